// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// Components besides the first of the OpenGL engine's samples.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionGLTools.h"

#include "vtkShaderProgram.h"

using namespace vtkChiOcclusionGLTools;

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::DefineComponents(const chi_occlusion_plan& plan)
{
  return define("COMPONENTS", plan.components ? plan.components->count : 0) +
    define("IS_DEPENDENT", plan.components ? plan.components->dependent : 0);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::SetComponents(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
  if (!plan.components)
  {
    return;
  }
  const chi_plan_components& all = *plan.components;
  float scale[CHI_MAX_COMPONENTS - 1][3];
  float end[CHI_MAX_COMPONENTS - 1];
  float quantum[CHI_MAX_COMPONENTS - 1];
  int first[CHI_MAX_COMPONENTS - 1];
  for (int k = 0; k < all.count; ++k)
  {
    const chi_plan_component& one = all.more[k];
    scale[k][0] = one.base;
    scale[k][1] = one.scale;
    scale[k][2] = one.offset;
    end[k] = one.end;
    quantum[k] = one.quantum;
    first[k] = static_cast<int>(vtkChiOcclusionTextures::FirstEntryOf(plan, k));
  }
  program->SetUniform3fv("moreScale", all.count, scale);
  program->SetUniform1fv("moreEnd", all.count, end);
  program->SetUniform1fv("moreQuantum", all.count, quantum);
  program->SetUniform1iv("moreFirst", all.count, first);
  program->SetUniform1fv("componentWeight", all.count + 1, all.weight);
}
