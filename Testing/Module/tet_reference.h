/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_REFERENCE_H
#define CHI_TET_REFERENCE_H

/*
 * The exact slow path by which projected tetrahedra are judged. For each pixel's ray every
 * tetrahedron's entry and exit follow from its plane equations in double; they are sorted along the
 * ray and the volume rendering integral of each is found by quadrature. It shares no code with the
 * engines.
 */

#include "segment_reference.h"

#include <chiaroscuro/chi_camera.h>
#include <chiaroscuro/chi_preintegration.h>

/** What is drawn, borrowed. Points are in the world. */
typedef struct tet_reference_scene
{
  const chi_camera* camera;
  const double (*points)[3];
  const uint32_t (*vertices)[4];
  size_t count;         /**< tetrahedra */
  const float* scalars; /**< of points, or of tetrahedra */
  int is_cell_data;
  /** Colour and extinction: of tables made by chi_preintegration_update, of which color, count and
   * range are read; or, where that is NULL, any function of the scalar. */
  const chi_segment_tables* tables;
  segment_classify classify;
  const void* classify_data;
  /** Direct colours of points, or of tetrahedra, in place of those of the tables; or NULL. */
  const float (*colors)[3];
} tet_reference_scene;

/** A tetrahedron on a ray. */
typedef struct tet_reference_fragment
{
  uint32_t tetrahedron;
  double entry, exit; /**< depths along the view axis */
  double length;      /**< between them, world units */
  double scalar[2];   /**< at entry and exit */
  double color[2][3]; /**< direct ones, likewise */
} tet_reference_fragment;

/**
 * The tetrahedra on a ray, nearest first, which is moved by 1e-8 pixels so as to lie in no face;
 * `x`, `y` in pixels, the centre of pixel i being i + 0.5. The list is the caller's to free.
 */
tet_reference_fragment* tet_reference_list(
  const tet_reference_scene* scene, double x, double y, size_t* count);

/** Premultiplied colour and opacity of a sorted list, to 1e-7. */
void tet_reference_integrate(const tet_reference_scene* scene, const tet_reference_fragment* list,
  size_t count, double rgba[4]);

/** [height x width x 4] premultiplied colour and opacity of every pixel, row 0 lowest; fragments of
 * every pixel in `counts` [height x width], or NULL. */
void tet_reference_render(const tet_reference_scene* scene, double* rgba, uint32_t* counts);

/** Length of the ray within one tetrahedron, behind the near plane, from the coordinates as they
 * are stored; 0 where the ray misses it or it has no volume. Long double throughout. */
long double tet_reference_thickness(
  const chi_camera* camera, const double points[4][3], double x, double y);

/** How much of the ray lies within the cube [-1, 1]^3, behind the near plane. */
double tet_reference_cube_length(const chi_camera* camera, double x, double y);

#endif
