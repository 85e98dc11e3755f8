# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: the OpenGL engine makes the CPU engine's picture, and loses no cell."""
import unittest

import numpy as np
from each_engine import InEachEngine
from occlusion_scene import Messages, float_image, marschner_lobb, sphere, square
from tetrahedra_scene import TetScene, cube, even, extinction, hexahedra_of, lattice, mesh, paths_in
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.util.vtkConstants import VTK_HEXAHEDRON
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane
from vtkmodules.vtkRenderingCore import vtkLight

from chiaroscuro.vtkChiRendering import vtkChiProjectedTetrahedraMapper

AUTO = vtkChiProjectedTetrahedraMapper.ENGINE_AUTO
CPU = vtkChiProjectedTetrahedraMapper.ENGINE_CPU
OPENGL = vtkChiProjectedTetrahedraMapper.ENGINE_OPENGL
OBLIQUE = (-0.5, -0.35, -0.8)
SIZE = 96
COLORS = ((0.0, (0.0, 0.0, 1.0)), (0.4, (1.0, 0.2, 0.0)), (1.0, (0.2, 1.0, 0.3)))
RAMP = ((0.0, 0.0), (0.4, 0.3), (0.55, 1.0), (0.7, 0.1), (1.0, 0.6))


def waves(x, y, z):
    return 0.5 + 0.25 * np.sin(5.0 * x + 3.0 * y * z) + 0.25 * np.cos(7.0 * y - 4.0 * z)


def ramps(unit=0.3, **options):
    return extinction(unit=unit, **{"colors": COLORS, "ramp": RAMP, **options})


def shaken(n, seed=7):
    """A cube whose inner points are anywhere near their places, so that no two cells are alike."""
    data = cube(n, field=waves)
    points = lattice(n)
    inner = (np.abs(points) < 0.499).all(axis=1)
    points[inner] += np.random.default_rng(seed).uniform(-0.2, 0.2, (inner.sum(), 3)) / n
    places = vtkPoints()
    places.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(places)
    return data


def draw(engine, data, prop, setup=None, size=SIZE, **look):
    """The float picture of one engine, and its scene."""
    InEachEngine.now = engine
    scene = TetScene(data, prop, (size, size))
    scene.look(**{"direction": OBLIQUE, "half": 0.8, **look})
    if setup:
        setup(scene)
    return scene.rgba(), scene


