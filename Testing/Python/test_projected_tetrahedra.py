# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: meshes in a scene, against closed forms."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL, new_mapper
from occlusion_scene import Scene, float_image, sphere, square
from tetrahedra_scene import TetScene, cube, even, extinction, interval, paths, rays
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane
from vtkmodules.vtkCommonTransforms import vtkTransform

from chiaroscuro.vtkChiRendering import vtkChiProjectedTetrahedraMapper

# What the float picture of an even cube may be off by (issue: accuracy of the homogeneous cube).
FLOAT = 1e-4
# Half a step of 8 bits, and that.
BYTES = 0.5 / 255.0 + FLOAT
TAU = 2.0
OBLIQUE = (-0.4, -0.5, -1.0)


def alpha(path, tau=TAU):
    return 1.0 - np.exp(-tau * path)


def even_cube(n=2, tau=TAU, size=(64, 64), direction=OBLIQUE, half=1.0, parallel=False, **options):
    scene = TetScene(cube(n), even(tau), size, **options)
    scene.look(direction, half=half, parallel=parallel)
    return scene


class Cube(InEachEngine):
    def assert_even(self, scene, exact, bound=FLOAT, message=""):
        rgba = scene.rgba()
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
        self.assertLess(np.abs(rgba[..., 3] - exact).max(), bound, message)
        # white: premultiplied colour is alpha
        self.assertLess(np.abs(rgba[..., :3] - rgba[..., 3:]).max(), 1e-6, message)

    def test_is_the_closed_form_however_finely_split_from_wherever_it_is_seen(self):
        for n in (1, 4, 16):
            for parallel in (True, False):
                for direction in ((0, 0, -1), OBLIQUE, (-0.3, 0.2, 0.7)):
                    with self.subTest(n=n, parallel=parallel, direction=direction):
                        scene = even_cube(n, direction=direction, parallel=parallel)
                        self.assert_even(scene, alpha(paths(scene.renderer, 64, 64)))

    def test_is_the_closed_form_from_inside_and_across_the_near_plane(self):
        for near in (0.01, 0.4):
            for center in ((0.0, 0.0, 0.0), (0.1, -0.2, 0.55)):
                with self.subTest(near=near, center=center):
                    scene = even_cube(3)
                    camera = scene.renderer.GetActiveCamera()
                    camera.SetPosition(*center)
                    camera.SetFocalPoint(0.3, 0.2, -1.0)
                    camera.SetViewAngle(70.0)
                    camera.SetClippingRange(near, 5.0)
                    self.assert_even(scene, alpha(paths(scene.renderer, 64, 64)))

    def test_the_window_shows_the_float_picture_over_the_background(self):
        background = np.array((0.2, 0.4, 0.6))
        for samples in (0, 8):
            for dither in (False, True):
                scene = even_cube(background=tuple(background))
                scene.window.SetMultiSamples(samples)
                scene.mapper.SetDither(dither)
                pixels = scene.pixels()
                rgba = float_image(scene.mapper)
                wanted = rgba[..., :3] + (1.0 - rgba[..., 3:]) * background
                with self.subTest(samples=samples, dither=dither):
                    # blended in 8 bits: colour, one minus alpha (times 0.6) and sum are rounded;
                    # dithering moves a colour by at most half a step before
                    bound = BYTES + (0.5 + 0.5 * 0.6) / 255.0 + (0.5 / 255.0 if dither else 0.0)
                    self.assertLess(np.abs(pixels - wanted).max(), bound)
                    exact = alpha(paths(scene.renderer, 64, 64))
                    self.assertLess(np.abs(rgba[..., 3] - exact).max(), FLOAT)

    def test_a_quarter_of_the_window_holds_the_whole_picture(self):
        scene = even_cube(size=(150, 110), viewports=((0.4, 0.5, 1.0, 1.0),))
        pixels = scene.pixels()
        width, height = 90, 55
        exact = alpha(paths(scene.renderer, width, height))
        self.assertEqual(float_image(scene.mapper).shape[:2], (height, width))
        self.assertLess(np.abs(float_image(scene.mapper)[..., 3] - exact).max(), FLOAT)
        self.assertLess(np.abs(pixels[55:, 60:, 0] - exact).max(), BYTES)
        self.assertEqual(pixels[:55].max(), 0.0)
        self.assertEqual(pixels[:, :60].max(), 0.0)
        scene.window.SetSize(100, 80) # another size, the same mapper
        pixels = scene.pixels()
        exact = alpha(paths(scene.renderer, 60, 40))
        self.assertLess(np.abs(pixels[40:, 40:, 0] - exact).max(), BYTES)

    def test_lengths_are_those_of_the_world_whatever_the_matrix(self):
        # the same picture of a cube of edge 1/10 blown up by 10, and of a stretched, turned, mirrored box
        scene = TetScene(cube(2, 0.1), even(TAU))
        scene.volume.SetScale(10.0)
        scene.look(OBLIQUE, half=1.0, parallel=False)
        self.assert_even(scene, alpha(paths(scene.renderer, 64, 64)))
        scene = TetScene(cube(2, 0.1), even(TAU))
        scene.volume.SetScale(10.0, -5.0, 3.0)
        scene.volume.RotateZ(90.0)
        scene.volume.SetPosition(0.1, 0.0, 0.2)
        scene.look(OBLIQUE, half=1.0, parallel=False)
        low, high = (0.1 - 0.25, -0.5, 0.2 - 0.15), (0.1 + 0.25, 0.5, 0.2 + 0.15)
        self.assert_even(scene, alpha(paths(scene.renderer, 64, 64, low, high)))
        matrix = vtkTransform()
        matrix.Scale(10.0, 10.0, 10.0)
        scene = TetScene(cube(2, 0.1), even(TAU))
        scene.volume.SetUserTransform(matrix)
        scene.look(OBLIQUE, half=1.0, parallel=True)
        self.assert_even(scene, alpha(paths(scene.renderer, 64, 64)))

    def test_clipping_planes_cut_at_every_pixel(self):
        scene = even_cube(3)
        for origin, normal in (((0.1, 0, 0), (-1, 0, 0)), ((0, 0, -0.23), (0, 0, 2.0))):
            plane = vtkPlane()
            plane.SetOrigin(origin)
            plane.SetNormal(normal)
            scene.mapper.AddClippingPlane(plane)
        exact = paths(scene.renderer, 64, 64, (-0.5, -0.5, -0.23), (0.1, 0.5, 0.5))
        self.assert_even(scene, alpha(exact))
        scene.mapper.RemoveAllClippingPlanes()
        self.assert_even(scene, alpha(paths(scene.renderer, 64, 64)))

    def test_opacity_means_what_the_convention_says(self):
        # opacity 0.9 over a unit of 1, along a path of 1: VTK's two answers
        for image, wanted in ((False, 1.0 - np.exp(-0.9)), (True, 0.9)):
            scene = TetScene(cube(2), extinction(0.9))
            scene.look(half=0.4) # nothing but cube, straight through
            if image:
                scene.mapper.SetOpacityConventionToImage()
            with self.subTest(image=image):
                self.assert_even(scene, wanted)
                self.assertEqual(scene.mapper.GetUsedUnitDistance(), 1.0)

    def test_the_automatic_unit_is_the_edge_of_a_mean_tetrahedron(self):
        scene = TetScene(cube(3), extinction(0.9, 17.0, ramp=((0.0, 0.9), (1.0, 0.9))))
        scene.mapper.AutomaticUnitDistanceOn()
        scene.volume.SetScale(10.0)
        scene.look(half=4.0)
        scene.window.Render()
        cells = 6 * 27
        unit = np.cbrt(1000.0 / cells)
        # the volume in double, the unit a double: 1e-12 is their rounding with room
        self.assertLess(abs(scene.mapper.GetUsedUnitDistance() / unit - 1.0), 1e-12)
        self.assert_even(scene, alpha(10.0, 0.9 / unit))


