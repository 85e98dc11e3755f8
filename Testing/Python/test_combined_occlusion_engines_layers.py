# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The engines' pictures of translucent geometry, and of pixels that a surface covers in part."""
import unittest

from engine_agreement import Agreement, N, fog, interact, shells, tubes, veiled_tubes, veils
from engine_contents import nearest
from vtkmodules.vtkCommonDataModel import vtkPlane


class TranslucentLayers(Agreement):
    def test_fog_and_shells(self):
        for content in (fog, shells):
            for parallel in (False, True):
                for half in (0, 1):
                    with self.subTest(content=content.__name__, parallel=parallel, half=half):
                        self.check(
                            content,
                            geometry=veils,
                            parallel=parallel,
                            setup=lambda mapper: mapper.SetOcclusionResolution(half),
                            without={"geometry": None},
                        )

    def test_before_opaque_geometry(self):
        for content in (fog, shells):
            for parallel in (False, True):
                with self.subTest(content=content.__name__, parallel=parallel):
                    self.check(content, geometry=veiled_tubes, parallel=parallel, without={"geometry": tubes})

    def test_what_the_window_shows(self):
        """With silhouettes of several samples a pixel as well."""

        def prepare(scene, mapper):
            mapper.SetGeometryAntiAliasingToMultiSample()
            tubes(scene)

        self.check_window(prepare, lambda scene, mapper: veils(scene))

    def test_alone(self):
        for geometry in (veils, veiled_tubes):
            for parallel in (False, True):
                with self.subTest(geometry=geometry.__name__, parallel=parallel):
                    self.check(None, geometry=geometry, parallel=parallel, darkens=False)

    def test_light_that_is_known_later(self):
        """Without bias the planes about a layer are complete only after its slab."""
        for bias, factor, directions in ((0.0, 0.4, 16), (0.0, 1.7, 17), (1.0, 1.0, 6)):
            with self.subTest(bias=bias, factor=factor):

                def setup(mapper):
                    mapper.SetOcclusionBias(bias)
                    mapper.SetSampleDistance(factor * 2.0 / (N - 1))
                    mapper.SetNumberOfDirections(directions)
                    mapper.SetLightDirection(0.5, 0.2, 1.0)

                self.check(fog, geometry=veiled_tubes, setup=setup, without={"geometry": tubes})

    def test_under_colored_light(self):
        for half in (0, 1):

            def setup(mapper):
                mapper.SetAttenuationColor(1.0, 0.4, 0.1)
                mapper.SetOcclusionResolution(half)

            self.check(fog, geometry=veiled_tubes, setup=setup, without={"geometry": tubes})
            self.check(fog, geometry=veils, setup=setup, without={"setup": lambda mapper: None})

    def test_who_darkens_them(self):
        for bits in (1, 2, 6, 9, 13):
            with self.subTest(bits=bits):
                self.check(fog, setup=lambda mapper: interact(mapper, bits), geometry=veiled_tubes, darkens=False)

    def test_cut_volumes_nearest_labels_and_no_skipping(self):
        def setup(mapper):
            plane = vtkPlane()
            plane.SetNormal(0.6, 0.3, -1.0)
            plane.SetOrigin(0.1, 0.0, 0.3)
            mapper.AddClippingPlane(plane)
            mapper.SkippingOff()

        self.check(nearest(fog), geometry=veiled_tubes, without={"geometry": tubes})
        self.check(fog, setup=setup, geometry=veiled_tubes, without={"geometry": tubes})


class Edges(Agreement):
    def test_fog_shells_and_geometry_alone(self):
        for content in (fog, shells, None):
            for parallel in (False, True):
                with self.subTest(content=content and content.__name__, parallel=parallel):
                    self.check(
                        content,
                        geometry=tubes,
                        parallel=parallel,
                        setup=lambda mapper: mapper.SetGeometryAntiAliasingToMultiSample(),
                        without={"setup": lambda mapper: None},
                        darkens=content is not None,
                    )

    def test_behind_four_layers_under_colored_light(self):
        for half, combine in ((0, 0), (1, 1)):
            with self.subTest(half=half):

                def setup(mapper):
                    mapper.SetGeometryAntiAliasingToMultiSample()
                    plain(mapper)

                def plain(mapper):
                    mapper.SetAttenuationColor(1.0, 0.4, 0.1)
                    mapper.SetOcclusionResolution(half)
                    mapper.SetVicinityDistance(0.03)
                    mapper.SetCombineMode(combine)

                self.check(fog, geometry=veiled_tubes, setup=setup, without={"setup": plain})


if __name__ == "__main__":
    unittest.main()
