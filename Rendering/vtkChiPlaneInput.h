// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiPlaneInput_h
#define vtkChiPlaneInput_h

#include <chiaroscuro/chi_transfer.h>

#include "vtkChiTransferFunction2D.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkVolumeProperty;

// The transfer function of two quantities that a mapper is to draw by, as a table for the C core:
// the mapper's own, or that of a volume property as vtkGPUVolumeRayCastMapper reads it.
class vtkChiPlaneInput
{
public:
  // The mapper's own; null: the property's, where that is in its mode TF_2D.
  void SetFunction(vtkChiTransferFunction2D* function) { this->Function = function; }
  vtkChiTransferFunction2D* GetFunction() const { return this->Function; }

  // Changes whenever the function does; 0 where none is asked for.
  std::uint64_t GetTime(vtkVolumeProperty* property) const;

  // Adds the table over the range of a component of the samples to `transfer`, -1: their magnitude;
  // `second` is the array along its y axis, null for the gradient.
  void Collect(vtkVolumeProperty* property, vtkDataArray* samples, int component,
    vtkDataArray* second, chi_transfer_view* transfer);
  // Hands that array's first component over as plain floats.
  void CollectSecond(vtkDataArray* second, chi_transfer_view* transfer);

  // Empty, or why the function is not used.
  const std::string& GetProblem() const { return this->Problem; }

private:
  bool ReadImage(vtkVolumeProperty* property, chi_transfer_view* transfer);
  bool MakeTable(chi_transfer_view* transfer);

  vtkSmartPointer<vtkChiTransferFunction2D> Function;
  std::vector<float> Table;
  std::vector<float> Second;
  std::string Problem;
};

#endif
