// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiTetTextures.h"

#include "vtkChiGLTools.h"

#include "vtkOpenGLRenderWindow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

using namespace vtkChiGLTools;

namespace
{
// A list of texels, `perItem` of them an item, in rows.
template <typename T>
bool uploadList(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, const Format& format,
  const T* items, std::size_t texels)
{
  const std::size_t width = TABLE_WIDTH;
  const std::size_t height = texels == 0 ? 1 : (texels - 1) / width + 1;
  const std::size_t values = static_cast<std::size_t>(format.Components);
  int largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (height > static_cast<std::size_t>(largest))
  {
    return false;
  }
  std::vector<T> rows(width * height * values);
  std::copy_n(items, texels * values, rows.begin());
  return Upload(texture, window, format, width, height, rows.data());
}

// As the core hands points out.
struct Point
{
  double X[3];
  float Scalar;
  float Opacity;
};
static_assert(sizeof(Point) == 4 * sizeof(double), "chi_tet_plan's points");

void split(double from, float& large, float& small)
{
  large = static_cast<float>(from);
  small = static_cast<float>(from - static_cast<double>(large));
}

void placePoint(const chi_tet_plan& plan, const Point& point, double perUnit, float texels[12])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    split(point.X[axis] * perUnit, texels[axis], texels[4 + axis]);
  }
  texels[3] = point.Scalar;
  texels[7] = point.Opacity;
  const bool before = plan.parallel == 0 && !(point.X[2] >= plan.near_depth);
  for (int axis = 0; axis < 2; ++axis)
  {
    const double at = point.X[axis] / (plan.parallel ? 1.0 : point.X[2]);
    const double pixel = (at - plan.first[axis]) / plan.step[axis];
    const double whole = std::floor(pixel);
    texels[8 + axis] = before ? 0.0f : static_cast<float>(whole);
    // floats beyond 2^24 have no more units: what lies there is off the picture by far
    texels[10 + axis] = before ? -1.0f : static_cast<float>(pixel - whole);
  }
}
}

