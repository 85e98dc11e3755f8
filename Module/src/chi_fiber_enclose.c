/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The part of a mesh whose values lie inside of closed lines, as tetrahedra. The inside is made of
 * triangles; tetrahedra that no side of these passes lie in one of them or outside and are passed
 * whole, the others are cut along all of the triangles' sides, which are fiber surfaces too. Both
 * sides of a face are so cut alike, and points have names that neighbours find too.
 */

#include "chi_fiber_internal.h"

#include <math.h>
#include <stdlib.h>

typedef struct enclose_job
{
  const chi_exec* exec;
  const chi_fiber_index* index;
  chi_fiber_enclosed* own;
} enclose_job;

/* Six volumes; negative: left-handed. */
static double volume_of(double (*const x)[3])
{
  double e[3][3];
  for (int k = 0; k < 3; ++k)
  {
    for (int a = 0; a < 3; ++a)
    {
      e[k][a] = x[k + 1][a] - x[0][a];
    }
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
    e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

double chi_fiber_six_volumes(const chi_fiber_index* x, const uint32_t v[4])
{
  double places[4][3];
  for (int k = 0; k < 4; ++k)
  {
    chi_fiber_place(x, v[k], places[k]);
  }
  return volume_of(places);
}

/* ---- tetrahedra that are cut ---- */

static int compare_keys(const void* a, const void* b)
{
  const uint64_t x = *(const uint64_t*)a, y = *(const uint64_t*)b;
  return (x > y) - (x < y);
}

/* The pairs of a chunk, by tetrahedra; those that do not meet in truth are left out. */
static size_t gather(const enclose_job* job, size_t chunk, uint64_t* key)
{
  const chi_fiber_pairs* const pairs = &job->own->pairs;
  const chi_fiber_polygon* const polygon = &job->own->pieces.polygon;
  size_t count = 0;
  for (size_t b = 0; b < pairs->batches; ++b)
  {
    const chi_fiber_job* const from = pairs->job + b * job->index->chunks + chunk;
    for (size_t p = 0; p < from->pairs; ++p)
    {
      const uint64_t code = pairs->pair[b][from->first_pair + p];
      const uint64_t segment = b * CHI_FIBER_BATCH + code % CHI_FIBER_PAIR;
      uint32_t v[4];
      chi_fiber_fetch(job->index, code / CHI_FIBER_PAIR, v);
      if (chi_fiber_passes(job->index, polygon->segment + segment, v))
      {
        key[count++] = code / CHI_FIBER_PAIR * polygon->count + segment;
      }
    }
  }
  for (size_t i = 1; i < count; ++i)
  {
    if (key[i - 1] > key[i])
    {
      qsort(key, count, sizeof *key, compare_keys);
      break;
    }
  }
  return count;
}

/* Whether a side is among the keys [first, last), which all are of one tetrahedron. */
static int is_among(const uint64_t* key, size_t first, size_t last, uint64_t wanted)
{
  while (first < last)
  {
    const size_t middle = first + (last - first) / 2;
    if (key[middle] == wanted)
    {
      return 1;
    }
    first = key[middle] < wanted ? middle + 1 : first;
    last = key[middle] < wanted ? last : middle;
  }
  return 0;
}

/* What to do with each part of a chunk's tetrahedra. */
typedef void (*visit_fn)(
  const enclose_job* job, chi_fiber_job* own, uint64_t tetrahedron, const chi_fiber_clipped* clip);

/* The triangles beside a tetrahedron's sides, each at the first of its own that is met. */
static void visit_parts(const enclose_job* job, chi_fiber_job* own, visit_fn visit)
{
  const chi_fiber_pieces* const pieces = &job->own->pieces;
  const uint64_t* const key = job->own->key + own->first_pair;
  const uint64_t segments = pieces->polygon.count;
  for (size_t first = 0, last; first < own->pairs; first = last)
  {
    const uint64_t tetrahedron = key[first] / segments;
    uint32_t v[4];
    for (last = first + 1; last < own->pairs && key[last] / segments == tetrahedron; ++last)
    {
    }
    chi_fiber_fetch(job->index, tetrahedron, v);
    for (size_t i = 2 * first; i < 2 * last; ++i)
    {
      const uint32_t segment = (uint32_t)(key[i / 2] % segments);
      const int32_t t = pieces->beside[segment][i % 2];
      int is_first = t >= 0;
      for (int k = 0; k < 3 && is_first; ++k)
      {
        const uint32_t other = pieces->triangle[t].segment[k];
        is_first = other >= segment || !is_among(key, first, i / 2, tetrahedron * segments + other);
      }
      if (is_first)
      {
        chi_fiber_clipped clip;
        chi_fiber_clip(job->index, pieces, v, (size_t)t, &clip);
        visit(job, own, tetrahedron, &clip);
      }
    }
  }
}

static void count_part(
  const enclose_job* job, chi_fiber_job* own, uint64_t tetrahedron, const chi_fiber_clipped* clip)
{
  (void)job;
  (void)tetrahedron;
  own->corners += clip->cells ? (size_t)clip->points : 0;
  own->crossed += (size_t)clip->cells;
}

static void make_part(
  const enclose_job* job, chi_fiber_job* own, uint64_t tetrahedron, const chi_fiber_clipped* clip)
{
  chi_fiber_enclosed* const e = job->own;
  uint32_t point[CHI_FIBER_CLIP_POINTS], v[4];
  double place[CHI_FIBER_CLIP_POINTS][3];
  chi_fiber_fetch(job->index, tetrahedron, v);
  const int is_left_handed = chi_fiber_six_volumes(job->index, v) < 0;
  for (int i = 0; i < clip->points && clip->cells; ++i)
  {
    point[i] = chi_fiber_find_point(&e->parts, own, clip->name + i);
    chi_fiber_position_of(job->index, &e->pieces.polygon, 0, clip->name + i, place[i]);
  }
  double* const volume = e->sums + e->blocks + own->chunk;
  for (int i = 0; i < clip->cells; ++i)
  {
    double x[4][3];
    const size_t number = own->first_part + own->triangles++;
    uint32_t* const corner = e->parts.corner + 4 * number;
    for (int k = 0; k < 4; ++k)
    {
      const int from = clip->cell[i][is_left_handed && k > 1 ? 5 - k : k];
      corner[k] = point[from];
      memcpy(x[k], place[from], sizeof x[k]);
      if (clip->name[from].b == CHI_FIBER_NONE)
      {
        atomic_store_explicit(e->is_used + clip->name[from].a, 1, memory_order_relaxed);
      }
      else
      {
        e->parts.used[own->first_corner + point[from]] = 1;
      }
    }
    e->from[number] = tetrahedron;
    *volume += volume_of(x);
  }
}

static void count_chunks(void* data, size_t begin, size_t end)
{
  const enclose_job* const job = (const enclose_job*)data;
  chi_fiber_enclosed* const e = job->own;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    chi_fiber_job* const own = e->cuts.job + c;
    own->pairs = gather(job, c, e->key + own->first_pair);
    visit_parts(job, own, count_part);
  }
}

static void make_chunks(void* data, size_t begin, size_t end)
{
  const enclose_job* const job = (const enclose_job*)data;
  chi_fiber_enclosed* const e = job->own;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    chi_fiber_job* const own = e->cuts.job + c;
    memset(e->parts.table + 2 * own->first_corner, 0xff, 2 * own->corners * sizeof(uint32_t));
    e->sums[e->blocks + c] = 0;
    visit_parts(job, own, make_part);
  }
}

