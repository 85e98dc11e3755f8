// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiDerivedFields
 * @brief   gradient magnitude, second derivative along the gradient, Laplacian and mean curvature
 * of isosurfaces, as point arrays
 *
 * The input is any data set with an array of points, chosen by SetInputArrayToProcess(0, 0, 0,
 * vtkDataObject::FIELD_ASSOCIATION_POINTS, name); where none is chosen it is the active scalars.
 * The output is the input with further point arrays, named after the array:
 *  - <name>_GradientMagnitude: |grad f|
 *  - <name>_SecondDerivative: n . Hess f . n with n = grad f / |grad f|
 *  - <name>_Laplacian: div grad f
 *  - <name>_MeanCurvature: H = div(n) / 2 of the isosurface through the point
 * in float, or in double where the array is double or of integers of 32 bits or more.
 *
 * Images and rectilinear grids are differentiated by differences of order 2 or 4 along their axes,
 * one-sided ones of the same order at the boundary; spacing and direction matrix are taken into
 * account. Structured grids likewise, by the chain rule. On other data sets the quadratic
 * polynomial that fits the values at the neighbours best is differentiated: first derivatives are
 * of second order, second ones of first. Sheets have the derivatives within them.
 *
 * Cell data is refused: vtkCellDataToPointData makes point data of it.
 *
 * Sources: G. Kindlmann, J. W. Durkin, "Semi-Automatic Generation of Transfer Functions for Direct
 * Volume Rendering", VolVis 1998; G. Kindlmann, R. Whitaker, T. Tasdizen, T. Moller,
 * "Curvature-Based Transfer Functions for Direct Volume Rendering", IEEE Visualization 2003.
 *
 * @sa vtkGradientFilter vtkImageGradientMagnitude vtkChiContinuousScatterplot
 */
#ifndef vtkChiDerivedFields_h
#define vtkChiDerivedFields_h

#include "vtkChiFiltersModule.h" // For export macro
#include "vtkDataSetAlgorithm.h"

#include <memory> // For the private part

class vtkDataArray;
class vtkDataSet;

class VTKCHIFILTERS_EXPORT vtkChiDerivedFields : public vtkDataSetAlgorithm
{
public:
  static vtkChiDerivedFields* New();
  vtkTypeMacro(vtkChiDerivedFields, vtkDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Component of the array; -1: magnitude of the tuples. Default 0.
   */
  vtkSetMacro(Component, int);
  vtkGetMacro(Component, int);
  ///@}

  ///@{
  /**
   * Order of the differences on images, rectilinear and structured grids: 2 or 4. Default 2.
   */
  vtkSetMacro(Order, int);
  vtkGetMacro(Order, int);
  ///@}

  ///@{
  /**
   * Which fields to derive. Default: the gradient's magnitude alone.
   */
  vtkSetMacro(ComputeGradientMagnitude, bool);
  vtkGetMacro(ComputeGradientMagnitude, bool);
  vtkBooleanMacro(ComputeGradientMagnitude, bool);
  vtkSetMacro(ComputeSecondDerivative, bool);
  vtkGetMacro(ComputeSecondDerivative, bool);
  vtkBooleanMacro(ComputeSecondDerivative, bool);
  vtkSetMacro(ComputeLaplacian, bool);
  vtkGetMacro(ComputeLaplacian, bool);
  vtkBooleanMacro(ComputeLaplacian, bool);
  vtkSetMacro(ComputeMeanCurvature, bool);
  vtkGetMacro(ComputeMeanCurvature, bool);
  vtkBooleanMacro(ComputeMeanCurvature, bool);
  ///@}

  ///@{
  /**
   * Results of the last update: points where |grad f| <= 1e-12 range / extent, so that second
   * derivative and curvature are 0; points whose results are NaN because a sample is not finite or
   * hidden, or because the mesh collapses or has no cell there; points of unstructured grids with
   * too few neighbours for all second derivatives, those that are missing counting as 0.
   */
  vtkGetMacro(NumberOfFlatPoints, vtkIdType);
  vtkGetMacro(NumberOfNonFinitePoints, vtkIdType);
  vtkGetMacro(NumberOfUndeterminedPoints, vtkIdType);
  vtkGetMacro(NumberOfLinearPoints, vtkIdType);
  ///@}

  ///@{
  /**
   * Since the object was made: fields that were computed, and fields that were kept, since neither
   * the mesh nor the array nor a setting had changed.
   */
  vtkGetMacro(NumberOfComputedFields, vtkIdType);
  vtkGetMacro(NumberOfKeptFields, vtkIdType);
  ///@}

protected:
  vtkChiDerivedFields();
  ~vtkChiDerivedFields() override;

  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiDerivedFields(const vtkChiDerivedFields&) = delete;
  void operator=(const vtkChiDerivedFields&) = delete;

  vtkDataArray* FindArray(vtkDataSet* input);
  bool Derive(vtkDataArray* array, vtkIdType points);

  int Component = 0;
  int Order = 2;
  bool ComputeGradientMagnitude = true;
  bool ComputeSecondDerivative = false;
  bool ComputeLaplacian = false;
  bool ComputeMeanCurvature = false;

  vtkIdType NumberOfFlatPoints = 0;
  vtkIdType NumberOfNonFinitePoints = 0;
  vtkIdType NumberOfUndeterminedPoints = 0;
  vtkIdType NumberOfLinearPoints = 0;
  vtkIdType NumberOfComputedFields = 0;
  vtkIdType NumberOfKeptFields = 0;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
