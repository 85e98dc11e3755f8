/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Visibility orders against all pairs of tetrahedra on the rays of all pixels, found by the slow
 * path that shares no code with the library. Counts have no tolerance: an order is right or not. */

#include "tet_order_meshes.h"

enum
{
  SIZE = 24 /* pixels a side: an odd step against cells, so that rays differ */
};

/* Violations of all views together; the last info. */
static long judge_views(const order_mesh* m, int method, chi_tet_order_info* info)
{
  const chi_tet_mesh_view mesh = order_mesh_view(m);
  uint32_t* const keys = malloc((m->count + 1) * sizeof *keys);
  chi_tet_order* order = NULL;
  long wrong = 0;
  int64_t cycles = 0;
  CHECK(chi_tet_order_create(NULL, &mesh, method, &order) == CHI_OK);
  for (int view = 0; order && view <= TET_VIEW_INSIDE; ++view)
  {
    for (int parallel = 0; parallel <= (view != TET_VIEW_INSIDE); ++parallel)
    {
      const chi_camera camera = tet_view(view, parallel, SIZE);
      const chi_tet_order_view from = { sizeof from, &camera, NULL };
      int32_t bits = 0;
      CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == CHI_OK);
      CHECK(bits > 0 && bits <= 32);
      for (size_t t = 0; t < m->count; ++t)
      {
        CHECK(bits == 32 || keys[t] >> bits == 0);
      }
      const long here = order_judge(m, &camera, keys, 1);
      wrong += here;
      /* the library's own judge looks at neighbours alone, as this one can */
      int64_t violations = -1;
      CHECK(chi_tet_order_violations(NULL, &mesh, &from, keys, &violations) == CHI_OK);
      CHECK(violations == order_judge(m, &camera, keys, 0));
      chi_tet_order_get_info(order, info);
      cycles += info->cycles;
    }
  }
  info->cycles = cycles;
  chi_tet_order_destroy(NULL, order);
  free(keys);
  return wrong;
}

/* |x|^2 ties within cubes; the lift that is found does not. */
static void split_cubes_have_a_lift(void)
{
  order_mesh m = order_mesh_cubes(4, 0, 1);
  chi_tet_order_info info;
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.used == CHI_TET_ORDER_TANGENTIAL && info.lift == 1);
  CHECK(info.tied_faces == 0 && info.wrong_faces == 0);
  /* 64 cubes: 24 faces a cube, 12 on each side of the box twice over */
  CHECK(info.boundary_faces == 6 * 2 * 16 && info.interior_faces == (4 * 384 - 192) / 2);
  CHECK(info.pieces == 1 && info.convex == 1 && info.bad_faces == 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_TANGENTIAL, &info) > 0);
  CHECK(info.tied_faces == 6 * 64 && info.lift == 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_MPVO, &info) == 0);
  CHECK(info.cycles == 0);
  order_mesh_free(&m);
}

/* Stretched and sheared: the form follows. */
static void sheared_cubes_have_a_lift(void)
{
  order_mesh m = order_mesh_cubes(4, 0, 1);
  for (size_t i = 0; i < m.point_count; ++i)
  {
    double* const p = m.points[i];
    const double x = p[0], y = p[1], z = p[2];
    p[0] = 0.5 * x + 0.4 * y + 0.1 * z;
    p[1] = 0.3 * y + 0.2 * z;
    p[2] = 0.02 * z;
  }
  chi_tet_order_info info;
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.lift == 1);
  order_mesh_free(&m);
}

/* One cube, its faces' diagonals by lot: no form separates them all, so that halves of pyramids
 * stay tied, in pairs. */
static void ties_are_told_apart_by_their_faces(void)
{
  order_mesh m = order_mesh_centered(1, 5);
  chi_tet_order_info info;
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.lift == 1 && info.used == CHI_TET_ORDER_TANGENTIAL);
  CHECK(info.tied_faces == 6 && info.wrong_faces == 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_TANGENTIAL, &info) > 0);
  order_mesh_free(&m);
}

