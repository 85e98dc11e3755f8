// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiFiberSurface
 * @brief   the surface on which two fields take the values of a polygon, and what it encloses
 *
 * Input port 0 takes any data set with cells of volume and two arrays of points, chosen by
 * SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name) and
 * SetInputArrayToProcess(1, ...); where none is chosen they are the first two arrays of points.
 * Input port 1 takes the polygon: the lines and polygons of a vtkPolyData, whose x and y are values
 * of the first and the second array, or a vtkTable, whose first two columns are the corners of one
 * closed polygon.
 *
 * Output port 0 is the fiber surface, exact for fields that are linear in each tetrahedron of the
 * split of the cells: triangles with one point where several meet, counterclockwise as seen from
 * outside the polygon (of open lines: from their right). All point and cell data are carried along:
 * floating point arrays linearly, other arrays from the nearest point. Added are the cell arrays
 * "SegmentId" (counted through all lines, then all polygons) and, if asked for, "ComponentId", the
 * point array "SegmentParameter" (0 to 1 along the segment) and normals from the fields' gradients.
 *
 * Output port 1 is the input with the cell array "FiberMask" (unsigned char): 1 for cells that
 * touch the inside of the closed polygons, so that a brush in a scatterplot selects cells
 * (vtkThreshold extracts them).
 *
 * Output port 2 is what the closed polygons enclose: the part of the data set whose values lie
 * inside of an odd number of them (the rule of even and odd, as for the mask), as right-handed
 * tetrahedra (vtkUnstructuredGrid) that are cut exactly along the fiber surface, and share whole
 * faces. They are also cut where lines between the polygon's corners, which divide it into
 * triangles, have their fiber surfaces; tetrahedra of the split that neither passes are as they
 * were. Where values lie exactly on the polygon some cells are flat. Point and cell data are
 * carried along as to the surface. Its volume is GetEnclosedVolume().
 *
 * Cell data are refused: vtkCellDataToPointData makes point data of them. Composite data sets are
 * refused: vtkMergeBlocks, or the filter on each block.
 *
 * Sources: H. Carr, Z. Geng, J. Tierny, A. Chattopadhyay, A. Knoll, "Fiber Surfaces: Generalizing
 * Isosurfaces to Bivariate Data", CGF 34(3), 2015; P. Klacansky, J. Tierny, H. Carr, Z. Geng, "Fast
 * and Exact Fiber Surfaces for Tetrahedral Meshes", IEEE TVCG 23(7), 2017.
 *
 * @sa vtkFiberSurface vtkContinuousScatterplot
 */
#ifndef vtkChiFiberSurface_h
#define vtkChiFiberSurface_h

#include "vtkChiFiltersModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For the private part

class vtkDataSet;
class vtkUnstructuredGrid;

