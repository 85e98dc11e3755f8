# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiTransferFunction2D, alone and in the mappers of volumes and of tetrahedra."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL
from occlusion_scene import Messages, Scene, erode, float_image, marschner_lobb, volume_property
from tetrahedra_scene import TetScene, cube, even, extinction, hexahedra_of, lattice, mesh, paths
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_HEXAHEDRON
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper, vtkChiTransferFunction2D

RED = (1.0, 0.0, 0.0, 0.5)
BLUE = (0.0, 0.0, 1.0, 0.75)


def value(function, x, y):
    rgba = [0.0] * 4
    function.MapValue(x, y, rgba)
    return rgba


def points(places):
    result = vtkPoints()
    for x, y in places:
        result.InsertNextPoint(x, y, 17.0)
    return result


def rgba_image(values, origin=(0.0, 0.0), spacing=(1.0, 1.0)):
    """values[y, x, 4]"""
    data = vtkImageData()
    data.SetDimensions(values.shape[1], values.shape[0], 1)
    data.SetOrigin(*origin, 0.0)
    data.SetSpacing(*spacing, 1.0)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(values).reshape(-1, 4), deep=True))
    return data


class Shapes(unittest.TestCase):
    def test_each_is_where_it_is_put(self):
        function = vtkChiTransferFunction2D()
        self.assertEqual(value(function, 1.0, 1.0), [0.0] * 4)
        self.assertEqual(function.AddRectangle(0.0, 2.0, 0.0, 4.0, RED), 0)
        self.assertEqual(function.AddTrapezoid(3.0, 3.0, 2.5, 3.5, 0.0, 4.0, BLUE, 1.0), 1)
        self.assertEqual(function.AddGaussian(6.0, 2.0, 0.5, 1.0, RED), 2)
        self.assertEqual(function.AddPolygon(points(((8, 0), (9, 0), (8.5, 3))), BLUE), 3)
        self.assertEqual(function.GetNumberOfShapes(), 4)
        np.testing.assert_allclose(value(function, 1.0, 1.0), RED, atol=1e-7) # the far Gaussian's tail
        np.testing.assert_allclose(value(function, 3.0, 2.0), BLUE, atol=1e-7)
        self.assertAlmostEqual(value(function, 6.5, 2.0)[3], 0.5 * np.exp(-0.5), 12)
        self.assertAlmostEqual(value(function, 8.5, 1.0)[3], 0.75, 5)
        function.RemoveShape(0)
        self.assertLess(value(function, 1.0, 1.0)[3], 1e-7)
        function.RemoveAllShapes()
        self.assertEqual(value(function, 8.5, 1.0), [0.0] * 4)

    def test_an_image_lies_in_its_own_coordinates(self):
        values = np.zeros((3, 2, 4), np.uint8)
        values[1, 1] = (255, 0, 0, 51)
        function = vtkChiTransferFunction2D()
        self.assertTrue(function.SetImage(rgba_image(values, (10.0, -1.0), (2.0, 0.5))))
        np.testing.assert_allclose(value(function, 12.0, -0.5), (1.0, 0.0, 0.0, 0.2), atol=1e-6)
        self.assertAlmostEqual(value(function, 11.0, -0.5)[3], 0.1, 6)
        self.assertAlmostEqual(value(function, 99.0, -0.5)[3], 0.2, 6) # the nearest beyond
        function.AddGaussian(12.0, -0.5, 1.0, 1.0, BLUE)
        self.assertEqual(function.GetNumberOfShapes(), 2)
        self.assertTrue(function.SetImage(rgba_image(np.zeros((2, 2, 4), np.float32))))
        self.assertEqual(function.GetNumberOfShapes(), 2)
        self.assertTrue(function.SetImage(None))
        self.assertAlmostEqual(value(function, 12.0, -0.5)[3], 0.75, 12)

    def test_times_tell_what_has_changed(self):
        function = vtkChiTransferFunction2D()
        times = [function.GetMTime()]
        for change in (
            lambda: function.AddGaussian(0.0, 0.0, 1.0, 1.0, RED),
            lambda: function.SetImage(rgba_image(np.zeros((2, 2, 4), np.float32))),
            lambda: function.RemoveShape(1),
            lambda: function.RemoveAllShapes(),
        ):
            change()
            times.append(function.GetMTime())
        self.assertEqual(times, sorted(set(times)))
        function.RemoveAllShapes()
        function.SetImage(None)
        self.assertEqual(function.GetMTime(), times[-1])

    def test_a_table_is_an_image(self):
        function = vtkChiTransferFunction2D()
        function.AddGaussian(0.5, 0.25, 0.1, 0.1, RED)
        table = vtkImageData()
        self.assertTrue(function.GetTable(11, 5, 0.0, 1.0, 0.0, 0.5, table))
        self.assertEqual(table.GetDimensions(), (11, 5, 1))
        values = vtk_to_numpy(table.GetPointData().GetScalars()).reshape(5, 11, 4)
        np.testing.assert_allclose(values[2, 5], RED, atol=1e-6)
        np.testing.assert_allclose(values[2, 6, 3], 0.5 * np.exp(-0.5), rtol=1e-5)

    def test_nonsense_is_an_error_and_changes_nothing(self):
        function = vtkChiTransferFunction2D()
        messages = Messages(function)
        time = function.GetMTime()
        for attempt in (
            lambda: function.AddRectangle(1.0, 1.0, 0.0, 1.0, RED),
            lambda: function.AddRectangle(0.0, 1.0, 0.0, 1.0, (1.0, 0.0, 0.0, 1.5)),
            lambda: function.AddRectangle(0.0, 1.0, 0.0, float("nan"), RED),
            lambda: function.AddTrapezoid(1.0, 0.0, 0.0, 1.0, 0.0, 1.0, RED),
            lambda: function.AddGaussian(0.0, 0.0, 0.0, 1.0, RED),
            lambda: function.AddGaussian(0.0, 0.0, 1.0, 1.0, RED, 1.0),
            lambda: function.AddPolygon(points(((0, 0), (1, 1))), RED),
            lambda: function.AddPolygon(None, RED),
            lambda: function.SetImage(vtkImageData()) - 1,
            lambda: function.SetImage(rgba_image(np.zeros((1, 2, 4), np.float32))) - 1,
            lambda: function.GetTable(1, 5, 0.0, 1.0, 0.0, 1.0, vtkImageData()) - 1,
            lambda: function.GetTable(4, 5, 1.0, 1.0, 0.0, 1.0, vtkImageData()) - 1,
            lambda: function.GetTable(1 << 16, 1 << 16, 0.0, 1.0, 0.0, 1.0, vtkImageData()) - 1,
            lambda: function.GetTable(4, 5, 0.0, 1.0, 0.0, 1.0, None) - 1,
        ):
            count = len(messages.errors)
            self.assertEqual(attempt(), -1)
            self.assertEqual(len(messages.errors), count + 1)
        function.RemoveShape(0)
        self.assertIn("no shape 0", messages.errors[-1])
        self.assertEqual((function.GetNumberOfShapes(), function.GetMTime()), (0, time))


