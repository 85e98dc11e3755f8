/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Points and cells of every kind of grid, checked as they are read. */

#include "chi_grid_internal.h"

#include <float.h>
#include <math.h>

enum
{
  VTK_POLYHEDRON_TYPE = 42,
  VTK_HEXAHEDRON_TYPE = 12
};

static const double largest = 1e100; /* of a coordinate: six volumes are below 5e301 */

static int unstructured_is_valid(const chi_grid_view* v)
{
  return chi_view_is_valid(&v->points) && (v->connectivity || v->connectivity_count == 0) &&
    (v->cell_count == 0 || (v->cell_types && v->offsets)) && (v->faces || v->faces_count == 0) &&
    (v->face_offsets || v->faces_count == 0);
}

static int structured_is_valid(const chi_grid_view* v, size_t points)
{
  if (v->kind == CHI_GRID_CURVILINEAR)
  {
    return chi_view_is_valid(&v->points) && v->points.count >= points;
  }
  for (int a = 0; a < 3 && v->kind == CHI_GRID_RECTILINEAR; ++a)
  {
    if (!chi_array_is_valid(&v->axes[a]) || v->axes[a].count < v->dimensions[a])
    {
      return 0;
    }
  }
  return 1;
}

chi_status chi_grid_open(chi_grid* grid, const chi_grid_view* given)
{
  memset(grid, 0, sizeof *grid);
  chi_grid_view* const v = &grid->view;
  if (!given || !CHI_ADOPT(chi_grid_view, version, v, given) || v->kind < CHI_GRID_UNSTRUCTURED ||
    v->kind > CHI_GRID_CURVILINEAR)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  grid->has_points = v->kind == CHI_GRID_UNSTRUCTURED || v->kind == CHI_GRID_CURVILINEAR;
  /* half a unit in the last place */
  grid->rounding =
    grid->has_points && v->points.type == CHI_F32 ? 0.5 * FLT_EPSILON : 0.5 * DBL_EPSILON;
  if (v->kind == CHI_GRID_UNSTRUCTURED)
  {
    if (!unstructured_is_valid(v))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    grid->points = v->points.count;
    grid->cells = v->cell_count;
  }
  else
  {
    grid->points = grid->cells = 1;
    for (int a = 0; a < 3; ++a)
    {
      const size_t n = v->dimensions[a];
      if (n > 0 && grid->points > SIZE_MAX / n)
      {
        return CHI_ERROR_TOO_LARGE;
      }
      grid->points *= n;
      grid->dimensions[a] = n > 1 ? n - 1 : 1;
      grid->is_flat |= n < 2;
    }
    if (!structured_is_valid(v, grid->points))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    grid->cells =
      grid->points ? grid->dimensions[0] * grid->dimensions[1] * grid->dimensions[2] : 0;
  }
  const size_t most = UINT32_MAX - (size_t)1;
  return grid->points > most || grid->cells > most ? CHI_ERROR_TOO_LARGE : CHI_OK;
}

static double axis_at(const chi_array_view* axis, size_t i)
{
  return chi_number_at((const char*)axis->data + i * axis->stride, axis->type);
}

void chi_grid_implicit_point(const chi_grid* grid, size_t id, double x[3])
{
  const chi_grid_view* const v = &grid->view;
  const size_t row = id / v->dimensions[0];
  const size_t ijk[3] = { id % v->dimensions[0], row % v->dimensions[1], row / v->dimensions[1] };
  for (int a = 0; a < 3; ++a)
  {
    const double* const m = v->index_to_world + 4 * a;
    x[a] = v->kind == CHI_GRID_RECTILINEAR
      ? axis_at(&v->axes[a], ijk[a])
      : m[0] * (double)ijk[0] + m[1] * (double)ijk[1] + m[2] * (double)ijk[2] + m[3];
  }
}

/* The stream of a polyhedron holds together: faces of three points and more, all of them there. */
static int read_faces(const chi_grid* grid, size_t index, chi_grid_cell* cell)
{
  const chi_grid_view* const v = &grid->view;
  const int64_t first = v->face_offsets ? v->face_offsets[index] : -1;
  if (first < 0 || (uint64_t)first >= v->faces_count || cell->count < 4)
  {
    return 0;
  }
  const int64_t* at = v->faces + first;
  size_t left = v->faces_count - (size_t)first - 1;
  const int64_t faces = *at++;
  if (faces < 4 || (uint64_t)faces > left)
  {
    return 0;
  }
  cell->faces = at;
  cell->face_count = (size_t)faces;
  for (int64_t f = 0; f < faces; ++f)
  {
    if (left == 0 || *at < 3 || (uint64_t)*at > left - 1)
    {
      return 0;
    }
    const int64_t n = *at++;
    for (int64_t k = 0; k < n; ++k, ++at)
    {
      if (*at < 0 || (uint64_t)*at >= grid->points)
      {
        return 0;
      }
    }
    left -= (size_t)n + 1;
  }
  return 1;
}

static int is_at_hidden_point(const chi_grid_cell* cell)
{
  const uint8_t* const ghosts = cell->grid->view.point_ghosts;
  int bits = 0;
  for (size_t k = 0; k < cell->count && ghosts; ++k)
  {
    bits |= ghosts[cell->ids[k]];
  }
  return bits & CHI_GRID_HIDDEN_POINT;
}

