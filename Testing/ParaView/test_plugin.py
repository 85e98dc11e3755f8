# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Load the plugin named on the command line; tube the stream lines of a wavelet, on every process."""
import sys

from paraview import servermanager
from paraview.simple import Gradient, LoadPlugin, StreamTracer, Wavelet

LoadPlugin(sys.argv[1], remote=False, ns=globals())
gradient = Gradient(Input=Wavelet(), ScalarArray=["POINTS", "RTData"])
gradient.UpdatePipeline()  # the tracer places its seeds by what is known of its input
tracer = StreamTracer(Input=gradient, SeedType="Point Cloud")
tracer.Vectors = ["POINTS", "Gradient"]
tracer.MaximumStreamlineLength = 3.0
tracer.UpdatePipeline()
assert tracer.GetDataInformation().GetNumberOfCells() > 0
tubes = StreamTubesChiaroscuro(Input=tracer)  # noqa: F821 (comes with the plugin)
tubes.NumberOfSides = 6
tubes.UpdatePipeline()
info = tubes.GetDataInformation()
assert info.GetNumberOfPoints() > 1000, info.GetNumberOfPoints()
names = {info.GetPointDataInformation().GetArrayInformation(i).GetName()
         for i in range(info.GetPointDataInformation().GetNumberOfArrays())}
assert {"RTData", "CurveParameter", "TubeNormals"} <= names, names
curves = servermanager.OutputPort(tubes, 1).GetDataInformation()
assert 0 < curves.GetNumberOfPoints() < info.GetNumberOfPoints()
few = info.GetNumberOfPoints()
tubes.NumberOfSides = 12
tubes.UpdatePipeline()
assert tubes.GetDataInformation().GetNumberOfPoints() == 2 * few
print("stream tubes in ParaView: ok")
