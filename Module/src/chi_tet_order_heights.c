/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A height for each vertex, where no quadratic form is convex across all faces. With l the affine
 * dependency of a face's five points, of length 1 and positive at the opposite two, a face is
 * convex where l . h > 0. The form that brings all l . h as near to one value as can be is the
 * start; then each face that falls short moves its five heights along l by what it lacks. Source:
 * Agmon, "The Relaxation Method for Linear Inequalities", 1954.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

enum
{
  SWEEPS = 96,
  PATIENCE = 8 /* sweeps in which concave faces have to become half as many */
};

/* What is asked of a face, as a share of the mean. */
static const double TARGET = 0.0625;

typedef struct link
{
  uint32_t id[5]; /* the two opposite vertices first */
  float l[5];
} link;

typedef struct sums /* of least squares, and what a chunk counts */
{
  double a[6][6], b[6];
  size_t faces;
} sums;

typedef struct heights_job
{
  const chi_tet_mesh_view* mesh;
  const uint32_t* neighbors;
  const chi_order_lift* lift;
  link* links;
  sums* sums;
  size_t starts[CHI_ORDER_CHUNKS];
  double* heights;
} heights_job;

static void count_faces(void* data, size_t begin, size_t end)
{
  const heights_job* const it = (const heights_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  for (size_t c = begin; c < end; ++c)
  {
    it->sums[c] = (sums){ .faces = 0 };
    for (size_t i = 4 * c * chunk; i < 4 * n && i < 4 * (c + 1) * chunk; ++i)
    {
      it->sums[c].faces += it->neighbors[i] < n && it->neighbors[i] > i / 4;
    }
  }
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* The dependency of five points: each one's share is the volume of the other four. */
static void relate(const double y[5][3], link* f)
{
  double d[4][3], l[5], square = 0;
  for (int i = 0; i < 4; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      d[i][k] = y[i + 1][k] - y[0][k];
    }
  }
  l[1] = determinant(d[1], d[2], d[3]);
  l[2] = -determinant(d[0], d[2], d[3]);
  l[3] = determinant(d[0], d[1], d[3]);
  l[4] = -determinant(d[0], d[1], d[2]);
  l[0] = -(l[1] + l[2] + l[3] + l[4]);
  for (int i = 0; i < 5; ++i)
  {
    square += l[i] * l[i];
  }
  const double scale = square > 0 ? (l[0] < 0 ? -1 : 1) / sqrt(square) : 0;
  for (int i = 0; i < 5; ++i)
  {
    f->l[i] = (float)(l[i] * scale);
  }
}

static void link_faces(void* data, size_t begin, size_t end)
{
  const heights_job* const it = (const heights_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  for (size_t c = begin; c < end; ++c)
  {
    link* f = it->links + it->starts[c];
    sums* const s = it->sums + c;
    for (size_t i = 4 * c * chunk; i < 4 * n && i < 4 * (c + 1) * chunk; ++i)
    {
      const size_t t = i / 4, u = it->neighbors[i];
      if (!(u < n && u > t))
      {
        continue;
      }
      size_t back = 0;
      while (back < 3 && it->neighbors[4 * u + back] != t)
      {
        ++back;
      }
      f->id[0] = it->mesh->vertices[i];
      f->id[1] = it->mesh->vertices[4 * u + back];
      double y[5][3], q[6] = { 0 };
      for (int k = 0; k < 5; ++k)
      {
        double x[3];
        if (k > 1)
        {
          f->id[k] = it->mesh->vertices[4 * t + chi_order_face[i % 4][k - 2]];
        }
        chi_view_get(&it->mesh->points, f->id[k], x);
        chi_order_lower(it->lift, x, y[k]);
      }
      relate((const double(*)[3])y, f);
      for (int k = 0; k < 5; ++k)
      {
        for (int a = 0; a < 3; ++a)
        {
          q[a] += (double)f->l[k] * y[k][a] * y[k][a];
          q[3 + a] += (double)f->l[k] * y[k][a] * y[k][(a + 1) % 3];
        }
      }
      for (int a = 0; a < 6; ++a)
      {
        s->b[a] += q[a];
        for (int b = 0; b < 6; ++b)
        {
          s->a[a][b] += q[a] * q[b];
        }
      }
      ++f;
    }
  }
}

/* The form of least squares: q . form = 1 for all faces. 0 where there is none. */
static int solve(sums* s, double form[6])
{
  for (int p = 0; p < 6; ++p)
  {
    /* positive semi-definite: without pivots */
    if (!(s->a[p][p] > 0))
    {
      return 0;
    }
    for (int r = 0; r < 6; ++r)
    {
      const double share = r == p ? 0 : s->a[r][p] / s->a[p][p];
      for (int k = 0; k < 6; ++k)
      {
        s->a[r][k] -= share * s->a[p][k];
      }
      s->b[r] -= share * s->b[p];
    }
  }
  for (int p = 0; p < 6; ++p)
  {
    form[p] = s->b[p] / s->a[p][p];
  }
  return 1;
}

static void raise_points(void* data, size_t begin, size_t end)
{
  const heights_job* const it = (const heights_job*)data;
  const size_t n = it->mesh->points.count, chunk = chi_order_chunk(n);
  const double* const m = it->lift->form;
  for (size_t i = begin * chunk; i < n && i < end * chunk; ++i)
  {
    double x[3], y[3];
    chi_view_get(&it->mesh->points, i, x);
    chi_order_lower(it->lift, x, y);
    it->heights[i] = m[0] * y[0] * y[0] + m[1] * y[1] * y[1] + m[2] * y[2] * y[2] +
      m[3] * y[0] * y[1] + m[4] * y[1] * y[2] + m[5] * y[2] * y[0];
  }
}

/* How many faces are not convex, after each that lacks something has moved its vertices. In order:
 * one face sees what the last has done. */
static size_t sweep(const heights_job* it, size_t faces, double target)
{
  size_t concave = 0;
  for (size_t i = 0; i < faces; ++i)
  {
    const link* const f = it->links + i;
    double rise = 0;
    for (int k = 0; k < 5; ++k)
    {
      rise += (double)f->l[k] * it->heights[f->id[k]];
    }
    if (!(rise >= target))
    {
      concave += !(rise > 0.25 * target);
      for (int k = 0; k < 5; ++k)
      {
        it->heights[f->id[k]] += (target - rise) * (double)f->l[k];
      }
    }
  }
  return concave;
}

chi_status chi_order_heights_find(const chi_exec* exec, chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, int* found)
{
  chi_buffer links = { 0 };
  sums parts[CHI_ORDER_CHUNKS], sum = { .faces = 0 };
  heights_job job = { .mesh = mesh,
    .neighbors = (const uint32_t*)adjacency->neighbors.data,
    .lift = lift,
    .sums = parts };
  *found = 0;
  chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, count_faces, &job);
  for (size_t c = 0; c < CHI_ORDER_CHUNKS && status == CHI_OK; ++c)
  {
    job.starts[c] = sum.faces;
    sum.faces += parts[c].faces;
  }
  if (status != CHI_OK || sum.faces == 0)
  {
    return status;
  }
  if (!chi_buffer_reserve(exec, &links, sum.faces, sizeof(link)) ||
    !chi_buffer_reserve(exec, &lift->heights, mesh->points.count, sizeof(double)))
  {
    chi_buffer_free(exec, &links);
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job.links = (link*)links.data;
  job.heights = (double*)lift->heights.data;
  status = chi_for(exec, CHI_ORDER_CHUNKS, link_faces, &job);
  for (size_t c = 0; c < CHI_ORDER_CHUNKS && status == CHI_OK; ++c)
  {
    for (int a = 0; a < 6; ++a)
    {
      sum.b[a] += parts[c].b[a];
      for (int b = 0; b < 6; ++b)
      {
        sum.a[a][b] += parts[c].a[a][b];
      }
    }
  }
  if (status == CHI_OK && solve(&sum, lift->form))
  {
    status = chi_for(exec, CHI_ORDER_CHUNKS, raise_points, &job);
    size_t before = SIZE_MAX;
    for (int k = 0; k < SWEEPS && status == CHI_OK && !*found; ++k)
    {
      const size_t concave = sweep(&job, sum.faces, TARGET);
      *found = concave == 0;
      if (k % PATIENCE == 0)
      {
        if (concave > before / 2)
        {
          break;
        }
        before = concave;
      }
      status = chi_is_cancelled(exec) ? CHI_ERROR_CANCELLED : CHI_OK;
    }
  }
  chi_buffer_free(exec, &links);
  return status;
}
