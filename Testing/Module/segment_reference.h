/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SEGMENT_REFERENCE_H
#define CHI_SEGMENT_REFERENCE_H

/*
 * The volume rendering integral of one segment by quadrature in double: the slow path by which the
 * tables and kernels are judged. It shares nothing with them but the transfer function.
 */

#include <math.h>
#include <stddef.h>

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

/* Gauss & Legendre on (0, 1): nodes, then weights, of 2, 3 and 5 points. */
static const double segment_gauss[3][2][5] = { { { 0.21132486540518712, 0.78867513459481288 },
                                                 { 0.5, 0.5 } },
  { { 0.11270166537925831, 0.5, 0.88729833462074169 },
    { 0.27777777777777778, 0.44444444444444444, 0.27777777777777778 } },
  { { 0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155, 0.953089922969332 },
    { 0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324,
      0.11846344252809454 } } };

/*
 * Adds, behind what is there, a piece along which colour and extinction are linear: sum[0 ... 2] is
 * premultiplied colour, sum[3] the optical depth so far. Five points, degree 9, on panels of an
 * optical depth of 1/4 at most: below 1e-12. Of what is thinner fewer points do: with 2 of them the
 * error is that of the fourth derivative, a tau^3 / 700 at most, with 3 less than tau^5 / 1e5.
 */
static inline void segment_add_linear(
  const double a[4], const double b[4], double length, double sum[4])
{
  const double before = sum[3], most = fmax(a[3], b[3]) * length;
  const int rule = most < 1e-3 ? 0 : most < 0.03 ? 1 : 2, points = rule < 2 ? rule + 2 : 5;
  const double *const node = segment_gauss[rule][0], *const weight = segment_gauss[rule][1];
  const double steps = ceil(fmin(fmax(4 * most, 1), 4000));
  for (double p = 0; p < steps && sum[3] < 40; ++p)
  {
    for (int k = 0; k < points; ++k)
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

/* The same of a segment between two places in the entries; with `colors` its colour is not theirs
 * but linear from the first of these to the second. */
static inline void segment_add_direct(const segment_entries* e, const double (*colors)[3],
  double x0, double x1, double length, double sum[4])
{
  double a[4], b[4];
  segment_classify_entries(e, x0, a);
  for (int c = 0; c < 3 && colors; ++c)
  {
    a[c] = colors[0][c];
  }
  for (double x = x0;;)
  {
    double next = x1 > x0 ? fmin(floor(x) + 1, x1) : fmax(ceil(x) - 1, x1);
    segment_classify_entries(e, next, b);
    for (int c = 0; c < 3 && colors; ++c)
    {
      const double u = next == x1 ? 1 : (next - x0) / (x1 - x0);
      b[c] = colors[0][c] + u * (colors[1][c] - colors[0][c]);
    }
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

static inline void segment_add(
  const segment_entries* e, double x0, double x1, double length, double sum[4])
{
  segment_add_direct(e, NULL, x0, x1, length, sum);
}

/* The same of any function of the scalar, which is linear from s0 to s1: cut in halves until linear
 * pieces agree with those twice as long to `tolerance`, and to at least 2^-`least` of it, so that
 * no feature wider than that is missed. */
static inline void segment_add_function(segment_classify classify, const void* data, double s0,
  double s1, double length, double tolerance, int least, double sum[4])
{
  double a[4], middle[4], b[4], once[4], twice[4];
  classify(data, s0, a);
  classify(data, 0.5 * (s0 + s1), middle);
  classify(data, s1, b);
  for (int c = 0; c < 4; ++c)
  {
    once[c] = twice[c] = sum[c];
  }
  segment_add_linear(a, b, length, once);
  segment_add_linear(a, middle, 0.5 * length, twice);
  segment_add_linear(middle, b, 0.5 * length, twice);
  double error = fabs(once[3] - twice[3]) * exp(-sum[3]);
  for (int c = 0; c < 3; ++c)
  {
    error = fmax(error, fabs(once[c] - twice[c]));
  }
  if ((least <= 0 && error <= tolerance) || least < -30)
  {
    for (int c = 0; c < 4; ++c)
    {
      sum[c] = twice[c];
    }
    return;
  }
  const double s = 0.5 * (s0 + s1);
  segment_add_function(classify, data, s0, s, 0.5 * length, 0.5 * tolerance, least - 1, sum);
  segment_add_function(classify, data, s, s1, 0.5 * length, 0.5 * tolerance, least - 1, sum);
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
