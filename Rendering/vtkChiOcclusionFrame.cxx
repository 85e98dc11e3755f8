// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiOcclusionFrame.h"

#include "vtkAbstractVolumeMapper.h"
#include "vtkCamera.h"
#include "vtkCameraPass.h"
#include "vtkCommand.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkRenderer.h"
#include "vtkSMPTools.h"
#include "vtkVolume.h"
#include "vtkVolumeCollection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

vtkStandardNewMacro(vtkChiOcclusionFrame);
vtkInformationKeyMacro(vtkChiOcclusionFrame, FRAME, ObjectBase);

namespace
{
//------------------------------------------------------------------------------
bool isOurs(vtkAbstractVolumeMapper* mapper, bool shading)
{
  return mapper &&
    (mapper->IsA("vtkChiCombinedOcclusionVolumeMapper") ||
      (!shading && mapper->IsA("vtkChiProjectedTetrahedraMapper")));
}
}

//------------------------------------------------------------------------------
void vtkChiOcclusionFrame::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Layers: " << this->Layers.size() << "\n";
}

//------------------------------------------------------------------------------
vtkChiOcclusionFrame* vtkChiOcclusionFrame::Get(vtkRenderer* renderer)
{
  vtkInformation* information = renderer->GetInformation();
  if (!information)
  {
    vtkNew<vtkInformation> made;
    renderer->SetInformation(made);
    information = made;
  }
  vtkChiOcclusionFrame* frame = vtkChiOcclusionFrame::SafeDownCast(information->Get(FRAME()));
  if (!frame)
  {
    vtkNew<vtkChiOcclusionFrame> made;
    information->Set(FRAME(), made);
    made->Scene = renderer;
    renderer->AddObserver(
      vtkCommand::StartEvent, made.GetPointer(), &vtkChiOcclusionFrame::BeginFrame);
    renderer->AddObserver(vtkCommand::EndEvent, made.GetPointer(), &vtkChiOcclusionFrame::EndFrame);
    frame = made;
  }
  return frame;
}

//------------------------------------------------------------------------------
int vtkChiOcclusionFrame::CountVolumes(vtkRenderer* renderer, bool shading)
{
  int count = 0;
  vtkCollectionSimpleIterator cookie;
  vtkVolumeCollection* volumes = renderer->GetVolumes();
  volumes->InitTraversal(cookie);
  while (vtkVolume* volume = volumes->GetNextVolume(cookie))
  {
    count += volume->GetVisibility() && isOurs(volume->GetMapper(), shading) ? 1 : 0;
  }
  return count;
}

