/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fields from derivatives: what is asked for, and in which units it is computed. */

#include "chi_derived_internal.h"

#include <math.h>

enum
{
  TUPLES_A_CHUNK = 1 << 16,
  TUPLES_A_ROW = 2048
};

static const double flatness = 1e-12; /* of range / extent */

/*------------------------------------------------------------------------------------------------*/
typedef struct range_job
{
  const chi_exec* exec;
  const chi_derived_source* source;
  const chi_derived_kernels* kernels;
  double (*ranges)[2]; /* [chunks] */
} range_job;

static void find_ranges(void* data, size_t begin, size_t end)
{
  const range_job* const job = (const range_job*)data;
  const size_t count = job->source->values.count;
  double row[TUPLES_A_ROW];
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t last = chi_grid_chunk_end(c * TUPLES_A_CHUNK, TUPLES_A_CHUNK, count);
    double range[2] = { INFINITY, -INFINITY };
    for (size_t i = c * TUPLES_A_CHUNK; i < last; i += TUPLES_A_ROW)
    {
      const size_t n = last - i < TUPLES_A_ROW ? last - i : TUPLES_A_ROW;
      job->kernels->load(job->source, i, n, row);
      job->kernels->range(row, n, range);
    }
    memcpy(job->ranges[c], range, sizeof range);
  }
}

/* Whether float holds what there is to read. */
static int fits_single(const chi_derived_source* source)
{
  const chi_type type = source->values.type;
  return source->component >= 0 && (type == CHI_F32 || chi_type_size(type) <= 2);
}

chi_status chi_derived_find_range(
  const chi_exec* exec, const chi_derived_source* source, double range[2])
{
  range[0] = INFINITY;
  range[1] = -INFINITY;
  const size_t chunks = chi_grid_chunks(source->values.count, TUPLES_A_CHUNK);
  range_job job = {
    .exec = exec, .source = source, .kernels = chi_derived_get_kernels(!fits_single(source))
  };
  if (chunks == 0)
  {
    return CHI_OK;
  }
  job.ranges = (double(*)[2])chi_alloc(exec, chunks, sizeof *job.ranges);
  if (!job.ranges)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  const chi_status status = chi_for(exec, chunks, find_ranges, &job);
  for (size_t c = 0; c < chunks && status == CHI_OK; ++c)
  {
    range[0] = fmin(range[0], job.ranges[c][0]);
    range[1] = fmax(range[1], job.ranges[c][1]);
  }
  chi_free(exec, job.ranges, chunks, sizeof *job.ranges);
  return status;
}

/*------------------------------------------------------------------------------------------------*/
int chi_derived_is_single(const chi_derived_job* job)
{
  const chi_derived_source source = { .values = job->values, .component = job->params.component };
  return job->arrays.type == CHI_F32 && !job->grid.has_points && fits_single(&source);
}

int chi_derived_is_second(const chi_derived_job* job)
{
  return job->arrays.second_derivative || job->arrays.laplacian || job->arrays.mean_curvature;
}

void* chi_derived_array(const chi_derived_job* job, int which)
{
  const chi_derived_arrays* const a = &job->arrays;
  void* const array[4] = { a->gradient_magnitude, a->second_derivative, a->laplacian,
    a->mean_curvature };
  return array[which];
}

/* As two powers of two, since one may be out of float's range where the product with a number in
 * hand is not. */
double chi_derived_unit(const chi_derived_job* job, int which, double unit[2])
{
  const int value = ilogb(job->value_unit), length = ilogb(job->length_unit);
  const int exponent = which == 0 ? value - length : which == 3 ? -length : value - 2 * length;
  const int least = -126, most = 127;
  int half = exponent / 2;
  half = half < least ? least : half > most ? most : half;
  int rest = exponent - half;
  rest = rest < -1022 ? -1022 : rest > 1023 ? 1023 : rest;
  unit[0] = ldexp(1, half);
  unit[1] = ldexp(1, rest);
  return ldexp(1, exponent);
}

/* A power of two not above a positive number, whose square and inverse square are numbers too. */
static double unit_of(double x)
{
  const int exponent = x > 0 && isfinite(x) ? ilogb(x) : 0;
  return ldexp(1, exponent < -1000 ? -1000 : exponent > 1000 ? 1000 : exponent);
}

static double diagonal(const double size[3])
{
  const double most = fmax(fmax(size[0], size[1]), size[2]);
  double sum = 0;
  for (int a = 0; a < 3 && most > 0; ++a)
  {
    sum += size[a] / most * (size[a] / most);
  }
  return most * sqrt(sum);
}

/* Extent of grids that have points: of those that are finite. */
static chi_status measure_points(chi_derived_job* job, double size[3])
{
  const chi_vec3_view* const points = &job->grid.view.points;
  for (int a = 0; a < 3; ++a)
  {
    const chi_derived_source source = { .values = { points->data, job->grid.points, 3,
                                          points->stride, points->type },
      .component = a,
      .factor = 1 };
    double range[2];
    const chi_status status = chi_derived_find_range(job->exec, &source, range);
    if (status != CHI_OK)
    {
      return status;
    }
    size[a] = range[1] >= range[0] ? range[1] - range[0] : 0;
  }
  return CHI_OK;
}

