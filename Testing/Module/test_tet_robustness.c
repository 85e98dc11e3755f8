/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The renderer of tetrahedra under hostile hosts and input. */
#include "chi_test.h"
#include "tet_frame.h"
#include "tet_reference.h"

enum
{
  SIZE = 80, /* four tiles */
  FLOATS = SIZE * SIZE * 4
};

/* A lit, cut scene with a surface: every stage has something to do. */
static void make_rich(scene* s, const tet_mesh* mesh, float* depth)
{
  static const chi_shading_light light = { .kind = CHI_LIGHT_EYE, .diffuse = { 1, 1, 1 } };
  static chi_shading_view shading;
  static chi_surface_view surface;
  static const double plane[4] = { 1, 2, 3, 1.5 };
  make_scene(s, mesh, TET_VIEW_CLOSE, 0, SIZE);
  tet_transfer_signal(&s->transfer, 1);
  for (int i = 0; i < SIZE * SIZE; ++i)
  {
    depth[i] = i % SIZE < SIZE / 2 ? 2.2f : INFINITY;
  }
  surface = (chi_surface_view){ .struct_size = sizeof surface, .depth = depth, .version = 1 };
  shading = (chi_shading_view){ .struct_size = sizeof shading,
    .ambient = 0.3,
    .diffuse = 0.7,
    .lights = &light,
    .light_count = 1 };
  s->frame.surface = &surface;
  s->frame.shading = &shading;
  s->frame.clip_planes = plane;
  s->frame.clip_plane_count = 1;
}

static void keep(const chi_tet* tet, float* out)
{
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  CHECK(image.width == SIZE && image.height == SIZE && image.rgba);
  if (image.rgba)
  {
    memcpy(out, image.rgba, FLOATS * sizeof(float));
  }
}

static void any_schedule_gives_the_same_bits(void)
{
  static float depth[SIZE * SIZE], a[FLOATS], b[FLOATS];
  tet_mesh* const mesh = tet_mesh_cubes(5, TET_MARSCHNER_LOBB);
  scene s;
  make_rich(&s, mesh, depth);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  chi_tet *one, *other;
  CHECK(chi_tet_create(NULL, &one) == CHI_OK && chi_tet_create(NULL, &other) == CHI_OK);
  CHECK(chi_tet_render(NULL, one, &s.frame) == CHI_OK);
  CHECK(chi_tet_render(&backwards, other, &s.frame) == CHI_OK);
  keep(one, a);
  keep(other, b);
  CHECK(memcmp(a, b, sizeof a) == 0);
  chi_tet_destroy(NULL, one);
  chi_tet_destroy(NULL, other);
  tet_mesh_free(mesh);
}

/* Each allocation refused, then each poll of cancellation answered: a status, nothing leaks, and
 * the next frame is right. */
static void a_host_may_refuse_and_cancel(void)
{
  static float depth[SIZE * SIZE], wanted[FLOATS], got[FLOATS];
  tet_mesh* const mesh = tet_mesh_cubes(3, TET_MARSCHNER_LOBB);
  scene s;
  make_rich(&s, mesh, depth);
  s.params.fragment_cache_bytes = 1 << 20;
  s.params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  chi_tet* good;
  CHECK(chi_tet_create(NULL, &good) == CHI_OK);
  CHECK(chi_tet_render(NULL, good, &s.frame) == CHI_OK);
  keep(good, wanted);
  int refused = 0, cancelled = 0;
  for (int cancels = 0; cancels < 2; ++cancels)
  {
    for (long k = 0;; ++k)
    {
      chi_test_host host = { .refuse_at = cancels ? -1 : k, .cancel_at = cancels ? k : 1L << 40 };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release,
        .is_cancelled = chi_test_is_cancelled };
      chi_tet* tet = NULL;
      chi_status status = chi_tet_create(&exec, &tet);
      if (status == CHI_OK)
      {
        status = chi_tet_render(&exec, tet, &s.frame);
        chi_tet_image image;
        chi_tet_get_image(tet, &image);
        CHECK((status == CHI_OK) == (image.rgba != NULL));
        host.refuse_at = -1; /* and is friendly from here on */
        host.cancel_at = 1L << 40;
        CHECK(chi_tet_render(&exec, tet, &s.frame) == CHI_OK);
        keep(tet, got);
        CHECK(memcmp(wanted, got, sizeof got) == 0);
      }
      chi_tet_destroy(&exec, tet);
      CHECK(host.live == 0);
      refused += status == CHI_ERROR_OUT_OF_MEMORY;
      cancelled += status == CHI_ERROR_CANCELLED;
      if (status == CHI_OK)
      {
        break;
      }
      CHECK(status == (cancels ? CHI_ERROR_CANCELLED : CHI_ERROR_OUT_OF_MEMORY));
    }
  }
  CHECK(refused > 15 && cancelled > 5);
  chi_tet_destroy(NULL, good);
  tet_mesh_free(mesh);
}

