# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiProjectedTetrahedraMapper: colours that are given with the scalars (four dependent components), against
closed forms, and against what vtkProjectedTetrahedraMapper makes of the same arrays."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL
from occlusion_scene import float_image
from tetrahedra_scene import TetScene, cube, even, extinction, lattice, mesh, paths, tetrahedra_of
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingVolume import vtkProjectedTetrahedraMapper

N = 3
FLOAT = 1e-4 # of the float picture of an even mesh: the bound
OBLIQUE = (-0.4, -0.5, -1.0)
COLOR = np.array((0.2, 0.6, 1.0)) # fifteenths: exact in bytes
OPACITY = 0.8
RED_TABLE = ((0.0, (1.0, 0.0, 0.0)), (255.0, (1.0, 0.0, 0.0))) # must never be seen


def given(opacity, unit=1.0):
    """Dependent components; `opacity` is a list of (value, opacity)."""
    prop = extinction(unit=unit, colors=RED_TABLE, ramp=opacity)
    prop.IndependentComponentsOff()
    return prop


def block(rgba, cells=False, n=N):
    """The cube of 6 n^3 tetrahedra with a tuple of its own for each point, or cell."""
    where = {"cell_scalars" if cells else "scalars": rgba}
    return mesh(lattice(n), tetrahedra_of(n), **where)


def tuples(color, opacity, count, dtype):
    one = np.append(color, opacity)
    one = np.round(255.0 * one) if dtype == np.uint8 else one
    return np.tile(one, (count, 1)).astype(dtype)


def pictures(data, prop, mapper=None, direction=OBLIQUE):
    """The window's picture of one mapper."""
    scene = TetScene(size=(64, 64))
    scene.add_volume(data, prop, mapper or scene.mapper)
    scene.look(direction, half=0.9, parallel=True)
    scene.window.Render() # vtkProjectedTetrahedraMapper draws nothing in the first frame
    return scene.pixels(), scene


