/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Light of a segment: shift, attenuate, halve, enlarge. Included by chi_occlusion_kernels.inl. */

enum
{
  PARTS = CHI_SEGMENT / CHI_LANES,
  LINE = CHI_LINE / sizeof(float)
};

CHI_INLINE void shifted(const float* q, size_t stride, const float w[4], vf out[PARTS])
{
  for (int k = 0; k < PARTS; ++k)
  {
    const float* const a = q + k * CHI_LANES;
    const float* const b = a + stride;
    out[k] = vf_load(a) * w[0] + vf_load(a + 1) * w[1] + vf_load(b) * w[2] + vf_load(b + 1) * w[3];
  }
}

/*
 * One slab for all directions: shift the light, attenuate it by half the slab (what the middle of
 * the slab sees), and by the other half. Doc: theory/occlusion.md, Eq. 3.
 */
CHI_INLINE int light_run(
  const chi_light_segment* segment, const int has_tau, const int has_geometry, const int weighted)
{
  /* A copy, which the stores cannot change. */
  const chi_light_segment copy = *segment, *const s = &copy;
  vf sum[PARTS], half_tau[PARTS], geometry[PARTS];
  for (int k = 0; k < PARTS; ++k)
  {
    sum[k] = vf_set(0.0f);
    half_tau[k] = has_tau ? vf_load(s->tau + k * CHI_LANES) * (-0.5f * s->factor) : vf_set(0.0f);
    geometry[k] = has_geometry ? vf_load(s->geometry + k * CHI_LANES) : vf_set(1.0f);
  }
  const float* source = s->source;
  float* target = s->target;
  for (int m = 0; m < s->directions; ++m, source += s->plane, target += s->plane)
  {
    const float* const taps = source + s->offset[m];
    vf light[PARTS];
    shifted(taps, s->stride, s->weight[m], light);
    /* The row that the next one reads besides: it lies too far away for the processor to guess. */
    for (int x = 0; x <= CHI_SEGMENT; x += LINE)
    {
      __builtin_prefetch(taps + 2 * s->stride + x);
    }
    for (int k = 0; k < PARTS; ++k)
    {
      vf through = vf_set(1.0f);
      if (has_tau)
      {
        const vf length = s->length[m] + (vf_iota() + (float)(k * CHI_LANES)) * s->length_x[m];
        through = vf_exp_neg(half_tau[k] * length);
        light[k] *= through;
      }
      sum[k] += weighted ? light[k] * s->share[m] : light[k];
      if (has_tau)
      {
        light[k] *= through;
      }
      if (has_geometry)
      {
        light[k] *= geometry[k];
      }
      vf_store(target + k * CHI_LANES, light[k]);
    }
  }
  const float mean = weighted ? 1.0f : 1.0f / (float)s->directions;
  vi lit = vi_set(0), dimmed = vi_set(0);
  for (int k = 0; k < PARTS; ++k)
  {
    const vf visibility = sum[k] * mean;
    vf_store(s->visibility + k * CHI_LANES, visibility);
    lit |= visibility >= s->dark_below;
    dimmed |= visibility <= s->bright_above;
  }
  return (vi_any(lit) ? 0 : CHI_LIGHT_DARK) | (vi_any(dimmed) ? 0 : CHI_LIGHT_BRIGHT);
}

static int light(const chi_light_segment* s)
{
  switch ((s->share ? 4 : 0) + (s->tau ? 2 : 0) + (s->geometry ? 1 : 0))
  {
    case 0:
      return light_run(s, 0, 0, 0);
    case 1:
      return light_run(s, 0, 1, 0);
    case 2:
      return light_run(s, 1, 0, 0);
    case 3:
      return light_run(s, 1, 1, 0);
    case 4:
      return light_run(s, 0, 0, 1);
    case 5:
      return light_run(s, 0, 1, 1);
    case 6:
      return light_run(s, 1, 0, 1);
    default:
      return light_run(s, 1, 1, 1);
  }
}

