// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiFieldInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiShadingInput.h"
#include "vtkChiViews.h"

#include "vtkAbstractMapper.h"
#include "vtkAbstractVolumeMapper.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkVolumeProperty.h"

#include <algorithm>

//------------------------------------------------------------------------------
bool vtkChiFieldInput::Collect(vtkAbstractVolumeMapper* mapper, vtkDataSet* input,
  vtkVolumeProperty* property, int vectorComponent, const std::string& opacityArray)
{
  this->Problem.clear();
  this->Limits.clear();
  this->Field.struct_size = sizeof(this->Field);
  if (!this->FindScalars(mapper, input) || !this->FindOpacity(input, opacityArray))
  {
    return false;
  }
  this->ChooseComponents(property, vectorComponent);
  this->FindSecond(property, input);
  const vtkMTimeType time = input->GetMTime();
  this->CollectFunctions(property, time);
  const bool newScalars = this->Lend(this->Scalars, time, this->Samples);
  const bool newOpacities = this->OpacityArray && this->LendOpacity(time);
  // no more than there are points, or cells
  const vtkIdType count =
    this->Field.is_cell_data ? input->GetNumberOfCells() : input->GetNumberOfPoints();
  const bool newSeconds = this->Second && this->Lend(this->Second, time, this->Seconds);
  const bool newColors = this->ColorArray && this->Lend(this->ColorArray, time, this->Colors);
  this->Samples.View.count = static_cast<std::size_t>(count);
  this->Opacities.View.count = static_cast<std::size_t>(count);
  this->Colors.View.count = static_cast<std::size_t>(count);
  this->Seconds.View.count = static_cast<std::size_t>(count);
  const std::array<std::uint64_t, 5> key = { static_cast<std::uint64_t>(this->Field.component),
    static_cast<std::uint64_t>(this->Field.is_cell_data), vtkChiBits(this->OpacityArray),
    vtkChiBits(this->ColorArray), vtkChiBits(this->Second) };
  if (newScalars || newOpacities || newColors || newSeconds || key != this->FieldKey)
  {
    this->FieldKey = key;
    ++this->Field.version;
  }
  this->Field.scalars = &this->Samples.View;
  this->Field.opacity = this->OpacityArray ? &this->Opacities.View : nullptr;
  this->Field.opacity_component = 0;
  this->Field.colors = this->ColorArray ? &this->Colors.View : nullptr;
  this->Field.second = this->Second ? &this->Seconds.View : nullptr;
  this->Field.second_component = 0;
  this->CombineFunctions();
  this->CollectPlane(property, time);
  this->AddLimits(property);
  return true;
}

//------------------------------------------------------------------------------
// Along with a function of two quantities there is nothing else that opacity or colour could be
// read at.
void vtkChiFieldInput::FindSecond(vtkVolumeProperty* property, vtkDataSet* input)
{
  this->Second = nullptr;
  if (this->Plane.GetTime(property) == 0)
  {
    return;
  }
  if (this->OpacityArray || this->ColorArray)
  {
    this->Limits.emplace_back("an opacity array and dependent components are left out under a "
                              "two-dimensional transfer function");
    this->OpacityArray = nullptr;
    this->ColorArray = nullptr;
  }
  if (this->SecondName.empty())
  {
    return;
  }
  vtkDataSetAttributes* data = this->Field.is_cell_data
    ? static_cast<vtkDataSetAttributes*>(input->GetCellData())
    : static_cast<vtkDataSetAttributes*>(input->GetPointData());
  const std::string problem = this->Problem;
  this->Second = data->GetArray(this->SecondName.c_str());
  if (!this->Second || !this->IsLong(input, this->Second))
  {
    this->Problem = problem;
    this->Second = nullptr;
    this->Limits.push_back("the array '" + this->SecondName +
      "' of the two-dimensional transfer function's y axis is not there, or too short: the "
      "gradient is used");
  }
}

//------------------------------------------------------------------------------
void vtkChiFieldInput::CollectPlane(vtkVolumeProperty* property, vtkMTimeType time)
{
  const std::uint64_t asked = this->Plane.GetTime(property);
  if (asked == 0)
  {
    this->PlaneKey = {};
    return;
  }
  const std::array<std::uint64_t, 7> key = { asked, vtkChiBits(this->Scalars),
    this->Scalars->GetMTime(), static_cast<std::uint64_t>(this->Field.component), time,
    vtkChiBits(this->Second), this->Second ? this->Second->GetMTime() : 0 };
  if (key != this->PlaneKey)
  {
    this->PlaneKey = key;
    this->PlaneTransfer = this->Transfer;
    this->Plane.Collect(
      property, this->Scalars, this->Field.component, this->Second, &this->PlaneTransfer);
    ++this->Transfer.version;
  }
  if (!this->Plane.GetProblem().empty())
  {
    this->Limits.push_back(this->Plane.GetProblem());
  }
  this->Transfer.plane = this->PlaneTransfer.plane;
  if (this->Transfer.plane)
  {
    std::copy_n(this->PlaneTransfer.plane_count, 2, this->Transfer.plane_count);
    std::copy_n(this->PlaneTransfer.plane_range, 2, this->Transfer.plane_range);
    std::copy_n(this->PlaneTransfer.range, 2, this->Transfer.range);
  }
}

