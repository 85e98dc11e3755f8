/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* A frame in the words of chi_occlusion_plan.h. */

#include "chi_occlusion_describe.h"
#include "chi_components_internal.h"
#include "chi_mask_internal.h"
#include "chi_occlusion_march.h"

#include <math.h>
#include <string.h>

enum
{
  BLOCK = 8, /* slabs that share a footprint */
  CELL = 32, /* pixels */
  RECTS = 7, /* a slab */
  SURFACE_PLANES = 4,
  SURFACE_FLOATS = 8 /* a pixel: surface and surface_more */
};

static const chi_rect nothing = { 0, 0, 0, 0 };

static chi_rect meet(chi_rect a, chi_rect b)
{
  const chi_rect r = { chi_greater(a.x0, b.x0), chi_greater(a.y0, b.y0), chi_lesser(a.x1, b.x1),
    chi_lesser(a.y1, b.y1) };
  return chi_rect_is_empty(r) ? nothing : r;
}

/* Every point moved by any vector from low to high. */
static chi_rect spread(chi_rect r, const int32_t low[2], const int32_t high[2])
{
  return chi_rect_is_empty(r)
    ? nothing
    : (chi_rect){ r.x0 + low[0], r.y0 + low[1], r.x1 + high[0], r.y1 + high[1] };
}

_Static_assert((int)CHI_PLAN_DIRECTIONS == (int)CHI_MAX_ORDINATES &&
    (int)CHI_PLAN_VICINITY == (int)CHI_MAX_VICINITY_SAMPLES,
  "the plan has room for what the engine has");

static void describe_scene(chi_occlusion_plan* plan, const chi_scene* s)
{
  plan->width = s->width;
  plan->height = s->height;
  plan->light_scale = s->scale;
  plan->light_width = s->light_width;
  plan->light_height = s->light_height;
  plan->parallel = s->parallel;
  memcpy(plan->origin, s->origin, sizeof plan->origin);
  memcpy(plan->axis, s->axis, sizeof plan->axis);
  memcpy(plan->along_x, s->along_x, sizeof plan->along_x);
  memcpy(plan->along_y, s->along_y, sizeof plan->along_y);
  memcpy(plan->box_low, s->box_low, sizeof plan->box_low);
  memcpy(plan->box_high, s->box_high, sizeof plan->box_high);
  memcpy(plan->clip, s->clip, sizeof plan->clip);
  plan->clip_count = s->clips;
  plan->slope_x = s->slope_x;
  plan->slope_dx = s->slope_dx;
  plan->slope_y = s->slope_y;
  plan->slope_dy = s->slope_dy;
  plan->start = s->start;
  plan->slice = s->slice;
  plan->slab = s->slab;
  plan->group = s->group;
  plan->slabs = s->slabs;
  plan->volume_begin = s->volume_begin;
  plan->volume_end = s->volume_end;
  plan->bias = s->bias;
  plan->sample_bias = s->sample_bias;
  plan->ring = chi_scene_ring(s);
  plan->directions = s->directions;
  for (int k = 0; k < s->directions; ++k)
  {
    plan->direction[k][0] = s->tangent[0][k];
    plan->direction[k][1] = s->tangent[1][k];
    plan->share[k] = s->weight[k];
  }
  plan->light_pixels[0] = s->pixels_x;
  plan->light_pixels[1] = s->pixels_y;
  plan->published = s->published;
  plan->path[0] = (float)s->light[0].slope[0];
  plan->path[1] = (float)s->light[0].slope[1];
  plan->channels = s->channels;
  for (int c = 0; c < 3; ++c)
  {
    plan->channel_of[c] = s->channel_of[c];
  }
  for (int c = 0; c < s->channels; ++c)
  {
    chi_plan_channel* const channel = plan->channel + c;
    channel->attenuation = s->factor[c];
    channel->mean_length = s->mean_length * s->factor[c];
    channel->thin = CHI_THIN / channel->mean_length;
  }
  for (int i = 0; i < 3; ++i)
  {
    chi_light_weights(s->scale, 0.25 * (i - 1) * (s->scale == 1 ? 0 : 1), plan->light_weight[i]);
  }
}