/* Cameras and functions change, and nothing is allocated any more. */
static void a_warm_frame_allocates_nothing(void)
{
  static float depth[SIZE * SIZE];
  tet_mesh* const mesh = tet_mesh_cubes(4, TET_MARSCHNER_LOBB);
  scene s;
  make_rich(&s, mesh, depth);
  s.params.pre_integration =
    CHI_PREINTEGRATION_PARTIAL; /* the automatic choice borrows for itself */
  chi_test_host host = { .refuse_at = -1, .cancel_at = 1L << 40 };
  const chi_exec exec = {
    .struct_size = sizeof exec, .user = &host, .alloc = chi_test_alloc, .release = chi_test_release
  };
  chi_tet* tet;
  CHECK(chi_tet_create(&exec, &tet) == CHI_OK);
  long before = 0;
  for (int frame = 0; frame < 8; ++frame) /* twice the same four views */
  {
    before = frame == 4 ? host.allocations : before;
    s.camera = tet_look(4, 20 * (frame % 4), 10, 0, SIZE, 0.4);
    s.transfer.view.version += 1;
    CHECK(chi_tet_render(&exec, tet, &s.frame) == CHI_OK);
  }
  CHECK(host.allocations == before);
  chi_tet_destroy(&exec, tet);
  CHECK(host.live == 0);
  tet_mesh_free(mesh);
}

static void bad_input_is_refused_or_counted(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, SIZE);
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_tet_render(NULL, tet, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_tet_render(NULL, NULL, &s.frame) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_stats stats;
#define REFUSED(change, back)                                                                      \
  change;                                                                                          \
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_ERROR_INVALID_ARGUMENT);                        \
  back
  REFUSED(s.camera.width = 0, s.camera.width = SIZE);
  REFUSED(s.camera.width = 20000, s.camera.width = SIZE);
  REFUSED(s.camera.near_depth = 0, s.camera.near_depth = 0.01);
  REFUSED(s.camera.world_to_eye[0] = NAN, s.camera = tet_view(TET_VIEW_OBLIQUE, 0, SIZE));
  REFUSED(s.field.component = 1, s.field.component = 0);
  REFUSED(s.field.scalars = NULL, s.field.scalars = &s.scalars);
  REFUSED((s.scalars.count -= 1, s.field.version += 1), s.scalars.count += 1);
  REFUSED(s.params.order = 9, s.params.order = 0);
  REFUSED(s.params.blend = 2, s.params.blend = 0);
  REFUSED(s.frame.clip_plane_count = 1, s.frame.clip_plane_count = 0);
  REFUSED(s.frame.clip_plane_count = 33, s.frame.clip_plane_count = 0);
  REFUSED(s.frame.struct_size = 8, s.frame.struct_size = sizeof s.frame);
  REFUSED(s.params.struct_size = 8, s.params.struct_size = sizeof s.params);
  REFUSED(s.transfer.view.range[1] = s.transfer.view.range[0], s.transfer.view.range[1] += 1);
  static const double singular[16] = { 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  REFUSED(s.frame.grid_to_world = singular, s.frame.grid_to_world = NULL);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);

  /* scalars that are not finite: the tetrahedra at them */
  mesh->scalars[0] = NAN;
  s.field.version += 1;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.non_finite_cells == 6); /* all of the first cube: its diagonal starts there */
  mesh->scalars[0] = 0;
  s.field.version += 1;

  /* a broken cell has a name */
  chi_tet_image image;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  mesh->connectivity[4 * 7 + 2] = 1000;
  s.grid.version += 1;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.grid.first_bad_cell == 7);
  chi_tet_get_image(tet, &image);
  CHECK(image.rgba && image.width == SIZE); /* the last picture stands */

  /* nothing at all is nothing to draw */
  s.grid.cell_count = 0;
  s.grid.connectivity_count = 0;
  s.grid.version += 1;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_image(tet, &image);
  CHECK(image.rgba && image.rgba[3] == 0);
  chi_tet_destroy(NULL, tet);
  chi_tet_destroy(NULL, NULL);
  tet_mesh_free(mesh);
}

/* The homogeneous cube cut by a plane and by a surface has closed forms; under any matrix lengths
 * are those of the world. The bound is that of the uncut cube; cuts are made in float, to 1e-6 of
 * the distance, times the extinction. */
