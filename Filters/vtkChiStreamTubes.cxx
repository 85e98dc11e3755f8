// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiStreamTubes.h"

#include "vtkCellData.h"
#include "vtkChiCarry.h"
#include "vtkChiExec.h"
#include "vtkChiPages.h"
#include "vtkChiViews.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

#include <vtksys/SystemInformation.hxx>

#include <chiaroscuro/chi_tube.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

vtkStandardNewMacro(vtkChiStreamTubes);

struct vtkChiStreamTubes::Internals
{
  // What the fit was made from; a change of anything else keeps it.
  std::tuple<vtkPoints*, vtkMTimeType, vtkCellArray*, vtkMTimeType, double, int> Key;
  std::unique_ptr<vtkChiLinesView> Lines;
  chi_spline* Spline = nullptr;
  chi_tube* Tube = nullptr;

  ~Internals()
  {
    chi_tube_destroy(nullptr, this->Tube);
    chi_spline_destroy(nullptr, this->Spline);
  }
};

vtkChiStreamTubes::vtkChiStreamTubes()
  : Internal(new Internals)
{
  this->SetNumberOfOutputPorts(2);
}

vtkChiStreamTubes::~vtkChiStreamTubes() = default;

namespace
{
using ViewList = std::vector<std::unique_ptr<vtkChiArrayView>>;

// Everything that the steps of one RequestData share.
struct Request
{
  vtkPolyData* Input;
  vtkPolyData* Output;
  vtkPolyData* Curves;
  const chi_exec* Exec;
  const chi_tube* Tube;
  chi_tube_sizes Sizes;
};

// The name under which a message speaks of an array.
std::string NameOf(vtkAbstractArray* array)
{
  return array->GetName() ? std::string("\"") + array->GetName() + "\"" : std::string("(unnamed)");
}

chi_status CarryPointData(const Request& r, int target, vtkPolyData* output)
{
  vtkPointData* const in = r.Input->GetPointData();
  const size_t count = target == CHI_TUBE_SURFACE ? r.Sizes.points : r.Sizes.curve_points;
  vtkSmartPointer<vtkIdList> nearest;
  for (int i = 0; i < in->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const source = in->GetAbstractArray(i);
    auto array = vtkChiNewLike(source, static_cast<vtkIdType>(count));
    vtkDataArray* const numbers = vtkDataArray::SafeDownCast(source);
    vtkDataArray* const result = vtkDataArray::SafeDownCast(array);
    if (count > 0 && vtkChiArrayView::IsDirect(numbers) && vtkChiArrayView::IsDirect(result))
    {
      const vtkChiArrayView view(numbers);
      const chi_status status = chi_tube_attribute(
        r.Exec, r.Tube, target, view.Get(), result->GetVoidPointer(0), view.Get()->stride);
      if (status != CHI_OK)
      {
        return status;
      }
    }
    else if (count > 0)
    {
      if (!nearest)
      {
        std::vector<int64_t> ids(count);
        const chi_status status = chi_tube_nearest(r.Exec, r.Tube, target, ids.data());
        if (status != CHI_OK)
        {
          return status;
        }
        nearest = vtkChiToIdList(ids);
      }
      source->GetTuples(nearest, array);
    }
    vtkChiAddLike(output->GetPointData(), array, in, i);
  }
  return CHI_OK;
}

// Cell data of the lines, which follow the vertices in the cells' order.
void CarryCellData(const Request& r, vtkPolyData* output, const std::vector<int64_t>& lines)
{
  vtkCellData* const in = r.Input->GetCellData();
  const auto ids = vtkChiToIdList(lines, r.Input->GetNumberOfVerts());
  for (int i = 0; i < in->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const source = in->GetAbstractArray(i);
    auto array = vtkChiNewLike(source, ids->GetNumberOfIds());
    if (ids->GetNumberOfIds() > 0)
    {
      source->GetTuples(ids, array);
    }
    vtkChiAddLike(output->GetCellData(), array, in, i);
  }
  vtkNew<vtkIdTypeArray> lineIds;
  lineIds->SetName("LineId");
  lineIds->SetNumberOfTuples(static_cast<vtkIdType>(lines.size()));
  std::copy(lines.begin(), lines.end(), lineIds->GetPointer(0));
  output->GetCellData()->AddArray(lineIds);
}

// Second texture mode: the carried scalars in place of the length.
void ScalarsToTCoords(vtkDataArray* scalars, double length, float* tcoords)
{
  for (vtkIdType i = 0; scalars && i < scalars->GetNumberOfTuples(); ++i)
  {
    tcoords[2 * i] = static_cast<float>(scalars->GetComponent(i, 0) / length);
  }
}

bool FitsInMemory(uint64_t bytes, uint64_t& available)
{
  vtksys::SystemInformation info;
  info.RunMemoryCheck();
  available = static_cast<uint64_t>(info.GetHostMemoryAvailable()) * 1024;
  return available == 0 || bytes <= available;
}
}

