# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: shading by gradients, gradient opacity, two-dimensional transfer
functions, beside the ray caster."""
import unittest

import numpy as np
from occlusion_lights import LIGHTS, light
from occlusion_scene import (
    Messages,
    Scene,
    cube,
    erode,
    float_image,
    marschner_lobb,
    square,
    transfer_plane,
    visibility_image,
    volume_property,
)
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkRenderingCore import vtkLightKit
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

SIZE = 64
DATA = marschner_lobb(SIZE)
STEP = 0.1 * 2.0 / (SIZE - 1)


def shaded_property(ambient=0.2, diffuse=0.7, specular=0.3, power=12.0, opacity=0.9):
    prop = volume_property(opacity=opacity, unit=0.1)
    prop.ShadeOn()
    prop.SetAmbient(ambient)
    prop.SetDiffuse(diffuse)
    prop.SetSpecular(specular)
    prop.SetSpecularPower(power)
    return prop


def peer():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.UseJitteringOff()
    return mapper


def ours():
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetOcclusionStrength(0.0)
    return mapper


def picture(mapper, prop, lights=(), data=DATA, parallel=False, prepare=None, direction=(-0.5, -0.35, -0.8)):
    mapper.SetSampleDistance(STEP)
    scene = Scene((80, 80))
    volume, _ = scene.add_volume(data, prop, mapper)
    for item in lights:
        scene.renderer.AddLight(item)
    if prepare:
        prepare(volume, scene)
    scene.look(direction, half=1.6, parallel=parallel)
    return scene.pixels()


def differences(a, b):
    inside = erode(b.max(axis=2) > 0, 2)
    return inside.sum(), 255.0 * np.abs(a - b).max(axis=2)[inside]


def gradient_property(shade):
    prop = shaded_property()
    prop.SetShade(shade)
    function = vtkPiecewiseFunction()
    for place, value in ((0.0, 0.0), (0.06, 0.2), (0.15, 1.0)):
        function.AddPoint(place, value)
    prop.SetGradientOpacity(function)
    return prop


class Comparison(unittest.TestCase):
    def check(self, prop, **options):
        lights = options.pop("lights", list)
        pictures = [picture(mapper(), prop(), lights(), **options) for mapper in (ours, peer)]
        count, difference = differences(*pictures)
        self.assertGreater(count, 1500)
        # the bounds
        self.assertLessEqual(difference.mean(), 1.0)
        self.assertLessEqual(np.percentile(difference, 99.0), 3.0)
        return pictures[0]


class AgainstTheRayCaster(Comparison):
    def test_shaded_pictures_agree_under_every_kind_of_light(self):
        seen = []
        for name, lights in LIGHTS.items():
            for parallel in (False, True)[: 1 + name.startswith("one")]:
                with self.subTest(lights=name, parallel=parallel):
                    one = self.check(shaded_property, lights=lights, parallel=parallel)
                    seen += [] if parallel else [one]
        for a, b in zip(seen[:-1], seen[1:]):  # and no two lights give the same picture
            self.assertGreater(255.0 * np.abs(a - b).mean(), 0.5)

    def test_sharp_highlights_agree(self):
        dull = self.check(lambda: shaded_property(specular=0.0))
        shiny = self.check(lambda: shaded_property(0.1, 0.6, 0.8, 40.0))
        self.assertGreater(255.0 * np.abs(dull - shiny).max(), 30.0)

    def test_one_sided_lighting_agrees(self):
        def one_sided(_volume, scene):
            scene.renderer.TwoSidedLightingOff()

        two = self.check(shaded_property, lights=LIGHTS["one scene light, off the axis"])
        one = self.check(shaded_property, lights=LIGHTS["one scene light, off the axis"], prepare=one_sided)
        self.assertGreater(255.0 * np.abs(one - two).mean(), 2.0)

    def test_a_light_kit_and_lights_that_are_off_agree(self):
        def kit(_volume, scene):
            scene.kit = vtkLightKit()
            scene.kit.AddLightsToRenderer(scene.renderer)

        self.check(shaded_property, prepare=kit)
        off = light(position=(-3.0, 1.0, 2.0))
        off.SwitchOff()
        self.check(shaded_property, lights=lambda: [light(), off])

    def test_without_lights_a_shaded_volume_is_black(self):
        def dark(_volume, scene):
            scene.renderer.AutomaticLightCreationOff()

        for mapper in (ours(), peer()):
            self.assertEqual(picture(mapper, shaded_property(), prepare=dark).max(), 0.0)

    def test_a_rotated_volume_agrees(self):
        def turn(volume, _scene):
            volume.RotateX(25.0)
            volume.RotateZ(40.0)

        # under one headlight: with more, the ray caster's normals do not turn with the volume
        self.check(shaded_property, prepare=turn)

    def test_a_scene_that_is_rotated_as_a_whole_looks_the_same(self):
        def shot(turn):
            mapper = ours()
            mapper.SetSampleDistance(STEP)
            scene = Scene((100, 100))
            volume, _ = scene.add_volume(DATA, shaded_property(), mapper)
            volume.SetUserTransform(turn)
            for place, color in (((1.0, 2.0, 3.0), (1.0, 0.4, 0.2)), ((-3.0, 1.0, 2.0), (0.2, 0.5, 1.0))):
                scene.renderer.AddLight(light(position=turn.TransformPoint(place), color=color))
            scene.look((-0.5, -0.35, -0.8), half=1.6, parallel=False)
            camera = scene.renderer.GetActiveCamera()
            camera.SetPosition(turn.TransformPoint(camera.GetPosition()))
            camera.SetViewUp(turn.TransformVector(camera.GetViewUp()))
            return scene.pixels()

        turn = vtkTransform()
        straight = shot(turn)
        turn.RotateX(25.0)
        turn.RotateZ(40.0)
        # positions in float may turn a rounding to 8 bits
        self.assertLessEqual(255.0 * np.abs(shot(turn) - straight).max(), 1.01)

    def test_gradient_opacity_agrees_shaded_and_unshaded(self):
        plain = self.check(lambda: volume_property(opacity=0.9, unit=0.1))
        for shade in (0, 1):
            with self.subTest(shade=shade):
                cut = self.check(lambda: gradient_property(shade))
                self.assertGreater(255.0 * np.abs(cut - plain).mean(), 5.0)
        off = gradient_property(0)
        off.DisableGradientOpacityOn()
        self.assertEqual(np.abs(self.check(lambda: off) - plain).max(), 0.0)

    def test_bytes_and_cells_agree(self):
        bytes_ = marschner_lobb(SIZE, np.uint8)
        prop = shaded_property()
        for function in (prop.GetScalarOpacity(), prop.GetRGBTransferFunction()):
            node = [0.0] * (4 if function is prop.GetScalarOpacity() else 6)
            for i in range(function.GetSize()):
                function.GetNodeValue(i, node)
                node[0] *= 255.0
                function.SetNodeValue(i, node)
        self.check(lambda: prop, data=bytes_)


def plane_property(shade=0, unit=STEP, **options):
    prop = shaded_property(specular=0.1)
    prop.SetShade(shade)
    prop.SetTransferFunctionModeTo2D()
    prop.SetTransferFunction2D(transfer_plane(**options))
    prop.SetScalarOpacityUnitDistance(unit)
    return prop


class TwoDimensionalTransferFunctions(Comparison):
    # the ray caster corrects no opacities here: its step is the unit distance. It resamples small tables
    # with a wide filter; ours are linear, so that the table must be fine.
    def test_gradients_along_y_agree_shaded_and_unshaded(self):
        for shade in (0, 1):
            with self.subTest(shade=shade):
                self.check(lambda: plane_property(shade))

    def test_a_second_array_along_y_agrees_shaded_and_unshaded(self):
        data = vtkImageData()
        data.DeepCopy(DATA)
        ticks = np.linspace(-1.0, 1.0, SIZE)
        _, y, x = np.meshgrid(ticks, ticks, ticks, indexing="ij")
        second = numpy_to_vtk((50.0 + 20.0 * np.sin(3.0 * x) * y).astype(np.float32).ravel(), deep=True)
        second.SetName("second")
        data.GetPointData().AddArray(second)
        by_gradient = picture(ours(), plane_property())
        for shade in (0, 1):
            with self.subTest(shade=shade):
                pictures = []
                for mapper in (ours(), peer()):
                    mapper.SetTransfer2DYAxisArray("second")
                    pictures.append(picture(mapper, plane_property(shade, opacity=0.1), data=data))
                _, difference = differences(*pictures)
                self.assertLessEqual(difference.mean(), 1.0)
                self.assertLessEqual(np.percentile(difference, 99.0), 3.0)
                self.assertGreater(255.0 * np.abs(pictures[0] - by_gradient).mean(), 5.0)

    def test_opacity_does_not_depend_on_the_sample_distance(self):
        pictures = []
        for step in (0.5, 1.0, 2.0):
            mapper = ours()
            scene = Scene((100, 100))
            scene.add_volume(DATA, plane_property(unit=0.1, opacity=0.6), mapper)
            mapper.SetSampleDistance(step * STEP)
            scene.look((-0.5, -0.35, -0.8), half=1.6)
            scene.window.Render()
            pictures.append(float_image(mapper))
        self.assertGreater(pictures[0][..., 3].max(), 0.9)
        for other in pictures[1:]:
            self.assertLessEqual(255.0 * np.abs(other - pictures[0]).mean(), 0.1)

    def test_what_is_missing_is_named(self):
        prop = plane_property()
        broken = shaded_property()
        broken.SetTransferFunctionModeTo2D()
        for cause, properties, name in (("'second'", prop, "second"), ("two-dimensional", broken, None)):
            mapper = ours()
            messages = Messages(mapper)
            mapper.SetTransfer2DYAxisArray(name)
            self.assertGreater(picture(mapper, properties).max(), 0.1)
            self.assertEqual((len(messages.warnings), messages.errors), (1, []))
            self.assertIn(cause, messages.warnings[0])

    def test_skipping_changes_no_pixel(self):
        pictures = []
        for skip in (True, False):
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            mapper.SetSkipping(skip)
            scene = Scene((100, 100))
            scene.add_volume(DATA, plane_property(unit=0.1), mapper)
            scene.look((-0.5, -0.35, -0.8), half=1.6)
            scene.window.Render()
            pictures.append(float_image(mapper))
        self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[1]).max(), 1.0)  # the bound


class WithOcclusion(unittest.TestCase):
    def test_occlusion_takes_matt_light_and_no_highlights(self):
        """Schott et al. 2013, Eq. 9, on a volume: V (ambient + diffuse) + specular."""
        pictures = {}
        for name, values in (("all", (0.2, 0.5, 0.25)), ("matt", (0.2, 0.5, 0.0)), ("shine", (0.0, 0.0, 0.25))):
            for strength in (0.0, 1.0):
                mapper = ours()
                mapper.SetOcclusionStrength(strength)
                picture(mapper, shaded_property(*values, 1.0), LIGHTS["one headlight"]())
                pictures[name, strength] = float_image(mapper)[..., :3]
        # highlights alone are the same in the dark and in the light
        self.assertEqual(np.abs(pictures["shine", 0.0] - pictures["shine", 1.0]).max(), 0.0)
        self.assertGreater(pictures["shine", 1.0].max(), 0.05)
        # matt light is taken, and the sum is the sum: no clamping, as 0.2 + 0.5 + 0.25 < 1
        self.assertLess(pictures["matt", 1.0].sum(), 0.8 * pictures["matt", 0.0].sum())
        for strength in (0.0, 1.0):
            total = pictures["matt", strength] + pictures["shine", strength]
            self.assertLessEqual(np.abs(pictures["all", strength] - total).max(), 1e-5)  # roundings

    def test_gradient_opacity_lets_light_through_as_well(self):
        """What gradients make transparent darkens no more."""
        pictures = []
        z = np.linspace(0.0, 1.0, 24, dtype=np.float32)[:, None, None]
        data = cube(np.broadcast_to(z, (24, 24, 24)).copy(), 2.0)  # one gradient everywhere
        for share in (1.0, 0.5, 0.0):
            prop = volume_property(opacity=0.5)
            function = vtkPiecewiseFunction()
            function.AddPoint(0.0, share)
            function.AddPoint(1.0, share)
            prop.SetGradientOpacity(function)
            scene = Scene((60, 60))
            _, mapper = scene.add_volume(data, prop)
            scene.renderer.AddActor(square(0.5, -1.2))
            scene.look((0.0, 0.0, -1.0), half=1.2)
            scene.window.Render()
            pictures.append((visibility_image(mapper)[30, 30], float_image(mapper)[30, 30, 3]))
        (full, _), (half, _), (none, _) = pictures
        self.assertEqual(none, 1.0)
        # each direction has half of the optical thickness: the mean of roots is below the mean's root
        self.assertLessEqual(half, np.sqrt(full) + 1e-4)
        self.assertLess(full, half - 0.1)

    def test_shading_and_its_switches_say_nothing_and_reuse_frames(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        messages = Messages(mapper)
        prop = gradient_property(1)
        scene = Scene((60, 60))
        scene.add_volume(DATA, prop, mapper)
        scene.renderer.AddLight(light())
        scene.look(half=1.6)
        scene.window.Render()
        scene.window.Render()
        self.assertTrue(mapper.GetReusedLastFrame())
        before = float_image(mapper)
        for change in (
            lambda: scene.renderer.GetLights().GetItemAsObject(0).SetPosition(-3.0, 0.0, 1.0),
            lambda: scene.renderer.GetLights().GetItemAsObject(0).SetDiffuseColor(0.2, 1.0, 0.3),
            lambda: prop.SetDiffuse(0.3),
            lambda: prop.SetSpecularPower(3.0),
            lambda: prop.GetGradientOpacity().AddPoint(0.0, 0.9),
            lambda: prop.ShadeOff(),
            lambda: prop.DisableGradientOpacityOn(),
        ):
            change()
            scene.window.Render()
            self.assertFalse(mapper.GetReusedLastFrame())
            after = float_image(mapper)
            self.assertGreater(np.abs(after - before).max(), 0.005)
            before = after
        self.assertEqual((messages.errors, messages.warnings), ([], []))
        self.assertEqual(prop.HasGradientOpacity(0), True)
        # looking for a gradient opacity must not make one
        plain = volume_property()
        scene = Scene((60, 60))
        scene.add_volume(DATA, plain)
        scene.window.Render()
        self.assertEqual(plain.HasGradientOpacity(0), False)


if __name__ == "__main__":
    unittest.main()
