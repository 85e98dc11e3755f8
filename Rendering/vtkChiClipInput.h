// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiClipInput_h
#define vtkChiClipInput_h

#include <string>
#include <vector>

class vtkAbstractVolumeMapper;
class vtkVolume;

// The clipping planes of a mapper, and the cropping box of one that has it, for the C core.
class vtkChiClipInput
{
public:
  // Returns false where a plane cannot be used: GetProblem(). `world` is the row-major matrix from
  // world space to the space that the core calls world.
  bool Collect(vtkAbstractVolumeMapper* mapper, vtkVolume* volume, const double* world);

  // [planes x 4]: a x + b y + c z + d >= 0 stays.
  const std::vector<double>& GetPlanes() const { return this->Planes; }
  const std::string& GetProblem() const { return this->Problem; }
  // Empty, or what was left out.
  const std::string& GetLimit() const { return this->Limit; }

  // A plane a x + b y + c z + d >= 0 of the space that `toWorld` carries to world space (null:
  // world space itself), in the space that the core calls world, which `world` carries world space
  // to.
  static void PlacePlane(
    const double plane[4], const double* toWorld, const double* world, double placed[4]);

private:
  void Add(const double plane[4], const double* toWorld, const double* world);

  std::vector<double> Planes;
  std::string Problem;
  std::string Limit;
};

#endif
