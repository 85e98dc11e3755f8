/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_OCCLUSION_H
#define CHI_TET_OCCLUSION_H

/* Occlusion of tetrahedra: in place of the pixels of a whole tile, slab after slab of all tiles,
 * with the light planes of chi_light_planes.h in between. */

#include "chi_light_planes.h"
#include "chi_tet_internal.h"

/* The tetrahedra of every tile and slab, in the order of the tile's list. */
typedef struct chi_tet_slabs
{
  double start, slab; /* depth of the first border; from border to border */
  double margin;      /* slabs that rounding may move a tetrahedron by */
  int32_t count;      /* 0: there is nothing to draw */
  chi_buffer depths;  /* double [tiles][2] */
  chi_buffer starts;  /* size_t [tiles + 1] of a tile in the list */
  chi_buffer before;  /* uint32 [tiles][count + 1] of a slab in the tile's part */
  chi_buffer list;    /* uint32 */
} chi_tet_slabs;

chi_status chi_tet_slabs_build(const chi_exec* exec, chi_tet_slabs* slabs, const chi_tet_bins* bins,
  const chi_tet_scene* scene, int32_t count);
void chi_tet_slabs_free(const chi_exec* exec, chi_tet_slabs* slabs);

static inline double chi_tet_slabs_border(const chi_tet_slabs* slabs, int32_t k)
{
  return slabs->start + k * slabs->slab;
}

/* What is kept from frame to frame. */
struct chi_tet_occlusion
{
  chi_tet_slabs slabs;
  chi_scene scene;
  chi_light_buffers light;
  chi_buffer tau;      /* float [2][rows][stride] */
  chi_buffer seen;     /* float [3][rows][stride] what light leaves at light planes */
  chi_buffer surfaces; /* float [rows][GEOMETRY_PLANES][stride] */
  chi_buffer tiles;    /* of each tile; chi_tet_occlusion.c */
  chi_buffer need;     /* uint8 [tile rows][segments] */
};

#endif
