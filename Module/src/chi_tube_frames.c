/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Frames along the axis of a tube. What a ring needs of its neighbours alone is computed for a
 * block of rings at once; only the normal is carried from ring to ring. */

#include "chi_tube_frames.h"

#include <string.h>

/* Any unit vector across t: from the axis that t follows least. */
static void any_normal(const double t[3], double out[3])
{
  const double a[3] = { fabs(t[0]), fabs(t[1]), fabs(t[2]) };
  double axis[3] = { 0, 0, 0 };
  axis[a[0] <= a[1] && a[0] <= a[2] ? 0 : a[1] <= a[2] ? 1 : 2] = 1;
  chi_cross(t, axis, out);
  chi_normalise(out);
}

/* Take rounding's part along the tangent from a normal and make it a unit vector again. */
static void straighten(const double tangent[3], double normal[3])
{
  const double along = chi_dot(normal, tangent);
  for (int a = 0; a < 3; ++a)
  {
    normal[a] -= along * tangent[a];
  }
  if (!(chi_normalise(normal) > 0.5))
  {
    any_normal(tangent, normal);
  }
}

/* Frenet's normal where the curve bends, on the side of the one carried there. */
static void bend_normal(
  const chi_tube_frames* f, size_t s, const double tangent[3], double normal[3])
{
  const chi_tube_block* const b = &f->block;
  const chi_spline_curve* const c = &f->curve;
  double n[3], x[3][3], scale = 1;
  if (c->degree == 1)
  {
    for (int a = 0; a < 3; ++a)
    {
      n[a] = b->after[a][s] - b->before[a][s];
    }
  }
  else
  {
    chi_spline_evaluate(c, f->ring[f->first + s - 1].u, 2, x);
    memcpy(n, x[2], sizeof n);
    scale = chi_dot(x[1], x[1]);
  }
  /* Below, the direction is rounding: a turn of less than 1e-9 over the curve, or what the
   * tangent's part leaves of a far longer vector. */
  const double least = fmax(1e-9 * sqrt(scale), 1e-12 * sqrt(chi_dot(n, n)));
  const double along = chi_dot(n, tangent);
  for (int a = 0; a < 3; ++a)
  {
    n[a] -= along * tangent[a];
  }
  if (!(chi_normalise(n) > least))
  {
    return;
  }
  straighten(tangent, n);
  const double side = chi_dot(n, normal) < 0 ? -1 : 1;
  for (int a = 0; a < 3; ++a)
  {
    normal[a] = side * n[a];
  }
}

static void put(double field[3][CHI_TUBE_SLOTS], size_t s, const double x[3])
{
  for (int a = 0; a < 3; ++a)
  {
    field[a][s] = x[a];
  }
}

static void copy_slot(chi_tube_block* b, size_t from, size_t to)
{
  for (int a = 0; a < 3; ++a)
  {
    b->x[a][to] = b->x[a][from];
    b->before[a][to] = b->before[a][from];
    b->after[a][to] = b->after[a][from];
    b->tangent[a][to] = b->tangent[a][from];
    b->stretch[a][to] = b->stretch[a][from];
    b->normal[a][to] = b->normal[a][from];
  }
  b->widening[to] = b->widening[from];
  b->radius[to] = b->radius[from];
  b->chord[to] = b->chord[from];
}

/* A ring anywhere on any curve: everything but its normal. */
static void place_one(chi_tube_frames* f, size_t s, const chi_tube_ring* ring)
{
  chi_tube_block* const b = &f->block;
  const chi_spline_curve* const c = &f->curve;
  double x[3], before[3], after[3], tangent[3], stretch[3] = { 0, 0, 0 };
  const int side = c->degree == 1 ? ring->side : 0;
  chi_tube_axis(c, ring, x);
  chi_tube_tangents(c, ring->u, before, after);
  memcpy(tangent, side < 0 ? before : after, sizeof tangent);
  b->widening[s] = 0;
  const double sum[3] = { before[0] + after[0], before[1] + after[1], before[2] + after[2] };
  const double half = 0.5 * sqrt(chi_dot(sum, sum));
  if (side == 0 && c->degree == 1 && half >= 1e-6)
  {
    for (int a = 0; a < 3; ++a)
    {
      tangent[a] = sum[a] * (0.5 / half);
      stretch[a] = after[a] - before[a];
    }
    const double square = chi_dot(stretch, stretch);
    b->widening[s] = square > 1e-28 ? (1 / fmax(half, 0.6) - 1) / square : 0;
  }
  put(b->x, s, x);
  put(b->before, s, before);
  put(b->after, s, after);
  put(b->tangent, s, tangent);
  put(b->stretch, s, stretch);
}

