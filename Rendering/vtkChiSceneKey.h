// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiSceneKey_h
#define vtkChiSceneKey_h

#include "vtkChiCameraView.h"

#include <cstdint>
#include <vector>

class vtkProp;
class vtkRenderer;

// Everything that the picture of these props depends on, but for its size: two that are alike mean
// that nothing needs to be drawn again.
std::vector<std::uint64_t> vtkChiSceneKey(
  vtkRenderer* renderer, const vtkChiCameraView& camera, const std::vector<vtkProp*>& drawn);

#endif
