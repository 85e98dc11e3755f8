/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A body of one piece whose boundary is convex at every edge, with two faces at each, is convex.
 */
#include "chi_tet_order_internal.h"

#include <math.h>

static chi_status count_pieces(
  const chi_exec* exec, size_t n, const uint32_t* neighbors, int32_t* pieces)
{
  chi_buffer stacks = { 0 }, seen = { 0 };
  if (!chi_buffer_reserve(exec, &stacks, n, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &seen, n, 1))
  {
    chi_buffer_free(exec, &stacks);
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  uint32_t* const stack = (uint32_t*)stacks.data;
  uint8_t* const is_seen = (uint8_t*)seen.data;
  if (n > 0)
  {
    memset(is_seen, 0, n);
  }
  *pieces = 0;
  for (size_t start = 0; start < n; ++start)
  {
    if (is_seen[start])
    {
      continue;
    }
    size_t depth = 0;
    *pieces += *pieces < INT32_MAX;
    stack[depth++] = (uint32_t)start;
    is_seen[start] = 1;
    while (depth > 0)
    {
      const size_t t = stack[--depth];
      for (size_t i = 0; i < 4; ++i)
      {
        const uint32_t u = neighbors[4 * t + i];
        if (u < n && !is_seen[u])
        {
          is_seen[u] = 1;
          stack[depth++] = u;
        }
      }
    }
  }
  chi_buffer_free(exec, &stacks);
  chi_buffer_free(exec, &seen);
  return CHI_OK;
}

typedef struct edge
{
  uint32_t from, to, face; /* as the face runs; 4 t + i */
  uint32_t faces;          /* at it; 0: an empty place of the table */
} edge;

static void get(const chi_tet_mesh_view* mesh, uint32_t face, size_t k, double x[3])
{
  chi_view_get(
    &mesh->points, mesh->vertices[(face & ~3u) + (size_t)chi_order_face[face & 3][k]], x);
}

/* Whether none of b's vertices lies beyond the plane of a. Coordinates are known to a rounding of
 * their type: a box that is turned stays convex. */
static int is_convex(const chi_tet_mesh_view* mesh, uint32_t a, uint32_t b)
{
  double x[3][3], most = 0;
  for (size_t k = 0; k < 3; ++k)
  {
    get(mesh, a, k, x[k]);
  }
  for (size_t j = 0; j < 3; ++j)
  {
    double y[3], e[3][3], n[3], length[3];
    get(mesh, b, j, y);
    for (int k = 0; k < 3; ++k)
    {
      e[0][k] = x[1][k] - x[0][k];
      e[1][k] = x[2][k] - x[0][k];
      e[2][k] = y[k] - x[0][k];
      most = fmax(fmax(most, fabs(x[0][k])), fmax(fabs(x[1][k]), fmax(fabs(x[2][k]), fabs(y[k]))));
    }
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      n[k] = e[0][l] * e[1][m] - e[0][m] * e[1][l];
      length[k] = sqrt(e[k][0] * e[k][0] + e[k][1] * e[k][1] + e[k][2] * e[k][2]);
    }
    /* the determinant's change where each of its vectors changes by two such errors */
    const double known = 2 * sqrt(3) * most * (mesh->points.type == CHI_F32 ? 0x1p-24 : 0x1p-52);
    const double bound =
      known * (length[0] * length[1] + length[1] * length[2] + length[2] * length[0]);
    if (!(n[0] * e[2][0] + n[1] * e[2][1] + n[2] * e[2][2] <= bound))
    {
      return 0;
    }
  }
  return 1;
}

/* Every edge of the boundary: two faces, which run along it in opposite senses. */
static int32_t are_edges_convex(
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency, edge* table, size_t places)
{
  memset(table, 0, places * sizeof *table);
  size_t open = 0;
  for (size_t f = 0; f < adjacency->exterior_count; ++f)
  {
    const size_t id = ((const uint32_t*)adjacency->exterior.data)[f];
    for (size_t k = 0; k < 3; ++k)
    {
      const uint32_t* const v = mesh->vertices + (id & ~(size_t)3);
      const uint32_t from = v[chi_order_face[id & 3][k]],
                     to = v[chi_order_face[id & 3][(k + 1) % 3]];
      const uint32_t low = from < to ? from : to, high = from < to ? to : from;
      size_t at =
        (low * 0x9e3779b97f4a7c15u ^ high * 0xc2b2ae3d27d4eb4fu) * 0x9e3779b97f4a7c15u >> 20;
      at &= places - 1;
      while (table[at].faces &&
        !((table[at].from == from && table[at].to == to) ||
          (table[at].from == to && table[at].to == from)))
      {
        at = (at + 1) & (places - 1);
      }
      edge* const e = table + at;
      if (e->faces == 0)
      {
        *e = (edge){ from, to, (uint32_t)id, 1 };
        ++open;
      }
      else if (e->faces == 1 && e->from == to && is_convex(mesh, e->face, (uint32_t)id))
      {
        e->faces = 2;
        --open;
      }
      else
      {
        return 0;
      }
    }
  }
  return open == 0;
}

chi_status chi_order_shape_find(const chi_exec* exec, chi_order_shape* shape,
  const chi_tet_mesh_view* mesh, const chi_order_adjacency* adjacency)
{
  const uint32_t* const neighbors = (const uint32_t*)adjacency->neighbors.data;
  shape->convex = 0;
  const chi_status status = count_pieces(exec, mesh->count, neighbors, &shape->pieces);
  if (status != CHI_OK || shape->pieces != 1 || adjacency->bad > 0)
  {
    return status;
  }
  size_t places = 64;
  while (places < 3 * (size_t)adjacency->boundary) /* twice the edges */
  {
    places *= 2;
  }
  chi_buffer table = { 0 };
  if (!chi_buffer_reserve(exec, &table, places, sizeof(edge)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  shape->convex = are_edges_convex(mesh, adjacency, (edge*)table.data, places);
  chi_buffer_free(exec, &table);
  return CHI_OK;
}
