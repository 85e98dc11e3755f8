/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Run time against error of continuous scatterplots' options, on Marschner & Lobb's signal and the
 * distance from the centre: trilinear cells of an image subdivided to tolerances, against four
 * levels everywhere (`trilinear`, the sum of |bin - reference| over the mass), and the same image
 * as hexahedra; small cells deposited by their mean (`splat`, the same sum against exact bins, and
 * `splat bound`, the bound that is reported). n is the number of cells. Two threads. Prints CSV.
 */

#include "chi_bench.h"
#include "scatterplot_waves.h"

#include <chiaroscuro/chi_scatterplot.h>

typedef struct scene
{
  chi_grid_view image, list; /* cells, and hexahedra */
  double *f, *g, *points;
  size_t cells;
} scene;

static scene make_scene(size_t n)
{
  static const size_t around[8] = { 0, 1, 3, 2, 4, 5, 7, 6 };
  const size_t p = n + 1, points = p * p * p;
  scene s = { .f = chi_bench_room(points, 8),
    .g = chi_bench_room(points, 8),
    .points = chi_bench_room(points, 24),
    .cells = n * n * n };
  for (size_t i = 0; i < points; ++i)
  {
    const size_t k[3] = { i % p, i / p % p, i / (p * p) };
    double value[2];
    for (int a = 0; a < 3; ++a)
    {
      s.points[3 * i + (size_t)a] = 2 * (double)k[a] / (double)n - 1;
    }
    waves_values(s.points + 3 * i, value);
    s.f[i] = value[0];
    s.g[i] = value[1];
  }
  const double h = 2 / (double)n;
  s.image = (chi_grid_view){ .struct_size = sizeof s.image,
    .kind = CHI_GRID_IMAGE,
    .dimensions = { p, p, p },
    .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 } };
  int64_t* const ids = chi_bench_room(8 * s.cells, 8);
  int64_t* const offsets = chi_bench_room(s.cells + 1, 8);
  uint8_t* const types = chi_bench_room(s.cells, 1);
  memset(types, 12, s.cells);
  for (size_t c = 0; c <= s.cells; ++c)
  {
    const size_t first = c % n + p * (c / n % n + p * (c / (n * n)));
    offsets[c] = (int64_t)(8 * c);
    for (size_t k = 0; k < 8 && c < s.cells; ++k)
    {
      const size_t b = around[k];
      ids[8 * c + k] = (int64_t)(first + (b & 1) + p * ((b >> 1 & 1) + p * (b >> 2)));
    }
  }
  s.list = (chi_grid_view){ .struct_size = sizeof s.list,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { s.points, points, 24, CHI_F64 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = s.cells,
    .connectivity_count = 8 * s.cells };
  return s;
}

static void free_scene(scene* s)
{
  free(s->f);
  free(s->g);
  free(s->points);
  free((void*)s->list.connectivity);
  free((void*)s->list.offsets);
  free((void*)s->list.cell_types);
}

static const double range[2][2] = { { 0, 1 }, { 0, 1.7320508075688774 } };

/* The least time of `runs`, and the sum of differences from the reference over the mass. */
static double plot(const scene* s, const chi_grid_view* grid, chi_scatterplot_params params,
  int runs, const double* reference, double* density, double* error, double* bound)
{
  chi_bench_pool pool = { 2 };
  const chi_exec exec = chi_bench_exec(&pool);
  const size_t points = s->list.points.count, bins = params.bins[0] * params.bins[1];
  const chi_scatterplot_input input = { .struct_size = sizeof input,
    .grid = grid,
    .fields = { { s->f, points, 1, 8, CHI_F64 }, { s->g, points, 1, 8, CHI_F64 } } };
  chi_scatterplot_result r = { 0 };
  double best = INFINITY, l1 = 0;
  memcpy(params.range, range, sizeof range);
  for (int i = 0; i < runs; ++i)
  {
    chi_scatterplot* handle;
    chi_bench_must(chi_scatterplot_create(&exec, &handle) == CHI_OK, "create");
    const double start = chi_bench_now();
    chi_bench_must(
      chi_scatterplot_compute(&exec, handle, &input, &params, density, &r) == CHI_OK, "compute");
    best = fmin(best, chi_bench_now() - start);
    chi_scatterplot_destroy(handle);
  }
  for (size_t i = 0; i < bins && reference; ++i)
  {
    l1 += fabs(density[i] - reference[i]) * range[0][1] * range[1][1] / (double)bins;
  }
  *error = l1 / r.total_mass;
  *bound = r.splat_bound / r.total_mass;
  return best;
}

