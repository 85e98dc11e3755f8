/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The inside of closed lines, by the rule of even and odd, as triangles that share whole sides.
 * First the lines are cut where they cross or touch, and pieces that lie on one another cancel; a
 * crossing is rounded to double, which moves its lines by a unit in the last place, so that this is
 * done again until nothing crosses. Then a box is triangulated with all corners, the pieces are
 * forced in by turning diagonals, and the triangles are told apart from without. All signs are
 * exact. Source: Sloan, "A fast algorithm for generating constrained Delaunay triangulations",
 * 1993 (forcing sides in). Diagonals are turned to the shorter one in the end, which
 * is all that shape is asked for here.
 */

#include "chi_fiber_internal.h"

#include <math.h>
#include <stdlib.h>

enum
{
  MOST_ROUNDS = 64, /* of cutting: two or three happen */
  MOST_PASSES = 64, /* of turning diagonals */
  BOX = 4,          /* corners around all others */
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
static int make_room(const chi_exec* exec, void* of, size_t* room, size_t count, size_t size)
{
  void* old;
  memcpy(&old, of, sizeof old);
  if (count <= *room)
  {
    return 1;
  }
  const size_t more = count + count / 2 + 16;
  void* const block = chi_alloc(exec, more, size);
  if (!block)
  {
    return 0;
  }
  if (old)
  {
    memcpy(block, old, *room * size);
    chi_free(exec, old, *room, size);
  }
  memcpy(of, &block, sizeof block);
  *room = more;
  return 1;
}

#define ROOM(g, array, room, count)                                                                \
  make_room((g)->exec, &(g)->array, &(g)->room, count, sizeof *(g)->array)

static void drop(planar* g)
{
  void* const blocks[] = { g->x, g->sides, g->cuts, g->triangles, g->at, g->queue };
  const size_t bytes[] = { g->point_room * sizeof *g->x, g->side_room * sizeof *g->sides,
    g->cut_room * sizeof *g->cuts, g->triangle_room * sizeof *g->triangles,
    g->at_room * sizeof *g->at, g->queue_room * sizeof *g->queue };
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; ++i)
  {
    if (blocks[i])
    {
      chi_free(g->exec, blocks[i], bytes[i], 1);
    }
  }
}

/* ---- lines cut where they meet ---- */

static uint32_t low_of(const side* s)
{
  return s->from < s->to ? s->from : s->to;
}

static uint32_t high_of(const side* s)
{
  return s->from < s->to ? s->to : s->from;
}

static int compare_sides(const void* a, const void* b)
{
  const side *const s = (const side*)a, *const t = (const side*)b;
  const uint32_t low[2] = { low_of(s), low_of(t) }, high[2] = { high_of(s), high_of(t) };
  if (low[0] != low[1])
  {
    return low[0] < low[1] ? -1 : 1;
  }
  if (high[0] != high[1])
  {
    return high[0] < high[1] ? -1 : 1;
  }
  return (s->from > t->from) - (s->from < t->from);
}

static int is_same_side(const side* s, const side* t)
{
  return low_of(s) == low_of(t) && high_of(s) == high_of(t);
}

/* Pieces that lie on one another, an even number of them, are none. */
static void cancel(planar* g)
{
  size_t kept = 0;
  qsort(g->sides, g->side_count, sizeof *g->sides, compare_sides);
  for (size_t i = 0; i < g->side_count;)
  {
    size_t end = i + 1;
    for (; end < g->side_count && is_same_side(g->sides + i, g->sides + end); ++end)
    {
    }
    if ((end - i) % 2 && g->sides[i].from != g->sides[i].to)
    {
      g->sides[kept++] = g->sides[i];
    }
    i = end;
  }
  g->side_count = kept;
}

static int sign_of(double x)
{
  return (x > 0) - (x < 0);
}

static int is_between(const double a[2], const double b[2], const double x[2])
{
  for (int k = 0; k < 2; ++k)
  {
    const double low = a[k] < b[k] ? a[k] : b[k], high = a[k] < b[k] ? b[k] : a[k];
    if (!(x[k] >= low && x[k] <= high))
    {
      return 0;
    }
  }
  return 1;
}

