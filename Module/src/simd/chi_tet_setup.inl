/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Tetrahedra of a tile, a vector of them at a time: planes in double, what the pixels evaluate in
 * float, relative to the tetrahedron's own first vertex and first pixel.
 *
 * Along the ray of a pixel, d = (x, y, 1) in perspective, p = z d. With z0 the depth of the first
 * vertex, w = 1 - z0 / z grows with z and is, on a plane, linear on the screen (perspective-correct
 * interpolation). In parallel projection w = z - z0 serves the same. The ray enters through the
 * plane of the largest w of all faces that look at the eye and leaves through that of the smallest
 * of the others: no table of cases.
 */

#include "chi_tet_kernels.h"
#include "chi_vec.h"

enum
{
  HALF_LANES = CHI_LANES / 2
};

typedef double vd __attribute__((vector_size(8 * HALF_LANES)));
typedef int64_t vl __attribute__((vector_size(8 * HALF_LANES)));
typedef float vh __attribute__((vector_size(4 * HALF_LANES)));
typedef int32_t vhi __attribute__((vector_size(4 * HALF_LANES)));

/* Pixels: the bounding boxes are made in float and may be off by so much; twice its error, 4e-4 for
 * coordinates up to WILD. */
#define MARGIN 1e-3f
#define WILD 4096.0f
/*
 * The pixels' floats are off by up to 1.5 roundings of |a| width + |b| height + |c|, which is a
 * depth. Where that could be more than 1e-5 of the longest edge, the tetrahedron is delicate: its
 * pixels are evaluated in double, plane by plane.
 */
#define DELICATE (1e-5f / (1.5f * 5.9604645e-8f))

/*
 * A determinant is off by up to 9 roundings of the product of its edges' sizes, sums of the
 * components. Below ten times that, faces may have no direction (three vertices in a line, or at
 * one place), and a ray may not leave: it is flat. A needle whose width is 1e-6 of its length has
 * 1e-13.
 */
#define VOLUME 1e-14

typedef struct batch
{
  float a[4][CHI_LANES], b[4][CHI_LANES], c[4][CHI_LANES]; /* w of a face = a dx + b dy + c */
  float ax[CHI_TET_QUANTITIES][CHI_LANES], ay[CHI_TET_QUANTITIES][CHI_LANES],
    ac[CHI_TET_QUANTITIES][CHI_LANES]; /* scalar where z = z0; the opacity's; direct colours */
  float bx[CHI_TET_QUANTITIES][CHI_LANES], by[CHI_TET_QUANTITIES][CHI_LANES],
    bc[CHI_TET_QUANTITIES][CHI_LANES]; /* its slope along z */
  float low[CHI_TET_QUANTITIES][CHI_LANES],
    high[CHI_TET_QUANTITIES][CHI_LANES]; /* its range in the tetrahedron */
  float z0[CHI_LANES];
  float edge_x[6][CHI_LANES], edge_slope[6][CHI_LANES]; /* where a projected edge crosses row y */
  float edge_low[6][CHI_LANES], edge_high[6][CHI_LANES];
  int32_t x0[CHI_LANES], y0[CHI_LANES], x1[CHI_LANES], y1[CHI_LANES]; /* pixels of the tile */
  int32_t front[CHI_LANES]; /* bit i: the face opposite vertex i looks at the eye; DELICATE_FLAG */
  int32_t state[CHI_LANES]; /* 0, FLAT or DELICATE_CELL */
  uint32_t id[CHI_LANES];
} batch;

enum
{
  FLAT = 1,
  DELICATE_CELL = 2,
  DELICATE_FLAG = 16, /* beside the four faces */
  SPREAD = 4          /* spans are not to be trusted: all of the bounding box */
};

CHI_INLINE vd vd_set(double x)
{
  return (vd){ 0 } + x;
}

CHI_INLINE vd vd_select(vl mask, vd a, vd b)
{
  return (vd)((mask & (vl)a) | (~mask & (vl)b));
}

