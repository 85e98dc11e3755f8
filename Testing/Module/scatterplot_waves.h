/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_WAVES_H
#define CHI_SCATTERPLOT_WAVES_H

/*
 * The plot of Marschner & Lobb's signal (1994) and the distance from the centre over [-1, 1]^3, by
 * quadrature in one dimension. At a height z both depend on the distance r from the axis alone:
 *
 *   f = (1 - sin(pi z / 2) + (1 + cos t) / 4) / 2.5,  t = 12 pi cos(pi r / 2),
 *   g = sqrt(r^2 + z^2),
 *
 * so that lines of bins are crossed at values of r in closed form, and between two of them lies an
 * area of the square in closed form.
 */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WAVES_PI 3.14159265358979323846

__attribute__((unused)) static void waves_values(const double x[3], double value[2])
{
  const double r = sqrt(x[0] * x[0] + x[1] * x[1]), t = 12 * WAVES_PI * cos(WAVES_PI * r / 2);
  value[0] = (1 - sin(WAVES_PI * x[2] / 2) + 0.25 * (1 + cos(t))) / 2.5;
  value[1] = sqrt(r * r + x[2] * x[2]);
}

/* Of the square [-1, 1]^2 nearer to its centre than r. */
static double waves_area(double r)
{
  if (r <= 1)
  {
    return WAVES_PI * r * r;
  }
  return r * r >= 2 ? 4 : WAVES_PI * r * r - 4 * (r * r * acos(1 / r) - sqrt(r * r - 1));
}

static int waves_compare(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

/* Masses of bins[1] x bins[0], all of them 8 where the range holds all values; midpoints of `nodes`
 * heights. */
__attribute__((unused)) static void waves_masses(
  double* mass, const size_t bins[2], const double range[2][2], size_t nodes)
{
  const double root2 = sqrt(2), size0 = range[0][1] - range[0][0];
  const double size1 = range[1][1] - range[1][0];
  double* const r = (double*)malloc((24 * (bins[0] + 2) + bins[1] + 2) * sizeof *r);
  memset(mass, 0, bins[0] * bins[1] * sizeof *mass);
  for (size_t node = 0; node < nodes; ++node)
  {
    const double z = 2 * ((double)node + 0.5) / (double)nodes - 1;
    const double a = (1.25 - sin(WAVES_PI * z / 2)) / 2.5, b = 0.1;
    size_t count = 0;
    r[count++] = 0;
    r[count++] = root2;
    for (size_t j = 0; j <= bins[1]; ++j)
    {
      const double g = range[1][0] + size1 * (double)j / (double)bins[1];
      const double r2 = g * g - z * z;
      if (r2 > 0 && r2 < 2)
      {
        r[count++] = sqrt(r2);
      }
    }
    for (size_t i = 0; i <= bins[0]; ++i)
    {
      const double c = (range[0][0] + size0 * (double)i / (double)bins[0] - a) / b;
      /* t = 2 pi k +- acos c, from 12 pi down to beyond -22.8 */
      for (int k = -4; k <= 6 && fabs(c) < 1; ++k)
      {
        for (int sign = -1; sign <= 1; sign += 2)
        {
          const double at = (2 * k + sign * acos(c) / WAVES_PI) / 12;
          if (fabs(at) < 1 && 2 / WAVES_PI * acos(at) < root2)
          {
            r[count++] = 2 / WAVES_PI * acos(at);
          }
        }
      }
    }
    qsort(r, count, sizeof *r, waves_compare);
    for (size_t s = 1; s < count; ++s)
    {
      const double middle[3] = { (r[s - 1] + r[s]) / 2, 0, z };
      double value[2];
      waves_values(middle, value);
      const double x = (value[0] - range[0][0]) / size0 * (double)bins[0];
      const double y = (value[1] - range[1][0]) / size1 * (double)bins[1];
      if (x >= 0 && y >= 0 && x < (double)bins[0] && y < (double)bins[1])
      {
        mass[(size_t)y * bins[0] + (size_t)x] +=
          (waves_area(r[s]) - waves_area(r[s - 1])) * 2 / (double)nodes;
      }
    }
  }
  free(r);
}

#endif
