/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Lists of cells of any type in runs: their simplices go into a block. Fields of cells have no
 * simplices: each cell is one deposit. */

#include "chi_scatterplot_internal.h"

#include <math.h>

enum
{
  VTK_TETRA_TYPE = 10
};

double chi_scatter_weight(const chi_scatter_job* job, size_t cell, const int64_t* ids, size_t count)
{
  const chi_scatterplot_input* const in = &job->input;
  if (!in->weight.data)
  {
    return 1;
  }
  if (in->weight_association == CHI_SCATTERPLOT_CELLS)
  {
    return chi_scatter_value(&in->weight, in->weight_component, cell);
  }
  double sum = 0;
  for (size_t k = 0; k < count; ++k)
  {
    sum += chi_scatter_value(&in->weight, in->weight_component, (size_t)ids[k]);
  }
  return sum / (double)count;
}

/* A tetrahedron that is a cell itself. Its mass is kept at `mass` when it is first looked at, and
 * is NaN where its points are not finite. */
static int add_tetrahedron(
  chi_scatter_job* job, chi_scatter_worker* w, size_t index, double* mass, int is_first)
{
  const chi_grid* const grid = &job->grid;
  const chi_grid_view* const v = &grid->view;
  chi_scatter_block* const b = &w->block;
  const int64_t begin = v->offsets[index], end = v->offsets[index + 1];
  if (begin < 0 || end != begin + 4 || (uint64_t)end > v->connectivity_count)
  {
    return CHI_CELL_BROKEN;
  }
  const int64_t* const ids = v->connectivity + begin;
  double x[4][3], reach = 0;
  for (size_t c = 0; c < 4; ++c)
  {
    if ((uint64_t)ids[c] >= grid->points)
    {
      return CHI_CELL_BROKEN;
    }
    b->ids[c * b->capacity + b->count] = (uint32_t)ids[c];
  }
  for (size_t c = 0; c < 4 && is_first; ++c)
  {
    chi_grid_point(grid, (size_t)ids[c], x[c]);
    for (int a = 0; a < 3; ++a)
    {
      const double far = fabs(x[c][a]);
      reach = far <= reach ? reach : far; /* NaN stays */
    }
  }
  if (is_first)
  {
    const double volume =
      reach <= CHI_SCATTER_LARGEST ? chi_scatter_volume6(x[0], x[1], x[2], x[3]) / 6 : NAN;
    *mass = volume * chi_scatter_weight(job, index, ids, 4);
  }
  if (*mass != *mass)
  {
    return CHI_CELL_NON_FINITE;
  }
  b->mass[b->count] = *mass;
  b->cell[b->count++] = (uint32_t)index;
  return CHI_CELL_GOOD;
}

