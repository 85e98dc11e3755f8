// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiTransferFunction2D.h"

#include "vtkChiExec.h"
#include "vtkChiTransferShapes.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"

#include <algorithm>
#include <cmath>
#include <limits>

vtkStandardNewMacro(vtkChiTransferFunction2D);

namespace
{
chi_transfer_shape makeShape(int kind, const double rgba[4])
{
  chi_transfer_shape shape = {};
  shape.struct_size = sizeof(shape);
  shape.kind = kind;
  std::copy(rgba, rgba + 4, shape.rgba);
  return shape;
}

// Width of the narrowest feature along an axis, in as many entries as it takes to be drawn.
double stepOf(const chi_transfer_shape& shape, int axis)
{
  constexpr double ENTRIES = 16.0; // over what is linear, or an edge
  switch (shape.kind)
  {
    case CHI_SHAPE_GAUSSIAN:
      // linear between entries an eighth of sigma apart it is off by 1/512 of its height
      return shape.sigma[axis] * std::sqrt(1.0 - shape.correlation * shape.correlation) / 8.0;
    case CHI_SHAPE_IMAGE:
      return (shape.high[axis] - shape.low[axis]) / static_cast<double>(shape.image_size[axis] - 1);
    case CHI_SHAPE_POLYGON:
    {
      double range[2] = { shape.polygon[axis], shape.polygon[axis] };
      for (std::size_t i = 1; i < shape.polygon_count; ++i)
      {
        range[0] = std::min(range[0], shape.polygon[2 * i + static_cast<std::size_t>(axis)]);
        range[1] = std::max(range[1], shape.polygon[2 * i + static_cast<std::size_t>(axis)]);
      }
      return range[1] > range[0] ? (range[1] - range[0]) / (4.0 * ENTRIES)
                                 : std::numeric_limits<double>::infinity();
    }
    default:
    {
      double width = shape.high[axis] - shape.low[axis];
      if (shape.kind == CHI_SHAPE_TRAPEZOID && axis == 0)
      {
        width = std::max(width, shape.top[1] - shape.top[0]);
      }
      const double soft = shape.softness > 0.0 ? 0.5 * shape.softness : 1.0;
      return width * soft / ENTRIES;
    }
  }
}
}

//------------------------------------------------------------------------------
std::vector<chi_transfer_shape> vtkChiTransferShapes::GetCore() const
{
  std::vector<chi_transfer_shape> core;
  core.reserve(this->List.size());
  for (const vtkChiTransferShape& shape : this->List)
  {
    core.push_back(shape.Core);
    core.back().polygon = shape.Polygon.data();
    core.back().image = shape.Image.data();
  }
  return core;
}

//------------------------------------------------------------------------------
double vtkChiTransferShapes::GetStep(int axis) const
{
  double step = std::numeric_limits<double>::infinity();
  for (const chi_transfer_shape& shape : this->GetCore())
  {
    step = std::min(step, stepOf(shape, axis));
  }
  return step;
}

//------------------------------------------------------------------------------
std::vector<float> vtkChiTransferShapes::ReadImage(vtkImageData* image, std::size_t size[2])
{
  vtkDataArray* table = image ? image->GetPointData()->GetScalars() : nullptr;
  int dimensions[3] = { 0, 0, 0 };
  if (image)
  {
    image->GetDimensions(dimensions);
  }
  const vtkIdType entries = static_cast<vtkIdType>(dimensions[0]) * dimensions[1];
  if (!table || table->GetNumberOfComponents() != 4 || table->GetNumberOfTuples() < entries ||
    dimensions[0] < 2 || dimensions[1] < 2 || dimensions[0] > 65536 || dimensions[1] > 65536 ||
    entries > (1 << 22))
  {
    return {};
  }
  const int type = table->GetDataType();
  const double most = type == VTK_FLOAT || type == VTK_DOUBLE ? 1.0 : table->GetDataTypeMax();
  std::vector<float> rgba(4 * static_cast<std::size_t>(entries));
  for (std::size_t i = 0; i < rgba.size(); ++i)
  {
    const vtkIdType tuple = static_cast<vtkIdType>(i / 4);
    rgba[i] = static_cast<float>(table->GetComponent(tuple, static_cast<int>(i % 4)) / most);
  }
  size[0] = static_cast<std::size_t>(dimensions[0]);
  size[1] = static_cast<std::size_t>(dimensions[1]);
  return rgba;
}

