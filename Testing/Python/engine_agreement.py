# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes that both engines of vtkChiCombinedOcclusionVolumeMapper draw, and how much they may differ."""
import unittest

import numpy as np
from occlusion_scene import (
    Messages,
    Scene,
    ball,
    cube,
    float_image,
    marschner_lobb,
    sphere,
    square,
    volume_property,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

N = 24
SIZE = 48  # the CPU engine's paths are linear over 32 light pixels: not for wide views of few pixels


def fog():
    """Extinction everywhere, varying slowly."""
    return marschner_lobb(N, np.uint8), volume_property(255.0, 0.3, 0.1)


def shells():
    """Thin opaque layers between what is transparent."""
    prop = volume_property(1.0, 0.0, 0.1)
    opacity = prop.GetScalarOpacity()
    opacity.RemoveAllPoints()
    for place in (0.3, 0.6):
        for at, value in ((-0.04, 0.0), (0.0, 0.95), (0.04, 0.0)):
            opacity.AddPoint(place + at, value)
    return marschner_lobb(N), prop


def peak():
    """Thin peaks of opacity where the colours turn 40 times: slices a voxel apart need more than the middle's."""
    prop = volume_property(1.0, 0.0, 0.05)
    opacity = prop.GetScalarOpacity()
    opacity.RemoveAllPoints()
    for place, value in ((0.2, 0.3), (0.5, 0.95)):
        for at, share in ((-0.01, 0.0), (0.0, 1.0), (0.01, 0.0)):
            opacity.AddPoint(place + at, share * value)
    colors = vtkColorTransferFunction()
    for at in np.linspace(0.0, 1.0, 801):
        colors.AddRGBPoint(at, *(0.5 + 0.5 * np.sin(80.0 * np.pi * at + phase) for phase in (0.0, 2.0, 4.0)))
    prop.SetColor(colors)
    z, y, x = np.meshgrid(*(np.linspace(0.0, 1.0, N),) * 3, indexing="ij", sparse=True)
    return cube(0.9 * z + 0.08 * x + 0.02 * y, 2.0), prop


def soft_ball():
    """Gradients in every direction, fog within."""
    return cube(ball(N, soft=0.4), 2.0), volume_property(1.0, 0.4, 0.1)


def tubes(scene):
    """Opaque things in, before and behind the volume, tilted and lit."""
    scene.renderer.AddActor(sphere(0.3, (0.5, 0.3, 0.2), color=(0.9, 0.7, 0.4), lit=True))
    scene.renderer.AddActor(sphere(0.25, (-0.4, -0.2, 1.3), color=(0.5, 0.7, 0.9), lit=True))
    plane = square(1.6, -1.3, color=(0.8, 0.8, 0.8))
    plane.RotateX(25.0)
    scene.renderer.AddActor(plane)


def translucent(actor, opacity):
    actor.GetProperty().SetOpacity(opacity)
    return actor


def veils(scene):
    """Translucent things in front of the volume, in it, and behind it, at most four in a pixel."""
    plane = square(0.8, 0.1, color=(0.3, 0.9, 0.4))
    plane.RotateY(35.0)
    scene.renderer.AddActor(translucent(plane, 0.5))
    scene.renderer.AddActor(translucent(sphere(0.5, (-0.2, 0.2, -0.2), color=(0.9, 0.3, 0.8), lit=True), 0.35))
    front = square(0.3, 1.5, color=(0.9, 0.9, 0.2))
    front.SetPosition(2.0, 0.6, 0.0)
    scene.renderer.AddActor(translucent(front, 0.25))
    scene.renderer.AddActor(translucent(square(1.5, -1.25, color=(0.5, 0.5, 1.0)), 0.7))


def veiled_tubes(scene):
    tubes(scene)
    veils(scene)


SCENE = Scene((SIZE, SIZE))  # one window for all: shaders are built once


def visibility_of(mapper):
    """The visibility of the surfaces, [y, x], or [y, x, 3] under coloured light."""
    data = vtkImageData()
    mapper.GetVisibilityImage(data)
    scalars = data.GetPointData().GetScalars()
    width, height, _ = data.GetDimensions()
    components = scalars.GetNumberOfComponents()
    shape = (height, width) if components == 1 else (height, width, components)
    return vtk_to_numpy(scalars).reshape(shape).copy()


def render(engine, content, setup=None, geometry=None, lights=(), parallel=False, look=None, size=SIZE):
    """The picture and the visibility of the surfaces, floats, of one engine; without lights, a headlight."""
    data, prop = content() if content else (None, None)
    scene = SCENE
    scene.window.SetSize(size, size)
    scene.renderer.RemoveAllViewProps()
    scene.renderer.RemoveAllLights()
    for item in lights:
        scene.renderer.AddLight(item)
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetEngine(engine)
    if setup:
        setup(mapper)
    if data is None:
        data = cube(np.zeros((3, 3, 3)), 0.1)
        prop = volume_property(1.0, 0.0)
    scene.add_volume(data, prop, mapper)
    if geometry:
        geometry(scene)
    scene.look((-0.5, -0.35, -0.8), half=1.4, parallel=parallel)
    if look:
        look(scene)
    scene.window.Render()
    return float_image(mapper), visibility_of(mapper), mapper


def interact(mapper, bits):
    """Who darkens whom, from the lowest bit: the volume itself and geometry, geometry the volume and itself."""
    mapper.SetVolumeToVolume(bool(bits & 1))
    mapper.SetVolumeToGeometry(bool(bits & 2))
    mapper.SetGeometryToVolume(bool(bits & 4))
    mapper.SetGeometryToGeometry(bool(bits & 8))


CPU = vtkChiCombinedOcclusionVolumeMapper.ENGINE_CPU
OPENGL = vtkChiCombinedOcclusionVolumeMapper.ENGINE_OPENGL
AUTO = vtkChiCombinedOcclusionVolumeMapper.ENGINE_AUTO


def differences(a, b, where):
    """Mean and 99th percentile of the largest difference of a pixel's components, of 255."""
    if not where.any():
        return 0.0, 0.0
    difference = 255.0 * np.abs(a - b)
    difference = (difference.max(axis=2) if difference.ndim == 3 else difference)[where]
    return difference.mean(), np.percentile(difference, 99.0)


class Agreement(unittest.TestCase):
    # the bounds, of 255
    MEAN = 1.0
    PERCENTILE_99 = 4.0
    LEAST = 400  # pixels, so that there is something to compare

    def check(self, content, darkens=True, without=None, **options):
        """Compare the engines' pictures; `without`: options that leave out what is tested, which must show."""
        setup = options.pop("setup", lambda mapper: None)
        cpu, cpu_visibility, mapper = render(CPU, content, setup, **options)
        self.assertEqual(mapper.GetEngineInUse(), CPU)
        gpu, gpu_visibility, mapper = render(OPENGL, content, setup, **options)
        self.assertEqual(mapper.GetEngineInUse(), OPENGL, mapper.GetEngineReason())
        self.assertGreater((cpu[..., 3] > 0.05).sum(), self.LEAST)
        darkened = (cpu_visibility < 1.0).reshape(*cpu.shape[:2], -1).any(axis=2)
        seen = (np.maximum(cpu[..., 3], gpu[..., 3]) > 0.0, darkened)
        pairs = ((cpu, gpu), (cpu_visibility, gpu_visibility))
        for name, (a, b), where in zip(("picture", "visibility"), pairs, seen):
            self.assertEqual(a.shape, b.shape, name)
            self.assertTrue(np.isfinite(b).all(), name)
            mean, most = differences(a, b, where)
            print(f"{self.id().split('.')[-1]} {name}: mean {mean:.4f}, 99 % {most:.4f} of 255")
            self.assertLessEqual(mean, self.MEAN, name)
            self.assertLessEqual(most, self.PERCENTILE_99, name)
        if darkens:  # occlusion does something in this scene

            def unshaded(mapper):
                setup(mapper)
                mapper.SetOcclusionStrength(0.0)

            plain = render(OPENGL, content, unshaded, **options)[0]
            self.assertGreater(255.0 * np.abs(plain - gpu).max(axis=2).mean(), 5.0)
        if without:  # an engine that left it out would be caught by the bounds
            left_out = render(OPENGL, **{"content": content, **options, "setup": setup, **without})[:2]
            caught = [
                a.shape != b.shape or bounded[0] > 2.0 * self.MEAN or bounded[1] > 2.0 * self.PERCENTILE_99
                for (a, _), b, where in zip(pairs, left_out, seen)
                for bounded in [differences(a, b, where) if a.shape == b.shape else (0.0, 0.0)]
            ]
            self.assertTrue(any(caught))
        return gpu

    def check_window(self, prepare, change):
        """Compare what windows show, of one sample a pixel and of several; `change(scene, mapper)` must be seen."""
        for samples in (0, 4):
            pictures = []
            for engine in (CPU, OPENGL):
                scene = Scene((60, 50), background=(0.2, 0.3, 0.4))
                scene.window.SetMultiSamples(samples)
                _, mapper = scene.add_volume(*fog())
                mapper.SetEngine(engine)
                prepare(scene, mapper)
                scene.look((-0.5, -0.35, -0.8), half=1.4, parallel=False)
                before = scene.pixels()
                change(scene, mapper)
                pictures.append(scene.pixels())
                self.assertEqual(mapper.GetEngineInUse(), engine)
                self.assertEqual(mapper.GetNumberOfDroppedLayers(), 0)
            everywhere = np.ones(before.shape[:2], bool)
            mean, most = differences(*pictures, everywhere)
            self.assertLessEqual(mean, self.MEAN)
            self.assertLessEqual(most, self.PERCENTILE_99)
            self.assertGreater(differences(pictures[0], before, everywhere)[0], 5.0 * self.MEAN)

    def check_edits(self, content, edits):
        """Textures follow what is edited, and leave when they are not needed: each of the functions that
        `edits(scene, mapper, data, prop)` lists must be seen, and by both engines alike."""
        pictures = {CPU: [], OPENGL: []}
        for engine, seen in pictures.items():
            scene = Scene((60, 60))
            mapper = vtkChiCombinedOcclusionVolumeMapper()
            messages = Messages(mapper)
            mapper.SetEngine(engine)
            data, prop = content()
            scene.add_volume(data, prop, mapper)
            scene.look((-0.5, -0.35, -0.8), half=1.2)
            for edit in [lambda: None, *edits(scene, mapper, data, prop)]:
                edit()
                seen.append(scene.pixels())
                self.assertEqual(mapper.GetEngineInUse(), engine, mapper.GetEngineReason())
            self.assertEqual((messages.errors, messages.warnings), ([], []))
        for k, (a, b) in enumerate(zip(*pictures.values())):
            self.assertLessEqual(255.0 * np.abs(a - b).mean(), self.MEAN)
            if k:
                self.assertGreater(255.0 * np.abs(b - pictures[OPENGL][k - 1]).mean(), 2.0 * self.MEAN)
