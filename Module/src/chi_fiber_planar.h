/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FIBER_PLANAR_H
#define CHI_FIBER_PLANAR_H

/* Lines in the plane of two fields on their way to triangles: chi_fiber_arrange.c cuts them where
 * they meet, chi_fiber_triangulate.c divides what they enclose, chi_fiber_planar.c hands it on. */

#include "chi_fiber_internal.h"

enum
{
  NOWHERE = -1
};

typedef struct side
{
  uint32_t from, to;
} side;

typedef struct cut_at
{
  uint32_t side, point;
  double along;
} cut_at;

typedef struct triangle
{
  uint32_t v[3]; /* counterclockwise */
  int32_t n[3];  /* across the side opposite to v[k] */
  uint8_t fixed; /* bits of sides that are pieces of lines */
  uint8_t inside;
} triangle;

typedef struct planar
{
  const chi_exec* exec;
  double (*x)[2];
  side* sides;
  cut_at* cuts;
  triangle* triangles;
  int32_t* at; /* [points] a triangle there */
  side* queue;
  size_t points, side_count, cut_count, triangle_count;
  size_t point_room, side_room, cut_room, triangle_room, at_room, queue_room;
} planar;

/* Room for `count`; 0: refused. */
int chi_planar_make_room(const chi_exec* exec, void* of, size_t* room, size_t count, size_t size);

#define ROOM(g, array, room, count)                                                                \
  chi_planar_make_room((g)->exec, &(g)->array, &(g)->room, count, sizeof *(g)->array)

static inline int side_to(const triangle* t, int32_t neighbour)
{
  return t->n[0] == neighbour ? 0 : t->n[1] == neighbour ? 1 : 2;
}

/* By their ends, whichever comes first; then by the way they run. */
int chi_planar_compare_sides(const void* a, const void* b);
/* Sides that meet in their ends alone, none twice. */
chi_status chi_planar_arrange(planar* g);
/* Triangles of all points of the sides within a box, `inside` told apart. */
chi_status chi_planar_triangulate(planar* g);

#endif
