// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTransferShapes_h
#define vtkChiTransferShapes_h

#include <chiaroscuro/chi_transfer_shapes.h>

#include <cstddef>
#include <vector>

class vtkImageData;

struct vtkChiTransferShape
{
  chi_transfer_shape Core = {}; // but for the pointers to what follows
  std::vector<double> Polygon;
  std::vector<float> Image;
};

// The shapes of a vtkChiTransferFunction2D as the core reads them.
struct vtkChiTransferShapes
{
  std::vector<vtkChiTransferShape> List;

  std::vector<chi_transfer_shape> GetCore() const;
  // How fine a table has to be for the narrowest feature along an axis; infinite without shapes.
  double GetStep(int axis) const;

  // Red, green, blue and opacity of an image, 0 ... 1; empty where it is no such image.
  static std::vector<float> ReadImage(vtkImageData* image, std::size_t size[2]);
};

#endif
