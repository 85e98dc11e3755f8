/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "occlusion_stress.h"

#include "occlusion_reference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double angle_45 = 0.78539816339744831, radian = 0.017453292519943295;

/* What a case needs. Missing memory shows as a measured NaN. */
typedef struct bench
{
  const chi_exec* exec;
  stress_report report;
  void* user;
  chi_occlusion* engine;
  reference_frame* frame;
} bench;

static void tell(const bench* b, const char* name, double parameter, const char* invariant,
  double measured, double bound)
{
  const stress_row row = { name, parameter, invariant, measured, bound };
  b->report(b->user, &row);
}

/* ---- a homogeneous box: optical depth and visibility are known ---- */

typedef struct box
{
  size_t n[3];       /* samples */
  double spacing[3]; /* world units */
  double origin[3];
  double sigma; /* extinction a world unit */
  float* value; /* [n[0] n[1] n[2]] all 1, owned */
} box;

static int box_create(box* b)
{
  const size_t count = b->n[0] * b->n[1] * b->n[2];
  b->value = malloc(count * sizeof *b->value);
  for (size_t i = 0; b->value && i < count; ++i)
  {
    b->value[i] = 1;
  }
  return b->value != NULL;
}

static double box_extent(const box* b)
{
  double square = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double side = b->spacing[a] * (double)(b->n[a] - 1);
    square += side * side;
  }
  return sqrt(square);
}

/* A frame of the box, seen from outside: turned as reference_turned_view turns, the window shows
 * `size` world units at the box's centre. */
