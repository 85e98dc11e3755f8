# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiContinuousHistogram as a Python user meets it: any data set, closed forms, nonsense named."""
import math
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (vtkDataObject, vtkDataSetAttributes, vtkImageData, vtkMultiBlockDataSet,
                                           vtkPolyData, vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource

from chiaroscuro import vtkChiContinuousHistogram

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
CELLS = vtkDataObject.FIELD_ASSOCIATION_CELLS


def named(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def with_sum(data):
    """The sum of the coordinates as active scalars."""
    x = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    data.GetPointData().SetScalars(named(x.sum(1), "sum"))
    return data


def cube(n=6):
    data = vtkImageData()
    data.SetDimensions(n + 1, n + 1, n + 1)
    data.SetSpacing(1 / n, 1 / n, 1 / n)
    return with_sum(data)


def histogram_of(data, bins=30):
    histogram = vtkChiContinuousHistogram()
    histogram.SetInputDataObject(data)
    histogram.SetNumberOfBins(bins)
    return histogram


def heard(histogram, call=None):
    """Messages of errors and warnings of an update, or of a call."""
    messages = []

    def keep(_, event, text):
        messages.append(text)

    keep.CallDataType = "string0"
    tags = [histogram.AddObserver("ErrorEvent", keep), histogram.AddObserver("WarningEvent", keep)]
    executive = histogram.GetExecutive()
    tag = executive.AddObserver("ErrorEvent", lambda *_: None)
    if call:
        call()
    else:
        histogram.Modified()
        histogram.Update()
    executive.RemoveObserver(tag)
    for each in tags:
        histogram.RemoveObserver(each)
    return "\n".join(messages)


def updated(histogram):
    """The columns by name after an update without messages."""
    messages = heard(histogram)
    if messages:
        raise AssertionError(messages)
    table = histogram.GetOutput()
    return {table.GetColumnName(k): vtk_to_numpy(table.GetColumn(k)).copy()
            for k in range(table.GetNumberOfColumns())}


def below(t):
    """The distribution of the sum of three numbers, each even on [0, 1]."""
    return sum(c * np.maximum(t - k, 0) ** 3 / 6 for k, c in enumerate((1, -3, 3, -1)))


class ClosedForms(unittest.TestCase):
    def check(self, data):
        columns = updated(histogram_of(data))
        self.assertEqual(list(columns), ["BinCenter", "Density", "IsoArea", "Mass", "Cumulative"])
        edges = np.linspace(0, 3, 31)
        # some hundreds of parts a bin are added, coordinates are rounded: 1e-13 each way
        np.testing.assert_allclose(columns["BinCenter"], (edges[1:] + edges[:-1]) / 2, atol=1e-13)
        np.testing.assert_allclose(columns["Mass"], np.diff(below(edges)), atol=1e-13)
        np.testing.assert_allclose(columns["Density"], np.diff(below(edges)) / 0.1, atol=1e-12)
        np.testing.assert_allclose(columns["IsoArea"], columns["Density"] * math.sqrt(3), atol=1e-12)
        np.testing.assert_allclose(columns["Cumulative"], below(edges[1:]), atol=1e-13)

    def test_images_with_an_extent(self):
        self.check(cube())
        data = vtkImageData()
        data.SetExtent(3, 13, -4, 6, 1, 11)
        data.SetSpacing(0.1, 0.1, 0.1)
        data.SetOrigin(-0.3, 0.4, -0.1)
        self.check(with_sum(data))

    def test_rectilinear_and_curvilinear_grids(self):
        axis = np.linspace(0, 1, 7) ** 2
        grid = vtkRectilinearGrid()
        grid.SetDimensions(7, 7, 7)
        grid.SetXCoordinates(named(axis, "x"))
        grid.SetYCoordinates(named(axis, "y"))
        grid.SetZCoordinates(named(axis, "z"))
        self.check(with_sum(grid))
        curved = vtkStructuredGrid()
        curved.SetDimensions(7, 7, 7)
        points = vtkPoints()
        points.SetData(named(np.array([grid.GetPoint(i) for i in range(343)]), "points"))
        curved.SetPoints(points)
        self.check(with_sum(curved))

    def test_unstructured_grids(self):
        append = vtkAppendFilter()
        append.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
        append.AddInputData(cube())
        append.Update()
        self.check(append.GetOutput())

    def test_polygons_are_measured_by_area(self):
        plane = vtkPlaneSource()
        plane.SetResolution(5, 4)
        plane.Update()
        data = with_sum(plane.GetOutput())
        histogram = histogram_of(data, 8)
        columns = updated(histogram)
        triangle = 1 - np.abs(columns["BinCenter"])
        np.testing.assert_allclose(columns["Density"], triangle, atol=1e-6)  # its points are float
        np.testing.assert_allclose(columns["IsoArea"], triangle * math.sqrt(2), atol=1e-6)
        self.assertAlmostEqual(histogram.GetTotalMass(), 1, 6)

    def test_moments_and_quantiles_are_not_read_from_bins(self):
        histogram = histogram_of(cube(), 2)
        histogram.SetNumberOfMoments(6)
        updated(histogram)
        self.assertAlmostEqual(histogram.GetMean(), 1.5, 13)
        self.assertAlmostEqual(histogram.GetVariance(), 0.25, 13)
        self.assertAlmostEqual(histogram.GetCentralMoment(4), 0.1625, 13)
        self.assertAlmostEqual(histogram.GetMoment(2), 2.5, 12)
        self.assertEqual(histogram.GetMoment(0), 1)
        for t in (0.1, 0.5, 1, 1.5, 2.25):
            # 1e-12 of the range 3; near 0 the share's rounding by the slope t^2 / 2 beside
            self.assertAlmostEqual(histogram.GetQuantile(float(below(np.array(t)))), t, delta=4e-12)
        self.assertEqual(histogram.GetQuantile(0), 0)
        self.assertEqual(histogram.GetQuantile(1), 3)


class Options(unittest.TestCase):
    def test_a_window_counts_what_is_beyond(self):
        histogram = histogram_of(cube(), 7)
        histogram.AutomaticRangeOff()
        histogram.SetRange(1, 2)
        columns = updated(histogram)
        self.assertAlmostEqual(columns["Mass"].sum(), 2 / 3, 13)
        self.assertAlmostEqual(histogram.GetMassOutOfRange(), 1 / 3, 13)
        self.assertAlmostEqual(histogram.GetMassBelowRange(), 1 / 6, 13)
        self.assertAlmostEqual(columns["Cumulative"][-1], 5 / 6, 13)

    def test_fields_of_cells_are_constant_in_each(self):
        data = cube(4)
        data.GetCellData().AddArray(named(np.arange(64) % 4 * 1.0, "a"))
        histogram = histogram_of(data, 4)
        histogram.SetInputArrayToProcess(0, 0, 0, CELLS, "a")
        np.testing.assert_allclose(updated(histogram)["Mass"], 0.25, rtol=1e-13)
        self.assertAlmostEqual(histogram.GetSingularMass(), 1, 13)
        self.assertEqual(histogram.GetQuantile(1), 3)

    def test_components_and_magnitude(self):
        data = cube(4)
        s = vtk_to_numpy(data.GetPointData().GetScalars())
        data.GetPointData().AddArray(named(np.stack([0 * s, s, 0 * s], 1), "vector"))
        expected = updated(histogram_of(data))["Mass"]
        for component in (1, -1):
            histogram = histogram_of(data)
            histogram.SetInputArrayToProcess(0, 0, 0, POINTS, "vector")
            histogram.SetComponent(component)
            np.testing.assert_allclose(updated(histogram)["Mass"], expected, atol=1e-14)

    def test_ghosts_are_left_out(self):
        data = cube(4)
        ghosts = named(np.r_[np.ones(16, np.uint8), np.zeros(48, np.uint8)],
                       vtkDataSetAttributes.GhostArrayName())
        data.GetCellData().AddArray(ghosts)
        histogram = histogram_of(data)
        updated(histogram)
        self.assertEqual(histogram.GetNumberOfHiddenCells(), 16)
        self.assertAlmostEqual(histogram.GetTotalMass(), 0.75, 13)

    def test_unchanged_input_keeps_its_ranges(self):
        histogram = histogram_of(cube(20))
        updated(histogram)
        self.assertEqual(histogram.GetNumberOfSkipped(histogram.SKIP_UNCHANGED), 0)
        histogram.SetNumberOfBins(2)  # bricks span 1.2 of 3
        kept = updated(histogram)["Mass"]
        self.assertEqual(histogram.GetNumberOfSkipped(histogram.SKIP_UNCHANGED), 1)
        self.assertGreater(histogram.GetNumberOfSkipped(histogram.SKIP_ONE_BIN), 0)
        histogram.SetSkippingMask(0)
        np.testing.assert_allclose(updated(histogram)["Mass"], kept, atol=1e-13)
        for kind in (1, 2, 4):
            self.assertEqual(histogram.GetNumberOfSkipped(kind), 0)

    def test_changed_values_are_seen(self):
        data = cube(5)
        histogram = histogram_of(data)
        updated(histogram)
        vtk_to_numpy(data.GetPointData().GetScalars())[:] *= 2
        data.GetPointData().GetScalars().Modified()
        message = heard(histogram, lambda: self.assertTrue(math.isnan(histogram.GetQuantile(0.5))))
        self.assertIn("changed since the last update", message)
        updated(histogram)
        self.assertAlmostEqual(histogram.GetQuantile(0.5), 3, delta=6e-12)
        self.assertAlmostEqual(histogram.GetMean(), 3, 12)

    def test_an_empty_data_set_is_no_error(self):
        for data in (vtkUnstructuredGrid(), vtkPolyData()):
            histogram = histogram_of(data)
            self.assertEqual(heard(histogram), "")
            self.assertEqual(histogram.GetOutput().GetNumberOfRows(), 0)
            self.assertTrue(math.isnan(histogram.GetMean()))
            self.assertTrue(math.isnan(histogram.GetQuantile(0.5)))


class Nonsense(unittest.TestCase):
    def test_it_is_named(self):
        data = cube(3)
        few = named(np.zeros(5), "few")
        data.GetPointData().AddArray(few)
        cases = [
            (lambda h: h.SetNumberOfBins(0), "NumberOfBins is 0"),
            (lambda h: h.SetNumberOfBins(2000000), "NumberOfBins is 2000000"),
            (lambda h: (h.AutomaticRangeOff(), h.SetRange(3, 2)), "the range is [3, 2]"),
            (lambda h: (h.AutomaticRangeOff(), h.SetRange(2, 2)), "the range is [2, 2]"),
            (lambda h: (h.AutomaticRangeOff(), h.SetRange(0, float("nan"))), "the range is [0, nan]"),
            (lambda h: (h.AutomaticRangeOff(), h.SetRange(0, float("inf"))), "the range is [0, inf]"),
            (lambda h: h.SetInputArrayToProcess(0, 0, 0, POINTS, "missing"), "no array 'missing'"),
            (lambda h: h.SetInputArrayToProcess(0, 0, 0, CELLS, "sum"), "no array 'sum'"),
            (lambda h: h.SetInputArrayToProcess(0, 0, 0, POINTS, "few"), "does not belong to the input"),
            (lambda h: h.SetComponent(1), "has no component 1"),
            (lambda h: h.SetComponent(-2), "has no component -2"),
        ]
        for change, words in cases:
            histogram = histogram_of(data)
            change(histogram)
            self.assertIn(words, heard(histogram))
            self.assertEqual(histogram.GetOutput().GetNumberOfRows(), 0)
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, data)
        self.assertIn("vtkMergeBlocks", heard(histogram_of(blocks)))
        bare = vtkImageData()
        bare.SetDimensions(3, 3, 3)
        self.assertIn("no active scalars", heard(histogram_of(bare)))

    def test_orders_and_shares_are_checked(self):
        histogram = histogram_of(cube(3))
        self.assertTrue(math.isnan(histogram.GetMoment(1)))  # not updated: nothing to say
        updated(histogram)
        for call, words in ((lambda: histogram.GetMoment(5), "orders are 0 ... 4"),
                            (lambda: histogram.GetCentralMoment(-1), "orders are 0 ... 4"),
                            (lambda: histogram.GetQuantile(1.5), "shares are 0 ... 1"),
                            (lambda: histogram.GetQuantile(float("nan")), "shares are 0 ... 1")):
            self.assertIn(words, heard(histogram, call))

    def test_values_that_are_no_numbers_are_counted(self):
        data = cube(6)
        vtk_to_numpy(data.GetPointData().GetScalars())[3 + 7 * 3 + 49 * 3] = np.nan
        histogram = histogram_of(data)
        self.assertIn("8 cells", heard(histogram))
        self.assertEqual(histogram.GetNumberOfSkippedCells(), 8)
        self.assertAlmostEqual(histogram.GetTotalMass(), 1 - 8 / 216, 12)

    def test_a_constant_gets_a_window_and_one_message(self):
        data = cube(3)
        vtk_to_numpy(data.GetPointData().GetScalars())[:] = 5
        histogram = histogram_of(data, 3)
        self.assertIn("is constant, 5", heard(histogram))
        mass = vtk_to_numpy(histogram.GetOutput().GetColumn(3))
        np.testing.assert_allclose(mass, [0, 1, 0], atol=1e-13)
        self.assertEqual(histogram.GetMean(), 5)
        self.assertEqual(histogram.GetQuantile(0.3), 5)


if __name__ == "__main__":
    unittest.main()
