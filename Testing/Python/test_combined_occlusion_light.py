# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: light from aside, a second light, coloured attenuation."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Messages,
    Scene,
    ball,
    cube,
    float_image,
    square,
    visibility_image,
    volume_property,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


def colors_of_visibility(mapper):
    """The visibility image's components, [y, x, 1 or 3]."""
    data = vtkImageData()
    mapper.GetVisibilityImage(data)
    scalars = data.GetPointData().GetScalars()
    width, height, _ = data.GetDimensions()
    return vtk_to_numpy(scalars).reshape(height, width, scalars.GetNumberOfComponents()).copy()


def ball_before_a_wall(aside=None, parallel=True, offset=(0.0, 0.0, 0.0), opacity=1.0, **settings):
    """A ball of radius 0.2 at the origin, seen along -z, and a wall 0.5 behind it."""
    scene = Scene((120, 120))
    prop = volume_property(opacity=opacity, unit=0.02, colors=WHITE)
    _, mapper = scene.add_volume(cube(ball(48, 0.2, 0.05, offset)), prop)
    mapper.SetConeAngle(10)
    mapper.VicinityOcclusionOff()
    if aside is not None:
        mapper.SetLightDirection(*aside)
    for name, value in settings.items():
        set_value = getattr(mapper, "Set" + name)
        set_value(*value) if isinstance(value, tuple) else set_value(value)
    scene.renderer.AddActor(square(3.0, -0.5))
    scene.look(half=1.0, parallel=parallel)
    return scene, mapper


def shadow(mapper):
    """Middle of the shadow on the wall, world units of a view of half height 1."""
    dark = 1.0 - visibility_image(mapper)
    ticks = (np.arange(120) + 0.5) / 60.0 - 1.0
    return np.array([(dark * ticks[None, :]).sum(), (dark * ticks[:, None]).sum()]) / dark.sum()


