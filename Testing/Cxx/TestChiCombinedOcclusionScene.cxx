// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// A picture with everything in it: a volume with soft and hard parts, geometry in front of it, in
// it and behind it. Properties first, the baseline second.
#include "ChiTestImage.h"

#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkCylinderSource.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlaneSource.h"
#include "vtkPointData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRTAnalyticSource.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace
{
void addActor(vtkRenderer* renderer, vtkAlgorithm* source, double r, double g, double b)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(source->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(r, g, b);
  renderer->AddActor(actor);
}

double meanVisibility(vtkImageData* image)
{
  vtkDataArray* values = image->GetPointData()->GetScalars();
  double sum = 0.0;
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    sum += values->GetComponent(i, 0);
  }
  return sum / static_cast<double>(std::max<vtkIdType>(values->GetNumberOfTuples(), 1));
}
}

int TestChiCombinedOcclusionScene(int argc, char* argv[])
{
  vtkNew<vtkRTAnalyticSource> wavelet; // 21^3 points, values 37 to 277
  vtkNew<vtkChiCombinedOcclusionVolumeMapper> mapper;
  mapper->SetInputConnection(wavelet->GetOutputPort());
  mapper->SetSampleDistance(0.25);
  mapper->SetNumberOfDirections(
    64); // so that another good set of directions gives the same picture
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(130, 0.25, 0.45, 0.85);
  color->AddRGBPoint(200, 0.95, 0.85, 0.6);
  color->AddRGBPoint(277, 0.85, 0.3, 0.2);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(130, 0.0);
  opacity->AddPoint(190, 0.08);
  opacity->AddPoint(200, 0.7);
  opacity->AddPoint(277, 0.95);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(0.9, 0.9, 0.92);
  renderer->AddVolume(volume);
  vtkNew<vtkPlaneSource> floor;
  floor->SetOrigin(-16, -16, -12);
  floor->SetPoint1(16, -16, -12);
  floor->SetPoint2(-16, 16, -12);
  addActor(renderer, floor, 0.85, 0.82, 0.75);
  vtkNew<vtkCylinderSource> rod;
  rod->SetHeight(30);
  rod->SetRadius(1.2);
  rod->SetResolution(48);
  addActor(renderer, rod, 0.3, 0.7, 0.35);
  vtkNew<vtkSphereSource> ball;
  ball->SetCenter(8, -8, 11);
  ball->SetRadius(3);
  ball->SetThetaResolution(48);
  ball->SetPhiResolution(48);
  addActor(renderer, ball, 0.8, 0.6, 0.2);

  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetSize(240, 200);
  window->AddRenderer(renderer);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(25, -45, 55);
  camera->SetFocalPoint(0, 0, -2);
  camera->SetViewUp(0, 0, 1);
  renderer->ResetCameraClippingRange();
  window->Render();

  bool good = true;
  const auto claim = [&good](bool holds, const char* what)
  {
    if (!holds)
    {
      std::cerr << "does not hold: " << what << "\n";
      good = false;
    }
  };
  claim(!mapper->GetReusedLastFrame(), "the first frame is rendered");
  claim(mapper->GetNumberOfSamples() > 0, "samples are counted");
  claim(
    mapper->GetSecondsTotal() >= mapper->GetSecondsEngine(), "the whole takes longer than a part");
  claim(mapper->GetTimeToDraw() > 0.0, "the time to draw is reported");
  vtkNew<vtkImageData> image;
  claim(mapper->GetVisibilityImage(image), "there is a visibility image");
  const double shaded = meanVisibility(image);
  claim(shaded < 0.97, "something darkens the geometry");
  claim(ChiTestImage::Compare(window, argc, argv, "TestChiCombinedOcclusionScene"),
    "the picture is the baseline");

  window->Render();
  claim(mapper->GetReusedLastFrame(), "an unchanged frame is not rendered again");
  mapper->SetConeAngle(20);
  window->Render();
  claim(mapper->GetVisibilityImage(image) && meanVisibility(image) != shaded,
    "another cone gives another visibility");
  mapper->SetGeometryOcclusion(false);
  window->Render();
  claim(mapper->GetVisibilityImage(image) && meanVisibility(image) == 1.0,
    "without geometry occlusion the geometry is fully visible");

  mapper->ReleaseGraphicsResources(nullptr); // as vtkRenderer::SetRenderWindow does
  mapper->ReleaseGraphicsResources(window);
  mapper->SetGeometryOcclusion(true);
  mapper->SetConeAngle(45);
  window->Render();
  claim(ChiTestImage::Compare(window, argc, argv, "TestChiCombinedOcclusionScene"),
    "the picture comes back after the graphics resources were released");
  renderer->RemoveViewProp(volume);
  window->Render();
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
