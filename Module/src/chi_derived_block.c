/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Derivatives on structured grids, one after the other along the axes: a block of rows goes through
 * a range of planes with the planes that the stencils reach in a ring, so that every row is read
 * and converted once a block and all else stays in cache.
 */

#include "chi_derived_plan.h"

/* One block under way. */
typedef struct block
{
  const chi_derived_plan* plan;
  size_t first_row, end_row; /* whose results are wanted */
  size_t low_row, high_row;  /* that these reach */
  size_t loaded;             /* planes up to here are in the ring */
  char* samples;             /* [fields][width][rows of the ring][nx] */
  char* across;              /* [fields][width][block_rows][nx]: derivatives along y */
  char* spare;               /* [4][nx]: results that nobody wants or that get narrower */
  chi_derived_rows rows;
  chi_derived_counts* counts;
} block;

/*------------------------------------------------------------------------------------------------*/
static size_t ring_rows(const chi_derived_plan* p)
{
  return p->block_rows + p->axis[1].width - 1;
}

static char* sample_row(const block* b, size_t field, size_t plane, size_t row)
{
  const chi_derived_plan* const p = b->plan;
  const size_t slot = plane % p->axis[2].width;
  return b->samples +
    ((field * p->axis[2].width + slot) * ring_rows(p) + row - b->low_row) * p->row_bytes;
}

static char* across_row(const block* b, size_t field, size_t plane, size_t row)
{
  const chi_derived_plan* const p = b->plan;
  const size_t slot = plane % p->axis[2].width;
  return b->across +
    ((field * p->axis[2].width + slot) * p->block_rows + row - b->first_row) * p->row_bytes;
}

/* The samples that have weight at i of an axis, the middle one apart. */
static size_t list_taps(
  const chi_derived_axis* axis, size_t i, int derivative, size_t at[], double weight[])
{
  size_t taps = 0;
  for (size_t k = 0; k < axis->width; ++k)
  {
    const double w = axis->weights[derivative][i * CHI_DERIVED_WIDTH + k];
    if (w != 0 && axis->start[i] + k != i)
    {
      at[taps] = axis->start[i] + k;
      weight[taps++] = w;
    }
  }
  return taps;
}

static void derive_along_y(
  const block* b, size_t field, size_t plane, size_t row, int derivative, void* out)
{
  const chi_derived_plan* const p = b->plan;
  size_t at[CHI_DERIVED_WIDTH];
  double weight[CHI_DERIVED_WIDTH];
  const void* rows[CHI_DERIVED_WIDTH];
  const size_t taps = list_taps(&p->axis[1], row, derivative, at, weight);
  for (size_t k = 0; k < taps; ++k)
  {
    rows[k] = sample_row(b, field, plane, at[k]);
  }
  p->kernels->across(p->n[0], taps, weight, rows, sample_row(b, field, plane, row), out);
}

/* Of the samples, or of their derivatives along y. */
static void derive_along_z(const block* b, size_t field, size_t plane, size_t row, int derivative,
  char* (*get)(const block*, size_t, size_t, size_t), void* out)
{
  const chi_derived_plan* const p = b->plan;
  size_t at[CHI_DERIVED_WIDTH];
  double weight[CHI_DERIVED_WIDTH];
  const void* rows[CHI_DERIVED_WIDTH];
  const size_t taps = list_taps(&p->axis[2], plane, derivative, at, weight);
  for (size_t k = 0; k < taps; ++k)
  {
    rows[k] = get(b, field, at[k], row);
  }
  p->kernels->across(p->n[0], taps, weight, rows, get(b, field, plane, row), out);
}

static void load_plane(block* b, size_t plane)
{
  const chi_derived_plan* const p = b->plan;
  for (size_t f = 0; f < p->fields; ++f)
  {
    for (size_t y = b->low_row; y < b->high_row; ++y)
    {
      const size_t first = (plane * p->n[1] + y) * p->n[0];
      p->kernels->load(&p->source[f], first, p->n[0], sample_row(b, f, plane, y));
    }
    for (size_t y = b->first_row; p->is_second && y < b->end_row; ++y)
    {
      derive_along_y(b, f, plane, y, 0, across_row(b, f, plane, y));
    }
  }
}

static void derive_field(const block* b, size_t f, size_t plane, size_t row)
{
  const chi_derived_plan* const p = b->plan;
  const void* const samples = sample_row(b, f, plane, row);
  void* const* const first = b->rows.first[f];
  void* const* const second = b->rows.second[f];
  p->kernels->along(&p->along[0], samples, first[0]);
  derive_along_z(b, f, plane, row, 0, sample_row, first[2]);
  if (!p->is_second)
  {
    derive_along_y(b, f, plane, row, 0, first[1]);
    return;
  }
  memcpy(first[1], across_row(b, f, plane, row), p->row_bytes);
  p->kernels->along(&p->along[1], samples, second[0]);
  derive_along_y(b, f, plane, row, 1, second[1]);
  derive_along_z(b, f, plane, row, 1, sample_row, second[2]);
  p->kernels->along(&p->along[0], first[1], second[3]);
  p->kernels->along(&p->along[0], first[2], second[4]);
  derive_along_z(b, f, plane, row, 0, across_row, second[5]);
}

static void narrow(const double* from, float* to, size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    to[i] = (float)from[i];
  }
}

