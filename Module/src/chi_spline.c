/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The handle: cleaned points, storage of all curves in a few slabs, evaluation. The fit itself is
 * in chi_spline_fit.c. */

#include "chi_spline_fit.h"

#include <stdatomic.h>
#include <string.h>

/* Lines that one call of a parallel body takes; fixed, so that scratch and rounding do not depend
 * on the number of threads. */
enum
{
  LINES_A_CHUNK = 16
};

struct chi_spline
{
  chi_spline_line* lines;
  double* parameters;   /* [points] */
  int64_t* indices;     /* [points] */
  double* positions;    /* [points x 3], minus each line's origin */
  double* coefficients; /* [controls x 3] */
  double* knots;
  size_t line_capacity, point_capacity, control_capacity, knot_capacity;
  size_t line_count;
  chi_spline_stats stats;
};

chi_status chi_spline_create(const chi_exec* exec, chi_spline** spline)
{
  if (!spline)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *spline = (chi_spline*)chi_alloc(exec, 1, sizeof **spline);
  if (!*spline)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*spline, 0, sizeof **spline);
  (*spline)->stats.struct_size = sizeof(chi_spline_stats);
  return CHI_OK;
}

static void release(const chi_exec* exec, void* block, size_t count, size_t size)
{
  if (block)
  {
    chi_free(exec, block, count, size);
  }
}

static void free_storage(const chi_exec* exec, chi_spline* s)
{
  release(exec, s->lines, s->line_capacity, sizeof *s->lines);
  release(exec, s->parameters, s->point_capacity, sizeof *s->parameters);
  release(exec, s->indices, s->point_capacity, sizeof *s->indices);
  release(exec, s->positions, s->point_capacity, 3 * sizeof *s->positions);
  release(exec, s->coefficients, s->control_capacity, 3 * sizeof *s->coefficients);
  release(exec, s->knots, s->knot_capacity, sizeof *s->knots);
  memset(s, 0, sizeof *s);
  s->stats.struct_size = sizeof(chi_spline_stats);
}

void chi_spline_destroy(const chi_exec* exec, chi_spline* spline)
{
  if (spline)
  {
    free_storage(exec, spline);
    chi_free(exec, spline, 1, sizeof *spline);
  }
}

