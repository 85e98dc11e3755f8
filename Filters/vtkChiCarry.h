// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiCarry_h
#define vtkChiCarry_h

#include "vtkAbstractArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <vector>

// What filters that carry arrays of any kind to a new mesh have in common.

// Ids of the input tuples for arrays that the core cannot carry itself.
inline vtkSmartPointer<vtkIdList> vtkChiToIdList(
  const std::vector<std::int64_t>& ids, vtkIdType offset = 0)
{
  auto list = vtkSmartPointer<vtkIdList>::New();
  list->SetNumberOfIds(static_cast<vtkIdType>(ids.size()));
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    list->SetId(static_cast<vtkIdType>(i), static_cast<vtkIdType>(ids[i]) + offset);
  }
  return list;
}

inline vtkSmartPointer<vtkAbstractArray> vtkChiNewLike(vtkAbstractArray* in, vtkIdType tuples)
{
  auto out = vtkSmartPointer<vtkAbstractArray>::Take(in->NewInstance());
  out->SetNumberOfComponents(in->GetNumberOfComponents());
  out->SetNumberOfTuples(tuples);
  out->SetName(in->GetName());
  out->CopyComponentNames(in);
  return out;
}

// Add an array under the role (scalars, vectors, ...) that the original has; normals and texture
// coordinates are the new mesh's own.
inline void vtkChiAddLike(
  vtkDataSetAttributes* out, vtkAbstractArray* array, vtkDataSetAttributes* in, int index)
{
  const int added = out->AddArray(array);
  const int role = in->IsArrayAnAttribute(index);
  if (role >= 0 && role != vtkDataSetAttributes::NORMALS && role != vtkDataSetAttributes::TCOORDS)
  {
    out->SetActiveAttribute(added, role);
  }
}

#endif
