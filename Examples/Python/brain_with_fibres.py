# SPDX-License-Identifier: BSD-3-Clause
"""A brain (MRI), cut open, with nerve fibres; all shade each other."""
import tempfile, zipfile

import nibabel
import numpy as np
import vtkmodules.all as vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray as ids
from chiaroscuro import vtkChiCombinedOcclusionVolumeMapper, vtkChiStreamTubes

def fibres(path, color, move=(0, 0, 0)):
    streamlines = [line + move for line in nibabel.streamlines.load(path).streamlines]
    ends = np.cumsum([0] + [len(line) for line in streamlines])
    points, cells, lines = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(np.concatenate(streamlines), deep=True))
    cells.SetData(ids(ends, deep=True), ids(np.arange(ends[-1]), deep=True))
    lines.SetPoints(points)
    lines.SetLines(cells)
    tubes, mapper, actor = vtkChiStreamTubes(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    tubes.SetInputData(lines)
    tubes.RadiusIsRelativeOff()
    tubes.SetRadius(0.5)  # millimetres
    mapper.SetInputConnection(tubes.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    return actor

def scene(data):
    renderer, reader, half = vtk.vtkRenderer(), vtk.vtkNIFTIImageReader(), vtk.vtkExtractVOI()
    with tempfile.TemporaryDirectory() as folder:  # of two other people, by a rigid motion in MNI space
        zipfile.ZipFile(f"{data}/minimal_bundles.zip").extractall(folder)
        renderer.AddActor(fibres(f"{folder}/sub_5/AF_L.trk", (0.95, 0.5, 0.15)))
        renderer.AddActor(fibres(f"{folder}/sub_5/CC_ForcepsMajor.trk", (0.2, 0.6, 0.75)))
    renderer.AddActor(fibres(f"{data}/tracks300.trk", (0.75, 0.3, 0.55), (-90, -114, -67)))
    reader.SetFileName(f"{data}/ch2better.nii.gz")
    half.SetInputConnection(reader.GetOutputPort())
    half.SetVOI(138, 300, 0, 369, 0, 315)  # the left side cut away at x = -6 mm
    brain, volume = vtkChiCombinedOcclusionVolumeMapper(), vtk.vtkVolume()
    brain.SetInputConnection(half.GetOutputPort())
    volume.SetMapper(brain)
    volume.SetPosition(-75, -107, -69.5)  # where the file's affine puts its first voxel
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for value, alpha, grey in ((62, 0, 0.7), (78, 0.5, 0.72), (92, 0.8, 0.78), (112, 0.9, 0.98)):
        opacity.AddPoint(value, alpha)
        color.AddRGBPoint(value, grey, 0.96 * grey, 0.9 * grey)
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetColor(color)
    volume.GetProperty().SetInterpolationTypeToLinear()
    renderer.AddVolume(volume)
    renderer.SetBackground(1, 1, 1)
    renderer.GetActiveCamera().SetPosition(-1, 0.35, 0.25)
    renderer.GetActiveCamera().SetViewUp(0, 0, 1)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Zoom(1.35)
    return renderer, brain


if __name__ == "__main__":
    from argparse import ArgumentParser
    from save_picture import save

    parser = ArgumentParser(description=__doc__)
    parser.add_argument("data", help="the folder that `make data` fills")
    parser.add_argument("picture", help="PNG to write")
    given = parser.parse_args()
    save(scene(given.data)[0], given.picture)
