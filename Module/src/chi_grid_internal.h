/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_GRID_INTERNAL_H
#define CHI_GRID_INTERNAL_H

#include <chiaroscuro/chi_grid.h>

#include "chi_internal.h"

enum
{
  CHI_CELL_POINTS = 27, /* most nodes of a cell that is no polyhedron */
  CHI_CELL_CENTER = -1  /* corner of a tetrahedron: the mean of the cell's points */
};

/* A polyhedron with its faces, each the number of its corners and these, outward. */
typedef struct chi_shape
{
  uint8_t points, faces;
  uint8_t face[14][7];
} chi_shape;

/* A type of cell: the linear cells that its nodes make, one of them for linear types. */
typedef struct chi_cell_part
{
  uint8_t shape;
  uint8_t node[12];
} chi_cell_part;

typedef struct chi_cell_type
{
  const chi_cell_part* part;
  size_t parts, points;
} chi_cell_type;

extern const chi_shape chi_shapes[];
/* NULL where the type is not split by a table. */
const chi_cell_type* chi_cell_type_of(int vtk_type);
int chi_cell_type_is_flat(int vtk_type);

/* A grid whose arrays are there and long enough; what they say is checked cell by cell. */
typedef struct chi_grid
{
  chi_grid_view view;
  size_t points, cells;
  size_t dimensions[3]; /* in cells, of structured grids */
  int is_flat;          /* a structured grid of less than three dimensions */
  int has_points;       /* else they follow from their ids */
  double rounding;      /* of a coordinate, relative to its size */
} chi_grid;

chi_status chi_grid_open(chi_grid* grid, const chi_grid_view* view);
void chi_grid_implicit_point(const chi_grid* grid, size_t id, double x[3]);

static inline void chi_grid_point(const chi_grid* grid, size_t id, double x[3])
{
  const chi_vec3_view* const points = &grid->view.points;
  const char* const at = (const char*)points->data + id * points->stride;
  if (!grid->has_points)
  {
    chi_grid_implicit_point(grid, id, x);
  }
  else if (points->type == CHI_F64)
  {
    memcpy(x, at, 3 * sizeof(double));
  }
  else
  {
    float single[3];
    memcpy(single, at, sizeof single);
    x[0] = single[0];
    x[1] = single[1];
    x[2] = single[2];
  }
}

/* Fixed chunks of `size` of `count` items: how many, and where the one that begins at `first` ends.
 */
static inline size_t chi_grid_chunks(size_t count, size_t size)
{
  return count / size + (count % size != 0);
}

static inline size_t chi_grid_chunk_end(size_t first, size_t size, size_t count)
{
  return count - first < size ? count : first + size;
}

/* What becomes of a cell. */
enum
{
  CHI_CELL_GOOD = 0,
  CHI_CELL_GHOST,
  CHI_CELL_BLANKED,
  CHI_CELL_FLAT_TYPE,
  CHI_CELL_UNSUPPORTED,
  CHI_CELL_NON_FINITE,
  CHI_CELL_BROKEN
};

typedef struct chi_grid_cell
{
  const chi_grid* grid;
  const chi_cell_type* type; /* NULL: a polyhedron, whose corners are point ids */
  const int64_t* ids;        /* [count] of its points */
  size_t count;
  const int64_t* faces; /* of a polyhedron: its part of the stream, behind the number of faces */
  size_t face_count;
  int64_t own[8]; /* ids of a structured grid's cell */
  /* chi_cell_locate: */
  double x[CHI_CELL_POINTS][3], center[3];
  double low[3], high[3];
} chi_grid_cell;

/* Ids and faces, checked; CHI_CELL_... */
int chi_cell_read(const chi_grid* grid, size_t index, chi_grid_cell* cell);
/* Coordinates; 0 where one is not finite. */
int chi_cell_locate(chi_grid_cell* cell);
void chi_cell_find_center(chi_grid_cell* cell);

/* The faces of a polyhedron, by bits, that must go the other way round for all to go as its first
 * one does. Those beyond 64 are believed. */
uint64_t chi_cell_flips(const chi_grid_cell* cell);

/* How a cell is split. */
enum
{
  CHI_SPLIT_NONE = 0,
  CHI_SPLIT_POSITIVE, /* from its lowest vertex, all tetrahedra right-handed as they come */
  CHI_SPLIT_NEGATIVE, /* likewise, all left-handed */
  CHI_SPLIT_SIGNED,   /* likewise, each to be looked at */
  CHI_SPLIT_CENTER    /* from its centre, each to be looked at */
};

typedef struct chi_cell_split
{
  int way, folded;
  size_t tetrahedra, flat, collapsed;
  double volume;
} chi_cell_split;

/* Choose for a cell that has been located. */
void chi_cell_choose(chi_grid_cell* cell, chi_cell_split* split);
/* Write its tetrahedra; their number. The cell is located unless each is right- or left-handed. */
size_t chi_cell_write(
  const chi_grid_cell* cell, int way, uint32_t center_id, uint32_t (*vertices)[4]);

/* ---- cells of two dimensions (chi_grid_polygon.c) */

typedef struct chi_polygon_type chi_polygon_type;

typedef struct chi_grid_polygon
{
  const chi_polygon_type* type; /* NULL: a strip or a polygon */
  int is_strip;
  const int64_t* ids; /* [count] of its points */
  size_t count, triangles;
  int64_t own[4];  /* ids of a structured grid's cell */
  double whole[3]; /* chi_polygon_locate: twice its vector area */
} chi_grid_polygon;

/* Whether cells of a type are cut into triangles. */
int chi_polygon_has_type(int vtk_type);
/* Triangles of a polygonal cell of `count` points, at most. */
size_t chi_polygon_most(int vtk_type, size_t count);
/* Ids, checked; CHI_CELL_... The polygon may point into itself. */
int chi_polygon_read(const chi_grid* grid, size_t index, chi_grid_polygon* polygon);
/* A triangle of those that it is cut into, as places among its points. */
void chi_polygon_triangle(const chi_grid_polygon* polygon, size_t t, size_t corner[3]);
/* Which way it is turned; 0 where a coordinate is not finite. */
int chi_polygon_locate(const chi_grid* grid, chi_grid_polygon* polygon);
/* Area and points of a triangle, once the polygon is located; negative where a polygon's triangle
 * is turned against the whole, so that one that is not convex has its own area. */
double chi_polygon_area(
  const chi_grid* grid, const chi_grid_polygon* polygon, size_t t, double x[3][3]);

#endif