N = 32
DATA = marschner_lobb(N)


def picture(prepare, distance=0.0, data=DATA, size=96):
    scene = Scene((size, size))
    prop = volume_property(unit=0.1)
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetOcclusionStrength(0.0)
    mapper.SetSampleDistance(distance)
    messages = Messages(mapper)
    scene.add_volume(data, prop, mapper)
    prepare(mapper, prop)
    scene.look((-0.5, -0.35, -0.8), half=1.4, parallel=False)
    scene.window.Render()
    assert not messages.errors and not messages.warnings, (messages.errors, messages.warnings)
    return float_image(mapper)


def blobs(deviation, top=0.1):
    """Gaussians over the scalar, 0 to 1, and the gradient, mostly 0 to `top`."""
    function = vtkChiTransferFunction2D()
    for x, y, rgba in (
        (0.3, 0.3, (1.0, 0.3, 0.1, 0.3)),
        (0.55, 0.6, (0.2, 1.0, 0.3, 0.5)),
        (0.75, 0.15, (0.3, 0.4, 1.0, 0.4)),
    ):
        function.AddGaussian(x, y * top, deviation, deviation * top, rgba)
    return function


class InTheVolumeMapper(unittest.TestCase):
    def test_draws_what_the_same_table_draws_in_vtk_volume_property(self):
        function = blobs(0.1)
        low, high = DATA.GetScalarRange()
        table = vtkImageData()
        function.GetTable(512, 512, low, high, 0.0, 0.25 * (high - low), table)

        def by_property(_, prop):
            prop.SetTransferFunctionModeTo2D()
            prop.SetTransferFunction2D(table)

        ours = picture(lambda mapper, _: mapper.SetTransferFunction2D(function))
        theirs = picture(by_property)
        self.assertGreater((ours[..., 3] > 0.2).sum(), 1000)
        # both are linear between entries: of 512 the curvature over half an entry of sigma / 40
        self.assertLess(255.0 * np.abs(ours - theirs).max(), 1.0)
        self.assertGreater(255.0 * np.abs(ours - picture(lambda *_: None)).mean(), 5.0)

    def test_opacity_does_not_hang_on_the_distance_of_the_slices(self):
        n = 128
        data = marschner_lobb(n)
        for deviation in (1 / 8, 1 / 16, 1 / 32):
            # over the axes of the ray caster, whose y is a quarter of the scalar range
            function = blobs(deviation, 0.25)
            a, b = (
                picture(lambda mapper, _: mapper.SetTransferFunction2D(function), 2.0 / (n - 1) * d, data, 128)
                for d in (2.0, 0.25)
            )
            difference = 255.0 * np.abs(a - b).max(axis=2)
            inside = erode(b[..., 3] > 0.0, 2)
            self.assertGreater(inside.sum(), 4000)
            mean, most = difference[inside].mean(), np.percentile(difference[inside], 99.0)
            print(f"sigma {deviation:.3f}: 2 against 0.25 voxels: mean {mean:.2f}, 99 % {most:.2f} of 255")
            if deviation >= 1 / 16: # the bounds; narrower ones are reported
                self.assertLessEqual(mean, 2.0)
                self.assertLessEqual(most, 6.0)

    def test_a_second_array_and_changes_are_seen(self):
        values = vtk_to_numpy(DATA.GetPointData().GetScalars()).reshape((N,) * 3)
        data = vtkImageData()
        data.DeepCopy(DATA)
        z = np.broadcast_to(np.linspace(0.0, 1.0, N, dtype=np.float32)[:, None, None], values.shape)
        other = numpy_to_vtk(np.ascontiguousarray(z).ravel(), deep=True)
        other.SetName("height")
        data.GetPointData().AddArray(other)
        function = vtkChiTransferFunction2D()
        function.AddRectangle(-1.0, 2.0, -1.0, 0.5, (1.0, 1.0, 1.0, 0.5)) # the lower half

        scene = Scene((64, 64))
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        mapper.SetOcclusionStrength(0.0)
        mapper.SetTransferFunction2D(function)
        mapper.SetTransfer2DYAxisArray("height")
        scene.add_volume(data, volume_property(unit=0.1), mapper)
        scene.look((0, 1, 0), up=(0, 0, 1), half=1.0)
        scene.window.Render()
        alpha = float_image(mapper)[..., 3]
        self.assertGreater(alpha[8:28, 8:56].min(), 0.99)
        self.assertEqual(alpha[36:, :].max(), 0.0)
        function.AddRectangle(-1.0, 2.0, 0.75, 2.0, (1.0, 1.0, 1.0, 0.5))
        scene.window.Render()
        self.assertGreater(float_image(mapper)[52:58, 8:56, 3].min(), 0.99)
        mapper.SetTransferFunction2D(None)
        self.assertIsNone(mapper.GetTransferFunction2D())
        scene.window.Render()
        self.assertGreater(float_image(mapper)[40, 32, 3], 0.1) # the property's functions


