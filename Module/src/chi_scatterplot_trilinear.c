/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Trilinear cells subdivided to a tolerance. A cell becomes (2^L)^3 equal parts of its parameters,
 * with the values of the trilinear interpolant at their corners; each part is split about its
 * diagonal as a lattice's cells are, so that parts are bricks again.
 *
 * Bound. Let M_xy be the larger of a field's mixed differences v(11) - v(10) - v(01) + v(00) on
 * the two sides z = 0, 1 of the cell, M_xz and M_yz likewise. On any tetrahedron whose corners are
 * corners of the cell the linear interpolant differs from the trilinear one by at most
 *
 *   B = (M_xy + M_xz + M_yz) / 4.                                                              (1)
 *
 * For at barycentric coordinates l the one is E v(X, Y, Z), with the corner drawn with odds l, and
 * the other the same with X, Y and Z drawn apart. Parting X from (Y, Z) changes it by the
 * covariance of X with v(1, Y, Z) - v(0, Y, Z), at most a quarter of what that spans, M_xy + M_xz;
 * parting Y from Z by a quarter of M_yz. Mixed differences of a part are at most 4^-L of the
 * cell's, so its bound is too.
 *
 * A part's mass is the integral of the map's determinant, and spread evenly over it. What that
 * moves is at most half of the determinant's span D by the values' span E in the part, of which
 * each falls with 2^-L:
 *
 *   E D / 2, D relative to the cell's mean determinant.                                        (2)
 *
 * So with (B + E D / 2) 4^-L <= tolerance mass lies on average no further than that from where the
 * trilinear cell has it.
 */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  BRICK_LEVEL = 3, /* a brick has room for 2^3 parts along each axis */
  VOXEL_TYPE = 11,
  HEXAHEDRON_TYPE = 12
};

typedef struct cell
{
  double v[2][8];      /* values, in units of bins; bits of a corner's number are its x, y, z */
  double det[3][3][3]; /* Bernstein coefficients of the mass per volume of parameters, z first */
  int is_even;         /* it is det[0][0][0] everywhere */
} cell;

/* ---- the level */

/* (1) for a field. */
static double mixed_bound(const double v[8])
{
  const double xy0 = fabs(v[3] - v[2] - v[1] + v[0]), xy1 = fabs(v[7] - v[6] - v[5] + v[4]);
  const double xz0 = fabs(v[5] - v[4] - v[1] + v[0]), xz1 = fabs(v[7] - v[6] - v[3] + v[2]);
  const double yz0 = fabs(v[6] - v[4] - v[2] + v[0]), yz1 = fabs(v[7] - v[5] - v[3] + v[1]);
  return ((xy0 > xy1 ? xy0 : xy1) + (xz0 > xz1 ? xz0 : xz1) + (yz0 > yz1 ? yz0 : yz1)) / 4;
}

/* How far a field goes along the three axes together: what it spans in a part is 2^-L of it. */
static double span_of(const double v[8])
{
  double sum = 0;
  for (int step = 1; step < 8; step *= 2)
  {
    double most = 0;
    for (int k = 0; k < 8; ++k)
    {
      const double d = k & step ? fabs(v[k] - v[k - step]) : 0;
      most = d > most ? d : most;
    }
    sum += most;
  }
  return sum;
}

/* The same of the determinant, relative to its mean: derivatives of a quadratic are twice the
 * differences of its coefficients. */
static double determinant_span(const cell* c)
{
  const double* const d = &c->det[0][0][0];
  double sum = 0, mean = 0;
  for (int k = 0; k < 27; ++k)
  {
    mean += d[k] / 27;
  }
  for (int step = 1; step < 27; step *= 3)
  {
    double most = 0;
    for (int k = 0; k < 27; ++k)
    {
      const double change = k / step % 3 ? fabs(d[k] - d[k - step]) : 0;
      most = change > most ? change : most;
    }
    sum += 2 * most;
  }
  return mean != 0 ? sum / fabs(mean) : 0;
}

