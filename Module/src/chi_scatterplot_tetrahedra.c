/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Runs of lists that hold nothing but tetrahedra, in tight loops. */

#include "chi_scatterplot_internal.h"

#include <math.h>

/* Points of a run's cells into the block; 0 where one is not there. */
static int load_ids(const chi_scatter_job* job, size_t first, size_t count, chi_scatter_block* b)
{
  uint32_t* const id[4] = { b->ids, b->ids + b->capacity, b->ids + 2 * b->capacity,
    b->ids + 3 * b->capacity };
  if (job->corners)
  {
    for (size_t i = 0; i < count; ++i)
    {
      const uint32_t* const from = job->corners[first + i];
      id[0][i] = from[0];
      id[1][i] = from[1];
      id[2][i] = from[2];
      id[3][i] = from[3];
    }
    return 1; /* the sort has looked */
  }
  const int64_t* const from = job->grid.view.connectivity + 4 * first;
  const uint64_t points = job->grid.points;
  int are_there = 1;
  for (size_t i = 0; i < count; ++i)
  {
    for (size_t c = 0; c < 4; ++c)
    {
      are_there &= (uint64_t)from[4 * i + c] < points;
      id[c][i] = (uint32_t)from[4 * i + c];
    }
  }
  return are_there;
}

/* Volumes of the block's cells, NaN where a point is not finite. */
static void find_volumes(const chi_scatter_job* job, size_t count, chi_scatter_block* b)
{
  const chi_vec3_view* const points = &job->grid.view.points;
  const char* const data = (const char*)points->data;
  const size_t stride = points->stride;
#define VOLUMES(type)                                                                              \
  for (size_t i = 0; i < count; ++i)                                                               \
  {                                                                                                \
    double x[4][3], reach = 0;                                                                     \
    for (size_t c = 0; c < 4; ++c)                                                                 \
    {                                                                                              \
      type p[3];                                                                                   \
      memcpy(p, data + b->ids[c * b->capacity + i] * stride, sizeof p);                            \
      for (int a = 0; a < 3; ++a)                                                                  \
      {                                                                                            \
        x[c][a] = (double)p[a];                                                                    \
        const double far = fabs(x[c][a]); /* NaN makes the volume NaN */                           \
        reach = far > reach ? far : reach;                                                         \
      }                                                                                            \
    }                                                                                              \
    const double volume = chi_scatter_volume6(x[0], x[1], x[2], x[3]) / 6;                         \
    b->mass[i] = reach <= CHI_SCATTER_LARGEST ? volume : NAN;                                      \
  }
  if (points->type == CHI_F64)
  {
    VOLUMES(double)
  }
  else
  {
    VOLUMES(float)
  }
#undef VOLUMES
}

static void find_masses(
  const chi_scatter_job* job, size_t first, size_t count, chi_scatter_block* b)
{
  find_volumes(job, count, b);
  for (size_t i = 0; i < count && job->input.weight.data; ++i)
  {
    int64_t ids[4];
    for (size_t c = 0; c < 4; ++c)
    {
      ids[c] = b->ids[c * b->capacity + i];
    }
    b->mass[i] *= chi_scatter_weight(job, first + i, ids, 4);
  }
}

/* All of the block into its piece; 0 where a number is not finite. */
static int add_up(
  const chi_scatter_job* job, size_t count, const chi_scatter_block* b, chi_scatter_piece* piece)
{
  double mass[4] = { 0, 0, 0, 0 }, size[4] = { 0, 0, 0, 0 };
  const double* const values[2] = { b->x, b->y };
  int are_finite = 1;
  for (size_t i = 0; i < count; ++i)
  {
    mass[i & 3] += b->mass[i];
    size[i & 3] += fabs(b->mass[i]);
  }
  const double sum = (mass[0] + mass[1]) + (mass[2] + mass[3]);
  for (int f = 0; f < 2; ++f)
  {
    for (size_t c = 0; c < 4; ++c)
    {
      double low, high;
      are_finite &= job->kernels->extremes(values[f] + c * b->capacity, count, &low, &high);
      piece->low[f] = low < piece->low[f] ? low : piece->low[f];
      piece->high[f] = high > piece->high[f] ? high : piece->high[f];
    }
  }
  piece->cells = piece->simplices = (uint32_t)count;
  piece->mass = sum;
  piece->size = (size[0] + size[1]) + (size[2] + size[3]);
  return are_finite && isfinite(piece->size);
}

void chi_scatter_visit_tetrahedra(
  chi_scatter_job* job, size_t run, chi_scatter_worker* w, chi_scatter_piece* piece)
{
  static const chi_scatter_piece nothing = { .low = { INFINITY, INFINITY },
    .high = { -INFINITY, -INFINITY } };
  chi_scatter_block* const b = &w->block;
  size_t first, last;
  chi_scatter_find_run(job, run, &first, &last);
  const size_t count = last - first;
  if (!chi_scatter_reserve_block(job, w, count))
  {
    return;
  }
  if (!load_ids(job, first, count, b))
  {
    job->failed = CHI_ERROR_INVALID_ARGUMENT;
    return;
  }
  b->count = count;
  if (job->masses && !piece)
  {
    memcpy(b->mass, job->masses + first, count * sizeof *b->mass);
  }
  else
  {
    find_masses(job, first, count, b);
  }
  if (job->masses && piece)
  {
    memcpy(job->masses + first, b->mass, count * sizeof *b->mass);
  }
  chi_scatter_gather_block(job, b);
  int are_finite = piece || job->pieces[run].skipped == 0;
  if (piece)
  {
    *piece = nothing;
    are_finite = add_up(job, count, b, piece);
    *piece = are_finite ? *piece : nothing;
  }
  if (!are_finite)
  {
    for (size_t i = 0; i < count; ++i)
    {
      b->cell[i] = (uint32_t)i;
    }
    chi_scatter_look_through(b, 4, piece);
  }
  if (!piece)
  {
    chi_scatter_deposit_block(job, w, run);
  }
  b->count = 0;
}
