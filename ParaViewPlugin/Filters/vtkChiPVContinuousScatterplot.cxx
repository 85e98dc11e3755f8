// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiPVContinuousScatterplot.h"

#include "vtkChiFieldData.h"
#include "vtkChiSelectArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkChiPVContinuousScatterplot);

//------------------------------------------------------------------------------
void vtkChiPVContinuousScatterplot::SelectFirstArray(
  int, int port, int connection, int association, const char* name)
{
  vtkChiSelectArray(this, 0, port, connection, association, name);
}

void vtkChiPVContinuousScatterplot::SelectSecondArray(
  int, int port, int connection, int association, const char* name)
{
  vtkChiSelectArray(this, 1, port, connection, association, name);
}

void vtkChiPVContinuousScatterplot::SelectWeightArray(
  int, int, int, int association, const char* name)
{
  this->WeightAssociation = association;
  this->WeightName = name ? name : "";
  this->ApplyWeight();
}

void vtkChiPVContinuousScatterplot::SetUseWeight(bool on)
{
  if (this->UseWeight != on)
  {
    this->UseWeight = on;
    this->ApplyWeight();
  }
}

void vtkChiPVContinuousScatterplot::ApplyWeight()
{
  if (this->UseWeight)
  {
    this->SetInputArrayToProcess(2, 0, 0, this->WeightAssociation, this->WeightName.c_str());
  }
  else
  {
    this->GetInputArrayInformation(2)->Clear(); // an array that was never chosen is no weight
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkChiPVContinuousScatterplot::RequestData(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  const int result = this->Superclass::RequestData(request, inputs, outputs);
  for (int port = 0; port < 2; ++port)
  {
    vtkDataObject* const output = vtkDataObject::GetData(outputs, port);
    if (result && vtkImageData::SafeDownCast(output)) // of a matrix only the last plot's are known
    {
      vtkChiAddFieldData(output, "TotalMass", this->GetTotalMass());
      vtkChiAddFieldData(output, "MassOutOfRange", this->GetMassOutOfRange());
      vtkChiAddFieldData(output, "SingularMass", this->GetSingularMass());
      vtkChiAddFieldData(output, "SplatErrorBound", this->GetSplatErrorBound());
      vtkChiAddFieldData(
        output, "NumberOfSkippedCells", static_cast<double>(this->GetNumberOfSkippedCells()));
    }
  }
  return result;
}

//------------------------------------------------------------------------------
void vtkChiPVContinuousScatterplot::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "UseWeight: " << this->UseWeight << "\n";
  os << indent << "Weight: " << this->WeightName << "\n";
}
