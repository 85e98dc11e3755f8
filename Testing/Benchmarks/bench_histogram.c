/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Continuous histograms of Marschner & Lobb's signal on 0.2, 1.6 and 12.6 million tetrahedra, an
 * image and its split as a list: 64, 256 and 1024 bins, one thread and two, from nothing and with
 * ranges and moments kept; a quantile; a narrow window and a field that is constant in places, with
 * what is skipped and without. n in the output is the number of tetrahedra. Errors: `mass`, |bins
 * and what is beyond - volume| / volume; `method`, the sum of |bin - exact| over the volume, exact
 * in long double on the smallest mesh; `share`, what a quantile misses. Arguments: the largest
 * grid, in cells along an axis. Prints CSV.
 */

#include "chi_bench.h"
#include "histogram_scene.h"

typedef struct scene
{
  chi_grid_view grids[2]; /* an image, its split as a list */
  double* values;
  size_t points;
  split parts;
} scene;

/* Marschner & Lobb 1994, Eq. 1, over [-1, 1]^3: alpha 0.25, f_M 6. */
static double signal(const double x[3])
{
  const double pi = 3.14159265358979323846;
  const double rho = cos(2 * pi * 6 * cos(pi * hypot(x[0], x[1]) / 2));
  return (1 - sin(pi * x[2] / 2) + 0.25 * (1 + rho)) / (2 * 1.25);
}

static scene make_scene(size_t n)
{
  const size_t p = n + 1;
  const double h = 2 / (double)n;
  scene s = { .points = p * p * p };
  s.grids[0] = (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { p, p, p },
    .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 },
    .version = 1 };
  chi_bench_must(make_split(&s.parts, NULL, s.grids) == CHI_OK, "split");
  s.values = chi_bench_room(s.points, sizeof(double));
  for (size_t i = 0; i < s.points; ++i)
  {
    s.values[i] = signal(s.parts.points[i]);
  }
  const size_t count = s.parts.counts.tetrahedra;
  int64_t* const ids = chi_bench_room(4 * count, sizeof *ids);
  int64_t* const offsets = chi_bench_room(count + 1, sizeof *offsets);
  uint8_t* const types = chi_bench_room(count, 1);
  memset(types, 10, count);
  for (size_t i = 0; i <= 4 * count; ++i)
  {
    offsets[i / 4] = i % 4 ? offsets[i / 4] : (int64_t)i;
    if (i < 4 * count)
    {
      ids[i] = s.parts.vertices[i / 4][i % 4];
    }
  }
  s.grids[1] = (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { s.parts.points, s.points, 3 * sizeof(double), CHI_F64 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = count,
    .connectivity_count = 4 * count,
    .version = 2 };
  return s;
}

static void drop_scene(scene* s)
{
  free((void*)s->grids[1].cell_types);
  free((void*)s->grids[1].offsets);
  free((void*)s->grids[1].connectivity);
  free(s->values);
  drop_split(&s->parts);
}

static double method_error(const scene* s, const bins* b)
{
  long double *const mass = chi_bench_room(2 * b->count, sizeof *mass),
                     *const area = mass + b->count;
  long double sum = 0;
  const double* const range = b->result.range;
  reference_bins(&s->parts, s->values, b->count, range[0], range[1], mass, area);
  for (size_t i = 0; i < b->count; ++i)
  {
    sum += fabsl(b->mass[i] - mass[i]);
  }
  free(mass);
  return (double)(sum / b->result.total_mass);
}

static void print(const scene* s, const char* of, const char* method, size_t parameter, int threads,
  double ns, double error, const char* kind)
{
  printf("histogram,%s,%s,%zu,%zu,%d,%.0f,%.3g,%s\n", of, method, parameter,
    s->parts.counts.tetrahedra, threads, ns, error, kind);
  fflush(stdout);
}

/* The shortest of some first and second calls. */
static void time_calls(const chi_exec* exec, const chi_grid_view* grid,
  const chi_histogram_params* params, bins* b, double ns[2])
{
  ns[0] = ns[1] = INFINITY;
  for (int i = 0; i < CHI_BENCH_RUNS; ++i)
  {
    chi_histogram* h = NULL;
    chi_bench_must(chi_histogram_create(exec, &h) == CHI_OK, "create");
    for (int k = 0; k < 2; ++k)
    {
      const double start = chi_bench_now();
      chi_bench_must(make_bins(b, exec, h, grid, params) == CHI_OK, "compute");
      ns[k] = fmin(ns[k], chi_bench_now() - start);
      if (i + 1 < CHI_BENCH_RUNS || k == 0)
      {
        drop_bins(b);
      }
    }
    chi_histogram_destroy(exec, h);
  }
}

