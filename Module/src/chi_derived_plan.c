/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Derivatives on structured grids: stencils, units, and how the grid is cut into blocks. */

#include "chi_derived_plan.h"

#include <math.h>

enum
{
  PIECES = 64, /* at most; each has scratch of its own, and takes blocks in order */
  LEAST_PLANES = 16,
  MOST_ROWS = 32,
  LEAST_ROWS = 4,
  LINE = 64,               /* bytes of a cache line: rows begin with one */
  CACHE_BYTES = 512 * 1024 /* that a ring should not exceed */
};

/* Weights of the whole stencils along x, one row a tap. */
static chi_status make_along(chi_derived_plan* p, int derivative)
{
  chi_derived_along* const a = &p->along[derivative];
  const chi_derived_axis* const x = &p->axis[0];
  const size_t reach = (size_t)x->order / 2, n = x->count;
  /* second derivatives of unevenly spaced samples need one sample more */
  const size_t more = derivative && !x->is_uniform;
  *a = (chi_derived_along){ .count = n,
    .width = x->width,
    .start = x->start,
    .table = x->weights[derivative],
    .begin = reach };
  a->end = n > reach + more ? n - reach - more : 0;
  if (a->end <= a->begin)
  {
    a->begin = a->end = 0;
    return CHI_OK;
  }
  for (size_t k = 0; k < 2 * reach + more + 1; ++k)
  {
    if (k != reach)
    {
      a->offset[a->taps++] = (ptrdiff_t)k - (ptrdiff_t)reach;
    }
  }
  p->along_bytes[derivative] = a->taps * n;
  char* const to = (char*)chi_alloc(p->job->exec, a->taps * n, p->kernels->size);
  a->weights = p->along_weights[derivative] = to;
  if (!to)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(to, 0, a->taps * n * p->kernels->size);
  for (size_t k = 0; k < a->taps; ++k)
  {
    for (size_t i = a->begin; i < a->end; ++i)
    {
      const size_t at = (size_t)((ptrdiff_t)i + a->offset[k]) - x->start[i];
      const double w = x->weights[derivative][i * CHI_DERIVED_WIDTH + at];
      const float single = (float)w;
      memcpy(to + (k * n + i) * p->kernels->size, p->kernels->size == 4 ? (const void*)&single : &w,
        p->kernels->size);
    }
  }
  return CHI_OK;
}

/* Lengths of an image's axes, and the inverse of the products of their unit vectors. Axes of one
 * sample count as perpendicular to all. */
static chi_status measure_image(chi_derived_plan* p, double spacing[3])
{
  const double* const m = p->job->grid.view.index_to_world;
  double unit[3][3] = { { 0 } }, g[3][3], most = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double column[3] = { m[a], m[4 + a], m[8 + a] };
    const double largest = fmax(fmax(fabs(column[0]), fabs(column[1])), fabs(column[2]));
    spacing[a] = 1;
    if (p->n[a] < 2)
    {
      continue;
    }
    if (!(largest > 0) || !isfinite(column[0] + column[1] + column[2]))
    {
      p->job->counts->bad_axis = a;
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    double sum = 0;
    for (int x = 0; x < 3; ++x)
    {
      unit[a][x] = column[x] / largest;
      sum += unit[a][x] * unit[a][x];
    }
    for (int x = 0; x < 3; ++x)
    {
      unit[a][x] /= sqrt(sum);
    }
    spacing[a] = largest * sqrt(sum) / p->job->length_unit;
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = 0; b < 3; ++b)
    {
      g[a][b] =
        a == b ? 1 : unit[a][0] * unit[b][0] + unit[a][1] * unit[b][1] + unit[a][2] * unit[b][2];
      most = a == b ? most : fmax(most, fabs(g[a][b]));
    }
  }
  p->form.is_orthogonal = most < 1e-14; /* some roundings of a rotation */
  const double xy = g[0][1], xz = g[0][2], yz = g[1][2];
  const double determinant = 1 + 2 * xy * xz * yz - xy * xy - xz * xz - yz * yz;
  if (!(determinant > 1e-20))
  {
    p->job->counts->bad_axis = fabs(xy) >= most ? 1 : 2;
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const double inverse[6] = { 1 - yz * yz, 1 - xz * xz, 1 - xy * xy, xz * yz - xy, xy * yz - xz,
    xy * xz - yz };
  for (int k = 0; k < 6; ++k)
  {
    p->form.metric[k] = inverse[k] / determinant;
  }
  return CHI_OK;
}

