# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The engines' pictures of scenes drawn by lot, in which many features meet."""
import random
import unittest

import numpy as np
from engine_agreement import CPU, OPENGL, Agreement, N, differences, fog, peak, render, shells, tubes, veiled_tubes, veils
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction, vtkPlane


class Lot:
    """A scene by its number."""

    def __init__(self, number):
        draw = random.Random(number)
        self.setters = []

        def use(probability, name, *choices):
            if draw.random() < probability:
                value = draw.choice(choices)
                self.setters.append((name, value if isinstance(value, tuple) else (value,)))

        self.kind = draw.choice((fog, shells, peak))
        self.shaded, self.gradients, self.nearest, self.clipped, self.inside = (
            draw.random() < probability for probability in (0.3, 0.3, 0.15, 0.25, 0.25)
        )
        self.options = {
            "geometry": draw.choice((None, tubes, veils, veiled_tubes)),
            "parallel": draw.random() < 0.4,
            "size": draw.choice((48, 61, 96)),
        }
        use(1.0, "OcclusionResolution", 0, 1)
        use(1.0, "NumberOfDirections", 1, 4, 6, 16, 17, 40, 64)
        use(1.0, "ConeAngle", 20.0, 45.0, 70.0)
        use(0.5, "AttenuationColor", (1.0, 0.5, 0.2), (0.3, 1.0, 0.3), (0.0, 0.0, 2.0))
        use(0.6, "LightDirection", (0.5, 0.2, 1.0), (-0.8, 0.3, 0.6))
        if draw.random() < 0.25:
            use(1.0, "OcclusionMethod", 1)
        elif draw.random() < 0.25:
            use(1.0, "SecondLightDirection", (0.3, -0.4, 1.0))
            use(1.0, "SecondLightShare", 0.4)
        use(0.4, "GeometryAntiAliasing", 1)
        use(0.4, "OcclusionBias", 0.0, 0.3)
        use(0.4, "SampleDistance", 0.8 / (N - 1), 3.2 / (N - 1))
        use(0.3, "OcclusionStrength", 0.0, 0.5)
        use(0.4, "VicinityDistance", 0.03)
        use(0.3, "GeometryThickness", 0.4, 1.0e300)
        use(0.3, "GeometryOpacity", 0.5)
        use(0.2, "Skipping", False)
        for name in ("VolumeToVolume", "VolumeToGeometry", "GeometryToVolume", "GeometryToGeometry"):
            use(0.15, name, False)
        if draw.random() < 0.25:
            use(1.0, "Cropping", 1)
            use(1.0, "CroppingRegionPlanes", (-0.5, 0.5, -0.5, 0.5, -0.5, 0.5))
            use(1.0, "CroppingRegionFlags", 0x2EBFEBA)

    def content(self):
        data, prop = self.kind()
        if self.shaded:
            prop.ShadeOn()
        if self.nearest:
            prop.SetInterpolationTypeToNearest()
        if self.gradients:
            steep = vtkPiecewiseFunction()
            steep.AddPoint(0.0, 0.1)
            steep.AddPoint(20.0 if self.kind is fog else 0.1, 1.0)
            prop.SetGradientOpacity(steep)
        return data, prop

    def setup(self, mapper):
        for name, value in self.setters:
            getattr(mapper, "Set" + name)(*value)
        if self.clipped:
            plane = vtkPlane()
            plane.SetNormal(0.6, 0.3, -1.0)
            plane.SetOrigin(0.1, 0.0, 0.3)
            mapper.AddClippingPlane(plane)

    def look(self, scene):
        if self.inside:  # the volume goes on beyond all rims
            camera = scene.renderer.GetActiveCamera()
            camera.ParallelProjectionOff()
            camera.SetPosition(0.1, 0.2, 0.3)
            camera.SetFocalPoint(-0.5, 0.1, -2.0)
            camera.SetViewAngle(30.0)
            camera.SetClippingRange(0.05, 10.0)

    def render(self, engine):
        return render(engine, self.content, self.setup, look=self.look, **self.options)


class Together(Agreement):
    def test_scenes_by_lot(self):
        largest = 0.0
        for number in range(24):
            lot = Lot(number)
            cpu, cpu_visibility, _ = lot.render(CPU)
            gpu, gpu_visibility, mapper = lot.render(OPENGL)
            self.assertEqual(mapper.GetEngineInUse(), OPENGL, mapper.GetEngineReason())
            for name, a, b in (("picture", cpu, gpu), ("visibility", cpu_visibility, gpu_visibility)):
                with self.subTest(number=number, name=name, lot=vars(lot)):
                    self.assertTrue(np.isfinite(b).all())
                    where = cpu[..., 3] > 0.0 if name == "picture" else np.ones(cpu.shape[:2], bool)
                    mean, most = differences(a, b, where)
                    print(f"{number} {name}: mean {mean:.4f}, 99 % {most:.4f} of 255")
                    self.assertLessEqual(mean, self.MEAN)
                    self.assertLessEqual(most, self.PERCENTILE_99)
            largest = max(largest, cpu[..., 3].max())
        self.assertGreater(largest, 0.9)


if __name__ == "__main__":
    unittest.main()
