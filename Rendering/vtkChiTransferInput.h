// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTransferInput_h
#define vtkChiTransferInput_h

#include <chiaroscuro/chi_transfer.h>

#include "vtkType.h"

#include <array>
#include <cstddef>
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
  // `function` is the index of the property's functions, `unit` that of its unit distance,
  // `version` that of the samples; of a component -1 the magnitude is taken. The tables have
  // `least` entries or more. Returns whether they are new.
  bool Collect(vtkVolumeProperty* property, int function, int unit, vtkDataArray* samples,
    int component, std::uint64_t version, vtkMTimeType time, std::size_t least = 2);

  const chi_transfer_view* GetTransfer() const { return &this->Transfer; }
  const std::string& GetLimit() const { return this->Limit; }

private:
  void ChooseRange(vtkVolumeProperty* property, vtkDataArray* samples, std::size_t least);

  chi_transfer_view Transfer = {};
  int Function = 0;
  int Component = 0;
  std::array<std::uint64_t, 11> Key = {};
  std::vector<float> Colors;
  std::vector<float> Opacities;
  std::string Limit;
};

#endif
