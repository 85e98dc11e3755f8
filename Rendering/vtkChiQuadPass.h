// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiQuadPass_h
#define vtkChiQuadPass_h

#include <chiaroscuro/chi_occlusion_plan.h>

#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkTextureObject.h"

#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkShaderProgram;

// Draws quads that compute: a fragment shader with definitions, textures to read, textures to
// write, and the rectangle of pixels that it happens in. Shaders are built once a set of
// definitions.
class vtkChiQuadPass
{
public:
  enum Blending
  {
    REPLACE,
    UNDER, // what is there stays in front
    OVER,  // what is there lies behind
    ADD,   // to what is there
    MAXIMUM
  };

  // All draws lie between these two; OpenGL's state is afterwards as it was.
  void Begin(vtkOpenGLRenderWindow* window);
  void End();

  // Null where the shader cannot be built. `definitions` are lines of GLSL. `vertices`: the vertex
  // shader that belongs to the fragment shader; null: that of a quad over the whole target.
  vtkShaderProgram* Use(
    const char* shader, const std::string& definitions, const char* vertices = nullptr);
  void Read(const char* name, vtkTextureObject* texture);
  // The first `blended` targets are blended, further ones replaced.
  void Draw(const std::vector<vtkTextureObject*>& targets, const chi_rect& rect,
    Blending blending = REPLACE, std::size_t blended = 1);
  // A quad each, in order, of which the vertex shader makes what it likes: it is the
  // firstInstance + gl_InstanceID-th.
  void DrawInstances(
    vtkTextureObject* target, const chi_rect& rect, Blending blending, std::size_t count);
  // Fill a rectangle of a texture with one value.
  void Clear(vtkTextureObject* target, const chi_rect& rect, const float value[4]);
  // Whether the frame buffer of a draw was refused.
  bool HasFailed() const { return this->Failed; }

  bool ReadPixels(vtkOpenGLRenderWindow* window, vtkTextureObject* from, int components,
    std::vector<float>& values);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  class State;
  void Bind(const std::vector<vtkTextureObject*>& targets, const chi_rect& rect);
  void Blend(Blending blending);
  void Finish();

  vtkOpenGLRenderWindow* Window = nullptr; // between Begin and End
  std::shared_ptr<State> Restore;
  vtkNew<vtkOpenGLFramebufferObject> Target;
  std::size_t Attached = 0;
  std::map<std::pair<const char*, std::string>, std::unique_ptr<vtkOpenGLQuadHelper>> Programs;
  vtkOpenGLQuadHelper* Quad = nullptr;
  std::vector<vtkTextureObject*> Textures; // active
  bool Failed = false;
};

#endif
