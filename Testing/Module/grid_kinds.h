/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_GRID_KINDS_H
#define CHI_GRID_KINDS_H

/* Cells of every type with straight edges, put side by side, and whether their splits conform. */

#include "grid_mesh.h"

/* Nodes and faces as VTK has them: vtkCell::GetParametricCoords, vtkCell::GetFace. */
typedef struct cell_kind
{
  int type;
  size_t points, faces, tetrahedra;
  double volume;
  double x[27][3];
  int face[8][10]; /* the number of nodes, then these */
} cell_kind;

#define H 0.5
#define CORNERS_OF_CUBE                                                                            \
  { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 },       \
  {                                                                                                \
    0, 1, 1                                                                                        \
  }
#define EDGES_OF_CUBE                                                                              \
  { H, 0, 0 }, { 1, H, 0 }, { H, 1, 0 }, { 0, H, 0 }, { H, 0, 1 }, { 1, H, 1 }, { H, 1, 1 },       \
    { 0, H, 1 }, { 0, 0, H }, { 1, 0, H }, { 1, 1, H },                                            \
  {                                                                                                \
    0, 1, H                                                                                        \
  }
#define CORNERS_OF_WEDGE                                                                           \
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },                                 \
  {                                                                                                \
    0, 1, 1                                                                                        \
  }
#define LEVELS_OF_WEDGE                                                                            \
  { H, 0, 0 }, { H, H, 0 }, { 0, H, 0 }, { H, 0, 1 }, { H, H, 1 },                                 \
  {                                                                                                \
    0, H, 1                                                                                        \
  }