static int bin_of(double x, int32_t bins)
{
  return x < bins ? (int)x : bins - 1;
}

/* Levels that change nothing are not taken: of cells that miss the plot, or lie in one bin. */
static int matters(const chi_scatter_plot* plot, const double v[2][8])
{
  int is_one = 1;
  for (int f = 0; f < 2; ++f)
  {
    double low = v[f][0], high = v[f][0];
    for (int k = 1; k < 8; ++k)
    {
      low = v[f][k] < low ? v[f][k] : low;
      high = v[f][k] > high ? v[f][k] : high;
    }
    const int32_t n = plot->bins[f];
    if (high < 0 || low > n)
    {
      return 0;
    }
    is_one = is_one && low >= 0 && high <= n && bin_of(low, n) == bin_of(high, n);
  }
  return !is_one;
}

static int choose_level(const chi_scatter_job* job, const cell* c, int* is_capped)
{
  const double d = c->is_even ? 0 : determinant_span(c);
  const int most = job->params.trilinear_levels;
  double ratio = 0;
  int level = 0;
  *is_capped = 0;
  if (!matters(&job->plot, c->v))
  {
    return 0;
  }
  for (int f = 0; f < 2; ++f)
  {
    const double error = mixed_bound(c->v[f]) + (d > 0 ? 0.5 * d * span_of(c->v[f]) : 0);
    const double most_error = job->params.trilinear_tolerance * job->plot.bins[f];
    ratio = error > ratio * most_error ? error / most_error : ratio;
  }
  for (; ratio > 1 && level < most; ratio /= 4)
  {
    ++level;
  }
  *is_capped = ratio > 1;
  return level;
}

/* ---- parts */

static size_t place_of(size_t x, size_t y, size_t z)
{
  return x + CHI_SCATTER_ROW * y + CHI_SCATTER_LAYER * z;
}

/* From values at every (2^level)-th point of n cells along each axis those between, axis by axis.
 */
static void interpolate(double* v, const size_t n[3], int level)
{
  const size_t step = (size_t)1 << level;
  const double part = 1 / (double)step;
  for (size_t z = 0; z <= n[2] && level > 0; ++z)
  {
    for (size_t y = 0; y <= n[1]; ++y)
    {
      double* const row = v + place_of(0, y * step, z * step);
      for (size_t x = 0; x < n[0]; ++x)
      {
        const double from = row[x * step], rise = (row[(x + 1) * step] - from) * part;
        for (size_t t = 1; t < step; ++t)
        {
          row[x * step + t] = from + rise * (double)t;
        }
      }
    }
    for (size_t y = 0; y < n[1]; ++y)
    {
      double* const from = v + place_of(0, y * step, z * step);
      const double* const to = from + place_of(0, step, 0);
      for (size_t t = 1; t < step; ++t)
      {
        for (size_t x = 0; x <= n[0] * step; ++x)
        {
          from[place_of(x, t, 0)] = from[x] + (to[x] - from[x]) * (part * (double)t);
        }
      }
    }
  }
  for (size_t z = 0; z < n[2] && level > 0; ++z)
  {
    for (size_t y = 0; y <= n[1] * step; ++y)
    {
      double* const from = v + place_of(0, y, z * step);
      const double* const to = from + place_of(0, 0, step);
      for (size_t t = 1; t < step; ++t)
      {
        for (size_t x = 0; x <= n[0] * step; ++x)
        {
          from[place_of(x, 0, t)] = from[x] + (to[x] - from[x]) * (part * (double)t);
        }
      }
    }
  }
}

/* Round to the grid of values again, and keep what rounding moved out of low ... high inside. */
static void snap(
  const chi_scatter_job* job, double* v, const int32_t cells[3], double low, double high)
{
  const double s = job->plot.snap;
  for (size_t z = 0; z <= (size_t)cells[2]; ++z)
  {
    for (size_t y = 0; y <= (size_t)cells[1]; ++y)
    {
      double* const row = v + place_of(0, y, z);
      for (size_t x = 0; x <= (size_t)cells[0]; ++x)
      {
        double value = (row[x] + s) - s;
        value = value < low ? low : value;
        row[x] = value > high ? high : value;
      }
    }
  }
}

