/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A function that is linear in each tetrahedron, continuous, and convex across every face, is at
 * any point x the greatest of its linear pieces there; along a ray towards x the values at x of the
 * pieces that it passes increase. So they are keys. Which function, is free: |x|^2 for Delaunay
 * meshes, any quadratic form for grids, whose cells' corners |x|^2 takes to one hyperplane.
 */
#include "chi_tet_order_lift.h"

#include <math.h>

enum
{
  LEAST = -16, /* powers of 2 from this one */
  SHARE = 64   /* one plane of so many may be an outlier */
};

/* Faces across which gradients differ by less than this share of the largest are tied: with planes
 * to 2^-32 of it, keys there are wrong only where the eye is within 2^-32 / 2^-24 * 4 = 1/64 rad of
 * the face's plane. */
static const double TIE = 0x1p-24;
/* Of outliers, whose keys are known to 2^-20 of their own size. */
static const double FAR_TIE = 0x1p-14;

/* A tetrahedron in the lift's coordinates, with what its plane is made of. */
typedef struct simplex
{
  double y[4][3], h[4];
  double edge[3][3], normal[3][3]; /* from vertex 0; e_j x e_k */
  double volume, most;             /* six times; the sum of what it consists of */
  double gradient[3];
} simplex;

void chi_order_lower(const chi_order_lift* lift, const double x[3], double y[3])
{
  const double d[3] = { x[0] - lift->center[0], x[1] - lift->center[1], x[2] - lift->center[2] };
  for (int k = 0; k < 3; ++k)
  {
    y[k] =
      lift->frame[3 * k] * d[0] + lift->frame[3 * k + 1] * d[1] + lift->frame[3 * k + 2] * d[2];
  }
}

static double height(const chi_order_lift* lift, size_t vertex, const double y[3])
{
  double q[6];
  if (lift->heights.data)
  {
    return ((const double*)lift->heights.data)[vertex];
  }
  squares(y, q);
  return dot(lift->form, q, 6);
}

/* 0 where it has no volume, or coordinates that are not finite. */
static int raise_simplex(
  const chi_order_lift* lift, const chi_tet_mesh_view* mesh, size_t t, simplex* s)
{
  double x[4][3];
  chi_order_corners(mesh, t, x);
  for (int i = 0; i < 4; ++i)
  {
    chi_order_lower(lift, x[i], s->y[i]);
    s->h[i] = height(lift, mesh->vertices[4 * t + (size_t)i], s->y[i]);
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      s->edge[i][k] = s->y[i + 1][k] - s->y[0][k];
    }
  }
  s->volume = s->most = 0;
  for (int i = 0; i < 3; ++i)
  {
    const double *const a = s->edge[(i + 1) % 3], *const b = s->edge[(i + 2) % 3];
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      s->normal[i][k] = a[l] * b[m] - a[m] * b[l];
      s->most += i == 0 ? fabs(s->edge[0][k]) * (fabs(a[l] * b[m]) + fabs(a[m] * b[l])) : 0;
    }
  }
  s->volume = dot(s->edge[0], s->normal[0], 3);
  for (int k = 0; k < 3; ++k)
  {
    s->gradient[k] =
      ((s->h[1] - s->h[0]) * s->normal[0][k] + (s->h[2] - s->h[0]) * s->normal[1][k] +
        (s->h[3] - s->h[0]) * s->normal[2][k]) /
      s->volume;
  }
  return fabs(s->volume) > 16 * 0x1p-53 * s->most; /* else its sign is not known */
}

static void find_plane(const simplex* s, double plane[4])
{
  memcpy(plane, s->gradient, sizeof s->gradient);
  plane[3] = s->h[0] - dot(s->gradient, s->y[0], 3);
}

/* How large its keys are for eyes near the mesh. */
static double size_of(const lift_job* it, const double plane[4])
{
  return it->radius * fmax(fabs(plane[0]), fmax(fabs(plane[1]), fabs(plane[2]))) + fabs(plane[3]);
}

static void find_planes(void* data, size_t begin, size_t end)
{
  const lift_job* const it = (const lift_job*)data;
  const size_t chunk = chi_order_chunk(it->mesh->count);
  for (size_t c = begin; c < end; ++c)
  {
    part* const p = it->parts + c;
    for (size_t t = c * chunk; t < it->mesh->count && t < (c + 1) * chunk; t += it->stride)
    {
      simplex s;
      if (!raise_simplex(it->lift, it->mesh, t, &s))
      {
        ++p->flat;
        continue;
      }
      double plane[4];
      find_plane(&s, plane);
      const double size = size_of(it, plane);
      const int power = size > 0 ? ilogb(size) - LEAST : 0;
      ++p->sizes[power < 0 ? 0 : power < SIZES ? power : SIZES - 1];
      if (!(size <= it->cut))
      {
        ++p->far;
        continue;
      }
      for (int k = 0; k < 4; ++k)
      {
        p->low[k] = plane[k] < p->low[k] ? plane[k] : p->low[k];
        p->high[k] = plane[k] > p->high[k] ? plane[k] : p->high[k];
      }
    }
    it->far[c] = (size_t)p->far;
  }
}

