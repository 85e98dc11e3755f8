// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTransferInput_h
#define vtkChiTransferInput_h

#include <chiaroscuro/chi_transfer.h>

#include "vtkType.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkVolumeProperty;

// The colour and opacity functions of a volume property as tables over one component of the
// samples, for the C core; kept until property or samples change.
class vtkChiTransferInput
{
public:
  // `function` is the index of the property's functions, `version` that of the samples. Returns
  // whether the tables are new.
  bool Collect(vtkVolumeProperty* property, int function, vtkDataArray* samples, int component,
    std::uint64_t version, vtkMTimeType time);

  const chi_transfer_view* GetTransfer() const { return &this->Transfer; }
  const std::string& GetLimit() const { return this->Limit; }

private:
  void ChooseRange(vtkVolumeProperty* property, vtkDataArray* samples);

  chi_transfer_view Transfer = {};
  int Function = 0;
  int Component = 0;
  std::array<std::uint64_t, 10> Key = {};
  std::vector<float> Colors;
  std::vector<float> Opacities;
  std::string Limit;
};

#endif
