/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_FIT_H
#define CHI_DERIVED_FIT_H

#include <stddef.h>

enum
{
  CHI_FIT_MOST = 400, /* neighbours: two rings of hexahedra are 124, of tetrahedra about 100 */
  CHI_FIT_UNKNOWNS = 9
};

/* Rows of a fit: neighbours relative to the point, in a length about their distance. */
typedef struct chi_fit
{
  size_t count;
  double length;
  double x[CHI_FIT_MOST][3], weight[CHI_FIT_MOST];
  double column[CHI_FIT_UNKNOWNS + 1][CHI_FIT_MOST]; /* the last: differences of values */
} chi_fit;

/* What it finds. */
typedef struct chi_fit_result
{
  double first[3], second[6]; /* xx, yy, zz, xy, xz, yz */
  int rank, is_complete;      /* whether every second derivative was found */
} chi_fit_result;

/* A quadratic polynomial through the point whose neighbours are in x, weight and the last column,
 * within the space of at most `dimension` that these span. Overwrites the columns. */
chi_fit_result chi_fit_solve(chi_fit* fit, size_t dimension);

#endif
