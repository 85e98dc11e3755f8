# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Samples of several components, and functions of them, for tests of both engines."""
import numpy as np
from occlusion_scene import image
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty


def waves(count, dtype=np.uint8, size=48):
    """Fields like that of Marschner & Lobb (1994), along other axes and of other periods: [z, y, x, c]."""
    ticks = np.linspace(-1.0, 1.0, size)
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij")
    fields = []
    for axis, (a, b, c), period in zip(range(4), ((z, y, x), (x, z, y), (y, x, z), (-z, x, y)), (6, 4, 3, 5)):
        ripple = np.cos(2.0 * np.pi * period * np.cos(0.5 * np.pi * np.sqrt(b * b + c * c)))
        fields.append((1.0 - np.sin(0.5 * np.pi * a) + 0.25 * (1.0 + ripple)) / 2.5)
    values = np.stack(fields[:count], axis=-1)
    return np.round(255.0 * values).astype(dtype)


def interleaved(values):
    """An image of values[z, y, x, c], two long where it is a cube."""
    data = image(np.ascontiguousarray(values[..., 0]), (2.0 / (values.shape[2] - 1),) * 3)
    array = numpy_to_vtk(values.reshape(-1, values.shape[-1]), deep=True)
    array.SetName("fields")
    data.GetPointData().SetScalars(array)
    return data


COLORS = (
    ((0.1, 0.2, 0.9), (1.0, 0.6, 0.1)),
    ((0.9, 0.1, 0.2), (0.2, 1.0, 0.4)),
    ((0.2, 0.8, 0.8), (0.9, 0.9, 0.1)),
    ((0.7, 0.2, 0.9), (0.3, 0.4, 0.2)),
)


def property_of(count, weights=(1.0, 1.0, 1.0, 1.0), scale=255.0):
    """Each component a band of opacity and colours of its own."""
    prop = vtkVolumeProperty()
    prop.SetInterpolationTypeToLinear()
    for k in range(count):
        color = vtkColorTransferFunction()
        for place, rgb in zip((0.0, scale), COLORS[k]):
            color.AddRGBPoint(place, *rgb)
        band = vtkPiecewiseFunction()
        for place, opacity in ((0.0, 0.0), (0.3 + 0.1 * k, 0.02), (0.5 + 0.1 * k, 0.5 - 0.1 * k), (1.0, 0.0)):
            band.AddPoint(place * scale, opacity)
        prop.SetColor(k, color)
        prop.SetScalarOpacity(k, band)
        prop.SetScalarOpacityUnitDistance(k, 0.1 + 0.05 * k)
        prop.SetComponentWeight(k, weights[k])
    return prop
