/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Points of one name, made in several jobs, become one: that of the first job, which adds up what
 * the others know of it in the order of the jobs. Names are dealt out to fixed partitions by their
 * hash, each of which is worked through in order, so nothing depends on the schedule.
 */

#include "chi_fiber_internal.h"

typedef struct weld_job
{
  const chi_exec* exec;
  chi_fiber_parts* parts;
  chi_fiber_pairs* pairs;
  size_t (*counts)[CHI_FIBER_PARTITIONS]; /* [jobs] then where each writes */
  uint32_t* order;                        /* [points] places, partition by partition */
  size_t first[CHI_FIBER_PARTITIONS + 1];
} weld_job;

static size_t partition_of(const chi_fiber_name* name)
{
  return chi_fiber_hash(name) % CHI_FIBER_PARTITIONS; /* the table uses the high bits */
}

static void count_names(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = job->pairs->job + j;
    const chi_fiber_name* const name = job->parts->name + own->first_corner;
    memset(job->counts[j], 0, sizeof job->counts[j]);
    for (size_t i = 0; i < own->points; ++i)
    {
      ++job->counts[j][partition_of(name + i)];
    }
  }
}

static void deal_names(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = job->pairs->job + j;
    const chi_fiber_name* const name = job->parts->name + own->first_corner;
    for (size_t i = 0; i < own->points; ++i)
    {
      job->order[job->counts[j][partition_of(name + i)]++] = (uint32_t)(own->first_corner + i);
    }
  }
}

/* `id` becomes the place of the first point of that name. */
static void weld_partitions(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  chi_fiber_parts* const parts = job->parts;
  for (size_t p = begin; p < end; ++p)
  {
    const size_t count = job->first[p + 1] - job->first[p], size = 2 * count;
    uint32_t* const table = parts->table + 2 * job->first[p];
    memset(table, 0xff, size * sizeof *table);
    for (size_t k = 0; k < count; ++k)
    {
      if (k % 4096 == 0 && chi_is_cancelled(job->exec))
      {
        return;
      }
      const uint32_t place = job->order[job->first[p] + k];
      const chi_fiber_name* const name = parts->name + place;
      size_t at = (size_t)((uint64_t)chi_fiber_hash(name) * size >> 32);
      while (table[at] != CHI_FIBER_NONE && !chi_fiber_same(parts->name + table[at], name))
      {
        at = at + 1 < size ? at + 1 : 0;
      }
      const uint32_t first = table[at] == CHI_FIBER_NONE ? place : table[at];
      table[at] = first;
      parts->id[place] = first;
      parts->used[first] |= parts->used[place];
      for (int i = 0; i < 3 && parts->normal && first != place; ++i)
      {
        parts->normal[first][i] += parts->normal[place][i];
      }
    }
  }
}

static void count_own(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    chi_fiber_job* const own = job->pairs->job + j;
    own->own = 0;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      own->own += job->parts->id[i] == i && job->parts->used[i];
    }
  }
}

/* First points get their number, noted in the table, which is as long and no longer needed; but not
 * those whose triangles have all fallen together. */
static void number_own(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = job->pairs->job + j;
    uint32_t next = (uint32_t)own->first_own;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      if (job->parts->id[i] == i)
      {
        job->parts->table[i] = job->parts->used[i] ? next++ : CHI_FIBER_NONE;
      }
    }
  }
}

static void number_all(void* data, size_t begin, size_t end)
{
  const weld_job* const job = (const weld_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    const chi_fiber_job* const own = job->pairs->job + j;
    for (size_t i = own->first_corner; i < own->first_corner + own->points; ++i)
    {
      job->parts->id[i] = job->parts->table[job->parts->id[i]];
    }
  }
}

static void add_up_partitions(weld_job* job)
{
  size_t at = 0;
  for (size_t p = 0; p < CHI_FIBER_PARTITIONS; ++p)
  {
    job->first[p] = at;
    for (size_t j = 0; j < job->pairs->jobs; ++j)
    {
      const size_t count = job->counts[j][p];
      job->counts[j][p] = at;
      at += count;
    }
  }
  job->first[CHI_FIBER_PARTITIONS] = at;
}

chi_status chi_fiber_weld(const chi_exec* exec, chi_fiber_parts* parts, chi_fiber_pairs* pairs,
  size_t* points, size_t* triangles)
{
  size_t names = 0;
  for (size_t j = 0; j < pairs->jobs; ++j)
  {
    names += pairs->job[j].points;
  }
  if (!chi_buffer_reserve(
        exec, &parts->partition_buffer, pairs->jobs + 1, CHI_FIBER_PARTITIONS * sizeof(size_t)) ||
    !chi_buffer_reserve(exec, &parts->order_buffer, names + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  weld_job job = { .exec = exec,
    .parts = parts,
    .pairs = pairs,
    .counts = (size_t(*)[CHI_FIBER_PARTITIONS])parts->partition_buffer.data,
    .order = (uint32_t*)parts->order_buffer.data };
  chi_status status = chi_for(exec, pairs->jobs, count_names, &job);
  if (status == CHI_OK)
  {
    add_up_partitions(&job);
    status = chi_for(exec, pairs->jobs, deal_names, &job);
  }
  status = status == CHI_OK ? chi_for(exec, CHI_FIBER_PARTITIONS, weld_partitions, &job) : status;
  status = status == CHI_OK ? chi_for(exec, pairs->jobs, count_own, &job) : status;
  *points = *triangles = 0;
  for (size_t j = 0; j < pairs->jobs && status == CHI_OK; ++j)
  {
    pairs->job[j].first_own = *points;
    pairs->job[j].first_triangle = *triangles;
    *points += pairs->job[j].own;
    *triangles += pairs->job[j].triangles;
  }
  status = status == CHI_OK ? chi_for(exec, pairs->jobs, number_own, &job) : status;
  return status == CHI_OK ? chi_for(exec, pairs->jobs, number_all, &job) : status;
}