/* All tetrahedra of a cell. */
static int add_cell(chi_scatter_job* job, chi_scatter_worker* w, size_t index, int is_first)
{
  const chi_grid* const grid = &job->grid;
  chi_scatter_block* const b = &w->block;
  chi_grid_cell cell;
  int found = chi_cell_read(grid, index, &cell);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  if (!chi_cell_locate(&cell))
  {
    return CHI_CELL_NON_FINITE;
  }
  chi_cell_split split;
  chi_cell_choose(&cell, &split);
  if (split.tetrahedra > b->capacity - b->count)
  {
    return CHI_CELL_UNSUPPORTED; /* the caller has made room: this cannot be */
  }
  const size_t center_id = grid->points + b->centers, first = b->count;
  if (split.way == CHI_SPLIT_CENTER)
  {
    chi_scatter_center* const center = b->center + b->centers++;
    chi_cell_find_center(&cell);
    memcpy(center->point, cell.center, sizeof center->point);
    for (int f = 0; f < 2; ++f)
    {
      double sum = 0;
      for (size_t k = 0; k < cell.count; ++k)
      {
        sum +=
          chi_scatter_value(&job->input.fields[f], job->input.components[f], (size_t)cell.ids[k]);
      }
      center->value[f] = sum / (double)cell.count;
    }
  }
  /* there are no edges yet: room for what the cell writes */
  uint32_t(*const vertices)[4] = (uint32_t(*)[4])(void*)(b->ends + 2 * b->count);
  const size_t count = chi_cell_write(&cell, split.way, (uint32_t)center_id, vertices);
  const double weight = chi_scatter_weight(job, index, cell.ids, cell.count);
  for (size_t t = 0; t < count; ++t)
  {
    double x[4][3];
    for (size_t c = 0; c < 4; ++c)
    {
      const uint32_t id = vertices[t][c];
      b->ids[c * b->capacity + b->count] = id;
      if (id == center_id)
      {
        memcpy(x[c], cell.center, sizeof x[c]);
      }
      else
      {
        chi_grid_point(grid, id, x[c]);
      }
    }
    b->mass[b->count] = chi_scatter_volume6(x[0], x[1], x[2], x[3]) / 6 * weight;
    b->cell[b->count++] = (uint32_t)index;
  }
  if (job->params.trilinear_tolerance > 0 && b->count > first)
  {
    chi_scatter_refine_cell(job, w, &cell, split.way, first, weight, is_first);
  }
  return CHI_CELL_GOOD;
}

/* ---- fields of cells */

static int volume_of(const chi_scatter_job* job, size_t index, double* volume, double* weight)
{
  if (job->dimension == 2)
  {
    return chi_scatter_measure_polygon(job, index, volume, weight);
  }
  chi_grid_cell cell;
  const int found = chi_cell_read(&job->grid, index, &cell);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  *weight = chi_scatter_weight(job, index, cell.ids, cell.count);
  if (job->grid.view.kind == CHI_GRID_IMAGE)
  {
    *volume = 6 * job->cell_volume;
    return isfinite(*volume) ? CHI_CELL_GOOD : CHI_CELL_NON_FINITE;
  }
  if (!chi_cell_locate(&cell))
  {
    return CHI_CELL_NON_FINITE;
  }
  chi_cell_split split;
  chi_cell_choose(&cell, &split);
  *volume = split.volume;
  return CHI_CELL_GOOD;
}

/* One cell with constant fields. */
static int visit_constant(
  chi_scatter_job* job, chi_scatter_worker* w, size_t index, chi_scatter_piece* piece)
{
  const chi_scatterplot_input* const in = &job->input;
  double volume = 0, weight = 1;
  const int found = volume_of(job, index, &volume, &weight);
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  const double mass = volume * weight;
  double value[2];
  for (int f = 0; f < 2; ++f)
  {
    value[f] = chi_scatter_value(&in->fields[f], in->components[f], index);
  }
  if (!isfinite(mass) || !isfinite(value[0]) || !isfinite(value[1]))
  {
    return CHI_CELL_NON_FINITE;
  }
  if (!piece)
  {
    chi_scatter_map(&job->plot, 0, value, 1);
    chi_scatter_map(&job->plot, 1, value + 1, 1);
    w->sink.singular += chi_scatter_deposit_at(job, w, value[0], value[1], mass) ? mass : 0;
    ++w->one_bin;
    return found;
  }
  ++piece->cells;
  ++piece->simplices;
  piece->mass += mass;
  piece->size += fabs(mass);
  for (int f = 0; f < 2; ++f)
  {
    piece->low[f] = value[f] < piece->low[f] ? value[f] : piece->low[f];
    piece->high[f] = value[f] > piece->high[f] ? value[f] : piece->high[f];
  }
  return found;
}

/* ---- runs */

