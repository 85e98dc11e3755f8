/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Geometry among light planes: in which slabs it blocks, and where it receives. */

#include "chi_light_planes.h"

#include <math.h>
#include <string.h>

double chi_light_receiver_plane(const chi_scene* s, double slices)
{
  return slices / (double)s->group - s->bias - 0.5;
}

/* The step that serves this depth: its plane rounded down, and 2; the number of slabs: none does.
 */
static int32_t serving_step(const chi_light_planes* l, float slices)
{
  const double plane = chi_light_receiver_plane(l->scene, (double)slices);
  if (plane < 0)
  {
    return plane >= -1;
  }
  return (int32_t)(plane < (double)(l->scene->slabs - 2) ? (int64_t)plane + 2 : l->scene->slabs);
}

static uint64_t* blocking_of(const chi_light_planes* l, int64_t by, int segment)
{
  return l->blocking + (size_t)(by * l->segments + segment) * (size_t)l->blocking_words;
}

/* Set the bits of the slabs of an interval. */
static void block_slabs(const chi_light_planes* l, float begin, float end, uint64_t* bits)
{
  const float last = (float)l->scene->slabs;
  const int64_t a = (int64_t)(begin < last ? begin : last) >> l->blocking_shift;
  const int64_t b = (int64_t)(end < last ? end : last) >> l->blocking_shift;
  for (int64_t word = a >> 6; word <= b >> 6; ++word)
  {
    const uint64_t from = word == a >> 6 ? ~(uint64_t)0 << (a & 63) : ~(uint64_t)0;
    const uint64_t to = word == b >> 6 ? ~(uint64_t)0 >> (63 - (b & 63)) : ~(uint64_t)0;
    bits[word] |= from & to;
  }
}

enum
{
  PIXELS = CHI_SEGMENT * 4, /* of a piece, at most */
  DIGIT = 8                 /* bits */
};
_Static_assert(PIXELS <= 256, "a pixel of a piece is a byte");

/* Sort pixels by their steps, which lie in [first, last]: by their digits, the lowest one first. */
static void sort_pixels(const int32_t* step, int32_t first, int32_t last, int count, uint8_t* order)
{
  uint8_t other[PIXELS], *from = order, *to = other;
  for (int shift = 0; shift < 31 && (last - first) >> shift; shift += DIGIT)
  {
    uint16_t place[(1 << DIGIT) + 1] = { 0 };
    for (int i = 0; i < count; ++i)
    {
      ++place[((step[from[i]] - first) >> shift & ((1 << DIGIT) - 1)) + 1];
    }
    for (int d = 0; d < 1 << DIGIT; ++d)
    {
      place[d + 1] = (uint16_t)(place[d + 1] + place[d]);
    }
    for (int i = 0; i < count; ++i)
    {
      to[place[(step[from[i]] - first) >> shift & ((1 << DIGIT) - 1)]++] = from[i];
    }
    uint8_t* const swap = from;
    from = to;
    to = swap;
  }
  if (from != order)
  {
    memcpy(order, from, (size_t)count);
  }
}

static uint8_t* order_of(const chi_light_planes* l, int64_t by, int segment)
{
  const size_t pixels = (size_t)(CHI_SEGMENT * l->scene->scale * l->scene->scale);
  return l->order + (size_t)(by * l->segments + segment) * pixels;
}

/* Where a pixel of a piece lies, by its number there. */
static void place_of(
  const chi_light_planes* l, int64_t by, int segment, int pixel, int64_t* x, int64_t* y)
{
  const int width = CHI_SEGMENT * l->scene->scale;
  *x = (int64_t)segment * width + pixel % width;
  *y = by * l->scene->scale + pixel / width;
}

static void find_next(const chi_light_planes* l, int64_t by, int segment, chi_light_served* served)
{
  if (served->next < served->count)
  {
    int64_t x, y;
    place_of(l, by, segment, order_of(l, by, segment)[served->next], &x, &y);
    served->plane = chi_light_receiver_plane(l->scene, (double)surface_row(l, RECEIVER, y)[x]);
  }
  else
  {
    served->plane = INFINITY;
  }
}