static void read_structured(const chi_grid* grid, size_t index, chi_grid_cell* cell)
{
  const size_t* const d = grid->dimensions;
  const int64_t nx = (int64_t)grid->view.dimensions[0];
  const int64_t nxy = nx * (int64_t)grid->view.dimensions[1];
  const size_t row = index / d[0];
  const int64_t first =
    (int64_t)(index % d[0]) + (int64_t)(row % d[1]) * nx + (int64_t)(row / d[1]) * nxy;
  for (int k = 0; k < 8; ++k) /* a hexahedron's corners go around */
  {
    cell->own[k] = first + ((k + 1) >> 1 & 1) + (k >> 1 & 1) * nx + (k >> 2) * nxy;
  }
  cell->ids = cell->own;
  cell->count = 8;
  cell->type = chi_cell_type_of(VTK_HEXAHEDRON_TYPE);
}

/* Ids, faces and type of an unstructured grid's cell. */
static int read_unstructured(const chi_grid* grid, size_t index, chi_grid_cell* cell)
{
  const chi_grid_view* const v = &grid->view;
  const int64_t begin = v->offsets[index], end = v->offsets[index + 1];
  if (begin < 0 || end < begin || (uint64_t)end > v->connectivity_count)
  {
    return CHI_CELL_BROKEN;
  }
  cell->ids = v->connectivity + begin;
  cell->count = (size_t)(end - begin);
  for (size_t k = 0; k < cell->count; ++k)
  {
    if ((uint64_t)cell->ids[k] >= grid->points) /* negative ones too */
    {
      return CHI_CELL_BROKEN;
    }
  }
  const int type = v->cell_types[index];
  cell->type = chi_cell_type_of(type);
  if (cell->type)
  {
    return cell->count == cell->type->points ? CHI_CELL_GOOD : CHI_CELL_BROKEN;
  }
  if (type == VTK_POLYHEDRON_TYPE)
  {
    return read_faces(grid, index, cell) ? CHI_CELL_GOOD : CHI_CELL_BROKEN;
  }
  return chi_cell_type_is_flat(type) ? CHI_CELL_FLAT_TYPE : CHI_CELL_UNSUPPORTED;
}

int chi_cell_read(const chi_grid* grid, size_t index, chi_grid_cell* cell)
{
  cell->grid = grid;
  cell->faces = NULL;
  int found = CHI_CELL_GOOD;
  if (grid->view.kind == CHI_GRID_UNSTRUCTURED)
  {
    found = read_unstructured(grid, index, cell);
  }
  else if (grid->is_flat)
  {
    found = CHI_CELL_FLAT_TYPE;
  }
  else
  {
    read_structured(grid, index, cell);
  }
  const int ghost = grid->view.cell_ghosts ? grid->view.cell_ghosts[index] : 0;
  if (found != CHI_CELL_BROKEN && ghost & CHI_GRID_DUPLICATE_CELL)
  {
    return CHI_CELL_GHOST;
  }
  if (found != CHI_CELL_BROKEN && ghost & CHI_GRID_HIDDEN_CELL)
  {
    return CHI_CELL_BLANKED;
  }
  return found == CHI_CELL_GOOD && is_at_hidden_point(cell) ? CHI_CELL_BLANKED : found;
}

/* Points as they are found; NaN is not tame, and leaves the box as it is. */
typedef struct point_box
{
  double low[3], high[3];
  int is_tame;
} point_box;

static inline void add_point(point_box* box, const double x[3])
{
  for (int a = 0; a < 3; ++a)
  {
    box->low[a] = x[a] < box->low[a] ? x[a] : box->low[a];
    box->high[a] = x[a] > box->high[a] ? x[a] : box->high[a];
    box->is_tame &= fabs(x[a]) <= largest;
  }
}

/* Points of a polyhedron's faces, beside those of its connectivity. */
static void add_faces(point_box* box, const chi_grid_cell* cell)
{
  const int64_t* at = cell->faces;
  for (size_t f = 0; f < cell->face_count; ++f)
  {
    for (int64_t n = *at++; n > 0; --n, ++at)
    {
      double x[3];
      chi_grid_point(cell->grid, (size_t)*at, x);
      add_point(box, x);
    }
  }
}

int chi_cell_locate(chi_grid_cell* cell)
{
  point_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 1 };
  for (size_t k = 0; k < cell->count; ++k)
  {
    double x[3];
    chi_grid_point(cell->grid, (size_t)cell->ids[k], x);
    add_point(&box, x);
    if (cell->type)
    {
      memcpy(cell->x[k], x, sizeof x);
    }
  }
  if (!cell->type)
  {
    add_faces(&box, cell);
  }
  memcpy(cell->low, box.low, sizeof box.low);
  memcpy(cell->high, box.high, sizeof box.high);
  return box.is_tame;
}

void chi_cell_find_center(chi_grid_cell* cell)
{
  double sum[3] = { 0, 0, 0 };
  for (size_t k = 0; k < cell->count; ++k)
  {
    double x[3];
    chi_grid_point(cell->grid, (size_t)cell->ids[k], x);
    for (int a = 0; a < 3; ++a)
    {
      sum[a] += x[a];
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    cell->center[a] = sum[a] / (double)cell->count;
  }
}
