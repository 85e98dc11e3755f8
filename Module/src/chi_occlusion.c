/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_components_internal.h"
#include "chi_mask_internal.h"
#include "chi_occlusion_describe.h"
#include "chi_occlusion_frame.h"

#include <math.h>
#include <string.h>

/* What a stage was made from; it runs again only where this differs. */
typedef struct volume_key
{
  const void* scalars;
  uint64_t version;
  size_t stride, dimensions[3];
  int64_t type, interpolation;
  int64_t components, dependent;
} volume_key;

typedef struct mask_key
{
  const void* arrays[4];
  uint64_t version;
  size_t stride, value_count;
  int64_t type, is_cell_data, point_bits, cell_bits, reach;
} mask_key;

typedef struct transfer_key
{
  const void* rgb;
  const void* opacity;
  uint64_t version;
  size_t count, table_count;
  double range[2], unit_distance;
  int64_t dilate;
  const void* gradient_opacity;
  size_t gradient_count;
  double gradient_end;
  const void* plane;
  const void* y_samples;
  size_t plane_count[2];
  double plane_range[2];
} transfer_key;

typedef struct frame_key
{
  double world_to_eye[16], window[4], near_depth;
  double index_to_world[16];
  double cone_angle, strength, sample_distance, bias, thickness;
  double geometry_opacity, vicinity_distance, vicinity_bias, coarsening;
  double clip_planes[4 * CHI_MAX_CLIP_PLANES], crop_planes[24];
  const void* depth;
  const void* layers[2];
  const void* edges[3];
  uint64_t surface_version, layers_version;
  double lights[11]; /* directions, the second one's cone and share, attenuation */
  chi_shading_key shading;
  int64_t integers[17];
  int64_t color_integration;
} frame_key;

struct chi_occlusion
{
  chi_bricks bricks;
  chi_mask mask;
  chi_classification classification;
  chi_component_set components;
  chi_component_key component_key;
  chi_march march;
  chi_reduction reduction;
  chi_buffer rgba, visibility;
  volume_key volume;
  mask_key masked;
  transfer_key transfer;
  frame_key frame;
  int has_bricks, has_classification, has_frame;
  int32_t width, height;
  size_t colors; /* of the visibility: 1, or 3 interleaved with their mean behind them all */
  chi_occlusion_stats stats;
  /* of chi_occlusion_describe */
  chi_plan_keep plan;
  frame_key planned;
  int has_plan;
  uint64_t versions[4]; /* of the frame, the samples, the tables, the mask */
};

void chi_occlusion_default_params(chi_occlusion_params* params)
{
  if (params)
  {
    *params = (chi_occlusion_params){ .struct_size = sizeof *params,
      .method = CHI_OCCLUSION_ORDINATES,
      .directions = 16,
      .half_size = 1,
      .interactions = CHI_ALL_INTERACTIONS,
      .cone_angle_rad = 0.78539816339744831,
      .strength = 1,
      .bias = -1,
      .skip = 1,
      .combine = CHI_COMBINE_PRODUCT,
      .geometry_opacity = 1,
      .vicinity_samples = 32 };
  }
}

chi_status chi_occlusion_create(const chi_exec* exec, chi_occlusion** occlusion)
{
  if (!occlusion)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *occlusion = (chi_occlusion*)chi_alloc(exec, 1, sizeof **occlusion);
  if (!*occlusion)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*occlusion, 0, sizeof **occlusion);
  return CHI_OK;
}

void chi_occlusion_destroy(const chi_exec* exec, chi_occlusion* occlusion)
{
  if (!occlusion)
  {
    return;
  }
  chi_bricks_free(exec, &occlusion->bricks);
  chi_mask_free(exec, &occlusion->mask);
  chi_classification_free(exec, &occlusion->classification);
  chi_components_free(exec, &occlusion->components);
  chi_march_free(exec, &occlusion->march);
  chi_reduction_free(exec, &occlusion->reduction);
  chi_buffer_free(exec, &occlusion->rgba);
  chi_buffer_free(exec, &occlusion->visibility);
  chi_plan_free(exec, &occlusion->plan);
  chi_free(exec, occlusion, 1, sizeof *occlusion);
}

