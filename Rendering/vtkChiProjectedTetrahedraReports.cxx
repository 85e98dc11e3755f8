// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
// What vtkChiProjectedTetrahedraMapper tells of its last frame: pictures, counters, times.
#include "vtkChiExec.h"
#include "vtkChiFloatImage.h"
#include "vtkChiProjectedTetrahedraInternals.h"

#include <algorithm>

//------------------------------------------------------------------------------
bool vtkChiProjectedTetrahedraMapper::GetFloatImage(vtkImageData* image)
{
  if (!image)
  {
    vtkErrorMacro("GetFloatImage needs a vtkImageData to write into.");
    return false;
  }
  this->Internal->Engine.ReadImage();
  const chi_tet_image& from = this->Internal->Engine.GetImage();
  const bool any = this->Internal->Drawn && from.rgba;
  vtkFloatArray* values =
    vtkChiAllocateImage(image, any ? from.width : 0, any ? from.height : 0, 4, "RGBA");
  if (any)
  {
    std::copy_n(from.rgba, values->GetNumberOfValues(), values->GetPointer(0));
  }
  return any;
}

//------------------------------------------------------------------------------
vtkIdType vtkChiProjectedTetrahedraMapper::GetNumberOfOrderViolations()
{
  Internals& in = *this->Internal;
  if (!in.Drawn || !in.Collected)
  {
    return -1;
  }
  const vtkChiExec exec(nullptr);
  std::int64_t violations = -1;
  const chi_status status = in.Engine.CountViolations(exec.Get(), in.MakeFrame(), &violations);
  if (status != CHI_OK)
  {
    vtkErrorMacro("the order of the tetrahedra was not looked at: " << chi_status_string(status));
    return -1;
  }
  return static_cast<vtkIdType>(violations);
}

//------------------------------------------------------------------------------
vtkIdType vtkChiProjectedTetrahedraMapper::GetNumberOfSkipped(int kind)
{
  for (int k = 1; k < CHI_TET_SKIP_KINDS; ++k)
  {
    if (kind == 1 << k)
    {
      return static_cast<vtkIdType>(this->Internal->Engine.GetStats().skipped[k]);
    }
  }
  return 0;
}

#define CHI_REPORT(type, name, expression)                                                         \
  type vtkChiProjectedTetrahedraMapper::Get##name()                                                \
  {                                                                                                \
    const chi_tet_stats& stats = this->Internal->Engine.GetStats();                                \
    return static_cast<type>(expression);                                                          \
  }

CHI_REPORT(double, UsedUnitDistance, stats.unit_distance)
CHI_REPORT(vtkIdType, NumberOfTetrahedra, stats.grid.tetrahedra)
CHI_REPORT(vtkIdType, NumberOfFlatTetrahedra, stats.grid.flat_cells)
CHI_REPORT(vtkIdType, NumberOfGhostCells, stats.grid.ghost_cells)
CHI_REPORT(vtkIdType, NumberOfBlankedCells, stats.grid.blanked_cells)
CHI_REPORT(vtkIdType, NumberOfLowerDimensionalCells, stats.grid.lower_dimensional_cells)
CHI_REPORT(vtkIdType, NumberOfUnsupportedCells, stats.grid.unsupported_cells)
CHI_REPORT(vtkIdType, NumberOfNonFiniteCells, stats.grid.non_finite_cells)
CHI_REPORT(vtkIdType, NumberOfNonFiniteTetrahedra, stats.non_finite_cells)
CHI_REPORT(vtkIdType, NumberOfDrawnTetrahedra, stats.drawn)
CHI_REPORT(vtkIdType, NumberOfFragments, stats.fragments)
CHI_REPORT(vtkIdType, NumberOfExactTetrahedra, stats.drawn_exactly)
CHI_REPORT(vtkIdType, NumberOfSplattedTetrahedra, stats.splatted)
CHI_REPORT(int, UsedVisibilityOrder, stats.order.used)
CHI_REPORT(int, UsedPreIntegration, stats.pre_integration)
CHI_REPORT(vtkIdType, NumberOfCycles, stats.order.cycles)
CHI_REPORT(double, SecondsSplit, stats.seconds_split)
CHI_REPORT(double, SecondsScalars, stats.seconds_values)
CHI_REPORT(double, SecondsOrder, stats.seconds_order)
CHI_REPORT(double, SecondsTiles, stats.seconds_bins)
CHI_REPORT(double, SecondsDraw, stats.seconds_draw)
CHI_REPORT(double, SecondsEngine, stats.seconds_total)
CHI_REPORT(vtkIdType, MeshBytes, stats.bytes_mesh)
CHI_REPORT(vtkIdType, FrameBytes, stats.bytes_frame)
CHI_REPORT(vtkIdType, ImageBytes, stats.bytes_image)
CHI_REPORT(vtkIdType, CacheBytes, stats.bytes_cache)
CHI_REPORT(double, SecondsLight, stats.seconds_light)
CHI_REPORT(vtkIdType, OcclusionBytes, stats.bytes_occlusion)
CHI_REPORT(bool, ReusedLastFrame, stats.reused != 0)
#undef CHI_REPORT

