/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The surface of a planned tube: frames along the axis, rings of vertices, caps, cells. */

#include "chi_tube_internal.h"

#include <string.h>

enum
{
  LINES_A_CHUNK = 8,
  MAX_SIDES = 4096
};

/* A place on the axis with its frame; normal, binormal and tangent are orthonormal, right-handed.
 */
typedef struct station
{
  double x[3], tangent[3], normal[3], binormal[3];
  double stretch[3]; /* along it a mitre widens the ring; any length */
  double widening;   /* (1 / cos(half the turn) - 1) / |stretch|^2 */
  double radius;
} station;

typedef struct sweep_job
{
  const chi_exec* exec;
  const chi_tube* tube;
  const chi_tube_outputs* out;
  const float* circle; /* [sides][2] cosine, sine */
} sweep_job;

/* Any unit vector across t: from the axis that t follows least. */
static void any_normal(const double t[3], double out[3])
{
  const double a[3] = { fabs(t[0]), fabs(t[1]), fabs(t[2]) };
  double axis[3] = { 0, 0, 0 };
  axis[a[0] <= a[1] && a[0] <= a[2] ? 0 : a[1] <= a[2] ? 1 : 2] = 1;
  chi_cross(t, axis, out);
  chi_normalise(out);
}

static void reflect(double v[3], const double mirror[3], double square)
{
  const double f = 2 * chi_dot(mirror, v) / square;
  for (int k = 0; k < 3; ++k)
  {
    v[k] -= f * mirror[k];
  }
}

/* Carry the normal from one station to the next without turning about the axis: double reflection.
 * Wang, Juettler, Zheng & Liu 2008, section 4, Table I. */
static void carry_normal(const station* from, station* to)
{
  double step[3], normal[3], tangent[3], second[3];
  for (int k = 0; k < 3; ++k)
  {
    step[k] = to->x[k] - from->x[k];
    normal[k] = from->normal[k];
    tangent[k] = from->tangent[k];
  }
  const double c1 = chi_dot(step, step);
  if (c1 > 0)
  {
    reflect(normal, step, c1);
    reflect(tangent, step, c1);
    for (int k = 0; k < 3; ++k)
    {
      second[k] = to->tangent[k] - tangent[k];
    }
    const double c2 = chi_dot(second, second);
    if (c2 > 1e-30)
    {
      reflect(normal, second, c2);
    }
  }
  else
  {
    /* Two rings at one corner: the least rotation; none at all for a reversal, where the normal is
     * perpendicular to both tangents already. */
    const double sum = 1 + chi_dot(from->tangent, to->tangent);
    const double f = sum > 1e-12 ? chi_dot(to->tangent, normal) / sum : 0;
    for (int k = 0; k < 3; ++k)
    {
      normal[k] -= f * (from->tangent[k] + to->tangent[k]);
    }
  }
  /* Rounding: keep it perpendicular. */
  const double along = chi_dot(normal, to->tangent);
  for (int k = 0; k < 3; ++k)
  {
    normal[k] -= along * to->tangent[k];
  }
  const double square = chi_dot(normal, normal);
  /* Reflections keep the length, so that one Newton step of the inverse root restores it to
   * rounding: its error is 3/8 of the square of what is missing. */
  double scale = 1.5 - 0.5 * square;
  if (fabs(square - 1) > 1e-8)
  {
    if (!(square > 0.25))
    {
      any_normal(to->tangent, to->normal);
      return;
    }
    scale = 1 / sqrt(square);
  }
  for (int k = 0; k < 3; ++k)
  {
    to->normal[k] = normal[k] * scale;
  }
}

