# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that run once with each engine of a mapper that has two."""
import unittest

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper


class InEachEngine(unittest.TestCase):
    """Tests of the CPU engine; classes that inherit them, behind InOpenGL, are of the other one."""

    ENGINE = vtkChiCombinedOcclusionVolumeMapper.ENGINE_CPU
    now = ENGINE

    @classmethod
    def setUpClass(cls):
        InEachEngine.now = cls.ENGINE


class InOpenGL:
    ENGINE = vtkChiCombinedOcclusionVolumeMapper.ENGINE_OPENGL


def new_mapper(kind=vtkChiCombinedOcclusionVolumeMapper):
    """A mapper of the engine whose turn it is."""
    mapper = kind()
    mapper.SetEngine(InEachEngine.now)
    return mapper


def check_engine(mapper):
    """The engine asked for has drawn, or none."""
    assert mapper.GetEngineInUse() in (InEachEngine.now, mapper.ENGINE_AUTO), mapper.GetEngineReason()
