/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The index of a mesh with two fields: values and flags by point, ranges of bricks of cells and of
 * runs of points, and a list of tetrahedra where the grid does not give them as it is. */

#include "chi_fiber_internal.h"

#include <math.h>

enum
{
  VTK_TETRAHEDRON_TYPE = 10
};

static const double largest = 1e100; /* of values and of coordinates */

const chi_fiber_range chi_fiber_no_range = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };

const uint8_t chi_fiber_paths[6][4] = { { 0, 1, 3, 7 }, { 0, 1, 5, 7 }, { 0, 2, 3, 7 },
  { 0, 2, 6, 7 }, { 0, 4, 5, 7 }, { 0, 4, 6, 7 } };

/* ---- values ---- */

static double value_of(const chi_array_view* a, int32_t component, size_t tuple)
{
  const char* const at = (const char*)a->data + tuple * a->stride;
  const size_t size = chi_type_size(a->type);
  if (component >= 0)
  {
    return chi_number_at(at + (size_t)component * size, a->type);
  }
  double square = 0;
  for (size_t k = 0; k < a->components; ++k)
  {
    const double x = chi_number_at(at + k * size, a->type);
    square += x * x;
  }
  return sqrt(square);
}

static void copy_field(const chi_fiber_index_job* job, int k, size_t first, size_t last)
{
  const chi_array_view* const a = job->params->fields[k];
  const int32_t component = job->params->components[k];
  double(*const values)[2] = job->index->values;
  const char* at = component < 0
    ? NULL
    : (const char*)a->data + first * a->stride + (size_t)component * chi_type_size(a->type);
  for (size_t i = first; i < last; ++i)
  {
    if (component >= 0 && a->type == CHI_F32)
    {
      float x;
      memcpy(&x, at, sizeof x);
      values[i][k] = x;
      at += a->stride;
    }
    else if (component >= 0 && a->type == CHI_F64)
    {
      memcpy(&values[i][k], at, sizeof(double));
      at += a->stride;
    }
    else
    {
      values[i][k] = value_of(a, component, i);
    }
  }
}

static int place_is_tame(const chi_grid* grid, size_t id)
{
  double x[3];
  chi_grid_point(grid, id, x);
  return fabs(x[0]) <= largest && fabs(x[1]) <= largest && fabs(x[2]) <= largest;
}

/* The mean over a cell's points, in place and value. */
static void read_center(const chi_fiber_index_job* job, size_t center)
{
  chi_fiber_index* const x = job->index;
  double* const value = x->values[x->grid.points + center];
  chi_grid_cell cell;
  chi_cell_read(&x->grid, x->center_cells[center], &cell);
  chi_cell_find_center(&cell);
  memcpy(x->center_places[center], cell.center, sizeof cell.center);
  for (int k = 0; k < 2; ++k)
  {
    double sum = 0;
    for (size_t i = 0; i < cell.count; ++i)
    {
      const double y =
        value_of(job->params->fields[k], job->params->components[k], (size_t)cell.ids[i]);
      sum += fabs(y) <= largest ? y : INFINITY;
    }
    value[k] = sum / (double)cell.count;
  }
}

static void read_runs(void* data, size_t begin, size_t end)
{
  chi_fiber_index_job* const job = (chi_fiber_index_job*)data;
  chi_fiber_index* const x = job->index;
  const uint8_t* const ghosts = x->grid.view.point_ghosts;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    const size_t first = r * CHI_FIBER_RUN;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, x->points);
    const size_t given = last < x->grid.points ? last : x->grid.points;
    if (first < given)
    {
      copy_field(job, 0, first, given);
      copy_field(job, 1, first, given);
    }
    chi_fiber_range range = chi_fiber_no_range;
    int all = 0;
    for (size_t i = first; i < last; ++i)
    {
      int flags = 0;
      if (i >= given)
      {
        read_center(job, i - x->grid.points);
      }
      else
      {
        flags |= job->looks_at_places && !place_is_tame(&x->grid, i) ? CHI_FIBER_BAD_PLACE : 0;
        flags |= ghosts && ghosts[i] & CHI_GRID_HIDDEN_POINT ? CHI_FIBER_HIDDEN : 0;
      }
      double* const value = x->values[i];
      if (fabs(value[0]) <= largest && fabs(value[1]) <= largest)
      {
        chi_fiber_widen(&range, value);
      }
      else
      {
        flags |= CHI_FIBER_BAD_VALUE;
        value[0] = value[1] = 0;
      }
      x->flags[i] = (uint8_t)flags;
      all |= flags;
    }
    x->run[r] = range;
    x->run_flags[r] = (uint8_t)all;
  }
}

