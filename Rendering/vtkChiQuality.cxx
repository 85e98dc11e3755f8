// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkChiQuality.h"

#include <algorithm>

namespace
{
// From full to least; each costs half to a third of the one before.
struct Step
{
  int Directions; // at most
  int ImageReduction;
  double Coarsening;
};
const Step ladder[] = { { 64, 1, 1.0 }, { 8, 1, 1.0 }, { 8, 1, 2.0 }, { 8, 2, 1.0 }, { 8, 2, 2.0 },
  { 8, 3, 2.0 }, { 8, 4, 2.0 } };
const int levels = static_cast<int>(sizeof(ladder) / sizeof(ladder[0]));
}

//------------------------------------------------------------------------------
vtkChiQuality::Settings vtkChiQuality::GetLevel(const Settings& full, int level)
{
  Settings settings;
  settings.Directions = std::min(full.Directions, ladder[level].Directions);
  settings.ImageReduction = std::max(full.ImageReduction, ladder[level].ImageReduction);
  settings.Coarsening = full.Coarsening * ladder[level].Coarsening;
  return settings;
}

//------------------------------------------------------------------------------
// Of the time of a full frame, in the core's measured proportion: at 16 directions light takes a
// third (theory/occlusion.md, Speed).
double vtkChiQuality::GetCost(const Settings& full, const Settings& settings)
{
  const auto cost = [](const Settings& s)
  {
    return (2.0 + s.Directions / 16.0) / 3.0 / (s.ImageReduction * s.ImageReduction) / s.Coarsening;
  };
  return cost(settings) / cost(full);
}

//------------------------------------------------------------------------------
vtkChiQuality::Settings vtkChiQuality::Choose(const Settings& full, double seconds)
{
  int level = levels - 1; // before anything is known, an interactive frame must not take long
  const double left = seconds - this->OtherTime;
  for (int i = 0; i < levels && this->FullTime >= 0.0; ++i)
  {
    // a better level than the last must fit with room to spare, or two would take turns
    const double room = i < this->Level ? 0.7 : 1.0;
    if (this->FullTime * GetCost(full, GetLevel(full, i)) <= room * left)
    {
      level = i;
      break;
    }
  }
  this->Level = level;
  const Settings settings = GetLevel(full, level);
  this->Cost = GetCost(full, settings);
  return settings;
}

//------------------------------------------------------------------------------
void vtkChiQuality::Report(double engineSeconds, double totalSeconds)
{
  // the last frame counts as much as all before: scenes change, and machines stutter
  const double time = engineSeconds / this->Cost;
  this->FullTime = this->FullTime < 0.0 ? time : 0.5 * (this->FullTime + time);
  this->OtherTime = std::max(totalSeconds - engineSeconds, 0.0);
}
