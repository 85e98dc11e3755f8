/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The inside of closed lines, by the rule of even and odd, as triangles that share whole sides. */

#include "chi_fiber_planar.h"

#include <stdlib.h>

static void drop(planar* g)
{
  void* const blocks[] = { g->x, g->sides, g->cuts, g->triangles, g->at, g->queue };
  const size_t bytes[] = { g->point_room * sizeof *g->x, g->side_room * sizeof *g->sides,
    g->cut_room * sizeof *g->cuts, g->triangle_room * sizeof *g->triangles,
    g->at_room * sizeof *g->at, g->queue_room * sizeof *g->queue };
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; ++i)
  {
    if (blocks[i])
    {
      chi_free(g->exec, blocks[i], bytes[i], 1);
    }
  }
}

static chi_status write_pieces(const chi_exec* exec, chi_fiber_pieces* pieces, const planar* g)
{
  size_t inner = 0;
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    inner += g->triangles[t].inside & 1;
  }
  chi_fiber_polygon* const polygon = &pieces->polygon;
  if (!chi_buffer_reserve(exec, &polygon->segments, 3 * inner + 1, sizeof *polygon->segment) ||
    !chi_buffer_reserve(exec, &polygon->corner_buffer, g->points + 1, sizeof *polygon->corner) ||
    !chi_buffer_reserve(exec, &pieces->triangle_buffer, inner + 1, sizeof *pieces->triangle) ||
    !chi_buffer_reserve(exec, &pieces->beside_buffer, 3 * inner + 1, sizeof *pieces->beside) ||
    !chi_buffer_reserve(exec, &polygon->order, 4 * g->triangle_count + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  polygon->segment = (chi_fiber_segment*)polygon->segments.data;
  polygon->corner = (chi_fiber_corner*)polygon->corner_buffer.data;
  pieces->triangle = (chi_fiber_triangle*)pieces->triangle_buffer.data;
  pieces->beside = (int32_t(*)[2])pieces->beside_buffer.data;
  uint32_t* const of_side = (uint32_t*)polygon->order.data; /* [triangles x 3] segments */
  uint32_t* const number = of_side + 3 * g->triangle_count; /* [triangles] of those inside */
  for (size_t i = 0; i < g->points; ++i)
  {
    polygon->corner[i] = (chi_fiber_corner){ { g->x[i][0], g->x[i][1] }, 1 };
  }
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    if (g->triangles[t].inside & 1)
    {
      number[t] = (uint32_t)pieces->triangles++;
    }
  }
  for (size_t t = 0; t < g->triangle_count; ++t)
  {
    const triangle* const own = g->triangles + t;
    chi_fiber_triangle* const out = pieces->triangle + (own->inside & 1 ? number[t] : 0);
    for (int k = 0; k < 3 && own->inside & 1; ++k)
    {
      /* side k of a piece runs from its corner k to the next */
      const int opposite = (k + 2) % 3;
      const int32_t other = own->n[opposite];
      const int is_shared = other != NOWHERE && g->triangles[other].inside & 1;
      uint32_t from = own->v[k], to = own->v[(k + 1) % 3];
      uint32_t* const here = of_side + 3 * t + (size_t)opposite;
      if (is_shared && (size_t)other < t)
      {
        *here = of_side[3 * (size_t)other + (size_t)side_to(g->triangles + other, (int32_t)t)];
      }
      else
      {
        const side key = { from, to }, reversed = { to, from };
        const int runs_back = own->fixed >> opposite & 1 &&
          !bsearch(&key, g->sides, g->side_count, sizeof key, chi_planar_compare_sides) &&
          bsearch(&reversed, g->sides, g->side_count, sizeof key, chi_planar_compare_sides);
        from = runs_back ? reversed.from : from;
        to = runs_back ? reversed.to : to;
        *here = (uint32_t)polygon->count++;
        chi_fiber_segment* const s = polygon->segment + *here;
        *s = chi_fiber_make_segment(polygon->corner, from, to);
        s->is_closed = (uint8_t)!is_shared;
        s->id = *here;
        pieces->beside[*here][0] = pieces->beside[*here][1] = NOWHERE;
      }
      const int is_flipped = polygon->segment[*here].corner[0] != own->v[k];
      pieces->beside[*here][is_flipped] = (int32_t)number[t];
      out->corner[k] = own->v[k];
      out->segment[k] = *here;
      out->is_flipped[k] = (uint8_t)is_flipped;
    }
  }
  polygon->corners = g->points;
  return CHI_OK;
}

/* Sides between the starts of segments that follow one another in a closed line: what was left out
 * in between, since it had no length, leaves no gap. */
static int read_sides(planar* g, const chi_fiber_polygon* lines)
{
  if (!ROOM(g, x, point_room, lines->corners + 1) || !ROOM(g, sides, side_room, lines->count + 1))
  {
    return 0;
  }
  for (size_t i = 0; i < lines->corners; ++i)
  {
    memcpy(g->x[i], lines->corner[i].x, sizeof *g->x);
  }
  g->points = lines->corners;
  for (size_t first = 0, end; first < lines->count; first = end)
  {
    const chi_fiber_segment* const s = lines->segment;
    for (end = first + 1; end < lines->count && s[end].line == s[first].line; ++end)
    {
    }
    for (size_t i = first; i < end && s[i].is_closed; ++i)
    {
      g->sides[g->side_count++] =
        (side){ s[i].corner[0], s[i + 1 < end ? i + 1 : first].corner[0] };
    }
  }
  return 1;
}

chi_status chi_fiber_pieces_make(
  const chi_exec* exec, chi_fiber_pieces* pieces, const chi_fiber_polygon* lines)
{
  planar g = { .exec = exec };
  pieces->triangles = 0;
  pieces->polygon.count = pieces->polygon.corners = 0;
  chi_status status = read_sides(&g, lines) ? chi_planar_arrange(&g) : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK && g.side_count > 0)
  {
    status = chi_planar_triangulate(&g);
    status = status == CHI_OK ? write_pieces(exec, pieces, &g) : status;
  }
  drop(&g);
  return status;
}

void chi_fiber_pieces_free(const chi_exec* exec, chi_fiber_pieces* pieces)
{
  chi_fiber_polygon_free(exec, &pieces->polygon);
  chi_buffer_free(exec, &pieces->triangle_buffer);
  chi_buffer_free(exec, &pieces->beside_buffer);
}
