/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Bins before it sorts: the lists of a tile fit into the second cache, so that a radix sort of each
 * costs a fifth of that of all tetrahedra at once.
 */
#include "chi_tet_internal.h"

#include <math.h>

/* The points on the screen are floats: 16 roundings of the largest window, pixels. */
#define MARGIN 2e-2f

typedef struct bin_job
{
  const chi_tet_mesh* mesh;
  const chi_tet_values* values;
  const chi_tet_eye* eye;
  chi_tet_bins* bins;
  const float* depth;
  const uint32_t* codes;
  chi_tet_window window;
  int32_t width, height, bits;
  int32_t skip;        /* CHI_TET_SKIP_... */
  size_t chunk, tiles; /* tetrahedra, whole words of bits */
  size_t first_tile;   /* of those that are sorted at a time */
  int64_t (*tally)[4]; /* [chunks] outside, uncovered, clipped, hidden */
} bin_job;

enum
{
  OUTSIDE,
  UNCOVERED,
  CLIPPED,
  HIDDEN
};

/* Whether all of it lies behind the surface of every pixel of its tiles. */
static int is_hidden(const bin_job* it, const uint32_t v[4], uint32_t range)
{
  const chi_tet_point* const points = (const chi_tet_point*)it->eye->points.data;
  const float* const depths = (const float*)it->bins->depths.data;
  double nearest = points[v[0]].z;
  for (int i = 1; i < 4; ++i)
  {
    nearest = points[v[i]].z < nearest ? points[v[i]].z : nearest;
  }
  for (uint32_t y = range >> 8 & 255; y <= range >> 24; ++y)
  {
    for (uint32_t x = range & 255; x <= (range >> 16 & 255); ++x)
    {
      if (nearest < depths[y * (uint32_t)it->bins->tiles[0] + x])
      {
        return 0;
      }
    }
  }
  return 1;
}

/* One that has no pixels, for all that is known, among those of the tile next to its first vertex:
 * where it is not to be skipped. CHI_TET_OUTSIDE if its planes would not be finite. */
static uint32_t range_all_the_same(const bin_job* it, const uint32_t v[4])
{
  const chi_tet_point* const points = (const chi_tet_point*)it->eye->points.data;
  for (int i = 0; i < 4; ++i)
  {
    const chi_tet_point* const p = points + v[i];
    if (!(fabs(p->x) < CHI_TET_FAR && fabs(p->y) < CHI_TET_FAR && fabs(p->z) < CHI_TET_FAR))
    {
      return CHI_TET_OUTSIDE;
    }
  }
  const float* const at = ((const float(*)[2])it->eye->screen.data)[v[0]];
  uint32_t range = 0;
  for (int k = 0; k < 2; ++k)
  {
    const float last = (float)((k ? it->height : it->width) - 1);
    const float place = at[k] > 0 ? (at[k] < last ? at[k] : last) : 0; /* 0 too if not finite */
    const uint32_t tile = (uint32_t)place >> CHI_TET_TILE_SHIFT;
    range |= tile << (8 * k) | tile << (16 + 8 * k);
  }
  return range;
}