class Light(unittest.TestCase):
    def test_the_shadow_lies_where_the_light_does_not(self):
        for parallel, behind in ((True, 0.5), (False, 0.5)):
            for aside in ((1.0, 0.0, 1.0), (0.0, -0.5, 1.0), (-0.8, 0.6, 1.0)):
                scene, mapper = ball_before_a_wall(aside, parallel)
                scene.window.Render()
                # in perspective things 0.5 behind the origin are smaller by the distance's part
                distance = 1.0 / np.tan(np.radians(15.0))
                scale = 1.0 if parallel else distance / (distance + behind)
                middle = shadow(mapper)
                # a light plane lies half a slab off (0.02, and 1.5 for the bias), pixels are 1/60
                self.assertLess(abs(middle[0] + behind * scale * aside[0]), 0.05, (parallel, aside, middle))
                self.assertLess(abs(middle[1] + behind * scale * aside[1]), 0.05, (parallel, aside, middle))

    def test_from_the_eye_is_the_default(self):
        scene, mapper = ball_before_a_wall()
        scene.window.Render()
        plain = float_image(mapper)
        self.assertEqual(mapper.GetLightDirection(), (0.0, 0.0, 1.0))
        for direction in ((0.0, 0.0, 0.0), (0.0, 0.0, 7.0)):
            mapper.SetLightDirection(*direction)
            scene.window.Render()
            self.assertEqual(np.abs(float_image(mapper) - plain).max(), 0.0)
        mapper.SetLightDirection(0.3, 0.0, 1.0)
        scene.window.Render()
        self.assertFalse(mapper.GetReusedLastFrame())
        self.assertGreater(np.abs(float_image(mapper) - plain).max(), 0.2)

    def test_mirrored_light_is_a_mirrored_picture(self):
        """The directions are no mirror image of themselves: 64 of them, 0.006 of error each."""
        scene, mapper = ball_before_a_wall((0.9, 0.2, 1.0), ConeAngle=45, NumberOfDirections=64)
        scene.window.Render()
        left = visibility_image(mapper)
        mapper.SetLightDirection(-0.9, 0.2, 1.0)
        scene.window.Render()
        right = visibility_image(mapper)
        self.assertLess(np.abs(left - right[:, ::-1]).mean(), 0.012)
        self.assertGreater(np.abs(left - right).mean(), 0.04)

    def test_too_steep_a_light_is_said_once_and_brought_to_60_degrees(self):
        scene, mapper = ball_before_a_wall((np.sqrt(3.0), 0.0, 1.0))
        messages = Messages(mapper)
        scene.window.Render()
        at_60 = visibility_image(mapper)
        self.assertEqual(messages.warnings, [])
        for direction in ((4.0, 0.0, 1.0), (1.0, 0.0, -1.0)):
            mapper.SetLightDirection(*direction)
            scene.window.Render()
            self.assertLess(np.abs(visibility_image(mapper) - at_60).max(), 1e-5)
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("60 degrees", messages.warnings[0])
        self.assertEqual(messages.errors, [])

    def test_a_second_light_casts_a_second_shadow(self):
        scene, mapper = ball_before_a_wall((0.8, 0.0, 1.0))
        scene.window.Render()
        first = visibility_image(mapper)
        mapper.SetSecondLightDirection(-0.8, 0.0, 1.0)
        mapper.SetSecondLightConeAngle(10)
        scene.window.Render()
        self.assertEqual(np.abs(visibility_image(mapper) - first).max(), 0.0)  # no share yet
        mapper.SetSecondLightShare(1.0)
        scene.window.Render()
        second = visibility_image(mapper)
        mapper.SetSecondLightShare(0.25)
        scene.window.Render()
        both = visibility_image(mapper)
        # at half size pixels are taken together along the mean path of both lights: equal here
        self.assertLess(np.abs(both - (0.75 * first + 0.25 * second)).max(), 1e-3)
        self.assertLess(both[60, 60 - 24], 0.3)
        self.assertLess(abs(both[60, 60 + 24] - 0.75), 0.05)

    def test_the_published_method_has_one_light(self):
        scene, mapper = ball_before_a_wall((0.8, 0.0, 1.0))
        messages = Messages(mapper)
        mapper.SetOcclusionMethodToPublished()
        scene.window.Render()
        one = visibility_image(mapper)
        self.assertLess(abs(shadow(mapper)[0] + 0.4), 0.05)
        self.assertEqual(messages.warnings, [])
        mapper.SetSecondLightShare(0.5)
        scene.window.Render()
        self.assertEqual(len(messages.warnings), 1)
        self.assertEqual(np.abs(visibility_image(mapper) - one).max(), 0.0)


