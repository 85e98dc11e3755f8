/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An order of a view nearby: relations that have turned lie within spans of ranks. Sorting those
 * spans anew puts all right, since what crosses a span's ends was right and stays so.
 */
#include "chi_tet_order_internal.h"

enum
{
  SPANS = 16, /* a chunk; more relations than that are sorted as a whole */
  SHARE = 4   /* likewise where spans are more than a quarter of all */
};

typedef struct span
{
  uint32_t low, high; /* ranks, both included */
} span;

typedef struct repair_job
{
  const chi_order_sorter* s;
  size_t count;
  span spans[CHI_ORDER_CHUNKS][SPANS];
  uint32_t found[CHI_ORDER_CHUNKS];
} repair_job;

static void place(void* data, size_t begin, size_t end)
{
  const repair_job* const it = (const repair_job*)data;
  const size_t chunk = chi_order_chunk(it->count);
  for (size_t i = begin * chunk; i < end * chunk && i < it->count; ++i)
  {
    it->s->keys[it->s->queue[i]] = (uint32_t)i;
  }
}

static void compare(repair_job* it, size_t chunk, uint32_t from, uint32_t to)
{
  const span turned = { it->s->keys[to], it->s->keys[from] };
  if (turned.low < turned.high)
  {
    if (it->found[chunk] < SPANS)
    {
      it->spans[chunk][it->found[chunk]] = turned;
    }
    ++it->found[chunk];
  }
}

static void find_turned(void* data, size_t begin, size_t end)
{
  repair_job* const it = (repair_job*)data;
  const chi_order_sorter* const s = it->s;
  const size_t size = chi_order_chunk(it->count);
  for (size_t c = begin; c < end; ++c)
  {
    it->found[c] = 0;
    for (size_t t = c * size; t < it->count && t < (c + 1) * size && it->found[c] <= SPANS; ++t)
    {
      for (size_t i = 0; i < 4; ++i)
      {
        if (s->sides[t] >> i & 1)
        {
          compare(it, c, (uint32_t)t, s->neighbors[4 * t + i]);
        }
      }
      for (size_t k = s->relations ? s->starts[t] : 0; s->relations && k < s->starts[t + 1]; ++k)
      {
        compare(it, c, (uint32_t)t, s->relations[k].to);
      }
    }
  }
}

/* Spans that overlap are one. */
static size_t unite(span* spans, size_t count)
{
  for (size_t i = 1; i < count; ++i)
  {
    const span moved = spans[i];
    size_t at = i;
    for (; at > 0 && spans[at - 1].low > moved.low; --at)
    {
      spans[at] = spans[at - 1];
    }
    spans[at] = moved;
  }
  size_t kept = 0;
  for (size_t i = 0; i < count; ++i)
  {
    if (kept && spans[i].low <= spans[kept - 1].high)
    {
      spans[kept - 1].high =
        spans[i].high > spans[kept - 1].high ? spans[i].high : spans[kept - 1].high;
    }
    else
    {
      spans[kept++] = spans[i];
    }
  }
  return kept;
}

static int is_within(const chi_order_sorter* s, const span* r, uint32_t t)
{
  return s->keys[t] >= r->low && s->keys[t] <= r->high;
}

static void release(const chi_order_sorter* s, const span* r, uint32_t t, uint32_t* out, size_t* n)
{
  if (is_within(s, r, t) && --s->waiting[t] == 0)
  {
    out[(*n)++] = t;
  }
}

/* 0 where there is a cycle. */
static int sort_span(const chi_order_sorter* s, const span* r, uint32_t* out)
{
  const size_t size = r->high - r->low + 1;
  const uint32_t* const old = s->queue + r->low;
  size_t tail = 0;
  for (size_t i = 0; i < size; ++i)
  {
    const uint32_t t = old[i];
    s->waiting[t] = 0;
    for (size_t k = 0; k < 4; ++k)
    {
      s->waiting[t] +=
        s->sides[t] >> (4 + k) & 1 && is_within(s, r, s->neighbors[4 * (size_t)t + k]);
    }
  }
  for (size_t i = 0; i < size && s->relations; ++i)
  {
    for (size_t k = s->starts[old[i]]; k < s->starts[old[i] + 1]; ++k)
    {
      s->waiting[s->relations[k].to] += (uint32_t)is_within(s, r, s->relations[k].to);
    }
  }
  for (size_t i = 0; i < size; ++i)
  {
    if (s->waiting[old[i]] == 0)
    {
      out[tail++] = old[i];
    }
  }
  for (size_t head = 0; head < tail; ++head)
  {
    const uint32_t t = out[head];
    for (size_t i = 0; i < 4; ++i)
    {
      if (s->sides[t] >> i & 1)
      {
        release(s, r, s->neighbors[4 * (size_t)t + i], out, &tail);
      }
    }
    for (size_t k = s->relations ? s->starts[t] : 0; s->relations && k < s->starts[t + 1]; ++k)
    {
      release(s, r, s->relations[k].to, out, &tail);
    }
  }
  if (tail < size)
  {
    return 0;
  }
  memcpy(s->queue + r->low, out, size * sizeof *out);
  for (size_t i = 0; i < size; ++i)
  {
    s->keys[out[i]] = r->low + (uint32_t)i;
  }
  return 1;
}

chi_status chi_order_repair(
  const chi_exec* exec, chi_order_sort* sort, chi_order_sorter* s, size_t count, int* outcome)
{
  repair_job job = { .s = s, .count = count };
  span spans[CHI_ORDER_CHUNKS * SPANS];
  size_t found = 0, sum = 0;
  *outcome = CHI_ORDER_TOO_MUCH;
  chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, place, &job);
  status = status == CHI_OK ? chi_for(exec, CHI_ORDER_CHUNKS, find_turned, &job) : status;
  for (size_t c = 0; c < CHI_ORDER_CHUNKS && status == CHI_OK; ++c)
  {
    if (job.found[c] > SPANS)
    {
      return CHI_OK;
    }
    memcpy(spans + found, job.spans[c], job.found[c] * sizeof *spans);
    found += job.found[c];
  }
  found = unite(spans, found);
  for (size_t i = 0; i < found; ++i)
  {
    sum += spans[i].high - spans[i].low + 1;
  }
  if (status != CHI_OK || sum > count / SHARE)
  {
    return status;
  }
  for (size_t i = 0; i < found; ++i)
  {
    if (!sort_span(s, spans + i, (uint32_t*)sort->spare.data))
    {
      *outcome = CHI_ORDER_SPOILED;
      return CHI_OK;
    }
  }
  sort->replaced = (int64_t)sum;
  sort->cycles = 0;
  *outcome = CHI_ORDER_REPAIRED;
  return CHI_OK;
}