/* The vertex of u that t does not have. */
static size_t apex(const chi_tet_mesh_view* mesh, const uint32_t* neighbors, uint32_t t, uint32_t u)
{
  size_t i = 0;
  while (i < 3 && neighbors[4 * (size_t)u + i] != t)
  {
    ++i;
  }
  return mesh->vertices[4 * (size_t)u + i];
}

/* By how much the apex of a neighbour lies above the plane of s: as a multiple of the form, in
 * constraint, and of the lift as it is; the face's side; and the bounds of rounding. */
static double rise(const lift_job* it, const simplex* s, size_t vertex, const double y[3], int i,
  double* distance, double* error)
{
  double away[3], normal[3], reach = 0;
  const double* const on = s->y[i == 0 ? 1 : 0];
  double from[3];
  for (int k = 0; k < 3; ++k)
  {
    away[k] = y[k] - s->y[0][k];
    from[k] = y[k] - on[k];
    normal[k] = i ? s->normal[i - 1][k] : -(s->normal[0][k] + s->normal[1][k] + s->normal[2][k]);
  }
  const double up = height(it->lift, vertex, y) - s->h[0];
  for (int j = 0; j < 3; ++j)
  {
    double size = 0;
    for (int k = 0; k < 3; ++k)
    {
      size += fabs(s->normal[j][k] * away[k]);
    }
    reach += fabs(s->h[j + 1] - s->h[0]) * size;
  }
  /* a dozen roundings of each term, once more where the volume itself is small against its terms */
  *error = 16 * 0x1p-53 * (fabs(up) + reach / fabs(s->volume) * (1 + s->most / fabs(s->volume)));
  const double along = dot(normal, from, 3) * (s->volume > 0 ? -1 : 1);
  *distance = along / sqrt(dot(normal, normal, 3));
  return up - dot(s->gradient, away, 3);
}

/* The same as a linear function of the form: what has to be positive. Its size. */
static double constrain(const simplex* s, const double y[3], double q[6])
{
  double away[3], corner[6];
  for (int k = 0; k < 3; ++k)
  {
    away[k] = y[k] - s->y[0][k];
  }
  squares(away, q);
  for (int j = 0; j < 3; ++j)
  {
    const double share = dot(s->normal[j], away, 3) / s->volume;
    squares(s->edge[j], corner);
    for (int k = 0; k < 6; ++k)
    {
      q[k] -= share * corner[k];
    }
  }
  return sqrt(dot(q, q, 6));
}

