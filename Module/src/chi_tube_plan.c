/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Which lines are tubed, where their rings lie, how wide they are. */

#include "chi_tube_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
  LINES_A_CHUNK = 16,
  MAX_PIECES = 256 /* of one knot span; a turn of 360 degrees at 1.4 degrees a ring */
};

/* A ring that may be dropped again. */
typedef struct candidate
{
  chi_tube_ring ring;
  double x[3], tangent[3], before[3];
  size_t source;
  double weight;
  int keep;
} candidate;

typedef struct candidate_list
{
  candidate* item;
  size_t count, capacity;
} candidate_list;

typedef struct plan_job
{
  const chi_exec* exec;
  chi_tube* tube;
  const chi_tube_params* params;
  double turn_scale;             /* 1 / chord of the angular tolerance */
  const double* attribute_scale; /* [attribute_count] 1 / (tolerance * range); 0: constant array */
  size_t* clamped;               /* [lines] */
  size_t* dropped;               /* [lines] */
  uint8_t* reason;               /* [lines] 1 outside, 2 short */
  int write;                     /* 0: count rings; 1: write them */
  atomic_int refused, bad_radius;
} plan_job;

static double value_at(const chi_array_view* a, size_t tuple, size_t component)
{
  const char* const at = (const char*)a->data + tuple * a->stride;
  if (a->type == CHI_F32)
  {
    float x;
    memcpy(&x, at + component * sizeof x, sizeof x);
    return (double)x;
  }
  double x;
  memcpy(&x, at + component * sizeof x, sizeof x);
  return x;
}

static candidate* append(const chi_exec* exec, candidate_list* list)
{
  if (list->count == list->capacity)
  {
    const size_t capacity = list->capacity ? 2 * list->capacity : 256;
    candidate* const grown = (candidate*)chi_alloc(exec, capacity, sizeof *grown);
    if (!grown)
    {
      return NULL;
    }
    if (list->item)
    {
      memcpy(grown, list->item, list->count * sizeof *grown);
      chi_free(exec, list->item, list->capacity, sizeof *grown);
    }
    list->item = grown;
    list->capacity = capacity;
  }
  memset(&list->item[list->count], 0, sizeof(candidate));
  return &list->item[list->count++];
}

static double radius_at(
  const plan_job* job, size_t line, const chi_spline_curve* c, size_t source, double weight)
{
  const chi_tube_params* const p = job->params;
  double radius = p->radius;
  if (p->line_radius)
  {
    radius *= value_at(p->line_radius, line, 0);
  }
  if (p->point_radius)
  {
    const chi_lines_view* const lines = job->tube->lines;
    const double a =
      value_at(p->point_radius, (size_t)chi_tube_point_id(lines, line, c, source), 0);
    const double b =
      value_at(p->point_radius, (size_t)chi_tube_point_id(lines, line, c, source + 1), 0);
    radius *= a + weight * (b - a);
  }
  return radius;
}

/* Largest radius that does not fold the surface. On a spline just below 1 / curvature; at a corner
 * what leaves the mitre within the shorter of its two segments. */
