// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiShadingInput_h
#define vtkChiShadingInput_h

#include "vtkChiPlaneInput.h"

#include <chiaroscuro/chi_shading.h>
#include <chiaroscuro/chi_transfer.h>

#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkLight;
class vtkRenderer;
class vtkVolumeProperty;

// What gradients do to a volume, for the C core: the material of a vtkVolumeProperty under the
// lights of a renderer, and its gradient opacity as a table; both as vtkGPUVolumeRayCastMapper
// reads them.
class vtkChiShadingInput
{
public:
  // `view` is the row-major matrix from world to eye coordinates.
  void CollectLights(vtkVolumeProperty* property, vtkRenderer* renderer, const double* view);

  // Adds the gradient opacity over the range of the samples, the first component's, to `transfer`.
  void CollectGradientOpacity(
    vtkVolumeProperty* property, vtkDataArray* samples, chi_transfer_view* transfer);

  // The transfer function of two quantities, instead of all others where there is one.
  vtkChiPlaneInput* GetPlane() { return &this->Plane; }

  // Time stamp of the gradient opacity, 0 where it is not asked for.
  static std::uint64_t GetGradientOpacityTime(vtkVolumeProperty* property);

  // Null: the volume is unlit.
  const chi_shading_view* GetShading() const { return this->Lit ? &this->Shading : nullptr; }
  const std::vector<std::string>& GetLimits() const { return this->Limits; }

private:
  void AddLight(vtkLight* light, const double* view);

  bool Lit = false;
  chi_shading_view Shading = {};
  std::vector<chi_shading_light> Lights;
  std::vector<float> GradientOpacities;
  vtkChiPlaneInput Plane;
  std::vector<std::string> Limits;
};

#endif
