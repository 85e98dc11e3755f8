/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The slow path by which projected tetrahedra are judged is itself judged by closed forms. */

#include "chi_test.h"
#include "tet_reference.h"
#include "tet_scenes.h"

enum
{
  SIZE = 48
};

static tet_reference_scene scene_of(const tet_mesh* mesh, const chi_camera* camera)
{
  return (tet_reference_scene){ .camera = camera,
    .points = (const double(*)[3])mesh->points,
    .vertices = (const uint32_t(*)[4])mesh->vertices,
    .count = mesh->count,
    .scalars = mesh->scalars };
}

static void fog(const void* data, double scalar, double rgba[4])
{
  (void)data;
  (void)scalar;
  rgba[0] = rgba[1] = rgba[2] = 1;
  rgba[3] = 0.3;
}

static void a_cube_of_fog_has_its_closed_form(void)
{
  for (int view = 0; view < TET_VIEWS; ++view)
  {
    for (int parallel = 0; parallel < 2; ++parallel)
    {
      for (size_t n = 1; n <= 4; n += 3)
      {
        if (parallel && view == TET_VIEW_INSIDE)
        {
          continue;
        }
        tet_mesh* const mesh = tet_mesh_cubes(n, TET_CONSTANT);
        const chi_camera camera = tet_view(view, parallel, SIZE);
        tet_reference_scene scene = scene_of(mesh, &camera);
        scene.classify = fog;
        static double rgba[SIZE * SIZE][4];
        static uint32_t counts[SIZE * SIZE];
        tet_reference_render(&scene, rgba[0], counts);
        int seen = 0;
        for (int i = 0; i < SIZE * SIZE; ++i)
        {
          const double x = i % SIZE + 0.5, y = i / SIZE + 0.5;
          const double length = tet_reference_cube_length(&camera, x, y);
          /* 1e-8 of a pixel aside, lengths change by that times the slope of the cube's sides */
          CHECK_NEAR(rgba[i][3], -expm1(-0.3 * length), 1e-8);
          CHECK_NEAR(rgba[i][0], rgba[i][3], 1e-9);
          seen += length > 0 && counts[i] > 0;
        }
        CHECK(seen > SIZE * SIZE / 4);
        tet_mesh_free(mesh);
      }
    }
  }
}

static void fragments_follow_each_other_and_the_field(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(5, TET_OBLIQUE_RAMP);
  const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, SIZE);
  const tet_reference_scene scene = scene_of(mesh, &camera);
  size_t all = 0;
  for (int i = 0; i < SIZE * SIZE; i += 7)
  {
    const double x = i % SIZE + 0.5, y = i / SIZE + 0.5;
    size_t count;
    tet_reference_fragment* const list = tet_reference_list(&scene, x, y, &count);
    double length = 0;
    for (size_t k = 0; k < count; ++k)
    {
      length += list[k].length;
      if (k > 0)
      {
        CHECK_NEAR(list[k].entry, list[k - 1].exit, 1e-12);
        CHECK_NEAR(list[k].scalar[0], list[k - 1].scalar[1], 1e-6); /* scalars are floats */
      }
      const double(*const points)[3] = mesh->points;
      double vertex[4][3];
      for (int v = 0; v < 4; ++v)
      {
        memcpy(vertex[v], points[mesh->vertices[list[k].tetrahedron][v]], sizeof vertex[v]);
      }
      const long double exact = tet_reference_thickness(&camera, (const double(*)[3])vertex, x, y);
      CHECK_NEAR(list[k].length, (double)exact, 1e-7); /* the ray is 1e-8 of a pixel aside */
    }
    CHECK_NEAR(length, tet_reference_cube_length(&camera, x, y), 1e-8);
    all += count;
    free(list);
  }
  CHECK(all > SIZE * SIZE / 7);
  tet_mesh_free(mesh);
}

/* Thin and far: in the closed form of a corner cut off, exact in long double alone. */
static void thickness_is_exact_of_slivers(void)
{
  const chi_camera camera = tet_look(3, 0, 0, 1, 2, 1); /* along -z; pixel centres at +-1/2 */
  for (double height = 1; height > 1e-12; height /= 10)
  {
    const double points[4][3] = { { -4, -4, 0 }, { 4, -4, 0 }, { 0, 4, 0 }, { 0, 0, height } };
    /* at (1/2, 1/2): below the plane through (0, 0, height) and the edge from (4, -4) to (0, 4),
     * 2 x + y = 4, which is 1 - (2 x + y) / 4 of the height */
    const double expected = height * (1 - 1.5 / 4);
    CHECK_NEAR((double)tet_reference_thickness(&camera, points, 1.5, 1.5) / height,
      expected / height, 1e-6); /* 3 - 1e-12 leaves so many digits of a long double */
    CHECK(tet_reference_thickness(&camera, points, -40, 1.5) == 0);
  }
  const double flat[4][3] = { { -4, -4, 0 }, { 4, -4, 0 }, { 0, 4, 0 }, { 1, 1, 0 } };
  CHECK(tet_reference_thickness(&camera, flat, 1.5, 1.5) == 0);
}

