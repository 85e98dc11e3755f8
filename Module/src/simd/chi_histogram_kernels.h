/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_HISTOGRAM_KERNELS_H
#define CHI_HISTOGRAM_KERNELS_H

/* Simplices into bins, once per instruction set; chosen at load. Sums of a bin are taken in another
 * order where vectors have eight lanes. */

#include <stddef.h>
#include <stdint.h>

enum
{
  CHI_HISTOGRAM_PADDING = 8 /* slots behind the last that vectors touch, and leave 0 */
};

/* Bins over a range of values. Slot 0 is below, slot j + 1 bin j, slot bins + 1 above. */
typedef struct chi_histogram_window
{
  double low, high, scale;
  double snap;    /* adding and taking it away rounds to multiples of `quantum` */
  double quantum; /* in units of bins */
  size_t bins;
} chi_histogram_window;

/* Sums by slot, of volume and of the integral of |grad f|. */
typedef struct chi_histogram_tile
{
  double *mass, *area; /* [bins + 2 + CHI_HISTOGRAM_PADDING] */
} chi_histogram_tile;

/* A value in units of bins: up to `bins` within the range, beyond outside, whatever is rounded. */
static inline double chi_histogram_map(const chi_histogram_window* w, double value)
{
  const double end = (double)w->bins, far = 0x1p200;
  double x = (value - w->low) * w->scale;
  x = x < far ? x : far;
  x = x > -far ? x : -far;
  x = (x + w->snap) - w->snap; /* so that differences are not tiny, and exact */
  const double below = x < -w->quantum ? x : -w->quantum;
  const double above = x > end + w->quantum ? x : end + w->quantum;
  const double within = x < end ? x : end;
  return value < w->low ? below : value > w->high ? above : within;
}

static inline size_t chi_histogram_slot(const chi_histogram_window* w, double x)
{
  return x < 0 ? 0 : x < (double)w->bins ? 1 + (size_t)(int64_t)x : w->bins + 1;
}

/* The slot of a constant: the range's upper end belongs to the last bin. */
static inline size_t chi_histogram_constant_slot(const chi_histogram_window* w, double x)
{
  return x == (double)w->bins ? w->bins : chi_histogram_slot(w, x);
}

typedef struct chi_histogram_kernels
{
  /* `count` simplices of `corners` values each (1: constants), which are overwritten. */
  void (*put)(const chi_histogram_window* window, double* const value[4], int corners,
    const double* mass, const double* area, size_t count, const chi_histogram_tile* tile);
} chi_histogram_kernels;

extern const chi_histogram_kernels chi_histogram_kernels_generic, chi_histogram_kernels_avx2,
  chi_histogram_kernels_avx512;
const chi_histogram_kernels* chi_histogram_get_kernels(void);

#endif
