// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiDerivedFields.h"

#include "vtkCellData.h"
#include "vtkChiExec.h"
#include "vtkChiGridInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiPages.h"
#include "vtkChiPolyDataGrid.h"
#include "vtkChiViews.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <chiaroscuro/chi_derived.h>

#include <algorithm>
#include <tuple>

vtkStandardNewMacro(vtkChiDerivedFields);

namespace
{
constexpr int FieldCount = 4;
const char* const FieldNames[FieldCount] = { "GradientMagnitude", "SecondDerivative", "Laplacian",
  "MeanCurvature" };

// Whether float has fewer digits than the array.
bool IsWide(vtkDataArray* array)
{
  const chi_type type = vtkChiType(array->GetDataType());
  return type != CHI_F32 && (type == CHI_F64 || type == 0 || chi_type_size(type) > 2);
}
}

struct vtkChiDerivedFields::Internals
{
  vtkChiGridInput Grid;
  vtkChiPolyDataGrid Polygons;

  // The fields that are at hand, and what they were made from.
  struct Field
  {
    vtkSmartPointer<vtkDataArray> Array;
    vtkMTimeType Time = 0; // when it was made: what is modified later is not ours any more
  };
  Field Fields[FieldCount];
  vtkSmartPointer<vtkDataArray> Source; // held, so that no other one comes to lie there
  std::tuple<vtkMTimeType, void*, vtkIdType, int, int, std::uint64_t> Key;

  // Forget what was made from anything else.
  void Match(vtkDataArray* array, int component, int order)
  {
    void* const data = array->HasStandardMemoryLayout() ? array->GetVoidPointer(0) : nullptr;
    const auto key = std::make_tuple(array->GetMTime(), data, array->GetNumberOfValues(), component,
      order, this->Grid.GetGrid()->version);
    const bool isSame = this->Source == array && key == this->Key;
    for (Field& field : this->Fields)
    {
      if (!isSame || (field.Array && field.Array->GetMTime() != field.Time))
      {
        field = Field();
      }
    }
    this->Source = array;
    this->Key = key;
  }
};

vtkChiDerivedFields::vtkChiDerivedFields()
  : Internal(new Internals)
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkChiDerivedFields::~vtkChiDerivedFields() = default;

//------------------------------------------------------------------------------
// Pieces take the neighbours from those beside them that the differences reach.
int vtkChiDerivedFields::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  vtkInformation* const out = outputs->GetInformationObject(0);
  const int result = this->Superclass::RequestUpdateExtent(request, inputs, outputs);
  const auto get = [out](vtkInformationIntegerKey* key)
  { return out->Has(key) ? out->Get(key) : 0; };
  if (get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
  {
    in->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(),
      get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS()) + this->Order / 2);
  }
  return result;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkChiDerivedFields::FindArray(vtkDataSet* input)
{
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* array = this->GetInputArrayToProcess(0, input, association);
  const char* name = this->GetInputArrayInformation(0)->Get(vtkDataObject::FIELD_NAME());
  if (!array && name && !*name) // ParaView's, where it knew no array when the filter was made
  {
    association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    array = input->GetPointData()->GetScalars();
    name = nullptr;
  }
  vtkDataArray* const ofCells = array ? nullptr
    : name                            ? input->GetCellData()->GetArray(name)
                                      : input->GetCellData()->GetScalars();
  if (ofCells || (array && association == vtkDataObject::FIELD_ASSOCIATION_CELLS))
  {
    vtkErrorMacro(<< vtkChiDescribe(ofCells ? ofCells : array)
                  << " belongs to the cells; derivatives need values at points, which "
                     "vtkCellDataToPointData makes of it");
    return nullptr;
  }
  if (!array)
  {
    vtkErrorMacro("there is no array" << vtkChiChosenArray(this, 0));
    return nullptr;
  }
  if (association != vtkDataObject::FIELD_ASSOCIATION_POINTS ||
    array->GetNumberOfTuples() != input->GetNumberOfPoints())
  {
    vtkErrorMacro(<< vtkChiDescribe(array) << " does not belong to the points, of which there are "
                  << input->GetNumberOfPoints());
    return nullptr;
  }
  const std::string problem = vtkChiRefuseComponent(array, this->Component);
  if (!problem.empty())
  {
    vtkErrorMacro(<< problem);
    return nullptr;
  }
  return array;
}

