/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Derivatives on unstructured grids: at each point the quadratic polynomial that fits its
 * neighbours' values best. */

#include "chi_derived_fit.h"
#include "chi_derived_internal.h"

#include <math.h>

enum
{
  POINTS_A_CHUNK = 1024,
  POINTS_A_POLL = 64,
  CELLS_A_POLL = 1 << 16,
  TABLE = 1024, /* places that hold them by id; a power of two */
  SPARE = 3     /* neighbours beyond the unknowns that a fit should have */
};

typedef struct point_job
{
  const chi_derived_job* job;
  const chi_grid* grid;
  const chi_derived_kernels* kernels;
  chi_derived_source source;
  size_t* first;   /* [points + 1] of its cells */
  uint32_t* cells; /* [first[points]] */
  size_t cell_room;
  double threshold, unit[4][2];
  chi_derived_counts* counts; /* [chunks] */
} point_job;

/*------------------------------------------------------------------------------------------------*/
static int is_hidden(const chi_grid* grid, size_t cell)
{
  return grid->view.cell_ghosts && grid->view.cell_ghosts[cell] & CHI_GRID_HIDDEN_CELL;
}

/* Every id of every cell, checked; what they add up to stands at first[id + 1]. */
static chi_status count_cells(point_job* p)
{
  const chi_grid_view* const v = &p->grid->view;
  for (size_t c = 0; c < v->cell_count; ++c)
  {
    if (c % CELLS_A_POLL == 0 && chi_is_cancelled(p->job->exec))
    {
      return CHI_ERROR_CANCELLED;
    }
    const int64_t begin = v->offsets[c], end = v->offsets[c + 1];
    if (begin < 0 || end < begin || (uint64_t)end > v->connectivity_count)
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    const size_t more = !is_hidden(p->grid, c);
    for (int64_t k = begin; k < end; ++k)
    {
      if ((uint64_t)v->connectivity[k] >= p->grid->points) /* negative ones too */
      {
        return CHI_ERROR_INVALID_ARGUMENT;
      }
      p->first[v->connectivity[k] + 1] += more;
    }
  }
  return CHI_OK;
}

/* The cells of each point, in order. */
static chi_status list_cells(point_job* p)
{
  const chi_grid_view* const v = &p->grid->view;
  memset(p->first, 0, (p->grid->points + 1) * sizeof *p->first);
  const chi_status status = count_cells(p);
  if (status != CHI_OK)
  {
    return status;
  }
  size_t sum = 0; /* where each begins stands one place ahead, and moves to its end below */
  for (size_t i = 1; i <= p->grid->points; ++i)
  {
    const size_t count = p->first[i];
    p->first[i] = sum;
    sum += count;
  }
  p->cell_room = sum + 1;
  p->cells = (uint32_t*)chi_alloc(p->job->exec, p->cell_room, sizeof *p->cells);
  if (!p->cells)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (size_t c = 0; c < v->cell_count; ++c)
  {
    if (c % CELLS_A_POLL == 0 && chi_is_cancelled(p->job->exec))
    {
      return CHI_ERROR_CANCELLED;
    }
    for (int64_t k = v->offsets[c]; k < v->offsets[c + 1] && !is_hidden(p->grid, c); ++k)
    {
      p->cells[p->first[v->connectivity[k] + 1]++] = (uint32_t)c;
    }
  }
  return CHI_OK;
}

/*------------------------------------------------------------------------------------------------*/
/* A point and those around it, in the order in which they are found. */
typedef struct ring
{
  size_t count, dimension; /* the largest of the cells about the point */
  uint32_t id[CHI_FIT_MOST + 1];
  uint32_t table[TABLE]; /* places in id, plus 1 */
} ring;

static void add(ring* r, uint32_t id)
{
  size_t at = (id * 2654435769u) >> 22 & (TABLE - 1);
  while (r->table[at])
  {
    if (r->id[r->table[at] - 1] == id)
    {
      return;
    }
    at = (at + 1) & (TABLE - 1);
  }
  if (r->count <= CHI_FIT_MOST)
  {
    r->id[r->count++] = id;
    r->table[at] = (uint32_t)r->count;
  }
}

