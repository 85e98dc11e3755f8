/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OCCLUSION_RAMP_H
#define OCCLUSION_RAMP_H

/*
 * A volume whose scalar is linear in space, so that a ray's scalar is known everywhere and what the
 * eye sees is an integral over the transfer function alone: the test of its integration. Shared by
 * test and bench.
 */

#include "occlusion_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  RAMP_PICTURE = 48 /* pixels a side */
};

/* Scalar 0 at the front, 1 at the back, seen along z. It rises a little to the side too, so that
 * slices meet every phase of the transfer function. */
typedef struct ramp_scene
{
  int depth; /* voxels from 0 to 1 */
  float* scalars;
  reference_frame* f;
} ramp_scene;

/* Per voxel, of the side; x and y span a voxel's rise over the picture. */
static const double ramp_side[2] = { 0.0213, 0.0031 };

static inline double ramp_scalar(const ramp_scene* r, const double at[3])
{
  return (at[2] + ramp_side[0] * at[0] + ramp_side[1] * at[1]) / r->depth;
}

/* Deeper by three voxels than the ramp, so that its end lies inside everywhere. */
static inline int ramp_create(ramp_scene* r, int depth, double angle_deg)
{
  const size_t side = RAMP_PICTURE + 2, n[3] = { side, side, (size_t)depth + 3 };
  r->depth = depth;
  r->scalars = (float*)malloc(n[0] * n[1] * n[2] * sizeof(float));
  r->f = (reference_frame*)malloc(sizeof *r->f);
  if (!r->scalars || !r->f)
  {
    return 0;
  }
  for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i)
  {
    const double at[3] = { (double)(i % n[0]), (double)(i / n[0] % n[1]),
      (double)(i / (n[0] * n[1])) };
    r->scalars[i] = (float)ramp_scalar(r, at);
  }
  const double center[3] = { 0.5 * (double)(side - 1), 0.5 * (double)(side - 1), 0.5 * depth };
  const double turn[2] = { angle_deg, 0.4 * angle_deg };
  const reference_view view =
    reference_turned_view(center, 4.0 * depth, turn, RAMP_PICTURE - 8, RAMP_PICTURE, 1);
  reference_frame_init(r->f, NULL, &view, 1);
  r->f->volume = (chi_volume_view){ .struct_size = sizeof r->f->volume,
    .scalars = r->scalars,
    .type = CHI_F32,
    .stride = sizeof(float),
    .dimensions = { n[0], n[1], n[2] },
    .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  r->f->frame.volume = &r->f->volume;
  r->f->frame.transfer = &r->f->transfer;
  r->f->transfer.unit_distance = 1;
  r->f->params.strength = 0;
  r->f->params.sample_distance = 1;
  return 1;
}

static inline void ramp_free(ramp_scene* r)
{
  free(r->scalars);
  free(r->f);
}

/* Extinction a voxel, and colour, of one entry of the transfer function. */
static inline void ramp_entry(reference_frame* f, int i, double extinction, const double rgb[3])
{
  f->opacity[i] = (float)-expm1(-extinction);
  for (int c = 0; c < 3; ++c)
  {
    f->rgb[3 * i + c] = (float)rgb[c];
  }
}

/* A Gaussian peak of opacity at scalar 1/2, colours that turn `turns` times over the range. */
static inline void ramp_peak(reference_frame* f, double extinction, double sigma, double turns)
{
  for (int i = 0; i < REFERENCE_ENTRIES; ++i)
  {
    const double s = (double)i / (REFERENCE_ENTRIES - 1), d = (s - 0.5) / sigma;
    const double turn = 6.283185307179586 * turns * s;
    const double rgb[3] = { 0.5 + 0.5 * sin(turn), 0.5 + 0.5 * sin(turn + 2),
      0.5 + 0.5 * sin(turn + 4) };
    ramp_entry(f, i, extinction * exp(-0.5 * d * d), rgb);
  }
  ++f->transfer.version;
}

static inline double ramp_extinction(const reference_frame* f, int i)
{
  const double alpha = fmin((double)f->opacity[i], 1 - 0x1p-24);
  return -log1p(-alpha);
}

/*
 * What the eye sees of a ray whose scalar rises (`rise` > 0, a unit of length) or falls from `from`
 * to `to`: the transfer function's tables, linear between entries, in steps of 1/64 entry in
 * double.
 */
static inline void ramp_integrate(
  const reference_frame* f, double from, double to, double rise, double out[4])
{
  const int steps = 64 * (REFERENCE_ENTRIES - 1);
  const double step = (to - from) / steps, length = fabs(step / rise);
  double clear = 1;
  memset(out, 0, 4 * sizeof *out);
  for (int k = 0; k < steps && clear > 1e-12; ++k)
  {
    const double s = from + (k + 0.5) * step;
    const double t = fmin(fmax(s, 0), 1) * (REFERENCE_ENTRIES - 1);
    const int i = t < REFERENCE_ENTRIES - 2 ? (int)t : REFERENCE_ENTRIES - 2;
    const double w = t - i;
    if (f->opacity[i] == 0 && f->opacity[i + 1] == 0)
    {
      continue;
    }
    const double tau = ((1 - w) * ramp_extinction(f, i) + w * ramp_extinction(f, i + 1)) * length;
    const double alpha = -expm1(-tau);
    for (int c = 0; c < 3; ++c)
    {
      out[c] +=
        clear * alpha * ((1 - w) * (double)f->rgb[3 * i + c] + w * (double)f->rgb[3 * (i + 1) + c]);
    }
    clear *= exp(-tau);
  }
  out[3] = 1 - clear;
}

/* Every ray of the picture crosses the whole range: one exact colour for all, and the picture's
 * mean and largest difference from it in units of 1/255; colours only, or alpha as well. */
static inline void ramp_error(
  const float* rgba, const double exact[4], int channels, double error[2])
{
  error[0] = error[1] = 0;
  size_t count = 0;
  for (int y = 4; y < RAMP_PICTURE - 4; ++y)
  {
    for (int x = 4; x < RAMP_PICTURE - 4; ++x)
    {
      for (int c = 0; c < channels; ++c)
      {
        const double d = 255 * fabs((double)rgba[4 * (y * RAMP_PICTURE + x) + c] - exact[c]);
        error[0] += d;
        error[1] = fmax(error[1], d);
        ++count;
      }
    }
  }
  error[0] /= (double)count;
}

#endif
