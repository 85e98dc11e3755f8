# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lights for the tests of shading."""
from vtkmodules.vtkRenderingCore import vtkLight


def light(kind="SceneLight", position=(1.0, 2.0, 3.0), color=(1.0, 1.0, 1.0), intensity=1.0):
    result = vtkLight()
    getattr(result, "SetLightTypeTo" + kind)()
    result.SetPosition(*position)
    result.SetFocalPoint(0.0, 0.0, 0.0)
    result.SetDiffuseColor(*color)
    result.SetSpecularColor(*color)
    result.SetIntensity(intensity)
    return result


def positional(cone=180.0, exponent=1.0, attenuation=(1.0, 0.0, 0.0), **options):
    result = light(**options)
    result.PositionalOn()
    result.SetConeAngle(cone)
    result.SetExponent(exponent)
    result.SetAttenuationValues(*attenuation)
    return result


LIGHTS = {
    "one headlight": lambda: [],
    "one scene light, off the axis": lambda: [light()],
    "one camera light": lambda: [light("CameraLight", (0.5, 0.5, 1.0))],
    "two coloured lights": lambda: [
        light(color=(1.0, 0.4, 0.2)),
        light(position=(-3.0, 1.0, 2.0), color=(0.2, 0.5, 1.0), intensity=0.8),
    ],
    "a headlight and a scene light": lambda: [light("Headlight", (0, 0, 1), intensity=0.5), light()],
    "a positional light": lambda: [positional()],
    "a positional light that falls off": lambda: [positional(attenuation=(0.5, 0.2, 0.1))],
    # the ray caster puts samples up to half a voxel off when it asks how far the light is: a cone that
    # ends hard ends a voxel elsewhere, so that this one has faded before
    "a spot and a directional light": lambda: [
        positional(cone=60.0, exponent=30.0),
        light(position=(-3.0, 1.0, 2.0), color=(0.2, 0.5, 1.0)),
    ],
}
