// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiContinuousScatterplot
 * @brief   how much of a data set's volume has which pair of values of two arrays
 *
 * The input is any data set and two arrays of points (linear in each tetrahedron of the split of
 * the cells) or of cells (constant in each), chosen by SetInputArrayToProcess(0, 0, 0, association,
 * name) and SetInputArrayToProcess(1, ...); where none is chosen they are the first two arrays of
 * points. A third one (2) is an optional weight: cell data are exact, of point data the mean of a
 * cell's points counts for all of the cell. Data sets without cells of volume are measured by the
 * area of their polygons; cells of lower dimension than the highest are counted and left out, as
 * ghosts and blanked cells are.
 *
 * Output port 0 is a vtkImageData with a point a bin, at its centre, and the point scalars
 * "Density" (double): volume times weight per unit of area of the plot, integrated exactly over
 * each bin, not sampled. Output port 1 is the same as colours ("Color", RGBA), by a logarithmic or
 * linear scale. With matrix arrays both are a vtkMultiBlockDataSet with one plot a pair of them.
 *
 * Where the controller has several processes, each holds a piece of the whole and all of them
 * update; then every one gets the plot of the whole. Cells that two of them hold have to be marked
 * as ghosts in one.
 *
 * Sources: S. Bachthaler, D. Weiskopf, "Continuous Scatterplots", IEEE TVCG 14(6), 2008;
 * C. Micchelli, "A constructive approach to Kergin interpolation in R^k", 1980.
 *
 * @sa vtkContinuousScatterplot vtkChiFiberSurface
 */
#ifndef vtkChiContinuousScatterplot_h
#define vtkChiContinuousScatterplot_h

#include "vtkChiFiltersModule.h" // For export macro
#include "vtkDataObjectAlgorithm.h"

#include <memory> // For the private part
#include <string> // For names of arrays
#include <vector> // For names of arrays

class vtkDataArray;
class vtkDataSet;
class vtkImageData;
class vtkMultiProcessController;
class vtkStringArray;

