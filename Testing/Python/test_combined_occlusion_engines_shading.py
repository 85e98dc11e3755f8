# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine shades, and makes opacity of gradients, as the CPU engine."""
import unittest

import numpy as np
from engine_agreement import CPU, N, OPENGL, Agreement, fog, peak, render, shells, soft_ball, tubes
from engine_contents import lit, nearest, steep
from occlusion_lights import LIGHTS, light
from occlusion_scene import ball, cube, image, volume_property


class Feature(Agreement):
    def check_feature(self, content, without, **options):
        return self.check(content, darkens=False, without={"content": without}, **options)


class Shading(Feature):
    def test_with_and_without_geometry_in_both_projections(self):
        for content in (fog, shells, peak):
            for parallel in (False, True):
                for geometry in (None, tubes):
                    for half in (0, 1):
                        with self.subTest(content=content.__name__, parallel=parallel, geometry=geometry, half=half):
                            self.check_feature(
                                lit(content),
                                content,
                                parallel=parallel,
                                geometry=geometry,
                                setup=lambda mapper: mapper.SetOcclusionResolution(half),
                            )

    def test_every_kind_of_light(self):
        pictures = []
        for name, lights in LIGHTS.items():
            for content in (fog, soft_ball):
                with self.subTest(lights=name, content=content.__name__):
                    pictures.append(self.check_feature(lit(content), content, lights=lights()))
        for content in (0, 1):  # and no two lights give the same picture
            ones = pictures[content::2]
            for a, b in zip(ones[:-1], ones[1:]):
                self.assertGreater(255.0 * np.abs(a - b).max(axis=2).mean(), 0.5)

    def test_ambient_light_of_the_lights(self):
        pictures = []
        for ambient in ((0.0, 0.0, 0.0), (0.2, 0.9, 0.5)):
            colored = light()
            colored.SetAmbientColor(ambient)
            pictures.append(self.check(lit(fog), lights=[colored]))
        self.assertGreater(255.0 * np.abs(pictures[1] - pictures[0]).max(axis=2).mean(), 5.0)

    def test_light_that_is_attenuated_by_colour(self):
        def setup(mapper):
            mapper.SetAttenuationColor(1.0, 0.5, 0.2)

        for geometry in (None, tubes):
            for left_out in ({"content": fog}, {"setup": lambda mapper: None}):
                with self.subTest(geometry=geometry, left_out=list(left_out)):
                    self.check(lit(fog), setup=setup, geometry=geometry, without=left_out)

    def test_highlights(self):
        for lights in (LIGHTS["one headlight"], LIGHTS["one camera light"], LIGHTS["a positional light"]):
            for power in (1.0, 40.0):
                with self.subTest(power=power):
                    shiny = self.check(lit(soft_ball, 0.8, power), lights=lights(), darkens=False)
                    dull = render(OPENGL, lit(soft_ball, 0.0), lights=lights())[0]
                    self.assertGreater(255.0 * np.abs(shiny - dull).max(), 20.0)

    def test_one_sided_lighting_and_sixteen_lights(self):
        behind = [light(position=(-1.0, -2.0, -3.0))]
        two = self.check(lit(fog), lights=behind)
        try:
            one = self.check(lit(fog), lights=behind, darkens=False, look=lambda scene: scene.renderer.TwoSidedLightingOff())
            self.assertGreater(255.0 * np.abs(one - two).mean(), 5.0)
        finally:
            render(CPU, fog, look=lambda scene: scene.renderer.TwoSidedLightingOn())
        many = [item for lights in list(LIGHTS.values())[3:] for item in lights()] * 2
        self.assertGreaterEqual(len(many), 16)
        for item in many:
            item.SetIntensity(0.15 * item.GetIntensity())
        self.check_feature(lit(fog), fog, lights=many[:16])

    def test_no_light_at_all(self):
        def dark(scene):
            scene.renderer.AutomaticLightCreationOff()
            scene.renderer.RemoveAllLights()

        try:
            picture = self.check(lit(fog), look=dark, darkens=False)
            self.assertEqual(picture[..., :3].max(), 0.0)
            self.assertGreater(picture[..., 3].max(), 0.5)
        finally:
            render(CPU, fog, look=lambda scene: scene.renderer.AutomaticLightCreationOn())

    def test_scalar_types_borders_and_interpolation(self):
        for dtype in (np.uint8, np.int16, np.uint16, np.float32, np.float64):

            def content():
                values = np.round(255.0 * ball(N, radius=0.6, soft=0.9)).astype(dtype)  # gradients up to the border
                return image(values, (0.08, 0.09, 0.07)), volume_property(255.0, 0.3, 0.1)

            for setting in (lit, lambda made: lit(nearest(made))):
                with self.subTest(dtype=dtype.__name__, nearest=setting is not lit):
                    self.check_feature(setting(content), content if setting is lit else nearest(content))

    def test_a_turned_volume_of_cells_is_lit_from_where_it_should(self):
        def content():
            data = image(ball(N, soft=0.4), (0.06, 0.05, 0.07), cells=True)
            data.SetDirectionMatrix(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1)
            return data, volume_property(1.0, 0.4, 0.1)

        self.check_feature(lit(content), content, lights=LIGHTS["two coloured lights"]())

    def test_volumes_of_one_sample_in_an_axis_and_voxels_that_are_not_finite(self):
        def slab():
            values = ball(N)[N // 2 : N // 2 + 1]
            return image(values, (2.0 / N,) * 3, cells=True), volume_property(1, 0.9, 0.05)

        def holes():
            values = ball(N, soft=0.4)
            values[10:14, 12, 9:20] = np.nan
            values[20, 20, 20] = np.inf
            return cube(values, 2.0), volume_property(1.0, 0.4, 0.1)

        for content in (slab, holes):
            with self.subTest(content=content.__name__):
                self.check_feature(lit(content), content)

    def test_slices_of_other_widths_clipped_and_without_skipping(self):
        for factor in (0.4, 1.7):
            for skip in (True, False):
                with self.subTest(factor=factor, skip=skip):

                    def setup(mapper):
                        mapper.SetSampleDistance(factor * 2.0 / (N - 1))
                        mapper.SetSkipping(skip)

                    self.check_feature(lit(shells), shells, setup=setup)

    def test_camera_inside_the_volume(self):
        def look(scene):
            camera = scene.renderer.GetActiveCamera()
            camera.SetPosition(0.1, 0.2, 0.3)
            camera.SetFocalPoint(-0.5, 0.1, -2.0)
            camera.SetViewAngle(60.0)
            camera.SetClippingRange(0.05, 10.0)

        # the CPU engine's paths are linear over 32 light pixels: not for wide views of few pixels
        self.check_feature(lit(fog), fog, look=look, geometry=tubes, size=160)


class GradientOpacity(Feature):
    def test_shaded_and_unshaded_with_and_without_geometry_in_both_projections(self):
        for content in (fog, shells, peak):
            for shaded in (False, True):
                for parallel in (False, True):
                    for geometry in (None, tubes):
                        with self.subTest(content=content.__name__, shaded=shaded, parallel=parallel, geometry=geometry):
                            made = lit(content) if shaded else content
                            self.check_feature(steep(made), made, parallel=parallel, geometry=geometry)

    def test_what_gradients_make_transparent_darkens_no_more(self):
        bright = render(OPENGL, steep(soft_ball, 0.2), geometry=tubes)[1]
        dark = render(OPENGL, soft_ball, geometry=tubes)[1]
        expected = render(CPU, steep(soft_ball, 0.2), geometry=tubes)[1]
        covered = dark < 1.0
        self.assertGreater((bright - dark)[covered].mean(), 0.05)
        self.assertLessEqual(255.0 * np.abs(bright - expected)[covered].mean(), self.MEAN)

    def test_nearest_samples(self):
        for content in (fog, soft_ball):
            with self.subTest(content=content.__name__):
                self.check_feature(steep(nearest(content)), nearest(content))


class Changes(Agreement):
    def test_tables_lights_and_materials(self):
        def edits(scene, mapper, data, prop):
            light = LIGHTS["one scene light, off the axis"]()[0]
            scene.renderer.AddLight(light)
            return (
                lambda: prop.GetGradientOpacity().AddPoint(0.0, 0.9),
                lambda: light.SetPosition(-3.0, 0.5, 2.0),
                lambda: light.SetDiffuseColor(0.2, 1.0, 0.5),
                lambda: prop.SetDiffuse(0.3),
                lambda: prop.SetSpecularPower(2.0),
                lambda: prop.DisableGradientOpacityOn(),
                lambda: prop.ShadeOff(),
                lambda: (prop.ShadeOn(), prop.DisableGradientOpacityOff()),
            )

        self.check_edits(steep(lit(soft_ball), 0.2), edits)


if __name__ == "__main__":
    unittest.main()
