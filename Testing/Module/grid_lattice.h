/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_GRID_LATTICE_H
#define CHI_GRID_LATTICE_H

/* Grids of unit cubes: an image, and a mesh of all linear types. */

#include "grid_mesh.h"

__attribute__((unused)) static chi_grid_view image_of(size_t nx, size_t ny, size_t nz)
{
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { nx, ny, nz },
    .index_to_world = { 0.5, 0, 0, 1, 0, 0.25, 0, 2, 0, 0, 2, 3, 0, 0, 0, 1 } };
}

/* A lattice of n^3 hexahedra, some of them as two wedges or as six pyramids, whose inner points are
 * moved; tetrahedra stand on the wedges. */
__attribute__((unused)) static mesh* make_mixed(int n, double jitter, uint32_t seed)
{
  mesh* const m = new_mesh();
  const int p = n + 1;
  for (int i = 0; i < p * p * p; ++i)
  {
    const int c[3] = { i % p, i / p % p, i / (p * p) };
    double x[3];
    for (int a = 0; a < 3; ++a)
    {
      const int inner = c[a] > 0 && c[a] < n;
      x[a] = c[a] + (inner ? jitter * (2 * chi_test_random(&seed) - 1) : 0);
    }
    add_point(m, x[0], x[1], x[2]);
  }
  for (int j = 0; j < n * n; ++j)
  {
    const double choice = chi_test_random(&seed);
    for (int k = 0; k < n; ++k)
    {
      const int64_t q = j % n + (int64_t)p * (j / n) + (int64_t)p * p * k, up = (int64_t)p * p;
      const int64_t h[8] = { q, q + 1, q + p + 1, q + p, q + up, q + up + 1, q + up + p + 1,
        q + up + p };
      if (choice < 0.3) /* a column is of wedges or not */
      {
        add_cell(m, 13, 6, (const int64_t[6]){ h[0], h[1], h[2], h[4], h[5], h[6] });
        add_cell(m, 13, 6, (const int64_t[6]){ h[0], h[2], h[3], h[4], h[6], h[7] });
        if (k == n - 1)
        {
          const int64_t top = add_point(m, j % n + 0.7, j / n + 0.3, n + 1);
          add_cell(m, 10, 4, (const int64_t[4]){ h[4], h[5], h[6], top });
        }
      }
      else if (chi_test_random(&seed) < 0.3)
      {
        static const int face[6][4] = { { 0, 4, 7, 3 }, { 1, 2, 6, 5 }, { 0, 1, 5, 4 },
          { 3, 7, 6, 2 }, { 0, 3, 2, 1 }, { 4, 5, 6, 7 } };
        const int64_t middle = add_point(m, j % n + 0.5, j / n + 0.5, k + 0.5);
        for (int f = 0; f < 6; ++f)
        {
          add_cell(m, 14, 5,
            (const int64_t[5]){
              h[face[f][0]], h[face[f][1]], h[face[f][2]], h[face[f][3]], middle });
        }
      }
      else
      {
        add_cell(m, 12, 8, h);
      }
    }
  }
  return m;
}

/* Volume of the tetrahedra that stand on the lattice, one high. */
__attribute__((unused)) static double volume_on_top(const mesh* m)
{
  double sum = 0;
  for (size_t c = 0; c < m->cells; ++c)
  {
    if (m->types[c] == 10)
    {
      const int64_t* const id = m->ids + m->offsets[c];
      const double *const p = m->x[id[0]], *const q = m->x[id[1]], *const r = m->x[id[2]];
      sum += ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 6;
    }
  }
  return sum;
}

#endif
