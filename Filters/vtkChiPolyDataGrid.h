// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiPolyDataGrid_h
#define vtkChiPolyDataGrid_h

#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

// Polygons as an unstructured grid, whose lists of cells the core can read; made anew where they
// change. Other data sets are handed through. Point and cell data stay where they are: cells have
// the order of the cell data.
class vtkChiPolyDataGrid
{
public:
  vtkDataSet* Convert(vtkDataSet* input)
  {
    vtkPolyData* const polygons = vtkPolyData::SafeDownCast(input);
    if (!polygons)
    {
      this->From = nullptr;
      this->Grid = nullptr;
      return input;
    }
    if (this->From != polygons || this->Time != polygons->GetMTime())
    {
      this->Make(polygons);
    }
    return this->Grid;
  }

private:
  void Make(vtkPolyData* polygons)
  {
    this->Grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    this->Grid->SetPoints(polygons->GetPoints());
    this->Grid->GetPointData()->ShallowCopy(polygons->GetPointData());
    this->Grid->GetCellData()->ShallowCopy(polygons->GetCellData());
    this->Grid->Allocate(polygons->GetNumberOfCells());
    vtkNew<vtkIdList> ids;
    for (vtkIdType i = 0; i < polygons->GetNumberOfCells(); ++i)
    {
      polygons->GetCellPoints(i, ids);
      this->Grid->InsertNextCell(polygons->GetCellType(i), ids);
    }
    this->From = polygons;
    this->Time = polygons->GetMTime();
  }

  vtkSmartPointer<vtkUnstructuredGrid> Grid;
  vtkSmartPointer<vtkPolyData> From;
  vtkMTimeType Time = 0;
};

#endif
