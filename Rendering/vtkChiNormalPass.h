// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiNormalPass_h
#define vtkChiNormalPass_h

#include "vtkOpenGLRenderPass.h"

// Draws the props of a render state so that their colour is their normal in view coordinates, with
// an alpha of 1; 0 where a mapper's shader knows no normal. Their shaders are rebuilt for it, and
// again for the next ordinary frame.
class vtkChiNormalPass : public vtkOpenGLRenderPass
{
public:
  static vtkChiNormalPass* New();
  vtkTypeMacro(vtkChiNormalPass, vtkOpenGLRenderPass);

  void Render(const vtkRenderState* state) override;
  bool PreReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool PostReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;

protected:
  vtkChiNormalPass() = default;
  ~vtkChiNormalPass() override = default;

private:
  vtkChiNormalPass(const vtkChiNormalPass&) = delete;
  void operator=(const vtkChiNormalPass&) = delete;
};

#endif