static volume_key key_of_volume(const chi_volume_view* v)
{
  volume_key key;
  memset(&key, 0, sizeof key);
  key.scalars = v->scalars;
  key.version = v->version;
  key.stride = v->stride;
  memcpy(key.dimensions, v->dimensions, sizeof key.dimensions);
  key.type = v->type;
  key.interpolation = v->interpolation;
  return key;
}

static mask_key key_of_mask(const chi_mask_view* m, const chi_volume_view* volume, int reach)
{
  mask_key key;
  memset(&key, 0, sizeof key);
  if (m && (m->values || m->point_flags || m->cell_flags))
  {
    key.arrays[0] = m->values;
    key.arrays[1] = m->point_flags;
    key.arrays[2] = m->cell_flags;
    key.arrays[3] = m->table_of_value;
    key.value_count = m->value_count;
    key.version = m->version;
    key.stride = m->stride;
    key.type = m->type;
    key.is_cell_data = volume->is_cell_data;
    key.point_bits = m->point_bits;
    key.cell_bits = m->cell_bits;
    key.reach = reach;
  }
  return key;
}

static transfer_key key_of_transfer(const chi_transfer_view* t, int dilate)
{
  transfer_key key;
  memset(&key, 0, sizeof key);
  key.rgb = t->rgb;
  key.opacity = t->opacity;
  key.version = t->version;
  key.count = t->count;
  key.table_count = t->table_count;
  memcpy(key.range, t->range, sizeof key.range);
  key.unit_distance = t->unit_distance;
  key.dilate = dilate;
  key.gradient_opacity = t->gradient_opacity;
  key.gradient_count = t->gradient_count;
  key.gradient_end = t->gradient_end;
  key.plane = t->plane;
  key.y_samples = t->y_samples;
  memcpy(key.plane_count, t->plane_count, sizeof key.plane_count);
  memcpy(key.plane_range, t->plane_range, sizeof key.plane_range);
  return key;
}

static frame_key key_of_frame(const chi_occlusion_frame* frame)
{
  const chi_camera* const c = frame->camera;
  const chi_occlusion_params* const p = frame->params;
  frame_key key;
  memset(&key, 0, sizeof key);
  memcpy(key.world_to_eye, c->world_to_eye, sizeof key.world_to_eye);
  memcpy(key.window, c->window, sizeof key.window);
  key.near_depth = c->near_depth;
  key.cone_angle = p->cone_angle_rad;
  key.strength = p->strength;
  key.sample_distance = p->sample_distance;
  key.bias = p->bias;
  key.thickness = p->geometry_thickness;
  key.geometry_opacity = p->geometry_opacity;
  key.vicinity_distance = p->vicinity_distance;
  key.vicinity_bias = p->vicinity_bias;
  key.coarsening = p->coarsening;
  memcpy(key.lights, p->light_direction, sizeof p->light_direction);
  memcpy(key.lights + 3, p->second_light_direction, sizeof p->second_light_direction);
  key.lights[6] = p->second_light_cone_angle_rad;
  key.lights[7] = p->second_light_share;
  for (int k = 0; k < 3; ++k)
  {
    key.lights[8 + k] = p->colored_attenuation ? p->attenuation[k] : 1;
  }
  if (frame->volume)
  {
    memcpy(key.index_to_world, frame->volume->index_to_world, sizeof key.index_to_world);
  }
  if (frame->clip_plane_count)
  {
    memcpy(key.clip_planes, frame->clip_planes, 4 * frame->clip_plane_count * sizeof(double));
  }
  if (frame->crop)
  {
    memcpy(key.crop_planes, frame->crop->planes, sizeof key.crop_planes);
  }
  chi_shading_make_key(&key.shading, frame->shading);
  if (frame->surface)
  {
    key.depth = frame->surface->depth;
    key.surface_version = frame->surface->version;
    key.edges[0] = frame->surface->end;
    key.edges[1] = frame->surface->edge_depth;
    key.edges[2] = frame->surface->edge_rgba;
  }
  if (frame->layers)
  {
    key.layers[0] = frame->layers->depth;
    key.layers[1] = frame->layers->rgba;
    key.layers_version = frame->layers->version;
  }
  const int64_t integers[] = { c->parallel, c->width, c->height, p->method, p->directions,
    p->half_size, p->interactions, p->skip, frame->volume != NULL, frame->surface != NULL,
    frame->volume ? frame->volume->is_cell_data : 0, p->combine, p->vicinity_samples,
    (int64_t)frame->clip_plane_count, frame->layers ? frame->layers->count : 0,
    frame->crop ? (int64_t)frame->crop->regions : -1, p->reduction };
  memcpy(key.integers, integers, sizeof integers);
  key.color_integration = p->color_integration;
  return key;
}

