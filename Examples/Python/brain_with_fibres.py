# SPDX-License-Identifier: BSD-3-Clause
"""A brain (MRI), cut open, with nerve fibres; all shade each other: brain_with_fibres.py DATA PICTURE"""
import sys
import tempfile
import zipfile

import nibabel
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkImagingCore import vtkExtractVOI
from vtkmodules.vtkIOImage import vtkNIFTIImageReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkPolyDataMapper,
    vtkRenderer, vtkRenderWindow, vtkVolume, vtkWindowToImageFilter)
from chiaroscuro import vtkChiCombinedOcclusionVolumeMapper, vtkChiStreamTubes


def fibres(path, color, move=(0, 0, 0)):
    streamlines = [line + move for line in nibabel.streamlines.load(path).streamlines]
    points, cells, lines = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.concatenate(streamlines).astype(np.float32), deep=True))
    ids = iter(range(points.GetNumberOfPoints()))
    for line in streamlines:
        cells.InsertNextCell(len(line), [next(ids) for _ in line])
    lines.SetPoints(points)
    lines.SetLines(cells)
    tubes, mapper, actor = vtkChiStreamTubes(), vtkPolyDataMapper(), vtkActor()
    tubes.SetInputData(lines)
    tubes.RadiusIsRelativeOff()
    tubes.SetRadius(0.5)  # millimetres
    mapper.SetInputConnection(tubes.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    return actor


def scene(data):
    renderer, reader, half, volume = vtkRenderer(), vtkNIFTIImageReader(), vtkExtractVOI(), vtkVolume()
    with tempfile.TemporaryDirectory() as folder:  # of two other people, by a rigid motion in MNI space
        zipfile.ZipFile(f"{data}/minimal_bundles.zip").extractall(folder)
        for name, color in (("AF_L", (0.95, 0.5, 0.15)), ("CC_ForcepsMajor", (0.2, 0.6, 0.75))):
            renderer.AddActor(fibres(f"{folder}/sub_5/{name}.trk", color))
    renderer.AddActor(fibres(f"{data}/tracks300.trk", (0.75, 0.3, 0.55), (-90, -114, -67)))
    reader.SetFileName(f"{data}/ch2better.nii.gz")
    half.SetInputConnection(reader.GetOutputPort())
    half.SetVOI(138, 300, 0, 369, 0, 315)  # the left side cut away at x = -6 mm
    brain, opacity, color = vtkChiCombinedOcclusionVolumeMapper(), vtkPiecewiseFunction(), vtkColorTransferFunction()
    brain.SetInputConnection(half.GetOutputPort())
    for value, alpha, grey in ((62, 0, 0.7), (78, 0.5, 0.72), (92, 0.8, 0.78), (112, 0.9, 0.98)):
        opacity.AddPoint(value, alpha)
        color.AddRGBPoint(value, grey, 0.96 * grey, 0.9 * grey)
    volume.SetMapper(brain)
    volume.SetPosition(-75, -107, -69.5)  # where the file's affine puts its first voxel
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetColor(color)
    volume.GetProperty().SetInterpolationTypeToLinear()
    renderer.AddVolume(volume)
    renderer.SetBackground(1, 1, 1)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(-1, 0.35, 0.25)
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera()
    camera.Zoom(1.35)
    return renderer, brain


def save(renderer, path, size=1024):
    window, image, writer = vtkRenderWindow(), vtkWindowToImageFilter(), vtkPNGWriter()
    window.SetSize(size, size)
    window.SetOffScreenRendering(True)
    window.AddRenderer(renderer)
    window.Render()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.ShouldRerenderOff()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    return window


if __name__ == "__main__":
    save(scene(sys.argv[1])[0], sys.argv[2])
