/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Which lines are tubed, where their rings lie, how wide they are. */

#include "chi_tube_rings.h"

#include <stdatomic.h>

enum
{
  LINES_A_CHUNK = 16
};

typedef struct plan_job
{
  chi_ring_rules rules;
  chi_tube* tube;
  size_t* clamped;       /* [lines] */
  size_t* dropped;       /* [lines] */
  uint8_t* reason;       /* [lines] 1 outside, 2 short */
  chi_ring_lists* lists; /* [chunks] rings chosen by the first pass, for the second to copy */
  int write;             /* 0: choose and count rings; 1: write them */
  atomic_int refused, bad_radius;
} plan_job;

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
        const double radius = chi_tube_radius(
          &job->rules, i, c, k + 1 < c->count ? k : k - 1, k + 1 < c->count ? 0 : 1);
        ring[kept] =
          (chi_tube_ring){ .u = c->point_parameters[k], .radius = (float)radius, .side = side };
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

/* Every point of a polyline is a ring and nothing can be left out: no candidates needed. */
static int is_plain(const plan_job* job, const chi_spline_curve* c)
{
  const chi_tube_params* const p = job->rules.params;
  return p->keep_rings && c->degree == 1 && c->count == c->point_count && !p->clip_box &&
    !p->limit_radius;
}

static int plan_line(plan_job* job, chi_ring_lists* lists, size_t i)
{
  chi_tube_line* const line = &job->tube->line[i];
  chi_spline_curve c;
  chi_ring_choice choice;
  chi_spline_get_curve(job->tube->spline, i, &c);
  job->clamped[i] = job->dropped[i] = line->ring_count = 0;
  job->reason[i] = 0;
  if (c.count == 0)
  {
    return 1;
  }
  if (c.length < job->rules.params->min_length)
  {
    job->reason[i] = 2;
    return 1;
  }
  if (is_plain(job, &c))
  {
    plan_points(job, i, &c);
    return 1;
  }
  if (!chi_tube_choose_rings(&job->rules, i, &c, lists, &choice))
  {
    return 0;
  }
  if (choice.bad_radius)
  {
    job->bad_radius = 1;
  }
  line->ring_count = choice.rings;
  job->clamped[i] = choice.clamped;
  job->dropped[i] = choice.dropped;
  job->reason[i] = choice.outside ? 1 : 0;
  return 1;
}

/* Copy the chosen rings of a chunk's lines, or make those that need no choice. */
static void write_lines(plan_job* job, const chi_ring_lists* lists, size_t first, size_t last)
{
  const chi_tube* const t = job->tube;
  size_t at = 0;
  for (size_t i = first; i < last; ++i)
  {
    chi_spline_curve c;
    chi_spline_get_curve(t->spline, i, &c);
    const size_t count = t->line[i].ring_count;
    if (count > 0 && is_plain(job, &c))
    {
      plan_points(job, i, &c);
    }
    else if (count > 0)
    {
      memcpy(t->ring + t->line[i].ring_start, lists->ring + at, count * sizeof *t->ring);
      at += count;
    }
  }
}

static void plan_chunk(void* data, size_t begin, size_t end)
{
  plan_job* const job = (plan_job*)data;
  const chi_exec* const exec = job->rules.exec;
  for (size_t chunk = begin; chunk < end && !job->refused; ++chunk)
  {
    chi_ring_lists* const lists = &job->lists[chunk];
    const size_t first = chunk * LINES_A_CHUNK;
    const size_t count = job->tube->line_count;
    const size_t last = count - first < LINES_A_CHUNK ? count : first + LINES_A_CHUNK;
    if (job->write)
    {
      write_lines(job, lists, first, last);
      continue;
    }
    for (size_t i = first; i < last && !chi_is_cancelled(exec); ++i)
    {
      if (!plan_line(job, lists, i))
      {
        job->refused = 1;
        break;
      }
    }
    if (lists->candidate)
    {
      chi_free(exec, lists->candidate, lists->candidate_capacity, sizeof *lists->candidate);
      lists->candidate = NULL;
      lists->candidate_capacity = 0;
    }
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
        const double x = chi_tube_value(p->attributes[n], i, m);
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

static chi_status run_plan(plan_job* job, size_t chunks)
{
  chi_tube* const t = job->tube;
  const chi_exec* const exec = job->rules.exec;
  chi_status status = CHI_OK;
  for (job->write = 0; job->write < 2 && status == CHI_OK; ++job->write)
  {
    status = chi_for(exec, chunks, plan_chunk, job);
    status = status == CHI_OK && job->refused ? CHI_ERROR_OUT_OF_MEMORY : status;
    status = status == CHI_OK && job->bad_radius ? CHI_ERROR_INVALID_ARGUMENT : status;
    if (status == CHI_OK && !job->write)
    {
      status = place_lines(t);
      status = status == CHI_OK ? reserve_rings(exec, t) : status;
    }
  }
  for (size_t chunk = 0; chunk < chunks; ++chunk)
  {
    chi_ring_lists_release(exec, &job->lists[chunk]);
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
  const chi_lines_view* lines, const chi_tube_params* given)
{
  chi_tube_params own = { 0 };
  const chi_tube_params* const params =
    given && CHI_ADOPT(chi_tube_params, min_length, &own, given) ? &own : NULL;
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
  if (n > SIZE_MAX / 128)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  const size_t arrays = params->attribute_tolerance > 0 ? params->attribute_count : 0;
  const size_t chunks = (n + LINES_A_CHUNK - 1) / LINES_A_CHUNK;
  const size_t bytes =
    chunks * sizeof(chi_ring_lists) + (arrays + 1) * sizeof(double) + n * (2 * sizeof(size_t) + 1);
  char* const scratch = (char*)chi_alloc(exec, bytes, 1);
  chi_tube_params used = *params;
  used.attribute_count = arrays;
  plan_job job = { .rules = { .exec = exec, .lines = lines, .params = &used }, .tube = t };
  job.rules.turn_scale = 0.5 / sin(0.5 * fmin(params->angular_tolerance_rad, 3.14));
  chi_status status = scratch ? reserve_lines(exec, t, n) : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK)
  {
    job.lists = (chi_ring_lists*)(void*)scratch;
    double* const scale = (double*)(void*)(job.lists + chunks);
    job.clamped = (size_t*)(void*)(scale + arrays + 1);
    job.dropped = job.clamped + n;
    job.reason = (uint8_t*)(job.dropped + n);
    job.rules.attribute_scale = scale;
    memset(job.lists, 0, chunks * sizeof *job.lists);
    scale_attributes(&used, scale);
    status = run_plan(&job, chunks);
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
