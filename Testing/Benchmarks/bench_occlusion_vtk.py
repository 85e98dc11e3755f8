#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames a second of vtkChiCombinedOcclusionVolumeMapper and of vtkGPUVolumeRayCastMapper.

Marschner-Lobb 256^3 of unsigned char, 512^2 pixels, one slice a voxel. The camera moves by one degree
a frame; a frame ends when OpenGL has finished, so that ours includes read-back and compositing. Rows
"unchanged" repeat a frame in which nothing changed. Prints
topic,case,method,parameter,n,threads,min_ns,error,error_kind, where the error is the mean absolute
difference to the picture of 64 directions and full-size light buffers, for peers to our unshaded
picture at a tenth of a voxel, in units of full scale over the pixels that the volume covers. Rows
"with gradients" are lit by the renderer's headlight as well (vtkVolumeProperty::ShadeOn), and
compared with pictures that are.
"""
import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

from occlusion_scene import Scene, marschner_lobb, volume_property  # noqa: E402
from vtkmodules.vtkCommonCore import vtkSMPTools  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction  # noqa: E402
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper  # noqa: E402

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper  # noqa: E402

N = int(os.environ.get("CHI_BENCH_N", "256"))
SIZE = int(os.environ.get("CHI_BENCH_SIZE", "512"))
FRAMES = int(os.environ.get("CHI_BENCH_FRAMES", "6"))
VOXEL = 2.0 / (N - 1)
THREADS = os.cpu_count()


def classification(case):
    """Fog: 0.02 a voxel everywhere. Shells: 0.4 a voxel for values 101 ... 111, nothing elsewhere."""
    prop = volume_property(255.0, 0.02, VOXEL)
    ramp = vtkPiecewiseFunction()
    for place, opacity in ((0, 0.0), (100, 0.0), (101, 0.4), (111, 0.4), (112, 0.0), (255, 0.0)):
        ramp.AddPoint(place, 0.02 if case == "fog" else opacity)
    prop.SetScalarOpacity(ramp)
    return prop


def peer(step):
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetSampleDistance(step)
    mapper.UseJitteringOff()
    return mapper


class Run:
    def __init__(self, data, mapper, prop):
        self.scene = Scene((SIZE, SIZE))
        self.scene.add_volume(data, prop, mapper)
        self.mapper = mapper
        renderer = self.scene.renderer
        renderer.ResetCamera()
        self.camera = renderer.GetActiveCamera()
        self.camera.Azimuth(30)
        self.camera.Elevation(20)
        self.camera.Zoom(1.4)
        self.start = self.camera.GetPosition()

    def frame(self):
        begin = time.perf_counter_ns()
        self.scene.window.Render()
        self.scene.window.WaitForCompletion()
        return time.perf_counter_ns() - begin

    def next_frame(self):
        self.camera.Azimuth(1)
        self.scene.renderer.ResetCameraClippingRange()
        return self.frame()

    def unchanged(self):
        self.frame()
        return min(self.frame() for _ in range(FRAMES))

    def picture(self):
        """The picture of the first view."""
        self.camera.SetPosition(self.start)
        self.scene.renderer.ResetCameraClippingRange()
        return self.scene.pixels()


def error(picture, reference):
    covered = (reference.max(axis=2) > 0) | (picture.max(axis=2) > 0)
    return np.abs(picture - reference)[covered].mean()


def row(case, method, parameter, nanoseconds, value, kind):
    print(f"occlusion_vtk,{case},{method},{parameter},{N},{THREADS},{nanoseconds},{value:.6f},{kind}", flush=True)


def race(runs, frames=FRAMES):
    """Smallest time of each, one frame of each in turn, so that all see the same noise."""
    for run in runs:
        run.frame()  # shaders, textures, bricks
    times = [[run.next_frame() for run in runs] for _ in range(frames)]
    return np.min(times, axis=0)


def describe(case, name, mapper):
    print(
        f"# {case} {name}: samples {mapper.GetNumberOfSamples()} skipped {mapper.GetNumberOfSkippedSamples()}"
        f" light {mapper.GetNumberOfLightUpdates()} skipped {mapper.GetNumberOfSkippedLightUpdates()}"
        f" seconds: engine {mapper.GetSecondsEngine():.4f} slices {mapper.GetSecondsSlices():.4f}"
        f" composite {mapper.GetSecondsComposite():.4f} total {mapper.GetSecondsTotal():.4f}",
        file=sys.stderr,
    )


def main():
    vtkSMPTools.SetBackend("STDThread")
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    data = marschner_lobb(N, np.uint8)
    for case in sys.argv[1:] or ["fog", "shells"]:
        prop = classification(case)

        lit = classification(case)
        lit.ShadeOn()

        def ours(directions=16, full=False, strength=1.0, step=0.0, material=prop):
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            mapper.SetNumberOfDirections(directions)
            mapper.SetOcclusionStrength(strength)
            mapper.SetSampleDistance(step)
            if full:
                mapper.SetOcclusionResolutionToFull()
            return Run(data, mapper, material)

        shaded = ours(64, True).picture()
        unshaded = ours(strength=0.0, step=0.1 * VOXEL).picture()
        lit_shaded = ours(64, True, material=lit).picture()
        lit_unshaded = ours(strength=0.0, step=0.1 * VOXEL, material=lit).picture()
        to_shaded, to_unshaded = "mean_abs_to_64_full", "mean_abs_to_unshaded"
        runs = [
            ("chi", "16 directions half", ours(16), shaded, to_shaded),
            ("chi", "8 directions half", ours(8), shaded, to_shaded),
            ("chi", "16 directions full", ours(16, True), shaded, to_shaded),
            ("chi", "strength 0", ours(strength=0.0), unshaded, to_unshaded),
            ("vtkGPUVolumeRayCastMapper", "unshaded", Run(data, peer(VOXEL), prop), unshaded, to_unshaded),
            ("chi", "16 directions half with gradients", ours(16, material=lit), lit_shaded, to_shaded),
            ("chi", "strength 0 with gradients", ours(strength=0.0, material=lit), lit_unshaded, to_unshaded),
            ("vtkGPUVolumeRayCastMapper", "with gradients", Run(data, peer(VOXEL), lit), lit_unshaded, to_unshaded),
        ]
        times = race([run for _, _, run, _, _ in runs])
        for (method, parameter, run, reference, kind), time_ns in zip(runs, times):
            if method == "chi":
                describe(case, parameter, run.mapper)
            row(case, method, parameter, time_ns, error(run.picture(), reference), kind)
        run = runs[0][2]
        row(case, "chi", "16 directions half unchanged", run.unchanged(), error(run.picture(), shaded), to_shaded)

        # half a minute a frame, and since VTK 9.2 only
        if case == "fog" and hasattr(vtkOpenGLGPUVolumeRayCastMapper, "SetVolumetricScatteringBlending"):
            mapper = peer(VOXEL)
            mapper.SetGlobalIlluminationReach(1.0)
            mapper.SetVolumetricScatteringBlending(2.0)
            run = Run(data, mapper, lit)
            # its shading is another model: its time counts, not its difference to ours
            time_ns = min(run.next_frame() for _ in range(5))
            row(case, "vtkGPUVolumeRayCastMapper", "volumetric shadows", time_ns, float("nan"), "none")


if __name__ == "__main__":
    main()
