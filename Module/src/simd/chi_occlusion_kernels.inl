/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Inner loops of the occlusion renderer; compiled once per instruction set (see the files that
 * include this one). Fused multiply-adds are allowed here: results differ between instruction sets
 * by rounding, and not between threads or schedules.
 */

#include "chi_occlusion_kernels.h"
#include "chi_vec.h"

#include <math.h>

/* Low and high half of the pair of samples that one four-byte load brings. */
CHI_INLINE void split_pair(vi word, int fetch, vf* a, vf* b)
{
  if (fetch == CHI_FETCH_U8)
  {
    *a = vi_float(word & 255);
    *b = vi_float((vi)((vu)word >> 8) & 255);
  }
  else if (fetch == CHI_FETCH_U16)
  {
    *a = vi_float(word & 65535);
    *b = vi_float((vi)((vu)word >> 16));
  }
  else
  {
    *a = vi_float((word << 16) >> 16);
    *b = vi_float(word >> 16);
  }
}

CHI_INLINE vi gather_samples(const chi_sample_frame* s, vi index, int fetch, vi mask)
{
  if (fetch == CHI_FETCH_F32)
  {
    return vi_gather(s->scalars, index, 4, mask);
  }
  /* A four-byte load at the last samples would leave the array: load earlier and shift. */
  const int scale = fetch == CHI_FETCH_U8 ? 1 : 2;
  const vi last = vi_set(s->last_load);
  const vi beyond = index > last;
  const vi at = (beyond & last) | (~beyond & index);
  const vi word =
    fetch == CHI_FETCH_U8 ? vi_gather(s->scalars, at, 1, mask) : vi_gather(s->scalars, at, 2, mask);
  return (vi)((vu)word >> (vu)((index - at) * (8 * scale)));
}

/* Trilinear (or nearest) scalar at an index position that lies inside the grid. */
CHI_INLINE vf fetch_scalar(
  const chi_sample_frame* s, const vf p[3], int fetch, int nearest, vi mask)
{
  if (nearest)
  {
    vi i[3];
    for (int a = 0; a < 3; ++a)
    {
      i[a] = vf_int(p[a] + 0.5f);
    }
    const vi index = i[0] * s->step_x + i[1] * s->step_y + i[2] * s->step_z;
    const vi word = gather_samples(s, index, fetch, mask);
    vf a, b;
    if (fetch == CHI_FETCH_F32)
    {
      return (vf)word;
    }
    split_pair(word, fetch, &a, &b);
    return a;
  }
  vi i[3];
  vf f[3];
  for (int a = 0; a < 3; ++a)
  {
    const vi last = vi_set(s->last_cell[a]);
    i[a] = vf_int(p[a]);
    const vi beyond = i[a] > last;
    i[a] = (beyond & last) | (~beyond & i[a]);
    f[a] = p[a] - vi_float(i[a]);
  }
  const vi index = i[0] * s->step_x + i[1] * s->step_y + i[2] * s->step_z;
  vf line[4];
  for (int c = 0; c < 4; ++c)
  {
    const vi at = index + ((c & 1 ? s->step_y : 0) + (c & 2 ? s->step_z : 0));
    vf a, b;
    if (fetch == CHI_FETCH_F32)
    {
      a = (vf)gather_samples(s, at, fetch, mask);
      b = (vf)gather_samples(s, at + s->step_x, fetch, mask);
    }
    else
    {
      split_pair(gather_samples(s, at, fetch, mask), fetch, &a, &b);
    }
    line[c] = a + f[0] * (b - a);
  }
  const vf low = line[0] + f[1] * (line[1] - line[0]);
  const vf high = line[2] + f[1] * (line[3] - line[2]);
  return low + f[2] * (high - low);
}

/* A piece of a row on its way through the stages below. Each stage is a loop of its own: one loop
 * for all would be a chain of some 300 cycles an iteration, longer than the processor looks ahead.
 */
enum
{
  PIECE = 128
};