/* Values at the coarse points are in w->fine, and masses of its cells: deposit it. */
static void deposit_fine(chi_scatter_job* job, chi_scatter_worker* w, const size_t n[3], int level,
  const double box[4], double most)
{
  chi_scatter_brick* const b = w->fine;
  for (int a = 0; a < 3; ++a)
  {
    b->cells[a] = (int32_t)(n[a] << level);
  }
  interpolate(b->x, n, level);
  interpolate(b->y, n, level);
  snap(job, b->x, b->cells, box[0], box[1]);
  snap(job, b->y, b->cells, box[2], box[3]);
  chi_scatter_deposit_cells(job, w, b, box, most);
  chi_scatter_settle(job, w); /* a sum of all parts of a piece would round off too much */
}

/* ---- bricks of a lattice */

typedef struct refinement
{
  chi_scatter_job* job;
  chi_scatter_worker* w;
  const chi_scatter_brick* b;
  uint8_t level[CHI_SCATTER_CELLS];
} refinement;

static size_t cell_of(const size_t at[3])
{
  return at[0] + CHI_SCATTER_BRICK * (at[1] + CHI_SCATTER_BRICK * at[2]);
}

static void read_corners(const chi_scatter_brick* b, const size_t at[3], double v[2][8])
{
  const size_t first = place_of(at[0], at[1], at[2]);
  for (size_t k = 0; k < 8; ++k)
  {
    const size_t corner = first + place_of(k & 1, k >> 1 & 1, k >> 2);
    v[0][k] = b->x[corner];
    v[1][k] = b->y[corner];
  }
}

static void add_to_box(const double v[2][8], double box[4])
{
  for (int f = 0; f < 2; ++f)
  {
    for (int k = 0; k < 8; ++k)
    {
      box[2 * f] = v[f][k] < box[2 * f] ? v[f][k] : box[2 * f];
      box[2 * f + 1] = v[f][k] > box[2 * f + 1] ? v[f][k] : box[2 * f + 1];
    }
  }
}

/* A cell in 2^level parts along each axis, as many bricks as that takes. */
static void deposit_parts(chi_scatter_job* job, chi_scatter_worker* w, const cell* c, int level);