class Even(InEachEngine):
    def test_every_type_of_points_and_cells(self):
        for dtype in (np.uint8, np.float32, np.float64):
            for cells in (False, True):
                count = 6 * N**3 if cells else (N + 1) ** 3
                top = 255.0 if dtype == np.uint8 else 1.0
                data = block(tuples(COLOR, OPACITY, count, dtype), cells)
                _, scene = pictures(data, given(((0.0, 0.0), (top, 1.0)), 0.5))
                if cells:
                    scene.mapper.SetScalarModeToUseCellData()
                with self.subTest(dtype=dtype, cells=cells):
                    rgba = scene.rgba()
                    self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))
                    exact = 1.0 - np.exp(-OPACITY / 0.5 * paths(scene.renderer, 64, 64))
                    self.assertLess(np.abs(rgba[..., 3] - exact).max(), FLOAT)
                    self.assertLess(np.abs(rgba[..., :3] - exact[..., None] * COLOR).max(), FLOAT)

    def test_integers_of_other_types_are_colors_as_they_are(self):
        rgba = np.tile((1, 0, 3, 200), ((N + 1) ** 3, 1)) # 3 is beyond what is white
        for dtype in (np.int16, np.int32, np.int64):
            _, scene = pictures(block(rgba.astype(dtype)), given(((0.0, 0.0), (200.0, 1.0))))
            got = scene.rgba()
            np.testing.assert_allclose(got[..., :3], got[..., 3:] * (1.0, 0.0, 1.0), atol=1e-6)
            self.assertGreater(got[..., 3].max(), 0.5)

    def test_the_fourth_component_goes_through_the_opacity_function(self):
        data = block(tuples(COLOR, 0.25, (N + 1) ** 3, np.float32))
        for steps, tau in ((((0.0, 1.0), (1.0, 0.0)), 0.75), (((0.0, 0.0), (0.24, 0.0), (0.25, 0.5), (1.0, 0.5)), 0.5)):
            _, scene = pictures(data, given(steps))
            exact = 1.0 - np.exp(-tau * paths(scene.renderer, 64, 64))
            self.assertLess(np.abs(scene.rgba()[..., 3] - exact).max(), FLOAT)

    def test_hues_are_those_of_vtk(self):
        # one tetrahedron, seen along z, so that lengths rise from its edges to the middle
        points = ((-0.7, -0.6, 0.3), (0.7, -0.6, 0.3), (0.0, 0.7, 0.3), (0.0, 0.0, -0.5))
        for dtype in (np.uint8, np.float32):
            top = 255.0 if dtype == np.uint8 else 1.0
            prop = given(((0.0, 0.0), (top, 1.0)), 0.25)
            for cells in (False, True):
                values = {}
                for name, color in (("hue", COLOR), ("white", np.ones(3))):
                    rgba = tuples(color, OPACITY, 1 if cells else 4, dtype)
                    data = mesh(points, [(0, 1, 2, 3)], **{"cell_scalars" if cells else "scalars": rgba})
                    for kind, mapper in (("vtk", vtkProjectedTetrahedraMapper()), ("own", None)):
                        if mapper and cells:
                            mapper.SetScalarModeToUseCellData()
                        picture, scene = pictures(data, prop, mapper, (0.0, 0.0, -1.0))
                        if not mapper and cells:
                            scene.mapper.SetScalarModeToUseCellData()
                            picture = scene.pixels()
                        values[kind, name] = picture
                for kind in ("vtk", "own"):
                    white, hue = values[kind, "white"], values[kind, "hue"]
                    with self.subTest(dtype=dtype, cells=cells, mapper=kind):
                        self.assertGreater((white[..., 0] > 0.3).sum(), 200)
                        # both pictures are rounded to 8 bits: half a step each; floats of COLOR are
                        # cut down to 8 bits by VTK before
                        self.assertLess(np.abs(hue - white * COLOR).max(), 1.51 / 255.0)
                # of one cell in parallel projection VTK's length, and with it the opacity, is exact too:
                # half a step of 8 bits each
                self.assertLess(np.abs(values["own", "white"] - values["vtk", "white"]).max(), 1.01 / 255.0)
                self.assertLess(np.abs(values["own", "hue"] - values["vtk", "hue"]).max(), 1.51 / 255.0)

    def test_vtk_takes_the_fourth_component_for_the_opacity_itself(self):
        # so that its picture does not change with the function: what this class says it does differently
        data = block(tuples(COLOR, OPACITY, (N + 1) ** 3, np.float32))
        steep, flat = given(((0.0, 0.0), (1.0, 1.0))), given(((0.0, 0.1), (1.0, 0.1)))
        vtk = [pictures(data, prop, vtkProjectedTetrahedraMapper())[0] for prop in (steep, flat)]
        own = [pictures(data, prop)[0] for prop in (steep, flat)]
        np.testing.assert_array_equal(vtk[0], vtk[1])
        self.assertGreater(own[0].mean(), 3.0 * own[1].mean())


