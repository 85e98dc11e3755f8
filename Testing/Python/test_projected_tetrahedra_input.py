# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: whatever comes in, as the same picture or as one clear message."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL, new_mapper
from occlusion_scene import Messages, Scene
from tetrahedra_scene import TetScene, cube, even, extinction, hexahedra_of, lattice, mesh, paths, tetrahedra_of
from vtkmodules.util import vtkConstants
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkConstants import (
    VTK_HEXAHEDRON,
    VTK_PYRAMID,
    VTK_QUADRATIC_TETRA,
    VTK_TETRA,
    VTK_VOXEL,
    VTK_WEDGE,
)
from vtkmodules.vtkCommonCore import vtkBitArray, vtkDataArray, vtkIdList, vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import (
    VTK_POLYHEDRON,
    vtkCellArray,
    vtkDataSetAttributes,
    vtkExplicitStructuredGrid,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPlane,
    vtkPolyData,
    vtkRectilinearGrid,
    vtkStructuredGrid,
    vtkUniformGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer
from vtkmodules.vtkCommonMath import vtkMatrix3x3

from chiaroscuro.vtkChiRendering import vtkChiProjectedTetrahedraMapper

N = 4
TAU = 2.0
FLOAT = 1e-4 # of a float picture of an even mesh: the bound
OBLIQUE = (-0.4, -0.5, -1.0)
COLORS = ((0.0, (0.1, 0.2, 1.0)), (0.5, (0.3, 1.0, 0.3)), (1.0, (1.0, 0.2, 0.1)))


def field(x, y, z):
    """Linear, so that every split of the cells draws the same."""
    return 0.5 + 0.5 * x - 0.3 * y + 0.15 * z


def colorful():
    return extinction(unit=0.2, colors=COLORS, ramp=((0.0, 0.1), (1.0, 1.0)))


def picture(data, prop=None, prepare=None):
    scene = TetScene(data, prop or colorful())
    scene.look(OBLIQUE, half=1.0, parallel=False)
    if prepare:
        prepare(scene)
    return scene.rgba(), scene


def values():
    return field(*lattice(N).T)


def scalars_of(data, numbers=None, name="density", cells=False):
    array = numpy_to_vtk(np.ascontiguousarray(values() if numbers is None else numbers), deep=True)
    array.SetName(name)
    (data.GetCellData() if cells else data.GetPointData()).SetScalars(array)
    return data


def as_image(kind=vtkImageData):
    data = kind()
    data.SetDimensions(N + 1, N + 1, N + 1)
    data.SetSpacing(1.0 / N, 1.0 / N, 1.0 / N)
    data.SetOrigin(-0.5, -0.5, -0.5)
    return scalars_of(data)


def as_turned_image():
    """The same block with x and y of the image along -y and x of the world, and an extent that begins at 3."""
    data = vtkImageData()
    data.SetExtent(3, 3 + N, 3, 3 + N, 3, 3 + N)
    data.SetSpacing(1.0 / N, 1.0 / N, 1.0 / N)
    turn = vtkMatrix3x3()
    turn.DeepCopy((0, 1, 0, -1, 0, 0, 0, 0, 1))
    data.SetDirectionMatrix(turn)
    place = np.array((0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0)).reshape(3, 3) @ np.full(3, 3.0 / N)
    corner = np.array((-0.5, 0.5, -0.5)) # where the first point comes to lie
    data.SetOrigin(corner - place)
    points = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    return scalars_of(data, field(*points.T))


def as_rectilinear():
    data = vtkRectilinearGrid()
    data.SetDimensions(N + 1, N + 1, N + 1)
    # steps of unequal width, of all kinds of numbers
    ticks = np.array((-0.5, -0.375, 0.0, 0.25, 0.5))
    data.SetXCoordinates(numpy_to_vtk(ticks, deep=True))
    data.SetYCoordinates(numpy_to_vtk(ticks.astype(np.float32), deep=True))
    data.SetZCoordinates(numpy_to_vtk(ticks, deep=True))
    points = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    return scalars_of(data, field(*points.T))


def points_of(dtype=np.float64):
    points = vtkPoints()
    points.SetData(numpy_to_vtk(lattice(N, dtype=dtype), deep=True))
    return points


def as_structured():
    data = vtkStructuredGrid()
    data.SetDimensions(N + 1, N + 1, N + 1)
    data.SetPoints(points_of(np.float32))
    return scalars_of(data)


def as_explicit():
    data = vtkExplicitStructuredGrid()
    data.SetDimensions(N + 1, N + 1, N + 1)
    data.SetPoints(points_of())
    cells = vtkCellArray()
    cells.DeepCopy(as_cells(VTK_HEXAHEDRON).GetCells())
    data.SetCells(cells)
    return scalars_of(data)


def split(kind):
    """Point ids of cells of one type over the lattice."""
    cubes = hexahedra_of(N)
    if kind == VTK_HEXAHEDRON:
        return cubes
    if kind == VTK_VOXEL:
        return cubes[:, (0, 1, 3, 2, 4, 5, 7, 6)]
    if kind == VTK_WEDGE: # two prisms over the triangles of the lower face
        return np.concatenate([cubes[:, (0, 2, 1, 4, 6, 5)], cubes[:, (0, 3, 2, 4, 7, 6)]])
    return tetrahedra_of(N)


def as_cells(kind):
    return mesh(lattice(N), split(kind), kind, scalars=values())


def as_pyramids():
    """Six pyramids a cube, about a point in its middle."""
    cubes = hexahedra_of(N)
    points = lattice(N)
    middle = points[cubes].mean(axis=1)
    apex = len(points) + np.arange(len(cubes))
    faces = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))
    cells = np.concatenate([np.column_stack([cubes[:, f], apex]) for f in faces])
    points = np.concatenate([points, middle])
    return mesh(points, cells, VTK_PYRAMID, scalars=field(*points.T))


