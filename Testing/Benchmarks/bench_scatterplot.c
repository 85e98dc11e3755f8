/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Continuous scatterplots of Marschner & Lobb's signal and the distance from the centre, on
 * 0.2, 1.6 and 12.6 million tetrahedra: an image, its split as a list, and that list in random
 * order; 64^2, 256^2 and 1024^2 bins, one thread and two, each plot from nothing. n in the output
 * is the number of tetrahedra. Errors: `mass`, |mass - volume| / volume; `method`, the sum of |bin
 * - exact| over the mass, exact by cutting in long double on the smallest mesh; `mesh`, the same
 * sum against the signal itself, by quadrature: the error of fields that are linear in each
 * tetrahedron, not of the plot. The first lines are the machine's triad, whose error column is its
 * bandwidth in GB/s: to compare machines, `rate` is what two threads reach, in million tetrahedra a
 * second, scaled by it to 47 GB/s. Prints CSV.
 */

#include "chi_bench.h"
#include "scatterplot_reference.h"
#include "scatterplot_waves.h"

#include <chiaroscuro/chi_scatterplot.h>

#include <math.h>
#include <string.h>

typedef struct scene
{
  chi_grid_view image, list;
  double *f, *g, *points;
  uint32_t* vertices;
  size_t count; /* tetrahedra */
} scene;

/* Marschner & Lobb 1994 over [-1, 1]^3. */
static scene make_scene(size_t n)
{
  const double pi = 3.14159265358979323846;
  const size_t p = n + 1, points = p * p * p;
  scene s = { .f = chi_bench_room(points, 8),
    .g = chi_bench_room(points, 8),
    .points = chi_bench_room(points, 24) };
  for (size_t i = 0; i < points; ++i)
  {
    const size_t k[3] = { i % p, i / p % p, i / (p * p) };
    double* const x = s.points + 3 * i;
    for (int a = 0; a < 3; ++a)
    {
      x[a] = 2 * (double)k[a] / (double)n - 1;
    }
    const double rho = cos(12 * pi * cos(pi * sqrt(x[0] * x[0] + x[1] * x[1]) / 2));
    s.f[i] = (1 - sin(pi * x[2] / 2) + 0.25 * (1 + rho)) / 2.5;
    s.g[i] = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
  }
  const double h = 2 / (double)n;
  s.image = (chi_grid_view){ .struct_size = sizeof s.image,
    .kind = CHI_GRID_IMAGE,
    .dimensions = { p, p, p },
    .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 } };
  chi_grid_counts counts = { .struct_size = sizeof counts };
  chi_bench_must(chi_grid_count(NULL, &s.image, &counts) == CHI_OK, "count");
  s.count = counts.tetrahedra;
  s.vertices = chi_bench_room(s.count, 16);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = s.vertices };
  chi_bench_must(chi_grid_split(NULL, &s.image, &counts, &out) == CHI_OK, "split");
  int64_t* const ids = chi_bench_room(4 * s.count, 8);
  int64_t* const offsets = chi_bench_room(s.count + 1, 8);
  uint8_t* const types = chi_bench_room(s.count, 1);
  memset(types, 10, s.count);
  for (size_t t = 0; t <= s.count; ++t)
  {
    offsets[t] = (int64_t)(4 * t);
  }
  s.list = (chi_grid_view){ .struct_size = sizeof s.list,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { s.points, points, 24, CHI_F64 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = s.count,
    .connectivity_count = 4 * s.count };
  return s;
}

static void fill_list(scene* s, int is_shuffled)
{
  int64_t* const ids = (int64_t*)s->list.connectivity;
  uint64_t state = 88172645463325252u; /* xorshift64 */
  for (size_t t = s->count; t-- > 1 && is_shuffled;)
  {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    const size_t other = (size_t)(state % (t + 1));
    uint32_t keep[4];
    memcpy(keep, s->vertices + 4 * t, 16);
    memcpy(s->vertices + 4 * t, s->vertices + 4 * other, 16);
    memcpy(s->vertices + 4 * other, keep, 16);
  }
  for (size_t i = 0; i < 4 * s->count; ++i)
  {
    ids[i] = s->vertices[i];
  }
}

static double bandwidth = 47; /* of two threads */

static const double range[2][2] = { { 0, 1 }, { 0, 1.7320508075688774 } };

static long double* exact_masses(const scene* s, size_t bins)
{
  ref_plot ref = { .bins = { bins, bins } };
  memcpy(ref.range, range, sizeof range);
  ref.mass = calloc(bins * bins, sizeof *ref.mass);
  for (size_t t = 0; t < s->count; ++t)
  {
    double f[4], g[4];
    for (size_t c = 0; c < 4; ++c)
    {
      f[c] = s->f[s->vertices[4 * t + c]];
      g[c] = s->g[s->vertices[4 * t + c]];
    }
    ref_deposit(&ref, 4, f, g, 8.0L / (long double)s->count);
  }
  return ref.mass;
}

