/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Translucent layers in the march. A layer of a pixel that lies in the segment just sampled cuts it
 * in two: extinction is constant along a segment, so that of the transmittance T of the ray before
 * and T q after it, T q^f is left at the fraction f, and the segment's colour splits in proportion
 * to what each part absorbs (theory/occlusion.md, "Translucent layers"). The kernels know nothing
 * of it: where a layer is due, the row's state is kept before they run and mended afterwards, and
 * only there. What a layer receives may be known some slabs later only, so its weight in the
 * picture is kept apart, and its colour is added at the end.
 */

#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

int chi_layers_are_valid(const chi_layers_view* layers)
{
  return !layers || layers->count == 0 ||
    (layers->count > 0 && layers->count <= CHI_MAX_LAYERS && layers->depth && layers->rgba);
}

int chi_layers_count(const chi_occlusion_frame* frame)
{
  const int edge = frame->surface && frame->surface->edge_depth;
  return (frame->layers ? frame->layers->count : 0) + edge;
}

/* The slot of the surface's edge; -1: there is none. */
static int edge_of(const chi_occlusion_frame* frame)
{
  return frame->surface && frame->surface->edge_depth ? chi_layers_count(frame) - 1 : -1;
}

/* Place of a pixel's slot in the caller's arrays. */
static size_t place_of(const chi_occlusion_frame* frame, int slot, int64_t x, int64_t y)
{
  const size_t width = (size_t)frame->camera->width, height = (size_t)frame->camera->height;
  return ((slot == edge_of(frame) ? 0 : (size_t)slot) * height + (size_t)y) * width + (size_t)x;
}

const float* chi_layer_color(const chi_occlusion_frame* frame, int slot, int64_t x, int64_t y)
{
  return 4 * place_of(frame, slot, x, y) +
    (slot == edge_of(frame) ? frame->surface->edge_rgba : frame->layers->rgba);
}

static double layer_depth(const chi_occlusion_frame* frame, int slot, int64_t x, int64_t y)
{
  const float* const depth =
    slot == edge_of(frame) ? frame->surface->edge_depth : frame->layers->depth;
  return (double)depth[place_of(frame, slot, x, y)];
}

float chi_layer_alpha(const float rgba[4])
{
  return fminf(fmaxf(rgba[3], 0), 1);
}

float chi_layer_slices(const chi_scene* s, const chi_occlusion_frame* frame, int slot, int64_t x,
  int64_t y, float surface)
{
  const float* const rgba = chi_layer_color(frame, slot, x, y);
  const double world = layer_depth(frame, slot, x, y);
  const float here = (float)((world - s->start) / s->slice);
  const int finite =
    isfinite(rgba[0]) && isfinite(rgba[1]) && isfinite(rgba[2]) && isfinite(rgba[3]);
  const int there =
    world > 0 && world < INFINITY && finite && here < INFINITY && rgba[3] > 0 && !(here >= surface);
  return there ? here : INFINITY;
}

float chi_layer_receiver(const chi_scene* s, const chi_occlusion_frame* frame, int slot, int64_t x,
  int64_t y, float slices)
{
  return slices < INFINITY && slot == edge_of(frame)
    ? chi_surface_receiver(s, frame->surface, x, y, layer_depth(frame, slot, x, y))
    : slices;
}

static float* layer_row(const march* m, int which, int64_t y)
{
  return m->layer_planes + ((size_t)y * LAYER_PLANES + (size_t)which) * m->light.stride;
}

