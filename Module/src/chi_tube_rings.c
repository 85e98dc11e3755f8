/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Where the rings of one line lie: as few as its tolerances allow. */

#include "chi_tube_rings.h"

enum
{
  MAX_PIECES = 256, /* of one knot span; a turn of 360 degrees at 1.4 degrees a ring */
  FINENESS = 16     /* the longest step is found to this fraction of it */
};

typedef chi_ring_candidate candidate;

/* One line on its way. */
typedef struct ring_job
{
  const chi_ring_rules* rules;
  const chi_spline_curve* curve;
  size_t line;
  chi_ring_lists* lists;
  chi_ring_choice* choice;
} ring_job;

/* Room for one more item behind `count`; 0 when memory was refused. */
static int grow(
  const chi_exec* exec, void** item, size_t count, size_t* capacity, size_t size, size_t least)
{
  if (count < *capacity)
  {
    return 1;
  }
  const size_t wanted = *capacity ? 2 * *capacity : least;
  void* const grown = chi_alloc(exec, wanted, size);
  if (!grown)
  {
    return 0;
  }
  if (*item)
  {
    memcpy(grown, *item, count * size);
    chi_free(exec, *item, *capacity, size);
  }
  *item = grown;
  *capacity = wanted;
  return 1;
}

void chi_ring_lists_release(const chi_exec* exec, chi_ring_lists* l)
{
  if (l->candidate)
  {
    chi_free(exec, l->candidate, l->candidate_capacity, sizeof *l->candidate);
  }
  if (l->ring)
  {
    chi_free(exec, l->ring, l->ring_capacity, sizeof *l->ring);
  }
  memset(l, 0, sizeof *l);
}

static int add_candidate(ring_job* job, const candidate* item)
{
  chi_ring_lists* const l = job->lists;
  void* list = l->candidate;
  const int fits =
    grow(job->rules->exec, &list, l->candidates, &l->candidate_capacity, sizeof *l->candidate, 256);
  l->candidate = (candidate*)list;
  if (fits)
  {
    l->candidate[l->candidates++] = *item;
  }
  return fits;
}

static int add_ring(ring_job* job, const candidate* item)
{
  chi_ring_lists* const l = job->lists;
  void* list = l->ring;
  const int fits = grow(job->rules->exec, &list, l->rings, &l->ring_capacity, sizeof *l->ring, 512);
  l->ring = (chi_tube_ring*)list;
  if (fits)
  {
    l->ring[l->rings++] = item->ring;
    ++job->choice->rings;
    job->choice->clamped += (size_t)item->clamped;
  }
  return fits;
}

/* Largest radius that does not fold the surface. On a spline just below 1 / curvature; at a corner
 * what leaves the mitre within the shorter of its two segments. */
static double radius_limit(const chi_spline_curve* c, const candidate* at)
{
  if (c->degree == 3)
  {
    const double curvature = sqrt(chi_dot(at->bend, at->bend));
    return curvature > 0 ? 0.999 / curvature : INFINITY;
  }
  const size_t span = chi_spline_span(c, at->ring.u, 1);
  const double cosine = chi_dot(at->before, at->tangent);
  if (at->ring.u != c->knots[span] || cosine > 1 - 1e-12 || cosine < CHI_TUBE_MITRE_COSINE)
  {
    return INFINITY;
  }
  const size_t i = span - 1, previous = i > 0 ? i - 1 : c->count - 2;
  const double left = chi_distance(c->coefficients + 3 * i, c->coefficients + 3 * previous);
  const double right = chi_distance(c->coefficients + 3 * i, c->coefficients + 3 * (i + 1));
  return fmin(left, right) / sqrt((1 - cosine) / (1 + cosine)); /* tan of half the turn */
}

