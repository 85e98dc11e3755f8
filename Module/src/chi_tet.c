/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_handle.h"

#include <float.h>
#include <math.h>

void chi_tet_default_params(chi_tet_params* params)
{
  if (params)
  {
    *params = (chi_tet_params){ .struct_size = sizeof *params, .skip = CHI_TET_SKIP_ALL };
  }
}

chi_status chi_tet_create(const chi_exec* exec, chi_tet** tet)
{
  if (!tet)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *tet = (chi_tet*)chi_alloc(exec, 1, sizeof **tet);
  if (!*tet)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*tet, 0, sizeof **tet);
  const chi_status status = chi_preintegration_create(exec, &(*tet)->preintegration);
  if (status != CHI_OK)
  {
    chi_free(exec, *tet, 1, sizeof **tet);
    *tet = NULL;
  }
  return status;
}

void chi_tet_destroy(const chi_exec* exec, chi_tet* tet)
{
  if (!tet)
  {
    return;
  }
  chi_tet_mesh_free(exec, &tet->mesh);
  chi_tet_values_free(exec, &tet->values);
  chi_tet_plane_free(exec, &tet->plane);
  chi_tet_eye_free(exec, &tet->eye);
  chi_tet_bins_free(exec, &tet->bins);
  chi_tet_order_destroy(exec, tet->order);
  chi_preintegration_destroy(exec, tet->preintegration);
  chi_tet_cache_free(exec, &tet->cache);
  chi_tet_occlusion_destroy(exec, tet->occlusion);
  chi_buffer_free(exec, &tet->reduction.depth);
  chi_buffer_free(exec, &tet->reduction.rgba);
  chi_buffer_free(exec, &tet->shades);
  chi_buffer_free(exec, &tet->image);
  chi_buffer_free(exec, &tet->sequence);
  chi_buffer_free(exec, &tet->integrals);
  chi_free(exec, tet, 1, sizeof *tet);
}

static chi_tet_scene make_scene(const chi_tet* tet, const chi_tet_frame* f)
{
  const chi_tet_values* const v = &tet->values;
  chi_tet_scene s = { .points = (const chi_tet_point*)tet->eye.points.data,
    .vertices = (const uint32_t*)tet->mesh.vertices.data,
    .cells = tet->mesh.cell_of,
    .cell_scalars = v->is_cell_data ? (const float*)v->scalars.data : NULL,
    .cell_opacities =
      v->is_cell_data && v->separate && !v->by_gradient ? (const float*)v->opacities.data : NULL,
    .near_depth = f->camera->near_depth,
    .width = f->camera->width,
    .height = f->camera->height,
    .parallel = f->camera->parallel != 0,
    .separate = v->separate,
    .seconds = v->by_gradient ? (const float*)v->gradients.data : NULL,
    .planes = tet->eye.planes,
    .plane_count = f->clip_plane_count,
    .depth = f->surface ? f->surface->depth : NULL,
    .base = (float)tet->tables.range[0],
    .scale =
      (float)((double)(tet->tables.count - 1) / (tet->tables.range[1] - tet->tables.range[0])),
    .end = (float)(tet->tables.count - 1),
    .tables = &tet->tables,
    /* half a step is at most 1/4096 of full scale, 0.06 of 255, and rounding has no bias */
    .fine = tet->values.coarseness <= 1.0f / 2048,
    .extinction = (const float*)tet->values.extinction.data,
    .shades = f->shading ? (const float(*)[6])tet->shades.data : NULL,
    .color_limit = f->shading && f->shading->unclamped ? INFINITY : 1,
    .maximum = f->params->blend == CHI_TET_BLEND_MAXIMUM,
    .maximum_of_unit = (float)fmin(tet->stats.unit_distance, (double)FLT_MAX),
    .image_opacity = f->params->opacity_convention == CHI_OPACITY_IMAGE,
    .colors = v->direct ? (const float(*)[3])v->colors.data : NULL };
  s.base_y = s.base;
  s.scale_y = s.scale;
  s.end_y = s.end;
  if (v->by_plane)
  {
    const double* const range = tet->plane.key.plane_range;
    s.plane = (const float(*)[4])tet->plane.entries.data;
    s.plane_rows = (int32_t)tet->plane.rows;
    s.base_y = (float)range[0];
    s.end_y = (float)(tet->plane.rows - 1);
    s.scale_y = (float)((double)(tet->plane.rows - 1) / (range[1] - range[0]));
  }
  memcpy(s.first, tet->eye.first, sizeof s.first);
  memcpy(s.step, tet->eye.step, sizeof s.step);
  return s;
}

