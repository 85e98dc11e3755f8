// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiQuadPass.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkOpenGLVertexArrayObject.h"
#include "vtkShaderProgram.h"

#include <algorithm>

//------------------------------------------------------------------------------
// What draws change, put back at the end.
class vtkChiQuadPass::State
{
public:
  explicit State(vtkOpenGLState* state)
    : GL(state)
    , Viewport(state)
    , Scissor(state)
    , ClearColor(state)
    , ColorMask(state)
    , DepthMask(state)
    , BlendFunction(state)
    , Blend(state, GL_BLEND)
    , DepthTest(state, GL_DEPTH_TEST)
    , CullFace(state, GL_CULL_FACE)
    , ScissorTest(state, GL_SCISSOR_TEST)
    , StencilTest(state, GL_STENCIL_TEST)
  {
    glGetIntegerv(GL_BLEND_EQUATION_RGB, &this->Equation[0]);
    glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &this->Equation[1]);
    state->PushFramebufferBindings();
    state->vtkglBlendEquation(GL_FUNC_ADD);
    state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    state->vtkglDepthMask(GL_FALSE);
    state->vtkglDisable(GL_BLEND);
    state->vtkglDisable(GL_DEPTH_TEST);
    state->vtkglDisable(GL_CULL_FACE);
    state->vtkglDisable(GL_STENCIL_TEST);
    state->vtkglEnable(GL_SCISSOR_TEST);
  }
  ~State()
  {
    this->GL->PopFramebufferBindings();
    this->GL->vtkglBlendEquationSeparate(
      static_cast<unsigned int>(this->Equation[0]), static_cast<unsigned int>(this->Equation[1]));
  }
  State(const State&) = delete;
  void operator=(const State&) = delete;

private:
  vtkOpenGLState* GL;
  vtkOpenGLState::ScopedglViewport Viewport;
  vtkOpenGLState::ScopedglScissor Scissor;
  vtkOpenGLState::ScopedglClearColor ClearColor;
  vtkOpenGLState::ScopedglColorMask ColorMask;
  vtkOpenGLState::ScopedglDepthMask DepthMask;
  vtkOpenGLState::ScopedglBlendFuncSeparate BlendFunction;
  vtkOpenGLState::ScopedglEnableDisable Blend;
  vtkOpenGLState::ScopedglEnableDisable DepthTest;
  vtkOpenGLState::ScopedglEnableDisable CullFace;
  vtkOpenGLState::ScopedglEnableDisable ScissorTest;
  vtkOpenGLState::ScopedglEnableDisable StencilTest;
  int Equation[2] = { GL_FUNC_ADD, GL_FUNC_ADD };
};

