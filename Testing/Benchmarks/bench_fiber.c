/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Fiber surfaces of the Marschner-Lobb signal against |x| in cubes of Kuhn's tetrahedra, 0.2, 1.6
 * and 12.6 million, as an unstructured grid and as an image, eight segments around a closed
 * polygon, on one thread and on two: the first call with its index, a further polygon with the
 * index kept, and the arrays written. Beside these the torus, whose area is known, as run time
 * against error. Prints CSV; the error of the first rows is the area's difference between grids,
 * relative.
 */

#include "chi_bench.h"

#include <chiaroscuro/chi_fiber.h>

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Marschner & Lobb 1994, Eq. 1, in [-1, 1]^3: alpha 0.25, f_M 6. */
static double signal(double x, double y, double z)
{
  const double r = cos(2 * pi * 6 * cos(pi * sqrt(x * x + y * y) / 2));
  return (1 - sin(pi * z / 2) + 0.25 * (1 + r)) / (2 * 1.25);
}

typedef struct scene
{
  size_t n; /* cells along an axis */
  float* fields[2];
  chi_grid_view image, list;
} scene;

static scene make_scene(size_t n, int is_torus)
{
  scene s = { .n = n };
  const size_t p = n + 1, points = p * p * p, count = 6 * n * n * n;
  const double h = 2 / (double)n;
  s.image = (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { p, p, p },
    .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 },
    .version = 1 };
  float* const x = chi_bench_room(points, 3 * sizeof *x);
  s.fields[0] = chi_bench_room(points, sizeof(float));
  s.fields[1] = chi_bench_room(points, sizeof(float));
  for (size_t i = 0; i < points; ++i)
  {
    const double at[3] = { h * (double)(i % p) - 1, h * (double)(i / p % p) - 1,
      h * (double)(i / (p * p)) - 1 };
    const double r = sqrt(at[0] * at[0] + at[1] * at[1]);
    s.fields[0][i] = (float)(is_torus ? r : signal(at[0], at[1], at[2]));
    s.fields[1][i] = (float)(is_torus ? at[2] : sqrt(r * r + at[2] * at[2]));
    for (size_t a = 0; a < 3; ++a)
    {
      x[3 * i + a] = (float)at[a];
    }
  }
  chi_grid_counts counts;
  chi_bench_must(chi_grid_count(NULL, &s.image, &counts) == CHI_OK, "count");
  chi_bench_must(counts.tetrahedra == count, "count");
  uint32_t* const vertices = chi_bench_room(count, 4 * sizeof *vertices);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices };
  chi_bench_must(chi_grid_split(NULL, &s.image, &counts, &out) == CHI_OK, "split");
  uint8_t* const types = chi_bench_room(count, 1);
  int64_t* const offsets = chi_bench_room(count + 1, sizeof *offsets);
  int64_t* const ids = chi_bench_room(4 * count, sizeof *ids);
  for (size_t t = 0; t < count; ++t)
  {
    types[t] = 10;
    offsets[t] = (int64_t)(4 * t);
    for (size_t k = 0; k < 4; ++k)
    {
      ids[4 * t + k] = vertices[4 * t + k];
    }
  }
  offsets[count] = (int64_t)(4 * count);
  free(vertices);
  s.list = (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { x, points, 3 * sizeof *x, CHI_F32 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = count,
    .connectivity_count = 4 * count,
    .version = 1 };
  return s;
}

static void drop_scene(scene* s)
{
  free(s->fields[0]);
  free(s->fields[1]);
  free((void*)s->list.points.data);
  free((void*)s->list.cell_types);
  free((void*)s->list.offsets);
  free((void*)s->list.connectivity);
}

enum
{
  MOST_SEGMENTS = 256
};

static chi_lines_view circle(
  double (*points)[3], int64_t offsets[2], double u, double v, double radius, size_t count)
{
  for (size_t i = 0; i <= count; ++i)
  {
    const double angle = 2 * pi * (double)(i % count) / (double)count;
    points[i][0] = u + radius * cos(angle);
    points[i][1] = v + radius * sin(angle);
    points[i][2] = 0;
  }
  offsets[0] = 0;
  offsets[1] = (int64_t)count + 1;
  return (chi_lines_view){
    .points = { points, count + 1, sizeof points[0], CHI_F64 }, .offsets = offsets, .line_count = 1
  };
}

