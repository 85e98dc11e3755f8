// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiContinuousScatterplot.h"

#include "vtkCellData.h"
#include "vtkChiExec.h"
#include "vtkChiGridInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiReduction.h"
#include "vtkChiViews.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <chiaroscuro/chi_scatterplot.h>

#include <tuple>

vtkStandardNewMacro(vtkChiContinuousScatterplot);

// An array with what belongs to it.
struct vtkChiContinuousScatterplot::Field
{
  vtkDataArray* Array = nullptr;
  int Association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  int Component = 0;
};

struct vtkChiContinuousScatterplot::Internals
{
  vtkChiGridInput Grid;
  vtkSmartPointer<vtkMultiProcessController> Controller;
  chi_scatterplot* Handle = nullptr;
  chi_scatterplot_result Result = {};

  // Polygons as an unstructured grid, whose arrays the core can read.
  vtkSmartPointer<vtkUnstructuredGrid> Polygons;
  vtkSmartPointer<vtkPolyData> PolygonsFrom;
  vtkMTimeType PolygonsTime = 0;

  // What the kept ranges were made of; arrays are held, so that no other one comes to lie there.
  using Key = std::tuple<vtkSmartPointer<vtkDataArray>, vtkMTimeType>;
  Key Keys[3];
  std::uint64_t Version = 1;

  ~Internals() { chi_scatterplot_destroy(this->Handle); }

  vtkDataSet* Convert(vtkDataSet* input);
};

vtkChiContinuousScatterplot::vtkChiContinuousScatterplot()
  : Internal(new Internals)
{
  this->SetNumberOfOutputPorts(2);
  this->Internal->Controller = vtkMultiProcessController::GetGlobalController();
}

vtkChiContinuousScatterplot::~vtkChiContinuousScatterplot() = default;

//------------------------------------------------------------------------------
namespace
{
// The first of consecutive global ids of cells, or 0.
vtkIdType GetFirstCell(vtkDataSet* input)
{
  vtkDataArray* const ids = input->GetCellData()->GetGlobalIds();
  const vtkIdType count = ids ? ids->GetNumberOfTuples() : 0;
  const double first = count > 0 ? ids->GetComponent(0, 0) : 0;
  for (vtkIdType i = 1; i < count; ++i)
  {
    if (ids->GetComponent(i, 0) != first + static_cast<double>(i))
    {
      return 0;
    }
  }
  return first >= 0 ? static_cast<vtkIdType>(first) : 0;
}
}

void vtkChiContinuousScatterplot::SetController(vtkMultiProcessController* controller)
{
  if (this->Internal->Controller != controller)
  {
    this->Internal->Controller = controller;
    this->Modified();
  }
}

vtkMultiProcessController* vtkChiContinuousScatterplot::GetController() const
{
  return this->Internal->Controller;
}

int vtkChiContinuousScatterplot::GetNumberOfProcesses() const
{
  return vtkChiNumberOfProcesses(this->Internal->Controller);
}

// Whether all processes can go on: none may wait for one that gave up.
bool vtkChiContinuousScatterplot::AllAgree(bool isGood)
{
  double isBad = isGood ? 0 : 1;
  if (this->GetNumberOfProcesses() > 1 && vtkChiMaxOfAll(this->Internal->Controller, &isBad, 1))
  {
    vtkErrorMacro("the processes cannot be reached");
    return false;
  }
  if (isGood && isBad > 0)
  {
    vtkErrorMacro("another process cannot plot its piece");
  }
  return isBad <= 0;
}