/* The published rule: one buffer, the mean of its taps. Schott et al. 2013, Algorithm 3. */
static int blur(const chi_light_segment* s)
{
  vf sum[PARTS];
  for (int k = 0; k < PARTS; ++k)
  {
    sum[k] = vf_set(0.0f);
  }
  for (int m = 0; m < s->directions; ++m)
  {
    vf tap[PARTS];
    shifted(s->source + s->offset[m], s->stride, s->weight[m], tap);
    for (int k = 0; k < PARTS; ++k)
    {
      sum[k] += tap[k];
    }
  }
  const float mean = 1.0f / (float)s->directions;
  vi lit = vi_set(0), dimmed = vi_set(0);
  for (int k = 0; k < PARTS; ++k)
  {
    const int x = k * CHI_LANES;
    const vf length = s->length[0] + (vf_iota() + (float)x) * s->length_x[0];
    const vf through =
      s->tau ? vf_exp_neg(vf_load(s->tau + x) * length * (-0.5f * s->factor)) : vf_set(1.0f);
    const vf seen = sum[k] * mean * through;
    vf_store(s->visibility + x, seen);
    vf_store(
      s->target + x, seen * through * (s->geometry ? vf_load(s->geometry + x) : vf_set(1.0f)));
    lit |= seen >= s->dark_below;
    dimmed |= seen <= s->bright_above;
  }
  return (vi_any(lit) ? 0 : CHI_LIGHT_DARK) | (vi_any(dimmed) ? 0 : CHI_LIGHT_BRIGHT);
}

/* 1 where a surface's interval meets the slab. */
CHI_INLINE vf blocks(const float* begin, const float* end, float slab)
{
  const vi meets = (vf_load(begin) < slab + 1.0f) & (vf_load(end) >= slab);
  return vf_select(meets, vf_set(1.0f), vf_set(0.0f));
}

static int block(
  const float* const begin[2], const float* const end[2], int scale, float slab, float* out)
{
  vf most = vf_set(0.0f);
  for (int x = 0; x < CHI_SEGMENT; x += CHI_LANES)
  {
    vf closed;
    if (scale == 1)
    {
      closed = blocks(begin[0] + x, end[0] + x, slab);
    }
    else
    {
      const int a = 2 * x, b = a + CHI_LANES;
      closed = 0.25f *
        vf_add_pairs(
          blocks(begin[0] + a, end[0] + a, slab) + blocks(begin[1] + a, end[1] + a, slab),
          blocks(begin[0] + b, end[0] + b, slab) + blocks(begin[1] + b, end[1] + b, slab));
    }
    most = vf_max(most, closed);
    vf_store(out + x, 1.0f - closed);
  }
  return vi_any(most > 0.0f);
}

/* Mean transmittance of four pixels a light pixel. */
CHI_INLINE vf mean_of_four(vf a0, vf a1, vf b0, vf b1)
{
  return vf_add_pairs(a0 + b0, a1 + b1) * 0.25f;
}

/*
 * Two rows of pixels to one of light pixels: the optical thickness whose transmittance along a path
 * of the cone's mean length is that of the four pixels.
 *
 * Averaging thickness would let thin opaque things darken twice their area; averaging transmittance
 * slab by slab lets the edge of a deep opaque thing darken the light pixel that it half covers
 * again in every slab. Light that goes straight on meets in a slab the same pixels as in the one
 * before, so that what counts is the mean of the product with the slab before over the mean of that
 * slab alone (theory/occlusion.md, Eq. 4).
 */
