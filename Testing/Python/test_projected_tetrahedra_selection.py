# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: the cell that one points at is found."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL
from occlusion_scene import float_image, sphere
from tetrahedra_scene import TetScene, even, extinction, hexahedra_of, lattice, mesh
from vtkmodules.util.vtkConstants import VTK_HEXAHEDRON
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingCore import vtkHardwareSelector, vtkPropPicker

SIZE = 32
N = 4


def blocks(opacities, **options):
    """N^3 hexahedra over a cube of edge 1, seen along -z so that it fills the picture; opacity is a cell's
    own scalar, tau over a length."""
    values = np.asarray(opacities, np.float32).reshape(-1)
    data = mesh(lattice(N), hexahedra_of(N), VTK_HEXAHEDRON, cell_scalars=values)
    scene = TetScene(data, extinction(unit=0.01, ramp=((0.0, 0.0), (1.0, 1.0))), (SIZE, SIZE), **options)
    scene.look(half=0.5)
    return scene


def found(scene, association=vtkDataObject.FIELD_ASSOCIATION_CELLS):
    """What is found in each pixel, [y, x], and its ids."""
    selector = vtkHardwareSelector()
    selector.SetRenderer(scene.renderer)
    selector.SetArea(0, 0, SIZE - 1, SIZE - 1)
    selector.SetFieldAssociation(association)
    scene.window.Render()
    assert selector.CaptureBuffers()
    props = np.full((SIZE, SIZE), None, object)
    ids = np.full((SIZE, SIZE), -1, np.int64)
    for y in range(SIZE):
        for x in range(SIZE):
            node = selector.GenerateSelection(x, y, x, y).GetNode(0)
            if node:
                props[y, x] = node.GetProperties().Get(node.PROP())
                ids[y, x] = node.GetSelectionList().GetValue(0)
    return props, ids


def cell(i, j, k):
    return i + N * (j + N * k)


def column(pixel):
    return pixel * N // SIZE


class Selection(InEachEngine):
    def test_the_first_opaque_cell_of_each_column_is_found(self):
        # layer k = 3 is nearest; what is opaque is 1 - exp(-25) of a cell
        opacities = np.zeros((N, N, N))
        opacities[3, :, 0] = 1.0
        opacities[2, :, :2] = 1.0
        opacities[0, :, 2] = 1.0
        scene = blocks(opacities)
        props, ids = found(scene)
        layer = {0: 3, 1: 2, 2: 0}
        for y in range(SIZE):
            for x in range(SIZE):
                i = column(x)
                if i in layer:
                    self.assertIs(props[y, x], scene.volume)
                    self.assertEqual(ids[y, x], cell(i, column(y), layer[i]))
                else:
                    self.assertIsNone(props[y, x])

    def test_opacity_is_accumulated_up_to_the_picking_opacity(self):
        # four layers of 0.3 each: passes 0.5 in the second, 0.7 in the fourth (0.3, 0.51, 0.657, 0.76)
        scene = blocks(np.full((N, N, N), -np.log(0.7) / 0.25 * 0.01))
        for limit, layer in ((0.2, 3), (0.5, 2), (0.6, 1), (0.7, 0)):
            scene.mapper.SetPickingOpacity(limit)
            _, ids = found(scene)
            for x, y in ((3, 5), (20, 9), (30, 30)):
                self.assertEqual(ids[y, x], cell(column(x), column(y), layer), limit)

    def test_haze_is_found_by_its_most_opaque_cell_and_nothing_below_a_step_of_255(self):
        opacities = np.full((N, N, N), 0.001)
        opacities[1] = 0.004
        scene = blocks(opacities) # 2.5 % and 10 % a cell: 0.5 is never passed
        _, ids = found(scene)
        self.assertEqual(ids[7, 9], cell(column(9), column(7), 1))
        scene = blocks(np.full((N, N, N), 1e-5)) # 1 - exp(-1e-3) altogether
        props, _ = found(scene)
        self.assertTrue((props == None).all()) # noqa: E711 (elementwise)

    def test_geometry_in_front_is_found_first(self):
        scene = blocks(np.full((N, N, N), 1.0))
        near, far = sphere(0.2, (0, 0, 0.7)), sphere(0.2, (0, 0, -0.7))
        scene.renderer.AddActor(near)
        scene.renderer.AddActor(far)
        scene.renderer.ResetCameraClippingRange()
        props, _ = found(scene)
        self.assertIs(props[16, 16], near)
        self.assertIs(props[2, 2], scene.volume)

    def test_points_are_those_of_the_cell(self):
        scene = blocks(np.full((N, N, N), 1.0))
        _, ids = found(scene, vtkDataObject.FIELD_ASSOCIATION_POINTS)
        for x, y in ((1, 1), (13, 9), (30, 22)):
            point = [round((v + 0.5) / SIZE * N) for v in (x, y)]
            self.assertEqual(ids[y, x], point[0] + (N + 1) * (point[1] + (N + 1) * N))

    def test_the_picture_stays(self):
        scene = blocks(np.full((N, N, N), 0.05))
        before = scene.rgba()
        picker = vtkPropPicker()
        self.assertEqual(picker.Pick(10, 10, 0, scene.renderer), 1)
        self.assertIs(picker.GetViewProp(), scene.volume)
        np.testing.assert_array_equal(float_image(scene.mapper), before)
        np.testing.assert_array_equal(scene.rgba(), before)


class SelectionInOpenGL(InOpenGL, Selection):
    pass


if __name__ == "__main__":
    unittest.main()