/* Sizes of the bounding box. */
static chi_status measure(chi_derived_job* job, double size[3])
{
  const chi_grid_view* const v = &job->grid.view;
  if (job->grid.has_points)
  {
    return measure_points(job, size);
  }
  double first[3], last[3];
  chi_grid_point(&job->grid, 0, first);
  chi_grid_point(&job->grid, job->grid.points - 1, last);
  for (int a = 0; a < 3; ++a)
  {
    size[a] = fabs(last[a] - first[a]);
    if (v->kind == CHI_GRID_IMAGE)
    {
      size[a] = 0;
      for (int k = 0; k < 3; ++k)
      {
        size[a] += fabs(v->index_to_world[4 * a + k]) * (double)(v->dimensions[k] - 1);
      }
    }
  }
  return CHI_OK;
}

static size_t longest_axis(const chi_grid* grid)
{
  const size_t* const d = grid->view.dimensions;
  const size_t xy = d[0] > d[1] ? d[0] : d[1];
  return grid->view.kind == CHI_GRID_UNSTRUCTURED ? 2 : xy > d[2] ? xy : d[2];
}

static chi_status find_units(chi_derived_job* job)
{
  chi_derived_counts* const counts = job->counts;
  const chi_derived_source source = { .values = job->values,
    .component = job->params.component,
    .ghosts = job->grid.view.point_ghosts,
    .factor = 1 };
  double range[2], size[3];
  chi_status status = chi_derived_find_range(job->exec, &source, range);
  status = status == CHI_OK ? measure(job, size) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  if (range[0] <= range[1])
  {
    memcpy(counts->range, range, sizeof range);
  }
  counts->extent = diagonal(size);
  /* halves, whose difference does not overflow */
  const double half = 0.5 * counts->range[1] - 0.5 * counts->range[0];
  const double middle = 0.5 * counts->range[1] + 0.5 * counts->range[0];
  job->value_unit = 2 * unit_of(half > 0 ? half : fabs(middle));
  if (fits_single(&source)) /* which then holds its inverse too */
  {
    job->value_unit = fmin(fmax(job->value_unit, 0x1p-126), 0x1p126);
  }
  const size_t n = longest_axis(&job->grid);
  job->length_unit = unit_of(counts->extent / (n > 1 ? (double)(n - 1) : 1));
  return CHI_OK;
}

/* Of the gradient's magnitude in the job's units. */
double chi_derived_threshold(const chi_derived_job* job)
{
  const chi_derived_counts* const counts = job->counts;
  const double range = counts->range[1] / job->value_unit - counts->range[0] / job->value_unit;
  const double extent = counts->extent / job->length_unit;
  return extent > 0 ? flatness * range / extent : 0;
}

/*------------------------------------------------------------------------------------------------*/
static int adopt(chi_derived_job* job, const chi_derived_params* params,
  const chi_derived_arrays* arrays, const chi_array_view* values)
{
  chi_derived_params* const p = &job->params;
  chi_derived_arrays* const a = &job->arrays;
  memset(p, 0, sizeof *p);
  memset(a, 0, sizeof *a);
  if ((params && !CHI_ADOPT(chi_derived_params, component, p, params)) || !arrays ||
    !CHI_ADOPT(chi_derived_arrays, mean_curvature, a, arrays) || !chi_array_is_valid(values))
  {
    return 0;
  }
  p->order = p->order == 0 ? 2 : p->order;
  job->values = *values;
  return (p->order == 2 || p->order == 4) && (a->type == CHI_F32 || a->type == CHI_F64) &&
    p->component >= -1 && (p->component < 0 || (size_t)p->component < values->components) &&
    (a->gradient_magnitude || chi_derived_is_second(job));
}

chi_status chi_derived_compute(const chi_exec* exec, const chi_grid_view* view,
  const chi_array_view* values, const chi_derived_params* params, const chi_derived_arrays* arrays,
  chi_derived_counts* counts)
{
  if (!counts)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_derived_counts found = { .struct_size = sizeof found, .bad_axis = -1 };
  *counts = found;
  chi_derived_job job = { .exec = exec, .counts = &found };
  if (!adopt(&job, params, arrays, values))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_grid_open(&job.grid, view);
  if (status != CHI_OK)
  {
    return status;
  }
  counts->points = found.points = job.grid.points;
  if (values->count != found.points)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (found.points == 0)
  {
    return CHI_OK;
  }
  status = find_units(&job);
  if (status == CHI_OK)
  {
    status = job.grid.view.kind == CHI_GRID_UNSTRUCTURED ? chi_derived_unstructured(&job)
                                                         : chi_derived_structured(&job);
  }
  if (status == CHI_OK)
  {
    *counts = found;
  }
  counts->bad_axis = found.bad_axis;
  return status;
}