/* To 2e-15 of it: two steps of Newton's method from 14 bits; what it goes into becomes float. */
CHI_INLINE vd vd_reciprocal(vd a)
{
#if defined(CHI_VEC_AVX512)
  vd x = (vd)_mm512_rcp14_pd((__m512d)a);
  x = x + x * (1 - a * x);
  return x + x * (1 - a * x);
#else
  return 1 / a;
#endif
}

CHI_INLINE vd vd_abs(vd a)
{
  return (vd)((vl)a & INT64_MAX);
}

CHI_INLINE vd vd_min(vd a, vd b)
{
  return vd_select(a < b, a, b);
}

CHI_INLINE vd vd_max(vd a, vd b)
{
  return vd_select(a > b, a, b);
}

CHI_INLINE vh vd_float(vd a)
{
  return __builtin_convertvector(a, vh);
}

CHI_INLINE vd vh_double(vh a)
{
  return __builtin_convertvector(a, vd);
}

CHI_INLINE void vh_store(float* p, vh a)
{
  memcpy(p, &a, sizeof a);
}

CHI_INLINE vh vh_set(float x)
{
  return (vh){ 0 } + x;
}

CHI_INLINE vh vh_select(vhi mask, vh a, vh b)
{
  return (vh)((mask & (vhi)a) | (~mask & (vhi)b));
}

CHI_INLINE vh vh_min(vh a, vh b)
{
  return vh_select(a < b, a, b);
}

CHI_INLINE vh vh_max(vh a, vh b)
{
  return vh_select(a > b, a, b);
}

CHI_INLINE vh vh_abs(vh a)
{
  return (vh)((vhi)a & INT32_MAX);
}

/* Smallest integers not below, and largest not above, numbers of at most WILD. */
CHI_INLINE vhi vh_ceil(vh a)
{
  const vhi i = __builtin_convertvector(a, vhi);
  return i - (__builtin_convertvector(i, vh) < a);
}

CHI_INLINE vhi vh_floor(vh a)
{
  const vhi i = __builtin_convertvector(a, vhi);
  return i + (__builtin_convertvector(i, vh) > a);
}

/* Points id[0] ... of HALF_LANES tetrahedra, transposed: out[0 ... 2] the coordinates, out[3] the
 * bits of the two scalars. */
CHI_INLINE void load_points(
  const chi_tet_point* points, const uint32_t* const* at, int corner, vd out[4])
{
#if defined(CHI_VEC_AVX512)
#  define CHI_ROW(i) _mm256_load_pd((const double*)(points + at[i][corner]))
  const __m512d a = _mm512_insertf64x4(_mm512_castpd256_pd512(CHI_ROW(0)), CHI_ROW(4), 1);
  const __m512d b = _mm512_insertf64x4(_mm512_castpd256_pd512(CHI_ROW(1)), CHI_ROW(5), 1);
  const __m512d c = _mm512_insertf64x4(_mm512_castpd256_pd512(CHI_ROW(2)), CHI_ROW(6), 1);
  const __m512d d = _mm512_insertf64x4(_mm512_castpd256_pd512(CHI_ROW(3)), CHI_ROW(7), 1);
  const __m512d ab0 = _mm512_unpacklo_pd(a, b), ab1 = _mm512_unpackhi_pd(a, b);
  const __m512d cd0 = _mm512_unpacklo_pd(c, d), cd1 = _mm512_unpackhi_pd(c, d);
  /* lanes of 128 bits: a0 of ab0 is (x of 0, x of 1), a1 (z of 0, z of 1), a2, a3 those of 4, 5 */
  const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  out[0] = (vd)_mm512_permutex2var_pd(ab0, first, cd0);
  out[1] = (vd)_mm512_permutex2var_pd(ab1, first, cd1);
  out[2] = (vd)_mm512_permutex2var_pd(ab0, second, cd0);
  out[3] = (vd)_mm512_permutex2var_pd(ab1, second, cd1);
#  undef CHI_ROW
#elif defined(CHI_VEC_AVX2)
#  define CHI_ROW(i) _mm256_load_pd((const double*)(points + at[i][corner]))
  const __m256d a = CHI_ROW(0), b = CHI_ROW(1), c = CHI_ROW(2), d = CHI_ROW(3);
  const __m256d ab0 = _mm256_unpacklo_pd(a, b), ab1 = _mm256_unpackhi_pd(a, b);
  const __m256d cd0 = _mm256_unpacklo_pd(c, d), cd1 = _mm256_unpackhi_pd(c, d);
  out[0] = (vd)_mm256_permute2f128_pd(ab0, cd0, 0x20);
  out[1] = (vd)_mm256_permute2f128_pd(ab1, cd1, 0x20);
  out[2] = (vd)_mm256_permute2f128_pd(ab0, cd0, 0x31);
  out[3] = (vd)_mm256_permute2f128_pd(ab1, cd1, 0x31);
#  undef CHI_ROW
#else
  double column[4][HALF_LANES];
  for (int i = 0; i < HALF_LANES; ++i)
  {
    const double* const p = (const double*)(points + at[i][corner]);
    for (int k = 0; k < 4; ++k)
    {
      column[k][i] = p[k];
    }
  }
  memcpy(out, column, sizeof column);
#endif
}

