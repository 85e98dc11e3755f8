/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Samples of one row of pixels through one slab. */

#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

/* Visibility of a run of pixels at a slice, or NULL where all of it is 1. */
static const float* run_visibility(const march* m, int channel, int64_t slab, double slices,
  int64_t y, int x_begin, int x_end, float* out)
{
  const chi_scene* const s = m->scene;
  const chi_light_field* const f = &m->light.field[0][channel];
  if (!m->shaded || !(f->volume || f->geometry) || slab == 0)
  {
    return NULL;
  }
  const double plane = slices / (double)s->group - s->sample_bias - 0.5;
  return chi_light_read_row(&m->light, f, plane < (double)(slab - 1) ? plane : (double)(slab - 1),
    m->strength, y, x_begin, x_end, out);
}

/* Common parts of a row between two slices. */
static void set_row(const march* m, chi_sample_row* row, int64_t y, int64_t segment)
{
  const chi_scene* const s = m->scene;
  const double far = s->start + (double)(segment + 1) * s->slice;
  for (int a = 0; a < 3; ++a)
  {
    const double across = (double)y * s->along_y[a];
    const double lateral = s->parallel ? 1 : far;
    row->position[a] = (float)(s->origin[a] + far * s->axis[a] + lateral * across);
    row->position_x[a] = (float)(lateral * s->along_x[a]);
    row->direction[a] = (float)(s->slice * (s->axis[a] + (s->parallel ? 0 : across)));
    row->direction_x[a] = (float)(s->parallel ? 0 : s->slice * s->along_x[a]);
  }
  const double py = s->slope_y + (double)y * s->slope_dy;
  row->length0 = (float)s->slope_x;
  row->length_x = (float)s->slope_dx;
  row->length_c = (float)(1 + py * py);
  row->near_slice = (float)segment;
  row->first = segment == s->volume_begin * s->group;
}

/* Where the rays of a run that are done now have got as opaque as asked, by the extinction that is
 * constant from slice to slice. `before` is their transmittance at the near slice. */
static void find_crossings(
  const march* m, const chi_sample_row* row, int64_t y, const float* before, int x0, int x1)
{
  const chi_scene* const s = m->scene;
  const float limit = m->keep->crossing_transmittance;
  for (int x = x0; x < x1 && x < s->width; ++x)
  {
    const float after = row->transmittance[x];
    if (before[x] > limit && after <= limit)
    {
      const double near = (double)row->near_slice;
      const double from = row->enter ? fmax(near, (double)row->enter[x]) : near;
      double to = row->enter ? fmin(near + 1, (double)row->leave[x]) : near + 1;
      to = row->surface ? fmin(to, fmax(from, (double)row->surface[x])) : to;
      const double share = after > 0
        ? log((double)before[x] / (double)limit) / log((double)before[x] / (double)after)
        : 0;
      m->keep->crossing[y * s->width + x] =
        (float)(s->start + (from + share * (to - from)) * s->slice);
    }
  }
}

/* Light pixels of a cell: a scale of 1 or 2 makes of it one segment of them or half a one. */
static inline int segment_of_cell(const chi_scene* s, int cell)
{
  _Static_assert(CHI_CELL_WIDTH % CHI_SEGMENT == 0, "a cell is whole segments of pixels");
  return cell * (CHI_CELL_WIDTH / CHI_SEGMENT) >> (s->scale - 1);
}

