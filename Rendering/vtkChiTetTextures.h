// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkChiTetTextures_h
#define vtkChiTetTextures_h

#include <chiaroscuro/chi_tet.h>

#include "vtkNew.h"
#include "vtkTextureObject.h"

#include <cstdint>

class vtkOpenGLRenderWindow;
class vtkWindow;

// What the core's plan of tetrahedra hands to the OpenGL engine, as textures: each list in rows of
// TABLE_WIDTH texels. Each is uploaded when its version changes, and stays until it is released.
class vtkChiTetTextures
{
public:
  // False where OpenGL refuses one of them.
  bool Update(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  void ReleaseGraphicsResources(vtkWindow* window);

  // World units a unit of the points: a power of two, so that floats neither run over nor round.
  static double UnitOf(const chi_tet_plan& plan);

  vtkTextureObject* GetSequence() { return this->Sequence; }
  vtkTextureObject* GetVertices() { return this->Vertices; }
  // Three texels a point. x, y, depth in the eye's space, each the sum of the first three values of
  // the first and of the second texel, the larger one first; the fourth ones are the scalar and
  // what opacity is looked up at. The third: whole pixels and, not negative, the rest; a point that
  // lies before the near plane has a rest of -1.
  vtkTextureObject* GetPoints() { return this->Points; }
  vtkTextureObject* GetScalars() { return this->Scalars; } // of cells
  vtkTextureObject* GetOpacities() { return this->Opacities; }
  vtkTextureObject* GetCells() { return this->Cells; }
  vtkTextureObject* GetShades() { return this->Shades; } // three texels of two a tetrahedron
  vtkTextureObject* GetColors() { return this->Colors; }
  vtkTextureObject* GetPsi() { return this->Psi; } // a row a row
  vtkTextureObject* GetDepths() { return this->Depths; }
  vtkTextureObject* GetFull() { return this->Full; }
  vtkTextureObject* GetDirect() { return this->Direct; } // given colours of points, or of cells
  vtkTextureObject* GetPlane() { return this->Plane; }   // a table of two quantities, row after row
  vtkTextureObject* GetSeconds() { return this->Seconds; } // one a tetrahedron
  vtkTextureObject* GetSurface() { return this->Surface; }

private:
  bool UpdateMesh(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdateValues(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdatePoints(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdateDirect(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdatePlane(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdateTables(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool UpdateSurface(vtkOpenGLRenderWindow* window, const chi_tet_plan& plan);
  bool IsCurrent(vtkOpenGLRenderWindow* window, vtkTextureObject* texture, std::uint64_t& has,
    std::uint64_t version);

  vtkNew<vtkTextureObject> Sequence;
  vtkNew<vtkTextureObject> Vertices;
  vtkNew<vtkTextureObject> Points;
  vtkNew<vtkTextureObject> Scalars;
  vtkNew<vtkTextureObject> Opacities;
  vtkNew<vtkTextureObject> Cells;
  vtkNew<vtkTextureObject> Shades;
  vtkNew<vtkTextureObject> Colors;
  vtkNew<vtkTextureObject> Psi;
  vtkNew<vtkTextureObject> Depths;
  vtkNew<vtkTextureObject> Full;
  vtkNew<vtkTextureObject> Direct;
  vtkNew<vtkTextureObject> Plane;
  vtkNew<vtkTextureObject> Seconds;
  vtkNew<vtkTextureObject> Surface;
  std::uint64_t SequenceVersion = 0;
  std::uint64_t VerticesVersion = 0;
  std::uint64_t PointsVersion = 0;
  std::uint64_t ScalarsVersion = 0;
  std::uint64_t TablesVersion = 0;
  std::uint64_t DirectVersion = 0;
  std::uint64_t PlaneVersion = 0;
  std::uint64_t SecondsVersion = 0;
};

#endif
