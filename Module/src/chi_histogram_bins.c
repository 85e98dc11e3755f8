/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Windows of values, and all pieces of a mesh into their bins. */

#include "chi_histogram_internal.h"

#include <math.h>

int chi_histogram_open_window(chi_histogram_window* w, double low, double high, size_t bins)
{
  double size = 1;
  while (size < (double)bins)
  {
    size *= 2;
  }
  *w = (chi_histogram_window){ .low = low,
    .high = high,
    .scale = (double)bins / (high - low),
    .snap = 3 * size,
    .quantum = size * 0x1p-51, /* of numbers from 2 to 4 sizes */
    .bins = bins };
  return low < high && isfinite(high - low) && isfinite(w->scale);
}

/* ---- pieces in groups, whose bins are added up in order */

typedef struct bin_job
{
  const chi_exec* exec;
  const chi_histogram* histogram;
  const chi_histogram_window* window;
  const chi_histogram_kernels* kernels;
  size_t groups, slots;
  size_t numbers;                               /* two a slot: masses of all, areas of all */
  chi_sum* sums;                                /* [groups][numbers] */
  int64_t (*skipped)[CHI_HISTOGRAM_SKIP_KINDS]; /* [groups] */
  chi_status* status;                           /* [groups] */
} bin_job;

static void put_piece(bin_job* job, size_t group, size_t index, chi_histogram_block* block,
  const chi_histogram_tile* tile)
{
  const chi_histogram_window* const w = job->window;
  const chi_histogram_plan* const plan = &job->histogram->plan;
  const chi_histogram_piece* const piece = chi_histogram_pieces(job->histogram) + index;
  if (piece->low > piece->high)
  {
    return;
  }
  const double low = chi_histogram_map(w, piece->low), high = chi_histogram_map(w, piece->high);
  const int is_constant = low == high;
  size_t first = is_constant ? chi_histogram_constant_slot(w, low) : chi_histogram_slot(w, low);
  const size_t last = is_constant ? first : chi_histogram_slot(w, high);
  /* of what begins at the upper end, constants are in the last bin, and the rest above */
  const int is_outside = last == 0 || low > (double)w->bins;
  const int kind = is_outside ? CHI_HISTOGRAM_SKIP_OUTSIDE : CHI_HISTOGRAM_SKIP_ONE_BIN;
  const int is_one = first == last && (is_outside || first <= w->bins);
  if (is_one && !(plan->no_skipping & kind))
  {
    tile->mass[first] = piece->mass;
    tile->area[first] = piece->area;
    ++job->skipped[group][is_outside ? 0 : 1];
  }
  else
  {
    job->status[group] = chi_histogram_fill(job->exec, plan, index, block, NULL);
    if (job->status[group] == CHI_OK)
    {
      job->kernels->put(
        w, block->value, plan->corners, block->mass, block->area, block->count, tile);
    }
    first = first > w->bins ? w->bins : first;
  }
  chi_sum* const masses = job->sums + group * job->numbers;
  chi_sum* const areas = masses + job->slots;
  for (size_t k = first; k <= last; ++k)
  {
    chi_sum_add(masses + k, tile->mass[k]);
    chi_sum_add(areas + k, tile->area[k]);
    tile->mass[k] = tile->area[k] = 0;
  }
}

static void put_groups(void* data, size_t begin, size_t end)
{
  bin_job* const job = (bin_job*)data;
  const size_t pieces = job->histogram->plan.pieces;
  chi_histogram_block block = { 0 };
  const size_t room = job->slots + CHI_HISTOGRAM_PADDING;
  double* const memory = (double*)chi_alloc(job->exec, 2 * room, sizeof *memory);
  const chi_histogram_tile tile = { memory, memory ? memory + room : NULL };
  if (memory)
  {
    memset(memory, 0, 2 * room * sizeof *memory);
  }
  for (size_t g = begin; g < end; ++g)
  {
    chi_sum* const sums = job->sums + g * job->numbers;
    memset(sums, 0, job->numbers * sizeof *sums);
    memset(job->skipped[g], 0, sizeof job->skipped[g]);
    job->status[g] = memory ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
    const size_t last = (g + 1) * pieces / job->groups;
    for (size_t i = g * pieces / job->groups; i < last && job->status[g] == CHI_OK; ++i)
    {
      if (chi_is_cancelled(job->exec))
      {
        job->status[g] = CHI_ERROR_CANCELLED;
        break;
      }
      put_piece(job, g, i, &block, &tile);
    }
  }
  chi_histogram_free_block(job->exec, &block);
  if (memory)
  {
    chi_free(job->exec, memory, 2 * room, sizeof *memory);
  }
}

/* Few groups where there are many bins, so that their memory stays in bounds; whatever the threads,
 * for the same bits. */
static size_t groups_of(size_t bins, size_t pieces)
{
  const size_t count = ((size_t)1 << 18) / bins;
  const size_t most = count < 8 ? 8 : count > CHI_HISTOGRAM_GROUPS ? CHI_HISTOGRAM_GROUPS : count;
  return most < pieces ? most : pieces;
}

chi_status chi_histogram_fill_window(const chi_exec* exec, chi_histogram* h,
  const chi_histogram_window* w, int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS])
{
  int64_t of_groups[CHI_HISTOGRAM_GROUPS][CHI_HISTOGRAM_SKIP_KINDS];
  chi_status states[CHI_HISTOGRAM_GROUPS] = { CHI_OK };
  bin_job job = { .exec = exec,
    .histogram = h,
    .window = w,
    .kernels = chi_histogram_get_kernels(),
    .groups = groups_of(w->bins, h->plan.pieces),
    .slots = w->bins + 2,
    .numbers = 2 * (w->bins + 2),
    .skipped = of_groups,
    .status = states };
  if (!chi_buffer_reserve(exec, &h->group_buffer, job.groups * job.numbers + 1, sizeof *job.sums) ||
    !chi_buffer_reserve(exec, &h->bin_buffer, job.numbers, sizeof(double)))
  {
    return chi_histogram_agree(&h->plan, CHI_ERROR_OUT_OF_MEMORY, NULL, 0);
  }
  job.sums = (chi_sum*)h->group_buffer.data;
  chi_status status = job.groups > 0 ? chi_for(exec, job.groups, put_groups, &job) : CHI_OK;
  double* const out = (double*)h->bin_buffer.data;
  for (size_t g = 0; g < job.groups && status == CHI_OK; ++g)
  {
    status = states[g];
    for (int k = 0; k < CHI_HISTOGRAM_SKIP_KINDS; ++k)
    {
      skipped[k] += of_groups[g][k];
    }
  }
  for (size_t i = 0; i < job.numbers && status == CHI_OK; ++i)
  {
    chi_sum sum = { 0, 0 };
    for (size_t g = 0; g < job.groups; ++g)
    {
      const chi_sum* const part = job.sums + g * job.numbers + i;
      chi_sum_add(&sum, part->high);
      chi_sum_add(&sum, part->low);
    }
    out[i] = chi_sum_value(&sum);
  }
  status = chi_histogram_agree(&h->plan, status, NULL, 0);
  status = status == CHI_OK ? chi_histogram_sum(&h->plan, out, job.slots) : status;
  return status == CHI_OK ? chi_histogram_sum(&h->plan, out + job.slots, job.slots) : status;
}