/* n^3 cells from `at` on, less at the brick's ends. */
static void refine(refinement* r, const size_t at[3], size_t n)
{
  static const size_t one[3] = { 1, 1, 1 };
  const chi_scatter_brick* const b = r->b;
  size_t end[3], k[3], count[3];
  for (int a = 0; a < 3; ++a)
  {
    end[a] = at[a] + n < (size_t)b->cells[a] ? at[a] + n : (size_t)b->cells[a];
    if (end[a] <= at[a])
    {
      return;
    }
    count[a] = end[a] - at[a];
  }
  double box[4] = { INFINITY, -INFINITY, INFINITY, -INFINITY }, v[2][8], most = 0;
  int level = 0;
  for (k[2] = at[2]; k[2] < end[2]; ++k[2])
  {
    for (k[1] = at[1]; k[1] < end[1]; ++k[1])
    {
      for (k[0] = at[0]; k[0] < end[0]; ++k[0])
      {
        const size_t i = cell_of(k);
        const double size = fabs(b->mass[i]);
        if (size == size)
        {
          read_corners(b, k, v);
          add_to_box((const double(*)[8])v, box);
          level = r->level[i] > level ? r->level[i] : level;
          most = size > most ? size : most;
        }
      }
    }
  }
  if (!(most > 0))
  {
    return; /* nothing there, or nothing of any mass */
  }
  if (n == 1 && level > BRICK_LEVEL)
  {
    cell c = { .is_even = 1 };
    read_corners(b, at, c.v);
    c.det[0][0][0] = 6 * b->mass[cell_of(at)];
    deposit_parts(r->job, r->w, &c, level);
    return;
  }
  if (n << level > CHI_SCATTER_BRICK)
  {
    for (size_t part = 0; part < 8; ++part)
    {
      const size_t half = n / 2;
      const size_t from[3] = { at[0] + half * (part & 1), at[1] + half * (part >> 1 & 1),
        at[2] + half * (part >> 2) };
      refine(r, from, half);
    }
    return;
  }
  chi_scatter_brick* const fine = r->w->fine;
  const double share = ldexp(1, -3 * level);
  for (k[2] = 0; k[2] <= count[2]; ++k[2])
  {
    for (k[1] = 0; k[1] <= count[1]; ++k[1])
    {
      for (k[0] = 0; k[0] <= count[0]; ++k[0])
      {
        const size_t from = place_of(at[0] + k[0], at[1] + k[1], at[2] + k[2]);
        const size_t to = place_of(k[0] << level, k[1] << level, k[2] << level);
        fine->x[to] = b->x[from];
        fine->y[to] = b->y[from];
      }
    }
  }
  for (k[2] = 0; k[2] < count[2] << level; ++k[2])
  {
    for (k[1] = 0; k[1] < count[1] << level; ++k[1])
    {
      for (k[0] = 0; k[0] < count[0] << level; ++k[0])
      {
        const size_t from[3] = { at[0] + (k[0] >> level), at[1] + (k[1] >> level),
          at[2] + (k[2] >> level) };
        fine->mass[cell_of(k)] = share * b->mass[cell_of(from)];
      }
    }
  }
  r->w->more_simplices += 6 * (((size_t)1 << 3 * level) - 1) * count[0] * count[1] * count[2];
  deposit_fine(r->job, r->w, n == 1 ? one : count, level, box, share * most);
}

int chi_scatter_refine_brick(
  chi_scatter_job* job, chi_scatter_worker* w, const chi_scatter_brick* b)
{
  refinement r = { job, w, b, { 0 } };
  cell c = { .is_even = 1 };
  size_t at[3];
  int any = 0, is_capped;
  for (at[2] = 0; at[2] < (size_t)b->cells[2]; ++at[2])
  {
    for (at[1] = 0; at[1] < (size_t)b->cells[1]; ++at[1])
    {
      for (at[0] = 0; at[0] < (size_t)b->cells[0]; ++at[0])
      {
        const size_t i = cell_of(at);
        if (b->mass[i] == b->mass[i])
        {
          read_corners(b, at, c.v);
          r.level[i] = (uint8_t)choose_level(job, &c, &is_capped);
          any |= r.level[i];
          w->subdivided += r.level[i] > 0;
          w->capped += (size_t)is_capped;
        }
      }
    }
  }
  if (any)
  {
    refine(&r, (const size_t[3]){ 0, 0, 0 }, CHI_SCATTER_BRICK);
  }
  return any;
}

/* ---- one cell */

static double value_at(const double v[8], const double t[3])
{
  double x[4];
  for (int k = 0; k < 4; ++k)
  {
    x[k] = v[2 * k] + (v[2 * k + 1] - v[2 * k]) * t[0];
  }
  const double y0 = x[0] + (x[1] - x[0]) * t[1], y1 = x[2] + (x[3] - x[2]) * t[1];
  return y0 + (y1 - y0) * t[2];
}

/* Integrals of the quadratic Bernstein polynomials over parts first ... first + count - 1 of n.
 * Simpson's rule is exact, and all terms are positive. */
static void part_weights(size_t first, size_t count, size_t n, double weight[][3])
{
  for (size_t k = 0; k < count; ++k)
  {
    const double h = 1 / (double)n, a = h * (double)(first + k);
    const double t[3] = { a, a + 0.5 * h, a + h };
    for (int b = 0; b < 3; ++b)
    {
      double p[3];
      for (int i = 0; i < 3; ++i)
      {
        p[i] = b == 0 ? (1 - t[i]) * (1 - t[i]) : b == 1 ? 2 * t[i] * (1 - t[i]) : t[i] * t[i];
      }
      weight[k][b] = h * (p[0] + 4 * p[1] + p[2]) / 6;
    }
  }
}

