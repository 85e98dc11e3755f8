// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause

// Waves in half of a spherical shell, a curvilinear grid, around a ball. waves_in_shell [FILE.png]

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkChiProjectedTetrahedraMapper.h>
#include <vtkColorTransferFunction.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkStructuredGrid.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>

int main(int argc, char* argv[])
{
  const double pi = 3.14159265358979;
  const int n[3] = { 17, 49, 65 }; // outwards, from pole to pole, around
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> wave;
  wave->SetName("wave");
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        const double r = 1 + 1.0 * i / (n[0] - 1), a = pi * k / (n[2] - 1);
        const double b = 0.05 + (pi - 0.1) * j / (n[1] - 1);
        points->InsertNextPoint(r * std::sin(b) * std::cos(a), r * std::cos(b), -r * std::sin(b) * std::sin(a));
        wave->InsertNextValue(static_cast<float>(std::sin(5 * a) * std::sin(4 * b) * std::sin(pi * (r - 1))));
      }
    }
  }
  vtkNew<vtkStructuredGrid> shell;
  shell->SetDimensions(n);
  shell->SetPoints(points);
  shell->GetPointData()->SetScalars(wave);

  vtkNew<vtkPiecewiseFunction> opacity; // only crests and troughs
  opacity->AddPoint(-1, 1);
  opacity->AddPoint(-0.3, 0);
  opacity->AddPoint(0.3, 0);
  opacity->AddPoint(1, 1);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(-1, 0.1, 0.3, 0.8);
  color->AddRGBPoint(0, 0.95, 0.95, 0.95);
  color->AddRGBPoint(1, 0.8, 0.2, 0.1);
  vtkNew<vtkChiProjectedTetrahedraMapper> mapper; // takes any data set
  mapper->SetInputData(shell);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetScalarOpacityUnitDistance(0.08);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkSphereSource> ball;
  ball->SetRadius(1);
  ball->SetThetaResolution(96);
  ball->SetPhiResolution(64);
  vtkNew<vtkPolyDataMapper> ballMapper;
  ballMapper->SetInputConnection(ball->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(ballMapper);
  actor->GetProperty()->SetColor(0.55, 0.6, 0.6);

  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  renderer->AddVolume(volume);
  renderer->SetBackground(1, 1, 1);
  renderer->GetActiveCamera()->SetPosition(0.6, 0.5, 1);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.4);
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(512, 512);
  window->AddRenderer(renderer);
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(grab->GetOutputPort());
  writer->SetFileName(argc > 1 ? argv[1] : "waves_in_shell.png");
  writer->Write();
  return mapper->GetNumberOfOrderViolations() == 0 ? 0 : 1;
}
