/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Layout, buffers and order of a frame's march. */

#include "chi_components_internal.h"
#include "chi_mask_internal.h"
#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

size_t chi_march_picture_floats(const chi_scene* s)
{
  return GEOMETRY_PLANES * chi_light_rows(s) * chi_light_stride(s) + 64;
}

static void plan_order(march* m)
{
  int64_t* next = m->order;
  const int64_t diagonals = (m->blocks - 1) * (m->lag + 1) + m->bands;
  for (int64_t d = 0; d < diagonals; ++d)
  {
    for (int64_t block = d / (m->lag + 1) < m->blocks - 1 ? d / (m->lag + 1) : m->blocks - 1;
         block >= 0; --block)
    {
      const int64_t band = d - block * (m->lag + 1);
      if (band >= m->bands)
      {
        break;
      }
      *next++ = block;
      *next++ = band;
    }
  }
}

/* Which light travels: for the volume, and, where others block it, for surfaces. */
void chi_frame_fields(const chi_occlusion_frame* frame, chi_frame_light* light)
{
  const int bits = frame->params->interactions;
  const int has_volume = frame->volume != NULL, has_surface = frame->surface != NULL;
  const int to_volume[2] = { (bits & CHI_VOLUME_TO_VOLUME) && has_volume,
    (bits & CHI_GEOMETRY_TO_VOLUME) && has_surface };
  const int to_surface[2] = { (bits & CHI_VOLUME_TO_GEOMETRY) && has_volume,
    (bits & CHI_GEOMETRY_TO_GEOMETRY) && has_surface };
  memset(light, 0, sizeof *light);
  if (!(frame->params->strength > 0) && !frame->probes)
  {
    return;
  }
  light->volume[0] = to_volume[0];
  light->geometry[0] = to_volume[1];
  light->fields = to_volume[0] || to_volume[1];
  const int receives = has_surface || (chi_layers_count(frame) > 0);
  if (receives && (to_surface[0] != to_volume[0] || to_surface[1] != to_volume[1]))
  {
    light->volume[1] = to_surface[0];
    light->geometry[1] = to_surface[1];
    light->surface_field = 1;
    light->fields = to_surface[0] || to_surface[1] ? 2 : light->fields;
  }
}

static int plan_fields(march* m)
{
  chi_frame_light light;
  chi_frame_fields(m->frame, &light);
  for (int f = 0; f < 2; ++f)
  {
    for (int c = 0; c < m->scene->channels; ++c)
    {
      m->keep->light.field[f][c].volume = light.volume[f];
      m->keep->light.field[f][c].geometry = light.geometry[f];
    }
  }
  m->surface_field = light.surface_field;
  chi_march_place_weights(m->scene->scale, m->receiver_weight);
  return light.fields;
}

