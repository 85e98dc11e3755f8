# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: colour between slices, and on its way to 8 bits."""
import unittest

import numpy as np
from occlusion_scene import Scene, cube, float_image, volume_property
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

EDGE = 65


def ramp():
    """Scalar 0 at the far end of z, 1 at the near one, a little tilted."""
    ticks = np.linspace(0.0, 1.0, EDGE)
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij", sparse=True)
    return cube(z + 0.021 * x + 0.003 * y)


def thin_peak():
    """Opacity a peak 1/100 of the range wide on either side, colours that turn 40 times."""
    prop = volume_property(unit=1.0 / (EDGE - 1))
    peak = vtkPiecewiseFunction()
    for place, opacity in ((0.0, 0.0), (0.49, 0.0), (0.5, 0.95), (0.51, 0.0), (1.0, 0.0)):
        peak.AddPoint(place, opacity)
    colors = vtkColorTransferFunction()
    for s in np.linspace(0.0, 1.0, 801):
        turn = 2.0 * np.pi * 40.0 * s
        colors.AddRGBPoint(s, *(0.5 + 0.5 * np.sin(turn + phase) for phase in (0.0, 2.0, 4.0)))
    prop.SetScalarOpacity(peak)
    prop.SetColor(colors)
    return prop


class Colour(unittest.TestCase):
    def test_one_slice_a_voxel_shows_the_colours_of_a_thin_peak(self):
        scene = Scene((96, 96))
        _, mapper = scene.add_volume(ramp(), thin_peak())
        mapper.SetOcclusionStrength(0.0)
        scene.look(half=0.4)

        def picture(rule, distance):
            mapper.SetColorIntegration(rule)
            mapper.SetSampleDistance(distance)
            scene.window.Render()
            return float_image(mapper)

        exact = picture(mapper.COLOR_PREINTEGRATED, 1.0 / (EDGE - 1) / 32)
        voxel = 1.0 / (EDGE - 1)
        pre, middle, fine = (
            255.0 * np.abs(picture(rule, distance) - exact).mean()
            for rule, distance in (
                (mapper.COLOR_PREINTEGRATED, voxel),
                (mapper.COLOR_MIDDLE, voxel),
                (mapper.COLOR_MIDDLE, voxel / 16),
            )
        )
        print(f"thin peak: pre-integrated {pre:.2f}, middle {middle:.2f}, 16 times finer {fine:.2f} of 255")
        self.assertGreater(exact[..., 3].mean(), 0.2)
        self.assertLessEqual(pre, 1.0)  # a step of 8 bits
        self.assertGreater(middle, 10.0 * pre)  # what the rule is for
        self.assertLessEqual(fine, 1.0)  # both rules lead to the same picture

    def test_the_rule_is_chosen_by_name(self):
        _, mapper = Scene((8, 8)).add_volume(ramp())
        mapper.SetColorIntegrationToMiddle()
        self.assertEqual(mapper.GetColorIntegration(), mapper.COLOR_MIDDLE)
        mapper.SetColorIntegrationToPreIntegrated()
        self.assertEqual(mapper.GetColorIntegration(), mapper.COLOR_PREINTEGRATED)

    def test_dithering_keeps_the_mean_of_8_x_8_pixels_and_is_the_same_each_time(self):
        scene = Scene((64, 64), background=(0.2, 0.2, 0.2))
        # thin fog in parallel projection: one colour in all pixels, between two steps of 8 bits
        values = np.full((9, 9, 9), 0.5, np.float32)
        prop = volume_property(opacity=0.0437, unit=1.0, colors=((0.0, (0.9, 0.4, 0.3)), (1.0, (0.9, 0.4, 0.3))))
        _, mapper = scene.add_volume(cube(values), prop)
        mapper.SetOcclusionStrength(0.0)
        scene.look(half=0.3)
        scene.renderer.SetBackground(0.0, 0.0, 0.0)
        self.assertFalse(mapper.GetDither())
        plain = 255.0 * scene.pixels()
        true = 255.0 * float_image(mapper)[..., :3]
        mapper.DitherOn()
        first, second = 255.0 * scene.pixels(), 255.0 * scene.pixels()
        self.assertEqual(np.abs(first - second).max(), 0.0)
        self.assertEqual(np.abs(float_image(mapper)[..., :3] * 255.0 - true).max(), 0.0)
        self.assertLess(np.abs(first - true).max(), 1.001)  # a pixel is never farther than a step

        def blocks(picture):
            return picture.reshape(8, 8, 8, 8, 3).mean(axis=(1, 3))

        dithered, rounded = (np.abs(blocks(p) - blocks(true)).max() for p in (first, plain))
        print(f"mean of 8 x 8 pixels: dithered {dithered:.4f}, rounded {rounded:.4f} of 255")
        self.assertLessEqual(dithered, 1.0 / 64 + 1e-3)  # 64 thresholds
        self.assertGreater(rounded, 3.0 / 64)

    def test_dithering_leaves_pixels_without_volume_alone(self):
        scene = Scene((64, 64), background=(0.3, 0.31, 0.32))
        empty = scene.pixels()
        _, mapper = scene.add_volume(cube(np.zeros((9, 9, 9), np.float32)))
        mapper.DitherOn()
        self.assertEqual(np.abs(scene.pixels() - empty).max(), 0.0)


if __name__ == "__main__":
    unittest.main()
