// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiSelection.h"

#include "vtkChiSelectionFS.h"

#include "vtkDataObject.h"
#include "vtkHardwareSelector.h"
#include "vtkMatrix4x4.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkRenderer.h"
#include "vtkShaderProgram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace
{
//------------------------------------------------------------------------------
// Id of the point or cell of the input at a place in index space.
vtkIdType idAt(const double place[3], const chi_volume_view& samples, bool cells)
{
  const bool ofCells = samples.is_cell_data != 0; // its samples lie in the middle of cells
  vtkIdType id = 0;
  for (int axis = 2; axis >= 0; --axis)
  {
    const vtkIdType count = static_cast<vtkIdType>(samples.dimensions[axis]);
    const vtkIdType items = std::max<vtkIdType>(count + (ofCells ? 1 : 0) - (cells ? 1 : 0), 1);
    const double shift = ofCells == cells ? 0.5 : ofCells ? 1.0 : 0.0;
    const vtkIdType at = static_cast<vtkIdType>(std::floor(place[axis] + shift));
    id = id * items + std::min(std::max<vtkIdType>(at, 0), items - 1);
  }
  return id;
}
}

//------------------------------------------------------------------------------
vtkChiSelection::Ids vtkChiSelection::GetIdsOfImage(
  const chi_camera& camera, const chi_volume_view& samples)
{
  std::array<double, 16> eyeToIndex;
  vtkMatrix4x4::Multiply4x4(camera.world_to_eye, samples.index_to_world, eyeToIndex.data());
  vtkMatrix4x4::Invert(eyeToIndex.data(), eyeToIndex.data());
  Ids ids;
  ids.Points = 1;
  ids.Cells = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const vtkIdType count = static_cast<vtkIdType>(samples.dimensions[axis]);
    ids.Points *= count + (samples.is_cell_data ? 1 : 0);
    ids.Cells *= std::max<vtkIdType>(count - (samples.is_cell_data ? 0 : 1), 1);
  }
  ids.Find = [eyeToIndex, &samples](std::size_t, const double eye[3], bool cell)
  {
    const double from[4] = { eye[0], eye[1], eye[2], 1.0 };
    double place[4];
    vtkMatrix4x4::MultiplyPoint(eyeToIndex.data(), from, place);
    return idAt(place, samples, cell);
  };
  return ids;
}

//------------------------------------------------------------------------------
vtkChiSelection::vtkChiSelection() = default;

//------------------------------------------------------------------------------
vtkChiSelection::~vtkChiSelection()
{
  delete this->Quad;
}

//------------------------------------------------------------------------------
bool vtkChiSelection::IsKnown(vtkHardwareSelector* selector, vtkVolume* volume,
  const vtkChiCameraView& camera, int width, int height) const
{
  return selector->GetCurrentPass() != vtkHardwareSelector::MIN_KNOWN_PASS &&
    volume == this->Volume && width == this->Width && height == this->Height &&
    std::equal(this->View, this->View + 16, camera.GetView()) &&
    std::equal(this->Projection, this->Projection + 16, camera.GetProjection());
}

//------------------------------------------------------------------------------
float* vtkChiSelection::Allocate(
  vtkVolume* volume, const vtkChiCameraView& camera, int width, int height)
{
  this->Volume = volume;
  this->Width = width;
  this->Height = height;
  std::copy_n(camera.GetView(), 16, this->View);
  std::copy_n(camera.GetProjection(), 16, this->Projection);
  this->Depths.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
    std::numeric_limits<float>::infinity());
  return this->Depths.data();
}

