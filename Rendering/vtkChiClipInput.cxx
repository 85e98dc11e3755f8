// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiClipInput.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkAbstractVolumeMapper.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"

#include <algorithm>
#include <cmath>

//------------------------------------------------------------------------------
void vtkChiClipInput::PlacePlane(
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
void vtkChiClipInput::Add(const double plane[4], const double* toWorld, const double* world)
{
  double placed[4];
  PlacePlane(plane, toWorld, world, placed);
  this->Planes.insert(this->Planes.end(), placed, placed + 4);
}

//------------------------------------------------------------------------------
bool vtkChiClipInput::Collect(
  vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world)
{
  this->Planes.clear();
  this->Problem.clear();
  this->Limit.clear();
  vtkPlaneCollection* planes = mapper->GetClippingPlanes();
  vtkCollectionSimpleIterator cookie;
  if (planes)
  {
    planes->InitTraversal(cookie);
    while (vtkPlane* plane = planes->GetNextPlane(cookie))
    {
      const double* normal = plane->GetNormal();
      const double equation[4] = { normal[0], normal[1], normal[2],
        -vtkMath::Dot(normal, plane->GetOrigin()) };
      if (!(vtkMath::Norm(normal) > 0.0) || !std::isfinite(equation[3]))
      {
        this->Problem = "a clipping plane has no normal, or is not finite: nothing to draw";
        return false;
      }
      this->Add(equation, nullptr, world);
    }
  }
  vtkVolumeMapper* cropped = vtkVolumeMapper::SafeDownCast(mapper);
  // other regions than the inner box are not convex: vtkChiMaskInput has them
  if (cropped && cropped->GetCropping() && cropped->GetCroppingRegionFlags() == VTK_CROP_SUBVOLUME)
  {
    for (int k = 0; k < 6; ++k)
    {
      const double sign = k & 1 ? -1.0 : 1.0;
      double equation[4] = { 0.0, 0.0, 0.0, -sign * cropped->GetCroppingRegionPlanes()[k] };
      equation[k / 2] = sign;
      this->Add(equation, volume->GetMatrix()->GetData(), world);
    }
  }
  if (this->Planes.size() > 4 * CHI_MAX_CLIP_PLANES)
  {
    this->Limit = "more than " + std::to_string(CHI_MAX_CLIP_PLANES) +
      " clipping planes, the cropping box's included, are not supported: the others cut nothing";
    this->Planes.resize(4 * CHI_MAX_CLIP_PLANES);
  }
  return true;
}
