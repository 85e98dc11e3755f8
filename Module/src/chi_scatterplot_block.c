/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Simplices of a list side by side: their values, what has to be left out, and their deposits, with
 * the edges that they share found in a small table. */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  LEAST_CAPACITY = CHI_SCATTER_RUN
};

/* The parts of one piece of memory; with `base` 0 only its size. */
static size_t lay_out(chi_scatter_block* b, size_t capacity, char* base)
{
  size_t at = 0;
#define PART(member, count)                                                                        \
  b->member = (void*)(base + at);                                                                  \
  at += ((count) * sizeof *b->member + 63) / 64 * 64
  PART(x, 4 * capacity + 8);
  PART(y, 4 * capacity + 8);
  PART(mass, capacity + 8);
  PART(ends, 6 * capacity);
  PART(center, capacity);
  PART(ids, 4 * capacity);
  PART(cell, capacity);
#undef PART
  return at;
}

int chi_scatter_reserve_block(chi_scatter_job* job, chi_scatter_worker* w, size_t count)
{
  chi_scatter_block* const b = &w->block;
  if (count <= b->capacity)
  {
    return 1;
  }
  const chi_exec* const exec = job->keep->has_exec ? &job->keep->exec : NULL;
  const size_t capacity = (count < LEAST_CAPACITY ? LEAST_CAPACITY : count + 7) / 8 * 8;
  size_t slots = 8;
  while (slots < 8 * capacity) /* an edge and a half a simplex, six at most */
  {
    slots *= 2;
  }
  chi_scatter_block none;
  static char nothing;
  const size_t bytes = lay_out(&none, capacity, &nothing);
  const int is_there = capacity <= SIZE_MAX / 512 &&
    chi_buffer_reserve(exec, &w->list_block, bytes, 1) &&
    chi_buffer_reserve(exec, &w->edge_block, 6 * capacity, sizeof *w->edge) &&
    chi_buffer_reserve(exec, &w->slot_block, slots, sizeof *w->slots);
  b->capacity = 0;
  if (!is_there)
  {
    job->failed = CHI_ERROR_OUT_OF_MEMORY;
    return 0;
  }
  lay_out(b, capacity, (char*)w->list_block.data);
  memset(w->list_block.data, 0, bytes); /* vectors read a little beyond what is written */
  b->capacity = capacity;
  w->edge = (chi_scatter_edge*)w->edge_block.data;
  w->slots = (uint32_t*)w->slot_block.data;
  w->slot_mask = slots - 1;
  return 1;
}

void chi_scatter_gather_block(const chi_scatter_job* job, chi_scatter_block* b)
{
  double* const values[2] = { b->x, b->y };
  const size_t points = job->grid.points;
  for (int f = 0; f < 2; ++f)
  {
    for (size_t c = 0; c < 4; ++c)
    {
      const uint32_t* const ids = b->ids + c * b->capacity;
      double* const out = values[f] + c * b->capacity;
      chi_scatter_gather(
        &job->input.fields[f], job->input.components[f], ids, points, b->count, out);
      for (size_t i = 0; i < b->count && b->centers > 0; ++i)
      {
        out[i] = ids[i] >= points ? b->center[ids[i] - points].value[f] : out[i];
      }
    }
  }
}

void chi_scatter_look_through(chi_scatter_block* b, int corners, chi_scatter_piece* piece)
{
  for (size_t first = 0, end; first < b->count; first = end)
  {
    double zero = 0, mass = 0, size = 0;
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
    for (end = first; end < b->count && b->cell[end] == b->cell[first]; ++end)
    {
      zero += 0 * b->mass[end];
      mass += b->mass[end];
      size += fabs(b->mass[end]);
      for (size_t c = 0; c < (size_t)corners; ++c)
      {
        const double x = b->x[c * b->capacity + end], y = b->y[c * b->capacity + end];
        zero += 0 * x + 0 * y;
        low[0] = x < low[0] ? x : low[0];
        high[0] = x > high[0] ? x : high[0];
        low[1] = y < low[1] ? y : low[1];
        high[1] = y > high[1] ? y : high[1];
      }
    }
    const int is_good = zero == 0;
    for (size_t i = first; i < end && !is_good; ++i)
    {
      b->mass[i] = NAN;
    }
    if (!piece)
    {
      continue;
    }
    piece->skipped += (uint32_t)!is_good;
    piece->cells += (uint32_t)is_good;
    piece->simplices += is_good ? (uint32_t)(end - first) : 0;
    piece->mass += is_good ? mass : 0;
    piece->size += is_good ? size : 0;
    for (int f = 0; f < 2 && is_good; ++f)
    {
      piece->low[f] = low[f] < piece->low[f] ? low[f] : piece->low[f];
      piece->high[f] = high[f] > piece->high[f] ? high[f] : piece->high[f];
    }
  }
}

/* Add a weight to the edge between two corners, which are places in the block's arrays. Until all
 * are there the edge's own ends are ids of points, lower one first: its key beside its weight. */
