/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_MAT4_H
#define CHI_MAT4_H

/* Affine 4 x 4 matrices, row-major, double. */

#include <math.h>
#include <stdint.h>

static inline void chi_mat4_multiply(const double a[16], const double b[16], double out[16])
{
  double c[16];
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      c[4 * i + j] = a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] +
        a[4 * i + 3] * b[12 + j];
    }
  }
  for (int i = 0; i < 16; ++i)
  {
    out[i] = c[i];
  }
}

/* 0 when the 3 x 3 part is singular to working precision, relative to its columns, or not finite.
 */
static inline int32_t chi_mat4_invert_affine(const double m[16], double out[16])
{
  const double x[3] = { m[5] * m[10] - m[6] * m[9], m[6] * m[8] - m[4] * m[10],
    m[4] * m[9] - m[5] * m[8] };
  const double det = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
  double size = 1;
  for (int j = 0; j < 3; ++j)
  {
    size *= sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
  }
  /* 1e-12: a box sheared until its height is 1e-12 of its edges has no thickness to integrate. */
  if (!(fabs(det) > 1e-12 * size) || !isfinite(det) || !isfinite(m[3] + m[7] + m[11]))
  {
    return 0;
  }
  double inv[9] = { x[0], m[2] * m[9] - m[1] * m[10], m[1] * m[6] - m[2] * m[5], x[1],
    m[0] * m[10] - m[2] * m[8], m[2] * m[4] - m[0] * m[6], x[2], m[1] * m[8] - m[0] * m[9],
    m[0] * m[5] - m[1] * m[4] };
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      out[4 * i + j] = inv[3 * i + j] / det;
    }
    out[4 * i + 3] = -(out[4 * i] * m[3] + out[4 * i + 1] * m[7] + out[4 * i + 2] * m[11]);
  }
  out[12] = out[13] = out[14] = 0;
  out[15] = 1;
  return 1;
}

#endif