static void find_ranges(void* data, size_t begin, size_t end)
{
  const bin_job* const it = (const bin_job*)data;
  const uint32_t* const visible = (const uint32_t*)it->values->visible.data;
  uint32_t* const ranges = (uint32_t*)it->bins->scratch.data;
  uint32_t* const in_tile = (uint32_t*)it->bins->in_tile.data;
  const size_t n = it->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    uint32_t* const count = (uint32_t*)it->bins->counts.data + chunk * it->tiles;
    int64_t tally[4] = { 0 };
    memset(count, 0, it->tiles * sizeof *count);
    const size_t first = chunk * it->chunk < n ? chunk * it->chunk : n;
    const size_t past = n - first > it->chunk ? first + it->chunk : n;
    memset(in_tile + first / 32, 0, (past - first + 31) / 32 * sizeof *in_tile);
    chi_tet_get_kernels()->ranges(&it->window, first, past, ranges);
    for (size_t t = first; t < past; ++t)
    {
      uint32_t r = ranges[t];
      if (!(visible[t / 32] >> t % 32 & 1))
      {
        ranges[t] = CHI_TET_OUTSIDE;
        continue;
      }
      const uint32_t* const v = (const uint32_t*)it->mesh->vertices.data + 4 * t;
      if (r == CHI_TET_OUTSIDE || r == CHI_TET_UNCOVERED)
      {
        const int is_outside = r == CHI_TET_OUTSIDE;
        const int skips = it->skip & (is_outside ? CHI_TET_SKIP_OUTSIDE : CHI_TET_SKIP_UNCOVERED);
        r = skips ? r : range_all_the_same(it, v);
        if (skips || r == CHI_TET_OUTSIDE)
        {
          ++tally[is_outside ? OUTSIDE : UNCOVERED];
          ranges[t] = r;
          continue;
        }
        ranges[t] = r;
      }
      if (it->codes && it->codes[v[0]] & it->codes[v[1]] & it->codes[v[2]] & it->codes[v[3]])
      {
        ++tally[CLIPPED];
        ranges[t] = CHI_TET_OUTSIDE;
        continue;
      }
      if (it->depth && is_hidden(it, v, r))
      {
        ++tally[HIDDEN];
        ranges[t] = CHI_TET_OUTSIDE;
        continue;
      }
      in_tile[t / 32] |= (uint32_t)1 << t % 32;
      if ((r & 0xffff) == r >> 16) /* most lie in one tile */
      {
        ++count[(r >> 24) * (uint32_t)it->bins->tiles[0] + (r & 255)];
        continue;
      }
      for (uint32_t y = r >> 8 & 255; y <= r >> 24; ++y)
      {
        for (uint32_t x = r & 255; x <= (r >> 16 & 255); ++x)
        {
          ++count[y * (uint32_t)it->bins->tiles[0] + x];
        }
      }
    }
    memcpy(it->tally[chunk], tally, sizeof tally);
  }
}

static void scatter(void* data, size_t begin, size_t end)
{
  const bin_job* const it = (const bin_job*)data;
  const uint32_t* const ranges = (const uint32_t*)it->bins->scratch.data;
  const uint32_t* const keys = (const uint32_t*)it->bins->keys.data;
  uint64_t* const list = (uint64_t*)it->bins->list.data;
  const size_t* const starts = (const size_t*)it->bins->starts.data;
  const size_t n = it->mesh->counts.tetrahedra;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    uint32_t* const next = (uint32_t*)it->bins->counts.data + chunk * it->tiles;
    for (size_t t = chunk * it->chunk; t < n && t < (chunk + 1) * it->chunk; ++t)
    {
      const uint32_t r = ranges[t];
      if (r == CHI_TET_OUTSIDE || r == CHI_TET_UNCOVERED)
      {
        continue;
      }
      const uint64_t entry = (uint64_t)keys[t] << 32 | t;
      if ((r & 0xffff) == r >> 16)
      {
        const size_t tile = (r >> 24) * (uint32_t)it->bins->tiles[0] + (r & 255);
        list[starts[tile] + next[tile]++] = entry;
        continue;
      }
      for (uint32_t y = r >> 8 & 255; y <= r >> 24; ++y)
      {
        for (uint32_t x = r & 255; x <= (r >> 16 & 255); ++x)
        {
          const size_t tile = y * (uint32_t)it->bins->tiles[0] + x;
          list[starts[tile] + next[tile]++] = entry;
        }
      }
    }
  }
}

/* One pass of a radix sort, by eleven bits of how much entries exceed the lowest one. */
static void sort_pass(const uint64_t* from, uint64_t* to, size_t n, uint64_t low, int shift)
{
  uint32_t place[2048] = { 0 };
  for (size_t i = 0; i < n; ++i)
  {
    ++place[(from[i] - low) >> shift & 2047];
  }
  uint32_t sum = 0;
  for (size_t i = 0; i < 2048; ++i)
  {
    const uint32_t count = place[i];
    place[i] = sum;
    sum += count;
  }
  for (size_t i = 0; i < n; ++i)
  {
    to[place[(from[i] - low) >> shift & 2047]++] = from[i];
  }
}

/* Sorts what is nearly sorted; 0 where that would take long, as in layers that one looks at along
 * an axis. Entries of equal keys keep the order of their indices either way. */
static int insert(uint64_t* list, size_t n)
{
  size_t moves = 0;
  for (size_t i = 1; i < n; ++i)
  {
    const uint64_t entry = list[i];
    size_t j = i;
    for (; j > 0 && list[j - 1] > entry; --j)
    {
      list[j] = list[j - 1];
    }
    list[j] = entry;
    moves += i - j;
    if (moves > 2 * n)
    {
      return 0;
    }
  }
  return 1;
}