static void cuts_and_matrices_have_closed_forms(void)
{
  static float depth[SIZE * SIZE];
  tet_mesh* const mesh = tet_mesh_cubes(3, TET_CONSTANT);
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    for (int kind = 0; kind < 3; ++kind) /* a plane, a surface, a matrix */
    {
      scene s;
      make_scene(&s, mesh, TET_VIEW_AXIS, parallel, SIZE);
      const double plane[4] = { 0, 0, -1,
        0.25 }; /* z < 1/4 stays; the eye looks along -z from +z */
      const double eye = s.camera.world_to_eye[11] < 0 ? -s.camera.world_to_eye[11] : 0;
      for (int i = 0; i < SIZE * SIZE; ++i)
      {
        depth[i] = (float)(eye + 0.5); /* z = -1/2 */
      }
      const chi_surface_view surface = {
        .struct_size = sizeof surface, .depth = depth, .version = 1
      };
      const double matrix[16] = { 0, -0.5, 0, 0, 2, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 };
      double low[3] = { -1, -1, -1 }, high[3] = { 1, 1, 1 };
      if (kind == 0)
      {
        s.frame.clip_planes = plane;
        s.frame.clip_plane_count = 1;
        high[2] = 0.25;
      }
      else if (kind == 1)
      {
        s.frame.surface = &surface;
        low[2] = -0.5;
      }
      else
      {
        s.frame.grid_to_world = matrix;
        low[0] = -0.5;
        high[0] = 0.5;
        low[1] = -2;
        high[1] = 2;
      }
      chi_tet* tet;
      CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
      CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
      chi_tet_image image;
      chi_tet_get_image(tet, &image);
      double worst = 0;
      for (int i = 0; i < SIZE * SIZE; ++i)
      {
        double at[2], enter = 0, leave = INFINITY, way[3];
        for (int k = 0; k < 2; ++k)
        {
          const double width = s.camera.window[2 * k + 1] - s.camera.window[2 * k];
          at[k] = s.camera.window[2 * k] + ((k ? i / SIZE : i % SIZE) + 0.5) / SIZE * width;
        }
        way[0] = parallel ? 0 : at[0];
        way[1] = parallel ? 0 : at[1];
        way[2] = -1;
        const double from[3] = { parallel ? at[0] : 0, parallel ? at[1] : 0, eye };
        for (int k = 0; k < 3; ++k)
        {
          const double a = (low[k] - from[k]) / way[k], b = (high[k] - from[k]) / way[k];
          enter = fmax(enter, fmin(a, b));
          leave = fmin(leave, fmax(a, b));
        }
        const double length = fmax(leave - enter, 0) * sqrt(way[0] * way[0] + way[1] * way[1] + 1);
        const double error = fabs((double)image.rgba[4 * i + 3] + expm1(-0.3 * length));
        worst = length > 1e-3 && error > worst ? error : worst;
      }
      CHECK_NEAR(worst, 0, 1e-4);
      chi_tet_destroy(NULL, tet);
    }
  }
  tet_mesh_free(mesh);
}

/* A vertex out of the range of floats takes its tetrahedra away, and no others; a unit distance
 * there leaves nothing to see. */
static void what_floats_cannot_hold_is_left_out(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_CONSTANT);
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      scene s;
      make_scene(&s, mesh, TET_VIEW_AXIS, parallel, SIZE);
      const double was = mesh->points[26][axis]; /* the corner (1, 1, 1), that 6 tetrahedra share */
      mesh->points[26][axis] = axis == 2 ? -3e38 : 3e38;
      chi_tet* tet;
      CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
      CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
      chi_tet_stats stats;
      chi_tet_get_stats(tet, &stats);
      CHECK(stats.outside == 6);
      chi_tet_image image;
      chi_tet_get_image(tet, &image);
      double worst = 0;
      int missing = 0, wrong = 0;
      for (int i = 0; i < SIZE * SIZE; ++i)
      {
        const double length = tet_reference_cube_length(&s.camera, i % SIZE + 0.5, i / SIZE + 0.5);
        const double alpha = (double)image.rgba[4 * i + 3];
        const int is_corner = i % SIZE >= SIZE / 2 - 1 && i / SIZE >= SIZE / 2 - 1;
        wrong += !(alpha >= 0 && alpha < 1);
        missing += length > 0.5 && alpha < 0.9 * -expm1(-0.3 * length);
        worst =
          is_corner || length < 1e-3 ? worst : fmax(worst, fabs(alpha + expm1(-0.3 * length)));
      }
      CHECK_NEAR(worst, 0, 1e-4); /* as of the whole cube */
      CHECK(missing > 0 && wrong == 0);
      mesh->points[26][axis] = was;
      if (axis == 0)
      {
        s.params.blend = CHI_TET_BLEND_MAXIMUM;
        s.transfer.view.unit_distance = 1e60;
        s.transfer.view.version += 1;
        s.grid.version += 1;
        CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
        chi_tet_get_image(tet, &image);
        for (int i = 0; i < FLOATS; ++i)
        {
          wrong += image.rgba[i] != 0;
        }
        CHECK(wrong == 0);
      }
      chi_tet_destroy(NULL, tet);
    }
  }
  tet_mesh_free(mesh);
}

int main(void)
{
  what_floats_cannot_hold_is_left_out();
  any_schedule_gives_the_same_bits();
  a_host_may_refuse_and_cancel();
  a_warm_frame_allocates_nothing();
  bad_input_is_refused_or_counted();
  cuts_and_matrices_have_closed_forms();
  return chi_test_report();
}