def as_quadratic():
    """Tetrahedra with nodes in the middle of their edges."""
    tets = tetrahedra_of(N)
    points = lattice(N)
    pairs = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
    edges = np.sort(np.stack([tets[:, p] for p in pairs], axis=1), axis=2)
    unique, ids = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    cells = np.column_stack([tets, len(points) + ids.reshape(-1, 6)])
    points = np.concatenate([points, points[unique].mean(axis=1)])
    return mesh(points, cells, VTK_QUADRATIC_TETRA, scalars=field(*points.T))


def as_polyhedra():
    """Every other cube by its six faces."""
    data = vtkUnstructuredGrid()
    data.SetPoints(points_of())
    faces = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    for i, corners in enumerate(hexahedra_of(N)):
        if i % 2:
            stream = vtkIdList()
            stream.InsertNextId(6)
            for face in faces:
                stream.InsertNextId(4)
                for corner in face:
                    stream.InsertNextId(corners[corner])
            data.InsertNextCell(VTK_POLYHEDRON, stream)
        else:
            data.InsertNextCell(VTK_HEXAHEDRON, 8, [int(c) for c in corners])
    return scalars_of(data)


class Classes(InEachEngine):
    def test_every_class_and_cell_type_draws_what_tetrahedra_draw(self):
        reference, scene = picture(as_cells(VTK_TETRA))
        self.assertGreater((reference[..., 3] > 0.3).sum(), 500)
        # of a linear field every split is the same picture but for the error of Psi, 2e-3 of the colours'
        # difference in one segment (the bound); optical depth is exact
        cases = {
            "image": as_image(),
            "uniform grid": as_image(vtkUniformGrid),
            "turned image": as_turned_image(),
            "rectilinear": as_rectilinear(),
            "structured": as_structured(),
            "explicit": as_explicit(),
            "hexahedra": as_cells(VTK_HEXAHEDRON),
            "voxels": as_cells(VTK_VOXEL),
            "wedges": as_cells(VTK_WEDGE),
            "pyramids": as_pyramids(),
            "quadratic": as_quadratic(),
            "polyhedra": as_polyhedra(),
        }
        for name, data in cases.items():
            with self.subTest(data=name):
                rgba, scene = picture(data)
                self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
                self.assertLess(np.abs(rgba[..., 3] - reference[..., 3]).max(), FLOAT)
                self.assertLess(np.abs(rgba - reference).max(), 2e-3)
                mapper = scene.mapper
                self.assertEqual(mapper.GetInput() is None, not isinstance(data, vtkUnstructuredGrid))
                self.assertIs(mapper.GetDataSetInput(), data)

    def test_scalars_of_cells_are_constant_in_each(self):
        # layers along z of tau 1, 2, 3, 4, seen along z: their sum; whatever the class
        layers = np.repeat(np.arange(1.0, N + 1), N * N)
        prop = extinction(unit=0.1, ramp=((0.0, 0.0), (10.0, 1.0)))
        image = as_image()
        image.GetPointData().SetScalars(None)
        for data in (scalars_of(image, layers, cells=True), mesh(lattice(N), hexahedra_of(N), VTK_HEXAHEDRON,
                                                                 cell_scalars=layers)):
            scene = TetScene(data, prop)
            scene.look(half=0.4)
            self.assertLess(np.abs(scene.rgba()[..., 3] - (1.0 - np.exp(-10.0 / N))).max(), FLOAT)

    def test_ghost_hidden_and_blanked_cells_are_left_out(self):
        def without_layer(data, value):
            ghosts = vtkUnsignedCharArray()
            ghosts.SetName(vtkDataSetAttributes.GhostArrayName())
            ghosts.SetNumberOfTuples(N**3)
            ghosts.Fill(0)
            for i in range(N * N):
                ghosts.SetValue(i, value)
            data.GetCellData().AddArray(ghosts)
            return data

        ghost, hidden = vtkDataSetAttributes.DUPLICATECELL, vtkDataSetAttributes.HIDDENCELL
        for make in (as_image, lambda: as_cells(VTK_HEXAHEDRON), as_structured, as_polyhedra):
            for value, counter in ((ghost, "Ghost"), (hidden, "Blanked")):
                rgba, scene = picture(without_layer(make(), value), even(TAU))
                exact = paths(scene.renderer, 64, 64, (-0.5, -0.5, -0.5 + 1.0 / N), (0.5, 0.5, 0.5))
                self.assertLess(np.abs(rgba[..., 3] - (1.0 - np.exp(-TAU * exact))).max(), FLOAT)
                self.assertEqual(getattr(scene.mapper, "GetNumberOf%sCells" % counter)(), N * N)
        uniform = as_image(vtkUniformGrid)
        for i in range(N * N):
            uniform.BlankCell(i)
        rgba, scene = picture(uniform, even(TAU))
        self.assertLess(np.abs(rgba[..., 3] - (1.0 - np.exp(-TAU * exact))).max(), FLOAT)

    def test_a_pipeline_feeds_it_and_its_changes_are_seen(self):
        producer = vtkTrivialProducer()
        producer.SetOutput(as_cells(VTK_TETRA))
        mapper = new_mapper(vtkChiProjectedTetrahedraMapper)
        mapper.SetInputConnection(producer.GetOutputPort())
        scene = TetScene()
        from vtkmodules.vtkRenderingCore import vtkVolume

        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(even(TAU))
        scene.renderer.AddVolume(volume)
        scene.look(half=1.0)
        first = scene.pixels()
        producer.SetOutput(cube(2, 0.5))
        second = scene.pixels()
        self.assertGreater((first > 0).sum(), 2 * (second > 0).sum())
        self.assertGreater((second > 0).sum(), 100)


