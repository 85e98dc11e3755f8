/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_area.h"

#include <math.h>
#include <string.h>

/* A point of a triangle of the fan: its shares of the thick point and of the second corner. */
typedef struct place
{
  double x, y, thick, second;
} place;

enum
{
  MOST = 8 /* corners of a triangle cut by four lines, and one more on the way */
};

/* Depths that differ by more than this, of the nearest, make thickness bend: its second derivative
 * along a triangle is of the difference's square, which two orders of a rule leave a sixtieth of.
 */
#define DEEP 0.02

/* Rules over a triangle: exact for polynomials of degree 2, so for thickness times a value, both
 * linear; and of degree 5 (Radon 1948). */
typedef struct rule
{
  int count;
  double weight[7], at[7][2];
} rule;

static const rule flat_rule = { 3, { 1.0 / 3, 1.0 / 3, 1.0 / 3 },
  { { 0.5, 0.5 }, { 0.5, 0 }, { 0, 0.5 } } };

#define A 0.10128650732345634
#define B 0.47014206410511509
#define WA 0.12593918054482715
#define WB 0.13239415278850618
static const rule deep_rule = { 7, { 0.225, WA, WA, WA, WB, WB, WB },
  { { 1.0 / 3, 1.0 / 3 }, { A, A }, { 1 - 2 * A, A }, { A, 1 - 2 * A }, { B, B }, { 1 - 2 * B, B },
    { B, 1 - 2 * B } } };

static chi_tet_area_end make_end(const chi_tet_scene* s, const chi_tet_corner* c)
{
  const double w = s->parallel ? c->depth : 1 / c->depth, times = s->parallel ? 1 : w;
  chi_tet_area_end end = { .w = w };
  for (int q = 0; q < CHI_TET_QUANTITIES; ++q)
  {
    end.value[q] = c->value[q] * times;
  }
  return end;
}

/* Twice the area of a triangle of the fan; its edges. */
static double make_triangle(chi_tet_area* area, int k)
{
  const chi_tet_fan* const f = &area->fan;
  const chi_tet_corner* const c[3] = { f->thick, f->corner + k, f->corner + (k + 1) % f->count };
  for (int i = 0; i < 3; ++i)
  {
    const chi_tet_corner *const p = c[i], *const q = c[(i + 1) % 3];
    const double a = p->y - q->y, b = q->x - p->x, size = fabs(a) + fabs(b);
    const double by = size > 0 ? 1 / size : 0;
    double* const e = area->edge[k][i];
    e[0] = a * by;
    e[1] = b * by;
    e[2] = size > 0 ? -(e[0] * p->x + e[1] * p->y) : -1; /* outside: it has no area */
  }
  return (c[1]->x - c[0]->x) * (c[2]->y - c[0]->y) - (c[1]->y - c[0]->y) * (c[2]->x - c[0]->x);
}

void chi_tet_area_begin(chi_tet_area* area, const chi_tet_scene* scene, uint32_t tetrahedron)
{
  area->scene = scene;
  area->tetrahedron = tetrahedron;
  (void)chi_tet_fan_make(scene, tetrahedron, &area->fan);
  const chi_tet_fan* const f = &area->fan;
  double nearest = f->thick[0].depth, farthest = f->thick[1].depth;
  for (int k = 0; k < f->count; ++k)
  {
    area->corner[k] = make_end(scene, f->corner + k);
    area->size[k] = make_triangle(area, k);
    nearest = fmin(nearest, f->corner[k].depth);
    farthest = fmax(farthest, f->corner[k].depth);
  }
  area->thick[0] = make_end(scene, f->thick);
  area->thick[1] = make_end(scene, f->thick + 1);
  area->quantities = scene->colors ? CHI_TET_QUANTITIES : scene->separate ? 2 : 1;
  area->is_deep = !scene->parallel && farthest > (1 + DEEP) * nearest;
}

/* What stays of a polygon on the side of a line along an axis. */
static int cut(const place* in, int count, int axis, double at, double side, place out[MOST])
{
  int kept = 0;
  for (int i = 0; i < count; ++i)
  {
    const place *const p = in + i, *const q = in + (i + 1) % count;
    const double d = side * ((axis ? p->y : p->x) - at), e = side * ((axis ? q->y : q->x) - at);
    if (d >= 0)
    {
      out[kept++] = *p;
    }
    if ((d > 0 && e < 0) || (d < 0 && e > 0))
    {
      const double t = d / (d - e);
      out[kept++] = (place){ p->x + t * (q->x - p->x), p->y + t * (q->y - p->y),
        p->thick + t * (q->thick - p->thick), p->second + t * (q->second - p->second) };
    }
  }
  return kept;
}

