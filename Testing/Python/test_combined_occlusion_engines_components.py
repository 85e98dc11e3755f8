# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine composes components as the CPU engine does."""
import unittest

import numpy as np
from engine_agreement import N, Agreement, tubes, veiled_tubes
from occlusion_components import interleaved, property_of, waves
from occlusion_scene import Messages, image
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction

RANGES = {np.uint8: (0.0, 255.0), np.int16: (-3000.0, 9000.0), np.uint16: (0.0, 60000.0), np.float32: (0.0, 1.0)}


def fields(count, dtype=np.uint8, weights=(1.0, 1.0, 1.0, 1.0), dependent=False, nearest=False, hole=False):
    """Components along different axes, each with functions of its own."""

    def make():
        values = waves(count, np.float64, N) / 255.0
        if dependent:
            values[..., :-1] = 0.25 + 0.75 * values[..., :-1]  # no black
        low, high = RANGES.get(dtype, (0.0, 1.0e5))
        values = low + (high - low) * values
        values = np.round(values).astype(dtype) if np.issubdtype(dtype, np.integer) else values.astype(dtype)
        if hole:
            values[8:14, 6:15, 5:18, count - 1] = np.nan
        prop = property_of(count, weights, high - low)
        for k in range(count):
            functions = (prop.GetRGBTransferFunction(k), prop.GetScalarOpacity(k))
            for function, width in zip(functions, (6, 4)):
                nodes = []
                for i in range(function.GetSize()):
                    node = [0.0] * width
                    function.GetNodeValue(i, node)
                    nodes.append(node)
                function.RemoveAllPoints()
                for node in nodes:
                    add = function.AddRGBPoint if width == 6 else function.AddPoint
                    add(node[0] + low, *node[1 : 4 if width == 6 else 2])
        prop.SetIndependentComponents(not dependent)
        if nearest:
            prop.SetInterpolationTypeToNearest()
        return interleaved(values), prop

    return make


def uneven(mapper):
    """Cuts of every kind."""
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, N),) * 3, indexing="ij")
    mapper.CroppingOn()
    mapper.SetCroppingRegionPlanes(-0.35, 0.3, -0.4, 0.45, -0.3, 0.25)
    mapper.SetCroppingRegionFlags(0x1234567)
    mapper.SetMaskTypeToBinary()
    mapper.SetMaskInput(image(((x + 0.5 * y < 0.5) & (z - 0.3 * x > -0.7)).astype(np.uint8)))


class Components(Agreement):
    def check_components(self, content, without, **options):
        return self.check(content, darkens=False, without={"content": without}, **options)

    def test_independent_ones_in_both_projections_with_and_without_geometry(self):
        for count in (2, 3, 4):
            for parallel in (False, True):
                for geometry in (None, tubes):
                    with self.subTest(count=count, parallel=parallel, geometry=geometry):
                        # the last one left out
                        weights = [1.0] * (count - 1) + [0.0] * (5 - count)
                        self.check_components(
                            fields(count), fields(count, weights=weights), parallel=parallel, geometry=geometry
                        )

    def test_weights(self):
        even = (1.0, 1.0, 1.0, 1.0)
        for weights in ((1.0, 0.5, 0.2, 0.0), (0.0, 1.0, 0.4, 0.7), (0.3, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)):
            with self.subTest(weights=weights):
                self.check_components(fields(4, weights=weights), fields(4, weights=even))

    def test_dependent_ones_in_both_projections_with_and_without_geometry(self):
        for count in (2, 4):
            for parallel in (False, True):
                for geometry in (None, tubes):
                    with self.subTest(count=count, parallel=parallel, geometry=geometry):
                        self.check_components(
                            fields(count, dependent=True), fields(count), parallel=parallel, geometry=geometry
                        )

    def test_types_of_samples(self):
        for dtype in (np.int16, np.uint16, np.float32, np.float64, np.int32):
            for count, dependent in ((2, False), (3, False), (4, False), (2, True)):
                with self.subTest(dtype=dtype.__name__, count=count, dependent=dependent):
                    self.check_components(fields(count, dtype, dependent=dependent), fields(1, dtype))
        # colours of dependent ones that are no bytes are 0 ... 1
        self.check_components(fields(4, np.float32, dependent=True), fields(4, np.float32))

    def test_nearest_samples(self):
        for count, dependent in ((2, False), (4, False), (2, True), (4, True)):
            with self.subTest(count=count, dependent=dependent):
                self.check_components(
                    fields(count, nearest=True, dependent=dependent), fields(count, dependent=dependent)
                )

    def test_what_is_not_finite(self):
        for count, dependent in ((2, False), (3, False), (2, True), (4, True)):
            for nearest in (False, True):
                with self.subTest(count=count, dependent=dependent, nearest=nearest):
                    options = {"dependent": dependent, "nearest": nearest}
                    self.check_components(
                        fields(count, np.float32, hole=True, **options),
                        fields(count, np.float32, **options),
                        setup=Messages,  # one warning is right
                    )

    def test_cuts_and_translucent_layers(self):
        for nearest in (False, True):
            for content in (fields(3, nearest=nearest), fields(4, dependent=True, nearest=nearest)):
                self.check(content, setup=uneven, geometry=veiled_tubes, darkens=False, without={"setup": lambda mapper: None})

    def test_slices_closer_and_wider_than_a_voxel_and_without_skipping(self):
        for factor in (0.3, 1.7):
            for content in (fields(3), fields(2, dependent=True)):
                with self.subTest(factor=factor):
                    self.check_components(
                        content,
                        fields(1),
                        setup=lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1)),
                    )
        self.check_components(fields(3), fields(1), setup=lambda mapper: mapper.SkippingOff())


class Changes(Agreement):
    def test_components_functions_and_weights(self):
        def edits(scene, mapper, data, prop):
            dense = vtkPiecewiseFunction()
            dense.AddPoint(0.0, 0.0)
            dense.AddPoint(255.0, 0.6)
            return (
                lambda: prop.SetComponentWeight(2, 0.0),
                lambda: prop.SetScalarOpacity(1, dense),
                lambda: prop.IndependentComponentsOff(),
                lambda: mapper.SetInputDataObject(fields(2)()[0]),
                lambda: prop.IndependentComponentsOn(),
                lambda: mapper.SetInputDataObject(fields(1)()[0]),
            )

        self.check_edits(fields(4), edits)


if __name__ == "__main__":
    unittest.main()
