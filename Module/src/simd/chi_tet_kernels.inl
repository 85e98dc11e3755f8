/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#include "chi_tet_kernels.h"

#include <math.h>

#include "chi_tet_setup.inl"

#include "chi_tet_fragments.inl"

#include "chi_segment.inl"

#include "chi_tet_ranges.inl"

/* Colours at x, extinctions at y: of none at their means, else as segment_partial, to which a full
 * table in three dimensions falls back: it would need five. */
CHI_INLINE void segment_separate(
  const chi_segment_tables* t, vf x0, vf x1, vf y0, vf y1, vf length, const int method, vf out[4])
{
  vf x[2] = { x0, x1 }, y[2] = { y0, y1 };
  if (method == CHI_PREINTEGRATION_NONE)
  {
    x[0] = x[1] = (x0 + x1) * 0.5f;
    y[0] = y[1] = (y0 + y1) * 0.5f;
  }
  vf color[2][4], tau[2];
  for (int k = 0; k < 2; ++k)
  {
    vf next[4], extinction[4];
    const vf f = segment_load(t->color, y[k], extinction, next);
    tau[k] = (extinction[3] + f * (next[3] - extinction[3])) * length;
    const vf g = segment_load(t->color, x[k], color[k], next);
    for (int c = 0; c < 3; ++c)
    {
      color[k][c] += g * (next[c] - color[k][c]);
    }
  }
  const vf psi = segment_psi(tau[0], tau[1]);
  out[3] = vf_exp_neg((tau[0] + tau[1]) * -0.5f);
  for (int c = 0; c < 3; ++c)
  {
    out[c] = color[0][c] * (1.0f - psi) + color[1][c] * (psi - out[3]);
  }
}

/* What differs from frame to frame, so that each combination has code of its own. */
typedef struct variant
{
  int parallel, separate, cuts, picking, method, shaded, direct, lit, projected;
} variant;

enum
{
  METHOD_MAXIMUM = 16 /* beside CHI_PREINTEGRATION_... */
};

#include "chi_tet_slab.inl"

/* Lengths along the rays, scalars as positions in the table. */
CHI_INLINE void finish(tile_state* t, const variant u)
{
  const chi_tet_scene* const s = t->scene;
  fragments* const f = &t->f;
  const vf base = vf_set(s->base), scale = vf_set(s->scale), end = vf_set(s->end), zero = vf_set(0);
  for (size_t i = 0; i < f->count; i += CHI_LANES)
  {
    if (!u.parallel)
    {
      const vi p = vi_load(f->pixel + i);
      const vf x = vi_float(p & (CHI_TET_TILE - 1)) * (float)s->step[0] + (float)t->left;
      const vf y = vi_float(p >> CHI_TET_TILE_SHIFT) * (float)s->step[1] + (float)t->bottom;
      vf_store(f->length + i, vf_load(f->length + i) * vf_sqrt(x * x + y * y + 1.0f));
    }
    vf_store(f->x0 + i, vf_min(vf_max((vf_load(f->x0 + i) - base) * scale, zero), end));
    vf_store(f->x1 + i, vf_min(vf_max((vf_load(f->x1 + i) - base) * scale, zero), end));
    if (u.separate)
    {
      const vf last = vf_set(s->end_y);
      for (int e = 0; e < 2; ++e)
      {
        float* const y = (e ? f->y1 : f->y0) + i;
        vf_store(y, vf_min(vf_max((vf_load(y) - s->base_y) * s->scale_y, zero), last));
      }
    }
  }
}

/* Colours front to back: premultiplied colour and transmittance of a pixel. */
CHI_INLINE void blend(float* pixel, const float source[4])
{
#if defined(CHI_VEC_AVX512) || defined(CHI_VEC_AVX2)
  const __m128 d = _mm_load_ps(pixel);
  const __m128 t = _mm_shuffle_ps(d, d, 0xff);
  _mm_store_ps(pixel, _mm_fmadd_ps(t, _mm_load_ps(source), _mm_blend_ps(d, _mm_setzero_ps(), 8)));
#else
  const float t = pixel[3];
  pixel[0] += t * source[0];
  pixel[1] += t * source[1];
  pixel[2] += t * source[2];
  pixel[3] = t * source[3];
#endif
}

