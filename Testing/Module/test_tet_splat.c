/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Tetrahedra smaller than pixels: judged against 16 samples a pixel of the exact picture, and by
 * the optical depth of the whole window against the integral over the cells. Prints what it
 * measures. */
#include "chi_test.h"
#include "tet_frame.h"
#include "tet_reference.h"
#include "tet_tiny.h"

enum
{
  MOST_SIZE = 192,
  MOST_FLOATS = 4 * MOST_SIZE * MOST_SIZE,
  SAMPLES = 4 /* a side of a pixel */
};

/* A picture of its own, `times` as many pixels a side and their means; four floats a pixel. */
static void draw(const scene* s, int splatting, int times, float* rgba, chi_tet_stats* stats)
{
  chi_tet_params params = s->params;
  chi_camera camera = s->camera;
  chi_tet_frame frame = s->frame;
  params.subpixel_splatting = splatting;
  params.skip = CHI_TET_SKIP_EVERY_KIND & ~CHI_TET_SKIP_SATURATED;
  camera.width *= times;
  camera.height *= times;
  frame.params = &params;
  frame.camera = &camera;
  chi_tet* tet;
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  CHECK(chi_tet_render(NULL, tet, &frame) == CHI_OK);
  chi_tet_image image;
  chi_tet_get_image(tet, &image);
  const size_t width = (size_t)camera.width, columns = (size_t)s->camera.width;
  memset(rgba, 0, 4 * columns * columns * sizeof(float));
  for (size_t i = 0; image.rgba && i < 4 * width * width; ++i)
  {
    const size_t x = i / 4 % width / (size_t)times, y = i / 4 / width / (size_t)times;
    rgba[4 * (y * columns + x) + i % 4] += image.rgba[i] / (float)(times * times);
  }
  if (stats)
  {
    chi_tet_get_stats(tet, stats);
  }
  chi_tet_destroy(NULL, tet);
}

static size_t floats_of(const scene* s)
{
  return 4 * (size_t)s->camera.width * (size_t)s->camera.height;
}

/* Of 255. */
static double mean_difference(const scene* s, const float* a, const float* b)
{
  double sum = 0;
  for (size_t i = 0; i < floats_of(s); ++i)
  {
    sum += fabs((double)a[i] - (double)b[i]);
  }
  return 255 * sum / (double)floats_of(s);
}

/* The picture's optical depth, over its area. */
static double depth_of(const scene* s, const float* rgba)
{
  const double* const w = s->camera.window;
  double sum = 0;
  for (size_t i = 3; i < floats_of(s); i += 4)
  {
    sum -= log1p(-(double)rgba[i]);
  }
  return 4 * sum * (w[1] - w[0]) * (w[3] - w[2]) / (double)floats_of(s);
}

static float fine[MOST_FLOATS], plain[MOST_FLOATS], splatted[MOST_FLOATS];

/* Both criteria of issue 6: the mean error against 16 samples is no larger than without, of thin
 * and of opaque cells; the optical depth of a thin scene is kept to 1e-4, or, where all cells are
 * small, to 1e-5: what is left are depths that differ within a cell, in perspective. `worse` is the
 * share by which opaque cells may miss the first: of two large ones side by side in a pixel the
 * first hides the other, where rays would have seen both; measured 5e-4 of the error. */
