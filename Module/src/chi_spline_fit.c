/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Fit of one line. Schott et al. 2013, section 4.1: the samples are the first coefficients, which
 * by the variation-diminishing property adds no wiggle; the coefficients then move towards the
 * samples, and stop as soon as the tolerance holds; then the number of samples is halved while it
 * still does.
 */

#include "chi_spline_fit.h"

#include <string.h>

enum
{
  DEGREE = 3,
  DEFAULT_ITERATIONS = 64, /* the slowest component falls by 2/3 an iteration: (2/3)^64 = 5e-12 */
  DEFAULT_HALVINGS = 16,
  /* Components that a spline on the samples' own knots interpolates: PIA needs so many rounds for
   * (2/3)^n = 1e-14, double precision. */
  INTERPOLATION_ITERATIONS = 80
};

int chi_spline_scratch_create(const chi_exec* exec, chi_spline_scratch* s, size_t points)
{
  const size_t n = points + 4;
  const size_t doubles = n * (4 + 3 + 1 + 3) + (n + 3) * 3 + (n + 7);
  s->bytes = doubles * sizeof(double) + n * sizeof(size_t);
  s->block = (double*)chi_alloc(exec, s->bytes, 1);
  if (!s->block)
  {
    return 0;
  }
  s->basis = s->block;
  s->sample = s->basis + 4 * n;
  s->parameter = s->sample + 3 * n;
  s->delta = s->parameter + n;
  s->coefficient = s->delta + 3 * n;
  s->knot = s->coefficient + 3 * (n + 3);
  s->span = (size_t*)(void*)(s->knot + n + 7);
  return 1;
}

void chi_spline_scratch_destroy(const chi_exec* exec, chi_spline_scratch* s)
{
  chi_free(exec, s->block, s->bytes, 1);
}

/* The candidate curve of `m` samples in scratch; open or periodic. */
typedef struct candidate
{
  chi_spline_curve curve;
  size_t samples;
} candidate;

static size_t control_count(const candidate* c)
{
  return c->samples + (c->curve.closed ? DEGREE : 0);
}

/* Knots whose Greville abscissae lie at the samples' parameters, or close to them: averages of
 * three (open), the parameters themselves (periodic: the average of a symmetric neighbourhood). */
static void place_knots(candidate* c, chi_spline_scratch* s)
{
  const size_t m = c->samples;
  const double* const t = s->parameter;
  double* const knot = s->knot;
  if (c->curve.closed)
  {
    for (size_t j = 0; j < m + 2 * DEGREE + 1; ++j)
    {
      const ptrdiff_t i = (ptrdiff_t)j - DEGREE, period = (ptrdiff_t)m;
      ptrdiff_t wrapped = i % period, turns = i / period;
      if (wrapped < 0)
      {
        wrapped += period;
        --turns;
      }
      knot[j] = t[wrapped] + (double)turns;
    }
    return;
  }
  for (size_t j = 0; j <= DEGREE; ++j)
  {
    knot[j] = 0;
    knot[m + j] = 1;
  }
  for (size_t j = 1; j + DEGREE < m; ++j)
  {
    knot[j + DEGREE] = (t[j] + t[j + 1] + t[j + 2]) / 3;
  }
}

static void repeat_first_controls(candidate* c, chi_spline_scratch* s)
{
  if (c->curve.closed)
  {
    for (size_t j = 0; j < DEGREE; ++j)
    {
      memcpy(s->coefficient + 3 * (c->samples + j), s->coefficient + 3 * j, 3 * sizeof(double));
    }
  }
}

/* Control that belongs to a sample: itself, or, periodic, the middle one of the three at its knot.
 */
static size_t control_of(const candidate* c, size_t sample)
{
  return c->curve.closed ? (sample + 1) % c->samples : sample;
}

static void start_from_samples(candidate* c, chi_spline_scratch* s)
{
  place_knots(c, s);
  c->curve.coefficients = s->coefficient;
  c->curve.knots = s->knot;
  c->curve.count = control_count(c);
  c->curve.degree = DEGREE;
  size_t span = DEGREE;
  for (size_t i = 0; i < c->samples; ++i)
  {
    memcpy(s->coefficient + 3 * control_of(c, i), s->sample + 3 * i, 3 * sizeof(double));
    while (span + 1 < c->curve.count && !(s->parameter[i] < s->knot[span + 1]))
    {
      ++span;
    }
    s->span[i] = span;
    chi_spline_basis(s->knot, span, DEGREE, s->parameter[i], s->basis + 4 * i);
  }
  repeat_first_controls(c, s);
}