//------------------------------------------------------------------------------
// vtkPolyData has four lists of cells; their order is that of the cell data.
vtkDataSet* vtkChiContinuousScatterplot::Internals::Convert(vtkDataSet* input)
{
  vtkPolyData* const polygons = vtkPolyData::SafeDownCast(input);
  if (!polygons)
  {
    this->PolygonsFrom = nullptr;
    return input;
  }
  if (this->PolygonsFrom == polygons && this->PolygonsTime == polygons->GetMTime())
  {
    return this->Polygons;
  }
  this->Polygons = vtkSmartPointer<vtkUnstructuredGrid>::New();
  this->Polygons->SetPoints(polygons->GetPoints());
  this->Polygons->GetPointData()->ShallowCopy(polygons->GetPointData());
  this->Polygons->GetCellData()->ShallowCopy(polygons->GetCellData());
  this->Polygons->Allocate(polygons->GetNumberOfCells());
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < polygons->GetNumberOfCells(); ++i)
  {
    polygons->GetCellPoints(i, ids);
    this->Polygons->InsertNextCell(polygons->GetCellType(i), ids);
  }
  this->PolygonsFrom = polygons;
  this->PolygonsTime = polygons->GetMTime();
  return this->Polygons;
}

//------------------------------------------------------------------------------
void vtkChiContinuousScatterplot::SetTrilinearTolerance(double tolerance)
{
  if (!(tolerance >= 0) || !(tolerance <= VTK_DOUBLE_MAX))
  {
    vtkErrorMacro("SetTrilinearTolerance(" << tolerance << "): must be 0 or more, and finite");
  }
  else if (this->TrilinearTolerance != tolerance)
  {
    this->TrilinearTolerance = tolerance;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkChiContinuousScatterplot::SetComponent(int array, int component)
{
  if (array < 0 || array > 2 || component < -1)
  {
    vtkErrorMacro("SetComponent(" << array << ", " << component
                                  << "): arrays are 0, 1 and the weight 2; components begin at 0, "
                                     "-1 is the magnitude");
    return;
  }
  if (this->Component[array] != component)
  {
    this->Component[array] = component;
    this->Modified();
  }
}

int vtkChiContinuousScatterplot::GetComponent(int array) const
{
  return array >= 0 && array <= 2 ? this->Component[array] : 0;
}

void vtkChiContinuousScatterplot::SetRange(int array, double low, double high)
{
  if (array < 0 || array > 1)
  {
    vtkErrorMacro("SetRange: arrays are 0 and 1, not " << array);
    return;
  }
  if (this->Range[array][0] != low || this->Range[array][1] != high)
  {
    this->Range[array][0] = low;
    this->Range[array][1] = high;
    this->Modified();
  }
}

void vtkChiContinuousScatterplot::GetRange(int array, double range[2]) const
{
  const int i = array == 1 ? 1 : 0;
  range[0] = this->Range[i][0];
  range[1] = this->Range[i][1];
}

void vtkChiContinuousScatterplot::SetMatrixArrays(vtkStringArray* names)
{
  this->MatrixArrays.clear();
  for (vtkIdType i = 0; names && i < names->GetNumberOfValues(); ++i)
  {
    this->MatrixArrays.push_back(names->GetValue(i));
  }
  this->Modified();
}

void vtkChiContinuousScatterplot::AddMatrixArray(const char* name)
{
  if (name)
  {
    this->MatrixArrays.emplace_back(name);
    this->Modified();
  }
}

void vtkChiContinuousScatterplot::RemoveAllMatrixArrays()
{
  this->MatrixArrays.clear();
  this->Modified();
}

int vtkChiContinuousScatterplot::GetNumberOfMatrixArrays() const
{
  return static_cast<int>(this->MatrixArrays.size());
}

vtkIdType vtkChiContinuousScatterplot::GetNumberOfSkipped(int kind) const
{
  const chi_scatterplot_result& r = this->Internal->Result;
  return kind == SKIP_EDGES  ? static_cast<vtkIdType>(r.edge_simplices)
    : kind == SKIP_ONE_BIN   ? static_cast<vtkIdType>(r.one_bin_simplices)
    : kind == SKIP_PIECES    ? static_cast<vtkIdType>(r.missing_pieces + r.one_bin_pieces)
    : kind == SKIP_UNCHANGED ? r.is_kept
                             : 0;
}

//------------------------------------------------------------------------------
int vtkChiContinuousScatterplot::FillInputPortInformation(int, vtkInformation* info)
{
  // Composite data are taken to be refused by name; the pipeline would make a plot a block.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

int vtkChiContinuousScatterplot::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

int vtkChiContinuousScatterplot::RequestDataObject(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  for (int port = 0; port < 2; ++port)
  {
    vtkInformation* const info = outputs->GetInformationObject(port);
    vtkDataObject* const output = vtkDataObject::GetData(info);
    const bool isMatrix = !this->MatrixArrays.empty();
    if (isMatrix && !vtkMultiBlockDataSet::SafeDownCast(output))
    {
      info->Set(vtkDataObject::DATA_OBJECT(), vtkSmartPointer<vtkMultiBlockDataSet>::New());
    }
    else if (!isMatrix && !vtkImageData::SafeDownCast(output))
    {
      info->Set(vtkDataObject::DATA_OBJECT(), vtkSmartPointer<vtkImageData>::New());
    }
  }
  return 1;
}

int vtkChiContinuousScatterplot::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  const int extent[6] = { 0, this->Dimensions[0] - 1, 0, this->Dimensions[1] - 1, 0, 0 };
  for (int port = 0; port < 2; ++port)
  {
    vtkInformation* const info = outputs->GetInformationObject(port);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    vtkDataObject::SetPointDataActiveScalarInfo(
      info, port == 0 ? VTK_DOUBLE : VTK_UNSIGNED_CHAR, port == 0 ? 1 : 4);
  }
  return 1;
}

// All of the input, whatever part of the plot is asked for; of several processes, each its piece.
int vtkChiContinuousScatterplot::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkChiRequestPiece(this->Internal->Controller, inputs[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
bool vtkChiContinuousScatterplot::FindField(vtkDataSet* input, int index, Field& field)
{
  static const char* const names[] = { "first array", "second array", "weight" };
  const bool isChosen = vtkChiIsChosen(this, index);
  field = Field();
  field.Component = this->Component[index];
  if (isChosen)
  {
    field.Array = this->GetInputArrayToProcess(index, input, field.Association);
  }
  else if (index < 2)
  {
    field.Array = input->GetPointData()->GetArray(index);
  }
  else
  {
    return true;
  }
  if (!field.Array)
  {
    vtkErrorMacro("there is no " << names[index]
                                 << (isChosen ? vtkChiChosenArray(this, index)
                                              : " of points; choose it by SetInputArrayToProcess"));
    return false;
  }
  if (field.Association != vtkDataObject::FIELD_ASSOCIATION_POINTS &&
    field.Association != vtkDataObject::FIELD_ASSOCIATION_CELLS)
  {
    vtkErrorMacro("the " << names[index] << ", " << vtkChiDescribe(field.Array)
                         << ", is neither of points nor of cells");
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
// Every array of the plot or of the matrix.
bool vtkChiContinuousScatterplot::FindFields(
  vtkDataSet* input, std::vector<Field>& fields, Field& weight)
{
  const bool isMatrix = !this->MatrixArrays.empty();
  fields.resize(isMatrix ? this->MatrixArrays.size() : 2);
  if (!this->FindField(input, 2, weight))
  {
    return false;
  }
  if (!isMatrix)
  {
    return this->FindField(input, 0, fields[0]) && this->FindField(input, 1, fields[1]);
  }
  for (size_t i = 0; i < fields.size(); ++i)
  {
    const char* const name = this->MatrixArrays[i].c_str();
    fields[i].Array = input->GetPointData()->GetArray(name);
    if (!fields[i].Array)
    {
      fields[i].Array = input->GetCellData()->GetArray(name);
      fields[i].Association = vtkDataObject::FIELD_ASSOCIATION_CELLS;
    }
    if (!fields[i].Array)
    {
      vtkErrorMacro("there is no array '" << name << "' of points or cells for the matrix");
      return false;
    }
  }
  return true;
}

bool vtkChiContinuousScatterplot::Check(const Field fields[2], const Field& weight)
{
  if (fields[0].Association != fields[1].Association)
  {
    vtkErrorMacro("of the two arrays, " << vtkChiDescribe(fields[0].Array) << " and "
                                        << vtkChiDescribe(fields[1].Array)
                                        << ", one is of points and one of cells; "
                                           "vtkCellDataToPointData makes point data of cell data");
    return false;
  }
  for (const Field* field : { fields, fields + 1, &weight })
  {
    const std::string problem =
      field->Array ? vtkChiRefuseComponent(field->Array, field->Component) : std::string();
    if (!problem.empty())
    {
      vtkErrorMacro(<< problem);
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
// Without arrays the piece is empty.
bool vtkChiContinuousScatterplot::Plot(vtkDataSet* input, const Field fields[2],
  const Field& weight, vtkImageData* density, vtkImageData* colors)
{
  Internals& internal = *this->Internal;
  const bool isEmpty = !fields[0].Array;
  if (!this->AllAgree(isEmpty || this->Check(fields, weight)))
  {
    return false;
  }
  const Field* const all[3] = { fields, fields + 1, &weight };
  for (int i = 0; i < 3; ++i)
  {
    const Field& field = *all[i];
    const Internals::Key key{ field.Array, field.Array ? field.Array->GetMTime() : 0 };
    if (key != internal.Keys[i])
    {
      internal.Keys[i] = key;
      ++internal.Version;
    }
  }

  // Borrow.
  std::unique_ptr<vtkChiArrayView> views[2], weights;
  chi_grid_view nothing = {};
  nothing.struct_size = sizeof nothing;
  nothing.kind = CHI_GRID_IMAGE; // without points
  chi_scatterplot_input in = {};
  in.struct_size = sizeof in;
  in.grid = isEmpty ? &nothing : internal.Grid.GetGrid();
  for (int i = 0; i < 2; ++i)
  {
    in.fields[i] = chi_array_view{ nullptr, 0, 1, sizeof(double), CHI_F64 };
    if (!isEmpty)
    {
      views[i].reset(new vtkChiArrayView(fields[i].Array));
      in.fields[i] = *views[i]->Get();
    }
    in.components[i] = fields[i].Array ? fields[i].Component : 0;
  }
  in.association = fields[0].Association == vtkDataObject::FIELD_ASSOCIATION_CELLS
    ? CHI_SCATTERPLOT_CELLS
    : CHI_SCATTERPLOT_POINTS;
  if (weight.Array && !isEmpty)
  {
    weights.reset(new vtkChiArrayView(weight.Array));
    in.weight = *weights->Get();
    in.weight_component = weight.Component;
    in.weight_association = weight.Association == vtkDataObject::FIELD_ASSOCIATION_CELLS
      ? CHI_SCATTERPLOT_CELLS
      : CHI_SCATTERPLOT_POINTS;
  }
  vtkImageData* const image = vtkImageData::SafeDownCast(input);
  vtkRectilinearGrid* const rectilinear = vtkRectilinearGrid::SafeDownCast(input);
  for (int axis = 0; axis < 3 && (image || rectilinear); ++axis)
  {
    in.first_index[axis] = (image ? image->GetExtent() : rectilinear->GetExtent())[2 * axis];
  }
  const bool isPiece = this->GetNumberOfProcesses() > 1;
  in.first_cell = isPiece ? GetFirstCell(input) : 0;
  in.version = this->SkippingMask & SKIP_UNCHANGED ? internal.Version : 0;
  chi_scatterplot_params params = {};
  params.struct_size = sizeof params;
  params.automatic_range = this->AutomaticRange || !this->MatrixArrays.empty();
  params.method =
    this->Method == METHOD_PUBLISHED ? CHI_SCATTERPLOT_PUBLISHED : CHI_SCATTERPLOT_EXACT;
  params.trilinear_tolerance = this->TrilinearTolerance;
  params.trilinear_levels = this->TrilinearLevels;
  params.splat_size = this->SplatSize;
  params.switches =
    static_cast<uint32_t>((this->SkippingMask & SKIP_EDGES ? 0 : CHI_SCATTERPLOT_NO_EDGES) |
      (this->SkippingMask & SKIP_ONE_BIN ? 0 : CHI_SCATTERPLOT_NO_ONE_BIN) |
      (this->SkippingMask & SKIP_PIECES ? 0 : CHI_SCATTERPLOT_NO_SKIP));
  chi_scatterplot_reduction reduction = {};
  reduction.struct_size = sizeof reduction;
  reduction.user = internal.Controller;
  reduction.max_f64 = vtkChiMaxOfAll;
  reduction.sum_i64 = vtkChiSumOfAll;
  params.reduction = isPiece ? &reduction : nullptr;
  for (int i = 0; i < 2; ++i)
  {
    params.bins[i] = static_cast<size_t>(this->Dimensions[i]);
    params.range[i][0] = this->Range[i][0];
    params.range[i][1] = this->Range[i][1];
  }

  // Plot.
  vtkNew<vtkDoubleArray> values;
  values->SetName("Density");
  values->SetNumberOfTuples(
    static_cast<vtkIdType>(this->Dimensions[0]) * static_cast<vtkIdType>(this->Dimensions[1]));
  const vtkChiExec exec(this);
  chi_scatterplot_result& r = internal.Result;
  chi_status status = internal.Handle ? CHI_OK : chi_scatterplot_create(nullptr, &internal.Handle);
  status = status == CHI_OK
    ? chi_scatterplot_compute(exec.Get(), internal.Handle, &in, &params, values->GetPointer(0), &r)
    : status;
  vtkNew<vtkUnsignedCharArray> rgba;
  rgba->SetName("Color");
  rgba->SetNumberOfComponents(4);
  rgba->SetNumberOfTuples(values->GetNumberOfTuples());
  chi_scatterplot_display_params display = {};
  display.struct_size = sizeof display;
  display.is_linear = !this->LogarithmicDisplay;
  display.decades = this->DisplayDecades;
  status = status == CHI_OK
    ? chi_scatterplot_display(exec.Get(), values->GetPointer(0),
        static_cast<size_t>(values->GetNumberOfTuples()), &display, rgba->GetPointer(0))
    : status;
  if (status != CHI_OK)
  {
    r = {};
    if (status == CHI_ERROR_CANCELLED)
    {
      return true;
    }
    vtkErrorMacro("the plot failed: " << chi_status_string(status)
                                      << (status == CHI_ERROR_INVALID_ARGUMENT
                                             ? "; a cell of the input is broken, or values have no "
                                               "finite range"
                                             : ""));
    return false;
  }

  // Report.
  this->TotalMass = r.total_mass;
  this->MassOutOfRange = r.mass_out_of_range;
  this->SingularMass = r.singular_mass;
  this->NumberOfSkippedCells = static_cast<vtkIdType>(r.skipped_cells);
  this->NumberOfHiddenCells = static_cast<vtkIdType>(r.ghost_cells + r.blanked_cells);
  this->NumberOfLowerDimensionalCells = static_cast<vtkIdType>(r.lower_dimensional_cells);
  this->NumberOfSimplices = static_cast<vtkIdType>(r.simplices);
  this->NumberOfSubdividedCells = static_cast<vtkIdType>(r.subdivided_cells);
  this->NumberOfCappedCells = static_cast<vtkIdType>(r.capped_cells);
  this->NumberOfSplats = static_cast<vtkIdType>(r.splats);
  this->SplatErrorBound = r.splat_bound;
  if (r.skipped_cells > 0)
  {
    vtkWarningMacro(<< r.skipped_cells
                    << " cells with values or points that are not finite are left out");
  }
  if (r.unsupported_cells > 0)
  {
    vtkWarningMacro(<< r.unsupported_cells << " cells are of types that are not split");
  }
  if (r.constant_fields && !isEmpty)
  {
    vtkWarningMacro("constant: " << (r.constant_fields & 1 ? vtkChiDescribe(fields[0].Array) : "")
                                 << (r.constant_fields == 3 ? ", " : "")
                                 << (r.constant_fields & 2 ? vtkChiDescribe(fields[1].Array) : "")
                                 << "; the plot is a narrow window around the value");
  }

  // Attach.
  vtkImageData* const images[2] = { density, colors };
  vtkDataArray* const arrays[2] = { values, rgba };
  for (int k = 0; k < 2; ++k)
  {
    double origin[3] = { 0, 0, 0 }, spacing[3] = { 1, 1, 1 };
    for (int i = 0; i < 2; ++i)
    {
      spacing[i] = (r.range[i][1] - r.range[i][0]) / this->Dimensions[i];
      origin[i] = r.range[i][0] + spacing[i] / 2;
    }
    images[k]->SetDimensions(this->Dimensions[0], this->Dimensions[1], 1);
    images[k]->SetOrigin(origin);
    images[k]->SetSpacing(spacing);
    images[k]->GetPointData()->SetScalars(arrays[k]);
  }
  return true;
}

//------------------------------------------------------------------------------
int vtkChiContinuousScatterplot::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  Internals& internal = *this->Internal;
  vtkDataObject* const given = vtkDataObject::GetData(inputs[0]);
  vtkDataSet* input = vtkDataSet::SafeDownCast(given);
  vtkDataObject* const output[2] = { vtkDataObject::GetData(outputs, 0),
    vtkDataObject::GetData(outputs, 1) };
  internal.Result = {};
  this->TotalMass = this->MassOutOfRange = this->SingularMass = 0;
  this->NumberOfSkippedCells = this->NumberOfHiddenCells = 0;
  this->NumberOfLowerDimensionalCells = this->NumberOfSimplices = 0;
  this->NumberOfSubdividedCells = this->NumberOfCappedCells = this->NumberOfSplats = 0;
  this->SplatErrorBound = 0;
  if (!input)
  {
    vtkErrorMacro("the input is a " << (given ? given->GetClassName() : "null")
                                    << "; merge composite data with vtkMergeBlocks, or take each "
                                       "block");
    return 0;
  }
  // what the core would refuse, by the names of this class
  const double bins = static_cast<double>(this->Dimensions[0]) * this->Dimensions[1];
  if (this->Dimensions[0] < 1 || this->Dimensions[1] < 1 || this->Dimensions[0] > 32768 ||
    this->Dimensions[1] > 32768 || bins > 0x1p28)
  {
    vtkErrorMacro("Dimensions are " << this->Dimensions[0] << " x " << this->Dimensions[1]
                                    << " bins; each must be 1 ... 32768, and all at most 2^28");
    return 0;
  }
  for (int i = 0; i < 2 && !this->AutomaticRange && this->MatrixArrays.empty(); ++i)
  {
    const double size = this->Range[i][1] - this->Range[i][0];
    if (!(size > 0) || !(size < VTK_DOUBLE_MAX))
    {
      vtkErrorMacro("the range of array " << i << " is [" << this->Range[i][0] << ", "
                                          << this->Range[i][1]
                                          << "]; it must be finite, its lower end below the upper");
      return 0;
    }
  }
  input = internal.Convert(input);
  const bool isThere = internal.Grid.Collect(input);
  const bool isEmpty = !isThere && internal.Grid.IsEmpty();
  if (!isThere && !isEmpty)
  {
    vtkErrorMacro(<< internal.Grid.GetProblem());
  }
  if (isEmpty && this->GetNumberOfProcesses() <= 1)
  {
    return 1; // an empty piece is a normal event in a streamed pipeline
  }
  const bool isMatrix = !this->MatrixArrays.empty();
  std::vector<Field> arrays(isMatrix ? this->MatrixArrays.size() : 2);
  Field weight;
  if (!this->AllAgree(isEmpty || (isThere && this->FindFields(input, arrays, weight))))
  {
    return 0;
  }
  if (!isMatrix)
  {
    return this->Plot(input, arrays.data(), weight, vtkImageData::SafeDownCast(output[0]),
      vtkImageData::SafeDownCast(output[1]));
  }

  // A matrix.
  vtkMultiBlockDataSet* const plots[2] = { vtkMultiBlockDataSet::SafeDownCast(output[0]),
    vtkMultiBlockDataSet::SafeDownCast(output[1]) };
  unsigned int block = 0;
  for (size_t i = 0; i < arrays.size(); ++i)
  {
    for (size_t j = i + 1; j < arrays.size(); ++j, ++block)
    {
      const Field pair[2] = { arrays[i], arrays[j] };
      vtkNew<vtkImageData> density, colors;
      if (!this->Plot(input, pair, weight, density, colors))
      {
        return 0;
      }
      const std::string name = this->MatrixArrays[i] + ", " + this->MatrixArrays[j];
      vtkImageData* const images[2] = { density, colors };
      for (int k = 0; k < 2; ++k)
      {
        plots[k]->SetBlock(block, images[k]);
        plots[k]->GetMetaData(block)->Set(vtkCompositeDataSet::NAME(), name.c_str());
      }
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkChiContinuousScatterplot::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Component: " << this->Component[0] << " " << this->Component[1] << " "
     << this->Component[2] << "\n";
  os << indent << "Dimensions: " << this->Dimensions[0] << " " << this->Dimensions[1] << "\n";
  for (int i = 0; i < 2; ++i)
  {
    os << indent << "Range " << i << ": " << this->Range[i][0] << " " << this->Range[i][1] << "\n";
  }
  os << indent << "AutomaticRange: " << this->AutomaticRange << "\n";
  os << indent << "Method: " << this->Method << "\n";
  os << indent << "TrilinearTolerance: " << this->TrilinearTolerance << "\n";
  os << indent << "TrilinearLevels: " << this->TrilinearLevels << "\n";
  os << indent << "SplatSize: " << this->SplatSize << "\n";
  os << indent << "NumberOfMatrixArrays: " << this->MatrixArrays.size() << "\n";
  os << indent << "LogarithmicDisplay: " << this->LogarithmicDisplay << "\n";
  os << indent << "DisplayDecades: " << this->DisplayDecades << "\n";
  os << indent << "SkippingMask: " << this->SkippingMask << "\n";
  os << indent << "TotalMass: " << this->TotalMass << "\n";
  os << indent << "MassOutOfRange: " << this->MassOutOfRange << "\n";
  os << indent << "SingularMass: " << this->SingularMass << "\n";
  os << indent << "NumberOfSkippedCells: " << this->NumberOfSkippedCells << "\n";
  os << indent << "NumberOfHiddenCells: " << this->NumberOfHiddenCells << "\n";
  os << indent << "NumberOfLowerDimensionalCells: " << this->NumberOfLowerDimensionalCells << "\n";
  os << indent << "NumberOfSimplices: " << this->NumberOfSimplices << "\n";
  os << indent << "NumberOfSubdividedCells: " << this->NumberOfSubdividedCells << "\n";
  os << indent << "NumberOfCappedCells: " << this->NumberOfCappedCells << "\n";
  os << indent << "NumberOfSplats: " << this->NumberOfSplats << "\n";
  os << indent << "SplatErrorBound: " << this->SplatErrorBound << "\n";
}