/* ---- sources ---- */

static chi_status split_grid(
  const chi_exec* exec, chi_fiber_index* x, const chi_grid_view* view, int64_t* first_bad_cell)
{
  chi_grid_counts counts;
  chi_status status = chi_grid_count(exec, view, &counts);
  *first_bad_cell = counts.first_bad_cell;
  if (status != CHI_OK)
  {
    return status;
  }
  if (!chi_buffer_reserve(exec, &x->list_buffer, counts.tetrahedra + 1, sizeof *x->vertices) ||
    !chi_buffer_reserve(exec, &x->cell_buffer, counts.tetrahedra + 1, sizeof *x->cells) ||
    !chi_buffer_reserve(exec, &x->center_buffer, counts.extra_points + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &x->place_buffer, counts.extra_points + 1, 3 * sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  x->vertices = (uint32_t(*)[4])x->list_buffer.data;
  x->cells = (uint32_t*)x->cell_buffer.data;
  x->center_cells = (uint32_t*)x->center_buffer.data;
  x->center_places = (double(*)[3])x->place_buffer.data;
  const chi_grid_tetrahedra out = { .struct_size = sizeof out,
    .vertices = (uint32_t*)x->list_buffer.data,
    .cells = x->cells,
    .extra_cells = x->center_cells };
  status = chi_grid_split(exec, view, &counts, &out);
  x->tetrahedra = counts.tetrahedra;
  x->centers = counts.extra_points;
  x->bad_places = counts.non_finite_cells;
  x->hidden = counts.ghost_cells + counts.blanked_cells;
  x->others = counts.lower_dimensional_cells + counts.unsupported_cells;
  return status;
}

static int choose_source(const chi_grid* grid)
{
  const chi_grid_view* const v = &grid->view;
  if (v->kind == CHI_GRID_IMAGE || v->kind == CHI_GRID_RECTILINEAR)
  {
    return grid->is_flat ? CHI_FIBER_LIST : CHI_FIBER_KUHN;
  }
  const int is_direct = v->kind == CHI_GRID_UNSTRUCTURED && grid->cells > 0 &&
    v->cell_types[0] == VTK_TETRAHEDRON_TYPE && v->offsets[0] >= 0 &&
    (uint64_t)v->offsets[0] <= v->connectivity_count &&
    (v->connectivity_count - (size_t)v->offsets[0]) / 4 >= grid->cells;
  return is_direct ? CHI_FIBER_DIRECT : CHI_FIBER_LIST;
}

static void lay_bricks(chi_fiber_index* x)
{
  if (x->source == CHI_FIBER_KUHN)
  {
    for (int a = 0; a < 3; ++a)
    {
      x->blocks[a] = chi_grid_chunks(x->grid.dimensions[a], CHI_FIBER_BLOCK);
    }
    x->bricks = x->blocks[0] * x->blocks[1] * x->blocks[2];
    x->bricks_a_chunk = CHI_FIBER_IMAGE_CHUNK;
    x->tetrahedra = 6 * x->grid.cells;
  }
  else
  {
    x->tetrahedra = x->source == CHI_FIBER_DIRECT ? x->grid.cells : x->tetrahedra;
    x->bricks = chi_grid_chunks(x->tetrahedra, CHI_FIBER_LIST_BRICK);
    x->bricks_a_chunk = CHI_FIBER_LIST_CHUNK;
  }
  x->chunks = chi_grid_chunks(x->bricks, x->bricks_a_chunk);
  x->points = x->grid.points + x->centers;
  x->runs = chi_grid_chunks(x->points, CHI_FIBER_RUN);
}

/* Coordinates of an image lie among those of its corners. */
static int image_is_tame(const chi_grid* grid)
{
  int tame = 1;
  for (int k = 0; k < 8; ++k)
  {
    const size_t* const n = grid->view.dimensions;
    const size_t id =
      (k & 1 ? n[0] - 1 : 0) + n[0] * (k & 2 ? n[1] - 1 : 0) + n[0] * n[1] * (k & 4 ? n[2] - 1 : 0);
    tame &= place_is_tame(grid, id);
  }
  return tame;
}

static chi_status fill(
  const chi_exec* exec, chi_fiber_index* x, const chi_fiber_params* params, int* is_broken)
{
  if (!chi_buffer_reserve(exec, &x->value_buffer, x->points + 1, sizeof *x->values) ||
    !chi_buffer_reserve(exec, &x->flag_buffer, x->points + x->runs + 1, 1) ||
    !chi_buffer_reserve(exec, &x->brick_buffer, x->bricks + 1, sizeof *x->brick) ||
    !chi_buffer_reserve(exec, &x->run_buffer, x->runs + 1, sizeof *x->run) ||
    !chi_buffer_reserve(exec, &x->sum_buffer, x->bricks + 1, CHI_FIBER_SUMS * sizeof(size_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  x->values = (double(*)[2])x->value_buffer.data;
  x->flags = (uint8_t*)x->flag_buffer.data;
  x->run_flags = x->flags + x->points;
  x->brick = (chi_fiber_range*)x->brick_buffer.data;
  x->run = (chi_fiber_range*)x->run_buffer.data;
  chi_fiber_index_job job = { .exec = exec,
    .index = x,
    .params = params,
    .sums = (size_t(*)[CHI_FIBER_SUMS])x->sum_buffer.data,
    .looks_at_places = x->source == CHI_FIBER_DIRECT ||
      (x->source == CHI_FIBER_KUHN &&
        !(x->grid.view.kind == CHI_GRID_IMAGE && image_is_tame(&x->grid))) };
  memset(job.sums, 0, (x->bricks + 1) * CHI_FIBER_SUMS * sizeof(size_t));
  chi_status status = chi_for(exec, x->runs, read_runs, &job);
  for (size_t r = 0; r < x->runs && status == CHI_OK; ++r)
  {
    job.all_flags |= x->run_flags[r];
  }
  status = status == CHI_OK ? chi_for(exec, x->bricks, chi_fiber_read_bricks, &job) : status;
  *is_broken = job.is_broken;
  for (size_t b = 0; b < x->bricks && status == CHI_OK; ++b)
  {
    x->bad_values += job.sums[b][0];
    x->bad_places += job.sums[b][1];
    x->hidden += job.sums[b][2];
  }
  x->range = chi_fiber_no_range;
  for (size_t r = 0; r < x->runs && status == CHI_OK; ++r)
  {
    if (x->run[r].low[0] <= x->run[r].high[0])
    {
      chi_fiber_widen(&x->range, x->run[r].low);
      chi_fiber_widen(&x->range, x->run[r].high);
    }
  }
  return status;
}

chi_status chi_fiber_index_build(const chi_exec* exec, chi_fiber_index* x,
  const chi_grid_view* view, const chi_fiber_params* params, int64_t* first_bad_cell)
{
  *first_bad_cell = -1;
  chi_status status = chi_grid_open(&x->grid, view);
  for (int k = 0; k < 2 && status == CHI_OK; ++k)
  {
    if (params->fields[k]->count != x->grid.points)
    {
      status = CHI_ERROR_INVALID_ARGUMENT;
    }
  }
  if (status != CHI_OK)
  {
    return status;
  }
  x->source = choose_source(&x->grid);
  for (;;)
  {
    int is_broken = 0;
    x->centers = x->tetrahedra = x->bad_values = x->bad_places = x->hidden = x->others = 0;
    if (x->source == CHI_FIBER_LIST)
    {
      status = split_grid(exec, x, view, first_bad_cell);
    }
    if (status == CHI_OK)
    {
      lay_bricks(x);
      status = fill(exec, x, params, &is_broken);
    }
    if (status != CHI_OK || !is_broken)
    {
      return status;
    }
    x->source = CHI_FIBER_LIST; /* which finds what is wrong, or not of the kind */
  }
}

void chi_fiber_index_free(const chi_exec* exec, chi_fiber_index* x)
{
  chi_buffer* const buffers[] = { &x->value_buffer, &x->flag_buffer, &x->brick_buffer,
    &x->run_buffer, &x->list_buffer, &x->cell_buffer, &x->center_buffer, &x->place_buffer,
    &x->sum_buffer };
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; ++i)
  {
    chi_buffer_free(exec, buffers[i]);
  }
}
