/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Simplices into bins. The density of a linear function's values over a simplex is the B-spline
 * whose knots are the values at the corners (Curry & Schoenberg 1966): quadratic for a tetrahedron.
 * Between two knots it is a Bezier polynomial with coefficients that are not negative, and the
 * integral over a part of that is its length by the mean of the part's own three coefficients,
 * values of the polar form (Ramshaw 1989). Only sums of what is not negative are rounded: each
 * bin's part is right to some units in the last place of itself.
 */

#include "chi_histogram_internal.h"

#include <math.h>

/* Which coefficients of a piece are not 0: the last, all, the first. */
typedef enum shape
{
  RISING,
  GENERAL,
  FALLING
} shape;

/* Three times the mean over u ... v of the quadratic Bezier polynomial c: with the polar form
 * B(s, t), B(u, u) + B(u, v) + B(v, v). */
static inline double sum_between(shape kind, const double c[3], double u, double v)
{
  const double p = 1 - u, q = 1 - v;
  const double first = p * (p + q) + q * q, last = u * (u + v) + v * v;
  return kind == RISING ? c[2] * last
    : kind == FALLING   ? c[0] * first
                      : c[0] * first + c[2] * last + c[1] * (2 * (p * u + q * v) + (p * v + q * u));
}

int chi_histogram_open_window(chi_histogram_window* w, double low, double high, size_t bins)
{
  double size = 1;
  while (size < (double)bins)
  {
    size *= 2;
  }
  *w = (chi_histogram_window){ .low = low,
    .high = high,
    .scale = (double)bins / (high - low),
    .snap = 3 * size,
    .quantum = size * 0x1p-51, /* of numbers from 2 to 4 sizes */
    .bins = bins };
  return low < high && isfinite(high - low) && isfinite(w->scale);
}

/* A value in units of bins: up to `bins` within the range, beyond outside, whatever is rounded. */
static inline double map(const chi_histogram_window* w, double value)
{
  const double end = (double)w->bins, far = 0x1p200;
  double x = (value - w->low) * w->scale;
  x = x < far ? x : far;
  x = x > -far ? x : -far;
  x = (x + w->snap) - w->snap; /* so that differences are not tiny, and exact */
  const double below = x < -w->quantum ? x : -w->quantum;
  const double above = x > end + w->quantum ? x : end + w->quantum;
  const double within = x < end ? x : end;
  return value < w->low ? below : value > w->high ? above : within;
}

static inline size_t slot_of(const chi_histogram_window* w, double x)
{
  return x < 0 ? 0 : x < (double)w->bins ? 1 + (size_t)(int64_t)x : w->bins + 1;
}

/* The slot of a constant: the range's upper end belongs to the last bin. */
static inline size_t slot_of_constant(const chi_histogram_window* w, double x)
{
  return x == (double)w->bins ? w->bins : slot_of(w, x);
}

static inline void put(double* tile, size_t slot, double mass, double area, double share)
{
  tile[2 * slot] += mass * share;
  tile[2 * slot + 1] += area * share;
}

/* One piece of a density, from knot to knot, into the slots that it meets. */
static inline void put_piece_of_density(const chi_histogram_window* w, double* tile, shape kind,
  double begin, double end, const double c[3], double mass, double area)
{
  if (!(end > begin))
  {
    return;
  }
  const double inverse = 1 / (end - begin), third = 1.0 / 3;
  size_t slot = slot_of(w, begin);
  const size_t last = slot_of(w, end); /* beyond it there is nothing */
  double at = begin, u = 0;
  for (; slot < last; ++slot)
  {
    const double edge = (double)slot, v = (edge - begin) * inverse;
    put(tile, slot, mass, area, (edge - at) * third * sum_between(kind, c, u, v));
    at = edge;
    u = v;
  }
  put(tile, last, mass, area, (end - at) * third * sum_between(kind, c, u, 1));
}

/* Sorted values. */
static inline void put_tetrahedron(
  const chi_histogram_window* w, double* tile, const double x[4], double mass, double area)
{
  const double a = x[0], b = x[1], c = x[2], d = x[3];
  const double most = 3 / (d - a);
  /* where three knots coincide there is no piece that needs the ratio */
  const double at_b = c > a ? most * ((b - a) / (c - a)) : 0;
  const double at_c = d > b ? most * ((d - c) / (d - b)) : 0;
  const double rising[3] = { 0, 0, at_b }, middle[3] = { at_b, most, at_c };
  const double falling[3] = { at_c, 0, 0 };
  put_piece_of_density(w, tile, RISING, a, b, rising, mass, area);
  put_piece_of_density(w, tile, GENERAL, b, c, middle, mass, area);
  put_piece_of_density(w, tile, FALLING, c, d, falling, mass, area);
}

