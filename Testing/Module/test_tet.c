/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_test.h"
#include "tet_frame.h"
#include "tet_reference.h"

/* Float pictures of a homogeneous cube: the bound, 1e-4; it is float rounding of what is
 * accumulated over up to 6 n fragments of a ray. */
static void a_homogeneous_cube_has_the_closed_form(void)
{
  static const size_t sizes[] = { 1, 4, 16 };
  for (int view = 0; view <= TET_VIEW_INSIDE; ++view)
  {
    for (int parallel = 0; parallel <= (view != TET_VIEW_INSIDE); ++parallel)
    {
      for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k)
      {
        tet_mesh* const mesh = tet_mesh_cubes(sizes[k], TET_CONSTANT);
        scene s;
        make_scene(&s, mesh, view, parallel, 128);
        chi_tet* tet;
        CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
        CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
        chi_tet_image image;
        chi_tet_get_image(tet, &image);
        double worst = 0;
        for (int y = 0; y < 128; ++y)
        {
          for (int x = 0; x < 128; ++x)
          {
            const double length = tet_reference_cube_length(&s.camera, x + 0.5, y + 0.5);
            const double error =
              fabs((double)image.rgba[4 * (128 * y + x) + 3] + expm1(-0.3 * length));
            /* within the margin of a silhouette either answer is right */
            worst = length > 1e-3 && error > worst ? error : worst;
          }
        }
        CHECK_NEAR(worst, 0, 1e-4);
        chi_tet_destroy(NULL, tet);
        tet_mesh_free(mesh);
      }
    }
  }
}

/* A surface and a clip plane end rays in cells whose first vertex lies behind the eye, as anywhere.
 */
static void cuts_hold_in_cells_around_the_eye(void)
{
  static float depth[64 * 64];
  const chi_surface_view surface = { .struct_size = sizeof surface, .depth = depth, .version = 1 };
  for (size_t n = 1; n <= 3; ++n)
  {
    tet_mesh* const mesh = tet_mesh_cubes(n, TET_CONSTANT);
    scene s;
    make_scene(&s, mesh, TET_VIEW_INSIDE, 0, 64);
    s.camera = tet_look(0.37, 213, -27, 0, 64, 0.57735); /* from the points that come first */
    const double* const m = s.camera.world_to_eye;
    const double plane[4] = { m[8], m[9], m[10], m[11] + 0.2 }; /* what is nearer than 0.2 stays */
    for (int clips = 0; clips < 2; ++clips)
    {
      for (int i = 0; i < 64 * 64; ++i)
      {
        depth[i] = 0.2f;
      }
      s.frame.surface = clips ? NULL : &surface;
      s.frame.clip_planes = plane;
      s.frame.clip_plane_count = (size_t)clips;
      chi_tet* tet;
      CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
      CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
      chi_tet_image image;
      chi_tet_get_image(tet, &image);
      double worst = 0;
      for (int i = 0; i < 64 * 64; ++i)
      {
        const double* const w = s.camera.window;
        const double x = w[0] + (w[1] - w[0]) * (i % 64 + 0.5) / 64;
        const double y = w[2] + (w[3] - w[2]) * (i / 64 + 0.5) / 64;
        const double length = (0.2 - s.camera.near_depth) * sqrt(1 + x * x + y * y);
        worst = fmax(worst, fabs((double)image.rgba[4 * i + 3] + expm1(-0.3 * length)));
      }
      CHECK_NEAR(worst, 0, 1e-4); /* as of whole rays */
      chi_tet_destroy(NULL, tet);
    }
    tet_mesh_free(mesh);
  }
}

/* Nothing is done twice, and what is done again gives the same. */
static void an_unchanged_frame_stands(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(4, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 64);
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  float* const first = (float*)malloc(64 * 64 * 4 * sizeof(float));
  memcpy(first, image.rgba, 64 * 64 * 4 * sizeof(float));
  chi_tet_stats stats;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.reused == 1);
  s.params.skip = CHI_TET_SKIP_NOTHING;
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  chi_tet_get_image(tet, &image);
  CHECK(stats.reused == 0);
  CHECK(memcmp(first, image.rgba, 64 * 64 * 4 * sizeof(float)) == 0);
  free(first);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

