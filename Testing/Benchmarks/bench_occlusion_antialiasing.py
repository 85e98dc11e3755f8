#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Anti-aliasing of geometry in vtkChiCombinedOcclusionVolumeMapper, against 4 x 4 supersampling.

Bent tubes of a few pixels' width over a soft ball of fog, and over background alone, 400^2 pixels. The
camera moves by half a degree a frame; a frame ends when OpenGL has finished. Prints
topic,case,method,parameter,n,threads,min_ns,error,error_kind, the error being the mean, the root mean
square, or the 99th percentile, of the difference of colours, in units of full scale over all pixels.
The reference has 16 pixels for each, with light buffers as much finer: with occlusion, a part of the
error is theirs, so that the cases without it (strength 0) show the silhouettes alone.
"""
import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

from occlusion_scene import Scene, actor, ball, cube, volume_property  # noqa: E402
from test_combined_occlusion_antialiasing import tubes  # noqa: E402

SIZE = int(os.environ.get("CHI_BENCH_SIZE", "400"))
FRAMES = int(os.environ.get("CHI_BENCH_FRAMES", "6"))
METHODS = ("none", "multisample", "fxaa", "multisample and fxaa")


def make(size, fog, strength, mode):
    scene = Scene((size, size), background=(0.15, 0.2, 0.3))
    _, mapper = scene.add_volume(cube(ball(64)), volume_property(1.0, 0.6 if fog else 0.0, 0.2))
    mapper.SetOcclusionStrength(strength)
    mapper.SetGeometryAntiAliasing(mode)
    scene.renderer.AddActor(actor(tubes(40, 0.012), color=(0.9, 0.8, 0.6), lit=True))
    scene.look((0.3, 0.2, -1), half=0.8, parallel=False)
    return scene


def seconds(scene):
    best = np.inf
    for _ in range(FRAMES):
        scene.renderer.GetActiveCamera().Azimuth(0.5)
        start = time.perf_counter()
        scene.window.Render()
        scene.window.GetZbufferDataAtPoint(0, 0)  # waits
        best = min(best, time.perf_counter() - start)
    return best


def main():
    print("topic,case,method,parameter,n,threads,min_ns,error,error_kind")
    for fog in (True, False):
        for strength in (0.0, 1.0):
            fine = make(4 * SIZE, fog, strength, 0).pixels()
            reference = fine.reshape(SIZE, 4, SIZE, 4, 3).mean((1, 3))
            scenes = [make(SIZE, fog, strength, mode) for mode in range(4)]
            errors = [np.abs(scene.pixels() - reference) for scene in scenes]
            times = [seconds(scene) for scene in scenes]
            for method, error, best in zip(METHODS, errors, times):
                kinds = (
                    ("mean", error.mean()),
                    ("rms", np.sqrt((error**2).mean())),
                    ("p99", np.quantile(error, 0.99)),
                )
                case = "tubes over " + ("fog" if fog else "background")
                for kind, value in kinds:
                    print(
                        f"occlusion_antialiasing,{case},{method},strength {strength:g},{SIZE * SIZE},"
                        f"{os.cpu_count()},{best * 1e9:.0f},{value:.6f},{kind} to 4 x 4 samples",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