class SamePicture(unittest.TestCase):
    # of 255. The issue asks for a mean of 1; the engines do the same sums in floats, but for psi: by the
    # table of 128^2, off by 2e-3 at most and 4e-5 in the mean of its square, and by quadrature
    MEAN = 0.05
    MOST = 1.0
    LEAST = 1000 # pixels to compare

    def check(self, data=None, prop=None, setup=None, without=None, **options):
        """Compare the engines; `without` leaves out of the OpenGL engine's picture what is tested, which must show."""
        data = data or shaken(6)
        prop = prop or ramps()
        pictures = []
        for engine in (CPU, OPENGL):
            picture, scene = draw(engine, data, prop, setup, **options)
            self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
            pictures.append((picture, scene.mapper.GetNumberOfFragments()))
        (cpu, _), (gpu, fragments) = pictures
        self.assertTrue(np.isfinite(gpu).all())
        self.assertGreater((cpu[..., 3] > 0.05).sum(), self.LEAST)
        self.assertGreater(fragments, self.LEAST)
        difference = 255.0 * np.abs(cpu - gpu).max(axis=2)
        print(f"{self.id().split('.')[-1]}: mean {difference.mean():.5f}, most {difference.max():.4f} of 255")
        self.assertLessEqual(difference.mean(), self.MEAN)
        self.assertLessEqual(difference.max(), self.MOST)
        if without:
            plain, _ = draw(OPENGL, data, prop, without, **options)
            self.assertGreater(255.0 * np.abs(plain - gpu).max(axis=2).mean(), 5.0)
        return gpu

    def test_every_pre_integration_under_both_conventions_and_projections(self):
        for method in ("None", "Partial", "Full"):
            for convention in ("Linear", "Image"):
                for parallel in (False, True):
                    with self.subTest(method=method, convention=convention, parallel=parallel):

                        def setup(scene):
                            getattr(scene.mapper, "SetPreIntegrationTo" + method)()
                            getattr(scene.mapper, "SetOpacityConventionTo" + convention)()

                        self.check(setup=setup, parallel=parallel)

    def test_thin_peaks_inside_of_cells(self):
        peak = [(0.0, 0.0)]
        for place in (0.3, 0.62):
            peak += [(place - 0.01, 0.0), (place, 1.0), (place + 0.01, 0.0)]
        peak.append((1.0, 0.0))
        self.check(
            prop=ramps(unit=0.01, ramp=peak), without=lambda scene: scene.mapper.SetPreIntegrationToNone()
        )

    def test_values_of_cells(self):
        n = 6
        points = lattice(n)
        corners = hexahedra_of(n)
        values = waves(*points[corners].mean(axis=1).T).astype(np.float32)
        self.check(mesh(points, corners, VTK_HEXAHEDRON, cell_scalars=values))

    def test_opacity_of_its_own_of_points_and_of_cells(self):
        n = 6
        points = lattice(n)
        corners = hexahedra_of(n)
        for of_cells in (False, True):
            with self.subTest(of_cells=of_cells):
                places = points[corners].mean(axis=1) if of_cells else points
                values = {"cell_scalars" if of_cells else "scalars": waves(*places.T).astype(np.float32)}
                data = mesh(points, corners, VTK_HEXAHEDRON, **values)
                other = numpy_to_vtk((0.5 + places[:, 0]).astype(np.float32), deep=True)
                other.SetName("other")
                (data.GetCellData() if of_cells else data.GetPointData()).AddArray(other)
                self.check(
                    data, setup=lambda scene: scene.mapper.SetOpacityArrayName("other"), without=lambda _: None
                )

    def test_maximum_intensity(self):
        for convention in ("Linear", "Image"):

            def setup(scene):
                scene.mapper.SetBlendModeToMaximumIntensity()
                getattr(scene.mapper, "SetOpacityConventionTo" + convention)()

            self.check(setup=setup, without=lambda _: None)

    def test_lights_on_the_gradient(self):
        prop = ramps()
        prop.ShadeOn()
        prop.SetAmbient(0.2)
        prop.SetDiffuse(0.7)
        prop.SetSpecular(0.6)
        prop.SetSpecularPower(10.0)

        def setup(scene):
            light = vtkLight()
            light.SetPosition(1.0, 2.0, 3.0)
            light.SetColor(1.0, 0.8, 0.6)
            scene.renderer.AddLight(light)
            prop.ShadeOn()

        self.check(prop=prop, setup=setup, without=lambda scene: prop.ShadeOff())

    def test_clip_planes(self):
        def setup(scene):
            for normal, origin in (((0.6, 0.3, -1.0), (0.1, 0.0, 0.1)), ((-1.0, 0.0, 0.2), (0.25, 0.0, 0.0))):
                plane = vtkPlane()
                plane.SetNormal(normal)
                plane.SetOrigin(origin)
                scene.mapper.AddClippingPlane(plane)

        for parallel in (False, True):
            self.check(setup=setup, without=lambda _: None, parallel=parallel)

    def test_geometry_before_behind_and_inside(self):
        def setup(scene):
            scene.renderer.AddActor(sphere(0.3, (0.1, 0.0, 0.1)))
            scene.renderer.AddActor(sphere(0.2, (-0.4, -0.2, 1.3)))
            plane = square(0.6, -0.4)
            plane.RotateX(25.0)
            scene.renderer.AddActor(plane)

        for parallel in (False, True):
            self.check(setup=setup, without=lambda _: None, parallel=parallel)

    def test_the_eye_inside_of_the_mesh(self):
        def setup(scene):
            camera = scene.renderer.GetActiveCamera()
            camera.SetParallelProjection(False)
            camera.SetPosition(0.1, 0.2, 0.3)
            camera.SetFocalPoint(-0.3, 0.1, -2.0)
            camera.SetViewAngle(60.0)
            camera.SetClippingRange(0.01, 10.0)

        self.check(setup=setup)

    def test_a_matrix_that_scales_and_mirrors(self):
        def setup(scene):
            scene.volume.SetScale(10.0, -7.0, 4.0)
            scene.volume.RotateY(20.0)

        self.check(prop=ramps(unit=2.0), setup=setup, half=6.0)

    def test_far_from_the_origin_and_of_any_size(self):
        for shift, edge in ((1e5, 1.0), (0.0, 1e-9), (0.0, 1e12)):
            with self.subTest(shift=shift, edge=edge):
                data = shaken(4)
                places = vtkPoints()
                places.SetDataTypeToDouble()
                places.SetData(
                    numpy_to_vtk(edge * (lattice(4) + shift), deep=True)
                )
                data.SetPoints(places)

                def setup(scene):
                    camera = scene.renderer.GetActiveCamera()
                    at = np.full(3, shift * edge)
                    camera.SetFocalPoint(*at)
                    camera.SetPosition(*(at + 3.0 * edge * np.array([0.5, 0.35, 0.8])))
                    camera.SetParallelScale(0.8 * edge)
                    camera.SetClippingRange(edge, 6.0 * edge)

                self.check(data, ramps(unit=0.3 * edge), setup=setup)

    def test_images_are_meshes(self):
        self.check(marschner_lobb(9), ramps(unit=0.5), half=1.2)

    def test_pictures_of_fewer_pixels(self):
        for times in (2, 3, 5):
            with self.subTest(times=times):

                def setup(scene):
                    scene.mapper.SetImageReduction(times)
                    scene.renderer.AddActor(sphere(0.3, (0.1, 0.0, 0.1)))

                self.check(setup=setup, size=97)

    def test_without_skipping(self):
        self.check(setup=lambda scene: scene.mapper.SkippingOff())

    def test_every_order(self):
        for order in ("Centroid", "Tangential", "MPVO", "XMPVO"):
            with self.subTest(order=order):
                self.check(setup=lambda scene: getattr(scene.mapper, "SetVisibilityOrderTo" + order)())