/* Vectors of red, green, blue and transmittance as one colour a fragment. */
CHI_INLINE void transpose(const vf in[4], float out[CHI_LANES][4])
{
#if defined(CHI_VEC_AVX512)
  const __m512 a = _mm512_unpacklo_ps((__m512)in[0], (__m512)in[1]);
  const __m512 b = _mm512_unpackhi_ps((__m512)in[0], (__m512)in[1]);
  const __m512 c = _mm512_unpacklo_ps((__m512)in[2], (__m512)in[3]);
  const __m512 d = _mm512_unpackhi_ps((__m512)in[2], (__m512)in[3]);
  const __m512 row[4] = { (__m512)_mm512_unpacklo_pd((__m512d)a, (__m512d)c),
    (__m512)_mm512_unpackhi_pd((__m512d)a, (__m512d)c),
    (__m512)_mm512_unpacklo_pd((__m512d)b, (__m512d)d),
    (__m512)_mm512_unpackhi_pd((__m512d)b, (__m512d)d) };
  for (int k = 0; k < 4; ++k)
  {
    _mm_store_ps(out[k], _mm512_castps512_ps128(row[k]));
    _mm_store_ps(out[k + 4], _mm512_extractf32x4_ps(row[k], 1));
    _mm_store_ps(out[k + 8], _mm512_extractf32x4_ps(row[k], 2));
    _mm_store_ps(out[k + 12], _mm512_extractf32x4_ps(row[k], 3));
  }
#else
  for (int i = 0; i < CHI_LANES; ++i)
  {
    for (int k = 0; k < 4; ++k)
    {
      out[i][k] = in[k][i];
    }
  }
#endif
}

CHI_INLINE void keep_maximum(tile_state* t, const variant u)
{
  const fragments* const f = &t->f;
  for (size_t i = 0; i < f->count; ++i)
  {
    float* const p = t->target->rgba + 4 * f->pixel[i];
    const float x = f->x0[i] > f->x1[i] ? f->x0[i] : f->x1[i];
    const float y = !u.separate ? x : f->y0[i] > f->y1[i] ? f->y0[i] : f->y1[i];
    p[0] = x > p[0] ? x : p[0];
    p[1] = y > p[1] ? y : p[1];
  }
}

#include "chi_tet_colors.inl"

#include "chi_tet_plane.inl"

/* Where accumulated opacity passes what counts as hit; until then the most opaque fragment. */
CHI_INLINE void pick(tile_state* t, size_t i, float transmittance)
{
  const fragments* const f = &t->f;
  chi_tet_target* const g = t->target;
  const int32_t pixel = f->pixel[i];
  if (g->pick_alpha[pixel] > 1.0f)
  {
    return; /* hit before */
  }
  const float before = g->rgba[4 * pixel + 3];
  const float share = before * (1.0f - transmittance);
  const int hit = 1.0f - before * transmittance >= g->pick_opacity;
  if (hit || share > g->pick_alpha[pixel])
  {
    g->pick_alpha[pixel] = hit ? 2.0f : share;
    g->pick[pixel] = f->id[i];
    g->pick_depth[pixel] = f->depth[i];
  }
}

/* A fragment's premultiplied colour, by the lights on its tetrahedron. */
CHI_INLINE void light(const chi_tet_scene* s, uint32_t id, float source[4])
{
  const float* const shade = s->shades[id];
  const float alpha = 1.0f - source[3];
  for (int c = 0; c < 3; ++c)
  {
    const float lit = source[c] * shade[c] + shade[3 + c] * alpha;
    source[c] = lit < s->color_limit * alpha ? lit : s->color_limit * alpha;
  }
}

#if defined(CHI_VEC_AVX2) || defined(CHI_VEC_AVX512)
/* Numbers of pairs, and pairs of numbers: a[0] b[0] a[1] b[1] ... */
CHI_INLINE void split_pairs(const float* pairs, vf* first, vf* second)
{
  const vf a = vf_load(pairs), b = vf_load(pairs + CHI_LANES);
#  if defined(CHI_VEC_AVX512)
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odd = _mm512_or_si512(even, _mm512_set1_epi32(1));
  *first = (vf)_mm512_permutex2var_ps((__m512)a, even, (__m512)b);
  *second = (vf)_mm512_permutex2var_ps((__m512)a, odd, (__m512)b);
#  else
  const __m256 x = _mm256_permute2f128_ps((__m256)a, (__m256)b, 0x20);
  const __m256 y = _mm256_permute2f128_ps((__m256)a, (__m256)b, 0x31);
  *first = (vf)_mm256_shuffle_ps(x, y, 0x88);
  *second = (vf)_mm256_shuffle_ps(x, y, 0xdd);
#  endif
}