/* The largest value along a ray through a ramp along x is that where the ray has the largest x. */
static void maximum_intensity_is_that_of_the_largest_scalar(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(3, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_AXIS, 1, 64);
  s.params.blend = CHI_TET_BLEND_MAXIMUM;
  for (int i = 0; i < TET_TABLE; ++i)
  {
    const float c = (float)i / (TET_TABLE - 1);
    s.transfer.rgb[i][0] = s.transfer.rgb[i][1] = s.transfer.rgb[i][2] = c;
    s.transfer.opacity[i] = 1;
  }
  s.transfer.view.version += 1;
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  const double step = (s.camera.window[1] - s.camera.window[0]) / 64;
  double worst = 0;
  for (int y = 0; y < 64; ++y)
  {
    for (int x = 0; x < 64; ++x)
    {
      const double wx = s.camera.window[0] + (x + 0.5) * step;
      if (tet_reference_cube_length(&s.camera, x + 0.5, y + 0.5) > 0)
      {
        const double error = fabs((double)image.rgba[4 * (64 * y + x)] - 0.5 * (wx + 1));
        worst = error > worst ? error : worst;
      }
    }
  }
  CHECK_NEAR(worst, 0, 1e-5); /* a hundred roundings of a float */
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

/* One tetrahedron in the middle of the view is what one points at. */
static void one_points_at_the_cell_that_is_there(void)
{
  const double points[4][3] = { { -1, -1, 0 }, { 1, -1, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  tet_mesh* const mesh = tet_mesh_single(points);
  scene s;
  make_scene(&s, mesh, TET_VIEW_AXIS, 1, 32);
  tet_transfer_constant(&s.transfer, 1);
  int64_t cells[32 * 32];
  float depths[32 * 32];
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_find_cells(NULL, tet, &s.frame, 0.5, cells, depths) == CHI_OK);
  CHECK(cells[32 * 16 + 16] == 0);
  CHECK(cells[0] == -1 && isinf(depths[0]));
  CHECK(chi_tet_find_cells(NULL, tet, &s.frame, 1.5, cells, depths) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

/* Pointing changes no picture of the same frame, and what statistics say of the mesh and its order
 * is true of what was pointed at last. */
static void pointing_leaves_the_picture(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_RAMP);
  tet_mesh* const finer = tet_mesh_cubes(3, TET_RAMP);
  scene s, t;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 32);
  make_scene(&t, finer, TET_VIEW_OBLIQUE, 0, 32);
  t.params.order = CHI_TET_ORDER_MPVO;
  s.params.blend = CHI_TET_BLEND_MAXIMUM; /* which pointing does not do */
  int64_t cells[32 * 32];
  float depths[32 * 32];
  chi_tet* tet;
  chi_tet_stats stats;
  chi_tet_image image;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  CHECK(chi_tet_find_cells(NULL, tet, &s.frame, 0.1, cells, depths) == CHI_OK);
  CHECK(cells[32 * 16 + 16] >= 0);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.reused == 1 && stats.order.used == CHI_TET_ORDER_TANGENTIAL);
  CHECK(chi_tet_find_cells(NULL, tet, &t.frame, 0.1, cells, depths) == CHI_OK);
  chi_tet_get_image(tet, &image);
  CHECK(!image.rgba);
  CHECK(chi_tet_render(NULL, tet, &t.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.reused == 0 && stats.grid.tetrahedra == finer->count);
  CHECK(stats.tetrahedra == (int64_t)finer->count && stats.order.used == CHI_TET_ORDER_MPVO);
  /* a broken cell has its name here, too */
  finer->connectivity[4 * 5] = -1;
  t.grid.version += 1;
  CHECK(chi_tet_find_cells(NULL, tet, &t.frame, 0.1, cells, depths) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.grid.first_bad_cell == 5);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
  tet_mesh_free(finer);
}

/* Colours of kept fragments differ by what their scalars are rounded by: 1/65535 of the range, and
 * the steepest colour of the signal's table goes from 0 to 1 over half of it; so 3e-5 a fragment,
 * of which the pixel is a mean. */
static void kept_fragments_give_the_same_picture(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(6, TET_MARSCHNER_LOBB);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 96);
  tet_transfer_signal(&s.transfer, 1);
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  float* const first = (float*)malloc(96 * 96 * 4 * sizeof(float));
  memcpy(first, image.rgba, 96 * 96 * 4 * sizeof(float));
  s.params.fragment_cache_bytes = (size_t)1 << 24;
  chi_tet_stats stats;
  for (int frame = 0; frame < 4; ++frame)
  {
    s.transfer.view.version += 1;
    CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
    chi_tet_get_stats(tet, &stats);
    CHECK((stats.bytes_cache > 0) == (frame >= 2));
    CHECK((stats.drawn == 0) == (frame == 3)); /* the fourth draws no tetrahedron */
    chi_tet_get_image(tet, &image);
    double worst = 0;
    for (int i = 0; i < 96 * 96 * 4; ++i)
    {
      const double error = fabs((double)image.rgba[i] - (double)first[i]);
      worst = error > worst ? error : worst;
    }
    CHECK_NEAR(worst, 0, frame < 3 ? 0 : 3e-5);
  }
  s.camera = tet_view(TET_VIEW_CLOSE, 0, 96);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.drawn > 0);
  /* too little room for any */
  s.params.fragment_cache_bytes = 100;
  for (int frame = 0; frame < 4; ++frame)
  {
    s.transfer.view.version += 1;
    CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
    chi_tet_get_stats(tet, &stats);
    CHECK(stats.drawn > 0);
  }
  free(first);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

/* A coarse picture of what is smooth is the picture, where it is smooth: linear interpolation
 * between pixels r apart is off by at most r^2 / 8 of the second difference. */
static void a_reduced_picture_is_the_picture_enlarged(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_CONSTANT);
  scene s;
  make_scene(&s, mesh, TET_VIEW_INSIDE, 0, 99);
  chi_tet *full, *coarse;
  CHECK(chi_tet_create(NULL, &full) == CHI_OK && chi_tet_create(NULL, &coarse) == CHI_OK);
  CHECK(chi_tet_render(NULL, full, &s.frame) == CHI_OK);
  s.params.reduction = 2;
  CHECK(chi_tet_render(NULL, coarse, &s.frame) == CHI_OK);
  chi_tet_image a, b;
  chi_tet_get_image(full, &a);
  chi_tet_get_image(coarse, &b);
  CHECK(b.width == 99 && b.height == 99);
  double mean = 0;
  for (int i = 0; i < 99 * 99; ++i)
  {
    mean += fabs((double)a.rgba[4 * i + 3] - (double)b.rgba[4 * i + 3]) / (99 * 99);
  }
  CHECK(mean > 0);
  CHECK_NEAR(mean, 0, 1e-3); /* edges of the cube alone are not smooth */
  chi_tet_stats stats;
  CHECK(chi_tet_render(NULL, coarse, &s.frame) == CHI_OK);
  chi_tet_get_stats(coarse, &stats);
  CHECK(stats.reused == 1);
  s.params.reduction = 9;
  CHECK(chi_tet_render(NULL, coarse, &s.frame) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_destroy(NULL, full);
  chi_tet_destroy(NULL, coarse);
  tet_mesh_free(mesh);
}

/* The gradient of a ramp along x is (1, 0, 0) everywhere: a light that travels at an angle to it
 * changes all colours by one factor, |n.l|, and adds nothing where there is no highlight. */
static void a_ramp_is_lit_as_one(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(3, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_AXIS, 1, 64);
  chi_tet *plain, *lit;
  CHECK(chi_tet_create(NULL, &plain) == CHI_OK && chi_tet_create(NULL, &lit) == CHI_OK);
  CHECK(chi_tet_render(NULL, plain, &s.frame) == CHI_OK);
  const chi_shading_light light = { .kind = CHI_LIGHT_DIRECTIONAL,
    .direction = { 3, 0, -4 },
    .diffuse = { 1, 0.5, 0 },
    .specular = { 1, 1, 1 } };
  chi_shading_view shading = { .struct_size = sizeof shading,
    .ambient = 0.25,
    .diffuse = 0.5,
    .two_sided = 1,
    .lights = &light,
    .light_count = 1 };
  s.frame.shading = &shading;
  CHECK(chi_tet_render(NULL, lit, &s.frame) == CHI_OK);
  chi_tet_image a, b;
  chi_tet_get_image(plain, &a);
  chi_tet_get_image(lit, &b);
  const double factor[3] = { 0.25 + 0.5 * 0.6, 0.25 + 0.5 * 0.6 * 0.5, 0.25 };
  double worst = 0;
  for (int i = 0; i < 64 * 64; ++i)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double error = fabs((double)b.rgba[4 * i + k] - factor[k] * (double)a.rgba[4 * i + k]);
      worst = error > worst ? error : worst;
    }
    worst = fmax(worst, fabs((double)a.rgba[4 * i + 3] - (double)b.rgba[4 * i + 3]));
  }
  CHECK_NEAR(worst, 0, 1e-6); /* ten roundings of a float */
  shading.ambient = -1;
  CHECK(chi_tet_render(NULL, lit, &s.frame) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_destroy(NULL, plain);
  chi_tet_destroy(NULL, lit);
  tet_mesh_free(mesh);
}

