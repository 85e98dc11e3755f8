/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* One number of every tuple, and of the centres of cells. */

#include "chi_grid_internal.h"

#include <math.h>
#include <stdatomic.h>

enum
{
  VALUES_A_CHUNK = 16384
};

typedef struct scalar_job
{
  const chi_exec* exec;
  const chi_grid* grid;
  const chi_array_view* values;
  int32_t component;
  const uint32_t* extra_cells;
  size_t extra_count;
  float* scalars;
  atomic_int refused;
} scalar_job;

static double value_of(const scalar_job* job, size_t tuple)
{
  const chi_array_view* const a = job->values;
  const char* const at = (const char*)a->data + tuple * a->stride;
  const size_t size = chi_type_size(a->type);
  if (job->component >= 0)
  {
    return chi_number_at(at + (size_t)job->component * size, a->type);
  }
  double square = 0;
  for (size_t k = 0; k < a->components; ++k)
  {
    const double x = chi_number_at(at + k * size, a->type);
    square += x * x;
  }
  return sqrt(square);
}

static float mean_of(scalar_job* job, size_t index)
{
  chi_grid_cell cell;
  const int found =
    index < job->grid->cells ? chi_cell_read(job->grid, index, &cell) : CHI_CELL_BROKEN;
  if (found != CHI_CELL_GOOD)
  {
    job->refused = 1;
    return NAN;
  }
  double sum = 0;
  for (size_t k = 0; k < cell.count; ++k)
  {
    sum += value_of(job, (size_t)cell.ids[k]);
  }
  return (float)(sum / (double)cell.count);
}

static void find_scalars(void* data, size_t begin, size_t end)
{
  scalar_job* const job = (scalar_job*)data;
  const size_t tuples = job->values->count, count = tuples + job->extra_count;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t first = c * VALUES_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, VALUES_A_CHUNK, count);
    for (size_t i = first; i < last; ++i)
    {
      job->scalars[i] =
        i < tuples ? (float)value_of(job, i) : mean_of(job, job->extra_cells[i - tuples]);
    }
  }
}

chi_status chi_grid_scalars(const chi_exec* exec, const chi_grid_view* view,
  const chi_array_view* values, int32_t component, const uint32_t* extra_cells, size_t extra_count,
  float* scalars)
{
  chi_grid grid;
  if (!chi_array_is_valid(values) || component < -1 ||
    (component >= 0 && (size_t)component >= values->components) || (extra_count && !extra_cells) ||
    extra_count > UINT32_MAX || (values->count + extra_count && !scalars))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (extra_count > 0)
  {
    const chi_status status = chi_grid_open(&grid, view);
    if (status != CHI_OK || grid.points != values->count)
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
  }
  scalar_job job = { .exec = exec,
    .grid = &grid,
    .values = values,
    .component = component,
    .extra_cells = extra_cells,
    .extra_count = extra_count,
    .scalars = scalars };
  const size_t count = values->count + extra_count;
  const size_t chunks = chi_grid_chunks(count, VALUES_A_CHUNK);
  const chi_status status = chi_for(exec, chunks, find_scalars, &job);
  return status == CHI_OK && job.refused ? CHI_ERROR_INVALID_ARGUMENT : status;
}
