// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiOcclusionGL.h"

#include "vtkChiGLTools.h"
#include "vtkChiOcclusionAliveFS.h"
#include "vtkChiOcclusionGLTools.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkShaderProgram.h"

#include <algorithm>

using namespace vtkChiOcclusionGLTools;

namespace
{
constexpr int CHECK = 8; // slabs from one look at what is still alive to the next

// CHI_FEATURE_... that the shaders do.
constexpr std::uint64_t KNOWN = CHI_FEATURE_REDUCTION | CHI_FEATURE_COLORED | CHI_FEATURE_SHADING |
  CHI_FEATURE_GRADIENT_OPACITY | CHI_FEATURE_TRANSFER_PLANE | CHI_FEATURE_EDGES |
  CHI_FEATURE_LAYERS | CHI_FEATURE_CROP | CHI_FEATURE_MASK | CHI_FEATURE_PUBLISHED |
  CHI_FEATURE_COMPONENTS;
}

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::WhyNot(
  vtkOpenGLRenderWindow* window, const chi_occlusion_frame& frame)
{
  const std::uint64_t features = chi_occlusion_features(&frame) & ~KNOWN;
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
  // the layers of a pixel stand one above the other
  const int layers =
    (frame.layers ? frame.layers->count : 0) + (frame.surface && frame.surface->edge_depth ? 1 : 0);
  if (std::max(frame.camera->width, std::max(layers, 1) * frame.camera->height) + 1 > largest[0] ||
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
  // outside of the light buffers all light arrives, as beyond the edges of these
  vtkChiGLTools::Reserve(
    texture, vtkOpenGLRenderWindow::SafeDownCast(this->Window), width, height, components, half);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::Resize(TextureList& list, std::size_t count)
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
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::Reserve(
  TextureList& list, std::size_t count, const chi_occlusion_plan& plan, int components)
{
  this->Resize(list, count);
  for (auto& texture : list)
  {
    this->Reserve(texture, plan.light_width, plan.light_height, components, this->Half);
  }
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::Allocate(const chi_occlusion_plan& plan, bool half)
{
  this->Half = half;
  this->Reserve(this->Layer, plan.width, plan.height, 4, false);
  this->Colored = isColored(plan);
  const int colors = this->Colored ? 4 : 1;
  this->Reserve(this->Received, plan.width, plan.height, colors, false);
  this->Reserve(this->Visibility, plan.width, plan.height, colors, false);
  this->Reduced = plan.reduction > 1;
  if (this->Reduced)
  {
    this->Reserve(this->FullLayer, plan.full_width, plan.full_height, 4, false);
    this->Reserve(this->FullVisibility, plan.full_width, plan.full_height, colors, false);
  }
  else
  {
    this->FullLayer->ReleaseGraphicsResources(this->Window);
    this->FullVisibility->ReleaseGraphicsResources(this->Window);
  }
  this->Resize(this->LayerWeights, weightsOf(plan));
  for (auto& texture : this->LayerWeights)
  {
    this->Reserve(texture, plan.width, plan.height, 4, false);
  }
  this->Resize(this->LayerLight, static_cast<std::size_t>(plan.layers));
  for (auto& texture : this->LayerLight)
  {
    this->Reserve(texture, plan.width, plan.height, colors, false);
  }
  const std::size_t textures =
    static_cast<std::size_t>(plan.published ? 1 : (plan.directions - 1) / FOUR + 1);
  const int parts = plan.published ? 1 : FOUR;
  for (int i = 0; i < 2; ++i)
  {
    const bool used = plan.fields > i;
    this->Reserve(this->Tau[i], plan.light_width * plan.light_scale,
      plan.light_height * plan.light_scale, 1, false);
    for (int channel = 0; channel < 3; ++channel)
    {
      const std::size_t count = used && channel < plan.channels ? textures : 0;
      this->Reserve(this->Fields[i].Light[channel][0], count, plan, parts);
      this->Reserve(this->Fields[i].Light[channel][1], count, plan, parts);
    }
    this->Reserve(
      this->Fields[i].Ring, used ? static_cast<std::size_t>(plan.ring) : 0, plan, colors);
    if (batchesOf(plan) > 1)
    {
      this->Reserve(this->Partial[i], plan.light_width, plan.light_height, 1, false);
    }
  }
  return this->GetLayer()->GetHandle() != 0 && this->GetVisibility()->GetHandle() != 0;
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
  for (const TextureList* list : { &this->LayerWeights, &this->LayerLight })
  {
    for (const auto& texture : *list)
    {
      this->Pass.Clear(texture, picture, zero);
    }
  }
  for (int i = 0; i < 2; ++i)
  {
    this->Pass.Clear(this->Tau[i], tau, zero);
    this->TauDrawn[i] = {};
    for (const TextureList* list : this->Fields[i].GetLists())
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
    this->GetLayer()->GetHandle() != 0 && this->GetVisibility()->GetHandle() != 0;
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
    const std::int64_t drawn = this->DrawSlabs(plan);
    if (plan.surface)
    {
      this->DrawBeyond(plan, false);
    }
    if (plan.layers > 0)
    {
      this->DrawLastLayers(plan, drawn);
      this->DrawBeyond(plan, true);
      this->FinishLayers(plan);
    }
    this->DrawVicinity(plan);
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
std::int64_t vtkChiOcclusionGL::DrawSlabs(const chi_occlusion_plan& plan)
{
  glGenQueries(1, &this->Query);
  this->Asked = false;
  std::int64_t lastReceiver = isEmpty(plan.beyond) && isEmpty(plan.layers_beyond) ? -1 : plan.slabs;
  for (std::int64_t slab = 0; slab < plan.slabs; ++slab)
  {
    const bool none = isEmpty(plan.receivers[slab]) && isEmpty(plan.layer_receivers[slab]);
    lastReceiver = none ? lastReceiver : std::max(lastReceiver, slab);
  }
  const float zero[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  const bool lit = plan.fields > 0;
  std::int64_t slab = 0;
  for (; slab < plan.slabs; ++slab)
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
    if (!isWithin(plan.layer_spots[slab], plan.samples[slab]))
    {
      this->DrawLayers(plan, slab);
    }
    for (int field = 0; field < plan.fields; ++field)
    {
      const bool blocked = plan.field[field].volume || plan.field[field].geometry;
      for (int channel = 0; channel < plan.channels && blocked && !isEmpty(plan.light[slab]);
           ++channel)
      {
        plan.published ? this->DrawBlur(plan, field, channel, slab)
                       : this->DrawLight(plan, field, channel, slab);
      }
    }
    if (lit && plan.surface && !isEmpty(plan.receivers[slab]))
    {
      this->DrawReceivers(plan, slab, false);
    }
    if (lit && !isEmpty(plan.layer_receivers[slab]))
    {
      this->DrawReceivers(plan, slab, true);
    }
    // what is asked in one check is read in the next one, so that nothing waits for the answer
    if (plan.saturated > 0.0 && slab % CHECK == CHECK - 1 && slab >= lastReceiver &&
      !this->AskAlive(plan, slab))
    {
      ++slab;
      break;
    }
  }
  glDeleteQueries(1, &this->Query);
  this->Query = 0;
  return slab;
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
bool vtkChiOcclusionGL::ReadLayer(vtkOpenGLRenderWindow* window, std::vector<float>& rgba)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->Pass.ReadPixels(window, this->GetLayer(), 4, rgba);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::ReadVisibility(
  vtkOpenGLRenderWindow* window, std::vector<float>& visibility)
{
  return this->Drawn && this->Window.GetPointer() == window &&
    this->Pass.ReadPixels(window, this->GetVisibility(), this->Colored ? 4 : 1, visibility);
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
  for (vtkTextureObject* texture : { this->Layer.Get(), this->Received.Get(),
         this->Visibility.Get(), this->FullLayer.Get(), this->FullVisibility.Get(),
         this->Tau[0].Get(), this->Tau[1].Get(), this->Partial[0].Get(), this->Partial[1].Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
  std::vector<TextureList*> lists = { &this->LayerWeights, &this->LayerLight };
  for (Field& field : this->Fields)
  {
    const auto more = field.GetLists();
    lists.insert(lists.end(), more.begin(), more.end());
  }
  for (TextureList* list : lists)
  {
    for (auto& texture : *list)
    {
      texture->ReleaseGraphicsResources(window);
    }
    list->clear();
  }
}