class VTKCHIFILTERS_EXPORT vtkChiFiberSurface : public vtkPolyDataAlgorithm
{
public:
  static vtkChiFiberSurface* New();
  vtkTypeMacro(vtkChiFiberSurface, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The polygon, a vtkPolyData or a vtkTable.
   */
  void SetPolygonData(vtkDataObject* polygon) { this->SetInputData(1, polygon); }
  void SetPolygonConnection(vtkAlgorithmOutput* port) { this->SetInputConnection(1, port); }
  ///@}

  ///@{
  /**
   * Component of the first (0) and second (1) array; -1: magnitude. Default 0.
   */
  void SetComponent(int array, int component);
  int GetComponent(int array) const;
  ///@}

  ///@{
  /**
   * Close the lines of the polygon that end elsewhere than they begin. Polygons and tables are
   * closed always. Default off.
   */
  vtkSetMacro(CloseLines, bool);
  vtkGetMacro(CloseLines, bool);
  vtkBooleanMacro(CloseLines, bool);
  ///@}

  ///@{
  /**
   * Give each segment of the polygon points of its own, so that normals and SegmentParameter are
   * exact on both sides of the polygon's corners; otherwise normals are averaged there and
   * SegmentParameter is that of the segment that begins. Default off: closed polygons give closed
   * surfaces by their points' ids.
   */
  vtkSetMacro(SplitCorners, bool);
  vtkGetMacro(SplitCorners, bool);
  vtkBooleanMacro(SplitCorners, bool);
  ///@}

  ///@{
  /**
   * Normals from the gradients of the fields. Default on.
   */
  vtkSetMacro(ComputeNormals, bool);
  vtkGetMacro(ComputeNormals, bool);
  vtkBooleanMacro(ComputeNormals, bool);
  ///@}

  ///@{
  /**
   * Find the connected parts of the surface (cell array "ComponentId", 0 ...), and leave out those
   * of an area below MinimumArea, in units of length squared. Default off, 0.
   */
  vtkSetMacro(ExtractComponents, bool);
  vtkGetMacro(ExtractComponents, bool);
  vtkBooleanMacro(ExtractComponents, bool);
  vtkSetClampMacro(MinimumArea, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(MinimumArea, double);
  ///@}

  ///@{
  /**
   * Fill output port 1; off, it is empty. Default off.
   */
  vtkSetMacro(GenerateMask, bool);
  vtkGetMacro(GenerateMask, bool);
  vtkBooleanMacro(GenerateMask, bool);
  ///@}

  ///@{
  /**
   * Fill output port 2; off, it is empty. Polygons that are not closed are an error then. Default
   * off.
   */
  vtkSetMacro(GenerateEnclosedCells, bool);
  vtkGetMacro(GenerateEnclosedCells, bool);
  vtkBooleanMacro(GenerateEnclosedCells, bool);
  ///@}

  /**
   * What the cells of output port 2 hold, in units of length cubed, of points in double precision;
   * 0 where they were not asked for.
   */
  vtkGetMacro(EnclosedVolume, double);

  ///@{
  /**
   * vtkAlgorithm::SINGLE_PRECISION, DOUBLE_PRECISION, or DEFAULT_PRECISION (default): that of the
   * input's points, single where it has none.
   */
  vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
  vtkGetMacro(OutputPointsPrecision, int);
  ///@}

  enum SkipType
  {
    SKIP_BRICKS = 1,    ///< bricks of cells whose values no segment meets
    SKIP_RUNS = 2,      ///< runs of points that no cell needs, or on one side of all segments
    SKIP_UNCHANGED = 4, ///< the index of mesh and arrays that have not changed
    SKIP_EVERY_KIND = 7
  };
  ///@{
  /**
   * The kinds of work that are left out where they cannot matter, a sum of SKIP_...; results are
   * the same with and without. Default SKIP_EVERY_KIND.
   */
  vtkSetClampMacro(SkippingMask, int, 0, SKIP_EVERY_KIND);
  vtkGetMacro(SkippingMask, int);
  ///@}

  /**
   * What one kind (SKIP_...) left out in the last update; of SKIP_UNCHANGED 1 if the index was
   * kept. 0 for anything else.
   */
  vtkIdType GetNumberOfSkipped(int kind) const;

  ///@{
  /**
   * Results of the last update: segments of the polygon, and those of no length; pairs of a
   * tetrahedron and a segment that meet; cells left out since a value or a coordinate is not
   * finite; connected parts, and those below MinimumArea.
   */
  vtkGetMacro(NumberOfSegments, vtkIdType);
  vtkGetMacro(NumberOfEmptySegments, vtkIdType);
  vtkGetMacro(NumberOfCrossings, vtkIdType);
  vtkGetMacro(NumberOfSkippedCells, vtkIdType);
  vtkGetMacro(NumberOfComponents, vtkIdType);
  vtkGetMacro(NumberOfSmallComponents, vtkIdType);
  ///@}

protected:
  vtkChiFiberSurface();
  ~vtkChiFiberSurface() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkChiFiberSurface(const vtkChiFiberSurface&) = delete;
  void operator=(const vtkChiFiberSurface&) = delete;

  int Enclose(vtkDataSet* input, vtkUnstructuredGrid* output, bool isDouble);

  int Component[2] = { 0, 0 };
  bool CloseLines = false;
  bool SplitCorners = false;
  bool ComputeNormals = true;
  bool ExtractComponents = false;
  double MinimumArea = 0;
  bool GenerateMask = false;
  bool GenerateEnclosedCells = false;
  int OutputPointsPrecision = DEFAULT_PRECISION;
  int SkippingMask = SKIP_EVERY_KIND;

  vtkIdType NumberOfSegments = 0;
  vtkIdType NumberOfEmptySegments = 0;
  vtkIdType NumberOfCrossings = 0;
  vtkIdType NumberOfSkippedCells = 0;
  vtkIdType NumberOfComponents = 0;
  vtkIdType NumberOfSmallComponents = 0;
  double EnclosedVolume = 0;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
