/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Hostile hosts and broken meshes. */

#include "counting_host.h"
#include "tet_order_meshes.h"

typedef struct outcome
{
  uint32_t* keys;
  chi_tet_order_info info;
  int64_t violations;
  int32_t bits;
} outcome;

static chi_status run(const chi_exec* exec, const order_mesh* m, int method, int view, outcome* out)
{
  const chi_tet_mesh_view mesh = order_mesh_view(m);
  const chi_camera camera = tet_view(view, 0, 40);
  const chi_tet_order_view from = { sizeof from, &camera, NULL };
  chi_tet_order* order = NULL;
  chi_status status = chi_tet_order_create(exec, &mesh, method, &order);
  CHECK((status == CHI_OK) == (order != NULL));
  if (status == CHI_OK)
  {
    status = chi_tet_order_keys(exec, order, &from, out->keys, &out->bits);
    chi_tet_order_get_info(order, &out->info);
  }
  if (status == CHI_OK)
  {
    status = chi_tet_order_violations(exec, &mesh, &from, out->keys, &out->violations);
  }
  chi_tet_order_destroy(exec, order);
  return status;
}

/* Meshes that need each of the ways: a form, one with ties, heights, gaps. */
static order_mesh make(int kind)
{
  order_mesh m = kind == 1 ? order_mesh_centered(1, 5) : order_mesh_cubes(4, kind * 0.24, 3);
  if (kind == 3)
  {
    order_mesh_thin(&m, 0.4, 8);
  }
  return m;
}

static void any_schedule_gives_the_same_bits(void)
{
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  for (int kind = 0; kind < 4; ++kind)
  {
    order_mesh m = make(kind);
    outcome a = { .keys = malloc(m.count * 4) }, b = { .keys = malloc(m.count * 4) };
    for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
    {
      CHECK(run(NULL, &m, method, TET_VIEW_CLOSE, &a) == CHI_OK);
      CHECK(run(&backwards, &m, method, TET_VIEW_CLOSE, &b) == CHI_OK);
      CHECK(memcmp(a.keys, b.keys, m.count * 4) == 0 && a.bits == b.bits);
      CHECK(a.info.cycles == b.info.cycles && a.info.tied_faces == b.info.tied_faces);
      CHECK(a.info.wrong_faces == b.info.wrong_faces && a.violations == b.violations);
      CHECK(method != CHI_TET_ORDER_AUTO || a.violations == 0);
    }
    free(a.keys);
    free(b.keys);
    order_mesh_free(&m);
  }
}

static void each_refusal_and_each_cancel_is_survived(void)
{
  for (int kind = 0; kind < 4; ++kind)
  {
    order_mesh m = make(kind);
    outcome out = { .keys = malloc(m.count * 4) };
    for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
    {
      chi_test_host host = { .refuse_at = -1, .cancel_at = 1000000 };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release,
        .is_cancelled = chi_test_is_cancelled };
      CHECK(run(&exec, &m, method, TET_VIEW_OBLIQUE, &out) == CHI_OK);
      CHECK(host.live == 0);
      const long allocations = host.allocations, polls = host.polls;
      for (long i = 0; i < allocations; ++i)
      {
        host = (chi_test_host){ .refuse_at = i, .cancel_at = 1000000 };
        CHECK(run(&exec, &m, method, TET_VIEW_OBLIQUE, &out) == CHI_ERROR_OUT_OF_MEMORY);
        CHECK(host.live == 0);
      }
      for (long i = 0; i < polls; ++i)
      {
        host = (chi_test_host){ .refuse_at = -1, .cancel_at = i };
        CHECK(run(&exec, &m, method, TET_VIEW_OBLIQUE, &out) == CHI_ERROR_CANCELLED);
        CHECK(host.live == 0);
      }
    }
    free(out.keys);
    order_mesh_free(&m);
  }
}

/* The second frame of a size has all that it needs. */
static void frames_allocate_nothing(void)
{
  for (int kind = 0; kind < 4; ++kind)
  {
    order_mesh m = make(kind);
    const chi_tet_mesh_view mesh = order_mesh_view(&m);
    chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 40);
    const chi_tet_order_view from = { sizeof from, &camera, NULL };
    chi_test_host host = { .refuse_at = -1, .cancel_at = 1000000 };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    uint32_t* const keys = malloc(m.count * 4);
    int32_t bits;
    chi_tet_order* order = NULL;
    chi_tet_order_info info;
    CHECK(chi_tet_order_create(&exec, &mesh, CHI_TET_ORDER_AUTO, &order) == CHI_OK);
    CHECK(chi_tet_order_keys(&exec, order, &from, keys, &bits) == CHI_OK);
    const long before = host.allocations;
    camera.world_to_eye[8] += 1e-15; /* not the same, but it sees the same */
    CHECK(chi_tet_order_keys(&exec, order, &from, keys, &bits) == CHI_OK);
    chi_tet_order_get_info(order, &info);
    CHECK(host.allocations == before && !info.reused);
    chi_tet_order_destroy(&exec, order);
    CHECK(host.live == 0);
    free(keys);
    order_mesh_free(&m);
  }
}

