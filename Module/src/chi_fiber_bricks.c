/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Ranges of values of an index by bricks of cells, and the cells there that are left out. */

#include "chi_fiber_internal.h"

enum
{
  VTK_TETRAHEDRON_TYPE = 10
};

static int is_ghost(const chi_fiber_index* x, size_t cell)
{
  const uint8_t* const ghosts = x->grid.view.cell_ghosts;
  return ghosts && ghosts[cell] & (CHI_GRID_DUPLICATE_CELL | CHI_GRID_HIDDEN_CELL);
}

/* Count why a cell is left out; 0: it is not. */
static int count_bad(size_t sums[CHI_FIBER_SUMS], int hidden, int flags)
{
  if (hidden || flags & CHI_FIBER_HIDDEN)
  {
    ++sums[2];
    return 1;
  }
  sums[1] += (flags & CHI_FIBER_BAD_PLACE) != 0;
  sums[0] += (flags & (CHI_FIBER_BAD_PLACE | CHI_FIBER_BAD_VALUE)) == CHI_FIBER_BAD_VALUE;
  return flags != 0;
}

static chi_fiber_range range_of(const double* values, const int64_t* id, const int64_t* end)
{
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  for (; id < end; ++id)
  {
    const double* const value = values + 2 * *id;
    for (int k = 0; k < 2; ++k)
    {
      low[k] = value[k] < low[k] ? value[k] : low[k];
      high[k] = value[k] > high[k] ? value[k] : high[k];
    }
  }
  return (chi_fiber_range){ { low[0], low[1] }, { high[0], high[1] } };
}

/* Of the tetrahedra that are not left out; these are counted. */
static chi_fiber_range range_of_good(
  chi_fiber_index_job* job, size_t brick, size_t first, size_t last)
{
  const chi_fiber_index* const x = job->index;
  const int64_t* const ids = x->grid.view.connectivity + x->grid.view.offsets[0];
  chi_fiber_range range = chi_fiber_no_range;
  for (size_t t = first; t < last; ++t)
  {
    const int64_t* const p = ids + 4 * t;
    const int flags = x->flags[p[0]] | x->flags[p[1]] | x->flags[p[2]] | x->flags[p[3]];
    if (!count_bad(job->sums[brick], is_ghost(x, t), flags))
    {
      for (int k = 0; k < 4; ++k)
      {
        chi_fiber_widen(&range, x->values[p[k]]);
      }
    }
  }
  return range;
}

static void read_direct(chi_fiber_index_job* job, size_t brick)
{
  chi_fiber_index* const x = job->index;
  const chi_grid_view* const v = &x->grid.view;
  const size_t first = brick * CHI_FIBER_LIST_BRICK;
  const size_t last = chi_grid_chunk_end(first, CHI_FIBER_LIST_BRICK, x->tetrahedra);
  const int64_t* const ids = v->connectivity + v->offsets[0];
  const size_t points = x->grid.points;
  int others = 0, beyond = 0;
  for (size_t t = first; t < last; ++t)
  {
    others |= v->cell_types[t] != VTK_TETRAHEDRON_TYPE;
    others |= v->offsets[t + 1] - v->offsets[t] != 4;
  }
  for (size_t k = 4 * first; k < 4 * last; ++k)
  {
    beyond |= (uint64_t)ids[k] >= points;
  }
  if (others || beyond)
  {
    job->is_broken = 1;
    return;
  }
  x->brick[brick] = job->all_flags || v->cell_ghosts
    ? range_of_good(job, brick, first, last)
    : range_of(x->values[0], ids + 4 * first, ids + 4 * last);
}

static void read_list(chi_fiber_index_job* job, size_t brick)
{
  chi_fiber_index* const x = job->index;
  const size_t first = brick * CHI_FIBER_LIST_BRICK;
  const size_t last = chi_grid_chunk_end(first, CHI_FIBER_LIST_BRICK, x->tetrahedra);
  chi_fiber_range range = chi_fiber_no_range;
  for (size_t t = first; t < last; ++t)
  {
    const uint32_t* const p = x->vertices[t];
    const uint8_t* const f = x->flags;
    if ((f[p[0]] | f[p[1]] | f[p[2]] | f[p[3]]) & CHI_FIBER_BAD_VALUE)
    {
      /* of a cell's tetrahedra the first counts */
      int counts = 1;
      for (size_t u = t; counts && u > 0 && x->cells[u - 1] == x->cells[t]; --u)
      {
        const uint32_t* const q = x->vertices[u - 1];
        counts = !((f[q[0]] | f[q[1]] | f[q[2]] | f[q[3]]) & CHI_FIBER_BAD_VALUE);
      }
      job->sums[brick][0] += (size_t)counts;
      continue;
    }
    for (int k = 0; k < 4; ++k)
    {
      chi_fiber_widen(&range, x->values[p[k]]);
    }
  }
  x->brick[brick] = range;
}

static void read_block(chi_fiber_index_job* job, size_t brick)
{
  chi_fiber_index* const x = job->index;
  size_t low[3], high[3];
  chi_fiber_block(x, brick, low, high);
  chi_fiber_range range = chi_fiber_no_range;
  int all = 0;
  for (size_t k = low[2]; k <= high[2]; ++k)
  {
    for (size_t j = low[1]; j <= high[1]; ++j)
    {
      const size_t row = chi_fiber_first_point(x, (const size_t[3]){ 0, j, k });
      for (size_t i = row + low[0]; i <= row + high[0]; ++i)
      {
        all |= x->flags[i];
        if (!(x->flags[i] & CHI_FIBER_BAD_VALUE))
        {
          chi_fiber_widen(&range, x->values[i]);
        }
      }
    }
  }
  x->brick[brick] = range;
  if (!all && !x->grid.view.cell_ghosts)
  {
    return;
  }
  for (size_t k = low[2]; k < high[2]; ++k)
  {
    for (size_t j = low[1]; j < high[1]; ++j)
    {
      for (size_t i = low[0]; i < high[0]; ++i)
      {
        const size_t first = chi_fiber_first_point(x, (const size_t[3]){ i, j, k });
        int flags = 0;
        for (int p = 0; p < 8; ++p)
        {
          flags |= x->flags[first + chi_fiber_step(x, p)];
        }
        const size_t* const n = x->grid.dimensions;
        count_bad(job->sums[brick], is_ghost(x, i + n[0] * (j + n[1] * k)), flags);
      }
    }
  }
}

void chi_fiber_read_bricks(void* data, size_t begin, size_t end)
{
  chi_fiber_index_job* const job = (chi_fiber_index_job*)data;
  for (size_t b = begin; b < end; ++b)
  {
    if (job->is_broken || (b % 16 == 0 && chi_is_cancelled(job->exec)))
    {
      return;
    }
    switch (job->index->source)
    {
      case CHI_FIBER_DIRECT:
        read_direct(job, b);
        break;
      case CHI_FIBER_LIST:
        read_list(job, b);
        break;
      default:
        read_block(job, b);
        break;
    }
  }
}
