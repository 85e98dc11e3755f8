/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_ORDER_MESHES_H
#define CHI_TET_ORDER_MESHES_H

/* Meshes whose visibility order is judged, and the judge: all pairs on each ray. */

#include "chi_test.h"
#include "tet_reference.h"
#include "tet_scenes.h"

#include <chiaroscuro/chi_tet_order.h>

/* Vertices and tetrahedra, at most so many. */
typedef struct order_mesh
{
  double (*points)[3];
  uint32_t (*vertices)[4];
  size_t point_count, count;
} order_mesh;

__attribute__((unused)) static order_mesh order_mesh_room(size_t points, size_t count)
{
  order_mesh m = { calloc(points, 24), calloc(count + 1, 16), points, count };
  if (!m.points || !m.vertices)
  {
    exit(1);
  }
  return m;
}

__attribute__((unused)) static void order_mesh_free(order_mesh* m)
{
  free(m->points);
  free(m->vertices);
}

/* Swaps vertices of those that are left-handed. */
__attribute__((unused)) static void order_mesh_orient(order_mesh* m)
{
  for (size_t t = 0; t < m->count; ++t)
  {
    double e[3][3];
    for (int i = 0; i < 3; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        e[i][k] = m->points[m->vertices[t][i + 1]][k] - m->points[m->vertices[t][0]][k];
      }
    }
    const double volume = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
      e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
      e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    if (volume < 0)
    {
      const uint32_t v = m->vertices[t][2];
      m->vertices[t][2] = m->vertices[t][3];
      m->vertices[t][3] = v;
    }
  }
}

/* Cubes of six tetrahedra, inner points moved by so much of an edge. */
__attribute__((unused)) static order_mesh order_mesh_cubes(size_t n, double moved, uint32_t seed)
{
  tet_mesh* const from = tet_mesh_cubes(n, TET_CONSTANT);
  order_mesh m = order_mesh_room(from->point_count, from->count);
  memcpy(m.points, from->points, 24 * m.point_count);
  memcpy(m.vertices, from->vertices, 16 * m.count);
  tet_mesh_free(from);
  for (size_t i = 0; i < m.point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double by = moved * 2 / (double)n * (chi_test_random(&seed) - 0.5);
      m.points[i][k] += fabs(m.points[i][k]) < 1 - 1e-9 ? by : 0;
    }
  }
  order_mesh_orient(&m);
  return m;
}

/* Cubes of twelve tetrahedra around their centres; their faces' diagonals are drawn by lot. The two
 * halves of each pyramid lie between points of one sphere. */
__attribute__((unused)) static order_mesh order_mesh_centered(size_t n, uint32_t seed)
{
  const size_t side = n + 1, corners = side * side * side;
  order_mesh m = order_mesh_room(corners + n * n * n, 12 * n * n * n);
  uint8_t* const diagonal = malloc(3 * corners);
  for (size_t i = 0; i < 3 * corners; ++i)
  {
    diagonal[i] = chi_test_random(&seed) < 0.5;
  }
  const size_t step[3] = { 1, side, side * side };
  for (size_t i = 0; i < corners; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      m.points[i][a] = 2.0 * (double)(i / step[a] % side) / (double)n - 1;
    }
  }
  size_t t = 0;
  for (size_t c = 0; c < n * n * n; ++c)
  {
    const size_t first = c % n + side * (c / n % n) + side * side * (c / n / n);
    for (int a = 0; a < 3; ++a)
    {
      m.points[corners + c][a] = m.points[first][a] + 1 / (double)n;
    }
    for (size_t f = 0; f < 6; ++f)
    {
      const size_t a = f / 2, at = first + (f % 2) * step[a];
      const size_t u = step[(a + 1) % 3], v = step[(a + 2) % 3];
      const size_t ring[4] = { at, at + u, at + u + v, at + v }, k = diagonal[3 * at + a];
      for (size_t half = 0; half < 2; ++half, ++t)
      {
        m.vertices[t][0] = (uint32_t)(corners + c);
        m.vertices[t][1] = (uint32_t)ring[k];
        m.vertices[t][2] = (uint32_t)ring[(k + 2) % 4];
        m.vertices[t][3] = (uint32_t)ring[(k + 1 + 2 * half) % 4];
      }
    }
  }
  free(diagonal);
  order_mesh_orient(&m);
  return m;
}

