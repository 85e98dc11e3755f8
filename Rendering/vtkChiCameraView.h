// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiCameraView_h
#define vtkChiCameraView_h

#include <chiaroscuro/chi_camera.h>
#include <chiaroscuro/chi_volume.h>

#include "vtkCamera.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkOpenGLCamera.h"
#include "vtkRenderer.h"

#include <algorithm>
#include <cmath>

// The renderer's camera as the C core takes it, out of the same matrices as the actors are drawn
// with.
class vtkChiCameraView
{
public:
  // Returns null, or the reason why this camera cannot be used; `limit` names what was ignored.
  const char* Collect(vtkRenderer* renderer, int width, int height)
  {
    this->Limit = nullptr;
    vtkMatrix4x4* view = nullptr;
    vtkMatrix4x4* projection = nullptr;
    vtkMatrix4x4* both = nullptr;
    vtkMatrix3x3* normals = nullptr;
    vtkOpenGLCamera* camera = vtkOpenGLCamera::SafeDownCast(renderer->GetActiveCamera());
    if (!camera)
    {
      return "the active camera is not a vtkOpenGLCamera";
    }
    camera->GetKeyMatrices(renderer, view, normals, projection, both); // columns first, as for GLSL
    double newView[16];
    double newProjection[16];
    for (int row = 0; row < 4; ++row)
    {
      for (int column = 0; column < 4; ++column)
      {
        newView[4 * row + column] = view->GetElement(column, row);
        newProjection[4 * row + column] = projection->GetElement(column, row);
      }
    }
    for (int i = 0; i < 16; ++i)
    {
      if (!std::isfinite(newView[i]) || !std::isfinite(newProjection[i]))
      {
        return "the camera's matrices are not finite";
      }
    }
    // A camera that has only been rounded anew is the same one, and nothing needs to be drawn
    // again: vtkWindowToImageFilter sets the view angle it has read, through a pi of eight digits.
    double projectionRounded[16];
    std::copy(newProjection, newProjection + 16, projectionRounded);
    for (int i = 0; i < 6; i += 5)
    {
      if (std::abs(newProjection[i] - this->Projection[i]) < 1e-7 * std::abs(this->Projection[i]))
      {
        projectionRounded[i] = this->Projection[i]; // 1e-4 of a pixel at a thousand pixels
      }
    }
    if (!IsRounded(newView, this->View) || !IsRounded(projectionRounded, this->Projection))
    {
      std::copy(newView, newView + 16, this->View);
      std::copy(newProjection, newProjection + 16, this->Projection);
    }
    return this->Decompose(width, height);
  }

  // Depth along the view axis of a depth in the window, 0 at the near and 1 at the far plane.
  double Depth(double window) const
  {
    const double* p = this->Projection;
    const double z = 2.0 * window - 1.0;
    return (z * p[15] - p[11]) / (z * p[14] - p[10]);
  }

  // The inverse: depth in the window of a depth along the view axis.
  double WindowDepth(double depth) const
  {
    const double* p = this->Projection;
    return 0.5 * ((p[11] - depth * p[10]) / (p[15] - depth * p[14]) + 1.0);
  }

  // Whether any corner of the volume's box lies beyond the near plane.
  bool Reaches(const chi_volume_view* volume) const
  {
    double matrix[16];
    vtkMatrix4x4::Multiply4x4(this->Camera.world_to_eye, volume->index_to_world, matrix);
    const double margin = volume->is_cell_data ? 0.5 : 0.0;
    for (int corner = 0; corner < 8; ++corner)
    {
      double depth = -matrix[11];
      for (int axis = 0; axis < 3; ++axis)
      {
        const double last = static_cast<double>(volume->dimensions[axis]) - 1.0;
        depth -= matrix[8 + axis] * ((corner >> axis) & 1 ? last + margin : -margin);
      }
      if (depth > this->Camera.near_depth)
      {
        return true;
      }
    }
    return false;
  }