static void add_edge(chi_scatter_worker* w, size_t* count, size_t from, size_t to, double weight)
{
  const chi_scatter_block* const b = &w->block;
  const uint32_t p = b->ids[from], q = b->ids[to], low = p < q ? p : q, high = p < q ? q : p;
  size_t slot = (size_t)(((uint64_t)low << 32 | high) * 0x9e3779b97f4a7c15u >> 32) & w->slot_mask;
  for (; w->slots[slot]; slot = (slot + 1) & w->slot_mask)
  {
    chi_scatter_edge* const e = w->edge + w->slots[slot] - 1;
    if (e->from == low && e->to == high)
    {
      e->weight += weight;
      return;
    }
  }
  b->ends[*count][0] = (uint32_t)from;
  b->ends[*count][1] = (uint32_t)to;
  w->edge[*count] = (chi_scatter_edge){ low, high, weight };
  w->slots[slot] = (uint32_t)++ * count;
}

static void corners_at(const chi_scatter_block* b, size_t i, double x[4], double y[4])
{
  for (size_t c = 0; c < 4; ++c)
  {
    x[c] = b->x[c * b->capacity + i];
    y[c] = b->y[c * b->capacity + i];
  }
}

static void deposit_tetrahedra(chi_scatter_job* job, chi_scatter_worker* w, const double box[4])
{
  chi_scatter_block* const b = &w->block;
  double weight[6][CHI_SCATTER_CHUNK], x[4], y[4], most = 0, edge_mass = 0;
  uint8_t kind[CHI_SCATTER_CHUNK];
  size_t edges = 0;
  memset(w->slots, 0, (w->slot_mask + 1) * sizeof *w->slots);
  if (chi_scatter_splats(job))
  {
    chi_scatter_splat_list(job, w);
  }
  for (size_t i = 0; i < b->count; ++i)
  {
    most = fabs(b->mass[i]) > most ? fabs(b->mass[i]) : most;
  }
  for (size_t first = 0; first < b->count; first += CHI_SCATTER_CHUNK)
  {
    const size_t left = b->count - first;
    const size_t count = left < CHI_SCATTER_CHUNK ? left : CHI_SCATTER_CHUNK;
    job->kernels->classify(&job->plot, b->x + first, b->y + first, b->capacity, b->mass + first,
      count, chi_scatter_light(most), weight, kind);
    for (size_t k = 0; k < count; ++k)
    {
      const size_t i = first + k;
      switch (kind[k])
      {
        case CHI_SCATTER_EDGES:
          for (size_t e = 0; e < 6; ++e)
          {
            add_edge(w, &edges, chi_scatter_ends[e][0] * b->capacity + i,
              chi_scatter_ends[e][1] * b->capacity + i, weight[e][k]);
          }
          edge_mass += b->mass[i];
          ++w->edges;
          break;
        case CHI_SCATTER_ONE_BIN:
          chi_scatter_deposit_at(job, w, b->x[i], b->y[i], b->mass[i]);
          ++w->one_bin;
          break;
        case CHI_SCATTER_SECTIONS:
          corners_at(b, i, x, y);
          chi_scatter_deposit_simplex(job, w, 4, x, y, b->mass[i]);
          break;
        default:
          break;
      }
    }
  }
  for (size_t e = 0; e < edges; ++e)
  {
    w->edge[e].from = b->ends[e][0];
    w->edge[e].to = b->ends[e][1];
  }
  if (edges > 0)
  {
    chi_scatter_deposit_edges(job, w, b->x, b->y, edges, edge_mass, box, chi_scatter_noise(most));
  }
}

void chi_scatter_deposit_block(chi_scatter_job* job, chi_scatter_worker* w, size_t run)
{
  chi_scatter_block* const b = &w->block;
  const chi_scatter_piece* const all = job->pieces + run;
  const size_t corners = (size_t)job->dimension + 1;
  double box[4] = { all->low[0], all->high[0], all->low[1], all->high[1] }, x[4], y[4];
  chi_scatter_map(&job->plot, 0, box, 2);
  chi_scatter_map(&job->plot, 1, box + 2, 2);
  for (size_t c = 0; c < corners; ++c)
  {
    job->kernels->map(&job->plot, 0, b->x + c * b->capacity, b->count);
    job->kernels->map(&job->plot, 1, b->y + c * b->capacity, b->count);
  }
  if (corners == 4)
  {
    deposit_tetrahedra(job, w, box);
  }
  for (size_t i = 0; i < b->count && corners == 3; ++i)
  {
    corners_at(b, i, x, y);
    if (b->mass[i] == b->mass[i])
    {
      chi_scatter_deposit_simplex(job, w, 3, x, y, b->mass[i]);
    }
  }
}

void chi_scatter_finish_block(
  chi_scatter_job* job, chi_scatter_worker* w, size_t run, chi_scatter_piece* piece)
{
  chi_scatter_block* const b = &w->block;
  if (b->count > 0)
  {
    chi_scatter_gather_block(job, b);
    if (piece || job->pieces[run].skipped > 0)
    {
      chi_scatter_look_through(b, job->dimension + 1, piece);
    }
    if (!piece)
    {
      chi_scatter_deposit_block(job, w, run);
    }
  }
  b->count = b->centers = 0;
}
