// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiCombinedOcclusionVolumeMapper.h"

#include "vtkChiCameraView.h"
#include "vtkChiCompositor.h"
#include "vtkChiExec.h"
#include "vtkChiOcclusionFrame.h"
#include "vtkChiVolumeInput.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkAlgorithm.h"
#include "vtkDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMultiVolume.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderPass.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkPointData.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkWeakPointer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkChiCombinedOcclusionVolumeMapper);

//------------------------------------------------------------------------------
struct vtkChiCombinedOcclusionVolumeMapper::Internals
{
  // collected
  vtkChiVolumeInput Input;
  vtkChiCameraView Camera;
  chi_occlusion_params Params = {};
  int Viewport[4] = { 0, 0, 0, 0 };
  double Diagonal = 0.0; // of the volume, in view or not; 0 without one
  bool HasVolume = false;
  bool HasSurface = false;
  bool Peeling = false; // called by the depth peeling pass, several times a frame
  bool First = false;   // of the mappers of this class in this frame
  bool Shared = false;  // other volumes of the renderer have mappers of this class

  vtkWeakPointer<vtkChiOcclusionFrame> Frame;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkWeakPointer<vtkRenderer> Scene;
  chi_occlusion* Renderer = nullptr;
  chi_occlusion_image Image = {};
  chi_occlusion_stats Stats = {};

  vtkChiCompositor Compositor;
  bool LastMerged = false;
  std::vector<float> Merged; // the picture fitted in between other mappers' pictures

  double SecondsCollect = 0.0;
  double SecondsComposite = 0.0;
  double SecondsTotal = 0.0;
  std::set<std::string> Warnings; // each is said once
  std::set<std::string> Errors;   // and these again after a frame that went well
};

namespace
{
//------------------------------------------------------------------------------
bool isPeeling(vtkVolume* volume)
{
  vtkInformation* keys = volume->GetPropertyKeys();
  if (keys && keys->Has(vtkOpenGLRenderPass::RenderPasses()))
  {
    const int count = keys->Length(vtkOpenGLRenderPass::RenderPasses());
    for (int i = 0; i < count; ++i)
    {
      if (keys->Get(vtkOpenGLRenderPass::RenderPasses(), i)->IsA("vtkDualDepthPeelingPass"))
      {
        return true;
      }
    }
  }
  return false;
}

//------------------------------------------------------------------------------
int countOcclusionVolumes(vtkRenderer* renderer)
{
  int count = 0;
  vtkCollectionSimpleIterator cookie;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie))
  {
    vtkVolume* volume = vtkVolume::SafeDownCast(prop);
    count += volume && volume->GetVisibility() &&
        vtkChiCombinedOcclusionVolumeMapper::SafeDownCast(volume->GetMapper())
      ? 1
      : 0;
  }
  return count;
}

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

