// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiOcclusionTextures.h"

#include "vtkChiGLTools.h"

#include "vtkOpenGLRenderWindow.h"

#include <algorithm>
#include <cstddef>

using namespace vtkChiGLTools;

namespace
{
// Samples as they are: linear filters of the hardware have 8-bit weights, the core's have 24.
Format formatOf(chi_type type, int components = 1)
{
  static const Format formats[4][3] = {
    { { GL_R8UI, GL_RED_INTEGER, VTK_UNSIGNED_CHAR, 1 },
      { GL_RG8UI, GL_RG_INTEGER, VTK_UNSIGNED_CHAR, 2 },
      { GL_RGBA8UI, GL_RGBA_INTEGER, VTK_UNSIGNED_CHAR, 4 } },
    { { GL_R16I, GL_RED_INTEGER, VTK_SHORT, 1 }, { GL_RG16I, GL_RG_INTEGER, VTK_SHORT, 2 },
      { GL_RGBA16I, GL_RGBA_INTEGER, VTK_SHORT, 4 } },
    { { GL_R16UI, GL_RED_INTEGER, VTK_UNSIGNED_SHORT, 1 },
      { GL_RG16UI, GL_RG_INTEGER, VTK_UNSIGNED_SHORT, 2 },
      { GL_RGBA16UI, GL_RGBA_INTEGER, VTK_UNSIGNED_SHORT, 4 } },
    { { GL_R32F, GL_RED, VTK_FLOAT, 1 }, { GL_RG32F, GL_RG, VTK_FLOAT, 2 },
      { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 } },
  };
  const int row = type == CHI_U8 ? 0 : type == CHI_I16 ? 1 : type == CHI_U16 ? 2 : 3;
  return formats[row][components == 1 ? 0 : components == 2 ? 1 : 2]; // of three, one lies idle
}

// Samples of several components, the plan's own first.
template <typename T>
bool uploadComponents(
  vtkTextureObject* texture, vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  const chi_plan_components& all = *plan.components;
  const Format format = formatOf(plan.type, all.count + 1);
  const std::size_t step = static_cast<std::size_t>(format.Components);
  const std::size_t count = plan.dimensions[0] * plan.dimensions[1] * plan.dimensions[2];
  std::vector<T> texels(step * count);
  for (int k = 0; k <= all.count; ++k)
  {
    const T* from = static_cast<const T*>(k == 0 ? plan.scalars : all.more[k - 1].scalars);
    T* to = texels.data() + k;
    for (std::size_t i = 0; i < count; ++i, to += step)
    {
      *to = from[i];
    }
  }
  return Upload(texture, window, format, plan.dimensions, texels.data());
}
}

//------------------------------------------------------------------------------
const char* vtkChiOcclusionTextures::SamplerOf(chi_type type)
{
  return type == CHI_F32 ? "sampler3D" : type == CHI_I16 ? "isampler3D" : "usampler3D";
}

