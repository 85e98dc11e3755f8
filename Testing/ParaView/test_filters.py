# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scatterplot, histogram, fiber surface and derived fields of the plugin named on the command line: results are those
of the VTK classes used directly, bit for bit, on an image and on an unstructured grid; what makes no sense is named."""
import sys

import numpy as np
from paraview.simple import (
    AppendDatasets,
    Calculator,
    CreateRenderView,
    GroupDatasets,
    Hide,
    LoadPlugin,
    OutputPort,
    PointDatatoCellData,
    PolyLineSource,
    Render,
    ResetCamera,
    Show,
    Tetrahedralize,
    Wavelet,
)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

from chiaroscuro.vtkChiFilters import (
    vtkChiContinuousHistogram,
    vtkChiContinuousScatterplot,
    vtkChiDerivedFields,
    vtkChiFiberSurface,
)

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
LoadPlugin(sys.argv[1], remote=False, ns=globals())
from paraview_messages import messages, said  # noqa: E402 (once the plugin has printed what it does)


def data_of(proxy, port=0):
    proxy.UpdatePipeline()
    OutputPort(proxy, port).UpdatePipeline()
    return proxy.GetClientSideObject().GetOutputDataObject(port)


def array_of(data, name):
    for part in (data.GetRowData,) if data.IsA("vtkTable") else (data.GetPointData, data.GetCellData):
        if part().HasArray(name):
            return vtk_to_numpy(part().GetArray(name))
    raise AssertionError(f"{data.GetClassName()} has no array {name}")


def agree(proxy, direct, names, port=0):
    """The same code and the same numbers: the same bytes."""
    direct.Update()
    ours, theirs = data_of(proxy, port), direct.GetOutputDataObject(port)
    assert ours.GetClassName() == theirs.GetClassName()
    for name in names:
        a, b = array_of(ours, name), array_of(theirs, name)
        assert len(a) > 50 and np.ptp(a) > 0, (name, len(a))
        assert a.dtype == b.dtype and a.tobytes() == b.tobytes(), name
    return ours


def number(data, name):
    return data.GetFieldData().GetArray(name).GetValue(0)


def choose(direct, *names):
    for i, name in enumerate(names):
        direct.SetInputArrayToProcess(i, 0, 0, POINTS, name)


wavelet = Wavelet(WholeExtent=[-6, 6, -6, 6, -6, 6])
place = Calculator(Input=wavelet, Function="coords", ResultArrayName="place")
polygon = PolyLineSource(Points=[100, 2, 0, 200, 2, 0, 200, 7, 0, 100, 7, 0], Closed=1)
polygon.UpdatePipeline()
for source in (place, Tetrahedralize(Input=place), AppendDatasets(Input=[place])):
    data = data_of(source)

    # Derived fields.
    fields = DerivedFieldsChiaroscuro(Input=source)  # noqa: F821 (comes with the plugin)
    fields.Array = ["POINTS", "RTData"]
    fields.ComputeSecondDerivative = fields.ComputeLaplacian = fields.ComputeMeanCurvature = 1
    fields.Order = "Fourth"
    direct = vtkChiDerivedFields()
    direct.SetInputData(data)
    choose(direct, "RTData")
    direct.ComputeSecondDerivativeOn()
    direct.ComputeLaplacianOn()
    direct.ComputeMeanCurvatureOn()
    direct.SetOrder(4)
    agree(fields, direct, ["RTData_GradientMagnitude", "RTData_SecondDerivative", "RTData_Laplacian",
                           "RTData_MeanCurvature"])

    # Scatterplots: components, ranges, weights, a matrix.
    plot = ContinuousScatterplotChiaroscuro(Input=source)  # noqa: F821
    plot.FirstArray, plot.SecondArray = ["POINTS", "RTData"], ["POINTS", "place"]
    plot.SecondComponent = "Magnitude"
    plot.Dimensions = [64, 48]
    direct = vtkChiContinuousScatterplot()
    direct.SetInputData(data)
    choose(direct, "RTData", "place")
    direct.SetComponent(1, -1)
    direct.SetDimensions(64, 48)
    ours = agree(plot, direct, ["Density"])
    agree(plot, direct, ["Color"], port=1)
    assert ours.GetDimensions() == (64, 48, 1)
    assert abs(number(ours, "TotalMass") - 12.0**3) < 1e-9 * 12**3  # sums of 13824 or fewer volumes
    assert number(ours, "TotalMass") == direct.GetTotalMass() and number(ours, "MassOutOfRange") == 0
    plot.UseWeight, plot.WeightArray, plot.WeightComponent = 1, ["POINTS", "place"], "Magnitude"
    plot.AutomaticRange, plot.FirstRange, plot.SecondRange = 0, [100, 200], [1, 8]
    plot.LogarithmicDisplay = 0
    choose(direct, "RTData", "place", "place")
    direct.SetComponent(2, -1)
    direct.AutomaticRangeOff()
    direct.SetRange(0, 100, 200)
    direct.SetRange(1, 1, 8)
    direct.LogarithmicDisplayOff()
    ours = agree(plot, direct, ["Density"])
    agree(plot, direct, ["Color"], port=1)
    assert number(ours, "MassOutOfRange") == direct.GetMassOutOfRange() > 0
    plot.UseWeight = 0
    assert abs(number(data_of(plot), "TotalMass") - 12.0**3) < 1e-9 * 12**3
    matrix = ContinuousScatterplotChiaroscuro(Input=source, MatrixArrays=["RTData", "place", "RTData"])  # noqa: F821
    blocks = data_of(matrix)
    assert blocks.IsA("vtkMultiBlockDataSet") and blocks.GetNumberOfBlocks() == 3

    # Histograms.
    histogram = ContinuousHistogramChiaroscuro(Input=source)  # noqa: F821
    histogram.Array, histogram.NumberOfBins = ["POINTS", "place"], 100
    histogram.Component = "Magnitude"
    direct = vtkChiContinuousHistogram()
    direct.SetInputData(data)
    choose(direct, "place")
    direct.SetComponent(-1)
    direct.SetNumberOfBins(100)
    ours = agree(histogram, direct, ["BinCenter", "Density", "IsoArea", "Mass", "Cumulative"])
    assert number(ours, "Mean") == direct.GetMean() and number(ours, "Variance") == direct.GetVariance()
    assert number(ours, "Median") == direct.GetQuantile(0.5)
    histogram.AutomaticRange, histogram.Range = 0, [1, 5]
    direct.AutomaticRangeOff()
    direct.SetRange(1, 5)
    ours = agree(histogram, direct, ["Density"])
    assert number(ours, "MassAboveRange") == direct.GetMassAboveRange() > 0

    # Fiber surfaces.
    fiber = FiberSurfaceChiaroscuro(Input=source, Polygon=polygon)  # noqa: F821
    fiber.FirstArray, fiber.SecondArray = ["POINTS", "RTData"], ["POINTS", "place"]
    fiber.SecondComponent = "Magnitude"
    fiber.GenerateMask = fiber.ExtractComponents = 1
    direct = vtkChiFiberSurface()
    direct.SetInputData(data)
    direct.SetPolygonData(data_of(polygon))
    choose(direct, "RTData", "place")
    direct.SetComponent(1, -1)
    direct.GenerateMaskOn()
    direct.ExtractComponentsOn()
    ours = agree(fiber, direct, ["SegmentId", "SegmentParameter", "RTData"])
    theirs = direct.GetOutput()
    assert vtk_to_numpy(ours.GetPoints().GetData()).tobytes() == vtk_to_numpy(theirs.GetPoints().GetData()).tobytes()
    agree(fiber, direct, ["FiberMask"], port=1)
    fiber.GenerateMask = 0
    assert data_of(fiber, 1).GetNumberOfCells() == 0
    assert messages() == "", said.GetOutput()[-2000:]

# The display port is a picture: its own colours in the view once ParaView's colour map is off.
plot = ContinuousScatterplotChiaroscuro(Input=place)  # noqa: F821
plot.FirstArray, plot.SecondArray, plot.SecondComponent = ["POINTS", "RTData"], ["POINTS", "place"], "Magnitude"
plot.Dimensions = [64, 64]
view = CreateRenderView(ViewSize=[200, 200], OrientationAxesVisibility=0, CenterAxesVisibility=0)
display = Show(OutputPort(plot, 1), view)
assert display.Representation == "Slice", display.Representation
display.MapScalars = 0
display.Scale = [1.0, 20.0, 1.0]
ResetCamera(view)
Render(view)
grab = vtkWindowToImageFilter()
grab.SetInput(view.GetRenderWindow())
grab.ReadFrontBufferOff()
grab.Update()
seen = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int)
wanted = array_of(data_of(plot, 1), "Color")[:, :3].astype(int)
brightest = wanted[wanted.sum(axis=1).argmax()]
assert np.abs(seen - brightest).max(axis=1).min() <= 2, "the largest density's colour is not in the view"
Hide(OutputPort(plot, 1), view)
messages()

# What makes no sense: an error that names it, nothing in the output, and the filter works again.
cells = PointDatatoCellData(Input=place)
group = GroupDatasets(Input=[place, place])


def refused(proxy, *words):
    proxy.UpdatePipeline()
    text = messages()
    for word in words:
        assert word in text, (words, text[:1500])


for make in (ContinuousScatterplotChiaroscuro, FiberSurfaceChiaroscuro):  # noqa: F821
    others = {"Polygon": polygon} if make is FiberSurfaceChiaroscuro else {}  # noqa: F821
    proxy = make(Input=place, FirstArray=["POINTS", "nothing"], SecondArray=["POINTS", "RTData"], **others)
    refused(proxy, "first array", "'nothing'")
    proxy.FirstArray, proxy.SecondArray = ["POINTS", "RTData"], ["POINTS", "none"]
    refused(proxy, "second array", "'none'")
    proxy.SecondArray, proxy.SecondComponent = ["POINTS", "place"], 7
    refused(proxy, "'place'", "has no component 7")
    proxy.SecondComponent = 0
    proxy.UpdatePipeline()
    assert messages().count("ERR") == 0 and proxy.GetDataInformation().GetNumberOfPoints() > 0
    refused(make(Input=group, FirstArray=["POINTS", "RTData"], SecondArray=["POINTS", "place"], **others),
            "vtkMultiBlockDataSet", "vtkMergeBlocks")
refused(FiberSurfaceChiaroscuro(Input=cells, Polygon=polygon, FirstArray=["CELLS", "RTData"],  # noqa: F821
                                SecondArray=["CELLS", "place"]), "'RTData'", "vtkCellDataToPointData")
refused(FiberSurfaceChiaroscuro(Input=place), "port 1", "not optional")  # noqa: F821
refused(ContinuousScatterplotChiaroscuro(Input=place, FirstArray=["POINTS", "RTData"],  # noqa: F821
                                         SecondArray=["POINTS", "place"], Dimensions=[0, 5]), "Dimensions are 0 x 5")
proxy = ContinuousScatterplotChiaroscuro(Input=cells, FirstArray=["CELLS", "RTData"],  # noqa: F821
                                         SecondArray=["CELLS", "place"])
assert data_of(proxy).GetNumberOfPoints() == 256**2 and messages() == ""
refused(ContinuousHistogramChiaroscuro(Input=place, Array=["POINTS", "nothing"]), "'nothing'")  # noqa: F821
refused(ContinuousHistogramChiaroscuro(Input=group, Array=["POINTS", "RTData"]), "vtkMergeBlocks")  # noqa: F821
refused(ContinuousHistogramChiaroscuro(Input=place, Array=["POINTS", "RTData"], AutomaticRange=0,  # noqa: F821
                                       Range=[5, 1]), "the range is [5, 1]")
refused(DerivedFieldsChiaroscuro(Input=place, Array=["POINTS", "nothing"]), "'nothing'")  # noqa: F821
refused(DerivedFieldsChiaroscuro(Input=cells, Array=["CELLS", "RTData"]), "vtkCellDataToPointData")  # noqa: F821
both = data_of(DerivedFieldsChiaroscuro(Input=group, Array=["POINTS", "RTData"]))  # noqa: F821
assert all(both.GetBlock(i).GetPointData().HasArray("RTData_GradientMagnitude") for i in range(2))
assert messages() == ""
print("filters in ParaView: ok")
