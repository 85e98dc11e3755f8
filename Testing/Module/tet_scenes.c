/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "tet_scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void* get(size_t count, size_t size)
{
  void* const block = calloc(count, size);
  if (!block)
  {
    fprintf(stderr, "no memory for a scene\n");
    exit(1);
  }
  return block;
}

static tet_mesh* new_mesh(size_t points, size_t count)
{
  tet_mesh* const m = (tet_mesh*)get(1, sizeof *m);
  m->point_count = points;
  m->count = count;
  m->points = (double(*)[3])get(points, sizeof *m->points);
  m->scalars = (float*)get(points, sizeof *m->scalars);
  m->vertices = (uint32_t(*)[4])get(count, sizeof *m->vertices);
  m->offsets = (int64_t*)get(count + 1, sizeof *m->offsets);
  m->connectivity = (int64_t*)get(4 * count, sizeof *m->connectivity);
  m->types = (uint8_t*)get(count, 1);
  return m;
}

static void fill_grid(tet_mesh* m)
{
  memset(m->types, 10, m->count); /* VTK_TETRA */
  for (size_t t = 0; t < m->count; ++t)
  {
    m->offsets[t + 1] = (int64_t)(4 * (t + 1));
    for (size_t k = 0; k < 4; ++k)
    {
      m->connectivity[4 * t + k] = m->vertices[t][k];
    }
  }
}

static double field_at(int field, const double x[3])
{
  const double radius = sqrt(x[0] * x[0] + x[1] * x[1]);
  switch (field)
  {
    case TET_MARSCHNER_LOBB: /* Eq. 14 of their paper */
      return (1 - sin(pi * x[2] / 2) + 0.25 * (1 + cos(2 * pi * 6 * cos(pi * radius / 2)))) / 2.5;
    case TET_RAMP:
      return 0.5 * (x[0] + 1);
    case TET_OBLIQUE_RAMP:
      return (x[0] + x[1] + x[2] + 3) / 6;
    default:
      return 0.5;
  }
}

tet_mesh* tet_mesh_cubes(size_t n, int field)
{
  /* The six ways from a cube's first corner to its last along the axes. */
  static const int way[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
    { 2, 1, 0 } };
  const size_t side = n + 1, step[3] = { 1, side, side * side };
  tet_mesh* const m = new_mesh(side * side * side, 6 * n * n * n);
  for (size_t i = 0; i < m->point_count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      m->points[i][a] = 2.0 * (double)(i / step[a] % side) / (double)n - 1;
    }
    m->scalars[i] = (float)field_at(field, m->points[i]);
  }
  for (size_t t = 0; t < m->count; ++t)
  {
    const size_t cube = t / 6;
    size_t corner = cube % n + side * (cube / n % n) + side * side * (cube / n / n);
    for (int k = 0; k < 4; ++k)
    {
      m->vertices[t][k] = (uint32_t)corner;
      corner += k < 3 ? step[way[t % 6][k]] : 0;
    }
  }
  fill_grid(m);
  return m;
}

tet_mesh* tet_mesh_single(const double points[4][3])
{
  tet_mesh* const m = new_mesh(4, 1);
  memcpy(m->points, points, 4 * sizeof *points);
  for (uint32_t k = 0; k < 4; ++k)
  {
    m->scalars[k] = (float)k;
    m->vertices[0][k] = k;
  }
  fill_grid(m);
  return m;
}

void tet_mesh_free(tet_mesh* m)
{
  free(m->points);
  free(m->scalars);
  free(m->vertices);
  free(m->offsets);
  free(m->connectivity);
  free(m->types);
  free(m);
}

chi_grid_view tet_mesh_grid(const tet_mesh* m)
{
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { m->points, m->point_count, sizeof *m->points, CHI_F64 },
    .cell_types = m->types,
    .offsets = m->offsets,
    .connectivity = m->connectivity,
    .cell_count = m->count,
    .connectivity_count = 4 * m->count,
    .version = 1 };
}

