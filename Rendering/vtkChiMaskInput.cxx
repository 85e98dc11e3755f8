// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiMaskInput.h"

#include "vtkAbstractVolumeMapper.h"
#include "vtkMatrix4x4.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"

#include <algorithm>
#include <cmath>

//------------------------------------------------------------------------------
void vtkChiMaskInput::PlacePlane(
  const double plane[4], const double* toWorld, const double* world, double placed[4])
{
  double matrix[16];
  std::copy(world, world + 16, matrix);
  if (toWorld)
  {
    vtkMatrix4x4::Multiply4x4(world, toWorld, matrix);
  }
  // planes go with the inverse: plane . M^-1 . (M x) = plane . x
  double inverse[16];
  vtkMatrix4x4::Invert(matrix, inverse);
  for (int column = 0; column < 4; ++column)
  {
    placed[column] = 0.0;
    for (int row = 0; row < 4; ++row)
    {
      placed[column] += plane[row] * inverse[4 * row + column];
    }
  }
}

//------------------------------------------------------------------------------
bool vtkChiMaskInput::Collect(
  vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world)
{
  this->Problem.clear();
  this->HasCrop = false;
  vtkVolumeMapper* cropped = vtkVolumeMapper::SafeDownCast(mapper);
  if (!cropped || !cropped->GetCropping())
  {
    return true;
  }
  const double* planes = cropped->GetCroppingRegionPlanes();
  if (!std::all_of(planes, planes + 6, [](double x) { return std::isfinite(x); }))
  {
    this->Problem = "a cropping region plane (vtkVolumeMapper) is not finite: nothing to draw";
    return false;
  }
  if (cropped->GetCroppingRegionFlags() == VTK_CROP_SUBVOLUME)
  {
    return true;
  }
  this->Crop.struct_size = sizeof(this->Crop);
  this->Crop.regions = static_cast<std::uint32_t>(cropped->GetCroppingRegionFlags());
  for (int k = 0; k < 6; ++k)
  {
    double equation[4] = { 0.0, 0.0, 0.0, -planes[k] };
    equation[k / 2] = 1.0;
    vtkChiMaskInput::PlacePlane(
      equation, volume->GetMatrix()->GetData(), world, this->Crop.planes[k]);
  }
  this->HasCrop = true;
  return true;
}