/* Everything about a place on the axis; 0 where the curve has no direction. */
static int place(ring_job* job, double u, size_t hint, candidate* at)
{
  const chi_spline_curve* const c = job->curve;
  double x[3][3];
  memset(at, 0, sizeof *at);
  at->ring.u = u;
  at->source = chi_tube_source(c, u, hint, &at->weight);
  chi_spline_evaluate(c, u, c->degree == 3 ? 2 : 1, x);
  memcpy(at->x, x[0], sizeof at->x);
  memcpy(at->axis, x[0], sizeof at->axis);
  memcpy(at->tangent, x[1], sizeof at->tangent);
  if (c->degree == 3 && chi_normalise(at->tangent) > 0)
  {
    memcpy(at->before, at->tangent, sizeof at->before);
    chi_tube_bend(x[1], x[2], at->bend);
  }
  else if (!chi_tube_tangents(c, u, at->before, at->tangent))
  {
    return 0;
  }
  double radius = chi_tube_radius(job->rules, job->line, c, at->source, at->weight);
  if (!(radius >= 0) || !isfinite(radius))
  {
    job->choice->bad_radius = 1;
    radius = 0;
  }
  if (job->rules->params->limit_radius)
  {
    const double limit = radius_limit(c, at);
    at->clamped = radius > limit;
    radius = at->clamped ? limit : radius;
  }
  at->ring.radius = (float)radius;
  return 1;
}

static int add_place(ring_job* job, double u)
{
  const chi_spline_curve* const c = job->curve;
  const size_t n = job->lists->candidates;
  candidate at;
  if (!place(job, u, n > 0 ? job->lists->candidate[n - 1].source : 0, &at))
  {
    return 1;
  }
  const int closed_end = c->closed && (u == 0 || u >= 1);
  if (c->degree == 3 || chi_dot(at.before, at.tangent) >= CHI_TUBE_MITRE_COSINE || closed_end)
  {
    return add_candidate(job, &at);
  }
  candidate first = at;
  at.keep = first.keep = 1;
  at.ring.side = 1;
  first.ring.side = -1;
  memcpy(first.tangent, first.before, sizeof first.tangent);
  return add_candidate(job, &first) && add_candidate(job, &at);
}

/* Pieces of a knot span so short that none bends more than half of what the tolerances allow. */
static size_t pieces_of(const ring_job* job, double a, double b)
{
  double x[3][2][3], chord[3], turn = 0;
  for (int k = 0; k < 3; ++k)
  {
    chi_spline_evaluate(job->curve, a + 0.5 * k * (b - a), 1, x[k]);
    chi_normalise(x[k][1]);
  }
  for (int k = 0; k < 3; ++k)
  {
    chord[k] = 0.5 * (x[0][0][k] + x[2][0][k]) - x[1][0][k];
  }
  const double off = sqrt(chi_dot(chord, chord));
  for (int k = 0; k < 2; ++k)
  {
    turn += acos(fmin(fmax(chi_dot(x[k][1], x[k + 1][1]), -1), 1)); /* once a span */
  }
  const double by_turn = 2 * turn / job->rules->params->angular_tolerance_rad;
  const double by_chord = 2 * sqrt(off / job->rules->params->chord_tolerance);
  const double pieces = ceil(fmax(fmax(by_turn, by_chord), 1));
  return pieces < MAX_PIECES ? (size_t)pieces : MAX_PIECES;
}

/* Candidates at the input points from *point on, up to u. */
static int add_points(ring_job* job, size_t* point, double u)
{
  const chi_spline_curve* const c = job->curve;
  for (; *point < c->point_count && c->point_parameters[*point] <= u; ++*point)
  {
    const double at = c->point_parameters[*point];
    if (at < u && at > job->lists->candidate[job->lists->candidates - 1].ring.u &&
      !add_place(job, at))
    {
      return 0;
    }
  }
  return 1;
}

static int add_candidates(ring_job* job)
{
  const chi_spline_curve* const c = job->curve;
  const chi_tube_params* const p = job->rules->params;
  job->lists->candidates = 0;
  if (c->degree == 1 || p->keep_rings)
  {
    /* A polyline's points; a chord that stands for many points keeps those for the arrays' sake. */
    for (size_t i = 0; i < c->point_count; ++i)
    {
      if (!add_place(job, c->point_parameters[i]))
      {
        return 0;
      }
    }
    return 1;
  }
  const int by_points = p->attribute_count > 0 || p->point_radius;
  size_t point = 1;
  for (size_t span = 3; span < c->count; ++span)
  {
    const double a = c->knots[span], b = c->knots[span + 1];
    const size_t pieces = a < b ? pieces_of(job, a, b) : 0;
    for (size_t k = 0; k < pieces; ++k)
    {
      const double u = a + (b - a) * ((double)k / (double)pieces);
      const int first = job->lists->candidates == 0;
      if ((by_points && !first && !add_points(job, &point, u)) || !add_place(job, u))
      {
        return 0;
      }
    }
  }
  const int any = job->lists->candidates > 0;
  return (!by_points || !any || add_points(job, &point, 1)) && add_place(job, 1);
}

