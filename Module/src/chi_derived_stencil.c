/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Weights of differences: the derivatives of the polynomial through the samples of a window. */

#include "chi_derived_internal.h"

#include <math.h>

/* First and second derivatives at `here` of the Lagrange polynomials of `count` places. Each is a
 * product of (t - t_j) / (t_k - t_j) with t from here, of which the terms up to t^2 are kept.
 * Documentation/theory/derived.md, equation (7). */
static void differentiate(
  size_t count, const double* place, double here, double first[], double second[])
{
  for (size_t k = 0; k < count; ++k)
  {
    double c[3] = { 1, 0, 0 };
    for (size_t j = 0; j < count; ++j)
    {
      if (j != k)
      {
        const double t = here - place[j], scale = 1 / (place[k] - place[j]);
        c[2] = (c[1] + t * c[2]) * scale;
        c[1] = (c[0] + t * c[1]) * scale;
        c[0] = t * c[0] * scale;
      }
    }
    first[k] = c[1];
    second[k] = 2 * c[2];
  }
}

static size_t window_start(size_t i, size_t reach, size_t size, size_t count)
{
  const size_t start = i > reach ? i - reach : 0;
  return start + size > count ? count - size : start;
}

/* The weights at one sample of the nearest `size` ones, one-sided at the ends, by derivative. */
static void weigh(const chi_derived_axis* axis, size_t i, size_t size, const double* at,
  double spacing, int derivative)
{
  const size_t reach = (size_t)axis->order / 2;
  const size_t start = window_start(i, reach, size, axis->count);
  double place[CHI_DERIVED_WIDTH], w[2][CHI_DERIVED_WIDTH];
  for (size_t k = 0; k < size; ++k) /* uniform ones in steps, whose weights are exact fractions */
  {
    place[k] = at ? at[start + k] - at[i] : (double)(start + k) - (double)i;
  }
  differentiate(size, place, 0, w[0], w[1]);
  double* const to = axis->weights[derivative] + i * CHI_DERIVED_WIDTH + (start - axis->start[i]);
  for (size_t k = 0; k < size; ++k)
  {
    to[k] = at ? w[derivative][k] : w[derivative][k] / (derivative ? spacing * spacing : spacing);
  }
}

static int is_monotonic(size_t count, const double* at)
{
  int up = 1, down = 1;
  for (size_t i = 0; i < count; ++i)
  {
    if (!isfinite(at[i]))
    {
      return 0;
    }
    up = up && (i == 0 || at[i] > at[i - 1]);
    down = down && (i == 0 || at[i] < at[i - 1]);
  }
  return up || down;
}

chi_status chi_derived_axis_create(const chi_exec* exec, chi_derived_axis* axis, size_t count,
  int order, double spacing, const double* at)
{
  const size_t most = (size_t)order + 2;
  *axis = (chi_derived_axis){
    .count = count, .width = count < most ? count : most, .order = order, .is_uniform = !at
  };
  if (at && !is_monotonic(count, at))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  axis->start = (size_t*)chi_alloc(exec, count, sizeof(size_t));
  for (int d = 0; d < 2; ++d)
  {
    axis->weights[d] = (double*)chi_alloc(exec, count, CHI_DERIVED_WIDTH * sizeof(double));
  }
  if (!axis->start || !axis->weights[0] || !axis->weights[1])
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(axis->weights[0], 0, count * CHI_DERIVED_WIDTH * sizeof(double));
  memset(axis->weights[1], 0, count * CHI_DERIVED_WIDTH * sizeof(double));
  const size_t reach = (size_t)order / 2;
  const size_t narrow = count < (size_t)order + 1 ? count : (size_t)order + 1;
  for (size_t i = 0; i < count; ++i)
  {
    axis->start[i] = window_start(i, reach, axis->width, count);
    /* symmetric differences of order + 1 samples have second derivatives of that order too */
    const int is_symmetric = !at && i >= reach && i + reach < count;
    weigh(axis, i, narrow, at, spacing, 0);
    weigh(axis, i, is_symmetric ? narrow : axis->width, at, spacing, 1);
  }
  return CHI_OK;
}

void chi_derived_axis_destroy(const chi_exec* exec, chi_derived_axis* axis)
{
  if (axis->start)
  {
    chi_free(exec, axis->start, axis->count, sizeof(size_t));
  }
  for (int d = 0; d < 2; ++d)
  {
    if (axis->weights[d])
    {
      chi_free(exec, axis->weights[d], axis->count, CHI_DERIVED_WIDTH * sizeof(double));
    }
  }
  memset(axis, 0, sizeof *axis);
}
