// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The mapper of meshes, its input, its window and its renderer may go in any order, at any time.
#include "vtkChiProjectedTetrahedraMapper.h"

#include "vtkCellType.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cstdlib>
#include <iostream>
#include <sstream>

namespace
{
class ErrorCounter : public vtkCommand
{
public:
  static ErrorCounter* New() { return new ErrorCounter; }
  void Execute(vtkObject*, unsigned long, void*) override { ++this->Count; }
  int Count = 0;
};

// A hexahedron and a pyramid on top of it.
vtkSmartPointer<vtkUnstructuredGrid> makeMesh()
{
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> scalars;
  const double corners[9][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
    { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 }, { 0.5, 0.5, 2 } };
  for (const auto& corner : corners)
  {
    points->InsertNextPoint(corner);
    scalars->InsertNextValue(corner[2]);
  }
  mesh->SetPoints(points);
  mesh->GetPointData()->SetScalars(scalars);
  const vtkIdType hexahedron[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const vtkIdType pyramid[5] = { 4, 5, 6, 7, 8 };
  mesh->InsertNextCell(VTK_HEXAHEDRON, 8, hexahedron);
  mesh->InsertNextCell(VTK_PYRAMID, 5, pyramid);
  return mesh;
}

struct Scene
{
  vtkSmartPointer<vtkRenderWindow> Window = vtkSmartPointer<vtkRenderWindow>::New();
  vtkSmartPointer<vtkRenderer> Renderer = vtkSmartPointer<vtkRenderer>::New();
  vtkSmartPointer<vtkVolume> Volume = vtkSmartPointer<vtkVolume>::New();

  explicit Scene(vtkChiProjectedTetrahedraMapper* mapper)
  {
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(0.0, 0.2);
    opacity->AddPoint(2.0, 0.9);
    this->Volume->GetProperty()->SetScalarOpacity(opacity);
    this->Volume->SetMapper(mapper);
    this->Renderer->AddVolume(this->Volume);
    this->Window->SetMultiSamples(0);
    this->Window->SetOffScreenRendering(1);
    this->Window->SetSize(60, 50);
    this->Window->AddRenderer(this->Renderer);
    this->Window->Render();
  }
};
}

int TestChiProjectedTetrahedraLifetime(int, char*[])
{
  bool good = true;
  const auto claim = [&good](bool holds, const char* what)
  {
    if (!holds)
    {
      std::cerr << "does not hold: " << what << "\n";
      good = false;
    }
  };
  vtkNew<vtkRenderWindow> stays; // an X server may restart when its last client leaves
  stays->SetOffScreenRendering(1);
  stays->SetSize(10, 10);
  stays->Render();

  auto mapper = vtkSmartPointer<vtkChiProjectedTetrahedraMapper>::New();
  auto mesh = makeMesh();
  mapper->SetInputData(mesh);
  claim(mapper->GetInput() == mesh, "an unstructured input is handed out as one");
  vtkNew<ErrorCounter> errors;
  mapper->AddObserver(vtkCommand::ErrorEvent, errors);
  vtkNew<vtkImageData> image;
  claim(!mapper->GetFloatImage(image), "there is no picture before the first frame");
  claim(image->GetNumberOfPoints() == 0, "and the image is empty then");
  claim(mapper->GetNumberOfOrderViolations() == -1, "and no order");

  // the window goes first: the picture stays
  {
    Scene scene(mapper);
    claim(mapper->GetFloatImage(image) && image->GetNumberOfPoints() == 3000, "there is a picture");
    claim(mapper->GetNumberOfTetrahedra() > 6, "of tetrahedra");
  }
  claim(mapper->GetFloatImage(image), "the picture outlives its window");
  claim(mapper->GetNumberOfOrderViolations() == 0, "so does the order");

  // two windows in turn, one of them closed in between
  {
    Scene first(mapper);
    {
      Scene second(mapper);
      first.Window->Render();
      second.Window->Render();
    }
    first.Window->Render();
    claim(mapper->GetFloatImage(image), "the first window lives on");
    first.Window->RemoveRenderer(first.Renderer);
    vtkNew<vtkRenderWindow> other;
    other->SetMultiSamples(0);
    other->SetOffScreenRendering(1);
    other->SetSize(60, 50);
    other->AddRenderer(first.Renderer);
    other->Render();
    claim(mapper->GetFloatImage(image), "the renderer may move to another window");
    other->RemoveRenderer(first.Renderer);
  }

  // another size, another mapper, another input, none
  {
    Scene scene(mapper);
    scene.Window->SetSize(31, 77);
    scene.Window->Render();
    claim(mapper->GetFloatImage(image) && image->GetNumberOfPoints() == 31 * 77, "sizes follow");
    vtkNew<vtkChiProjectedTetrahedraMapper> next;
    next->SetInputData(mesh);
    scene.Volume->SetMapper(next);
    scene.Window->Render();
    claim(next->GetFloatImage(image), "a new mapper draws");
    scene.Volume->SetMapper(mapper);
    scene.Window->Render();
    mapper->RemoveAllInputs();
    scene.Window->Render();
    mapper->SetInputData(makeMesh());
    mesh = nullptr; // the first input is gone for good
    scene.Window->Render();
    claim(mapper->GetFloatImage(image), "input may be taken away, and another one given");
  }

  // the input goes, the mapper knows what it drew
  {
    Scene scene(mapper);
    mapper->RemoveAllInputs();
    claim(mapper->GetNumberOfOrderViolations() == 0, "the order of a mesh that is gone");
    mapper->SetInputData(makeMesh());
  }

  // the mapper goes first
  {
    Scene scene(mapper);
    scene.Volume->SetMapper(nullptr);
    mapper = nullptr;
    scene.Renderer->RemoveViewProp(scene.Volume);
    scene.Window->Render();
  }
  claim(errors->Count == 0, "none of this is an error");

  vtkNew<vtkChiProjectedTetrahedraMapper> printed;
  std::ostringstream text;
  printed->Print(text);
  claim(text.str().find("PickingOpacity: 0.5") != std::string::npos, "it prints its settings");
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
