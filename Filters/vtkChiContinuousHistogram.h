// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiContinuousHistogram
 * @brief   how much of a data set's volume has which value of an array: exact bins, area of
 * isosurfaces, moments and quantiles
 *
 * The input is any data set and an array of points (linear in each tetrahedron of the split of the
 * cells) or of cells (constant in each), chosen by SetInputArrayToProcess(0, 0, 0, association,
 * name); where none is chosen it is the active scalars. Data sets without cells of volume are
 * measured by the area of their polygons; cells of lower dimension than the highest are counted and
 * left out, as ghosts and blanked cells are.
 *
 * Output is a vtkTable with a row a bin and the columns (double)
 *  - BinCenter
 *  - Density: volume by the bin's width, which is the mean over the bin of the integral of
 *    dA / |grad f| over the isosurface
 *  - IsoArea: the mean over the bin of the isosurfaces' area (length of isolines, where area is
 *    measured)
 *  - Mass: volume in the bin; the range's upper end belongs to the last one
 *  - Cumulative: volume up to the bin's upper end, with what lies below the range
 *
 * Bins are integrals over the cells, not counts of samples; moments and quantiles are of the
 * continuous distribution over all values, in the range or not, not read from bins.
 *
 * Sources: H. Carr, B. Duffy, B. Denby, "On Histograms and Isosurface Statistics", IEEE TVCG 12(5),
 * 2006; C. Scheidegger, J. Schreiner, B. Duffy, H. Carr, C. Silva, "Revisiting Histograms and
 * Isosurface Statistics", IEEE TVCG 14(6), 2008.
 *
 * @sa vtkExtractHistogram vtkImageHistogram vtkChiContinuousScatterplot
 */
#ifndef vtkChiContinuousHistogram_h
#define vtkChiContinuousHistogram_h

#include "vtkChiFiltersModule.h" // For export macro
#include "vtkTableAlgorithm.h"

#include <memory> // For the private part

class vtkDataArray;
class vtkDataSet;
class vtkMultiProcessController;

