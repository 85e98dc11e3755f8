/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The core's tubes of 2000 helices of 500 points, 8 sides: the stages one by one, on one thread and
 * on two, with each set of instructions; then run time against error of the fitted and thinned
 * surface, the distance of its rings' chords from the helix. Prints CSV.
 */

#define _POSIX_C_SOURCE 200809L /* setenv */

#include "chi_bench.h"

#include <chiaroscuro/chi_tube.h>

#include <math.h>

enum
{
  LINES = 2000,
  EACH = 500,
  SIDES = 8
};

typedef struct bench
{
  chi_bench_pool pool;
  chi_exec exec;
  chi_lines_view view;
  chi_spline* spline;
  chi_tube* tube;
  chi_tube_sizes sizes;
  float *points, *normals;
  double* axis;
  int64_t *offsets, *connectivity;
  size_t point_room, connectivity_room, cell_room;
  double fit, plan, sweep; /* shortest of the runs, ns */
} bench;

static void make_room(bench* b)
{
  const chi_tube_sizes* const s = &b->sizes;
  if (s->points > b->point_room || s->connectivity > b->connectivity_room ||
    s->cells > b->cell_room)
  {
    free(b->points);
    free(b->normals);
    free(b->axis);
    free(b->offsets);
    free(b->connectivity);
    b->point_room = s->points;
    b->connectivity_room = s->connectivity;
    b->cell_room = s->cells;
    b->points = malloc(3 * s->points * sizeof *b->points);
    b->normals = malloc(3 * s->points * sizeof *b->normals);
    b->axis = malloc(3 * s->points * sizeof *b->axis);
    b->offsets = malloc((s->cells + 1) * sizeof *b->offsets);
    b->connectivity = malloc(s->connectivity * sizeof *b->connectivity);
    chi_bench_must(b->points && b->normals && b->axis && b->offsets && b->connectivity, "malloc");
  }
}

static void run(bench* b, const chi_spline_params* fit, const chi_tube_params* params)
{
  b->fit = b->plan = b->sweep = INFINITY;
  for (int i = 0; i < CHI_BENCH_RUNS; ++i)
  {
    const double t0 = chi_bench_now();
    chi_bench_must(chi_spline_fit(&b->exec, b->spline, &b->view, fit) == CHI_OK, "fit");
    const double t1 = chi_bench_now();
    chi_bench_must(chi_tube_plan(&b->exec, b->tube, b->spline, &b->view, params) == CHI_OK, "plan");
    const double t2 = chi_bench_now();
    chi_tube_get_sizes(b->tube, &b->sizes);
    make_room(b);
    const chi_tube_outputs out = { .struct_size = sizeof out,
      .points = b->points,
      .point_type = CHI_F32,
      .normals = b->normals,
      .offsets = b->offsets,
      .connectivity = b->connectivity,
      .curve_points = b->axis };
    const double t3 = chi_bench_now();
    chi_bench_must(chi_tube_sweep(&b->exec, b->tube, &out) == CHI_OK, "sweep");
    const double t4 = chi_bench_now();
    b->fit = fmin(b->fit, t1 - t0);
    b->plan = fmin(b->plan, t2 - t1);
    b->sweep = fmin(b->sweep, t4 - t3);
  }
}

static double distance_to_helix(const double x[3])
{
  double t = x[2] / 0.3;
  for (int i = 0; i < 20; ++i) /* Newton for the nearest point */
  {
    const double f = x[0] * sin(t) - x[1] * cos(t) + 0.3 * (0.3 * t - x[2]);
    t -= f / (x[0] * cos(t) + x[1] * sin(t) + 0.09);
  }
  return sqrt(pow(x[0] - cos(t), 2) + pow(x[1] - sin(t), 2) + pow(x[2] - 0.3 * t, 2));
}

