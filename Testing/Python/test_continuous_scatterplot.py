# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiContinuousScatterplot as a Python user meets it: any data set, closed forms, nonsense named."""
import unittest

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (vtkDataObject, vtkDataSetAttributes, vtkImageData, vtkMultiBlockDataSet,
                                           vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource

from chiaroscuro import vtkChiContinuousScatterplot

try:
    from vtkmodules.vtkInfovisCore import vtkContinuousScatterplot
except ImportError:
    vtkContinuousScatterplot = None

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
CELLS = vtkDataObject.FIELD_ASSOCIATION_CELLS


def named(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def places(data):
    return np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])


def with_fields(data, u, v):
    x = places(data)
    data.GetPointData().AddArray(named(u(x), "u"))
    data.GetPointData().AddArray(named(v(x), "v"))
    return data


def cube(n=6):
    data = vtkImageData()
    data.SetDimensions(n + 1, n + 1, n + 1)
    data.SetSpacing(1 / n, 1 / n, 1 / n)
    return with_fields(data, lambda x: x[:, 0], lambda x: x[:, 1] + x[:, 2])


def plot_of(data, bins=(20, 30)):
    plot = vtkChiContinuousScatterplot()
    plot.SetInputData(data)
    plot.SetInputArrayToProcess(0, 0, 0, POINTS, "u")
    plot.SetInputArrayToProcess(1, 0, 0, POINTS, "v")
    plot.SetDimensions(*bins)
    return plot


def updated(plot):
    """Densities [second][first] after an update without errors."""
    messages = heard(plot)
    if messages:
        raise AssertionError(messages)
    image = plot.GetOutputDataObject(0)
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[1::-1])


def heard(plot):
    """Update, and the messages of errors and warnings."""
    messages = []

    def keep(_, event, text):
        messages.append(text)

    keep.CallDataType = "string0"
    tags = [plot.AddObserver("ErrorEvent", keep), plot.AddObserver("WarningEvent", keep)]
    executive = plot.GetExecutive()
    tag = executive.AddObserver("ErrorEvent", lambda *_: None)
    plot.Modified()
    plot.Update()
    executive.RemoveObserver(tag)
    for each in tags:
        plot.RemoveObserver(each)
    return "\n".join(messages)


def triangle_mass(bins):
    """Of y + z over [0, 2], both even on [0, 1]."""
    t = np.linspace(0, 2, bins + 1)
    return np.diff(np.where(t <= 1, t * t / 2, 1 - (2 - t) ** 2 / 2))


class ClosedForms(unittest.TestCase):
    def test_a_box_spline_in_one_direction(self):
        density = updated(plot_of(cube()))
        exact = triangle_mass(30) / (2 / 30)
        # the stated bound of a bin
        np.testing.assert_allclose(density, np.repeat(exact[:, None], 20, 1), atol=1e-10)

    def test_the_image_lies_over_the_values(self):
        plot = plot_of(cube())
        updated(plot)
        image = plot.GetOutputDataObject(0)
        np.testing.assert_allclose(image.GetOrigin()[:2], (0.5 / 20, 1 / 30), rtol=1e-14)
        np.testing.assert_allclose(image.GetSpacing()[:2], (1 / 20, 2 / 30), rtol=1e-14)
        self.assertEqual(image.GetPointData().GetScalars().GetName(), "Density")
        self.assertAlmostEqual(plot.GetTotalMass(), 1, 13)
        self.assertEqual(plot.GetMassOutOfRange(), 0)
        self.assertEqual(plot.GetSingularMass(), 0)
        self.assertEqual(plot.GetNumberOfSimplices(), 6 * 6 ** 3)

    def test_one_array_twice_is_a_diagonal(self):
        plot = plot_of(cube(), (10, 10))
        plot.SetInputArrayToProcess(1, 0, 0, POINTS, "u")
        density = updated(plot)
        np.testing.assert_allclose(density, np.eye(10) * 10, atol=1e-9)
        self.assertAlmostEqual(plot.GetSingularMass(), 1, 12)

    def test_a_window_counts_what_is_beyond(self):
        plot = plot_of(cube(), (7, 5))
        plot.AutomaticRangeOff()
        plot.SetRange(0, 0.25, 0.5)
        plot.SetRange(1, 0, 1)
        density = updated(plot)
        self.assertAlmostEqual(density.sum() * (0.25 / 7) * (1 / 5), 0.25 * 0.5, 12)
        self.assertAlmostEqual(plot.GetMassOutOfRange(), 1 - 0.125, 12)


