/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Slab after slab, from the eye on: what of the tetrahedra lies in it is drawn as a layer, lit by
 * what light planes say of depths a bias nearer to the eye, and laid behind the picture; its
 * optical thickness then takes its part of the light. Doc: theory/tet_occlusion.md.
 */
#include "chi_tet_occlusion.h"

#include <math.h>

enum
{
  BAND = 16, /* rows of light pixels that a task takes */
  LIST = 1024,
  SEEN = 3 /* light planes that a slab of matter reads: about one, and those on either side */
};
_Static_assert(CHI_TET_TILE / 2 % BAND == 0, "a band lies in one row of tiles");
_Static_assert(CHI_TET_TILE / 2 % CHI_SEGMENT == 0, "tiles are whole segments of light");

typedef struct slab_tile
{
  int32_t last;       /* slab with something to draw; -1: none */
  int32_t plane;      /* the last light plane that `seen` has */
  int32_t within;     /* tiles to the farthest that still needs its light; negative: none does */
  uint8_t opaque;     /* no pixel lets light through any more */
  uint8_t bright[3];  /* of the last three planes: all light arrives */
  uint8_t has_tau[2]; /* likewise of slabs: something is in `tau` */
} slab_tile;

typedef struct occlusion_job
{
  const chi_exec* exec;
  const chi_tet_bins* bins;
  const chi_tet_kernels* kernels;
  chi_tet_scene scene; /* limited to the slab at hand */
  const chi_tet_slabs* slabs;
  chi_light_planes planes;
  slab_tile* tiles;
  uint8_t* need; /* [tile rows][segments] */
  float* seen[SEEN];
  int32_t behind; /* slab at hand less the middle one of its light planes */
  float* rgba;
  float strength;
  int skips;
  int32_t slab;
  chi_tet_tally* tally; /* [tiles] */
} occlusion_job;

int chi_tet_occlusion_is_valid(const chi_tet_params* p)
{
  return p->occlusion_strength >= 0 && p->occlusion_strength <= 1 &&
    (p->cone_angle_degrees == 0 || (p->cone_angle_degrees >= 1 && p->cone_angle_degrees <= 85)) &&
    p->occlusion_bias >= 0 && p->occlusion_bias < INFINITY && p->direction_count >= 0 &&
    p->direction_count <= CHI_MAX_DIRECTIONS && p->occlusion_slabs >= 0 &&
    p->occlusion_slabs <= CHI_TET_MAX_SLABS;
}

int chi_tet_is_occluded(const chi_tet_params* p)
{
  return p->occlusion_strength > 0 && p->blend == CHI_TET_BLEND_COMPOSITE;
}

void chi_tet_occlusion_key(const chi_tet_params* p, double key[CHI_TET_OCCLUSION_KEY])
{
  const double all[CHI_TET_OCCLUSION_KEY] = { p->occlusion_strength, p->cone_angle_degrees,
    p->occlusion_bias, p->direction_count, p->occlusion_slabs, p->full_size_light != 0 };
  for (int k = 0; k < CHI_TET_OCCLUSION_KEY; ++k)
  {
    key[k] = chi_tet_is_occluded(p) ? all[k] : 0;
  }
}

/*------------------------------------------------------------------------------------------------*/
/* Which tiles' light may still reach a pixel that shows it: of each that is not done the tiles
 * around, as far as light gets until its last slab; two sweeps carry that on (Chebyshev distance).
 * Light of others is neither drawn nor moved. Returns whether there is any. */
