/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cells of two dimensions as triangles, for data sets that have no others. All nodes of quadratic
 * cells are corners. */

#include "chi_grid_internal.h"

#include <math.h>

enum
{
  TRIANGLE = 5,
  STRIP = 6,
  POLYGON = 7,
  PIXEL = 8,
  QUAD = 9,
  QUADRATIC_EDGE = 21
};

/* Cells of a fixed number of nodes, and how these make triangles. */
struct chi_polygon_type
{
  uint8_t vtk_type, points, triangles;
  uint8_t corner[8][3];
};

static const chi_polygon_type types[] = {
  { TRIANGLE, 3, 1, { { 0, 1, 2 } } },
  { PIXEL, 4, 2, { { 0, 1, 3 }, { 0, 3, 2 } } },
  { QUAD, 4, 2, { { 0, 1, 2 }, { 0, 2, 3 } } },
  { 22, 6, 4, { { 0, 3, 5 }, { 1, 4, 3 }, { 2, 5, 4 }, { 3, 4, 5 } } },
  { 23, 8, 6, { { 0, 4, 7 }, { 1, 5, 4 }, { 2, 6, 5 }, { 3, 7, 6 }, { 4, 5, 6 }, { 4, 6, 7 } } },
  { 28, 9, 8,
    { { 0, 4, 8 }, { 4, 1, 8 }, { 1, 5, 8 }, { 5, 2, 8 }, { 2, 6, 8 }, { 6, 3, 8 }, { 3, 7, 8 },
      { 7, 0, 8 } } },
  { 34, 7, 6, { { 0, 3, 6 }, { 3, 1, 6 }, { 1, 4, 6 }, { 4, 2, 6 }, { 2, 5, 6 }, { 5, 0, 6 } } },
};

static const chi_polygon_type* type_of(int vtk_type)
{
  for (size_t k = 0; k < sizeof types / sizeof types[0]; ++k)
  {
    if (types[k].vtk_type == vtk_type)
    {
      return types + k;
    }
  }
  return NULL;
}

int chi_polygon_has_type(int vtk_type)
{
  return vtk_type == STRIP || vtk_type == POLYGON || type_of(vtk_type);
}

size_t chi_polygon_most(int vtk_type, size_t count)
{
  const chi_polygon_type* const type = type_of(vtk_type);
  return type ? type->triangles : count;
}

/* A quadrilateral of a structured grid. */
static int read_quad(const chi_grid* grid, size_t index, chi_grid_polygon* p)
{
  const size_t *const n = grid->view.dimensions, *const d = grid->dimensions;
  const size_t at[3] = { index % d[0], index / d[0] % d[1], index / d[0] / d[1] };
  const size_t step[3] = { 1, n[0], n[0] * n[1] };
  size_t side[3] = { 0, 0, 0 }, first = 0;
  int sides = 0;
  for (int a = 0; a < 3; ++a)
  {
    first += at[a] * step[a];
    if (n[a] > 1)
    {
      side[sides++] = step[a];
    }
  }
  if (sides != 2)
  {
    return CHI_CELL_FLAT_TYPE;
  }
  p->own[0] = (int64_t)first;
  p->own[1] = (int64_t)(first + side[0]);
  p->own[2] = (int64_t)(first + side[0] + side[1]);
  p->own[3] = (int64_t)(first + side[1]);
  p->ids = p->own;
  p->count = 4;
  p->type = type_of(QUAD);
  return CHI_CELL_GOOD;
}

static int read_listed(const chi_grid_cell* cell, int vtk_type, chi_grid_polygon* p)
{
  if (!chi_polygon_has_type(vtk_type))
  {
    return vtk_type < TRIANGLE || vtk_type == QUADRATIC_EDGE ? CHI_CELL_FLAT_TYPE
                                                             : CHI_CELL_UNSUPPORTED;
  }
  p->type = type_of(vtk_type);
  p->is_strip = vtk_type == STRIP;
  p->ids = cell->ids;
  p->count = cell->count;
  return p->type && p->count != p->type->points ? CHI_CELL_BROKEN : CHI_CELL_GOOD;
}

int chi_polygon_read(const chi_grid* grid, size_t index, chi_grid_polygon* p)
{
  const chi_grid_view* const v = &grid->view;
  chi_grid_cell cell;
  int found = chi_cell_read(grid, index, &cell);
  if (found == CHI_CELL_GOOD)
  {
    return CHI_CELL_UNSUPPORTED; /* a cell of three dimensions: there are none */
  }
  if (found != CHI_CELL_FLAT_TYPE && found != CHI_CELL_UNSUPPORTED)
  {
    return found;
  }
  *p = (chi_grid_polygon){ 0 };
  found = v->kind == CHI_GRID_UNSTRUCTURED ? read_listed(&cell, v->cell_types[index], p)
                                           : read_quad(grid, index, p);
  for (size_t k = 0; k < p->count && found == CHI_CELL_GOOD && v->point_ghosts; ++k)
  {
    found = v->point_ghosts[p->ids[k]] & CHI_GRID_HIDDEN_POINT ? CHI_CELL_BLANKED : CHI_CELL_GOOD;
  }
  p->triangles = p->type ? p->type->triangles : p->count > 2 ? p->count - 2 : 0;
  return found;
}

void chi_polygon_triangle(const chi_grid_polygon* p, size_t t, size_t corner[3])
{
  for (size_t c = 0; c < 3; ++c)
  {
    corner[c] = p->type ? p->type->corner[t][c] : p->is_strip || c > 0 ? t + c : 0;
  }
}

/* Twice the vector area. */
static void normal_of(double x[3][3], double n[3])
{
  const double a[3] = { x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2] };
  const double b[3] = { x[2][0] - x[0][0], x[2][1] - x[0][1], x[2][2] - x[0][2] };
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
}

static void locate(const chi_grid* grid, const chi_grid_polygon* p, size_t t, double x[3][3])
{
  size_t corner[3];
  chi_polygon_triangle(p, t, corner);
  for (int c = 0; c < 3; ++c)
  {
    chi_grid_point(grid, (size_t)p->ids[corner[c]], x[c]);
  }
}

int chi_polygon_locate(const chi_grid* grid, chi_grid_polygon* p)
{
  int is_finite = 1;
  for (size_t t = 0; t < p->triangles; ++t)
  {
    double x[3][3], n[3];
    locate(grid, p, t, x);
    normal_of(x, n);
    for (int a = 0; a < 3; ++a)
    {
      p->whole[a] += n[a];
      for (int c = 0; c < 3; ++c)
      {
        is_finite &= fabs(x[c][a]) <= 1e100; /* as chi_grid_count has it */
      }
    }
  }
  return is_finite;
}

double chi_polygon_area(const chi_grid* grid, const chi_grid_polygon* p, size_t t, double x[3][3])
{
  double n[3];
  locate(grid, p, t, x);
  normal_of(x, n);
  const double area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const double along = n[0] * p->whole[0] + n[1] * p->whole[1] + n[2] * p->whole[2];
  return !p->type && !p->is_strip && along < 0 ? -area : area;
}
