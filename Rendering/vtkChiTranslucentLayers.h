// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTranslucentLayers_h
#define vtkChiTranslucentLayers_h

#include "vtkChiCameraView.h"
#include "vtkChiLayersPass.h"

#include <chiaroscuro/chi_surface.h>

#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkSmartPointer.h"
#include "vtkTextureObject.h"

#include <cstdint>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkProp;
class vtkRenderer;

// The translucent geometry of a renderer: hidden from the renderer's own drawing for a frame, and
// peeled into layers for the engine, nearest first, in front of the opaque geometry alone. Drawn
// anew only where something has changed.
class vtkChiTranslucentLayers
{
public:
  // Hide the props for the frame that begins.
  void Hide(vtkRenderer* renderer);
  void Show();
  bool Exist(vtkRenderer* renderer) const { return !this->Find(renderer).empty(); }
  bool IsHiding() const { return !this->Hidden.empty(); }

  // Peel the props that are hidden. `opaque` is the window depth of the opaque geometry, in a
  // texture of this size, null where there is none; `opaqueVersion` differs whenever it does.
  void Update(vtkRenderer* renderer, const vtkChiCameraView& camera, const int size[2],
    vtkTextureObject* opaque, std::uint64_t opaqueVersion);

  // Null where there are no layers in view.
  const chi_layers_view* GetView() const { return this->View.count > 0 ? &this->View : nullptr; }
  // The most layers that any pixel has beyond those of the view.
  int GetDropped() const { return this->Dropped; }
  // Whether there were props that cannot be hidden and peeled.
  bool HasForeign() const { return !this->Foreign.empty(); }
  double GetSeconds() const { return this->Seconds; }
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  std::vector<vtkProp*> Find(vtkRenderer* renderer) const;
  bool DrawLayer(vtkRenderer* renderer, int layer, vtkTextureObject* opaque);
  void CountRest(vtkRenderer* renderer, int layer, vtkTextureObject* opaque);
  void DrawProps(vtkRenderer* renderer);
  void DropForeign();
  void Peel(vtkRenderer* renderer, const vtkChiCameraView& camera, vtkTextureObject* opaque);
  void Convert(const vtkChiCameraView& camera, int layer);

  vtkNew<vtkChiLayersPass> Pass;
  vtkNew<vtkOpenGLFramebufferObject> Target;
  vtkNew<vtkTextureObject> Color;
  vtkNew<vtkTextureObject> Depths[2]; // window depths of two layers in turn, in a colour
  vtkNew<vtkTextureObject> WindowDepth;
  std::vector<vtkSmartPointer<vtkProp>> Hidden;
  std::vector<vtkProp*> Foreign; // compared, never used: mappers that honour no render pass
  std::vector<std::uint64_t> Key;
  std::vector<float> Depth; // [layers x height x width]
  std::vector<float> Rgba;
  chi_layers_view View = {};
  int Width = 0;
  int Height = 0;
  int Dropped = 0;
  double Seconds = 0.0;
};

#endif