/* By the upper 22 bits of what keys differ by, in two passes, which the result is back in place
 * after; then what few entries are alike in these by all bits. */
static void sort(uint64_t* list, uint64_t* other, size_t n, int32_t bits)
{
  if (n < 2)
  {
    return;
  }
  int shift = 32;
  uint64_t low = 0;
  if (bits > 22)
  {
    uint64_t high = 0;
    low = UINT64_MAX;
    for (size_t i = 0; i < n; ++i)
    {
      low = list[i] < low ? list[i] : low;
      high = list[i] > high ? list[i] : high;
    }
    low &= ~(uint64_t)UINT32_MAX;
    for (shift = 32; (high - low) >> shift >= (uint64_t)1 << 22; ++shift)
    {
    }
  }
  sort_pass(list, other, n, low, shift);
  sort_pass(other, list, n, low, shift + 11);
  if (shift > 32 && !insert(list, n))
  {
    sort_pass(list, other, n, low, 32);
    sort_pass(other, list, n, low, 43);
    sort_pass(list, other, n, low, 54);
    memcpy(list, other, n * sizeof *list);
  }
}

static void sort_tiles(void* data, size_t begin, size_t end)
{
  const bin_job* const it = (const bin_job*)data;
  const size_t* const starts = (const size_t*)it->bins->starts.data + it->first_tile;
  for (size_t tile = begin; tile < end; ++tile)
  {
    const size_t n = starts[tile + 1] - starts[tile];
    uint64_t* const list = (uint64_t*)it->bins->list.data + starts[tile];
    uint64_t* const other = (uint64_t*)it->bins->scratch.data + (starts[tile] - starts[0]);
    sort(list, other, n, it->bits);
  }
}

/* Some tiles at a time, so that the scratch of sorts is where ranges of tiles have been, half as
 * long as the lists or less; a fifth of these at least, so that no host waits often. */
