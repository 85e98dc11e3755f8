# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine cuts what the CPU engine cuts."""
import unittest

import numpy as np
from engine_agreement import CPU, N, OPENGL, Agreement, fog, render, shells, soft_ball, tubes, veiled_tubes
from engine_contents import lit, nearest
from occlusion_scene import ball, cube, image, volume_property
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkPiecewiseFunction, vtkPlane, vtkUniformGrid
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

PLANES = (-0.35, 0.3, -0.4, 0.45, -0.3, 0.25)
ALL = 0x7FFFFFF
SETS = {"subvolume": 0x0002000, "fence": 0x2EBFEBA, "inverted fence": 0x5140145, "cross": 0x0417410, "some": 0x1234567}


def crop(regions, planes=PLANES, more=None):
    """A setup of the mapper that leaves these regions."""

    def setup(mapper):
        mapper.CroppingOn()
        mapper.SetCroppingRegionPlanes(planes)
        mapper.SetCroppingRegionFlags(regions)
        if more:
            more(mapper)

    return setup


def no_setup(mapper):
    """What `without` takes to leave a setup out."""


def cells():
    """A turned grid of cells."""
    data = image(ball(N, soft=0.4), (0.06, 0.05, 0.07), cells=True)
    data.SetDirectionMatrix(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1)
    return data, volume_property(1.0, 0.4, 0.1)


class Cuts(Agreement):
    LEAST = 100  # pixels: a region alone is a third of the cube

    def check_cut(self, content, setup, **options):
        without = {"setup": options.pop("uncut", no_setup)}
        return self.check(content, setup=setup, darkens=False, without=without, **options)


class Cropping(Cuts):
    def test_sets_of_regions_in_both_projections_with_and_without_geometry(self):
        for name, regions in SETS.items():
            for content in (fog, shells):
                for parallel in (False, True):
                    for geometry in (None, tubes):
                        with self.subTest(name, content=content.__name__, parallel=parallel, geometry=geometry):
                            self.check_cut(content, crop(regions), parallel=parallel, geometry=geometry)

    def test_each_of_the_27_regions_alone(self):
        planes = (-0.33, 0.33, -0.33, 0.33, -0.33, 0.33)
        dense = lambda: (cube(np.ones((N, N, N)), 2.0), volume_property(1.0, 0.5, 0.1))  # noqa: E731
        seen = []
        for region in range(27):
            with self.subTest(region=region):
                picture = self.check_cut(dense, crop(1 << region, planes))
                alpha = picture[..., 3]
                rows, columns = np.nonzero(alpha > 0.05)
                seen.append((rows.mean(), columns.mean(), alpha.sum()))
        self.assertEqual(len({tuple(np.round(s, 2)) for s in seen}), 27)  # no two look alike

    def test_all_regions_and_none(self):
        for engine in (CPU, OPENGL):
            whole = render(engine, fog)[0]
            np.testing.assert_array_equal(render(engine, fog, crop(ALL))[0], whole)
            picture, _, mapper = render(engine, fog, crop(0), geometry=tubes)
            self.assertEqual((mapper.GetEngineInUse(), mapper.GetNumberOfSamples()), (engine, 0))
            self.assertGreater(picture[..., 3].max(), 0.99)  # the geometry

    def test_planes_in_any_order_and_on_each_other(self):
        for planes in ((0.3, -0.35, 0.45, -0.4, 0.25, -0.3), (0.0, 0.0, -0.4, 0.45, 0.1, 0.1), (-5, 5, -5, 0.2, 0.1, 5)):
            with self.subTest(planes=planes):
                self.check_cut(fog, crop(SETS["some"], planes))

    def test_nearest_samples_and_cells(self):
        for content in (nearest(fog), cells, nearest(cells)):
            self.check_cut(content, crop(SETS["some"]))

    def test_with_clipping_planes_and_shading(self):
        def clip(mapper):
            plane = vtkPlane()
            plane.SetNormal(0.6, 0.3, -1.0)
            plane.SetOrigin(0.1, 0.0, 0.3)
            mapper.AddClippingPlane(plane)

        for content in (shells, lit(soft_ball), nearest(lit(soft_ball))):
            self.check_cut(content, crop(SETS["some"], more=clip), uncut=clip)

    def test_slices_closer_and_wider_than_a_voxel_and_without_skipping(self):
        for factor in (0.3, 1.7, 3.1):
            with self.subTest(factor=factor):
                step = lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1))  # noqa: E731
                self.check_cut(fog, crop(SETS["some"], more=step), uncut=step)
        self.check_cut(shells, crop(SETS["fence"], more=lambda mapper: mapper.SkippingOff()))

    def test_with_translucent_layers(self):
        for parallel in (False, True):
            self.check_cut(fog, crop(SETS["some"]), geometry=veiled_tubes, parallel=parallel)


