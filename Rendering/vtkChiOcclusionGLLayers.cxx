// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The OpenGL engine's translucent layers, and parts of pixels that a surface covers, which are
// alike.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionFinishLayersFS.h"
#include "vtkChiOcclusionGLTools.h"
#include "vtkChiOcclusionLayersFS.h"

#include "vtkShaderProgram.h"

#include <string>
#include <vector>

using namespace vtkChiOcclusionGLTools;

//------------------------------------------------------------------------------
// Those of a slab that the pass of its samples does not meet.
void vtkChiOcclusionGL::DrawLayers(const chi_occlusion_plan& plan, std::int64_t slab)
{
  this->DrawLayers(plan, slab, slab + 1, plan.layer_spots[slab], plan.samples[slab]);
}

//------------------------------------------------------------------------------
// Those of all slabs from this one on, and behind.
void vtkChiOcclusionGL::DrawLastLayers(const chi_occlusion_plan& plan, std::int64_t slab)
{
  this->DrawLayers(plan, slab, plan.slabs + 1, { 0, 0, plan.width, plan.height }, {});
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawLayers(const chi_occlusion_plan& plan, std::int64_t begin,
  std::int64_t end, const chi_rect& rect, const chi_rect& without)
{
  vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionLayersFS, this->DefineLayers(plan));
  if (!program)
  {
    return;
  }
  this->ReadLayers(program, plan, begin, end);
  const float hole[4] = { static_cast<float>(without.x0), static_cast<float>(without.y0),
    static_cast<float>(without.x1), static_cast<float>(without.y1) };
  program->SetUniform4f("hole", hole);
  std::vector<vtkTextureObject*> targets = { this->Layer.Get() };
  targets.insert(targets.end(), this->LayerWeights.begin(), this->LayerWeights.end());
  this->Pass.Draw(targets, rect, vtkChiQuadPass::UNDER, targets.size());
}

//------------------------------------------------------------------------------
std::string vtkChiOcclusionGL::DefineLayers(const chi_occlusion_plan& plan) const
{
  return define("LAYERS", plan.layers) +
    define("WEIGHTS", static_cast<int>(this->LayerWeights.size()));
}

//------------------------------------------------------------------------------
// For a pass that blends the layers of slabs from `begin` up to `end`.
void vtkChiOcclusionGL::ReadLayers(
  vtkShaderProgram* program, const chi_occlusion_plan& plan, std::int64_t begin, std::int64_t end)
{
  const float infinite = 1.0e30f; // beyond which shaders take nothing to be there
  const float range[2] = { begin > 0 ? static_cast<float>(begin * plan.group) : -infinite,
    end <= plan.slabs ? static_cast<float>(end * plan.group) : infinite };
  this->Pass.Read("layersTexture", this->Inputs.GetLayers());
  program->SetUniform2f("layerRange", range);
}

//------------------------------------------------------------------------------
// Their colours, when it is known what light they receive.
void vtkChiOcclusionGL::FinishLayers(const chi_occlusion_plan& plan)
{
  const chi_plan_field& field = plan.field[plan.surface_field];
  const bool lit = plan.fields > 0 && plan.slabs > 0 && (field.volume || field.geometry);
  vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionFinishLayersFS,
    this->DefineLayers(plan) + define("LIT", lit ? 1 : 0) + defineLight(plan));
  if (!program)
  {
    return;
  }
  this->Pass.Read("layersTexture", this->Inputs.GetLayers());
  this->Pass.Read("layerColorTexture", this->Inputs.GetLayerColors());
  for (std::size_t i = 0; i < this->LayerWeights.size(); ++i)
  {
    this->Pass.Read(("weightTexture" + std::to_string(i)).c_str(), this->LayerWeights[i]);
  }
  for (std::size_t k = 0; k < this->LayerLight.size() && lit; ++k)
  {
    this->Pass.Read(("lightTexture" + std::to_string(k)).c_str(), this->LayerLight[k]);
  }
  program->SetUniformf("strength", static_cast<float>(plan.strength));
  this->Pass.Draw({ this->Layer.Get() }, { 0, 0, plan.width, plan.height }, vtkChiQuadPass::ADD);
}
