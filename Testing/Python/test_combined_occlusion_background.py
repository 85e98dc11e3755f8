# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper in windows of all kinds: what it leaves in the frame buffer, alpha too."""
import unittest

import numpy as np
from occlusion_scene import (
    WHITE,
    Messages,
    Scene,
    actor,
    erode,
    float_image,
    image,
    marschner_lobb,
    sphere,
    volume_property,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkWindowToImageFilter
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

N = 32
STEP = 0.2 * 2.0 / (N - 1)


def plain():
    """Our mapper as an unshaded ray caster."""
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetOcclusionStrength(0.0)
    mapper.SetSampleDistance(STEP)
    return mapper


def peer():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.UseJitteringOff()
    mapper.SetSampleDistance(STEP)
    return mapper


def rgba(scene):
    """The window, [y, x, 4] bytes."""
    scene.window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(scene.window)
    grab.SetInputBufferTypeToRGBA()
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.Update()
    width, height, _ = grab.GetOutput().GetDimensions()
    scalars = grab.GetOutput().GetPointData().GetScalars()
    return vtk_to_numpy(scalars).reshape(height, width, 4).astype(float)


def window(**options):
    scene = Scene((96, 96), **options)
    scene.window.SetAlphaBitPlanes(1)
    return scene


def look(scene, renderer=None, parallel=False):
    scene.look((-0.5, -0.35, -0.8), half=1.6, parallel=parallel, renderer=renderer)


class AgainstTheRayCaster(unittest.TestCase):
    def compare(self, build, covered=1500):
        """The scenes with our mapper and with VTK's agree within issue 1's bounds, alpha included."""
        ours, theirs = (rgba(build(mapper)) for mapper in (plain, peer))
        empty = rgba(build(None))
        # inside the picture of both: the ray caster draws half a voxel less at the box's faces
        inside = erode(np.abs(theirs - empty).max(axis=2) > 0, 2)
        self.assertGreater(inside.sum(), covered)
        difference = np.abs(ours - theirs).max(axis=2)
        self.assertLessEqual(difference[inside].mean(), 1.0)
        self.assertLessEqual(np.percentile(difference[inside], 99.0), 2.0)
        # and nothing is touched where there is nothing
        outside = erode(np.abs(ours - empty).max(axis=2) == 0, 1)
        self.assertEqual(np.abs(theirs - empty)[erode(outside, 3)].max(initial=0.0), 0.0)
        return ours

    def test_backgrounds_of_every_alpha(self):
        for alpha, geometry in ((0.0, False), (0.4, True), (1.0, False)):

            def build(mapper):
                scene = window(background=(0.1, 0.3, 0.5))
                scene.renderer.SetBackgroundAlpha(alpha)
                if geometry:
                    scene.renderer.AddActor(sphere(0.7, (0.3, 0.2, 0.5), color=(0.9, 0.6, 0.2)))
                if mapper:
                    scene.add_volume(marschner_lobb(N), volume_property(unit=0.1, opacity=0.1), mapper())
                look(scene)
                return scene

            with self.subTest(alpha=alpha, geometry=geometry):
                ours = self.compare(build)
                corner = 255.0 * np.array((0.1, 0.3, 0.5, alpha))
                self.assertLessEqual(np.abs(ours[2, 2] - corner).max(), 0.51)

    def test_a_layer_over_another_with_and_without_its_depth(self):
        def build(mapper, preserve=False):
            scene = window(background=(0.2, 0.2, 0.2))
            scene.window.SetNumberOfLayers(2)
            scene.renderer.AddActor(sphere(0.6, color=(0.2, 0.9, 0.2)))
            top = vtkRenderer()
            top.SetLayer(1)
            top.SetPreserveDepthBuffer(preserve)
            scene.window.AddRenderer(top)
            look(scene)
            top.SetActiveCamera(scene.renderer.GetActiveCamera())
            if mapper:
                scene.add_volume(
                    marschner_lobb(N), volume_property(unit=0.1, opacity=0.1), mapper(), renderer=top
                )
            return scene

        ours = self.compare(build)
        # a stated limit: geometry of another renderer does not take part, though its depth is kept
        self.assertEqual(np.abs(rgba(build(plain, True)) - ours).max(), 0.0)

    def test_a_renderer_that_does_not_erase(self):
        def build(mapper):
            scene = window(background=(0.5, 0.1, 0.1))
            scene.renderer.SetBackgroundAlpha(1.0)
            if mapper:
                scene.add_volume(marschner_lobb(N), volume_property(unit=0.1, opacity=0.1), mapper())
            look(scene)
            scene.window.Render()
            scene.renderer.EraseOff()
            return scene

        # what is opaque stays so, though the volume is drawn over itself
        self.assertGreaterEqual(self.compare(build)[..., 3].min(), 254.0)

    def test_inside_the_volume_in_both_projections(self):
        for parallel in (False, True):

            def build(mapper):
                scene = window()
                if mapper:
                    scene.add_volume(marschner_lobb(N), volume_property(unit=0.3, opacity=0.1), mapper())
                look(scene, parallel=parallel)
                camera = scene.renderer.GetActiveCamera()
                camera.SetPosition(0.1, 0.15, 0.4)
                camera.SetFocalPoint(0.0, 0.0, -1.0)
                camera.SetViewUp(0.0, 1.0, 0.0)
                camera.SetParallelScale(0.6)
                camera.SetViewAngle(60.0)
                camera.SetClippingRange(0.05, 5.0)
                return scene

            with self.subTest(parallel=parallel):
                self.compare(build, 5000)

    def test_viewports_with_gaps(self):
        def build(mapper):
            scene = Scene((200, 120), viewports=((0.05, 0.1, 0.45, 0.9), (0.55, 0.2, 1.0, 1.0)))
            scene.window.SetAlphaBitPlanes(1)
            for renderer in scene.renderers:
                if mapper:
                    scene.add_volume(
                        marschner_lobb(N), volume_property(unit=0.1, opacity=0.1), mapper(), renderer=renderer
                    )
                look(scene, renderer)
            return scene

        self.compare(build)


class Stereo(unittest.TestCase):
    def test_each_eye_sees_an_opaque_volume_where_it_sees_the_same_box_of_polygons(self):
        # not against the ray caster, whose rays leave from between the eyes
        masks = []
        for polygons in (False, True):
            scene = window()
            scene.window.SetSize(240, 120)
            if polygons:
                source = vtkCubeSource()
                source.SetBounds(-0.5, 0.5, -0.3, 0.3, -0.4, 0.4)
                scene.renderer.AddActor(actor(source))
            else:
                data = image(np.ones((9, 7, 11), np.float32), (0.1, 0.1, 0.1))
                scene.add_volume(data, volume_property(1.0, 0.9999, 0.001, WHITE), plain())
            scene.look((-0.5, -0.35, -0.8), half=0.9, parallel=False)
            scene.renderer.GetActiveCamera().SetFocalPoint(0.1, 0.0, 0.0)
            scene.window.StereoCapableWindowOn()
            scene.window.SetStereoTypeToSplitViewportHorizontal()
            scene.window.StereoRenderOn()
            scene.renderer.GetActiveCamera().SetEyeAngle(16.0)
            masks.append(rgba(scene)[..., 0] > 127)
        volume, box = masks
        self.assertGreater(box.sum(), 4000)
        self.assertGreater((box[:, :120] != box[:, 120:]).sum(), 100)  # the eyes differ
        # rasterised by their centres: at most every other pixel of the outline, of 500 in all
        self.assertLessEqual((volume != box).sum(), 250)


class Alpha(unittest.TestCase):
    def test_two_volumes_leave_the_alpha_of_both(self):
        alone = []
        for shown in ((0,), (1,), (0, 1)):
            scene = window()
            scene.renderer.SetBackgroundAlpha(0.0)
            mappers = []
            for k in shown:
                mapper = plain()
                volume, _ = scene.add_volume(marschner_lobb(24), volume_property(unit=0.4), mapper)
                volume.SetScale(0.5)
                volume.SetPosition((-0.2, 0.1, 0.7) if k else (0.2, 0.0, -0.7))
                mappers.append(mapper)
            scene.look(half=0.8)
            picture = rgba(scene)
            alone.append((picture, [float_image(mapper) for mapper in mappers]))
        first, second = alone[0][1][0][..., 3], alone[1][1][0][..., 3]
        expected = 255.0 * (1.0 - (1.0 - first) * (1.0 - second))
        self.assertGreater(((first > 0.2) & (second > 0.2)).sum(), 300)
        # 8 bits, each of two times
        self.assertLessEqual(np.abs(alone[2][0][..., 3] - expected).max(), 1.51)

    def test_shaded_colours_never_exceed_their_alpha(self):
        scene = window()
        scene.renderer.SetBackgroundAlpha(0.0)
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        messages = Messages(mapper)
        scene.add_volume(marschner_lobb(24), volume_property(unit=0.1), mapper)
        scene.renderer.AddActor(sphere(0.5, (0.5, 0.3, 0.8), lit=True))
        look(scene)
        picture = rgba(scene)
        self.assertGreater(picture[..., 3].max(), 250.0)
        self.assertLessEqual((picture[..., :3].max(axis=2) - picture[..., 3]).max(), 1.0)
        self.assertEqual(picture[1, 1].max(), 0.0)
        self.assertEqual(messages.errors + messages.warnings, [])


class Windows(unittest.TestCase):
    def test_the_largest_window(self):
        scene = Scene((4000, 4000))
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        messages = Messages(mapper)
        scene.add_volume(marschner_lobb(8), volume_property(unit=0.5), mapper)
        look(scene)
        scene.window.Render()
        self.assertEqual(scene.window.GetActualSize(), (4000, 4000))
        colors = vtkUnsignedCharArray()
        scene.window.GetPixelData(1990, 1990, 2010, 2010, 0, colors, 0)
        self.assertGreater(vtk_to_numpy(colors).max(), 20)
        scene.window.GetPixelData(0, 0, 10, 10, 0, colors, 0)
        self.assertEqual(vtk_to_numpy(colors).max(), 0)
        self.assertEqual(messages.errors + messages.warnings, [])

    def test_released_and_closed_windows_show_the_same_picture_again(self):
        scene = window()
        mapper = vtkChiCombinedOcclusionVolumeMapper()
        data, prop = marschner_lobb(24), volume_property(unit=0.1)
        volume, _ = scene.add_volume(data, prop, mapper)
        actor = sphere(0.5, (0.5, 0.3, 0.8), lit=True)
        scene.renderer.AddActor(actor)
        look(scene)
        messages = Messages(mapper, scene.window, scene.renderer)
        expected = rgba(scene)
        mapper.ReleaseGraphicsResources(scene.window)
        self.assertEqual(np.abs(rgba(scene) - expected).max(), 0.0)
        volume.ReleaseGraphicsResources(scene.window)
        self.assertEqual(np.abs(rgba(scene) - expected).max(), 0.0)
        scene.window.Finalize()  # closed
        scene.window.SetOffScreenRendering(1)
        self.assertEqual(np.abs(rgba(scene) - expected).max(), 0.0)
        other = window()
        other.renderer.AddVolume(volume)
        other.renderer.AddActor(actor)
        look(other)
        scene.renderer.RemoveVolume(volume)
        scene.window.Finalize()
        self.assertEqual(np.abs(rgba(other) - expected).max(), 0.0)
        self.assertEqual(messages.errors + messages.warnings, [])


if __name__ == "__main__":
    unittest.main()
