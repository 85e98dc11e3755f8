# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes for the tests and the benchmark of vtkChiCombinedOcclusionVolumeMapper."""
import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (registers the factories)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401 (likewise)
from algorithm_messages import Messages  # noqa: F401 (tests of scenes have it from here)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkFiltersSources import vtkPlaneSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


# An X server without -noreset starts afresh when its last client leaves, and refuses who comes meanwhile:
# one window stays.
_KEEP_SERVER = vtkRenderWindow()
_KEEP_SERVER.SetOffScreenRendering(1)
_KEEP_SERVER.SetSize(8, 8)
_KEEP_SERVER.Render()


def image(values, spacing=(1.0, 1.0, 1.0), origin=None, cells=False):
    """vtkImageData over values[z, y, x], centred at the world's origin unless told otherwise."""
    shape = values.shape[::-1]
    points = [n + 1 for n in shape] if cells else list(shape)
    if origin is None:
        origin = [-0.5 * (n - 1) * h for n, h in zip(points, spacing)]
    data = vtkImageData()
    data.SetDimensions(points)
    data.SetSpacing(spacing)
    data.SetOrigin(origin)
    array = numpy_to_vtk(np.ascontiguousarray(values).ravel(), deep=True)
    array.SetName("density")
    (data.GetCellData() if cells else data.GetPointData()).SetScalars(array)
    return data


def cube(values, edge=1.0, center=(0.0, 0.0, 0.0)):
    """An image whose samples span a cube of that edge around the centre."""
    h = edge / (values.shape[0] - 1)
    return image(values.astype(np.float32), (h, h, h), [c - 0.5 * edge for c in center])


def marschner_lobb(n, dtype=np.float32):
    """The test signal of Marschner & Lobb (Visualization 1994) on [-1, 1]^3; integers span 0 ... 255."""
    ticks = np.linspace(-1.0, 1.0, n)
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij", sparse=True)
    ripple = np.cos(12.0 * np.pi * np.cos(0.5 * np.pi * np.sqrt(x * x + y * y)))
    values = (1.0 - np.sin(0.5 * np.pi * z) + 0.25 * (1.0 + ripple)) / 2.5
    if np.issubdtype(dtype, np.integer):
        values = np.round(255.0 * values)
    return image(values.astype(dtype), (2.0 / (n - 1),) * 3)


def ball(n, radius=0.35, soft=0.15, offset=(0.0, 0.0, 0.0)):
    """values[z, y, x] of a soft ball, 1 inside, 0 outside, in a cube of edge 1."""
    ticks = (np.arange(n) + 0.5) / n - 0.5
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij", sparse=True)
    distance = np.sqrt((x - offset[0]) ** 2 + (y - offset[1]) ** 2 + (z - offset[2]) ** 2)
    return np.clip((radius - distance) / soft + 0.5, 0.0, 1.0).astype(np.float32)


WHITE = ((0.0, (1.0, 1.0, 1.0)), (1.0, (1.0, 1.0, 1.0)))


def volume_property(scale=1.0, opacity=0.3, unit=1.0, colors=None):
    """Colours over 0 ... scale, opacity a ramp up to `opacity` a `unit`."""
    color = vtkColorTransferFunction()
    for place, rgb in colors or ((0.0, (0.2, 0.3, 1.0)), (0.5, (1.0, 0.9, 0.3)), (1.0, (1.0, 0.1, 0.1))):
        color.AddRGBPoint(place * scale, *rgb)
    ramp = vtkPiecewiseFunction()
    ramp.AddPoint(0.0, 0.0)
    ramp.AddPoint(scale, opacity)
    prop = vtkVolumeProperty()
    prop.SetColor(color)
    prop.SetScalarOpacity(ramp)
    prop.SetScalarOpacityUnitDistance(unit)
    prop.SetInterpolationTypeToLinear()
    return prop