static void halve(
  const float* const tau[2], const float* const before[2], float length, float* out, int count)
{
  const vf thin = vf_set(CHI_THIN / length);
  for (int x = 0; x < count; x += CHI_LANES)
  {
    const vf a0 = vf_load(tau[0] + 2 * x), a1 = vf_load(tau[0] + 2 * x + CHI_LANES);
    const vf b0 = vf_load(tau[1] + 2 * x), b1 = vf_load(tau[1] + 2 * x + CHI_LANES);
    const vi thick = (vf_max(a0, b0) > thin) | (vf_max(a1, b1) > thin);
    if (!vi_any(thick))
    {
      vf_store(out + x, mean_of_four(a0, a1, b0, b1));
      continue;
    }
    const vf ea0 = vf_exp_neg(a0 * -length), ea1 = vf_exp_neg(a1 * -length);
    const vf eb0 = vf_exp_neg(b0 * -length), eb1 = vf_exp_neg(b1 * -length);
    const vf pa0 = vf_exp_neg(vf_load(before[0] + 2 * x) * -length);
    const vf pa1 = vf_exp_neg(vf_load(before[0] + 2 * x + CHI_LANES) * -length);
    const vf pb0 = vf_exp_neg(vf_load(before[1] + 2 * x) * -length);
    const vf pb1 = vf_exp_neg(vf_load(before[1] + 2 * x + CHI_LANES) * -length);
    const vf floor = vf_set(1e-30f);
    const vf joint = vf_max(mean_of_four(ea0 * pa0, ea1 * pa1, eb0 * pb0, eb1 * pb1), floor);
    const vf first = vf_max(mean_of_four(pa0, pa1, pb0, pb1), floor);
    const vf tau_mean = (vf_log(first) - vf_log(joint)) * (1.0f / length);
    vf_store(out + x, vf_max(tau_mean, vf_set(0.0f)));
  }
}

/* Path length a unit depth of every direction at the first of `count` pixels, and its mean change a
 * pixel: a light ray through a pixel of slope p has the slope p - s. The line goes through the
 * length at Gauss's two points, so that its mean error over the pixels vanishes; through the ends
 * it would lie above the convex length everywhere, and darken. */
static void path_lengths(const float* slope_x, const float* slope_y, int directions, float px,
  float py, float px_step, int count, float* length, float* length_x)
{
  const float end = (float)(count > 1 ? count - 1 : 1);
  const float low = 0.21132487f * end, high = 0.78867513f * end;
  const float share = 1.0f / (high - low);
  for (int m = 0; m < directions; ++m)
  {
    const float y = py - slope_y[m];
    const float a = px + px_step * low - slope_x[m], b = px + px_step * high - slope_x[m];
    const float first = sqrtf(1.0f + y * y + a * a);
    length_x[m] = (sqrtf(1.0f + y * y + b * b) - first) * share;
    length[m] = first - low * length_x[m];
  }
}

/* Interleave: (a0, b0, a1, b1, ...) in two vectors. */
CHI_INLINE void store_interleaved(float* out, vf a, vf b)
{
#ifdef CHI_VEC_AVX512
  const __m512i low = _mm512_set_epi32(23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
  const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
  vf_store(out, (vf)_mm512_permutex2var_ps((__m512)a, low, (__m512)b));
  vf_store(out + CHI_LANES, (vf)_mm512_permutex2var_ps((__m512)a, high, (__m512)b));
#else
  for (int i = 0; i < CHI_LANES; ++i)
  {
    out[2 * i] = a[i];
    out[2 * i + 1] = b[i];
  }
#endif
}

/* Weighted sum of rows of light pixels, enlarged to the picture's pixels: a light pixel's two
 * columns lie a quarter of it off its centre, with the weights of chi_light_weights(2, -1/4) and
 * their mirror. */
static void enlarge(const float* const* rows, const float* weight, int row_count, float base,
  int scale, int begin, int end, float* out)
{
  const float near = 0.11458333f, middle = 1.0208333f, far = -0.13541667f;
  const vf zero = vf_set(0.0f), one = vf_set(1.0f);
  if (scale == 1)
  {
    for (int x = begin; x < end; x += CHI_LANES)
    {
      vf v = vf_set(base);
      for (int r = 0; r < row_count; ++r)
      {
        v += vf_load(rows[r] + x) * weight[r];
      }
      vf_store(out + x, v);
    }
    return;
  }
  for (int x = begin / 2; x < (end + 1) / 2; x += CHI_LANES)
  {
    vf left = vf_set(base), here = vf_set(base), right = vf_set(base);
    for (int r = 0; r < row_count; ++r)
    {
      left += vf_load(rows[r] + x - 1) * weight[r];
      here += vf_load(rows[r] + x) * weight[r];
      right += vf_load(rows[r] + x + 1) * weight[r];
    }
    const vf even = left * near + here * middle + right * far;
    const vf odd = left * far + here * middle + right * near;
    store_interleaved(out + 2 * x, vf_min(vf_max(even, zero), one), vf_min(vf_max(odd, zero), one));
  }
}