static int find_need(occlusion_job* it)
{
  const int32_t nx = it->bins->tiles[0], ny = it->bins->tiles[1];
  const double across = CHI_TET_TILE / it->planes.scene->scale;
  const double gone = it->slab > 0 ? it->planes.reach[it->slab - 1] : 0;
  int any = 0;
  for (int32_t i = 0; i < nx * ny; ++i)
  {
    slab_tile* const t = it->tiles + i;
    const int live = t->last >= it->slab && !(it->skips && t->opaque);
    /* two pixels more: light is read with its neighbours, and between rows */
    const double far = live ? ceil((it->planes.reach[t->last] - gone + 2) / across) : -1;
    t->within = (int32_t)fmin(far, nx + ny);
    any |= live;
  }
  for (int sweep = 0; sweep < 2; ++sweep)
  {
    const int32_t to = sweep ? -1 : 1;
    for (int32_t j = 0; j < ny; ++j)
    {
      for (int32_t i = 0; i < nx; ++i)
      {
        const int32_t x = sweep ? nx - 1 - i : i, y = sweep ? ny - 1 - j : j;
        slab_tile* const t = it->tiles + y * nx + x;
        const int32_t around[4][2] = { { x - to, y }, { x - to, y - to }, { x, y - to },
          { x + to, y - to } };
        for (int k = 0; k < 4; ++k)
        {
          const int32_t u = around[k][0], v = around[k][1];
          if (u >= 0 && u < nx && v >= 0 && v < ny && it->tiles[v * nx + u].within - 1 > t->within)
          {
            t->within = it->tiles[v * nx + u].within - 1;
          }
        }
      }
    }
  }
  const int32_t each = CHI_TET_TILE / it->planes.scene->scale / CHI_SEGMENT;
  for (int32_t y = 0; y < ny; ++y)
  {
    for (int32_t k = 0; k < it->planes.segments; ++k)
    {
      it->need[y * it->planes.segments + k] = it->tiles[y * nx + k / each].within >= 0;
    }
  }
  return any;
}

/* A tile's pixels, and its light pixels and segments, inside of the picture. */
typedef struct tile_box
{
  int32_t x0, y0, x1, y1;
  int32_t rows[2], segments[2];
} tile_box;

static tile_box find_box(const occlusion_job* it, size_t tile)
{
  const chi_scene* const s = it->planes.scene;
  const int32_t nx = it->bins->tiles[0], high = CHI_TET_TILE / s->scale;
  const int32_t i = (int32_t)(tile % (size_t)nx), j = (int32_t)(tile / (size_t)nx);
  const int32_t each = high / CHI_SEGMENT;
  tile_box b = { i * CHI_TET_TILE, j * CHI_TET_TILE, (i + 1) * CHI_TET_TILE, (j + 1) * CHI_TET_TILE,
    { j * high, (j + 1) * high }, { i * each, (i + 1) * each } };
  b.x1 = b.x1 < s->width ? b.x1 : s->width;
  b.y1 = b.y1 < s->height ? b.y1 : s->height;
  b.rows[1] = b.rows[1] < s->light_height ? b.rows[1] : s->light_height;
  b.segments[1] = b.segments[1] < it->planes.segments ? b.segments[1] : it->planes.segments;
  return b;
}

/* What light leaves of colours at a light plane, for a tile. */
static void read_plane(const occlusion_job* it, const tile_box* b, slab_tile* t, int32_t plane)
{
  const chi_light_planes* const l = &it->planes;
  const int at = (plane + it->slabs->count * SEEN) % SEEN;
  t->bright[at] = 1;
  for (int32_t y = b->y0; y < b->y1; ++y)
  {
    float* const row = it->seen[at] + (size_t)y * l->stride;
    if (chi_light_read_row(l, &l->field[0][0], plane, it->strength, y, b->x0, b->x1, row))
    {
      t->bright[at] = 0;
    }
    else
    {
      chi_fill_ones(row + b->x0, b->x1 - b->x0);
    }
  }
  t->plane = plane;
}

/* The light of a tile's matter in this slab, plane by plane; 0 where it is all there is. */
static int find_light(const occlusion_job* it, const tile_box* b, slab_tile* t, const float** light)
{
  const int32_t first = it->slab - it->behind - 1;
  int bright = 1;
  for (int32_t plane = t->plane < first ? first : t->plane + 1; plane < first + SEEN; ++plane)
  {
    read_plane(it, b, t, plane);
  }
  for (int k = 0; k < SEEN; ++k)
  {
    const int at = (first + k + it->slabs->count * SEEN) % SEEN;
    light[k] = it->seen[at] + (size_t)b->y0 * it->planes.stride + b->x0;
    bright &= t->bright[at];
  }
  return !bright;
}

static void draw_list(const occlusion_job* it, const uint32_t* list, size_t count,
  const tile_box* b, chi_tet_target* target, chi_tet_tally* tally)
{
  uint64_t part[LIST];
  for (size_t end = count; end > 0;) /* from the last, which is the nearest */
  {
    const size_t n = end < LIST ? end : LIST;
    for (size_t i = 0; i < n; ++i)
    {
      part[i] = list[end - n + i];
    }
    it->kernels->draw(&it->scene, part, n, b->x0, b->y0, target, tally);
    end -= n;
  }
}

