/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Sums over processes. Numbers become two integers of 40 bits each, in units of the largest of them
 * all, so that their sum does not depend on the order, and every process gets the same bits. */

#include "chi_histogram_internal.h"

#include <math.h>

enum
{
  LIMB_BITS = 40, /* 2^22 processes do not overflow */
  CHUNK = 512
};

chi_status chi_histogram_agree(
  const chi_histogram_plan* plan, chi_status status, double* values, size_t count)
{
  const chi_histogram_reduction* const all = &plan->reduction;
  double worst[4] = { status };
  if (!all->max_f64)
  {
    return status;
  }
  for (size_t i = 0; i < count; ++i)
  {
    worst[1 + i] = values[i];
  }
  if (all->max_f64(all->user, worst, count + 1))
  {
    return CHI_ERROR_CANCELLED;
  }
  for (size_t i = 0; i < count; ++i)
  {
    values[i] = worst[1 + i];
  }
  return (chi_status)worst[0];
}

chi_status chi_histogram_sum(const chi_histogram_plan* plan, double* values, size_t count)
{
  const chi_histogram_reduction* const all = &plan->reduction;
  double most = 0;
  int exponent;
  if (!all->max_f64)
  {
    return CHI_OK;
  }
  for (size_t i = 0; i < count; ++i)
  {
    const double size = fabs(values[i]);
    most = size > most ? size : most;
  }
  chi_status status = chi_histogram_agree(plan, CHI_OK, &most, 1);
  if (status != CHI_OK || !(most > 0))
  {
    return status;
  }
  frexp(most, &exponent);
  for (size_t first = 0; first < count; first += CHUNK)
  {
    const size_t n = chi_grid_chunk_end(first, CHUNK, count) - first;
    int64_t limb[2 * CHUNK];
    for (size_t i = 0; i < n; ++i)
    {
      const double x = ldexp(values[first + i], LIMB_BITS - exponent), whole = rint(x);
      limb[2 * i] = (int64_t)whole;
      limb[2 * i + 1] = (int64_t)llrint(ldexp(x - whole, LIMB_BITS));
    }
    if (all->sum_i64(all->user, limb, 2 * n))
    {
      return CHI_ERROR_CANCELLED;
    }
    for (size_t i = 0; i < n; ++i)
    {
      const double sum = (double)limb[2 * i] + ldexp((double)limb[2 * i + 1], -LIMB_BITS);
      values[first + i] = ldexp(sum, exponent - LIMB_BITS);
    }
  }
  return status;
}
