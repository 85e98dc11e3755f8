/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_VEC_H
#define CHI_VEC_H

/*
 * Vectors of floats for the kernels, as wide as the instruction set that this translation unit is
 * compiled for. Arithmetic is the compiler's own (GCC and Clang vector extensions); only what these
 * cannot say - gathers, and "is any lane set" - is an intrinsic, with a scalar form beside it.
 */

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#  include <immintrin.h>
#  define CHI_LANES 16
#  define CHI_VEC_AVX512 1
#elif defined(__AVX2__) && defined(__FMA__)
#  include <immintrin.h>
#  define CHI_LANES 8
#  define CHI_VEC_AVX2 1
#else
#  define CHI_LANES 4
#endif

typedef float vf __attribute__((vector_size(4 * CHI_LANES)));
typedef int32_t vi __attribute__((vector_size(4 * CHI_LANES)));
typedef uint32_t vu __attribute__((vector_size(4 * CHI_LANES)));

#define CHI_INLINE static inline __attribute__((always_inline, unused))

CHI_INLINE vf vf_load(const float* p)
{
  vf v;
  memcpy(&v, p, sizeof v);
  return v;
}

CHI_INLINE void vf_store(float* p, vf v)
{
  memcpy(p, &v, sizeof v);
}

CHI_INLINE vi vi_load(const int32_t* p)
{
  vi v;
  memcpy(&v, p, sizeof v);
  return v;
}

CHI_INLINE void vi_store(int32_t* p, vi v)
{
  memcpy(p, &v, sizeof v);
}

CHI_INLINE vf vf_set(float x)
{
  return (vf){ 0 } + x;
}

CHI_INLINE vi vi_set(int32_t x)
{
  return (vi){ 0 } + x;
}

/* 0, 1, 2, ... */
CHI_INLINE vf vf_iota(void)
{
  static const float steps[16] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };
  return vf_load(steps);
}

CHI_INLINE vi vf_bits(vf v)
{
  return (vi)v;
}

CHI_INLINE vf vi_float(vi v)
{
  return __builtin_convertvector(v, vf);
}

/* Towards zero; undefined for NaN and beyond 2^31, so clamp first. */
CHI_INLINE vi vf_int(vf v)
{
  return __builtin_convertvector(v, vi);
}

/* Lanes of a where the mask (all bits set, or none) is set, of b elsewhere. */
CHI_INLINE vf vf_select(vi mask, vf a, vf b)
{
  return (vf)((mask & (vi)a) | (~mask & (vi)b));
}

/* NaN in a gives b. */
CHI_INLINE vf vf_max(vf a, vf b)
{
#ifdef CHI_VEC_AVX512
  return (vf)_mm512_max_ps((__m512)a, (__m512)b);
#elif defined(CHI_VEC_AVX2)
  return (vf)_mm256_max_ps((__m256)a, (__m256)b);
#else
  return vf_select(a > b, a, b);
#endif
}

CHI_INLINE vf vf_min(vf a, vf b)
{
#ifdef CHI_VEC_AVX512
  return (vf)_mm512_min_ps((__m512)a, (__m512)b);
#elif defined(CHI_VEC_AVX2)
  return (vf)_mm256_min_ps((__m256)a, (__m256)b);
#else
  return vf_select(a < b, a, b);
#endif
}

CHI_INLINE vi vi_min(vi a, vi b)
{
#ifdef CHI_VEC_AVX512
  return (vi)_mm512_min_epi32((__m512i)a, (__m512i)b);
#elif defined(CHI_VEC_AVX2)
  return (vi)_mm256_min_epi32((__m256i)a, (__m256i)b);
#else
  const vi less = a < b;
  return (less & a) | (~less & b);
#endif
}

CHI_INLINE int vi_any(vi mask)
{
#ifdef CHI_VEC_AVX512
  return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(CHI_VEC_AVX2)
  return _mm256_movemask_ps((__m256)mask) != 0;
#else
  int32_t any = 0;
  for (int i = 0; i < CHI_LANES; ++i)
  {
    any |= mask[i];
  }
  return any != 0;
#endif
}

CHI_INLINE int vi_count(vi mask)
{
#ifdef CHI_VEC_AVX512
  return __builtin_popcount(_mm512_test_epi32_mask((__m512i)mask, (__m512i)mask));
#elif defined(CHI_VEC_AVX2)
  return __builtin_popcount((unsigned)_mm256_movemask_ps((__m256)mask));
#else
  int count = 0;
  for (int i = 0; i < CHI_LANES; ++i)
  {
    count -= mask[i];
  }
  return count;
#endif
}