class DataSets(unittest.TestCase):
    def check(self, data):
        density = updated(plot_of(data))
        exact = triangle_mass(30) / (2 / 30)
        np.testing.assert_allclose(density, np.repeat(exact[:, None], 20, 1), atol=1e-10)

    def test_images_with_an_extent(self):
        data = vtkImageData()
        data.SetExtent(3, 13, -4, 6, 1, 11)
        data.SetSpacing(0.1, 0.1, 0.1)
        data.SetOrigin(-0.3, 0.4, -0.1)
        self.check(with_fields(data, lambda x: x[:, 0], lambda x: x[:, 1] + x[:, 2]))

    def test_rectilinear_and_curvilinear_grids(self):
        axis = np.linspace(0, 1, 7) ** 2
        grid = vtkRectilinearGrid()
        grid.SetDimensions(7, 7, 7)
        grid.SetXCoordinates(named(axis, "x"))
        grid.SetYCoordinates(named(axis, "y"))
        grid.SetZCoordinates(named(axis.astype(np.float64), "z"))
        self.check(with_fields(grid, lambda x: x[:, 0], lambda x: x[:, 1] + x[:, 2]))
        curved = vtkStructuredGrid()
        curved.SetDimensions(7, 7, 7)
        points = vtkPoints()
        points.SetData(named(places(grid), "points"))
        curved.SetPoints(points)
        self.check(with_fields(curved, lambda x: x[:, 0], lambda x: x[:, 1] + x[:, 2]))

    def test_unstructured_grids_of_voxels_and_of_tetrahedra(self):
        append = vtkAppendFilter()
        append.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
        append.AddInputData(cube())
        append.Update()
        self.check(append.GetOutput())
        split = vtkDataSetTriangleFilter()
        split.SetInputData(append.GetOutput())
        split.Update()
        self.check(split.GetOutput())

    def test_polygons_are_measured_by_area(self):
        plane = vtkPlaneSource()
        plane.SetResolution(5, 4)
        plane.Update()
        data = with_fields(plane.GetOutput(), lambda x: x[:, 0] + 0.5, lambda x: x[:, 1] + 0.5)
        plot = plot_of(data, (8, 8))
        np.testing.assert_allclose(updated(plot), 1, atol=1e-6)  # its points are float
        self.assertAlmostEqual(plot.GetTotalMass(), 1, 6)

    def test_an_empty_data_set_is_no_error(self):
        plot = plot_of(vtkUnstructuredGrid())
        self.assertEqual(heard(plot), "")
        self.assertEqual(plot.GetTotalMass(), 0)


