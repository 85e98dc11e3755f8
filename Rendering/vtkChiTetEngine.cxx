// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiTetEngine.h"

//------------------------------------------------------------------------------
vtkChiTetEngine::~vtkChiTetEngine()
{
  chi_tet_destroy(nullptr, this->Core);
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::Prepare(const chi_exec* exec)
{
  return this->Core ? CHI_OK : chi_tet_create(exec, &this->Core);
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::Render(const chi_exec* exec, const chi_tet_frame& frame)
{
  this->Image = {};
  chi_status status = this->Prepare(exec);
  if (status == CHI_OK)
  {
    status = chi_tet_render(exec, this->Core, &frame);
    this->Stats = {};
    this->Stats.struct_size = sizeof(this->Stats);
    chi_tet_get_stats(this->Core, &this->Stats);
  }
  if (status == CHI_OK)
  {
    this->Kept.clear();
    chi_tet_get_image(this->Core, &this->Image);
  }
  return status;
}

//------------------------------------------------------------------------------
void vtkChiTetEngine::KeepImage()
{
  if (this->Image.rgba && this->Kept.empty())
  {
    const std::size_t pixels =
      static_cast<std::size_t>(this->Image.width) * static_cast<std::size_t>(this->Image.height);
    this->Kept.assign(this->Image.rgba, this->Image.rgba + 4 * pixels);
    this->Image.rgba = this->Kept.data();
  }
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::FindCells(const chi_exec* exec, const chi_tet_frame& frame,
  double opacity, std::int64_t* cells, float* depths)
{
  this->KeepImage();
  const chi_status status = this->Prepare(exec);
  return status == CHI_OK ? chi_tet_find_cells(exec, this->Core, &frame, opacity, cells, depths)
                          : status;
}

//------------------------------------------------------------------------------
chi_status vtkChiTetEngine::CountViolations(
  const chi_exec* exec, const chi_tet_frame& frame, std::int64_t* violations)
{
  this->KeepImage();
  const chi_status status = this->Prepare(exec);
  return status == CHI_OK ? chi_tet_count_violations(exec, this->Core, &frame, violations) : status;
}
