# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The engines' pictures of translucent geometry, and of pixels that a surface covers in part."""
import unittest

import numpy as np
from engine_agreement import CPU, OPENGL, Agreement, N, differences, fog, shells, tubes, veiled_tubes, veils
from occlusion_scene import Scene
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
        for samples in (0, 4):
            pictures = []
            for engine in (CPU, OPENGL):
                scene = Scene((60, 50), background=(0.2, 0.3, 0.4))
                scene.window.SetMultiSamples(samples)
                _, mapper = scene.add_volume(*fog())
                mapper.SetEngine(engine)
                mapper.SetGeometryAntiAliasingToMultiSample()
                tubes(scene)
                scene.look((-0.5, -0.35, -0.8), half=1.4, parallel=False)
                opaque = scene.pixels()
                veils(scene)
                pictures.append(scene.pixels())
                self.assertEqual(mapper.GetEngineInUse(), engine)
                self.assertEqual(mapper.GetNumberOfDroppedLayers(), 0)
            everywhere = np.ones(opaque.shape[:2], bool)
            mean, most = differences(*pictures, everywhere)
            self.assertLessEqual(mean, self.MEAN)
            self.assertLessEqual(most, self.PERCENTILE_99)
            self.assertGreater(differences(pictures[0], opaque, everywhere)[0], 5.0 * self.MEAN)

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

                def setup(mapper):
                    mapper.SetVolumeToVolume(bool(bits & 1))
                    mapper.SetVolumeToGeometry(bool(bits & 2))
                    mapper.SetGeometryToVolume(bool(bits & 4))
                    mapper.SetGeometryToGeometry(bool(bits & 8))

                self.check(fog, setup=setup, geometry=veiled_tubes, darkens=False)

    def test_cut_volumes_nearest_labels_and_no_skipping(self):
        def nearest():
            data, prop = fog()
            prop.SetInterpolationTypeToNearest()
            return data, prop

        def setup(mapper):
            plane = vtkPlane()
            plane.SetNormal(0.6, 0.3, -1.0)
            plane.SetOrigin(0.1, 0.0, 0.3)
            mapper.AddClippingPlane(plane)
            mapper.SkippingOff()

        self.check(nearest, geometry=veiled_tubes, without={"geometry": tubes})
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
