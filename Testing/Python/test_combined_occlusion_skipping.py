# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: what it leaves out, counts, and can be told to do all the same."""
import unittest

import numpy as np
from occlusion_scene import Scene, ball, cube, float_image, sphere, visibility_image, volume_property
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction, vtkPlane

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper as Mapper

KINDS = {
    name: getattr(Mapper, "SKIP_" + name)
    for name in (
        "EMPTY_BRICKS SATURATED_RAYS BEHIND_GEOMETRY CLIPPED FOOTPRINT SATURATED_LIGHT UNREACHED_LIGHT UNCHANGED"
    ).split()
}
# opacity a tenth of the edge, over the ball's values: everywhere; a skin; the densest voxels
FUNCTIONS = {
    "dense": ((0.0, 0.0), (1.0, 0.97)),
    "skin": ((0.0, 0.0), (0.25, 0.0), (0.35, 0.999), (0.45, 0.0), (1.0, 0.0)),
    "sparse": ((0.0, 0.0), (0.95, 0.0), (1.0, 0.9)),
}


def build(function="dense", strength=1.0):
    """A lopsided ball, cut by a plane, with a sphere in it; more picture than volume."""
    scene = Scene((144, 144))
    values = ball(56, 0.2, 0.3, (-0.05, 0.05, 0.0))
    volume, mapper = scene.add_volume(cube(values), volume_property(unit=0.1))
    opacity = vtkPiecewiseFunction()
    for point in FUNCTIONS[function]:
        opacity.AddPoint(*point)
    volume.GetProperty().SetScalarOpacity(opacity)
    plane = vtkPlane()
    plane.SetNormal(0.2, 0.1, -1.0)
    plane.SetOrigin(0.0, 0.0, 0.1)
    mapper.AddClippingPlane(plane)
    mapper.SetOcclusionStrength(strength)
    scene.renderer.AddActor(sphere(0.2, (0.15, 0.0, 0.0)))
    scene.look((0.1, 0.2, -1.0), half=0.7, parallel=False)
    scene.renderer.ResetCameraClippingRange(-1.0, 1.0, -1.0, 1.0, -1.0, 1.0)
    return scene, volume, mapper


class EachKind(unittest.TestCase):
    def test_turned_off_it_counts_nothing_and_no_pixel_changes(self):
        spared = dict.fromkeys(KINDS, 0)
        for strength in (1.0, 0.0):  # without light rays that are done need no samples
            for function in FUNCTIONS:
                scene, _, mapper = build(function, strength)
                scene.window.Render()
                expected, lit = float_image(mapper), visibility_image(mapper)
                self.assertGreater(expected[..., 3].max(), 0.5)
                counts = {name: mapper.GetNumberOfSkipped(kind) for name, kind in KINDS.items()}
                for name, kind in KINDS.items():
                    if name == "UNCHANGED":
                        continue
                    with self.subTest(function=function, kind=name, strength=strength):
                        mapper.SetSkippingMask(Mapper.SKIP_EVERY_KIND & ~kind)
                        scene.window.Render()
                        self.assertFalse(mapper.GetReusedLastFrame())
                        self.assertEqual(mapper.GetNumberOfSkipped(kind), 0)
                        # the bound
                        self.assertLessEqual(255.0 * np.abs(float_image(mapper) - expected).max(), 1.0)
                        self.assertLessEqual(255.0 * np.abs(visibility_image(mapper) - lit).max(), 1.0)
                        spared[name] += counts[name]
        for name, count in spared.items():
            if name != "UNCHANGED":
                self.assertGreater(count, 0, name)

    def test_the_mask_counts_only_while_skipping_is_on(self):
        scene, _, mapper = build()
        mapper.SkippingOff()
        for _ in range(2):
            scene.window.Render()
            self.assertEqual([mapper.GetNumberOfSkipped(kind) for kind in KINDS.values()], [0] * 8)
            self.assertFalse(mapper.GetReusedLastFrame())
            self.assertFalse(mapper.GetReusedGeometry())
        self.assertEqual(mapper.GetSkippingMask(), Mapper.SKIP_EVERY_KIND)
        self.assertEqual(mapper.GetNumberOfSkipped(3), 0)
        self.assertEqual(mapper.GetNumberOfSkipped(-1), 0)


class OnlyWhatChanged(unittest.TestCase):
    def test_each_change_makes_anew_what_depends_on_it(self):
        scene, volume, mapper = build("skin")
        actor = scene.renderer.GetActors().GetLastActor()

        def kept():
            scene.window.Render()
            flags = (
                mapper.GetReusedBricks(),
                mapper.GetReusedClassification(),
                mapper.GetReusedGeometry(),
                mapper.GetReusedLastFrame(),
            )
            self.assertEqual(mapper.GetNumberOfSkipped(Mapper.SKIP_UNCHANGED), sum(flags) - flags[2])
            return flags

        self.assertEqual(kept(), (False, False, False, False))
        self.assertEqual(kept(), (True, True, True, True))
        samples = mapper.GetNumberOfSamples()
        self.assertEqual(samples, 0)  # the picture is drawn again, nothing is sampled
        scene.renderer.GetActiveCamera().Azimuth(2.0)
        self.assertEqual(kept(), (True, True, False, False))
        volume.GetProperty().GetScalarOpacity().AddPoint(0.5, 0.1)
        self.assertEqual(kept(), (True, False, True, False))
        volume.GetProperty().GetRGBTransferFunction().AddRGBPoint(0.5, 1.0, 0.0, 0.0)
        self.assertEqual(kept(), (True, False, True, False))
        actor.SetPosition(0.05, 0.0, 0.0)
        self.assertEqual(kept(), (True, True, False, False))
        actor.GetProperty().SetColor(0.2, 0.9, 0.2)
        self.assertEqual(kept(), (True, True, False, True))
        scene.window.SetSize(120, 144)
        self.assertEqual(kept(), (True, True, False, False))
        mapper.SetConeAngle(30.0)
        self.assertEqual(kept(), (True, True, True, False))
        mapper.GetInput().GetPointData().GetScalars().Modified()
        self.assertEqual(kept(), (False, False, True, False))
        mapper.SetSkippingMask(Mapper.SKIP_EVERY_KIND & ~Mapper.SKIP_UNCHANGED)
        self.assertEqual(kept(), (False, False, False, False))
        self.assertEqual(kept(), (False, False, False, False))


class OcclusionOff(unittest.TestCase):
    def test_it_costs_nothing_over_the_plain_render(self):
        counts = []
        for strength in (0.0, 1.0):
            scene, _, mapper = build("dense", strength)
            scene.window.Render()
            counts.append(
                (
                    mapper.GetNumberOfLightUpdates() + mapper.GetNumberOfSkippedLightUpdates(),
                    mapper.GetLightBufferBytes(),
                    mapper.GetNumberOfSamples(),
                )
            )
        self.assertEqual(counts[0][:2], (0, 0))
        self.assertGreater(counts[1][0], 0)
        # 16 directions, twice, of floats at half size
        self.assertGreater(counts[1][1], 16 * 2 * 4 * 72 * 72)
        self.assertLessEqual(counts[0][2], counts[1][2])


if __name__ == "__main__":
    unittest.main()
