/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Closed lines cut where they cross or touch; pieces that lie on one another cancel, by the rule of
 * even and odd. A crossing is rounded to double, which moves its lines by a unit in the last place,
 * so that this is done again until nothing crosses. All signs are exact.
 */

#include "chi_fiber_planar.h"

#include <math.h>
#include <stdlib.h>

enum
{
  MOST_ROUNDS = 64 /* of cutting: two or three happen */
};

/* Room for `count`; 0: refused. */
int chi_planar_make_room(const chi_exec* exec, void* of, size_t* room, size_t count, size_t size)
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

static uint32_t low_of(const side* s)
{
  return s->from < s->to ? s->from : s->to;
}

static uint32_t high_of(const side* s)
{
  return s->from < s->to ? s->to : s->from;
}

int chi_planar_compare_sides(const void* a, const void* b)
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
  qsort(g->sides, g->side_count, sizeof *g->sides, chi_planar_compare_sides);
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

chi_status chi_planar_arrange(planar* g)
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
