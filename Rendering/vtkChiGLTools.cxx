// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#if __has_include("vtk_glad.h")
#  include "vtk_glad.h"
#else
#  include "vtk_glew.h"
#endif
#include "vtkChiGLTools.h"

#include "vtkOpenGLRenderWindow.h"
#include "vtkTextureObject.h"

#include <algorithm>
#include <cctype>

namespace
{
void prepare(
  vtkTextureObject* texture, vtkOpenGLRenderWindow* window, const vtkChiGLTools::Format& format)
{
  texture->SetContext(window);
  texture->SetMinificationFilter(vtkTextureObject::Nearest);
  texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  texture->SetWrapS(vtkTextureObject::ClampToEdge);
  texture->SetWrapT(vtkTextureObject::ClampToEdge);
  texture->SetWrapR(vtkTextureObject::ClampToEdge);
  texture->SetInternalFormat(format.Internal);
  texture->SetFormat(format.External);
  texture->SetDataType(static_cast<unsigned int>(texture->GetDefaultDataType(format.Type)));
}

const char* const FAILED = "this window's OpenGL could not carry the shaders out";
}

//------------------------------------------------------------------------------
vtkChiGLTools::Format vtkChiGLTools::FloatFormat(int components)
{
  switch (components)
  {
    case 1:
      return { GL_R32F, GL_RED, VTK_FLOAT, 1 };
    case 2:
      return { GL_RG32F, GL_RG, VTK_FLOAT, 2 };
    default:
      return { GL_RGBA32F, GL_RGBA, VTK_FLOAT, 4 };
  }
}

//------------------------------------------------------------------------------
vtkChiGLTools::Format vtkChiGLTools::UnsignedFormat(int components)
{
  return components == 1 ? Format{ GL_R32UI, GL_RED_INTEGER, VTK_UNSIGNED_INT, 1 }
                         : Format{ GL_RGBA32UI, GL_RGBA_INTEGER, VTK_UNSIGNED_INT, 4 };
}

//------------------------------------------------------------------------------
// The interface of VTK takes no const, and only reads.
bool vtkChiGLTools::Upload(vtkTextureObject* texture, vtkOpenGLRenderWindow* window,
  const Format& format, std::size_t width, std::size_t height, const void* data)
{
  prepare(texture, window, format);
  return texture->Create2DFromRaw(static_cast<unsigned int>(width),
    static_cast<unsigned int>(height), format.Components, format.Type, const_cast<void*>(data));
}

//------------------------------------------------------------------------------
bool vtkChiGLTools::Upload(vtkTextureObject* texture, vtkOpenGLRenderWindow* window,
  const Format& format, const std::size_t size[3], const void* data)
{
  prepare(texture, window, format);
  return texture->Create3DFromRaw(static_cast<unsigned int>(size[0]),
    static_cast<unsigned int>(size[1]), static_cast<unsigned int>(size[2]), format.Components,
    format.Type, const_cast<void*>(data));
}

//------------------------------------------------------------------------------
void vtkChiGLTools::Reserve(vtkTextureObject* texture, vtkOpenGLRenderWindow* window, int width,
  int height, int components, bool half)
{
  const unsigned int internal = components == 4 ? (half ? GL_RGBA16F : GL_RGBA32F)
    : components == 2                           ? (half ? GL_RG16F : GL_RG32F)
                                                : (half ? GL_R16F : GL_R32F);
  const unsigned int w = static_cast<unsigned int>(width);
  const unsigned int h = static_cast<unsigned int>(height);
  texture->SetContext(window);
  if (texture->GetHandle() != 0 && texture->GetWidth() == w && texture->GetHeight() == h &&
    texture->GetInternalFormat(VTK_FLOAT, components, false) == internal)
  {
    return;
  }
  texture->ReleaseGraphicsResources(window);
  texture->SetContext(window);
  texture->SetMinificationFilter(vtkTextureObject::Nearest);
  texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  texture->SetBorderColor(1.0f, 1.0f, 1.0f, 1.0f);
  texture->SetWrapS(vtkTextureObject::ClampToBorder);
  texture->SetWrapT(vtkTextureObject::ClampToBorder);
  texture->SetInternalFormat(internal);
  texture->SetFormat(components == 4 ? GL_RGBA : components == 2 ? GL_RG : GL_RED);
  texture->SetDataType(GL_FLOAT);
  texture->Allocate2D(w, h, components, VTK_FLOAT);
}

//------------------------------------------------------------------------------
bool vtkChiGLTools::IsSoftware(const std::string& renderer)
{
  std::string lower = renderer;
  std::transform(lower.begin(), lower.end(), lower.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* name : { "llvmpipe", "softpipe", "swiftshader", "swr", "software", "lavapipe",
         "microsoft basic render", "gdi generic" })
  {
    if (lower.find(name) != std::string::npos)
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
std::string vtkChiGLTools::GetRendererOf(vtkOpenGLRenderWindow* window)
{
  window->MakeCurrent();
  const GLubyte* name = glGetString(GL_RENDERER);
  return name ? reinterpret_cast<const char*>(name) : "";
}

//------------------------------------------------------------------------------
int vtkChiEngineChoice::Choose(
  vtkOpenGLRenderWindow* window, int asked, const std::function<std::string()>& obstacle)
{
  this->InUse = CPU;
  if (asked == CPU)
  {
    this->Reason = "the CPU engine is asked for";
    return this->InUse;
  }
  const std::string renderer = vtkChiGLTools::GetRendererOf(window);
  if (asked == AUTO && vtkChiGLTools::IsSoftware(renderer))
  {
    this->Reason = "OpenGL is drawn by " + renderer + ", in software";
    return this->InUse;
  }
  this->Reason = this->Refused.GetPointer() == window ? FAILED : obstacle();
  if (this->Reason.empty())
  {
    this->InUse = OPENGL;
    this->Reason =
      asked == OPENGL ? "the OpenGL engine is asked for" : "OpenGL is drawn by " + renderer;
  }
  return this->InUse;
}

//------------------------------------------------------------------------------
void vtkChiEngineChoice::Refuse(vtkOpenGLRenderWindow* window)
{
  this->Refused = window;
  this->InUse = CPU;
  this->Reason = FAILED;
}
