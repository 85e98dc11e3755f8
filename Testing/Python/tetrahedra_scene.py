# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Meshes, scenes and exact answers for the tests of vtkChiProjectedTetrahedraMapper."""
import itertools

import numpy as np
from each_engine import check_engine, new_mapper
from occlusion_scene import Messages, Scene, float_image
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.util.vtkConstants import VTK_TETRA
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPiecewiseFunction, vtkUnstructuredGrid
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty

from chiaroscuro.vtkChiRendering import vtkChiProjectedTetrahedraMapper

WHITE = (1.0, 1.0, 1.0)


def mesh(points, cells, kind=VTK_TETRA, scalars=None, cell_scalars=None, name="density"):
    """vtkUnstructuredGrid of cells of one type; cells[i] are point ids."""
    cells = np.asarray(cells, np.int64)
    data = vtkUnstructuredGrid()
    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data.SetPoints(places)
    connectivity = vtkCellArray()
    offsets = np.arange(len(cells) + 1, dtype=np.int64) * cells.shape[1]
    connectivity.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(cells.ravel(), deep=True)
    )
    data.SetCells(kind, connectivity)
    for values, attributes in ((scalars, data.GetPointData()), (cell_scalars, data.GetCellData())):
        if values is not None:
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
            array.SetName(name)
            attributes.SetScalars(array)
    return data


def lattice(n, edge=1.0, center=(0.0, 0.0, 0.0), dtype=np.float64):
    """(n + 1)^3 points over a cube, x fastest."""
    ticks = (np.arange(n + 1) / n - 0.5) * edge
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij")
    return (np.stack([x, y, z], axis=-1).reshape(-1, 3) + np.asarray(center)).astype(dtype)


def hexahedra_of(n):
    """Point ids of the n^3 cubes of a lattice, [cells, 8], in the order of VTK_HEXAHEDRON."""
    k, j, i = (g.ravel() for g in np.meshgrid(*(np.arange(n),) * 3, indexing="ij"))
    first = i + (n + 1) * (j + (n + 1) * k)
    right, up, deep = 1, n + 1, (n + 1) ** 2
    bottom = [first, first + right, first + right + up, first + up]
    return np.stack(bottom + [c + deep for c in bottom], axis=-1)


def tetrahedra_of(n):
    """The same cubes, each split into six tetrahedra about its diagonal (Kuhn 1960)."""
    corners = hexahedra_of(n)
    first = corners[:, 0]
    steps = (1, n + 1, (n + 1) ** 2)
    return np.concatenate(
        [
            np.stack([first, first + steps[a], first + steps[a] + steps[b], corners[:, 6]], axis=-1)
            for a, b, _ in itertools.permutations(range(3))
        ]
    )


def cube(n=1, edge=1.0, center=(0.0, 0.0, 0.0), field=None, dtype=np.float64):
    """A cube of 6 n^3 tetrahedra; field(x, y, z) are its scalars, 1 where it is None."""
    points = lattice(n, edge, center)
    values = np.ones(len(points)) if field is None else field(*points.T)
    return mesh(points.astype(dtype), tetrahedra_of(n), scalars=values.astype(np.float32))


def extinction(tau=1.0, unit=1.0, colors=((0.0, WHITE), (1.0, WHITE)), ramp=None):
    """Even extinction of `tau` a length, or `ramp` of (scalar, opacity) over `unit`."""
    color = vtkColorTransferFunction()
    for place, rgb in colors:
        color.AddRGBPoint(place, *rgb)
    opacity = vtkPiecewiseFunction()
    opacity.ClampingOn()
    for place, value in ramp or ((0.0, min(tau * unit, 1.0)), (1.0, min(tau * unit, 1.0))):
        opacity.AddPoint(place, value)
    prop = vtkVolumeProperty()
    prop.SetColor(color)
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(unit)
    prop.SetInterpolationTypeToLinear()
    return prop


def even(tau):
    """The same for any tau, by the unit distance."""
    return extinction(tau, 1.0 / tau)


class TetScene(Scene):
    """A window with one mesh."""

    def __init__(self, data=None, prop=None, size=(64, 64), **options):
        super().__init__(size, **options)
        self.mapper = new_mapper(vtkChiProjectedTetrahedraMapper)
        self.messages = Messages(self.mapper)
        self.volume = None
        if data is not None:
            self.volume, _ = self.add_volume(data, prop or even(1.0), self.mapper)
            self.look()

    def rgba(self):
        self.window.Render()
        check_engine(self.mapper)
        return float_image(self.mapper)


def rays(renderer, width, height):
    """Origin at the near plane and unit direction of the ray of each pixel, [y, x, 3]; x and y are what
    vtkCamera projects by."""
    camera = renderer.GetActiveCamera()
    matrix = camera.GetCompositeProjectionTransformMatrix(width / height, -1.0, 1.0)
    inverse = np.linalg.inv(np.array([[matrix.GetElement(r, c) for c in range(4)] for r in range(4)]))
    y, x = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    ends = []
    for z in (-1.0, 1.0):
        clip = np.stack([2.0 * x - 1.0, 2.0 * y - 1.0, np.full_like(x, z), np.ones_like(x)], axis=-1)
        world = clip @ inverse.T
        ends.append(world[..., :3] / world[..., 3:])
    way = ends[1] - ends[0]
    return ends[0], way / np.linalg.norm(way, axis=-1, keepdims=True)


def interval(renderer, width, height, low=(-0.5,) * 3, high=(0.5,) * 3):
    """Where the ray of each pixel enters and leaves a box, as distances from the near plane."""
    origin, way = rays(renderer, width, height)
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (np.asarray(low) - origin) / way
        b = (np.asarray(high) - origin) / way
    # a ray inside a slab that it runs along: NaN says nothing where it lies in the face itself
    enter = np.fmax.reduce(np.fmin(a, b), axis=-1)
    leave = np.fmin.reduce(np.fmax(a, b), axis=-1)
    enter = np.minimum(np.maximum(enter, 0.0), 1e30) # infinite beside a slab that it runs along
    return enter, np.maximum(leave, enter)


def paths(renderer, width, height, low=(-0.5,) * 3, high=(0.5,) * 3):
    enter, leave = interval(renderer, width, height, low, high)
    return leave - enter


def paths_in(renderer, width, height, corners):
    """Length of the ray of each pixel inside one tetrahedron."""
    origin, way = rays(renderer, width, height)
    corners = np.asarray(corners, float)
    enter = np.zeros((height, width))
    leave = np.full((height, width), np.inf)
    for i in range(4):
        a, b, c = (corners[j] for j in range(4) if j != i)
        normal = np.cross(b - a, c - a)
        normal *= np.sign(np.dot(normal, corners[i] - a)) # inwards
        height_of = (origin - a) @ normal
        slope = way @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            at = -height_of / slope
        enter = np.where(slope > 0, np.maximum(enter, at), enter)
        leave = np.where(slope < 0, np.minimum(leave, at), leave)
        leave = np.where((slope == 0) & (height_of < 0), -np.inf, leave)
    return np.maximum(leave - enter, 0.0)