class Scalars(InEachEngine):
    def test_every_type_draws_the_same(self):
        numbers = np.round(100.0 * np.clip(values(), 0.0, 1.0))
        prop = extinction(unit=0.2, colors=[(100.0 * p, c) for p, c in COLORS], ramp=((0.0, 0.1), (100.0, 1.0)))
        reference = None
        names = (
            "UNSIGNED_CHAR CHAR SIGNED_CHAR SHORT UNSIGNED_SHORT INT UNSIGNED_INT LONG UNSIGNED_LONG "
            "LONG_LONG UNSIGNED_LONG_LONG ID_TYPE FLOAT DOUBLE"
        )
        for name in names.split():
            with self.subTest(type=name):
                array = vtkDataArray.CreateDataArray(getattr(vtkConstants, "VTK_" + name))
                array.DeepCopy(numpy_to_vtk(numbers))
                data = as_cells(VTK_TETRA)
                data.GetPointData().SetScalars(array)
                rgba, scene = picture(data, prop)
                self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
                reference = rgba if reference is None else reference
                # tables of integers and of reals have other entries: where the colour's slope changes
                # by up to 0.04 between two of them, 100/4096 apart, a colour is off by a quarter of both
                self.assertLess(np.abs(rgba - reference).max(), 0.25 * 0.04 * 100.0 / 4096.0)

    def test_bits_are_scalars_too(self):
        bits = vtkBitArray()
        for _ in range((N + 1) ** 3):
            bits.InsertNextValue(1)
        data = as_cells(VTK_TETRA)
        data.GetPointData().SetScalars(bits)
        rgba, scene = picture(data, even(TAU))
        exact = paths(scene.renderer, 64, 64)
        self.assertLess(np.abs(rgba[..., 3] - (1.0 - np.exp(-TAU * exact))).max(), FLOAT)

    def test_arrays_are_chosen_by_mode_and_name(self):
        data = mesh(lattice(N), tetrahedra_of(N))
        other = numpy_to_vtk(np.full((N + 1) ** 3, 0.75), deep=True)
        other.SetName("other")
        data.GetPointData().AddArray(other)
        cells = numpy_to_vtk(np.full(6 * N**3, 0.5), deep=True)
        cells.SetName("cells")
        data.GetCellData().AddArray(cells)
        scalars_of(data, np.full((N + 1) ** 3, 0.25))
        prop = extinction(ramp=((0.0, 0.0), (1.0, 1.0)))
        scene = TetScene(data, prop)
        scene.look(half=0.4)

        def tau():
            return -np.log(1.0 - float(scene.rgba()[32, 32, 3]))

        self.assertAlmostEqual(tau(), 0.25, 3)
        scene.mapper.SetScalarModeToUsePointFieldData()
        scene.mapper.SelectScalarArray("other")
        self.assertAlmostEqual(tau(), 0.75, 3)
        scene.mapper.SetScalarModeToUseCellFieldData()
        scene.mapper.SelectScalarArray("cells")
        self.assertAlmostEqual(tau(), 0.5, 3)
        data.GetPointData().SetActiveScalars("other")
        scene.mapper.SetScalarModeToUsePointData()
        self.assertAlmostEqual(tau(), 0.75, 3)
        self.assertEqual(scene.messages.errors, [])

    def test_a_component_or_the_magnitude(self):
        vectors = np.tile(np.array((0.3, -0.4, 0.0)), ((N + 1) ** 3, 1))
        data = mesh(lattice(N), tetrahedra_of(N), scalars=vectors)
        prop = extinction(ramp=((-1.0, 0.0), (1.0, 1.0)))
        scene = TetScene(data, prop)
        scene.look(half=0.4)

        def scalar():
            return -2.0 * np.log(1.0 - float(scene.rgba()[32, 32, 3])) - 1.0

        self.assertAlmostEqual(scalar(), 0.3, 3) # as vtkProjectedTetrahedraMapper: the first
        scene.mapper.SetVectorModeToComponent()
        scene.mapper.SetVectorComponent(1)
        self.assertAlmostEqual(scalar(), -0.4, 3)
        scene.mapper.SetVectorComponent(2)
        self.assertAlmostEqual(scalar(), 0.0, 3)
        scene.mapper.SetVectorModeToMagnitude()
        self.assertAlmostEqual(scalar(), 0.5, 3)
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))

    def test_opacity_of_its_own(self):
        # colour by a ramp over 0 ... 1, opacity by an array in the thousands
        opacity = np.full((N + 1) ** 3, 1500.0)
        prop = extinction(colors=COLORS, ramp=((1000.0, 0.0), (2000.0, 1.0)))
        both = mesh(lattice(N), tetrahedra_of(N), scalars=np.stack([np.full_like(opacity, 0.5), opacity], -1))
        apart = mesh(lattice(N), tetrahedra_of(N), scalars=np.full_like(opacity, 0.5))
        array = numpy_to_vtk(opacity, deep=True)
        array.SetName("opacity")
        apart.GetPointData().AddArray(array)
        for data, by_name in ((both, False), (apart, True)):
            prop.SetIndependentComponents(by_name)
            scene = TetScene(data, prop)
            scene.look(half=0.4)
            if by_name:
                scene.mapper.SetOpacityArrayName("opacity")
            rgba = scene.rgba()[32, 32]
            with self.subTest(by_name=by_name):
                self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
                self.assertLess(abs(rgba[3] - (1.0 - np.exp(-0.5))), FLOAT)
                np.testing.assert_allclose(rgba[:3] / rgba[3], COLORS[1][1], atol=1e-3)
        vtk_to_numpy(array)[:] = 1250.0 # and its changes are seen
        array.Modified()
        self.assertLess(abs(scene.rgba()[32, 32, 3] - (1.0 - np.exp(-0.25))), FLOAT)


