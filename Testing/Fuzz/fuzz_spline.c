/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fits of any lines: refused where the header says so, else finite curves whose parts agree. */

#include "fuzz.h"

static void check_curve(const chi_spline_curve* c, fuzz* f)
{
  FUZZ_CHECK(c->degree == 1 || c->degree == 3);
  FUZZ_CHECK(c->reason == CHI_SPLINE_USED && c->count > (size_t)c->degree);
  FUZZ_CHECK(isfinite(c->length) && c->length > 0 && c->max_error >= 0);
  for (size_t i = 0; i < 3 * c->count; ++i)
  {
    FUZZ_CHECK(isfinite(c->coefficients[i]));
  }
  const size_t knots = c->count + (size_t)c->degree + 1;
  for (size_t i = 0; i < knots; ++i)
  {
    FUZZ_CHECK(isfinite(c->knots[i]) && (i == 0 || c->knots[i] >= c->knots[i - 1]));
  }
  FUZZ_CHECK(c->knots[c->degree] == 0 && c->knots[c->count] == 1);
  FUZZ_CHECK(c->point_count >= 2);
  for (size_t i = 0; i < c->point_count; ++i)
  {
    FUZZ_CHECK(fuzz_is_in(c->point_parameters[i], 0, 1) && c->point_indices[i] >= 0);
    FUZZ_CHECK(i == 0 ||
      (c->point_parameters[i] >= c->point_parameters[i - 1] &&
        c->point_indices[i] > c->point_indices[i - 1]));
  }
  for (int i = 0; i < 6; ++i)
  {
    const double u = i < 2 ? i
      : i == 2             ? fuzz_any(f)
                           : c->point_parameters[fuzz_upto(f, c->point_count - 1)];
    double x[4][3];
    const int32_t order = (int32_t)fuzz_upto(f, 3);
    chi_spline_evaluate(c, u, order, x);
    for (int k = 0; k < 3 * (order + 1); ++k)
    {
      /* a derivative divides by knot distances of down to 1e-16, three times */
      FUZZ_CHECK(isfinite(x[k / 3][k % 3]) || (k >= 3 && c->length > 1e100));
    }
  }
}

/* Two handles hold the same bits. */
static void check_same(const chi_spline* a, const chi_spline* b)
{
  FUZZ_CHECK(chi_spline_count(a) == chi_spline_count(b));
  for (size_t i = 0; i < chi_spline_count(a); ++i)
  {
    chi_spline_curve c, d;
    chi_spline_get_curve(a, i, &c);
    chi_spline_get_curve(b, i, &d);
    FUZZ_CHECK(c.count == d.count && c.degree == d.degree && c.reason == d.reason &&
      c.closed == d.closed && memcmp(&c.max_error, &d.max_error, sizeof c.max_error) == 0);
    if (c.count)
    {
      FUZZ_CHECK(memcmp(c.coefficients, d.coefficients, 3 * c.count * sizeof(double)) == 0);
    }
  }
}

static void check_fit(fuzz* f, const chi_spline* s, const chi_lines_view* lines)
{
  chi_spline_stats stats;
  chi_spline_get_stats(s, &stats);
  FUZZ_CHECK(chi_spline_count(s) == lines->line_count);
  FUZZ_CHECK(stats.curves + stats.skipped_lines == lines->line_count);
  FUZZ_CHECK(stats.skipped[0] == 0 &&
    stats.skipped[1] + stats.skipped[2] + stats.skipped[3] == stats.skipped_lines);
  size_t curves = 0;
  for (size_t i = 0; i < lines->line_count; ++i)
  {
    chi_spline_curve c;
    chi_spline_get_curve(s, i, &c);
    curves += c.count > 0;
    FUZZ_CHECK((c.count > 0) == (c.reason == CHI_SPLINE_USED));
    FUZZ_CHECK(c.reason >= 0 && c.reason <= CHI_SPLINE_NOT_FINITE);
    if (c.count)
    {
      check_curve(&c, f);
      FUZZ_CHECK(c.point_indices[c.point_count - 1] < lines->offsets[i + 1] - lines->offsets[i]);
      FUZZ_CHECK(c.max_error <= stats.max_error);
    }
    else
    {
      double x[4][3];
      chi_spline_evaluate(&c, fuzz_any(f), 3, x); /* infallible */
    }
  }
  FUZZ_CHECK(curves == stats.curves);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  chi_exec exec = fuzz_host(f, 1000);
  chi_spline* s = NULL;
  chi_status status = chi_spline_create(&exec, &s);
  fuzz_after(f, status);
  FUZZ_CHECK((status == CHI_OK) == (s != NULL));
  for (int round = 0; s && round < 3; ++round) /* one handle, several fits */
  {
    const size_t kept = f->kept_count;
    double extent;
    const chi_lines_view lines = fuzz_lines(f, &extent);
    const chi_spline_params params = fuzz_spline_params(f);
    const int valid = fuzz_lines_are_valid(&lines) && fuzz_spline_params_are_valid(&params);
    exec = fuzz_host(f, 1000);
    status = chi_spline_fit(&exec, s, &lines, &params);
    fuzz_after(f, status);
    FUZZ_CHECK((status == CHI_ERROR_INVALID_ARGUMENT) == !valid);
    FUZZ_CHECK(status != CHI_ERROR_TOO_LARGE);
    if (status == CHI_OK)
    {
      check_fit(f, s, &lines);
      chi_spline* other = NULL;
      FUZZ_CHECK(chi_spline_create(NULL, &other) == CHI_OK);
      FUZZ_CHECK(chi_spline_fit(NULL, other, &lines, &params) == CHI_OK);
      check_same(s, other);
      chi_spline_destroy(NULL, other);
    }
    else
    {
      chi_spline_stats stats;
      chi_spline_get_stats(s, &stats);
      FUZZ_CHECK(chi_spline_count(s) == 0 && stats.curves == 0 && stats.skipped_lines == 0);
    }
    chi_spline_curve none;
    chi_spline_get_curve(s, lines.line_count + fuzz_upto(f, 3), &none);
    FUZZ_CHECK(none.count == 0 && none.coefficients == NULL);
    fuzz_forget(f, kept);
  }
  exec = fuzz_host(f, 1000);
  chi_spline_destroy(&exec, s);
  fuzz_end(f);
  return 0;
}