static void collect_row(const march* m, int64_t y)
{
  const chi_scene* const s = m->scene;
  const float* const surface = m->frame->surface ? surface_row(&m->light, SURFACE, y) : NULL;
  float* const next = m->layer_next + (size_t)y * (size_t)m->cells_x;
  for (int64_t x = 0; x < s->width; ++x)
  {
    float nearest = INFINITY;
    for (int k = 0; k < m->layers; ++k)
    {
      const float depth = chi_layer_slices(s, m->frame, k, x, y, surface ? surface[x] : INFINITY);
      layer_row(m, LAYER_DEPTH + k, y)[x] = depth;
      layer_row(m, LAYER_WEIGHT + k, y)[x] = 0;
      for (int c = 0; c < s->channels; ++c)
      {
        layer_row(m, LAYER_VISIBILITY + c * LAYER_SLOTS + k, y)[x] = 1;
      }
      if (k == edge_of(m->frame))
      {
        layer_row(m, LAYER_RECEIVER, y)[x] = chi_layer_receiver(s, m->frame, k, x, y, depth);
      }
      nearest = fminf(nearest, depth);
    }
    m->layer_done[(size_t)y * m->light.stride + (size_t)x] = 0;
    float* const cell = next + x / CHI_CELL_WIDTH;
    *cell = x % CHI_CELL_WIDTH == 0 ? nearest : fminf(*cell, nearest);
  }
}

/* Depths at which a slot receives light. */
static const float* receiver_row(const march* m, int slot, int64_t y)
{
  return layer_row(m, slot == edge_of(m->frame) ? LAYER_RECEIVER : LAYER_DEPTH + slot, y);
}

/* Step of the march that lights geometry at this depth; see chi_light_receiver_plane. */
static float step_of(const march* m, float slices)
{
  return (float)(floor(chi_light_receiver_plane(m->scene, (double)slices)) + 2);
}

static void collect_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const chi_scene* const s = m->scene;
  for (size_t by = begin; by < end && !chi_is_cancelled(m->exec); ++by)
  {
    float* const steps = m->layer_steps + 2 * by * (size_t)m->light.segments;
    for (int k = 0; k < m->light.segments; ++k)
    {
      steps[2 * k] = INFINITY;
      steps[2 * k + 1] = -INFINITY;
    }
    const int64_t last = (int64_t)(by + 1) * s->scale;
    for (int64_t y = (int64_t)by * s->scale; y < last && y < s->height; ++y)
    {
      collect_row(m, y);
      for (int64_t x = 0; x < s->width; ++x)
      {
        float* const range = steps + 2 * (x / s->scale / CHI_SEGMENT);
        for (int k = 0; k < m->layers; ++k)
        {
          const float depth = receiver_row(m, k, y)[x];
          if (depth < INFINITY)
          {
            range[0] = fminf(range[0], step_of(m, depth));
            range[1] = fmaxf(range[1], step_of(m, depth));
          }
        }
      }
    }
  }
}