static chi_status find_cuts(const enclose_job* job)
{
  chi_fiber_enclosed* const e = job->own;
  const chi_fiber_index* const x = job->index;
  const size_t chunks = e->cuts.jobs = e->pairs.batches > 0 ? x->chunks : 0;
  if (e->pieces.polygon.count > UINT64_MAX / (x->tetrahedra + 1))
  {
    return CHI_ERROR_TOO_LARGE;
  }
  if (!chi_buffer_reserve(job->exec, &e->cuts.job_buffer, chunks + 1, sizeof *e->cuts.job) ||
    !chi_buffer_reserve(job->exec, &e->key_buffer, e->pairs.count + 1, sizeof *e->key) ||
    !chi_buffer_reserve(job->exec, &e->cut_buffer, x->tetrahedra / 8 + 1, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  e->cuts.job = (chi_fiber_job*)e->cuts.job_buffer.data;
  e->key = (uint64_t*)e->key_buffer.data;
  e->is_cut = (uint8_t*)e->cut_buffer.data;
  memset(e->cuts.job, 0, (chunks + 1) * sizeof *e->cuts.job);
  memset(e->is_cut, 0, x->tetrahedra / 8 + 1);
  size_t first = 0;
  for (size_t c = 0; c < chunks; ++c)
  {
    e->cuts.job[c].chunk = c;
    e->cuts.job[c].first_pair = first;
    for (size_t b = 0; b < e->pairs.batches; ++b)
    {
      first += e->pairs.job[b * chunks + c].pairs;
    }
  }
  const chi_status status = chi_for(job->exec, chunks, count_chunks, (void*)job);
  size_t corners = 0, cells = 0;
  for (size_t c = 0; c < chunks && status == CHI_OK; ++c)
  {
    chi_fiber_job* const own = e->cuts.job + c;
    own->first_corner = corners;
    own->first_part = cells;
    corners += own->corners;
    cells += own->crossed;
    for (size_t p = 0; p < own->pairs; ++p)
    {
      const uint64_t t = e->key[own->first_pair + p] / e->pieces.polygon.count;
      e->is_cut[t / 8] |= (uint8_t)(1 << t % 8);
    }
  }
  e->cuts.corners = corners;
  e->cuts.count = cells;
  return status == CHI_OK && corners > CHI_FIBER_AT_CORNER ? CHI_ERROR_TOO_LARGE : status;
}

static chi_status make_cuts(const enclose_job* job)
{
  chi_fiber_enclosed* const e = job->own;
  chi_fiber_parts* const parts = &e->parts;
  const size_t corners = e->cuts.corners + 1, cells = e->cuts.count + 1;
  if (!chi_buffer_reserve(job->exec, &parts->name_buffer, corners, sizeof *parts->name) ||
    !chi_buffer_reserve(job->exec, &parts->id_buffer, corners, sizeof *parts->id) ||
    !chi_buffer_reserve(job->exec, &parts->used_buffer, corners, 1) ||
    !chi_buffer_reserve(job->exec, &parts->table_buffer, 2 * corners, sizeof *parts->table) ||
    !chi_buffer_reserve(job->exec, &parts->corner_buffer, 4 * cells, sizeof *parts->corner) ||
    !chi_buffer_reserve(job->exec, &e->from_buffer, cells, sizeof *e->from))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  parts->name = (chi_fiber_name*)parts->name_buffer.data;
  parts->id = (uint32_t*)parts->id_buffer.data;
  parts->used = (uint8_t*)parts->used_buffer.data;
  parts->table = (uint32_t*)parts->table_buffer.data;
  parts->corner = (uint32_t*)parts->corner_buffer.data;
  e->from = (uint64_t*)e->from_buffer.data;
  const chi_status status = chi_for(job->exec, e->cuts.jobs, make_chunks, (void*)job);
  return status == CHI_OK ? chi_fiber_weld(job->exec, parts, &e->cuts, &e->points, &e->cells)
                          : status;
}

/* ---- tetrahedra that are passed whole ---- */

int chi_fiber_is_whole(
  const chi_fiber_index* x, const chi_fiber_enclosed* e, size_t t, uint32_t v[4], size_t* cell)
{
  if (e->is_cut[t / 8] >> t % 8 & 1)
  {
    return 0;
  }
  *cell = chi_fiber_fetch(x, t, v);
  return e->inside[v[0]] && chi_fiber_is_usable(x, *cell, v);
}

static void find_whole(void* data, size_t begin, size_t end)
{
  const enclose_job* const job = (const enclose_job*)data;
  chi_fiber_enclosed* const e = job->own;
  for (size_t b = begin; b < end && !chi_is_cancelled(job->exec); ++b)
  {
    const size_t first = b * CHI_FIBER_ENCLOSED_BLOCK;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_ENCLOSED_BLOCK, job->index->tetrahedra);
    size_t count = 0;
    double volume = 0, lost = 0; /* many alike round off alike */
    for (size_t t = first; t < last; ++t)
    {
      uint32_t v[4];
      size_t cell;
      if (chi_fiber_is_whole(job->index, e, t, v, &cell))
      {
        ++count;
        double low;
        volume = chi_two_sum(volume, fabs(chi_fiber_six_volumes(job->index, v)), &low);
        lost += low;
        for (int k = 0; k < 4; ++k)
        {
          atomic_store_explicit(e->is_used + v[k], 1, memory_order_relaxed);
        }
      }
    }
    e->first_whole[b + 1] = count;
    e->sums[b] = volume + lost;
  }
}

static chi_status make_whole(const enclose_job* job)
{
  chi_fiber_enclosed* const e = job->own;
  const chi_fiber_index* const x = job->index;
  const size_t none = e->pieces.triangles == 0;
  chi_status status = chi_fiber_find_inside(job->exec, x, &e->pieces.polygon, e->inside);
  e->first_whole[0] = 0;
  memset(e->first_whole, 0, (e->blocks + 1) * sizeof *e->first_whole);
  memset(e->sums, 0, e->blocks * sizeof *e->sums);
  status =
    status == CHI_OK && !none ? chi_for(job->exec, e->blocks, find_whole, (void*)job) : status;
  for (size_t b = 0; b < e->blocks; ++b)
  {
    e->first_whole[b + 1] += e->first_whole[b];
  }
  e->whole = e->first_whole[e->blocks];
  return status;
}

/* ---- the mesh's points that stay ---- */

static void count_used(void* data, size_t begin, size_t end)
{
  const enclose_job* const job = (const enclose_job*)data;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    const size_t first = r * CHI_FIBER_RUN;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, job->index->points);
    size_t count = 0;
    for (size_t i = first; i < last; ++i)
    {
      count += atomic_load_explicit(job->own->is_used + i, memory_order_relaxed);
    }
    job->own->first_used[r + 1] = count;
  }
}