/* Along the ray of a place what lies behind clip planes and in front of the surface, depths. */
static void find_limits(const chi_tet_area* area, double x, double y, float surface, double z[2])
{
  const chi_tet_scene* const s = area->scene;
  const double u = s->first[0] + s->step[0] * x, v = s->first[1] + s->step[1] * y;
  z[0] = -INFINITY;
  z[1] = surface > 0 ? surface : INFINITY;
  for (size_t k = 0; k < s->plane_count; ++k)
  {
    const double* const n = s->planes + 4 * k;
    const double rise = s->parallel ? n[2] : n[0] * u + n[1] * v + n[2];
    const double at = s->parallel ? n[0] * u + n[1] * v + n[3] : n[3];
    if (rise > 0)
    {
      z[0] = fmax(z[0], -at / rise);
    }
    else if (rise < 0)
    {
      z[1] = fmin(z[1], -at / rise);
    }
    else if (at < 0)
    {
      z[1] = -INFINITY;
    }
  }
}

typedef struct ray_list
{
  chi_tet_area_ray* rays;
  int count;
} ray_list;

/* The ray at a place of a triangle, for such a share of the pixel. */
static void add_ray(
  const chi_tet_area* area, int k, const place* p, double share, const float* surface, ray_list* to)
{
  if (!(p->thick > 0))
  {
    return; /* on the silhouette */
  }
  const chi_tet_scene* const s = area->scene;
  const chi_tet_area_end* const a = area->corner + k;
  const chi_tet_area_end* const b = area->corner + (k + 1) % area->fan.count;
  const double first = 1 - p->thick - p->second;
  const int n = area->quantities;
  double z[2], value[CHI_TET_QUANTITIES][2]; /* at both ends */
  for (int end = 0; end < 2; ++end)
  {
    const chi_tet_area_end* const t = area->thick + end;
    const double w = p->thick * t->w + first * a->w + p->second * b->w;
    const double by = s->parallel ? 1 : 1 / w;
    z[end] = s->parallel ? w : by;
    for (int q = 0; q < n; ++q)
    {
      value[q][end] = by * (p->thick * t->value[q] + first * a->value[q] + p->second * b->value[q]);
    }
  }
  double length = s->parallel ? p->thick * (area->thick[1].w - area->thick[0].w)
                              : p->thick * (area->thick[0].w - area->thick[1].w) * z[0] * z[1];
  if (surface)
  {
    double limit[2];
    find_limits(area, p->x, p->y, *surface, limit);
    const double from = fmax(z[0], limit[0]), until = fmin(z[1], limit[1]);
    if (!(from < until))
    {
      return;
    }
    for (int q = 0; q < n; ++q)
    {
      const double slope = (value[q][1] - value[q][0]) / (z[1] - z[0]), base = value[q][0];
      value[q][0] = base + slope * (from - z[0]);
      value[q][1] = base + slope * (until - z[0]);
    }
    length = until - from;
  }
  length *= chi_tet_slant(s, p->x, p->y);
  if (length > 0)
  {
    chi_tet_area_ray* const ray = to->rays + to->count++;
    ray->share = share;
    ray->length = length;
    memcpy(ray->value, value, (size_t)n * sizeof *value);
  }
}

/* A polygon within a triangle of the fan. */
static void add_polygon(const chi_tet_area* area, int k, const place* p, int count, const rule* by,
  const float* surface, ray_list* to)
{
  for (int i = 1; i + 1 < count; ++i)
  {
    const place *const a = p, *const b = p + i, *const c = p + i + 1;
    const double size = 0.5 * ((b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x));
    if (!(size > 0))
    {
      continue;
    }
    for (int n = 0; n < by->count; ++n)
    {
      const double v = by->at[n][0], w = by->at[n][1], u = 1 - v - w;
      const place at = { u * a->x + v * b->x + w * c->x, u * a->y + v * b->y + w * c->y,
        u * a->thick + v * b->thick + w * c->thick, u * a->second + v * b->second + w * c->second };
      add_ray(area, k, &at, size * by->weight[n], surface, to);
    }
  }
}

