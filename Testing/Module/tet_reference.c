/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "tet_reference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  BAND = 8 /* rows of pixels at a time: of fine meshes the fragments of all would not fit */
};

/* A ray: origin + z direction, where z is the depth along the view axis; x right, y up, z ahead. */
typedef struct ray
{
  double origin[3], direction[3], per_depth; /* world length */
} ray;

static ray make_ray(const chi_camera* camera, double x, double y)
{
  const double* const w = camera->window;
  const double u = w[0] + x / camera->width * (w[1] - w[0]);
  const double v = w[2] + y / camera->height * (w[3] - w[2]);
  if (camera->parallel)
  {
    return (ray){ { u, v, 0 }, { 0, 0, 1 }, 1 };
  }
  return (ray){ { 0, 0, 0 }, { u, v, 1 }, sqrt(u * u + v * v + 1) };
}

/* The ray of tetrahedra: 1e-8 of a pixel beside the place asked for, so that none runs within a
 * face, where rounding would give it to both cells or to none. The picture changes by as little. */
static ray make_generic_ray(const chi_camera* camera, double x, double y)
{
  return make_ray(camera, x + 1e-8, y + 0.618e-8);
}

static void to_eye(const chi_camera* camera, const double world[3], double eye[3])
{
  const double* const m = camera->world_to_eye;
  for (int i = 0; i < 3; ++i)
  {
    eye[i] = m[4 * i] * world[0] + m[4 * i + 1] * world[1] + m[4 * i + 2] * world[2] + m[4 * i + 3];
  }
  eye[2] = -eye[2];
}

/* A tetrahedron in the eye's coordinates, with the gradients of its barycentric coordinates. */
typedef struct cell
{
  double vertex[4][3], gradient[4][3];
  double scalar[4];
  const float* color[4]; /* or NULL */
  double window[4];      /* left, right, bottom, top of its projection, pixels */
} cell;

