/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FIBER_SURFACE_H
#define CHI_FIBER_SURFACE_H

/* Fiber surfaces of small meshes with all of their arrays, and what is measured on them. Arrays
 * that the core sees are blocks of exact size. */

#include "grid_lattice.h"

#include <chiaroscuro/chi_fiber.h>

typedef void (*field_fn)(const double x[3], double value[2]);

/* Two fields on a grid, interleaved; its points are those of its split. */
typedef struct fields
{
  double* values; /* [points x 2] */
  size_t points;
  chi_array_view view;
} fields;

__attribute__((unused)) static void* must_alloc(size_t bytes)
{
  void* const block = malloc(bytes ? bytes : 1);
  if (!block)
  {
    exit(1);
  }
  return block;
}

__attribute__((unused)) static fields make_fields(const chi_grid_view* grid, field_fn fn)
{
  fields f = { 0 };
  split s;
  CHECK(make_split(&s, NULL, grid) == CHI_OK);
  f.points = s.counts.points;
  f.values = must_alloc(f.points * 2 * sizeof(double));
  for (size_t i = 0; i < f.points; ++i)
  {
    fn(s.points[i], f.values + 2 * i);
  }
  drop_split(&s);
  f.view = (chi_array_view){ f.values, f.points, 2, 2 * sizeof(double), CHI_F64 };
  return f;
}

/* Lines through points of the fields' plane, given one after the other. */
typedef struct lines
{
  double* xyz;
  int64_t* offsets;
  chi_lines_view view;
} lines;

__attribute__((unused)) static lines make_lines(
  size_t line_count, const size_t* counts, const double (*points)[2])
{
  lines l = { 0 };
  size_t total = 0;
  l.offsets = must_alloc((line_count + 1) * sizeof *l.offsets);
  for (size_t i = 0; i < line_count; ++i)
  {
    l.offsets[i] = (int64_t)total;
    total += counts[i];
  }
  l.offsets[line_count] = (int64_t)total;
  l.xyz = must_alloc(3 * total * sizeof *l.xyz);
  for (size_t i = 0; i < total; ++i)
  {
    l.xyz[3 * i] = points[i][0];
    l.xyz[3 * i + 1] = points[i][1];
    l.xyz[3 * i + 2] = 0;
  }
  l.view = (chi_lines_view){ .points = { l.xyz, total, 3 * sizeof(double), CHI_F64 },
    .offsets = l.offsets,
    .line_count = line_count };
  return l;
}

__attribute__((unused)) static lines make_line(size_t count, const double (*points)[2])
{
  return make_lines(1, &count, points);
}

__attribute__((unused)) static void drop_lines(lines* l)
{
  free(l->xyz);
  free(l->offsets);
}

/* A circle as a closed line, counterclockwise or not. */
__attribute__((unused)) static lines make_circle(
  double u, double v, double radius, size_t count, int clockwise)
{
  double(*const p)[2] = must_alloc((count + 1) * sizeof *p);
  for (size_t i = 0; i <= count; ++i)
  {
    const double angle = 2 * acos(-1) * (double)(i % count) / (double)count * (clockwise ? -1 : 1);
    p[i][0] = u + radius * cos(angle);
    p[i][1] = v + radius * sin(angle);
  }
  lines l = make_line(count + 1, (const double(*)[2])p);
  free(p);
  return l;
}

typedef struct surface
{
  chi_fiber_sizes sizes;
  double (*points)[3];
  float (*normals)[3];
  float* parameter;
  int64_t (*triangles)[3];
  int64_t *offsets, *segments, *cells, *components;
} surface;

__attribute__((unused)) static void drop_surface(surface* s)
{
  free(s->points);
  free(s->normals);
  free(s->parameter);
  free(s->triangles);
  free(s->offsets);
  free(s->segments);
  free(s->cells);
  free(s->components);
  memset(s, 0, sizeof *s);
}

__attribute__((unused)) static chi_fiber_params params_of(const fields* f, const lines* l)
{
  return (chi_fiber_params){ .struct_size = sizeof(chi_fiber_params),
    .fields = { &f->view, &f->view },
    .components = { 0, 1 },
    .polygon = l->view };
}