static double attribute_of(const ring_job* job, const candidate* at, size_t array, size_t component)
{
  const chi_array_view* const a = job->rules->params->attributes[array];
  const chi_lines_view* const lines = job->rules->lines;
  const size_t i = (size_t)chi_tube_point_id(lines, job->line, job->curve, at->source);
  const size_t j = (size_t)chi_tube_point_id(lines, job->line, job->curve, at->source + 1);
  const double first = chi_tube_value(a, i, component), second = chi_tube_value(a, j, component);
  return first + at->weight * (second - first);
}

/* Turn between two unit vectors in units of the angular tolerance, by their chord: exactly 1 where
 * the turn is the tolerance, and without an arc cosine a candidate. */
static double turn_of(const ring_job* job, const double a[3], const double b[3])
{
  const double d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  return sqrt(chi_dot(d, d)) * job->rules->turn_scale;
}

/* By how many times the tolerances k would be missed if of the rings around it only i and j stayed.
 */
static double need_of(
  const ring_job* job, const candidate* i, const candidate* k, const candidate* j)
{
  const chi_tube_params* const p = job->rules->params;
  double ij = 0, ik = 0, square = 0;
  for (int a = 0; a < 3; ++a)
  {
    ij += (j->axis[a] - i->axis[a]) * (j->axis[a] - i->axis[a]);
    ik += (j->axis[a] - i->axis[a]) * (k->x[a] - i->axis[a]);
  }
  const double w = ij > 0 ? fmin(fmax(ik / ij, 0), 1) : 0;
  for (int a = 0; a < 3; ++a)
  {
    const double off = i->axis[a] + w * (j->axis[a] - i->axis[a]) - k->x[a];
    square += off * off;
  }
  double need = sqrt(square) / p->chord_tolerance;
  need = fmax(need, turn_of(job, i->tangent, k->tangent));
  const double radius =
    (double)i->ring.radius + w * ((double)j->ring.radius - (double)i->ring.radius);
  need = fmax(need, fabs(radius - (double)k->ring.radius) / p->chord_tolerance);
  for (size_t n = 0; n < p->attribute_count && need <= 1; ++n)
  {
    for (size_t m = 0; m < p->attributes[n]->components; ++m)
    {
      const double a = attribute_of(job, i, n, m), b = attribute_of(job, j, n, m);
      const double off = a + w * (b - a) - attribute_of(job, k, n, m);
      need = fmax(need, isfinite(off) ? fabs(off) * job->rules->attribute_scale[n] : 0);
    }
  }
  return need;
}

/* Put the ring of a spline half the step's sagitta outside of the bend: the chord then errs as much
 * to one side as the rings do to the other, and may be sqrt(2) times as long. The line's ends stay.
 */
static void move_outward(const ring_job* job, const candidate* from, candidate* to)
{
  const double curvature = sqrt(chi_dot(to->bend, to->bend));
  if (job->curve->degree == 1 || to->ring.u <= 0 || to->ring.u >= 1 || !(curvature > 0))
  {
    return;
  }
  double step = 0;
  for (int a = 0; a < 3; ++a)
  {
    step += (to->x[a] - from->x[a]) * (to->x[a] - from->x[a]);
  }
  const double most = 0.999 * job->rules->params->chord_tolerance; /* rounded to float below */
  to->ring.outward = (float)fmin(curvature * step / 16, most);
  for (int a = 0; a < 3; ++a)
  {
    to->axis[a] = to->x[a] - to->bend[a] * ((double)to->ring.outward / curvature);
  }
}

/* Whether candidates first ... end - 1, which lie between two rings, may go; `to` finds its place.
 */
static int can_skip(
  const ring_job* job, const candidate* from, size_t first, size_t end, candidate* to)
{
  move_outward(job, from, to);
  if (turn_of(job, from->tangent, to->before) > 1)
  {
    return 0;
  }
  for (size_t k = first; k < end; ++k)
  {
    if (need_of(job, from, &job->lists->candidate[k], to) > 1)
    {
      return 0;
    }
  }
  return 1;
}

