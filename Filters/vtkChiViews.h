// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiViews_h
#define vtkChiViews_h

#include <chiaroscuro/chi.h>

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkTypeInt64Array.h"

#include <type_traits>

// Lends VTK's arrays to the C core: what lies in memory as the core reads it is borrowed, anything
// else is converted once and owned here. The source stays referenced while the view lives.

// The core's type code of a VTK type; 0 where there is none (bits, strings, variants).
inline chi_type vtkChiType(int type)
{
  switch (type)
  {
    case VTK_FLOAT:
      return CHI_F32;
    case VTK_DOUBLE:
      return CHI_F64;
    case VTK_CHAR:
      return std::is_signed<char>::value ? CHI_I8 : CHI_U8;
    case VTK_SIGNED_CHAR:
      return CHI_I8;
    case VTK_UNSIGNED_CHAR:
      return CHI_U8;
    case VTK_SHORT:
      return CHI_I16;
    case VTK_UNSIGNED_SHORT:
      return CHI_U16;
    case VTK_INT:
      return CHI_I32;
    case VTK_UNSIGNED_INT:
      return CHI_U32;
    case VTK_LONG:
      return sizeof(long) == 8 ? CHI_I64 : CHI_I32;
    case VTK_UNSIGNED_LONG:
      return sizeof(long) == 8 ? CHI_U64 : CHI_U32;
    case VTK_LONG_LONG:
      return CHI_I64;
    case VTK_UNSIGNED_LONG_LONG:
      return CHI_U64;
    case VTK_ID_TYPE:
      return sizeof(vtkIdType) == 8 ? CHI_I64 : CHI_I32;
    default:
      return 0;
  }
}

// Tuples of any type that the core can read.
class vtkChiArrayView
{
public:
  // With `asReal`, integers become double.
  explicit vtkChiArrayView(vtkDataArray* array, bool asReal = false)
    : Array(array)
  {
    const int type = array->GetDataType();
    const bool isReal = type == VTK_FLOAT || type == VTK_DOUBLE;
    if ((asReal && !isReal) || !vtkChiType(type) || !array->HasStandardMemoryLayout())
    {
      vtkNew<vtkDoubleArray> copy;
      copy->DeepCopy(array);
      this->Array = copy;
    }
    this->View.data = this->Array->GetVoidPointer(0);
    this->View.count = static_cast<size_t>(this->Array->GetNumberOfTuples());
    this->View.components = static_cast<size_t>(this->Array->GetNumberOfComponents());
    this->View.type = vtkChiType(this->Array->GetDataType());
    this->View.stride = this->View.components * chi_type_size(this->View.type);
  }
  vtkChiArrayView(const vtkChiArrayView&) = delete;
  void operator=(const vtkChiArrayView&) = delete;

  // Whether the core reads the array itself, so that results are of its type.
  static bool IsDirect(vtkDataArray* array)
  {
    return array && vtkChiType(array->GetDataType()) && array->HasStandardMemoryLayout();
  }

  const chi_array_view* Get() const { return &this->View; }

private:
  vtkSmartPointer<vtkDataArray> Array;
  chi_array_view View = {};
};

// Points and polylines of a data set.
class vtkChiLinesView
{
public:
  vtkChiLinesView(vtkPoints* points, vtkCellArray* lines)
    : Points(points->GetData(), true)
    , Cells(lines)
  {
    const chi_array_view& p = *this->Points.Get();
    this->View.points = { p.data, p.count, p.stride, p.type };
    this->View.line_count = static_cast<size_t>(lines->GetNumberOfCells());
    if (this->View.line_count == 0)
    {
      return;
    }
    if (lines->IsStorage64Bit())
    {
      this->Offsets = lines->GetOffsetsArray64();
      this->Connectivity = lines->GetConnectivityArray64();
    }
    else
    {
      this->Offsets = vtkSmartPointer<vtkTypeInt64Array>::New();
      this->Offsets->DeepCopy(lines->GetOffsetsArray());
      this->Connectivity = vtkSmartPointer<vtkTypeInt64Array>::New();
      this->Connectivity->DeepCopy(lines->GetConnectivityArray());
    }
    static_assert(sizeof(vtkTypeInt64) == sizeof(int64_t), "ids are 64 bits wide");
    this->View.offsets = reinterpret_cast<const int64_t*>(this->Offsets->GetPointer(0));
    this->View.connectivity = reinterpret_cast<const int64_t*>(this->Connectivity->GetPointer(0));
  }
  vtkChiLinesView(const vtkChiLinesView&) = delete;
  void operator=(const vtkChiLinesView&) = delete;

  const chi_lines_view* Get() const { return &this->View; }

private:
  vtkChiArrayView Points;
  vtkSmartPointer<vtkCellArray> Cells;
  vtkSmartPointer<vtkTypeInt64Array> Offsets, Connectivity;
  chi_lines_view View = {};
};

#endif