//------------------------------------------------------------------------------
vtkFloatArray* allocateImage(
  vtkImageData* image, int width, int height, int components, const char* name)
{
  image->Initialize();
  image->SetDimensions(width, height, width > 0 && height > 0 ? 1 : 0);
  vtkNew<vtkFloatArray> values;
  values->SetName(name);
  values->SetNumberOfComponents(components);
  values->SetNumberOfTuples(static_cast<vtkIdType>(width) * height);
  image->GetPointData()->SetScalars(values);
  return vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars());
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
  chi_occlusion_destroy(nullptr, this->Internal->Renderer);
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::SetGeometryOcclusion(bool on)
{
  this->SetVolumeToGeometry(on);
  this->SetGeometryToVolume(on);
  this->SetGeometryToGeometry(on);
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
  if (renderer->GetSelector() || !vtkOpenGLRenderWindow::SafeDownCast(in.Window))
  {
    return; // what would be painted into a selection buffer would be read as ids
  }
  const double start = vtkTimerLog::GetUniversalTime();
  in.Frame = vtkChiOcclusionFrame::Get(renderer);
  in.Peeling = isPeeling(volume);
  if (in.Frame->HasDrawn(volume))
  {
    if (in.Peeling)
    {
      return;
    }
    in.Frame->BeginFrame();
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
  in.Shared = countOcclusionVolumes(renderer) > 1;

  if (this->GetInputAlgorithm())
  {
    this->GetInputAlgorithm()->Update();
  }
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
  in.Diagonal = in.HasVolume ? diagonalOf(*in.Input.GetVolume()) : 0.0;
  if (in.HasVolume)
  {
    this->CollectUnsupported(volume);
    in.HasVolume = in.Camera.Reaches(in.Input.GetVolume());
  }
  this->CollectParameters();
  return true;
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
  check(property->GetShade(0) != 0,
    "shading by gradients (vtkVolumeProperty::ShadeOn) is not supported yet: the volume is shaded "
    "by "
    "occlusion alone");
  const bool two = property->GetTransferFunctionMode() == vtkVolumeProperty::TF_2D;
  check(!two && property->HasGradientOpacity(0) && !property->GetDisableGradientOpacity(0),
    "gradient opacity (vtkVolumeProperty) is not supported yet: scalar opacity alone is used");
  check(two,
    "two-dimensional transfer functions (vtkVolumeProperty) are not supported yet: the "
    "one-dimensional ones are used");
  check(!property->GetLabelMapLabels().empty(),
    "label maps (vtkVolumeProperty) are not supported yet: labels are ignored");
  check(this->BlendMode != COMPOSITE_BLEND,
    "only the composite blend mode is supported yet: composite is used");
  check(vtkMultiVolume::SafeDownCast(volume) != nullptr,
    "vtkMultiVolume is not supported: this mapper's own input is drawn");
  check(this->Internal->Peeling,
    "depth peeling for volumes (vtkRenderer::SetUseDepthPeelingForVolumes) is not supported yet: "
    "the "
    "volume is drawn below all translucent geometry");
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::CollectParameters()
{
  if (this->Engine == ENGINE_OPENGL && this->Internal->Warnings.insert("OpenGL").second)
  {
    vtkErrorMacro("the OpenGL engine is not there yet: the CPU engine renders");
  }
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
  params.skip = this->Skipping ? 1 : 0;
  params.geometry_opacity = this->GeometryOpacity;
  params.combine = this->CombineMode == COMBINE_MINIMUM ? CHI_COMBINE_MINIMUM : CHI_COMBINE_PRODUCT;
  params.vicinity_samples = this->VicinityOcclusion ? this->NumberOfVicinitySamples : 0;
  params.vicinity_distance =
    this->VicinityDistance * (in.Diagonal > 0.0 ? in.Diagonal : diagonalOfProps(in.Scene));
  params.vicinity_bias = this->VicinityDepthBias == 0.0 && this->OcclusionMethod == PUBLISHED
    ? 0.1 * params.vicinity_distance
    : this->VicinityDepthBias;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Surface(vtkRenderer* renderer)
{
  Internals& in = *this->Internal;
  in.Frame->GetGeometry()->Update(renderer, in.Camera, in.Viewport[2], in.Viewport[3]);
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::RenderEngine()
{
  Internals& in = *this->Internal;
  const vtkChiExec exec(nullptr); // no events while drawing, so no abort and no progress
  if (!in.Renderer)
  {
    const chi_status created = chi_occlusion_create(exec.Get(), &in.Renderer);
    if (created != CHI_OK)
    {
      this->SayOnce(chi_status_string(created), true);
      return false;
    }
  }
  const chi_surface_view* surface = in.Frame->GetGeometry()->GetView();
  in.HasSurface = surface != nullptr;
  if (!in.HasVolume && !surface)
  {
    in.Stats = {};
    return false; // nothing there, nothing wrong
  }
  chi_occlusion_frame frame = {};
  frame.struct_size = sizeof(frame);
  frame.camera = in.Camera.Get();
  frame.volume = in.HasVolume ? in.Input.GetVolume() : nullptr;
  frame.transfer = in.HasVolume ? in.Input.GetTransfer() : nullptr;
  frame.surface = surface;
  frame.params = &in.Params;
  frame.clip_planes = in.Input.GetClipPlanes().data();
  frame.clip_plane_count = in.HasVolume ? in.Input.GetClipPlanes().size() / 4 : 0;
  const chi_status status = chi_occlusion_render(exec.Get(), in.Renderer, &frame);
  in.Stats.struct_size = sizeof(in.Stats);
  chi_occlusion_get_stats(in.Renderer, &in.Stats);
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
  chi_occlusion_get_image(in.Renderer, &in.Image);
  return in.Image.rgba != nullptr;
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::Composite(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const double start = vtkTimerLog::GetUniversalTime();
  vtkChiGeometryBuffer* geometry = in.Frame->GetGeometry();
  in.Frame->AddLayer(
    volume, in.Camera.Get(), in.HasVolume ? in.Input.GetVolume() : nullptr, &in.Image, in.Shared);
  vtkChiCompositor::Picture picture;
  picture.Width = in.Image.width;
  picture.Height = in.Image.height;
  picture.Rgba = in.Image.rgba;
  picture.Visibility = in.Image.visibility;
  // merged pictures change with what lies in front and behind
  const bool merge = in.Shared && !in.First;
  picture.Unchanged = in.Stats.reused != 0 && !merge && !in.LastMerged;
  in.LastMerged = merge;
  if (merge)
  {
    std::vector<float> specular;
    geometry->ReadSpecular(vtkOpenGLRenderWindow::SafeDownCast(in.Window), specular);
    in.Frame->MergeLastLayer(in.Merged, specular);
    picture.Rgba = in.Merged.empty() ? in.Image.rgba : in.Merged.data();
  }
  picture.Surface = geometry->GetView() ? geometry->GetColor() : nullptr;
  picture.Specular = merge && !in.Merged.empty() ? nullptr : geometry->GetSpecular();
  picture.First = in.First;
  picture.Peeling = in.Peeling;
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
  this->TimeToDraw = in.SecondsTotal;
  if (in.HasVolume && in.Image.rgba)
  {
    in.Errors.clear();
  }
  if (in.Image.rgba == nullptr)
  {
    in.SecondsComposite = 0.0;
  }
  if (in.HasVolume && in.Stats.non_finite_samples > 0)
  {
    this->SayOnce("the input has NaN or infinite voxels: they, and the cells that they touch, are "
                  "transparent (GetNumberOfNonFiniteSamples counts them)");
  }
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::GetVisibilityImage(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("GetVisibilityImage needs a vtkImageData to write into.");
    return false;
  }
  const chi_occlusion_image& from = this->Internal->Image;
  vtkFloatArray* values = allocateImage(
    image, from.visibility ? from.width : 0, from.visibility ? from.height : 0, 1, "Visibility");
  if (!from.visibility)
  {
    return false;
  }
  std::copy_n(from.visibility, values->GetNumberOfTuples(), values->GetPointer(0));
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::GetFloatImage(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("GetFloatImage needs a vtkImageData to write into.");
    return false;
  }
  Internals& in = *this->Internal;
  const chi_occlusion_image& from = in.Image;
  vtkFloatArray* values =
    allocateImage(image, from.rgba ? from.width : 0, from.rgba ? from.height : 0, 4, "RGBA");
  if (!from.rgba)
  {
    return false;
  }
  const vtkIdType pixels = values->GetNumberOfTuples();
  float* to = values->GetPointer(0);
  std::copy_n(from.rgba, 4 * pixels, to);

  if (!in.HasSurface)
  {
    return true;
  }
  vtkChiGeometryBuffer* geometry = in.Frame ? in.Frame->GetGeometry() : nullptr;
  std::vector<float> surface;
  if (!geometry || geometry->GetWidth() != from.width || geometry->GetHeight() != from.height ||
    !geometry->ReadColor(vtkOpenGLRenderWindow::SafeDownCast(in.Window), surface))
  {
    vtkErrorMacro(
      "GetFloatImage cannot read the colours of the opaque geometry: the window is gone or "
      "has drawn another size since.");
    allocateImage(image, 0, 0, 4, "RGBA");
    return false;
  }
  std::vector<float> specular;
  geometry->ReadSpecular(vtkOpenGLRenderWindow::SafeDownCast(in.Window), specular);
  for (vtkIdType pixel = 0; pixel < pixels; ++pixel)
  {
    const float* lit = surface.data() + 4 * pixel;
    if (lit[3] > 0.0f)
    {
      float* target = to + 4 * pixel;
      const float through = 1.0f - target[3];
      for (int c = 0; c < 3; ++c)
      {
        const float highlight = specular.empty() ? 0.0f : specular[4 * pixel + c];
        target[c] += through * (from.visibility[pixel] * (lit[c] - highlight) + highlight);
      }
      target[3] = 1.0f;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::GetGeometryImage(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("GetGeometryImage needs a vtkImageData to write into.");
    return false;
  }
  Internals& in = *this->Internal;
  vtkChiGeometryBuffer* geometry = in.Frame ? in.Frame->GetGeometry() : nullptr;
  std::vector<float> colors;
  std::vector<float> normals;
  if (!geometry || !geometry->GetView() ||
    !geometry->ReadColor(vtkOpenGLRenderWindow::SafeDownCast(in.Window), colors) ||
    !geometry->ReadNormals(in.Scene, normals))
  {
    allocateImage(image, 0, 0, 4, "RGBA");
    return false;
  }
  vtkFloatArray* rgba =
    allocateImage(image, geometry->GetWidth(), geometry->GetHeight(), 4, "RGBA");
  const vtkIdType pixels = rgba->GetNumberOfTuples();
  std::copy(colors.begin(), colors.end(), rgba->GetPointer(0));
  vtkNew<vtkFloatArray> normal;
  normal->SetName("Normal");
  normal->SetNumberOfComponents(3);
  normal->SetNumberOfTuples(pixels);
  vtkNew<vtkFloatArray> depth;
  depth->SetName("Depth");
  depth->SetNumberOfTuples(pixels);
  for (vtkIdType pixel = 0; pixel < pixels; ++pixel)
  {
    std::copy_n(normals.data() + 4 * pixel, 3, normal->GetPointer(3 * pixel));
  }
  std::copy(geometry->GetDepths().begin(), geometry->GetDepths().end(), depth->GetPointer(0));
  image->GetPointData()->AddArray(normal);
  image->GetPointData()->AddArray(depth);
  return true;
}

//------------------------------------------------------------------------------
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfSamples()
{
  return static_cast<vtkIdType>(this->Internal->Stats.samples);
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfSkippedSamples()
{
  return static_cast<vtkIdType>(this->Internal->Stats.skipped_samples);
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfSlices()
{
  return static_cast<vtkIdType>(this->Internal->Stats.slices);
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfLightUpdates()
{
  return static_cast<vtkIdType>(this->Internal->Stats.light_updates);
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfSkippedLightUpdates()
{
  return static_cast<vtkIdType>(this->Internal->Stats.skipped_light_updates);
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfNonFiniteSamples()
{
  return static_cast<vtkIdType>(this->Internal->Stats.non_finite_samples);
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsCollect()
{
  return this->Internal->SecondsCollect;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsGeometry()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetGeometry()->GetSecondsDraw() : 0.0;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsReadBack()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetGeometry()->GetSecondsReadBack() : 0.0;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsBricks()
{
  return this->Internal->Stats.seconds_bricks;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsClassification()
{
  return this->Internal->Stats.seconds_classification;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsVisibleSet()
{
  return this->Internal->Stats.seconds_visible_set;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsSlices()
{
  return this->Internal->Stats.seconds_slices;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsEngine()
{
  return this->Internal->Stats.seconds_total;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsComposite()
{
  return this->Internal->SecondsComposite;
}
double vtkChiCombinedOcclusionVolumeMapper::GetSecondsTotal()
{
  return this->Internal->SecondsTotal;
}
bool vtkChiCombinedOcclusionVolumeMapper::GetReusedLastFrame()
{
  return this->Internal->Stats.reused != 0;
}
bool vtkChiCombinedOcclusionVolumeMapper::GetReusedGeometry()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame && frame->GetGeometry()->GetReused();
}
const char* vtkChiCombinedOcclusionVolumeMapper::GetInstructionSet()
{
  return chi_occlusion_instruction_set();
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  Internals& in = *this->Internal;
  in.Compositor.ReleaseGraphicsResources(window);
  if (in.Frame && window) // vtkRenderer::SetRenderWindow says null before the first frame
  {
    in.Frame->GetGeometry()->ReleaseGraphicsResources(window);
  }
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ConeAngle: " << this->ConeAngle << "\n";
  os << indent << "NumberOfDirections: " << this->NumberOfDirections << "\n";
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "OcclusionStrength: " << this->OcclusionStrength << "\n";
  os << indent << "OcclusionBias: " << this->OcclusionBias << "\n";
  os << indent << "GeometryThickness: " << this->GeometryThickness << "\n";
  os << indent << "GeometryOpacity: " << this->GeometryOpacity << "\n";
  os << indent << "VicinityOcclusion: " << this->VicinityOcclusion << "\n";
  os << indent << "VicinityDistance: " << this->VicinityDistance << "\n";
  os << indent << "VicinityDepthBias: " << this->VicinityDepthBias << "\n";
  os << indent << "NumberOfVicinitySamples: " << this->NumberOfVicinitySamples << "\n";
  os << indent << "CombineMode: " << (this->CombineMode == COMBINE_MINIMUM ? "Minimum" : "Product")
     << "\n";
  os << indent << "OcclusionResolution: " << (this->OcclusionResolution == HALF ? "Half" : "Full")
     << "\n";
  os << indent
     << "OcclusionMethod: " << (this->OcclusionMethod == PUBLISHED ? "Published" : "Ordinates")
     << "\n";
  os << indent << "Engine: " << this->Engine << "\n";
  os << indent << "VolumeToVolume: " << this->VolumeToVolume << "\n";
  os << indent << "VolumeToGeometry: " << this->VolumeToGeometry << "\n";
  os << indent << "GeometryToVolume: " << this->GeometryToVolume << "\n";
  os << indent << "GeometryToGeometry: " << this->GeometryToGeometry << "\n";
  os << indent << "Skipping: " << this->Skipping << "\n";
}