/* A sixth of the mass of each part of a brick of n^3 from part `first` of all^3 on. */
static double find_masses(
  const cell* c, const size_t first[3], size_t n, size_t all, chi_scatter_brick* fine)
{
  double weight[3][CHI_SCATTER_BRICK][3], along_x[3][3][CHI_SCATTER_BRICK], most = 0;
  for (int a = 0; a < 3 && !c->is_even; ++a)
  {
    part_weights(first[a], n, all, weight[a]);
  }
  for (size_t row = 0; row < 9 && !c->is_even; ++row)
  {
    const double* const d = c->det[row / 3][row % 3];
    for (size_t x = 0; x < n; ++x)
    {
      const double* const k = weight[0][x];
      along_x[row / 3][row % 3][x] = k[0] * d[0] + k[1] * d[1] + k[2] * d[2];
    }
  }
  const double even = c->det[0][0][0] / 6 / (double)(all * all * all);
  for (size_t z = 0; z < n; ++z)
  {
    for (size_t y = 0; y < n; ++y)
    {
      double* const row = fine->mass + cell_of((const size_t[3]){ 0, y, z });
      for (size_t x = 0; x < n; ++x)
      {
        double sum = 0;
        for (int j = 0; j < 9 && !c->is_even; ++j)
        {
          sum += weight[2][z][j / 3] * weight[1][y][j % 3] * along_x[j / 3][j % 3][x];
        }
        row[x] = c->is_even ? even : sum / 6;
        most = fabs(row[x]) > most ? fabs(row[x]) : most;
      }
    }
  }
  return most;
}

static void deposit_parts(chi_scatter_job* job, chi_scatter_worker* w, const cell* c, int level)
{
  static const size_t one[3] = { 1, 1, 1 };
  const int inner = level < BRICK_LEVEL ? level : BRICK_LEVEL;
  const size_t bricks = (size_t)1 << (level - inner), n = (size_t)1 << inner, all = n * bricks;
  chi_scatter_brick* const fine = w->fine;
  const double s = job->plot.snap;
  for (size_t k = 0; k < bricks * bricks * bricks; ++k)
  {
    const size_t at[3] = { k % bricks, k / bricks % bricks, k / bricks / bricks };
    double box[4] = { INFINITY, -INFINITY, INFINITY, -INFINITY }, v[2][8];
    for (size_t corner = 0; corner < 8; ++corner)
    {
      const double t[3] = { (double)(at[0] + (corner & 1)) / (double)bricks,
        (double)(at[1] + (corner >> 1 & 1)) / (double)bricks,
        (double)(at[2] + (corner >> 2)) / (double)bricks };
      const size_t to = place_of((corner & 1) * n, (corner >> 1 & 1) * n, (corner >> 2) * n);
      for (int f = 0; f < 2; ++f)
      {
        v[f][corner] = (value_at(c->v[f], t) + s) - s;
      }
      fine->x[to] = v[0][corner];
      fine->y[to] = v[1][corner];
    }
    add_to_box((const double(*)[8])v, box);
    const size_t first[3] = { at[0] * n, at[1] * n, at[2] * n };
    const double most = find_masses(c, first, n, all, fine);
    deposit_fine(job, w, one, inner, box, most);
  }
  w->more_simplices += 6 * (all * all * all - 1);
}

/* ---- cells of lists */

/* Coefficients of the determinant of a trilinear map: the edges along each axis are bilinear in
 * the two others, so it is quadratic in each (Grandy 1997 has its integral). 0 where its sign is
 * not known to be one everywhere. */