CHI_INLINE void join_pairs(vf first, vf second, float* pairs)
{
#  if defined(CHI_VEC_AVX512)
  const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
  vf_store(pairs, (vf)_mm512_permutex2var_ps((__m512)first, low, (__m512)second));
  vf_store(pairs + CHI_LANES, (vf)_mm512_permutex2var_ps((__m512)first, high, (__m512)second));
#  else
  const __m256 x = _mm256_unpacklo_ps((__m256)first, (__m256)second);
  const __m256 y = _mm256_unpackhi_ps((__m256)first, (__m256)second);
  vf_store(pairs, (vf)_mm256_permute2f128_ps(x, y, 0x20));
  vf_store(pairs + CHI_LANES, (vf)_mm256_permute2f128_ps(x, y, 0x31));
#  endif
}

/* A premultiplied colour and transmittance behind those of a pixel. */
CHI_INLINE void blend_behind(float* pixel, __m128 source)
{
  const __m128 d = _mm_load_ps(pixel);
  const __m128 before = _mm_shuffle_ps(d, d, 0xff);
  _mm_store_ps(pixel, _mm_fmadd_ps(before, source, _mm_blend_ps(d, _mm_setzero_ps(), 8)));
}

/* e^-x of x >= 0. */
CHI_INLINE vf transmittance_of(vf x)
{
  return vi_any(x > 0.25f) ? vf_exp_neg(-x) : segment_exp_thin(-x);
}

/* The same by the nearest entries of tables whose entries hardly differ from each other. */
CHI_INLINE void blend_fine(tile_state* t)
{
  const chi_tet_scene* const s = t->scene;
  fragments* const f = &t->f;
  const size_t count = f->count;
  int32_t at[2][FRAGMENTS + CHI_LANES];
  float weight[2][FRAGMENTS + CHI_LANES]; /* extinctions; then weights */
  for (size_t i = 0; i < count; i += CHI_LANES)
  {
    vi_store(at[0] + i, vf_int(vf_load(f->x0 + i) + 0.5f));
    vi_store(at[1] + i, vf_int(vf_load(f->x1 + i) + 0.5f));
  }
  for (size_t i = 0; i < count; ++i)
  {
    weight[0][i] = s->extinction[at[0][i]];
    weight[1][i] = s->extinction[at[1][i]];
  }
  for (size_t i = 0; i < count; i += CHI_LANES)
  {
    const vf length = vf_load(f->length + i);
    const vf front = vf_load(weight[0] + i) * length, back = vf_load(weight[1] + i) * length;
    const vf psi = segment_psi(front, back);
    const vf through = transmittance_of((front + back) * 0.5f);
    vf_store(weight[0] + i, 1.0f - psi);
    vf_store(weight[1] + i, psi - through);
    vf_store(f->length + i, through);
  }
  const float(*const color)[4] = s->tables->color;
  for (size_t i = 0; i < count; ++i)
  {
    const __m128 behind = _mm_mul_ps(_mm_set1_ps(weight[1][i]), _mm_loadu_ps(color[at[1][i]]));
    const __m128 sum =
      _mm_fmadd_ps(_mm_set1_ps(weight[0][i]), _mm_loadu_ps(color[at[0][i]]), behind);
    blend_behind(
      t->target->rgba + 4 * f->pixel[i], _mm_blend_ps(sum, _mm_set1_ps(f->length[i]), 8));
  }
}

/*
 * What segment_partial computes, arranged for fragments that end in single pixels: only extinctions
 * are looked up before the weights are known; an entry of the table and the next are loaded as one
 * and multiplied by both their weights, colour by colour, on their way to the pixel.
 */
