# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the volume is found where one points at it."""
import unittest

import numpy as np
from occlusion_scene import WHITE, Messages, Scene, cube, float_image, image, sphere, volume_property
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingCore import vtkCellPicker, vtkHardwareSelector, vtkPropPicker

SIZE = 64
POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
CELLS = vtkDataObject.FIELD_ASSOCIATION_CELLS


def fog(opacity=0.5, unit=0.1, parallel=True, cells=False):
    """A box of even fog, |x|, |y|, |z| <= 1/2, in the middle of a picture from -1 to 1, seen along -z."""
    scene = Scene((SIZE, SIZE))
    values = np.ones((21, 21, 21), np.float32)
    data = image(values[:20, :20, :20], (0.05,) * 3, (-0.5,) * 3, True) if cells else cube(values)
    volume, mapper = scene.add_volume(data, volume_property(1.0, opacity, unit, WHITE))
    scene.look(half=1.0, parallel=parallel)
    return scene, volume, mapper


def selector_of(scene, association=CELLS):
    selector = vtkHardwareSelector()
    selector.SetRenderer(scene.renderer)
    selector.SetArea(0, 0, SIZE - 1, SIZE - 1)
    selector.SetFieldAssociation(association)
    scene.window.Render()
    assert selector.CaptureBuffers()
    return selector


def props(scene, association=CELLS):
    """What is found in each pixel, [y, x], and the ids of its points or cells."""
    selector = selector_of(scene, association)
    found = np.full((SIZE, SIZE), None, object)
    ids = np.full((SIZE, SIZE), -1, np.int64)
    selection = selector.GenerateSelection(0, 0, SIZE - 1, SIZE - 1)
    known = {}
    for i in range(selection.GetNumberOfNodes()):
        properties = selection.GetNode(i).GetProperties()
        known[properties.Get(selection.GetNode(i).PROP_ID())] = properties.Get(selection.GetNode(i).PROP())
    for y in range(SIZE):
        for x in range(SIZE):
            node = selector.GenerateSelection(x, y, x, y).GetNode(0)
            if node:
                found[y, x] = known[node.GetProperties().Get(node.PROP_ID())]
                ids[y, x] = node.GetSelectionList().GetValue(0)
    return found, ids


def at(x, y):
    """The pixel of a place of the world, seen in parallel."""
    return tuple(int(0.5 * (v + 1.0) * SIZE) for v in (y, x))


def vars_of(names):
    return [(k, v) for k, v in names.items() if k in ("near", "far", "beside", "inside", "volume")]


