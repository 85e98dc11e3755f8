// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGeometrySamples_h
#define vtkChiGeometrySamples_h

#include "vtkChiCameraView.h"

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

class vtkOpenGLQuadHelper;
class vtkOpenGLRenderWindow;

// Textures of several samples a pixel, and how they become one.
class vtkChiGeometrySamples
{
public:
  vtkChiGeometrySamples() = default;
  ~vtkChiGeometrySamples();
  vtkChiGeometrySamples(const vtkChiGeometrySamples&) = delete;
  void operator=(const vtkChiGeometrySamples&) = delete;

  // Returns false where OpenGL offers less than two samples a pixel.
  bool Allocate(vtkOpenGLRenderWindow* window, int width, int height);
  vtkTextureObject* GetColor() { return this->Color; }
  vtkTextureObject* GetSpecular() { return this->Specular; }
  vtkTextureObject* GetDepth() { return this->Depth; }

  // Into the four textures that are bound: colour and specular colour where rays end, the edge, and
  // window depths of the end, of what blocks light, and of the edge.
  void Resolve(vtkOpenGLRenderWindow* window, const vtkChiCameraView& camera);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  vtkNew<vtkTextureObject> Color;
  vtkNew<vtkTextureObject> Specular;
  vtkNew<vtkTextureObject> Depth;
  vtkOpenGLQuadHelper* Quad = nullptr;
  vtkWeakPointer<vtkRenderWindow> QuadWindow;
  int Count = 0;
};

#endif
