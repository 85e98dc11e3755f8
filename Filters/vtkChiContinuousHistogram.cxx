// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiContinuousHistogram.h"

#include "vtkCellData.h"
#include "vtkChiExec.h"
#include "vtkChiGridInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiPolyDataGrid.h"
#include "vtkChiReduction.h"
#include "vtkChiViews.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkTable.h"

#include <chiaroscuro/chi_histogram.h>

#include <limits>

vtkStandardNewMacro(vtkChiContinuousHistogram);

struct vtkChiContinuousHistogram::Internals
{
  vtkChiGridInput Grid;
  vtkChiPolyDataGrid Polygons;
  chi_histogram* Handle = nullptr;
  chi_histogram_result Result = {};

  // What the last histogram was made of, for quantiles. Arrays are held, so that no other one comes
  // to lie there.
  vtkSmartPointer<vtkDataSet> Input;
  vtkSmartPointer<vtkDataArray> Array;
  std::unique_ptr<vtkChiArrayView> View;
  vtkMTimeType ArrayTime = 0;
  std::uint64_t Version = 0, GridVersion = 0;
  bool IsReady = false;
  vtkSmartPointer<vtkMultiProcessController> Controller;
  vtkSmartPointer<vtkMultiProcessController> Together; // of the last histogram, for quantiles

  ~Internals() { chi_histogram_destroy(nullptr, this->Handle); }

  // Lend an array; its version changes with it.
  void Borrow(vtkDataArray* array)
  {
    if (this->Array != array || this->ArrayTime != array->GetMTime() || !this->IsAsItWas())
    {
      this->Array = array;
      this->ArrayTime = array->GetMTime();
      this->View.reset(new vtkChiArrayView(array));
      ++this->Version;
    }
  }

  // Whether the array that was lent still lies where it did.
  bool IsAsItWas() const
  {
    const chi_array_view* const view = this->View ? this->View->Get() : nullptr;
    return view && this->ArrayTime == this->Array->GetMTime() &&
      static_cast<size_t>(this->Array->GetNumberOfTuples()) == view->count &&
      (!vtkChiArrayView::IsDirect(this->Array) || this->Array->GetVoidPointer(0) == view->data);
  }
};

vtkChiContinuousHistogram::vtkChiContinuousHistogram()
  : Internal(new Internals)
{
  this->Internal->Controller = vtkMultiProcessController::GetGlobalController();
}

vtkChiContinuousHistogram::~vtkChiContinuousHistogram() = default;

