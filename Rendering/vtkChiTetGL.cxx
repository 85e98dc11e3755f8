// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiTetGL.h"

#include "vtkChiGLTools.h"
#include "vtkChiTetColorFunctions.h"
#include "vtkChiTetEnlargeFS.h"
#include "vtkChiTetFS.h"
#include "vtkChiTetMaximumFS.h"
#include "vtkChiTetSegmentFunctions.h"
#include "vtkChiTetTableFunctions.h"
#include "vtkChiTetVS.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkShaderProgram.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace vtkChiGLTools;

namespace
{
// A shader with what it calls; one string each, by which programs are found again.
std::string withFunctions(const char* shader, const std::string& functions)
{
  std::string source = shader;
  vtkShaderProgram::Substitute(source, "//CHI::Functions::Dec", functions);
  return source;
}

const char* vertexShader()
{
  static const std::string whole = withFunctions(vtkChiTetVS, vtkChiTetTableFunctions);
  return whole.c_str();
}

const char* fragmentShader()
{
  static const std::string whole = withFunctions(vtkChiTetFS,
    std::string(vtkChiTetTableFunctions) + vtkChiTetSegmentFunctions + vtkChiTetColorFunctions);
  return whole.c_str();
}

const char* maximumShader()
{
  static const std::string whole = withFunctions(vtkChiTetMaximumFS, vtkChiTetTableFunctions);
  return whole.c_str();
}

bool isMaximum(const chi_tet_plan& plan)
{
  return plan.blend == CHI_TET_BLEND_MAXIMUM;
}

std::string definitionsOf(const chi_tet_plan& plan)
{
  return Define("TABLE_WIDTH", TABLE_WIDTH) + Define("PARALLEL", plan.parallel) +
    Define("CELL_DATA", plan.is_cell_data) + Define("HAS_CELLS", plan.cells ? 1 : 0) +
    Define("SEPARATE", plan.opacities || plan.seconds ? 1 : 0) +
    Define("DIRECT", plan.colors ? 1 : 0) + Define("HAS_SECONDS", plan.seconds ? 1 : 0) +
    Define("HAS_PLANE", plan.plane ? 1 : 0) + Define("PLANES", static_cast<int>(plan.plane_count)) +
    Define("HAS_SURFACE", plan.depth ? 1 : 0) + Define("SHADED", plan.shades ? 1 : 0) +
    Define("MAXIMUM", isMaximum(plan) ? 1 : 0) + Define("METHOD", plan.tables.method) +
    Define("METHOD_NONE", CHI_PREINTEGRATION_NONE) +
    Define("METHOD_PARTIAL", CHI_PREINTEGRATION_PARTIAL) +
    Define("METHOD_FULL", CHI_PREINTEGRATION_FULL) + Define("PSI_SIZE", CHI_PSI_SIZE);
}

void setPair(vtkShaderProgram* program, const char* name, double x, double y)
{
  const float pair[2] = { static_cast<float>(x), static_cast<float>(y) };
  program->SetUniform2f(name, pair);
}

// Where a table of two quantities is read.
void setPlane(vtkShaderProgram* program, const chi_tet_plan& plan)
{
  const double last = plan.plane_rows - 1;
  const float place[3] = { static_cast<float>(last / (plan.plane_range[1] - plan.plane_range[0])),
    static_cast<float>(plan.plane_range[0]), static_cast<float>(last) };
  const int size[2] = { plan.tables.count + 1, plan.plane_rows };
  program->SetUniform2i("planeSize", size);
  if (program->IsUniformUsed("planePlace"))
  {
    program->SetUniform3f("planePlace", place);
  }
  if (program->IsUniformUsed("planeStep"))
  {
    program->SetUniformf("planeStep", static_cast<float>(plan.plane_step));
    program->SetUniformi("planeParts", plan.plane_parts);
  }
}
}

//------------------------------------------------------------------------------
std::string vtkChiTetGL::WhyNot(vtkOpenGLRenderWindow* window, const chi_tet_frame& frame)
{
  if (frame.params->projection == CHI_TET_PROJECTION_PUBLISHED)
  {
    return "the published projection is drawn by the CPU engine alone";
  }
  if (frame.params->subpixel_splatting)
  {
    return "small tetrahedra are splatted by the CPU engine alone";
  }
  if (frame.params->occlusion_strength > 0.0 && frame.params->blend == CHI_TET_BLEND_COMPOSITE)
  {
    return "the OpenGL engine does not have occlusion of tetrahedra";
  }
  // the largest of one number carries nothing else along
  if (frame.params->blend == CHI_TET_BLEND_MAXIMUM &&
    (frame.transfer->plane || frame.field->colors))
  {
    return "the OpenGL engine has maximum intensity of one quantity alone, without given colours "
           "(four dependent components) and two-dimensional transfer functions";
  }
  int version[2] = { 0, 0 };
  window->GetOpenGLVersion(version[0], version[1]);
  return version[0] * 10 + version[1] < 32 ? "the OpenGL engine needs OpenGL 3.2" : "";
}