static int add_cut(planar* g, size_t number, uint32_t point)
{
  const side* const s = g->sides + number;
  if (point == s->from || point == s->to)
  {
    return 1;
  }
  if (!ROOM(g, cuts, cut_room, g->cut_count + 1))
  {
    return 0;
  }
  const double *const p = g->x[s->from], *const q = g->x[s->to], *const x = g->x[point];
  const double along = (q[0] - p[0]) * (x[0] - p[0]) + (q[1] - p[1]) * (x[1] - p[1]);
  g->cuts[g->cut_count++] = (cut_at){ (uint32_t)number, point, along };
  return 1;
}

/* The number of a point, perhaps a new one; UINT32_MAX: refused. */
static uint32_t point_at(planar* g, const double x[2])
{
  for (size_t i = 0; i < g->points; ++i)
  {
    if (g->x[i][0] == x[0] && g->x[i][1] == x[1])
    {
      return (uint32_t)i;
    }
  }
  if (g->points >= CHI_FIBER_AT_CORNER || !ROOM(g, x, point_room, g->points + 1))
  {
    return UINT32_MAX;
  }
  memcpy(g->x[g->points], x, sizeof *g->x);
  return (uint32_t)g->points++;
}

/* Note where two pieces meet otherwise than in their ends; 0: memory is refused. */
static int meet(planar* g, size_t i, size_t j)
{
  const side s = g->sides[i], t = g->sides[j];
  const double *const a = g->x[s.from], *const b = g->x[s.to], *const c = g->x[t.from],
                      *const d = g->x[t.to];
  const double of_c = chi_fiber_area(a, b, c), of_d = chi_fiber_area(a, b, d);
  const double of_a = chi_fiber_area(c, d, a), of_b = chi_fiber_area(c, d, b);
  if (sign_of(of_c) * sign_of(of_d) < 0 && sign_of(of_a) * sign_of(of_b) < 0)
  {
    const double along = fabs(of_a) / (fabs(of_a) + fabs(of_b));
    const double x[2] = { a[0] + along * (b[0] - a[0]) + 0.0, a[1] + along * (b[1] - a[1]) + 0.0 };
    const uint32_t point = point_at(g, x);
    return point != UINT32_MAX && add_cut(g, i, point) && add_cut(g, j, point);
  }
  const int fine = (of_c != 0 || !is_between(a, b, c) || add_cut(g, i, t.from)) &&
    (of_d != 0 || !is_between(a, b, d) || add_cut(g, i, t.to));
  return fine && (of_a != 0 || !is_between(c, d, a) || add_cut(g, j, s.from)) &&
    (of_b != 0 || !is_between(c, d, b) || add_cut(g, j, s.to));
}

static int compare_cuts(const void* a, const void* b)
{
  const cut_at *const p = (const cut_at*)a, *const q = (const cut_at*)b;
  if (p->side != q->side)
  {
    return p->side < q->side ? -1 : 1;
  }
  if (p->along != q->along)
  {
    return p->along < q->along ? -1 : 1;
  }
  return (p->point > q->point) - (p->point < q->point);
}

static int cut_sides(planar* g)
{
  const size_t before = g->side_count;
  qsort(g->cuts, g->cut_count, sizeof *g->cuts, compare_cuts);
  if (!ROOM(g, sides, side_room, before + g->cut_count))
  {
    return 0;
  }
  for (size_t i = 0; i < g->cut_count;)
  {
    side* const s = g->sides + g->cuts[i].side;
    const uint32_t last = s->to;
    s->to = g->cuts[i].point;
    uint32_t from = s->to;
    const uint32_t number = g->cuts[i].side;
    for (++i; i < g->cut_count && g->cuts[i].side == number; ++i)
    {
      if (g->cuts[i].point != from)
      {
        g->sides[g->side_count++] = (side){ from, g->cuts[i].point };
        from = g->cuts[i].point;
      }
    }
    g->sides[g->side_count++] = (side){ from, last };
  }
  return 1;
}

