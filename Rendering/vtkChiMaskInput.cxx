// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiMaskInput.h"
#include "vtkChiClipInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiViews.h"

#include "vtkAbstractVolumeMapper.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"

#include <algorithm>
#include <cmath>

namespace
{
std::string describe(const std::size_t dimensions[3])
{
  return std::to_string(dimensions[0]) + " x " + std::to_string(dimensions[1]) + " x " +
    std::to_string(dimensions[2]);
}

bool matches(const int points[3], int less, const std::size_t dimensions[3])
{
  bool same = true;
  for (int axis = 0; axis < 3; ++axis)
  {
    same = same && points[axis] > less &&
      static_cast<std::size_t>(points[axis] - less) == dimensions[axis];
  }
  return same;
}
}

//------------------------------------------------------------------------------
bool vtkChiMaskInput::CollectCrop(
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
    vtkChiClipInput::PlacePlane(
      equation, volume->GetMatrix()->GetData(), world, this->Crop.planes[k]);
  }
  this->HasCrop = true;
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiMaskInput::CollectMask(vtkDataSet* input, const chi_volume_view& samples,
  vtkImageData* mask, const std::vector<std::uint8_t>* tables)
{
  this->Problem.clear();
  this->Limits.clear();
  const std::uint64_t version = this->Mask.version;
  this->Mask = {};
  this->Mask.struct_size = sizeof(this->Mask);
  this->Mask.version = version;
  if (mask && !this->CollectValues(samples, mask))
  {
    this->HasMask = false;
    return false;
  }
  this->CollectFlags(input);
  this->HasMask = this->Mask.values || this->Mask.point_flags || this->Mask.cell_flags;
  if (this->HasMask && !vtkImageData::SafeDownCast(input))
  {
    this->Limits.emplace_back(std::string("masks and blanking of a ") + input->GetClassName() +
      " are not supported yet: its samples are interpolated, all are drawn");
    this->HasMask = false;
  }
  const std::array<std::uint64_t, 8> key = { vtkChiBits(this->Mask.values), this->ValuesKey[1],
    vtkChiBits(this->Mask.point_flags), vtkChiBits(this->Mask.cell_flags),
    this->Mask.point_flags ? input->GetPointGhostArray()->GetMTime() : 0,
    this->Mask.cell_flags ? input->GetCellGhostArray()->GetMTime() : 0,
    this->HasMask ? input->GetMTime() : 0, mask ? mask->GetMTime() : 0 };
  const std::vector<std::uint8_t> labels = tables && mask ? *tables : std::vector<std::uint8_t>();
  if (key != this->MaskKey || labels != this->Tables)
  {
    this->MaskKey = key;
    this->Tables = labels;
    ++this->Mask.version;
  }
  this->Mask.table_of_value = this->Tables.empty() ? nullptr : this->Tables.data();
  this->Mask.value_count = this->Tables.size();
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiMaskInput::CollectValues(const chi_volume_view& samples, vtkImageData* mask)
{
  int points[3];
  mask->GetDimensions(points);
  // a value a sample: of the mask's points, or, where the samples are those of cells, of its cells
  vtkDataArray* array = mask->GetPointData()->GetScalars();
  int less = 0;
  if (samples.is_cell_data && (!array || !matches(points, 0, samples.dimensions)))
  {
    array = mask->GetCellData()->GetScalars();
    less = 1;
  }
  if (!array)
  {
    this->Problem = "the mask (SetMaskInput) has no scalars: nothing to draw";
    return false;
  }
  const std::size_t count = samples.dimensions[0] * samples.dimensions[1] * samples.dimensions[2];
  if (!matches(points, less, samples.dimensions) ||
    static_cast<std::size_t>(array->GetNumberOfTuples()) < count ||
    array->GetNumberOfComponents() < 1)
  {
    const std::size_t own[3] = { static_cast<std::size_t>(points[0]),
      static_cast<std::size_t>(points[1]), static_cast<std::size_t>(points[2]) };
    this->Problem = "the mask (SetMaskInput) of " + describe(own) + " points and " +
      std::to_string(array->GetNumberOfTuples()) + " values does not fit the input of " +
      describe(samples.dimensions) + (samples.is_cell_data ? " cells" : " points") +
      ": nothing to draw";
    return false;
  }
  const std::array<std::uint64_t, 2> key = { vtkChiBits(array), array->GetMTime() };
  if (key != this->ValuesKey || this->Found != array || !this->Values)
  {
    this->Found = array;
    this->Values = array;
    if (array->GetDataType() == VTK_BIT)
    {
      this->Values = vtkSmartPointer<vtkUnsignedCharArray>::New();
      this->Values->DeepCopy(array);
    }
    else if (!array->HasStandardMemoryLayout())
    {
      this->Values.TakeReference(vtkDataArray::CreateDataArray(array->GetDataType()));
      this->Values->DeepCopy(array);
    }
    this->ValuesKey = key;
  }
  this->Mask.type = vtkChiType(this->Values->GetDataType());
  if (this->Mask.type == 0)
  {
    this->Problem =
      std::string("the mask (SetMaskInput) has values of a type that cannot be read, ") +
      array->GetDataTypeAsString() + ": nothing to draw";
    return false;
  }
  this->Mask.values = this->Values->GetVoidPointer(0);
  this->Mask.stride = static_cast<std::size_t>(this->Values->GetNumberOfComponents()) *
    static_cast<std::size_t>(this->Values->GetDataTypeSize());
  return true;
}

//------------------------------------------------------------------------------
// As vtkImageData::IsCellVisible does, a hidden point hides its cells; cells that other processes
// own are drawn by these, and those that finer cells replace by the finer ones.
void vtkChiMaskInput::CollectFlags(vtkDataSet* input)
{
  vtkUnsignedCharArray* points = input->GetPointGhostArray();
  vtkUnsignedCharArray* cells = input->GetCellGhostArray();
  if (points && points->GetNumberOfValues() >= input->GetNumberOfPoints())
  {
    this->Mask.point_flags = points->GetPointer(0);
    this->Mask.point_bits = vtkDataSetAttributes::HIDDENPOINT;
  }
  if (cells && cells->GetNumberOfValues() >= input->GetNumberOfCells())
  {
    this->Mask.cell_flags = cells->GetPointer(0);
    this->Mask.cell_bits = vtkDataSetAttributes::HIDDENCELL | vtkDataSetAttributes::REFINEDCELL |
      vtkDataSetAttributes::DUPLICATECELL;
  }
}
