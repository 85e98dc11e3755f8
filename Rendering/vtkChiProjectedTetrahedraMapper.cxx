// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiProjectedTetrahedraMapper.h"

#include "vtkChiExec.h"
#include "vtkChiPassKeys.h"
#include "vtkChiProjectedTetrahedraInternals.h"

#include "vtkAlgorithm.h"
#include "vtkCellTypes.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkHardwareSelector.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkTimerLog.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

vtkStandardNewMacro(vtkChiProjectedTetrahedraMapper);

namespace
{
//------------------------------------------------------------------------------
bool hasTranslucentGeometry(vtkRenderer* renderer)
{
  vtkCollectionSimpleIterator cookie;
  vtkPropCollection* props = renderer->GetViewProps();
  props->InitTraversal(cookie);
  while (vtkProp* prop = props->GetNextProp(cookie))
  {
    if (prop->GetVisibility() && !vtkVolume::SafeDownCast(prop) &&
      prop->HasTranslucentPolygonalGeometry())
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
bool isFinite(const double bounds[6])
{
  return std::all_of(bounds, bounds + 6, [](double x) { return std::isfinite(x); });
}

//------------------------------------------------------------------------------
// The point of a cell that is nearest to a place.
vtkIdType findPoint(vtkDataSet* input, vtkIdType cell, const double place[3], vtkIdList* points)
{
  input->GetCellPoints(cell, points);
  vtkIdType nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (vtkIdType i = 0; i < points->GetNumberOfIds(); ++i)
  {
    double point[3];
    input->GetPoint(points->GetId(i), point);
    const double distance = vtkMath::Distance2BetweenPoints(point, place);
    if (distance < least)
    {
      least = distance;
      nearest = points->GetId(i);
    }
  }
  return nearest;
}
}

//------------------------------------------------------------------------------
vtkChiProjectedTetrahedraMapper::vtkChiProjectedTetrahedraMapper()
  : Internal(new Internals)
{
}

//------------------------------------------------------------------------------
vtkChiProjectedTetrahedraMapper::~vtkChiProjectedTetrahedraMapper()
{
  this->SetOpacityArrayName(nullptr);
  this->SetTransfer2DYAxisArray(nullptr);
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::SetTransferFunction2D(vtkChiTransferFunction2D* function)
{
  if (function != this->GetTransferFunction2D())
  {
    this->Internal->Field.GetPlane()->SetFunction(function);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkChiTransferFunction2D* vtkChiProjectedTetrahedraMapper::GetTransferFunction2D()
{
  return this->Internal->Field.GetPlane()->GetFunction();
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::SetInputData(vtkDataSet* input)
{
  this->SetInputDataInternal(0, input);
}

//------------------------------------------------------------------------------
// Composite data are let in to be refused by a message of our own.
int vtkChiProjectedTetrahedraMapper::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1); // a warning of our own says so
  return 1;
}

//------------------------------------------------------------------------------
double* vtkChiProjectedTetrahedraMapper::GetBounds()
{
  double* bounds = this->Superclass::GetBounds();
  vtkDataSet* input = this->GetDataSetInput();
  if (!input || isFinite(bounds))
  {
    return bounds;
  }
  Internals& in = *this->Internal;
  if (in.FiniteTime != input->GetMTime())
  {
    vtkMath::UninitializeBounds(in.FiniteBounds);
    for (vtkIdType i = 0; i < input->GetNumberOfPoints(); ++i)
    {
      double point[3];
      input->GetPoint(i, point);
      for (int axis = 0; axis < 3 && vtkMath::IsFinite(vtkMath::Norm(point)); ++axis)
      {
        double* range = in.FiniteBounds + 2 * axis;
        const bool first = range[0] > range[1];
        range[0] = first ? point[axis] : std::min(range[0], point[axis]);
        range[1] = first ? point[axis] : std::max(range[1], point[axis]);
      }
    }
    in.FiniteTime = input->GetMTime();
  }
  std::copy_n(in.FiniteBounds, 6, bounds);
  return bounds;
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::SayOnce(const std::string& what, bool isError)
{
  std::set<std::string>& said = isError ? this->Internal->Errors : this->Internal->Warnings;
  if (what.empty() || !said.insert(what).second)
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
void vtkChiProjectedTetrahedraMapper::Render(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  in.Window = renderer->GetRenderWindow();
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
  in.Drawn = false;
  if (this->Collect(renderer, volume))
  {
    in.SecondsCollect = vtkTimerLog::GetUniversalTime() - start;
    this->Surface(renderer);
    in.Drawn = this->RenderEngine();
    if (in.Drawn)
    {
      this->Composite(renderer, volume);
    }
  }
  in.SecondsTotal = vtkTimerLog::GetUniversalTime() - start;
  this->Report();
}

//------------------------------------------------------------------------------
vtkDataSet* vtkChiProjectedTetrahedraMapper::CollectInput()
{
  if (this->GetInputAlgorithm())
  {
    this->GetInputAlgorithm()->Update();
  }
  vtkDataObject* object = this->GetDataObjectInput();
  if (vtkCompositeDataSet::SafeDownCast(object))
  {
    this->SayOnce(std::string("the input is a ") + object->GetClassName() +
        ", and this mapper draws one mesh: vtkMergeBlocks makes one of its blocks",
      true);
    return nullptr;
  }
  vtkDataSet* input = vtkDataSet::SafeDownCast(object);
  if (!input)
  {
    this->SayOnce("there is no input: nothing to draw");
  }
  if (input && input->GetDataReleased())
  {
    this->SayOnce("the input has been released (vtkDataObject::ReleaseData): nothing to draw");
    return nullptr;
  }
  return input;
}

//------------------------------------------------------------------------------
bool vtkChiProjectedTetrahedraMapper::Collect(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  in.Collected = false;
  // the viewport that is set, not the renderer's place in the window: render passes draw elsewhere
  glGetIntegerv(GL_VIEWPORT, in.Viewport);
  if (in.Viewport[2] < 1 || in.Viewport[3] < 1)
  {
    return false;
  }
  const char* reason = in.Camera.Collect(renderer, in.Viewport[2], in.Viewport[3]);
  if (reason)
  {
    this->SayOnce(std::string("nothing is drawn: ") + reason, true);
    return false;
  }
  if (in.Camera.GetLimit())
  {
    this->SayOnce(in.Camera.GetLimit());
  }
  in.Shared = vtkChiOcclusionFrame::CountVolumes(renderer, false) > 1;
  in.Input = this->CollectInput();
  if (!in.Input)
  {
    return false;
  }
  if (!in.Grid.Collect(in.Input))
  {
    this->SayOnce(in.Grid.GetProblem(), !in.Grid.IsEmpty());
    return false;
  }
  const int component = this->VectorMode == MAGNITUDE ? -1
    : this->VectorMode == COMPONENT                   ? this->VectorComponent
                                                      : 0;
  in.Field.SetSecondArray(this->Transfer2DYAxisArray);
  const bool good = in.Field.Collect(this, in.Input, volume->GetProperty(), component,
    this->OpacityArrayName ? this->OpacityArrayName : "");
  for (const std::string& limit : in.Field.GetLimits())
  {
    this->SayOnce(limit);
  }
  if (!good)
  {
    this->SayOnce(in.Field.GetProblem(), true);
    return false;
  }
  const bool clipped = in.Clips.Collect(this, volume, in.Camera.GetWorld());
  this->SayOnce(in.Clips.GetProblem(), true);
  this->SayOnce(in.Clips.GetLimit());
  this->CollectParameters(renderer, volume);
  in.Collected = clipped && this->CollectMatrix(volume);
  return in.Collected;
}

//------------------------------------------------------------------------------
bool vtkChiProjectedTetrahedraMapper::CollectMatrix(vtkVolume* volume)
{
  double* matrix = this->Internal->GridToWorld;
  vtkMatrix4x4::Multiply4x4(
    this->Internal->Camera.GetWorld(), volume->GetMatrix()->GetData(), matrix);
  double columns = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    columns *= std::sqrt(matrix[axis] * matrix[axis] + matrix[4 + axis] * matrix[4 + axis] +
      matrix[8 + axis] * matrix[8 + axis]);
  }
  const double determinant = vtkMatrix4x4::Determinant(matrix);
  // relative to the box that its columns would span; the bound is rounding of a product of three
  if (!std::isfinite(determinant) || !(std::abs(determinant) > 1e-14 * columns))
  {
    this->SayOnce("the matrix of the vtkVolume is singular or not finite: nothing to draw", true);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::CollectParameters(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  in.Shading.CollectLights(volume->GetProperty(), renderer, in.Camera.GetView());
  for (const std::string& limit : in.Shading.GetLimits())
  {
    this->SayOnce(limit);
  }
  chi_tet_params& params = in.Params;
  chi_tet_default_params(&params);
  params.order = this->VisibilityOrder;
  params.pre_integration = this->PreIntegration;
  params.projection = this->Projection;
  params.subpixel_splatting = this->SubpixelSplatting ? 1 : 0;
  if (in.Field.GetTransfer()->plane && this->Projection == PROJECTION_PUBLISHED)
  {
    params.projection = CHI_TET_PROJECTION_EXACT;
    this->SayOnce("the published projection knows no two-dimensional transfer functions: the exact "
                  "one is drawn");
  }
  params.opacity_convention = this->OpacityConvention;
  params.blend =
    this->BlendMode == MAXIMUM_INTENSITY_BLEND ? CHI_TET_BLEND_MAXIMUM : CHI_TET_BLEND_COMPOSITE;
  params.skip = this->Skipping ? this->SkippingMask : CHI_TET_SKIP_NOTHING;
  params.automatic_unit_distance = this->AutomaticUnitDistance ? 1 : 0;
  params.fragment_cache_bytes = static_cast<std::size_t>(this->FragmentCacheLimit) << 20;
  params.reduction = this->ImageReduction;
  params.occlusion_strength = this->OcclusionStrength;
  params.cone_angle_degrees = this->ConeAngle;
  params.occlusion_bias = std::max(this->OcclusionBias, 0.0);
  params.direction_count = this->NumberOfDirections;
  params.occlusion_slabs = this->NumberOfOcclusionSlabs;
  params.full_size_light = this->OcclusionResolution == FULL ? 1 : 0;
  const double allotted = volume->GetAllocatedRenderTime();
  if (this->AutoAdjustQuality && in.FullSeconds > allotted && allotted > 0.0)
  {
    const double needed = std::ceil(std::sqrt(in.FullSeconds / allotted));
    params.reduction = std::max(params.reduction, static_cast<int>(std::min(needed, 8.0)));
  }
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::Surface(vtkRenderer* renderer)
{
  Internals& in = *this->Internal;
  const chi_surface_view* geometry =
    in.Frame->UpdateGeometry(in.Camera, in.Viewport[2], in.Viewport[3]);
  in.HasSurface = geometry != nullptr;
  if (geometry)
  {
    in.Surface = {};
    in.Surface.struct_size = sizeof(in.Surface);
    // of several samples a pixel, what is behind all
    in.Surface.depth = geometry->end ? geometry->end : geometry->depth;
    in.Surface.version = geometry->version;
  }
  this->ReportTranslucent(renderer);
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::ReportTranslucent(vtkRenderer* renderer)
{
  if (!this->Internal->Frame->GetTranslucent()->IsHiding() && hasTranslucentGeometry(renderer))
  {
    this->SayOnce(std::string("translucent geometry is drawn by VTK, ") +
      (this->Internal->Peeling ? "after the tetrahedra and over all of them"
                               : "before the tetrahedra, which lie over all of it"));
  }
}

//------------------------------------------------------------------------------
bool vtkChiProjectedTetrahedraMapper::RenderEngine()
{
  Internals& in = *this->Internal;
  const vtkChiExec exec(nullptr); // no events while drawing, so no abort and no progress
  const chi_status status = in.Engine.Render(
    exec.Get(), vtkOpenGLRenderWindow::SafeDownCast(in.Window), in.MakeFrame(), this->Engine);
  if (this->Engine == ENGINE_OPENGL && in.Engine.GetInUse() == ENGINE_CPU)
  {
    this->SayOnce("the CPU engine draws in place of the OpenGL engine: " + in.Engine.GetReason());
  }
  if (status != CHI_OK)
  {
    this->ReportFailure(status);
    return false;
  }
  return in.Engine.GetImage().width > 0;
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::Composite(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const double start = vtkTimerLog::GetUniversalTime();
  if (in.Shared)
  {
    in.Engine.ReadImage();
  }
  const chi_tet_image& from = in.Engine.GetImage();
  chi_occlusion_image image = {};
  image.width = from.width;
  image.height = from.height;
  image.rgba = from.rgba;
  vtkChiOcclusionFrame::Box box;
  std::copy_n(in.GridToWorld, 16, box.ToWorld);
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Low[axis] = in.Engine.GetStats().grid.bounds[2 * axis];
    box.High[axis] = in.Engine.GetStats().grid.bounds[2 * axis + 1];
  }
  in.Frame->AddLayer(volume, in.Camera.Get(), in.Shared ? &box : nullptr, &image, false);
  vtkChiCompositor::Picture picture;
  picture.Width = from.width;
  picture.Height = from.height;
  picture.Rgba = from.rgba;
  picture.RgbaTexture = in.Engine.GetLayer();
  // merged pictures change with what lies in front and behind
  const bool merge = in.Shared && in.Frame->GetNumberOfLayers() > 1;
  picture.Unchanged = in.Engine.GetStats().reused != 0 && !merge && !in.LastMerged;
  in.LastMerged = merge;
  if (merge)
  {
    in.Frame->MergeLastLayer(in.Merged, {});
    picture.Rgba = in.Merged.empty() ? from.rgba : in.Merged.data();
    picture.RgbaTexture = nullptr;
  }
  picture.Peeling = in.Peeling;
  picture.Dither = this->Dither;
  if (!in.Compositor.Draw(renderer, picture))
  {
    this->SayOnce("the shader that draws the picture could not be built", true);
  }
  in.SecondsComposite = vtkTimerLog::GetUniversalTime() - start;
}

//------------------------------------------------------------------------------
// Ids of cells where the mesh is opaque enough. Opaque geometry is not looked at: the selector's
// own depth buffer says what lies in front.
void vtkChiProjectedTetrahedraMapper::RenderSelection(vtkRenderer* renderer, vtkVolume* volume)
{
  Internals& in = *this->Internal;
  const bool drawn = in.Drawn;
  if (!this->Collect(renderer, volume))
  {
    return;
  }
  in.Drawn = drawn;
  const int width = in.Viewport[2];
  const int height = in.Viewport[3];
  if (!in.Selection.IsKnown(renderer->GetSelector(), volume, in.Camera, width, height))
  {
    const vtkChiExec exec(nullptr);
    chi_tet_frame frame = in.MakeFrame();
    frame.surface = nullptr;
    in.FoundCells.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const chi_status status = in.Engine.FindCells(exec.Get(), frame, this->PickingOpacity,
      in.FoundCells.data(), in.Selection.Allocate(volume, in.Camera, width, height));
    if (status != CHI_OK)
    {
      in.Selection.Forget();
      this->SayOnce(std::string("the mesh is not selected: ") + chi_status_string(status), true);
      return;
    }
  }
  double eyeToGrid[16];
  vtkMatrix4x4::Multiply4x4(in.Camera.Get()->world_to_eye, in.GridToWorld, eyeToGrid);
  vtkMatrix4x4::Invert(eyeToGrid, eyeToGrid);
  vtkNew<vtkIdList> points;
  vtkChiSelection::Ids ids;
  ids.Points = in.Input->GetNumberOfPoints();
  ids.Cells = in.Input->GetNumberOfCells();
  ids.Find = [&](std::size_t pixel, const double eye[3], bool cell) -> vtkIdType
  {
    const vtkIdType found = static_cast<vtkIdType>(in.FoundCells[pixel]);
    if (cell)
    {
      return found;
    }
    const double from[4] = { eye[0], eye[1], eye[2], 1.0 };
    double place[4];
    vtkMatrix4x4::MultiplyPoint(eyeToGrid, from, place);
    return findPoint(in.Input, found, place, points);
  };
  if (!in.Selection.Draw(renderer, in.Camera, ids))
  {
    this->SayOnce("the shader that draws the selection could not be built", true);
  }
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::ReportFailure(int status)
{
  Internals& in = *this->Internal;
  const chi_grid_counts& grid = in.Engine.GetStats().grid;
  const std::string mesh = std::string("the input (") + in.Input->GetClassName() + ")";
  if (status == CHI_ERROR_INVALID_ARGUMENT && grid.first_bad_cell >= 0)
  {
    this->SayOnce("cell " + std::to_string(grid.first_bad_cell) + " of " + mesh +
        " is broken: a point id out of range, or points or faces that do not fit its type; nothing "
        "is drawn",
      true);
  }
  else if (status == CHI_ERROR_OUT_OF_MEMORY || status == CHI_ERROR_TOO_LARGE)
  {
    // the bound of bytes that a tetrahedron costs with its neighbours, and a point and a pixel
    const double bytes = 84.0 * static_cast<double>(grid.tetrahedra) +
      48.0 * static_cast<double>(grid.points) + 16.0 * in.Viewport[2] * in.Viewport[3];
    this->SayOnce(mesh + " of " + std::to_string(in.Input->GetNumberOfCells()) +
        " cells is too large: " + chi_status_string(status) + "; about " +
        std::to_string(static_cast<long long>(bytes / 1048576.0) + 1) +
        " MiB are needed, and no more than 2^32 - 2 points or tetrahedra",
      true);
  }
  else
  {
    this->SayOnce(mesh + " is not drawn: " + chi_status_string(status), true);
  }
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::Report()
{
  Internals& in = *this->Internal;
  if (!in.Drawn)
  {
    in.SecondsComposite = 0.0;
    return;
  }
  in.Errors.clear();
  const chi_tet_stats& stats = in.Engine.GetStats();
  if (!stats.reused) // a picture drawn again says nothing of the next one
  {
    this->TimeToDraw = in.SecondsTotal;
    const int reduction = std::max(in.Params.reduction, 1);
    in.FullSeconds =
      stats.seconds_draw * reduction * reduction + in.SecondsTotal - stats.seconds_draw;
  }
  const std::string mesh = std::string("the input (") + in.Input->GetClassName() + ")";
  if (stats.grid.unsupported_cells > 0)
  {
    const char* name =
      vtkCellTypes::GetClassNameFromTypeId(static_cast<int>(stats.grid.first_unsupported_type));
    this->SayOnce(mesh + " has cells of types that are not split into tetrahedra, such as " +
      (name ? name : "unknown ones") + " (" + std::to_string(stats.grid.first_unsupported_type) +
      "): they are left out (GetNumberOfUnsupportedCells)");
  }
  if (stats.grid.tetrahedra == 0)
  {
    this->SayOnce(mesh + " has no cells of volume: nothing to draw");
  }
  if (stats.grid.non_finite_cells > 0)
  {
    this->SayOnce(mesh +
      " has points that are NaN or infinite: their cells are left out (GetNumberOfNonFiniteCells)");
  }
  if (stats.non_finite_cells > 0)
  {
    this->SayOnce(std::string("the scalars of ") + mesh +
      " are NaN or infinite in places: tetrahedra there are left out "
      "(GetNumberOfNonFiniteTetrahedra)");
  }
}

//------------------------------------------------------------------------------
void vtkChiProjectedTetrahedraMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  Internals& in = *this->Internal;
  in.Engine.ReleaseGraphicsResources(window);
  in.Compositor.ReleaseGraphicsResources(window);
  in.Selection.ReleaseGraphicsResources(window);
  if (in.Frame && window) // vtkRenderer::SetRenderWindow says null before the first frame
  {
    in.Frame->GetGeometry()->ReleaseGraphicsResources(window);
  }
}