static void cross(const double a[3], const double b[3], double out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* 0: it has no volume. */
static int make_cell(const tet_reference_scene* s, size_t t, cell* c)
{
  double edge[3][3];
  for (int k = 0; k < 4; ++k)
  {
    to_eye(s->camera, s->points[s->vertices[t][k]], c->vertex[k]);
    const size_t value = s->is_cell_data ? t : s->vertices[t][k];
    c->scalar[k] = (double)s->scalars[value];
    c->color[k] = s->colors ? s->colors[value] : NULL;
  }
  for (int k = 0; k < 3; ++k)
  {
    for (int i = 0; i < 3; ++i)
    {
      edge[k][i] = c->vertex[k + 1][i] - c->vertex[0][i];
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    cross(edge[(k + 1) % 3], edge[(k + 2) % 3], c->gradient[k + 1]);
  }
  const double volume = dot(edge[0], c->gradient[1]);
  if (volume == 0)
  {
    return 0;
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 1; k < 4; ++k)
    {
      c->gradient[k][i] /= volume;
    }
    c->gradient[0][i] = -(c->gradient[1][i] + c->gradient[2][i] + c->gradient[3][i]);
  }
  const double* const w = s->camera->window;
  c->window[0] = c->window[2] = INFINITY;
  c->window[1] = c->window[3] = -INFINITY;
  for (int k = 0; k < 4; ++k)
  {
    const double z = c->vertex[k][2];
    if (!s->camera->parallel && z < s->camera->near_depth) /* anywhere */
    {
      c->window[0] = c->window[2] = -INFINITY;
      c->window[1] = c->window[3] = INFINITY;
      return 1;
    }
    const double by = s->camera->parallel ? 1 : 1 / z;
    const double x = (c->vertex[k][0] * by - w[0]) / (w[1] - w[0]) * s->camera->width;
    const double y = (c->vertex[k][1] * by - w[2]) / (w[3] - w[2]) * s->camera->height;
    c->window[0] = fmin(c->window[0], x);
    c->window[1] = fmax(c->window[1], x);
    c->window[2] = fmin(c->window[2], y);
    c->window[3] = fmax(c->window[3], y);
  }
  return 1;
}

/* Where all four barycentric coordinates are positive along the ray. */
static int intersect(const cell* c, const ray* r, double near_depth, tet_reference_fragment* out)
{
  double at[4], rise[4], from = near_depth, to = INFINITY, away[3];
  for (int i = 0; i < 3; ++i)
  {
    away[i] = r->origin[i] - c->vertex[0][i];
  }
  for (int k = 0; k < 4; ++k)
  {
    at[k] = (k == 0) + dot(c->gradient[k], away);
    rise[k] = dot(c->gradient[k], r->direction);
    if (rise[k] > 0)
    {
      from = fmax(from, -at[k] / rise[k]);
    }
    else if (rise[k] < 0)
    {
      to = fmin(to, -at[k] / rise[k]);
    }
    else if (at[k] < 0)
    {
      return 0;
    }
  }
  if (!(from < to))
  {
    return 0;
  }
  out->entry = from;
  out->exit = to;
  out->length = (to - from) * r->per_depth;
  out->scalar[0] = out->scalar[1] = 0;
  for (int k = 0; k < 4; ++k)
  {
    out->scalar[0] += c->scalar[k] * (at[k] + rise[k] * from);
    out->scalar[1] += c->scalar[k] * (at[k] + rise[k] * to);
  }
  for (int i = 0; i < 3 && c->color[0]; ++i)
  {
    out->color[0][i] = out->color[1][i] = 0;
    for (int k = 0; k < 4; ++k)
    {
      out->color[0][i] += (double)c->color[k][i] * (at[k] + rise[k] * from);
      out->color[1][i] += (double)c->color[k][i] * (at[k] + rise[k] * to);
    }
  }
  return 1;
}

typedef struct list
{
  tet_reference_fragment* at;
  size_t count, room;
} list;

static void append(list* l, const tet_reference_fragment* fragment)
{
  if (l->count == l->room)
  {
    l->room = l->room ? 2 * l->room : 32;
    l->at = (tet_reference_fragment*)realloc(l->at, l->room * sizeof *l->at);
    if (!l->at)
    {
      fprintf(stderr, "no memory for a reference\n");
      exit(1);
    }
  }
  l->at[l->count++] = *fragment;
}

static int is_behind(const void* a, const void* b)
{
  const tet_reference_fragment* const f = (const tet_reference_fragment*)a;
  const tet_reference_fragment* const g = (const tet_reference_fragment*)b;
  const double x = f->entry + f->exit, y = g->entry + g->exit;
  return x < y ? -1 : x > y ? 1 : f->tetrahedron < g->tetrahedron ? -1 : 1;
}

static void sort(list* l)
{
  if (l->count > 1)
  {
    qsort(l->at, l->count, sizeof *l->at, is_behind);
  }
}

tet_reference_fragment* tet_reference_list(
  const tet_reference_scene* s, double x, double y, size_t* count)
{
  const ray r = make_generic_ray(s->camera, x, y);
  list l = { NULL, 0, 0 };
  for (size_t t = 0; t < s->count; ++t)
  {
    cell c;
    tet_reference_fragment f = { .tetrahedron = (uint32_t)t };
    if (make_cell(s, t, &c) && intersect(&c, &r, s->camera->near_depth, &f))
    {
      append(&l, &f);
    }
  }
  sort(&l);
  *count = l.count;
  return l.at;
}

void tet_reference_integrate(
  const tet_reference_scene* s, const tet_reference_fragment* l, size_t count, double rgba[4])
{
  double sum[4] = { 0, 0, 0, 0 };
  for (size_t i = 0; i < count && sum[3] < 30; ++i) /* behind e^-30 nothing is seen */
  {
    const double *const scalar = l[i].scalar, length = l[i].length;
    if (s->tables)
    {
      const chi_segment_tables* const t = s->tables;
      const segment_entries e = { t->color, t->count };
      double x[2];
      for (int k = 0; k < 2; ++k)
      {
        x[k] = (scalar[k] - t->range[0]) / (t->range[1] - t->range[0]) * (t->count - 1);
      }
      const double(*const colors)[3] = s->colors ? (const double(*)[3])l[i].color : NULL;
      segment_add_direct(&e, colors, x[0], x[1], length, sum);
    }
    else
    {
      segment_add_function(
        s->classify, s->classify_data, scalar[0], scalar[1], length, 1e-9, 4, sum);
    }
  }
  memcpy(rgba, sum, 3 * sizeof *sum);
  rgba[3] = -expm1(-sum[3]);
}

/* The pixel that holds x, cut to first ... end. */
static size_t pixel(double x, size_t first, size_t end)
{
  return x > (double)first ? x < (double)end ? (size_t)x : end : first;
}

void tet_reference_render(const tet_reference_scene* s, double* rgba, uint32_t* counts)
{
  const size_t width = (size_t)s->camera->width, height = (size_t)s->camera->height;
  list* const lists = (list*)calloc(BAND * width, sizeof *lists);
  if (!lists)
  {
    fprintf(stderr, "no memory for a reference\n");
    exit(1);
  }
  for (size_t first = 0; first < height; first += BAND)
  {
    const size_t end = first + BAND < height ? first + BAND : height;
    for (size_t t = 0; t < s->count; ++t)
    {
      cell c;
      if (!make_cell(s, t, &c) || c.window[3] < (double)first || c.window[2] > (double)end)
      {
        continue;
      }
      /* One pixel more than the projection says, which rounding may have cut. */
      const size_t low = pixel(c.window[2] - 1, first, end),
                   high = pixel(c.window[3] + 2, first, end);
      const size_t left = pixel(c.window[0] - 1, 0, width),
                   right = pixel(c.window[1] + 2, 0, width);
      for (size_t y = low; y < high; ++y)
      {
        for (size_t x = left; x < right; ++x)
        {
          const ray r = make_generic_ray(s->camera, (double)x + 0.5, (double)y + 0.5);
          tet_reference_fragment f = { .tetrahedron = (uint32_t)t };
          if (intersect(&c, &r, s->camera->near_depth, &f))
          {
            append(lists + (y - first) * width + x, &f);
          }
        }
      }
    }
    for (size_t i = 0; i < (end - first) * width; ++i)
    {
      sort(lists + i);
      tet_reference_integrate(s, lists[i].at, lists[i].count, rgba + 4 * (first * width + i));
      if (counts)
      {
        counts[first * width + i] = (uint32_t)lists[i].count;
      }
      lists[i].count = 0;
    }
  }
  for (size_t i = 0; i < BAND * width; ++i)
  {
    free(lists[i].at);
  }
  free(lists);
}

/* Inside and outside of the plane through three vertices, the fourth being inside. */
static int cut(const long double vertex[4][3], int face, const long double origin[3],
  const long double direction[3], long double range[2])
{
  const long double *const a = vertex[(face + 1) & 3], *const b = vertex[(face + 2) & 3];
  const long double* const c = vertex[(face + 3) & 3];
  long double p[3], q[3], normal[3], side = 0, at = 0, rise = 0;
  for (int i = 0; i < 3; ++i)
  {
    p[i] = b[i] - a[i];
    q[i] = c[i] - a[i];
  }
  for (int i = 0; i < 3; ++i)
  {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = p[j] * q[k] - p[k] * q[j];
    side += normal[i] * (vertex[face][i] - a[i]);
    at += normal[i] * (origin[i] - a[i]);
    rise += normal[i] * direction[i];
  }
  if (side == 0)
  {
    return 0;
  }
  at = side < 0 ? -at : at;
  rise = side < 0 ? -rise : rise;
  if (rise > 0)
  {
    range[0] = fmaxl(range[0], -at / rise);
  }
  else if (rise < 0)
  {
    range[1] = fminl(range[1], -at / rise);
  }
  else if (at < 0)
  {
    return 0;
  }
  return 1;
}

long double tet_reference_thickness(
  const chi_camera* camera, const double points[4][3], double x, double y)
{
  const double *const m = camera->world_to_eye, *const w = camera->window;
  long double vertex[4][3];
  for (int k = 0; k < 4; ++k)
  {
    for (int i = 0; i < 3; ++i)
    {
      long double sum = (long double)m[4 * i + 3];
      for (int j = 0; j < 3; ++j)
      {
        sum += (long double)m[4 * i + j] * (long double)points[k][j];
      }
      vertex[k][i] = i == 2 ? -sum : sum;
    }
  }
  const long double u =
    (long double)w[0] + (long double)x / camera->width * ((long double)w[1] - (long double)w[0]);
  const long double v =
    (long double)w[2] + (long double)y / camera->height * ((long double)w[3] - (long double)w[2]);
  const int p = camera->parallel != 0;
  const long double origin[3] = { p ? u : 0, p ? v : 0, 0 };
  const long double direction[3] = { p ? 0 : u, p ? 0 : v, 1 };
  long double range[2] = { (long double)camera->near_depth, INFINITY };
  for (int face = 0; face < 4; ++face)
  {
    if (!cut((const long double(*)[3])vertex, face, origin, direction, range))
    {
      return 0;
    }
  }
  const long double per_depth = p ? 1 : sqrtl(u * u + v * v + 1);
  return range[0] < range[1] ? (range[1] - range[0]) * per_depth : 0;
}

double tet_reference_cube_length(const chi_camera* camera, double x, double y)
{
  const ray r = make_ray(camera, x, y);
  const double* const m = camera->world_to_eye;
  double from = camera->near_depth, to = INFINITY;
  for (int a = 0; a < 3; ++a)
  {
    /* back to the world: the matrix is rigid */
    const double eye[3] = { r.origin[0] - m[3], r.origin[1] - m[7], -r.origin[2] - m[11] };
    const double at = m[a] * eye[0] + m[4 + a] * eye[1] + m[8 + a] * eye[2];
    const double rise =
      m[a] * r.direction[0] + m[4 + a] * r.direction[1] - m[8 + a] * r.direction[2];
    if (rise == 0)
    {
      if (fabs(at) > 1)
      {
        return 0;
      }
      continue;
    }
    from = fmax(from, fmin((-1 - at) / rise, (1 - at) / rise));
    to = fmin(to, fmax((-1 - at) / rise, (1 - at) / rise));
  }
  return from < to ? (to - from) * r.per_depth : 0;
}
