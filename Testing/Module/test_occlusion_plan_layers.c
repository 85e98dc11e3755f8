/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What a plan says to further engines of layers and of surfaces that cover pixels in part. */

#include <chiaroscuro/chi_occlusion_plan.h>

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  N = 8,
  WIDTH = 40,
  HEIGHT = 30,
  PIXELS = WIDTH * HEIGHT,
  SLOTS = CHI_MAX_LAYERS + 1
};

typedef struct scene
{
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_layers_view layers;
  chi_occlusion_params params;
  chi_occlusion_frame frame;
  chi_occlusion* engine;
  chi_occlusion_plan plan;
  float rgb[6], opacity[2], samples[N * N * N];
  float depth[PIXELS], end[PIXELS], edge_depth[PIXELS], edge_rgba[4 * PIXELS];
  float layer_depth[CHI_MAX_LAYERS * PIXELS], layer_rgba[4 * CHI_MAX_LAYERS * PIXELS];
} scene;

/* Fog in a cube of 7 units about depth 60; surfaces and layers about it, here and there. */
static scene* make_scene(int parallel)
{
  scene* const s = calloc(1, sizeof *s);
  if (!s)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, WIDTH, HEIGHT, parallel ? 5 : 5.0 / 60);
  for (int i = 0; i < N * N * N; ++i)
  {
    s->samples[i] = 1;
  }
  s->volume = cube_at(s->samples, CHI_F32, N, 60);
  s->opacity[1] = 0.1f;
  s->transfer = tables(s->rgb, s->opacity, 2, 0, 1);
  uint32_t state = 99;
  for (int i = 0; i < PIXELS; ++i)
  {
    state = state * 1664525u + 1013904223u;
    const double a = (state >> 8) / (double)(1 << 24);
    s->depth[i] = i % 3 ? (float)(55 + 12 * a) : INFINITY;
    s->end[i] = i % 2 ? s->depth[i] : i % 5 ? s->depth[i] + 4 : INFINITY;
    s->edge_depth[i] = i % 3 && i % 2 == 0 ? s->depth[i] : INFINITY;
    s->edge_rgba[4 * i + 3] = 0.5f;
  }
  for (int i = 0; i < CHI_MAX_LAYERS * PIXELS; ++i)
  {
    state = state * 1664525u + 1013904223u;
    /* twice as coarse as there are numbers: some lie at the same depth */
    s->layer_depth[i] = state >> 29 ? 54 + 0.125f * (float)(state >> 24 & 127) : INFINITY;
    s->layer_rgba[4 * i] = (float)(i / PIXELS);
    s->layer_rgba[4 * i + 3] = 0.25f * (float)(i / PIXELS + 1) + (i % 7 ? 0 : 3);
  }
  s->surface = surface_of(s->depth);
  s->layers = layers_of(s->layer_depth, s->layer_rgba, CHI_MAX_LAYERS);
  chi_occlusion_default_params(&s->params);
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .volume = &s->volume,
    .transfer = &s->transfer,
    .surface = &s->surface,
    .params = &s->params };
  s->plan.struct_size = sizeof s->plan;
  CHECK(chi_occlusion_create(NULL, &s->engine) == CHI_OK);
  return s;
}

static void free_scene(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  free(s);
}

static void describe(scene* s)
{
  ++s->layers.version;
  ++s->surface.version;
  CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &s->plan) == CHI_OK);
}

static int holds(chi_rect rect, int pixel)
{
  const int x = pixel % WIDTH, y = pixel / WIDTH;
  return x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1;
}

static float slices_of(const scene* s, float depth)
{
  return (float)(((double)depth - s->plan.start) / s->plan.slice);
}

/* Slot of the frame that a layer of the plan is: layers carry theirs in red, edges come last. */
static int slot_of(const float rgba[4])
{
  return rgba[3] == 0.5f && rgba[0] == 0 ? CHI_MAX_LAYERS : (int)rgba[0];
}