/* All arrays of the surface that a handle holds. */
__attribute__((unused)) static chi_status write_surface(
  surface* s, const chi_exec* exec, const chi_fiber* fiber, const chi_fiber_params* params)
{
  memset(s, 0, sizeof *s);
  chi_fiber_get_sizes(fiber, &s->sizes);
  const size_t n = s->sizes.points, m = s->sizes.triangles;
  const int finds = params->find_components || params->minimum_area > 0;
  s->points = must_alloc(n * sizeof *s->points);
  s->normals = params->no_normals ? NULL : must_alloc(n * sizeof *s->normals);
  s->parameter = must_alloc(n * sizeof *s->parameter);
  s->triangles = must_alloc(m * sizeof *s->triangles);
  s->offsets = must_alloc((m + 1) * sizeof *s->offsets);
  s->segments = must_alloc(m * sizeof *s->segments);
  s->cells = must_alloc(m * sizeof *s->cells);
  s->components = finds ? must_alloc(m * sizeof *s->components) : NULL;
  const chi_fiber_outputs out = { .struct_size = sizeof out,
    .points = s->points,
    .point_type = CHI_F64,
    .normals = (float*)s->normals,
    .segment_parameter = s->parameter,
    .offsets = s->offsets,
    .connectivity = (int64_t*)s->triangles,
    .segment_ids = s->segments,
    .cell_ids = s->cells,
    .component_ids = s->components };
  return chi_fiber_write(exec, fiber, &out);
}

/* The surface of a mesh, from a handle of its own. */
__attribute__((unused)) static surface surface_of(
  const chi_grid_view* grid, const chi_fiber_params* params)
{
  surface s = { 0 };
  chi_fiber* fiber = NULL;
  CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  CHECK(chi_fiber_extract(NULL, fiber, grid, params) == CHI_OK);
  CHECK(write_surface(&s, NULL, fiber, params) == CHI_OK);
  chi_fiber_destroy(NULL, fiber);
  return s;
}

__attribute__((unused)) static void area_vector(const surface* s, size_t t, double n[3])
{
  const double *const a = s->points[s->triangles[t][0]], *const b = s->points[s->triangles[t][1]],
                      *const c = s->points[s->triangles[t][2]];
  const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
  n[0] = 0.5 * (u[1] * v[2] - u[2] * v[1]);
  n[1] = 0.5 * (u[2] * v[0] - u[0] * v[2]);
  n[2] = 0.5 * (u[0] * v[1] - u[1] * v[0]);
}

