/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cells of two dimensions as triangles, for data sets that have no others. */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  TRIANGLE = 5,
  STRIP,
  POLYGON,
  PIXEL,
  QUAD,
  QUADRATIC_EDGE = 21,
  QUADRATIC_TRIANGLE,
  QUADRATIC_QUAD = 23,
  BIQUADRATIC_QUAD = 28,
  BIQUADRATIC_TRIANGLE = 34
};

typedef struct triangle_list
{
  uint8_t count, points;
  uint8_t corner[8][3];
} triangle_list;

/* All nodes are corners. */
static const triangle_list quadratic_triangle = { 4, 6,
  { { 0, 3, 5 }, { 1, 4, 3 }, { 2, 5, 4 }, { 3, 4, 5 } } };
static const triangle_list biquadratic_triangle = { 6, 7,
  { { 0, 3, 6 }, { 3, 1, 6 }, { 1, 4, 6 }, { 4, 2, 6 }, { 2, 5, 6 }, { 5, 0, 6 } } };
static const triangle_list quadratic_quad = { 6, 8,
  { { 0, 4, 7 }, { 1, 5, 4 }, { 2, 6, 5 }, { 3, 7, 6 }, { 4, 5, 6 }, { 4, 6, 7 } } };
static const triangle_list biquadratic_quad = { 8, 9,
  { { 0, 4, 8 }, { 4, 1, 8 }, { 1, 5, 8 }, { 5, 2, 8 }, { 2, 6, 8 }, { 6, 3, 8 }, { 3, 7, 8 },
    { 7, 0, 8 } } };

static const triangle_list* table_of(int type)
{
  return type == QUADRATIC_TRIANGLE ? &quadratic_triangle
    : type == BIQUADRATIC_TRIANGLE  ? &biquadratic_triangle
    : type == QUADRATIC_QUAD        ? &quadratic_quad
    : type == BIQUADRATIC_QUAD      ? &biquadratic_quad
                                    : NULL;
}

int chi_scatter_is_polygon(int vtk_type)
{
  return (vtk_type >= TRIANGLE && vtk_type <= QUAD) || table_of(vtk_type);
}

/* A cell's corners, and how they make triangles. */
typedef struct polygon
{
  const int64_t* ids;
  int64_t own[4];
  size_t count;
  int type;
} polygon;

/* A quadrilateral of a structured grid. */
static int read_structured(const chi_grid* grid, size_t index, polygon* p)
{
  const size_t* const n = grid->view.dimensions;
  const size_t* const d = grid->dimensions;
  const size_t at[3] = { index % d[0], index / d[0] % d[1], index / d[0] / d[1] };
  const int64_t step[3] = { 1, (int64_t)n[0], (int64_t)(n[0] * n[1]) };
  int64_t side[3], first = 0;
  int sides = 0;
  for (int a = 0; a < 3; ++a)
  {
    first += (int64_t)at[a] * step[a];
    if (n[a] > 1)
    {
      side[sides++] = step[a];
    }
  }
  if (sides != 2)
  {
    return CHI_CELL_FLAT_TYPE;
  }
  p->own[0] = first;
  p->own[1] = first + side[0];
  p->own[2] = first + side[0] + side[1];
  p->own[3] = first + side[1];
  p->ids = p->own;
  p->count = 4;
  p->type = QUAD;
  return CHI_CELL_GOOD;
}

static int read_polygon(const chi_grid* grid, size_t index, polygon* p)
{
  const chi_grid_view* const v = &grid->view;
  chi_grid_cell cell;
  int found = chi_cell_read(grid, index, &cell);
  if (found != CHI_CELL_FLAT_TYPE)
  {
    return found == CHI_CELL_GOOD ? CHI_CELL_UNSUPPORTED : found;
  }
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    found = read_structured(grid, index, p);
  }
  else
  {
    p->type = v->cell_types[index];
    p->ids = cell.ids;
    p->count = cell.count;
    const triangle_list* const table = table_of(p->type);
    const int is_line = p->type < TRIANGLE || p->type == QUADRATIC_EDGE;
    found = is_line                      ? CHI_CELL_FLAT_TYPE
      : !chi_scatter_is_polygon(p->type) ? CHI_CELL_UNSUPPORTED
                                         : CHI_CELL_GOOD;
    const size_t points = table ? table->points
      : p->type == TRIANGLE     ? 3
      : p->type >= PIXEL        ? 4
                                : p->count;
    if (found == CHI_CELL_GOOD && p->count != points)
    {
      return CHI_CELL_BROKEN;
    }
  }
  for (size_t k = 0; k < p->count && found == CHI_CELL_GOOD && v->point_ghosts; ++k)
  {
    found = v->point_ghosts[p->ids[k]] & CHI_GRID_HIDDEN_POINT ? CHI_CELL_BLANKED : CHI_CELL_GOOD;
  }
  return found;
}

