/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Counts and splits grids, in fixed chunks of cells: look at each, add up, then write each where
 * the chunks before it end. */

#include "chi_grid_internal.h"

#include <math.h>

enum
{
  CELLS_A_CHUNK = 4096,
  CELLS_A_POLL = 256, /* polyhedra take some microseconds each */
  POINTS_A_CHUNK = 16384
};

typedef struct chunk
{
  chi_grid_counts counts;                /* of its cells */
  size_t first_tetrahedron, first_extra; /* where it writes */
} chunk;

typedef struct grid_job
{
  const chi_exec* exec;
  const chi_grid* grid;
  chunk* chunks;
  size_t chunk_count;
  uint8_t* ways; /* [cells] CHI_SPLIT_..., or NULL */
  const chi_grid_tetrahedra* out;
} grid_job;

static chi_grid_counts no_counts(const chi_grid* grid)
{
  return (chi_grid_counts){ .struct_size = sizeof(chi_grid_counts),
    .points = grid->points,
    .cells = grid->cells,
    .first_bad_cell = -1,
    .first_unsupported_type = -1,
    .bounds = { 1, -1, 1, -1, 1, -1 } };
}

static void widen(double bounds[6], const double low[3], const double high[3])
{
  const int empty = bounds[0] > bounds[1];
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = empty || low[a] < bounds[2 * a] ? low[a] : bounds[2 * a];
    bounds[2 * a + 1] = empty || high[a] > bounds[2 * a + 1] ? high[a] : bounds[2 * a + 1];
  }
}

/* Look at one cell; how it is split. */
static int count_cell(const chi_grid* grid, size_t index, chi_grid_counts* counts)
{
  chi_grid_cell cell;
  chi_cell_split split;
  int found = chi_cell_read(grid, index, &cell);
  if (found == CHI_CELL_GOOD && !chi_cell_locate(&cell))
  {
    found = CHI_CELL_NON_FINITE;
  }
  switch (found)
  {
    case CHI_CELL_GOOD:
      chi_cell_choose(&cell, &split);
      counts->tetrahedra += split.tetrahedra;
      counts->extra_points += split.way == CHI_SPLIT_CENTER;
      counts->flat_cells += split.flat;
      counts->folded_cells += (size_t)split.folded;
      counts->collapsed_tetrahedra += split.collapsed;
      counts->single_cells += split.tetrahedra == 1;
      counts->volume += split.volume;
      widen(counts->bounds, cell.low, cell.high);
      return split.way;
    case CHI_CELL_GHOST:
      ++counts->ghost_cells;
      break;
    case CHI_CELL_BLANKED:
      ++counts->blanked_cells;
      break;
    case CHI_CELL_FLAT_TYPE:
      ++counts->lower_dimensional_cells;
      break;
    case CHI_CELL_NON_FINITE:
      ++counts->non_finite_cells;
      break;
    case CHI_CELL_UNSUPPORTED:
      if (counts->unsupported_cells++ == 0)
      {
        counts->first_unsupported_type = grid->view.cell_types[index];
      }
      break;
    default:
      counts->first_bad_cell = counts->first_bad_cell < 0 ? (int64_t)index : counts->first_bad_cell;
      break;
  }
  return CHI_SPLIT_NONE;
}

static void count_chunks(void* data, size_t begin, size_t end)
{
  const grid_job* const job = (const grid_job*)data;
  for (size_t c = begin; c < end; ++c)
  {
    const size_t first = c * CELLS_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, CELLS_A_CHUNK, job->grid->cells);
    chi_grid_counts counts = no_counts(job->grid);
    for (size_t i = first; i < last; ++i)
    {
      if (i % CELLS_A_POLL == 0 && chi_is_cancelled(job->exec))
      {
        return;
      }
      const int way = count_cell(job->grid, i, &counts);
      if (job->ways)
      {
        job->ways[i] = (uint8_t)way;
      }
    }
    job->chunks[c].counts = counts;
  }
}

