/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SEGMENT_REFERENCE_H
#define CHI_SEGMENT_REFERENCE_H

/*
 * The volume rendering integral of one segment by quadrature in double: the slow path by which the
 * tables and kernels are judged. It shares nothing with them but the transfer function.
 */

#include <math.h>

/* Colour and extinction (rgba[3], per world unit) of a scalar. */
typedef void (*segment_classify)(const void* data, double scalar, double rgba[4]);

/* Piecewise linear functions of the place 0 ... count - 1. */
typedef struct segment_entries
{
  const float (*rgba)[4]; /* red, green, blue, extinction */
  int count;
} segment_entries;

static inline void segment_classify_entries(const void* data, double x, double rgba[4])
{
  const segment_entries* const e = (const segment_entries*)data;
  const double clamped = fmin(fmax(x, 0), e->count - 1);
  const int i = clamped < e->count - 1 ? (int)clamped : e->count - 2;
  for (int c = 0; c < 4; ++c)
  {
    rgba[c] =
      (double)e->rgba[i][c] + (clamped - i) * ((double)e->rgba[i + 1][c] - (double)e->rgba[i][c]);
  }
}

/*
 * Adds, behind what is there, a piece along which colour and extinction are linear: sum[0 ... 2] is
 * premultiplied colour, sum[3] the optical depth so far. Gauss & Legendre of five points, degree 9,
 * on panels of an optical depth of 1/4 at most: below 1e-12.
 */
static inline void segment_add_linear(
  const double a[4], const double b[4], double length, double sum[4])
{
  static const double node[5] = { 0.046910077030668004, 0.23076534494715845, 0.5,
    0.76923465505284155, 0.953089922969332 };
  static const double weight[5] = { 0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
    0.23931433524968324, 0.11846344252809454 };
  const double before = sum[3];
  const double steps = ceil(fmin(fmax(4 * fmax(a[3], b[3]) * length, 1), 4000));
  for (double p = 0; p < steps && sum[3] < 40; ++p)
  {
    for (int k = 0; k < 5; ++k)
    {
      const double u = (p + node[k]) / steps;
      const double sigma = a[3] + u * (b[3] - a[3]);
      const double tau = before + u * length * (a[3] + 0.5 * u * (b[3] - a[3]));
      const double w = weight[k] / steps * length * sigma * exp(-tau);
      for (int c = 0; c < 3; ++c)
      {
        sum[c] += w * (a[c] + u * (b[c] - a[c]));
      }
    }
  }
  sum[3] = before + 0.5 * length * (a[3] + b[3]);
}

/* The same of a segment between two places in the entries. */
static inline void segment_add(
  const segment_entries* e, double x0, double x1, double length, double sum[4])
{
  double a[4], b[4];
  segment_classify_entries(e, x0, a);
  for (double x = x0;;)
  {
    double next = x1 > x0 ? fmin(floor(x) + 1, x1) : fmax(ceil(x) - 1, x1);
    segment_classify_entries(e, next, b);
    segment_add_linear(a, b, x1 != x0 ? length * ((next - x) / (x1 - x0)) : length, sum);
    if (next == x1)
    {
      return;
    }
    x = next;
    for (int c = 0; c < 4; ++c)
    {
      a[c] = b[c];
    }
  }
}

/* Premultiplied colour and opacity of one segment. */
static inline void segment_integrate(
  const segment_entries* e, double x0, double x1, double length, double rgba[4])
{
  rgba[0] = rgba[1] = rgba[2] = rgba[3] = 0;
  segment_add(e, x0, x1, length, rgba);
  rgba[3] = -expm1(-rgba[3]);
}

#endif