/* Delaunay's mesh of a few points in general position: any four in whose sphere lies no other. */
__attribute__((unused)) static order_mesh order_mesh_delaunay(const double (*points)[3], size_t n)
{
  order_mesh m = order_mesh_room(n, 16 * n);
  memcpy(m.points, points, 24 * n);
  m.count = 0;
  for (size_t i = 0; i < n * n * n * n; ++i)
  {
    const size_t id[4] = { i % n, i / n % n, i / n / n % n, i / n / n / n };
    if (id[0] >= id[1] || id[1] >= id[2] || id[2] >= id[3])
    {
      continue;
    }
    double e[3][3], square[3], normal[3][3], center[3];
    for (int k = 0; k < 9; ++k)
    {
      e[k / 3][k % 3] = points[id[k / 3 + 1]][k % 3] - points[id[0]][k % 3];
    }
    for (int k = 0; k < 3; ++k)
    {
      const double *const a = e[(k + 1) % 3], *const b = e[(k + 2) % 3];
      square[k] = e[k][0] * e[k][0] + e[k][1] * e[k][1] + e[k][2] * e[k][2];
      for (int c = 0; c < 3; ++c)
      {
        normal[k][c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
      }
    }
    const double volume = e[0][0] * normal[0][0] + e[0][1] * normal[0][1] + e[0][2] * normal[0][2];
    for (int c = 0; c < 3; ++c) /* from the first of the four */
    {
      center[c] = (square[0] * normal[0][c] + square[1] * normal[1][c] + square[2] * normal[2][c]) /
        (2 * volume);
    }
    size_t other = 0;
    for (; other < n; ++other)
    {
      /* |x - center|^2 - |center|^2, without the squares of a center that is far away */
      double power = 0;
      for (int c = 0; c < 3; ++c)
      {
        const double x = points[other][c] - points[id[0]][c];
        power += x * (x - 2 * center[c]);
      }
      if (power < 0 && other != id[0] && other != id[1] && other != id[2] && other != id[3])
      {
        break;
      }
    }
    for (int k = 0; k < 4 && other == n; ++k)
    {
      m.vertices[m.count][k] = (uint32_t)id[k];
    }
    m.count += other == n;
  }
  order_mesh_orient(&m);
  return m;
}

/* Leaves out groups of six by lot: holes, cavities, pieces. */
__attribute__((unused)) static void order_mesh_thin(order_mesh* m, double share, uint32_t seed)
{
  size_t kept = 0;
  for (size_t t = 0; t < m->count; t += 6)
  {
    if (chi_test_random(&seed) >= share)
    {
      memmove(m->vertices + kept, m->vertices + t, 6 * 16);
      kept += 6;
    }
  }
  m->count = kept;
}

/* In another order, each turned about itself. */
__attribute__((unused)) static void order_mesh_shuffle(order_mesh* m, uint32_t seed)
{
  for (size_t t = m->count; t-- > 1;)
  {
    const size_t u = (size_t)(chi_test_random(&seed) * (double)(t + 1));
    uint32_t v[4];
    memcpy(v, m->vertices[t], 16);
    memcpy(m->vertices[t], m->vertices[u], 16);
    const uint32_t turned[4] = { v[1], v[2], v[0], v[3] };
    memcpy(m->vertices[u], turned, 16);
  }
}

__attribute__((unused)) static chi_tet_mesh_view order_mesh_view(const order_mesh* m)
{
  return (chi_tet_mesh_view){ sizeof(chi_tet_mesh_view), { m->points, m->point_count, 24, CHI_F64 },
    m->vertices[0], m->count };
}

/* Pairs on the rays of all pixels that are in the wrong order: of all pairs whose intervals are
 * disjoint and longer than 1e-9 of the extent, or of neighbouring ones. The definition. */
__attribute__((unused)) static long order_judge(
  const order_mesh* m, const chi_camera* camera, const uint32_t* keys, int all_pairs)
{
  float* const zero = calloc(m->count + 1, sizeof *zero);
  const tet_reference_scene scene = { .camera = camera,
    .points = (const double(*)[3])m->points,
    .vertices = (const uint32_t(*)[4])m->vertices,
    .count = m->count,
    .scalars = zero,
    .is_cell_data = 1 };
  const double least = 1e-9 * 2 * sqrt(3.0);
  long wrong = 0;
  for (int y = 0; y < camera->height; ++y)
  {
    for (int x = 0; x < camera->width; ++x)
    {
      size_t count, kept = 0;
      tet_reference_fragment* const f = tet_reference_list(&scene, x + 0.5, y + 0.5, &count);
      for (size_t i = 0; i < count; ++i)
      {
        f[kept] = f[i];
        kept += f[i].exit - f[i].entry > least;
      }
      for (size_t j = 1; j < kept; ++j)
      {
        for (size_t i = all_pairs ? 0 : j - 1; i < j; ++i)
        {
          const uint32_t near = f[i].tetrahedron, far = f[j].tetrahedron;
          wrong += f[i].exit <= f[j].entry + least &&
            (keys[near] < keys[far] || (keys[near] == keys[far] && near < far));
        }
      }
      free(f);
    }
  }
  free(zero);
  return wrong;
}

#endif
