// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionAliveFS.h"
#include "vtkChiOcclusionLightFS.h"
#include "vtkChiOcclusionReceiveFS.h"
#include "vtkChiOcclusionSampleFS.h"
#include "vtkChiOcclusionVicinityFS.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkShaderProgram.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace
{
constexpr int FOUR = 4;   // directions a texture
constexpr int BATCH = 16; // directions a pass
constexpr int CHECK = 8;  // slabs from one look at what is still alive to the next

bool isEmpty(const chi_rect& rect)
{
  return rect.x0 >= rect.x1 || rect.y0 >= rect.y1;
}

std::int64_t areaOf(const chi_rect& rect)
{
  return static_cast<std::int64_t>(rect.x1 - rect.x0) * (rect.y1 - rect.y0);
}

std::string define(const char* name, int value)
{
  return std::string("#define ") + name + " " + std::to_string(value) + "\n";
}

// Narrowed for the shader.
template <std::size_t N>
void setUniform(vtkShaderProgram* program, const char* name, const double (&value)[N])
{
  float single[N];
  std::copy(value, value + N, single);
  N == 2 ? program->SetUniform2f(name, single) : program->SetUniform3f(name, single);
}

void setWeights(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
  float weights[3][3];
  for (int i = 0; i < 3; ++i)
  {
    std::copy(plan.light_weight[i], plan.light_weight[i] + 3, weights[i]);
  }
  program->SetUniform3fv("lightWeight", 3, weights);
}

// Slopes and weights of a batch of directions; 0 for those that are not there.
void setDirections(vtkShaderProgram* program, const chi_occlusion_plan& plan, int batch)
{
  float direction[BATCH][2] = {};
  float share[BATCH] = {};
  for (int k = 0; k < BATCH && batch * BATCH + k < plan.directions; ++k)
  {
    const int m = batch * BATCH + k;
    direction[k][0] = plan.direction[m][0];
    direction[k][1] = plan.direction[m][1];
    share[k] = plan.share[m];
  }
  program->SetUniform2fv("direction", BATCH, direction);
  program->SetUniform4fv("share", BATCH / FOUR, share);
}

int targetsOf(const chi_occlusion_plan& plan, int batch)
{
  return (std::min(plan.directions - batch * BATCH, BATCH) - 1) / FOUR + 1;
}

int batchesOf(const chi_occlusion_plan& plan)
{
  return (plan.directions - 1) / BATCH + 1;
}

const char* const lightNames[] = { "lightTexture0", "lightTexture1", "lightTexture2",
  "lightTexture3" };
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::IsSoftware(const std::string& renderer)
{
  std::string lower = renderer;
  std::transform(lower.begin(), lower.end(), lower.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* name : { "llvmpipe", "softpipe", "swiftshader", "swr", "software", "lavapipe",
         "microsoft basic render", "gdi generic" })
  {
    if (lower.find(name) != std::string::npos)
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::GetRendererOf(vtkOpenGLRenderWindow* window)
{
  window->MakeCurrent();
  const GLubyte* name = glGetString(GL_RENDERER);
  return name ? reinterpret_cast<const char*>(name) : "";
}

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::WhyNot(
  vtkOpenGLRenderWindow* window, const chi_occlusion_frame& frame)
{
  const std::uint64_t features = chi_occlusion_features(&frame);
  for (int bit = 0; bit < 64; ++bit)
  {
    const std::uint64_t feature = std::uint64_t(1) << bit;
    if (features & feature)
    {
      return std::string("the OpenGL engine does not have ") + chi_occlusion_feature_name(feature);
    }
  }
  int version[2] = { 0, 0 };
  window->GetOpenGLVersion(version[0], version[1]);
  if (version[0] * 10 + version[1] < 32)
  {
    return "the OpenGL engine needs OpenGL 3.2";
  }
  int largest[2] = { 0, 0 };
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest[0]);
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest[1]);
  const chi_volume_view* volume = frame.volume;
  if (std::max(frame.camera->width, frame.camera->height) + 1 > largest[0] ||
    (volume &&
      *std::max_element(volume->dimensions, volume->dimensions + 3) >
        static_cast<std::size_t>(largest[1])))
  {
    return "the volume or the picture is larger than this OpenGL's textures can be";
  }
  return "";
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::Reserve(
  vtkTextureObject* texture, int width, int height, int components, bool half)
{
  const unsigned int internal =
    components == 4 ? (half ? GL_RGBA16F : GL_RGBA32F) : (half ? GL_R16F : GL_R32F);
  const unsigned int w = static_cast<unsigned int>(width);
  const unsigned int h = static_cast<unsigned int>(height);
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(this->Window);
  texture->SetContext(window);
  if (texture->GetHandle() != 0 && texture->GetWidth() == w && texture->GetHeight() == h &&
    texture->GetInternalFormat(VTK_FLOAT, components, false) == internal)
  {
    return;
  }
  texture->ReleaseGraphicsResources(window);
  texture->SetContext(window);
  texture->SetMinificationFilter(vtkTextureObject::Nearest);
  texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  // outside of the light buffers all light arrives
  texture->SetBorderColor(1.0f, 1.0f, 1.0f, 1.0f);
  texture->SetWrapS(vtkTextureObject::ClampToBorder);
  texture->SetWrapT(vtkTextureObject::ClampToBorder);
  texture->SetInternalFormat(internal);
  texture->SetFormat(components == 4 ? GL_RGBA : GL_RED);
  texture->SetDataType(GL_FLOAT);
  texture->Allocate2D(w, h, components, VTK_FLOAT);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::Reserve(
  TextureList& list, std::size_t count, const chi_occlusion_plan& plan, int components)
{
  for (std::size_t i = count; i < list.size(); ++i)
  {
    list[i]->ReleaseGraphicsResources(this->Window);
  }
  list.resize(count);
  for (auto& texture : list)
  {
    if (!texture)
    {
      texture = vtkSmartPointer<vtkTextureObject>::New();
    }
    this->Reserve(texture, plan.light_width, plan.light_height, components, this->Half);
  }
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::Allocate(const chi_occlusion_plan& plan, bool half)
{
  this->Half = half;
  this->Reserve(this->Layer, plan.width, plan.height, 4, false);
  this->Reserve(this->Received, plan.width, plan.height, 1, false);
  this->Reserve(this->Visibility, plan.width, plan.height, 1, false);
  const std::size_t textures = static_cast<std::size_t>((plan.directions - 1) / FOUR + 1);
  for (int i = 0; i < 2; ++i)
  {
    const bool used = plan.fields > i;
    this->Reserve(this->Tau[i], plan.light_width * plan.light_scale,
      plan.light_height * plan.light_scale, 1, false);
    this->Reserve(this->Fields[i].Light[0], used ? textures : 0, plan, 4);
    this->Reserve(this->Fields[i].Light[1], used ? textures : 0, plan, 4);
    this->Reserve(this->Fields[i].Ring, used ? static_cast<std::size_t>(plan.ring) : 0, plan, 1);
    if (batchesOf(plan) > 1)
    {
      this->Reserve(this->Partial[i], plan.light_width, plan.light_height, 1, false);
    }
  }
  return this->Layer->GetHandle() != 0 && this->Visibility->GetHandle() != 0;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::Clear(const chi_occlusion_plan& plan)
{
  const float zero[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  const float one[4] = { 1.0f, 1.0f, 1.0f, 1.0f };
  const chi_rect picture = { 0, 0, plan.width, plan.height };
  const chi_rect light = { 0, 0, plan.light_width, plan.light_height };
  const chi_rect tau = { 0, 0, plan.light_width * plan.light_scale,
    plan.light_height * plan.light_scale };
  this->Pass.Clear(this->Layer, picture, zero);
  this->Pass.Clear(this->Received, picture, one);
  for (int i = 0; i < 2; ++i)
  {
    this->Pass.Clear(this->Tau[i], tau, zero);
    this->TauDrawn[i] = {};
    for (const TextureList* list :
      { &this->Fields[i].Light[0], &this->Fields[i].Light[1], &this->Fields[i].Ring })
    {
      for (const auto& texture : *list)
      {
        this->Pass.Clear(texture, light, one);
      }
    }
  }
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::Holds(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan, bool half)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->FrameVersion == plan.frame_version && this->Half == half &&
    this->Layer->GetHandle() != 0 && this->Visibility->GetHandle() != 0;
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::Render(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan, bool half)
{
  if (this->Window.GetPointer() != window || this->Layer->GetHandle() == 0)
  {
    this->ReleaseGraphicsResources(this->Window);
    this->Window = window;
  }
  this->Drawn = false;
  this->Samples = 0;
  this->LightUpdates = 0;
  this->Pass.Begin(window);
  bool good = this->Allocate(plan, half) && this->Inputs.Update(window, plan);
  if (good)
  {
    this->Clear(plan);
    this->DrawSlabs(plan);
    if (plan.surface)
    {
      this->DrawBeyond(plan);
    }
    this->DrawVicinity(plan);
    good = !this->Pass.HasFailed();
  }
  this->Pass.End();
  this->FrameVersion = plan.frame_version;
  this->Drawn = good;
  return good;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawSlabs(const chi_occlusion_plan& plan)
{
  glGenQueries(1, &this->Query);
  this->Asked = false;
  std::int64_t lastReceiver = isEmpty(plan.beyond) ? -1 : plan.slabs;
  for (std::int64_t slab = 0; slab < plan.slabs; ++slab)
  {
    lastReceiver = isEmpty(plan.receivers[slab]) ? lastReceiver : std::max(lastReceiver, slab);
  }
  const float zero[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  const bool lit = plan.fields > 0;
  for (std::int64_t slab = 0; slab < plan.slabs; ++slab)
  {
    const int side = static_cast<int>(slab & 1);
    if (lit && !isEmpty(this->TauDrawn[side]))
    {
      this->Pass.Clear(this->Tau[side], this->TauDrawn[side], zero);
      this->TauDrawn[side] = {};
    }
    if (!isEmpty(plan.samples[slab]))
    {
      this->DrawSamples(plan, slab);
    }
    for (int field = 0; field < plan.fields; ++field)
    {
      if (!isEmpty(plan.light[slab]) && (plan.field[field].volume || plan.field[field].geometry))
      {
        this->DrawLight(plan, field, slab);
      }
    }
    if (lit && plan.surface && !isEmpty(plan.receivers[slab]))
    {
      this->DrawReceivers(plan, slab);
    }
    // what is asked in one check is read in the next one, so that nothing waits for the answer
    if (plan.saturated > 0.0 && slab % CHECK == CHECK - 1 && slab >= lastReceiver &&
      !this->AskAlive(plan, slab))
    {
      break;
    }
  }
  glDeleteQueries(1, &this->Query);
  this->Query = 0;
}

//------------------------------------------------------------------------------
// Whether any ray had something to meet when this was asked last; asks again.
bool vtkChiOcclusionGL::AskAlive(const chi_occlusion_plan& plan, std::int64_t slab)
{
  unsigned int ready = 0;
  unsigned int alive = 1;
  if (this->Asked)
  {
    glGetQueryObjectuiv(this->Query, GL_QUERY_RESULT_AVAILABLE, &ready);
    if (!ready)
    {
      return true;
    }
    glGetQueryObjectuiv(this->Query, GL_QUERY_RESULT, &alive);
  }
  vtkShaderProgram* program = alive
    ? this->Pass.Use(vtkChiOcclusionAliveFS, define("HAS_SURFACE", plan.surface ? 1 : 0))
    : nullptr;
  if (program)
  {
    this->Pass.Read("layerTexture", this->Layer);
    program->SetUniformf("saturated", static_cast<float>(plan.saturated));
    if (plan.surface)
    {
      this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
      program->SetUniformf("slice", static_cast<float>((slab + 1) * plan.group));
    }
    vtkOpenGLState* state = vtkOpenGLRenderWindow::SafeDownCast(this->Window)->GetState();
    state->vtkglColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glBeginQuery(GL_SAMPLES_PASSED, this->Query);
    this->Pass.Draw({ this->Visibility.Get() }, { 0, 0, plan.width, plan.height });
    glEndQuery(GL_SAMPLES_PASSED);
    state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    this->Asked = true;
  }
  return alive != 0;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiOcclusionGL::Plane(
  const chi_occlusion_plan& plan, int field, std::int64_t slab)
{
  // a plane before the first one is not read, but something must be bound in its place
  return this->Fields[field]
    .Ring[static_cast<std::size_t>(std::max<std::int64_t>(slab, 0) % plan.ring)];
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawSamples(const chi_occlusion_plan& plan, std::int64_t slab)
{
  chi_plan_slab rays;
  chi_occlusion_plan_slab(&plan, slab, &rays);
  const bool lit = rays.is_lit != 0;
  const bool integrates = std::isfinite(plan.color_step);
  vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionSampleFS,
    std::string("#define VOLUME_SAMPLER ") + vtkChiOcclusionTextures::SamplerOf(plan.type) + "\n" +
      define("NEAREST", plan.nearest) + define("CLIPS", plan.clip_count) +
      define("HAS_SURFACE", plan.surface ? 1 : 0) + define("HAS_LIGHT", lit ? 1 : 0) +
      define("LIGHT_SCALE", plan.light_scale) + define("BRICK_EDGE", plan.brick_edge) +
      define("ENTRIES", static_cast<int>(plan.entries)) +
      define("COLOR_PARTS", integrates ? plan.color_parts : 0) +
      define("COLOR_STEPS", plan.color_steps) +
      define("TABLE_WIDTH", vtkChiOcclusionTextures::TABLE_WIDTH));
  if (!program)
  {
    return;
  }
  this->Pass.Read("volumeTexture", this->Inputs.GetVolume());
  this->Pass.Read("brickTexture", this->Inputs.GetBricks());
  this->Pass.Read("sumTexture", this->Inputs.GetSums());
  this->Pass.Read("sigmaTexture", this->Inputs.GetSigma());
  this->Pass.Read("colorTexture", this->Inputs.GetColors());
  const float table[3] = { plan.table_base, plan.table_scale, plan.table_offset };
  program->SetUniformi("useBricks", plan.use_bricks);
  program->SetUniform3f("tableScale", table);
  program->SetUniformf("quantum", plan.quantum);
  if (integrates)
  {
    this->Pass.Read("colorSumTexture", this->Inputs.GetColorSums());
    this->Pass.Read("colorMeanTexture", this->Inputs.GetColorMeans());
    program->SetUniformf("colorStep", plan.color_step);
    program->SetUniformf("colorWorth", plan.color_worth * plan.color_step);
    program->SetUniformf("colorEven", static_cast<float>(plan.color_even) * plan.color_step);
    program->SetUniformf("colorThin", plan.color_thin);
  }
  program->SetUniform2f("firstPixel", rays.pixel);
  program->SetUniform3f("position", rays.position);
  program->SetUniform3f("positionX", rays.position_x);
  program->SetUniform3f("positionY", rays.position_y);
  program->SetUniform3f("direction", rays.direction);
  program->SetUniform3f("directionX", rays.direction_x);
  program->SetUniform3f("directionY", rays.direction_y);
  setUniform(program, "boxLow", plan.box_low);
  setUniform(program, "boxHigh", plan.box_high);
  float clips[CHI_MAX_CLIP_PLANES][4];
  for (int k = 0; k < plan.clip_count; ++k)
  {
    std::copy(plan.clip[k], plan.clip[k] + 4, clips[k]);
  }
  program->SetUniform4fv("clip", plan.clip_count, clips);
  setUniform(program, "raySlope", { plan.slope_x, plan.slope_y });
  setUniform(program, "raySlopeStep", { plan.slope_dx, plan.slope_dy });
  program->SetUniformf("slice", static_cast<float>(plan.slice));
  program->SetUniformi("segments", static_cast<int>(plan.group));
  program->SetUniformi("startsHere", slab == plan.volume_begin ? 1 : 0);
  program->SetUniformf("firstSlice", static_cast<float>(slab * plan.group));
  if (plan.surface)
  {
    this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
  }
  if (lit)
  {
    this->Pass.Read("planeTexture0", this->Plane(plan, 0, rays.first_plane));
    this->Pass.Read("planeTexture1", this->Plane(plan, 0, rays.first_plane + 1));
    this->Pass.Read("planeTexture2", this->Plane(plan, 0, rays.first_plane + 2));
    const float there[3] = { rays.first_plane >= 0 ? 1.0f : 0.0f,
      rays.first_plane >= -1 ? 1.0f : 0.0f, rays.first_plane >= -2 ? 1.0f : 0.0f };
    program->SetUniform3f("planeThere", there);
    program->SetUniform3f("planeRange", rays.plane);
    program->SetUniformf("strength", static_cast<float>(plan.strength));
    setWeights(program, plan);
  }
  const chi_rect& rect = plan.samples[slab];
  if (plan.fields > 0)
  {
    this->TauDrawn[slab & 1] = rect;
    this->Pass.Draw({ this->Layer.Get(), this->Tau[slab & 1].Get() }, rect, vtkChiQuadPass::UNDER);
  }
  else
  {
    this->Pass.Draw({ this->Layer.Get() }, rect, vtkChiQuadPass::UNDER);
  }
  this->Samples += areaOf(rect) * plan.group;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawLight(const chi_occlusion_plan& plan, int field, std::int64_t slab)
{
  Field& light = this->Fields[field];
  const TextureList& from = light.Light[slab & 1];
  const TextureList& to = light.Light[(slab & 1) ^ 1];
  const bool tau =
    plan.field[field].volume && plan.attenuation > 0.0f && !isEmpty(plan.samples[slab]);
  const bool geometry = plan.surface && plan.field[field].geometry && !isEmpty(plan.blockers[slab]);
  const int batches = batchesOf(plan);
  const double scale = plan.light_scale;
  for (int batch = 0; batch < batches; ++batch)
  {
    const int targets = targetsOf(plan, batch);
    vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionLightFS,
      define("TARGETS", targets) + define("HAS_TAU", tau) + define("HAS_GEOMETRY", geometry) +
        define("CONTINUES", batch > 0) + define("LIGHT_SCALE", plan.light_scale));
    if (!program)
    {
      return;
    }
    std::vector<vtkTextureObject*> into = { batch == batches - 1 ? this->Plane(plan, field, slab)
                                                                 : this->Partial[batch & 1].Get() };
    for (int k = 0; k < targets; ++k)
    {
      const std::size_t i = static_cast<std::size_t>(batch * FOUR + k);
      this->Pass.Read(lightNames[k], from[i]);
      into.push_back(to[i]);
    }
    float shift[BATCH][2] = {};
    float weight[BATCH][4] = {};
    for (int k = 0; k < BATCH && batch * BATCH + k < plan.directions; ++k)
    {
      const chi_plan_shift& step = plan.shift[slab * plan.directions + batch * BATCH + k];
      shift[k][0] = static_cast<float>(step.x);
      shift[k][1] = static_cast<float>(step.y);
      std::copy(step.weight, step.weight + 4, weight[k]);
    }
    program->SetUniform2fv("shift", BATCH, shift);
    program->SetUniform4fv("shiftWeight", BATCH, weight);
    setDirections(program, plan, batch);
    if (tau)
    {
      this->Pass.Read("tauTexture", this->Tau[slab & 1]);
      this->Pass.Read("tauBeforeTexture", this->Tau[(slab & 1) ^ 1]);
      // of the middle of light pixel (0, 0)
      setUniform(program, "raySlope",
        { plan.slope_x + 0.5 * (scale - 1.0) * plan.slope_dx,
          plan.slope_y + 0.5 * (scale - 1.0) * plan.slope_dy });
      setUniform(program, "raySlopeStep", { scale * plan.slope_dx, scale * plan.slope_dy });
      program->SetUniformf("attenuation", plan.attenuation);
      program->SetUniformf("meanLength", plan.mean_length);
      program->SetUniformf("thin", plan.thin);
    }
    if (geometry)
    {
      this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
      this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
      program->SetUniformf("slab", static_cast<float>(slab));
    }
    if (batch > 0)
    {
      this->Pass.Read("visibilityTexture", this->Partial[(batch & 1) ^ 1]);
    }
    this->Pass.Draw(into, plan.light[slab]);
  }
  this->LightUpdates += areaOf(plan.light[slab]) * plan.directions;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawReceivers(const chi_occlusion_plan& plan, std::int64_t slab)
{
  const int field = plan.surface_field;
  if (!plan.field[field].volume && !plan.field[field].geometry)
  {
    return; // nothing takes light from surfaces
  }
  vtkShaderProgram* program = this->Pass.Use(
    vtkChiOcclusionReceiveFS, define("BEYOND", 0) + define("LIGHT_SCALE", plan.light_scale));
  if (program)
  {
    this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
    this->Pass.Read("planeTexture0", this->Plane(plan, field, slab - 1));
    this->Pass.Read("planeTexture1", this->Plane(plan, field, slab));
    setUniform(program, "planeThere", { slab > 0 ? 1.0 : 0.0, 1.0 });
    program->SetUniformf("above", static_cast<float>(slab));
    program->SetUniformf("last", slab == plan.slabs - 1 ? 1.0f : 0.0f);
    setWeights(program, plan);
    this->Pass.Draw({ this->Received.Get() }, plan.receivers[slab]);
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawBeyond(const chi_occlusion_plan& plan)
{
  const int field = plan.surface_field;
  if (plan.fields == 0 || isEmpty(plan.beyond) ||
    (!plan.field[field].volume && !plan.field[field].geometry))
  {
    return;
  }
  const TextureList& light = this->Fields[field].Light[plan.slabs & 1];
  for (int batch = 0; batch < batchesOf(plan); ++batch)
  {
    const int targets = targetsOf(plan, batch);
    vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionReceiveFS,
      define("BEYOND", 1) + define("LIGHT_SCALE", plan.light_scale) + define("TARGETS", targets));
    if (!program)
    {
      return;
    }
    this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
    this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
    for (int k = 0; k < targets; ++k)
    {
      this->Pass.Read(lightNames[k], light[static_cast<std::size_t>(batch * FOUR + k)]);
    }
    program->SetUniformf("above", static_cast<float>(plan.slabs - 1));
    setUniform(program, "lightPixels", plan.light_pixels);
    setDirections(program, plan, batch);
    this->Pass.Draw({ this->Received.Get() }, plan.beyond,
      batch == 0 ? vtkChiQuadPass::REPLACE : vtkChiQuadPass::ADD);
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawVicinity(const chi_occlusion_plan& plan)
{
  const chi_rect picture = { 0, 0, plan.width, plan.height };
  const bool near = plan.surface && plan.vicinity_samples > 0 && plan.strength > 0.0;
  vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionVicinityFS,
    define("SAMPLES", near ? plan.vicinity_samples : 0) + define("LIGHTS", plan.lights) +
      define("PLANE_RULE", plan.vicinity_plane_rule) + define("PARALLEL", plan.parallel) +
      define("COMBINE_MINIMUM", plan.combine == CHI_COMBINE_MINIMUM));
  if (!program)
  {
    return;
  }
  this->Pass.Read("visibilityTexture", this->Received);
  program->SetUniformf("strength", static_cast<float>(plan.strength));
  if (near)
  {
    this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
    std::vector<float> disc;
    float radius[2] = { 0.0f, 0.0f };
    float share[2] = { 0.0f, 0.0f };
    for (int light = 0; light < plan.lights; ++light)
    {
      radius[light] = static_cast<float>(plan.vicinity_radius[light]);
      share[light] = static_cast<float>(plan.vicinity_share[light]);
      disc.insert(disc.end(), &plan.vicinity_disc[light][0][0],
        &plan.vicinity_disc[light][0][0] + 2 * plan.vicinity_samples);
    }
    program->SetUniform2fv("disc", plan.lights * plan.vicinity_samples, disc.data());
    program->SetUniform2f("radius", radius);
    program->SetUniform2f("share", share);
    setUniform(program, "pixels", plan.vicinity_pixels);
    program->SetUniformf("virtualSlice", static_cast<float>(plan.vicinity_distance));
    program->SetUniformf("bias", static_cast<float>(plan.vicinity_bias));
    program->SetUniformf("curvature", static_cast<float>(plan.vicinity_curvature));
    program->SetUniformf("riseShare", static_cast<float>(plan.vicinity_rise));
    program->SetUniformf("fade", static_cast<float>(plan.vicinity_fade));
  }
  this->Pass.Draw({ this->Visibility.Get() }, picture);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::ReadLayer(vtkOpenGLRenderWindow* window, std::vector<float>& rgba)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->Pass.ReadPixels(window, this->Layer, 4, rgba);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::ReadVisibility(
  vtkOpenGLRenderWindow* window, std::vector<float>& visibility)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->Pass.ReadPixels(window, this->Visibility, 1, visibility);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Drawn = false;
  this->Pass.ReleaseGraphicsResources(window);
  if (!window)
  {
    return;
  }
  this->Inputs.ReleaseGraphicsResources(window);
  for (vtkTextureObject* texture :
    { this->Layer.Get(), this->Received.Get(), this->Visibility.Get(), this->Tau[0].Get(),
      this->Tau[1].Get(), this->Partial[0].Get(), this->Partial[1].Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
  for (Field& field : this->Fields)
  {
    for (TextureList* list : { &field.Light[0], &field.Light[1], &field.Ring })
    {
      for (auto& texture : *list)
      {
        texture->ReleaseGraphicsResources(window);
      }
      list->clear();
    }
  }
}
