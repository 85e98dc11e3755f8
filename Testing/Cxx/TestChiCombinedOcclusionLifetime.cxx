// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The mapper, its window and its renderer may go in any order, at any time.
#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkActor.h"
#include "vtkCommand.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPolyDataMapper.h"
#include "vtkRTAnalyticSource.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cstdlib>
#include <iostream>
#include <sstream>

namespace
{
class ErrorCounter : public vtkCommand
{
public:
  static ErrorCounter* New() { return new ErrorCounter; }
  void Execute(vtkObject*, unsigned long, void*) override { ++this->Count; }
  int Count = 0;
};

struct Scene
{
  vtkSmartPointer<vtkRenderWindow> Window = vtkSmartPointer<vtkRenderWindow>::New();
  vtkSmartPointer<vtkRenderer> Renderer = vtkSmartPointer<vtkRenderer>::New();
  vtkSmartPointer<vtkVolume> Volume = vtkSmartPointer<vtkVolume>::New();

  explicit Scene(vtkChiCombinedOcclusionVolumeMapper* mapper)
  {
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(100, 0.0);
    opacity->AddPoint(277, 0.4);
    this->Volume->GetProperty()->SetScalarOpacity(opacity);
    this->Volume->GetProperty()->SetInterpolationTypeToLinear();
    this->Volume->SetMapper(mapper);
    vtkNew<vtkSphereSource> ball;
    ball->SetRadius(4);
    vtkNew<vtkPolyDataMapper> surface;
    surface->SetInputConnection(ball->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(surface);
    actor->SetPosition(6, 3, 8);
    this->Renderer->AddActor(actor);
    this->Renderer->AddVolume(this->Volume);
    this->Window->SetMultiSamples(0);
    this->Window->SetOffScreenRendering(1);
    this->Window->SetSize(60, 50);
    this->Window->AddRenderer(this->Renderer);
    this->Window->Render();
  }
};
}

int TestChiCombinedOcclusionLifetime(int, char*[])
{
  bool good = true;
  const auto claim = [&good](bool holds, const char* what)
  {
    if (!holds)
    {
      std::cerr << "does not hold: " << what << "\n";
      good = false;
    }
  };
  vtkNew<vtkRenderWindow> stays; // an X server may restart when its last client leaves
  stays->SetOffScreenRendering(1);
  stays->SetSize(10, 10);
  stays->Render();

  vtkNew<vtkRTAnalyticSource> wavelet;
  auto mapper = vtkSmartPointer<vtkChiCombinedOcclusionVolumeMapper>::New();
  mapper->SetInputConnection(wavelet->GetOutputPort());
  vtkNew<ErrorCounter> errors;
  mapper->AddObserver(vtkCommand::ErrorEvent, errors);
  vtkNew<vtkImageData> image;
  claim(!mapper->GetFloatImage(image), "there is no picture before the first frame");
  claim(image->GetNumberOfPoints() == 0, "and the image is empty then");

  // the window goes first
  {
    Scene scene(mapper);
    claim(mapper->GetFloatImage(image) && image->GetNumberOfPoints() == 3000, "there is a picture");
  }
  claim(!mapper->GetFloatImage(image) && errors->Count == 1,
    "the colours of geometry whose window has gone are an error");

  // two windows in turn, one of them closed in between
  {
    Scene first(mapper);
    {
      Scene second(mapper);
      first.Window->Render();
      second.Window->Render();
    }
    first.Window->Render();
    claim(mapper->GetFloatImage(image), "the first window lives on");

    // the renderer moves to another window
    first.Window->RemoveRenderer(first.Renderer);
    vtkNew<vtkRenderWindow> other;
    other->SetMultiSamples(0);
    other->SetOffScreenRendering(1);
    other->SetSize(60, 50);
    other->AddRenderer(first.Renderer);
    other->Render();
    claim(mapper->GetFloatImage(image), "the renderer may move to another window");
    other->RemoveRenderer(first.Renderer);
  }

  // another size, another mapper, no mapper
  {
    Scene scene(mapper);
    scene.Window->SetSize(31, 77);
    scene.Window->Render();
    claim(mapper->GetFloatImage(image) && image->GetNumberOfPoints() == 31 * 77, "sizes follow");
    vtkNew<vtkChiCombinedOcclusionVolumeMapper> next;
    next->SetInputConnection(wavelet->GetOutputPort());
    scene.Volume->SetMapper(next);
    scene.Window->Render();
    claim(next->GetFloatImage(image), "a new mapper draws");
    scene.Volume->SetMapper(mapper);
    scene.Window->Render();
    vtkNew<vtkImageData> empty;
    mapper->SetInputData(empty);
    scene.Window->Render();
    mapper->SetInputConnection(wavelet->GetOutputPort());
    scene.Window->Render();
    claim(mapper->GetFloatImage(image), "input may be taken away and given back");
  }

  // the mapper goes first
  {
    Scene scene(mapper);
    scene.Volume->SetMapper(nullptr);
    mapper = nullptr;
    scene.Renderer->RemoveViewProp(scene.Volume);
    scene.Window->Render();
  }

  vtkNew<vtkChiCombinedOcclusionVolumeMapper> printed;
  std::ostringstream text;
  printed->Print(text);
  claim(text.str().find("ConeAngle: 45") != std::string::npos, "it prints its settings");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