static void judge(const char* name, const tet_mesh* mesh, int size, double limit, double worse)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene s;
    make_scene(&s, mesh, TET_VIEW_OBLIQUE, parallel, size);
    chi_tet_stats stats;
    double error[2][2];
    for (int opaque = 0; opaque < 2; ++opaque)
    {
      tet_transfer_signal(&s.transfer, opaque ? 20 : 1);
      draw(&s, 0, SAMPLES, fine, NULL);
      draw(&s, 0, 1, plain, NULL);
      draw(&s, 1, 1, splatted, &stats);
      error[opaque][0] = mean_difference(&s, plain, fine);
      error[opaque][1] = mean_difference(&s, splatted, fine);
      CHECK(error[opaque][0] > 0 && error[opaque][1] <= error[opaque][0] * (1 + worse * opaque));
    }
    CHECK(stats.splatted > 1000 && stats.uncovered == 0);
    tet_transfer_linear(&s.transfer, 1e-2);
    const double wanted = tet_tiny_depth(mesh, &s.camera, 1e-2);
    draw(&s, 1, 1, splatted, NULL);
    draw(&s, 0, 1, plain, NULL);
    const double with = depth_of(&s, splatted) / wanted - 1;
    printf("%s, %s: mean of 255 thin %.4f (%.4f without), opaque %.4f (%.4f), depth %.1e (%.1e)\n",
      name, parallel ? "parallel" : "perspective", error[0][1], error[0][0], error[1][1],
      error[1][0], with, depth_of(&s, plain) / wanted - 1);
    CHECK_NEAR(with, 0, limit);
  }
}

static void tiny_cells_keep_their_depth_and_look_as_16_samples(void)
{
  tet_mesh* mesh = tet_tiny_noise(24, 3);
  judge("cells of a pixel", mesh, 48, 1e-5, 0);
  tet_mesh_free(mesh);
  mesh = tet_tiny_dust(4000, 0.002, 0.02, 7);
  judge("dust", mesh, 48, 1e-5, 0);
  tet_mesh_free(mesh);
  mesh = tet_tiny_graded(16, 1000, 1);
  judge("edges 1000:1", mesh, MOST_SIZE, 1e-4, 1e-3);
  tet_mesh_free(mesh);
}

/* Of what is drawn otherwise: lights, an opacity of its own, given colours, cells' values. */
static void every_kind_of_scene_is_splatted(void)
{
  static const chi_shading_light light = { .kind = CHI_LIGHT_EYE, .diffuse = { 1, 1, 1 } };
  const chi_shading_view shading = { .struct_size = sizeof shading,
    .ambient = 0.3,
    .diffuse = 0.7,
    .lights = &light,
    .light_count = 1 };
  tet_mesh* const mesh = tet_tiny_noise(16, 5);
  float* const given = (float*)malloc(3 * mesh->count * sizeof(float));
  uint32_t seed = 9;
  for (size_t i = 0; i < 3 * mesh->count; ++i)
  {
    given[i] = (float)chi_test_random(&seed);
  }
  const chi_array_view opacity = { given, mesh->point_count, 1, sizeof(float), CHI_F32 };
  const chi_array_view colors = { given, mesh->point_count, 3, 3 * sizeof(float), CHI_F32 };
  const chi_array_view cells = { given, mesh->count, 1, sizeof(float), CHI_F32 };
  for (int kind = 0; kind < 4; ++kind)
  {
    scene s;
    make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 32);
    tet_transfer_signal(&s.transfer, 1);
    s.frame.shading = kind == 0 ? &shading : NULL;
    s.field.opacity = kind == 1 ? &opacity : NULL;
    s.field.colors = kind == 2 ? &colors : NULL;
    s.field.scalars = kind == 3 ? &cells : &s.scalars;
    s.field.is_cell_data = kind == 3;
    draw(&s, 0, SAMPLES, fine, NULL);
    draw(&s, 0, 1, plain, NULL);
    draw(&s, 1, 1, splatted, NULL);
    /* one sample of cells that do not depend on each other against 16: a quarter's deviation is
     * left of it, and the mean of all is off from the 16 by that */
    CHECK(mean_difference(&s, splatted, fine) < 0.5 * mean_difference(&s, plain, fine));
  }
  free(given);
  tet_mesh_free(mesh);
}

/* A plane and a surface cut small cells at the places that rays are taken at: the even cube's
 * picture is that of 16 samples, but at edges of the surface, where a pixel has one depth. */
