# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scenes that both engines of vtkChiCombinedOcclusionVolumeMapper draw, and how much they may differ."""
import unittest

import numpy as np
from occlusion_scene import (
    Scene,
    cube,
    float_image,
    marschner_lobb,
    sphere,
    square,
    visibility_image,
    volume_property,
)
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


def tubes(scene):
    """Opaque things in, before and behind the volume, tilted and lit."""
    scene.renderer.AddActor(sphere(0.3, (0.5, 0.3, 0.2), color=(0.9, 0.7, 0.4), lit=True))
    scene.renderer.AddActor(sphere(0.25, (-0.4, -0.2, 1.3), color=(0.5, 0.7, 0.9), lit=True))
    plane = square(1.6, -1.3, color=(0.8, 0.8, 0.8))
    plane.RotateX(25.0)
    scene.renderer.AddActor(plane)


SCENE = Scene((SIZE, SIZE))  # one window for all: shaders are built once


def render(engine, content, setup=None, geometry=None, parallel=False, look=None, size=SIZE):
    """The picture and the visibility of the surfaces, floats, of one engine."""
    data, prop = content() if content else (None, None)
    scene = SCENE
    scene.window.SetSize(size, size)
    scene.renderer.RemoveAllViewProps()
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
    return float_image(mapper), visibility_image(mapper), mapper


CPU = vtkChiCombinedOcclusionVolumeMapper.ENGINE_CPU
OPENGL = vtkChiCombinedOcclusionVolumeMapper.ENGINE_OPENGL
AUTO = vtkChiCombinedOcclusionVolumeMapper.ENGINE_AUTO


class Agreement(unittest.TestCase):
    # the bounds, of 255
    MEAN = 1.0
    PERCENTILE_99 = 4.0

    def check(self, content, darkens=True, **options):
        setup = options.pop("setup", lambda mapper: None)
        cpu, cpu_visibility, mapper = render(CPU, content, setup, **options)
        self.assertEqual(mapper.GetEngineInUse(), CPU)
        gpu, gpu_visibility, mapper = render(OPENGL, content, setup, **options)
        self.assertEqual(mapper.GetEngineInUse(), OPENGL, mapper.GetEngineReason())
        self.assertGreater((cpu[..., 3] > 0.05).sum(), 400)  # there is something to compare
        for name, a, b in (("picture", cpu, gpu), ("visibility", cpu_visibility, gpu_visibility)):
            self.assertTrue(np.isfinite(b).all(), name)
            difference = 255.0 * np.abs(a - b)
            difference = difference.max(axis=2) if difference.ndim == 3 else difference
            where = np.maximum(cpu[..., 3], gpu[..., 3]) > 0.0 if name == "picture" else cpu_visibility < 1.0
            if where.any():
                self.assertLessEqual(difference[where].mean(), self.MEAN, name)
                self.assertLessEqual(np.percentile(difference[where], 99.0), self.PERCENTILE_99, name)
        if darkens:  # occlusion does something in this scene

            def unshaded(mapper):
                setup(mapper)
                mapper.SetOcclusionStrength(0.0)

            plain = render(OPENGL, content, unshaded, **options)[0]
            self.assertGreater(255.0 * np.abs(plain - gpu).max(axis=2).mean(), 5.0)
        return gpu
