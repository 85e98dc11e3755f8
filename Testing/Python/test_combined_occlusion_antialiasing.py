# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Silhouettes of opaque geometry, against volume and background."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Messages,
    Scene,
    actor,
    ball,
    cube,
    float_image,
    sphere,
    square,
    volume_property,
)
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkTubeFilter
from vtkmodules.vtkRenderingCore import vtkRenderer

NONE, MULTISAMPLE, FXAA, BOTH = range(4)


def tubes(count=16, radius=0.03, seed=1):
    """Bent tubes of a few pixels' width all over the picture."""
    random = np.random.default_rng(seed)
    points, cells = vtkPoints(), vtkCellArray()
    for _ in range(count):
        a, b, c = random.uniform(-1, 1, (3, 3))
        line = 0.6 * np.sin(np.outer(np.linspace(0, 1, 40), 3 * a) + 3 * b) + 0.2 * c
        cells.InsertNextCell(len(line))
        for place in line:
            cells.InsertCellPoint(points.InsertNextPoint(place))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(cells)
    tube = vtkTubeFilter()
    tube.SetInputData(data)
    tube.SetRadius(radius)
    tube.SetNumberOfSides(12)
    return tube


def tube_scene(size, mode, opacity=0.6, strength=0.0):
    scene = Scene((size, size), background=(0.15, 0.2, 0.3))
    _, mapper = scene.add_volume(cube(ball(24)), volume_property(1.0, opacity, 0.2))
    mapper.SetOcclusionStrength(strength)
    mapper.VicinityOcclusionOff()
    mapper.SetGeometryAntiAliasing(mode)
    scene.renderer.AddActor(actor(tubes(), color=(0.9, 0.8, 0.6), lit=True))
    scene.look((0.3, 0.2, -1), half=0.8, parallel=False)
    return scene, mapper


def supersampled(size, **options):
    scene, _ = tube_scene(4 * size, NONE, **options)
    return scene.pixels().reshape(size, 4, size, 4, 3).mean((1, 3))


def rms(a, b):
    return float(np.sqrt(np.mean((a - b) ** 2)))


