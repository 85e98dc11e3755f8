// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiOcclusionTextures_h
#define vtkChiOcclusionTextures_h

#include <chiaroscuro/chi_occlusion_plan.h>

#include "vtkNew.h"
#include "vtkTextureObject.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkWindow;

// What the core's plan of a frame hands to the OpenGL engine, as textures: samples, bricks, tables,
// surfaces. Each is uploaded when its version changes, and stays until it is released.
class vtkChiOcclusionTextures
{
public:
  // False where OpenGL refuses one of them.
  bool Update(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  void ReleaseGraphicsResources(vtkWindow* window);

  // Place of the table of a component besides the plan's own in the textures of tables.
  static std::size_t FirstEntryOf(const chi_occlusion_plan& plan, int component);

  // Of the samples' texture, in GLSL.
  static const char* SamplerOf(chi_type type);

  vtkTextureObject* GetVolume() { return this->Volume; }
  vtkTextureObject* GetBricks() { return this->Bricks; }
  vtkTextureObject* GetSums() { return this->Sums; }
  vtkTextureObject* GetSigma() { return this->Sigma; }
  vtkTextureObject* GetColors() { return this->Colors; }
  vtkTextureObject* GetColorSums() { return this->ColorSums; }
  vtkTextureObject* GetColorMeans() { return this->ColorMeans; }
  vtkTextureObject* GetSecond() { return this->Second; }
  vtkTextureObject* GetGradientOpacity() { return this->GradientOpacity; }
  // 32 cells of a mask's grid a texel.
  vtkTextureObject* GetKeep(int grid) { return this->Keep[grid]; }
  vtkTextureObject* GetLabels() { return this->Labels; }
  vtkTextureObject* GetSurface() { return this->Surface; }
  vtkTextureObject* GetSurfaceMore() { return this->SurfaceMore; }
  vtkTextureObject* GetGuide() { return this->Guide; }
  // Slot k of a pixel stands k pictures above it.
  vtkTextureObject* GetLayers() { return this->Layers; }
  vtkTextureObject* GetLayerColors() { return this->LayerColors; }

private:
  bool UpdateVolume(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateTables(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateGradientOpacity(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateSecond(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateMask(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateSurfaces(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateGuide(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);
  bool UpdateLayers(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan);

  vtkNew<vtkTextureObject> Volume;
  vtkNew<vtkTextureObject> Bricks;
  vtkNew<vtkTextureObject> Sums;
  vtkNew<vtkTextureObject> Sigma;
  vtkNew<vtkTextureObject> Colors;
  vtkNew<vtkTextureObject> ColorSums;
  vtkNew<vtkTextureObject> ColorMeans;
  vtkNew<vtkTextureObject> GradientOpacity;
  vtkNew<vtkTextureObject> Second;
  vtkNew<vtkTextureObject> Keep[CHI_PLAN_GRIDS];
  vtkNew<vtkTextureObject> Labels;
  vtkNew<vtkTextureObject> Surface;
  vtkNew<vtkTextureObject> SurfaceMore;
  vtkNew<vtkTextureObject> Guide;
  vtkNew<vtkTextureObject> Layers;
  vtkNew<vtkTextureObject> LayerColors;
  std::uint64_t VolumeVersion = 0;
  std::uint64_t TableVersion = 0;
  std::uint64_t GradientVersion = 0;
  std::uint64_t SecondVersion = 0;
  std::uint64_t MaskVersion = 0;
  std::uint64_t FrameVersion = 0;
};

#endif
