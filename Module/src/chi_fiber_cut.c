/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Each pair's part of the surface: the section of a tetrahedron with the plane of a segment, cut
 * off at the segment's ends. Its corners lie on edges of the mesh, where the plane passes, or on
 * faces, where the segment's end lies within the face's image; nothing else can happen, since
 * fibers are straight lines that leave a tetrahedron through two faces. All choices are signs of
 * areas in the plane of the fields, the same in all tetrahedra at an edge or face, so the parts
 * meet.
 */

#include "chi_fiber_internal.h"

#include <math.h>

const chi_fiber_section chi_fiber_sections[16] = { { 0, { { 0 } } },
  { 3, { { 0, 1 }, { 0, 2 }, { 0, 3 } } }, { 3, { { 1, 0 }, { 1, 3 }, { 1, 2 } } },
  { 4, { { 0, 2 }, { 0, 3 }, { 1, 3 }, { 1, 2 } } }, { 3, { { 2, 0 }, { 2, 1 }, { 2, 3 } } },
  { 4, { { 0, 3 }, { 0, 1 }, { 2, 1 }, { 2, 3 } } },
  { 4, { { 1, 0 }, { 1, 3 }, { 2, 3 }, { 2, 0 } } }, { 3, { { 3, 0 }, { 3, 1 }, { 3, 2 } } },
  { 3, { { 3, 0 }, { 3, 2 }, { 3, 1 } } }, { 4, { { 0, 1 }, { 0, 2 }, { 3, 2 }, { 3, 1 } } },
  { 4, { { 1, 2 }, { 1, 0 }, { 3, 0 }, { 3, 2 } } }, { 3, { { 2, 0 }, { 2, 3 }, { 2, 1 } } },
  { 4, { { 2, 0 }, { 2, 1 }, { 3, 1 }, { 3, 0 } } }, { 3, { { 1, 0 }, { 1, 2 }, { 1, 3 } } },
  { 3, { { 0, 1 }, { 0, 3 }, { 0, 2 } } }, { 0, { { 0 } } } };

typedef struct cut_job
{
  const chi_exec* exec;
  chi_fiber_parts* parts;
  chi_fiber_pairs* pairs;
  const chi_fiber_index* index;
  const chi_fiber_polygon* polygon;
} cut_job;

/* A tetrahedron against one segment. */
typedef struct cell
{
  const chi_fiber_index* index;
  const chi_fiber_polygon* polygon;
  const chi_fiber_segment* segment;
  uint32_t number; /* of the segment */
  int split_corners;
  uint32_t id[4];
  const double* value[4];
  double area[4]; /* (q - p) x (value - p) */
  int left[4];
} cell;

typedef struct corner
{
  int at;       /* -1: before the segment's start, 1: beyond its end */
  int ends;     /* by bits: exactly at its start, exactly at its end */
  uint8_t a, b; /* corners of the tetrahedron, by ascending id */
} corner;

/* Where on the segment an edge of the mesh passes it. Along the line the area of edge and point
 * falls if the edge runs from right to left, else it grows; it is 0 where the edge passes. */
static corner classify(const cell* c, int from, int to)
{
  corner k = { 0, 0, (uint8_t)from, (uint8_t)to };
  if (c->id[from] > c->id[to])
  {
    k.a = (uint8_t)to;
    k.b = (uint8_t)from;
  }
  double p, q;
  const int p_left = chi_fiber_is_corner_left(c->value[k.a], c->value[k.b], c->segment->p, &p);
  const int q_left = chi_fiber_is_corner_left(c->value[k.a], c->value[k.b], c->segment->q, &q);
  const int rises = c->left[k.b];
  k.at = p_left != rises ? -1 : q_left == rises ? 1 : 0;
  k.ends = (p == 0) | (q == 0) << 1;
  return k;
}

/* The name of a point between `count` of the mesh's, of which those of no weight, exactly, are
 * dropped. At a point of the mesh whatever cuts there is the same, unless parts are kept apart. */
static chi_fiber_name name_of(
  const cell* c, const uint32_t* ids, const double* weights, int count, uint32_t tag)
{
  uint32_t kept[3] = { CHI_FIBER_NONE, CHI_FIBER_NONE, CHI_FIBER_NONE };
  int n = 0;
  for (int i = 0; i < count; ++i)
  {
    if (weights[i] != 0)
    {
      kept[n++] = ids[i];
    }
  }
  if (n == 1)
  {
    return (chi_fiber_name){ kept[0], CHI_FIBER_NONE, c->split_corners ? c->number : CHI_FIBER_NONE,
      c->number };
  }
  return (chi_fiber_name){ kept[0], kept[1], kept[2], tag };
}

