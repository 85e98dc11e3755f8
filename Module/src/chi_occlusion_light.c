/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Light of one band of rows through one slab. */

#include "chi_light_planes.h"

#include <math.h>
#include <string.h>

/* What light there is where a piece's comes from; outside the picture it is bright. */
static int state_of_source(
  const chi_light_planes* l, const chi_light_field* f, int64_t side, int64_t y, int segment)
{
  if (tile_row(l, f, side, y)[segment] == TILE_MIXED)
  {
    return TILE_MIXED;
  }
  const int64_t height = l->scene->light_height;
  const int64_t low = y > l->skew ? y - l->skew : 0;
  const int64_t high = y + l->skew < height ? y + l->skew : height - 1;
  const int first = segment > l->shift_segments ? segment - l->shift_segments : 0;
  const int last =
    segment + l->shift_segments < l->segments ? segment + l->shift_segments : l->segments - 1;
  const int inside = y - l->skew >= 0 && y + l->skew < height && segment - l->shift_segments >= 0 &&
    segment + l->shift_segments < l->segments;
  int state = inside ? 0 : TILE_BRIGHT;
  for (int64_t j = low; j <= high && state != TILE_MIXED; ++j)
  {
    const uint8_t* const flags = tile_row(l, f, side, j);
    for (int k = first; k <= last; ++k)
    {
      state |= flags[k];
    }
  }
  return state;
}

static void fill_tile(float* out, size_t stride, int planes, int state)
{
  for (int d = 0; d < planes; ++d, out += stride)
  {
    if (state == TILE_BRIGHT)
    {
      chi_fill_ones(out, CHI_SEGMENT);
    }
    else
    {
      memset(out, 0, CHI_SEGMENT * sizeof(float));
    }
  }
}

/* The enlargement reads one pixel beyond the picture on either side. */
static void repeat_ends(const chi_light_planes* l, int k, float* seen)
{
  if (k == 0)
  {
    seen[-1] = seen[0];
  }
  if (k == l->segments - 1)
  {
    const int end = l->scene->light_width - k * CHI_SEGMENT;
    seen[end] = seen[end - 1];
  }
}

static void light_piece(const chi_light_planes* l, const chi_light_field* f, float factor,
  int64_t slab, int64_t y, int k, int needed, light_counts* counts)
{
  const chi_scene* const s = l->scene;
  const int64_t read = slab & 1, write = read ^ 1;
  const int x = k * CHI_SEGMENT;
  uint8_t* const target_tile = tile_row(l, f, write, y) + k;
  uint8_t* const seen_tile = tile_row(l, f, 2 + ring_slot(l, slab), y) + k;
  const int planes = s->published ? 1 : s->directions;
  const int64_t cost = (int64_t)s->directions * CHI_SEGMENT;
  float* const target = row_of_light(l, f, write, y) + x;
  float* const seen = visibility_row(l, f, slab, y) + x;
  float* const geometry = light_scratch(l, GEOMETRY, y) + x;
  if (!needed)
  {
    counts->unreached += cost;
    *target_tile = *seen_tile = TILE_MIXED; /* unknown, and nobody asks */
    return;
  }
  const int skips = l->skip & CHI_SKIP_SATURATED_LIGHT;
  const int source = skips ? state_of_source(l, f, read, y, k) : TILE_MIXED;
  const int has_tau = f->volume && factor > 0 && l->tau_flag[y * l->segments + k];
  const int blocked =
    f->geometry && source != TILE_DARK && chi_light_block(l, slab, y, k, geometry);
  /* What is dark stays dark; what is bright does where nothing stands in the way. */
  if (source == TILE_DARK || (source == TILE_BRIGHT && !has_tau && !blocked))
  {
    counts->uniform += cost;
    if (*target_tile != source)
    {
      fill_tile(target, l->light_stride, planes, source);
    }
    if (*seen_tile != source)
    {
      fill_tile(seen, l->light_stride, 1, source);
      repeat_ends(l, k, seen);
    }
    *target_tile = *seen_tile = (uint8_t)source;
    return;
  }
  const int left = s->light_width - x, inside = left < CHI_SEGMENT ? left : CHI_SEGMENT;
  float length[CHI_MAX_ORDINATES], length_x[CHI_MAX_ORDINATES];
  if (has_tau)
  {
    const float axis[2] = { (float)s->light[0].slope[0], (float)s->light[0].slope[1] };
    const double center = (x + 0.5) * s->scale - 0.5, row = ((double)y + 0.5) * s->scale - 0.5;
    l->kernels->path_lengths(s->published ? axis : s->tangent[0],
      s->published ? axis + 1 : s->tangent[1], planes, (float)(s->slope_x + center * s->slope_dx),
      (float)(s->slope_y + row * s->slope_dy), (float)(s->slope_dx * s->scale), inside, length,
      length_x);
  }
  const float* const tau = s->scale == 1 ? tau_row(l, slab, y) : light_scratch(l, LIGHT_TAU, y);
  const chi_light_segment segment = { .source = row_of_light(l, f, read, y) + x,
    .target = target,
    .plane = l->light_stride,
    .offset = l->step_offset + slab * s->directions,
    .weight = (const float(*)[4])l->step_weight + slab * s->directions,
    .stride = l->light_row,
    .directions = s->directions,
    .share = s->weighted ? s->weight : NULL,
    .factor = factor,
    .tau = has_tau ? tau + x : NULL,
    .length = length,
    .length_x = length_x,
    .geometry = blocked ? geometry : NULL,
    .visibility = seen,
    .dark_below = l->dark_below,
    .bright_above = 1 - CHI_LIGHT_LOSS };
  const int all = (s->published ? l->kernels->blur : l->kernels->light)(&segment);
  repeat_ends(l, k, seen);
  /* What linear weights spread of a shadow that goes by, and their rounding, never ends. Where
   * matter takes light, however little, it adds up. */
  const int bright = skips && (all & CHI_LIGHT_BRIGHT) && !has_tau && !blocked;
  *target_tile = *seen_tile = bright ? TILE_BRIGHT : TILE_MIXED;
  if (bright)
  {
    fill_tile(target, l->light_stride, planes, TILE_BRIGHT);
  }
  else if (inside < CHI_SEGMENT)
  {
    /* Beyond the rim all light arrives: neither what lies there, which the other rims do not know,
     * nor what has left the picture may come back. */
    for (int d = 0; d < planes; ++d)
    {
      chi_fill_ones(target + (size_t)d * l->light_stride + inside, CHI_SEGMENT - inside);
    }
  }
  else if (skips && (all & CHI_LIGHT_DARK))
  {
    fill_tile(target, l->light_stride, planes, TILE_DARK);
    *target_tile = TILE_DARK;
  }
  counts->updates += cost;
}

