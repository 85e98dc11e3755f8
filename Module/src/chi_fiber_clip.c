/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * What a tetrahedron has in common with a triangle of the fields' plane. Its corners are the
 * tetrahedron's, where their values lie in the triangle; points of its edges, where these pass a
 * side of the triangle; and points of its faces, whose values are a corner of the triangle. Which
 * of them there are is decided by the signs that chi_fiber_cut uses, those of a polygon that has
 * been moved off all values, so each corner lies in three of the seven faces (four of the
 * tetrahedron, three walls over the triangle's sides), and faces are walked around by that alone.
 *
 * Tetrahedra are made by joining the first corner, in an order of names that all polyhedra share,
 * with the triangles of the faces it is not in, which are fans from their own first corners. A face
 * is so divided alike on both of its sides. Source: De Loera, Rambau & Santos, "Triangulations",
 * 2010, chapter 4 (pulling).
 */

#include "chi_fiber_internal.h"

enum
{
  WALL = 4, /* faces 0 ... 3 lie opposite to that corner, 4 ... 6 over a side of the triangle */
  FACES = 7,
  NONE = -1
};

static const uint8_t edge_ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 },
  { 2, 3 } };
static const int8_t edge_of[4][4] = { { NONE, 0, 1, 2 }, { 0, NONE, 3, 4 }, { 1, 3, NONE, 5 },
  { 2, 4, 5, NONE } };
/* The face that an edge runs around counterclockwise, seen from outside of a right-handed one. */
static const int8_t face_of[4][4] = { { NONE, 2, 3, 1 }, { 3, NONE, 0, 2 }, { 1, 3, NONE, 0 },
  { 2, 0, 1, NONE } };

typedef struct clip
{
  const chi_fiber_index* index;
  const chi_fiber_pieces* pieces;
  const chi_fiber_triangle* triangle;
  uint32_t id[4];
  const double* value[4];
  uint8_t left[3][4], on_line[3][4]; /* of side s: inside; exactly on it */
  uint8_t low[6], high[6];           /* ends of edges by ascending id */
  uint8_t corner_left[6][3], corner_on[6][3];
  int8_t at_vertex[4], at_edge[6][3], at_face[4][3]; /* points */
  uint8_t faces[CHI_FIBER_CLIP_POINTS];              /* bits */
  chi_fiber_name full[CHI_FIBER_CLIP_POINTS];        /* as in general position */
  int8_t next[FACES][CHI_FIBER_CLIP_POINTS];         /* around a face */
  chi_fiber_clipped* out;
} clip;

static void find_signs(clip* c)
{
  const chi_fiber_polygon* const polygon = &c->pieces->polygon;
  for (int s = 0; s < 3; ++s)
  {
    const chi_fiber_segment* const segment = polygon->segment + c->triangle->segment[s];
    for (int k = 0; k < 4; ++k)
    {
      double area;
      c->left[s][k] =
        (uint8_t)(chi_fiber_is_left(segment, c->value[k], &area) ^ c->triangle->is_flipped[s]);
      c->on_line[s][k] = area == 0;
    }
  }
  for (int e = 0; e < 6; ++e)
  {
    const int is_up = c->id[edge_ends[e][0]] < c->id[edge_ends[e][1]];
    c->low[e] = edge_ends[e][!is_up];
    c->high[e] = edge_ends[e][is_up];
    for (int k = 0; k < 3; ++k)
    {
      double area;
      c->corner_left[e][k] = (uint8_t)chi_fiber_is_corner_left(c->value[c->low[e]],
        c->value[c->high[e]], polygon->corner[c->triangle->corner[k]].x, &area);
      c->corner_on[e][k] = area == 0;
    }
  }
}

static int add(clip* c, unsigned faces, chi_fiber_name full, chi_fiber_name name)
{
  chi_fiber_clipped* const out = c->out;
  if (out->points == CHI_FIBER_CLIP_POINTS)
  {
    return 0; /* cannot be */
  }
  c->faces[out->points] = (uint8_t)faces;
  c->full[out->points] = full;
  out->name[out->points] = name;
  return out->points++;
}

static chi_fiber_name vertex_name(uint32_t id)
{
  return (chi_fiber_name){ id, CHI_FIBER_NONE, CHI_FIBER_NONE, 0 };
}

