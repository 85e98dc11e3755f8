/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Images and rectilinear grids in bricks of 8^3 cells, six tetrahedra a cell about the diagonal
 * from its first to its last point, as chi_grid_split cuts them. */

#include "chi_scatterplot_internal.h"

#include <math.h>

typedef struct place
{
  size_t first[3], cells[3]; /* of the grid */
} place;

static place find_brick(const chi_scatter_job* job, size_t index)
{
  const size_t row = index / job->bricks[0];
  const size_t at[3] = { index % job->bricks[0], row % job->bricks[1], row / job->bricks[1] };
  place p;
  for (int a = 0; a < 3; ++a)
  {
    const size_t phase = job->brick_phase[a], begin = at[a] * CHI_SCATTER_BRICK;
    const size_t end = begin + CHI_SCATTER_BRICK - phase;
    p.first[a] = begin > phase ? begin - phase : 0;
    p.cells[a] = (end < job->grid.dimensions[a] ? end : job->grid.dimensions[a]) - p.first[a];
  }
  return p;
}

static size_t point_id(const chi_scatter_job* job, const place* p, size_t y, size_t z)
{
  const size_t* const n = job->grid.view.dimensions;
  return p->first[0] + n[0] * (p->first[1] + y + n[1] * (p->first[2] + z));
}

/* Values of the fields at the brick's points, as they are. */
static void load(const chi_scatter_job* job, const place* p, chi_scatter_brick* b)
{
  const chi_scatterplot_input* const in = &job->input;
  for (int a = 0; a < 3; ++a)
  {
    b->cells[a] = (int32_t)p->cells[a];
  }
  for (size_t z = 0; z <= p->cells[2]; ++z)
  {
    for (size_t y = 0; y <= p->cells[1]; ++y)
    {
      const size_t id = point_id(job, p, y, z), at = z * CHI_SCATTER_LAYER + y * CHI_SCATTER_ROW;
      chi_scatter_load(&in->fields[0], in->components[0], id, p->cells[0] + 1, b->x + at);
      chi_scatter_load(&in->fields[1], in->components[1], id, p->cells[0] + 1, b->y + at);
    }
  }
}

/* Extremes of values at the brick's points; 0 where one is not finite. */
static int find_range(const chi_scatter_brick* b, const double* values, double* low, double* high)
{
  double l = INFINITY, h = -INFINITY, zero = 0;
  for (int z = 0; z <= b->cells[2]; ++z)
  {
    for (int y = 0; y <= b->cells[1]; ++y)
    {
      const double* const row = values + z * CHI_SCATTER_LAYER + y * CHI_SCATTER_ROW;
      for (int x = 0; x <= b->cells[0]; ++x)
      {
        l = row[x] < l ? row[x] : l;
        h = row[x] > h ? row[x] : h;
        zero += 0 * row[x];
      }
    }
  }
  *low = l;
  *high = h;
  return zero == 0;
}

static double width(const chi_array_view* axis, size_t i)
{
  return fabs(chi_scatter_value(axis, 0, i + 1) - chi_scatter_value(axis, 0, i));
}

static double weight_of(const chi_scatter_job* job, size_t cell, const int64_t ids[8])
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
  for (int k = 0; k < 8; ++k)
  {
    sum += chi_scatter_value(&in->weight, in->weight_component, (size_t)ids[k]);
  }
  return sum / 8;
}

/* Mass of each tetrahedron of each cell, NaN of cells that are left out. Counts of them, and ranges
 * of the others' values, where `piece` is not NULL. */