//------------------------------------------------------------------------------
vtkChiTransferFunction2D::vtkChiTransferFunction2D()
  : Shapes(new vtkChiTransferShapes)
{
}

//------------------------------------------------------------------------------
vtkChiTransferFunction2D::~vtkChiTransferFunction2D() = default;

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::Add(vtkChiTransferShape&& shape, const char* what)
{
  chi_transfer_shape core = shape.Core;
  core.polygon = shape.Polygon.data();
  core.image = shape.Image.data();
  double rgba[4];
  if (chi_transfer_shapes_map(&core, 1, 0.0, 0.0, rgba) != CHI_OK)
  {
    vtkErrorMacro("the " << what
                         << " is not added: an empty range, or a number that is not finite or out "
                            "of its range (colour and opacity 0 to 1, softness 0 to 1, deviations "
                            "above 0, correlation between -1 and 1, polygons of 3 points or more)");
    return -1;
  }
  // the image stays the last one
  std::vector<vtkChiTransferShape>& list = this->Shapes->List;
  const bool before = !list.empty() && list.back().Core.kind == CHI_SHAPE_IMAGE;
  const auto place = list.insert(before ? list.end() - 1 : list.end(), std::move(shape));
  this->Modified();
  return static_cast<int>(place - list.begin());
}

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::AddRectangle(
  double xMin, double xMax, double yMin, double yMax, const double rgba[4], double softness)
{
  vtkChiTransferShape shape;
  shape.Core = makeShape(CHI_SHAPE_RECTANGLE, rgba);
  shape.Core.low[0] = xMin;
  shape.Core.low[1] = yMin;
  shape.Core.high[0] = xMax;
  shape.Core.high[1] = yMax;
  shape.Core.softness = softness;
  return this->Add(std::move(shape), "rectangle");
}

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::AddTrapezoid(double xMin, double xMax, double topXMin, double topXMax,
  double yMin, double yMax, const double rgba[4], double softness)
{
  vtkChiTransferShape shape;
  shape.Core = makeShape(CHI_SHAPE_TRAPEZOID, rgba);
  shape.Core.low[0] = xMin;
  shape.Core.low[1] = yMin;
  shape.Core.high[0] = xMax;
  shape.Core.high[1] = yMax;
  shape.Core.top[0] = topXMin;
  shape.Core.top[1] = topXMax;
  shape.Core.softness = softness;
  return this->Add(std::move(shape), "trapezoid");
}

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::AddGaussian(
  double x, double y, double sigmaX, double sigmaY, const double rgba[4], double correlation)
{
  vtkChiTransferShape shape;
  shape.Core = makeShape(CHI_SHAPE_GAUSSIAN, rgba);
  shape.Core.center[0] = x;
  shape.Core.center[1] = y;
  shape.Core.sigma[0] = sigmaX;
  shape.Core.sigma[1] = sigmaY;
  shape.Core.correlation = correlation;
  return this->Add(std::move(shape), "Gaussian");
}

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::AddPolygon(vtkPoints* points, const double rgba[4])
{
  vtkChiTransferShape shape;
  shape.Core = makeShape(CHI_SHAPE_POLYGON, rgba);
  for (vtkIdType i = 0; points && i < points->GetNumberOfPoints(); ++i)
  {
    double point[3];
    points->GetPoint(i, point);
    shape.Polygon.insert(shape.Polygon.end(), point, point + 2);
  }
  shape.Core.polygon_count = shape.Polygon.size() / 2;
  return this->Add(std::move(shape), "polygon");
}

