/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_internal.h"

#include "chi_occlusion_internal.h" /* what it knows of shading */
#include "math/chi_mat4.h"

#include <float.h>
#include <math.h>
#include <time.h>

/* What a stage was made from; it runs again only where this differs. Filled from zeros, so that
 * padding compares equal. */
typedef struct grid_key
{
  int64_t kind;
  const void* arrays[11];
  uint64_t version;
  size_t counts[10];
  double index_to_world[16];
} grid_key;

typedef struct field_key
{
  const void* arrays[4];
  uint64_t version;
  int64_t integers[6];
  size_t shapes[4][4];
  double color_range[2];
} field_key;

typedef struct choice_key
{
  uint64_t tables;
  int64_t skip;
} choice_key;

typedef struct view_key
{
  double world_to_eye[16], window[4], near_depth, grid_to_world[16];
  int64_t size[2], parallel, order;
  double clip_planes[4 * CHI_TET_CUTS];
  size_t clip_plane_count;
} view_key;

typedef struct bin_key
{
  uint64_t visible;
  const void* depth;
  uint64_t surface;
  int64_t skip, splatting;
} bin_key;

typedef struct draw_key
{
  uint64_t tables, plane;
  int64_t method, blend, skip, size[2], projection;
  const void* depth;
  uint64_t surface;
  chi_shading_key shading;
  double occlusion[CHI_TET_OCCLUSION_KEY];
} draw_key;

/* What a plan is made from. */
typedef struct described_key
{
  draw_key draw;
  uint64_t versions[4];
} described_key;

/* What fragments are made from, but for their colours. */
typedef struct cache_key
{
  uint64_t view, bins, values, surface;
  const void* depth;
  double range[2];
  size_t count;
  int64_t projection;
} cache_key;

struct chi_tet
{
  chi_tet_mesh mesh;
  chi_tet_values values;
  chi_tet_eye eye;
  chi_tet_bins bins;
  chi_tet_order* order;
  chi_preintegration* preintegration;
  chi_segment_tables tables;
  chi_tet_plane plane; /* beside them, which then are of its bound */
  chi_tet_reduction reduction;
  chi_tet_cache cache;
  cache_key cached;
  chi_tet_occlusion* occlusion; /* NULL before it is first asked for */
  double cell;                  /* cube root of the mesh's volume a cell, world units */
  chi_buffer shades;            /* float [tetrahedra][6] */
  chi_buffer image;
  int32_t width, height;
  int32_t bits; /* of the keys */
  int has_mesh, has_values, has_choice, has_view, has_bins, has_image;
  grid_key grid;
  field_key field;
  choice_key choice;
  view_key view;
  bin_key bin;
  draw_key drawn;
  chi_tet_tally tally; /* of the picture */
  /* of chi_tet_describe */
  uint64_t versions[4]; /* of the points, the sequence, the vertices, the values */
  described_key described;
  uint64_t frame_version;
  uint64_t sequenced;   /* version of the sequence that is made; 0: none */
  chi_buffer sequence;  /* uint32 */
  chi_buffer integrals; /* double [entries][4] of the tables, where small ones are splatted */
  size_t sequence_count;
  chi_tet_stats stats;
};

/* A frame in structs of our own, whichever version its caller was compiled for. */
typedef struct own_frame
{
  chi_tet_frame frame;
  chi_camera camera;
  chi_grid_view grid;
  chi_tet_field field;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_tet_params params;
  chi_shading_view shading;
} own_frame;

static double now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

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

/*------------------------------------------------------------------------------------------------*/
static int all_finite(const double* x, size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    if (!isfinite(x[i]))
    {
      return 0;
    }
  }
  return 1;
}

static int camera_is_valid(const chi_camera* c)
{
  return c->width >= 1 && c->height >= 1 && c->width <= CHI_TET_MAX_SIZE &&
    c->height <= CHI_TET_MAX_SIZE && all_finite(c->world_to_eye, 16) && all_finite(c->window, 4) &&
    c->window[0] != c->window[1] && c->window[2] != c->window[3] && !isnan(c->near_depth) &&
    (c->parallel || (c->near_depth > 0 && isfinite(c->near_depth)));
}