/* Corners of triangle t of those that a polygon is cut into. */
static void triangle_of(const polygon* p, size_t t, size_t k[3])
{
  static const uint8_t pixel[2][3] = { { 0, 1, 3 }, { 0, 3, 2 } };
  const triangle_list* const table = table_of(p->type);
  for (size_t c = 0; c < 3; ++c)
  {
    k[c] = table         ? table->corner[t][c]
      : p->type == STRIP ? t + c
      : p->type == PIXEL ? pixel[t][c]
                         : (c ? t + c : 0);
  }
}

static size_t triangles_of(const polygon* p)
{
  const triangle_list* const table = table_of(p->type);
  return table ? table->count : p->count > 2 ? p->count - 2 : 0;
}

/* Twice the area of a triangle of points, as a vector. */
static void area2(const double x[3][3], double n[3])
{
  const double a[3] = { x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2] };
  const double b[3] = { x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2] };
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
}

/* Areas of a polygon's triangles, those that are turned against the whole negative: so a polygon
 * that is not convex has its own area. Returns the sum; 0 and a flag where a coordinate is bad. */
static double find_areas(
  const chi_scatter_job* job, const polygon* p, double* areas, int* is_finite)
{
  const size_t count = triangles_of(p);
  double whole[3] = { 0, 0, 0 }, sum = 0;
  *is_finite = 1;
  for (int pass = 0; pass < 2; ++pass)
  {
    for (size_t t = 0; t < count; ++t)
    {
      size_t k[3];
      double x[3][3], n[3];
      triangle_of(p, t, k);
      for (int c = 0; c < 3; ++c)
      {
        chi_grid_point(&job->grid, (size_t)p->ids[k[c]], x[c]);
        *is_finite &= fabs(x[c][0]) <= 1e100 && fabs(x[c][1]) <= 1e100 && fabs(x[c][2]) <= 1e100;
      }
      area2((const double(*)[3])x, n);
      const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      const double along = n[0] * whole[0] + n[1] * whole[1] + n[2] * whole[2];
      const double area = 0.5 * (p->type == POLYGON && along < 0 ? -length : length);
      for (int a = 0; a < 3 && pass == 0; ++a)
      {
        whole[a] += n[a];
      }
      if (pass == 1)
      {
        sum += area;
        if (areas)
        {
          areas[t] = area;
        }
      }
    }
  }
  return sum;
}

int chi_scatter_measure_polygon(
  const chi_scatter_job* job, size_t index, double* area, double* weight)
{
  polygon p;
  int is_finite;
  const int found = read_polygon(&job->grid, index, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  *area = find_areas(job, &p, NULL, &is_finite);
  *weight = chi_scatter_weight(job, index, p.ids, p.count);
  return is_finite ? CHI_CELL_GOOD : CHI_CELL_NON_FINITE;
}

int chi_scatter_add_polygon(chi_scatter_job* job, chi_scatter_worker* w, size_t index)
{
  chi_scatter_block* const b = &w->block;
  polygon p;
  int is_finite;
  const int found = read_polygon(&job->grid, index, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  find_areas(job, &p, b->mass + b->count, &is_finite);
  if (!is_finite)
  {
    return CHI_CELL_NON_FINITE;
  }
  const double weight = chi_scatter_weight(job, index, p.ids, p.count);
  const size_t count = triangles_of(&p);
  for (size_t t = 0; t < count; ++t)
  {
    size_t k[3];
    triangle_of(&p, t, k);
    for (size_t c = 0; c < 4; ++c)
    {
      b->ids[c * b->capacity + b->count] = (uint32_t)p.ids[k[c < 3 ? c : 2]];
    }
    b->mass[b->count] *= weight;
    b->cell[b->count++] = (uint32_t)index;
  }
  return CHI_CELL_GOOD;
}
