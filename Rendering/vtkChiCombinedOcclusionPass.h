// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkChiCombinedOcclusionPass
 * @brief   draw opaque geometry once, and volumes that it shades and that shade it
 *
 * For those who build their own chain of render passes (vtkRenderer::SetPass); nobody else needs
 * it, because vtkChiCombinedOcclusionVolumeMapper works under the stock pipeline as it is. In such
 * a chain this pass takes the places of vtkOpaquePass and vtkVolumetricPass: it draws the opaque
 * geometry of the renderer into a buffer of its own (colour, specular part, depth), lays this over
 * the bound frame buffer, depth included, and has the delegate draw the volumes. A
 * vtkChiCombinedOcclusionVolumeMapper among them finds the buffer there, so that geometry is drawn
 * once a frame, and not at all in frames in which neither it nor the view has changed.
 *
 * @code
 * vtkCameraPass
 *   vtkSequencePass
 *     vtkLightsPass
 *     vtkChiCombinedOcclusionPass
 *     vtkOverlayPass
 * @endcode
 *
 * Translucent geometry is drawn by the mapper, whether the chain has a vtkTranslucentPass or not,
 * from the second frame on. The textures are those of the last frame, of the viewport's size; they
 * belong to the renderer, and are null where it had no opaque geometry in view.
 *
 * @sa vtkChiCombinedOcclusionVolumeMapper vtkSequencePass vtkVolumetricPass
 */

#ifndef vtkChiCombinedOcclusionPass_h
#define vtkChiCombinedOcclusionPass_h

#include "vtkChiRenderingModule.h" // for export macro
#include "vtkOpenGLRenderPass.h"

#include <memory> // for std::unique_ptr

class vtkTextureObject;

class VTKCHIRENDERING_EXPORT vtkChiCombinedOcclusionPass : public vtkOpenGLRenderPass
{
public:
  static vtkChiCombinedOcclusionPass* New();
  vtkTypeMacro(vtkChiCombinedOcclusionPass, vtkOpenGLRenderPass);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Draw geometry and volumes. The renderer's lights must be set (vtkLightsPass). While a selection
   * is made its selector draws all props, as in a renderer without a pass; without a camera that
   * can be used, opaque props draw themselves as they would in vtkOpaquePass.
   */
  void Render(const vtkRenderState* state) override;

  ///@{
  /**
   * The pass that draws volumes over the geometry; a vtkVolumetricPass at first. Null: none.
   */
  void SetDelegatePass(vtkRenderPass* delegate);
  vtkRenderPass* GetDelegatePass();
  ///@}

  ///@{
  /**
   * Lit colours of the opaque geometry, RGBA floats, alpha 0 where there is none; the specular part
   * of them, null where no prop has any; window depths in the first component.
   */
  vtkTextureObject* GetColorTexture();
  vtkTextureObject* GetSpecularTexture();
  vtkTextureObject* GetDepthTexture();
  ///@}

  /**
   * Whether the last frame found the geometry's buffer as it was.
   */
  bool GetReusedGeometry();

  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkChiCombinedOcclusionPass();
  ~vtkChiCombinedOcclusionPass() override;

private:
  vtkChiCombinedOcclusionPass(const vtkChiCombinedOcclusionPass&) = delete;
  void operator=(const vtkChiCombinedOcclusionPass&) = delete;

  void DrawQuad(vtkRenderer* renderer, bool colors);

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
