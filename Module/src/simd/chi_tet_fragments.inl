/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* From tetrahedra to fragments: the pixels that may be covered, and of those that are, the length
 * of the ray inside and the scalars at both its ends. */

enum
{
  CANDIDATES = 256, /* pixels at a time: all buffers together stay in the first cache */
  FRAGMENTS = 640
};

/* A candidate: pixel of the tile, lane of the batch, pixels from the first of its bounding box. */
enum
{
  LANE_SHIFT = 12,
  DX_SHIFT = 16,
  DY_SHIFT = 22
};

typedef struct fragments
{
  size_t count;
  int32_t pixel[FRAGMENTS + CHI_LANES];
  float length[FRAGMENTS + CHI_LANES];                        /* along z; then along the ray */
  float x0[FRAGMENTS + CHI_LANES], x1[FRAGMENTS + CHI_LANES]; /* scalars at entry and exit */
  float y0[FRAGMENTS + CHI_LANES], y1[FRAGMENTS + CHI_LANES]; /* the opacity's */
  float depth[FRAGMENTS + CHI_LANES];                         /* of the entry */
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
  face faces[4];        /* of the delicate tetrahedron whose candidates come last */
  int delicate;         /* its lane; -1: they are another's */
  size_t delicate_from; /* its first candidate */
  float exact_entry[CANDIDATES + CHI_TET_TILE + 2 * CHI_LANES]; /* of delicate candidates */
  float exact_exit[CANDIDATES + CHI_TET_TILE + 2 * CHI_LANES];
  float exact_length[CANDIDATES + CHI_TET_TILE + 2 * CHI_LANES];
  size_t candidate_count;
  int32_t candidate[CANDIDATES + CHI_TET_TILE + 2 * CHI_LANES];
  fragments f;
  float plane[CHI_TET_CUTS][4]; /* cuts of this tile: m = p0 dx + p1 dy + p2 against p3 */
  chi_tet_target* target;
  chi_tet_tally* tally;
} tile_state;

/* table[index], index in 0 ... CHI_LANES - 1 */
CHI_INLINE vf look_up(const float table[CHI_LANES], vi index)
{
#if defined(CHI_VEC_AVX512)
  return (vf)_mm512_permutexvar_ps((__m512i)index, _mm512_loadu_ps(table));
#elif defined(CHI_VEC_AVX2)
  return (vf)_mm256_permutevar8x32_ps(_mm256_loadu_ps(table), (__m256i)index);
#else
  return __builtin_shuffle(vf_load(table), index);
#endif
}

CHI_INLINE vi look_up_bits(const int32_t table[CHI_LANES], vi index)
{
  vf v;
  memcpy(&v, table, sizeof v);
  float copy[CHI_LANES];
  memcpy(copy, &v, sizeof v);
  return (vi)look_up(copy, index);
}

