# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whole frames of vtkChiProjectedTetrahedraMapper beside vtkProjectedTetrahedraMapper, in turn in one run.

    bench_tet_vtk [SIZE | delaunay | holes]... [FOLDER]

Marschner & Lobb's test signal on n^3 cubes, split by chi_grid into one vtkUnstructuredGrid that both are
given; 512^2 pixels, the camera turns by 3 degrees a frame; no shading, no opaque geometry, no transparent
cell. The same on a Delaunay mesh of scattered points (kept in FOLDER), and on cubes with moved points out of
which balls are cut. CSV as the other benchmarks'; errors are of the float picture against tetrahedra drawn
without any skipping and with the full table. "once a mesh": split into tetrahedra and analysis of the order.
"""
import sys
import time
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_TETRA
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPiecewiseFunction, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkDelaunay3D
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import vtkProjectedTetrahedraMapper

from chiaroscuro import vtkChiProjectedTetrahedraMapper

SIZES = (32, 55, 94, 118)  # 0.2, 1, 5 and 10 million tetrahedra
ORDERS = ("automatic", "centroid", "keys", "MPVO", "XMPVO")  # GetUsedVisibilityOrder
PATHS = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))


def signal_at(places):
    x, y, z = places.T
    radius = np.sqrt(x * x + y * y)
    return (1 - np.sin(np.pi * z / 2) + 0.25 * (1 + np.cos(12 * np.pi * np.cos(np.pi * radius / 2)))) / 2.5


def cubes(n):
    """Points and tetrahedra as chi_grid splits an image: six paths along the axes in every cube."""
    ticks = np.linspace(-1.0, 1.0, n + 1)
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij")
    steps = (1, n + 1, (n + 1) ** 2)
    k, j, i = np.meshgrid(*(np.arange(n),) * 3, indexing="ij")
    first = (i + steps[1] * j + steps[2] * k).ravel()
    last = first + sum(steps)
    cells = np.stack(
        [np.stack([first, first + steps[a], first + steps[a] + steps[b], last], -1) for a, b, _ in PATHS], 1
    ).reshape(-1, 4)
    return np.stack([x, y, z], -1).reshape(-1, 3), cells


def make_grid(places, cells):
    points, connectivity, grid = vtkPoints(), vtkCellArray(), vtkUnstructuredGrid()
    points.SetData(numpy_to_vtk(places.astype(np.float32), deep=True))
    connectivity.SetData(
        numpy_to_vtkIdTypeArray(np.arange(0, 4 * len(cells) + 1, 4), deep=True),
        numpy_to_vtkIdTypeArray(cells.ravel(), deep=True),
    )
    grid.SetPoints(points)
    grid.SetCells(VTK_TETRA, connectivity)
    scalars = numpy_to_vtk(signal_at(places).astype(np.float32), deep=True)
    scalars.SetName("signal")
    grid.GetPointData().SetScalars(scalars)
    return grid


def delaunay(folder):
    """0.2 million tetrahedra between scattered points and the corners of the cube."""
    kept = folder / "delaunay_tetrahedra.npz" if folder else None
    if kept and kept.exists():
        with np.load(kept) as arrays:
            return make_grid(arrays["places"], arrays["cells"])
    corners = np.stack(np.meshgrid(*((-1.0, 1.0),) * 3), -1).reshape(-1, 3)
    places = np.concatenate([corners, np.random.default_rng(1).uniform(-1, 1, (31000, 3))]).astype(np.float32)
    points, given, mesher = vtkPoints(), vtkUnstructuredGrid(), vtkDelaunay3D()
    points.SetData(numpy_to_vtk(places, deep=True))
    given.SetPoints(points)
    mesher.SetInputData(given)
    mesher.Update()
    cells = vtk_to_numpy(mesher.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 4)
    if kept:
        np.savez_compressed(kept, places=places, cells=cells)
    return make_grid(places, cells)


def holes():
    """0.2 million tetrahedra of cubes whose inner points are moved by up to 0.2 edges, less 20 balls."""
    n, lot = 34, np.random.default_rng(2)
    places, cells = cubes(n)
    centers = places[cells].mean(axis=1)
    for center in lot.uniform(-0.9, 0.9, (20, 3)):
        keep = np.linalg.norm(centers - center, axis=1) > 0.22
        cells, centers = cells[keep], centers[keep]
    moved = lot.uniform(-0.4 / n, 0.4 / n, places.shape)
    return make_grid(places + np.where(np.abs(places) < 1, moved, 0.0), cells)


def set_functions(prop, weight=1.0):
    """That of the issue's scene; `weight` moves it a little."""
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for place, rgb in ((0.0, (0, 0, 1)), (0.5, (0, 1, 0)), (1.0, (1, 0, weight - 1.0))):
        color.AddRGBPoint(place, *rgb)
    for place, value in ((0.0, 0.05 * weight), (0.5, 0.4), (1.0, 0.9)):
        opacity.AddPoint(place, value)
    prop.SetColor(color)
    prop.SetScalarOpacity(opacity)


