/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* A mesh as simplices with their corners' values, volume and area, piece by piece. */

#include "chi_histogram_internal.h"

#include <math.h>

enum
{
  VTK_TETRA_TYPE = 10,
  VTK_POLYHEDRON_TYPE = 42,
  VTK_HEXAHEDRON_TYPE = 12,
  LEAST_CAPACITY = 6 * CHI_HISTOGRAM_RUN
};

/* ---- blocks */

int chi_histogram_reserve(const chi_exec* exec, chi_histogram_block* block, size_t count)
{
  block->count = 0;
  if (count <= block->capacity)
  {
    return 1;
  }
  const size_t capacity = count < LEAST_CAPACITY ? LEAST_CAPACITY : (count + 7) / 8 * 8;
  block->capacity = 0;
  if (!chi_buffer_reserve(exec, &block->memory, 6 * capacity, sizeof(double)))
  {
    return 0;
  }
  double* at = (double*)block->memory.data;
  for (int k = 0; k < 4; ++k, at += capacity)
  {
    block->value[k] = at;
  }
  block->mass = at;
  block->area = at + capacity;
  block->capacity = capacity;
  return 1;
}

void chi_histogram_free_block(const chi_exec* exec, chi_histogram_block* block)
{
  chi_buffer_free(exec, &block->memory);
  chi_buffer_free(exec, &block->vertices);
  memset(block, 0, sizeof *block);
}

static double length_of(const double n[3])
{
  const double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
  const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  if (square > 1e-280 && square < 1e280)
  {
    return sqrt(square);
  }
  if (!(largest > 0))
  {
    return 0;
  }
  const double x = n[0] / largest, y = n[1] / largest, z = n[2] / largest;
  return largest * sqrt(x * x + y * y + z * z);
}

static void cross(const double a[3], const double b[3], double n[3])
{
  n[0] = a[1] * b[2] - a[2] * b[1];
  n[1] = a[2] * b[0] - a[0] * b[2];
  n[2] = a[0] * b[1] - a[1] * b[0];
}

static void subtract(const double a[3], const double b[3], double d[3])
{
  for (int k = 0; k < 3; ++k)
  {
    d[k] = a[k] - b[k];
  }
}

/* |grad f| V = |sum of (f_k - f_0) (normal of the side opposite k)| / 6: no division, so that flat
 * tetrahedra too have the area of their isosurfaces. */
static void add_tetrahedron(chi_histogram_block* block, double x[4][3], const double value[4])
{
  double e[3][3], n[3][3], sum[3];
  const size_t at = block->count++;
  for (int k = 0; k < 3; ++k)
  {
    subtract(x[k + 1], x[0], e[k]);
  }
  cross(e[1], e[2], n[0]);
  cross(e[2], e[0], n[1]);
  cross(e[0], e[1], n[2]);
  for (int a = 0; a < 3; ++a)
  {
    sum[a] = (value[1] - value[0]) * n[0][a] + (value[2] - value[0]) * n[1][a] +
      (value[3] - value[0]) * n[2][a];
  }
  for (int k = 0; k < 4; ++k)
  {
    block->value[k][at] = value[k];
  }
  block->mass[at] = fabs(e[0][0] * n[0][0] + e[0][1] * n[0][1] + e[0][2] * n[0][2]) / 6;
  block->area[at] = length_of(sum) / 6;
}

/* |grad f| A = |(f_1 - f_0) e_2 - (f_2 - f_0) e_1| / 2: the gradient, turned by a right angle. */
void chi_histogram_add_triangle(
  chi_histogram_block* block, double x[3][3], const double value[3], double sign)
{
  double e[2][3], n[3], turned[3];
  const size_t at = block->count++;
  subtract(x[1], x[0], e[0]);
  subtract(x[2], x[0], e[1]);
  cross(e[0], e[1], n);
  for (int a = 0; a < 3; ++a)
  {
    turned[a] = (value[1] - value[0]) * e[1][a] - (value[2] - value[0]) * e[0][a];
  }
  for (int k = 0; k < 3; ++k)
  {
    block->value[k][at] = value[k];
  }
  block->mass[at] = sign * length_of(n) / 2;
  block->area[at] = sign * length_of(turned) / 2;
}

/* ---- cells */

