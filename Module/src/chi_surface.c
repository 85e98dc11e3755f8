/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_internal.h"

#include <math.h>

typedef struct interval_job
{
  const chi_exec* exec;
  const chi_scene* scene;
  const chi_surface_view* surface;
  double thickness;      /* slabs */
  size_t stride, padded; /* floats from row to row; floats a row that are written */
  float* slice_depth;
  float* receiver;
  float* begin;
  float* end;
} interval_job;

static double to_slabs(const chi_scene* s, double depth)
{
  return depth > 0 && depth < INFINITY ? (depth - s->start) / s->slab : INFINITY;
}

/*
 * Whether a step of depth between neighbours a, b belongs to one surface: the step before a, or the
 * one after b, foresees it to within half of itself (and a slab, below which no light passes
 * anyway).
 */
static inline int is_continuous(double before, double a, double b, double after)
{
  const double step = b - a;
  const double allowed = 0.5 * fabs(step) + 1;
  return (fabs(step) <= 1) | (fabs(step - (a - before)) <= allowed) |
    (fabs(step - (after - b)) <= allowed);
}

/*
 * Depths in slabs of a pixel and of the two beside it to either side, along x and along y, in this
 * order: two before, one before, the pixel, one after, two after. INFINITY: no surface there.
 */
typedef struct cross
{
  double x[5], y[5];
} cross;

/* Deepest and nearest depth of the surface on the way to the four neighbours. `odd`: of the pixel's
 * place, along x and y; with the neighbour on that side it shares a light pixel at half size. */
static inline void widen(const cross* c, const int odd[2], double range[2])
{
  for (int k = 0; k < 4; ++k)
  {
    const double* const z = k < 2 ? c->x : c->y;
    const int sign = k & 1 ? -1 : 1;
    const double next = z[2 + sign];
    const int same = (next < INFINITY) & is_continuous(z[2 - sign], z[2], next, z[2 + 2 * sign]);
    const int shares = same & (odd[k >> 1] == (sign < 0));
    range[0] = shares & (next < range[0]) ? next : range[0];
    range[1] = same & (next > range[1]) ? next : range[1];
  }
}

/*
 * Depth from which the bias counts. Light pixels beside this one, through which its light comes,
 * close from the depth that a tilted surface has there; they are read bilinearly, and shifted so in
 * every slab. So the surface is taken as far nearer to the eye as it rises over 1.5 light pixels.
 */
static inline double receiving_depth(const cross* c, double depth, int scale)
{
  double rise[2] = { 0, 0 };
  for (int k = 0; k < 4; ++k)
  {
    const double* const z = k < 2 ? c->x : c->y;
    const int sign = k & 1 ? -1 : 1;
    const double next = z[2 + sign];
    const int rises =
      (next < depth - rise[k >> 1]) & is_continuous(z[2 - sign], depth, next, z[2 + 2 * sign]);
    rise[k >> 1] = rises ? depth - next : rise[k >> 1];
  }
  return depth - 1.5 * scale * (rise[0] + rise[1]);
}

/* Depth of a pixel in slabs; INFINITY without surface or outside the picture. */
static double depth_at(const chi_scene* s, const chi_surface_view* surface, int64_t x, int64_t y)
{
  return x < 0 || y < 0 || x >= s->width || y >= s->height
    ? INFINITY
    : to_slabs(s, (double)surface->depth[x + (int64_t)s->width * y]);
}

float chi_surface_receiver(
  const chi_scene* scene, const chi_surface_view* surface, int64_t x, int64_t y, double depth)
{
  cross c;
  for (int k = 0; k < 5; ++k)
  {
    c.x[k] = depth_at(scene, surface, x + k - 2, y);
    c.y[k] = depth_at(scene, surface, x, y + k - 2);
  }
  return (float)(receiving_depth(&c, to_slabs(scene, depth), scene->scale) * (double)scene->group);
}

enum
{
  COLUMNS = 256,
  WINDOW = 5 /* rows that a pixel looks at */
};

