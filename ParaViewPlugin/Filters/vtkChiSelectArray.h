// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiSelectArray_h
#define vtkChiSelectArray_h

#include "vtkAlgorithm.h"
#include "vtkInformation.h"

// ParaView names no array where it knew none when the filter was made: none is chosen then.
inline void vtkChiSelectArray(
  vtkAlgorithm* algorithm, int index, int port, int connection, int association, const char* name)
{
  if (name && *name)
  {
    algorithm->SetInputArrayToProcess(index, port, connection, association, name);
  }
  else
  {
    algorithm->GetInputArrayInformation(index)->Clear();
    algorithm->Modified();
  }
}

#endif