class TestGeometryAntiAliasing(unittest.TestCase):
    def test_error_against_supersampling_falls(self):
        for options in ({"opacity": 0.6, "strength": 1.0}, {"opacity": 0.0}):
            reference = supersampled(80, **options)
            errors = [rms(tube_scene(80, mode, **options)[0].pixels(), reference) for mode in range(4)]
            # four samples leave about 0.4 of the error of one; more where light, whose buffers are
            # coarser, has an error of its own
            self.assertLess(errors[MULTISAMPLE], 0.6 * errors[NONE], options)
            self.assertLess(errors[FXAA], 0.85 * errors[NONE], options)
            self.assertLess(errors[BOTH], errors[FXAA], options)

    def test_both_parts_of_a_pixel_have_their_own_volume(self):
        """A square in the middle of fog: an edge's pixel is a share of it, with half the fog in
        front, and of the background, with all of it."""
        color, background = np.array((0.9, 0.2, 0.1)), np.array((0.1, 0.3, 0.8))
        scene = Scene((90, 90), background=tuple(background))
        _, mapper = scene.add_volume(cube(np.ones((17, 17, 17)), 1.6), volume_property(1.0, 0.5, 0.5, WHITE))
        mapper.SetOcclusionStrength(0.0)
        mapper.SetGeometryAntiAliasingToMultiSample()
        plate = square(0.5, color=tuple(color))
        plate.RotateZ(10)
        scene.renderer.AddActor(plate)
        scene.look()
        pixels = scene.pixels()
        inside = 1 - 0.5**1.6 + 0.5**1.6 * color
        outside = 1 - 0.5**3.2 + 0.5**3.2 * background
        along = inside - outside
        share = ((pixels - outside) @ along / (along @ along))[25:65, 12:78]
        # a mixture of both, but for 8 bits
        mixture = outside + share[..., None] * along
        np.testing.assert_allclose(pixels[25:65, 12:78], mixture, atol=1.5 / 255)
        part = (share > 0.02) & (share < 0.98)
        self.assertGreater(part.sum(), 50)
        # each row between the corners: the square's width in pixels, at 10 degrees
        np.testing.assert_allclose(share[3:-3].sum(1), 1.0 * 45 / np.cos(np.radians(10)), atol=0.6)

    def test_none_is_the_default_and_leaves_vtks_pixels(self):
        scene, mapper = tube_scene(80, NONE)
        self.assertEqual(mapper.GetGeometryAntiAliasing(), NONE)
        scene.pixels()
        self.assertEqual(set(np.unique(float_image(mapper)[..., 3] == 1.0)), {False, True})

    def test_the_first_frame_is_as_the_second(self):
        for mode in range(4):
            scene, _ = tube_scene(60, mode)
            first = scene.pixels()
            np.testing.assert_array_equal(scene.pixels(), first)

    def test_a_multisampled_window_shows_the_same(self):
        pictures = []
        for samples in (0, 4):
            scene, _ = tube_scene(80, MULTISAMPLE)
            scene.window.SetMultiSamples(samples)
            pictures.append(scene.pixels())
        np.testing.assert_allclose(pictures[0], pictures[1], atol=1.01 / 255)

    def test_depth_peeling_for_volumes_shows_the_same(self):
        pictures = []
        for peel in (False, True):
            scene, _ = tube_scene(80, MULTISAMPLE)
            glass = square(0.4, 0.3, color=(1, 0, 0))
            glass.GetProperty().SetOpacity(0.5)
            scene.renderer.AddActor(glass)
            scene.renderer.SetUseDepthPeeling(peel)
            scene.renderer.SetUseDepthPeelingForVolumes(peel)
            pictures.append(scene.pixels())
        np.testing.assert_allclose(pictures[0], pictures[1], atol=1.01 / 255)

    def test_depths_of_the_geometry_stay_in_the_frame_buffer(self):
        depths = []
        for mode in (NONE, MULTISAMPLE):
            scene, _ = tube_scene(80, mode)
            scene.pixels()
            scene.pixels()
            depths.append([scene.renderer.GetZ(x, y) for x, y in ((40, 40), (30, 50), (52, 33), (2, 2))])
        self.assertEqual(depths[0], depths[1])

    def test_layers_below_survive(self):
        scene, _ = tube_scene(80, MULTISAMPLE)
        scene.window.SetNumberOfLayers(2)
        scene.renderer.SetLayer(1)
        below = vtkRenderer()
        below.SetBackground(0.15, 0.2, 0.3)
        scene.window.AddRenderer(below)
        scene.pixels()
        np.testing.assert_allclose(
            scene.pixels(), tube_scene(80, MULTISAMPLE)[0].pixels(), atol=1.01 / 255
        )

    def test_without_the_volume_in_view_vtk_draws_geometry(self):
        scene, _ = tube_scene(60, MULTISAMPLE)
        scene.pixels()
        scene.renderer.GetVolumes().GetItemAsObject(0).SetPosition(50, 0, 0)
        pixels = scene.pixels()
        plain, _ = tube_scene(60, NONE)
        plain.renderer.GetVolumes().GetItemAsObject(0).VisibilityOff()
        np.testing.assert_array_equal(pixels, plain.pixels())

    def test_two_volumes_draw_edges_once(self):
        pictures = []
        for mode, size in ((NONE, 400), (NONE, 100), (MULTISAMPLE, 100)):
            scene, mapper = tube_scene(size, mode)
            _, other = scene.add_volume(cube(ball(12), 0.4, (0.8, 0.0, 0.0)), volume_property(1.0, 0.6, 0.2))
            other.SetOcclusionStrength(0.0)
            other.SetGeometryAntiAliasing(mode)
            pixels = scene.pixels()
            pictures.append(pixels.reshape(100, size // 100, 100, size // 100, 3).mean((1, 3)))
        self.assertLess(rms(pictures[2], pictures[0]), 0.6 * rms(pictures[1], pictures[0]))

    def test_modes_can_be_changed_and_resources_released(self):
        scene, mapper = tube_scene(60, NONE)
        expected = [tube_scene(60, mode)[0].pixels() for mode in range(4)]
        for mode in (1, 0, 3, 2, 1):
            mapper.SetGeometryAntiAliasing(mode)
            # another number of roundings in the first frame after a change
            np.testing.assert_allclose(scene.pixels(), expected[mode], atol=1.01 / 255)
        mapper.ReleaseGraphicsResources(scene.window)
        np.testing.assert_array_equal(scene.pixels(), expected[1])
        scene.window.SetSize(50, 70)
        self.assertEqual(scene.pixels().shape, (70, 50, 3))

    def test_where_it_cannot_be_it_is_said_once(self):
        scene, mapper = tube_scene(60, MULTISAMPLE)
        messages = Messages(mapper)
        scene.renderer.UseHiddenLineRemovalOn()
        pictures = [scene.pixels(), scene.pixels()]
        np.testing.assert_array_equal(pictures[0], pictures[1])
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("multisampled", messages.warnings[0])

    def test_highlights_of_silhouettes_do_not_leak(self):
        """A white, strongly specular ball before black: nowhere brighter than without occlusion."""
        pictures = []
        for strength in (0.0, 1.0):
            scene = Scene((80, 80))
            _, mapper = scene.add_volume(cube(ball(16), 0.5, (0, 0, 0.6)), volume_property(1.0, 0.5, 0.2))
            mapper.SetOcclusionStrength(strength)
            mapper.SetGeometryAntiAliasingToMultiSample()
            shiny = sphere(0.4, lit=True)
            shiny.GetProperty().SetSpecular(1.0)
            scene.renderer.AddActor(shiny)
            scene.look()
            pictures.append(scene.pixels())
        self.assertLessEqual((pictures[1] - pictures[0]).max(), 1.01 / 255)


if __name__ == "__main__":
    unittest.main()
