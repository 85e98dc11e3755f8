// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGeometryBuffer_h
#define vtkChiGeometryBuffer_h

#include "vtkChiCameraView.h"
#include "vtkChiGeometryPass.h"
#include "vtkChiGeometrySamples.h"

#include <chiaroscuro/chi_surface.h>

#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkSmartPointer.h"
#include "vtkTextureObject.h"

#include <cstdint>
#include <functional>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkProp;
class vtkRenderer;

// The opaque geometry of a renderer, drawn into colour and depth textures of the viewport's size.
// It is drawn anew only where the geometry, the lights, the view or the size have changed. One
// render pass hangs on the props for the whole frame, so that no shader is rebuilt.
class vtkChiGeometryBuffer
{
public:
  // From the start of a frame to its end: the render pass, and whether the renderer's own drawing
  // writes depth alone, because all colours come from here.
  void Attach(vtkRenderer* renderer, bool hide);
  void Detach();
  bool IsHiding() const { return this->Hiding; }
  // For who draws it otherwise.
  void SetHiding(bool on) { this->Hiding = on; }
  bool Exist(vtkRenderer* renderer);

  // Returns false where there is no opaque geometry. With several samples a pixel the view has
  // edges, and the colours are those at its `end`, times the share that is covered there.
  bool Update(
    vtkRenderer* renderer, const vtkChiCameraView& camera, int width, int height, bool multiSample);
  // Whether the last drawing has several samples a pixel: not where OpenGL refuses them.
  bool IsMultiSampled() const { return this->MultiSampled; }

  // Null where there is no opaque geometry in view.
  const chi_surface_view* GetView() const { return this->AnySurface ? &this->View : nullptr; }
  // Window depth where rays end, 0 to 1; null where there is no opaque geometry in view.
  vtkTextureObject* GetWindowDepth()
  {
    vtkTextureObject* depth = this->MultiSampled ? this->PackedDepths : this->WindowDepth;
    return this->AnySurface ? depth : nullptr;
  }
  vtkTextureObject* GetColor() { return this->Color; }
  // The specular part of the colours; null, and false, where no prop has any.
  vtkTextureObject* GetSpecular() { return this->AnySpecular ? this->Specular.Get() : nullptr; }
  // Colours, [height x width x 4] floats, alpha 0 where there is no geometry, are those of the last
  // drawing. Normals are drawn when they are asked for, because no engine needs them yet:
  // [height x width x 4] floats in view coordinates, fourth component 0 where there is no geometry
  // or its shader has no normal.
  bool ReadColor(vtkOpenGLRenderWindow* window, std::vector<float>& rgba);
  bool ReadSpecular(vtkOpenGLRenderWindow* window, std::vector<float>& rgba);
  bool ReadNormals(vtkRenderer* renderer, std::vector<float>& normals);
  // Depth along the view axis, [height x width], infinite where there is no geometry.
  const std::vector<float>& GetDepths() const { return this->Depths; }
  int GetWidth() const { return this->Width; }
  int GetHeight() const { return this->Height; }
  bool GetReused() const { return this->Reused; }
  // Draw anew in the next frame, changed or not.
  void Forget() { this->Key.clear(); }
  double GetSecondsDraw() const { return this->SecondsDraw; }
  double GetSecondsReadBack() const { return this->SecondsReadBack; }
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  void CollectProps(vtkRenderer* renderer);
  void Draw(vtkRenderer* renderer);
  void DrawSamples(vtkRenderer* renderer, const vtkChiCameraView& camera);
  void Bind(vtkOpenGLRenderWindow* window, const std::vector<vtkTextureObject*>& colors,
    const std::function<void()>& draw);
  void DrawInto(vtkRenderer* renderer, const std::vector<vtkTextureObject*>& colors,
    vtkTextureObject* depth, vtkChiGeometryPass::Modes mode, const std::function<void()>& read);
  bool Read(vtkOpenGLRenderWindow* window, vtkTextureObject* from, std::vector<float>& rgba);
  void ConvertDepths(const vtkChiCameraView& camera);
  bool ConvertDepth(const vtkChiCameraView& camera, const float* window, std::size_t stride,
    std::vector<float>& depths) const;

  vtkNew<vtkChiGeometryPass> Pass;
  vtkNew<vtkTextureObject> Color;
  vtkNew<vtkTextureObject> Specular;
  vtkNew<vtkTextureObject> WindowDepth;
  vtkNew<vtkTextureObject> Edge;         // colour of a part of a pixel, and its share
  vtkNew<vtkTextureObject> PackedDepths; // in the window: end, what blocks, edge
  vtkNew<vtkOpenGLFramebufferObject> Target;
  vtkChiGeometrySamples Samples;
  std::vector<vtkSmartPointer<vtkProp>> Attached;
  std::vector<vtkProp*> Props;
  std::vector<std::uint64_t> Key;
  std::vector<float> WindowDepths; // as read back, 0 to 1
  std::vector<float> Packed;
  std::vector<float> Depths; // along the view axis, and likewise the next three
  std::vector<float> NextDepths;
  std::vector<float> Ends;
  std::vector<float> EdgeDepths;
  std::vector<float> EdgeRgba;
  chi_surface_view View = {};
  int Width = 0;
  int Height = 0;
  bool AnySurface = false;
  bool AnySpecular = false;
  bool MultiSampled = false;
  bool Hiding = false;
  bool Reused = false;
  double SecondsDraw = 0.0;
  double SecondsReadBack = 0.0;
};

#endif
