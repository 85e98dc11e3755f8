/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* The tetrahedra of every tile and slab of depths, in order. */
#include "chi_tet_occlusion.h"

#include <math.h>

typedef struct slab_job
{
  const chi_exec* exec;
  const chi_tet_bins* bins;
  const chi_tet_scene* scene;
  chi_tet_slabs* slabs;
  double (*depths)[2]; /* [tiles] nearest, farthest */
} slab_job;

static void depths_of(const chi_tet_scene* scene, uint32_t id, double depths[2])
{
  const uint32_t* const v = scene->vertices + 4 * (size_t)id;
  depths[0] = depths[1] = scene->points[v[0]].z;
  for (int i = 1; i < 4; ++i)
  {
    const double z = scene->points[v[i]].z;
    depths[0] = z < depths[0] ? z : depths[0];
    depths[1] = z > depths[1] ? z : depths[1];
  }
}

static void find_depths(void* data, size_t begin, size_t end)
{
  const slab_job* const it = (const slab_job*)data;
  const size_t* const starts = (const size_t*)it->bins->starts.data;
  const uint64_t* const list = (const uint64_t*)it->bins->list.data;
  for (size_t tile = begin; tile < end; ++tile)
  {
    double nearest = INFINITY, farthest = -INFINITY;
    for (size_t i = starts[tile]; i < starts[tile + 1]; ++i)
    {
      double depths[2];
      depths_of(it->scene, (uint32_t)list[i], depths);
      nearest = depths[0] < nearest ? depths[0] : nearest;
      farthest = depths[1] > farthest ? depths[1] : farthest;
    }
    it->depths[tile][0] = nearest;
    it->depths[tile][1] = farthest;
  }
}

/* First and last slab that a tetrahedron may have a part in; 0 where there is none. */
static int slabs_of(const slab_job* it, uint32_t id, int32_t range[2])
{
  const chi_tet_slabs* const s = it->slabs;
  double depths[2];
  depths_of(it->scene, id, depths);
  for (int k = 0; k < 2; ++k)
  {
    /* limits are floats: what rounding moves across a border belongs to both slabs */
    const double at = (depths[k] - s->start) / s->slab + (k ? s->margin : -s->margin);
    range[k] = (int32_t)floor(fmin(fmax(at, -1), s->count));
  }
  range[0] = range[0] > 0 ? range[0] : 0;
  range[1] = range[1] < s->count ? range[1] : s->count - 1;
  return range[0] <= range[1];
}

/* How many there are in each slab, and before it. */
static void count(void* data, size_t begin, size_t end)
{
  const slab_job* const it = (const slab_job*)data;
  const size_t* const starts = (const size_t*)it->bins->starts.data;
  const uint64_t* const list = (const uint64_t*)it->bins->list.data;
  const int32_t slabs = it->slabs->count;
  for (size_t tile = begin; tile < end && !chi_is_cancelled(it->exec); ++tile)
  {
    uint32_t* const before = (uint32_t*)it->slabs->before.data + tile * (size_t)(slabs + 1);
    memset(before, 0, (size_t)(slabs + 1) * sizeof *before);
    for (size_t i = starts[tile]; i < starts[tile + 1]; ++i)
    {
      int32_t range[2];
      if (slabs_of(it, (uint32_t)list[i], range)) /* differences from slab to slab */
      {
        ++before[range[0]];
        --before[range[1] + 1];
      }
    }
    uint32_t here = 0;
    size_t sum = 0;
    for (int32_t k = 0; k <= slabs; ++k)
    {
      here += before[k];
      before[k] = (uint32_t)sum;
      sum += here;
    }
    ((size_t*)it->slabs->starts.data)[tile + 1] = sum;
  }
}

static void fill(void* data, size_t begin, size_t end)
{
  const slab_job* const it = (const slab_job*)data;
  const size_t* const starts = (const size_t*)it->bins->starts.data;
  const uint64_t* const list = (const uint64_t*)it->bins->list.data;
  const size_t slabs = (size_t)it->slabs->count;
  for (size_t tile = begin; tile < end && !chi_is_cancelled(it->exec); ++tile)
  {
    uint32_t* const before = (uint32_t*)it->slabs->before.data + tile * (slabs + 1);
    uint32_t* const out =
      (uint32_t*)it->slabs->list.data + ((const size_t*)it->slabs->starts.data)[tile];
    for (size_t i = starts[tile]; i < starts[tile + 1]; ++i)
    {
      int32_t range[2];
      if (slabs_of(it, (uint32_t)list[i], range))
      {
        for (int32_t k = range[0]; k <= range[1]; ++k)
        {
          out[before[k]++] = (uint32_t)list[i];
        }
      }
    }
    for (size_t k = slabs; k > 0; --k) /* each has become the next one's */
    {
      before[k] = before[k - 1];
    }
    before[0] = 0;
  }
}

chi_status chi_tet_slabs_build(const chi_exec* exec, chi_tet_slabs* slabs, const chi_tet_bins* bins,
  const chi_tet_scene* scene, int32_t count_wanted)
{
  const size_t tiles = (size_t)bins->tiles[0] * (size_t)bins->tiles[1];
  slabs->count = 0;
  if (!chi_buffer_reserve(exec, &slabs->depths, tiles, 2 * sizeof(double)) ||
    !chi_buffer_reserve(exec, &slabs->starts, tiles + 1, sizeof(size_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  slab_job job = { exec, bins, scene, slabs, (double(*)[2])slabs->depths.data };
  chi_status status = chi_for(exec, tiles, find_depths, &job);
  double nearest = INFINITY, farthest = -INFINITY;
  for (size_t tile = 0; tile < tiles && status == CHI_OK; ++tile)
  {
    nearest = fmin(nearest, job.depths[tile][0]);
    farthest = fmax(farthest, job.depths[tile][1]);
  }
  nearest = fmax(nearest, scene->near_depth);
  if (status != CHI_OK || !(nearest < farthest))
  {
    return status;
  }
  /* a little more on both sides than rounding takes away */
  const double spare = 1e-6 * (farthest - nearest) + 1.2e-7 * fmax(fabs(nearest), fabs(farthest));
  nearest = fmax(nearest - spare, scene->near_depth);
  farthest += spare;
  slabs->count = count_wanted;
  slabs->start = nearest;
  slabs->slab = (farthest - nearest) / count_wanted;
  slabs->margin = 1.2e-7 * fmax(fabs(nearest), fabs(farthest)) / slabs->slab;
  if (!chi_buffer_reserve(
        exec, &slabs->before, tiles * (size_t)(count_wanted + 1), sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  status = chi_for(exec, tiles, count, &job);
  if (status != CHI_OK)
  {
    return status;
  }
  size_t* const starts = (size_t*)slabs->starts.data;
  starts[0] = 0;
  for (size_t tile = 0; tile < tiles; ++tile)
  {
    if (starts[tile + 1] > UINT32_MAX)
    {
      return CHI_ERROR_TOO_LARGE;
    }
    starts[tile + 1] += starts[tile];
  }
  if (!chi_buffer_reserve(exec, &slabs->list, starts[tiles] + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  return chi_for(exec, tiles, fill, &job);
}

void chi_tet_slabs_free(const chi_exec* exec, chi_tet_slabs* slabs)
{
  chi_buffer_free(exec, &slabs->depths);
  chi_buffer_free(exec, &slabs->starts);
  chi_buffer_free(exec, &slabs->before);
  chi_buffer_free(exec, &slabs->list);
}
