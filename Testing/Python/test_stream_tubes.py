# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiStreamTubes as a Python user meets it: data carried, nothing lost silently, nonsense named."""
import math
import unittest

import numpy as np
from algorithm_messages import Messages
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkTriangleFilter, vtkCleanPolyData

from chiaroscuro import vtkChiStreamTubes


def lines(*polylines, dtype=np.float32):
    data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    flat = np.concatenate([np.asarray(p, float).reshape(-1, 3) for p in polylines] or [np.zeros((0, 3))])
    points.SetData(numpy_to_vtk(flat.astype(dtype), deep=True))
    start = 0
    for p in polylines:
        cells.InsertNextCell(len(p), list(range(start, start + len(p))))
        start += len(p)
    data.SetPoints(points)
    data.SetLines(cells)
    return data


def helix(count=200, turns=2.0):
    t = np.linspace(0, 2 * math.pi * turns, count)
    return np.stack([np.cos(t), np.sin(t), 0.2 * t], 1)


def add(attributes, name, values):
    array = numpy_to_vtk(np.asarray(values), deep=True)
    array.SetName(name)
    attributes.AddArray(array)
    return array


class StreamTubes(unittest.TestCase):
    def tube(self, data, **settings):
        tubes = vtkChiStreamTubes()
        self.messages = Messages(tubes)
        for name, value in settings.items():
            getattr(tubes, "Set" + name)(value)
        tubes.SetInputData(data)
        tubes.Update()
        return tubes

    def test_any_polyline_gives_a_tube_without_a_setting(self):
        tubes = self.tube(lines(helix()))
        out = tubes.GetOutput()
        self.assertGreater(out.GetNumberOfPoints(), 100)
        self.assertEqual(out.GetNumberOfStrips(), 12 + 2)
        normals = vtk_to_numpy(out.GetPointData().GetNormals())
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
        self.assertFalse(self.messages.warnings + self.messages.errors)
        curves = tubes.GetOutput(1)
        self.assertEqual(curves.GetNumberOfLines(), 1)
        # a chord of the tolerance 3.5e-4 spans sqrt(8 * 3.5e-4): 244 rings on a length of 12.9
        self.assertLess(curves.GetNumberOfPoints(), 300)
        self.assertGreater(tubes.GetNumberOfRemovedRings(), 0)

    def test_a_capped_tube_is_closed(self):
        for capping in ("Flat", "Round"):
            tubes = vtkChiStreamTubes()
            getattr(tubes, "SetCappingTo" + capping)()
            tubes.SetInputData(lines(helix()))
            tubes.GenerateTrianglesOn()
            tubes.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
            clean = vtkCleanPolyData()
            clean.SetInputConnection(tubes.GetOutputPort())
            clean.SetTolerance(0)
            edges = vtkFeatureEdges()
            edges.SetInputConnection(clean.GetOutputPort())
            edges.FeatureEdgesOff()
            edges.ManifoldEdgesOff()
            edges.Update()
            self.assertEqual(edges.GetOutput().GetNumberOfCells(), 0, capping)

    def test_all_data_are_carried(self):
        data = lines(helix(), helix() + 5)
        count = data.GetNumberOfPoints()
        add(data.GetPointData(), "speed", np.linspace(1, 3, count).astype(np.float32))
        add(data.GetPointData(), "number", np.arange(count, dtype=np.int32) + 7)
        add(data.GetPointData(), "velocity", np.random.default_rng(0).random((count, 3)))
        data.GetPointData().SetActiveScalars("speed")
        names = vtkStringArray()
        names.SetName("name")
        for i in range(count):
            names.InsertNextValue("p%d" % i)
        data.GetPointData().AddArray(names)
        add(data.GetCellData(), "bundle", np.array([11, 22], np.int64))
        tubes = self.tube(data)
        for out in (tubes.GetOutput(0), tubes.GetOutput(1)):
            pd = out.GetPointData()
            self.assertEqual(pd.GetScalars().GetName(), "speed")
            for i in range(pd.GetNumberOfArrays()):
                self.assertEqual(pd.GetAbstractArray(i).GetNumberOfTuples(), out.GetNumberOfPoints())
            speed = vtk_to_numpy(pd.GetArray("speed"))
            self.assertGreaterEqual(speed.min(), 1)
            self.assertLessEqual(speed.max(), 3)
            number = vtk_to_numpy(pd.GetArray("number"))
            self.assertEqual(pd.GetArray("number").GetDataTypeAsString(), "int")
            at = pd.GetAbstractArray("name")
            for i in range(0, out.GetNumberOfPoints(), 37):
                self.assertEqual(at.GetValue(i), "p%d" % (number[i] - 7))
            bundle = vtk_to_numpy(out.GetCellData().GetArray("bundle"))
            line = vtk_to_numpy(out.GetCellData().GetArray("LineId"))
            np.testing.assert_array_equal(bundle, np.where(line == 0, 11, 22))

    def test_a_straight_line_coloured_by_speed_keeps_its_colours(self):
        x = np.zeros((100, 3))
        x[:, 0] = np.arange(100)
        data = lines(x)
        add(data.GetPointData(), "speed", np.sin(np.arange(100) / 5.0))
        plain = self.tube(data, AttributeTolerance=0.0).GetOutput(1).GetNumberOfPoints()
        tubes = self.tube(data)
        curve = tubes.GetOutput(1)
        self.assertEqual(plain, 2)
        self.assertGreater(curve.GetNumberOfPoints(), 20)
        position = vtk_to_numpy(curve.GetPoints().GetData())[:, 0]
        speed = vtk_to_numpy(curve.GetPointData().GetArray("speed"))
        between = np.interp(np.arange(100), position, speed)
        # the tolerance is a thousandth of the range, which is 2
        np.testing.assert_allclose(between, np.sin(np.arange(100) / 5.0), atol=2e-3 * 1.001)

    def test_no_line_is_lost_without_a_count(self):
        nan = float("nan")
        data = lines(
            [[1, 2, 3]], [[4, 4, 4]] * 3, [[nan, 0, 0], [0, nan, 0]],
            [[0, 0, 0], [0, 0, 0], [1, 1, 1], [nan] * 3, [2, 2, 2], [2, 2, 2]],
            [[0, 0, 0], [3, 0, 0], [0, 0, 0.5]], [[0, 0, 0], [1, 0, 0], [0, 0, 0]], helix(),
            dtype=np.float64)
        tubes = self.tube(data, RadiusIsRelative=False, Radius=0.1)
        self.assertEqual(tubes.GetNumberOfSkippedLines(), 3)
        self.assertEqual(tubes.GetOutput(1).GetNumberOfLines(), 4)
        self.assertEqual(len(self.messages.warnings), 1)
        self.assertIn("3 lines have no tube", self.messages.warnings[0])
        points = vtk_to_numpy(tubes.GetOutput().GetPoints().GetData())
        self.assertTrue(np.isfinite(points).all())

    def test_a_radius_array_of_points_or_cells_scales_the_tubes(self):
        x = np.zeros((50, 3))
        x[:, 2] = np.arange(50)
        data = lines(x, x + [20, 0, 0])
        add(data.GetPointData(), "width", np.tile(np.linspace(1, 2, 50), 2))
        add(data.GetCellData(), "size", [1.0, 3.0])
        tubes = vtkChiStreamTubes()
        tubes.SetInputData(data)
        tubes.RadiusIsRelativeOff()
        tubes.SetRadius(0.5)
        tubes.SetCappingToNone()
        tubes.SetInputArrayToProcess(0, 0, 0, 0, "width")
        tubes.Update()
        p = vtk_to_numpy(tubes.GetOutput().GetPoints().GetData())
        first = p[p[:, 0] < 10]
        np.testing.assert_allclose(np.hypot(first[:, 0], first[:, 1]), 0.5 * (1 + first[:, 2] / 49), rtol=1e-5)
        tubes.SetInputArrayToProcess(0, 0, 0, 1, "size")
        tubes.Update()
        p = vtk_to_numpy(tubes.GetOutput().GetPoints().GetData())
        second = p[p[:, 0] > 10]
        np.testing.assert_allclose(np.hypot(second[:, 0] - 20, second[:, 1]), 1.5, rtol=1e-5)

    def test_nonsense_is_named(self):
        data = lines(helix())
        add(data.GetPointData(), "wrong", np.full(200, -1.0))
        tubes = vtkChiStreamTubes()
        messages = Messages(tubes)
        tubes.SetInputData(data)
        tubes.SetInputArrayToProcess(0, 0, 0, 0, "wrong")
        tubes.Update()
        self.assertTrue(any('"wrong"' in e and "negative" in e for e in messages.errors), messages.errors)
        tubes = self.tube(data, Radius=0.0)
        self.assertTrue(any("Radius" in e for e in self.messages.errors))
        self.assertEqual(tubes.GetOutput().GetNumberOfPoints(), 0)
        for setter, wanted in (("NumberOfSides", 3), ("Capping", 0), ("AttributeTolerance", 0.0)):
            tubes = vtkChiStreamTubes()
            getattr(tubes, "Set" + setter)(-5)
            self.assertEqual(getattr(tubes, "Get" + setter)(), wanted)

    def test_empty_input_gives_empty_output(self):
        for data in (vtkPolyData(), lines()):
            tubes = self.tube(data)
            self.assertEqual(tubes.GetOutput().GetNumberOfPoints(), 0)
            self.assertFalse(self.messages.warnings + self.messages.errors)

    def test_only_what_changed_is_done_again(self):
        tubes = self.tube(lines(helix()))
        time = tubes.GetOutput().GetMTime()
        tubes.Update()
        self.assertEqual(tubes.GetOutput().GetMTime(), time)
        tubes.SetRadius(0.01)
        tubes.Update()
        self.assertEqual(tubes.GetNumberOfFits(), 1)
        tubes.SetTolerance(1e-3)
        tubes.Update()
        self.assertEqual(tubes.GetNumberOfFits(), 2)

    def test_the_input_is_left_as_it_is(self):
        data = lines(helix())
        before = vtk_to_numpy(data.GetPoints().GetData()).copy()
        self.tube(data)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), before)

    def test_texture_coordinates_are_vtks(self):
        for mode, end in ((1, 1.0), (2, 2.0 / 4)):
            tubes = self.tube(lines([[0, 0, 0], [1, 0, 0], [2, 0, 0]]), GenerateTCoords=mode, TextureLength=4.0)
            tcoords = vtk_to_numpy(tubes.GetOutput().GetPointData().GetTCoords())
            self.assertAlmostEqual(tcoords[:, 0].max(), end, places=5)

    def test_outside_lines_are_skipped(self):
        tubes = vtkChiStreamTubes()
        tubes.SetInputData(lines(helix(), helix() + 100))
        tubes.SetClipBox(-2, 2, -2, 2, -1, 10)
        tubes.UseClipBoxOn()
        tubes.RadiusIsRelativeOff()
        tubes.SetRadius(0.1)
        tubes.Update()
        self.assertEqual(tubes.GetNumberOfClippedLines(), 1)
        self.assertEqual(tubes.GetOutput(1).GetNumberOfLines(), 1)


if __name__ == "__main__":
    unittest.main()
