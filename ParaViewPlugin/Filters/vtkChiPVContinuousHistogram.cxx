// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiPVContinuousHistogram.h"

#include "vtkChiFieldData.h"
#include "vtkChiSelectArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

vtkStandardNewMacro(vtkChiPVContinuousHistogram);

//------------------------------------------------------------------------------
void vtkChiPVContinuousHistogram::SelectArray(
  int, int port, int connection, int association, const char* name)
{
  vtkChiSelectArray(this, 0, port, connection, association, name);
}

//------------------------------------------------------------------------------
int vtkChiPVContinuousHistogram::RequestData(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const int result = this->Superclass::RequestData(request, inputs, outputs);
  vtkTable* const table = vtkTable::GetData(outputs);
  if (result && this->GetTotalMass() > 0)
  {
    vtkChiAddFieldData(table, "Mean", this->GetMean());
    vtkChiAddFieldData(table, "Variance", this->GetVariance());
    vtkChiAddFieldData(table, "Median", this->GetQuantile(0.5));
    vtkChiAddFieldData(table, "TotalMass", this->GetTotalMass());
    vtkChiAddFieldData(table, "MassBelowRange", this->GetMassBelowRange());
    vtkChiAddFieldData(table, "MassAboveRange", this->GetMassAboveRange());
    vtkChiAddFieldData(
      table, "NumberOfSkippedCells", static_cast<double>(this->GetNumberOfSkippedCells()));
  }
  // ParaView appends the tables of all processes, and each has that of the whole.
  vtkMultiProcessController* const controller = this->GetController();
  if (controller && controller->GetLocalProcessId() > 0)
  {
    table->Initialize();
  }
  return result;
}

//------------------------------------------------------------------------------
void vtkChiPVContinuousHistogram::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
