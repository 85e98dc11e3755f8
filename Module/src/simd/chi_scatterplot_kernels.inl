/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The density that a tetrahedron of mass m projects to is the linear simplex spline of its four
 * corners v_k (Micchelli 1980). With E_k the signed double areas of the triangles opposite to the
 * corners, sum E_k v_k = 0 and sum E_k = 0, its second derivative along x is a uniform measure on
 * the six edges: edge kl carries
 *
 *   -6 m / (E_i E_j) |y_k - y_l|  per unit of y,  {i, j} the other two corners.                (1)
 *
 * The average of a density over bins is its convolution with a box; two box
 * widths along x turn a point of that measure at i + f into the weights of a quadratic B-spline,
 *
 *   ((1 - f)^2 / 2, 1/2 + f - f^2, f^2 / 2) in bins i, i + 1, i + 2,                           (2)
 *
 * of the row's second differences. So an edge is deposited row by row, and two running sums along
 * each row give the exact mass of every bin. Edges that cells share carry the sum of their weights.
 */

#include "chi_scatterplot_kernels.h"

#include "chi_vec8.h"

#include <math.h>

#include "chi_scatterplot_sections.inl"

/* ---- values */

static void map(const chi_scatter_plot* plot, int axis, double* values, size_t count)
{
  const v8 low = v8_set(plot->low[axis]), scale = v8_set(plot->scale[axis]);
  const v8 snap = v8_set(plot->snap), far = v8_set(CHI_SCATTER_FAR);
  for (size_t i = 0; i < count; i += 8)
  {
    const v8 x = v8_max(v8_min((v8_load(values + i) - low) * scale, far), -far);
    v8_store(values + i, (x + snap) - snap);
  }
}

static int extremes(const double* values, size_t count, double* low, double* high)
{
  v8 l = v8_set(INFINITY), h = v8_set(-INFINITY), zero = v8_set(0);
  for (size_t i = 0; i < count; i += 8)
  {
    v8 v = v8_load(values + i);
    if (count - i < 8)
    {
      v = v8_select(m8_first((int)(count - i)), v, v8_set(values[i]));
    }
    l = v8_min(v, l);
    h = v8_max(v, h);
    zero += v * 0;
  }
  *low = l[0];
  *high = h[0];
  double sum = zero[0];
  for (int k = 1; k < 8; ++k)
  {
    *low = l[k] < *low ? l[k] : *low;
    *high = h[k] > *high ? h[k] : *high;
    sum += zero[k];
  }
  return sum == 0;
}

/* ---- how each of eight tetrahedra is deposited, and the weights of its edges */

typedef struct kinds
{
  unsigned edges, one_bin, sections; /* bits of lanes */
} kinds;