/* Whether a triangle lies in the pixel. */
static int is_within(const place p[3], double x, double y)
{
  int within = 1;
  for (int i = 0; i < 3; ++i)
  {
    within &= fabs(p[i].x - x) <= 0.5;
    within &= fabs(p[i].y - y) <= 0.5;
  }
  return within;
}

static void add_triangle(const chi_tet_area* area, int k, double x, double y, const rule* by,
  const float* surface, ray_list* to)
{
  const chi_tet_fan* const f = &area->fan;
  int around = 1;
  double at[3];
  for (int i = 0; i < 3; ++i)
  {
    const double* const e = area->edge[k][i];
    at[i] = e[0] * x + e[1] * y + e[2]; /* the pixel reaches half a unit to both sides */
    if (at[i] <= -0.5)
    {
      return;
    }
    around &= at[i] >= 0.5;
  }
  const chi_tet_corner *const a = f->corner + k, *const b = f->corner + (k + 1) % f->count;
  if (around && !surface)
  {
    /* all of the pixel: what is linear has its mean in the middle */
    const double t = (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
    const double u =
      (a->x - f->thick[0].x) * (y - f->thick[0].y) - (a->y - f->thick[0].y) * (x - f->thick[0].x);
    const place middle = { x, y, t / area->size[k], u / area->size[k] };
    add_ray(area, k, &middle, 1, NULL, to);
    return;
  }
  place one[MOST], other[MOST];
  one[0] = (place){ f->thick[0].x, f->thick[0].y, 1, 0 };
  one[1] = (place){ a->x, a->y, 0, 0 };
  one[2] = (place){ b->x, b->y, 0, 1 };
  int count = 3;
  if (!is_within(one, x, y))
  {
    count = cut(one, count, 0, x - 0.5, 1, other);
    count = cut(other, count, 0, x + 0.5, -1, one);
    count = cut(one, count, 1, y - 0.5, 1, other);
    count = cut(other, count, 1, y + 0.5, -1, one);
  }
  add_polygon(area, k, one, count, by, surface, to);
}

int chi_tet_area_of_pixel(
  const chi_tet_area* area, int32_t x, int32_t y, chi_tet_area_ray rays[CHI_TET_AREA_RAYS])
{
  const chi_tet_scene* const s = area->scene;
  const int32_t pixel[2] = { x, y };
  const int cuts =
    (s->plane_count || s->depth) && chi_tet_fan_is_cut(s, area->tetrahedron, pixel, pixel);
  const float surface =
    cuts && s->depth ? s->depth[(size_t)y * (size_t)s->width + (size_t)x] : 0.0f;
  ray_list list = { rays, 0 };
  for (int k = 0; k < area->fan.count; ++k)
  {
    add_triangle(area, k, x, y, area->is_deep || cuts ? &deep_rule : &flat_rule,
      cuts ? &surface : NULL, &list);
  }
  return list.count;
}

enum
{
  PLACES = 8 /* a side of a pixel */
};

uint64_t chi_tet_area_cover(const chi_tet_area* area, int32_t x, int32_t y)
{
  const double left = x - 0.5 + 0.5 / PLACES, lowest = y - 0.5 + 0.5 / PLACES;
  uint64_t cover = 0;
  for (int row = 0; row < PLACES; ++row)
  {
    double low = 0, high = PLACES - 1; /* what all edges of the silhouette leave of the row */
    for (int k = 0; k < area->fan.count; ++k)
    {
      const double* const e = area->edge[k][1];
      const double at = e[0] * left + e[1] * (lowest + (double)row / PLACES) + e[2];
      const double step = e[0] / PLACES;
      low = step > 0 ? fmax(low, -at / step) : low;
      high = step < 0 ? fmin(high, -at / step) : step == 0 && at < 0 ? -1 : high;
    }
    if (low <= high)
    {
      const int from = (int)ceil(low), to = (int)high;
      for (int i = from; i <= to; ++i)
      {
        cover |= (uint64_t)1 << (PLACES * row + i);
      }
    }
  }
  if (!cover)
  {
    const chi_tet_corner* const p = area->fan.thick;
    const double i = fmin(fmax((p->x - x + 0.5) * PLACES, 0), PLACES - 1);
    const double j = fmin(fmax((p->y - y + 0.5) * PLACES, 0), PLACES - 1);
    cover = (uint64_t)1 << (PLACES * (int)j + (int)i);
  }
  return cover;
}
