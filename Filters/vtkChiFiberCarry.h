// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiFiberCarry_h
#define vtkChiFiberCarry_h

// Data of a mesh's points and cells carried to what is made of them, ghost marks left behind.

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkChiCarry.h"
#include "vtkChiViews.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <chiaroscuro/chi_fiber.h>

#include <cstdint>
#include <cstring>
#include <vector>

inline bool vtkChiIsGhosts(vtkAbstractArray* array)
{
  return array->GetName() &&
    std::strcmp(array->GetName(), vtkDataSetAttributes::GhostArrayName()) == 0;
}

// To the points of a fiber surface, or of what it encloses, by the core's two calls.
template <class Attribute, class Nearest>
chi_status vtkChiCarryPointData(const chi_exec* exec, const chi_fiber* fiber, Attribute attribute,
  Nearest find, vtkPointData* in, vtkPointData* out, vtkIdType count)
{
  vtkSmartPointer<vtkIdList> nearest;
  for (int i = 0; i < in->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const source = in->GetAbstractArray(i);
    if (vtkChiIsGhosts(source)) // what they hide has no surface
    {
      continue;
    }
    auto array = vtkChiNewLike(source, count);
    vtkDataArray* const numbers = vtkDataArray::SafeDownCast(source);
    vtkDataArray* const result = vtkDataArray::SafeDownCast(array);
    if (count > 0 && vtkChiArrayView::IsDirect(numbers) && vtkChiArrayView::IsDirect(result))
    {
      const vtkChiArrayView view(numbers);
      const chi_status status =
        attribute(exec, fiber, view.Get(), result->GetVoidPointer(0), view.Get()->stride);
      if (status != CHI_OK)
      {
        return status;
      }
    }
    else if (count > 0)
    {
      if (!nearest)
      {
        std::vector<std::int64_t> ids(static_cast<std::size_t>(count));
        const chi_status status = find(exec, fiber, ids.data());
        if (status != CHI_OK)
        {
          return status;
        }
        nearest = vtkChiToIdList(ids);
      }
      source->GetTuples(nearest, array);
    }
    vtkChiAddLike(out, array, in, i);
  }
  return CHI_OK;
}

inline void vtkChiCarryCellData(
  vtkCellData* in, vtkCellData* out, const std::vector<std::int64_t>& cells)
{
  const auto ids = vtkChiToIdList(cells);
  for (int i = 0; i < in->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* const source = in->GetAbstractArray(i);
    if (!vtkChiIsGhosts(source))
    {
      auto array = vtkChiNewLike(source, ids->GetNumberOfIds());
      if (ids->GetNumberOfIds() > 0)
      {
        source->GetTuples(ids, array);
      }
      vtkChiAddLike(out, array, in, i);
    }
  }
}

#endif
