#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames a second of vtkChiCombinedOcclusionVolumeMapper and of vtkGPUVolumeRayCastMapper.

Marschner-Lobb 256^3 of unsigned char, 512^2 pixels, one slice a voxel. The camera moves by one degree
a frame; a frame ends when OpenGL has finished, so that ours includes read-back and compositing. Rows
"unchanged" repeat a frame in which nothing changed. Prints
topic,case,method,parameter,n,threads,min_ns,error,error_kind, where the error is the mean absolute
difference to the picture of 64 directions and full-size light buffers, for peers to our unshaded
picture at a tenth of a voxel, in units of full scale over the pixels that the volume covers.
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

    def moving(self, frames=FRAMES, warm_up=True):
        if warm_up:
            self.frame()  # shaders, textures, bricks
        times = []
        for _ in range(frames):
            self.camera.Azimuth(1)
            self.scene.renderer.ResetCameraClippingRange()
            times.append(self.frame())
        return min(times)

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


def main():
    vtkSMPTools.SetBackend("STDThread")
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    data = marschner_lobb(N, np.uint8)
    only = sys.argv[1:] or ["fog", "shells"]
    for case in only:
        prop = classification(case)

        def ours(directions=16, full=False, strength=1.0, step=0.0):
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            mapper.SetNumberOfDirections(directions)
            mapper.SetOcclusionStrength(strength)
            mapper.SetSampleDistance(step)
            if full:
                mapper.SetOcclusionResolutionToFull()
            return Run(data, mapper, prop)

        shaded = ours(64, True).picture()
        unshaded = ours(strength=0.0, step=0.1 * VOXEL).picture()
        for directions, full in ((16, False), (8, False), (16, True)):
            run = ours(directions, full)
            name = f"{directions} directions {'full' if full else 'half'}"
            nanoseconds = run.moving()
            mapper = run.mapper
            print(
                f"# {case} {name}: samples {mapper.GetNumberOfSamples()} skipped {mapper.GetNumberOfSkippedSamples()}"
                f" light {mapper.GetNumberOfLightUpdates()} skipped {mapper.GetNumberOfSkippedLightUpdates()}"
                f" seconds: engine {mapper.GetSecondsEngine():.4f} slices {mapper.GetSecondsSlices():.4f}"
                f" composite {mapper.GetSecondsComposite():.4f} total {mapper.GetSecondsTotal():.4f}",
                file=sys.stderr,
            )
            row(case, "chi", name, nanoseconds, error(run.picture(), shaded), "mean_abs_to_64_full")
            if directions == 16 and not full:
                row(case, "chi", name + " unchanged", run.unchanged(), error(run.picture(), shaded), "mean_abs_to_64_full")
        run = ours(strength=0.0)
        row(case, "chi", "strength 0", run.moving(), error(run.picture(), unshaded), "mean_abs_to_unshaded")

        run = Run(data, peer(VOXEL), prop)
        row(
            case, "vtkGPUVolumeRayCastMapper", "unshaded", run.moving(), error(run.picture(), unshaded), "mean_abs_to_unshaded"
        )
        # half a minute a frame, and since VTK 9.2 only
        if case == "fog" and hasattr(vtkOpenGLGPUVolumeRayCastMapper, "SetVolumetricScatteringBlending"):
            mapper = peer(VOXEL)
            mapper.SetGlobalIlluminationReach(1.0)
            mapper.SetVolumetricScatteringBlending(2.0)
            lit = classification(case)
            lit.ShadeOn()
            run = Run(data, mapper, lit)
            # its shading is another model: its time counts, not its difference to ours
            row(case, "vtkGPUVolumeRayCastMapper", "volumetric shadows", run.moving(5, False), float("nan"), "none")


if __name__ == "__main__":
    main()
