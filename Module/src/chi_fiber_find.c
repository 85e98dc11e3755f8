/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The pairs of a tetrahedron and a segment that may meet. Each point is looked at once for a batch
 * of segments: on which side of the line it lies, exactly, and whether it lies before the start or
 * beyond the end, certainly or perhaps. Then four words and few operations tell for a tetrahedron
 * which segments of the batch can pass it.
 */

#include "chi_fiber_internal.h"

#include <math.h>

#define FIELD (((uint64_t)1 << CHI_FIBER_BATCH) - 1)

typedef struct find_job
{
  const chi_exec* exec;
  const chi_fiber_index* index;
  const chi_fiber_kernels* kernels;
  const chi_fiber_segment* segment; /* of the batch */
  size_t segments;
  int32_t no_skipping;
  uint64_t* word;       /* [points] */
  uint8_t* active;      /* [bricks] whether a segment may meet it */
  uint8_t* passed;      /* [runs] whether one word served all, or none was needed */
  atomic_uchar* needed; /* [runs] whether a brick that is active has a point there */
  chi_fiber_job* job;   /* [chunks] of the batch */
  uint64_t* pair;       /* NULL: count */
} find_job;

/* The sides of values, exactly, where rounding hides some of them. */
static void settle(
  const chi_fiber_segment* s, const double* values, size_t count, uint64_t bit, uint64_t* word)
{
  for (size_t i = 0; i < count; ++i)
  {
    double area;
    word[i] = (word[i] & ~(bit << CHI_FIBER_LEFT)) |
      (chi_fiber_is_left(s, values + 2 * i, &area) ? bit << CHI_FIBER_LEFT : 0);
  }
}

static void classify_run(const find_job* job, size_t run)
{
  const chi_fiber_index* const x = job->index;
  const size_t first = run * CHI_FIBER_RUN;
  const size_t last = chi_grid_chunk_end(first, CHI_FIBER_RUN, x->points);
  const int looks = !(job->no_skipping & CHI_FIBER_SKIP_RUNS);
  const int is_empty = !(x->run[run].low[0] <= x->run[run].high[0]);
  uint64_t all = 0;
  size_t open[CHI_FIBER_BATCH], opens = 0;
  for (size_t s = 0; s < job->segments; ++s)
  {
    uint64_t bits = 0;
    if (looks && (is_empty || chi_fiber_bits_of_box(job->segment + s, x->run + run, &bits)))
    {
      all |= bits << s;
    }
    else
    {
      open[opens++] = s;
    }
  }
  job->passed[run] = opens == 0;
  uint64_t* const word = job->word;
  for (size_t i = first; i < last; ++i)
  {
    word[i] = all | (uint64_t)x->flags[i] << CHI_FIBER_FLAGS;
  }
  for (size_t k = 0; k < opens; ++k)
  {
    const chi_fiber_segment* const s = job->segment + open[k];
    if (job->kernels->classify(
          s->p, s->d, s->square, x->values[first], last - first, (unsigned)open[k], word + first))
    {
      settle(s, x->values[first], last - first, (uint64_t)1 << open[k], word + first);
    }
  }
}

static void classify(void* data, size_t begin, size_t end)
{
  find_job* const job = (find_job*)data;
  for (size_t r = begin; r < end && !chi_is_cancelled(job->exec); ++r)
  {
    if (atomic_load_explicit(job->needed + r, memory_order_relaxed))
    {
      classify_run(job, r);
    }
    else
    {
      job->passed[r] = 1;
    }
  }
}

/* Segments of the batch that may pass a tetrahedron, by the conjunction and disjunction of its
 * points' words. */
static inline uint64_t passing(uint64_t both, uint64_t either)
{
  return (either & ~both) >> CHI_FIBER_LEFT & ~(both >> CHI_FIBER_BEFORE) &
    ~(both >> CHI_FIBER_BEYOND) & FIELD;
}

/* Where pairs go, or how many they are. */
typedef struct pair_sink
{
  uint64_t* pair;
  size_t count, corners;
} pair_sink;

/* Each end adds a corner at most, since parts are convex. */
static inline void add_pairs(
  pair_sink* sink, uint64_t tetrahedron, uint64_t segments, const uint64_t w[4], uint64_t either)
{
  while (segments)
  {
    unsigned s = 0;
    while (!(segments >> s & 1))
    {
      ++s;
    }
    segments &= segments - 1;
    const int lefts = (int)((w[0] >> s & 1) + (w[1] >> s & 1) + (w[2] >> s & 1) + (w[3] >> s & 1));
    sink->corners += (lefts == 2 ? 4 : 3) + (either >> (CHI_FIBER_MAYBE_BEFORE + s) & 1) +
      (either >> (CHI_FIBER_MAYBE_BEYOND + s) & 1);
    if (sink->pair)
    {
      sink->pair[sink->count] = tetrahedron * CHI_FIBER_PAIR + s;
    }
    ++sink->count;
  }
}

