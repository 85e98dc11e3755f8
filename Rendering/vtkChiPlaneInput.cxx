// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiPlaneInput.h"

#include "vtkChiExec.h"
#include "vtkChiTransferShapes.h"

#include "vtkImageData.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

namespace
{
// The ray caster takes a gradient over a quarter of the scalar range to be the largest.
constexpr double LargestOfRayCaster = 0.25;
// What central differences can reach: half the range along each of three axes.
const double LargestGradient = std::sqrt(0.75);

// One value, or none, has a range too.
void findRange(vtkDataArray* samples, int component, double range[2])
{
  samples->GetFiniteRange(range, component);
  if (!(range[0] <= range[1]))
  {
    range[0] = 0.0;
    range[1] = 1.0;
  }
  if (!(range[1] - range[0] > 1e-12 * std::abs(range[0])))
  {
    range[1] = range[0] + std::max(std::abs(range[0]) * 1e-6, 1e-30);
  }
}

std::size_t entriesOf(double span, double step)
{
  constexpr double LEAST = 256.0;
  constexpr double MOST = 2048.0; // both ways 2^22
  return static_cast<std::size_t>(std::min(std::max(std::ceil(span / step) + 1.0, LEAST), MOST));
}
}

//------------------------------------------------------------------------------
std::uint64_t vtkChiPlaneInput::GetTime(vtkVolumeProperty* property) const
{
  if (this->Function)
  {
    return this->Function->GetMTime() + 1;
  }
  const bool asked = property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D;
  vtkImageData* image = asked ? property->GetTransferFunction2D(0) : nullptr;
  return image ? image->GetMTime() + 1 : asked ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkChiPlaneInput::Collect(vtkVolumeProperty* property, vtkDataArray* samples, int component,
  vtkDataArray* second, chi_transfer_view* transfer)
{
  this->Problem.clear();
  transfer->plane = nullptr;
  transfer->y_samples = nullptr;
  if (this->GetTime(property) == 0)
  {
    return;
  }
  const double largest = this->Function ? LargestGradient : LargestOfRayCaster;
  double x[2];
  double y[2];
  findRange(samples, component, x);
  y[0] = 0.0;
  y[1] = largest * (x[1] - x[0]);
  if (second)
  {
    findRange(second, 0, y);
  }
  const double old[2] = { transfer->range[0], transfer->range[1] };
  std::copy(x, x + 2, transfer->range);
  std::copy(y, y + 2, transfer->plane_range);
  if (!(this->Function ? this->MakeTable(transfer) : this->ReadImage(property, transfer)))
  {
    std::copy(old, old + 2, transfer->range);
    return;
  }
  transfer->plane = this->Table.data();
}

//------------------------------------------------------------------------------
void vtkChiPlaneInput::CollectSecond(vtkDataArray* second, chi_transfer_view* transfer)
{
  this->Second.resize(static_cast<std::size_t>(second->GetNumberOfTuples()));
  for (std::size_t i = 0; i < this->Second.size(); ++i)
  {
    this->Second[i] = static_cast<float>(second->GetComponent(static_cast<vtkIdType>(i), 0));
  }
  transfer->y_samples = this->Second.data();
}

//------------------------------------------------------------------------------
// As the ray caster reads it: over the whole ranges; the image's own origin and spacing say
// nothing.
bool vtkChiPlaneInput::ReadImage(vtkVolumeProperty* property, chi_transfer_view* transfer)
{
  this->Table =
    vtkChiTransferShapes::ReadImage(property->GetTransferFunction2D(0), transfer->plane_count);
  if (this->Table.empty())
  {
    this->Problem =
      "the two-dimensional transfer function (vtkVolumeProperty) is no image of 2 x 2 "
      "to 2^22 points with four components: the one-dimensional ones are used";
  }
  return !this->Table.empty();
}

//------------------------------------------------------------------------------
bool vtkChiPlaneInput::MakeTable(chi_transfer_view* transfer)
{
  const vtkChiTransferShapes& shapes = *this->Function->Shapes;
  const double* x = transfer->range;
  const double* y = transfer->plane_range;
  transfer->plane_count[0] = entriesOf(x[1] - x[0], shapes.GetStep(0));
  transfer->plane_count[1] = entriesOf(y[1] - y[0], shapes.GetStep(1));
  this->Table.resize(4 * transfer->plane_count[0] * transfer->plane_count[1]);
  const std::vector<chi_transfer_shape> core = shapes.GetCore();
  const vtkChiExec exec(nullptr);
  const chi_status status = chi_transfer_shapes_table(
    exec.Get(), core.data(), core.size(), transfer->plane_count, x, y, this->Table.data());
  if (status != CHI_OK)
  {
    this->Problem =
      std::string("the two-dimensional transfer function could not be made a table: ") +
      chi_status_string(status) + ": the one-dimensional ones are used";
  }
  return status == CHI_OK;
}
