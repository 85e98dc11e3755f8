/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The stages of a frame before its pixels: each runs again only where what it was made from has
 * changed. */
#include "chi_tet_handle.h"

#include <math.h>
#include <time.h>

double chi_tet_now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static chi_tet_grid_key key_of_grid(const chi_grid_view* g)
{
  chi_tet_grid_key k;
  memset(&k, 0, sizeof k);
  k.kind = g->kind;
  const void* const arrays[11] = { g->points.data, g->axes[0].data, g->axes[1].data,
    g->axes[2].data, g->cell_types, g->offsets, g->connectivity, g->faces, g->face_offsets,
    g->cell_ghosts, g->point_ghosts };
  memcpy(k.arrays, arrays, sizeof arrays);
  k.version = g->version;
  const size_t counts[10] = { g->points.count, g->points.stride, (size_t)g->points.type,
    g->dimensions[0], g->dimensions[1], g->dimensions[2], g->cell_count, g->connectivity_count,
    g->faces_count, g->axes[0].count };
  memcpy(k.counts, counts, sizeof counts);
  memcpy(k.index_to_world, g->index_to_world, sizeof k.index_to_world);
  return k;
}

static chi_tet_field_key key_of_field(const chi_tet_frame* frame)
{
  const chi_tet_field* const f = frame->field;
  chi_tet_field_key k;
  memset(&k, 0, sizeof k);
  k.version = f->version;
  k.integers[0] = f->is_cell_data != 0;
  k.integers[1] = f->component;
  k.integers[2] = f->opacity_component;
  k.integers[3] = f->color_component;
  memcpy(k.color_range, f->color_range, sizeof k.color_range);
  k.integers[4] = f->second_component;
  k.integers[5] = frame->transfer->plane != NULL;
  const chi_array_view* const arrays[4] = { f->scalars, f->opacity, f->colors, f->second };
  for (int i = 0; i < 4; ++i)
  {
    if (!arrays[i])
    {
      continue;
    }
    k.arrays[i] = arrays[i]->data;
    const size_t shape[4] = { arrays[i]->count, arrays[i]->components, arrays[i]->stride,
      (size_t)arrays[i]->type };
    memcpy(k.shapes[i], shape, sizeof shape);
  }
  return k;
}

static chi_tet_view_key key_of_view(const chi_tet_frame* f)
{
  chi_tet_view_key k;
  memset(&k, 0, sizeof k);
  memcpy(k.world_to_eye, f->camera->world_to_eye, sizeof k.world_to_eye);
  memcpy(k.window, f->camera->window, sizeof k.window);
  k.near_depth = f->camera->near_depth;
  for (int i = 0; i < 16; ++i)
  {
    k.grid_to_world[i] = f->grid_to_world ? f->grid_to_world[i] : i % 5 == 0;
  }
  k.size[0] = f->camera->width;
  k.size[1] = f->camera->height;
  k.parallel = f->camera->parallel != 0;
  k.order = f->params->order;
  k.clip_plane_count = f->clip_plane_count;
  if (k.clip_plane_count)
  {
    memcpy(k.clip_planes, f->clip_planes, 4 * k.clip_plane_count * sizeof(double));
  }
  return k;
}

int chi_tet_differs(const chi_tet* tet, const chi_tet_frame* f, int has, const void* old,
  const void* key, size_t size)
{
  (void)tet;
  return !has || !(f->params->skip & CHI_TET_SKIP_UNCHANGED) || memcmp(old, key, size) != 0;
}

static chi_status split(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const chi_tet_grid_key key = key_of_grid(f->grid);
  if (!chi_tet_differs(tet, f, tet->has_mesh, &tet->grid, &key, sizeof key))
  {
    ++tet->stats.skipped[7];
    return CHI_OK;
  }
  tet->has_mesh = tet->has_values = tet->has_choice = tet->has_view = tet->has_bins = 0;
  chi_tet_order_destroy(exec, tet->order);
  tet->order = NULL;
  const double start = chi_tet_now();
  const chi_status status = chi_tet_mesh_build(exec, &tet->mesh, f->grid);
  tet->stats.grid = tet->mesh.counts;
  tet->stats.seconds_split = chi_tet_now() - start;
  tet->grid = key;
  tet->has_mesh = status == CHI_OK;
  ++tet->versions[2];
  return status;
}

static chi_status read_values(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const chi_tet_field_key key = key_of_field(f);
  if (!chi_tet_differs(tet, f, tet->has_values, &tet->field, &key, sizeof key))
  {
    ++tet->stats.skipped[7];
    return CHI_OK;
  }
  tet->has_values = tet->has_choice = tet->has_view = 0; /* points of the eye carry the scalars */
  const double start = chi_tet_now();
  const chi_status status = chi_tet_values_build(
    exec, &tet->values, &tet->mesh, f->grid, f->field, f->transfer->plane != NULL);
  tet->stats.seconds_values = chi_tet_now() - start;
  tet->field = key;
  ++tet->versions[3];
  tet->has_values = status == CHI_OK;
  return status;
}

