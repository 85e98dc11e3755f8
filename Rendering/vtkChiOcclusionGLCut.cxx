// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// What cropping regions and masks leave of the OpenGL engine's samples.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionGLTools.h"

#include "vtkShaderProgram.h"

using namespace vtkChiOcclusionGLTools;

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::DefineCuts(const chi_occlusion_plan& plan)
{
  const chi_plan_cut* cut = plan.cut;
  return define("HAS_REGIONS", cut && cut->regions != CHI_CROP_ALL_REGIONS ? 1 : 0) +
    define("GRIDS", cut ? cut->grids : 0);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::SetCuts(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
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
}