//------------------------------------------------------------------------------
void vtkChiQuadPass::Begin(vtkOpenGLRenderWindow* window)
{
  this->Window = window;
  this->Failed = false;
  this->Restore = std::make_shared<State>(window->GetState());
  this->Target->SetContext(window);
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::End()
{
  if (this->Attached > 0)
  {
    // a texture that stays attached could not be resized or released by itself
    this->Target->Bind();
    this->Target->RemoveColorAttachments(static_cast<unsigned int>(this->Attached));
    this->Attached = 0;
  }
  this->Restore.reset();
  this->Window = nullptr;
  this->Quad = nullptr;
}

//------------------------------------------------------------------------------
vtkShaderProgram* vtkChiQuadPass::Use(
  const char* shader, const std::string& definitions, const char* vertices)
{
  std::unique_ptr<vtkOpenGLQuadHelper>& quad = this->Programs[{ shader, definitions }];
  if (quad)
  {
    this->Window->GetShaderCache()->ReadyShaderProgram(quad->Program);
  }
  else
  {
    std::string source = shader;
    std::string vertexSource = vertices ? vertices : "";
    vtkShaderProgram::Substitute(source, "//CHI::Defines::Dec", definitions);
    vtkShaderProgram::Substitute(vertexSource, "//CHI::Defines::Dec", definitions);
    quad.reset(new vtkOpenGLQuadHelper(
      this->Window, vertices ? vertexSource.c_str() : nullptr, source.c_str(), ""));
  }
  this->Quad = quad.get();
  this->Failed = this->Failed || !quad->Program;
  return quad->Program;
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Read(const char* name, vtkTextureObject* texture)
{
  texture->Activate();
  this->Quad->Program->SetUniformi(name, texture->GetTextureUnit());
  this->Textures.push_back(texture);
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Bind(const std::vector<vtkTextureObject*>& targets, const chi_rect& rect)
{
  vtkOpenGLState* state = this->Window->GetState();
  this->Target->Bind();
  for (std::size_t i = 0; i < targets.size(); ++i)
  {
    this->Target->AddColorAttachment(static_cast<unsigned int>(i), targets[i]);
  }
  for (std::size_t i = targets.size(); i < this->Attached; ++i)
  {
    this->Target->RemoveColorAttachment(static_cast<unsigned int>(i));
  }
  this->Attached = targets.size();
  this->Target->ActivateDrawBuffers(static_cast<unsigned int>(targets.size()));
  if (!this->Target->CheckFrameBufferStatus(GL_FRAMEBUFFER))
  {
    this->Failed = true;
  }
  state->vtkglViewport(
    0, 0, static_cast<int>(targets[0]->GetWidth()), static_cast<int>(targets[0]->GetHeight()));
  state->vtkglScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Draw(const std::vector<vtkTextureObject*>& targets, const chi_rect& rect,
  Blending blending, std::size_t blended)
{
  this->Bind(targets, rect);
  this->Blend(blending);
  if (blending != REPLACE)
  {
    for (std::size_t i = blended; i < targets.size(); ++i)
    {
      glDisablei(GL_BLEND, static_cast<unsigned int>(i));
    }
  }
  if (!this->Failed)
  {
    const float size[2] = { static_cast<float>(targets[0]->GetWidth()),
      static_cast<float>(targets[0]->GetHeight()) };
    this->Quad->Program->SetUniform2f("targetSize", size);
    this->Quad->Render();
  }
  this->Finish();
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::DrawInstances(
  vtkTextureObject* target, const chi_rect& rect, Blending blending, std::size_t count)
{
  constexpr std::size_t BATCH = 1 << 18; // systems stop a call that keeps them for seconds
  this->Bind({ target }, rect);
  this->Blend(blending);
  for (std::size_t first = 0; first < count && !this->Failed; first += BATCH)
  {
    this->Quad->Program->SetUniformi("firstInstance", static_cast<int>(first));
    this->Quad->VAO->Bind();
    glDrawArraysInstanced(
      GL_TRIANGLE_STRIP, 0, 4, static_cast<int>(std::min(BATCH, count - first)));
    this->Quad->VAO->Release();
  }
  this->Finish();
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Blend(Blending blending)
{
  if (blending == REPLACE)
  {
    return;
  }
  vtkOpenGLState* state = this->Window->GetState();
  const unsigned int source = blending == UNDER ? GL_ONE_MINUS_DST_ALPHA : GL_ONE;
  const unsigned int target = blending == OVER ? GL_ONE_MINUS_SRC_ALPHA : GL_ONE;
  state->vtkglEnable(GL_BLEND);
  state->vtkglBlendEquation(blending == MAXIMUM ? GL_MAX : GL_FUNC_ADD);
  state->vtkglBlendFuncSeparate(source, target, source, target);
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Finish()
{
  // of all targets, whatever was set for one
  this->Window->GetState()->vtkglDisable(GL_BLEND);
  this->Window->GetState()->vtkglBlendEquation(GL_FUNC_ADD);
  for (vtkTextureObject* texture : this->Textures)
  {
    texture->Deactivate();
  }
  this->Textures.clear();
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::Clear(vtkTextureObject* target, const chi_rect& rect, const float value[4])
{
  this->Bind({ target }, rect);
  this->Window->GetState()->vtkglClearColor(value[0], value[1], value[2], value[3]);
  this->Window->GetState()->vtkglClear(GL_COLOR_BUFFER_BIT);
}

//------------------------------------------------------------------------------
bool vtkChiQuadPass::ReadPixels(
  vtkOpenGLRenderWindow* window, vtkTextureObject* from, int components, std::vector<float>& values)
{
  if (!window || from->GetHandle() == 0)
  {
    return false;
  }
  window->MakeCurrent();
  this->Begin(window);
  const int width = static_cast<int>(from->GetWidth());
  const int height = static_cast<int>(from->GetHeight());
  this->Bind({ from }, { 0, 0, width, height });
  this->Target->ActivateReadBuffer(0);
  values.resize(static_cast<std::size_t>(components) * from->GetWidth() * from->GetHeight());
  glReadPixels(0, 0, width, height, components == 4 ? GL_RGBA : GL_RED, GL_FLOAT, values.data());
  const bool good = !this->Failed;
  this->End();
  return good;
}

//------------------------------------------------------------------------------
void vtkChiQuadPass::ReleaseGraphicsResources(vtkWindow* window)
{
  this->Programs.clear();
  this->Quad = nullptr;
  this->Attached = 0;
  if (window)
  {
    this->Target->ReleaseGraphicsResources(window);
  }
}
