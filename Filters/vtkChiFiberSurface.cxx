// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiFiberSurface.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkChiExec.h"
#include "vtkChiFiberCarry.h"
#include "vtkChiGridInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiPages.h"
#include "vtkChiPolygonInput.h"
#include "vtkChiViews.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <chiaroscuro/chi_fiber.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <tuple>
#include <vector>

vtkStandardNewMacro(vtkChiFiberSurface);

struct vtkChiFiberSurface::Internals
{
  vtkChiGridInput Grid;
  chi_fiber* Fiber = nullptr;
  chi_fiber_sizes Sizes = {};

  // What the index was made of; the arrays are held, so that no other one comes to lie there.
  using Key = std::tuple<vtkSmartPointer<vtkDataArray>, vtkMTimeType>;
  std::array<Key, 2> Fields;
  std::uint64_t Version = 0;

  ~Internals() { chi_fiber_destroy(nullptr, this->Fiber); }
};

vtkChiFiberSurface::vtkChiFiberSurface()
  : Internal(new Internals)
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(3);
}

vtkChiFiberSurface::~vtkChiFiberSurface() = default;

namespace
{
vtkSmartPointer<vtkIdTypeArray> NewIds(const char* name, std::size_t count)
{
  auto array = vtkSmartPointer<vtkIdTypeArray>::New();
  array->SetName(name);
  array->SetNumberOfTuples(static_cast<vtkIdType>(count));
  return array;
}

std::string Interval(const double range[2])
{
  return "[" + std::to_string(range[0]) + ", " + std::to_string(range[1]) + "]";
}
}