/* Of the first line's rings and the middles between them. */
static double axis_error(const bench* b)
{
  const size_t rings = b->sizes.rings / LINES;
  double worst = 0;
  for (size_t k = 0; k < rings; ++k)
  {
    const double* const x = b->axis + 3 * k;
    worst = fmax(worst, distance_to_helix(x));
    if (k + 1 < rings)
    {
      const double middle[3] = { 0.5 * (x[0] + x[3]), 0.5 * (x[1] + x[4]), 0.5 * (x[2] + x[5]) };
      worst = fmax(worst, distance_to_helix(middle));
    }
  }
  return worst;
}

static void row(const bench* b, const char* of, const char* parameter, double ns, double error)
{
  printf("tube,%s,chi_tube,%s,%d,%d,%.0f,%.6g,%s\n", of, parameter, LINES * EACH, b->pool.threads,
    ns, error, error > 0 ? "axis_distance" : "");
}

int main(void)
{
  double(*const x)[3] = malloc((size_t)LINES * EACH * sizeof *x);
  int64_t* const first = malloc((LINES + 1) * sizeof *first);
  chi_bench_must(x && first, "malloc");
  for (size_t i = 0; i <= LINES; ++i)
  {
    first[i] = (int64_t)(i * EACH);
  }
  for (size_t i = 0; i < (size_t)LINES * EACH; ++i)
  {
    const double t = 12.566370614359172 * (double)(i % EACH) / (EACH - 1);
    const size_t line = i / EACH;
    x[i][0] = cos(t) + 3.0 * (double)(line % 50);
    x[i][1] = sin(t) + 3.0 * (double)(line / 50);
    x[i][2] = 0.3 * t;
  }
  bench b = { .view = { { x, (size_t)LINES * EACH, sizeof *x, CHI_F64 }, first, NULL, LINES } };
  chi_bench_must(chi_spline_create(NULL, &b.spline) == CHI_OK, "create");
  chi_bench_must(chi_tube_create(NULL, &b.tube) == CHI_OK, "create");
  chi_tube_params params = { .struct_size = sizeof params,
    .radius = 0.05,
    .sides = SIDES,
    .cells = CHI_TUBE_STRIPS,
    .cap = CHI_TUBE_CAP_NONE,
    .chord_tolerance = 1e-3,
    .angular_tolerance_rad = 0.78,
    .keep_rings = 1 };
  chi_spline_params fit = { .struct_size = sizeof fit, .method = CHI_SPLINE_POLYLINE };
  printf(CHI_BENCH_HEADER);
  static const char* const sets[4] = { "generic", "avx2", "avx512", "" };
  for (int threads = 1; threads <= 2; ++threads)
  {
    b.pool.threads = threads;
    b.exec = chi_bench_exec(&b.pool);
    for (int k = 0; k < 3; ++k)
    {
      setenv("CHIAROSCURO_ISA", sets[k], 1);
      run(&b, &fit, &params);
      row(&b, "sweep of every point (core)", sets[k], b.sweep, 0);
    }
    unsetenv("CHIAROSCURO_ISA");
    row(&b, "stages without fit (core)", "clean", b.fit, 0);
    row(&b, "stages without fit (core)", "plan", b.plan, 0);
    row(&b, "stages without fit (core)", "sweep", b.sweep, 0);
  }
  params.keep_rings = 0;
  fit.method = CHI_SPLINE_PROGRESSIVE;
  static const double tolerances[] = { 1e-2, 3e-3, 1e-3, 3e-4, 1e-4 };
  for (int k = 0; k < 5; ++k)
  {
    char text[96];
    fit.tolerance = params.chord_tolerance = tolerances[k];
    run(&b, &fit, &params);
    snprintf(text, sizeof text, "tolerance=%g rings=%zu fit=%.0fms plan=%.0fms sweep=%.0fms",
      tolerances[k], b.sizes.rings / LINES, b.fit * 1e-6, b.plan * 1e-6, b.sweep * 1e-6);
    row(&b, "fitted helices (core)", text, b.fit + b.plan + b.sweep, axis_error(&b));
  }
  chi_tube_destroy(NULL, b.tube);
  chi_spline_destroy(NULL, b.spline);
  free(b.points);
  free(b.normals);
  free(b.axis);
  free(b.offsets);
  free(b.connectivity);
  free(x);
  free(first);
  return 0;
}
