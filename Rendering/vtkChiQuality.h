// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiQuality_h
#define vtkChiQuality_h

// How well a frame may be drawn in the time that it is given, from what the frames before took.
class vtkChiQuality
{
public:
  struct Settings
  {
    int Directions = 16;     // of light
    int ImageReduction = 1;  // pixels of the picture a pixel drawn, in both directions
    double Coarsening = 1.0; // of the distance between slices
  };

  // What to draw with: `full`, or as much less as fits. `seconds` is what the frame may take.
  Settings Choose(const Settings& full, double seconds);
  // What the frame took that has been chosen last: the engine's share, and all of it.
  void Report(double engineSeconds, double totalSeconds);

private:
  static Settings GetLevel(const Settings& full, int level);
  static double GetCost(const Settings& full, const Settings& settings);

  int Level = 0;
  double Cost = 1.0;      // of the last choice, of a full frame's
  double FullTime = -1.0; // seconds of the engine for a full frame; negative: not known yet
  double OtherTime = 0.0; // seconds of everything else
};

#endif
