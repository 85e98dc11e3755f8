// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiCombinedOcclusionInternals_h
#define vtkChiCombinedOcclusionInternals_h

#include "vtkChiCameraView.h"
#include "vtkChiCombinedOcclusionVolumeMapper.h"
#include "vtkChiCompositor.h"
#include "vtkChiLabelInput.h"
#include "vtkChiMaskInput.h"
#include "vtkChiOcclusionEngine.h"
#include "vtkChiOcclusionFrame.h"
#include "vtkChiQuality.h"
#include "vtkChiSelection.h"
#include "vtkChiVolumeInput.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkImageData.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

#include <set>
#include <string>
#include <vector>

// What the mapper keeps between and during frames, for its own source files alone.
struct vtkChiCombinedOcclusionVolumeMapper::Internals
{
  // collected
  vtkChiVolumeInput Input;
  vtkChiMaskInput Masks;
  vtkChiLabelInput Labels;
  bool HasLabels = false;
  vtkSmartPointer<vtkImageData> MaskInput;
  vtkChiCameraView Camera;
  chi_occlusion_params Params = {};
  int Viewport[4] = { 0, 0, 0, 0 };
  double Diagonal = 0.0; // of the volume, in view or not; 0 without one
  bool HasVolume = false;
  bool HasSurface = false;
  bool Peeling = false;     // called by the depth peeling pass, several times a frame
  bool First = false;       // of the mappers of this class in this frame
  bool Interactive = false; // the frame shall be fast rather than good
  bool Shared = false;      // other volumes of the renderer have mappers of this class

  vtkWeakPointer<vtkChiOcclusionFrame> Frame;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkWeakPointer<vtkRenderer> Scene;
  vtkChiOcclusionEngine Engine;
  chi_occlusion_image Image = {}; // without floats while it lies in textures: see ReadImage
  chi_occlusion_stats Stats = {};

  vtkChiCompositor Compositor;
  vtkChiSelection Selection;
  vtkChiQuality Quality;
  vtkChiQuality::Settings Used; // of the last frame
  double UsedSampleDistance = 0.0;
  bool LastMerged = false;
  std::vector<float> Merged; // the picture fitted in between other mappers' pictures

  double SecondsCollect = 0.0;
  double SecondsComposite = 0.0;
  double SecondsTotal = 0.0;
  std::set<std::string> Warnings; // each is said once
  std::set<std::string> Errors;   // and these again after a frame that went well

  // What has been collected, for the core; opaque geometry is up to the caller.
  chi_occlusion_frame MakeFrame()
  {
    chi_occlusion_frame frame = {};
    frame.struct_size = sizeof(frame);
    frame.camera = this->Camera.Get();
    frame.volume = this->HasVolume ? this->Input.GetVolume() : nullptr;
    frame.transfer = !this->HasVolume ? nullptr
      : this->HasLabels               ? this->Labels.GetTransfer()
                                      : this->Input.GetTransfer();
    frame.params = &this->Params;
    frame.clip_planes = this->Input.GetClipPlanes().data();
    frame.clip_plane_count = this->HasVolume ? this->Input.GetClipPlanes().size() / 4 : 0;
    frame.crop = this->HasVolume ? this->Masks.GetCrop() : nullptr;
    frame.mask = this->HasVolume ? this->Masks.GetMask() : nullptr;
    frame.components = this->HasVolume ? this->Input.GetComponents() : nullptr;
    frame.shading =
      this->HasVolume && !frame.components ? this->Input.GetShading()->GetShading() : nullptr;
    return frame;
  }

  // Has the floats of Image, where there is a picture and its window still exists.
  bool ReadImage()
  {
    if (this->Image.width > 0 && !this->Image.rgba && this->Engine.ReadImage())
    {
      this->Image = this->Engine.GetImage();
    }
    return this->Image.rgba != nullptr;
  }
};

#endif