/* The last of candidates next ... end that a step from `from` may reach; the first may always. */
static size_t longest_step(const ring_job* job, const candidate* from, size_t next, size_t end)
{
  candidate* const item = job->lists->candidate;
  move_outward(job, from, &item[next]);
  size_t good = next, bad = end + 1;
  for (size_t step = 1; good < end; step = 2 * step + 1)
  {
    const size_t j = end - next > step ? next + step : end;
    if (!can_skip(job, from, next, j, &item[j]))
    {
      bad = j;
      break;
    }
    good = j;
  }
  while (bad - good > 1 && good < end)
  {
    const size_t middle = good + (bad - good) / 2;
    if (can_skip(job, from, next, middle, &item[middle]))
    {
      good = middle;
    }
    else
    {
      bad = middle;
    }
  }
  return good;
}

/* Keep as few rings as the tolerances allow: from each the longest step forward that they bear,
 * found by doubling and halving, first among the candidates and then between the last that may be
 * reached and the one beyond. (Splitting at the worst ring instead, Douglas & Peucker 1973, ends at
 * steps of all lengths between the longest and half of it; steps from candidate to candidate only,
 * at two thirds of it: 18 % and 35 % more rings on a helix.) */
static int thin(ring_job* job)
{
  const size_t n = job->lists->candidates;
  candidate* const item = job->lists->candidate;
  candidate from = item[0];
  item[n - 1].keep = 1;
  if (job->curve->closed && n > 3)
  {
    item[n / 3].keep = item[2 * n / 3].keep = 1; /* a loop needs three */
  }
  int fits = add_ring(job, &from);
  for (size_t next = 1; next < n && fits;)
  {
    size_t end = next; /* no step goes beyond a ring that stays anyway */
    while (!item[end].keep)
    {
      ++end;
    }
    const size_t good = longest_step(job, &from, next, end);
    candidate best = item[good];
    double low = best.ring.u, high = good < end ? item[good + 1].ring.u : low;
    size_t step = (good - next + 1);
    for (; job->curve->degree == 3 && low < high && step < FINENESS; step *= 2)
    {
      const double middle = 0.5 * (low + high);
      candidate at;
      if (!place(job, middle, best.source, &at))
      {
        break;
      }
      if (can_skip(job, &from, next, good + 1, &at))
      {
        low = middle;
        best = at;
      }
      else
      {
        high = middle;
      }
    }
    from = best;
    fits = add_ring(job, &from);
    next = good + 1;
  }
  return fits;
}

/* 1: the line lies wholly outside of the clip box by more than its radius. */
static int is_outside(const ring_job* job)
{
  const double* const box = job->rules->params->clip_box;
  if (!box)
  {
    return 0;
  }
  const chi_ring_lists* const l = job->lists;
  for (int a = 0; a < 3; ++a)
  {
    double low = INFINITY, high = -INFINITY, radius = 0;
    for (size_t k = 0; k < l->candidates; ++k)
    {
      low = fmin(low, l->candidate[k].x[a]);
      high = fmax(high, l->candidate[k].x[a]);
      radius = fmax(radius, (double)l->candidate[k].ring.radius);
    }
    /* the axis leaves the chords by no more than the tolerance */
    const double margin = radius * 1.6 + job->rules->params->chord_tolerance;
    const double origin = job->curve->origin[a];
    if (low + origin > box[2 * a + 1] + margin || high + origin < box[2 * a] - margin)
    {
      return 1;
    }
  }
  return 0;
}

int chi_tube_choose_rings(const chi_ring_rules* rules, size_t line, const chi_spline_curve* curve,
  chi_ring_lists* lists, chi_ring_choice* choice)
{
  ring_job job = { rules, curve, line, lists, choice };
  *choice = (chi_ring_choice){ .rings = 0 };
  if (!add_candidates(&job))
  {
    return 0;
  }
  if (lists->candidates < 2)
  {
    return 1;
  }
  if (is_outside(&job))
  {
    choice->outside = 1;
    return 1;
  }
  if (!rules->params->keep_rings)
  {
    const int fits = thin(&job);
    choice->dropped = lists->candidates > choice->rings ? lists->candidates - choice->rings : 0;
    return fits;
  }
  for (size_t k = 0; k < lists->candidates; ++k)
  {
    if (!add_ring(&job, &lists->candidate[k]))
    {
      return 0;
    }
  }
  return 1;
}
