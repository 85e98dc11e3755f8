// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiPassKeys_h
#define vtkChiPassKeys_h

#include "vtkInformation.h"
#include "vtkInformationObjectBaseVectorKey.h"
#include "vtkNew.h"
#include "vtkOpenGLRenderPass.h"
#include "vtkProp.h"
#include "vtkSmartPointer.h"

#include <vector>

// The first keys of a prop modify it; what they hold later does not.
inline void vtkChiProvideKeys(vtkProp* prop)
{
  if (!prop->GetPropertyKeys())
  {
    vtkNew<vtkInformation> keys;
    prop->SetPropertyKeys(keys);
  }
}

// The render passes whose parts of shaders a prop is drawn with.
inline void vtkChiAppendPass(vtkProp* prop, vtkOpenGLRenderPass* pass)
{
  vtkChiProvideKeys(prop);
  prop->GetPropertyKeys()->Append(vtkOpenGLRenderPass::RenderPasses(), pass);
}

inline void vtkChiRemovePass(vtkProp* prop, vtkOpenGLRenderPass* pass)
{
  vtkInformationObjectBaseVectorKey* key = vtkOpenGLRenderPass::RenderPasses();
  vtkInformation* keys = prop->GetPropertyKeys();
  if (keys && keys->Has(key))
  {
    keys->Remove(key, pass);
    if (keys->Length(key) == 0)
    {
      keys->Remove(key);
    }
  }
}

// Whether the depth peeling pass draws a prop, several times a frame.
inline bool vtkChiIsPeeled(vtkProp* prop)
{
  vtkInformation* keys = prop->GetPropertyKeys();
  vtkInformationObjectBaseVectorKey* key = vtkOpenGLRenderPass::RenderPasses();
  bool peeled = false;
  for (int i = 0; keys && keys->Has(key) && i < keys->Length(key); ++i)
  {
    peeled = peeled || keys->Get(key, i)->IsA("vtkDualDepthPeelingPass");
  }
  return peeled;
}

// Takes the keys of render passes that are under way (depth peeling, say) off a prop, because their
// shaders write something else than colour, and puts them back.
class vtkChiPlainShaders
{
public:
  explicit vtkChiPlainShaders(vtkProp* prop)
    : Keys(prop->GetPropertyKeys())
  {
    vtkInformationObjectBaseVectorKey* key = vtkOpenGLRenderPass::RenderPasses();
    const int count = this->Keys && this->Keys->Has(key) ? this->Keys->Length(key) : 0;
    for (int i = 0; i < count; ++i)
    {
      this->Passes.emplace_back(this->Keys->Get(key, i));
    }
    if (count > 0)
    {
      this->Keys->Remove(key);
    }
  }
  ~vtkChiPlainShaders()
  {
    for (const auto& pass : this->Passes)
    {
      this->Keys->Append(vtkOpenGLRenderPass::RenderPasses(), pass);
    }
  }
  vtkChiPlainShaders(const vtkChiPlainShaders&) = delete;
  void operator=(const vtkChiPlainShaders&) = delete;

private:
  vtkSmartPointer<vtkInformation> Keys;
  std::vector<vtkSmartPointer<vtkObjectBase>> Passes;
};

#endif
