/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_internal.h"

#include <math.h>
#include <stdatomic.h>

/* A tile ends where all its pixels let less light through than this: half of 1/255 of 8 bits. */
#define STOP 2e-3f

typedef struct draw_job
{
  const chi_exec* exec;
  const chi_tet_bins* bins;
  const chi_tet_scene* scene;
  const chi_tet_kernels* kernels;
  const chi_tet_pass* pass;
  const uint32_t* order; /* of the tiles: those with most to draw first */
  float stop;
  chi_tet_tally* tally; /* [tiles] */
  atomic_size_t next;
} draw_job;

static float opacity_of(const chi_tet_scene* s, float extinction)
{
  const float depth = s->maximum_of_unit * extinction;
  return s->image_opacity ? -expm1f(-depth) : depth < 1 ? depth : 1;
}

/* At both places of the largest value. */
static void finish_plane(const chi_tet_scene* s, const float in[4], float out[4])
{
  const int32_t width = s->tables->count + 1, last = s->plane_rows - 2;
  const int32_t i = (int32_t)in[0], j = (int32_t)in[1] < last ? (int32_t)in[1] : last;
  const float u = in[0] - (float)i, v = in[1] - (float)j;
  const float(*const low)[4] = s->plane + i + (size_t)j * (size_t)width;
  const float(*const high)[4] = low + width;
  float at[4];
  for (int c = 0; c < 4; ++c)
  {
    const float below = low[0][c] + u * (low[1][c] - low[0][c]);
    at[c] = below + v * (high[0][c] + u * (high[1][c] - high[0][c]) - below);
  }
  out[3] = opacity_of(s, at[3]);
  for (int c = 0; c < 3; ++c)
  {
    out[c] = at[c] * out[3];
  }
}

/* Colours of the largest values, and what is one minus transmittance elsewhere. */
static void finish_pixel(const chi_tet_scene* s, const float in[4], float out[4])
{
  if (!s->maximum)
  {
    out[0] = in[0];
    out[1] = in[1];
    out[2] = in[2];
    out[3] = 1 - in[3];
    return;
  }
  out[0] = out[1] = out[2] = out[3] = 0;
  if (in[0] >= 0 && s->plane)
  {
    finish_plane(s, in, out);
  }
  else if (in[0] >= 0)
  {
    float at[2][4];
    for (int q = 0; q < 2; ++q)
    {
      const int last = s->tables->count - 2;
      const float place = in[s->colors ? 0 : q]; /* of direct colours one scalar has all */
      const int i = (int)place < last ? (int)place : last;
      const float f = place - (float)i;
      for (int k = 0; k < 4; ++k)
      {
        at[q][k] =
          s->tables->color[i][k] + f * (s->tables->color[i + 1][k] - s->tables->color[i][k]);
      }
    }
    out[3] = opacity_of(s, at[1][3]);
    for (int k = 0; k < 3; ++k)
    {
      out[k] = (s->colors ? in[1 + k] : at[0][k]) * out[3];
    }
  }
}

static void store_tile(const draw_job* job, const float* tile, int32_t x0, int32_t y0)
{
  const chi_tet_scene* const s = job->scene;
  for (int32_t y = 0; y < CHI_TET_TILE && y0 + y < s->height; ++y)
  {
    for (int32_t x = 0; x < CHI_TET_TILE && x0 + x < s->width; ++x)
    {
      finish_pixel(s, tile + 4 * (y * CHI_TET_TILE + x),
        job->pass->rgba + 4 * ((size_t)(y0 + y) * (size_t)s->width + (size_t)(x0 + x)));
    }
  }
}

static void store_picks(const draw_job* job, const chi_tet_target* target, int32_t x0, int32_t y0)
{
  const chi_tet_scene* const s = job->scene;
  for (int32_t y = 0; y < CHI_TET_TILE && y0 + y < s->height; ++y)
  {
    for (int32_t x = 0; x < CHI_TET_TILE && x0 + x < s->width; ++x)
    {
      const int i = y * CHI_TET_TILE + x;
      const size_t to = (size_t)(y0 + y) * (size_t)s->width + (size_t)(x0 + x);
      const int any = target->pick_alpha[i] > 1.0f / 255;
      const uint32_t t = target->pick[i];
      job->pass->picks->cells[to] = any ? (int64_t)(s->cells ? s->cells[t] : t) : -1;
      job->pass->picks->depths[to] = any ? target->pick_depth[i] : INFINITY;
    }
  }
}

