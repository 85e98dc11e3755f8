// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTetGL_h
#define vtkChiTetGL_h

#include "vtkChiQuadPass.h"
#include "vtkChiTetTextures.h"

#include <chiaroscuro/chi_tet.h>

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkShaderProgram;

// The OpenGL engine of tetrahedra: draws the core's plan of a frame, one quad a tetrahedron, the
// farthest first, and leaves the picture in a texture. OpenGL 3.2 core.
class vtkChiTetGL
{
public:
  // Why this window cannot draw this frame, or this plan of it; empty where it can.
  static std::string WhyNot(vtkOpenGLRenderWindow* window, const chi_tet_frame& frame);
  static std::string WhyNot(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);

  // False where OpenGL refuses something.
  bool Render(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  // Whether the texture holds the picture of this plan.
  bool Holds(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);

  // premultiplied colour and alpha
  vtkTextureObject* GetLayer() { return this->Reduced ? this->FullLayer : this->Layer; }
  bool ReadLayer(vtkOpenGLRenderWindow* window, std::vector<float>& rgba);
  // Pairs of a tetrahedron and a pixel in the last picture that was drawn.
  std::int64_t GetFragments() const { return this->Fragments; }

  void ReleaseGraphicsResources(vtkWindow* window);

private:
  bool Allocate(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  void DrawTetrahedra(const chi_tet_plan& plan);
  void ReadInputs(vtkShaderProgram* program, const chi_tet_plan& plan);
  void SetView(vtkShaderProgram* program, const chi_tet_plan& plan);
  void DrawMaximum(const chi_tet_plan& plan);
  void DrawEnlarged(const chi_tet_plan& plan);

  vtkWeakPointer<vtkRenderWindow> Window;
  vtkChiQuadPass Pass;
  vtkChiTetTextures Inputs;
  vtkNew<vtkTextureObject> Layer;
  vtkNew<vtkTextureObject> Places;    // in the tables, of the largest scalar and its opacity so far
  vtkNew<vtkTextureObject> FullLayer; // the layer enlarged
  bool Reduced = false;
  bool Drawn = false;
  std::uint64_t FrameVersion = 0;
  std::int64_t Fragments = 0;
};

#endif
