/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include <chiaroscuro/chi_spline.h>

#include "chi_test.h"
#include "spline_curves.h"

static chi_lines_view view_of(const line* l)
{
  const chi_lines_view view = { { l->x, l->n, sizeof *l->x, CHI_F64 }, l->offsets, NULL, 1 };
  return view;
}

static chi_spline* fit_with(
  const line* l, double tolerance, int32_t method, size_t coefficients, chi_spline_curve* curve)
{
  const chi_lines_view view = view_of(l);
  const chi_spline_params params = { .struct_size = sizeof params,
    .tolerance = tolerance,
    .method = method,
    .coefficients = coefficients };
  chi_spline* s = NULL;
  CHECK(chi_spline_create(NULL, &s) == CHI_OK);
  CHECK(chi_spline_fit(NULL, s, &view, &params) == CHI_OK);
  chi_spline_get_curve(s, 0, curve);
  return s;
}

static chi_spline* fit(const line* l, double tolerance, int32_t method, chi_spline_curve* curve)
{
  return fit_with(l, tolerance, method, 0, curve);
}

static void plane_curves_get_no_wiggle(void)
{
  for (int k = 0; k < PLANE_CURVES; ++k)
  {
    int allowed, changes;
    const double exact = plane_curve_turning((plane_curve)k, &allowed);
    line l = make_plane_curve((plane_curve)k, 200);
    chi_spline_curve c;
    chi_spline* s = fit(&l, 1e-4, CHI_SPLINE_PROGRESSIVE, &c);
    const double found = turning(&c, &changes);
    CHECK(found <= 1.02 * exact); /* the bound */
    CHECK(found >= 0.98 * exact);
    CHECK(changes <= allowed);
    CHECK(c.count <= 100); /* data reduction took place */
    CHECK(c.closed == (k == CIRCLE));
    chi_spline_destroy(NULL, s);
    free(l.x);
  }
}

static void noise_within_the_tolerance_is_not_followed(void)
{
  const double eps = 1e-2;
  for (uint32_t seed = 7; seed < 12; ++seed)
  {
    line l = make_noisy_line(100, eps, seed);
    double found[3];
    size_t coefficients = 0;
    const int32_t method[3] = { CHI_SPLINE_PROGRESSIVE, CHI_SPLINE_INTERPOLATE,
      CHI_SPLINE_LEAST_SQUARES };
    for (int k = 0; k < 3; ++k)
    {
      chi_spline_curve c;
      chi_spline* s = fit_with(&l, 2 * eps, method[k], k == 2 ? coefficients : 0, &c);
      int changes;
      coefficients = k == 0 ? c.count : coefficients;
      found[k] = turning(&c, &changes);
      chi_spline_destroy(NULL, s);
    }
    CHECK(found[0] <= 0.5 * found[1]);
    CHECK(found[0] <= found[2]);
    free(l.x);
  }
}

static double distance_to_polyline(const line* l, const double p[3])
{
  double best = INFINITY;
  for (size_t i = 0; i + 1 < l->n; ++i)
  {
    double ab = 0, ap = 0, square = 0;
    for (int k = 0; k < 3; ++k)
    {
      ab += (l->x[i + 1][k] - l->x[i][k]) * (l->x[i + 1][k] - l->x[i][k]);
      ap += (l->x[i + 1][k] - l->x[i][k]) * (p[k] - l->x[i][k]);
    }
    const double t = ab > 0 ? fmin(fmax(ap / ab, 0), 1) : 0;
    for (int k = 0; k < 3; ++k)
    {
      const double d = l->x[i][k] + t * (l->x[i + 1][k] - l->x[i][k]) - p[k];
      square += d * d;
    }
    best = fmin(best, square);
  }
  return sqrt(best);
}

static line random_walk(uint32_t seed, size_t n)
{
  line l = make_line(n);
  double at[3] = { 0 }, heading[3] = { 1, 0, 0 };
  for (size_t i = 0; i < n; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      heading[k] = 0.7 * heading[k] + 0.6 * (chi_test_random(&seed) - 0.5);
      at[k] += heading[k] * (i % 7 ? 1 : 0.01);
      l.x[i][k] = at[k];
    }
  }
  return l;
}