static int is_ghost(const chi_fiber_index* x, size_t cell)
{
  const uint8_t* const ghosts = x->grid.view.cell_ghosts;
  return ghosts && ghosts[cell] & (CHI_GRID_DUPLICATE_CELL | CHI_GRID_HIDDEN_CELL);
}

static inline void look_at(
  const find_job* job, uint64_t tetrahedron, const uint64_t w[4], size_t cell, pair_sink* sink)
{
  const uint64_t both = w[0] & w[1] & w[2] & w[3], either = w[0] | w[1] | w[2] | w[3];
  const uint64_t segments = passing(both, either);
  if (segments && !(either >> CHI_FIBER_FLAGS) && !is_ghost(job->index, cell))
  {
    add_pairs(sink, tetrahedron, segments, w, either);
  }
}

static void look_at_direct(const find_job* job, size_t first, size_t last, pair_sink* sink)
{
  const chi_grid_view* const v = &job->index->grid.view;
  const int64_t* const ids = v->connectivity + v->offsets[0];
  for (size_t t = first; t < last; ++t)
  {
    const int64_t* const p = ids + 4 * t;
    const uint64_t w[4] = { job->word[p[0]], job->word[p[1]], job->word[p[2]], job->word[p[3]] };
    look_at(job, t, w, t, sink);
  }
}

static void look_at_list(const find_job* job, size_t first, size_t last, pair_sink* sink)
{
  const chi_fiber_index* const x = job->index;
  for (size_t t = first; t < last; ++t)
  {
    const uint32_t* const p = x->vertices[t];
    const uint64_t w[4] = { job->word[p[0]], job->word[p[1]], job->word[p[2]], job->word[p[3]] };
    const uint64_t both = w[0] & w[1] & w[2] & w[3], either = w[0] | w[1] | w[2] | w[3];
    const uint64_t segments = passing(both, either);
    if (segments && !(either >> CHI_FIBER_FLAGS & CHI_FIBER_BAD_VALUE))
    {
      add_pairs(sink, t, segments, w, either);
    }
  }
}

static inline void look_at_cube(
  const find_job* job, size_t cell, size_t first, const size_t step[8], pair_sink* sink)
{
  uint64_t w[8], both = ~(uint64_t)0, either = 0;
  for (int k = 0; k < 8; ++k)
  {
    w[k] = job->word[first + step[k]];
    both &= w[k];
    either |= w[k];
  }
  const uint64_t out = (uint64_t)(CHI_FIBER_BAD_PLACE | CHI_FIBER_HIDDEN) << CHI_FIBER_FLAGS;
  if (!passing(both, either) || either & out || is_ghost(job->index, cell))
  {
    return;
  }
  for (uint64_t t = 0; t < 6; ++t)
  {
    const uint8_t* const p = chi_fiber_paths[t];
    const uint64_t v[4] = { w[p[0]], w[p[1]], w[p[2]], w[p[3]] };
    const uint64_t all = v[0] & v[1] & v[2] & v[3], any = v[0] | v[1] | v[2] | v[3];
    const uint64_t segments = passing(all, any);
    if (segments && !(any >> CHI_FIBER_FLAGS))
    {
      add_pairs(sink, 6 * (uint64_t)cell + t, segments, v, any);
    }
  }
}

static void look_at_block(const find_job* job, size_t brick, pair_sink* sink)
{
  const chi_fiber_index* const x = job->index;
  const size_t* const n = x->grid.dimensions;
  size_t low[3], high[3], step[8];
  chi_fiber_block(x, brick, low, high);
  for (int k = 0; k < 8; ++k)
  {
    step[k] = chi_fiber_step(x, k);
  }
  for (size_t k = low[2]; k < high[2]; ++k)
  {
    for (size_t j = low[1]; j < high[1]; ++j)
    {
      const size_t row = chi_fiber_first_point(x, (const size_t[3]){ 0, j, k });
      for (size_t i = low[0]; i < high[0]; ++i)
      {
        look_at_cube(job, i + n[0] * (j + n[1] * k), row + i, step, sink);
      }
    }
  }
}