static chi_status make_rectilinear_axis(chi_derived_plan* p, int a)
{
  const chi_array_view* const view = &p->job->grid.view.axes[a];
  double* const at = (double*)chi_alloc(p->job->exec, p->n[a], sizeof *at);
  if (!at)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < p->n[a]; ++i)
  {
    at[i] =
      chi_number_at((const char*)view->data + i * view->stride, view->type) / p->job->length_unit;
  }
  const chi_status status =
    chi_derived_axis_create(p->job->exec, &p->axis[a], p->n[a], p->job->params.order, 1, at);
  chi_free(p->job->exec, at, p->n[a], sizeof *at);
  p->job->counts->bad_axis = status == CHI_ERROR_INVALID_ARGUMENT ? a : -1;
  return status;
}

static chi_status make_axes(chi_derived_plan* p)
{
  double spacing[3] = { 1, 1, 1 };
  const int32_t kind = p->job->grid.view.kind;
  p->form.is_orthogonal = kind != CHI_GRID_CURVILINEAR;
  chi_status status = kind == CHI_GRID_IMAGE ? measure_image(p, spacing) : CHI_OK;
  for (int a = 0; a < 3 && status == CHI_OK; ++a)
  {
    status = kind == CHI_GRID_RECTILINEAR ? make_rectilinear_axis(p, a)
                                          : chi_derived_axis_create(p->job->exec, &p->axis[a],
                                              p->n[a], p->job->params.order, spacing[a], NULL);
  }
  for (int d = 0; d < 1 + p->is_second && status == CHI_OK; ++d)
  {
    status = make_along(p, d);
  }
  return status;
}

static void find_sources(chi_derived_plan* p)
{
  const chi_derived_job* const job = p->job;
  const chi_vec3_view* const points = &job->grid.view.points;
  p->source[0] = (chi_derived_source){ .values = job->values,
    .component = job->params.component,
    .ghosts = job->grid.view.point_ghosts,
    .factor = 1 / job->value_unit };
  for (int x = 0; x < 3; ++x)
  {
    p->source[1 + x] = (chi_derived_source){ .values = { points->data, points->count, 3,
                                               points->stride, points->type },
      .component = x,
      .factor = 1 / job->length_unit };
  }
}

static void find_form(chi_derived_plan* p)
{
  p->form.is_second = p->is_second;
  p->form.threshold = chi_derived_threshold(p->job);
  for (int k = 0; k < 4; ++k)
  {
    chi_derived_unit(p->job, k, p->form.factor[k]);
  }
  for (int a = 0; a < 3; ++a)
  {
    p->form.inactive[a] = p->n[a] < 2;
  }
}

/* Blocks of rows that fit into cache, and enough of planes for every piece to have one. */
static void cut(chi_derived_plan* p)
{
  p->block_rows = p->n[1] < MOST_ROWS ? p->n[1] : MOST_ROWS;
  while (p->block_rows > LEAST_ROWS && chi_derived_count_rows(p) * p->row_bytes > CACHE_BYTES)
  {
    p->block_rows = (p->block_rows + 1) / 2;
  }
  p->row_blocks = chi_grid_chunks(p->n[1], p->block_rows);
  const size_t wanted = p->row_blocks < PIECES ? PIECES / p->row_blocks : 1;
  const size_t planes = chi_grid_chunks(p->n[2], wanted);
  p->block_planes = planes > LEAST_PLANES ? planes : LEAST_PLANES;
  p->blocks = p->row_blocks * chi_grid_chunks(p->n[2], p->block_planes);
  p->pieces = p->blocks < PIECES ? p->blocks : PIECES;
}

chi_status chi_derived_structured(chi_derived_job* job)
{
  const int is_single = chi_derived_is_single(job);
  chi_derived_plan p = { .job = job,
    .kernels = chi_derived_get_kernels(!is_single),
    .is_second = chi_derived_is_second(job),
    .is_curved = job->grid.view.kind == CHI_GRID_CURVILINEAR,
    .narrows = !is_single && job->arrays.type == CHI_F32 };
  p.fields = p.is_curved ? CHI_DERIVED_FIELDS : 1;
  memcpy(p.n, job->grid.view.dimensions, sizeof p.n);
  p.row_bytes = (p.n[0] * p.kernels->size + LINE - 1) / LINE * LINE;
  chi_status status = make_axes(&p);
  if (status == CHI_OK)
  {
    find_sources(&p);
    find_form(&p);
    cut(&p);
    status = chi_derived_run(&p);
  }
  for (int d = 0; d < 2; ++d)
  {
    if (p.along_weights[d])
    {
      chi_free(job->exec, p.along_weights[d], p.along_bytes[d], p.kernels->size);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    chi_derived_axis_destroy(job->exec, &p.axis[a]);
  }
  return status;
}