typedef struct sample_piece
{
  float t[PIECE]; /* table position at the far slice; NaN: no sample */
  int32_t entry[PIECE];
  float fraction[PIECE]; /* of the segment that lies in the box */
  int32_t entering[PIECE];
  float depth[PIECE]; /* optical thickness along the view axis */
  int32_t color[PIECE];
} sample_piece;

/* Where the samples lie, which of them anybody needs, and their places in the tables. */
CHI_INLINE void fetch_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count,
  const int fetch, const int nearest)
{
  const chi_sample_frame* const s = row->frame;
  const vf nan = vf_set(NAN);
  const vf end = vf_set(s->table_end);
  const vi last_entry = vi_set((int32_t)s->table_end);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf xs = vf_iota() + (float)x;
    vi want = vi_set(-1);
    vf p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = row->position[a] + xs * row->position_x[a];
    }
    if (row->enter)
    {
      /* The ray meets the box inside this segment: sample where it does, and count only the part.
       */
      const vf enter = vf_load(row->enter + x), leave = vf_load(row->leave + x);
      const vf near = vf_set(row->near_slice), far = near + 1.0f;
      want = (enter < far) & (leave > near);
      const vf stop = vf_min(far, leave), start = vf_max(near, enter);
      vf_store(piece->fraction + i, vf_max(stop - start, vf_set(0.0f)));
      vi_store(piece->entering + i, (enter > near) | vi_set(row->first ? -1 : 0));
      const vf back = stop - far;
      for (int a = 0; a < 3; ++a)
      {
        p[a] += back * (row->direction[a] + xs * row->direction_x[a]);
      }
    }
    for (int a = 0; a < 3; ++a)
    {
      p[a] = vf_min(vf_max(p[a], vf_set(0.0f)), vf_set(s->last_index[a]));
    }
    const vi inside = want;
    if (row->surface && !row->saturated_too)
    {
      want &= vf_load(row->surface + x) > row->near_slice;
    }
    if (!row->saturated_too)
    {
      want &= vf_load(row->transmittance + x) > s->saturated;
    }
    if (row->bricks)
    {
      const vi brick = (vf_int(p[0]) >> 3) + (vf_int(p[1]) >> 3) * s->brick_step_y +
        (vf_int(p[2]) >> 3) * s->brick_step_z;
      want &= (vi_gather(s->occupied, brick, 1, want) & 255) != 0;
    }
    const int taken = vi_count(want);
    row->taken += taken;
    row->skipped += vi_count(inside) - taken;
    if (taken == 0)
    {
      vf_store(piece->t + i, nan);
      vi_store(piece->entry + i, vi_set(0));
      continue;
    }
    const vf scalar = fetch_scalar(s, p, fetch, nearest, want);
    /* x - x is 0 for every finite x: NaN and infinite samples are transparent. */
    const vi finite = (scalar - scalar == 0.0f) & want;
    vf t = (scalar - s->base) * s->scale + s->offset;
    t = vf_min(vf_max(t, vf_set(0.0f)), end);
    vi entry = vf_int(t);
    entry -= (entry >= last_entry) & 1; /* the last entry has no interval after it */
    vf_store(piece->t + i, vf_select(finite, t, nan));
    vi_store(piece->entry + i, entry & finite);
  }
}

