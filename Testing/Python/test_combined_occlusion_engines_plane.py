# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""vtkChiCombinedOcclusionVolumeMapper: the OpenGL engine reads two-dimensional transfer functions as the CPU engine."""
import unittest

import numpy as np
from engine_agreement import N, OPENGL, Agreement, fog, render, soft_ball, tubes
from engine_contents import by_second, plane, with_second
from occlusion_lights import LIGHTS
from occlusion_scene import ball, image, transfer_plane, volume_property
from vtkmodules.util.numpy_support import numpy_to_vtk


class OverTheGradient(Agreement):
    def test_shaded_and_unshaded_with_and_without_geometry_in_both_projections(self):
        for content in (fog, soft_ball):
            for shade in (False, True):
                for parallel in (False, True):
                    for geometry in (None, tubes):
                        with self.subTest(content=content.__name__, shade=shade, parallel=parallel, geometry=geometry):
                            self.check(
                                plane(content, shade),
                                parallel=parallel,
                                geometry=geometry,
                                darkens=False,
                                without={"content": content},
                            )

    def test_tables_of_every_size(self):
        # tables are refined to about 1024 x 256; larger ones fill several rows of their texture each
        for width, height in ((2, 2), (3, 300), (700, 5), (5000, 40)):
            with self.subTest(width=width, height=height):
                self.check(plane(fog, width=width, height=height), darkens=False, without={"content": fog})

    def test_sharp_tables_are_integrated_along_the_scalar(self):
        """Where one segment crosses most of the table, its middle alone says little."""
        for content in (fog, soft_ball):
            for factor in (0.4, 1.0, 1.7):
                with self.subTest(content=content.__name__, factor=factor):
                    self.check(
                        plane(content, width=700, peaks=12.0, opacity=0.9),
                        setup=lambda mapper: mapper.SetSampleDistance(factor * 2.0 / (N - 1)),
                        darkens=False,
                        without={"content": plane(content, width=700, opacity=0.9)},
                    )

    def test_scalar_types_lights_and_interpolation(self):
        for dtype in (np.uint8, np.int16, np.float64):
            for nearest in (False, True):

                def content():
                    values = np.round(255.0 * ball(N, radius=0.6, soft=0.9)).astype(dtype)
                    return image(values, (0.08, 0.09, 0.07)), volume_property(255.0, 0.3, 0.1)

                with self.subTest(dtype=dtype.__name__, nearest=nearest):
                    self.check(
                        plane(content, True, nearest),
                        lights=LIGHTS["two coloured lights"](),
                        darkens=False,
                        without={"content": content},
                    )

    def test_without_skipping(self):
        self.check(
            plane(fog),
            setup=lambda mapper: mapper.SkippingOff(),
            geometry=tubes,
            darkens=False,
            without={"content": fog},
        )


class OverASecondArray(Agreement):
    def test_shaded_and_unshaded_with_and_without_geometry_in_both_projections(self):
        for content in (fog, soft_ball):
            for shade in (False, True):
                for parallel in (False, True):
                    for geometry in (None, tubes):
                        with self.subTest(content=content.__name__, shade=shade, parallel=parallel, geometry=geometry):
                            self.check(
                                plane(with_second(content), shade),
                                setup=by_second,
                                parallel=parallel,
                                geometry=geometry,
                                darkens=False,
                                # over the gradient instead
                                without={"setup": lambda mapper: None},
                            )

    def test_nearest_samples_and_what_is_not_finite(self):
        for nearest in (False, True):
            for hole in (False, True):
                with self.subTest(nearest=nearest, hole=hole):
                    made = plane(with_second(fog, hole), nearest=nearest, opacity=0.2)
                    picture = self.check(made, setup=by_second, darkens=False, without={"setup": lambda mapper: None})
                    if hole:  # and it is transparent
                        whole = render(OPENGL, plane(with_second(fog), nearest=nearest, opacity=0.2), by_second)[0]
                        self.assertGreater(255.0 * (whole[..., 3] - picture[..., 3]).max(), 10.0)


class Changes(Agreement):
    def test_tables_and_arrays(self):
        def edits(scene, mapper, data, prop):
            def edit_array():
                second = data.GetPointData().GetArray("second")
                second.DeepCopy(numpy_to_vtk(np.linspace(20.0, 80.0, N**3, dtype=np.float32), deep=True))
                second.SetName("second")
                second.Modified()
                data.Modified()

            return (
                lambda: prop.SetTransferFunction2D(transfer_plane(opacity=0.2)),
                lambda: by_second(mapper),
                edit_array,
                lambda: prop.SetTransferFunctionModeTo1D(),
                lambda: prop.SetTransferFunctionModeTo2D(),
                lambda: mapper.SetTransfer2DYAxisArray(None),
            )

        self.check_edits(plane(with_second(fog)), edits)


if __name__ == "__main__":
    unittest.main()
