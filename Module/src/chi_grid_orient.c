/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Which way round the faces of a polyhedron go. VTK asks for outward faces; readers do not always
 * give them, and the signs of volumes tell nothing before they agree. */

#include "chi_grid_internal.h"

/* 1: b follows a somewhere in the face, -1: a follows b, 0: neither */
static int direction_of(const int64_t* face, size_t count, int64_t a, int64_t b)
{
  int64_t last = face[count - 1];
  for (size_t k = 0; k < count; last = face[k++])
  {
    if ((last == a && face[k] == b) || (last == b && face[k] == a))
    {
      return last == a ? 1 : -1;
    }
  }
  return 0;
}

/* Whether the first face's way round is the second's: they cross a common edge in opposite
 * directions if so. 1: yes, -1: no, 0: no common edge */
static int compare_ways(const int64_t* f, size_t f_count, const int64_t* g, size_t g_count)
{
  int64_t last = f[f_count - 1];
  for (size_t k = 0; k < f_count; last = f[k++])
  {
    const int direction = direction_of(g, g_count, last, f[k]);
    if (direction != 0)
    {
      return -direction;
    }
  }
  return 0;
}

/* Whether faces cross each edge as often in the one direction as in the other: whether a sum of the
 * edges' hashes, with the sign of their direction, vanishes. The hash is SplitMix64's finaliser. */
static int is_oriented(const chi_grid_cell* cell)
{
  uint64_t sum = 0;
  const int64_t* at = cell->faces;
  for (size_t f = 0; f < cell->face_count; ++f)
  {
    const int64_t count = *at++;
    int64_t last = at[count - 1];
    for (int64_t k = 0; k < count; last = at[k++])
    {
      const uint64_t low = (uint64_t)(last < at[k] ? last : at[k]);
      const uint64_t high = (uint64_t)(last < at[k] ? at[k] : last);
      uint64_t z = low << 32 ^ high;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      z ^= z >> 31;
      sum += last < at[k] ? z : 0 - z;
    }
    at += count;
  }
  return sum == 0;
}

uint64_t chi_cell_flips(const chi_grid_cell* cell)
{
  if (is_oriented(cell))
  {
    return 0;
  }
  const int64_t* face[64];
  size_t queue[64], queued = 1;
  const size_t faces = cell->face_count < 64 ? cell->face_count : 64;
  const int64_t* at = cell->faces;
  for (size_t f = 0; f < faces; ++f)
  {
    face[f] = at + 1;
    at += *at + 1;
  }
  uint64_t flips = 0, known = 1;
  queue[0] = 0;
  for (size_t q = 0; q < queued; ++q)
  {
    const size_t f = queue[q];
    for (size_t g = 1; g < faces; ++g)
    {
      const int64_t* const a = face[f];
      const int64_t* const b = face[g];
      const int way = known >> g & 1 ? 0 : compare_ways(a, (size_t)a[-1], b, (size_t)b[-1]);
      if (way != 0)
      {
        flips |= ((flips >> f & 1) ^ (way < 0)) << g;
        known |= (uint64_t)1 << g;
        queue[queued++] = g;
      }
    }
  }
  return flips;
}
