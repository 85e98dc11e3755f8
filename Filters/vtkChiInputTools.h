// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiInputTools_h
#define vtkChiInputTools_h

#include "vtkAlgorithm.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"

#include <cstdint>
#include <cstring>
#include <string>

// What the classes that lend VTK's data to the core have in common.

// For keys: a thing is the same where its bits are.
inline std::uint64_t vtkChiBits(const void* pointer)
{
  return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(pointer));
}
inline std::uint64_t vtkChiBits(double value)
{
  std::uint64_t pattern = 0;
  static_assert(sizeof(pattern) == sizeof(value), "bits of a double");
  std::memcpy(&pattern, &value, sizeof(pattern));
  return pattern;
}

// Whether SetInputArrayToProcess has been called for this index; else filters take arrays of their
// own choice.
inline bool vtkChiIsChosen(vtkAlgorithm* algorithm, int index)
{
  vtkInformationVector* chosen =
    algorithm->GetInformation()->Get(vtkAlgorithm::INPUT_ARRAYS_TO_PROCESS());
  return chosen && chosen->GetNumberOfInformationObjects() > index &&
    chosen->GetInformationObject(index)->Has(vtkDataObject::FIELD_ASSOCIATION());
}

// For messages: what SetInputArrayToProcess has been told, for messages about an array that is not
// there.
inline std::string vtkChiChosenArray(vtkAlgorithm* algorithm, int index)
{
  vtkInformation* chosen = algorithm->GetInputArrayInformation(index);
  const char* name = chosen->Get(vtkDataObject::FIELD_NAME());
  return name ? std::string(" '") + name + "', chosen by SetInputArrayToProcess"
              : " of the kind chosen by SetInputArrayToProcess";
}

// For messages.
inline std::string vtkChiDescribe(vtkDataArray* array)
{
  return std::string("array '") + (array->GetName() ? array->GetName() : "(unnamed)") + "' (" +
    array->GetDataTypeAsString() + ", " + std::to_string(array->GetNumberOfTuples()) + " tuples, " +
    std::to_string(array->GetNumberOfComponents()) + " components)";
}

// Empty, or what is wrong with a component of an array, of which -1 is the magnitude.
inline std::string vtkChiRefuseComponent(vtkDataArray* array, int component)
{
  return component >= -1 && component < array->GetNumberOfComponents() ? std::string()
                                                                       : vtkChiDescribe(array) +
      " has no component " + std::to_string(component) + "; they begin at 0, -1 is the magnitude";
}

#endif