static int is_tame(const double* value, int count)
{
  int tame = 1;
  for (int k = 0; k < count; ++k)
  {
    tame &= fabs(value[k]) <= CHI_HISTOGRAM_LARGEST;
  }
  return tame;
}

static int add_linear(
  const chi_histogram_plan* plan, const chi_grid_cell* cell, chi_histogram_block* block)
{
  double x[4][3], value[4];
  for (size_t k = 0; k < 4; ++k)
  {
    const size_t id = (size_t)cell->ids[k];
    chi_grid_point(&plan->grid, id, x[k]);
    value[k] = chi_histogram_value(plan, id);
  }
  if (!is_tame(&x[0][0], 12) || !is_tame(value, 4))
  {
    return CHI_CELL_NON_FINITE;
  }
  add_tetrahedron(block, x, value);
  return CHI_CELL_GOOD;
}

/* A cell's tetrahedra, as chi_grid_split makes them; all or none. */
static int add_split(const chi_histogram_plan* plan, chi_grid_cell* cell,
  const chi_cell_split* split, chi_histogram_block* block)
{
  const chi_grid* const grid = &plan->grid;
  const uint32_t center_id = (uint32_t)grid->points;
  const size_t before = block->count;
  double center_value = 0;
  if (split->way == CHI_SPLIT_CENTER)
  {
    chi_cell_find_center(cell);
    for (size_t k = 0; k < cell->count; ++k)
    {
      center_value += chi_histogram_value(plan, (size_t)cell->ids[k]);
    }
    center_value /= (double)cell->count;
  }
  uint32_t(*const vertices)[4] = (uint32_t(*)[4])block->vertices.data;
  const size_t count = chi_cell_write(cell, split->way, center_id, vertices);
  for (size_t t = 0; t < count; ++t)
  {
    double x[4][3], value[4];
    for (int k = 0; k < 4; ++k)
    {
      const uint32_t id = vertices[t][k];
      if (id == center_id)
      {
        memcpy(x[k], cell->center, sizeof x[k]);
        value[k] = center_value;
      }
      else
      {
        chi_grid_point(grid, id, x[k]);
        value[k] = chi_histogram_value(plan, id);
      }
    }
    if (!is_tame(value, 4))
    {
      block->count = before;
      return CHI_CELL_NON_FINITE;
    }
    add_tetrahedron(block, x, value);
  }
  return CHI_CELL_GOOD;
}

static int add_cell(const chi_histogram_plan* plan, size_t index, chi_histogram_block* block)
{
  chi_grid_cell cell;
  chi_cell_split split;
  const int found = chi_cell_read(&plan->grid, index, &cell);
  const int are_cells = plan->association == CHI_HISTOGRAM_CELLS;
  if (found != CHI_CELL_GOOD)
  {
    return found;
  }
  if (!are_cells && cell.type && cell.count == 4)
  {
    return add_linear(plan, &cell, block);
  }
  if (!chi_cell_locate(&cell))
  {
    return CHI_CELL_NON_FINITE;
  }
  chi_cell_choose(&cell, &split);
  if (!are_cells)
  {
    return add_split(plan, &cell, &split, block);
  }
  const double value = chi_histogram_value(plan, index);
  if (!is_tame(&value, 1))
  {
    return CHI_CELL_NON_FINITE;
  }
  block->value[0][block->count] = value;
  block->area[block->count] = 0;
  block->mass[block->count++] = split.volume;
  return CHI_CELL_GOOD;
}

/* ---- pieces */

/* Tetrahedra of a type's cells, at most: each face of each part a fan. */
static size_t most_of_type(int vtk_type)
{
  const chi_cell_type* const type = chi_cell_type_of(vtk_type);
  size_t sum = 0;
  for (size_t p = 0; type && p < type->parts; ++p)
  {
    const chi_shape* const shape = chi_shapes + type->part[p].shape;
    for (size_t f = 0; f < shape->faces; ++f)
    {
      sum += shape->face[f][0] - (size_t)2;
    }
  }
  return vtk_type == VTK_TETRA_TYPE ? 1 : sum;
}

static size_t most_of_polyhedron(const chi_histogram_plan* plan, size_t index)
{
  chi_grid_cell cell;
  size_t sum = 0;
  if (chi_cell_read(&plan->grid, index, &cell) == CHI_CELL_GOOD && !cell.type)
  {
    const int64_t* at = cell.faces;
    for (size_t f = 0; f < cell.face_count; ++f)
    {
      sum += (size_t)*at;
      at += *at + 1;
    }
  }
  return sum;
}

