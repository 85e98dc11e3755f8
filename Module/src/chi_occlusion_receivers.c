/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Geometry in the march, as blocker and as receiver of light; probes, which receive alike. */

#include "chi_occlusion_march.h"

#include <math.h>

/* Mean visibility at a place of a light plane, bilinear; x and y in light pixels from a centre. */
static double plane_at(const march* m, const chi_light_field* f, int64_t slab, double x, double y)
{
  if (slab < 0)
  {
    return 1;
  }
  const chi_scene* const s = m->scene;
  x = fmin(fmax(x, 0), s->light_width - 1);
  y = fmin(fmax(y, 0), s->light_height - 1);
  /* The three light pixels about the nearest one a side; see chi_light_weights. */
  const int64_t i = (int64_t)(x + 0.5), j = (int64_t)(y + 0.5);
  double u[3], v[3], sum = 0;
  chi_light_weights(s->scale, x - (double)i, u);
  chi_light_weights(s->scale, y - (double)j, v);
  for (int64_t b = -1; b <= 1; ++b)
  {
    const int64_t row = j + b < 0 ? 0 : j + b < s->light_height ? j + b : s->light_height - 1;
    const float* const from = visibility_row(&m->light, f, slab, row);
    for (int64_t a = -1; a <= 1; ++a)
    {
      const int64_t at = i + a < 0 ? 0 : i + a < s->light_width ? i + a : s->light_width - 1;
      sum += v[b + 1] * u[a + 1] * (double)from[at];
    }
  }
  return fmin(fmax(sum, 0), 1);
}

/* Behind the last plane: every direction at the offset that is left, in one step. */
static double beyond_last_plane(
  const march* m, const chi_light_field* f, double plane, double x, double y)
{
  const chi_scene* const s = m->scene;
  const double shift =
    chi_scene_shift(s, chi_scene_depth(s, (double)s->slabs - 0.5), chi_scene_depth(s, plane + 0.5));
  double sum = 0;
  for (int k = 0; k < s->directions; ++k)
  {
    const double px = x + (double)s->tangent[0][k] * s->pixels_x * shift;
    const double py = y + (double)s->tangent[1][k] * s->pixels_y * shift;
    const double weight = s->weighted ? (double)s->weight[k] : 1;
    if (!(px > -1 && py > -1 && px < s->light_width && py < s->light_height))
    {
      sum += weight; /* from outside the picture */
      continue;
    }
    const int64_t i = (int64_t)floor(px), j = (int64_t)floor(py);
    const double u = px - (double)i, v = py - (double)j;
    const float* const a = row_of_light(&m->light, f, s->slabs & 1, j) + i +
      (s->published ? 0 : (ptrdiff_t)k * (ptrdiff_t)m->light.light_stride);
    const float* const b = a + m->light.light_row;
    sum += weight *
      ((1 - v) * ((1 - u) * (double)a[0] + u * (double)a[1]) +
        v * ((1 - u) * (double)b[0] + u * (double)b[1]));
  }
  return s->weighted ? fmin(sum, 1) : sum / s->directions; /* the weights are floats */
}

/* Visibility between planes at `plane`, before strength. */
static double visibility_at(
  const march* m, const chi_light_field* f, double plane, double x, double y)
{
  if (!(f->volume || f->geometry) || m->scene->slabs == 0 || plane <= -1)
  {
    return 1;
  }
  if (plane > (double)(m->scene->slabs - 1))
  {
    return beyond_last_plane(m, f, plane, x, y);
  }
  const double below = floor(plane), w = plane - below;
  const int64_t i = (int64_t)below;
  const double a = plane_at(m, f, i, x, y);
  return w > 0 ? (1 - w) * a + w * plane_at(m, f, i + 1, x, y) : a;
}

static double to_light(const chi_scene* s, double pixel)
{
  return pixel / s->scale - 0.5;
}

/* What geometry at this depth of a pixel receives, before strength. */
double chi_march_visibility(const march* m, int channel, double slices, int64_t x, int64_t y)
{
  const chi_scene* const s = m->scene;
  return visibility_at(m, &m->light.field[m->surface_field][channel],
    chi_light_receiver_plane(s, slices), to_light(s, (double)x + 0.5),
    to_light(s, (double)y + 0.5));
}

static void light_surface(const march* m, int64_t y, int64_t x)
{
  const double depth = (double)surface_row(&m->light, RECEIVER, y)[x];
  for (int c = 0; c < m->scene->channels; ++c)
  {
    surface_visibility(m, c, y)[x] = (float)chi_march_visibility(m, c, depth, x, y);
  }
}

/* The weights of plane_at for pixels of even and odd place, whose light pixels all lie inside. */
void chi_march_place_weights(int scale, double weight[2][2][9])
{
  for (int k = 0; k < 4; ++k)
  {
    double u[3], v[3];
    chi_light_weights(scale, scale == 1 ? 0 : k & 1 ? 0.25 : -0.25, u);
    chi_light_weights(scale, scale == 1 ? 0 : k & 2 ? 0.25 : -0.25, v);
    for (int i = 0; i < 9; ++i)
    {
      weight[k >> 1][k & 1][i] = v[i / 3] * u[i % 3];
    }
  }
}

