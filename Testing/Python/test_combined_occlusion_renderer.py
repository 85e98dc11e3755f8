# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: several volumes, and the renderer around them."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Messages,
    Scene,
    ball,
    cube,
    float_image,
    sphere,
    square,
    volume_property,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkRenderingCore import (
    vtkAssembly,
    vtkHardwareSelector,
    vtkRenderer,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper


class SeveralVolumes(unittest.TestCase):
    def build(self, order, direction, parallel=True, geometry=False):
        n = 20
        parts = {
            "near": (cube(ball(n), 0.8, (0.1, 0.05, 0.6)), ((0, (1, 0.2, 0.2)), (1, (1, 0.2, 0.2)))),
            "far": (cube(ball(n), 0.8, (-0.1, 0.0, -0.6)), ((0, (0.2, 1, 0.2)), (1, (0.2, 1, 0.2)))),
        }
        scene = Scene((96, 96), background=(0.1, 0.2, 0.4))
        mappers = []
        for name in order:
            data, colors = parts[name]
            _, mapper = scene.add_volume(data, volume_property(1.0, 0.5, 0.1, colors))
            mappers.append(mapper)
        if geometry:
            scene.renderer.AddActor(square(0.9, 0.0, color=(0.8, 0.8, 0.8)))
        scene.look(direction, half=1.0, parallel=parallel)
        return scene.pixels(), [float_image(mapper) for mapper in mappers]

    def test_disjoint_volumes_equal_each_alone_composited_by_depth(self):
        background = np.array([0.1, 0.2, 0.4])
        for direction, front in (((0.1, 0.1, -1), "near"), ((0.1, 0.1, 1), "far"), ((0.3, -0.2, -1), "near")):
            for parallel in (True, False):
                with self.subTest(direction=direction, parallel=parallel):
                    alone = {
                        name: self.build([name], direction, parallel)[1][0] for name in ("near", "far")
                    }
                    first = alone[front]
                    second = alone["far" if front == "near" else "near"]
                    both = first + (1.0 - first[..., 3:]) * second
                    expected = both[..., :3] + (1.0 - both[..., 3:]) * background
                    self.assertGreater(((first[..., 3] > 0.1) & (second[..., 3] > 0.1)).sum(), 50)
                    for order in (("near", "far"), ("far", "near")):
                        pixels, _ = self.build(order, direction, parallel)
                        # 8 bits: the background, and of each layer its colour, alpha and the result
                        self.assertLessEqual(255.0 * np.abs(pixels - expected).max(), 3.01)

    def test_the_order_of_insertion_does_not_show_with_geometry_either(self):
        one, _ = self.build(("near", "far"), (0.1, 0.1, -1), geometry=True)
        other, _ = self.build(("far", "near"), (0.1, 0.1, -1), geometry=True)
        difference = 255.0 * np.abs(one - other).max(axis=2)
        # the volumes' shadows on the square are factors; its own is taken with the first of them
        self.assertLessEqual(difference.mean(), 1.0)

    def test_one_mapper_may_serve_two_volumes(self):
        data, prop = cube(ball(16), 0.8), volume_property(1.0, 0.5, 0.1)
        places = ((-0.2, 0.0, -0.6), (0.1, 0.1, 0.6))
        pictures = []
        for shared in (False, True):
            scene = Scene((64, 64))
            mapper = None
            for place in places:
                volume, mapper = scene.add_volume(data, prop, mapper if shared else None)
                volume.SetPosition(place)
            scene.look(half=1.0)
            scene.window.Render()
            pictures.append(scene.pixels())
        self.assertGreater(pictures[0].max(), 0.3)
        self.assertEqual(np.abs(pictures[0] - pictures[1]).max(), 0.0)

    def test_hiding_one_volume_shows_the_other_alone(self):
        for hidden in (0, 1):
            scene = Scene((64, 64))
            volumes = [
                scene.add_volume(cube(ball(16), 0.8, (0, 0, z)), volume_property(1.0, 0.5, 0.1))[0]
                for z in (-0.6, 0.6)
            ]
            scene.look(half=1.0)
            for volume in volumes:
                volume.VisibilityOff()
            volumes[1 - hidden].VisibilityOn()
            expected = scene.pixels()
            volumes[hidden].VisibilityOn()
            both = scene.pixels()
            self.assertGreater(np.abs(both - expected).max(), 0.05)
            volumes[hidden].VisibilityOff()
            self.assertEqual(np.abs(scene.pixels() - expected).max(), 0.0)

    def test_a_volume_of_another_mapper_is_drawn_over_as_vtk_does(self):
        scene = Scene((64, 64))
        scene.add_volume(cube(ball(20), 0.8, (0, 0, -0.6)), volume_property(1.0, 0.5, 0.1))
        scene.add_volume(
            cube(ball(20), 0.5, (0, 0, 0.6)),
            volume_property(1.0, 0.99, 0.01, WHITE),
            vtkOpenGLGPUVolumeRayCastMapper(),
        )
        scene.look(half=1.0)
        self.assertGreater(scene.pixels()[32, 32].min(), 0.9)


class Renderer(unittest.TestCase):
    def fill(self, scene, renderer):
        _, mapper = scene.add_volume(cube(ball(24), 1.2), volume_property(unit=0.1), renderer=renderer)
        renderer.AddActor(sphere(0.3, (0.3, 0.2, 0.2), lit=True, color=(0.9, 0.6, 0.2)))
        scene.look((0.3, 0.2, -1.0), half=0.9, parallel=False, renderer=renderer)
        return mapper

    def test_two_viewports_each_show_the_picture_of_a_window_of_their_size(self):
        alone = Scene((80, 90))
        self.fill(alone, alone.renderer)
        expected = alone.pixels()
        pair = Scene((160, 90), viewports=((0, 0, 0.5, 1), (0.5, 0, 1, 1)))
        for renderer in pair.renderers:
            self.fill(pair, renderer)
        pixels = pair.pixels()
        self.assertGreater(expected.max(), 0.5)
        self.assertEqual(np.abs(pixels[:, :80] - expected).max(), 0.0)
        self.assertEqual(np.abs(pixels[:, 80:] - expected).max(), 0.0)

    def test_one_mapper_in_two_windows_and_two_renderers(self):
        first = Scene((64, 64))
        mapper = self.fill(first, first.renderer)
        expected = first.pixels()
        second = Scene((64, 64))
        second.add_volume(
            mapper.GetInput(), volume_property(unit=0.1), mapper=mapper
        )
        second.renderer.AddActor(sphere(0.3, (0.3, 0.2, 0.2), lit=True, color=(0.9, 0.6, 0.2)))
        second.look((0.3, 0.2, -1.0), half=0.9, parallel=False)
        self.assertEqual(np.abs(second.pixels() - expected).max(), 0.0)
        self.assertEqual(np.abs(first.pixels() - expected).max(), 0.0)

    def test_the_state_of_opengl_is_restored(self):
        plain = Scene((160, 80), viewports=((0, 0, 0.5, 1), (0.5, 0, 1, 1)))
        mixed = Scene((160, 80), viewports=((0, 0, 0.5, 1), (0.5, 0, 1, 1)))
        self.fill(mixed, mixed.renderers[0])
        for scene in (plain, mixed):
            renderer = scene.renderers[1]
            renderer.AddActor(sphere(0.5, (0.3, 0.0, 0.0), lit=True))
            glass = sphere(0.5, (-0.3, 0.0, 0.0), lit=True, color=(1.0, 0.3, 0.3))
            glass.GetProperty().SetOpacity(0.4)
            renderer.AddActor(glass)
            scene.look(half=1.0, renderer=renderer)
        for _ in range(2):
            self.assertEqual(np.abs(plain.pixels()[:, 80:] - mixed.pixels()[:, 80:]).max(), 0.0)

    def test_a_layer_above_keeps_the_volume_below(self):
        scene = Scene((80, 80))
        self.fill(scene, scene.renderer)
        expected = scene.pixels()
        scene.window.SetNumberOfLayers(2)
        top = vtkRenderer()
        top.SetLayer(1)
        scene.window.AddRenderer(top)
        top.AddActor(square(0.1))
        scene.look(half=1.0, renderer=top)
        pixels = scene.pixels()
        self.assertEqual(np.abs(pixels[:30] - expected[:30]).max(), 0.0)
        self.assertEqual(pixels[40, 40].min(), 1.0)

    def test_an_unchanged_frame_is_reused_and_each_change_is_seen(self):
        scene = Scene((64, 64))
        mapper = self.fill(scene, scene.renderer)
        prop = scene.renderer.GetActors().GetLastActor()
        volume = scene.renderer.GetVolumes().GetLastProp()

        def frame():
            scene.window.Render()
            return mapper.GetReusedLastFrame(), mapper.GetReusedGeometry()

        self.assertEqual(frame(), (False, False))
        first = scene.pixels()
        self.assertEqual(frame(), (True, True))
        self.assertEqual(np.abs(scene.pixels() - first).max(), 0.0)
        self.assertEqual(mapper.GetSecondsGeometry(), 0.0)
        # a colour of the geometry is no matter for the engine
        prop.GetProperty().SetColor(0.1, 0.6, 0.2)
        self.assertEqual(frame(), (True, False))
        self.assertGreater(np.abs(scene.pixels() - first).max(), 0.1)
        volume.GetProperty().GetScalarOpacity(0).AddPoint(0.5, 0.4)
        self.assertEqual(frame(), (False, True))
        self.assertEqual(frame(), (True, True))
        prop.SetPosition(0.1, 0.0, 0.0)
        self.assertEqual(frame(), (False, False))
        scene.renderer.GetActiveCamera().Azimuth(1.0)
        self.assertEqual(frame(), (False, False))
        mapper.SetOcclusionStrength(0.5)
        self.assertEqual(frame(), (False, True))
        mapper.GetInput().GetPointData().GetScalars().Modified()
        self.assertEqual(frame(), (False, True))
        volume.SetPosition(0.0, 0.1, 0.0)
        self.assertEqual(frame(), (False, True))

    def test_a_screenshot_does_not_render_again(self):
        scene = Scene((64, 64))
        mapper = self.fill(scene, scene.renderer)  # in perspective: the filter sets the view angle
        expected = scene.pixels()
        grab = vtkWindowToImageFilter()
        grab.SetInput(scene.window)
        grab.SetInputBufferTypeToRGB()
        grab.Update()
        self.assertTrue(mapper.GetReusedLastFrame())
        self.assertTrue(mapper.GetReusedGeometry())
        shot = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(64, 64, 3)
        self.assertLess(np.abs(shot / 255.0 - expected).max(), 1e-9)

    def test_a_part_of_an_assembly_that_moves_or_changes_shape_is_seen(self):
        scene = Scene((64, 64))
        _, mapper = scene.add_volume(cube(ball(16), 1.2), volume_property(unit=0.1))
        part = sphere(0.2, (0.4, 0.3, 0.5))
        assembly = vtkAssembly()
        assembly.AddPart(part)
        scene.renderer.AddActor(assembly)
        scene.look(half=1.0)
        scene.window.Render()
        scene.window.Render()
        self.assertTrue(mapper.GetReusedGeometry())
        before = float_image(mapper)
        part.SetPosition(-0.2, 0.0, 0.0)
        scene.window.Render()
        self.assertFalse(mapper.GetReusedGeometry())
        moved = float_image(mapper)
        self.assertGreater(np.abs(moved - before).max(), 0.5)
        part.GetMapper().GetInputAlgorithm().SetRadius(0.4)
        scene.window.Render()
        self.assertFalse(mapper.GetReusedGeometry())
        self.assertGreater(float_image(mapper)[..., 3].sum(), moved[..., 3].sum())

    def test_a_window_of_one_pixel(self):
        scene = Scene((1, 1))
        mapper = self.fill(scene, scene.renderer)
        scene.window.SetSize(1, 1)
        scene.look(half=0.5)
        scene.window.Render()
        picture = float_image(mapper)
        self.assertTrue(np.isfinite(picture).all())

    def test_nothing_to_draw_leaves_the_background(self):
        scene = Scene((40, 40), background=(0.2, 0.4, 0.6))
        _, mapper = scene.add_volume(cube(np.zeros((8, 8, 8))))
        messages = Messages(mapper)
        scene.look()
        expected = np.round(255.0 * np.array([0.2, 0.4, 0.6])) / 255.0
        self.assertLess(np.abs(scene.pixels() - expected).max(), 1e-9)
        self.assertEqual((messages.errors, messages.warnings), ([], []))
        self.assertEqual(float_image(mapper).max(), 0.0)
        self.assertEqual(mapper.GetNumberOfSamples(), 0)

    def test_a_volume_nearer_than_the_near_plane_is_not_drawn(self):
        for parallel in (True, False):
            for geometry in (False, True):
                with self.subTest(parallel=parallel, geometry=geometry):
                    scene = Scene((40, 40))
                    _, mapper = scene.add_volume(cube(ball(16)))
                    messages = Messages(mapper)
                    scene.renderer.GetCullers().RemoveAllItems()  # else the mapper is not asked
                    if geometry:
                        scene.renderer.AddActor(square(0.5, -2.0))
                    scene.look(half=1.0, parallel=parallel)
                    camera = scene.renderer.GetActiveCamera()
                    camera.SetClippingRange(camera.GetDistance() + 1.0, camera.GetDistance() + 4.0)
                    pixels = scene.pixels()
                    self.assertEqual((messages.errors, messages.warnings), ([], []))
                    self.assertGreater(mapper.GetSecondsTotal(), 0.0)
                    self.assertEqual(pixels[20, 20, 0], 1.0 if geometry else 0.0)

    def test_a_selection_finds_the_volume_and_the_actor_that_stands_out_of_it(self):
        scene = Scene((64, 64))
        self.fill(scene, scene.renderer)
        target = scene.renderer.GetActors().GetLastActor()
        scene.window.Render()
        selector = vtkHardwareSelector()
        selector.SetRenderer(scene.renderer)
        selector.SetArea(0, 0, 63, 63)
        selector.SetFieldAssociation(vtkDataObject.FIELD_ASSOCIATION_CELLS)
        selection = selector.Select()
        props = {selection.GetNode(i).GetProperties().Get(selection.GetNode(i).PROP()) for i in range(selection.GetNumberOfNodes())}
        self.assertEqual(props, {target, scene.renderer.GetVolumes().GetLastProp()})

    def test_depth_peeling_of_volumes_gives_the_same_picture(self):
        pictures = []
        for peel in (False, True):
            scene = Scene((80, 80))
            mapper = self.fill(scene, scene.renderer)
            messages = Messages(mapper)
            glass = square(0.5, 0.8, color=(0.2, 0.9, 0.2))
            glass.SetPosition(-0.6, -0.6, 0.0)
            glass.GetProperty().SetOpacity(0.5)
            scene.renderer.AddActor(glass)
            scene.renderer.SetUseDepthPeeling(peel)
            scene.renderer.SetUseDepthPeelingForVolumes(peel)
            scene.renderer.SetMaximumNumberOfPeels(4)
            scene.window.Render()
            pictures.append(scene.pixels())
            pictures.append(float_image(mapper))
            self.assertEqual(messages.warnings, [])
        # the pictures agree, glass included, but for blending in 8 bits
        self.assertGreater(pictures[0].max(), 0.5)
        self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[2]).max(), 2.01)
        self.assertEqual(np.abs(pictures[1] - pictures[3]).max(), 0.0)

    def test_multisampled_edges_stay_as_they_are(self):
        pictures = []
        for with_volume in (False, True):
            scene = Scene((64, 64))
            scene.window.SetMultiSamples(4)
            scene.renderer.AddActor(sphere(0.3, (-0.5, 0.2, 0.0), lit=True))
            if with_volume:
                volume, mapper = scene.add_volume(cube(ball(16), 0.5))
                volume.SetPosition(0.6, 0.0, 0.0)
                mapper.SetGeometryOcclusion(False)
            scene.look(half=1.0)
            pictures.append(scene.pixels()[:, :32])
        self.assertGreater(len(np.unique(pictures[0])), 20)
        self.assertEqual(np.abs(pictures[0] - pictures[1]).max(), 0.0)

    def test_a_transparent_window_gets_premultiplied_colour_and_alpha(self):
        scene = Scene((64, 64))
        scene.window.SetAlphaBitPlanes(1)
        scene.renderer.SetBackgroundAlpha(0.0)
        mapper = self.fill(scene, scene.renderer)
        scene.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(scene.window)
        grab.SetInputBufferTypeToRGBA()
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(64, 64, 4)
        # 8 bits: the picture before it is blended, and the result
        self.assertLessEqual(np.abs(pixels - 255.0 * float_image(mapper)).max(), 1.01)

    def test_tiles_fit_together(self):
        for parallel in (True, False):
            with self.subTest(parallel=parallel):
                whole, tiled = Scene((128, 128)), Scene((64, 64))
                for scene in (whole, tiled):
                    mapper = self.fill(scene, scene.renderer)
                    mapper.SetOcclusionStrength(0.0)  # light does not cross the border of a tile
                    scene.look((0.3, 0.2, -1.0), half=0.9, parallel=parallel)
                expected = whole.pixels()
                grab = vtkWindowToImageFilter()
                grab.SetInput(tiled.window)
                grab.SetScale(2)
                grab.SetInputBufferTypeToRGB()
                grab.ReadFrontBufferOff()
                grab.Update()
                pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
                difference = np.abs(pixels.reshape(128, 128, 3) - 255.0 * expected).max(axis=2)
                # the silhouette of the sphere may be rasterised otherwise
                self.assertLessEqual(np.percentile(difference, 99.0), 1.0)

    def test_each_eye_of_a_stereo_pair_gets_its_own_picture(self):
        scene = Scene((128, 64))
        self.fill(scene, scene.renderer)
        scene.window.StereoCapableWindowOn()
        scene.window.SetStereoTypeToSplitViewportHorizontal()
        scene.window.StereoRenderOn()
        scene.renderer.GetActiveCamera().SetEyeAngle(10.0)
        pixels = scene.pixels()
        left, right = pixels[:, :64], pixels[:, 64:]
        self.assertGreater(min(left.max(), right.max()), 0.5)
        self.assertGreater(np.abs(left - right).max(), 0.1)

    def test_a_view_that_scales_and_mirrors_the_world_is_followed(self):
        transform = vtkTransform()
        transform.Scale(-0.5, 0.5, 0.5)
        pictures = []
        for by_view in (True, False):
            scene = Scene((96, 96))
            volume, mapper = scene.add_volume(
                cube(ball(24, 0.3, 0.2, (0.1, 0.1, 0.0)), 1.2), volume_property(unit=0.1)
            )
            prop = sphere(0.3, (0.3, 0.2, 0.2))
            scene.renderer.AddActor(prop)
            scene.look(half=0.7)
            if by_view:
                camera = scene.renderer.GetActiveCamera()
                camera.SetModelTransformMatrix(transform.GetMatrix())
            else:
                volume.SetUserTransform(transform)
                prop.SetUserTransform(transform)
            scene.window.Render()
            pictures.append(float_image(mapper))
        self.assertGreater(pictures[0][..., 3].max(), 0.9)
        self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[1]).mean(), 0.1)

    def test_errors_come_back_after_a_good_frame(self):
        scene = Scene((32, 32))
        _, mapper = scene.add_volume(cube(ball(8)))
        messages = Messages(mapper)
        scene.look()
        for mode, errors in ((3, 1), (3, 1), (0, 1), (3, 2)):
            mapper.SetScalarMode(mode)
            mapper.SelectScalarArray("missing")
            scene.window.Render()
            self.assertEqual(len(messages.errors), errors)

    def test_too_many_slices_is_an_error_that_names_the_setting(self):
        scene = Scene((32, 32))
        _, mapper = scene.add_volume(cube(ball(8)))
        messages = Messages(mapper)
        mapper.SetSampleDistance(1e-12)
        scene.look()
        scene.window.Render()
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("SampleDistance", messages.errors[0])

    def test_removing_and_adding_again_works(self):
        scene = Scene((64, 64))
        self.fill(scene, scene.renderer)
        expected = scene.pixels()
        volume = scene.renderer.GetVolumes().GetLastProp()
        scene.renderer.RemoveViewProp(volume)
        without = scene.pixels()
        self.assertGreater(np.abs(without - expected).max(), 0.1)
        scene.renderer.AddVolume(volume)
        self.assertEqual(np.abs(scene.pixels() - expected).max(), 0.0)


if __name__ == "__main__":
    unittest.main()