void chi_lift_judge_faces(void* data, size_t begin, size_t end)
{
  const lift_job* const it = (const lift_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  const double length = sqrt(dot(it->lift->form, it->lift->form, 6));
  for (size_t c = begin; c < end; ++c)
  {
    part* const p = it->parts + c;
    size_t at = it->starts[c];
    for (size_t t = c * chunk; t < n && t < (c + 1) * chunk; t += it->stride)
    {
      const uint32_t* const near = it->neighbors + 4 * t;
      simplex s;
      double tie = 0;
      int known = 0;
      for (int i = 0; i < 4; ++i)
      {
        const uint32_t u = near[i];
        /* of the two sides of a face the one of the lower index, unless few are looked at */
        if (u >= n || (it->stride == 1 && u < t))
        {
          continue;
        }
        if (!known && !raise_simplex(it->lift, it->mesh, t, &s))
        {
          break;
        }
        if (!known)
        {
          double plane[4];
          find_plane(&s, plane);
          tie = size_of(it, plane) <= 0.5 * it->cut
            ? it->tie
            : fmax(it->tie, FAR_TIE * sqrt(dot(plane, plane, 3)));
        }
        known = 1;
        double x[3], y[3];
        const size_t vertex = apex(it->mesh, it->neighbors, (uint32_t)t, u);
        chi_view_get(&it->mesh->points, vertex, x);
        chi_order_lower(it->lift, x, y);
        if (it->searches)
        {
          double q[6];
          const double size = constrain(&s, y, q), margin = dot(it->lift->form, q, 6);
          if (size > 0 && margin / (size * length) < p->worst)
          {
            p->worst = margin / (size * length);
            for (int k = 0; k < 6; ++k)
            {
              p->vector[k] = q[k] / size;
            }
          }
          continue;
        }
        double distance, error;
        const double up = rise(it, &s, vertex, y, i, &distance, &error);
        const double least = error + tie * distance;
        if (!(distance > 0) || up < -least)
        {
          ++p->wrong;
        }
        else if (!(up > least))
        {
          ++p->tied;
          if (it->pairs)
          {
            it->pairs[2 * at] = (uint32_t)t;
            it->pairs[2 * at++ + 1] = u;
          }
        }
      }
    }
  }
}

static void write_planes(void* data, size_t begin, size_t end)
{
  const lift_job* const it = (const lift_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  int32_t* const planes = (int32_t*)it->lift->planes.data;
  chi_order_outlier* const outliers = (chi_order_outlier*)it->lift->outliers.data;
  for (size_t c = begin; c < end; ++c)
  {
    size_t at = it->starts[c];
    for (size_t t = c * chunk; t < n && t < (c + 1) * chunk; ++t)
    {
      simplex s;
      const int is_solid = raise_simplex(it->lift, it->mesh, t, &s);
      double plane[4];
      find_plane(&s, plane);
      const int is_far = is_solid && !(size_of(it, plane) <= it->cut);
      for (size_t k = 0; k < 4; ++k)
      {
        plane[k] = (plane[k] - it->middle[k]) * it->inverse[k];
      }
      if (is_far)
      {
        memcpy(outliers[at].plane, plane, sizeof plane);
        outliers[at++].t = (uint32_t)t;
      }
      for (size_t k = 0; k < 4; ++k)
      {
        const double v = is_solid && !is_far ? plane[k] : 0;
        planes[k * n + t] = v > -INT32_MAX && v < INT32_MAX ? (int32_t)floor(v + 0.5) : 0;
      }
    }
  }
}

static void clear(lift_job* job)
{
  for (size_t c = 0; c < CHI_ORDER_CHUNKS; ++c)
  {
    job->parts[c] = (part){ .worst = INFINITY };
    for (int k = 0; k < 4; ++k)
    {
      job->parts[c].low[k] = INFINITY;
      job->parts[c].high[k] = -INFINITY;
    }
  }
}

static part add_up(const lift_job* job)
{
  part sum = job->parts[0];
  for (size_t c = 1; c < CHI_ORDER_CHUNKS; ++c)
  {
    const part* const p = job->parts + c;
    for (int k = 0; k < 4; ++k)
    {
      sum.low[k] = p->low[k] < sum.low[k] ? p->low[k] : sum.low[k];
      sum.high[k] = p->high[k] > sum.high[k] ? p->high[k] : sum.high[k];
    }
    for (int k = 0; k < 6; ++k)
    {
      sum.covariance[k] += p->covariance[k];
    }
    sum.tied += p->tied;
    sum.wrong += p->wrong;
    sum.flat += p->flat;
    for (int k = 0; k < SIZES; ++k)
    {
      sum.sizes[k] += p->sizes[k];
    }
    sum.worst = p->worst < sum.worst ? p->worst : sum.worst;
  }
  return sum;
}

chi_status chi_lift_run(const chi_exec* exec, lift_job* job, chi_range_fn body, part* sum)
{
  clear(job);
  const chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, body, job);
  *sum = add_up(job);
  return status;
}

/* The largest gradient, for what a tie is; outliers apart: flat cells at the hull, whose spheres
 * are huge, would leave few bits to the others. */
static chi_status measure(const chi_exec* exec, lift_job* job, part* planes)
{
  job->cut = INFINITY;
  chi_status status = chi_lift_run(exec, job, find_planes, planes);
  int top = SIZES - 1, last;
  while (top > 0 && planes->sizes[top] == 0)
  {
    --top;
  }
  size_t far = planes->sizes[top];
  for (last = top; last > 0 && far <= job->mesh->count / job->stride / SHARE;
       far += planes->sizes[--last])
  {
  }
  if (status == CHI_OK && last < top - 1) /* two bits or more to gain */
  {
    job->cut = ldexp(1, last + 1 + LEAST);
    status = chi_lift_run(exec, job, find_planes, planes);
  }
  double most = 0;
  for (int k = 0; k < 3; ++k)
  {
    most = fmax(most, fmax(planes->high[k], -planes->low[k]));
  }
  job->tie = TIE * most;
  return status;
}

static chi_status judge(const chi_exec* exec, lift_job* job, part* planes, part* faces)
{
  chi_status status = measure(exec, job, planes);
  if (status == CHI_OK)
  {
    status = chi_lift_run(exec, job, chi_lift_judge_faces, faces);
  }
  return status;
}

static chi_status gather_ties(
  const chi_exec* exec, lift_job* job, const chi_order_adjacency* adjacency)
{
  chi_order_lift* const lift = job->lift;
  chi_buffer pairs = { 0 };
  size_t at = 0;
  for (size_t c = 0; c < CHI_ORDER_CHUNKS; ++c)
  {
    job->starts[c] = at;
    at += (size_t)job->parts[c].tied;
  }
  if (!chi_buffer_reserve(exec, &pairs, at, 2 * sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  part sum;
  job->pairs = (uint32_t*)pairs.data;
  chi_status status = chi_lift_run(exec, job, chi_lift_judge_faces, &sum);
  job->pairs = NULL;
  if (status == CHI_OK)
  {
    status =
      chi_order_groups_build(exec, lift, job->mesh, adjacency, (const uint32_t*)pairs.data, at);
  }
  chi_buffer_free(exec, &pairs);
  return status;
}

chi_status chi_order_lift_find(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, int general)
{
  part parts[CHI_ORDER_CHUNKS], sum, planes = { 0 }, faces = { 0 };
  size_t far[CHI_ORDER_CHUNKS];
  lift_job job = { .mesh = mesh,
    .neighbors = (const uint32_t*)adjacency->neighbors.data,
    .lift = lift,
    .parts = parts,
    .stride = 1,
    .far = far };
  chi_status status = chi_lift_run(exec, &job, chi_lift_find_frame, &sum);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_lift_set_frame(lift, &sum, mesh->count);
  for (int corner = 0; corner < 8; ++corner)
  {
    double x[3], y[3];
    for (int k = 0; k < 3; ++k)
    {
      x[k] = corner >> k & 1 ? sum.high[k] : sum.low[k];
    }
    chi_order_lower(lift, x, y);
    job.radius = fmax(job.radius, sqrt(dot(y, y, 3)));
  }
  /* a thousandth tied is what repairing them costs less than a search; a sample is asked first */
  const size_t strides[2] = { mesh->count / SAMPLE + 1, 1 };
  int suits = 1;
  for (int k = !general || strides[0] == 1; k < 2 && suits && status == CHI_OK; ++k)
  {
    job.stride = strides[k];
    status = judge(exec, &job, &planes, &faces);
    suits = !general ||
      (faces.wrong == 0 && faces.tied <= (int64_t)(2 * mesh->count / job.stride / 1000));
  }
  job.stride = 1;
  if (status == CHI_OK && !suits)
  {
    double first[6], form[6];
    int found = 0;
    memcpy(first, lift->form, sizeof first);
    status = chi_lift_search(exec, &job, form, &found);
    int has_heights = 0;
    if (status == CHI_OK && general > 1 && !found && planes.flat == 0)
    {
      status = chi_order_heights_find(exec, lift, mesh, adjacency, &has_heights);
    }
    if (!has_heights)
    {
      chi_buffer_free(exec, &lift->heights);
      memcpy(lift->form, found ? form : first, sizeof first);
    }
    if (status == CHI_OK)
    {
      status = judge(exec, &job, &planes, &faces);
    }
  }
  if (status != CHI_OK)
  {
    return status;
  }
  lift->tied = faces.tied;
  lift->wrong = faces.wrong;
  lift->usable = faces.wrong == 0 && planes.flat == 0;
  lift->outlier_count = 0;
  for (size_t c = 0; c < CHI_ORDER_CHUNKS; ++c)
  {
    job.starts[c] = lift->outlier_count;
    lift->outlier_count += far[c];
  }
  if (!chi_buffer_reserve(exec, &lift->planes, 4 * mesh->count, sizeof(int32_t)) ||
    !chi_buffer_reserve(exec, &lift->outliers, lift->outlier_count, sizeof(chi_order_outlier)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (int k = 0; k < 4; ++k)
  {
    const double half =
      planes.low[k] <= planes.high[k] ? 0.5 * (planes.high[k] - planes.low[k]) : 0;
    job.middle[k] = half > 0 ? planes.low[k] + half : 0;
    job.inverse[k] = half > 0 ? (INT32_MAX - 1) / half : 0;
    lift->scale[k] = half / (INT32_MAX - 1);
  }
  status = chi_for(exec, CHI_ORDER_CHUNKS, write_planes, &job);
  if (status == CHI_OK && general && lift->usable && lift->tied > 0)
  {
    status = gather_ties(exec, &job, adjacency);
  }
  chi_buffer_free(exec, &lift->heights); /* the planes tell all */
  return status;
}

void chi_order_lift_free(const chi_exec* exec, chi_order_lift* lift)
{
  chi_buffer_free(exec, &lift->planes);
  chi_buffer_free(exec, &lift->groups);
  chi_buffer_free(exec, &lift->members);
  chi_buffer_free(exec, &lift->outliers);
  chi_buffer_free(exec, &lift->heights);
}
