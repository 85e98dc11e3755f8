# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""A brain (MRI) as a mesh of tetrahedra, small where it has detail, beside the image itself."""
from pathlib import Path

import numpy as np
import vtkmodules.all as vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from chiaroscuro import vtkChiCombinedOcclusionVolumeMapper, vtkChiProjectedTetrahedraMapper

POINTS = 30000


def read(data):
    """ch2bet, smoothed to what so few points can hold."""
    reader, smooth = vtk.vtkNIFTIImageReader(), vtk.vtkImageGaussianSmooth()
    reader.SetFileName(f"{data}/ch2bet.nii.gz")
    smooth.SetInputConnection(reader.GetOutputPort())
    smooth.SetStandardDeviation(1.5)
    smooth.Update()
    return smooth.GetOutput()


def mesh(image):
    """Delaunay tetrahedra of points that lie where the gradient is, and of the box's corners."""
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1]).astype(float)
    slope = np.sqrt(sum(g * g for g in np.gradient(values)))
    weight = (slope + 0.02 * slope.max() * (values > 0)).ravel()
    random = np.random.default_rng(1)
    chosen = random.choice(weight.size, POINTS, replace=False, p=weight / weight.sum())
    index = np.stack(np.unravel_index(chosen, values.shape)[::-1], axis=-1)
    index = index + random.uniform(-0.5, 0.5, index.shape)  # jittered: no five points on a sphere
    last = np.array(image.GetDimensions()) - 1.0
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * last
    places = np.concatenate([np.clip(index, 0, last), corners]) * image.GetSpacing() + image.GetOrigin()
    points, cloud = vtk.vtkPoints(), vtk.vtkPolyData()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(places), deep=True))
    cloud.SetPoints(points)
    delaunay, probe = vtk.vtkDelaunay3D(), vtk.vtkProbeFilter()
    delaunay.SetInputData(cloud)
    probe.SetInputConnection(delaunay.GetOutputPort())
    probe.SetSourceData(image)
    probe.Update()
    return probe.GetOutput()


def cached_mesh(image, path):
    if not Path(path).exists():
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(mesh(image))
        writer.SetFileName(path)
        writer.Write()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def classify():
    opacity, color, prop = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction(), vtk.vtkVolumeProperty()
    # cerebrospinal fluid and all around clear, grey matter thin, white matter dense
    for value, alpha, rgb in ((30, 0.0, (0.1, 0.02, 0.1)), (55, 0.015, (0.3, 0.05, 0.15)),
                              (80, 0.05, (0.75, 0.3, 0.2)), (95, 0.12, (0.95, 0.65, 0.4)),
                              (108, 0.4, (1.0, 0.95, 0.85)), (130, 0.6, (1.0, 1.0, 0.97))):
        opacity.AddPoint(value, alpha)
        color.AddRGBPoint(value, *rgb)
    prop.SetScalarOpacity(opacity)
    prop.SetColor(color)
    prop.SetScalarOpacityUnitDistance(1.0)  # millimetre
    prop.SetInterpolationTypeToLinear()
    return prop


def scene(data, cache):
    """Both mappers under one transfer function, side by side in one window's two renderers."""
    image = read(data)
    tetrahedra, slices = vtkChiProjectedTetrahedraMapper(), vtkChiCombinedOcclusionVolumeMapper()
    tetrahedra.SetInputData(cached_mesh(image, cache))
    tetrahedra.SetOpacityConventionToImage()
    slices.SetInputData(image)
    slices.SetOcclusionStrength(0.0)
    renderers = []
    for mapper in (tetrahedra, slices):
        volume, renderer = vtk.vtkVolume(), vtk.vtkRenderer()
        volume.SetMapper(mapper)
        volume.SetProperty(classify())
        renderer.AddVolume(volume)
        renderer.SetBackground(0.06, 0.07, 0.09)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(-0.8, 0.75, 0.45)
        camera.SetViewUp(0, 0, 1)
        renderer.ResetCamera()
        camera.Zoom(1.75)
        renderers.append(renderer)
    return renderers, tetrahedra


if __name__ == "__main__":
    from argparse import ArgumentParser
    from save_picture import save

    parser = ArgumentParser(description=__doc__)
    parser.add_argument("data", help="the folder that `make data` fills")
    parser.add_argument("picture", help="PNG to write")
    given = parser.parse_args()
    save(scene(given.data, given.picture + ".vtu")[0][0], given.picture)
