/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Lists of nothing but tetrahedra in an order of space. What is moved is the cells' points, so that
 * nobody has to look a cell up in memory's order again: 16 bytes a cell, and 2 bytes a point while
 * they are sorted. A cell's key is that of its first point on a Morton curve. A first pass goes to
 * buckets by the key's upper bits, its writes to as many places as the first cache has lines; a
 * second one sorts each bucket in place by the lower bits while the second cache holds it.
 */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  KEY_BITS = 16, /* x, y, z in turn from the lowest on */
  FINE_BITS = 7,
  FINE = 1 << FINE_BITS,
  COARSE = 1 << (KEY_BITS - FINE_BITS),
  POINTS_A_CHUNK = 16384,
  PARTS = 32 /* of the list, whatever the number of threads */
};

typedef uint32_t corners[4];

typedef struct corner_job
{
  const chi_scatter_job* job;
  corners* out;
  uint16_t* keys; /* of points */
  size_t (*places)[COARSE];
  double low[3], scale[3], last[3];
  atomic_int is_broken; /* a point is not there */
} corner_job;

/* Bits 0, 1, 2 ... to 0, 3, 6 ... */
static uint32_t spread_bits(uint32_t k)
{
  k = (k | k << 8) & 0x0300f00f;
  k = (k | k << 4) & 0x030c30c3;
  return (k | k << 2) & 0x09249249;
}

static void make_keys(void* data, size_t begin, size_t end)
{
  const corner_job* const s = (const corner_job*)data;
  const chi_grid* const grid = &s->job->grid;
  for (size_t c = begin; c < end; ++c)
  {
    const size_t first = c * POINTS_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, POINTS_A_CHUNK, grid->points);
    for (size_t i = first; i < last; ++i)
    {
      double x[3];
      uint32_t key = 0;
      chi_grid_point(grid, i, x);
      for (int a = 0; a < 3; ++a)
      {
        double k = (x[a] - s->low[a]) * s->scale[a];
        k = k > 0 ? k : 0; /* NaN too */
        k = k < s->last[a] ? k : s->last[a];
        key |= spread_bits((uint32_t)k) << a;
      }
      s->keys[i] = (uint16_t)key;
    }
  }
}

static size_t part_begin(const corner_job* s, size_t part)
{
  const size_t n = s->job->grid.cells;
  return n / PARTS * part + n % PARTS * part / PARTS;
}

static void count_cells(void* data, size_t begin, size_t end)
{
  corner_job* const s = (corner_job*)data;
  const uint64_t points = s->job->grid.points;
  for (size_t part = begin; part < end; ++part)
  {
    size_t* const places = s->places[part];
    memset(places, 0, sizeof s->places[part]);
    for (size_t i = part_begin(s, part); i < part_begin(s, part + 1); ++i)
    {
      const int64_t* const ids = s->job->grid.view.connectivity + 4 * i;
      if ((uint64_t)ids[0] >= points || (uint64_t)ids[1] >= points || (uint64_t)ids[2] >= points ||
        (uint64_t)ids[3] >= points)
      {
        s->is_broken = 1;
        return;
      }
      ++places[s->keys[ids[0]] >> FINE_BITS];
    }
  }
}

static void move_cells(void* data, size_t begin, size_t end)
{
  const corner_job* const s = (const corner_job*)data;
  for (size_t part = begin; part < end; ++part)
  {
    size_t* const places = s->places[part];
    for (size_t i = part_begin(s, part); i < part_begin(s, part + 1); ++i)
    {
      const int64_t* const ids = s->job->grid.view.connectivity + 4 * i;
      const corners all = { (uint32_t)ids[0], (uint32_t)ids[1], (uint32_t)ids[2],
        (uint32_t)ids[3] };
      memcpy(s->out[places[s->keys[ids[0]] >> FINE_BITS]++], all, sizeof all);
    }
  }
}

