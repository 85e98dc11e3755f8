/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "tet_stress.h"

#include "tet_reference.h"
#include "tet_scenes.h"

#include <chiaroscuro/chi_tet.h>

#include <math.h>
#include <string.h>

enum
{
  SIZE = 64
};

typedef struct stress_case
{
  const char* name;
  double size;    /* of the tetrahedron; of an extent of 1 */
  double aspect;  /* > 0: the last vertex lies so much of the size off the opposite face */
  double edge_on; /* >= 0: the third vertex lies so much, radians, off a plane through the eye */
  double offset;  /* of all coordinates, the eye's among them */
  int parallel;
  int copies; /* vertices that are the last one again */
} stress_case;

/* 0 ... 1 */
static double random_unit(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)*state * 0x1p-32;
}

/* -1 ... 1 */
static double draw(uint32_t* state)
{
  return 2 * random_unit(state) - 1;
}

static void make_points(
  const stress_case* c, const chi_camera* camera, uint32_t* seed, double p[4][3])
{
  const double h = c->size;
  for (int i = 0; i < 4; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      p[i][k] = h * draw(seed);
    }
  }
  if (c->aspect > 0)
  {
    double a = random_unit(seed), b = random_unit(seed);
    const int beyond = a + b > 1;
    a = beyond ? 1 - a : a;
    b = beyond ? 1 - b : b;
    for (int k = 0; k < 3; ++k)
    {
      p[3][k] =
        p[0][k] + a * (p[1][k] - p[0][k]) + b * (p[2][k] - p[0][k]) + h / c->aspect * draw(seed);
    }
  }
  if (c->edge_on >= 0)
  {
    double eye[3];
    const double* const m = camera->world_to_eye;
    for (int k = 0; k < 3; ++k)
    {
      eye[k] = -(m[k] * m[3] + m[4 + k] * m[7] + m[8 + k] * m[11]);
    }
    const double a = 0.4 + 0.2 * random_unit(seed);
    for (int k = 0; k < 3; ++k)
    {
      const double to = a * (p[0][k] - eye[k]) + (1 - a) * (p[1][k] - eye[k]);
      const double axis = c->parallel ? -m[8 + k] * h : to * 0.4 * h;
      p[2][k] = eye[k] + to + axis + c->edge_on * h * draw(seed);
    }
  }
  for (int i = 0; i < c->copies; ++i)
  {
    memcpy(p[2 - i], p[3], sizeof p[3]);
  }
  for (int i = 0; i < 4; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      p[i][k] += c->offset;
    }
  }
}

static void move_camera(chi_camera* camera, double offset)
{
  double* const m = camera->world_to_eye;
  for (int i = 0; i < 3; ++i)
  {
    m[4 * i + 3] -= (m[4 * i] + m[4 * i + 1] + m[4 * i + 2]) * offset;
  }
}

