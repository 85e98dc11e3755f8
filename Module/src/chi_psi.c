/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Moreland & Angel, "A Fast High Accuracy Volume Renderer for Unstructured Data", 2004. */

#include "chi_preintegration_internal.h"

#include <math.h>

enum
{
  POINTS = 5
};

/* Gauss & Legendre on (0, 1), degree 9. */
static const double node[POINTS] = { 0.046910077030668004, 0.23076534494715845, 0.5,
  0.76923465505284155, 0.953089922969332 };
static const double weight[POINTS] = { 0.11846344252809454, 0.23931433524968324,
  0.28444444444444444, 0.23931433524968324, 0.11846344252809454 };

double chi_psi(double front, double back)
{
  const double dark = 37; /* e^-37 < 1e-16 */
  if (!(front <= 1e300 && back <= 1e300))
  {
    return 0;
  }
  /* The optical depth at u is front u + half_rise u^2; up to where it is `dark`, or the end. */
  const double half_rise = 0.5 * (back - front);
  const double end =
    front + half_rise <= dark ? 1 : 2 * dark / (front + sqrt(front * front + 4 * half_rise * dark));
  /* Panels of equal length where the integrand is nearly a polynomial; else u = end v^2 crowds them
   * to where it falls. */
  const double most = fmax(front, back);
  const int crowded = most > 4, panels = crowded ? 6 : most > 1 ? 2 : 1;
  double sum = 0;
  for (int panel = 0; panel < panels; ++panel)
  {
    for (int k = 0; k < POINTS; ++k)
    {
      const double v = (panel + node[k]) / panels;
      const double u = crowded ? end * v * v : v;
      sum += weight[k] * (crowded ? 2 * end * v : 1) * exp(-u * (front + half_rise * u));
    }
  }
  return sum / panels;
}