static void layers_of_a_pixel_are_sorted_and_none_is_lost(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel);
    s->frame.layers = &s->layers;
    s->surface.end = s->end;
    s->surface.edge_depth = s->edge_depth;
    s->surface.edge_rgba = s->edge_rgba;
    describe(s);
    CHECK(s->plan.layers == SLOTS);
    CHECK(s->plan.features == (CHI_FEATURE_LAYERS | CHI_FEATURE_EDGES));
    int pairs = 0, edges = 0;
    for (int i = 0; i < PIXELS; ++i)
    {
      int expected = 0, found = 0;
      const float end = slices_of(s, s->end[i]);
      for (int k = 0; k < SLOTS; ++k)
      {
        const float depth = k < CHI_MAX_LAYERS ? s->layer_depth[k * PIXELS + i] : s->edge_depth[i];
        expected += depth < INFINITY && slices_of(s, depth) < end;
        const float* const layer = s->plan.layer[k * PIXELS + i];
        const float* const rgba = s->plan.layer_rgba[k * PIXELS + i];
        if (!(layer[0] < INFINITY))
        {
          CHECK(layer[1] == 0 && rgba[3] == 0);
          continue;
        }
        CHECK(found == k); /* those that are missing come last */
        ++found;
        const int slot = slot_of(rgba);
        edges += slot == CHI_MAX_LAYERS;
        const float from =
          slot < CHI_MAX_LAYERS ? s->layer_depth[slot * PIXELS + i] : s->edge_depth[i];
        CHECK(layer[0] == slices_of(s, from));
        CHECK(layer[1] == (rgba[3] < 1 ? rgba[3] : 1));
        if (k > 0)
        {
          const float before = s->plan.layer[(k - 1) * PIXELS + i][0];
          CHECK(before <= layer[0]);
          pairs += before == layer[0];
          CHECK(before < layer[0] || slot_of(s->plan.layer_rgba[(k - 1) * PIXELS + i]) < slot);
        }
      }
      CHECK(found == expected);
    }
    CHECK(pairs > 10 && edges > 100);
    free_scene(s);
  }
}

static void rectangles_hold_all_layers_and_their_light(void)
{
  scene* const s = make_scene(1);
  s->frame.layers = &s->layers;
  s->frame.surface = NULL;
  s->params.half_size = 0;
  describe(s);
  int front = 0, behind = 0, later = 0;
  for (int i = 0; i < s->plan.layers * PIXELS; ++i)
  {
    const float* const layer = s->plan.layer[i];
    if (!(layer[0] < INFINITY))
    {
      continue;
    }
    const int64_t slab = layer[0] < 0 ? 0 : (int64_t)(layer[0] / (float)s->plan.group);
    front += layer[0] < 0;
    behind += slab >= s->plan.slabs;
    CHECK(slab >= s->plan.slabs || holds(s->plan.layer_spots[slab], i % PIXELS));
    if (layer[2] > (float)(s->plan.slabs - 1))
    {
      CHECK(holds(s->plan.layers_beyond, i % PIXELS) && layer[3] >= 0);
      ++later;
    }
    else if (layer[2] > -1)
    {
      const int64_t above = (int64_t)floorf(layer[2]) + 1;
      CHECK(holds(s->plan.layer_receivers[above < s->plan.slabs ? above : above - 1], i % PIXELS));
      for (int64_t g = above > 0 ? above - 1 : 0; g <= above && g < s->plan.slabs; ++g)
      {
        /* samples darken it */
        CHECK(!holds(s->plan.samples[g], i % PIXELS) || holds(s->plan.light[g], i % PIXELS));
      }
    }
  }
  CHECK(front > 100 && behind > 100 && later > 100);
  free_scene(s);
}

static void a_surface_blocks_where_it_is_and_receives_where_rays_end(void)
{
  scene* const s = make_scene(0);
  describe(s);
  CHECK(s->plan.layers == 0 && s->plan.features == 0);
  for (int i = 0; i < PIXELS; ++i)
  {
    CHECK(s->plan.surface_more[i][2] == s->plan.surface_more[i][3]);
  }
  s->surface.end = s->end;
  s->surface.edge_depth = s->edge_depth;
  s->surface.edge_rgba = s->edge_rgba;
  describe(s);
  CHECK(s->plan.layers == 1);
  int open = 0;
  for (int i = 0; i < PIXELS; ++i)
  {
    const float* const at = s->plan.surface[i];
    const float* const more = s->plan.surface_more[i];
    const int blocks = s->depth[i] < INFINITY, ends = s->end[i] < INFINITY;
    CHECK((at[2] < INFINITY) == blocks && (more[0] == 1) == blocks && more[2] == s->depth[i]);
    CHECK((at[1] < INFINITY) == ends && at[0] == slices_of(s, s->end[i]) && more[3] == s->end[i]);
    open += blocks && !ends;
  }
  CHECK(open > 20);
  free_scene(s);
}

int main(void)
{
  layers_of_a_pixel_are_sorted_and_none_is_lost();
  rectangles_hold_all_layers_and_their_light();
  a_surface_blocks_where_it_is_and_receives_where_rays_end();
  return chi_test_report();
}
