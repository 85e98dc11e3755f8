// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// The OpenGL engine's light: its way through the slabs, and what surfaces take of it.
#include "vtkChiOcclusionGL.h"

#include "vtkChiOcclusionBlurFS.h"
#include "vtkChiOcclusionGLTools.h"
#include "vtkChiOcclusionLightFS.h"
#include "vtkChiOcclusionLightFunctions.h"
#include "vtkChiOcclusionReceiveFS.h"
#include "vtkChiOcclusionVicinityFS.h"

#include "vtkShaderProgram.h"

#include <algorithm>
#include <string>
#include <vector>

using namespace vtkChiOcclusionGLTools;

namespace
{
// How the light of `count` directions moves into a slab; those that are not there weigh nothing.
void setShifts(vtkShaderProgram* program, const chi_occlusion_plan& plan, std::int64_t slab,
  int first, int count)
{
  float shift[CHI_PLAN_DIRECTIONS][2] = {};
  float weight[CHI_PLAN_DIRECTIONS][4] = {};
  for (int k = 0; k < count && first + k < plan.directions; ++k)
  {
    const chi_plan_shift& step = plan.shift[slab * plan.directions + first + k];
    shift[k][0] = static_cast<float>(step.x);
    shift[k][1] = static_cast<float>(step.y);
    std::copy(step.weight, step.weight + 4, weight[k]);
  }
  program->SetUniform2fv("shift", count, shift);
  program->SetUniform4fv("shiftWeight", count, weight);
}

// Slopes and weights of a batch of directions; 0 for those that are not there.
void setDirections(vtkShaderProgram* program, const chi_occlusion_plan& plan, int batch)
{
  if (plan.published)
  {
    program->SetUniform2fv("direction", plan.directions, plan.direction);
    return;
  }
  float direction[BATCH][2] = {};
  float share[BATCH] = {};
  for (int k = 0; k < BATCH && batch * BATCH + k < plan.directions; ++k)
  {
    const int m = batch * BATCH + k;
    direction[k][0] = plan.direction[m][0];
    direction[k][1] = plan.direction[m][1];
    share[k] = plan.share[m];
  }
  program->SetUniform2fv("direction", BATCH, direction);
  program->SetUniform4fv("share", BATCH / FOUR, share);
}

// The colours that a channel's light is for.
void setColors(vtkShaderProgram* program, const chi_occlusion_plan& plan, int channel)
{
  float colors[3];
  for (int c = 0; c < 3; ++c)
  {
    colors[c] = plan.channel_of[c] == channel ? 1.0f : 0.0f;
  }
  program->SetUniform3f("colors", colors);
}

// Shaders with what they call; one string each, by which programs are found again.
std::string withFunctions(const char* shader)
{
  std::string source = shader;
  vtkShaderProgram::Substitute(source, "//CHI::Functions::Dec", vtkChiOcclusionLightFunctions);
  return source;
}

const char* lightShader()
{
  static const std::string whole = withFunctions(vtkChiOcclusionLightFS);
  return whole.c_str();
}

const char* blurShader()
{
  static const std::string whole = withFunctions(vtkChiOcclusionBlurFS);
  return whole.c_str();
}

const char* const lightNames[] = { "lightTexture0", "lightTexture1", "lightTexture2",
  "lightTexture3" };
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::IsAttenuated(
  const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab) const
{
  return plan.field[field].volume && plan.channel[channel].attenuation > 0.0f &&
    !isEmpty(plan.samples[slab]);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionGL::IsBlocked(
  const chi_occlusion_plan& plan, int field, std::int64_t slab) const
{
  return plan.surface && plan.field[field].geometry && !isEmpty(plan.blockers[slab]);
}

//------------------------------------------------------------------------------
// What stands in light's way through a slab.
void vtkChiOcclusionGL::SetObstacles(vtkShaderProgram* program, const chi_occlusion_plan& plan,
  int field, int channel, std::int64_t slab)
{
  const double scale = plan.light_scale;
  if (this->IsAttenuated(plan, field, channel, slab))
  {
    this->Pass.Read("tauTexture", this->Tau[slab & 1]);
    this->Pass.Read("tauBeforeTexture", this->Tau[(slab & 1) ^ 1]);
    // of the middle of light pixel (0, 0)
    setUniform(program, "raySlope",
      { plan.slope_x + 0.5 * (scale - 1.0) * plan.slope_dx,
        plan.slope_y + 0.5 * (scale - 1.0) * plan.slope_dy });
    setUniform(program, "raySlopeStep", { scale * plan.slope_dx, scale * plan.slope_dy });
    program->SetUniformf("attenuation", plan.channel[channel].attenuation);
    program->SetUniformf("meanLength", plan.channel[channel].mean_length);
    program->SetUniformf("thin", plan.channel[channel].thin);
  }
  if (this->IsBlocked(plan, field, slab))
  {
    this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
    this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
    program->SetUniformf("slab", static_cast<float>(slab));
  }
}

//------------------------------------------------------------------------------
// The published rule.
void vtkChiOcclusionGL::DrawBlur(
  const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab)
{
  Field& light = this->Fields[field];
  vtkShaderProgram* program = this->Pass.Use(blurShader(),
    define("TAPS", plan.directions) +
      define("HAS_TAU", this->IsAttenuated(plan, field, channel, slab)) +
      define("HAS_GEOMETRY", this->IsBlocked(plan, field, slab)) +
      define("COLORED", isColored(plan)) + define("LIGHT_SCALE", plan.light_scale));
  if (!program)
  {
    return;
  }
  this->Pass.Read(lightNames[0], light.Light[channel][slab & 1][0]);
  setShifts(program, plan, slab, 0, plan.directions);
  program->SetUniform2f("path", plan.path);
  this->SetObstacles(program, plan, field, channel, slab);
  setColors(program, plan, channel);
  this->Pass.Draw({ this->Plane(plan, field, slab), light.Light[channel][(slab & 1) ^ 1][0].Get() },
    plan.light[slab],
    isColored(plan) && channel > 0 ? vtkChiQuadPass::ADD : vtkChiQuadPass::REPLACE);
  this->LightUpdates += areaOf(plan.light[slab]) * plan.directions;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawLight(
  const chi_occlusion_plan& plan, int field, int channel, std::int64_t slab)
{
  Field& light = this->Fields[field];
  const TextureList& from = light.Light[channel][slab & 1];
  const TextureList& to = light.Light[channel][(slab & 1) ^ 1];
  const int batches = batchesOf(plan);
  for (int batch = 0; batch < batches; ++batch)
  {
    const int targets = targetsOf(plan, batch);
    vtkShaderProgram* program = this->Pass.Use(lightShader(),
      define("TARGETS", targets) +
        define("HAS_TAU", this->IsAttenuated(plan, field, channel, slab)) +
        define("HAS_GEOMETRY", this->IsBlocked(plan, field, slab)) +
        define("CONTINUES", batch > 0) +
        define("COLORED", isColored(plan) && batch == batches - 1) +
        define("LIGHT_SCALE", plan.light_scale));
    if (!program)
    {
      return;
    }
    std::vector<vtkTextureObject*> into = { batch == batches - 1 ? this->Plane(plan, field, slab)
                                                                 : this->Partial[batch & 1].Get() };
    for (int k = 0; k < targets; ++k)
    {
      const std::size_t i = static_cast<std::size_t>(batch * FOUR + k);
      this->Pass.Read(lightNames[k], from[i]);
      into.push_back(to[i]);
    }
    setShifts(program, plan, slab, batch * BATCH, BATCH);
    setDirections(program, plan, batch);
    this->SetObstacles(program, plan, field, channel, slab);
    if (batch > 0)
    {
      this->Pass.Read("visibilityTexture", this->Partial[(batch & 1) ^ 1]);
    }
    const bool colored = isColored(plan) && batch == batches - 1;
    if (colored)
    {
      setColors(program, plan, channel);
    }
    this->Pass.Draw(into, plan.light[slab],
      colored && channel > 0 ? vtkChiQuadPass::ADD : vtkChiQuadPass::REPLACE);
  }
  this->LightUpdates += areaOf(plan.light[slab]) * plan.directions;
}

//------------------------------------------------------------------------------
// What surfaces or layers receive goes into the same shader's outputs, from one texture or another.
std::string vtkChiOcclusionGL::DefineReceivers(const chi_occlusion_plan& plan, bool layers) const
{
  return define("LIGHT_SCALE", plan.light_scale) + define("LAYERS", layers ? plan.layers : 0) +
    define("TAPS", plan.published ? plan.directions : 0) + defineLight(plan);
}

//------------------------------------------------------------------------------
std::vector<vtkTextureObject*> vtkChiOcclusionGL::ReadReceivers(bool layers, bool beyond)
{
  if (layers)
  {
    this->Pass.Read("layersTexture", this->Inputs.GetLayers());
    return { this->LayerLight.begin(), this->LayerLight.end() };
  }
  this->Pass.Read("surfaceTexture", this->Inputs.GetSurface());
  if (beyond)
  {
    this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
  }
  return { this->Received.Get() };
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawReceivers(
  const chi_occlusion_plan& plan, std::int64_t slab, bool layers)
{
  const int field = plan.surface_field;
  if (!plan.field[field].volume && !plan.field[field].geometry)
  {
    return; // nothing takes light from surfaces
  }
  vtkShaderProgram* program = this->Pass.Use(
    vtkChiOcclusionReceiveFS, define("BEYOND", 0) + this->DefineReceivers(plan, layers));
  if (program)
  {
    const std::vector<vtkTextureObject*> targets = this->ReadReceivers(layers, false);
    this->Pass.Read("planeTexture0", this->Plane(plan, field, slab - 1));
    this->Pass.Read("planeTexture1", this->Plane(plan, field, slab));
    setUniform(program, "planeThere", { slab > 0 ? 1.0 : 0.0, 1.0 });
    program->SetUniformf("above", static_cast<float>(slab));
    program->SetUniformf("last", slab == plan.slabs - 1 ? 1.0f : 0.0f);
    setWeights(program, plan);
    this->Pass.Draw(targets, layers ? plan.layer_receivers[slab] : plan.receivers[slab],
      layers ? vtkChiQuadPass::ADD : vtkChiQuadPass::REPLACE, targets.size());
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawBeyond(const chi_occlusion_plan& plan, bool layers)
{
  const int field = plan.surface_field;
  const chi_rect& rect = layers ? plan.layers_beyond : plan.beyond;
  if (plan.fields == 0 || isEmpty(rect) ||
    (!plan.field[field].volume && !plan.field[field].geometry))
  {
    return;
  }
  for (int channel = 0; channel < plan.channels; ++channel)
  {
    const TextureList& light = this->Fields[field].Light[channel][plan.slabs & 1];
    for (int batch = 0; batch < batchesOf(plan); ++batch)
    {
      const int lights = targetsOf(plan, batch);
      vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionReceiveFS,
        define("BEYOND", 1) + define("TARGETS", lights) + this->DefineReceivers(plan, layers));
      if (!program)
      {
        return;
      }
      const std::vector<vtkTextureObject*> targets = this->ReadReceivers(layers, true);
      for (int k = 0; k < lights; ++k)
      {
        this->Pass.Read(lightNames[k], light[static_cast<std::size_t>(batch * FOUR + k)]);
      }
      program->SetUniformf("above", static_cast<float>(plan.slabs - 1));
      setUniform(program, "lightPixels", plan.light_pixels);
      setDirections(program, plan, batch);
      setColors(program, plan, channel);
      const bool first = batch == 0 && channel == 0 && !layers;
      this->Pass.Draw(
        targets, rect, first ? vtkChiQuadPass::REPLACE : vtkChiQuadPass::ADD, targets.size());
    }
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionGL::DrawVicinity(const chi_occlusion_plan& plan)
{
  const chi_rect picture = { 0, 0, plan.width, plan.height };
  const bool near = plan.surface && plan.vicinity_samples > 0 && plan.strength > 0.0;
  vtkShaderProgram* program = this->Pass.Use(vtkChiOcclusionVicinityFS,
    define("SAMPLES", near ? plan.vicinity_samples : 0) + define("LIGHTS", plan.lights) +
      define("PLANE_RULE", plan.vicinity_plane_rule) + define("PARALLEL", plan.parallel) +
      define("COMBINE_MINIMUM", plan.combine == CHI_COMBINE_MINIMUM) + defineLight(plan) +
      define("COLORED", isColored(plan)));
  if (!program)
  {
    return;
  }
  this->Pass.Read("visibilityTexture", this->Received);
  program->SetUniformf("strength", static_cast<float>(plan.strength));
  if (near)
  {
    this->Pass.Read("surfaceMoreTexture", this->Inputs.GetSurfaceMore());
    std::vector<float> disc;
    float radius[2] = { 0.0f, 0.0f };
    float share[2] = { 0.0f, 0.0f };
    for (int light = 0; light < plan.lights; ++light)
    {
      radius[light] = static_cast<float>(plan.vicinity_radius[light]);
      share[light] = static_cast<float>(plan.vicinity_share[light]);
      disc.insert(disc.end(), &plan.vicinity_disc[light][0][0],
        &plan.vicinity_disc[light][0][0] + 2 * plan.vicinity_samples);
    }
    program->SetUniform2fv("disc", plan.lights * plan.vicinity_samples, disc.data());
    program->SetUniform2f("radius", radius);
    program->SetUniform2f("share", share);
    setUniform(program, "pixels", plan.vicinity_pixels);
    program->SetUniformf("virtualSlice", static_cast<float>(plan.vicinity_distance));
    program->SetUniformf("bias", static_cast<float>(plan.vicinity_bias));
    program->SetUniformf("curvature", static_cast<float>(plan.vicinity_curvature));
    program->SetUniformf("riseShare", static_cast<float>(plan.vicinity_rise));
    program->SetUniformf("fade", static_cast<float>(plan.vicinity_fade));
  }
  this->Pass.Draw({ this->Visibility.Get() }, picture);
}
