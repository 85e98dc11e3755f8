#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run time against error of the engines as VTK's users have them: bench_occlusion_error_vtk.py FOLDER

The four scenes of bench_occlusion_error, drawn by vtkChiCombinedOcclusionVolumeMapper at one pixel and one slice
a voxel, and judged by the exact pixels and the exact visibility of geometry that it has left in FOLDER: by the CPU
engine, by OpenGL with light buffers of 32 and of 16 bits. Fibres are tubes of 16 sides, the exact ones capsules.
Prints topic,case,method,parameter,n,threads,min_ns,error,error_kind: the parameter is the number of directions;
..._to_cpu is the difference from the CPU engine's picture, over all pixels. A frame ends when OpenGL has finished.
"""
import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

from occlusion_scene import WHITE, Scene, actor, float_image, image, square, visibility_image, volume_property  # noqa: E402
from tube_lines import poly_data  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkSMPTools  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkImageData  # noqa: E402

from chiaroscuro import vtkChiStreamTubes  # noqa: E402
from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper as Mapper  # noqa: E402

SIZE = 128
MIDDLE = 0.5 * (SIZE - 1)
NAMES = ("half-plane", "balls", "brain", "brain with fibres")
RANGES = (8.0, 4.5, 0.6, 0.6)  # largest extinctions a voxel
FRAMES = 3  # and one before: OpenGL in software takes up to a second a frame
THREADS = os.cpu_count()
ENGINES = (
    ("chi-cpu", Mapper.ENGINE_CPU, Mapper.SINGLE_FLOAT),
    ("chi-opengl-32-bits", Mapper.ENGINE_OPENGL, Mapper.SINGLE_FLOAT),
    ("chi-opengl-16-bits", Mapper.ENGINE_OPENGL, Mapper.HALF_FLOAT),
)


def extinction_property(largest):
    """Scalars are the extinction of a voxel of white matter."""
    prop = volume_property(largest, 0.0, 1.0, WHITE)
    opacity = prop.GetScalarOpacity()
    opacity.RemoveAllPoints()
    for sigma in np.linspace(0.0, largest, 2049):
        opacity.AddPoint(sigma, -np.expm1(-sigma))
    return prop


def fibres(folder):
    """Tubes about the fibres, z towards the eye."""
    points = np.fromfile(f"{folder}/fibres128.raw", "<f4").reshape(-1, 3)
    ends = np.flatnonzero(np.isnan(points[:, 0]))
    lines = [part[~np.isnan(part[:, 0])] for part in np.split(points, ends)]
    lines = [(line - MIDDLE) * (1, 1, -1) for line in lines if len(line) > 1]
    tubes = vtkChiStreamTubes()
    tubes.SetInputData(poly_data(lines))
    tubes.SplineFittingOff()
    tubes.SetNumberOfSides(16)
    tubes.RadiusIsRelativeOff()
    tubes.SetRadius(0.8)
    return actor(tubes)


class Judged:
    """A scene with what is exact of some of its pixels."""

    def __init__(self, which, folder):
        self.name = NAMES[which]
        values = np.fromfile(f"{folder}/occlusion_error_{which}.raw", "<f4").reshape((SIZE,) * 3)
        exact = np.loadtxt(f"{folder}/occlusion_error_{which}.csv", delimiter=",")
        self.pixels = tuple(exact[:, 1::-1].astype(int).T)  # y, x
        self.exact = {"dV": exact[:, 3], "picture": exact[:, 2]}
        self.scene = Scene((SIZE, SIZE))
        self.volume, _ = self.scene.add_volume(image(values[::-1]), extinction_property(RANGES[which]))
        self.data = self.volume.GetMapper().GetInput()
        if which == 0:  # the wall behind, at voxel 64
            self.scene.renderer.AddActor(square(2 * SIZE, MIDDLE - 64))
        if which == 3:
            self.scene.renderer.AddActor(fibres(folder))
        self.scene.look(half=0.5 * SIZE)

    def draw(self, mapper):
        """Shortest frame in nanoseconds; visibility of geometry and picture of white things over black."""
        mapper.SetInputData(self.data)
        self.volume.SetMapper(mapper)
        times = []
        for frame in range(FRAMES + 1):
            mapper.SetOcclusionBias(-1.0 - (frame & 1))  # both mean the default, and the frame is drawn anew
            begin = time.perf_counter_ns()
            self.scene.window.Render()
            self.scene.window.WaitForCompletion()
            times.append(time.perf_counter_ns() - begin)
        rgba, seen, surface = float_image(mapper), visibility_image(mapper), vtkImageData()
        picture = rgba[..., 0].copy()
        if mapper.GetGeometryImage(surface):
            hit = np.isfinite(vtk_to_numpy(surface.GetPointData().GetArray("Depth"))).reshape(picture.shape)
            picture += np.where(hit, (1.0 - rgba[..., 3]) * seen, 0.0)
            seen = np.where(hit, seen, np.nan)
        else:
            seen = np.full_like(picture, np.nan)
        return min(times[1:]), {"dV": seen, "picture": picture}


def print_errors(case, method, directions, nanoseconds, difference, what):
    """Of what is known in both; 1 is full scale."""
    size = np.abs(difference[np.isfinite(difference)])
    if size.size:
        kinds = {"mean": size.mean(), "rms": np.sqrt((size**2).mean()), "p99": np.percentile(size, 99.0)}
        for kind, value in kinds.items():
            print(f"occlusion_error,{case},{method},{directions},{SIZE**3},{THREADS},{nanoseconds},{value:.3g},"
                  f"{kind}_{what}", flush=True)


def main():
    folder = sys.argv[1]
    vtkSMPTools.SetBackend("STDThread")
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    for which in range(len(NAMES)):
        judged = Judged(which, folder)
        for resolution, size in ((Mapper.FULL, "full"), (Mapper.HALF, "half")):
            for directions in (16, 64):
                by_cpu = None
                for method, engine, precision in ENGINES:
                    mapper = Mapper()
                    mapper.SetEngine(engine)
                    mapper.SetLightPrecision(precision)
                    mapper.SetNumberOfDirections(directions)
                    mapper.SetOcclusionResolution(resolution)
                    mapper.VicinityOcclusionOff()
                    mapper.SetGeometryAntiAliasingToNone()
                    time_ns, drawn = judged.draw(mapper)
                    if mapper.GetEngineInUse() != engine:
                        sys.exit(f"{judged.name}, {method}: {mapper.GetEngineReason()}")
                    by_cpu = by_cpu or drawn
                    for what, exact in judged.exact.items():
                        difference = drawn[what][judged.pixels] - exact
                        print_errors(judged.name, f"{method}-{size}-1", directions, time_ns, difference, f"{what}_vtk")
                        if engine != Mapper.ENGINE_CPU:
                            difference = drawn[what] - by_cpu[what]
                            print_errors(judged.name, f"{method}-{size}-1", directions, time_ns, difference, f"{what}_to_cpu")


if __name__ == "__main__":
    main()