//------------------------------------------------------------------------------
std::string vtkChiTetGL::WhyNot(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  window->MakeCurrent();
  int largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (std::max(plan.full_width, plan.full_height) > largest)
  {
    return "the picture is larger than this OpenGL's textures can be";
  }
  // three texels a point, and what lights make of a tetrahedron likewise
  const std::size_t items =
    std::max({ 3 * plan.point_count, (plan.shades ? 3 : 1) * plan.count, plan.value_count });
  const std::size_t most = static_cast<std::size_t>(largest) * TABLE_WIDTH;
  if (items > std::min<std::size_t>(most, std::numeric_limits<int>::max()))
  {
    return "the mesh is larger than this OpenGL's textures can be";
  }
  return "";
}

//------------------------------------------------------------------------------
bool vtkChiTetGL::Allocate(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  Reserve(this->Layer, window, plan.width, plan.height, 4, false);
  this->Reduced = plan.reduction > 1;
  if (this->Reduced)
  {
    Reserve(this->FullLayer, window, plan.full_width, plan.full_height, 4, false);
  }
  else
  {
    this->FullLayer->ReleaseGraphicsResources(window);
  }
  if (isMaximum(plan))
  {
    Reserve(this->Places, window, plan.width, plan.height, 2, false);
  }
  else
  {
    this->Places->ReleaseGraphicsResources(window);
  }
  return this->Layer->GetHandle() != 0 && this->GetLayer()->GetHandle() != 0;
}

//------------------------------------------------------------------------------
bool vtkChiTetGL::Holds(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->FrameVersion == plan.frame_version && this->GetLayer()->GetHandle() != 0;
}

//------------------------------------------------------------------------------
bool vtkChiTetGL::Render(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (this->Window.GetPointer() != window || this->Layer->GetHandle() == 0)
  {
    this->ReleaseGraphicsResources(this->Window);
    this->Window = window;
  }
  this->Drawn = false;
  this->Fragments = 0;
  this->Pass.Begin(window);
  bool good = this->Allocate(window, plan) && this->Inputs.Update(window, plan);
  if (good)
  {
    this->DrawTetrahedra(plan);
    if (isMaximum(plan))
    {
      this->DrawMaximum(plan);
    }
    if (this->Reduced)
    {
      this->DrawEnlarged(plan);
    }
    good = !this->Pass.HasFailed();
  }
  this->Pass.End();
  this->FrameVersion = plan.frame_version;
  this->Drawn = good;
  return good;
}

//------------------------------------------------------------------------------
void vtkChiTetGL::DrawTetrahedra(const chi_tet_plan& plan)
{
  const chi_rect all = { 0, 0, plan.width, plan.height };
  const bool maximum = isMaximum(plan);
  vtkTextureObject* target = maximum ? this->Places : this->Layer;
  const float nothing = maximum ? -1.0f : 0.0f; // no place in the tables, or no light
  const float clear[4] = { nothing, nothing, nothing, nothing };
  this->Pass.Clear(target, all, clear);
  vtkShaderProgram* program = this->Pass.Use(fragmentShader(), definitionsOf(plan), vertexShader());
  if (!program)
  {
    return;
  }
  this->ReadInputs(program, plan);
  this->SetView(program, plan);
  unsigned int query = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  this->Pass.DrawInstances(
    target, all, maximum ? vtkChiQuadPass::MAXIMUM : vtkChiQuadPass::OVER, plan.sequence_count);
  glEndQuery(GL_SAMPLES_PASSED);
  unsigned int fragments = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &fragments);
  glDeleteQueries(1, &query);
  this->Fragments = static_cast<std::int64_t>(fragments);
}

