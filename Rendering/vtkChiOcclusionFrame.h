// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiOcclusionFrame_h
#define vtkChiOcclusionFrame_h

#include "vtkChiGeometryBuffer.h"
#include "vtkChiTranslucentLayers.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkObject.h"
#include "vtkWeakPointer.h"

#include <cstddef>
#include <vector>

class vtkInformationObjectBaseKey;
class vtkRenderer;
class vtkVolume;

// What the mappers of one renderer share: its opaque geometry, and which of them have drawn in the
// frame that is under way. Some shade the geometry (vtkChiCombinedOcclusionVolumeMapper), others
// only end at it. Hung into the renderer's information, so that it lives as long.
class vtkChiOcclusionFrame : public vtkObject
{
public:
  static vtkChiOcclusionFrame* New();
  vtkTypeMacro(vtkChiOcclusionFrame, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  static vtkInformationObjectBaseKey* FRAME();

  // Visible volumes of a renderer whose mapper is of one of these classes; of those that shade
  // geometry alone.
  static int CountVolumes(vtkRenderer* renderer, bool shading);

  // The one of this renderer, made at the first call.
  static vtkChiOcclusionFrame* Get(vtkRenderer* renderer);

  vtkChiGeometryBuffer* GetGeometry() { return &this->Geometry; }

  // Whether this volume has been drawn since the renderer began the frame.
  bool HasDrawn(vtkVolume* volume) const;
  int GetNumberOfLayers() const { return static_cast<int>(this->Layers.size()); }
  int GetNumberOfShadingLayers() const;
  // Whether the renderer draws opaque geometry by itself, plainly.
  bool IsStock() const;
  // Whether nobody has shaded the geometry yet.
  bool IsFirst() const { return this->GetNumberOfShadingLayers() == 0; }
  // A volume is drawn twice in a frame only where someone renders without the renderer's event.
  void Forget() { this->Layers.clear(); }
  // Observers of the renderer.
  void BeginFrame();
  void EndFrame();

  // The translucent geometry, hidden while a frame of the renderer is drawn. It cannot be hidden in
  // the frame in which the first mapper comes to be known, nor need it be where no mapper draws;
  // then the frame is drawn once more.
  vtkChiTranslucentLayers* GetTranslucent() { return &this->Translucent; }

  // Where a volume lies: a box, carried to the core's world by a row-major matrix.
  struct Box
  {
    double ToWorld[16];
    double Low[3];
    double High[3];
  };
  static Box GetBoxOf(const chi_volume_view& samples);

  // Keep a picture for those that are still to come, where `box` is not null; where nobody will ask
  // for it, or there is geometry alone, the fact is kept. A picture without visibility leaves the
  // geometry as it is.
  void AddLayer(vtkVolume* volume, const chi_camera* camera, const Box* box,
    const chi_occlusion_image* image, bool shading);

  // Whether the geometry's colours come from several samples a pixel. Then the renderer's own
  // drawing of them is hidden, from the next frame on, or from this one, drawn once more.
  void SetMultiSample(bool on) { this->MultiSample = on; }
  // The same buffer for a mapper that only ends at the geometry: drawn as those that shade it have
  // it drawn, so that it is not drawn twice.
  const chi_surface_view* UpdateGeometry(const vtkChiCameraView& camera, int width, int height);

  // What the last layer must write so that it comes to lie between the earlier ones, some of which
  // are in front of it: premultiplied colour, and the layer's own alpha.
  // `specular`, [height x width x 4] or empty: what of the opaque geometry's light occlusion does
  // not take.
  void MergeLastLayer(std::vector<float>& rgba, const std::vector<float>& specular) const;

protected:
  vtkChiOcclusionFrame() = default;
  ~vtkChiOcclusionFrame() override = default;

private:
  vtkChiOcclusionFrame(const vtkChiOcclusionFrame&) = delete;
  void operator=(const vtkChiOcclusionFrame&) = delete;

  struct Layer
  {
    vtkVolume* Volume = nullptr;   // compared, never used
    bool Shading = false;          // of the geometry
    std::vector<float> Rgba;       // empty: nothing but geometry, or not kept
    std::vector<float> Visibility; // one value a pixel, or three, or none: 1
    chi_camera Camera = {};
    double EyeToBox[16] = {};
    Box Place = {};

    double EntryDepth(double x, double y) const;
  };

  void MergeRow(int row, std::vector<float>& rgba, const std::vector<float>& specular) const;

  bool WillDraw(bool shading) const;

  vtkWeakPointer<vtkRenderer> Scene;
  vtkChiGeometryBuffer Geometry;
  vtkChiTranslucentLayers Translucent;
  bool MultiSample = false;
  bool Missed = false;                 // props were hidden, and no mapper drew
  bool DrewLast[2] = { false, false }; // a mapper drew in the last frame; one that shades
  bool Again = false;                  // this frame is drawn for the second time
  std::vector<Layer> Layers;
};

#endif
