// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkChiCombinedOcclusionInternals.h"
#include "vtkChiExec.h"
#include "vtkChiPassKeys.h"

#include "vtkAlgorithm.h"
#include "vtkDataSet.h"
#include "vtkMath.h"
#include "vtkMultiVolume.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkChiCombinedOcclusionVolumeMapper);

namespace
{
//------------------------------------------------------------------------------
// World units; of a sheared box the root of its edges' squares.
double diagonalOf(const chi_volume_view& volume)
{
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double cells =
      static_cast<double>(volume.dimensions[axis]) - (volume.is_cell_data ? 0.0 : 1.0);
    for (int row = 0; row < 3; ++row)
    {
      const double edge = volume.index_to_world[4 * row + axis] * cells;
      square += edge * edge;
    }
  }
  return std::sqrt(square);
}

//------------------------------------------------------------------------------
double diagonalOfProps(vtkRenderer* renderer)
{
  double bounds[6];
  renderer->ComputeVisiblePropBounds(bounds);
  const double diagonal = vtkMath::AreBoundsInitialized(bounds)
    ? std::sqrt((bounds[1] - bounds[0]) * (bounds[1] - bounds[0]) +
        (bounds[3] - bounds[2]) * (bounds[3] - bounds[2]) +
        (bounds[5] - bounds[4]) * (bounds[5] - bounds[4]))
    : 0.0;
  return std::isfinite(diagonal) ? diagonal : 0.0;
}
}

//------------------------------------------------------------------------------
vtkChiCombinedOcclusionVolumeMapper::vtkChiCombinedOcclusionVolumeMapper()
  : Internal(new Internals)
{
}

