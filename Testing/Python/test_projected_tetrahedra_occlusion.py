# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: occlusion, beside vtkChiCombinedOcclusionVolumeMapper on the same image."""
import unittest

import numpy as np
from occlusion_scene import WHITE, Messages, Scene, float_image, image, square, volume_property

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper, vtkChiProjectedTetrahedraMapper

N = 28
SIZE = (96, 96)


def balls():
    """Balls whose surfaces are two voxels wide, in a cube of edge 1."""
    rng = np.random.default_rng(3)
    ticks = np.linspace(-0.5, 0.5, N)
    z, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij", sparse=True)
    values = np.zeros((N, N, N))
    for cx, cy, cz, share in rng.uniform(-1.0, 1.0, (40, 4)):
        distance = np.sqrt((x - 0.4 * cx) ** 2 + (y - 0.4 * cy) ** 2 + (z - 0.4 * cz) ** 2)
        values = np.maximum(values, np.clip((0.11 + 0.05 * share - distance) * N / 4 + 0.5, 0.0, 1.0))
    h = 1.0 / (N - 1)
    return image(values.astype(np.float32), (h, h, h), (-0.5, -0.5, -0.5))


class Balls(Scene):
    """White balls by one of the two mappers; their depths in as many slabs as the image has slices."""

    def __init__(self, kind, data, direction, parallel):
        super().__init__(SIZE)
        self.mapper = kind()
        self.mapper.SetEngine(kind.ENGINE_CPU)
        self.messages = Messages(self.mapper)
        if kind is vtkChiProjectedTetrahedraMapper:
            self.mapper.SetOpacityConventionToImage()
            self.mapper.SetPreIntegrationToFull()
        self.add_volume(data, volume_property(opacity=0.6, unit=1.0 / (N - 1), colors=WHITE), self.mapper)
        self.look(direction, half=0.75, parallel=parallel)

    def rgba(self, strength):
        self.mapper.SetOcclusionStrength(strength)
        self.window.Render()
        return float_image(self.mapper)

    def visibility(self):
        """What light leaves of white, where there is something to see."""
        dark, lit = self.rgba(0.0), self.rgba(1.0)
        assert not self.messages.errors and not self.messages.warnings
        return np.where(dark[..., 0] > 0.05, lit[..., 0] / np.maximum(dark[..., 0], 1e-6), np.nan)