/* The lower and the upper float of each double's bits. */
CHI_INLINE vh low_float(vd bits)
{
  return (vh) __builtin_convertvector((vl)bits, vhi);
}

CHI_INLINE vh high_float(vd bits)
{
  return (vh) __builtin_convertvector((vl)bits >> 32, vhi);
}

static void add_to_box(
  double x, double y, const double first[2], const double step[2], double box[2][2])
{
  const double at[2] = { (x - first[0]) / step[0], (y - first[1]) / step[1] };
  for (int k = 0; k < 2; ++k)
  {
    box[0][k] = at[k] < box[0][k] ? at[k] : box[0][k];
    box[1][k] = at[k] > box[1][k] ? at[k] : box[1][k];
  }
}

/* The pixels around what of a tetrahedron lies behind the near plane; 0 where nothing does. */
static __attribute__((noinline)) int find_box(const chi_tet_point* points, const uint32_t v[4],
  double near_depth, int parallel, const double first[2], const double step[2], double box[2][2])
{
  box[0][0] = box[0][1] = INFINITY;
  box[1][0] = box[1][1] = -INFINITY;
  for (int i = 0; i < 4; ++i)
  {
    const chi_tet_point* const a = points + v[i];
    const int behind = a->z >= near_depth;
    if (behind)
    {
      const double w = parallel ? 1 : 1 / a->z;
      add_to_box(a->x * w, a->y * w, first, step, box);
    }
    for (int j = 0; j < i; ++j) /* edges through the near plane */
    {
      const chi_tet_point* const b = points + v[j];
      if (behind != (b->z >= near_depth))
      {
        const double t = (near_depth - a->z) / (b->z - a->z), w = parallel ? 1 : 1 / near_depth;
        add_to_box(
          (a->x + t * (b->x - a->x)) * w, (a->y + t * (b->y - a->y)) * w, first, step, box);
      }
    }
  }
  return box[0][0] <= box[1][0];
}

/* Where rows meet the six projected edges, for boxes too wide to try every pixel of. */
CHI_INLINE void set_edges(batch* r, int o, const vh sx[4], const vh sy[4])
{
  static const int from[6] = { 0, 0, 0, 1, 1, 2 }, to[6] = { 1, 2, 3, 2, 3, 3 };
  for (int e = 0; e < 6; ++e)
  {
    const vh ax = sx[from[e]], ay = sy[from[e]], bx = sx[to[e]], by = sy[to[e]];
    const vh dy = by - ay;
    /* a level edge meets the rows that it may touch where its ends are: those of the others */
    const vhi steep = vh_abs(dy) > 1e-4f;
    const vh slope = vh_select(steep, (bx - ax) / vh_select(steep, dy, vh_set(1)), vh_set(0));
    vh_store(r->edge_slope[e] + o, slope);
    vh_store(r->edge_x[e] + o, ax - ay * slope);
    vh_store(r->edge_low[e] + o, vh_min(ay, by) - MARGIN);
    vh_store(r->edge_high[e] + o, vh_max(ay, by) + MARGIN);
  }
}

