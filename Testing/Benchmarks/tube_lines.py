# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Line sets of bench_tube_vtk.py: each a list of fine references, arrays [points, 3], and the sampled lines."""
import math

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

FINE = 16  # points of a reference for each point of its line


def integrate(field, x, step, points):
    """Stream lines from the seeds x [lines, 3] by Runge and Kutta's method of fourth order."""
    out = [x]
    for _ in range(points - 1):
        a = field(x)
        b = field(x + 0.5 * step * a)
        c = field(x + 0.5 * step * b)
        d = field(x + step * c)
        x = x + step / 6 * (a + 2 * b + 2 * c + d)
        out.append(x)
    return np.stack(out, 1)


def helices(lines, points):
    """Radius 1, pitch 2 pi 0.3, two turns: the curvature is constant, so that equal pieces are the best."""
    t = np.linspace(0, 4 * math.pi, points)
    one = np.stack([np.cos(t), np.sin(t), 0.3 * t], 1)
    shift = np.stack([3.0 * (np.arange(lines) % 50), 3.0 * (np.arange(lines) // 50), np.zeros(lines)], 1)
    return one[None] + shift[:, None]


def sphere_flow(lines, points):
    """Potential flow past the unit sphere: straight far away, bent beside it."""
    def field(p):
        r = np.linalg.norm(p, axis=1, keepdims=True)
        return np.array([1.0, 0, 0]) * (1 + 0.5 / r**3) - 1.5 * p[:, :1] * p / r**5
    yz = np.random.default_rng(1).uniform(-1.5, 1.5, (lines, 2))
    seeds = np.concatenate([np.full((lines, 1), -6.0), yz], 1)
    return integrate(field, seeds, 15 / points, points)


def abc_flow(lines, points):
    """The Arnold-Beltrami-Childress flow (A, B, C = sqrt 3, sqrt 2, 1): chaotic, bent nearly everywhere."""
    a, b = math.sqrt(3), math.sqrt(2)
    def field(p):
        x, y, z = p.T
        return np.stack([a * np.sin(z) + np.cos(y), b * np.sin(x) + a * np.cos(z), np.sin(y) + b * np.cos(x)], 1)
    return integrate(field, np.random.default_rng(1).uniform(0, 2 * math.pi, (lines, 3)), 20 / points, points)


def fibres(path):
    """The fornix's fibres in millimetres; noisy data, so that the polylines are their own reference."""
    import nibabel
    nibabel.imageglobals.logger.setLevel(40)  # the file's header names no voxel order
    lines = [np.asarray(line, float) for line in nibabel.streamlines.load(path).streamlines]
    lines = [line - lines[0].mean(0) for line in lines]
    return [refined(line, 8) for line in lines], lines


def analytic(make, lines, points):
    fine = make(lines, (points - 1) * FINE + 1)
    return list(fine), list(fine[:, ::FINE])


def poly_data(lines):
    data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    ends = np.cumsum([0] + [len(line) for line in lines])
    points.SetData(numpy_to_vtk(np.concatenate(lines).astype(np.float32), deep=True))
    cells.SetData(numpy_to_vtkIdTypeArray(ends, deep=True), numpy_to_vtkIdTypeArray(np.arange(ends[-1]), deep=True))
    data.SetPoints(points)
    data.SetLines(cells)
    return data


def polylines(data):
    ends = vtk_to_numpy(data.GetLines().GetOffsetsArray())
    ids = vtk_to_numpy(data.GetLines().GetConnectivityArray())
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return [points[ids[a:b]] for a, b in zip(ends[:-1], ends[1:])]


def refined(line, pieces):
    """Every segment cut into equal pieces."""
    w = np.arange(pieces)[:, None] / pieces
    inner = line[:-1, None] + (line[1:] - line[:-1])[:, None] * w
    return np.concatenate([inner.reshape(-1, 3), line[-1:]])


def farthest(points, line):
    """Largest distance of points [n, 3] to a polyline [m, 3]: exact to the segments beside the eight nearest vertices."""
    start, step = line[:-1], line[1:] - line[:-1]
    square = np.maximum((step * step).sum(1), 1e-300)
    worst = 0.0
    for p in np.array_split(points, len(points) // 256 + 1):
        near = (line * line).sum(1) - 2 * (p @ line.T)
        near = np.argpartition(near, min(7, len(line) - 1), axis=1)[:, :8]
        best = np.full(len(p), np.inf)
        for s in (near - 1, near):
            s = np.clip(s, 0, len(start) - 1)
            away = p[:, None] - start[s]
            w = np.clip((away * step[s]).sum(2) / square[s], 0, 1)
            away -= w[..., None] * step[s]
            best = np.minimum(best, (away * away).sum(2).min(1))
        worst = max(worst, best.max())
    return math.sqrt(worst)


def hausdorff(data, references):
    """Largest two-sided distance between the first lines of a poly data and their references."""
    worst = 0.0
    for line, fine in zip(polylines(data), references):
        middle = fine.mean(0)
        fine, line = fine - middle, refined(line - middle, 4)
        worst = max(worst, farthest(fine[::2], line), farthest(line, fine))
    return worst
