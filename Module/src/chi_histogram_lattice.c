/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Images and rectilinear grids in bricks of 8^3 cells, row by row: six tetrahedra a cell about the
 * diagonal from its first to its last point, as chi_grid_split cuts them. Their edges go along the
 * axes one after another, so that differences along these are the gradient.
 */

#include "chi_histogram_internal.h"

#include <math.h>

enum
{
  CELLS = CHI_HISTOGRAM_BRICK,
  ROW = CELLS + 1,
  LAYER = ROW * ROW
};

typedef struct brick
{
  const chi_histogram_plan* plan;
  size_t first[3], cells[3];
  double value[ROW * LAYER];
  double width[3][CELLS]; /* of a rectilinear grid's cells */
  int is_clean;           /* no cell has to be looked at */
} brick;

/* The order of the axes along which each of a cell's tetrahedra goes. */
static const uint8_t paths[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 },
  { 2, 0, 1 }, { 2, 1, 0 } };

int chi_histogram_plan_lattice(chi_histogram_plan* plan)
{
  const chi_grid_view* const v = &plan->grid.view;
  if (plan->dimension != 3 || plan->association != CHI_HISTOGRAM_POINTS ||
    (v->kind != CHI_GRID_IMAGE && v->kind != CHI_GRID_RECTILINEAR))
  {
    return 0;
  }
  const double* const m = v->index_to_world;
  double largest = 0;
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3, c = (a + 2) % 3; /* (cofactor of row r, column a) */
    for (int r = 0; r < 3 && v->kind == CHI_GRID_IMAGE; ++r)
    {
      const int s = (r + 1) % 3, t = (r + 2) % 3;
      plan->cofactor[r][a] = m[4 * s + b] * m[4 * t + c] - m[4 * t + b] * m[4 * s + c];
      largest = fmax(largest, fabs(plan->cofactor[r][a]));
    }
    plan->bricks[a] = chi_grid_chunks(plan->grid.dimensions[a], CELLS);
  }
  plan->volume =
    fabs(m[0] * plan->cofactor[0][0] + m[4] * plan->cofactor[1][0] + m[8] * plan->cofactor[2][0]) /
    6;
  plan->cofactor_size = largest;
  for (int k = 0; k < 9 && largest > 0; ++k)
  {
    plan->cofactor[k / 3][k % 3] /= largest;
  }
  if (v->kind == CHI_GRID_RECTILINEAR)
  {
    return 1;
  }
  double x[3];
  int is_tame = 1; /* a lattice is finite where the corners of its bounds are */
  for (size_t k = 0; k < 8; ++k)
  {
    const size_t* const n = v->dimensions;
    const size_t id =
      (k & 1 ? n[0] - 1 : 0) + n[0] * ((k & 2 ? n[1] - 1 : 0) + n[1] * (k & 4 ? n[2] - 1 : 0));
    chi_grid_implicit_point(&plan->grid, id, x);
    for (int a = 0; a < 3; ++a)
    {
      is_tame &= fabs(x[a]) <= CHI_HISTOGRAM_LARGEST;
    }
  }
  return is_tame;
}

static void load_widths(const chi_histogram_plan* plan, brick* b)
{
  for (int a = 0; a < 3; ++a)
  {
    const chi_array_view* const axis = &plan->grid.view.axes[a];
    for (size_t i = 0; i < b->cells[a]; ++i)
    {
      const char* const at = (const char*)axis->data + (b->first[a] + i) * axis->stride;
      const double low = chi_number_at(at, axis->type);
      const double high = chi_number_at(at + axis->stride, axis->type);
      const int is_tame = fabs(low) <= CHI_HISTOGRAM_LARGEST && fabs(high) <= CHI_HISTOGRAM_LARGEST;
      b->width[a][i] = is_tame ? fabs(high - low) : NAN;
      b->is_clean &= is_tame;
    }
  }
}

static void open_brick(const chi_histogram_plan* plan, size_t index, brick* b)
{
  const chi_grid_view* const v = &plan->grid.view;
  const size_t row = index / plan->bricks[0];
  const size_t at[3] = { index % plan->bricks[0], row % plan->bricks[1], row / plan->bricks[1] };
  b->plan = plan;
  b->is_clean = !v->cell_ghosts && !v->point_ghosts;
  for (int a = 0; a < 3; ++a)
  {
    b->first[a] = at[a] * CELLS;
    b->cells[a] = chi_grid_chunk_end(b->first[a], CELLS, plan->grid.dimensions[a]) - b->first[a];
  }
  for (size_t z = 0; z <= b->cells[2]; ++z)
  {
    for (size_t y = 0; y <= b->cells[1]; ++y)
    {
      const size_t first =
        b->first[0] + v->dimensions[0] * (b->first[1] + y + v->dimensions[1] * (b->first[2] + z));
      double* const out = b->value + z * LAYER + y * ROW;
      chi_scatter_load(&plan->field, plan->component, first, b->cells[0] + 1, out);
      for (size_t x = 0; x <= b->cells[0]; ++x)
      {
        b->is_clean &= fabs(out[x]) <= CHI_HISTOGRAM_LARGEST;
      }
    }
  }
  if (v->kind == CHI_GRID_RECTILINEAR)
  {
    load_widths(plan, b);
  }
}

