/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Fields from derivatives of a signal like that of Marschner and Lobb in float, run time against
 * error: the gradient's magnitude alone and all four fields, of order 2 and 4, on images and on the
 * same points as other grids. n is the number of points; the error is the mean one of the first
 * field over its range. Beside them what memory gives: a triad, whose error column is its
 * bandwidth in GB/s. Prints CSV.
 */

#include "chi_bench.h"
#include "derived_fields.h"

/* A grid over the points of an image, its field in float. */
typedef struct bench_grid
{
  const char* name;
  chi_grid_view view;
  size_t points;
  double* x; /* NULL: follow from the image */
  size_t n;
} bench_grid;

static void place(const bench_grid* g, size_t i, double x[3])
{
  const double h = 1.6 / (double)(g->n - 1);
  for (int a = 0; a < 3; ++a, i /= g->n)
  {
    x[a] = h * (double)(i % g->n) - 0.8;
  }
}

static void where(const bench_grid* g, size_t i, double x[3])
{
  if (g->x)
  {
    memcpy(x, g->x + 3 * i, 3 * sizeof *x);
  }
  else
  {
    place(g, i, x);
  }
}

static double mean_error(const bench_grid* g, const float* found)
{
  double sum = 0, low = INFINITY, high = -INFINITY;
  size_t count = 0;
  for (size_t i = 0; i < g->points; i += 1 + g->points / 1000000, ++count)
  {
    double x[3], exact[ALL];
    where(g, i, x);
    const jet j = marschner_lobb(x);
    derive_exactly(&j, exact);
    sum += fabs((double)found[i] - exact[0]);
    low = fmin(low, exact[0]);
    high = fmax(high, exact[0]);
  }
  return sum / (double)count / (high - low);
}

static void run(const bench_grid* g, int most_threads)
{
  float* const values = derived_room(g->points * sizeof *values);
  float* out[ALL];
  for (size_t i = 0; i < g->points; ++i)
  {
    double x[3];
    where(g, i, x);
    values[i] = (float)marschner_lobb(x).value;
  }
  for (int k = 0; k < ALL; ++k)
  {
    out[k] = derived_room(g->points * sizeof(float));
    memset(out[k], 0, g->points * sizeof(float));
  }
  const chi_array_view view = { values, g->points, 1, sizeof(float), CHI_F32 };
  for (int order = 2; order <= (g->view.kind == CHI_GRID_UNSTRUCTURED ? 2 : 4); order += 2)
  {
    for (int all = 0; all < 2; ++all)
    {
      const chi_derived_params params = { sizeof params, order, 0 };
      const chi_derived_arrays arrays = { sizeof arrays, CHI_F32, 0, out[0], all ? out[1] : NULL,
        all ? out[2] : NULL, all ? out[3] : NULL };
      for (int threads = 1; threads <= most_threads; ++threads)
      {
        chi_bench_pool pool = { threads };
        const chi_exec exec = chi_bench_exec(&pool);
        chi_derived_counts counts;
        double best = INFINITY;
        for (int i = 0; i < CHI_BENCH_RUNS; ++i)
        {
          const double start = chi_bench_now();
          chi_bench_must(
            chi_derived_compute(&exec, &g->view, &view, &params, &arrays, &counts) == CHI_OK,
            "chi_derived_compute");
          best = fmin(best, chi_bench_now() - start);
        }
        printf("derived,%s,%s,order %d,%zu,%d,%.0f,%.3g,mean of |grad f| over its range\n", g->name,
          all ? "all four" : "gradient magnitude", order, g->points, threads, best,
          mean_error(g, out[0]));
        fflush(stdout);
      }
    }
  }
  free(values);
  for (int k = 0; k < ALL; ++k)
  {
    free(out[k]);
  }
}

static void run_kinds(size_t n, int with_points)
{
  const double h = 1.6 / (double)(n - 1);
  bench_grid g = { .name = "image",
    .points = n * n * n,
    .n = n,
    .view = { .struct_size = sizeof g.view,
      .kind = CHI_GRID_IMAGE,
      .dimensions = { n, n, n },
      .index_to_world = { h, 0, 0, -0.8, 0, h, 0, -0.8, 0, 0, h, -0.8, 0, 0, 0, 1 } } };
  run(&g, 2);
  if (!with_points)
  {
    return;
  }
  const bench_grid image = g;
  double* const axis = derived_room(n * sizeof *axis);
  for (size_t i = 0; i < n; ++i)
  {
    axis[i] = h * (double)i - 0.8;
  }
  g.name = "rectilinear";
  g.view.kind = CHI_GRID_RECTILINEAR;
  for (int a = 0; a < 3; ++a)
  {
    g.view.axes[a] = (chi_array_view){ axis, n, 1, sizeof(double), CHI_F64 };
  }
  run(&g, 2);
  g.name = "curvilinear";
  g.view.kind = CHI_GRID_CURVILINEAR;
  double* const points = derived_room(3 * g.points * sizeof *points);
  for (size_t i = 0; i < g.points; ++i)
  {
    double* const x = points + 3 * i;
    place(&image, i, x);
    const double old[2] = { x[0], x[1] };
    x[0] += 0.05 * sin(3 * old[1]);
    x[1] += 0.05 * sin(3 * x[2]);
    x[2] += 0.05 * sin(3 * old[0]);
  }
  g.x = points;
  g.view.points = (chi_vec3_view){ points, g.points, 3 * sizeof(double), CHI_F64 };
  run(&g, 2);
  g.name = "tetrahedra";
  chi_grid_counts counts;
  chi_bench_must(chi_grid_count(NULL, &image.view, &counts) == CHI_OK, "chi_grid_count");
  uint32_t* const vertices = derived_room(4 * counts.tetrahedra * sizeof *vertices);
  int64_t* const ids = derived_room(4 * counts.tetrahedra * sizeof *ids);
  int64_t* const offsets = derived_room((counts.tetrahedra + 1) * sizeof *offsets);
  uint8_t* const types = derived_room(counts.tetrahedra);
  const chi_grid_tetrahedra split = { .struct_size = sizeof split, .vertices = vertices };
  chi_bench_must(chi_grid_split(NULL, &image.view, &counts, &split) == CHI_OK, "chi_grid_split");
  for (size_t t = 0; t <= counts.tetrahedra; ++t)
  {
    offsets[t] = (int64_t)(4 * t);
    for (size_t k = 0; k < 4 && t < counts.tetrahedra; ++k)
    {
      types[t] = 10;
      ids[4 * t + k] = vertices[4 * t + k];
    }
  }
  g.view.kind = CHI_GRID_UNSTRUCTURED;
  g.view.cell_types = types;
  g.view.offsets = offsets;
  g.view.connectivity = ids;
  g.view.cell_count = counts.tetrahedra;
  g.view.connectivity_count = 4 * counts.tetrahedra;
  run(&g, 2);
  free(axis);
  free(points);
  free(vertices);
  free(ids);
  free(offsets);
  free(types);
}

int main(void)
{
  printf(CHI_BENCH_HEADER);
  for (int threads = 1; threads <= 2; ++threads)
  {
    chi_bench_triad("derived", threads);
  }
  run_kinds(32, 1);
  run_kinds(64, 1);
  run_kinds(128, 0);
  run_kinds(256, 0);
  chi_bench_triad("derived", 2);
  return 0;
}
