# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""The representation "Tetrahedra (Chiaroscuro)" of the plugin named on the command line: pictures are those of
vtkChiProjectedTetrahedraMapper used directly, whatever the data set; properties arrive, and come back from a state
file; input that makes no sense is named."""
import os
import sys
import tempfile

import numpy as np
from paraview.simple import (
    AppendDatasets,
    Calculator,
    ColorBy,
    CreateRenderView,
    Delete,
    FindSource,
    GetActiveView,
    GetColorTransferFunction,
    GetDisplayProperties,
    GetOpacityTransferFunction,
    GroupDatasets,
    Hide,
    LoadPlugin,
    LoadState,
    PointDatatoCellData,
    RenameSource,
    Render,
    ResetCamera,
    ResetSession,
    SaveState,
    Show,
    Sphere,
    Tetrahedralize,
    Threshold,
    Transform,
    TrivialProducer,
    Wavelet,
)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkRectilinearGrid
from vtkmodules.vtkRenderingCore import vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter

from chiaroscuro.vtkChiRendering import vtkChiProjectedTetrahedraMapper

NAME = "Tetrahedra (Chiaroscuro)"
SIZE = 120

LoadPlugin(sys.argv[1], remote=False, ns=globals())
from paraview_messages import messages, said  # noqa: E402 (once the plugin has printed what it does)


def make_view():
    view = CreateRenderView()
    view.ViewSize = [SIZE, SIZE]
    view.OrientationAxesVisibility = 0
    view.CenterAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [0.0, 0.0, 0.0]
    return view


def pixels(view):
    Render(view)
    grab = vtkWindowToImageFilter()
    grab.SetInput(view.GetRenderWindow())
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.SetInputBufferTypeToRGB()
    grab.Update()
    width, height, _ = grab.GetOutput().GetDimensions()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(height, width, 3).astype(int)


def mappers(view):
    """Those that the view draws with."""
    volumes = view.GetClientSideObject().GetRenderer().GetVolumes()
    found = [volumes.GetItemAsObject(i) for i in range(volumes.GetNumberOfItems())]
    found = [v.GetMapper() for v in found if v.GetVisibility()]
    return [m for m in found if isinstance(m, vtkChiProjectedTetrahedraMapper)]


def show(source, view, array="RTData", association="POINTS"):
    display = Show(source, view)
    ColorBy(display, (association, array))
    display.RescaleTransferFunctionToDataRange(False, True)
    display.SetRepresentationType(NAME)
    ResetCamera(view)
    view.GetActiveCamera().Azimuth(25.0)
    view.GetActiveCamera().Elevation(20.0)
    return display


def direct(source, view, array="RTData", association="POINTS", prepare=None):
    """The picture of the mapper itself, in the same view, by the same functions."""
    renderer = view.GetClientSideObject().GetRenderer()
    mapper = vtkChiProjectedTetrahedraMapper()
    mapper.SetInputDataObject(source.GetClientSideObject().GetOutputDataObject(0))
    if association == "POINTS":
        mapper.SetScalarModeToUsePointFieldData()
    else:
        mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectScalarArray(array)
    mapper.AutomaticUnitDistanceOn()
    prop = vtkVolumeProperty()
    prop.SetColor(GetColorTransferFunction(array).GetClientSideObject())
    prop.SetScalarOpacity(GetOpacityTransferFunction(array).GetClientSideObject())
    if prepare:
        prepare(mapper, prop)
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    Hide(source, view)
    renderer.AddVolume(volume)
    picture = pixels(view)
    renderer.RemoveVolume(volume)
    Show(source, view)
    return picture


def agree(picture, other, least=500):
    """The same engine and the same numbers: the same bytes."""
    assert (picture.max(axis=2) > 20).sum() > least, "nothing to be seen"
    assert np.abs(picture - other).max() == 0, np.abs(picture - other).max()


def produce(data, name, values):
    """A source of data with one array of points."""
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.GetPointData().AddArray(array)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    source.UpdatePipeline()
    return source


def as_rectilinear():
    data = vtkRectilinearGrid()
    data.SetDimensions(6, 6, 6)
    ticks = numpy_to_vtk(np.array((0.0, 0.5, 1.5, 2.0, 3.5, 4.0)), deep=True)
    data.SetXCoordinates(ticks)
    data.SetYCoordinates(ticks)
    data.SetZCoordinates(ticks)
    return produce(data, "RTData", [np.linalg.norm(data.GetPoint(i)) for i in range(216)])


def as_colors():
    """A cube of hues, bytes, with a fourth component."""
    data = vtkImageData()
    data.SetDimensions(5, 5, 5)
    places = np.array([data.GetPoint(i) for i in range(125)]) / 4.0
    rgba = np.column_stack([places, np.full(125, 0.6)])
    return produce(data, "RGBA", np.round(255.0 * rgba).astype(np.uint8))


# Every class of data set; functions, unit distance and camera are ParaView's.
wavelet = Wavelet(WholeExtent=[-4, 4, -4, 4, -4, 4])
turned = Transform(Input=wavelet)
turned.Transform.Rotate = [0.0, 30.0, 0.0]
sources = {
    "vtkUnstructuredGrid": Tetrahedralize(Input=wavelet),
    "hexahedra": AppendDatasets(Input=[wavelet]),
    "vtkImageData": wavelet,
    "vtkStructuredGrid": turned,
    "vtkRectilinearGrid": as_rectilinear(),
}
for name, source in sources.items():
    view = make_view()
    display = show(source, view)
    picture = pixels(view)
    (mapper,) = mappers(view)
    assert mapper.GetAutomaticUnitDistance() and mapper.GetNumberOfTetrahedra() > 500, name
    assert name == "hexahedra" or mapper.GetDataSetInput().IsA(name), mapper.GetDataSetInput().GetClassName()
    agree(picture, direct(source, view))
    display.SetRepresentationType("Outline")
    Render(view)
    assert not mappers(view) # away again
    Delete(view)
assert messages() == "", said.GetOutput()

# Transfer functions, moved props, cells, vectors, an opacity array, colours as they are.
view = make_view()
source = Calculator(Input=sources["hexahedra"], Function="coords", ResultArrayName="place")
source = Calculator(Input=source, Function="coordsX+4", ResultArrayName="rising")
both = PointDatatoCellData(Input=source, PassPointData=1)
display = show(both, view)
GetColorTransferFunction("RTData").RGBPoints = [60.0, 1.0, 0.0, 0.0, 280.0, 0.0, 1.0, 0.0]
GetOpacityTransferFunction("RTData").Points = [60.0, 0.0, 0.5, 0.0, 280.0, 0.7, 0.5, 0.0]
first = pixels(view)
agree(first, direct(both, view))
display.Position = [1.0, 0.0, 0.0]
assert np.abs(pixels(view) - first).max() > 20
display.Position = [0.0, 0.0, 0.0]
ColorBy(display, ("CELLS", "RTData"))
picture = pixels(view)
assert np.abs(picture - first).max() > 5
agree(picture, direct(both, view, association="CELLS"))

for component, mode in (("Magnitude", "magnitude"), ("Y", 1)):
    ColorBy(display, ("POINTS", "place", component))
    display.RescaleTransferFunctionToDataRange(False, True)

    def prepare(mapper, prop):
        if mode == "magnitude":
            mapper.SetVectorModeToMagnitude()
        else:
            mapper.SetVectorModeToComponent()
            mapper.SetVectorComponent(mode)

    agree(pixels(view), direct(both, view, "place", prepare=prepare))

ColorBy(display, ("POINTS", "RTData"))
display.OpacityArrayName = ["POINTS", "rising"]
display.UseSeparateOpacityArray = 1
GetOpacityTransferFunction("RTData").Points = [0.0, 0.0, 0.5, 0.0, 8.0, 0.7, 0.5, 0.0]
agree(pixels(view), direct(both, view, prepare=lambda mapper, prop: mapper.SetOpacityArrayName("rising")))
assert messages() == "", said.GetOutput()
display.OpacityArrayName = ["CELLS", "rising"] # not of the points that the colour is of
pixels(view)
assert "opacity array" in messages()
display.UseSeparateOpacityArray = 0
Delete(view)

view = make_view()
rgba = as_colors()
display = show(rgba, view, "RGBA")
GetOpacityTransferFunction("RGBA").Points = [0.0, 0.0, 0.5, 0.0, 255.0, 1.0, 0.5, 0.0]
display.MapScalars = 0
picture = pixels(view)
agree(picture, direct(rgba, view, "RGBA", prepare=lambda mapper, prop: prop.IndependentComponentsOff()))
assert (picture.max(axis=2) - picture.min(axis=2)).max() > 100 # hues of the cube's corners
assert messages() == "", said.GetOutput()
Delete(view)

# Composite data become one mesh.
view = make_view()
far = Transform(Input=wavelet)
far.Transform.Translate = [10.0, 0.0, 0.0]
group = GroupDatasets(Input=[AppendDatasets(Input=[wavelet]), AppendDatasets(Input=[far])])
display = show(group, view)
pixels(view)
(mapper,) = mappers(view)
assert mapper.GetNumberOfTetrahedra() == 2 * 6 * 8**3, mapper.GetNumberOfTetrahedra()
assert messages() == "", said.GetOutput()
Delete(view)

# Interaction draws fewer pixels, never fewer cells.
view = make_view()
display = show(sources["hexahedra"], view)
display.ChiInteractiveImageReduction = 3
display.ChiAutoAdjustQuality = 0
full = pixels(view)
(mapper,) = mappers(view)
assert mapper.GetUsedImageReduction() == 1
view.LODThreshold = 0.0 # megabytes: all data are larger
view.SMProxy.InteractiveRender()
assert mapper.GetUsedImageReduction() == 3, mapper.GetUsedImageReduction()
assert mapper.GetNumberOfTetrahedra() == 6 * 8**3
assert np.array_equal(pixels(view), full) and mapper.GetUsedImageReduction() == 1
Delete(view)

# What makes no sense.
view = make_view()
display = Show(sources["hexahedra"], view)
ColorBy(display, None)
display.SetRepresentationType(NAME)
assert pixels(view).max() == 0
assert "ColorArrayName" in messages()
ColorBy(display, ("POINTS", "RTData"))
assert pixels(view).max() > 20
display.ColorArrayName = ["POINTS", "nowhere"]
assert pixels(view).max() == 0
assert "nowhere" in messages()
ColorBy(display, ("POINTS", "RTData"))
display.UseSeparateOpacityArray = 1
display.OpacityArrayName = ["POINTS", "nowhere"]
assert pixels(view).max() > 20 # the colour's array has the opacity too
assert "'nowhere'" in messages()
Delete(view)
view = make_view()
nothing = Threshold(Input=sources["hexahedra"], Scalars=["POINTS", "RTData"], LowerThreshold=1e6, UpperThreshold=2e6)
display = Show(nothing, view)
display.SetRepresentationType(NAME)
assert pixels(view).max() == 0
surface = AppendDatasets(Input=[Sphere()]) # an unstructured grid of triangles alone
surface = Calculator(Input=surface, Function="coordsX", ResultArrayName="x")
messages()
show(surface, view, "x")
assert pixels(view).max() == 0
assert "no cells of volume" in messages()
Delete(view)

# Every property, to the mapper and through a state file.
ResetSession()
values = {
    "ChiAutomaticUnitDistance": (0, "GetAutomaticUnitDistance"),
    "ChiBlendMode": (1, "GetBlendMode"),
    "ChiPreIntegration": (3, "GetPreIntegration"),
    "ChiVisibilityOrder": (2, "GetVisibilityOrder"),
    "ChiOpacityConvention": (1, "GetOpacityConvention"),
    "ChiEngine": (1, "GetEngine"),
    "ChiImageReduction": (2, "GetImageReduction"),
    "ChiAutoAdjustQuality": (0, "GetAutoAdjustQuality"),
    "ChiFragmentCacheLimit": (7, "GetFragmentCacheLimit"),
    "ChiInteractiveImageReduction": (5, None),
    "ChiShade": (1, None),
}
view = make_view()
source = Tetrahedralize(Input=Wavelet(WholeExtent=[-4, 4, -4, 4, -4, 4]))
RenameSource("cells", source)
display = show(source, view)
assert {p for p in display.ListProperties() if p.startswith("Chi")} == set(values)


def check(display, view):
    Render(view)
    (mapper,) = mappers(view)
    for name, (value, get) in values.items():
        got = display.GetProperty(name).GetData()
        got = {"Maximum Intensity": 1, "Full": 3, "Tangential Distance": 2, "Image": 1, "CPU": 1}.get(got, got)
        assert got == value, (name, got, value)
        assert get is None or getattr(mapper, get)() == value, (name, getattr(mapper, get)(), value)


shaded = pixels(view)
display.ChiShade = 1
assert np.abs(pixels(view) - shaded).max() > 5
for name, (value, _) in values.items():
    display.SMProxy.GetProperty(name).SetElement(0, value)
display.SMProxy.UpdateVTKObjects()
check(display, view)
before = pixels(view)
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "state.pvsm")
    SaveState(path)
    ResetSession()
    LoadState(path)
view = GetActiveView()
display = GetDisplayProperties(FindSource("cells"), view)
assert display.GetProperty("Representation").GetData() == NAME
view.ViewSize = [SIZE, SIZE]
check(display, view)
assert np.array_equal(pixels(view), before)
assert messages() == "", said.GetOutput()
print("tetrahedra in ParaView: ok")