static void add_cells(const point_job* p, ring* r, uint32_t id)
{
  const chi_grid_view* const v = &p->grid->view;
  for (size_t k = p->first[id]; k < p->first[id + 1]; ++k)
  {
    const size_t cell = p->cells[k];
    for (int64_t i = v->offsets[cell]; i < v->offsets[cell + 1]; ++i)
    {
      add(r, (uint32_t)v->connectivity[i]);
    }
  }
}

/* Types as VTK numbers them: vertices and lines, faces, the others. */
static size_t dimension_of(int type)
{
  static const uint8_t lines[] = { 1, 2, 3, 4, 21, 35 };
  if (!chi_cell_type_is_flat(type))
  {
    return 3;
  }
  return memchr(lines, type, sizeof lines) ? 1 : 2;
}

static void find_ring(const point_job* p, ring* r, uint32_t id)
{
  const chi_grid_view* const v = &p->grid->view;
  memset(r->table, 0, sizeof r->table);
  r->count = r->dimension = 0;
  add(r, id);
  add_cells(p, r, id);
  for (size_t k = p->first[id]; k < p->first[id + 1]; ++k)
  {
    const size_t dimension = dimension_of(v->cell_types[p->cells[k]]);
    r->dimension = dimension > r->dimension ? dimension : r->dimension;
  }
}

static void widen_ring(const point_job* p, ring* r)
{
  const size_t count = r->count;
  for (size_t k = 1; k < count; ++k)
  {
    add_cells(p, r, r->id[k]);
  }
}

/*------------------------------------------------------------------------------------------------*/
/* Value in the job's units; NaN where it is not finite. */
static double value_at(const point_job* p, size_t id)
{
  double value;
  p->kernels->load(&p->source, id, 1, &value);
  return value;
}

static void collect(const point_job* p, const ring* r, const double middle[3], chi_fit* f)
{
  const double value = value_at(p, r->id[0]);
  double sum = 0;
  f->count = 0;
  for (size_t k = 1; k < r->count; ++k)
  {
    double x[3], square = 0;
    chi_grid_point(p->grid, r->id[k], x);
    for (int a = 0; a < 3; ++a)
    {
      x[a] = (x[a] - middle[a]) / p->job->length_unit;
      square += x[a] * x[a];
    }
    if (square > 0 && isfinite(square)) /* neither the same place nor nowhere */
    {
      memcpy(f->x[f->count], x, sizeof x);
      f->weight[f->count] = sqrt(square);
      f->column[CHI_FIT_UNKNOWNS][f->count] = value_at(p, r->id[k]) - value;
      sum += square;
      ++f->count;
    }
  }
  f->length = f->count ? sqrt(sum / (double)f->count) : 1;
  for (size_t k = 0; k < f->count; ++k)
  {
    f->weight[k] = f->length / f->weight[k];
    f->column[CHI_FIT_UNKNOWNS][k] *= f->weight[k];
    for (int a = 0; a < 3; ++a)
    {
      f->x[k][a] /= f->length;
    }
  }
}

static chi_fit_result derive(const point_job* p, uint32_t id, ring* r, chi_fit* f)
{
  double middle[3];
  chi_fit_result d = { { 0 }, { 0 }, 0, 0 };
  chi_grid_point(p->grid, id, middle);
  if (!isfinite(middle[0] + middle[1] + middle[2]))
  {
    return d;
  }
  find_ring(p, r, id);
  const size_t unknowns = r->dimension * (r->dimension + 3) / 2;
  const int is_wide = r->count > unknowns + SPARE;
  if (is_wide)
  {
    collect(p, r, middle, f);
    d = chi_fit_solve(f, r->dimension);
  }
  if (!d.is_complete && r->count > 1)
  {
    widen_ring(p, r);
    collect(p, r, middle, f);
    d = chi_fit_solve(f, r->dimension);
  }
  return d;
}

/*------------------------------------------------------------------------------------------------*/
static void put(
  const chi_derived_job* job, int which, size_t id, double value, const double unit[2])
{
  void* const array = chi_derived_array(job, which);
  const double scaled = value * unit[0] * unit[1];
  if (array && job->arrays.type == CHI_F32)
  {
    ((float*)array)[id] = (float)scaled;
  }
  else if (array)
  {
    ((double*)array)[id] = scaled;
  }
}

