// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiGeometryBuffer.h"

#include "vtkChiPassKeys.h"
#include "vtkChiSceneKey.h"

#include "vtkActor.h"
#include "vtkActor2D.h"
#include "vtkAssemblyNode.h"
#include "vtkAssemblyPath.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPropCollection.h"
#include "vtkProperty.h"
#include "vtkSMPTools.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace
{
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
      vtkChiProvideKeys(prop); // before anyone looks at its time
      this->Props.push_back(prop);
    }
  }
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::Attach(vtkRenderer* renderer, bool hide)
{
  this->Detach();
  this->CollectProps(renderer);
  this->Attached.assign(this->Props.begin(), this->Props.end());
  this->Hiding = hide && !this->Attached.empty();
  this->Pass->SetMode(hide ? vtkChiGeometryPass::HIDE : vtkChiGeometryPass::DRAW);
  for (vtkProp* prop : this->Attached)
  {
    vtkChiAppendPass(prop, this->Pass);
  }
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::Detach()
{
  for (vtkProp* prop : this->Attached)
  {
    vtkChiRemovePass(prop, this->Pass);
  }
  this->Attached.clear();
  this->Hiding = false;
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::Exist(vtkRenderer* renderer)
{
  this->CollectProps(renderer);
  return !this->Props.empty();
}

//------------------------------------------------------------------------------
bool vtkChiGeometryBuffer::Update(
  vtkRenderer* renderer, const vtkChiCameraView& camera, int width, int height, bool multiSample)
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
  std::vector<std::uint64_t> key = vtkChiSceneKey(renderer, camera, this->Props);
  key.push_back(multiSample ? 1 : 0);
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
  this->AnySpecular = std::any_of(this->Props.begin(), this->Props.end(), hasSpecular);
  const std::size_t pixels =
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  this->MultiSampled = multiSample && this->Samples.Allocate(window, this->Width, this->Height);
  if (this->MultiSampled)
  {
    this->DrawSamples(renderer, camera);
  }
  else
  {
    this->WindowDepths.resize(pixels);
    this->Draw(renderer);
  }
  this->ConvertDepths(camera);
  this->SecondsReadBack = vtkTimerLog::GetUniversalTime() - start - this->SecondsDraw;
  this->Key = std::move(key);
  return this->AnySurface;
}

//------------------------------------------------------------------------------
// Colours, and in one go what of them is specular (Schott et al. 2013, Eq. 9).
void vtkChiGeometryBuffer::Draw(vtkRenderer* renderer)
{
  const double start = vtkTimerLog::GetUniversalTime();
  const std::vector<vtkTextureObject*> colors = this->AnySpecular
    ? std::vector<vtkTextureObject*>{ this->Color, this->Specular }
    : std::vector<vtkTextureObject*>{ this->Color };
  this->DrawInto(renderer, colors, this->WindowDepth, vtkChiGeometryPass::BUFFER,
    [this, start]
    {
      glFinish(); // reading waits anyhow: what it waits for is the drawing
      this->SecondsDraw = vtkTimerLog::GetUniversalTime() - start;
      glReadPixels(
        0, 0, this->Width, this->Height, GL_DEPTH_COMPONENT, GL_FLOAT, this->WindowDepths.data());
    });
}

//------------------------------------------------------------------------------
void vtkChiGeometryBuffer::DrawSamples(vtkRenderer* renderer, const vtkChiCameraView& camera)
{
  const double start = vtkTimerLog::GetUniversalTime();
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  // Shaded once a pixel, at its centre, normals would be extrapolated beyond thin triangles at
  // silhouettes, to black. OpenGL 4 shades each sample.
  const bool each = glMinSampleShading != nullptr && !glIsEnabled(GL_SAMPLE_SHADING);
  if (each)
  {
    glEnable(GL_SAMPLE_SHADING);
    glMinSampleShading(1.0f);
  }
  this->DrawInto(renderer, { this->Samples.GetColor(), this->Samples.GetSpecular() },
    this->Samples.GetDepth(), vtkChiGeometryPass::BUFFER, [] {});
  if (each)
  {
    glDisable(GL_SAMPLE_SHADING);
  }
  const std::size_t pixels =
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height);
  this->Packed.resize(4 * pixels);
  this->EdgeRgba.resize(4 * pixels);
  this->Bind(window, { this->Color, this->Specular, this->Edge, this->PackedDepths },
    [this, window, &camera, start]
    {
      this->Samples.Resolve(window, camera);
      glFinish();
      this->SecondsDraw = vtkTimerLog::GetUniversalTime() - start;
      this->Target->ActivateReadBuffer(2);
      glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, this->EdgeRgba.data());
      this->Target->ActivateReadBuffer(3);
      glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, this->Packed.data());
    });
}