static int add_edge_point(clip* c, int e, int s)
{
  if (c->at_edge[e][s] != NONE)
  {
    return c->at_edge[e][s];
  }
  const int a = c->low[e], b = c->high[e], k1 = (s + 1) % 3;
  const chi_fiber_name full = { c->id[a], c->id[b], CHI_FIBER_NONE, c->triangle->segment[s] };
  chi_fiber_name name = full;
  if (c->on_line[s][a] || c->on_line[s][b])
  {
    name = vertex_name(c->id[c->on_line[s][a] ? a : b]);
  }
  else if (c->corner_on[e][s] || c->corner_on[e][k1])
  {
    name.tag = CHI_FIBER_AT_CORNER | c->triangle->corner[c->corner_on[e][s] ? s : k1];
  }
  const unsigned faces = 15u & ~(1u << a) & ~(1u << b);
  return c->at_edge[e][s] = (int8_t)add(c, faces | 1u << (WALL + s), full, name);
}

static int add_face_point(clip* c, int face, int corner)
{
  if (c->at_face[face][corner] != NONE)
  {
    return c->at_face[face][corner];
  }
  int at[3], n = 0;
  for (int k = 0; k < 4; ++k)
  {
    if (k != face)
    {
      int i = n++;
      for (; i > 0 && c->id[at[i - 1]] > c->id[k]; --i)
      {
        at[i] = at[i - 1];
      }
      at[i] = k;
    }
  }
  const uint32_t tag = CHI_FIBER_AT_CORNER | c->triangle->corner[corner];
  const chi_fiber_name full = { c->id[at[0]], c->id[at[1]], c->id[at[2]], tag };
  uint32_t kept[3] = { CHI_FIBER_NONE, CHI_FIBER_NONE, CHI_FIBER_NONE };
  n = 0;
  for (int k = 0; k < 3; ++k) /* no weight: the corner lies on the edge opposite */
  {
    if (!c->corner_on[edge_of[at[(k + 1) % 3]][at[(k + 2) % 3]]][corner])
    {
      kept[n++] = c->id[at[k]];
    }
  }
  const chi_fiber_name name =
    n == 1 ? vertex_name(kept[0]) : (chi_fiber_name){ kept[0], kept[1], kept[2], tag };
  const unsigned walls = 1u << (WALL + corner) | 1u << (WALL + (corner + 2) % 3);
  return c->at_face[face][corner] = (int8_t)add(c, 1u << face | walls, full, name);
}

/* The points of a wall, counterclockwise as seen from its right side, as in chi_fiber_cut. */
static int walk_wall(clip* c, int s, int points[CHI_FIBER_CORNERS + 2])
{
  int lefts = 0, at[4], n = 0;
  for (int k = 0; k < 4; ++k)
  {
    lefts |= c->left[s][k] << k;
  }
  const chi_fiber_section* const section = chi_fiber_sections + lefts;
  const int k1 = (s + 1) % 3;
  for (int k = 0; k < section->count; ++k)
  {
    const int e = edge_of[section->edge[k][0]][section->edge[k][1]];
    const int rises = c->left[s][c->high[e]];
    at[k] = c->corner_left[e][s] != rises ? -1 : c->corner_left[e][k1] == rises ? 1 : 0;
  }
  for (int k = 0; k < section->count; ++k)
  {
    const int k2 = k + 1 < section->count ? k + 1 : 0, from = at[k], to = at[k2];
    const uint8_t *const a = section->edge[k], *const b = section->edge[k2];
    if (from == 0)
    {
      points[n++] = add_edge_point(c, edge_of[a[0]][a[1]], s);
    }
    if (from == to)
    {
      continue;
    }
    const int third = b[0] == a[0] || b[0] == a[1] ? b[1] : b[0];
    const int face = 6 - a[0] - a[1] - third;
    const int starts = (from < 0) != (to < 0), ends = (from > 0) != (to > 0);
    if (starts && from < 0)
    {
      points[n++] = add_face_point(c, face, s);
    }
    if (ends)
    {
      points[n++] = add_face_point(c, face, k1);
    }
    if (starts && to < 0)
    {
      points[n++] = add_face_point(c, face, s);
    }
  }
  return n;
}

/* Around the faces: each edge of a wall is run back in the other face that it lies in; what is left
 * of the tetrahedron's own edges runs around one of its faces so, around the other back. */
static void find_walls(clip* c)
{
  for (int s = 0; s < 3; ++s)
  {
    int points[CHI_FIBER_CORNERS + 2];
    const int n = walk_wall(c, s, points);
    for (int k = 0; k < n; ++k)
    {
      const int u = points[k], v = points[k + 1 < n ? k + 1 : 0];
      const int others = c->faces[u] & c->faces[v] & ~(1 << (WALL + s));
      c->next[WALL + s][u] = (int8_t)v;
      for (int f = 0; f < FACES; ++f)
      {
        if (others >> f & 1 && f < WALL)
        {
          c->next[f][v] = (int8_t)u;
        }
      }
    }
  }
}