static void the_reported_error_bounds_the_hausdorff_distance(void)
{
  for (uint32_t seed = 1; seed <= 12; ++seed)
  {
    line l = random_walk(seed, 60);
    chi_spline_curve c;
    chi_spline* s = fit(&l, 0.01 * seed, CHI_SPLINE_PROGRESSIVE, &c);
    chi_spline_stats stats;
    chi_spline_get_stats(s, &stats);
    CHECK(stats.unconverged == 0);
    CHECK(stats.max_point_error <= 0.01 * seed * (1 + 1e-9));
    const int steps = 6000;
    double(*dense)[3] = malloc((steps + 1) * sizeof *dense);
    double forward = 0, backward = 0;
    for (int i = 0; i <= steps; ++i)
    {
      double x[1][3];
      chi_spline_evaluate(&c, (double)i / steps, 0, x);
      for (int k = 0; k < 3; ++k)
      {
        dense[i][k] = x[0][k] + c.origin[k];
      }
      forward = fmax(forward, distance_to_polyline(&l, dense[i]));
    }
    const line curve = { dense, { 0, steps + 1 }, (size_t)steps + 1 };
    for (size_t i = 0; i + 1 < l.n; ++i)
    {
      for (int part = 0; part <= 4; ++part)
      {
        double p[3];
        for (int k = 0; k < 3; ++k)
        {
          p[k] = l.x[i][k] + 0.25 * part * (l.x[i + 1][k] - l.x[i][k]);
        }
        backward = fmax(backward, distance_to_polyline(&curve, p));
      }
    }
    CHECK(forward <= c.max_error);
    CHECK(
      backward <= c.max_error * 1.001); /* chords of the dense sampling cut corners by < 0.1 % */
    free(dense);
    chi_spline_destroy(NULL, s);
    free(l.x);
  }
}

static void a_closed_line_closes(void)
{
  line l = make_line(73);
  for (size_t i = 0; i < l.n; ++i)
  {
    const double a = 6.28318530717958648 * (double)(i % 72) / 72;
    l.x[i][0] = 5 + cos(a);
    l.x[i][1] = sin(a);
    l.x[i][2] = 3;
  }
  chi_spline_curve c;
  chi_spline* s = fit(&l, 1e-4, CHI_SPLINE_PROGRESSIVE, &c);
  CHECK(c.closed == 1);
  double a[4][3], b[4][3];
  chi_spline_evaluate(&c, 0, 2, a);
  chi_spline_evaluate(&c, 1, 2, b);
  for (int order = 0; order < 3; ++order)
  {
    for (int k = 0; k < 3; ++k)
    {
      CHECK_NEAR(a[order][k], b[order][k], 1e-9 * pow(7, order)); /* du = 1 is a length of 2 pi */
    }
  }
  chi_spline_destroy(NULL, s);
  free(l.x);
}

static void scale_and_place_do_not_matter(void)
{
  line base = random_walk(3, 50);
  chi_spline_curve c0;
  chi_spline* s0 = fit(&base, 0.02, CHI_SPLINE_PROGRESSIVE, &c0);
  for (int k = 0; k < 4; ++k)
  {
    const double scale = k == 0 ? 1e-6 : k == 1 ? 1e6 : 1, shift = k == 2 ? 1e8 : 0;
    line l = make_line(base.n);
    for (size_t i = 0; i < base.n; ++i)
    {
      for (int a = 0; a < 3; ++a)
      {
        /* k == 3: a quarter turn about (1, 1, 1), coordinates cycled */
        l.x[i][a] = scale * base.x[i][k == 3 ? (a + 1) % 3 : a] + shift;
      }
    }
    chi_spline_curve c;
    chi_spline* s = fit(&l, 0.02 * scale, CHI_SPLINE_PROGRESSIVE, &c);
    CHECK(c.count == c0.count);
    /* At 1e8 the input itself is rounded to 1.5e-8. */
    const double bound = (k == 2 ? 1e-6 : 1e-9) * scale;
    for (int i = 0; i <= 100 && c.count == c0.count; ++i)
    {
      double a[1][3], b[1][3];
      chi_spline_evaluate(&c0, i / 100.0, 0, a);
      chi_spline_evaluate(&c, i / 100.0, 0, b);
      for (int x = 0; x < 3; ++x)
      {
        CHECK_NEAR(b[0][x], scale * a[0][k == 3 ? (x + 1) % 3 : x], bound);
      }
    }
    chi_spline_destroy(NULL, s);
    free(l.x);
  }
  chi_spline_destroy(NULL, s0);
  free(base.x);
}

