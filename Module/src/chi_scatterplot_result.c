/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Sums over threads and processes, and what is told of them. */

#include "chi_scatterplot_internal.h"

#include <math.h>

typedef struct sum_job
{
  const chi_scatter_job* job;
  int64_t* bins;
} sum_job;

enum
{
  BINS_A_CHUNK = 16384
};

static void sum_bins(void* data, size_t begin, size_t end)
{
  const sum_job* const s = (const sum_job*)data;
  const chi_scatterplot* const keep = s->job->keep;
  const size_t bins = s->job->params.bins[0] * s->job->params.bins[1];
  for (size_t c = begin; c < end; ++c)
  {
    const size_t first = c * BINS_A_CHUNK, last = chi_grid_chunk_end(first, BINS_A_CHUNK, bins);
    for (size_t k = 0; k < keep->worker_count; ++k)
    {
      const chi_scatter_worker* const w = keep->workers[k];
      for (size_t i = first; i < last && w->is_equipped && w->sink.bins != s->bins; ++i)
      {
        s->bins[i] += w->sink.bins[i];
      }
    }
  }
}

/* Running sums of edges leave 1e-13 of a piece's mass too much or too little: spread over all bins
 * in proportion, so that the sum is exact. */
static void spread(int64_t* bins, size_t count, int64_t rest)
{
  double total = 0, before = 0;
  int64_t done = 0;
  for (size_t i = 0; i < count; ++i)
  {
    total += fabs((double)bins[i]);
  }
  for (size_t i = 0; i < count && rest != 0 && total > 0; ++i)
  {
    before += fabs((double)bins[i]);
    const int64_t due = (int64_t)llrint((double)rest * (before / total));
    bins[i] += due - done;
    done = due;
  }
}

chi_status chi_scatter_sum(chi_scatter_job* job, chi_scatter_masses* m)
{
  chi_scatterplot* const keep = job->keep;
  const size_t count = job->params.bins[0] * job->params.bins[1];
  int64_t sums[6] = { 0 };
  chi_scatter_worker* const w = chi_scatter_acquire(job); /* one has to hold them */
  if (w)
  {
    m->bins = w->sink.bins;
    chi_scatter_release(job, w);
  }
  chi_status status = w ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
  sum_job s = { job, m->bins };
  if (w)
  {
    status = chi_for(job->exec, chi_grid_chunks(count, BINS_A_CHUNK), sum_bins, &s);
  }
  for (size_t k = 0; k < keep->worker_count; ++k)
  {
    const chi_scatter_worker* const one = keep->workers[k];
    sums[0] += one->mass;
    sums[1] += one->sink.deposited;
    sums[2] += one->out;
    sums[3] += one->singular;
    sums[5] += one->bound;
  }
  for (size_t i = 0; i < job->piece_count; ++i)
  {
    sums[4] += llrint(job->pieces[i].mass * job->total_unit);
  }
  status = chi_scatter_agree(job, status, NULL, 0);
  status = status == CHI_OK ? chi_scatter_add_up(job, sums, 6) : status;
  m->mass = sums[0];
  m->deposited = sums[1];
  m->out = (double)sums[2] / job->total_unit;
  m->singular = (double)sums[3] / job->total_unit;
  m->total = (double)sums[4] / job->total_unit;
  m->bound = (double)sums[5] / job->total_unit;
  return status == CHI_OK ? chi_scatter_add_up(job, m->bins, count) : status;
}

void chi_scatter_write_result(const chi_scatter_job* job, const chi_scatter_masses* m,
  double* density, chi_scatterplot_result* r)
{
  const size_t count = job->params.bins[0] * job->params.bins[1];
  const double area = (r->range[0][1] - r->range[0][0]) / (double)job->params.bins[0] *
    ((r->range[1][1] - r->range[1][0]) / (double)job->params.bins[1]);
  double sum = 0;
  if (job->params.method == CHI_SCATTERPLOT_EXACT)
  {
    spread(m->bins, count, m->mass - m->deposited);
  }
  for (size_t i = 0; i < count; ++i)
  {
    const double mass = (double)m->bins[i] / job->plot.unit;
    sum += mass;
    density[i] = mass != 0 ? mass / area : 0; /* the area may be beyond what doubles hold */
  }
  r->total_mass = m->total;
  /* what the published method loses or makes is not told from what is beyond */
  r->mass_out_of_range = job->params.method == CHI_SCATTERPLOT_EXACT ? m->out : m->total - sum;
  r->singular_mass = m->singular;
  r->splat_bound = m->bound;
}

void chi_scatter_count_pieces(const chi_scatter_job* job, chi_scatterplot_result* r)
{
  r->dimension = job->dimension;
  r->pieces = job->piece_count;
  r->is_sorted = job->order || job->corners;
  for (size_t k = 0; k < job->keep->worker_count; ++k)
  {
    const chi_scatter_worker* const w = job->keep->workers[k];
    r->edge_simplices += w->edges;
    r->one_bin_simplices += w->one_bin;
    r->section_simplices += w->sections;
    r->missing_pieces += w->missing_pieces;
    r->one_bin_pieces += w->one_bin_pieces;
    r->subdivided_cells += w->subdivided;
    r->capped_cells += w->capped;
    r->folded_cells += w->folded;
    r->splats += w->splats;
    r->simplices += w->more_simplices;
  }
  for (size_t i = 0; i < job->piece_count; ++i)
  {
    const chi_scatter_piece* const p = job->pieces + i;
    r->cells += p->cells;
    r->simplices += p->simplices;
    r->skipped_cells += p->skipped;
    r->ghost_cells += p->ghosts;
    r->blanked_cells += p->blanked;
    r->lower_dimensional_cells += p->lower_dimensional;
    r->unsupported_cells += p->unsupported;
  }
  if (job->dimension == 0)
  {
    r->lower_dimensional_cells = job->grid.cells;
  }
}