class Options(unittest.TestCase):
    def test_fields_of_cells_are_constant_in_each(self):
        data = cube(4)
        data.GetCellData().AddArray(named(np.arange(64) % 4 * 1.0, "a"))
        data.GetCellData().AddArray(named(np.arange(64) // 16 * 1.0, "b"))
        plot = plot_of(data, (4, 4))
        plot.SetInputArrayToProcess(0, 0, 0, CELLS, "a")
        plot.SetInputArrayToProcess(1, 0, 0, CELLS, "b")
        np.testing.assert_allclose(updated(plot), 1 / 16 / (0.75 * 0.75), rtol=1e-13)

    def test_weights_of_cells_are_exact(self):
        data = cube(4)
        data.GetCellData().AddArray(named(np.full(64, 2.5), "w"))
        plot = plot_of(data)
        plain = updated(plot).copy()
        plot.SetInputArrayToProcess(2, 0, 0, CELLS, "w")
        np.testing.assert_allclose(updated(plot), 2.5 * plain, atol=1e-10)
        self.assertAlmostEqual(plot.GetTotalMass(), 2.5, 13)

    def test_components_and_magnitude(self):
        data = cube(4)
        x = places(data)
        data.GetPointData().AddArray(named(np.stack([0 * x[:, 0], x[:, 0], 0 * x[:, 0]], 1), "vector"))
        expected = updated(plot_of(data)).copy()
        for component in (1, -1):
            plot = plot_of(data)
            plot.SetInputArrayToProcess(0, 0, 0, POINTS, "vector")
            plot.SetComponent(0, component)
            np.testing.assert_allclose(updated(plot), expected, atol=1e-12)

    def test_a_matrix_has_a_plot_a_pair(self):
        data = cube(4)
        data.GetPointData().AddArray(named(places(data)[:, 2] ** 2, "w"))
        names = vtkStringArray()
        for name in ("u", "v", "w"):
            names.InsertNextValue(name)
        plot = plot_of(data)
        pair = updated(plot).copy()
        plot.SetMatrixArrays(names)
        self.assertEqual(heard(plot), "")
        blocks = plot.GetOutputDataObject(0)
        self.assertIsInstance(blocks, vtkMultiBlockDataSet)
        self.assertEqual(blocks.GetNumberOfBlocks(), 3)
        self.assertEqual(plot.GetOutputDataObject(1).GetNumberOfBlocks(), 3)
        first = vtk_to_numpy(blocks.GetBlock(0).GetPointData().GetScalars()).reshape(pair.shape)
        np.testing.assert_array_equal(first, pair)
        plot.RemoveAllMatrixArrays()
        np.testing.assert_array_equal(updated(plot), pair)

    def test_colours_follow_the_scale(self):
        plot = plot_of(cube(), (10, 10))
        density = updated(plot)
        for logarithmic in (True, False):
            plot.SetLogarithmicDisplay(logarithmic)
            updated(plot)
            rgba = vtk_to_numpy(plot.GetOutputDataObject(1).GetPointData().GetScalars()).reshape(10, 10, 4)
            self.assertTrue((rgba[..., 3] == 255).all())
            brightness = rgba[..., :3].astype(int).sum(2)
            order = np.argsort(density, axis=None)
            self.assertTrue((np.diff(brightness.ravel()[order]) >= 0).all())
            self.assertEqual(brightness.max(), 3 * 255)

    def test_the_published_method_is_near(self):
        plot = plot_of(with_fields(cube(4), lambda x: x[:, 0], lambda x: x[:, 1] ** 2 + x[:, 0] * x[:, 2]), (64, 64))
        exact = updated(plot).copy()
        plot.SetMethodToPublished()
        published = updated(plot)
        # point samples of a piecewise linear function: they differ where it bends
        self.assertLess(np.abs(published - exact).sum() / exact.sum(), 0.02)
        self.assertGreater(np.abs(published - exact).max(), 1e-6)

    def test_trilinear_cells_approach_their_interpolant(self):
        # x y in the unit cube is below u in u - u log u of it, z below v in v
        data = vtkImageData()
        data.SetDimensions(2, 2, 2)
        with_fields(data, lambda x: x[:, 0] * x[:, 1], lambda x: x[:, 2])
        plot = plot_of(data, (64, 4))
        u = np.linspace(0, 1, 65)[1:]
        below = u - u * np.log(u)
        last = np.inf
        for levels, tolerance in enumerate((0.3, 0.0625, 0.015, 0.0039)):
            plot.SetTrilinearTolerance(tolerance)
            density = updated(plot)
            moved = np.abs(np.cumsum(density.mean(axis=0)) / 64 - below).mean()
            self.assertLess(moved, min(tolerance, last / 2))
            self.assertEqual(plot.GetNumberOfSubdividedCells(), 1 if levels else 0)
            self.assertEqual(plot.GetNumberOfCappedCells(), 0)
            self.assertAlmostEqual(density.sum() / 256, 1, 12)
            last = moved
        plot.SetTrilinearLevels(1)
        updated(plot)
        self.assertEqual(plot.GetNumberOfSimplices(), 48)
        self.assertEqual(plot.GetNumberOfCappedCells(), 1)
        voxels = vtkAppendFilter()
        voxels.SetInputData(data)
        voxels.Update()
        same = plot_of(voxels.GetOutput(), (64, 4))
        same.SetTrilinearTolerance(0.01)
        plot.SetTrilinearLevels(4)
        plot.SetTrilinearTolerance(0.01)
        np.testing.assert_allclose(updated(same), updated(plot), atol=1e-10)

    def test_splats_stay_within_their_bound(self):
        plot = plot_of(cube(30), (7, 9))
        exact = updated(plot).copy()
        self.assertEqual((plot.GetNumberOfSplats(), plot.GetSplatErrorBound()), (0, 0))
        plot.SetSplatSize(0.7)
        error = np.abs(updated(plot) - exact).sum() * (1 / 7) * (2 / 9)
        self.assertGreater(plot.GetNumberOfSplats(), 0)
        self.assertGreater(error, 0)
        self.assertLess(error, plot.GetSplatErrorBound())

    def test_unchanged_input_keeps_its_ranges(self):
        plot = plot_of(cube())
        updated(plot)
        self.assertEqual(plot.GetNumberOfSkipped(plot.SKIP_UNCHANGED), 0)
        plot.SetDimensions(11, 12)
        kept = updated(plot).copy()
        self.assertEqual(plot.GetNumberOfSkipped(plot.SKIP_UNCHANGED), 1)
        plot.SetSkippingMask(plot.SKIP_EVERY_KIND & ~plot.SKIP_UNCHANGED)
        np.testing.assert_array_equal(updated(plot), kept)
        self.assertEqual(plot.GetNumberOfSkipped(plot.SKIP_UNCHANGED), 0)
        plot.SetSkippingMask(0)
        np.testing.assert_allclose(updated(plot), kept, atol=1e-10 * kept.max())

    @unittest.skipIf(vtkContinuousScatterplot is None, "this VTK has none")
    def test_vtks_own_class_fills_the_same_bins(self):
        data = cube(2)
        data.GetPointData().Initialize()
        data = with_fields(data, lambda x: x[:, 0], lambda x: x[:, 0] * x[:, 1])
        split = vtkDataSetTriangleFilter()
        split.SetInputData(data)
        split.Update()
        n = 12
        peer = vtkContinuousScatterplot()
        peer.SetInputData(split.GetOutput())
        peer.SetField1("u", n)
        peer.SetField2("v", n)
        peer.Update()
        theirs = vtk_to_numpy(peer.GetOutput().GetPointData().GetScalars()).reshape(n, n)
        ours = updated(plot_of(split.GetOutput(), (n, n)))
        # Its values, scaled to 255, are not volumes: where the density is 1 everywhere they go from 20
        # to 255, and the last bins are empty. What can be compared is where there is something.
        self.assertTrue((theirs[:-1, :-1][ours[:-1, :-1] > 0] > 0).all())
        empty = np.ones((n + 2, n + 2), bool)  # and so are all neighbours
        padded = np.pad(ours > 0, 1)
        for i in range(3):
            for j in range(3):
                empty[1:-1, 1:-1] &= ~padded[i:i + n, j:j + n]
        self.assertTrue(empty[1:-1, 1:-1].sum() > n)
        self.assertTrue((theirs[empty[1:-1, 1:-1]] == 0).all())


class Nonsense(unittest.TestCase):
    def test_it_is_named(self):
        data = cube(3)
        data.GetCellData().AddArray(named(np.zeros(27), "cells"))
        cases = [
            (lambda p: p.SetDimensions(0, 5), "Dimensions are 0 x 5"),
            (lambda p: p.SetDimensions(40000, 5), "Dimensions are 40000"),
            (lambda p: (p.AutomaticRangeOff(), p.SetRange(1, 3, 2)), "range of array 1 is [3, 2]"),
            (lambda p: (p.AutomaticRangeOff(), p.SetRange(0, float("nan"), 2)), "range of array 0"),
            (lambda p: p.SetInputArrayToProcess(0, 0, 0, POINTS, "missing"), "no first array"),
            (lambda p: p.SetInputArrayToProcess(2, 0, 0, POINTS, "missing"), "no weight"),
            (lambda p: p.SetInputArrayToProcess(1, 0, 0, CELLS, "cells"), "vtkCellDataToPointData"),
            (lambda p: p.SetTrilinearTolerance(1) or p.SetTrilinearTolerance(-1) or
             self.assertEqual(p.GetTrilinearTolerance(), 1) or p.SetDimensions(0, 1), "Dimensions"),
            (lambda p: p.SetComponent(0, 2), "has no component 2"),
            (lambda p: p.AddMatrixArray("missing"), "no array 'missing'"),
        ]
        for change, words in cases:
            plot = plot_of(data)
            change(plot)
            self.assertIn(words, heard(plot))
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, data)
        plot = plot_of(data)
        plot.SetInputDataObject(0, blocks)
        self.assertIn("vtkMergeBlocks", heard(plot))

    def test_values_that_are_no_numbers_are_counted(self):
        data = cube(6)
        values = vtk_to_numpy(data.GetPointData().GetArray("u"))
        values[3 + 7 * 3 + 49 * 3] = np.nan
        plot = plot_of(data)
        self.assertIn("8 cells", heard(plot))
        self.assertEqual(plot.GetNumberOfSkippedCells(), 8)
        self.assertAlmostEqual(plot.GetTotalMass(), 1 - 8 / 216, 12)

    def test_a_constant_gets_a_window_and_one_message(self):
        data = with_fields(cube(3), lambda x: x[:, 0], lambda x: 0 * x[:, 0] + 5)
        plot = plot_of(data, (4, 4))
        self.assertEqual(heard(plot).count("constant"), 1)
        self.assertAlmostEqual(plot.GetOutputDataObject(0).GetSpacing()[1], 5e-6 / 4, 12)
        self.assertEqual(plot.GetMassOutOfRange(), 0)

    def test_hidden_cells_are_left_out(self):
        data = cube(3)
        ghosts = np.zeros(27, np.uint8)
        ghosts[:3] = (vtkDataSetAttributes.DUPLICATECELL, vtkDataSetAttributes.HIDDENCELL, 0)
        data.GetCellData().AddArray(named(ghosts, vtkDataSetAttributes.GhostArrayName()))
        plot = plot_of(data)
        updated(plot)
        self.assertEqual(plot.GetNumberOfHiddenCells(), 2)
        self.assertAlmostEqual(plot.GetTotalMass(), 25 / 27, 13)


if __name__ == "__main__":
    unittest.main()