/* Flat ones, double ones, three at a face, points that are not finite: an order is given. */
static void broken_meshes_are_ordered(void)
{
  order_mesh whole = order_mesh_cubes(3, 0.1, 3);
  order_mesh m = order_mesh_room(whole.point_count + 2, whole.count + 5);
  memcpy(m.points, whole.points, 24 * whole.point_count);
  memcpy(m.vertices, whole.vertices, 16 * whole.count);
  const uint32_t nowhere = (uint32_t)whole.point_count, more = (uint32_t)whole.count;
  m.points[nowhere][0] = NAN;
  m.points[nowhere + 1][1] = INFINITY;
  memcpy(m.vertices[more], m.vertices[7], 16);      /* twice */
  memcpy(m.vertices[more + 1], m.vertices[20], 16); /* two more at three faces of one */
  m.vertices[more + 1][0] = m.vertices[60][1];      /* through others, too */
  memcpy(m.vertices[more + 2], (uint32_t[4]){ 0, 1, 4, 5 }, 16); /* flat */
  memcpy(m.vertices[more + 3], (uint32_t[4]){ 3, 3, 3, 3 }, 16); /* a point */
  memcpy(m.vertices[more + 4], (uint32_t[4]){ 0, 1, nowhere, nowhere + 1 }, 16);
  outcome out = { .keys = malloc(m.count * 4) };
  for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
  {
    for (int view = 0; view <= TET_VIEW_INSIDE; ++view)
    {
      CHECK(run(NULL, &m, method, view, &out) == CHI_OK);
      CHECK(out.bits == 32 || out.keys[3] >> out.bits == 0);
      CHECK(method == CHI_TET_ORDER_CENTROID || out.info.bad_faces >= 4);
      CHECK(out.info.lift == 0 && out.info.convex == 0);
    }
  }
  free(out.keys);
  order_mesh_free(&m);
  order_mesh_free(&whole);
}

/* Cells without volume lie between others and cover nothing: the rest stays in order. */
static void flat_cells_harm_nobody(void)
{
  order_mesh whole = order_mesh_cubes(3, 0, 3);
  order_mesh m = order_mesh_room(whole.point_count, whole.count + 1);
  memcpy(m.points, whole.points, 24 * whole.point_count);
  memcpy(m.vertices, whole.vertices, 16 * whole.count);
  memcpy(m.vertices[whole.count], (uint32_t[4]){ 0, 1, 4, 5 }, 16); /* on the outside */
  outcome out = { .keys = malloc(m.count * 4) };
  for (int view = 0; view <= TET_VIEW_INSIDE; ++view)
  {
    CHECK(run(NULL, &m, CHI_TET_ORDER_AUTO, view, &out) == CHI_OK);
    CHECK(out.violations == 0);
  }
  free(out.keys);
  order_mesh_free(&m);
  order_mesh_free(&whole);
}