//------------------------------------------------------------------------------
int vtkChiProjectedTetrahedraMapper::GetEngineInUse()
{
  return this->Internal->Engine.GetInUse();
}
const char* vtkChiProjectedTetrahedraMapper::GetEngineReason()
{
  return this->Internal->Engine.GetReason().c_str();
}
int vtkChiProjectedTetrahedraMapper::GetUsedImageReduction()
{
  return this->Internal->Drawn ? std::max(this->Internal->Params.reduction, 1)
                               : this->ImageReduction;
}
double vtkChiProjectedTetrahedraMapper::GetSecondsCollect()
{
  return this->Internal->SecondsCollect;
}
double vtkChiProjectedTetrahedraMapper::GetSecondsGeometry()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetGeometry()->GetSecondsDraw() : 0.0;
}
double vtkChiProjectedTetrahedraMapper::GetSecondsReadBack()
{
  vtkChiOcclusionFrame* frame = this->Internal->Frame;
  return frame ? frame->GetGeometry()->GetSecondsReadBack() : 0.0;
}
double vtkChiProjectedTetrahedraMapper::GetSecondsComposite()
{
  return this->Internal->SecondsComposite;
}
double vtkChiProjectedTetrahedraMapper::GetSecondsTotal()
{
  return this->Internal->SecondsTotal;
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "VectorMode: " << this->VectorMode << "\n";
  os << indent << "VectorComponent: " << this->VectorComponent << "\n";
  os << indent
     << "OpacityArrayName: " << (this->OpacityArrayName ? this->OpacityArrayName : "(none)")
     << "\n";
  os << indent << "Transfer2DYAxisArray: "
     << (this->Transfer2DYAxisArray ? this->Transfer2DYAxisArray : "(none)") << "\n";
  os << indent << "VisibilityOrder: " << this->VisibilityOrder << "\n";
  os << indent << "PreIntegration: " << this->PreIntegration << "\n";
  os << indent
     << "Projection: " << (this->Projection == PROJECTION_PUBLISHED ? "Published" : "Exact")
     << "\n";
  os << indent << "SubpixelSplatting: " << this->SubpixelSplatting << "\n";
  os << indent
     << "OpacityConvention: " << (this->OpacityConvention == OPACITY_IMAGE ? "Image" : "Linear")
     << "\n";
  os << indent << "AutomaticUnitDistance: " << this->AutomaticUnitDistance << "\n";
  os << indent << "OcclusionStrength: " << this->OcclusionStrength << "\n";
  os << indent << "ConeAngle: " << this->ConeAngle << "\n";
  os << indent << "NumberOfDirections: " << this->NumberOfDirections << "\n";
  os << indent << "NumberOfOcclusionSlabs: " << this->NumberOfOcclusionSlabs << "\n";
  os << indent << "OcclusionBias: " << this->OcclusionBias << "\n";
  os << indent << "OcclusionResolution: " << (this->OcclusionResolution == FULL ? "Full" : "Half")
     << "\n";
  os << indent << "PickingOpacity: " << this->PickingOpacity << "\n";
  os << indent << "Dither: " << this->Dither << "\n";
  os << indent << "Engine: " << this->Engine << "\n";
  os << indent << "ImageReduction: " << this->ImageReduction << "\n";
  os << indent << "AutoAdjustQuality: " << this->AutoAdjustQuality << "\n";
  os << indent << "FragmentCacheLimit: " << this->FragmentCacheLimit << "\n";
  os << indent << "Skipping: " << this->Skipping << "\n";
  os << indent << "SkippingMask: " << this->SkippingMask << "\n";
}
