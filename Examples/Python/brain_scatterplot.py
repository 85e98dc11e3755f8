# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""A brain's T1 intensity against its gradient, a polygon brushed there, and the fiber surface of that polygon
in the brain."""

import numpy as np
import vtkmodules.all as vtk
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from chiaroscuro import (
    vtkChiCombinedOcclusionVolumeMapper,
    vtkChiContinuousScatterplot,
    vtkChiDerivedFields,
    vtkChiFiberSurface,
)

# Between liquor (T1 50) and white matter (115) without grey matter (85) in between gradients are steep where the
# intensity is that of grey matter: in the walls of the ventricles.
BRUSH = ((82.0, 20.0), (100.0, 20.0), (96.0, 38.0), (82.0, 38.0))
VENTRICLES = (60, 240, 90, 300, 100, 230)  # voxels: without the cortex, some of which is as thin


def read(data):
    """ch2better, smoothed by 0.75 mm, with the magnitude of its gradient a millimetre."""
    reader, single, smooth = vtk.vtkNIFTIImageReader(), vtk.vtkImageCast(), vtk.vtkImageGaussianSmooth()
    gradient = vtkChiDerivedFields()
    reader.SetFileName(f"{data}/ch2better.nii.gz")
    single.SetInputConnection(reader.GetOutputPort())
    single.SetOutputScalarTypeToFloat()
    smooth.SetInputConnection(single.GetOutputPort())
    smooth.SetStandardDeviation(1.5)  # voxels
    smooth.Update()
    smooth.GetOutput().GetPointData().GetScalars().SetName("T1")
    gradient.SetInputData(smooth.GetOutput())
    gradient.ComputeGradientMagnitudeOn()
    gradient.Update()
    return gradient.GetOutput()


def fields(algorithm, image):
    algorithm.SetInputData(image)
    for index, name in enumerate(("T1", "T1_GradientMagnitude")):
        algorithm.SetInputArrayToProcess(index, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, name)
    return algorithm


def table(corners):
    result = vtk.vtkTable()
    for name, values in zip(("T1", "Gradient"), zip(*corners)):
        column = numpy_to_vtk(np.array(values), deep=True)
        column.SetName(name)
        result.AddColumn(column)
    return result


def plot(image):
    """A view of the logarithm of the density, with axes, a colour bar, and the brush."""
    scatterplot = fields(vtkChiContinuousScatterplot(), image)
    scatterplot.AutomaticRangeOff()
    scatterplot.SetRange(0, 40.0, 130.0)
    scatterplot.SetRange(1, 0.0, 40.0)
    scatterplot.Update()
    density = scatterplot.GetOutput(0)
    values = vtk_to_numpy(density.GetPointData().GetScalars())
    low = np.ceil(np.log10(values.max())) - 5.0  # decades that are told apart
    logarithm = numpy_to_vtk(np.maximum(np.log10(np.maximum(values, 1e-300)), low), deep=True)
    density.GetPointData().SetScalars(logarithm)

    chart, colors, view = vtk.vtkChartHistogram2D(), vtk.vtkColorTransferFunction(), vtk.vtkContextView()
    for share, rgb in ((0, (1, 1, 1)), (0.15, (0.9, 0.93, 0.97)), (0.4, (0.62, 0.76, 0.88)), (0.7, (0.22, 0.45, 0.7)),
                       (1, (0.03, 0.1, 0.3))):
        colors.AddRGBPoint(low + 5.0 * share, *rgb)
    chart.SetInputData(density)
    chart.SetTransferFunction(colors)
    line = chart.AddPlot(vtk.vtkChart.LINE)
    line.SetInputData(table(BRUSH + BRUSH[:1]), 0, 1)
    line.GetPen().SetColorF(0.95, 0.45, 0.1)
    line.SetWidth(4)
    chart.SetTitle("log10 of the volume, mm\u00b3, a unit of both")
    chart.GetTitleProperties().SetFontSize(24)
    for axis, title in ((vtk.vtkAxis.BOTTOM, "T1 intensity"), (vtk.vtkAxis.LEFT, "gradient, 1/mm")):
        chart.GetAxis(axis).SetTitle(title)
        chart.GetAxis(axis).GetTitleProperties().SetFontSize(24)
        chart.GetAxis(axis).GetLabelProperties().SetFontSize(22)
    view.GetScene().AddItem(chart)
    view.GetRenderWindow().SetMultiSamples(8)
    return view, scatterplot


def scene(image):
    """The right half of the brain, and the walls of both ventricles as the brush finds them."""
    renderer, brain, volume = vtk.vtkRenderer(), vtkChiCombinedOcclusionVolumeMapper(), vtk.vtkVolume()
    half, middle = vtk.vtkExtractVOI(), vtk.vtkExtractVOI()
    half.SetInputData(image)
    half.SetVOI(138, 300, 0, 369, 0, 315)
    middle.SetInputData(image)
    middle.SetVOI(*VENTRICLES)
    middle.Update()
    fibers, mapper, walls = fields(vtkChiFiberSurface(), middle.GetOutput()), vtk.vtkPolyDataMapper(), vtk.vtkActor()
    fibers.SetPolygonData(table(BRUSH))
    fibers.ExtractComponentsOn()
    fibers.SetMinimumArea(5000.0)  # square millimetres: the ventricles have 20 000, the next piece 3600
    mapper.SetInputConnection(fibers.GetOutputPort())
    mapper.ScalarVisibilityOff()
    walls.SetMapper(mapper)
    walls.GetProperty().SetColor(0.95, 0.45, 0.1)
    renderer.AddActor(walls)
    brain.SetInputConnection(half.GetOutputPort())
    volume.SetMapper(brain)
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    for value, alpha, grey in ((62, 0, 0.7), (78, 0.5, 0.72), (92, 0.8, 0.78), (112, 0.9, 0.98)):
        opacity.AddPoint(value, alpha)
        color.AddRGBPoint(value, grey, 0.96 * grey, 0.9 * grey)
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetColor(color)
    volume.GetProperty().SetInterpolationTypeToLinear()
    renderer.AddVolume(volume)
    renderer.SetBackground(1, 1, 1)
    renderer.GetActiveCamera().SetPosition(-1, 0.35, 0.25)
    renderer.GetActiveCamera().SetViewUp(0, 0, 1)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Zoom(1.35)
    return renderer, fibers


def save_view(view, path, size=1024):
    window, grab, writer = view.GetRenderWindow(), vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    window.SetOffScreenRendering(True)
    window.SetSize(size, size)
    window.Render()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


if __name__ == "__main__":
    from argparse import ArgumentParser
    from save_picture import save

    parser = ArgumentParser(description=__doc__)
    parser.add_argument("data", help="the folder that `make data` fills")
    parser.add_argument("plot", help="PNG of the scatterplot to write")
    parser.add_argument("brain", help="PNG of the brain to write")
    given = parser.parse_args()
    head = read(given.data)
    save_view(plot(head)[0], given.plot)
    save(scene(head)[0], given.brain)