/* Mean extinction of every segment, and the optical thickness that it adds. */
CHI_INLINE void classify_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count)
{
  const chi_sample_frame* const s = row->frame;
  const vf nan = vf_set(NAN);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf t = vf_load(piece->t + i);
    const vi finite = t == t;
    const vi entry = vi_load(piece->entry + i);
    vf parts[4]; /* lanes without a sample read entry 0 */
    vf_load_entries((const float(*)[4])(const void*)s->sigma, piece->entry + i, parts);
    const vf f = t - vi_float(entry);
    const vi sum = (vi)parts[0];
    const vf sigma0 = parts[1], half_slope = parts[2];
    const vf rest = f * (sigma0 + f * half_slope);

    /* Scalar linear along the segment: integral over scalar / its change. Where that hardly
     * changes, the extinction in the middle. */
    const vf t_before = row->restart ? nan : vf_load(row->table_position + x);
    const vi known = (t_before == t_before) & finite;
    const vf t0 = vf_select(known, t_before, t);
    const vf change = t - t0;
    const vi steep = ((change > 1.0f) | (change < -1.0f)) & known;
    const vf local = sigma0 + (2.0f * f - change) * half_slope;
    const vf integral = vi_float((vi)((vu)sum - (vu)vi_load(row->sum + x))) * s->quantum +
      (rest - vf_load(row->rest + x));
    vf sigma = vf_select(steep, integral / vf_select(steep, change, vf_set(1.0f)), local);
    /* A ray that begins here has no scalar before; elsewhere an unsampled neighbour was
     * transparent, and its brick's margin covers this segment. */
    const vi entering = row->enter ? vi_load(piece->entering + i) : vi_set(row->first ? -1 : 0);
    const vi valid = finite & (known | entering);
    sigma = vf_select(valid, vf_max(sigma, vf_set(0.0f)), vf_set(0.0f));
    vf_store(row->table_position + x, t);
    vi_store(row->sum + x, sum);
    vf_store(row->rest + x, rest);
    const vf fraction = row->enter ? vf_load(piece->fraction + i) : vf_set(1.0f);
    vf_store(piece->depth + i, sigma * (fraction * s->slice));
    vi_store(piece->color + i, vf_int(vf_select(valid, t - 0.5f * change + 0.5f, vf_set(0.0f))));
  }
}

/* What the eye gets of it. */
CHI_INLINE void composite_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count)
{
  const chi_sample_frame* const s = row->frame;
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    vf depth = vf_load(piece->depth + i);
    if (!vi_any(depth > 0.0f))
    {
      continue;
    }
    row->any_tau = 1;
    vf_store(row->tau + x, vf_load(row->tau + x) + depth);
    /* The eye sees the part in front of the surface, and nothing where it is dark already. */
    if (row->surface)
    {
      const vf fraction = row->enter ? vf_load(piece->fraction + i) : vf_set(1.0f);
      const vf free = vf_load(row->surface + x) - row->near_slice;
      depth *= vf_min(vf_max(free, vf_set(0.0f)), fraction) / vf_max(fraction, vf_set(1e-30f));
    }
    const vf transmittance = vf_load(row->transmittance + x);
    const vi seen = (transmittance > s->saturated) & (depth > 0.0f);
    if (!vi_any(seen))
    {
      continue;
    }
    const vf slope = row->length0 + (vf_iota() + (float)x) * row->length_x;
    const vf tau = depth * vf_sqrt(slope * slope + row->length_c);
    const vf alpha = vf_select(seen, 1.0f - vf_exp_neg(-tau), vf_set(0.0f));
    vf weight = transmittance * alpha;
    vf_store(row->transmittance + x, transmittance - weight);
    if (row->visibility)
    {
      weight *= vf_load(row->visibility + x);
    }
    vf color[4];
    vf_load_entries(s->rgba, piece->color + i, color);
    for (int c = 0; c < 3; ++c)
    {
      vf_store(row->color[c] + x, vf_load(row->color[c] + x) + weight * color[c]);
    }
  }
}

CHI_INLINE void sample_run(
  chi_sample_row* row, int x_begin, int x_end, const int fetch, const int nearest)
{
  sample_piece piece;
  for (int x = x_begin; x < x_end; x += PIECE)
  {
    const int count = x_end - x < PIECE ? x_end - x : PIECE;
    fetch_piece(row, &piece, x, count, fetch, nearest);
    classify_piece(row, &piece, x, count);
    composite_piece(row, &piece, x, count);
  }
}

