// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiCompositor.h"

#include "vtkChiOcclusionCompositeFS.h"
#include "vtkChiOcclusionCompositePlainFS.h"

#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLRenderer.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkProp.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace
{
//------------------------------------------------------------------------------
bool hasTranslucentGeometry(vtkRenderer* renderer)
{
  vtkCollectionSimpleIterator cookie;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie))
  {
    if (prop->GetVisibility() && prop->HasTranslucentPolygonalGeometry())
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
// Whether the bound frame buffer holds just what the private buffer holds where there is geometry.
// In all other cases rewriting pixels would take away what others have drawn.
bool mayRewriteSurface(vtkRenderer* renderer, bool hidden)
{
  int samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  return samples <= 1 && !renderer->GetPass() && !renderer->GetUseFXAA() &&
    !renderer->GetUseShadows() && !renderer->GetUseSSAO() && !renderer->GetUseHiddenLineRemoval() &&
    (hidden || !hasTranslucentGeometry(renderer));
}

//------------------------------------------------------------------------------
// The rectangle of a picture outside of which it is all zeros: first column and row, past the last.
void findCovered(int width, int height, const float* rgba, int box[4])
{
  const std::size_t row = 4 * static_cast<std::size_t>(width);
  // bits without a way out of the loop, so that it becomes vectors; -0 counts as something
  const auto isEmpty = [](const float* from, std::size_t count)
  {
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      std::uint32_t bits;
      std::memcpy(&bits, from + i, sizeof bits);
      any |= bits;
    }
    return any == 0;
  };
  int low = 0;
  int high = height;
  while (low < high && isEmpty(rgba + low * row, row))
  {
    ++low;
  }
  while (high > low && isEmpty(rgba + (high - 1) * row, row))
  {
    --high;
  }
  int left = low < high ? width : 0;
  int right = 0;
  for (int y = low; y < high; ++y)
  {
    const float* line = rgba + y * row;
    for (int x = 0; x < left; ++x) // stops at what an earlier row has
    {
      if (!isEmpty(line + 4 * x, 4))
      {
        left = x;
      }
    }
    for (int x = width; x > right; --x)
    {
      if (!isEmpty(line + 4 * (x - 1), 4))
      {
        right = x;
      }
    }
  }
  box[0] = left;
  box[1] = low;
  box[2] = right;
  box[3] = high;
}

//------------------------------------------------------------------------------
void uploadPlane(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, int width, int height,
  int components, const float* data)
{
  texture->SetContext(window);
  texture->SetMinificationFilter(vtkTextureObject::Nearest);
  texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  texture->ResetFormatAndType(); // of one component or three, whichever it was before
  // the texture's interface takes no const, and only reads
  texture->Create2DFromRaw(static_cast<unsigned int>(width), static_cast<unsigned int>(height),
    components, VTK_FLOAT, const_cast<float*>(data));
}
}

//------------------------------------------------------------------------------
vtkChiCompositor::vtkChiCompositor() = default;

//------------------------------------------------------------------------------
vtkChiCompositor::~vtkChiCompositor()
{
  this->DropQuads();
}

//------------------------------------------------------------------------------
void vtkChiCompositor::DropQuads()
{
  delete this->Quad;
  delete this->Plain;
  this->Quad = this->Plain = nullptr;
}

//------------------------------------------------------------------------------
bool vtkChiCompositor::Draw(vtkRenderer* renderer, const Picture& picture)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (!picture.RgbaTexture)
  {
    this->Upload(window, picture);
  }

  // While volumes are peeled a buffer of the peeling pass is bound for drawing; the frame buffer
  // that holds the opaque geometry is the one bound for reading.
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglViewport viewport(state);
  vtkOpenGLState::ScopedglScissor scissor(state);
  if (picture.Peeling)
  {
    int target = 0;
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &target);
    state->PushFramebufferBindings();
    state->vtkglBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<unsigned int>(target));
    int size[2];
    int origin[2];
    renderer->GetTiledSizeAndOrigin(&size[0], &size[1], &origin[0], &origin[1]);
    state->vtkglViewport(origin[0], origin[1], picture.Width, picture.Height);
    state->vtkglScissor(origin[0], origin[1], picture.Width, picture.Height);
  }
  const bool good = this->PrepareQuad(window, picture);
  if (good)
  {
    this->DrawQuad(renderer, picture);
  }
  if (good && picture.Smooth)
  {
    this->Smooth(renderer, picture);
  }
  if (picture.Peeling)
  {
    state->PopFramebufferBindings();
  }
  return good;
}

