/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The cells that touch the inside of a polygon: those that its closed lines pass, and those with a
 * corner inside. A cell that none passes has all of its values on one side. */

#include "chi_fiber_internal.h"

enum
{
  TETRAHEDRA_A_CHUNK = 24576 /* whole cells of images, at six each */
};

typedef struct mask_job
{
  const chi_exec* exec;
  const chi_fiber_index* index;
  const chi_fiber_polygon* polygon;
  uint8_t* inside; /* [points] */
  uint8_t* mask;
} mask_job;

/* Closed lines that pass to the right of values, odd or not; the polygon moved by (e, e^2). */
static uint8_t is_inside(const chi_fiber_polygon* polygon, const double x[2])
{
  int odd = 0;
  for (size_t i = 0; i < polygon->count; ++i)
  {
    const chi_fiber_segment* const s = polygon->segment + i;
    const int p_above = s->p[1] >= x[1], q_above = s->q[1] >= x[1];
    double area;
    if (s->is_closed && p_above != q_above)
    {
      odd ^= chi_fiber_is_left(s, x, &area) == q_above;
    }
  }
  return (uint8_t)odd;
}

static int meets_any(const chi_fiber_polygon* polygon, const chi_fiber_range* box)
{
  for (size_t i = 0; i < polygon->count; ++i)
  {
    if (polygon->segment[i].is_closed && chi_fiber_meets(polygon->segment + i, box))
    {
      return 1;
    }
  }
  return 0;
}

static void look_at_runs(void* data, size_t begin, size_t end)
{
  const mask_job* const job = (const mask_job*)data;
  const chi_fiber_index* const x = job->index;
  const chi_fiber_polygon* const polygon = job->polygon;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    const size_t first = r * CHI_FIBER_RUN;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, x->points);
    const chi_fiber_range* const range = x->run + r;
    const int is_alike = range->low[0] <= range->high[0] && !meets_any(polygon, range);
    const uint8_t all = is_alike ? is_inside(polygon, range->low) : 0;
    for (size_t i = first; i < last; ++i)
    {
      job->inside[i] = is_alike ? all : is_inside(polygon, x->values[i]);
    }
  }
}

chi_status chi_fiber_find_inside(const chi_exec* exec, const chi_fiber_index* index,
  const chi_fiber_polygon* polygon, uint8_t* inside)
{
  mask_job job = { exec, index, polygon, inside, NULL };
  return chi_for(exec, index->runs, look_at_runs, &job);
}

static int is_left_out(const chi_fiber_index* x, size_t cell, int flags)
{
  const uint8_t* const ghosts = x->grid.view.cell_ghosts;
  return flags || (ghosts && ghosts[cell] & (CHI_GRID_DUPLICATE_CELL | CHI_GRID_HIDDEN_CELL));
}

/* Of an image's cell with this first point: what leaves it out as a whole. */
static int cell_flags(const chi_fiber_index* x, uint32_t first)
{
  int flags = 0;
  for (int k = 0; k < 8 && x->source == CHI_FIBER_KUHN; ++k)
  {
    flags |= x->flags[first + chi_fiber_step(x, k)];
  }
  return flags & (CHI_FIBER_BAD_PLACE | CHI_FIBER_HIDDEN);
}

/* Where the cell of a tetrahedron, or the next one, begins: chunks do not share cells. */
static size_t cell_start(const chi_fiber_index* x, size_t t)
{
  while (
    x->source == CHI_FIBER_LIST && t > 0 && t < x->tetrahedra && x->cells[t] == x->cells[t - 1])
  {
    ++t;
  }
  return t;
}

int chi_fiber_is_usable(const chi_fiber_index* x, size_t cell, const uint32_t v[4])
{
  int flags = cell_flags(x, v[0]);
  for (int k = 0; k < 4; ++k)
  {
    flags |= x->flags[v[k]];
  }
  return !is_left_out(x, cell, flags);
}

static void look_at_cells(void* data, size_t begin, size_t end)
{
  const mask_job* const job = (const mask_job*)data;
  const chi_fiber_index* const x = job->index;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t first = c * TETRAHEDRA_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, TETRAHEDRA_A_CHUNK, x->tetrahedra);
    for (size_t t = cell_start(x, first); t < cell_start(x, last); ++t)
    {
      uint32_t v[4];
      const size_t cell = chi_fiber_fetch(x, t, v);
      int inside = 0;
      for (int k = 0; k < 4; ++k)
      {
        inside |= job->inside[v[k]];
      }
      if (inside && chi_fiber_is_usable(x, cell, v))
      {
        job->mask[cell] = 1;
      }
    }
  }
}

chi_status chi_fiber_mask(const chi_exec* exec, const chi_fiber* fiber, uint8_t* mask)
{
  if (!fiber || (fiber->has_surface && fiber->index.grid.cells && !mask))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface)
  {
    return CHI_ERROR_NOT_READY;
  }
  const chi_fiber_index* const x = &fiber->index;
  if (x->grid.cells == 0)
  {
    return CHI_OK;
  }
  memset(mask, 0, x->grid.cells);
  mask_job job = { exec, x, &fiber->polygon, (uint8_t*)chi_alloc(exec, x->points + 1, 1), mask };
  if (!job.inside)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  const size_t chunks = chi_grid_chunks(x->tetrahedra, TETRAHEDRA_A_CHUNK);
  chi_status status = chi_fiber_find_inside(exec, x, job.polygon, job.inside);
  status = status == CHI_OK ? chi_for(exec, chunks, look_at_cells, &job) : status;
  for (size_t j = 0; j < fiber->pairs.jobs && status == CHI_OK; ++j)
  {
    const chi_fiber_job* const own = fiber->pairs.job + j;
    for (size_t p = 0; p < own->pairs; ++p)
    {
      const uint64_t code = fiber->pairs.pair[own->batch][own->first_pair + p];
      const size_t number = own->batch * CHI_FIBER_BATCH + code % CHI_FIBER_PAIR;
      uint32_t v[4];
      if (fiber->parts.size[own->first_part + p] && fiber->polygon.segment[number].is_closed)
      {
        mask[chi_fiber_fetch(x, code / CHI_FIBER_PAIR, v)] = 1;
      }
    }
  }
  chi_free(exec, job.inside, x->points + 1, 1);
  return status;
}
