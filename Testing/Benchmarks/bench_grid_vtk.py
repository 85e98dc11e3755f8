# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkDataSetTriangleFilter on the grids of bench_grid.c, for its rows beside ours. It cuts cubes into five
tetrahedra where it knows that they alternate (images), so the sizes differ: n is the number made. The column
error: triangles inside the grid that do not belong to exactly two tetrahedra, over all inside."""
import math
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, vtkCellArray, vtkImageData, vtkStructuredGrid,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter

RUNS = 5


def grids(n):
    """As bench_grid.c makes them; hexahedra once more with scattered ids."""
    image = vtkImageData()
    image.SetDimensions(n + 1, n + 1, n + 1)
    yield "image", image
    axis = np.arange(n + 1, dtype=float)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    xyz = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(xyz, deep=True))
    curvilinear = vtkStructuredGrid()
    curvilinear.SetDimensions(n + 1, n + 1, n + 1)
    curvilinear.SetPoints(points)
    yield "curvilinear", curvilinear
    first = np.arange((n + 1)**3).reshape(n + 1, n + 1, n + 1)[:-1, :-1, :-1].reshape(-1, 1)
    p, q = n + 1, (n + 1)**2
    ids = first + np.array([0, 1, p + 1, p, q, q + 1, q + p + 1, q + p])
    for name, step in ("hexahedra", 1), ("hexahedra (scattered ids)", 1000003):
        order = np.arange(len(xyz)) * step % len(xyz)
        placed = np.empty_like(xyz)
        placed[order] = xyz
        points = vtkPoints()
        points.SetData(numpy_to_vtk(placed, deep=True))
        cells = vtkCellArray()
        cells.SetData(8, numpy_to_vtkIdTypeArray(order[ids].ravel().astype(np.int64), deep=True))
        grid = vtkUnstructuredGrid()
        grid.SetPoints(points)
        grid.SetCells(VTK_HEXAHEDRON, cells)
        yield name, grid


def apart(grid, n):
    """The share of triangles inside that are not of two tetrahedra."""
    x = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    tetrahedra = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    triangles = np.concatenate([np.delete(tetrahedra, k, axis=1) for k in range(4)])
    triangles.sort(axis=1)
    key = (triangles[:, 0].astype(np.int64) * len(x) + triangles[:, 1]) * len(x) + triangles[:, 2]
    key, at, counts = np.unique(key, return_index=True, return_counts=True)
    corners = x[triangles[at]]
    outside = np.any(np.all((corners == 0) | (corners == n), axis=1) & (np.ptp(corners, axis=1) == 0), axis=1)
    return np.count_nonzero(counts[~outside] != 2) / np.count_nonzero(~outside)


def main():
    for n in (32, 55):
        for name, grid in grids(n):
            peer = vtkDataSetTriangleFilter()
            peer.SetInputData(grid)
            best = math.inf
            for _ in range(RUNS):
                peer.Modified()
                start = time.perf_counter_ns()
                peer.Update()
                best = min(best, time.perf_counter_ns() - start)
            made = peer.GetOutput()
            print(f"grid,{name},vtkDataSetTriangleFilter,{made.GetNumberOfCells() * 1e-6:.1f} M,"
                  f"{made.GetNumberOfCells()},1,{best},{apart(made, n):.3g},triangles that do not meet", flush=True)


print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
main()
