/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Cells of two dimensions: their triangles into the block, or their area. */

#include "chi_scatterplot_internal.h"

int chi_scatter_measure_polygon(
  const chi_scatter_job* job, size_t index, double* area, double* weight)
{
  chi_grid_polygon p;
  const int found = chi_polygon_read(&job->grid, index, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  const int is_finite = chi_polygon_locate(&job->grid, &p);
  *area = 0;
  for (size_t t = 0; t < p.triangles; ++t)
  {
    double x[3][3];
    *area += chi_polygon_area(&job->grid, &p, t, x);
  }
  *weight = chi_scatter_weight(job, index, p.ids, p.count);
  return is_finite ? CHI_CELL_GOOD : CHI_CELL_NON_FINITE;
}

int chi_scatter_add_polygon(chi_scatter_job* job, chi_scatter_worker* w, size_t index)
{
  chi_scatter_block* const b = &w->block;
  chi_grid_polygon p;
  const int found = chi_polygon_read(&job->grid, index, &p);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  if (!chi_polygon_locate(&job->grid, &p))
  {
    return CHI_CELL_NON_FINITE;
  }
  const double weight = chi_scatter_weight(job, index, p.ids, p.count);
  for (size_t t = 0; t < p.triangles; ++t)
  {
    size_t k[3];
    double x[3][3];
    chi_polygon_triangle(&p, t, k);
    for (size_t c = 0; c < 4; ++c)
    {
      b->ids[c * b->capacity + b->count] = (uint32_t)p.ids[k[c < 3 ? c : 2]];
    }
    b->mass[b->count] = chi_polygon_area(&job->grid, &p, t, x) * weight;
    b->cell[b->count++] = (uint32_t)index;
  }
  return CHI_CELL_GOOD;
}
