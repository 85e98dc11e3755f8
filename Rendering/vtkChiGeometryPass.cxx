// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiGeometryPass.h"

#include "vtkObjectFactory.h"
#include "vtkProp.h"
#include "vtkRenderState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"

vtkStandardNewMacro(vtkChiGeometryPass);

//------------------------------------------------------------------------------
void vtkChiGeometryPass::Render(const vtkRenderState* state)
{
  this->PreRender(state);
  for (int i = 0; i < state->GetPropArrayCount(); ++i)
  {
    state->GetPropArray()[i]->RenderOpaqueGeometry(state->GetRenderer());
  }
  this->PostRender(state);
}

//------------------------------------------------------------------------------
bool vtkChiGeometryPass::PreReplaceShaderValues(std::string& vtkNotUsed(vertexShader),
  std::string& vtkNotUsed(geometryShader), std::string& fragmentShader,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* vtkNotUsed(prop))
{
  // the last tag of main(): colours have been lit and textured by then
  vtkShaderProgram::Substitute(fragmentShader, "//VTK::DepthPeeling::Impl",
    "//VTK::DepthPeeling::Impl\n  //CHI::Geometry::Impl\n", false);
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiGeometryPass::PostReplaceShaderValues(std::string& vtkNotUsed(vertexShader),
  std::string& vtkNotUsed(geometryShader), std::string& fragmentShader,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* vtkNotUsed(prop))
{
  if (this->Output == SPECULAR)
  {
    // Phong's sum, before textures multiply it; physically based shaders have no such sum
    const bool known = vtkShaderProgram::Substitute(fragmentShader,
      "vec4(ambientColor + diffuse + specular, opacity)", "vec4(specular, opacity)", false);
    vtkShaderProgram::Substitute(
      fragmentShader, "//CHI::Geometry::Impl", known ? "" : "gl_FragData[0] = vec4(0.0);", false);
    return true;
  }
  const bool known = fragmentShader.find("normalVCVSOutput") != std::string::npos;
  vtkShaderProgram::Substitute(fragmentShader, "//CHI::Geometry::Impl",
    known ? "gl_FragData[0] = vec4(normalVCVSOutput, 1.0);" : "gl_FragData[0] = vec4(0.0);", false);
  return true;
}