static void describe_volume(
  chi_occlusion_plan* plan, const chi_bricks* bricks, const chi_classification* c, float color_step)
{
  static const chi_type type[] = { CHI_U8, CHI_I16, CHI_U16, CHI_F32 }; /* by fetch */
  _Static_assert(sizeof(chi_plan_entry) == sizeof(chi_plan_entry) &&
      offsetof(chi_plan_entry, half_slope) == offsetof(chi_plan_entry, half_slope),
    "the plan hands out the kernels' table");
  plan->scalars = bricks->scalars;
  plan->type = type[bricks->fetch];
  plan->nearest = bricks->nearest;
  memcpy(plan->dimensions, bricks->dimensions, sizeof plan->dimensions);
  memcpy(plan->bricks, bricks->count, sizeof plan->bricks);
  plan->brick_edge = 8;
  plan->table_base = c->base;
  plan->table_scale = c->scale;
  plan->table_offset = c->offset;
  plan->quantum = c->quantum;
  plan->entries = c->entries;
  plan->table_entries = c->table_entries;
  plan->table = (const chi_plan_entry*)c->sigma.data;
  plan->rgba = (const float(*)[4])c->rgba.data;
  plan->occupied = (const uint8_t*)c->occupied.data;
  _Static_assert(sizeof(chi_plan_color) == sizeof(chi_plan_color) &&
      offsetof(chi_plan_color, rgb) == offsetof(chi_plan_color, rgb),
    "the plan hands out the kernels' table");
  plan->colors = (const chi_plan_color*)c->colors.data;
  plan->color_step = color_step;
  plan->color_worth = CHI_COLOR_WORTH;
  plan->color_thin = CHI_COLOR_THIN;
  plan->color_parts = CHI_COLOR_PARTS;
  plan->color_steps = CHI_COLOR_STEPS;
  plan->color_even = CHI_COLOR_EVEN;
}

/* Jobs over blocks of slabs, and over rows of the picture. */
typedef struct describe_job
{
  const chi_exec* exec;
  const chi_scene* scene;
  const chi_bricks* bricks;
  const chi_classification* classification;
  const chi_occlusion_frame* frame;
  chi_plan_keep* keep;
  float* planes; /* [SURFACE_PLANES][height][width] */
  chi_rect* samples;
} describe_job;

/* Whether anything visible may lie in a frustum of pixels x0 ... x1 - 1 and slabs [first, last). */
static int cell_is_visible(const describe_job* it, double first, double last, int x0, int y0)
{
  const chi_scene* const s = it->scene;
  const double z[2] = { chi_scene_depth(s, first), chi_scene_depth(s, last) };
  const double x[2] = { x0, x0 + CELL - 1 }, y[2] = { y0, y0 + CELL - 1 };
  double low[3], high[3], p[8][3];
  for (int a = 0; a < 3; ++a)
  {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (int corner = 0; corner < 8; ++corner)
    {
      const double depth = z[corner >> 2];
      const double across = x[corner & 1] * s->along_x[a] + y[corner >> 1 & 1] * s->along_y[a];
      p[corner][a] = s->origin[a] + depth * s->axis[a] + (s->parallel ? 1 : depth) * across;
      low[a] = fmin(low[a], p[corner][a]);
      high[a] = fmax(high[a], p[corner][a]);
    }
    if (!(high[a] >= s->box_low[a] && low[a] <= s->box_high[a]))
    {
      return 0;
    }
  }
  for (int k = 0; k < s->clips; ++k)
  {
    const double* const c = s->clip[k];
    double most = -INFINITY;
    for (int corner = 0; corner < 8; ++corner)
    {
      most = fmax(most, c[0] * p[corner][0] + c[1] * p[corner][1] + c[2] * p[corner][2] + c[3]);
    }
    if (most < 0)
    {
      return 0;
    }
  }
  if (chi_crop_share(s, (const double(*)[3])p) == CHI_CUT_ALL)
  {
    return 0;
  }
  int64_t all;
  return !(chi_skip_kinds(it->frame->params) & CHI_SKIP_BRICKS) ||
    chi_classification_count(it->classification, it->bricks, low, high, &all) > 0;
}