/* Other calls may run the stages of a frame that is drawn later. */
static void what_was_described_is_still_to_be_drawn(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_AXIS, 0, 32);
  chi_tet *tet, *fresh;
  chi_tet_image image, expected;
  chi_tet_plan plan = { .struct_size = sizeof plan };
  chi_tet_stats stats;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK && chi_tet_create(NULL, &fresh) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  s.camera = tet_view(TET_VIEW_OBLIQUE, 0, 32);
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  CHECK(chi_tet_render(NULL, fresh, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  chi_tet_get_image(tet, &image);
  chi_tet_get_image(fresh, &expected);
  CHECK(stats.reused == 0);
  CHECK(memcmp(image.rgba, expected.rgba, 32 * 32 * 4 * sizeof(float)) == 0);
  /* and what is told of the picture is not what was told of a plan */
  const int64_t drawn = stats.drawn, fragments = stats.fragments;
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.fragments == 0 && stats.drawn == (int64_t)plan.sequence_count);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.reused == 1 && stats.drawn == drawn && stats.fragments == fragments);
  CHECK(drawn > 0 && fragments > 0);
  chi_tet_destroy(NULL, tet);
  chi_tet_destroy(NULL, fresh);
  tet_mesh_free(mesh);
}

/* A plan says what it is of: other engines draw again only where that changes. */
static void a_plan_knows_when_its_picture_stands(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(2, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 33);
  chi_tet* tet;
  chi_tet_plan plan = { .struct_size = sizeof plan };
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK);
  CHECK(plan.width == 33 && plan.full_height == 33 && plan.reduction == 1);
  CHECK(plan.sequence_count > 0 && plan.sequence_count <= plan.count && !plan.depth);
  for (size_t i = 0; i < 3 * plan.point_count; ++i)
  {
    CHECK(fabs(plan.points[4 * (i / 3) + i % 3]) <= plan.point_limit * (1 + 1e-15));
  }
  const uint64_t first = plan.frame_version;
  CHECK(first != 0);
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK && plan.frame_version == first);
  s.params.blend = CHI_TET_BLEND_MAXIMUM;
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK && plan.frame_version > first);
  const uint64_t second = plan.frame_version;
  s.params.reduction = 2;
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK && plan.frame_version > second);
  CHECK(plan.width == 17 && plan.full_width == 33 && plan.reduction == 2);
  plan.struct_size = sizeof plan - 1; /* of a caller that would be written over */
  CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