static int field_is_valid(const chi_tet_field* f)
{
  const int one = chi_array_is_valid(f->scalars) && f->component >= -1 &&
    f->component < (int64_t)f->scalars->components;
  return one &&
    (!f->opacity ||
      (chi_array_is_valid(f->opacity) && f->opacity_component >= -1 &&
        f->opacity_component < (int64_t)f->opacity->components && !f->colors)) &&
    (!f->second ||
      (chi_array_is_valid(f->second) && f->second_component >= -1 &&
        f->second_component < (int64_t)f->second->components)) &&
    (!f->colors ||
      (chi_array_is_valid(f->colors) && f->color_component >= 0 &&
        f->color_component + (int64_t)3 <= (int64_t)f->colors->components &&
        all_finite(f->color_range, 2) &&
        (f->color_range[0] != f->color_range[1] ||
          (f->color_range[0] == 0 && f->color_range[1] == 0))));
}

static int params_are_valid(const chi_tet_params* p)
{
  return p->order >= CHI_TET_ORDER_AUTO && p->order <= CHI_TET_ORDER_XMPVO &&
    p->pre_integration >= CHI_PREINTEGRATION_AUTO &&
    p->pre_integration <= CHI_PREINTEGRATION_FULL &&
    (p->opacity_convention == CHI_OPACITY_LINEAR || p->opacity_convention == CHI_OPACITY_IMAGE) &&
    (p->blend == CHI_TET_BLEND_COMPOSITE || p->blend == CHI_TET_BLEND_MAXIMUM) && p->skip >= 0 &&
    p->reduction >= 0 && p->reduction <= 8 && p->projection >= CHI_TET_PROJECTION_EXACT &&
    p->projection <= CHI_TET_PROJECTION_PUBLISHED && chi_tet_occlusion_is_valid(p);
}

/* The frame as one of ours, checked. The grid, the arrays and the transfer function are checked in
 * full by the stages that read them. */