static void find_masses(
  const chi_scatter_job* job, const place* p, chi_scatter_brick* b, chi_scatter_piece* piece)
{
  const chi_grid_view* const v = &job->grid.view;
  const double* const values[2] = { b->x, b->y };
  for (size_t c = 0; c < CHI_SCATTER_CELLS; ++c)
  {
    const size_t x = c % CHI_SCATTER_BRICK, y = c / CHI_SCATTER_BRICK % CHI_SCATTER_BRICK;
    const size_t z = c / CHI_SCATTER_BRICK / CHI_SCATTER_BRICK;
    b->mass[c] = NAN;
    if (x >= p->cells[0] || y >= p->cells[1] || z >= p->cells[2])
    {
      continue;
    }
    const size_t i = p->first[0] + x, j = p->first[1] + y, k = p->first[2] + z;
    const size_t id = i + job->grid.dimensions[0] * (j + job->grid.dimensions[1] * k);
    chi_grid_cell cell;
    const int found = chi_cell_read(&job->grid, id, &cell);
    const double volume = v->kind == CHI_GRID_IMAGE
      ? job->cell_volume
      : width(&v->axes[0], i) * width(&v->axes[1], j) * width(&v->axes[2], k) / 6;
    const double mass = volume * weight_of(job, id, cell.ids);
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY }, zero = 0 * mass;
    for (size_t corner = 0; corner < 8; ++corner)
    {
      const size_t at = (z + (corner >> 2)) * CHI_SCATTER_LAYER +
        (y + (corner >> 1 & 1)) * CHI_SCATTER_ROW + x + (corner & 1);
      for (int f = 0; f < 2; ++f)
      {
        const double value = values[f][at];
        low[f] = value < low[f] ? value : low[f];
        high[f] = value > high[f] ? value : high[f];
        zero += 0 * value;
      }
    }
    const int is_good = found == CHI_CELL_GOOD && zero == 0;
    b->mass[c] = is_good ? mass : NAN;
    if (piece)
    {
      piece->ghosts += found == CHI_CELL_GHOST;
      piece->blanked += found == CHI_CELL_BLANKED;
      piece->skipped += found == CHI_CELL_GOOD && !is_good;
      piece->cells += (uint32_t)is_good;
      for (int f = 0; f < 2 && is_good; ++f)
      {
        piece->low[f] = low[f] < piece->low[f] ? low[f] : piece->low[f];
        piece->high[f] = high[f] > piece->high[f] ? high[f] : piece->high[f];
      }
      piece->mass += is_good ? 6 * mass : 0;
      piece->size += is_good ? 6 * fabs(mass) : 0;
    }
  }
}

void chi_scatter_measure_brick(
  const chi_scatter_job* job, size_t index, chi_scatter_brick* b, chi_scatter_piece* piece)
{
  const place p = find_brick(job, index);
  const chi_grid_view* const v = &job->grid.view;
  load(job, &p, b);
  *piece = (chi_scatter_piece){ .low = { INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY } };
  double low[2], high[2];
  const int finite0 = find_range(b, b->x, &low[0], &high[0]);
  const int finite1 = find_range(b, b->y, &low[1], &high[1]);
  piece->is_clean = finite0 && finite1 && v->kind == CHI_GRID_IMAGE && isfinite(job->cell_volume) &&
    !v->cell_ghosts && !v->point_ghosts && !job->input.weight.data;
  if (!piece->is_clean)
  {
    find_masses(job, &p, b, piece);
  }
  else
  {
    piece->cells = (uint32_t)(p.cells[0] * p.cells[1] * p.cells[2]);
    piece->mass = piece->size = 6.0 * piece->cells * job->cell_volume;
    memcpy(piece->low, low, sizeof low);
    memcpy(piece->high, high, sizeof high);
  }
  piece->simplices = 6 * piece->cells;
}

/* Corners of a tetrahedron by its number 6 cell + kind. */
static void corners_of(const chi_scatter_brick* b, size_t number, double x[4], double y[4])
{
  static const size_t step[3] = { 1, CHI_SCATTER_ROW, CHI_SCATTER_LAYER };
  const size_t cell = number / 6;
  size_t at = cell % CHI_SCATTER_BRICK +
    cell / CHI_SCATTER_BRICK % CHI_SCATTER_BRICK * CHI_SCATTER_ROW +
    cell / CHI_SCATTER_BRICK / CHI_SCATTER_BRICK * CHI_SCATTER_LAYER;
  for (int c = 0; c < 4; ++c)
  {
    x[c] = b->x[at];
    y[c] = b->y[at];
    at += c < 3 ? step[chi_scatter_steps[number % 6][c]] : 0;
  }
}

