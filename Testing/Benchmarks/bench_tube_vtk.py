# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiStreamTubes beside vtkTubeFilter (same rings) and vtkSplineFilter + vtkTubeFilter (same error)."""
import math
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkTubeFilter
from vtkmodules.vtkFiltersGeneral import vtkSplineFilter

from chiaroscuro import vtkChiStreamTubes

LINES, POINTS, SIDES, RUNS = 2000, 500, 8, 5


def helices(lines, points):
    """Helices of radius 1 and pitch 2 pi 0.3, two turns each, side by side."""
    t = np.linspace(0, 4 * math.pi, points)
    one = np.stack([np.cos(t), np.sin(t), 0.3 * t], 1)
    shift = np.stack([3.0 * (np.arange(lines) % 50), 3.0 * (np.arange(lines) // 50), np.zeros(lines)], 1)
    data, p, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    xyz = (one[None] + shift[:, None]).reshape(-1, 3).astype(np.float32)
    p.SetData(numpy_to_vtk(xyz, deep=True))
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(lines + 1) * points, deep=True),
                  numpy_to_vtkIdTypeArray(np.arange(lines * points), deep=True))
    data.SetPoints(p)
    data.SetLines(cells)
    return data


def timed(*filters, runs=RUNS):
    best = math.inf
    for _ in range(runs):
        for f in filters:
            f.Modified()
        start = time.perf_counter_ns()
        filters[-1].Update()
        best = min(best, time.perf_counter_ns() - start)
    return best


def axis_error(curve):
    """Largest distance of the polylines' points and middles of segments to the first helix's axis."""
    xyz = vtk_to_numpy(curve.GetPoints().GetData()).astype(float)
    ends = vtk_to_numpy(curve.GetLines().GetOffsetsArray())
    p = xyz[ends[0]:ends[1]]
    p = np.concatenate([p, 0.5 * (p[1:] + p[:-1])])
    t = p[:, 2] / 0.3
    for _ in range(20):  # Newton for the nearest point of the helix
        f = p[:, 0] * np.sin(t) - p[:, 1] * np.cos(t) + 0.3 * (0.3 * t - p[:, 2])
        t -= f / (p[:, 0] * np.cos(t) + p[:, 1] * np.sin(t) + 0.09)
    q = np.stack([np.cos(t), np.sin(t), 0.3 * t], 1)
    return np.linalg.norm(p - q, axis=1).max()


def triangles(surface):
    return sum(surface.GetStrips().GetOffsetsArray().GetTuple1(i + 1)
               - surface.GetStrips().GetOffsetsArray().GetTuple1(i) - 2
               for i in range(0, min(SIDES, surface.GetNumberOfStrips())))


def row(case, method, parameter, n, threads, ns, error, kind):
    print(f"tube,{case},{method},{parameter},{n},{threads},{ns},{error:.6g},{kind}", flush=True)


def main():
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    vtkSMPTools.SetBackend("STDThread")
    data = helices(LINES, POINTS)
    peer = vtkTubeFilter()
    peer.SetInputData(data)
    peer.SetNumberOfSides(SIDES)
    peer.SetRadius(0.05)
    ours = vtkChiStreamTubes()
    ours.SetInputData(data)
    ours.SetNumberOfSides(SIDES)
    ours.RadiusIsRelativeOff()
    ours.SetRadius(0.05)
    ours.SetCappingToNone()
    ours.SplineFittingOff()
    for threads in (2, 1):
        vtkSMPTools.Initialize(threads)
        row("same rings", "chiStreamTubes", "no fit", LINES * POINTS, threads, timed(ours), 0, "")
    row("same rings", "vtkTubeFilter", "", LINES * POINTS, 1, timed(peer), 0, "")

    # Equal error: the axis against the true helix, on a tenth of the lines.
    vtkSMPTools.Initialize(2)
    few = helices(LINES // 10, POINTS)
    ours.SetInputData(few)
    ours.SplineFittingOn()
    ours.ToleranceIsRelativeOff()
    ours.SetAngularTolerance(45)
    for tolerance in (1e-2, 3e-3, 1e-3, 3e-4):
        ours.SetTolerance(tolerance)
        best = math.inf
        for _ in range(RUNS):
            few.GetPoints().Modified()  # so that the fit is part of the time
            best = min(best, timed(ours, runs=1))
        error = axis_error(ours.GetOutput(1))
        parameter = f"tolerance={tolerance:g} triangles={triangles(ours.GetOutput()):.0f}"
        row("equal error", "chiStreamTubes", parameter, few.GetNumberOfPoints(), 2, best, error, "axis_hausdorff")
    spline = vtkSplineFilter()
    spline.SetInputData(few)
    spline.SetSubdivideToSpecified()
    peer.SetInputConnection(spline.GetOutputPort())
    for pieces in (40, 80, 160, 320, 640):
        spline.SetNumberOfSubdivisions(pieces)
        best = timed(spline, peer, runs=3)
        error = axis_error(spline.GetOutput())
        parameter = f"pieces={pieces} triangles={triangles(peer.GetOutput()):.0f}"
        row("equal error", "vtkSplineFilter+vtkTubeFilter", parameter, few.GetNumberOfPoints(), 1, best, error, "axis_hausdorff")


if __name__ == "__main__":
    main()
