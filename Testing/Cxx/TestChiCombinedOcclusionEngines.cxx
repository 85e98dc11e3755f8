// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// Switching between the engines, and releasing them, leaves no texture behind.
#include "ChiTestTextures.h"

#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkActor.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPolyDataMapper.h"
#include "vtkRTAnalyticSource.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

int TestChiCombinedOcclusionEngines(int, char*[])
{
  using Mapper = vtkChiCombinedOcclusionVolumeMapper;
  bool good = true;
  const auto claim = [&good](bool holds, const char* what)
  {
    if (!holds)
    {
      std::cerr << "does not hold: " << what << "\n";
      good = false;
    }
  };
  vtkNew<vtkRTAnalyticSource> wavelet;
  wavelet->SetWholeExtent(0, 7, 0, 7, 0, 7);
  vtkNew<Mapper> mapper;
  mapper->SetInputConnection(wavelet->GetOutputPort());
  mapper->SetNumberOfDirections(4);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(37, 0.0);
  opacity->AddPoint(277, 0.4);
  vtkNew<vtkVolume> volume;
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->SetMapper(mapper);
  vtkNew<vtkSphereSource> ball;
  ball->SetCenter(3, 3, 3); // no light slabs behind the volume
  vtkNew<vtkPolyDataMapper> surface;
  surface->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(surface);
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetSize(12, 10);
  window->AddRenderer(renderer);
  window->Render();
  const int without = ChiCountTextures(window);

  renderer->AddVolume(volume);
  renderer->ResetCamera();
  mapper->SetEngineToCPU();
  window->Render();
  const int cpu = ChiCountTextures(window);
  mapper->SetEngineToOpenGL();
  window->Render();
  claim(mapper->GetEngineInUse() == Mapper::ENGINE_OPENGL, "the OpenGL engine draws");
  const int opengl = ChiCountTextures(window);
  claim(opengl > cpu + 10, "the OpenGL engine keeps its planes in textures");
  int most = 0;
  for (int i = 0; i < 200; ++i)
  {
    mapper->SetEngine(i % 2 ? Mapper::ENGINE_OPENGL : Mapper::ENGINE_CPU);
    window->Render();
    claim(mapper->GetEngineInUse() == mapper->GetEngine(), "each engine draws when it is asked to");
    most = i % 100 == 99 ? std::max(most, ChiCountTextures(window)) : most;
  }
  claim(most <= opengl, "200 switches leave no texture behind");
  mapper->SetEngineToCPU();
  window->Render();
  claim(ChiCountTextures(window) <= cpu, "what the OpenGL engine held is free while the CPU draws");

  // planes of other numbers and sizes
  mapper->SetEngineToOpenGL();
  for (int i = 0; i < 8; ++i)
  {
    mapper->SetNumberOfDirections(4 + 8 * i);
    mapper->SetOcclusionBias(i % 5);
    mapper->SetLightPrecision(i % 2);
    mapper->SetGeometryToGeometry(i % 3 != 0);
    window->SetSize(10 + i, 20 - i);
    window->Render();
  }
  mapper->SetNumberOfDirections(4);
  mapper->SetOcclusionBias(-1.0);
  mapper->SetLightPrecisionToSingle();
  mapper->GeometryToGeometryOn();
  window->SetSize(12, 10);
  window->Render();
  claim(ChiCountTextures(window) <= opengl + 2,
    "what other settings needed is gone"); // two of 17 and more directions

  renderer->RemoveViewProp(volume); // releases its graphics resources
  window->Render();
  claim(ChiCountTextures(window) <= without, "nothing is left of a mapper that has been released");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
