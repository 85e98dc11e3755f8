# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine makes the CPU engine's picture."""
import unittest

import numpy as np
from engine_agreement import (
    AUTO,
    CPU,
    N,
    OPENGL,
    SCENE,
    Agreement,
    fog,
    interact,
    peak,
    render,
    shells,
    tubes,
)
from occlusion_scene import (
    Messages,
    Scene,
    ball,
    cube,
    float_image,
    image,
    sphere,
    square,
    volume_property,
)
from vtkmodules.vtkCommonDataModel import vtkPlane

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


class SamePicture(Agreement):
    def test_fog_and_shells(self):
        for content in (fog, shells):
            for parallel in (False, True):
                for half in (0, 1):
                    with self.subTest(content=content.__name__, parallel=parallel, half=half):
                        self.check(
                            content,
                            parallel=parallel,
                            setup=lambda mapper: mapper.SetOcclusionResolution(half),
                        )

    def test_colours_of_thin_peaks(self):
        colors = []
        for middle in (False, True):
            for options in ({}, {"parallel": True}, {"geometry": tubes}):
                with self.subTest(middle=middle, **options):

                    def setup(mapper):
                        if middle:
                            mapper.SetColorIntegrationToMiddle()

                    colors.append(self.check(peak, setup=setup, darkens="geometry" in options, **options))
        # The rules differ here by far more than the engines may: the agreement is of integrated colours.
        for integrated, rough in zip(colors[:3], colors[3:]):
            seen = integrated[..., 3] > 0.05
            self.assertGreater(255.0 * np.abs(integrated - rough).max(axis=2)[seen].mean(), 10.0 * self.MEAN)

    def test_scalar_types_and_interpolation(self):
        types = (np.uint8, np.int16, np.uint16, np.float32, np.float64, np.int8)
        for dtype in types:
            for nearest in (False, True) if dtype in (np.uint8, np.float32) else (False,):

                def content():
                    scale = 120.0 if dtype == np.int8 else 255.0
                    values = np.round(scale * ball(N, soft=0.4))
                    prop = volume_property(scale, 0.4, 0.1)
                    if nearest:
                        prop.SetInterpolationTypeToNearest()
                    return image(values.astype(dtype), (2.0 / N,) * 3), prop

                with self.subTest(dtype=dtype.__name__, nearest=nearest):
                    self.check(content)

    def test_cell_data_and_a_turned_volume(self):
        def content():
            data = image(ball(N, soft=0.4), (0.06, 0.05, 0.07), cells=True)
            data.SetDirectionMatrix(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1)
            return data, volume_property(1.0, 0.4, 0.1)

        self.check(content)

    def test_slices_closer_and_wider_than_a_voxel(self):
        for factor in (0.3, 1.7):
            with self.subTest(factor=factor):
                self.check(fog, setup=lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1)))

    def test_numbers_of_directions(self):
        for directions in (4, 6, 17, 64):
            with self.subTest(directions=directions):
                self.check(fog, setup=lambda mapper: mapper.SetNumberOfDirections(directions), geometry=tubes)

    def test_strength_bias_and_cone(self):
        for strength, bias, cone in ((0.5, 0.0, 20.0), (1.0, 0.5, 70.0), (0.7, -1.0, 85.0), (0.0, -1.0, 45.0)):
            with self.subTest(strength=strength, bias=bias, cone=cone):

                def setup(mapper):
                    mapper.SetOcclusionStrength(strength)
                    mapper.SetOcclusionBias(bias)
                    mapper.SetConeAngle(cone)

                self.check(fog, setup=setup, darkens=strength > 0.5)

    def test_light_from_aside_a_second_light_and_attenuation(self):
        def setup(mapper):
            mapper.SetLightDirection(0.6, 0.4, 1.0)
            mapper.SetSecondLightDirection(-0.5, 0.1, 1.0)
            mapper.SetSecondLightShare(0.3)
            mapper.SetSecondLightConeAngle(20.0)
            mapper.SetAttenuationColor(0.6, 0.6, 0.6)

        for half in (0, 1):
            for parallel in (False, True):
                with self.subTest(half=half, parallel=parallel):

                    def both(mapper):
                        setup(mapper)
                        mapper.SetOcclusionResolution(half)

                    self.check(fog, setup=both, geometry=tubes, parallel=parallel)

    def test_clipping_planes(self):
        def setup(mapper):
            for normal, origin in (((0.6, 0.3, -1.0), (0.1, 0.0, 0.3)), ((-1.0, 0.0, 0.2), (0.5, 0, 0))):
                plane = vtkPlane()
                plane.SetNormal(normal)
                plane.SetOrigin(origin)
                mapper.AddClippingPlane(plane)

        for content in (fog, shells):
            self.check(content, setup=setup)

    def test_without_skipping(self):
        for content in (fog, shells):
            self.check(content, setup=lambda mapper: mapper.SkippingOff(), geometry=tubes)

    def test_voxels_that_are_not_finite(self):
        def content():
            values = ball(N, soft=0.4)
            values[10:14, 12, 9:20] = np.nan
            values[20, 20, 20] = np.inf
            return cube(values, 2.0), volume_property(1.0, 0.4, 0.1)

        self.check(content)

    def test_volumes_of_one_sample_in_an_axis(self):
        def content():
            return image(ball(N)[N // 2 : N // 2 + 1], (2.0 / N,) * 3, cells=True), volume_property(1, 0.9, 0.05)

        self.check(content, darkens=False)


class SamePictureWithGeometry(Agreement):
    def test_geometry_alone(self):
        for parallel in (False, True):
            for half in (0, 1):
                with self.subTest(parallel=parallel, half=half):
                    self.check(
                        None,
                        parallel=parallel,
                        geometry=tubes,
                        setup=lambda mapper: mapper.SetOcclusionResolution(half),
                        darkens=False,
                    )

    def test_every_choice_of_who_darkens_whom(self):
        for bits in range(16):
            with self.subTest(bits=bits):
                self.check(fog, setup=lambda mapper: interact(mapper, bits), geometry=tubes, darkens=bits == 15)

    def test_thickness_and_opacity_of_geometry(self):
        for thickness, opacity in ((0.0, 0.5), (0.4, 1.0), (0.4, 0.6), (np.inf, 1.0), (np.inf, 0.1)):
            with self.subTest(thickness=thickness, opacity=opacity):

                def setup(mapper):
                    mapper.SetGeometryOpacity(opacity)
                    if np.isinf(thickness):
                        mapper.SetGeometryThicknessToInfinity()
                    else:
                        mapper.SetGeometryThickness(thickness)

                self.check(shells, setup=setup, geometry=tubes)

    def test_vicinity_rules_and_combination(self):
        for bias, combine, samples in ((0.0, 0, 32), (0.01, 0, 118), (0.0, 1, 8), (0.0, 0, 0)):
            for parallel in (False, True):
                with self.subTest(bias=bias, combine=combine, samples=samples, parallel=parallel):

                    def setup(mapper):
                        mapper.SetVicinityDistance(0.03)
                        mapper.SetVicinityDepthBias(bias)
                        mapper.SetCombineMode(combine)
                        mapper.SetNumberOfVicinitySamples(samples)

                    self.check(fog, setup=setup, geometry=tubes, parallel=parallel)

    def test_camera_inside_the_volume(self):
        def look(scene):
            camera = scene.renderer.GetActiveCamera()
            camera.SetPosition(0.1, 0.2, 0.3)
            camera.SetFocalPoint(-0.5, 0.1, -2.0)
            camera.SetViewAngle(60.0)
            camera.SetClippingRange(0.05, 10.0)

        self.check(fog, look=look, geometry=tubes, size=160)

    def test_part_of_a_window(self):
        pictures = []
        for engine in (CPU, OPENGL):
            scene = Scene((130, 90), viewports=((0.0, 0.1, 0.6, 0.9), (0.6, 0.0, 1.0, 1.0)))
            for renderer in scene.renderers:
                data, prop = fog()
                _, mapper = scene.add_volume(data, prop, vtkChiCombinedOcclusionVolumeMapper(), renderer)
                mapper.SetEngine(engine)
                renderer.AddActor(sphere(0.4, (0.5, 0.4, 0.9), lit=True))
                scene.look((-0.3, -0.2, -1.0), half=1.3, renderer=renderer)
            pictures.append(scene.pixels())
        difference = 255.0 * np.abs(pictures[0] - pictures[1])
        self.assertGreater((pictures[0] > 0.1).sum(), 4000)
        self.assertLessEqual(difference.mean(), self.MEAN)
        self.assertLessEqual(np.percentile(difference, 99.0), self.PERCENTILE_99)


class Windows(unittest.TestCase):
    """The OpenGL engine's textures follow the window that is drawn."""

    def assert_alike(self, a, b):
        difference = 255.0 * np.abs(a - b)
        self.assertGreater((a > 0.1).sum(), 1000)
        self.assertLessEqual(difference.mean(), Agreement.MEAN)
        self.assertLessEqual(np.percentile(difference, 99.0), Agreement.PERCENTILE_99)

    def build(self, mapper, size, direction):
        scene = Scene(size)
        data, prop = fog()
        scene.add_volume(data, prop, mapper)
        scene.renderer.AddActor(sphere(0.4, (0.5, 0.4, 0.9), lit=True))
        scene.look(direction, half=1.3, parallel=False)
        return scene

    def in_each_engine(self, pictures):
        """What `pictures(mapper)` lists, drawn by either engine."""
        results = []
        for engine in (CPU, OPENGL):
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            mapper.SetEngine(engine)
            results.append(pictures(mapper))
            self.assertEqual(mapper.GetEngineInUse(), engine)
        self.assertEqual(len(results[0]), len(results[1]))
        for a, b in zip(*results):
            self.assert_alike(a, b)

    def test_two_windows_share_a_mapper(self):
        def pictures(mapper):
            first = self.build(mapper, (60, 50), (-0.3, -0.2, -1.0))
            second = self.build(mapper, (44, 64), (0.5, 0.1, -1.0))
            result = [scene.pixels() for scene in (first, second, first, first, second)]
            np.testing.assert_array_equal(result[0], result[2])
            return result

        self.in_each_engine(pictures)

    def test_a_window_of_another_size(self):
        def pictures(mapper):
            scene = self.build(mapper, (60, 50), (-0.3, -0.2, -1.0))
            result = []
            for size in ((60, 50), (31, 77), (90, 40), (60, 50)):
                scene.window.SetSize(size)
                result.append(scene.pixels())
                self.assertEqual(result[-1].shape, (size[1], size[0], 3))
            np.testing.assert_array_equal(result[0], result[3])
            return result

        self.in_each_engine(pictures)

    def test_both_eyes(self):
        def pictures(mapper):
            scene = self.build(mapper, (60, 50), (-0.3, -0.2, -1.0))
            flat = scene.pixels()
            scene.window.SetStereoTypeToSplitViewportHorizontal()
            scene.window.StereoRenderOn()
            split = scene.pixels()
            scene.window.SetStereoTypeToAnaglyph()
            both = scene.pixels()
            self.assertGreater(np.abs(both - flat).mean(), 0.01)
            scene.window.StereoRenderOff()
            np.testing.assert_array_equal(scene.pixels(), flat)
            return [flat, split, both]

        self.in_each_engine(pictures)

    def test_a_context_that_is_lost(self):
        def pictures(mapper):
            scene = self.build(mapper, (60, 50), (-0.3, -0.2, -1.0))
            before = scene.pixels()
            scene.window.Finalize()
            after = scene.pixels()
            np.testing.assert_array_equal(before, after)
            return [before, after]

        self.in_each_engine(pictures)

    def test_volumes_behind_each_other_are_merged(self):
        pictures = []
        for engine in (CPU, OPENGL):
            scene = Scene((60, 60))
            for place in (0.6, -0.6):
                _, mapper = scene.add_volume(cube(ball(16), 1.0, (0.1, 0.0, place)), volume_property(1.0, 0.5, 0.1), vtkChiCombinedOcclusionVolumeMapper())
                mapper.SetEngine(engine)
            scene.renderer.AddActor(square(0.9, 0.0, color=(0.8, 0.8, 0.8)))
            scene.look((0.1, 0.1, -1.0), half=1.0)
            pictures.append(scene.pixels())
        self.assert_alike(*pictures)

    def test_nothing_is_drawn_anew_where_nothing_changed(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        mapper.SetEngine(OPENGL)
        scene = self.build(mapper, (60, 50), (-0.3, -0.2, -1.0))
        first = scene.pixels()
        self.assertFalse(mapper.GetReusedLastFrame())
        np.testing.assert_array_equal(scene.pixels(), first)
        self.assertTrue(mapper.GetReusedLastFrame())
        mapper.SetConeAngle(30.0)
        self.assertGreater(np.abs(scene.pixels() - first).max(), 0.0)
        self.assertFalse(mapper.GetReusedLastFrame())

    def test_half_floats_cost_little(self):
        single, _, _ = render(OPENGL, fog, geometry=tubes)
        half, _, mapper = render(OPENGL, fog, lambda m: m.SetLightPrecisionToHalf(), geometry=tubes)
        self.assertEqual(mapper.GetEngineInUse(), OPENGL)
        difference = 255.0 * np.abs(single - half)
        # 11 bits lose 2^-12 a slab in the mean: of some 40 slabs a hundredth
        self.assertGreater(difference.max(), 0.0)
        self.assertLessEqual(difference.mean(), 255.0 * 40 * 2.0**-12)


class WhichEngine(unittest.TestCase):
    def test_names_of_software_rasterisers(self):
        software = (
            "llvmpipe (LLVM 15.0.6, 256 bits)",
            "softpipe",
            "SWR (LLVM 9.0)",
            "Google SwiftShader",
            "Microsoft Basic Render Driver",
            "Apple Software Renderer",
            "GDI Generic",
        )
        hardware = ("NVIDIA H100/PCIe/SSE2", "AMD Radeon RX 7900 XT (radeonsi, navi31, LLVM 15.0.7)", "Apple M2", "")
        for names, expected in ((software, True), (hardware, False)):
            for name in names:
                self.assertEqual(vtkChiCombinedOcclusionVolumeMapper.IsSoftwareRenderer(name), expected, name)

    def test_auto_takes_the_engine_that_the_renderer_string_asks_for(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        self.assertEqual((mapper.GetEngineInUse(), mapper.GetEngineReason()), (AUTO, ""))
        _, _, mapper = render(AUTO, fog)
        capabilities = SCENE.window.ReportCapabilities()
        renderer = next(line for line in capabilities.splitlines() if "renderer string" in line)
        software = mapper.IsSoftwareRenderer(renderer)
        self.assertEqual(mapper.GetEngineInUse(), CPU if software else OPENGL)
        self.assertIn(renderer.split(":", 1)[1].strip(), mapper.GetEngineReason())

    def test_the_cpu_engine_stands_in_and_says_why(self):
        word = "larger"  # than any OpenGL's textures are today
        data = image(np.full((40000, 2, 2), 200, np.uint8), (2.0, 2.0, 5.0e-5))
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        messages = Messages(mapper)
        mapper.SetSampleDistance(0.1)
        SCENE.renderer.RemoveAllViewProps()
        SCENE.add_volume(data, volume_property(255.0, 0.3, 0.1), mapper)
        SCENE.look((-0.5, -0.35, -0.8), half=1.4)
        mapper.SetEngineToOpenGL()
        for _ in range(2):
            SCENE.window.Render()
            mapper.Modified()
        self.assertEqual(mapper.GetEngineInUse(), CPU)
        self.assertIn(word, mapper.GetEngineReason())
        self.assertEqual(len(messages.warnings), 1)  # once
        self.assertIn(word, messages.warnings[0])
        self.assertEqual(messages.errors, [])
        picture = float_image(mapper)
        mapper.SetEngineToCPU()
        SCENE.window.Render()
        self.assertGreater(picture[..., 3].max(), 0.3)
        np.testing.assert_array_equal(picture, float_image(mapper))

    def test_the_cpu_engine_when_it_is_asked_for(self):
        _, _, mapper = render(CPU, fog)
        self.assertEqual(mapper.GetEngineInUse(), CPU)
        self.assertIn("asked for", mapper.GetEngineReason())


if __name__ == "__main__":
    unittest.main()