static void look_at_brick(const find_job* job, size_t brick, pair_sink* sink)
{
  if (job->index->source == CHI_FIBER_KUHN)
  {
    look_at_block(job, brick, sink);
    return;
  }
  const size_t first = brick * CHI_FIBER_LIST_BRICK;
  const size_t last = chi_grid_chunk_end(first, CHI_FIBER_LIST_BRICK, job->index->tetrahedra);
  if (job->index->source == CHI_FIBER_DIRECT)
  {
    look_at_direct(job, first, last, sink);
  }
  else
  {
    look_at_list(job, first, last, sink);
  }
}

static void need(const find_job* job, size_t first_point, size_t last_point)
{
  for (size_t r = first_point / CHI_FIBER_RUN; r <= last_point / CHI_FIBER_RUN; ++r)
  {
    atomic_store_explicit(job->needed + r, 1, memory_order_relaxed);
  }
}

/* The runs of a brick's points. */
static void need_brick(const find_job* job, size_t brick)
{
  const chi_fiber_index* const x = job->index;
  if (x->source == CHI_FIBER_KUHN)
  {
    size_t low[3], high[3];
    chi_fiber_block(x, brick, low, high);
    for (size_t k = low[2]; k <= high[2]; ++k)
    {
      for (size_t j = low[1]; j <= high[1]; ++j)
      {
        const size_t row = chi_fiber_first_point(x, (const size_t[3]){ 0, j, k });
        need(job, row + low[0], row + high[0]);
      }
    }
    return;
  }
  const size_t first = brick * CHI_FIBER_LIST_BRICK;
  const size_t last = chi_grid_chunk_end(first, CHI_FIBER_LIST_BRICK, x->tetrahedra);
  for (size_t t = first; t < last; ++t)
  {
    uint32_t v[4];
    chi_fiber_fetch(x, t, v);
    for (int k = 0; k < 4; ++k)
    {
      need(job, v[k], v[k]);
    }
  }
}

static void choose_bricks(void* data, size_t begin, size_t end)
{
  const find_job* const job = (const find_job*)data;
  const int looks = !(job->no_skipping & CHI_FIBER_SKIP_BRICKS);
  const size_t size = job->index->bricks_a_chunk;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t last = chi_grid_chunk_end(c * size, size, job->index->bricks);
    for (size_t b = c * size; b < last; ++b)
    {
      int meets = !looks;
      for (size_t s = 0; s < job->segments && !meets; ++s)
      {
        meets = chi_fiber_meets(job->segment + s, job->index->brick + b);
      }
      job->active[b] = (uint8_t)meets;
    }
  }
}

static void need_bricks(void* data, size_t begin, size_t end)
{
  const find_job* const job = (const find_job*)data;
  const size_t size = job->index->bricks_a_chunk;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t last = chi_grid_chunk_end(c * size, size, job->index->bricks);
    for (size_t b = c * size; b < last; ++b)
    {
      if (job->active[b])
      {
        need_brick(job, b);
      }
    }
  }
}

/* Find the runs of active bricks, unless this costs more than to look at all. */
static chi_status find_needed(find_job* job)
{
  const chi_fiber_index* const x = job->index;
  size_t active = 0;
  for (size_t b = 0; b < x->bricks; ++b)
  {
    active += job->active[b];
  }
  const int is_worth = x->source == CHI_FIBER_KUHN || active < x->bricks / 8;
  const int looks = is_worth && !(job->no_skipping & CHI_FIBER_SKIP_RUNS);
  memset(job->needed, !looks, x->runs);
  return looks ? chi_for(job->exec, x->chunks, need_bricks, job) : CHI_OK;
}

static void look_through(void* data, size_t begin, size_t end)
{
  const find_job* const job = (const find_job*)data;
  const size_t size = job->index->bricks_a_chunk;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t first = c * size, last = chi_grid_chunk_end(first, size, job->index->bricks);
    chi_fiber_job* const own = job->job + c;
    pair_sink sink = { job->pair ? job->pair + own->first_pair : NULL, 0, 0 };
    for (size_t b = first; b < last; ++b)
    {
      if (job->active[b])
      {
        look_at_brick(job, b, &sink);
      }
    }
    own->pairs = sink.count;
    own->corners = sink.corners;
  }
}

