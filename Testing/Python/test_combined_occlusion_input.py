# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: whatever comes in."""
import unittest

import numpy as np
from occlusion_scene import Messages, Scene, ball, float_image, image, sphere, volume_property
from vtkmodules.util import vtkConstants
from vtkmodules.vtkCommonCore import vtkBitArray, vtkDataArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane, vtkRectilinearGrid
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.util.numpy_support import numpy_to_vtk

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

EDGE = 24
SPACING = (1.0 / EDGE,) * 3


def lopsided():
    """A field without any symmetry, zero at the border."""
    values = ball(EDGE, 0.28, 0.3, (-0.1, 0.05, 0.0)) + 0.7 * ball(EDGE, 0.12, 0.2, (0.2, 0.2, 0.1))
    return np.clip(values, 0.0, 1.0)


def picture(data, prop=None, prepare=None):
    """One frame of `data`, seen askew: float image, mapper, messages."""
    scene = Scene((96, 96))
    volume, mapper = scene.add_volume(data, prop or volume_property(opacity=0.5, unit=0.1))
    messages = Messages(mapper)
    if prepare:
        prepare(volume, mapper, scene)
    scene.look((-0.4, -0.5, -1.0), half=0.7, parallel=False)
    scene.window.Render()
    scene.window.Render()
    return float_image(mapper), mapper, messages


def mean_difference(a, b):
    covered = (a[..., 3] > 0) | (b[..., 3] > 0)
    return 255.0 * np.abs(a - b).max(axis=2)[covered].mean()


