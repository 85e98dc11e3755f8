# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: scenes that other implementations are known to draw wrongly."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL
from occlusion_scene import Messages, Scene
from tetrahedra_scene import (
    TetScene,
    cube,
    even,
    extinction,
    lattice,
    mesh,
    paths,
    paths_in,
    tetrahedra_of,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_LINE, VTK_QUAD, VTK_TRIANGLE, VTK_VERTEX
from vtkmodules.vtkRenderingVolume import vtkProjectedTetrahedraMapper

TAU = 2.0
FLOAT = 1e-4 # of a float picture: the bound for even meshes
OBLIQUE = (-0.4, -0.5, -1.0)

# Seen along -z its silhouette is a quadrilateral: the edges 0-1 and 2-3 cross in the middle (class 2).
CROSSED = np.array([[-0.8, 0.1, 0.3], [0.8, -0.1, 0.5], [0.1, -0.7, -0.4], [-0.2, 0.7, -0.2]])
# One vertex inside the triangle of the others (class 1).
POINTED = np.array([[-0.7, -0.6, 0.0], [0.8, -0.5, 0.1], [0.0, 0.8, -0.1], [0.05, -0.1, 0.6]])


def alpha(path, tau=TAU):
    return 1.0 - np.exp(-tau * path)


def one(corners, tau=TAU, **look):
    corners = np.asarray(corners, float)
    scene = TetScene(mesh(corners, [[0, 1, 2, 3]], scalars=np.ones(4, np.float32)), even(tau))
    scene.look(**look)
    return scene


class OneTetrahedron(InEachEngine):
    def assert_path(self, scene, corners, tau=TAU, bound=FLOAT):
        exact = alpha(paths_in(scene.renderer, 64, 64, corners), tau)
        rgba = scene.rgba()
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
        self.assertLess(np.abs(rgba[..., 3] - exact).max(), bound)
        return exact

    def test_both_silhouettes_have_the_right_thickness_everywhere(self):
        # VTK takes the wrong segment's opacity at the crossing of a quadrilateral silhouette
        for corners in (CROSSED, POINTED, CROSSED[::-1], POINTED[[1, 0, 2, 3]]):
            for parallel in (True, False):
                scene = one(corners, parallel=parallel)
                exact = self.assert_path(scene, corners)
                self.assertGreater((exact > 0.3).sum(), 100)

    def test_one_vertex_or_three_before_the_near_plane(self):
        # VTK drops a cell that crosses the near plane
        for corners in (CROSSED, POINTED, -POINTED):
            for near in (0.35, 0.5, 0.6):
                scene = one(corners, parallel=False)
                camera = scene.renderer.GetActiveCamera()
                camera.SetPosition(0.0, 0.0, 0.9)
                camera.SetViewAngle(80.0)
                camera.SetClippingRange(near, 5.0)
                exact = self.assert_path(scene, corners)
                self.assertGreater((exact > 0.1).sum(), 100)

    def test_the_eye_inside_and_a_vertex_behind_it(self):
        corners = np.array([[-3.0, -2.0, -2.0], [3.0, -2.0, -2.5], [0.0, 3.0, -2.0], [0.0, 0.0, 4.0]])
        scene = one(corners, parallel=False)
        camera = scene.renderer.GetActiveCamera()
        camera.SetPosition(0.1, 0.2, 0.5)
        camera.SetFocalPoint(0.0, 0.0, -2.0)
        camera.SetClippingRange(0.001, 10.0)
        exact = self.assert_path(scene, corners)
        self.assertGreater(exact.min(), 0.3)

    def test_edge_on_exactly_and_nearly(self):
        # three vertices in a plane through the eye, or along the rays in parallel: no thickness to lose,
        # none to invent
        for tilt in (0.0, 1e-12, 1e-6, 1e-3):
            corners = np.array(
                [[-0.5, 0.0, 0.4], [-0.5 + tilt, 0.3, -0.4], [-0.5, -0.5, 0.1], [0.6, 0.1, 0.2]]
            )
            with self.subTest(tilt=tilt):
                self.assert_path(one(corners, parallel=True), corners)
        flat = np.array([[-0.5, 0.0, 0.4], [0.5, 0.0, -0.4], [-0.4, 0.0, -0.5], [0.6, 0.0, 0.2]])
        scene = one(flat)
        self.assertEqual(scene.rgba()[..., 3].max(), 0.0) # no volume, nothing to see
        self.assertEqual(scene.mapper.GetNumberOfFlatTetrahedra(), 1)

    def test_a_thickness_far_below_the_longest_edge(self):
        for thin in (1e-3, 1e-5):
            corners = np.array([[-0.8, -0.7, 0.0], [0.8, -0.6, 0.0], [0.0, 0.8, 0.0], [0.0, -0.1, thin]])
            for parallel in (True, False):
                with self.subTest(thin=thin, parallel=parallel):
                    tau = 1.0 / thin
                    scene = one(corners, tau, parallel=parallel)
                    # bound of the stability suite: 1e-5 of the longest edge, here 1.6, times tau; the
                    # float picture's own bound beside it
                    self.assert_path(scene, corners, tau, FLOAT + 1.6e-5 * min(tau, 1e3))


class Meshes(InEachEngine):
    def test_six_cells_are_all_there_on_the_very_first_frame(self):
        scene = TetScene(cube(1), even(TAU))
        scene.look(OBLIQUE, half=1.0)
        rgba = scene.rgba() # the first
        self.assertEqual(scene.mapper.GetNumberOfTetrahedra(), 6)
        self.assertLess(np.abs(rgba[..., 3] - alpha(paths(scene.renderer, 64, 64))).max(), FLOAT)

    def test_small_cells_beside_large_ones_in_perspective(self):
        # VTK loses cells far smaller than their neighbours
        points = np.concatenate([lattice(2), lattice(2, 1e-3, (0.9, 0.0, 0.0))])
        cells = np.concatenate([tetrahedra_of(2), tetrahedra_of(2) + 27])
        scene = TetScene(mesh(points, cells, scalars=np.ones(54, np.float32)), even(1000.0))
        camera = scene.renderer.GetActiveCamera()
        camera.SetParallelProjection(False)
        camera.SetPosition(0.9, 0.0, 0.01)
        camera.SetFocalPoint(0.9, 0.0, 0.0)
        camera.SetViewAngle(12.0)
        camera.SetClippingRange(1e-3, 5.0)
        low, high = (0.9 - 5e-4, -5e-4, -5e-4), (0.9 + 5e-4, 5e-4, 5e-4)
        exact = alpha(paths(scene.renderer, 64, 64, low, high), 1000.0)
        self.assertGreater((exact > 0.5).sum(), 500)
        self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), 1e-3) # 1e-5 of the edges of 0.5, times tau

    def test_scalars_change_and_the_mesh_does_not(self):
        data = cube(4)
        scene = TetScene(data, extinction(ramp=((0.0, 0.0), (1.0, 1.0))))
        scene.look(half=0.4)
        self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(1.0, 1.0)), FLOAT)
        split = scene.mapper.GetSecondsSplit()
        self.assertGreater(split, 0.0)
        array = data.GetPointData().GetScalars()
        vtk_to_numpy(array)[:] = 0.25
        array.Modified()
        self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(1.0, 0.25)), FLOAT)
        self.assertEqual(scene.mapper.GetSecondsSplit(), 0.0) # the mesh was kept
        other = array.NewInstance()
        other.SetName("other")
        other.SetNumberOfTuples(array.GetNumberOfTuples())
        other.Fill(0.5)
        data.GetPointData().SetScalars(other)
        self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(1.0, 0.5)), FLOAT)
        self.assertEqual(scene.mapper.GetSecondsSplit(), 0.0)

    def test_the_mesh_moves_and_the_scalars_do_not(self):
        data = cube(2)
        scene = TetScene(data, even(TAU))
        scene.look(half=1.0)
        scene.window.Render()
        points = data.GetPoints()
        vtk_to_numpy(points.GetData())[:, 2] *= 0.5
        points.Modified()
        self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(0.5)), FLOAT)

    def test_negative_scalars(self):
        data = cube(2, field=lambda x, y, z: np.full_like(x, -7.0))
        prop = extinction(ramp=((-10.0, 0.0), (-4.0, 1.0)), colors=((-10.0, (0, 0, 0)), (-4.0, (1, 1, 1))))
        scene = TetScene(data, prop)
        scene.look(half=0.4)
        rgba = scene.rgba()[32, 32]
        self.assertLess(abs(rgba[3] - alpha(1.0, 0.5)), FLOAT)
        self.assertLess(abs(rgba[0] / rgba[3] - 0.5), FLOAT)

    def test_bytes_and_shorts(self):
        # VTK takes unsigned char scalars to be colours
        for dtype, value in ((np.uint8, 200), (np.int16, -1234), (np.uint16, 60000), (np.int8, -100)):
            data = mesh(lattice(2), tetrahedra_of(2), scalars=np.full(27, value, dtype))
            prop = extinction(ramp=((value - 50.0, 0.0), (value + 50.0, 1.0)))
            scene = TetScene(data, prop)
            scene.look(half=0.4)
            with self.subTest(dtype=dtype):
                self.assertLess(abs(scene.rgba()[32, 32, 3] - alpha(1.0, 0.5)), FLOAT)
                self.assertEqual(scene.messages.errors, [])

    def test_a_quadrilateral_of_four_points_is_no_tetrahedron(self):
        # nor are lines, triangles and vertices; VTK takes whatever has four points
        data = cube(2)
        for kind, ids in (
            (VTK_QUAD, (0, 2, 26, 24)),
            (VTK_TRIANGLE, (0, 2, 26)),
            (VTK_LINE, (0, 26)),
            (VTK_VERTEX, (3,)),
        ):
            data.InsertNextCell(kind, len(ids), ids)
        scene = TetScene(data, even(TAU))
        scene.look(OBLIQUE, half=1.0)
        self.assertLess(np.abs(scene.rgba()[..., 3] - alpha(paths(scene.renderer, 64, 64))).max(), FLOAT)
        self.assertEqual(scene.mapper.GetNumberOfLowerDimensionalCells(), 4)
        self.assertEqual(scene.messages.warnings, [])

    def test_agrees_with_vtk_as_far_as_vtk_is_right(self):
        # The even cube, n = 4, perspective: our error and VTK's own, both against the closed form.
        pictures = {}
        for mapper_class in (None, vtkProjectedTetrahedraMapper):
            if mapper_class is None:
                scene = TetScene(cube(4), even(TAU))
            else:
                scene = Scene((64, 64))
                scene.add_volume(cube(4), even(TAU), mapper_class())
            scene.look(OBLIQUE, half=1.0, parallel=False)
            scene.pixels() # VTK's first frame lacks cells
            pictures[mapper_class] = scene.pixels()[..., 0]
            exact = alpha(paths(scene.renderer, 64, 64))
        far = paths(scene.renderer, 64, 64) > 0.15 # where the issue measures
        ours, theirs = (255.0 * np.abs(p - exact)[far].mean() for p in pictures.values())
        print("even cube, mean error of 255: ours %.3f, vtkProjectedTetrahedraMapper %.3f" % (ours, theirs))
        self.assertLessEqual(ours, 0.3) # the bound: rounding to 8 bits is 0.25 in the mean
        both = 255.0 * np.abs(np.subtract(*pictures.values()))[far].mean()
        self.assertLessEqual(both, ours + theirs) # what the two errors allow


class OneTetrahedronInOpenGL(InOpenGL, OneTetrahedron):
    pass


class MeshesInOpenGL(InOpenGL, Meshes):
    pass


if __name__ == "__main__":
    unittest.main()
