/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_PREINTEGRATION_INTERNAL_H
#define CHI_PREINTEGRATION_INTERNAL_H

#include "chi_internal.h"

#include <chiaroscuro/chi_preintegration.h>

#include <math.h>

/* Moreland & Angel's psi to 1e-8: what of the back end's colour passes, before the transmittance
 * is taken off; theory/preintegration.md, Eq. 4. Optical depths may be infinite. */
double chi_psi(double front, double back);

/* The table of full pre-integration, size[0] = size[1] places of scalars by size[2] optical depths,
 * each >= 4, the latter <= 64, and depth[.][3], the entries' places in it. CHI_OK,
 * CHI_ERROR_OUT_OF_MEMORY or CHI_ERROR_CANCELLED. */
chi_status chi_fill_full(const chi_exec* exec, const float (*color)[4], float (*depth)[4],
  size_t count, const int32_t size[3], float (*full)[4]);

enum
{
  CHI_FULL_THICK = 8 /* the last entry of the third axis, whose gamma is 1, stands for so many times
                        the optical depth of the one before */
};

/* The same table, whose red is the mean scalar of what is seen (a colour that rises from 0 to 1
 * over the 1-D tables), with red the mean place of what is seen, from front (0) to back (1). */
void chi_center_full(
  const float (*depth)[4], size_t count, const int32_t size[3], float (*full)[4]);

/* Colour and extinction at a place of the 1-D tables. */
static inline void chi_classify_at(const float (*color)[4], int count, double x, double rgba[4])
{
  const int i = x < count - 1 ? (int)x : count - 2;
  for (int c = 0; c < 4; ++c)
  {
    rgba[c] = (double)color[i][c] + (x - i) * ((double)color[i + 1][c] - (double)color[i][c]);
  }
}

/* Adds the integrals of colour x extinction, and of extinction, over a way along which both are
 * linear from a to b: Simpson's rule is exact. */
static inline void chi_add_products(const double a[4], const double b[4], double way, double sum[4])
{
  for (int c = 0; c < 3; ++c)
  {
    sum[c] += way * (a[c] * (2 * a[3] + b[3]) + b[c] * (a[3] + 2 * b[3])) / 6;
  }
  sum[3] += way * 0.5 * (a[3] + b[3]);
}

/* The same from place `from` to `to` of the 1-D tables. */
static inline void chi_integrate_entries(
  const float (*color)[4], int count, double from, double to, double sum[4])
{
  double at[4], next[4];
  chi_classify_at(color, count, from, at);
  for (double x = from; x < to;)
  {
    const double y = fmin(floor(x) + 1, to);
    chi_classify_at(color, count, y, next);
    chi_add_products(at, next, y - x, sum);
    memcpy(at, next, sizeof at);
    x = y;
  }
}

#endif
