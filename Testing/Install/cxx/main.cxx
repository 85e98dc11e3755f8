// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause

// A straight line, tubed: all vertices lie on the cylinder. The mapper is made and asked, not drawn.

#include <vtkCellArray.h>
#include <vtkChiCombinedOcclusionVolumeMapper.h>
#include <vtkChiStreamTubes.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <cmath>
#include <iostream>

int main()
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(1, 2, 3);
  points->InsertNextPoint(1, 2, 5);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0, 1 });
  vtkNew<vtkPolyData> line;
  line->SetPoints(points);
  line->SetLines(cells);
  vtkNew<vtkChiStreamTubes> tubes;
  tubes->SetInputData(line);
  tubes->RadiusIsRelativeOff();
  tubes->SetRadius(0.25);
  tubes->SetNumberOfSides(8);
  tubes->Update();
  vtkPolyData* const surface = tubes->GetOutput();
  double farthest = 0, nearest = 1;
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    double x[3];
    surface->GetPoint(i, x);
    const double r = std::hypot(x[0] - 1, x[1] - 2);
    farthest = r > farthest ? r : farthest;
    nearest = r < nearest ? r : nearest;
  }
  vtkNew<vtkChiCombinedOcclusionVolumeMapper> mapper;
  mapper->SetConeAngle(30);
  std::cout << surface->GetNumberOfPoints() << " points, radius " << nearest << " to " << farthest
            << ", cone " << mapper->GetConeAngle() << "\n";
  // points are floats near 5: 2^-22 each way
  return surface->GetNumberOfPoints() >= 16 && std::abs(farthest - 0.25) < 1e-6 &&
      std::abs(nearest - 0.25) < 1e-6 && mapper->GetConeAngle() == 30
    ? 0
    : 1;
}