/* Simplices of a cell, at most. */
static size_t most_of(const chi_histogram_plan* plan, size_t index)
{
  const chi_grid_view* const v = &plan->grid.view;
  const int is_list = v->kind == CHI_GRID_UNSTRUCTURED;
  if (plan->association == CHI_HISTOGRAM_CELLS)
  {
    return 1;
  }
  if (plan->dimension == 2)
  {
    const int64_t count = is_list ? v->offsets[index + 1] - v->offsets[index] : 4;
    return count < 0 || (uint64_t)count > v->connectivity_count + 4
      ? 0
      : chi_polygon_most(is_list ? v->cell_types[index] : 0, (size_t)count);
  }
  const int type = is_list ? v->cell_types[index] : VTK_HEXAHEDRON_TYPE;
  return type == VTK_POLYHEDRON_TYPE ? most_of_polyhedron(plan, index) : plan->most[type];
}

static void count_cell(chi_histogram_piece* piece, size_t index, int found)
{
  piece->cells += found == CHI_CELL_GOOD;
  piece->ghosts += found == CHI_CELL_GHOST;
  piece->blanked += found == CHI_CELL_BLANKED;
  piece->lower_dimensional += found == CHI_CELL_FLAT_TYPE;
  piece->unsupported += found == CHI_CELL_UNSUPPORTED;
  piece->skipped += found == CHI_CELL_NON_FINITE;
  if (found == CHI_CELL_BROKEN && piece->bad < 0)
  {
    piece->bad = (int64_t)index;
  }
}

static chi_status fill_run(const chi_exec* exec, const chi_histogram_plan* plan, size_t run,
  chi_histogram_block* block, chi_histogram_piece* piece)
{
  const size_t first = run * CHI_HISTOGRAM_RUN;
  const size_t end = chi_grid_chunk_end(first, CHI_HISTOGRAM_RUN, plan->grid.cells);
  size_t all = 0, most = 0;
  for (size_t i = first; i < end; ++i)
  {
    const size_t count = most_of(plan, i);
    all += count;
    most = count > most ? count : most;
  }
  if (!chi_histogram_reserve(exec, block, all) ||
    !chi_buffer_reserve(exec, &block->vertices, most + 1, 4 * sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = first; i < end; ++i)
  {
    const int found =
      plan->dimension == 2 ? chi_histogram_add_polygon(plan, i, block) : add_cell(plan, i, block);
    if (piece)
    {
      count_cell(piece, i, found);
    }
  }
  return CHI_OK;
}

chi_status chi_histogram_fill(const chi_exec* exec, const chi_histogram_plan* plan, size_t index,
  chi_histogram_block* block, chi_histogram_piece* piece)
{
  if (!plan->is_lattice)
  {
    return fill_run(exec, plan, index, block, piece);
  }
  if (!chi_histogram_reserve(exec, block, LEAST_CAPACITY))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_histogram_fill_brick(plan, index, block, piece);
  return CHI_OK;
}

/* The highest dimension among the mesh's cells. */
static int find_dimension(const chi_grid* grid)
{
  const chi_grid_view* const v = &grid->view;
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
  int dimension = 0;
  for (int type = 0; type < 256; ++type)
  {
    if (is_there[type] && (chi_cell_type_of(type) || type == VTK_POLYHEDRON_TYPE))
    {
      return 3;
    }
    dimension = is_there[type] && chi_polygon_has_type(type) ? 2 : dimension;
  }
  return dimension;
}

void chi_histogram_make_plan(chi_histogram_plan* plan)
{
  plan->dimension = find_dimension(&plan->grid);
  plan->corners = plan->association == CHI_HISTOGRAM_CELLS ? 1 : plan->dimension + 1;
  for (int type = 0; type < 256; ++type)
  {
    plan->most[type] = (uint16_t)most_of_type(type);
  }
  plan->is_lattice = chi_histogram_plan_lattice(plan);
  plan->pieces = plan->is_lattice ? plan->bricks[0] * plan->bricks[1] * plan->bricks[2]
                                  : chi_grid_chunks(plan->grid.cells, CHI_HISTOGRAM_RUN);
}