/* Lanes that are set in the mask, one after the other; returns nothing, the caller counts. */
#if defined(CHI_VEC_AVX512)
typedef __mmask16 lane_mask;
CHI_INLINE lane_mask mask_of(vi mask)
{
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
#else
typedef vi lane_mask;
CHI_INLINE lane_mask mask_of(vi mask)
{
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

/* Clip planes and the surface: the rays of these pixels are cut to [low, high]. */
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

/* Candidates `first` ... of one delicate tetrahedron: from z0 to the entry, and the length inside,
 * along z; in double. Lengths are not positive where the ray does not meet it. */
static __attribute__((noinline)) void cross_delicate(tile_state* t, size_t first)
{
  const chi_tet_scene* const s = t->scene;
  const face* const faces = t->faces;
  const vd infinity = vd_set(INFINITY), z0 = vd_set((double)t->r.z0[t->delicate]);
  for (size_t i = first; i < t->candidate_count; i += HALF_LANES)
  {
    vhi p;
    memcpy(&p, t->candidate + i, sizeof p);
    const vd x = t->left + s->step[0] * __builtin_convertvector(p & (CHI_TET_TILE - 1), vd);
    const vd y = t->bottom +
      s->step[1] * __builtin_convertvector((p >> CHI_TET_TILE_SHIFT) & (CHI_TET_TILE - 1), vd);
    vd low = vd_set(s->near_depth), high = infinity;
    for (int k = 0; k < 4; ++k)
    {
      const face* const of = faces + k;
      /* n . (a - p(z)) = along (za - z) + across: zero where the ray meets the plane */
      const double zs = s->parallel ? 1 : of->at[2];
      const vd along = s->parallel ? vd_set(of->n[2]) : of->n[0] * x + of->n[1] * y + of->n[2];
      const vd across = of->n[0] * (of->at[0] - zs * x) + of->n[1] * (of->at[1] - zs * y);
      const vd z = of->at[2] + across / along;
      const vl enters = along * of->sign > 0, leaves = along * of->sign < 0;
      low = vd_select(enters, vd_max(z, low), low);
      high = vd_select(leaves, vd_min(z, high), high);
      /* within the plane: on one side of it, and of the two tetrahedra at it in one alone */
      const vl out =
        ~(enters | leaves) & ((across * of->sign > 0) | ((across == 0) & (vd_set(of->sign) < 0)));
      high = vd_select(out, -infinity, high);
    }
    const vl meets = (low > -infinity) & (high < infinity);
    vh_store(t->exact_entry + i, vd_float(low - z0));
    vh_store(t->exact_exit + i, vd_float(high - z0));
    vh_store(t->exact_length + i, vd_float(vd_select(meets, high - low, vd_set(-1))));
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

/* The ray is inside of the face's half-space where w is larger, if it looks at the eye, or smaller.
 */
CHI_INLINE void narrow(vi front, int bit, vf w, vf* low, vf* high)
{
#if defined(CHI_VEC_AVX512)
  const __mmask16 enters = _mm512_test_epi32_mask((__m512i)front, _mm512_set1_epi32(1 << bit));
  *low = (vf)_mm512_mask_max_ps((__m512)*low, enters, (__m512)*low, (__m512)w);
  *high = (vf)_mm512_mask_min_ps((__m512)*high, _knot_mask16(enters), (__m512)*high, (__m512)w);
#else
  const vi enters = -((front >> bit) & 1);
  *low = vf_select(enters, vf_max(*low, w), *low);
  *high = vf_select(enters, *high, vf_min(*high, w));
#endif
}

/* Fragments of all candidates. */
CHI_INLINE void evaluate(
  tile_state* t, const int parallel, const int separate, const int cuts, const int picking)
{
  const batch* const r = &t->r;
  fragments* const f = &t->f;
  for (size_t i = 0; i < t->candidate_count; i += CHI_LANES)
  {
    const vi p = vi_load(t->candidate + i);
    const vi lane = (p >> LANE_SHIFT) & (CHI_LANES - 1);
    const vf x = vi_float((p >> DX_SHIFT) & (CHI_TET_TILE - 1)), y = vi_float(p >> DY_SHIFT);
    const vi front = look_up_bits(r->front, lane);
    const vf z0 = look_up(r->z0, lane);
    vf low = vf_set(-3e38f), high = vf_set(3e38f);
    for (int k = 0; k < 4; ++k)
    {
      const vf w =
        x * look_up(r->a[k], lane) + (y * look_up(r->b[k], lane) + look_up(r->c[k], lane));
      narrow(front, k, w, &low, &high);
    }
    vf from = vf_set(-3e38f), to = vf_set(3e38f);
    if (cuts)
    {
      cut(t, p & (CHI_TET_TILE_PIXELS - 1), z0, parallel, &from, &to);
      low = vf_max(low, from);
      high = vf_min(high, to);
    }
    /* z - z0 = z0 w / (1 - w); what lies between is z0 dw / ((1 - low)(1 - high)) */
    const vf dw = high - low;
    vf entry = low, dz = dw;
    vi inside = dw > 0.0f;
    if (!parallel)
    {
      const vf a0 = 1.0f - low, a1 = 1.0f - high;
      const vf zr = z0 * reciprocal(a0 * a1);
      dz = zr * dw;
      entry = zr * a1 * low;
    }
    const vi delicate = (front & DELICATE_FLAG) != 0;
    if (vi_any(delicate))
    {
      vf begin = vf_load(t->exact_entry + i), length = vf_load(t->exact_length + i);
      if (cuts)
      {
        const vf end = vf_load(t->exact_exit + i);
        const vf lower = parallel ? from : z0 / (1.0f - from) - z0;
        const vf upper = parallel ? to : z0 / (1.0f - to) - z0;
        const vi later = lower > begin, sooner = upper < end;
        const vf start = vf_select(later, lower, begin), stop = vf_select(sooner, upper, end);
        length = vf_select((later | sooner) & (length > 0.0f), stop - start, length);
        begin = start;
      }
      entry = vf_select(delicate, begin, entry);
      dz = vf_select(delicate, length, dz);
      inside = (delicate & (length > 0.0f)) | (~delicate & inside);
    }
    const size_t left = t->candidate_count - i;
    if (left < CHI_LANES)
    {
      inside &= vf_iota() < (float)left;
    }
    const lane_mask mask = mask_of(inside);
    const size_t n = f->count;
    compress(f->length + n, mask, dz);
    compress((float*)f->pixel + n, mask, (vf)(p & (CHI_TET_TILE_PIXELS - 1)));
    for (int q = 0; q <= separate; ++q)
    {
      const vf at =
        x * look_up(r->ax[q], lane) + (y * look_up(r->ay[q], lane) + look_up(r->ac[q], lane));
      const vf slope = parallel
        ? look_up(r->bc[q], lane)
        : x * look_up(r->bx[q], lane) + (y * look_up(r->by[q], lane) + look_up(r->bc[q], lane));
      const vf least = look_up(r->low[q], lane), most = look_up(r->high[q], lane);
      const vf s0 = at + slope * entry, s1 = s0 + slope * dz;
      compress((q ? f->y0 : f->x0) + n, mask, vf_min(vf_max(s0, least), most));
      compress((q ? f->y1 : f->x1) + n, mask, vf_min(vf_max(s1, least), most));
    }
    if (picking)
    {
      compress(f->depth + n, mask, z0 + entry);
      float ids[CHI_LANES];
      memcpy(ids, r->id, sizeof ids);
      compress((float*)f->id + n, mask, look_up(ids, lane));
    }
    f->count += lanes_of(mask);
  }
  t->candidate_count = 0;
}
