// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiCombinedOcclusionInternals_h
#define vtkChiCombinedOcclusionInternals_h

#include "vtkChiCameraView.h"
#include "vtkChiCombinedOcclusionVolumeMapper.h"
#include "vtkChiCompositor.h"
#include "vtkChiMaskInput.h"
#include "vtkChiOcclusionFrame.h"
#include "vtkChiVolumeInput.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
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
  vtkChiCameraView Camera;
  chi_occlusion_params Params = {};
  int Viewport[4] = { 0, 0, 0, 0 };
  double Diagonal = 0.0; // of the volume, in view or not; 0 without one
  bool HasVolume = false;
  bool HasSurface = false;
  bool Peeling = false; // called by the depth peeling pass, several times a frame
  bool First = false;   // of the mappers of this class in this frame
  bool Shared = false;  // other volumes of the renderer have mappers of this class

  vtkWeakPointer<vtkChiOcclusionFrame> Frame;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkWeakPointer<vtkRenderer> Scene;
  chi_occlusion* Renderer = nullptr;
  chi_occlusion_image Image = {};
  chi_occlusion_stats Stats = {};

  vtkChiCompositor Compositor;
  bool LastMerged = false;
  std::vector<float> Merged; // the picture fitted in between other mappers' pictures

  double SecondsCollect = 0.0;
  double SecondsComposite = 0.0;
  double SecondsTotal = 0.0;
  std::set<std::string> Warnings; // each is said once
  std::set<std::string> Errors;   // and these again after a frame that went well
};

#endif