static double area_of(const float* x, const int64_t* ids, size_t count)
{
  double sum = 0;
  for (size_t t = 0; t < count; ++t)
  {
    double e[2][3];
    for (size_t k = 0; k < 2; ++k)
    {
      for (size_t a = 0; a < 3; ++a)
      {
        e[k][a] = (double)x[3 * ids[3 * t + k + 1] + (int64_t)a] - x[3 * ids[3 * t] + (int64_t)a];
      }
    }
    const double n[3] = { e[0][1] * e[1][2] - e[0][2] * e[1][1],
      e[0][2] * e[1][0] - e[0][0] * e[1][2], e[0][0] * e[1][1] - e[0][1] * e[1][0] };
    sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  return sum;
}

typedef struct times
{
  double first, further, write, enclose, area, volume;
  chi_fiber_enclosed_sizes enclosed;
  chi_fiber_sizes sizes;
} times;

static times run(const chi_grid_view* grid, const scene* s, int threads, double u, double v,
  double radius, size_t segments)
{
  chi_bench_pool pool = { threads };
  const chi_exec exec = chi_bench_exec(&pool);
  const size_t n = s->n + 1;
  const chi_array_view fields[2] = { { s->fields[0], n * n * n, 1, sizeof(float), CHI_F32 },
    { s->fields[1], n * n * n, 1, sizeof(float), CHI_F32 } };
  double(*const points)[3] = chi_bench_room(MOST_SEGMENTS + 1, sizeof *points);
  double(*const others)[3] = chi_bench_room(MOST_SEGMENTS + 1, sizeof *others);
  int64_t offsets[2], other_offsets[2];
  chi_fiber_params params = { .struct_size = sizeof params,
    .fields = { fields, fields + 1 },
    .fields_version = 1,
    .polygon = circle(points, offsets, u, v, radius, segments) };
  chi_fiber_params other = params;
  other.polygon = circle(others, other_offsets, u, v, radius * 0.98, segments);
  times t = { .first = INFINITY, .further = INFINITY, .write = INFINITY, .enclose = INFINITY };
  for (int i = 0; i < CHI_BENCH_RUNS; ++i)
  {
    chi_fiber* fiber = NULL;
    chi_bench_must(chi_fiber_create(&exec, &fiber) == CHI_OK, "create");
    const double t0 = chi_bench_now();
    chi_bench_must(chi_fiber_extract(&exec, fiber, grid, &params) == CHI_OK, "extract");
    chi_fiber_get_sizes(fiber, &t.sizes);
    /* as a caller does who has just made its arrays */
    float* const x = chi_bench_room(3 * t.sizes.points + 1, sizeof *x);
    float* const normals = chi_bench_room(3 * t.sizes.points + 1, sizeof *normals);
    float* const parameter = chi_bench_room(t.sizes.points + 1, sizeof *parameter);
    int64_t* const ids = chi_bench_room(3 * t.sizes.triangles + 1, sizeof *ids);
    int64_t* const numbers = chi_bench_room(3 * t.sizes.triangles + 4, sizeof *numbers);
    const chi_fiber_outputs out = { .struct_size = sizeof out,
      .points = x,
      .point_type = CHI_F32,
      .normals = normals,
      .segment_parameter = parameter,
      .offsets = numbers,
      .connectivity = ids,
      .segment_ids = numbers + t.sizes.triangles + 1,
      .cell_ids = numbers + 2 * t.sizes.triangles + 1 };
    const double t1 = chi_bench_now();
    chi_bench_must(chi_fiber_write(&exec, fiber, &out) == CHI_OK, "write");
    const double t2 = chi_bench_now();
    t.area = area_of(x, ids, t.sizes.triangles);
    chi_bench_must(chi_fiber_extract(&exec, fiber, grid, &other) == CHI_OK, "extract");
    const double t3 = chi_bench_now();
    chi_bench_must(chi_fiber_extract(&exec, fiber, grid, &params) == CHI_OK, "extract");
    const double t4 = chi_bench_now();
    chi_bench_must(chi_fiber_write(&exec, fiber, &out) == CHI_OK, "write");
    const double t5 = chi_bench_now();
    chi_bench_must(chi_fiber_enclose(&exec, fiber, &t.enclosed) == CHI_OK, "enclose");
    float* const places = chi_bench_room(3 * t.enclosed.points + 1, sizeof *places);
    int64_t* const cells = chi_bench_room(4 * t.enclosed.cells + 1, sizeof *cells);
    int64_t* const from = chi_bench_room(2 * t.enclosed.cells + 1, sizeof *from);
    const chi_fiber_enclosed_outputs enclosed = { .struct_size = sizeof enclosed,
      .points = places,
      .point_type = CHI_F32,
      .offsets = from,
      .connectivity = cells,
      .cell_ids = from + t.enclosed.cells + 1 };
    chi_bench_must(chi_fiber_enclosed_write(&exec, fiber, &enclosed) == CHI_OK, "write");
    t.enclose = fmin(t.enclose, chi_bench_now() - t5);
    t.volume = t.enclosed.volume;
    free(places);
    free(cells);
    free(from);
    t.first = fmin(t.first, t2 - t0);
    t.further = fmin(t.further, t5 - t3);
    t.write = fmin(t.write, fmin(t2 - t1, t5 - t4));
    free(x);
    free(normals);
    free(parameter);
    free(ids);
    free(numbers);
    chi_fiber_destroy(&exec, fiber);
  }
  free(points);
  free(others);
  return t;
}

static void print_enclosed(
  const char* of, const times* t, int threads, double error, const char* kind)
{
  printf(
    "fiber,%s,enclosed cells,%zu cells of which %zu whole %.1f bytes a tetrahedron,%zu,%d,%.0f,"
    "%.3g,%s\n",
    of, t->enclosed.cells, t->enclosed.whole_cells,
    (double)t->enclosed.scratch_bytes / (double)t->sizes.tetrahedra, t->sizes.tetrahedra, threads,
    t->enclose, error, kind);
  fflush(stdout);
}

static void print(const char* of, const char* method, const times* t, int threads, double ns,
  double error, const char* kind)
{
  printf("fiber,%s,%s,%zu triangles %.1f bytes a tetrahedron,%zu,%d,%.0f,%.3g,%s\n", of, method,
    t->sizes.triangles, (double)t->sizes.scratch_bytes / (double)t->sizes.tetrahedra,
    t->sizes.tetrahedra, threads, ns, error, kind);
  fflush(stdout);
}

int main(int argc, char** argv)
{
  const size_t most = argc > 1 ? (size_t)strtoull(argv[1], NULL, 10) : 128;
  printf(CHI_BENCH_HEADER);
  for (size_t n = 32; n <= most; n *= 2)
  {
    scene s = make_scene(n, 0);
    double area = 0, volume = 0;
    for (int threads = 1; threads <= 2; ++threads)
    {
      for (int is_image = 0; is_image < 2; ++is_image)
      {
        const times t = run(is_image ? &s.image : &s.list, &s, threads, 0.5, 0.6, 0.15, 8);
        area = area > 0 ? area : t.area;
        const char* const of = is_image ? "image" : "tetrahedra";
        const double error = fabs(t.area / area - 1);
        print(of, "first call", &t, threads, t.first, error, "area between grids");
        print(of, "index kept", &t, threads, t.further, error, "area between grids");
        print(of, "writing alone", &t, threads, t.write, error, "area between grids");
        volume = volume > 0 ? volume : t.volume;
        print_enclosed(of, &t, threads, fabs(t.volume / volume - 1), "volume between grids");
      }
    }
    drop_scene(&s);
  }
  for (size_t n = 16; n <= (most < 64 ? most : 64); n *= 2)
  {
    scene s = make_scene(n, 1);
    const times t = run(&s.list, &s, 1, 0.55, 0.05, 0.3, 2 * n);
    print("torus", "index kept", &t, 1, t.further, fabs(t.area / (4 * pi * pi * 0.55 * 0.3) - 1),
      "area");
    print_enclosed("torus", &t, 1, fabs(t.volume / (2 * pi * pi * 0.55 * 0.09) - 1), "volume");
    drop_scene(&s);
  }
  return 0;
}