CHI_INLINE void blend_partial(tile_state* t)
{
  const chi_tet_scene* const s = t->scene;
  fragments* const f = &t->f;
  const size_t count = f->count;
  int32_t at[2][FRAGMENTS + CHI_LANES];
  float pairs[2][2 * (FRAGMENTS + CHI_LANES)]; /* extinctions; then weights */
  for (size_t i = 0; i < count; i += CHI_LANES)
  {
    for (int e = 0; e < 2; ++e)
    {
      float* const x = (e ? f->x1 : f->x0) + i;
      const vf place = vf_load(x);
      const vi index = vf_int(place);
      vi_store(at[e] + i, index);
      vf_store(x, place - vi_float(index));
    }
  }
  for (size_t i = 0; i < count; ++i)
  {
    memcpy(pairs[0] + 2 * i, s->extinction + at[0][i], 2 * sizeof(float));
    memcpy(pairs[1] + 2 * i, s->extinction + at[1][i], 2 * sizeof(float));
  }
  for (size_t i = 0; i < count; i += CHI_LANES)
  {
    const vf length = vf_load(f->length + i);
    vf part[2], tau[2];
    for (int e = 0; e < 2; ++e)
    {
      vf here, next;
      split_pairs(pairs[e] + 2 * i, &here, &next);
      part[e] = vf_load((e ? f->x1 : f->x0) + i);
      tau[e] = (here + part[e] * (next - here)) * length;
    }
    const vf psi = segment_psi(tau[0], tau[1]);
    const vf through = transmittance_of((tau[0] + tau[1]) * 0.5f);
    const vf weight[2] = { 1.0f - psi, psi - through };
    for (int e = 0; e < 2; ++e)
    {
      join_pairs(weight[e] * (1.0f - part[e]), weight[e] * part[e], pairs[e] + 2 * i);
    }
    vf_store(f->length + i, through);
  }
  const float(*const color)[4] = s->tables->color;
  const __m256i spread = _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
  for (size_t i = 0; i < count; ++i)
  {
    __m256 sum = _mm256_setzero_ps();
    for (int e = 0; e < 2; ++e)
    {
      double both;
      memcpy(&both, pairs[e] + 2 * i, sizeof both);
      const __m256 w = _mm256_permutevar_ps((__m256)_mm256_set1_pd(both), spread);
      sum = _mm256_fmadd_ps(_mm256_loadu_ps(color[at[e][i]]), w, sum);
    }
    const __m128 source =
      _mm_blend_ps(_mm_add_ps(_mm256_castps256_ps128(sum), _mm256_extractf128_ps(sum, 1)),
        _mm_set1_ps(f->length[i]), 8);
    blend_behind(t->target->rgba + 4 * f->pixel[i], source);
  }
}
#endif

/* Colours of all fragments, whose vectors are whole, and on to their pixels. */
CHI_INLINE void blend_fragments(tile_state* t, const variant u)
{
  const chi_segment_tables* const tables = t->scene->tables;
  fragments* const f = &t->f;
  t->tally->fragments += (int64_t)f->count;
  if (u.method == METHOD_MAXIMUM)
  {
    if (u.direct)
    {
      keep_maximum_color(t);
    }
    else if (t->scene->plane)
    {
      keep_maximum_plane(t);
    }
    else
    {
      keep_maximum(t, u);
    }
    f->count = 0;
    return;
  }
#if defined(CHI_VEC_AVX2) || defined(CHI_VEC_AVX512)
  if (u.method == CHI_PREINTEGRATION_PARTIAL && !u.separate && !u.picking && !u.shaded &&
    !u.direct && !u.lit)
  {
    if (t->scene->fine)
    {
      blend_fine(t);
    }
    else
    {
      blend_partial(t);
    }
    f->count = 0;
    return;
  }
#endif
  float* const rgba = t->target->rgba;
  for (size_t i = 0; i < f->count; i += CHI_LANES)
  {
    const vf x0 = vf_load(f->x0 + i), x1 = vf_load(f->x1 + i), length = vf_load(f->length + i);
    vf color[4];
    if (u.direct)
    {
      segment_direct(t, i, u.method, color);
    }
    else if (u.separate && t->scene->plane)
    {
      segment_plane(
        t->scene, x0, x1, vf_load(f->y0 + i), vf_load(f->y1 + i), length, u.method, color);
    }
    else if (u.separate)
    {
      segment_separate(
        tables, x0, x1, vf_load(f->y0 + i), vf_load(f->y1 + i), length, u.method, color);
    }
    else if (u.method == CHI_PREINTEGRATION_FULL)
    {
      segment_full(tables, x0, x1, length, color);
    }
    else if (u.method == CHI_PREINTEGRATION_PARTIAL)
    {
      segment_partial(tables, x0, x1, length, color);
    }
    else
    {
      segment_none(tables, x0, x1, length, color);
    }
    float source[CHI_LANES][4] __attribute__((aligned(64)));
    transpose(color, source);
    const size_t left = f->count - i;
    const int n = left < CHI_LANES ? (int)left : CHI_LANES;
    float lit[CHI_LANES];
    if (u.lit)
    {
      find_light(t, i, lit);
    }
    for (int k = 0; k < n; ++k)
    {
      if (u.shaded)
      {
        light(t->scene, f->id[i + (size_t)k], source[k]);
      }
      for (int c = 0; c < 3 && u.lit; ++c)
      {
        source[k][c] *= lit[k];
      }
      if (u.picking)
      {
        pick(t, i + (size_t)k, source[k][3]);
      }
      blend(rgba + 4 * f->pixel[i + (size_t)k], source[k]);
    }
  }
  f->count = 0;
}