/* By a function of its own, so that the stack of other frames stays as small as it was. */
static __attribute__((noinline)) void draw_splatted(const draw_job* job, const uint64_t* list,
  size_t count, const int32_t tile[2], chi_tet_target* target, chi_tet_tally* tally)
{
  chi_tet_splatter splatter;
  splatter.scene = job->scene;
  splatter.integrals = job->pass->integrals;
  splatter.target = target;
  splatter.tile[0] = tile[0];
  splatter.tile[1] = tile[1];
  tally->splatted = chi_tet_splat_begin(&splatter, list, count);
  target->projector = tally->splatted ? &splatter.projector : NULL;
  job->kernels->draw(job->scene, list, count, tile[0], tile[1], target, tally);
  if (!tally->splatted)
  {
    store_tile(job, target->rgba, tile[0], tile[1]);
    return;
  }
  chi_tet_splat_end(&splatter);
  store_tile(job, target->rgba, tile[0], tile[1]);
  const int32_t width = job->scene->width, height = job->scene->height;
  for (int32_t i = 0; i < CHI_TET_TILE_PIXELS; ++i)
  {
    const int32_t x = tile[0] + i % CHI_TET_TILE, y = tile[1] + i / CHI_TET_TILE;
    if (x < width && y < height)
    {
      job->pass->rgba[4 * ((size_t)y * (size_t)width + (size_t)x) + 3] =
        chi_tet_splat_alpha(&splatter, i);
    }
  }
}

static void draw_tile(draw_job* job, size_t tile)
{
  _Alignas(64) float rgba[4 * CHI_TET_TILE_PIXELS];
  const chi_tet_scene* const s = job->scene;
  const size_t* const starts = (const size_t*)job->bins->starts.data;
  const int32_t x0 = (int32_t)(tile % (size_t)job->bins->tiles[0]) * CHI_TET_TILE;
  const int32_t y0 = (int32_t)(tile / (size_t)job->bins->tiles[0]) * CHI_TET_TILE;
  for (int i = 0; i < CHI_TET_TILE_PIXELS; ++i)
  {
    rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = s->maximum ? -1.0f : 0.0f;
    const int inside = x0 + i % CHI_TET_TILE < s->width && y0 + i / CHI_TET_TILE < s->height;
    rgba[4 * i + 3] = inside ? 1.0f : 0.0f; /* pixels outside of the picture are not waited for */
  }
  const uint64_t* const list = (const uint64_t*)job->bins->list.data + starts[tile];
  const size_t count = starts[tile + 1] - starts[tile];
  chi_tet_target target = { .rgba = rgba, .stop = s->maximum ? 0 : job->stop };
  chi_tet_projector published = { .draw = chi_tet_publish };
  target.projector = job->pass->published ? &published : NULL;
  chi_tet_cached cached;
  if (job->pass->cache_use == CHI_TET_CACHE_WRITE || job->pass->cache_use == CHI_TET_CACHE_READ)
  {
    const chi_tet_cache* const cache = job->pass->cache;
    const size_t* const from = (const size_t*)cache->starts.data + tile;
    cached = (chi_tet_cached){ (uint16_t*)cache->pixels.data + from[0],
      (uint16_t(*)[2])cache->ends.data + from[0], (float*)cache->lengths.data + from[0], 0 };
    target.cached = &cached;
    if (job->pass->cache_use == CHI_TET_CACHE_READ)
    {
      cached.count = from[1] - from[0];
      job->kernels->draw_cached(s, &target, job->tally + tile);
      store_tile(job, rgba, x0, y0);
      return;
    }
  }
  if (!job->pass->picks)
  {
    if (job->pass->integrals)
    {
      draw_splatted(job, list, count, (int32_t[2]){ x0, y0 }, &target, job->tally + tile);
    }
    else
    {
      job->kernels->draw(s, list, count, x0, y0, &target, job->tally + tile);
      job->tally[tile].left = published.left;
      store_tile(job, rgba, x0, y0);
    }
    return;
  }
  float alpha[CHI_TET_TILE_PIXELS] = { 0 }, depth[CHI_TET_TILE_PIXELS];
  uint32_t id[CHI_TET_TILE_PIXELS];
  target.pick_alpha = alpha;
  target.pick = id;
  target.pick_depth = depth;
  target.pick_opacity = (float)job->pass->picks->opacity;
  target.stop = 0;
  job->kernels->draw(s, list, count, x0, y0, &target, job->tally + tile);
  store_picks(job, &target, x0, y0);
}