chi_grid_view tet_image_grid(size_t n)
{
  const double h = 2.0 / (double)n;
  return (chi_grid_view){ .struct_size = sizeof(chi_grid_view),
    .kind = CHI_GRID_IMAGE,
    .dimensions = { n + 1, n + 1, n + 1 },
    .index_to_world = { h, 0, 0, -1, 0, h, 0, -1, 0, 0, h, -1, 0, 0, 0, 1 },
    .version = 1 };
}

chi_camera tet_look(
  double distance, double azimuth, double elevation, int parallel, int size, double half)
{
  const double a = azimuth * pi / 180, e = elevation * pi / 180;
  const double away[3] = { cos(e) * sin(a), sin(e), cos(e) * cos(a) };
  const double right[3] = { cos(a), 0, -sin(a) };
  const double up[3] = { -sin(e) * sin(a), cos(e), -sin(e) * cos(a) };
  return (chi_camera){ .struct_size = sizeof(chi_camera),
    .world_to_eye = { right[0], right[1], right[2], 0, up[0], up[1], up[2], 0, away[0], away[1],
      away[2], -distance, 0, 0, 0, 1 },
    .window = { -half, half, -half, half },
    .parallel = parallel,
    .width = size,
    .height = size,
    .near_depth = 1e-3 };
}

chi_camera tet_view(int view, int parallel, int size)
{
  static const struct
  {
    double distance, azimuth, elevation, angle, half; /* degrees; half the height if parallel */
  } of[TET_VIEWS] = { { 5, 0, 0, 30, 1.3 }, { 6.6921, 33, 27, 30, 1.8 }, { 2.2, 33, 27, 60, 1.25 },
    { 0.37, 33, 27, 60, 1.25 }, { 6.6921, 30, 25, 30, 1.8 } };
  const double half = parallel ? of[view].half : tan(of[view].angle * pi / 360);
  return tet_look(of[view].distance, of[view].azimuth, of[view].elevation, parallel, size, half);
}

static void set_view(tet_transfer* t)
{
  const uint64_t version = t->view.version;
  t->view = (chi_transfer_view){ .struct_size = sizeof t->view,
    .rgb = t->rgb[0],
    .opacity = t->opacity,
    .count = TET_TABLE,
    .range = { 0, 1 },
    .unit_distance = 1,
    .version = version + 1 };
}

void tet_transfer_constant(tet_transfer* t, double extinction)
{
  for (int i = 0; i < TET_TABLE; ++i)
  {
    t->rgb[i][0] = t->rgb[i][1] = t->rgb[i][2] = 1;
    t->opacity[i] = (float)extinction;
  }
  set_view(t);
}

void tet_transfer_linear(tet_transfer* t, double extinction)
{
  for (int i = 0; i < TET_TABLE; ++i)
  {
    const float x = (float)i / (TET_TABLE - 1);
    t->rgb[i][0] = x;
    t->rgb[i][1] = 0.5f;
    t->rgb[i][2] = 1 - x;
    t->opacity[i] = x;
  }
  set_view(t);
  t->view.unit_distance = 1 / extinction;
}

void tet_transfer_signal(tet_transfer* t, double times)
{
  for (int i = 0; i < TET_TABLE; ++i)
  {
    const double s = (double)i / (TET_TABLE - 1), u = s < 0.5 ? 2 * s : 2 * s - 1;
    t->rgb[i][0] = (float)(s < 0.5 ? 0 : u);
    t->rgb[i][1] = (float)(s < 0.5 ? u : 1 - u);
    t->rgb[i][2] = (float)(s < 0.5 ? 1 - u : 0);
    t->opacity[i] = (float)(s < 0.5 ? 0.05 + 0.35 * u : 0.4 + 0.5 * u);
  }
  set_view(t);
  t->view.unit_distance = 1 / times; /* opacities stay below 1 */
}

void tet_transfer_peak(tet_transfer* t, double sigma, double extinction)
{
  for (int i = 0; i < TET_TABLE; ++i)
  {
    const double s = (double)i / (TET_TABLE - 1), away = (s - 0.5) / sigma;
    t->rgb[i][0] = (float)s;
    t->rgb[i][1] = (float)(4 * s * (1 - s));
    t->rgb[i][2] = (float)(1 - s);
    t->opacity[i] = (float)exp(-0.5 * away * away);
  }
  set_view(t);
  t->view.unit_distance = 1 / extinction;
}
