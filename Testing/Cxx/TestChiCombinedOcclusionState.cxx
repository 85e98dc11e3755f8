// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// OpenGL's state after the mapper has drawn is what it was before, in VTK's record of it and in
// truth.
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif

#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPolyDataMapper.h"
#include "vtkProp.h"
#include "vtkProperty.h"
#include "vtkRTAnalyticSource.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cstdlib>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

namespace
{
using Snapshot = std::vector<std::pair<std::string, int>>;

// Draws nothing; writes down OpenGL's state when it is its turn among the volumes.
class StateProbe : public vtkProp
{
public:
  static StateProbe* New();
  vtkTypeMacro(StateProbe, vtkProp);
  Snapshot State;

  int RenderVolumetricGeometry(vtkViewport* viewport) override
  {
    this->State.clear();
    const struct
    {
      const char* Name;
      unsigned int Value;
      int Count;
    } items[] = {
      { "GL_BLEND", GL_BLEND, 1 },
      { "GL_DEPTH_TEST", GL_DEPTH_TEST, 1 },
      { "GL_CULL_FACE", GL_CULL_FACE, 1 },
      { "GL_SCISSOR_TEST", GL_SCISSOR_TEST, 1 },
      { "GL_MULTISAMPLE", GL_MULTISAMPLE, 1 },
      { "GL_BLEND_SRC_RGB", GL_BLEND_SRC_RGB, 1 },
      { "GL_BLEND_DST_RGB", GL_BLEND_DST_RGB, 1 },
      { "GL_BLEND_SRC_ALPHA", GL_BLEND_SRC_ALPHA, 1 },
      { "GL_BLEND_DST_ALPHA", GL_BLEND_DST_ALPHA, 1 },
      { "GL_BLEND_EQUATION_RGB", GL_BLEND_EQUATION_RGB, 1 },
      { "GL_BLEND_EQUATION_ALPHA", GL_BLEND_EQUATION_ALPHA, 1 },
      { "GL_DEPTH_FUNC", GL_DEPTH_FUNC, 1 },
      { "GL_DEPTH_WRITEMASK", GL_DEPTH_WRITEMASK, 1 },
      { "GL_COLOR_WRITEMASK", GL_COLOR_WRITEMASK, 4 },
      { "GL_VIEWPORT", GL_VIEWPORT, 4 },
      { "GL_SCISSOR_BOX", GL_SCISSOR_BOX, 4 },
      { "GL_DRAW_FRAMEBUFFER_BINDING", GL_DRAW_FRAMEBUFFER_BINDING, 1 },
      { "GL_READ_FRAMEBUFFER_BINDING", GL_READ_FRAMEBUFFER_BINDING, 1 },
      { "GL_DRAW_BUFFER0", GL_DRAW_BUFFER0, 1 },
      { "GL_READ_BUFFER", GL_READ_BUFFER, 1 },
      { "GL_PIXEL_PACK_BUFFER_BINDING", GL_PIXEL_PACK_BUFFER_BINDING, 1 },
      { "GL_PACK_ALIGNMENT", GL_PACK_ALIGNMENT, 1 },
      { "GL_UNPACK_ALIGNMENT", GL_UNPACK_ALIGNMENT, 1 },
    };
    vtkOpenGLState* state =
      vtkOpenGLRenderWindow::SafeDownCast(vtkRenderer::SafeDownCast(viewport)->GetRenderWindow())
        ->GetState();
    for (const auto& item : items)
    {
      int truth[4] = { 0, 0, 0, 0 };
      int record[4] = { 0, 0, 0, 0 };
      glGetIntegerv(item.Value, truth);
      state->vtkglGetIntegerv(item.Value, record);
      for (int i = 0; i < item.Count; ++i)
      {
        this->State.emplace_back(item.Name, truth[i]);
        this->State.emplace_back(std::string("recorded ") + item.Name, record[i]);
      }
    }
    float clear[4];
    glGetFloatv(GL_COLOR_CLEAR_VALUE, clear);
    for (const float component : clear)
    {
      this->State.emplace_back("GL_COLOR_CLEAR_VALUE", static_cast<int>(1000.0f * component));
    }
    return 1;
  }

protected:
  StateProbe() = default;
  ~StateProbe() override = default;
};
vtkStandardNewMacro(StateProbe);
}

int TestChiCombinedOcclusionState(int, char*[])
{
  vtkNew<vtkRTAnalyticSource> wavelet;
  vtkNew<vtkChiCombinedOcclusionVolumeMapper> mapper;
  mapper->SetInputConnection(wavelet->GetOutputPort());
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(100, 0.0);
  opacity->AddPoint(277, 0.4);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetInterpolationTypeToLinear();
  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(4);
  vtkNew<vtkPolyDataMapper> surface;
  surface->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(surface);
  actor->SetPosition(6, 3, 8);
  vtkNew<vtkActor> glass;
  glass->SetMapper(surface);
  glass->SetPosition(-6, 3, 8);
  glass->GetProperty()->SetOpacity(0.5);
  vtkNew<StateProbe> before;
  vtkNew<StateProbe> after;

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(0.2, 0.3, 0.4);
  renderer->SetViewport(0.25, 0.1, 1.0, 0.9);
  renderer->AddActor(actor);
  renderer->AddActor(glass);
  renderer->AddViewProp(before);
  renderer->AddVolume(volume);
  renderer->AddViewProp(after);
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetSize(80, 70);
  window->AddRenderer(renderer);

  bool good = true;
  for (const int samples : { 0, 4 })
  {
    window->SetMultiSamples(samples);
    vtkIdType slices = 0;
    for (int frame = 0; frame < 3; ++frame) // the first, a moved one, an unchanged one
    {
      if (frame < 2)
      {
        renderer->GetActiveCamera()->Azimuth(10);
      }
      window->Render();
      slices += mapper->GetNumberOfSlices();
      if (before->State.empty() || before->State.size() != after->State.size())
      {
        std::cerr << "the probes were not asked\n";
        return EXIT_FAILURE;
      }
      for (std::size_t i = 0; i < before->State.size(); ++i)
      {
        if (before->State[i] != after->State[i])
        {
          std::cerr << samples << " samples, frame " << frame << ": " << before->State[i].first
                    << " was " << before->State[i].second << " and is " << after->State[i].second
                    << "\n";
          good = false;
        }
      }
    }
    if (slices == 0)
    {
      std::cerr << "nothing was drawn\n";
      good = false;
    }
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