/* Frenet's normal where the curve bends, on the side of the one carried there. */
static void bend_normal(
  const chi_spline_curve* c, double u, const double before[3], const double after[3], station* s)
{
  double n[3], x[3][3], scale = 1;
  if (c->degree == 1)
  {
    for (int k = 0; k < 3; ++k)
    {
      n[k] = after[k] - before[k];
    }
  }
  else
  {
    chi_spline_evaluate(c, u, 2, x);
    memcpy(n, x[2], sizeof n);
    scale = chi_dot(x[1], x[1]);
  }
  const double along = chi_dot(n, s->tangent);
  for (int k = 0; k < 3; ++k)
  {
    n[k] -= along * s->tangent[k];
  }
  /* Below, the direction is rounding: a turn of less than 1e-9 over the curve. */
  if (!(chi_normalise(n) > 1e-9 * sqrt(scale)))
  {
    return;
  }
  const double side = chi_dot(n, s->normal) < 0 ? -1 : 1;
  for (int k = 0; k < 3; ++k)
  {
    s->normal[k] = side * n[k];
  }
}

/* Everything about a ring but its normal. */
static void place_station(const chi_spline_curve* c, const chi_tube_ring* ring, size_t k,
  int direct, const double* known_before, station* s, double before[3], double after[3])
{
  s->radius = (double)ring->radius;
  s->widening = 0;
  if (direct)
  {
    /* a polyline with a ring at every point: no evaluation */
    const double* const x = c->coefficients + 3 * k;
    const double* const next = k + 1 < c->count ? x + 3 : (c->closed ? c->coefficients + 3 : NULL);
    const double* const last =
      k > 0 ? x - 3 : (c->closed ? c->coefficients + 3 * (c->count - 2) : NULL);
    for (int a = 0; a < 3; ++a)
    {
      s->x[a] = x[a];
      before[a] = known_before ? known_before[a] : last ? x[a] - last[a] : next[a] - x[a];
      after[a] = next ? next[a] - x[a] : before[a];
    }
    if (!known_before)
    {
      chi_normalise(before);
    }
    chi_normalise(after);
  }
  else
  {
    double x[1][3];
    chi_spline_evaluate(c, ring->u, 0, x);
    memcpy(s->x, x[0], sizeof s->x);
    chi_tube_tangents(c, ring->u, before, after);
  }
  if (ring->side != 0 || c->degree != 1)
  {
    memcpy(s->tangent, ring->side < 0 ? before : after, sizeof s->tangent);
    return;
  }
  /* The bisector of two unit vectors at angle a is their sum over 2 cos(a / 2); the ring widens
   * along their difference by 1 / cos(a / 2). One square root in place of four. */
  const double cosine = chi_dot(before, after);
  const double half = sqrt(0.5 * fmax(1 + cosine, 0));
  if (half < 1e-6)
  {
    memcpy(s->tangent, after, sizeof s->tangent); /* a reversal has no bisector */
    return;
  }
  for (int a = 0; a < 3; ++a)
  {
    s->tangent[a] = (before[a] + after[a]) * (0.5 / half);
    s->stretch[a] = after[a] - before[a];
  }
  const double square = chi_dot(s->stretch, s->stretch);
  /* a closed line's seam may turn by more than a mitre takes */
  s->widening = square > 1e-28 ? (1 / fmax(half, 0.6) - 1) / square : 0;
}

typedef struct walker
{
  const chi_tube* tube;
  chi_spline_curve curve;
  const chi_tube_ring* ring;
  size_t rings, next, point;
  int direct;
  int has_after; /* the last ring's direction onwards is the next one's direction before */
  double after[3];
  station now;
} walker;

static void start_walk(walker* w, const chi_tube* t, size_t line)
{
  memset(w, 0, sizeof *w);
  w->tube = t;
  chi_spline_get_curve(t->spline, line, &w->curve);
  w->ring = t->ring + t->line[line].ring_start;
  w->rings = t->line[line].ring_count;
  w->direct = t->keep_rings && w->curve.degree == 1 && w->curve.count == w->curve.point_count;
}

/* Step to the next ring, carrying the frame. */
static void walk(walker* w)
{
  station to = { .radius = 0 };
  double before[3], after[3];
  const chi_tube_ring* const ring = &w->ring[w->next];
  w->point += w->next > 0 && ring->side <= 0; /* both rings of a corner belong to one point */
  place_station(
    &w->curve, ring, w->point, w->direct, w->has_after ? w->after : NULL, &to, before, after);
  w->has_after = w->direct;
  memcpy(w->after, after, sizeof after);
  if (w->next == 0)
  {
    any_normal(to.tangent, to.normal);
  }
  else
  {
    carry_normal(&w->now, &to);
  }
  if (w->tube->frame == CHI_TUBE_FRENET)
  {
    bend_normal(&w->curve, ring->u, before, after, &to);
  }
  chi_cross(to.tangent, to.normal, to.binormal);
  w->now = to;
  ++w->next;
}

