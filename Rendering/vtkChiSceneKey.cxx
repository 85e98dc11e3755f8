// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiSceneKey.h"
#include "vtkChiInputTools.h"

#include "vtkActor.h"
#include "vtkAlgorithm.h"
#include "vtkAssemblyNode.h"
#include "vtkAssemblyPath.h"
#include "vtkCollection.h"
#include "vtkDataObject.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMapper.h"
#include "vtkMatrix4x4.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkTexture.h"

#include <algorithm>

namespace
{
// When anything that a mapper draws was last modified. vtkActor looks at its first input only; a
// glyph's shape comes in by the second.
vtkMTimeType mapperTime(vtkMapper* mapper)
{
  vtkMTimeType time = mapper ? mapper->GetMTime() : 0;
  for (int port = 0; mapper && port < mapper->GetNumberOfInputPorts(); ++port)
  {
    for (int item = 0; item < mapper->GetNumberOfInputConnections(port); ++item)
    {
      mapper->GetInputAlgorithm(port, item)->Update();
      vtkDataObject* data = mapper->GetInputDataObject(port, item);
      time = std::max(time, data ? data->GetMTime() : 0);
    }
  }
  return time;
}

// Everything that a prop's picture depends on.
void appendProp(vtkProp* prop, std::vector<std::uint64_t>& key)
{
  key.push_back(vtkChiBits(prop));
  vtkActor* actor = vtkActor::SafeDownCast(prop);
  if (actor)
  {
    key.push_back(
      std::max({ actor->GetMTime(), actor->GetRedrawMTime(), mapperTime(actor->GetMapper()) }));
    return;
  }
  // The parts of an assembly: their matrices by value, because drawing one writes into its parts
  // and so gives them a new time each frame.
  prop->InitPathTraversal();
  while (vtkAssemblyPath* path = prop->GetNextPath())
  {
    vtkProp* leaf = path->GetLastNode()->GetViewProp();
    vtkActor* part = vtkActor::SafeDownCast(leaf);
    key.push_back(vtkChiBits(leaf));
    key.push_back(static_cast<std::uint64_t>(leaf->GetVisibility()));
    if (part)
    {
      key.push_back(std::max(mapperTime(part->GetMapper()), part->GetProperty()->GetMTime()));
      key.push_back(part->GetTexture() ? part->GetTexture()->GetMTime() : 0);
    }
    else
    {
      key.push_back(
        leaf == prop ? std::max(prop->GetMTime(), prop->GetRedrawMTime()) : leaf->GetRedrawMTime());
    }
    vtkMatrix4x4* matrix = path->GetLastNode()->GetMatrix();
    for (int i = 0; matrix && i < 16; ++i)
    {
      key.push_back(vtkChiBits(matrix->GetData()[i]));
    }
  }
}
}

//------------------------------------------------------------------------------
std::vector<std::uint64_t> vtkChiSceneKey(
  vtkRenderer* renderer, const vtkChiCameraView& camera, const std::vector<vtkProp*>& drawn)
{
  std::vector<std::uint64_t> key;
  // values of matrices, not the camera's time stamp: some render passes swap the camera each frame
  for (int i = 0; i < 16; ++i)
  {
    key.push_back(vtkChiBits(camera.GetView()[i]));
    key.push_back(vtkChiBits(camera.GetProjection()[i]));
  }
  for (int i = 0; i < 3; ++i)
  {
    key.push_back(vtkChiBits(renderer->GetAmbient()[i]));
  }
  key.push_back(static_cast<std::uint64_t>(renderer->GetTwoSidedLighting()));
  vtkTexture* environment =
    renderer->GetUseImageBasedLighting() ? renderer->GetEnvironmentTexture() : nullptr;
  key.push_back(environment ? environment->GetMTime() : 0);

  vtkCollectionSimpleIterator cookie;
  vtkLightCollection* lights = renderer->GetLights();
  lights->InitTraversal(cookie);
  while (vtkLight* light = lights->GetNextLight(cookie))
  {
    key.push_back(vtkChiBits(light));
    key.push_back(light->GetMTime());
  }
  for (vtkProp* prop : drawn)
  {
    appendProp(prop, key);
  }
  return key;
}
