/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Included by one file for each instruction set. Loops over slots are independent: compilers turn
 * them into vectors. */

#include "chi_tube_kernels.h"

#include <math.h>

static void place(chi_tube_block* restrict b, size_t first, size_t last)
{
  for (size_t s = first; s <= last; ++s)
  {
    const double x = b->x[0][s + 1] - b->x[0][s];
    const double y = b->x[1][s + 1] - b->x[1][s];
    const double z = b->x[2][s + 1] - b->x[2][s];
    const double inverse = 1 / sqrt(x * x + y * y + z * z);
    b->after[0][s] = x * inverse;
    b->after[1][s] = y * inverse;
    b->after[2][s] = z * inverse;
  }
  for (size_t s = first; s <= last; ++s)
  {
    b->before[0][s] = b->after[0][s - 1];
    b->before[1][s] = b->after[1][s - 1];
    b->before[2][s] = b->after[2][s - 1];
  }
  for (size_t s = first; s <= last; ++s)
  {
    /* The bisector of two unit vectors at angle a is their sum over 2 cos(a / 2); the ring widens
     * along their difference by 1 / cos(a / 2). */
    const double u[3] = { b->before[0][s], b->before[1][s], b->before[2][s] };
    const double v[3] = { b->after[0][s], b->after[1][s], b->after[2][s] };
    /* from the sum: 1 + cos a would lose all its digits towards a reversal */
    const double w[3] = { u[0] + v[0], u[1] + v[1], u[2] + v[2] };
    const double half = 0.5 * sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const int bent = half >= 1e-6; /* a reversal has no bisector */
    const double share = 0.5 / (bent ? half : 1);
    const double d[3] = { v[0] - u[0], v[1] - u[1], v[2] - u[2] };
    const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const int widens = bent && square > 1e-28;
    /* a closed line's seam may turn by more than a mitre takes */
    const double widening = (1 / (half > 0.6 ? half : 0.6) - 1) / (widens ? square : 1);
    for (int a = 0; a < 3; ++a)
    {
      b->tangent[a][s] = bent ? w[a] * share : v[a];
      b->stretch[a][s] = d[a];
    }
    b->widening[s] = widens ? widening : 0;
  }
}

/* Double reflection as one matrix, so that only its product with the normal waits for the ring
 * before. Wang, Juettler, Zheng & Liu 2008, section 4, Table I: reflect by the step between the
 * centers, then by what is then missing to the new tangent. With mirrors p and q,
 *   (1 - 2 q q' / q.q) (1 - 2 p p' / p.p) = 1 - f p p' - g q q' + f g (p.q) q p'. */
static void turns(chi_tube_block* restrict b, size_t first, size_t last)
{
  for (size_t s = first; s <= last; ++s)
  {
    double p[3], t[3], q[3], r[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = b->x[a][s] - b->x[a][s - 1];
      t[a] = b->tangent[a][s - 1];
    }
    const double pp = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    const double f = pp > 0 ? 2 / pp : 0;
    const double along = f * (p[0] * t[0] + p[1] * t[1] + p[2] * t[2]);
    for (int a = 0; a < 3; ++a)
    {
      q[a] = b->tangent[a][s] - (t[a] - along * p[a]);
    }
    const double qq = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    /* Nothing is missing at a reversal; below 1e-8, q's direction is off by more than 1e-8, its
     * rounding over its length, and the normal is better left 1e-8 off the right angle. */
    const double g = qq > 1e-16 ? 2 / qq : 0;
    const double fg = f * g * (p[0] * q[0] + p[1] * q[1] + p[2] * q[2]);
    for (int a = 0; a < 3; ++a)
    {
      r[a] = fg * q[a] - f * p[a];
    }
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 3; ++j)
      {
        b->turn[3 * i + j][s] = (i == j ? 1.0 : 0.0) + (r[i] * p[j] - g * q[i] * q[j]);
      }
    }
    b->chord[s] = sqrt(pp);
  }
}

/* Eight vertices, 24 floats, are whole vectors of every width, and their three coordinates take turns
 * in the same pattern each time. */
static void ring(const chi_tube_ellipse* e, const float* restrict circle, size_t sides,
  float* restrict points, float* restrict normals)
{
  float c[CHI_TUBE_PATTERN], u[CHI_TUBE_PATTERN], v[CHI_TUBE_PATTERN];
  const float* const sine = circle + 3 * sides;
  const size_t count = 3 * sides, whole = count - count % CHI_TUBE_PATTERN;
  for (int pass = 0; pass < 2; ++pass)
  {
    float* restrict const out = pass ? normals : points;
    const float* const center = pass ? e->normal_center : e->center;
    const float* const cosine_axis = pass ? e->normal_cosine : e->cosine;
    const float* const sine_axis = pass ? e->normal_sine : e->sine;
    if (!out)
    {
      continue;
    }
    for (size_t i = 0; i < CHI_TUBE_PATTERN; i += 3)
    {
      for (size_t k = 0; k < 3; ++k)
      {
        c[i + k] = center[k];
        u[i + k] = cosine_axis[k];
        v[i + k] = sine_axis[k];
      }
    }
    for (size_t at = 0; at < whole; at += CHI_TUBE_PATTERN)
    {
      for (size_t i = 0; i < CHI_TUBE_PATTERN; ++i)
      {
        out[at + i] = c[i] + (circle[at + i] * u[i] + sine[at + i] * v[i]);
      }
    }
    for (size_t at = whole; at < count; ++at)
    {
      out[at] = c[at - whole] + (circle[at] * u[at - whole] + sine[at] * v[at - whole]);
    }
  }
}
