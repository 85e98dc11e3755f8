# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiContinuousScatterplot beside vtkContinuousScatterplot on the same tetrahedra, 64^2 bins:
bench_scatterplot_vtk.py [LARGEST], cells along an axis (2, 4 ... LARGEST, default 4).

The other class takes tens of milliseconds a tetrahedron, hence the small grids; on those our time is mostly what a call and
its bins cost, so that the last row, ours on 32^3 cubes, tells the rate. Rows of one thread are processor time, which on
a machine that others use too is what the wall clock says on a quiet one. The other class scales its values to 255 and
gives no mass; the error is that of ours, |mass + mass out of range - volume| / volume."""
import math
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools
from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkCellArray, vtkUnstructuredGrid

from bench_fiber_vtk import fields, tetrahedra
from chiaroscuro import vtkChiContinuousScatterplot

try:
    from vtkmodules.vtkInfovisCore import vtkContinuousScatterplot
except ImportError:
    vtkContinuousScatterplot = None

BINS = 64
RUNS = 5
LARGE = 32


def mesh(n):
    points, signal, distance = fields(n)
    grid, places, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(points, deep=True))
    cells.SetData(4, numpy_to_vtkIdTypeArray(tetrahedra(n), deep=True))
    grid.SetPoints(places)
    grid.SetCells(VTK_TETRA, cells)
    for name, values in (("signal", signal), ("distance", distance)):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)
    return grid


def ours(grid):
    plot = vtkChiContinuousScatterplot()
    plot.SetInputData(grid)
    plot.SetInputArrayToProcess(0, 0, 0, 0, "signal")
    plot.SetInputArrayToProcess(1, 0, 0, 0, "distance")
    plot.SetDimensions(BINS, BINS)
    plot.SetSkippingMask(plot.SKIP_EVERY_KIND & ~plot.SKIP_UNCHANGED)  # each run from nothing
    return plot


def theirs(grid):
    plot = vtkContinuousScatterplot()
    plot.SetInputData(grid)
    plot.SetField1("signal", BINS)
    plot.SetField2("distance", BINS)
    return plot


def least(plot, runs, threads):
    """Nanoseconds of the fastest of some runs."""
    vtkSMPTools.Initialize(threads)
    clock = time.process_time_ns if threads == 1 else time.perf_counter_ns
    best = math.inf
    for _ in range(runs):
        plot.Modified()
        start = clock()
        plot.Update()
        best = min(best, clock() - start)
    return best


def mass_error(plot):
    """The cube's volume is 8."""
    image = plot.GetOutputDataObject(0)
    area = image.GetSpacing()[0] * image.GetSpacing()[1]
    inside = math.fsum(vtk_to_numpy(image.GetPointData().GetScalars()).astype(float)) * area
    return abs(inside + plot.GetMassOutOfRange() - 8) / 8


def row(method, parameter, n, threads, ns, error="", kind=""):
    print(f"scatterplot,tetrahedra,{method},{parameter},{n},{threads},{ns},{error},{kind}", flush=True)


def main():
    most = int(sys.argv[1]) if len(sys.argv) > 1 else 4
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    vtkSMPTools.SetBackend("STDThread")
    peer_rate = math.nan
    sizes = [2]
    while sizes[-1] < most:
        sizes.append(2 * sizes[-1])
    for n in sizes + [LARGE]:
        grid = mesh(n)
        cells = grid.GetNumberOfCells()
        if vtkContinuousScatterplot and n <= most:
            ns = least(theirs(grid), 1, 1)
            peer_rate = cells / ns
            row("vtkContinuousScatterplot", f"{BINS}^2", cells, 1, ns)
        for threads in (1, 2):
            plot = ours(grid)
            ns = least(plot, RUNS, threads)
            ratio = cells / ns / peer_rate
            parameter = f"{BINS}^2" + (f" {ratio:.0f} times the other's rate" if ratio == ratio else "")
            row("vtkChiContinuousScatterplot", parameter, cells, threads, ns, f"{mass_error(plot):.3g}", "mass")
    if not vtkContinuousScatterplot:
        print("vtkContinuousScatterplot is left out: this VTK has none", file=sys.stderr)


if __name__ == "__main__":
    main()