static void find_samples(void* data, size_t begin, size_t end)
{
  const describe_job* const it = (const describe_job*)data;
  const chi_scene* const s = it->scene;
  for (size_t block = begin; block < end && !chi_is_cancelled(it->exec); ++block)
  {
    const int64_t first =
      (int64_t)block * BLOCK > s->volume_begin ? (int64_t)block * BLOCK : s->volume_begin;
    const int64_t last =
      (int64_t)(block + 1) * BLOCK < s->volume_end ? (int64_t)(block + 1) * BLOCK : s->volume_end;
    chi_rect found = nothing;
    for (int32_t y = 0; y < s->height && first < last; y += CELL)
    {
      for (int32_t x = 0; x < s->width; x += CELL)
      {
        const chi_rect cell = { x, y, chi_lesser(x + CELL, s->width),
          chi_lesser(y + CELL, s->height) };
        if (cell_is_visible(it, (double)first, (double)last, x, y))
        {
          found = chi_rect_join(found, cell);
        }
      }
    }
    for (int64_t g = (int64_t)block * BLOCK; g < (int64_t)(block + 1) * BLOCK && g < s->slabs; ++g)
    {
      it->samples[g] = g >= first && g < last ? found : nothing;
    }
  }
}

float chi_plan_beyond(const chi_scene* s, double plane)
{
  const double behind = (double)s->slabs - 0.5;
  return s->slabs > 0 && plane + 0.5 > behind
    ? (float)chi_scene_shift(s, chi_scene_depth(s, behind), chi_scene_depth(s, plane + 0.5))
    : 0;
}

/* Four planes of chi_surface_intervals into the layout of the plan. */
static void place_surfaces(void* data, size_t begin, size_t end)
{
  const describe_job* const it = (const describe_job*)data;
  const chi_scene* const s = it->scene;
  const size_t width = (size_t)s->width, count = width * (size_t)s->height;
  const chi_surface_view* const view = it->frame->surface;
  float(*const surface)[4] = (float(*)[4])it->keep->surface.data;
  float(*const more)[4] = surface + count;
  for (size_t i = begin * width; i < end * width; ++i)
  {
    const float slices = it->planes[i], receiver = it->planes[count + i];
    const float from = it->planes[2 * count + i], to = it->planes[3 * count + i];
    const int any = receiver < INFINITY, blocks = from < INFINITY;
    const double plane = any ? chi_light_receiver_plane(s, (double)receiver) : INFINITY;
    surface[i][0] = slices;
    surface[i][1] = (float)plane;
    surface[i][2] = from;
    surface[i][3] = to;
    more[i][0] = blocks ? chi_geometry_opacity(it->frame->params, from, to) : 0;
    more[i][1] = any ? chi_plan_beyond(s, plane) : 0;
    more[i][2] = blocks ? view->depth[i] : INFINITY;
    more[i][3] = any ? (view->end ? view->end : view->depth)[i] : INFINITY;
  }
}

void chi_plan_receive(const chi_occlusion_plan* plan, float plane, int32_t x, int32_t y,
  chi_rect* receivers, chi_rect* beyond)
{
  if (plan->slabs == 0 || !(plane > -1 && plane < INFINITY))
  {
    return;
  }
  if (plane > (float)(plan->slabs - 1))
  {
    chi_rect_add(beyond, x, y);
  }
  else
  {
    const int64_t above = (int64_t)floorf(plane) + 1;
    chi_rect_add(receivers + (above < plan->slabs ? above : plan->slabs - 1), x, y);
  }
}