static size_t list_edges(const chi_scatter_brick* b, chi_scatter_edge* out)
{
  size_t count = 0;
  for (size_t bits = 1; bits < 8; ++bits)
  {
    const size_t offset =
      (bits & 1) + (bits >> 1 & 1) * CHI_SCATTER_ROW + (bits >> 2) * CHI_SCATTER_LAYER;
    for (int z = 0; z <= b->cells[2]; ++z)
    {
      for (int y = 0; y <= b->cells[1]; ++y)
      {
        const size_t row = (size_t)z * CHI_SCATTER_LAYER + (size_t)y * CHI_SCATTER_ROW;
        for (size_t at = row; at <= row + (size_t)b->cells[0]; ++at)
        {
          out[count] =
            (chi_scatter_edge){ (uint32_t)at, (uint32_t)(at + offset), b->weight[bits][at] };
          count += b->weight[bits][at] != 0;
        }
      }
    }
  }
  return count;
}

void chi_scatter_deposit_brick(chi_scatter_job* job, size_t index, chi_scatter_worker* w)
{
  const chi_scatter_piece* const piece = job->pieces + index;
  const place p = find_brick(job, index);
  chi_scatter_brick* const b = w->brick;
  double box[4] = { piece->low[0], piece->high[0], piece->low[1], piece->high[1] };
  load(job, &p, b);
  double most = job->cell_volume;
  if (piece->is_clean)
  {
    for (size_t c = 0; c < CHI_SCATTER_CELLS; ++c)
    {
      b->mass[c] = job->cell_volume;
    }
  }
  else
  {
    find_masses(job, &p, b, NULL);
    most = 0;
    for (size_t c = 0; c < CHI_SCATTER_CELLS; ++c)
    {
      most = fabs(b->mass[c]) > most ? fabs(b->mass[c]) : most;
    }
  }
  chi_scatter_map(&job->plot, 0, b->x, CHI_SCATTER_POINTS);
  chi_scatter_map(&job->plot, 1, b->y, CHI_SCATTER_POINTS);
  chi_scatter_map(&job->plot, 0, box, 2);
  chi_scatter_map(&job->plot, 1, box + 2, 2);

  if (!(job->params.trilinear_tolerance > 0) || !chi_scatter_refine_brick(job, w, b))
  {
    chi_scatter_deposit_cells(job, w, b, box, most);
  }
}

void chi_scatter_deposit_cells(chi_scatter_job* job, chi_scatter_worker* w, chi_scatter_brick* b,
  const double box[4], double most)
{
  double x[4], y[4];
  if (chi_scatter_splats(job))
  {
    chi_scatter_splat_brick(job, w, b);
  }
  job->kernels->brick(&job->plot, b, chi_scatter_light(most));
  for (size_t i = 0; i < b->one_bin_count; ++i)
  {
    corners_of(b, b->one_bin[i], x, y);
    chi_scatter_deposit_at(job, w, x[0], y[0], b->mass[b->one_bin[i] / 6]);
  }
  for (size_t i = 0; i < b->sections_count; ++i)
  {
    corners_of(b, b->sections[i], x, y);
    chi_scatter_deposit_simplex(job, w, 4, x, y, b->mass[b->sections[i] / 6]);
  }
  w->one_bin += b->one_bin_count;
  w->edges += b->edge_cells;
  if (b->edge_cells > 0)
  {
    const size_t count = list_edges(b, w->edge);
    chi_scatter_deposit_edges(
      job, w, b->x, b->y, count, b->edge_mass, box, chi_scatter_noise(most));
  }
}