/* Angle by which the frame of a closed curve comes back turned, and the length of its rings'
 * chords. */
static double defect(const chi_tube* t, size_t line, double* length)
{
  walker w;
  double first[3] = { 0, 0, 0 }, last[3] = { 0, 0, 0 };
  start_walk(&w, t, line);
  *length = 0;
  while (w.next < w.rings)
  {
    walk(&w);
    if (w.next == 1)
    {
      memcpy(first, w.now.normal, sizeof first);
    }
    else
    {
      *length += chi_distance(last, w.now.x);
    }
    memcpy(last, w.now.x, sizeof last);
  }
  return w.curve.closed ? atan2(-chi_dot(first, w.now.binormal), chi_dot(first, w.now.normal)) : 0;
}

static void store_point(const sweep_job* job, size_t at, const double x[3])
{
  if (job->out->point_type == CHI_F32)
  {
    float* const p = (float*)job->out->points + 3 * at;
    p[0] = (float)x[0];
    p[1] = (float)x[1];
    p[2] = (float)x[2];
  }
  else
  {
    memcpy((double*)job->out->points + 3 * at, x, 3 * sizeof *x);
  }
}

/* One ring: x + radius (cos N + sin B), normals (cos N + sin B - slope T) / sqrt(1 + slope^2). */
static void store_ring(
  const sweep_job* job, size_t at, const double origin[3], const station* s, double slope)
{
  const int sides = job->tube->sides;
  const float* const circle = job->circle;
  double center[3];
  float n[3], b[3], nr[3], br[3], ts[3];
  const double unit = slope != 0 ? 1 / sqrt(1 + slope * slope) : 1;
  const double ne = s->widening * chi_dot(s->normal, s->stretch);
  const double be = s->widening * chi_dot(s->binormal, s->stretch);
  for (int k = 0; k < 3; ++k)
  {
    center[k] = s->x[k] + origin[k];
    nr[k] = (float)(s->radius * (s->normal[k] + ne * s->stretch[k]));
    br[k] = (float)(s->radius * (s->binormal[k] + be * s->stretch[k]));
    n[k] = (float)(unit * s->normal[k]);
    b[k] = (float)(unit * s->binormal[k]);
    ts[k] = (float)(unit * slope * s->tangent[k]);
  }
  if (job->out->points && job->out->point_type == CHI_F32)
  {
    float* const p = (float*)job->out->points + 3 * at;
    const float c[3] = { (float)center[0], (float)center[1], (float)center[2] };
    for (int j = 0; j < sides; ++j)
    {
      for (int k = 0; k < 3; ++k)
      {
        p[3 * j + k] = c[k] + circle[2 * j] * nr[k] + circle[2 * j + 1] * br[k];
      }
    }
  }
  else if (job->out->points)
  {
    double* const p = (double*)job->out->points + 3 * at;
    for (int j = 0; j < sides; ++j)
    {
      const double angle = 6.28318530717958648 * j / sides, cosine = cos(angle), sine = sin(angle);
      for (int k = 0; k < 3; ++k)
      {
        p[3 * j + k] = center[k] +
          s->radius *
            (cosine * (s->normal[k] + ne * s->stretch[k]) +
              sine * (s->binormal[k] + be * s->stretch[k]));
      }
    }
  }
  if (job->out->normals)
  {
    float* const p = job->out->normals + 3 * at;
    for (int j = 0; j < sides; ++j)
    {
      for (int k = 0; k < 3; ++k)
      {
        p[3 * j + k] = circle[2 * j] * n[k] + circle[2 * j + 1] * b[k] - ts[k];
      }
    }
  }
}

/* Vertices of a cap at the ring whose first vertex is `rim`; direction -1 at the start, 1 at the
 * end. */