class Linear(InEachEngine):
    def ramp(self, axis):
        """Red rises from 0 to 1 along an axis, green falls, blue is 1/4; the fourth component is 1/2."""
        x = lattice(N)[:, axis] + 0.5
        return np.stack([x, 1.0 - x, np.full_like(x, 0.25), np.full_like(x, 0.5)], -1).astype(np.float32)

    def test_across_the_view(self):
        scene = TetScene(block(self.ramp(0)), given(((0.0, 0.0), (1.0, 1.0)), 0.2))
        scene.look((0, 0, -1), half=0.5, parallel=True)
        rgba = scene.rgba()
        alpha = 1.0 - np.exp(-2.5)
        x = (np.arange(64) + 0.5) / 64.0
        self.assertLess(np.abs(rgba[..., 3] - alpha).max(), FLOAT)
        self.assertLess(np.abs(rgba[..., 0] - alpha * x).max(), FLOAT)
        self.assertLess(np.abs(rgba[..., 1] - alpha * (1.0 - x)).max(), FLOAT)
        self.assertLess(np.abs(rgba[..., 2] - alpha * 0.25).max(), FLOAT)

    def test_along_the_view(self):
        # the integral of (1 - u) tau e^(-tau u): red is 1 in front
        tau = 2.5
        exact = 1.0 - (1.0 - np.exp(-tau)) / tau
        for method in ("Partial", "Full", "Auto"):
            # an odd height: no ray lies in the diagonal faces, which all are edge-on
            scene = TetScene(block(self.ramp(2)), given(((0.0, 0.0), (1.0, 1.0)), 0.2), size=(64, 51))
            getattr(scene.mapper, "SetPreIntegrationTo" + method)()
            scene.look((0, 0, -1), half=0.4, parallel=True)
            # psi's error, 4.5e-5 a segment (theory/preintegration.md)
            self.assertLess(np.abs(scene.rgba()[..., 0] - exact).max(), FLOAT)

    def test_none_is_the_middle(self):
        scene = TetScene(block(self.ramp(2)), given(((0.0, 0.0), (1.0, 1.0)), 0.2), size=(64, 51))
        scene.mapper.SetPreIntegrationToNone()
        scene.look((0, 0, -1), half=0.4, parallel=True)
        got = scene.rgba()[..., 0]
        tau = 2.5
        off = (1.0 - (1.0 - np.exp(-tau)) / tau) - got
        # 3 layers, in each of which the front's half of the colour weighs more than half by t^2 / 12 at
        # most, t being its optical depth: to first order psi - (1 + T) / 2
        self.assertLess(off.max(), 3.0 * (1.0 / 3.0) * (tau / 3.0) ** 2 / 12.0)
        self.assertGreater(off.min(), 1e-3) # and it does make a difference

    def test_maximum_intensity_has_the_color_of_the_largest_fourth_component(self):
        rgba = self.ramp(0)
        rgba[:, 3] = lattice(N)[:, 2] + 0.5 # largest where the view along -z begins
        scene = TetScene(block(rgba), given(((0.0, 0.0), (1.0, 1.0))))
        scene.mapper.SetBlendModeToMaximumIntensity()
        scene.look((0, 0, -1), half=0.5, parallel=True)
        scene.window.Render()
        got = float_image(scene.mapper)
        if scene.mapper.GetEngine() == scene.mapper.ENGINE_OPENGL: # which leaves this to the CPU engine
            self.assertEqual(scene.mapper.GetEngineInUse(), scene.mapper.ENGINE_CPU)
            self.assertIn("four dependent components", scene.mapper.GetEngineReason())
        x = (np.arange(64) + 0.5) / 64.0
        np.testing.assert_allclose(got[..., 3], 1.0, atol=1e-5)
        self.assertLess(np.abs(got[..., 0] - x).max(), FLOAT)

    def test_lights_shine_on_the_gradient_of_the_fourth_component(self):
        rgba = self.ramp(0)
        rgba[:, 3] = lattice(N)[:, 2] + 0.5 # faces the headlight of a view along -z
        factors = []
        for axis in (2, 0):
            rgba[:, 3] = lattice(N)[:, axis] + 0.5
            prop = given(((0.0, 0.5), (1.0, 0.5)))
            plain = TetScene(block(rgba), prop)
            plain.look((0, 0, -1), half=0.4, parallel=True)
            before = plain.rgba()
            prop.ShadeOn()
            prop.SetAmbient(0.25)
            prop.SetDiffuse(0.5)
            prop.SetSpecular(0.0)
            after = plain.rgba()
            np.testing.assert_allclose(after[..., 3], before[..., 3], atol=1e-6)
            factors.append(after[..., :3] / before[..., :3])
        np.testing.assert_allclose(factors[0], 0.75, atol=1e-4) # n.l = 1
        np.testing.assert_allclose(factors[1], 0.25, atol=1e-4) # n.l = 0


