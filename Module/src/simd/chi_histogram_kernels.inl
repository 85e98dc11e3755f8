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

#include "chi_histogram_kernels.h"
#include "chi_vec8.h"

#define THIRD (1.0 / 3)

/* Which coefficients of a piece are not 0: the last, all, the first. */
typedef enum shape
{
  RISING,
  GENERAL,
  FALLING
} shape;

/* Three times the mean over u ... v of the quadratic Bezier polynomial c: with the polar form
 * B(s, t), B(u, u) + B(u, v) + B(v, v). The same of numbers and of vectors. */
#define SUM_BETWEEN(type)                                                                          \
  const type p = 1 - u, q = 1 - v;                                                                 \
  const type first = p * (p + q) + q * q, last = u * (u + v) + v * v;                              \
  return kind == RISING ? c[2] * last                                                              \
    : kind == FALLING                                                                              \
    ? c[0] * first                                                                                 \
    : c[0] * first + c[2] * last + c[1] * (2 * (p * u + q * v) + (p * v + q * u))

CHI_INLINE8 double sum_between(shape kind, const double c[3], double u, double v)
{
  SUM_BETWEEN(double);
}

CHI_INLINE8 v8 sum_between8(shape kind, const double c[3], v8 u, v8 v)
{
  SUM_BETWEEN(v8);
}

/* The pieces of a tetrahedron's density between its sorted values x. */
typedef struct spline
{
  double rising[3], general[3], falling[3];
} spline;

CHI_INLINE8 spline make_spline(const double x[4])
{
  const double a = x[0], b = x[1], c = x[2], d = x[3];
  const double most = 3 / (d - a);
  /* where three knots coincide there is no piece that needs the ratio */
  const double at_b = c > a ? most * ((b - a) / (c - a)) : 0;
  const double at_c = d > b ? most * ((d - c) / (d - b)) : 0;
  return (spline){ { 0, 0, at_b }, { at_b, most, at_c }, { at_c, 0, 0 } };
}

CHI_INLINE8 void put(
  const chi_histogram_tile* tile, size_t slot, double mass, double area, double share)
{
  tile->mass[slot] += mass * share;
  tile->area[slot] += area * share;
}

/* One piece of a density, from knot to knot, into the slots that it meets. */
CHI_INLINE8 void put_piece(const chi_histogram_window* w, const chi_histogram_tile* tile,
  shape kind, double begin, double end, const double c[3], double mass, double area)
{
  if (!(end > begin))
  {
    return;
  }
  const double inverse = 1 / (end - begin);
  size_t slot = chi_histogram_slot(w, begin);
  const size_t last = chi_histogram_slot(w, end); /* beyond it there is nothing */
  double at = begin, u = 0;
  for (; slot < last; ++slot)
  {
    const double edge = (double)slot, v = (edge - begin) * inverse;
    put(tile, slot, mass, area, (edge - at) * THIRD * sum_between(kind, c, u, v));
    at = edge;
    u = v;
  }
  put(tile, last, mass, area, (end - at) * THIRD * sum_between(kind, c, u, 1));
}

/* A tetrahedron that may reach beyond the range. */
static void put_crossing(const chi_histogram_window* w, const chi_histogram_tile* tile,
  const double x[4], double mass, double area)
{
  const spline s = make_spline(x);
  put_piece(w, tile, RISING, x[0], x[1], s.rising, mass, area);
  put_piece(w, tile, GENERAL, x[1], x[2], s.general, mass, area);
  put_piece(w, tile, FALLING, x[2], x[3], s.falling, mass, area);
}

/* Linear pieces, written as quadratic ones. */
static void put_triangle(const chi_histogram_window* w, const chi_histogram_tile* tile,
  const double x[3], double mass, double area)
{
  const double most = 2 / (x[2] - x[0]);
  const double rising[3] = { 0, most / 2, most }, falling[3] = { most, most / 2, 0 };
  put_piece(w, tile, GENERAL, x[0], x[1], rising, mass, area);
  put_piece(w, tile, GENERAL, x[1], x[2], falling, mass, area);
}