/* What this frame does with kept fragments: nothing while the view moves; where it stands the first
 * new transfer function counts them, the second keeps them, and the next ones use them. */
static int use_cache(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  chi_tet_cache* const cache = &tet->cache;
  chi_tet_cache_key key;
  memset(&key, 0, sizeof key);
  key.view = tet->versions[0];
  key.bins = tet->versions[1];
  key.values = tet->versions[3];
  key.depth = f->surface ? f->surface->depth : NULL;
  key.surface = f->surface ? f->surface->version : 0;
  memcpy(key.range, tet->tables.range, sizeof key.range);
  key.count = (size_t)tet->tables.count;
  key.projection = f->params->projection;
  if (!f->params->fragment_cache_bytes || f->params->subpixel_splatting || tet->values.separate ||
    tet->values.direct || f->params->blend != CHI_TET_BLEND_COMPOSITE || f->shading ||
    !(f->params->skip & CHI_TET_SKIP_UNCHANGED))
  {
    chi_tet_cache_free(exec, cache);
    cache->is_counted = cache->is_full = 0;
    return CHI_TET_CACHE_OFF;
  }
  if (memcmp(&key, &tet->cached, sizeof key) != 0)
  {
    tet->cached = key;
    cache->is_counted = cache->is_full = 0;
    return CHI_TET_CACHE_OFF;
  }
  if (!cache->is_counted)
  {
    return CHI_TET_CACHE_COUNT;
  }
  const size_t tiles = (size_t)tet->bins.tiles[0] * (size_t)tet->bins.tiles[1];
  return cache->is_full ? CHI_TET_CACHE_READ
    : chi_tet_cache_reserve(exec, cache, tiles, f->params->fragment_cache_bytes)
    ? CHI_TET_CACHE_WRITE
    : CHI_TET_CACHE_OFF;
}

/* The pixels, from all stages before. */
static chi_status draw(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f, float* rgba)
{
  chi_tet_stats* const s = &tet->stats;
  chi_tet_cache* const cache = &tet->cache;
  const double begin = chi_tet_now();
  if (f->shading)
  {
    const chi_status shaded =
      chi_tet_shade(exec, &tet->shades, &tet->mesh, &tet->values, &tet->eye, &tet->bins, f);
    if (shaded != CHI_OK)
    {
      return shaded;
    }
  }
  const chi_tet_scene scene = make_scene(tet, f);
  s->seconds_light = 0;
  s->bytes_occlusion = 0;
  s->light_slabs = 0;
  if (chi_tet_is_occluded(f->params))
  {
    chi_tet_occlusion_result result;
    const chi_status status =
      chi_tet_occlude(exec, &tet->occlusion, &tet->bins, &scene, f, tet->cell, rgba, &result);
    tet->tally = result.tally;
    chi_tet_report(s, &tet->tally);
    s->seconds_light = result.seconds_light;
    s->bytes_occlusion = result.bytes;
    s->light_slabs = result.slabs;
    s->seconds_draw = chi_tet_now() - begin;
    return status;
  }
  if (f->params->subpixel_splatting)
  {
    const chi_status prepared = chi_tet_splat_prepare(exec, &tet->integrals, &tet->tables);
    if (prepared != CHI_OK)
    {
      return prepared;
    }
  }
  const int use = use_cache(exec, tet, f);
  const chi_tet_pass pass = { .skip_saturated = f->params->skip & CHI_TET_SKIP_SATURATED,
    .rgba = rgba,
    .cache = cache,
    .cache_use = use,
    .published = f->params->projection == CHI_TET_PROJECTION_PUBLISHED,
    .integrals = f->params->subpixel_splatting ? (const double(*)[4])tet->integrals.data : NULL };
  const chi_status status = chi_tet_draw(exec, &tet->bins, &scene, &pass, &tet->tally);
  cache->is_counted = status == CHI_OK && (use == CHI_TET_CACHE_COUNT || cache->is_counted);
  cache->is_full = status == CHI_OK && (use == CHI_TET_CACHE_WRITE || cache->is_full);
  chi_tet_report(s, &tet->tally);
  s->seconds_draw = chi_tet_now() - begin;
  return status;
}