//------------------------------------------------------------------------------
int vtkChiContinuousHistogram::FillInputPortInformation(int, vtkInformation* info)
{
  // Composite data are taken to be refused by name; the pipeline would make a table a block.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

// All of the input: a table has no parts. Of several processes, each its piece.
int vtkChiContinuousHistogram::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkChiRequestPiece(this->Internal->Controller, inputs[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkChiContinuousHistogram::FindArray(vtkDataSet* input, int& association)
{
  const bool isChosen = vtkChiIsChosen(this, 0);
  vtkDataArray* array = nullptr;
  if (isChosen)
  {
    array = this->GetInputArrayToProcess(0, input, association);
  }
  else
  {
    array = input->GetPointData()->GetScalars();
    association =
      array ? vtkDataObject::FIELD_ASSOCIATION_POINTS : vtkDataObject::FIELD_ASSOCIATION_CELLS;
    array = array ? array : input->GetCellData()->GetScalars();
  }
  if (!array)
  {
    vtkErrorMacro(<< (isChosen ? "there is no array" + vtkChiChosenArray(this, 0)
                               : "the input has no active scalars; choose an array by "
                                 "SetInputArrayToProcess"));
    return nullptr;
  }
  const bool ofPoints = association == vtkDataObject::FIELD_ASSOCIATION_POINTS;
  if (!ofPoints && association != vtkDataObject::FIELD_ASSOCIATION_CELLS)
  {
    vtkErrorMacro(<< vtkChiDescribe(array) << " is neither of points nor of cells");
    return nullptr;
  }
  const vtkIdType count = ofPoints ? input->GetNumberOfPoints() : input->GetNumberOfCells();
  if (array->GetNumberOfTuples() != count)
  {
    vtkErrorMacro(<< vtkChiDescribe(array) << " does not belong to the input, which has " << count
                  << (ofPoints ? " points" : " cells"));
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
void vtkChiContinuousHistogram::SetController(vtkMultiProcessController* controller)
{
  if (this->Internal->Controller != controller)
  {
    this->Internal->Controller = controller;
    this->Modified();
  }
}

vtkMultiProcessController* vtkChiContinuousHistogram::GetController() const
{
  return this->Internal->Controller;
}

// Whether all processes can go on: none may wait for one that gave up.
bool vtkChiContinuousHistogram::AllAgree(bool isGood)
{
  vtkMultiProcessController* const controller = this->Internal->Together;
  double isBad = isGood ? 0 : 1;
  if (vtkChiNumberOfProcesses(controller) > 1 && vtkChiMaxOfAll(controller, &isBad, 1))
  {
    vtkErrorMacro("the processes cannot be reached");
    return false;
  }
  if (isGood && isBad > 0)
  {
    vtkErrorMacro("another process cannot go on with its piece");
  }
  return isBad <= 0;
}

//------------------------------------------------------------------------------
void vtkChiContinuousHistogram::Reset()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  this->Internal->IsReady = false;
  this->Internal->Result = {};
  this->TotalMass = this->MassBelowRange = this->MassAboveRange = this->SingularMass = 0;
  this->Mean = this->Variance = nan;
  this->NumberOfSkippedCells = this->NumberOfHiddenCells = 0;
  this->NumberOfLowerDimensionalCells = this->NumberOfSimplices = 0;
}

void vtkChiContinuousHistogram::Report(vtkDataArray* array)
{
  const chi_histogram_result& r = this->Internal->Result;
  this->TotalMass = r.total_mass;
  this->MassBelowRange = r.mass_below;
  this->MassAboveRange = r.mass_above;
  this->SingularMass = r.singular_mass;
  this->Mean = r.mean;
  this->Variance = r.central_moments[2];
  this->NumberOfSkippedCells = static_cast<vtkIdType>(r.skipped_cells);
  this->NumberOfHiddenCells = static_cast<vtkIdType>(r.ghost_cells + r.blanked_cells);
  this->NumberOfLowerDimensionalCells = static_cast<vtkIdType>(r.lower_dimensional_cells);
  this->NumberOfSimplices = static_cast<vtkIdType>(r.simplices);
  if (r.skipped_cells > 0)
  {
    vtkWarningMacro(<< r.skipped_cells
                    << " cells with values or points that are not finite are left out");
  }
  if (r.unsupported_cells > 0)
  {
    vtkWarningMacro(<< r.unsupported_cells << " cells are of types that are not split");
  }
  if (r.is_constant && array)
  {
    vtkWarningMacro(<< vtkChiDescribe(array) << " is constant, " << r.mean
                    << "; the bins are a narrow window around the value");
  }
}

//------------------------------------------------------------------------------
int vtkChiContinuousHistogram::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  static const char* const names[] = { "BinCenter", "Density", "IsoArea", "Mass", "Cumulative" };
  Internals& internal = *this->Internal;
  vtkDataObject* const given = vtkDataObject::GetData(inputs[0]);
  vtkDataSet* input = vtkDataSet::SafeDownCast(given);
  vtkTable* const table = vtkTable::GetData(outputs);
  this->Reset();
  vtkNew<vtkDoubleArray> columns[5];
  for (int k = 0; k < 5; ++k)
  {
    columns[k]->SetName(names[k]);
    table->AddColumn(columns[k]);
  }
  if (!input)
  {
    vtkErrorMacro("the input is a " << (given ? given->GetClassName() : "null")
                                    << "; merge composite data with vtkMergeBlocks, or take each "
                                       "block");
    return 0;
  }
  // what the core would refuse, by the names of this class
  if (this->NumberOfBins < 1 || this->NumberOfBins > 1 << 20)
  {
    vtkErrorMacro("NumberOfBins is " << this->NumberOfBins << "; it must be 1 ... 1048576");
    return 0;
  }
  const double size = this->Range[1] - this->Range[0];
  if (!this->AutomaticRange &&
    (!(size > 0) || !(this->NumberOfBins / size < VTK_DOUBLE_MAX) || !(size < VTK_DOUBLE_MAX)))
  {
    vtkErrorMacro("the range is [" << this->Range[0] << ", " << this->Range[1]
                                   << "]; it must be finite, its lower end below the upper");
    return 0;
  }
  input = internal.Polygons.Convert(input);
  internal.Together = internal.Controller;
  const bool isPiece = vtkChiNumberOfProcesses(internal.Together) > 1;
  const bool isThere = internal.Grid.Collect(input), isEmpty = !isThere && internal.Grid.IsEmpty();
  if (!isThere && !isEmpty)
  {
    vtkErrorMacro(<< internal.Grid.GetProblem());
  }
  if (isEmpty && !isPiece)
  {
    return 1; // an empty piece is a normal event in a streamed pipeline
  }
  int association = 0;
  vtkDataArray* const array = isThere ? this->FindArray(input, association) : nullptr;
  if (!this->AllAgree(isEmpty || array))
  {
    return 0;
  }

  // Borrow; a piece without cells is an image without points.
  chi_grid_view nothing = {};
  nothing.struct_size = sizeof nothing;
  nothing.kind = CHI_GRID_IMAGE;
  const chi_array_view noValues = { nullptr, 0, 1, sizeof(double), CHI_F64 };
  chi_histogram_reduction reduction = {};
  reduction.struct_size = sizeof reduction;
  reduction.user = internal.Together;
  reduction.max_f64 = vtkChiMaxOfAll;
  reduction.sum_i64 = vtkChiSumOfAll;
  internal.Input = isEmpty ? nullptr : input;
  if (!isEmpty)
  {
    internal.Borrow(array);
    internal.GridVersion = internal.Grid.GetGrid()->version;
  }
  chi_histogram_params params = {};
  params.struct_size = sizeof params;
  params.reduction = isPiece ? &reduction : nullptr;
  params.field = isEmpty ? &noValues : internal.View->Get();
  params.component = isEmpty ? 0 : this->Component;
  params.association = association == vtkDataObject::FIELD_ASSOCIATION_CELLS ? CHI_HISTOGRAM_CELLS
                                                                             : CHI_HISTOGRAM_POINTS;
  params.field_version = internal.Version;
  params.bins = static_cast<size_t>(this->NumberOfBins);
  params.range[0] = this->Range[0];
  params.range[1] = this->Range[1];
  params.automatic_range = this->AutomaticRange;
  params.moments = this->NumberOfMoments;
  params.no_skipping = SKIP_EVERY_KIND & ~this->SkippingMask;

  // Compute.
  for (auto& column : columns)
  {
    column->SetNumberOfTuples(this->NumberOfBins);
  }
  chi_histogram_outputs out = {};
  out.struct_size = sizeof out;
  out.centers = columns[0]->GetPointer(0);
  out.density = columns[1]->GetPointer(0);
  out.iso_area = columns[2]->GetPointer(0);
  out.mass = columns[3]->GetPointer(0);
  out.cumulative = columns[4]->GetPointer(0);
  const vtkChiExec exec(this);
  chi_status status = internal.Handle ? CHI_OK : chi_histogram_create(nullptr, &internal.Handle);
  status = status == CHI_OK ? chi_histogram_compute(exec.Get(), internal.Handle,
                                isEmpty ? &nothing : internal.Grid.GetGrid(), &params, &out)
                            : status;
  chi_histogram_get_result(internal.Handle, &internal.Result);
  if (status != CHI_OK)
  {
    for (auto& column : columns)
    {
      column->SetNumberOfTuples(0);
    }
    if (status != CHI_ERROR_CANCELLED)
    {
      const int64_t bad = internal.Result.first_bad_cell;
      vtkErrorMacro("the histogram failed: " << chi_status_string(status)
                                             << (status == CHI_ERROR_INVALID_ARGUMENT && bad >= 0
                                                    ? "; cell " + std::to_string(bad) + " is broken"
                                                    : ""));
    }
    this->Reset();
    return status == CHI_ERROR_CANCELLED;
  }
  internal.IsReady = true;
  this->Report(array);
  return 1;
}

//------------------------------------------------------------------------------
double vtkChiContinuousHistogram::GetMoment(int order)
{
  double moment = std::numeric_limits<double>::quiet_NaN();
  const chi_histogram_result& r = this->Internal->Result;
  if (this->Internal->IsReady &&
    chi_histogram_moment(this->Internal->Handle, order, &moment) != CHI_OK)
  {
    vtkErrorMacro("GetMoment(" << order << "): orders are 0 ... " << r.moments
                               << "; SetNumberOfMoments finds more");
  }
  return moment;
}

double vtkChiContinuousHistogram::GetCentralMoment(int order)
{
  const chi_histogram_result& r = this->Internal->Result;
  if (!this->Internal->IsReady)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (order < 0 || order > r.moments)
  {
    vtkErrorMacro("GetCentralMoment(" << order << "): orders are 0 ... " << r.moments
                                      << "; SetNumberOfMoments finds more");
    return std::numeric_limits<double>::quiet_NaN();
  }
  return r.central_moments[order];
}

double vtkChiContinuousHistogram::GetQuantile(double share)
{
  Internals& internal = *this->Internal;
  double quantile = std::numeric_limits<double>::quiet_NaN();
  if (!(share >= 0 && share <= 1))
  {
    vtkErrorMacro("GetQuantile(" << share << "): shares are 0 ... 1");
    return quantile;
  }
  if (!internal.IsReady || !(this->TotalMass > 0))
  {
    return quantile;
  }
  const bool isThere = !internal.Input ||
    (internal.Grid.Collect(internal.Input) &&
      internal.Grid.GetGrid()->version == internal.GridVersion && internal.IsAsItWas());
  if (!isThere)
  {
    vtkErrorMacro("GetQuantile: the input has changed since the last update");
  }
  if (!this->AllAgree(isThere))
  {
    internal.IsReady = false; // what was lent may be gone
    return quantile;
  }
  const vtkChiExec exec(nullptr);
  const chi_status status = chi_histogram_quantile(exec.Get(), internal.Handle, share, &quantile);
  if (status != CHI_OK)
  {
    vtkErrorMacro("GetQuantile failed: " << chi_status_string(status));
    quantile = std::numeric_limits<double>::quiet_NaN();
  }
  return quantile;
}

vtkIdType vtkChiContinuousHistogram::GetNumberOfSkipped(int kind) const
{
  const int64_t* const skipped = this->Internal->Result.skipped;
  return kind == SKIP_OUTSIDE ? static_cast<vtkIdType>(skipped[0])
    : kind == SKIP_ONE_BIN    ? static_cast<vtkIdType>(skipped[1])
    : kind == SKIP_UNCHANGED  ? static_cast<vtkIdType>(skipped[2])
                              : 0;
}

//------------------------------------------------------------------------------
void vtkChiContinuousHistogram::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Component: " << this->Component << "\n";
  os << indent << "NumberOfBins: " << this->NumberOfBins << "\n";
  os << indent << "Range: " << this->Range[0] << " " << this->Range[1] << "\n";
  os << indent << "AutomaticRange: " << this->AutomaticRange << "\n";
  os << indent << "NumberOfMoments: " << this->NumberOfMoments << "\n";
  os << indent << "SkippingMask: " << this->SkippingMask << "\n";
  os << indent << "TotalMass: " << this->TotalMass << "\n";
  os << indent << "MassBelowRange: " << this->MassBelowRange << "\n";
  os << indent << "MassAboveRange: " << this->MassAboveRange << "\n";
  os << indent << "SingularMass: " << this->SingularMass << "\n";
  os << indent << "Mean: " << this->Mean << "\n";
  os << indent << "Variance: " << this->Variance << "\n";
  os << indent << "NumberOfSkippedCells: " << this->NumberOfSkippedCells << "\n";
  os << indent << "NumberOfHiddenCells: " << this->NumberOfHiddenCells << "\n";
  os << indent << "NumberOfLowerDimensionalCells: " << this->NumberOfLowerDimensionalCells << "\n";
  os << indent << "NumberOfSimplices: " << this->NumberOfSimplices << "\n";
}
