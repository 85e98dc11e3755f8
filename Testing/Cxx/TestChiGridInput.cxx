// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// Any class of data set lends its mesh to the core: what the core counts of it must be what was
// built, in volume, cells left out, and version. One block of cells, in every class that can say
// it.
#include "vtkChiGridInput.h"

#include <chiaroscuro/chi_grid.h>

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkExplicitStructuredGrid.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkSmartPointer.h"
#include "vtkStructuredGrid.h"
#include "vtkUniformGrid.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>

namespace
{
int failures = 0;

void check(bool good, const std::string& what)
{
  if (!good)
  {
    std::cerr << "wrong: " << what << "\n";
    ++failures;
  }
}

// 4 x 3 x 2 cells of 0.5 x 1 x 2 from (1, 2, 3): a volume of 2 x 3 x 4.
const int cells[3] = { 4, 3, 2 };
const double origin[3] = { 1.0, 2.0, 3.0 };
const double spacing[3] = { 0.5, 1.0, 2.0 };
const double volume = 24.0;

chi_grid_counts count(vtkChiGridInput& input, vtkDataSet* data, const std::string& what)
{
  chi_grid_counts counts = {};
  counts.struct_size = sizeof(counts);
  const bool good = input.Collect(data);
  check(good, what + " is lent: " + input.GetProblem());
  if (good)
  {
    const chi_status status = chi_grid_count(nullptr, input.GetGrid(), &counts);
    check(status == CHI_OK, what + " is counted: " + chi_status_string(status));
  }
  return counts;
}

// Sums of at most 2 x 24 x 6 products of numbers that are exact in binary: 1e-12 is far above
// their rounding.
void checkBlock(vtkDataSet* data, const std::string& what, double wanted = volume)
{
  vtkChiGridInput input;
  const chi_grid_counts counts = count(input, data, what);
  check(std::abs(counts.volume - wanted) <= 1e-12 * wanted,
    what + " has the volume " + std::to_string(counts.volume));
  check(counts.cells == static_cast<std::size_t>(data->GetNumberOfCells()), what + ": cells");
  check(counts.points == static_cast<std::size_t>(data->GetNumberOfPoints()), what + ": points");
  double bounds[6];
  data->GetBounds(bounds);
  for (int i = 0; i < 6; ++i)
  {
    check(std::abs(counts.bounds[i] - bounds[i]) <= 1e-12, what + ": bounds");
  }
}

template <typename T>
void place(T* data)
{
  data->SetDimensions(cells[0] + 1, cells[1] + 1, cells[2] + 1);
}

vtkSmartPointer<vtkImageData> makeImage()
{
  auto image = vtkSmartPointer<vtkUniformGrid>::New();
  place(image.GetPointer());
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  return image;
}

vtkSmartPointer<vtkPoints> makePoints(int type)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(type);
  const auto image = makeImage();
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    points->InsertNextPoint(image->GetPoint(i));
  }
  return points;
}

// Hexahedra; every other one as a polyhedron of six quadrilaterals, where asked.
vtkSmartPointer<vtkUnstructuredGrid> makeUnstructured(int type, bool polyhedra)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(makePoints(type));
  const auto image = makeImage();
  const int faces[6][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 }, { 0, 1, 5, 4 }, { 1, 2, 6, 5 },
    { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
  for (vtkIdType i = 0; i < image->GetNumberOfCells(); ++i)
  {
    vtkNew<vtkIdList> voxel;
    image->GetCellPoints(i, voxel);
    const vtkIdType corners[8] = { voxel->GetId(0), voxel->GetId(1), voxel->GetId(3),
      voxel->GetId(2), voxel->GetId(4), voxel->GetId(5), voxel->GetId(7), voxel->GetId(6) };
    if (!polyhedra || i % 2 == 0)
    {
      grid->InsertNextCell(VTK_HEXAHEDRON, 8, corners);
      continue;
    }
    vtkNew<vtkIdList> stream;
    stream->InsertNextId(6);
    for (const auto& face : faces)
    {
      stream->InsertNextId(4);
      for (const int corner : face)
      {
        stream->InsertNextId(corners[corner]);
      }
    }
    grid->InsertNextCell(VTK_POLYHEDRON, stream);
  }
  return grid;
}