static void number_used(void* data, size_t begin, size_t end)
{
  const enclose_job* const job = (const enclose_job*)data;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    const size_t first = r * CHI_FIBER_RUN;
    const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, job->index->points);
    size_t next = job->own->first_used[r];
    for (size_t i = first; i < last; ++i)
    {
      job->own->new_id[i] = atomic_load_explicit(job->own->is_used + i, memory_order_relaxed)
        ? (uint32_t)next++
        : CHI_FIBER_NONE;
    }
  }
}

static chi_status number_points(const enclose_job* job)
{
  chi_fiber_enclosed* const e = job->own;
  const size_t runs = job->index->runs;
  e->first_used[0] = 0;
  chi_status status = chi_for(job->exec, runs, count_used, (void*)job);
  for (size_t r = 0; r < runs && status == CHI_OK; ++r)
  {
    e->first_used[r + 1] += e->first_used[r];
  }
  status = status == CHI_OK ? chi_for(job->exec, runs, number_used, (void*)job) : status;
  e->vertices = status == CHI_OK ? e->first_used[runs] : 0;
  return status;
}

/* ---- together ---- */

static int reserve(const chi_exec* exec, chi_fiber_enclosed* e, const chi_fiber_index* x)
{
  e->blocks = chi_grid_chunks(x->tetrahedra, CHI_FIBER_ENCLOSED_BLOCK);
  if (!chi_buffer_reserve(exec, &e->inside_buffer, x->points + 1, 1) ||
    !chi_buffer_reserve(exec, &e->used_buffer, x->points + 1, sizeof *e->is_used) ||
    !chi_buffer_reserve(exec, &e->id_buffer, x->points + 1, sizeof *e->new_id) ||
    !chi_buffer_reserve(exec, &e->whole_buffer, e->blocks + 1, sizeof *e->first_whole) ||
    !chi_buffer_reserve(exec, &e->run_buffer, x->runs + 1, sizeof *e->first_used) ||
    !chi_buffer_reserve(exec, &e->sum_buffer, e->blocks + x->chunks + 1, sizeof *e->sums))
  {
    return 0;
  }
  e->inside = (uint8_t*)e->inside_buffer.data;
  e->is_used = (atomic_uchar*)e->used_buffer.data;
  e->new_id = (uint32_t*)e->id_buffer.data;
  e->first_whole = (size_t*)e->whole_buffer.data;
  e->first_used = (size_t*)e->run_buffer.data;
  e->sums = (double*)e->sum_buffer.data;
  for (size_t i = 0; i < x->points; ++i)
  {
    atomic_init(e->is_used + i, 0);
  }
  return 1;
}

