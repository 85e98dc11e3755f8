# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""What turns the volumes of engine_agreement into shaded ones, or ones with other transfer functions."""
import numpy as np
from engine_agreement import N
from occlusion_scene import transfer_plane
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction


def lit(content, specular=0.6, power=12.0):
    """The same under lights."""

    def make():
        data, prop = content()
        prop.ShadeOn()
        prop.SetAmbient(0.2)
        prop.SetDiffuse(0.7)
        prop.SetSpecular(specular)
        prop.SetSpecularPower(power)
        return data, prop

    return make


def steep(content, least=0.06):
    """The same, transparent where the gradient is below that share of the scalar's range."""

    def make():
        data, prop = content()
        low, high = data.GetScalarRange()
        function = vtkPiecewiseFunction()
        for place, value in ((0.0, 0.0), (least, 0.2), (2.5 * least, 1.0)):
            function.AddPoint(place * (high - low), value)
        prop.SetGradientOpacity(function)
        return data, prop

    return make


def nearest(content):
    """The same with nearest samples."""

    def make():
        data, prop = content()
        prop.SetInterpolationTypeToNearest()
        return data, prop

    return make


def plane(content, shade=False, nearest=False, **options):
    """The same with a table over the scalar and a second quantity."""

    def make():
        data, prop = content()
        prop.SetTransferFunctionModeTo2D()
        prop.SetTransferFunction2D(transfer_plane(**{"opacity": 0.6, **options}))
        prop.SetShade(shade)
        prop.SetAmbient(0.2)
        prop.SetDiffuse(0.7)
        prop.SetSpecular(0.5)
        prop.SetSpecularPower(12.0)
        if nearest:
            prop.SetInterpolationTypeToNearest()
        return data, prop

    return make


def with_second(content, hole=False):
    """The same with an array of stripes."""

    def make():
        data, prop = content()
        z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, N),) * 3, indexing="ij")
        values = (50.0 + 20.0 * np.sin(5.0 * x) * y + 5.0 * z).astype(np.float32)
        if hole:
            values[8:12, 9:15, 3:20] = np.nan
        second = numpy_to_vtk(values.ravel(), deep=True)
        second.SetName("second")
        data.GetPointData().AddArray(second)
        return data, prop

    return make


def by_second(mapper):
    mapper.SetTransfer2DYAxisArray("second")