/* A grid flattened by its matrix: centroids are in the wrong order somewhere, what is found
 * automatically nowhere. */
static void violations_are_those_of_the_order_asked_for(void)
{
  static const double flat[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 1 };
  tet_mesh* const mesh = tet_mesh_cubes(4, TET_RAMP);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 64);
  s.frame.grid_to_world = flat;
  chi_tet* tet;
  chi_tet_stats stats;
  int64_t count = -1;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  s.params.order = CHI_TET_ORDER_CENTROID;
  CHECK(chi_tet_count_violations(NULL, tet, &s.frame, &count) == CHI_OK && count > 0);
  s.params.order = CHI_TET_ORDER_AUTO;
  CHECK(chi_tet_count_violations(NULL, tet, &s.frame, &count) == CHI_OK && count == 0);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  chi_tet_get_stats(tet, &stats);
  CHECK(stats.order.used == CHI_TET_ORDER_TANGENTIAL && stats.order.lift == 1);
  CHECK(chi_tet_count_violations(NULL, tet, &s.frame, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_tet_count_violations(NULL, NULL, &s.frame, &count) == CHI_ERROR_INVALID_ARGUMENT);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

enum
{
  FINE = 8193, /* entries of a table whose steps are below 1/2048 */
  COARSE = 257
};

/* Blue to red, and an opacity that rises fourfold: linear, so that tables of any size hold it. */
static void fill_ramp(float (*rgb)[3], float* opacity, int count)
{
  for (int i = 0; i < count; ++i)
  {
    const float x = (float)i / (float)(count - 1);
    rgb[i][0] = x;
    rgb[i][1] = 0.5f;
    rgb[i][2] = 1 - x;
    opacity[i] = 0.25f + 0.75f * x;
  }
}

/* Of a table with small steps the nearest entry is taken: half a step of a colour, 1/16384 here,
 * and of an extinction, which moves an opacity by at most that share of tau e^-tau < 1/2. */
static void fine_tables_give_the_same_picture(void)
{
  static float rgb[2][FINE][3], opacity[2][FINE];
  tet_mesh* const mesh = tet_mesh_cubes(5, TET_MARSCHNER_LOBB);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 96);
  s.params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  float* const first = (float*)malloc(96 * 96 * 4 * sizeof(float));
  double worst = 0;
  for (int fine = 0; fine < 2; ++fine)
  {
    chi_tet* tet;
    CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
    fill_ramp(rgb[fine], opacity[fine], fine ? FINE : COARSE);
    s.transfer.view.rgb = rgb[fine][0];
    s.transfer.view.opacity = opacity[fine];
    s.transfer.view.count = fine ? FINE : COARSE;
    CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
    chi_tet_image image;
    chi_tet_get_image(tet, &image);
    for (int i = 0; i < 96 * 96 * 4; ++i)
    {
      const double error = fine ? fabs((double)image.rgba[i] - (double)first[i]) : 0;
      first[i] = fine ? first[i] : image.rgba[i];
      worst = error > worst ? error : worst;
    }
    chi_tet_destroy(NULL, tet);
  }
  CHECK_NEAR(worst, 0, 1.5 / 16384);
  free(first);
  tet_mesh_free(mesh);
}

