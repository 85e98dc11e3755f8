# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: vicinity occlusion, how it is combined, the published preset."""
import unittest

import numpy as np
from occlusion_scene import Scene, cube, sphere, square, visibility_image

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


class Vicinity(unittest.TestCase):
    def step(self, **settings):
        """A square that covers the left half, 0.04 in front of another; the virtual slice is 0.1 away, and
        nearer than the light planes see by default."""
        scene = Scene((100, 100))
        _, mapper = scene.add_volume(cube(np.zeros((16, 16, 16)), 2.0))
        mapper.SetVicinityDistance(0.1 / np.sqrt(12.0))
        mapper.SetNumberOfVicinitySamples(118)
        for name, value in settings.items():
            getattr(mapper, "Set" + name)(value)
        scene.renderer.AddActor(square(2.0, 0.0))
        left = square(1.0, 0.04)
        left.SetPosition(-1.0, 0.0, 0.0)
        scene.renderer.AddActor(left)
        scene.look(half=1.0)
        scene.window.Render()
        return visibility_image(mapper).squeeze(), mapper

    def test_a_step_takes_its_share_of_the_disc(self):
        every, _ = self.step()
        none, _ = self.step(VicinityOcclusion=False)
        ratio = (every / none)[50, 50:]
        distance = np.minimum((np.arange(50) + 0.5) * 0.02 / 0.1, 1.0)
        exact = 1.0 - (np.arccos(distance) - distance * np.sqrt(1.0 - distance**2)) / np.pi
        # 118 samples of equal areas, within three areas of any half-plane's share
        self.assertLessEqual(np.abs(ratio - exact).max(), 3.0 / 118)
        self.assertLess(ratio[0], 0.6)
        self.assertEqual((every / none)[50, :50].min(), 1.0)

    def test_the_switches_that_end_it(self):
        none, _ = self.step(VicinityOcclusion=False)
        for settings in ({"NumberOfVicinitySamples": 0}, {"VicinityDistance": 0.0}):
            self.assertEqual(np.abs(self.step(**settings)[0] - none).max(), 0.0)
        self.assertEqual(self.step(GeometryToGeometry=False)[0].min(), 1.0)

    def test_minimum_is_never_darker_than_the_product(self):
        fine = {"SampleDistance": 0.01, "OcclusionBias": 0.01}  # the light planes see the step as well
        product, _ = self.step(**fine)
        minimum, _ = self.step(CombineMode=vtkChiCombinedOcclusionVolumeMapper.COMBINE_MINIMUM, **fine)
        self.assertGreaterEqual((minimum - product).min(), 0.0)
        self.assertGreater((minimum - product).max(), 0.02)

    def test_geometry_that_lets_light_through_darkens_less(self):
        fine = {"SampleDistance": 0.01, "OcclusionBias": 0.01, "VicinityOcclusion": False,
                "OcclusionResolution": vtkChiCombinedOcclusionVolumeMapper.FULL}
        every, _ = self.step(**fine)
        none, _ = self.step(GeometryOpacity=0.0, **fine)
        half, _ = self.step(GeometryOpacity=0.5, **fine)
        self.assertLess(every.min(), 0.9)
        self.assertGreaterEqual(none.min(), 1.0 - 1e-5)
        self.assertLessEqual(np.abs((1.0 - half) - 0.5 * (1.0 - every)).max(), 1e-5)

    def test_the_preset_is_that_of_the_paper(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        self.assertTrue(mapper.GetVicinityOcclusion())
        self.assertEqual(mapper.GetNumberOfVicinitySamples(), 32)
        self.assertEqual(mapper.GetVicinityDistance(), 0.005)
        mapper.SetConeAngle(25)
        mapper.VicinityOcclusionOff()
        mapper.SetCombineModeToMinimum()
        mapper.ApplyPublishedPreset()
        self.assertEqual(mapper.GetOcclusionMethod(), mapper.PUBLISHED)
        self.assertTrue(mapper.GetVicinityOcclusion())
        self.assertEqual(mapper.GetNumberOfVicinitySamples(), 81)
        self.assertEqual(mapper.GetCombineMode(), mapper.COMBINE_PRODUCT)
        self.assertEqual(mapper.GetGeometryThickness(), mapper.GetGeometryThicknessMaxValue())
        self.assertEqual(mapper.GetOcclusionBias(), 0.0)
        self.assertEqual(mapper.GetConeAngle(), 25)

    def test_setters_clamp(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        for name, low, high in (
            ("GeometryOpacity", 0.0, 1.0),
            ("VicinityDistance", 0.0, 1.0),
            ("NumberOfVicinitySamples", 0, 118),
            ("CombineMode", 0, 1),
        ):
            getattr(mapper, "Set" + name)(-7)
            self.assertEqual(getattr(mapper, "Get" + name)(), low)
            getattr(mapper, "Set" + name)(700)
            self.assertEqual(getattr(mapper, "Get" + name)(), high)
        mapper.SetVicinityDepthBias(-1.0)
        self.assertEqual(mapper.GetVicinityDepthBias(), 0.0)

    def test_a_sphere_alone_keeps_its_light(self):
        """Convex and open: the tangent plane's rule sees no blocker, the published one darkens the rim."""
        rims = []
        for bias in (0.0, 0.002):
            scene = Scene((120, 120))
            _, mapper = scene.add_volume(cube(np.zeros((16, 16, 16)), 2.0))
            mapper.SetVicinityDistance(0.02)
            mapper.SetVicinityDepthBias(bias)
            scene.renderer.AddActor(sphere(0.7))
            scene.look(half=1.0)
            scene.window.Render()
            mapper.VicinityOcclusionOff()
            every = visibility_image(mapper).squeeze()
            scene.window.Render()
            rims.append((every / visibility_image(mapper).squeeze()).min())
        self.assertGreaterEqual(rims[0], 1.0 - 1.0 / 32)  # facets at the rim: one sample
        self.assertLess(rims[1], 0.7)


if __name__ == "__main__":
    unittest.main()
