/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Geometry in the march, as blocker and as receiver of light; probes, which receive alike. */

#include "chi_occlusion_march.h"

#include <math.h>

/* Step of the march that can serve visibility at this depth: both planes about it are then
 * complete, with a row to spare on either side. */
double chi_march_receiver_plane(const chi_scene* s, double slices)
{
  return slices / (double)s->group - s->bias - 0.5;
}

/* The step that serves this depth: its plane rounded down, and 2; the number of slabs: none does.
 */
static int64_t serving_step(const march* m, float slices)
{
  const double plane = chi_march_receiver_plane(m->scene, (double)slices);
  if (plane < 0)
  {
    return plane >= -1;
  }
  return plane < (double)(m->scene->slabs - 2) ? (int64_t)plane + 2 : m->scene->slabs;
}

enum
{
  BLOCKS,
  SERVES
};

/* The bit of a slab. */
static int part_of(const march* m, int64_t slab)
{
  const int64_t last = m->scene->slabs;
  return (int)((slab < 0 ? 0 : slab < last ? slab : last) >> m->touched_shift);
}

static uint64_t parts_of(const march* m, float begin, float end)
{
  const float last = (float)m->scene->slabs;
  const int a = part_of(m, (int64_t)(begin < last ? begin : last));
  const int b = part_of(m, (int64_t)(end < last ? end : last));
  return (~(uint64_t)0 << a) & (~(uint64_t)0 >> (63 - b));
}

static int touches(const march* m, int kind, int64_t slab, int64_t by, int segment)
{
  return (int)(m->touched[by * m->segments + segment][kind] >> part_of(m, slab) & 1);
}

void chi_march_gather_touched(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const chi_scene* const s = m->scene;
  for (size_t by = begin; by < end && !chi_is_cancelled(m->exec); ++by)
  {
    for (int segment = 0; segment < m->segments; ++segment)
    {
      const size_t piece = by * (size_t)m->segments + (size_t)segment;
      uint64_t* const touched = m->touched[piece];
      touched[BLOCKS] = touched[SERVES] = 0;
      float farthest = -INFINITY;
      for (int64_t y = (int64_t)by * s->scale; y < (int64_t)(by + 1) * s->scale && y < s->height;
           ++y)
      {
        const float* const begin_row = picture(m, BLOCK_BEGIN, y);
        const float* const end_row = picture(m, BLOCK_END, y);
        const float* const depth = picture(m, RECEIVER, y);
        const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
        for (int64_t x = x0; x < x0 + CHI_SEGMENT * s->scale && x < s->width; ++x)
        {
          if (begin_row[x] < INFINITY)
          {
            touched[BLOCKS] |= parts_of(m, begin_row[x], end_row[x]);
          }
          if (depth[x] < INFINITY)
          {
            touched[SERVES] |= (uint64_t)1 << part_of(m, serving_step(m, depth[x]));
            farthest = depth[x] > farthest ? depth[x] : farthest;
          }
        }
      }
      m->last_served[piece] = farthest > -INFINITY ? serving_step(m, farthest) : -1;
    }
  }
}

/* Share of the light that one slab of a surface's interval blocks, so that all of them block the
 * geometry's opacity; the one of every slab where they never end (Algorithm 3). */
float chi_geometry_opacity(const chi_occlusion_params* params, float begin, float end)
{
  const float opacity = (float)params->geometry_opacity;
  const float slabs = floorf(end) - floorf(begin) + 1;
  return opacity == 1 || opacity == 0 || !(end < INFINITY) ? opacity
                                                           : 1 - powf(1 - opacity, 1 / slabs);
}

/* What each of a row's pixels blocks in a slab. */
static void block_pixels(
  const march* m, const float* begin, const float* end, float slab, int count, float* blocked)
{
  const float opacity = (float)m->frame->params->geometry_opacity;
  for (int i = 0; i < count; ++i)
  {
    blocked[i] = (begin[i] < slab + 1) & (end[i] >= slab) ? opacity : 0;
  }
  for (int i = 0; i < count && opacity != 1; ++i)
  {
    blocked[i] = blocked[i] > 0 ? chi_geometry_opacity(m->frame->params, begin[i], end[i]) : 0;
  }
}