CHI_INLINE8 kinds classify8(const chi_scatter_plot* plot, const v8 x[4], const v8 y[4], v8 mass,
  m8 lanes, double light, v8 weight[6])
{
  const v8 ax = x[1] - x[0], bx = x[2] - x[0], cx = x[3] - x[0];
  const v8 ay = y[1] - y[0], by = y[2] - y[0], cy = y[3] - y[0];
  const v8 e1 = v8_determinant(bx, cy, by, cx), e2 = v8_determinant(cx, ay, cy, ax);
  const v8 e3 = v8_determinant(ax, by, ay, bx);
  const v8 e0 = v8_determinant(y[2] - y[1], x[3] - x[1], x[2] - x[1], y[3] - y[1]);

  const v8 x_low = v8_min(v8_min(x[0], x[1]), v8_min(x[2], x[3]));
  const v8 x_high = v8_max(v8_max(x[0], x[1]), v8_max(x[2], x[3]));
  const v8 y_low = v8_min(v8_min(y[0], y[1]), v8_min(y[2], y[3]));
  const v8 y_high = v8_max(v8_max(y[0], y[1]), v8_max(y[2], y[3]));
  const v8 zero = v8_set(0), one = v8_set(1);
  const m8 inside = (x_low >= zero) & (y_low >= zero) & (x_high <= v8_set(plot->bins[0])) &
    (y_high <= v8_set(plot->bins[1]));
  /* those without area go by sections, where they are counted */
  const m8 in_one_bin = (x_high < v8_floor(x_low) + one) & (y_high < v8_floor(y_low) + one) &
    ((e1 != zero) | (e2 != zero) | (e3 != zero));

  /* The two least areas against the length: what cancels in the sums stays below 1e-16 K m. */
  const v8 a0 = v8_abs(e0), a1 = v8_abs(e1), a2 = v8_abs(e2), a3 = v8_abs(e3);
  const v8 low01 = v8_min(a0, a1), high01 = v8_max(a0, a1);
  const v8 low23 = v8_min(a2, a3), high23 = v8_max(a2, a3);
  const v8 least = v8_min(low01, low23);
  const v8 second = v8_min(v8_max(low01, low23), v8_min(high01, high23));
  const v8 length = v8_max(x_high - x_low, y_high - y_low);
  const m8 is_good =
    (least * second * v8_set(plot->condition) >= length * length * v8_max(length, one)) &
    (least > zero) & (v8_abs(mass) >= v8_set(light));

  kinds k;
  const unsigned valid = m8_bits(lanes & (mass == mass)), in = m8_bits(inside) & valid;
  k.one_bin = plot->no_one_bin ? 0 : m8_bits(in_one_bin) & in;
  k.edges = plot->no_edges ? 0 : m8_bits(is_good) & in & ~k.one_bin;
  k.sections = valid & ~(k.edges | k.one_bin);
  if (k.edges)
  {
    /* (1); lanes that go elsewhere have weight 0 */
    const m8 chosen = inside & is_good & lanes & (mass == mass) &
      (plot->no_one_bin ? (m8)(zero == zero) : ~in_one_bin);
    const v8 m6 = v8_select(chosen, -6 * mass, zero);
    const v8 r0 = one / v8_select(chosen, e0, one), r1 = one / v8_select(chosen, e1, one);
    const v8 r2 = one / v8_select(chosen, e2, one), r3 = one / v8_select(chosen, e3, one);
    const v8 q0 = m6 * r0, q1 = m6 * r1, q2 = m6 * r2;
    weight[0] = q2 * r3;
    weight[1] = q1 * r3;
    weight[2] = q1 * r2;
    weight[3] = q0 * r3;
    weight[4] = q0 * r2;
    weight[5] = q0 * r1;
  }
  return k;
}

static void classify(const chi_scatter_plot* plot, const double* x, const double* y, size_t stride,
  const double* mass, size_t count, double light, double (*out)[CHI_SCATTER_CHUNK], uint8_t* kind)
{
  for (size_t i = 0; i < count; i += 8)
  {
    v8 px[4], py[4], weight[6];
    for (size_t c = 0; c < 4; ++c)
    {
      px[c] = v8_load(x + c * stride + i);
      py[c] = v8_load(y + c * stride + i);
    }
    const int left = count - i < 8 ? (int)(count - i) : 8;
    const kinds k = classify8(plot, px, py, v8_load(mass + i), m8_first(left), light, weight);
    for (int e = 0; e < 6 && k.edges; ++e)
    {
      v8_store(out[e] + i, weight[e]);
    }
    for (int l = 0; l < left; ++l)
    {
      kind[i + (size_t)l] = k.edges >> l & 1 ? CHI_SCATTER_EDGES
        : k.one_bin >> l & 1                 ? CHI_SCATTER_ONE_BIN
        : k.sections >> l & 1                ? CHI_SCATTER_SECTIONS
                                             : CHI_SCATTER_NOTHING;
    }
  }
}

CHI_INLINE8 void list_cells(unsigned bits, size_t first, int kind, uint16_t* list, size_t* count)
{
  for (; bits; bits &= bits - 1)
  {
    list[(*count)++] = (uint16_t)(6 * (first + (size_t)__builtin_ctz(bits)) + (size_t)kind);
  }
}

CHI_INLINE8 void add_weight(double* at, v8 weight)
{
  v8_store(at, v8_load(at) + weight);
}