/* Simplices that a cell may add, at most. */
static size_t most_simplices(const chi_scatter_job* job, size_t index)
{
  const chi_grid_view* const v = &job->grid.view;
  if (v->kind != CHI_GRID_UNSTRUCTURED)
  {
    return 12;
  }
  if (v->cell_types[index] == VTK_TETRA_TYPE)
  {
    return 1;
  }
  chi_grid_cell cell;
  chi_cell_split split;
  const int found = chi_cell_read(&job->grid, index, &cell);
  if (found == CHI_CELL_FLAT_TYPE)
  {
    return cell.count + 8;
  }
  if (found != CHI_CELL_GOOD || !chi_cell_locate(&cell))
  {
    return 0;
  }
  chi_cell_choose(&cell, &split);
  return split.tetrahedra + split.collapsed;
}

static void count(chi_scatter_job* job, chi_scatter_piece* piece, int found)
{
  if (found == CHI_CELL_BROKEN)
  {
    job->failed = CHI_ERROR_INVALID_ARGUMENT;
  }
  if (piece)
  {
    piece->ghosts += found == CHI_CELL_GHOST;
    piece->blanked += found == CHI_CELL_BLANKED;
    piece->lower_dimensional += found == CHI_CELL_FLAT_TYPE;
    piece->unsupported += found == CHI_CELL_UNSUPPORTED;
    piece->skipped += found == CHI_CELL_NON_FINITE;
  }
}

/* Fetch what is needed of cells further on in an order that is not memory's. */
static void fetch_ahead(const chi_scatter_job* job, size_t i, size_t last)
{
  enum
  {
    FAR = 64,
    NEAR = 12
  };
  const chi_grid_view* const v = &job->grid.view;
  if (i + FAR < last)
  {
    const size_t cell = job->order[i + FAR];
    __builtin_prefetch(v->offsets + cell);
    __builtin_prefetch(v->cell_types + cell);
    const int64_t at = v->offsets[job->order[i + NEAR]];
    if (at >= 0 && (uint64_t)at < v->connectivity_count)
    {
      __builtin_prefetch(v->connectivity + at);
    }
  }
}

void chi_scatter_find_run(const chi_scatter_job* job, size_t run, size_t* first, size_t* last)
{
  const size_t begin = run * CHI_SCATTER_RUN, end = begin + CHI_SCATTER_RUN - job->run_phase;
  *first = begin > job->run_phase ? begin - job->run_phase : 0;
  *last = end < job->grid.cells ? end : job->grid.cells;
}

void chi_scatter_visit_run(
  chi_scatter_job* job, size_t run, chi_scatter_worker* w, chi_scatter_piece* piece)
{
  const chi_grid_view* const v = &job->grid.view;
  size_t first, last;
  if (job->is_uniform && !job->order)
  {
    chi_scatter_visit_tetrahedra(job, run, w, piece);
    return;
  }
  chi_scatter_find_run(job, run, &first, &last);
  const int are_cells = job->input.association == CHI_SCATTERPLOT_CELLS;
  const int is_plain = job->masses && !v->cell_ghosts && !v->point_ghosts;
  if (piece)
  {
    *piece = (chi_scatter_piece){ .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY } };
  }
  for (size_t i = first; i < last && !job->failed; ++i)
  {
    const size_t index = job->order ? job->order[i] : i;
    if (job->order)
    {
      fetch_ahead(job, i, last);
    }
    if (are_cells)
    {
      count(job, piece, visit_constant(job, w, index, piece));
      continue;
    }
    const int is_tetrahedron = is_plain && v->cell_types[index] == VTK_TETRA_TYPE;
    const size_t most = is_tetrahedron ? 1 : most_simplices(job, index);
    if (most > w->block.capacity - w->block.count)
    {
      chi_scatter_finish_block(job, w, run, piece);
      if (!chi_scatter_reserve_block(job, w, most))
      {
        return;
      }
    }
    count(job, piece,
      is_tetrahedron          ? add_tetrahedron(job, w, index, job->masses + i, piece != NULL)
        : job->dimension == 2 ? chi_scatter_add_polygon(job, w, index)
                              : add_cell(job, w, index, piece != NULL));
  }
  chi_scatter_finish_block(job, w, run, piece);
}
