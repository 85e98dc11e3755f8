# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: what is cropped neither draws nor darkens."""
import unittest

import numpy as np
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
from vtkmodules.util.numpy_support import vtk_to_numpy
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
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetOcclusionStrength(strength)
    mapper.SetSampleDistance(step)
    return mapper


def peer(step):
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetSampleDistance(step)
    mapper.AutoAdjustSampleDistancesOff()
    mapper.UseJitteringOff()
    return mapper


class Regions(unittest.TestCase):
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
                image(data, (0.05,) * 3, [-0.5, -0.5, -0.5]), volume_property(1.0, 0.8, 0.05)
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


if __name__ == "__main__":
    unittest.main()