//------------------------------------------------------------------------------
// Compute the fields that are wanted and not at hand.
bool vtkChiDerivedFields::Derive(vtkDataArray* array, vtkIdType points)
{
  Internals& internal = *this->Internal;
  const bool wanted[FieldCount] = { this->ComputeGradientMagnitude, this->ComputeSecondDerivative,
    this->ComputeLaplacian, this->ComputeMeanCurvature };
  const bool isWide = IsWide(array);
  const std::string name = array->GetName() ? array->GetName() : "";
  chi_derived_arrays arrays = {};
  arrays.struct_size = sizeof arrays;
  arrays.type = isWide ? CHI_F64 : CHI_F32;
  void** const places[FieldCount] = { &arrays.gradient_magnitude, &arrays.second_derivative,
    &arrays.laplacian, &arrays.mean_curvature };
  vtkSmartPointer<vtkDataArray> made[FieldCount];
  vtkIdType count = 0;
  for (int k = 0; k < FieldCount; ++k)
  {
    if (wanted[k] && internal.Fields[k].Array)
    {
      ++this->NumberOfKeptFields;
    }
    else if (wanted[k])
    {
      made[k].TakeReference(isWide ? static_cast<vtkDataArray*>(vtkDoubleArray::New())
                                   : static_cast<vtkDataArray*>(vtkFloatArray::New()));
      made[k]->SetName((name.empty() ? FieldNames[k] : name + "_" + FieldNames[k]).c_str());
      made[k]->SetNumberOfTuples(points);
      vtkChiAdvisePages(made[k]);
      *places[k] = made[k]->GetVoidPointer(0);
      ++count;
    }
  }
  if (count == 0)
  {
    return true;
  }
  chi_derived_params params = {};
  params.struct_size = sizeof params;
  params.order = this->Order;
  params.component = this->Component;
  const vtkChiArrayView values(array);
  const vtkChiExec exec(this);
  chi_derived_counts counts = {};
  const chi_status status = chi_derived_compute(
    exec.Get(), internal.Grid.GetGrid(), values.Get(), &params, &arrays, &counts);
  if (status != CHI_OK)
  {
    static const char* const axes[] = { "x", "y", "z" };
    if (status == CHI_ERROR_INVALID_ARGUMENT && counts.bad_axis >= 0)
    {
      vtkErrorMacro("the points along " << axes[counts.bad_axis]
                                        << " have no distance: spacings must not be 0, axes not "
                                           "parallel, coordinates strictly increase or decrease");
    }
    else if (status == CHI_ERROR_INVALID_ARGUMENT)
    {
      vtkErrorMacro("the input has cells that are broken: ids of points that are not there, or "
                    "offsets that decrease");
    }
    else if (status != CHI_ERROR_CANCELLED)
    {
      vtkErrorMacro("the derivatives failed: " << chi_status_string(status));
    }
    return false;
  }
  for (int k = 0; k < FieldCount; ++k)
  {
    if (made[k])
    {
      made[k]->Modified();
      internal.Fields[k].Array = made[k];
      internal.Fields[k].Time = made[k]->GetMTime();
    }
  }
  this->NumberOfComputedFields += count;
  this->NumberOfFlatPoints = static_cast<vtkIdType>(counts.flat_points);
  this->NumberOfNonFinitePoints = static_cast<vtkIdType>(counts.non_finite_points);
  this->NumberOfUndeterminedPoints = static_cast<vtkIdType>(counts.undetermined_points);
  this->NumberOfLinearPoints = static_cast<vtkIdType>(counts.linear_points);
  return true;
}

//------------------------------------------------------------------------------
int vtkChiDerivedFields::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  Internals& internal = *this->Internal;
  vtkDataSet* const input = vtkDataSet::GetData(inputs[0]);
  vtkDataSet* const output = vtkDataSet::GetData(outputs);
  output->ShallowCopy(input);
  if (this->Order != 2 && this->Order != 4)
  {
    vtkErrorMacro("Order is " << this->Order << "; differences are of order 2 or 4");
    return 0;
  }
  const bool wanted[FieldCount] = { this->ComputeGradientMagnitude, this->ComputeSecondDerivative,
    this->ComputeLaplacian, this->ComputeMeanCurvature };
  if (std::none_of(wanted, wanted + FieldCount, [](bool b) { return b; }))
  {
    vtkWarningMacro("no field is wanted: the output is the input");
    return 1;
  }
  if (input->GetNumberOfPoints() == 0)
  {
    return 1; // an empty piece is a normal event in a streamed pipeline
  }
  if (input->GetNumberOfCells() == 0)
  {
    vtkErrorMacro("the input has points but no cells; derivatives need to know which points are "
                  "neighbours");
    return 0;
  }
  vtkDataArray* const array = this->FindArray(input);
  if (!array)
  {
    return 0;
  }
  if (!internal.Grid.Collect(internal.Polygons.Convert(input)))
  {
    vtkErrorMacro(<< internal.Grid.GetProblem());
    return 0;
  }
  internal.Match(array, this->Component, this->Order);
  if (!this->Derive(array, input->GetNumberOfPoints()))
  {
    return this->GetAbortExecute() ? 1 : 0;
  }
  for (int k = 0; k < FieldCount; ++k)
  {
    if (wanted[k])
    {
      output->GetPointData()->AddArray(internal.Fields[k].Array);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkChiDerivedFields::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Component: " << this->Component << "\n";
  os << indent << "Order: " << this->Order << "\n";
  os << indent << "ComputeGradientMagnitude: " << this->ComputeGradientMagnitude << "\n";
  os << indent << "ComputeSecondDerivative: " << this->ComputeSecondDerivative << "\n";
  os << indent << "ComputeLaplacian: " << this->ComputeLaplacian << "\n";
  os << indent << "ComputeMeanCurvature: " << this->ComputeMeanCurvature << "\n";
  os << indent << "NumberOfFlatPoints: " << this->NumberOfFlatPoints << "\n";
  os << indent << "NumberOfNonFinitePoints: " << this->NumberOfNonFinitePoints << "\n";
  os << indent << "NumberOfUndeterminedPoints: " << this->NumberOfUndeterminedPoints << "\n";
  os << indent << "NumberOfLinearPoints: " << this->NumberOfLinearPoints << "\n";
  os << indent << "NumberOfComputedFields: " << this->NumberOfComputedFields << "\n";
  os << indent << "NumberOfKeptFields: " << this->NumberOfKeptFields << "\n";
}
