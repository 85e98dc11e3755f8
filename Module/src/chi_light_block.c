/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Geometry among light planes: in which slabs it blocks, and where it receives. */

#include "chi_light_planes.h"

#include <math.h>

double chi_light_receiver_plane(const chi_scene* s, double slices)
{
  return slices / (double)s->group - s->bias - 0.5;
}

/* The step that serves this depth: its plane rounded down, and 2; the number of slabs: none does.
 */
static int64_t serving_step(const chi_light_planes* l, float slices)
{
  const double plane = chi_light_receiver_plane(l->scene, (double)slices);
  if (plane < 0)
  {
    return plane >= -1;
  }
  return plane < (double)(l->scene->slabs - 2) ? (int64_t)plane + 2 : l->scene->slabs;
}

enum
{
  BLOCKS,
  SERVES
};

/* The bit of a slab. */
static int part_of(const chi_light_planes* l, int64_t slab)
{
  const int64_t last = l->scene->slabs;
  return (int)((slab < 0 ? 0 : slab < last ? slab : last) >> l->touched_shift);
}

static uint64_t parts_of(const chi_light_planes* l, float begin, float end)
{
  const float last = (float)l->scene->slabs;
  const int a = part_of(l, (int64_t)(begin < last ? begin : last));
  const int b = part_of(l, (int64_t)(end < last ? end : last));
  return (~(uint64_t)0 << a) & (~(uint64_t)0 >> (63 - b));
}

static int touches(const chi_light_planes* l, int kind, int64_t slab, int64_t by, int segment)
{
  return (int)(l->touched[by * l->segments + segment][kind] >> part_of(l, slab) & 1);
}

void chi_light_touch_rows(void* data, size_t begin, size_t end)
{
  const chi_light_planes* const l = (const chi_light_planes*)data;
  const chi_scene* const s = l->scene;
  for (size_t by = begin; by < end && !chi_is_cancelled(l->exec); ++by)
  {
    for (int segment = 0; segment < l->segments; ++segment)
    {
      const size_t piece = by * (size_t)l->segments + (size_t)segment;
      uint64_t* const touched = l->touched[piece];
      touched[BLOCKS] = touched[SERVES] = 0;
      float farthest = -INFINITY;
      for (int64_t y = (int64_t)by * s->scale; y < (int64_t)(by + 1) * s->scale && y < s->height;
           ++y)
      {
        const float* const begin_row = surface_row(l, BLOCK_BEGIN, y);
        const float* const end_row = surface_row(l, BLOCK_END, y);
        const float* const depth = surface_row(l, RECEIVER, y);
        const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
        for (int64_t x = x0; x < x0 + CHI_SEGMENT * s->scale && x < s->width; ++x)
        {
          if (begin_row[x] < INFINITY)
          {
            touched[BLOCKS] |= parts_of(l, begin_row[x], end_row[x]);
          }
          if (depth[x] < INFINITY)
          {
            touched[SERVES] |= (uint64_t)1 << part_of(l, serving_step(l, depth[x]));
            farthest = depth[x] > farthest ? depth[x] : farthest;
          }
        }
      }
      l->last_served[piece] = farthest > -INFINITY ? serving_step(l, farthest) : -1;
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
static void block_pixels(const chi_light_planes* l, const float* begin, const float* end,
  float slab, int count, float* blocked)
{
  const float opacity = (float)l->params->geometry_opacity;
  for (int i = 0; i < count; ++i)
  {
    blocked[i] = (begin[i] < slab + 1) & (end[i] >= slab) ? opacity : 0;
  }
  for (int i = 0; i < count && opacity != 1; ++i)
  {
    blocked[i] = blocked[i] > 0 ? chi_geometry_opacity(l->params, begin[i], end[i]) : 0;
  }
}

/* Transmittance of the geometry in a slab, a segment of light pixels; 0 when nothing blocks. */
int chi_light_block(const chi_light_planes* l, int64_t slab, int64_t by, int segment, float* out)
{
  const chi_scene* const s = l->scene;
  if (!l->surfaces || !touches(l, BLOCKS, slab, by, segment))
  {
    return 0;
  }
  const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
  const int64_t left = s->width - x0, pixels = CHI_SEGMENT * s->scale;
  float blocked[2][2 * CHI_SEGMENT] = { { 0 } };
  for (int64_t k = 0; k < s->scale && by * s->scale + k < s->height; ++k)
  {
    const int64_t y = by * s->scale + k;
    block_pixels(l, surface_row(l, BLOCK_BEGIN, y) + x0, surface_row(l, BLOCK_END, y) + x0,
      (float)slab, (int)(left < pixels ? left : pixels), blocked[k]);
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

int chi_light_serves(const chi_light_planes* l, int64_t step, int64_t by, int segment)
{
  return touches(l, SERVES, step, by, segment);
}
