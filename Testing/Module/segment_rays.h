/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SEGMENT_RAYS_H
#define CHI_SEGMENT_RAYS_H

/* Transfer functions from smooth to wild, and what is left of a whole ray's colour when its
 * segments come from tables: for the test and the benchmark of pre-integration. */

#include "segment_reference.h"

#include <chiaroscuro/chi_preintegration.h>

#include <stdlib.h>

enum
{
  SMOOTH, /* colour and opacity of second degree */
  PEAK,   /* a Gaussian whose sigma is 1/200 of the range */
  BOXES,  /* two, 1/50 and 1/200 of the range wide */
  STEP,
  RANDOM /* every entry */
};

__attribute__((unused)) static const char* const kind_name[] = { "smooth", "peak", "boxes", "step",
  "random" };

/* The next number in [0, 1), as of chi_test.h. */
static double next_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)*state * 0x1p-32;
}

__attribute__((unused)) static void fill_transfer(
  int kind, size_t count, float (*rgb)[3], float* opacity)
{
  uint32_t seed = 9;
  for (size_t i = 0; i < count; ++i)
  {
    const double s = (double)i / (double)(count - 1);
    const int noise = kind == RANDOM;
    rgb[i][0] = (float)(noise ? next_random(&seed) : s);
    rgb[i][1] = (float)(noise ? next_random(&seed) : 4 * s * (1 - s));
    rgb[i][2] = (float)(noise ? next_random(&seed) : 1 - s);
    opacity[i] = (float)(noise ? next_random(&seed)
        : kind == SMOOTH       ? 0.2 * s * s
        : kind == PEAK         ? exp(-0.5 * pow(200 * (s - 0.5), 2))
        : kind == BOXES        ? (s > 0.3 && s < 0.32) || (s > 0.6 && s < 0.605)
                               : s > 0.5);
  }
}

/* Rays along which the scalar is linear, cut at random: what the three methods make of them, as
 * parts of 255: mean and largest of the whole rays. */
__attribute__((unused)) static void measure_rays(
  const chi_segment_tables* tables, double cell, double error[2])
{
  const segment_entries e = { tables->color, tables->count };
  const double end = tables->count - 1;
  uint32_t seed = 11;
  error[0] = error[1] = 0;
  const int rays = 100;
  for (int r = 0; r < rays; ++r)
  {
    const double low = 0.2 * next_random(&seed), high = 1 - 0.2 * next_random(&seed);
    const double from = r & 1 ? high : low, to = r & 1 ? low : high;
    const double length = 16 * cell * (1 + 0.7 * next_random(&seed));
    double expected[4] = { 0, 0, 0, 0 };
    float sum[4] = { 0, 0, 0, 1 };
    for (double at = 0; at < 1;)
    {
      const double step = fmin(1 - at, (0.02 + next_random(&seed)) * cell / length);
      const float x0 = (float)((from + (to - from) * at) * end);
      const float x1 = (float)((from + (to - from) * (at + step)) * end);
      const float l = (float)(step * length);
      float rgba[4];
      if (chi_segment_evaluate(tables, 1, &x0, &x1, &l, rgba) != CHI_OK)
      {
        exit(1);
      }
      segment_add(&e, (double)x0, (double)x1, (double)l, expected);
      for (int c = 0; c < 3; ++c)
      {
        sum[c] += sum[3] * rgba[c];
      }
      sum[3] *= 1 - rgba[3];
      at += step;
    }
    for (int c = 0; c < 3; ++c)
    {
      const double off = 255 * fabs((double)sum[c] - expected[c]);
      error[0] += off / (3 * rays);
      error[1] = fmax(error[1], off);
    }
  }
}

#endif
