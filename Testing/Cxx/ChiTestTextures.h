// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ChiTestTextures_h
#define ChiTestTextures_h

#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif

#include "vtkRenderWindow.h"

// Of the window's context. Names are small numbers in every implementation that hands out the next
// free one.
inline int ChiCountTextures(vtkRenderWindow* window)
{
  window->MakeCurrent();
  int count = 0;
  for (unsigned int name = 1; name < 4096; ++name)
  {
    count += glIsTexture(name) ? 1 : 0;
  }
  return count;
}

#endif