  const chi_camera* Get() const { return &this->Camera; }
  const double* GetView() const { return this->View; }
  const double* GetProjection() const { return this->Projection; }
  // What carries world space to the space that the C core calls world: the identity, unless the
  // view transform scales or mirrors; then it is the view transform, and the core's camera is at
  // rest.
  const double* GetWorld() const { return this->World; }
  const char* GetLimit() const { return this->Limit; }

private:
  static bool IsRounded(const double* matrix, const double* last)
  {
    double largest = 0.0;
    double difference = 0.0;
    for (int i = 0; i < 16; ++i)
    {
      largest = std::max(largest, std::abs(last[i]));
      difference = std::max(difference, std::abs(matrix[i] - last[i]));
    }
    return difference <= 1e-14 * largest; // a few roundings of a double
  }

  const char* Decompose(int width, int height)
  {
    const double* p = this->Projection;
    const bool parallel = p[12] == 0.0 && p[13] == 0.0 && p[14] == 0.0 && p[15] == 1.0;
    const bool perspective = p[12] == 0.0 && p[13] == 0.0 && p[14] == -1.0 && p[15] == 0.0;
    if ((!parallel && !perspective) || p[0] == 0.0 || p[5] == 0.0 || p[10] == 0.0)
    {
      return "the camera's projection is neither perspective nor parallel";
    }
    if (p[1] != 0.0 || p[4] != 0.0 || p[8] != 0.0 || p[9] != 0.0 ||
      (parallel && (p[2] != 0.0 || p[6] != 0.0)))
    {
      this->Limit =
        "sheared projections (vtkCamera::SetViewShear, and stereo in parallel projection) are not "
        "supported yet: the shear is left out of the volume";
    }
    this->Camera = {};
    this->Camera.struct_size = sizeof(chi_camera);
    this->Camera.parallel = parallel ? 1 : 0;
    this->Camera.width = width;
    this->Camera.height = height;
    // Normalised x of a point in the eye's space: (p0 x + p2 z + p3) / w, with w = -z in
    // perspective.
    const double shift[2] = { parallel ? -p[3] : p[2], parallel ? -p[7] : p[6] };
    this->Camera.window[0] = (-1.0 + shift[0]) / p[0];
    this->Camera.window[1] = (1.0 + shift[0]) / p[0];
    this->Camera.window[2] = (-1.0 + shift[1]) / p[5];
    this->Camera.window[3] = (1.0 + shift[1]) / p[5];
    this->Camera.near_depth = this->Depth(0.0);
    this->SplitView();
    if (perspective)
    {
      // Stereo: vtkCamera moves the eye to the side by the projection (vtkPerspectiveTransform::
      // Stereo). (p0 x + p2 z + p3) / w is the projection of x + p3 / p0.
      this->Camera.world_to_eye[3] += p[3] / p[0];
      this->Camera.world_to_eye[7] += p[7] / p[5];
    }
    return nullptr;
  }

  // The core asks for a rigid camera. Where the view is not (SetUserViewTransform,
  // SetModelTransformMatrix with a scale or a mirror), the scene is moved into the eye's space
  // instead.
  void SplitView()
  {
    const double* m = this->View;
    double deviation = 0.0;
    for (int i = 0; i < 3; ++i)
    {
      for (int j = i; j < 3; ++j)
      {
        const double dot =
          m[4 * i] * m[4 * j] + m[4 * i + 1] * m[4 * j + 1] + m[4 * i + 2] * m[4 * j + 2];
        deviation = std::max(deviation, std::abs(dot - (i == j ? 1.0 : 0.0)));
      }
    }
    const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) -
      m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
    // 1e-6: what vtkCamera's normalised axes leave, with much room; far below one part of a pixel
    const bool rigid = deviation < 1e-6 && determinant > 0.0;
    for (int i = 0; i < 16; ++i)
    {
      const double identity = i % 5 == 0 ? 1.0 : 0.0;
      this->Camera.world_to_eye[i] = rigid ? m[i] : identity;
      this->World[i] = rigid ? identity : m[i];
    }
  }

  chi_camera Camera = {};
  double View[16] = {};
  double Projection[16] = {};
  double World[16] = {};
  const char* Limit = nullptr;
};

#endif