/* Transmittance of the geometry in a slab, a segment of light pixels; 0 when nothing blocks. */
int chi_march_block_light(const march* m, int64_t slab, int64_t by, int segment, float* out)
{
  const chi_scene* const s = m->scene;
  if (!m->frame->surface || !touches(m, BLOCKS, slab, by, segment))
  {
    return 0;
  }
  const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
  const int64_t left = s->width - x0, pixels = CHI_SEGMENT * s->scale;
  float blocked[2][2 * CHI_SEGMENT] = { { 0 } };
  for (int64_t k = 0; k < s->scale && by * s->scale + k < s->height; ++k)
  {
    const int64_t y = by * s->scale + k;
    block_pixels(m, picture(m, BLOCK_BEGIN, y) + x0, picture(m, BLOCK_END, y) + x0, (float)slab,
      (int)(left < pixels ? left : pixels), blocked[k]);
  }
  int any = 0;
  for (int i = 0; i < CHI_SEGMENT; ++i)
  {
    out[i] = s->scale == 1 ? 1 - blocked[0][i]
                           : 1 -
        0.25f *
          (blocked[0][2 * i] + blocked[0][2 * i + 1] + blocked[1][2 * i] + blocked[1][2 * i + 1]);
    any |= out[i] < 1;
  }
  return any;
}

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
    const float* const from = visibility_row(m, f, slab, row);
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
    const float* const a = row_of_light(m, f, s->slabs & 1, j) + i +
      (s->published ? 0 : (ptrdiff_t)k * (ptrdiff_t)m->light_stride);
    const float* const b = a + m->light_row;
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
  return visibility_at(m, &m->keep->field[m->surface_field][channel],
    chi_march_receiver_plane(s, slices), to_light(s, (double)x + 0.5),
    to_light(s, (double)y + 0.5));
}

static void light_surface(const march* m, int64_t y, int64_t x)
{
  const double depth = (double)picture(m, RECEIVER, y)[x];
  for (int c = 0; c < m->scene->channels; ++c)
  {
    surface_visibility(m, c, y)[x] = (float)chi_march_visibility(m, c, depth, x, y);
  }
}

/* Surfaces of one light row whose planes are complete in this step. */
void chi_march_light_surfaces(const march* m, int64_t step, int64_t by)
{
  const chi_scene* const s = m->scene;
  /* Depths that this step may serve, by a margin of more than rounding: most pixels are others. */
  const double first = ((double)(step - 2) + s->bias + 0.5) * (double)s->group;
  const double margin = 1e-6 * (fabs(first) + (double)s->group);
  const float low = (float)(first - margin), high = (float)(first + (double)s->group + margin);
  for (int segment = 0; segment < m->segments; ++segment)
  {
    if (!touches(m, SERVES, step, by, segment))
    {
      continue;
    }
    const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
    for (int64_t y = by * s->scale; y < (by + 1) * s->scale && y < s->height; ++y)
    {
      const float* const depth = picture(m, RECEIVER, y);
      int any = 0;
      for (int64_t x = x0; x < x0 + CHI_SEGMENT * s->scale; ++x) /* rows are padded */
      {
        any |= (depth[x] >= low) & (depth[x] <= high);
      }
      for (int64_t x = x0; any && x < x0 + CHI_SEGMENT * s->scale && x < s->width; ++x)
      {
        const double plane = chi_march_receiver_plane(s, (double)depth[x]);
        if (plane >= (double)(step - 2) && plane < (double)(step - 1)) /* serving_step */
        {
          light_surface(m, y, x);
        }
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
  m->frame->probes->visibility[i] = (float)visibility_at(m, &m->keep->field[0][0],
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
    const float* const depth = picture(m, RECEIVER, (int64_t)y);
    for (int64_t x = 0; x < s->width; ++x)
    {
      if (depth[x] < INFINITY &&
        chi_march_receiver_plane(s, (double)depth[x]) >= (double)(s->slabs - 2))
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
