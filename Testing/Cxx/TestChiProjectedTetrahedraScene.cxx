// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// A twisted ring of hexahedra around a ball, cut by a plane, beside its wedges: properties first,
// the baseline second.
#include "ChiTestImage.h"

#include "vtkChiProjectedTetrahedraMapper.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCellType.h"
#include "vtkColorTransferFunction.h"
#include "vtkFloatArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <cstdlib>
#include <iostream>

namespace
{
// n x m x m cells around a circle of radius 1, whose square section of half edge 0.35 turns once.
void makeRing(vtkUnstructuredGrid* ring)
{
  const int n = 48;
  const int m = 6;
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> scalars;
  scalars->SetName("wave");
  for (int i = 0; i < n; ++i)
  {
    const double around = 2.0 * vtkMath::Pi() * i / n;
    for (int j = 0; j <= m; ++j)
    {
      for (int k = 0; k <= m; ++k)
      {
        const double u = 0.35 * (2.0 * j / m - 1.0);
        const double v = 0.35 * (2.0 * k / m - 1.0);
        const double twist = 0.5 * around;
        const double out = 1.0 + u * std::cos(twist) - v * std::sin(twist);
        const double up = u * std::sin(twist) + v * std::cos(twist);
        points->InsertNextPoint(out * std::cos(around), out * std::sin(around), up);
        scalars->InsertNextValue(
          static_cast<float>(0.5 + 0.5 * std::sin(8.0 * around) * std::cos(4.0 * u)));
      }
    }
  }
  ring->SetPoints(points);
  ring->GetPointData()->SetScalars(scalars);
  const auto id = [](int i, int j, int k)
  {
    // after half a turn of the section its corners meet those of the first one, mirrored
    const bool last = i == n;
    return static_cast<vtkIdType>(
      ((last ? 0 : i) * (m + 1) + (last ? m - j : j)) * (m + 1) + (last ? m - k : k));
  };
  for (int i = 0; i < n; ++i)
  {
    for (int j = 0; j < m; ++j)
    {
      for (int k = 0; k < m; ++k)
      {
        const vtkIdType c[8] = { id(i, j, k), id(i, j + 1, k), id(i, j + 1, k + 1), id(i, j, k + 1),
          id(i + 1, j, k), id(i + 1, j + 1, k), id(i + 1, j + 1, k + 1), id(i + 1, j, k + 1) };
        if (i % 2 == 0)
        {
          ring->InsertNextCell(VTK_HEXAHEDRON, 8, c);
        }
        else
        {
          const vtkIdType wedges[2][6] = { { c[0], c[1], c[2], c[4], c[5], c[6] },
            { c[0], c[2], c[3], c[4], c[6], c[7] } };
          ring->InsertNextCell(VTK_WEDGE, 6, wedges[0]);
          ring->InsertNextCell(VTK_WEDGE, 6, wedges[1]);
        }
      }
    }
  }
}
}

int TestChiProjectedTetrahedraScene(int argc, char* argv[])
{
  vtkNew<vtkUnstructuredGrid> ring;
  makeRing(ring);
  vtkNew<vtkChiProjectedTetrahedraMapper> mapper;
  mapper->SetInputData(ring);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(-0.9, 0.0, 0.0);
  plane->SetNormal(1.0, 0.3, 0.0);
  mapper->AddClippingPlane(plane);

  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 0.1, 0.3, 0.9);
  color->AddRGBPoint(0.5, 0.95, 0.9, 0.8);
  color->AddRGBPoint(1.0, 0.9, 0.25, 0.1);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.7);
  opacity->AddPoint(0.45, 0.02);
  opacity->AddPoint(0.6, 0.05);
  opacity->AddPoint(1.0, 0.9);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetScalarOpacityUnitDistance(0.15);

  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(0.5);
  ball->SetCenter(0.55, 0.0, 0.2); // into the ring
  ball->SetThetaResolution(48);
  ball->SetPhiResolution(48);
  vtkNew<vtkPolyDataMapper> surface;
  surface->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(surface);
  actor->GetProperty()->SetColor(0.5, 0.8, 0.4);

  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  renderer->AddActor(actor);
  renderer->SetBackground(1.0, 1.0, 1.0);
  renderer->GetActiveCamera()->SetPosition(1.2, -2.6, 2.8);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.4);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetSize(300, 300);
  window->AddRenderer(renderer);
  window->Render();

  bool good = true;
  const auto claim = [&good](bool holds, const char* what)
  {
    if (!holds)
    {
      std::cerr << "does not hold: " << what << "\n";
      good = false;
    }
  };
  // 48 rings of 36 hexahedra, half of them as two wedges; a hexahedron has five tetrahedra or more
  claim(mapper->GetNumberOfTetrahedra() >= 24 * 36 * (5 + 6), "all cells are split");
  claim(mapper->GetNumberOfUnsupportedCells() == 0, "all cells are known");
  claim(
    mapper->GetNumberOfOrderViolations() == 0, "the order of a ring seen askew has no violation");
  claim(mapper->GetNumberOfFragments() > 300 * 300, "most of the picture is ring");
  window->Render();
  good = ChiTestImage::Compare(window, argc, argv, "TestChiProjectedTetrahedraScene") && good;
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
