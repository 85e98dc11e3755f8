/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * What a renderer of tetrahedra holds beyond its input. Issue 6 asks for at most 60 bytes a
 * tetrahedron with an order by keys, 84 with one by adjacency; apart from pictures (16 bytes a
 * pixel) and tables.
 */
#include "chi_test.h"
#include "counting_host.h"
#include "tet_frame.h"

enum
{
  CUBES = 32, /* a side: 196608 tetrahedra */
  WINDOW = 512,
  /* tables of 1024 entries of 4 floats, twice, that of psi (64 KB), and numbers a tile or a chunk
   */
  APART = 256 << 10
};

/* The bytes that the frame leaves held, and their largest sum before; the picture apart. */
typedef struct held
{
  double frame, peak, pixels;
  chi_tet_stats stats;
} held;

static held measure(const tet_mesh* mesh, int size)
{
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, size);
  tet_transfer_signal(&s.transfer, 1);
  s.params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  counting_host host = { 0 };
  const chi_exec exec = counting_exec(&host);
  chi_tet* tet;
  CHECK(chi_tet_create(&exec, &tet) == CHI_OK);
  CHECK(chi_tet_render(&exec, tet, &s.frame) == CHI_OK);
  held h = { .pixels = (double)size * size };
  chi_tet_get_stats(tet, &h.stats);
  h.frame = (double)(host.live - h.stats.bytes_image);
  h.peak = (double)host.peak;
  /* what statistics say is what there is */
  const double said = (double)(h.stats.bytes_mesh + h.stats.bytes_frame);
  CHECK(said <= h.frame && said + APART > h.frame);
  CHECK(h.stats.bytes_image >= 16 * (size_t)size * (size_t)size);
  chi_tet_destroy(&exec, tet);
  CHECK(host.live == 0);
  return h;
}

/* Points moved by up to 0.24 edges leave no lift. */
static tet_mesh* make_moved(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(CUBES, TET_MARSCHNER_LOBB);
  uint32_t seed = 1;
  for (size_t i = 0; i < mesh->point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      double* const x = mesh->points[i] + k;
      const double by = 0.48 * 2 / CUBES * (chi_test_random(&seed) - 0.5);
      *x += fabs(*x) < 1 - 1e-9 ? by : 0;
    }
  }
  return mesh;
}

static void an_order_by_keys_takes_sixty_bytes(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(CUBES, TET_MARSCHNER_LOBB);
  const double n = (double)mesh->count;
  const held h = measure(mesh, WINDOW);
  CHECK(h.stats.order.lift == 1);
  CHECK(h.frame <= 60 * n + APART);
  /* once, while the order is found: 100 beside vertices, points and values */
  CHECK(h.peak <= (100 + 16 + 8) * n);
  printf("keys: %.1f bytes a tetrahedron, at most %.1f on the way\n", h.frame / n, h.peak / n);
  tet_mesh_free(mesh);
}

static void an_order_by_adjacency_takes_eighty_four(void)
{
  tet_mesh* const mesh = make_moved();
  const double n = (double)mesh->count;
  const held h = measure(mesh, WINDOW);
  CHECK(h.stats.order.used == CHI_TET_ORDER_MPVO);
  CHECK(h.frame <= 84 * n + APART);
  CHECK(h.peak <= (100 + 16 + 8) * n);
  printf("MPVO: %.1f bytes a tetrahedron, at most %.1f on the way\n", h.frame / n, h.peak / n);
  tet_mesh_free(mesh);
}

/* A notch of an eighth: exterior faces are looked up at pixels, and that is apart: four events of
 * 16 bytes, a count of 4 and relations of 8 at a pixel where the mesh is left and entered again. */
static void what_gaps_take_is_bound_by_pixels(void)
{
  tet_mesh* const mesh = make_moved();
  size_t left = 0;
  for (size_t t = 0; t < mesh->count; ++t)
  {
    const size_t cube = t / 6, x = cube % CUBES, y = cube / CUBES % CUBES, z = cube / CUBES / CUBES;
    if (x < CUBES / 2 || y < CUBES / 2 || z < CUBES / 2)
    {
      memcpy(mesh->vertices[left], mesh->vertices[t], sizeof *mesh->vertices);
      memcpy(mesh->connectivity + 4 * left, mesh->connectivity + 4 * t, 4 * sizeof(int64_t));
      ++left;
    }
  }
  mesh->count = left;
  const double n = (double)mesh->count;
  const held small = measure(mesh, 64), large = measure(mesh, WINDOW);
  CHECK(small.stats.order.used == CHI_TET_ORDER_XMPVO);
  CHECK(large.stats.order.used == CHI_TET_ORDER_XMPVO);
  CHECK(small.frame <= 84 * n + APART);
  CHECK(large.frame <= 84 * n + APART + 84 * large.pixels);
  printf("XMPVO: %.1f bytes a tetrahedron at 64 x 64 pixels; %.1f a pixel more at 512 x 512\n",
    small.frame / n, (large.frame - small.frame) / (large.pixels - small.pixels));
  tet_mesh_free(mesh);
}

int main(void)
{
  an_order_by_keys_takes_sixty_bytes();
  an_order_by_adjacency_takes_eighty_four();
  what_gaps_take_is_bound_by_pixels();
  return chi_test_report();
}
