# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: other ways from tetrahedra to pixels than planes at their centres."""
import unittest

import numpy as np
from occlusion_scene import float_image
from tetrahedra_scene import TetScene, cube, even, paths

# What the float picture of an even cube may be off by (issue: accuracy of the homogeneous cube).
FLOAT = 1e-4
TAU = 2.0
OBLIQUE = (-0.4, -0.5, -1.0)


def alpha(path):
    return 1.0 - np.exp(-TAU * path)


def even_cube(n, parallel):
    scene = TetScene(cube(n), even(TAU), (64, 64))
    scene.look(OBLIQUE, half=1.0, parallel=parallel)
    return scene


class Published(unittest.TestCase):
    """Shirley and Tuchman's projection: linear thickness on the screen."""

    def test_is_exact_where_thickness_is_linear(self):
        scene = even_cube(3, True)
        scene.mapper.SetProjectionToPublished()
        exact = alpha(paths(scene.renderer, 64, 64))
        self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)
        self.assertEqual(scene.mapper.GetNumberOfExactTetrahedra(), 0)
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))

    def test_is_off_in_perspective_and_by_less_of_smaller_cells(self):
        errors = []
        for n in (1, 4):
            scene = even_cube(n, False)
            exact = alpha(paths(scene.renderer, 64, 64))
            self.assertEqual(scene.mapper.GetProjection(), scene.mapper.PROJECTION_EXACT)
            self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)
            scene.mapper.SetProjectionToPublished()
            errors.append(255.0 * np.abs(scene.rgba()[..., 3] - exact).mean())
            scene.mapper.SetProjectionToExact()
            self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)
        # what is left out is a depth's second derivative over a cell
        self.assertGreater(errors[0], 0.1)
        self.assertLess(errors[1], errors[0] / 2.0)

    def test_what_the_near_plane_cuts_is_drawn_exactly_and_counted(self):
        scene = even_cube(1, False)
        camera = scene.renderer.GetActiveCamera()
        camera.SetPosition(0.1, -0.2, 0.3) # in the cube: what is not behind the eye is cut
        camera.SetFocalPoint(0.3, 0.2, -1.0)
        camera.SetClippingRange(0.2, 5.0)
        scene.mapper.SetProjectionToPublished()
        self.assertEqual(scene.mapper.GetProjection(), scene.mapper.PROJECTION_PUBLISHED)
        exact = alpha(paths(scene.renderer, 64, 64))
        self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)
        self.assertGreater(scene.mapper.GetNumberOfExactTetrahedra(), 0)
        self.assertIn("Projection: Published", str(scene.mapper))
        self.assertEqual(float_image(scene.mapper).shape, (64, 64, 4))

    def test_is_drawn_by_the_cpu_engine_alone(self):
        scene = even_cube(2, True)
        mapper = scene.mapper
        mapper.SetEngineToOpenGL()
        mapper.SetProjectionToPublished()
        exact = alpha(paths(scene.renderer, 64, 64))
        self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)
        self.assertEqual(mapper.GetEngineInUse(), mapper.ENGINE_CPU)
        self.assertIn("published projection", mapper.GetEngineReason())
        self.assertEqual(len(scene.messages.warnings), 1)
        mapper.SetProjectionToExact()
        scene.window.Render()
        self.assertEqual(mapper.GetEngineInUse(), mapper.ENGINE_OPENGL)


class Splatting(unittest.TestCase):
    """Tetrahedra below a pixel."""

    def scene(self, splatting, tau=0.01):
        # 24^3 cubes of a third of a pixel, and three quarters of the window empty
        scene = TetScene(cube(24), even(tau), (16, 16))
        scene.mapper.SetSubpixelSplatting(splatting)
        scene.look(OBLIQUE, half=1.1, parallel=True)
        return scene

    def test_keeps_the_optical_depth(self):
        off = {}
        for splatting in (False, True):
            scene = self.scene(splatting)
            opacity = scene.rgba()[..., 3].astype(float)
            pixel = (2.0 * 1.1 / 16.0) ** 2
            # an even cube of edge 1: its volume
            off[splatting] = abs(-np.log1p(-opacity).sum() * pixel / 0.01 - 1.0)
            self.assertEqual(scene.mapper.GetNumberOfSplattedTetrahedra() > 6 * 24**3 - 1, splatting)
            self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
        self.assertLess(off[True], 1e-4)
        self.assertLess(off[True], off[False])
        self.assertIn("SubpixelSplatting: 1", str(scene.mapper))

    def test_leaves_large_cells_alone(self):
        scene = even_cube(1, True)
        plain = scene.rgba()
        scene.mapper.SubpixelSplattingOn()
        np.testing.assert_array_equal(plain, scene.rgba())
        self.assertEqual(scene.mapper.GetNumberOfSplattedTetrahedra(), 0)

    def test_is_the_cpu_engines(self):
        scene = self.scene(True)
        scene.mapper.SetEngineToOpenGL()
        scene.window.Render()
        self.assertEqual(scene.mapper.GetEngineInUse(), scene.mapper.ENGINE_CPU)
        self.assertIn("splatted", scene.mapper.GetEngineReason())
        self.assertEqual(len(scene.messages.warnings), 1)


if __name__ == "__main__":
    unittest.main()