static chi_status adopt(own_frame* own, const chi_tet_frame* given)
{
  memset(own, 0, sizeof *own);
  chi_tet_default_params(&own->params);
  chi_tet_frame* const f = &own->frame;
  if (!given || !CHI_ADOPT(chi_tet_frame, clip_plane_count, f, given) || !f->camera || !f->grid ||
    !f->field || !f->transfer || !CHI_ADOPT(chi_camera, near_depth, &own->camera, f->camera) ||
    !CHI_ADOPT(chi_grid_view, version, &own->grid, f->grid) ||
    !CHI_ADOPT(chi_tet_field, version, &own->field, f->field) ||
    !CHI_ADOPT(chi_transfer_view, version, &own->transfer, f->transfer) ||
    (f->surface && !CHI_ADOPT(chi_surface_view, version, &own->surface, f->surface)) ||
    (f->shading && !CHI_ADOPT(chi_shading_view, light_count, &own->shading, f->shading)) ||
    (f->params && !CHI_ADOPT(chi_tet_params, automatic_unit_distance, &own->params, f->params)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  f->camera = &own->camera;
  f->grid = &own->grid;
  f->field = &own->field;
  f->transfer = &own->transfer;
  f->surface = f->surface ? &own->surface : NULL;
  f->params = &own->params;
  f->shading = f->shading ? &own->shading : NULL;
  chi_tet_params* const p = &own->params;
  p->subpixel_splatting = p->subpixel_splatting && p->blend == CHI_TET_BLEND_COMPOSITE &&
    p->projection == CHI_TET_PROJECTION_EXACT && !chi_tet_is_occluded(p) && !f->transfer->plane;
  if (own->params.skip & CHI_TET_SKIP_ALL)
  {
    own->params.skip |= CHI_TET_SKIP_EVERY_KIND;
  }
  const int of_two = f->transfer->plane != NULL;
  if (of_two &&
    (f->field->opacity || f->field->colors ||
      own->params.projection == CHI_TET_PROJECTION_PUBLISHED))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  return camera_is_valid(f->camera) && field_is_valid(f->field) && params_are_valid(f->params) &&
      (!f->surface || f->surface->depth) && chi_shading_is_valid(f->shading) &&
      (!f->grid_to_world || all_finite(f->grid_to_world, 16)) &&
      f->clip_plane_count <= CHI_TET_MAX_CLIP_PLANES &&
      (!f->clip_plane_count ||
        (f->clip_planes && all_finite(f->clip_planes, 4 * f->clip_plane_count)))
    ? CHI_OK
    : CHI_ERROR_INVALID_ARGUMENT;
}

/*------------------------------------------------------------------------------------------------*/
static grid_key key_of_grid(const chi_grid_view* g)
{
  grid_key k;
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

static field_key key_of_field(const chi_tet_frame* frame)
{
  const chi_tet_field* const f = frame->field;
  field_key k;
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

static view_key key_of_view(const chi_tet_frame* f)
{
  view_key k;
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

/* Whether a stage has to run: always, where nothing may be kept. */
static int differs(const chi_tet* tet, const chi_tet_frame* f, int has, const void* old,
  const void* key, size_t size)
{
  (void)tet;
  return !has || !(f->params->skip & CHI_TET_SKIP_UNCHANGED) || memcmp(old, key, size) != 0;
}

static chi_status split(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const grid_key key = key_of_grid(f->grid);
  if (!differs(tet, f, tet->has_mesh, &tet->grid, &key, sizeof key))
  {
    ++tet->stats.skipped[7];
    return CHI_OK;
  }
  tet->has_mesh = tet->has_values = tet->has_choice = tet->has_view = tet->has_bins = 0;
  chi_tet_order_destroy(exec, tet->order);
  tet->order = NULL;
  const double start = now();
  const chi_status status = chi_tet_mesh_build(exec, &tet->mesh, f->grid);
  tet->stats.grid = tet->mesh.counts;
  tet->stats.seconds_split = now() - start;
  tet->grid = key;
  tet->has_mesh = status == CHI_OK;
  ++tet->versions[2];
  return status;
}

static chi_status read_values(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const field_key key = key_of_field(f);
  if (!differs(tet, f, tet->has_values, &tet->field, &key, sizeof key))
  {
    ++tet->stats.skipped[7];
    return CHI_OK;
  }
  tet->has_values = tet->has_choice = tet->has_view = 0; /* points of the eye carry the scalars */
  const double start = now();
  const chi_status status = chi_tet_values_build(
    exec, &tet->values, &tet->mesh, f->grid, f->field, f->transfer->plane != NULL);
  tet->stats.seconds_values = now() - start;
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
  const choice_key key = { tet->tables.version, skip };
  if (differs(tet, f, tet->has_choice, &tet->choice, &key, sizeof key))
  {
    const double start = now();
    tet->has_choice = 0;
    status = chi_tet_values_choose(exec, &tet->values, &tet->mesh, &tet->tables, skip);
    tet->stats.seconds_values += now() - start;
    tet->choice = key;
    tet->has_choice = status == CHI_OK;
  }
  tet->stats.non_finite_cells = tet->values.non_finite;
  tet->stats.skipped[1] = tet->values.transparent;
  return status;
}

static chi_status look(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  const view_key key = key_of_view(f);
  if (!differs(tet, f, tet->has_view, &tet->view, &key, sizeof key))
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
  const double start = now();
  chi_status status = chi_tet_eye_build(exec, &tet->eye, &tet->mesh, &tet->values, f);
  tet->stats.seconds_bins += now() - start;
  const double begin = now();
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
  tet->stats.seconds_order = now() - begin;
  tet->view = key;
  tet->has_view = status == CHI_OK;
  ++tet->versions[0];
  return status;
}

static chi_status bin(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
{
  bin_key key;
  memset(&key, 0, sizeof key);
  key.visible = tet->values.version;
  key.skip = f->params->skip & (CHI_TET_SKIP_CLIPPED | CHI_TET_SKIP_HIDDEN);
  key.splatting = f->params->subpixel_splatting;
  if (f->surface && key.skip & CHI_TET_SKIP_HIDDEN)
  {
    key.depth = f->surface->depth;
    key.surface = f->surface->version;
  }
  if (differs(tet, f, tet->has_bins, &tet->bin, &key, sizeof key))
  {
    tet->has_bins = 0;
    const double start = now();
    const chi_status status =
      chi_tet_bins_build(exec, &tet->bins, &tet->mesh, &tet->values, &tet->eye, f, tet->bits);
    tet->stats.seconds_bins += now() - start;
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
  tet->stats.skipped[3] = tet->bins.clipped;
  tet->stats.skipped[4] = tet->bins.hidden;
  return CHI_OK;
}

static void report(chi_tet_stats* stats, const chi_tet_tally* tally)
{
  stats->drawn = tally->tetrahedra;
  stats->fragments = tally->fragments;
  stats->delicate = tally->delicate;
  stats->splatted = tally->splatted;
  stats->drawn_exactly = tally->left;
  stats->skipped[5] = tally->saturated;
}

enum
{
  STAGES = 4 /* split, values, view, bins */
};

/* All stages before pixels. A picture of what they were before is lost, unless the frame is
 * refused: then a stage is left to be run again, which no later picture is drawn without. */
static chi_status prepare(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f)
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
    status == CHI_OK ? s->skipped[7] == STAGES : status == CHI_ERROR_INVALID_ARGUMENT;
  s->tetrahedra = (int64_t)tet->mesh.counts.tetrahedra;
  s->bytes_mesh = tet->mesh.vertices.bytes + tet->mesh.cells.bytes + tet->mesh.points.bytes +
    tet->mesh.extra_cells.bytes + tet->values.scalars.bytes + tet->values.opacities.bytes +
    tet->values.colors.bytes + tet->values.visible.bytes + s->order.bytes;
  s->bytes_frame = tet->eye.points.bytes + tet->eye.screen.bytes + tet->eye.codes.bytes +
    tet->bins.keys.bytes + tet->bins.in_tile.bytes + tet->bins.counts.bytes +
    tet->bins.starts.bytes + tet->bins.list.bytes + tet->bins.scratch.bytes;
  return status;
}

/* A frame of fewer pixels in place of the one asked for, where that is asked for. */
static chi_status reduce(const chi_exec* exec, chi_tet* tet, own_frame* own)
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

/* `full`: of the picture that is handed out. */
static draw_key key_of_draw(const chi_tet* tet, const chi_tet_frame* f, const chi_camera* full)
{
  draw_key key;
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

/* Of the eye's space, in which the mesh's bounds are a box that is turned. */
static double limit_of_points(const chi_tet* tet, const chi_tet_frame* f)
{
  double matrix[16], limit = 0;
  memcpy(matrix, f->camera->world_to_eye, sizeof matrix);
  if (f->grid_to_world)
  {
    chi_mat4_multiply(f->camera->world_to_eye, f->grid_to_world, matrix);
  }
  const double* const bounds = tet->mesh.counts.bounds;
  for (int corner = 0; corner < 8; ++corner)
  {
    for (int i = 0; i < 3; ++i)
    {
      double x = matrix[4 * i + 3];
      for (int j = 0; j < 3; ++j)
      {
        x += matrix[4 * i + j] * bounds[2 * j + (corner >> j & 1)];
      }
      limit = fmax(limit, fabs(x));
    }
  }
  return limit;
}

static void add_plane(const chi_tet* tet, chi_tet_plan* plan)
{
  const chi_tet_plane* const p = &tet->plane;
  plan->plane = (const float(*)[4])p->entries.data;
  plan->plane_rows = (int32_t)p->rows;
  plan->plane_step = CHI_TET_PLANE_STEP;
  plan->plane_parts = CHI_TET_PLANE_PARTS;
  memcpy(plan->plane_range, p->key.plane_range, sizeof plan->plane_range);
  plan->plane_version = p->version;
  plan->seconds = tet->values.by_gradient ? (const float*)tet->values.gradients.data : NULL;
}

static chi_tet_plan make_plan(const chi_tet* tet, const chi_tet_frame* f, const chi_camera* full)
{
  const chi_tet_values* const v = &tet->values;
  const chi_tet_mesh* const m = &tet->mesh;
  return (chi_tet_plan){ .struct_size = sizeof(chi_tet_plan),
    .points = (const double*)tet->eye.points.data,
    .scalars = (const float*)v->scalars.data,
    .opacities = v->separate && !v->by_gradient ? (const float*)v->opacities.data : NULL,
    .point_count = m->point_count,
    .value_count = v->is_cell_data ? m->counts.cells : m->point_count,
    .vertices = (const uint32_t*)m->vertices.data,
    .cells = m->cell_of,
    .count = m->counts.tetrahedra,
    .sequence = (const uint32_t*)tet->sequence.data,
    .sequence_count = tet->sequence_count,
    .is_cell_data = v->is_cell_data,
    .blend = f->params->blend,
    .planes = tet->eye.planes,
    .plane_count = f->clip_plane_count,
    .maximum_path = tet->stats.unit_distance,
    .opacity_convention = f->params->opacity_convention,
    .parallel = f->camera->parallel != 0,
    .colors = v->direct ? (const float*)v->colors.data : NULL,
    .tables = tet->tables,
    .points_version = tet->versions[0],
    .scalars_version = tet->versions[3],
    .vertices_version = tet->versions[2],
    .sequence_version = tet->versions[1],
    .shades = f->shading ? (const float*)tet->shades.data : NULL,
    .color_limit = f->shading && f->shading->unclamped ? INFINITY : 1,
    .width = f->camera->width,
    .height = f->camera->height,
    .full_width = full->width,
    .full_height = full->height,
    .reduction = f->params->reduction > 1 ? f->params->reduction : 1,
    .first = { tet->eye.first[0], tet->eye.first[1] },
    .step = { tet->eye.step[0], tet->eye.step[1] },
    .near_depth = f->camera->near_depth,
    .point_limit = limit_of_points(tet, f),
    .depth = f->surface ? f->surface->depth : NULL,
    .surface_version = f->surface ? f->surface->version : 0,
    .frame_version = tet->frame_version };
}

chi_status chi_tet_describe(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame, chi_tet_plan* plan)
{
  own_frame own;
  const chi_status valid = tet && plan && plan->struct_size >= sizeof *plan
    ? adopt(&own, frame)
    : CHI_ERROR_INVALID_ARGUMENT;
  if (valid != CHI_OK)
  {
    return valid;
  }
  const double start = now();
  const chi_tet_frame* const f = &own.frame;
  own.params.subpixel_splatting = 0;
  chi_status status = reduce(exec, tet, &own);
  status = status == CHI_OK ? prepare(exec, tet, f) : status;
  if (status == CHI_OK && (tet->sequenced != tet->versions[1] || !tet->sequenced))
  {
    status = chi_tet_sequence(
      exec, &tet->bins, &tet->mesh, tet->bits, &tet->sequence, &tet->sequence_count);
    tet->sequenced = status == CHI_OK ? tet->versions[1] : 0;
  }
  if (status == CHI_OK && f->shading)
  {
    status = chi_tet_shade(exec, &tet->shades, &tet->mesh, &tet->values, &tet->eye, &tet->bins, f);
  }
  if (status != CHI_OK)
  {
    return status;
  }
  described_key key;
  memset(&key, 0, sizeof key);
  key.draw = key_of_draw(tet, f, &own.camera);
  memcpy(key.versions, tet->versions, sizeof key.versions);
  tet->stats.reused = !differs(tet, f, tet->frame_version != 0, &tet->described, &key, sizeof key);
  tet->frame_version += !tet->stats.reused;
  tet->described = key;
  *plan = make_plan(tet, f, &own.camera);
  if (tet->values.by_plane)
  {
    add_plane(tet, plan);
  }
  report(&tet->stats, &(chi_tet_tally){ .tetrahedra = (int64_t)tet->sequence_count });
  tet->stats.seconds_draw = 0;
  tet->stats.seconds_total = now() - start;
  return CHI_OK;
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
  cache_key key;
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
  const double begin = now();
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
    report(s, &tet->tally);
    s->seconds_light = result.seconds_light;
    s->bytes_occlusion = result.bytes;
    s->light_slabs = result.slabs;
    s->seconds_draw = now() - begin;
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
  report(s, &tet->tally);
  s->seconds_draw = now() - begin;
  return status;
}

chi_status chi_tet_render(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame)
{
  own_frame own;
  const chi_status valid = tet ? adopt(&own, frame) : CHI_ERROR_INVALID_ARGUMENT;
  if (valid != CHI_OK)
  {
    return valid;
  }
  chi_tet_frame* const f = &own.frame;
  const double start = now();
  const int32_t width = f->camera->width, height = f->camera->height;
  const int reduced = own.params.reduction > 1;
  chi_status status = reduce(exec, tet, &own);
  chi_tet_stats* const s = &tet->stats;
  status = status == CHI_OK ? prepare(exec, tet, f) : status;
  if (status == CHI_ERROR_INVALID_ARGUMENT)
  {
    return status;
  }
  const draw_key key = key_of_draw(tet, f, &own.camera);
  if (status == CHI_OK && tet->has_image && s->skipped[7] == STAGES &&
    !differs(tet, f, 1, &tet->drawn, &key, sizeof key))
  {
    ++s->skipped[7];
    s->reused = 1;
    report(s, &tet->tally);
    s->seconds_draw = 0;
    s->seconds_total = now() - start;
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
  s->seconds_total = now() - start;
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
  own_frame own;
  if (!tet || !cells || !depths || !(opacity > 0 && opacity < 1))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = adopt(&own, frame);
  if (status != CHI_OK)
  {
    return status;
  }
  own.params.blend = CHI_TET_BLEND_COMPOSITE;
  chi_tet_stats stats = tet->stats;
  status = prepare(exec, tet, &own.frame);
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
  own_frame own;
  if (!tet || !violations)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_status status = adopt(&own, frame);
  status = status == CHI_OK ? prepare(exec, tet, &own.frame) : status;
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
