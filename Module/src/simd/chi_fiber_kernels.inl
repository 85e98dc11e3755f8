/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_fiber_kernels.h"

#include <math.h>

/* Without branches, so that the compiler makes vectors of it. */
static int classify(const double p[2], const double d[2], double square, const double* values,
  size_t count, unsigned number, uint64_t* words)
{
  const double px = p[0], py = p[1], dx = d[0], dy = d[1];
  const uint64_t one = (uint64_t)1 << number;
  uint64_t hidden = 0;
  for (size_t i = 0; i < count; ++i)
  {
    const double u = values[2 * i] - px, v = values[2 * i + 1] - py;
    const double a = dx * v, b = dy * u, c = dx * u, e = dy * v;
    const double area = a - b, along = c + e, rest = along - square;
    /* ccwerrboundA of Shewchuk 1997, as of chi_fiber_area; the others with room for the square's
     * rounding */
    const double bound = 0x1.8p-52 * (1 + 0x1p-40) * (fabs(a) + fabs(b));
    const double error = 0x1p-50 * (fabs(c) + fabs(e) + square);
    const uint64_t left = area > 0 ? one << CHI_FIBER_LEFT : 0;
    const uint64_t before = along < -error ? one << CHI_FIBER_BEFORE : 0;
    const uint64_t beyond = rest > error ? one << CHI_FIBER_BEYOND : 0;
    const uint64_t maybe_before = along <= error ? one << CHI_FIBER_MAYBE_BEFORE : 0;
    const uint64_t maybe_beyond = rest >= -error ? one << CHI_FIBER_MAYBE_BEYOND : 0;
    words[i] |= left | before | beyond | maybe_before | maybe_beyond;
    hidden |= fabs(area) <= bound ? one : 0;
  }
  return hidden != 0;
}