//------------------------------------------------------------------------------
int vtkChiFiberSurface::FillInputPortInformation(int port, vtkInformation* info)
{
  // Composite data are taken to be refused by name; the pipeline would loop over their blocks and
  // give an index to none.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkDataSet" : "vtkPolyData");
  info->Append(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkCompositeDataSet" : "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
int vtkChiFiberSurface::FillOutputPortInformation(int port, vtkInformation* info)
{
  static const char* const types[] = { "vtkPolyData", "vtkDataSet", "vtkUnstructuredGrid" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types[port]);
  return 1;
}

//------------------------------------------------------------------------------
vtkTypeBool vtkChiFiberSurface::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (!request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT()))
  {
    return this->Superclass::ProcessRequest(request, inputs, outputs);
  }
  if (!vtkPolyData::GetData(outputs, 0))
  {
    vtkNew<vtkPolyData> surface;
    outputs->GetInformationObject(0)->Set(vtkDataObject::DATA_OBJECT(), surface);
  }
  if (!vtkUnstructuredGrid::GetData(outputs, 2))
  {
    vtkNew<vtkUnstructuredGrid> enclosed;
    outputs->GetInformationObject(2)->Set(vtkDataObject::DATA_OBJECT(), enclosed);
  }
  vtkDataObject* const input = vtkDataObject::GetData(inputs[0]);
  vtkDataObject* const masked = vtkDataObject::GetData(outputs, 1);
  const bool isDataSet = vtkDataSet::SafeDownCast(input) != nullptr;
  if (!masked || (isDataSet && std::strcmp(masked->GetClassName(), input->GetClassName()) != 0))
  {
    const auto made = isDataSet
      ? vtkSmartPointer<vtkDataObject>::Take(input->NewInstance())
      : vtkSmartPointer<vtkDataObject>(vtkSmartPointer<vtkPolyData>::New());
    outputs->GetInformationObject(1)->Set(vtkDataObject::DATA_OBJECT(), made);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkChiFiberSurface::RequestData(vtkInformation* vtkNotUsed(request),
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataObject* const given = vtkDataObject::GetData(inputVector[0]);
  vtkDataSet* const input = vtkDataSet::SafeDownCast(given);
  vtkPolyData* const output = vtkPolyData::GetData(outputVector, 0);
  vtkDataSet* const masked = vtkDataSet::GetData(outputVector, 1);
  Internals& internal = *this->Internal;
  internal.Sizes = {};
  this->NumberOfSegments = this->NumberOfEmptySegments = this->NumberOfCrossings = 0;
  this->NumberOfSkippedCells = this->NumberOfComponents = this->NumberOfSmallComponents = 0;
  this->EnclosedVolume = 0;
  if (!input)
  {
    vtkErrorMacro("the input is a " << (given ? given->GetClassName() : "null")
                                    << "; composite data have one fiber surface a block: merge "
                                       "them with vtkMergeBlocks, or take each block");
    return 0;
  }
  output->GetFieldData()->PassData(input->GetFieldData());
  if (masked && this->GenerateMask)
  {
    masked->ShallowCopy(input);
  }

  // 1. The polygon.
  vtkChiPolygonInput polygon;
  vtkDataObject* const shape = vtkDataObject::GetData(inputVector[1]);
  if (vtkPolyData* const lines = vtkPolyData::SafeDownCast(shape))
  {
    polygon.Read(lines, this->CloseLines);
  }
  else if (vtkTable* const table = vtkTable::SafeDownCast(shape))
  {
    polygon.Read(table);
  }
  if (!polygon.Problem.empty())
  {
    vtkErrorMacro(<< polygon.Problem);
    return 0;
  }
  if (!polygon.Remark.empty())
  {
    vtkWarningMacro(<< polygon.Remark);
  }
  if (std::any_of(polygon.Points.begin(), polygon.Points.end(),
        [](double x) { return !(std::abs(x) <= 1e100); }))
  {
    vtkErrorMacro("the polygon has a corner that is NaN, infinite or beyond 1e100");
    return 0;
  }

  // 2. The mesh and its two arrays.
  if (!internal.Grid.Collect(input))
  {
    if (!internal.Grid.IsEmpty())
    {
      vtkErrorMacro(<< internal.Grid.GetProblem());
      return 0;
    }
    return 1; // an empty piece is a normal event in a streamed pipeline
  }
  vtkDataArray* arrays[2] = { nullptr, nullptr };
  for (int i = 0; i < 2; ++i)
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    const bool isChosen = vtkChiIsChosen(this, i);
    if (isChosen)
    {
      arrays[i] = this->GetInputArrayToProcess(i, input, association);
    }
    else
    {
      arrays[i] = input->GetPointData()->GetArray(i);
    }
    const char* const which = i == 0 ? "first" : "second";
    if (isChosen && arrays[i] && association != vtkDataObject::FIELD_ASSOCIATION_POINTS)
    {
      vtkErrorMacro("the " << which << " array, " << vtkChiDescribe(arrays[i])
                           << ", is not of points; vtkCellDataToPointData makes point data of cell "
                              "data");
      return 0;
    }
    if (!arrays[i])
    {
      vtkErrorMacro("there is no "
        << which << " array of points"
        << (isChosen ? vtkChiChosenArray(this, i) : "; choose it by SetInputArrayToProcess"));
      return 0;
    }
    const std::string problem = vtkChiRefuseComponent(arrays[i], this->Component[i]);
    if (!problem.empty())
    {
      vtkErrorMacro(<< problem);
      return 0;
    }
    const Internals::Key key{ arrays[i], arrays[i]->GetMTime() };
    if (key != internal.Fields[i])
    {
      internal.Fields[i] = key;
      ++internal.Version;
    }
  }

  // 3. Extract.
  const vtkChiExec exec(this);
  const vtkChiArrayView first(arrays[0]), second(arrays[1]);
  chi_fiber_params params = {};
  params.struct_size = sizeof params;
  params.fields[0] = first.Get();
  params.fields[1] = second.Get();
  params.components[0] = this->Component[0];
  params.components[1] = this->Component[1];
  params.fields_version = internal.Version;
  params.polygon = polygon.Get();
  params.split_corners = this->SplitCorners;
  params.no_normals = !this->ComputeNormals;
  params.find_components = this->ExtractComponents;
  params.minimum_area = this->ExtractComponents ? this->MinimumArea : 0;
  params.no_skipping = SKIP_EVERY_KIND & ~this->SkippingMask;
  chi_status status = internal.Fiber ? CHI_OK : chi_fiber_create(nullptr, &internal.Fiber);
  status = status == CHI_OK
    ? chi_fiber_extract(exec.Get(), internal.Fiber, internal.Grid.GetGrid(), &params)
    : status;
  chi_fiber_get_sizes(internal.Fiber, &internal.Sizes);
  const chi_fiber_sizes& sizes = internal.Sizes;
  if (status != CHI_OK)
  {
    if (status != CHI_ERROR_CANCELLED && sizes.first_bad_cell >= 0)
    {
      vtkErrorMacro("cell " << sizes.first_bad_cell << " of the input is broken");
    }
    else if (status != CHI_ERROR_CANCELLED)
    {
      vtkErrorMacro("the fiber surface failed: " << chi_status_string(status));
    }
    return status == CHI_ERROR_CANCELLED;
  }
  this->NumberOfSegments = static_cast<vtkIdType>(sizes.segments);
  this->NumberOfEmptySegments = static_cast<vtkIdType>(sizes.empty_segments);
  this->NumberOfCrossings = static_cast<vtkIdType>(sizes.crossed);
  this->NumberOfSkippedCells =
    static_cast<vtkIdType>(sizes.non_finite_values + sizes.non_finite_cells);
  this->NumberOfComponents = static_cast<vtkIdType>(sizes.components);
  this->NumberOfSmallComponents = static_cast<vtkIdType>(sizes.left_out);
  if (sizes.segments == 0)
  {
    vtkWarningMacro("the polygon has no segment of any length: there is no fiber surface");
  }
  else if (sizes.empty_segments > 0)
  {
    vtkWarningMacro(<< sizes.empty_segments << " segments of the polygon have no length");
  }
  if (this->NumberOfSkippedCells > 0)
  {
    vtkWarningMacro(<< sizes.non_finite_values << " cells with values and "
                    << sizes.non_finite_cells
                    << " cells with points that are not finite are left out");
  }
  if (sizes.segments > 0 && sizes.triangles == 0 && sizes.left_out == 0)
  {
    vtkWarningMacro("the polygon meets no values of the arrays, which range over "
      << Interval(sizes.field_ranges) << " and " << Interval(sizes.field_ranges + 2)
      << ": the fiber surface is empty");
  }

  // 4. Write and carry.
  vtkPointSet* const set = vtkPointSet::SafeDownCast(input);
  const bool isDouble = this->OutputPointsPrecision == DOUBLE_PRECISION ||
    (this->OutputPointsPrecision == DEFAULT_PRECISION && set && set->GetPoints() &&
      set->GetPoints()->GetDataType() == VTK_DOUBLE);
  const vtkIdType pointCount = static_cast<vtkIdType>(sizes.points);
  vtkNew<vtkPoints> points;
  points->SetDataType(isDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(pointCount);
  vtkNew<vtkFloatArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(this->ComputeNormals ? pointCount : 0);
  vtkNew<vtkFloatArray> parameter;
  parameter->SetName("SegmentParameter");
  parameter->SetNumberOfTuples(pointCount);
  vtkNew<vtkTypeInt64Array> offsets;
  offsets->SetNumberOfTuples(static_cast<vtkIdType>(sizes.triangles) + 1);
  vtkNew<vtkTypeInt64Array> connectivity;
  connectivity->SetNumberOfTuples(3 * static_cast<vtkIdType>(sizes.triangles));
  for (vtkDataArray* array : { points->GetData(), static_cast<vtkDataArray*>(normals),
         static_cast<vtkDataArray*>(connectivity) })
  {
    vtkChiAdvisePages(array);
  }
  std::vector<std::int64_t> cells(sizes.triangles), segments(sizes.triangles),
    components(this->ExtractComponents ? sizes.triangles : 0);
  chi_fiber_outputs outputs = {};
  outputs.struct_size = sizeof outputs;
  outputs.points = points->GetVoidPointer(0);
  outputs.point_type = isDouble ? CHI_F64 : CHI_F32;
  outputs.normals = this->ComputeNormals ? normals->GetPointer(0) : nullptr;
  outputs.segment_parameter = parameter->GetPointer(0);
  outputs.offsets = reinterpret_cast<int64_t*>(offsets->GetPointer(0));
  outputs.connectivity = reinterpret_cast<int64_t*>(connectivity->GetPointer(0));
  outputs.segment_ids = segments.data();
  outputs.cell_ids = cells.data();
  outputs.component_ids = this->ExtractComponents ? components.data() : nullptr;
  status = chi_fiber_write(exec.Get(), internal.Fiber, &outputs);
  vtkNew<vtkUnsignedCharArray> mask;
  mask->SetName("FiberMask");
  if (status == CHI_OK && this->GenerateMask)
  {
    mask->SetNumberOfTuples(input->GetNumberOfCells());
    status = chi_fiber_mask(exec.Get(), internal.Fiber, mask->GetPointer(0));
  }
  status = status == CHI_OK
    ? vtkChiCarryPointData(exec.Get(), internal.Fiber, chi_fiber_attribute, chi_fiber_nearest,
        input->GetPointData(), output->GetPointData(), pointCount)
    : status;
  if (status != CHI_OK)
  {
    output->Initialize();
    if (status != CHI_ERROR_CANCELLED)
    {
      vtkErrorMacro("writing the fiber surface failed: " << chi_status_string(status));
    }
    return status == CHI_ERROR_CANCELLED;
  }

  // 5. Attach.
  vtkNew<vtkCellArray> triangles;
  triangles->SetData(offsets, connectivity);
  output->SetPoints(points);
  output->SetPolys(triangles);
  if (this->ComputeNormals)
  {
    output->GetPointData()->SetNormals(normals);
  }
  output->GetPointData()->AddArray(parameter);
  vtkChiCarryCellData(input->GetCellData(), output->GetCellData(), cells);
  auto ids = NewIds("SegmentId", segments.size());
  std::copy(segments.begin(), segments.end(), ids->GetPointer(0));
  output->GetCellData()->AddArray(ids);
  if (this->ExtractComponents)
  {
    ids = NewIds("ComponentId", components.size());
    std::copy(components.begin(), components.end(), ids->GetPointer(0));
    output->GetCellData()->AddArray(ids);
  }
  if (masked && this->GenerateMask)
  {
    masked->GetCellData()->AddArray(mask);
  }

  // 6. What is enclosed; an error leaves nothing of the surface either.
  if (this->GenerateEnclosedCells &&
    !this->Enclose(input, vtkUnstructuredGrid::GetData(outputVector, 2), isDouble))
  {
    output->Initialize();
    masked->Initialize();
    return 0;
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkChiFiberSurface::Enclose(vtkDataSet* input, vtkUnstructuredGrid* output, bool isDouble)
{
  const vtkChiExec exec(this);
  chi_fiber* const fiber = this->Internal->Fiber;
  chi_fiber_enclosed_sizes sizes = {};
  chi_status status = chi_fiber_enclose(exec.Get(), fiber, &sizes);
  if (status == CHI_ERROR_INVALID_ARGUMENT && sizes.open_segments > 0)
  {
    vtkErrorMacro("the polygon encloses nothing, since lines with "
      << sizes.open_segments
      << " of its segments do not end where they begin; CloseLines closes them");
    return 0;
  }
  output->GetFieldData()->PassData(input->GetFieldData());
  vtkNew<vtkPoints> points;
  points->SetDataType(isDouble ? VTK_DOUBLE : VTK_FLOAT);
  vtkNew<vtkTypeInt64Array> offsets, connectivity;
  std::vector<std::int64_t> cells(sizes.cells);
  if (status == CHI_OK)
  {
    points->SetNumberOfPoints(static_cast<vtkIdType>(sizes.points));
    offsets->SetNumberOfTuples(static_cast<vtkIdType>(sizes.cells) + 1);
    connectivity->SetNumberOfTuples(4 * static_cast<vtkIdType>(sizes.cells));
    vtkChiAdvisePages(points->GetData());
    vtkChiAdvisePages(connectivity);
    chi_fiber_enclosed_outputs outputs = {};
    outputs.struct_size = sizeof outputs;
    outputs.points = points->GetVoidPointer(0);
    outputs.point_type = isDouble ? CHI_F64 : CHI_F32;
    outputs.offsets = reinterpret_cast<int64_t*>(offsets->GetPointer(0));
    outputs.connectivity = reinterpret_cast<int64_t*>(connectivity->GetPointer(0));
    outputs.cell_ids = cells.data();
    status = chi_fiber_enclosed_write(exec.Get(), fiber, &outputs);
  }
  status = status == CHI_OK ? vtkChiCarryPointData(exec.Get(), fiber, chi_fiber_enclosed_attribute,
                                chi_fiber_enclosed_nearest, input->GetPointData(),
                                output->GetPointData(), static_cast<vtkIdType>(sizes.points))
                            : status;
  if (status != CHI_OK)
  {
    output->Initialize();
    if (status != CHI_ERROR_CANCELLED)
    {
      vtkErrorMacro("cutting out what the polygon encloses failed: " << chi_status_string(status));
    }
    return status == CHI_ERROR_CANCELLED;
  }
  vtkNew<vtkCellArray> tetrahedra;
  tetrahedra->SetData(offsets, connectivity);
  output->SetPoints(points);
  output->SetCells(VTK_TETRA, tetrahedra);
  vtkChiCarryCellData(input->GetCellData(), output->GetCellData(), cells);
  this->EnclosedVolume = sizes.volume;
  return 1;
}

//------------------------------------------------------------------------------
void vtkChiFiberSurface::SetComponent(int array, int component)
{
  if (array < 0 || array > 1 || component < -1)
  {
    vtkErrorMacro("SetComponent(" << array << ", " << component
                                  << "): arrays are 0 and 1, components -1 (magnitude), 0 ...");
  }
  else if (this->Component[array] != component)
  {
    this->Component[array] = component;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkChiFiberSurface::GetComponent(int array) const
{
  return array == 0 || array == 1 ? this->Component[array] : 0;
}

//------------------------------------------------------------------------------
vtkIdType vtkChiFiberSurface::GetNumberOfSkipped(int kind) const
{
  for (int k = 0; k < CHI_FIBER_SKIP_KINDS; ++k)
  {
    if (kind == 1 << k)
    {
      return static_cast<vtkIdType>(this->Internal->Sizes.skipped[k]);
    }
  }
  return 0;
}

//------------------------------------------------------------------------------
void vtkChiFiberSurface::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Component: " << this->Component[0] << ", " << this->Component[1] << "\n";
  os << indent << "CloseLines: " << this->CloseLines << "\n";
  os << indent << "SplitCorners: " << this->SplitCorners << "\n";
  os << indent << "ComputeNormals: " << this->ComputeNormals << "\n";
  os << indent << "ExtractComponents: " << this->ExtractComponents << "\n";
  os << indent << "MinimumArea: " << this->MinimumArea << "\n";
  os << indent << "GenerateMask: " << this->GenerateMask << "\n";
  os << indent << "GenerateEnclosedCells: " << this->GenerateEnclosedCells << "\n";
  os << indent << "EnclosedVolume: " << this->EnclosedVolume << "\n";
  os << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
  os << indent << "SkippingMask: " << this->SkippingMask << "\n";
  os << indent << "NumberOfSegments: " << this->NumberOfSegments << "\n";
  os << indent << "NumberOfCrossings: " << this->NumberOfCrossings << "\n";
  os << indent << "NumberOfSkippedCells: " << this->NumberOfSkippedCells << "\n";
  os << indent << "NumberOfComponents: " << this->NumberOfComponents << "\n";
}