/* plane_at at light pixel (i, j), with its weights. */
static double plane_inside(const march* m, const chi_light_field* f, int64_t slab, int64_t i,
  int64_t j, const double weight[9])
{
  if (slab < 0)
  {
    return 1;
  }
  const float* const from = visibility_row(&m->light, f, slab, j) + i;
  const ptrdiff_t stride = (ptrdiff_t)m->light.light_stride;
  double sum = 0;
  for (int b = 0; b < 3; ++b)
  {
    for (int a = 0; a < 3; ++a)
    {
      sum += weight[3 * b + a] * (double)from[(b - 1) * stride + a - 1];
    }
  }
  return fmin(fmax(sum, 0), 1);
}

/* light_surface of a pixel between two planes, one or more light pixels from the picture's rim: the
 * same bits. */
static void light_inside(const march* m, double plane, int64_t y, int64_t x, const double weight[9])
{
  const chi_scene* const s = m->scene;
  const double below = floor(plane), w = plane - below;
  for (int c = 0; c < s->channels; ++c)
  {
    const chi_light_field* const f = &m->light.field[m->surface_field][c];
    double seen = 1;
    if (f->volume || f->geometry)
    {
      const int64_t slab = (int64_t)below, i = x / s->scale, j = y / s->scale;
      seen = plane_inside(m, f, slab, i, j, weight);
      seen = w > 0 ? (1 - w) * seen + w * plane_inside(m, f, slab + 1, i, j, weight) : seen;
    }
    surface_visibility(m, c, y)[x] = (float)seen;
  }
}

/* Surfaces of one light row whose planes are complete in this step. */
void chi_march_light_surfaces(const march* m, int64_t step, int64_t by)
{
  const chi_scene* const s = m->scene;
  const int inside_y = by > 0 && by < s->light_height - 1;
  int64_t x, y;
  double plane;
  for (int segment = 0; segment < m->light.segments; ++segment)
  {
    while (chi_light_serve(&m->light, step, by, segment, &x, &y, &plane))
    {
      const int64_t i = x / s->scale;
      if (inside_y && i > 0 && i < s->light_width - 1)
      {
        light_inside(m, plane, y, x, m->receiver_weight[y % s->scale][x % s->scale]);
      }
      else
      {
        light_surface(m, y, x);
      }
    }
  }
}

static double probe_plane(const march* m, size_t i)
{
  const chi_scene* const s = m->scene;
  return (m->frame->probes->position[3 * i + 2] - s->start) / s->slab - s->bias - 0.5;
}

static void read_probe(const march* m, size_t i)
{
  const double* const p = m->frame->probes->position + 3 * i;
  m->frame->probes->visibility[i] = (float)visibility_at(m, &m->light.field[0][0],
    probe_plane(m, i), to_light(m->scene, p[0]), to_light(m->scene, p[1]));
}

/* Probes of rows [begin, end) that this step completes. */
void chi_march_read_probes(const march* m, int64_t step, int64_t begin, int64_t end)
{
  const chi_occlusion_probes* const probes = m->frame->probes;
  for (size_t i = 0; probes && i < probes->count; ++i)
  {
    const double row = floor(probes->position[3 * i + 1] / m->scene->scale);
    const double top = (double)m->scene->light_height - 1;
    const double y = row < 0 ? 0 : row > top ? top : row;
    if (y >= (double)begin && y < (double)end && floor(probe_plane(m, i)) + 2 == (double)step)
    {
      read_probe(m, i);
    }
  }
}

/* What no step of the march could serve: surfaces and probes at the last plane and behind it. */
void chi_march_light_rest(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const chi_scene* const s = m->scene;
  for (size_t y = begin; y < end && !chi_is_cancelled(m->exec); ++y)
  {
    const float* const depth = surface_row(&m->light, RECEIVER, (int64_t)y);
    for (int64_t x = 0; x < s->width; ++x)
    {
      if (depth[x] < INFINITY &&
        chi_light_receiver_plane(s, (double)depth[x]) >= (double)(s->slabs - 2))
      {
        light_surface(m, (int64_t)y, x);
      }
    }
  }
}

void chi_march_read_last_probes(const march* m)
{
  const chi_occlusion_probes* const probes = m->frame->probes;
  for (size_t i = 0; probes && i < probes->count; ++i)
  {
    const double plane = probe_plane(m, i);
    if (!isfinite(plane) || !isfinite(probes->position[3 * i]) ||
      !isfinite(probes->position[3 * i + 1]))
    {
      probes->visibility[i] = NAN;
    }
    else if (plane <= -1 || floor(plane) + 2 >= (double)m->scene->slabs)
    {
      read_probe(m, i);
    }
  }
}