void testClasses()
{
  const auto image = makeImage();
  checkBlock(image, "vtkUniformGrid");
  vtkNew<vtkImageData> moved;
  moved->SetExtent(-3, -3 + cells[0], 5, 5 + cells[1], 7, 7 + cells[2]);
  moved->SetSpacing(spacing);
  vtkNew<vtkMatrix3x3> turn; // about z, by a right angle
  turn->SetElement(0, 0, 0.0);
  turn->SetElement(0, 1, -1.0);
  turn->SetElement(1, 0, 1.0);
  turn->SetElement(1, 1, 0.0);
  moved->SetDirectionMatrix(turn);
  checkBlock(moved, "vtkImageData with a direction matrix");
  vtkChiGridInput input;
  const chi_grid_counts counts = count(input, moved, "vtkImageData with a direction matrix");
  const double wanted[6] = { -8.0, -5.0, -1.5, 0.5, 14.0, 18.0 };
  for (int i = 0; i < 6; ++i)
  {
    check(std::abs(counts.bounds[i] - wanted[i]) <= 1e-12, "an image lies where its matrix says");
  }

  vtkNew<vtkRectilinearGrid> rectilinear;
  place(rectilinear.GetPointer());
  vtkNew<vtkFloatArray> x;
  vtkNew<vtkDoubleArray> y;
  vtkNew<vtkIntArray> z; // 3, 5, 7: of integers
  for (int i = 0; i <= cells[0]; ++i)
  {
    x->InsertNextValue(static_cast<float>(origin[0] + spacing[0] * i));
  }
  for (int i = 0; i <= cells[1]; ++i)
  {
    y->InsertNextValue(origin[1] + spacing[1] * i);
  }
  for (int i = 0; i <= cells[2]; ++i)
  {
    z->InsertNextValue(static_cast<int>(origin[2] + spacing[2] * i));
  }
  rectilinear->SetXCoordinates(x);
  rectilinear->SetYCoordinates(y);
  rectilinear->SetZCoordinates(z);
  checkBlock(rectilinear, "vtkRectilinearGrid");

  vtkNew<vtkStructuredGrid> curvilinear;
  place(curvilinear.GetPointer());
  curvilinear->SetPoints(makePoints(VTK_FLOAT));
  checkBlock(curvilinear, "vtkStructuredGrid");

  for (const int type : { VTK_FLOAT, VTK_DOUBLE, VTK_INT })
  {
    // integers cut the steps of 0.5 along x: 1 1 2 2 3, the volume stays
    checkBlock(makeUnstructured(type, false),
      "vtkUnstructuredGrid of points of type " + std::to_string(type));
  }
  checkBlock(makeUnstructured(VTK_DOUBLE, true), "vtkUnstructuredGrid with polyhedra");
  const auto narrow = makeUnstructured(VTK_DOUBLE, false);
  narrow->GetCells()->ConvertTo32BitStorage();
  checkBlock(narrow, "vtkUnstructuredGrid of 32-bit cells");

  vtkNew<vtkExplicitStructuredGrid> explicitGrid;
  place(explicitGrid.GetPointer());
  explicitGrid->SetPoints(makePoints(VTK_DOUBLE));
  vtkNew<vtkCellArray> hexahedra;
  hexahedra->DeepCopy(makeUnstructured(VTK_DOUBLE, false)->GetCells());
  explicitGrid->SetCells(hexahedra);
  checkBlock(explicitGrid, "vtkExplicitStructuredGrid");
  explicitGrid->BlankCell(3);
  checkBlock(explicitGrid, "blanked vtkExplicitStructuredGrid", volume - 1.0);
}