class Choice(InEachEngine):
    def test_changes_are_seen(self):
        rgba = tuples(COLOR, OPACITY, (N + 1) ** 3, np.float32)
        data = block(rgba)
        prop = given(((0.0, 0.0), (1.0, 1.0)))
        _, scene = pictures(data, prop)
        array = data.GetPointData().GetScalars()
        first = scene.rgba()
        vtk_to_numpy(array)[:, 0] = 0.9
        array.Modified()
        second = scene.rgba()
        np.testing.assert_allclose(second[..., 0], 0.9 * second[..., 3], atol=1e-6)
        np.testing.assert_allclose(second[..., 1:], first[..., 1:], atol=1e-6)
        prop.IndependentComponentsOn() # the first component through both functions
        third = scene.rgba()
        np.testing.assert_allclose(third[..., 1:3], 0.0, atol=1e-6)
        prop.IndependentComponentsOff()
        np.testing.assert_array_equal(scene.rgba(), second)
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))

    def test_an_opacity_array_takes_the_place_of_the_fourth_component(self):
        data = block(tuples(COLOR, 0.1, (N + 1) ** 3, np.float32))
        array = numpy_to_vtk(np.full((N + 1) ** 3, 1500.0), deep=True)
        array.SetName("opacity")
        data.GetPointData().AddArray(array)
        _, scene = pictures(data, given(((1000.0, 0.0), (2000.0, 1.0))))
        scene.mapper.SetOpacityArrayName("opacity")
        rgba = scene.rgba()
        exact = 1.0 - np.exp(-0.5 * paths(scene.renderer, 64, 64))
        self.assertLess(np.abs(rgba[..., 3] - exact).max(), FLOAT)
        self.assertLess(np.abs(rgba[..., :3] - exact[..., None] * COLOR).max(), FLOAT)
        self.assertEqual((scene.messages.errors, scene.messages.warnings), ([], []))

    def test_three_or_five_dependent_components_are_named(self):
        for count in (3, 5):
            scene = TetScene(block(np.full(((N + 1) ** 3, count), 0.5)), given(((0.0, 0.0), (1.0, 1.0))))
            scene.look(half=0.4)
            rgba = scene.rgba()
            self.assertEqual(len(scene.messages.warnings), 1)
            self.assertIn("%d components" % count, scene.messages.warnings[0])
            self.assertGreater(rgba[32, 32, 3], 0.3)

    def test_cells_are_still_selected(self):
        _, scene = pictures(block(tuples(COLOR, OPACITY, (N + 1) ** 3, np.uint8)), given(((0.0, 0.0), (255.0, 1.0)), 0.1))
        from vtkmodules.vtkRenderingCore import vtkHardwareSelector

        selector = vtkHardwareSelector()
        selector.SetRenderer(scene.renderer)
        selector.SetArea(30, 30, 33, 33)
        selector.SetFieldAssociation(vtkDataObject.FIELD_ASSOCIATION_CELLS)
        self.assertEqual(selector.Select().GetNumberOfNodes(), 1)

    def test_one_component_is_drawn_as_ever(self):
        scene = TetScene(cube(2), even(2.0))
        scene.look(OBLIQUE, half=1.0)
        first = scene.rgba()
        scene.volume.GetProperty().IndependentComponentsOff()
        np.testing.assert_array_equal(scene.rgba(), first)


class EvenInOpenGL(InOpenGL, Even):
    pass


class LinearInOpenGL(InOpenGL, Linear):
    pass


class ChoiceInOpenGL(InOpenGL, Choice):
    pass


class BothEngines(unittest.TestCase):
    def test_draw_the_same(self):
        n = 6
        points = lattice(n)
        for cells in (False, True):
            places = points[tetrahedra_of(n)].mean(axis=1) if cells else points
            x, y, z = places.T
            waves = (0.5 + 0.5 * np.sin(5.0 * x), 0.5 + 0.5 * np.sin(4.0 * y - x), z + 0.5)
            rgba = np.stack([*waves, 0.5 + 0.3 * np.sin(6.0 * x - 5.0 * z)], -1).astype(np.float32)
            for method in ("None", "Partial", "Full"):
                seen = []
                for engine in (InEachEngine.ENGINE, InOpenGL.ENGINE):
                    InEachEngine.now = engine
                    scene = TetScene(block(rgba, cells, n), given(((0.0, 0.0), (0.4, 0.1), (0.6, 1.0), (1.0, 0.2)), 0.2))
                    getattr(scene.mapper, "SetPreIntegrationTo" + method)()
                    scene.look(OBLIQUE, half=0.8, parallel=False)
                    seen.append(scene.rgba())
                difference = 255.0 * np.abs(seen[0] - seen[1])
                print(f"cells {cells}, {method}: mean {difference.mean():.5f}, most {difference.max():.4f} of 255")
                self.assertGreater(seen[0][..., 3].max(), 0.3)
                self.assertLess(difference.max(), 0.5) # psi by table and by quadrature, 2e-3


if __name__ == "__main__":
    unittest.main()
