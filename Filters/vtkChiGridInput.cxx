// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiGridInput.h"
#include "vtkChiInputTools.h"
#include "vtkChiViews.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkExplicitStructuredGrid.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGridBase.h"
#include "vtkVersionMacros.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <iterator>

// From 9.4 on the faces of polyhedra lie in cell arrays, and the stream of faces is deprecated.
#define CHI_VTK_HAS_FACE_STREAM (VTK_VERSION_NUMBER < VTK_VERSION_CHECK(9, 4, 0))

namespace
{
//------------------------------------------------------------------------------
// A number that all bits count in: four chains, so that memory is what it waits for.
std::uint64_t mixBytes(const void* data, std::size_t bytes, std::uint64_t seed)
{
  const std::uint64_t odd = 0x9e3779b97f4a7c15u; // 2^64 / golden ratio (Knuth 1973, section 6.4)
  const auto add = [odd](std::uint64_t sum, std::uint64_t word)
  {
    sum ^= word;
    return ((sum << 31) | (sum >> 33)) * odd;
  };
  std::uint64_t lanes[4] = { seed, seed + 1, seed + 2, seed + 3 };
  const unsigned char* from = static_cast<const unsigned char*>(data);
  std::size_t at = 0;
  for (; at + sizeof(lanes) <= bytes; at += sizeof(lanes))
  {
    std::uint64_t words[4];
    std::memcpy(words, from + at, sizeof(words));
    for (int i = 0; i < 4; ++i)
    {
      lanes[i] = add(lanes[i], words[i]);
    }
  }
  for (; at < bytes; ++at)
  {
    lanes[0] = add(lanes[0], from[at]);
  }
  std::uint64_t sum = add(seed, bytes);
  for (const std::uint64_t lane : lanes)
  {
    sum = add(sum, lane);
  }
  return sum;
}

//------------------------------------------------------------------------------
vtkUnsignedCharArray* findGhosts(vtkDataSetAttributes* data)
{
  return vtkUnsignedCharArray::SafeDownCast(
    data->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()));
}

//------------------------------------------------------------------------------
std::string describeClass(vtkDataSet* input)
{
  return std::string("the input (") + input->GetClassName() + ")";
}
}

//------------------------------------------------------------------------------
void vtkChiGridInput::List(vtkDataSet* input, SourceList& sources, std::vector<double>& values)
{
  const auto add = [&sources](vtkDataArray* array, vtkMTimeType owner)
  {
    Source source;
    source.Array = array;
    if (array)
    {
      source.Time = std::max(owner, array->GetMTime());
      source.Count = array->GetNumberOfValues();
      source.Data = array->HasStandardMemoryLayout() ? array->GetVoidPointer(0) : nullptr;
    }
    sources.push_back(source);
  };
  const auto addCells = [&add](vtkCellArray* cells)
  {
    add(cells ? cells->GetOffsetsArray() : nullptr, cells ? cells->GetMTime() : 0);
    add(cells ? cells->GetConnectivityArray() : nullptr, 0);
  };
  values.push_back(input->GetDataObjectType());
  if (vtkPointSet* set = vtkPointSet::SafeDownCast(input))
  {
    vtkPoints* points = set->GetPoints();
    add(points ? points->GetData() : nullptr, points ? points->GetMTime() : 0);
  }
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  if (vtkImageData* image = vtkImageData::SafeDownCast(input))
  {
    image->GetExtent(extent);
    const double* matrix = image->GetIndexToPhysicalMatrix()->GetData();
    values.insert(values.end(), matrix, matrix + 16);
  }
  else if (vtkRectilinearGrid* rectilinear = vtkRectilinearGrid::SafeDownCast(input))
  {
    rectilinear->GetExtent(extent);
    add(rectilinear->GetXCoordinates(), 0);
    add(rectilinear->GetYCoordinates(), 0);
    add(rectilinear->GetZCoordinates(), 0);
  }
  else if (vtkStructuredGrid* curvilinear = vtkStructuredGrid::SafeDownCast(input))
  {
    curvilinear->GetExtent(extent);
  }
  else if (vtkExplicitStructuredGrid* explicitGrid = vtkExplicitStructuredGrid::SafeDownCast(input))
  {
    addCells(explicitGrid->GetCells());
  }
  else if (vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(input))
  {
    addCells(grid->GetCells());
    add(grid->GetCellTypesArray(), 0);
#if CHI_VTK_HAS_FACE_STREAM
    add(grid->GetFaces(), 0);
    add(grid->GetFaceLocations(), 0);
#else
    addCells(grid->GetPolyhedronFaces());
    addCells(grid->GetPolyhedronFaceLocations());
#endif
  }
  values.insert(values.end(), extent, extent + 6);
  add(findGhosts(input->GetCellData()), 0);
  add(findGhosts(input->GetPointData()), 0);
}

