// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiTranslucentLayers.h"

#include "vtkChiPassKeys.h"
#include "vtkChiSceneKey.h"

#include "vtkActor2D.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkLODProp3D.h"
#include "vtkOpenGLActor.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkProp.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"

#include <algorithm>
#include <limits>

namespace
{
//------------------------------------------------------------------------------
void allocate(
  vtkTextureObject* texture, vtkOpenGLRenderWindow* window, int width, int height, int components)
{
  const unsigned int size[2] = { static_cast<unsigned int>(width),
    static_cast<unsigned int>(height) };
  texture->SetContext(window);
  if (texture->GetHandle() == 0)
  {
    if (components > 0)
    {
      texture->Allocate2D(size[0], size[1], components, VTK_FLOAT);
    }
    else
    {
      texture->AllocateDepth(size[0], size[1], vtkTextureObject::Float32);
    }
  }
  texture->Resize(size[0], size[1]);
}
}

//------------------------------------------------------------------------------
std::vector<vtkProp*> vtkChiTranslucentLayers::Find(vtkRenderer* renderer) const
{
  std::vector<vtkProp*> found;
  vtkCollectionSimpleIterator cookie;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie))
  {
    if (vtkLODProp3D* levels = vtkLODProp3D::SafeDownCast(prop))
    {
      // it has chosen no level before its first frame, and complains when it is asked
      levels->SetAllocatedRenderTime(levels->GetAllocatedRenderTime(), renderer);
    }
    if (prop->GetVisibility() && !vtkVolume::SafeDownCast(prop) &&
      !vtkActor2D::SafeDownCast(prop) && prop->HasTranslucentPolygonalGeometry() &&
      std::find(this->Foreign.begin(), this->Foreign.end(), prop) == this->Foreign.end())
    {
      found.push_back(prop);
    }
  }
  return found;
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::Hide(vtkRenderer* renderer)
{
  this->Show();
  for (vtkProp* prop : this->Find(renderer))
  {
    this->Hidden.emplace_back(prop);
    vtkChiAppendPass(prop, this->Pass);
  }
  this->Pass->SetMode(vtkChiLayersPass::HIDE);
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::Show()
{
  for (vtkProp* prop : this->Hidden)
  {
    vtkChiRemovePass(prop, this->Pass);
  }
  this->Hidden.clear();
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::Update(vtkRenderer* renderer, const vtkChiCameraView& camera,
  const int size[2], vtkTextureObject* opaque, std::uint64_t opaqueVersion)
{
  this->Seconds = 0.0;
  if (!this->IsHiding())
  {
    this->View.count = 0;
    this->Dropped = 0;
    this->Key.clear();
    return;
  }
  std::vector<vtkProp*> props(this->Hidden.begin(), this->Hidden.end());
  std::vector<std::uint64_t> key = vtkChiSceneKey(renderer, camera, props);
  key.push_back(opaque ? opaqueVersion + 1 : 0);
  if (key == this->Key && size[0] == this->Width && size[1] == this->Height &&
    this->Color->GetHandle() != 0)
  {
    return;
  }
  const double start = vtkTimerLog::GetUniversalTime();
  this->Width = size[0];
  this->Height = size[1];
  this->Peel(renderer, camera, opaque);
  this->Key = std::move(key);
  this->Seconds = vtkTimerLog::GetUniversalTime() - start;
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::Peel(
  vtkRenderer* renderer, const vtkChiCameraView& camera, vtkTextureObject* opaque)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  allocate(this->Color, window, this->Width, this->Height, 4);
  allocate(this->Depths[0], window, this->Width, this->Height, 1);
  allocate(this->Depths[1], window, this->Width, this->Height, 1);
  allocate(this->WindowDepth, window, this->Width, this->Height, 0);
  this->Target->SetContext(window);

  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  vtkOpenGLState::ScopedglDepthFunc depthFunc(state);
  vtkOpenGLState::ScopedglColorMask colorMask(state);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  int equation[2]; // depth peeling takes maxima
  glGetIntegerv(GL_BLEND_EQUATION_RGB, &equation[0]);
  glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &equation[1]);
  state->PushFramebufferBindings();
  this->Target->Bind();
  state->vtkglViewport(0, 0, this->Width, this->Height);
  state->vtkglScissor(0, 0, this->Width, this->Height);
  state->vtkglBlendEquation(GL_FUNC_ADD);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE, GL_ONE, GL_ONE);
  state->vtkglDepthFunc(GL_LESS);
  state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (opaque)
  {
    opaque->Activate();
  }

  const std::size_t pixels =
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  this->Depth.resize(CHI_MAX_LAYERS * pixels);
  this->Rgba.resize(4 * CHI_MAX_LAYERS * pixels);
  int count = 0;
  this->Dropped = 0;
  while (count < CHI_MAX_LAYERS && this->DrawLayer(renderer, count, opaque))
  {
    ++count;
  }
  if (count == CHI_MAX_LAYERS)
  {
    this->CountRest(renderer, count, opaque);
  }
  if (opaque)
  {
    opaque->Deactivate();
  }
  this->Target->RemoveColorAttachment(0);
  this->Target->RemoveColorAttachment(1);
  this->Target->RemoveDepthAttachment();
  state->PopFramebufferBindings();
  state->vtkglBlendEquationSeparate(
    static_cast<unsigned int>(equation[0]), static_cast<unsigned int>(equation[1]));
  this->Pass->SetMode(vtkChiLayersPass::HIDE);

  for (int layer = 0; layer < count; ++layer)
  {
    this->Convert(camera, layer);
  }
  this->View.struct_size = sizeof(chi_layers_view);
  this->View.depth = this->Depth.data();
  this->View.rgba = this->Rgba.data();
  this->View.count = count;
  ++this->View.version;
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::DrawProps(vtkRenderer* renderer)
{
  for (vtkProp* prop : this->Hidden)
  {
    // no other pass's shader parts, and the nearest fragment stays: VTK masks the depth otherwise
    const vtkChiPlainShaders plain(prop);
    vtkChiAppendPass(prop, this->Pass);
    vtkInformation* keys = prop->GetPropertyKeys();
    const bool had = keys->Has(vtkOpenGLActor::GLDepthMaskOverride()) != 0;
    const int mask = had ? keys->Get(vtkOpenGLActor::GLDepthMaskOverride()) : 0;
    keys->Set(vtkOpenGLActor::GLDepthMaskOverride(), 1);
    this->Pass->TakeDrawn();
    prop->RenderTranslucentPolygonalGeometry(renderer);
    if (this->Pass->TakeDrawn() == 0)
    {
      this->Foreign.push_back(prop);
    }
    if (had)
    {
      keys->Set(vtkOpenGLActor::GLDepthMaskOverride(), mask);
    }
    else
    {
      keys->Remove(vtkOpenGLActor::GLDepthMaskOverride());
    }
    vtkChiRemovePass(prop, this->Pass);
  }
}

//------------------------------------------------------------------------------
// Returns false where the layer is empty.
bool vtkChiTranslucentLayers::DrawLayer(vtkRenderer* renderer, int layer, vtkTextureObject* opaque)
{
  static const float nothing[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  static const float farthest[4] = { 1.0f, 1.0f, 1.0f, 1.0f };
  vtkOpenGLState* state =
    vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())->GetState();
  vtkTextureObject* before = layer > 0 ? this->Depths[(layer + 1) % 2].Get() : nullptr;
  const std::size_t pixels =
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  float* depth = this->Depth.data() + static_cast<std::size_t>(layer) * pixels;
  float* rgba = this->Rgba.data() + 4 * static_cast<std::size_t>(layer) * pixels;

  this->Target->AddColorAttachment(0, this->Color);
  this->Target->AddColorAttachment(1, this->Depths[layer % 2]);
  this->Target->AddDepthAttachment(this->WindowDepth);
  if (before)
  {
    before->Activate();
  }
  for (std::size_t foreign = this->Foreign.size() + 1; foreign != this->Foreign.size();)
  {
    foreign = this->Foreign.size();
    // vtkOpenGLState compares the first of several buffers alone with what it remembers, which is
    // another frame buffer's while volumes are peeled: say it to OpenGL itself as well
    static const GLenum both[2] = { GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1 };
    this->Target->ActivateDrawBuffers(2);
    glDrawBuffers(2, both);
    state->vtkglDisable(GL_BLEND);
    state->vtkglEnable(GL_DEPTH_TEST);
    state->vtkglDepthMask(GL_TRUE);
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, farthest);
    glClearBufferfv(GL_DEPTH, 0, farthest);
    this->Pass->SetMode(
      layer == 0 ? vtkChiLayersPass::FIRST : vtkChiLayersPass::NEXT, before, opaque);
    this->DrawProps(renderer);
    this->DropForeign(); // who draws with shaders of his own has spoilt the layer: without him
  }
  if (before)
  {
    before->Deactivate();
  }
  this->Target->ActivateReadBuffer(0);
  glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, rgba);
  this->Target->ActivateReadBuffer(1);
  glReadPixels(0, 0, this->Width, this->Height, GL_RED, GL_FLOAT, depth);
  return std::any_of(depth, depth + pixels, [](float z) { return z < 1.0f; });
}

