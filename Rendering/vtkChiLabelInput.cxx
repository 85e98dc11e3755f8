// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiLabelInput.h"

#include "vtkColorTransferFunction.h"
#include "vtkPiecewiseFunction.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace
{
constexpr std::size_t maxTables = 256;
constexpr int maxLabel = 65535;
// of all tables together: positions in them are floats, and keep an eighth of an entry
constexpr double maxEntries = 2097152.0;

vtkColorTransferFunction* colorOf(vtkVolumeProperty* property, int label)
{
  vtkColorTransferFunction* own = label ? property->GetLabelColor(label) : nullptr;
  return own || property->GetColorChannels(0) == 1 ? own : property->GetRGBTransferFunction(0);
}

vtkPiecewiseFunction* opacityOf(vtkVolumeProperty* property, int label)
{
  vtkPiecewiseFunction* own = label ? property->GetLabelScalarOpacity(label) : nullptr;
  return own ? own : property->GetScalarOpacity(0);
}

void tabulate(vtkVolumeProperty* property, int label, const double range[2], int count,
  float* colors, float* opacities)
{
  opacityOf(property, label)->GetTable(range[0], range[1], count, opacities);
  vtkColorTransferFunction* color = colorOf(property, label);
  if (color)
  {
    color->GetTable(range[0], range[1], count, colors);
  }
  else
  {
    std::vector<float> gray(static_cast<std::size_t>(count));
    property->GetGrayTransferFunction(0)->GetTable(range[0], range[1], count, gray.data());
    for (std::size_t i = 0; i < 3 * gray.size(); ++i)
    {
      colors[i] = gray[i / 3];
    }
  }
}

void blendInto(float* values, const float* plain, std::size_t count, float share)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    const float value = plain[i] + share * (values[i] - plain[i]);
    values[i] = std::isfinite(value) ? std::min(std::max(value, 0.0f), 1.0f) : 0.0f;
  }
}
}

//------------------------------------------------------------------------------
// That of the volume's own table, and as far as the labels' functions reach beyond it, in its
// steps.
void vtkChiLabelInput::ChooseRange(vtkVolumeProperty* property, const chi_transfer_view& plain)
{
  const double step = (plain.range[1] - plain.range[0]) / static_cast<double>(plain.count - 1);
  double low = plain.range[0];
  double high = plain.range[1];
  for (int label : this->Labels)
  {
    double nodes[2];
    // one step more where a function ends: beyond its nodes it is 0 unless it clamps
    vtkPiecewiseFunction* opacity = opacityOf(property, label);
    opacity->GetRange(nodes);
    low = std::min(low, nodes[0] - (opacity->GetClamping() ? 0.0 : step));
    high = std::max(high, nodes[1] + (opacity->GetClamping() ? 0.0 : step));
    if (vtkColorTransferFunction* color = colorOf(property, label))
    {
      color->GetRange(nodes);
      low = std::min(low, nodes[0] - (color->GetClamping() ? 0.0 : step));
      high = std::max(high, nodes[1] + (color->GetClamping() ? 0.0 : step));
    }
  }
  const double before = std::ceil((plain.range[0] - low) / step);
  const double after = std::ceil((high - plain.range[1]) / step);
  const double most =
    std::min(65536.0, std::floor(maxEntries / static_cast<double>(this->Labels.size() + 1)));
  const double count = static_cast<double>(plain.count) + before + after;
  this->Transfer.range[0] = plain.range[0] - before * step;
  this->Transfer.range[1] = plain.range[1] + after * step;
  this->Transfer.count = static_cast<std::size_t>(std::min(count, most));
}

//------------------------------------------------------------------------------
bool vtkChiLabelInput::Collect(
  vtkVolumeProperty* property, const chi_transfer_view& plain, double blend)
{
  this->Limits.clear();
  this->Labels.clear();
  for (int label : property->GetLabelMapLabels())
  {
    if (label > 0 && label <= maxLabel && this->Labels.size() + 1 < maxTables)
    {
      this->Labels.push_back(label);
    }
    else if (label != 0)
    {
      this->Limits.assign(1,
        "labels other than 1 ... " + std::to_string(maxLabel) + ", or more than " +
          std::to_string(maxTables - 1) +
          ", are not supported: they are drawn with the volume's own functions");
    }
  }
  if (property->HasLabelGradientOpacity())
  {
    this->Limits.emplace_back("gradient opacity of labels (vtkVolumeProperty) is not supported: "
                              "the volume's own is used");
  }
  if (this->Labels.empty() || !(blend > 0.0))
  {
    return false;
  }

  std::vector<std::uint64_t> key = { plain.version, 0 };
  std::memcpy(&key[1], &blend, sizeof(blend));
  for (int label : this->Labels)
  {
    vtkColorTransferFunction* color = colorOf(property, label);
    key.push_back(static_cast<std::uint64_t>(label));
    key.push_back(color ? color->GetMTime() : 0);
    key.push_back(opacityOf(property, label)->GetMTime());
  }
  key.push_back(property->GetMTime());
  if (key == this->Key)
  {
    return true;
  }
  this->Key = key;

  const std::uint64_t version = this->Transfer.version + 1;
  this->Transfer = plain; // what does not depend on the label stays
  this->Transfer.version = version;
  this->ChooseRange(property, plain);
  const std::size_t tables = this->Labels.size() + 1;
  const std::size_t count = this->Transfer.count;
  this->Colors.resize(3 * count * tables);
  this->Opacities.resize(count * tables);
  this->TableOfValue.assign(static_cast<std::size_t>(this->Labels.back()) + 1, 0);
  for (std::size_t table = 0; table < tables; ++table)
  {
    const int label = table ? this->Labels[table - 1] : 0;
    float* colors = this->Colors.data() + 3 * count * table;
    float* opacities = this->Opacities.data() + count * table;
    tabulate(property, label, this->Transfer.range, static_cast<int>(count), colors, opacities);
    const float share = table ? static_cast<float>(blend) : 1.0f;
    blendInto(colors, this->Colors.data(), 3 * count, share);
    blendInto(opacities, this->Opacities.data(), count, share);
    this->TableOfValue[static_cast<std::size_t>(label)] = static_cast<std::uint8_t>(table);
  }
  this->Transfer.rgb = this->Colors.data();
  this->Transfer.opacity = this->Opacities.data();
  this->Transfer.table_count = tables;
  return true;
}