//------------------------------------------------------------------------------
// One colour for all pixels, or that of the voxel in each.
void vtkChiSelection::SetColors(vtkHardwareSelector* selector, const chi_camera& camera,
  const Ids& ids, std::vector<float>& pixels) const
{
  const int pass = selector->GetCurrentPass();
  const bool points =
    pass == vtkHardwareSelector::POINT_ID_LOW24 || pass == vtkHardwareSelector::POINT_ID_HIGH24;
  const bool cells =
    pass == vtkHardwareSelector::CELL_ID_LOW24 || pass == vtkHardwareSelector::CELL_ID_HIGH24;
  const int shift =
    pass == vtkHardwareSelector::POINT_ID_HIGH24 || pass == vtkHardwareSelector::CELL_ID_HIGH24 ? 24
                                                                                                : 0;
  float same[3];
  selector->GetPropColorValue(same);
  for (std::size_t pixel = 0; pixel < this->Depths.size(); ++pixel)
  {
    float* color = pixels.data() + 4 * pixel;
    std::copy_n(same, 3, color);
    if (!(points || cells) || color[3] >= 1.0f)
    {
      continue;
    }
    const std::size_t width = static_cast<std::size_t>(this->Width);
    const double depth = static_cast<double>(this->Depths[pixel]);
    const double scale = camera.parallel ? 1.0 : depth;
    const double u = (static_cast<double>(pixel % width) + 0.5) / this->Width;
    const double v = (static_cast<double>(pixel / width) + 0.5) / this->Height;
    const double eye[3] = { scale * (camera.window[0] + u * (camera.window[1] - camera.window[0])),
      scale * (camera.window[2] + v * (camera.window[3] - camera.window[2])), -depth };
    const vtkIdType id = ids.Find(pixel, eye, cells) >> shift;
    for (int c = 0; c < 3; ++c)
    {
      color[c] = static_cast<float>((id >> (8 * c)) & 255) / 255.0f;
    }
  }
}

//------------------------------------------------------------------------------
bool vtkChiSelection::Draw(vtkRenderer* renderer, const vtkChiCameraView& camera, const Ids& ids)
{
  vtkHardwareSelector* selector = renderer->GetSelector();
  std::vector<float> pixels(4 * this->Depths.size());
  for (std::size_t pixel = 0; pixel < this->Depths.size(); ++pixel)
  {
    const double depth = static_cast<double>(this->Depths[pixel]);
    // the last depth in front of the far plane, where the volume reaches beyond it
    const double window =
      std::isfinite(depth) ? std::min(camera.WindowDepth(depth), 1.0 - 6e-8) : 1;
    pixels[4 * pixel + 3] = static_cast<float>(std::max(window, 0.0));
  }
  selector->BeginRenderProp();
  if (selector->GetCurrentPass() == vtkHardwareSelector::COMPOSITE_INDEX_PASS)
  {
    selector->RenderCompositeIndex(1);
  }
  selector->UpdateMaximumPointId(ids.Points);
  selector->UpdateMaximumCellId(ids.Cells);
  this->SetColors(selector, *camera.Get(), ids, pixels);
  const bool good = this->DrawQuad(renderer, pixels);
  selector->EndRenderProp();
  return good;
}

//------------------------------------------------------------------------------
bool vtkChiSelection::DrawQuad(vtkRenderer* renderer, const std::vector<float>& pixels)
{
  vtkOpenGLRenderWindow* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  this->Texture->SetContext(window);
  this->Texture->SetMinificationFilter(vtkTextureObject::Nearest);
  this->Texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  // the texture's interface takes no const, and only reads
  this->Texture->Create2DFromRaw(static_cast<unsigned int>(this->Width),
    static_cast<unsigned int>(this->Height), 4, VTK_FLOAT, const_cast<float*>(pixels.data()));
  if (this->Quad && this->QuadWindow.GetPointer() != window)
  {
    delete this->Quad;
    this->Quad = nullptr;
  }
  if (this->Quad)
  {
    window->GetShaderCache()->ReadyShaderProgram(this->Quad->Program);
  }
  else
  {
    this->QuadWindow = window;
    this->Quad = new vtkOpenGLQuadHelper(window, nullptr, vtkChiSelectionFS, "");
  }
  if (!this->Quad->Program)
  {
    return false;
  }
  vtkOpenGLState* state = window->GetState();
  vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
  vtkOpenGLState::ScopedglEnableDisable depthTest(state, GL_DEPTH_TEST);
  vtkOpenGLState::ScopedglEnableDisable cullFace(state, GL_CULL_FACE);
  vtkOpenGLState::ScopedglDepthMask depthMask(state);
  vtkOpenGLState::ScopedglDepthFunc depthFunc(state);
  state->vtkglDisable(GL_BLEND);
  state->vtkglEnable(GL_DEPTH_TEST);
  state->vtkglDisable(GL_CULL_FACE);
  state->vtkglDepthMask(GL_TRUE);
  state->vtkglDepthFunc(GL_LEQUAL);
  this->Texture->Activate();
  this->Quad->Program->SetUniformi("idTexture", this->Texture->GetTextureUnit());
  this->Quad->Render();
  this->Texture->Deactivate();
  return true;
}

//------------------------------------------------------------------------------
void vtkChiSelection::ReleaseGraphicsResources(vtkWindow* window)
{
  delete this->Quad;
  this->Quad = nullptr;
  if (window)
  {
    this->Texture->ReleaseGraphicsResources(window);
  }
}
