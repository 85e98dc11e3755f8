// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiGeometryPass.h"

#include "vtkChiGeometryFunctions.h"

#include "vtkActor.h"
#include "vtkObjectFactory.h"
#include "vtkShaderProgram.h"

vtkStandardNewMacro(vtkChiGeometryPass);

//------------------------------------------------------------------------------
void vtkChiGeometryPass::Render(const vtkRenderState* vtkNotUsed(state))
{
  // a key on props, and nobody's delegate
}

//------------------------------------------------------------------------------
bool vtkChiGeometryPass::PreReplaceShaderValues(std::string& vtkNotUsed(vertexShader),
  std::string& vtkNotUsed(geometryShader), std::string& fragmentShader,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* vtkNotUsed(prop))
{
  vtkShaderProgram::Substitute(fragmentShader, "//VTK::DepthPeeling::Dec",
    std::string(vtkChiGeometryFunctions) + "\n//VTK::DepthPeeling::Dec", false);
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
  // Phong's sum, before textures multiply it; physically based shaders have no such sum
  vtkShaderProgram::Substitute(fragmentShader, "vec4(ambientColor + diffuse + specular, opacity)",
    "vec4(ambientColor + diffuse + (chiSpecular = specular), opacity)", true);
  vtkShaderProgram::Substitute(fragmentShader, "gl_FragData[0] = gl_FragData[0] * tcolor;",
    "gl_FragData[0] = gl_FragData[0] * tcolor; chiSpecular *= tcolor.rgb;", true);
  const bool known = fragmentShader.find("normalVCVSOutput") != std::string::npos;
  const std::string normal = known ? "vec4(normalVCVSOutput, 1.0)" : "vec4(0.0)";
  vtkShaderProgram::Substitute(fragmentShader, "//CHI::Geometry::Impl",
    "if (chiGeometryMode == 2) { gl_FragData[1] = vec4(chiSpecular, gl_FragData[0].a); }\n"
    "  else if (chiGeometryMode != 0) { gl_FragData[0] = chiGeometryMode == 3 ? " +
      normal + " : vec4(0.0); }\n",
    false);
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiGeometryPass::SetShaderParameters(vtkShaderProgram* program,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* prop, vtkOpenGLVertexArrayObject* vtkNotUsed(VAO))
{
  // what of a prop is translucent is none of this pass's business
  vtkActor* actor = vtkActor::SafeDownCast(prop);
  const bool opaque = !actor || !actor->IsRenderingTranslucentPolygonalGeometry();
  program->SetUniformi("chiGeometryMode", opaque ? this->Mode : DRAW);
  return true;
}