static void widen_extent(const float* depth, size_t count, double extent[2])
{
  for (size_t i = 0; i < count && depth; ++i)
  {
    const double z = (double)depth[i];
    if (z > 0 && z < INFINITY)
    {
      extent[0] = z < extent[0] ? z : extent[0];
      extent[1] = z > extent[1] ? z : extent[1];
    }
  }
}

/* Nearest and farthest surface depth; INFINITY and -INFINITY without any. */
static void surface_extent(const chi_occlusion_frame* frame, double extent[2])
{
  extent[0] = INFINITY;
  extent[1] = -INFINITY;
  const size_t count = (size_t)frame->camera->width * (size_t)frame->camera->height;
  if (frame->surface)
  {
    widen_extent(frame->surface->depth, count, extent);
    widen_extent(frame->surface->end, count, extent);
    widen_extent(frame->surface->edge_depth, count, extent);
  }
}

/* Bricks of margin by which occupancy grows, where slices lie more than a voxel apart: a segment
 * may then cross a brick in which neither of its ends lies. */
static int dilation(const chi_scene* scene)
{
  double step = 0;
  for (int a = 0; a < 3; ++a)
  {
    double axis = fabs(scene->axis[a]);
    if (!scene->parallel)
    {
      axis += fabs(scene->along_x[a]) * scene->width + fabs(scene->along_y[a]) * scene->height;
    }
    step = fmax(step, axis * scene->slice);
  }
  return step <= 2 ? 0 : step < 800 ? (int)((step - 2) / 8) + 1 : 100;
}

static chi_status prepare_volume(
  const chi_exec* exec, chi_occlusion* o, const chi_occlusion_frame* frame, const chi_scene* scene)
{
  const double t0 = chi_seconds();
  const chi_component_key components = chi_components_key(frame->components);
  const chi_volume_view own = chi_component_view(frame->volume, frame->components, 0);
  volume_key volume = key_of_volume(&own);
  volume.components = components.count;
  volume.dependent = components.dependent;
  chi_status status = CHI_OK;
  const int reuse = chi_skip_kinds(frame->params) & CHI_SKIP_UNCHANGED;
  o->stats.reused_bricks =
    reuse && o->has_bricks && memcmp(&volume, &o->volume, sizeof volume) == 0;
  if (!o->stats.reused_bricks)
  {
    o->has_bricks = o->has_classification = o->has_frame = o->has_plan = 0;
    ++o->versions[1];
    status = chi_bricks_build(exec, &o->bricks, &own);
    status = status == CHI_OK
      ? chi_components_build(exec, &o->components, frame->volume, frame->components)
      : status;
    o->volume = volume;
    o->has_bricks = status == CHI_OK;
  }
  const double t1 = chi_seconds();
  o->stats.seconds_bricks = t1 - t0;
  const int reach = dilation(scene);
  const mask_key masked = key_of_mask(frame->mask, frame->volume, reach);
  if (status == CHI_OK &&
    !(o->has_classification && memcmp(&masked, &o->masked, sizeof masked) == 0))
  {
    o->has_classification = o->has_frame = 0;
    ++o->versions[3];
    status = chi_mask_build(exec, &o->mask, &o->bricks, frame->volume, frame->mask, reach);
    o->masked = masked;
    o->classification.mask = o->mask.grids || o->mask.labels ? &o->mask : NULL;
  }
  const transfer_key transfer = key_of_transfer(frame->transfer, reach);
  o->stats.reused_classification = reuse && status == CHI_OK && o->has_classification &&
    memcmp(&transfer, &o->transfer, sizeof transfer) == 0 &&
    memcmp(&components, &o->component_key, sizeof components) == 0;
  if (status == CHI_OK && !o->stats.reused_classification)
  {
    o->has_classification = o->has_frame = o->has_plan = 0;
    ++o->versions[2];
    status = chi_classify_transfer(
      exec, &o->classification, &o->bricks, frame->transfer, (int)transfer.dilate);
    status = status == CHI_OK ? chi_components_classify(exec, &o->components, &o->classification,
                                  &o->bricks, frame->components, (int)transfer.dilate)
                              : status;
    if (status == CHI_OK)
    {
      chi_mask_apply(o->classification.mask, &o->bricks, &o->classification);
    }
    o->transfer = transfer;
    o->component_key = components;
    o->has_classification = status == CHI_OK;
  }
  o->stats.seconds_classification = chi_seconds() - t1;
  o->stats.non_finite_samples =
    o->bricks.non_finite + (frame->components ? o->components.non_finite : 0);
  o->stats.occupied_bricks = o->classification.occupied_bricks;
  o->stats.bricks = (int64_t)(o->bricks.count[0] * o->bricks.count[1] * o->bricks.count[2]);
  return status;
}