def wedge(shape=(N, N, N)):
    """A mask[z, y, x] without symmetry."""
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in shape), indexing="ij")
    return (x + 0.5 * y < 0.3) & (z - 0.3 * x > -0.6)


def checkers(edge=3):
    """A mask of blocks, each other one."""
    k, j, i = np.meshgrid(*(np.arange(N) // edge,) * 3, indexing="ij")
    return (i + j + k) % 2


def mask(values, cells=False, more=None):
    """A setup of the mapper that leaves the voxels whose value is positive."""

    def setup(mapper):
        mapper.SetMaskTypeToBinary()
        mapper.SetMaskInput(image(np.asarray(values, np.uint8), cells=cells))
        if more:
            more(mapper)

    return setup


def blank(content, points=0, cells=0):
    """The same of a grid of which some points, and some cells, are hidden."""

    def make():
        data, prop = content()
        grid = vtkUniformGrid()
        grid.ShallowCopy(data)
        rng = np.random.default_rng(4)
        for attributes, count, share, flag in (
            (grid.GetPointData(), grid.GetNumberOfPoints(), points, vtkDataSetAttributes.HIDDENPOINT),
            (grid.GetCellData(), grid.GetNumberOfCells(), cells, vtkDataSetAttributes.HIDDENCELL),
        ):
            if share:
                # in runs, as blocks that are refined are
                hidden = np.repeat(rng.random(count // 7 + 1) < share, 7)[:count]
                ghosts = numpy_to_vtk(np.where(hidden, flag, 0).astype(np.uint8), deep=True)
                ghosts.SetName(vtkDataSetAttributes.GhostArrayName())
                attributes.AddArray(ghosts)
        return grid, prop

    return make


class Masks(Cuts):
    def test_masks_in_both_projections_with_and_without_geometry(self):
        for name, values in (("wedge", wedge()), ("checkers", checkers()), ("voxels", checkers(1))):
            for content in (fog, shells):
                for parallel in (False, True):
                    for geometry in (None, tubes):
                        with self.subTest(name, content=content.__name__, parallel=parallel, geometry=geometry):
                            self.check_cut(content, mask(values), parallel=parallel, geometry=geometry)

    def test_masks_of_cells_and_of_nearest_samples(self):
        for content in (cells, nearest(cells)):
            self.check_cut(content, mask(wedge(), cells=True))
        self.check_cut(nearest(fog), mask(checkers()))

    def test_blanked_points_and_cells(self):
        for content in (fog, shells, cells):
            for points, hidden in ((0.02, 0.0), (0.0, 0.3), (0.02, 0.2)):
                with self.subTest(content=content.__name__, points=points, cells=hidden):
                    self.check(
                        blank(content, points, hidden),
                        geometry=tubes,
                        darkens=False,
                        without={"content": content},
                    )

    def test_masks_regions_and_blanking_together(self):
        for parallel in (False, True):
            self.check_cut(
                blank(fog, 0.01, 0.1),
                mask(checkers(5), more=crop(SETS["fence"])),
                uncut=crop(SETS["fence"]),
                parallel=parallel,
                geometry=tubes,
            )
            self.check_cut(
                blank(shells, 0.01, 0.1),
                mask(wedge(), more=crop(SETS["fence"])),
                uncut=mask(wedge()),
                parallel=parallel,
            )

    def test_shading_gradients_and_translucent_layers(self):
        for content in (lit(fog), lit(soft_ball), nearest(lit(soft_ball))):
            self.check_cut(content, mask(wedge()), geometry=veiled_tubes)

    def test_slices_closer_and_wider_than_a_voxel_and_without_skipping(self):
        """Wider than two, both engines miss the same voxels."""
        for factor in (0.3, 1.7, 3.1):
            with self.subTest(factor=factor):
                step = lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1))  # noqa: E731
                self.check_cut(fog, mask(checkers(), more=step), uncut=step)
        self.check_cut(shells, mask(checkers(), more=lambda mapper: mapper.SkippingOff()))

    def test_volumes_of_odd_sizes(self):
        """Cells that fill no whole word of bits, or a single one."""
        for shape in ((5, 7, 3), (2, 2, 2), (33, 9, 17)):

            def content():
                return image(np.ones(shape, np.uint8), [1.8 / n for n in shape[::-1]]), volume_property(1.0, 0.4, 0.1)

            with self.subTest(shape=shape):
                self.check_cut(content, mask(np.arange(np.prod(shape)).reshape(shape) % 3))

    def test_nothing_left(self):
        picture, _, mapper = render(OPENGL, fog, mask(np.zeros((N, N, N))), geometry=tubes)
        self.assertEqual((mapper.GetEngineInUse(), mapper.GetNumberOfSamples()), (OPENGL, 0))
        self.assertGreater(picture[..., 3].max(), 0.99)  # the geometry


def label(prop, number, rgb=None, opacity=None):
    """Functions of a label, over 0 ... 255: one colour, an opacity that ends as high."""
    if rgb:
        color = vtkColorTransferFunction()
        color.AddRGBPoint(0.0, *rgb)
        color.AddRGBPoint(255.0, *rgb)
        prop.SetLabelColor(number, color)
    if opacity:
        ramp = vtkPiecewiseFunction()
        ramp.AddPoint(0.0, 0.0)
        ramp.AddPoint(255.0, opacity)
        prop.SetLabelScalarOpacity(number, ramp)


def labelled(content=fog, opacity=0.7):
    """The same with functions of labels 1 and 2."""

    def make():
        data, prop = content()
        label(prop, 1, (0.1, 1.0, 0.2), opacity)
        label(prop, 2, (1.0, 0.2, 0.2))
        return data, prop

    return make


def labels(values, more=None, factor=1.0):
    """A setup of the mapper with a label of every voxel."""

    def setup(mapper):
        mapper.SetMaskTypeToLabelMap()
        mapper.SetMaskBlendFactor(factor)
        mapper.SetMaskInput(image(np.asarray(values, np.uint8)))
        if more:
            more(mapper)

    return setup


ORGANS = wedge() + 2 * (~wedge() & (np.arange(N)[None, :, None] > N / 2))


class Labels(Cuts):
    def test_labels_in_both_projections_with_and_without_geometry(self):
        for name, values in (("organs", ORGANS), ("checkers", checkers()), ("voxels", checkers(1))):
            for parallel in (False, True):
                for geometry in (None, tubes):
                    with self.subTest(name, parallel=parallel, geometry=geometry):
                        self.check_cut(labelled(), labels(values), parallel=parallel, geometry=geometry)

    def test_nearest_samples_shading_and_the_blend_factor(self):
        for content in (nearest(labelled()), lit(labelled()), nearest(lit(labelled()))):
            self.check_cut(content, labels(ORGANS))
        self.check_cut(labelled(), labels(ORGANS, factor=0.5), uncut=labels(ORGANS, factor=0.0))

    def test_labels_beside_cuts_of_both_kinds(self):
        content = blank(labelled(), 0.01, 0.1)
        more = crop(SETS["fence"])
        self.check_cut(content, labels(ORGANS, more), uncut=more, geometry=tubes)
        self.check_cut(content, labels(ORGANS, more), uncut=labels(ORGANS), geometry=tubes)

    def test_many_labels(self):
        """Tables one after the other fill many rows of their textures."""

        def content():
            data, prop = fog()
            for number in range(1, 200):
                label(prop, number, (number / 200.0, 1.0 - number / 200.0, 0.5 * (number % 3)), 0.2 + 0.5 * (number % 2))
            return data, prop

        self.check_cut(content, labels(np.arange(N**3).reshape(N, N, N) // 70 % 200))

    def test_slices_closer_and_wider_than_a_voxel_and_without_skipping(self):
        for factor in (0.3, 1.7):
            with self.subTest(factor=factor):
                step = lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1))  # noqa: E731
                self.check_cut(labelled(), labels(ORGANS, step), uncut=step)
        self.check_cut(labelled(), labels(ORGANS, lambda mapper: mapper.SkippingOff()))


class Changes(Agreement):
    def test_regions_masks_and_labels(self):
        def edits(scene, mapper, data, prop):
            cut = image(wedge().astype(np.uint8))

            def edit():
                cut.GetPointData().GetScalars().DeepCopy(numpy_to_vtk(checkers(6).astype(np.uint8).ravel(), deep=True))
                cut.GetPointData().GetScalars().Modified()
                cut.Modified()

            return (
                lambda: crop(SETS["some"])(mapper),
                lambda: mapper.SetCroppingRegionPlanes(-0.6, 0.3, -0.4, 0.6, -0.3, 0.5),
                lambda: mapper.SetCroppingRegionFlags(SETS["fence"]),
                lambda: mapper.CroppingOff(),
                lambda: (mapper.SetMaskInput(cut), mapper.SetMaskTypeToBinary()),
                edit,
                lambda: mapper.SetMaskTypeToLabelMap(),
                lambda: label(prop, 1, (1.0, 0.0, 1.0), 0.9),
                lambda: mapper.SetMaskInput(None),
            )

        self.check_edits(labelled(), edits)


if __name__ == "__main__":
    unittest.main()
