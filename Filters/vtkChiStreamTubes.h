// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiStreamTubes
 * @brief   tubes around polylines: B-spline fit, no twist, no thinning, rings only where they are
 * needed
 *
 * Each polyline of the input becomes a tube. By default the line is first approximated by a cubic
 * C2 B-spline that stays within Tolerance of every input point and adds no wiggle of its own; the
 * tube's rings then follow the spline's curvature, the radius and every floating point array, and
 * straight runs get none. Without SplineFitting there is a ring at every point, mitred at the
 * corners.
 *
 * Output port 0 holds the tubes, output port 1 the fitted curves as polylines. All point and cell
 * data are carried along: floating point arrays linearly along the line (never beyond the input's
 * values), other arrays from the nearest input point, cell data from the line. Added are the point
 * arrays "TubeNormals" and "CurveParameter" (0 to 1 along the line) and the cell array "LineId".
 *
 * Lines that cannot be tubed (fewer than two distinct finite points) are counted and named in one
 * warning; vertices, polygons and strips of the input are ignored with one message.
 *
 * Sources: M. Schott, T. Martin, A. V. P. Grosset, S. T. Smith, C. D. Hansen, "Ambient Occlusion
 * Effects for Combined Volumes and Tubular Geometry", IEEE TVCG 19(6), 2013, section 4; W. Wang, B.
 * Juettler, D. Zheng, Y. Liu, "Computation of Rotation Minimizing Frames", ACM TOG 27(1), 2008.
 *
 * @sa vtkTubeFilter vtkSplineFilter
 */
#ifndef vtkChiStreamTubes_h
#define vtkChiStreamTubes_h

#include "vtkChiFiltersModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For the private part

