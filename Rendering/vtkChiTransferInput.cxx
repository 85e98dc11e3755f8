// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiTransferInput.h"
#include "vtkChiInputTools.h"

#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace
{
// The smallest distance between nodes of the opacity function, of those larger than `least`;
// infinite where there is none.
double narrowestGap(vtkVolumeProperty* property, int function, double least)
{
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity(function);
  double gap = std::numeric_limits<double>::infinity();
  double last[4];
  double node[4];
  for (int i = 0; i < opacity->GetSize(); ++i)
  {
    opacity->GetNodeValue(i, node);
    const double distance = i > 0 ? node[0] - last[0] : 0.0;
    if (distance > least)
    {
      gap = std::min(gap, distance);
    }
    std::copy(node, node + 4, last);
  }
  return gap;
}

}

//------------------------------------------------------------------------------
// Entries and range of the tables. Outside the nodes the functions are constant, so the tables need
// to span the nodes only, and of these only the part that the data reach.
void vtkChiTransferInput::ChooseRange(
  vtkVolumeProperty* property, vtkDataArray* samples, std::size_t least)
{
  double nodes[2];
  property->GetScalarOpacity(this->Function)->GetRange(nodes);
  double colorNodes[2];
  bool clamped = property->GetScalarOpacity(this->Function)->GetClamping() != 0;
  if (property->GetColorChannels(this->Function) == 1)
  {
    property->GetGrayTransferFunction(this->Function)->GetRange(colorNodes);
    clamped = clamped && property->GetGrayTransferFunction(this->Function)->GetClamping() != 0;
  }
  else
  {
    property->GetRGBTransferFunction(this->Function)->GetRange(colorNodes);
    clamped = clamped && property->GetRGBTransferFunction(this->Function)->GetClamping() != 0;
  }
  nodes[0] = std::min(nodes[0], colorNodes[0]);
  nodes[1] = std::max(nodes[1], colorNodes[1]);

  double data[2];
  samples->GetFiniteRange(data, this->Component);
  if (!(data[0] <= data[1])) // no finite sample at all
  {
    data[0] = nodes[0];
    data[1] = nodes[1];
  }
  double low = clamped ? std::max(nodes[0], std::min(data[0], nodes[1])) : data[0];
  double high = clamped ? std::min(nodes[1], std::max(data[1], nodes[0])) : data[1];
  const int type = samples->GetDataType();
  const bool integers =
    type != VTK_FLOAT && type != VTK_DOUBLE && this->Component >= 0 && high - low < 65535.0;
  if (integers)
  {
    low = std::floor(low);
    high = std::max(std::ceil(high), low + 1.0);
    // entries on the integers, and evenly between them where there is room, so that nodes at
    // integers, where the steps of such functions are, are met exactly
    const double span = high - low;
    const double parts = std::max(1.0, std::floor(4096.0 / span));
    this->Transfer.count = static_cast<std::size_t>(span * parts) + 1;
  }
  else
  {
    const double room = std::max(std::abs(low), std::abs(high)) * 1e-6;
    if (!(high - low > room)) // one value, or none: a table around it
    {
      const double half = std::max(room, 1e-30);
      low -= half;
      high += half;
    }
    // four entries over the narrowest feature, but for those that are meant as steps
    const double span = high - low;
    const double entries = 4.0 * span / narrowestGap(property, this->Function, span / 16384.0);
    this->Transfer.count =
      static_cast<std::size_t>(std::min(std::max(entries, 4096.0), 16384.0)) + 1;
  }
  this->Transfer.count = std::max(this->Transfer.count, least);
  this->Transfer.range[0] = low;
  this->Transfer.range[1] = high;
}

//------------------------------------------------------------------------------
bool vtkChiTransferInput::Collect(vtkVolumeProperty* property, int function, int unit,
  vtkDataArray* samples, int component, std::uint64_t version, vtkMTimeType time, std::size_t least)
{
  this->Limit.clear();
  this->Function = function;
  this->Component = component;
  vtkPiecewiseFunction* opacity = property->GetScalarOpacity(function);
  const int channels = property->GetColorChannels(function);
  vtkPiecewiseFunction* gray =
    channels == 1 ? property->GetGrayTransferFunction(function) : nullptr;
  vtkColorTransferFunction* color = gray ? nullptr : property->GetRGBTransferFunction(function);
  double unitDistance = property->GetScalarOpacityUnitDistance(unit);
  if (!(unitDistance > 0.0) || !std::isfinite(unitDistance))
  {
    this->Limit = "a scalar opacity unit distance of " + std::to_string(unitDistance) +
      " (vtkVolumeProperty) has no meaning: 1 is used";
    unitDistance = 1.0;
  }

  const void* colorObject = gray ? static_cast<void*>(gray) : static_cast<void*>(color);
  const std::array<std::uint64_t, 11> key = { vtkChiBits(opacity), opacity->GetMTime(),
    vtkChiBits(colorObject), gray ? gray->GetMTime() : color->GetMTime(), version,
    vtkChiBits(unitDistance), time, vtkChiBits(samples), static_cast<std::uint64_t>(function),
    static_cast<std::uint64_t>(component), least };
  if (key == this->Key && !this->Opacities.empty())
  {
    return false;
  }

  this->ChooseRange(property, samples, least);
  const int count = static_cast<int>(this->Transfer.count);
  const double* range = this->Transfer.range;
  std::vector<float> opacities(this->Transfer.count);
  std::vector<float> colors(3 * this->Transfer.count);
  opacity->GetTable(range[0], range[1], count, opacities.data());
  if (gray)
  {
    std::vector<float> values(this->Transfer.count);
    gray->GetTable(range[0], range[1], count, values.data());
    for (std::size_t i = 0; i < colors.size(); ++i)
    {
      colors[i] = values[i / 3];
    }
  }
  else
  {
    color->GetTable(range[0], range[1], count, colors.data());
    if (color->GetSize() == 1) // where a sample hits the only node, VTK's table says black
    {
      double node[6];
      color->GetNodeValue(0, node);
      for (std::size_t i = 0; i < colors.size(); ++i)
      {
        colors[i] = static_cast<float>(node[1 + i % 3]);
      }
    }
  }
  const auto clamp = [](float value)
  { return std::isfinite(value) ? std::min(std::max(value, 0.0f), 1.0f) : 0.0f; };
  std::transform(opacities.begin(), opacities.end(), opacities.begin(), clamp);
  std::transform(colors.begin(), colors.end(), colors.begin(), clamp);

  this->Opacities = std::move(opacities);
  this->Colors = std::move(colors);
  this->Transfer.struct_size = sizeof(chi_transfer_view);
  this->Transfer.rgb = this->Colors.data();
  this->Transfer.opacity = this->Opacities.data();
  this->Transfer.unit_distance = unitDistance;
  ++this->Transfer.version;
  this->Key = key;
  return true;
}
