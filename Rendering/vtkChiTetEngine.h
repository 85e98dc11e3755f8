// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTetEngine_h
#define vtkChiTetEngine_h

#include "vtkChiGLTools.h"
#include "vtkChiTetGL.h"

#include <chiaroscuro/chi_tet.h>

#include "vtkRenderWindow.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

// The two engines of tetrahedra behind one call: chooses, says why, and hands the picture out as
// floats or as a texture, whichever it is made in.
class vtkChiTetEngine
{
public:
  vtkChiTetEngine() = default;
  ~vtkChiTetEngine();
  vtkChiTetEngine(const vtkChiTetEngine&) = delete;
  void operator=(const vtkChiTetEngine&) = delete;

  // Status and statistics are those of chi_tet_render, and of chi_tet_find_cells, which takes no
  // picture away here, and chi_tet_count_violations. `asked`: of vtkChiEngineChoice.
  chi_status Render(
    const chi_exec* exec, vtkOpenGLRenderWindow* window, const chi_tet_frame& frame, int asked);
  chi_status FindCells(const chi_exec* exec, const chi_tet_frame& frame, double opacity,
    std::int64_t* cells, float* depths);
  chi_status CountViolations(
    const chi_exec* exec, const chi_tet_frame& frame, std::int64_t* violations);

  const chi_tet_stats& GetStats() const { return this->Stats; }
  int GetInUse() const { return this->Choice.GetInUse(); }
  const std::string& GetReason() const { return this->Choice.GetReason(); }

  // The last picture: no pixels before the first one, and after one that failed. Its floats are
  // null where it lies in the texture and has not been read back, the texture is where it lies in
  // floats.
  const chi_tet_image& GetImage() const { return this->Image; }
  vtkTextureObject* GetLayer();
  // Makes the floats; false where the window has gone, or there is no picture.
  bool ReadImage();

  void ReleaseGraphicsResources(vtkWindow* window);

private:
  chi_status Prepare(const chi_exec* exec);
  chi_status Describe(const chi_exec* exec, const chi_tet_frame& frame, chi_tet_plan& plan);
  bool RenderOpenGL(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  chi_status RenderCPU(const chi_exec* exec, const chi_tet_frame& frame);
  void CopyStats();
  void KeepImage();

  chi_tet* Core = nullptr;
  vtkChiTetGL GL;
  vtkChiEngineChoice Choice;
  vtkWeakPointer<vtkRenderWindow> Window;
  chi_tet_image Image = {};
  chi_tet_stats Stats = {};
  // the picture, where the core's memory has been used otherwise, or read back
  std::vector<float> Kept;
};

#endif