static void finish_row(block* b, size_t plane, size_t row)
{
  const chi_derived_plan* const p = b->plan;
  chi_derived_rows* const rows = &b->rows;
  const size_t first = (plane * p->n[1] + row) * p->n[0];
  const size_t size = chi_type_size(p->job->arrays.type);
  char* wanted[4];
  for (int k = 0; k < 4; ++k)
  {
    char* const array = (char*)chi_derived_array(p->job, k);
    wanted[k] = array ? array + first * size : NULL;
    rows->out[k] = wanted[k] && !p->narrows ? wanted[k] : b->spare + (size_t)k * p->row_bytes;
  }
  rows->flat = rows->nan = rows->bad = 0;
  if (p->is_curved)
  {
    p->kernels->curve(rows, &p->form);
  }
  p->kernels->finish(rows, &p->form);
  b->counts->flat_points += rows->flat;
  b->counts->undetermined_points += rows->bad;
  b->counts->non_finite_points += rows->nan - rows->bad;
  for (int k = 0; k < 4 && p->narrows; ++k)
  {
    if (wanted[k])
    {
      narrow((const double*)rows->out[k], (float*)(void*)wanted[k], p->n[0]);
    }
  }
}

static void run_block(const chi_derived_plan* p, size_t index, block* b)
{
  const size_t y = index % p->row_blocks * p->block_rows;
  const size_t z = index / p->row_blocks * p->block_planes;
  const size_t end_plane = chi_grid_chunk_end(z, p->block_planes, p->n[2]);
  b->first_row = y;
  b->end_row = chi_grid_chunk_end(y, p->block_rows, p->n[1]);
  b->low_row = p->axis[1].start[y];
  b->high_row = p->axis[1].start[b->end_row - 1] + p->axis[1].width;
  b->loaded = p->axis[2].start[z];
  for (size_t plane = z; plane < end_plane && !chi_is_cancelled(p->job->exec); ++plane)
  {
    for (const size_t end = p->axis[2].start[plane] + p->axis[2].width; b->loaded < end;
         ++b->loaded)
    {
      load_plane(b, b->loaded);
    }
    for (size_t row = b->first_row; row < b->end_row; ++row)
    {
      for (size_t f = 0; f < p->fields; ++f)
      {
        derive_field(b, f, plane, row);
      }
      finish_row(b, plane, row);
    }
  }
}

/*------------------------------------------------------------------------------------------------*/
size_t chi_derived_count_rows(const chi_derived_plan* p)
{
  const size_t ring = p->axis[2].width * (ring_rows(p) + (p->is_second ? p->block_rows : 0));
  const size_t derivatives = p->is_second ? 9 : 3;
  return p->fields * (ring + derivatives) + (p->is_curved ? 6 : 0) + 4;
}

/* Lay a block's rows out in scratch. */
static block lay_out(const chi_derived_plan* p, size_t piece)
{
  block b = { .plan = p, .counts = p->counts + piece, .rows = { .count = p->n[0] } };
  char* at = (char*)p->scratch[piece].data;
  b.samples = at;
  at += p->fields * p->axis[2].width * ring_rows(p) * p->row_bytes;
  b.across = at;
  at += p->is_second ? p->fields * p->axis[2].width * p->block_rows * p->row_bytes : 0;
  b.spare = at;
  at += 4 * p->row_bytes;
  for (size_t f = 0; f < p->fields; ++f)
  {
    for (int k = 0; k < 3; ++k, at += p->row_bytes)
    {
      b.rows.first[f][k] = at;
    }
    for (int k = 0; k < 6 && p->is_second; ++k, at += p->row_bytes)
    {
      b.rows.second[f][k] = at;
    }
  }
  for (int k = 0; k < 6 && p->is_curved; ++k, at += p->row_bytes)
  {
    b.rows.metric[k] = at;
  }
  return b;
}

static void run_pieces(void* data, size_t begin, size_t end)
{
  const chi_derived_plan* const p = (const chi_derived_plan*)data;
  for (size_t piece = begin; piece < end; ++piece)
  {
    block b = lay_out(p, piece);
    const size_t last = (piece + 1) * p->blocks / p->pieces;
    for (size_t i = piece * p->blocks / p->pieces; i < last && !chi_is_cancelled(p->job->exec); ++i)
    {
      run_block(p, i, &b);
    }
  }
}

chi_status chi_derived_run(chi_derived_plan* p)
{
  const chi_exec* const exec = p->job->exec;
  p->counts = (chi_derived_counts*)chi_alloc(exec, p->pieces, sizeof *p->counts);
  p->scratch = (chi_buffer*)chi_alloc(exec, p->pieces, sizeof *p->scratch);
  chi_status status = p->counts && p->scratch ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK)
  {
    memset(p->counts, 0, p->pieces * sizeof *p->counts);
    memset(p->scratch, 0, p->pieces * sizeof *p->scratch);
    for (size_t i = 0; i < p->pieces && status == CHI_OK; ++i)
    {
      status = chi_buffer_reserve(exec, &p->scratch[i], chi_derived_count_rows(p), p->row_bytes)
        ? CHI_OK
        : CHI_ERROR_OUT_OF_MEMORY;
    }
    status = status == CHI_OK ? chi_for(exec, p->pieces, run_pieces, p) : status;
    for (size_t i = 0; i < p->pieces; ++i)
    {
      chi_buffer_free(exec, &p->scratch[i]);
      p->job->counts->flat_points += p->counts[i].flat_points;
      p->job->counts->non_finite_points += p->counts[i].non_finite_points;
      p->job->counts->undetermined_points += p->counts[i].undetermined_points;
    }
  }
  if (p->scratch)
  {
    chi_free(exec, p->scratch, p->pieces, sizeof *p->scratch);
  }
  if (p->counts)
  {
    chi_free(exec, p->counts, p->pieces, sizeof *p->counts);
  }
  return status;
}
