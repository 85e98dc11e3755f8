/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The surface of a planned tube: frames along the axis, rings of vertices, caps, cells. */

#include "chi_tube_frames.h"

#include <string.h>

enum
{
  LINES_A_CHUNK = 8
};

typedef struct sweep_job
{
  const chi_exec* exec;
  const chi_tube* tube;
  const chi_tube_outputs* out;
  const chi_tube_kernels* kernels;
  const float* circle;         /* [3 x sides] cosines, each three times, then as many sines */
  const double* double_circle; /* [sides][2] cosine, sine; only where points are double */
} sweep_job;

/* A ring that is about to be written; normal, binormal and tangent are orthonormal, right-handed.
 */
typedef struct station
{
  double x[3], tangent[3], normal[3], binormal[3];
  double stretch[3], widening; /* see chi_tube_block */
  double radius;
} station;

static void take_station(chi_tube_frames* f, size_t slot, station* s)
{
  chi_tube_slot(f->block.x, slot, s->x);
  chi_tube_slot(f->block.tangent, slot, s->tangent);
  chi_tube_slot(f->block.normal, slot, s->normal);
  chi_tube_slot(f->block.stretch, slot, s->stretch);
  chi_cross(s->tangent, s->normal, s->binormal);
  s->widening = f->block.widening[slot];
  s->radius = f->block.radius[slot];
}

/* Angle by which the frame of a closed curve comes back turned, and the length of its rings'
 * chords. */
static double defect(
  const chi_tube_kernels* kernels, const chi_tube* t, size_t line, double* length)
{
  chi_tube_frames f;
  double first[3] = { 0, 0, 0 };
  station last = { .radius = 0 };
  chi_tube_frames_start(&f, kernels, t, line);
  *length = 0;
  for (size_t count; (count = chi_tube_frames_next(&f)) > 0;)
  {
    if (f.first == 0)
    {
      chi_tube_slot(f.block.normal, 1, first);
    }
    for (size_t s = 1; s <= count; ++s)
    {
      *length += f.block.chord[s];
    }
    take_station(&f, count, &last);
  }
  return f.curve.closed ? atan2(-chi_dot(first, last.binormal), chi_dot(first, last.normal)) : 0;
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
  const size_t sides = (size_t)job->tube->sides;
  const int is_float = job->out->point_type == CHI_F32;
  const double unit = slope != 0 ? 1 / sqrt(1 + slope * slope) : 1;
  const double ne = s->widening * chi_dot(s->normal, s->stretch);
  const double be = s->widening * chi_dot(s->binormal, s->stretch);
  double center[3], cosine[3], sine[3];
  chi_tube_ellipse e;
  for (int k = 0; k < 3; ++k)
  {
    center[k] = s->x[k] + origin[k];
    cosine[k] = s->radius * (s->normal[k] + ne * s->stretch[k]);
    sine[k] = s->radius * (s->binormal[k] + be * s->stretch[k]);
    e.center[k] = (float)center[k];
    e.cosine[k] = (float)cosine[k];
    e.sine[k] = (float)sine[k];
    e.normal_center[k] = (float)(-unit * slope * s->tangent[k]);
    e.normal_cosine[k] = (float)(unit * s->normal[k]);
    e.normal_sine[k] = (float)(unit * s->binormal[k]);
  }
  job->kernels->ring(&e, job->circle, sides,
    job->out->points && is_float ? (float*)job->out->points + 3 * at : NULL,
    job->out->normals ? job->out->normals + 3 * at : NULL);
  if (job->out->points && !is_float)
  {
    double* const p = (double*)job->out->points + 3 * at;
    for (size_t j = 0; j < sides; ++j)
    {
      for (size_t k = 0; k < 3; ++k)
      {
        p[3 * j + k] = center[k] +
          (job->double_circle[2 * j] * cosine[k] + job->double_circle[2 * j + 1] * sine[k]);
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
            ((double)job->circle[3 * j] * s->normal[k] +
              (double)job->circle[3 * (n + j)] * s->binormal[k]) +
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
  chi_tube_frames f;
  double length = 0, turn = 0, distance = 0;
  chi_tube_frames_start(&f, job->kernels, t, i);
  const int closed = f.curve.closed;
  if (closed || (job->out->tcoords && !(job->out->tcoord_length > 0)))
  {
    turn = defect(job->kernels, t, i, &length);
  }
  const size_t own = closed ? line->ring_count - 1 : line->ring_count;
  const size_t caps = closed || t->cap == CHI_TUBE_CAP_NONE ? 0 : 2;
  const size_t cap_points = chi_tube_cap_points(t), cap_start = line->point_start + own * n;
  for (size_t count; (count = chi_tube_frames_next(&f)) > 0;)
  {
    const chi_tube_block* const b = &f.block;
    for (size_t slot = 1; slot <= count && f.first + slot <= own; ++slot)
    {
      const size_t k = f.first + slot - 1, at = line->point_start + k * n;
      const double around = b->chord[slot] + b->chord[slot + 1];
      const double slope = around > 0 ? (b->radius[slot + 1] - b->radius[slot - 1]) / around : 0;
      station s;
      take_station(&f, slot, &s);
      distance += b->chord[slot];
      if (closed && length > 0)
      {
        turn_frame(&s, turn * distance / length);
      }
      store_ring(job, at, f.curve.origin, &s, slope);
      store_along(job, at, n, f.ring[k].u, distance, length);
      if (caps && (k == 0 || k + 1 == own))
      {
        const size_t cap = cap_start + (k == 0 ? 0 : cap_points);
        store_cap(job, cap, at, f.curve.origin, &s, k == 0 ? -1 : 1);
        store_along(job, cap, cap_points, f.ring[k].u, distance, length);
      }
    }
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
    double x[3];
    if (direct)
    {
      memcpy(x, c.coefficients + 3 * k, sizeof x);
    }
    else
    {
      chi_tube_axis(&c, &t->ring[line->ring_start + k], x);
    }
    for (size_t a = 0; a < 3; ++a)
    {
      o->curve_points[3 * (line->curve_point_start + k) + a] = x[a] + c.origin[a];
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

chi_status chi_tube_sweep(const chi_exec* exec, const chi_tube* t, const chi_tube_outputs* given)
{
  chi_tube_outputs own = { 0 };
  const chi_tube_outputs* const outputs =
    given && CHI_ADOPT(chi_tube_outputs, curve_line_ids, &own, given) ? &own : NULL;
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
  const size_t sides = (size_t)t->sides, bytes = sides * (2 * sizeof(double) + 6 * sizeof(float));
  double* const circle = (double*)chi_alloc(exec, bytes, 1);
  if (!circle)
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  float* const repeated = (float*)(void*)(circle + 2 * sides);
  for (size_t j = 0; j < sides; ++j)
  {
    const double angle = 6.28318530717958648 * (double)j / (double)sides;
    circle[2 * j] = cos(angle);
    circle[2 * j + 1] = sin(angle);
    for (size_t k = 0; k < 3; ++k)
    {
      repeated[3 * j + k] = (float)circle[2 * j];
      repeated[3 * (sides + j) + k] = (float)circle[2 * j + 1];
    }
  }
  sweep_job job = { exec, t, outputs, chi_tube_get_kernels(), repeated, circle };
  const chi_status status =
    chi_for(exec, (t->line_count + LINES_A_CHUNK - 1) / LINES_A_CHUNK, sweep_chunk, &job);
  chi_free(exec, circle, bytes, 1);
  return status;
}