//------------------------------------------------------------------------------
std::uint64_t vtkChiGridInput::Print(const SourceList& sources, const std::vector<double>& values)
{
  std::uint64_t sum = mixBytes(values.data(), values.size() * sizeof(double), 0);
  for (const Source& source : sources)
  {
    if (source.Array && source.Data)
    {
      const std::size_t bytes = static_cast<std::size_t>(source.Count) *
        static_cast<std::size_t>(source.Array->GetDataTypeSize());
      sum = mixBytes(source.Data, bytes, sum);
    }
    else // what does not lie in a row is not looked at: its time decides
    {
      sum = mixBytes(&source.Time, sizeof(source.Time), sum);
    }
  }
  return sum;
}

//------------------------------------------------------------------------------
// Time stamps change more often than meshes: of the data set with its scalars, of arrays that a
// filter hands through. Where they alone have changed, the contents decide.
bool vtkChiGridInput::Collect(vtkDataSet* input)
{
  this->Problem.clear();
  this->Empty = !input;
  if (!input)
  {
    this->Problem = "there is no input";
    return false;
  }
  vtkUnstructuredGridBase* base = vtkUnstructuredGridBase::SafeDownCast(input);
  if (base && !vtkUnstructuredGrid::SafeDownCast(input))
  {
    if (this->ConvertedFrom != input || this->ConvertedTime != input->GetMTime())
    {
      this->Converted = vtkSmartPointer<vtkUnstructuredGrid>::New();
      this->Converted->DeepCopy(input);
      this->ConvertedFrom = input;
      this->ConvertedTime = input->GetMTime();
    }
    input = this->Converted;
  }
  SourceList sources;
  std::vector<double> values;
  List(input, sources, values);
  // its own, which GetMTime() hides behind that of its arrays
  const vtkMTimeType time = input->vtkObject::GetMTime();
  const auto sameArray = [](const Source& a, const Source& b)
  { return a.Array == b.Array && a.Data == b.Data && a.Count == b.Count; };
  const auto sameTime = [](const Source& a, const Source& b) { return a.Time == b.Time; };
  const auto compare = [&sources, this](const auto& same)
  {
    return std::equal(
      sources.begin(), sources.end(), this->Sources.begin(), this->Sources.end(), same);
  };
  const bool arrays = values == this->Values && compare(sameArray);
  if (arrays && time == this->Time && compare(sameTime) && this->Good)
  {
    return true;
  }
  const std::uint64_t print = Print(sources, values);
  const bool unchanged = arrays && print == this->LastPrint && this->Good;
  this->Time = time;
  this->Sources.swap(sources);
  this->Values.swap(values);
  this->LastPrint = print;
  if (unchanged)
  {
    return true;
  }
  const std::uint64_t version = this->Grid.version;
  this->Grid = {};
  this->Grid.struct_size = sizeof(this->Grid);
  this->Grid.version = version + 1;
  this->Copies.clear();
  this->Types.clear();
  this->Good = this->Borrow(input);
  return this->Good;
}

