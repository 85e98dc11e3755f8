// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiCombinedOcclusionPass.h"

#include "vtkChiCameraView.h"
#include "vtkChiCombinedOcclusionVolumeMapper.h"
#include "vtkChiGeometryDrawFS.h"
#include "vtkChiOcclusionFrame.h"

#include "vtkHardwareSelector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"
#include "vtkSmartPointer.h"
#include "vtkTextureObject.h"
#include "vtkVolume.h"
#include "vtkVolumetricPass.h"
#include "vtkWeakPointer.h"

vtkStandardNewMacro(vtkChiCombinedOcclusionPass);

//------------------------------------------------------------------------------
struct vtkChiCombinedOcclusionPass::Internals
{
  ~Internals() { delete this->Quad; }

  vtkSmartPointer<vtkRenderPass> Delegate = vtkSmartPointer<vtkVolumetricPass>::New();
  vtkWeakPointer<vtkChiOcclusionFrame> Frame;
  vtkWeakPointer<vtkRenderWindow> QuadWindow;
  vtkOpenGLQuadHelper* Quad = nullptr;
  vtkChiCameraView Camera;
};

namespace
{
//------------------------------------------------------------------------------
// Whether all volumes have mappers of ours, and there are some; whether the first one wants several
// samples a pixel.
void lookAtVolumes(const vtkRenderState* state, bool& ours, bool& samples)
{
  int count = 0;
  int others = 0;
  samples = false;
  for (int i = 0; i < state->GetPropArrayCount(); ++i)
  {
    vtkVolume* volume = vtkVolume::SafeDownCast(state->GetPropArray()[i]);
    vtkChiCombinedOcclusionVolumeMapper* mapper =
      volume ? vtkChiCombinedOcclusionVolumeMapper::SafeDownCast(volume->GetMapper()) : nullptr;
    others += volume && !mapper ? 1 : 0;
    if (mapper && count++ == 0)
    {
      const int mode = mapper->GetGeometryAntiAliasing();
      samples = mode == vtkChiCombinedOcclusionVolumeMapper::GEOMETRY_MULTISAMPLE ||
        mode == vtkChiCombinedOcclusionVolumeMapper::GEOMETRY_MULTISAMPLE_AND_FXAA;
    }
  }
  ours = count > 0 && others == 0;
}
}

//------------------------------------------------------------------------------
vtkChiCombinedOcclusionPass::vtkChiCombinedOcclusionPass()
  : Internal(new Internals)
{
}

