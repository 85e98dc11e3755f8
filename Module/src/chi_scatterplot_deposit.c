/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Threads' memory, and deposits that bricks and lists share. */

#include "chi_scatterplot_internal.h"

#include <math.h>

static void lock(chi_scatter_job* job)
{
  while (atomic_flag_test_and_set_explicit(&job->lock, memory_order_acquire))
  {
  }
}

static void unlock(chi_scatter_job* job)
{
  atomic_flag_clear_explicit(&job->lock, memory_order_release);
}

void chi_scatter_free_worker(const chi_exec* exec, chi_scatter_worker* worker)
{
  chi_buffer* const buffers[] = { &worker->bins, &worker->scratch, &worker->tile_block,
    &worker->brick_block, &worker->fine_block, &worker->edge_block, &worker->list_block,
    &worker->slot_block };
  for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; ++i)
  {
    chi_buffer_free(exec, buffers[i]);
  }
  chi_free(exec, worker, 1, sizeof *worker);
}

/* Memory of all kinds that do not grow as a piece is read; 0 where it is refused. */
static int equip(const chi_scatter_job* job, chi_scatter_worker* w)
{
  const chi_exec* const exec = job->keep->has_exec ? &job->keep->exec : NULL;
  const size_t nx = (size_t)job->plot.bins[0], ny = (size_t)job->plot.bins[1];
  const size_t bins = nx * ny, tile = job->tile_budget + nx + 64;
  const size_t scratch = (nx > ny ? nx : ny) + 32;
  if (job->is_lattice)
  {
    const int is_new = !w->brick_block.data;
    if (!chi_buffer_reserve(exec, &w->brick_block, 1, sizeof *w->brick) ||
      !chi_buffer_reserve(exec, &w->edge_block, 7 * CHI_SCATTER_POINTS, sizeof *w->edge))
    {
      return 0;
    }
    w->brick = (chi_scatter_brick*)w->brick_block.data;
    w->edge = (chi_scatter_edge*)w->edge_block.data;
    if (is_new)
    {
      memset(w->brick, 0, sizeof *w->brick);
    }
  }
  if (job->params.trilinear_tolerance > 0 && job->dimension == 3)
  {
    const int is_new = !w->fine_block.data;
    if (!chi_buffer_reserve(exec, &w->fine_block, 1, sizeof *w->fine) ||
      !chi_buffer_reserve(exec, &w->edge_block, 7 * CHI_SCATTER_POINTS, sizeof *w->edge))
    {
      return 0;
    }
    w->fine = (chi_scatter_brick*)w->fine_block.data;
    w->edge = (chi_scatter_edge*)w->edge_block.data;
    if (is_new)
    {
      memset(w->fine, 0, sizeof *w->fine);
    }
  }
  if (bins == 0) /* nothing is deposited yet */
  {
    return 1;
  }
  if (!chi_buffer_reserve(exec, &w->bins, bins, sizeof *w->sink.bins) ||
    !chi_buffer_reserve(exec, &w->scratch, scratch, sizeof(double)) ||
    !chi_buffer_reserve(exec, &w->tile_block, tile, sizeof *w->tile))
  {
    return 0;
  }
  w->sink.bins = (int64_t*)w->bins.data;
  w->sink.scratch = (double*)w->scratch.data;
  w->tile = (double*)w->tile_block.data;
  memset(w->sink.bins, 0, bins * sizeof *w->sink.bins);
  memset(w->tile, 0, tile * sizeof *w->tile);
  return 1;
}

chi_scatter_worker* chi_scatter_acquire(chi_scatter_job* job)
{
  chi_scatterplot* const keep = job->keep;
  const chi_exec* const exec = keep->has_exec ? &keep->exec : NULL;
  for (;;)
  {
    chi_scatter_worker* found = NULL;
    int is_full = 0;
    lock(job);
    for (size_t i = 0; i < keep->worker_count && !found; ++i)
    {
      found = keep->workers[i]->is_busy ? NULL : keep->workers[i];
    }
    is_full = !found && keep->worker_count == CHI_SCATTER_WORKERS;
    if (!found && !is_full)
    {
      found = (chi_scatter_worker*)chi_alloc(exec, 1, sizeof *found);
      if (found)
      {
        memset(found, 0, sizeof *found);
        keep->workers[keep->worker_count++] = found;
      }
    }
    if (found)
    {
      found->is_busy = 1;
      if (!found->is_equipped && !(found->is_equipped = equip(job, found)))
      {
        found->is_busy = 0;
        found = NULL;
      }
    }
    unlock(job);
    if (found)
    {
      return found;
    }
    if (!is_full)
    {
      job->failed = CHI_ERROR_OUT_OF_MEMORY;
      return NULL;
    }
  }
}

