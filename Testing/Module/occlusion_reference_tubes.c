/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Real geometry to judge the geometry buffer by: chains of capsules. */

#include "occlusion_reference_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  N = REFERENCE_SIZE /* cells of one voxel along each axis */
};

struct reference_tubes
{
  float* points; /* [count][3], NaN between chains, owned */
  size_t count;
  double radius;
  uint32_t* first;   /* [N^3 + 1] of a cell in `capsule` */
  uint32_t* capsule; /* those that may touch the cell, by their first points */
};

static int ends_of(const reference_tubes* t, size_t i, double a[3], double b[3])
{
  for (int k = 0; k < 3; ++k)
  {
    a[k] = (double)t->points[3 * i + (size_t)k];
    b[k] = (double)t->points[3 * (i + 1) + (size_t)k];
  }
  return isfinite(a[0] + a[1] + a[2]) && isfinite(b[0] + b[1] + b[2]);
}

/* Cells that a capsule's box touches; 0 where none is inside the grid. */
static int cells_of(const reference_tubes* t, size_t i, int low[3], int high[3])
{
  double a[3], b[3];
  if (!ends_of(t, i, a, b))
  {
    return 0;
  }
  for (int k = 0; k < 3; ++k)
  {
    const double from = floor(fmin(a[k], b[k]) - t->radius);
    const double to = floor(fmax(a[k], b[k]) + t->radius);
    if (!(to >= 0 && from < N))
    {
      return 0;
    }
    low[k] = (int)fmax(from, 0);
    high[k] = (int)fmin(to, N - 1);
  }
  return 1;
}

/* Counts the cells' capsules, or files them where `first` holds the next free place of each. */
static void visit_cells(reference_tubes* t, uint32_t* next, int file)
{
  for (size_t i = 0; i + 1 < t->count; ++i)
  {
    int low[3], high[3];
    if (!cells_of(t, i, low, high))
    {
      continue;
    }
    for (int z = low[2]; z <= high[2]; ++z)
    {
      for (int y = low[1]; y <= high[1]; ++y)
      {
        for (int x = low[0]; x <= high[0]; ++x)
        {
          uint32_t* const place = next + x + N * (y + N * z);
          if (file)
          {
            t->capsule[*place] = (uint32_t)i;
          }
          ++*place;
        }
      }
    }
  }
}

reference_tubes* reference_tubes_create(const float* points, size_t count, double radius)
{
  const size_t cells = (size_t)N * N * N;
  reference_tubes* const t = calloc(1, sizeof *t);
  uint32_t* const next = calloc(cells + 1, sizeof *next);
  if (t)
  {
    t->points = malloc((3 * count + 1) * sizeof *t->points);
    t->first = calloc(cells + 1, sizeof *t->first);
  }
  if (!t || !next || !t->points || !t->first)
  {
    free(next);
    reference_tubes_free(t);
    return NULL;
  }
  memcpy(t->points, points, 3 * count * sizeof *points);
  t->count = count;
  t->radius = radius;
  visit_cells(t, next, 0);
  uint32_t sum = 0;
  for (size_t i = 0; i <= cells; ++i)
  {
    t->first[i] = sum;
    sum += i < cells ? next[i] : 0;
    next[i] = t->first[i];
  }
  t->capsule = malloc(((size_t)sum + 1) * sizeof *t->capsule);
  if (t->capsule)
  {
    visit_cells(t, next, 1);
  }
  free(next);
  if (!t->capsule)
  {
    reference_tubes_free(t);
    return NULL;
  }
  return t;
}

reference_tubes* reference_tubes_read(const char* name, double radius)
{
  FILE* const file = name ? fopen(name, "rb") : NULL;
  float* points = NULL;
  size_t count = 0, room = 0;
  while (file)
  {
    if (count == room)
    {
      room = room ? 2 * room : 4096;
      float* const more = realloc(points, 3 * room * sizeof *points);
      if (!more)
      {
        count = 0;
        break;
      }
      points = more;
    }
    if (fread(points + 3 * count, 3 * sizeof *points, 1, file) != 1)
    {
      break;
    }
    ++count;
  }
  if (file)
  {
    fclose(file);
  }
  reference_tubes* const tubes = count ? reference_tubes_create(points, count, radius) : NULL;
  free(points);
  return tubes;
}