class Selection(unittest.TestCase):
    def test_the_nearer_of_volume_and_geometry_is_found_in_every_pixel(self):
        for parallel in (True, False):
            scene, volume, _ = fog(parallel=parallel)
            near, far, beside = (
                sphere(0.2, place) for place in ((-0.2, 0.2, 0.9), (0.2, -0.2, -0.9), (0.75, 0.0, 0.0))
            )
            inside = sphere(0.2, (0.2, 0.25, 0.0))
            for prop in (near, far, beside, inside):
                scene.renderer.AddActor(prop)
            scene.renderer.ResetCameraClippingRange(-1.5, 1.5, -1.5, 1.5, -1.5, 1.5)
            with self.subTest(parallel=parallel):
                found, _ = props(scene)
                counts = {name: (found == prop).sum() for name, prop in vars_of(locals())}
                self.assertGreater(counts["near"], 90)  # in front of the fog
                self.assertEqual(counts["far"], 0)  # behind and inside it, whatever the alpha
                self.assertEqual(counts["inside"], 0)
                self.assertGreater(counts["beside"], 20)
                self.assertGreater(counts["volume"], 500)
                # outside of all there is nothing
                self.assertIsNone(found[2, 2])
                # the fog's face is a square of 32 pixels, less the near sphere
                if parallel:
                    x, y = np.meshgrid(np.arange(SIZE), np.arange(SIZE))
                    face = (abs(x - 31.5) < 15.5) & (abs(y - 31.5) < 15.5)
                    self.assertTrue(((found == volume) | (found == near))[face].all())

    def test_more_opacity_asked_for_reaches_through_the_haze(self):
        # alpha 0.5 is reached 0.1 behind the face: z = 0.4
        for z, finds in ((0.41, "ball"), (0.39, "fog")):
            scene, volume, mapper = fog(opacity=0.5, unit=0.1)
            mapper.SetSampleDistance(0.02)
            mapper.SetSelectionOpacity(0.5)
            ball = sphere(0.2, (0.0, 0.0, z - 0.2))
            scene.renderer.AddActor(ball)
            found, _ = props(scene)
            self.assertEqual(found[at(0.0, 0.0)], ball if finds == "ball" else volume)
            self.assertEqual(found[at(0.3, 0.3)], volume)
            mapper.SetSelectionOpacity(0.985)  # alpha over the whole depth is 0.999, but the ball ends it
            found, _ = props(scene)
            self.assertEqual(found[at(0.0, 0.0)], ball)

    def test_ids_are_those_of_the_voxels_that_one_sees(self):
        for cells in (False, True):
            for association in (POINTS, CELLS):
                with self.subTest(cells=cells, association=association):
                    scene, _, _ = fog(cells=cells)
                    _, ids = props(scene, association)
                    n = 20 if association == CELLS else 21
                    for px, py in ((32, 32), (20, 40), (45, 22)):
                        x, y = ((p + 0.5) * 2.0 / SIZE - 1.0 for p in (px, py))
                        i, j = (
                            int((v + 0.5) / 0.05) if association == CELLS else round((v + 0.5) / 0.05)
                            for v in (x, y)
                        )
                        self.assertEqual(ids[py, px] % n, i)
                        self.assertEqual(ids[py, px] // n % n, j)
                        self.assertEqual(ids[py, px] // (n * n), n - 1)  # at the face towards the eye

    def test_a_transparent_or_unpickable_volume_is_not_found(self):
        for opacity, pickable in ((0.0, True), (0.5, False)):
            scene, volume, _ = fog(opacity=opacity)
            volume.SetPickable(pickable)
            ball = sphere(0.2)
            scene.renderer.AddActor(ball)
            found, _ = props(scene)
            self.assertEqual({prop for prop in found.ravel() if prop}, {ball})

    def test_the_picture_is_kept_over_a_selection(self):
        scene, _, mapper = fog()
        messages = Messages(mapper, scene.renderer, scene.window)
        scene.renderer.AddActor(sphere(0.2, (0.0, 0.0, 0.4)))
        expected = scene.pixels()
        before = float_image(mapper)
        selector_of(scene)
        self.assertEqual(np.abs(float_image(mapper) - before).max(), 0.0)
        self.assertEqual(np.abs(scene.pixels() - expected).max(), 0.0)
        self.assertTrue(mapper.GetReusedLastFrame())
        self.assertEqual(messages.errors + messages.warnings, [])

    def test_two_volumes_of_one_mapper_are_told_apart(self):
        scene, volume, mapper = fog()
        volume.SetPosition(-0.4, 0.0, -0.3)
        other, _ = scene.add_volume(mapper.GetInput(), volume.GetProperty(), mapper)
        other.SetPosition(0.4, 0.0, 0.3)
        scene.renderer.ResetCameraClippingRange(-1.5, 1.5, -1.5, 1.5, -1.5, 1.5)
        found, _ = props(scene)
        self.assertEqual(found[at(-0.6, 0.0)], volume)
        self.assertEqual(found[at(0.6, 0.0)], other)
        self.assertEqual(found[at(0.0, 0.0)], other)  # where both are, the nearer one


class Pickers(unittest.TestCase):
    def test_the_prop_picker_finds_volume_and_geometry(self):
        scene, volume, _ = fog()
        ball = sphere(0.2, (-0.75, 0.0, 0.0))
        scene.renderer.AddActor(ball)
        scene.window.Render()
        for (x, y), prop in (((32, 32), volume), ((8, 32), ball), ((2, 2), None)):
            picker = vtkPropPicker()
            picker.Pick(x, y, 0.0, scene.renderer)
            self.assertEqual(picker.GetViewProp(), prop)

    def test_the_cell_picker_finds_the_face_of_the_volume(self):
        scene, volume, mapper = fog()
        scene.window.Render()
        picker = vtkCellPicker()
        picker.SetTolerance(0.0)
        picker.SetVolumeOpacityIsovalue(0.2)
        self.assertEqual(picker.Pick(32, 32, 0.0, scene.renderer), 1)
        self.assertEqual(picker.GetViewProp(), volume)
        self.assertLess(abs(picker.GetPickPosition()[2] - 0.5), 0.051)  # a voxel


if __name__ == "__main__":
    unittest.main()
