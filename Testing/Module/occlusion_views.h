/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_VIEWS_H
#define CHI_OCCLUSION_VIEWS_H

/* The views that the scenes of tests are made of: an eye at the origin that looks along -z, a cube
 * ahead of it, tables over its scalars. */

#include <chiaroscuro/chi_occlusion.h>

#include <math.h>

/* `half`: of the window's height, world units, or, in perspective, at depth 1. Pixels are square.
 */
static inline chi_camera eye_at_origin(int parallel, int width, int height, double half)
{
  const double wide = half * width / height;
  return (chi_camera){ .struct_size = sizeof(chi_camera),
    .world_to_eye = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 },
    .window = { -wide, wide, -half, half },
    .parallel = parallel,
    .width = width,
    .height = height,
    .near_depth = 1 };
}

/* n^3 samples, one unit apart, centred at a depth on the eye's axis. */
static inline chi_volume_view cube_at(const void* samples, chi_type type, size_t n, double depth)
{
  const double low = -0.5 * ((double)n - 1);
  return (chi_volume_view){ .struct_size = sizeof(chi_volume_view),
    .scalars = samples,
    .type = type,
    .stride = chi_type_size(type),
    .dimensions = { n, n, n },
    .index_to_world = { 1, 0, 0, low, 0, 1, 0, low, 0, 0, 1, low - depth, 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
}

/* Opacity of a unit. */
static inline chi_transfer_view tables(
  const float* rgb, const float* opacity, size_t count, double low, double high)
{
  return (chi_transfer_view){ .struct_size = sizeof(chi_transfer_view),
    .rgb = rgb,
    .opacity = opacity,
    .count = count,
    .range = { low, high },
    .unit_distance = 1,
    .version = 1 };
}

/* A surface of the first version. */
static inline chi_surface_view surface_of(const float* depth)
{
  return (
    chi_surface_view){ .struct_size = sizeof(chi_surface_view), .depth = depth, .version = 1 };
}

/* Layers of the first version, [count][height][width]. */
static inline chi_layers_view layers_of(const float* depth, const float* rgba, int32_t count)
{
  return (chi_layers_view){ .struct_size = sizeof(chi_layers_view),
    .depth = depth,
    .rgba = rgba,
    .version = 1,
    .count = count };
}

/* Largest difference of two pictures of one size, colours and surface visibilities. */
static inline double difference(const chi_occlusion_image* a, const chi_occlusion_image* b)
{
  double worst = 0;
  const size_t pixels = (size_t)a->width * (size_t)a->height;
  for (size_t i = 0; i < 4 * pixels; ++i)
  {
    worst = fmax(worst, fabs((double)a->rgba[i] - (double)b->rgba[i]));
  }
  for (size_t i = 0; i < pixels; ++i)
  {
    worst = fmax(worst, fabs((double)a->visibility[i] - (double)b->visibility[i]));
  }
  return worst;
}

#endif
