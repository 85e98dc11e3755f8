/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Light of one band of rows through one slab. */

#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

/* What light there is where a piece's comes from; outside the picture it is bright. */
static int state_of_source(
  const march* m, const chi_light_field* f, int64_t side, int64_t y, int segment)
{
  const int64_t height = m->scene->light_height;
  const int64_t low = y > m->skew ? y - m->skew : 0;
  const int64_t high = y + m->skew < height ? y + m->skew : height - 1;
  const int first = segment > m->shift_segments ? segment - m->shift_segments : 0;
  const int last =
    segment + m->shift_segments < m->segments ? segment + m->shift_segments : m->segments - 1;
  const int inside = y - m->skew >= 0 && y + m->skew < height && segment - m->shift_segments >= 0 &&
    segment + m->shift_segments < m->segments;
  int state = inside ? 0 : TILE_BRIGHT;
  for (int64_t j = low; j <= high && state != TILE_MIXED; ++j)
  {
    const uint8_t* const flags = tile_row(m, f, side, j);
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
static void repeat_ends(const march* m, int k, float* seen)
{
  if (k == 0)
  {
    seen[-1] = seen[0];
  }
  if (k == m->segments - 1)
  {
    const int end = m->scene->light_width - k * CHI_SEGMENT;
    seen[end] = seen[end - 1];
  }
}

static void light_piece(march* m, chi_light_field* f, float factor, int64_t slab, int64_t y, int k,
  int needed, light_counts* counts)
{
  const chi_scene* const s = m->scene;
  const int64_t read = slab & 1, write = read ^ 1;
  const int x = k * CHI_SEGMENT;
  uint8_t* const target_tile = tile_row(m, f, write, y) + k;
  uint8_t* const seen_tile = tile_row(m, f, 2 + ring_slot(m, slab), y) + k;
  const int planes = s->published ? 1 : s->directions;
  const int64_t cost = (int64_t)s->directions * CHI_SEGMENT;
  float* const target = row_of_light(m, f, write, y) + x;
  float* const seen = visibility_row(m, f, slab, y) + x;
  float* const geometry = light_scratch(m, GEOMETRY, y) + x;
  if (!needed)
  {
    counts->unreached += cost;
    *target_tile = *seen_tile = TILE_MIXED; /* unknown, and nobody asks */
    return;
  }
  const int skips = m->skip & CHI_SKIP_SATURATED_LIGHT;
  const int source = skips ? state_of_source(m, f, read, y, k) : TILE_MIXED;
  const int has_tau = f->volume && factor > 0 && m->tau_flag[y * m->segments + k];
  const int blocked =
    f->geometry && source != TILE_DARK && chi_march_block_light(m, slab, y, k, geometry);
  /* What is dark stays dark; what is bright does where nothing stands in the way. */
  if (source == TILE_DARK || (source == TILE_BRIGHT && !has_tau && !blocked))
  {
    counts->uniform += cost;
    if (*target_tile != source)
    {
      fill_tile(target, m->light_stride, planes, source);
    }
    if (*seen_tile != source)
    {
      fill_tile(seen, m->light_stride, 1, source);
      repeat_ends(m, k, seen);
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
    m->kernels->path_lengths(s->published ? axis : s->tangent[0],
      s->published ? axis + 1 : s->tangent[1], planes, (float)(s->slope_x + center * s->slope_dx),
      (float)(s->slope_y + row * s->slope_dy), (float)(s->slope_dx * s->scale), inside, length,
      length_x);
  }
  const float* const tau = s->scale == 1 ? tau_row(m, slab, y) : light_scratch(m, LIGHT_TAU, y);
  const chi_light_segment segment = { .source = row_of_light(m, f, read, y) + x,
    .target = target,
    .plane = m->light_stride,
    .offset = m->step_offset + slab * s->directions,
    .weight = (const float(*)[4])m->step_weight + slab * s->directions,
    .stride = m->light_row,
    .directions = s->directions,
    .share = s->weighted ? s->weight : NULL,
    .factor = factor,
    .tau = has_tau ? tau + x : NULL,
    .length = length,
    .length_x = length_x,
    .geometry = blocked ? geometry : NULL,
    .visibility = seen,
    .dark_below = m->dark_below };
  const int dark = (s->published ? m->kernels->blur : m->kernels->light)(&segment);
  repeat_ends(m, k, seen);
  *target_tile = *seen_tile = TILE_MIXED;
  if (inside < CHI_SEGMENT)
  {
    /* Beyond the rim all light arrives: neither what lies there, which the other rims do not know,
     * nor what has left the picture may come back. */
    for (int d = 0; d < planes; ++d)
    {
      chi_fill_ones(target + (size_t)d * m->light_stride + inside, CHI_SEGMENT - inside);
    }
  }
  else if (skips && dark)
  {
    fill_tile(target, m->light_stride, planes, TILE_DARK);
    *target_tile = TILE_DARK;
  }
  counts->updates += cost;
}

/* The thickness of light pixels where the picture has four for each: that which gives light of this
 * factor the mean transmittance. */
static void halve_piece(march* m, int64_t slab, const int64_t rows[2], int k, float factor)
{
  const int x = k * CHI_SEGMENT;
  for (int64_t y = rows[0]; y < rows[1] && m->scene->scale == 2 && factor > 0; ++y)
  {
    if (m->tau_flag[y * m->segments + k])
    {
      const float* const tau[2] = { tau_row(m, slab, 2 * y) + 2 * x,
        tau_row(m, slab, 2 * y + 1) + 2 * x };
      const float* const before[2] = { tau_row(m, slab - 1, 2 * y) + 2 * x,
        tau_row(m, slab - 1, 2 * y + 1) + 2 * x };
      m->kernels->halve(tau, before, m->scene->mean_length * factor,
        light_scratch(m, LIGHT_TAU, y) + x, CHI_SEGMENT);
    }
  }
}

/* One slab's light for a band of rows; piece by piece, so that the rows of a piece, which share
 * most of what they read, follow each other while it is in the nearest cache. */
void chi_march_light_band(
  march* m, int64_t slab, const int64_t rows[2], const uint8_t* need, light_counts* counts)
{
  for (int k = 0; k < m->segments; ++k)
  {
    for (int c = 0; c < m->scene->channels; ++c)
    {
      const float factor = m->scene->factor[c];
      halve_piece(m, slab, rows, k, factor);
      for (int f = 0; f < m->fields; ++f)
      {
        for (int64_t y = rows[0]; y < rows[1]; ++y)
        {
          light_piece(m, &m->keep->field[f][c], factor, slab, y, k, need[k], counts);
        }
      }
    }
  }
  for (int64_t y = rows[0]; y < rows[1] && m->frame->surface; ++y)
  {
    chi_march_light_surfaces(m, slab, y);
  }
  for (int64_t y = rows[0]; y < rows[1] && m->layers; ++y)
  {
    chi_layers_light(m, slab, y);
  }
  chi_march_read_probes(m, slab, rows[0], rows[1]);
}