class VTKCHIFILTERS_EXPORT vtkChiContinuousHistogram : public vtkTableAlgorithm
{
public:
  static vtkChiContinuousHistogram* New();
  vtkTypeMacro(vtkChiContinuousHistogram, vtkTableAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Component of the array; -1: magnitude of the tuples, linear between points. Default 0.
   */
  vtkSetMacro(Component, int);
  vtkGetMacro(Component, int);
  ///@}

  ///@{
  /**
   * 1 ... 2^20. Default 256.
   */
  vtkSetMacro(NumberOfBins, int);
  vtkGetMacro(NumberOfBins, int);
  ///@}

  ///@{
  /**
   * The lower and upper end of the bins, where AutomaticRange is off; what is beyond is counted.
   * Default 0, 1.
   */
  vtkSetVector2Macro(Range, double);
  vtkGetVector2Macro(Range, double);
  ///@}

  ///@{
  /**
   * Take all values. A constant array c gets a window of width max(|c|, 1) 1e-6 around it, and a
   * warning. Default on.
   */
  vtkSetMacro(AutomaticRange, bool);
  vtkGetMacro(AutomaticRange, bool);
  vtkBooleanMacro(AutomaticRange, bool);
  ///@}

  ///@{
  /**
   * Highest order of the moments that are found, 2 ... 8. Default 4.
   */
  vtkSetClampMacro(NumberOfMoments, int, 2, 8);
  vtkGetMacro(NumberOfMoments, int);
  ///@}

  enum SkipType
  {
    SKIP_OUTSIDE = 1,   ///< bricks whose values miss the range
    SKIP_ONE_BIN = 2,   ///< bricks whose values lie in one bin, constant ones
    SKIP_UNCHANGED = 4, ///< ranges and moments of bricks where mesh and array have not changed
    SKIP_EVERY_KIND = 7
  };
  ///@{
  /**
   * The short ways that are taken, a sum of SKIP_...; results are the same to 1e-13 of the mass
   * with and without. Default SKIP_EVERY_KIND.
   */
  vtkSetClampMacro(SkippingMask, int, 0, SKIP_EVERY_KIND);
  vtkGetMacro(SkippingMask, int);
  ///@}

  ///@{
  /**
   * Results of the last update. Mass is volume: all, its parts below and above the range, their
   * sum, and the part in cells where the array is constant (which is in the bins as the rest is).
   * Cells that are left out since a value or a coordinate is not finite, that are ghosts or
   * blanked, or of a lower dimension.
   */
  vtkGetMacro(TotalMass, double);
  vtkGetMacro(MassBelowRange, double);
  vtkGetMacro(MassAboveRange, double);
  double GetMassOutOfRange() const { return this->MassBelowRange + this->MassAboveRange; }
  vtkGetMacro(SingularMass, double);
  vtkGetMacro(NumberOfSkippedCells, vtkIdType);
  vtkGetMacro(NumberOfHiddenCells, vtkIdType);
  vtkGetMacro(NumberOfLowerDimensionalCells, vtkIdType);
  vtkGetMacro(NumberOfSimplices, vtkIdType);
  ///@}

  ///@{
  /**
   * Of the distribution of values over the volume, after an update; NaN where there is no mass.
   */
  vtkGetMacro(Mean, double);
  vtkGetMacro(Variance, double);
  ///@}

  /**
   * Mean of f^order, 0 <= order <= NumberOfMoments.
   */
  double GetMoment(int order);
  /**
   * Mean of (f - mean)^order, 0 <= order <= NumberOfMoments.
   */
  double GetCentralMoment(int order);

  /**
   * The value below which a share (0 ... 1) of the volume lies, to 1e-12 of the range of values:
   * solved by further passes over the mesh, so that the input of the last update must still be as
   * it was; else there is an error, and NaN.
   */
  double GetQuantile(double share);

  ///@{
  /**
   * The processes that hold the pieces, all of which update; every one gets the histogram of the
   * whole. Null: this one holds all. Settings must be the same in all, and all of them ask for a
   * quantile together. Ranges, masses, moments and quantiles are of the whole, the same bits in
   * all processes and within 1e-14 of what one process gives; numbers of cells are of the own
   * piece. Cells that two of them hold have to be marked as ghosts in one. Default: the global
   * controller.
   */
  void SetController(vtkMultiProcessController* controller);
  vtkMultiProcessController* GetController() const;
  ///@}

  /**
   * How many bricks, or runs of cells, took one of the short ways (SKIP_...) in the last update;
   * of SKIP_UNCHANGED 1 if ranges were kept. 0 for anything else.
   */
  vtkIdType GetNumberOfSkipped(int kind) const;

protected:
  vtkChiContinuousHistogram();
  ~vtkChiContinuousHistogram() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiContinuousHistogram(const vtkChiContinuousHistogram&) = delete;
  void operator=(const vtkChiContinuousHistogram&) = delete;

  bool AllAgree(bool isGood);
  vtkDataArray* FindArray(vtkDataSet* input, int& association);
  void Reset();
  void Report(vtkDataArray* array);

  int Component = 0;
  int NumberOfBins = 256;
  double Range[2] = { 0, 1 };
  bool AutomaticRange = true;
  int NumberOfMoments = 4;
  int SkippingMask = SKIP_EVERY_KIND;

  double TotalMass = 0;
  double MassBelowRange = 0;
  double MassAboveRange = 0;
  double SingularMass = 0;
  double Mean = 0;
  double Variance = 0;
  vtkIdType NumberOfSkippedCells = 0;
  vtkIdType NumberOfHiddenCells = 0;
  vtkIdType NumberOfLowerDimensionalCells = 0;
  vtkIdType NumberOfSimplices = 0;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
