/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* The translucent layers of a frame, and the edges of its surface, in the words of
 * chi_occlusion_plan.h. */

#include "chi_occlusion_describe.h"
#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

typedef struct layers_job
{
  const chi_scene* scene;
  const chi_occlusion_frame* frame;
  const chi_occlusion_plan* plan;
  float (*layer)[4]; /* [layers][height][width] */
  float (*rgba)[4];
} layers_job;

/* A pixel's layers, the nearest first; of equal ones the first is in front. */
static int sort_layers(
  const layers_job* it, int64_t x, int64_t y, int slot[LAYER_SLOTS], float depth[LAYER_SLOTS])
{
  const int32_t width = it->plan->width;
  const float surface = it->plan->surface ? it->plan->surface[y * width + x][0] : INFINITY;
  int count = 0;
  for (int k = 0; k < it->plan->layers; ++k)
  {
    const float here = chi_layer_slices(it->scene, it->frame, k, x, y, surface);
    int at = count;
    for (; at > 0 && depth[at - 1] > here; --at)
    {
      depth[at] = depth[at - 1];
      slot[at] = slot[at - 1];
    }
    depth[at] = here;
    slot[at] = k;
    count += here < INFINITY;
  }
  return count;
}

static void place_layers(void* data, size_t begin, size_t end)
{
  const layers_job* const it = (const layers_job*)data;
  const size_t width = (size_t)it->plan->width, pixels = width * (size_t)it->plan->height;
  for (size_t i = begin * width; i < end * width; ++i)
  {
    const int64_t x = (int64_t)(i % width), y = (int64_t)(i / width);
    int slot[LAYER_SLOTS];
    float depth[LAYER_SLOTS];
    const int count = sort_layers(it, x, y, slot, depth);
    for (int k = 0; k < it->plan->layers; ++k)
    {
      float* const layer = it->layer[(size_t)k * pixels + i];
      float* const rgba = it->rgba[(size_t)k * pixels + i];
      memset(rgba, 0, 4 * sizeof(float));
      memset(layer, 0, 4 * sizeof(float));
      layer[0] = INFINITY;
      if (k < count)
      {
        const float* const color = chi_layer_color(it->frame, slot[k], x, y);
        const double plane = chi_light_receiver_plane(
          it->scene, (double)chi_layer_receiver(it->scene, it->frame, slot[k], x, y, depth[k]));
        memcpy(rgba, color, 4 * sizeof(float));
        layer[0] = depth[k];
        layer[1] = chi_layer_alpha(color);
        layer[2] = (float)plane;
        layer[3] = chi_plan_beyond(it->scene, plane);
      }
    }
  }
}

/* Which slabs layers lie in, and which planes light them. */
static void bound_layers(chi_occlusion_plan* plan, chi_rect* spots, chi_rect* receivers)
{
  const size_t pixels = (size_t)plan->width * (size_t)plan->height;
  for (size_t i = 0; i < (size_t)plan->layers * pixels; ++i)
  {
    const float* const layer = plan->layer[i];
    if (!(layer[0] < INFINITY))
    {
      continue;
    }
    const int32_t x = (int32_t)(i % pixels % (size_t)plan->width);
    const int32_t y = (int32_t)(i % pixels / (size_t)plan->width);
    const double slab = fmax(floor((double)layer[0] / (double)plan->group), 0);
    if (slab < (double)plan->slabs)
    {
      chi_rect_add(spots + (int64_t)slab, x, y);
    }
    chi_plan_receive(plan, layer[2], x, y, receivers, &plan->layers_beyond);
  }
}

chi_status chi_plan_layers(const chi_exec* exec, chi_plan_keep* keep, const chi_scene* scene,
  const chi_occlusion_frame* frame, chi_rect* spots, chi_rect* receivers)
{
  chi_occlusion_plan* const plan = &keep->plan;
  plan->layers = chi_layers_count(frame);
  if (plan->layers == 0)
  {
    return CHI_OK;
  }
  const size_t slots = (size_t)plan->layers * (size_t)plan->width * (size_t)plan->height;
  if (!chi_buffer_reserve(exec, &keep->layers, 2 * slots, 4 * sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  float(*const layer)[4] = (float(*)[4])keep->layers.data;
  layers_job job = {
    .scene = scene, .frame = frame, .plan = plan, .layer = layer, .rgba = layer + slots
  };
  const chi_status status = chi_for(exec, (size_t)plan->height, place_layers, &job);
  if (status == CHI_OK)
  {
    plan->layer = (const float(*)[4])layer;
    plan->layer_rgba = plan->layer + slots;
    bound_layers(plan, spots, receivers);
  }
  return status;
}
