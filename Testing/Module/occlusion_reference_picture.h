/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_REFERENCE_PICTURE_H
#define CHI_OCCLUSION_REFERENCE_PICTURE_H

/* The exact final picture, and real geometry in it. */

#include "occlusion_reference.h"

/*
 * The pixel (x, y) of the final picture of white matter over black, as the engine defines it: the
 * sum of transmittance x alpha x V along its ray, V read bias[0] nearer to the eye, and of the
 * white surface behind, with bias[1]. The step of the sum is 1/16 voxel along the depth axis, V is
 * linear over pieces of 1/2 voxel. Where the surface has a test for what it contains, V is what
 * that leaves.
 */
double reference_pixel(const reference_volume* volume, const reference_surface* surface,
  const reference_view* view, const reference_rays* rays, const double bias[2], const int pixel[2]);

typedef struct reference_tubes reference_tubes;

/* Chains of capsules of one radius, all in index space, from a file of float x y z, NaN after each
 * chain; NULL when memory or the file is missing. */
reference_tubes* reference_tubes_read(const char* file, double radius);
/* From `count` points in memory. */
reference_tubes* reference_tubes_create(const float* points, size_t count, double radius);
void reference_tubes_free(reference_tubes* tubes);
/* For reference_surface.contains. */
int reference_tubes_contain(const void* tubes, const double at[3]);
/* Depths of the nearest hits of a parallel view's pixels; INFINITY where there is none. */
void reference_tubes_depth(const reference_tubes* tubes, const reference_view* view, float* depth);

#endif