/* One bucket in place: each cell that is not in its part of the bucket changes places with the next
 * one of that part. */
static void sort_bucket(const corner_job* s, size_t first, size_t last)
{
  size_t next[FINE] = { 0 }, end[FINE], at = first;
  for (size_t i = first; i < last; ++i)
  {
    ++next[s->keys[s->out[i][0]] & (FINE - 1)];
  }
  for (size_t k = 0; k < FINE; ++k)
  {
    end[k] = at + next[k];
    next[k] = at;
    at = end[k];
  }
  for (size_t k = 0; k < FINE; ++k)
  {
    while (next[k] < end[k])
    {
      corners cell;
      memcpy(cell, s->out[next[k]], sizeof cell);
      for (size_t to; (to = s->keys[cell[0]] & (FINE - 1)) != k;)
      {
        corners other;
        memcpy(other, s->out[next[to]], sizeof other);
        memcpy(s->out[next[to]++], cell, sizeof cell);
        memcpy(cell, other, sizeof cell);
      }
      memcpy(s->out[next[k]++], cell, sizeof cell);
    }
  }
}

/* Each bucket's end is where the last part's cells ended. */
static void sort_buckets(void* data, size_t begin, size_t end)
{
  const corner_job* const s = (const corner_job*)data;
  const size_t* const ends = s->places[PARTS - 1];
  for (size_t k = begin; k < end; ++k)
  {
    sort_bucket(s, k > 0 ? ends[k - 1] : 0, ends[k]);
  }
}

static chi_status sort_cells(corner_job* s)
{
  const chi_exec* const exec = s->job->exec;
  double high[3];
  chi_status status = chi_scatter_find_box(s->job, s->low, high);
  for (int a = 0; a < 3; ++a)
  {
    const double size = high[a] - s->low[a];
    const int cells = 1 << ((KEY_BITS + 2 - a) / 3);
    s->last[a] = cells - 1;
    s->scale[a] = size > 0 && isfinite(size) ? cells / size : 0;
  }
  const size_t chunks = chi_grid_chunks(s->job->grid.points, POINTS_A_CHUNK);
  status = status == CHI_OK ? chi_for(exec, chunks, make_keys, s) : status;
  status = status == CHI_OK ? chi_for(exec, PARTS, count_cells, s) : status;
  if (status != CHI_OK || s->is_broken)
  {
    return status == CHI_OK ? CHI_ERROR_INVALID_ARGUMENT : status;
  }
  size_t at = 0;
  for (size_t k = 0; k < COARSE; ++k)
  {
    for (size_t part = 0; part < PARTS; ++part)
    {
      const size_t count = s->places[part][k];
      s->places[part][k] = at;
      at += count;
    }
  }
  status = chi_for(exec, PARTS, move_cells, s);
  return status == CHI_OK ? chi_for(exec, COARSE, sort_buckets, s) : status;
}

chi_status chi_scatter_sort_corners(chi_scatter_job* job)
{
  chi_scatterplot* const keep = job->keep;
  const chi_exec* const exec = keep->has_exec ? &keep->exec : NULL;
  chi_buffer keys = { 0 }, places = { 0 };
  corner_job s = { .job = job };
  chi_status status = CHI_ERROR_OUT_OF_MEMORY;
  if (chi_buffer_reserve(exec, &keep->order, job->grid.cells, sizeof *s.out) &&
    chi_buffer_reserve(exec, &keys, job->grid.points, sizeof *s.keys) &&
    chi_buffer_reserve(exec, &places, PARTS, sizeof *s.places))
  {
    s.out = (corners*)keep->order.data;
    s.keys = (uint16_t*)keys.data;
    s.places = (size_t(*)[COARSE])places.data;
    status = sort_cells(&s);
  }
  job->corners = status == CHI_OK ? (const corners*)s.out : NULL;
  chi_buffer_free(exec, &keys);
  chi_buffer_free(exec, &places);
  return status;
}