//------------------------------------------------------------------------------
bool vtkChiTransferFunction2D::SetImage(vtkImageData* image)
{
  std::vector<vtkChiTransferShape>& list = this->Shapes->List;
  const auto removeImage = [&]
  {
    if (!list.empty() && list.back().Core.kind == CHI_SHAPE_IMAGE)
    {
      list.pop_back();
      this->Modified();
    }
  };
  if (!image)
  {
    removeImage();
    return true;
  }
  const double white[4] = { 1.0, 1.0, 1.0, 1.0 };
  vtkChiTransferShape shape;
  shape.Core = makeShape(CHI_SHAPE_IMAGE, white);
  shape.Image = vtkChiTransferShapes::ReadImage(image, shape.Core.image_size);
  if (shape.Image.empty())
  {
    vtkErrorMacro("the image needs 2 x 2 to 2^22 points with scalars of four components");
    return false;
  }
  const double* bounds = image->GetBounds();
  for (int axis = 0; axis < 2; ++axis)
  {
    shape.Core.low[axis] = bounds[2 * axis];
    shape.Core.high[axis] = bounds[2 * axis + 1];
  }
  removeImage();
  return this->Add(std::move(shape), "image") >= 0;
}

//------------------------------------------------------------------------------
int vtkChiTransferFunction2D::GetNumberOfShapes()
{
  return static_cast<int>(this->Shapes->List.size());
}

//------------------------------------------------------------------------------
void vtkChiTransferFunction2D::RemoveShape(int index)
{
  if (index < 0 || index >= this->GetNumberOfShapes())
  {
    vtkErrorMacro("there is no shape " << index << ": there are " << this->GetNumberOfShapes());
    return;
  }
  this->Shapes->List.erase(this->Shapes->List.begin() + index);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkChiTransferFunction2D::RemoveAllShapes()
{
  if (!this->Shapes->List.empty())
  {
    this->Shapes->List.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkChiTransferFunction2D::MapValue(double x, double y, double rgba[4])
{
  const std::vector<chi_transfer_shape> core = this->Shapes->GetCore();
  if (chi_transfer_shapes_map(core.data(), core.size(), x, y, rgba) != CHI_OK)
  {
    std::fill(rgba, rgba + 4, 0.0); // shapes are looked at when they are added
  }
}

//------------------------------------------------------------------------------
bool vtkChiTransferFunction2D::GetTable(
  int nx, int ny, double xMin, double xMax, double yMin, double yMax, vtkImageData* table)
{
  const std::size_t size[2] = { static_cast<std::size_t>(std::max(nx, 0)),
    static_cast<std::size_t>(std::max(ny, 0)) };
  const double x[2] = { xMin, xMax };
  const double y[2] = { yMin, yMax };
  const bool small = size[0] <= 65536 && size[1] <= 65536 && size[0] * size[1] <= 1 << 22;
  std::vector<float> rgba(small ? 4 * size[0] * size[1] : 0);
  const std::vector<chi_transfer_shape> core = this->Shapes->GetCore();
  const vtkChiExec exec(nullptr);
  if (!table || rgba.empty() ||
    chi_transfer_shapes_table(exec.Get(), core.data(), core.size(), size, x, y, rgba.data()) !=
      CHI_OK)
  {
    vtkErrorMacro("no table of " << nx << " x " << ny << " points from (" << xMin << ", " << yMin
                                 << ") to (" << xMax << ", " << yMax
                                 << ") can be made: an image to write into, 2 to 65536 points each "
                                    "way, 2^22 together, and ranges that are not empty are needed");
    return false;
  }
  table->Initialize();
  table->SetDimensions(nx, ny, 1);
  table->SetOrigin(xMin, yMin, 0.0);
  table->SetSpacing((xMax - xMin) / (nx - 1), (yMax - yMin) / (ny - 1), 1.0);
  vtkNew<vtkFloatArray> values;
  values->SetName("RGBA");
  values->SetNumberOfComponents(4);
  values->SetNumberOfTuples(static_cast<vtkIdType>(rgba.size() / 4));
  std::copy(rgba.begin(), rgba.end(), values->GetPointer(0));
  table->GetPointData()->SetScalars(values);
  return true;
}

//------------------------------------------------------------------------------
void vtkChiTransferFunction2D::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  static const char* const names[] = { "Rectangle", "Trapezoid", "Gaussian", "Polygon", "Image" };
  for (const vtkChiTransferShape& shape : this->Shapes->List)
  {
    const double* rgba = shape.Core.rgba;
    os << indent << names[shape.Core.kind] << ": " << rgba[0] << " " << rgba[1] << " " << rgba[2]
       << " " << rgba[3] << "\n";
  }
}