static void store_cap(const sweep_job* job, size_t at, size_t rim, const double origin[3],
  const station* s, int direction)
{
  const size_t n = (size_t)job->tube->sides;
  if (job->tube->cap == CHI_TUBE_CAP_FLAT)
  {
    /* the same positions bit for bit, another normal */
    const size_t size = job->out->point_type == CHI_F32 ? sizeof(float) : sizeof(double);
    if (job->out->points)
    {
      char* const p = (char*)job->out->points;
      memcpy(p + 3 * at * size, p + 3 * rim * size, 3 * n * size);
    }
    for (size_t j = 0; j < n && job->out->normals; ++j)
    {
      for (size_t k = 0; k < 3; ++k)
      {
        job->out->normals[3 * (at + j) + k] = (float)(direction * s->tangent[k]);
      }
    }
    return;
  }
  const size_t latitudes = chi_tube_latitudes(job->tube->sides);
  for (size_t l = 1; l <= latitudes + 1; ++l)
  {
    const double angle = 1.57079632679489662 * (double)l / (double)(latitudes + 1);
    const double across = l > latitudes ? 0 : cos(angle),
                 along = direction * (l > latitudes ? 1 : sin(angle));
    for (size_t j = 0; j < (l > latitudes ? 1 : n); ++j)
    {
      const size_t vertex = at + (l - 1) * n + j;
      double d[3], x[3];
      for (size_t k = 0; k < 3; ++k)
      {
        d[k] = across *
            ((double)job->circle[2 * j] * s->normal[k] +
              (double)job->circle[2 * j + 1] * s->binormal[k]) +
          along * s->tangent[k];
        x[k] = s->x[k] + origin[k] + s->radius * d[k];
      }
      if (job->out->points)
      {
        store_point(job, vertex, x);
      }
      for (size_t k = 0; k < 3 && job->out->normals; ++k)
      {
        job->out->normals[3 * vertex + k] = (float)d[k];
      }
    }
  }
}

/* Turn of the frame about its tangent, for closed curves. */
static void turn_frame(station* s, double angle)
{
  const double c = cos(angle), d = sin(angle);
  for (int k = 0; k < 3; ++k)
  {
    const double n = s->normal[k], b = s->binormal[k];
    s->normal[k] = c * n + d * b;
    s->binormal[k] = c * b - d * n;
  }
}

static void store_along(
  const sweep_job* job, size_t at, size_t count, double u, double distance, double length)
{
  const chi_tube_outputs* const o = job->out;
  const int sides = job->tube->sides;
  const double unit = o->tcoord_length > 0 ? o->tcoord_length : length;
  const float s = (float)(unit > 0 ? distance / unit : 0);
  for (size_t j = 0; j < count; ++j)
  {
    if (o->parameter)
    {
      o->parameter[at + j] = (float)u;
    }
    if (o->tcoords)
    {
      o->tcoords[2 * (at + j)] = s;
      o->tcoords[2 * (at + j) + 1] = (float)(j % (size_t)sides) / (float)sides;
    }
  }
}

static void sweep_vertices(const sweep_job* job, size_t i)
{
  const chi_tube* const t = job->tube;
  const chi_tube_line* const line = &t->line[i];
  const size_t n = (size_t)t->sides;
  walker w;
  double length = 0, turn = 0, distance = 0, behind = 0;
  start_walk(&w, t, i);
  const int closed = w.curve.closed;
  if (closed || (job->out->tcoords && !(job->out->tcoord_length > 0)))
  {
    turn = defect(t, i, &length);
  }
  const size_t own = closed ? line->ring_count - 1 : line->ring_count;
  const size_t caps = closed || t->cap == CHI_TUBE_CAP_NONE ? 0 : 2;
  const size_t cap_points = chi_tube_cap_points(t), cap_start = line->point_start + own * n;
  station last = { .radius = 0 }, now;
  walk(&w);
  now = w.now;
  for (size_t k = 0; k < own; ++k)
  {
    station next = now;
    const int more = w.next < w.rings;
    if (more)
    {
      walk(&w);
      next = w.now;
    }
    const double ahead = more ? chi_distance(now.x, next.x) : 0;
    distance += behind;
    const double before = k > 0 ? last.radius : now.radius;
    const double slope = behind + ahead > 0 ? (next.radius - before) / (behind + ahead) : 0;
    station s = now;
    if (closed && length > 0)
    {
      turn_frame(&s, turn * distance / length);
    }
    const size_t at = line->point_start + k * n;
    store_ring(job, at, w.curve.origin, &s, slope);
    store_along(job, at, n, w.ring[k].u, distance, length);
    if (caps && (k == 0 || k + 1 == own))
    {
      const size_t cap = cap_start + (k == 0 ? 0 : cap_points);
      store_cap(job, cap, at, w.curve.origin, &s, k == 0 ? -1 : 1);
      store_along(job, cap, cap_points, w.ring[k].u, distance, length);
    }
    last = now;
    now = next;
    behind = ahead;
  }
}

