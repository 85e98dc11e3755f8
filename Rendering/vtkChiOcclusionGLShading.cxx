// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// What gradients and a second quantity do to the OpenGL engine's samples.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionGLTools.h"

#include "vtkShaderProgram.h"

#include <algorithm>
#include <limits>

using namespace vtkChiOcclusionGLTools;

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::DefineShading(const chi_occlusion_plan& plan)
{
  const chi_plan_shading none = {};
  const chi_plan_shading& s = plan.shading ? *plan.shading : none;
  const bool overGradient = s.plane_table && !s.plane_second;
  return define("HAS_SHADING", plan.shading ? 1 : 0) +
    define("HAS_GRADIENT", s.lit || s.gradient_opacity || overGradient) +
    define("HAS_ROWS", s.plane_table ? 1 : 0) + define("HAS_SECOND", s.plane_second ? 1 : 0) +
    define("HAS_GRADIENT_OPACITY", s.gradient_opacity ? 1 : 0) + define("IS_SHADED", s.lit) +
    define("IS_TWO_SIDED", s.two_sided) + define("IS_SHINY", s.shiny) +
    define("LAMPS", s.light_count) + define("LAMP_EYE", CHI_LIGHT_EYE) +
    define("LAMP_POSITIONAL", CHI_LIGHT_POSITIONAL);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::SetShading(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
  if (!plan.shading)
  {
    return;
  }
  const chi_plan_shading& s = *plan.shading;
  program->SetUniform3fv("toGradient", 3, s.gradient);
  if (s.gradient_opacity)
  {
    this->Pass.Read("gradientOpacityTexture", this->Inputs.GetGradientOpacity());
    const float scale[2] = { s.gradient_scale, s.gradient_end };
    program->SetUniform2f("gradientScale", scale);
  }
  if (s.plane_table)
  {
    const float scale[3] = { s.plane_base, s.plane_scale, s.plane_end };
    program->SetUniform3f("rowScale", scale);
    program->SetUniformf("rowQuantum", s.plane_quantum);
  }
  if (s.plane_second)
  {
    this->Pass.Read("secondTexture", this->Inputs.GetSecond());
  }
  if (!s.lit)
  {
    return;
  }
  program->SetUniform4fv("toEye", 3, s.to_eye);
  program->SetUniformf("ambient", s.ambient);
  program->SetUniform3f("ambientLight", s.ambient_light);
  program->SetUniformf("specularPower", s.power);
  program->SetUniformf("colorLimit", std::min(s.limit, std::numeric_limits<float>::max()));
  int kind[CHI_MAX_LIGHTS];
  float direction[CHI_MAX_LIGHTS][3];
  float position[CHI_MAX_LIGHTS][3];
  float diffuse[CHI_MAX_LIGHTS][3];
  float specular[CHI_MAX_LIGHTS][3];
  float attenuation[CHI_MAX_LIGHTS][3];
  float cone[CHI_MAX_LIGHTS][2];
  for (int k = 0; k < s.light_count; ++k)
  {
    const chi_plan_light& light = s.light[k];
    kind[k] = light.kind;
    std::copy(light.direction, light.direction + 3, direction[k]);
    std::copy(light.position, light.position + 3, position[k]);
    std::copy(light.diffuse, light.diffuse + 3, diffuse[k]);
    std::copy(light.specular, light.specular + 3, specular[k]);
    std::copy(light.attenuation, light.attenuation + 3, attenuation[k]);
    cone[k][0] = light.cone_cosine;
    cone[k][1] = light.exponent;
  }
  if (s.light_count > 0)
  {
    program->SetUniform1iv("lampKind", s.light_count, kind);
    program->SetUniform3fv("lampDirection", s.light_count, direction);
    program->SetUniform3fv("lampPosition", s.light_count, position);
    program->SetUniform3fv("lampDiffuse", s.light_count, diffuse);
    program->SetUniform3fv("lampSpecular", s.light_count, specular);
    program->SetUniform3fv("lampAttenuation", s.light_count, attenuation);
    program->SetUniform2fv("lampCone", s.light_count, cone);
  }
}
