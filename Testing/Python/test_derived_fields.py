# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiDerivedFields as a Python user meets it: any data set, known fields, VTK's filters, nonsense named."""
import math
import unittest

import numpy as np
from algorithm_messages import Messages
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, vtkDataObject, vtkImageData, vtkPolyData,
                                           vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid)
from vtkmodules.vtkCommonMath import vtkMatrix3x3
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkFiltersGeneral import vtkGradientFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource

from chiaroscuro import vtkChiDerivedFields

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
CELLS = vtkDataObject.FIELD_ASSOCIATION_CELLS
SUFFIXES = ("GradientMagnitude", "SecondDerivative", "Laplacian", "MeanCurvature")
N = 21
H = 0.05


def named(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def coordinates(data):
    return np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])


def with_distance(data, kind=np.float64):
    """The distance from (-1, -1.5, -2): |grad f| = 1, curvature 1 / f, Laplacian 2 / f."""
    x = coordinates(data) + np.array([1, 1.5, 2])
    data.GetPointData().SetScalars(named(np.sqrt((x**2).sum(1)).astype(kind), "r"))
    return data


def image(kind=np.float64, turned=False):
    data = vtkImageData()
    data.SetDimensions(N, N + 1, N - 2)
    data.SetSpacing(H, 0.9 * H, 1.1 * H)
    if turned:
        c, s = math.cos(0.5), math.sin(0.5)
        matrix = vtkMatrix3x3()
        for i, row in enumerate(((c, -s, 0), (s, c, 0), (0, 0, 1))):
            for j, value in enumerate(row):
                matrix.SetElement(i, j, value)
        data.SetDirectionMatrix(matrix)
    return with_distance(data, kind)


def rectilinear():
    data = vtkRectilinearGrid()
    data.SetDimensions(N, N, N)
    axis = named((np.arange(N) + 0.2 * np.sin(np.arange(N))) * H, "axis")
    data.SetXCoordinates(axis)
    data.SetYCoordinates(axis)
    data.SetZCoordinates(axis)
    return with_distance(data)


def curvilinear():
    source = image()
    x = coordinates(source)
    x += 0.03 * np.sin(2 * x[:, [1, 2, 0]])
    data = vtkStructuredGrid()
    data.SetDimensions(source.GetDimensions())
    points = vtkPoints()
    points.SetData(named(x, "points"))
    data.SetPoints(points)
    return with_distance(data)


def unstructured():
    append = vtkAppendFilter()
    append.SetInputData(curvilinear())
    append.Update()
    return with_distance(append.GetOutput())