/* The chunks' counts in order, and where each begins to write. */
static void add_up(grid_job* job, chi_grid_counts* sum)
{
  for (size_t c = 0; c < job->chunk_count; ++c)
  {
    const chi_grid_counts* const counts = &job->chunks[c].counts;
    job->chunks[c].first_tetrahedron = sum->tetrahedra;
    job->chunks[c].first_extra = sum->extra_points;
    sum->tetrahedra += counts->tetrahedra;
    sum->extra_points += counts->extra_points;
    sum->ghost_cells += counts->ghost_cells;
    sum->blanked_cells += counts->blanked_cells;
    sum->lower_dimensional_cells += counts->lower_dimensional_cells;
    sum->unsupported_cells += counts->unsupported_cells;
    sum->non_finite_cells += counts->non_finite_cells;
    sum->flat_cells += counts->flat_cells;
    sum->folded_cells += counts->folded_cells;
    sum->collapsed_tetrahedra += counts->collapsed_tetrahedra;
    sum->single_cells += counts->single_cells;
    sum->volume += counts->volume;
    if (sum->first_bad_cell < 0)
    {
      sum->first_bad_cell = counts->first_bad_cell;
    }
    if (sum->first_unsupported_type < 0)
    {
      sum->first_unsupported_type = counts->first_unsupported_type;
    }
    const double* const b = counts->bounds;
    if (b[0] <= b[1])
    {
      widen(
        sum->bounds, (const double[3]){ b[0], b[2], b[4] }, (const double[3]){ b[1], b[3], b[5] });
    }
  }
}

static chi_status count_all(grid_job* job, chi_grid_counts* sum)
{
  *sum = no_counts(job->grid);
  const chi_status status = chi_for(job->exec, job->chunk_count, count_chunks, job);
  if (status != CHI_OK)
  {
    return status;
  }
  add_up(job, sum);
  if (sum->first_bad_cell >= 0)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  return sum->extra_points > UINT32_MAX - (size_t)1 - sum->points ? CHI_ERROR_TOO_LARGE : CHI_OK;
}

chi_status chi_grid_count(const chi_exec* exec, const chi_grid_view* view, chi_grid_counts* counts)
{
  chi_grid grid;
  if (!counts)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_grid_open(&grid, view);
  *counts = no_counts(&grid);
  if (status != CHI_OK || grid.cells == 0)
  {
    return status;
  }
  grid_job job = {
    .exec = exec, .grid = &grid, .chunk_count = chi_grid_chunks(grid.cells, CELLS_A_CHUNK)
  };
  job.chunks = (chunk*)chi_alloc(exec, job.chunk_count, sizeof *job.chunks);
  if (!job.chunks)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  status = count_all(&job, counts);
  chi_free(exec, job.chunks, job.chunk_count, sizeof *job.chunks);
  if (status != CHI_OK)
  {
    const int64_t bad = status == CHI_ERROR_INVALID_ARGUMENT ? counts->first_bad_cell : -1;
    *counts = no_counts(&grid);
    counts->first_bad_cell = bad;
  }
  return status;
}

/* Write one cell's tetrahedra from `at`, its centre as extra point `extra`; how many they are. */
static size_t write_cell(const grid_job* job, size_t index, size_t at, size_t extra)
{
  const chi_grid_tetrahedra* const out = job->out;
  const size_t center_id = job->grid->points + extra;
  const int way = job->ways[index];
  chi_grid_cell cell;
  chi_cell_read(job->grid, index, &cell);
  if (way == CHI_SPLIT_SIGNED || way == CHI_SPLIT_CENTER)
  {
    chi_cell_locate(&cell);
  }
  if (way == CHI_SPLIT_CENTER)
  {
    chi_cell_find_center(&cell);
    if (out->points)
    {
      memcpy(out->points + 3 * center_id, cell.center, sizeof cell.center);
    }
    if (out->extra_cells)
    {
      out->extra_cells[extra] = (uint32_t)index;
    }
  }
  uint32_t(*const vertices)[4] = (uint32_t(*)[4])(void*)out->vertices;
  const size_t count = chi_cell_write(&cell, way, (uint32_t)center_id, vertices + at);
  for (size_t t = 0; t < count && out->cells; ++t)
  {
    out->cells[at + t] = (uint32_t)index;
  }
  return count;
}