/* The thickness of light pixels where the picture has four for each: that which gives light of this
 * factor the mean transmittance. */
static void halve_piece(
  const chi_light_planes* l, int64_t slab, const int64_t rows[2], int k, float factor)
{
  const int x = k * CHI_SEGMENT;
  for (int64_t y = rows[0]; y < rows[1] && l->scene->scale == 2 && factor > 0; ++y)
  {
    if (l->tau_flag[y * l->segments + k])
    {
      const float* const tau[2] = { tau_row(l, slab, 2 * y) + 2 * x,
        tau_row(l, slab, 2 * y + 1) + 2 * x };
      const float* const before[2] = { tau_row(l, slab - 1, 2 * y) + 2 * x,
        tau_row(l, slab - 1, 2 * y + 1) + 2 * x };
      l->kernels->halve(tau, before, l->scene->mean_length * factor,
        light_scratch(l, LIGHT_TAU, y) + x, CHI_SEGMENT);
    }
  }
}

/* Piece by piece, so that the rows of a piece, which share most of what they read, follow each
 * other while it is in the nearest cache. */
void chi_light_band(const chi_light_planes* l, int64_t slab, const int64_t rows[2],
  const uint8_t* need, light_counts* counts)
{
  for (int k = 0; k < l->segments; ++k)
  {
    for (int c = 0; c < l->scene->channels; ++c)
    {
      const float factor = l->scene->factor[c];
      halve_piece(l, slab, rows, k, factor);
      for (int f = 0; f < l->fields; ++f)
      {
        for (int64_t y = rows[0]; y < rows[1]; ++y)
        {
          light_piece(l, &l->field[f][c], factor, slab, y, k, need[k], counts);
        }
      }
    }
  }
}

const float* chi_light_read_row(const chi_light_planes* l, const chi_light_field* f, double plane,
  float strength, int64_t y, int x_begin, int x_end, float* out)
{
  const chi_scene* const s = l->scene;
  if (plane <= -1)
  {
    return NULL;
  }
  const int64_t first = (int64_t)floor(plane);
  const float w = (float)(plane - (double)first);
  int64_t rows[3] = { y, y, y };
  double share[3] = { 1, 0, 0 };
  const int row_count = s->scale == 2 ? 3 : 1;
  if (s->scale == 2)
  {
    chi_light_weights(2, y & 1 ? 0.25 : -0.25, share);
    for (int k = 0; k < 3; ++k)
    {
      const int64_t row = (y >> 1) + k - 1;
      rows[k] = row < 0 ? 0 : row < s->light_height ? row : s->light_height - 1;
    }
  }
  const int seg0 = x_begin / s->scale / CHI_SEGMENT;
  int seg1 = (x_end - 1) / s->scale / CHI_SEGMENT + 1; /* one more: the right neighbour is read */
  seg1 = seg1 < l->segments ? seg1 : l->segments - 1;
  const float* source[6];
  float weight[6], base = 1 - strength;
  int state = TILE_BRIGHT, count = 0;
  for (int k = 0; k < 2 * row_count; ++k)
  {
    const int64_t i = first + k / row_count, row = rows[k % row_count];
    const float part = strength * (k < row_count ? 1 - w : w) * (float)share[k % row_count];
    if (i < 0)
    {
      base += part; /* before the first plane all light arrives */
      continue;
    }
    if (part == 0)
    {
      continue;
    }
    source[count] = visibility_row(l, f, i, row);
    weight[count++] = part;
    const uint8_t* const flags = tile_row(l, f, 2 + ring_slot(l, i), row);
    for (int segment = seg0 > 0 ? seg0 - 1 : 0; segment <= seg1 && state != TILE_MIXED; ++segment)
    {
      state |= flags[segment];
    }
  }
  if (state == TILE_BRIGHT)
  {
    return NULL;
  }
  l->kernels->enlarge(source, weight, count, base, s->scale, x_begin, x_end, out);
  return out;
}
