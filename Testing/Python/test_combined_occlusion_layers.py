# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Translucent geometry in and around the volume of vtkChiCombinedOcclusionVolumeMapper."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Messages,
    Scene,
    ball,
    cube,
    float_image,
    image,
    sphere,
    square,
    visibility_image,
    volume_property,
)
from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkAssembly,
    vtkCompositeDataDisplayAttributes,
    vtkImageSlice,
    vtkImageSliceMapper,
    vtkRenderer,
)
from vtkmodules.vtkRenderingOpenGL2 import vtkCompositePolyDataMapper2  # noqa: F401 (factory)

BACKGROUND = np.array((0.1, 0.3, 0.2))
RED = np.array((0.9, 0.1, 0.05))
FOG = 1.0 - 0.5**2  # alpha of the whole box: opacity 0.5 on half a unit, one unit deep


def translucent(prop, opacity=0.5):
    prop.GetProperty().SetOpacity(opacity)
    return prop


def fog_scene(parallel=True, strength=0.0, setup=None, size=(90, 90)):
    """White fog in the unit cube before a flat background."""
    scene = Scene(size, background=tuple(BACKGROUND))
    if setup:
        setup(scene)
    _, mapper = scene.add_volume(cube(np.ones((17, 17, 17))), volume_property(1.0, 0.5, 0.5, WHITE))
    mapper.SetOcclusionStrength(strength)
    scene.look(parallel=parallel)
    return scene, mapper


def over(front, alpha, behind):
    """Premultiplied front over what is behind."""
    return np.asarray(front) + (1.0 - alpha) * np.asarray(behind)


def fog_between(near, far):
    """Alpha of the fog along the middle ray between two heights."""
    depth = min(near, 0.5) - max(far, -0.5)
    return 1.0 - 0.25 ** max(depth, 0.0)


def through(heights, alpha=0.5, color=RED, background=BACKGROUND):
    """What the middle pixel shows of planes at these heights, the highest nearest to the eye."""
    result = np.asarray(background, float)
    places = [9.0] + sorted(heights, reverse=True) + [-9.0]
    for i in range(len(places) - 1, 0, -1):
        fog = fog_between(places[i - 1], places[i])
        result = over(fog * np.ones(3), fog, result)
        if i > 1:
            result = over(alpha * color, alpha, result)
    return result


# how VTK itself would draw the translucent geometry
PIPELINES = {
    "blending": lambda scene: None,
    "peeling": lambda scene: scene.renderer.SetUseDepthPeeling(1),
    "peeling for volumes": lambda scene: (
        scene.renderer.SetUseDepthPeeling(1),
        scene.renderer.SetUseDepthPeelingForVolumes(1),
    ),
    "fxaa": lambda scene: scene.renderer.SetUseFXAA(1),
    "multisampling": lambda scene: scene.window.SetMultiSamples(4),
}


