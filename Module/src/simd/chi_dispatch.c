/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_derived_kernels.h"
#include "chi_fiber_kernels.h"
#include "chi_histogram_kernels.h"
#include "chi_occlusion_kernels.h"
#include "chi_scatterplot_kernels.h"
#include "chi_segment_kernels.h"
#include "chi_tet_kernels.h"
#include "chi_tube_kernels.h"

#include <stdlib.h>
#include <string.h>

enum
{
  GENERIC,
  AVX2,
  AVX512
};

/* The widest instruction set of this machine, or the one that CHIAROSCURO_ISA asks for. */
static int instruction_set(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const char* const wish = getenv("CHIAROSCURO_ISA");
  const int generic = wish && strcmp(wish, "generic") == 0;
  const int avx2 = wish && strcmp(wish, "avx2") == 0;
  __builtin_cpu_init();
  if (!generic && !avx2 && __builtin_cpu_supports("avx512f") &&
    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd"))
  {
    return AVX512;
  }
  if (!generic && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    return AVX2;
  }
#endif
  return GENERIC;
}

const chi_occlusion_kernels* chi_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_kernels_avx512
    : set == AVX2      ? &chi_kernels_avx2
                       : &chi_kernels_generic;
#else
  return &chi_kernels_generic;
#endif
}

const chi_fiber_kernels* chi_fiber_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_fiber_kernels_avx512
    : set == AVX2      ? &chi_fiber_kernels_avx2
                       : &chi_fiber_kernels_generic;
#else
  return &chi_fiber_kernels_generic;
#endif
}

const chi_tube_kernels* chi_tube_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_tube_kernels_avx512
    : set == AVX2      ? &chi_tube_kernels_avx2
                       : &chi_tube_kernels_generic;
#else
  return &chi_tube_kernels_generic;
#endif
}

const chi_segment_kernels* chi_segment_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_segment_kernels_avx512
    : set == AVX2      ? &chi_segment_kernels_avx2
                       : &chi_segment_kernels_generic;
#else
  return &chi_segment_kernels_generic;
#endif
}

const chi_tet_kernels* chi_tet_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_tet_kernels_avx512
    : set == AVX2      ? &chi_tet_kernels_avx2
                       : &chi_tet_kernels_generic;
#else
  return &chi_tet_kernels_generic;
#endif
}

const chi_scatter_kernels* chi_scatter_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_scatter_kernels_avx512
    : set == AVX2      ? &chi_scatter_kernels_avx2
                       : &chi_scatter_kernels_generic;
#else
  return &chi_scatter_kernels_generic;
#endif
}

const chi_derived_kernels* chi_derived_get_kernels(int is_double)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return (set == AVX512    ? chi_derived_kernels_avx512
             : set == AVX2 ? chi_derived_kernels_avx2
                           : chi_derived_kernels_generic) +
    (is_double ? 1 : 0);
#else
  return chi_derived_kernels_generic + (is_double ? 1 : 0);
#endif
}

const chi_histogram_kernels* chi_histogram_get_kernels(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const int set = instruction_set();
  return set == AVX512 ? &chi_histogram_kernels_avx512
    : set == AVX2      ? &chi_histogram_kernels_avx2
                       : &chi_histogram_kernels_generic;
#else
  return &chi_histogram_kernels_generic;
#endif
}
