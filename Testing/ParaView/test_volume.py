# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""A volume of vtkChiCombinedOcclusionVolumeMapper in ParaView's render view, which peels translucent
geometry and volumes by default; and without peeling."""
import numpy as np
from paraview.simple import CreateRenderView, Plane, Render, Show, Sphere
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)

from chiaroscuro.vtkChiRendering import vtkChiCombinedOcclusionVolumeMapper

ALPHA = 0.6  # of the fog, a unit
BACKGROUND = 0.2


def fog():
    """White fog, |x|, |y|, |z| <= 1/2."""
    data = vtkImageData()
    data.SetDimensions(11, 11, 11)
    data.SetSpacing(0.1, 0.1, 0.1)
    data.SetOrigin(-0.5, -0.5, -0.5)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ones(11**3, np.float32), deep=True))
    mapper = vtkChiCombinedOcclusionVolumeMapper()
    mapper.SetInputDataObject(data)
    mapper.SetOcclusionStrength(0.0)
    mapper.AutoAdjustQualityOff()
    prop = vtkVolumeProperty()
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    color.AddRGBPoint(1.0, 1.0, 1.0, 1.0)
    opacity.AddPoint(1.0, ALPHA)
    prop.SetColor(color)
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(1.0)
    prop.SetInterpolationTypeToLinear()
    volume = vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(prop)
    return volume, mapper


def pixels(view):
    Render(view)
    grab = vtkWindowToImageFilter()
    grab.SetInput(view.GetRenderWindow())
    grab.ReadFrontBufferOff()
    grab.ShouldRerenderOff()
    grab.SetInputBufferTypeToRGB()
    grab.Update()
    width, height, _ = grab.GetOutput().GetDimensions()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(height, width, 3) / 255.0


def over(color, alpha, behind):
    """Premultiplied colour over what is behind."""
    return color + (1.0 - alpha) * behind


view = CreateRenderView()
view.ViewSize = [120, 120]
view.OrientationAxesVisibility = 0
view.CenterAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [BACKGROUND] * 3
renderer = view.GetClientSideObject().GetRenderer()
assert renderer.GetUseDepthPeeling() and renderer.GetUseDepthPeelingForVolumes()

volume, mapper = fog()
renderer.AddVolume(volume)
glass = Show(Plane(Origin=[-0.8, -0.8, 0.1], Point1=[0.8, -0.8, 0.1], Point2=[-0.8, 0.8, 0.1]), view)
glass.DiffuseColor = [1.0, 0.0, 0.0]
glass.AmbientColor = [1.0, 0.0, 0.0]
glass.Ambient, glass.Diffuse, glass.Specular = 1.0, 0.0, 0.0
glass.Opacity = 0.5
ball = Show(Sphere(Center=[-0.6, -0.6, 0.8], Radius=0.15), view)
ball.DiffuseColor = [0.0, 0.0, 1.0]
ball.AmbientColor = [0.0, 0.0, 1.0]
ball.Ambient, ball.Diffuse = 1.0, 0.0

Render(view)  # the first frame of a view moves its camera
view.CameraPosition = [0.0, 0.0, 4.0]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraParallelProjection = 1
view.CameraParallelScale = 1.0

RED = np.array((1.0, 0.0, 0.0))
for peeling in (True, False):
    renderer.SetUseDepthPeeling(peeling)
    if hasattr(renderer, "SetUseOIT"):  # newer VTK
        renderer.SetUseOIT(not peeling)
    Render(view)
    for azimuth in (0.0, 180.0):
        renderer.GetActiveCamera().Azimuth(azimuth)
        renderer.ResetCameraClippingRange()
        Render(view)
        # were it drawn a second time in the frame, the engine would find that nothing has changed
        assert azimuth == 0.0 or not mapper.GetReusedLastFrame()
        picture = pixels(view)
        assert mapper.GetReusedLastFrame()
        near, far = (0.4, 0.6) if azimuth == 0.0 else (0.6, 0.4)
        fog_alpha = [1.0 - (1.0 - ALPHA) ** length for length in (near, far)]
        behind = over(fog_alpha[1] * np.ones(3), fog_alpha[1], BACKGROUND)
        expected = over(fog_alpha[0] * np.ones(3), fog_alpha[0], over(0.5 * RED, 0.5, behind))
        # 8 bits: the background, the blend and the result
        assert np.abs(picture[60, 60] - expected).max() <= 2.01 / 255.0, (picture[60, 60], expected)
        beside = over(0.5 * RED, 0.5, BACKGROUND)
        assert np.abs(picture[60, 100] - beside).max() <= 2.01 / 255.0, (picture[60, 100], beside)
        assert np.abs(picture[2, 2] - BACKGROUND).max() <= 0.51 / 255.0
    renderer.GetActiveCamera().Azimuth(180.0)
print("volumes in ParaView: ok")
