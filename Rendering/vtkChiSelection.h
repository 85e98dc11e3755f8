// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiSelection_h
#define vtkChiSelection_h

#include "vtkChiCameraView.h"

#include <chiaroscuro/chi_volume.h>

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <cstddef>
#include <functional>
#include <vector>

class vtkHardwareSelector;
class vtkOpenGLQuadHelper;
class vtkRenderer;
class vtkVolume;

// Draws a volume into the buffers of vtkHardwareSelector: in every pixel in which it is opaque
// enough, the colour that the pass asks for, at the depth where it gets so.
class vtkChiSelection
{
public:
  // Which points and cells there are to be found.
  struct Ids
  {
    vtkIdType Points = 0; // how many
    vtkIdType Cells = 0;
    // Id of the cell, or of the point, that is found in a pixel, at this place in eye coordinates.
    std::function<vtkIdType(std::size_t pixel, const double eye[3], bool cell)> Find;
  };
  static Ids GetIdsOfImage(const chi_camera& camera, const chi_volume_view& samples);

  vtkChiSelection();
  ~vtkChiSelection();
  vtkChiSelection(const vtkChiSelection&) = delete;
  void operator=(const vtkChiSelection&) = delete;

  // Whether the depths of the pass before are those of this one: passes of one selection follow
  // each other without a change of the scene.
  bool IsKnown(vtkHardwareSelector* selector, vtkVolume* volume, const vtkChiCameraView& camera,
    int width, int height) const;
  // Place for [height x width] depths along the view axis, infinite where there is nothing.
  float* Allocate(vtkVolume* volume, const vtkChiCameraView& camera, int width, int height);
  // Returns false where the shader cannot be built.
  bool Draw(vtkRenderer* renderer, const vtkChiCameraView& camera, const Ids& ids);
  void Forget() { this->Volume = nullptr; }
  void ReleaseGraphicsResources(vtkWindow* window);

private:
  void SetColors(vtkHardwareSelector* selector, const chi_camera& camera, const Ids& ids,
    std::vector<float>& pixels) const;
  bool DrawQuad(vtkRenderer* renderer, const std::vector<float>& pixels);

  vtkOpenGLQuadHelper* Quad = nullptr;
  vtkWeakPointer<vtkRenderWindow> QuadWindow;
  vtkNew<vtkTextureObject> Texture;
  vtkVolume* Volume = nullptr; // compared, never used
  std::vector<float> Depths;
  double View[16] = {};
  double Projection[16] = {};
  int Width = 0;
  int Height = 0;
};

#endif
