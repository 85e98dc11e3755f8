/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Least squares: the quadratic polynomial that fits a point's neighbours best. */

#include "chi_derived_fit.h"

#include <math.h>
#include <string.h>

static const double spread = 1e-6; /* of neighbours along an axis, that it counts as one */
/* Of a column: the least share that no earlier one explains. What is left of fields of third degree
 * is magnified by its inverse: bent layers, two at a time, must not pass for knowledge of a second
 * derivative across. On one side of a point two layers leave 0.3. */
static const double independent = 0.1;

/* Eigenvectors of a symmetric matrix by Jacobi's rotations, as columns, the largest first. */
static void find_frame(double m[3][3], double frame[3][3], double value[3])
{
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      frame[a][b] = a == b;
    }
  }
  for (int turn = 0; turn < 30; ++turn) /* converges quadratically: ten would do */
  {
    static const int pair[3][2] = { { 0, 1 }, { 0, 2 }, { 1, 2 } };
    const int a = pair[turn % 3][0], b = pair[turn % 3][1];
    if (m[a][b] == 0)
    {
      continue;
    }
    const double theta = (m[b][b] - m[a][a]) / (2 * m[a][b]);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; ++k)
    {
      const double x = m[k][a], y = m[k][b];
      m[k][a] = c * x - s * y;
      m[k][b] = s * x + c * y;
    }
    for (int k = 0; k < 3; ++k)
    {
      const double x = m[a][k], y = m[b][k], u = frame[k][a], v = frame[k][b];
      m[a][k] = c * x - s * y;
      m[b][k] = s * x + c * y;
      frame[k][a] = c * u - s * v;
      frame[k][b] = s * u + c * v;
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    value[a] = m[a][a];
  }
  for (int i = 0; i < 3; ++i) /* sort three */
  {
    const int a = i % 2, b = a + 1;
    if (value[a] < value[b])
    {
      const double swap = value[a];
      value[a] = value[b];
      value[b] = swap;
      for (int k = 0; k < 3; ++k)
      {
        const double x = frame[k][a];
        frame[k][a] = frame[k][b];
        frame[k][b] = x;
      }
    }
  }
}

/* Axes for the fit, those that the neighbours spread along most first, and how many they span. */
static size_t choose_frame(const chi_fit* f, size_t dimension, double frame[3][3])
{
  double m[3][3] = { { 0 } }, value[3];
  for (size_t k = 0; k < f->count; ++k)
  {
    for (int a = 0; a < 3; ++a)
    {
      for (int b = 0; b < 3; ++b) /* of directions: the trace is 1 */
      {
        m[a][b] += f->x[k][a] * f->x[k][b] * f->weight[k] * f->weight[k] / (double)f->count;
      }
    }
  }
  find_frame(m, frame, value);
  const size_t spanned = value[2] > spread * spread ? 3
    : value[1] > spread * spread                    ? 2
    : value[0] > 0                                  ? 1
                                                    : 0;
  return spanned < dimension ? spanned : dimension;
}