/* The tables, over world lengths; and which tetrahedra they leave to be drawn. */
static chi_status classify(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  chi_transfer_view transfer = *f->transfer;
  double scale = 1, stretch = 1; /* of volumes, and at most of lengths */
  if (f->grid_to_world)
  {
    const double* const m = f->grid_to_world;
    scale = fabs(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
      m[2] * (m[4] * m[9] - m[5] * m[8]));
    stretch = 0;
    for (int i = 0; i < 11; ++i)
    {
      stretch += i % 4 < 3 ? m[i] * m[i] : 0;
    }
    stretch = sqrt(stretch);
  }
  tet->cell = cbrt(tet->mesh.counts.volume * scale / (double)chi_tet_cells_of(&tet->mesh));
  if (f->params->automatic_unit_distance && tet->cell > 0)
  {
    transfer.unit_distance = tet->cell;
  }
  tet->stats.unit_distance = transfer.unit_distance;
  chi_preintegration_params params;
  chi_preintegration_default_params(&params);
  const int method = f->params->pre_integration;
  if (transfer.plane)
  {
    const chi_transfer_view whole = transfer;
    const chi_status made =
      chi_tet_plane_build(exec, &tet->plane, &whole, f->params->opacity_convention, &transfer);
    if (made != CHI_OK)
    {
      return made;
    }
    /* a table of three dimensions would be of the bound, which nothing is drawn by */
    params.method = method == CHI_PREINTEGRATION_NONE ? method : CHI_PREINTEGRATION_PARTIAL;
  }
  else
  {
    chi_tet_plane_free(exec, &tet->plane);
    params.method = method;
  }
  params.opacity_convention = f->params->opacity_convention;
  params.direct_color = tet->values.direct;
  params.longest_segment = tet->values.longest_edge * stretch;
  /* cells of one value each have segments as short as one likes */
  params.segment_range =
    fmax(tet->values.widest_range, 1e-6 * (transfer.range[1] - transfer.range[0]));
  chi_status status = chi_preintegration_update(exec, tet->preintegration, &transfer, &params);
  chi_preintegration_get_tables(tet->preintegration, &tet->tables);
  if (status != CHI_OK)
  {
    return status;
  }
  if (f->transfer->plane && method != CHI_PREINTEGRATION_PARTIAL)
  {
    tet->tables.method = method == CHI_PREINTEGRATION_NONE ? method : CHI_PREINTEGRATION_FULL;
  }
  tet->stats.pre_integration = tet->tables.method;
  /* of maximum intensity the first fragment decides nothing: opacities of 0 hide others */
  const int skip =
    f->params->skip & CHI_TET_SKIP_TRANSPARENT && f->params->blend == CHI_TET_BLEND_COMPOSITE;
  const chi_tet_choice_key key = { tet->tables.version, skip };
  if (chi_tet_differs(tet, f, tet->has_choice, &tet->choice, &key, sizeof key))
  {
    const double start = chi_tet_now();
    tet->has_choice = 0;
    status = chi_tet_values_choose(exec, &tet->values, &tet->mesh, &tet->tables, skip);
    tet->stats.seconds_values += chi_tet_now() - start;
    tet->choice = key;
    tet->has_choice = status == CHI_OK;
  }
  tet->stats.non_finite_cells = tet->values.non_finite;
  tet->stats.skipped[1] = tet->values.transparent;
  return status;
}

static chi_status look(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const chi_tet_view_key key = key_of_view(f);
  if (!chi_tet_differs(tet, f, tet->has_view, &tet->view, &key, sizeof key))
  {
    ++tet->stats.skipped[7];
    return CHI_OK;
  }
  if (tet->order && tet->view.order != key.order)
  {
    chi_tet_order_destroy(exec, tet->order);
    tet->order = NULL;
  }
  tet->has_view = tet->has_bins = 0;
  const double start = chi_tet_now();
  chi_status status = chi_tet_eye_build(exec, &tet->eye, &tet->mesh, &tet->values, f);
  tet->stats.seconds_bins += chi_tet_now() - start;
  const double begin = chi_tet_now();
  if (status == CHI_OK && !tet->order)
  {
    const chi_tet_mesh_view mesh = { sizeof mesh, tet->mesh.all_points,
      (const uint32_t*)tet->mesh.vertices.data, tet->mesh.counts.tetrahedra };
    status = chi_tet_order_create(exec, &mesh, f->params->order, &tet->order);
  }
  if (status == CHI_OK &&
    !chi_buffer_reserve(exec, &tet->bins.keys, tet->mesh.counts.tetrahedra + 1, sizeof(uint32_t)))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  if (status == CHI_OK)
  {
    const chi_tet_order_view view = { sizeof view, f->camera, f->grid_to_world };
    status =
      chi_tet_order_keys(exec, tet->order, &view, (uint32_t*)tet->bins.keys.data, &tet->bits);
    tet->stats.order.struct_size = sizeof tet->stats.order;
    chi_tet_order_get_info(tet->order, &tet->stats.order);
  }
  tet->stats.seconds_order = chi_tet_now() - begin;
  tet->view = key;
  tet->has_view = status == CHI_OK;
  ++tet->versions[0];
  return status;
}