class Color(unittest.TestCase):
    def test_light_that_passes_the_volume_reddens(self):
        scene, mapper = ball_before_a_wall(opacity=0.05, AttenuationColor=(0.25, 1.0, 2.0))
        pixels = scene.pixels()
        visibility = colors_of_visibility(mapper)
        self.assertEqual(visibility.shape[2], 3)
        middle = visibility[60, 60]
        self.assertGreater(middle[0], middle[1] + 0.05)
        self.assertGreater(middle[1], middle[2] + 0.05)
        # optical depth over the ball, for factors of 1/4, 1 and 2
        depths = -np.log(middle)
        self.assertLess(abs(depths[1] / depths[0] - 4.0), 0.1)
        self.assertLess(abs(depths[2] / depths[1] - 2.0), 0.05)
        # the wall is white: what is not hidden by the ball shows the visibility
        every = float_image(mapper)[..., :3]
        self.assertLessEqual(np.abs(every - pixels).max(), 0.51 / 255)

    def test_a_frame_that_only_darkens_shows_the_same_colours(self):
        """With FXAA asked for, the geometry's pixels are darkened in the frame buffer, not rewritten."""
        results = []
        for fxaa in (False, True):
            scene, mapper = ball_before_a_wall(opacity=0.05, AttenuationColor=(0.25, 1.0, 2.0))
            scene.renderer.SetUseFXAA(fxaa)
            scene.renderer.GetFXAAOptions().SetRelativeContrastThreshold(10.0)  # leaves all as it is
            scene.renderer.GetFXAAOptions().SetHardContrastThreshold(10.0)
            results.append(scene.pixels())
        # multiplied, rounded to 8 bits, then added to and rounded once more
        self.assertLessEqual(np.abs(results[0] - results[1]).max(), 1.51 / 255)

    def test_equal_factors_are_grey(self):
        scene, mapper = ball_before_a_wall()
        # which light is 1 or 0 all over a piece depends on the factor: every piece counts here
        mapper.SetSkippingMask(mapper.SKIP_EVERY_KIND & ~mapper.SKIP_SATURATED_LIGHT)
        scene.window.Render()
        plain = float_image(mapper)
        updates = mapper.GetNumberOfLightUpdates()
        self.assertEqual(mapper.GetAttenuationColor(), (1.0, 1.0, 1.0))
        mapper.SetAttenuationColor(2.0, 2.0, 2.0)
        scene.window.Render()
        self.assertEqual(colors_of_visibility(mapper).shape[2], 1)
        self.assertEqual(mapper.GetNumberOfLightUpdates(), updates)
        mapper.SetAttenuationColor(1.0, 1.0, 1.0)
        scene.window.Render()
        self.assertEqual(np.abs(float_image(mapper) - plain).max(), 0.0)

    def test_a_factor_of_zero_takes_the_colour_out_of_the_occlusion(self):
        scene, mapper = ball_before_a_wall(AttenuationColor=(1.0, 0.0, 1.0))
        mapper.SetGeometryToGeometry(False)
        mapper.SetGeometryToVolume(False)
        scene.window.Render()
        visibility = colors_of_visibility(mapper)
        self.assertEqual(visibility[..., 1].min(), 1.0)
        self.assertLess(visibility[..., 0].min(), 0.5)
        self.assertTrue((visibility[..., 0] == visibility[..., 2]).all())

    def test_two_volumes_darken_in_colour(self):
        """Both volumes' visibilities multiply on the wall, channel by channel."""
        scene, mapper = ball_before_a_wall(opacity=0.05, AttenuationColor=(0.25, 1.0, 2.0))
        one = scene.pixels()
        prop = volume_property(opacity=0.05, unit=0.02, colors=WHITE)
        other, second = scene.add_volume(cube(ball(48, 0.2, 0.05), center=(-1.0, 0.0, 0.0)), prop)
        for name in ("ConeAngle", "AttenuationColor"):
            value = getattr(mapper, "Get" + name)()
            getattr(second, "Set" + name)(value)
        second.VicinityOcclusionOff()
        two = scene.pixels()
        # nothing of the second one's shadow reaches the right half, nor of the first one's the left
        self.assertLessEqual(np.abs(two[:, 66:] - one[:, 66:]).max(), 2.01 / 255)
        self.assertGreater(np.abs(two[:, :40] - one[:, :40]).max(), 0.2)
        shadow_color = two[60, 8]
        self.assertGreater(shadow_color[0], shadow_color[2])
        self.assertIsNotNone(other)

    def test_setters_clamp(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        mapper.SetAttenuationColor(-1.0, 2000.0, float("nan"))
        self.assertEqual(mapper.GetAttenuationColor(), (0.0, 1000.0, 0.0))
        mapper.SetSecondLightShare(2.0)
        self.assertEqual(mapper.GetSecondLightShare(), 1.0)
        mapper.SetSecondLightConeAngle(0.0)
        self.assertEqual(mapper.GetSecondLightConeAngle(), 1.0)
        time = mapper.GetMTime()
        mapper.SetAttenuationColor(0.0, 1000.0, 0.0)
        self.assertEqual(mapper.GetMTime(), time)


if __name__ == "__main__":
    unittest.main()
