/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SEGMENT_KERNELS_H
#define CHI_SEGMENT_KERNELS_H

/* Segments of rays by themselves, once per instruction set: chi_segment_evaluate. A renderer
 * includes chi_segment.inl in its own kernel instead. */

#include <chiaroscuro/chi_preintegration.h>

typedef struct chi_segment_kernels
{
  void (*evaluate)(const chi_segment_tables* tables, size_t count, const float* x0, const float* x1,
    const float* length, float* rgba);
} chi_segment_kernels;

extern const chi_segment_kernels chi_segment_kernels_generic;
#if defined(__x86_64__)
extern const chi_segment_kernels chi_segment_kernels_avx2;
extern const chi_segment_kernels chi_segment_kernels_avx512;
#endif

/* Those of this machine. */
const chi_segment_kernels* chi_segment_get_kernels(void);

#endif