static void degenerate_lines_are_counted_or_fitted(void)
{
  /* 0: one point; 1: all equal; 2: NaN; 3: repeats and a NaN inside; 4: go and return; 5: two
   * points; 6: three points; 7: none */
  const double nan = NAN;
  const double x[][3] = { { 1, 2, 3 }, { 4, 4, 4 }, { 4, 4, 4 }, { 4, 4, 4 }, { nan, 0, 0 },
    { 0, nan, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 1, 1, 1 }, { nan, nan, nan }, { 1, 1, 1 },
    { 2, 1, 3 }, { 3, 3, 3 }, { 3, 3, 3 }, { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 1, 0, 0 },
    { 0, 0, 1e-9 }, { 0, 0, 0 }, { 1, 1, 1 }, { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 } };
  const int64_t offsets[] = { 0, 1, 4, 6, 14, 19, 21, 24, 24 };
  const chi_lines_view view = { { x, 24, sizeof x[0], CHI_F64 }, offsets, NULL, 8 };
  const chi_spline_params params = { .struct_size = sizeof params, .tolerance = 1e-3 };
  chi_spline* s = NULL;
  CHECK(chi_spline_create(NULL, &s) == CHI_OK);
  CHECK(chi_spline_fit(NULL, s, &view, &params) == CHI_OK);
  chi_spline_stats t;
  chi_spline_get_stats(s, &t);
  CHECK(t.curves == 4 && t.skipped_lines == 4);
  CHECK(t.skipped[CHI_SPLINE_TOO_FEW_POINTS] == 2 && t.skipped[CHI_SPLINE_ALL_EQUAL] == 1);
  CHECK(t.skipped[CHI_SPLINE_NOT_FINITE] == 1);
  CHECK(t.non_finite_points == 3 && t.repeated_points == 2 + 3);
  CHECK(t.unconverged == 0 && t.max_point_error <= 1e-3);
  for (size_t i = 0; i < 8; ++i)
  {
    chi_spline_curve c;
    chi_spline_get_curve(s, i, &c);
    for (int k = 0; k <= 50 && c.count; ++k)
    {
      double p[4][3];
      chi_spline_evaluate(&c, k / 50.0, 3, p);
      CHECK(isfinite(p[0][0] + p[1][1] + p[2][2] + p[3][0]));
    }
  }
  chi_spline_destroy(NULL, s);
}

static void merging_near_points_keeps_the_ends(void)
{
  /* the last points of both lines lie nearer to the ones before than merge_distance */
  const double x[][3] = { { 0, 0, 0 }, { 1, 1, 0 }, { 2, 0, 0 }, { 3, 1, 0 }, { 3.001, 1, 0 },
    { 0, 0, 5 }, { 2, 0, 5 }, { 2, 2, 5 }, { 0, 2, 5 }, { 0, 0.001, 5 }, { 0, 0, 5 } };
  const int64_t offsets[] = { 0, 5, 11 };
  double kept[11][3];
  memcpy(kept, x, sizeof x);
  const chi_lines_view view = { { x, 11, sizeof x[0], CHI_F64 }, offsets, NULL, 2 };
  const chi_spline_params params = {
    .struct_size = sizeof params, .tolerance = 1e-4, .merge_distance = 0.01
  };
  chi_spline* s = NULL;
  CHECK(chi_spline_create(NULL, &s) == CHI_OK);
  CHECK(chi_spline_fit(NULL, s, &view, &params) == CHI_OK);
  chi_spline_curve c;
  double p[1][3];
  chi_spline_get_curve(s, 0, &c);
  chi_spline_evaluate(&c, 1, 0, p);
  CHECK(p[0][0] == 3.001 && p[0][1] == 1);
  chi_spline_get_curve(s, 1, &c);
  CHECK(c.closed == 1 && c.point_count == 5);
  CHECK(c.point_indices[4] == 5);
  chi_spline_stats t;
  chi_spline_get_stats(s, &t);
  CHECK(t.repeated_points == 2 && t.unconverged == 0);
  CHECK(memcmp(x, kept, sizeof x) == 0); /* the input is as it was */
  chi_spline_destroy(NULL, s);
}

static void unequal_segments_do_not_distort(void)
{
  line l = make_line(41);
  double at = 0;
  for (size_t i = 0; i < l.n; ++i)
  {
    l.x[i][0] = cos(at);
    l.x[i][1] = sin(at);
    l.x[i][2] = 0;
    at += i % 2 ? 0.1 : 0.0001;
  }
  chi_spline_curve c;
  chi_spline* s = fit(&l, 1e-3, CHI_SPLINE_PROGRESSIVE, &c);
  for (int i = 0; i <= 1000; ++i)
  {
    double x[1][3];
    chi_spline_evaluate(&c, i / 1000.0, 0, x);
    const double r = hypot(x[0][0] + c.origin[0], x[0][1] + c.origin[1]);
    /* the tolerance, and the sagitta 0.1^2 / 8 of what the polyline cuts off */
    CHECK_NEAR(r, 1.0, 1e-3 + 1.25e-3);
  }
  chi_spline_destroy(NULL, s);
  free(l.x);
}