static void combine(const double* coefficients, const double basis[4], double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = basis[0] * coefficients[k] + basis[1] * coefficients[3 + k] +
      basis[2] * coefficients[6 + k] + basis[3] * coefficients[9 + k];
  }
}

/* One round: every coefficient moves by what its sample still lacks. Returns the largest move. */
static double move_coefficients(candidate* c, chi_spline_scratch* s)
{
  double largest = 0;
  for (size_t i = 0; i < c->samples; ++i)
  {
    double at[3];
    combine(s->coefficient + 3 * (s->span[i] - DEGREE), s->basis + 4 * i, at);
    double square = 0;
    for (int k = 0; k < 3; ++k)
    {
      s->delta[3 * i + (size_t)k] = s->sample[3 * i + (size_t)k] - at[k];
      square += s->delta[3 * i + (size_t)k] * s->delta[3 * i + (size_t)k];
    }
    largest = square > largest ? square : largest;
  }
  for (size_t i = 0; i < c->samples; ++i)
  {
    double* const control = s->coefficient + 3 * control_of(c, i);
    for (size_t k = 0; k < 3; ++k)
    {
      control[k] += s->delta[3 * i + k];
    }
  }
  repeat_first_controls(c, s);
  return sqrt(largest);
}

/* Distance of p to its projection on the curve near u, which moves there, within [low, high]. */
static double project(
  const chi_spline_curve* c, const double p[3], double low, double high, double* u)
{
  double best = INFINITY, at = *u;
  for (int round = 0; round < 4; ++round)
  {
    double x[3][3];
    chi_spline_evaluate(c, at, 2, x);
    const double distance = chi_distance(x[0], p);
    if (distance < best)
    {
      best = distance;
      *u = at;
    }
    double f = 0, slope = 0, speed = 0;
    for (int k = 0; k < 3; ++k)
    {
      const double gap = x[0][k] - p[k];
      f += gap * x[1][k];
      speed += x[1][k] * x[1][k];
      slope += gap * x[2][k];
    }
    slope = speed + slope > 0.1 * speed ? speed + slope : speed; /* Newton, else Gauss-Newton */
    const double next = slope > 0 ? at - f / slope : at;
    const double clamped = next < low ? low : next > high ? high : next;
    if (!(fabs(clamped - at) > 1e-12))
    {
      break;
    }
    at = clamped;
  }
  return best;
}

static double neighbour(const chi_spline_curve* c, size_t i, int step)
{
  const size_t n = c->point_count;
  return step < 0 ? (i > 0 ? c->point_parameters[i - 1] : 0)
                  : (i + 1 < n ? c->point_parameters[i + 1] : 1);
}

/* Whether all input points lie within the tolerance; looks first where it failed last. */
static int holds(const chi_spline_curve* c, const double* points, double tolerance, size_t* suspect)
{
  const size_t n = c->point_count;
  size_t span = DEGREE;
  for (size_t k = 0; k <= n; ++k)
  {
    const size_t i = k == 0 ? *suspect : k - 1;
    double u = c->point_parameters[i], basis[4], at[3];
    span = chi_spline_span(c, u, k == 1 ? DEGREE : span);
    if (k > 0 && !(c->knots[span] <= u && u <= c->knots[span + 1]))
    {
      span = chi_spline_span(c, u, span);
    }
    chi_spline_basis(c->knots, span, DEGREE, u, basis);
    combine(c->coefficients + 3 * (span - DEGREE), basis, at);
    if (!(chi_distance(at, points + 3 * i) <= tolerance) &&
      !(project(c, points + 3 * i, neighbour(c, i, -1), neighbour(c, i, 1), &u) <= tolerance))
    {
      *suspect = i;
      return 0;
    }
    if (i + 1 < n && k > 0)
    {
      /* the next point lies in this span or a later one */
      while (span + 1 < c->count && c->knots[span + 1] <= c->point_parameters[i + 1])
      {
        ++span;
      }
    }
  }
  return 1;
}

/* Move until the tolerance holds, or nothing moves any more. */
static int fit_candidate(
  candidate* c, chi_spline_scratch* s, const double* points, const chi_spline_params* params)
{
  const int interpolate = params->method == CHI_SPLINE_INTERPOLATE;
  const int rounds = interpolate ? INTERPOLATION_ITERATIONS
    : params->max_iterations > 0 ? params->max_iterations
                                 : DEFAULT_ITERATIONS;
  size_t suspect = 0;
  start_from_samples(c, s);
  for (int round = 0; round < rounds; ++round)
  {
    if (!interpolate && holds(&c->curve, points, params->tolerance, &suspect))
    {
      return 1;
    }
    /* A thousandth of the tolerance cannot mend what is still outside of it. */
    if (move_coefficients(c, s) <= 1e-3 * params->tolerance && !interpolate)
    {
      break;
    }
  }
  return holds(&c->curve, points, params->tolerance, &suspect);
}