/* A quantity that is linear in the tetrahedron, from its values at the vertices. */
CHI_INLINE void set_quantity(batch* r, int q, int o, const vh s[4], const vd n[4][3], vd inverse,
  int parallel, const vd at[3], const vd base[2], const vd step[2], vd zs)
{
  const vd s0 = vh_double(s[0]);
  const vd d1 = (vh_double(s[1]) - s0) * inverse, d2 = (vh_double(s[2]) - s0) * inverse,
           d3 = (vh_double(s[3]) - s0) * inverse;
  vd g[3];
  for (int k = 0; k < 3; ++k)
  {
    g[k] = d1 * n[1][k] + d2 * n[2][k] + d3 * n[3][k];
  }
  const vd zero = vd_set(0);
  vh_store(r->bx[q] + o, vd_float(parallel ? zero : g[0] * step[0]));
  vh_store(r->by[q] + o, vd_float(parallel ? zero : g[1] * step[1]));
  vh_store(r->bc[q] + o, vd_float(parallel ? g[2] : g[0] * base[0] + g[1] * base[1] + g[2]));
  vh_store(r->ax[q] + o, vd_float(g[0] * step[0] * zs));
  vh_store(r->ay[q] + o, vd_float(g[1] * step[1] * zs));
  vh_store(r->ac[q] + o, vd_float(s0 - (g[0] * at[0] + g[1] * at[1] + g[2] * at[2])));
  vh_store(r->low[q] + o, vh_min(vh_min(s[0], s[1]), vh_min(s[2], s[3])));
  vh_store(r->high[q] + o, vh_max(vh_max(s[0], s[1]), vh_max(s[2], s[3])));
}

/* A direct colour at the four points of tetrahedra. */
CHI_INLINE void load_colors(
  const chi_tet_scene* scene, const uint32_t* id, const uint32_t* const* at, int k, vh s[4])
{
  for (int c = 0; c < 4; ++c)
  {
    float lanes[HALF_LANES];
    for (int i = 0; i < HALF_LANES; ++i)
    {
      const uint32_t cell = scene->cells ? scene->cells[id[i]] : id[i];
      lanes[i] = scene->colors[scene->cell_scalars ? cell : at[i][c]][k];
    }
    memcpy(s + c, lanes, sizeof lanes);
  }
}

CHI_INLINE vd size_of(const vd e[3])
{
  return vd_abs(e[0]) + vd_abs(e[1]) + vd_abs(e[2]);
}

