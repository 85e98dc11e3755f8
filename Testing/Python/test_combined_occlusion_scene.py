# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: volumes, geometry, and the renderer around them."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Scene,
    ball,
    cube,
    erode,
    float_image,
    image,
    marschner_lobb,
    sphere,
    square,
    visibility_image,
    volume_property,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane
from vtkmodules.vtkImagingCore import vtkExtractVOI
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


class AgainstThePeer(unittest.TestCase):
    def test_strength_zero_equals_the_unshaded_ray_caster(self):
        n = 64
        data = marschner_lobb(n)
        step = 0.1 * 2.0 / (n - 1)
        peer = vtkOpenGLGPUVolumeRayCastMapper()
        peer.AutoAdjustSampleDistancesOff()
        peer.UseJitteringOff()
        ours = vtkChiCombinedOcclusionVolumeMapper()
        ours.SetOcclusionStrength(0.0)
        for parallel in (False, True):
            with self.subTest(parallel=parallel):
                pictures = []
                for mapper in (ours, peer):
                    mapper.SetSampleDistance(step)
                    scene = Scene((200, 200))
                    scene.add_volume(data, volume_property(unit=0.1), mapper)
                    scene.look((-0.5, -0.35, -0.8), half=1.6, parallel=parallel)
                    pictures.append(scene.pixels())
                inside = erode(pictures[1].max(axis=2) > 0, 2)
                self.assertGreater(inside.sum(), 8000)
                difference = 255.0 * np.abs(pictures[0] - pictures[1]).max(axis=2)[inside]
                # the bounds
                self.assertLessEqual(difference.mean(), 1.0)
                self.assertLessEqual(np.percentile(difference, 99.0), 2.0)


class Cut(unittest.TestCase):
    def pictures(self, data, cut, strength, mapper_class, turned=False):
        mapper = mapper_class()
        mapper.SetSampleDistance(0.1 * data.GetSpacing()[0])
        if strength is not None:
            mapper.SetOcclusionStrength(strength)
        else:
            mapper.AutoAdjustSampleDistancesOff()
            mapper.UseJitteringOff()
        scene = Scene((200, 200))
        volume, _ = scene.add_volume(data, volume_property(unit=0.1), mapper)
        if turned:  # no scale: the ray caster corrects opacity for unscaled steps
            volume.RotateZ(20.0)
            volume.SetPosition(0.1, -0.05, 0.1)
        cut(mapper)
        scene.look((-0.5, -0.35, -0.8), half=1.6, parallel=False)
        scene.renderer.ResetCameraClippingRange(-2.0, 2.0, -2.0, 2.0, -2.0, 2.0)
        return scene.pixels()

    def two_planes(self, mapper):
        for normal, origin in (((0.6, 0.3, -1.0), (0.1, 0.0, 0.3)), ((-1.0, 0.0, 0.2), (0.5, 0.0, 0.0))):
            plane = vtkPlane()
            plane.SetNormal(normal)
            plane.SetOrigin(origin)
            mapper.AddClippingPlane(plane)

    def inner_box(self, mapper):
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(-0.7, 0.4, -0.5, 0.9, -0.95, 0.3)
        mapper.SetCroppingRegionFlagsToSubVolume()

    def test_the_inner_box_leaves_the_picture_of_the_cut_data(self):
        data = marschner_lobb(64)
        voxels = (10, 45, 8, 50, 12, 40)
        voi = vtkExtractVOI()
        voi.SetInputData(data)
        voi.SetVOI(voxels)
        voi.Update()
        bounds = voi.GetOutput().GetBounds()
        for strength in (0.0, 1.0):
            whole, cut = (
                self.pictures(d, c, strength, vtkChiCombinedOcclusionVolumeMapper)
                for d, c in (
                    (voi.GetOutput(), lambda mapper: None),
                    (data, lambda mapper: (mapper.CroppingOn(), mapper.SetCroppingRegionPlanes(bounds))),
                )
            )
            self.assertGreater((whole > 0.1).sum(), 4000)
            # slices begin at the cut in both; positions in float may turn a rounding to 8 bits
            self.assertLessEqual(np.rint(255.0 * np.abs(whole - cut)).max(), 1)

    def test_planes_and_box_cut_where_the_ray_caster_cuts_within_its_half_voxel(self):
        # The ray caster puts cuts up to half a voxel off (its own crop of these data against the cut
        # data: mean 4.7/255 of 64^3), so the difference must halve with the voxel.
        for name in ("two_planes", "inner_box"):
            for turned in (False, True):
                with self.subTest(cut=name, turned=turned):
                    means = []
                    for n in (50, 100):
                        data, cut = marschner_lobb(n), getattr(self, name)
                        ours = self.pictures(data, cut, 0.0, vtkChiCombinedOcclusionVolumeMapper, turned)
                        peer = self.pictures(data, cut, None, vtkOpenGLGPUVolumeRayCastMapper, turned)
                        inside = erode(peer.max(axis=2) > 0, 2)
                        self.assertGreater(inside.sum(), 4000)
                        means.append(255.0 * np.abs(ours - peer).max(axis=2)[inside].mean())
                    self.assertLessEqual(means[1], 0.6 * means[0])

    def test_what_is_cut_away_darkens_nothing(self):
        def cut_half(mapper):
            plane = vtkPlane()
            plane.SetNormal(-1.0, 0.0, 0.0)
            plane.SetOrigin(0.0, 0.0, 0.0)
            mapper.AddClippingPlane(plane)

        # voxels 0 ... 10 of 21: the plane through voxel 10 leaves what the smaller image has
        values = ball(21, 0.45)
        pictures = []
        for data, cut in ((values, cut_half), (values[:, :, :11], lambda mapper: None)):
            scene = Scene((120, 120))
            _, mapper = scene.add_volume(
                image(data, (0.05,) * 3, [-0.5, -0.5, -0.5]), volume_property(1.0, 0.8, 0.05)
            )
            cut(mapper)
            scene.renderer.AddActor(square(0.7, -0.6))
            scene.look(half=0.8)
            scene.window.Render()
            pictures.append((float_image(mapper), visibility_image(mapper)))
        self.assertLess(pictures[0][1].min(), 0.9)
        for a, b in zip(*pictures):
            self.assertLessEqual(255.0 * np.abs(a - b).max(), 0.1)  # positions in float