/* Least squares on the candidate's knots with the end points kept (Piegl & Tiller 1997,
 * section 9.4.1): normal equations, a band of seven, Cholesky. */
static void fit_least_squares(candidate* c, chi_spline_scratch* s, const double* points)
{
  const size_t n = c->curve.point_count, m = c->samples;
  double(*const band)[4] = (double(*)[4])(void*)s->basis; /* no longer needed: lower half of N'N */
  double* const right = s->delta;
  memset(band, 0, m * sizeof *band);
  memset(right, 0, 3 * m * sizeof *right);
  for (size_t i = 0; i < n; ++i)
  {
    const double u = c->curve.point_parameters[i];
    const size_t span = chi_spline_span(&c->curve, u, DEGREE), first = span - DEGREE;
    double basis[4];
    chi_spline_basis(s->knot, span, DEGREE, u, basis);
    for (size_t a = 0; a < 4; ++a)
    {
      for (size_t b = 0; b <= a; ++b)
      {
        band[first + a][a - b] += basis[a] * basis[b];
      }
      for (size_t k = 0; k < 3; ++k)
      {
        right[3 * (first + a) + k] += basis[a] * points[3 * i + k];
      }
    }
  }
  /* The ends are known: their rows say so, and what they contribute moves to the right-hand side.
   */
  for (size_t end = 0; end < m; end += m - 1)
  {
    const double* const x = points + (end ? 3 * (n - 1) : 0);
    for (size_t i = 0; i < m; ++i)
    {
      const size_t low = i < end ? i : end, gap = i < end ? end - i : i - end;
      if (i != end && gap <= DEGREE)
      {
        double* const entry = &band[low + gap][gap];
        for (size_t k = 0; k < 3; ++k)
        {
          right[3 * i + k] -= *entry * x[k];
        }
        *entry = 0;
      }
    }
    band[end][0] = 1;
    memcpy(right + 3 * end, x, 3 * sizeof *x);
  }
  for (size_t i = 0; i < m; ++i)
  {
    band[i][0] += 1e-12; /* a coefficient that no point sees stays where it is put: at zero */
    for (size_t j = i >= DEGREE ? i - DEGREE : 0; j <= i; ++j)
    {
      double sum = band[i][i - j];
      for (size_t k = i >= DEGREE ? i - DEGREE : 0; k < j; ++k)
      {
        sum -= j - k <= DEGREE ? band[i][i - k] * band[j][j - k] : 0;
      }
      band[i][i - j] = i == j ? sqrt(sum > 0 ? sum : 1e-300) : sum / band[j][0];
    }
  }
  for (size_t k = 0; k < 3; ++k)
  {
    for (size_t i = 0; i < m; ++i)
    {
      for (size_t j = i >= DEGREE ? i - DEGREE : 0; j < i; ++j)
      {
        right[3 * i + k] -= band[i][i - j] * right[3 * j + k];
      }
      right[3 * i + k] /= band[i][0];
    }
    for (size_t i = m; i-- > 0;)
    {
      for (size_t j = i + 1; j < m && j - i <= DEGREE; ++j)
      {
        right[3 * i + k] -= band[j][j - i] * right[3 * j + k];
      }
      right[3 * i + k] /= band[i][0];
    }
  }
  memcpy(s->coefficient, right, 3 * m * sizeof *right);
}

static void accept(chi_spline_line* line, const candidate* c, double* coefficients, double* knots)
{
  memcpy(coefficients, c->curve.coefficients, 3 * c->curve.count * sizeof *coefficients);
  memcpy(knots, c->curve.knots, (c->curve.count + DEGREE + 1) * sizeof *knots);
  line->curve.coefficients = coefficients;
  line->curve.knots = knots;
  line->curve.count = c->curve.count;
  line->curve.degree = DEGREE;
}