/* Which slabs have surfaces that block in them, or receive from their planes. */
static void bound_surfaces(
  chi_occlusion_plan* plan, chi_rect* blockers, chi_rect* receivers, chi_rect* carried)
{
  const int64_t slabs = plan->slabs;
  for (int32_t y = 0; y < plan->height; ++y)
  {
    for (int32_t x = 0; x < plan->width; ++x)
    {
      const float* const at = plan->surface[(size_t)y * (size_t)plan->width + (size_t)x];
      if (at[2] < INFINITY)
      {
        const int64_t from = at[2] < (float)slabs ? (int64_t)at[2] : slabs;
        const int64_t to = at[3] < (float)slabs ? (int64_t)at[3] : slabs - 1;
        const int is_long = to - from > BLOCK; /* taken to the last slab, to spare the loop */
        for (int64_t g = from; g <= to && !is_long; ++g)
        {
          chi_rect_add(blockers + g, x / plan->light_scale, y / plan->light_scale);
        }
        if (is_long)
        {
          chi_rect_add(carried + from, x / plan->light_scale, y / plan->light_scale);
        }
      }
      chi_plan_receive(plan, at[1], x, y, receivers, &plan->beyond);
    }
  }
  for (int64_t g = 0; g < slabs; ++g)
  {
    carried[g] = g ? chi_rect_join(carried[g], carried[g - 1]) : carried[g];
    blockers[g] = chi_rect_join(blockers[g], carried[g]);
  }
}

static chi_rect to_light(const chi_occlusion_plan* plan, chi_rect r)
{
  const int32_t s = plan->light_scale;
  return chi_rect_is_empty(r)
    ? nothing
    : (chi_rect){ r.x0 / s, r.y0 / s, (r.x1 - 1) / s + 1, (r.y1 - 1) / s + 1 };
}

/* Least and greatest shift of a slab. */
static void shift_range(
  const chi_occlusion_plan* plan, int64_t slab, int32_t low[2], int32_t high[2])
{
  low[0] = low[1] = INT32_MAX;
  high[0] = high[1] = INT32_MIN;
  for (int k = 0; k < plan->directions; ++k)
  {
    const chi_plan_shift* const shift = plan->shift + slab * plan->directions + k;
    low[0] = chi_lesser(low[0], shift->x);
    low[1] = chi_lesser(low[1], shift->y);
    high[0] = chi_greater(high[0], shift->x + 1);
    high[1] = chi_greater(high[1], shift->y + 1);
  }
}

/*
 * Light differs from 1 where something has blocked it in this slab, or where the shift brings such
 * light from the slab before; it matters where samples or surfaces read its planes, or where the
 * next slab's shift takes it from.
 */
static void bound_light(chi_occlusion_plan* plan, chi_rect* light, int keep_all)
{
  const chi_rect whole = { 0, 0, plan->light_width, plan->light_height };
  const int32_t pixel[2][2] = { { -1, -1 }, { 1, 1 } }; /* read by the weights of light pixels */
  chi_rect dark = nothing;
  for (int64_t g = 0; g < plan->slabs; ++g)
  {
    int32_t low[2], high[2];
    shift_range(plan, g, low, high);
    /* q reads q + shift: what is at p comes to p - shift */
    const int32_t down[2] = { -high[0], -high[1] }, up[2] = { -low[0], -low[1] };
    dark = chi_rect_join(
      dark, spread(dark, down, up)); /* the other buffer's light stays until overwritten */
    dark = chi_rect_join(dark, to_light(plan, plan->samples[g]));
    dark = meet(chi_rect_join(dark, plan->blockers[g]), whole);
    light[g] = keep_all ? whole : dark;
  }
  chi_rect wanted =
    chi_rect_is_empty(chi_rect_join(plan->beyond, plan->layers_beyond)) ? nothing : whole;
  chi_rect later =
    nothing; /* samples of later slabs: they read planes that lie up to a ring back */
  for (int64_t g = plan->slabs - 1; g >= 0 && !keep_all; --g)
  {
    for (int64_t k = 0; k < 2 && g + k < plan->slabs; ++k)
    {
      const chi_rect receivers =
        chi_rect_join(plan->receivers[g + k], plan->layer_receivers[g + k]);
      wanted = chi_rect_join(
        wanted, spread(to_light(plan, receivers), pixel[0], pixel[1])); /* planes g, g - 1 */
    }
    wanted = meet(chi_rect_join(wanted, spread(to_light(plan, later), pixel[0], pixel[1])), whole);
    light[g] = meet(light[g], wanted);
    int32_t low[2], high[2];
    shift_range(plan, g, low, high);
    wanted = spread(wanted, low, high);
    later = chi_rect_join(later, plan->samples[g]);
  }
}