chi_status chi_tet_render(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame)
{
  chi_tet_own_frame own;
  const chi_status valid = tet ? chi_tet_adopt_frame(&own, frame) : CHI_ERROR_INVALID_ARGUMENT;
  if (valid != CHI_OK)
  {
    return valid;
  }
  chi_tet_frame* const f = &own.frame;
  const double start = chi_tet_now();
  const int32_t width = f->camera->width, height = f->camera->height;
  const int reduced = own.params.reduction > 1;
  chi_status status = chi_tet_reduce_frame(exec, tet, &own);
  chi_tet_stats* const s = &tet->stats;
  status = status == CHI_OK ? chi_tet_prepare(exec, tet, f) : status;
  if (status == CHI_ERROR_INVALID_ARGUMENT)
  {
    return status;
  }
  const chi_tet_draw_key key = chi_tet_key_of_draw(tet, f, &own.camera);
  if (status == CHI_OK && tet->has_image && s->skipped[7] == CHI_TET_STAGES &&
    !chi_tet_differs(tet, f, 1, &tet->drawn, &key, sizeof key))
  {
    ++s->skipped[7];
    s->reused = 1;
    chi_tet_report(s, &tet->tally);
    s->seconds_draw = 0;
    s->seconds_total = chi_tet_now() - start;
    return CHI_OK;
  }
  tet->has_image = 0;
  if (status == CHI_OK &&
    (!chi_buffer_reserve(exec, &tet->image, (size_t)width * (size_t)height, 4 * sizeof(float)) ||
      (reduced &&
        !chi_buffer_reserve(exec, &tet->reduction.rgba,
          (size_t)f->camera->width * (size_t)f->camera->height, 4 * sizeof(float)))))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  float* const image = (float*)tet->image.data;
  float* const rgba = reduced ? (float*)tet->reduction.rgba.data : image;
  status = status == CHI_OK ? draw(exec, tet, f, rgba) : status;
  if (status == CHI_OK && reduced)
  {
    status = chi_tet_enlarge(exec, &tet->reduction, rgba, image, width, height);
  }
  tet->drawn = key;
  tet->has_image = status == CHI_OK;
  tet->width = width;
  tet->height = height;
  s->bytes_image = tet->image.bytes;
  s->bytes_cache = tet->cache.pixels.bytes + tet->cache.ends.bytes + tet->cache.lengths.bytes;
  s->seconds_total = chi_tet_now() - start;
  return status;
}

void chi_tet_get_image(const chi_tet* tet, chi_tet_image* image)
{
  if (image)
  {
    *image = (chi_tet_image){ 0 };
    if (tet && tet->has_image)
    {
      *image = (chi_tet_image){ tet->width, tet->height, (const float*)tet->image.data };
    }
  }
}

void chi_tet_get_stats(const chi_tet* tet, chi_tet_stats* stats)
{
  if (stats)
  {
    memset(stats, 0, sizeof *stats);
    if (tet)
    {
      *stats = tet->stats;
    }
    stats->struct_size = sizeof *stats;
  }
}

chi_status chi_tet_find_cells(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame,
  double opacity, int64_t* cells, float* depths)
{
  chi_tet_own_frame own;
  if (!tet || !cells || !depths || !(opacity > 0 && opacity < 1))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_tet_adopt_frame(&own, frame);
  if (status != CHI_OK)
  {
    return status;
  }
  own.params.blend = CHI_TET_BLEND_COMPOSITE;
  chi_tet_stats stats = tet->stats;
  status = chi_tet_prepare(exec, tet, &own.frame);
  if (status == CHI_OK)
  {
    own.frame.shading = NULL;
    const chi_tet_scene scene = make_scene(tet, &own.frame);
    const chi_tet_picks picks = { opacity, cells, depths };
    chi_tet_tally tally;
    const chi_tet_pass pass = { .picks = &picks };
    status = chi_tet_draw(exec, &tet->bins, &scene, &pass, &tally);
  }
  /* what was drawn last stays as it was; what is known of the mesh and its order may be new */
  stats.grid = tet->stats.grid;
  stats.order = tet->stats.order;
  tet->stats = stats;
  return status;
}

chi_status chi_tet_count_violations(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame, int64_t* violations)
{
  chi_tet_own_frame own;
  if (!tet || !violations)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = chi_tet_adopt_frame(&own, frame);
  status = status == CHI_OK ? chi_tet_prepare(exec, tet, &own.frame) : status;
  if (status == CHI_OK)
  {
    const chi_tet_mesh_view mesh = { sizeof mesh, tet->mesh.all_points,
      (const uint32_t*)tet->mesh.vertices.data, tet->mesh.counts.tetrahedra };
    const chi_tet_order_view view = { sizeof view, own.frame.camera, own.frame.grid_to_world };
    status = chi_tet_order_violations(
      exec, &mesh, &view, (const uint32_t*)tet->bins.keys.data, violations);
  }
  return status;
}