static void run(const scene* s, const chi_grid_view* grid, const char* name, size_t bins,
  int threads, int method, const long double* exact, const double* analytic)
{
  chi_bench_pool pool = { threads };
  const chi_exec exec = chi_bench_exec(&pool);
  const size_t points = s->list.points.count;
  const chi_scatterplot_input input = { .struct_size = sizeof input,
    .grid = grid,
    .fields = { { s->f, points, 1, 8, CHI_F64 }, { s->g, points, 1, 8, CHI_F64 } } };
  chi_scatterplot_params params = {
    .struct_size = sizeof params, .bins = { bins, bins }, .method = method
  };
  memcpy(params.range, range, sizeof range);
  double* const density = chi_bench_room(bins * bins, 8);
  chi_scatterplot_result r = { 0 };
  double best = INFINITY;
  for (int i = 0; i < CHI_BENCH_RUNS; ++i)
  {
    chi_scatterplot* plot;
    chi_bench_must(chi_scatterplot_create(&exec, &plot) == CHI_OK, "create");
    const double start = chi_bench_now();
    chi_bench_must(
      chi_scatterplot_compute(&exec, plot, &input, &params, density, &r) == CHI_OK, "compute");
    best = fmin(best, chi_bench_now() - start);
    chi_scatterplot_destroy(plot);
  }
  const double area = range[0][1] * range[1][1] / (double)(bins * bins);
  long double sum = 0, l1 = 0, mesh = 0;
  for (size_t i = 0; i < bins * bins; ++i)
  {
    sum += density[i] * (long double)area;
    l1 += exact ? fabsl(density[i] * (long double)area - exact[i]) : 0;
    mesh += analytic ? fabs(density[i] * area - analytic[i]) : 0;
  }
  const char* const way = method == CHI_SCATTERPLOT_PUBLISHED ? "published" : "exact";
  const double mass = fabs((double)(sum + (method ? 0 : r.mass_out_of_range) - 8)) / 8;
  printf("scatterplot,%s,%s,%zu^2 bins,%zu,%d,%.0f,%.3g,mass\n", name, way, bins, s->count, threads,
    best, mass);
  if (threads == 2)
  {
    printf("scatterplot,%s,%s,%zu^2 bins,%zu,%d,%.0f,%.3g,rate\n", name, way, bins, s->count,
      threads, best, 1e3 * (double)s->count / best * (47 / bandwidth));
  }
  if (exact)
  {
    printf("scatterplot,%s,%s,%zu^2 bins,%zu,%d,%.0f,%.3g,method\n", name, way, bins, s->count,
      threads, best, (double)(l1 / 8));
  }
  if (analytic)
  {
    printf("scatterplot,%s,%s,%zu^2 bins,%zu,%d,%.0f,%.3g,mesh\n", name, way, bins, s->count,
      threads, best, (double)(mesh / 8));
  }
  fflush(stdout);
  free(density);
}

int main(int argc, char** argv)
{
  static const size_t sizes[] = { 32, 64, 128 }, bins[] = { 64, 256, 1024 };
  const int is_short = argc > 1 && strcmp(argv[1], "short") == 0;
  printf(CHI_BENCH_HEADER);
  chi_bench_triad("scatterplot", 1);
  bandwidth = chi_bench_triad("scatterplot", 2);
  double* analytic[3];
  for (int b = 0; b < 3; ++b)
  {
    const size_t both[2] = { bins[b], bins[b] };
    analytic[b] = chi_bench_room(bins[b] * bins[b], 8);
    waves_masses(analytic[b], both, range, 8192);
  }
  for (int k = 0; k < (is_short ? 1 : 3); ++k)
  {
    scene s = make_scene(sizes[k]);
    for (int b = 0; b < 3; ++b)
    {
      long double* const exact = k == 0 && b == 0 ? exact_masses(&s, bins[b]) : NULL;
      for (int threads = 1; threads <= 2; ++threads)
      {
        run(&s, &s.image, "image", bins[b], threads, CHI_SCATTERPLOT_EXACT, exact,
          threads == 2 ? analytic[b] : NULL);
      }
      if (k == 0)
      {
        run(&s, &s.image, "image", bins[b], 2, CHI_SCATTERPLOT_PUBLISHED, exact, analytic[b]);
      }
      fill_list(&s, 0);
      run(&s, &s.list, "list", bins[b], 2, CHI_SCATTERPLOT_EXACT, exact, NULL);
      free(exact);
    }
    fill_list(&s, 1);
    run(&s, &s.list, "shuffled list", 256, 2, CHI_SCATTERPLOT_EXACT, NULL, NULL);
    free(s.f);
    free(s.g);
    free(s.points);
    free(s.vertices);
    free((void*)s.list.connectivity);
    free((void*)s.list.offsets);
    free((void*)s.list.cell_types);
  }
  for (int b = 0; b < 3; ++b)
  {
    free(analytic[b]);
  }
  return 0;
}