/* The first candidate: the cleaned points, with midpoints where there are too few for a cubic. */
static void sample_points(
  candidate* c, chi_spline_scratch* s, const chi_spline_line* line, const double* points)
{
  const size_t n = line->curve.point_count, used = line->curve.closed ? n - 1 : n;
  const int halve = used < 4;
  c->curve = line->curve;
  c->samples = 0;
  for (size_t i = 0; i < used; ++i)
  {
    for (int part = 0; part <= (halve && i + 1 < n ? 1 : 0); ++part)
    {
      const size_t next = i + 1 < n ? i + 1 : i;
      const double w = 0.5 * part;
      s->parameter[c->samples] =
        (1 - w) * line->curve.point_parameters[i] + w * line->curve.point_parameters[next];
      for (size_t k = 0; k < 3; ++k)
      {
        s->sample[3 * c->samples + k] = (1 - w) * points[3 * i + k] + w * points[3 * next + k];
      }
      ++c->samples;
    }
  }
}

/* The candidate, resampled at `m` regular parameters: the samples of the next one. */
static void resample(candidate* c, chi_spline_scratch* s, size_t m)
{
  for (size_t j = 0; j < m; ++j)
  {
    s->parameter[j] = (double)j / (double)(c->curve.closed ? m : m - 1);
    chi_spline_evaluate(&c->curve, s->parameter[j], 0, (double(*)[3])(void*)(s->sample + 3 * j));
  }
  c->samples = m;
}

/* A line that bends by less than the tolerance and never turns back is its two end points. */
static int is_straight(
  const chi_spline_line* line, const double* points, double tolerance, double* error)
{
  const size_t n = line->curve.point_count;
  const double* const end = points + 3 * (n - 1);
  const double length = chi_distance(points, end);
  double before = 0;
  *error = 0;
  if (line->curve.closed || !(length > 0))
  {
    return 0;
  }
  for (size_t i = 1; i < n; ++i)
  {
    double along = 0, square = 0;
    for (size_t k = 0; k < 3; ++k)
    {
      along += points[3 * i + k] * (end[k] / length);
    }
    for (size_t k = 0; k < 3; ++k)
    {
      const double off = points[3 * i + k] - along * (end[k] / length);
      square += off * off;
    }
    if (!(sqrt(square) <= tolerance) || along < before)
    {
      return 0;
    }
    *error = fmax(*error, sqrt(square));
    before = along;
  }
  return 1;
}

/* The polar form of the curve's piece on a span: its Bezier points on any part of it. Ramshaw 1989.
 */
static void blossom(const chi_spline_curve* c, size_t span, const double at[3], double out[3])
{
  double d[4][3];
  memcpy(d, c->coefficients + 3 * (span - DEGREE), sizeof d);
  for (size_t r = 1; r <= DEGREE; ++r)
  {
    for (size_t j = DEGREE; j >= r; --j)
    {
      const double low = c->knots[span - DEGREE + j], high = c->knots[span + 1 + j - r];
      const double w = high > low ? (at[r - 1] - low) / (high - low) : 0;
      for (int k = 0; k < 3; ++k)
      {
        d[j][k] += (1 - w) * (d[j - 1][k] - d[j][k]);
      }
    }
  }
  memcpy(out, d[DEGREE], sizeof d[0]);
}

static double segment_distance(const double p[3], const double a[3], const double b[3])
{
  double ab = 0, ap = 0, q[3];
  for (int k = 0; k < 3; ++k)
  {
    ab += (b[k] - a[k]) * (b[k] - a[k]);
    ap += (b[k] - a[k]) * (p[k] - a[k]);
  }
  const double t = ab > 0 ? fmin(fmax(ap / ab, 0), 1) : 0;
  for (int k = 0; k < 3; ++k)
  {
    q[k] = a[k] + t * (b[k] - a[k]);
  }
  return chi_distance(p, q);
}

/* Largest distance of the curve between two parameters to a segment: at most that of the Bezier
 * points of its pieces, since the distance to a segment is convex. */
static double piece_distance(
  const chi_spline_curve* c, double from, double to, const double a[3], const double b[3])
{
  double largest = 0;
  size_t span = chi_spline_span(c, from, DEGREE);
  for (double low = from; low < to || low == from;)
  {
    const double high = span + 1 < c->count ? fmin(c->knots[span + 1], to) : to;
    const double at[5] = { low, low, low, high, high };
    for (int k = 0; k < 4; ++k)
    {
      const double argument[3] = { k > 2 ? high : at[0], k > 1 ? high : low, k > 0 ? high : low };
      double p[3];
      blossom(c, span, argument, p);
      largest = fmax(largest, segment_distance(p, a, b));
    }
    if (!(high < to))
    {
      break;
    }
    low = high;
    ++span;
  }
  return largest;
}

