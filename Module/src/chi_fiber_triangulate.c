/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * A box is triangulated with all corners, the pieces of lines are forced in by turning diagonals,
 * and the triangles are told apart from without. All signs are exact. Source: Sloan, "A fast
 * algorithm for generating constrained Delaunay triangulations", 1993 (forcing sides in). Diagonals
 * are turned to the shorter one in the end, which is all that shape is asked for here.
 */

#include "chi_fiber_planar.h"

#include <math.h>

enum
{
  MOST_PASSES = 64, /* of turning diagonals */
  BOX = 4           /* corners around all others */
};

static double area_at(const planar* g, uint32_t a, uint32_t b, uint32_t c)
{
  return chi_fiber_area(g->x[a], g->x[b], g->x[c]);
}

static int corner_of(const triangle* t, uint32_t point)
{
  return t->v[0] == point ? 0 : t->v[1] == point ? 1 : t->v[2] == point ? 2 : NOWHERE;
}

static void replace_neighbour(planar* g, int32_t of, int32_t old, int32_t by)
{
  if (of != NOWHERE)
  {
    g->triangles[of].n[side_to(g->triangles + of, old)] = by;
  }
}

static void note(planar* g, int32_t number)
{
  for (int k = 0; k < 3; ++k)
  {
    g->at[g->triangles[number].v[k]] = number;
  }
}

/* Turn the diagonal that lies opposite to corner i. */
static void turn(planar* g, int32_t number, int i)
{
  triangle* const t = g->triangles + number;
  const int32_t other = t->n[i];
  triangle* const u = g->triangles + other;
  const int j = side_to(u, number), i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3,
            j2 = (j + 2) % 3;
  const uint32_t a = t->v[i], b = t->v[i1], c = t->v[i2], d = u->v[j];
  const triangle was = *t, that = *u;
  *t = (triangle){ { a, b, d }, { that.n[j1], other, was.n[i2] },
    (uint8_t)((that.fixed >> j1 & 1) | (was.fixed >> i2 & 1) << 2), 0 };
  *u = (triangle){ { d, c, a }, { was.n[i1], number, that.n[j2] },
    (uint8_t)((was.fixed >> i1 & 1) | (that.fixed >> j2 & 1) << 2), 0 };
  replace_neighbour(g, that.n[j1], other, number);
  replace_neighbour(g, was.n[i1], number, other);
  note(g, number);
  note(g, other);
}

/* Whether both triangles that turning makes are counterclockwise. */
static int can_turn(const planar* g, int32_t number, int i)
{
  const triangle* const t = g->triangles + number;
  const triangle* const u = g->triangles + t->n[i];
  const uint32_t d = u->v[side_to(u, number)];
  return area_at(g, t->v[i], t->v[(i + 1) % 3], d) > 0 &&
    area_at(g, d, t->v[(i + 2) % 3], t->v[i]) > 0;
}

/* The triangle that holds a point, in its inside or on side *on; a walk first, then a search, since
 * walks may go around in circles. */
static int32_t locate(const planar* g, uint32_t point, int32_t from, int* on)
{
  int32_t at = from;
  for (size_t step = 0; step < 2 * g->triangle_count + 16 && at != NOWHERE; ++step)
  {
    const triangle* const t = g->triangles + at;
    int out = NOWHERE;
    *on = NOWHERE;
    for (int k = 0; k < 3 && out == NOWHERE; ++k)
    {
      const int i = (int)((size_t)k + step) % 3;
      const double area = area_at(g, t->v[(i + 1) % 3], t->v[(i + 2) % 3], point);
      out = area < 0 ? i : NOWHERE;
      *on = area == 0 ? i : *on;
    }
    if (out == NOWHERE)
    {
      return at;
    }
    at = t->n[out];
  }
  for (size_t i = 0; i < g->triangle_count; ++i)
  {
    const triangle* const t = g->triangles + i;
    int holds = 1;
    *on = NOWHERE;
    for (int k = 0; k < 3 && holds; ++k)
    {
      const double area = area_at(g, t->v[(k + 1) % 3], t->v[(k + 2) % 3], point);
      holds = area >= 0;
      *on = area == 0 ? k : *on;
    }
    if (holds)
    {
      return (int32_t)i;
    }
  }
  return NOWHERE;
}

static int32_t insert(planar* g, uint32_t point, int32_t from)
{
  int on;
  const int32_t a = locate(g, point, from, &on);
  if (a == NOWHERE)
  {
    return NOWHERE;
  }
  const int32_t b = (int32_t)g->triangle_count, c = b + 1;
  const triangle t = g->triangles[a];
  g->triangle_count += 2;
  g->triangles[a] = (triangle){ { t.v[0], t.v[1], point }, { b, c, t.n[2] }, 0, 0 };
  g->triangles[b] = (triangle){ { t.v[1], t.v[2], point }, { c, a, t.n[0] }, 0, 0 };
  g->triangles[c] = (triangle){ { t.v[2], t.v[0], point }, { a, b, t.n[1] }, 0, 0 };
  replace_neighbour(g, t.n[0], a, b);
  replace_neighbour(g, t.n[1], a, c);
  note(g, a);
  note(g, b);
  note(g, c);
  if (on != NOWHERE) /* the flat one of the three is turned away */
  {
    turn(g, on == 0 ? b : on == 1 ? c : a, 2);
  }
  return a;
}