//------------------------------------------------------------------------------
void vtkChiCompositor::Upload(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  if (this->Uploaded && picture.Unchanged && this->QuadWindow.GetPointer() == window &&
    this->Layer->GetHandle() != 0)
  {
    return;
  }
  uploadPlane(this->Layer, window, picture.Width, picture.Height, 4, picture.Rgba);
  findCovered(picture.Width, picture.Height, picture.Rgba, this->Covered);
  const bool colored = picture.VisibilityRgb != nullptr;
  if (colored || picture.Visibility)
  {
    uploadPlane(this->Visibility, window, picture.Width, picture.Height, colored ? 3 : 1,
      colored ? picture.VisibilityRgb : picture.Visibility);
  }
  this->Uploaded = true;
}

//------------------------------------------------------------------------------
bool vtkChiCompositor::PrepareQuad(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  if (this->QuadWindow.GetPointer() != window)
  {
    this->DropQuads();
    this->QuadWindow = window;
  }
  const bool plain = !picture.Surface && !picture.Dither;
  vtkOpenGLQuadHelper*& quad = plain ? this->Plain : this->Quad;
  if (quad)
  {
    window->GetShaderCache()->ReadyShaderProgram(quad->Program);
  }
  else
  {
    quad = new vtkOpenGLQuadHelper(
      window, nullptr, plain ? vtkChiOcclusionCompositePlainFS : vtkChiOcclusionCompositeFS, "");
  }
  return quad->Program != nullptr;
}

//------------------------------------------------------------------------------
// No geometry to darken: where the picture is zero, nothing changes.
void vtkChiCompositor::DrawPlain(vtkOpenGLRenderWindow* window, const Picture& picture)
{
  vtkTextureObject* layer = picture.RgbaTexture ? picture.RgbaTexture : this->Layer.Get();
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglScissor scissor(state);
  vtkOpenGLState::ScopedglEnableDisable scissorTest(state, GL_SCISSOR_TEST);
  if (!picture.RgbaTexture)
  {
    int viewport[4];
    int box[4] = { 0, 0, 1 << 30, 1 << 30 };
    glGetIntegerv(GL_VIEWPORT, viewport);
    if (glIsEnabled(GL_SCISSOR_TEST))
    {
      glGetIntegerv(GL_SCISSOR_BOX, box);
    }
    const bool pixels = viewport[2] == picture.Width && viewport[3] == picture.Height;
    int low[2];
    int size[2];
    for (int axis = 0; axis < 2; ++axis)
    {
      const int first = pixels ? viewport[axis] + this->Covered[axis] : viewport[axis];
      const int past =
        pixels ? viewport[axis] + this->Covered[2 + axis] : viewport[axis] + viewport[2 + axis];
      low[axis] = std::max(first, box[axis]);
      size[axis] = std::max(std::min(past, box[axis] + box[2 + axis]) - low[axis], 0);
    }
    state->vtkglEnable(GL_SCISSOR_TEST);
    state->vtkglScissor(low[0], low[1], size[0], size[1]);
  }
  layer->Activate();
  this->Plain->Program->SetUniformi("layerTexture", layer->GetTextureUnit());
  this->Plain->Render();
  layer->Deactivate();
}

