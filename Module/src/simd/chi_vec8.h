/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_VEC8_H
#define CHI_VEC8_H

/*
 * Eight doubles at a time, on every instruction set: one register of AVX-512, two of AVX2, four of
 * SSE2. Translation units that include this are compiled with -ffp-contract=off; what is fused is
 * written so.
 */

#include <stdint.h>
#include <string.h>

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#  include <immintrin.h>
#  define CHI_VEC8_AVX512 1
#elif defined(__AVX2__) && defined(__FMA__)
#  include <immintrin.h>
#  define CHI_VEC8_AVX2 1
#endif

typedef double v8 __attribute__((vector_size(64)));
typedef int64_t m8 __attribute__((vector_size(64))); /* all bits of a lane set, or none */
typedef double v4 __attribute__((vector_size(32)));

#define CHI_INLINE8 static inline __attribute__((always_inline, unused))

CHI_INLINE8 v8 v8_load(const double* p)
{
  v8 v;
  memcpy(&v, p, sizeof v);
  return v;
}

CHI_INLINE8 void v8_store(double* p, v8 v)
{
  memcpy(p, &v, sizeof v);
}

CHI_INLINE8 v4 v4_load(const double* p)
{
  v4 v;
  memcpy(&v, p, sizeof v);
  return v;
}

CHI_INLINE8 void v4_store(double* p, v4 v)
{
  memcpy(p, &v, sizeof v);
}

CHI_INLINE8 v8 v8_set(double x)
{
  return (v8){ x, x, x, x, x, x, x, x };
}

CHI_INLINE8 v8 v8_iota(void)
{
  return (v8){ 0, 1, 2, 3, 4, 5, 6, 7 };
}

CHI_INLINE8 v8 v8_select(m8 mask, v8 a, v8 b)
{
  return (v8)((mask & (m8)a) | (~mask & (m8)b));
}

/* NaN in either gives b. */
CHI_INLINE8 v8 v8_min(v8 a, v8 b)
{
#ifdef CHI_VEC8_AVX512
  return (v8)_mm512_min_pd((__m512d)a, (__m512d)b);
#else
  return v8_select(a < b, a, b);
#endif
}

CHI_INLINE8 v8 v8_max(v8 a, v8 b)
{
#ifdef CHI_VEC8_AVX512
  return (v8)_mm512_max_pd((__m512d)a, (__m512d)b);
#else
  return v8_select(a > b, a, b);
#endif
}

CHI_INLINE8 v8 v8_abs(v8 a)
{
  return (v8)((m8)a & INT64_MAX);
}

/* Of 0 <= a < 2^51. */
CHI_INLINE8 v8 v8_floor(v8 a)
{
  const v8 rounded = (a + 0x1p52) - 0x1p52;
  return rounded - v8_select(rounded > a, v8_set(1), v8_set(0));
}

/* Bit i is set where lane i is. */
CHI_INLINE8 unsigned m8_bits(m8 mask)
{
#ifdef CHI_VEC8_AVX512
  return _mm512_movepi64_mask((__m512i)mask);
#elif defined(CHI_VEC8_AVX2)
  __m256d half[2];
  memcpy(half, &mask, sizeof mask);
  return (unsigned)_mm256_movemask_pd(half[0]) | (unsigned)_mm256_movemask_pd(half[1]) << 4;
#else
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i)
  {
    bits |= (unsigned)(mask[i] & 1) << i;
  }
  return bits;
#endif
}

CHI_INLINE8 m8 m8_of_bits(unsigned bits)
{
  const m8 lane = { 1, 2, 4, 8, 16, 32, 64, 128 };
  return (lane & (int64_t)bits) != 0;
}

/* Lanes below `count`. */
CHI_INLINE8 m8 m8_first(int count)
{
  return v8_iota() < v8_set(count);
}

/* a b + c, rounded once where the machine can. */
CHI_INLINE8 v8 v8_fma(v8 a, v8 b, v8 c)
{
#ifdef CHI_VEC8_AVX512
  return (v8)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
#elif defined(CHI_VEC8_AVX2)
  __m256d x[2], y[2], z[2];
  memcpy(x, &a, sizeof a);
  memcpy(y, &b, sizeof b);
  memcpy(z, &c, sizeof c);
  z[0] = _mm256_fmadd_pd(x[0], y[0], z[0]);
  z[1] = _mm256_fmadd_pd(x[1], y[1], z[1]);
  memcpy(&c, z, sizeof c);
  return c;
#else
  return a * b + c;
#endif
}

/* The rounding error of the product p = a b (Dekker 1971); |a|, |b| < 2^990. */
CHI_INLINE8 v8 v8_product_error(v8 a, v8 b, v8 p)
{
#if defined(CHI_VEC8_AVX512) || defined(CHI_VEC8_AVX2)
  return v8_fma(a, b, -p);
#else
  const v8 ta = a * 134217729.0, tb = b * 134217729.0; /* 2^27 + 1 */
  const v8 ah = ta - (ta - a), al = a - ah, bh = tb - (tb - b), bl = b - bh;
  return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
#endif
}

/* a d - b c to two units in the last place; 0 if and only if the products are equal (Kahan). */
CHI_INLINE8 v8 v8_determinant(v8 a, v8 d, v8 b, v8 c)
{
  const v8 bc = b * c, error = v8_product_error(b, c, bc);
#if defined(CHI_VEC8_AVX512) || defined(CHI_VEC8_AVX2)
  return v8_fma(a, d, -bc) - error;
#else
  const v8 ad = a * d;
  return (ad - bc) + (v8_product_error(a, d, ad) - error);
#endif
}

#endif