/* The triangle with the side from a to b, and the corner that lies opposite; NOWHERE: none. */
static int32_t find_side(const planar* g, uint32_t a, uint32_t b, int* opposite)
{
  const int32_t start = g->at[a];
  int32_t t = start;
  do
  {
    const int k = corner_of(g->triangles + t, a);
    if (g->triangles[t].v[(k + 1) % 3] == b)
    {
      *opposite = (k + 2) % 3;
      return t;
    }
    t = g->triangles[t].n[(k + 1) % 3];
  } while (t != start && t != NOWHERE);
  /* at the box's rim, whose corners have no triangles all around, the other way too */
  for (t = t == NOWHERE ? start : NOWHERE; t != NOWHERE;)
  {
    const int k = corner_of(g->triangles + t, a);
    if (g->triangles[t].v[(k + 1) % 3] == b)
    {
      *opposite = (k + 2) % 3;
      return t;
    }
    t = g->triangles[t].n[(k + 2) % 3];
  }
  return NOWHERE;
}

static void fix(planar* g, int32_t number, int k)
{
  triangle* const t = g->triangles + number;
  triangle* const u = g->triangles + t->n[k];
  t->fixed |= (uint8_t)(1 << k);
  u->fixed |= (uint8_t)(1 << side_to(u, number));
}

/* The sides that the line from a to b crosses, into the queue; NOWHERE: it ends nowhere. */
static int find_crossed(planar* g, uint32_t a, uint32_t b, size_t* count)
{
  const int32_t start = g->at[a];
  int32_t t = start;
  int k;
  for (;;)
  {
    k = corner_of(g->triangles + t, a);
    const uint32_t right = g->triangles[t].v[(k + 1) % 3], left = g->triangles[t].v[(k + 2) % 3];
    if (area_at(g, a, b, right) < 0 && area_at(g, a, b, left) > 0 && area_at(g, right, left, b) < 0)
    {
      break;
    }
    t = g->triangles[t].n[(k + 1) % 3];
    if (t == start || t == NOWHERE)
    {
      return NOWHERE;
    }
  }
  uint32_t right = g->triangles[t].v[(k + 1) % 3], left = g->triangles[t].v[(k + 2) % 3];
  for (*count = 0; *count < g->triangle_count;)
  {
    g->queue[(*count)++] = (side){ right, left };
    const int32_t next = g->triangles[t].n[k];
    const triangle* const u = g->triangles + next;
    const uint32_t beyond = u->v[side_to(u, t)];
    if (beyond == b)
    {
      return 0;
    }
    if (area_at(g, a, b, beyond) > 0)
    {
      k = corner_of(u, left);
      left = beyond;
    }
    else
    {
      k = corner_of(u, right);
      right = beyond;
    }
    t = next;
  }
  return NOWHERE;
}

/* 0: done. */
static int force(planar* g, const side* s)
{
  int k;
  int32_t t = find_side(g, s->from, s->to, &k);
  if (t != NOWHERE)
  {
    fix(g, t, k);
    return 0;
  }
  size_t count = 0, at = 0;
  const size_t room = g->queue_room;
  if (find_crossed(g, s->from, s->to, &count) == NOWHERE)
  {
    return NOWHERE;
  }
  for (size_t step = 0, most = 64 + 8 * count * count; count > 0 && step < most; ++step)
  {
    const side crossed = g->queue[at];
    at = at + 1 < room ? at + 1 : 0;
    --count;
    t = find_side(g, crossed.from, crossed.to, &k);
    side put = crossed;
    int is_left_over = 1;
    if (t == NOWHERE)
    {
      return NOWHERE;
    }
    if (can_turn(g, t, k))
    {
      turn(g, t, k);
      put = (side){ g->triangles[t].v[0], g->triangles[t].v[2] }; /* the other diagonal */
      is_left_over = put.from != s->from && put.from != s->to && put.to != s->from &&
        put.to != s->to &&
        (area_at(g, s->from, s->to, put.from) > 0) != (area_at(g, s->from, s->to, put.to) > 0);
    }
    if (is_left_over)
    {
      const size_t end = at + count;
      g->queue[end < room ? end : end - room] = put;
      ++count;
    }
  }
  t = find_side(g, s->from, s->to, &k);
  if (t == NOWHERE)
  {
    return NOWHERE;
  }
  fix(g, t, k);
  return 0;
}