static uint32_t corner_tag(const cell* c, int end)
{
  return CHI_FIBER_AT_CORNER |
    (c->split_corners ? 2 * c->number + (uint32_t)end : c->segment->corner[end]);
}

static chi_fiber_name edge_name(const cell* c, const corner* k)
{
  const uint32_t ids[2] = { c->id[k->a], c->id[k->b] };
  const double weights[2] = { c->area[k->b], c->area[k->a] };
  return name_of(c, ids, weights, 2, k->ends ? corner_tag(c, !(k->ends & 1)) : c->number);
}

/* Areas of a point with the sides of a face that contains it, as weights of the face's corners. */
static void face_weights(
  const double* a, const double* b, const double* c, const double x[2], double w[3])
{
  w[0] = chi_fiber_area(b, c, x);
  w[1] = chi_fiber_area(c, a, x);
  w[2] = chi_fiber_area(a, b, x);
}

static chi_fiber_name face_name(const cell* c, int omitted, int end)
{
  int at[3], n = 0;
  for (int k = 0; k < 4; ++k)
  {
    if (k != omitted)
    {
      int i = n++;
      for (; i > 0 && c->id[at[i - 1]] > c->id[k]; --i)
      {
        at[i] = at[i - 1];
      }
      at[i] = k;
    }
  }
  double weights[3];
  face_weights(c->value[at[0]], c->value[at[1]], c->value[at[2]],
    end ? c->segment->q : c->segment->p, weights);
  const uint32_t ids[3] = { c->id[at[0]], c->id[at[1]], c->id[at[2]] };
  return name_of(c, ids, weights, 3, corner_tag(c, end));
}

/* The part's corners; their number, 0 or 3 and more. */
static int cut(cell* c, chi_fiber_name names[CHI_FIBER_CORNERS + 2])
{
  int lefts = 0;
  for (int k = 0; k < 4; ++k)
  {
    c->value[k] = c->index->values[c->id[k]];
    c->left[k] = chi_fiber_is_left(c->segment, c->value[k], c->area + k);
    lefts |= c->left[k] << k;
  }
  const chi_fiber_section* const s = chi_fiber_sections + lefts;
  corner corners[4];
  int inside = 0, before = 0, beyond = 0;
  for (int k = 0; k < s->count; ++k)
  {
    corners[k] = classify(c, s->edge[k][0], s->edge[k][1]);
    inside += corners[k].at == 0;
    before += corners[k].at < 0;
    beyond += corners[k].at > 0;
  }
  if (before == s->count || beyond == s->count)
  {
    return 0;
  }
  int n = 0;
  for (int k = 0; k < s->count; ++k)
  {
    const corner *const from = corners + k, *const to = corners + (k + 1 < s->count ? k + 1 : 0);
    if (from->at == 0)
    {
      names[n++] = edge_name(c, from);
    }
    if (from->at == to->at)
    {
      continue;
    }
    /* the face of both edges lacks the corner that neither has: 0 + 1 + 2 + 3 = 6 */
    const int third = to->a == from->a || to->a == from->b ? to->b : to->a;
    const int omitted = 6 - from->a - from->b - third;
    const int starts = (from->at < 0) != (to->at < 0), ends = (from->at > 0) != (to->at > 0);
    if (starts && from->at < 0)
    {
      names[n++] = face_name(c, omitted, 0);
    }
    if (ends)
    {
      names[n++] = face_name(c, omitted, 1);
    }
    if (starts && to->at < 0)
    {
      names[n++] = face_name(c, omitted, 0);
    }
  }
  return n;
}

/* Minus the gradient of the segment's distance, six volumes times, away from its inside; the sign
 * of the tetrahedron. */
static int find_normal(const cell* c, double normal[3])
{
  double x[4][3], e[3][3];
  for (int k = 0; k < 4; ++k)
  {
    chi_fiber_place(c->index, c->id[k], x[k]);
  }
  for (int k = 0; k < 3; ++k)
  {
    for (int i = 0; i < 3; ++i)
    {
      e[k][i] = x[k + 1][i] - x[0][i];
    }
  }
  double sum[3] = { 0, 0, 0 }, volume = 0;
  for (int k = 0; k < 3; ++k) /* the area opposite to corner k + 1, inwards */
  {
    const double *const u = e[(k + 1) % 3], *const v = e[(k + 2) % 3];
    const double area[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
      u[0] * v[1] - u[1] * v[0] };
    const double rise = c->area[k + 1] - c->area[0];
    for (int i = 0; i < 3; ++i)
    {
      sum[i] += rise * area[i];
      volume += k == 0 ? e[0][i] * area[i] : 0;
    }
  }
  const double sign = c->segment->per_length * ((volume < 0) != (c->segment->side < 0) ? 1 : -1);
  for (int i = 0; i < 3; ++i)
  {
    normal[i] = sign * sum[i];
  }
  return volume < 0 ? -1 : 1;
}