//------------------------------------------------------------------------------
bool vtkChiGridInput::Borrow(vtkDataSet* input)
{
  this->Empty = input->GetNumberOfPoints() == 0 || input->GetNumberOfCells() == 0;
  if (this->Empty)
  {
    this->Problem = describeClass(input) + " has no " +
      (input->GetNumberOfPoints() == 0 ? "points" : "cells") + ": nothing to draw";
    return false;
  }
  bool good = true;
  if (vtkImageData* image = vtkImageData::SafeDownCast(input))
  {
    this->BorrowImage(image);
  }
  else if (vtkRectilinearGrid* rectilinear = vtkRectilinearGrid::SafeDownCast(input))
  {
    this->BorrowRectilinear(rectilinear);
  }
  else if (vtkStructuredGrid* curvilinear = vtkStructuredGrid::SafeDownCast(input))
  {
    this->BorrowCurvilinear(curvilinear);
  }
  else if (vtkExplicitStructuredGrid* explicitGrid = vtkExplicitStructuredGrid::SafeDownCast(input))
  {
    good = this->BorrowExplicit(explicitGrid);
  }
  else if (vtkUnstructuredGrid* grid = vtkUnstructuredGrid::SafeDownCast(input))
  {
    good = this->BorrowUnstructured(grid);
  }
  else
  {
    this->Problem = describeClass(input) + " is of a class whose cells have no volume";
    return false;
  }
  return good && this->BorrowGhosts(input);
}