static void write_chunks(void* data, size_t begin, size_t end)
{
  const grid_job* const job = (const grid_job*)data;
  for (size_t c = begin; c < end; ++c)
  {
    const size_t first = c * CELLS_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, CELLS_A_CHUNK, job->grid->cells);
    size_t at = job->chunks[c].first_tetrahedron, extra = job->chunks[c].first_extra;
    for (size_t i = first; i < last; ++i)
    {
      if (i % CELLS_A_POLL == 0 && chi_is_cancelled(job->exec))
      {
        return;
      }
      if (job->ways[i] != CHI_SPLIT_NONE)
      {
        at += write_cell(job, i, at, extra);
        extra += job->ways[i] == CHI_SPLIT_CENTER;
      }
    }
  }
}

static void write_points(void* data, size_t begin, size_t end)
{
  const grid_job* const job = (const grid_job*)data;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t first = c * POINTS_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, POINTS_A_CHUNK, job->grid->points);
    for (size_t i = first; i < last; ++i)
    {
      chi_grid_point(job->grid, i, job->out->points + 3 * i);
    }
  }
}

static chi_status split(grid_job* job, const chi_grid_counts* told)
{
  chi_grid_counts counts;
  chi_status status = count_all(job, &counts);
  if (status == CHI_OK &&
    (counts.tetrahedra != told->tetrahedra || counts.extra_points != told->extra_points))
  {
    status = CHI_ERROR_INVALID_ARGUMENT;
  }
  if (status == CHI_OK)
  {
    status = chi_for(job->exec, job->chunk_count, write_chunks, job);
  }
  if (status == CHI_OK && job->out->points)
  {
    status =
      chi_for(job->exec, chi_grid_chunks(job->grid->points, POINTS_A_CHUNK), write_points, job);
  }
  return status;
}

chi_status chi_grid_split(const chi_exec* exec, const chi_grid_view* view,
  const chi_grid_counts* given_counts, const chi_grid_tetrahedra* given_out)
{
  chi_grid grid;
  chi_grid_counts counts;
  chi_grid_tetrahedra out;
  if (!given_counts || !CHI_ADOPT(chi_grid_counts, bounds, &counts, given_counts) || !given_out ||
    !CHI_ADOPT(chi_grid_tetrahedra, extra_cells, &out, given_out) ||
    (counts.tetrahedra > 0 && !out.vertices))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_grid_open(&grid, view);
  if (status == CHI_OK && (counts.points != grid.points || counts.cells != grid.cells))
  {
    status = CHI_ERROR_INVALID_ARGUMENT;
  }
  if (status != CHI_OK)
  {
    return status;
  }
  grid_job job = { .exec = exec,
    .grid = &grid,
    .chunk_count = chi_grid_chunks(grid.cells, CELLS_A_CHUNK),
    .out = &out };
  /* one more than there may be, since none are refused */
  job.chunks = (chunk*)chi_alloc(exec, job.chunk_count + 1, sizeof *job.chunks);
  job.ways = (uint8_t*)chi_alloc(exec, grid.cells + 1, 1);
  status = job.chunks && job.ways ? split(&job, &counts) : CHI_ERROR_OUT_OF_MEMORY;
  if (job.ways)
  {
    chi_free(exec, job.ways, grid.cells + 1, 1);
  }
  if (job.chunks)
  {
    chi_free(exec, job.chunks, job.chunk_count + 1, sizeof *job.chunks);
  }
  return status;
}
