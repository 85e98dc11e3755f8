/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_FAN_H
#define CHI_TET_FAN_H

/*
 * A tetrahedron on the screen as Shirley & Tuchman (1990) split it: its silhouette, a triangle or a
 * quadrilateral, as triangles about the point over which the tetrahedron is thickest. Over each of
 * them the ray enters through one face and leaves through another.
 */

#include "simd/chi_tet_kernels.h"

/* A corner of the silhouette, where the ray touches a vertex of the tetrahedron. */
typedef struct chi_tet_corner
{
  double x, y; /* pixels; centres are integers */
  double depth;
  double value[CHI_TET_QUANTITIES]; /* those that the scene has, else 0 */
} chi_tet_corner;

typedef struct chi_tet_fan
{
  int32_t count;            /* of corners: 3 or 4; 0: it has no area */
  chi_tet_corner corner[4]; /* counter-clockwise */
  chi_tet_corner thick[2];  /* where the ray enters and leaves at the thick point */
} chi_tet_fan;

/* 0: a vertex lies in front of the near plane, so that there is no such picture of it. */
int chi_tet_fan_make(const chi_tet_scene* scene, uint32_t tetrahedron, chi_tet_fan* fan);

/* Whether a clip plane or the surface of a pixel of the box, pixels of the window, cuts it. */
int chi_tet_fan_is_cut(
  const chi_tet_scene* scene, uint32_t tetrahedron, const int32_t low[2], const int32_t high[2]);

/* How much longer than its depth a ray is at a place of the window, pixels. */
double chi_tet_slant(const chi_tet_scene* scene, double x, double y);

#endif
