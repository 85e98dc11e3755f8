# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiStreamTubes beside vtkTubeFilter (same rings) and vtkSplineFilter + vtkTubeFilter (same error):
bench_tube_vtk.py [DATA], the folder with tracks300.trk."""
import math
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkFiltersCore import vtkTubeFilter
from vtkmodules.vtkFiltersGeneral import vtkSplineFilter

from chiaroscuro import vtkChiStreamTubes
from tube_lines import abc_flow, analytic, fibres, hausdorff, helices, poly_data, sphere_flow

LINES, POINTS, SIDES, RUNS = 2000, 500, 8, 5
FEW, COMPARED = 40, 20  # lines of the cases at equal error; of them the error is measured


def timed(*filters, runs=RUNS):
    best = math.inf
    for _ in range(runs):
        for f in filters:
            f.Modified()
        start = time.perf_counter_ns()
        filters[-1].Update()
        best = min(best, time.perf_counter_ns() - start)
    return best


def triangles(surface):
    return int(np.sum(np.diff(vtk_to_numpy(surface.GetStrips().GetOffsetsArray())) - 2))


def row(case, method, parameter, n, threads, ns, error, kind):
    print(f"tube,{case},{method},{parameter},{n},{threads},{ns},{error:.6g},{kind}", flush=True)


def tubes(data, radius):
    ours = vtkChiStreamTubes()
    ours.SetInputData(data)
    ours.SetNumberOfSides(SIDES)
    ours.RadiusIsRelativeOff()
    ours.SetRadius(radius)
    ours.SetCappingToNone()
    return ours


def same_rings():
    data = poly_data(helices(LINES, POINTS))
    peer = vtkTubeFilter()
    peer.SetInputData(data)
    peer.SetNumberOfSides(SIDES)
    peer.SetRadius(0.05)
    ours = tubes(data, 0.05)
    ours.SplineFittingOff()
    for threads in (2, 1):
        vtkSMPTools.Initialize(threads)
        row("same rings", "chiStreamTubes", "no fit", LINES * POINTS, threads, timed(ours), 0, "")
    row("same rings", "vtkTubeFilter", "", LINES * POINTS, 1, timed(peer), 0, "")


def equal_error(case, references, lines, radius, tolerances, steps):
    """Triangles of the strips, and the two-sided distance of their axes to the references."""
    data, references = poly_data(lines), references[:COMPARED]
    points, count = data.GetNumberOfPoints(), len(lines)
    ours = tubes(data, radius)
    ours.LimitRadiusToCurvatureOff()
    ours.ToleranceIsRelativeOff()
    ours.SetAngularTolerance(45)
    for tolerance in tolerances:
        ours.SetTolerance(tolerance)
        best = math.inf
        for _ in range(RUNS):
            data.GetPoints().Modified()  # so that the fit is part of the time
            best = min(best, timed(ours, runs=1))
        error = hausdorff(ours.GetOutput(1), references)
        parameter = f"tolerance={tolerance:g} triangles={triangles(ours.GetOutput()) / count:.0f}"
        row(case, "chiStreamTubes", parameter, points, 2, best, error, "axis_hausdorff")
    spline, peer = vtkSplineFilter(), vtkTubeFilter()
    spline.SetInputData(data)
    spline.SetSubdivideToLength()  # at equal numbers of pieces no worse than SubdivideToSpecified
    peer.SetInputConnection(spline.GetOutputPort())
    peer.SetNumberOfSides(SIDES)
    peer.SetRadius(radius)
    for step in steps:
        spline.SetLength(step)
        best = timed(spline, peer, runs=3)
        error = hausdorff(spline.GetOutput(), references)
        parameter = f"length={step:g} triangles={triangles(peer.GetOutput()) / count:.0f}"
        row(case, "vtkSplineFilter+vtkTubeFilter", parameter, points, 1, best, error, "axis_hausdorff")


def main():
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    vtkSMPTools.SetBackend("STDThread")
    same_rings()
    vtkSMPTools.Initialize(2)
    tolerances = (1e-2, 3e-3, 1e-3, 3e-4)
    equal_error("helix", *analytic(helices, FEW, POINTS), 0.05, tolerances, (0.2, 0.1, 0.05, 0.025))
    equal_error("flow past a sphere", *analytic(sphere_flow, FEW, POINTS), 0.05, tolerances,
                (0.4, 0.2, 0.1, 0.05))
    equal_error("ABC flow", *analytic(abc_flow, FEW, POINTS), 0.02, tolerances, (0.2, 0.1, 0.05, 0.025))
    if len(sys.argv) > 1:
        equal_error("fornix", *fibres(f"{sys.argv[1]}/tracks300.trk"), 0.5, (1, 0.5, 0.2, 0.1, 0.05),
                    (8, 4, 2, 1, 0.5))


if __name__ == "__main__":
    main()
