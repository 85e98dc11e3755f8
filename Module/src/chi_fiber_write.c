/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The arrays of a fiber surface, and the data of a mesh's points carried to it. */

#include "chi_fiber_internal.h"

#include <math.h>

typedef struct write_job
{
  const chi_exec* exec;
  const chi_fiber* fiber;
  const chi_fiber_outputs* out;
  const chi_array_view* in; /* of an attribute, */
  char* attribute;          /* which goes here, */
  size_t stride;
  int64_t* nearest; /* or ids that go here */
} write_job;

void chi_fiber_position(const chi_fiber* fiber, const chi_fiber_name* name, double place[3])
{
  chi_fiber_position_of(&fiber->index, &fiber->polygon, fiber->parts.split_corners, name, place);
}

void chi_fiber_position_of(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name, double place[3])
{
  uint32_t parents[3];
  double weights[3];
  const int count = chi_fiber_locate(index, polygon, split_corners, name, parents, weights);
  chi_fiber_place(index, parents[0], place);
  double first[3] = { place[0], place[1], place[2] };
  for (int k = 1; k < count; ++k)
  {
    double x[3];
    chi_fiber_place(index, parents[k], x);
    for (int a = 0; a < 3; ++a)
    {
      place[a] += weights[k] * (x[a] - first[a]);
    }
  }
}

static void write_point(const write_job* job, size_t place, size_t id)
{
  const chi_fiber* const f = job->fiber;
  const chi_fiber_outputs* const out = job->out;
  const chi_fiber_name* const name = f->parts.name + place;
  if (out->points)
  {
    double x[3];
    chi_fiber_position(f, name, x);
    for (int a = 0; a < 3 && out->point_type == CHI_F32; ++a)
    {
      ((float*)out->points)[3 * id + (size_t)a] = (float)x[a];
    }
    if (out->point_type == CHI_F64)
    {
      memcpy((double*)out->points + 3 * id, x, sizeof x);
    }
  }
  if (out->normals)
  {
    const double* const n = f->parts.normal[place];
    /* squares of small meshes' areas leave the range of double before their largest part does */
    const double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    double unit[3] = { 0, 0, 0 }, square = 0;
    for (int a = 0; a < 3 && most > 0; ++a)
    {
      unit[a] = n[a] / most;
      square += unit[a] * unit[a];
    }
    for (int a = 0; a < 3; ++a)
    {
      out->normals[3 * id + (size_t)a] = (float)(square > 0 ? unit[a] / sqrt(square) : a == 2);
    }
  }
  if (out->segment_parameter)
  {
    out->segment_parameter[id] =
      (float)chi_fiber_parameter(&f->index, &f->polygon, f->parts.split_corners, name);
  }
}

/* One number of a point of the mesh, or the mean of a cell's. */
static double value_at(
  const chi_array_view* a, uint32_t point, size_t component, const chi_grid_cell* center)
{
  const char* const data = (const char*)a->data + component * chi_type_size(a->type);
  if (!center)
  {
    return chi_number_at(data + point * a->stride, a->type);
  }
  double sum = 0;
  for (size_t k = 0; k < center->count; ++k)
  {
    sum += chi_number_at(data + (size_t)center->ids[k] * a->stride, a->type);
  }
  return sum / (double)center->count;
}

/* The cell whose centre a point is; 0 where it is none. */
static int read_center(const chi_fiber_index* x, uint32_t point, chi_grid_cell* cell)
{
  if (point < x->grid.points)
  {
    return 0;
  }
  chi_cell_read(&x->grid, x->center_cells[point - x->grid.points], cell);
  return 1;
}

uint32_t chi_fiber_nearest_of(
  const chi_fiber_index* x, const uint32_t* parents, const double* weights, int count)
{
  int most = 0;
  for (int k = 1; k < count; ++k)
  {
    most = weights[k] > weights[most] ? k : most;
  }
  chi_grid_cell cell;
  return read_center(x, parents[most], &cell) ? (uint32_t)cell.ids[0] : parents[most];
}

void chi_fiber_carry(const chi_fiber_index* x, const chi_array_view* a, const uint32_t* parents,
  const double* weights, int count, char* to)
{
  if (a->type != CHI_F32 && a->type != CHI_F64)
  {
    const uint32_t from = chi_fiber_nearest_of(x, parents, weights, count);
    memcpy(to, (const char*)a->data + from * a->stride, a->components * chi_type_size(a->type));
    return;
  }
  chi_grid_cell cells[3];
  int is_center[3];
  for (int k = 0; k < count; ++k)
  {
    is_center[k] = read_center(x, parents[k], cells + k);
  }
  for (size_t c = 0; c < a->components; ++c)
  {
    double value = 0;
    for (int k = 0; k < count; ++k)
    {
      value += weights[k] > 0
        ? weights[k] * value_at(a, parents[k], c, is_center[k] ? cells + k : NULL)
        : 0;
    }
    if (a->type == CHI_F32)
    {
      const float single = (float)value;
      memcpy(to + c * sizeof single, &single, sizeof single);
    }
    else
    {
      memcpy(to + c * sizeof value, &value, sizeof value);
    }
  }
}

