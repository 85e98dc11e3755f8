/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_PREDICATES_H
#define CHI_PREDICATES_H

/*
 * The sign of a determinant of three vectors, exactly: in double where its rounding cannot matter,
 * else in sums of doubles that do not overlap. Source: Shewchuk, "Adaptive Precision Floating-Point
 * Arithmetic and Fast Robust Geometric Predicates", 1997 (the bound of the filter, two-sums and
 * two-products; the determinant itself is expanded plainly, since hardly any face comes so far).
 * Holds where nothing overflows or underflows, and must be compiled without contraction.
 */

#include <math.h>
#include <stddef.h>

/* A vector from one point to another: what was rounded off stands in lo. */
typedef struct chi_difference
{
  double hi[3], lo[3];
} chi_difference;

static inline double chi_two_sum(double a, double b, double* lo)
{
  const double sum = a + b, of_b = sum - a;
  *lo = (a - (sum - of_b)) + (b - of_b);
  return sum;
}

static inline double chi_two_product(double a, double b, double* lo)
{
  const double product = a * b;
  *lo = fma(a, b, -product);
  return product;
}

static inline chi_difference chi_difference_of(const double to[3], const double from[3])
{
  chi_difference d;
  for (int k = 0; k < 3; ++k)
  {
    d.hi[k] = chi_two_sum(to[k], -from[k], &d.lo[k]);
  }
  return d;
}

/* Adds a number to a sum of n parts, smallest first, that do not overlap; its length is then n + 1
 * or less, since parts of 0 are left out. */
static inline size_t chi_expansion_grow(double* parts, size_t n, double number)
{
  size_t out = 0;
  for (size_t i = 0; i < n; ++i)
  {
    double lo;
    number = chi_two_sum(number, parts[i], &lo);
    if (lo != 0)
    {
      parts[out++] = lo;
    }
  }
  if (number != 0)
  {
    parts[out++] = number;
  }
  return out;
}

/* The sign of a . (b x c): -1, 0, 1. */
static inline int chi_determinant_sign_exact(
  const chi_difference* a, const chi_difference* b, const chi_difference* c)
{
  enum
  {
    /* 6 terms of 2 x 2 x 2 products of up to 4 parts */
    PARTS = 6 * 8 * 4
  };
  double parts[PARTS];
  size_t n = 0;
  for (int i = 0; i < 6; ++i)
  {
    const int x = i % 3, y = (x + (i < 3 ? 1 : 2)) % 3, z = 3 - x - y;
    const double sign = i < 3 ? 1 : -1;
    for (int k = 0; k < 8; ++k)
    {
      const double p = sign * (k & 1 ? a->lo[x] : a->hi[x]), q = k & 2 ? b->lo[y] : b->hi[y],
                   r = k & 4 ? c->lo[z] : c->hi[z];
      double low, lows[2];
      const double high = chi_two_product(p, q, &low);
      const double highs[2] = { chi_two_product(low, r, lows), chi_two_product(high, r, lows + 1) };
      n = chi_expansion_grow(parts, n, lows[0]);
      n = chi_expansion_grow(parts, n, highs[0]);
      n = chi_expansion_grow(parts, n, lows[1]);
      n = chi_expansion_grow(parts, n, highs[1]);
    }
  }
  return n == 0 ? 0 : parts[n - 1] > 0 ? 1 : -1; /* the largest part outweighs the others */
}

/* The same, of vectors whose parts in lo may be missing in `hi`: a filter first. */
static inline int chi_determinant_sign(
  const chi_difference* a, const chi_difference* b, const chi_difference* c)
{
  const double yz = b->hi[1] * c->hi[2], zy = b->hi[2] * c->hi[1];
  const double zx = b->hi[2] * c->hi[0], xz = b->hi[0] * c->hi[2];
  const double xy = b->hi[0] * c->hi[1], yx = b->hi[1] * c->hi[0];
  const double value = a->hi[0] * (yz - zy) + a->hi[1] * (zx - xz) + a->hi[2] * (xy - yx);
  const double most = fabs(a->hi[0]) * (fabs(yz) + fabs(zy)) +
    fabs(a->hi[1]) * (fabs(zx) + fabs(xz)) + fabs(a->hi[2]) * (fabs(xy) + fabs(yx));
  /* (7 + 56 u) u of orient3d, u = 2^-53, rounded up */
  const double bound = 0x1.cp-51 * (1 + 0x1p-40) * most;
  return value > bound ? 1 : value < -bound ? -1 : chi_determinant_sign_exact(a, b, c);
}

/* On which side of the plane through a, b, c the point d lies: 1 where a, b, c run counterclockwise
 * as seen from d, -1 on the other side, 0 in the plane. */
static inline int chi_plane_side(
  const double a[3], const double b[3], const double c[3], const double d[3])
{
  const chi_difference u = chi_difference_of(d, a), v = chi_difference_of(b, a),
                       w = chi_difference_of(c, a);
  return chi_determinant_sign(&u, &v, &w);
}

/* Likewise of a point infinitely far away. */
static inline int chi_plane_side_far(
  const double a[3], const double b[3], const double c[3], const double towards[3])
{
  const chi_difference u = { { towards[0], towards[1], towards[2] }, { 0, 0, 0 } },
                       v = chi_difference_of(b, a), w = chi_difference_of(c, a);
  return chi_determinant_sign(&u, &v, &w);
}

#endif
