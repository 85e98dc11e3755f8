// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiGeometryPass_h
#define vtkChiGeometryPass_h

#include "vtkOpenGLRenderPass.h"

// Draws the props of a render state so that their colour is something else of them: their normal in
// view coordinates, with an alpha of 1, or their specular light, textured as the rest is. 0 where a
// mapper's shader does not know it. Their shaders are rebuilt for it, and again for the next
// ordinary frame.
class vtkChiGeometryPass : public vtkOpenGLRenderPass
{
public:
  static vtkChiGeometryPass* New();
  vtkTypeMacro(vtkChiGeometryPass, vtkOpenGLRenderPass);

  enum Outputs
  {
    NORMAL,
    SPECULAR
  };
  // To be set before the first drawing.
  void SetOutput(Outputs output) { this->Output = output; }

  void Render(const vtkRenderState* state) override;
  bool PreReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool PostReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;

protected:
  vtkChiGeometryPass() = default;
  ~vtkChiGeometryPass() override = default;

private:
  vtkChiGeometryPass(const vtkChiGeometryPass&) = delete;
  void operator=(const vtkChiGeometryPass&) = delete;

  Outputs Output = NORMAL;
};

#endif
