// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiVolumeInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiViews.h"

#include "vtkAbstractMapper.h"
#include "vtkAbstractVolumeMapper.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace
{
void multiply(const double* a, const double* b, double* product)
{
  double result[16];
  vtkMatrix4x4::Multiply4x4(a, b, result);
  std::copy(result, result + 16, product);
}
}

//------------------------------------------------------------------------------
bool vtkChiVolumeInput::Collect(vtkAbstractVolumeMapper* mapper, vtkDataSet* input, int scalarMode,
  vtkVolume* volume, const double* world)
{
  this->Problem.clear();
  this->Limits.clear();
  this->Empty = !input || input->GetNumberOfPoints() == 0;
  if (this->Empty)
  {
    return false;
  }
  vtkMTimeType time = input->GetMTime();
  vtkImageData* image = vtkImageData::SafeDownCast(input);
  if (vtkRectilinearGrid* grid = vtkRectilinearGrid::SafeDownCast(input))
  {
    image = this->Resample(mapper, grid, scalarMode);
    scalarMode = VTK_SCALAR_MODE_DEFAULT; // the new image has no other array
    this->Limits.emplace_back(
      "vtkRectilinearGrid is not supported yet: its samples are interpolated "
      "onto evenly spaced ones");
  }
  if (!image)
  {
    if (this->Problem.empty())
    {
      this->Problem =
        std::string("an input of class ") + input->GetClassName() + " is not a vtkImageData";
    }
    return false;
  }
  return this->CollectSamples(mapper, image, time, scalarMode) &&
    this->CollectMatrix(image, volume, world) &&
    this->CollectTransfer(volume->GetProperty(), image, time) &&
    this->CollectClips(mapper, volume, world);
}

//------------------------------------------------------------------------------
vtkDataArray* vtkChiVolumeInput::Find(
  vtkAbstractVolumeMapper* mapper, vtkDataSet* data, int scalarMode, int& isCell)
{
  return vtkAbstractMapper::GetScalars(data, scalarMode, mapper->GetArrayAccessMode(),
    mapper->GetArrayId(), mapper->GetArrayName(), isCell);
}