void chi_scatter_release(chi_scatter_job* job, chi_scatter_worker* worker)
{
  lock(job);
  worker->is_busy = 0;
  unlock(job);
}

int chi_scatter_deposit_at(
  const chi_scatter_job* job, chi_scatter_worker* worker, double x, double y, double mass)
{
  const int32_t* const n = job->plot.bins;
  if (!(x >= 0 && y >= 0 && x <= n[0] && y <= n[1]))
  {
    worker->sink.outside += mass;
    return 0;
  }
  const int32_t i = x < n[0] ? (int32_t)x : n[0] - 1, j = y < n[1] ? (int32_t)y : n[1] - 1;
  const int64_t all = llrint(mass * job->plot.unit);
  worker->sink.bins[(size_t)j * (size_t)n[0] + (size_t)i] += all;
  worker->sink.deposited += all;
  worker->sink.inside += mass;
  return 1;
}

void chi_scatter_settle(const chi_scatter_job* job, chi_scatter_worker* w)
{
  w->mass += llrint(w->sink.inside * job->plot.unit);
  w->out += llrint(w->sink.outside * job->total_unit);
  w->singular += llrint(w->sink.singular * job->total_unit);
  w->bound += (int64_t)ceil(w->sink_error * job->total_unit);
  w->sink.inside = w->sink.outside = w->sink.singular = w->sink_error = 0;
}

static double clamp(double x, double high)
{
  return x < 0 ? 0 : x > high ? high : x;
}

void chi_scatter_deposit_edges(const chi_scatter_job* job, chi_scatter_worker* worker,
  const double* x, const double* y, size_t count, double mass, const double box[4], double clean)
{
  const int32_t* const n = job->plot.bins;
  const int32_t left = (int32_t)clamp(box[0], n[0]), right = (int32_t)clamp(box[1], n[0]);
  const int32_t first = (int32_t)clamp(box[2], n[1]);
  const int32_t last = (int32_t)clamp(box[3], n[1] - 1); /* what ends on a line ends below it */
  chi_scatter_tile tile = { .at = worker->tile, .left = left, .width = right - left + 1 };
  /* a segment's tails reach three bins further, and vectors eight */
  worker->sink.inside += mass;
  tile.stride = ((size_t)tile.width + 10) / 8 * 8 + 8;
  tile.stride += tile.stride % 64 == 0 ? 8 : 0; /* rows do not share the sets of the cache */
  const size_t most = job->tile_budget / tile.stride;
  const int32_t rows = most < 1 ? 1 : most > (size_t)n[1] ? n[1] : (int32_t)most;
  for (int32_t j = first; j <= last; j += rows)
  {
    tile.first = j;
    tile.count = last - j + 1 < rows ? last - j + 1 : rows;
    job->kernels->edges(&tile, x, y, worker->edge, count);
    worker->sink.deposited += job->kernels->flush(&job->plot, &tile, clean, worker->sink.bins);
  }
}

/* ---- the published method, for comparison */

typedef struct point2
{
  double x, y;
} point2;