/*
 * Bounds of a cubic fit: each input point is projected to the curve (in order along it), each piece
 * of curve between two projections is compared with their segment. The pieces cover the curve; and
 * a point of the segment lies over a point of the piece, or beyond the projection of an end, and
 * then it is nearer to that end's projection than the end is. theory/spline.md, section 3.
 */
static void measure(chi_spline_line* line, const double* points)
{
  const chi_spline_curve* const c = &line->curve;
  const size_t n = c->point_count;
  double before = 0, bound = 0, error = 0;
  for (size_t i = 0; i < n; ++i)
  {
    double u = c->point_parameters[i];
    if (i > 0 && i + 1 < n)
    {
      u = fmax(u, before);
      error = fmax(error,
        project(c, points + 3 * i, fmax(before, neighbour(c, i, -1)), neighbour(c, i, 1), &u));
    }
    else
    {
      double at[1][3];
      chi_spline_evaluate(c, u, 0, at);
      error = fmax(error, chi_distance(at[0], points + 3 * i));
    }
    if (i > 0)
    {
      bound = fmax(bound, piece_distance(c, before, u, points + 3 * (i - 1), points + 3 * i));
    }
    before = u;
  }
  line->point_error = error;
  line->curve.max_error = fmax(bound, error) * (1 + 1e-12) + 1e-15 * c->length;
}

static void keep_polyline(chi_spline_line* line, const double* points, double* knots)
{
  const size_t n = line->curve.point_count;
  line->curve.coefficients = points;
  line->curve.knots = knots;
  line->curve.count = n;
  line->curve.degree = 1;
  knots[0] = 0;
  memcpy(knots + 1, line->curve.point_parameters, n * sizeof *knots);
  knots[n + 1] = 1;
}

static void keep_chord(
  chi_spline_line* line, const double* points, double* coefficients, double* knots)
{
  const size_t n = line->curve.point_count;
  memcpy(coefficients, points, 3 * sizeof *coefficients);
  memcpy(coefficients + 3, points + 3 * (n - 1), 3 * sizeof *coefficients);
  static const double ends[4] = { 0, 0, 1, 1 };
  memcpy(knots, ends, sizeof ends);
  line->curve.coefficients = coefficients;
  line->curve.knots = knots;
  line->curve.count = 2;
  line->curve.degree = 1;
}

void chi_spline_fit_line(chi_spline_line* line, const double* points, double* coefficients,
  double* knots, chi_spline_scratch* scratch, const chi_spline_params* params)
{
  double error = 0;
  if (!scratch)
  {
    keep_polyline(line, points, knots);
    return;
  }
  if (line->curve.point_count == 2 ||
    (params->method == CHI_SPLINE_PROGRESSIVE && params->max_halvings >= 0 &&
      is_straight(line, points, params->tolerance, &error)))
  {
    keep_chord(line, points, coefficients, knots);
    line->point_error = line->curve.point_count == 2 ? 0 : error;
    line->curve.max_error = line->point_error * (1 + 1e-12) + 1e-15 * line->curve.length;
    return;
  }
  candidate c;
  sample_points(&c, scratch, line, points);
  size_t m = c.samples;
  line->unconverged = !fit_candidate(&c, scratch, points, params);
  accept(line, &c, coefficients, knots);
  const int halvings = params->method == CHI_SPLINE_INTERPOLATE ? 0
    : params->max_halvings > 0                                  ? params->max_halvings
    : params->max_halvings < 0                                  ? 0
                                                                : DEFAULT_HALVINGS;
  const int least_squares = params->method == CHI_SPLINE_LEAST_SQUARES && !line->curve.closed;
  if (least_squares && params->coefficients >= 4 && params->coefficients <= m)
  {
    resample(&c, scratch, params->coefficients);
    start_from_samples(&c, scratch);
    fit_least_squares(&c, scratch, points);
    accept(line, &c, coefficients, knots);
    measure(line, points);
    line->unconverged = !(line->point_error <= params->tolerance);
    return;
  }
  for (int k = 0; k < halvings && m > 4 && !line->unconverged; ++k)
  {
    m = m / 2 > 4 ? m / 2 : 4;
    resample(&c, scratch, m);
    if (least_squares)
    {
      start_from_samples(&c, scratch);
      fit_least_squares(&c, scratch, points);
      size_t suspect = 0;
      if (!holds(&c.curve, points, params->tolerance, &suspect))
      {
        break;
      }
    }
    else if (!fit_candidate(&c, scratch, points, params))
    {
      break;
    }
    accept(line, &c, coefficients, knots);
  }
  measure(line, points);
  line->unconverged = !(line->point_error <= params->tolerance * (1 + 1e-12));
}
