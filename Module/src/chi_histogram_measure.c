/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Ranges, masses and moments of pieces, and of all of them. Over a simplex of n + 1 corners with
 * values u_i the mean of u^k is h_k(u_0 ... u_n) / binomial(n + k, k), h_k the sum of all monomials
 * of degree k. A piece's moments are about the middle of its own range and in units of half of it,
 * so that nothing overflows and little cancels when they are moved to the mean of all.
 */

#include "chi_histogram_internal.h"

#include <math.h>

enum
{
  EIGHT = 8,
  LANES = 64,
  PIECES_A_GROUP = 16
};

typedef struct measure_job
{
  const chi_exec* exec;
  const chi_histogram_plan* plan;
  chi_histogram_piece* pieces;
  chi_status* status; /* of groups of pieces */
} measure_job;

static double binomial(int n, int k)
{
  double b = 1;
  for (int i = 1; i <= k; ++i)
  {
    b = b * (n - k + i) / i;
  }
  return b;
}

static double sum_of_eight(const double x[EIGHT])
{
  return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

/* Extremes of all corners, EIGHT at a time, so that no chain of comparisons is waited for. */
static void find_range(const chi_histogram_block* block, int corners, chi_histogram_piece* piece)
{
  double low[EIGHT], high[EIGHT];
  for (int k = 0; k < EIGHT; ++k)
  {
    low[k] = INFINITY;
    high[k] = -INFINITY;
  }
  for (int c = 0; c < corners; ++c)
  {
    const double* const x = block->value[c];
    size_t i = 0;
    for (; i + EIGHT <= block->count; i += EIGHT)
    {
      for (int k = 0; k < EIGHT; ++k)
      {
        low[k] = x[i + (size_t)k] < low[k] ? x[i + (size_t)k] : low[k];
        high[k] = x[i + (size_t)k] > high[k] ? x[i + (size_t)k] : high[k];
      }
    }
    for (; i < block->count; ++i)
    {
      low[0] = x[i] < low[0] ? x[i] : low[0];
      high[0] = x[i] > high[0] ? x[i] : high[0];
    }
  }
  for (int k = 0; k < EIGHT; ++k)
  {
    piece->low = low[k] < piece->low ? low[k] : piece->low;
    piece->high = high[k] > piece->high ? high[k] : piece->high;
  }
}

/* What LANES simplices from `first` on add. Short sums are added up, so that equal parts do not
 * round alike thousands of times. */
static void add_masses(
  const chi_histogram_block* block, int corners, size_t first, chi_histogram_piece* piece)
{
  const double *const a = block->value[0], *const b = block->value[corners > 1 ? 1 : 0];
  const double* const c = block->value[corners > 2 ? 2 : 0];
  const double* const d = block->value[corners > 3 ? 3 : 0];
  const size_t last = chi_grid_chunk_end(first, LANES, block->count);
  double mass[EIGHT] = { 0 }, area[EIGHT] = { 0 }, singular[EIGHT] = { 0 };
  for (size_t i = first; i < last; ++i)
  {
    const size_t k = (i - first) % EIGHT;
    mass[k] += block->mass[i];
    area[k] += block->area[i];
    singular[k] += (a[i] == b[i]) & (a[i] == c[i]) & (a[i] == d[i]) ? block->mass[i] : 0;
  }
  piece->mass += sum_of_eight(mass);
  piece->area += sum_of_eight(area);
  piece->singular += sum_of_eight(singular);
}

/* Their moments, by the recurrence h_k(.., u) = h_k(..) + u h_(k-1)(.., u). */
static void add_moments(const chi_histogram_block* block, int corners, size_t first, int orders,
  chi_histogram_piece* piece)
{
  double h[CHI_HISTOGRAM_MOMENTS + 1][LANES] = { 0 }, u[LANES], mass[LANES] = { 0 };
  const size_t count = chi_grid_chunk_end(first, LANES, block->count) - first;
  const double center = piece->center, unit = piece->half > 0 ? 1 / piece->half : 0;
  memcpy(mass, block->mass + first, count * sizeof *mass);
  for (size_t i = 0; i < LANES; ++i)
  {
    h[0][i] = 1;
    u[i] = 0;
  }
  for (int k = 0; k < corners; ++k)
  {
    const double* const x = block->value[k] + first;
    for (size_t i = 0; i < count; ++i)
    {
      u[i] = (x[i] - center) * unit;
    }
    for (int order = 1; order <= orders; ++order)
    {
      for (size_t i = 0; i < LANES; ++i)
      {
        h[order][i] += u[i] * h[order - 1][i];
      }
    }
  }
  for (int order = 1; order <= orders; ++order)
  {
    double sum[EIGHT] = { 0 };
    for (size_t i = 0; i < LANES; i += EIGHT)
    {
      for (size_t k = 0; k < EIGHT; ++k)
      {
        sum[k] += mass[i + k] * h[order][i + k];
      }
    }
    piece->moment[order] += sum_of_eight(sum) / binomial(corners - 1 + order, order);
  }
}

static chi_status measure_piece(
  const measure_job* job, size_t index, chi_histogram_block* block, chi_histogram_piece* piece)
{
  const chi_histogram_plan* const plan = job->plan;
  *piece = (chi_histogram_piece){ .low = INFINITY, .high = -INFINITY, .bad = -1 };
  const chi_status status = chi_histogram_fill(job->exec, plan, index, block, piece);
  if (status != CHI_OK || block->count == 0)
  {
    return status;
  }
  piece->simplices = (uint32_t)block->count;
  find_range(block, plan->corners, piece);
  piece->center = 0.5 * piece->low + 0.5 * piece->high;
  piece->half = 0.5 * piece->high - 0.5 * piece->low;
  piece->half = isfinite(1 / piece->half) ? piece->half : 0; /* 1e-308: constant */
  for (size_t first = 0; first < block->count; first += LANES)
  {
    add_masses(block, plan->corners, first, piece);
    add_moments(block, plan->corners, first, plan->moments, piece);
  }
  piece->moment[0] = piece->mass;
  return CHI_OK;
}

static void measure_groups(void* data, size_t begin, size_t end)
{
  measure_job* const job = (measure_job*)data;
  chi_histogram_block block = { 0 };
  for (size_t g = begin; g < end; ++g)
  {
    const size_t first = g * PIECES_A_GROUP;
    const size_t last = chi_grid_chunk_end(first, PIECES_A_GROUP, job->plan->pieces);
    job->status[g] = CHI_OK;
    for (size_t i = first; i < last && job->status[g] == CHI_OK; ++i)
    {
      job->status[g] = chi_is_cancelled(job->exec) ? CHI_ERROR_CANCELLED
                                                   : measure_piece(job, i, &block, job->pieces + i);
    }
  }
  chi_histogram_free_block(job->exec, &block);
}

chi_status chi_histogram_measure(const chi_exec* exec, chi_histogram* h)
{
  const chi_histogram_plan* const plan = &h->plan;
  const size_t groups = chi_grid_chunks(plan->pieces, PIECES_A_GROUP);
  if (groups == 0)
  {
    return CHI_OK;
  }
  if (!chi_buffer_reserve(exec, &h->piece_buffer, plan->pieces, sizeof(chi_histogram_piece)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  measure_job job = { exec, plan, chi_histogram_pieces(h), NULL };
  job.status = (chi_status*)chi_alloc(exec, groups, sizeof *job.status);
  if (!job.status)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_status status = chi_for(exec, groups, measure_groups, &job);
  for (size_t g = 0; g < groups && status == CHI_OK; ++g)
  {
    status = job.status[g];
  }
  chi_free(exec, job.status, groups, sizeof *job.status);
  for (size_t i = 0; i < plan->pieces && status == CHI_OK; ++i)
  {
    if (job.pieces[i].bad >= 0)
    {
      h->result.first_bad_cell = job.pieces[i].bad;
      status = CHI_ERROR_INVALID_ARGUMENT;
    }
  }
  return status;
}

/* The mean, from differences to the middle of the range. */
static chi_status find_mean(chi_histogram* h, double middle)
{
  const chi_histogram_piece* const pieces = chi_histogram_pieces(h);
  chi_sum sum = { 0, 0 };
  for (size_t i = 0; i < h->plan.pieces; ++i)
  {
    const chi_histogram_piece* const p = pieces + i;
    if (p->low <= p->high)
    {
      chi_sum_add(&sum, p->mass * (p->center - middle));
      chi_sum_add(&sum, p->half * p->moment[1]);
    }
  }
  double rest = chi_sum_value(&sum);
  const chi_status status = chi_histogram_sum(&h->plan, &rest, 1);
  h->result.mean = middle + rest / h->result.total_mass;
  return status;
}

/* Pieces' moments about the mean, in units of `half`. */
static chi_status find_moments(chi_histogram* h, double half)
{
  const chi_histogram_piece* const pieces = chi_histogram_pieces(h);
  const int orders = h->plan.moments;
  chi_sum sum[CHI_HISTOGRAM_MOMENTS + 1] = { 0 };
  for (size_t i = 0; i < h->plan.pieces; ++i)
  {
    const chi_histogram_piece* const p = pieces + i;
    if (!(p->low <= p->high))
    {
      continue;
    }
    const double shift = (p->center - h->result.mean) / half, scale = p->half / half;
    double own[CHI_HISTOGRAM_MOMENTS + 1], power = 1;
    for (int k = 0; k <= orders; ++k, power *= scale)
    {
      own[k] = power * p->moment[k];
    }
    for (int k = 2; k <= orders; ++k) /* by Horner's rule in the shift */
    {
      double all = own[0];
      for (int j = 1; j <= k; ++j)
      {
        all = all * shift + binomial(k, j) * own[j];
      }
      chi_sum_add(sum + k, all);
    }
  }
  double power = half;
  chi_status status = CHI_OK;
  for (int k = 2; k <= orders && status == CHI_OK; ++k)
  {
    double all = chi_sum_value(sum + k);
    status = chi_histogram_sum(&h->plan, &all, 1);
    power *= half;
    all = k % 2 == 0 && all < 0 ? 0 : all; /* rounding, where nearly all mass has one value */
    h->result.central_moments[k] = power * (all / h->result.total_mass);
  }
  return status;
}

chi_status chi_histogram_add_up(chi_histogram* h)
{
  chi_histogram_result* const r = &h->result;
  const chi_histogram_piece* const pieces = chi_histogram_pieces(h);
  chi_sum mass = { 0, 0 }, area = { 0, 0 }, singular = { 0, 0 };
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < h->plan.pieces; ++i)
  {
    const chi_histogram_piece* const p = pieces + i;
    chi_sum_add(&mass, p->mass);
    chi_sum_add(&area, p->area);
    chi_sum_add(&singular, p->singular);
    low = p->low < low ? p->low : low;
    high = p->high > high ? p->high : high;
    r->cells += p->cells;
    r->simplices += p->simplices;
    r->skipped_cells += p->skipped;
    r->ghost_cells += p->ghosts;
    r->blanked_cells += p->blanked;
    r->lower_dimensional_cells += p->lower_dimensional;
    r->unsupported_cells += p->unsupported;
  }
  double masses[2] = { chi_sum_value(&mass), chi_sum_value(&singular) }, ends[2] = { -low, high };
  r->total_area = chi_sum_value(&area);
  chi_status status = chi_histogram_agree(&h->plan, CHI_OK, ends, 2);
  status = status == CHI_OK ? chi_histogram_sum(&h->plan, masses, 2) : status;
  status = status == CHI_OK ? chi_histogram_sum(&h->plan, &r->total_area, 1) : status;
  low = -ends[0];
  high = ends[1];
  r->total_mass = masses[0];
  r->singular_mass = masses[1];
  r->field_range[0] = low <= high ? low : 1;
  r->field_range[1] = low <= high ? high : -1;
  r->mean = NAN;
  for (int k = 0; k <= h->plan.moments; ++k)
  {
    r->central_moments[k] = r->total_mass > 0 ? k == 0 : NAN;
  }
  if (r->total_mass > 0 && status == CHI_OK)
  {
    const double half = 0.5 * high - 0.5 * low;
    status = find_mean(h, 0.5 * low + 0.5 * high);
    if (half > 0 && isfinite(1 / half) && status == CHI_OK)
    {
      status = find_moments(h, half);
    }
  }
  return status;
}