class VTKCHIFILTERS_EXPORT vtkChiContinuousScatterplot : public vtkDataObjectAlgorithm
{
public:
  static vtkChiContinuousScatterplot* New();
  vtkTypeMacro(vtkChiContinuousScatterplot, vtkDataObjectAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Component of the first (0) and second (1) array and of the weight (2); -1: magnitude. Default
   * 0.
   */
  void SetComponent(int array, int component);
  int GetComponent(int array) const;
  ///@}

  ///@{
  /**
   * Bins along the first and the second array. Default 256, 256.
   */
  vtkSetVector2Macro(Dimensions, int);
  vtkGetVector2Macro(Dimensions, int);
  ///@}

  ///@{
  /**
   * The lower and upper end of the first (0) and second (1) array's values in the plot; what is
   * beyond is counted. Used where AutomaticRange is off. Default 0, 1.
   */
  void SetRange(int array, double low, double high);
  void GetRange(int array, double range[2]) const;
  ///@}

  ///@{
  /**
   * Show all values. A constant array c gets a window of width max(|c|, 1) 1e-6 around it, and a
   * warning. Default on.
   */
  vtkSetMacro(AutomaticRange, bool);
  vtkGetMacro(AutomaticRange, bool);
  vtkBooleanMacro(AutomaticRange, bool);
  ///@}

  enum MethodType
  {
    METHOD_EXACT = 0,    ///< averages over bins
    METHOD_PUBLISHED = 1 ///< triangles of Bachthaler & Weiskopf, read at the centres of bins
  };
  ///@{
  /**
   * How cells are deposited. Default METHOD_EXACT.
   */
  vtkSetClampMacro(Method, int, METHOD_EXACT, METHOD_PUBLISHED);
  vtkGetMacro(Method, int);
  void SetMethodToExact() { this->SetMethod(METHOD_EXACT); }
  void SetMethodToPublished() { this->SetMethod(METHOD_PUBLISHED); }
  ///@}

  ///@{
  /**
   * How far mass of image and rectilinear cells, hexahedra and voxels may lie, on average, from
   * where the trilinear interpolant of point arrays has it, as a part of each array's range in the
   * plot: cells are subdivided into 8, 64, ... equal parts until that is so, at most
   * TrilinearLevels times. Hexahedra then have the volume of their trilinear map. 0: cells are
   * split into tetrahedra as they are. Default 0, and 4 levels.
   */
  void SetTrilinearTolerance(double tolerance);
  vtkGetMacro(TrilinearTolerance, double);
  vtkSetClampMacro(TrilinearLevels, int, 1, 6);
  vtkGetMacro(TrilinearLevels, int);
  ///@}

  ///@{
  /**
   * Cells of images and rectilinear grids, and tetrahedra of other grids, whose values span at most
   * this part of a bin along both arrays and that a line between two bins crosses are deposited by
   * the mean and the extent of their values, an approximation with a bound that GetSplatErrorBound
   * gives. 0: all is exact. Default 0.
   */
  vtkSetClampMacro(SplatSize, double, 0, 1);
  vtkGetMacro(SplatSize, double);
  ///@}

  ///@{
  /**
   * Names of arrays of points or cells (points first), of which every pair is plotted; the two
   * arrays to process are not used then. Null or none: no matrix. Ranges are automatic.
   */
  void SetMatrixArrays(vtkStringArray* names);
  void AddMatrixArray(const char* name);
  void RemoveAllMatrixArrays();
  int GetNumberOfMatrixArrays() const;
  ///@}

  ///@{
  /**
   * The colours' scale: by the logarithm over DisplayDecades below the largest density, or linear.
   * Default on, 4.
   */
  vtkSetMacro(LogarithmicDisplay, bool);
  vtkGetMacro(LogarithmicDisplay, bool);
  vtkBooleanMacro(LogarithmicDisplay, bool);
  vtkSetClampMacro(DisplayDecades, double, 0.1, 300.0);
  vtkGetMacro(DisplayDecades, double);
  ///@}

  enum SkipType
  {
    SKIP_EDGES = 1,     ///< well-conditioned cells by their edges, not by their sections
    SKIP_ONE_BIN = 2,   ///< cells inside one bin in one deposit
    SKIP_PIECES = 4,    ///< bricks that miss the plot, or are constant
    SKIP_UNCHANGED = 8, ///< ranges of bricks where mesh and arrays have not changed
    SKIP_EVERY_KIND = 15
  };
  ///@{
  /**
   * The short ways that are taken, a sum of SKIP_...; results are the same to 1e-10 of the largest
   * bin with and without. Default SKIP_EVERY_KIND.
   */
  vtkSetClampMacro(SkippingMask, int, 0, SKIP_EVERY_KIND);
  vtkGetMacro(SkippingMask, int);
  ///@}

  ///@{
  /**
   * Results of the last update; of a matrix, those of the last pair. Mass is volume times weight:
   * all, its part beyond the plot, and its part in cells whose image has no area (which is in the
   * plot as the rest is). Cells that are left out since a value or a coordinate is not finite, that
   * are ghosts or blanked, or of a lower dimension.
   */
  vtkGetMacro(TotalMass, double);
  vtkGetMacro(MassOutOfRange, double);
  vtkGetMacro(SingularMass, double);
  vtkGetMacro(NumberOfSkippedCells, vtkIdType);
  vtkGetMacro(NumberOfHiddenCells, vtkIdType);
  vtkGetMacro(NumberOfLowerDimensionalCells, vtkIdType);
  vtkGetMacro(NumberOfSimplices, vtkIdType);
  ///@}

  ///@{
  /**
   * Cells and tetrahedra that the last update deposited by their mean, and what the masses of all
   * bins together are off by these at most.
   */
  vtkGetMacro(NumberOfSplats, vtkIdType);
  vtkGetMacro(SplatErrorBound, double);
  ///@}

  ///@{
  /**
   * Trilinear cells that the last update subdivided, and of them those that would have taken more
   * than TrilinearLevels.
   */
  vtkGetMacro(NumberOfSubdividedCells, vtkIdType);
  vtkGetMacro(NumberOfCappedCells, vtkIdType);
  ///@}

  ///@{
  /**
   * The processes that hold the pieces. Null: this one holds all. Settings must be the same in all.
   * Ranges and masses are of the whole, numbers of cells of the own piece. The plot has the bits
   * that one process would give it where pieces of images and rectilinear grids end at cells
   * that are multiples of 8 in the whole's extent, and where pieces of other grids are runs of
   * multiples of 2048 cells, told by their global ids, and not sorted, without ghosts; else it is
   * within 1e-12 (images) or 1e-11 (lists) of the largest bin. Default: the global controller.
   */
  void SetController(vtkMultiProcessController* controller);
  vtkMultiProcessController* GetController() const;
  ///@}

  /**
   * How many took one of the short ways (SKIP_...) in the last update: simplices, simplices,
   * bricks, and 1 if ranges were kept. 0 for anything else.
   */
  vtkIdType GetNumberOfSkipped(int kind) const;

protected:
  vtkChiContinuousScatterplot();
  ~vtkChiContinuousScatterplot() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiContinuousScatterplot(const vtkChiContinuousScatterplot&) = delete;
  void operator=(const vtkChiContinuousScatterplot&) = delete;

  struct Field;
  int GetNumberOfProcesses() const;
  bool AllAgree(bool isGood);
  bool FindField(vtkDataSet* input, int index, Field& field);
  bool FindFields(vtkDataSet* input, std::vector<Field>& fields, Field& weight);
  bool Check(const Field fields[2], const Field& weight);
  bool Plot(vtkDataSet* input, const Field fields[2], const Field& weight, vtkImageData* density,
    vtkImageData* colors);

  int Component[3] = { 0, 0, 0 };
  int Dimensions[2] = { 256, 256 };
  double Range[2][2] = { { 0, 1 }, { 0, 1 } };
  bool AutomaticRange = true;
  int Method = METHOD_EXACT;
  double TrilinearTolerance = 0;
  int TrilinearLevels = 4;
  double SplatSize = 0;
  std::vector<std::string> MatrixArrays;
  bool LogarithmicDisplay = true;
  double DisplayDecades = 4;
  int SkippingMask = SKIP_EVERY_KIND;

  double TotalMass = 0;
  double MassOutOfRange = 0;
  double SingularMass = 0;
  vtkIdType NumberOfSkippedCells = 0;
  vtkIdType NumberOfHiddenCells = 0;
  vtkIdType NumberOfLowerDimensionalCells = 0;
  vtkIdType NumberOfSimplices = 0;
  vtkIdType NumberOfSubdividedCells = 0;
  vtkIdType NumberOfCappedCells = 0;
  vtkIdType NumberOfSplats = 0;
  double SplatErrorBound = 0;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