class Input(unittest.TestCase):
    def test_every_scalar_type_gives_the_same_picture(self):
        values = np.round(100.0 * lopsided())
        prop = volume_property(100.0, 0.5, 0.1)
        reference = None
        names = (
            "UNSIGNED_CHAR CHAR SIGNED_CHAR SHORT UNSIGNED_SHORT INT UNSIGNED_INT LONG UNSIGNED_LONG "
            "LONG_LONG UNSIGNED_LONG_LONG ID_TYPE FLOAT DOUBLE"
        )
        for name in names.split():
            with self.subTest(type=name):
                data = image(values.astype(np.float32), SPACING)
                array = vtkDataArray.CreateDataArray(getattr(vtkConstants, "VTK_" + name))
                array.DeepCopy(data.GetPointData().GetScalars())
                data.GetPointData().SetScalars(array)
                result, _, messages = picture(data, prop)
                self.assertEqual((messages.errors, messages.warnings), ([], []))
                self.assertGreater(result[..., 3].max(), 0.5)
                reference = result if reference is None else reference
                # the tables have entries on the integers or 4097 over the range; both are linear
                # between the nodes, so that only kinks at nodes and roundings of float differ
                self.assertLessEqual(mean_difference(result, reference), 0.1)

    def test_a_narrow_peak_in_a_wide_range_is_not_lost(self):
        values = lopsided().astype(np.float64)
        prop = volume_property(1.0, 0.5, 0.1)
        ramp = prop.GetScalarOpacity()
        ramp.RemoveAllPoints()
        for place, opacity in ((0.0, 0.0), (0.499, 0.0), (0.5, 0.9), (0.501, 0.0), (1.0, 0.0)):
            ramp.AddPoint(place, opacity)
        expected, _, _ = picture(image(values, SPACING), prop)
        # the same, but for one voxel in a corner whose value makes the range a hundred times wider
        values[0, 0, 0] = -100.0
        result, _, _ = picture(image(values, SPACING), prop)
        self.assertGreater(expected[..., 3].max(), 0.05)
        self.assertLessEqual(mean_difference(result, expected), 1.0)

    def test_bits_are_drawn(self):
        values = (lopsided() > 0.5).astype(np.uint8)
        data = image(values, SPACING)
        expected, _, _ = picture(data)
        bits = vtkBitArray()
        bits.SetNumberOfTuples(values.size)
        for i, value in enumerate(values.ravel()):
            bits.SetValue(i, int(value))
        data.GetPointData().SetScalars(bits)
        result, _, messages = picture(data)
        self.assertEqual(messages.errors, [])
        self.assertEqual(np.abs(result - expected).max(), 0.0)

    def test_cells_lie_between_their_points(self):
        values = lopsided()  # zero at the border, so that the constant margins of cells do not show
        by_points, _, _ = picture(image(values, SPACING))
        by_cells, _, messages = picture(image(values, SPACING, cells=True))
        self.assertEqual(messages.errors, [])
        # the same samples at the same places; only the first slice may lie elsewhere
        self.assertLessEqual(mean_difference(by_points, by_cells), 1.0)

    def test_an_array_is_chosen_by_name_and_a_missing_one_is_named(self):
        data = image(lopsided(), SPACING)
        expected, _, _ = picture(data)
        data.GetPointData().SetActiveScalars(None)

        def choose(name):
            def prepare(_volume, mapper, _scene):
                mapper.SetScalarModeToUsePointFieldData()
                mapper.SelectScalarArray(name)

            return prepare

        result, _, messages = picture(data, prepare=choose("density"))
        self.assertEqual(messages.errors, [])
        self.assertEqual(np.abs(result - expected).max(), 0.0)
        result, _, messages = picture(data, prepare=choose("pressure"))
        self.assertIsNone(result)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("'pressure'", messages.errors[0])
        self.assertIn("vtkChiCombinedOcclusionVolumeMapper", messages.errors[0])

    def test_negative_spacing_equals_the_mirrored_array(self):
        values = lopsided()
        expected, _, _ = picture(image(values, SPACING))
        for axis in range(3):
            spacing = list(SPACING)
            origin = [-0.5 * (EDGE - 1) * h for h in SPACING]
            spacing[axis] *= -1.0
            origin[axis] *= -1.0
            data = image(np.flip(values, 2 - axis), spacing, origin)
            result, _, messages = picture(data)
            self.assertEqual(messages.errors, [])
            self.assertLessEqual(mean_difference(result, expected), 0.05)  # roundings of float

    def test_a_direction_matrix_equals_a_rotated_volume(self):
        angle = np.radians(35.0)
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        values = lopsided()
        straight = image(values, SPACING)
        matrix = vtkMatrix4x4()
        for row in range(3):
            for column in range(3):
                matrix.SetElement(row, column, turn[row, column])
        expected, _, _ = picture(straight, prepare=lambda volume, *_: volume.SetUserMatrix(matrix))
        turned = image(values, SPACING, turn @ np.array(straight.GetOrigin()))
        turned.SetDirectionMatrix(*turn.ravel())
        result, _, messages = picture(turned)
        self.assertEqual(messages.errors, [])
        self.assertLessEqual(mean_difference(result, expected), 0.05)  # roundings of float
        upright, _, _ = picture(straight)
        self.assertGreater(mean_difference(result, upright), 5.0)  # it did turn

    def test_an_extent_that_does_not_begin_at_zero_moves_nothing_else(self):
        values = lopsided()
        expected, _, _ = picture(image(values, SPACING))
        data = image(values, SPACING)
        offset = (5, -7, 11)
        data.SetExtent(*[v for o in offset for v in (o, o + EDGE - 1)])
        data.SetOrigin([a - o * h for a, o, h in zip(data.GetOrigin(), offset, SPACING)])
        result, _, messages = picture(data)
        self.assertEqual(messages.errors, [])
        self.assertLessEqual(mean_difference(result, expected), 0.05)

    def test_scale_and_mirror_of_the_volume_are_honoured(self):
        values = lopsided()
        expected, _, _ = picture(image(np.flip(values, 2), (SPACING[0] / 2, SPACING[1], SPACING[2])))
        result, _, _ = picture(
            image(values, SPACING), prepare=lambda volume, *_: volume.SetScale(-0.5, 1.0, 1.0)
        )
        self.assertLessEqual(mean_difference(result, expected), 0.05)

    def test_flat_images_are_named_and_draw_nothing(self):
        for shape in ((1, 1, 1), (1, 1, 2), (1, 8, 8)):
            with self.subTest(shape=shape):
                result, _, messages = picture(image(np.ones(shape, np.float32), SPACING))
                self.assertIsNone(result)
                self.assertEqual(len(messages.errors), 1)
                self.assertIn("encloses no volume", messages.errors[0])

    def test_a_flat_image_still_leaves_the_geometry_shaded(self):
        def add(_volume, _mapper, scene):
            scene.renderer.AddActor(sphere(0.3))

        result, _, messages = picture(image(np.ones((1, 1, 1), np.float32)), prepare=add)
        self.assertEqual(len(messages.errors), 1)
        self.assertGreater(result[..., 3].max(), 0.99)

    def test_a_single_cell_is_drawn(self):
        result, _, messages = picture(image(np.ones((1, 1, 1), np.float32), cells=True))
        self.assertEqual(messages.errors, [])
        self.assertGreater(result[..., 3].max(), 0.1)

    def test_empty_input_gives_nothing_and_no_message(self):
        result, _, messages = picture(vtkImageData())
        self.assertIsNone(result)
        self.assertEqual((messages.errors, messages.warnings), ([], []))

    def test_an_image_without_scalars_is_named(self):
        data = vtkImageData()
        data.SetDimensions(4, 4, 4)
        result, _, messages = picture(data)
        self.assertIsNone(result)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("no scalars", messages.errors[0])

    def test_too_short_an_array_is_named(self):
        data = image(lopsided(), SPACING)
        data.GetPointData().GetScalars().Resize(100)
        result, _, messages = picture(data)
        self.assertIsNone(result)
        self.assertIn("too short", messages.errors[0])
        self.assertIn("'density'", messages.errors[0])

    def test_singular_matrices_are_named(self):
        matrix = vtkMatrix4x4()
        matrix.SetElement(1, 1, 0.0)
        result, _, messages = picture(
            image(lopsided(), SPACING), prepare=lambda volume, *_: volume.SetUserMatrix(matrix)
        )
        self.assertIsNone(result)
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("singular", messages.errors[0])

    def test_nan_voxels_are_transparent_and_counted(self):
        values = lopsided()
        hole = values.copy()
        hole[8:14, 8:14, 8:14] = np.nan
        expected = values.copy()
        result, mapper, messages = picture(image(hole, SPACING))
        self.assertTrue(np.isfinite(result).all())
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("NaN", messages.warnings[0])
        full, _, _ = picture(image(expected, SPACING))
        self.assertLess(result[..., 3].sum(), full[..., 3].sum())
        only, mapper, _ = picture(image(np.full_like(values, np.nan), SPACING))
        self.assertEqual(only[..., 3].max(), 0.0)
        self.assertTrue(np.isfinite(only).all())

    def test_a_rectilinear_grid_is_resampled_and_says_so(self):
        values = lopsided()
        expected, _, _ = picture(image(values, SPACING))
        plain = image(values, SPACING)
        grid = vtkRectilinearGrid()
        grid.SetDimensions(EDGE, EDGE, EDGE)
        for axis, name in enumerate("XYZ"):
            ticks = plain.GetOrigin()[axis] + np.arange(EDGE) * SPACING[axis]
            getattr(grid, f"Set{name}Coordinates")(numpy_to_vtk(ticks, deep=True))
        grid.GetPointData().SetScalars(plain.GetPointData().GetScalars())
        result, _, messages = picture(grid)
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("vtkRectilinearGrid", messages.warnings[0])
        self.assertLessEqual(mean_difference(result, expected), 0.05)

    def test_what_is_not_supported_is_named_once_and_something_is_drawn(self):
        data = image(lopsided(), SPACING)
        causes = {
            "two-dimensional transfer function": lambda volume, *_: volume.GetProperty().SetTransferFunctionModeTo2D(),
            "unit distance": lambda volume, *_: volume.GetProperty().SetScalarOpacityUnitDistance(-1.0),
            "blend mode": lambda _volume, mapper, _scene: mapper.SetBlendModeToMaximumIntensity(),
            "clipping planes": lambda _volume, mapper, _scene: [
                mapper.AddClippingPlane(vtkPlane()) for _ in range(33)],
        }
        if hasattr(volume_property(), "SetInterpolationTypeToCubic"):  # not in every VTK
            causes["cubic interpolation"] = lambda volume, *_: volume.GetProperty().SetInterpolationTypeToCubic()
        for cause, prepare in causes.items():
            with self.subTest(cause=cause):
                result, _, messages = picture(data, volume_property(opacity=0.5, unit=0.1), prepare)
                self.assertGreater(result[..., 3].max(), 0.3)
                self.assertEqual(messages.errors, [])
                self.assertEqual(len(messages.warnings), 1, messages.warnings)
                self.assertIn(cause, messages.warnings[0])

    def test_setters_clamp(self):
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        for name, low, high in (
            ("ConeAngle", 1.0, 85.0),
            ("NumberOfDirections", 4, 64),
            ("OcclusionStrength", 0.0, 1.0),
            ("SampleDistance", 0.0, None),
            ("GeometryThickness", 0.0, None),
        ):
            getattr(mapper, "Set" + name)(-1000)
            self.assertEqual(getattr(mapper, "Get" + name)(), low)
            if high is not None:
                getattr(mapper, "Set" + name)(1000)
                self.assertEqual(getattr(mapper, "Get" + name)(), high)


if __name__ == "__main__":
    unittest.main()
