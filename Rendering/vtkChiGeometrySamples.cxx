// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiGeometrySamples.h"

#include "vtkChiGeometryResolveFS.h"

#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkShaderProgram.h"

#include <algorithm>
#include <cmath>

//------------------------------------------------------------------------------
vtkChiGeometrySamples::~vtkChiGeometrySamples()
{
  delete this->Quad;
}

//------------------------------------------------------------------------------
bool vtkChiGeometrySamples::Allocate(vtkOpenGLRenderWindow* window, int width, int height)
{
  int limits[2] = { 0, 0 };
  glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &limits[0]);
  glGetIntegerv(GL_MAX_DEPTH_TEXTURE_SAMPLES, &limits[1]);
  this->Count = std::min({ limits[0], limits[1], 8 });
  if (this->Count < 2)
  {
    return false;
  }
  const unsigned int size[2] = { static_cast<unsigned int>(width),
    static_cast<unsigned int>(height) };
  for (vtkTextureObject* texture : { this->Color.Get(), this->Specular.Get(), this->Depth.Get() })
  {
    texture->SetContext(window);
    texture->SetAutoParameters(0); // textures of samples have no filters to set
    texture->SetSamples(static_cast<unsigned int>(this->Count));
    if (texture->GetHandle() != 0 && texture->GetWidth() == size[0] &&
      texture->GetHeight() == size[1])
    {
      continue;
    }
    texture->ReleaseGraphicsResources(window);
    texture->SetContext(window);
    if (texture == this->Depth.Get())
    {
      texture->AllocateDepth(size[0], size[1], vtkTextureObject::Float32);
    }
    else
    {
      texture->Allocate2D(size[0], size[1], 4, VTK_FLOAT);
    }
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkChiGeometrySamples::Resolve(vtkOpenGLRenderWindow* window, const vtkChiCameraView& camera)
{
  if (this->Quad && this->QuadWindow.GetPointer() != window)
  {
    delete this->Quad;
    this->Quad = nullptr;
  }
  if (this->Quad)
  {
    window->GetShaderCache()->ReadyShaderProgram(this->Quad->Program);
  }
  else
  {
    this->QuadWindow = window;
    this->Quad = new vtkOpenGLQuadHelper(window, nullptr, vtkChiGeometryResolveFS, "");
  }
  vtkShaderProgram* program = this->Quad->Program;
  if (!program)
  {
    return;
  }
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  state->vtkglDisable(GL_DEPTH_TEST);
  state->vtkglDisable(GL_CULL_FACE);
  vtkTextureObject* textures[3] = { this->Color, this->Specular, this->Depth };
  const char* names[3] = { "colorSamples", "specularSamples", "depthSamples" };
  for (int i = 0; i < 3; ++i)
  {
    textures[i]->Activate();
    program->SetUniformi(names[i], textures[i]->GetTextureUnit());
  }
  const double* p = camera.GetProjection();
  const float row[4] = { static_cast<float>(p[10]), static_cast<float>(p[11]),
    static_cast<float>(p[14]), static_cast<float>(p[15]) };
  const chi_camera* view = camera.Get();
  const double pixel = std::max(std::abs(view->window[1] - view->window[0]) / view->width,
    std::abs(view->window[3] - view->window[2]) / view->height);
  program->SetUniform4f("depthRow", row);
  program->SetUniformi("sampleCount", this->Count);
  program->SetUniformf("reach", static_cast<float>(4.0 * pixel)); // up to 76 degrees from the view
  this->Quad->Render();
  for (vtkTextureObject* texture : textures)
  {
    texture->Deactivate();
  }
}

//------------------------------------------------------------------------------
void vtkChiGeometrySamples::ReleaseGraphicsResources(vtkWindow* window)
{
  delete this->Quad;
  this->Quad = nullptr;
  this->Color->ReleaseGraphicsResources(window);
  this->Specular->ReleaseGraphicsResources(window);
  this->Depth->ReleaseGraphicsResources(window);
}
