/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_SCENES_H
#define CHI_TET_SCENES_H

/* Meshes of tetrahedra, views and transfer functions that tests and benchmarks of projected
 * tetrahedra share. All meshes fill the cube [-1, 1]^3. */

#include <chiaroscuro/chi_camera.h>
#include <chiaroscuro/chi_grid.h>
#include <chiaroscuro/chi_transfer.h>

/** A mesh with a scalar a point. */
typedef struct tet_mesh
{
  double (*points)[3];
  float* scalars;
  size_t point_count;
  uint32_t (*vertices)[4];
  size_t count;
  /* The same tetrahedra, as an unstructured grid has them. */
  int64_t *offsets, *connectivity;
  uint8_t* types;
} tet_mesh;

enum
{
  TET_CONSTANT,       /**< 1/2 */
  TET_MARSCHNER_LOBB, /**< the test signal of Marschner & Lobb 1994, f_M 6, alpha 1/4 */
  TET_RAMP,           /**< linear from 0 to 1 along x */
  TET_OBLIQUE_RAMP    /**< linear from 0 to 1 along the diagonal */
};

/** n^3 cubes of 6 tetrahedra each (Kuhn's split, that of chi_grid for images). */
tet_mesh* tet_mesh_cubes(size_t n, int field);
/** One tetrahedron, of scalars 0, 1, 2, 3. */
tet_mesh* tet_mesh_single(const double points[4][3]);
void tet_mesh_free(tet_mesh* mesh);

/** The mesh as an unstructured grid. */
chi_grid_view tet_mesh_grid(const tet_mesh* mesh);
/** The mesh of cubes as the image that it is the split of. */
chi_grid_view tet_image_grid(size_t n);

enum
{
  TET_VIEW_AXIS,    /**< along z */
  TET_VIEW_OBLIQUE, /**< of the whole cube, from aside and above */
  TET_VIEW_CLOSE,   /**< cells cross the window's edge, and in perspective the near plane */
  TET_VIEW_INSIDE,  /**< the eye is within the cube; perspective alone */
  TET_VIEW_SIGNAL,  /**< that of the accuracy scene with the test signal */
  TET_VIEWS
};

/** A square window of so many pixels. */
chi_camera tet_view(int view, int parallel, int size);
/** An eye at a distance from the origin, which it looks at: turned by the azimuth about y and
 * raised by the elevation, degrees. `half` is half the window's height: world units, or, in
 * perspective, at depth 1. */
chi_camera tet_look(
  double distance, double azimuth, double elevation, int parallel, int size, double half);

enum
{
  TET_TABLE = 1024
};

/** A transfer function over 0 ... 1. */
typedef struct tet_transfer
{
  float rgb[TET_TABLE][3], opacity[TET_TABLE];
  chi_transfer_view view; /* of these arrays; do not copy the struct */
} tet_transfer;

/** White, of one extinction a world unit, 0 ... 1. */
void tet_transfer_constant(tet_transfer* transfer, double extinction);
/** From blue to red, of an extinction of the scalar times so much. */
void tet_transfer_linear(tet_transfer* transfer, double extinction);
/** The test signal's: blue to green, then green to red, each times as opaque as the first. */
void tet_transfer_signal(tet_transfer* transfer, double times);
/** A Gaussian about the middle: sigma is a share of the range; colours run from blue to red. */
void tet_transfer_peak(tet_transfer* transfer, double sigma, double extinction);

#endif