/* base[index * scale bytes], four bytes each; lanes outside the mask are zero and not read. */
#ifdef CHI_VEC_AVX512
#  define vi_gather(base, index, scale, mask)                                                      \
    (vi) _mm512_mask_i32gather_epi32(_mm512_setzero_si512(),                                       \
      _mm512_test_epi32_mask((__m512i)(mask), (__m512i)(mask)), (__m512i)(index), (base), (scale))
#elif defined(CHI_VEC_AVX2)
#  define vi_gather(base, index, scale, mask)                                                      \
    (vi) _mm256_mask_i32gather_epi32(                                                              \
      _mm256_setzero_si256(), (const int*)(base), (__m256i)(index), (__m256i)(mask), (scale))
#else
CHI_INLINE vi vi_gather(const void* base, vi index, int scale, vi mask)
{
  vi v = { 0 };
  for (int i = 0; i < CHI_LANES; ++i)
  {
    if (mask[i])
    {
      int32_t x;
      memcpy(&x, (const char*)base + (ptrdiff_t)index[i] * scale, sizeof x);
      v[i] = x;
    }
  }
  return v;
}
#endif
#define vf_gather(base, index, scale, mask) ((vf)vi_gather(base, index, scale, mask))

/* sqrt of a non-negative number. */
CHI_INLINE vf vf_sqrt(vf v)
{
#ifdef CHI_VEC_AVX512
  return (vf)_mm512_sqrt_ps((__m512)v);
#elif defined(CHI_VEC_AVX2)
  return (vf)_mm256_sqrt_ps((__m256)v);
#else
  for (int i = 0; i < CHI_LANES; ++i)
  {
    v[i] = __builtin_sqrtf(v[i]);
  }
  return v;
#endif
}

/*
 * e^x for x <= 0, flushed to zero below -87. 2^f on [-1/2, 1/2] by the Taylor polynomial of degree
 * 6, whose remainder is (ln 2 / 2)^7 / 7! = 1.2e-7: as good as float rounding.
 */
CHI_INLINE vf vf_exp_neg(vf x)
{
  const vf magic = vf_set(12582912.0f); /* 1.5 * 2^23: adding it rounds to an integer */
  x = vf_max(x, vf_set(-87.0f));
  const vf t = x * 1.44269504f;
  const vf shifted = t + magic;
  const vf f = t - (shifted - magic);
  vf p = f * 1.5403530e-4f + 1.3333558e-3f;
  p = p * f + 9.6181291e-3f;
  p = p * f + 5.5504109e-2f;
  p = p * f + 2.4022651e-1f;
  p = p * f + 6.9314718e-1f;
  p = p * f + 1.0f;
  return (vf)((vi)p + ((vi)shifted << 23)); /* which shifts all bits of magic out */
}

/*
 * Natural logarithm of a positive normal number: x = 2^e m, m in [sqrt(1/2), sqrt(2)), and the
 * series of the area hyperbolic tangent in s = (m - 1) / (m + 1), |s| < 0.172: its remainder 2 s^9
 * / 9 is 3e-8.
 */
CHI_INLINE vf vf_log(vf x)
{
  const vi bits = (vi)x - 0x3f3504f3; /* sqrt(1/2) */
  const vi exponent = bits >> 23;
  const vf m = (vf)((vi)x - (exponent << 23));
  const vf s = (m - 1.0f) / (m + 1.0f);
  const vf s2 = s * s;
  const vf series = s * (2.0f + s2 * (0.66666667f + s2 * (0.4f + s2 * 0.28571429f)));
  return vi_float(exponent) * 0.69314718f + series;
}

/* Sums of neighbours: (a0 + a1, a2 + a3, ..., b0 + b1, ...). */
CHI_INLINE vf vf_add_pairs(vf a, vf b)
{
#ifdef CHI_VEC_AVX512
  const __m512i even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
  const __m512i odd = _mm512_or_si512(even, _mm512_set1_epi32(1));
  return (vf)_mm512_permutex2var_ps((__m512)a, even, (__m512)b) +
    (vf)_mm512_permutex2var_ps((__m512)a, odd, (__m512)b);
#else
  vf sum;
  for (int i = 0; i < CHI_LANES / 2; ++i)
  {
    sum[i] = a[2 * i] + a[2 * i + 1];
    sum[i + CHI_LANES / 2] = b[2 * i] + b[2 * i + 1];
  }
  return sum;
#endif
}

/* The four floats of table entries at[i], transposed: out[k][i] = table[at[i]][k]. One 16-byte load
 * a lane and shuffles cost half of the gathers that fetch the same; indices come from memory,
 * because taking them out of a vector costs more than the rest. */