class InTheTetrahedraMapper(InEachEngine):
    def test_the_gradient_of_a_ramp_is_its_slope_times_the_edge_of_a_mean_cell(self):
        n = 4
        data = cube(n, field=lambda x, y, z: x + 0.5)
        slope = (1.0 / (6 * n**3)) ** (1 / 3) # tetrahedra are the cells
        for share, expected in ((1.0, 1.0), (1.5, 0.0)):
            function = vtkChiTransferFunction2D()
            middle = share * slope
            function.AddRectangle(-1.0, 2.0, 0.8 * middle, 1.2 * middle, (1.0, 0.5, 0.25, 0.5))
            scene = TetScene(data, extinction(1.0, 0.25))
            scene.mapper.SetTransferFunction2D(function)
            scene.look((-0.5, -0.35, -0.8), half=0.8, parallel=False)
            rgba = scene.rgba()
            self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
            alpha = expected * (1.0 - np.exp(-0.5 / 0.25 * paths(scene.renderer, 64, 64)))
            self.assertLess(np.abs(rgba[..., 3] - alpha).max(), 1e-4) # the bound of even meshes
            self.assertLess(np.abs(rgba[..., 1] - 0.5 * alpha).max(), 1e-4)

    def test_a_second_array_of_points_and_of_cells(self):
        n = 4
        points = lattice(n)
        corners = hexahedra_of(n)
        for of_cells in (False, True):
            places = points[corners].mean(axis=1) if of_cells else points
            ones = {"cell_scalars" if of_cells else "scalars": np.ones(len(places), np.float32)}
            data = mesh(points, corners, VTK_HEXAHEDRON, **ones)
            other = numpy_to_vtk(np.ascontiguousarray(places[:, 1]), deep=True)
            other.SetName("height")
            (data.GetCellData() if of_cells else data.GetPointData()).AddArray(other)
            function = vtkChiTransferFunction2D()
            function.AddRectangle(-1.0, 2.0, 0.0, 1.0, (1.0, 1.0, 1.0, 0.5)) # the upper half
            scene = TetScene(data, even(1.0))
            scene.mapper.SetTransferFunction2D(function)
            scene.mapper.SetTransfer2DYAxisArray("height")
            scene.look(half=0.5)
            alpha = scene.rgba()[..., 3]
            # but for a step of the table: 1/256 of the height
            np.testing.assert_allclose(alpha[33:], 1.0 - np.exp(-0.5), atol=1e-4)
            self.assertLess(alpha[:31].max(), 1e-6)
            scene.mapper.SetTransfer2DYAxisArray("width")
            scene.rgba()
            self.assertIn("'width'", scene.messages.warnings[-1])

    def test_the_property_may_have_the_function(self):
        low, high = 0.0, 1.0
        function = blobs(0.1)
        table = vtkImageData()
        function.GetTable(512, 512, low, high, 0.0, 0.25 * (high - low), table)
        pictures = []
        for by_property in (False, True):
            prop = extinction(1.0, 0.02)
            if by_property:
                prop.SetTransferFunctionModeTo2D()
                prop.SetTransferFunction2D(table)
            scene = TetScene(cube(8, field=lambda x, y, z: (x + 0.5) ** 2), prop)
            if not by_property:
                scene.mapper.SetTransferFunction2D(function)
            scene.look((-0.5, -0.35, -0.8), half=0.8)
            pictures.append(scene.rgba())
        self.assertGreater(pictures[0][..., 3].max(), 0.3)
        # gradients are constant in a cell and its rows are two tables' between entries
        self.assertLess(255.0 * np.abs(pictures[0] - pictures[1]).max(), 1.0)

    def test_what_cannot_be_along_with_it_is_named(self):
        scene = TetScene(cube(2), even(1.0))
        scene.mapper.SetOpacityArrayName("density")
        scene.mapper.SetTransferFunction2D(blobs(0.1))
        scene.mapper.SetProjectionToPublished()
        scene.rgba()
        self.assertEqual(scene.messages.errors, [])
        self.assertTrue(any("opacity array" in text for text in scene.messages.warnings))
        self.assertTrue(any("published projection" in text for text in scene.messages.warnings))