static uint64_t bytes_of(const chi_fiber_enclosed* e)
{
  const chi_buffer* const buffers[] = { &e->pieces.polygon.segments,
    &e->pieces.polygon.corner_buffer, &e->pieces.polygon.order, &e->pieces.triangle_buffer,
    &e->pieces.beside_buffer, &e->pairs.job_buffer, &e->pairs.pair_pointers, &e->pairs.mask_buffer,
    &e->pairs.active_buffer, &e->cuts.job_buffer, &e->parts.name_buffer, &e->parts.corner_buffer,
    &e->parts.id_buffer, &e->parts.used_buffer, &e->parts.table_buffer, &e->parts.order_buffer,
    &e->parts.partition_buffer, &e->key_buffer, &e->cut_buffer, &e->inside_buffer, &e->used_buffer,
    &e->id_buffer, &e->from_buffer, &e->whole_buffer, &e->run_buffer, &e->sum_buffer };
  uint64_t bytes = 0;
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; ++i)
  {
    bytes += buffers[i]->bytes;
  }
  for (size_t i = 0; i < e->pairs.buffers; ++i)
  {
    bytes += e->pairs.pair_buffer[i].bytes;
  }
  return bytes;
}

static chi_status make(const enclose_job* job, const chi_fiber_polygon* lines)
{
  chi_fiber_enclosed* const e = job->own;
  chi_status status = chi_fiber_pieces_make(job->exec, &e->pieces, lines);
  if (status == CHI_OK && !reserve(job->exec, e, job->index))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  status = status == CHI_OK
    ? chi_fiber_find(job->exec, &e->pairs, job->index, &e->pieces.polygon, 0)
    : status;
  status = status == CHI_OK ? find_cuts(job) : status;
  status = status == CHI_OK ? make_cuts(job) : status;
  status = status == CHI_OK ? make_whole(job) : status;
  status = status == CHI_OK ? number_points(job) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  if (e->vertices + e->points >= CHI_FIBER_NONE)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  double high = 0, low = 0;
  for (size_t i = 0; i < e->blocks + e->cuts.jobs; ++i)
  {
    double lost;
    high = chi_two_sum(high, e->sums[i], &lost);
    low += lost;
  }
  e->volume = (high + low) / 6;
  return CHI_OK;
}

