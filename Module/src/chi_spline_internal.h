/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SPLINE_INTERNAL_H
#define CHI_SPLINE_INTERNAL_H

#include <chiaroscuro/chi_spline.h>

#include "chi_internal.h"

#include <math.h>

/* Index i with knots[i] <= u < knots[i + 1] within the domain knots[degree] ... knots[count], at
 * its end the last interval that has a length; `hint` is where to look first. */
static inline size_t chi_spline_span(const chi_spline_curve* c, double u, size_t hint)
{
  size_t low = (size_t)c->degree, high = c->count;
  if (hint >= low && hint < high && c->knots[hint] <= u && u < c->knots[hint + 1])
  {
    return hint;
  }
  if (u >= c->knots[high])
  {
    size_t i = high - 1;
    while (i > low && !(c->knots[i] < c->knots[i + 1]))
    {
      --i;
    }
    return i;
  }
  while (high - low > 1)
  {
    const size_t middle = low + (high - low) / 2;
    if (c->knots[middle] <= u)
    {
      low = middle;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

/* The degree + 1 basis functions that are not zero on a span. de Boor, "On calculating with
 * B-splines", 1972, Eq. 8. */
static inline void chi_spline_basis(
  const double* knots, size_t span, int degree, double u, double n[4])
{
  double left[4], right[4];
  n[0] = 1;
  for (int j = 1; j <= degree; ++j)
  {
    left[j] = u - knots[span + 1 - (size_t)j];
    right[j] = knots[span + (size_t)j] - u;
    double saved = 0;
    for (int r = 0; r < j; ++r)
    {
      const double width = right[r + 1] + left[j - r];
      const double share = width > 0 ? n[r] / width : 0;
      n[r] = saved + right[r + 1] * share;
      saved = left[j - r] * share;
    }
    n[j] = saved;
  }
}

static inline double chi_distance(const double a[3], const double b[3])
{
  const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

#endif