/* A row's depths in slabs from two pixels before x0 to two behind the piece. */
static void load_row(const interval_job* it, int64_t y, int64_t x0, int count, double* out)
{
  const chi_scene* const s = it->scene;
  for (int i = 0; i < count + 4; ++i)
  {
    out[i] = depth_at(s, it->surface, x0 + i - 2, y);
  }
}

/* One row of a piece; row[k] is that of y + k - 2. */
static void piece_intervals(
  const interval_job* it, size_t y, int64_t x0, int count, const double* const row[WINDOW])
{
  const chi_scene* const s = it->scene;
  const int scale = s->scale;
  const double group = (double)s->group;
  for (int i = 0; i < count; ++i)
  {
    const int64_t x = x0 + i;
    const size_t at = y * it->stride + (size_t)x;
    cross c;
    for (int k = 0; k < 5; ++k)
    {
      c.x[k] = row[2][i + k];
      c.y[k] = row[k][i + 2];
    }
    const double depth = c.x[2];
    const double end =
      it->surface->end ? to_slabs(s, (double)it->surface->end[x + (int64_t)y * s->width]) : depth;
    it->slice_depth[at] = (float)(end * group);
    it->receiver[at] = it->begin[at] = it->end[at] = INFINITY;
    if (end < INFINITY)
    {
      it->receiver[at] = (float)(receiving_depth(&c, end, scale) * group);
    }
    if (depth < INFINITY)
    {
      /* Two pixels of one steep surface lie slabs apart: each closes the way to the deeper one,
       * and, where they share a light pixel, from the nearer one, so that their mean closes all
       * of it. */
      const int odd[2] = { (int)(x & 1), (int)(y & 1) };
      double range[2] = { depth, depth };
      widen(&c, odd, range);
      double begin = scale > 1 ? range[0] : depth;
      const double beyond = range[1] + it->thickness;
      begin = begin > 0 ? begin : 0;
      it->begin[at] = (float)begin;
      it->end[at] = (float)(beyond > begin ? beyond : begin);
    }
  }
}

/* Piece by piece from row to row, so that each depth is converted once. */
static void row_intervals(void* data, size_t first, size_t last)
{
  const interval_job* const it = (const interval_job*)data;
  const chi_scene* const s = it->scene;
  double depths[WINDOW][COLUMNS + 4];
  for (int64_t x0 = 0; x0 < s->width; x0 += COLUMNS)
  {
    const int count = s->width - x0 < COLUMNS ? (int)(s->width - x0) : COLUMNS;
    for (int64_t y = (int64_t)first - 2; y < (int64_t)first + 2; ++y)
    {
      load_row(it, y, x0, count, depths[(y + WINDOW) % WINDOW]);
    }
    for (size_t y = first; y < last && !chi_is_cancelled(it->exec); ++y)
    {
      const double* row[WINDOW];
      load_row(it, (int64_t)y + 2, x0, count, depths[(y + 2) % WINDOW]);
      for (size_t k = 0; k < WINDOW; ++k)
      {
        row[k] = depths[(y + k + WINDOW - 2) % WINDOW];
      }
      piece_intervals(it, y, x0, count, row);
    }
  }
  for (size_t y = first; y < last; ++y)
  {
    for (size_t x = (size_t)s->width; x < it->padded; ++x)
    {
      it->slice_depth[y * it->stride + x] = INFINITY;
      it->receiver[y * it->stride + x] = INFINITY;
      it->begin[y * it->stride + x] = it->end[y * it->stride + x] = INFINITY;
    }
  }
}

chi_status chi_surface_intervals(const chi_exec* exec, const chi_scene* scene,
  const chi_surface_view* surface, double thickness, size_t stride, size_t padded,
  float* slice_depth, float* receiver, float* begin, float* end)
{
  interval_job job = { exec, scene, surface, thickness / scene->slab, stride, padded, slice_depth,
    receiver, begin, end };
  return chi_for(exec, (size_t)scene->height, row_intervals, &job);
}
