// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiPolygonInput_h
#define vtkChiPolygonInput_h

#include <chiaroscuro/chi.h>

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <cstdint>
#include <string>
#include <vector>

// Polygons in the plane of two arrays, from whatever they are drawn with, as the core reads them.
struct vtkChiPolygonInput
{
  std::vector<double> Points; // three each
  std::vector<std::int64_t> Offsets{ 0 };
  std::string Problem, Remark;

  void Add(double x, double y) { this->Points.insert(this->Points.end(), { x, y, 0.0 }); }

  // Close what has been added since the last line, and end it.
  void EndLine(bool close)
  {
    const std::size_t first = 3 * static_cast<std::size_t>(this->Offsets.back());
    if (close && this->Points.size() > first + 3 && !this->EndsAt(&this->Points[first]))
    {
      this->Add(this->Points[first], this->Points[first + 1]);
    }
    this->Offsets.push_back(static_cast<std::int64_t>(this->Points.size() / 3));
  }

  bool EndsAt(const double x[2]) const
  {
    const std::size_t size = this->Points.size();
    return size > 0 && this->Points[size - 3] == x[0] && this->Points[size - 2] == x[1];
  }

  // Lines that go on where the one before has ended, and has not come back to its own start, are
  // one: many draw polygons so.
  void AddLines(vtkPoints* points, vtkCellArray* cells, bool close, bool join)
  {
    vtkNew<vtkIdList> ids;
    bool isOpen = false;
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c)
    {
      cells->GetCellAtId(c, ids);
      for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i)
      {
        double x[3];
        points->GetPoint(ids->GetId(i), x);
        if (i == 0 && isOpen)
        {
          const double first[2] = { this->Points[3 * this->Offsets.back()],
            this->Points[3 * this->Offsets.back() + 1] };
          if (this->EndsAt(x) && !this->EndsAt(first))
          {
            continue;
          }
          this->EndLine(close);
        }
        this->Add(x[0], x[1]);
      }
      isOpen = join && this->Points.size() > 3 * static_cast<std::size_t>(this->Offsets.back());
      if (!join)
      {
        this->EndLine(close);
      }
    }
    if (isOpen)
    {
      this->EndLine(close);
    }
  }

  void Read(vtkPolyData* data, bool closeLines)
  {
    if (data->GetPoints() && data->GetNumberOfPoints() > 0)
    {
      this->AddLines(data->GetPoints(), data->GetLines(), closeLines, true);
      this->AddLines(data->GetPoints(), data->GetPolys(), true, false);
    }
    if (data->GetNumberOfVerts() > 0 || data->GetNumberOfStrips() > 0)
    {
      this->Remark = "the polygon's vertices and strips are ignored";
    }
  }

  void Read(vtkTable* table)
  {
    vtkDataArray* const x = vtkDataArray::SafeDownCast(table->GetColumn(0));
    vtkDataArray* const y = vtkDataArray::SafeDownCast(table->GetColumn(1));
    if (!x || !y)
    {
      this->Problem = "the polygon's table (" + std::to_string(table->GetNumberOfColumns()) +
        " columns) needs two columns of numbers first, x and y of its corners";
      return;
    }
    for (vtkIdType i = 0; i < table->GetNumberOfRows(); ++i)
    {
      this->Add(x->GetComponent(i, 0), y->GetComponent(i, 0));
    }
    this->EndLine(true);
  }

  chi_lines_view Get() const
  {
    chi_lines_view view = {};
    view.points = { this->Points.data(), this->Points.size() / 3, 3 * sizeof(double), CHI_F64 };
    view.offsets = this->Offsets.data();
    view.line_count = this->Offsets.size() - 1;
    return view;
  }
};

#endif
