/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Visibility orders of 0.2, 1 and 5 million tetrahedra, on one thread and on two: the analysis that
 * is made once a mesh, and the keys of an oblique view of 512 x 512 pixels, perspective, that moves
 * from call to call. Cases: a grid of cubes as chi_grid splits it; the same sheared; the same with
 * its inner points moved, which has no quadratic lift; and a step, which is not convex. error: the
 * violations of a view of 128 x 128 pixels, of the smallest mesh alone. Bytes held a tetrahedron
 * are rows of their own, in place of a time. Prints CSV. With an argument: that size in cubes a
 * side.
 */

#include "chi_bench.h"
#include "tet_scenes.h"

#include <chiaroscuro/chi_tet_order.h>

#include <math.h>
#include <string.h>

typedef struct bench_mesh
{
  const char* name;
  tet_mesh* tets;
} bench_mesh;

static void turn(tet_mesh* m)
{
  for (size_t t = 0; t < m->count; ++t)
  {
    if (t % 6 != 0 && t % 6 != 3 && t % 6 != 4) /* the odd ways along the axes */
    {
      const uint32_t v = m->vertices[t][2];
      m->vertices[t][2] = m->vertices[t][3];
      m->vertices[t][3] = v;
    }
  }
}

static bench_mesh make(int kind, size_t n)
{
  static const char* const names[4] = { "cubes", "sheared cubes", "moved cubes", "step" };
  bench_mesh b = { names[kind], tet_mesh_cubes(n, TET_CONSTANT) };
  tet_mesh* const m = b.tets;
  turn(m);
  uint32_t state = 1;
  for (size_t i = 0; i < m->point_count && (kind == 1 || kind == 2); ++i)
  {
    double* const p = m->points[i];
    if (kind == 1)
    {
      p[0] += 0.5 * p[1];
      p[2] = 0.3 * p[2] + 0.2 * p[0];
    }
    const int is_inner = fabs(p[0]) < 1 && fabs(p[1]) < 1 && fabs(p[2]) < 1;
    for (int k = 0; k < 3 && kind == 2 && is_inner; ++k)
    {
      state = state * 1664525u + 1013904223u;
      p[k] += 0.3 / (double)n * ((double)state * 0x1p-31 - 1);
    }
  }
  size_t left = 0;
  for (size_t t = 0; t < m->count && kind == 3; ++t)
  {
    const size_t x = t / 6 % n, y = t / 6 / n % n;
    if (x < n / 2 || y < n / 2)
    {
      memcpy(m->vertices[left++], m->vertices[t], sizeof m->vertices[t]);
    }
  }
  m->count = kind == 3 ? left : m->count;
  return b;
}

static void run(const bench_mesh* b, int32_t method, const char* name, int judge)
{
  const tet_mesh* const m = b->tets;
  const chi_tet_mesh_view mesh = { .struct_size = sizeof mesh,
    .points = { m->points, m->point_count, sizeof *m->points, CHI_F64 },
    .vertices = m->vertices[0],
    .count = m->count };
  uint32_t* const keys = (uint32_t*)malloc(m->count * sizeof *keys);
  chi_bench_must(keys != NULL, "malloc");
  for (int threads = 1; threads <= 2; ++threads)
  {
    chi_bench_pool pool = { threads };
    const chi_exec exec = chi_bench_exec(&pool);
    double analysis = INFINITY, look = INFINITY;
    chi_tet_order_info info = { 0 };
    int64_t violations = 0;
    int32_t bits = 0;
    for (int i = 0; i < CHI_BENCH_RUNS; ++i)
    {
      chi_tet_order* order;
      const double t0 = chi_bench_now();
      chi_bench_must(chi_tet_order_create(&exec, &mesh, method, &order) == CHI_OK, "create");
      analysis = fmin(analysis, chi_bench_now() - t0);
      for (int k = 0; k < 2; ++k) /* the first one reserves */
      {
        const chi_camera camera = tet_look(6.6921, 33 + k, 27, 0, 512, 0.27);
        const chi_tet_order_view from = { sizeof from, &camera, NULL };
        const double t1 = chi_bench_now();
        chi_bench_must(chi_tet_order_keys(&exec, order, &from, keys, &bits) == CHI_OK, "keys");
        look = fmin(look, chi_bench_now() - t1);
      }
      chi_tet_order_get_info(order, &info);
      if (judge && i == 0)
      {
        const chi_camera camera = tet_look(6.6921, 33, 27, 0, 128, 0.27);
        const chi_tet_order_view from = { sizeof from, &camera, NULL };
        chi_bench_must(chi_tet_order_keys(&exec, order, &from, keys, &bits) == CHI_OK, "keys");
        chi_bench_must(
          chi_tet_order_violations(&exec, &mesh, &from, keys, &violations) == CHI_OK, "judge");
      }
      chi_tet_order_destroy(&exec, order);
    }
    static const char* const used[] = { "auto", "centroid", "tangential", "mpvo", "xmpvo" };
    printf("tet_order,%s,%s analysis,%s lift %d bits %d,%zu,%d,%.0f,,\n", b->name, name,
      used[info.used], info.lift, bits, m->count, threads, analysis);
    if (judge)
    {
      printf("tet_order,%s,%s keys,%s,%zu,%d,%.0f,%lld,violations\n", b->name, name,
        used[info.used], m->count, threads, look, (long long)violations);
    }
    else
    {
      printf("tet_order,%s,%s keys,%s,%zu,%d,%.0f,,\n", b->name, name, used[info.used], m->count,
        threads, look);
    }
    if (threads == 1)
    {
      printf("tet_order,%s,%s memory,%s,%zu,,,%.1f,bytes a tetrahedron\n", b->name, name,
        used[info.used], m->count, (double)info.bytes / (double)m->count);
    }
    fflush(stdout);
  }
  free(keys);
}

int main(int argc, char** argv)
{
  static const size_t sizes[3] = { 32, 55, 94 };
  printf(CHI_BENCH_HEADER);
  for (int s = 0; s < (argc > 1 ? 1 : 3); ++s)
  {
    const size_t n = argc > 1 ? (size_t)atoi(argv[1]) : sizes[s];
    for (int kind = 0; kind < 4; ++kind)
    {
      const bench_mesh b = make(kind, n);
      run(&b, CHI_TET_ORDER_AUTO, "auto", s == 0);
      if (kind == 0)
      {
        run(&b, CHI_TET_ORDER_CENTROID, "centroid", s == 0);
        run(&b, CHI_TET_ORDER_TANGENTIAL, "tangential", s == 0);
        run(&b, CHI_TET_ORDER_MPVO, "mpvo", s == 0);
      }
      if (kind == 0 || kind == 2)
      {
        run(&b, CHI_TET_ORDER_XMPVO, "xmpvo", s == 0);
      }
      tet_mesh_free(b.tets);
    }
  }
  return 0;
}
