// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiGeometryBuffer.h"

#include "vtkChiPassKeys.h"

#include "vtkActor.h"
#include "vtkActor2D.h"
#include "vtkAlgorithm.h"
#include "vtkAssemblyNode.h"
#include "vtkAssemblyPath.h"
#include "vtkCollection.h"
#include "vtkDataObject.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMapper.h"
#include "vtkMatrix4x4.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPropCollection.h"
#include "vtkProperty.h"
#include "vtkRenderState.h"
#include "vtkTexture.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace
{
std::uint64_t bits(double value)
{
  std::uint64_t pattern = 0;
  std::memcpy(&pattern, &value, sizeof(pattern));
  return pattern;
}

std::uint64_t bits(const void* pointer)
{
  return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

// When anything that a mapper draws was last modified. vtkActor looks at its first input only; a
// glyph's shape comes in by the second.
vtkMTimeType mapperTime(vtkMapper* mapper)
{
  vtkMTimeType time = mapper ? mapper->GetMTime() : 0;
  for (int port = 0; mapper && port < mapper->GetNumberOfInputPorts(); ++port)
  {
    for (int item = 0; item < mapper->GetNumberOfInputConnections(port); ++item)
    {
      mapper->GetInputAlgorithm(port, item)->Update();
      vtkDataObject* data = mapper->GetInputDataObject(port, item);
      time = std::max(time, data ? data->GetMTime() : 0);
    }
  }
  return time;
}

// Everything that a prop's picture depends on.
void appendProp(vtkProp* prop, std::vector<std::uint64_t>& key)
{
  key.push_back(bits(prop));
  vtkActor* actor = vtkActor::SafeDownCast(prop);
  if (actor)
  {
    key.push_back(
      std::max({ actor->GetMTime(), actor->GetRedrawMTime(), mapperTime(actor->GetMapper()) }));
    return;
  }
  // The parts of an assembly: their matrices by value, because drawing one writes into its parts
  // and so gives them a new time each frame.
  prop->InitPathTraversal();
  while (vtkAssemblyPath* path = prop->GetNextPath())
  {
    vtkProp* leaf = path->GetLastNode()->GetViewProp();
    vtkActor* part = vtkActor::SafeDownCast(leaf);
    key.push_back(bits(leaf));
    key.push_back(static_cast<std::uint64_t>(leaf->GetVisibility()));
    if (part)
    {
      key.push_back(std::max(mapperTime(part->GetMapper()), part->GetProperty()->GetMTime()));
      key.push_back(part->GetTexture() ? part->GetTexture()->GetMTime() : 0);
    }
    else
    {
      key.push_back(
        leaf == prop ? std::max(prop->GetMTime(), prop->GetRedrawMTime()) : leaf->GetRedrawMTime());
    }
    vtkMatrix4x4* matrix = path->GetLastNode()->GetMatrix();
    for (int i = 0; matrix && i < 16; ++i)
    {
      key.push_back(bits(matrix->GetData()[i]));
    }
  }
}

// Whether any part of a prop is lit with highlights.
bool hasSpecular(vtkProp* prop)
{
  bool any = false;
  prop->InitPathTraversal();
  while (vtkAssemblyPath* path = prop->GetNextPath())
  {
    vtkActor* part = vtkActor::SafeDownCast(path->GetLastNode()->GetViewProp());
    any = any ||
      (part && part->GetProperty()->GetLighting() && part->GetProperty()->GetSpecular() > 0.0);
  }
  return any;
}
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::CollectProps(vtkRenderer* renderer)
{
  this->Props.clear();
  vtkCollectionSimpleIterator cookie;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie))
  {
    // volumes say that they have opaque geometry, and annotation lies in no depth
    if (prop->GetVisibility() && !vtkVolume::SafeDownCast(prop) &&
      !vtkActor2D::SafeDownCast(prop) && prop->HasOpaqueGeometry())
    {
      this->Props.push_back(prop);
    }
  }
}

