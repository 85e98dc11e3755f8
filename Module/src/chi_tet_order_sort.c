/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The topological sort of Williams' meshed polyhedra visibility order: of two tetrahedra with a
 * common face the one on the eye's side of its plane is in front. Kahn's algorithm (1962), first
 * come, first served.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

#define DONE UINT32_MAX

typedef struct side_job
{
  const chi_tet_mesh_view* mesh;
  const uint32_t* neighbors;
  const chi_order_eye* eye;
  uint8_t* sides;
  uint32_t* waiting;
} side_job;

static void find_sides(void* data, size_t begin, size_t end)
{
  const side_job* const it = (const side_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  for (size_t t = begin * chunk; t < n && t < end * chunk; ++t)
  {
    double x[4][3];
    chi_order_corners(it->mesh, t, x);
    uint32_t sides = 0, waiting = 0;
    for (size_t i = 0; i < 4; ++i)
    {
      if (it->neighbors[4 * t + i] < n)
      {
        const int side = chi_order_side(it->eye, (const double(*)[3])x, i);
        sides |= side > 0 ? 1u << i : side < 0 ? 16u << i : 0;
        waiting += side < 0;
      }
    }
    it->sides[t] = (uint8_t)sides;
    it->waiting[t] = waiting;
  }
}

static void release(chi_order_sorter* s, uint32_t t)
{
  if (s->waiting[t] != DONE && --s->waiting[t] == 0)
  {
    s->waiting[t] = DONE;
    s->queue[s->tail++] = t;
  }
}

static void drain(chi_order_sorter* s)
{
  while (s->head < s->tail)
  {
    const uint32_t t = s->queue[s->head];
    s->keys[t] = (uint32_t)s->head++;
    for (size_t i = 0; i < 4; ++i)
    {
      if (s->sides[t] >> i & 1)
      {
        release(s, s->neighbors[4 * (size_t)t + i]);
      }
    }
    for (size_t k = s->relations ? s->starts[t] : 0; s->relations && k < s->starts[t + 1]; ++k)
    {
      release(s, s->relations[k].to);
    }
  }
}

/* Someone not yet drawn who is behind t. */
static uint32_t find_behind(const chi_order_sorter* s, uint32_t t)
{
  for (size_t i = 0; i < 4; ++i)
  {
    const uint32_t u = s->neighbors[4 * (size_t)t + i];
    if (s->sides[t] >> (4 + i) & 1 && s->waiting[u] != DONE)
    {
      return u;
    }
  }
  for (size_t k = 0; k < s->relation_count; ++k)
  {
    if (s->relations[k].to == t && s->waiting[s->relations[k].from] != DONE)
    {
      return s->relations[k].from;
    }
  }
  return t; /* cannot be: it waits for someone */
}

static double distance_of(const chi_order_sorter* s, uint32_t t)
{
  double x[4][3], sum = 0;
  const double* const m = s->eye->to_eye;
  chi_order_corners(s->mesh, t, x);
  for (int r = 0; r < 3; ++r)
  {
    double c = 4 * m[4 * r + 3];
    for (int i = 0; i < 4; ++i)
    {
      c += m[4 * r] * x[i][0] + m[4 * r + 1] * x[i][1] + m[4 * r + 2] * x[i][2];
    }
    sum += s->eye->parallel ? (r == 2 ? -c : 0) : c * c;
  }
  return sum;
}

/*
 * Nobody is free: who is behind whom, followed backwards, ends in a cycle. Of its members the one
 * is drawn for which the fewest relations are broken, then the farthest, then the first.
 */
static void break_cycle(chi_order_sorter* s, uint32_t start, uint32_t stamp)
{
  size_t length = 0;
  uint32_t t = start;
  while (s->visit[t] != stamp)
  {
    s->visit[t] = stamp;
    s->path[length++] = t;
    t = find_behind(s, t);
  }
  uint32_t best = t;
  double far = distance_of(s, t);
  while (s->path[--length] != t)
  {
    const uint32_t u = s->path[length];
    if (s->waiting[u] <= s->waiting[best])
    {
      const double d = distance_of(s, u);
      if (s->waiting[u] < s->waiting[best] || d > far || (d == far && u < best))
      {
        best = u;
        far = d;
      }
    }
  }
  s->waiting[best] = DONE;
  s->queue[s->tail++] = best;
}

/* Relations by the tetrahedron that they are from; starts has two places more than there are. */
static void index_relations(chi_order_sort* sort, size_t n, uint32_t* waiting)
{
  uint32_t* const starts = (uint32_t*)sort->relation_starts.data;
  const chi_order_relation* const found = (const chi_order_relation*)sort->found.data;
  chi_order_relation* const relations = (chi_order_relation*)sort->relations.data;
  memset(starts, 0, (n + 2) * sizeof *starts);
  for (size_t k = 0; k < sort->relation_count; ++k)
  {
    ++starts[found[k].from + 2];
    ++waiting[found[k].to];
  }
  for (size_t t = 0; t < n; ++t)
  {
    starts[t + 2] += starts[t + 1];
  }
  for (size_t k = 0; k < sort->relation_count; ++k)
  {
    relations[starts[found[k].from + 1]++] = found[k];
  }
}

chi_status chi_order_sort_find(const chi_exec* exec, chi_order_sort* sort,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, const chi_order_eye* eye,
  uint32_t* keys)
{
  const size_t n = mesh->count;
  if (!chi_buffer_reserve(exec, &sort->sides, n, 1) ||
    !chi_buffer_reserve(exec, &sort->waiting, n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &sort->queue, n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &sort->spare, n, sizeof(uint32_t)) ||
    (sort->relation_count &&
      (!chi_buffer_reserve(exec, &sort->relation_starts, n + 2, sizeof(uint32_t)) ||
        !chi_buffer_reserve(
          exec, &sort->relations, sort->relation_count, sizeof(chi_order_relation)))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  side_job job = { mesh, (const uint32_t*)adjacency->neighbors.data, eye,
    (uint8_t*)sort->sides.data, (uint32_t*)sort->waiting.data };
  chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, find_sides, &job);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_order_sorter s = { .mesh = mesh,
    .neighbors = job.neighbors,
    .eye = eye,
    .sides = job.sides,
    .waiting = job.waiting,
    .queue = (uint32_t*)sort->queue.data,
    .keys = keys };
  if (sort->relation_count)
  {
    index_relations(sort, n, s.waiting);
    s.relations = (const chi_order_relation*)sort->relations.data;
    s.starts = (const uint32_t*)sort->relation_starts.data;
    s.relation_count = sort->relation_count;
  }
  if (sort->ordered == n && n > 0)
  {
    int outcome = CHI_ORDER_TOO_MUCH;
    sort->ordered = 0;
    status = chi_order_repair(exec, sort, &s, n, &outcome);
    if (status != CHI_OK || outcome == CHI_ORDER_SPOILED)
    {
      return status != CHI_OK ? status
                              : chi_order_sort_find(exec, sort, mesh, adjacency, eye, keys);
    }
    if (outcome == CHI_ORDER_REPAIRED)
    {
      sort->ordered = n;
      return CHI_OK;
    }
  }
  for (uint32_t t = 0; t < n; ++t)
  {
    if (s.waiting[t] == 0)
    {
      s.waiting[t] = DONE;
      s.queue[s.tail++] = t;
    }
  }
  sort->cycles = 0;
  sort->replaced = (int64_t)n;
  drain(&s);
  uint32_t first = 0;
  while (s.tail < n)
  {
    if (sort->cycles == 0)
    {
      if (!chi_buffer_reserve(exec, &sort->walk, 2 * n, sizeof(uint32_t)))
      {
        return CHI_ERROR_OUT_OF_MEMORY;
      }
      s.path = (uint32_t*)sort->walk.data;
      s.visit = s.path + n;
      memset(s.visit, 0, n * sizeof *s.visit);
    }
    while (s.waiting[first] == DONE)
    {
      ++first;
    }
    break_cycle(&s, first, (uint32_t)++sort->cycles);
    drain(&s);
  }
  sort->ordered = sort->cycles ? 0 : n;
  return chi_is_cancelled(exec) ? CHI_ERROR_CANCELLED : CHI_OK;
}

void chi_order_sort_free(const chi_exec* exec, chi_order_sort* sort)
{
  chi_buffer_free(exec, &sort->sides);
  chi_buffer_free(exec, &sort->waiting);
  chi_buffer_free(exec, &sort->queue);
  chi_buffer_free(exec, &sort->walk);
  chi_buffer_free(exec, &sort->spare);
  chi_buffer_free(exec, &sort->relations);
  chi_buffer_free(exec, &sort->relation_starts);
  chi_buffer_free(exec, &sort->boxes);
  chi_buffer_free(exec, &sort->bands);
  chi_buffer_free(exec, &sort->counts);
  chi_buffer_free(exec, &sort->events);
  chi_buffer_free(exec, &sort->found);
}
