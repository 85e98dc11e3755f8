/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_INTERNAL_H
#define CHI_DERIVED_INTERNAL_H

#include "chi_grid_internal.h"
#include "simd/chi_derived_kernels.h"

#include <chiaroscuro/chi_derived.h>

/* Differences along one axis: for sample i the weights of the samples from start[i] on. */
typedef struct chi_derived_axis
{
  size_t count, width; /* samples; those of a window */
  int order, is_uniform;
  size_t* start;
  double* weights[2]; /* [count][CHI_DERIVED_WIDTH] of the first, the second derivative */
} chi_derived_axis;

/* `at`: [count] positions, or NULL: `spacing` apart. CHI_ERROR_INVALID_ARGUMENT where they are not
 * strictly monotonic. Freed in any case. */
chi_status chi_derived_axis_create(const chi_exec* exec, chi_derived_axis* axis, size_t count,
  int order, double spacing, const double* at);
void chi_derived_axis_destroy(const chi_exec* exec, chi_derived_axis* axis);

/* What has been asked for, checked. */
typedef struct chi_derived_job
{
  const chi_exec* exec;
  chi_grid grid;
  chi_array_view values;
  chi_derived_params params;
  chi_derived_arrays arrays;
  chi_derived_counts* counts;
  double value_unit;  /* power of two about the range of the values */
  double length_unit; /* power of two about the spacing */
} chi_derived_job;

/* Whether float will do: neither values nor results have more digits. */
int chi_derived_is_single(const chi_derived_job* job);
/* Whether anything but the gradient is wanted. */
int chi_derived_is_second(const chi_derived_job* job);
/* Of magnitude, second derivative, Laplacian, curvature: the array, and what one of its units is in
 * the units of the job. */
void* chi_derived_array(const chi_derived_job* job, int which);
double chi_derived_unit(const chi_derived_job* job, int which, double unit[2]);
/* Of the magnitude of the gradient in these units: what is not larger counts as 0. */
double chi_derived_threshold(const chi_derived_job* job);

chi_status chi_derived_structured(chi_derived_job* job);
chi_status chi_derived_unstructured(chi_derived_job* job);

/* Range of the finite scalars; infinite and reversed where there are none. */
chi_status chi_derived_find_range(
  const chi_exec* exec, const chi_derived_source* source, double range[2]);

#endif