//------------------------------------------------------------------------------
void vtkChiFieldInput::AddLimits(vtkVolumeProperty* property)
{
  const std::string& limit = this->ColorFunction.GetLimit();
  if (!limit.empty())
  {
    this->Limits.push_back(limit);
  }
  if (vtkChiShadingInput::GetGradientOpacityTime(property) != 0 && !this->Transfer.plane)
  {
    this->Limits.emplace_back("gradient opacity (vtkVolumeProperty) is not supported for "
                              "tetrahedra: it is left out; a vtkChiTransferFunction2D over the "
                              "gradient does the same");
  }
}

//------------------------------------------------------------------------------
// Whether an array has a tuple for each point, or cell.
bool vtkChiFieldInput::IsLong(vtkDataSet* input, vtkDataArray* array)
{
  const vtkIdType count =
    this->Field.is_cell_data ? input->GetNumberOfCells() : input->GetNumberOfPoints();
  if (array->GetNumberOfComponents() < 1 || array->GetNumberOfTuples() < count)
  {
    this->Problem = vtkChiDescribe(array) + " is too short: the input (" + input->GetClassName() +
      ") has " + std::to_string(count) + (this->Field.is_cell_data ? " cells" : " points");
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiFieldInput::FindScalars(vtkAbstractVolumeMapper* mapper, vtkDataSet* input)
{
  const int mode = mapper->GetScalarMode();
  int of = 0; // 0: points, 1: cells, 2: field data
  this->Scalars = vtkAbstractMapper::GetScalars(
    input, mode, mapper->GetArrayAccessMode(), mapper->GetArrayId(), mapper->GetArrayName(), of);
  if (mode == VTK_SCALAR_MODE_USE_FIELD_DATA || (this->Scalars && of > 1))
  {
    this->Problem = std::string("scalars of the field data of the input (") +
      input->GetClassName() + ") belong to no point and no cell: they cannot be drawn";
    return false;
  }
  if (!this->Scalars)
  {
    const char* name = mapper->GetArrayName();
    const bool byName =
      mode == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA || mode == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
    this->Problem = std::string("the input (") + input->GetClassName() + ") has no " +
      (byName ? std::string("array '") + (name && *name ? name : "(by index)") + "'"
              : std::string("scalars")) +
      " for scalar mode " + mapper->GetScalarModeAsString();
    return false;
  }
  this->Field.is_cell_data = of;
  return this->IsLong(input, this->Scalars);
}

//------------------------------------------------------------------------------
bool vtkChiFieldInput::FindOpacity(vtkDataSet* input, const std::string& name)
{
  this->OpacityArray = nullptr;
  this->OpacityComponent = 0;
  if (name.empty())
  {
    return true;
  }
  vtkDataSetAttributes* data = this->Field.is_cell_data
    ? static_cast<vtkDataSetAttributes*>(input->GetCellData())
    : static_cast<vtkDataSetAttributes*>(input->GetPointData());
  this->OpacityArray = data->GetArray(name.c_str());
  if (!this->OpacityArray)
  {
    this->Problem = std::string("the input (") + input->GetClassName() +
      ") has no opacity array '" + name + "' of " +
      (this->Field.is_cell_data ? "cells" : "points") + ", which the scalars are of";
    return false;
  }
  return this->IsLong(input, this->OpacityArray);
}

//------------------------------------------------------------------------------
// As vtkProjectedTetrahedraMapper: of independent components the first; of two dependent ones the
// first for colour and the second for opacity; of four three are the colour: bytes over 255, other
// types as they are. The fourth is what opacity is read at, as vtkVolumeProperty says (that mapper
// takes it for the opacity itself), if no array of its own is.
void vtkChiFieldInput::ChooseComponents(vtkVolumeProperty* property, int vectorComponent)
{
  const int there = this->Scalars->GetNumberOfComponents();
  this->Field.component = 0;
  this->ColorArray = nullptr;
  if (there > 1 && !property->GetIndependentComponents())
  {
    if (there == 2 && !this->OpacityArray)
    {
      this->OpacityArray = this->Scalars;
      this->OpacityComponent = 1;
    }
    else if (there == 4)
    {
      this->ColorArray = this->Scalars;
      this->Field.color_component = 0;
      this->Field.color_range[1] = this->Scalars->GetDataType() == VTK_UNSIGNED_CHAR ? 255.0 : 1.0;
      this->Field.component = 3;
      if (this->OpacityArray) // all that is left for scalars to say
      {
        this->Scalars = this->OpacityArray;
        this->Field.component = this->OpacityComponent;
        this->OpacityArray = nullptr;
      }
    }
    else if (there != 2)
    {
      this->Limits.push_back("dependent components (vtkVolumeProperty) are drawn of two or of "
                             "four: only the first is drawn of " +
        vtkChiDescribe(this->Scalars));
    }
  }
  else if (there > 1)
  {
    this->Field.component = std::min(vectorComponent, there - 1);
  }
}

//------------------------------------------------------------------------------
// Returns whether anything about the array is new.
bool vtkChiFieldInput::Lend(vtkDataArray* array, vtkMTimeType time, Lent& lent)
{
  const bool direct = vtkChiArrayView::IsDirect(array);
  const std::array<std::uint64_t, 5> key = { vtkChiBits(array), array->GetMTime(), time,
    vtkChiBits(direct ? array->GetVoidPointer(0) : nullptr),
    static_cast<std::uint64_t>(array->GetNumberOfValues()) };
  if (key == lent.Key && lent.From == array)
  {
    return false;
  }
  lent.Key = key;
  lent.From = array;
  lent.Held = array;
  if (!direct)
  {
    lent.Held = vtkSmartPointer<vtkDoubleArray>::New();
    lent.Held->DeepCopy(array);
  }
  lent.View = *vtkChiArrayView(lent.Held).Get();
  return true;
}

//------------------------------------------------------------------------------
// Both tables of the core span one range, so values that opacity is read at by a table of its own
// are carried from that table's range to the scalars'.
bool vtkChiFieldInput::LendOpacity(vtkMTimeType time)
{
  const double* from = this->OpacityFunction.GetTransfer()->range;
  const double* to = this->ColorFunction.GetTransfer()->range;
  const std::array<std::uint64_t, 9> key = { vtkChiBits(this->OpacityArray),
    this->OpacityArray->GetMTime(), time, static_cast<std::uint64_t>(this->OpacityComponent),
    vtkChiBits(this->OpacityArray->GetVoidPointer(0)), vtkChiBits(from[0]), vtkChiBits(from[1]),
    vtkChiBits(to[0]), vtkChiBits(to[1]) };
  if (key == this->OpacityKey && this->Opacities.From == this->OpacityArray)
  {
    return false;
  }
  const vtkIdType count = this->OpacityArray->GetNumberOfTuples();
  vtkNew<vtkDoubleArray> carried;
  carried->SetNumberOfTuples(count);
  const double scale = (to[1] - to[0]) / (from[1] - from[0]);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double value = this->OpacityArray->GetComponent(i, this->OpacityComponent);
    carried->SetValue(i, to[0] + scale * (value - from[0]));
  }
  this->OpacityKey = key;
  this->Opacities.Key = {};
  this->Opacities.From = this->OpacityArray;
  this->Opacities.Held = carried;
  this->Opacities.View = *vtkChiArrayView(carried).Get();
  return true;
}

//------------------------------------------------------------------------------
void vtkChiFieldInput::CollectFunctions(vtkVolumeProperty* property, vtkMTimeType time)
{
  const int component = this->Field.component;
  const std::uint64_t version = this->Scalars->GetMTime();
  const auto collect = [&](std::size_t least)
  {
    // the unit distance is the first component's, as in vtkProjectedTetrahedraMapper
    this->ColorFunction.Collect(property, 0, 0, this->Scalars, component, version, time, least);
    if (this->OpacityArray)
    {
      this->OpacityFunction.Collect(
        property, 0, 0, this->OpacityArray, this->OpacityComponent, version, time, least);
    }
  };
  collect(this->Entries);
  const std::size_t colors = this->ColorFunction.GetTransfer()->count;
  const std::size_t opacities = this->OpacityFunction.GetTransfer()->count;
  if (this->OpacityArray && colors != opacities)
  {
    this->Entries = std::max(colors, opacities); // and so from now on
    collect(this->Entries);
  }
}

//------------------------------------------------------------------------------
void vtkChiFieldInput::CombineFunctions()
{
  const chi_transfer_view& opacities = *this->OpacityFunction.GetTransfer();
  const std::uint64_t version = this->Transfer.version;
  this->Transfer = *this->ColorFunction.GetTransfer();
  const std::array<std::uint64_t, 2> key = { this->Transfer.version,
    this->OpacityArray ? opacities.version : 0 };
  if (this->OpacityArray)
  {
    this->Transfer.opacity = opacities.opacity;
  }
  this->Transfer.version = key == this->TransferKey ? version : version + 1;
  this->TransferKey = key;
}