def transfer_plane(width=256, height=128, opacity=0.3, peaks=0.0):
    """A table of two quantities: red along the first, green along the second, opacity along both, in so many peaks."""
    y, x = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    along = np.clip(8.0 * np.sin(np.pi * peaks * x) ** 2 - 7.0, 0.0, 1.0) if peaks else x
    rgba = np.stack([x, y, 1.0 - x, opacity * along * np.clip(3.0 * y, 0.0, 1.0)], axis=-1).astype(np.float32)
    result = vtkImageData()
    result.SetDimensions(width, height, 1)
    result.GetPointData().SetScalars(numpy_to_vtk(rgba.reshape(-1, 4), deep=True))
    return result


def actor(source, color=(1.0, 1.0, 1.0), lit=False):
    """Opaque actor; of constant colour unless lit."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    prop = vtkActor()
    prop.SetMapper(mapper)
    prop.GetProperty().SetColor(color)
    if not lit:
        prop.GetProperty().LightingOff()
    return prop


def sphere(radius, center=(0.0, 0.0, 0.0), **options):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetCenter(center)
    source.SetThetaResolution(64)
    source.SetPhiResolution(64)
    return actor(source, **options)


def square(size, z=0.0, **options):
    source = vtkPlaneSource()
    source.SetOrigin(-size, -size, z)
    source.SetPoint1(size, -size, z)
    source.SetPoint2(-size, size, z)
    return actor(source, **options)


class Scene:
    """A window with one renderer, or more, looked at along a direction."""

    def __init__(self, size=(120, 120), viewports=((0, 0, 1, 1),), background=(0.0, 0.0, 0.0)):
        self.window = vtkRenderWindow()
        self.window.SetMultiSamples(0)
        self.window.SetOffScreenRendering(1)
        self.window.SetSize(size)
        self.window.SetDesiredUpdateRate(0.001)
        self.renderers = []
        for viewport in viewports:
            renderer = vtkRenderer()
            renderer.SetViewport(viewport)
            renderer.SetBackground(background)
            self.window.AddRenderer(renderer)
            self.renderers.append(renderer)
        self.renderer = self.renderers[0]

    def add_volume(self, data, prop=None, mapper=None, renderer=None):
        mapper = mapper or vtkChiCombinedOcclusionVolumeMapper()
        mapper.SetInputDataObject(data)
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop or volume_property())
        (renderer or self.renderer).AddVolume(volume)
        return volume, mapper

    def look(self, direction=(0, 0, -1), up=(0, 1, 0), half=1.0, parallel=True, renderer=None):
        """From outside towards the origin; `half` is half the height of the picture there."""
        camera = (renderer or self.renderer).GetActiveCamera()
        direction = np.asarray(direction, float) / np.linalg.norm(direction)
        distance = half / np.tan(np.radians(15.0))
        camera.SetFocalPoint(0, 0, 0)
        camera.SetPosition(*(-distance * direction))
        camera.SetViewUp(up)
        camera.SetViewAngle(30.0)
        camera.SetParallelProjection(parallel)
        camera.SetParallelScale(half)
        camera.SetClippingRange(0.1 * distance, 3.0 * distance)

    def pixels(self):
        """The window's colours, [y, x, 3] floats 0 ... 1, row 0 at the bottom."""
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.SetInputBufferTypeToRGB()
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        data = grab.GetOutput()
        width, height, _ = data.GetDimensions()
        return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width, 3) / 255.0


def float_image(mapper):
    """The mapper's last picture, [y, x, 4]."""
    data = vtkImageData()
    if not mapper.GetFloatImage(data):
        return None
    width, height, _ = data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width, 4).copy()


def visibility_image(mapper):
    """The visibility of the geometry in the last picture, [y, x]."""
    data = vtkImageData()
    if not mapper.GetVisibilityImage(data):
        return None
    width, height, _ = data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(height, width).copy()


def erode(mask, times):
    """Leave out pixels nearer than `times` to the border of the mask (silhouettes)."""
    for _ in range(times):
        inner = np.zeros_like(mask)
        inner[1:-1, 1:-1] = (
            mask[1:-1, 1:-1] & mask[:-2, 1:-1] & mask[2:, 1:-1] & mask[1:-1, :-2] & mask[1:-1, 2:]
        )
        mask = inner
    return mask