static void cuts_go_through_small_cells(void)
{
  static const double plane[4] = { 1, 2, 3, 0.4 };
  static float depth[48 * 48], coarse[4 * 48 * 48];
  tet_mesh* const mesh = tet_mesh_cubes(24, TET_CONSTANT);
  for (int i = 0; i < 48 * 48; ++i)
  {
    depth[i] = i % 48 < 24 ? 6.5f : INFINITY;
  }
  const chi_surface_view surface = { .struct_size = sizeof surface, .depth = depth, .version = 1 };
  for (int kind = 0; kind < 2; ++kind)
  {
    scene s;
    chi_tet_stats stats;
    make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 48);
    tet_transfer_constant(&s.transfer, 0.3);
    s.frame.clip_planes = plane;
    s.frame.clip_plane_count = kind ? 0 : 1;
    s.frame.surface = kind ? &surface : NULL;
    draw(&s, 1, 1, splatted, &stats);
    CHECK(stats.splatted > 1000);
    draw(&s, 0, 1, coarse, NULL);
    double worst = 0, mean = 0;
    for (size_t i = 0; i < floats_of(&s); ++i)
    {
      const double error = fabs((double)splatted[i] - (double)coarse[i]);
      worst = fmax(worst, error);
      mean += error / (double)floats_of(&s);
    }
    /* lengths grow by 2 a unit at the cube's edges, a pixel is 1/13 wide: means over a pixel with
     * an edge differ from its centre by up to a quarter of that, e^-x 0.3 times so much: 0.012;
     * such pixels are fewer than a tenth */
    CHECK(worst < 0.012);
    CHECK(mean < 0.1 * 0.012);
  }
  tet_mesh_free(mesh);
}

/* Cells through the near plane are taken at pixels' centres, among small ones behind them. */
static void the_eye_may_be_among_them(void)
{
  tet_mesh* const mesh = tet_mesh_cubes(20, TET_CONSTANT);
  scene s;
  chi_tet_stats stats;
  make_scene(&s, mesh, TET_VIEW_INSIDE, 0, 16);
  draw(&s, 1, 1, splatted, &stats);
  CHECK(stats.splatted > 100);
  double mean = 0;
  for (int i = 0; i < 16 * 16; ++i)
  {
    const double length = tet_reference_cube_length(&s.camera, i % 16 + 0.5, i / 16 + 0.5);
    mean += fabs((double)splatted[4 * i + 3] + expm1(-0.3 * length)) / (16 * 16);
  }
  /* as above at the cube's edges, pixels being 1/10 wide where the cube ends */
  CHECK_NEAR(mean, 0, 2e-3);
  tet_mesh_free(mesh);
}

/* Where nothing is small, and where it has no effect, pictures have the same bits. */
static void without_small_cells_nothing_changes(void)
{
  for (int kind = 0; kind < 4; ++kind)
  {
    tet_mesh* const mesh = kind == 0 ? tet_mesh_cubes(2, TET_RAMP) : tet_tiny_noise(12, 3);
    scene s;
    make_scene(&s, mesh, TET_VIEW_CLOSE, 0, 24);
    tet_transfer_signal(&s.transfer, 1);
    s.params.blend = kind == 1 ? CHI_TET_BLEND_MAXIMUM : CHI_TET_BLEND_COMPOSITE;
    s.params.projection = kind == 2 ? CHI_TET_PROJECTION_PUBLISHED : CHI_TET_PROJECTION_EXACT;
    s.params.occlusion_strength = kind == 3 ? 0.5 : 0;
    chi_tet_stats stats;
    draw(&s, 0, 1, plain, NULL);
    draw(&s, 1, 1, splatted, &stats);
    CHECK(stats.splatted == 0 && plain[4 * (12 * 24 + 12) + 3] > 0);
    CHECK(memcmp(plain, splatted, floats_of(&s) * sizeof(float)) == 0);
    tet_mesh_free(mesh);
  }
}

/* The same handle, on and off in turn; cells are found by the exact picture; plans have no more in
 * their sequence. */
