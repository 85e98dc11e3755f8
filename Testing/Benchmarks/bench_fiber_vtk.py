# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiFiberSurface beside vtkFiberSurface on the same unstructured grids, read from the same files:
bench_fiber_vtk.py [LARGEST [FOLDER]], cells along an axis (32, 64 ... LARGEST, default 128).

ParaView 5.11's VTK lacks vtkFiberSurface, so it runs in a virtual environment in FOLDER (default: the system's for
temporary files) with the PyPI wheel of VTK 9.5.0, one turn of it between the turns of ours; where the wheel cannot be
had, its rows are left out and a message says so. Rows of one thread are processor time, which on a machine that others
use too is what the wall clock says on a quiet one. The error is the relative difference of the areas."""
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

WHEEL = "vtk==9.5.0"
RUNS = 5
SEGMENTS = 8


def fields(n):
    """Marschner-Lobb and the distance from the middle at the points of [-1, 1]^3, x fastest."""
    axis = np.linspace(-1, 1, n + 1)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    r = np.cos(12 * math.pi * np.cos(math.pi * np.hypot(x, y) / 2))
    signal = (1 - np.sin(math.pi * z / 2) + 0.25 * (1 + r)) / 2.5
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return points.astype(np.float32), signal.ravel().astype(np.float32), np.linalg.norm(points, axis=1).astype(
        np.float32)


def tetrahedra(n):
    """Kuhn's six of each cube."""
    row, plane = n + 1, (n + 1)**2
    first = np.arange((n + 1)**3).reshape(n + 1, n + 1, n + 1)[:-1, :-1, :-1].reshape(-1, 1, 1)
    steps = [(1, row, plane), (1, plane, row), (row, 1, plane), (row, plane, 1), (plane, 1, row), (plane, row, 1)]
    return (first + np.array([np.cumsum((0,) + s) for s in steps])).reshape(-1).astype(np.int64)


def save(folder, n):
    folder.mkdir(parents=True, exist_ok=True)
    for name, values in zip(("points", "signal", "distance"), fields(n)):
        np.save(folder / f"{name}{n}.npy", values)
    np.save(folder / f"tetrahedra{n}.npy", tetrahedra(n))


def load(folder, n):
    """As a vtkUnstructuredGrid, and the polygon."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import VTK_TETRA, vtkCellArray, vtkPolyData, vtkUnstructuredGrid
    read = {name: np.load(folder / f"{name}{n}.npy") for name in ("points", "signal", "distance", "tetrahedra")}
    grid, points, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(read["points"], deep=True))
    cells.SetData(4, numpy_to_vtkIdTypeArray(read["tetrahedra"], deep=True))
    grid.SetPoints(points)
    grid.SetCells(VTK_TETRA, cells)
    for name in ("signal", "distance"):
        array = numpy_to_vtk(read[name], deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)

    def polygon(radius):
        """As lines of two points, which is what vtkFiberSurface reads."""
        shape, corners, lines = vtkPolyData(), vtkPoints(), vtkCellArray()
        corners.SetDataTypeToDouble()
        for i in range(SEGMENTS + 1):
            angle = 2 * math.pi * (i % SEGMENTS) / SEGMENTS
            corners.InsertNextPoint(0.5 + radius * math.cos(angle), 0.6 + radius * math.sin(angle), 0)
        for i in range(SEGMENTS):
            lines.InsertNextCell(2, [i, i + 1])
        shape.SetPoints(corners)
        shape.SetLines(lines)
        return shape

    return grid, polygon(0.15), polygon(0.147)


def area(surface):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    x = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    t = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return 0.5 * np.linalg.norm(np.cross(x[t[:, 1]] - x[t[:, 0]], x[t[:, 2]] - x[t[:, 0]]), axis=1).sum()


def timed(algorithm, threads=1):
    clock = time.process_time_ns if threads == 1 else time.perf_counter_ns
    start = clock()
    algorithm.Update()
    return clock() - start


def peer(folder):
    """A server of turns, in the wheel's Python: a number of cells in, time, triangles and area out."""
    from vtkmodules.vtkFiltersTopology import vtkFiberSurface
    print("ready", flush=True)
    last, other = None, None
    for line in sys.stdin:
        n = int(line)
        if n != last:
            last, (grid, polygon, _) = n, load(folder, n)
            other = vtkFiberSurface()
            other.SetInputData(0, grid)
            other.SetInputData(1, polygon)
            other.SetField1("signal")
            other.SetField2("distance")
        other.Modified()
        ns = timed(other)
        print(ns, other.GetOutput().GetNumberOfCells(), float(area(other.GetOutput())), flush=True)


