/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* From tetrahedra to fragments: the pixels that may be covered, and of those that are, the length
 * of the ray inside and the scalars at both its ends. */

enum
{
  FRAGMENTS = 512 /* at a time: all buffers together stay in the first cache */
};

typedef struct fragments
{
  size_t count;
  int32_t pixel[FRAGMENTS + CHI_LANES];
  float length[FRAGMENTS + CHI_LANES];                        /* along z; then along the ray */
  float x0[FRAGMENTS + CHI_LANES], x1[FRAGMENTS + CHI_LANES]; /* scalars at entry and exit */
  float y0[FRAGMENTS + CHI_LANES], y1[FRAGMENTS + CHI_LANES]; /* the opacity's */
  float depth[FRAGMENTS + CHI_LANES]; /* of the entry; of the middle, where it is lit */
  uint32_t id[FRAGMENTS + CHI_LANES];
} fragments;

/* A face by its points in the order of their ids, so that both tetrahedra at it compute the same
 * bits: exactly one of them is where a ray lies in its plane. */
typedef struct face
{
  double n[3]; /* normal */
  double at[3];
  double sign; /* +-1: the side of the tetrahedron */
} face;

typedef struct tile_state
{
  const chi_tet_scene* scene;
  double left, bottom; /* of the first pixel's centre, at depth 1 or world units */
  int32_t x, y;        /* first pixel */
  batch r;
  face faces[4];       /* of the last delicate tetrahedron */
  uint64_t lanes[256]; /* of mask_of; where it has one */
  fragments f;
  float plane[CHI_TET_CUTS][4]; /* cuts of this tile: m = p0 dx + p1 dy + p2 against p3 */
  chi_tet_target* target;
  chi_tet_tally* tally;
  float colors[2][3][FRAGMENTS + CHI_LANES]; /* direct ones at entry and exit */
} tile_state;

/* Lanes that are set in the mask, one after the other; returns nothing, the caller counts. */
#if defined(CHI_VEC_AVX512)
typedef __mmask16 lane_mask;
CHI_INLINE lane_mask mask_of(const uint64_t* table, vi mask)
{
  (void)table;
  return _mm512_movepi32_mask((__m512i)mask);
}
CHI_INLINE void compress(float* out, lane_mask mask, vf v)
{
  _mm512_storeu_ps(out, _mm512_maskz_compress_ps(mask, (__m512)v));
}
CHI_INLINE size_t lanes_of(lane_mask mask)
{
  return (size_t)__builtin_popcount(mask);
}
#elif defined(CHI_VEC_AVX2)
typedef struct lane_mask
{
  __m256i lanes; /* which lane comes first, second, ... */
  int bits;
} lane_mask;
/* By a table of the 256 masks: the lanes that each selects, a byte each. */
CHI_INLINE lane_mask mask_of(const uint64_t* table, vi mask)
{
  const int bits = _mm256_movemask_ps((__m256)mask);
  return (lane_mask){ _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i*)(table + bits))), bits };
}
CHI_INLINE void compress(float* out, lane_mask mask, vf v)
{
  _mm256_storeu_ps(out, _mm256_permutevar8x32_ps((__m256)v, mask.lanes));
}
CHI_INLINE size_t lanes_of(lane_mask mask)
{
  return (size_t)__builtin_popcount((unsigned)mask.bits);
}
#else
typedef vi lane_mask;
CHI_INLINE lane_mask mask_of(const uint64_t* table, vi mask)
{
  (void)table;
  return mask;
}
CHI_INLINE void compress(float* out, lane_mask mask, vf v)
{
  for (int i = 0; i < CHI_LANES; ++i)
  {
    *out = v[i];
    out -= mask[i];
  }
}
CHI_INLINE size_t lanes_of(lane_mask mask)
{
  return (size_t)vi_count(mask);
}
#endif

/* Clip planes, the surface and limits of depth: the rays of these pixels are cut to [low, high], by
 * w from the depth z0, which is positive in perspective. */