static chi_status reserve(
  const chi_exec* exec, chi_spline* s, size_t lines, size_t points, size_t controls, size_t knots)
{
  if (lines <= s->line_capacity && points <= s->point_capacity && controls <= s->control_capacity &&
    knots <= s->knot_capacity)
  {
    return CHI_OK;
  }
  free_storage(exec, s);
  lines = lines ? lines : 1;
  points = points ? points : 1;
  s->lines = (chi_spline_line*)chi_alloc(exec, lines, sizeof *s->lines);
  s->line_capacity = s->lines ? lines : 0;
  s->parameters = (double*)chi_alloc(exec, points, sizeof *s->parameters);
  s->indices = s->parameters ? (int64_t*)chi_alloc(exec, points, sizeof *s->indices) : NULL;
  s->positions = s->indices ? (double*)chi_alloc(exec, points, 3 * sizeof *s->positions) : NULL;
  s->point_capacity = points;
  s->coefficients = (double*)chi_alloc(exec, controls, 3 * sizeof *s->coefficients);
  s->control_capacity = controls;
  s->knots = (double*)chi_alloc(exec, knots, sizeof *s->knots);
  s->knot_capacity = knots;
  if (!s->lines || !s->positions || !s->coefficients || !s->knots)
  {
    free_storage(exec, s);
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  return CHI_OK;
}

typedef struct fit_job
{
  const chi_exec* exec;
  chi_spline* spline;
  const chi_lines_view* lines;
  const chi_spline_params* params;
  atomic_int refused;
} fit_job;

static int64_t point_id(const chi_lines_view* lines, int64_t at)
{
  return lines->connectivity ? lines->connectivity[at] : at;
}

/* Drop non-finite points and repeats; chord-length parameters. */
static void clean_line(const fit_job* job, size_t i)
{
  chi_spline* const s = job->spline;
  chi_spline_line* const line = &s->lines[i];
  const int64_t begin = job->lines->offsets[i], end = job->lines->offsets[i + 1];
  double* const position = s->positions + 3 * line->point_start;
  double* const parameter = s->parameters + line->point_start;
  int64_t* const index = s->indices + line->point_start;
  size_t count = 0;
  double length = 0;
  int64_t first = -1, last = -1;
  int tail = 0; /* the last point so far was merged into the one before it */
  double end_point[3] = { 0, 0, 0 };
  for (int64_t k = begin; k < end; ++k)
  {
    double x[3];
    chi_view_get(&job->lines->points, (size_t)point_id(job->lines, k), x);
    if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
    {
      ++line->non_finite;
      continue;
    }
    if (count == 0)
    {
      memcpy(line->curve.origin, x, sizeof x);
      first = k;
    }
    last = k;
    for (int c = 0; c < 3; ++c)
    {
      x[c] -= line->curve.origin[c];
    }
    const double step = count ? chi_distance(x, position + 3 * (count - 1)) : 0;
    tail = count && !(step > job->params->merge_distance && step > 0) && step > 0;
    if (count && !(step > job->params->merge_distance && step > 0))
    {
      memcpy(end_point, x, sizeof x);
      ++line->repeated;
      continue;
    }
    length += step;
    memcpy(position + 3 * count, x, sizeof x);
    parameter[count] = length;
    index[count++] = k - begin;
  }
  /* The end stays where it is: a last point that was too near takes the place of the one before. */
  if (tail && count > 1)
  {
    length -= chi_distance(position + 3 * (count - 1), position + 3 * (count - 2));
    length += chi_distance(end_point, position + 3 * (count - 2));
    memcpy(position + 3 * (count - 1), end_point, sizeof end_point);
    parameter[count - 1] = length;
    index[count - 1] = last - begin;
  }
  line->curve.length = length;
  line->curve.point_count = count;
  if (count < 2 || !(length > 0) || !isfinite(length))
  {
    line->curve.point_count = 0;
    line->curve.reason = line->non_finite && count < 2 ? CHI_SPLINE_NOT_FINITE
      : end - begin < 2                                ? CHI_SPLINE_TOO_FEW_POINTS
                                                       : CHI_SPLINE_ALL_EQUAL;
    line->curve.reason = isfinite(length) ? line->curve.reason : CHI_SPLINE_NOT_FINITE;
    return;
  }
  for (size_t k = 0; k < count; ++k)
  {
    parameter[k] /= length;
  }
  parameter[count - 1] = 1;
  double a[3], b[3];
  chi_view_get(&job->lines->points, (size_t)point_id(job->lines, first), a);
  chi_view_get(&job->lines->points, (size_t)point_id(job->lines, last), b);
  line->curve.closed = count > 3 && a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void fit_chunk(void* data, size_t begin, size_t end)
{
  fit_job* const job = (fit_job*)data;
  chi_spline* const s = job->spline;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    const size_t first = chunk * LINES_A_CHUNK;
    const size_t last =
      s->line_count - first < LINES_A_CHUNK ? s->line_count : first + LINES_A_CHUNK;
    size_t longest = 0;
    for (size_t i = first; i < last; ++i)
    {
      clean_line(job, i);
      const size_t n = s->lines[i].curve.point_count;
      longest = n > longest ? n : longest;
    }
    chi_spline_scratch scratch;
    const int fits = job->params->method != CHI_SPLINE_POLYLINE && longest > 0;
    if (fits && !chi_spline_scratch_create(job->exec, &scratch, longest))
    {
      job->refused = 1;
      return;
    }
    for (size_t i = first; i < last && !chi_is_cancelled(job->exec); ++i)
    {
      chi_spline_line* const line = &s->lines[i];
      if (line->curve.point_count > 0)
      {
        line->curve.point_parameters = s->parameters + line->point_start;
        line->curve.point_indices = s->indices + line->point_start;
        chi_spline_fit_line(line, s->positions + 3 * line->point_start,
          s->coefficients + 3 * line->control_start, s->knots + line->knot_start,
          fits ? &scratch : NULL, job->params);
      }
    }
    if (fits)
    {
      chi_spline_scratch_destroy(job->exec, &scratch);
    }
  }
}

static void gather_stats(chi_spline* s)
{
  chi_spline_stats* const t = &s->stats;
  *t = (chi_spline_stats){ .struct_size = sizeof *t };
  for (size_t i = 0; i < s->line_count; ++i)
  {
    const chi_spline_line* const line = &s->lines[i];
    t->repeated_points += line->repeated;
    t->non_finite_points += line->non_finite;
    if (line->curve.count == 0)
    {
      ++t->skipped_lines;
      ++t->skipped[line->curve.reason];
      continue;
    }
    ++t->curves;
    t->coefficients += line->curve.count - (line->curve.closed && line->curve.degree == 3 ? 3 : 0);
    t->max_error = fmax(t->max_error, line->curve.max_error);
    t->max_point_error = fmax(t->max_point_error, line->point_error);
    t->unconverged += line->unconverged != 0;
  }
}

chi_status chi_spline_fit(const chi_exec* exec, chi_spline* spline, const chi_lines_view* lines,
  const chi_spline_params* given)
{
  chi_spline_params own = { 0 };
  const chi_spline_params* const params =
    given && CHI_ADOPT(chi_spline_params, merge_distance, &own, given) ? &own : NULL;
  if (spline) /* the former curves are gone, whatever the result */
  {
    spline->line_count = 0;
    spline->stats = (chi_spline_stats){ .struct_size = sizeof spline->stats };
  }
  if (!spline || !params || !chi_lines_are_valid(lines) || !(params->tolerance >= 0) ||
    !isfinite(params->tolerance) || !(params->merge_distance >= 0) ||
    !isfinite(params->merge_distance) || params->method < CHI_SPLINE_PROGRESSIVE ||
    params->method > CHI_SPLINE_LEAST_SQUARES)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const size_t n = lines->line_count;
  const size_t points = n ? (size_t)(lines->offsets[n] - lines->offsets[0]) : 0;
  /* A cubic needs four coefficients however few points there are, a closed one repeats three. */
  if (points > SIZE_MAX / 64 || n > SIZE_MAX / 512)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  const chi_status reserved = reserve(exec, spline, n, points,
    params->method == CHI_SPLINE_POLYLINE ? 1 : points + 7 * n + 1, points + 11 * n + 1);
  if (reserved != CHI_OK)
  {
    return reserved;
  }
  for (size_t i = 0; i < n; ++i)
  {
    const size_t start = (size_t)(lines->offsets[i] - lines->offsets[0]);
    spline->lines[i] = (chi_spline_line){
      .point_start = start, .control_start = start + 7 * i, .knot_start = start + 11 * i
    };
  }
  spline->line_count = n;
  fit_job job = { exec, spline, lines, params, 0 };
  const size_t chunks = (n + LINES_A_CHUNK - 1) / LINES_A_CHUNK;
  chi_status status = chunks ? chi_for(exec, chunks, fit_chunk, &job) : CHI_OK;
  if (status == CHI_OK && job.refused)
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  if (status != CHI_OK)
  {
    spline->line_count = 0;
    spline->stats = (chi_spline_stats){ .struct_size = sizeof spline->stats };
    return status;
  }
  gather_stats(spline);
  return CHI_OK;
}

size_t chi_spline_count(const chi_spline* spline)
{
  return spline ? spline->line_count : 0;
}

void chi_spline_get_curve(const chi_spline* spline, size_t line, chi_spline_curve* curve)
{
  if (curve)
  {
    memset(curve, 0, sizeof *curve);
    if (spline && line < spline->line_count)
    {
      *curve = spline->lines[line].curve;
    }
  }
}

void chi_spline_get_stats(const chi_spline* spline, chi_spline_stats* stats)
{
  if (stats)
  {
    *stats = spline ? spline->stats : (chi_spline_stats){ .struct_size = sizeof *stats };
  }
}

void chi_spline_evaluate(const chi_spline_curve* curve, double u, int32_t order, double out[][3])
{
  const int degree = curve->degree;
  if (curve->count == 0)
  {
    memset(out, 0, (size_t)(order + 1) * sizeof out[0]);
    return;
  }
  u = u > 0 ? (u < 1 ? u : 1) : 0;
  const size_t span = chi_spline_span(curve, u, (size_t)degree);
  double d[4][3];
  memcpy(d, curve->coefficients + 3 * (span - (size_t)degree), (size_t)(degree + 1) * sizeof d[0]);
  double basis[4];
  for (int32_t k = 0; k <= order; ++k)
  {
    const int left = degree - (int)k; /* degree of the k-th derivative */
    for (int c = 0; c < 3; ++c)
    {
      out[k][c] = 0;
    }
    if (left < 0)
    {
      continue;
    }
    chi_spline_basis(curve->knots, span, left, u, basis);
    for (int j = 0; j <= left; ++j)
    {
      for (int c = 0; c < 3; ++c)
      {
        out[k][c] += basis[j] * d[j][c];
      }
    }
    /* Coefficients of the next derivative: differences over the knots. de Boor 1972, Eq. 12. */
    for (int j = 0; j < left; ++j)
    {
      const double width =
        curve->knots[span + (size_t)j + 1] - curve->knots[span + (size_t)j + 1 - (size_t)left];
      for (int c = 0; c < 3; ++c)
      {
        d[j][c] = width > 0 ? left * (d[j + 1][c] - d[j][c]) / width : 0;
      }
    }
  }
}