static int find_determinant(const chi_grid_cell* g, const int order[8], cell* c)
{
  double edge[3][2][2][3]; /* along an axis; at the lower and the higher of the others' ends */
  double low = INFINITY, high = -INFINITY;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    for (int k = 0; k < 4; ++k)
    {
      const int from = (k & 1) << u | (k >> 1) << v, to = from | 1 << axis;
      for (int i = 0; i < 3; ++i)
      {
        edge[axis][k >> 1][k & 1][i] = g->x[order[to]][i] - g->x[order[from]][i];
      }
    }
  }
  memset(c->det, 0, sizeof c->det);
  /* x y: the y and z ends of an edge along x, and so on */
  for (int k = 0; k < 64; ++k)
  {
    const int xy = k & 1, xz = k >> 1 & 1, yx = k >> 2 & 1, yz = k >> 3 & 1, zx = k >> 4 & 1;
    const int zy = k >> 5;
    const double *const p = edge[0][xz][xy], *const q = edge[1][yz][yx], *const r = edge[2][zy][zx];
    const double det = p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
      p[2] * (q[0] * r[1] - q[1] * r[0]);
    const int i = yx + zx, j = xy + zy, l = xz + yz;
    c->det[l][j][i] += ldexp(det, -(i == 1) - (j == 1) - (l == 1));
  }
  const double* const d = &c->det[0][0][0];
  for (int k = 0; k < 27; ++k)
  {
    low = d[k] < low ? d[k] : low;
    high = d[k] > high ? d[k] : high;
  }
  return low >= 0 || high <= 0;
}

void chi_scatter_refine_cell(chi_scatter_job* job, chi_scatter_worker* w, const chi_grid_cell* g,
  int way, size_t first, double weight, int is_first)
{
  static const int around[8] = { 0, 1, 3, 2, 4, 5, 7, 6 }, in_order[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const chi_grid_view* const grid = &job->grid.view;
  chi_scatter_block* const b = &w->block;
  const int type =
    grid->kind == CHI_GRID_UNSTRUCTURED ? grid->cell_types[b->cell[first]] : HEXAHEDRON_TYPE;
  const int* const order = type == VOXEL_TYPE ? in_order : around;
  cell c = { .is_even = 0 };
  double volume = 0, before = 0, zero = 0;
  if (type != VOXEL_TYPE && type != HEXAHEDRON_TYPE)
  {
    return;
  }
  if (!find_determinant(g, order, &c))
  {
    w->folded += !is_first;
    return;
  }
  double* const d = &c.det[0][0][0];
  for (int k = 0; k < 27; ++k)
  {
    volume += fabs(d[k]) / 27;
    d[k] = fabs(d[k]) * weight;
  }
  for (size_t t = first; t < b->count; ++t)
  {
    before += b->mass[t];
  }
  /* What its tetrahedra hold becomes the volume of the map, subdivided or not. */
  for (size_t t = first; t < b->count && before != 0; ++t)
  {
    b->mass[t] *= volume * weight / before;
  }
  for (int f = 0; f < 2 && !is_first; ++f)
  {
    for (int k = 0; k < 8; ++k)
    {
      c.v[f][k] = chi_scatter_value(
        &job->input.fields[f], job->input.components[f], (size_t)g->ids[order[k]]);
    }
    for (int k = 0; k < 8; ++k)
    {
      zero += 0 * c.v[f][k];
    }
    chi_scatter_map(&job->plot, f, c.v[f], 8);
  }
  if (is_first || zero != 0 || !isfinite(volume * weight) || before == 0)
  {
    return; /* cells that are not finite are left out with the block */
  }
  int is_capped, level = choose_level(job, &c, &is_capped);
  /* (1) holds for corners of the cell */
  level += level == 0 && way == CHI_SPLIT_CENTER;
  w->subdivided += level > 0;
  w->capped += (size_t)is_capped;
  if (level > 0)
  {
    const size_t tetrahedra = b->count - first;
    b->count = first;
    b->centers -= way == CHI_SPLIT_CENTER;
    deposit_parts(job, w, &c, level);
    w->more_simplices += 6 - tetrahedra; /* may wrap around, and back */
  }
}
