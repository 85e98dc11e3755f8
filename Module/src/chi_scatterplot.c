/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Stages of a plot: check what is given, look through the mesh piece by piece, agree on range and
 * quantum, deposit the pieces, add up. Sums over pieces are of integers, so that neither threads
 * nor processes change a bit.
 */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  MOST_BINS = 32768,
  MOST_BINS_TOGETHER = 1 << 28,
  TILE_BUDGET = 65536, /* doubles: half a megabyte stays in the second cache */
  DEEP = 12,           /* bits that a window may fall short of what touches it */
  MOST_LEVELS = 6,     /* of subdivision */
  DEFAULT_LEVELS = 4,
  MASS_BITS = CHI_SCATTER_MASS_BITS
};

/* ---- the handle */

chi_status chi_scatterplot_create(const chi_exec* exec, chi_scatterplot** plot)
{
  if (!plot)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *plot = (chi_scatterplot*)chi_alloc(exec, 1, sizeof **plot);
  if (!*plot)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*plot, 0, sizeof **plot);
  (*plot)->has_exec = exec != NULL;
  if (exec)
  {
    (*plot)->exec = *exec;
  }
  return CHI_OK;
}

void chi_scatterplot_destroy(chi_scatterplot* plot)
{
  if (!plot)
  {
    return;
  }
  const chi_exec own = plot->exec;
  const chi_exec* const exec = plot->has_exec ? &own : NULL;
  for (size_t i = 0; i < plot->worker_count; ++i)
  {
    chi_scatter_free_worker(exec, plot->workers[i]);
  }
  chi_buffer_free(exec, &plot->pieces);
  chi_buffer_free(exec, &plot->order);
  chi_buffer_free(exec, &plot->masses);
  chi_free(exec, plot, 1, sizeof *plot);
}

/* ---- what is given */

static int field_is_valid(const chi_array_view* field, int32_t component, size_t count)
{
  return chi_array_is_valid(field) && field->count == count && component >= -1 &&
    (component < 0 || (size_t)component < field->components);
}

static chi_status check_input(chi_scatter_job* job)
{
  const chi_scatterplot_input* const in = &job->input;
  const chi_status status = chi_grid_open(&job->grid, in->grid);
  if (status != CHI_OK)
  {
    return status;
  }
  const size_t count =
    in->association == CHI_SCATTERPLOT_CELLS ? job->grid.cells : job->grid.points;
  const size_t weights =
    in->weight_association == CHI_SCATTERPLOT_CELLS ? job->grid.cells : job->grid.points;
  int is_good = in->association >= CHI_SCATTERPLOT_POINTS &&
    in->association <= CHI_SCATTERPLOT_CELLS && in->weight_association >= CHI_SCATTERPLOT_POINTS &&
    in->weight_association <= CHI_SCATTERPLOT_CELLS;
  for (int f = 0; f < 2; ++f)
  {
    is_good = is_good && field_is_valid(&in->fields[f], in->components[f], count);
  }
  is_good =
    is_good && (!in->weight.data || field_is_valid(&in->weight, in->weight_component, weights));
  return is_good ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT;
}