CHI_INLINE void pad(fragments* f)
{
  for (size_t i = f->count; i < f->count + CHI_LANES; ++i)
  {
    f->pixel[i] = 0;
    f->length[i] = f->x0[i] = f->x1[i] = f->y0[i] = f->y1[i] = f->depth[i] = 0;
  }
}

static __attribute__((noinline)) void keep(const tile_state* t)
{
  chi_tet_cached* const to = t->target->cached;
  const fragments* const f = &t->f;
  const float scale = 65535.0f / t->scene->end;
  for (size_t i = 0; i < f->count; ++i)
  {
    to->pixel[to->count + i] = (uint16_t)f->pixel[i];
    to->length[to->count + i] = f->length[i];
    to->ends[to->count + i][0] = (uint16_t)(int32_t)(f->x0[i] * scale + 0.5f);
    to->ends[to->count + i][1] = (uint16_t)(int32_t)(f->x1[i] * scale + 0.5f);
  }
  to->count += f->count;
}

CHI_INLINE void consume(tile_state* t, const variant u)
{
  pad(&t->f);
  if (u.direct)
  {
    pad_colors(t);
  }
  finish(t, u);
  if (t->target->cached)
  {
    keep(t);
  }
  blend_fragments(t, u);
}

CHI_INLINE void draw_kept(
  const chi_tet_scene* scene, chi_tet_target* target, chi_tet_tally* tally, const variant u)
{
  tile_state t;
  t.scene = scene;
  t.target = target;
  t.tally = tally;
  fragments* const f = &t.f;
  const chi_tet_cached* const from = target->cached;
  const float scale = scene->end / 65535.0f;
  for (size_t done = 0; done < from->count; done += FRAGMENTS)
  {
    const size_t left = from->count - done;
    f->count = left < FRAGMENTS ? left : FRAGMENTS;
    for (size_t i = 0; i < f->count; ++i)
    {
      const float x0 = (float)from->ends[done + i][0] * scale;
      const float x1 = (float)from->ends[done + i][1] * scale;
      f->pixel[i] = from->pixel[done + i];
      f->length[i] = from->length[done + i];
      f->x0[i] = x0 < scene->end ? x0 : scene->end;
      f->x1[i] = x1 < scene->end ? x1 : scene->end;
    }
    pad(f);
    blend_fragments(&t, u);
  }
}

/* Rows of a box that is at most as wide as a vector, as many as fit into one: pixels from the
 * first. */
typedef struct narrow_boxes
{
  float x[CHI_LANES + 1][CHI_LANES], y[CHI_LANES + 1][CHI_LANES];
  int32_t pixel[CHI_LANES + 1][CHI_LANES];
  int32_t rows[CHI_LANES + 1];
} narrow_boxes;

static void make_narrow_boxes(narrow_boxes* boxes)
{
  for (int width = 1; width <= CHI_LANES; ++width)
  {
    boxes->rows[width] = CHI_LANES / width;
    for (int i = 0; i < CHI_LANES; ++i)
    {
      const int x = i % width, y = i / width;
      boxes->x[width][i] = (float)x;
      /* lanes beyond the last whole row belong to no row that a box has */
      boxes->y[width][i] = y < boxes->rows[width] ? (float)y : 2.0f * CHI_TET_TILE;
      boxes->pixel[width][i] = y < boxes->rows[width] ? (y << CHI_TET_TILE_SHIFT) + x : 0;
    }
  }
}

/* Where in its box a tetrahedron is being drawn. */
typedef struct cursor
{
  int32_t row;
  int32_t spans_row; /* first row of `first` and `last`; -1: none */
  int32_t first[CHI_LANES], last[CHI_LANES];
} cursor;