class TestTranslucentLayers(unittest.TestCase):
    def test_a_plane_in_fog_is_the_closed_form_however_vtk_would_draw_it(self):
        for name, setup in PIPELINES.items():
            for parallel in (True, False):
                scene, mapper = fog_scene(parallel, setup=setup)
                messages = Messages(mapper)
                plane = translucent(square(0.6, color=tuple(RED)))
                scene.renderer.AddActor(plane)
                for height in (0.8, 0.23, -0.7):
                    plane.SetPosition(0, 0, height)
                    pixels = scene.pixels()
                    # two roundings to 8 bits (the renderer's, the blend's), and one of the closed form
                    np.testing.assert_allclose(
                        pixels[45, 45], through([height]), atol=2.0 / 255, err_msg=f"{name} {height}"
                    )
                    np.testing.assert_allclose(pixels[2, 2], BACKGROUND, atol=0.6 / 255)
                self.assertEqual(messages.warnings + messages.errors, [], name)

    def test_four_layers_are_drawn_and_further_ones_counted_and_named_once(self):
        for count, dropped in ((4, 0), (6, 2)):
            scene, mapper = fog_scene()
            messages = Messages(mapper)
            heights = [0.7 - 0.25 * i for i in range(count)]
            for height in reversed(heights):
                scene.renderer.AddActor(translucent(square(0.8, height, color=tuple(RED)), 0.3))
            pixels = scene.pixels()
            # what is left out is the farthest
            np.testing.assert_allclose(pixels[45, 45], through(heights[:4], 0.3), atol=2.0 / 255)
            self.assertEqual(mapper.GetNumberOfDroppedLayers(), dropped)
            scene.renderer.GetActiveCamera().Azimuth(5)
            scene.pixels()
            self.assertEqual(len(messages.warnings), 1 if dropped else 0)

    def test_opaque_geometry_hides_what_is_behind_it(self):
        scene, mapper = fog_scene()
        scene.renderer.AddActor(square(0.8, 0.1, color=(0, 0, 1)))
        without = scene.pixels()
        plane = translucent(square(0.8, -0.2, color=tuple(RED)))
        scene.renderer.AddActor(plane)
        np.testing.assert_array_equal(scene.pixels(), without)
        plane.SetPosition(0, 0, 0.4)
        expected = through([0.2], background=(0, 0, 1))
        # the plane ends the fog as well
        fog = fog_between(9.0, 0.2), fog_between(0.2, 0.1)
        inner = over(fog[1] * np.ones(3), fog[1], (0, 0, 1))
        expected = over(fog[0] * np.ones(3), fog[0], over(0.5 * RED, 0.5, inner))
        np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)
        self.assertEqual(mapper.GetNumberOfDroppedLayers(), 0)

    def test_a_layer_takes_the_light_of_an_opaque_surface_there(self):
        scene, mapper = fog_scene(strength=1.0)
        mapper.VicinityOcclusionOff()
        mapper.GeometryToGeometryOff()
        mapper.GeometryToVolumeOff()
        plane = square(0.8, -0.2, color=(1, 1, 1))
        scene.renderer.AddActor(plane)
        scene.pixels()
        expected = visibility_image(mapper)
        opaque = float_image(mapper)
        translucent(plane, 0.999)  # white, and as good as opaque
        scene.pixels()
        layered = float_image(mapper)
        self.assertLess(expected[45, 45], 0.8)
        # 0.001 of what is behind
        np.testing.assert_allclose(layered[30:60, 30:60], opaque[30:60, 30:60], atol=2e-3)

    def test_layers_do_not_occlude(self):
        scene, mapper = fog_scene(strength=1.0)
        scene.renderer.AddActor(square(0.8, -0.8))
        scene.pixels()
        before = visibility_image(mapper)
        scene.renderer.AddActor(translucent(square(0.3, 0.2)))
        scene.pixels()
        np.testing.assert_array_equal(visibility_image(mapper), before)

    def test_the_first_frame_is_as_the_second(self):
        for name in ("blending", "peeling for volumes"):
            scene, _ = fog_scene(setup=PIPELINES[name])
            scene.renderer.AddActor(translucent(square(0.4, 0.2, color=tuple(RED))))
            first = scene.pixels()
            np.testing.assert_array_equal(scene.pixels(), first)

    def test_backgrounds_and_layers_below_survive(self):
        scene, _ = fog_scene()
        scene.renderer.GradientBackgroundOn()
        scene.renderer.SetBackground2(0.9, 0.2, 0.6)
        gradient = scene.pixels()[45, 2]
        scene.renderer.AddActor(translucent(square(0.9, -0.7, color=tuple(RED))))
        pixels = scene.pixels()
        np.testing.assert_allclose(
            pixels[45, 20], over(0.5 * RED, 0.5, gradient), atol=2.0 / 255, err_msg="beside the fog"
        )
        # a renderer above another one, which does not erase
        scene, _ = fog_scene(setup=lambda s: (s.window.SetNumberOfLayers(2), s.renderer.SetLayer(1)))
        below = vtkRenderer()
        below.SetBackground(0.3, 0.6, 0.9)
        scene.window.AddRenderer(below)
        scene.renderer.AddActor(translucent(square(0.8, 0.1, color=tuple(RED))))
        scene.pixels()
        pixels = scene.pixels()
        np.testing.assert_allclose(
            pixels[45, 45], through([0.1], background=(0.3, 0.6, 0.9)), atol=2.0 / 255
        )

    def test_without_the_volume_in_view_vtk_draws_translucent_geometry(self):
        for name in ("blending", "peeling for volumes"):
            scene, _ = fog_scene(setup=PIPELINES[name])
            scene.renderer.AddActor(translucent(square(0.8, color=tuple(RED))))
            np.testing.assert_allclose(scene.pixels()[45, 45], through([0.0]), atol=2.0 / 255)
            volume = scene.renderer.GetVolumes().GetItemAsObject(0)
            expected = over(0.5 * RED, 0.5, BACKGROUND)
            volume.VisibilityOff()
            np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)
            volume.VisibilityOn()
            volume.SetPosition(50, 0, 0)
            np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)
            volume.SetPosition(0, 0, 0)
            np.testing.assert_allclose(scene.pixels()[45, 45], through([0.0]), atol=2.0 / 255)

    def test_assemblies_and_blocks_of_composites_take_part(self):
        scene, _ = fog_scene()
        group = vtkAssembly()
        group.AddPart(translucent(square(0.8, color=tuple(RED))))
        group.AddPart(square(0.8, -0.6, color=(0, 0, 1)))
        group.SetPosition(0, 0, 0.2)
        scene.renderer.AddActor(group)
        expected = through([0.2], background=(0, 0, 1))
        fog = fog_between(9.0, 0.2), fog_between(0.2, -0.4)
        inner = over(fog[1] * np.ones(3), fog[1], (0, 0, 1))
        expected = over(fog[0] * np.ones(3), fog[0], over(0.5 * RED, 0.5, inner))
        np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)

        scene, _ = fog_scene()
        blocks = vtkMultiBlockDataSet()
        for i, height in enumerate((0.2, -0.4)):
            plate = vtkCubeSource()
            plate.SetXLength(1.6)
            plate.SetYLength(1.6)
            plate.SetZLength(1e-4)
            plate.SetCenter(0, 0, height)
            plate.Update()
            blocks.SetBlock(i, plate.GetOutput())
        composite = vtkCompositePolyDataMapper2()
        composite.SetInputDataObject(blocks)
        attributes = vtkCompositeDataDisplayAttributes()
        composite.SetCompositeDataDisplayAttributes(attributes)
        attributes.SetBlockColor(blocks.GetBlock(0), tuple(RED))
        attributes.SetBlockOpacity(blocks.GetBlock(0), 0.5)
        attributes.SetBlockColor(blocks.GetBlock(1), (0, 0, 1))
        actor = vtkActor()
        actor.SetMapper(composite)
        actor.GetProperty().LightingOff()
        actor.GetProperty().BackfaceCullingOn()
        scene.renderer.AddActor(actor)
        scene.pixels()
        np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)

    def test_lit_and_nested_spheres_are_peeled_front_to_back(self):
        """Fog of alpha 0 everywhere: the picture must be that of VTK's own depth peeling."""
        pictures = []
        for ours in (True, False):
            scene = Scene((100, 100), background=tuple(BACKGROUND))
            scene.renderer.SetUseDepthPeeling(1)
            scene.renderer.SetMaximumNumberOfPeels(20)
            if ours:
                scene.add_volume(image(np.zeros((5, 5, 5), np.float32)))
            scene.renderer.AddActor(translucent(sphere(0.5, color=(1, 0.2, 0.2), lit=True), 0.4))
            scene.renderer.AddActor(translucent(sphere(0.3, color=(0.2, 1, 0.2), lit=True), 0.6))
            scene.look(parallel=False)
            scene.pixels()
            pictures.append(scene.pixels())
        # VTK blends its peels in 8 bits, four of them
        self.assertLessEqual(np.abs(pictures[0] - pictures[1]).max(), 4.0 / 255)

    def test_images_take_part(self):
        scene, _ = fog_scene()
        slice_mapper = vtkImageSliceMapper()
        slice_mapper.SetInputDataObject(image(np.full((1, 9, 9), 255, np.uint8), (0.1, 0.1, 0.1)))
        picture = vtkImageSlice()
        picture.SetMapper(slice_mapper)
        picture.GetProperty().SetOpacity(0.5)
        picture.GetProperty().SetColorWindow(100)
        picture.ForceTranslucentOn()
        scene.renderer.AddViewProp(picture)
        expected = through([0.0], color=np.ones(3))
        np.testing.assert_allclose(scene.pixels()[45, 45], expected, atol=2.0 / 255)

    def test_props_are_as_before_after_a_frame(self):
        scene, _ = fog_scene()
        plane = translucent(square(0.8, color=tuple(RED)))
        scene.renderer.AddActor(plane)
        scene.pixels()
        time = plane.GetMTime()
        scene.pixels()
        self.assertEqual(plane.GetMTime(), time)
        keys = plane.GetPropertyKeys()
        self.assertEqual(keys.GetNumberOfKeys() if keys else 0, 0)
        self.assertTrue(plane.GetVisibility())

    def test_layers_are_peeled_only_when_something_changed(self):
        scene, mapper = fog_scene()
        plane = translucent(square(0.8, color=tuple(RED)))
        scene.renderer.AddActor(plane)
        scene.pixels()
        scene.pixels()
        self.assertTrue(mapper.GetReusedLastFrame())
        plane.GetProperty().SetColor(0, 1, 0)
        pixels = scene.pixels()
        self.assertFalse(mapper.GetReusedLastFrame())
        np.testing.assert_allclose(
            pixels[45, 45], through([0.0], color=np.array((0, 1, 0))), atol=2.0 / 255
        )

    def test_resizing_and_releasing_leave_the_picture(self):
        scene, mapper = fog_scene()
        scene.renderer.AddActor(translucent(square(0.8, 0.1, color=tuple(RED))))
        for size in (64, 130, 90):
            scene.window.SetSize(size, size)
            pixels = scene.pixels()
            np.testing.assert_allclose(
                pixels[size // 2, size // 2], through([0.1]), atol=2.0 / 255
            )
        mapper.ReleaseGraphicsResources(scene.window)
        np.testing.assert_array_equal(scene.pixels(), pixels)

    def test_a_viewport_has_its_own_layers(self):
        scene = Scene((180, 90), viewports=((0, 0, 0.5, 1), (0.5, 0, 1, 1)), background=tuple(BACKGROUND))
        for renderer, height in zip(scene.renderers, (0.2, -0.3)):
            _, mapper = scene.add_volume(
                cube(np.ones((17, 17, 17))), volume_property(1.0, 0.5, 0.5, WHITE), renderer=renderer
            )
            mapper.SetOcclusionStrength(0.0)
            renderer.AddActor(translucent(square(0.8, height, color=tuple(RED))))
            scene.look(renderer=renderer)
        pixels = scene.pixels()
        for x, height in ((45, 0.2), (135, -0.3)):
            np.testing.assert_allclose(pixels[45, x], through([height]), atol=2.0 / 255)

    def test_layers_go_with_structure(self):
        """A plane through a ball: brute force over heights of an opaque plane."""
        scene = Scene((80, 80), background=(0, 0, 0))
        _, mapper = scene.add_volume(cube(ball(24)), volume_property(1.0, 0.9, 0.2))
        mapper.SetOcclusionStrength(0.0)
        scene.look((0.3, 0.2, -1), parallel=False)
        scene.pixels()
        whole = float_image(mapper)
        plane = square(0.8, 0.07, color=(1, 1, 1))
        scene.renderer.AddActor(plane)
        scene.pixels()
        opaque = float_image(mapper)  # the part in front, over white
        translucent(plane, 0.35)
        scene.pixels()
        # blending is linear in the layer's alpha
        mask = opaque[..., 3] == 1.0
        expected = np.where(mask[..., None], 0.35 * opaque + 0.65 * whole, whole)
        # rays end at alpha 0.998
        self.assertLessEqual(np.abs(float_image(mapper) - expected)[2:-2, 2:-2].max(), 3e-3)


if __name__ == "__main__":
    unittest.main()
