/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_fan.h"

#include <math.h>
#include <string.h>

/* Twice the area of a triangle on the screen, positive if it is counter-clockwise. */
static double area_of(const chi_tet_corner* a, const chi_tet_corner* b, const chi_tet_corner* c)
{
  return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* A point between corners: their shares, which add up to 1, on the screen. Depths and values are
 * those of the point in space: in perspective 1 / depth and value / depth are linear. */
static chi_tet_corner mix(
  const chi_tet_scene* s, const chi_tet_corner* const of[], int count, const double share[])
{
  chi_tet_corner out = { 0 };
  double sum = 0;
  for (int i = 0; i < count; ++i)
  {
    const double weight = s->parallel ? share[i] : share[i] / of[i]->depth;
    out.x += share[i] * of[i]->x;
    out.y += share[i] * of[i]->y;
    out.depth += weight * of[i]->depth;
    for (int q = 0; q < CHI_TET_QUANTITIES; ++q)
    {
      out.value[q] += weight * of[i]->value[q];
    }
    sum += weight;
  }
  out.depth /= sum;
  for (int q = 0; q < CHI_TET_QUANTITIES; ++q)
  {
    out.value[q] /= sum;
  }
  return out;
}

static int place(const chi_tet_scene* s, uint32_t t, chi_tet_corner out[4])
{
  for (int i = 0; i < 4; ++i)
  {
    const uint32_t vertex = s->vertices[4 * (size_t)t + (size_t)i];
    const chi_tet_point* const p = s->points + vertex;
    const double w = s->parallel ? 1 : 1 / p->z;
    if (!(p->z >= s->near_depth))
    {
      return 0;
    }
    const size_t cell = s->cells ? s->cells[t] : t;
    out[i] = (chi_tet_corner){ (p->x * w - s->first[0]) / s->step[0],
      (p->y * w - s->first[1]) / s->step[1], p->z,
      { s->cell_scalars ? s->cell_scalars[cell] : p->scalar,
        s->cell_opacities ? s->cell_opacities[cell] : p->opacity } };
    for (int k = 0; k < 3 && s->colors; ++k)
    {
      out[i].value[CHI_TET_COLORS + k] = s->colors[s->cell_scalars ? cell : vertex][k];
    }
  }
  return 1;
}

/*
 * Four points in the plane have one dependence, sum q_i = 0 and sum q_i p_i = 0, of which q_i are
 * the areas of the triangles without point i, signed in turns; and the points of either sign span
 * sets that meet in one point (Radon 1921), over which the tetrahedron is thickest. So the signs
 * are the cases of the projection: three against one, a vertex within the triangle of the others;
 * two against two, edges that cross; and where some are zero, a vertex on an edge or on another
 * vertex, which is as the first, with triangles of the fan that have no area.
 */
int chi_tet_fan_make(const chi_tet_scene* scene, uint32_t tetrahedron, chi_tet_fan* fan)
{
  chi_tet_corner p[4];
  fan->count = 0;
  if (!place(scene, tetrahedron, p))
  {
    return 0;
  }
  const double q[4] = { area_of(p + 1, p + 2, p + 3), -area_of(p, p + 2, p + 3),
    area_of(p, p + 1, p + 3), -area_of(p, p + 1, p + 2) };
  const chi_tet_corner* of[2][4]; /* points of positive and of negative sign */
  double share[2][4], sum[2] = { 0, 0 };
  int id[2][4], count[2] = { 0, 0 };
  for (int i = 0; i < 4; ++i)
  {
    if (q[i] != 0)
    {
      const int side = q[i] < 0;
      id[side][count[side]] = i;
      of[side][count[side]] = p + i;
      share[side][count[side]++] = fabs(q[i]);
      sum[side] += fabs(q[i]);
    }
  }
  if (count[0] == 0 || count[1] == 0)
  {
    return 1; /* all on one line */
  }
  for (int side = 0; side < 2; ++side)
  {
    for (int i = 0; i < count[side]; ++i)
    {
      share[side][i] /= sum[side];
    }
    fan->thick[side] = mix(scene, of[side], count[side], share[side]);
  }
  if (count[0] == 1 || count[1] == 1)
  {
    const int single = count[0] == 1 ? 0 : 1, alone = id[single][0];
    for (int i = 0, k = 0; i < 4; ++i)
    {
      if (i != alone)
      {
        fan->corner[k++] = p[i];
      }
    }
    fan->count = 3;
    fan->thick[!single].x = p[alone].x; /* to the bit */
    fan->thick[!single].y = p[alone].y;
  }
  else
  {
    const chi_tet_corner around[4] = { *of[0][0], *of[1][0], *of[0][1], *of[1][1] };
    memcpy(fan->corner, around, sizeof around);
    fan->count = 4;
    fan->thick[1].x = fan->thick[0].x;
    fan->thick[1].y = fan->thick[0].y;
  }
  if (area_of(fan->corner, fan->corner + 1, fan->corner + 2) < 0)
  {
    const chi_tet_corner swap = fan->corner[0];
    fan->corner[0] = fan->corner[2];
    fan->corner[2] = swap;
  }
  if (fan->thick[0].depth > fan->thick[1].depth)
  {
    const chi_tet_corner swap = fan->thick[0];
    fan->thick[0] = fan->thick[1];
    fan->thick[1] = swap;
  }
  return 1;
}

int chi_tet_fan_is_cut(
  const chi_tet_scene* scene, uint32_t tetrahedron, const int32_t low[2], const int32_t high[2])
{
  double farthest = 0;
  for (int i = 0; i < 4; ++i)
  {
    const chi_tet_point* const p =
      scene->points + scene->vertices[4 * (size_t)tetrahedron + (size_t)i];
    farthest = i == 0 || p->z > farthest ? p->z : farthest;
    for (size_t k = 0; k < scene->plane_count; ++k)
    {
      const double* const n = scene->planes + 4 * k;
      if (n[0] * p->x + n[1] * p->y + n[2] * p->z + n[3] < 0)
      {
        return 1;
      }
    }
  }
  for (int32_t y = low[1]; scene->depth && y <= high[1]; ++y)
  {
    for (int32_t x = low[0]; x <= high[0]; ++x)
    {
      const float d = scene->depth[(size_t)y * (size_t)scene->width + (size_t)x];
      if (d > 0 && (double)d < farthest)
      {
        return 1;
      }
    }
  }
  return 0;
}

double chi_tet_slant(const chi_tet_scene* scene, double x, double y)
{
  if (scene->parallel)
  {
    return 1;
  }
  const double u = scene->first[0] + scene->step[0] * x, v = scene->first[1] + scene->step[1] * y;
  return sqrt(u * u + v * v + 1);
}