/* A tile whose pixels all let less than 0.002 through ends: 0.002 of white is half of 1/255. */
static void opaque_tiles_end(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(16, TET_CONSTANT);
  scene s;
  make_scene(&s, mesh, TET_VIEW_INSIDE, 0, 64);
  tet_transfer_constant(&s.transfer, 1);
  s.transfer.view.unit_distance = 0.02; /* an optical depth of 50 a unit */
  chi_tet *tet, *whole;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK && chi_tet_create(NULL, &whole) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
  s.params.skip = CHI_TET_SKIP_EVERY_KIND & ~CHI_TET_SKIP_SATURATED;
  CHECK(chi_tet_render(NULL, whole, &s.frame) == CHI_OK);
  chi_tet_stats a, b;
  chi_tet_get_stats(tet, &a);
  chi_tet_get_stats(whole, &b);
  CHECK(a.skipped[5] > 1000 && b.skipped[5] == 0);
  CHECK(a.drawn + a.skipped[5] == b.drawn);
  chi_tet_image x, y;
  chi_tet_get_image(tet, &x);
  chi_tet_get_image(whole, &y);
  double worst = 0;
  for (int i = 0; i < 64 * 64 * 4; ++i)
  {
    worst = fmax(worst, fabs((double)x.rgba[i] - (double)y.rgba[i]));
  }
  CHECK_NEAR(worst, 0, 0.002);
  chi_tet_destroy(NULL, tet);
  chi_tet_destroy(NULL, whole);
  tet_mesh_free(mesh);
}