class Geometry(InEachEngine):
    """Opaque geometry ends rays at every pixel."""

    def check(self, scene, place):
        """A square at z = place, seen along -z in parallel: colour of the geometry behind the mesh."""
        rgba = scene.rgba()
        enter, leave = interval(scene.renderer, 64, 64)
        origin, way = rays(scene.renderer, 64, 64)
        stop = (place - origin[..., 2]) / way[..., 2]
        hit = origin + stop[..., None] * way
        inside = (np.abs(hit[..., 0]) < 0.6) & (np.abs(hit[..., 1]) < 0.6)
        border = (np.abs(np.abs(hit[..., :2]) - 0.6) < 0.05).any(axis=-1) # whose pixel it is is OpenGL's
        path = np.where(inside, np.clip(stop, enter, leave) - enter, leave - enter)
        # depth of 32 bits over a clipping range of about 8, three roundings: 1e-6 of a length
        error = np.abs(rgba[..., 3] - alpha(path))[~border]
        self.assertLess(error.max(), FLOAT + TAU * 1e-5)
        return inside, rgba

    def test_before_behind_and_inside(self):
        for samples in (0, 8):
            for parallel in (True, False):
                for place in (0.8, 0.2, -0.3, -0.8):
                    with self.subTest(samples=samples, parallel=parallel, place=place):
                        scene = even_cube(3, direction=(-0.2, -0.1, -1.0), parallel=parallel)
                        scene.window.SetMultiSamples(samples)
                        scene.renderer.AddActor(square(0.6, place, color=(1.0, 0.0, 0.0)))
                        scene.renderer.ResetCameraClippingRange()
                        inside, rgba = self.check(scene, place)
                        pixels = scene.pixels()
                        red = np.where(inside, rgba[..., 0] + 1.0 - rgba[..., 3], rgba[..., 0])
                        around = np.pad(inside, 1) # what a pixel's samples can see lies in its neighbours
                        windows = np.lib.stride_tricks.sliding_window_view(around, (3, 3))
                        good = windows.all(axis=(2, 3)) | ~windows.any(axis=(2, 3))
                        self.assertLess(np.abs(pixels[..., 0] - red)[good].max(), BYTES)

    def test_moves_and_goes_away(self):
        scene = even_cube(2, direction=(0, 0, -1), parallel=True)
        prop = square(0.6, 0.2)
        scene.renderer.AddActor(prop)
        scene.renderer.ResetCameraClippingRange()
        first = scene.rgba()
        prop.SetPosition(0, 0, -0.3)
        moved = scene.rgba()
        self.assertLess(abs(first[32, 32, 3] - alpha(0.3)), FLOAT + TAU * 1e-5)
        self.assertLess(abs(moved[32, 32, 3] - alpha(0.6)), FLOAT + TAU * 1e-5)
        scene.renderer.RemoveActor(prop)
        self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(1.0)), FLOAT)

    def test_in_one_of_two_viewports_alone(self):
        scene = TetScene(size=(128, 64), viewports=((0, 0, 0.5, 1), (0.5, 0, 1, 1)))
        data = cube(2)
        mappers = []
        for renderer in scene.renderers:
            mapper = new_mapper(vtkChiProjectedTetrahedraMapper)
            scene.add_volume(data, even(TAU), mapper, renderer)
            scene.look(renderer=renderer)
            mappers.append(mapper)
        scene.renderers[1].AddActor(square(0.6, 0.0))
        scene.window.Render()
        for mapper, path in zip(mappers, (1.0, 0.5)):
            self.assertLess(abs(float_image(mapper)[32, 32, 3] - alpha(path)), FLOAT + TAU * 1e-5)

    def test_translucent_geometry_is_named_once(self):
        scene = even_cube(2)
        veil = sphere(0.3)
        veil.GetProperty().SetOpacity(0.4)
        scene.renderer.AddActor(veil)
        scene.window.Render()
        scene.window.Render()
        self.assertEqual(len(scene.messages.warnings), 1)
        self.assertIn("translucent", scene.messages.warnings[0])
        exact = alpha(paths(scene.renderer, 64, 64))
        self.assertLess(np.abs(float_image(scene.mapper)[..., 3] - exact).max(), FLOAT)