static void box_frame(
  reference_frame* f, const box* b, const double turn_deg[2], double size, int pixels, int parallel)
{
  double center[3];
  for (int a = 0; a < 3; ++a)
  {
    center[a] = b->origin[a] + 0.5 * b->spacing[a] * (double)(b->n[a] - 1);
  }
  const reference_view view =
    reference_turned_view(center, 2 * box_extent(b), turn_deg, size, pixels, parallel);
  reference_frame_init(f, NULL, &view, 1);
  f->volume = (chi_volume_view){ .struct_size = sizeof f->volume,
    .scalars = b->value,
    .type = CHI_F32,
    .stride = sizeof(float),
    .dimensions = { b->n[0], b->n[1], b->n[2] },
    .index_to_world = { b->spacing[0], 0, 0, b->origin[0], 0, b->spacing[1], 0, b->origin[1], 0, 0,
      -b->spacing[2], -b->origin[2], 0, 0, 0, 1 },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  f->frame.volume = &f->volume;
  f->frame.transfer = &f->transfer;
  f->transfer.count = 2;
  f->opacity[0] = f->opacity[1] = 0.5f;
  f->transfer.unit_distance = log(2.0) / b->sigma;
}

/* Length of a pixel's ray within the box, world units, from near_depth on. */
static double box_path(const reference_frame* f, const box* b, int x, int y)
{
  const chi_camera* const c = &f->camera;
  const double u = c->window[0] + (x + 0.5) / c->width * (c->window[1] - c->window[0]);
  const double v = c->window[2] + (y + 0.5) / c->height * (c->window[3] - c->window[2]);
  const double* const m = c->world_to_eye;
  const double start[3] = { c->parallel ? u : 0, c->parallel ? v : 0, 0 };
  const double along[3] = { c->parallel ? 0 : u, c->parallel ? 0 : v, -1 };
  const double margin = f->volume.is_cell_data ? 0.5 : 0;
  double from = c->near_depth, to = INFINITY;
  for (int a = 0; a < 3; ++a)
  {
    double p = 0, d = 0; /* the rotation's inverse is its transpose */
    for (int k = 0; k < 3; ++k)
    {
      p += m[4 * k + a] * (start[k] - m[4 * k + 3]);
      d += m[4 * k + a] * along[k];
    }
    const double sign = a == 2 ? -1 : 1;
    const double low = (sign * p - b->origin[a]) / b->spacing[a] + margin;
    const double high = low - ((double)(b->n[a] - 1) + 2 * margin);
    const double step = sign * d / b->spacing[a];
    if (fabs(step) * b->spacing[a] < 1e-14)
    {
      to = low >= 0 && high <= 0 ? to : -INFINITY;
      continue;
    }
    from = fmax(from, fmin(-low / step, -high / step));
    to = fmin(to, fmax(-low / step, -high / step));
  }
  return to > from ? (to - from) * sqrt(along[0] * along[0] + along[1] * along[1] + 1) : 0;
}

/* Largest difference of alpha from 1 - exp(-tau), NaN without a picture. Rays end at alpha 0.998:
 * what is missing beyond does not count. */
static double alpha_error(const bench* b, const box* box)
{
  const reference_frame* const f = b->frame;
  chi_occlusion_image image;
  const chi_status status = chi_occlusion_render(b->exec, b->engine, &f->frame);
  chi_occlusion_get_image(b->engine, &image);
  if (status != CHI_OK || !image.rgba)
  {
    return NAN;
  }
  double worst = 0;
  for (int i = 0; i < f->camera.width * f->camera.height; ++i)
  {
    const double tau = box->sigma * box_path(f, box, i % f->camera.width, i / f->camera.width);
    const double alpha = (double)image.rgba[4 * i + 3], exact = -expm1(-tau);
    const double error = fabs(alpha - exact);
    if (!(error >= 0) || !(image.rgba[4 * i] >= 0 && image.rgba[4 * i] <= 1))
    {
      return NAN;
    }
    worst = fmax(worst, exact > 0.998 && alpha >= 0.998 ? 0 : error);
  }
  return worst;
}

/*
 * Bound of alpha_error: a float product a slice (2^-24 each); where a ray enters and leaves is
 * known to 2^-24 of all slices, times the thickness of one slice, at most 1 where alpha is not
 * saturated, on either side. A ray along an edge of the box has no such bound: views are chosen so
 * that none is.
 */
static double alpha_bound(const bench* b)
{
  chi_occlusion_stats stats;
  chi_occlusion_get_stats(b->engine, &stats);
  return (4.0 * (double)stats.slices + 16) * 0x1p-24;
}

/* Mean over the cone of exp(-tau / mu): visibility at optical depth tau below a plane. */
static double plane_visibility(double tau, double theta, int directions)
{
  double sum = 0;
  for (int i = 0; i < directions; ++i)
  {
    sum += exp(-tau / (1 - (1 - cos(theta)) * (i + 0.5) / directions));
  }
  return sum / directions;
}

/* Visibility that the engine finds in the middle of the picture at a depth below the front face. */
static double visibility_at_depth(const bench* b, double depth)
{
  reference_frame* const f = b->frame;
  const double at[3] = { 0.5 * f->camera.width, 0.5 * f->camera.height, depth };
  float seen = NAN;
  f->probes = (chi_occlusion_probes){ at, &seen, 1 };
  f->frame.probes = &f->probes;
  const chi_status status = chi_occlusion_render(b->exec, b->engine, &f->frame);
  f->frame.probes = NULL;
  return status == CHI_OK ? (double)seen : NAN;
}

static const double oblique[2] = { 31, 17 }, straight[2] = { 0, 0 };

/* Optical depth of about one through the box, whose extent shrinks as the extinction grows. */
static void extinction_with_extent(const bench* b)
{
  for (int power = -12; power <= 12; power += 3)
  {
    box x = { .n = { 33, 33, 33 }, .sigma = pow(10, power) };
    x.spacing[0] = x.spacing[1] = x.spacing[2] = 1 / (32 * x.sigma);
    if (box_create(&x))
    {
      double worst = 0;
      for (int parallel = 0; parallel < 2; ++parallel)
      {
        box_frame(b->frame, &x, oblique, 2 / x.sigma, 48, parallel);
        worst = fmax(worst, alpha_error(b, &x));
      }
      tell(b, "extinction a unit, extent its inverse", x.sigma, "alpha = 1 - exp(-tau)", worst,
        alpha_bound(b));
      box_frame(b->frame, &x, straight, 1 / x.sigma, 48, 1);
      const double front = 2 * box_extent(&x) - 0.5 / x.sigma;
      const double d = 8 * x.spacing[2], seen = visibility_at_depth(b, front + d);
      /* Between light planes V is linear: (sigma slab)^2 / 8; see test_occlusion_accuracy. */
      tell(b, "extinction a unit, extent its inverse", x.sigma, "V of a half-space",
        fabs(seen - plane_visibility(d * x.sigma, angle_45, 4000)), 1.5e-3);
    }
    free(x.value);
  }
}

/* The same box of 32 units whatever the extinction: empty, or opaque at once. */
static void extinction_alone(const bench* b)
{
  double before = 2;
  for (int power = -12; power <= 12; power += 3)
  {
    box x = { .n = { 33, 33, 33 }, .spacing = { 1, 1, 1 }, .sigma = pow(10, power) };
    if (box_create(&x))
    {
      box_frame(b->frame, &x, oblique, 60, 48, 1);
      const double worst = alpha_error(b, &x);
      tell(
        b, "extinction a unit, extent 32", x.sigma, "alpha = 1 - exp(-tau)", worst, alpha_bound(b));
      box_frame(b->frame, &x, straight, 32, 48, 1);
      const double seen = visibility_at_depth(b, 2 * box_extent(&x) - 16 + 4);
      tell(b, "extinction a unit, extent 32", x.sigma, "V of a half-space, falling",
        seen <= before ? fabs(seen - plane_visibility(4 * x.sigma, angle_45, 4000)) : NAN, 4e-3);
      before = seen;
    }
    free(x.value);
  }
}

static void spacing_ratios(const bench* b)
{
  static const char* const names[6] = { "spacing 1000:1:1, parallel", "spacing 1:1000:1, parallel",
    "spacing 1:1:1000, parallel", "spacing 1000:1:1, perspective", "spacing 1:1000:1, perspective",
    "spacing 1:1:1000, perspective" };
  for (int k = 0; k < 6; ++k)
  {
    box x = { .n = { 9, 9, 9 }, .spacing = { 1, 1, 1 } };
    x.spacing[k % 3] = 1000;
    x.sigma = 0.1; /* the short sides are thin, the long one is opaque */
    if (box_create(&x))
    {
      double worst = 0, bound = 0;
      for (int view = 0; view < 2; ++view)
      {
        box_frame(b->frame, &x, view ? oblique : straight, view ? 40 : 9000, 24, k < 3);
        worst = fmax(worst, alpha_error(b, &x));
        bound = fmax(bound, alpha_bound(b));
      }
      tell(b, names[k], 1000, "alpha = 1 - exp(-tau)", worst, bound);
    }
    free(x.value);
  }
}

static void cones(const bench* b)
{
  static const double angles[9] = { 1, 2, 5, 15, 30, 45, 60, 75, 85 };
  for (int half = 0; half < 2; ++half)
  {
    double before = 2;
    for (int k = 0; k < 9; ++k)
    {
      box x = { .n = { 129, 129, 9 }, .spacing = { 1, 1, 1 }, .sigma = 0.05 };
      if (box_create(&x))
      {
        box_frame(b->frame, &x, straight, 129, 129, 1);
        b->frame->params.half_size = half;
        b->frame->params.cone_angle_rad = angles[k] * radian;
        const double d = 4, seen = visibility_at_depth(b, 2 * box_extent(&x) - 4 + d);
        /* The engine's own 16 directions; between light planes (sigma L)^2 / 8 exp(-tau L), which
         * is at most 2 e^-2 / (8 d^2) each. A wider cone has the longer paths. */
        tell(b, half ? "half angle of the cone, half size" : "half angle of the cone, full size",
          angles[k], "V of a half-space, falling",
          seen <= before ? fabs(seen - plane_visibility(d * x.sigma, angles[k] * radian, 16)) : NAN,
          2 * exp(-2) / (8 * d * d));
        before = seen;
      }
      free(x.value);
    }
  }
}

static void few_voxels(const bench* b)
{
  for (size_t k = 0; k < 2 * 27; ++k)
  {
    box x = {
      .n = { k % 3 + 1, k / 3 % 3 + 1, k / 9 % 3 + 1 }, .spacing = { 1, 1, 1 }, .sigma = 0.4
    };
    if (box_create(&x))
    {
      double worst = 0, bound = 0;
      for (int view = 0; view < 4; ++view)
      {
        box_frame(b->frame, &x, view & 1 ? oblique : straight, 6, 48, view >> 1);
        /* One sample has no extent, and no distance that would place the eye. No ray runs within a
         * volume that is flat: none meets it for a length. */
        b->frame->camera.world_to_eye[11] = -10;
        if (!(view >> 1))
        {
          b->frame->camera.window[0] = b->frame->camera.window[2] = -0.3;
          b->frame->camera.window[1] = b->frame->camera.window[3] = 0.3;
          b->frame->camera.near_depth = 0.1;
        }
        for (int a = 0; a < 3; ++a)
        {
          const double* const m = b->frame->camera.world_to_eye;
          double at = a == 2 ? -10 : 0;
          for (int c = 0; c < 3; ++c)
          {
            at -= m[4 * a + c] * (c == 2 ? -0.5 : 0.5) * (double)(x.n[c] - 1);
          }
          b->frame->camera.world_to_eye[4 * a + 3] = at;
        }
        b->frame->volume.is_cell_data = k >= 27;
        worst = fmax(worst, alpha_error(b, &x));
        bound = fmax(bound, alpha_bound(b));
      }
      char name[64];
      snprintf(name, sizeof name, "%zu x %zu x %zu %s", x.n[0], x.n[1], x.n[2],
        k < 27 ? "samples" : "cells");
      tell(b, name, (double)(x.n[0] * x.n[1] * x.n[2]), "alpha = 1 - exp(-tau)", worst, bound);
    }
    free(x.value);
  }
}

/* The eye in the middle of the box: what it sees begins at near_depth. */
static void near_planes(const bench* b)
{
  for (int power = -7; power <= -1; ++power)
  {
    box x = { .n = { 33, 33, 33 }, .spacing = { 1, 1, 1 }, .sigma = 1.0 / 16 };
    if (box_create(&x))
    {
      box_frame(b->frame, &x, oblique, 60, 48, 0);
      b->frame->camera.world_to_eye[11] += 2 * box_extent(&x);
      b->frame->camera.near_depth = 55 * pow(10, power);
      const double worst = alpha_error(b, &x);
      tell(b, "near plane over the volume's diagonal, eye within", pow(10, power),
        "alpha = 1 - exp(-tau)", worst, alpha_bound(b));
    }
    free(x.value);
  }
}

/* ---- opacity functions with steps over a linear ramp along the view ---- */

enum
{
  RAMP = 33, /* samples along the ramp */
  ACROSS = 5
};

static void fill_steps(float* opacity, size_t entries, int shape)
{
  for (size_t i = 0; i < entries; ++i)
  {
    const int on = shape == 0 ? i >= entries / 2
      : shape == 1            ? i == entries / 2
                              : i > 0 && i % 2 == 1;
    opacity[i] = on ? (shape == 0 ? 0.9f : 0.6f) : 0;
  }
}

static void steps(const bench* b)
{
  static const char* const names[3] = { "opacity a step, entries", "opacity one entry of",
    "opacity a comb, entries" };
  static const size_t sizes[4] = { 2, 256, 4096, 65536 };
  float* const value = malloc(RAMP * ACROSS * ACROSS * sizeof *value);
  float* const opacity = malloc(65536 * sizeof *opacity);
  float* const rgb = calloc(3 * 65536, sizeof *rgb);
  for (int i = 0; value && i < RAMP * ACROSS * ACROSS; ++i)
  {
    value[i] = (float)(i / (ACROSS * ACROSS)) / (RAMP - 1);
  }
  for (int k = 0; value && opacity && rgb && k < 12; ++k)
  {
    const size_t entries = sizes[k % 4];
    fill_steps(opacity, entries, k / 4);
    double sum = 0; /* of the piecewise linear extinction over the table, at unit distance 1 */
    for (size_t i = 0; i + 1 < entries; ++i)
    {
      sum -= 0.5 * (log1p(-(double)opacity[i]) + log1p(-(double)opacity[i + 1]));
    }
    for (int distance = 0; distance < 3; ++distance)
    {
      box x = { .n = { ACROSS, ACROSS, RAMP }, .spacing = { 1, 1, 1 }, .sigma = 1 };
      reference_frame* const f = b->frame;
      box_frame(f, &x, straight, 3, 15, 1);
      f->volume.scalars = value;
      f->transfer = (chi_transfer_view){ .struct_size = sizeof f->transfer,
        .rgb = rgb,
        .opacity = opacity,
        .count = entries,
        .range = { 0, 1 },
        .unit_distance = sum * (RAMP - 1) / (double)(entries - 1), /* tau = 1 in all */
        .version = 1 };
      f->params.sample_distance = distance == 0 ? 0.25 : distance == 1 ? 1 : 4;
      f->params.strength = 0;
      chi_occlusion_image image;
      const chi_status status = chi_occlusion_render(b->exec, b->engine, &f->frame);
      chi_occlusion_get_image(b->engine, &image);
      double worst = status == CHI_OK ? 0 : NAN;
      for (int i = 0; status == CHI_OK && i < 15 * 15; ++i)
      {
        worst = fmax(worst, fabs((double)image.rgba[4 * i + 3] + expm1(-1)));
      }
      /* At the box's face a ray has no scalar before: its first segment counts with its far end's
       * extinction, at most twice the mean one (comb), or, over a ramp, with twice the integral,
       * (d / 32)^2. Of a step that lies deeper nothing is lost. */
      const double d = fmax(f->params.sample_distance, 0.25) / (RAMP - 1);
      const double face = exp(-1) * (entries == 2 ? d * d : k / 4 == 2 ? d : 0);
      static const char* const invariants[3] = { "alpha = 1 - exp(-tau), 4 slices a voxel",
        "alpha = 1 - exp(-tau), 1 slice a voxel", "alpha = 1 - exp(-tau), 1/4 slice a voxel" };
      tell(b, names[k / 4], (double)entries, invariants[distance], worst, alpha_bound(b) + face);
    }
  }
  free(value);
  free(opacity);
  free(rgb);
}

void occlusion_stress(const chi_exec* exec, int window, stress_report report, void* user)
{
  bench b = { exec, report, user, NULL, malloc(sizeof(reference_frame)) };
  if (b.frame && chi_occlusion_create(exec, &b.engine) == CHI_OK)
  {
    extinction_with_extent(&b);
    extinction_alone(&b);
    steps(&b);
    spacing_ratios(&b);
    near_planes(&b);
    cones(&b);
    few_voxels(&b);
  }
  else
  {
    tell(&b, "memory", 0, "is there", NAN, 0);
  }
  chi_occlusion_destroy(exec, b.engine);
  free(b.frame);
  occlusion_stress_pictures(exec, window, report, user);
}
