# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine cuts what the CPU engine cuts."""
import unittest

import numpy as np
from engine_agreement import CPU, N, OPENGL, Agreement, fog, render, shells, soft_ball, tubes
from occlusion_scene import Scene, ball, cube, image, square, volume_property
from vtkmodules.vtkCommonDataModel import vtkPlane

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

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


def nearest(content):
    """The same with nearest samples."""

    def make():
        data, prop = content()
        prop.SetInterpolationTypeToNearest()
        return data, prop

    return make


def shaded(content):
    """The same, shaded by gradients."""

    def make():
        data, prop = content()
        prop.ShadeOn()
        prop.SetAmbient(0.2)
        prop.SetDiffuse(0.7)
        prop.SetSpecular(0.5)
        prop.SetSpecularPower(12.0)
        return data, prop

    return make


class Cropping(Agreement):
    LEAST = 100  # a region alone is a third of the cube

    def check_cut(self, content, setup, **options):
        without = {"setup": options.pop("uncut", no_setup)}
        return self.check(content, setup=setup, darkens=False, without=without, **options)

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
        def cells():
            data = image(ball(N, soft=0.4), (0.06, 0.05, 0.07), cells=True)
            data.SetDirectionMatrix(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1)
            return data, volume_property(1.0, 0.4, 0.1)

        for content in (nearest(fog), cells, nearest(cells)):
            self.check_cut(content, crop(SETS["some"]))

    def test_with_clipping_planes_and_shading(self):
        def clip(mapper):
            plane = vtkPlane()
            plane.SetNormal(0.6, 0.3, -1.0)
            plane.SetOrigin(0.1, 0.0, 0.3)
            mapper.AddClippingPlane(plane)

        for content in (shells, shaded(soft_ball), nearest(shaded(soft_ball))):
            self.check_cut(content, crop(SETS["some"], more=clip), uncut=clip)

    def test_slices_closer_and_wider_than_a_voxel_and_without_skipping(self):
        for factor in (0.3, 1.7, 3.1):
            with self.subTest(factor=factor):
                step = lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1))  # noqa: E731
                self.check_cut(fog, crop(SETS["some"], more=step), uncut=step)
        self.check_cut(shells, crop(SETS["fence"], more=lambda mapper: mapper.SkippingOff()))

    def test_with_translucent_layers(self):
        def veils(scene):
            tubes(scene)
            for z in (-0.31, 0.02, 0.3):
                veil = square(0.8, z, color=(0.3, 0.9, 0.5))
                veil.GetProperty().SetOpacity(0.4)
                scene.renderer.AddActor(veil)

        for parallel in (False, True):
            self.check_cut(fog, crop(SETS["some"]), geometry=veils, parallel=parallel)

    def test_regions_that_change_are_drawn_anew(self):
        pictures = {CPU: [], OPENGL: []}
        for engine, seen in pictures.items():
            scene = Scene((60, 60))
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            mapper.SetEngine(engine)
            scene.add_volume(*fog(), mapper)
            scene.look((-0.5, -0.35, -0.8), half=1.2)
            for change in (
                lambda: None,
                lambda: crop(SETS["some"])(mapper),
                lambda: mapper.SetCroppingRegionPlanes(-0.6, 0.3, -0.4, 0.6, -0.3, 0.5),
                lambda: mapper.SetCroppingRegionFlags(SETS["fence"]),
                lambda: mapper.CroppingOff(),
            ):
                change()
                seen.append(scene.pixels())
                self.assertEqual(mapper.GetEngineInUse(), engine)
        for k, (a, b) in enumerate(zip(*pictures.values())):
            self.assertLessEqual(255.0 * np.abs(a - b).mean(), Agreement.MEAN)
            if k:  # and each change is seen
                self.assertGreater(255.0 * np.abs(b - pictures[OPENGL][k - 1]).mean(), 2.0 * Agreement.MEAN)


if __name__ == "__main__":
    unittest.main()