static chi_status bin(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  chi_tet_bin_key key;
  memset(&key, 0, sizeof key);
  key.visible = tet->values.version;
  key.skip = f->params->skip &
    (CHI_TET_SKIP_OUTSIDE | CHI_TET_SKIP_CLIPPED | CHI_TET_SKIP_HIDDEN | CHI_TET_SKIP_UNCOVERED);
  key.splatting = f->params->subpixel_splatting;
  if (f->surface && key.skip & CHI_TET_SKIP_HIDDEN)
  {
    key.depth = f->surface->depth;
    key.surface = f->surface->version;
  }
  if (chi_tet_differs(tet, f, tet->has_bins, &tet->bin, &key, sizeof key))
  {
    tet->has_bins = 0;
    const double start = chi_tet_now();
    const chi_status status =
      chi_tet_bins_build(exec, &tet->bins, &tet->mesh, &tet->values, &tet->eye, f, tet->bits);
    tet->stats.seconds_bins += chi_tet_now() - start;
    tet->bin = key;
    tet->has_bins = status == CHI_OK;
    ++tet->versions[1];
    if (status != CHI_OK)
    {
      return status;
    }
  }
  else
  {
    ++tet->stats.skipped[7];
  }
  tet->stats.outside = tet->bins.outside;
  tet->stats.uncovered = tet->bins.uncovered;
  /* where they are not skipped, what is too far off is left out all the same */
  tet->stats.skipped[2] = f->params->skip & CHI_TET_SKIP_OUTSIDE ? tet->bins.outside : 0;
  tet->stats.skipped[3] = tet->bins.clipped;
  tet->stats.skipped[4] = tet->bins.hidden;
  tet->stats.skipped[6] = tet->bins.uncovered;
  return CHI_OK;
}

void chi_tet_report(chi_tet_stats* stats, const chi_tet_tally* tally)
{
  stats->drawn = tally->tetrahedra;
  stats->fragments = tally->fragments;
  stats->delicate = tally->delicate;
  stats->splatted = tally->splatted;
  stats->drawn_exactly = tally->left;
  stats->skipped[5] = tally->saturated;
}

chi_status chi_tet_prepare(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  chi_tet_stats* const s = &tet->stats;
  memset(s->skipped, 0, sizeof s->skipped);
  s->reused = 0;
  s->seconds_split = s->seconds_values = s->seconds_order = s->seconds_bins = 0;
  chi_status status = split(exec, tet, f);
  status = status == CHI_OK ? read_values(exec, tet, f) : status;
  status = status == CHI_OK ? classify(exec, tet, f) : status;
  status = status == CHI_OK ? look(exec, tet, f) : status;
  status = status == CHI_OK ? bin(exec, tet, f) : status;
  tet->has_image &=
    status == CHI_OK ? s->skipped[7] == CHI_TET_STAGES : status == CHI_ERROR_INVALID_ARGUMENT;
  s->tetrahedra = (int64_t)tet->mesh.counts.tetrahedra;
  s->bytes_mesh = tet->mesh.vertices.bytes + tet->mesh.cells.bytes + tet->mesh.points.bytes +
    tet->mesh.extra_cells.bytes + tet->values.scalars.bytes + tet->values.opacities.bytes +
    tet->values.colors.bytes + tet->values.gradients.bytes + tet->values.visible.bytes +
    s->order.bytes;
  s->bytes_frame = tet->eye.points.bytes + tet->eye.screen.bytes + tet->eye.codes.bytes +
    tet->bins.keys.bytes + tet->bins.in_tile.bytes + tet->bins.counts.bytes +
    tet->bins.starts.bytes + tet->bins.list.bytes + tet->bins.scratch.bytes;
  return status;
}

chi_status chi_tet_reduce_frame(const chi_exec* exec, chi_tet* tet, chi_tet_own_frame* own)
{
  chi_tet_frame* const f = &own->frame;
  if (own->params.reduction <= 1)
  {
    return CHI_OK;
  }
  const chi_status status = chi_tet_reduce(exec, &tet->reduction, f, own->params.reduction);
  f->camera = &tet->reduction.camera;
  f->surface = f->surface ? &tet->reduction.surface : NULL;
  return status;
}

chi_tet_draw_key chi_tet_key_of_draw(
  const chi_tet* tet, const chi_tet_frame* f, const chi_camera* full)
{
  chi_tet_draw_key key;
  memset(&key, 0, sizeof key);
  key.tables = tet->tables.version;
  key.plane = f->transfer->plane ? tet->plane.version : 0;
  key.method = tet->tables.method;
  key.blend = f->params->blend;
  key.skip = f->params->skip & CHI_TET_SKIP_SATURATED;
  key.depth = f->surface ? f->surface->depth : NULL;
  key.surface = f->surface ? f->surface->version : 0;
  chi_shading_make_key(&key.shading, f->shading);
  chi_tet_occlusion_key(f->params, key.occlusion);
  key.projection = f->params->projection;
  key.size[0] = full->width;
  key.size[1] = full->height;
  return key;
}
