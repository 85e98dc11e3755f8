/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* A polygon in the plane of two fields as segments, with their ends known as the same or not, and
 * how these lie to boxes. */

#include "chi_fiber_internal.h"

#include <math.h>
#include <stdlib.h>

static const double largest = 1e100; /* of a value: areas are below 1e201 */

/* The six products of the expanded determinant, each exactly, added exactly. */
double chi_fiber_area_exact(const double p[2], const double q[2], const double x[2])
{
  const double factor[6][2] = { { q[0], x[1] }, { -q[0], p[1] }, { -p[0], x[1] }, { -q[1], x[0] },
    { q[1], p[0] }, { p[1], x[0] } };
  double parts[12];
  size_t n = 0;
  for (int i = 0; i < 6; ++i)
  {
    double low;
    const double high = chi_two_product(factor[i][0], factor[i][1], &low);
    n = chi_expansion_grow(parts, n, low);
    n = chi_expansion_grow(parts, n, high);
  }
  return n == 0 ? 0 : parts[n - 1];
}

typedef struct named_point
{
  double x[2];
  size_t at;
} named_point;

static int compare_points(const void* a, const void* b)
{
  const named_point *const p = (const named_point*)a, *const q = (const named_point*)b;
  for (int k = 0; k < 2; ++k)
  {
    if (p->x[k] != q->x[k])
    {
      return p->x[k] < q->x[k] ? -1 : 1;
    }
  }
  return (p->at > q->at) - (p->at < q->at);
}

/* Number the distinct ones of `count` points; name[i] is the number of the i-th. */
static size_t name_points(named_point* points, size_t count, uint32_t* name, chi_fiber_corner* out)
{
  size_t distinct = 0;
  qsort(points, count, sizeof *points, compare_points);
  for (size_t i = 0; i < count; ++i)
  {
    if (i == 0 || points[i].x[0] != points[i - 1].x[0] || points[i].x[1] != points[i - 1].x[1])
    {
      out[distinct++] = (chi_fiber_corner){ { points[i].x[0], points[i].x[1] }, 0 };
    }
    name[points[i].at] = (uint32_t)(distinct - 1);
  }
  return distinct;
}

chi_fiber_segment chi_fiber_make_segment(const chi_fiber_corner* corner, uint32_t from, uint32_t to)
{
  chi_fiber_segment s = { .corner = { from, to }, .side = 1 };
  for (int k = 0; k < 2; ++k)
  {
    s.p[k] = corner[from].x[k];
    s.q[k] = corner[to].x[k];
    s.d[k] = s.q[k] - s.p[k];
    s.square += s.d[k] * s.d[k];
  }
  s.per_length = 1 / sqrt(s.square);
  /* (q - p) x (x - p) of a point on the line, once the line has moved by (e, e^2): e dy - e^2 dx */
  s.tie = (int8_t)(s.d[1] > 0 || (s.d[1] == 0 && s.d[0] < 0) ? 1 : -1);
  return s;
}

/* Twice the area of a closed line of segments, from their first end: no size of coordinates
 * matters. */
static double area_of(const chi_fiber_segment* s, size_t count)
{
  double sum = 0;
  for (size_t i = 1; i < count; ++i)
  {
    sum += (s[i].p[0] - s[0].p[0]) * (s[i].q[1] - s[0].p[1]) -
      (s[i].p[1] - s[0].p[1]) * (s[i].q[0] - s[0].p[0]);
  }
  return sum;
}

/* One line, of `count` points with these names. */
static void add_line(
  chi_fiber_polygon* polygon, const uint32_t* name, size_t count, int64_t first_id, uint32_t line)
{
  const size_t first = polygon->count;
  for (size_t i = 0; i + 1 < count; ++i)
  {
    chi_fiber_segment s = chi_fiber_make_segment(polygon->corner, name[i], name[i + 1]);
    if (name[i] == name[i + 1] || !(s.square > 0))
    {
      ++polygon->empty;
      continue;
    }
    s.id = first_id + (int64_t)i;
    s.line = line;
    polygon->corner[name[i]].starts = 1;
    polygon->segment[polygon->count++] = s;
  }
  const size_t made = polygon->count - first;
  if (made > 1 && name[0] == name[count - 1])
  {
    chi_fiber_segment* const s = polygon->segment + first;
    const int side = area_of(s, made) < 0 ? -1 : 1;
    for (size_t i = 0; i < made; ++i)
    {
      s[i].side = (int8_t)side;
      s[i].is_closed = 1;
    }
    polygon->closed += made;
  }
}

static int64_t point_id(const chi_lines_view* lines, int64_t i)
{
  return lines->connectivity ? lines->connectivity[i] : i;
}

