// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiInputTools_h
#define vtkChiInputTools_h

#include "vtkDataArray.h"

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

// For messages.
inline std::string vtkChiDescribe(vtkDataArray* array)
{
  return std::string("array '") + (array->GetName() ? array->GetName() : "(unnamed)") + "' (" +
    array->GetDataTypeAsString() + ", " + std::to_string(array->GetNumberOfTuples()) + " tuples, " +
    std::to_string(array->GetNumberOfComponents()) + " components)";
}

#endif
