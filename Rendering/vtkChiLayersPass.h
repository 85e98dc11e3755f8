// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiLayersPass_h
#define vtkChiLayersPass_h

#include "vtkOpenGLRenderPass.h"

class vtkTextureObject;

// Hangs on translucent props from the start of a frame to its end. One shader serves for both: the
// renderer's own drawing, of blending, peeling or order-independent transparency alike, is hidden,
// and layers are peeled off by others' draw calls in between; so no shader is built anew for it.
// What of a prop is opaque is drawn as ever.
class vtkChiLayersPass : public vtkOpenGLRenderPass
{
public:
  static vtkChiLayersPass* New();
  vtkTypeMacro(vtkChiLayersPass, vtkOpenGLRenderPass);

  enum Modes
  {
    DRAW,
    HIDE,
    FIRST,
    NEXT,
    COUNT
  };
  // The textures, [height x width] window depths, must be active while props are drawn in the last
  // three modes; null where there is none.
  void SetMode(Modes mode, vtkTextureObject* before = nullptr, vtkTextureObject* opaque = nullptr);

  // Props drawn through this pass's shader since the last call; foreign mappers have their own.
  int TakeDrawn();

  void Render(const vtkRenderState* state) override;
  bool PreReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool PostReplaceShaderValues(std::string& vertexShader, std::string& geometryShader,
    std::string& fragmentShader, vtkAbstractMapper* mapper, vtkProp* prop) override;
  bool SetShaderParameters(vtkShaderProgram* program, vtkAbstractMapper* mapper, vtkProp* prop,
    vtkOpenGLVertexArrayObject* VAO = nullptr) override;

protected:
  vtkChiLayersPass() = default;
  ~vtkChiLayersPass() override = default;

private:
  vtkChiLayersPass(const vtkChiLayersPass&) = delete;
  void operator=(const vtkChiLayersPass&) = delete;

  Modes Mode = HIDE;
  vtkTextureObject* Before = nullptr;
  vtkTextureObject* Opaque = nullptr;
  int Drawn = 0;
};

#endif