chi_status chi_fiber_polygon_read(
  const chi_exec* exec, chi_fiber_polygon* polygon, const chi_lines_view* lines)
{
  polygon->count = polygon->corners = polygon->empty = polygon->closed = polygon->given_count = 0;
  if (!chi_lines_are_valid(lines))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const int64_t begin = lines->line_count ? lines->offsets[0] : 0;
  const int64_t end = lines->line_count ? lines->offsets[lines->line_count] : 0;
  const size_t count = (size_t)(end - begin);
  if (count >= CHI_FIBER_AT_CORNER)
  {
    return CHI_ERROR_TOO_LARGE;
  }
  /* one more than there may be, since none are refused */
  if (!chi_buffer_reserve(exec, &polygon->segments, count + 1, sizeof *polygon->segment) ||
    !chi_buffer_reserve(exec, &polygon->corner_buffer, count + 1, sizeof *polygon->corner) ||
    !chi_buffer_reserve(exec, &polygon->given, count + 1, sizeof(named_point)) ||
    !chi_buffer_reserve(exec, &polygon->order, count + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  polygon->segment = (chi_fiber_segment*)polygon->segments.data;
  polygon->corner = (chi_fiber_corner*)polygon->corner_buffer.data;
  named_point* const points = (named_point*)polygon->given.data;
  uint32_t* const name = (uint32_t*)polygon->order.data;
  for (size_t i = 0; i < count; ++i)
  {
    double x[3];
    chi_view_get(&lines->points, (size_t)point_id(lines, begin + (int64_t)i), x);
    if (!(fabs(x[0]) <= largest && fabs(x[1]) <= largest))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    points[i] = (named_point){ { x[0] + 0.0, x[1] + 0.0 }, i }; /* no -0 */
  }
  polygon->given_count = count;
  polygon->corners = name_points(points, count, name, polygon->corner);
  int64_t id = 0;
  for (size_t l = 0; l < lines->line_count; ++l)
  {
    const int64_t first = lines->offsets[l], length = lines->offsets[l + 1] - first;
    add_line(polygon, name + (first - begin), (size_t)length, id, (uint32_t)l);
    id += length > 0 ? length - 1 : 0;
  }
  return CHI_OK;
}

/* Extremes of the line function over a box, and what their rounding may be. */
typedef struct box_sides
{
  double low, high, error;
} box_sides;

static box_sides sides_of(const double along[2], const double from[2], const chi_fiber_range* box)
{
  box_sides s = { 0, 0, 0 };
  for (int k = 0; k < 2; ++k)
  {
    const double a = along[k] * (box->low[k] - from[k]), b = along[k] * (box->high[k] - from[k]);
    s.low += a < b ? a : b;
    s.high += a < b ? b : a;
    s.error += fabs(a) + fabs(b);
  }
  s.error *= 0x1p-50; /* three roundings of u = 2^-53 a term, and one of the sum */
  return s;
}

static box_sides line_sides(const chi_fiber_segment* s, const chi_fiber_range* box)
{
  const double normal[2] = { -s->d[1], s->d[0] };
  return sides_of(normal, s->p, box);
}

int chi_fiber_meets(const chi_fiber_segment* s, const chi_fiber_range* box)
{
  for (int k = 0; k < 2; ++k)
  {
    const double low = s->p[k] < s->q[k] ? s->p[k] : s->q[k];
    const double high = s->p[k] < s->q[k] ? s->q[k] : s->p[k];
    if (!(low <= box->high[k] && high >= box->low[k]))
    {
      return 0;
    }
  }
  const box_sides side = line_sides(s, box);
  return side.low <= side.error && side.high >= -side.error;
}

int chi_fiber_bits_of_box(const chi_fiber_segment* s, const chi_fiber_range* box, uint64_t* bits)
{
  const box_sides line = line_sides(s, box), along = sides_of(s->d, s->p, box);
  const double error = along.error + s->square * 0x1p-50;
  const int left = line.low > line.error, right = line.high < -line.error;
  const int before = along.high<-error, after = along.low> error;
  const int beyond = along.low - s->square > error, within = along.high - s->square < -error;
  *bits = (uint64_t)left << CHI_FIBER_LEFT | (uint64_t)before << CHI_FIBER_BEFORE |
    (uint64_t)beyond << CHI_FIBER_BEYOND | (uint64_t)before << CHI_FIBER_MAYBE_BEFORE |
    (uint64_t)beyond << CHI_FIBER_MAYBE_BEYOND;
  return (left || right) && (before || after) && (beyond || within);
}

void chi_fiber_polygon_free(const chi_exec* exec, chi_fiber_polygon* polygon)
{
  chi_buffer_free(exec, &polygon->segments);
  chi_buffer_free(exec, &polygon->corner_buffer);
  chi_buffer_free(exec, &polygon->given);
  chi_buffer_free(exec, &polygon->order);
}
