# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: fast pictures while one interacts, the full one when one stops."""
import unittest

import numpy as np
from occlusion_scene import Scene, ball, cube, float_image, marschner_lobb, sphere, square, volume_property
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkInteractionStyle import vtkInteractorStyleTrackballCamera
from vtkmodules.vtkRenderingCore import vtkLODProp3D, vtkRenderWindowInteractor

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

STILL, FASTEST = 0.001, 1.0e9


def build(kind, size=200):
    scene = Scene((size, size), background=(0.1, 0.1, 0.1))
    if kind == "shells":
        prop = volume_property(255.0, 0.3, 2.0 / 63.0)
        peak = vtkPiecewiseFunction()
        for place, opacity in ((0, 0), (100, 0), (115, 0.9), (130, 0), (255, 0)):
            peak.AddPoint(place, opacity)
        prop.SetScalarOpacity(peak)
        volume, mapper = scene.add_volume(marschner_lobb(64, np.uint8), prop)
    else:
        volume, mapper = scene.add_volume(cube(ball(56, 0.3, 0.5), 1.2), volume_property(1.0, 0.3, 0.1))
    if kind == "edges":
        mapper.SetGeometryAntiAliasingToMultiSample()
    if kind in ("geometry", "edges"):
        scene.renderer.AddActor(sphere(0.3, (0.3, 0.2, 0.2), lit=True, color=(0.9, 0.6, 0.2)))
        scene.renderer.AddActor(square(0.9, -0.5, color=(0.8, 0.8, 0.8)))
    scene.look((0.3, 0.2, -1.0), half=1.6 if kind == "shells" else 0.8, parallel=False)
    return scene, volume, mapper


def luminance(pixels):
    return (pixels * (0.2126, 0.7152, 0.0722)).sum(axis=2)


def used(mapper):
    return (
        mapper.GetUsedNumberOfDirections(),
        mapper.GetUsedSampleDistance(),
        mapper.GetUsedImageReduction(),
    )


