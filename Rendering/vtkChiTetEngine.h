// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTetEngine_h
#define vtkChiTetEngine_h

#include <chiaroscuro/chi_tet.h>

#include <cstdint>
#include <vector>

// The core's renderer of tetrahedra, and the picture that it drew last.
class vtkChiTetEngine
{
public:
  vtkChiTetEngine() = default;
  ~vtkChiTetEngine();
  vtkChiTetEngine(const vtkChiTetEngine&) = delete;
  void operator=(const vtkChiTetEngine&) = delete;

  // Status and statistics are those of chi_tet_render, and of chi_tet_find_cells, which takes no
  // picture away here, and chi_tet_count_violations.
  chi_status Render(const chi_exec* exec, const chi_tet_frame& frame);
  chi_status FindCells(const chi_exec* exec, const chi_tet_frame& frame, double opacity,
    std::int64_t* cells, float* depths);
  chi_status CountViolations(
    const chi_exec* exec, const chi_tet_frame& frame, std::int64_t* violations);

  const chi_tet_stats& GetStats() const { return this->Stats; }
  // Without floats before the first picture, and after one that failed.
  const chi_tet_image& GetImage() const { return this->Image; }

private:
  chi_status Prepare(const chi_exec* exec);
  void KeepImage();

  chi_tet* Core = nullptr;
  chi_tet_image Image = {};
  chi_tet_stats Stats = {};
  std::vector<float> Kept; // the picture, where the core's memory has been used otherwise
};

#endif
