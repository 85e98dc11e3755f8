/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FIBER_KERNELS_H
#define CHI_FIBER_KERNELS_H

/* How values lie to a segment, once per instruction set; chosen at load. Nothing here fuses
 * multiplications with additions, so that all of them give the same bits. */

#include <stddef.h>
#include <stdint.h>

/* A point's word: a bit a segment in each field. */
enum
{
  CHI_FIBER_BATCH = 12, /* segments */
  CHI_FIBER_LEFT = 0,   /* of the segment's line */
  CHI_FIBER_BEFORE = CHI_FIBER_BATCH,
  CHI_FIBER_BEYOND = 2 * CHI_FIBER_BATCH,
  CHI_FIBER_MAYBE_BEFORE = 3 * CHI_FIBER_BATCH,
  CHI_FIBER_MAYBE_BEYOND = 4 * CHI_FIBER_BATCH,
  CHI_FIBER_FLAGS = 5 * CHI_FIBER_BATCH
};

typedef struct chi_fiber_kernels
{
  /* Add the bits of a segment from p along d, `square` long squared, to the words of `count`
   * values, as segment `number` of the batch. Whether some value is so near to its line that
   * rounding hides on which side it lies. */
  int (*classify)(const double p[2], const double d[2], double square, const double* values,
    size_t count, unsigned number, uint64_t* words);
} chi_fiber_kernels;

extern const chi_fiber_kernels chi_fiber_kernels_generic;
#if defined(__x86_64__)
extern const chi_fiber_kernels chi_fiber_kernels_avx2;
extern const chi_fiber_kernels chi_fiber_kernels_avx512;
#endif

/* Those of this machine. */
const chi_fiber_kernels* chi_fiber_get_kernels(void);

#endif