class VTKCHIFILTERS_EXPORT vtkChiStreamTubes : public vtkPolyDataAlgorithm
{
public:
  static vtkChiStreamTubes* New();
  vtkTypeMacro(vtkChiStreamTubes, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Largest distance of an input point to its fitted curve: a fraction of the input's bounding-box
   * diagonal, or, with ToleranceIsRelative off, a length. Also the largest distance between the
   * curve and the chords of the rings. Default 1e-4, relative.
   */
  vtkSetClampMacro(Tolerance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Tolerance, double);
  vtkSetMacro(ToleranceIsRelative, bool);
  vtkGetMacro(ToleranceIsRelative, bool);
  vtkBooleanMacro(ToleranceIsRelative, bool);
  ///@}

  ///@{
  /**
   * Fit a spline to each line (default on). Off: a ring at every input point, mitred at corners.
   */
  vtkSetMacro(SplineFitting, bool);
  vtkGetMacro(SplineFitting, bool);
  vtkBooleanMacro(SplineFitting, bool);
  ///@}

  ///@{
  /**
   * Radius of the tubes: a fraction of the bounding-box diagonal, or, with RadiusIsRelative off, a
   * length. An array chosen by SetInputArrayToProcess(0, 0, 0, association, name), of points or
   * cells, multiplies it; its values must be finite and not negative. Default 0.004, relative.
   */
  vtkSetClampMacro(Radius, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(Radius, double);
  vtkSetMacro(RadiusIsRelative, bool);
  vtkGetMacro(RadiusIsRelative, bool);
  vtkBooleanMacro(RadiusIsRelative, bool);
  vtkSetMacro(UseRadiusArray, bool);
  vtkGetMacro(UseRadiusArray, bool);
  vtkBooleanMacro(UseRadiusArray, bool);
  ///@}

  ///@{
  /**
   * Corners of the cross-section, 3 to 4096. Default 12.
   */
  vtkSetClampMacro(NumberOfSides, int, 3, 4096);
  vtkGetMacro(NumberOfSides, int);
  ///@}

  ///@{
  /**
   * Largest turn of the curve between two rings, degrees, 0.1 to 90. Default 10.
   */
  vtkSetClampMacro(AngularTolerance, double, 0.1, 90.0);
  vtkGetMacro(AngularTolerance, double);
  ///@}

  ///@{
  /**
   * Largest error of any floating point array between rings, as a fraction of its range; 0 lets the
   * arrays hold no rings. Default 1e-3.
   */
  vtkSetClampMacro(AttributeTolerance, double, 0.0, 1.0);
  vtkGetMacro(AttributeTolerance, double);
  ///@}

  enum CappingType
  {
    CAPPING_NONE = 0,
    CAPPING_FLAT = 1,
    CAPPING_ROUND = 2
  };
  ///@{
  /**
   * How open tubes end: not at all, flat (default), or in a hemisphere. Capped tubes are
   * watertight.
   */
  vtkSetClampMacro(Capping, int, CAPPING_NONE, CAPPING_ROUND);
  vtkGetMacro(Capping, int);
  void SetCappingToNone() { this->SetCapping(CAPPING_NONE); }
  void SetCappingToFlat() { this->SetCapping(CAPPING_FLAT); }
  void SetCappingToRound() { this->SetCapping(CAPPING_ROUND); }
  ///@}

  enum FrameType
  {
    FRAME_ROTATION_MINIMISING = 0,
    FRAME_FRENET = 1
  };
  ///@{
  /**
   * How the cross-section turns along the line: as little as possible (default; Wang et al. 2008),
   * or with the curve's normal, without its flips (as in Schott et al. 2013).
   */
  vtkSetClampMacro(Frame, int, FRAME_ROTATION_MINIMISING, FRAME_FRENET);
  vtkGetMacro(Frame, int);
  void SetFrameToRotationMinimising() { this->SetFrame(FRAME_ROTATION_MINIMISING); }
  void SetFrameToFrenet() { this->SetFrame(FRAME_FRENET); }
  ///@}

  ///@{
  /**
   * Keep the radius below the radius of curvature, so that the surface does not fold (Schott et al.
   * 2013: r < 1 / curvature). Default off; GetNumberOfClampedRadii() counts.
   */
  vtkSetMacro(LimitRadiusToCurvature, bool);
  vtkGetMacro(LimitRadiusToCurvature, bool);
  vtkBooleanMacro(LimitRadiusToCurvature, bool);
  ///@}

  enum TCoordsType
  {
    TCOORDS_OFF = 0,
    TCOORDS_FROM_NORMALIZED_LENGTH = 1,
    TCOORDS_FROM_LENGTH = 2,
    TCOORDS_FROM_SCALARS = 3
  };
  ///@{
  /**
   * Texture coordinates, as in vtkTubeFilter: the first from the length along the line (0 to 1, or
   * divided by TextureLength), or from the active scalars divided by TextureLength; the second
   * around the tube. Default off, TextureLength 1.
   */
  vtkSetClampMacro(GenerateTCoords, int, TCOORDS_OFF, TCOORDS_FROM_SCALARS);
  vtkGetMacro(GenerateTCoords, int);
  void SetGenerateTCoordsToOff() { this->SetGenerateTCoords(TCOORDS_OFF); }
  void SetGenerateTCoordsToNormalizedLength()
  {
    this->SetGenerateTCoords(TCOORDS_FROM_NORMALIZED_LENGTH);
  }
  void SetGenerateTCoordsToUseLength() { this->SetGenerateTCoords(TCOORDS_FROM_LENGTH); }
  void SetGenerateTCoordsToUseScalars() { this->SetGenerateTCoords(TCOORDS_FROM_SCALARS); }
  vtkSetClampMacro(TextureLength, double, 1e-12, VTK_DOUBLE_MAX);
  vtkGetMacro(TextureLength, double);
  ///@}

  ///@{
  /**
   * Triangles instead of triangle strips. Default off.
   */
  vtkSetMacro(GenerateTriangles, bool);
  vtkGetMacro(GenerateTriangles, bool);
  vtkBooleanMacro(GenerateTriangles, bool);
  ///@}

  ///@{
  /**
   * Lines wholly outside this box (xmin, xmax, ymin, ymax, zmin, zmax; radius included) are not
   * tubed while UseClipBox is on. Default off.
   */
  vtkSetVector6Macro(ClipBox, double);
  vtkGetVector6Macro(ClipBox, double);
  vtkSetMacro(UseClipBox, bool);
  vtkGetMacro(UseClipBox, bool);
  vtkBooleanMacro(UseClipBox, bool);
  ///@}

  ///@{
  /**
   * Shorter lines are not tubed; length units. Default 0.
   */
  vtkSetClampMacro(MinimumLength, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MinimumLength, double);
  ///@}

  ///@{
  /**
   * vtkAlgorithm::SINGLE_PRECISION (default), DOUBLE_PRECISION, or DEFAULT_PRECISION: that of the
   * input.
   */
  vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
  vtkGetMacro(OutputPointsPrecision, int);
  ///@}

  ///@{
  /**
   * Results of the last update: an upper bound of the two-sided Hausdorff distance between fitted
   * curves and input lines (it may exceed the tolerance, which holds for the input points); control
   * points of all curves; lines without a tube because they have fewer than two distinct finite
   * points; rings whose radius was limited; input points that were repeated or not finite; rings
   * that were not needed; lines skipped by the clip box and by their length; fits carried out since
   * the object was made.
   */
  vtkGetMacro(MaximumError, double);
  vtkGetMacro(NumberOfControlPoints, vtkIdType);
  vtkGetMacro(NumberOfSkippedLines, vtkIdType);
  vtkGetMacro(NumberOfClampedRadii, vtkIdType);
  vtkGetMacro(NumberOfRemovedPoints, vtkIdType);
  vtkGetMacro(NumberOfRemovedRings, vtkIdType);
  vtkGetMacro(NumberOfClippedLines, vtkIdType);
  vtkGetMacro(NumberOfShortLines, vtkIdType);
  vtkGetMacro(NumberOfFits, vtkIdType);
  ///@}

protected:
  vtkChiStreamTubes();
  ~vtkChiStreamTubes() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiStreamTubes(const vtkChiStreamTubes&) = delete;
  void operator=(const vtkChiStreamTubes&) = delete;

  double Tolerance = 1e-4;
  bool ToleranceIsRelative = true;
  bool SplineFitting = true;
  double Radius = 0.004;
  bool RadiusIsRelative = true;
  bool UseRadiusArray = true;
  int NumberOfSides = 12;
  double AngularTolerance = 10;
  double AttributeTolerance = 1e-3;
  int Capping = CAPPING_FLAT;
  int Frame = FRAME_ROTATION_MINIMISING;
  bool LimitRadiusToCurvature = false;
  int GenerateTCoords = TCOORDS_OFF;
  double TextureLength = 1;
  bool GenerateTriangles = false;
  double ClipBox[6] = { 0, 0, 0, 0, 0, 0 };
  bool UseClipBox = false;
  double MinimumLength = 0;
  int OutputPointsPrecision = SINGLE_PRECISION;

  double MaximumError = 0;
  vtkIdType NumberOfControlPoints = 0;
  vtkIdType NumberOfSkippedLines = 0;
  vtkIdType NumberOfClampedRadii = 0;
  vtkIdType NumberOfRemovedPoints = 0;
  vtkIdType NumberOfRemovedRings = 0;
  vtkIdType NumberOfClippedLines = 0;
  vtkIdType NumberOfShortLines = 0;
  vtkIdType NumberOfFits = 0;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