/* Documentation/theory/derived.md, equations (1) to (4). */
static void write_point(
  const point_job* p, size_t id, const chi_fit_result* d, chi_derived_counts* counts)
{
  const double *const g = d->first, *const h = d->second;
  double result[4] = { NAN, NAN, NAN, NAN };
  if (d->rank > 0)
  {
    const double square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    const double length = sqrt(square), trace = h[0] + h[1] + h[2];
    const double form = g[0] * g[0] * h[0] + g[1] * g[1] * h[1] + g[2] * g[2] * h[2] +
      2 * (g[0] * g[1] * h[3] + g[0] * g[2] * h[4] + g[1] * g[2] * h[5]);
    const int is_flat = length <= p->threshold;
    result[0] = length;
    result[1] = is_flat ? 0 : form / square;
    result[2] = trace;
    result[3] = is_flat ? 0 : (trace - form / square) / (2 * length);
    counts->flat_points += (size_t)is_flat;
    counts->non_finite_points += (size_t)(isnan(length + trace + form) != 0);
    counts->linear_points += (size_t)!d->is_complete;
  }
  else
  {
    ++counts->undetermined_points;
  }
  for (int k = 0; k < 4; ++k)
  {
    put(p->job, k, id, result[k], p->unit[k]);
  }
}

static void derive_points(void* data, size_t begin, size_t end)
{
  const point_job* const p = (const point_job*)data;
  ring r;
  chi_fit f;
  for (size_t c = begin; c < end; ++c)
  {
    chi_derived_counts counts = { 0 };
    const size_t last = chi_grid_chunk_end(c * POINTS_A_CHUNK, POINTS_A_CHUNK, p->grid->points);
    for (size_t i = c * POINTS_A_CHUNK; i < last; ++i)
    {
      if (i % POINTS_A_POLL == 0 && chi_is_cancelled(p->job->exec))
      {
        return;
      }
      const chi_fit_result d = derive(p, (uint32_t)i, &r, &f);
      write_point(p, i, &d, &counts);
    }
    p->counts[c] = counts;
  }
}

static chi_status derive_all(point_job* p, size_t chunks)
{
  const chi_status status = chi_for(p->job->exec, chunks, derive_points, p);
  chi_derived_counts* const sum = p->job->counts;
  for (size_t c = 0; c < chunks && status == CHI_OK; ++c)
  {
    sum->flat_points += p->counts[c].flat_points;
    sum->non_finite_points += p->counts[c].non_finite_points;
    sum->undetermined_points += p->counts[c].undetermined_points;
    sum->linear_points += p->counts[c].linear_points;
  }
  return status;
}

chi_status chi_derived_unstructured(chi_derived_job* job)
{
  point_job p = { .job = job,
    .grid = &job->grid,
    .kernels = chi_derived_get_kernels(1),
    .source = { .values = job->values,
      .component = job->params.component,
      .ghosts = job->grid.view.point_ghosts,
      .factor = 1 / job->value_unit },
    .threshold = chi_derived_threshold(job) };
  for (int k = 0; k < 4; ++k)
  {
    chi_derived_unit(job, k, p.unit[k]);
  }
  const size_t points = job->grid.points, chunks = chi_grid_chunks(points, POINTS_A_CHUNK);
  p.first = (size_t*)chi_alloc(job->exec, points + 1, sizeof *p.first);
  p.counts = (chi_derived_counts*)chi_alloc(job->exec, chunks, sizeof *p.counts);
  chi_status status = p.first && p.counts ? list_cells(&p) : CHI_ERROR_OUT_OF_MEMORY;
  status = status == CHI_OK ? derive_all(&p, chunks) : status;
  if (p.cells)
  {
    chi_free(job->exec, p.cells, p.cell_room, sizeof *p.cells);
  }
  if (p.counts)
  {
    chi_free(job->exec, p.counts, chunks, sizeof *p.counts);
  }
  if (p.first)
  {
    chi_free(job->exec, p.first, points + 1, sizeof *p.first);
  }
  return status;
}