static void bad_arguments_are_refused(void)
{
  order_mesh m = order_mesh_cubes(1, 0, 3);
  chi_tet_mesh_view mesh = order_mesh_view(&m);
  chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 8);
  chi_tet_order_view from = { sizeof from, &camera, NULL };
  chi_tet_order *order = NULL, *none = NULL;
  uint32_t keys[6];
  int32_t bits;
  int64_t violations;
  const chi_status bad = CHI_ERROR_INVALID_ARGUMENT;
  CHECK(chi_tet_order_create(NULL, NULL, 0, &none) == bad);
  CHECK(chi_tet_order_create(NULL, &mesh, 0, NULL) == bad);
  CHECK(chi_tet_order_create(NULL, &mesh, -1, &none) == bad);
  CHECK(chi_tet_order_create(NULL, &mesh, CHI_TET_ORDER_XMPVO + 1, &none) == bad);
  mesh.struct_size -= 8;
  CHECK(chi_tet_order_create(NULL, &mesh, 0, &none) == bad);
  mesh = order_mesh_view(&m);
  mesh.points.count = 7;
  CHECK(chi_tet_order_create(NULL, &mesh, 0, &none) == bad);
  CHECK(chi_tet_order_violations(NULL, &mesh, &from, keys, &violations) == bad);
  mesh = order_mesh_view(&m);
  mesh.vertices = NULL;
  CHECK(chi_tet_order_create(NULL, &mesh, 0, &none) == bad);
  mesh = order_mesh_view(&m);
  mesh.count = (size_t)1 << 30;
  CHECK(chi_tet_order_create(NULL, &mesh, 0, &none) == CHI_ERROR_TOO_LARGE);
  CHECK(none == NULL);
  mesh = order_mesh_view(&m);
  CHECK(chi_tet_order_create(NULL, &mesh, 0, &order) == CHI_OK);
  CHECK(chi_tet_order_keys(NULL, NULL, &from, keys, &bits) == bad);
  CHECK(chi_tet_order_keys(NULL, order, NULL, keys, &bits) == bad);
  CHECK(chi_tet_order_keys(NULL, order, &from, NULL, &bits) == bad);
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, NULL) == bad);
  from.struct_size -= 8;
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == bad);
  from.struct_size += 8;
  const double singular[16] = { 0 };
  from.grid_to_world = singular;
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == bad);
  from.grid_to_world = NULL;
  camera.world_to_eye[3] = NAN;
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == bad);
  camera = tet_view(TET_VIEW_OBLIQUE, 0, 0);
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == bad);
  from.camera = NULL;
  CHECK(chi_tet_order_keys(NULL, order, &from, keys, &bits) == bad);
  CHECK(chi_tet_order_violations(NULL, &mesh, &from, keys, &violations) == bad);
  camera = tet_view(TET_VIEW_OBLIQUE, 0, 8);
  from.camera = &camera;
  CHECK(chi_tet_order_violations(NULL, &mesh, &from, NULL, &violations) == bad);
  chi_tet_order_destroy(NULL, order);
  chi_tet_order_destroy(NULL, NULL);
  order_mesh_free(&m);
}

static void no_tetrahedra_have_an_order(void)
{
  const chi_tet_mesh_view mesh = { sizeof mesh, { NULL, 0, 24, CHI_F64 }, NULL, 0 };
  const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 8);
  const chi_tet_order_view from = { sizeof from, &camera, NULL };
  for (int method = 0; method <= CHI_TET_ORDER_XMPVO; ++method)
  {
    chi_tet_order* order = NULL;
    uint32_t key;
    int32_t bits = 0;
    int64_t violations = -1;
    CHECK(chi_tet_order_create(NULL, &mesh, method, &order) == CHI_OK);
    CHECK(chi_tet_order_keys(NULL, order, &from, &key, &bits) == CHI_OK && bits >= 1);
    CHECK(chi_tet_order_violations(NULL, &mesh, &from, NULL, &violations) == CHI_OK);
    CHECK(violations == 0);
    chi_tet_order_destroy(NULL, order);
  }
}

/* The bounds beyond points and vertices: 20 bytes a tetrahedron with a lift, 24 more with
 * adjacency; what exterior faces take at the pixels does not grow with the mesh. */
static void memory_stays_within_bounds(void)
{
  static const double moved[2] = { 0, 0.48 }, most[2] = { 20, 44 };
  for (int k = 0; k < 2; ++k)
  {
    order_mesh m = order_mesh_cubes(20, moved[k], 1);
    const chi_tet_mesh_view mesh = order_mesh_view(&m);
    const chi_camera camera = tet_view(TET_VIEW_OBLIQUE, 0, 64);
    const chi_tet_order_view from = { sizeof from, &camera, NULL };
    uint32_t* const keys = malloc(m.count * sizeof *keys);
    counting_host host = { 0 };
    const chi_exec exec = counting_exec(&host);
    chi_tet_order* order = NULL;
    chi_tet_order_info info;
    int32_t bits;
    CHECK(chi_tet_order_create(&exec, &mesh, CHI_TET_ORDER_AUTO, &order) == CHI_OK);
    CHECK(chi_tet_order_keys(&exec, order, &from, keys, &bits) == CHI_OK);
    chi_tet_order_get_info(order, &info);
    CHECK(info.used == (k ? CHI_TET_ORDER_MPVO : CHI_TET_ORDER_TANGENTIAL));
    CHECK((double)host.live <= most[k] * (double)m.count + 4096);
    CHECK(info.bytes <= host.live && info.bytes + 4096 > host.live); /* ends of cache lines */
    chi_tet_order_destroy(&exec, order);
    CHECK(host.live == 0);
    free(keys);
    order_mesh_free(&m);
  }
}

int main(void)
{
  any_schedule_gives_the_same_bits();
  each_refusal_and_each_cancel_is_survived();
  frames_allocate_nothing();
  broken_meshes_are_ordered();
  flat_cells_harm_nobody();
  bad_arguments_are_refused();
  no_tetrahedra_have_an_order();
  memory_stays_within_bounds();
  return chi_test_report();
}
