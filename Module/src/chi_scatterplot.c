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
  TILE_BUDGET = 32768, /* doubles: a quarter of a megabyte stays in the second cache */
  DEEP = 12,           /* bits that a window may fall short of what touches it */
  MOST_LEVELS = 6,     /* of subdivision */
  DEFAULT_LEVELS = 4,
  MASS_BITS = 61 /* of all mass together: sums of integers do not overflow */
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

/* ---- all processes together */

/* Maxima over processes, the worst status among them; without others as they are. */
static chi_status agree(const chi_scatter_job* job, chi_status status, double* values, size_t count)
{
  double all[8] = { status };
  if (!job->params.reduction)
  {
    return status;
  }
  for (size_t i = 0; i < count; ++i)
  {
    all[1 + i] = values[i];
  }
  if (job->reduction.max_f64(job->reduction.user, all, count + 1))
  {
    return CHI_ERROR_CANCELLED;
  }
  for (size_t i = 0; i < count; ++i)
  {
    values[i] = all[1 + i];
  }
  return (chi_status)all[0];
}

static chi_status add_up(const chi_scatter_job* job, int64_t* values, size_t count)
{
  return job->params.reduction && job->reduction.sum_i64(job->reduction.user, values, count)
    ? CHI_ERROR_CANCELLED
    : CHI_OK;
}

/* The exponent e of a sum over processes that is < 2^e. Slightly more is assumed, so that sums that
 * are rounded differently do not fall on both sides of a power of two. */
static chi_status find_exponent(const chi_scatter_job* job, double size, int* exponent)
{
  double largest = size;
  chi_status status = agree(job, CHI_OK, &largest, 1);
  if (status != CHI_OK || !(largest > 0))
  {
    *exponent = 0;
    return status;
  }
  frexp(largest, exponent);
  int64_t sum = (int64_t)llrint(ldexp(size, 40 - *exponent));
  status = add_up(job, &sum, 1);
  int more;
  frexp((double)sum * (1 + 1e-9) + 1, &more);
  *exponent += more - 40;
  return status;
}

/* ---- the mesh */

/* The highest dimension among an unstructured grid's types of cells. */
static int find_dimension(const chi_grid* grid)
{
  const chi_grid_view* const v = &grid->view;
  int dimension = 0;
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    int axes = 0;
    for (int a = 0; a < 3 && grid->cells > 0; ++a)
    {
      axes += v->dimensions[a] > 1;
    }
    return axes < 2 ? 0 : axes;
  }
  uint8_t is_there[256] = { 0 };
  for (size_t i = 0; i < v->cell_count; ++i)
  {
    is_there[v->cell_types[i]] = 1;
  }
  for (int type = 0; type < 256; ++type)
  {
    if (is_there[type])
    {
      const int d = chi_cell_type_of(type) || type == 42 ? 3 : chi_scatter_is_polygon(type) ? 2 : 0;
      dimension = d > dimension ? d : dimension;
    }
  }
  return dimension;
}

static double determinant3(const double* m)
{
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
    m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/* Whether cell i is the tetrahedron of the ids 4 i ... 4 i + 3, so that only these have to be read.
 */
static int is_uniform(const chi_grid_view* v)
{
  int is_there = v->kind == CHI_GRID_UNSTRUCTURED && v->connectivity_count / 4 >= v->cell_count;
  for (size_t i = 0; is_there && i < v->cell_count; ++i)
  {
    is_there = v->cell_types[i] == 10 && v->offsets[i] == 4 * (int64_t)i;
  }
  return is_there &&
    (v->cell_count == 0 || v->offsets[v->cell_count] == 4 * (int64_t)v->cell_count);
}

static void plan_pieces(chi_scatter_job* job)
{
  const chi_grid* const grid = &job->grid;
  const int kind = grid->view.kind;
  job->is_lattice = job->dimension == 3 &&
    (kind == CHI_GRID_IMAGE || kind == CHI_GRID_RECTILINEAR) &&
    job->input.association == CHI_SCATTERPLOT_POINTS;
  job->cell_volume = kind == CHI_GRID_IMAGE ? fabs(determinant3(grid->view.index_to_world)) / 6 : 0;
  /* the dimension is that of all processes, and this one's part may be empty */
  job->piece_count = job->dimension > 0 && grid->cells > 0;
  job->is_uniform = is_uniform(&grid->view);
  for (int a = 0; a < 3 && job->is_lattice; ++a)
  {
    const int64_t rest = job->input.first_index[a] % CHI_SCATTER_BRICK;
    job->brick_phase[a] = (size_t)(rest < 0 ? rest + CHI_SCATTER_BRICK : rest);
    job->bricks[a] = chi_grid_chunks(job->brick_phase[a] + grid->dimensions[a], CHI_SCATTER_BRICK);
    job->piece_count *= job->bricks[a];
  }
  if (!job->is_lattice && job->piece_count > 0)
  {
    const int64_t rest = job->input.first_cell % CHI_SCATTER_RUN;
    job->run_phase = (size_t)(rest < 0 ? rest + CHI_SCATTER_RUN : rest);
    job->piece_count = chi_grid_chunks(job->run_phase + grid->cells, CHI_SCATTER_RUN);
  }
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
    (int32_t)job->run_phase, job->order != NULL, job->is_lattice,
    job->params.trilinear_tolerance > 0 };
  memcpy(of, all, sizeof all);
}