static void schedules_strides_and_types_agree(void)
{
  enum
  {
    LINES = 40,
    POINTS = 30
  };
  static float x32[LINES * POINTS][3];
  static double x64[LINES * POINTS][5];
  int64_t offsets[LINES + 1];
  uint32_t seed = 5;
  for (int i = 0; i < LINES * POINTS; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      /* volatile: gcc 12 at -O3 otherwise drops the rounding to float on the way to x64 */
      const volatile float x = (float)((i % POINTS) * (k == 0) + chi_test_random(&seed));
      x32[i][k] = x;
      x64[i][k] = (double)x;
    }
  }
  for (int i = 0; i <= LINES; ++i)
  {
    offsets[i] = i * POINTS;
  }
  const chi_lines_view a = { { x32, LINES * POINTS, sizeof x32[0], CHI_F32 }, offsets, NULL,
    LINES };
  const chi_lines_view b = { { x64, LINES * POINTS, sizeof x64[0], CHI_F64 }, offsets, NULL,
    LINES };
  const chi_spline_params params = { .struct_size = sizeof params, .tolerance = 0.1 };
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  chi_spline *s = NULL, *t = NULL;
  CHECK(chi_spline_create(NULL, &s) == CHI_OK && chi_spline_create(&backwards, &t) == CHI_OK);
  CHECK(chi_spline_fit(NULL, s, &a, &params) == CHI_OK);
  CHECK(chi_spline_fit(&backwards, t, &b, &params) == CHI_OK);
  for (size_t i = 0; i < LINES; ++i)
  {
    chi_spline_curve c, d;
    chi_spline_get_curve(s, i, &c);
    chi_spline_get_curve(t, i, &d);
    CHECK(c.count == d.count && c.max_error == d.max_error);
    CHECK(memcmp(c.coefficients, d.coefficients, 3 * c.count * sizeof(double)) == 0);
    CHECK(memcmp(c.knots, d.knots, (c.count + 4) * sizeof(double)) == 0);
  }
  /* refused allocations, cancellation at each poll: reported, nothing leaks, the handle lives on */
  for (long at = 0; at < 40; ++at)
  {
    chi_test_host host = { .refuse_at = at, .cancel_at = 1 << 30 };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    chi_spline* u = NULL;
    chi_status status = chi_spline_create(&exec, &u);
    CHECK(status == (at == 0 ? CHI_ERROR_OUT_OF_MEMORY : CHI_OK));
    if (u)
    {
      status = chi_spline_fit(&exec, u, &a, &params);
      CHECK(status == (host.allocations > at ? CHI_ERROR_OUT_OF_MEMORY : CHI_OK));
      CHECK(status != CHI_OK || chi_spline_count(u) == LINES);
    }
    chi_spline_destroy(&exec, u);
    CHECK(host.live == 0);
    host = (chi_test_host){ .refuse_at = -1, .cancel_at = at };
    const chi_exec cancelling = { .struct_size = sizeof cancelling,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release,
      .is_cancelled = chi_test_is_cancelled };
    CHECK(chi_spline_create(&cancelling, &u) == CHI_OK);
    CHECK(chi_spline_fit(&cancelling, u, &a, &params) == CHI_ERROR_CANCELLED);
    CHECK(chi_spline_count(u) == 0);
    chi_spline_destroy(&cancelling, u);
    CHECK(host.live == 0);
  }
  chi_spline_destroy(NULL, s);
  chi_spline_destroy(&backwards, t);
}

static void bad_arguments_are_named(void)
{
  chi_spline* s = NULL;
  const double x[2][3] = { { 0, 0, 0 }, { 1, 0, 0 } };
  const int64_t outside[2] = { 0, 3 }, none[1] = { 0 };
  const chi_lines_view bad = { { x, 2, sizeof x[0], CHI_F64 }, outside, NULL, 1 };
  const chi_lines_view empty = { { NULL, 0, sizeof x[0], CHI_F64 }, none, NULL, 0 };
  chi_spline_params params = { .struct_size = sizeof params, .tolerance = 1 };
  CHECK(chi_spline_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_spline_create(NULL, &s) == CHI_OK);
  CHECK(chi_spline_fit(NULL, s, &bad, &params) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_spline_fit(NULL, s, &empty, &params) == CHI_OK && chi_spline_count(s) == 0);
  params.tolerance = NAN;
  CHECK(chi_spline_fit(NULL, s, &empty, &params) == CHI_ERROR_INVALID_ARGUMENT);
  chi_spline_destroy(NULL, s);
  chi_spline_destroy(NULL, NULL);
}

int main(void)
{
  plane_curves_get_no_wiggle();
  noise_within_the_tolerance_is_not_followed();
  the_reported_error_bounds_the_hausdorff_distance();
  a_closed_line_closes();
  scale_and_place_do_not_matter();
  degenerate_lines_are_counted_or_fitted();
  merging_near_points_keeps_the_ends();
  unequal_segments_do_not_distort();
  schedules_strides_and_types_agree();
  bad_arguments_are_named();
  return chi_test_report();
}
