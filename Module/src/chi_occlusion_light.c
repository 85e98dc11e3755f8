/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Light of one band of rows through one slab. */

#include "chi_occlusion_march.h"

#include <math.h>

static int source_is_dirty(
  const march* m, const chi_light_field* f, int64_t side, int64_t y, int segment)
{
  const int64_t low = y > m->skew ? y - m->skew : 0;
  const int64_t high =
    y + m->skew < m->scene->light_height ? y + m->skew : m->scene->light_height - 1;
  const int first = segment > m->shift_segments ? segment - m->shift_segments : 0;
  const int last =
    segment + m->shift_segments < m->segments ? segment + m->shift_segments : m->segments - 1;
  int dirty = 0;
  for (int64_t j = low; j <= high; ++j)
  {
    const uint8_t* const flags = dirty_row(m, f, side, j);
    for (int k = first; k <= last; ++k)
    {
      dirty |= flags[k];
    }
  }
  return dirty;
}

static void light_piece(march* m, chi_light_field* f, float factor, int64_t slab, int64_t y, int k,
  int needed, light_counts* counts)
{
  const chi_scene* const s = m->scene;
  const int64_t read = slab & 1, write = read ^ 1;
  const int x = k * CHI_SEGMENT;
  uint8_t* const target_dirty = dirty_row(m, f, write, y) + k;
  uint8_t* const seen_dirty = dirty_row(m, f, 2 + ring_slot(m, slab), y) + k;
  const int planes = s->published ? 1 : s->directions;
  const int64_t cost = (int64_t)s->directions * CHI_SEGMENT;
  float* const target = row_of_light(m, f, write, y) + x;
  float* const seen = visibility_row(m, f, slab, y) + x;
  float* const geometry = light_scratch(m, GEOMETRY, y) + x;
  if (!needed)
  {
    counts->unreached += cost;
    *target_dirty = *seen_dirty = 1; /* unknown, and nobody asks */
    return;
  }
  const int has_tau = f->volume && factor > 0 && m->tau_flag[y * m->segments + k];
  const int blocked = f->geometry && chi_march_block_light(m, slab, y, k, geometry);
  if ((m->skip & CHI_SKIP_SATURATED_LIGHT) && !has_tau && !blocked &&
    !source_is_dirty(m, f, read, y, k))
  {
    counts->uniform += cost;
    for (int d = 0; d < planes && *target_dirty; ++d)
    {
      chi_fill_ones(target + (size_t)d * m->light_stride, CHI_SEGMENT);
    }
    *target_dirty = 0;
    if (*seen_dirty)
    {
      chi_fill_ones(seen - (k == 0), CHI_SEGMENT + (k == 0));
      *seen_dirty = 0;
    }
    return;
  }
  float length[CHI_MAX_ORDINATES], length_x[CHI_MAX_ORDINATES];
  if (has_tau)
  {
    const float axis[2] = { (float)s->light[0].slope[0], (float)s->light[0].slope[1] };
    const double center = (x + 0.5) * s->scale - 0.5, row = ((double)y + 0.5) * s->scale - 0.5;
    m->kernels->path_lengths(s->published ? axis : s->tangent[0],
      s->published ? axis + 1 : s->tangent[1], planes, (float)(s->slope_x + center * s->slope_dx),
      (float)(s->slope_y + row * s->slope_dy), (float)(s->slope_dx * s->scale), CHI_SEGMENT, length,
      length_x);
  }
  const float* const tau = s->scale == 1 ? tau_row(m, slab, y) : light_scratch(m, LIGHT_TAU, y);
  const chi_light_segment segment = { .source = row_of_light(m, f, read, y) + x,
    .target = target,
    .plane = m->light_stride,
    .offset = m->steps[slab].offset,
    .weight = (const float(*)[4])m->steps[slab].weight,
    .stride = m->light_row,
    .directions = s->directions,
    .share = s->weighted ? s->weight : NULL,
    .factor = factor,
    .tau = has_tau ? tau + x : NULL,
    .length = length,
    .length_x = length_x,
    .geometry = blocked ? geometry : NULL,
    .visibility = seen };
  (s->published ? m->kernels->blur : m->kernels->light)(&segment);
  if (k == 0)
  {
    seen[-1] = seen[0]; /* the enlargement reads one pixel beyond the picture */
  }
  *target_dirty = *seen_dirty = 1;
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
