/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Small cells on a line between two bins, deposited by their mean: with values from a to b and mean
 * c, of which X = i is the line, the share (c + (b - a) / 2 - i) / (b - a) goes beyond it, as of a
 * cell whose values are spread evenly about their mean. Of the true share q it is known that
 *
 *   (c - i) / (b - i) <= q <= (c - a) / (i - a)                                                (1)
 *
 * (Markov's inequality from both ends), and of a tetrahedron, a convex body, that at least 27 / 64
 * of it lie on its centroid's side of any plane (Gruenbaum 1960). The L1 error is twice the mass
 * times the distance to the further end of that interval. What lies on lines of both axes goes the
 * exact way.
 */

#include "chi_scatterplot_internal.h"

#include <math.h>

typedef struct extent
{
  double low, high, mean;
} extent;

/* The line between bins that an extent within the plot crosses, or 0 for none. */
static int line_of(const extent* e)
{
  const int first = (int)e->low;
  return e->high > first + 1 ? first + 1 : 0;
}

static double share_beyond(const extent* e, double line, int is_convex, double* error)
{
  static const double least = 27. / 64;
  const double above = e->mean - line;
  double share = 0.5 + above / (e->high - e->low);
  double from = above / (e->high - line), to = 1 + above / (line - e->low);
  from = from > 0 ? from : 0;
  to = to < 1 ? to : 1;
  if (is_convex && above >= 0)
  {
    from = from > least ? from : least;
  }
  if (is_convex && above <= 0)
  {
    to = to < 1 - least ? to : 1 - least;
  }
  share = share < from ? from : share > to ? to : share;
  *error = share - from > to - share ? share - from : to - share;
  return share;
}

/* 0: it is left to the exact ways. */
static int splat(const chi_scatter_job* job, chi_scatter_worker* w, const extent* x,
  const extent* y, double mass, int is_convex)
{
  const int at_x = line_of(x), at_y = line_of(y);
  if (!at_x == !at_y)
  {
    return 0;
  }
  double error;
  const double share = share_beyond(at_x ? x : y, at_x ? at_x : at_y, is_convex, &error);
  const double i = at_x ? at_x : floor(x->low) + 0.5, j = at_y ? at_y : floor(y->low) + 0.5;
  const double half_x = at_x ? 0.5 : 0, half_y = at_y ? 0.5 : 0;
  chi_scatter_deposit_at(job, w, i - half_x, j - half_y, mass - mass * share);
  chi_scatter_deposit_at(job, w, i + half_x, j + half_y, mass * share);
  w->sink_error += 2 * fabs(mass) * error;
  ++w->splats;
  return 1;
}

/* Of `count` corners of equal weight but the first and the last, whose is `ends` times as much. */
static inline extent extent_of(const double* v, int count, double ends)
{
  extent e = { v[0], v[0], ends * (v[0] + v[count - 1]) };
  for (int k = 1; k < count; ++k)
  {
    e.low = v[k] < e.low ? v[k] : e.low;
    e.high = v[k] > e.high ? v[k] : e.high;
    e.mean += k < count - 1 ? v[k] : 0;
  }
  e.mean /= count - 2 + 2 * ends;
  return e;
}

static inline int is_small(const chi_scatter_job* job, int axis, const extent* e)
{
  return e->low >= 0 && e->high <= job->plot.bins[axis] &&
    e->high - e->low <= job->params.splat_size;
}

static double cross(const double* x, const double* y, int a, int b)
{
  return (x[a] - x[0]) * (y[b] - y[0]) - (y[a] - y[0]) * (x[b] - x[0]);
}

/* Of each of a cell's tetrahedra, whose mass would be reported as singular: two corners beside the
 * ends of the diagonal. */
static int have_areas(const double v[8], const double u[8])
{
  const int is_off[8] = { 0, cross(v, u, 1, 7) != 0, cross(v, u, 2, 7) != 0, cross(v, u, 3, 7) != 0,
    cross(v, u, 4, 7) != 0, cross(v, u, 5, 7) != 0, cross(v, u, 6, 7) != 0, 0 };
  return (is_off[1] | is_off[3]) & (is_off[1] | is_off[5]) & (is_off[2] | is_off[3]) &
    (is_off[2] | is_off[6]) & (is_off[4] | is_off[5]) & (is_off[4] | is_off[6]);
}

void chi_scatter_splat_brick(chi_scatter_job* job, chi_scatter_worker* w, chi_scatter_brick* b)
{
  uint8_t rows[CHI_SCATTER_BRICK * CHI_SCATTER_BRICK] = { 0 };
  job->kernels->straddling(&job->plot, b, job->params.splat_size, rows);
  for (size_t row = 0; row < CHI_SCATTER_BRICK * CHI_SCATTER_BRICK; ++row)
  {
    for (unsigned bits = rows[row]; bits; bits &= bits - 1)
    {
      const size_t i = (size_t)__builtin_ctz(bits), c = row * CHI_SCATTER_BRICK + i;
      const size_t first =
        i + row % CHI_SCATTER_BRICK * CHI_SCATTER_ROW + row / CHI_SCATTER_BRICK * CHI_SCATTER_LAYER;
      double v[8], u[8];
      for (size_t k = 0; k < 8; ++k)
      {
        const size_t at =
          first + (k & 1) + (k >> 1 & 1) * CHI_SCATTER_ROW + (k >> 2) * CHI_SCATTER_LAYER;
        v[k] = b->x[at];
        u[k] = b->y[at];
      }
      /* all six tetrahedra have the ends of the diagonal, two each of the other corners */
      const extent x = extent_of(v, 8, 3), y = extent_of(u, 8, 3);
      if (have_areas(v, u) && splat(job, w, &x, &y, 6 * b->mass[c], 0))
      {
        b->mass[c] = NAN;
      }
    }
  }
}

void chi_scatter_splat_list(chi_scatter_job* job, chi_scatter_worker* w)
{
  chi_scatter_block* const b = &w->block;
  for (size_t i = 0; i < b->count; ++i)
  {
    double v[4], u[4];
    for (size_t c = 0; c < 4; ++c)
    {
      v[c] = b->x[c * b->capacity + i];
      u[c] = b->y[c * b->capacity + i];
    }
    const extent x = extent_of(v, 4, 1), y = extent_of(u, 4, 1);
    if (b->mass[i] == b->mass[i] && is_small(job, 0, &x) && is_small(job, 1, &y) &&
      (cross(v, u, 1, 2) != 0 || cross(v, u, 1, 3) != 0 || cross(v, u, 2, 3) != 0) &&
      splat(job, w, &x, &y, b->mass[i], 1))
    {
      b->mass[i] = NAN;
    }
  }
}
