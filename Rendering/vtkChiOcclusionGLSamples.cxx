// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The OpenGL engine's samples of the volume.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionClassifyFunctions.h"
#include "vtkChiOcclusionComponentsFunctions.h"
#include "vtkChiOcclusionCutFunctions.h"
#include "vtkChiOcclusionFetchFunctions.h"
#include "vtkChiOcclusionGLTools.h"
#include "vtkChiOcclusionPlanesFunctions.h"
#include "vtkChiOcclusionRowsFunctions.h"
#include "vtkChiOcclusionSampleFS.h"
#include "vtkChiOcclusionShadeFunctions.h"
#include "vtkChiOcclusionSplitFunctions.h"

#include "vtkShaderProgram.h"

#include <algorithm>
#include <cmath>

using namespace vtkChiOcclusionGLTools;

namespace
{
// The shader with what it calls, topic by topic; one string, by which programs are found again.
const char* sampleShader()
{
  static const std::string whole = []
  {
    std::string source = vtkChiOcclusionSampleFS;
    vtkShaderProgram::Substitute(source, "//CHI::Functions::Dec",
      std::string(vtkChiOcclusionFetchFunctions) + vtkChiOcclusionClassifyFunctions +
        vtkChiOcclusionPlanesFunctions + vtkChiOcclusionShadeFunctions +
        vtkChiOcclusionRowsFunctions + vtkChiOcclusionSplitFunctions + vtkChiOcclusionCutFunctions +
        vtkChiOcclusionComponentsFunctions);
    return source;
  }();
  return whole.c_str();
}
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawSamples(const chi_occlusion_plan& plan, std::int64_t slab)
{
  chi_plan_slab rays;
  chi_occlusion_plan_slab(&plan, slab, &rays);
  const bool lit = rays.is_lit != 0;
  const bool integrates = std::isfinite(plan.color_step);
  vtkShaderProgram* program = this->Pass.Use(sampleShader(),
    std::string("#define VOLUME_SAMPLER ") + vtkChiOcclusionTextures::SamplerOf(plan.type) + "\n" +
      define("NEAREST", plan.nearest) + define("CLIPS", plan.clip_count) +
      define("HAS_SURFACE", plan.surface ? 1 : 0) + define("HAS_LIGHT", lit ? 1 : 0) +
      define("LIGHT_SCALE", plan.light_scale) + define("BRICK_EDGE", plan.brick_edge) +
      define("ENTRIES", static_cast<int>(plan.table_entries)) +
      define("COLOR_PARTS", integrates ? plan.color_parts : 0) +
      define("COLOR_STEPS", plan.color_steps) + define("TABLE_WIDTH", vtkChiGLTools::TABLE_WIDTH) +
      defineLight(plan) + this->DefineShading(plan) + this->DefineLayers(plan) +
      this->DefineCuts(plan) + this->DefineComponents(plan));
  if (!program)
  {
    return;
  }
  this->Pass.Read("volumeTexture", this->Inputs.GetVolume());
  this->Pass.Read("brickTexture", this->Inputs.GetBricks());
  this->Pass.Read("sumTexture", this->Inputs.GetSums());
  this->Pass.Read("sigmaTexture", this->Inputs.GetSigma());
  this->Pass.Read("colorTexture", this->Inputs.GetColors());
  const float table[3] = { plan.table_base, plan.table_scale, plan.table_offset };
  program->SetUniformi("useBricks", plan.use_bricks);
  program->SetUniform3f("tableScale", table);
  program->SetUniformf("quantum", plan.quantum);
  if (integrates)
  {
    this->Pass.Read("colorSumTexture", this->Inputs.GetColorSums());
    this->Pass.Read("colorMeanTexture", this->Inputs.GetColorMeans());
    program->SetUniformf("colorStep", plan.color_step);
    program->SetUniformf("colorWorth", plan.color_worth * plan.color_step);
    program->SetUniformf("colorEven", static_cast<float>(plan.color_even) * plan.color_step);
    program->SetUniformf("colorThin", plan.color_thin);
  }
  program->SetUniform2f("firstPixel", rays.pixel);
  program->SetUniform3f("position", rays.position);
  program->SetUniform3f("positionX", rays.position_x);
  program->SetUniform3f("positionY", rays.position_y);
  program->SetUniform3f("direction", rays.direction);
  program->SetUniform3f("directionX", rays.direction_x);
  program->SetUniform3f("directionY", rays.direction_y);
  setUniform(program, "boxLow", plan.box_low);
  setUniform(program, "boxHigh", plan.box_high);
  float clips[CHI_MAX_CLIP_PLANES][4];
  for (int k = 0; k < plan.clip_count; ++k)
  {
    std::copy(plan.clip[k], plan.clip[k] + 4, clips[k]);
  }
  program->SetUniform4fv("clip", plan.clip_count, clips);
  setUniform(program, "raySlope", { plan.slope_x, plan.slope_y });
  setUniform(program, "raySlopeStep", { plan.slope_dx, plan.slope_dy });
  program->SetUniformf("slice", static_cast<float>(plan.slice));
  program->SetUniformi("segments", static_cast<int>(plan.group));
  program->SetUniformi("startsHere", slab == plan.volume_begin ? 1 : 0);
  program->SetUniformf("firstSlice", static_cast<float>(slab * plan.group));
  if (plan.surface)
  {
    this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
  }
  if (lit)
  {
    this->Pass.Read("planeTexture0", this->Plane(plan, 0, rays.first_plane));
    this->Pass.Read("planeTexture1", this->Plane(plan, 0, rays.first_plane + 1));
    this->Pass.Read("planeTexture2", this->Plane(plan, 0, rays.first_plane + 2));
    const float there[3] = { rays.first_plane >= 0 ? 1.0f : 0.0f,
      rays.first_plane >= -1 ? 1.0f : 0.0f, rays.first_plane >= -2 ? 1.0f : 0.0f };
    program->SetUniform3f("planeThere", there);
    program->SetUniform3f("planeRange", rays.plane);
    program->SetUniformf("strength", static_cast<float>(plan.strength));
    setWeights(program, plan);
  }
  this->SetShading(program, plan);
  if (plan.layers > 0)
  {
    this->ReadLayers(program, plan, slab, slab + 1);
  }
  this->SetCuts(program, plan);
  this->SetComponents(program, plan);
  const chi_rect& rect = plan.samples[slab];
  std::vector<vtkTextureObject*> targets = { this->Layer.Get() };
  targets.insert(targets.end(), this->LayerWeights.begin(), this->LayerWeights.end());
  const std::size_t blended = targets.size();
  if (plan.fields > 0)
  {
    this->TauDrawn[slab & 1] = rect;
    targets.push_back(this->Tau[slab & 1]);
  }
  this->Pass.Draw(targets, rect, vtkChiQuadPass::UNDER, blended);
  this->Samples += areaOf(rect) * plan.group;
}
