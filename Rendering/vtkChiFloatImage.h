// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiFloatImage_h
#define vtkChiFloatImage_h

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

// Makes room for a picture of floats in an image, as point scalars of that name; none where a side
// is 0.
inline vtkFloatArray* vtkChiAllocateImage(
  vtkImageData* image, int width, int height, int components, const char* name)
{
  image->Initialize();
  image->SetDimensions(width, height, width > 0 && height > 0 ? 1 : 0);
  vtkNew<vtkFloatArray> values;
  values->SetName(name);
  values->SetNumberOfComponents(components);
  values->SetNumberOfTuples(static_cast<vtkIdType>(width) * height);
  image->GetPointData()->SetScalars(values);
  return vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars());
}

#endif