class OneCell(unittest.TestCase):
    """Planes are floats: how far that carries. The table stands in theory/tet_opengl.md."""

    def corners(self, size, aspect, seed):
        """A tetrahedron with a longest edge of `size`, thin in one direction, or in two, somewhere in the mesh."""
        rng = np.random.default_rng(seed)
        longest = lambda c: max(np.linalg.norm(a - b) for a in c for b in c)
        while True: # one that is thick before it is made thin
            corners = rng.uniform(-1.0, 1.0, (4, 3))
            if abs(np.linalg.det(corners[1:] - corners[0])) > 0.06 * longest(corners) ** 3:
                break
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        corners = corners * (1.0, 1.0 / aspect if seed % 2 else 1.0, 1.0 / aspect) @ turn.T
        corners *= size / longest(corners)
        return corners - corners.mean(axis=0) + rng.uniform(-0.3, 0.3, 3), rng

    def errors(self, size, aspect, seed, pixels=64):
        """Errors of the thickness, and where it is exactly so and so much, in longest edges."""
        corners, rng = self.corners(size, aspect, seed)
        # two cells that are too small to be seen give the mesh an extent of 1
        tiny = 1e-9 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        points = np.concatenate([corners, 0.5 - tiny, tiny - 0.5])
        tau = 3.0 / size
        data = mesh(points, np.arange(12).reshape(3, 4), scalars=np.ones(12, np.float32))

        def setup(scene):
            camera = scene.renderer.GetActiveCamera()
            away = rng.normal(size=3)
            away /= np.linalg.norm(away)
            center = corners.mean(axis=0)
            camera.SetFocalPoint(*center)
            camera.SetPosition(*(center + 2.5 * away))
            camera.SetViewUp(*np.cross(away, rng.normal(size=3)))
            camera.SetParallelScale(0.6 * size)
            camera.SetViewAngle(np.degrees(2.0 * np.arctan(0.6 * size / 2.5)))
            camera.SetClippingRange(0.5, 5.0)

        rgba, scene = draw(OPENGL, data, even(tau), setup, size=pixels, parallel=seed % 3 == 0)
        exact = paths_in(scene.renderer, pixels, pixels, corners) / size
        alpha = np.minimum(rgba[..., 3].astype(float), 1.0 - 1e-9)
        return np.abs(-np.log1p(-alpha) / tau / size - exact), exact, alpha

    def test_no_cell_is_lost(self):
        for size in (1.0, 1e-2, 1e-4):
            for aspect in (1.0, 10.0, 100.0, 1000.0):
                with self.subTest(size=size, aspect=aspect):
                    errors, seen, lost = [], 0, 0
                    for seed in range(6):
                        error, exact, alpha = self.errors(size, aspect, seed)
                        errors.append(error[(exact > 0.0) | (alpha > 0.0)])
                        # what the issue asks for: nothing missing that is thicker than 1e-3 of the edge
                        seen += (exact > 1e-3).sum()
                        lost += ((exact > 1e-3) & (alpha == 0.0)).sum()
                    errors = np.concatenate(errors)
                    print(
                        f"size {size:g}, aspect {aspect:g}: 99.9 % {np.percentile(errors, 99.9):.1e}, "
                        f"most {errors.max():.1e}, {seen} pixels, {lost} lost"
                    )
                    self.assertGreater(seen, 30)
                    self.assertEqual(lost, 0)
                    # a float's 6e-8, times how much steeper than the rest a thin cell's faces may be seen: 1000
                    self.assertLess(errors.max(), 6e-8 * max(aspect, 30.0))