/* The pixels of CHI_LANES rows that the projected edges enclose. */
CHI_INLINE void find_spans(const batch* r, int lane, cursor* at)
{
  const int32_t x0 = r->x0[lane], x1 = r->x1[lane];
  if (r->state[lane] & SPREAD)
  {
    vi_store(at->first, vi_set(x0));
    vi_store(at->last, vi_set(x1));
    return;
  }
  const vf row = vf_iota() + (float)(r->y0[lane] + at->row);
  vf left = vf_set(1e9f), right = vf_set(-1e9f);
  for (int e = 0; e < 6; ++e)
  {
    const vi meets = (row >= r->edge_low[e][lane]) & (row <= r->edge_high[e][lane]);
    const vf x = row * r->edge_slope[e][lane] + r->edge_x[e][lane];
    left = vf_select(meets, vf_min(left, x), left);
    right = vf_select(meets, vf_max(right, x), right);
  }
  /* twice the margin: the slope carries that of the row */
  const vf l = vf_max(left - 4 * MARGIN, vf_set((float)x0));
  const vf h = vf_min(right + 4 * MARGIN, vf_set((float)x1));
  const vi li = vf_int(vf_min(l, vf_set(CHI_TET_TILE)));
  vi_store(at->first, li - (vi_float(li) < l));
  vi_store(at->last, vf_int(vf_max(h, vf_set(-1)) + 1.0f) - 1);
}

/* Goes on with a tetrahedron until it is done, or the fragments fill their buffer: 0 then. */
CHI_INLINE int go_on(tile_state* t, int lane, cursor* at, const narrow_boxes* boxes,
  const uint8_t* marked, const variant u)
{
  const batch* const r = &t->r;
  const int32_t x0 = r->x0[lane], y0 = r->y0[lane];
  const int32_t width = r->x1[lane] - x0 + 1, height = r->y1[lane] - y0 + 1;
  const int32_t start = (y0 << CHI_TET_TILE_SHIFT) + x0;
  if (width <= CHI_LANES)
  {
    const vf x = vf_load(boxes->x[width]), y = vf_load(boxes->y[width]);
    const vi pixel = vi_load(boxes->pixel[width]) + start;
    for (; at->row < height; at->row += boxes->rows[width])
    {
      if (t->f.count > FRAGMENTS - CHI_LANES)
      {
        return 0;
      }
      const vf row = y + (float)at->row;
      evaluate(t, lane, x, row, pixel + (at->row << CHI_TET_TILE_SHIFT), row < (float)height,
        u.parallel, u.separate, u.direct, u.cuts, u.picking, u.lit, u.picking | u.shaded, marked);
    }
    return 1;
  }
  for (; at->row < height; ++at->row)
  {
    if (t->f.count > FRAGMENTS - CHI_TET_TILE)
    {
      return 0;
    }
    if (at->spans_row < 0 || at->row >= at->spans_row + CHI_LANES)
    {
      at->spans_row = at->row;
      find_spans(r, lane, at);
    }
    const int32_t first = at->first[at->row - at->spans_row];
    const int32_t last = at->last[at->row - at->spans_row];
    for (int32_t i = first; i <= last; i += CHI_LANES)
    {
      const vf x = vf_iota() + (float)(i - x0);
      const vi in_row = vf_int(vf_iota()) + i;
      const vi wanted = in_row <= last;
      /* beyond the row's end any pixel of the tile will do */
      const vi pixel = (in_row & wanted) + ((y0 + at->row) << CHI_TET_TILE_SHIFT);
      evaluate(t, lane, x, vf_set((float)at->row), pixel, wanted, u.parallel, u.separate, u.direct,
        u.cuts, u.picking, u.lit, u.picking | u.shaded, marked);
    }
  }
  return 1;
}

/* The end of a projector's pipe. */
typedef struct tile_sink
{
  chi_tet_sink sink;
  tile_state* tile;
  variant variant;
} tile_sink;

static void put(chi_tet_sink* sink, uint32_t tetrahedron, const chi_tet_fragment* from)
{
  tile_sink* const it = (tile_sink*)sink;
  fragments* const f = &it->tile->f;
  if (f->count == FRAGMENTS)
  {
    consume(it->tile, it->variant);
  }
  const size_t i = f->count++;
  f->pixel[i] = from->pixel;
  f->length[i] = from->length;
  f->x0[i] = from->value[0][0];
  f->x1[i] = from->value[0][1];
  f->y0[i] = from->value[1][0];
  f->y1[i] = from->value[1][1];
  for (int k = 0; k < 3 && it->variant.direct; ++k)
  {
    it->tile->colors[0][k][i] = from->value[CHI_TET_COLORS + k][0];
    it->tile->colors[1][k][i] = from->value[CHI_TET_COLORS + k][1];
  }
  f->id[i] = tetrahedron;
}