class InTheTetrahedraMapperInOpenGL(InOpenGL, InTheTetrahedraMapper):
    pass


class BothEnginesOfTetrahedra(unittest.TestCase):
    def test_draw_the_same(self):
        def field(x, y, z):
            return 0.5 + 0.25 * np.sin(5.0 * x + 3.0 * y * z) + 0.25 * np.cos(7.0 * y - 4.0 * z)

        data = cube(6, field=field)
        other = numpy_to_vtk(np.ascontiguousarray(lattice(6)[:, 2] + 0.5), deep=True)
        other.SetName("depth")
        data.GetPointData().AddArray(other)
        for second in (None, "depth"):
            for method in ("None", "Partial", "Full"):
                pictures = []
                for engine in (InEachEngine.ENGINE, InOpenGL.ENGINE):
                    InEachEngine.now = engine
                    scene = TetScene(data, extinction(1.0, 0.1))
                    getattr(scene.mapper, "SetPreIntegrationTo" + method)()
                    scene.mapper.SetTransferFunction2D(blobs(0.15, 1.0 if second else 0.2))
                    scene.mapper.SetTransfer2DYAxisArray(second)
                    scene.look((-0.5, -0.35, -0.8), half=0.8, parallel=False)
                    pictures.append(scene.rgba())
                difference = 255.0 * np.abs(pictures[0] - pictures[1])
                print(f"{second}, {method}: mean {difference.mean():.5f}, most {difference.max():.4f} of 255")
                self.assertGreater(pictures[0][..., 3].max(), 0.3)
                self.assertLess(difference.max(), 0.5) # psi by table and by quadrature, 2e-3


if __name__ == "__main__":
    unittest.main()