static chi_status build_scene(chi_scene* scene, const chi_occlusion_frame* frame)
{
  double extent[2];
  surface_extent(frame, extent);
  memset(scene, 0, sizeof *scene);
  return chi_scene_build(scene, frame, extent[0], extent[1]);
}

/* What both engines count of a scene. */
static void start_stats(chi_occlusion_stats* stats, const chi_scene* scene)
{
  *stats = (chi_occlusion_stats){ .struct_size = sizeof *stats };
  stats->sample_distance = scene->volume_end > scene->volume_begin ? scene->slice : 0;
  for (int k = 0; k < scene->lights; ++k)
  {
    stats->moved_lights += scene->light[k].moved;
  }
}

chi_status chi_occlusion_render(
  const chi_exec* exec, chi_occlusion* o, const chi_occlusion_frame* given)
{
  chi_own_frame own;
  const chi_occlusion_frame* const frame = &own.frame;
  chi_status status = o ? chi_frame_check(&own, given) : CHI_ERROR_INVALID_ARGUMENT;
  if (status != CHI_OK)
  {
    return status;
  }
  const double t0 = chi_seconds();
  const int reduction = chi_reduction_of(frame);
  const chi_occlusion_frame* drawn = frame;
  if (reduction > 1)
  {
    status = chi_reduce(exec, &o->reduction, frame, reduction);
    drawn = &o->reduction.frame;
    o->has_frame = status == CHI_OK ? o->has_frame : 0;
  }
  chi_scene scene;
  if (status == CHI_OK)
  {
    status = build_scene(&scene, drawn);
  }
  if (status != CHI_OK)
  {
    return status;
  }
  start_stats(&o->stats, &scene);
  if (frame->volume)
  {
    status = prepare_volume(exec, o, frame, &scene);
  }
  const frame_key key = key_of_frame(frame);
  const int64_t reused = o->stats.reused_bricks + o->stats.reused_classification;
  o->stats.skipped[SKIPPED_UNCHANGED] = reused;
  if (status == CHI_OK && o->has_frame && !frame->probes &&
    (chi_skip_kinds(frame->params) & CHI_SKIP_UNCHANGED) &&
    memcmp(&key, &o->frame, sizeof key) == 0)
  {
    o->stats.reused = 1;
    o->stats.skipped[SKIPPED_UNCHANGED] = reused + 1;
    o->stats.seconds_total = chi_seconds() - t0;
    return CHI_OK;
  }
  o->has_frame = 0;
  const size_t pixels = (size_t)frame->camera->width * (size_t)frame->camera->height;
  if (status == CHI_OK &&
    (!chi_buffer_reserve(exec, &o->rgba, pixels, 4 * sizeof(float)) ||
      (frame->surface &&
        !chi_buffer_reserve(exec, reduction > 1 ? &o->reduction.rgba : &o->rgba,
          chi_march_picture_floats(&scene), sizeof(float))) ||
      !chi_buffer_reserve(
        exec, &o->visibility, pixels * (scene.channels > 1 ? 4 : 1), sizeof(float))))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_march_result result = { 0 };
  if (status == CHI_OK)
  {
    o->march.components = &o->components;
    chi_buffer* const rgba = reduction > 1 ? &o->reduction.rgba : &o->rgba;
    chi_buffer* const visibility = reduction > 1 ? &o->reduction.visibility : &o->visibility;
    status = chi_march_run(exec, &o->march, &scene, &o->bricks, &o->classification, drawn,
      (float*)rgba->data, (float*)visibility->data, &result);
  }
  if (status == CHI_OK && reduction > 1)
  {
    status = chi_enlarge(exec, &o->reduction, frame, &scene, reduction, (float*)o->rgba.data,
      (float*)o->visibility.data);
  }
  if (status == CHI_OK)
  {
    o->frame = key;
    o->has_frame = 1;
    o->colors = scene.channels > 1 ? 3 : 1;
    o->width = frame->camera->width;
    o->height = frame->camera->height;
  }
  o->stats.slices = (scene.volume_end - scene.volume_begin) * scene.group;
  o->stats.light_slices = scene.slabs;
  o->stats.samples = result.samples;
  o->stats.skipped_samples = result.skipped_samples;
  o->stats.light_updates = result.light_updates;
  o->stats.skipped_light_updates = result.skipped_light_updates;
  o->stats.light_bytes = result.light_bytes;
  memcpy(o->stats.skipped, result.skipped, sizeof o->stats.skipped);
  o->stats.skipped[SKIPPED_UNCHANGED] = reused;
  o->stats.seconds_visible_set = result.seconds_visible_set;
  o->stats.seconds_slices = result.seconds_slices;
  o->stats.seconds_samples = result.seconds_samples;
  o->stats.seconds_light = result.seconds_light;
  o->stats.seconds_total = chi_seconds() - t0;
  return status;
}

