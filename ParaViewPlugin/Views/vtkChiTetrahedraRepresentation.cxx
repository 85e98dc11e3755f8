// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiTetrahedraRepresentation.h"

#include "vtkChiProjectedTetrahedraMapper.h"

#include "vtkAlgorithmOutput.h"
#include "vtkColorTransferFunction.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLODProp3D.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMergeBlocks.h"
#include "vtkObjectFactory.h"
#include "vtkPVRenderView.h"
#include "vtkRenderer.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVolumeProperty.h"

#include <algorithm>

vtkStandardNewMacro(vtkChiTetrahedraRepresentation);

namespace
{
// ParaView's prop draws with mappers of unstructured grids what is unstructured alone.
class vtkChiTetrahedraVolume : public vtkPVLODVolume
{
public:
  static vtkChiTetrahedraVolume* New();
  vtkTypeMacro(vtkChiTetrahedraVolume, vtkPVLODVolume);

  int RenderVolumetricGeometry(vtkViewport* viewport) override
  {
    if (!this->HasArray)
    {
      return 0;
    }
    const int drawn = this->LODProp->RenderVolumetricGeometry(viewport);
    this->EstimatedRenderTime = this->LODProp->GetEstimatedRenderTime();
    return drawn;
  }

  bool HasArray = false; // and something to draw it of
};
vtkStandardNewMacro(vtkChiTetrahedraVolume);

//------------------------------------------------------------------------------
// The name and association of the array to colour by; null where there is none.
const char* getColorArray(vtkInformation* info, int& association)
{
  association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  if (!info || !info->Has(vtkDataObject::FIELD_NAME()))
  {
    return nullptr;
  }
  if (info->Has(vtkDataObject::FIELD_ASSOCIATION()))
  {
    association = info->Get(vtkDataObject::FIELD_ASSOCIATION());
  }
  const char* name = info->Get(vtkDataObject::FIELD_NAME());
  return name && *name ? name : nullptr;
}
}

//------------------------------------------------------------------------------
vtkChiTetrahedraRepresentation::vtkChiTetrahedraRepresentation()
{
  this->Actor = vtkSmartPointer<vtkChiTetrahedraVolume>::New();
  this->Actor->SetProperty(this->Property);
  this->Mapper->AutomaticUnitDistanceOn();
  this->Actor->SetMapper(this->Mapper);
  this->Actor->SetEnableLOD(0); // coarse pictures are the mapper's own
}

//------------------------------------------------------------------------------
vtkChiTetrahedraRepresentation::~vtkChiTetrahedraRepresentation() = default;

//------------------------------------------------------------------------------
int vtkChiTetrahedraRepresentation::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1); // it is elsewhere on most processes
  return 1;
}

//------------------------------------------------------------------------------
void vtkChiTetrahedraRepresentation::SayOnce(const std::string& what)
{
  if (this->Said != what)
  {
    vtkWarningMacro(<< what);
    this->Said = what;
  }
}

//------------------------------------------------------------------------------
int vtkChiTetrahedraRepresentation::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkMath::UninitializeBounds(this->DataBounds);
  this->Shown = vtkSmartPointer<vtkUnstructuredGrid>::New();
  this->HasOpacity = false;
  if (inputVector[0]->GetNumberOfInformationObjects() == 1)
  {
    vtkDataObject* input = vtkDataObject::GetData(inputVector[0], 0);
    if (vtkCompositeDataSet::SafeDownCast(input))
    {
      vtkNew<vtkMergeBlocks> merge;
      merge->SetInputData(input);
      merge->Update();
      this->Shown = merge->GetOutputDataObject(0);
    }
    else if (vtkDataSet::SafeDownCast(input))
    {
      this->Shown.TakeReference(input->NewInstance()); // ours to add an array to
      this->Shown->ShallowCopy(input);
    }
    if (vtkDataSet* data = vtkDataSet::SafeDownCast(this->Shown))
    {
      data->GetBounds(this->DataBounds);
      this->HasOpacity = this->UseSeparateOpacityArray && this->AppendOpacity(data);
    }
  }
  return this->Superclass::RequestData(request, inputVector, outputVector);
}