CHI_INLINE void cut(const tile_state* t, vi pixel, vf z0, const int parallel, vf* low, vf* high)
{
  const chi_tet_scene* const s = t->scene;
  const vf x = vi_float(pixel & (CHI_TET_TILE - 1)), y = vi_float(pixel >> CHI_TET_TILE_SHIFT);
  for (size_t k = 0; k < s->plane_count; ++k)
  {
    /* m z >= q stays, in parallel projection c z >= q */
    const float* const p = t->plane[k];
    vf w;
    vi enters;
    if (parallel)
    {
      const vf q = x * p[0] + y * p[1] + p[2];
      const vf z = q / p[3];
      const vi level = vf_set(p[3]) == 0.0f;
      const vi out = q > 0.0f;
      w = vf_select(level, vf_select(out, vf_set(3e38f), vf_set(-3e38f)), z - z0);
      enters = level | (vf_set(p[3]) > 0.0f);
    }
    else
    {
      const vf m = x * p[0] + y * p[1] + p[2];
      const vi level = vf_set(p[3]) == 0.0f;
      const vi out = m < 0.0f;
      w = vf_select(level, vf_select(out, vf_set(3e38f), vf_set(-3e38f)), 1.0f - z0 * m / p[3]);
      enters = level | (vf_set(p[3]) > 0.0f);
    }
    *low = vf_select(enters, vf_max(*low, w), *low);
    *high = vf_select(enters, *high, vf_min(*high, w));
  }
  if (s->depth)
  {
    float depth[CHI_LANES];
    for (int i = 0; i < CHI_LANES; ++i)
    {
      const int32_t column = t->x + (pixel[i] & (CHI_TET_TILE - 1));
      const int32_t row = t->y + ((pixel[i] & (CHI_TET_TILE_PIXELS - 1)) >> CHI_TET_TILE_SHIFT);
      const float d = column < s->width && row < s->height
        ? s->depth[(size_t)row * (size_t)s->width + (size_t)column]
        : 0.0f;
      depth[i] = d > 0.0f ? d : INFINITY;
    }
    const vf d = vf_load(depth);
    *high = vf_min(*high, parallel ? d - z0 : 1.0f - z0 / d);
  }
  if (s->limited)
  {
    *low = vf_max(*low, parallel ? s->limits[0] - z0 : 1.0f - z0 / s->limits[0]);
    *high = vf_min(*high, parallel ? s->limits[1] - z0 : 1.0f - z0 / s->limits[1]);
  }
}

