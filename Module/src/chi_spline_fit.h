/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SPLINE_FIT_H
#define CHI_SPLINE_FIT_H

#include "chi_spline_internal.h"

/* One line in the handle: its curve, and where its parts start in the handle's slabs. */
typedef struct chi_spline_line
{
  chi_spline_curve curve;
  size_t point_start, control_start, knot_start;
  size_t repeated, non_finite;
  double point_error; /* largest distance of an input point to the curve */
  int unconverged;
} chi_spline_line;

/* What the fit of one line needs besides its result; for the longest line of a chunk. */
typedef struct chi_spline_scratch
{
  double* block;
  size_t bytes;
  double* basis;       /* [n + 4][4] at the samples */
  size_t* span;        /* [n + 4] */
  double* sample;      /* [n + 4][3] what the curve is moved towards */
  double* parameter;   /* [n + 4] */
  double* delta;       /* [n + 4][3] */
  double* coefficient; /* [n + 7][3] candidate */
  double* knot;        /* [n + 11] */
} chi_spline_scratch;

int chi_spline_scratch_create(const chi_exec* exec, chi_spline_scratch* scratch, size_t points);
void chi_spline_scratch_destroy(const chi_exec* exec, chi_spline_scratch* scratch);

/* Fit the cleaned points of a line; scratch is NULL for a polyline. */
void chi_spline_fit_line(chi_spline_line* line, const double* points, double* coefficients,
  double* knots, chi_spline_scratch* scratch, const chi_spline_params* params);

#endif