/* Lanes o ... o + HALF_LANES - 1 of a batch. */
CHI_INLINE void set_up(batch* r, int o, const chi_tet_scene* scene, int32_t tile_x, int32_t tile_y,
  const int parallel, const int separate, const int direct)
{
  vd x[4], y[4], z[4], bits[4];
  const uint32_t* at[HALF_LANES];
  for (int i = 0; i < HALF_LANES; ++i)
  {
    at[i] = scene->vertices + 4 * (size_t)r->id[o + i];
  }
  for (int c = 0; c < 4; ++c)
  {
    vd out[4];
    load_points(scene->points, at, c, out);
    x[c] = out[0];
    y[c] = out[1];
    z[c] = out[2];
    bits[c] = out[3];
  }

  /* the bounding box, pixels of the tile */
  const double left = scene->first[0] + scene->step[0] * tile_x;
  const double bottom = scene->first[1] + scene->step[1] * tile_y;
  const float to_pixel[2] = { (float)(1 / scene->step[0]), (float)(1 / scene->step[1]) };
  const float shift[2] = { (float)(-left / scene->step[0]), (float)(-bottom / scene->step[1]) };
  vh sx[4], sy[4];
  for (int c = 0; c < 4; ++c)
  {
    const vh q = parallel ? vh_set(1) : 1.0f / vd_float(z[c]);
    sx[c] = vd_float(x[c]) * q * to_pixel[0] + shift[0];
    sy[c] = vd_float(y[c]) * q * to_pixel[1] + shift[1];
  }
  vh x0 = vh_min(vh_min(sx[0], sx[1]), vh_min(sx[2], sx[3])) - MARGIN;
  vh y0 = vh_min(vh_min(sy[0], sy[1]), vh_min(sy[2], sy[3])) - MARGIN;
  vh x1 = vh_max(vh_max(sx[0], sx[1]), vh_max(sx[2], sx[3])) + MARGIN;
  vh y1 = vh_max(vh_max(sy[0], sy[1]), vh_max(sy[2], sy[3])) + MARGIN;
  const vd nearest = vd_min(vd_min(z[0], z[1]), vd_min(z[2], z[3]));
  vhi wild = ~((x0 > -WILD) & (x1 < WILD) & (y0 > -WILD) & (y1 < WILD));
  wild |= __builtin_convertvector(nearest < scene->near_depth, vhi);
  const vh last = vh_set(CHI_TET_TILE - 1), zero = vh_set(0);
  x0 = vh_select(wild, zero, vh_max(x0, zero));
  y0 = vh_select(wild, zero, vh_max(y0, zero));
  x1 = vh_select(wild, last, vh_min(x1, last));
  y1 = vh_select(wild, last, vh_min(y1, last));
  for (int i = 0; i < HALF_LANES; ++i)
  {
    double box[2][2];
    if (wild[i])
    {
      const double first[2] = { left, bottom };
      if (!find_box(scene->points, at[i], scene->near_depth, parallel, first, scene->step, box))
      {
        box[0][0] = CHI_TET_TILE;
      }
      const double margin = 1e-6; /* of a pixel, and more than the roundings of its place */
      x0[i] = box[0][0] - margin > 0 ? (float)fmin(box[0][0] - margin, CHI_TET_TILE) : 0;
      y0[i] = box[0][1] - margin > 0 ? (float)fmin(box[0][1] - margin, CHI_TET_TILE) : 0;
      x1[i] = box[1][0] + margin < CHI_TET_TILE - 1 ? (float)fmax(box[1][0] + margin, -1)
                                                    : CHI_TET_TILE - 1;
      y1[i] = box[1][1] + margin < CHI_TET_TILE - 1 ? (float)fmax(box[1][1] + margin, -1)
                                                    : CHI_TET_TILE - 1;
    }
  }
  /* beyond the tile on the far side: an empty box all the same */
  const vhi first_x = vh_ceil(vh_min(x0, vh_set(CHI_TET_TILE)));
  const vhi first_y = vh_ceil(vh_min(y0, vh_set(CHI_TET_TILE)));
  const vhi last_x = vh_floor(vh_max(x1, vh_set(-1))), last_y = vh_floor(vh_max(y1, vh_set(-1)));
  memcpy(r->x0 + o, &first_x, sizeof first_x);
  memcpy(r->y0 + o, &first_y, sizeof first_y);
  memcpy(r->x1 + o, &last_x, sizeof last_x);
  memcpy(r->y1 + o, &last_y, sizeof last_y);
  const vhi columns = last_x - first_x + 1, rows = last_y - first_y + 1;
  int large = 0;
  for (int i = 0; i < HALF_LANES; ++i)
  {
    large |= columns[i] > CHI_LANES;
  }
  if (large)
  {
    set_edges(r, o, sx, sy);
  }

  /* inward normals of the faces opposite each vertex, times twice their areas */
  const vd e1[3] = { x[1] - x[0], y[1] - y[0], z[1] - z[0] };
  const vd e2[3] = { x[2] - x[0], y[2] - y[0], z[2] - z[0] };
  const vd e3[3] = { x[3] - x[0], y[3] - y[0], z[3] - z[0] };
  vd n[4][3];
  for (int k = 0; k < 3; ++k)
  {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    n[1][k] = e2[i] * e3[j] - e2[j] * e3[i];
    n[2][k] = e3[i] * e1[j] - e3[j] * e1[i];
    n[3][k] = e1[i] * e2[j] - e1[j] * e2[i];
    n[0][k] = -(n[1][k] + n[2][k] + n[3][k]);
  }
  const vd det = e1[0] * n[1][0] + e1[1] * n[1][1] + e1[2] * n[1][2];
  const vd sizes = size_of(e1) * size_of(e2) * size_of(e3);
  const vl mirrored = det < 0, flat = ~(vd_abs(det) > VOLUME * sizes);
  const vd inverse = vd_reciprocal(vd_select(flat, vd_set(1), det));
  const vd z0 = z[0];

  /* the first pixel's ray, and from where it is at depth z0 to the first vertex */
  const vd base[2] = { left + scene->step[0] * __builtin_convertvector(first_x, vd),
    bottom + scene->step[1] * __builtin_convertvector(first_y, vd) };
  const vd step[2] = { vd_set(scene->step[0]), vd_set(scene->step[1]) };
  const vd zs = parallel ? vd_set(1) : z0;
  const vd to[3] = { x[0] - zs * base[0], y[0] - zs * base[1], vd_set(0) };
  const vh width = __builtin_convertvector(columns, vh), height = __builtin_convertvector(rows, vh);
  vh rough = vh_set(0);
  vhi front = { 0 };
  for (int i = 0; i < 4; ++i)
  {
    const vd* const m = n[i]; /* inwards if det > 0; what is made of it does not depend on that */
    const vd offset = i == 0 ? det : vd_set(0); /* face 0 passes through vertex 1 */
    vd q = parallel ? m[2] : m[0] * x[0] + m[1] * y[0] + m[2] * z[0] - offset;
    /* 1e-12: such a face is delicate in any case; only infinities are to be kept out */
    const vd least = (vd_abs(m[0]) + vd_abs(m[1]) + vd_abs(m[2])) * zs * 1e-12 + 1e-300;
    q = vd_select(vd_abs(q) > least, q, vd_select(q < 0, -least, least));
    front |= __builtin_convertvector((q > 0) ^ mirrored, vhi) & (1 << i);
    const vd scale = vd_reciprocal(q);
    const vh a = vd_float(-m[0] * step[0] * zs * scale), b = vd_float(-m[1] * step[1] * zs * scale);
    const vh c = vd_float((m[0] * to[0] + m[1] * to[1] - offset) * scale);
    vh_store(r->a[i] + o, a);
    vh_store(r->b[i] + o, b);
    vh_store(r->c[i] + o, c);
    rough = vh_max(rough, vh_abs(a) * width + vh_abs(b) * height + vh_abs(c));
  }

  /* the longest edge, by its longest component */
  vh longest = vh_set(0);
  for (int k = 0; k < 3; ++k)
  {
    const vd* const v = k == 0 ? x : k == 1 ? y : z;
    longest = vh_max(longest,
      vd_float(vd_max(vd_max(v[0], v[1]), vd_max(v[2], v[3])) -
        vd_min(vd_min(v[0], v[1]), vd_min(v[2], v[3]))));
  }
  const vhi delicate = wild | ~(rough * vd_float(zs) < longest * DELICATE);
  const vhi state =
    (__builtin_convertvector(flat, vhi) & FLAT) | (delicate & DELICATE_CELL) | (wild & SPREAD);
  memcpy(r->state + o, &state, sizeof state);
  front |= delicate & DELICATE_FLAG;
  memcpy(r->front + o, &front, sizeof front);
  vh_store(r->z0 + o, vd_float(z0));

  vh s[4];
  for (int q = 0; q <= separate; ++q)
  {
    for (int c = 0; c < 4; ++c)
    {
      s[c] = q ? high_float(bits[c]) : low_float(bits[c]);
    }
    const float* const seconds = q ? scene->seconds : NULL;
    const float* const of_cells = q ? scene->cell_opacities : scene->cell_scalars;
    if (seconds || of_cells)
    {
      for (int i = 0; i < HALF_LANES; ++i)
      {
        const uint32_t t = r->id[o + i];
        s[0][i] = seconds ? seconds[t] : of_cells[scene->cells ? scene->cells[t] : t];
      }
      s[1] = s[2] = s[3] = s[0];
    }
    set_quantity(r, q, o, s, (const vd(*)[3])n, inverse, parallel, to, base, step, zs);
  }
  for (int k = 0; k < 3 && direct; ++k)
  {
    load_colors(scene, r->id + o, at, k, s);
    set_quantity(
      r, CHI_TET_COLORS + k, o, s, (const vd(*)[3])n, inverse, parallel, to, base, step, zs);
  }
}
