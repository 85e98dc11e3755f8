// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGeometryBuffer_h
#define vtkChiGeometryBuffer_h

#include "vtkChiCameraView.h"
#include "vtkChiGeometryPass.h"

#include <chiaroscuro/chi_surface.h>

#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkTextureObject.h"

#include <cstdint>
#include <functional>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkProp;

// The opaque geometry of a renderer, drawn into a colour and a depth texture of the viewport's
// size. It is drawn anew only where the geometry, the lights, the view or the size have changed.
// The props are drawn as they are, without the key of a render pass on them, so that no shader is
// rebuilt.
class vtkChiGeometryBuffer
{
public:
  // Returns false where there is no opaque geometry.
  bool Update(vtkRenderer* renderer, const vtkChiCameraView& camera, int width, int height);

  // Null where there is no opaque geometry in view.
  const chi_surface_view* GetView() const { return this->AnySurface ? &this->View : nullptr; }
  // Window depth, 0 to 1, Float32; null where there is no opaque geometry in view.
  vtkTextureObject* GetWindowDepth()
  {
    return this->AnySurface ? this->WindowDepth.Get() : nullptr;
  }
  // Everything that the picture of these props depends on, but for its size.
  static std::vector<std::uint64_t> MakeKey(
    vtkRenderer* renderer, const vtkChiCameraView& camera, const std::vector<vtkProp*>& drawn);
  vtkTextureObject* GetColor() { return this->Color; }
  // Colours, [height x width x 4] floats, alpha 0 where there is no geometry, are those of the last
  // drawing. Normals are drawn when they are asked for, because no engine needs
  // them yet and a pass of their own has every shader rebuilt: [height x width x 4] floats in view
  // coordinates, fourth component 0 where there is no geometry or its shader has no normal.
  bool ReadColor(vtkOpenGLRenderWindow* window, std::vector<float>& rgba);
  // The specular part of the colours; null, and false, where no prop has any.
  vtkTextureObject* GetSpecular() { return this->AnySpecular ? this->Specular.Get() : nullptr; }
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
  void DrawInto(vtkOpenGLRenderWindow* window, vtkTextureObject* color,
    const std::function<void()>& draw, const std::function<void()>& read);
  void Draw(vtkRenderer* renderer, vtkOpenGLRenderWindow* window);
  void DrawSpecular(vtkRenderer* renderer, vtkOpenGLRenderWindow* window);
  bool Read(vtkOpenGLRenderWindow* window, vtkTextureObject* from, std::vector<float>& rgba);
  void ConvertDepth(const vtkChiCameraView& camera);

  vtkNew<vtkTextureObject> Color;
  vtkNew<vtkTextureObject> Specular;
  vtkNew<vtkChiGeometryPass> SpecularPass;
  vtkNew<vtkTextureObject> WindowDepth;
  vtkNew<vtkOpenGLFramebufferObject> Target;
  std::vector<vtkProp*> Props;
  std::vector<std::uint64_t> Key;
  std::vector<float> WindowDepths; // as read back, 0 to 1
  std::vector<float> Depths;       // along the view axis
  chi_surface_view View = {};
  int Width = 0;
  int Height = 0;
  bool AnySurface = false;
  bool AnySpecular = false;
  bool Reused = false;
  double SecondsDraw = 0.0;
  double SecondsReadBack = 0.0;
};

#endif