static int run_case(const chi_exec* exec, const stress_case* c, int tetrahedra, tet_stress_row* row)
{
  uint32_t seed = 1;
  int64_t off = 0;
  chi_tet* tet;
  int ok = chi_tet_create(exec, &tet) == CHI_OK;
  *row = (tet_stress_row){ .name = c->name, .parallel = c->parallel };
  static tet_transfer transfer;
  tet_transfer_constant(&transfer, 1);
  transfer.view.unit_distance = c->size; /* an optical depth of 1 over the size */
  for (int n = 0; ok && n < tetrahedra; ++n)
  {
    const double distance = c->size < 1 ? 1 : 3;
    chi_camera camera = tet_look(distance, 200 * random_unit(&seed), 70 * draw(&seed), c->parallel,
      SIZE, 1.1 * c->size / (c->parallel ? 1 : distance));
    double p[4][3];
    make_points(c, &camera, &seed, p);
    move_camera(&camera, c->offset);
    tet_mesh* const mesh = tet_mesh_single((const double(*)[3])p);
    chi_grid_view grid = tet_mesh_grid(mesh);
    grid.version = (uint64_t)n + 1;
    const chi_array_view scalars = { mesh->scalars, mesh->point_count, 1, sizeof(float), CHI_F32 };
    const chi_tet_field field = {
      .struct_size = sizeof field, .scalars = &scalars, .version = (uint64_t)n + 1
    };
    const chi_tet_frame frame = { .struct_size = sizeof frame,
      .camera = &camera,
      .grid = &grid,
      .field = &field,
      .transfer = &transfer.view };
    ok = chi_tet_render(exec, tet, &frame) == CHI_OK;
    chi_tet_stats stats;
    chi_tet_get_stats(tet, &stats);
    row->ns += 1e9 * stats.seconds_total;
    chi_tet_image image;
    chi_tet_get_image(tet, &image);
    double longest = 0;
    for (int i = 0; i < 6; ++i)
    {
      static const int ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
      const double *const a = p[ends[i][0]], *const b = p[ends[i][1]];
      longest = fmax(longest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    for (int i = 0; ok && i < SIZE * SIZE; ++i)
    {
      const double exact = (double)tet_reference_thickness(
        &camera, (const double(*)[3])p, i % SIZE + 0.5, i / SIZE + 0.5);
      const double alpha = (double)image.rgba[4 * i + 3];
      if (exact > 0 || alpha > 0)
      {
        const double error = fabs(-log1p(-alpha) * c->size - exact) / longest;
        ++row->pixels;
        off += error > 1e-5;
        row->worst = error > row->worst ? error : row->worst;
        row->missing += exact > 1e-3 * longest && alpha == 0;
      }
    }
    tet_mesh_free(mesh);
  }
  chi_tet_destroy(exec, tet);
  row->beyond = row->pixels ? (double)off / (double)row->pixels : 0;
  return ok;
}

int tet_stress(const chi_exec* exec, int tetrahedra, tet_stress_report report, void* user)
{
  static const stress_case cases[] = { { "fat, 1", 1, 0, -1, 0, 0, 0 },
    { "fat, 1e-2", 1e-2, 0, -1, 0, 0, 0 }, { "fat, 1e-4", 1e-4, 0, -1, 0, 0, 0 },
    { "fat, 1e-6", 1e-6, 0, -1, 0, 0, 0 }, { "flat 1e2", 1, 1e2, -1, 0, 0, 0 },
    { "flat 1e4", 1, 1e4, -1, 0, 0, 0 }, { "flat 1e6", 1, 1e6, -1, 0, 0, 0 },
    { "flat 1e4, size 1e-4", 1e-4, 1e4, -1, 0, 0, 0 },
    { "flat 1e6, size 1e-6", 1e-6, 1e6, -1, 0, 0, 0 }, { "edge-on 1e-2", 1, 0, 1e-2, 0, 0, 0 },
    { "edge-on 1e-3", 1, 0, 1e-3, 0, 0, 0 }, { "edge-on 1e-6", 1, 0, 1e-6, 0, 0, 0 },
    { "edge-on 1e-9", 1, 0, 1e-9, 0, 0, 0 }, { "edge-on 1e-12", 1, 0, 1e-12, 0, 0, 0 },
    { "edge-on 0", 1, 0, 0, 0, 0, 0 }, { "edge-on 1e-3, size 1e-4", 1e-4, 0, 1e-3, 0, 0, 0 },
    { "edge-on 1e-9, size 1e-6", 1e-6, 0, 1e-9, 0, 0, 0 }, { "offset 1e7", 1, 0, -1, 1e7, 0, 0 },
    { "offset 1e7, size 1e-2", 1e-2, 0, -1, 1e7, 0, 0 }, { "no volume", 1, INFINITY, -1, 0, 0, 0 },
    { "two vertices at one place", 1, 0, -1, 0, 0, 1 },
    { "three vertices at one place", 1, 0, -1, 0, 0, 2 } };
  int ok = 1;
  for (size_t i = 0; ok && i < 2 * sizeof cases / sizeof *cases; ++i)
  {
    stress_case c = cases[i / 2];
    c.parallel = i % 2;
    tet_stress_row row;
    ok = run_case(exec, &c, tetrahedra, &row);
    report(user, &row);
  }
  return ok;
}