//------------------------------------------------------------------------------
vtkChiCombinedOcclusionPass::~vtkChiCombinedOcclusionPass() = default;

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionPass::SetDelegatePass(vtkRenderPass* delegate)
{
  if (this->Internal->Delegate != delegate)
  {
    this->Internal->Delegate = delegate;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkRenderPass* vtkChiCombinedOcclusionPass::GetDelegatePass()
{
  return this->Internal->Delegate;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionPass::Render(const vtkRenderState* state)
{
  Internals& in = *this->Internal;
  vtkRenderer* renderer = state->GetRenderer();
  this->NumberOfRenderedProps = 0;
  if (renderer->GetSelector())
  {
    renderer->GetSelector()->Render(
      renderer, state->GetPropArray(), state->GetPropArrayCount()); // as vtkRenderer does
    return;
  }
  int viewport[4];
  glGetIntegerv(GL_VIEWPORT, viewport);
  const bool good = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()) &&
    viewport[2] > 0 && viewport[3] > 0 && !in.Camera.Collect(renderer, viewport[2], viewport[3]);
  bool late = false;
  if (good)
  {
    in.Frame = vtkChiOcclusionFrame::Get(renderer);
    vtkChiGeometryBuffer* geometry = in.Frame->GetGeometry();
    bool ours = false;
    bool samples = false;
    lookAtVolumes(state, ours, samples);
    geometry->Update(renderer, in.Camera, viewport[2], viewport[3], samples && ours);
    // The mapper writes the colours, darkened, over the background: rounded once. Where others draw
    // before it they must be there from the start.
    late = ours && in.Delegate && geometry->GetView();
    geometry->SetHiding(late);
    if (geometry->GetView())
    {
      this->DrawQuad(renderer, !late);
    }
  }
  else
  {
    for (int i = 0; i < state->GetPropArrayCount(); ++i)
    {
      this->NumberOfRenderedProps += state->GetPropArray()[i]->RenderOpaqueGeometry(renderer);
    }
  }
  if (in.Delegate)
  {
    this->PreRender(state);
    in.Delegate->Render(state);
    this->NumberOfRenderedProps += in.Delegate->GetNumberOfRenderedProps();
    this->PostRender(state);
  }
  if (late && in.Frame->IsFirst())
  {
    this->DrawQuad(renderer, true); // no mapper drew
  }
  if (good)
  {
    in.Frame->GetGeometry()->SetHiding(false);
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionPass::DrawQuad(vtkRenderer* renderer, bool colors)
{
  Internals& in = *this->Internal;
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  if (in.Quad && in.QuadWindow.GetPointer() != window)
  {
    delete in.Quad;
    in.Quad = nullptr;
  }
  if (in.Quad)
  {
    window->GetShaderCache()->ReadyShaderProgram(in.Quad->Program);
  }
  else
  {
    in.QuadWindow = window;
    in.Quad = new vtkOpenGLQuadHelper(window, nullptr, vtkChiGeometryDrawFS, "");
  }
  vtkShaderProgram* program = in.Quad->Program;
  if (!program)
  {
    vtkErrorMacro("the shader that draws geometry could not be built");
    return;
  }
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  vtkOpenGLState::ScopedglBlendFuncSeparate blendFunction(state);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  vtkOpenGLState::ScopedglDepthFunc depthFunc(state);
  vtkOpenGLState::ScopedglColorMask colorMask(state);
  const unsigned char write = colors ? GL_TRUE : GL_FALSE;
  state->vtkglColorMask(write, write, write, write);
  state->vtkglEnable(GL_BLEND);
  state->vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  state->vtkglEnable(GL_DEPTH_TEST);
  state->vtkglDepthFunc(GL_LEQUAL);
  state->vtkglDepthMask(GL_TRUE);
  state->vtkglDisable(GL_CULL_FACE);
  vtkChiGeometryBuffer* geometry = in.Frame->GetGeometry();
  vtkTextureObject* textures[2] = { geometry->GetColor(), geometry->GetWindowDepth() };
  const char* names[2] = { "colorTexture", "depthTexture" };
  for (int i = 0; i < 2; ++i)
  {
    textures[i]->Activate();
    program->SetUniformi(names[i], textures[i]->GetTextureUnit());
  }
  program->SetUniformi("samples", geometry->IsMultiSampled() ? 1 : 0);
  in.Quad->Render();
  for (vtkTextureObject* texture : textures)
  {
    texture->Deactivate();
  }
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiCombinedOcclusionPass::GetColorTexture()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame && frame->GetGeometry()->GetView() ? frame->GetGeometry()->GetColor() : nullptr;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiCombinedOcclusionPass::GetSpecularTexture()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame && frame->GetGeometry()->GetView() ? frame->GetGeometry()->GetSpecular() : nullptr;
}

//------------------------------------------------------------------------------
vtkTextureObject* vtkChiCombinedOcclusionPass::GetDepthTexture()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetGeometry()->GetWindowDepth() : nullptr;
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionPass::GetReusedGeometry()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame && frame->GetGeometry()->GetReused();
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionPass::ReleaseGraphicsResources(vtkWindow* window)
{
  Internals& in = *this->Internal;
  delete in.Quad;
  in.Quad = nullptr;
  if (!window) // vtkRenderer::SetRenderWindow says null before the first frame
  {
    return;
  }
  this->Superclass::ReleaseGraphicsResources(window);
  if (in.Delegate)
  {
    in.Delegate->ReleaseGraphicsResources(window);
  }
  if (in.Frame)
  {
    in.Frame->GetGeometry()->ReleaseGraphicsResources(window);
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionPass::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DelegatePass: " << this->Internal->Delegate.Get() << "\n";
}