chi_status chi_occlusion_describe(const chi_exec* exec, chi_occlusion* o,
  const chi_occlusion_frame* given, chi_occlusion_plan* plan)
{
  chi_own_frame own;
  const chi_occlusion_frame* const frame = &own.frame;
  chi_status status = o && plan ? chi_frame_check(&own, given) : CHI_ERROR_INVALID_ARGUMENT;
  if (status != CHI_OK)
  {
    return status;
  }
  const double t0 = chi_seconds();
  const int reduction = chi_reduction_of(frame);
  const chi_occlusion_frame* drawn = frame;
  if (reduction > 1)
  {
    status = chi_reduce(exec, &o->reduction, frame, reduction);
    drawn = &o->reduction.frame;
  }
  chi_scene scene;
  status = status == CHI_OK ? build_scene(&scene, drawn) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  start_stats(&o->stats, &scene);
  if (frame->volume)
  {
    status = prepare_volume(exec, o, frame, &scene);
  }
  const frame_key key = key_of_frame(frame);
  const int64_t stages = o->stats.reused_bricks + o->stats.reused_classification;
  o->stats.reused = status == CHI_OK && o->has_plan &&
    (chi_skip_kinds(frame->params) & CHI_SKIP_UNCHANGED) &&
    memcmp(&key, &o->planned, sizeof key) == 0;
  o->stats.skipped[SKIPPED_UNCHANGED] = stages + o->stats.reused;
  if (status == CHI_OK && !o->stats.reused)
  {
    const double t1 = chi_seconds();
    o->has_plan = 0;
    ++o->versions[0];
    o->plan.set = &o->components;
    status = chi_plan_fill(exec, &o->plan, &scene, &o->bricks, &o->classification, frame, drawn);
    o->planned = key;
    o->has_plan = status == CHI_OK;
    o->stats.seconds_visible_set = chi_seconds() - t1;
  }
  if (status == CHI_OK)
  {
    *plan = o->plan.plan;
    plan->frame_version = o->versions[0];
    plan->volume_version = o->versions[1];
    plan->table_version = o->versions[2];
    plan->mask_version = o->versions[3];
  }
  o->stats.slices = (scene.volume_end - scene.volume_begin) * scene.group;
  o->stats.light_slices = scene.slabs;
  o->stats.seconds_total = chi_seconds() - t0;
  return status;
}