class Interaction(unittest.TestCase):
    def test_nothing_pops_between_the_fast_picture_and_the_full_one(self):
        for kind in ("fog", "shells", "geometry", "edges"):
            scene, _, mapper = build(kind)
            full, best = scene.pixels(), used(mapper)
            self.assertEqual((best[0], best[2]), (16, 1))
            samples = mapper.GetNumberOfSamples()
            seen = set()
            rate = 1.0
            while rate < 1.0e9:
                scene.window.SetDesiredUpdateRate(rate)
                pixels = scene.pixels()
                if used(mapper) not in seen:
                    seen.add(used(mapper))
                    change = luminance(pixels).mean() / luminance(full).mean() - 1.0
                    print(f"{kind} {used(mapper)}: luminance {100.0 * change:+.2f} %")
                    with self.subTest(kind=kind, used=used(mapper)):
                        self.assertLessEqual(abs(change), 0.02)  # asked
                rate *= 2.0
            self.assertGreaterEqual(len(seen), 2)
            least = used(mapper)
            self.assertLess(least[0], best[0])
            self.assertAlmostEqual(least[1], 2.0 * best[1])
            self.assertEqual(least[2], 4)
            self.assertLess(mapper.GetNumberOfSamples(), samples / 8)
            scene.window.SetDesiredUpdateRate(STILL)
            self.assertEqual(np.abs(scene.pixels() - full).max(), 0.0)
            self.assertEqual(used(mapper), best)

    def test_silhouettes_of_geometry_stay_sharp(self):
        scene, _, mapper = build("geometry")
        # dark geometry before bright fog: no pixel of the sphere may take its neighbours' fog
        scene.renderer.GetActors().GetLastActor().VisibilityOff()
        ball_actor = scene.renderer.GetActors().GetItemAsObject(0)
        ball_actor.SetPosition(-0.3, -0.2, 0.8)
        ball_actor.GetProperty().SetColor(0.0, 0.0, 0.0)
        ball_actor.GetProperty().SetSpecular(0.0)
        scene.renderer.ResetCameraClippingRange(-1.0, 1.0, -1.0, 1.0, -1.0, 1.4)
        full = scene.pixels()
        scene.window.SetDesiredUpdateRate(FASTEST)
        fast = scene.pixels()
        self.assertEqual(mapper.GetUsedImageReduction(), 4)
        dark = full.max(axis=2) == 0.0
        self.assertGreater(dark.sum(), 800)
        # what leaks over the edge is the weight of neighbours hundreds of slabs off
        self.assertLessEqual(255.0 * fast[dark].max(), 1.0)
        self.assertLessEqual(255.0 * np.abs(fast - full)[~dark].mean(), 2.0)

    def test_it_can_be_turned_off_and_told_when_to_begin(self):
        scene, _, mapper = build("fog", 96)
        mapper.AutoAdjustQualityOff()
        scene.window.SetDesiredUpdateRate(FASTEST)
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 1)
        mapper.AutoAdjustQualityOn()
        mapper.SetInteractiveUpdateRate(1.0e10)
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 1)
        mapper.SetInteractiveUpdateRate(1.0)
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 4)

    def test_a_reduction_that_is_asked_for_is_kept(self):
        scene, _, mapper = build("fog", 96)
        full = scene.pixels()
        mapper.SetImageReduction(3)
        reduced = scene.pixels()
        self.assertEqual(used(mapper)[::2], (16, 3))
        # of a fog as smooth as this one a ninth of the pixels says nearly all, and not all
        self.assertLessEqual(255.0 * np.abs(reduced - full).mean(), 2.0)
        self.assertGreater(np.abs(reduced - full).max(), 0.0)
        scene.window.SetDesiredUpdateRate(FASTEST)
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 4)
        for given, kept in ((0, 1), (9, 4)):
            mapper.SetImageReduction(given)
            self.assertEqual(mapper.GetImageReduction(), kept)

    def test_a_machine_that_is_fast_enough_draws_in_full(self):
        scene, _, mapper = build("fog", 64)
        scene.window.SetDesiredUpdateRate(STILL)
        scene.window.Render()
        self.assertLess(mapper.GetSecondsTotal(), 5.0)
        scene.window.SetDesiredUpdateRate(0.01)
        mapper.SetInteractiveUpdateRate(0.1)  # so that a hundred seconds are interactive
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 1)
        self.assertEqual(mapper.GetUsedNumberOfDirections(), 16)

    def test_an_interactor_drives_it(self):
        scene, _, mapper = build("fog", 96)
        interactor = vtkRenderWindowInteractor()
        interactor.SetRenderWindow(scene.window)
        interactor.SetDesiredUpdateRate(FASTEST)
        style = vtkInteractorStyleTrackballCamera()
        interactor.SetInteractorStyle(style)
        style.StartRotate()
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 4)
        style.EndRotate()
        scene.window.Render()
        self.assertEqual(mapper.GetUsedImageReduction(), 1)

    def test_the_published_rule_keeps_its_taps(self):
        scene, _, mapper = build("fog", 96)
        mapper.SetOcclusionMethodToPublished()
        scene.window.SetDesiredUpdateRate(FASTEST)
        scene.window.Render()
        self.assertEqual((mapper.GetUsedNumberOfDirections(), mapper.GetUsedImageReduction()), (16, 4))


class LevelsOfDetail(unittest.TestCase):
    def test_a_prop_with_two_levels_draws_the_coarse_one_when_time_is_short(self):
        scene, volume, mapper = build("fog", 96)
        expected = scene.pixels()
        scene.renderer.RemoveVolume(volume)
        coarse = vtkChiCombinedOcclusionVolumeMapper()
        coarse.SetInputDataObject(cube(ball(14, 0.3, 0.5), 1.2))
        prop = vtkLODProp3D()
        fine_id = prop.AddLOD(mapper, volume.GetProperty(), 0.0)
        coarse_id = prop.AddLOD(coarse, volume.GetProperty(), 0.0)
        scene.renderer.AddViewProp(prop)
        self.assertLessEqual(255.0 * np.abs(scene.pixels() - expected).max(), 1.0)
        prop.SetSelectedLODID(coarse_id)
        prop.AutomaticLODSelectionOff()
        other = scene.pixels()
        self.assertGreater(255.0 * np.abs(other - expected).max(), 1.0)
        self.assertGreater(other.max(), 0.3)
        self.assertGreater(coarse.GetNumberOfSlices(), 0)
        prop.SetSelectedLODID(fine_id)
        self.assertLessEqual(255.0 * np.abs(scene.pixels() - expected).max(), 1.0)
        # the time that a level takes is what the prop chooses by
        for each in (mapper, coarse):
            self.assertGreater(each.GetTimeToDraw(), 0.0)


if __name__ == "__main__":
    unittest.main()
