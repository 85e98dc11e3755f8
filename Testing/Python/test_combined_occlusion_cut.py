# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: what is cropped, masked or blanked neither draws nor darkens."""
import unittest

import numpy as np
from each_engine import InEachEngine, InOpenGL, check_engine, new_mapper
from occlusion_scene import (
    Messages,
    Scene,
    ball,
    erode,
    float_image,
    image,
    marschner_lobb,
    sphere,
    square,
    visibility_image,
    volume_property,
)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkBitArray
from vtkmodules.vtkCommonDataModel import (
    vtkDataSetAttributes,
    vtkImageData,
    vtkPiecewiseFunction,
    vtkRectilinearGrid,
    vtkUniformGrid,
)
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

PLANES = (-0.35, 0.3, -0.4, 0.45, -0.3, 0.25)
ALL = 0x7FFFFFF
SETS = {"fence": 0x2EBFEBA, "inverted fence": 0x5140145, "cross": 0x0417410, "some": 0x1234567}


def cropped(data, flags, mapper, size=100, place=None, planes=PLANES, extra=None):
    """One frame of `data`, seen askew: the window's colours."""
    scene = Scene((size, size))
    volume, _ = scene.add_volume(data, volume_property(unit=0.1), mapper)
    if place:
        place(volume)
    mapper.CroppingOn()
    mapper.SetCroppingRegionPlanes(planes)
    mapper.SetCroppingRegionFlags(flags)
    if extra:
        extra(scene)
    scene.look((-0.5, -0.35, -0.8), half=1.6, parallel=False)
    scene.renderer.ResetCameraClippingRange(-2.0, 2.0, -2.0, 2.0, -2.0, 2.0)
    return scene.pixels()


def ours(strength=1.0, step=0.0):
    mapper = new_mapper()
    mapper.SetOcclusionStrength(strength)
    mapper.SetSampleDistance(step)
    return mapper


def peer(step):
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetSampleDistance(step)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.UseJitteringOff()
    return mapper


