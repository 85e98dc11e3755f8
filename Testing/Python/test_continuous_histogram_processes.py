# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Continuous histograms of pieces in two processes: run by mpiexec -np 2. Each process makes the whole too, has its
histogram alone, and compares."""
import numpy as np
from mpi4py import MPI
from two_processes import TwoProcesses, hide_layers, main, named, updated  # before VTK's controller: it calls MPI_Init
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource

from chiaroscuro import vtkChiContinuousHistogram

N = 20  # cells along an axis
COLUMNS = ("BinCenter", "Density", "IsoArea", "Mass", "Cumulative")


def image(first, last, shift=0.0):
    """The part of the unit cube between two layers of points."""
    data = vtkImageData()
    data.SetExtent(0, N, 0, N, first, last)
    data.SetSpacing(1 / N, 1 / N, 1 / N)
    z, y, x = np.meshgrid(np.arange(first, last + 1), np.arange(N + 1), np.arange(N + 1), indexing="ij")
    values = shift + np.sin(3 * x / N) + y * z / N / N
    data.GetPointData().SetScalars(named(values.ravel(), "u"))
    return data


def as_list(data):
    cells = vtkAppendFilter()
    cells.SetInputData(data)
    cells.Update()
    return cells.GetOutput()


def histogram_of(data, controller, ends=None):
    histogram = vtkChiContinuousHistogram()
    histogram.SetController(controller)
    histogram.SetInputData(data)
    histogram.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "u")
    histogram.SetNumberOfBins(50)
    histogram.SetNumberOfMoments(6)
    if ends:
        histogram.AutomaticRangeOff()
        histogram.SetRange(*ends)
    return updated(histogram)


def table(histogram):
    return {name: vtk_to_numpy(histogram.GetOutput().GetColumnByName(name)).copy() for name in COLUMNS}


class Processes(TwoProcesses):
    def compare(self, piece, whole, ends=None):
        together, alone = histogram_of(piece, self.world, ends), histogram_of(whole, None, ends)
        self.assertEqual(together.messages + alone.messages, [])
        ours, expected = table(together), table(alone)
        for name in COLUMNS:
            # sums of the same parts in another order, some 1e3 to a bin of 1e-2 of the whole
            np.testing.assert_allclose(ours[name], expected[name], rtol=0, atol=1e-14 * np.abs(expected[name]).max())
            both = MPI.COMM_WORLD.allgather(ours[name].tobytes())
            self.assertEqual(both[0], both[1])  # the bits are the same in all
        for name in ("TotalMass", "MassBelowRange", "MassAboveRange", "SingularMass", "Mean", "Variance"):
            self.assertAlmostEqual(getattr(together, "Get" + name)(), getattr(alone, "Get" + name)(), 13)
        for order in range(7):
            self.assertAlmostEqual(together.GetMoment(order) / alone.GetMoment(order), 1, 12)
            self.assertAlmostEqual(together.GetCentralMoment(order), alone.GetCentralMoment(order), 12)
        for share in (0, 0.1, 0.5, 0.77, 1, 0.5):
            # both are within 1e-12 of the range, which is 2
            self.assertAlmostEqual(together.GetQuantile(share), alone.GetQuantile(share), 11)

    def test_there_are_two(self):
        self.assertEqual(self.world.GetNumberOfProcesses(), 2)
        self.assertIs(vtkChiContinuousHistogram().GetController(), self.world)

    def test_pieces_of_an_image(self):
        piece = image(0, 13) if self.rank == 0 else image(13, N)
        self.compare(piece, image(0, N))
        self.compare(piece, image(0, N), (0.3, 1.1))

    def test_pieces_of_a_list(self):
        self.compare(as_list(image(0, 7) if self.rank == 0 else image(7, N)), as_list(image(0, N)))

    def test_kept_pieces_beside_new_ones(self):
        together = histogram_of(image(0, 13) if self.rank == 0 else image(13, N), self.world)
        before = together.GetQuantile(0.5)
        if self.rank == 1:  # the other one's bins are kept, this one's are not
            together.SetInputData(image(13, N, 0.5))
        together.SetNumberOfBins(60)
        together.Update()
        self.assertGreater(together.GetQuantile(0.5), before)
        self.assertEqual(together.messages, [])

    def test_an_empty_piece(self):
        self.compare(image(0, N) if self.rank == 0 else vtkUnstructuredGrid(), image(0, N))
        self.compare(vtkUnstructuredGrid() if self.rank == 0 else as_list(image(0, N)), as_list(image(0, N)))

    def test_a_layer_that_both_hold_counts_once(self):
        piece = image(0, 16) if self.rank == 0 else image(8, N)
        if self.rank == 1:
            hide_layers(piece, 8)
        self.compare(piece, image(0, N))

    def test_polygons_beside_cells_of_volume_do_not_count(self):
        piece = image(0, N)
        if self.rank == 1:
            plane = vtkPlaneSource()
            plane.SetResolution(3, 3)
            plane.Update()
            piece = plane.GetOutput()
            piece.GetPointData().SetScalars(named(np.full(16, 9.0), "u"))
        together, alone = histogram_of(piece, self.world), histogram_of(image(0, N), None)
        self.assertEqual(together.GetTotalMass(), alone.GetTotalMass())
        self.assertEqual(together.GetNumberOfLowerDimensionalCells(), 9 if self.rank == 1 else 0)
        np.testing.assert_allclose(table(together)["Mass"], table(alone)["Mass"], rtol=0, atol=1e-16)

    def test_a_process_that_cannot_go_on_leaves_none_waiting(self):
        piece = image(0, 16) if self.rank == 0 else image(16, N)
        if self.rank == 1:
            piece.GetPointData().RemoveArray("u")
        messages = "\n".join(histogram_of(piece, self.world).messages)
        self.assertIn("another process" if self.rank == 0 else "there is no array", messages)

    def test_an_input_that_has_changed_is_told_to_all(self):
        piece = image(0, 16) if self.rank == 0 else image(16, N)
        together = histogram_of(piece, self.world)
        if self.rank == 1:
            piece.GetPointData().GetScalars().Modified()
        self.assertTrue(np.isnan(together.GetQuantile(0.5)))
        self.assertIn("another process" if self.rank == 0 else "has changed", "\n".join(together.messages))


if __name__ == "__main__":
    main()