/* Linear pieces, written as quadratic ones. */
static inline void put_triangle(
  const chi_histogram_window* w, double* tile, const double x[3], double mass, double area)
{
  const double most = 2 / (x[2] - x[0]);
  const double rising[3] = { 0, most / 2, most }, falling[3] = { most, most / 2, 0 };
  put_piece_of_density(w, tile, GENERAL, x[0], x[1], rising, mass, area);
  put_piece_of_density(w, tile, GENERAL, x[1], x[2], falling, mass, area);
}

static inline void order(double* x, double* y)
{
  const double low = *x < *y ? *x : *y, high = *x < *y ? *y : *x;
  *x = low;
  *y = high;
}

/* Values of the block into units of bins, the corners in ascending order. */
static void map_block(const chi_histogram_window* w, chi_histogram_block* block, int corners)
{
  const chi_histogram_window window = *w; /* so that no store can change it */
  double *const a = block->value[0], *const b = block->value[1];
  double *const c = block->value[2], *const d = block->value[3];
  for (int k = 0; k < corners; ++k)
  {
    double* const x = block->value[k];
    for (size_t i = 0; i < block->count; ++i)
    {
      x[i] = map(&window, x[i]);
    }
  }
  for (size_t i = 0; i < block->count && corners == 3; ++i)
  {
    order(a + i, b + i);
    order(b + i, c + i);
    order(a + i, b + i);
  }
  if (corners < 4)
  {
    return;
  }
  for (size_t i = 0; i < block->count; ++i)
  {
    double x[4] = { a[i], b[i], c[i], d[i] };
    order(x, x + 1);
    order(x + 2, x + 3);
    order(x, x + 2);
    order(x + 1, x + 3);
    order(x + 1, x + 2);
    a[i] = x[0];
    b[i] = x[1];
    c[i] = x[2];
    d[i] = x[3];
  }
}

static void put_block(
  const chi_histogram_window* w, chi_histogram_block* block, int corners, double* tile)
{
  map_block(w, block, corners);
  const double* const last = block->value[corners - 1];
  for (size_t i = 0; i < block->count; ++i)
  {
    const double a = block->value[0][i], z = last[i];
    const double mass = block->mass[i], area = block->area[i];
    const size_t slot = a == z ? slot_of_constant(w, a) : slot_of(w, a);
    if (a == z || slot == slot_of(w, z))
    {
      put(tile, slot, mass, area, 1);
    }
    else if (corners == 4)
    {
      const double x[4] = { a, block->value[1][i], block->value[2][i], z };
      put_tetrahedron(w, tile, x, mass, area);
    }
    else
    {
      const double x[3] = { a, block->value[1][i], z };
      put_triangle(w, tile, x, mass, area);
    }
  }
}

/* ---- all pieces, in groups whose bins are added up in order */

typedef struct bin_job
{
  const chi_exec* exec;
  const chi_histogram* histogram;
  const chi_histogram_window* window;
  size_t groups, numbers;                       /* two a slot */
  chi_sum* sums;                                /* [groups][numbers] */
  int64_t (*skipped)[CHI_HISTOGRAM_SKIP_KINDS]; /* [groups] */
  chi_status* status;                           /* [groups] */
} bin_job;

