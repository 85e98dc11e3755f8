// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGeometryPass_h
#define vtkChiGeometryPass_h

#include "vtkOpenGLRenderPass.h"

// Hangs on opaque props from the start of a frame to its end, and while they are drawn into a
// private buffer in between; one shader serves for all that is asked of them, so that none is built
// anew for it.
class vtkChiGeometryPass : public vtkOpenGLRenderPass
{
public:
  static vtkChiGeometryPass* New();
  vtkTypeMacro(vtkChiGeometryPass, vtkOpenGLRenderPass);

  enum Modes
  {
    DRAW,   // as ever
    HIDE,   // depth alone, by an alpha of 0: blending must be on
    BUFFER, // colour, and in the second target the specular part of it, textured as the rest is;
            // black where a mapper's shader does not know it
    NORMAL  // in view coordinates, with an alpha of 1; 0 where it is not known
  };
  void SetMode(Modes mode) { this->Mode = mode; }

  void Render(const vtkRenderState* state) override;
  bool PreReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool PostReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool SetShaderParameters(vtkShaderProgram* program, vtkAbstractMapper* mapper, vtkProp* prop,
    vtkOpenGLVertexArrayObject* VAO = nullptr) override;

protected:
  vtkChiGeometryPass() = default;
  ~vtkChiGeometryPass() override = default;

private:
  vtkChiGeometryPass(const vtkChiGeometryPass&) = delete;
  void operator=(const vtkChiGeometryPass&) = delete;

  Modes Mode = DRAW;
};

#endif
