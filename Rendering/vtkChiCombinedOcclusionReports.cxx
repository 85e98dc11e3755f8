// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// What vtkChiCombinedOcclusionVolumeMapper tells of its last frame: pictures, counters, times.
#include "vtkChiCombinedOcclusionInternals.h"
#include "vtkChiFloatImage.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkPointData.h"

#include <algorithm>

//------------------------------------------------------------------------------
bool vtkChiCombinedOcclusionVolumeMapper::GetVisibilityImage(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("GetVisibilityImage needs a vtkImageData to write into.");
    return false;
  }
  this->Internal->ReadImage();
  const chi_occlusion_image& from = this->Internal->Image;
  const bool colored = from.visibility_rgb != nullptr;
  vtkFloatArray* values = vtkChiAllocateImage(image, from.visibility ? from.width : 0,
    from.visibility ? from.height : 0, colored ? 3 : 1, "Visibility");
  if (!from.visibility)
  {
    return false;
  }
  std::copy_n(colored ? from.visibility_rgb : from.visibility, values->GetNumberOfValues(),
    values->GetPointer(0));
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
  if (!in.ReadImage() && in.Image.width > 0)
  {
    vtkErrorMacro("GetFloatImage cannot read the picture: its window is gone.");
  }
  const chi_occlusion_image& from = in.Image;
  vtkFloatArray* values =
    vtkChiAllocateImage(image, from.rgba ? from.width : 0, from.rgba ? from.height : 0, 4, "RGBA");
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
    vtkChiAllocateImage(image, 0, 0, 4, "RGBA");
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
        const float visibility =
          from.visibility_rgb ? from.visibility_rgb[3 * pixel + c] : from.visibility[pixel];
        target[c] += through * (visibility * (lit[c] - highlight) + highlight);
      }
      target[3] = 1.0f - through * (1.0f - lit[3]); // a share of the pixel, where multisampled
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
    vtkChiAllocateImage(image, 0, 0, 4, "RGBA");
    return false;
  }
  vtkFloatArray* rgba =
    vtkChiAllocateImage(image, geometry->GetWidth(), geometry->GetHeight(), 4, "RGBA");
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
int vtkChiCombinedOcclusionVolumeMapper::GetUsedNumberOfDirections()
{
  return this->Internal->Used.Directions;
}
double vtkChiCombinedOcclusionVolumeMapper::GetUsedSampleDistance()
{
  return this->Internal->UsedSampleDistance;
}
int vtkChiCombinedOcclusionVolumeMapper::GetUsedImageReduction()
{
  return this->Internal->Used.ImageReduction;
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetNumberOfSkipped(int kind)
{
  for (int k = 1; k < CHI_SKIP_KINDS; ++k)
  {
    if (kind == 1 << k)
    {
      return static_cast<vtkIdType>(this->Internal->Stats.skipped[k]);
    }
  }
  return 0;
}
vtkIdType vtkChiCombinedOcclusionVolumeMapper::GetLightBufferBytes()
{
  return static_cast<vtkIdType>(this->Internal->Stats.light_bytes);
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
int vtkChiCombinedOcclusionVolumeMapper::GetEngineInUse()
{
  return this->Internal->Engine.GetInUse();
}
const char* vtkChiCombinedOcclusionVolumeMapper::GetEngineReason()
{
  return this->Internal->Engine.GetReason().c_str();
}
bool vtkChiCombinedOcclusionVolumeMapper::IsSoftwareRenderer(const char* renderer)
{
  return renderer && vtkChiGLTools::IsSoftware(renderer);
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
int vtkChiCombinedOcclusionVolumeMapper::GetNumberOfDroppedLayers()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetTranslucent()->GetDropped() : 0;
}
bool vtkChiCombinedOcclusionVolumeMapper::GetReusedBricks()
{
  return this->Internal->Stats.reused_bricks != 0;
}
bool vtkChiCombinedOcclusionVolumeMapper::GetReusedClassification()
{
  return this->Internal->Stats.reused_classification != 0;
}
const char* vtkChiCombinedOcclusionVolumeMapper::GetInstructionSet()
{
  return chi_occlusion_instruction_set();
}

//------------------------------------------------------------------------------
void vtkChiCombinedOcclusionVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ConeAngle: " << this->ConeAngle << "\n";
  os << indent << "MaskInput: " << this->Internal->MaskInput.Get() << "\n";
  os << indent << "MaskType: " << (this->MaskType == BinaryMaskType ? "Binary" : "LabelMap")
     << "\n";
  os << indent << "MaskBlendFactor: " << this->MaskBlendFactor << "\n";
  os << indent << "NumberOfDirections: " << this->NumberOfDirections << "\n";
  os << indent << "SampleDistance: " << this->SampleDistance << "\n";
  os << indent << "Transfer2DYAxisArray: "
     << (this->Transfer2DYAxisArray ? this->Transfer2DYAxisArray : "(none)") << "\n";
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
  os << indent << "LightDirection: " << this->LightDirection[0] << " " << this->LightDirection[1]
     << " " << this->LightDirection[2] << "\n";
  os << indent << "SecondLightDirection: " << this->SecondLightDirection[0] << " "
     << this->SecondLightDirection[1] << " " << this->SecondLightDirection[2] << "\n";
  os << indent << "SecondLightConeAngle: " << this->SecondLightConeAngle << "\n";
  os << indent << "SecondLightShare: " << this->SecondLightShare << "\n";
  os << indent << "AttenuationColor: " << this->AttenuationColor[0] << " "
     << this->AttenuationColor[1] << " " << this->AttenuationColor[2] << "\n";
  os << indent << "Engine: " << this->Engine << "\n";
  os << indent << "LightPrecision: " << (this->LightPrecision == HALF_FLOAT ? "Half" : "Single")
     << "\n";
  os << indent << "VolumeToVolume: " << this->VolumeToVolume << "\n";
  os << indent << "VolumeToGeometry: " << this->VolumeToGeometry << "\n";
  os << indent << "GeometryToVolume: " << this->GeometryToVolume << "\n";
  os << indent << "GeometryToGeometry: " << this->GeometryToGeometry << "\n";
  os << indent << "GeometryAntiAliasing: " << this->GeometryAntiAliasing << "\n";
  os << indent << "ColorIntegration: "
     << (this->ColorIntegration == COLOR_MIDDLE ? "Middle" : "PreIntegrated") << "\n";
  os << indent << "Dither: " << this->Dither << "\n";
  os << indent << "Skipping: " << this->Skipping << "\n";
  os << indent << "SkippingMask: " << this->SkippingMask << "\n";
  os << indent << "ImageReduction: " << this->ImageReduction << "\n";
  os << indent << "AutoAdjustQuality: " << this->AutoAdjustQuality << "\n";
  os << indent << "InteractiveUpdateRate: " << this->InteractiveUpdateRate << "\n";
  os << indent << "SelectionOpacity: " << this->SelectionOpacity << "\n";
}