typedef struct span
{
  double low, high;
  size_t side;
} span;

static int compare_spans(const void* a, const void* b)
{
  const span *const p = (const span*)a, *const q = (const span*)b;
  return p->low != q->low ? (p->low < q->low ? -1 : 1) : (p->side > q->side) - (p->side < q->side);
}

/* All meetings of pieces whose ranges along the first axis overlap. */
static chi_status find_meetings(planar* g)
{
  const size_t count = g->side_count;
  span* const spans = (span*)chi_alloc(g->exec, count + 1, sizeof *spans);
  if (!spans)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < count; ++i)
  {
    const double a = g->x[g->sides[i].from][0], b = g->x[g->sides[i].to][0];
    spans[i] = (span){ a < b ? a : b, a < b ? b : a, i };
  }
  qsort(spans, count, sizeof *spans, compare_spans);
  chi_status status = CHI_OK;
  for (size_t i = 0; i < count && status == CHI_OK; ++i)
  {
    for (size_t j = i + 1; j < count && spans[j].low <= spans[i].high && status == CHI_OK; ++j)
    {
      status = meet(g, spans[i].side, spans[j].side) ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
    }
    status = i % 64 == 0 && chi_is_cancelled(g->exec) ? CHI_ERROR_CANCELLED : status;
  }
  chi_free(g->exec, spans, count + 1, sizeof *spans);
  return status;
}

static chi_status arrange(planar* g)
{
  for (int round = 0; round < MOST_ROUNDS; ++round)
  {
    cancel(g);
    g->cut_count = 0;
    const chi_status status = find_meetings(g);
    if (status != CHI_OK || g->cut_count == 0)
    {
      return status;
    }
    if (!cut_sides(g))
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
  }
  return CHI_ERROR_TOO_LARGE;
}

/* ---- the triangulation ---- */

static double area_at(const planar* g, uint32_t a, uint32_t b, uint32_t c)
{
  return chi_fiber_area(g->x[a], g->x[b], g->x[c]);
}