/* A job's point of this name, perhaps a new one. */
uint32_t chi_fiber_find_point(
  chi_fiber_parts* parts, chi_fiber_job* own, const chi_fiber_name* name)
{
  uint32_t* const table = parts->table + 2 * own->first_corner;
  const size_t size = 2 * own->corners;
  size_t at = (size_t)((uint64_t)chi_fiber_hash(name) * size >> 32);
  while (table[at] != CHI_FIBER_NONE)
  {
    if (chi_fiber_same(parts->name + own->first_corner + table[at], name))
    {
      return table[at];
    }
    at = at + 1 < size ? at + 1 : 0;
  }
  table[at] = (uint32_t)own->points;
  parts->name[own->first_corner + own->points] = *name;
  parts->used[own->first_corner + own->points] = 0;
  if (parts->normal)
  {
    memset(parts->normal[own->first_corner + own->points], 0, sizeof *parts->normal);
  }
  return (uint32_t)own->points++;
}

/* Triangles of a part whose corners differ; `used` marks these. */
static size_t count_triangles(const uint32_t* corners, int count, uint8_t* used)
{
  size_t n = 0;
  for (int k = 2; k < count; ++k)
  {
    if (chi_fiber_is_triangle(corners, k))
    {
      used[corners[0]] = used[corners[k - 1]] = used[corners[k]] = 1;
      ++n;
    }
  }
  return n;
}

static void cut_pair(const cut_job* job, chi_fiber_job* own, size_t pair, size_t* corners)
{
  chi_fiber_parts* const parts = job->parts;
  const uint64_t code = job->pairs->pair[own->batch][own->first_pair + pair];
  cell c = { .index = job->index, .polygon = job->polygon, .split_corners = parts->split_corners };
  c.number = (uint32_t)(own->batch * CHI_FIBER_BATCH + code % CHI_FIBER_PAIR);
  c.segment = job->polygon->segment + c.number;
  chi_fiber_fetch(job->index, code / CHI_FIBER_PAIR, c.id);
  chi_fiber_name names[CHI_FIBER_CORNERS + 2];
  const int count = cut(&c, names);
  parts->size[own->first_part + pair] = (uint8_t)count;
  if (count == 0)
  {
    return;
  }
  double normal[3];
  const int flip = (find_normal(&c, normal) < 0) != (c.segment->side < 0);
  uint32_t* const out = parts->corner + own->first_corner + *corners;
  for (int k = 0; k < count; ++k)
  {
    const uint32_t point = chi_fiber_find_point(parts, own, names + (flip ? count - 1 - k : k));
    out[k] = point;
    for (int i = 0; parts->normal && i < 3; ++i)
    {
      parts->normal[own->first_corner + point][i] += normal[i];
    }
  }
  *corners += (size_t)count;
  own->triangles += count_triangles(out, count, parts->used + own->first_corner);
  ++own->crossed;
}

static void cut_jobs(void* data, size_t begin, size_t end)
{
  const cut_job* const job = (const cut_job*)data;
  for (size_t j = begin; j < end && !chi_is_cancelled(job->exec); ++j)
  {
    chi_fiber_job* const own = job->pairs->job + j;
    size_t corners = 0;
    own->points = own->triangles = own->crossed = 0;
    memset(job->parts->table + 2 * own->first_corner, 0xff, 2 * own->corners * sizeof(uint32_t));
    for (size_t p = 0; p < own->pairs; ++p)
    {
      cut_pair(job, own, p, &corners);
    }
  }
}

