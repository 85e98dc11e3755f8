# SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
# SPDX-License-Identifier: BSD-3-Clause
"""A renderer to a PNG, smooth at every edge."""
from vtkmodules.vtkImagingCore import vtkImageShrink3D
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkWindowToImageFilter


def save(renderer, path, size=1024):
    """Render once at twice the size, average 2 x 2 pixels, write `path`; returns the window.

    Multisampling would smooth the tubes against each other only: of a pixel that a tube half covers, the
    rest shows what lies behind the volume.
    """
    window, image, writer = vtkRenderWindow(), vtkWindowToImageFilter(), vtkPNGWriter()
    half = vtkImageShrink3D()
    window.SetSize(2 * size, 2 * size)
    window.SetMultiSamples(0)
    window.SetOffScreenRendering(True)
    window.AddRenderer(renderer)
    window.Render()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.ShouldRerenderOff()
    half.SetInputConnection(image.GetOutputPort())
    half.SetShrinkFactors(2, 2, 1)
    half.AveragingOn()
    writer.SetInputConnection(half.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    return window