/* The slab's layer behind the picture; whether some pixel still lets light through. */
static int merge_layer(const occlusion_job* it, const tile_box* b, const float* layer)
{
  const chi_tet_scene* const s = &it->scene;
  int clear = 0;
  for (int32_t y = b->y0; y < b->y1; ++y)
  {
    const double slope_y = s->first[1] + s->step[1] * y;
    const chi_tet_slab_row row = { .layer = layer + 4 * (y - b->y0) * CHI_TET_TILE,
      .count = b->x1 - b->x0,
      .rgba = it->rgba + 4 * ((size_t)y * (size_t)s->width + (size_t)b->x0),
      .tau = tau_row(&it->planes, it->slab, y) + b->x0,
      .slope = s->parallel ? 0 : (float)(s->first[0] + s->step[0] * b->x0),
      .slope_x = s->parallel ? 0 : (float)s->step[0],
      .square = s->parallel ? 1 : (float)(1 + slope_y * slope_y),
      .opaque = CHI_SATURATED };
    clear |= it->kernels->merge(&row);
  }
  return clear;
}

static void draw_tile(const occlusion_job* it, size_t tile)
{
  slab_tile* const t = it->tiles + tile;
  if (t->within < 0)
  {
    return;
  }
  const chi_light_planes* const l = &it->planes;
  const tile_box b = find_box(it, tile);
  const uint32_t* const before =
    (const uint32_t*)it->slabs->before.data + tile * (size_t)(it->slabs->count + 1) + it->slab;
  const size_t count = before[1] - before[0];
  for (int32_t y = b.rows[0]; y < b.rows[1]; ++y)
  {
    memset(l->tau_flag + y * l->segments + b.segments[0], count > 0,
      (size_t)(b.segments[1] - b.segments[0]));
  }
  if (!count)
  {
    for (int32_t y = b.y0; y < b.y1 && t->has_tau[it->slab & 1]; ++y)
    {
      memset(tau_row(l, it->slab, y) + b.x0, 0, CHI_TET_TILE * sizeof(float));
    }
    t->has_tau[it->slab & 1] = 0;
    return;
  }
  _Alignas(64) float layer[4 * CHI_TET_TILE_PIXELS];
  for (int i = 0; i < CHI_TET_TILE_PIXELS; ++i)
  {
    layer[4 * i] = layer[4 * i + 1] = layer[4 * i + 2] = 0;
    layer[4 * i + 3] = 1;
  }
  chi_tet_target target = { .rgba = layer };
  const float* light[SEEN];
  if (!t->opaque && find_light(it, &b, t, light))
  {
    memcpy(target.light, light, sizeof light);
    target.light_stride = l->stride;
  }
  const uint32_t* const list = (const uint32_t*)it->slabs->list.data +
    ((const size_t*)it->slabs->starts.data)[tile] + before[0];
  draw_list(it, list, count, &b, &target, it->tally + tile);
  t->opaque = (uint8_t)!merge_layer(it, &b, layer);
  t->has_tau[it->slab & 1] = 1;
}

static void draw_tiles(void* data, size_t begin, size_t end)
{
  const occlusion_job* const it = (const occlusion_job*)data;
  for (size_t tile = begin; tile < end && !chi_is_cancelled(it->exec); ++tile)
  {
    draw_tile(it, tile);
  }
}

static void light_bands(void* data, size_t begin, size_t end)
{
  const occlusion_job* const it = (const occlusion_job*)data;
  const chi_light_planes* const l = &it->planes;
  const int32_t high = CHI_TET_TILE / l->scene->scale;
  for (size_t band = begin; band < end && !chi_is_cancelled(it->exec); ++band)
  {
    const int64_t first = (int64_t)band * BAND, last = first + BAND;
    const int64_t rows[2] = { first,
      last < l->scene->light_height ? last : l->scene->light_height };
    light_counts counts = { 0, 0, 0 };
    chi_light_band(l, it->slab, rows, it->need + first / high * l->segments, &counts);
  }
}

static void clear_rows(void* data, size_t begin, size_t end)
{
  const occlusion_job* const it = (const occlusion_job*)data;
  const size_t width = (size_t)it->scene.width;
  for (size_t i = begin * width; i < end * width; ++i)
  {
    memset(it->rgba + 4 * i, 0, 3 * sizeof(float));
    it->rgba[4 * i + 3] = 1;
  }
}

static void finish_rows(void* data, size_t begin, size_t end)
{
  const occlusion_job* const it = (const occlusion_job*)data;
  const size_t width = (size_t)it->scene.width;
  for (size_t i = begin * width; i < end * width; ++i)
  {
    it->rgba[4 * i + 3] = 1 - it->rgba[4 * i + 3];
  }
}

