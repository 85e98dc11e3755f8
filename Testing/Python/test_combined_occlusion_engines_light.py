# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The engines' pictures where pixels are fewer, under light of several colours, and by the published method."""
import unittest

from engine_agreement import Agreement, N, fog, interact, shells, tubes, veiled_tubes


class ReducedPictures(Agreement):
    SIZE = 160  # 40 pixels are left at the least: as many as full pictures have elsewhere

    def check_reduced(self, content, **options):
        """With slices two voxels apart, as interactive frames have them."""

        def wide(mapper):
            mapper.SetSampleDistance(2.0 * 2.0 / (N - 1))

        for reduction in (2, 3, 4):
            with self.subTest(reduction=reduction):

                def setup(mapper):
                    wide(mapper)
                    mapper.SetImageReduction(reduction)

                # a quarter of the pixels says all of smooth fog
                shows = content is shells or reduction > 2
                self.check(
                    content,
                    setup=setup,
                    without={"setup": wide} if shows else None,
                    size=self.SIZE,
                    **options,
                )

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


class ColoredLight(Agreement):
    COLORS = ((1.0, 0.5, 0.2), (0.3, 1.0, 0.3), (0.0, 1.0, 2.0))  # three channels, two, one that nothing takes

    def check_colored(self, content, color, setup=lambda mapper: None, **options):
        def colored(mapper):
            setup(mapper)
            mapper.SetAttenuationColor(*color)

        self.check(content, setup=colored, without={"setup": setup}, **options)

    def test_fog_and_shells(self):
        for content in (fog, shells):
            for k, color in enumerate(self.COLORS):
                for parallel in (False, True):
                    half = (k + parallel) % 2
                    with self.subTest(content=content.__name__, color=color, parallel=parallel, half=half):
                        self.check_colored(
                            content, color, lambda mapper: mapper.SetOcclusionResolution(half), parallel=parallel
                        )

    def test_geometry(self):
        for content, color in zip((fog, shells, fog), self.COLORS):
            for parallel in (False, True):
                with self.subTest(content=content.__name__, color=color, parallel=parallel):
                    self.check_colored(content, color, geometry=tubes, parallel=parallel)

    def test_many_directions_of_two_lights_and_vicinity(self):
        for directions in (5, 17, 40):
            with self.subTest(directions=directions):

                def setup(mapper):
                    mapper.SetNumberOfDirections(directions)
                    mapper.SetSecondLightDirection(-0.5, 0.1, 1.0)
                    mapper.SetSecondLightShare(0.3)
                    mapper.SetVicinityDistance(0.03)
                    mapper.SetCombineMode(directions % 2)

                self.check_colored(fog, self.COLORS[0], setup, geometry=tubes)

    def test_who_darkens_whom(self):
        for bits in (1, 2, 6, 9, 11, 12):
            with self.subTest(bits=bits):

                def setup(mapper):
                    mapper.SetAttenuationColor(1.0, 0.5, 0.2)
                    interact(mapper, bits)

                self.check(fog, setup=setup, geometry=tubes, darkens=False)

    def test_what_the_window_shows(self):
        """Geometry is rewritten, or what is there is darkened by colours."""
        self.check_window(
            lambda scene, mapper: tubes(scene), lambda scene, mapper: mapper.SetAttenuationColor(*self.COLORS[0])
        )


class PublishedMethod(Agreement):
    def check_published(self, content, setup=lambda mapper: None, **options):
        def published(mapper):
            mapper.SetOcclusionMethodToPublished()
            setup(mapper)

        self.check(content, setup=published, without={"setup": setup}, **options)

    def test_fog_and_shells(self):
        for content in (fog, shells):
            for parallel in (False, True):
                for half in (0, 1):
                    taps = (16, 64)[half]
                    with self.subTest(content=content.__name__, parallel=parallel, half=half, taps=taps):

                        def setup(mapper):
                            mapper.SetNumberOfDirections(taps)
                            mapper.SetOcclusionResolution(half)

                        self.check_published(content, setup, parallel=parallel)

    def test_geometry(self):
        for content in (fog, shells):
            for parallel in (False, True):
                for infinite in (False, True):
                    with self.subTest(content=content.__name__, parallel=parallel, infinite=infinite):

                        def setup(mapper):
                            if infinite:  # Algorithm 3
                                mapper.SetGeometryThicknessToInfinity()
                                mapper.SetGeometryOpacity(0.5)

                        self.check_published(content, setup, geometry=tubes, parallel=parallel)

    def test_geometry_alone(self):
        for parallel in (False, True):
            with self.subTest(parallel=parallel):
                self.check_published(None, geometry=tubes, parallel=parallel, darkens=False)

    def test_the_preset_of_the_paper(self):
        for parallel in (False, True):
            with self.subTest(parallel=parallel):
                self.check(
                    fog,
                    setup=lambda mapper: mapper.ApplyPublishedPreset(),
                    without={"setup": lambda mapper: None},
                    geometry=tubes,
                    parallel=parallel,
                )

    def test_with_all_the_rest(self):
        """Tilted and coloured light, layers, edges, a tap alone and odd numbers of taps."""
        for taps in (1, 7, 33):
            with self.subTest(taps=taps):

                def setup(mapper):
                    mapper.SetNumberOfDirections(taps)
                    mapper.SetLightDirection(0.5, 0.2, 1.0)
                    mapper.SetAttenuationColor(1.0, 0.4, 0.4)
                    mapper.SetGeometryAntiAliasingToMultiSample()

                self.check_published(fog, setup, geometry=veiled_tubes)


if __name__ == "__main__":
    unittest.main()