class DerivedFields(unittest.TestCase):
    def derive(self, data, all_fields=True, **settings):
        filter_ = vtkChiDerivedFields()
        self.messages = Messages(filter_)
        if all_fields:
            filter_.ComputeSecondDerivativeOn()
            filter_.ComputeLaplacianOn()
            filter_.ComputeMeanCurvatureOn()
        for name, value in settings.items():
            getattr(filter_, "Set" + name)(*(value if isinstance(value, tuple) else (value,)))
        filter_.SetInputData(data)
        filter_.Update()
        return filter_

    def fields(self, filter_, name="r"):
        data = filter_.GetOutput().GetPointData()
        return [vtk_to_numpy(data.GetArray(f"{name}_{s}")) for s in SUFFIXES]

    def test_every_kind_of_data_set_has_the_derivatives_of_a_sphere(self):
        # h = 0.05, derivatives of the distance of third and fourth order up to 0.2: h^2 0.2 = 5e-4 in
        # the gradient, ten times that one-sided in second derivatives; of fits, first order: h 0.4
        for data, tolerance in ((image(), 5e-3), (image(turned=True), 5e-3), (rectilinear(), 5e-3),
                                (curvilinear(), 5e-3), (unstructured(), 2e-2)):
            with self.subTest(data.GetClassName()):
                derived = self.derive(data)
                self.assertFalse(self.messages.errors + self.messages.warnings)
                out = derived.GetOutput()
                self.assertEqual(out.GetClassName(), data.GetClassName())
                self.assertEqual(out.GetPointData().GetScalars().GetName(), "r")
                r = vtk_to_numpy(data.GetPointData().GetArray("r"))
                magnitude, second, laplacian, curvature = self.fields(derived)
                np.testing.assert_allclose(magnitude, 1, atol=1e-3)
                np.testing.assert_allclose(second, 0, atol=tolerance)
                np.testing.assert_allclose(laplacian, 2 / r, atol=2 * tolerance)
                np.testing.assert_allclose(curvature, 1 / r, atol=tolerance)
                self.assertEqual(derived.GetNumberOfFlatPoints(), 0)

    def test_order_four_is_more_exact(self):
        r = vtk_to_numpy(image().GetPointData().GetArray("r"))
        error = [np.abs(self.fields(self.derive(image(), Order=order))[3] - 1 / r).max() for order in (2, 4)]
        self.assertLess(error[1], 0.05 * error[0])  # h^2 = 0.0025 times ratios of derivatives below 20

    def test_the_gradient_is_vtks_inside_an_image(self):
        # vtkGradientFilter does not turn gradients by the direction matrix; their length is the same
        for turned in (False, True):
            data = image(turned=turned)
            peer = vtkGradientFilter()
            peer.SetInputData(data)
            peer.SetInputScalars(POINTS, "r")
            peer.SetResultArrayName("g")
            peer.Update()
            theirs = np.linalg.norm(vtk_to_numpy(peer.GetOutput().GetPointData().GetArray("g")), axis=1)
            ours = self.fields(self.derive(data))[0]
            shape = data.GetDimensions()[::-1]
            inside = (slice(1, -1), ) * 3
            np.testing.assert_allclose(ours.reshape(shape)[inside], theirs.reshape(shape)[inside], atol=1e-12)

    def test_types_of_results_follow_the_array(self):
        for kind, expected in ((np.float32, np.float32), (np.uint8, np.float32), (np.int16, np.float32),
                               (np.float64, np.float64), (np.int32, np.float64), (np.int64, np.float64)):
            derived = self.derive(image(kind))
            self.assertEqual({f.dtype for f in self.fields(derived)}, {np.dtype(expected)})

    def test_components_and_magnitude(self):
        data = image()
        r = vtk_to_numpy(data.GetPointData().GetArray("r"))
        data.GetPointData().AddArray(named(np.stack([0 * r, -3 * r, 4 * r], 1), "v"))
        array = (0, 0, 0, POINTS, "v")
        for component, factor in ((0, 0), (1, 3), (2, 4), (-1, 5)):
            derived = self.derive(data, InputArrayToProcess=array, Component=component)
            np.testing.assert_allclose(self.fields(derived, "v")[0], factor, atol=5e-3)
            self.assertEqual(derived.GetNumberOfFlatPoints(), len(r) if factor == 0 else 0)

    def test_polygons_have_the_gradient_within_them(self):
        source = vtkPlaneSource()
        source.SetResolution(12, 15)
        source.SetNormal(1, 2, 3)
        source.Update()
        data = source.GetOutput()
        x = coordinates(data)
        data.GetPointData().SetScalars(named(x @ np.array([1.0, 2.0, 3.0]) + x[:, 0], "s"))
        derived = self.derive(data)
        n = np.array([1, 2, 3]) / math.sqrt(14)
        within = np.array([1, 0, 0]) - n[0] * n  # along the normal nothing is known
        # coordinates are float: eps / spacing
        np.testing.assert_allclose(self.fields(derived, "s")[0], np.linalg.norm(within), atol=1e-4)
        self.assertEqual(derived.GetOutput().GetClassName(), "vtkPolyData")

    def test_only_what_is_wanted_is_made(self):
        derived = self.derive(image(), all_fields=False, ComputeGradientMagnitude=False, ComputeLaplacian=True)
        data = derived.GetOutput().GetPointData()
        self.assertEqual([data.GetArrayName(i) for i in range(data.GetNumberOfArrays())], ["r", "r_Laplacian"])

    def test_what_has_not_changed_is_kept(self):
        data = image()
        derived = self.derive(data)
        first = self.fields(derived)[0]
        self.assertEqual((derived.GetNumberOfComputedFields(), derived.GetNumberOfKeptFields()), (4, 0))
        data.Modified()  # but neither mesh nor array
        derived.Update()
        self.assertEqual((derived.GetNumberOfComputedFields(), derived.GetNumberOfKeptFields()), (4, 4))
        derived.ComputeLaplacianOff()
        derived.Update()
        self.assertEqual((derived.GetNumberOfComputedFields(), derived.GetNumberOfKeptFields()), (4, 7))
        np.testing.assert_array_equal(self.fields_or_none(derived)[0], first)
        array = data.GetPointData().GetArray("r")
        array.SetValue(0, 5)
        array.Modified()
        data.Modified()
        derived.Update()
        self.assertEqual(derived.GetNumberOfComputedFields(), 7)
        data.SetSpacing(1, 1, 1)
        derived.Update()
        self.assertEqual(derived.GetNumberOfComputedFields(), 10)
        derived.SetOrder(4)
        derived.Update()
        self.assertEqual(derived.GetNumberOfComputedFields(), 13)
        vtk_to_numpy(derived.GetOutput().GetPointData().GetArray("r_GradientMagnitude"))[:] = 0
        derived.GetOutput().GetPointData().GetArray("r_GradientMagnitude").Modified()  # spoilt by others
        data.Modified()
        derived.Update()
        self.assertEqual(derived.GetNumberOfComputedFields(), 14)
        self.assertGreater(self.fields_or_none(derived)[0].max(), 0)

    def fields_or_none(self, filter_):
        data = filter_.GetOutput().GetPointData()
        return [vtk_to_numpy(a) if a else None for a in (data.GetArray(f"r_{s}") for s in SUFFIXES)]

    def test_samples_that_are_not_finite_are_counted(self):
        data = image()
        data.GetPointData().GetArray("r").SetValue(N * (N + 1) * 9 + N * 10 + 10, math.nan)
        derived = self.derive(data)
        self.assertEqual(derived.GetNumberOfNonFinitePoints(), 1 + 6 + 12)  # itself, axes, mixed derivatives
        self.assertEqual(int(np.isnan(self.fields(derived)[2]).sum()), 7)

    def refuse(self, text, data, **settings):
        self.derive(data, **settings)
        self.assertEqual(len(self.messages.errors) > 0, True)
        self.assertIn(text, " ".join(self.messages.errors))

    def test_bad_input_is_named(self):
        data = image()
        data.GetCellData().AddArray(named(np.zeros(data.GetNumberOfCells()), "c"))
        data.GetPointData().AddArray(named(np.zeros(5), "short"))
        self.refuse("vtkCellDataToPointData", data, InputArrayToProcess=(0, 0, 0, CELLS, "c"))
        self.refuse("vtkCellDataToPointData", data, InputArrayToProcess=(0, 0, 0, POINTS, "c"))
        self.refuse("'missing'", data, InputArrayToProcess=(0, 0, 0, POINTS, "missing"))
        self.refuse("does not belong to the points", data, InputArrayToProcess=(0, 0, 0, POINTS, "short"))
        self.refuse("component 1", data, Component=1)
        self.refuse("component -2", data, Component=-2)
        self.refuse("Order is 3", data, Order=3)
        flat = image()
        flat.SetSpacing(H, 0, H)
        self.refuse("along y", flat)
        axes = rectilinear()
        axes.SetZCoordinates(named(np.zeros(N), "z"))
        self.refuse("along z", axes)
        cloud = vtkPolyData()
        points = vtkPoints()
        points.InsertNextPoint(0, 0, 0)
        cloud.SetPoints(points)
        cloud.GetPointData().SetScalars(named(np.zeros(1), "s"))
        self.refuse("no cells", cloud)
        broken = vtkUnstructuredGrid()
        points = vtkPoints()
        for i in range(8):
            points.InsertNextPoint(i & 1, i >> 1 & 1, i >> 2)
        broken.SetPoints(points)
        broken.InsertNextCell(VTK_HEXAHEDRON, 8, [0, 1, 3, 2, 4, 5, 7, 99])
        broken.GetPointData().SetScalars(named(np.zeros(8), "s"))
        self.refuse("broken", broken)

    def test_nothing_is_no_error(self):
        self.derive(vtkPolyData())
        self.assertFalse(self.messages.errors)
        self.derive(image(), all_fields=False, ComputeGradientMagnitude=False)
        self.assertIn("no field is wanted", " ".join(self.messages.warnings))


if __name__ == "__main__":
    unittest.main()
