// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGridInput_h
#define vtkChiGridInput_h

#include "vtkChiFiltersModule.h" // for export macro

#include <chiaroscuro/chi_grid.h>

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkCellArray;
class vtkDataSet;
class vtkExplicitStructuredGrid;
class vtkImageData;
class vtkPoints;
class vtkRectilinearGrid;
class vtkStructuredGrid;

// Lends the mesh of any vtkDataSet to the C core. Nothing is copied but arrays that the core cannot
// read; arrays and copies are held until the mesh changes, so that what the core keeps of a version
// stays valid.
// Exported to the other modules of the package; its header is not installed.
class VTKCHIFILTERS_EXPORT vtkChiGridInput
{
public:
  // Returns whether there is a mesh of cells with volume, or might be one; else why not is
  // GetProblem().
  bool Collect(vtkDataSet* input);

  // In the coordinates of the data set. Its version changes with the mesh, not with the data on it.
  const chi_grid_view* GetGrid() const { return &this->Grid; }
  const std::string& GetProblem() const { return this->Problem; }
  // Whether the problem is that there is nothing, rather than something wrong.
  bool IsEmpty() const { return this->Empty; }

private:
  // An array as it was, to know it again.
  struct Source
  {
    vtkSmartPointer<vtkDataArray> Array; // null: there is none
    const void* Data = nullptr;
    vtkIdType Count = 0; // of values
    vtkMTimeType Time = 0;
  };
  using SourceList = std::vector<Source>;

  // What the mesh is made of: arrays, and numbers beside.
  static void List(vtkDataSet* input, SourceList& sources, std::vector<double>& values);
  static std::uint64_t Print(const SourceList& sources, const std::vector<double>& values);
  bool Borrow(vtkDataSet* input);
  void BorrowImage(vtkImageData* image);
  void BorrowRectilinear(vtkRectilinearGrid* grid);
  void BorrowCurvilinear(vtkStructuredGrid* grid);
  bool BorrowExplicit(vtkExplicitStructuredGrid* grid);
  bool BorrowUnstructured(vtkUnstructuredGrid* grid);
  void BorrowFaces(vtkUnstructuredGrid* grid);
  void BorrowCells(vtkCellArray* cells);
  void BorrowPoints(vtkPoints* points);
  bool BorrowGhosts(vtkDataSet* input);
  void SetDimensions(const int dimensions[3]);
  const std::int64_t* GetIds(vtkDataArray* ids);

  chi_grid_view Grid = {};
  std::string Problem;
  bool Empty = false;
  bool Good = false; // the mesh of the last call could be lent

  vtkMTimeType Time = 0; // of the data set itself
  SourceList Sources;
  std::vector<double> Values;
  std::uint64_t LastPrint = 0;

  std::vector<vtkSmartPointer<vtkDataArray>> Copies; // of arrays that the core cannot read
  std::vector<std::uint8_t> Types;                   // of grids whose cells are all of one type
  vtkSmartPointer<vtkUnstructuredGrid> Converted;    // of classes that hold no arrays
  vtkMTimeType ConvertedTime = 0;
  const vtkDataSet* ConvertedFrom = nullptr; // compared, never used
};

#endif