//------------------------------------------------------------------------------
void vtkChiCompositor::DrawQuad(vtkRenderer* renderer, const Picture& picture)
{
  vtkOpenGLState* state =
    vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  int equation[2]; // depth peeling takes maxima
  glGetIntegerv(GL_BLEND_EQUATION_RGB, &equation[0]);
  glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &equation[1]);
  state->vtkglEnable(GL_BLEND);
  state->vtkglBlendEquation(GL_FUNC_ADD);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  state->vtkglDisable(GL_DEPTH_TEST); // the picture ends at the geometry by itself
  state->vtkglDepthMask(GL_FALSE);
  state->vtkglDisable(GL_CULL_FACE);

  if (!picture.Surface && !picture.Dither)
  {
    this->DrawPlain(vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()), picture);
    state->vtkglBlendEquationSeparate(
      static_cast<unsigned int>(equation[0]), static_cast<unsigned int>(equation[1]));
    return;
  }
  // a texture that is missing is declared in the shader, but not read
  const bool uploaded = !picture.RgbaTexture;
  vtkTextureObject* layer = uploaded ? this->Layer.Get() : picture.RgbaTexture;
  vtkTextureObject* visibility = picture.VisibilityTexture;
  bool colored = visibility && visibility->GetComponents() > 1;
  if (uploaded)
  {
    colored = picture.VisibilityRgb != nullptr;
    visibility = colored || picture.Visibility ? this->Visibility.Get() : nullptr;
  }
  vtkTextureObject* textures[4] = { layer, visibility, picture.Surface,
    picture.Surface ? picture.Specular : nullptr };
  const char* names[4] = { "layerTexture", "visibilityTexture", "surfaceTexture",
    "specularTexture" };
  vtkShaderProgram* program = this->Quad->Program;
  for (int i = 0; i < 4; ++i)
  {
    vtkTextureObject* texture = textures[i];
    if (texture)
    {
      texture->Activate();
    }
    program->SetUniformi(names[i], (texture ? texture : layer)->GetTextureUnit());
  }
  program->SetUniformi("dither", picture.Dither ? 1 : 0);
  program->SetUniformi("hasSpecular", textures[3] ? 1 : 0);
  program->SetUniformi("hasSurface", picture.Surface ? 1 : 0);
  const bool rewrite = picture.Surface && picture.First &&
    (picture.Hidden || mayRewriteSurface(renderer, picture.Layered));
  program->SetUniformi("rewriteSurface", rewrite ? 1 : 0);
  program->SetUniformi("coloredVisibility", colored ? 1 : 0);
  // One alpha cannot darken colours by different parts: then they are multiplied first. Where
  // geometry is rewritten nothing of it is left to darken.
  const int first = colored && picture.Surface && !rewrite ? 1 : 0;
  for (int stage = first; stage <= 2 * first; ++stage)
  {
    program->SetUniformi("stage", stage);
    if (stage == 1)
    {
      state->vtkglBlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_ZERO, GL_SRC_ALPHA);
    }
    else if (stage == 2)
    {
      state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE, GL_ONE, GL_ONE);
    }
    this->Quad->Render();
  }
  for (vtkTextureObject* texture : textures)
  {
    if (texture)
    {
      texture->Deactivate();
    }
  }
  state->vtkglBlendEquationSeparate(
    static_cast<unsigned int>(equation[0]), static_cast<unsigned int>(equation[1]));
}

//------------------------------------------------------------------------------
// Of all that the viewport holds by now. Several samples a pixel cannot be copied from, and need it
// least.
void vtkChiCompositor::Smooth(vtkRenderer* renderer, const Picture& picture)
{
  vtkOpenGLRenderer* target = vtkOpenGLRenderer::SafeDownCast(renderer);
  int samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  if (!target || samples > 1)
  {
    return;
  }
  vtkOpenGLState* state =
    vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  state->PushFramebufferBindings();
  if (!picture.Peeling)
  {
    int bound = 0; // what is drawn into is what is copied from
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    state->vtkglBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<unsigned int>(bound));
  }
  this->Fxaa->UpdateConfiguration(renderer->GetFXAAOptions());
  this->Fxaa->Execute(target);
  state->PopFramebufferBindings();
}

//------------------------------------------------------------------------------
void vtkChiCompositor::ReleaseGraphicsResources(vtkWindow* window)
{
  this->DropQuads();
  this->Uploaded = false;
  if (window)
  {
    this->Fxaa->ReleaseGraphicsResources();
    this->Layer->ReleaseGraphicsResources(window);
    this->Visibility->ReleaseGraphicsResources(window);
  }
}