//------------------------------------------------------------------------------
std::vector<std::uint64_t> vtkChiGeometryBuffer::MakeKey(
  vtkRenderer* renderer, const vtkChiCameraView& camera, const std::vector<vtkProp*>& drawn)
{
  std::vector<std::uint64_t> key;
  // values of matrices, not the camera's time stamp: some render passes swap the camera each frame
  for (int i = 0; i < 16; ++i)
  {
    key.push_back(bits(camera.GetView()[i]));
    key.push_back(bits(camera.GetProjection()[i]));
  }
  for (int i = 0; i < 3; ++i)
  {
    key.push_back(bits(renderer->GetAmbient()[i]));
  }
  key.push_back(static_cast<std::uint64_t>(renderer->GetTwoSidedLighting()));
  vtkTexture* environment =
    renderer->GetUseImageBasedLighting() ? renderer->GetEnvironmentTexture() : nullptr;
  key.push_back(environment ? environment->GetMTime() : 0);

  vtkCollectionSimpleIterator cookie;
  vtkLightCollection* lights = renderer->GetLights();
  lights->InitTraversal(cookie);
  while (vtkLight* light = lights->GetNextLight(cookie))
  {
    key.push_back(bits(light));
    key.push_back(light->GetMTime());
  }
  for (vtkProp* prop : drawn)
  {
    appendProp(prop, key);
  }
  return key;
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::Update(
  vtkRenderer* renderer, const vtkChiCameraView& camera, int width, int height)
{
  this->SecondsDraw = 0.0;
  this->SecondsReadBack = 0.0;
  this->Reused = false;
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  this->CollectProps(renderer);
  if (this->Props.empty())
  {
    this->Key.clear();
    this->AnySurface = false;
    this->AnySpecular = false;
    return false;
  }
  std::vector<std::uint64_t> key = MakeKey(renderer, camera, this->Props);
  if (width == this->Width && height == this->Height && key == this->Key &&
    this->Color->GetHandle() != 0)
  {
    this->Reused = true;
    return this->AnySurface;
  }
  this->Width = width;
  this->Height = height;
  this->Key.clear();

  const double start = vtkTimerLog::GetUniversalTime();
  this->Draw(renderer, window);
  this->DrawSpecular(renderer, window);
  this->ConvertDepth(camera);
  this->SecondsReadBack = vtkTimerLog::GetUniversalTime() - start - this->SecondsDraw;
  this->Key = std::move(key);
  return this->AnySurface;
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::DrawInto(vtkOpenGLRenderWindow* window, vtkTextureObject* color,
  const std::function<void()>& draw, const std::function<void()>& read)
{
  const unsigned int width = static_cast<unsigned int>(this->Width);
  const unsigned int height = static_cast<unsigned int>(this->Height);
  color->SetContext(window);
  this->WindowDepth->SetContext(window);
  this->Target->SetContext(window);
  if (color->GetHandle() == 0)
  {
    color->Allocate2D(width, height, 4, VTK_FLOAT);
  }
  if (this->WindowDepth->GetHandle() == 0)
  {
    this->WindowDepth->AllocateDepth(width, height, vtkTextureObject::Float32);
  }
  color->Resize(width, height);
  this->WindowDepth->Resize(width, height);

  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglClearColor clearColor(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  vtkOpenGLState::ScopedglDepthFunc depthFunc(state);
  vtkOpenGLState::ScopedglColorMask colorMask(state);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  state->PushFramebufferBindings();
  this->Target->Bind();
  this->Target->AddColorAttachment(0, color);
  this->Target->AddDepthAttachment(this->WindowDepth);
  this->Target->ActivateDrawBuffer(0);
  this->Target->ActivateReadBuffer(0);
  state->vtkglViewport(0, 0, this->Width, this->Height);
  state->vtkglScissor(0, 0, this->Width, this->Height);
  state->vtkglDisable(GL_BLEND);
  state->vtkglEnable(GL_DEPTH_TEST);
  state->vtkglDepthFunc(GL_LEQUAL);
  state->vtkglDepthMask(GL_TRUE);
  state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  state->vtkglClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  state->vtkglClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw();
  read();
  this->Target->RemoveColorAttachment(0);
  this->Target->RemoveDepthAttachment();
  state->PopFramebufferBindings();
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::Draw(vtkRenderer* renderer, vtkOpenGLRenderWindow* window)
{
  const double start = vtkTimerLog::GetUniversalTime();
  this->WindowDepths.resize(
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  this->DrawInto(
    window, this->Color,
    [this, renderer]
    {
      for (vtkProp* prop : this->Props)
      {
        const vtkChiPlainShaders plain(prop);
        prop->RenderOpaqueGeometry(renderer);
      }
    },
    [this, start]
    {
      this->SecondsDraw = vtkTimerLog::GetUniversalTime() - start;
      glReadPixels(
        0, 0, this->Width, this->Height, GL_DEPTH_COMPONENT, GL_FLOAT, this->WindowDepths.data());
    });
}

//------------------------------------------------------------------------------
// The highlights apart, where there are any, because occlusion does not take them (Schott et al.
// 2013, Eq. 9).
void vtkChiGeometryBuffer::DrawSpecular(vtkRenderer* renderer, vtkOpenGLRenderWindow* window)
{
  this->AnySpecular = std::any_of(this->Props.begin(), this->Props.end(), hasSpecular);
  if (!this->AnySpecular)
  {
    return;
  }
  const double start = vtkTimerLog::GetUniversalTime();
  vtkRenderState state(renderer);
  state.SetPropArrayAndCount(this->Props.data(), static_cast<int>(this->Props.size()));
  this->SpecularPass->SetOutput(vtkChiGeometryPass::SPECULAR);
  this->DrawInto(
    window, this->Specular, [this, &state] { this->SpecularPass->Render(&state); }, [] {});
  this->SecondsDraw += vtkTimerLog::GetUniversalTime() - start;
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::ReadNormals(vtkRenderer* renderer, std::vector<float>& normals)
{
  vtkOpenGLRenderWindow* window =
    renderer ? vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()) : nullptr;
  if (!window || this->Color->GetHandle() == 0)
  {
    return false;
  }
  window->MakeCurrent();
  this->CollectProps(renderer);
  vtkRenderState state(renderer);
  state.SetPropArrayAndCount(this->Props.data(), static_cast<int>(this->Props.size()));
  normals.resize(
    4 * static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  vtkNew<vtkTextureObject> texture;
  vtkNew<vtkChiGeometryPass> pass;
  this->DrawInto(
    window, texture, [&pass, &state] { pass->Render(&state); },
    [this, &normals]
    { glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, normals.data()); });
  texture->ReleaseGraphicsResources(window);
  pass->ReleaseGraphicsResources(window);
  return true;
}

//------------------------------------------------------------------------------
// From the window's depth to the distance along the view axis. The version is that of the depths,
// not of the drawing: a change of colour alone must not make the engine render again.
void vtkChiGeometryBuffer::ConvertDepth(const vtkChiCameraView& camera)
{
  std::vector<float> depths(this->WindowDepths.size());
  const vtkChiCameraView view =
    camera; // by value, so that the loop need not read it anew each time
  const float none = std::numeric_limits<float>::infinity();
  float nearest = 1.0f;
  for (std::size_t i = 0; i < depths.size(); ++i)
  {
    const float window = this->WindowDepths[i];
    const float depth = static_cast<float>(view.Depth(static_cast<double>(window)));
    depths[i] = window < 1.0f ? depth : none;
    nearest = std::min(nearest, window);
  }
  const bool any = nearest < 1.0f;
  this->AnySurface = any;
  this->View.struct_size = sizeof(chi_surface_view);
  if (depths != this->Depths)
  {
    ++this->View.version;
    this->Depths.swap(depths);
  }
  this->View.depth = this->Depths.data();
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::ReadColor(vtkOpenGLRenderWindow* window, std::vector<float>& rgba)
{
  return this->Read(window, this->Color, rgba);
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::ReadSpecular(vtkOpenGLRenderWindow* window, std::vector<float>& rgba)
{
  return this->AnySpecular && this->Read(window, this->Specular, rgba);
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::Read(
  vtkOpenGLRenderWindow* window, vtkTextureObject* from, std::vector<float>& rgba)
{
  if (!window || from->GetHandle() == 0)
  {
    return false;
  }
  window->MakeCurrent();
  vtkOpenGLState* state = window->GetState();
  rgba.resize(4 * static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  state->PushFramebufferBindings();
  this->Target->Bind();
  this->Target->AddColorAttachment(0, from);
  this->Target->ActivateDrawBuffer(0);
  this->Target->ActivateReadBuffer(0);
  glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, rgba.data());
  this->Target->RemoveColorAttachment(0);
  state->PopFramebufferBindings();
  return true;
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Target->ReleaseGraphicsResources(window);
  this->Color->ReleaseGraphicsResources(window);
  this->Specular->ReleaseGraphicsResources(window);
  this->SpecularPass->ReleaseGraphicsResources(window);
  this->WindowDepth->ReleaseGraphicsResources(window);
  this->Key.clear();
}
