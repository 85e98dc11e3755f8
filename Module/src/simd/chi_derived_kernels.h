/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_KERNELS_H
#define CHI_DERIVED_KERNELS_H

/* Rows of numbers for the derivatives on structured grids, once per instruction set and precision:
 * a row holds numbers of one `size`. Nothing is fused: the same bits everywhere. */

#include <chiaroscuro/chi.h>

enum
{
  CHI_DERIVED_WIDTH = 6, /* samples of the widest stencil */
  CHI_DERIVED_TAPS = 5   /* of these beside the middle one */
};

/* Values of a field as a kernel reads them. */
typedef struct chi_derived_source
{
  chi_array_view values;
  int32_t component;     /* -1: magnitude */
  const uint8_t* ghosts; /* of the points, or NULL */
  double factor;
} chi_derived_source;

/* Differences along rows. Where begin <= i < end the taps are the same, at i + offset[k]; elsewhere
 * a window of samples is given by `start` and `table`. */
typedef struct chi_derived_along
{
  size_t count, begin, end, taps, width;
  ptrdiff_t offset[CHI_DERIVED_TAPS];
  const void* weights; /* [taps][count] numbers of a row's type */
  const size_t* start;
  const double* table; /* [count][CHI_DERIVED_WIDTH] */
} chi_derived_along;

/* How fields follow from derivatives: those along the axes, in lengths along these, and the inverse
 * of the axes' products (xx, yy, zz, xy, xz, yz). */
typedef struct chi_derived_form
{
  double metric[6];
  int is_orthogonal, is_second;
  double threshold;    /* of the gradient's magnitude */
  double factor[4][2]; /* of magnitude, second derivative, Laplacian, curvature: both apply */
  double inactive[3];  /* 1 for axes of one sample, else 0 */
} chi_derived_form;

typedef struct chi_derived_rows
{
  size_t count;
  void* first[4][3];     /* derivatives of the field, and of the coordinates of curvilinear grids */
  void* second[4][6];    /* xx, yy, zz, xy, xz, yz */
  void* metric[6];       /* of curvilinear grids */
  void* out[4];          /* only the first without is_second */
  size_t flat, nan, bad; /* counted up */
} chi_derived_rows;

typedef struct chi_derived_kernels
{
  size_t size; /* of a number */
  /* Scalars of consecutive tuples times the factor; NaN for what is not finite. */
  void (*load)(const chi_derived_source* source, size_t first, size_t count, void* row);
  /* Widen a range by what is finite in a row. */
  void (*range)(const void* row, size_t count, double range[2]);
  /* Sum of weights times differences to the middle row. */
  void (*across)(size_t count, size_t taps, const double* weights, const void* const* rows,
    const void* middle, void* out);
  void (*along)(const chi_derived_along* along, const void* row, void* out);
  /* Metric and covariant second derivatives of curvilinear grids; counts `bad`. */
  void (*curve)(chi_derived_rows* rows, const chi_derived_form* form);
  void (*finish)(chi_derived_rows* rows, const chi_derived_form* form);
} chi_derived_kernels;

/* [0] float, [1] double */
extern const chi_derived_kernels chi_derived_kernels_generic[2];
#if defined(__x86_64__)
extern const chi_derived_kernels chi_derived_kernels_avx2[2];
extern const chi_derived_kernels chi_derived_kernels_avx512[2];
#endif

/* Those of this machine. */
const chi_derived_kernels* chi_derived_get_kernels(int is_double);

#endif
