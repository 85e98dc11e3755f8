/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What all pieces of a plot have in common: dimension and pieces of the mesh, range, and the
 * quantum of its sums. */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  TETRAHEDRON = 10, /* VTK's number */
  TYPES_A_CHUNK = 65536,
  MASS_BITS = CHI_SCATTER_MASS_BITS
};

/* ---- all processes together */

chi_status chi_scatter_agree(
  const chi_scatter_job* job, chi_status status, double* values, size_t count)
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

chi_status chi_scatter_add_up(const chi_scatter_job* job, int64_t* values, size_t count)
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
  chi_status status = chi_scatter_agree(job, CHI_OK, &largest, 1);
  if (status != CHI_OK || !(largest > 0))
  {
    *exponent = 0;
    return status;
  }
  frexp(largest, exponent);
  int64_t sum = (int64_t)llrint(ldexp(size, 40 - *exponent));
  status = chi_scatter_add_up(job, &sum, 1);
  int more;
  frexp((double)sum * (1 + 1e-9) + 1, &more);
  *exponent += more - 40;
  return status;
}

/* ---- the mesh */

typedef struct type_job
{
  const chi_grid_view* view;
  atomic_uchar is_there[256];
  atomic_int is_other; /* than cell i the tetrahedron of the ids 4 i ... 4 i + 3 */
} type_job;

static void look_at_types(void* data, size_t begin, size_t end)
{
  type_job* const t = (type_job*)data;
  const chi_grid_view* const v = t->view;
  for (size_t c = begin; c < end; ++c)
  {
    const size_t first = c * TYPES_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, TYPES_A_CHUNK, v->cell_count);
    const uint8_t type = v->cell_types[first];
    uint8_t differs = 0;
    for (size_t i = first; i < last; ++i)
    {
      differs |= v->cell_types[i] ^ type;
    }
    uint8_t is_there[256] = { 0 };
    is_there[type] = 1;
    for (size_t i = first; i < last && differs; ++i)
    {
      is_there[v->cell_types[i]] = 1;
    }
    for (int k = 0; k < 256; ++k)
    {
      if (is_there[k])
      {
        t->is_there[k] = 1;
      }
    }
    uint64_t is_other = differs || type != TETRAHEDRON;
    for (size_t i = first; i <= last && !is_other; ++i)
    {
      is_other |= (uint64_t)v->offsets[i] ^ 4 * (uint64_t)i;
    }
    if (is_other)
    {
      t->is_other = 1;
    }
  }
}

chi_status chi_scatter_look_at_types(chi_scatter_job* job)
{
  const chi_grid_view* const v = &job->grid.view;
  job->dimension = 0;
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    int axes = 0;
    for (int a = 0; a < 3 && job->grid.cells > 0; ++a)
    {
      axes += v->dimensions[a] > 1;
    }
    job->dimension = axes < 2 ? 0 : axes;
    return CHI_OK;
  }
  type_job t;
  memset(&t, 0, sizeof t);
  t.view = v;
  t.is_other = v->connectivity_count / 4 < v->cell_count;
  const size_t chunks = chi_grid_chunks(v->cell_count, TYPES_A_CHUNK);
  const chi_status status = chunks ? chi_for(job->exec, chunks, look_at_types, &t) : CHI_OK;
  for (int type = 0; type < 256; ++type)
  {
    if (t.is_there[type])
    {
      const int d = chi_cell_type_of(type) || type == 42 ? 3 : chi_polygon_has_type(type) ? 2 : 0;
      job->dimension = d > job->dimension ? d : job->dimension;
    }
  }
  job->is_uniform = !t.is_other && !v->cell_ghosts && !v->point_ghosts &&
    job->input.association == CHI_SCATTERPLOT_POINTS;
  return status;
}

static double determinant3(const double* m)
{
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
    m[2] * (m[4] * m[9] - m[5] * m[8]);
}

void chi_scatter_plan_pieces(chi_scatter_job* job)
{
  const chi_grid* const grid = &job->grid;
  const int kind = grid->view.kind;
  job->is_lattice = job->dimension == 3 &&
    (kind == CHI_GRID_IMAGE || kind == CHI_GRID_RECTILINEAR) &&
    job->input.association == CHI_SCATTERPLOT_POINTS;
  job->cell_volume = kind == CHI_GRID_IMAGE ? fabs(determinant3(grid->view.index_to_world)) / 6 : 0;
  /* the dimension is that of all processes, and this one's part may be empty */
  job->piece_count = job->dimension > 0 && grid->cells > 0;
  job->is_uniform = job->is_uniform && job->dimension == 3;
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

/* ---- range and quantum */

chi_status chi_scatter_choose_range(
  chi_scatter_job* job, chi_status status, chi_scatterplot_result* r)
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
  status = chi_scatter_agree(job, status, extremes, 4);
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

void chi_scatter_set_plot(chi_scatter_job* job, const chi_scatterplot_result* r)
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

int chi_scatter_misses(const chi_scatter_job* job, const chi_scatter_piece* piece, double box[4])
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

/* The published method may make 2^20 times the mass. */
static int unit_bits(const chi_scatter_job* job)
{
  return job->params.method == CHI_SCATTERPLOT_PUBLISHED ? MASS_BITS - 20 : MASS_BITS;
}

chi_status chi_scatter_choose_units(chi_scatter_job* job)
{
  double all = 0, touching = 0, is_signed = 0;
  const int skips = !(job->params.switches & CHI_SCATTERPLOT_NO_SKIP);
  for (size_t i = 0; i < job->piece_count; ++i)
  {
    const chi_scatter_piece* const p = job->pieces + i;
    double box[4];
    all += p->size;
    is_signed = p->size > p->mass * (1 + 1e-9) ? 1 : is_signed;
    touching += p->cells > 0 && !(skips && chi_scatter_misses(job, p, box)) ? p->size : 0;
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
  status = chi_scatter_agree(job, status, &is_signed, 1);
  job->is_signed = is_signed > 0;
  return status;
}
