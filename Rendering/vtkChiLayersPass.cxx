// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiLayersPass.h"

#include "vtkChiLayersFunctions.h"

#include "vtkActor.h"
#include "vtkObjectFactory.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"

vtkStandardNewMacro(vtkChiLayersPass);

//------------------------------------------------------------------------------
void vtkChiLayersPass::SetMode(Modes mode, vtkTextureObject* before, vtkTextureObject* opaque)
{
  this->Mode = mode;
  this->Before = before;
  this->Opaque = opaque;
}

//------------------------------------------------------------------------------
int vtkChiLayersPass::TakeDrawn()
{
  const int drawn = this->Drawn;
  this->Drawn = 0;
  return drawn;
}

//------------------------------------------------------------------------------
void vtkChiLayersPass::Render(const vtkRenderState* vtkNotUsed(state))
{
  // a key on props, and nobody's delegate
}

//------------------------------------------------------------------------------
bool vtkChiLayersPass::PreReplaceShaderValues(std::string& vtkNotUsed(vertexShader),
  std::string& vtkNotUsed(geometryShader), std::string& fragmentShader,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* vtkNotUsed(prop))
{
  vtkShaderProgram::Substitute(fragmentShader, "//VTK::DepthPeeling::Dec",
    std::string(vtkChiLayersFunctions) + "\n//VTK::DepthPeeling::Dec", false);
  // the depth is known here, and the colour there: lit and textured
  vtkShaderProgram::Substitute(fragmentShader, "//VTK::DepthPeeling::PreColor",
    "//CHI::Layers::PreColor\n  //VTK::DepthPeeling::PreColor", false);
  vtkShaderProgram::Substitute(fragmentShader, "//VTK::DepthPeeling::Impl",
    "//CHI::Layers::Impl\n  //VTK::DepthPeeling::Impl", false);
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiLayersPass::PostReplaceShaderValues(std::string& vtkNotUsed(vertexShader),
  std::string& vtkNotUsed(geometryShader), std::string& fragmentShader,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* vtkNotUsed(prop))
{
  const bool own = fragmentShader.find("gl_FragDepth =") != std::string::npos;
  const std::string depth = own ? "gl_FragDepth" : "gl_FragCoord.z";
  vtkShaderProgram::Substitute(fragmentShader, "//CHI::Layers::PreColor",
    "if (!chiLayerTakes(" + depth + ")) { discard; }", false);
  vtkShaderProgram::Substitute(fragmentShader, "//CHI::Layers::Impl",
    "if (chiLayerMode >= 2)\n  {\n    gl_FragData[0].rgb *= gl_FragData[0].a;\n"
    "    gl_FragData[1] = vec4(" +
      depth + ");\n    gl_FragData[0] = chiLayerMode == 4 ? vec4(1.0) : gl_FragData[0];\n  }",
    false);
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiLayersPass::SetShaderParameters(vtkShaderProgram* program,
  vtkAbstractMapper* vtkNotUsed(mapper), vtkProp* prop, vtkOpenGLVertexArrayObject* vtkNotUsed(VAO))
{
  ++this->Drawn;
  // A unit that no mapper uses: two samplers of different types must not share one, used or not.
  const int unused = 15;
  int mode = this->Mode;
  vtkActor* actor = vtkActor::SafeDownCast(prop);
  if (mode == HIDE && actor && actor->HasOpaqueGeometry() &&
    !actor->IsRenderingTranslucentPolygonalGeometry())
  {
    mode = DRAW; // blocks of a composite may be opaque
  }
  program->SetUniformi("chiLayerMode", mode);
  program->SetUniformi("chiLayerHasOpaque", this->Opaque ? 1 : 0);
  program->SetUniformi("chiLayerBefore", this->Before ? this->Before->GetTextureUnit() : unused);
  program->SetUniformi("chiLayerOpaque", this->Opaque ? this->Opaque->GetTextureUnit() : unused);
  return true;
}