static void brick(const chi_scatter_plot* plot, chi_scatter_brick* b, double light)
{
  static const size_t step[3] = { 1, CHI_SCATTER_ROW, CHI_SCATTER_LAYER };
  const m8 lanes = m8_first(b->cells[0]);
  v8 edge_mass = v8_set(0);
  b->one_bin_count = b->sections_count = b->edge_cells = 0;
  memset(b->weight[1], 0, sizeof b->weight - sizeof b->weight[0]);
  for (int z = 0; z < b->cells[2]; ++z)
  {
    for (int y = 0; y < b->cells[1]; ++y)
    {
      const size_t first = (size_t)(z * CHI_SCATTER_BRICK + y) * CHI_SCATTER_BRICK;
      const v8 mass = v8_load(b->mass + first);
      for (int kind = 0; kind < 6; ++kind)
      {
        const unsigned char* const s = chi_scatter_steps[kind];
        size_t at[4] = { (size_t)z * step[2] + (size_t)y * step[1], 0, 0, 0 };
        v8 px[4], py[4], weight[6];
        for (int c = 0; c < 4; ++c)
        {
          at[c] = c ? at[c - 1] + step[s[c - 1]] : at[0];
          px[c] = v8_load(b->x + at[c]);
          py[c] = v8_load(b->y + at[c]);
        }
        const kinds k = classify8(plot, px, py, mass, lanes, light, weight);
        if (k.edges)
        {
          const int s0 = 1 << s[0], s1 = 1 << s[1], s2 = 1 << s[2];
          add_weight(b->weight[s0] + at[0], weight[0]);
          add_weight(b->weight[s0 | s1] + at[0], weight[1]);
          add_weight(b->weight[7] + at[0], weight[2]);
          add_weight(b->weight[s1] + at[1], weight[3]);
          add_weight(b->weight[s1 | s2] + at[1], weight[4]);
          add_weight(b->weight[s2] + at[2], weight[5]);
          b->edge_cells += (size_t)__builtin_popcount(k.edges);
          edge_mass += v8_select(m8_of_bits(k.edges), mass, v8_set(0));
        }
        list_cells(k.one_bin, first, kind, b->one_bin, &b->one_bin_count);
        list_cells(k.sections, first, kind, b->sections, &b->sections_count);
      }
    }
  }
  b->edge_mass = 0;
  for (int l = 0; l < 8; ++l)
  {
    b->edge_mass += edge_mass[l];
  }
}

/* ---- edges into second differences */

/* The integral of (2) over all that lies beyond a point at fraction f of its bin: cubic in bins 0,
 * 1 and 2 from there, 0 before, 1 after. Rows: powers of f; `shift` bins further up from entry
 * 8 - shift. */
static const double tail_powers[4][32] = {
  { 0, 0, 0, 0, 0, 0, 0, 0, 1. / 6, 5. / 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 },
  { 0, 0, 0, 0, 0, 0, 0, 0, -0.5, -0.5 },
  { 0, 0, 0, 0, 0, 0, 0, 0, 0.5, -0.5 },
  { 0, 0, 0, 0, 0, 0, 0, 0, -1. / 6, 1. / 3, -1. / 6 },
};

CHI_INLINE8 v8 tail_at(double f, int shift)
{
  const v8 t = v8_set(f);
  const double* const at = tail_powers[0] + 8 - shift;
  return v8_fma(
    v8_fma(v8_fma(v8_load(at + 96), t, v8_load(at + 64)), t, v8_load(at + 32)), t, v8_load(at));
}

/* Mass m spread evenly from fraction a to fraction b of one bin: (2) with the means of f and f^2;
 * one bin further up with `up`. */
CHI_INLINE8 v4 spread(double m, double a, double b, int up)
{
  const double f = (a + b) * 0.5, f2 = (a * a + a * b + b * b) * (1. / 6);
  const v4 by_f = up ? (v4){ 0, -1, 1, 0 } : (v4){ -1, 1, 0, 0 };
  const v4 by_f2 = up ? (v4){ 0, 1, -2, 1 } : (v4){ 1, -2, 1, 0 };
  const v4 whole = up ? (v4){ 0, 0.5, 0.5, 0 } : (v4){ 0.5, 0.5, 0, 0 };
  return (whole + by_f * f + by_f2 * f2) * m;
}

/* The tail of a point: with AVX-512 the vector itself, which the next row uses again. */
#ifdef CHI_VEC8_AVX512
typedef v8 tail;

CHI_INLINE8 tail tail_of(double f)
{
  return tail_at(f, 0);
}

/* Rate times what lies between two points: row[0] is the bin of the left one, that of the right one
 * is `bins` further. */