//------------------------------------------------------------------------------
int vtkChiStreamTubes::RequestData(vtkInformation* vtkNotUsed(request),
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* const input = vtkPolyData::GetData(inputVector[0]);
  Request r = { input, vtkPolyData::GetData(outputVector, 0), vtkPolyData::GetData(outputVector, 1),
    nullptr, nullptr, {} };
  Internals& internal = *this->Internal;

  this->MaximumError = 0;
  this->NumberOfControlPoints = this->NumberOfSkippedLines = this->NumberOfClampedRadii = 0;
  this->NumberOfRemovedPoints = this->NumberOfRemovedRings = 0;
  this->NumberOfClippedLines = this->NumberOfShortLines = 0;
  r.Output->GetFieldData()->PassData(input->GetFieldData());
  if (input->GetNumberOfPolys() > 0 || input->GetNumberOfStrips() > 0)
  {
    vtkWarningMacro("the input's polygons and strips are not lines and are ignored");
  }
  else if (input->GetNumberOfVerts() > 0 && input->GetNumberOfLines() == 0)
  {
    vtkWarningMacro("the input's vertices are not lines and are ignored");
  }
  if (!input->GetPoints() || input->GetNumberOfLines() == 0)
  {
    return 1; // an empty piece is a normal event in a streamed pipeline
  }

  // Lengths from fractions of the extent of what is finite.
  double bounds[6];
  input->GetBounds(bounds);
  double extent = std::sqrt(
    vtkMath::Distance2BetweenPoints(std::array<double, 3>{ bounds[0], bounds[2], bounds[4] }.data(),
      std::array<double, 3>{ bounds[1], bounds[3], bounds[5] }.data()));
  extent = std::isfinite(extent) && extent > 0 ? extent : 1;
  const double tolerance =
    std::max(this->Tolerance * (this->ToleranceIsRelative ? extent : 1), 1e-12 * extent);
  const double radius = this->Radius * (this->RadiusIsRelative ? extent : 1);
  if (!(radius > 0))
  {
    vtkErrorMacro("Radius is " << this->Radius << "; tubes need a radius above zero");
    return 0;
  }

  const vtkChiExec exec(this);
  r.Exec = exec.Get();
  const auto failed = [this](const char* call, chi_status status)
  {
    if (status != CHI_OK && status != CHI_ERROR_CANCELLED)
    {
      vtkErrorMacro(<< call << " failed: " << chi_status_string(status));
    }
    return status != CHI_OK;
  };

  // 1. Fit, unless the last one still stands.
  const int method = this->SplineFitting ? CHI_SPLINE_PROGRESSIVE : CHI_SPLINE_POLYLINE;
  const auto key = std::make_tuple(input->GetPoints(), input->GetPoints()->GetMTime(),
    input->GetLines(), input->GetLines()->GetMTime(), tolerance, method);
  if (!internal.Lines || key != internal.Key)
  {
    internal.Lines.reset(new vtkChiLinesView(input->GetPoints(), input->GetLines()));
    chi_spline_params fit = {};
    fit.struct_size = sizeof fit;
    fit.tolerance = tolerance;
    fit.method = method;
    chi_status status = CHI_OK;
    if (!internal.Spline)
    {
      status = chi_spline_create(nullptr, &internal.Spline);
    }
    if (!internal.Tube && status == CHI_OK)
    {
      status = chi_tube_create(nullptr, &internal.Tube);
    }
    status = status == CHI_OK ? chi_spline_fit(r.Exec, internal.Spline, internal.Lines->Get(), &fit)
                              : status;
    if (status != CHI_OK)
    {
      internal.Lines.reset();
      failed("the spline fit of the lines", status);
      return status == CHI_ERROR_CANCELLED;
    }
    internal.Key = key;
    ++this->NumberOfFits;
  }
  chi_spline_stats stats;
  chi_spline_get_stats(internal.Spline, &stats);
  this->MaximumError = stats.max_error;
  this->NumberOfControlPoints = static_cast<vtkIdType>(stats.coefficients);
  this->NumberOfSkippedLines = static_cast<vtkIdType>(stats.skipped_lines);
  this->NumberOfRemovedPoints =
    static_cast<vtkIdType>(stats.repeated_points + stats.non_finite_points);
  if (stats.skipped_lines > 0)
  {
    vtkWarningMacro(<< stats.skipped_lines << " lines have no tube: "
                    << stats.skipped[CHI_SPLINE_TOO_FEW_POINTS] << " of fewer than two points, "
                    << stats.skipped[CHI_SPLINE_ALL_EQUAL] << " of coinciding points, "
                    << stats.skipped[CHI_SPLINE_NOT_FINITE] << " of points that are not finite");
  }
  if (stats.unconverged > 0)
  {
    vtkWarningMacro(<< stats.unconverged << " lines could not be fitted within the tolerance "
                    << tolerance << "; the largest distance of a point is "
                    << stats.max_point_error);
  }

  // 2. Choose rings.
  std::unique_ptr<vtkChiArrayView> radii;
  ViewList views;
  std::vector<const chi_array_view*> attributes;
  chi_tube_params params = {};
  params.struct_size = sizeof params;
  params.radius = radius;
  params.sides = this->NumberOfSides;
  params.frame = this->Frame;
  params.cap = this->Capping;
  params.cells = this->GenerateTriangles ? CHI_TUBE_TRIANGLES : CHI_TUBE_STRIPS;
  params.limit_radius = this->LimitRadiusToCurvature;
  params.keep_rings = !this->SplineFitting;
  params.chord_tolerance = tolerance;
  params.angular_tolerance_rad = vtkMath::RadiansFromDegrees(this->AngularTolerance);
  params.attribute_tolerance = this->AttributeTolerance;
  params.min_length = this->MinimumLength;
  params.clip_box = this->UseClipBox ? this->ClipBox : nullptr;
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  const bool wantsArray =
    this->UseRadiusArray && this->GetInformation()->Has(vtkAlgorithm::INPUT_ARRAYS_TO_PROCESS());
  vtkDataArray* const radiusArray =
    wantsArray ? this->GetInputArrayToProcess(0, input, association) : nullptr;
  if (wantsArray && !radiusArray)
  {
    vtkErrorMacro("the radius array chosen by SetInputArrayToProcess is not in the input");
    return 0;
  }
  std::vector<double> ofLines;
  chi_array_view lineRadii = {};
  if (radiusArray)
  {
    const bool ofPoints = association == vtkDataObject::FIELD_ASSOCIATION_POINTS;
    double range[2];
    radiusArray->GetRange(range, 0);
    if (radiusArray->GetNumberOfComponents() != 1 || range[0] < 0)
    {
      vtkErrorMacro("radius array " << NameOf(radiusArray) << " has "
                                    << radiusArray->GetNumberOfComponents()
                                    << " components and values from " << range[0]
                                    << "; it needs one component and no negative values");
      return 0;
    }
    if (ofPoints)
    {
      radii.reset(new vtkChiArrayView(radiusArray, true));
      params.point_radius = radii->Get();
    }
    else
    {
      const vtkIdType first = input->GetNumberOfVerts();
      for (vtkIdType i = 0; i < input->GetNumberOfLines(); ++i)
      {
        ofLines.push_back(radiusArray->GetComponent(first + i, 0));
      }
      lineRadii = { ofLines.data(), ofLines.size(), 1, sizeof(double), CHI_F64 };
      params.line_radius = &lineRadii;
    }
  }
  for (int i = 0; i < input->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = input->GetPointData()->GetArray(i);
    if (array && (array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE))
    {
      views.emplace_back(new vtkChiArrayView(array, true));
      attributes.push_back(views.back()->Get());
    }
  }
  params.attributes = attributes.data();
  params.attribute_count = attributes.size();
  const chi_status planned =
    chi_tube_plan(r.Exec, internal.Tube, internal.Spline, internal.Lines->Get(), &params);
  if (planned == CHI_ERROR_INVALID_ARGUMENT && radiusArray)
  {
    vtkErrorMacro("radius array " << NameOf(radiusArray)
                                  << " has values that are not finite, or too few of them");
    return 0;
  }
  if (failed("the choice of rings", planned))
  {
    return 0;
  }
  r.Tube = internal.Tube;
  r.Sizes.struct_size = sizeof r.Sizes;
  chi_tube_get_sizes(r.Tube, &r.Sizes);
  this->NumberOfClampedRadii = static_cast<vtkIdType>(r.Sizes.clamped_radii);
  this->NumberOfRemovedRings = static_cast<vtkIdType>(r.Sizes.removed_rings);
  this->NumberOfClippedLines = static_cast<vtkIdType>(r.Sizes.outside_lines);
  this->NumberOfShortLines = static_cast<vtkIdType>(r.Sizes.short_lines);

  // 3. Allocate, if it fits.
  uint64_t available = 0;
  if (!FitsInMemory(r.Sizes.bytes, available))
  {
    vtkErrorMacro("the tubes need " << r.Sizes.bytes / 1048576 << " MiB and " << available / 1048576
                                    << " MiB are free; use fewer sides or a larger tolerance");
    return 0;
  }
  const bool isDouble = this->OutputPointsPrecision == DOUBLE_PRECISION ||
    (this->OutputPointsPrecision == DEFAULT_PRECISION &&
      input->GetPoints()->GetDataType() == VTK_DOUBLE);
  const vtkIdType pointCount = static_cast<vtkIdType>(r.Sizes.points);
  vtkNew<vtkPoints> points;
  points->SetDataType(isDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(pointCount);
  vtkNew<vtkFloatArray> normals;
  normals->SetName("TubeNormals");
  normals->SetNumberOfComponents(3);
  normals->SetNumberOfTuples(pointCount);
  vtkNew<vtkFloatArray> parameter;
  parameter->SetName("CurveParameter");
  parameter->SetNumberOfTuples(pointCount);
  vtkNew<vtkFloatArray> tcoords;
  tcoords->SetName("TCoords");
  tcoords->SetNumberOfComponents(2);
  tcoords->SetNumberOfTuples(this->GenerateTCoords == TCOORDS_OFF ? 0 : pointCount);
  vtkNew<vtkTypeInt64Array> offsets;
  offsets->SetNumberOfTuples(static_cast<vtkIdType>(r.Sizes.cells) + 1);
  vtkNew<vtkTypeInt64Array> connectivity;
  connectivity->SetNumberOfTuples(static_cast<vtkIdType>(r.Sizes.connectivity));
  // Without a fit and without losses the curves are the input's own lines: nothing to copy.
  const bool sameCurves = !this->SplineFitting && this->NumberOfRemovedPoints == 0 &&
    r.Sizes.curves == static_cast<size_t>(input->GetNumberOfLines()) &&
    input->GetNumberOfCells() == input->GetNumberOfLines();
  vtkNew<vtkPoints> curvePoints;
  curvePoints->SetDataType(VTK_DOUBLE);
  curvePoints->SetNumberOfPoints(sameCurves ? 0 : static_cast<vtkIdType>(r.Sizes.curve_points));
  vtkNew<vtkTypeInt64Array> curveOffsets;
  curveOffsets->SetNumberOfTuples(static_cast<vtkIdType>(r.Sizes.curves) + 1);
  std::vector<int64_t> lineIds(r.Sizes.cells), curveIds(r.Sizes.curves);

  for (vtkDataArray* array : { points->GetData(), static_cast<vtkDataArray*>(normals),
         static_cast<vtkDataArray*>(parameter), static_cast<vtkDataArray*>(connectivity) })
  {
    vtkChiAdvisePages(array);
  }

  // 4. Sweep and carry.
  chi_tube_outputs outputs = {};
  outputs.struct_size = sizeof outputs;
  outputs.points = points->GetVoidPointer(0);
  outputs.point_type = isDouble ? CHI_F64 : CHI_F32;
  outputs.normals = normals->GetPointer(0);
  outputs.tcoords = this->GenerateTCoords == TCOORDS_OFF ? nullptr : tcoords->GetPointer(0);
  outputs.tcoord_length = this->GenerateTCoords == TCOORDS_FROM_LENGTH ? this->TextureLength : 0;
  outputs.parameter = parameter->GetPointer(0);
  outputs.line_ids = lineIds.data();
  outputs.offsets = reinterpret_cast<int64_t*>(offsets->GetPointer(0));
  outputs.connectivity = reinterpret_cast<int64_t*>(connectivity->GetPointer(0));
  outputs.curve_points =
    sameCurves ? nullptr : static_cast<double*>(curvePoints->GetVoidPointer(0));
  outputs.curve_offsets = reinterpret_cast<int64_t*>(curveOffsets->GetPointer(0));
  outputs.curve_line_ids = curveIds.data();
  chi_status status = chi_tube_sweep(r.Exec, r.Tube, &outputs);
  status = status == CHI_OK ? CarryPointData(r, CHI_TUBE_SURFACE, r.Output) : status;
  status = status == CHI_OK && !sameCurves ? CarryPointData(r, CHI_TUBE_CURVES, r.Curves) : status;
  if (status != CHI_OK)
  {
    r.Output->Initialize();
    r.Curves->Initialize();
    return !failed("the sweep of the tubes", status) || status == CHI_ERROR_CANCELLED;
  }

  // 5. Attach.
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);
  r.Output->SetPoints(points);
  if (this->GenerateTriangles)
  {
    r.Output->SetPolys(cells);
  }
  else
  {
    r.Output->SetStrips(cells);
  }
  r.Output->GetPointData()->SetNormals(normals);
  r.Output->GetPointData()->AddArray(parameter);
  if (this->GenerateTCoords != TCOORDS_OFF)
  {
    if (this->GenerateTCoords == TCOORDS_FROM_SCALARS)
    {
      ScalarsToTCoords(
        r.Output->GetPointData()->GetScalars(), this->TextureLength, tcoords->GetPointer(0));
    }
    r.Output->GetPointData()->SetTCoords(tcoords);
  }
  CarryCellData(r, r.Output, lineIds);

  if (sameCurves)
  {
    r.Curves->SetPoints(input->GetPoints());
    r.Curves->SetLines(input->GetLines());
    r.Curves->GetPointData()->PassData(input->GetPointData());
  }
  else
  {
    vtkNew<vtkTypeInt64Array> curveConnectivity;
    curveConnectivity->SetNumberOfTuples(curvePoints->GetNumberOfPoints());
    for (vtkIdType i = 0; i < curvePoints->GetNumberOfPoints(); ++i)
    {
      curveConnectivity->SetValue(i, i);
    }
    vtkNew<vtkCellArray> curveCells;
    curveCells->SetData(curveOffsets, curveConnectivity);
    r.Curves->SetPoints(curvePoints);
    r.Curves->SetLines(curveCells);
  }
  CarryCellData(r, r.Curves, curveIds);
  return 1;
}