/* Each call takes as many tiles as it was given, whichever are next: the largest come first, so
 * that no thread is left with one at the end. Tiles do not depend on each other. */
static void draw_tiles(void* data, size_t begin, size_t end)
{
  draw_job* const job = (draw_job*)data;
  for (size_t i = begin; i < end && !chi_is_cancelled(job->exec); ++i)
  {
    draw_tile(job, job->order[atomic_fetch_add(&job->next, 1)]);
  }
}

/* Tiles by the length of their lists, longest first. */
static void order_tiles(const size_t* starts, size_t tiles, uint32_t* order)
{
  size_t longest = 0;
  for (size_t i = 0; i < tiles; ++i)
  {
    longest = starts[i + 1] - starts[i] > longest ? starts[i + 1] - starts[i] : longest;
  }
  enum
  {
    CLASSES = 256
  };
  uint32_t place[CLASSES + 1] = { 0 };
  const double scale = longest ? (double)(CLASSES - 1) / (double)longest : 0;
  for (size_t i = 0; i < tiles; ++i)
  {
    ++place[CLASSES - (size_t)((double)(starts[i + 1] - starts[i]) * scale)];
  }
  for (int i = 0; i < CLASSES; ++i)
  {
    place[i + 1] += place[i];
  }
  for (size_t i = 0; i < tiles; ++i)
  {
    order[place[CLASSES - 1 - (size_t)((double)(starts[i + 1] - starts[i]) * scale)]++] =
      (uint32_t)i;
  }
}

chi_status chi_tet_draw(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_scene* scene,
  const chi_tet_pass* pass, chi_tet_tally* tally)
{
  const size_t tiles = (size_t)bins->tiles[0] * (size_t)bins->tiles[1];
  const int counts = pass->cache_use == CHI_TET_CACHE_COUNT;
  if (!chi_buffer_reserve(exec, &bins->order, tiles, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &bins->tallies, tiles, sizeof(chi_tet_tally)) ||
    (counts && !chi_buffer_reserve(exec, &pass->cache->starts, tiles + 1, sizeof(size_t))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_tet_tally* const each = (chi_tet_tally*)bins->tallies.data;
  memset(each, 0, tiles * sizeof *each);
  order_tiles((const size_t*)bins->starts.data, tiles, (uint32_t*)bins->order.data);
  draw_job job = { .exec = exec,
    .bins = bins,
    .scene = scene,
    .kernels = chi_tet_get_kernels(),
    .pass = pass,
    .order = (const uint32_t*)bins->order.data,
    /* what is left out now may be wanted under other colours */
    .stop = pass->skip_saturated && !counts && pass->cache_use != CHI_TET_CACHE_WRITE ? STOP : 0,
    .tally = each };
  atomic_init(&job.next, 0);
  const chi_status status = chi_for(exec, tiles, draw_tiles, &job);
  *tally = (chi_tet_tally){ 0 };
  for (size_t i = 0; i < tiles; ++i)
  {
    if (counts)
    {
      ((size_t*)pass->cache->starts.data)[i] = (size_t)tally->fragments;
      ((size_t*)pass->cache->starts.data)[i + 1] = (size_t)(tally->fragments + each[i].fragments);
    }
    tally->tetrahedra += each[i].tetrahedra;
    tally->flat += each[i].flat;
    tally->delicate += each[i].delicate;
    tally->fragments += each[i].fragments;
    tally->saturated += each[i].saturated;
    tally->left += each[i].left;
    tally->splatted += each[i].splatted;
  }
  return status;
}

int chi_tet_cache_reserve(const chi_exec* exec, chi_tet_cache* cache, size_t tiles, size_t limit)
{
  const size_t count = ((const size_t*)cache->starts.data)[tiles];
  const size_t each = 3 * sizeof(uint16_t) + sizeof(float);
  return count <= limit / each &&
    chi_buffer_reserve(exec, &cache->pixels, count + 1, sizeof(uint16_t)) &&
    chi_buffer_reserve(exec, &cache->ends, count + 1, 2 * sizeof(uint16_t)) &&
    chi_buffer_reserve(exec, &cache->lengths, count + 1, sizeof(float));
}

void chi_tet_cache_free(const chi_exec* exec, chi_tet_cache* cache)
{
  chi_buffer_free(exec, &cache->starts);
  chi_buffer_free(exec, &cache->pixels);
  chi_buffer_free(exec, &cache->ends);
  chi_buffer_free(exec, &cache->lengths);
}
