// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGLTools_h
#define vtkChiGLTools_h

#include "vtkWeakPointer.h"

#include <cstddef>
#include <functional>
#include <string>

class vtkOpenGLRenderWindow;
class vtkRenderWindow;
class vtkTextureObject;

// What the OpenGL engines share: textures of exact texels, and the choice of an engine.
namespace vtkChiGLTools
{
constexpr int TABLE_WIDTH = 4096; // texels a row of a table's texture

// A texel format, and the VTK type of what is uploaded into it.
struct Format
{
  unsigned int Internal;
  unsigned int External;
  int Type;
  int Components;
};

Format FloatFormat(int components); // 1, 2 or 4
Format UnsignedFormat(int components);

// Texels of one value each, to be fetched, never filtered. False where OpenGL refuses it.
bool Upload(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, const Format& format,
  std::size_t width, std::size_t height, const void* data);
bool Upload(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, const Format& format,
  const std::size_t size[3], const void* data);
// A texture to draw into, of floats of 32 bits, or of 16; beyond its edges it is 1.
void Reserve(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, int width, int height,
  int components, bool half);

// A line of a shader's head.
inline std::string Define(const char* name, int value)
{
  return std::string("#define ") + name + " " + std::to_string(value) + "\n";
}

// Whether a GL_RENDERER string names a rasteriser that runs on the processor, where the CPU
// engine is the faster one.
bool IsSoftware(const std::string& renderer);
std::string GetRendererOf(vtkOpenGLRenderWindow* window);
}

// Which of two engines draws, and why.
class vtkChiEngineChoice
{
public:
  enum
  {
    AUTO = 0, // OpenGL, unless a software rasteriser draws it
    CPU = 1,
    OPENGL = 2
  };

  // `obstacle`: why OpenGL cannot draw the frame in this window; empty where it can.
  int Choose(
    vtkOpenGLRenderWindow* window, int asked, const std::function<std::string()>& obstacle);
  // This window's OpenGL has failed: it is not tried again, and the CPU engine draws.
  void Refuse(vtkOpenGLRenderWindow* window);
  void Forget() { this->Refused = nullptr; }

  int GetInUse() const { return this->InUse; } // AUTO before the first frame
  const std::string& GetReason() const { return this->Reason; }

private:
  vtkWeakPointer<vtkRenderWindow> Refused;
  int InUse = AUTO;
  std::string Reason;
};

#endif