static void sweep_curve(const sweep_job* job, size_t i)
{
  const chi_tube* const t = job->tube;
  const chi_tube_line* const line = &t->line[i];
  const chi_tube_outputs* const o = job->out;
  chi_spline_curve c;
  chi_spline_get_curve(t->spline, i, &c);
  const int direct = c.degree == 1 && c.count == line->ring_count && t->keep_rings;
  for (size_t k = 0; k < line->ring_count && o->curve_points; ++k)
  {
    double x[1][3];
    if (direct)
    {
      memcpy(x[0], c.coefficients + 3 * k, sizeof x[0]);
    }
    else
    {
      chi_spline_evaluate(&c, t->ring[line->ring_start + k].u, 0, x);
    }
    for (size_t a = 0; a < 3; ++a)
    {
      o->curve_points[3 * (line->curve_point_start + k) + a] = x[0][a] + c.origin[a];
    }
  }
  if (o->curve_offsets)
  {
    o->curve_offsets[line->curve_index + 1] = (int64_t)(line->curve_point_start + line->ring_count);
  }
  if (o->curve_line_ids)
  {
    o->curve_line_ids[line->curve_index] = (int64_t)i;
  }
}

static void sweep_chunk(void* data, size_t begin, size_t end)
{
  const sweep_job* const job = (const sweep_job*)data;
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    const size_t first = chunk * LINES_A_CHUNK, count = job->tube->line_count;
    const size_t last = count - first < LINES_A_CHUNK ? count : first + LINES_A_CHUNK;
    for (size_t i = first; i < last && !chi_is_cancelled(job->exec); ++i)
    {
      if (job->tube->line[i].ring_count == 0)
      {
        continue;
      }
      sweep_vertices(job, i);
      if (job->out->connectivity)
      {
        chi_tube_write_cells(job->tube, job->out, i);
      }
      sweep_curve(job, i);
    }
  }
}

chi_status chi_tube_sweep(const chi_exec* exec, const chi_tube* t, const chi_tube_outputs* outputs)
{
  if (!t || !outputs ||
    (outputs->points && outputs->point_type != CHI_F32 && outputs->point_type != CHI_F64))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!t->planned)
  {
    return CHI_ERROR_NOT_READY;
  }
  if (outputs->offsets)
  {
    outputs->offsets[0] = 0;
  }
  if (outputs->curve_offsets)
  {
    outputs->curve_offsets[0] = 0;
  }
  if (t->line_count == 0)
  {
    return CHI_OK;
  }
  float* const circle = (float*)chi_alloc(exec, (size_t)t->sides, 2 * sizeof(float));
  if (!circle)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  for (int32_t j = 0; j < t->sides; ++j)
  {
    const double angle = 6.28318530717958648 * j / t->sides;
    circle[2 * j] = (float)cos(angle);
    circle[2 * j + 1] = (float)sin(angle);
  }
  sweep_job job = { exec, t, outputs, circle };
  const chi_status status =
    chi_for(exec, (t->line_count + LINES_A_CHUNK - 1) / LINES_A_CHUNK, sweep_chunk, &job);
  chi_free(exec, circle, (size_t)t->sides, 2 * sizeof(float));
  return status;
}