static void describe_vicinity(
  chi_occlusion_plan* plan, const chi_scene* scene, const chi_occlusion_params* params)
{
  plan->combine = params->combine;
  plan->lights = scene->lights;
  for (int light = 0; light < scene->lights; ++light)
  {
    double disc[CHI_MAX_VICINITY_SAMPLES][2];
    plan->vicinity_samples = chi_vicinity_disc(scene, params, light, disc);
    plan->vicinity_radius[light] = chi_vicinity_radius(scene, params, light);
    plan->vicinity_share[light] = scene->light[light].share;
    for (int k = 0; k < plan->vicinity_samples; ++k)
    {
      plan->vicinity_disc[light][k][0] = (float)disc[k][0];
      plan->vicinity_disc[light][k][1] = (float)disc[k][1];
    }
  }
  plan->vicinity_plane_rule = !(params->vicinity_bias > 0);
  plan->vicinity_distance = params->vicinity_distance;
  plan->vicinity_bias = params->vicinity_bias;
  plan->vicinity_pixels[0] = scene->pixels_x * scene->scale;
  plan->vicinity_pixels[1] = scene->pixels_y * scene->scale;
  plan->vicinity_curvature = CHI_VICINITY_CURVATURE;
  plan->vicinity_rise = CHI_VICINITY_RISE;
  plan->vicinity_fade = CHI_VICINITY_FADE;
}