CHI_INLINE void vf_load_entries(const float (*table)[4], const int32_t* at, vf out[4])
{
#ifdef CHI_VEC_AVX512
  __m512 row[4];
  for (int k = 0; k < 4; ++k)
  {
    __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(table[at[k]]));
    r = _mm512_insertf32x4(r, _mm_loadu_ps(table[at[k + 4]]), 1);
    r = _mm512_insertf32x4(r, _mm_loadu_ps(table[at[k + 8]]), 2);
    row[k] = _mm512_insertf32x4(r, _mm_loadu_ps(table[at[k + 12]]), 3);
  }
  const __m512d a = (__m512d)_mm512_unpacklo_ps(row[0], row[1]);
  const __m512d b = (__m512d)_mm512_unpackhi_ps(row[0], row[1]);
  const __m512d c = (__m512d)_mm512_unpacklo_ps(row[2], row[3]);
  const __m512d d = (__m512d)_mm512_unpackhi_ps(row[2], row[3]);
  out[0] = (vf)_mm512_unpacklo_pd(a, c);
  out[1] = (vf)_mm512_unpackhi_pd(a, c);
  out[2] = (vf)_mm512_unpacklo_pd(b, d);
  out[3] = (vf)_mm512_unpackhi_pd(b, d);
#elif defined(CHI_VEC_AVX2)
  __m256 row[4];
  for (int k = 0; k < 4; ++k)
  {
    row[k] = _mm256_insertf128_ps(
      _mm256_castps128_ps256(_mm_loadu_ps(table[at[k]])), _mm_loadu_ps(table[at[k + 4]]), 1);
  }
  const __m256d a = (__m256d)_mm256_unpacklo_ps(row[0], row[1]);
  const __m256d b = (__m256d)_mm256_unpackhi_ps(row[0], row[1]);
  const __m256d c = (__m256d)_mm256_unpacklo_ps(row[2], row[3]);
  const __m256d d = (__m256d)_mm256_unpackhi_ps(row[2], row[3]);
  out[0] = (vf)_mm256_unpacklo_pd(a, c);
  out[1] = (vf)_mm256_unpackhi_pd(a, c);
  out[2] = (vf)_mm256_unpacklo_pd(b, d);
  out[3] = (vf)_mm256_unpackhi_pd(b, d);
#else
  for (int k = 0; k < 4; ++k)
  {
    float column[CHI_LANES];
    for (int i = 0; i < CHI_LANES; ++i)
    {
      column[i] = table[at[i]][k];
    }
    out[k] = vf_load(column);
  }
#endif
}

/* Two entries that lie one after the other, from one 32-byte load a lane: first[k][i] =
 * table[at[i]][k], second[k][i] = table[at[i] + 1][k]. */
CHI_INLINE void vf_load_pairs(const float (*table)[4], const int32_t* at, vf first[4], vf second[4])
{
#if defined(CHI_VEC_AVX512)
  /* Entries of two lanes a row, so that after the transposition of 4 x 4 blocks the quarters of t
   * are lanes 0 - 3 of first and second, then lanes 4 - 7; those of u 8 - 11 and 12 - 15. */
  __m512 t[4], u[4];
  for (int k = 0; k < 4; ++k)
  {
    t[k] = _mm512_insertf32x8(
      _mm512_castps256_ps512(_mm256_loadu_ps(table[at[k]])), _mm256_loadu_ps(table[at[k + 4]]), 1);
    u[k] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(table[at[k + 8]])),
      _mm256_loadu_ps(table[at[k + 12]]), 1);
  }
  for (int h = 0; h < 2; ++h)
  {
    const __m512d ta =
      (__m512d)(h ? _mm512_unpackhi_ps(t[0], t[1]) : _mm512_unpacklo_ps(t[0], t[1]));
    const __m512d tb =
      (__m512d)(h ? _mm512_unpackhi_ps(t[2], t[3]) : _mm512_unpacklo_ps(t[2], t[3]));
    const __m512d ua =
      (__m512d)(h ? _mm512_unpackhi_ps(u[0], u[1]) : _mm512_unpacklo_ps(u[0], u[1]));
    const __m512d ub =
      (__m512d)(h ? _mm512_unpackhi_ps(u[2], u[3]) : _mm512_unpacklo_ps(u[2], u[3]));
    const __m512 tl = (__m512)_mm512_unpacklo_pd(ta, tb), th = (__m512)_mm512_unpackhi_pd(ta, tb);
    const __m512 ul = (__m512)_mm512_unpacklo_pd(ua, ub), uh = (__m512)_mm512_unpackhi_pd(ua, ub);
    first[2 * h] = (vf)_mm512_shuffle_f32x4(tl, ul, 0x88);
    second[2 * h] = (vf)_mm512_shuffle_f32x4(tl, ul, 0xdd);
    first[2 * h + 1] = (vf)_mm512_shuffle_f32x4(th, uh, 0x88);
    second[2 * h + 1] = (vf)_mm512_shuffle_f32x4(th, uh, 0xdd);
  }
