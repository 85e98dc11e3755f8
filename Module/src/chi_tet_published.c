/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tetrahedra as Shirley & Tuchman, "A Polygonal Approximation to Direct Scalar Volume Rendering",
 * 1990, draw them: each as the triangles of its fan, over which thickness and scalars are linear on
 * the screen. The thick point's are exact; in perspective those between are not. To compare with.
 */
#include "chi_tet_internal.h"

#include "chi_tet_fan.h"

#include <math.h>

/* Twice the signed area between an edge and a point, by the ends in an order of their own, so that
 * the triangles on both sides of the edge get the same bits with opposite signs. */
static double side_of(const chi_tet_corner* a, const chi_tet_corner* b, double x, double y)
{
  const int swapped = a->y > b->y || (a->y == b->y && a->x > b->x);
  const chi_tet_corner *const from = swapped ? b : a, *const to = swapped ? a : b;
  const double area = (to->x - from->x) * (y - from->y) - (to->y - from->y) * (x - from->x);
  return swapped ? -area : area;
}

/* Whether the triangle left of the edge has a point that lies on it: of two triangles one has. */
static int owns(const chi_tet_corner* a, const chi_tet_corner* b)
{
  return b->y < a->y || (b->y == a->y && b->x < a->x);
}

static int covers(double side, const chi_tet_corner* a, const chi_tet_corner* b)
{
  return side > 0 || (side == 0 && owns(a, b));
}

/* First and last pixel of a tile, columns or rows, between the least and the largest of some
 * coordinates of the window. */
static void find_range(
  const chi_tet_corner* const of[], int count, int axis, const int32_t tile[2], int32_t range[2])
{
  double low = INFINITY, high = -INFINITY;
  for (int i = 0; i < count; ++i)
  {
    const double at = (axis ? of[i]->y : of[i]->x) - tile[axis];
    low = fmin(low, at);
    high = fmax(high, at);
  }
  range[0] = low > 0 ? low < CHI_TET_TILE ? (int32_t)ceil(low) : CHI_TET_TILE : 0;
  range[1] = high < CHI_TET_TILE - 1 ? high >= 0 ? (int32_t)floor(high) : -1 : CHI_TET_TILE - 1;
}

static void fill(const chi_tet_scene* s, uint32_t tetrahedron, const chi_tet_fan* fan, int k,
  const int32_t tile[2], chi_tet_sink* sink)
{
  const chi_tet_corner* const c[3] = { fan->thick, fan->corner + k,
    fan->corner + (k + 1) % fan->count };
  const double thickness = (fan->thick[1].depth - fan->thick[0].depth) *
    chi_tet_slant(s, fan->thick[0].x, fan->thick[0].y);
  int32_t columns[2], rows[2];
  find_range(c, 3, 0, tile, columns);
  find_range(c, 3, 1, tile, rows);
  for (int32_t row = rows[0]; row <= rows[1]; ++row)
  {
    for (int32_t column = columns[0]; column <= columns[1]; ++column)
    {
      const double x = tile[0] + column, y = tile[1] + row;
      double weight[3], sum = 0;
      int inside = 1;
      for (int i = 0; i < 3; ++i)
      {
        const chi_tet_corner *const a = c[(i + 1) % 3], *const b = c[(i + 2) % 3];
        weight[i] = side_of(a, b, x, y);
        inside &= covers(weight[i], a, b);
        sum += weight[i];
      }
      if (!inside || !(sum > 0))
      {
        continue;
      }
      chi_tet_fragment f = { .pixel = row * CHI_TET_TILE + column,
        .length = (float)(thickness * weight[0] / sum / chi_tet_slant(s, x, y)) };
      for (int q = 0; q < CHI_TET_QUANTITIES; ++q)
      {
        const double edge = weight[1] * c[1]->value[q] + weight[2] * c[2]->value[q];
        for (int end = 0; end < 2; ++end)
        {
          f.value[q][end] = (float)((weight[0] * fan->thick[end].value[q] + edge) / sum);
        }
      }
      sink->put(sink, tetrahedron, &f);
    }
  }
}

/* Whether a clip plane, or the surface of one of its pixels, cuts it. */
static int is_cut(
  const chi_tet_scene* s, uint32_t tetrahedron, const chi_tet_fan* fan, const int32_t tile[2])
{
  const int32_t end[2] = { s->width, s->height };
  int32_t low[2], high[2];
  if (!s->plane_count && !s->depth)
  {
    return 0;
  }
  for (int k = 0; k < 2; ++k)
  {
    int32_t range[2];
    const chi_tet_corner* const c[4] = { fan->corner, fan->corner + 1, fan->corner + 2,
      fan->corner + 3 };
    find_range(c, fan->count, k, tile, range);
    low[k] = tile[k] + range[0];
    high[k] = tile[k] + range[1] < end[k] ? tile[k] + range[1] : end[k] - 1;
  }
  return chi_tet_fan_is_cut(s, tetrahedron, low, high);
}

int chi_tet_publish(chi_tet_projector* projector, const chi_tet_scene* scene, uint32_t tetrahedron,
  const int32_t tile[2], chi_tet_sink* sink)
{
  chi_tet_fan fan;
  if (!chi_tet_fan_make(scene, tetrahedron, &fan) || is_cut(scene, tetrahedron, &fan, tile))
  {
    ++projector->left;
    return CHI_TET_REST_ALL;
  }
  if (fan.count > 0 && fan.thick[1].depth > fan.thick[0].depth)
  {
    for (int k = 0; k < fan.count; ++k)
    {
      fill(scene, tetrahedron, &fan, k, tile, sink);
    }
  }
  return CHI_TET_REST_NONE;
}