#ifdef CHI_VEC8_AVX512

/* Three times the part of one piece in eight bins from `edge` on. */
CHI_INLINE8 v8 part8(
  shape kind, double begin, double end, double inverse, const double c[3], v8 edge)
{
  const v8 low = v8_set(begin), high = v8_set(end);
  const v8 from = v8_min(v8_max(edge, low), high), to = v8_min(v8_max(edge + 1, low), high);
  const v8 u = (from - begin) * inverse, v = (to - begin) * inverse;
  return (to - from) * sum_between8(kind, c, u, v);
}

/* A tetrahedron within the range, eight bins at a time, all pieces at once: no branches but how
 * many eights. Bins that it does not meet get 0. */
CHI_INLINE8 void put_within(const chi_histogram_window* w, const chi_histogram_tile* tile,
  const double x[4], double mass, double area)
{
  (void)w;
  const double a = x[0], b = x[1], c = x[2], d = x[3];
  const spline s = make_spline(x);
  const double ab = b > a ? 1 / (b - a) : 0, bc = c > b ? 1 / (c - b) : 0;
  const double cd = d > c ? 1 / (d - c) : 0;
  const size_t last = (size_t)(int64_t)d;
  for (size_t j = (size_t)(int64_t)a; j <= last; j += 8)
  {
    const v8 edge = v8_iota() + (double)j;
    const v8 share = THIRD *
      (part8(RISING, a, b, ab, s.rising, edge) + part8(GENERAL, b, c, bc, s.general, edge) +
        part8(FALLING, c, d, cd, s.falling, edge));
    double *const m = tile->mass + j + 1, *const n = tile->area + j + 1;
    v8_store(m, v8_load(m) + mass * share);
    v8_store(n, v8_load(n) + area * share);
  }
}

#else

/* With shorter vectors one bin after another is faster. */
CHI_INLINE8 void put_within(const chi_histogram_window* w, const chi_histogram_tile* tile,
  const double x[4], double mass, double area)
{
  put_crossing(w, tile, x, mass, area);
}

#endif

CHI_INLINE8 void order(double* x, double* y)
{
  const double low = *x < *y ? *x : *y, high = *x < *y ? *y : *x;
  *x = low;
  *y = high;
}

/* Values into units of bins, the corners in ascending order. */
static void map_values(
  const chi_histogram_window* w, double* const value[4], int corners, size_t count)
{
  const chi_histogram_window window = *w; /* so that no store can change it */
  double *const a = value[0], *const b = value[1], *const c = value[2], *const d = value[3];
  for (int k = 0; k < corners; ++k)
  {
    double* const x = value[k];
    for (size_t i = 0; i < count; ++i)
    {
      x[i] = chi_histogram_map(&window, x[i]);
    }
  }
  for (size_t i = 0; i < count && corners == 3; ++i)
  {
    order(a + i, b + i);
    order(b + i, c + i);
    order(a + i, b + i);
  }
  for (size_t i = 0; i < count && corners == 4; ++i)
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

static void put_block(const chi_histogram_window* w, double* const value[4], int corners,
  const double* mass, const double* area, size_t count, const chi_histogram_tile* given)
{
  const chi_histogram_tile tile = *given;
  const double end = (double)w->bins;
  map_values(w, value, corners, count);
  for (size_t i = 0; i < count; ++i)
  {
    const double low = value[0][i], high = value[corners - 1][i];
    const size_t slot =
      low == high ? chi_histogram_constant_slot(w, low) : chi_histogram_slot(w, low);
    if (low == high || slot == chi_histogram_slot(w, high))
    {
      put(&tile, slot, mass[i], area[i], 1);
    }
    else if (corners == 3)
    {
      const double x[3] = { low, value[1][i], high };
      put_triangle(w, &tile, x, mass[i], area[i]);
    }
    else
    {
      const double x[4] = { low, value[1][i], value[2][i], high };
      if (low >= 0 && high <= end)
      {
        put_within(w, &tile, x, mass[i], area[i]);
      }
      else
      {
        put_crossing(w, &tile, x, mass[i], area[i]);
      }
    }
  }
}