static const cell_kind kinds[] = {
  { 10, 4, 4, 1, 1.0 / 6, { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    { { 3, 0, 1, 3 }, { 3, 1, 2, 3 }, { 3, 2, 0, 3 }, { 3, 0, 2, 1 } } },
  { 11, 8, 6, 6, 1,
    { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 },
      { 1, 1, 1 } },
    { { 4, 0, 2, 6, 4 }, { 4, 1, 3, 7, 5 }, { 4, 0, 1, 5, 4 }, { 4, 2, 3, 7, 6 }, { 4, 0, 1, 3, 2 },
      { 4, 4, 5, 7, 6 } } },
  { 12, 8, 6, 6, 1, { CORNERS_OF_CUBE },
    { { 4, 0, 4, 7, 3 }, { 4, 1, 2, 6, 5 }, { 4, 0, 1, 5, 4 }, { 4, 3, 7, 6, 2 }, { 4, 0, 3, 2, 1 },
      { 4, 4, 5, 6, 7 } } },
  { 13, 6, 5, 3, 0.5, { CORNERS_OF_WEDGE },
    { { 3, 0, 1, 2 }, { 3, 3, 5, 4 }, { 4, 0, 3, 4, 1 }, { 4, 1, 4, 5, 2 }, { 4, 2, 5, 3, 0 } } },
  { 14, 5, 5, 2, 1.0 / 3, { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    { { 4, 0, 3, 2, 1 }, { 3, 0, 1, 4 }, { 3, 1, 2, 4 }, { 3, 2, 3, 4 }, { 3, 3, 0, 4 } } },
  /* a unit square with a gable: corners that are binary fractions */
  { 15, 10, 7, 9, 1.25,
    { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { H, 1.5, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
      { 1, 1, 1 }, { H, 1.5, 1 }, { 0, 1, 1 } },
    { { 5, 0, 1, 2, 3, 4 }, { 5, 5, 6, 7, 8, 9 }, { 4, 0, 1, 6, 5 }, { 4, 1, 2, 7, 6 },
      { 4, 2, 3, 8, 7 }, { 4, 3, 4, 9, 8 }, { 4, 4, 0, 5, 9 } } },
  { 16, 12, 8, 12, 1.5,
    { { 0, 0, 0 }, { H, -H, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { H, 1.5, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
      { H, -H, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { H, 1.5, 1 }, { 0, 1, 1 } },
    { { 6, 0, 1, 2, 3, 4, 5 }, { 6, 6, 7, 8, 9, 10, 11 }, { 4, 0, 1, 7, 6 }, { 4, 1, 2, 8, 7 },
      { 4, 2, 3, 9, 8 }, { 4, 3, 4, 10, 9 }, { 4, 4, 5, 11, 10 }, { 4, 5, 0, 6, 11 } } },
  { 24, 10, 4, 8, 1.0 / 6,
    { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { H, 0, 0 }, { H, H, 0 }, { 0, H, 0 },
      { 0, 0, H }, { H, 0, H }, { 0, H, H } },
    { { 6, 0, 1, 3, 4, 8, 7 }, { 6, 1, 2, 3, 5, 9, 8 }, { 6, 2, 0, 3, 6, 7, 9 },
      { 6, 0, 2, 1, 6, 5, 4 } } },
  { 25, 20, 6, 22, 1, { CORNERS_OF_CUBE, EDGES_OF_CUBE },
    { { 8, 0, 4, 7, 3, 16, 15, 19, 11 }, { 8, 1, 2, 6, 5, 9, 18, 13, 17 },
      { 8, 0, 1, 5, 4, 8, 17, 12, 16 }, { 8, 3, 7, 6, 2, 19, 14, 18, 10 },
      { 8, 0, 3, 2, 1, 11, 10, 9, 8 }, { 8, 4, 5, 6, 7, 12, 13, 14, 15 } } },
  { 26, 15, 5, 0, 0.5, { CORNERS_OF_WEDGE, LEVELS_OF_WEDGE, { 0, 0, H }, { 1, 0, H }, { 0, 1, H } },
    { { 6, 0, 1, 2, 6, 7, 8 }, { 6, 3, 5, 4, 11, 10, 9 }, { 8, 0, 3, 4, 1, 12, 9, 13, 6 },
      { 8, 1, 4, 5, 2, 13, 10, 14, 7 }, { 8, 2, 5, 3, 0, 14, 11, 12, 8 } } },
  { 27, 13, 5, 0, 1.0 / 3,
    { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { H, 0, 0 }, { 1, H, 0 },
      { H, 1, 0 }, { 0, H, 0 }, { 0, 0, H }, { H, 0, H }, { H, H, H }, { 0, H, H } },
    { { 8, 0, 3, 2, 1, 8, 7, 6, 5 }, { 6, 0, 1, 4, 5, 10, 9 }, { 6, 1, 2, 4, 6, 11, 10 },
      { 6, 2, 3, 4, 7, 12, 11 }, { 6, 3, 0, 4, 8, 9, 12 } } },
  { 29, 27, 6, 48, 1,
    { CORNERS_OF_CUBE, EDGES_OF_CUBE, { 0, H, H }, { 1, H, H }, { H, 0, H }, { H, 1, H },
      { H, H, 0 }, { H, H, 1 }, { H, H, H } },
    { { 9, 0, 4, 7, 3, 16, 15, 19, 11, 20 }, { 9, 1, 2, 6, 5, 9, 18, 13, 17, 21 },
      { 9, 0, 1, 5, 4, 8, 17, 12, 16, 22 }, { 9, 3, 7, 6, 2, 19, 14, 18, 10, 23 },
      { 9, 0, 3, 2, 1, 11, 10, 9, 8, 24 }, { 9, 4, 5, 6, 7, 12, 13, 14, 15, 25 } } },
  { 31, 12, 5, 12, 0.5, { CORNERS_OF_WEDGE, LEVELS_OF_WEDGE },
    { { 6, 0, 1, 2, 6, 7, 8 }, { 6, 3, 5, 4, 11, 10, 9 }, { 6, 1, 0, 3, 4, 6, 9 },
      { 6, 2, 1, 4, 5, 7, 10 }, { 6, 0, 2, 5, 3, 8, 11 } } },
  { 32, 18, 5, 24, 0.5,
    { CORNERS_OF_WEDGE, LEVELS_OF_WEDGE, { 0, 0, H }, { 1, 0, H }, { 0, 1, H }, { H, 0, H },
      { H, H, H }, { 0, H, H } },
    { { 6, 0, 1, 2, 6, 7, 8 }, { 6, 3, 5, 4, 11, 10, 9 }, { 9, 0, 3, 4, 1, 12, 9, 13, 6, 15 },
      { 9, 1, 4, 5, 2, 13, 10, 14, 7, 16 }, { 9, 2, 5, 3, 0, 14, 11, 12, 8, 17 } } },
  { 33, 24, 6, 36, 1,
    { CORNERS_OF_CUBE, EDGES_OF_CUBE, { 0, H, H }, { 1, H, H }, { H, 0, H }, { H, 1, H } },
    { { 9, 0, 4, 7, 3, 16, 15, 19, 11, 20 }, { 9, 1, 2, 6, 5, 9, 18, 13, 17, 21 },
      { 9, 0, 1, 5, 4, 8, 17, 12, 16, 22 }, { 9, 3, 7, 6, 2, 19, 14, 18, 10, 23 },
      { 8, 0, 3, 2, 1, 11, 10, 9, 8 }, { 8, 4, 5, 6, 7, 12, 13, 14, 15 } } },
  /* VTK's, half as high and raised by a half */
  { 37, 19, 5, 32, 1.0 / 6,
    { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { H, H, H }, { H, 0, 0 }, { 1, H, 0 },
      { H, 1, 0 }, { 0, H, 0 }, { 0.25, 0.25, 0.25 }, { 0.75, 0.25, 0.25 }, { 0.75, 0.75, 0.25 },
      { 0.25, 0.75, 0.25 }, { H, H, 0 }, { H, 1.0 / 6, 1.0 / 6 }, { 5.0 / 6, H, 1.0 / 6 },
      { H, 5.0 / 6, 1.0 / 6 }, { 1.0 / 6, H, 1.0 / 6 }, { H, H, 0.125 } },
    { { 9, 0, 3, 2, 1, 8, 7, 6, 5, 13 }, { 7, 0, 1, 4, 5, 10, 9, 14 },
      { 7, 1, 2, 4, 6, 11, 10, 15 }, { 7, 2, 3, 4, 7, 12, 11, 16 },
      { 7, 3, 0, 4, 8, 9, 12, 17 } } },
};

enum
{
  KINDS = sizeof kinds / sizeof kinds[0]
};

__attribute__((unused)) static const cell_kind* kind_of(int type)
{
  for (size_t k = 0; k < KINDS; ++k)
  {
    if (kinds[k].type == type)
    {
      return kinds + k;
    }
  }
  exit(1);
}

/* A cell of unit size that begins at a point; `scale` may mirror it. */
__attribute__((unused)) static void place_cell(
  mesh* m, int type, double x, double y, double z, double scale_x, double scale_y, double scale_z)
{
  const cell_kind* const kind = kind_of(type);
  int64_t ids[27];
  for (size_t k = 0; k < kind->points; ++k)
  {
    ids[k] = share_point(
      m, x + scale_x * kind->x[k][0], y + scale_y * kind->x[k][1], z + scale_z * kind->x[k][2]);
  }
  add_cell(m, type, kind->points, ids);
}

/* Triangles of a face, by the number of its nodes and corners: what the core's rules amount to. */
__attribute__((unused)) static size_t triangles_of(int type, size_t nodes)
{
  switch (nodes)
  {
    case 3:
      return 1;
    case 4:
      return 2;
    case 5:
      return 3;
    case 6:
      return 4; /* hexagons, six-node triangles, six-node quadrilaterals */
    case 7:
      return 6;
    case 8:
      return 6;
    default:
      return type ? 8 : 0;
  }
}

__attribute__((unused)) static int is_within(const id_set* few, const id_set* many)
{
  size_t found = 0;
  for (size_t k = 0; k < many->count && found < few->count; ++k)
  {
    found += many->id[k] == few->id[found];
  }
  return found == few->count;
}

/* Triangles of one tetrahedron alone lie in faces of one cell alone, as many as these have. */
__attribute__((unused)) static void check_conformity(const mesh* m, const split* s)
{
  id_set* const face = calloc(8 * m->cells, sizeof *face);
  size_t faces = 0, more, singles, expected = 0, astray = 0;
  for (size_t c = 0; c < m->cells && face; ++c)
  {
    const cell_kind* const kind = kind_of(m->types[c]);
    for (size_t f = 0; f < kind->faces; ++f, ++faces)
    {
      face[faces].count = (size_t)kind->face[f][0];
      for (size_t k = 0; k < face[faces].count; ++k)
      {
        face[faces].id[k] = m->ids[m->offsets[c] + kind->face[f][k + 1]];
      }
      qsort(face[faces].id, face[faces].count, sizeof(int64_t), compare_ids);
    }
  }
  faces = keep_single(face, faces, &more);
  CHECK(more == 0);
  for (size_t f = 0; f < faces; ++f)
  {
    expected += triangles_of(1, face[f].count);
  }
  id_set* const triangle = boundary_of(s, &singles);
  for (size_t t = 0; t < singles; ++t)
  {
    int within = 0;
    for (size_t f = 0; f < faces && !within; ++f)
    {
      within = is_within(triangle + t, face + f);
    }
    astray += !within;
  }
  CHECK(astray == 0);
  CHECK(singles == expected);
  free(triangle);
  free(face);
}

#endif