//------------------------------------------------------------------------------
// Runs a function while these textures, which it allocates, are what is drawn into.
void vtkChiGeometryBuffer::Bind(vtkOpenGLRenderWindow* window,
  const std::vector<vtkTextureObject*>& colors, const std::function<void()>& draw)
{
  const unsigned int width = static_cast<unsigned int>(this->Width);
  const unsigned int height = static_cast<unsigned int>(this->Height);
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  vtkOpenGLState::ScopedglDepthFunc depthFunc(state);
  vtkOpenGLState::ScopedglColorMask colorMask(state);
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  this->Target->SetContext(window);
  state->PushFramebufferBindings();
  this->Target->Bind();
  std::vector<GLenum> buffers;
  for (std::size_t i = 0; i < colors.size(); ++i)
  {
    colors[i]->SetContext(window);
    if (colors[i]->GetHandle() == 0)
    {
      colors[i]->Allocate2D(width, height, 4, VTK_FLOAT);
    }
    colors[i]->Resize(width, height);
    this->Target->AddColorAttachment(static_cast<unsigned int>(i), colors[i]);
    buffers.push_back(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i));
  }
  // vtkOpenGLState compares the first of several buffers alone with what it remembers, which is
  // another frame buffer's while volumes are peeled: say it to OpenGL itself as well
  this->Target->ActivateDrawBuffers(static_cast<unsigned int>(buffers.size()));
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  this->Target->ActivateReadBuffer(0);
  state->vtkglViewport(0, 0, this->Width, this->Height);
  state->vtkglScissor(0, 0, this->Width, this->Height);
  state->vtkglDisable(GL_BLEND);
  state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  draw();
  for (std::size_t i = 0; i < colors.size(); ++i)
  {
    this->Target->RemoveColorAttachment(static_cast<unsigned int>(i));
  }
  state->PopFramebufferBindings();
}

