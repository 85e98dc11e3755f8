/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_SCENE_H
#define CHI_SCATTERPLOT_SCENE_H

/* Images with two fields, the same as lists of tetrahedra, and plots of them. */

#include <chiaroscuro/chi_scatterplot.h>

#include "chi_test.h"
#include "scatterplot_reference.h"

typedef struct scene
{
  chi_grid_view grid;
  chi_scatterplot_input input;
  double *f, *g, *points;
  int64_t *offsets, *ids;
  uint8_t* types;
  chi_grid_counts counts;
  uint32_t* vertices;
} scene;

typedef void (*scene_field)(const double x[3], double value[2]);

/* An image of n cells along each axis over the box from `low` to `high`. */
__attribute__((unused)) static scene* scene_image(
  const size_t n[3], const double low[3], const double high[3], scene_field field)
{
  scene* const s = (scene*)calloc(1, sizeof *s);
  s->grid = (chi_grid_view){ .struct_size = sizeof s->grid, .kind = CHI_GRID_IMAGE };
  s->grid.index_to_world[15] = 1;
  size_t count = 1;
  for (int a = 0; a < 3; ++a)
  {
    s->grid.dimensions[a] = n[a] + 1;
    s->grid.index_to_world[5 * a] = n[a] ? (high[a] - low[a]) / (double)n[a] : 1;
    s->grid.index_to_world[4 * a + 3] = low[a];
    count *= n[a] + 1;
  }
  s->f = (double*)malloc(count * sizeof(double));
  s->g = (double*)malloc(count * sizeof(double));
  s->points = (double*)malloc(count * 3 * sizeof(double));
  for (size_t i = 0; i < count; ++i)
  {
    const size_t k[3] = { i % (n[0] + 1), i / (n[0] + 1) % (n[1] + 1),
      i / ((n[0] + 1) * (n[1] + 1)) };
    double value[2];
    for (int a = 0; a < 3; ++a)
    {
      s->points[3 * i + (size_t)a] =
        n[a] ? low[a] + (high[a] - low[a]) * (double)k[a] / (double)n[a] : low[a];
    }
    field(s->points + 3 * i, value);
    s->f[i] = value[0];
    s->g[i] = value[1];
  }
  s->input = (chi_scatterplot_input){ .struct_size = sizeof s->input,
    .grid = &s->grid,
    .fields = {
      { s->f, count, 1, sizeof(double), CHI_F64 }, { s->g, count, 1, sizeof(double), CHI_F64 } } };
  s->counts.struct_size = sizeof s->counts;
  if (n[0] && n[1] && n[2])
  {
    CHECK(chi_grid_count(NULL, &s->grid, &s->counts) == CHI_OK);
    s->vertices = (uint32_t*)malloc(s->counts.tetrahedra * 16);
    const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = s->vertices };
    CHECK(chi_grid_split(NULL, &s->grid, &s->counts, &out) == CHI_OK);
  }
  return s;
}

/* The image's tetrahedra as an unstructured grid, shuffled where a seed is given. */
__attribute__((unused)) static void scene_to_list(scene* s, uint32_t seed)
{
  const size_t count = s->counts.tetrahedra;
  s->offsets = (int64_t*)malloc((count + 1) * sizeof(int64_t));
  s->ids = (int64_t*)malloc(count * 4 * sizeof(int64_t));
  s->types = (uint8_t*)malloc(count + 1);
  for (size_t t = count; t-- > 1 && seed;)
  {
    const size_t other = (size_t)(chi_test_random(&seed) * (double)(t + 1));
    uint32_t keep[4];
    memcpy(keep, s->vertices + 4 * t, 16);
    memcpy(s->vertices + 4 * t, s->vertices + 4 * other, 16);
    memcpy(s->vertices + 4 * other, keep, 16);
  }
  for (size_t i = 0; i < 4 * count; ++i)
  {
    s->ids[i] = s->vertices[i];
  }
  for (size_t t = 0; t <= count; ++t)
  {
    s->offsets[t] = (int64_t)(4 * t);
    s->types[t] = 10;
  }
  s->grid = (chi_grid_view){ .struct_size = sizeof s->grid,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { s->points, s->input.fields[0].count, 3 * sizeof(double), CHI_F64 },
    .cell_types = s->types,
    .offsets = s->offsets,
    .connectivity = s->ids,
    .cell_count = count,
    .connectivity_count = 4 * count };
}

__attribute__((unused)) static void scene_free(scene* s)
{
  free(s->f);
  free(s->g);
  free(s->points);
  free(s->offsets);
  free(s->ids);
  free(s->types);
  free(s->vertices);
  free(s);
}

__attribute__((unused)) static chi_scatterplot_params scene_params(
  size_t nx, size_t ny, double x0, double x1, double y0, double y1)
{
  return (chi_scatterplot_params){ .struct_size = sizeof(chi_scatterplot_params),
    .bins = { nx, ny },
    .range = { { x0, x1 }, { y0, y1 } } };
}

/* Densities, to be freed. */
__attribute__((unused)) static double* scene_plot(const chi_exec* exec, const scene* s,
  const chi_scatterplot_params* params, chi_scatterplot_result* result)
{
  chi_scatterplot* plot = NULL;
  double* const density = (double*)malloc(params->bins[0] * params->bins[1] * sizeof(double));
  CHECK(chi_scatterplot_create(exec, &plot) == CHI_OK);
  CHECK(chi_scatterplot_compute(exec, plot, &s->input, params, density, result) == CHI_OK);
  chi_scatterplot_destroy(plot);
  return density;
}

/* Sum of the bins and of what is beyond, relative to the volume. */
__attribute__((unused)) static double scene_mass_error(
  const double* density, const chi_scatterplot_result* r, size_t nx, size_t ny, double volume)
{
  const double area = (r->range[0][1] - r->range[0][0]) / (double)nx *
    ((r->range[1][1] - r->range[1][0]) / (double)ny);
  long double sum = 0;
  for (size_t i = 0; i < nx * ny; ++i)
  {
    sum += density[i] * (long double)area;
  }
  return fabs((double)(sum + r->mass_out_of_range - volume)) / fabs(volume);
}

/* One tetrahedron of the library's choice of shape. */
__attribute__((unused)) static double* scene_plot_one(const double f[4], const double g[4],
  double volume, const chi_scatterplot_params* params, chi_scatterplot_result* r)
{
  const double points[4][3] = { { 0, 0, 0 }, { 6 * volume, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  static const int64_t ids[4] = { 0, 1, 2, 3 }, offsets[2] = { 0, 4 };
  static const uint8_t type[1] = { 10 };
  const chi_grid_view grid = { .struct_size = sizeof grid,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { points, 4, 3 * sizeof(double), CHI_F64 },
    .cell_types = type,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = 1,
    .connectivity_count = 4 };
  scene s = { .grid = grid,
    .input = { .struct_size = sizeof s.input,
      .grid = &s.grid,
      .fields = { { f, 4, 1, sizeof(double), CHI_F64 }, { g, 4, 1, sizeof(double), CHI_F64 } } } };
  return scene_plot(NULL, &s, params, r);
}

#endif