//------------------------------------------------------------------------------
// ParaView's own way: an array of two components, named <colour>_and_opacity.
bool vtkChiTetrahedraRepresentation::AppendOpacity(vtkDataSet* data)
{
  int association = 0;
  const char* color = getColorArray(this->GetInputArrayInformation(0), association);
  vtkDataArray* colors = color ? this->GetInputArrayToProcess(0, data) : nullptr;
  vtkDataSetAttributes* from = this->OpacityArrayFieldAssociation >= 0
    ? data->GetAttributes(this->OpacityArrayFieldAssociation)
    : nullptr;
  vtkDataArray* opacities = from ? from->GetArray(this->OpacityArrayName.c_str()) : nullptr;
  if (!colors || !opacities || opacities->GetNumberOfTuples() != colors->GetNumberOfTuples())
  {
    this->SayOnce("the opacity array '" + this->OpacityArrayName +
      "' is not one of the same points or cells as the array to colour by: the latter has the "
      "opacity too");
    return false;
  }
  return this->AppendOpacityComponent(data);
}

//------------------------------------------------------------------------------
int vtkChiTetrahedraRepresentation::ProcessViewRequest(
  vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo)
{
  if (!this->Superclass::ProcessViewRequest(request, inInfo, outInfo))
  {
    return 0; // not visible
  }
  if (request == vtkPVView::REQUEST_UPDATE())
  {
    vtkPVRenderView::SetPiece(inInfo, this, this->Shown);
    // pieces of several processes are blended in the order of their depth
    outInfo->Set(vtkPVRenderView::NEED_ORDERED_COMPOSITING(), 1);
    vtkPVRenderView::SetOrderedCompositingConfiguration(inInfo, this,
      vtkUnstructuredGrid::SafeDownCast(this->Shown)
        ? vtkPVRenderView::DATA_IS_REDISTRIBUTABLE | vtkPVRenderView::USE_DATA_FOR_LOAD_BALANCING
        : vtkPVRenderView::USE_BOUNDS_FOR_REDISTRIBUTION);
    vtkPVRenderView::SetRedistributionModeToUniquelyAssignBoundaryCells(inInfo, this);
    vtkPVRenderView::SetRequiresDistributedRendering(inInfo, this, true);
    vtkNew<vtkMatrix4x4> matrix;
    this->Actor->GetMatrix(matrix);
    vtkPVRenderView::SetGeometryBounds(inInfo, this, this->DataBounds, matrix);
  }
  else if (request == vtkPVView::REQUEST_UPDATE_LOD())
  {
    vtkPVRenderView::SetRequiresDistributedRenderingLOD(inInfo, this, true);
  }
  else if (request == vtkPVView::REQUEST_RENDER())
  {
    vtkAlgorithmOutput* port = vtkPVRenderView::GetPieceProducer(inInfo, this);
    this->Mapper->SetInputConnection(port);
    const bool interactive = inInfo->Has(vtkPVRenderView::USE_LOD()) != 0;
    this->Mapper->SetImageReduction(std::max(
      this->ImageReduction, interactive ? this->InteractiveImageReduction : this->ImageReduction));
    vtkChiTetrahedraVolume::SafeDownCast(this->Actor)->HasArray = port && this->UpdateMapper();
  }
  return 1;
}