//------------------------------------------------------------------------------
// Draws the props into these textures, and runs a function before they are let go.
void vtkChiGeometryBuffer::DrawInto(vtkRenderer* renderer,
  const std::vector<vtkTextureObject*>& colors, vtkTextureObject* depth,
  vtkChiGeometryPass::Modes mode, const std::function<void()>& read)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  const unsigned int width = static_cast<unsigned int>(this->Width);
  const unsigned int height = static_cast<unsigned int>(this->Height);
  depth->SetContext(window);
  if (depth->GetHandle() == 0)
  {
    depth->AllocateDepth(width, height, vtkTextureObject::Float32);
  }
  depth->Resize(width, height);
  this->Bind(window, colors,
    [this, renderer, window, depth, mode, &read]
    {
      vtkOpenGLState* state = window->GetState();
      vtkOpenGLState::ScopedglClearColor clearColor(state);
      this->Target->AddDepthAttachment(depth);
      state->vtkglEnable(GL_DEPTH_TEST);
      state->vtkglDepthFunc(GL_LEQUAL);
      state->vtkglDepthMask(GL_TRUE);
      state->vtkglClearColor(0.0f, 0.0f, 0.0f, 0.0f);
      state->vtkglClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      this->Pass->SetMode(mode);
      for (vtkProp* prop : this->Props)
      {
        // nobody else's parts of shaders: peeling, say, may be under way
        const vtkChiPlainShaders plain(prop);
        vtkChiAppendPass(prop, this->Pass);
        prop->RenderOpaqueGeometry(renderer);
        vtkChiRemovePass(prop, this->Pass);
      }
      this->Pass->SetMode(this->Hiding ? vtkChiGeometryPass::HIDE : vtkChiGeometryPass::DRAW);
      read();
      this->Target->RemoveDepthAttachment();
    });
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
  normals.resize(
    4 * static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  vtkNew<vtkTextureObject> texture;
  this->DrawInto(renderer, { texture }, this->WindowDepth, vtkChiGeometryPass::NORMAL,
    [this, &normals]
    { glReadPixels(0, 0, this->Width, this->Height, GL_RGBA, GL_FLOAT, normals.data()); });
  texture->ReleaseGraphicsResources(window);
  return true;
}

//------------------------------------------------------------------------------
// From the window's depth to the distance along the view axis; `stride` floats from one to the
// next. Returns whether there is any.
bool vtkChiGeometryBuffer::ConvertDepth(const vtkChiCameraView& camera, const float* window,
  std::size_t stride, std::vector<float>& depths) const
{
  depths.resize(static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  std::atomic<bool> any(false);
  vtkSMPTools::For(0, static_cast<vtkIdType>(depths.size()), 65536,
    [&camera, window, stride, &depths, &any](vtkIdType begin, vtkIdType end)
    {
      const vtkChiCameraView view = camera; // by value: the loop need not read it anew each time
      const float none = std::numeric_limits<float>::infinity();
      float nearest = 1.0f;
      for (std::size_t i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      {
        const float z = window[i * stride];
        const float depth = static_cast<float>(view.Depth(static_cast<double>(z)));
        depths[i] = z < 1.0f ? depth : none;
        nearest = std::min(nearest, z);
      }
      if (nearest < 1.0f)
      {
        any = true;
      }
    });
  return any;
}

//------------------------------------------------------------------------------
// The version is that of the depths, not of the drawing: a change of colour alone must not make the
// engine render again. Edges are blended by the engine, with their colours.
void vtkChiGeometryBuffer::ConvertDepths(const vtkChiCameraView& camera)
{
  std::vector<float>& depths = this->NextDepths;
  if (this->MultiSampled)
  {
    this->AnySurface = this->ConvertDepth(camera, this->Packed.data() + 2, 4, this->EdgeDepths);
    this->AnySurface =
      this->ConvertDepth(camera, this->Packed.data(), 4, this->Ends) || this->AnySurface;
    this->ConvertDepth(camera, this->Packed.data() + 1, 4, depths);
  }
  else
  {
    this->AnySurface = this->ConvertDepth(camera, this->WindowDepths.data(), 1, depths);
  }
  this->View.struct_size = sizeof(chi_surface_view);
  if (this->MultiSampled || depths != this->Depths)
  {
    ++this->View.version;
    this->Depths.swap(depths);
  }
  this->View.depth = this->Depths.data();
  this->View.end = this->MultiSampled ? this->Ends.data() : nullptr;
  this->View.edge_depth = this->MultiSampled ? this->EdgeDepths.data() : nullptr;
  this->View.edge_rgba = this->MultiSampled ? this->EdgeRgba.data() : nullptr;
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
  for (vtkTextureObject* texture : { this->Color.Get(), this->Specular.Get(), this->Edge.Get(),
         this->PackedDepths.Get(), this->WindowDepth.Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
  this->Target->ReleaseGraphicsResources(window);
  this->Samples.ReleaseGraphicsResources(window);
  this->Key.clear();
}