//------------------------------------------------------------------------------
double vtkChiTetTextures::UnitOf(const chi_tet_plan& plan)
{
  const bool usable = plan.point_limit > 0.0 && std::isfinite(plan.point_limit);
  return usable ? std::exp2(std::ceil(std::log2(plan.point_limit))) : 1.0;
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::IsCurrent(vtkOpenGLRenderWindow* window, vtkTextureObject* texture,
  std::uint64_t& has, std::uint64_t version)
{
  texture->SetContext(window); // releases what belongs to another window
  const bool current = texture->GetHandle() != 0 && has == version;
  has = version;
  return current;
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::Update(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  return this->UpdateMesh(window, plan) && this->UpdateValues(window, plan) &&
    this->UpdatePoints(window, plan) && this->UpdateTables(window, plan) &&
    this->UpdateDirect(window, plan) && this->UpdatePlane(window, plan) &&
    this->UpdateSurface(window, plan);
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdateMesh(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (!this->IsCurrent(window, this->Sequence, this->SequenceVersion, plan.sequence_version) &&
    !uploadList(this->Sequence, window, UnsignedFormat(1), plan.sequence, plan.sequence_count))
  {
    return false;
  }
  if (this->IsCurrent(window, this->Vertices, this->VerticesVersion, plan.vertices_version))
  {
    return true;
  }
  return uploadList(this->Vertices, window, UnsignedFormat(4), plan.vertices, plan.count) &&
    (!plan.cells || uploadList(this->Cells, window, UnsignedFormat(1), plan.cells, plan.count));
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdateValues(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (plan.shades)
  {
    if (!uploadList(this->Shades, window, FloatFormat(2), plan.shades, 3 * plan.count))
    {
      return false;
    }
  }
  else
  {
    this->Shades->ReleaseGraphicsResources(window);
  }
  if (!plan.is_cell_data)
  {
    this->Scalars->ReleaseGraphicsResources(window);
    this->Opacities->ReleaseGraphicsResources(window);
    return true;
  }
  if (this->IsCurrent(window, this->Scalars, this->ScalarsVersion, plan.scalars_version))
  {
    return true;
  }
  return uploadList(this->Scalars, window, FloatFormat(1), plan.scalars, plan.value_count) &&
    (!plan.opacities ||
      uploadList(this->Opacities, window, FloatFormat(1), plan.opacities, plan.value_count));
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdatePoints(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (this->IsCurrent(window, this->Points, this->PointsVersion, plan.points_version))
  {
    return true;
  }
  const double perUnit = 1.0 / UnitOf(plan);
  std::vector<float> texels(12 * plan.point_count);
  for (std::size_t i = 0; i < plan.point_count; ++i)
  {
    Point point;
    std::memcpy(&point, plan.points + 4 * i, sizeof(point));
    placePoint(plan, point, perUnit, &texels[12 * i]);
  }
  return uploadList(this->Points, window, FloatFormat(4), texels.data(), 3 * plan.point_count);
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdateTables(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  const chi_segment_tables& tables = plan.tables;
  if (this->IsCurrent(window, this->Colors, this->TablesVersion, tables.version))
  {
    return true;
  }
  const std::size_t entries = static_cast<std::size_t>(tables.count) + 1;
  if (!uploadList(this->Colors, window, FloatFormat(4), tables.color[0], entries) ||
    !Upload(this->Psi, window, FloatFormat(1), CHI_PSI_SIZE, CHI_PSI_SIZE, tables.psi))
  {
    return false;
  }
  if (!tables.full)
  {
    this->Depths->ReleaseGraphicsResources(window);
    this->Full->ReleaseGraphicsResources(window);
    return true;
  }
  const std::size_t size[3] = { static_cast<std::size_t>(tables.full_size[0]),
    static_cast<std::size_t>(tables.full_size[1]), static_cast<std::size_t>(tables.full_size[2]) };
  return uploadList(this->Depths, window, FloatFormat(4), tables.depth[0], entries) &&
    Upload(this->Full, window, FloatFormat(4), size, tables.full);
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdateDirect(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (!plan.colors)
  {
    this->Direct->ReleaseGraphicsResources(window);
    return true;
  }
  if (this->IsCurrent(window, this->Direct, this->DirectVersion, plan.scalars_version))
  {
    return true;
  }
  std::vector<float> texels(4 * plan.value_count);
  for (std::size_t i = 0; i < plan.value_count; ++i)
  {
    std::copy_n(plan.colors + 3 * i, 3, &texels[4 * i]);
  }
  return uploadList(this->Direct, window, FloatFormat(4), texels.data(), plan.value_count);
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdatePlane(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (!plan.seconds)
  {
    this->Seconds->ReleaseGraphicsResources(window);
  }
  else if (!this->IsCurrent(window, this->Seconds, this->SecondsVersion, plan.scalars_version) &&
    !uploadList(this->Seconds, window, FloatFormat(1), plan.seconds, plan.count))
  {
    return false;
  }
  if (!plan.plane)
  {
    this->Plane->ReleaseGraphicsResources(window);
    return true;
  }
  const std::size_t entries =
    (static_cast<std::size_t>(plan.tables.count) + 1) * static_cast<std::size_t>(plan.plane_rows);
  return this->IsCurrent(window, this->Plane, this->PlaneVersion, plan.plane_version) ||
    uploadList(this->Plane, window, FloatFormat(4), plan.plane[0], entries);
}

//------------------------------------------------------------------------------
bool vtkChiTetTextures::UpdateSurface(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan)
{
  if (!plan.depth)
  {
    this->Surface->ReleaseGraphicsResources(window);
    return true;
  }
  return Upload(this->Surface, window, FloatFormat(1), static_cast<std::size_t>(plan.width),
    static_cast<std::size_t>(plan.height), plan.depth);
}

//------------------------------------------------------------------------------
void vtkChiTetTextures::ReleaseGraphicsResources(vtkWindow* window)
{
  for (vtkTextureObject* texture : { this->Sequence.Get(), this->Vertices.Get(), this->Points.Get(),
         this->Scalars.Get(), this->Opacities.Get(), this->Cells.Get(), this->Shades.Get(),
         this->Colors.Get(), this->Psi.Get(), this->Depths.Get(), this->Full.Get(),
         this->Direct.Get(), this->Plane.Get(), this->Seconds.Get(), this->Surface.Get() })
  {
    texture->ReleaseGraphicsResources(window);
  }
}