/* Those outside of the window and those between pixels' centres have no fragments: drawn all the
 * same, they change no bit. Half of the cube is out of sight, and 48 pixels are fewer than cells.
 */
static void what_has_no_pixel_is_skipped(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(24, TET_MARSCHNER_LOBB);
  static const struct
  {
    int32_t flag;
    int counter, view;
  } kinds[3] = { { CHI_TET_SKIP_OUTSIDE, 2, TET_VIEW_INSIDE },
    { CHI_TET_SKIP_OUTSIDE, 2, TET_VIEW_CLOSE }, { CHI_TET_SKIP_UNCOVERED, 6, TET_VIEW_OBLIQUE } };
  for (int k = 0; k < 3; ++k)
  {
    scene s;
    make_scene(&s, mesh, kinds[k].view, 0, 48);
    chi_tet *tet, *whole;
    CHECK(chi_tet_create(NULL, &tet) == CHI_OK && chi_tet_create(NULL, &whole) == CHI_OK);
    CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
    s.params.skip = CHI_TET_SKIP_EVERY_KIND & ~kinds[k].flag;
    CHECK(chi_tet_render(NULL, whole, &s.frame) == CHI_OK);
    chi_tet_stats a, b;
    chi_tet_get_stats(tet, &a);
    chi_tet_get_stats(whole, &b);
    CHECK(a.skipped[kinds[k].counter] > 1000 && b.skipped[kinds[k].counter] == 0);
    CHECK(a.skipped[2] == a.outside && a.skipped[6] == a.uncovered);
    CHECK(a.fragments <= b.fragments); /* the rest lies in the tile, beyond the picture */
    CHECK(b.drawn + b.skipped[5] == a.drawn + a.skipped[5] + a.skipped[kinds[k].counter]);
    chi_tet_image x, y;
    chi_tet_get_image(tet, &x);
    chi_tet_get_image(whole, &y);
    CHECK(memcmp(x.rgba, y.rgba, sizeof(float) * 4 * 48 * 48) == 0);
    chi_tet_destroy(NULL, tet);
    chi_tet_destroy(NULL, whole);
  }
  tet_mesh_free(mesh);
}

int main(void)
{
  what_has_no_pixel_is_skipped();
  cuts_hold_in_cells_around_the_eye();
  opaque_tiles_end();
  fine_tables_give_the_same_picture();
  violations_are_those_of_the_order_asked_for();
  what_was_described_is_still_to_be_drawn();
  a_plan_knows_when_its_picture_stands();
  a_ramp_is_lit_as_one();
  kept_fragments_give_the_same_picture();
  a_reduced_picture_is_the_picture_enlarged();
  a_homogeneous_cube_has_the_closed_form();
  an_unchanged_frame_stands();
  maximum_intensity_is_that_of_the_largest_scalar();
  one_points_at_the_cell_that_is_there();
  pointing_leaves_the_picture();
  return chi_test_report();
}
