// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiVolumeInput_h
#define vtkChiVolumeInput_h

#include "vtkChiClipInput.h"
#include "vtkChiShadingInput.h"
#include "vtkChiTransferInput.h"

#include <chiaroscuro/chi_components.h>
#include <chiaroscuro/chi_transfer.h>
#include <chiaroscuro/chi_volume.h>

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkDataSet;
class vtkImageData;
class vtkRectilinearGrid;
class vtkVolume;
class vtkVolumeProperty;

// Borrows the input of a volume mapper for the C core: samples, matrix, and the transfer functions
// as tables. Nothing is copied but arrays of a layout or type that the core cannot read; tables and
// copies are kept until their sources change.
class vtkChiVolumeInput
{
public:
  // Problem: why there is no volume to draw. Limits: what was drawn differently from what was
  // asked. `world` is the row-major matrix from world space to the space that the core calls world.
  bool Collect(vtkAbstractVolumeMapper* mapper, vtkDataSet* input, int scalarMode,
    vtkVolume* volume, const double* world);

  const chi_volume_view* GetVolume() const { return &this->Volume; }
  const chi_transfer_view* GetTransfer() const { return &this->Transfer; }
  // Null: one component is drawn.
  const chi_components* GetComponents() const
  {
    return this->Components.count > 1 ? &this->Components : nullptr;
  }
  vtkChiShadingInput* GetShading() { return &this->Shading; }
  // The array along the y axis of a two-dimensional transfer function; empty for the gradient.
  void SetSecondArray(const char* name) { this->SecondName = name ? name : ""; }
  // What the mapper's clipping planes and cropping box leave: [planes x 4] for the core.
  const std::vector<double>& GetClipPlanes() const { return this->Clips.GetPlanes(); }
  const std::string& GetProblem() const { return this->Problem; }
  const std::vector<std::string>& GetLimits() const { return this->Limits; }
  bool IsEmpty() const { return this->Empty; }

private:
  bool CollectSamples(
    vtkAbstractVolumeMapper* mapper, vtkImageData* image, vtkMTimeType time, int scalarMode);
  bool CollectMatrix(vtkImageData* image, vtkVolume* volume, const double* world);
  bool CollectTransfer(vtkVolumeProperty* property, vtkImageData* image, vtkMTimeType time);
  vtkDataArray* FindSecond(vtkVolumeProperty* property, vtkImageData* image);
  void AddPlaneLimit();
  bool CollectClips(vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world);
  int CountComponents(vtkVolumeProperty* property);
  vtkImageData* Resample(vtkAbstractVolumeMapper* mapper, vtkRectilinearGrid* grid, int scalarMode);
  vtkDataArray* Find(
    vtkAbstractVolumeMapper* mapper, vtkDataSet* data, int scalarMode, int& isCell);

  chi_volume_view Volume = {};
  chi_transfer_view Transfer = {};
  vtkChiClipInput Clips;
  std::string Problem;
  std::vector<std::string> Limits;
  bool Empty = false;

  vtkSmartPointer<vtkDataArray> Scalars; // as found
  vtkSmartPointer<vtkDataArray> Samples; // as handed to the core: the same, or a plain copy
  std::array<std::uint64_t, 4> SamplesKey = {};
  std::array<vtkChiTransferInput, CHI_MAX_COMPONENTS> Functions; // of the first, or the opacity's
  chi_components Components = {};
  std::array<std::uint64_t, 5> ShadingKey = {};
  vtkChiShadingInput Shading;
  std::string SecondName;

  vtkSmartPointer<vtkImageData> Resampled;
  std::array<std::uint64_t, 2> ResampledKey = {};
};

#endif
