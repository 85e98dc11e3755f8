/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The spline fit beside least squares with as many coefficients and interpolation: run time,
 * distance to the true curve, coefficients, and total turning over the true one (1 is no wiggle; of
 * the noisy line, whose true turning is 0, radians). Prints CSV.
 */

#include "chi_bench.h"
#include "spline_curves.h"

enum
{
  POINTS = 200,
  STEPS = 4000
};

/* A case: the line and what is true of it. */
typedef struct judged
{
  const char* name;
  line l;
  double (*truth)[3]; /* [STEPS + 1] */
  double turning;     /* 0: straight */
  int closed;
} judged;

/* Largest distance of the curve to the true polyline. */
static double distance_to_truth(const chi_spline_curve* c, const judged* j)
{
  double worst = 0;
  for (int i = 0; i <= STEPS; i += 16)
  {
    double x[1][3], best = INFINITY;
    chi_spline_evaluate(c, (double)i / STEPS, 0, x);
    for (int k = 0; k < STEPS; ++k)
    {
      const double* const a = j->truth[k];
      const double* const b = j->truth[k + 1];
      double dot = 0, square = 0, off = 0;
      for (int m = 0; m < 3; ++m)
      {
        dot += (b[m] - a[m]) * (x[0][m] + c->origin[m] - a[m]);
        square += (b[m] - a[m]) * (b[m] - a[m]);
      }
      const double w = fmin(fmax(dot / square, 0), 1);
      for (int m = 0; m < 3; ++m)
      {
        const double d = a[m] + w * (b[m] - a[m]) - x[0][m] - c->origin[m];
        off += d * d;
      }
      best = fmin(best, off);
    }
    worst = fmax(worst, best);
  }
  return sqrt(worst);
}

/* One row; returns the number of coefficients. */
static size_t measure(
  const judged* j, const char* name, int32_t method, double tolerance, size_t coefficients)
{
  const chi_lines_view view = { { j->l.x, j->l.n, sizeof *j->l.x, CHI_F64 }, j->l.offsets, NULL,
    1 };
  const chi_spline_params params = { .struct_size = sizeof params,
    .tolerance = tolerance,
    .method = method,
    .coefficients = coefficients };
  chi_spline* s = NULL;
  chi_status status = chi_spline_create(NULL, &s);
  double best = INFINITY;
  for (int run = 0; run < 4 * CHI_BENCH_RUNS && status == CHI_OK; ++run)
  {
    const double t0 = chi_bench_now();
    status = chi_spline_fit(NULL, s, &view, &params);
    best = fmin(best, chi_bench_now() - t0);
  }
  chi_spline_curve c;
  chi_spline_get_curve(s, 0, &c);
  if (status != CHI_OK || c.count == 0)
  {
    fprintf(stderr, "%s, %s: %s\n", j->name, name, chi_status_string(status));
    exit(1);
  }
  int changes;
  const double turned = turning(&c, &changes) / (j->turning > 0 ? j->turning : 1);
  printf(
    "spline,%s,%s,tolerance=%g coefficients=%zu turning=%.4g,%zu,1,%.0f,%.6g,distance_to_truth\n",
    j->name, name, tolerance, c.count, turned, j->l.n, best, distance_to_truth(&c, j));
  const size_t count = c.count;
  chi_spline_destroy(NULL, s);
  return count;
}

static void compare(judged* j, const double* tolerances, int count)
{
  if (!j->l.x || !j->truth)
  {
    exit(1);
  }
  for (int i = 0; i < count; ++i)
  {
    const size_t n = measure(j, "chi progressive", CHI_SPLINE_PROGRESSIVE, tolerances[i], 0);
    if (!j->closed) /* the peer takes a number of coefficients for open lines only */
    {
      measure(j, "least squares", CHI_SPLINE_LEAST_SQUARES, tolerances[i], n < 4 ? 4 : n);
    }
  }
  measure(j, "interpolation", CHI_SPLINE_INTERPOLATE, tolerances[count - 1], 0);
  free(j->l.x);
  free(j->truth);
}

/* Many lines at once: how the fit scales. */
static void many_lines(int threads)
{
  enum
  {
    LINES = 2000,
    EACH = 500
  };
  double(*const x)[3] = malloc((size_t)LINES * EACH * sizeof *x);
  int64_t* const offsets = malloc((LINES + 1) * sizeof *offsets);
  if (!x || !offsets)
  {
    exit(1);
  }
  for (size_t i = 0; i <= LINES; ++i)
  {
    offsets[i] = (int64_t)(i * EACH);
  }
  for (size_t i = 0; i < (size_t)LINES * EACH; ++i)
  {
    const double t = 12.566370614359172 * (double)(i % EACH) / (EACH - 1);
    x[i][0] = cos(t);
    x[i][1] = sin(t);
    x[i][2] = 0.3 * t + (double)(i / EACH);
  }
  const chi_lines_view view = { { x, (size_t)LINES * EACH, sizeof *x, CHI_F64 }, offsets, NULL,
    LINES };
  chi_bench_pool pool = { threads };
  const chi_exec exec = chi_bench_exec(&pool);
  chi_spline* s = NULL;
  chi_status status = chi_spline_create(&exec, &s);
  static const double tolerances[] = { 1e-2, 1e-3, 1e-4 };
  for (int k = 0; k < 3; ++k)
  {
    const chi_spline_params params = { .struct_size = sizeof params, .tolerance = tolerances[k] };
    double best = INFINITY;
    for (int run = 0; run < CHI_BENCH_RUNS && status == CHI_OK; ++run)
    {
      const double t0 = chi_bench_now();
      status = chi_spline_fit(&exec, s, &view, &params);
      best = fmin(best, chi_bench_now() - t0);
    }
    chi_spline_stats stats;
    chi_spline_get_stats(s, &stats);
    printf(
      "spline,2000 helices of 500 points,chi progressive,tolerance=%g,%d,%d,%.0f,%.6g,max_error\n",
      tolerances[k], LINES * EACH, threads, best, stats.max_error);
  }
  if (status != CHI_OK)
  {
    exit(1);
  }
  chi_spline_destroy(&exec, s);
  free(x);
  free(offsets);
}

int main(void)
{
  static const double smooth[] = { 1e-1, 1e-2, 1e-3, 1e-4 }, noisy[] = { 2e-2, 1e-2, 5e-3 };
  printf(CHI_BENCH_HEADER);
  for (int k = 0; k < PLANE_CURVES; ++k)
  {
    int changes;
    judged j = { plane_curve_name[k], make_plane_curve((plane_curve)k, POINTS),
      malloc((STEPS + 1) * sizeof *j.truth), plane_curve_turning((plane_curve)k, &changes),
      k == CIRCLE };
    for (int i = 0; i <= STEPS && j.truth; ++i)
    {
      plane_curve_point((plane_curve)k, (double)i / STEPS, j.truth[i]);
    }
    compare(&j, smooth, 4);
  }
  judged j = { "straight line with noise of 0.01", make_noisy_line(100, 1e-2, 7),
    malloc((STEPS + 1) * sizeof *j.truth), 0, 0 };
  for (int i = 0; i <= STEPS && j.truth; ++i)
  {
    j.truth[i][0] = 10.0 * i / STEPS;
    j.truth[i][1] = j.truth[i][2] = 0;
  }
  compare(&j, noisy, 3);
  many_lines(1);
  many_lines(2);
  return 0;
}