/* One of the six tetrahedra of each cell of a row, from `at` in the block. */
static void fill_path(const brick* b, size_t y, size_t z, const uint8_t path[3],
  const double (*normal)[3][CELLS], const double* volume, double area_unit,
  chi_histogram_block* block, size_t at)
{
  static const size_t step[3] = { 1, ROW, LAYER };
  const double* const v0 = b->value + z * LAYER + y * ROW;
  const double* const v1 = v0 + step[path[0]];
  const double* const v2 = v1 + step[path[1]];
  const double* const v3 = v2 + step[path[2]];
  double *const s0 = block->value[0] + at, *const s1 = block->value[1] + at;
  double *const s2 = block->value[2] + at, *const s3 = block->value[3] + at;
  double *const mass = block->mass + at, *const area = block->area + at;
  const double(*const p)[CELLS] = normal[path[0]];
  const double(*const q)[CELLS] = normal[path[1]];
  const double(*const r)[CELLS] = normal[path[2]];
  for (size_t x = 0; x < b->cells[0]; ++x)
  {
    const double along_p = v1[x] - v0[x], along_q = v2[x] - v1[x], along_r = v3[x] - v2[x];
    const double n0 = p[0][x] * along_p + q[0][x] * along_q + r[0][x] * along_r;
    const double n1 = p[1][x] * along_p + q[1][x] * along_q + r[1][x] * along_r;
    const double n2 = p[2][x] * along_p + q[2][x] * along_q + r[2][x] * along_r;
    s0[x] = v0[x];
    s1[x] = v1[x];
    s2[x] = v2[x];
    s3[x] = v3[x];
    mass[x] = volume[x];
    area[x] = sqrt(n0 * n0 + n1 * n1 + n2 * n2) * area_unit;
  }
}

/* Which cells of a row count. */
static void look_at_row(const brick* b, size_t y, size_t z, const double* volume,
  chi_histogram_piece* piece, int is_good[CELLS])
{
  const size_t* const n = b->plan->grid.dimensions;
  for (size_t x = 0; x < b->cells[0]; ++x)
  {
    chi_grid_cell cell;
    const size_t id = b->first[0] + x + n[0] * (b->first[1] + y + n[1] * (b->first[2] + z));
    const int found = chi_cell_read(&b->plan->grid, id, &cell);
    int is_tame = volume[x] >= 0;
    for (size_t k = 0; k < 8; ++k)
    {
      const size_t at = (z + (k >> 2)) * LAYER + (y + (k >> 1 & 1)) * ROW + x + (k & 1);
      is_tame &= fabs(b->value[at]) <= CHI_HISTOGRAM_LARGEST;
    }
    is_good[x] = found == CHI_CELL_GOOD && is_tame;
    if (piece)
    {
      piece->ghosts += found == CHI_CELL_GHOST;
      piece->blanked += found == CHI_CELL_BLANKED;
      piece->skipped += found == CHI_CELL_GOOD && !is_tame;
    }
  }
}

/* The row's tetrahedra whose cells count, closed up. */
static size_t close_up(
  chi_histogram_block* block, size_t at, size_t cells, const int is_good[CELLS])
{
  size_t to = at;
  for (size_t i = 0; i < 6 * cells; ++i)
  {
    if (is_good[i % cells])
    {
      for (int k = 0; k < 4; ++k)
      {
        block->value[k][to] = block->value[k][at + i];
      }
      block->mass[to] = block->mass[at + i];
      block->area[to++] = block->area[at + i];
    }
  }
  return to;
}

void chi_histogram_fill_brick(const chi_histogram_plan* plan, size_t index,
  chi_histogram_block* block, chi_histogram_piece* piece)
{
  brick b;
  double normal[3][3][CELLS] = { 0 }; /* [axis][component][cell] of a cell's sides */
  double volume[CELLS], area_unit = plan->cofactor_size / 6;
  const int is_image = plan->grid.view.kind == CHI_GRID_IMAGE;
  open_brick(plan, index, &b);
  for (size_t x = 0; x < CELLS && is_image; ++x)
  {
    volume[x] = plan->volume;
    for (int k = 0; k < 9; ++k)
    {
      normal[k % 3][k / 3][x] = plan->cofactor[k / 3][k % 3];
    }
  }
  for (size_t z = 0; z < b.cells[2]; ++z)
  {
    for (size_t y = 0; y < b.cells[1]; ++y)
    {
      for (size_t x = 0; x < b.cells[0] && !is_image; ++x)
      {
        const double wx = b.width[0][x], wy = b.width[1][y], wz = b.width[2][z];
        volume[x] = wx * wy * wz / 6;
        normal[0][0][x] = wy * wz;
        normal[1][1][x] = wx * wz;
        normal[2][2][x] = wx * wy;
        area_unit = 1.0 / 6;
      }
      const size_t at = block->count, cells = b.cells[0];
      for (size_t k = 0; k < 6; ++k)
      {
        fill_path(&b, y, z, paths[k], (const double(*)[3][CELLS])normal, volume, area_unit, block,
          at + k * cells);
      }
      block->count += 6 * cells;
      if (!b.is_clean)
      {
        int is_good[CELLS];
        look_at_row(&b, y, z, volume, piece, is_good);
        block->count = close_up(block, at, cells, is_good);
      }
    }
  }
  if (piece)
  {
    piece->cells = (uint32_t)(block->count / 6);
  }
}