chi_status chi_fiber_enclose(
  const chi_exec* exec, chi_fiber* fiber, chi_fiber_enclosed_sizes* sizes)
{
  if (!fiber || !sizes)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *sizes = (chi_fiber_enclosed_sizes){ .struct_size = sizeof *sizes };
  if (!fiber->has_surface)
  {
    return CHI_ERROR_NOT_READY;
  }
  sizes->open_segments = fiber->polygon.count - fiber->polygon.closed;
  if (sizes->open_segments > 0)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  chi_fiber_enclosed* const e = &fiber->enclosed;
  const enclose_job job = { exec, &fiber->index, e };
  if (!e->is_ready)
  {
    const chi_status status = make(&job, &fiber->polygon);
    if (status != CHI_OK)
    {
      return status;
    }
    e->is_ready = 1;
  }
  sizes->points = e->vertices + e->points;
  sizes->cells = e->whole + e->cells;
  sizes->whole_cells = e->whole;
  sizes->pieces = e->pieces.triangles;
  sizes->volume = e->volume;
  sizes->scratch_bytes = bytes_of(e);
  return CHI_OK;
}

void chi_fiber_enclosed_free(const chi_exec* exec, chi_fiber_enclosed* e)
{
  chi_buffer* const buffers[] = { &e->key_buffer, &e->cut_buffer, &e->inside_buffer,
    &e->used_buffer, &e->id_buffer, &e->from_buffer, &e->whole_buffer, &e->run_buffer,
    &e->sum_buffer };
  chi_fiber_pieces_free(exec, &e->pieces);
  chi_fiber_pairs_free(exec, &e->pairs);
  chi_fiber_pairs_free(exec, &e->cuts);
  chi_fiber_parts_free(exec, &e->parts);
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; ++i)
  {
    chi_buffer_free(exec, buffers[i]);
  }
}
