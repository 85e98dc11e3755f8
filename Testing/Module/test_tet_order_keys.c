/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What keys are: distances in closed form; and that they do not depend on how a mesh is stored. */

#include "tet_order_meshes.h"

static void find_keys(const chi_tet_mesh_view* mesh, int method, const chi_camera* camera,
  const double* grid_to_world, uint32_t* keys)
{
  chi_tet_order* order = NULL;
  int32_t bits;
  const chi_tet_order_view from = { sizeof from, camera, grid_to_world };
  CHECK(chi_tet_order_create(NULL, mesh, method, &order) == CHI_OK);
  CHECK(order && chi_tet_order_keys(NULL, order, &from, keys, &bits) == CHI_OK);
  chi_tet_order_destroy(NULL, order);
}

/* Where the eye is, and the way towards it. */
static void find_eye(const chi_camera* c, double at[3], double towards[3])
{
  for (int k = 0; k < 3; ++k)
  {
    at[k] = 0;
    towards[k] = c->world_to_eye[8 + k];
    for (int i = 0; i < 3; ++i)
    {
      at[k] -= c->world_to_eye[4 * i + k] * c->world_to_eye[4 * i + 3];
    }
  }
}

/* The centre and squared radius of the sphere through four points, by Cramer's rule. */
static double find_sphere(const order_mesh* m, size_t t, double center[3])
{
  double e[3][3], q[3], n[3][3], square = 0;
  const double* const o = m->points[m->vertices[t][0]];
  for (int i = 0; i < 3; ++i)
  {
    q[i] = 0;
    for (int k = 0; k < 3; ++k)
    {
      e[i][k] = m->points[m->vertices[t][i + 1]][k] - o[k];
      q[i] += 0.5 * e[i][k] * e[i][k];
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int a = (i + 1) % 3, b = (i + 2) % 3, l = (k + 1) % 3, j = (k + 2) % 3;
      n[i][k] = e[a][l] * e[b][j] - e[a][j] * e[b][l];
    }
  }
  const double volume = e[0][0] * n[0][0] + e[0][1] * n[0][1] + e[0][2] * n[0][2];
  for (int k = 0; k < 3; ++k)
  {
    const double d = (q[0] * n[0][k] + q[1] * n[1][k] + q[2] * n[2][k]) / volume;
    square += d * d;
    center[k] = o[k] + d;
  }
  return square;
}

/* Of all pairs whose distances differ by more than `apart`, the nearer one has the higher key. */
static void check_pairs(const double* distance, const uint32_t* keys, size_t n, double apart)
{
  long wrong = 0, compared = 0;
  for (size_t i = 0; i < n; ++i)
  {
    for (size_t j = 0; j < n; ++j)
    {
      compared += distance[i] < distance[j] - apart;
      wrong += distance[i] < distance[j] - apart && keys[i] <= keys[j];
    }
  }
  CHECK(wrong == 0);
  CHECK(compared > (long)(n * n / 3));
}

static void keys_are_distances(void)
{
  order_mesh m = order_mesh_cubes(5, 0.3, 11);
  const chi_tet_mesh_view mesh = order_mesh_view(&m);
  double* const distance = malloc(m.count * sizeof *distance);
  uint32_t* const keys = malloc(m.count * sizeof *keys);
  for (int method = CHI_TET_ORDER_CENTROID; method <= CHI_TET_ORDER_TANGENTIAL; ++method)
  {
    for (int view = 0; view <= TET_VIEW_INSIDE; ++view)
    {
      for (int parallel = 0; parallel < 2; ++parallel)
      {
        const chi_camera camera = tet_view(view, parallel, 8);
        double at[3], towards[3], largest = 0;
        find_eye(&camera, at, towards);
        for (size_t t = 0; t < m.count; ++t)
        {
          double c[3] = { 0, 0, 0 };
          const double square = method == CHI_TET_ORDER_TANGENTIAL ? find_sphere(&m, t, c) : 0;
          distance[t] = parallel ? 0 : -square;
          for (int k = 0; k < 3; ++k)
          {
            for (int i = 0; i < 4 && method == CHI_TET_ORDER_CENTROID; ++i)
            {
              c[k] += 0.25 * m.points[m.vertices[t][i]][k];
            }
            distance[t] += parallel ? -c[k] * towards[k] : (at[k] - c[k]) * (at[k] - c[k]);
          }
          largest = fmax(largest, fabs(distance[t]));
        }
        find_keys(&mesh, method, &camera, NULL, keys);
        /* centroids: floats, two roundings of 2^-24; spheres: planes and keys in 32 bits of ranges
         * that are at most 8 times the largest distance here, where the largest radius is 4 */
        check_pairs(distance, keys, m.count,
          method == CHI_TET_ORDER_CENTROID ? 0x1p-23 * largest : 0x1p-25 * (largest + 64));
      }
    }
  }
  free(distance);
  free(keys);
  order_mesh_free(&m);
}