static void it_is_switched_on_and_off(void)
{
  tet_mesh* const mesh = tet_tiny_noise(12, 3);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 16);
  tet_transfer_signal(&s.transfer, 1);
  draw(&s, 0, 1, plain, NULL);
  draw(&s, 1, 1, splatted, NULL);
  CHECK(memcmp(plain, splatted, floats_of(&s) * sizeof(float)) != 0);
  chi_tet* tet;
  chi_tet_image image;
  chi_tet_plan plan = { .struct_size = sizeof plan };
  int64_t cells[2][16 * 16];
  float depths[16 * 16];
  size_t sequence[2];
  CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
  for (int turn = 0; turn < 4; ++turn)
  {
    s.params.subpixel_splatting = turn % 2;
    CHECK(chi_tet_render(NULL, tet, &s.frame) == CHI_OK);
    chi_tet_get_image(tet, &image);
    CHECK(memcmp(image.rgba, turn % 2 ? splatted : plain, floats_of(&s) * sizeof(float)) == 0);
    CHECK(chi_tet_find_cells(NULL, tet, &s.frame, 0.5, cells[turn % 2], depths) == CHI_OK);
    CHECK(chi_tet_describe(NULL, tet, &s.frame, &plan) == CHI_OK);
    sequence[turn % 2] = plan.sequence_count;
  }
  CHECK(memcmp(cells[0], cells[1], sizeof cells[0]) == 0);
  CHECK(sequence[0] == sequence[1]);
  chi_tet_destroy(NULL, tet);
  tet_mesh_free(mesh);
}

static void hosts_may_be_hostile(void)
{
  tet_mesh* const mesh = tet_tiny_noise(12, 3);
  scene s;
  make_scene(&s, mesh, TET_VIEW_OBLIQUE, 0, 72); /* four tiles */
  tet_transfer_signal(&s.transfer, 1);
  s.camera.window[0] *= 4;
  s.camera.window[1] *= 4;
  s.params.subpixel_splatting = 1;
  s.params.pre_integration = CHI_PREINTEGRATION_PARTIAL;
  const size_t bytes = floats_of(&s) * sizeof(float);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  chi_tet_image image;
  for (int other = 0; other < 2; ++other)
  {
    chi_tet* tet;
    CHECK(chi_tet_create(NULL, &tet) == CHI_OK);
    CHECK(chi_tet_render(other ? &backwards : NULL, tet, &s.frame) == CHI_OK);
    chi_tet_get_image(tet, &image);
    memcpy(other ? splatted : plain, image.rgba, bytes);
    chi_tet_destroy(NULL, tet);
  }
  CHECK(memcmp(plain, splatted, bytes) == 0);
  int refused = 0;
  for (long k = 0;; ++k)
  {
    chi_test_host host = { .refuse_at = k, .cancel_at = 1L << 40 };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release };
    chi_tet* tet = NULL;
    chi_status status = chi_tet_create(&exec, &tet);
    status = status == CHI_OK ? chi_tet_render(&exec, tet, &s.frame) : status;
    refused += status == CHI_ERROR_OUT_OF_MEMORY;
    host.refuse_at = -1;
    if (tet)
    {
      const long before = host.allocations;
      CHECK(chi_tet_render(&exec, tet, &s.frame) == CHI_OK);
      CHECK(status != CHI_OK || host.allocations == before); /* warm: nothing is allocated */
      chi_tet_get_image(tet, &image);
      CHECK(memcmp(plain, image.rgba, bytes) == 0);
    }
    chi_tet_destroy(&exec, tet);
    CHECK(host.live == 0);
    if (status == CHI_OK)
    {
      break;
    }
  }
  CHECK(refused > 15);
  tet_mesh_free(mesh);
}

int main(void)
{
  tiny_cells_keep_their_depth_and_look_as_16_samples();
  every_kind_of_scene_is_splatted();
  cuts_go_through_small_cells();
  the_eye_may_be_among_them();
  without_small_cells_nothing_changes();
  it_is_switched_on_and_off();
  hosts_may_be_hostile();
  return chi_test_report();
}