__attribute__((unused)) static double area_of(const surface* s)
{
  double sum = 0;
  for (size_t t = 0; t < s->sizes.triangles; ++t)
  {
    double n[3];
    area_vector(s, t, n);
    sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  return sum;
}

/* What a closed surface encloses, positive where triangles are counterclockwise from outside. */
__attribute__((unused)) static double enclosed_by(const surface* s)
{
  double sum = 0;
  for (size_t t = 0; t < s->sizes.triangles; ++t)
  {
    double n[3];
    area_vector(s, t, n);
    const double* const a = s->points[s->triangles[t][0]];
    sum += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 3;
  }
  return sum;
}

typedef struct edge
{
  int64_t a, b;
  int balance, uses;
} edge;

__attribute__((unused)) static int compare_edges(const void* x, const void* y)
{
  const edge *const p = (const edge*)x, *const q = (const edge*)y;
  return p->a != q->a ? (p->a > q->a) - (p->a < q->a) : (p->b > q->b) - (p->b < q->b);
}

typedef struct edge_counts
{
  size_t open;    /* not crossed as often in one direction as in the other */
  size_t crowded; /* used more than twice */
} edge_counts;

__attribute__((unused)) static edge_counts count_edges(const surface* s)
{
  const size_t n = 3 * s->sizes.triangles;
  edge* const edges = must_alloc(n * sizeof *edges);
  for (size_t i = 0; i < n; ++i)
  {
    const int64_t a = s->triangles[i / 3][i % 3], b = s->triangles[i / 3][(i + 1) % 3];
    edges[i] = (edge){ a < b ? a : b, a < b ? b : a, a < b ? 1 : -1, 1 };
    CHECK(a != b);
  }
  qsort(edges, n, sizeof *edges, compare_edges);
  edge_counts counts = { 0, 0 };
  for (size_t i = 0; i < n;)
  {
    int balance = 0, uses = 0;
    const edge* const e = edges + i;
    for (; i < n && compare_edges(edges + i, e) == 0; ++i)
    {
      balance += edges[i].balance;
      ++uses;
    }
    counts.open += balance != 0;
    counts.crowded += uses > 2;
  }
  free(edges);
  return counts;
}

/* What every surface promises: ids that are there, every point used, offsets in steps of three,
 * cells in the mesh, parameters within 0 ... 1, unit normals. */
__attribute__((unused)) static void check_surface(const surface* s, size_t cells)
{
  const size_t n = s->sizes.points, m = s->sizes.triangles;
  uint8_t* const used = must_alloc(n);
  size_t bad = 0;
  memset(used, 0, n);
  for (size_t t = 0; t < m; ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int64_t id = s->triangles[t][k];
      if (id < 0 || (size_t)id >= n)
      {
        ++bad;
      }
      else
      {
        used[id] = 1;
      }
    }
    bad += s->offsets[t + 1] != 3 * (int64_t)(t + 1);
    bad += s->cells[t] < 0 || (size_t)s->cells[t] >= cells;
  }
  bad += s->offsets[0] != 0;
  for (size_t i = 0; i < n; ++i)
  {
    bad += !used[i];
    bad += !(s->parameter[i] >= 0 && s->parameter[i] <= 1);
    if (s->normals)
    {
      const float* const v = s->normals[i];
      bad += !(fabs(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) - 1) < 1e-6); /* of float */
    }
  }
  CHECK(bad == 0);
  free(used);
}

/* Of the fields' plane. */
__attribute__((unused)) static const double fiber_square[5][2] = { { -0.4, -0.5 }, { 0.6, -0.5 },
  { 0.6, 0.4 }, { -0.4, 0.4 }, { -0.4, -0.5 } };

__attribute__((unused)) static void mixed_waves(const double x[3], double value[2])
{
  value[0] = sin(1.3 * x[0] + x[1]) + 0.5 * cos(0.4 * x[2]);
  value[1] = cos(0.8 * x[1] - x[2]) + 0.5 * sin(1.5 * x[0]);
}

/* The tetrahedra of a grid's split as cells of their own. */
__attribute__((unused)) static mesh* tetrahedra_of(const chi_grid_view* grid)
{
  mesh* const m = new_mesh();
  split s;
  CHECK(make_split(&s, NULL, grid) == CHI_OK);
  for (size_t i = 0; i < s.counts.points; ++i)
  {
    add_point(m, s.points[i][0], s.points[i][1], s.points[i][2]);
  }
  for (size_t t = 0; t < s.counts.tetrahedra; ++t)
  {
    const int64_t ids[4] = { s.vertices[t][0], s.vertices[t][1], s.vertices[t][2],
      s.vertices[t][3] };
    add_cell(m, 10, 4, ids);
  }
  drop_split(&s);
  return m;
}

__attribute__((unused)) static int same_surface(const surface* a, const surface* b)
{
  const size_t n = a->sizes.points, m = a->sizes.triangles;
  return n == b->sizes.points && m == b->sizes.triangles &&
    memcmp(a->points, b->points, n * sizeof *a->points) == 0 &&
    memcmp(a->normals, b->normals, n * sizeof *a->normals) == 0 &&
    memcmp(a->parameter, b->parameter, n * sizeof *a->parameter) == 0 &&
    memcmp(a->triangles, b->triangles, m * sizeof *a->triangles) == 0 &&
    memcmp(a->segments, b->segments, m * sizeof *a->segments) == 0 &&
    memcmp(a->cells, b->cells, m * sizeof *a->cells) == 0;
}

#endif
