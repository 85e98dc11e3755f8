// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiTransferFunction2D
 * @brief   colour and opacity over two quantities, drawn by shapes
 *
 * A material is a shape in the plane of two quantities, x and y, both in the units of the data:
 * rectangle, trapezoid, Gaussian, polygon, or an RGBA image; with a colour and an opacity, which
 * means what vtkVolumeProperty's opacity means to the mapper that draws it. Where shapes overlap
 * their materials mix: extinctions add, opacity = 1 - product of (1 - a_i), and colours are
 * weighted by extinction, so that the order of the shapes means nothing. Elsewhere all is
 * transparent.
 *
 * Hand it to a mapper by SetTransferFunction2D: x is then the scalar, y the array named by
 * SetTransfer2DYAxisArray, or, without one, the magnitude of the gradient in units of the scalar a
 * voxel's edge (the mean of the three; of meshes the cube root of the mean volume of a cell).
 *
 * Source: Kniss, Kindlmann and Hansen, "Multidimensional transfer functions for interactive volume
 * rendering", 2002; the formulas are those of chi_transfer_shapes.h.
 *
 * @sa vtkChiCombinedOcclusionVolumeMapper vtkChiProjectedTetrahedraMapper vtkVolumeProperty
 */

#ifndef vtkChiTransferFunction2D_h
#define vtkChiTransferFunction2D_h

#include "vtkChiRenderingModule.h" // for export macro
#include "vtkObject.h"

#include <memory> // for std::unique_ptr

class vtkImageData;
class vtkPoints;
struct vtkChiTransferShape;
struct vtkChiTransferShapes;

class VTKCHIRENDERING_EXPORT vtkChiTransferFunction2D : public vtkObject
{
public:
  static vtkChiTransferFunction2D* New();
  vtkTypeMacro(vtkChiTransferFunction2D, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * An even rectangle. Over the share `softness` (0 to 1) of its half width and height, from the
   * edges inwards, opacity rises from 0; with 0 edges are hard. rgba: colour and largest opacity, 0
   * to 1. Returns the shape's index, or -1, with an error, where numbers mean nothing: an empty
   * range, values out of range or not finite.
   */
  int AddRectangle(double xMin, double xMax, double yMin, double yMax, const double rgba[4],
    double softness = 0.0);

  /**
   * A trapezoid from xMin ... xMax at yMin to topXMin ... topXMax at yMax; either may be one point.
   * Opacity rises over the share `softness` of the half width along x: with 1 it is a tent over the
   * axis, as in the triangular widgets of Kniss et al. Returns as AddRectangle does.
   */
  int AddTrapezoid(double xMin, double xMax, double topXMin, double topXMax, double yMin,
    double yMax, const double rgba[4], double softness = 0.0);

  /**
   * A Gaussian with standard deviations sigmaX, sigmaY, and a correlation between -1 and 1, which
   * tilts it whatever the units. Returns as AddRectangle does.
   */
  int AddGaussian(double x, double y, double sigmaX, double sigmaY, const double rgba[4],
    double correlation = 0.0);

  /**
   * A polygon with hard edges, closed, of three points or more, whose z is not read; where it
   * crosses itself, the even-odd rule says what is inside. The points are copied. Returns as
   * AddRectangle does.
   */
  int AddPolygon(vtkPoints* points, const double rgba[4]);

  /**
   * An image of four components, red, green, blue and opacity, 0 to 1, or, of integer types, 0 to
   * the largest number of the type; linear between its points, beyond them the nearest one. Its
   * origin and spacing are in the units of the data. The values are copied. Null takes it away.
   * Returns false, with an error, where it is no such image of 2 x 2 to 2^22 points.
   */
  bool SetImage(vtkImageData* image);

  ///@{
  /**
   * Shapes, the image among them as the last one; and how to take them away. Indices of those
   * behind move down by one.
   */
  int GetNumberOfShapes();
  void RemoveShape(int index);
  void RemoveAllShapes();
  ///@}

  /**
   * Colour and opacity at a place, exactly; 0 to 1, colour not multiplied by opacity.
   */
  void MapValue(double x, double y, double rgba[4]);

  /**
   * The function as an image of nx x ny points over the ranges, point scalars "RGBA" (float), for
   * pictures beside a histogram and for vtkVolumeProperty::SetTransferFunction2D. Hard edges are
   * smoothed over one point. 2 to 65536 points each way, 2^22 together; else false, with an error.
   */
  bool GetTable(
    int nx, int ny, double xMin, double xMax, double yMin, double yMax, vtkImageData* table);

protected:
  vtkChiTransferFunction2D();
  ~vtkChiTransferFunction2D() override;

private:
  friend class vtkChiPlaneInput; // of the mappers

  vtkChiTransferFunction2D(const vtkChiTransferFunction2D&) = delete;
  void operator=(const vtkChiTransferFunction2D&) = delete;

  int Add(vtkChiTransferShape&& shape, const char* what);

  std::unique_ptr<vtkChiTransferShapes> Shapes;
};

#endif