//------------------------------------------------------------------------------
void vtkChiGridInput::SetDimensions(const int dimensions[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Grid.dimensions[axis] = static_cast<std::size_t>(std::max(dimensions[axis], 1));
  }
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowImage(vtkImageData* image)
{
  int extent[6];
  image->GetExtent(extent);
  this->Grid.kind = CHI_GRID_IMAGE;
  int dimensions[3];
  image->GetDimensions(dimensions);
  this->SetDimensions(dimensions);
  double first[16];
  vtkMatrix4x4::Identity(first);
  for (int axis = 0; axis < 3; ++axis)
  {
    first[4 * axis + 3] = extent[2 * axis];
  }
  vtkMatrix4x4::Multiply4x4(
    image->GetIndexToPhysicalMatrix()->GetData(), first, this->Grid.index_to_world);
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowRectilinear(vtkRectilinearGrid* grid)
{
  this->Grid.kind = CHI_GRID_RECTILINEAR;
  int dimensions[3];
  grid->GetDimensions(dimensions);
  this->SetDimensions(dimensions);
  vtkDataArray* axes[3] = { grid->GetXCoordinates(), grid->GetYCoordinates(),
    grid->GetZCoordinates() };
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!vtkChiArrayView::IsDirect(axes[axis]))
    {
      vtkNew<vtkDoubleArray> copy;
      copy->DeepCopy(axes[axis]);
      this->Copies.emplace_back(copy);
      axes[axis] = copy;
    }
    this->Grid.axes[axis] = *vtkChiArrayView(axes[axis]).Get(); // stays: what it views is held here
  }
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowPoints(vtkPoints* points)
{
  vtkDataArray* data = points->GetData();
  const int type = data->GetDataType();
  if ((type != VTK_FLOAT && type != VTK_DOUBLE) || !data->HasStandardMemoryLayout())
  {
    vtkNew<vtkDoubleArray> copy;
    copy->DeepCopy(data);
    this->Copies.emplace_back(copy);
    data = copy;
  }
  const chi_array_view view = *vtkChiArrayView(data).Get();
  this->Grid.points = { view.data, view.count, view.stride, view.type };
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowCurvilinear(vtkStructuredGrid* grid)
{
  this->Grid.kind = CHI_GRID_CURVILINEAR;
  int dimensions[3];
  grid->GetDimensions(dimensions);
  this->SetDimensions(dimensions);
  this->BorrowPoints(grid->GetPoints());
}

//------------------------------------------------------------------------------
const std::int64_t* vtkChiGridInput::GetIds(vtkDataArray* ids)
{
  if (vtkChiType(ids->GetDataType()) != CHI_I64 || !ids->HasStandardMemoryLayout())
  {
    vtkNew<vtkTypeInt64Array> copy;
    copy->DeepCopy(ids);
    this->Copies.emplace_back(copy);
    ids = copy;
  }
  // long, long long or vtkIdType: all are 64 bits wide here
  return static_cast<const std::int64_t*>(ids->GetVoidPointer(0));
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowCells(vtkCellArray* cells)
{
  this->Grid.kind = CHI_GRID_UNSTRUCTURED;
  this->Grid.cell_count = static_cast<std::size_t>(cells->GetNumberOfCells());
  this->Grid.connectivity_count = static_cast<std::size_t>(cells->GetNumberOfConnectivityIds());
  this->Grid.offsets = this->GetIds(cells->GetOffsetsArray());
  this->Grid.connectivity = this->GetIds(cells->GetConnectivityArray());
}

//------------------------------------------------------------------------------
bool vtkChiGridInput::BorrowExplicit(vtkExplicitStructuredGrid* grid)
{
  if (!grid->GetCells())
  {
    this->Problem = describeClass(grid) + " has no cells: nothing to draw";
    return false;
  }
  this->BorrowCells(grid->GetCells());
  this->Types.assign(this->Grid.cell_count, VTK_HEXAHEDRON);
  this->Grid.cell_types = this->Types.data();
  this->BorrowPoints(grid->GetPoints());
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiGridInput::BorrowUnstructured(vtkUnstructuredGrid* grid)
{
  this->BorrowCells(grid->GetCells());
  vtkUnsignedCharArray* types = grid->GetCellTypesArray();
  if (!types || static_cast<std::size_t>(types->GetNumberOfValues()) < this->Grid.cell_count)
  {
    this->Problem = describeClass(grid) + " is broken: it has types of " +
      std::to_string(types ? types->GetNumberOfValues() : 0) + " cells, and " +
      std::to_string(this->Grid.cell_count) + " cells";
    return false;
  }
  this->Grid.cell_types = types->GetPointer(0);
  this->BorrowFaces(grid);
  this->BorrowPoints(grid->GetPoints());
  return true;
}

//------------------------------------------------------------------------------
void vtkChiGridInput::BorrowFaces(vtkUnstructuredGrid* grid)
{
#if CHI_VTK_HAS_FACE_STREAM
  vtkDataArray* faces = grid->GetFaces();
  vtkDataArray* places = grid->GetFaceLocations();
  if (!faces || !places ||
    static_cast<std::size_t>(places->GetNumberOfValues()) < this->Grid.cell_count)
  {
    return;
  }
#else
  if (!grid->GetPolyhedronFaces())
  {
    return;
  }
  vtkNew<vtkTypeInt64Array> faces;
  vtkNew<vtkTypeInt64Array> places;
  vtkNew<vtkIdList> stream;
  for (std::size_t i = 0; i < this->Grid.cell_count; ++i)
  {
    const bool has = this->Grid.cell_types[i] == VTK_POLYHEDRON;
    places->InsertNextValue(has ? faces->GetNumberOfValues() : -1);
    if (has)
    {
      grid->GetFaceStream(static_cast<vtkIdType>(i), stream);
      for (const vtkIdType value : *stream)
      {
        faces->InsertNextValue(value);
      }
    }
  }
  this->Copies.emplace_back(faces);
  this->Copies.emplace_back(places);
#endif
  this->Grid.faces = this->GetIds(faces);
  this->Grid.face_offsets = this->GetIds(places);
  this->Grid.faces_count = static_cast<std::size_t>(faces->GetNumberOfValues());
}

//------------------------------------------------------------------------------
bool vtkChiGridInput::BorrowGhosts(vtkDataSet* input)
{
  vtkUnsignedCharArray* ofCells = findGhosts(input->GetCellData());
  vtkUnsignedCharArray* ofPoints = findGhosts(input->GetPointData());
  if ((ofCells && ofCells->GetNumberOfTuples() < input->GetNumberOfCells()) ||
    (ofPoints && ofPoints->GetNumberOfTuples() < input->GetNumberOfPoints()))
  {
    this->Problem = describeClass(input) +
      " has ghosts for fewer cells or points than there are: " +
      vtkChiDescribe(
        ofCells && ofCells->GetNumberOfTuples() < input->GetNumberOfCells() ? ofCells : ofPoints);
    return false;
  }
  this->Grid.cell_ghosts = ofCells ? ofCells->GetPointer(0) : nullptr;
  this->Grid.point_ghosts = ofPoints ? ofPoints->GetPointer(0) : nullptr;
  return true;
}
