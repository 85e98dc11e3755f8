/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Segments whose colour is given at both ends, and linear between: all that is to be known of them
 * is how far from the front what is seen of them lies in the mean (theory/preintegration.md, Eq.
 * 9). As a scalar that is what the full table holds of a colour that rises with the scalar.
 */

#include "chi_preintegration_internal.h"

/* A scalar axis of the table: where node k lies in the 1-D tables, 0 ... 1. */
static double find_node(const float (*depth)[4], size_t count, int32_t node, size_t* entry)
{
  while (*entry + 2 < count && depth[*entry + 1][3] < (float)node)
  {
    ++*entry;
  }
  const double at = (double)depth[*entry][3], next = (double)depth[*entry + 1][3];
  return ((double)*entry + (node - at) / (next - at)) / (double)(count - 1);
}

/* Where extinction is even: the mean of u, weighted by e^-(tau u). */
static double even_center(double tau)
{
  return tau > 1e-3 ? 1 / tau + 1 / -expm1(tau) : 0.5 - tau / 12;
}

void chi_center_full(const float (*depth)[4], size_t count, const int32_t size[3], float (*full)[4])
{
  double node[512];
  size_t entry = 0;
  for (int32_t i = 0; i < size[0]; ++i)
  {
    node[i] = find_node(depth, count, i, &entry);
  }
  const int32_t end = size[2] - 1;
  for (int32_t k = 0; k <= end; ++k)
  {
    const double tau = k < end ? (double)k / (end - k) : (double)CHI_FULL_THICK * (end - 1);
    for (int32_t back = 0; back < size[1]; ++back)
    {
      for (int32_t front = 0; front < size[0]; ++front, ++full)
      {
        const double way = node[back] - node[front];
        const double center =
          back == front ? even_center(tau) : ((double)full[0][0] - node[front]) / way;
        full[0][0] = (float)fmin(fmax(center, 0), 1);
      }
    }
  }
}
