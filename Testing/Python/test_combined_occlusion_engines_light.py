# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The engines' pictures where pixels are fewer or shared: reduced pictures."""
import unittest

from engine_agreement import CPU, OPENGL, SCENE, Agreement, differences, fog, render, shells, tubes, visibility_of
from occlusion_scene import float_image

STILL, FASTEST = 0.001, 1.0e9  # frames a second that are wished


class ReducedPictures(Agreement):
    SIZE = 160  # 40 pixels are left at the least: as many as full pictures have elsewhere

    def frames(self, engine, content, **options):
        """Picture and visibility of interactive frames, by the reduction 4, 3, 2 that they use.

        Which one it is the mapper chooses by the time that the last frames took, but for the first one.
        So the wished rate is raised and lowered, with slices two voxels apart in all, until it comes.
        """

        def hurry(scene):
            scene.window.SetDesiredUpdateRate(FASTEST)

        found = {}
        rate = FASTEST
        try:
            _, _, mapper = render(engine, content, look=hurry, size=self.SIZE, **options)
            widest = mapper.GetUsedSampleDistance()
            for reduction in (4, 3, 2):
                for _ in range(300):
                    self.assertEqual(mapper.GetEngineInUse(), engine, mapper.GetEngineReason())
                    used = mapper.GetUsedImageReduction(), mapper.GetUsedSampleDistance()
                    if used == (reduction, widest):
                        found[reduction] = float_image(mapper), visibility_of(mapper)
                        break
                    rate *= 0.6 if used[0] > reduction else 1.3
                    SCENE.window.SetDesiredUpdateRate(rate)
                    SCENE.window.Render()
        finally:
            SCENE.window.SetDesiredUpdateRate(STILL)
        self.assertEqual(list(found), [4, 3, 2])
        return found

    def check_reduced(self, content, **options):
        cpu = self.frames(CPU, content, **options)
        gpu = self.frames(OPENGL, content, **options)
        full = render(OPENGL, content, size=self.SIZE, **options)[:2]
        for reduction in cpu:
            for name, a, b, whole in zip(("picture", "visibility"), cpu[reduction], gpu[reduction], full):
                with self.subTest(reduction=reduction, name=name):
                    where = a[..., 3] > 0.0 if name == "picture" else a < 1.0
                    mean, most = differences(a, b, where)
                    print(f"reduction {reduction} {name}: mean {mean:.4f}, 99 % {most:.4f} of 255")
                    self.assertLessEqual(mean, self.MEAN)
                    self.assertLessEqual(most, self.PERCENTILE_99)
                    if where.any():  # the full picture would not do
                        self.assertGreater(differences(a, whole, where)[1], 2.0 * self.PERCENTILE_99)

    def test_fog_and_shells(self):
        for content in (fog, shells):
            for parallel in (False, True):
                with self.subTest(content=content.__name__, parallel=parallel):
                    self.check_reduced(content, parallel=parallel)

    def test_along_the_edges_of_geometry(self):
        for content in (fog, shells):
            for parallel in (False, True):
                with self.subTest(content=content.__name__, parallel=parallel):
                    self.check_reduced(content, geometry=tubes, parallel=parallel)


if __name__ == "__main__":
    unittest.main()