class Windows(unittest.TestCase):
    """Textures follow the window, and leave with it."""

    def build(self, engine, size=(60, 50)):
        InEachEngine.now = engine
        scene = TetScene(shaken(4), ramps(), size)
        scene.look(OBLIQUE, half=0.8)
        return scene

    def assert_alike(self, a, b):
        self.assertGreater((a > 0.1).sum(), 1000)
        difference = 255.0 * np.abs(a - b)
        self.assertLess(difference.max(), 1.5) # of 8 bits: where a half is rounded to either side, 1
        self.assertLessEqual(difference.mean(), 0.05)

    def in_each_engine(self, pictures):
        results = []
        for engine in (CPU, OPENGL):
            results.append(pictures(self.build(engine)))
        for a, b in zip(*results, strict=True):
            self.assert_alike(a, b)

    def test_a_window_of_another_size_and_a_lost_context(self):
        def pictures(scene):
            result = []
            for size in ((60, 50), (31, 77), (90, 40), (60, 50)):
                scene.window.SetSize(size)
                result.append(scene.pixels())
            np.testing.assert_array_equal(result[0], result[3])
            scene.window.Finalize()
            result.append(scene.pixels())
            np.testing.assert_array_equal(result[0], result[4])
            return result

        self.in_each_engine(pictures)

    def test_two_windows_share_a_mapper(self):
        def pictures(first):
            second = TetScene(size=(44, 64))
            second.renderer.AddVolume(first.volume)
            second.look((0.5, 0.1, -1.0), half=0.7)
            result = [scene.pixels() for scene in (first, second, first, first, second)]
            np.testing.assert_array_equal(result[0], result[2])
            return result

        self.in_each_engine(pictures)

    def test_part_of_a_window_of_several_samples(self):
        def pictures(scene):
            scene.window.SetMultiSamples(4)
            scene.renderer.SetViewport(0.2, 0.1, 0.9, 1.0)
            scene.renderer.SetBackground(0.1, 0.2, 0.3)
            return [scene.pixels()]

        self.in_each_engine(pictures)

    def test_what_is_edited_is_seen(self):
        def pictures(scene):
            mapper, prop = scene.mapper, scene.volume.GetProperty()
            ball = sphere(0.3, (0.1, 0.0, 0.2))
            plane = vtkPlane()
            plane.SetNormal(1.0, 0.4, 0.0)
            edits = (
                lambda: None,
                lambda: prop.GetScalarOpacity().AddPoint(0.2, 1.0),
                lambda: scene.renderer.AddActor(ball),
                lambda: ball.SetPosition(0.1, 0.2, 0.4),
                lambda: scene.renderer.RemoveActor(ball),
                lambda: mapper.AddClippingPlane(plane),
                lambda: mapper.RemoveAllClippingPlanes(),
                lambda: mapper.SetInputData(cube(3, field=lambda x, y, z: 0.5 + x)),
                lambda: prop.ShadeOn(),
                lambda: mapper.SetPreIntegrationToNone(),
                lambda: mapper.SetBlendModeToMaximumIntensity(),
                lambda: mapper.SetBlendModeToComposite(),
                lambda: scene.look((0.3, 0.9, -0.2), half=0.6),
                lambda: mapper.SetImageReduction(4),
            )
            result = []
            for k, edit in enumerate(edits):
                edit()
                result.append(scene.pixels())
                if k:
                    self.assertGreater(255.0 * np.abs(result[-1] - result[-2]).mean(), 0.2, k) # ten times what the engines differ by
            self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
            return result

        self.in_each_engine(pictures)

    def test_meshes_behind_each_other_are_merged(self):
        def pictures(scene):
            other = vtkChiProjectedTetrahedraMapper()
            other.SetEngine(scene.mapper.GetEngine())
            scene.add_volume(cube(2, 0.6, (0.2, 0.1, 0.9), lambda x, y, z: z), ramps(), other)
            return [scene.pixels()]

        self.in_each_engine(pictures)

    def test_nothing_is_drawn_anew_where_nothing_changed(self):
        scene = self.build(OPENGL)
        first = scene.rgba()
        self.assertFalse(scene.mapper.GetReusedLastFrame())
        fragments = scene.mapper.GetNumberOfFragments()
        self.assertGreater(fragments, 1000)
        np.testing.assert_array_equal(scene.rgba(), first)
        self.assertTrue(scene.mapper.GetReusedLastFrame())
        self.assertEqual(scene.mapper.GetNumberOfFragments(), fragments)
        scene.volume.GetProperty().GetScalarOpacity().AddPoint(0.2, 1.0)
        self.assertGreater(np.abs(scene.rgba() - first).max(), 0.01)
        self.assertFalse(scene.mapper.GetReusedLastFrame())


