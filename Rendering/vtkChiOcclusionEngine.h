// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiOcclusionEngine_h
#define vtkChiOcclusionEngine_h

#include "vtkChiGLTools.h"
#include "vtkChiOcclusionGL.h"

#include <chiaroscuro/chi_occlusion.h>

#include "vtkRenderWindow.h"
#include "vtkWeakPointer.h"

#include <string>
#include <vector>

class vtkOpenGLRenderWindow;
class vtkTextureObject;

// The two engines behind one call: chooses, says why, and hands the picture out as floats or as
// textures, whichever it is made in.
class vtkChiOcclusionEngine
{
public:
  enum
  {
    OPENGL = vtkChiEngineChoice::OPENGL
  };

  vtkChiOcclusionEngine() = default;
  ~vtkChiOcclusionEngine();
  vtkChiOcclusionEngine(const vtkChiOcclusionEngine&) = delete;
  void operator=(const vtkChiOcclusionEngine&) = delete;

  // Makes the core's handle, where there is none yet.
  chi_status Prepare(const chi_exec* exec);
  chi_occlusion* GetCore() { return this->Core; }

  // Status and statistics are those of chi_occlusion_render.
  chi_status Render(const chi_exec* exec, vtkOpenGLRenderWindow* window,
    const chi_occlusion_frame& frame, int asked, bool half);
  const chi_occlusion_stats& GetStats() const { return this->Stats; }

  // AUTO before the first frame.
  int GetInUse() const { return this->Choice.GetInUse(); }
  const std::string& GetReason() const { return this->Choice.GetReason(); }

  // The last picture; its floats are null where it lies in textures and has not been read back. The
  // textures are null where it lies in floats alone.
  const chi_occlusion_image& GetImage() const { return this->Image; }
  vtkTextureObject* GetLayer();
  vtkTextureObject* GetVisibility();
  // Makes the floats; false where the window has gone, or there is no picture.
  bool ReadImage();

  void ReleaseGraphicsResources(vtkWindow* window);

private:
  chi_status RenderOpenGL(const chi_exec* exec, vtkOpenGLRenderWindow* window,
    const chi_occlusion_frame& frame, bool half);
  void HandOut();
  void SplitVisibility();

  chi_occlusion* Core = nullptr;
  vtkChiOcclusionGL GL;
  vtkWeakPointer<vtkRenderWindow> Window;
  vtkChiEngineChoice Choice;
  chi_occlusion_image Image = {};
  chi_occlusion_stats Stats = {};
  std::vector<float> Rgba;
  std::vector<float> Visibility;
  std::vector<float> VisibilityRgb; // empty where it has one colour
};

#endif
