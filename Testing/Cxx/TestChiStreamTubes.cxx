// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// Tubes of all kinds in one picture: a closed knot coloured by an array, a helix that widens with
// round caps, a polyline with mitred corners and flat caps. Properties first, the baseline second.
#include "ChiTestImage.h"

#include "vtkChiStreamTubes.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkDataObject.h"
#include "vtkFeatureEdges.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

#include <cmath>
#include <cstdlib>
#include <iostream>

namespace
{
// One line through count points, with an array "value" from 0 to 1.
template <typename Place>
vtkNew<vtkPolyData> makeLine(int count, Place place)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> values;
  values->SetName("value");
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(count);
  for (int i = 0; i < count; ++i)
  {
    double x[3];
    place(static_cast<double>(i) / (count - 1), x);
    lines->InsertCellPoint(points->InsertNextPoint(x));
    values->InsertNextValue(static_cast<float>(i) / static_cast<float>(count - 1));
  }
  if (count > 100) // closed: the same point first and last
  {
    double first[3];
    points->GetPoint(0, first);
    points->SetPoint(count - 1, first);
  }
  vtkNew<vtkPolyData> line;
  line->SetPoints(points);
  line->SetLines(lines);
  line->GetPointData()->SetScalars(values);
  return line;
}

void addTubes(vtkRenderer* renderer, vtkChiStreamTubes* tubes, double r, double g, double b)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(tubes->GetOutputPort());
  mapper->SetScalarVisibility(r < 0);
  mapper->SetScalarRange(0, 1);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetSpecular(0.3);
  actor->GetProperty()->SetSpecularPower(30);
  if (r >= 0)
  {
    actor->GetProperty()->SetColor(r, g, b);
  }
  renderer->AddActor(actor);
}
}

int TestChiStreamTubes(int argc, char* argv[])
{
  const double pi = 3.14159265358979324;
  const auto knot = makeLine(241,
    [pi](double t, double x[3])
    {
      const double a = 2 * pi * t, r = 2 + 0.8 * std::cos(3 * a);
      x[0] = r * std::cos(2 * a);
      x[1] = r * std::sin(2 * a);
      x[2] = 0.8 * std::sin(3 * a);
    });
  const auto helix = makeLine(60,
    [pi](double t, double x[3])
    {
      x[0] = 4.3 + 0.8 * std::cos(5 * pi * t);
      x[1] = 0.8 * std::sin(5 * pi * t);
      x[2] = 5 * t - 2.5;
    });
  const auto corners = makeLine(6,
    [](double t, double x[3])
    {
      const int i = static_cast<int>(5 * t + 0.5);
      x[0] = -4.2 + 0.7 * (i & 1);
      x[1] = 0.6 * (i & 2) - 0.6;
      x[2] = 5 * t - 2.5;
    });

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  vtkNew<vtkChiStreamTubes> closed;
  closed->SetInputData(knot);
  closed->RadiusIsRelativeOff();
  closed->SetRadius(0.32);
  closed->SetNumberOfSides(20);
  addTubes(renderer, closed, -1, 0, 0);
  vtkNew<vtkChiStreamTubes> widening;
  widening->SetInputData(helix);
  widening->RadiusIsRelativeOff();
  widening->SetRadius(0.4);
  widening->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "value");
  widening->SetCappingToRound();
  widening->SetNumberOfSides(20);
  addTubes(renderer, widening, 0.85, 0.5, 0.2);
  vtkNew<vtkChiStreamTubes> mitred;
  mitred->SetInputData(corners);
  mitred->SplineFittingOff();
  mitred->RadiusIsRelativeOff();
  mitred->SetRadius(0.25);
  mitred->SetNumberOfSides(6);
  addTubes(renderer, mitred, 0.25, 0.5, 0.75);

  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetOffScreenRendering(1);
  window->SetSize(280, 200);
  window->AddRenderer(renderer);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(2, -14, 7);
  camera->SetFocalPoint(0.3, 0, 0);
  camera->SetViewUp(0, 0, 1);
  renderer->ResetCameraClippingRange();
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
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputConnection(closed->GetOutputPort());
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->NonManifoldEdgesOn();
  edges->BoundaryEdgesOn();
  edges->Update();
  claim(edges->GetOutput()->GetNumberOfCells() == 0, "a closed line's tube has no seam");
  claim(closed->GetOutput()->GetPointData()->GetArray("value"), "arrays are carried");
  // 1e-4 of the fit and the polyline's own sagitta, 4e-4 of the diagonal where the knot bends most
  claim(closed->GetMaximumError() > 0 && closed->GetMaximumError() <= 5e-4 * knot->GetLength(),
    "the curve follows the line");
  claim(closed->GetNumberOfControlPoints() < 241, "the fit reduces the data");
  claim(widening->GetOutput(1)->GetNumberOfLines() == 1, "port 1 has the fitted curve");
  claim(
    ChiTestImage::Compare(window, argc, argv, "TestChiStreamTubes"), "the picture is the baseline");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
