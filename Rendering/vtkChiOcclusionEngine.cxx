// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiOcclusionEngine.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkTimerLog.h"

#include <algorithm>

//------------------------------------------------------------------------------
vtkChiOcclusionEngine::~vtkChiOcclusionEngine()
{
  chi_occlusion_destroy(nullptr, this->Core);
}

//------------------------------------------------------------------------------
chi_status vtkChiOcclusionEngine::Prepare(const chi_exec* exec)
{
  return this->Core ? CHI_OK : chi_occlusion_create(exec, &this->Core);
}

//------------------------------------------------------------------------------
chi_status vtkChiOcclusionEngine::Render(const chi_exec* exec, vtkOpenGLRenderWindow* window,
  const chi_occlusion_frame& frame, int asked, bool half)
{
  this->Image = {};
  this->Window = window;
  const chi_status prepared = this->Prepare(exec);
  if (prepared != CHI_OK)
  {
    return prepared;
  }
  const int inUse =
    this->Choice.Choose(window, asked, [&] { return vtkChiOcclusionGL::WhyNot(window, frame); });
  if (inUse == OPENGL)
  {
    const chi_status status = this->RenderOpenGL(exec, window, frame, half);
    if (status != CHI_OK || this->Choice.GetInUse() == OPENGL)
    {
      return status;
    }
  }
  this->GL.ReleaseGraphicsResources(window);
  const chi_status status = chi_occlusion_render(exec, this->Core, &frame);
  this->Stats.struct_size = sizeof(this->Stats);
  chi_occlusion_get_stats(this->Core, &this->Stats);
  if (status == CHI_OK)
  {
    chi_occlusion_get_image(this->Core, &this->Image);
  }
  return status;
}

//------------------------------------------------------------------------------
chi_status vtkChiOcclusionEngine::RenderOpenGL(
  const chi_exec* exec, vtkOpenGLRenderWindow* window, const chi_occlusion_frame& frame, bool half)
{
  const double start = vtkTimerLog::GetUniversalTime();
  chi_occlusion_plan plan = {};
  plan.struct_size = sizeof(plan);
  const chi_status status = chi_occlusion_describe(exec, this->Core, &frame, &plan);
  this->Stats.struct_size = sizeof(this->Stats);
  chi_occlusion_get_stats(this->Core, &this->Stats);
  if (status != CHI_OK)
  {
    return status;
  }
  double waited = 0.0; // for what others have asked of OpenGL
  if (!this->GL.Holds(window, plan, half))
  {
    const double called = vtkTimerLog::GetUniversalTime();
    glFinish();
    const double begin = vtkTimerLog::GetUniversalTime();
    waited = begin - called;
    this->Stats.reused = 0;
    this->Rgba.clear();
    if (!this->GL.Render(window, plan, half))
    {
      this->Choice.Refuse(window);
      return CHI_OK;
    }
    glFinish(); // the quality of interactive frames is chosen by the time
    this->Stats.samples = this->GL.GetSamples();
    this->Stats.light_updates = this->GL.GetLightUpdates();
    this->Stats.seconds_slices = vtkTimerLog::GetUniversalTime() - begin;
  }
  this->Image.width = plan.full_width;
  this->Image.height = plan.full_height;
  if (!this->Rgba.empty()) // read back before, and nothing has changed
  {
    this->HandOut();
  }
  this->Stats.seconds_total = vtkTimerLog::GetUniversalTime() - start - waited;
  return CHI_OK;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiOcclusionEngine::GetLayer()
{
  return this->Choice.GetInUse() == OPENGL ? this->GL.GetLayer() : nullptr;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiOcclusionEngine::GetVisibility()
{
  return this->Choice.GetInUse() == OPENGL ? this->GL.GetVisibility() : nullptr;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionEngine::HandOut()
{
  this->Image.rgba = this->Rgba.data();
  this->Image.visibility = this->Visibility.data();
  this->Image.visibility_rgb = this->VisibilityRgb.empty() ? nullptr : this->VisibilityRgb.data();
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionEngine::ReadImage()
{
  if (this->Choice.GetInUse() == OPENGL && this->Image.width > 0 && !this->Image.rgba)
  {
    vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(this->Window);
    if (this->GL.ReadLayer(window, this->Rgba) && this->GL.ReadVisibility(window, this->Visibility))
    {
      this->VisibilityRgb.clear();
      if (this->GL.IsColored())
      {
        this->SplitVisibility();
      }
      this->HandOut();
    }
  }
  return this->Image.rgba != nullptr;
}

//------------------------------------------------------------------------------
// Three colours and their mean a pixel.
void vtkChiOcclusionEngine::SplitVisibility()
{
  const std::size_t pixels = this->Visibility.size() / 4;
  this->VisibilityRgb.resize(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i)
  {
    std::copy_n(&this->Visibility[4 * i], 3, &this->VisibilityRgb[3 * i]);
    this->Visibility[i] = this->Visibility[4 * i + 3];
  }
  this->Visibility.resize(pixels);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionEngine::ReleaseGraphicsResources(vtkWindow* window)
{
  this->GL.ReleaseGraphicsResources(window);
  this->Choice.Forget();
}