//------------------------------------------------------------------------------
// Whether one of these mappers will be asked to draw: VTK leaves out volumes that are not in view,
// by this test (vtkFrustumCoverageCuller).
bool vtkChiOcclusionFrame::WillDraw(bool shading) const
{
  double planes[24];
  this->Scene->GetActiveCamera()->GetFrustumPlanes(this->Scene->GetTiledAspectRatio(), planes);
  vtkCollectionSimpleIterator cookie;
  vtkVolumeCollection* volumes = this->Scene->GetVolumes();
  volumes->InitTraversal(cookie);
  while (vtkVolume* volume = volumes->GetNextVolume(cookie))
  {
    // ParaView's volumes have theirs inside: taken to be one of these where one drew last
    vtkAbstractVolumeMapper* mapper = volume->GetMapper();
    const bool draws = mapper ? isOurs(mapper, shading) : this->DrewLast[shading ? 1 : 0];
    const double* bounds = draws && volume->GetVisibility() ? volume->GetBounds() : nullptr;
    if (!bounds)
    {
      continue;
    }
    double center[3];
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      center[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
      square += std::pow(0.5 * (bounds[2 * axis + 1] - bounds[2 * axis]), 2);
    }
    bool inside = true;
    for (int i = 0; i < 6; ++i)
    {
      const double* plane = planes + 4 * i;
      inside = inside &&
        plane[0] * center[0] + plane[1] * center[1] + plane[2] * center[2] + plane[3] >
          -std::sqrt(square);
    }
    if (inside)
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionFrame::IsStock() const
{
  // ParaView's own pass draws as a renderer without one does
  vtkRenderPass* pass = this->Scene->GetPass();
  vtkCameraPass* camera = vtkCameraPass::SafeDownCast(pass);
  pass = camera ? camera->GetDelegatePass() : pass;
  return (!pass || pass->IsA("vtkPVDefaultPass")) && !this->Scene->GetUseShadows() &&
    !this->Scene->GetUseSSAO() && !this->Scene->GetUseHiddenLineRemoval();
}

//------------------------------------------------------------------------------
void vtkChiOcclusionFrame::BeginFrame()
{
  this->Layers.clear();
  this->Translucent.Show();
  this->Geometry.Detach();
  if (!this->Scene || this->Scene->GetSelector())
  {
    return;
  }
  const bool shading = !this->Missed && this->WillDraw(true);
  if (shading || this->WillDraw(false))
  {
    this->Geometry.Attach(this->Scene, shading && this->MultiSample && this->IsStock());
  }
  if (shading)
  {
    this->Translucent.Hide(this->Scene);
  }
}

//------------------------------------------------------------------------------
void vtkChiOcclusionFrame::EndFrame()
{
  const bool layersHidden = this->Translucent.IsHiding();
  const bool colorsHidden = this->Geometry.IsHiding();
  this->Translucent.Show();
  this->Geometry.Detach();
  if (!this->Scene || this->Scene->GetSelector())
  {
    return;
  }
  const bool drawn = !this->IsFirst();
  // drawn too early, or not at all: the props were to be hidden, or were not
  const bool wrong = drawn ? (!layersHidden && this->Translucent.Exist(this->Scene)) ||
      (!colorsHidden && this->MultiSample && this->IsStock() && this->Geometry.Exist(this->Scene))
                           : layersHidden || colorsHidden;
  this->Missed = (layersHidden || colorsHidden) && !drawn;
  this->DrewLast[0] = !this->Layers.empty();
  this->DrewLast[1] = drawn;
  // what lies below cannot be brought back where the renderer does not erase; render passes of
  // others (ParaView's, say, across processes) are not to be surprised
  const bool may = !this->Again && !this->Scene->GetPass() && !this->Scene->Transparent() &&
    !this->Scene->GetPreserveDepthBuffer();
  if (wrong && may)
  {
    this->Again = true;
    this->Scene->Render();
    this->Again = false;
  }
}

//------------------------------------------------------------------------------
bool vtkChiOcclusionFrame::HasDrawn(vtkVolume* volume) const
{
  return std::any_of(this->Layers.begin(), this->Layers.end(),
    [volume](const Layer& layer) { return layer.Volume == volume; });
}

//------------------------------------------------------------------------------
int vtkChiOcclusionFrame::GetNumberOfShadingLayers() const
{
  return static_cast<int>(std::count_if(
    this->Layers.begin(), this->Layers.end(), [](const Layer& layer) { return layer.Shading; }));
}

//------------------------------------------------------------------------------
const chi_surface_view* vtkChiOcclusionFrame::UpdateGeometry(
  const vtkChiCameraView& camera, int width, int height)
{
  this->Geometry.Update(
    this->Scene, camera, width, height, this->MultiSample && this->Geometry.IsHiding());
  return this->Geometry.GetView();
}

//------------------------------------------------------------------------------
vtkChiOcclusionFrame::Box vtkChiOcclusionFrame::GetBoxOf(const chi_volume_view& samples)
{
  Box box;
  std::copy_n(samples.index_to_world, 16, box.ToWorld);
  const double margin = samples.is_cell_data ? 0.5 : 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Low[axis] = -margin;
    box.High[axis] = static_cast<double>(samples.dimensions[axis]) - 1.0 + margin;
  }
  return box;
}

//------------------------------------------------------------------------------
void vtkChiOcclusionFrame::AddLayer(vtkVolume* volume, const chi_camera* camera, const Box* box,
  const chi_occlusion_image* image, bool shading)
{
  Layer layer;
  layer.Volume = volume;
  layer.Shading = shading;
  if (box)
  {
    const std::size_t pixels =
      static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
    layer.Rgba.assign(image->rgba, image->rgba + 4 * pixels);
    if (image->visibility_rgb)
    {
      layer.Visibility.assign(image->visibility_rgb, image->visibility_rgb + 3 * pixels);
    }
    else if (image->visibility)
    {
      layer.Visibility.assign(image->visibility, image->visibility + pixels);
    }
    layer.Camera = *camera;
    layer.Place = *box;
    double boxToEye[16];
    vtkMatrix4x4::Multiply4x4(camera->world_to_eye, box->ToWorld, boxToEye);
    vtkMatrix4x4::Invert(boxToEye, layer.EyeToBox);
  }
  this->Layers.push_back(std::move(layer));
}

//------------------------------------------------------------------------------
// Depth at which the ray of a pixel enters the layer's box; infinite where it misses it.
double vtkChiOcclusionFrame::Layer::EntryDepth(double x, double y) const
{
  const double* m = this->EyeToBox;
  const double* window = this->Camera.window;
  const double px = window[0] + (window[1] - window[0]) * x / this->Camera.width;
  const double py = window[2] + (window[3] - window[2]) * y / this->Camera.height;
  const bool parallel = this->Camera.parallel != 0;
  double enter = this->Camera.near_depth;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
  {
    // place in the box at depth d: base + d * slope
    const double* row = m + 4 * axis;
    const double across = row[0] * px + row[1] * py;
    const double base = row[3] + (parallel ? across : 0.0);
    const double slope = -row[2] + (parallel ? 0.0 : across);
    if (slope == 0.0)
    {
      if (base < this->Place.Low[axis] || base > this->Place.High[axis])
      {
        return std::numeric_limits<double>::infinity();
      }
      continue;
    }
    const double first = (this->Place.Low[axis] - base) / slope;
    const double second = (this->Place.High[axis] - base) / slope;
    enter = std::max(enter, std::min(first, second));
    leave = std::min(leave, std::max(first, second));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

//------------------------------------------------------------------------------
void vtkChiOcclusionFrame::MergeLastLayer(
  std::vector<float>& rgba, const std::vector<float>& specular) const
{
  rgba.clear();
  if (this->Layers.empty() || this->Layers.back().Rgba.empty())
  {
    return;
  }
  rgba = this->Layers.back().Rgba;
  vtkSMPTools::For(0, this->Layers.back().Camera.height,
    [this, &rgba, &specular](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType row = begin; row < end; ++row)
      {
        this->MergeRow(static_cast<int>(row), rgba, specular);
      }
    });
}

//------------------------------------------------------------------------------
// The frame buffer holds F + (1 - f)(G + (1 - g) S): earlier layers in front F, behind G, and scene
// S. Wanted is F + (1 - f)(n + (1 - a)(G + (1 - g)(v (S - s) + s))) with the new layer n, its alpha
// a, its visibility v of S, and the highlights s, which nobody takes. Blending multiplies what is
// there by k = (1 - a) v, so what must be added is
//   F (1 - k) + (1 - f)(n + (1 - a)(1 - v)(G + (1 - g) s)).
void vtkChiOcclusionFrame::MergeRow(
  int row, std::vector<float>& rgba, const std::vector<float>& specular) const
{
  const Layer& last = this->Layers.back();
  const int width = last.Camera.width;
  std::vector<std::pair<double, const Layer*>> order;
  for (int column = 0; column < width; ++column)
  {
    const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
      static_cast<std::size_t>(column);
    order.clear();
    for (std::size_t i = 0; i + 1 < this->Layers.size(); ++i)
    {
      const Layer& layer = this->Layers[i];
      if (layer.Rgba.size() == last.Rgba.size() && layer.Rgba[4 * pixel + 3] > 0.0f)
      {
        order.emplace_back(layer.EntryDepth(column + 0.5, row + 0.5), &layer);
      }
    }
    if (order.empty() && specular.empty())
    {
      continue;
    }
    std::stable_sort(
      order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const double here = last.EntryDepth(column + 0.5, row + 0.5);
    float front[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
    float back[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
    for (const auto& entry : order)
    {
      float* stack = entry.first <= here ? front : back;
      const float* source = entry.second->Rgba.data() + 4 * pixel;
      const float through = 1.0f - stack[3];
      for (int c = 0; c < 4; ++c)
      {
        stack[c] += through * source[c];
      }
    }
    float* target = rgba.data() + 4 * pixel;
    const bool colored =
      !last.Visibility.empty() && 4 * last.Visibility.size() == 3 * last.Rgba.size();
    for (std::size_t c = 0; c < 3; ++c)
    {
      const float visibility =
        last.Visibility.empty() ? 1.0f : last.Visibility[colored ? 3 * pixel + c : pixel];
      const float keep = (1.0f - target[3]) * visibility;
      const float highlight = specular.empty() ? 0.0f : specular[4 * pixel + c];
      const float behind = back[c] + (1.0f - back[3]) * highlight;
      target[c] = front[c] * (1.0f - keep) +
        (1.0f - front[3]) * (target[c] + (1.0f - target[3]) * (1.0f - visibility) * behind);
    }
  }
}