static void run(const scene* s, int is_small)
{
  const chi_array_view field = view_values(s->values, s->points);
  for (int g = 0; g < 2; ++g)
  {
    const char* const name = g ? "list" : "image";
    for (int threads = 1; threads <= 2; ++threads)
    {
      chi_bench_pool pool = { threads };
      const chi_exec exec = chi_bench_exec(&pool);
      for (size_t count = 64; count <= 1024; count *= 4)
      {
        chi_histogram_params params = histogram_params(&field, count, 0, 1);
        params.automatic_range = 1;
        params.field_version = 1;
        params.moments = 4;
        bins b;
        double ns[2];
        time_calls(&exec, s->grids + g, &params, &b, ns);
        const double volume = 8, missed = fabs((double)(sum_of(&b) - volume)) / volume;
        print(s, name, "first call", count, threads, ns[0], missed, "mass");
        print(s, name, "again", count, threads, ns[1], is_small ? method_error(s, &b) : missed,
          is_small ? "method" : "mass");
        drop_bins(&b);
      }
    }
  }
}

static void run_quantile(const scene* s)
{
  const chi_array_view field = view_values(s->values, s->points);
  chi_bench_pool pool = { 2 };
  const chi_exec exec = chi_bench_exec(&pool);
  chi_histogram_params params = histogram_params(&field, 1, 0, 1);
  chi_histogram* h = NULL;
  bins b;
  double first = 0, best = INFINITY, median = 0;
  chi_bench_must(chi_histogram_create(&exec, &h) == CHI_OK, "create");
  chi_bench_must(make_bins(&b, &exec, h, s->grids, &params) == CHI_OK, "compute");
  drop_bins(&b);
  for (int i = 0; i <= CHI_BENCH_RUNS; ++i)
  {
    const double start = chi_bench_now();
    chi_bench_must(chi_histogram_quantile(&exec, h, 0.5, &median) == CHI_OK, "quantile");
    const double took = chi_bench_now() - start;
    first = i == 0 ? took : first;
    best = i > 0 ? fmin(best, took) : best;
  }
  params.range[0] = median; /* what lies below is half */
  chi_bench_must(make_bins(&b, &exec, h, s->grids, &params) == CHI_OK, "compute");
  const double missed = fabs(b.result.mass_below / b.result.total_mass - 0.5);
  print(s, "image", "first quantile", 2, 2, first, missed, "share");
  print(s, "image", "further quantile", 2, 2, best, missed, "share");
  drop_bins(&b);
  chi_histogram_destroy(&exec, h);
}

/* A window of a hundredth of the range; and a field that is cut off at its middle. */
static void run_skipping(const scene* s)
{
  double* const cut = chi_bench_room(s->points, sizeof *cut);
  for (size_t i = 0; i < s->points; ++i)
  {
    cut[i] = fmax(s->values[i] - 0.5, 0);
  }
  const chi_array_view fields[2] = { view_values(s->values, s->points),
    view_values(cut, s->points) };
  static const char* const names[2] = { "window of 1/100", "half constant" };
  chi_bench_pool pool = { 2 };
  const chi_exec exec = chi_bench_exec(&pool);
  for (int k = 0; k < 2; ++k)
  {
    bins with = { 0 };
    for (int without = 0; without < 2; ++without)
    {
      chi_histogram_params params = histogram_params(fields + k, 256, 0, 0.5);
      if (k == 0)
      {
        params.range[0] = 0.05;
        params.range[1] = 0.06;
      }
      params.field_version = 1;
      params.moments = 4;
      params.no_skipping = without ? CHI_HISTOGRAM_SKIP_OUTSIDE | CHI_HISTOGRAM_SKIP_ONE_BIN : 0;
      bins b;
      double ns[2], apart = 0;
      time_calls(&exec, s->grids, &params, &b, ns);
      for (size_t i = 0; i < b.count && without; ++i)
      {
        apart += fabs(b.mass[i] - with.mass[i]) / b.result.total_mass;
      }
      const size_t skipped = (size_t)(b.result.skipped[0] + b.result.skipped[1]);
      print(s, names[k], without ? "nothing skipped" : "bricks skipped", skipped, 2, ns[1], apart,
        "difference");
      if (without)
      {
        drop_bins(&with);
        drop_bins(&b);
      }
      else
      {
        with = b;
      }
    }
  }
  free(cut);
}

int main(int argc, char** argv)
{
  const size_t largest = argc > 1 ? (size_t)strtoull(argv[1], NULL, 10) : 128;
  printf(CHI_BENCH_HEADER);
  for (size_t n = 32; n <= largest; n *= 2)
  {
    scene s = make_scene(n);
    run(&s, n == 32);
    run_quantile(&s);
    run_skipping(&s);
    drop_scene(&s);
  }
  return 0;
}