/* Filled in once a tetrahedron. */
static void make_face(
  const chi_tet_scene* s, const uint32_t v[4], int opposite, double orientation, face* out)
{
  static const int of[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  uint32_t id[3] = { v[of[opposite][0]], v[of[opposite][1]], v[of[opposite][2]] };
  double sign = orientation;
  for (int i = 0; i < 2; ++i)
  {
    for (int j = 0; j < 2 - i; ++j)
    {
      if (id[j] > id[j + 1])
      {
        const uint32_t swap = id[j];
        id[j] = id[j + 1];
        id[j + 1] = swap;
        sign = -sign;
      }
    }
  }
  const chi_tet_point *a = s->points + id[0], *b = s->points + id[1], *c = s->points + id[2];
  const double e[3] = { b->x - a->x, b->y - a->y, b->z - a->z };
  const double g[3] = { c->x - a->x, c->y - a->y, c->z - a->z };
  out->n[0] = e[1] * g[2] - e[2] * g[1];
  out->n[1] = e[2] * g[0] - e[0] * g[2];
  out->n[2] = e[0] * g[1] - e[1] * g[0];
  out->at[0] = a->x;
  out->at[1] = a->y;
  out->at[2] = a->z;
  out->sign = sign;
}

static __attribute__((noinline)) void make_faces(tile_state* t, int lane)
{
  const chi_tet_scene* const s = t->scene;
  const uint32_t* const v = s->vertices + 4 * (size_t)t->r.id[lane];
  const chi_tet_point* const p = s->points + v[0];
  double e[3][3];
  for (int i = 0; i < 3; ++i)
  {
    const chi_tet_point* const q = s->points + v[i + 1];
    e[i][0] = q->x - p->x;
    e[i][1] = q->y - p->y;
    e[i][2] = q->z - p->z;
  }
  const double det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
    e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  for (int i = 0; i < 4; ++i)
  {
    make_face(s, v, i, det < 0 ? 1 : -1, t->faces + i);
  }
}

/* Pixels of one delicate tetrahedron: from z0 to the entry and to the exit, and the length inside,
 * along z; in double. Lengths are not positive where the ray does not meet it. */
static __attribute__((noinline)) void cross_delicate(
  const tile_state* t, float from, const int32_t pixel[CHI_LANES], float out[3][CHI_LANES])
{
  const chi_tet_scene* const s = t->scene;
  const vd infinity = vd_set(INFINITY), z0 = vd_set((double)from);
  for (int i = 0; i < CHI_LANES; i += HALF_LANES)
  {
    vhi p;
    memcpy(&p, pixel + i, sizeof p);
    const vd x = t->left + s->step[0] * __builtin_convertvector(p & (CHI_TET_TILE - 1), vd);
    const vd y = t->bottom + s->step[1] * __builtin_convertvector(p >> CHI_TET_TILE_SHIFT, vd);
    vd low = vd_set(s->near_depth), high = infinity;
    for (int k = 0; k < 4; ++k)
    {
      const face* const of = t->faces + k;
      /* n . (a - p(z)) = along (za - z) + across: zero where the ray meets the plane */
      const double zs = s->parallel ? 1 : of->at[2];
      const vd along = s->parallel ? vd_set(of->n[2]) : of->n[0] * x + of->n[1] * y + of->n[2];
      const vd across = of->n[0] * (of->at[0] - zs * x) + of->n[1] * (of->at[1] - zs * y);
      const vd z = of->at[2] + across / along;
      const vl enters = along * of->sign > 0, leaves = along * of->sign < 0;
      low = vd_select(enters, vd_max(z, low), low);
      high = vd_select(leaves, vd_min(z, high), high);
      /* within the plane: on one side of it, and of the two tetrahedra at it in one alone */
      const vl outside =
        ~(enters | leaves) & ((across * of->sign > 0) | ((across == 0) & (vd_set(of->sign) < 0)));
      high = vd_select(outside, -infinity, high);
    }
    const vl meets = (low > -infinity) & (high < infinity);
    vh_store(out[0] + i, vd_float(low - z0));
    vh_store(out[1] + i, vd_float(high - z0));
    vh_store(out[2] + i, vd_float(vd_select(meets, high - low, vd_set(-1))));
  }
}

/* To 4e-8 of it: one step of Newton's method from 14 bits. */
CHI_INLINE vf reciprocal(vf a)
{
#if defined(CHI_VEC_AVX512)
  const vf x = (vf)_mm512_rcp14_ps((__m512)a);
  return x + x * (1.0f - a * x);
#else
  return 1.0f / a;
#endif
}

#if defined(CHI_VEC_AVX512)
typedef __mmask16 face_mask;
#else
typedef vi face_mask;
#endif

/* All lanes, if the face looks at the eye. */
CHI_INLINE face_mask mask_of_face(int32_t front, int k)
{
#if defined(CHI_VEC_AVX512)
  return (face_mask) - ((front >> k) & 1);
#else
  return vi_set(-((front >> k) & 1));
#endif
}

/* The ray is inside of the face's half-space where w is larger, if it looks at the eye, or smaller.
 */
CHI_INLINE void narrow(face_mask enters, vf w, vf* low, vf* high)
{
#if defined(CHI_VEC_AVX512)
  *low = (vf)_mm512_mask_max_ps((__m512)*low, enters, (__m512)*low, (__m512)w);
  *high = (vf)_mm512_mask_min_ps((__m512)*high, _knot_mask16(enters), (__m512)*high, (__m512)w);
#else
  *low = vf_select(enters, vf_max(*low, w), *low);
  *high = vf_select(enters, *high, vf_min(*high, w));
#endif
}

/* What a quantity is where rays enter and leave a tetrahedron. */
CHI_INLINE void evaluate_ends(
  const batch* r, int q, int lane, vf x, vf y, vf entry, vf dz, const int parallel, vf ends[2])
{
  const vf at = x * r->ax[q][lane] + (y * r->ay[q][lane] + r->ac[q][lane]);
  const vf slope =
    parallel ? vf_set(r->bc[q][lane]) : x * r->bx[q][lane] + (y * r->by[q][lane] + r->bc[q][lane]);
  const vf least = vf_set(r->low[q][lane]), most = vf_set(r->high[q][lane]);
  const vf s0 = at + slope * entry, s1 = s0 + slope * dz;
  ends[0] = vf_min(vf_max(s0, least), most);
  ends[1] = vf_min(vf_max(s1, least), most);
}

/* Lanes whose pixels are not marked. */
static __attribute__((noinline)) void find_unmarked(
  const uint8_t* marked, const int32_t pixel[CHI_LANES], int32_t out[CHI_LANES])
{
  for (int i = 0; i < CHI_LANES; ++i)
  {
    out[i] = -!marked[pixel[i] & (CHI_TET_TILE_PIXELS - 1)];
  }
}

/* Fragments of one tetrahedron at pixels of the tile, x and y from the first of its box; those of
 * lanes that are not set in `wanted` are none, nor those at marked pixels. */
CHI_INLINE void evaluate(tile_state* t, int lane, vf x, vf y, vi pixel, vi wanted,
  const int parallel, const int separate, const int direct, const int cuts, const int picking,
  const int lit, const int named, const uint8_t* marked)
{
  if (marked)
  {
    int32_t at[CHI_LANES], unmarked[CHI_LANES];
    vi_store(at, pixel);
    find_unmarked(marked, at, unmarked);
    wanted &= vi_load(unmarked);
  }
  const batch* const r = &t->r;
  fragments* const f = &t->f;
  const int32_t front = r->front[lane];
  const vf z0 = vf_set(r->z0[lane]);
  vf low = vf_set(-3e38f), high = vf_set(3e38f);
  for (int k = 0; k < 4; ++k)
  {
    const vf w = x * r->a[k][lane] + (y * r->b[k][lane] + r->c[k][lane]);
    narrow(mask_of_face(front, k), w, &low, &high);
  }
  vf from = vf_set(-3e38f), to = vf_set(3e38f);
  /* where the first vertex lies behind the eye, the cell is delicate: cuts are counted from some
   * depth in front of it */
  const float near = (float)t->scene->near_depth;
  const float ahead = r->z0[lane] < 0 ? -r->z0[lane] : r->z0[lane];
  const vf zc = vf_set(parallel ? r->z0[lane] : ahead > near ? ahead : near);
  if (cuts)
  {
    cut(t, pixel, zc, parallel, &from, &to);
    low = vf_max(low, from);
    high = vf_min(high, to);
  }
  /* z - z0 = z0 w / (1 - w); what lies between is z0 dw / ((1 - low)(1 - high)) */
  const vf dw = high - low;
  vf entry = low, dz = dw;
  vi inside = wanted & (dw > 0.0f);
  if (!parallel)
  {
    const vf a0 = 1.0f - low, a1 = 1.0f - high;
    const vf zr = z0 * reciprocal(a0 * a1);
    dz = zr * dw;
    entry = zr * a1 * low;
  }
  if (front & DELICATE_FLAG)
  {
    int32_t at[CHI_LANES];
    float exact[3][CHI_LANES];
    vi_store(at, pixel);
    cross_delicate(t, r->z0[lane], at, exact);
    entry = vf_load(exact[0]);
    dz = vf_load(exact[2]);
    if (cuts)
    {
      const vf end = vf_load(exact[1]);
      /* w of 1 lies at infinity; beyond there is no cut, or nothing is left */
      const vf never = vf_set(3e38f);
      const vf lower = parallel ? from : vf_select(from < 1.0f, zc / (1.0f - from) - z0, never);
      const vf upper = parallel ? to : vf_select(to < 1.0f, zc / (1.0f - to) - z0, never);
      const vi later = lower > entry, sooner = upper < end;
      const vf start = vf_select(later, lower, entry), stop = vf_select(sooner, upper, end);
      dz = vf_select((later | sooner) & (dz > 0.0f), stop - start, dz);
      entry = start;
    }
    inside = wanted & (dz > 0.0f);
  }
  const lane_mask mask = mask_of(t->lanes, inside);
  const size_t n = f->count;
  compress(f->length + n, mask, dz);
  compress((float*)f->pixel + n, mask, (vf)pixel);
  for (int q = 0; q <= separate; ++q)
  {
    vf ends[2];
    evaluate_ends(r, q, lane, x, y, entry, dz, parallel, ends);
    compress((q ? f->y0 : f->x0) + n, mask, ends[0]);
    compress((q ? f->y1 : f->x1) + n, mask, ends[1]);
  }
  for (int k = 0; k < 3 && direct; ++k)
  {
    vf ends[2];
    evaluate_ends(r, CHI_TET_COLORS + k, lane, x, y, entry, dz, parallel, ends);
    compress(t->colors[0][k] + n, mask, ends[0]);
    compress(t->colors[1][k] + n, mask, ends[1]);
  }
  if (picking || lit)
  {
    compress(f->depth + n, mask, z0 + entry + dz * (lit ? 0.5f : 0.0f));
  }
  if (named)
  {
    for (int i = 0; i < CHI_LANES; ++i)
    {
      f->id[n + (size_t)i] = r->id[lane];
    }
  }
  f->count += lanes_of(mask);
}