def start_peer(folder):
    """The other process, or None."""
    python = folder / "wheel" / "bin" / "python"
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", folder / "wheel"], check=True, stdout=sys.stderr)
            subprocess.run([python, "-m", "pip", "install", "-q", WHEEL, "numpy"], check=True, stdout=sys.stderr)
        process = subprocess.Popen([python, __file__, "--peer", folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   env={}, text=True)
        if process.stdout.readline().strip() == "ready":
            return process
    except (OSError, subprocess.CalledProcessError) as problem:
        print(problem, file=sys.stderr)
    print(f"vtkFiberSurface is left out: no virtual environment with the wheel {WHEEL}", file=sys.stderr)
    return None


def row(method, parameter, n, threads, ns, error, kind):
    print(f"fiber,tetrahedra,{method},{parameter},{n},{threads},{ns},{error:.3g},{kind}", flush=True)


def compare(folder, n, process):
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from chiaroscuro import vtkChiFiberSurface
    save(folder, n)
    grid, polygon, further = load(folder, n)
    grid.GetBounds()
    cells = grid.GetNumberOfCells()
    best, triangles, surface = {}, 0, math.nan
    theirs, their_triangles, their_area = math.inf, 0, math.nan
    for turn in range(RUNS):
        for threads in (1, 2):
            vtkSMPTools.Initialize(threads)
            ours = vtkChiFiberSurface()
            ours.SetInputData(grid)
            ours.SetPolygonData(polygon)
            ours.SetInputArrayToProcess(0, 0, 0, 0, "signal")
            ours.SetInputArrayToProcess(1, 0, 0, 0, "distance")
            first = timed(ours, threads)
            triangles, surface = ours.GetOutput().GetNumberOfCells(), area(ours.GetOutput())
            ours.SetPolygonData(further)
            kept = timed(ours, threads)
            for key, ns in (("first call", first), ("index kept", kept)):
                best[key, threads] = min(best.get((key, threads), math.inf), ns)
        if process and (n <= 64 or turn < 2):  # theirs hardly varies
            process.stdin.write(f"{n}\n")
            process.stdin.flush()
            ns, their_triangles, their_area = process.stdout.readline().split()
            theirs, their_area = min(theirs, int(ns)), float(their_area)
    difference = abs(their_area / surface - 1)
    for (key, threads), ns in best.items():
        row("vtkChiFiberSurface", f"{key} {triangles} triangles", cells, threads, ns, difference, "area against the other")
    if process:
        row("vtkFiberSurface", f"{their_triangles} triangles", cells, 1, theirs, difference, "area against the other")
    for name in ("points", "signal", "distance", "tetrahedra"):
        (folder / f"{name}{n}.npy").unlink()


def main():
    if sys.argv[1:2] == ["--peer"]:
        peer(Path(sys.argv[2]))
        return
    most = int(sys.argv[1]) if len(sys.argv) > 1 else 128
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    from vtkmodules.vtkCommonCore import vtkSMPTools
    vtkSMPTools.SetBackend("STDThread")
    with tempfile.TemporaryDirectory() as own:
        folder = Path(sys.argv[2] if len(sys.argv) > 2 else own).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        process = start_peer(folder)
        n = 32
        while n <= most:
            compare(folder, n, process)
            n *= 2
        if process:
            process.stdin.close()
            process.wait()


if __name__ == "__main__":
    main()