/* Keys of exact methods of a mesh stored otherwise: still no pair in the wrong order. */
static void check_stored(
  const order_mesh* m, const chi_tet_mesh_view* mesh, const double* grid_to_world)
{
  uint32_t* const keys = malloc(m->count * sizeof *keys);
  for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
  {
    const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, method % 2, 16);
    find_keys(mesh, method, &camera, grid_to_world, keys);
    if (method == CHI_TET_ORDER_AUTO || method >= CHI_TET_ORDER_MPVO)
    {
      CHECK(order_judge(m, &camera, keys, 1) == 0);
    }
  }
  free(keys);
}

static void storage_does_not_matter(void)
{
  order_mesh m = order_mesh_cubes(3, 0.2, 2);
  const chi_tet_mesh_view mesh = order_mesh_view(&m);
  check_stored(&m, &mesh, NULL);

  /* f32 with a stride; points within 2^-25 of where they were move no face past a ray here */
  float* const loose = malloc(m.point_count * 5 * sizeof *loose);
  for (size_t i = 0; i < m.point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      loose[5 * i + k] = (float)m.points[i][k];
      m.points[i][k] = loose[5 * i + k];
    }
  }
  chi_tet_mesh_view other = mesh;
  other.points = (chi_vec3_view){ loose, m.point_count, 5 * sizeof(float), CHI_F32 };
  check_stored(&m, &other, NULL);
  free(loose);

  order_mesh_shuffle(&m, 9);
  check_stored(&m, &mesh, NULL);

  /* far away and scaled, and back by the matrix: coordinates of 2^-27 of the extent */
  const double move[3] = { 1e7, -2e7, 3e6 };
  double(*const there)[3] = malloc(m.point_count * 24);
  for (size_t i = 0; i < m.point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      there[i][k] = 10 * m.points[i][k] + move[k];
      m.points[i][k] = (there[i][k] - move[k]) / 10;
    }
  }
  other.points = (chi_vec3_view){ there, m.point_count, 24, CHI_F64 };
  const double back[16] = { 0.1, 0, 0, -move[0] / 10, 0, 0.1, 0, -move[1] / 10, 0, 0, 0.1,
    -move[2] / 10, 0, 0, 0, 1 };
  check_stored(&m, &other, back);

  /* mirrored, and back by the matrix: right-handed as it is stored */
  for (size_t i = 0; i < m.point_count; ++i)
  {
    there[i][0] = -m.points[i][0];
    there[i][1] = m.points[i][1];
    there[i][2] = m.points[i][2];
  }
  order_mesh mirrored = { there, m.vertices, m.point_count, m.count };
  order_mesh_orient(&mirrored);
  const double mirror[16] = { -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  check_stored(&m, &other, mirror);
  /* gaps, too, are seen through the mirror */
  order_mesh_thin(&m, 0.4, 4);
  other.count = m.count;
  uint32_t* const keys = malloc(m.count * sizeof *keys);
  const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 32);
  find_keys(&other, CHI_TET_ORDER_AUTO, &camera, mirror, keys);
  CHECK(order_judge(&m, &camera, keys, 1) == 0);
  free(keys);
  free(there);
  order_mesh_free(&m);
}

/* A mesh that stands still is not sorted again; one that is looked at from elsewhere is. */
static void keys_stand_while_the_camera_does(void)
{
  order_mesh m = order_mesh_cubes(3, 0, 2);
  order_mesh_thin(&m, 0.3, 4);
  const chi_tet_mesh_view mesh = order_mesh_view(&m);
  uint32_t* const keys = malloc(2 * m.count * sizeof *keys);
  for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
  {
    chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 32);
    const chi_tet_order_view from = { sizeof from, &camera, NULL };
    chi_tet_order* order = NULL;
    chi_tet_order_info info;
    int32_t bits;
    CHECK(chi_tet_order_create(NULL, &mesh, method, &order) == CHI_OK);
    for (int i = 0; i < 5; ++i)
    {
      /* as it was, other pixels, another place, other memory */
      camera.width += i == 2;
      camera.world_to_eye[3] += i == 3 ? 0.01 : 0;
      CHECK(chi_tet_order_keys(NULL, order, &from, keys + (i == 4 ? m.count : 0), &bits) == CHI_OK);
      chi_tet_order_get_info(order, &info);
      CHECK(info.reused == (i == 1 || (i == 2 && info.used != CHI_TET_ORDER_XMPVO)));
    }
    CHECK(memcmp(keys, keys + m.count, m.count * sizeof *keys) == 0);
    chi_tet_order_destroy(NULL, order);
  }
  free(keys);
  order_mesh_free(&m);
}

int main(void)
{
  keys_are_distances();
  storage_does_not_matter();
  keys_stand_while_the_camera_does();
  return chi_test_report();
}