static void find_edges(clip* c)
{
  for (int e = 0; e < 6; ++e)
  {
    const int a = edge_ends[e][0], b = edge_ends[e][1];
    int first = c->at_vertex[a], last = c->at_vertex[b];
    for (int s = 0; s < 3; ++s)
    {
      const int point = c->at_edge[e][s];
      first = point != NONE && !c->left[s][a] ? point : first;
      last = point != NONE && c->left[s][a] ? point : last;
    }
    if (first != NONE && last != NONE)
    {
      c->next[face_of[a][b]][first] = (int8_t)last;
      c->next[face_of[b][a]][last] = (int8_t)first;
    }
  }
}

static int is_before(const chi_fiber_name* x, const chi_fiber_name* y)
{
  return x->a != y->a ? x->a < y->a
    : x->b != y->b    ? x->b < y->b
    : x->c != y->c    ? x->c < y->c
                      : x->tag < y->tag;
}

static int is_one(const chi_fiber_clipped* out, int i, int j)
{
  return chi_fiber_same(out->name + i, out->name + j);
}

static void add_cell(chi_fiber_clipped* out, int a, int b, int c, int d)
{
  const int falls_together = is_one(out, a, b) || is_one(out, a, c) || is_one(out, a, d) ||
    is_one(out, b, c) || is_one(out, b, d) || is_one(out, c, d);
  if (!falls_together && out->cells < CHI_FIBER_CLIP_CELLS)
  {
    uint8_t* const cell = out->cell[out->cells++];
    cell[0] = (uint8_t)a;
    cell[1] = (uint8_t)b;
    cell[2] = (uint8_t)c;
    cell[3] = (uint8_t)d;
  }
}

static void pull(clip* c)
{
  chi_fiber_clipped* const out = c->out;
  int apex = 0;
  for (int i = 1; i < out->points; ++i)
  {
    apex = is_before(c->full + i, c->full + apex) ? i : apex;
  }
  for (int f = 0; f < FACES; ++f)
  {
    int first = NONE;
    for (int i = 0; i < out->points; ++i)
    {
      if (c->next[f][i] != NONE && (first == NONE || is_before(c->full + i, c->full + first)))
      {
        first = i;
      }
    }
    if (first == NONE || c->faces[apex] >> f & 1)
    {
      continue;
    }
    int u = c->next[f][first];
    for (int step = 0; step < out->points && u != NONE; ++step)
    {
      const int v = c->next[f][u];
      if (v == first || v == NONE)
      {
        break;
      }
      add_cell(out, apex, first, u, v);
      u = v;
    }
  }
}

void chi_fiber_clip(const chi_fiber_index* index, const chi_fiber_pieces* pieces,
  const uint32_t v[4], size_t triangle, chi_fiber_clipped* out)
{
  clip c = { .index = index,
    .pieces = pieces,
    .triangle = pieces->triangle + triangle,
    .id = { v[0], v[1], v[2], v[3] },
    .out = out };
  out->points = out->cells = 0;
  for (int k = 0; k < 4; ++k)
  {
    c.value[k] = index->values[v[k]];
  }
  memset(c.at_vertex, NONE, sizeof c.at_vertex);
  memset(c.at_edge, NONE, sizeof c.at_edge);
  memset(c.at_face, NONE, sizeof c.at_face);
  memset(c.next, NONE, sizeof c.next);
  find_signs(&c);
  for (int k = 0; k < 4; ++k)
  {
    if (c.left[0][k] && c.left[1][k] && c.left[2][k])
    {
      const chi_fiber_name name = vertex_name(v[k]);
      c.at_vertex[k] = (int8_t)add(&c, 15u & ~(1u << k), name, name);
    }
  }
  find_walls(&c);
  find_edges(&c);
  pull(&c);
}

int chi_fiber_passes(
  const chi_fiber_index* index, const chi_fiber_segment* segment, const uint32_t v[4])
{
  int lefts = 0, before = 0, beyond = 0;
  for (int k = 0; k < 4; ++k)
  {
    double area;
    lefts |= chi_fiber_is_left(segment, index->values[v[k]], &area) << k;
  }
  const chi_fiber_section* const section = chi_fiber_sections + lefts;
  for (int k = 0; k < section->count; ++k)
  {
    const int a = section->edge[k][0], b = section->edge[k][1];
    const int low = v[a] < v[b] ? a : b, high = v[a] < v[b] ? b : a;
    const double *const from = index->values[v[low]], *const to = index->values[v[high]];
    const int rises = lefts >> high & 1;
    double area;
    const int is_before = chi_fiber_is_corner_left(from, to, segment->p, &area) != rises;
    before += is_before;
    beyond += !is_before && chi_fiber_is_corner_left(from, to, segment->q, &area) == rises;
  }
  return section->count > 0 && before < section->count && beyond < section->count;
}