class Blending(InEachEngine):
    def test_maximum_intensity_is_that_of_the_largest_scalar_along_the_ray(self):
        # a ramp along x: seen along -z the largest scalar of a ray is that of its column
        ramp = cube(4, field=lambda x, y, z: x + 0.5)
        colors = ((0.0, (0.0, 0.0, 1.0)), (1.0, (1.0, 0.0, 0.0)))
        scene = TetScene(ramp, extinction(ramp=((0.0, 1.0), (1.0, 1.0)), colors=colors))
        scene.mapper.SetBlendModeToMaximumIntensity()
        scene.look(half=0.5)
        rgba = scene.rgba()
        column = (np.arange(64) + 0.5) / 64
        red = rgba[..., 0] / rgba[..., 3]
        # a place in a table of 4097 entries, linear: float
        self.assertLess(np.abs(red - column).max(), 1e-4)
        scene.look((-1, 0, 0), half=0.4) # along the ramp: its end
        rgba = scene.rgba()
        self.assertLess(np.abs(rgba[..., 0] / rgba[..., 3] - 1.0).max(), 1e-4)

    def test_several_meshes_are_blended_in_the_order_of_their_depth(self):
        # whichever is added first, the red one in front hides most of the blue one
        pictures = []
        for order in (0, 1):
            scene = TetScene(size=(64, 64))
            parts = [
                (cube(2, 0.5, (0, 0, 0.5)), ((0.0, (1.0, 0.0, 0.0)), (1.0, (1.0, 0.0, 0.0)))),
                (cube(2, 0.5, (0, 0, -0.5)), ((0.0, (0.0, 0.0, 1.0)), (1.0, (0.0, 0.0, 1.0)))),
            ]
            for data, colors in parts[:: 1 - 2 * order]:
                mapper = new_mapper(vtkChiProjectedTetrahedraMapper)
                scene.add_volume(data, extinction(1.0, 0.25, colors, ((0.0, 1.0), (1.0, 1.0))), mapper)
            scene.look(half=0.5)
            pictures.append(scene.pixels())
        front = alpha(0.5, 4.0)
        for picture in pictures:
            self.assertLess(abs(picture[32, 32, 0] - front), BYTES + 1.0 / 255.0)
            self.assertLess(abs(picture[32, 32, 2] - (1.0 - front) * front), BYTES + 1.0 / 255.0)


