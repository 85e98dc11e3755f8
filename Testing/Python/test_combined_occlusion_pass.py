# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionPass in a chain of render passes."""
import unittest

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401 (registers the factories)
from occlusion_scene import Messages, Scene, ball, cube, float_image, sphere, square, volume_property
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkHardwareSelector, vtkTextMapper
from vtkmodules.vtkRenderingOpenGL2 import (
    vtkCameraPass,
    vtkLightsPass,
    vtkOverlayPass,
    vtkRenderPassCollection,
    vtkSequencePass,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionPass


def set_chain(renderer):
    """Camera, then lights, our pass, annotation."""
    ours = vtkChiCombinedOcclusionPass()
    passes = vtkRenderPassCollection()
    for item in (vtkLightsPass(), ours, vtkOverlayPass()):
        passes.AddItem(item)
    sequence = vtkSequencePass()
    sequence.SetPasses(passes)
    camera = vtkCameraPass()
    camera.SetDelegatePass(sequence)
    renderer.SetPass(camera)
    return ours


def fill(scene, renderer, shiny=0.4):
    _, mapper = scene.add_volume(cube(ball(24)), volume_property(1.0, 0.6, 0.2), renderer=renderer)
    round_one = sphere(0.2, (0.3, 0.1, 0.3), color=(0.9, 0.8, 0.5), lit=True)
    round_one.GetProperty().SetSpecular(shiny)
    renderer.AddActor(round_one)
    renderer.AddActor(square(0.9, -0.4, color=(0.5, 0.6, 0.9)))
    renderer.SetBackground(0.1, 0.2, 0.3)
    scene.look((0.2, 0.3, -1), parallel=False, renderer=renderer)
    return mapper


class Draws:
    """How often the mappers of a renderer's actors have drawn."""

    def __init__(self, renderer):
        self.count = 0
        actors = renderer.GetActors()
        for i in range(actors.GetNumberOfItems()):
            actors.GetItemAsObject(i).GetMapper().AddObserver("StartEvent", self.add)

    def add(self, _caller, _event):
        self.count += 1

    def take(self):
        count, self.count = self.count, 0
        return count


def pair(size=(90, 90), setup=None, **options):
    """The same scene under the stock pipeline and in a chain: scenes, mappers, the pass."""
    scenes, mappers = [], []
    for _ in range(2):
        scene = Scene(size, **options)
        for renderer in scene.renderers:
            mappers.append(fill(scene, renderer))
        if setup:
            setup(scene)
        scenes.append(scene)
    return scenes, mappers, [set_chain(renderer) for renderer in scenes[1].renderers]


class TestCombinedOcclusionPass(unittest.TestCase):
    def test_the_picture_is_that_of_the_stock_pipeline(self):
        scenes, mappers, _ = pair()
        messages = Messages(mappers[1])
        stock, chain = scenes[0].pixels(), scenes[1].pixels()
        self.assertGreater(stock.std(), 0.05)
        np.testing.assert_allclose(chain, stock, atol=1.01 / 255)
        np.testing.assert_array_equal(float_image(mappers[0]), float_image(mappers[1]))
        self.assertEqual(messages.warnings + messages.errors, [])

    def test_geometry_is_drawn_once_and_not_at_all_when_nothing_changed(self):
        scenes, mappers, passes = pair()
        draws = [Draws(scene.renderer) for scene in scenes]
        for scene in scenes:
            scene.pixels()
        counts = [item.take() for item in draws]
        self.assertEqual(counts, [4, 2])  # two actors
        for scene in scenes:
            scene.renderer.GetActiveCamera().Azimuth(3)
            scene.pixels()
        self.assertEqual([item.take() for item in draws], [4, 2])
        for scene in scenes:
            scene.pixels()
        self.assertEqual([item.take() for item in draws], [2, 0])
        self.assertTrue(passes[0].GetReusedGeometry())
        self.assertTrue(mappers[1].GetReusedLastFrame())

    def test_viewports_and_sizes(self):
        scenes, _, passes = pair((160, 80), viewports=((0, 0, 0.5, 1), (0.5, 0.25, 1, 1)))
        for size in ((160, 80), (90, 120), (160, 80)):
            for scene in scenes:
                scene.window.SetSize(size)
            np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=1.01 / 255)
            self.assertEqual(passes[0].GetColorTexture().GetWidth(), size[0] // 2)
            self.assertEqual(passes[1].GetDepthTexture().GetHeight(), 3 * size[1] // 4)
            self.assertIsNotNone(passes[0].GetSpecularTexture())

    def test_resources_are_released_and_made_again(self):
        scenes, _, passes = pair()
        expected = scenes[1].pixels()
        for _ in range(3):
            passes[0].ReleaseGraphicsResources(scenes[1].window)
            np.testing.assert_array_equal(scenes[1].pixels(), expected)
        scenes[1].renderer.SetPass(None)
        passes[0].ReleaseGraphicsResources(scenes[1].window)
        np.testing.assert_allclose(scenes[1].pixels(), expected, atol=1.01 / 255)

    def test_anti_aliasing_is_that_of_the_stock_pipeline(self):
        scenes, mappers, _ = pair()
        for mode in (1, 2, 3):
            for mapper in mappers:
                mapper.SetGeometryAntiAliasing(mode)
            np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=2.01 / 255)

    def test_translucent_geometry_is_that_of_the_stock_pipeline(self):
        def glass(scene):
            prop = square(0.5, 0.1, color=(1, 0, 0))
            prop.GetProperty().SetOpacity(0.5)
            scene.renderer.AddActor(prop)

        scenes, _, _ = pair(setup=glass)
        scenes[1].pixels()
        np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=1.01 / 255)

    def test_depths_are_those_of_the_stock_pipeline(self):
        scenes, _, _ = pair()
        for scene in scenes:
            scene.pixels()
        places = ((45, 45), (60, 50), (20, 30), (2, 2))
        depths = [[scene.renderer.GetZ(*place) for place in places] for scene in scenes]
        self.assertEqual(depths[0], depths[1])

    def test_without_our_mapper_it_is_opaque_and_volumetric_pass(self):
        def replace(scene):
            mapper = vtkOpenGLGPUVolumeRayCastMapper()
            mapper.SetInputDataObject(cube(ball(24)))
            mapper.UseJitteringOff()
            scene.renderer.GetVolumes().GetItemAsObject(0).SetMapper(mapper)

        scenes, _, _ = pair(setup=replace)
        np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=1.01 / 255)
        for scene in scenes:
            scene.renderer.GetVolumes().GetItemAsObject(0).VisibilityOff()
        np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=1.01 / 255)

    def test_the_delegate_may_be_none(self):
        scenes, _, passes = pair()
        self.assertTrue(passes[0].GetDelegatePass().IsA("vtkVolumetricPass"))
        passes[0].SetDelegatePass(None)
        scenes[0].renderer.GetVolumes().GetItemAsObject(0).VisibilityOff()
        np.testing.assert_allclose(scenes[1].pixels(), scenes[0].pixels(), atol=1.01 / 255)

    def test_annotation_and_empty_scenes(self):
        scene = Scene((60, 60), background=(0.2, 0.4, 0.6))
        ours = set_chain(scene.renderer)
        np.testing.assert_allclose(scene.pixels(), np.broadcast_to((0.2, 0.4, 0.6), (60, 60, 3)), atol=0.51 / 255)
        self.assertIsNone(ours.GetColorTexture())
        text = vtkTextMapper()
        text.SetInput("depth")
        label = vtkActor2D()
        label.SetMapper(text)
        label.SetPosition(5, 20)
        scene.renderer.AddActor2D(label)
        self.assertGreater(scene.pixels().max(), 0.9)

    def test_a_selection_finds_the_actors(self):
        scenes, _, _ = pair()
        found = []
        for scene in scenes:
            scene.pixels()
            selector = vtkHardwareSelector()
            selector.SetRenderer(scene.renderer)
            selector.SetArea(0, 0, 89, 89)
            selector.SetFieldAssociation(vtkDataObject.FIELD_ASSOCIATION_CELLS)
            found.append(selector.Select().GetNumberOfNodes())
        self.assertGreaterEqual(found[0], 2)
        self.assertEqual(found[0], found[1])


if __name__ == "__main__":
    unittest.main()