static double length_of(const planar* g, uint32_t a, uint32_t b)
{
  return hypot(g->x[a][0] - g->x[b][0], g->x[a][1] - g->x[b][1]);
}

/* The sum of lengths falls with every turn, so this ends. */
static void shorten(planar* g, uint32_t first_of_box)
{
  int turned = 1;
  for (int pass = 0; pass < MOST_PASSES && turned; ++pass)
  {
    turned = 0;
    for (size_t i = 0; i < 3 * g->triangle_count; ++i)
    {
      const int32_t number = (int32_t)(i / 3);
      const int k = (int)(i % 3);
      const triangle* const t = g->triangles + number;
      if (t->n[k] == NOWHERE || t->fixed >> k & 1)
      {
        continue;
      }
      const triangle* const u = g->triangles + t->n[k];
      const uint32_t a = t->v[k], b = t->v[(k + 1) % 3], c = t->v[(k + 2) % 3],
                     d = u->v[side_to(u, number)];
      const int is_of_box =
        a >= first_of_box || b >= first_of_box || c >= first_of_box || d >= first_of_box;
      if (!is_of_box && length_of(g, a, d) < length_of(g, b, c) && can_turn(g, number, k))
      {
        turn(g, number, k);
        turned = 1;
      }
    }
  }
}

/* From a corner of the box inwards; the queue is a stack here. */
static void tell_apart(planar* g, uint32_t first_of_box)
{
  enum
  {
    SEEN = 2
  };
  size_t open = 0;
  const int32_t start = g->at[first_of_box];
  g->triangles[start].inside = SEEN;
  g->queue[open++].from = (uint32_t)start;
  while (open > 0)
  {
    const triangle* const t = g->triangles + g->queue[--open].from;
    for (int k = 0; k < 3; ++k)
    {
      triangle* const u = t->n[k] == NOWHERE ? NULL : g->triangles + t->n[k];
      if (u && !(u->inside & SEEN))
      {
        u->inside = (uint8_t)(SEEN | ((t->inside & 1) ^ (t->fixed >> k & 1)));
        g->queue[open++].from = (uint32_t)t->n[k];
      }
    }
  }
}

/* The box's corners are far enough off not to lie on any line between others. */
static int add_box(planar* g)
{
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY }, most = 0;
  for (size_t i = 0; i < g->side_count; ++i)
  {
    for (int k = 0; k < 4; ++k)
    {
      const double v = g->x[k & 1 ? g->sides[i].from : g->sides[i].to][k / 2];
      low[k / 2] = fmin(low[k / 2], v);
      high[k / 2] = fmax(high[k / 2], v);
      most = fmax(most, fabs(v));
    }
  }
  const double w = fmax(high[0] - low[0], high[1] - low[1]) + most * 0x1p-10;
  const uint32_t n = (uint32_t)g->points;
  if (!ROOM(g, x, point_room, g->points + BOX) || !ROOM(g, at, at_room, g->points + BOX) ||
    !ROOM(g, triangles, triangle_room, 2 * (g->points + BOX)) ||
    !ROOM(g, queue, queue_room, 2 * (g->points + BOX)))
  {
    return 0;
  }
  for (int k = 0; k < BOX; ++k) /* counterclockwise */
  {
    g->x[n + (uint32_t)k][0] = k == 0 || k == 3 ? low[0] - w : high[0] + w;
    g->x[n + (uint32_t)k][1] = k < 2 ? low[1] - w : high[1] + w;
  }
  g->points += BOX;
  g->triangles[0] = (triangle){ { n, n + 1, n + 2 }, { NOWHERE, 1, NOWHERE }, 0, 0 };
  g->triangles[1] = (triangle){ { n, n + 2, n + 3 }, { NOWHERE, NOWHERE, 0 }, 0, 0 };
  g->triangle_count = 2;
  for (size_t i = 0; i < g->points; ++i)
  {
    g->at[i] = NOWHERE;
  }
  note(g, 0);
  note(g, 1);
  return 1;
}

chi_status chi_planar_triangulate(planar* g)
{
  if (!add_box(g))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  const uint32_t first_of_box = (uint32_t)g->points - BOX;
  int32_t last = 0;
  for (size_t i = 0; i < 2 * g->side_count; ++i)
  {
    const uint32_t point = i % 2 ? g->sides[i / 2].to : g->sides[i / 2].from;
    if (g->at[point] == NOWHERE)
    {
      last = insert(g, point, last);
      if (last == NOWHERE)
      {
        return CHI_ERROR_TOO_LARGE;
      }
    }
  }
  for (size_t i = 0; i < g->side_count; ++i)
  {
    if (force(g, g->sides + i) == NOWHERE)
    {
      return CHI_ERROR_TOO_LARGE;
    }
  }
  shorten(g, first_of_box);
  tell_apart(g, first_of_box);
  return CHI_OK;
}