class Regions(InEachEngine):
    def test_they_are_cut_where_the_ray_caster_cuts_within_its_half_voxel(self):
        # The ray caster puts cuts up to half a voxel off, so the difference must halve with the voxel.
        def turn(volume):  # no scale: the ray caster corrects opacity for unscaled steps
            volume.RotateZ(20.0)
            volume.SetPosition(0.1, -0.05, 0.1)

        for name, flags in SETS.items():
            for place in (None, turn) if name == "some" else (None,):
                with self.subTest(regions=name, turned=place is not None):
                    means = []
                    for n in (40, 80):
                        data = marschner_lobb(n)
                        step = 0.2 * data.GetSpacing()[0]
                        a = cropped(data, flags, ours(0.0, step), place=place)
                        b = cropped(data, flags, peer(step), place=place)
                        inside = erode(b.max(axis=2) > 0, 2)
                        self.assertGreater(inside.sum(), 1000)
                        means.append(255.0 * np.abs(a - b).max(axis=2)[inside].mean())
                    self.assertLessEqual(means[1], 0.6 * means[0])

    def test_regions_of_transformed_volumes_lie_where_their_data_lie(self):
        values = marschner_lobb(32)
        reference = cropped(values, 0x1234567, ours())
        self.assertGreater((reference > 0.1).sum(), 2000)
        # the same picture from data that lie elsewhere, and a volume that brings them back
        shape = (32, 32, 32)
        array = vtk_to_numpy(values.GetPointData().GetScalars()).reshape(shape)
        h = values.GetSpacing()
        mirrored = image(array[:, :, ::-1], h)
        low, high = PLANES[:2]

        def mirror(volume):
            volume.SetScale(-1.0, 1.0, 1.0)

        # mirrored in x: planes and flags as well
        flags = 0
        for region in range(27):
            if 0x1234567 >> region & 1:
                flags |= 1 << (2 - region % 3 + region // 3 * 3)
        picture = cropped(mirrored, flags, ours(), place=mirror, planes=(-high, -low, *PLANES[2:]))
        self.assertLessEqual(np.rint(255.0 * np.abs(picture - reference)).max(), 1)  # positions in float
        shifted = image(array, [2.0 * s for s in h])

        def shrink(volume):
            volume.SetScale(0.5)

        picture = cropped(shifted, 0x1234567, ours(), place=shrink, planes=[2.0 * p for p in PLANES])
        self.assertLessEqual(np.rint(255.0 * np.abs(picture - reference)).max(), 1)

    def test_what_is_cropped_darkens_nothing(self):
        # the third beyond x = 0 (voxel 10 of 21) taken away: as the image that ends there
        values = ball(21, 0.45)
        pictures = []
        for data, flags in ((values, 0x7FFFFFF & ~sum(1 << r for r in range(27) if r % 3 == 2)),
                            (values[:, :, :11], ALL)):
            scene = Scene((120, 120))
            _, mapper = scene.add_volume(
                image(data, (0.05,) * 3, [-0.5, -0.5, -0.5]), volume_property(1.0, 0.8, 0.05), ours()
            )
            mapper.CroppingOn()
            mapper.SetCroppingRegionPlanes(-0.25, 0.0, -0.1, 0.1, -0.1, 0.1)
            mapper.SetCroppingRegionFlags(flags)
            scene.renderer.AddActor(square(0.7, -0.6))
            scene.look(half=0.8)
            scene.window.Render()
            pictures.append((float_image(mapper), visibility_image(mapper)))
        self.assertLess(pictures[0][1].min(), 0.9)
        for a, b in zip(*pictures):
            self.assertLessEqual(255.0 * np.abs(a - b).max(), 0.1)  # positions in float

    def test_nothing_left_leaves_the_geometry_shaded_and_says_nothing(self):
        mapper = ours()
        messages = Messages(mapper)
        picture = cropped(
            marschner_lobb(24), 0, mapper, extra=lambda scene: scene.renderer.AddActor(sphere(0.3))
        )
        self.assertEqual((messages.errors, messages.warnings), ([], []))
        self.assertGreater(picture.max(), 0.95)
        self.assertEqual(mapper.GetNumberOfSamples(), 0)

    def test_planes_that_are_not_finite_are_named(self):
        mapper = ours()
        messages = Messages(mapper)
        cropped(marschner_lobb(24), 0x1234567, mapper, planes=(0.0, np.nan, 0.0, 1.0, 0.0, 1.0))
        self.assertEqual(len(messages.errors), 1)
        self.assertIn("cropping region plane", messages.errors[0])


def seen(data, mapper, prop=None, size=100, extra=None, direction=(-0.5, -0.35, -0.8)):
    """One frame of `data`: float image, visibility of geometry, the window's colours."""
    scene = Scene((size, size))
    scene.add_volume(data, prop or volume_property(unit=0.1), mapper)
    if extra:
        extra(scene)
    scene.look(direction, half=1.6, parallel=False)
    scene.renderer.ResetCameraClippingRange(-2.0, 2.0, -2.0, 2.0, -2.0, 2.0)
    pixels = scene.pixels()
    if isinstance(mapper, vtkChiCombinedOcclusionVolumeMapper):
        check_engine(mapper)
        return float_image(mapper), visibility_image(mapper), pixels
    return None, None, pixels


def binary(values, cells=False):
    return image(np.asarray(values, np.uint8), cells=cells)


def wedge(n):
    """A mask[z, y, x] without symmetry."""
    z, y, x = np.meshgrid(*[np.linspace(-1.0, 1.0, n)] * 3, indexing="ij")
    return (x + 0.5 * y < 0.2) & (z - 0.3 * x > -0.6)


class Masks(InEachEngine):
    def masked(self, mapper, mask):
        mapper.SetMaskInput(mask)
        mapper.SetMaskTypeToBinary()
        return mapper

    def test_a_binary_mask_equals_the_ray_casters(self):
        data = marschner_lobb(40)
        step = 0.1 * data.GetSpacing()[0]
        mask = binary(wedge(40))
        a = seen(data, self.masked(ours(0.0, step), mask))[2]
        b = seen(data, self.masked(peer(step), mask))[2]
        inside = erode(b.max(axis=2) > 0, 2)
        self.assertGreater(inside.sum(), 1000)
        difference = 255.0 * np.abs(a - b).max(axis=2)[inside]
        # the bounds of the unshaded picture; the peer's segments count as their samples do
        self.assertLessEqual(difference.mean(), 1.0)
        self.assertLessEqual(np.percentile(difference, 99.0), 2.0)

    def test_a_mask_around_a_box_of_voxels_is_that_box_cropped(self):
        data = marschner_lobb(33)
        h = data.GetSpacing()[0]
        values = np.full((33, 33, 33), 3)
        values[8:20, 5:26, 10:31] = 0
        edges = [-1.0 + (i - 0.5) * h for i in (10, 31, 5, 26, 8, 20)]
        a = seen(data, self.masked(ours(), binary(values)))[0]
        cut = ours()
        cut.CroppingOn()
        cut.SetCroppingRegionPlanes(edges)
        cut.SetCroppingRegionFlags(ALL & ~(1 << 13))
        b = seen(data, cut)[0]
        self.assertGreater(np.abs(seen(data, ours())[0] - a).max(), 0.1)
        self.assertLessEqual(255.0 * np.abs(a - b).max(), 0.1)  # positions in float

    def test_what_is_masked_darkens_nothing(self):
        # of cells with nearest interpolation: the cut data ends at the very same faces
        values = np.round(10.0 * ball(24, 0.45))
        prop = volume_property(10.0, 0.8, 0.05)
        prop.SetInterpolationTypeToNearest()
        pictures = []
        for data, mask in (
            (values, np.arange(24)[None, None, :] < np.full((24, 24, 1), 13)),
            (values[:, :, :13], None),
        ):
            scene = Scene((120, 120))
            _, mapper = scene.add_volume(
                image(data.astype(np.float32), (0.05,) * 3, [-0.6, -0.6, -0.6], cells=True), prop, ours()
            )
            if mask is not None:
                self.masked(mapper, binary(mask, cells=True))
            scene.renderer.AddActor(square(0.7, -0.7))
            scene.look(half=0.8)
            scene.window.Render()
            pictures.append((float_image(mapper), visibility_image(mapper)))
        self.assertLess(pictures[0][1].min(), 0.9)
        for a, b in zip(*pictures):
            self.assertLessEqual(255.0 * np.abs(a - b).max(), 0.1)  # positions in float

    def test_masks_of_every_kind_of_array_and_of_points_for_cells(self):
        n = 20
        values = wedge(n)
        prop = volume_property(unit=0.1)
        data = image(ball(n), (0.1,) * 3)
        expected = seen(data, self.masked(ours(), binary(values)), prop)[0]
        self.assertGreater(expected[..., 3].max(), 0.2)
        for dtype in (np.int8, np.uint16, np.int32, np.float32, np.float64):
            mask = image(values.astype(dtype) * 5)
            self.assertEqual(np.abs(seen(data, self.masked(ours(), mask), prop)[0] - expected).max(), 0.0)
        mask = binary(values)
        bits = vtkBitArray()
        bits.SetNumberOfTuples(n**3)
        for i, value in enumerate(values.ravel()):
            bits.SetValue(i, int(value))
        mask.GetPointData().SetScalars(bits)
        self.assertEqual(np.abs(seen(data, self.masked(ours(), mask), prop)[0] - expected).max(), 0.0)
        cells = image(ball(n), (0.1,) * 3, cells=True)
        a, b = (
            seen(cells, self.masked(ours(), m), prop)[0] for m in (binary(values), binary(values, cells=True))
        )
        self.assertEqual(np.abs(a - b).max(), 0.0)

    def test_masks_that_do_not_fit_are_named(self):
        def add(scene):
            scene.renderer.AddActor(sphere(0.3))

        empty = vtkImageData()
        empty.SetDimensions(24, 24, 24)
        for mask, words in ((binary(np.ones((24, 24, 23))), "23 x 24 x 24"), (empty, "no scalars")):
            mapper = self.masked(ours(), mask)
            messages = Messages(mapper)
            picture, _, _ = seen(marschner_lobb(24), mapper, extra=add)
            self.assertEqual(len(messages.errors), 1)
            self.assertIn("the mask", messages.errors[0])
            self.assertIn(words, messages.errors[0])
            self.assertGreater(picture[..., 3].max(), 0.99)  # the geometry is still there
            mapper.SetMaskInput(None)
            picture, _, _ = seen(marschner_lobb(24), mapper)
            self.assertGreater(picture[..., 3].max(), 0.5)

    def test_everything_masked_leaves_the_geometry_shaded_and_says_nothing(self):
        mapper = self.masked(ours(), binary(np.zeros((24, 24, 24))))
        messages = Messages(mapper)
        _, _, pixels = seen(
            marschner_lobb(24), mapper, extra=lambda scene: scene.renderer.AddActor(sphere(0.3))
        )
        self.assertEqual((messages.errors, messages.warnings), ([], []))
        self.assertGreater(pixels.max(), 0.95)
        self.assertEqual(mapper.GetNumberOfSamples(), 0)

    def test_a_mask_that_changes_is_drawn_anew(self):
        mask = binary(np.ones((24, 24, 24)))
        mapper = self.masked(ours(), mask)
        scene = Scene((80, 80))
        scene.add_volume(marschner_lobb(24), volume_property(unit=0.1), mapper)
        scene.look(half=1.6)
        before = scene.pixels()
        scene.pixels()
        self.assertTrue(mapper.GetReusedLastFrame())
        mask.GetPointData().GetScalars().Fill(0)
        mask.GetPointData().GetScalars().Modified()
        self.assertGreater(before.max() - scene.pixels().max(), 0.3)


class Labels(InEachEngine):
    def label(self, prop, label, rgb=None, opacity=None):
        if rgb:
            color = vtkColorTransferFunction()
            color.AddRGBPoint(0.0, *rgb)
            color.AddRGBPoint(1.0, *rgb)
            prop.SetLabelColor(label, color)
        if opacity:
            ramp = vtkPiecewiseFunction()
            for place, value in opacity:
                ramp.AddPoint(place, value)
            prop.SetLabelScalarOpacity(label, ramp)

    def prop(self, unit):
        prop = volume_property(1.0, 0.02, unit)
        self.label(prop, 1, (0.1, 1.0, 0.2), ((0.0, 0.0), (1.0, 0.05)))
        self.label(prop, 2, (1.0, 0.2, 0.2))
        return prop

    def labels(self, n):
        return np.where(wedge(n), 1, 0) + 2 * (~wedge(n) & (np.arange(n)[None, :, None] > n / 2))

    def test_labels_choose_the_functions_that_the_ray_caster_chooses(self):
        n = 40
        data = marschner_lobb(n)
        # the ray caster takes the opacity of labels a sample, uncorrected: one unit distance a sample
        step = 0.1 * data.GetSpacing()[0]
        pictures = []
        for mapper in (ours(0.0, step), peer(step)):
            mapper.SetMaskInput(image(self.labels(n).astype(np.uint8)))
            mapper.SetMaskTypeToLabelMap()
            pictures.append(seen(data, mapper, self.prop(step))[2])
        inside = erode(pictures[1].max(axis=2) > 0, 2)
        self.assertGreater(inside.sum(), 1000)
        self.assertGreater(np.abs(pictures[0][..., 0] - pictures[0][..., 1])[inside].max(), 0.3)
        difference = 255.0 * np.abs(pictures[0] - pictures[1]).max(axis=2)[inside]
        # slices are a step along the view axis, the ray caster's samples along the ray: up to 1 / cos 15
        # degrees, 3.5 %, of its uncorrected opacity
        self.assertLessEqual(difference.mean(), 3.0)

    def test_a_label_everywhere_is_a_volume_with_its_functions(self):
        data = marschner_lobb(24)
        prop = self.prop(0.1)
        for label in (0, 1, 2, 3):
            with self.subTest(label=label):
                mapper = ours()
                messages = Messages(mapper)
                mapper.SetMaskInput(image(np.full((24, 24, 24), label, np.uint16)))
                picture = seen(data, mapper, prop)[0]
                self.assertEqual((messages.errors, messages.warnings), ([], []))
                plain = volume_property(1.0, 0.02, 0.1)
                if label in (1, 2):
                    plain.SetColor(prop.GetLabelColor(label))
                if label == 1:
                    plain.SetScalarOpacity(prop.GetLabelScalarOpacity(1))
                expected = seen(data, ours(), plain)[0]
                self.assertGreater(expected[..., 3].max(), 0.1)
                # table positions of up to 3 x 4097 entries are floats
                self.assertLessEqual(255.0 * np.abs(picture - expected).max(), 0.1)

    def test_the_blend_factor_goes_from_the_volumes_functions_to_the_labels(self):
        data = marschner_lobb(24)
        prop = self.prop(0.1)
        means = []
        for factor in (0.0, 0.5, 1.0):
            mapper = ours()
            mapper.SetMaskInput(image(np.ones((24, 24, 24), np.uint8)))
            mapper.SetMaskBlendFactor(factor)
            means.append(seen(data, mapper, prop)[0][..., 3].mean())
        plain = seen(data, ours(), volume_property(1.0, 0.02, 0.1))[0][..., 3].mean()
        self.assertEqual(means[0], plain)
        self.assertTrue(means[0] < means[1] < means[2])

    def test_labels_all_transparent_leave_the_geometry_shaded_and_say_nothing(self):
        prop = volume_property(1.0, 0.3, 0.1)
        self.label(prop, 5, None, ((0.0, 0.0), (1.0, 0.0)))
        mapper = ours()
        messages = Messages(mapper)
        mapper.SetMaskInput(image(np.full((24, 24, 24), 5, np.uint8)))
        _, _, pixels = seen(
            marschner_lobb(24), mapper, prop, extra=lambda scene: scene.renderer.AddActor(sphere(0.3))
        )
        self.assertEqual((messages.errors, messages.warnings), ([], []))
        self.assertGreater(pixels.max(), 0.95)
        self.assertEqual(mapper.GetNumberOfSamples(), 0)

    def test_functions_of_labels_reach_beyond_those_of_the_volume(self):
        values = np.full((16, 16, 16), 50.0, np.float32)
        values[4, 4, 4] = 0.0
        prop = volume_property(1.0, 0.0, 0.1)  # the volume's own end at 1
        self.label(prop, 1, (1.0, 1.0, 1.0), ((0.0, 0.0), (49.0, 0.0), (50.0, 0.5), (51.0, 0.0)))
        mapper = ours()
        mapper.SetMaskInput(image(np.ones((16, 16, 16), np.uint8)))
        self.assertGreater(seen(image(values, (0.1,) * 3), mapper, prop)[0][..., 3].max(), 0.9)

    def test_functions_that_change_are_drawn_anew_and_gradient_opacity_of_labels_is_named(self):
        data = marschner_lobb(24)
        prop = self.prop(0.1)
        mapper = ours()
        messages = Messages(mapper)
        mapper.SetMaskInput(image(np.ones((24, 24, 24), np.uint8)))
        scene = Scene((80, 80))
        scene.add_volume(data, prop, mapper)
        scene.look(half=1.6)
        before = scene.pixels()
        scene.pixels()
        self.assertTrue(mapper.GetReusedLastFrame())
        prop.GetLabelScalarOpacity(1).AddPoint(1.0, 0.9)
        self.assertGreater(np.abs(scene.pixels() - before).max(), 0.2)
        self.assertEqual(messages.warnings, [])
        gradient = vtkPiecewiseFunction()
        gradient.AddPoint(0.0, 1.0)
        prop.SetLabelGradientOpacity(1, gradient)
        scene.pixels()
        self.assertEqual(len(messages.warnings), 1)
        self.assertIn("gradient opacity of labels", messages.warnings[0])

    def test_label_volumes_under_nearest_interpolation_do_not_blend(self):
        # labels 1 and 3 side by side; 2, green, is nowhere
        values = np.where(np.arange(16)[:, None, None] % 2, 1.0, 3.0) * np.ones((16, 16, 16))
        prop = volume_property(
            4.0, 0.3, 0.1, ((0.0, (0, 0, 0)), (0.25, (1, 0, 0)), (0.5, (0, 1, 0)), (0.75, (0, 0, 1)), (1.0, (0, 0, 0)))
        )
        prop.SetInterpolationTypeToNearest()
        for dtype in (np.uint8, np.int16, np.float32):
            picture = seen(image(values.astype(dtype), (0.1,) * 3), ours(0.0), prop)[0]
            self.assertGreater(picture[..., 0].max(), 0.1)
            self.assertGreater(picture[..., 2].max(), 0.1)
            self.assertEqual(picture[..., 1].max(), 0.0)


class Blanking(InEachEngine):
    def grid(self, values, cells=False):
        grid = vtkUniformGrid()
        grid.ShallowCopy(image(np.asarray(values, np.float32), (0.1,) * 3, cells=cells))
        return grid

    def test_blanked_cells_and_the_cells_of_blanked_points_are_those_that_vtk_hides(self):
        n = 12
        rng = np.random.default_rng(4)
        values = 0.5 + 0.5 * rng.random((n, n, n))
        for cells in (False, True):
            with self.subTest(cells=cells):
                grid = self.grid(values, cells)
                for i in rng.integers(0, grid.GetNumberOfPoints(), 20):
                    grid.BlankPoint(int(i))
                for i in rng.integers(0, grid.GetNumberOfCells(), 200):
                    grid.BlankCell(int(i))
                visible = np.array([grid.IsCellVisible(i) for i in range(grid.GetNumberOfCells())])
                self.assertGreater(visible.sum(), 100)
                mapper = ours()
                messages = Messages(mapper)
                picture = seen(grid, mapper)[0]
                self.assertEqual((messages.errors, messages.warnings), ([], []))
                # the same from cells that are hidden by hand, and, of cells, from a mask
                plain = self.grid(values, cells)
                ghosts = numpy_to_vtk(
                    np.where(visible, 0, vtkDataSetAttributes.HIDDENCELL).astype(np.uint8), deep=True
                )
                ghosts.SetName(vtkDataSetAttributes.GhostArrayName())
                plain.GetCellData().AddArray(ghosts)
                self.assertEqual(np.abs(seen(plain, ours())[0] - picture).max(), 0.0)
                self.assertGreater(np.abs(seen(self.grid(values, cells), ours())[0] - picture).max(), 0.1)
                if cells:
                    masked = ours()
                    masked.SetMaskTypeToBinary()
                    masked.SetMaskInput(binary(visible.reshape(n, n, n), cells=True))
                    self.assertEqual(np.abs(seen(self.grid(values, True), masked)[0] - picture).max(), 0.0)

    def test_duplicate_cells_are_left_to_their_owner_and_duplicate_points_are_not(self):
        values = np.ones((12, 12, 12))
        grid = self.grid(values)
        whole = seen(grid, ours())[0]
        points = numpy_to_vtk(np.full(12**3, vtkDataSetAttributes.DUPLICATEPOINT, np.uint8), deep=True)
        points.SetName(vtkDataSetAttributes.GhostArrayName())
        grid.GetPointData().AddArray(points)
        # a few roundings of ends of segments, which are counted from other places where there may be cuts
        self.assertLessEqual(np.abs(seen(grid, ours())[0] - whole).max(), 2.0**-20)
        flags = np.zeros((11, 11, 11), np.uint8)
        flags[:, :, 6:] = vtkDataSetAttributes.DUPLICATECELL
        cells = numpy_to_vtk(flags.ravel(), deep=True)
        cells.SetName(vtkDataSetAttributes.GhostArrayName())
        grid.GetCellData().AddArray(cells)
        half = seen(grid, ours(), direction=(0, 0, -1))[0]
        # the same picture as of the image that ends there
        origin = [-0.5 * 11 * 0.1] * 3
        ends = image(values[:, :, :7].astype(np.float32), (0.1,) * 3, origin)
        ends = seen(ends, ours(), direction=(0, 0, -1))[0]
        self.assertLessEqual(255.0 * np.abs(half - ends).max(), 0.1)  # positions in float
        self.assertGreater(half.max(), 0.3)

    def test_an_amr_block_whose_cells_are_all_refined_draws_nothing(self):
        grid = self.grid(np.ones((12, 12, 12)))
        cells = numpy_to_vtk(np.full(11**3, vtkDataSetAttributes.REFINEDCELL, np.uint8), deep=True)
        cells.SetName(vtkDataSetAttributes.GhostArrayName())
        grid.GetCellData().AddArray(cells)
        mapper = ours()
        messages = Messages(mapper)
        self.assertEqual(seen(grid, mapper)[0].max(), 0.0)
        self.assertEqual((messages.errors, messages.warnings), ([], []))

    def test_blanking_of_a_resampled_grid_is_named(self):
        grid = vtkRectilinearGrid()
        grid.SetDimensions(8, 8, 8)
        for axis in "XYZ":
            getattr(grid, f"Set{axis}Coordinates")(numpy_to_vtk(np.linspace(-1.0, 1.0, 8) ** 3, deep=True))
        scalars = numpy_to_vtk(np.ones(512, np.float32), deep=True)
        scalars.SetName("ones")
        grid.GetPointData().SetScalars(scalars)
        grid.AllocatePointGhostArray()
        mapper = ours()
        messages = Messages(mapper)
        self.assertGreater(seen(grid, mapper)[0].max(), 0.1)
        self.assertEqual(len([w for w in messages.warnings if "masks and blanking" in w]), 1)


class RegionsInOpenGL(InOpenGL, Regions):
    pass


class MasksInOpenGL(InOpenGL, Masks):
    pass


class LabelsInOpenGL(InOpenGL, Labels):
    pass


class BlankingInOpenGL(InOpenGL, Blanking):
    pass


if __name__ == "__main__":
    unittest.main()
