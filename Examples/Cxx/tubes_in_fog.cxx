// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause

// A helix of tube in a ball of fog, each darkening the other. tubes_in_fog [FILE.png]

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkChiCombinedOcclusionVolumeMapper.h>
#include <vtkChiStreamTubes.h>
#include <vtkColorTransferFunction.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <cmath>

int main(int argc, char* argv[])
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(200);
  for (int i = 0; i < 200; ++i)
  {
    const double t = 0.12 * i;
    cells->InsertCellPoint(points->InsertNextPoint(40 * std::cos(t), 0.7 * i - 70, 40 * std::sin(t)));
  }
  vtkNew<vtkPolyData> line;
  line->SetPoints(points);
  line->SetLines(cells);
  vtkNew<vtkChiStreamTubes> tubes;
  tubes->SetInputData(line);
  tubes->SetRadius(0.02);
  vtkNew<vtkPolyDataMapper> tubeMapper;
  tubeMapper->SetInputConnection(tubes->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(tubeMapper);
  actor->GetProperty()->SetColor(0.9, 0.45, 0.15);

  vtkNew<vtkImageData> image;
  image->SetDimensions(64, 64, 64);
  image->SetSpacing(2, 2, 2);
  image->SetOrigin(-63, -63, -63);
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* density = static_cast<float*>(image->GetScalarPointer());
  for (int i = 0; i < 64 * 64 * 64; ++i)
  {
    const double x = i % 64 - 31.5, y = i / 64 % 64 - 31.5, z = i / 4096 - 31.5;
    density[i] = static_cast<float>(1 - std::sqrt(x * x + y * y + z * z) / 31.5);
  }
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0, 0);
  opacity->AddPoint(1, 0.05);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0, 0.75, 0.85, 1);
  vtkNew<vtkChiCombinedOcclusionVolumeMapper> mapper;
  mapper->SetInputData(image);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->GetProperty()->SetScalarOpacity(opacity);
  volume->GetProperty()->SetColor(color);
  volume->GetProperty()->SetInterpolationTypeToLinear();

  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  renderer->AddVolume(volume);
  renderer->SetBackground(1, 1, 1);
  renderer->ResetCamera();
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetSize(512, 512);
  window->AddRenderer(renderer);
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(grab->GetOutputPort());
  writer->SetFileName(argc > 1 ? argv[1] : "tubes_in_fog.png");
  writer->Write();
  return mapper->GetNumberOfSamples() > 0 ? 0 : 1;
}