CHI_INLINE8 void deposit_between(double* row, double rate, tail left, tail right, int bins)
{
  const v8 all = v8_set(rate);
  const __mmask8 from = (__mmask8)(bins < 8 ? 0xff << bins : 0);
  v8_store(row, v8_fma(left - (v8)_mm512_maskz_expand_pd(from, (__m512d)right), all, v8_load(row)));
  int t = 8;
  for (; t + 8 <= bins; t += 8)
  {
    v8_store(row + t, v8_load(row + t) + all);
  }
  for (; t < bins + 3; t += 8)
  {
    const __m512i lane =
      _mm512_sub_epi64(_mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7), _mm512_set1_epi64(bins - t));
    const __mmask8 beyond = _mm512_cmpge_epi64_mask(lane, _mm512_setzero_si512());
    const v8 taken = (v8)_mm512_maskz_permutexvar_pd(
      beyond, _mm512_min_epi64(lane, _mm512_set1_epi64(7)), (__m512d)right);
    v8_store(row + t, v8_fma(v8_set(1) - taken, all, v8_load(row + t)));
  }
}
#else
typedef double tail;

CHI_INLINE8 tail tail_of(double f)
{
  return f;
}

CHI_INLINE8 void deposit_between(double* row, double rate, tail left, tail right, int bins)
{
  const v8 all = v8_set(rate);
  v8_store(row, v8_fma(tail_at(left, 0) - tail_at(right, bins > 8 ? 8 : bins), all, v8_load(row)));
  int t = 8;
  for (; t + 8 <= bins; t += 8)
  {
    v8_store(row + t, v8_load(row + t) + all);
  }
  for (; t < bins + 3; t += 8)
  {
    v8_store(row + t, v8_fma(v8_set(1) - tail_at(right, bins - t), all, v8_load(row + t)));
  }
}
#endif

/* Below this length along x, in bins, differences of tails cancel, and moments are used. */
#define LEAST_WIDTH (1. / 32)

/* A point of an edge where it enters or leaves a row. */
typedef struct crossing
{
  double x;
  int bin;
  tail beyond;
} crossing;

CHI_INLINE8 crossing cross_at(double x)
{
  const int bin = (int)x;
  return (crossing){ x, bin, tail_of(x - bin) };
}

/* Mass m spread evenly between two points of a row of second differences. */
CHI_INLINE8 void deposit(double* row, double m, crossing left, crossing right)
{
  const double width = right.x - left.x;
  const int bins = right.bin - left.bin;
  double* const at = row + left.bin;
  if (width >= LEAST_WIDTH)
  {
    deposit_between(at, m / width, left.beyond, right.beyond, bins);
  }
  else if (bins == 0)
  {
    v4_store(at, v4_load(at) + spread(m, left.x - left.bin, right.x - left.bin, 0));
  }
  else
  {
    const double line = right.bin, before = m * ((line - left.x) / width);
    const v4 lower = spread(before, left.x - left.bin, 1, 0);
    const v4 upper = spread(m - before, 0, right.x - line, 1);
    v4_store(at, v4_load(at) + (lower + upper));
  }
}

/* An edge upwards. */
typedef struct segment
{
  double x0, y0, x1, y1, weight;
} segment;

/* Rows of the tile that an edge crosses; x does not fall, or does not rise, along it. */
CHI_INLINE8 void deposit_rows(const chi_scatter_tile* tile, const segment* s, int rises)
{
  const int first = tile->first, end = tile->first + tile->count;
  const double dy = s->y1 - s->y0, rate = s->weight * dy, slope = (s->x1 - s->x0) / dy;
  int j = (int)s->y0, last = (int)s->y1;
  last -= last > j && s->y1 == last;
  if (j >= end || last < first)
  {
    return;
  }
  double ya = s->y0, xa = s->x0;
  if (j < first)
  {
    j = first;
    ya = first;
    xa = s->x0 + slope * (ya - s->y0);
    xa = rises ? (xa > s->x1 ? s->x1 : xa) : (xa < s->x1 ? s->x1 : xa);
  }
  crossing a = cross_at(xa);
  double* row = tile->at + (size_t)(j - first) * tile->stride - tile->left;
  for (; j <= last && j < end; ++j, row += tile->stride)
  {
    double yb = s->y1, xb = s->x1;
    if (j < last)
    {
      yb = j + 1;
      xb = s->x0 + slope * (yb - s->y0);
      xb = rises ? (xb > s->x1 ? s->x1 : xb) : (xb < s->x1 ? s->x1 : xb);
    }
    const crossing b = cross_at(xb);
    deposit(row, rate * (yb - ya), rises ? a : b, rises ? b : a);
    a = b;
    ya = yb;
  }
}

