/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Which tiles of the window a tetrahedron may have pixels in. */

static uint32_t range_of_box(const chi_tet_window* w, const float low[2], const float high[2])
{
  const float last[2] = { (float)(w->width - 1), (float)(w->height - 1) };
  uint32_t range = 0;
  for (int k = 0; k < 2; ++k)
  {
    if (high[k] < -w->margin || low[k] > last[k] + w->margin)
    {
      return CHI_TET_OUTSIDE;
    }
    const float from = low[k] - w->margin > 0 ? ceilf(low[k] - w->margin) : 0;
    const float to = high[k] + w->margin < last[k] ? floorf(high[k] + w->margin) : last[k];
    if (from > to)
    {
      return CHI_TET_UNCOVERED;
    }
    range |= ((uint32_t)from >> CHI_TET_TILE_SHIFT) << (8 * k) |
      ((uint32_t)to >> CHI_TET_TILE_SHIFT) << (16 + 8 * k);
  }
  return range;
}

static int is_far(const chi_tet_point* points, const uint32_t v[4])
{
  for (int i = 0; i < 4; ++i)
  {
    const chi_tet_point* const p = points + v[i];
    if (!(fabs(p->x) < CHI_TET_FAR && fabs(p->y) < CHI_TET_FAR && fabs(p->z) < CHI_TET_FAR))
    {
      return 1;
    }
  }
  return 0;
}

/* One that may cross the near plane, or have a vertex too far off. */
static uint32_t range_of_any(const chi_tet_window* w, const uint32_t v[4])
{
  double box[2][2];
  if (is_far(w->points, v) ||
    !find_box(w->points, v, w->near_depth, w->parallel, w->first, w->step, box))
  {
    return CHI_TET_OUTSIDE;
  }
  const float low[2] = { (float)box[0][0], (float)box[0][1] };
  const float high[2] = { (float)box[1][0], (float)box[1][1] };
  return range_of_box(w, low, high);
}

static void ranges(const chi_tet_window* w, size_t begin, size_t end, uint32_t* out)
{
  if (w->any_beyond)
  {
    for (size_t t = begin; t < end; ++t)
    {
      out[t] = range_of_any(w, w->vertices + 4 * t);
    }
    return;
  }
#ifdef __SSE4_1__
  const __m128 margin = _mm_set1_ps(w->margin), zero = _mm_setzero_ps();
  const float x = (float)(w->width - 1), y = (float)(w->height - 1);
  const __m128 last = _mm_setr_ps(x, y, x, y);
  for (size_t t = begin; t < end; ++t)
  {
    const uint32_t* const v = w->vertices + 4 * t;
    const double* const p = (const double*)w->screen; /* pairs of floats, moved as one */
    const __m128 a = (__m128)_mm_loadh_pd(_mm_load_sd(p + v[0]), p + v[1]);
    const __m128 b = (__m128)_mm_loadh_pd(_mm_load_sd(p + v[2]), p + v[3]);
    __m128 low = _mm_min_ps(a, b), high = _mm_max_ps(a, b);
    low = _mm_min_ps(low, _mm_movehl_ps(low, low));
    high = _mm_max_ps(high, _mm_movehl_ps(high, high));
    const __m128 from = _mm_ceil_ps(_mm_max_ps(_mm_sub_ps(low, margin), zero));
    const __m128 to = _mm_floor_ps(_mm_min_ps(_mm_add_ps(high, margin), last));
    if (_mm_movemask_ps(_mm_cmple_ps(from, to)) != 15)
    {
      const float corners[2][2] = { { low[0], low[1] }, { high[0], high[1] } };
      out[t] = range_of_box(w, corners[0], corners[1]);
      continue;
    }
    const __m128i tile =
      _mm_srli_epi32(_mm_cvttps_epi32(_mm_movelh_ps(from, to)), CHI_TET_TILE_SHIFT);
    const __m128i words = _mm_packus_epi32(tile, tile);
    out[t] = (uint32_t)_mm_cvtsi128_si32(_mm_packus_epi16(words, words));
  }
#else
  for (size_t t = begin; t < end; ++t)
  {
    const uint32_t* const v = w->vertices + 4 * t;
    float low[2], high[2];
    for (int k = 0; k < 2; ++k)
    {
      low[k] = high[k] = w->screen[v[0]][k];
      for (int i = 1; i < 4; ++i)
      {
        const float c = w->screen[v[i]][k];
        low[k] = c < low[k] ? c : low[k];
        high[k] = c > high[k] ? c : high[k];
      }
    }
    out[t] = range_of_box(w, low, high);
  }
#endif
}