static double radius_limit(const chi_spline_curve* c, const candidate* at)
{
  if (c->degree == 3)
  {
    double x[3][3], cross[3];
    chi_spline_evaluate(c, at->ring.u, 2, x);
    chi_cross(x[1], x[2], cross);
    const double speed = sqrt(chi_dot(x[1], x[1]));
    const double bend = sqrt(chi_dot(cross, cross));
    return bend > 0 ? 0.999 * speed * speed * speed / bend : INFINITY;
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

static int add_ring(
  plan_job* job, candidate_list* list, size_t line, const chi_spline_curve* c, double u)
{
  candidate* const at = append(job->exec, list);
  if (!at)
  {
    return 0;
  }
  const size_t hint = list->count > 1 ? list->item[list->count - 2].source : 0;
  double x[1][3];
  at->ring.u = u;
  at->source = chi_tube_source(c, u, hint, &at->weight);
  chi_spline_evaluate(c, u, 0, x);
  memcpy(at->x, x[0], sizeof at->x);
  if (!chi_tube_tangents(c, u, at->before, at->tangent))
  {
    --list->count;
    return 1;
  }
  double radius = radius_at(job, line, c, at->source, at->weight);
  if (!(radius >= 0) || !isfinite(radius))
  {
    job->bad_radius = 1;
    radius = 0;
  }
  if (job->params->limit_radius)
  {
    const double limit = radius_limit(c, at);
    if (radius > limit)
    {
      radius = limit;
      ++job->clamped[line];
    }
  }
  at->ring.radius = (float)radius;
  const int closed_end = c->closed && (u == 0 || u >= 1);
  if (c->degree == 1 && chi_dot(at->before, at->tangent) < CHI_TUBE_MITRE_COSINE && !closed_end)
  {
    candidate* const second = append(job->exec, list);
    if (!second)
    {
      return 0;
    }
    candidate* const first = second - 1; /* append may have moved the list */
    *second = *first;
    first->ring.side = -1;
    memcpy(first->tangent, first->before, sizeof first->tangent);
    second->ring.side = 1;
    first->keep = second->keep = 1;
  }
  return 1;
}

/* Pieces of a knot span so short that none bends more than half of what the tolerances allow. */
static size_t pieces_of(const plan_job* job, const chi_spline_curve* c, double a, double b)
{
  double x[3][2][3], chord[3], off = 0, turn = 0;
  for (int k = 0; k < 3; ++k)
  {
    chi_spline_evaluate(c, a + 0.5 * k * (b - a), 1, x[k]);
    chi_normalise(x[k][1]);
  }
  for (int k = 0; k < 3; ++k)
  {
    chord[k] = 0.5 * (x[0][0][k] + x[2][0][k]) - x[1][0][k];
  }
  off = sqrt(chi_dot(chord, chord));
  for (int k = 0; k < 2; ++k)
  {
    turn += acos(fmin(fmax(chi_dot(x[k][1], x[k + 1][1]), -1), 1)); /* once a span */
  }
  const double by_turn = 2 * turn / job->params->angular_tolerance_rad;
  const double by_chord = 2 * sqrt(off / job->params->chord_tolerance);
  const double pieces = ceil(fmax(fmax(by_turn, by_chord), 1));
  return pieces < MAX_PIECES ? (size_t)pieces : MAX_PIECES;
}

static int add_candidates(
  plan_job* job, candidate_list* list, size_t line, const chi_spline_curve* c)
{
  list->count = 0;
  if (c->degree == 1 || job->params->keep_rings)
  {
    /* A polyline's points; a chord that stands for many points keeps those for the arrays' sake. */
    for (size_t i = 0; i < c->point_count; ++i)
    {
      if (!add_ring(job, list, line, c, c->point_parameters[i]))
      {
        return 0;
      }
    }
    return 1;
  }
  size_t point = 1;
  const int by_points = job->params->attribute_count > 0 || job->params->point_radius;
  for (size_t span = 3; span < c->count; ++span)
  {
    const double a = c->knots[span], b = c->knots[span + 1];
    const size_t pieces = a < b ? pieces_of(job, c, a, b) : 0;
    for (size_t k = 0; k < pieces; ++k)
    {
      const double u = a + (b - a) * ((double)k / (double)pieces);
      for (; by_points && point < c->point_count && c->point_parameters[point] <= u; ++point)
      {
        const double at = c->point_parameters[point];
        if (at < u && at > list->item[list->count - 1].ring.u && !add_ring(job, list, line, c, at))
        {
          return 0;
        }
      }
      if (!add_ring(job, list, line, c, u))
      {
        return 0;
      }
    }
  }
  for (; by_points && point + 1 < c->point_count; ++point)
  {
    if (c->point_parameters[point] > list->item[list->count - 1].ring.u &&
      !add_ring(job, list, line, c, c->point_parameters[point]))
    {
      return 0;
    }
  }
  return add_ring(job, list, line, c, 1);
}

static double attribute_of(const plan_job* job, size_t line, const chi_spline_curve* c,
  const candidate* at, size_t array, size_t component)
{
  const chi_array_view* const a = job->params->attributes[array];
  const chi_lines_view* const lines = job->tube->lines;
  const double first =
    value_at(a, (size_t)chi_tube_point_id(lines, line, c, at->source), component);
  const double second =
    value_at(a, (size_t)chi_tube_point_id(lines, line, c, at->source + 1), component);
  return first + at->weight * (second - first);
}

/* Turn between two unit vectors in units of the angular tolerance, by their chord: exactly 1 where
 * the turn is the tolerance, and without an arc cosine a candidate. */
static double turn_of(const plan_job* job, const double a[3], const double b[3])
{
  const double d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
  return sqrt(chi_dot(d, d)) * job->turn_scale;
}

/* By how many times the tolerances a candidate would be missed if only i and j stayed. */
static double need_of(const plan_job* job, size_t line, const chi_spline_curve* c,
  const candidate* i, const candidate* k, const candidate* j)
{
  double ij = 0, ik = 0, square = 0;
  for (int a = 0; a < 3; ++a)
  {
    ij += (j->x[a] - i->x[a]) * (j->x[a] - i->x[a]);
    ik += (j->x[a] - i->x[a]) * (k->x[a] - i->x[a]);
  }
  const double w = ij > 0 ? fmin(fmax(ik / ij, 0), 1) : 0;
  for (int a = 0; a < 3; ++a)
  {
    const double off = i->x[a] + w * (j->x[a] - i->x[a]) - k->x[a];
    square += off * off;
  }
  double need = sqrt(square) / job->params->chord_tolerance;
  need = fmax(need, turn_of(job, i->tangent, k->tangent));
  const double radius =
    (double)i->ring.radius + w * ((double)j->ring.radius - (double)i->ring.radius);
  need = fmax(need, fabs(radius - (double)k->ring.radius) / job->params->chord_tolerance);
  for (size_t n = 0; n < job->params->attribute_count && need <= 1; ++n)
  {
    for (size_t m = 0; m < job->params->attributes[n]->components; ++m)
    {
      const double a = attribute_of(job, line, c, i, n, m), b = attribute_of(job, line, c, j, n, m);
      const double off = a + w * (b - a) - attribute_of(job, line, c, k, n, m);
      need = fmax(need, isfinite(off) ? fabs(off) * job->attribute_scale[n] : 0);
    }
  }
  return need;
}

/* Whether every ring between i and j may go. */
static int can_skip(const plan_job* job, size_t line, const chi_spline_curve* c,
  const candidate_list* list, size_t i, size_t j)
{
  if (turn_of(job, list->item[i].tangent, list->item[j].before) > 1)
  {
    return 0;
  }
  for (size_t k = i + 1; k < j; ++k)
  {
    if (need_of(job, line, c, &list->item[i], &list->item[k], &list->item[j]) > 1)
    {
      return 0;
    }
  }
  return 1;
}

/* Keep as few rings as the tolerances allow: from each the longest step forward that they bear,
 * found by doubling and halving. (Splitting at the worst ring instead, Douglas & Peucker 1973, ends
 * at steps of all lengths between the longest and half of it: 18 % more rings on a helix.) */
static void thin(const plan_job* job, size_t line, const chi_spline_curve* c, candidate_list* list)
{
  const size_t n = list->count;
  list->item[0].keep = list->item[n - 1].keep = 1;
  if (c->closed && n > 3)
  {
    list->item[n / 3].keep = list->item[2 * n / 3].keep = 1; /* a loop needs three */
  }
  for (size_t i = 0; i + 1 < n;)
  {
    size_t end = i + 1; /* no step goes beyond a ring that stays anyway */
    while (!list->item[end].keep)
    {
      ++end;
    }
    size_t good = i + 1, bad = end + 1;
    for (size_t step = 2; good < end; step *= 2)
    {
      const size_t j = i + step < end ? i + step : end;
      if (!can_skip(job, line, c, list, i, j))
      {
        bad = j;
        break;
      }
      good = j;
    }
    while (bad - good > 1 && good < end)
    {
      const size_t middle = good + (bad - good) / 2;
      if (can_skip(job, line, c, list, i, middle))
      {
        good = middle;
      }
      else
      {
        bad = middle;
      }
    }
    list->item[good].keep = 1;
    i = good;
  }
}

/* 1: the line lies wholly outside of the clip box by more than its radius. */
static int is_outside(const plan_job* job, const candidate_list* list, const double origin[3])
{
  const double* const box = job->params->clip_box;
  if (!box)
  {
    return 0;
  }
  for (int a = 0; a < 3; ++a)
  {
    double low = INFINITY, high = -INFINITY, radius = 0;
    for (size_t k = 0; k < list->count; ++k)
    {
      low = fmin(low, list->item[k].x[a]);
      high = fmax(high, list->item[k].x[a]);
      radius = fmax(radius, (double)list->item[k].ring.radius);
    }
    /* the axis leaves the chords by no more than the tolerance */
    const double margin = radius * 1.6 + job->params->chord_tolerance;
    if (low + origin[a] > box[2 * a + 1] + margin || high + origin[a] < box[2 * a] - margin)
    {
      return 1;
    }
  }
  return 0;
}

/* All points of a polyline as rings, without candidates: what a plain sweep of a million points
 * needs. */
static void plan_points(plan_job* job, size_t i, const chi_spline_curve* c)
{
  chi_tube* const t = job->tube;
  chi_tube_ring* const ring = job->write ? t->ring + t->line[i].ring_start : NULL;
  double before[3] = { 0, 0, 0 };
  size_t kept = 0;
  for (size_t k = 0; k < c->count; ++k)
  {
    double after[3] = { 0, 0, 0 };
    const double* const x = c->coefficients + 3 * k;
    if (k + 1 < c->count)
    {
      for (int a = 0; a < 3; ++a)
      {
        after[a] = x[3 + a] - x[a];
      }
    }
    /* the turn is sharp where cos < limit, compared without square roots unless it may be */
    const double dot = chi_dot(before, after);
    const int sharp = dot < 0 &&
      dot < CHI_TUBE_MITRE_COSINE * sqrt(chi_dot(before, before) * chi_dot(after, after));
    for (int side = sharp ? -1 : 0; side < 2; side += 2)
    {
      if (job->write)
      {
        const double radius =
          radius_at(job, i, c, k + 1 < c->count ? k : k - 1, k + 1 < c->count ? 0 : 1);
        ring[kept] = (chi_tube_ring){ c->point_parameters[k], (float)radius, side };
        if (!(radius >= 0) || !isfinite(radius))
        {
          job->bad_radius = 1;
        }
      }
      ++kept;
      if (!sharp)
      {
        break;
      }
    }
    memcpy(before, after, sizeof before);
  }
  t->line[i].ring_count = kept;
}

static int plan_line(plan_job* job, candidate_list* list, size_t i)
{
  chi_tube* const t = job->tube;
  chi_spline_curve c;
  chi_spline_get_curve(t->spline, i, &c);
  if (!job->write)
  {
    job->clamped[i] = job->dropped[i] = 0;
    job->reason[i] = 0;
    t->line[i].ring_count = 0;
  }
  if (c.count == 0 || job->reason[i])
  {
    return 1;
  }
  if (c.length < job->params->min_length)
  {
    job->reason[i] = 2;
    return 1;
  }
  job->clamped[i] = 0;
  if (job->params->keep_rings && c.degree == 1 && c.count == c.point_count &&
    !job->params->clip_box && !job->params->limit_radius)
  {
    plan_points(job, i, &c);
    return 1;
  }
  if (!add_candidates(job, list, i, &c))
  {
    return 0;
  }
  if (list->count < 2)
  {
    return 1;
  }
  if (is_outside(job, list, c.origin))
  {
    job->reason[i] = 1;
    return 1;
  }
  if (!job->params->keep_rings)
  {
    thin(job, i, &c, list);
  }
  size_t kept = 0;
  for (size_t k = 0; k < list->count; ++k)
  {
    if (list->item[k].keep || job->params->keep_rings)
    {
      if (job->write)
      {
        t->ring[t->line[i].ring_start + kept] = list->item[k].ring;
      }
      ++kept;
    }
  }
  t->line[i].ring_count = kept;
  job->dropped[i] = list->count - kept;
  return 1;
}

static void plan_chunk(void* data, size_t begin, size_t end)
{
  plan_job* const job = (plan_job*)data;
  candidate_list list = { NULL, 0, 0 };
  for (size_t chunk = begin; chunk < end && !job->refused; ++chunk)
  {
    const size_t first = chunk * LINES_A_CHUNK;
    const size_t count = job->tube->line_count;
    const size_t last = count - first < LINES_A_CHUNK ? count : first + LINES_A_CHUNK;
    for (size_t i = first; i < last && !chi_is_cancelled(job->exec); ++i)
    {
      if (!plan_line(job, &list, i))
      {
        job->refused = 1;
        break;
      }
    }
  }
  if (list.item)
  {
    chi_free(job->exec, list.item, list.capacity, sizeof *list.item);
  }
}

static int params_are_valid(const chi_tube_params* p, const chi_lines_view* lines)
{
  if (!p || !(p->radius > 0) || !isfinite(p->radius) || (p->sides != 0 && p->sides < 3) ||
    p->sides > 4096 || !(p->chord_tolerance > 0) || !(p->angular_tolerance_rad > 0) ||
    !(p->attribute_tolerance >= 0) || p->frame < 0 || p->frame > CHI_TUBE_FRENET || p->cap < 0 ||
    p->cap > CHI_TUBE_CAP_ROUND || p->cells < 0 || p->cells > CHI_TUBE_TRIANGLES ||
    (p->attribute_count && !p->attributes))
  {
    return 0;
  }
  const chi_array_view* const radii[2] = { p->point_radius, p->line_radius };
  const size_t wanted[2] = { lines->points.count, lines->line_count };
  for (int k = 0; k < 2; ++k)
  {
    if (radii[k] &&
      (!chi_array_is_valid(radii[k]) || radii[k]->count < wanted[k] ||
        (radii[k]->type != CHI_F32 && radii[k]->type != CHI_F64)))
    {
      return 0;
    }
  }
  for (size_t n = 0; n < p->attribute_count; ++n)
  {
    const chi_array_view* const a = p->attributes[n];
    if (!chi_array_is_valid(a) || a->count < lines->points.count ||
      (a->type != CHI_F32 && a->type != CHI_F64))
    {
      return 0;
    }
  }
  return 1;
}

/* 1 / (tolerance * range) of every array, over its finite values. */
static void scale_attributes(const chi_tube_params* p, double* scale)
{
  for (size_t n = 0; n < p->attribute_count; ++n)
  {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < p->attributes[n]->count; ++i)
    {
      for (size_t m = 0; m < p->attributes[n]->components; ++m)
      {
        const double x = value_at(p->attributes[n], i, m);
        low = isfinite(x) && x < low ? x : low;
        high = isfinite(x) && x > high ? x : high;
      }
    }
    scale[n] = high > low ? 1 / (p->attribute_tolerance * (high - low)) : 0;
  }
}

static int32_t sides_from_tolerance(const chi_tube_params* p)
{
  /* r (1 - cos(pi / n)) <= tolerance */
  const double cosine = 1 - p->chord_tolerance / p->radius;
  const double sides = cosine > -1 ? ceil(3.14159265358979324 / acos(cosine)) : 3;
  return sides < 3 ? 3 : sides > 64 ? 64 : (int32_t)sides;
}

/* Offsets of every line in the outputs, in line order. */
static chi_status place_lines(chi_tube* t)
{
  chi_tube_sizes* const s = &t->sizes;
  const size_t n = (size_t)t->sides, cap_points = chi_tube_cap_points(t);
  const size_t latitudes = t->cap == CHI_TUBE_CAP_ROUND ? chi_tube_latitudes(t->sides) : 0;
  for (size_t i = 0; i < t->line_count; ++i)
  {
    chi_tube_line* const line = &t->line[i];
    chi_spline_curve c;
    chi_spline_get_curve(t->spline, i, &c);
    const size_t rings = line->ring_count;
    line->ring_start = s->rings;
    line->point_start = s->points;
    line->cell_start = s->cells;
    line->connectivity_start = s->connectivity;
    line->curve_point_start = s->curve_points;
    line->curve_index = s->curves;
    if (rings == 0)
    {
      continue;
    }
    /* A closed curve's last ring is its first one. */
    const size_t own = c.closed ? rings - 1 : rings;
    const size_t caps = c.closed || t->cap == CHI_TUBE_CAP_NONE ? 0 : 2;
    const size_t bands = rings - 1;
    if (own > SIZE_MAX / 64 / n)
    {
      return CHI_ERROR_TOO_LARGE;
    }
    s->points += own * n + caps * cap_points;
    if (t->cells == CHI_TUBE_TRIANGLES)
    {
      const size_t cap_triangles = t->cap == CHI_TUBE_CAP_FLAT ? n - 2 : latitudes * 2 * n + n;
      s->cells += 2 * n * bands + caps * cap_triangles;
      s->connectivity += 3 * (2 * n * bands + caps * cap_triangles);
    }
    else
    {
      s->cells += n + caps * (t->cap == CHI_TUBE_CAP_FLAT ? 1 : latitudes + 1);
      s->connectivity +=
        n * 2 * rings + caps * (t->cap == CHI_TUBE_CAP_FLAT ? n : (latitudes + 1) * 2 * (n + 1));
    }
    s->rings += rings;
    s->curve_points += rings;
    ++s->curves;
    if (s->connectivity > SIZE_MAX / 32 || s->points > SIZE_MAX / 128)
    {
      return CHI_ERROR_TOO_LARGE;
    }
  }
  s->bytes = (uint64_t)s->points * 28 + (uint64_t)s->connectivity * 8 + (uint64_t)s->cells * 16;
  return CHI_OK;
}

static chi_status reserve_lines(const chi_exec* exec, chi_tube* t, size_t lines)
{
  if (lines > t->line_capacity)
  {
    if (t->line)
    {
      chi_free(exec, t->line, t->line_capacity, sizeof *t->line);
    }
    t->line = (chi_tube_line*)chi_alloc(exec, lines, sizeof *t->line);
    t->line_capacity = t->line ? lines : 0;
  }
  return lines <= t->line_capacity ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
}

static chi_status reserve_rings(const chi_exec* exec, chi_tube* t)
{
  if (t->sizes.rings > t->ring_capacity)
  {
    if (t->ring)
    {
      chi_free(exec, t->ring, t->ring_capacity, sizeof *t->ring);
    }
    t->ring = (chi_tube_ring*)chi_alloc(exec, t->sizes.rings, sizeof *t->ring);
    t->ring_capacity = t->ring ? t->sizes.rings : 0;
  }
  return t->sizes.rings <= t->ring_capacity ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
}

static chi_status run_plan(plan_job* job)
{
  chi_tube* const t = job->tube;
  const size_t chunks = (t->line_count + LINES_A_CHUNK - 1) / LINES_A_CHUNK;
  chi_status status = CHI_OK;
  for (job->write = 0; job->write < 2 && status == CHI_OK; ++job->write)
  {
    status = chunks ? chi_for(job->exec, chunks, plan_chunk, job) : CHI_OK;
    status = status == CHI_OK && job->refused ? CHI_ERROR_OUT_OF_MEMORY : status;
    status = status == CHI_OK && job->bad_radius ? CHI_ERROR_INVALID_ARGUMENT : status;
    if (status == CHI_OK && !job->write)
    {
      status = place_lines(t);
      status = status == CHI_OK ? reserve_rings(job->exec, t) : status;
    }
  }
  for (size_t i = 0; i < t->line_count && status == CHI_OK; ++i)
  {
    t->sizes.clamped_radii += job->clamped[i];
    t->sizes.removed_rings += job->dropped[i];
    t->sizes.outside_lines += job->reason[i] == 1;
    t->sizes.short_lines += job->reason[i] == 2;
  }
  return status;
}

chi_status chi_tube_plan(const chi_exec* exec, chi_tube* t, const chi_spline* spline,
  const chi_lines_view* lines, const chi_tube_params* params)
{
  if (!t || !spline || !lines || chi_spline_count(spline) != lines->line_count ||
    !params_are_valid(params, lines))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const size_t n = lines->line_count;
  t->planned = 0;
  t->spline = spline;
  t->lines = lines;
  t->line_count = n;
  t->sides = params->sides ? params->sides : sides_from_tolerance(params);
  t->frame = params->frame;
  t->cap = params->cap;
  t->cells = params->cells;
  t->keep_rings = params->keep_rings;
  t->sizes = (chi_tube_sizes){ .struct_size = sizeof t->sizes, .sides = t->sides };
  if (n == 0)
  {
    t->planned = 1;
    return CHI_OK;
  }
  if (n > SIZE_MAX / 64)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  const size_t arrays = params->attribute_tolerance > 0 ? params->attribute_count : 0;
  const size_t bytes = n * (2 * sizeof(size_t) + 1) + (arrays + 1) * sizeof(double);
  char* const scratch = (char*)chi_alloc(exec, bytes, 1);
  chi_tube_params used = *params;
  used.attribute_count = arrays;
  plan_job job = { .exec = exec, .tube = t, .params = &used };
  job.turn_scale = 0.5 / sin(0.5 * fmin(params->angular_tolerance_rad, 3.14));
  chi_status status = scratch ? reserve_lines(exec, t, n) : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK)
  {
    double* const scale = (double*)(void*)scratch;
    job.attribute_scale = scale;
    job.clamped = (size_t*)(void*)(scale + arrays + 1);
    job.dropped = job.clamped + n;
    job.reason = (uint8_t*)(job.dropped + n);
    scale_attributes(&used, scale);
    status = run_plan(&job);
  }
  if (scratch)
  {
    chi_free(exec, scratch, bytes, 1);
  }
  t->planned = status == CHI_OK;
  if (status != CHI_OK)
  {
    t->sizes = (chi_tube_sizes){ .struct_size = sizeof t->sizes };
  }
  return status;
}

chi_status chi_tube_create(const chi_exec* exec, chi_tube** tube)
{
  if (!tube)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  *tube = (chi_tube*)chi_alloc(exec, 1, sizeof **tube);
  if (!*tube)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(*tube, 0, sizeof **tube);
  (*tube)->sizes.struct_size = sizeof(chi_tube_sizes);
  return CHI_OK;
}

void chi_tube_destroy(const chi_exec* exec, chi_tube* t)
{
  if (t)
  {
    if (t->line)
    {
      chi_free(exec, t->line, t->line_capacity, sizeof *t->line);
    }
    if (t->ring)
    {
      chi_free(exec, t->ring, t->ring_capacity, sizeof *t->ring);
    }
    chi_free(exec, t, 1, sizeof *t);
  }
}

void chi_tube_get_sizes(const chi_tube* t, chi_tube_sizes* sizes)
{
  if (sizes)
  {
    *sizes = t ? t->sizes : (chi_tube_sizes){ .struct_size = sizeof *sizes };
  }
}