static void wave(const void* data, double s, double rgba[4])
{
  (void)data;
  rgba[0] = s;
  rgba[1] = 0.5 + 0.5 * sin(20 * s);
  rgba[2] = 1 - s;
  rgba[3] = 2 + 2 * cos(30 * s);
}

static void functions_and_tables_agree(void)
{
  enum
  {
    COUNT = 20000 /* so that linear interpolation's error is (30 / count)^2 / 8 of the wave's 4 */
  };
  float(*const color)[4] = malloc((COUNT + 1) * sizeof *color);
  for (int i = 0; i <= COUNT && color; ++i)
  {
    double rgba[4];
    wave(NULL, fmin(i, COUNT - 1) / (COUNT - 1.0), rgba);
    for (int c = 0; c < 4; ++c)
    {
      color[i][c] = (float)rgba[c];
    }
  }
  chi_segment_tables tables;
  memset(&tables, 0, sizeof tables);
  tables.color = (const float(*)[4])color;
  tables.count = COUNT;
  tables.range[1] = 1;
  tet_mesh* const mesh = tet_mesh_cubes(3, TET_OBLIQUE_RAMP);
  const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 16);
  tet_reference_scene scene = scene_of(mesh, &camera);
  scene.classify = wave;
  static double a[16 * 16][4], b[16 * 16][4];
  tet_reference_render(&scene, a[0], NULL);
  scene.tables = &tables;
  tet_reference_render(&scene, b[0], NULL);
  for (int i = 0; i < 16 * 16; ++i)
  {
    for (int c = 0; c < 4; ++c)
    {
      CHECK_NEAR(
        a[i][c], b[i][c], 2e-6); /* of 6 world units: 1.1e-6 each of the table, of floats */
    }
  }
  free(color);
  tet_mesh_free(mesh);
}

static int by_value(const void* a, const void* b)
{
  const uint32_t x = *(const uint32_t*)a, y = *(const uint32_t*)b;
  return x < y ? -1 : x > y;
}

static int by_vertices(const void* a, const void* b)
{
  for (int k = 0; k < 4; ++k)
  {
    const int order = by_value((const uint32_t*)a + k, (const uint32_t*)b + k);
    if (order)
    {
      return order;
    }
  }
  return 0;
}

static void the_cubes_are_the_grids_own_split(void)
{
  enum
  {
    N = 3
  };
  tet_mesh* const mesh = tet_mesh_cubes(N, TET_RAMP);
  const chi_grid_view grids[] = { tet_image_grid(N), tet_mesh_grid(mesh) };
  for (size_t k = 0; k < mesh->count; ++k)
  {
    qsort(mesh->vertices[k], 4, sizeof(uint32_t), by_value);
  }
  qsort(mesh->vertices, mesh->count, sizeof *mesh->vertices, by_vertices);
  for (int g = 0; g < 2; ++g)
  {
    static uint32_t vertices[6 * N * N * N][4];
    chi_grid_counts counts;
    CHECK(chi_grid_count(NULL, grids + g, &counts) == CHI_OK);
    CHECK(counts.tetrahedra == mesh->count && counts.extra_points == 0);
    const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices[0] };
    CHECK(chi_grid_split(NULL, grids + g, &counts, &out) == CHI_OK);
    for (size_t k = 0; k < mesh->count; ++k)
    {
      qsort(vertices[k], 4, sizeof(uint32_t), by_value);
    }
    qsort(vertices, mesh->count, sizeof *vertices, by_vertices);
    CHECK(memcmp(vertices, mesh->vertices, sizeof vertices) == 0);
  }
  tet_mesh_free(mesh);
}

int main(void)
{
  a_cube_of_fog_has_its_closed_form();
  fragments_follow_each_other_and_the_field();
  thickness_is_exact_of_slivers();
  functions_and_tables_agree();
  the_cubes_are_the_grids_own_split();
  return chi_test_report();
}
