/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SPLINE_CURVES_H
#define CHI_SPLINE_CURVES_H

/* Lines by which the spline is judged, in its test and its benchmark. */

#include <chiaroscuro/chi_spline.h>

#include "chi_test.h"

/* One line of `n` points; `closed` repeats the first at the end. */
typedef struct line
{
  double (*x)[3];
  int64_t offsets[2];
  size_t n;
} line;

static inline line make_line(size_t n)
{
  line l = { malloc(n * sizeof *l.x), { 0, (int64_t)n }, n };
  return l;
}

typedef enum plane_curve
{
  ARC,    /* three quarters of the unit circle */
  SINE,   /* two periods, length 4 pi */
  SPIRAL, /* radius 1 to 3 in two turns */
  CIRCLE, /* the unit circle, first and last point equal bit for bit */
  PLANE_CURVES
} plane_curve;

static const char* const plane_curve_name[PLANE_CURVES] = { "arc", "sine", "spiral", "circle" };

static inline void plane_curve_point(plane_curve kind, double t, double x[3])
{
  const double pi = 3.14159265358979324;
  const double a = (kind == ARC ? 1.5 : kind == CIRCLE ? 2 : 4) * pi * t;
  const double r = kind == SPIRAL ? 1 + 2 * t : 1;
  x[0] = kind == SINE ? a : r * cos(a);
  x[1] = kind == SINE ? sin(a) : r * sin(a);
  x[2] = 0;
}

/* True total turning, radians, and changes of curvature's sign. */
static inline double plane_curve_turning(plane_curve kind, int* sign_changes)
{
  const double pi = 3.14159265358979324;
  *sign_changes = kind == SINE ? 3 : 0;
  return kind == ARC ? 1.5 * pi
    : kind == CIRCLE ? 2 * pi
    : kind == SINE   ? 8 * 0.25 * pi /* from slope 1 to -1 and back, four half waves */
                   /* tangent at the angle a + atan2(r, dr/da), with dr/da = 1 / (2 pi) */
                   : 4 * pi + atan2(3, 0.5 / pi) - atan2(1, 0.5 / pi);
}

static inline line make_plane_curve(plane_curve kind, size_t n)
{
  line l = make_line(n);
  for (size_t i = 0; i < n; ++i)
  {
    plane_curve_point(kind, (double)i / (double)(n - 1), l.x[i]);
  }
  if (kind == CIRCLE)
  {
    memcpy(l.x[n - 1], l.x[0], sizeof l.x[0]);
  }
  return l;
}

/* A straight line of length 10 along x, with uniform noise of at most eps in y and z. */
static inline line make_noisy_line(size_t n, double eps, uint32_t seed)
{
  line l = make_line(n);
  for (size_t i = 0; i < n; ++i)
  {
    l.x[i][0] = 10 * (double)i / (double)n;
    l.x[i][1] = eps * (2 * chi_test_random(&seed) - 1);
    l.x[i][2] = eps * (2 * chi_test_random(&seed) - 1);
  }
  return l;
}

/* Total turning by dense sampling, radians; changes of the sign of curvature about z, where the
 * turn between samples exceeds 1e-7 (double noise of a direction over a step of 1e-3 is 1e-13 /
 * 1e-3). */
static inline double turning(const chi_spline_curve* c, int* sign_changes)
{
  const int steps = 4000;
  double before[3] = { 0 }, total = 0;
  int sign = 0;
  *sign_changes = 0;
  for (int i = 0; i <= steps; ++i)
  {
    double x[2][3];
    chi_spline_evaluate(c, (double)i / steps, 1, x);
    const double* const d = x[1];
    const double speed = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double t[3] = { d[0] / speed, d[1] / speed, d[2] / speed };
    if (i > 0)
    {
      const double cross[3] = { before[1] * t[2] - before[2] * t[1],
        before[2] * t[0] - before[0] * t[2], before[0] * t[1] - before[1] * t[0] };
      const double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
      total += atan2(sine, before[0] * t[0] + before[1] * t[1] + before[2] * t[2]);
      if (fabs(cross[2]) > 1e-7)
      {
        const int now = cross[2] > 0 ? 1 : -1;
        *sign_changes += sign && now != sign;
        sign = now;
      }
    }
    memcpy(before, t, sizeof t);
  }
  return total;
}

#endif
