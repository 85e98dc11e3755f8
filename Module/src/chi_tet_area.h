/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_AREA_H
#define CHI_TET_AREA_H

/* What of a tetrahedron the rays through all of a pixel's area meet. */

#include "chi_tet_fan.h"

/* An end of a triangle's rays at a corner: what is linear on the screen. */
typedef struct chi_tet_area_end
{
  double w;                         /* 1 / depth; the depth in parallel projection */
  double value[CHI_TET_QUANTITIES]; /* times w; as they are in parallel projection */
} chi_tet_area_end;

typedef struct chi_tet_area
{
  const chi_tet_scene* scene;
  uint32_t tetrahedron;
  chi_tet_fan fan;
  chi_tet_area_end corner[4], thick[2];
  double edge[4][3][3]; /* of each triangle: a x + b y + c >= 0 inside, in units of |a| + |b| */
  double size[4];       /* twice their areas */
  int32_t quantities;   /* values that there are */
  int32_t is_deep;      /* depths of its vertices are not alike */
} chi_tet_area;

enum
{
  CHI_TET_AREA_RAYS = 4 * 5 * 7 /* triangles, parts of one cut by a pixel, places in a part */
};

/* A ray for all those around it. */
typedef struct chi_tet_area_ray
{
  double share; /* of the pixel, of all of them */
  double length;
  double value[CHI_TET_QUANTITIES][2]; /* where it enters and leaves */
} chi_tet_area_ray;

/* Of a tetrahedron behind the near plane. */
void chi_tet_area_begin(chi_tet_area* area, const chi_tet_scene* scene, uint32_t tetrahedron);

/* The rays of a pixel of the window that meet it; returns how many. */
int chi_tet_area_of_pixel(
  const chi_tet_area* area, int32_t x, int32_t y, chi_tet_area_ray rays[CHI_TET_AREA_RAYS]);

/* Which of 8 x 8 places in the pixel it covers, bits along x first; one at least. */
uint64_t chi_tet_area_cover(const chi_tet_area* area, int32_t x, int32_t y);

#endif
