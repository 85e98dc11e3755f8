// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// What cropping regions and masks leave of the OpenGL engine's samples.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionGLTools.h"

#include "vtkShaderProgram.h"

#include <algorithm>

using namespace vtkChiOcclusionGLTools;

namespace
{
const char* const keepNames[CHI_PLAN_GRIDS] = { "keepTexture0", "keepTexture1" };
}

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::DefineCuts(const chi_occlusion_plan& plan)
{
  const chi_plan_cut* cut = plan.cut;
  return define("HAS_REGIONS", cut && cut->regions != CHI_CROP_ALL_REGIONS ? 1 : 0) +
    define("GRIDS", cut ? cut->grids : 0) + define("HAS_LABELS", plan.labels ? 1 : 0);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::SetCuts(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
  if (plan.labels)
  {
    this->Pass.Read("labelTexture", this->Inputs.GetLabels());
  }
  if (!plan.cut)
  {
    return;
  }
  const chi_plan_cut& cut = *plan.cut;
  program->SetUniformf("cutAhead", cut.ahead);
  if (cut.regions != CHI_CROP_ALL_REGIONS)
  {
    program->SetUniform4fv("cropPlane", 6, cut.plane);
    program->SetUniformi("regions", static_cast<int>(cut.regions));
  }
  float last[CHI_PLAN_GRIDS][3];
  int step[2 * CHI_PLAN_GRIDS];
  float offset[CHI_PLAN_GRIDS];
  for (int k = 0; k < cut.grids; ++k)
  {
    const chi_plan_grid& grid = cut.grid[k];
    this->Pass.Read(keepNames[k], this->Inputs.GetKeep(k));
    std::copy(grid.last, grid.last + 3, last[k]);
    step[2 * k] = grid.step_y;
    step[2 * k + 1] = grid.step_z;
    offset[k] = grid.offset;
  }
  if (cut.grids > 0)
  {
    program->SetUniform3fv("keepLast", cut.grids, last);
    program->SetUniform1iv("keepStep", 2 * cut.grids, step);
    program->SetUniform1fv("keepOffset", cut.grids, offset);
  }
}