static double dot(const double* a, const double* b, size_t count)
{
  double sum[4] = { 0, 0, 0, 0 };
  size_t i = 0;
  for (; i + 4 <= count; i += 4)
  {
    for (size_t k = 0; k < 4; ++k)
    {
      sum[k] += a[i + k] * b[i + k];
    }
  }
  for (; i < count; ++i)
  {
    sum[0] += a[i] * b[i];
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static void subtract(double* from, double factor, const double* what, size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    from[i] -= factor * what[i];
  }
}

/* Least squares by Gram and Schmidt in the order of the columns; one that the earlier ones explain
 * has no part in the answer. Returns the bits of those that have. */
static unsigned solve(chi_fit* f, size_t unknowns, double answer[])
{
  double r[CHI_FIT_UNKNOWNS][CHI_FIT_UNKNOWNS + 1];
  unsigned kept = 0;
  for (size_t j = 0; j < unknowns; ++j)
  {
    double* const column = f->column[j];
    const double norm = sqrt(dot(column, column, f->count));
    for (size_t i = 0; i < j; ++i)
    {
      r[i][j] = kept >> i & 1 ? dot(f->column[i], column, f->count) : 0;
      if (kept >> i & 1)
      {
        subtract(column, r[i][j], f->column[i], f->count);
      }
    }
    const double rest = sqrt(dot(column, column, f->count));
    r[j][j] = rest;
    if (rest > independent * norm)
    {
      kept |= 1u << j;
      for (size_t k = 0; k < f->count; ++k)
      {
        column[k] /= rest;
      }
    }
  }
  for (size_t i = 0; i < unknowns; ++i)
  {
    r[i][CHI_FIT_UNKNOWNS] =
      kept >> i & 1 ? dot(f->column[i], f->column[CHI_FIT_UNKNOWNS], f->count) : 0;
    if (kept >> i & 1)
    {
      subtract(f->column[CHI_FIT_UNKNOWNS], r[i][CHI_FIT_UNKNOWNS], f->column[i], f->count);
    }
  }
  for (size_t i = unknowns; i-- > 0;)
  {
    answer[i] = 0;
    if (kept >> i & 1)
    {
      double x = r[i][CHI_FIT_UNKNOWNS];
      for (size_t j = i + 1; j < unknowns; ++j)
      {
        x -= kept >> j & 1 ? r[i][j] * answer[j] : 0;
      }
      answer[i] = x / r[i][i];
    }
  }
  return kept;
}

/* The columns of a fit within `n` dimensions: first powers, squares, products. */
static size_t fill_columns(chi_fit* f, size_t n, double frame[3][3])
{
  for (size_t k = 0; k < f->count; ++k)
  {
    const double w = f->weight[k];
    double u[3] = { 0, 0, 0 };
    for (size_t a = 0; a < n; ++a)
    {
      u[a] = f->x[k][0] * frame[0][a] + f->x[k][1] * frame[1][a] + f->x[k][2] * frame[2][a];
    }
    size_t j = 2 * n;
    for (size_t a = 0; a < n; ++a)
    {
      f->column[a][k] = w * u[a];
      f->column[n + a][k] = 0.5 * w * u[a] * u[a];
      for (size_t b = a + 1; b < n; ++b)
      {
        f->column[j++][k] = w * u[a] * u[b];
      }
    }
  }
  return n * (n + 3) / 2;
}

/* Documentation/theory/derived.md, equation (8). */
chi_fit_result chi_fit_solve(chi_fit* f, size_t dimension)
{
  chi_fit_result d = { { 0 }, { 0 }, 0, 0 };
  double frame[3][3], answer[CHI_FIT_UNKNOWNS] = { 0 }, local[3][3] = { { 0 } };
  const size_t n = choose_frame(f, dimension, frame);
  const size_t unknowns = fill_columns(f, n, frame);
  const unsigned kept = solve(f, unknowns, answer);
  d.is_complete = n > 0 && kept == (1u << unknowns) - 1;
  d.rank = (int)n;
  size_t j = 2 * n;
  for (size_t a = 0; a < n; ++a)
  {
    local[a][a] = answer[n + a];
    for (size_t b = a + 1; b < n; ++b)
    {
      local[a][b] = local[b][a] = answer[j++];
    }
  }
  static const int at[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
  for (size_t a = 0; a < n; ++a)
  {
    for (int x = 0; x < 3; ++x)
    {
      d.first[x] += frame[x][a] * answer[a] / f->length;
    }
    for (size_t b = 0; b < n; ++b)
    {
      for (int k = 0; k < 6; ++k)
      {
        d.second[k] +=
          frame[at[k][0]][a] * local[a][b] * frame[at[k][1]][b] / (f->length * f->length);
      }
    }
  }
  return d;
}