void testLeftOut()
{
  const auto mixed = makeUnstructured(VTK_DOUBLE, false);
  const vtkIdType some[3] = { 0, 1, 7 };
  mixed->InsertNextCell(VTK_VERTEX, 1, some);
  mixed->InsertNextCell(VTK_LINE, 2, some);
  mixed->InsertNextCell(VTK_TRIANGLE, 3, some);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(mixed->GetNumberOfCells());
  ghosts->Fill(0);
  ghosts->SetValue(1, vtkDataSetAttributes::DUPLICATECELL);
  ghosts->SetValue(2, vtkDataSetAttributes::HIDDENCELL);
  mixed->GetCellData()->AddArray(ghosts);
  vtkChiGridInput input;
  const chi_grid_counts counts = count(input, mixed, "a mesh with lines and ghosts");
  check(counts.lower_dimensional_cells == 3, "vertices, lines and faces are counted");
  check(
    counts.ghost_cells == 1 && counts.blanked_cells == 1, "ghosts and hidden cells are counted");
  check(std::abs(counts.volume - (volume - 2.0)) <= 1e-12 * volume, "and have no volume");

  const auto image = makeImage();
  vtkUniformGrid::SafeDownCast(image)->BlankPoint(0);
  vtkUniformGrid::SafeDownCast(image)->BlankCell(5);
  const chi_grid_counts blanked = count(input, image, "a blanked vtkUniformGrid");
  check(blanked.blanked_cells == 2, "blanked points and cells are counted");
  check(std::abs(blanked.volume - (volume - 2.0)) <= 1e-12 * volume, "and have no volume");
}

void testVersions()
{
  const auto grid = makeUnstructured(VTK_DOUBLE, false);
  vtkNew<vtkDoubleArray> scalars;
  scalars->SetName("scalars");
  scalars->SetNumberOfTuples(grid->GetNumberOfPoints());
  scalars->Fill(1.0);
  grid->GetPointData()->SetScalars(scalars);
  vtkChiGridInput input;
  input.Collect(grid);
  const auto version = [&input](vtkDataSet* data)
  {
    check(input.Collect(data), "the mesh is lent again");
    return input.GetGrid()->version;
  };
  std::uint64_t last = version(grid);
  check(version(grid) == last, "the same mesh is the same version");
  scalars->SetValue(3, 7.0);
  scalars->Modified();
  check(version(grid) == last, "other scalars are no other mesh");
  grid->Modified();
  check(version(grid) == last, "a time stamp alone is no other mesh");
  vtkNew<vtkUnstructuredGrid> handed;
  handed->ShallowCopy(grid);
  check(version(handed) == last, "what a filter hands through is no other mesh");

  double* first = static_cast<double*>(grid->GetPoints()->GetVoidPointer(0));
  first[0] = -first[0]; // behind everyone's back ...
  grid->Modified();     // ... but for this
  check(version(grid) != last, "moved points are another mesh");
  last = version(grid);
  first[0] = -first[0];
  first[3] = -first[3];
  grid->GetPoints()->Modified();
  check(version(grid) != last, "so are other points, whose signs alone have changed");
  last = version(grid);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(grid->GetNumberOfCells());
  ghosts->Fill(0);
  grid->GetCellData()->AddArray(ghosts);
  check(version(grid) != last, "ghosts are part of the mesh");
  last = version(grid);
  const auto image = makeImage();
  check(version(image) != last, "another class is another mesh");
  last = version(image);
  image->SetSpacing(1.0, 1.0, 1.0);
  check(version(image) != last, "so is another spacing");
}

void testProblems()
{
  vtkChiGridInput input;
  check(!input.Collect(nullptr) && input.IsEmpty(), "no input is none");
  vtkNew<vtkUnstructuredGrid> empty;
  check(!input.Collect(empty) && input.IsEmpty() &&
      input.GetProblem().find("vtkUnstructuredGrid") != std::string::npos,
    "an empty mesh is said to be empty: " + input.GetProblem());
  vtkNew<vtkPolyData> faces;
  faces->SetPoints(makePoints(VTK_FLOAT));
  vtkNew<vtkCellArray> lines;
  const vtkIdType ends[2] = { 0, 1 };
  lines->InsertNextCell(2, ends);
  faces->SetLines(lines);
  check(!input.Collect(faces) && !input.IsEmpty() &&
      input.GetProblem().find("vtkPolyData") != std::string::npos,
    "a vtkPolyData has no cells of volume: " + input.GetProblem());
  const auto broken = makeUnstructured(VTK_DOUBLE, false);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(2);
  broken->GetCellData()->AddArray(ghosts);
  check(!input.Collect(broken) && input.GetProblem().find("2 tuples") != std::string::npos,
    "too few ghosts are a problem: " + input.GetProblem());
  broken->GetCellData()->RemoveArray(ghosts->GetName());
  check(input.Collect(broken) && input.GetProblem().empty(), "and good again without them");
}
}

//------------------------------------------------------------------------------
int TestChiGridInput(int, char*[])
{
  testClasses();
  testLeftOut();
  testVersions();
  testProblems();
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