class WhichEngine(unittest.TestCase):
    def test_auto_takes_the_engine_that_the_renderer_string_asks_for(self):
        mapper = vtkChiProjectedTetrahedraMapper()
        self.assertEqual((mapper.GetEngine(), mapper.GetEngineInUse(), mapper.GetEngineReason()), (AUTO, AUTO, ""))
        InEachEngine.now = AUTO
        scene = TetScene(cube(2), even(1.0))
        scene.window.Render()
        capabilities = scene.window.ReportCapabilities()
        renderer = next(line for line in capabilities.splitlines() if "renderer string" in line)
        software = any(name in renderer.lower() for name in ("llvmpipe", "softpipe", "swr"))
        self.assertEqual(scene.mapper.GetEngineInUse(), CPU if software else OPENGL)
        self.assertIn(renderer.split(":", 1)[1].strip(), scene.mapper.GetEngineReason())

    def test_the_engine_that_is_asked_for_draws(self):
        for engine in (CPU, OPENGL):
            InEachEngine.now = engine
            scene = TetScene(cube(2), even(1.0))
            scene.rgba()
            self.assertEqual(scene.mapper.GetEngineInUse(), engine)
            self.assertIn("asked for", scene.mapper.GetEngineReason())


if __name__ == "__main__":
    unittest.main()
