/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cells of two dimensions: their triangles into the block, or their area. */

#include "chi_histogram_internal.h"

#include <math.h>

/* All of a cell with a field of cells is one entry. */
static int add_constant(const chi_histogram_plan* plan, size_t index, const chi_grid_polygon* p,
  chi_histogram_block* block)
{
  const double value = chi_histogram_value(plan, index);
  double sum = 0, x[3][3];
  if (!(fabs(value) <= CHI_HISTOGRAM_LARGEST))
  {
    return CHI_CELL_NON_FINITE;
  }
  for (size_t t = 0; t < p->triangles; ++t)
  {
    sum += chi_polygon_area(&plan->grid, p, t, x);
  }
  block->value[0][block->count] = value;
  block->mass[block->count] = sum;
  block->area[block->count++] = 0;
  return CHI_CELL_GOOD;
}

int chi_histogram_add_polygon(
  const chi_histogram_plan* plan, size_t index, chi_histogram_block* block)
{
  chi_grid_polygon p;
  const int found = chi_polygon_read(&plan->grid, index, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  if (!chi_polygon_locate(&plan->grid, &p))
  {
    return CHI_CELL_NON_FINITE;
  }
  if (plan->association == CHI_HISTOGRAM_CELLS)
  {
    return add_constant(plan, index, &p, block);
  }
  const size_t before = block->count;
  for (size_t t = 0; t < p.triangles; ++t)
  {
    double x[3][3], value[3];
    size_t corner[3];
    const double area = chi_polygon_area(&plan->grid, &p, t, x);
    int is_tame = 1;
    chi_polygon_triangle(&p, t, corner);
    for (int c = 0; c < 3; ++c)
    {
      value[c] = chi_histogram_value(plan, (size_t)p.ids[corner[c]]);
      is_tame &= fabs(value[c]) <= CHI_HISTOGRAM_LARGEST;
    }
    if (!is_tame)
    {
      block->count = before;
      return CHI_CELL_NON_FINITE;
    }
    chi_histogram_add_triangle(block, x, value, area < 0 ? -1 : 1);
  }
  return CHI_CELL_GOOD;
}