/* A Delaunay mesh with flat cells under two sides of its hull: their spheres are 10^8 times as
 * large as it, and the bits of the others' keys must not be spent on them. */
static void huge_spheres_at_the_hull_harm_nobody(void)
{
  enum
  {
    HULL = 4,
    INNER = 40,
    ALL = HULL + INNER + 2
  };
  double p[ALL][3] = { { 1, 1, 1 }, { 1, -1, -1 }, { -1, 1, -1 }, { -1, -1, 1 } };
  uint32_t seed = 5;
  for (int i = HULL; i < ALL; ++i)
  {
    double weight[4], sum = 0;
    for (int k = 0; k < 4; ++k)
    {
      weight[k] = i < HULL + INNER ? 0.01 + chi_test_random(&seed)
        : k == i - HULL - INNER    ? 1e-9
                                   : 0.3 + 0.4 * chi_test_random(&seed);
      sum += weight[k];
    }
    for (int k = 0; k < 12; ++k)
    {
      p[i][k % 3] += weight[k / 3] / sum * p[k / 3][k % 3];
    }
  }
  order_mesh m = order_mesh_delaunay((const double(*)[3])p, ALL);
  chi_tet_order_info info;
  CHECK(m.count >= 128); /* of 64 one may be an outlier */
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.used == CHI_TET_ORDER_TANGENTIAL && info.lift == 1 && info.convex == 1);
  CHECK(info.tied_faces == 0 && info.wrong_faces == 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_TANGENTIAL, &info) == 0);
  CHECK(info.lift == 1);
  CHECK(judge_views(&m, CHI_TET_ORDER_MPVO, &info) == 0);
  CHECK(info.cycles == 0);
  order_mesh_free(&m);
}

/* Points moved so far that no form is right; heights of vertices are. */
static void moved_points_have_heights(void)
{
  for (uint32_t seed = 1; seed <= 3; ++seed)
  {
    order_mesh m = order_mesh_cubes(4, 0.48, seed);
    chi_tet_order_info info;
    CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
    CHECK(info.used == CHI_TET_ORDER_TANGENTIAL && info.lift == 1);
    CHECK(info.tied_faces == 0 && info.wrong_faces == 0);
    CHECK(judge_views(&m, CHI_TET_ORDER_TANGENTIAL, &info) > 0);
    CHECK(info.wrong_faces > 0 && info.lift == 0);
    order_mesh_free(&m);
  }
}

/* And of others neither are found, though no cell is folded yet. */
static void moved_points_are_sorted_by_their_faces(void)
{
  order_mesh m = order_mesh_cubes(4, 0.48, 5);
  chi_tet_order_info info;
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.used == CHI_TET_ORDER_MPVO && info.convex == 1 && info.cycles == 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_CENTROID, &info) > 0);
  CHECK(judge_views(&m, CHI_TET_ORDER_MPVO, &info) == 0);
  order_mesh_free(&m);
}

/* A third of the cubes is missing: faces alone do not tell, the pixels' gaps do. */
static void gaps_are_looked_up_at_pixels(void)
{
  for (uint32_t seed = 1; seed <= 3; ++seed)
  {
    order_mesh m = order_mesh_cubes(4, seed == 3 ? 0.3 : 0, seed);
    order_mesh_thin(&m, seed == 2 ? 0.8 : 0.33, seed);
    chi_tet_order_info info;
    CHECK(judge_views(&m, CHI_TET_ORDER_XMPVO, &info) == 0);
    CHECK(info.convex == 0 && info.cycles == 0);
    /* what is left of a grid is part of the grid's own convex surface, unless too little is left
     * to tell which */
    CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
    CHECK(info.used == (seed == 2 ? CHI_TET_ORDER_XMPVO : CHI_TET_ORDER_TANGENTIAL));
    CHECK(info.lift == (seed != 2) && info.convex == 0 && info.cycles == 0);
    CHECK(seed != 2 || info.pieces > 1);
    CHECK(judge_views(&m, CHI_TET_ORDER_MPVO, &info) > 0);
    order_mesh_free(&m);
  }
}

