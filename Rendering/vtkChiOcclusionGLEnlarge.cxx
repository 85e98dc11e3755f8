// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The OpenGL engine's enlargement of a reduced picture.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionEnlargeFS.h"
#include "vtkChiOcclusionGLTools.h"

#include "vtkShaderProgram.h"

using namespace vtkChiOcclusionGLTools;

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawEnlarged(const chi_occlusion_plan& plan)
{
  vtkShaderProgram* program =
    this->Pass.Use(vtkChiOcclusionEnlargeFS, define("HAS_GUIDE", plan.guide ? 1 : 0));
  if (!program)
  {
    return;
  }
  this->Pass.Read("layerTexture", this->Layer);
  this->Pass.Read("visibilityTexture", this->Visibility);
  program->SetUniformi("reduction", plan.reduction);
  program->SetUniformi("reducedPixel", plan.reduced_pixel);
  if (plan.guide)
  {
    this->Pass.Read("guideTexture", this->Inputs.GetGuide());
    program->SetUniformf("guideFar", static_cast<float>(plan.guide_far));
  }
  this->Pass.Draw({ this->FullLayer.Get(), this->FullVisibility.Get() },
    { 0, 0, plan.full_width, plan.full_height });
}
