// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiPointsView_h
#define vtkChiPointsView_h

#include <chiaroscuro/chi.h>

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"

// Borrows the points of a data set for the C core. Float and double arrays in standard layout are
// not copied; anything else is converted to double once and owned here.
class vtkChiPointsView
{
public:
  explicit vtkChiPointsView(vtkPoints* points)
    : Array(points->GetData())
  {
    const int type = this->Array->GetDataType();
    if ((type != VTK_FLOAT && type != VTK_DOUBLE) || !this->Array->HasStandardMemoryLayout())
    {
      vtkNew<vtkDoubleArray> copy;
      copy->DeepCopy(this->Array);
      this->Array = copy;
    }
    const bool isFloat = this->Array->GetDataType() == VTK_FLOAT;
    this->View.data = this->Array->GetVoidPointer(0);
    this->View.count = static_cast<size_t>(this->Array->GetNumberOfTuples());
    this->View.stride = 3 * (isFloat ? sizeof(float) : sizeof(double));
    this->View.type = isFloat ? CHI_F32 : CHI_F64;
  }
  vtkChiPointsView(const vtkChiPointsView&) = delete;
  void operator=(const vtkChiPointsView&) = delete;

  const chi_vec3_view* Get() const { return &this->View; }

private:
  vtkSmartPointer<vtkDataArray> Array;
  chi_vec3_view View = {};
};

#endif