static void write_attribute(const write_job* job, size_t place, size_t id)
{
  const chi_fiber* const f = job->fiber;
  uint32_t parents[3];
  double weights[3];
  const int count = chi_fiber_locate(
    &f->index, &f->polygon, f->parts.split_corners, f->parts.name + place, parents, weights);
  if (job->nearest)
  {
    job->nearest[id] = chi_fiber_nearest_of(&f->index, parents, weights, count);
    return;
  }
  chi_fiber_carry(&f->index, job->in, parents, weights, count, job->attribute + id * job->stride);
}

static uint32_t final_id(const chi_fiber* f, uint32_t id)
{
  return f->with_components && id != CHI_FIBER_NONE ? f->components.new_id[id] : id;
}

static void write_points(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber* const f = job->fiber;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = f->pairs.job + j;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      /* each point is written by the job that met it first */
      const int is_own = f->parts.id[i] - own->first_own < own->own;
      const uint32_t id = is_own ? final_id(f, f->parts.id[i]) : CHI_FIBER_NONE;
      if (id != CHI_FIBER_NONE && job->out)
      {
        write_point(job, i, id);
      }
      else if (id != CHI_FIBER_NONE)
      {
        write_attribute(job, i, id);
      }
    }
  }
}

typedef struct triangle_sink
{
  const write_job* job;
  const chi_fiber_job* own;
  size_t next;
} triangle_sink;

static void write_triangle(void* data, size_t pair, const uint32_t points[3])
{
  triangle_sink* const sink = (triangle_sink*)data;
  const chi_fiber* const f = sink->job->fiber;
  const chi_fiber_outputs* const out = sink->job->out;
  if (final_id(f, points[0]) == CHI_FIBER_NONE)
  {
    return;
  }
  const size_t at = sink->next++;
  const uint64_t code = f->pairs.pair[sink->own->batch][sink->own->first_pair + pair];
  for (int k = 0; k < 3 && out->connectivity; ++k)
  {
    out->connectivity[3 * at + (size_t)k] = final_id(f, points[k]);
  }
  if (out->offsets)
  {
    out->offsets[at + 1] = 3 * (int64_t)(at + 1);
  }
  if (out->segment_ids)
  {
    const size_t number = sink->own->batch * CHI_FIBER_BATCH + code % CHI_FIBER_PAIR;
    out->segment_ids[at] = f->polygon.segment[number].id;
  }
  if (out->cell_ids)
  {
    uint32_t v[4];
    out->cell_ids[at] = (int64_t)chi_fiber_fetch(&f->index, code / CHI_FIBER_PAIR, v);
  }
  if (out->component_ids)
  {
    out->component_ids[at] = f->components.of_point[points[0]];
  }
}

static void write_triangles(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber* const f = job->fiber;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = f->pairs.job + j;
    triangle_sink sink = { job, own,
      f->with_components ? f->components.triangles[j] : own->first_triangle };
    chi_fiber_visit(f, own, write_triangle, &sink);
  }
}

chi_status chi_fiber_write(
  const chi_exec* exec, const chi_fiber* fiber, const chi_fiber_outputs* given)
{
  chi_fiber_outputs out;
  if (!fiber || !given || !CHI_ADOPT(chi_fiber_outputs, component_ids, &out, given) ||
    (out.points && out.point_type != CHI_F32 && out.point_type != CHI_F64))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface)
  {
    return CHI_ERROR_NOT_READY;
  }
  if ((out.normals && !fiber->with_normals) || (out.component_ids && !fiber->with_components))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  write_job job = { .exec = exec, .fiber = fiber, .out = &out };
  if (out.offsets)
  {
    out.offsets[0] = 0;
  }
  chi_status status = CHI_OK;
  if (out.points || out.normals || out.segment_parameter)
  {
    status = chi_for(exec, fiber->pairs.jobs, write_points, &job);
  }
  return status == CHI_OK ? chi_for(exec, fiber->pairs.jobs, write_triangles, &job) : status;
}

chi_status chi_fiber_attribute(const chi_exec* exec, const chi_fiber* fiber,
  const chi_array_view* in, void* out, size_t out_stride)
{
  if (!fiber || !chi_array_is_valid(in))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface)
  {
    return CHI_ERROR_NOT_READY;
  }
  if (in->count != fiber->index.grid.points || (fiber->sizes.points && !out) ||
    out_stride < in->components * chi_type_size(in->type))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  write_job job = {
    .exec = exec, .fiber = fiber, .in = in, .attribute = (char*)out, .stride = out_stride
  };
  return chi_for(exec, fiber->pairs.jobs, write_points, &job);
}

chi_status chi_fiber_nearest(const chi_exec* exec, const chi_fiber* fiber, int64_t* ids)
{
  if (!fiber || !ids)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface)
  {
    return CHI_ERROR_NOT_READY;
  }
  write_job job = { .exec = exec, .fiber = fiber, .nearest = ids };
  return chi_for(exec, fiber->pairs.jobs, write_points, &job);
}