#elif defined(CHI_VEC_AVX2)
  __m256 r[8];
  for (int k = 0; k < 8; ++k)
  {
    r[k] = _mm256_loadu_ps(table[at[k]]);
  }
  for (int h = 0; h < 2; ++h)
  {
    const __m256d ta =
      (__m256d)(h ? _mm256_unpackhi_ps(r[0], r[1]) : _mm256_unpacklo_ps(r[0], r[1]));
    const __m256d tb =
      (__m256d)(h ? _mm256_unpackhi_ps(r[2], r[3]) : _mm256_unpacklo_ps(r[2], r[3]));
    const __m256d ua =
      (__m256d)(h ? _mm256_unpackhi_ps(r[4], r[5]) : _mm256_unpacklo_ps(r[4], r[5]));
    const __m256d ub =
      (__m256d)(h ? _mm256_unpackhi_ps(r[6], r[7]) : _mm256_unpacklo_ps(r[6], r[7]));
    const __m256 tl = (__m256)_mm256_unpacklo_pd(ta, tb), th = (__m256)_mm256_unpackhi_pd(ta, tb);
    const __m256 ul = (__m256)_mm256_unpacklo_pd(ua, ub), uh = (__m256)_mm256_unpackhi_pd(ua, ub);
    first[2 * h] = (vf)_mm256_permute2f128_ps(tl, ul, 0x20);
    second[2 * h] = (vf)_mm256_permute2f128_ps(tl, ul, 0x31);
    first[2 * h + 1] = (vf)_mm256_permute2f128_ps(th, uh, 0x20);
    second[2 * h + 1] = (vf)_mm256_permute2f128_ps(th, uh, 0x31);
  }
#else
  for (int k = 0; k < 4; ++k)
  {
    float a[CHI_LANES], b[CHI_LANES];
    for (int i = 0; i < CHI_LANES; ++i)
    {
      a[i] = table[at[i]][k];
      b[i] = table[at[i] + 1][k];
    }
    first[k] = vf_load(a);
    second[k] = vf_load(b);
  }
#endif
}

/* The inverse of vf_load_entries, one after the other: table[i][k] = in[k][i]. */
CHI_INLINE void vf_store_entries(float (*table)[4], const vf in[4])
{
#if defined(CHI_VEC_AVX512)
  const __m512d a = (__m512d)_mm512_unpacklo_ps((__m512)in[0], (__m512)in[1]);
  const __m512d b = (__m512d)_mm512_unpackhi_ps((__m512)in[0], (__m512)in[1]);
  const __m512d c = (__m512d)_mm512_unpacklo_ps((__m512)in[2], (__m512)in[3]);
  const __m512d d = (__m512d)_mm512_unpackhi_ps((__m512)in[2], (__m512)in[3]);
  const __m512 row[4] = { (__m512)_mm512_unpacklo_pd(a, c), (__m512)_mm512_unpackhi_pd(a, c),
    (__m512)_mm512_unpacklo_pd(b, d), (__m512)_mm512_unpackhi_pd(b, d) };
  for (int k = 0; k < 4; ++k)
  {
    _mm_storeu_ps(table[k], _mm512_castps512_ps128(row[k]));
    _mm_storeu_ps(table[k + 4], _mm512_extractf32x4_ps(row[k], 1));
    _mm_storeu_ps(table[k + 8], _mm512_extractf32x4_ps(row[k], 2));
    _mm_storeu_ps(table[k + 12], _mm512_extractf32x4_ps(row[k], 3));
  }
#elif defined(CHI_VEC_AVX2)
  const __m256d a = (__m256d)_mm256_unpacklo_ps((__m256)in[0], (__m256)in[1]);
  const __m256d b = (__m256d)_mm256_unpackhi_ps((__m256)in[0], (__m256)in[1]);
  const __m256d c = (__m256d)_mm256_unpacklo_ps((__m256)in[2], (__m256)in[3]);
  const __m256d d = (__m256d)_mm256_unpackhi_ps((__m256)in[2], (__m256)in[3]);
  const __m256 row[4] = { (__m256)_mm256_unpacklo_pd(a, c), (__m256)_mm256_unpackhi_pd(a, c),
    (__m256)_mm256_unpacklo_pd(b, d), (__m256)_mm256_unpackhi_pd(b, d) };
  for (int k = 0; k < 4; ++k)
  {
    _mm_storeu_ps(table[k], _mm256_castps256_ps128(row[k]));
    _mm_storeu_ps(table[k + 4], _mm256_extractf128_ps(row[k], 1));
  }
#else
  for (int i = 0; i < CHI_LANES; ++i)
  {
    for (int k = 0; k < 4; ++k)
    {
      table[i][k] = in[k][i];
    }
  }
#endif
}

#endif
