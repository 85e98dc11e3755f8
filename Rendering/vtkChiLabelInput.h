// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiLabelInput_h
#define vtkChiLabelInput_h

#include <chiaroscuro/chi_transfer.h>

#include <cstdint>
#include <string>
#include <vector>

class vtkVolumeProperty;

// The transfer functions of a vtkVolumeProperty's labels as tables for the C core: table 0 is the
// volume's own, each label with a function of its own has one more. A label without a colour or an
// opacity function takes the volume's own, as vtkGPUVolumeRayCastMapper does.
class vtkChiLabelInput
{
public:
  // `plain` holds the volume's own functions. `blend` is the label's share of colour and opacity,
  // the volume's own have the rest. False: labels make no difference.
  bool Collect(vtkVolumeProperty* property, const chi_transfer_view& plain, double blend);

  const chi_transfer_view* GetTransfer() const { return &this->Transfer; }
  // By label, 0 ... largest.
  const std::vector<std::uint8_t>& GetTableOfValue() const { return this->TableOfValue; }
  const std::vector<std::string>& GetLimits() const { return this->Limits; }

private:
  void ChooseRange(vtkVolumeProperty* property, const chi_transfer_view& plain);

  chi_transfer_view Transfer = {};
  std::vector<std::uint8_t> TableOfValue;
  std::vector<int> Labels; // of tables 1, 2, ...
  std::vector<float> Colors;
  std::vector<float> Opacities;
  std::vector<std::uint64_t> Key;
  std::vector<std::string> Limits;
};

#endif
