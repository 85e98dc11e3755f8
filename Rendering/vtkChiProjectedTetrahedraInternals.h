// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiProjectedTetrahedraInternals_h
#define vtkChiProjectedTetrahedraInternals_h

#include "vtkChiCameraView.h"
#include "vtkChiClipInput.h"
#include "vtkChiCompositor.h"
#include "vtkChiFieldInput.h"
#include "vtkChiGridInput.h"
#include "vtkChiOcclusionFrame.h"
#include "vtkChiProjectedTetrahedraMapper.h"
#include "vtkChiSelection.h"
#include "vtkChiShadingInput.h"
#include "vtkChiTetEngine.h"

#include <chiaroscuro/chi_tet.h>

#include "vtkDataSet.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

// What the mapper keeps between and during frames, for its own source files alone.
struct vtkChiProjectedTetrahedraMapper::Internals
{
  // collected
  vtkWeakPointer<vtkDataSet> Input;
  vtkChiGridInput Grid;
  vtkChiFieldInput Field;
  vtkChiClipInput Clips;
  vtkChiShadingInput Shading;
  vtkChiCameraView Camera;
  double GridToWorld[16] = {};
  chi_tet_params Params = {};
  chi_surface_view Surface = {};
  int Viewport[4] = { 0, 0, 0, 0 };
  bool Collected = false; // all of it, for the last frame
  bool HasSurface = false;
  bool Peeling = false; // called by the depth peeling pass, several times a frame
  bool Shared = false;  // other volumes of the renderer have mappers that work together

  vtkWeakPointer<vtkChiOcclusionFrame> Frame;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkChiTetEngine Engine;
  bool Drawn = false; // the last frame has a picture
  vtkChiCompositor Compositor;
  vtkChiSelection Selection;
  std::vector<std::int64_t> FoundCells; // of the selection that is under way
  bool LastMerged = false;
  double FullSeconds = 0.0;  // what the last frame drawn would have taken at full size
  std::vector<float> Merged; // the picture fitted in between other mappers' pictures

  double FiniteBounds[6] = {}; // of the input's points that are finite
  vtkMTimeType FiniteTime = 0;

  double SecondsCollect = 0.0;
  double SecondsComposite = 0.0;
  double SecondsTotal = 0.0;
  std::set<std::string> Warnings; // each is said once
  std::set<std::string> Errors;   // and these again after a frame that went well

  // What has been collected, for the core.
  chi_tet_frame MakeFrame() const
  {
    chi_tet_frame frame = {};
    frame.struct_size = sizeof(frame);
    frame.camera = this->Camera.Get();
    frame.grid = this->Grid.GetGrid();
    frame.grid_to_world = this->GridToWorld;
    frame.field = this->Field.GetField();
    frame.transfer = this->Field.GetTransfer();
    frame.surface = this->HasSurface ? &this->Surface : nullptr;
    frame.params = &this->Params;
    frame.shading = this->Shading.GetShading();
    frame.clip_planes = this->Clips.GetPlanes().data();
    frame.clip_plane_count = this->Clips.GetPlanes().size() / 4;
    return frame;
  }
};

#endif
