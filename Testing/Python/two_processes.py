# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that mpiexec -np 2 runs: each process has a piece, makes the whole too, and compares."""
import sys
import unittest

import numpy as np
from algorithm_messages import Messages
from mpi4py import MPI  # before the controller: it calls MPI_Init
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes
from vtkmodules.vtkParallelCore import vtkMultiProcessController
from vtkmodules.vtkParallelMPI import vtkMPIController


def named(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def updated(algorithm):
    """Updated, with `messages`: the texts of its errors, which are not printed."""
    messages = Messages(algorithm)
    algorithm.Update()
    algorithm.messages = messages.errors
    return algorithm


def hide_layers(image, count):
    """The first layers of cells become ghosts."""
    x, y, z = (max(n - 1, 1) for n in image.GetDimensions())
    ghosts = np.zeros((z, y, x), np.uint8)
    ghosts[:count] = vtkDataSetAttributes.DUPLICATECELL
    image.GetCellData().AddArray(named(ghosts.ravel(), vtkDataSetAttributes.GhostArrayName()))


class TwoProcesses(unittest.TestCase):
    def setUp(self):
        self.world = vtkMultiProcessController.GetGlobalController()
        self.rank = self.world.GetLocalProcessId()


def main():
    world = vtkMPIController()
    world.Initialize()
    vtkMultiProcessController.SetGlobalController(world)
    program = unittest.main(exit=False)
    vtkMultiProcessController.SetGlobalController(None)
    world.Finalize(1)  # not MPI itself, which mpi4py ends
    MPI.COMM_WORLD.Barrier()
    sys.exit(not program.result.wasSuccessful())
