// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiFieldInput_h
#define vtkChiFieldInput_h

#include "vtkChiTransferInput.h"

#include <chiaroscuro/chi_tet.h>
#include <chiaroscuro/chi_transfer.h>

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkDataSet;
class vtkVolumeProperty;

// Lends what is drawn of a mesh to the C core: one array of points or cells, perhaps another for
// opacity, and the transfer functions as tables. Nothing is copied but
// arrays that the core cannot read; tables and copies are kept until their sources change.
class vtkChiFieldInput
{
public:
  // `vectorComponent` is what is drawn of several independent components; -1: the magnitude.
  // `opacityArray` is the name of the array that the opacity function is read at, empty: the
  // scalars. Returns false where there is nothing to draw: GetProblem() says why.
  bool Collect(vtkAbstractVolumeMapper* mapper, vtkDataSet* input, vtkVolumeProperty* property,
    int vectorComponent, const std::string& opacityArray);

  const chi_tet_field* GetField() const { return &this->Field; }
  const chi_transfer_view* GetTransfer() const { return &this->Transfer; }
  const std::string& GetProblem() const { return this->Problem; }
  // What is drawn differently from what was asked.
  const std::vector<std::string>& GetLimits() const { return this->Limits; }

private:
  // An array as the core reads it: itself, or a copy.
  struct Lent
  {
    vtkSmartPointer<vtkDataArray> From;
    vtkSmartPointer<vtkDataArray> Held;
    std::array<std::uint64_t, 5> Key = {};
    chi_array_view View = {};
  };

  bool FindScalars(vtkAbstractVolumeMapper* mapper, vtkDataSet* input);
  bool FindOpacity(vtkDataSet* input, const std::string& name);
  void ChooseComponents(vtkVolumeProperty* property, int vectorComponent);
  bool IsLong(vtkDataSet* input, vtkDataArray* array);
  bool Lend(vtkDataArray* array, vtkMTimeType time, Lent& lent);
  bool LendOpacity(vtkMTimeType time);
  void CollectFunctions(vtkVolumeProperty* property, vtkMTimeType time);
  void CombineFunctions();
  void AddLimits(vtkVolumeProperty* property);

  chi_tet_field Field = {};
  chi_transfer_view Transfer = {};
  std::string Problem;
  std::vector<std::string> Limits;

  vtkDataArray* Scalars = nullptr; // of this call, as found; likewise the next three
  vtkDataArray* ColorArray = nullptr; // of direct colours
  vtkDataArray* OpacityArray = nullptr;
  int OpacityComponent = 0;

  Lent Samples;
  Lent Opacities;
  Lent Colors;
  vtkChiTransferInput
    ColorFunction; // and the opacity function, where it is read at the scalars too
  vtkChiTransferInput OpacityFunction;
  std::size_t Entries = 2; // that both tables have
  std::array<std::uint64_t, 9> OpacityKey = {};
  std::array<std::uint64_t, 4> FieldKey = {};
  std::array<std::uint64_t, 2> TransferKey = {};
};

#endif