static void touch_piece(const chi_light_planes* l, int64_t by, int segment)
{
  const chi_scene* const s = l->scene;
  const int width = CHI_SEGMENT * s->scale;
  uint64_t* const bits = blocking_of(l, by, segment);
  uint8_t* const order = order_of(l, by, segment);
  int32_t step[PIXELS], first = INT32_MAX, end = -1, count = 0, last = -1;
  memset(bits, 0, (size_t)l->blocking_words * sizeof *bits);
  for (int row = 0; row < s->scale && by * s->scale + row < s->height; ++row)
  {
    const int64_t y = by * s->scale + row, x0 = (int64_t)segment * width;
    const float* const begin_row = surface_row(l, BLOCK_BEGIN, y) + x0;
    const float* const end_row = surface_row(l, BLOCK_END, y) + x0;
    const float* const depth = surface_row(l, RECEIVER, y) + x0;
    for (int i = 0; i < width && x0 + i < s->width; ++i)
    {
      if (begin_row[i] < INFINITY)
      {
        block_slabs(l, begin_row[i], end_row[i], bits);
      }
      if (!(depth[i] < INFINITY))
      {
        continue;
      }
      const int32_t at = serving_step(l, depth[i]);
      last = at > last ? at : last;
      if (at > 0 && at < s->slabs) /* what no step serves is lit already, or in the end */
      {
        order[count++] = (uint8_t)(row * width + i);
        step[row * width + i] = at;
        first = at < first ? at : first;
        end = at > end ? at : end;
      }
    }
  }
  if (count > 1)
  {
    sort_pixels(step, first, end, count, order);
  }
  chi_light_served* const served = l->served + by * l->segments + segment;
  *served = (chi_light_served){ .last = last, .count = count };
  find_next(l, by, segment, served);
}

void chi_light_touch_rows(void* data, size_t begin, size_t end)
{
  const chi_light_planes* const l = (const chi_light_planes*)data;
  for (size_t by = begin; by < end && !chi_is_cancelled(l->exec); ++by)
  {
    for (int segment = 0; segment < l->segments; ++segment)
    {
      touch_piece(l, (int64_t)by, segment);
    }
  }
}

int chi_light_serve(const chi_light_planes* l, int64_t step, int64_t by, int segment, int64_t* x,
  int64_t* y, double* plane)
{
  chi_light_served* const served = l->served + by * l->segments + segment;
  if (!(served->plane < (double)(step - 1))) /* serving_step */
  {
    return 0;
  }
  *plane = served->plane;
  place_of(l, by, segment, order_of(l, by, segment)[served->next], x, y);
  ++served->next;
  find_next(l, by, segment, served);
  return 1;
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
  const int64_t bit = slab >> l->blocking_shift;
  if (!l->surfaces || !(blocking_of(l, by, segment)[bit >> 6] >> (bit & 63) & 1))
  {
    return 0;
  }
  const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale, y0 = by * s->scale;
  if (l->params->geometry_opacity == 1 && y0 + s->scale <= s->height)
  {
    const float *begin[2], *end[2];
    for (int64_t k = 0; k < s->scale; ++k)
    {
      begin[k] = surface_row(l, BLOCK_BEGIN, y0 + k) + x0;
      end[k] = surface_row(l, BLOCK_END, y0 + k) + x0;
    }
    return l->kernels->block(begin, end, s->scale, (float)slab, out);
  }
  const int64_t left = s->width - x0, pixels = CHI_SEGMENT * s->scale;
  float blocked[2][2 * CHI_SEGMENT] = { { 0 } };
  for (int64_t k = 0; k < s->scale && y0 + k < s->height; ++k)
  {
    block_pixels(l, surface_row(l, BLOCK_BEGIN, y0 + k) + x0,
      surface_row(l, BLOCK_END, y0 + k) + x0, (float)slab, (int)(left < pixels ? left : pixels),
      blocked[k]);
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
