/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fragments to colours, and on to their pixels. Included by chi_tet_kernels.inl. */

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
