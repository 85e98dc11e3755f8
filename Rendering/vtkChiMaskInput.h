// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiMaskInput_h
#define vtkChiMaskInput_h

#include <chiaroscuro/chi_mask.h>

#include <chiaroscuro/chi_volume.h>

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkDataSet;
class vtkImageData;
class vtkVolume;

// What is left of a volume mapper's input, for the C core: cropping regions, a mask, and what the
// ghost arrays of points and cells hide.
class vtkChiMaskInput
{
public:
  // False where what is left is not known: GetProblem says why. `samples` is what the core gets of
  // the input; `mask` may be null.
  bool CollectCrop(vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world);
  // `tables`: of the labels that the mask's values are; null where they are a binary mask.
  bool CollectMask(vtkDataSet* input, const chi_volume_view& samples, vtkImageData* mask,
    const std::vector<std::uint8_t>* tables);

  // Null: all of it. The inner box alone is left to clip planes, see vtkChiVolumeInput.
  const chi_crop_view* GetCrop() const { return this->HasCrop ? &this->Crop : nullptr; }
  // Null: nothing is masked.
  const chi_mask_view* GetMask() const { return this->HasMask ? &this->Mask : nullptr; }
  const std::string& GetProblem() const { return this->Problem; }
  const std::vector<std::string>& GetLimits() const { return this->Limits; }

private:
  bool CollectValues(const chi_volume_view& samples, vtkImageData* mask);
  void CollectFlags(vtkDataSet* input);

  chi_crop_view Crop = {};
  bool HasCrop = false;
  chi_mask_view Mask = {};
  bool HasMask = false;
  vtkSmartPointer<vtkDataArray> Found;  // the mask's array
  vtkSmartPointer<vtkDataArray> Values; // as handed to the core: the same, or a plain copy
  std::array<std::uint64_t, 2> ValuesKey = {};
  std::array<std::uint64_t, 8> MaskKey = {};
  std::vector<std::uint8_t> Tables; // by label
  std::string Problem;
  std::vector<std::string> Limits;
};

#endif
