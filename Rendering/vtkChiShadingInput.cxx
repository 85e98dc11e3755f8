// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiShadingInput.h"

#include "vtkCollection.h"
#include "vtkDataArray.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRenderer.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>

namespace
{
constexpr int GradientEntries = 4097;

// The ray caster takes a gradient over a quarter of the scalar range to be the largest.
constexpr double LargestGradient = 0.25;

double notNegative(double value)
{
  return std::isfinite(value) ? std::max(value, 0.0) : 0.0;
}
}

//------------------------------------------------------------------------------
void vtkChiShadingInput::CollectLights(
  vtkVolumeProperty* property, vtkRenderer* renderer, const double* view)
{
  this->Limits.clear();
  this->Lights.clear();
  this->Lit = false;
  if (!property->GetShade(0))
  {
    return;
  }
  double ambient[3] = { 0.0, 0.0, 0.0 };
  int lights = 0;
  bool headlight = false;
  vtkCollectionSimpleIterator cookie;
  vtkLightCollection* all = renderer->GetLights();
  all->InitTraversal(cookie);
  while (vtkLight* light = all->GetNextLight(cookie))
  {
    if (!light->GetSwitch())
    {
      continue;
    }
    headlight = ++lights == 1 && light->LightTypeIsHeadlight() && !light->GetPositional();
    if (lights > CHI_MAX_LIGHTS)
    {
      continue;
    }
    this->AddLight(light, view);
    for (int c = 0; c < 3; ++c)
    {
      ambient[c] += notNegative(light->GetAmbientColor()[c] * light->GetIntensity());
    }
  }
  if (lights > CHI_MAX_LIGHTS)
  {
    this->Limits.push_back("more than " + std::to_string(CHI_MAX_LIGHTS) +
      " lights are not supported: the others do not shine on the volume");
  }
  this->Lit = true;
  this->Shading = {};
  this->Shading.struct_size = sizeof(this->Shading);
  this->Shading.diffuse = notNegative(property->GetDiffuse(0));
  this->Shading.specular = notNegative(property->GetSpecular(0));
  this->Shading.specular_power = notNegative(property->GetSpecularPower(0));
  // it clamps no colours of two-dimensional transfer functions
  this->Shading.unclamped = this->Plane.GetTime(property) > 1 ? 1 : 0;
  this->Shading.two_sided = renderer->GetTwoSidedLighting() ? 1 : 0;
  // The ray caster's ambient light: of the volume's colour under one headlight, and else the
  // lights' own.
  const double share = notNegative(property->GetAmbient(0));
  if (headlight)
  {
    this->Lights[0].kind = CHI_LIGHT_EYE;
    this->Shading.ambient = share;
  }
  else
  {
    for (int c = 0; c < 3; ++c)
    {
      this->Shading.ambient_light[c] = share * ambient[c];
    }
  }
  this->Shading.lights = this->Lights.data();
  this->Shading.light_count = this->Lights.size();
}

//------------------------------------------------------------------------------
void vtkChiShadingInput::AddLight(vtkLight* light, const double* view)
{
  double position[3];
  double focus[3];
  light->GetTransformedPosition(position);
  light->GetTransformedFocalPoint(focus);
  const double from[4] = { position[0], position[1], position[2], 1.0 };
  const double along[4] = { focus[0] - position[0], focus[1] - position[1], focus[2] - position[2],
    0.0 };
  double eye[4];
  chi_shading_light out = {};
  out.kind = light->GetPositional() ? CHI_LIGHT_POSITIONAL : CHI_LIGHT_DIRECTIONAL;
  vtkMatrix4x4::MultiplyPoint(view, from, eye);
  std::copy(eye, eye + 3, out.position);
  vtkMatrix4x4::MultiplyPoint(view, along, eye);
  if (!(vtkMath::Norm(eye) > 0.0)) // focal point and position are one
  {
    eye[2] = -1.0;
  }
  std::copy(eye, eye + 3, out.direction);
  for (int c = 0; c < 3; ++c)
  {
    out.diffuse[c] = notNegative(light->GetDiffuseColor()[c] * light->GetIntensity());
    out.specular[c] = notNegative(light->GetSpecularColor()[c] * light->GetIntensity());
    out.attenuation[c] = notNegative(light->GetAttenuationValues()[c]);
  }
  out.cone_angle_rad = vtkMath::RadiansFromDegrees(notNegative(light->GetConeAngle()));
  out.exponent = notNegative(light->GetExponent());
  this->Lights.push_back(out);
}

//------------------------------------------------------------------------------
// Asking for a gradient opacity that is not there would make one.
std::uint64_t vtkChiShadingInput::GetGradientOpacityTime(vtkVolumeProperty* property)
{
  const bool asked = property->GetTransferFunctionMode() != vtkVolumeProperty::TF_2D &&
    property->HasGradientOpacity(0) && !property->GetDisableGradientOpacity(0);
  return asked ? property->GetGradientOpacity(0)->GetMTime() : 0;
}

//------------------------------------------------------------------------------
void vtkChiShadingInput::CollectGradientOpacity(
  vtkVolumeProperty* property, vtkDataArray* samples, chi_transfer_view* transfer)
{
  transfer->gradient_opacity = nullptr;
  if (GetGradientOpacityTime(property) == 0)
  {
    return;
  }
  double range[2];
  samples->GetFiniteRange(range, 0);
  const double span = range[1] > range[0] ? range[1] - range[0] : 1.0;
  transfer->gradient_end = LargestGradient * span;
  this->GradientOpacities.resize(GradientEntries);
  property->GetGradientOpacity(0)->GetTable(
    0.0, transfer->gradient_end, GradientEntries, this->GradientOpacities.data());
  for (float& value : this->GradientOpacities)
  {
    value = std::isfinite(value) ? std::min(std::max(value, 0.0f), 1.0f) : 0.0f;
  }
  if (*std::min_element(this->GradientOpacities.begin(), this->GradientOpacities.end()) < 1.0f)
  {
    transfer->gradient_opacity = this->GradientOpacities.data();
    transfer->gradient_count = GradientEntries;
  }
}
