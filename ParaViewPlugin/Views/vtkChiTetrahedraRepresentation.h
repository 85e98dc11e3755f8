// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiTetrahedraRepresentation
 * @brief   any data set as a volume of tetrahedra, in ParaView's render view
 *
 * Draws with vtkChiProjectedTetrahedraMapper what ParaView colours by: the array, its component or
 * magnitude, colour and opacity functions, and the opacity array, which ParaView appends to it as a
 * component. Cells are handed to the mapper as they are, of whatever type; of composite data, the
 * blocks are merged. While the view shows its level of detail for interaction, the picture has
 * fewer pixels (SetInteractiveImageReduction); cells are never left out.
 */

#ifndef vtkChiTetrahedraRepresentation_h
#define vtkChiTetrahedraRepresentation_h

#include "vtkChiViewsModule.h" // for export macro
#include "vtkNew.h"            // for the mapper
#include "vtkSmartPointer.h"   // for the data
#include "vtkVolumeRepresentation.h"

#include <string> // for what has been said

class vtkChiProjectedTetrahedraMapper;
class vtkDataObject;
class vtkDataSet;

class VTKCHIVIEWS_EXPORT vtkChiTetrahedraRepresentation : public vtkVolumeRepresentation
{
public:
  static vtkChiTetrahedraRepresentation* New();
  vtkTypeMacro(vtkChiTetrahedraRepresentation, vtkVolumeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * As of vtkChiProjectedTetrahedraMapper. AutomaticUnitDistance is on by default here.
   */
  void SetVisibilityOrder(int order);
  void SetPreIntegration(int method);
  void SetOpacityConvention(int convention);
  void SetAutomaticUnitDistance(bool on);
  void SetBlendMode(int mode);
  void SetEngine(int engine);
  void SetImageReduction(int times);
  void SetAutoAdjustQuality(bool on);
  void SetFragmentCacheLimit(int megabytes);
  ///@}

  /**
   * Lights shine on the gradient (vtkVolumeProperty::SetShade). Default off.
   */
  void SetShade(bool on);

  ///@{
  /**
   * The image reduction of frames for which the view asks for its level of detail: while one
   * interacts with data larger than its threshold. 1 to 8; default 2.
   */
  vtkSetClampMacro(InteractiveImageReduction, int, 1, 8);
  vtkGetMacro(InteractiveImageReduction, int);
  ///@}

  /**
   * The mapper, to be asked what it did.
   */
  vtkChiProjectedTetrahedraMapper* GetMapper();

  int ProcessViewRequest(
    vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo) override;

protected:
  vtkChiTetrahedraRepresentation();
  ~vtkChiTetrahedraRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  bool AddToView(vtkView* view) override;
  bool RemoveFromView(vtkView* view) override;

private:
  vtkChiTetrahedraRepresentation(const vtkChiTetrahedraRepresentation&) = delete;
  void operator=(const vtkChiTetrahedraRepresentation&) = delete;

  bool AppendOpacity(vtkDataSet* data);
  bool UpdateMapper();
  void SayOnce(const std::string& what);

  vtkNew<vtkChiProjectedTetrahedraMapper> Mapper;
  vtkSmartPointer<vtkDataObject> Shown; // of this process; never null after RequestData
  bool HasOpacity = false;              // the array to draw has the opacity appended
  int ImageReduction = 1;
  int InteractiveImageReduction = 2;
  std::string Said;
};

#endif
