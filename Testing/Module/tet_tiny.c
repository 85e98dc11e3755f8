/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "tet_tiny.h"

#include <math.h>
#include <stdlib.h>

/* 0 ... 1, from a linear congruential generator's upper bits */
static double draw(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)(*state >> 8) / 16777216.0;
}

tet_mesh* tet_tiny_dust(size_t count, double low, double high, uint32_t seed)
{
  /* the cubes' mesh for its arrays: six tetrahedra in each have more than four points a cell */
  size_t n = 1;
  while (6 * n * n * n < count || (n + 1) * (n + 1) * (n + 1) < 4 * count)
  {
    ++n;
  }
  tet_mesh* const m = tet_mesh_cubes(n, TET_CONSTANT);
  m->count = count;
  m->point_count = 4 * count;
  for (size_t t = 0; t < count; ++t)
  {
    double middle[3];
    const double edge = low * pow(high / low, draw(&seed));
    for (int k = 0; k < 3; ++k)
    {
      middle[k] = (1 - edge) * (2 * draw(&seed) - 1);
    }
    for (size_t i = 0; i < 4; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        m->points[4 * t + i][k] = middle[k] + edge * (2 * draw(&seed) - 1);
      }
      m->scalars[4 * t + i] = (float)draw(&seed);
      m->vertices[t][i] = (uint32_t)(4 * t + i);
      m->connectivity[4 * t + i] = (int64_t)(4 * t + i);
    }
  }
  return m;
}

tet_mesh* tet_tiny_noise(size_t n, uint32_t seed)
{
  tet_mesh* const m = tet_mesh_cubes(n, TET_CONSTANT);
  for (size_t i = 0; i < m->point_count; ++i)
  {
    m->scalars[i] = (float)draw(&seed);
  }
  return m;
}

tet_mesh* tet_tiny_graded(size_t n, double ratio, uint32_t seed)
{
  tet_mesh* const m = tet_tiny_noise(n, seed);
  const double grow = pow(ratio, 1.0 / (double)(n - 1));
  for (size_t i = 0; i < m->point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double at = 0.5 * (m->points[i][k] + 1) * (double)n;
      m->points[i][k] = 2 * (pow(grow, at) - 1) / (pow(grow, (double)n) - 1) - 1;
    }
  }
  return m;
}

double tet_tiny_depth(const tet_mesh* mesh, const chi_camera* camera, double extinction)
{
  /* Gauss's rule of 5 points on 0 ... 1, three times, on a cube that is folded to a tetrahedron:
   * exact for polynomials of degree 7, the weight of the fold included */
  static const double node[5] = { 0.046910077030668004, 0.23076534494715845, 0.5,
    0.76923465505284155, 0.953089922969332 };
  static const double weight[5] = { 0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
    0.23931433524968324, 0.11846344252809454 };
  const double* const m = camera->world_to_eye;
  double sum = 0;
  for (size_t t = 0; t < mesh->count; ++t)
  {
    double p[4][3], s[4];
    for (int i = 0; i < 4; ++i)
    {
      const double* const x = mesh->points[mesh->vertices[t][i]];
      for (int k = 0; k < 3; ++k)
      {
        p[i][k] = m[4 * k] * x[0] + m[4 * k + 1] * x[1] + m[4 * k + 2] * x[2] + m[4 * k + 3];
      }
      s[i] = (double)mesh->scalars[mesh->vertices[t][i]];
    }
    double e[3][3];
    for (int i = 0; i < 3; ++i)
    {
      for (int k = 0; k < 3; ++k)
      {
        e[i][k] = p[i + 1][k] - p[0][k];
      }
    }
    const double six = fabs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
      e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
      e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]));
    double mean = 0;
    for (int n = 0; n < 125; ++n)
    {
      const int i = n % 5, j = n / 5 % 5, k = n / 25;
      const double u = node[i], v = node[j] * (1 - u), w = node[k] * (1 - u - v);
      const double fold = weight[i] * weight[j] * weight[k] * (1 - u) * (1 - u - v);
      double x[3], value = s[0] + u * (s[1] - s[0]) + v * (s[2] - s[0]) + w * (s[3] - s[0]);
      for (int c = 0; c < 3; ++c)
      {
        x[c] = p[0][c] + u * e[0][c] + v * e[1][c] + w * e[2][c];
      }
      const double far = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
      value *= camera->parallel ? 1 : far / fabs(x[2] * x[2] * x[2]);
      mean += fold * value;
    }
    sum += six * mean;
  }
  return sum * extinction;
}