/*------------------------------------------------------------------------------------------------*/
static void place_slabs(
  chi_tet_occlusion* o, const chi_tet_frame* f, double cell, chi_occlusion_params* params)
{
  const chi_tet_params* const p = f->params;
  chi_occlusion_default_params(params);
  params->half_size = !p->full_size_light;
  params->directions = p->direction_count ? p->direction_count : params->directions;
  if (p->cone_angle_degrees > 0)
  {
    params->cone_angle_rad = p->cone_angle_degrees * 0.017453292519943295;
  }
  params->bias = p->occlusion_bias > 0 ? p->occlusion_bias : 2 * cell;
  const double depths[2] = { o->slabs.start, chi_tet_slabs_border(&o->slabs, o->slabs.count) };
  memset(&o->scene, 0, sizeof o->scene);
  chi_scene_build_slabs(&o->scene, f->camera, params, depths, o->slabs.count);
}

/* Memory of the slabs, and light that is bright throughout. */
static chi_status prepare(occlusion_job* it, chi_tet_occlusion* o, const chi_tet_frame* f,
  const chi_occlusion_params* params)
{
  const chi_exec* const exec = it->exec;
  chi_light_planes* const l = &it->planes;
  const size_t tiles = (size_t)it->bins->tiles[0] * (size_t)it->bins->tiles[1];
  *l = (chi_light_planes){ .exec = exec,
    .scene = &o->scene,
    .params = params,
    .kernels = chi_kernels(),
    .skip = it->skips ? CHI_SKIP_SATURATED_LIGHT | CHI_SKIP_UNREACHED_LIGHT : 0 };
  chi_light_layout(l);
  const size_t plane = l->rows * l->stride;
  /* fragments of whole tiles read light, those outside of the picture too */
  const size_t seen = (size_t)it->bins->tiles[1] * CHI_TET_TILE * l->stride;
  const size_t need = (size_t)it->bins->tiles[1] * (size_t)l->segments;
  if (!chi_buffer_reserve(exec, &o->tau, 2 * plane, sizeof(float)) ||
    !chi_buffer_reserve(exec, &o->seen, SEEN * seen, sizeof(float)) ||
    !chi_buffer_reserve(exec, &o->tiles, tiles, sizeof(slab_tile)) ||
    !chi_buffer_reserve(exec, &o->need, need, 1) ||
    (f->surface && !chi_buffer_reserve(exec, &o->surfaces, GEOMETRY_PLANES * plane, sizeof(float))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(o->tau.data, 0, 2 * plane * sizeof(float));
  memset(o->seen.data, 0, SEEN * seen * sizeof(float));
  l->tau[0] = (float*)o->tau.data;
  l->tau[1] = l->tau[0] + plane;
  l->tau_step = l->stride;
  for (int k = 0; k < SEEN; ++k)
  {
    it->seen[k] = (float*)o->seen.data + (size_t)k * seen;
  }
  /* Light of the slab's near limit is read at plane slab - bias - 1/2, of its far limit at the next
   * one: in between it is linear to the plane that lies there, and from there on. */
  const double near = -o->scene.sample_bias - 0.5;
  it->behind =
    -(int32_t)ceil(fmax(near, -2.0 * o->slabs.count - 2)); /* then all is before plane 0 */
  it->scene.knot = (float)(-it->behind - fmax(near, -it->behind - 1.0));
  it->need = (uint8_t*)o->need.data;
  it->tiles = (slab_tile*)o->tiles.data;
  for (size_t i = 0; i < tiles; ++i)
  {
    const uint32_t* const before =
      (const uint32_t*)o->slabs.before.data + i * (size_t)(o->slabs.count + 1);
    int32_t last = o->slabs.count - 1;
    while (last >= 0 && before[last + 1] == before[last])
    {
      --last;
    }
    it->tiles[i] = (slab_tile){ .last = last, .plane = -4 * o->slabs.count };
  }
  for (int c = 0; c < o->scene.channels; ++c)
  {
    o->light.field[0][c].volume = 1;
    o->light.field[0][c].geometry = f->surface != NULL;
  }
  chi_status status = chi_light_prepare(l, &o->light, 1, f->surface != NULL);
  if (status == CHI_OK && f->surface)
  {
    l->surfaces = (float*)o->surfaces.data;
    const chi_surface_view depth = { .struct_size = sizeof depth, .depth = f->surface->depth };
    status = chi_surface_intervals(exec, &o->scene, &depth, params->geometry_thickness,
      GEOMETRY_PLANES * l->stride, l->stride, surface_row(l, SURFACE, 0),
      surface_row(l, RECEIVER, 0), surface_row(l, BLOCK_BEGIN, 0), surface_row(l, BLOCK_END, 0));
  }
  return status == CHI_OK && f->surface
    ? chi_for(exec, (size_t)o->scene.light_height, chi_light_touch_rows, l)
    : status;
}

/* All slabs that something is still to be seen in. */
static chi_status march(occlusion_job* it, chi_tet_occlusion_result* result)
{
  const chi_scene* const s = it->planes.scene;
  const size_t tiles = (size_t)it->bins->tiles[0] * (size_t)it->bins->tiles[1];
  const size_t bands = (size_t)(s->light_height + BAND - 1) / BAND;
  chi_status status = CHI_OK;
  for (; it->slab < it->slabs->count && status == CHI_OK && find_need(it); ++it->slab)
  {
    it->scene.limited = 1;
    for (int k = 0; k < 2; ++k)
    {
      it->scene.limits[k] = (float)chi_tet_slabs_border(it->slabs, it->slab + k);
    }
    status = chi_for(it->exec, tiles, draw_tiles, it);
    const double begin = chi_seconds();
    status = status == CHI_OK ? chi_for(it->exec, bands, light_bands, it) : status;
    result->seconds_light += chi_seconds() - begin;
  }
  result->slabs = it->slab;
  return status;
}

chi_status chi_tet_occlude(const chi_exec* exec, chi_tet_occlusion** keep, chi_tet_bins* bins,
  const chi_tet_scene* scene, const chi_tet_frame* frame, double cell, float* rgba,
  chi_tet_occlusion_result* result)
{
  memset(result, 0, sizeof *result);
  if (!*keep)
  {
    *keep = (chi_tet_occlusion*)chi_alloc(exec, 1, sizeof **keep);
    if (!*keep)
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    memset(*keep, 0, sizeof **keep);
  }
  chi_tet_occlusion* const o = *keep;
  const size_t tiles = (size_t)bins->tiles[0] * (size_t)bins->tiles[1];
  if (!chi_buffer_reserve(exec, &bins->tallies, tiles, sizeof(chi_tet_tally)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(bins->tallies.data, 0, tiles * sizeof(chi_tet_tally));
  const chi_tet_params* const p = frame->params;
  occlusion_job job = { .exec = exec,
    .bins = bins,
    .kernels = chi_tet_get_kernels(),
    .scene = *scene,
    .slabs = &o->slabs,
    .rgba = rgba,
    .strength = (float)p->occlusion_strength,
    .skips = (p->skip & CHI_TET_SKIP_SATURATED) != 0,
    .tally = (chi_tet_tally*)bins->tallies.data };
  chi_status status = chi_tet_slabs_build(
    exec, &o->slabs, bins, scene, p->occlusion_slabs ? p->occlusion_slabs : 128);
  status = status == CHI_OK ? chi_for(exec, (size_t)scene->height, clear_rows, &job) : status;
  if (status == CHI_OK && o->slabs.count)
  {
    chi_occlusion_params params;
    place_slabs(o, frame, cell, &params);
    status = prepare(&job, o, frame, &params);
    status = status == CHI_OK ? march(&job, result) : status;
  }
  for (size_t i = 0; i < tiles; ++i)
  {
    result->tally.tetrahedra += job.tally[i].tetrahedra;
    result->tally.fragments += job.tally[i].fragments;
    result->tally.delicate += job.tally[i].delicate;
  }
  result->bytes = job.planes.bytes + o->tau.bytes + o->seen.bytes + o->surfaces.bytes +
    o->slabs.before.bytes + o->slabs.list.bytes;
  return status == CHI_OK ? chi_for(exec, (size_t)scene->height, finish_rows, &job) : status;
}

void chi_tet_occlusion_destroy(const chi_exec* exec, chi_tet_occlusion* o)
{
  if (!o)
  {
    return;
  }
  chi_tet_slabs_free(exec, &o->slabs);
  chi_light_free(exec, &o->light);
  chi_buffer_free(exec, &o->tau);
  chi_buffer_free(exec, &o->seen);
  chi_buffer_free(exec, &o->surfaces);
  chi_buffer_free(exec, &o->tiles);
  chi_buffer_free(exec, &o->need);
  chi_free(exec, o, 1, sizeof *o);
}