//------------------------------------------------------------------------------
std::size_t vtkChiOcclusionTextures::FirstEntryOf(const chi_occlusion_plan& plan, int component)
{
  std::size_t first = plan.entries;
  for (int k = 0; k < component; ++k)
  {
    first += static_cast<std::size_t>(plan.components->more[k].entries);
  }
  return first;
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::Update(vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  bool good = true;
  if (plan.scalars)
  {
    good = this->UpdateVolume(window, plan) && this->UpdateTables(window, plan) &&
      this->UpdateGradientOpacity(window, plan) && this->UpdateSecond(window, plan) &&
      this->UpdateMask(window, plan);
  }
  if (plan.surface)
  {
    good = good && this->UpdateSurfaces(window, plan);
  }
  else
  {
    this->Surface->ReleaseGraphicsResources(window);
    this->SurfaceMore->ReleaseGraphicsResources(window);
  }
  good = good && this->UpdateGuide(window, plan) && this->UpdateLayers(window, plan);
  this->FrameVersion = plan.frame_version;
  return good;
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateVolume(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  this->Volume->SetContext(window); // releases what belongs to another window
  if (this->Volume->GetHandle() != 0 && this->VolumeVersion == plan.volume_version)
  {
    return true;
  }
  this->VolumeVersion = plan.volume_version;
  if (!plan.components)
  {
    return Upload(this->Volume, window, formatOf(plan.type), plan.dimensions, plan.scalars);
  }
  switch (plan.type)
  {
    case CHI_U8:
      return uploadComponents<std::uint8_t>(this->Volume, window, plan);
    case CHI_I16:
      return uploadComponents<std::int16_t>(this->Volume, window, plan);
    case CHI_U16:
      return uploadComponents<std::uint16_t>(this->Volume, window, plan);
    default:
      return uploadComponents<float>(this->Volume, window, plan);
  }
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateTables(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  this->Colors->SetContext(window);
  if (this->Colors->GetHandle() != 0 && this->TableVersion == plan.table_version)
  {
    return true;
  }
  this->TableVersion = plan.table_version;
  // behind the plan's own table, of two quantities row after row, or those of the components
  const chi_plan_shading* shading = plan.shading;
  const std::size_t rows =
    shading && shading->plane_table ? static_cast<std::size_t>(shading->plane_end) + 1 : 0;
  const int components = plan.components ? plan.components->count : 0;
  const std::size_t entries =
    components ? FirstEntryOf(plan, components) : plan.entries * (rows + 1);
  const std::size_t width = TABLE_WIDTH;
  const std::size_t height = (entries - 1) / width + 1;
  const std::size_t colorHeight = (plan.entries - 1) / width + 1;
  int largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (height > static_cast<std::size_t>(largest))
  {
    return false;
  }
  std::vector<std::int32_t> sums(width * height);
  std::vector<float> sigma(2 * width * height);
  std::vector<float> colors(4 * width * height);
  std::vector<std::int32_t> colorSums(4 * width * colorHeight);
  std::vector<float> colorMeans(4 * width * colorHeight);
  const auto place =
    [&](std::size_t first, const chi_plan_entry* table, const float(*rgba)[4], std::size_t count)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      sums[first + i] = table[i].sum;
      sigma[2 * (first + i)] = table[i].sigma;
      sigma[2 * (first + i) + 1] = table[i].half_slope;
      std::copy(rgba[i], rgba[i] + 4, &colors[4 * (first + i)]);
    }
  };
  place(0, plan.table, plan.rgba, plan.entries);
  if (rows > 0)
  {
    place(plan.entries, shading->plane_table, shading->plane_rgba, rows * plan.entries);
  }
  for (int k = 0; k < components; ++k)
  {
    const chi_plan_component& one = plan.components->more[k];
    place(FirstEntryOf(plan, k), one.table, one.rgba, static_cast<std::size_t>(one.entries));
  }
  for (std::size_t i = 0; i < plan.entries; ++i)
  {
    std::copy(plan.colors[i].sum, plan.colors[i].sum + 4, &colorSums[4 * i]);
    std::copy(plan.colors[i].rgb, plan.colors[i].rgb + 4, &colorMeans[4 * i]);
  }
  return Upload(this->Sums, window, { GL_R32I, GL_RED_INTEGER, VTK_INT, 1 }, width, height,
           sums.data()) &&
    Upload(this->Sigma, window, { GL_RG32F, GL_RG, VTK_FLOAT, 2 }, width, height, sigma.data()) &&
    Upload(
      this->Colors, window, { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 }, width, height, colors.data()) &&
    Upload(this->ColorSums, window, { GL_RGBA32I, GL_RGBA_INTEGER, VTK_INT, 4 }, width, colorHeight,
      colorSums.data()) &&
    Upload(this->ColorMeans, window, { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 }, width, colorHeight,
      colorMeans.data()) &&
    Upload(this->Bricks, window, { GL_R8UI, GL_RED_INTEGER, VTK_UNSIGNED_CHAR, 1 }, plan.bricks,
      plan.occupied);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateGradientOpacity(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  const float* opacity = plan.shading ? plan.shading->gradient_opacity : nullptr;
  if (!opacity)
  {
    this->GradientOpacity->ReleaseGraphicsResources(window);
    return true;
  }
  this->GradientOpacity->SetContext(window);
  if (this->GradientOpacity->GetHandle() != 0 && this->GradientVersion == plan.table_version)
  {
    return true;
  }
  this->GradientVersion = plan.table_version;
  const std::size_t width = TABLE_WIDTH;
  const std::size_t entries = static_cast<std::size_t>(plan.shading->gradient_end) + 1;
  const std::size_t height = (entries - 1) / width + 1;
  std::vector<float> values(opacity, opacity + entries);
  values.resize(width * height);
  return Upload(
    this->GradientOpacity, window, { GL_R32F, GL_RED, VTK_FLOAT, 1 }, width, height, values.data());
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateSecond(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  const float* samples = plan.shading ? plan.shading->plane_second : nullptr;
  if (!samples)
  {
    this->Second->ReleaseGraphicsResources(window);
    return true;
  }
  this->Second->SetContext(window);
  if (this->Second->GetHandle() != 0 && this->SecondVersion == plan.table_version)
  {
    return true;
  }
  this->SecondVersion = plan.table_version;
  return Upload(this->Second, window, formatOf(CHI_F32), plan.dimensions, samples);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateMask(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  static_assert(CHI_PLAN_GRIDS == 2, "ReleaseGraphicsResources lists them");
  const bool kept = this->MaskVersion == plan.mask_version;
  const int grids = plan.cut ? plan.cut->grids : 0;
  bool good = true;
  for (int k = 0; k < CHI_PLAN_GRIDS; ++k)
  {
    vtkTextureObject* texture = this->Keep[k];
    if (k >= grids)
    {
      texture->ReleaseGraphicsResources(window);
      continue;
    }
    texture->SetContext(window);
    if (kept && texture->GetHandle() != 0)
    {
      continue;
    }
    // rows of words, about as many as they are long: as few as fit into any texture
    const chi_plan_grid& grid = plan.cut->grid[k];
    const std::size_t words =
      static_cast<std::size_t>(grid.step_z) * (static_cast<std::size_t>(grid.last[2]) + 1) / 32 + 1;
    std::size_t width = 1;
    while (width * width < words)
    {
      width *= 2;
    }
    std::vector<std::uint32_t> rows(grid.bits, grid.bits + words);
    rows.resize(((words - 1) / width + 1) * width);
    good = good &&
      Upload(texture, window, { GL_R32UI, GL_RED_INTEGER, VTK_UNSIGNED_INT, 1 }, width,
        rows.size() / width, rows.data());
  }
  if (!plan.labels)
  {
    this->Labels->ReleaseGraphicsResources(window);
  }
  else
  {
    this->Labels->SetContext(window);
    good = good &&
      ((kept && this->Labels->GetHandle() != 0) ||
        Upload(this->Labels, window, formatOf(CHI_U8), plan.dimensions, plan.labels));
  }
  this->MaskVersion = plan.mask_version;
  return good;
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateSurfaces(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  this->Surface->SetContext(window);
  if (this->Surface->GetHandle() != 0 && this->FrameVersion == plan.frame_version)
  {
    return true;
  }
  const Format format = { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 };
  const std::size_t width = static_cast<std::size_t>(plan.width);
  const std::size_t height = static_cast<std::size_t>(plan.height);
  return Upload(this->Surface, window, format, width, height, plan.surface) &&
    Upload(this->SurfaceMore, window, format, width, height, plan.surface_more);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateGuide(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  if (!plan.guide)
  {
    this->Guide->ReleaseGraphicsResources(window);
    return true;
  }
  this->Guide->SetContext(window);
  return (this->Guide->GetHandle() != 0 && this->FrameVersion == plan.frame_version) ||
    Upload(this->Guide, window, { GL_R32F, GL_RED, VTK_FLOAT, 1 },
      static_cast<std::size_t>(plan.full_width), static_cast<std::size_t>(plan.full_height),
      plan.guide);
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionTextures::UpdateLayers(
  vtkOpenGLRenderWindow* window, const chi_occlusion_plan& plan)
{
  if (plan.layers == 0)
  {
    this->Layers->ReleaseGraphicsResources(window);
    this->LayerColors->ReleaseGraphicsResources(window);
    return true;
  }
  this->Layers->SetContext(window);
  if (this->Layers->GetHandle() != 0 && this->FrameVersion == plan.frame_version)
  {
    return true;
  }
  const Format format = { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 };
  const std::size_t width = static_cast<std::size_t>(plan.width);
  const std::size_t height = static_cast<std::size_t>(plan.layers * plan.height);
  return Upload(this->Layers, window, format, width, height, plan.layer) &&
    Upload(this->LayerColors, window, format, width, height, plan.layer_rgba);
}

//------------------------------------------------------------------------------
void vtkChiOcclusionTextures::ReleaseGraphicsResources(vtkWindow* window)
{
  for (vtkTextureObject* texture : { this->Volume.Get(), this->Bricks.Get(), this->Sums.Get(),
         this->Sigma.Get(), this->Colors.Get(), this->ColorSums.Get(), this->ColorMeans.Get(),
         this->GradientOpacity.Get(), this->Second.Get(), this->Keep[0].Get(), this->Keep[1].Get(),
         this->Labels.Get(), this->Surface.Get(), this->SurfaceMore.Get(), this->Guide.Get(),
         this->Layers.Get(), this->LayerColors.Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
}