//------------------------------------------------------------------------------
void vtkChiStreamTubes::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Tolerance: " << this->Tolerance
     << (this->ToleranceIsRelative ? " (relative)\n" : "\n");
  os << indent << "SplineFitting: " << this->SplineFitting << "\n";
  os << indent << "Radius: " << this->Radius << (this->RadiusIsRelative ? " (relative)\n" : "\n");
  os << indent << "UseRadiusArray: " << this->UseRadiusArray << "\n";
  os << indent << "NumberOfSides: " << this->NumberOfSides << "\n";
  os << indent << "AngularTolerance: " << this->AngularTolerance << "\n";
  os << indent << "AttributeTolerance: " << this->AttributeTolerance << "\n";
  os << indent << "Capping: " << this->Capping << "\n";
  os << indent << "Frame: " << this->Frame << "\n";
  os << indent << "LimitRadiusToCurvature: " << this->LimitRadiusToCurvature << "\n";
  os << indent << "GenerateTCoords: " << this->GenerateTCoords << "\n";
  os << indent << "TextureLength: " << this->TextureLength << "\n";
  os << indent << "GenerateTriangles: " << this->GenerateTriangles << "\n";
  os << indent << "UseClipBox: " << this->UseClipBox << "\n";
  os << indent << "MinimumLength: " << this->MinimumLength << "\n";
  os << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
  os << indent << "MaximumError: " << this->MaximumError << "\n";
  os << indent << "NumberOfControlPoints: " << this->NumberOfControlPoints << "\n";
  os << indent << "NumberOfSkippedLines: " << this->NumberOfSkippedLines << "\n";
  os << indent << "NumberOfFits: " << this->NumberOfFits << "\n";
}
