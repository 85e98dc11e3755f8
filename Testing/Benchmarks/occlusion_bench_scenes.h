/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_BENCH_SCENES_H
#define CHI_OCCLUSION_BENCH_SCENES_H

/* Marschner-Lobb, its transfer functions, and a camera that moves. */

#include "occlusion_reference.h"

#include <math.h>
#include <stdlib.h>

/* Marschner & Lobb 1994 on [-1, 1]^3, alpha 0.25, f_M 6, as 8 bits. */
static inline uint8_t* bench_marschner_lobb(int size)
{
  const double pi = 3.14159265358979324, step = 2.0 / (size - 1);
  const size_t n = (size_t)size;
  uint8_t* const out = malloc(n * n * n);
  double* const ripple = malloc(n * n * sizeof *ripple);
  for (size_t i = 0; ripple && i < n * n; ++i)
  {
    const double x = (double)(i % n) * step - 1, y = (double)(i / n) * step - 1;
    ripple[i] = 0.25 * (1 + cos(2 * pi * 6 * cos(0.5 * pi * sqrt(x * x + y * y))));
  }
  for (size_t k = 0; out && ripple && k < n; ++k)
  {
    const double ramp = 1 - sin(0.5 * pi * ((double)k * step - 1));
    for (size_t i = 0; i < n * n; ++i)
    {
      out[k * n * n + i] = (uint8_t)(255 * (ramp + ripple[i]) / (2 * 1.25) + 0.5);
    }
  }
  free(ripple);
  return out;
}

typedef enum bench_matter
{
  BENCH_FOG,    /* thin everywhere */
  BENCH_SHELLS, /* three thin shells */
  BENCH_DENSE,  /* opaque where bright: all in front is empty, nothing behind is seen */
  BENCH_SKIN,   /* one thin opaque shell */
  BENCH_VESSELS /* the crests of the ripples alone */
} bench_matter;

/* Opacity a voxel over 256 entries. */
static inline void bench_transfer(reference_frame* f, bench_matter matter)
{
  f->transfer.count = 256;
  f->transfer.range[0] = 0;
  f->transfer.range[1] = 255;
  f->transfer.unit_distance = 1;
  ++f->transfer.version;
  for (int i = 0; i < 256; ++i)
  {
    const int in_shell = abs(i - 90) <= 2 || abs(i - 128) <= 2 || abs(i - 166) <= 2;
    float opacity = 0;
    switch (matter)
    {
      case BENCH_FOG:
        opacity = 0.002f + 0.01f * (float)i / 255;
        break;
      case BENCH_SHELLS:
        opacity = in_shell ? 0.4f : 0;
        break;
      case BENCH_DENSE:
        opacity = i > 100 ? 0.8f : 0;
        break;
      case BENCH_SKIN:
        opacity = abs(i - 128) <= 6 ? 0.8f : 0;
        break;
      case BENCH_VESSELS:
        opacity = i >= 247 ? 0.5f : 0;
        break;
    }
    f->opacity[i] = opacity;
    f->rgb[3 * i] = (float)i / 255;
    f->rgb[3 * i + 1] = 0.6f;
    f->rgb[3 * i + 2] = 1 - (float)i / 255;
  }
}

/* ResetCamera, Azimuth 30, Elevation 20, Zoom 1.4, then one degree a frame. */
static inline reference_view bench_moving_view(int frame, int size, int pixels)
{
  const double degree = 0.017453292519943295, side = size - 1;
  const double center[3] = { 0.5 * side, 0.5 * side, 0.5 * side };
  const double turn[2] = { 30.0 + frame, 20 };
  const double radius = 0.5 * sqrt(3.0) * side, distance = radius / sin(15 * degree);
  reference_view view =
    reference_turned_view(center, distance, turn, 2 * distance * tan(15 / 1.4 * degree), pixels, 0);
  view.camera.near_depth = distance - radius;
  return view;
}

/* A frame of such a volume with the default parameters, one slice a voxel. */
static inline void bench_frame(
  reference_frame* f, const uint8_t* scalars, int size, int pixels, bench_matter matter)
{
  const reference_view view = bench_moving_view(0, size, pixels);
  const size_t n = (size_t)size;
  reference_frame_init(f, NULL, &view, 1);
  bench_transfer(f, matter);
  f->volume = (chi_volume_view){ .struct_size = sizeof f->volume,
    .scalars = scalars,
    .type = CHI_U8,
    .stride = 1,
    .dimensions = { n, n, n },
    .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  f->frame.volume = &f->volume;
  f->frame.transfer = &f->transfer;
  f->params.bias = -1;
  f->params.sample_distance = 1;
}

#endif