class Occlusion(unittest.TestCase):
    def test_is_that_of_the_volume_mapper_in_as_many_slabs(self):
        data = balls()
        for direction in ((0, 0, -1), (-0.4, -0.5, -1.0)):
            for parallel in (True, False):
                with self.subTest(direction=direction, parallel=parallel):
                    volume = Balls(vtkChiCombinedOcclusionVolumeMapper, data, direction, parallel)
                    wanted = volume.visibility()
                    mesh = Balls(vtkChiProjectedTetrahedraMapper, data, direction, parallel)
                    mesh.mapper.SetNumberOfOcclusionSlabs(int(volume.mapper.GetNumberOfSlices()))
                    found = mesh.visibility()
                    both = np.isfinite(wanted) & np.isfinite(found)
                    self.assertGreater(both.sum(), 1000)
                    self.assertLess(wanted[both].mean(), 0.8) # there is something to agree about
                    # asked: 0.02
                    self.assertLess(np.abs(wanted - found)[both].mean(), 0.02)

    def test_does_not_depend_on_the_number_of_slabs(self):
        scene = Balls(vtkChiProjectedTetrahedraMapper, balls(), (-0.4, -0.5, -1.0), False)
        pictures = []
        for slabs in (64, 128, 256):
            scene.mapper.SetNumberOfOcclusionSlabs(slabs)
            pictures.append(255.0 * scene.rgba(1.0)[..., 0])
        for other in pictures[:2]:
            shown = pictures[2] > 12.0
            difference = np.abs(other - pictures[2])[shown]
            self.assertLess(difference.mean(), 3.0) # asked
            self.assertLess(np.quantile(difference, 0.9), 3.0)

    def test_is_off_at_strength_zero_to_the_bit(self):
        scene = Balls(vtkChiProjectedTetrahedraMapper, balls(), (-0.4, -0.5, -1.0), False)
        scene.window.Render()
        self.assertEqual(scene.mapper.GetOcclusionStrength(), 0.0)
        off = float_image(scene.mapper)
        lit = scene.rgba(1.0)
        self.assertGreater(scene.mapper.GetSecondsLight(), 0.0)
        self.assertGreater(scene.mapper.GetOcclusionBytes(), 0)
        again = scene.rgba(0.0)
        self.assertTrue(np.array_equal(off, again))
        self.assertGreater(np.abs(lit - off).max(), 0.2)
        self.assertEqual(scene.mapper.GetSecondsLight(), 0.0)

    def test_every_parameter_tells(self):
        scene = Balls(vtkChiProjectedTetrahedraMapper, balls(), (-0.4, -0.5, -1.0), False)
        whole = scene.rgba(1.0)
        mapper = scene.mapper
        for change, back in (
            (lambda: mapper.SetConeAngle(15.0), lambda: mapper.SetConeAngle(45.0)),
            (lambda: mapper.SetNumberOfDirections(4), lambda: mapper.SetNumberOfDirections(16)),
            (lambda: mapper.SetNumberOfOcclusionSlabs(20), lambda: mapper.SetNumberOfOcclusionSlabs(128)),
            (lambda: mapper.SetOcclusionBias(0.3), lambda: mapper.SetOcclusionBias(-1.0)),
            (mapper.SetOcclusionResolutionToFull, mapper.SetOcclusionResolutionToHalf),
        ):
            change()
            self.assertGreater(np.abs(scene.rgba(1.0) - whole).max(), 0.01)
            back()
            self.assertTrue(np.array_equal(scene.rgba(1.0), whole))
        half = scene.rgba(0.5)
        dark = scene.rgba(0.0)
        # light enters linearly; both differ by the cuts at slabs, which pre-integration makes alike
        self.assertLess(np.abs(half - 0.5 * (whole + dark)).max(), 0.01)

    def test_is_drawn_by_the_cpu_engine_which_says_so(self):
        scene = Balls(vtkChiProjectedTetrahedraMapper, balls(), (0, 0, -1), True)
        scene.mapper.SetEngine(vtkChiProjectedTetrahedraMapper.ENGINE_OPENGL)
        lit = scene.rgba(1.0)
        self.assertEqual(scene.mapper.GetEngineInUse(), vtkChiProjectedTetrahedraMapper.ENGINE_CPU)
        self.assertIn("occlusion", scene.mapper.GetEngineReason())
        self.assertEqual(len(scene.messages.warnings), 1)
        scene.mapper.SetEngine(vtkChiProjectedTetrahedraMapper.ENGINE_CPU)
        self.assertTrue(np.array_equal(scene.rgba(1.0), lit))

    def test_geometry_takes_light_of_what_lies_beside_and_behind(self):
        def brightness(with_plate):
            scene = Balls(vtkChiProjectedTetrahedraMapper, balls(), (0, 0, -1), True)
            if with_plate:
                plate = square(0.5, 0.55)
                plate.SetPosition(-0.5, 0.0, 0.0) # before the left half
                scene.renderer.AddActor(plate)
            return scene.rgba(1.0)[..., 0]

        free, shaded = brightness(False), brightness(True)
        right = slice(SIZE[0] // 2 + 1, SIZE[0] // 2 + 12)
        self.assertLess(shaded[:, right].sum(), 0.9 * free[:, right].sum())
        self.assertEqual(shaded[:, : SIZE[0] // 2 - 1].max(), 0.0)


if __name__ == "__main__":
    unittest.main()