void reference_tubes_free(reference_tubes* t)
{
  if (t)
  {
    free(t->points);
    free(t->first);
    free(t->capsule);
    free(t);
  }
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int reference_tubes_contain(const void* tubes, const double at[3])
{
  const reference_tubes* const t = (const reference_tubes*)tubes;
  for (int k = 0; k < 3; ++k)
  {
    if (!(at[k] >= 0 && at[k] < N))
    {
      return 0;
    }
  }
  const size_t cell = (size_t)at[0] + N * ((size_t)at[1] + N * (size_t)at[2]);
  for (uint32_t i = t->first[cell]; i < t->first[cell + 1]; ++i)
  {
    double a[3], b[3], along[3], away[3];
    ends_of(t, t->capsule[i], a, b);
    for (int k = 0; k < 3; ++k)
    {
      along[k] = b[k] - a[k];
      away[k] = at[k] - a[k];
    }
    const double square = dot(along, along);
    const double part = square > 0 ? fmin(fmax(dot(away, along) / square, 0), 1) : 0;
    for (int k = 0; k < 3; ++k)
    {
      away[k] -= part * along[k];
    }
    if (dot(away, away) < t->radius * t->radius)
    {
      return 1;
    }
  }
  return 0;
}

/* Smallest z at which the line (x, y, *) meets the ball about c. */
static double ball_hit(const double c[3], double radius, double x, double y)
{
  const double dx = x - c[0], dy = y - c[1], rest = radius * radius - dx * dx - dy * dy;
  return rest >= 0 ? c[2] - sqrt(rest) : INFINITY;
}

/* Likewise the cylinder between a and b. */
static double cylinder_hit(const double a[3], const double b[3], double radius, double x, double y)
{
  /* |p - (p . w) w|^2 = r^2 for p = (x, y, z) - a: quadratic in z. */
  double w[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  const double length = sqrt(dot(w, w));
  if (!(length > 0))
  {
    return INFINITY;
  }
  for (int k = 0; k < 3; ++k)
  {
    w[k] /= length;
  }
  const double px = x - a[0], py = y - a[1], flat = px * w[0] + py * w[1];
  const double qa = 1 - w[2] * w[2], qb = -flat * w[2];
  const double qc = px * px + py * py - flat * flat - radius * radius;
  const double disc = qb * qb - qa * qc;
  if (!(qa > 1e-12) || disc < 0)
  {
    return INFINITY; /* along the line of sight its end's ball is in front */
  }
  const double z = (-qb - sqrt(disc)) / qa, place = flat + z * w[2];
  return place >= 0 && place <= length ? a[2] + z : INFINITY;
}

void reference_tubes_depth(const reference_tubes* t, const reference_view* view, float* depth)
{
  const chi_camera* const c = &view->camera;
  const double dx = (c->window[1] - c->window[0]) / c->width;
  const double dy = (c->window[3] - c->window[2]) / c->height;
  for (int i = 0; i < c->width * c->height; ++i)
  {
    depth[i] = INFINITY;
  }
  for (size_t i = 0; i + 1 < t->count; ++i)
  {
    double a[3], b[3];
    if (!ends_of(t, i, a, b))
    {
      continue;
    }
    const double left = fmin(a[0], b[0]) - t->radius - view->eye[0] - c->window[0];
    const double right = fmax(a[0], b[0]) + t->radius - view->eye[0] - c->window[0];
    const double low = fmin(a[1], b[1]) - t->radius - view->eye[1] - c->window[2];
    const double high = fmax(a[1], b[1]) + t->radius - view->eye[1] - c->window[2];
    for (int y = (int)fmax(low / dy, 0); y < c->height && y * dy <= high; ++y)
    {
      for (int x = (int)fmax(left / dx, 0); x < c->width && x * dx <= right; ++x)
      {
        const double px = view->eye[0] + c->window[0] + (x + 0.5) * dx;
        const double py = view->eye[1] + c->window[2] + (y + 0.5) * dy;
        const double z = fmin(cylinder_hit(a, b, t->radius, px, py),
          fmin(ball_hit(a, t->radius, px, py), ball_hit(b, t->radius, px, py)));
        float* const place = depth + x + c->width * y;
        *place = fminf(*place, (float)(z - view->eye[2]));
      }
    }
  }
}
