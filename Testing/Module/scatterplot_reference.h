/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_REFERENCE_H
#define CHI_SCATTERPLOT_REFERENCE_H

/*
 * Bins by brute force in long double: of every simplex the part in every row, and of that the part
 * in every bin, cut by halving edges, so that shares are products of ratios, whatever the shape.
 * Shares nothing with the library but the convention that a bin holds its lower ends, and the last
 * the upper one.
 */

#include <math.h>
#include <stddef.h>

typedef struct ref_simplex
{
  long double x[2][4], share;
} ref_simplex;

typedef struct ref_plot
{
  size_t bins[2];
  double range[2][2];
  long double* mass; /* [bins[1]][bins[0]] */
  long double out;
} ref_plot;

enum
{
  REF_PARTS = 512
};

/* The parts of `count` simplices above (or below) a line; those that only touch it are on both
 * sides. How many. */
static size_t ref_clip(ref_simplex* out, const ref_simplex* in, size_t count, int corners, int axis,
  long double line, int above)
{
  ref_simplex todo[64];
  size_t kept = 0;
  for (size_t k = 0; k < count; ++k)
  {
    size_t left = 0;
    todo[left++] = in[k];
    while (left > 0)
    {
      ref_simplex s = todo[--left], other = s;
      int low = 0, high = 0;
      for (int c = 1; c < corners; ++c)
      {
        low = s.x[axis][c] < s.x[axis][low] ? c : low;
        high = s.x[axis][c] > s.x[axis][high] ? c : high;
      }
      const long double a = s.x[axis][low], b = s.x[axis][high];
      if (!(a < line && b > line))
      {
        out[kept] = s;
        kept += above ? a >= line : b <= line;
        continue;
      }
      const long double t = (line - a) / (b - a);
      for (int e = 0; e < 2; ++e)
      {
        const long double at = s.x[e][low] + t * (s.x[e][high] - s.x[e][low]);
        s.x[e][high] = other.x[e][low] = e == axis ? line : at;
      }
      s.share *= t;
      other.share *= 1 - t;
      todo[left++] = s;
      todo[left++] = other;
    }
  }
  return kept;
}

/* What lies in bin k of an axis. A simplex all on a line belongs to the bin above, on the upper end
 * to the last one. */
static size_t ref_bin(ref_simplex* out, const ref_simplex* in, size_t count, int corners, int axis,
  size_t k, size_t bins)
{
  static ref_simplex above[REF_PARTS];
  const long double upper = (long double)(k + 1);
  size_t kept = ref_clip(above, in, count, corners, axis, (long double)k, 1);
  kept = ref_clip(out, above, kept, corners, axis, upper, 0);
  size_t left = 0;
  for (size_t i = 0; i < kept; ++i)
  {
    long double low = out[i].x[axis][0];
    for (int c = 1; c < corners; ++c)
    {
      low = fminl(low, out[i].x[axis][c]);
    }
    out[left] = out[i];
    left += low < upper || k + 1 == bins;
  }
  return left;
}

static void ref_find(
  const ref_simplex* s, int corners, int axis, size_t bins, size_t* first, size_t* end)
{
  long double low = s->x[axis][0], high = low;
  for (int c = 1; c < corners; ++c)
  {
    low = fminl(low, s->x[axis][c]);
    high = fmaxl(high, s->x[axis][c]);
  }
  const long double n = (long double)bins;
  *first = low > 0 ? (size_t)fminl(low, n - 1) : 0;
  *end = high < 0 || low > n ? *first : (size_t)fminl(floorl(high) + 1, n);
}

/* Deposit one simplex with the values f, g at its corners. */
__attribute__((unused)) static void ref_deposit(
  ref_plot* plot, int corners, const double* f, const double* g, long double mass)
{
  ref_simplex s = { .share = mass };
  const double* const values[2] = { f, g };
  for (int k = 0; k < 2; ++k)
  {
    const long double low = plot->range[k][0], size = plot->range[k][1] - low;
    for (int c = 0; c < corners; ++c)
    {
      s.x[k][c] = ((long double)values[k][c] - low) / size * (long double)plot->bins[k];
    }
  }
  size_t row, end_row, column, end_column;
  static ref_simplex rows[REF_PARTS], parts[REF_PARTS];
  long double inside = 0;
  for (ref_find(&s, corners, 1, plot->bins[1], &row, &end_row); row < end_row; ++row)
  {
    const size_t count = ref_bin(rows, &s, 1, corners, 1, row, plot->bins[1]);
    for (size_t r = 0; r < count; ++r)
    {
      ref_find(rows + r, corners, 0, plot->bins[0], &column, &end_column);
      for (; column < end_column; ++column)
      {
        const size_t found = ref_bin(parts, rows + r, 1, corners, 0, column, plot->bins[0]);
        for (size_t i = 0; i < found; ++i)
        {
          plot->mass[row * plot->bins[0] + column] += parts[i].share;
          inside += parts[i].share;
        }
      }
    }
  }
  plot->out += mass - inside;
}

#endif