//------------------------------------------------------------------------------
// How many layers lie behind the last one, at most.
void vtkChiTranslucentLayers::CountRest(vtkRenderer* renderer, int layer, vtkTextureObject* opaque)
{
  static const float nothing[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
  vtkOpenGLState* state =
    vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())->GetState();
  vtkTextureObject* before = this->Depths[(layer + 1) % 2];
  this->Target->RemoveColorAttachment(1);
  static const GLenum first = GL_COLOR_ATTACHMENT0;
  this->Target->ActivateDrawBuffers(1);
  glDrawBuffers(1, &first);
  state->vtkglEnable(GL_BLEND);
  state->vtkglDisable(GL_DEPTH_TEST);
  state->vtkglDepthMask(GL_FALSE);
  glClearBufferfv(GL_COLOR, 0, nothing);
  before->Activate();
  this->Pass->SetMode(vtkChiLayersPass::COUNT, before, opaque);
  this->DrawProps(renderer);
  before->Deactivate();
  std::vector<float> counts(
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  this->Target->ActivateReadBuffer(0);
  glReadPixels(0, 0, this->Width, this->Height, GL_RED, GL_FLOAT, counts.data());
  this->Dropped = static_cast<int>(*std::max_element(counts.begin(), counts.end()));
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::DropForeign()
{
  const auto isForeign = [this](vtkProp* prop)
  { return std::find(this->Foreign.begin(), this->Foreign.end(), prop) != this->Foreign.end(); };
  for (vtkProp* prop : this->Hidden)
  {
    if (isForeign(prop))
    {
      vtkChiRemovePass(prop, this->Pass);
    }
  }
  this->Hidden.erase(
    std::remove_if(this->Hidden.begin(), this->Hidden.end(), isForeign), this->Hidden.end());
}

//------------------------------------------------------------------------------
// From the window's depth to the distance along the view axis.
void vtkChiTranslucentLayers::Convert(const vtkChiCameraView& camera, int layer)
{
  const std::size_t pixels =
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  float* depth = this->Depth.data() + static_cast<std::size_t>(layer) * pixels;
  const vtkChiCameraView view = camera; // by value, so that the loop need not read it anew
  std::transform(depth, depth + pixels, depth,
    [view](float z)
    {
      return z < 1.0f ? static_cast<float>(view.Depth(static_cast<double>(z)))
                      : std::numeric_limits<float>::infinity();
    });
}

//------------------------------------------------------------------------------
void vtkChiTranslucentLayers::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Target->ReleaseGraphicsResources(window);
  this->Color->ReleaseGraphicsResources(window);
  this->Depths[0]->ReleaseGraphicsResources(window);
  this->Depths[1]->ReleaseGraphicsResources(window);
  this->WindowDepth->ReleaseGraphicsResources(window);
  this->Key.clear();
}