/* After the surface's depths are known. */
chi_status chi_layers_plan(march* m)
{
  const size_t next = m->light.rows * (size_t)m->cells_x;
  const size_t steps = 2 * (size_t)m->scene->light_height * (size_t)m->light.segments;
  if (!chi_buffer_reserve(
        m->exec, &m->keep->layers, LAYER_PLANES * m->plane + next + steps, sizeof(float)) ||
    !chi_buffer_reserve(m->exec, &m->keep->layer_flags, m->plane, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  m->layer_planes = (float*)m->keep->layers.data;
  m->layer_next = m->layer_planes + LAYER_PLANES * m->plane;
  m->layer_steps = m->layer_next + next;
  m->layer_done = (uint8_t*)m->keep->layer_flags.data;
  return chi_for(m->exec, (size_t)m->scene->light_height, collect_rows, m);
}

static void light_row(const march* m, int64_t y, const int64_t columns[2], float first, float last)
{
  for (int k = 0; k < m->layers; ++k)
  {
    const float* const depth = receiver_row(m, k, y);
    for (int64_t x = columns[0]; x < columns[1]; ++x)
    {
      if (depth[x] < INFINITY && step_of(m, depth[x]) >= first && step_of(m, depth[x]) <= last)
      {
        for (int c = 0; c < m->scene->channels; ++c)
        {
          layer_row(m, LAYER_VISIBILITY + c * LAYER_SLOTS + k, y)[x] =
            (float)chi_march_visibility(m, c, (double)depth[x], x, y);
        }
      }
    }
  }
}

/* Layers of one light row whose planes are complete in this step. */
void chi_layers_light(const march* m, int64_t step, int64_t by)
{
  const chi_scene* const s = m->scene;
  const float now = (float)step;
  for (int k = 0; k < m->light.segments; ++k)
  {
    const float* const range =
      m->layer_steps + 2 * ((size_t)by * (size_t)m->light.segments + (size_t)k);
    if (!(range[0] <= now) || !(range[1] >= now))
    {
      continue;
    }
    const int64_t width = (int64_t)CHI_SEGMENT * s->scale;
    const int64_t columns[2] = { k * width,
      (k + 1) * width < s->width ? (k + 1) * width : s->width };
    for (int64_t y = by * s->scale; y < (by + 1) * s->scale && y < s->height; ++y)
    {
      light_row(m, y, columns, now, now);
    }
  }
}

/* What no step of the march could serve: layers at the last plane and behind it. */
void chi_layers_light_rest(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const int64_t columns[2] = { 0, m->scene->width };
  for (size_t y = begin; y < end && !chi_is_cancelled(m->exec); ++y)
  {
    light_row(m, (int64_t)y, columns, (float)m->scene->slabs, INFINITY);
  }
}

/* The nearest slot of a pixel that is not done, or -1; its depth. */
static int next_slot(const march* m, uint8_t done, int64_t x, int64_t y, float* depth)
{
  int next = -1;
  *depth = INFINITY;
  for (int k = 0; k < m->layers; ++k)
  {
    const float at = layer_row(m, LAYER_DEPTH + k, y)[x];
    if (!(done >> k & 1) && at < *depth)
    {
      next = k;
      *depth = at;
    }
  }
  return next;
}

/* Blend the layers of a pixel that lie nearer than `depth` where nothing absorbs in between. */
static void pass_layers(march* m, int64_t x, int64_t y, float depth, float* transmittance)
{
  uint8_t* const done = m->layer_done + (size_t)y * m->light.stride + (size_t)x;
  float at;
  for (int k = next_slot(m, *done, x, y, &at); k >= 0 && at <= depth;
       k = next_slot(m, *done, x, y, &at))
  {
    layer_row(m, LAYER_WEIGHT + k, y)[x] = *transmittance;
    *transmittance *= 1 - chi_layer_alpha(chi_layer_color(m->frame, k, x, y));
    *done |= (uint8_t)(1 << k);
  }
}

/* Before a run of cells is sampled: blend what lies in front of the segment. Returns whether layers
 * lie in it; then the row's state is kept. */
int chi_layers_before(march* m, chi_sample_row* row, int64_t y, int first_cell, int end_cell)
{
  const float* const next = m->layer_next + (size_t)y * (size_t)m->cells_x;
  int due = 0;
  for (int cell = first_cell; cell < end_cell; ++cell)
  {
    if (!(next[cell] < row->near_slice + 1))
    {
      continue;
    }
    due = 1;
    const int64_t x0 = (int64_t)cell * CHI_CELL_WIDTH;
    const int64_t x1 =
      x0 + CHI_CELL_WIDTH < m->scene->width ? x0 + CHI_CELL_WIDTH : m->scene->width;
    for (int64_t x = x0; x < x1; ++x)
    {
      pass_layers(m, x, y, row->near_slice, row->transmittance + x);
    }
    for (int c = 0; c < 3; ++c)
    {
      memcpy(
        layer_row(m, LAYER_RED + c, y) + x0, row->color[c] + x0, CHI_CELL_WIDTH * sizeof(float));
    }
    memcpy(
      layer_row(m, LAYER_RED + 3, y) + x0, row->transmittance + x0, CHI_CELL_WIDTH * sizeof(float));
  }
  return due;
}

/* The segment of a pixel, with the layers that lie in it. */
static void split_segment(march* m, chi_sample_row* row, int64_t x, int64_t y)
{
  const float far = row->near_slice + 1;
  const float start = row->enter ? fmaxf(row->near_slice, row->enter[x]) : row->near_slice;
  float stop = row->enter ? fminf(far, row->leave[x]) : far;
  stop = row->surface ? fminf(stop, row->surface[x]) : stop;
  const float before = layer_row(m, LAYER_RED + 3, y)[x], after = row->transmittance[x];
  const float absorbed = before - after;
  uint8_t* const done = m->layer_done + (size_t)y * m->light.stride + (size_t)x;
  float through = 1, last = before, kept = 0; /* share of the segment's colour */
  float at;
  for (int k = next_slot(m, *done, x, y, &at); k >= 0 && at < far;
       k = next_slot(m, *done, x, y, &at))
  {
    const float f = at <= start || !(stop > start) ? 0 : fminf((at - start) / (stop - start), 1);
    const float here = absorbed > 0 ? before * powf(after / before, f) : before;
    kept += absorbed > 0 ? through * (last - here) / absorbed : 0;
    layer_row(m, LAYER_WEIGHT + k, y)[x] = through * here;
    through *= 1 - chi_layer_alpha(chi_layer_color(m->frame, k, x, y));
    last = here;
    *done |= (uint8_t)(1 << k);
  }
  if (!(absorbed > 0))
  {
    row->transmittance[x] = through * after;
    return;
  }
  kept += through * (last - after) / absorbed;
  for (int c = 0; c < 3; ++c)
  {
    const float color = layer_row(m, LAYER_RED + c, y)[x];
    row->color[c][x] = color + kept * (row->color[c][x] - color);
  }
  row->transmittance[x] = through * after;
}

/* After it has been sampled. */
void chi_layers_after(march* m, chi_sample_row* row, int64_t y, int first_cell, int end_cell)
{
  float* const next = m->layer_next + (size_t)y * (size_t)m->cells_x;
  const float far = row->near_slice + 1;
  for (int cell = first_cell; cell < end_cell; ++cell)
  {
    if (!(next[cell] < far))
    {
      continue;
    }
    next[cell] = INFINITY;
    const int64_t x0 = (int64_t)cell * CHI_CELL_WIDTH;
    for (int64_t x = x0; x < x0 + CHI_CELL_WIDTH && x < m->scene->width; ++x)
    {
      float depth;
      split_segment(m, row, x, y);
      next_slot(m, m->layer_done[(size_t)y * m->light.stride + (size_t)x], x, y, &depth);
      next[cell] = fminf(next[cell], depth);
    }
  }
}

/* The layers behind all samples, and the colours of all layers. */
void chi_layers_finish(void* data, size_t begin, size_t end)
{
  march* const m = (march*)data;
  for (size_t row = begin; row < end && !chi_is_cancelled(m->exec); ++row)
  {
    const int64_t y = (int64_t)row;
    float* const transmittance = picture(m, TRANSMITTANCE, y);
    for (int64_t x = 0; x < m->scene->width; ++x)
    {
      pass_layers(m, x, y, INFINITY, transmittance + x);
      for (int k = 0; k < m->layers; ++k)
      {
        const float weight = layer_row(m, LAYER_WEIGHT + k, y)[x];
        if (weight > 0)
        {
          for (int c = 0; c < 3; ++c)
          {
            const int plane = LAYER_VISIBILITY + m->scene->channel_of[c] * LAYER_SLOTS + k;
            const float light = 1 - m->strength * (1 - layer_row(m, plane, y)[x]);
            picture(m, RED + c, y)[x] += weight * light * chi_layer_color(m->frame, k, x, y)[c];
          }
        }
      }
    }
  }
}