//------------------------------------------------------------------------------
bool vtkChiVolumeInput::CollectSamples(
  vtkAbstractVolumeMapper* mapper, vtkImageData* image, vtkMTimeType time, int scalarMode)
{
  int isCell = 0;
  vtkDataArray* scalars = this->Find(mapper, image, scalarMode, isCell);
  if (!scalars)
  {
    const char* name = mapper->GetArrayName();
    const bool byName = scalarMode == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA ||
      scalarMode == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
    this->Problem = std::string("the input (") + image->GetClassName() + ") has no " +
      (byName ? std::string("array '") + (name ? name : "(by index)") + "'"
              : std::string("scalars")) +
      " for scalar mode " + mapper->GetScalarModeAsString();
    return false;
  }

  int dimensions[3];
  image->GetDimensions(dimensions);
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (isCell)
    {
      dimensions[axis] = std::max(dimensions[axis] - 1, 0);
    }
    this->Volume.dimensions[axis] = static_cast<std::size_t>(dimensions[axis]);
    count *= this->Volume.dimensions[axis];
  }
  // Samples of points span a volume only from two along each axis; a cell is one by itself.
  if (std::min({ dimensions[0], dimensions[1], dimensions[2] }) < (isCell ? 1 : 2))
  {
    int points[3];
    image->GetDimensions(points);
    this->Problem = "an image of " + std::to_string(points[0]) + " x " + std::to_string(points[1]) +
      " x " + std::to_string(points[2]) + " points encloses no volume: nothing to draw of " +
      vtkChiDescribe(scalars);
    return false;
  }
  if (static_cast<std::size_t>(scalars->GetNumberOfTuples()) < count)
  {
    this->Problem = vtkChiDescribe(scalars) + " is too short: the image has " +
      std::to_string(count) + (isCell ? " cells" : " points");
    return false;
  }
  if (scalars->GetNumberOfComponents() < 1)
  {
    this->Problem = vtkChiDescribe(scalars) + " has no components";
    return false;
  }

  const std::array<std::uint64_t, 4> key = { vtkChiBits(scalars), scalars->GetMTime(), time,
    static_cast<std::uint64_t>(isCell) };
  if (key != this->SamplesKey || this->Scalars != scalars || !this->Samples)
  {
    this->Scalars = scalars;
    this->Samples = scalars;
    if (scalars->GetDataType() == VTK_BIT)
    {
      this->Samples = vtkSmartPointer<vtkUnsignedCharArray>::New();
      this->Samples->DeepCopy(scalars);
    }
    else if (!scalars->HasStandardMemoryLayout())
    {
      this->Samples.TakeReference(vtkDataArray::CreateDataArray(scalars->GetDataType()));
      this->Samples->DeepCopy(scalars);
    }
    this->SamplesKey = key;
    ++this->Volume.version;
  }
  this->Volume.type = vtkChiType(this->Samples->GetDataType());
  if (this->Volume.type == 0)
  {
    this->Problem = vtkChiDescribe(scalars) + " has a type that cannot be drawn";
    return false;
  }
  this->Volume.struct_size = sizeof(chi_volume_view);
  this->Volume.scalars = this->Samples->GetVoidPointer(0);
  this->Volume.stride = static_cast<std::size_t>(this->Samples->GetNumberOfComponents()) *
    static_cast<std::size_t>(this->Samples->GetDataTypeSize());
  this->Volume.is_cell_data = isCell;
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiVolumeInput::CollectMatrix(vtkImageData* image, vtkVolume* volume, const double* world)
{
  int extent[6];
  image->GetExtent(extent);
  // sample (0, 0, 0) is the first point of the extent, or the centre of its first cell
  const double centre = this->Volume.is_cell_data ? 0.5 : 0.0;
  double first[16];
  vtkMatrix4x4::Identity(first);
  for (int axis = 0; axis < 3; ++axis)
  {
    first[4 * axis + 3] = extent[2 * axis] + centre;
  }
  double* matrix = this->Volume.index_to_world;
  const double* physical = image->GetIndexToPhysicalMatrix()->GetData();
  multiply(physical, first, matrix);
  multiply(volume->GetMatrix()->GetData(), matrix, matrix);
  multiply(world, matrix, matrix);

  double columns = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    columns *= std::sqrt(matrix[axis] * matrix[axis] + matrix[4 + axis] * matrix[4 + axis] +
      matrix[8 + axis] * matrix[8 + axis]);
  }
  const double determinant = vtkMatrix4x4::Determinant(matrix);
  // relative to the box that the spacings would span; the bound is rounding of a product of three
  if (!std::isfinite(determinant) || !(std::abs(determinant) > 1e-14 * columns))
  {
    this->Problem =
      "the matrix of the vtkVolume times spacing and direction of the input is singular or "
      "not finite: nothing to draw";
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiVolumeInput::CollectClips(
  vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world)
{
  const bool good = this->Clips.Collect(mapper, volume, world);
  this->Problem = this->Clips.GetProblem();
  if (!this->Clips.GetLimit().empty())
  {
    this->Limits.push_back(this->Clips.GetLimit());
  }
  return good;
}

//------------------------------------------------------------------------------
void vtkChiVolumeInput::AddPlaneLimit()
{
  if (!this->Shading.GetPlane()->GetProblem().empty())
  {
    this->Limits.push_back(this->Shading.GetPlane()->GetProblem());
  }
}

//------------------------------------------------------------------------------
// The array along the second axis of a two-dimensional transfer function; null for the gradient.
vtkDataArray* vtkChiVolumeInput::FindSecond(vtkVolumeProperty* property, vtkImageData* image)
{
  if (this->SecondName.empty() || this->Shading.GetPlane()->GetTime(property) == 0)
  {
    return nullptr;
  }
  vtkDataSetAttributes* data = this->Volume.is_cell_data
    ? static_cast<vtkDataSetAttributes*>(image->GetCellData())
    : static_cast<vtkDataSetAttributes*>(image->GetPointData());
  vtkDataArray* second = data->GetArray(this->SecondName.c_str());
  const std::size_t* n = this->Volume.dimensions;
  if (!second || static_cast<std::size_t>(second->GetNumberOfTuples()) < n[0] * n[1] * n[2])
  {
    this->Limits.push_back("the array '" + this->SecondName +
      "' of the two-dimensional transfer function's y axis is not there, or too short: the "
      "gradient is used");
    return nullptr;
  }
  return second;
}

//------------------------------------------------------------------------------
// How many components are drawn. VTK knows up to four independent ones, and two or four dependent.
int vtkChiVolumeInput::CountComponents(vtkVolumeProperty* property)
{
  const int there = this->Samples->GetNumberOfComponents();
  if (there == 1)
  {
    return 1;
  }
  if (!property->GetIndependentComponents() && there != 2 && there != 4)
  {
    this->Limits.push_back("dependent components (vtkVolumeProperty) must be 2 or 4: only the "
                           "first is drawn of " +
      vtkChiDescribe(this->Scalars));
    return 1;
  }
  if (there > CHI_MAX_COMPONENTS)
  {
    this->Limits.push_back(
      "more than four components are not supported: the first four are drawn of " +
      vtkChiDescribe(this->Scalars));
  }
  if (property->GetShade(0) || vtkChiShadingInput::GetGradientOpacityTime(property) != 0 ||
    this->Shading.GetPlane()->GetTime(property) != 0)
  {
    this->Limits.emplace_back("shading by gradients, gradient opacity and two-dimensional transfer "
                              "functions are not supported yet for several components: they are "
                              "drawn without");
  }
  return std::min(there, static_cast<int>(CHI_MAX_COMPONENTS));
}

//------------------------------------------------------------------------------
bool vtkChiVolumeInput::CollectTransfer(
  vtkVolumeProperty* property, vtkImageData* image, vtkMTimeType time)
{
  this->Volume.interpolation =
    property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION ? CHI_NEAREST : CHI_LINEAR;
  if (property->GetInterpolationType() > VTK_LINEAR_INTERPOLATION)
  {
    this->Limits.emplace_back(
      "cubic interpolation (vtkVolumeProperty) is not supported yet: linear is used");
  }
  vtkDataArray* second = this->FindSecond(property, image);
  const int count = this->CountComponents(property);
  const bool dependent = count > 1 && !property->GetIndependentComponents();
  const int own = dependent ? count - 1 : 0;
  // as vtkGPUVolumeRayCastMapper does: of dependent components, the unit of the last one
  const bool changed =
    this->Functions[0].Collect(property, 0, own, this->Samples, own, this->Volume.version, time);
  std::vector<std::string> limits = { this->Functions[0].GetLimit() };
  const std::array<std::uint64_t, 5> key = { vtkChiShadingInput::GetGradientOpacityTime(property),
    this->Shading.GetPlane()->GetTime(property), vtkChiBits(second),
    second ? second->GetMTime() : 0, static_cast<std::uint64_t>(count) };
  if (changed || key != this->ShadingKey)
  {
    const std::uint64_t version = this->Transfer.version;
    this->Transfer = *this->Functions[0].GetTransfer();
    this->Transfer.version = version + 1;
    this->ShadingKey = key;
    if (count == 1)
    {
      this->Shading.CollectGradientOpacity(property, this->Samples, &this->Transfer);
      this->Shading.GetPlane()->Collect(property, this->Samples, 0, second, &this->Transfer);
      if (second && this->Transfer.plane)
      {
        this->Shading.GetPlane()->CollectSecond(second, &this->Transfer);
      }
    }
  }
  if (count == 1)
  {
    this->AddPlaneLimit();
  }
  this->Components = {};
  this->Components.struct_size = sizeof(chi_components);
  this->Components.count = count;
  this->Components.dependent = dependent ? 1 : 0;
  this->Components.weight[0] = property->GetComponentWeight(0);
  for (int k = 1; k < count; ++k)
  {
    this->Components.weight[k] = property->GetComponentWeight(k);
    if (dependent && count == 4)
    {
      continue; // red, green and blue as they are
    }
    vtkChiTransferInput& functions = this->Functions[static_cast<std::size_t>(k)];
    const int component = dependent ? 0 : k;
    functions.Collect(
      property, component, component, this->Samples, component, this->Volume.version, time);
    this->Components.transfer[k - 1] = functions.GetTransfer();
    limits.push_back(functions.GetLimit());
  }
  std::copy_if(limits.begin(), limits.end(), std::back_inserter(this->Limits),
    [](const std::string& limit) { return !limit.empty(); });
  return true;
}

//------------------------------------------------------------------------------
// Trilinear interpolation onto as many evenly spaced samples over the same bounds. Scalars of cells
// are taken to the points first, as half a sample at the border has no place in an image.
vtkImageData* vtkChiVolumeInput::Resample(
  vtkAbstractVolumeMapper* mapper, vtkRectilinearGrid* grid, int scalarMode)
{
  int isCell = 0;
  vtkDataArray* scalars = this->Find(mapper, grid, scalarMode, isCell);
  int dimensions[3];
  grid->GetDimensions(dimensions);
  if (!scalars || std::min({ dimensions[0], dimensions[1], dimensions[2] }) < 2)
  {
    this->Problem = scalars ? "a vtkRectilinearGrid without thickness encloses no volume"
                            : "the input (vtkRectilinearGrid) has no scalars for scalar mode " +
        std::string(mapper->GetScalarModeAsString());
    return nullptr;
  }
  const std::array<std::uint64_t, 2> key = { vtkChiBits(scalars), grid->GetMTime() };
  if (this->Resampled && key == this->ResampledKey)
  {
    return this->Resampled;
  }

  // where each new sample lies among the old ones, axis by axis; cells by their centres
  vtkDataArray* coordinates[3] = { grid->GetXCoordinates(), grid->GetYCoordinates(),
    grid->GetZCoordinates() };
  std::vector<vtkIdType> lower[3];
  std::vector<double> weight[3];
  vtkIdType old[3];
  double origin[3];
  double spacing[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    std::vector<double> places;
    for (int i = 0; i + isCell < dimensions[axis]; ++i)
    {
      const double here = coordinates[axis]->GetComponent(i, 0);
      places.push_back(isCell ? 0.5 * (here + coordinates[axis]->GetComponent(i + 1, 0)) : here);
    }
    old[axis] = static_cast<vtkIdType>(places.size());
    const double first = coordinates[axis]->GetComponent(0, 0);
    const double last = coordinates[axis]->GetComponent(dimensions[axis] - 1, 0);
    origin[axis] = first;
    spacing[axis] = (last - first) / (dimensions[axis] - 1);
    for (int i = 0; i < dimensions[axis]; ++i)
    {
      const double place = first + i * spacing[axis];
      const auto above = std::upper_bound(places.begin(), places.end(), place);
      const vtkIdType low = std::min(
        std::max<vtkIdType>(above - places.begin() - 1, 0), std::max<vtkIdType>(old[axis] - 2, 0));
      const vtkIdType high = std::min(low + 1, old[axis] - 1);
      const double step = places[high] - places[low];
      const double t = step > 0.0 ? (place - places[low]) / step : 0.0;
      lower[axis].push_back(low);
      weight[axis].push_back(std::min(std::max(t, 0.0), 1.0));
    }
  }

  vtkNew<vtkFloatArray> samples;
  samples->SetName(scalars->GetName());
  samples->SetNumberOfTuples(static_cast<vtkIdType>(dimensions[0]) * dimensions[1] * dimensions[2]);
  vtkIdType id = 0;
  for (int k = 0; k < dimensions[2]; ++k)
  {
    for (int j = 0; j < dimensions[1]; ++j)
    {
      for (int i = 0; i < dimensions[0]; ++i, ++id)
      {
        const int at[3] = { i, j, k };
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner)
        {
          vtkIdType from[3];
          double product = 1.0;
          for (int axis = 0; axis < 3; ++axis)
          {
            const int side = (corner >> axis) & 1;
            const double t = weight[axis][at[axis]];
            from[axis] = std::min(lower[axis][at[axis]] + side, old[axis] - 1);
            product *= side ? t : 1.0 - t;
          }
          if (product > 0.0)
          {
            sum +=
              product * scalars->GetComponent(from[0] + old[0] * (from[1] + old[1] * from[2]), 0);
          }
        }
        samples->SetValue(id, static_cast<float>(sum));
      }
    }
  }
  this->Resampled = vtkSmartPointer<vtkImageData>::New();
  this->Resampled->SetDimensions(dimensions);
  this->Resampled->SetOrigin(origin);
  this->Resampled->SetSpacing(spacing);
  this->Resampled->GetPointData()->SetScalars(samples);
  this->ResampledKey = key;
  return this->Resampled;
}
