/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Counting and splitting grids of n^3 cubes into 0.2, 1 and 5 million tetrahedra, on one thread and
 * on two: an image, the same points as a curvilinear grid, as hexahedra (once more with neighbours'
 * ids far apart), and as the tetrahedra of the image's own split. n in the output is the number of
 * tetrahedra. Prints CSV.
 */

#include "chi_bench.h"

#include <chiaroscuro/chi_grid.h>

#include <math.h>
#include <string.h>

enum
{
  SCATTER = 1000003 /* a prime, so that every id is met once */
};

static void run(const char* of, const chi_grid_view* view, double volume)
{
  for (int threads = 1; threads <= 2; ++threads)
  {
    chi_bench_pool pool = { threads };
    const chi_exec exec = chi_bench_exec(&pool);
    double count_ns = INFINITY, split_ns = INFINITY;
    chi_grid_counts counts = { 0 };
    uint32_t *vertices = NULL, *cells = NULL;
    for (int i = 0; i < CHI_BENCH_RUNS; ++i)
    {
      const double t0 = chi_bench_now();
      chi_bench_must(chi_grid_count(&exec, view, &counts) == CHI_OK, "count");
      const double t1 = chi_bench_now();
      if (!vertices)
      {
        vertices = chi_bench_room(counts.tetrahedra, 4 * sizeof *vertices);
        cells = chi_bench_room(counts.tetrahedra, sizeof *cells);
      }
      const chi_grid_tetrahedra out = {
        .struct_size = sizeof out, .vertices = vertices, .cells = cells
      };
      const double t2 = chi_bench_now();
      chi_bench_must(chi_grid_split(&exec, view, &counts, &out) == CHI_OK, "split");
      const double t3 = chi_bench_now();
      count_ns = fmin(count_ns, t1 - t0);
      split_ns = fmin(split_ns, t3 - t2);
    }
    chi_bench_must(fabs(counts.volume / volume - 1) < 1e-12, "volume");
    const char* const names[2] = { "chi_grid_count", "chi_grid_split" };
    for (int k = 0; k < 2; ++k)
    {
      printf("grid,%s,%s,%.1f M,%zu,%d,%.0f,,\n", of, names[k], (double)counts.tetrahedra * 1e-6,
        counts.tetrahedra, threads, k ? split_ns : count_ns);
    }
    fflush(stdout);
    free(vertices);
    free(cells);
  }
}

static void run_all(size_t n)
{
  const size_t p = n + 1, points = p * p * p, cubes = n * n * n;
  const chi_grid_view image = { .struct_size = sizeof image,
    .kind = CHI_GRID_IMAGE,
    .dimensions = { p, p, p },
    .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
  const double volume = (double)cubes;
  chi_grid_counts counts;
  chi_bench_must(chi_grid_count(NULL, &image, &counts) == CHI_OK, "count");
  const size_t tetrahedra = counts.tetrahedra;
  double* const x = chi_bench_room(points, 3 * sizeof *x);
  uint32_t* const vertices = chi_bench_room(tetrahedra, 4 * sizeof *vertices);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices, .points = x };
  chi_bench_must(chi_grid_split(NULL, &image, &counts, &out) == CHI_OK, "split");
  uint8_t* const types = chi_bench_room(tetrahedra, 1);
  int64_t* const offsets = chi_bench_room(tetrahedra + 1, sizeof *offsets);
  int64_t* const ids = chi_bench_room(4 * tetrahedra, sizeof *ids);

  run("image", &image, volume);
  chi_grid_view view = image;
  view.kind = CHI_GRID_CURVILINEAR;
  view.points = (chi_vec3_view){ x, points, 3 * sizeof *x, CHI_F64 };
  run("curvilinear", &view, volume);

  view.kind = CHI_GRID_UNSTRUCTURED;
  view.cell_types = types;
  view.offsets = offsets;
  view.connectivity = ids;
  view.cell_count = cubes;
  view.connectivity_count = 8 * cubes;
  for (size_t c = 0; c < cubes; ++c)
  {
    const size_t first = c % n + p * (c / n % n) + p * p * (c / (n * n));
    types[c] = 12;
    offsets[c] = (int64_t)(8 * c);
    for (size_t k = 0; k < 8; ++k)
    {
      ids[8 * c + k] = (int64_t)(first + ((k + 1) >> 1 & 1) + (k >> 1 & 1) * p + (k >> 2) * p * p);
    }
  }
  offsets[cubes] = (int64_t)(8 * cubes);
  run("hexahedra", &view, volume);

  double* const scattered = chi_bench_room(points, 3 * sizeof *scattered);
  for (size_t i = 0; i < points; ++i)
  {
    memcpy(scattered + 3 * (i * SCATTER % points), x + 3 * i, 3 * sizeof *x);
  }
  for (size_t i = 0; i < 8 * cubes; ++i)
  {
    ids[i] = (int64_t)((size_t)ids[i] * SCATTER % points);
  }
  view.points.data = scattered;
  run("hexahedra (scattered ids)", &view, volume);
  view.points.data = x;
  free(scattered);

  view.cell_count = tetrahedra;
  view.connectivity_count = 4 * tetrahedra;
  for (size_t t = 0; t <= tetrahedra; ++t)
  {
    offsets[t] = (int64_t)(4 * t);
    for (size_t k = 0; k < 4 && t < tetrahedra; ++k)
    {
      types[t] = 10;
      ids[4 * t + k] = vertices[4 * t + k];
    }
  }
  run("tetrahedra", &view, volume);
  free(x);
  free(vertices);
  free(types);
  free(offsets);
  free(ids);
}

int main(void)
{
  printf(CHI_BENCH_HEADER);
  run_all(32);
  run_all(55);
  run_all(94);
  return 0;
}
