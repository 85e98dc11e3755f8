/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Connected parts of a fiber surface, by joining the points of each triangle, and their areas. */

#include "chi_fiber_internal.h"

#include <math.h>

typedef struct component_job
{
  const chi_exec* exec;
  chi_fiber* fiber;
  uint32_t* parent;   /* [points] of a forest: a point of the same component, of no higher id */
  double (*place)[3]; /* [points] */
  double* area;       /* [components] */
} component_job;

static uint32_t root_of(uint32_t* parent, uint32_t i)
{
  while (parent[i] != i)
  {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

static void join(void* data, size_t pair, const uint32_t points[3])
{
  const component_job* const job = (const component_job*)data;
  (void)pair;
  for (int k = 1; k < 3; ++k)
  {
    const uint32_t a = root_of(job->parent, points[0]), b = root_of(job->parent, points[k]);
    job->parent[a < b ? b : a] = a < b ? a : b;
  }
}

/* Components count in the order of their first triangles. */
static void number(void* data, size_t pair, const uint32_t points[3])
{
  const component_job* const job = (const component_job*)data;
  chi_fiber_components* const c = &job->fiber->components;
  (void)pair;
  const uint32_t root = root_of(job->parent, points[0]);
  if (c->of_point[root] == CHI_FIBER_NONE)
  {
    c->of_point[root] = (uint32_t)c->count++;
  }
}

static void add_area(void* data, size_t pair, const uint32_t points[3])
{
  const component_job* const job = (const component_job*)data;
  const double *const a = job->place[points[0]], *const b = job->place[points[1]],
                      *const c = job->place[points[2]];
  (void)pair;
  const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
  const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
    u[0] * v[1] - u[1] * v[0] };
  job->area[job->fiber->components.of_point[points[0]]] +=
    0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static void find_places(void* data, size_t begin, size_t end)
{
  const component_job* const job = (const component_job*)data;
  const chi_fiber* const f = job->fiber;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = f->pairs.job + j;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      if (f->parts.id[i] - own->first_own < own->own)
      {
        chi_fiber_position(f, f->parts.name + i, job->place[f->parts.id[i]]);
      }
    }
  }
}

static chi_status visit_all(const component_job* job, chi_fiber_triangle_fn visit)
{
  const chi_fiber* const f = job->fiber;
  for (size_t j = 0; j < f->pairs.jobs; ++j)
  {
    if (chi_is_cancelled(job->exec))
    {
      return CHI_ERROR_CANCELLED;
    }
    chi_fiber_visit(f, f->pairs.job + j, visit, (void*)job);
  }
  return CHI_OK;
}

typedef struct remaining
{
  const chi_fiber_components* components;
  size_t triangles;
} remaining;

static void count_remaining(void* data, size_t pair, const uint32_t points[3])
{
  remaining* const r = (remaining*)data;
  (void)pair;
  r->triangles += r->components->of_point[points[0]] != CHI_FIBER_NONE;
}

/* Leave out the components below the least area, and number points and components anew. */
static chi_status leave_out(component_job* job)
{
  chi_fiber* const f = job->fiber;
  chi_fiber_components* const c = &f->components;
  if (!chi_buffer_reserve(job->exec, &c->place_buffer, f->all_points + 1, 3 * sizeof(double)) ||
    !chi_buffer_reserve(job->exec, &c->area_buffer, c->count + 1, sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->place = (double(*)[3])c->place_buffer.data;
  job->area = (double*)c->area_buffer.data;
  memset(job->area, 0, (c->count + 1) * sizeof *job->area);
  chi_status status = chi_for(job->exec, f->pairs.jobs, find_places, job);
  status = status == CHI_OK ? visit_all(job, add_area) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  uint32_t* const number_of = job->parent; /* [points] holds [components] */
  uint32_t kept = 0;
  for (size_t k = 0; k < c->count; ++k)
  {
    number_of[k] = job->area[k] < f->minimum_area ? CHI_FIBER_NONE : kept++;
  }
  for (size_t i = 0; i < f->all_points; ++i)
  {
    c->of_point[i] = number_of[c->of_point[i]];
  }
  c->left_out = c->count - kept;
  c->count = kept;
  return CHI_OK;
}

chi_status chi_fiber_find_components(const chi_exec* exec, chi_fiber* fiber)
{
  chi_fiber_components* const c = &fiber->components;
  const size_t points = fiber->all_points;
  if (!chi_buffer_reserve(exec, &c->point_buffer, points + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &c->id_buffer, points + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &c->job_buffer, fiber->pairs.jobs + 1, sizeof(size_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  c->of_point = (uint32_t*)c->point_buffer.data;
  c->new_id = (uint32_t*)c->id_buffer.data;
  c->triangles = (size_t*)c->job_buffer.data;
  c->count = c->left_out = 0;
  component_job job = { .exec = exec, .fiber = fiber, .parent = c->new_id };
  for (size_t i = 0; i < points; ++i)
  {
    job.parent[i] = (uint32_t)i;
    c->of_point[i] = CHI_FIBER_NONE;
  }
  chi_status status = visit_all(&job, join);
  status = status == CHI_OK ? visit_all(&job, number) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  for (size_t i = 0; i < points; ++i)
  {
    c->of_point[i] = c->of_point[root_of(job.parent, (uint32_t)i)];
  }
  if (fiber->minimum_area > 0)
  {
    status = leave_out(&job);
  }
  size_t next = 0;
  for (size_t i = 0; i < points && status == CHI_OK; ++i)
  {
    c->new_id[i] = c->of_point[i] == CHI_FIBER_NONE ? CHI_FIBER_NONE : (uint32_t)next++;
  }
  remaining r = { c, 0 };
  for (size_t j = 0; j < fiber->pairs.jobs && status == CHI_OK; ++j)
  {
    c->triangles[j] = r.triangles;
    chi_fiber_visit(fiber, fiber->pairs.job + j, count_remaining, &r);
  }
  fiber->sizes.points = next;
  fiber->sizes.triangles = r.triangles;
  fiber->sizes.components = c->count;
  fiber->sizes.left_out = c->left_out;
  return status;
}

void chi_fiber_components_free(const chi_exec* exec, chi_fiber_components* c)
{
  chi_buffer_free(exec, &c->point_buffer);
  chi_buffer_free(exec, &c->id_buffer);
  chi_buffer_free(exec, &c->area_buffer);
  chi_buffer_free(exec, &c->place_buffer);
  chi_buffer_free(exec, &c->job_buffer);
}