//------------------------------------------------------------------------------
void vtkChiTetGL::ReadInputs(vtkShaderProgram* program, const chi_tet_plan& plan)
{
  const auto read = [&](const char* name, vtkTextureObject* texture)
  {
    if (texture->GetHandle() != 0 && program->IsUniformUsed(name))
    {
      this->Pass.Read(name, texture);
    }
  };
  read("sequenceTexture", this->Inputs.GetSequence());
  read("vertexTexture", this->Inputs.GetVertices());
  read("pointTexture", this->Inputs.GetPoints());
  read("scalarTexture", this->Inputs.GetScalars());
  read("opacityTexture", this->Inputs.GetOpacities());
  read("cellTexture", this->Inputs.GetCells());
  read("shadeTexture", this->Inputs.GetShades());
  read("colorTexture", this->Inputs.GetColors());
  read("psiTexture", this->Inputs.GetPsi());
  read("depthTexture", this->Inputs.GetDepths());
  read("fullTexture", this->Inputs.GetFull());
  read("directTexture", this->Inputs.GetDirect());
  read("planeTexture", this->Inputs.GetPlane());
  read("secondTexture", this->Inputs.GetSeconds());
  read("surfaceTexture", this->Inputs.GetSurface());
  if (plan.shades)
  {
    const double most = std::numeric_limits<float>::max();
    program->SetUniformf("colorLimit", static_cast<float>(std::min(plan.color_limit, most)));
  }
}

//------------------------------------------------------------------------------
void vtkChiTetGL::SetView(vtkShaderProgram* program, const chi_tet_plan& plan)
{
  const double unit = vtkChiTetTextures::UnitOf(plan);
  const double plane = plan.parallel ? unit : 1.0; // pixels lie at depth 1, or anywhere
  setPair(program, "firstPixel", plan.first[0] / plane, plan.first[1] / plane);
  setPair(program, "pixelStep", plan.step[0] / plane, plan.step[1] / plane);
  setPair(program, "pictureSize", plan.width, plan.height);
  // Rasterisers round corners to 1/16 of a pixel at least, of which half is lost, and floats of
  // 16384 pixels to 1/1024.
  program->SetUniformf("margin", 0.0625f);
  program->SetUniformf("nearDepth", static_cast<float>(plan.near_depth / unit));
  program->SetUniformf("unit", static_cast<float>(unit));
  const chi_segment_tables& tables = plan.tables;
  const double last = tables.count - 1;
  const float place[3] = { static_cast<float>(last / (tables.range[1] - tables.range[0])),
    static_cast<float>(tables.range[0]), static_cast<float>(last) };
  program->SetUniform3f("tablePlace", place);
  if (plan.plane)
  {
    setPlane(program, plan);
  }
  if (plan.plane_count > 0)
  {
    std::vector<float> planes(4 * plan.plane_count);
    for (std::size_t i = 0; i < planes.size(); ++i)
    {
      planes[i] = static_cast<float>(i % 4 == 3 ? plan.planes[i] / unit : plan.planes[i]);
    }
    program->SetUniform4fv("clip", static_cast<int>(plan.plane_count),
      reinterpret_cast<const float(*)[4]>(planes.data()));
  }
}

//------------------------------------------------------------------------------
void vtkChiTetGL::DrawMaximum(const chi_tet_plan& plan)
{
  vtkShaderProgram* program = this->Pass.Use(maximumShader(),
    Define("TABLE_WIDTH", TABLE_WIDTH) + Define("HAS_PLANE", 0) +
      Define("IMAGE_OPACITY", plan.opacity_convention == CHI_OPACITY_IMAGE ? 1 : 0));
  if (!program)
  {
    return;
  }
  this->Pass.Read("placeTexture", this->Places);
  this->Pass.Read("colorTexture", this->Inputs.GetColors());
  program->SetUniformf("maximumPath", static_cast<float>(plan.maximum_path));
  this->Pass.Draw({ this->Layer.Get() }, { 0, 0, plan.width, plan.height });
}

//------------------------------------------------------------------------------
void vtkChiTetGL::DrawEnlarged(const chi_tet_plan& plan)
{
  vtkShaderProgram* program = this->Pass.Use(vtkChiTetEnlargeFS, "");
  if (!program)
  {
    return;
  }
  this->Pass.Read("layerTexture", this->Layer);
  program->SetUniformf("reduction", static_cast<float>(plan.reduction));
  this->Pass.Draw({ this->FullLayer.Get() }, { 0, 0, plan.full_width, plan.full_height });
}

//------------------------------------------------------------------------------
bool vtkChiTetGL::ReadLayer(vtkOpenGLRenderWindow* window, std::vector<float>& rgba)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->Pass.ReadPixels(window, this->GetLayer(), 4, rgba);
}

//------------------------------------------------------------------------------
void vtkChiTetGL::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Drawn = false;
  this->Pass.ReleaseGraphicsResources(window);
  if (!window)
  {
    return;
  }
  this->Inputs.ReleaseGraphicsResources(window);
  for (vtkTextureObject* texture : { this->Layer.Get(), this->Places.Get(), this->FullLayer.Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
}