/* Rings that are the points of a polyline, slots from ... to. */
static void place_points(chi_tube_frames* f, size_t from, size_t to)
{
  chi_tube_block* const b = &f->block;
  const chi_spline_curve* const c = &f->curve;
  const size_t point = f->placed, points = c->count;
  const double* const x = c->coefficients + 3 * point;
  const size_t known = point + (to - from + 1) < points ? to + 1 : to;
  for (size_t s = from; s <= known; ++s)
  {
    for (size_t a = 0; a < 3; ++a)
    {
      b->x[a][s] = x[3 * (s - from) + a];
    }
  }
  if (known == to)
  {
    put(b->x, to + 1, c->coefficients + (c->closed ? 3 : 3 * (points - 2)));
  }
  if (point == 0)
  {
    /* the direction before the first ring, where the block looks for it */
    const double* const last = c->closed ? x + 3 * (points - 2) : x;
    const double* const next = c->closed ? x : x + 3;
    double direction[3] = { next[0] - last[0], next[1] - last[1], next[2] - last[2] };
    chi_normalise(direction);
    put(b->after, from - 1, direction);
  }
  f->kernels->place(b, from, to);
  if (known == to && !c->closed)
  {
    double before[3];
    chi_tube_slot(b->before, to, before);
    put(b->after, to, before);
    put(b->tangent, to, before);
    b->widening[to] = 0;
  }
}

/* Two rings at one corner: the least rotation; none at all for a reversal, where the normal is
 * perpendicular to both tangents already. */
static void turn_on_the_spot(chi_tube_block* b, size_t s)
{
  double from[3], to[3];
  chi_tube_slot(b->tangent, s - 1, from);
  chi_tube_slot(b->tangent, s, to);
  const double sum = 1 + chi_dot(from, to);
  const double f = sum > 1e-12 ? 1 / sum : 0;
  for (size_t i = 0; i < 3; ++i)
  {
    for (size_t j = 0; j < 3; ++j)
    {
      b->turn[3 * i + j][s] = (i == j ? 1.0 : 0.0) - f * (from[i] + to[i]) * to[j];
    }
  }
}

/* Carry the normal through slots from ... to. A rotation of rounded entries loses 1e-16 a ring,
 * 1e-8 at a reversal, so that once a block is often enough to restore length and right angle. */
static void carry_normals(chi_tube_frames* f, size_t from, size_t to)
{
  chi_tube_block* const b = &f->block;
  double n[3];
  chi_tube_slot(b->normal, from - 1, n);
  const int frenet = f->tube->frame == CHI_TUBE_FRENET;
  for (size_t s = from; s <= to; ++s)
  {
    double next[3], tangent[3];
    for (size_t i = 0; i < 3; ++i)
    {
      next[i] =
        b->turn[3 * i][s] * n[0] + b->turn[3 * i + 1][s] * n[1] + b->turn[3 * i + 2][s] * n[2];
    }
    memcpy(n, next, sizeof n);
    if (s == to || frenet)
    {
      chi_tube_slot(b->tangent, s, tangent);
      straighten(tangent, n);
    }
    if (frenet)
    {
      bend_normal(f, s, tangent, n);
    }
    put(b->normal, s, n);
  }
}

/* Place and turn the rings of slots from ... to. */
static void fill(chi_tube_frames* f, size_t from, size_t to)
{
  chi_tube_block* const b = &f->block;
  const chi_tube_ring* const ring = f->ring + f->placed;
  for (size_t s = from; s <= to; ++s)
  {
    b->radius[s] = (double)ring[s - from].radius;
  }
  if (f->direct)
  {
    place_points(f, from, to);
  }
  else
  {
    for (size_t s = from; s <= to; ++s)
    {
      place_one(f, s, &ring[s - from]);
    }
  }
  if (f->placed == 0)
  {
    double tangent[3], normal[3];
    chi_tube_slot(b->tangent, from, tangent);
    any_normal(tangent, normal);
    if (f->tube->frame == CHI_TUBE_FRENET)
    {
      bend_normal(f, from, tangent, normal);
    }
    put(b->normal, from, normal);
    b->radius[from - 1] = b->radius[from];
    b->chord[from] = 0;
    ++from;
  }
  f->kernels->turns(b, from, to);
  for (size_t s = from; s <= to; ++s)
  {
    if (!(b->chord[s] > 0))
    {
      turn_on_the_spot(b, s);
    }
  }
  carry_normals(f, from, to);
}

void chi_tube_frames_start(
  chi_tube_frames* f, const chi_tube_kernels* kernels, const chi_tube* t, size_t line)
{
  f->tube = t;
  f->kernels = kernels;
  chi_spline_get_curve(t->spline, line, &f->curve);
  f->ring = t->ring + t->line[line].ring_start;
  f->rings = t->line[line].ring_count;
  f->first = f->count = f->placed = 0;
  f->direct = t->keep_rings && f->curve.degree == 1 && f->curve.count == f->rings &&
    f->curve.count == f->curve.point_count;
}

size_t chi_tube_frames_next(chi_tube_frames* f)
{
  chi_tube_block* const b = &f->block;
  f->first += f->count;
  if (f->first >= f->rings)
  {
    return 0;
  }
  if (f->count > 0)
  {
    copy_slot(b, f->count, 0);
    copy_slot(b, f->count + 1, 1);
  }
  f->count = f->rings - f->first < CHI_TUBE_BLOCK ? f->rings - f->first : CHI_TUBE_BLOCK;
  const size_t wanted = f->first + f->count + (f->first + f->count < f->rings);
  if (f->placed < wanted)
  {
    fill(f, f->placed - f->first + 1, wanted - f->first);
    f->placed = wanted;
  }
  if (wanted == f->first + f->count)
  {
    b->radius[f->count + 1] = b->radius[f->count];
    b->chord[f->count + 1] = 0;
  }
  return f->count;
}
