/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a lift orders a body that is not convex. If all points but its own lie above the plane of
 * each tetrahedron, the mesh is part of the one convex surface over these points: at a point of a
 * tetrahedron no other plane is higher, gaps or not. For a positive form, "above the plane" is
 * "outside of the sphere", in coordinates in which the form is the square of the length.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

enum
{
  EFFORT = 256 /* places of the table looked at for each tetrahedron, on average, at most */
};

/* Points must be outside by this share of the squared radius: more than keys resolve where cells
 * are above 1/1000 of the extent, and than spheres of rounded coordinates are off. */
static const double MARGIN = 1e-6;
/* The volume as a share of what it is the difference of: below it spheres are off by more. */
static const double SOLID = 1e-6;

typedef struct hull_job
{
  const chi_tet_mesh_view* mesh;
  double center[3], to_ball[9];
  double low[3], per_place[3];
  int32_t places[3];
  uint32_t* starts;  /* [places + 1] */
  uint32_t* ids;     /* points by place */
  double (*z)[3];    /* likewise */
  uint8_t* is_below; /* [chunks] */
} hull_job;

static void transform(const hull_job* it, const double x[3], double z[3])
{
  for (int r = 0; r < 3; ++r)
  {
    z[r] = 0;
    for (int k = 0; k < 3; ++k)
    {
      z[r] += it->to_ball[3 * r + k] * (x[k] - it->center[k]);
    }
  }
}

static int32_t place_of(const hull_job* it, double z, int k)
{
  const double at = floor((z - it->low[k]) * it->per_place[k]);
  return at > 0 ? at < it->places[k] ? (int32_t)at : it->places[k] - 1 : 0;
}