void chi_march_sample_row(march* m, int64_t slab, int64_t y, int band, chi_sample_row* row)
{
  const chi_scene* const s = m->scene;
  const int64_t block = slab / m->block;
  const uint8_t* const cells = m->cells + (block * m->cells_y + y / CHI_CELL_HEIGHT) * m->cells_x;
  const uint8_t* const live = m->live_row + y * m->cells_x;
  const uint8_t* const need = m->need + (int64_t)band * m->light.segments;
  int64_t* const sampled = m->sampled + y * m->cells_x;
  uint8_t* const flags = m->light.tau_flag + y / s->scale * m->light.segments;
  const int width = (s->width + CHI_CELL_WIDTH - 1) / CHI_CELL_WIDTH * CHI_CELL_WIDTH;
  uint8_t* const stale =
    m->tau_stale + ((size_t)(slab & 1) * m->light.rows + (size_t)y) * (size_t)m->cells_x;
  for (int64_t i = 0; i < s->group; ++i)
  {
    const int64_t segment = slab * s->group + i;
    int is_set = 0;
    for (int cx = 0; cx < m->cells_x;)
    {
      const int light = need[segment_of_cell(s, cx)];
      if (cells[cx] == CELL_EMPTY || !(light || live[cx] == RAYS_LIVE))
      {
        if (cells[cx] != CELL_EMPTY)
        {
          row->spared[live[cx] == RAYS_SATURATED ? CHI_SPARED_SATURATED : CHI_SPARED_HIDDEN] +=
            CHI_CELL_WIDTH;
        }
        if (i == 0 && stale[cx])
        {
          memset(row->tau + cx * CHI_CELL_WIDTH, 0, CHI_CELL_WIDTH * sizeof(float));
          stale[cx] = 0;
        }
        ++cx;
        continue;
      }
      if (!is_set)
      {
        set_row(m, row, y, segment);
        is_set = 1;
      }
      /* A run of cells that are alike. */
      const int restart = sampled[cx] != segment - 1;
      int end = cx;
      while (end < m->cells_x && cells[end] == cells[cx] && live[end] == live[cx] &&
        (sampled[end] != segment - 1) == restart && need[segment_of_cell(s, end)] == light)
      {
        stale[end] = 1;
        sampled[end++] = segment;
      }
      const int x0 = cx * CHI_CELL_WIDTH;
      const int x1 = end * CHI_CELL_WIDTH < width ? end * CHI_CELL_WIDTH : width;
      row->new_tau = i == 0;
      row->restart = restart;
      row->bricks = (cells[cx] & CELL_MIXED) != 0;
      row->cut = (cells[cx] & CELL_CUT) != 0;
      row->enter = cells[cx] & (CELL_CROSSES_BOX | CELL_CUT) ? picture(m, ENTER, y) : NULL;
      row->leave = picture(m, LEAVE, y);
      row->surface = m->frame->surface ? surface_row(&m->light, SURFACE, y) : NULL;
      row->saturated_too = light;
      row->hidden_too = light || !(m->skip & CHI_SKIP_BEHIND_GEOMETRY);
      const float* visibility[3] = { NULL, NULL, NULL };
      for (int c = 0; c < s->channels && live[cx] == RAYS_LIVE; ++c)
      {
        visibility[c] =
          run_visibility(m, c, slab, (double)segment, y, x0, x1, row_visibility(m, c, band));
      }
      row->visibility = visibility[0];
      for (int c = 0; c < 3 && s->channels > 1; ++c)
      {
        row->tint[c] = visibility[s->channel_of[c]];
      }
      row->any_tau = 0;
      const int layered = m->layers && chi_layers_before(m, row, y, cx, end);
      float* const before = m->keep->crossing ? row_visibility(m, 0, band) : NULL;
      if (before) /* there is no light then, and the row is free */
      {
        memcpy(before + x0, row->transmittance + x0, (size_t)(x1 - x0) * sizeof(float));
      }
      m->kernels->sample(row, x0, x1);
      if (before)
      {
        find_crossings(m, row, y, before, x0, x1);
      }
      if (layered)
      {
        chi_layers_after(m, row, y, cx, end);
      }
      if (row->any_tau)
      {
        for (int k = cx; k < end; ++k)
        {
          flags[segment_of_cell(s, k)] = 1;
        }
      }
      cx = end;
    }
  }
  if (s->width % s->scale)
  {
    row->tau[s->width] =
      0; /* half a light pixel outside: clear, as the row above an odd height is */
  }
}
