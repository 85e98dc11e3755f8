// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiMaskInput_h
#define vtkChiMaskInput_h

#include <chiaroscuro/chi_mask.h>

#include <string>

class vtkAbstractVolumeMapper;
class vtkVolume;

// What is left of a volume mapper's input, for the C core: cropping regions.
class vtkChiMaskInput
{
public:
  // A plane a x + b y + c z + d >= 0 of the space that `toWorld` carries to world space (null:
  // world space itself), in the space that the core calls world, which `world` carries world space
  // to.
  static void PlacePlane(
    const double plane[4], const double* toWorld, const double* world, double placed[4]);

  // False where what is left is not known: GetProblem says why.
  bool Collect(vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world);

  // Null: all of it. The inner box alone is left to clip planes, see vtkChiVolumeInput.
  const chi_crop_view* GetCrop() const { return this->HasCrop ? &this->Crop : nullptr; }
  const std::string& GetProblem() const { return this->Problem; }

private:
  chi_crop_view Crop = {};
  bool HasCrop = false;
  std::string Problem;
};

#endif