//------------------------------------------------------------------------------
// What ParaView colours by, to the mapper and its property; false where that is nothing.
bool vtkChiTetrahedraRepresentation::UpdateMapper()
{
  int association = 0;
  const char* color = getColorArray(this->GetInputArrayInformation(0), association);
  if (!color)
  {
    this->SayOnce("no array is chosen to colour by (ColorArrayName): nothing is drawn");
    return false;
  }
  std::string name = color;
  if (this->HasOpacity)
  {
    name += "_and_opacity";
  }
  this->Mapper->SelectScalarArray(name.c_str());
  this->Mapper->SetScalarMode(association == vtkDataObject::FIELD_ASSOCIATION_CELLS
      ? VTK_SCALAR_MODE_USE_CELL_FIELD_DATA
      : association == vtkDataObject::FIELD_ASSOCIATION_NONE
      ? VTK_SCALAR_MODE_USE_FIELD_DATA
      : VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
  const bool independent = this->MapScalars && !this->MultiComponentsMapping && !this->HasOpacity;
  this->Property->SetIndependentComponents(independent);
  vtkColorTransferFunction* function = this->Property->GetRGBTransferFunction(0);
  const bool component = function->GetVectorMode() == vtkScalarsToColors::COMPONENT;
  this->Mapper->SetVectorMode(component ? vtkChiProjectedTetrahedraMapper::COMPONENT
                                        : vtkChiProjectedTetrahedraMapper::MAGNITUDE);
  this->Mapper->SetVectorComponent(component ? function->GetVectorComponent() : 0);
  this->Said.clear();
  return true;
}

//------------------------------------------------------------------------------
bool vtkChiTetrahedraRepresentation::AddToView(vtkView* view)
{
  vtkPVRenderView* renderView = vtkPVRenderView::SafeDownCast(view);
  if (!renderView)
  {
    return false;
  }
  renderView->GetRenderer()->AddActor(this->Actor);
  return this->Superclass::AddToView(view);
}

//------------------------------------------------------------------------------
bool vtkChiTetrahedraRepresentation::RemoveFromView(vtkView* view)
{
  vtkPVRenderView* renderView = vtkPVRenderView::SafeDownCast(view);
  if (!renderView)
  {
    return false;
  }
  renderView->GetRenderer()->RemoveActor(this->Actor);
  return this->Superclass::RemoveFromView(view);
}

//------------------------------------------------------------------------------
void vtkChiTetrahedraRepresentation::SetVisibilityOrder(int order)
{
  this->Mapper->SetVisibilityOrder(order);
}
void vtkChiTetrahedraRepresentation::SetPreIntegration(int method)
{
  this->Mapper->SetPreIntegration(method);
}
void vtkChiTetrahedraRepresentation::SetOpacityConvention(int convention)
{
  this->Mapper->SetOpacityConvention(convention);
}
void vtkChiTetrahedraRepresentation::SetAutomaticUnitDistance(bool on)
{
  this->Mapper->SetAutomaticUnitDistance(on);
}
void vtkChiTetrahedraRepresentation::SetBlendMode(int mode)
{
  this->Mapper->SetBlendMode(mode);
}
void vtkChiTetrahedraRepresentation::SetEngine(int engine)
{
  this->Mapper->SetEngine(engine);
}
void vtkChiTetrahedraRepresentation::SetImageReduction(int times)
{
  this->ImageReduction = std::min(std::max(times, 1), 8);
}
void vtkChiTetrahedraRepresentation::SetAutoAdjustQuality(bool on)
{
  this->Mapper->SetAutoAdjustQuality(on);
}
void vtkChiTetrahedraRepresentation::SetFragmentCacheLimit(int megabytes)
{
  this->Mapper->SetFragmentCacheLimit(megabytes);
}
void vtkChiTetrahedraRepresentation::SetShade(bool on)
{
  this->Property->SetShade(on);
}
vtkChiProjectedTetrahedraMapper* vtkChiTetrahedraRepresentation::GetMapper()
{
  return this->Mapper;
}

//------------------------------------------------------------------------------
void vtkChiTetrahedraRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ImageReduction: " << this->ImageReduction << "\n";
  os << indent << "InteractiveImageReduction: " << this->InteractiveImageReduction << "\n";
  os << indent << "Mapper:\n";
  this->Mapper->PrintSelf(os, indent.GetNextIndent());
}