static void sample(chi_sample_row* row, int x_begin, int x_end)
{
  switch (row->frame->fetch * 2 + row->frame->nearest)
  {
    case CHI_FETCH_U8 * 2:
      sample_run(row, x_begin, x_end, CHI_FETCH_U8, 0);
      break;
    case CHI_FETCH_I16 * 2:
      sample_run(row, x_begin, x_end, CHI_FETCH_I16, 0);
      break;
    case CHI_FETCH_U16 * 2:
      sample_run(row, x_begin, x_end, CHI_FETCH_U16, 0);
      break;
    case CHI_FETCH_F32 * 2:
      sample_run(row, x_begin, x_end, CHI_FETCH_F32, 0);
      break;
    case CHI_FETCH_U8 * 2 + 1:
      sample_run(row, x_begin, x_end, CHI_FETCH_U8, 1);
      break;
    case CHI_FETCH_I16 * 2 + 1:
      sample_run(row, x_begin, x_end, CHI_FETCH_I16, 1);
      break;
    case CHI_FETCH_U16 * 2 + 1:
      sample_run(row, x_begin, x_end, CHI_FETCH_U16, 1);
      break;
    default:
      sample_run(row, x_begin, x_end, CHI_FETCH_F32, 1);
      break;
  }
}

enum
{
  PARTS = CHI_SEGMENT / CHI_LANES
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
CHI_INLINE void light_run(const chi_light_segment* s, const int has_tau, const int has_geometry)
{
  vf sum[PARTS], half_tau[PARTS], geometry[PARTS];
  for (int k = 0; k < PARTS; ++k)
  {
    sum[k] = vf_set(0.0f);
    half_tau[k] = has_tau ? vf_load(s->tau + k * CHI_LANES) * -0.5f : vf_set(0.0f);
    geometry[k] = has_geometry ? vf_load(s->geometry + k * CHI_LANES) : vf_set(1.0f);
  }
  const float* source = s->source;
  float* target = s->target;
  for (int m = 0; m < s->directions; ++m, source += s->plane, target += s->plane)
  {
    vf light[PARTS];
    shifted(source + s->offset[m], s->stride, s->weight[m], light);
    for (int k = 0; k < PARTS; ++k)
    {
      vf through = vf_set(1.0f);
      if (has_tau)
      {
        const vf length = s->length[m] + (vf_iota() + (float)(k * CHI_LANES)) * s->length_x[m];
        through = vf_exp_neg(half_tau[k] * length);
        light[k] *= through;
      }
      sum[k] += light[k];
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
  const float mean = 1.0f / (float)s->directions;
  for (int k = 0; k < PARTS; ++k)
  {
    vf_store(s->visibility + k * CHI_LANES, sum[k] * mean);
  }
}

static void light(const chi_light_segment* s)
{
  if (s->tau)
  {
    if (s->geometry)
    {
      light_run(s, 1, 1);
    }
    else
    {
      light_run(s, 1, 0);
    }
  }
  else if (s->geometry)
  {
    light_run(s, 0, 1);
  }
  else
  {
    light_run(s, 0, 0);
  }
}

/* The published rule: one buffer, the mean of its taps. Schott et al. 2013, Algorithm 3. */
static void blur(const chi_light_segment* s)
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
  for (int k = 0; k < PARTS; ++k)
  {
    const int x = k * CHI_LANES;
    const vf length = s->length[0] + (vf_iota() + (float)x) * s->length_x[0];
    const vf through = s->tau ? vf_exp_neg(vf_load(s->tau + x) * length * -0.5f) : vf_set(1.0f);
    const vf seen = sum[k] * mean * through;
    vf_store(s->visibility + x, seen);
    vf_store(
      s->target + x, seen * through * (s->geometry ? vf_load(s->geometry + x) : vf_set(1.0f)));
  }
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
  const vf thin = vf_set(0.02f / length); /* below, the mean differs by < 0.02^2 / 8 = 5e-5 */
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
 * pixel: a light ray through a pixel of slope p has the slope p - s. */
static void path_lengths(const float* slope_x, const float* slope_y, int directions, float px,
  float py, float px_step, int count, float* length, float* length_x)
{
  const float last = px + px_step * (float)(count - 1);
  const float share = 1.0f / (float)(count > 1 ? count - 1 : 1);
  for (int m = 0; m < directions; ++m)
  {
    const float y = py - slope_y[m], a = px - slope_x[m], b = last - slope_x[m];
    const float first = sqrtf(1.0f + y * y + a * a);
    length[m] = first;
    length_x[m] = (sqrtf(1.0f + y * y + b * b) - first) * share;
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