static chi_status sort_lists(const chi_exec* exec, bin_job* job)
{
  chi_tet_bins* const bins = job->bins;
  const size_t* const starts = (const size_t*)bins->starts.data;
  size_t room = (bins->entries + 4) / 5;
  for (size_t tile = 0; tile < job->tiles; ++tile)
  {
    const size_t n = starts[tile + 1] - starts[tile];
    room = n > room ? n : room;
  }
  if (!chi_buffer_reserve(exec, &bins->scratch, room, sizeof(uint64_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  room = bins->scratch.bytes / sizeof(uint64_t);
  chi_status status = CHI_OK;
  for (size_t past = 0; past < job->tiles && status == CHI_OK;)
  {
    job->first_tile = past;
    while (past < job->tiles && starts[past + 1] - starts[job->first_tile] <= room)
    {
      ++past;
    }
    status = chi_for(exec, past - job->first_tile, sort_tiles, job);
  }
  return status;
}

static void find_depths(const bin_job* it)
{
  float* const depths = (float*)it->bins->depths.data;
  for (size_t i = 0; i < it->tiles; ++i)
  {
    depths[i] = -INFINITY;
  }
  for (int32_t y = 0; y < it->height; ++y)
  {
    const float* const row = it->depth + (size_t)y * (size_t)it->width;
    float* const out = depths + (size_t)(y >> CHI_TET_TILE_SHIFT) * (size_t)it->bins->tiles[0];
    for (int32_t x = 0; x < it->width; ++x)
    {
      const float d = row[x] > 0 ? row[x] : INFINITY; /* no surface */
      float* const tile = out + (x >> CHI_TET_TILE_SHIFT);
      *tile = d > *tile ? d : *tile;
    }
  }
}

chi_status chi_tet_bins_build(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_eye* eye, const chi_tet_frame* frame, int32_t bits)
{
  const int32_t skip = frame->params->skip;
  const int32_t width = frame->camera->width, height = frame->camera->height;
  const size_t n = mesh->counts.tetrahedra;
  bins->tiles[0] = (width + CHI_TET_TILE - 1) / CHI_TET_TILE;
  bins->tiles[1] = (height + CHI_TET_TILE - 1) / CHI_TET_TILE;
  const size_t tiles = (size_t)bins->tiles[0] * (size_t)bins->tiles[1];
  int64_t tally[CHI_TET_CHUNKS][4];
  bin_job job = { .mesh = mesh,
    .values = values,
    .eye = eye,
    .bins = bins,
    .depth = frame->surface && skip & CHI_TET_SKIP_HIDDEN ? frame->surface->depth : NULL,
    .codes = frame->clip_plane_count && skip & CHI_TET_SKIP_CLIPPED
      ? (const uint32_t*)eye->codes.data
      : NULL,
    .window = { (const float(*)[2])eye->screen.data, (const uint32_t*)mesh->vertices.data, width,
      height, eye->any_beyond, frame->camera->parallel != 0, (const chi_tet_point*)eye->points.data,
      { eye->first[0], eye->first[1] }, { eye->step[0], eye->step[1] }, frame->camera->near_depth,
      frame->params->subpixel_splatting ? 0.5f + MARGIN : MARGIN },
    .width = width,
    .height = height,
    .bits = bits,
    .skip = skip,
    .chunk = (n / 32 + CHI_TET_CHUNKS) / CHI_TET_CHUNKS * 32,
    .tiles = tiles,
    .tally = tally };
  if (!chi_buffer_reserve(exec, &bins->scratch, n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &bins->in_tile, n / 32 + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &bins->counts, CHI_TET_CHUNKS * tiles, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &bins->depths, tiles, sizeof(float)) ||
    !chi_buffer_reserve(exec, &bins->starts, tiles + 1, sizeof(size_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  if (job.depth)
  {
    find_depths(&job);
  }
  chi_status status = chi_for(exec, CHI_TET_CHUNKS, find_ranges, &job);
  if (status != CHI_OK)
  {
    return status;
  }
  bins->outside = bins->uncovered = bins->clipped = bins->hidden = 0;
  for (int i = 0; i < CHI_TET_CHUNKS; ++i)
  {
    bins->outside += tally[i][OUTSIDE];
    bins->uncovered += tally[i][UNCOVERED];
    bins->clipped += tally[i][CLIPPED];
    bins->hidden += tally[i][HIDDEN];
  }
  size_t* const starts = (size_t*)bins->starts.data;
  size_t sum = 0;
  for (size_t tile = 0; tile < tiles; ++tile)
  {
    starts[tile] = sum;
    uint32_t in_tile = 0;
    for (size_t chunk = 0; chunk < CHI_TET_CHUNKS; ++chunk)
    {
      uint32_t* const count = (uint32_t*)bins->counts.data + chunk * tiles + tile;
      const uint32_t c = *count;
      *count = in_tile;
      in_tile += c;
    }
    sum += in_tile;
  }
  starts[tiles] = bins->entries = sum;
  if (!chi_buffer_reserve(exec, &bins->list, sum + 1, sizeof(uint64_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  status = chi_for(exec, CHI_TET_CHUNKS, scatter, &job);
  return status == CHI_OK ? sort_lists(exec, &job) : status;
}

chi_status chi_tet_sequence(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_mesh* mesh,
  int32_t bits, chi_buffer* sequence, size_t* count)
{
  const size_t n = mesh->counts.tetrahedra;
  const uint32_t* const in_tile = (const uint32_t*)bins->in_tile.data;
  const uint32_t* const keys = (const uint32_t*)bins->keys.data;
  if (!chi_buffer_reserve(exec, &bins->whole, 2 * (n + 1), sizeof(uint64_t)) ||
    !chi_buffer_reserve(exec, sequence, n + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  uint64_t* const list = (uint64_t*)bins->whole.data;
  size_t drawn = 0;
  for (size_t t = 0; t < n; ++t)
  {
    if (in_tile[t / 32] >> t % 32 & 1)
    {
      list[drawn++] = (uint64_t)keys[t] << 32 | t;
    }
  }
  sort(list, list + n + 1, drawn, bits);
  for (size_t i = 0; i < drawn; ++i)
  {
    ((uint32_t*)sequence->data)[i] = (uint32_t)list[i];
  }
  *count = drawn;
  return CHI_OK;
}

void chi_tet_bins_free(const chi_exec* exec, chi_tet_bins* bins)
{
  chi_buffer_free(exec, &bins->keys);
  chi_buffer_free(exec, &bins->in_tile);
  chi_buffer_free(exec, &bins->counts);
  chi_buffer_free(exec, &bins->starts);
  chi_buffer_free(exec, &bins->list);
  chi_buffer_free(exec, &bins->scratch);
  chi_buffer_free(exec, &bins->depths);
  chi_buffer_free(exec, &bins->order);
  chi_buffer_free(exec, &bins->tallies);
  chi_buffer_free(exec, &bins->whole);
}