static void edges(const chi_scatter_tile* tile, const double* x, const double* y,
  const chi_scatter_edge* list, size_t count)
{
  for (size_t e = 0; e < count; ++e)
  {
    size_t p = list[e].from, q = list[e].to;
    if (y[q] < y[p])
    {
      p = list[e].to;
      q = list[e].from;
    }
    const segment s = { x[p], y[p], x[q], y[q], list[e].weight };
    if (!(s.y1 > s.y0))
    {
      continue;
    }
    if (s.x0 < s.x1)
    {
      deposit_rows(tile, &s, 1);
    }
    else
    {
      deposit_rows(tile, &s, 0);
    }
  }
}

/* ---- second differences into bins */

#ifdef CHI_VEC8_AVX512
CHI_INLINE8 v8 running_sums(v8 a)
{
  const v8 z = v8_set(0);
  a += __builtin_shufflevector(z, a, 7, 8, 9, 10, 11, 12, 13, 14);
  a += __builtin_shufflevector(z, a, 6, 7, 8, 9, 10, 11, 12, 13);
  return a + __builtin_shufflevector(z, a, 4, 5, 6, 7, 8, 9, 10, 11);
}

CHI_INLINE8 int64_t sum_row(double* row, int width, double unit, double clean, int64_t* bins)
{
  const __m512i last = _mm512_set1_epi64(7);
  v8 slope = v8_set(0), value = v8_set(0);
  __m512i sum = _mm512_setzero_si512();
  for (int i = 0; i < width; i += 8)
  {
    const v8 s = running_sums(v8_load(row + i)) + slope;
    const v8 v = running_sums(s) + value;
    slope = (v8)_mm512_permutexvar_pd(last, (__m512d)s);
    value = (v8)_mm512_permutexvar_pd(last, (__m512d)v);
    const __mmask8 in = (__mmask8)(width - i < 8 ? (1 << (width - i)) - 1 : 255);
    const __mmask8 kept =
      _mm512_mask_cmp_pd_mask(in, _mm512_abs_pd((__m512d)v), _mm512_set1_pd(clean), _CMP_GT_OQ);
    if (kept)
    {
      const __m512i n =
        _mm512_maskz_cvtpd_epi64(kept, _mm512_mul_pd((__m512d)v, _mm512_set1_pd(unit)));
      sum = _mm512_add_epi64(sum, n);
      _mm512_mask_storeu_epi64(
        bins + i, kept, _mm512_add_epi64(_mm512_maskz_loadu_epi64(kept, bins + i), n));
    }
  }
  return _mm512_reduce_add_epi64(sum);
}
#else
CHI_INLINE8 int64_t sum_row(double* row, int width, double unit, double clean, int64_t* bins)
{
  double slope = 0, value = 0;
  int64_t sum = 0;
  for (int i = 0; i < width; ++i)
  {
    slope += row[i];
    value += slope;
    if (fabs(value) > clean)
    {
      const int64_t n = (int64_t)llrint(value * unit);
      bins[i] += n;
      sum += n;
    }
  }
  return sum;
}
#endif

static int64_t flush(
  const chi_scatter_plot* plot, const chi_scatter_tile* tile, double clean, int64_t* bins)
{
  const int right = plot->bins[0] - tile->left;
  const int width = tile->width < right ? tile->width : right;
  int64_t sum = 0;
  for (int j = 0; j < tile->count; ++j)
  {
    double* const row = tile->at + (size_t)j * tile->stride;
    const size_t at = (size_t)(tile->first + j) * (size_t)plot->bins[0] + (size_t)tile->left;
    sum += sum_row(row, width, plot->unit, clean, bins + at);
    memset(row, 0, tile->stride * sizeof *row);
  }
  return sum;
}