class State(InEachEngine):
    def test_nothing_changed_is_drawn_again(self):
        scene = even_cube()
        first = scene.rgba()
        self.assertFalse(scene.mapper.GetReusedLastFrame())
        again = scene.rgba()
        self.assertTrue(scene.mapper.GetReusedLastFrame())
        np.testing.assert_array_equal(first, again)
        scene.renderer.GetActiveCamera().Azimuth(10.0)
        scene.window.Render()
        self.assertFalse(scene.mapper.GetReusedLastFrame())

    def test_no_skipping_changes_a_pixel_by_more_than_a_step(self):
        field = lambda x, y, z: np.maximum(x + y, 0.0)
        prop = extinction(ramp=((0.0, 0.0), (0.3, 0.0), (1.0, 1.0)), unit=0.02)
        scene = TetScene(cube(8, field=field), prop, size=(256, 256)) # 16 tiles
        scene.look(OBLIQUE, half=0.7, parallel=False)
        scene.renderer.AddActor(square(5.0, 0.1)) # all pixels
        plane = vtkPlane()
        plane.SetOrigin(0.0, 0.2, 0.0)
        plane.SetNormal(0.0, -1.0, 0.0)
        scene.mapper.AddClippingPlane(plane)
        scene.renderer.ResetCameraClippingRange()
        all_kinds = scene.rgba()
        mapper = vtkChiProjectedTetrahedraMapper
        kinds = [mapper.SKIP_TRANSPARENT, mapper.SKIP_CLIPPED, mapper.SKIP_HIDDEN]
        counted = {kind: scene.mapper.GetNumberOfSkipped(kind) for kind in kinds}
        scene.mapper.SkippingOff()
        none = scene.rgba()
        for kind, count in counted.items():
            self.assertGreater(count, 0, kind)
            self.assertEqual(scene.mapper.GetNumberOfSkipped(kind), 0)
        self.assertLess(np.abs(all_kinds - none).max(), 1.0 / 255.0)
        for kind in (mapper.SKIP_OUTSIDE, mapper.SKIP_UNCOVERED):
            self.assertEqual(scene.mapper.GetNumberOfSkipped(kind), 0)
        for kind in kinds:
            scene.mapper.SkippingOn()
            scene.mapper.SetSkippingMask(kind)
            self.assertLess(np.abs(scene.rgba() - none).max(), 1.0 / 255.0)
            # alone, no other kind has taken its work
            self.assertGreaterEqual(scene.mapper.GetNumberOfSkipped(kind), counted[kind])

    def test_tells_what_it_did(self):
        scene = even_cube(3)
        scene.window.Render()
        mapper = scene.mapper
        self.assertEqual(mapper.GetNumberOfTetrahedra(), 6 * 27)
        self.assertGreaterEqual(mapper.GetNumberOfDrawnTetrahedra(), 6 * 27)
        self.assertGreater(mapper.GetNumberOfFragments(), 64 * 64 // 4)
        self.assertGreater(mapper.GetMeshBytes(), 0)
        self.assertEqual(mapper.GetImageBytes(), 16 * 64 * 64)
        self.assertNotEqual(mapper.GetUsedVisibilityOrder(), mapper.ORDER_AUTO)
        self.assertNotEqual(mapper.GetUsedPreIntegration(), mapper.PREINTEGRATION_AUTO)
        parts = sum(
            getattr(mapper, "GetSeconds" + part)() for part in ("Collect", "Engine", "Composite", "ReadBack")
        )
        self.assertGreater(parts, 0.0)
        self.assertLessEqual(parts, mapper.GetSecondsTotal() * 1.001)
        self.assertIn("OpacityConvention: Linear", str(mapper))

    def test_the_order_of_a_convex_mesh_has_no_violation(self):
        scene = even_cube(4)
        self.assertEqual(scene.mapper.GetNumberOfOrderViolations(), -1) # nothing drawn yet
        before = scene.rgba()
        self.assertEqual(scene.mapper.GetNumberOfOrderViolations(), 0)
        self.assertEqual(scene.mapper.GetNumberOfCycles(), 0)
        np.testing.assert_array_equal(float_image(scene.mapper), before) # counting takes nothing away


class CubeInOpenGL(InOpenGL, Cube):
    pass


class GeometryInOpenGL(InOpenGL, Geometry):
    pass


class BlendingInOpenGL(InOpenGL, Blending):
    pass


class StateInOpenGL(InOpenGL, State):
    pass


if __name__ == "__main__":
    unittest.main()