/* Two grids, each with a lift across all its faces, that do not belong to one convex surface:
 * points of one lie below planes of the other, and keys would be wrong across the gap. */
static void a_lift_of_pieces_is_not_trusted(void)
{
  order_mesh a = order_mesh_cubes(3, 0, 1);
  order_mesh m = order_mesh_room(2 * a.point_count, 2 * a.count);
  for (size_t i = 0; i < a.point_count; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double x = a.points[i][k];
      m.points[i][k] = k == 0 ? 0.5 * x - 0.52 : x;
      m.points[a.point_count + i][k] = k == 0 ? 0.5 * x + 0.52 : 0.7 * x + 0.1 * k;
    }
  }
  for (size_t t = 0; t < a.count; ++t)
  {
    for (int k = 0; k < 4; ++k)
    {
      m.vertices[t][k] = a.vertices[t][k];
      m.vertices[a.count + t][k] = (uint32_t)a.point_count + a.vertices[t][k];
    }
  }
  chi_tet_order_info info;
  CHECK(judge_views(&m, CHI_TET_ORDER_AUTO, &info) == 0);
  CHECK(info.pieces == 2 && info.wrong_faces == 0 && info.tied_faces == 0);
  CHECK(info.lift == 0 && info.used == CHI_TET_ORDER_XMPVO && info.cycles == 0);
  order_mesh_free(&m);
  order_mesh_free(&a);
}

/* A camera that moves a little: the last order is put right where faces have turned, and is as
 * right as one from nothing. */
static void an_order_follows_the_camera(void)
{
  for (int gaps = 0; gaps < 2; ++gaps)
  {
    order_mesh m = order_mesh_cubes(9, 0.4, 6);
    if (gaps)
    {
      order_mesh_thin(&m, 0.05, 3);
    }
    const chi_tet_mesh_view mesh = order_mesh_view(&m);
    uint32_t* const keys = malloc(m.count * sizeof *keys);
    chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, SIZE);
    const chi_tet_order_view from = { sizeof from, &camera, NULL };
    chi_tet_order* order = NULL;
    long whole = 0, part = 0, nothing = 0;
    CHECK(chi_tet_order_create(
            NULL, &mesh, gaps ? CHI_TET_ORDER_XMPVO : CHI_TET_ORDER_MPVO, &order) == CHI_OK);
    for (int i = 0; i < 40; ++i)
    {
      chi_tet_order_info info;
      int32_t bits;
      int64_t violations = -1;
      /* sideways, by 1e-6 to 0.1 where the distance is 6.7 */
      camera.world_to_eye[3] += pow(10, -(i % 6)) * (i % 2 ? 0.1 : -0.1);
      CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == CHI_OK);
      CHECK(chi_tet_order_violations(NULL, &mesh, &from, keys, &violations) == CHI_OK);
      CHECK(violations == 0);
      CHECK(i % 10 || order_judge(&m, &camera, keys, 1) == 0);
      chi_tet_order_get_info(order, &info);
      CHECK(!info.reused);
      whole += info.sorted == (int64_t)m.count;
      part += info.sorted > 0 && info.sorted < (int64_t)m.count;
      nothing += info.sorted == 0;
    }

    CHECK(whole > 1 && part > 0 && nothing > 0);
    chi_tet_order_destroy(NULL, order);
    free(keys);
    order_mesh_free(&m);
  }
}