static void settle(chi_tet_sink* sink)
{
  tile_sink* const it = (tile_sink*)sink;
  consume(it->tile, it->variant);
}

static __attribute__((noinline)) int project(tile_state* t, uint32_t tetrahedron, const variant u)
{
  const int32_t tile[2] = { t->x, t->y };
  chi_tet_projector* const projector = t->target->projector;
  tile_sink sink = { { put, settle }, t, u };
  return projector->draw(projector, t->scene, tetrahedron, tile, &sink.sink);
}

CHI_INLINE void draw_batch(tile_state* t, int n, const narrow_boxes* boxes, const variant u)
{
  batch* const r = &t->r;
  for (int o = 0; o < CHI_LANES && o < n; o += HALF_LANES)
  {
    set_up(r, o, t->scene, t->x, t->y, u.parallel, u.separate, u.direct);
  }
  t->tally->tetrahedra += n;
  for (int lane = 0; lane < n; ++lane)
  {
    const uint8_t* marked = NULL;
    if (u.projected)
    {
      const int rest = project(t, r->id[lane], u);
      marked = rest == CHI_TET_REST_UNMARKED ? t->target->projector->marked : NULL;
      if (rest == CHI_TET_REST_NONE)
      {
        continue;
      }
    }
    if (r->x1[lane] < r->x0[lane] || r->y1[lane] < r->y0[lane])
    {
      continue;
    }
    if (r->state[lane] & FLAT)
    {
      ++t->tally->flat;
      continue;
    }
    if (r->state[lane] & DELICATE_CELL)
    {
      ++t->tally->delicate;
      make_faces(t, lane);
    }
    cursor at;
    at.row = 0;
    at.spans_row = -1;
    while (!go_on(t, lane, &at, boxes, marked, u))
    {
      consume(t, u);
    }
  }
}

static int is_saturated(const float* rgba, float stop)
{
  vf most = vf_set(0);
  for (size_t i = 3; i < 4 * CHI_TET_TILE_PIXELS; i += 4)
  {
    if (rgba[i] > stop)
    {
      return 0;
    }
  }
  (void)most;
  return 1;
}

CHI_INLINE void draw_tile(const chi_tet_scene* scene, const uint64_t* list, size_t count,
  int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally, const variant u)
{
  tile_state t;
  narrow_boxes boxes;
  make_narrow_boxes(&boxes);
#if defined(CHI_VEC_AVX2)
  for (uint32_t mask = 0; mask < 256; ++mask)
  {
    int shift = 0;
    t.lanes[mask] = 0;
    for (uint64_t lane = 0; lane < 8; ++lane)
    {
      if (mask >> lane & 1)
      {
        t.lanes[mask] |= lane << shift;
        shift += 8;
      }
    }
  }
#endif
  t.scene = scene;
  t.x = tile_x;
  t.y = tile_y;
  t.left = scene->first[0] + scene->step[0] * tile_x;
  t.bottom = scene->first[1] + scene->step[1] * tile_y;
  t.f.count = 0;
  t.target = target;
  t.tally = tally;
  for (size_t k = 0; k < scene->plane_count; ++k)
  {
    const double* const p = scene->planes + 4 * k;
    t.plane[k][0] = (float)((scene->parallel ? -p[0] : p[0]) * scene->step[0]);
    t.plane[k][1] = (float)((scene->parallel ? -p[1] : p[1]) * scene->step[1]);
    t.plane[k][2] = (float)(scene->parallel ? -(p[0] * t.left + p[1] * t.bottom + p[3])
                                            : p[0] * t.left + p[1] * t.bottom + p[2]);
    t.plane[k][3] = (float)(scene->parallel ? p[2] : -p[3]);
  }
  const size_t check = 64 * CHI_LANES; /* how often to look whether all is opaque: cheap enough */
  for (size_t done = 0; done < count; done += CHI_LANES)
  {
    const size_t left = count - done;
    const int n = left < CHI_LANES ? (int)left : CHI_LANES;
    for (int i = 0; i < CHI_LANES; ++i)
    {
      t.r.id[i] = (uint32_t)list[left - 1 - (size_t)(i < n ? i : n - 1)];
    }
    for (int i = 0; i < CHI_LANES; ++i) /* the next batch's points, and the vertices of one later */
    {
      const size_t next = (size_t)(CHI_LANES + i), later = (size_t)(3 * CHI_LANES + i);
      if (next < left)
      {
        const uint32_t* const v = scene->vertices + 4 * (size_t)(uint32_t)list[left - 1 - next];
        for (int c = 0; c < 4; ++c)
        {
          __builtin_prefetch(scene->points + v[c]);
        }
      }
      if (later < left)
      {
        __builtin_prefetch(scene->vertices + 4 * (size_t)(uint32_t)list[left - 1 - later]);
      }
    }
    draw_batch(&t, n, &boxes, u);
    if (target->stop > 0 && done % check == 0 && done > 0)
    {
      consume(&t, u);
      if (is_saturated(target->rgba, target->stop))
      {
        tally->saturated += (int64_t)(left - (size_t)n);
        return;
      }
    }
  }
  consume(&t, u);
}