static void run_tolerances(size_t n, size_t bins)
{
  static const double tolerances[] = { 0, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4 };
  scene s = make_scene(n);
  double *const reference = chi_bench_room(bins * bins, 8),
                *const density = chi_bench_room(bins * bins, 8);
  double error, bound;
  chi_scatterplot_params params = {
    .struct_size = sizeof params, .bins = { bins, bins }, .trilinear_tolerance = 1e-9
  };
  plot(&s, &s.image, params, 1, NULL, reference, &error, &bound);
  for (int k = 0; k < 2 * 6; ++k)
  {
    params.trilinear_tolerance = tolerances[k / 2];
    const double ns = plot(
      &s, k % 2 ? &s.list : &s.image, params, CHI_BENCH_RUNS, reference, density, &error, &bound);
    printf("scatterplot_error,%s,subdivided,%zu^2 bins tolerance %g,%zu,2,%.0f,%.3g,trilinear\n",
      k % 2 ? "hexahedra" : "image", bins, tolerances[k / 2], s.cells, ns, error);
    fflush(stdout);
  }
  free(reference);
  free(density);
  free_scene(&s);
}

/* A field whose cells are small against a bin, and one whose are not. */
static void run_splats(size_t n, size_t bins)
{
  static const double sizes[] = { 0, 0.25, 0.5, 1 };
  scene s = make_scene(n);
  double *const exact = chi_bench_room(bins * bins, 8),
                *const density = chi_bench_room(bins * bins, 8);
  for (int smooth = 0; smooth < 2; ++smooth)
  {
    for (size_t i = 0; i < s.list.points.count && smooth; ++i)
    {
      const double* const x = s.points + 3 * i;
      s.f[i] = 0.5 + 0.3 * sin(2 * x[0]) * cos(x[1]) + 0.1 * x[2];
      s.g[i] = sqrt(0.1 + x[0] * x[0] + x[1] * x[1] + x[2] * x[2] / 2);
    }
    for (int k = 0; k < 4; ++k)
    {
      double error, bound;
      chi_scatterplot_params params = {
        .struct_size = sizeof params, .bins = { bins, bins }, .splat_size = sizes[k]
      };
      double* const out = k ? density : exact;
      const double ns =
        plot(&s, &s.image, params, CHI_BENCH_RUNS, k ? exact : NULL, out, &error, &bound);
      const char* const name = smooth ? "smooth" : "image";
      printf("scatterplot_error,%s,splat,%zu^2 bins size %g,%zu,2,%.0f,%.3g,splat\n", name, bins,
        sizes[k], s.cells, ns, error);
      printf("scatterplot_error,%s,splat,%zu^2 bins size %g,%zu,2,%.0f,%.3g,splat bound\n", name,
        bins, sizes[k], s.cells, ns, bound);
    }
  }
  free(exact);
  free(density);
  free_scene(&s);
}

int main(int argc, char** argv)
{
  const int splats_only = argc > 1 && strcmp(argv[1], "splat") == 0;
  printf(CHI_BENCH_HEADER);
  if (!splats_only)
  {
    run_tolerances(24, 64);
    run_tolerances(24, 256);
  }
  run_splats(96, 16);
  run_splats(96, 64);
  return 0;
}
