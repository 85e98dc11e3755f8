# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Continuous scatterplots of pieces in two processes: run by mpiexec -np 2. Each process makes the whole too, plots it
alone, and compares."""
import numpy as np
from two_processes import TwoProcesses, hide_layers, main, named, updated  # before VTK's controller: it calls MPI_Init
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_TETRA, vtkCellArray, vtkDataObject, vtkImageData,
                                           vtkUnstructuredGrid)

from chiaroscuro import vtkChiContinuousScatterplot

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
N = 24  # cells along an axis: three bricks
BINS = (40, 50)


def fields(x):
    return np.sin(3 * x[:, 0]) + x[:, 1] * x[:, 2], np.cos(2 * x[:, 1]) * x[:, 0] - x[:, 2]


def add_fields(data, x):
    for name, values in zip("uv", fields(x)):
        data.GetPointData().AddArray(named(values, name))
    return data


def image(first, last):
    """The part of the unit cube between two layers of points."""
    data = vtkImageData()
    data.SetExtent(0, N, 0, N, first, last)
    data.SetSpacing(1 / N, 1 / N, 1 / N)
    z, y, x = np.meshgrid(np.arange(first, last + 1), np.arange(N + 1), np.arange(N + 1), indexing="ij")
    return add_fields(data, np.stack([x, y, z], axis=-1).reshape(-1, 3) / N)


def list_of(first, last, ids=True):
    """Some tetrahedra of Kuhn's split, with global ids."""
    axis = np.linspace(0, 1, N + 1)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    places = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    row, plane = N + 1, (N + 1)**2
    base = np.arange((N + 1)**3).reshape(N + 1, N + 1, N + 1)[:-1, :-1, :-1].reshape(-1, 1, 1)
    steps = [(1, row, plane), (1, plane, row), (row, 1, plane), (row, plane, 1), (plane, 1, row), (plane, row, 1)]
    corners = (base + np.array([np.cumsum((0,) + s) for s in steps])).reshape(-1, 4)[first:last]
    grid, points, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(places, deep=True))
    cells.SetData(4, numpy_to_vtkIdTypeArray(corners.astype(np.int64).ravel(), deep=True))
    grid.SetPoints(points)
    grid.SetCells(VTK_TETRA, cells)
    if ids:
        grid.GetCellData().SetGlobalIds(numpy_to_vtkIdTypeArray(np.arange(first, first + len(corners)), deep=True))
    return add_fields(grid, places)


def plot_of(data, controller, ranges=None):
    plot = vtkChiContinuousScatterplot()
    plot.SetController(controller)
    plot.SetInputData(data)
    plot.SetInputArrayToProcess(0, 0, 0, POINTS, "u")
    plot.SetInputArrayToProcess(1, 0, 0, POINTS, "v")
    plot.SetDimensions(*BINS)
    if ranges:
        plot.AutomaticRangeOff()
        for i, ends in enumerate(ranges):
            plot.SetRange(i, *ends)
    return updated(plot)


def result(plot):
    picture = plot.GetOutputDataObject(0)
    return (vtk_to_numpy(picture.GetPointData().GetScalars()).copy(),
            np.array([plot.GetTotalMass(), plot.GetMassOutOfRange(), plot.GetSingularMass()]),
            picture.GetOrigin() + picture.GetSpacing())


class Processes(TwoProcesses):
    def compare(self, piece, whole, bound, ranges=None):
        """Bins to a share of the largest, masses of all; 0: bits."""
        together, alone = plot_of(piece, self.world, ranges), plot_of(whole, None, ranges)
        self.assertEqual(together.messages + alone.messages, [])
        self.assertLessEqual(together.GetNumberOfSimplices(), alone.GetNumberOfSimplices())
        (density, masses, place), (expected, expected_masses, expected_place) = result(together), result(alone)
        self.assertEqual(place, expected_place)
        self.assertGreater(expected.max(), 0)
        np.testing.assert_allclose(density, expected, rtol=0, atol=bound * expected.max())
        np.testing.assert_allclose(masses, expected_masses, rtol=0, atol=min(bound, 1e-12) * expected_masses[0])

    def test_there_are_two(self):
        self.assertEqual(self.world.GetNumberOfProcesses(), 2)
        self.assertIs(vtkChiContinuousScatterplot().GetController(), self.world)

    def test_bricks_of_an_image_have_the_bits_of_the_whole(self):
        piece = image(0, 16) if self.rank == 0 else image(16, N)
        self.compare(piece, image(0, N), 0)
        self.compare(piece, image(0, N), 0, ((0.2, 0.9), (-0.5, 0.3)))

    def test_other_pieces_of_an_image(self):
        self.compare(image(0, 13) if self.rank == 0 else image(13, N), image(0, N), 1e-12)

    def test_runs_of_a_list_have_the_bits_of_the_whole(self):
        end = 20 * 2048
        self.compare(list_of(0, end) if self.rank == 0 else list_of(end, None), list_of(0, None), 0)

    def test_other_pieces_of_a_list(self):
        # Running sums of a run keep 1e-16 of its mass times the condition 1e5 of cells that go by their edges
        # (scatterplot.md, 3): 1e-11 where the largest bin has as much as a run.
        end = 30001
        self.compare(list_of(0, end, False) if self.rank == 0 else list_of(end, None, False), list_of(0, None), 1e-11)

    def test_an_empty_piece(self):
        self.compare(image(0, N) if self.rank == 0 else vtkUnstructuredGrid(), image(0, N), 0)
        self.compare(vtkUnstructuredGrid() if self.rank == 0 else list_of(0, None), list_of(0, None), 0)

    def test_a_layer_that_both_hold_counts_once(self):
        piece = image(0, 16) if self.rank == 0 else image(8, N)
        if self.rank == 1:
            hide_layers(piece, 8)
        self.compare(piece, image(0, N), 1e-12)  # volumes are summed one by one where there are ghosts

    def test_a_process_that_cannot_plot_leaves_none_waiting(self):
        piece = image(0, 16) if self.rank == 0 else image(16, N)
        if self.rank == 1:
            piece.GetPointData().RemoveArray("v")
        messages = "\n".join(plot_of(piece, self.world).messages)
        self.assertIn("another process" if self.rank == 0 else "no second array", messages)


if __name__ == "__main__":
    main()
