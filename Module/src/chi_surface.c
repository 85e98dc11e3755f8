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

/* Depth of a pixel in slabs; INFINITY without surface or outside the picture. */
static double depth_at(const interval_job* it, int64_t x, int64_t y)
{
  const chi_scene* const s = it->scene;
  if (x < 0 || y < 0 || x >= s->width || y >= s->height)
  {
    return INFINITY;
  }
  return to_slabs(s, (double)it->surface->depth[x + (int64_t)s->width * y]);
}

/*
 * Whether a step of depth between neighbours a, b belongs to one surface: the step before a, or the
 * one after b, foresees it to within half of itself (and a slab, below which no light passes
 * anyway).
 */
static int is_continuous(double before, double a, double b, double after)
{
  const double step = b - a;
  if (fabs(step) <= 1)
  {
    return 1;
  }
  return fabs(step - (a - before)) <= 0.5 * fabs(step) + 1 ||
    fabs(step - (after - b)) <= 0.5 * fabs(step) + 1;
}

/* Deepest and nearest depth of the surface on the way to the four neighbours. */
static void widen(const interval_job* it, int64_t x, int64_t y, double depth, double range[2])
{
  static const int step[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
  for (int k = 0; k < 4; ++k)
  {
    const int dx = step[k][0], dy = step[k][1];
    const double next = depth_at(it, x + dx, y + dy);
    if (next < INFINITY &&
      is_continuous(
        depth_at(it, x - dx, y - dy), depth, next, depth_at(it, x + 2 * dx, y + 2 * dy)))
    {
      const int share_light_pixel = (x + dx) / 2 == x / 2 && (y + dy) / 2 == y / 2 && x + dx >= 0;
      range[0] = share_light_pixel && next < range[0] ? next : range[0];
      range[1] = next > range[1] ? next : range[1];
    }
  }
}

/*
 * Depth from which the bias counts. Light pixels beside this one, through which its light comes,
 * close from the depth that a tilted surface has there; they are read bilinearly, and shifted so in
 * every slab. So the surface is taken as far nearer to the eye as it rises over 1.5 light pixels.
 */
static double receiving_depth(const interval_job* it, int64_t x, int64_t y, double depth)
{
  double rise[2] = { 0, 0 };
  for (int k = 0; k < 4; ++k)
  {
    const int sign = k & 1 ? -1 : 1, dx = k & 2 ? 0 : sign, dy = k & 2 ? sign : 0;
    const double next = depth_at(it, x + dx, y + dy);
    if (next < depth - rise[k >> 1] &&
      is_continuous(
        depth_at(it, x - dx, y - dy), depth, next, depth_at(it, x + 2 * dx, y + 2 * dy)))
    {
      rise[k >> 1] = depth - next;
    }
  }
  return depth - 1.5 * it->scene->scale * (rise[0] + rise[1]);
}

float chi_surface_receiver(
  const chi_scene* scene, const chi_surface_view* surface, int64_t x, int64_t y, double depth)
{
  const interval_job job = { .scene = scene, .surface = surface };
  return (float)(receiving_depth(&job, x, y, to_slabs(scene, depth)) * (double)scene->group);
}

static void row_intervals(void* data, size_t first, size_t last)
{
  const interval_job* const it = (const interval_job*)data;
  const chi_scene* const s = it->scene;
  for (size_t y = first; y < last && !chi_is_cancelled(it->exec); ++y)
  {
    for (int64_t x = 0; x < s->width; ++x)
    {
      const size_t at = y * it->stride + (size_t)x;
      const double depth = depth_at(it, x, (int64_t)y);
      const double end =
        it->surface->end ? to_slabs(s, (double)it->surface->end[x + (int64_t)y * s->width]) : depth;
      it->slice_depth[at] = (float)(end * (double)s->group);
      it->receiver[at] = it->begin[at] = it->end[at] = INFINITY;
      if (end < INFINITY)
      {
        it->receiver[at] = (float)(receiving_depth(it, x, (int64_t)y, end) * (double)s->group);
      }
      if (depth < INFINITY)
      {
        /* Two pixels of one steep surface lie slabs apart: each closes the way to the deeper one,
         * and, where they share a light pixel, from the nearer one, so that their mean closes all
         * of it. */
        double range[2] = { depth, depth };
        widen(it, x, (int64_t)y, depth, range);
        double begin = s->scale > 1 ? range[0] : depth;
        const double beyond = range[1] + it->thickness;
        begin = begin > 0 ? begin : 0;
        it->begin[at] = (float)begin;
        it->end[at] = (float)(beyond > begin ? beyond : begin);
      }
    }
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