static double cross(point2 a, point2 b, point2 c)
{
  return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

/* The hull of a projected tetrahedron in order, and the point where it is thickest; corners of the
 * hull, or 0 where it has no area. */
static int find_hull(const point2 v[4], point2 hull[4], point2* thick)
{
  const double e[4] = { -cross(v[1], v[2], v[3]), cross(v[0], v[2], v[3]), -cross(v[0], v[1], v[3]),
    cross(v[0], v[1], v[2]) };
  int front[4], back[4], fronts = 0, backs = 0;
  for (int k = 0; k < 4; ++k)
  {
    if (e[k] > 0)
    {
      front[fronts++] = k;
    }
    else
    {
      back[backs++] = k;
    }
  }
  if (fronts == 0 || backs == 0)
  {
    return 0;
  }
  if (fronts != 2)
  {
    const int alone = fronts == 1 ? front[0] : back[0];
    for (int k = 0; k < 3; ++k)
    {
      hull[k] = v[fronts == 1 ? back[k] : front[k]];
    }
    *thick = v[alone];
    return 3;
  }
  /* the diagonals cross where both are cut in the ratio of their weights */
  const double s = e[front[0]] + e[front[1]];
  *thick = (point2){ (e[front[0]] * v[front[0]].x + e[front[1]] * v[front[1]].x) / s,
    (e[front[0]] * v[front[0]].y + e[front[1]] * v[front[1]].y) / s };
  hull[0] = v[front[0]];
  hull[1] = v[back[0]];
  hull[2] = v[front[1]];
  hull[3] = v[back[1]];
  return 4;
}

/* Relative height at p over the fan of the hull's triangles from the thickest point, where it is 1;
 * negative outside. With `is_flat` 1 inside. */
static double height_at(const point2* hull, int corners, point2 thick, int is_flat, point2 p)
{
  for (int k = 0; k < corners; ++k)
  {
    const point2 a = hull[k], b = hull[(k + 1) % corners];
    const double area = cross(thick, a, b);
    const double w = cross(p, a, b) / area, wa = cross(p, b, thick) / area;
    if (area != 0 && w >= 0 && wa >= 0 && 1 - w - wa >= 0)
    {
      return is_flat ? 1 : w;
    }
  }
  return -1;
}

void chi_scatter_deposit_published(const chi_scatter_job* job, chi_scatter_worker* worker,
  int corners, const double* x, const double* y, double mass)
{
  const int32_t* const n = job->plot.bins;
  point2 v[4], hull[4], thick = { 0, 0 };
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY }, area = 0;
  for (int c = 0; c < corners; ++c)
  {
    v[c] = (point2){ x[c], y[c] };
    low[0] = fmin(low[0], x[c]);
    high[0] = fmax(high[0], x[c]);
    low[1] = fmin(low[1], y[c]);
    high[1] = fmax(high[1], y[c]);
  }
  int sides = 3;
  if (corners == 3)
  {
    memcpy(hull, v, 3 * sizeof *v);
    thick = (point2){ (x[0] + x[1] + x[2]) / 3, (y[0] + y[1] + y[2]) / 3 };
  }
  else
  {
    sides = find_hull(v, hull, &thick);
  }
  for (int k = 0; k < sides; ++k)
  {
    area += 0.5 * fabs(cross(thick, hull[k], hull[(k + 1) % sides]));
  }
  if (sides == 0 || !(area > 0))
  {
    return; /* infinite: the method has nothing to draw */
  }
  /* 3 m / A where it is thickest; bounded, so that the sums of integers are */
  const double peak = mass * fmin((corners == 4 ? 3 : 1) / area, CHI_SCATTER_HIGHEST);
  const double from[2] = { clamp(ceil(low[0] - 0.5), n[0]), clamp(ceil(low[1] - 0.5), n[1]) };
  for (int32_t j = (int32_t)from[1]; j < n[1] && j + 0.5 <= high[1]; ++j)
  {
    for (int32_t i = (int32_t)from[0]; i < n[0] && i + 0.5 <= high[0]; ++i)
    {
      const double h = height_at(hull, sides, thick, corners == 3, (point2){ i + 0.5, j + 0.5 });
      if (h > 0)
      {
        const int64_t all = llrint(peak * h * job->plot.unit);
        worker->sink.bins[(size_t)j * (size_t)n[0] + (size_t)i] += all;
      }
    }
  }
}

void chi_scatter_deposit_simplex(const chi_scatter_job* job, chi_scatter_worker* worker,
  int corners, const double* x, const double* y, double mass)
{
  if (job->params.method == CHI_SCATTERPLOT_PUBLISHED)
  {
    chi_scatter_deposit_published(job, worker, corners, x, y, mass);
  }
  else
  {
    job->kernels->sections(&job->plot, &worker->sink, corners, x, y, mass);
  }
  ++worker->sections;
}