#define CHI_DRAW(name, parallel, separate, cuts, method, lit)                                      \
  static __attribute__((noinline)) void name(const chi_tet_scene* scene, const uint64_t* list,     \
    size_t count, int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)    \
  {                                                                                                \
    draw_tile(scene, list, count, tile_x, tile_y, target, tally,                                   \
      (variant){ parallel, separate, cuts, 0, method, 0, 0, lit, 0 });                             \
  }
CHI_DRAW(draw_none, 0, 0, 0, CHI_PREINTEGRATION_NONE, 0)
CHI_DRAW(draw_partial, 0, 0, 0, CHI_PREINTEGRATION_PARTIAL, 0)
CHI_DRAW(draw_full, 0, 0, 0, CHI_PREINTEGRATION_FULL, 0)
CHI_DRAW(draw_partial_cut, 0, 0, 1, CHI_PREINTEGRATION_PARTIAL, 0)
CHI_DRAW(draw_full_cut, 0, 0, 1, CHI_PREINTEGRATION_FULL, 0)
CHI_DRAW(draw_partial_lit, 0, 0, 1, CHI_PREINTEGRATION_PARTIAL, 1)
CHI_DRAW(draw_full_lit, 0, 0, 1, CHI_PREINTEGRATION_FULL, 1)

/* Everything that is rarer, by one code. */
static __attribute__((noinline)) void draw_any(const chi_tet_scene* scene, const uint64_t* list,
  size_t count, int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)
{
  const variant u = { scene->parallel, scene->separate,
    scene->depth || scene->plane_count || scene->limited, target->pick_alpha != NULL,
    scene->maximum ? METHOD_MAXIMUM : scene->tables->method, scene->shades != NULL,
    scene->colors != NULL, target->light[0] != NULL, target->projector != NULL };
  draw_tile(scene, list, count, tile_x, tile_y, target, tally, u);
}

static void draw(const chi_tet_scene* scene, const uint64_t* list, size_t count, int32_t tile_x,
  int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)
{
  const int cuts = scene->depth || scene->plane_count || scene->limited;
  const int lit = target->light[0] != NULL;
  const int common = !scene->parallel && !scene->separate && !target->pick_alpha &&
    !scene->maximum && !scene->shades && !scene->colors && !target->projector;
  const int plain = common && !lit;
  const int method = scene->tables->method;
  (common && lit && method == CHI_PREINTEGRATION_PARTIAL       ? draw_partial_lit
      : common && lit && method == CHI_PREINTEGRATION_FULL     ? draw_full_lit
      : plain && !cuts && method == CHI_PREINTEGRATION_PARTIAL ? draw_partial
      : plain && cuts && method == CHI_PREINTEGRATION_PARTIAL  ? draw_partial_cut
      : plain && !cuts && method == CHI_PREINTEGRATION_FULL    ? draw_full
      : plain && cuts && method == CHI_PREINTEGRATION_FULL     ? draw_full_cut
      : plain && !cuts && method == CHI_PREINTEGRATION_NONE
      ? draw_none
      : draw_any)(scene, list, count, tile_x, tile_y, target, tally);
}

static void draw_cached(const chi_tet_scene* scene, chi_tet_target* target, chi_tet_tally* tally)
{
  const variant u = { scene->parallel, 0, 0, 0, scene->tables->method, 0, 0, 0, 0 };
  if (u.method == CHI_PREINTEGRATION_PARTIAL)
  {
    draw_kept(
      scene, target, tally, (variant){ 0, 0, 0, 0, CHI_PREINTEGRATION_PARTIAL, 0, 0, 0, 0 });
  }
  else
  {
    draw_kept(scene, target, tally, u);
  }
}