/* The frame's axes and the form's root: z^T z is the form. 0 where it is not positive. */
static int set_ball(const chi_order_lift* lift, hull_job* job)
{
  const double* const f = lift->form;
  double m[9] = { f[0], f[3] / 2, f[5] / 2, f[3] / 2, f[1], f[4] / 2, f[5] / 2, f[4] / 2, f[2] };
  double root[9] = { 0 };
  const double least = 1e-6 * fmax(f[0], fmax(f[1], f[2]));
  for (int i = 0; i < 3; ++i) /* m = root^T root, root upper triangular */
  {
    for (int j = i; j < 3; ++j)
    {
      double s = m[3 * i + j];
      for (int k = 0; k < i; ++k)
      {
        s -= root[3 * k + i] * root[3 * k + j];
      }
      if (j == i && !(s > least))
      {
        return 0;
      }
      root[3 * i + j] = j == i ? sqrt(s) : s / root[4 * i];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    job->center[i] = lift->center[i];
    for (int j = 0; j < 3; ++j)
    {
      job->to_ball[3 * i + j] = 0;
      for (int k = i; k < 3; ++k)
      {
        job->to_ball[3 * i + j] += root[3 * i + k] * lift->frame[3 * k + j];
      }
    }
  }
  return 1;
}

/* The mesh's points by the places of a grid: two to a place. */
static chi_status sort_points(const chi_exec* exec, hull_job* job, chi_buffer buffers[4])
{
  const chi_tet_mesh_view* const mesh = job->mesh;
  const size_t n = mesh->points.count;
  double high[3] = { -INFINITY, -INFINITY, -INFINITY }, volume = 1;
  size_t used = 0;
  if (!chi_buffer_reserve(exec, buffers, n, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  uint8_t* const is_used = (uint8_t*)buffers[0].data;
  memset(is_used, 0, n);
  for (size_t i = 0; i < 4 * mesh->count; ++i)
  {
    is_used[mesh->vertices[i]] = 1;
  }
  for (int k = 0; k < 3; ++k)
  {
    job->low[k] = INFINITY;
  }
  for (size_t i = 0; i < n; ++i)
  {
    double x[3], z[3];
    chi_view_get(&mesh->points, i, x);
    transform(job, x, z);
    used += is_used[i];
    for (int k = 0; k < 3 && is_used[i]; ++k)
    {
      job->low[k] = fmin(job->low[k], z[k]);
      high[k] = fmax(high[k], z[k]);
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    volume *= high[k] - job->low[k];
  }
  const double side = cbrt(2 * volume / (double)used);
  size_t total = 1;
  for (int k = 0; k < 3; ++k)
  {
    const double size = high[k] - job->low[k];
    /* flat bodies: as many places as points suffice along any axis */
    job->places[k] = (int32_t)fmin(fmax(size / side, 1), 1024);
    job->per_place[k] = size > 0 ? job->places[k] / size : 0;
    total *= (size_t)job->places[k];
  }
  if (!chi_buffer_reserve(exec, buffers + 1, total + 2, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, buffers + 2, used, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, buffers + 3, used, 3 * sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->starts = (uint32_t*)buffers[1].data;
  job->ids = (uint32_t*)buffers[2].data;
  job->z = (double(*)[3])buffers[3].data;
  memset(job->starts, 0, (total + 2) * sizeof *job->starts);
  for (int pass = 0; pass < 2; ++pass)
  {
    for (size_t i = 0; i < n; ++i)
    {
      double x[3], z[3];
      if (is_used[i])
      {
        chi_view_get(&mesh->points, i, x);
        transform(job, x, z);
        const size_t place = (size_t)place_of(job, z[0], 0) +
          (size_t)job->places[0] *
            ((size_t)place_of(job, z[1], 1) +
              (size_t)job->places[1] * (size_t)place_of(job, z[2], 2));
        if (pass)
        {
          const uint32_t at = job->starts[place + 1]++;
          job->ids[at] = (uint32_t)i;
          memcpy(job->z[at], z, sizeof z);
        }
        else
        {
          ++job->starts[place + 2];
        }
      }
    }
    for (size_t place = 0; place < total && !pass; ++place)
    {
      job->starts[place + 2] += job->starts[place + 1];
    }
  }
  return CHI_OK;
}

/* The sphere through the vertices; 0 where it is not known well enough. */
static int find_sphere(const hull_job* it, size_t t, double center[3], double* square)
{
  double x[4][3], z[4][3], e[3][3], q[3], volume = 0, most = 0, sum[3] = { 0, 0, 0 };
  chi_order_corners(it->mesh, t, x);
  for (int i = 0; i < 4; ++i)
  {
    transform(it, x[i], z[i]);
  }
  for (int i = 0; i < 3; ++i)
  {
    q[i] = 0;
    for (int k = 0; k < 3; ++k)
    {
      e[i][k] = z[i + 1][k] - z[0][k];
      q[i] += 0.5 * e[i][k] * e[i][k];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    const double *const a = e[(i + 1) % 3], *const b = e[(i + 2) % 3];
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      const double n = a[l] * b[m] - a[m] * b[l];
      sum[k] += q[i] * n;
      volume += i == 0 ? e[0][k] * n : 0;
      most += i == 0 ? fabs(e[0][k]) * (fabs(a[l] * b[m]) + fabs(a[m] * b[l])) : 0;
    }
  }
  *square = 0;
  for (int k = 0; k < 3; ++k)
  {
    sum[k] /= volume;
    *square += sum[k] * sum[k];
    center[k] = z[0][k] + sum[k];
  }
  return fabs(volume) > SOLID * most;
}

/* 1: a point that is not t's lies within its sphere, or not clearly outside; 2: too much to do. */
static uint8_t look(const hull_job* it, size_t t, size_t* effort)
{
  double center[3], square;
  if (!find_sphere(it, t, center, &square))
  {
    return 1;
  }
  const uint32_t* const v = it->mesh->vertices + 4 * t;
  const double limit = square * (1 + MARGIN), reach = sqrt(limit);
  int32_t first[3], last[3];
  size_t boxes = 1;
  for (int k = 0; k < 3; ++k)
  {
    first[k] = place_of(it, center[k] - reach, k);
    last[k] = place_of(it, center[k] + reach, k);
    boxes *= (size_t)(last[k] - first[k] + 1);
  }
  if (boxes > *effort)
  {
    return 2;
  }
  *effort -= boxes;
  for (int32_t k = first[2]; k <= last[2]; ++k)
  {
    for (int32_t j = first[1]; j <= last[1]; ++j)
    {
      const size_t row = (size_t)it->places[0] * ((size_t)j + (size_t)it->places[1] * (size_t)k);
      for (uint32_t p = it->starts[row + (size_t)first[0]];
           p < it->starts[row + (size_t)last[0] + 1]; ++p)
      {
        const double d[3] = { it->z[p][0] - center[0], it->z[p][1] - center[1],
          it->z[p][2] - center[2] };
        const uint32_t id = it->ids[p];
        if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= limit && id != v[0] && id != v[1] &&
          id != v[2] && id != v[3])
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

static void look_below(void* data, size_t begin, size_t end)
{
  const hull_job* const it = (const hull_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  for (size_t c = begin; c < end; ++c)
  {
    size_t effort = EFFORT * chunk + 4096;
    it->is_below[c] = 0;
    for (size_t t = c * chunk; t < n && t < (c + 1) * chunk && !it->is_below[c]; ++t)
    {
      it->is_below[c] = look(it, t, &effort);
    }
  }
}

chi_status chi_order_lift_supports(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, int32_t* supports)
{
  uint8_t is_below[CHI_ORDER_CHUNKS];
  chi_buffer buffers[4] = { { 0 } };
  hull_job job = { .mesh = mesh, .is_below = is_below };
  *supports = 0;
  if (mesh->count == 0 || !set_ball(lift, &job))
  {
    return CHI_OK;
  }
  chi_status status = sort_points(exec, &job, buffers);
  status = status == CHI_OK ? chi_for(exec, CHI_ORDER_CHUNKS, look_below, &job) : status;
  *supports = status == CHI_OK;
  for (int c = 0; c < CHI_ORDER_CHUNKS && status == CHI_OK; ++c)
  {
    *supports &= !is_below[c];
  }
  for (int i = 0; i < 4; ++i)
  {
    chi_buffer_free(exec, buffers + i);
  }
  return status;
}
