/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cells of two dimensions as triangles, for data sets that have no others. All nodes of quadratic
 * cells are corners. */

#include "chi_histogram_internal.h"

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
typedef struct polygon_type
{
  uint8_t vtk_type, points, triangles;
  uint8_t corner[8][3];
} polygon_type;

static const polygon_type types[] = {
  { TRIANGLE, 3, 1, { { 0, 1, 2 } } },
  { PIXEL, 4, 2, { { 0, 1, 3 }, { 0, 3, 2 } } },
  { QUAD, 4, 2, { { 0, 1, 2 }, { 0, 2, 3 } } },
  { 22, 6, 4, { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 }, { 3, 4, 5 } } },
  { 23, 8, 6, { { 0, 4, 7 }, { 4, 1, 5 }, { 5, 2, 6 }, { 6, 3, 7 }, { 4, 5, 6 }, { 4, 6, 7 } } },
  { 28, 9, 8,
    { { 8, 0, 4 }, { 8, 4, 1 }, { 8, 1, 5 }, { 8, 5, 2 }, { 8, 2, 6 }, { 8, 6, 3 }, { 8, 3, 7 },
      { 8, 7, 0 } } },
  { 34, 7, 6, { { 6, 0, 3 }, { 6, 3, 1 }, { 6, 1, 4 }, { 6, 4, 2 }, { 6, 2, 5 }, { 6, 5, 0 } } },
};

static const polygon_type* type_of(int vtk_type)
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
  const polygon_type* const type = type_of(vtk_type);
  return type ? type->triangles : count;
}

typedef struct polygon
{
  const polygon_type* type; /* NULL: a strip or a polygon */
  int is_strip;
  const int64_t* ids;
  int64_t own[4];
  size_t count;
} polygon;

/* A quadrilateral of a structured grid of two dimensions. */
static int read_quad(const chi_grid* grid, size_t index, polygon* p)
{
  const size_t *const n = grid->view.dimensions, *const d = grid->dimensions;
  const size_t at[3] = { index % d[0], index / d[0] % d[1], index / d[0] / d[1] };
  const size_t step[3] = { 1, n[0], n[0] * n[1] };
  size_t side[3] = { 0, 0, 0 }, first = 0;
  int sides = 0;
  for (int a = 0; a < 3; ++a)
  {
    first += at[a] * step[a];
    side[sides] = step[a];
    sides += n[a] > 1;
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

static int read_polygon(const chi_grid* grid, size_t index, chi_grid_cell* cell, polygon* p)
{
  const chi_grid_view* const v = &grid->view;
  int found = chi_cell_read(grid, index, cell);
  if (found == CHI_CELL_GOOD)
  {
    return CHI_CELL_UNSUPPORTED; /* a cell of three dimensions: there are none */
  }
  if (found != CHI_CELL_FLAT_TYPE && found != CHI_CELL_UNSUPPORTED)
  {
    return found;
  }
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    found = read_quad(grid, index, p);
  }
  else
  {
    const int vtk_type = v->cell_types[index];
    p->type = type_of(vtk_type);
    p->is_strip = vtk_type == STRIP;
    p->ids = cell->ids;
    p->count = cell->count;
    if (!chi_polygon_has_type(vtk_type))
    {
      return vtk_type < TRIANGLE || vtk_type == QUADRATIC_EDGE ? CHI_CELL_FLAT_TYPE
                                                               : CHI_CELL_UNSUPPORTED;
    }
    if (p->type ? p->count != p->type->points : p->count < 3)
    {
      return CHI_CELL_BROKEN;
    }
  }
  for (size_t k = 0; k < p->count && v->point_ghosts; ++k)
  {
    if (v->point_ghosts[p->ids[k]] & CHI_GRID_HIDDEN_POINT)
    {
      return CHI_CELL_BLANKED;
    }
  }
  return CHI_CELL_GOOD;
}

/* A triangle of the cell, as places among its points. */
static void triangle_of(const polygon* p, size_t t, size_t corner[3])
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

static void locate(
  const chi_grid* grid, const polygon* p, size_t t, size_t corner[3], double x[3][3])
{
  triangle_of(p, t, corner);
  for (int c = 0; c < 3; ++c)
  {
    chi_grid_point(grid, (size_t)p->ids[corner[c]], x[c]);
  }
}

int chi_histogram_add_polygon(
  const chi_histogram_plan* plan, size_t index, chi_histogram_block* block)
{
  chi_grid_cell cell;
  polygon p = { 0 };
  const int found = read_polygon(&plan->grid, index, &cell, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  const int are_cells = plan->association == CHI_HISTOGRAM_CELLS;
  const size_t count = p.type ? p.type->triangles : p.count - 2, before = block->count;
  /* a polygon that is not convex: triangles that are turned against the whole are taken away */
  const int has_signs = !p.type && !p.is_strip && p.count > 3;
  double whole[3] = { 0, 0, 0 }, x[3][3], sum = 0;
  size_t corner[3];
  int is_tame = 1;
  for (size_t t = 0; t < count; ++t)
  {
    double n[3];
    locate(&plan->grid, &p, t, corner, x);
    normal_of(x, n);
    for (int a = 0; a < 3; ++a)
    {
      whole[a] += n[a];
      for (int c = 0; c < 3; ++c)
      {
        is_tame &= fabs(x[c][a]) <= CHI_HISTOGRAM_LARGEST;
      }
    }
  }
  const double of_cell = are_cells ? chi_histogram_value(plan, index) : 0;
  is_tame &= fabs(of_cell) <= CHI_HISTOGRAM_LARGEST;
  for (size_t t = 0; t < count && is_tame; ++t)
  {
    double n[3], value[3] = { of_cell, of_cell, of_cell };
    locate(&plan->grid, &p, t, corner, x);
    normal_of(x, n);
    const int is_turned = has_signs && n[0] * whole[0] + n[1] * whole[1] + n[2] * whole[2] < 0;
    for (int c = 0; c < 3 && !are_cells; ++c)
    {
      value[c] = chi_histogram_value(plan, (size_t)p.ids[corner[c]]);
      is_tame &= fabs(value[c]) <= CHI_HISTOGRAM_LARGEST;
    }
    chi_histogram_add_triangle(block, x, value, is_turned ? -1 : 1);
    sum += block->mass[block->count - 1];
    block->count -= (size_t)are_cells; /* all of the cell is one entry */
  }
  if (!is_tame)
  {
    block->count = before;
    return CHI_CELL_NON_FINITE;
  }
  if (are_cells)
  {
    block->value[0][before] = of_cell;
    block->mass[before] = sum;
    block->area[before] = 0;
    block->count = before + 1;
  }
  return CHI_CELL_GOOD;
}