class BadInput(InEachEngine):
    """Each cause is named once: class, array, reason; nothing is drawn, or all that is good."""

    def assert_says(self, data, words, error=True, prepare=None, drawn=False):
        scene = TetScene(data, even(TAU))
        if prepare:
            prepare(scene)
        for _ in range(3):
            scene.window.Render()
        said = scene.messages.errors if error else scene.messages.warnings
        other = scene.messages.warnings if error else scene.messages.errors
        self.assertEqual((len(said), other), (1, []), said + other)
        for word in words:
            self.assertIn(word, said[0])
        rgba = scene.rgba()
        self.assertEqual(rgba is not None and bool(rgba[..., 3].max() > 0.0), drawn)
        return scene

    def test_nothing_there(self):
        self.assert_says(vtkUnstructuredGrid(), ("vtkUnstructuredGrid", "no points"), error=False)
        empty = mesh(lattice(1), np.empty((0, 4), int), scalars=np.ones(8))
        self.assert_says(empty, ("vtkUnstructuredGrid", "no cells"), error=False)
        scene = TetScene(cube(1), even(TAU))
        scene.mapper.RemoveAllInputs()
        scene.window.Render()
        self.assertEqual(scene.messages.errors, [])

    def test_no_scalars(self):
        self.assert_says(mesh(lattice(1), tetrahedra_of(1)), ("vtkUnstructuredGrid", "no scalars"))

        def by_name(scene):
            scene.mapper.SetScalarModeToUsePointFieldData()
            scene.mapper.SelectScalarArray("missing")

        self.assert_says(cube(1), ("vtkUnstructuredGrid", "'missing'"), prepare=by_name)

        def of_the_field(scene):
            array = numpy_to_vtk(np.ones(8), deep=True)
            array.SetName("constants")
            scene.mapper.GetInput().GetFieldData().AddArray(array)
            scene.mapper.SetScalarMode(5) # VTK_SCALAR_MODE_USE_FIELD_DATA
            scene.mapper.SelectScalarArray("constants")

        self.assert_says(cube(1), ("field data",), prepare=of_the_field)
        self.assert_says(
            cube(1), ("opacity array 'nowhere'",), prepare=lambda s: s.mapper.SetOpacityArrayName("nowhere")
        )

    def test_too_few_scalars(self):
        data = mesh(lattice(1), tetrahedra_of(1))
        short = numpy_to_vtk(np.ones(7), deep=True)
        short.SetName("short")
        data.GetPointData().AddArray(short)

        def choose(scene):
            scene.mapper.SetScalarModeToUsePointFieldData()
            scene.mapper.SelectScalarArray("short")

        self.assert_says(data, ("'short'", "7 tuples", "8 points"), prepare=choose)

    def test_composite_data_name_the_filter_that_helps(self):
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, cube(1))
        self.assert_says(blocks, ("vtkMultiBlockDataSet", "vtkMergeBlocks"))

    def test_no_cells_of_volume(self):
        flat = vtkPolyData()
        flat.SetPoints(points_of())
        triangles = vtkCellArray()
        triangles.InsertNextCell(3, (0, 1, 7))
        flat.SetPolys(triangles)
        self.assert_says(scalars_of(flat), ("vtkPolyData", "no volume"))
        sheet = vtkImageData()
        sheet.SetDimensions(5, 5, 1)
        self.assert_says(scalars_of(sheet, np.ones(25)), ("vtkImageData", "no cells of volume"), error=False)

    def test_cells_of_unknown_types(self):
        data = cube(2)
        data.InsertNextCell(72, 8, list(range(8))) # VTK_LAGRANGE_HEXAHEDRON
        scene = self.assert_says(data, ("vtkUnstructuredGrid", "not split"), error=False, drawn=True)
        self.assertEqual(scene.mapper.GetNumberOfUnsupportedCells(), 1)

    def test_numbers_that_are_not_finite_leave_their_cells_out(self):
        for bad in (np.nan, np.inf, -np.inf):
            data = cube(4)
            vtk_to_numpy(data.GetPointData().GetScalars())[0] = bad # a corner of one cube
            scene = self.assert_says(data, ("scalars", "NaN"), error=False, drawn=True)
            self.assertEqual(scene.mapper.GetNumberOfNonFiniteTetrahedra(), 6)
            data = cube(4)
            vtk_to_numpy(data.GetPoints().GetData())[124] = (bad, 0.0, 0.0) # the opposite one
            scene = self.assert_says(data, ("vtkUnstructuredGrid", "NaN"), error=False, drawn=True)
            self.assertEqual(scene.mapper.GetNumberOfNonFiniteCells(), 6)
            # and the camera still finds the rest
            scene.renderer.ResetCamera()
            self.assertTrue(np.isfinite(scene.renderer.GetActiveCamera().GetPosition()).all())
            self.assertGreater((scene.rgba()[..., 3] > 0.1).sum(), 200)

    def test_a_broken_mesh_names_the_cell(self):
        data = cube(1)
        vtk_to_numpy(data.GetCells().GetConnectivityArray())[4 * 3 + 1] = 77 # of cell 3
        self.assert_says(data, ("cell 3", "vtkUnstructuredGrid", "broken"))

    def test_matrix_and_planes_that_mean_nothing(self):
        self.assert_says(cube(1), ("matrix", "singular"), prepare=lambda s: s.volume.SetScale(1.0, 0.0, 1.0))

        def cut(scene):
            plane = vtkPlane()
            plane.SetNormal(0.0, 0.0, 0.0)
            scene.mapper.AddClippingPlane(plane)

        self.assert_says(cube(1), ("clipping plane",), prepare=cut)

    def test_after_a_good_frame_the_same_mistake_is_named_again(self):
        data = cube(1)
        scene = TetScene(data, even(TAU))
        scene.mapper.SetOpacityArrayName("nowhere")
        scene.window.Render()
        scene.mapper.SetOpacityArrayName(None)
        scene.window.Render()
        self.assertIsNotNone(scene.rgba())
        scene.mapper.SetOpacityArrayName("nowhere")
        scene.window.Render()
        self.assertEqual(len(scene.messages.errors), 2)


class ClassesInOpenGL(InOpenGL, Classes):
    pass


class ScalarsInOpenGL(InOpenGL, Scalars):
    pass


class BadInputInOpenGL(InOpenGL, BadInput):
    pass


if __name__ == "__main__":
    unittest.main()