static chi_status measure(chi_scatter_job* job, int* is_kept)
{
  chi_scatterplot* const keep = job->keep;
  const chi_exec* const exec = keep->has_exec ? &keep->exec : NULL;
  const uint64_t grid_version = job->grid.view.version, version = job->input.version;
  int32_t of[13];
  plan_pieces(job);
  chi_status status = job->dimension > 0 ? chi_scatter_sort(job) : CHI_OK;
  if (status == CHI_OK && job->dimension == 3 && job->grid.view.kind == CHI_GRID_UNSTRUCTURED &&
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

/* ---- range and quantum */

static chi_status choose_range(chi_scatter_job* job, chi_status status, chi_scatterplot_result* r)
{
  /* negative lower ends, upper ends */
  double extremes[4] = { -INFINITY, -INFINITY, -INFINITY, -INFINITY };
  for (size_t i = 0; i < job->piece_count && status == CHI_OK; ++i)
  {
    const chi_scatter_piece* const p = job->pieces + i;
    for (int f = 0; f < 2; ++f)
    {
      extremes[f] = -p->low[f] > extremes[f] ? -p->low[f] : extremes[f];
      extremes[2 + f] = p->high[f] > extremes[2 + f] ? p->high[f] : extremes[2 + f];
    }
  }
  status = agree(job, status, extremes, 4);
  memcpy(r->range, job->params.range, sizeof r->range);
  for (int f = 0; f < 2 && job->params.automatic_range; ++f)
  {
    double low = -extremes[f], high = extremes[2 + f];
    if (!(low <= high))
    {
      low = 0; /* nothing there */
      high = 1;
    }
    else if (!(low < high) || !isfinite((double)job->params.bins[f] / (high - low)))
    {
      const double half = 0.5e-6 * (fabs(low) > 1 ? fabs(low) : 1);
      low -= half;
      high = low + 2 * half;
      r->constant_fields |= 1 << f;
    }
    if (!isfinite(high - low)) /* beyond half of double's range */
    {
      return status == CHI_OK ? CHI_ERROR_INVALID_ARGUMENT : status;
    }
    r->range[f][0] = low;
    r->range[f][1] = high;
  }
  return status;
}

static void set_plot(chi_scatter_job* job, const chi_scatterplot_result* r)
{
  chi_scatter_plot* const plot = &job->plot;
  const int64_t most = (int64_t)(job->params.bins[0] > job->params.bins[1] ? job->params.bins[0]
                                                                           : job->params.bins[1]);
  double size = 1;
  while (size < (double)most)
  {
    size *= 2;
  }
  plot->snap = 3 * size; /* values within the plot become multiples of 2^-51 size */
  plot->condition = 1e5;
  plot->no_edges = (job->params.switches & CHI_SCATTERPLOT_NO_EDGES) != 0 ||
    job->params.method == CHI_SCATTERPLOT_PUBLISHED;
  plot->no_one_bin = (job->params.switches & CHI_SCATTERPLOT_NO_ONE_BIN) != 0 ||
    job->params.method == CHI_SCATTERPLOT_PUBLISHED;
  for (int f = 0; f < 2; ++f)
  {
    const double low = r->range[f][0], high = r->range[f][1], bins = (double)job->params.bins[f];
    plot->bins[f] = (int32_t)job->params.bins[f];
    plot->low[f] = low;
    plot->scale[f] = bins / (high - low);
    /* the upper end falls on the last line: rounding twice may miss it by a unit or two */
    double end = high;
    for (int k = 0; k < 8 && (chi_scatter_map(plot, f, &end, 1), end != bins); ++k)
    {
      plot->scale[f] = nextafter(plot->scale[f], end < bins ? INFINITY : 0);
      end = high;
    }
  }
}

/* Whether a piece's values, in units of bins, miss the plot; one on its lower or upper end does
 * not. */
static int misses(const chi_scatter_job* job, const chi_scatter_piece* piece, double box[4])
{
  const int32_t* const n = job->plot.bins;
  for (int f = 0; f < 2; ++f)
  {
    box[2 * f] = piece->low[f];
    box[2 * f + 1] = piece->high[f];
    chi_scatter_map(&job->plot, f, box + 2 * f, 2);
  }
  return box[1] < 0 || box[3] < 0 || box[0] > n[0] || box[2] > n[1];
}

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

/* The published method may make 2^20 times the mass. */
static int unit_bits(const chi_scatter_job* job)
{
  return job->params.method == CHI_SCATTERPLOT_PUBLISHED ? MASS_BITS - 20 : MASS_BITS;
}

/* Integers per unit of mass: of the whole, and of bins by the pieces that touch the plot. */
static chi_status choose_units(chi_scatter_job* job)
{
  double all = 0, touching = 0, is_signed = 0;
  const int skips = !(job->params.switches & CHI_SCATTERPLOT_NO_SKIP);
  for (size_t i = 0; i < job->piece_count; ++i)
  {
    const chi_scatter_piece* const p = job->pieces + i;
    double box[4];
    all += p->size;
    is_signed = p->size > p->mass * (1 + 1e-9) ? 1 : is_signed;
    touching += p->cells > 0 && !(skips && misses(job, p, box)) ? p->size : 0;
  }
  int exponent;
  chi_status status = find_exponent(job, all, &exponent);
  job->total_unit = ldexp(1, MASS_BITS - exponent);
  status = status == CHI_OK ? find_exponent(job, touching, &exponent) : status;
  job->plot.unit = ldexp(1, unit_bits(job) - exponent);
  if (status == CHI_OK &&
    (!isfinite(all) || !isfinite(job->total_unit) || !isfinite(job->plot.unit)))
  {
    status = CHI_ERROR_INVALID_ARGUMENT;
  }
  status = agree(job, status, &is_signed, 1);
  job->is_signed = is_signed > 0;
  return status;
}

/* ---- deposits */

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
  if (misses(job, p, box) && !(job->params.switches & CHI_SCATTERPLOT_NO_SKIP))
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

/* ---- results */

/* Of all threads and processes. */
typedef struct masses
{
  int64_t* bins;
  int64_t mass, deposited; /* within the plot: as summed, and as it went to bins */
  double total, out, singular, bound;
} masses;

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

/* Sums over threads and processes, bins in the first worker's. */
static chi_status gather(chi_scatter_job* job, masses* m)
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
  status = agree(job, status, NULL, 0);
  status = status == CHI_OK ? add_up(job, sums, 6) : status;
  m->mass = sums[0];
  m->deposited = sums[1];
  m->out = (double)sums[2] / job->total_unit;
  m->singular = (double)sums[3] / job->total_unit;
  m->total = (double)sums[4] / job->total_unit;
  m->bound = (double)sums[5] / job->total_unit;
  return status == CHI_OK ? add_up(job, m->bins, count) : status;
}

static void write_result(
  const chi_scatter_job* job, const masses* m, double* density, chi_scatterplot_result* r)
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
    density[i] = mass / area;
  }
  r->total_mass = m->total;
  /* what the published method loses or makes is not told from what is beyond */
  r->mass_out_of_range = job->params.method == CHI_SCATTERPLOT_EXACT ? m->out : m->total - sum;
  r->singular_mass = m->singular;
  r->splat_bound = m->bound;
}

static void count_pieces(const chi_scatter_job* job, chi_scatterplot_result* r)
{
  r->dimension = job->dimension;
  r->pieces = job->piece_count;
  r->is_sorted = job->order != NULL;
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

static chi_status deposit(chi_scatter_job* job, masses* m)
{
  const chi_status status = agree(job, run_stage(job, deposit_pieces), NULL, 0);
  return status == CHI_OK ? gather(job, m) : status;
}

static chi_status compute(
  chi_scatter_job* job, chi_status status, double* density, chi_scatterplot_result* r)
{
  double dimension = status == CHI_OK ? find_dimension(&job->grid) : 0;
  status = agree(job, status, &dimension, 1);
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
  status = choose_range(job, status, r);
  if (status != CHI_OK)
  {
    return status;
  }
  set_plot(job, r);
  status = choose_units(job);
  if (status != CHI_OK)
  {
    return status;
  }
  masses m = { 0 };
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
  count_pieces(job, r);
  write_result(job, &m, density, r);
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