static chi_status reserve(const chi_exec* exec, chi_fiber_pairs* pairs, const chi_fiber_index* x)
{
  if (pairs->batches > pairs->buffers)
  {
    chi_buffer* const more = (chi_buffer*)chi_alloc(exec, pairs->batches, sizeof *more);
    if (!more)
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    memset(more, 0, pairs->batches * sizeof *more);
    if (pairs->pair_buffer)
    {
      memcpy(more, pairs->pair_buffer, pairs->buffers * sizeof *more);
      chi_free(exec, pairs->pair_buffer, pairs->buffers, sizeof *more);
    }
    pairs->pair_buffer = more;
    pairs->buffers = pairs->batches;
  }
  if (!chi_buffer_reserve(exec, &pairs->job_buffer, pairs->jobs + 1, sizeof *pairs->job) ||
    !chi_buffer_reserve(exec, &pairs->pair_pointers, pairs->batches + 1, sizeof *pairs->pair) ||
    !chi_buffer_reserve(exec, &pairs->mask_buffer, x->points + 1, sizeof(uint64_t)) ||
    !chi_buffer_reserve(exec, &pairs->active_buffer, x->bricks + 2 * x->runs + 1, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  pairs->job = (chi_fiber_job*)pairs->job_buffer.data;
  pairs->pair = (uint64_t**)pairs->pair_pointers.data;
  memset(pairs->job, 0, (pairs->jobs + 1) * sizeof *pairs->job);
  return CHI_OK;
}

static chi_status find_batch(
  find_job* job, chi_fiber_pairs* pairs, size_t batch, const chi_fiber_index* x)
{
  job->pair = NULL;
  job->job = pairs->job + batch * x->chunks;
  chi_status status = chi_for(job->exec, x->chunks, choose_bricks, job);
  status = status == CHI_OK ? find_needed(job) : status;
  status = status == CHI_OK ? chi_for(job->exec, x->runs, classify, job) : status;
  status = status == CHI_OK ? chi_for(job->exec, x->chunks, look_through, job) : status;
  if (status != CHI_OK)
  {
    return status;
  }
  size_t count = 0;
  for (size_t c = 0; c < x->chunks; ++c)
  {
    chi_fiber_job* const own = job->job + c;
    own->batch = batch;
    own->chunk = c;
    own->first_pair = count;
    own->first_part = pairs->count + count;
    own->first_corner = pairs->corners;
    count += own->pairs;
    pairs->corners += own->corners;
  }
  for (size_t r = 0; r < x->runs; ++r)
  {
    pairs->skipped_runs += job->passed[r];
  }
  for (size_t b = 0; b < x->bricks; ++b)
  {
    pairs->skipped_bricks += !job->active[b];
  }
  pairs->count += count;
  if (pairs->corners > CHI_FIBER_AT_CORNER)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  if (!chi_buffer_reserve(job->exec, pairs->pair_buffer + batch, count + 1, sizeof(uint64_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->pair = pairs->pair[batch] = (uint64_t*)pairs->pair_buffer[batch].data;
  return chi_for(job->exec, x->chunks, look_through, job);
}

chi_status chi_fiber_find(const chi_exec* exec, chi_fiber_pairs* pairs, const chi_fiber_index* x,
  const chi_fiber_polygon* polygon, int32_t no_skipping)
{
  pairs->batches = chi_grid_chunks(polygon->count, CHI_FIBER_BATCH);
  pairs->jobs = pairs->batches * x->chunks;
  pairs->count = pairs->corners = pairs->skipped_bricks = pairs->skipped_runs = 0;
  chi_status status = reserve(exec, pairs, x);
  if (status != CHI_OK)
  {
    return status;
  }
  find_job job = { .exec = exec,
    .index = x,
    .kernels = chi_fiber_get_kernels(),
    .no_skipping = no_skipping,
    .word = (uint64_t*)pairs->mask_buffer.data,
    .active = (uint8_t*)pairs->active_buffer.data,
    .passed = (uint8_t*)pairs->active_buffer.data + x->bricks,
    .needed = (atomic_uchar*)pairs->active_buffer.data + x->bricks + x->runs };
  for (size_t b = 0; b < pairs->batches && status == CHI_OK; ++b)
  {
    const size_t first = b * CHI_FIBER_BATCH;
    job.segment = polygon->segment + first;
    job.segments = chi_grid_chunk_end(first, CHI_FIBER_BATCH, polygon->count) - first;
    status = find_batch(&job, pairs, b, x);
  }
  return status;
}

void chi_fiber_pairs_free(const chi_exec* exec, chi_fiber_pairs* pairs)
{
  for (size_t b = 0; b < pairs->buffers; ++b)
  {
    chi_buffer_free(exec, pairs->pair_buffer + b);
  }
  if (pairs->pair_buffer)
  {
    chi_free(exec, pairs->pair_buffer, pairs->buffers, sizeof *pairs->pair_buffer);
  }
  chi_buffer_free(exec, &pairs->job_buffer);
  chi_buffer_free(exec, &pairs->pair_pointers);
  chi_buffer_free(exec, &pairs->mask_buffer);
  chi_buffer_free(exec, &pairs->active_buffer);
}