static chi_status reserve(march* m)
{
  const chi_exec* const exec = m->exec;
  const chi_scene* const s = m->scene;
  chi_march* const keep = m->keep;
  const size_t segments = (size_t)m->light.segments, bands = (size_t)m->bands;
  const size_t blocks = (size_t)m->blocks, cells = (size_t)m->cells_x;
  const size_t channels = (size_t)s->channels;
  if (!chi_buffer_reserve(exec, &keep->planes, VOLUME_PLANES * m->plane + 64, sizeof(float)) ||
    !chi_buffer_reserve(
      exec, &keep->band_rows, bands * channels * m->light.stride + 64, sizeof(float)) ||
    !chi_buffer_reserve(exec, &keep->cells, blocks * (size_t)m->cells_y * cells + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->last_slab, bands * segments, 2 * sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->last_cell, (size_t)m->cells_y * cells, sizeof(int32_t)) ||
    !chi_buffer_reserve(exec, &keep->until, blocks * bands * segments + 1, sizeof(int32_t)) ||
    !chi_buffer_reserve(exec, &keep->need, bands * segments, 1) ||
    !chi_buffer_reserve(exec, &keep->live_row, 3 * m->light.rows * cells, 1) ||
    !chi_buffer_reserve(exec, &keep->sampled, m->light.rows * cells, sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->done, blocks * bands + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->order, blocks * bands + 1, 2 * sizeof(int64_t)) ||
    (s->channels > 1 &&
      !chi_buffer_reserve(exec, &keep->tint, channels * m->plane + 64, sizeof(float))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  m->planes = (float*)keep->planes.data;
  m->light.tau[0] = picture(m, TAU, 0);
  m->light.tau[1] = picture(m, TAU_OTHER, 0);
  m->light.tau_step = VOLUME_PLANES * m->light.stride;
  m->band_rows = (float*)keep->band_rows.data;
  m->cells = (uint8_t*)keep->cells.data;
  m->last_slab = (int64_t(*)[2])keep->last_slab.data;
  m->last_cell = (int32_t*)keep->last_cell.data;
  m->until = (int32_t*)keep->until.data;
  m->need = (uint8_t*)keep->need.data;
  m->live_row = (uint8_t*)keep->live_row.data;
  m->tau_stale = m->live_row + m->light.rows * cells;
  m->sampled = (int64_t*)keep->sampled.data;
  m->done = (atomic_uchar*)keep->done.data;
  m->order = (int64_t*)keep->order.data;
  m->tint = (float*)keep->tint.data;
  memset(keep->done.data, 0, blocks * bands);
  memset(m->live_row, RAYS_LIVE, m->light.rows * cells);
  memset(m->tau_stale, 0, 2 * m->light.rows * cells);
  for (size_t i = 0; i < m->light.rows * cells; ++i)
  {
    m->sampled[i] = -2;
  }
  return CHI_OK;
}

static void clear_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const size_t height = (size_t)m->scene->height;
  for (size_t y = begin; y < end; ++y)
  {
    for (int c = 0; c < 3; ++c)
    {
      memset(picture(m, RED + c, (int64_t)y), 0, m->light.stride * sizeof(float));
    }
    memset(picture(m, TAU, (int64_t)y), 0, m->light.stride * sizeof(float));
    memset(picture(m, TAU_OTHER, (int64_t)y), 0, m->light.stride * sizeof(float));
    chi_fill_ones(picture(m, TRANSMITTANCE, (int64_t)y), (int)m->light.stride);
    for (int c = 0; c < m->scene->channels && m->frame->surface && y < height; ++c)
    {
      chi_fill_ones(surface_visibility(m, c, (int64_t)y), m->scene->width);
    }
  }
}

/* Length of the picture's longest ray over a unit of depth. */
static double longest_ray(const chi_scene* s)
{
  const double x = fmax(fabs(s->slope_x), fabs(s->slope_x + (s->width - 1) * s->slope_dx));
  const double y = fmax(fabs(s->slope_y), fabs(s->slope_y + (s->height - 1) * s->slope_dy));
  return sqrt(1 + x * x + y * y);
}

float chi_march_color_step(
  const chi_scene* s, const chi_classification* c, const chi_occlusion_params* params)
{
  /* several tables, or rows of one, take the middle's */
  return params->color_integration == CHI_COLOR_MIDDLE || c->tables > 1 || c->plane.count[0]
    ? INFINITY
    : chi_classification_color_step(c, s->slice * longest_ray(s));
}

static chi_status set_sample_frame(march* m)
{
  chi_sample_frame* const f = &m->sample;
  f->saturated = m->keep->crossing      ? m->keep->crossing_transmittance
    : m->skip & CHI_SKIP_SATURATED_RAYS ? CHI_SATURATED
                                        : -1;
  if (!m->frame->volume)
  {
    return CHI_OK;
  }
  const chi_bricks* const b = m->bricks;
  const chi_classification* const c = m->classification;
  const size_t* const n = b->dimensions;
  f->scalars = b->scalars;
  f->fetch = b->fetch;
  f->nearest = b->nearest;
  f->step_x = n[0] > 1;
  f->step_y = n[1] > 1 ? (int32_t)n[0] : 0;
  f->step_z = n[2] > 1 ? (int32_t)(n[0] * n[1]) : 0;
  const size_t samples = n[0] * n[1] * n[2];
  f->last_load = (int32_t)(b->fetch == CHI_FETCH_U8 ? samples - 4
      : b->fetch == CHI_FETCH_F32                   ? samples - 1
                                                    : samples - 2);
  for (int a = 0; a < 3; ++a)
  {
    f->last_cell[a] = n[a] > 1 ? (int32_t)n[a] - 2 : 0;
    f->last_index[a] = (float)(n[a] - 1);
  }
  f->base = c->base;
  f->scale = c->scale;
  f->offset = c->offset;
  f->table_end = (float)(c->entries - 1);
  f->value_end = (float)(c->table_entries - 1);
  f->table_entries = (int32_t)c->table_entries;
  f->labels = c->mask ? c->mask->labels : NULL;
  f->sigma = (const chi_plan_entry*)c->sigma.data;
  f->rgba = (const float(*)[4])c->rgba.data;
  f->colors = (const chi_plan_color*)c->colors.data;
  f->color_step = chi_march_color_step(m->scene, c, m->frame->params);
  f->quantum = c->quantum;
  f->occupied = (const uint8_t*)c->occupied.data;
  f->brick_step_y = (int32_t)b->count[0];
  f->brick_step_z = (int32_t)(b->count[0] * b->count[1]);
  f->slice = (float)m->scene->slice;
  chi_cut_prepare(&f->cut, m->scene, c->mask);
  f->tinted = m->scene->channels > 1;
  f->general |= f->tinted;
  int shaded = 0;
  if (!chi_shading_prepare(&m->shade, m->frame, b, c, &shaded))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  f->shade = shaded ? &m->shade : NULL;
  f->general = f->general || shaded;
  m->second = *f; /* the other quantity's samples lie as the volume's do */
  m->second.scalars = m->shade.plane_second;
  m->second.fetch = CHI_FETCH_F32;
  f->second = m->shade.plane_second ? &m->second : NULL;
  f->components = NULL;
  if (m->frame->components)
  {
    chi_components_prepare(m->keep->components, m->frame->components, (int)m->frame->volume->type,
      &m->component_frame.plan);
    chi_components_frame(m->keep->components, f, m->more, &m->component_frame);
    f->components = &m->component_frame;
    f->general = 1;
  }
  return CHI_OK;
}

static void plan_layout(march* m)
{
  const chi_scene* const s = m->scene;
  chi_light_layout(&m->light);
  const int skew = m->light.skew;
  m->plane = m->light.rows * m->light.stride;
  m->cells_x = (s->width - 1) / CHI_CELL_WIDTH + 1;
  m->cells_y = (int)((m->light.rows - 1) / CHI_CELL_HEIGHT) + 1;
  m->block = 16 / skew < 1 ? 1 : 16 / skew < MAX_BLOCK ? 16 / skew : MAX_BLOCK;
  m->blocks = (s->slabs + m->block - 1) / m->block;
  m->bands = (s->light_height + skew * (m->block - 1) - 1) / BAND + 1;
  m->lag = (skew * m->block + BAND - 1) / BAND;
}

/* Everything that a frame needs before its first task. */
chi_status chi_march_plan(march* m)
{
  plan_layout(m);
  chi_status status = reserve(m);
  if (status != CHI_OK)
  {
    return status;
  }
  status = chi_light_prepare(&m->light, &m->keep->light, plan_fields(m), m->frame->surface != NULL);
  if (status == CHI_OK)
  {
    status = set_sample_frame(m);
  }
  if (status == CHI_OK)
  {
    plan_order(m);
    status = chi_for(m->exec, m->light.rows, clear_rows, m);
  }
  return status;
}
