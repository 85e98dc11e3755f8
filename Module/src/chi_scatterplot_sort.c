/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * An order of space for lists of cells whose neighbours in the list are not neighbours in the mesh:
 * runs of such lists share no edges, and their images are all over the plot. Cells are put in
 * Morton order of their first points, coarse enough that a run is a few buckets.
 */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  AXIS_BITS = 6,
  PASS_BITS = 9, /* two passes for three axes */
  BUCKETS = 1 << PASS_BITS,
  PARTS = 32, /* of the list, whatever the number of threads */
  SAMPLES = 16
};

typedef struct entry
{
  uint32_t key, cell;
} entry;

typedef struct sort_job
{
  const chi_scatter_job* job;
  entry *from, *to;
  size_t (*counts)[BUCKETS]; /* of each part */
  double low[3], scale[3];
  int shift;
} sort_job;

static size_t part_begin(const sort_job* s, size_t part)
{
  const size_t n = s->job->grid.cells;
  return n / PARTS * part + n % PARTS * part / PARTS;
}

/* The first point of a cell; 0 where it has none that is finite. */
static int first_point(const chi_scatter_job* job, size_t cell, double x[3])
{
  const chi_grid_view* const v = &job->grid.view;
  const int64_t at = v->offsets[cell];
  if (at < 0 || (uint64_t)at >= v->connectivity_count || v->connectivity[at] < 0 ||
    (uint64_t)v->connectivity[at] >= job->grid.points)
  {
    return 0;
  }
  chi_grid_point(&job->grid, (size_t)v->connectivity[at], x);
  return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

typedef struct box_job
{
  const chi_grid* grid;
  double bounds[PARTS][6];
} box_job;

static void find_bounds(void* data, size_t begin, size_t end)
{
  box_job* const s = (box_job*)data;
  const size_t n = s->grid->points;
  for (size_t part = begin; part < end; ++part)
  {
    double* const b = s->bounds[part];
    for (int a = 0; a < 3; ++a)
    {
      b[2 * a] = INFINITY;
      b[2 * a + 1] = -INFINITY;
    }
    for (size_t i = n / PARTS * part; i < (part + 1 < PARTS ? n / PARTS * (part + 1) : n); ++i)
    {
      double x[3];
      chi_grid_point(s->grid, i, x);
      for (int a = 0; a < 3; ++a)
      {
        /* infinite ones would leave no scale; their cells are left out anyway */
        b[2 * a] = x[a] < b[2 * a] && x[a] > -INFINITY ? x[a] : b[2 * a];
        b[2 * a + 1] = x[a] > b[2 * a + 1] && x[a] < INFINITY ? x[a] : b[2 * a + 1];
      }
    }
  }
}

chi_status chi_scatter_find_box(const chi_scatter_job* job, double low[3], double high[3])
{
  box_job s = { .grid = &job->grid };
  const chi_status status = chi_for(job->exec, PARTS, find_bounds, &s);
  for (int a = 0; a < 3; ++a)
  {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (size_t part = 0; part < PARTS && status == CHI_OK; ++part)
    {
      const double* const b = s.bounds[part] + 2 * a;
      low[a] = b[0] < low[a] ? b[0] : low[a];
      high[a] = b[1] > high[a] ? b[1] : high[a];
    }
  }
  return status;
}

/* Points of cells further on, which may be anywhere. */
static void fetch_ahead(const chi_scatter_job* job, size_t i)
{
  enum
  {
    FAR = 64
  };
  const chi_grid_view* const v = &job->grid.view;
  if (i + FAR < job->grid.cells)
  {
    const int64_t at = v->offsets[i + FAR];
    if (at >= 0 && (uint64_t)at < v->connectivity_count &&
      (uint64_t)v->connectivity[at] < job->grid.points)
    {
      __builtin_prefetch(
        (const char*)v->points.data + (size_t)v->connectivity[at] * v->points.stride);
    }
  }
}

static uint32_t key_of(const sort_job* s, size_t cell)
{
  double x[3];
  uint32_t key = 0;
  if (!first_point(s->job, cell, x))
  {
    return 0;
  }
  for (int a = 0; a < 3; ++a)
  {
    const uint32_t k = (uint32_t)((x[a] - s->low[a]) * s->scale[a]);
    for (int bit = 0; bit < AXIS_BITS; ++bit)
    {
      key |= (k >> bit & 1) << (3 * bit + a);
    }
  }
  return key;
}

static void make_keys(void* data, size_t begin, size_t end)
{
  const sort_job* const s = (const sort_job*)data;
  for (size_t part = begin; part < end; ++part)
  {
    for (size_t i = part_begin(s, part); i < part_begin(s, part + 1); ++i)
    {
      fetch_ahead(s->job, i);
      s->from[i] = (entry){ key_of(s, i), (uint32_t)i };
    }
  }
}

static void count_keys(void* data, size_t begin, size_t end)
{
  const sort_job* const s = (const sort_job*)data;
  for (size_t part = begin; part < end; ++part)
  {
    memset(s->counts[part], 0, sizeof s->counts[part]);
    for (size_t i = part_begin(s, part); i < part_begin(s, part + 1); ++i)
    {
      ++s->counts[part][s->from[i].key >> s->shift & (BUCKETS - 1)];
    }
  }
}

static void move_entries(void* data, size_t begin, size_t end)
{
  const sort_job* const s = (const sort_job*)data;
  for (size_t part = begin; part < end; ++part)
  {
    for (size_t i = part_begin(s, part); i < part_begin(s, part + 1); ++i)
    {
      s->to[s->counts[part][s->from[i].key >> s->shift & (BUCKETS - 1)]++] = s->from[i];
    }
  }
}

/* One stable pass: buckets in order, parts in order within. */
static chi_status sort_pass(sort_job* s)
{
  chi_status status = chi_for(s->job->exec, PARTS, count_keys, s);
  size_t at = 0;
  for (size_t bucket = 0; bucket < BUCKETS; ++bucket)
  {
    for (size_t part = 0; part < PARTS; ++part)
    {
      const size_t count = s->counts[part][bucket];
      s->counts[part][bucket] = at;
      at += count;
    }
  }
  if (status == CHI_OK)
  {
    status = chi_for(s->job->exec, PARTS, move_entries, s);
  }
  entry* const t = s->from;
  s->from = s->to;
  s->to = t;
  s->shift += PASS_BITS;
  return status;
}

static chi_status sort_cells(sort_job* s)
{
  double high[3];
  chi_status status = chi_scatter_find_box(s->job, s->low, high);
  if (status != CHI_OK)
  {
    return status;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double size = high[a] - s->low[a];
    s->scale[a] = size > 0 && isfinite(size) ? ((1 << AXIS_BITS) - 0.001) / size : 0;
  }
  status = chi_for(s->job->exec, PARTS, make_keys, s);
  status = status == CHI_OK ? sort_pass(s) : status;
  return status == CHI_OK ? sort_pass(s) : status;
}

/* Whether runs have nearly as many points as corners, in samples of the list. */
static int is_scattered(const chi_scatter_job* job)
{
  enum
  {
    SLOTS = 32768
  };
  const chi_grid_view* const v = &job->grid.view;
  uint32_t slots[SLOTS];
  size_t corners = 0, points = 0;
  for (size_t k = 0; k < SAMPLES; ++k)
  {
    const size_t first = (job->grid.cells - CHI_SCATTER_RUN) / (SAMPLES - 1) * k;
    memset(slots, 0xff, sizeof slots);
    size_t held = 0;
    for (size_t i = first; i < first + CHI_SCATTER_RUN && held < SLOTS / 2; ++i)
    {
      const int64_t begin = v->offsets[i], end = v->offsets[i + 1];
      const int is_good =
        begin >= 0 && end - begin <= CHI_CELL_POINTS && (uint64_t)end <= v->connectivity_count;
      for (int64_t c = begin; c < end && is_good; ++c)
      {
        const uint32_t id = (uint32_t)v->connectivity[c];
        uint32_t slot = id * 2654435761u >> 17;
        while (slots[slot] != UINT32_MAX && slots[slot] != id)
        {
          slot = (slot + 1) & (SLOTS - 1);
        }
        held += slots[slot] != id;
        slots[slot] = id;
        ++corners;
      }
    }
    points += held;
  }
  /* split cubes in rows have 0.17 points a corner, cells at random nearly 1 */
  return points > corners / 2;
}

chi_status chi_scatter_sort(chi_scatter_job* job)
{
  chi_scatterplot* const keep = job->keep;
  const chi_exec* const exec = keep->has_exec ? &keep->exec : NULL;
  const uint32_t switches = job->params.switches;
  job->order = NULL;
  job->corners = NULL;
  if (job->grid.view.kind != CHI_GRID_UNSTRUCTURED || job->grid.cells < 2 * CHI_SCATTER_RUN ||
    switches & CHI_SCATTERPLOT_NO_SORT || job->input.association == CHI_SCATTERPLOT_CELLS)
  {
    return CHI_OK;
  }
  const uint64_t version = job->grid.view.version;
  /* weights of cells need their numbers */
  const int has_corners = job->is_uniform &&
    !(job->input.weight.data && job->input.weight_association == CHI_SCATTERPLOT_CELLS);
  if (version && version == keep->order_version && has_corners == keep->order_has_corners)
  {
    job->order = has_corners ? NULL : (const uint32_t*)keep->order.data;
    job->corners = has_corners ? (const uint32_t(*)[4])keep->order.data : NULL;
    return CHI_OK;
  }
  if (!(switches & CHI_SCATTERPLOT_ALWAYS_SORT) && !is_scattered(job))
  {
    return CHI_OK;
  }
  keep->order_version = 0;
  keep->order_has_corners = has_corners;
  if (has_corners)
  {
    chi_buffer_free(exec, &keep->masses);
    const chi_status status = chi_scatter_sort_corners(job);
    keep->order_version = status == CHI_OK ? version : 0;
    return status;
  }
  chi_buffer other = { 0 }, small = { 0 };
  sort_job s = { .job = job };
  chi_status status = CHI_ERROR_OUT_OF_MEMORY;
  if (chi_buffer_reserve(exec, &keep->order, job->grid.cells, sizeof(entry)) &&
    chi_buffer_reserve(exec, &other, job->grid.cells, sizeof(entry)) &&
    chi_buffer_reserve(exec, &small, PARTS, sizeof *s.counts))
  {
    s.from = (entry*)keep->order.data;
    s.to = (entry*)other.data;
    s.counts = (size_t(*)[BUCKETS])small.data;
    status = sort_cells(&s);
  }
  if (status == CHI_OK) /* two passes: in place, the cells alone */
  {
    uint32_t* const cells = (uint32_t*)keep->order.data;
    for (size_t i = 0; i < job->grid.cells; ++i)
    {
      entry e;
      memcpy(&e, (const char*)keep->order.data + i * sizeof e, sizeof e);
      cells[i] = e.cell;
    }
    job->order = cells;
    keep->order_version = version;
  }
  chi_buffer_free(exec, &other);
  chi_buffer_free(exec, &small);
  return status;
}
