// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiTetEngine.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkTimerLog.h"

//------------------------------------------------------------------------------
vtkChiTetEngine::~vtkChiTetEngine()
{
  chi_tet_destroy(nullptr, this->Core);
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::Prepare(const chi_exec* exec)
{
  return this->Core ? CHI_OK : chi_tet_create(exec, &this->Core);
}

//------------------------------------------------------------------------------
void vtkChiTetEngine::CopyStats()
{
  this->Stats = {};
  this->Stats.struct_size = sizeof(this->Stats);
  chi_tet_get_stats(this->Core, &this->Stats);
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::Describe(
  const chi_exec* exec, const chi_tet_frame& frame, chi_tet_plan& plan)
{
  plan.struct_size = sizeof(plan);
  const chi_status status = chi_tet_describe(exec, this->Core, &frame, &plan);
  this->CopyStats();
  return status;
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::Render(
  const chi_exec* exec, vtkOpenGLRenderWindow* window, const chi_tet_frame& frame, int asked)
{
  this->Image = {};
  this->Window = window;
  chi_status status = this->Prepare(exec);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_tet_plan plan = {};
  const auto obstacle = [&]
  {
    const std::string reason = vtkChiTetGL::WhyNot(window, frame);
    if (!reason.empty())
    {
      return reason;
    }
    status = this->Describe(exec, frame, plan);
    return status == CHI_OK ? vtkChiTetGL::WhyNot(window, plan) : std::string();
  };
  const int inUse = this->Choice.Choose(window, asked, obstacle);
  if (status != CHI_OK || (inUse == vtkChiEngineChoice::OPENGL && this->RenderOpenGL(window, plan)))
  {
    return status;
  }
  this->GL.ReleaseGraphicsResources(window);
  return this->RenderCPU(exec, frame);
}

//------------------------------------------------------------------------------
bool vtkChiTetEngine::RenderOpenGL(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  this->Stats.reused = this->GL.Holds(window, plan) ? 1 : 0;
  if (!this->Stats.reused)
  {
    this->Kept.clear();
    glFinish(); // what others have asked of OpenGL is not our time
    const double begin = vtkTimerLog::GetUniversalTime();
    if (!this->GL.Render(window, plan))
    {
      this->Choice.Refuse(window);
      return false;
    }
    glFinish(); // the quality of interactive frames is chosen by the time
    this->Stats.seconds_draw = vtkTimerLog::GetUniversalTime() - begin;
    this->Stats.seconds_total += this->Stats.seconds_draw;
  }
  this->Stats.fragments = this->GL.GetFragments();
  this->Stats.bytes_image = 4 * sizeof(float) * static_cast<std::size_t>(plan.full_width) *
    static_cast<std::size_t>(plan.full_height);
  this->Image.width = plan.full_width;
  this->Image.height = plan.full_height;
  this->Image.rgba = this->Kept.empty() ? nullptr : this->Kept.data(); // read back before
  return true;
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::RenderCPU(const chi_exec* exec, const chi_tet_frame& frame)
{
  const chi_status status = chi_tet_render(exec, this->Core, &frame);
  this->CopyStats();
  if (status == CHI_OK)
  {
    this->Kept.clear();
    chi_tet_get_image(this->Core, &this->Image);
  }
  return status;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiTetEngine::GetLayer()
{
  return this->GetInUse() == vtkChiEngineChoice::OPENGL ? this->GL.GetLayer() : nullptr;
}

//------------------------------------------------------------------------------
bool vtkChiTetEngine::ReadImage()
{
  if (this->GetLayer() && this->Image.width > 0 && !this->Image.rgba &&
    this->GL.ReadLayer(vtkOpenGLRenderWindow::SafeDownCast(this->Window), this->Kept))
  {
    this->Image.rgba = this->Kept.data();
  }
  return this->Image.rgba != nullptr;
}

//------------------------------------------------------------------------------
void vtkChiTetEngine::KeepImage()
{
  if (this->Image.rgba && this->Kept.empty())
  {
    const std::size_t pixels =
      static_cast<std::size_t>(this->Image.width) * static_cast<std::size_t>(this->Image.height);
    this->Kept.assign(this->Image.rgba, this->Image.rgba + 4 * pixels);
    this->Image.rgba = this->Kept.data();
  }
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::FindCells(const chi_exec* exec, const chi_tet_frame& frame,
  double opacity, std::int64_t* cells, float* depths)
{
  this->KeepImage();
  const chi_status status = this->Prepare(exec);
  return status == CHI_OK ? chi_tet_find_cells(exec, this->Core, &frame, opacity, cells, depths)
                          : status;
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::CountViolations(
  const chi_exec* exec, const chi_tet_frame& frame, std::int64_t* violations)
{
  this->KeepImage();
  const chi_status status = this->Prepare(exec);
  return status == CHI_OK ? chi_tet_count_violations(exec, this->Core, &frame, violations) : status;
}

//------------------------------------------------------------------------------
void vtkChiTetEngine::ReleaseGraphicsResources(vtkWindow* window)
{
  this->GL.ReleaseGraphicsResources(window);
  this->Choice.Forget();
}
