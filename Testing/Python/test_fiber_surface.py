# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiFiberSurface as a Python user meets it: any data set, all data carried, nonsense named."""
import math
import unittest

import numpy as np
from algorithm_messages import Messages
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (VTK_TETRA, vtkCellArray, vtkDataObject, vtkDataSetAttributes, vtkImageData,
                                           vtkMultiBlockDataSet, vtkPolyData, vtkRectilinearGrid, vtkTable,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkThreshold
from vtkmodules.vtkFiltersGeneral import vtkDataSetTriangleFilter

from chiaroscuro import vtkChiContinuousScatterplot, vtkChiFiberSurface

try:
    from vtkmodules.vtkFiltersTopology import vtkFiberSurface
except ImportError:
    vtkFiberSurface = None

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


def image(n, low=-1.0, high=1.0):
    data = vtkImageData()
    data.SetDimensions(n + 1, n + 1, n + 1)
    data.SetOrigin(low, low, low)
    data.SetSpacing(*[(high - low) / n] * 3)
    return data


def ring(n=16):
    """Distance from the axis, and height: a circle is a torus."""
    return with_fields(image(n), lambda x: np.hypot(x[:, 0], x[:, 1]), lambda x: x[:, 2])


def circle(u=0.55, v=0.05, radius=0.3, count=24):
    angles = 2 * math.pi * np.arange(count) / count
    return np.stack([u + radius * np.cos(angles), v + radius * np.sin(angles)], 1)


def polygon(*lines, closed=False):
    """Lines or, closed, polygons."""
    data, points, cells, first = vtkPolyData(), vtkPoints(), vtkCellArray(), 0
    points.SetDataTypeToDouble()
    for line in lines:
        for x, y in line:
            points.InsertNextPoint(x, y, 17.0)  # a height is of no meaning
        cells.InsertNextCell(len(line), list(range(first, first + len(line))))
        first += len(line)
    data.SetPoints(points)
    (data.SetPolys if closed else data.SetLines)(cells)
    return data


def area(surface):
    x = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    t = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return 0.5 * np.linalg.norm(np.cross(x[t[:, 1]] - x[t[:, 0]], x[t[:, 2]] - x[t[:, 0]]), axis=1)


def open_edges(surface):
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


class FiberSurface(unittest.TestCase):
    def filter(self, data, shape, **settings):
        fiber = vtkChiFiberSurface()
        self.messages = Messages(fiber)
        fiber.SetInputData(data)
        fiber.SetPolygonData(shape)
        for i, name in enumerate(settings.pop("arrays", ())):
            fiber.SetInputArrayToProcess(i, 0, 0, POINTS, name)
        for name, value in settings.items():
            getattr(fiber, "Set" + name)(value)
        fiber.Update()
        return fiber

    def surface(self, data, shape, **settings):
        fiber = self.filter(data, shape, **settings)
        self.assertEqual(self.messages.errors + self.messages.warnings, [])
        return fiber.GetOutput()

    def test_circle_is_closed_torus(self):
        surface = self.surface(ring(32), polygon(circle(count=48), closed=True), arrays="uv")
        self.assertEqual(open_edges(surface), 0)
        self.assertLess(abs(area(surface).sum() / (4 * math.pi**2 * 0.55 * 0.3) - 1), 0.01)  # h^2 = 1/256, chords
        mass = vtkMassProperties()
        mass.SetInputData(surface)
        self.assertLess(abs(mass.GetVolume() / (2 * math.pi**2 * 0.55 * 0.09) - 1), 0.02)
        x = places(surface)
        r = np.hypot(x[:, 0], x[:, 1])
        out = np.stack([x[:, 0] / r * (r - 0.55), x[:, 1] / r * (r - 0.55), x[:, 2] - 0.05], 1)
        out /= np.linalg.norm(out, axis=1)[:, None]
        turned = np.sum(out * vtk_to_numpy(surface.GetPointData().GetNormals()), axis=1)
        self.assertGreater(turned.mean(), 0.995)
        self.assertGreater(turned.min(), 0.8)

    def test_lines_polygons_and_tables_agree(self):
        data, corners = ring(), circle()
        table = vtkTable()
        table.AddColumn(named(corners[:, 0], "a"))
        table.AddColumn(named(corners[:, 1], "b"))
        shapes = [polygon(corners, closed=True), polygon(np.vstack([corners, corners[:1]])), table]
        areas = [area(self.surface(data, shape)).sum() for shape in shapes]
        areas.append(area(self.surface(data, polygon(corners), CloseLines=True)).sum())
        edges = polygon(*[corners[[i, (i + 1) % 24]] for i in range(24)])
        self.assertEqual(open_edges(self.surface(data, edges)), 0)
        areas.append(area(self.surface(data, edges)).sum())
        masks = [vtk_to_numpy(self.filter(data, shape, GenerateMask=True).GetOutputDataObject(1).GetCellData().GetArray(
            "FiberMask")) for shape in (edges, shapes[0])]
        self.assertTrue(np.array_equal(*masks))
        two = self.surface(data, polygon(*[c[[i, (i + 1) % 24]] for c in (corners, circle(radius=0.2)[::-1])
                                           for i in range(24)]))
        self.assertEqual(set(vtk_to_numpy(two.GetCellData().GetArray("SegmentId"))), set(range(48)))
        self.assertEqual(len(set(areas)), 1)
        self.assertLess(area(self.surface(data, polygon(corners))).sum(), areas[0])

    def test_all_data_are_carried(self):
        data = ring()
        x = places(data)
        names, count = vtkStringArray(), len(x)
        names.SetName("names")
        for i in range(count):
            names.InsertNextValue(f"p{i}")
        data.GetPointData().AddArray(names)
        data.GetPointData().AddArray(named(x, "place"))
        data.GetPointData().AddArray(named(np.arange(count, dtype=np.int32), "id"))
        data.GetPointData().SetActiveVectors("place")
        cells = data.GetNumberOfCells()
        data.GetCellData().AddArray(named(np.arange(cells, dtype=np.int16), "cell"))
        data.GetFieldData().AddArray(named(np.ones(3), "note"))
        surface = self.surface(data, polygon(circle(), closed=True), arrays="uv")
        point_data, cell_data = surface.GetPointData(), surface.GetCellData()
        at = vtk_to_numpy(point_data.GetArray("place"))
        self.assertLess(np.abs(at - places(surface)).max(), 1e-6)  # float points
        self.assertIs(point_data.GetVectors(), point_data.GetArray("place"))
        ids = vtk_to_numpy(point_data.GetArray("id"))
        self.assertEqual([point_data.GetAbstractArray("names").GetValue(i) for i in range(50)],
                         [f"p{i}" for i in ids[:50]])
        self.assertLess(np.abs(x[ids] - at).max(), 0.125 + 1e-6)
        # values lie on the polygon
        u, v = (vtk_to_numpy(point_data.GetArray(n)) for n in "uv")
        d = np.hypot(u - 0.55, v - 0.05)
        self.assertLess(d.max(), 0.3 + 1e-12)
        self.assertGreater(d.min(), 0.3 * math.cos(math.pi / 24) - 1e-12)
        # segments: where the middle of a triangle lies
        triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        angle = np.arctan2(v[triangles].mean(axis=1) - 0.05, u[triangles].mean(axis=1) - 0.55) % (2 * math.pi)
        segment = vtk_to_numpy(cell_data.GetArray("SegmentId"))
        wrong = segment != np.floor(angle / (2 * math.pi) * 24)
        self.assertLess(area(surface)[wrong].sum(), 1e-6 * area(surface).sum())  # slivers at corners round
        t = vtk_to_numpy(point_data.GetArray("SegmentParameter"))
        self.assertTrue(0 <= t.min() and t.max() <= 1)
        # cells: the triangle's middle lies in the cell
        middle = places(surface)[triangles].mean(axis=1)
        index = np.floor((middle + 1) / 0.125 - 1e-9).astype(int)
        inside = index[:, 0] + 16 * (index[:, 1] + 16 * index[:, 2])
        cell = vtk_to_numpy(cell_data.GetArray("cell"))
        self.assertGreater(np.mean(cell == inside), 0.98)  # the rest lie on faces
        self.assertEqual(surface.GetFieldData().GetNumberOfArrays(), 1)

    def test_data_sets_of_every_class_agree(self):
        data = ring(10)
        flat = vtkRectilinearGrid()
        flat.SetDimensions(11, 11, 11)
        axis = named(np.linspace(-1, 1, 11), "axis")
        flat.SetXCoordinates(axis)
        flat.SetYCoordinates(axis)
        flat.SetZCoordinates(axis)
        flat.GetPointData().ShallowCopy(data.GetPointData())
        shape = polygon(circle(), closed=True)
        first, second = (area(self.surface(d, shape)).sum() for d in (data, flat))
        self.assertLess(abs(first / second - 1), 1e-6)
        split = vtkDataSetTriangleFilter()
        split.SetInputData(data)
        split.Update()
        third = area(self.surface(split.GetOutput(), shape)).sum()  # five tetrahedra a cube: another field
        self.assertLess(abs(first / third - 1), 0.03)
        self.assertEqual(open_edges(self.surface(split.GetOutput(), shape)), 0)

    def test_corners_may_be_split(self):
        data, shape = ring(), polygon(circle(count=4), closed=True)
        joined = self.surface(data, shape)
        split = self.surface(data, shape, SplitCorners=True)
        self.assertGreater(split.GetNumberOfPoints(), joined.GetNumberOfPoints())
        self.assertEqual(split.GetNumberOfCells(), joined.GetNumberOfCells())
        self.assertAlmostEqual(area(split).sum(), area(joined).sum(), places=5)
        plain = self.surface(data, shape, ComputeNormals=False)
        self.assertIsNone(plain.GetPointData().GetNormals())

    def test_components(self):
        blobs = with_fields(image(20), lambda x: np.cos(6 * x[:, 0]) + np.cos(6 * x[:, 1]) + np.cos(6 * x[:, 2]),
                            lambda x: x[:, 0])
        shape = polygon([(1.2, -9), (9, -9), (9, 9), (1.2, 9)], closed=True)
        fiber = self.filter(blobs, shape, ExtractComponents=True)
        surface = fiber.GetOutput()
        ids = vtk_to_numpy(surface.GetCellData().GetArray("ComponentId"))
        areas = np.bincount(ids, area(surface))
        self.assertEqual(len(areas), fiber.GetNumberOfComponents())
        self.assertEqual(len(areas), 27)  # tops at -pi/3, 0, pi/3, of which those at the walls are cut
        few = self.filter(blobs, shape, ExtractComponents=True, MinimumArea=float(areas.max() * 0.999))
        self.assertEqual(few.GetNumberOfComponents() + few.GetNumberOfSmallComponents(), 27)
        self.assertLess(few.GetNumberOfComponents(), 27)
        self.assertGreater(few.GetNumberOfComponents(), 0)

    def test_mask_selects_cells(self):
        data = ring()
        fiber = self.filter(data, polygon(circle(), closed=True), GenerateMask=True)
        masked = fiber.GetOutputDataObject(1)
        self.assertTrue(masked.IsA("vtkImageData"))
        mask = vtk_to_numpy(masked.GetCellData().GetArray("FiberMask"))
        volume = mask.sum() * 0.125**3
        self.assertGreater(volume, 2 * math.pi**2 * 0.55 * 0.09)
        self.assertLess(volume, 2 * math.pi**2 * 0.55 * (0.3 + 0.125 * 1.8)**2)
        threshold = vtkThreshold()
        threshold.SetInputConnection(fiber.GetOutputPort(1))
        threshold.SetInputArrayToProcess(0, 0, 0, CELLS, "FiberMask")
        threshold.SetLowerThreshold(1)
        threshold.SetUpperThreshold(1)
        threshold.Update()
        self.assertEqual(threshold.GetOutput().GetNumberOfCells(), mask.sum())
        self.assertEqual(self.filter(data, polygon(circle())).GetOutputDataObject(1).GetNumberOfCells(), 0)

    def volumes(self, grid):
        x = places(grid)
        t = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        e = [x[t[:, k]] - x[t[:, 0]] for k in (1, 2, 3)]
        return np.einsum("ij,ij->i", np.cross(e[0], e[1]), e[2]) / 6

    def test_enclosed_cells_are_a_torus(self):
        data = ring()
        data.GetCellData().AddArray(named(np.arange(data.GetNumberOfCells()), "id"))
        fiber = self.filter(data, polygon(circle(), closed=True), GenerateEnclosedCells=True, GenerateMask=True,
                            OutputPointsPrecision=1)
        self.assertEqual(self.messages.errors + self.messages.warnings, [])
        grid = fiber.GetOutputDataObject(2)
        self.assertTrue(grid.IsA("vtkUnstructuredGrid"))
        self.assertEqual(set(vtk_to_numpy(grid.GetCellTypesArray())), {VTK_TETRA})
        volumes = self.volumes(grid)
        self.assertGreater(volumes.min(), -1e-16)  # rounding of places below 1
        self.assertLess(abs(volumes.sum() / fiber.GetEnclosedVolume() - 1), 1e-12)
        self.assertLess(abs(volumes.sum() / (2 * math.pi**2 * 0.55 * 0.09) - 1), 0.05)
        mass = vtkMassProperties()
        mass.SetInputData(fiber.GetOutput())
        self.assertLess(abs(mass.GetVolume() / volumes.sum() - 1), 1e-12)
        # every face is shared or on the surface, by ids
        t = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        faces = np.sort(np.concatenate([t[:, k] for k in ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))]), axis=1)
        rim, uses = np.unique(faces, axis=0, return_counts=True)
        x = places(grid)[rim[uses == 1]]
        on_rim = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum()
        self.assertLess(abs(on_rim / area(fiber.GetOutput()).sum() - 1), 1e-12)
        self.assertEqual(uses.max(), 2)
        # data are carried, and the cells are those of the mask
        u, v = (vtk_to_numpy(grid.GetPointData().GetArray(name)) for name in "uv")
        self.assertLess(np.hypot(u - 0.55, v - 0.05).max(), 0.3 + 1e-15)
        self.assertLess(np.abs(v - places(grid)[:, 2]).max(), 1e-15)
        mask = vtk_to_numpy(fiber.GetOutputDataObject(1).GetCellData().GetArray("FiberMask"))
        ids = vtk_to_numpy(grid.GetCellData().GetArray("id"))
        self.assertTrue(np.array_equal(np.unique(ids), np.nonzero(mask)[0]))
        self.assertEqual(self.filter(data, polygon(circle())).GetOutputDataObject(2).GetNumberOfCells(), 0)

    def test_enclosed_volume_is_mass_of_scatterplot(self):
        data = with_fields(image(8), lambda x: np.sin(2 * x[:, 0] + x[:, 1]), lambda x: np.cos(x[:, 2] - 2 * x[:, 0]))
        plot = vtkChiContinuousScatterplot()
        plot.SetInputData(data)
        for i, name in enumerate("uv"):
            plot.SetInputArrayToProcess(i, 0, 0, POINTS, name)
            plot.SetRange(i, -1, 1)
        plot.SetAutomaticRange(False)
        plot.SetDimensions(16, 16)
        plot.Update()
        density = vtk_to_numpy(plot.GetOutput().GetPointData().GetArray("Density")).reshape(16, 16)
        mass = density[6:13, 3:9].sum() * 0.125**2
        low, high = np.array([3, 6]) / 8 - 1, np.array([9, 13]) / 8 - 1
        corners = [low, (high[0], low[1]), high, (low[0], high[1])]
        fiber = self.filter(data, polygon(corners, closed=True), GenerateEnclosedCells=True)
        self.assertGreater(mass, 0.5)
        self.assertLess(abs(fiber.GetEnclosedVolume() - mass), 1e-9)  # bins are whole numbers of a quantum of the mass
        self.assertEqual(fiber.GetOutputDataObject(2).GetPoints().GetDataType(), 10)  # VTK_FLOAT, as images have

    def test_enclosed_cells_of_any_data_set(self):
        data = ring(10)
        split = vtkDataSetTriangleFilter()
        split.SetInputData(data)
        split.Update()
        crossing = circle(count=5)[[0, 2, 4, 1, 3]]
        for shape in (polygon(circle(), closed=True), polygon(crossing, closed=True),
                      polygon(circle(), circle(radius=0.2), closed=True)):
            volumes = [self.filter(x, shape, GenerateEnclosedCells=True).GetEnclosedVolume()
                       for x in (data, split.GetOutput())]
            self.assertGreater(volumes[0], 0.1)
            self.assertLess(abs(volumes[0] / volumes[1] - 1), 0.05)  # another split
        none = self.filter(data, polygon(circle(u=9), closed=True), GenerateEnclosedCells=True)
        self.assertEqual((none.GetEnclosedVolume(), none.GetOutputDataObject(2).GetNumberOfCells()), (0, 0))
        all_of_it = self.filter(data, polygon(circle(radius=9), closed=True), GenerateEnclosedCells=True)
        self.assertLess(abs(all_of_it.GetEnclosedVolume() - 8), 1e-13)

    def test_open_polygons_enclose_nothing(self):
        self.refused(ring(), polygon(circle()), "23 of its segments", "CloseLines", GenerateEnclosedCells=True)
        fiber = self.filter(ring(), polygon(circle()), GenerateEnclosedCells=True, CloseLines=True)
        self.assertGreater(fiber.GetEnclosedVolume(), 0.9)

    def test_unchanged_inputs_are_kept(self):
        data, shape = ring(), polygon(circle(), closed=True)
        fiber = self.filter(data, shape)
        self.assertEqual(fiber.GetNumberOfSkipped(fiber.SKIP_UNCHANGED), 0)
        self.assertGreater(fiber.GetNumberOfSkipped(fiber.SKIP_BRICKS), -1)
        fiber.SetPolygonData(polygon(circle(radius=0.25), closed=True))
        fiber.Update()
        self.assertEqual(fiber.GetNumberOfSkipped(fiber.SKIP_UNCHANGED), 1)
        kept = area(fiber.GetOutput()).sum()
        self.assertEqual(area(self.surface(data, polygon(circle(radius=0.25), closed=True), SkippingMask=0)).sum(),
                         kept)
        u = vtk_to_numpy(data.GetPointData().GetArray("u"))
        u *= 0.9
        data.GetPointData().GetArray("u").Modified()
        fiber.Update()
        self.assertEqual(fiber.GetNumberOfSkipped(fiber.SKIP_UNCHANGED), 0)
        self.assertNotEqual(area(fiber.GetOutput()).sum(), kept)
        self.assertEqual(fiber.GetNumberOfSkipped(77), 0)

    def test_magnitude_and_components(self):
        data = image(12)
        x = places(data)
        data.GetPointData().AddArray(named(x[:, :2], "xy"))
        data.GetPointData().AddArray(named(x, "xyz"))
        fiber = vtkChiFiberSurface()
        fiber.SetInputData(data)
        fiber.SetPolygonData(polygon(circle(count=48), closed=True))
        fiber.SetInputArrayToProcess(0, 0, 0, POINTS, "xy")
        fiber.SetInputArrayToProcess(1, 0, 0, POINTS, "xyz")
        fiber.SetComponent(0, -1)
        fiber.SetComponent(1, 2)
        fiber.Update()
        self.assertEqual((fiber.GetComponent(0), fiber.GetComponent(1)), (-1, 2))
        direct = area(self.surface(ring(12), polygon(circle(count=48), closed=True))).sum()
        self.assertLess(abs(area(fiber.GetOutput()).sum() / direct - 1), 1e-6)  # roots round, points are float

    def refused(self, data, shape, *words, **settings):
        fiber = self.filter(data, shape, **settings)
        self.assertEqual(len(self.messages.errors), 2, self.messages.errors)  # ours, and the pipeline's
        for word in words:
            self.assertIn(word, self.messages.errors[0])
        self.assertEqual(fiber.GetOutput().GetNumberOfCells(), 0)

    def warned(self, data, shape, *words, **settings):
        fiber = self.filter(data, shape, **settings)
        self.assertEqual(self.messages.errors, [])
        self.assertEqual(len(self.messages.warnings), 1, self.messages.warnings)
        for word in words:
            self.assertIn(word, self.messages.warnings[0])
        return fiber

    def test_nonsense_is_named(self):
        data, shape = ring(8), polygon(circle(), closed=True)
        self.refused(data, shape, "no second array", arrays=["u", "nothing"])
        self.refused(image(4), shape, "no first array")
        self.refused(data, polygon([(0, 0), (math.nan, 1)]), "NaN")
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, data)
        self.refused(blocks, shape, "vtkMultiBlockDataSet", "vtkMergeBlocks")
        table = vtkTable()
        table.AddColumn(named(np.arange(3.0), "alone"))
        self.refused(data, table, "two columns")
        fiber = vtkChiFiberSurface()
        messages = Messages(fiber)
        data.GetCellData().AddArray(named(np.zeros(512), "of cells"))
        fiber.SetInputData(data)
        fiber.SetPolygonData(shape)
        fiber.SetInputArrayToProcess(0, 0, 0, CELLS, "of cells")
        fiber.Update()
        self.assertIn("vtkCellDataToPointData", messages.errors[0])
        messages.errors.clear()
        fiber.SetComponent(2, 0)
        fiber.SetComponent(0, -2)
        self.assertEqual(len(messages.errors), 2)
        fiber = vtkChiFiberSurface()
        messages = Messages(fiber)
        fiber.SetInputData(ring(4))
        fiber.SetPolygonData(shape)
        fiber.SetComponent(1, 1)
        fiber.Update()
        self.assertIn("no component 1", messages.errors[0])

    def test_useless_polygons_are_named(self):
        data = ring(8)
        self.warned(data, polygon([(5, 5), (6, 5), (6, 6)], closed=True), "range over", "empty")
        self.warned(data, polygon([(0.5, 0), (0.5, 0)]), "no segment")
        self.warned(data, polygon(), "no segment")
        fiber = self.warned(data, polygon([(0.2, 0), (0.5, 0), (0.5, 0), (0.5, 0.3)]), "1 segments", "no length")
        self.assertEqual(fiber.GetNumberOfSegments(), 2)
        self.assertEqual(set(vtk_to_numpy(fiber.GetOutput().GetCellData().GetArray("SegmentId"))), {0, 2})

    def test_values_that_are_not_finite(self):
        data = ring(8)
        vtk_to_numpy(data.GetPointData().GetArray("u"))[364] = math.nan  # the middle
        fiber = self.warned(data, polygon(circle(), closed=True), "8 cells", "not finite")
        self.assertEqual(fiber.GetNumberOfSkippedCells(), 8)
        self.assertTrue(np.all(np.isfinite(places(fiber.GetOutput()))))

    def test_hidden_cells(self):
        data = ring(8)
        ghosts = named(np.zeros(512, np.uint8), vtkDataSetAttributes.GhostArrayName())
        vtk_to_numpy(ghosts)[256:] = vtkDataSetAttributes.DUPLICATECELL
        data.GetCellData().AddArray(ghosts)
        surface = self.surface(data, polygon(circle(), closed=True))
        self.assertLess(places(surface)[:, 2].max(), 1e-6)
        self.assertIsNone(surface.GetCellData().GetArray(vtkDataSetAttributes.GhostArrayName()))

    def test_empty_input(self):
        fiber = self.filter(vtkUnstructuredGrid(), polygon(circle(), closed=True))
        self.assertEqual(fiber.GetOutput().GetNumberOfCells(), 0)
        self.assertEqual(self.messages.errors, [])

    @unittest.skipIf(vtkFiberSurface is None, "this VTK has no vtkFiberSurface (bench_fiber_vtk compares with the wheel's)")
    def test_same_area_as_vtk(self):
        split = vtkDataSetTriangleFilter()
        split.SetInputData(ring(10))
        split.Update()
        grid, shape = split.GetOutput(), polygon(np.vstack([circle(), circle()[:1]]))
        peer = vtkFiberSurface()
        peer.SetInputData(0, grid)
        peer.SetInputData(1, polygon(*[circle()[[i, (i + 1) % 24]] for i in range(24)]))
        peer.SetField1("u")
        peer.SetField2("v")
        peer.Update()
        ours = area(self.surface(grid, shape)).sum()
        self.assertLess(abs(area(peer.GetOutput()).sum() / ours - 1), 1e-5)


if __name__ == "__main__":
    unittest.main()
