// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiCompositor_h
#define vtkChiCompositor_h

#include "vtkNew.h"
#include "vtkOpenGLFXAAFilter.h"
#include "vtkRenderWindow.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

class vtkOpenGLQuadHelper;
class vtkOpenGLRenderWindow;
class vtkRenderer;

// Lays a picture that the core has rendered over the bound frame buffer, within the viewport that
// is set, and leaves OpenGL as it was.
class vtkChiCompositor
{
public:
  struct Picture
  {
    int Width = 0;
    int Height = 0;
    const float* Rgba = nullptr;          // [height x width x 4] premultiplied
    const float* Visibility = nullptr;    // [height x width] of the opaque geometry, if shaded
    const float* VisibilityRgb = nullptr; // [height x width x 3] in its place, where colours differ
    vtkTextureObject* RgbaTexture = nullptr;       // the same where the picture lies in textures;
    vtkTextureObject* VisibilityTexture = nullptr; // null: the floats are uploaded
    vtkTextureObject* Surface = nullptr;  // lit colours of the opaque geometry; null: there is none
    vtkTextureObject* Specular = nullptr; // part of these that occlusion does not take; null: none
    bool Unchanged = false;               // the same floats as in the last call
    bool First = false;                   // nobody has shaded the geometry in this frame
    bool Hidden = false;  // the frame buffer holds depths of the geometry, no colour
    bool Smooth = false;  // the last of this frame, and FXAA is to go over it
    bool Layered = false; // translucent geometry is in the picture, nowhere else
    bool Dither = false;  // an ordered pattern within half a step of 8 bits
    bool Peeling = false; // a buffer of the depth peeling pass is bound
  };

  vtkChiCompositor();
  ~vtkChiCompositor();
  vtkChiCompositor(const vtkChiCompositor&) = delete;
  void operator=(const vtkChiCompositor&) = delete;

  // Returns false where the shader cannot be built.
  bool Draw(vtkRenderer* renderer, const Picture& picture);
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  void Upload(vtkOpenGLRenderWindow* window, const Picture& picture);
  bool PrepareQuad(vtkOpenGLRenderWindow* window, const Picture& picture);
  void DropQuads();
  void DrawPlain(vtkOpenGLRenderWindow* window, const Picture& picture);
  void Smooth(vtkRenderer* renderer, const Picture& picture);
  void DrawQuad(vtkRenderer* renderer, const Picture& picture);

  vtkOpenGLQuadHelper* Quad = nullptr;
  vtkOpenGLQuadHelper* Plain = nullptr; // of pictures without geometry
  vtkWeakPointer<vtkRenderWindow> QuadWindow;
  vtkNew<vtkOpenGLFXAAFilter> Fxaa;
  vtkNew<vtkTextureObject> Layer;
  vtkNew<vtkTextureObject> Visibility;
  bool Uploaded = false; // the textures hold the picture of the last call
  int Covered[4] = { 0, 0, 0,
    0 }; // its first column and row, those after its last, within the picture
};

#endif