static void clear_depths(void* data, size_t begin, size_t end)
{
  for (size_t i = begin; i < end; ++i)
  {
    ((float*)data)[i] = INFINITY;
  }
}

chi_status chi_occlusion_find_depth(const chi_exec* exec, chi_occlusion* o,
  const chi_occlusion_frame* given, double alpha, float* depth)
{
  chi_own_frame own;
  const chi_occlusion_frame* const frame = &own.frame;
  chi_status status = o && depth && alpha > 0 && alpha < 1 ? chi_frame_check(&own, given)
                                                           : CHI_ERROR_INVALID_ARGUMENT;
  if (status != CHI_OK)
  {
    return status;
  }
  const chi_occlusion_stats stats = o->stats;
  chi_occlusion_params params = *frame->params;
  params.strength = 0; /* the plain ray cast */
  params.colored_attenuation = 0;
  params.skip |= CHI_SKIP_SATURATED_RAYS | CHI_SKIP_BEHIND_GEOMETRY;
  chi_occlusion_frame plain = *frame;
  plain.params = &params;
  plain.layers = NULL;
  plain.probes = NULL;
  chi_surface_view surface;
  if (frame->surface)
  {
    surface = *frame->surface;
    surface.edge_depth = surface.edge_rgba = NULL;
    plain.surface = &surface;
  }
  chi_scene scene;
  status = build_scene(&scene, &plain);
  const size_t pixels = status == CHI_OK ? (size_t)scene.width * (size_t)scene.height : 0;
  status = status == CHI_OK ? chi_for(exec, pixels, clear_depths, depth) : status;
  /* The march keeps its surfaces where the picture comes to lie; the last one stands, so it takes
   * the memory of reduced pictures. */
  if (status == CHI_OK && frame->surface &&
    (!chi_buffer_reserve(
       exec, &o->reduction.rgba, chi_march_picture_floats(&scene), sizeof(float)) ||
      !chi_buffer_reserve(exec, &o->reduction.visibility, pixels, sizeof(float))))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  if (status == CHI_OK && frame->volume)
  {
    status = prepare_volume(exec, o, &plain, &scene);
    if (status == CHI_OK)
    {
      chi_march_result result = { 0 };
      o->march.crossing = depth;
      o->march.crossing_transmittance = (float)(1 - alpha);
      status = chi_march_run(exec, &o->march, &scene, &o->bricks, &o->classification, &plain,
        frame->surface ? (float*)o->reduction.rgba.data : NULL,
        frame->surface ? (float*)o->reduction.visibility.data : NULL, &result);
      o->march.crossing = NULL;
    }
  }
  o->stats = stats;
  return status;
}

void chi_occlusion_get_image(const chi_occlusion* o, chi_occlusion_image* image)
{
  if (image)
  {
    const int valid = o && o->has_frame, colored = valid && o->colors == 3;
    const float* const visibility = valid ? (const float*)o->visibility.data : NULL;
    *image = (chi_occlusion_image){ .width = valid ? o->width : 0,
      .height = valid ? o->height : 0,
      .rgba = valid ? (const float*)o->rgba.data : NULL,
      .visibility = colored ? visibility + 3 * (size_t)o->width * (size_t)o->height : visibility,
      .visibility_rgb = colored ? visibility : NULL };
  }
}

void chi_occlusion_get_stats(const chi_occlusion* o, chi_occlusion_stats* stats)
{
  if (stats)
  {
    *stats = o ? o->stats : (chi_occlusion_stats){ .struct_size = sizeof *stats };
  }
}

const char* chi_occlusion_instruction_set(void)
{
  return chi_kernels()->name;
}