static chi_status check_params(const chi_scatter_job* job)
{
  const chi_scatterplot_params* const p = &job->params;
  const uint32_t known = CHI_SCATTERPLOT_NO_EDGES | CHI_SCATTERPLOT_NO_ONE_BIN |
    CHI_SCATTERPLOT_NO_SKIP | CHI_SCATTERPLOT_NO_SORT | CHI_SCATTERPLOT_ALWAYS_SORT;
  if (p->bins[0] == 0 || p->bins[1] == 0 || p->method < CHI_SCATTERPLOT_EXACT ||
    p->method > CHI_SCATTERPLOT_PUBLISHED || p->switches & ~known ||
    !(p->splat_size >= 0 && p->splat_size <= 1) || !(p->trilinear_tolerance >= 0) ||
    !isfinite(p->trilinear_tolerance) || p->trilinear_levels < 0 ||
    p->trilinear_levels > MOST_LEVELS ||
    (p->reduction && (!job->reduction.max_f64 || !job->reduction.sum_i64)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  for (int f = 0; f < 2 && !p->automatic_range; ++f)
  {
    const double size = p->range[f][1] - p->range[f][0];
    if (!(size > 0) || !isfinite(size) || !isfinite((double)p->bins[f] / size))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
  }
  return p->bins[0] > MOST_BINS || p->bins[1] > MOST_BINS ||
      p->bins[0] * p->bins[1] > MOST_BINS_TOGETHER
    ? CHI_ERROR_TOO_LARGE
    : CHI_OK;
}

static void measure_pieces(void* data, size_t begin, size_t end)
{
  chi_scatter_job* const job = (chi_scatter_job*)data;
  chi_scatter_worker* const w = chi_scatter_acquire(job);
  for (size_t i = begin; i < end && w && !job->failed && !chi_is_cancelled(job->exec); ++i)
  {
    if (job->is_lattice)
    {
      chi_scatter_measure_brick(job, i, w->brick, job->pieces + i);
    }
    else
    {
      chi_scatter_visit_run(job, i, w, job->pieces + i);
    }
  }
  if (w)
  {
    chi_scatter_release(job, w);
  }
}

/* Workers get what the stage needs when they are taken. */
static void begin_stage(chi_scatter_job* job)
{
  for (size_t i = 0; i < job->keep->worker_count; ++i)
  {
    chi_scatter_worker* const w = job->keep->workers[i];
    w->is_busy = w->is_equipped = 0;
    w->mass = w->out = w->singular = w->bound = 0;
    w->splats = 0;
    w->sink_error = 0;
    w->subdivided = w->capped = w->folded = w->more_simplices = 0;
    w->edges = w->one_bin = w->sections = w->missing_pieces = w->one_bin_pieces = 0;
    w->sink.deposited = 0;
    w->sink.inside = w->sink.outside = w->sink.singular = 0;
  }
}

static chi_status run_stage(chi_scatter_job* job, chi_range_fn body)
{
  begin_stage(job);
  const chi_status status =
    job->piece_count ? chi_for(job->exec, job->piece_count, body, job) : CHI_OK;
  return job->failed ? (chi_status)job->failed : status;
}

/* What the pieces' contents depend on beside grid and values. */
static void describe_pieces(const chi_scatter_job* job, int32_t of[13])
{
  const chi_scatterplot_input* const in = &job->input;
  const int32_t all[13] = { in->components[0], in->components[1], in->association,
    in->weight_association, in->weight.data ? in->weight_component : -2, job->dimension,
    (int32_t)job->brick_phase[0], (int32_t)job->brick_phase[1], (int32_t)job->brick_phase[2],
    (int32_t)job->run_phase, (job->order != NULL) + 2 * (job->corners != NULL), job->is_lattice,
    job->params.trilinear_tolerance > 0 };
  memcpy(of, all, sizeof all);
}

static chi_status measure(chi_scatter_job* job, int* is_kept)
{
  chi_scatterplot* const keep = job->keep;
  const chi_exec* const exec = keep->has_exec ? &keep->exec : NULL;
  const uint64_t grid_version = job->grid.view.version, version = job->input.version;
  int32_t of[13];
  chi_scatter_plan_pieces(job);
  chi_status status = job->dimension > 0 ? chi_scatter_sort(job) : CHI_OK;
  if (job->corners)
  {
    chi_buffer_free(exec, &keep->masses); /* found again, rather than to take a half more memory */
  }
  else if (status == CHI_OK && job->dimension == 3 &&
    job->grid.view.kind == CHI_GRID_UNSTRUCTURED &&
    job->input.association == CHI_SCATTERPLOT_POINTS)
  {
    /* grows with the number of cells, which is the same where the rest is kept */
    const int is_there = chi_buffer_reserve(exec, &keep->masses, job->grid.cells, sizeof(double));
    status = is_there ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
    job->masses = (double*)keep->masses.data;
  }
  describe_pieces(job, of);
  *is_kept = version && grid_version && version == keep->version &&
    grid_version == keep->grid_version && job->piece_count == keep->piece_count &&
    memcmp(of, keep->kept_of, sizeof of) == 0;
  if (status != CHI_OK || *is_kept)
  {
    job->pieces = (chi_scatter_piece*)keep->pieces.data;
    return status;
  }
  keep->version = keep->grid_version = 0;
  if (!chi_buffer_reserve(exec, &keep->pieces, job->piece_count + 1, sizeof *job->pieces))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->pieces = (chi_scatter_piece*)keep->pieces.data;
  status = run_stage(job, measure_pieces);
  if (status == CHI_OK)
  {
    keep->version = version;
    keep->grid_version = grid_version;
    keep->piece_count = job->piece_count;
    memcpy(keep->kept_of, of, sizeof of);
  }
  return status;
}

/* ---- deposits */

static int32_t bin_of(double x, int32_t bins)
{
  return x < bins ? (int32_t)x : bins - 1;
}

/* A field is constant, so that no simplex has an area, and all is in one bin. */
static int is_in_one_bin(
  const chi_scatter_job* job, const chi_scatter_piece* p, const double box[4])
{
  const int32_t* const n = job->plot.bins;
  return (p->low[0] == p->high[0] || p->low[1] == p->high[1]) && box[0] >= 0 && box[2] >= 0 &&
    box[1] <= n[0] && box[3] <= n[1] && bin_of(box[0], n[0]) == bin_of(box[1], n[0]) &&
    bin_of(box[2], n[1]) == bin_of(box[3], n[1]);
}

static void deposit_piece(chi_scatter_job* job, size_t i, chi_scatter_worker* w)
{
  const chi_scatter_piece* const p = job->pieces + i;
  const int skips = !(job->params.switches & CHI_SCATTERPLOT_NO_SKIP) &&
    job->params.method == CHI_SCATTERPLOT_EXACT;
  double box[4];
  if (p->cells == 0)
  {
    return;
  }
  if (chi_scatter_misses(job, p, box) && !(job->params.switches & CHI_SCATTERPLOT_NO_SKIP))
  {
    w->sink.outside += p->mass;
    ++w->missing_pieces;
  }
  else if (skips && is_in_one_bin(job, p, box))
  {
    chi_scatter_deposit_at(job, w, box[0], box[2], p->mass);
    w->sink.singular += p->mass;
    w->one_bin += p->simplices;
    ++w->one_bin_pieces;
  }
  else if (job->is_lattice)
  {
    chi_scatter_deposit_brick(job, i, w);
  }
  else
  {
    chi_scatter_visit_run(job, i, w, NULL);
  }
  chi_scatter_settle(job, w);
}

static void deposit_pieces(void* data, size_t begin, size_t end)
{
  chi_scatter_job* const job = (chi_scatter_job*)data;
  chi_scatter_worker* const w = chi_scatter_acquire(job);
  for (size_t i = begin; i < end && w && !job->failed && !chi_is_cancelled(job->exec); ++i)
  {
    deposit_piece(job, i, w);
  }
  if (w)
  {
    chi_scatter_release(job, w);
  }
}

static chi_status deposit(chi_scatter_job* job, chi_scatter_masses* m)
{
  const chi_status status = chi_scatter_agree(job, run_stage(job, deposit_pieces), NULL, 0);
  return status == CHI_OK ? chi_scatter_sum(job, m) : status;
}

static chi_status compute(
  chi_scatter_job* job, chi_status status, double* density, chi_scatterplot_result* r)
{
  status = status == CHI_OK ? chi_scatter_look_at_types(job) : status;
  double dimension = job->dimension;
  status = chi_scatter_agree(job, status, &dimension, 1);
  if (status != CHI_OK)
  {
    return status;
  }
  job->dimension = (int)dimension;
  status = measure(job, &r->is_kept);
  if (job->exec && job->exec->progress && status == CHI_OK)
  {
    job->exec->progress(job->exec->user, 0.2);
  }
  status = chi_scatter_choose_range(job, status, r);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_scatter_set_plot(job, r);
  status = chi_scatter_choose_units(job);
  if (status != CHI_OK)
  {
    return status;
  }
  chi_scatter_masses m = { 0 };
  status = deposit(job, &m);
  int exponent;
  frexp((double)m.mass, &exponent);
  if (status == CHI_OK && m.mass != 0 && exponent < MASS_BITS - DEEP && !job->is_signed &&
    job->params.method == CHI_SCATTERPLOT_EXACT)
  {
    /* a window into little of the mass has a quantum of its own */
    job->plot.unit = ldexp(job->plot.unit, MASS_BITS - 1 - exponent);
    status = isfinite(job->plot.unit) ? deposit(job, &m) : CHI_ERROR_INVALID_ARGUMENT;
  }
  if (status != CHI_OK)
  {
    return status;
  }
  chi_scatter_count_pieces(job, r);
  chi_scatter_write_result(job, &m, density, r);
  return CHI_OK;
}

chi_status chi_scatterplot_compute(const chi_exec* exec, chi_scatterplot* plot,
  const chi_scatterplot_input* input, const chi_scatterplot_params* params, double* density,
  chi_scatterplot_result* result)
{
  chi_scatter_job job;
  memset(&job, 0, sizeof job);
  if (!plot || !input || !params || !density ||
    !CHI_ADOPT(chi_scatterplot_input, version, &job.input, input) ||
    !CHI_ADOPT(chi_scatterplot_params, reduction, &job.params, params) ||
    (job.params.reduction &&
      !CHI_ADOPT(chi_scatterplot_reduction, sum_i64, &job.reduction, job.params.reduction)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (job.params.trilinear_levels == 0)
  {
    job.params.trilinear_levels = DEFAULT_LEVELS;
  }
  job.exec = exec;
  job.keep = plot;
  job.kernels = chi_scatter_get_kernels();
  job.tile_budget = TILE_BUDGET;
  atomic_flag_clear(&job.lock);
  chi_status status = check_params(&job); /* the same in all processes */
  if (status != CHI_OK)
  {
    return status;
  }
  chi_scatterplot_result own = { .struct_size = sizeof own };
  status = compute(&job, check_input(&job), density, &own);
  if (result && status == CHI_OK)
  {
    *result = own;
  }
  if (exec && exec->progress && status == CHI_OK)
  {
    exec->progress(exec->user, 1);
  }
  return status;
}
