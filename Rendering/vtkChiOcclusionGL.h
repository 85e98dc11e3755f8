// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiOcclusionGL_h
#define vtkChiOcclusionGL_h

#include "vtkChiOcclusionTextures.h"
#include "vtkChiQuadPass.h"

#include <chiaroscuro/chi_occlusion_plan.h>

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkTextureObject.h"
#include "vtkWeakPointer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkShaderProgram;

// The OpenGL engine: carries the core's plan of a frame out in fragment shaders, slab by slab, and
// leaves the picture in textures. OpenGL 3.2 core, one quad a pass.
class vtkChiOcclusionGL
{
public:
  // Why this window cannot draw this frame; empty where it can.
  static std::string WhyNot(vtkOpenGLRenderWindow* window, const chi_occlusion_frame& frame);

  // False where OpenGL refuses something; `half`: light in 16-bit floats.
  bool Render(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan, bool half);
  // Whether the textures hold the picture of this plan.
  bool Holds(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan, bool half);

  // premultiplied colour and alpha
  vtkTextureObject* GetLayer() { return this->Reduced ? this->FullLayer : this->Layer; }
  vtkTextureObject* GetVisibility()
  {
    return this->Reduced ? this->FullVisibility : this->Visibility;
  }
  bool ReadLayer(vtkOpenGLRenderWindow* window, std::vector<float>& rgba);
  // One value a pixel, or, under coloured light, red, green, blue and their mean.
  bool ReadVisibility(vtkOpenGLRenderWindow* window, std::vector<float>& visibility);
  bool IsColored() const { return this->Colored; }
  // Samples of the rectangles that were drawn, and their light updates: what shaders skip counts.
  std::int64_t GetSamples() const { return this->Samples; }
  std::int64_t GetLightUpdates() const { return this->LightUpdates; }

  void ReleaseGraphicsResources(vtkWindow* window);

private:
  using TextureList = std::vector<vtkSmartPointer<vtkTextureObject>>;
  // Light for one kind of receiver.
  struct Field
  {
    TextureList Light[3][2]; // of each channel; four directions a texture, or one for all
    TextureList Ring;        // visibility of the last slabs

    std::array<TextureList*, 7> GetLists()
    {
      return { &this->Light[0][0], &this->Light[0][1], &this->Light[1][0], &this->Light[1][1],
        &this->Light[2][0], &this->Light[2][1], &this->Ring };
    }
  };

  bool Allocate(const chi_occlusion_plan& plan, bool half);
  void Reserve(vtkTextureObject* texture, int width, int height, int components, bool half);
  void Resize(TextureList& list, std::size_t count);
  void Reserve(
    TextureList& list, std::size_t count, const chi_occlusion_plan& plan, int components);
  void Clear(const chi_occlusion_plan& plan);
  std::int64_t DrawSlabs(const chi_occlusion_plan& plan); // returns the first that was left out
  void DrawSamples(const chi_occlusion_plan& plan, std::int64_t slab);
  static std::string DefineShading(const chi_occlusion_plan& plan);
  void SetShading(vtkShaderProgram* program, const chi_occlusion_plan& plan);
  static std::string DefineCuts(const chi_occlusion_plan& plan);
  void SetCuts(vtkShaderProgram* program, const chi_occlusion_plan& plan);
  static std::string DefineComponents(const chi_occlusion_plan& plan);
  void SetComponents(vtkShaderProgram* program, const chi_occlusion_plan& plan);
  void DrawLight(const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab);
  void DrawBlur(const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab);
  bool IsAttenuated(
    const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab) const;
  bool IsBlocked(const chi_occlusion_plan& plan, int field, std::int64_t slab) const;
  void SetObstacles(vtkShaderProgram* program, const chi_occlusion_plan& plan, int field,
    int channel, std::int64_t slab);
  void DrawReceivers(const chi_occlusion_plan& plan, std::int64_t slab, bool layers);
  void DrawBeyond(const chi_occlusion_plan& plan, bool layers);
  std::string DefineReceivers(const chi_occlusion_plan& plan, bool layers) const;
  std::vector<vtkTextureObject*> ReadReceivers(bool layers, bool beyond); // returns the targets
  void DrawVicinity(const chi_occlusion_plan& plan);
  void DrawEnlarged(const chi_occlusion_plan& plan);
  void DrawLayers(const chi_occlusion_plan& plan, std::int64_t slab);
  void DrawLastLayers(const chi_occlusion_plan& plan, std::int64_t slab);
  void DrawLayers(const chi_occlusion_plan& plan, std::int64_t begin, std::int64_t end,
    const chi_rect& rect, const chi_rect& without);
  std::string DefineLayers(const chi_occlusion_plan& plan) const;
  void ReadLayers(vtkShaderProgram* program, const chi_occlusion_plan& plan, std::int64_t begin,
    std::int64_t end);
  void FinishLayers(const chi_occlusion_plan& plan);
  bool AskAlive(const chi_occlusion_plan& plan, std::int64_t slab);
  vtkTextureObject* Plane(const chi_occlusion_plan& plan, int field, std::int64_t slab);

  vtkWeakPointer<vtkRenderWindow> Window;
  vtkTimeStamp ContextTime;
  vtkMTimeType Context = 0;
  vtkChiQuadPass Pass;
  vtkChiOcclusionTextures Inputs;
  vtkNew<vtkTextureObject> Layer;
  vtkNew<vtkTextureObject> Received;   // visibility of surfaces from the light planes
  vtkNew<vtkTextureObject> Visibility; // with vicinity and strength
  vtkNew<vtkTextureObject> FullLayer;  // the same two, enlarged
  vtkNew<vtkTextureObject> FullVisibility;
  vtkNew<vtkTextureObject> Tau[2];     // of this slab and the one before
  vtkNew<vtkTextureObject> Partial[2]; // visibility of the directions so far
  // Of the layers, three slots each: the transmittance in front, and the alpha of all that is
  // there.
  TextureList LayerWeights;
  TextureList LayerLight; // visibility of each slot
  chi_rect TauDrawn[2] = {};
  Field Fields[2];
  unsigned int Query = 0;
  bool Asked = false;
  bool Half = false;
  bool Colored = false; // visibility has three colours
  bool Reduced = false; // the picture is smaller than the one that is handed out
  bool Drawn = false;
  std::uint64_t FrameVersion = 0;
  std::int64_t Samples = 0;
  std::int64_t LightUpdates = 0;
};

#endif