chi_status chi_fiber_cut(const chi_exec* exec, chi_fiber_parts* parts, chi_fiber_pairs* pairs,
  const chi_fiber_index* index, const chi_fiber_polygon* polygon, int with_normals)
{
  const size_t corners = pairs->corners + 1;
  if (!chi_buffer_reserve(exec, &parts->name_buffer, corners, sizeof *parts->name) ||
    !chi_buffer_reserve(exec, &parts->corner_buffer, corners, sizeof *parts->corner) ||
    !chi_buffer_reserve(exec, &parts->size_buffer, pairs->count + 1, 1) ||
    (with_normals &&
      !chi_buffer_reserve(exec, &parts->normal_buffer, corners, sizeof *parts->normal)) ||
    !chi_buffer_reserve(exec, &parts->id_buffer, corners, sizeof *parts->id) ||
    !chi_buffer_reserve(exec, &parts->used_buffer, corners, 1) ||
    !chi_buffer_reserve(exec, &parts->table_buffer, 2 * corners, sizeof *parts->table))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  parts->name = (chi_fiber_name*)parts->name_buffer.data;
  parts->corner = (uint32_t*)parts->corner_buffer.data;
  parts->size = (uint8_t*)parts->size_buffer.data;
  parts->normal = with_normals ? (double(*)[3])parts->normal_buffer.data : NULL;
  parts->id = (uint32_t*)parts->id_buffer.data;
  parts->table = (uint32_t*)parts->table_buffer.data;
  parts->used = (uint8_t*)parts->used_buffer.data;
  cut_job job = { exec, parts, pairs, index, polygon };
  return chi_for(exec, pairs->jobs, cut_jobs, &job);
}

/* The corner of the polygon that a tag names. */
static const double* corner_of(const chi_fiber_polygon* polygon, uint32_t tag, int split_corners)
{
  const uint32_t number = tag & ~CHI_FIBER_AT_CORNER;
  if (!split_corners)
  {
    return polygon->corner[number].x;
  }
  const chi_fiber_segment* const s = polygon->segment + number / 2;
  return number & 1 ? s->q : s->p;
}

int chi_fiber_locate(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name, uint32_t parents[3], double weights[3])
{
  const int count = name->b == CHI_FIBER_NONE ? 1 : name->c == CHI_FIBER_NONE ? 2 : 3;
  const double* x[3] = { NULL, NULL, NULL };
  const uint32_t ids[3] = { name->a, name->b, name->c };
  for (int k = 0; k < count; ++k)
  {
    parents[k] = ids[k];
    x[k] = index->values[ids[k]];
  }
  weights[0] = 1;
  if (count == 2 && !(name->tag & CHI_FIBER_AT_CORNER))
  {
    const chi_fiber_segment* const s = polygon->segment + name->tag;
    weights[0] = fabs(chi_fiber_area(s->p, s->q, x[1]));
    weights[1] = fabs(chi_fiber_area(s->p, s->q, x[0]));
  }
  else if (count == 2) /* the corner lies on the edge's image */
  {
    const double* const v = corner_of(polygon, name->tag, split_corners);
    const double d[2] = { x[1][0] - x[0][0], x[1][1] - x[0][1] };
    weights[0] = (x[1][0] - v[0]) * d[0] + (x[1][1] - v[1]) * d[1];
    weights[1] = (v[0] - x[0][0]) * d[0] + (v[1] - x[0][1]) * d[1];
  }
  else if (count == 3)
  {
    face_weights(x[0], x[1], x[2], corner_of(polygon, name->tag, split_corners), weights);
  }
  /* signs are exact, and agree: the point lies between all of them */
  double sum = 0;
  for (int k = 0; k < count; ++k)
  {
    weights[k] = fabs(weights[k]);
    sum += weights[k];
  }
  for (int k = 0; k < count; ++k)
  {
    weights[k] = sum > 0 ? weights[k] / sum : 1.0 / count;
  }
  return count;
}

double chi_fiber_parameter(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name)
{
  const uint32_t number = name->tag & ~CHI_FIBER_AT_CORNER;
  if (name->b != CHI_FIBER_NONE && name->tag & CHI_FIBER_AT_CORNER)
  {
    return split_corners ? number & 1 : !polygon->corner[number].starts;
  }
  const chi_fiber_segment* const s = polygon->segment + number;
  uint32_t parents[3];
  double weights[3], x[2] = { 0, 0 };
  const int count = chi_fiber_locate(index, polygon, split_corners, name, parents, weights);
  for (int k = 0; k < count; ++k)
  {
    x[0] += weights[k] * (index->values[parents[k]][0] - s->p[0]);
    x[1] += weights[k] * (index->values[parents[k]][1] - s->p[1]);
  }
  const double t = (s->d[0] * x[0] + s->d[1] * x[1]) / s->square;
  if (t >= 1)
  {
    return split_corners || !polygon->corner[s->corner[1]].starts;
  }
  return t > 0 ? t : 0;
}

void chi_fiber_parts_free(const chi_exec* exec, chi_fiber_parts* parts)
{
  chi_buffer* const buffers[] = { &parts->name_buffer, &parts->corner_buffer, &parts->size_buffer,
    &parts->normal_buffer, &parts->id_buffer, &parts->used_buffer, &parts->table_buffer,
    &parts->order_buffer, &parts->partition_buffer };
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers; ++i)
  {
    chi_buffer_free(exec, buffers[i]);
  }
}
