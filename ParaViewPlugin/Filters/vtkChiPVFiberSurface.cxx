// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiPVFiberSurface.h"

#include "vtkChiSelectArray.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkChiPVFiberSurface);

//------------------------------------------------------------------------------
void vtkChiPVFiberSurface::SelectFirstArray(
  int, int port, int connection, int association, const char* name)
{
  vtkChiSelectArray(this, 0, port, connection, association, name);
}

void vtkChiPVFiberSurface::SelectSecondArray(
  int, int port, int connection, int association, const char* name)
{
  vtkChiSelectArray(this, 1, port, connection, association, name);
}

//------------------------------------------------------------------------------
void vtkChiPVFiberSurface::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
