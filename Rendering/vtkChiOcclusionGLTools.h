// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiOcclusionGLTools_h
#define vtkChiOcclusionGLTools_h

#include "vtkChiGLTools.h"

#include <chiaroscuro/chi_occlusion_plan.h>

#include "vtkShaderProgram.h"

#include <algorithm>
#include <cstdint>
#include <string>

// Shared by the sources of vtkChiOcclusionGL.
namespace vtkChiOcclusionGLTools
{
constexpr int FOUR = 4;   // directions a texture
constexpr int BATCH = 16; // directions a pass

// The published rule has one buffer for all of them.
inline int batchesOf(const chi_occlusion_plan& plan)
{
  return plan.published ? 1 : (plan.directions - 1) / BATCH + 1;
}

// Light textures of a batch.
inline int targetsOf(const chi_occlusion_plan& plan, int batch)
{
  return plan.published ? 1 : (std::min(plan.directions - batch * BATCH, BATCH) - 1) / FOUR + 1;
}

inline bool isEmpty(const chi_rect& rect)
{
  return rect.x0 >= rect.x1 || rect.y0 >= rect.y1;
}

inline bool isWithin(const chi_rect& inner, const chi_rect& outer)
{
  return isEmpty(inner) ||
    (inner.x0 >= outer.x0 && inner.x1 <= outer.x1 && inner.y0 >= outer.y0 && inner.y1 <= outer.y1);
}

// Textures for the weights of layers.
inline std::size_t weightsOf(const chi_occlusion_plan& plan)
{
  return static_cast<std::size_t>((plan.layers + 2) / 3);
}

inline std::int64_t areaOf(const chi_rect& rect)
{
  return static_cast<std::int64_t>(rect.x1 - rect.x0) * (rect.y1 - rect.y0);
}

inline std::string define(const char* name, int value)
{
  return vtkChiGLTools::Define(name, value);
}

inline bool isColored(const chi_occlusion_plan& plan)
{
  return plan.channels > 1;
}

// The type of light in shaders, and where it stands in textures.
inline std::string defineLight(const chi_occlusion_plan& plan)
{
  return isColored(plan) ? "#define LIGHT vec3\n#define CHANNELS rgb\n"
                         : "#define LIGHT float\n#define CHANNELS r\n";
}

// Narrowed for the shader.
template <std::size_t N>
void setUniform(vtkShaderProgram* program, const char* name, const double (&value)[N])
{
  float single[N];
  std::copy(value, value + N, single);
  N == 2 ? program->SetUniform2f(name, single) : program->SetUniform3f(name, single);
}

// Of the light pixels about a pixel.
inline void setWeights(vtkShaderProgram* program, const chi_occlusion_plan& plan)
{
  float weights[3][3];
  for (int i = 0; i < 3; ++i)
  {
    std::copy(plan.light_weight[i], plan.light_weight[i] + 3, weights[i]);
  }
  program->SetUniform3fv("lightWeight", 3, weights);
}
}

#endif