static chi_status describe_surfaces(describe_job* it, chi_occlusion_plan* plan, chi_rect* blockers,
  chi_rect* receivers, chi_rect* carried)
{
  const chi_scene* const s = it->scene;
  const size_t width = (size_t)s->width, count = width * (size_t)s->height;
  if (!chi_buffer_reserve(it->exec, &it->keep->surface, count, SURFACE_FLOATS * sizeof(float)) ||
    !chi_buffer_reserve(it->exec, &it->keep->planes, count, SURFACE_PLANES * sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  it->planes = (float*)it->keep->planes.data;
  chi_status status =
    chi_surface_intervals(it->exec, s, it->frame->surface, it->frame->params->geometry_thickness,
      width, width, it->planes, it->planes + count, it->planes + 2 * count, it->planes + 3 * count);
  status = status == CHI_OK ? chi_for(it->exec, (size_t)s->height, place_surfaces, it) : status;
  if (status == CHI_OK)
  {
    plan->surface = (const float(*)[4])it->keep->surface.data;
    plan->surface_more = plan->surface + count;
    bound_surfaces(plan, blockers, receivers, carried);
  }
  return status;
}

static chi_status describe_reduction(const chi_exec* exec, chi_plan_keep* keep,
  const chi_scene* scene, const chi_occlusion_frame* whole)
{
  const int guided = chi_reduction_of(whole) > 1 && whole->surface;
  const size_t pixels = (size_t)whole->camera->width * (size_t)whole->camera->height;
  if (guided && !chi_buffer_reserve(exec, &keep->guide, pixels, sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  return chi_reduction_describe(
    exec, whole, scene, guided ? (float*)keep->guide.data : NULL, &keep->plan);
}

chi_status chi_plan_fill(const chi_exec* exec, chi_plan_keep* keep, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* whole, const chi_occlusion_frame* frame)
{
  chi_occlusion_plan* const plan = &keep->plan;
  const size_t slabs = (size_t)scene->slabs, directions = (size_t)scene->directions;
  memset(plan, 0, sizeof *plan);
  plan->struct_size = sizeof *plan;
  plan->features = chi_occlusion_features(whole);
  if (!chi_buffer_reserve(exec, &keep->rects, RECTS * slabs + 1, sizeof(chi_rect)) ||
    !chi_buffer_reserve(exec, &keep->shifts, slabs * directions + 1, sizeof(chi_plan_shift)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_rect* const samples = (chi_rect*)keep->rects.data;
  chi_rect *const blockers = samples + slabs, *const light = blockers + slabs,
                  *const receivers = light + slabs, *const carried = receivers + slabs,
                  *const spots = carried + slabs, *const layer_receivers = spots + slabs;
  memset(samples, 0, RECTS * slabs * sizeof(chi_rect));
  describe_scene(plan, scene);
  describe_vicinity(plan, scene, frame->params);
  plan->strength = frame->params->strength;
  const int skip = chi_skip_kinds(frame->params);
  plan->saturated = skip & CHI_SKIP_SATURATED_RAYS ? (double)CHI_SATURATED : 0;
  plan->use_bricks = (skip & CHI_SKIP_BRICKS) != 0;
  plan->samples = samples;
  plan->blockers = blockers;
  plan->light = light;
  plan->receivers = receivers;
  plan->layer_spots = spots;
  plan->layer_receivers = layer_receivers;

  chi_frame_light fields;
  chi_frame_fields(frame, &fields);
  plan->fields = fields.fields;
  plan->surface_field = fields.surface_field;
  for (int f = 0; f < 2; ++f)
  {
    plan->field[f] = (chi_plan_field){ fields.volume[f], fields.geometry[f] };
  }
  chi_plan_shift* const shift = (chi_plan_shift*)keep->shifts.data;
  plan->shift = shift;
  for (size_t i = 0; i < slabs * directions; ++i)
  {
    int32_t offset[2];
    chi_scene_step(
      scene, (int64_t)(i / directions), (int)(i % directions), offset, shift[i].weight);
    shift[i].x = offset[0];
    shift[i].y = offset[1];
  }

  describe_job job = { exec, scene, bricks, classification, frame, keep, NULL, samples };
  chi_status status = CHI_OK;
  if (frame->volume)
  {
    describe_volume(
      plan, bricks, classification, chi_march_color_step(scene, classification, frame->params));
    int shaded = 0;
    if (!chi_shading_prepare(&keep->shading, frame, bricks, classification, &shaded))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    plan->shading = shaded ? &keep->shading : NULL;
    plan->cut = chi_cut_prepare(&keep->cut, scene, classification->mask) ? &keep->cut : NULL;
    if (frame->components)
    {
      chi_components_prepare(
        keep->set, frame->components, (int)frame->volume->type, &keep->components);
      plan->components = &keep->components;
    }
    plan->labels = classification->mask ? classification->mask->labels : NULL;
    status = chi_for(exec, (slabs + BLOCK - 1) / BLOCK, find_samples, &job);
  }
  if (status == CHI_OK && frame->surface)
  {
    status = describe_surfaces(&job, plan, blockers, receivers, carried);
  }
  if (status == CHI_OK)
  {
    status = chi_plan_layers(exec, keep, scene, frame, spots, layer_receivers);
  }
  const int light_kinds = CHI_SKIP_SATURATED_LIGHT | CHI_SKIP_UNREACHED_LIGHT;
  bound_light(plan, light, (skip & light_kinds) != light_kinds);
  return status == CHI_OK ? describe_reduction(exec, keep, scene, whole) : status;
}

void chi_plan_free(const chi_exec* exec, chi_plan_keep* keep)
{
  chi_buffer_free(exec, &keep->shifts);
  chi_buffer_free(exec, &keep->rects);
  chi_buffer_free(exec, &keep->surface);
  chi_buffer_free(exec, &keep->planes);
  chi_buffer_free(exec, &keep->guide);
  chi_buffer_free(exec, &keep->layers);
}