static void put_piece(
  bin_job* job, size_t group, size_t index, chi_histogram_block* block, double* tile)
{
  const chi_histogram_window* const w = job->window;
  const chi_histogram_plan* const plan = &job->histogram->plan;
  const chi_histogram_piece* const piece = chi_histogram_pieces(job->histogram) + index;
  if (piece->low > piece->high)
  {
    return;
  }
  const double low = map(w, piece->low), high = map(w, piece->high);
  const int is_constant = low == high;
  size_t first = is_constant ? slot_of_constant(w, low) : slot_of(w, low);
  size_t last = is_constant ? first : slot_of(w, high);
  /* of what begins at the upper end, constants are in the last bin, and the rest above */
  const int is_outside = last == 0 || low > (double)w->bins;
  const int kind = is_outside ? CHI_HISTOGRAM_SKIP_OUTSIDE : CHI_HISTOGRAM_SKIP_ONE_BIN;
  const int is_one = first == last && (is_outside || first <= w->bins);
  if (is_one && !(plan->no_skipping & kind))
  {
    put(tile, first, piece->mass, piece->area, 1);
    ++job->skipped[group][is_outside ? 0 : 1];
  }
  else
  {
    job->status[group] = chi_histogram_fill(job->exec, plan, index, block, NULL);
    if (job->status[group] == CHI_OK)
    {
      put_block(w, block, plan->corners, tile);
    }
    first = first > w->bins ? w->bins : first;
  }
  chi_sum* const sums = job->sums + group * job->numbers;
  for (size_t k = 2 * first; k < 2 * last + 2; ++k)
  {
    chi_sum_add(sums + k, tile[k]);
    tile[k] = 0;
  }
}

static void put_groups(void* data, size_t begin, size_t end)
{
  bin_job* const job = (bin_job*)data;
  const size_t pieces = job->histogram->plan.pieces;
  chi_histogram_block block = { 0 };
  double* const tile = (double*)chi_alloc(job->exec, job->numbers, sizeof *tile);
  if (tile)
  {
    memset(tile, 0, job->numbers * sizeof *tile);
  }
  for (size_t g = begin; g < end; ++g)
  {
    chi_sum* const sums = job->sums + g * job->numbers;
    memset(sums, 0, job->numbers * sizeof *sums);
    memset(job->skipped[g], 0, sizeof job->skipped[g]);
    job->status[g] = tile ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
    const size_t last = (g + 1) * pieces / job->groups;
    for (size_t i = g * pieces / job->groups; i < last && job->status[g] == CHI_OK; ++i)
    {
      if (chi_is_cancelled(job->exec))
      {
        job->status[g] = CHI_ERROR_CANCELLED;
        break;
      }
      put_piece(job, g, i, &block, tile);
    }
  }
  chi_histogram_free_block(job->exec, &block);
  if (tile)
  {
    chi_free(job->exec, tile, job->numbers, sizeof *tile);
  }
}

/* Few groups where there are many bins, so that their memory stays in bounds; whatever the threads,
 * for the same bits. */
static size_t groups_of(size_t bins, size_t pieces)
{
  const size_t count = ((size_t)1 << 18) / bins;
  const size_t most = count < 8 ? 8 : count > CHI_HISTOGRAM_GROUPS ? CHI_HISTOGRAM_GROUPS : count;
  return most < pieces ? most : pieces;
}

chi_status chi_histogram_fill_window(const chi_exec* exec, chi_histogram* h,
  const chi_histogram_window* w, int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS])
{
  int64_t of_groups[CHI_HISTOGRAM_GROUPS][CHI_HISTOGRAM_SKIP_KINDS];
  chi_status states[CHI_HISTOGRAM_GROUPS] = { CHI_OK };
  bin_job job = { .exec = exec,
    .histogram = h,
    .window = w,
    .groups = groups_of(w->bins, h->plan.pieces),
    .numbers = 2 * (w->bins + 2),
    .skipped = of_groups,
    .status = states };
  if (!chi_buffer_reserve(exec, &h->group_buffer, job.groups * job.numbers + 1, sizeof *job.sums) ||
    !chi_buffer_reserve(exec, &h->bin_buffer, job.numbers, sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job.sums = (chi_sum*)h->group_buffer.data;
  chi_status status = job.groups > 0 ? chi_for(exec, job.groups, put_groups, &job) : CHI_OK;
  double* const out = (double*)h->bin_buffer.data;
  for (size_t g = 0; g < job.groups && status == CHI_OK; ++g)
  {
    status = states[g];
    for (int k = 0; k < CHI_HISTOGRAM_SKIP_KINDS; ++k)
    {
      skipped[k] += of_groups[g][k];
    }
  }
  for (size_t i = 0; i < job.numbers && status == CHI_OK; ++i)
  {
    chi_sum sum = { 0, 0 };
    for (size_t g = 0; g < job.groups; ++g)
    {
      const chi_sum* const part = job.sums + g * job.numbers + i;
      chi_sum_add(&sum, part->high);
      chi_sum_add(&sum, part->low);
    }
    out[i] = chi_sum_value(&sum);
  }
  return status;
}