class GeometryAndVolume(unittest.TestCase):
    def fog_scene(self, direction, up, parallel, strength):
        """A black sphere whose lower half sticks in white fog that fills z < 0 of a cube."""
        n = 33
        values = np.ones((17, n, n), np.float32)
        h = 2.0 / (n - 1)
        data = image(values, (h, h, h), (-1.0, -1.0, -1.0))
        scene = Scene((101, 101))
        _, mapper = scene.add_volume(data, volume_property(1.0, 0.6, 1.0, WHITE))
        mapper.SetOcclusionStrength(strength)
        scene.renderer.AddActor(sphere(0.5, color=(0.0, 0.0, 0.0)))
        scene.look(direction, up, half=1.3, parallel=parallel)
        scene.window.Render()
        return float_image(mapper), h

    def test_a_sphere_half_inside_fog_is_cut_at_the_right_depth(self):
        # white fog, black sphere, no shading: brightness is the alpha of the fog in front
        sigma = -np.log(1.0 - 0.6)
        for parallel in (True, False):
            with self.subTest(parallel=parallel):
                above, h = self.fog_scene((0, 0, -1), (0, 1, 0), parallel, 0.0)
                centre = above[50, 50]
                self.assertEqual(centre[3], 1.0)
                # from above the sphere's top stands out of the fog
                self.assertLessEqual(centre[0], 0.5 / 255.0)
                below, h = self.fog_scene((0, 0, 1), (0, 1, 0), parallel, 0.0)
                # half a unit of fog from its floor to the sphere; the first and last slab may each
                # be off by half a slice
                expected = 1.0 - np.exp(-0.5 * sigma)
                self.assertLessEqual(abs(below[50, 50, 0] - expected), sigma * h)
                side, h = self.fog_scene((1, 0, 0), (0, 0, 1), parallel, 0.0)
                # one row above the fog's surface nothing is in front, a few below there is
                self.assertLessEqual(side[60, 50, 0], 0.5 / 255.0)
                self.assertGreater(side[42, 50, 0], 0.2)

    def test_a_sphere_half_inside_fog_looks_alike_from_all_sides(self):
        for parallel in (True, False):
            for strength, bound in ((0.0, 1.0), (1.0, 6.0)):
                with self.subTest(parallel=parallel, strength=strength):
                    views = [
                        self.fog_scene(d, (0, 0, 1), parallel, strength)[0]
                        for d in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
                    ]
                    for view in views[1:] + [views[0][:, ::-1]]:
                        difference = 255.0 * np.abs(view - views[0]).max(axis=2)
                        # unshaded: what rasterising the sphere leaves at its silhouette. Shaded: the
                        # mirrored picture sees other directions of the cone, 0.02 of full visibility
                        self.assertLessEqual(difference.mean(), bound)

    def test_an_open_surface_that_faces_the_eye_keeps_its_colour(self):
        for size in (96, 31):
            for parallel in (True, False):
                with self.subTest(size=size, parallel=parallel):
                    scene = Scene((size, size))
                    clear = cube(np.zeros((16, 16, 16)))
                    _, mapper = scene.add_volume(clear)
                    scene.renderer.AddActor(square(0.6, 0.1))
                    scene.look(half=0.8, parallel=parallel)
                    scene.window.Render()
                    picture = float_image(mapper)
                    covered = picture[..., 3] > 0
                    self.assertGreater(covered.mean(), 0.4)
                    self.assertGreaterEqual(picture[covered][:, 0].min(), 0.97)

    def test_the_geometry_buffer_holds_colour_normal_and_depth(self):
        for parallel in (True, False):
            with self.subTest(parallel=parallel):
                scene = Scene((101, 101))
                _, mapper = scene.add_volume(cube(np.zeros((16, 16, 16))))
                scene.renderer.AddActor(sphere(0.5, lit=True, color=(0.2, 0.9, 0.4)))
                scene.look(half=0.7, parallel=parallel)
                scene.window.Render()
                data = vtkImageData()
                self.assertTrue(mapper.GetGeometryImage(data))
                arrays = data.GetPointData()

                def plane(name):
                    array = vtk_to_numpy(arrays.GetArray(name))
                    return array.reshape(101, 101, -1).squeeze()

                color, normal, depth = plane("RGBA"), plane("Normal"), plane("Depth")
                camera = scene.renderer.GetActiveCamera()
                distance = np.linalg.norm(camera.GetPosition())
                ticks = (np.arange(101) + 0.5 - 50.5) / 101 * 2.0 * 0.7
                x, y = np.meshgrid(ticks, ticks)
                hit = color[..., 3] > 0
                self.assertTrue(np.isinf(depth[~hit]).all())
                self.assertEqual(np.abs(normal[~hit]).max(), 0.0)
                scale = 1.0 if parallel else depth[hit] / distance
                point = np.stack([x[hit] * scale, y[hit] * scale, distance - depth[hit]], axis=1)
                radius = np.linalg.norm(point, axis=1)
                # chords of 64 facets lie (1 - cos(pi / 64)) r below the sphere, at most
                self.assertLessEqual(np.abs(radius - 0.5).max(), 0.5 * 2.0 * (1 - np.cos(np.pi / 64)) + 1e-5)
                # normals are interpolated over a facet
                self.assertGreaterEqual((normal[hit] * point / radius[:, None]).sum(axis=1).min(), 0.999)
                # seen straight on by the light at the eye
                self.assertLessEqual(np.abs(color[50, 50, :3] - (0.2, 0.9, 0.4)).max(), 0.01)
                # nothing is left behind in the shaders
                before = scene.pixels()
                mapper.GetGeometryImage(data)
                scene.renderer.GetActiveCamera().Azimuth(0.0)
                self.assertEqual(np.abs(scene.pixels() - before).max(), 0.0)

    def shaded(self, **switches):
        """Two squares, one in front of the other, and between them a ball of smoke to one side."""
        scene = Scene((96, 96))
        _, mapper = scene.add_volume(
            cube(np.pad(ball(30), 1), 0.8, (-0.2, 0.0, 0.0)), volume_property(1.0, 0.9, 0.1)
        )
        mapper.SetOcclusionBias(0.03)
        for name, value in switches.items():
            getattr(mapper, "Set" + name)(value)
        scene.renderer.AddActor(square(0.9, -0.45, color=(0.9, 0.9, 0.9)))
        small = square(0.12, 0.45, color=(0.3, 0.8, 0.3))
        small.SetPosition(-0.1, 0.5, 0.0)
        scene.renderer.AddActor(small)
        pole = sphere(0.12, (0.45, -0.1, 0.0), color=(0.8, 0.3, 0.3))
        scene.renderer.AddActor(pole)
        scene.look((0.05, 0.1, -1.0), half=1.0)
        scene.window.Render()
        picture, visibility = float_image(mapper), visibility_image(mapper)
        for prop in list(scene.renderer.GetActors()):
            prop.GetProperty().SetColor(0.0, 0.0, 0.0)
        scene.window.Render()
        return picture, visibility, float_image(mapper)  # the last: light from the volume alone

    def test_each_switch_changes_what_it_should_and_only_that(self):
        every = self.shaded()
        none = self.shaded(VolumeToVolume=False, GeometryOcclusion=False)
        unshaded = self.shaded(OcclusionStrength=0.0)
        self.assertEqual(np.abs(none[0] - unshaded[0]).max(), 0.0)
        self.assertEqual(none[1].min(), 1.0)

        def changes(other, index):
            return 255.0 * np.abs(other[index] - every[index]).max()

        # a switch that does not concern it changes nothing but the order of roundings
        nothing, something = 1.0, 8.0
        for name, volume, surface in (
            ("VolumeToVolume", True, False),
            ("GeometryToVolume", True, False),
            ("VolumeToGeometry", False, True),
            ("GeometryToGeometry", False, True),
        ):
            with self.subTest(switch=name):
                off = self.shaded(**{name: False})
                (self.assertGreater if volume else self.assertLess)(
                    changes(off, 2), something if volume else nothing
                )
                (self.assertGreater if surface else self.assertLess)(
                    changes(off, 1), something if surface else nothing
                )
                # without an occluder it can only get brighter
                self.assertGreaterEqual((off[1] - every[1]).min(), -1.0 / 255.0)
                self.assertGreaterEqual((off[2] - every[2]).min(), -1.0 / 255.0)
        geometry_off = self.shaded(GeometryOcclusion=False)
        self.assertEqual(geometry_off[1].min(), 1.0)
        self.assertGreater(changes(geometry_off, 2), 8.0)

    def test_skipping_changes_no_pixel(self):
        for parallel in (True, False):
            with self.subTest(parallel=parallel):
                pictures = []
                for skip in (True, False):
                    scene = Scene((160, 160))
                    _, mapper = scene.add_volume(
                        cube(ball(64), 1.2), volume_property(1.0, 0.95, 0.05)
                    )
                    mapper.SetSkipping(skip)
                    scene.renderer.AddActor(sphere(0.2, (0.35, 0.2, 0.25)))
                    scene.renderer.AddActor(square(0.7, -0.3))
                    scene.look((0.3, 0.2, -1.0), half=0.9, parallel=parallel)
                    scene.window.Render()
                    pictures.append(float_image(mapper))
                    self.assertGreater(mapper.GetNumberOfSamples(), 0)
                    if skip:
                        self.assertGreater(mapper.GetNumberOfSkippedSamples(), 0)
                        self.assertGreater(mapper.GetNumberOfSkippedLightUpdates(), 0)
                # the bound
                self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[1]).max(), 1.0)

    def shiny_scene(self, fxaa=False, volumes=1, specular=0.6):
        """A shiny square under dense smoke at one side, which leaves it little light."""
        scene = Scene((96, 96))
        for k in range(volumes):
            center = (-0.3, 0.0, 0.5) if k == 0 else (0.45, 0.45, 0.2)
            _, mapper = scene.add_volume(
                cube(np.pad(ball(30), 1), 0.8 if k == 0 else 0.5, center), volume_property(1.0, 0.9, 0.15)
            )
            if k == 0:
                first = mapper
        scene.renderer.SetUseFXAA(fxaa)
        plate = square(0.8, -0.3, color=(0.3, 0.5, 0.7), lit=True)
        plate.GetProperty().SetSpecular(specular)
        plate.GetProperty().SetSpecularColor(0.5, 0.4, 0.3)
        plate.GetProperty().SetSpecularPower(2.0)
        scene.renderer.AddActor(plate)
        scene.look(half=0.9, parallel=False)
        return scene, first

    def test_occlusion_takes_no_highlights(self):
        """Schott et al. 2013, Eqs 9 and 10, term by term."""
        scene, mapper = self.shiny_scene()
        scene.window.Render()
        shiny, visibility = float_image(mapper), visibility_image(mapper)
        data = vtkImageData()
        self.assertTrue(mapper.GetGeometryImage(data))
        lit = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(96, 96, 4)
        scene, mapper = self.shiny_scene(specular=0.0)
        scene.window.Render()
        dull = float_image(mapper)
        self.assertTrue(mapper.GetGeometryImage(data))
        diffuse = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(96, 96, 4)
        highlight = (lit - diffuse)[..., :3]
        self.assertGreater(highlight.max(), 0.25)
        self.assertLess(visibility.min(), 0.75)
        # the float image is that of the dull plate, and the highlight through the volume
        through = (shiny - dull)[..., :3]
        covered = (diffuse[..., 3] > 0) & (highlight.max(axis=2) > 0.05)
        share = through[covered] / highlight[covered]
        # the same share of every channel, that which the volume's alpha leaves: between 0 and 1, and not
        # less where the plate lies in shadow beside the smoke
        self.assertLessEqual(np.abs(share - share[:, :1]).max(), 1e-3)
        self.assertGreaterEqual(share.min(), -1e-4)
        self.assertLessEqual(share.max(), 1.0 + 1e-4)
        # beside the smoke, but in its shadow, all of the highlight arrives
        self.assertGreater((share[visibility[covered] < 0.9][:, 0] > 0.999).sum(), 20)

    def test_highlights_are_alike_however_the_pixels_are_drawn(self):
        pictures = [self.shiny_scene(fxaa)[0].pixels() for fxaa in (False, True)]
        inside = np.zeros((96, 96), bool)
        inside[14:82, 14:82] = True  # away from the silhouette of the square
        # 8 bits: the colour below, before it is darkened, and what is blended over it
        self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[1])[inside].max(), 3.01)

    def test_a_second_volume_takes_no_highlights_either(self):
        scene, _ = self.shiny_scene(volumes=2)
        both = scene.pixels()
        alone = self.shiny_scene(volumes=1)[0].pixels()
        far = np.zeros((96, 96), bool)
        far[10:40, 10:40] = True  # out of reach of the second volume and its shadow
        self.assertLessEqual(255.0 * np.abs(both - alone)[far].max(), 2.01)
        self.assertGreater(255.0 * np.abs(both - alone).max(), 20.0)

    def test_the_window_shows_the_float_image(self):
        scene = Scene((96, 96), background=(0.2, 0.4, 0.6))
        _, mapper = scene.add_volume(cube(ball(24), 1.2), volume_property(unit=0.1))
        scene.renderer.AddActor(sphere(0.3, (0.3, 0.2, 0.2), lit=True, color=(0.9, 0.6, 0.2)))
        scene.look((0.3, 0.2, -1.0), half=0.9)
        pixels = scene.pixels()
        picture = float_image(mapper)
        expected = picture[..., :3] + (1.0 - picture[..., 3:]) * np.array([0.2, 0.4, 0.6])
        # 8 bits: the background, the picture before it is blended (colour and alpha), the result
        self.assertLessEqual(255.0 * np.abs(pixels - expected).max(), 2.01)

    def test_darkening_and_rewriting_agree(self):
        pictures = []
        for fxaa in (False, True):  # FXAA is one of the cases in which pixels are darkened
            scene = Scene((96, 96))
            scene.add_volume(cube(ball(24), 1.2), volume_property(unit=0.1))
            scene.renderer.SetUseFXAA(fxaa)
            scene.renderer.AddActor(square(0.7, -0.3, color=(0.9, 0.6, 0.2)))
            scene.look(half=0.9)
            pictures.append(scene.pixels())
        inside = np.zeros((96, 96), bool)
        inside[14:82, 14:82] = True  # away from the silhouette of the square
        # 8 bits: the colour below, before it is darkened, and what is blended over it
        self.assertLessEqual(255.0 * np.abs(pictures[0] - pictures[1])[inside].max(), 2.01)


if __name__ == "__main__":
    unittest.main()
