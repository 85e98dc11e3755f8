/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The arrays of what a polygon encloses, and the data of a mesh's points carried there. */

#include "chi_fiber_internal.h"

typedef struct write_job
{
  const chi_exec* exec;
  const chi_fiber* fiber;
  const chi_fiber_enclosed_outputs* out;
  const chi_array_view* in; /* of an attribute, */
  char* attribute;          /* which goes here, */
  size_t stride;
  int64_t* nearest; /* or ids that go here */
} write_job;

static void write_point(const write_job* job, const chi_fiber_name* name, size_t id)
{
  const chi_fiber_index* const x = &job->fiber->index;
  const chi_fiber_polygon* const polygon = &job->fiber->enclosed.pieces.polygon;
  if (job->out)
  {
    double place[3];
    chi_fiber_position_of(x, polygon, 0, name, place);
    for (size_t a = 0; a < 3 && job->out->point_type == CHI_F32; ++a)
    {
      ((float*)job->out->points)[3 * id + a] = (float)place[a];
    }
    if (job->out->point_type == CHI_F64)
    {
      memcpy((double*)job->out->points + 3 * id, place, sizeof place);
    }
    return;
  }
  uint32_t parents[3];
  double weights[3];
  const int count = chi_fiber_locate(x, polygon, 0, name, parents, weights);
  if (job->nearest)
  {
    job->nearest[id] = chi_fiber_nearest_of(x, parents, weights, count);
    return;
  }
  chi_fiber_carry(x, job->in, parents, weights, count, job->attribute + id * job->stride);
}

static void write_vertices(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber_index* const x = &job->fiber->index;
  const uint32_t* const new_id = job->fiber->enclosed.new_id;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    const size_t first = r * CHI_FIBER_RUN;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, x->points);
    for (size_t i = first; i < last; ++i)
    {
      if (new_id[i] != CHI_FIBER_NONE)
      {
        const chi_fiber_name name = { (uint32_t)i, CHI_FIBER_NONE, CHI_FIBER_NONE, 0 };
        write_point(job, &name, new_id[i]);
      }
    }
  }
}

/* Each point is written by the job that met it first. */
static void write_cut_points(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber_enclosed* const e = &job->fiber->enclosed;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = e->cuts.job + j;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      if (e->parts.id[i] - own->first_own < own->own)
      {
        write_point(job, e->parts.name + i, e->vertices + e->parts.id[i]);
      }
    }
  }
}

static chi_status write_points(const write_job* job)
{
  const chi_fiber* const f = job->fiber;
  const chi_status status = chi_for(job->exec, f->index.runs, write_vertices, (void*)job);
  return status == CHI_OK ? chi_for(job->exec, f->enclosed.cuts.jobs, write_cut_points, (void*)job)
                          : status;
}

static void write_cell(
  const chi_fiber_enclosed_outputs* out, size_t id, const size_t points[4], size_t cell)
{
  for (size_t k = 0; k < 4 && out->connectivity; ++k)
  {
    out->connectivity[4 * id + k] = (int64_t)points[k];
  }
  if (out->offsets)
  {
    out->offsets[id + 1] = 4 * (int64_t)(id + 1);
  }
  if (out->cell_ids)
  {
    out->cell_ids[id] = (int64_t)cell;
  }
}

static void write_whole(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber_index* const x = &job->fiber->index;
  const chi_fiber_enclosed* const e = &job->fiber->enclosed;
  for (size_t b = begin; b < end && !chi_is_cancelled(job->exec); ++b)
  {
    const size_t first = b * CHI_FIBER_ENCLOSED_BLOCK;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_ENCLOSED_BLOCK, x->tetrahedra);
    size_t id = e->first_whole[b], cell;
    for (size_t t = first; t < last && id < e->first_whole[b + 1]; ++t)
    {
      uint32_t v[4];
      if (chi_fiber_is_whole(x, e, t, v, &cell))
      {
        const int is_left_handed = chi_fiber_six_volumes(x, v) < 0;
        const size_t points[4] = { e->new_id[v[0]], e->new_id[v[1]],
          e->new_id[v[is_left_handed ? 3 : 2]], e->new_id[v[is_left_handed ? 2 : 3]] };
        write_cell(job->out, id++, points, cell);
      }
    }
  }
}

static void write_cuts(void* data, size_t begin, size_t end)
{
  const write_job* const job = (const write_job*)data;
  const chi_fiber_enclosed* const e = &job->fiber->enclosed;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = e->cuts.job + j;
    for (size_t i = 0; i < own->triangles; ++i)
    {
      const uint32_t* const corner = e->parts.corner + 4 * (own->first_part + i);
      size_t points[4];
      uint32_t v[4];
      for (int k = 0; k < 4; ++k)
      {
        const size_t place = own->first_corner + corner[k];
        const chi_fiber_name* const name = e->parts.name + place;
        points[k] =
          name->b == CHI_FIBER_NONE ? e->new_id[name->a] : e->vertices + e->parts.id[place];
      }
      write_cell(job->out, e->whole + own->first_triangle + i, points,
        chi_fiber_fetch(&job->fiber->index, e->from[own->first_part + i], v));
    }
  }
}

chi_status chi_fiber_enclosed_write(
  const chi_exec* exec, const chi_fiber* fiber, const chi_fiber_enclosed_outputs* given)
{
  chi_fiber_enclosed_outputs out;
  if (!fiber || !given || !CHI_ADOPT(chi_fiber_enclosed_outputs, cell_ids, &out, given) ||
    (out.points && out.point_type != CHI_F32 && out.point_type != CHI_F64))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface || !fiber->enclosed.is_ready)
  {
    return CHI_ERROR_NOT_READY;
  }
  write_job job = { .exec = exec, .fiber = fiber, .out = &out };
  if (out.offsets)
  {
    out.offsets[0] = 0;
  }
  chi_status status = out.points ? write_points(&job) : CHI_OK;
  status = status == CHI_OK ? chi_for(exec, fiber->enclosed.blocks, write_whole, &job) : status;
  return status == CHI_OK ? chi_for(exec, fiber->enclosed.cuts.jobs, write_cuts, &job) : status;
}

chi_status chi_fiber_enclosed_attribute(const chi_exec* exec, const chi_fiber* fiber,
  const chi_array_view* in, void* out, size_t out_stride)
{
  if (!fiber || !chi_array_is_valid(in))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface || !fiber->enclosed.is_ready)
  {
    return CHI_ERROR_NOT_READY;
  }
  const chi_fiber_enclosed* const e = &fiber->enclosed;
  if (in->count != fiber->index.grid.points || (e->vertices + e->points && !out) ||
    out_stride < in->components * chi_type_size(in->type))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const write_job job = {
    .exec = exec, .fiber = fiber, .in = in, .attribute = (char*)out, .stride = out_stride
  };
  return write_points(&job);
}

chi_status chi_fiber_enclosed_nearest(const chi_exec* exec, const chi_fiber* fiber, int64_t* ids)
{
  if (!fiber || !ids)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!fiber->has_surface || !fiber->enclosed.is_ready)
  {
    return CHI_ERROR_NOT_READY;
  }
  const write_job job = { .exec = exec, .fiber = fiber, .nearest = ids };
  return write_points(&job);
}