static int side_to(const triangle* t, int32_t neighbour)
{
  return t->n[0] == neighbour ? 0 : t->n[1] == neighbour ? 1 : 2;
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

static chi_status triangulate(planar* g)
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

/* ---- as a polygon of its sides ---- */

static chi_status write_pieces(const chi_exec* exec, chi_fiber_pieces* pieces, const planar* g)
{
  size_t inner = 0;
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    inner += g->triangles[t].inside & 1;
  }
  chi_fiber_polygon* const polygon = &pieces->polygon;
  if (!chi_buffer_reserve(exec, &polygon->segments, 3 * inner + 1, sizeof *polygon->segment) ||
    !chi_buffer_reserve(exec, &polygon->corner_buffer, g->points + 1, sizeof *polygon->corner) ||
    !chi_buffer_reserve(exec, &pieces->triangle_buffer, inner + 1, sizeof *pieces->triangle) ||
    !chi_buffer_reserve(exec, &pieces->beside_buffer, 3 * inner + 1, sizeof *pieces->beside) ||
    !chi_buffer_reserve(exec, &polygon->order, 4 * g->triangle_count + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  polygon->segment = (chi_fiber_segment*)polygon->segments.data;
  polygon->corner = (chi_fiber_corner*)polygon->corner_buffer.data;
  pieces->triangle = (chi_fiber_triangle*)pieces->triangle_buffer.data;
  pieces->beside = (int32_t(*)[2])pieces->beside_buffer.data;
  uint32_t* const of_side = (uint32_t*)polygon->order.data; /* [triangles x 3] segments */
  uint32_t* const number = of_side + 3 * g->triangle_count; /* [triangles] of those inside */
  for (size_t i = 0; i < g->points; ++i)
  {
    polygon->corner[i] = (chi_fiber_corner){ { g->x[i][0], g->x[i][1] }, 1 };
  }
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    if (g->triangles[t].inside & 1)
    {
      number[t] = (uint32_t)pieces->triangles++;
    }
  }
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    const triangle* const own = g->triangles + t;
    chi_fiber_triangle* const out = pieces->triangle + (own->inside & 1 ? number[t] : 0);
    for (int k = 0; k < 3 && own->inside & 1; ++k)
    {
      /* side k of a piece runs from its corner k to the next */
      const int opposite = (k + 2) % 3;
      const int32_t other = own->n[opposite];
      const int is_shared = other != NOWHERE && g->triangles[other].inside & 1;
      uint32_t from = own->v[k], to = own->v[(k + 1) % 3];
      uint32_t* const here = of_side + 3 * t + (size_t)opposite;
      if (is_shared && (size_t)other < t)
      {
        *here = of_side[3 * (size_t)other + (size_t)side_to(g->triangles + other, (int32_t)t)];
      }
      else
      {
        const side key = { from, to }, reversed = { to, from };
        const int runs_back = own->fixed >> opposite & 1 &&
          !bsearch(&key, g->sides, g->side_count, sizeof key, compare_sides) &&
          bsearch(&reversed, g->sides, g->side_count, sizeof key, compare_sides);
        from = runs_back ? reversed.from : from;
        to = runs_back ? reversed.to : to;
        *here = (uint32_t)polygon->count++;
        chi_fiber_segment* const s = polygon->segment + *here;
        *s = chi_fiber_make_segment(polygon->corner, from, to);
        s->is_closed = (uint8_t)!is_shared;
        s->id = *here;
        pieces->beside[*here][0] = pieces->beside[*here][1] = NOWHERE;
      }
      const int is_flipped = polygon->segment[*here].corner[0] != own->v[k];
      pieces->beside[*here][is_flipped] = (int32_t)number[t];
      out->corner[k] = own->v[k];
      out->segment[k] = *here;
      out->is_flipped[k] = (uint8_t)is_flipped;
    }
  }
  polygon->corners = g->points;
  return CHI_OK;
}

/* Sides between the starts of segments that follow one another in a closed line: what was left out
 * in between, since it had no length, leaves no gap. */
static int read_sides(planar* g, const chi_fiber_polygon* lines)
{
  if (!ROOM(g, x, point_room, lines->corners + 1) || !ROOM(g, sides, side_room, lines->count + 1))
  {
    return 0;
  }
  for (size_t i = 0; i < lines->corners; ++i)
  {
    memcpy(g->x[i], lines->corner[i].x, sizeof *g->x);
  }
  g->points = lines->corners;
  for (size_t first = 0, end; first < lines->count; first = end)
  {
    const chi_fiber_segment* const s = lines->segment;
    for (end = first + 1; end < lines->count && s[end].line == s[first].line; ++end)
    {
    }
    for (size_t i = first; i < end && s[i].is_closed; ++i)
    {
      g->sides[g->side_count++] =
        (side){ s[i].corner[0], s[i + 1 < end ? i + 1 : first].corner[0] };
    }
  }
  return 1;
}

chi_status chi_fiber_pieces_make(
  const chi_exec* exec, chi_fiber_pieces* pieces, const chi_fiber_polygon* lines)
{
  planar g = { .exec = exec };
  pieces->triangles = 0;
  pieces->polygon.count = pieces->polygon.corners = 0;
  chi_status status = read_sides(&g, lines) ? arrange(&g) : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK && g.side_count > 0)
  {
    status = triangulate(&g);
    status = status == CHI_OK ? write_pieces(exec, pieces, &g) : status;
  }
  drop(&g);
  return status;
}

void chi_fiber_pieces_free(const chi_exec* exec, chi_fiber_pieces* pieces)
{
  chi_fiber_polygon_free(exec, &pieces->polygon);
  chi_buffer_free(exec, &pieces->triangle_buffer);
  chi_buffer_free(exec, &pieces->beside_buffer);
}
