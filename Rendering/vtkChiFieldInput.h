// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiFieldInput_h
#define vtkChiFieldInput_h

#include "vtkChiPlaneInput.h"
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

  // Colour and opacity over two quantities, in place of all else where there are any.
  vtkChiPlaneInput* GetPlane() { return &this->Plane; }
  // The array along the second axis of these; empty for the gradient.
  void SetSecondArray(const char* name) { this->SecondName = name ? name : ""; }

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
  void FindSecond(vtkVolumeProperty* property, vtkDataSet* input);
  void CollectPlane(vtkVolumeProperty* property, vtkMTimeType time);
  void AddLimits(vtkVolumeProperty* property);

  chi_tet_field Field = {};
  chi_transfer_view Transfer = {};
  std::string Problem;
  std::vector<std::string> Limits;

  vtkDataArray* Scalars = nullptr;    // of this call, as found; likewise the next three
  vtkDataArray* ColorArray = nullptr; // of direct colours
  vtkDataArray* OpacityArray = nullptr;
  int OpacityComponent = 0;

  Lent Samples;
  Lent Opacities;
  Lent Colors;
  Lent Seconds;
  vtkChiPlaneInput Plane;
  std::string SecondName;
  vtkDataArray* Second = nullptr; // of this call; null: the gradient
  vtkChiTransferInput
    ColorFunction; // and the opacity function, where it is read at the scalars too
  vtkChiTransferInput OpacityFunction;
  std::size_t Entries = 2; // that both tables have
  std::array<std::uint64_t, 9> OpacityKey = {};
  std::array<std::uint64_t, 5> FieldKey = {};
  std::array<std::uint64_t, 2> TransferKey = {};
  std::array<std::uint64_t, 7> PlaneKey = {};
  chi_transfer_view PlaneTransfer = {}; // what the plane adds to the transfer functions
};

#endif