/* Three long tetrahedra, each over the next: no order is right, one is given, and it is counted. */
static void a_cycle_is_counted_and_broken(void)
{
  order_mesh m = order_mesh_room(12, 3);
  for (uint32_t t = 0; t < 3; ++t)
  {
    const double a = 2.0943951023931953 * t; /* a third of a turn */
    for (uint32_t k = 0; k < 4; ++k)
    {
      /* a bar along the triangle's side, rising from one end to the other */
      const double along = k < 2 ? -0.9 : 0.9, wide = k % 2 ? 0.12 : -0.12;
      const double x = along, y = -0.3 + (k < 2 ? wide : 0), z = 0.5 * along + (k < 2 ? 0 : wide);
      double* const p = m.points[4 * t + k];
      p[0] = x * cos(a) - y * sin(a);
      p[1] = x * sin(a) + y * cos(a);
      p[2] = z;
      m.vertices[t][k] = 4 * t + k;
    }
  }
  order_mesh_orient(&m);
  const chi_tet_mesh_view mesh = order_mesh_view(&m);
  const chi_camera camera = tet_view(TET_VIEW_AXIS, 1, 64);
  const chi_tet_order_view from = { sizeof from, &camera, NULL };
  chi_tet_order* order = NULL;
  chi_tet_order_info info;
  uint32_t keys[3] = { 9, 9, 9 };
  int32_t bits;
  int64_t violations = 0;
  CHECK(chi_tet_order_create(NULL, &mesh, CHI_TET_ORDER_AUTO, &order) == CHI_OK);
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == CHI_OK);
  chi_tet_order_get_info(order, &info);
  CHECK(info.pieces == 3 && info.cycles == 1 && bits == 2);
  CHECK((1u << keys[0] | 1u << keys[1] | 1u << keys[2]) == 7);
  CHECK(chi_tet_order_violations(NULL, &mesh, &from, keys, &violations) == CHI_OK);
  CHECK(violations > 0 && violations == order_judge(&m, &camera, keys, 0));
  chi_tet_order_destroy(NULL, order);
  order_mesh_free(&m);
}

/* The eye on a corner, on an edge, within faces, within the planes of others: no relation there. */
static void the_eye_may_lie_in_faces(void)
{
  static const double distances[] = { 0, 0.25, 0.5, 1, 2 };
  static const int methods[] = { CHI_TET_ORDER_AUTO, CHI_TET_ORDER_MPVO, CHI_TET_ORDER_XMPVO };
  order_mesh m = order_mesh_cubes(4, 0, 1);
  const chi_tet_mesh_view mesh = order_mesh_view(&m);
  uint32_t* const keys = malloc(m.count * sizeof *keys);
  for (int i = 0; i < 3; ++i)
  {
    chi_tet_order* order = NULL;
    CHECK(chi_tet_order_create(NULL, &mesh, methods[i], &order) == CHI_OK);
    for (int k = 0; k < 5 * 4; ++k)
    {
      const chi_camera camera = tet_look(distances[k / 4], 45 * (k % 4), 0, 0, SIZE, 1);
      const chi_tet_order_view from = { sizeof from, &camera, NULL };
      chi_tet_order_info info;
      int32_t bits;
      CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == CHI_OK);
      chi_tet_order_get_info(order, &info);
      CHECK(info.cycles == 0);
      CHECK(order_judge(&m, &camera, keys, 1) == 0);
    }
    chi_tet_order_destroy(NULL, order);
  }
  free(keys);
  order_mesh_free(&m);
}

int main(void)
{
  split_cubes_have_a_lift();
  sheared_cubes_have_a_lift();
  ties_are_told_apart_by_their_faces();
  huge_spheres_at_the_hull_harm_nobody();
  moved_points_have_heights();
  moved_points_are_sorted_by_their_faces();
  gaps_are_looked_up_at_pixels();
  a_lift_of_pieces_is_not_trusted();
  an_order_follows_the_camera();
  a_cycle_is_counted_and_broken();
  the_eye_may_lie_in_faces();
  return chi_test_report();
}
