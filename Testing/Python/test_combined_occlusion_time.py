# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper over many frames: data that change, settings that are toggled."""
import gc
import os
import unittest

import numpy as np
from occlusion_scene import Messages, Scene, ball, cube, float_image, sphere, volume_property
from vtkmodules.util.numpy_support import vtk_to_numpy


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@unittest.skipUnless(os.path.exists("/proc/self/statm"), "needs /proc")
class ManyFrames(unittest.TestCase):
    def grow(self, frames, step, settle=100):
        """Bytes by which `frames` calls of step let the process grow, after some to settle."""
        for i in range(settle):
            step(i)
        gc.collect()
        before = resident_bytes()
        for i in range(settle, settle + frames):
            step(i)
        gc.collect()
        return resident_bytes() - before

    def test_five_hundred_time_steps_do_not_let_memory_grow(self):
        scene = Scene((48, 48))
        volume, mapper = scene.add_volume(cube(ball(16)), volume_property(unit=0.1))
        messages = Messages(mapper, scene.window)
        scene.renderer.AddActor(sphere(0.2, (0.3, 0.2, 0.3)))
        scene.look(half=0.7)
        pictures = []

        def step(i):
            values = ball(16, 0.2 + 0.1 * np.sin(0.1 * i))
            if i % 2:  # a new object, as readers give; and the same with new values
                mapper.SetInputData(cube(values))
            else:
                scalars = mapper.GetInput().GetPointData().GetScalars()
                vtk_to_numpy(scalars)[:] = values.ravel()
                scalars.Modified()
            volume.GetProperty().GetScalarOpacity().AddPoint(1.0, 0.3 + 0.1 * np.cos(0.2 * i))
            scene.window.Render()
            if i % 50 == 0:
                pictures.append(float_image(mapper)[..., 3].sum())

        # a leak of one volume of 16^3 floats a frame, or of one picture, would be 8 or 18 MiB
        self.assertLess(self.grow(500, step), 4 << 20)
        self.assertGreater(len({round(float(p), 3) for p in pictures}), 8)  # the pictures change
        self.assertEqual(messages.errors + messages.warnings, [])

    def test_two_hundred_toggles_of_quality_size_and_selection_leak_nothing(self):
        scene = Scene((48, 48))
        _, mapper = scene.add_volume(cube(ball(16)), volume_property(unit=0.1))
        scene.renderer.AddActor(sphere(0.2, (0.3, 0.2, 0.3)))
        scene.look(half=0.7)

        def step(i):
            scene.window.SetDesiredUpdateRate(1.0e9 if i % 2 else 0.001)
            mapper.SetOcclusionStrength(float(i % 3 > 0))
            scene.window.SetSize(48 + 16 * (i % 2), 48)
            scene.window.Render()
            scene.renderer.PickProp(24, 24)
            if i % 10 == 0:
                mapper.ReleaseGraphicsResources(scene.window)

        # a leak of one texture of 48 x 48 x 4 floats a toggle would be 7 MiB
        self.assertLess(self.grow(200, step, 50), 4 << 20)


if __name__ == "__main__":
    unittest.main()
