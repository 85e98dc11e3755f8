# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine makes the CPU engine's picture of features that meet."""
import unittest

import numpy as np
from engine_agreement import Agreement, N, fog, peak, shells, soft_ball, tubes, veiled_tubes
from engine_contents import by_second, lit, nearest, plane, steep, with_second
from occlusion_lights import LIGHTS
from occlusion_scene import image
from vtkmodules.vtkCommonDataModel import vtkPlane


def cut(mapper):
    mapper.CroppingOn()
    mapper.SetCroppingRegionPlanes(-0.35, 0.3, -0.4, 0.45, -0.3, 0.25)
    mapper.SetCroppingRegionFlagsToInvertedCross()
    clip = vtkPlane()
    clip.SetNormal(0.6, 0.3, -1.0)
    clip.SetOrigin(0.1, 0.0, 0.4)
    mapper.AddClippingPlane(clip)


def masked(mapper):
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, N),) * 3, indexing="ij")
    mapper.SetMaskTypeToBinary()
    mapper.SetMaskInput(image(((x + 0.5 * y < 0.3) & (z - 0.3 * x > -0.6)).astype(np.uint8)))


def published(mapper):
    mapper.SetOcclusionMethodToPublished()


def colored(mapper):
    mapper.SetAttenuationColor(1.0, 0.5, 0.2)


def two_lights(mapper):
    mapper.SetLightDirection(0.6, 0.4, 1.0)
    mapper.SetSecondLightDirection(-0.5, 0.1, 1.0)
    mapper.SetSecondLightShare(0.3)
    mapper.SetOcclusionResolution(0)


def smooth(mapper):
    mapper.SetGeometryAntiAliasingToMultiSample()


# with what is left where shading, or the table of two quantities, is ignored
CONTENTS = {
    "lit shells": (lit(shells), shells),
    "lit peaks": (lit(peak), peak),
    "lit fog of steep gradients": (steep(lit(fog)), fog),
    "a lit ball of nearest samples": (lit(nearest(soft_ball)), nearest(soft_ball)),
    "a table over the gradient, lit": (plane(fog, True), fog),
}
SETUPS = {
    "cropped and clipped": (cut, None),
    "masked": (masked, None),
    "by the published method": (published, tubes),
    "under coloured light": (colored, tubes),
    "under two lights from aside": (two_lights, tubes),
    "with translucent layers": (lambda mapper: None, veiled_tubes),
    "with layers and edges": (smooth, veiled_tubes),
    "cropped, with layers under coloured light": (lambda mapper: (cut(mapper), colored(mapper)), veiled_tubes),
}


class Together(Agreement):
    def test_what_gradients_do_beside_all_the_rest(self):
        lights = LIGHTS["a headlight and a scene light"]()
        for name, (content, plain) in CONTENTS.items():
            for k, (setting, (setup, geometry)) in enumerate(SETUPS.items()):
                with self.subTest(name, setting=setting):
                    self.check(
                        content,
                        setup=setup,
                        geometry=geometry,
                        lights=lights,
                        parallel=k % 2 == 1,
                        darkens=False,
                        without={"content": plain},
                    )

    def test_a_second_array_beside_all_the_rest(self):
        for setting, (setup, geometry) in SETUPS.items():
            with self.subTest(setting):
                self.check(
                    plane(with_second(fog)),
                    setup=lambda mapper: (by_second(mapper), setup(mapper)),
                    geometry=geometry,
                    darkens=False,
                    without={"setup": setup},
                )


if __name__ == "__main__":
    unittest.main()