class Scene:
    def __init__(self, mapper, grid):
        self.mapper, self.window, self.renderer = mapper, vtkRenderWindow(), vtkRenderer()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(512, 512)
        self.window.AddRenderer(self.renderer)
        mapper.SetInputData(grid)
        self.volume = vtkVolume()
        self.volume.SetMapper(mapper)
        set_functions(self.volume.GetProperty())
        self.volume.GetProperty().SetScalarOpacityUnitDistance(1.0)
        self.volume.GetProperty().SetInterpolationTypeToLinear()
        self.renderer.AddVolume(self.volume)
        azimuth, elevation = np.radians(30.0), np.radians(25.0)
        way = np.array([np.cos(elevation) * np.sin(azimuth), np.sin(elevation), np.cos(elevation) * np.cos(azimuth)])
        camera = self.renderer.GetActiveCamera()
        camera.SetViewAngle(30.0)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetPosition(*(6.6921 * way))
        self.renderer.ResetCameraClippingRange()

    def frame(self):
        """Seconds of Render() and of waiting for the picture."""
        start = time.perf_counter()
        self.window.Render()
        self.window.WaitForCompletion()
        return time.perf_counter() - start

    def turn(self):
        self.renderer.GetActiveCamera().Azimuth(3.0)
        return self.frame()

    def pixels(self):
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(float)


def row(case, method, parameter, n, seconds, error="", kind=""):
    size = f"{n / 1e6:.1f} M"
    print(f"tet,{case} {size},{method},{parameter},{n},2,{1e9 * seconds:.0f},{error},{kind}", flush=True)


def bench(case, grid):
    count = grid.GetNumberOfCells()
    rounds = 7 if count < 2e6 else 4 if count < 8e6 else 2
    ours, peer = Scene(vtkChiProjectedTetrahedraMapper(), grid), Scene(vtkProjectedTetrahedraMapper(), grid)
    ours.mapper.SetPreIntegrationToPartial()
    row(case + "first frame", "chiaroscuro", "analysis and all", count, ours.frame())
    row(case + "once a mesh", "chiaroscuro", "split and order", count, ours.mapper.GetSecondsSplit() + ours.mapper.GetSecondsOrder())
    row(case + "first frame", "VTK", "all", count, peer.frame())
    moving = [(ours.turn(), ours.turn(), peer.turn(), peer.renderer.GetActiveCamera().Azimuth(3.0)) for _ in range(rounds)]
    ours.frame(), peer.frame()
    best, least = min(min(m[0], m[1]) for m in moving), min(m[2] for m in moving)
    order = ORDERS[ours.mapper.GetUsedVisibilityOrder()]
    fragments = ours.mapper.GetNumberOfFragments()

    reference = Scene(vtkChiProjectedTetrahedraMapper(), grid)
    reference.mapper.SetPreIntegrationToFull()
    reference.mapper.SkippingOff()
    reference.renderer.SetActiveCamera(ours.renderer.GetActiveCamera())
    reference.frame()
    wanted = vtkImageData()
    reference.mapper.GetFloatImage(wanted)
    wanted = 255.0 * vtk_to_numpy(wanted.GetPointData().GetScalars())[:, :3]
    peer.renderer.SetActiveCamera(ours.renderer.GetActiveCamera())
    peer.frame()
    covered = wanted.max(axis=1) > 0
    for name, scene, seconds in (("chiaroscuro", ours, best), ("VTK", peer, least)):
        error = np.abs(scene.pixels() - wanted)[covered].mean()
        row(case + "moving camera", name, f"partial; order {order}" if scene is ours else "", count, seconds, f"{error:.4f}", "mean of 255")

    changed = {}
    for name, scene, limit in (("VTK", peer, 0), ("chiaroscuro", ours, 0), ("chiaroscuro with kept fragments", ours, 1024)):
        if scene is ours:
            ours.mapper.SetFragmentCacheLimit(limit)
        times = []
        for i in range((3 if rounds > 2 else 1) if scene is peer else 6):
            set_functions(scene.volume.GetProperty(), 1.0 + 0.01 * (i + 1))
            times.append(scene.frame())
        changed[name] = min(times)
        row(case + "transfer function", name, "", count, changed[name])
    for name, scene in (("chiaroscuro", ours), ("VTK", peer)):
        row(case + "nothing changed", name, "", count, min(scene.frame() for _ in range(rounds if rounds < 3 else 3)))
    held = (ours.mapper.GetMeshBytes() + ours.mapper.GetFrameBytes()) / count
    print(f"# {case}{count} tetrahedra, order {order}, {fragments / 1e6:.1f} M fragments: moving {1e3 * best:.0f} ms, {least / best:.1f} x, transfer function {changed['VTK'] / changed['chiaroscuro']:.1f} x, "
          f"fragments kept {changed['VTK'] / changed['chiaroscuro with kept fragments']:.1f} x; {held:.1f} bytes a tetrahedron", file=sys.stderr)


def main():
    names = [a for a in sys.argv[1:] if a.isdigit() or a in ("delaunay", "holes")]
    folder = next((Path(a) for a in sys.argv[1:] if a not in names), None)
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    for name in names or [*map(str, SIZES), "delaunay", "holes"]:
        grid = delaunay(folder) if name == "delaunay" else holes() if name == "holes" else make_grid(*cubes(int(name)))
        bench("" if name.isdigit() else name + " ", grid)


if __name__ == "__main__":
    main()