//------------------------------------------------------------------------------
vtkChiCombinedOcclusionVolumeMapper::~vtkChiCombinedOcclusionVolumeMapper()
{
  this->SetTransfer2DYAxisArray(nullptr);
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SetTransferFunction2D(vtkChiTransferFunction2D* function)
{
  if (function != this->GetTransferFunction2D())
  {
    this->Internal->Input.GetShading()->GetPlane()->SetFunction(function);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkChiTransferFunction2D* vtkChiCombinedOcclusionVolumeMapper::GetTransferFunction2D()
{
  return this->Internal->Input.GetShading()->GetPlane()->GetFunction();
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SetGeometryOcclusion(bool on)
{
  this->SetVolumeToGeometry(on);
  this->SetGeometryToVolume(on);
  this->SetGeometryToGeometry(on);
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SetAttenuationColor(double red, double green, double blue)
{
  const double asked[3] = { red, green, blue };
  double taken[3];
  for (int c = 0; c < 3; ++c)
  {
    taken[c] = asked[c] > 0.0 ? std::min(asked[c], 1000.0) : 0.0;
  }
  if (!std::equal(taken, taken + 3, this->AttenuationColor))
  {
    std::copy_n(taken, 3, this->AttenuationColor);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::ApplyPublishedPreset()
{
  this->SetOcclusionMethodToPublished();
  this->SetOcclusionResolutionToFull();
  this->SetOcclusionBias(0.0);
  this->SetGeometryThicknessToInfinity();
  this->VicinityOcclusionOn();
  this->SetVicinityDepthBias(0.0);
  this->SetNumberOfVicinitySamples(81);
  this->SetCombineModeToProduct();
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SayOnce(const char* what, bool isError)
{
  std::set<std::string>& said = isError ? this->Internal->Errors : this->Internal->Warnings;
  if (!said.insert(what).second)
  {
    return;
  }
  if (isError)
  {
    vtkErrorMacro(<< what);
  }
  else
  {
    vtkWarningMacro(<< what);
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  in.Window = renderer->GetRenderWindow();
  in.Scene = renderer;
  if (!vtkOpenGLRenderWindow::SafeDownCast(in.Window))
  {
    return;
  }
  in.Frame = vtkChiOcclusionFrame::Get(renderer);
  if (renderer->GetSelector())
  {
    this->RenderSelection(renderer, volume);
    return;
  }
  in.Selection.Forget();
  in.Interactive =
    this->AutoAdjustQuality && volume->GetAllocatedRenderTime() * this->InteractiveUpdateRate < 1.0;
  const double start = vtkTimerLog::GetUniversalTime();
  in.Peeling = vtkChiIsPeeled(volume);
  if (in.Frame->HasDrawn(volume))
  {
    if (in.Peeling)
    {
      return;
    }
    in.Frame->Forget();
  }
  if (this->Collect(renderer, volume))
  {
    in.SecondsCollect = vtkTimerLog::GetUniversalTime() - start;
    this->Surface(renderer);
    if (this->RenderEngine())
    {
      this->Composite(renderer, volume);
    }
  }
  in.SecondsTotal = vtkTimerLog::GetUniversalTime() - start;
  this->Report();
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::Collect(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  in.Image = {};
  // the viewport that is set, not the renderer's place in the window: render passes draw elsewhere
  glGetIntegerv(GL_VIEWPORT, in.Viewport);
  if (in.Viewport[2] < 1 || in.Viewport[3] < 1)
  {
    return false;
  }
  const char* reason = in.Camera.Collect(renderer, in.Viewport[2], in.Viewport[3]);
  if (reason)
  {
    this->SayOnce((std::string("nothing is drawn: ") + reason).c_str(), true);
    return false;
  }
  if (in.Camera.GetLimit())
  {
    this->SayOnce(in.Camera.GetLimit());
  }
  in.First = in.Frame->IsFirst();
  in.Shared = vtkChiOcclusionFrame::CountVolumes(renderer, false) > 1;

  if (this->GetInputAlgorithm())
  {
    this->GetInputAlgorithm()->Update();
  }
  in.Input.SetSecondArray(this->Transfer2DYAxisArray);
  in.HasVolume =
    in.Input.Collect(this, this->GetInput(), this->ScalarMode, volume, in.Camera.GetWorld());
  if (!in.HasVolume && !in.Input.IsEmpty())
  {
    this->SayOnce(in.Input.GetProblem().c_str(), true);
  }
  for (const std::string& limit : in.Input.GetLimits())
  {
    this->SayOnce(limit.c_str());
  }
  if (in.HasVolume)
  {
    this->CollectMasks(volume);
  }
  in.Diagonal = in.HasVolume ? diagonalOf(*in.Input.GetVolume()) : 0.0;
  if (in.HasVolume)
  {
    this->CollectUnsupported(volume);
    vtkChiShadingInput* shading = in.Input.GetShading();
    shading->CollectLights(volume->GetProperty(), renderer, in.Camera.GetView());
    for (const std::string& limit : shading->GetLimits())
    {
      this->SayOnce(limit.c_str());
    }
    in.HasVolume = in.Camera.Reaches(in.Input.GetVolume());
  }
  this->CollectParameters();
  this->CollectQuality(volume->GetAllocatedRenderTime());
  return true;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::CollectMasks(vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const bool binary = this->MaskType == BinaryMaskType;
  in.HasLabels = in.MaskInput && !binary && !in.Input.GetTransfer()->plane &&
    in.Labels.Collect(volume->GetProperty(), *in.Input.GetTransfer(), this->MaskBlendFactor);
  vtkImageData* mask = binary || in.HasLabels ? in.MaskInput.Get() : nullptr;
  if (!in.Masks.CollectCrop(this, volume, in.Camera.GetWorld()) ||
    !in.Masks.CollectMask(this->GetInput(), *in.Input.GetVolume(), mask,
      in.HasLabels ? &in.Labels.GetTableOfValue() : nullptr))
  {
    this->SayOnce(in.Masks.GetProblem().c_str(), true);
    in.HasVolume = false;
  }
  in.HasLabels = in.HasLabels && in.Masks.GetMask();
  for (const std::string& limit : in.Masks.GetLimits())
  {
    this->SayOnce(limit.c_str());
  }
  for (const std::string& limit : in.Labels.GetLimits())
  {
    this->SayOnce(limit.c_str());
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SetMaskInput(vtkImageData* mask)
{
  if (this->Internal->MaskInput != mask)
  {
    this->Internal->MaskInput = mask;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkImageData* vtkChiCombinedOcclusionVolumeMapper::GetMaskInput()
{
  return this->Internal->MaskInput;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::CollectUnsupported(vtkVolume* volume)
{
  vtkVolumeProperty* property = volume->GetProperty();
  const auto check = [this](bool asked, const char* what)
  {
    if (asked)
    {
      this->SayOnce(what);
    }
  };
  check(this->Internal->MaskInput && this->MaskType == LabelMapMaskType &&
      property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D,
    "label map masks are not supported with two-dimensional transfer functions: labels are "
    "ignored");
  check(this->BlendMode != COMPOSITE_BLEND,
    "only the composite blend mode is supported yet: composite is used");
  check(vtkMultiVolume::SafeDownCast(volume) != nullptr,
    "vtkMultiVolume is not supported: this mapper's own input is drawn");
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::CollectParameters()
{
  Internals& in = *this->Internal;
  chi_occlusion_params& params = in.Params;
  chi_occlusion_default_params(&params);
  params.method =
    this->OcclusionMethod == PUBLISHED ? CHI_OCCLUSION_PUBLISHED : CHI_OCCLUSION_ORDINATES;
  params.directions = this->NumberOfDirections;
  params.half_size = this->OcclusionResolution == HALF ? 1 : 0;
  params.interactions = (this->VolumeToVolume ? CHI_VOLUME_TO_VOLUME : 0) |
    (this->VolumeToGeometry ? CHI_VOLUME_TO_GEOMETRY : 0) |
    (this->GeometryToVolume ? CHI_GEOMETRY_TO_VOLUME : 0) |
    // geometry darkens itself once a frame, not once a volume
    (this->GeometryToGeometry && in.First ? CHI_GEOMETRY_TO_GEOMETRY : 0);
  params.cone_angle_rad = vtkMath::RadiansFromDegrees(this->ConeAngle);
  params.strength = this->OcclusionStrength;
  params.sample_distance = this->SampleDistance;
  params.bias = this->OcclusionBias;
  params.geometry_thickness = this->GeometryThickness >= VTK_DOUBLE_MAX
    ? std::numeric_limits<double>::infinity()
    : this->GeometryThickness;
  params.color_integration =
    this->ColorIntegration == COLOR_MIDDLE ? CHI_COLOR_MIDDLE : CHI_COLOR_PREINTEGRATED;
  params.skip = this->Skipping ? this->SkippingMask : CHI_SKIP_NOTHING;
  params.geometry_opacity = this->GeometryOpacity;
  params.combine = this->CombineMode == COMBINE_MINIMUM ? CHI_COMBINE_MINIMUM : CHI_COMBINE_PRODUCT;
  params.vicinity_samples = this->VicinityOcclusion ? this->NumberOfVicinitySamples : 0;
  params.vicinity_distance =
    this->VicinityDistance * (in.Diagonal > 0.0 ? in.Diagonal : diagonalOfProps(in.Scene));
  params.vicinity_bias = this->VicinityDepthBias == 0.0 && this->OcclusionMethod == PUBLISHED
    ? 0.1 * params.vicinity_distance
    : this->VicinityDepthBias;
  std::copy_n(this->LightDirection, 3, params.light_direction);
  std::copy_n(this->SecondLightDirection, 3, params.second_light_direction);
  params.second_light_cone_angle_rad = vtkMath::RadiansFromDegrees(this->SecondLightConeAngle);
  params.second_light_share = this->SecondLightShare;
  if (std::any_of(this->AttenuationColor, this->AttenuationColor + 3,
        [](double factor) { return factor != 1.0; }))
  {
    params.colored_attenuation = 1;
    std::copy_n(this->AttenuationColor, 3, params.attenuation);
  }
  if (this->OcclusionMethod == PUBLISHED && this->SecondLightShare > 0.0)
  {
    this->SayOnce("the published method has one light: the second one is not drawn");
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::CollectQuality(double seconds)
{
  Internals& in = *this->Internal;
  in.Used = vtkChiQuality::Settings();
  in.Used.Directions = in.Params.directions;
  in.Used.ImageReduction = this->ImageReduction;
  if (in.Interactive)
  {
    in.Used = in.Quality.Choose(in.Used, seconds);
    if (this->OcclusionMethod == PUBLISHED) // whose taps make the picture, not its error alone
    {
      in.Used.Directions = in.Params.directions;
    }
  }
  in.Params.directions = in.Used.Directions;
  in.Params.reduction = in.Used.ImageReduction;
  in.Params.half_size = in.Used.ImageReduction > 1 ? 0 : in.Params.half_size;
  in.Params.coarsening = in.Used.Coarsening;
}

//------------------------------------------------------------------------------
// Ids where the volume is opaque enough; the plain ray cast of the core says where that is.
void vtkChiCombinedOcclusionVolumeMapper::RenderSelection(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const chi_occlusion_image image = in.Image;
  const vtkChiQuality::Settings used = in.Used;
  in.Interactive = false;
  const bool collected = this->Collect(renderer, volume);
  in.Used = used;
  in.Image = image;
  if (!collected || !in.HasVolume || !this->PrepareEngine())
  {
    return;
  }
  if (!in.Selection.IsKnown(
        renderer->GetSelector(), volume, in.Camera, in.Viewport[2], in.Viewport[3]))
  {
    const vtkChiExec exec(nullptr);
    chi_occlusion_frame frame = in.MakeFrame();
    frame.surface = nullptr; // the selector's own depth buffer says what lies in front
    const chi_status status =
      chi_occlusion_find_depth(exec.Get(), in.Engine.GetCore(), &frame, this->SelectionOpacity,
        in.Selection.Allocate(volume, in.Camera, in.Viewport[2], in.Viewport[3]));
    if (image.rgba && in.Engine.GetInUse() == ENGINE_CPU)
    {
      chi_occlusion_get_image(
        in.Engine.GetCore(), &in.Image); // stands, unless the volume has changed
    }
    if (status != CHI_OK)
    {
      in.Selection.Forget();
      this->SayOnce(
        (std::string("the volume is not selected: ") + chi_status_string(status)).c_str(), true);
      return;
    }
  }
  if (!in.Selection.Draw(renderer, in.Camera,
        vtkChiSelection::GetIdsOfImage(*in.Camera.Get(), *in.Input.GetVolume())))
  {
    this->SayOnce("the shader that draws the selection could not be built", true);
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Surface(vtkRenderer* renderer)
{
  Internals& in = *this->Internal;
  vtkChiGeometryBuffer* geometry = in.Frame->GetGeometry();
  if (!(in.Params.skip & CHI_SKIP_UNCHANGED) && in.First)
  {
    geometry->Forget();
  }
  const bool samples = this->GeometryAntiAliasing == GEOMETRY_MULTISAMPLE ||
    this->GeometryAntiAliasing == GEOMETRY_MULTISAMPLE_AND_FXAA;
  if (in.First)
  {
    in.Frame->SetMultiSample(samples);
  }
  if (samples && !geometry->IsHiding() && !in.Frame->IsStock())
  {
    this->SayOnce("geometry cannot be multisampled where the renderer has a render pass, shadows, "
                  "screen-space occlusion or hidden line removal: its edges are as VTK draws them");
  }
  // A vtkChiCombinedOcclusionPass has drawn it already, the same. A reduced picture has no place
  // for what covers a pixel in part: then geometry has one sample a pixel.
  const bool can = samples && geometry->IsHiding() && in.Params.reduction <= 1;
  geometry->Update(renderer, in.Camera, in.Viewport[2], in.Viewport[3], can);
  if (in.First)
  {
    vtkChiTranslucentLayers* layers = in.Frame->GetTranslucent();
    layers->Update(renderer, in.Camera, in.Viewport + 2, geometry->GetWindowDepth(),
      geometry->GetView() ? geometry->GetView()->version : 0);
    if (layers->GetDropped() > 0)
    {
      this->SayOnce("some pixels have more than four layers of translucent geometry: the four that "
                    "are nearest to the eye are drawn (GetNumberOfDroppedLayers)");
    }
    if (layers->HasForeign())
    {
      this->SayOnce("translucent props whose mappers ignore render passes are drawn by VTK, "
                    "before or after all of the volume");
    }
  }
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::PrepareEngine()
{
  Internals& in = *this->Internal;
  const vtkChiExec exec(nullptr);
  const chi_status created = in.Engine.Prepare(exec.Get());
  if (created != CHI_OK)
  {
    this->SayOnce(chi_status_string(created), true);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::RenderEngine()
{
  Internals& in = *this->Internal;
  const vtkChiExec exec(nullptr); // no events while drawing, so no abort and no progress
  if (!this->PrepareEngine())
  {
    return false;
  }
  const chi_surface_view* surface = in.Frame->GetGeometry()->GetView();
  in.HasSurface = surface != nullptr;
  const chi_layers_view* layers = in.First ? in.Frame->GetTranslucent()->GetView() : nullptr;
  if (!in.HasVolume && !surface && !layers)
  {
    in.Stats = {};
    return false; // nothing there, nothing wrong
  }
  chi_occlusion_frame frame = in.MakeFrame();
  // the share of a pixel that an edge covers is drawn once
  chi_surface_view whole = surface ? *surface : chi_surface_view{};
  whole.end = whole.edge_depth = whole.edge_rgba = nullptr;
  frame.surface = surface && !in.First ? &whole : surface;
  frame.layers = layers;
  const chi_status status =
    in.Engine.Render(exec.Get(), vtkOpenGLRenderWindow::SafeDownCast(in.Window), frame,
      this->Engine, this->LightPrecision == HALF_FLOAT);
  in.Stats = in.Engine.GetStats();
  if (this->Engine == ENGINE_OPENGL && in.Engine.GetInUse() == ENGINE_CPU)
  {
    this->SayOnce(
      ("the CPU engine draws in place of the OpenGL engine: " + in.Engine.GetReason()).c_str());
  }
  if (status != CHI_OK)
  {
    std::string text = std::string("the occlusion engine gave up: ") + chi_status_string(status);
    if (status == CHI_ERROR_TOO_LARGE)
    {
      text +=
        " (SampleDistance " + std::to_string(this->SampleDistance) + " asks for too many slices)";
    }
    this->SayOnce(text.c_str(), true);
    return false;
  }
  in.Image = in.Engine.GetImage();
  return in.Image.width > 0;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Composite(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const double start = vtkTimerLog::GetUniversalTime();
  vtkChiGeometryBuffer* geometry = in.Frame->GetGeometry();
  if (in.Shared)
  {
    in.ReadImage();
  }
  const bool keep = in.Shared && in.HasVolume;
  const vtkChiOcclusionFrame::Box box =
    keep ? vtkChiOcclusionFrame::GetBoxOf(*in.Input.GetVolume()) : vtkChiOcclusionFrame::Box();
  in.Frame->AddLayer(volume, in.Camera.Get(), keep ? &box : nullptr, &in.Image, true);
  vtkChiCompositor::Picture picture;
  picture.Width = in.Image.width;
  picture.Height = in.Image.height;
  picture.Rgba = in.Image.rgba;
  picture.Visibility = in.Image.visibility;
  picture.VisibilityRgb = in.Image.visibility_rgb;
  picture.RgbaTexture = in.Engine.GetLayer();
  picture.VisibilityTexture = in.Engine.GetVisibility();
  // merged pictures change with what lies in front and behind
  const bool merge = in.Shared && in.Frame->GetNumberOfLayers() > 1;
  picture.Unchanged = in.Stats.reused != 0 && !merge && !in.LastMerged;
  in.LastMerged = merge;
  if (merge)
  {
    std::vector<float> specular;
    geometry->ReadSpecular(vtkOpenGLRenderWindow::SafeDownCast(in.Window), specular);
    in.Frame->MergeLastLayer(in.Merged, specular);
    picture.Rgba = in.Merged.empty() ? in.Image.rgba : in.Merged.data();
    picture.RgbaTexture = nullptr;
  }
  picture.Surface = geometry->GetView() ? geometry->GetColor() : nullptr;
  picture.Specular = merge && !in.Merged.empty() ? nullptr : geometry->GetSpecular();
  // not where that would take away what others have drawn, unless nobody draws the geometry else
  picture.First = in.First && (!merge || geometry->IsHiding());
  picture.Hidden = geometry->IsHiding();
  picture.Smooth = (this->GeometryAntiAliasing == GEOMETRY_FXAA ||
                     this->GeometryAntiAliasing == GEOMETRY_MULTISAMPLE_AND_FXAA) &&
    in.Frame->GetNumberOfShadingLayers() >= vtkChiOcclusionFrame::CountVolumes(renderer, true);
  picture.Layered = in.Frame->GetTranslucent()->IsHiding();
  picture.Peeling = in.Peeling;
  picture.Dither = this->Dither;
  if (!in.Compositor.Draw(renderer, picture))
  {
    this->SayOnce("the shader that draws the picture could not be built", true);
  }
  in.SecondsComposite = vtkTimerLog::GetUniversalTime() - start;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Report()
{
  Internals& in = *this->Internal;
  in.UsedSampleDistance = in.HasVolume ? in.Stats.sample_distance : 0.0;
  if (!in.Stats.reused && in.Image.width > 0) // a picture drawn again says nothing of the next one
  {
    this->TimeToDraw = in.SecondsTotal;
    in.Quality.Report(in.Stats.seconds_total, in.SecondsTotal);
  }
  if (in.HasVolume && in.Image.width > 0)
  {
    in.Errors.clear();
  }
  if (in.Image.width == 0)
  {
    in.SecondsComposite = 0.0;
  }
  if (in.Stats.moved_lights > 0)
  {
    this->SayOnce("a light more than 60 degrees off the view axis is not supported: it is taken to "
                  "lie at 60 degrees, on the same side");
  }
  if (in.HasVolume && in.Stats.non_finite_samples > 0)
  {
    this->SayOnce("the input has NaN or infinite voxels: they, and the cells that they touch, are "
                  "transparent (GetNumberOfNonFiniteSamples counts them)");
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  Internals& in = *this->Internal;
  in.Compositor.ReleaseGraphicsResources(window);
  in.Selection.ReleaseGraphicsResources(window);
  in.Engine.ReleaseGraphicsResources(window);
  if (in.Frame && window) // vtkRenderer::SetRenderWindow says null before the first frame
  {
    in.Frame->GetGeometry()->ReleaseGraphicsResources(window);
    in.Frame->GetTranslucent()->ReleaseGraphicsResources(window);
  }
}
