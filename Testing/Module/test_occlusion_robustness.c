/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The occlusion engine with hostile hosts, odd sizes and bad input. */

#include "chi_test.h"
#include "occlusion_reference.h"

#include <chiaroscuro/chi_occlusion_plan.h>

enum
{
  WIDTH = 24
};

/* A small scene that goes through every stage: fog of one ball, a surface, a probe; while there are
 * any, translucent layers. */
typedef struct scene
{
  reference_volume volume;
  reference_frame* frame;
  float* depth; /* exact size: ASan sees overruns */
  float *layer_depth, *layer_rgba;
  chi_layers_view layers;
  double probe[3];
  float seen;
} scene;

static int scene_create(scene* s, const size_t n[3], int pixels)
{
  const double center[3] = { 0.5 * (double)(n[0] - 1), 0.5 * (double)(n[1] - 1),
    0.5 * (double)(n[2] - 1) };
  const double turn[2] = { 20, 10 };
  memset(s, 0, sizeof *s);
  s->frame = malloc(sizeof *s->frame);
  s->depth = malloc((size_t)(pixels * pixels) * sizeof *s->depth);
  const int ok = s->frame && s->depth && reference_volume_create(&s->volume, n);
  CHECK(ok);
  if (ok)
  {
    for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i)
    {
      s->volume.extinction[i] = 0.2f + 0.01f * (float)(i % 7);
    }
    const reference_view view = reference_turned_view(center, 40, turn, 16, pixels, 0);
    reference_frame_init(s->frame, &s->volume, &view, 1);
    for (int i = 0; i < pixels * pixels; ++i)
    {
      s->depth[i] = i % 3 ? 42.0f : INFINITY;
    }
    s->frame->surface = (chi_surface_view){
      .struct_size = sizeof s->frame->surface, .depth = s->depth, .version = 1
    };
    s->frame->frame.surface = &s->frame->surface;
    const double p[3] = { 0.5 * pixels, 0.5 * pixels, 41 };
    memcpy(s->probe, p, sizeof p);
    s->frame->probes = (chi_occlusion_probes){ s->probe, &s->seen, 1 };
    s->frame->frame.probes = &s->frame->probes;
  }
  return ok;
}

static void scene_destroy(scene* s)
{
  reference_volume_free(&s->volume);
  free(s->frame);
  free(s->depth);
}

/* Two layers, in the fog and behind it, and pixels that the surface covers in part. */
static void add_layers(scene* s, int pixels)
{
  const size_t count = (size_t)(pixels * pixels);
  s->layer_depth = malloc(2 * count * sizeof *s->layer_depth);
  s->layer_rgba = malloc(8 * count * sizeof *s->layer_rgba);
  CHECK(s->layer_depth && s->layer_rgba);
  for (size_t i = 0; s->layer_depth && s->layer_rgba && i < 2 * count; ++i)
  {
    s->layer_depth[i] = i < count ? 39.5f : 60;
    for (size_t c = 0; c < 4; ++c)
    {
      s->layer_rgba[4 * i + c] = c < 3 ? 0.2f : 0.4f;
    }
  }
  s->layers = (chi_layers_view){ .struct_size = sizeof s->layers,
    .depth = s->layer_depth,
    .rgba = s->layer_rgba,
    .version = 1,
    .count = 2 };
  s->frame->frame.layers = &s->layers;
  s->frame->surface.edge_depth = s->depth;
  s->frame->surface.edge_rgba = s->layer_rgba;
  s->frame->surface.end = s->layer_depth + count;
}

static void remove_layers(scene* s)
{
  s->frame->frame.layers = NULL;
  s->frame->surface.edge_depth = s->frame->surface.edge_rgba = s->frame->surface.end = NULL;
  free(s->layer_depth);
  free(s->layer_rgba);
}

static chi_exec exec_of(chi_test_host* host)
{
  return (chi_exec){ .struct_size = sizeof(chi_exec),
    .user = host,
    .alloc = chi_test_alloc,
    .release = chi_test_release,
    .is_cancelled = chi_test_is_cancelled };
}

static chi_status render_or_describe(
  const chi_exec* exec, chi_occlusion* engine, const chi_occlusion_frame* frame, int describes)
{
  chi_occlusion_plan plan;
  return describes ? chi_occlusion_describe(exec, engine, frame, &plan)
                   : chi_occlusion_render(exec, engine, frame);
}

/* The allocations of the first frame, all of which are refused in turn. */
static long refuse_each(scene* s, int describes)
{
  const chi_occlusion_frame* const frame = &s->frame->frame;
  chi_test_host count = { .refuse_at = -1, .cancel_at = 1L << 40 };
  chi_exec exec = exec_of(&count);
  chi_occlusion* engine = NULL;
  CHECK(chi_occlusion_create(&exec, &engine) == CHI_OK);
  CHECK(render_or_describe(&exec, engine, frame, describes) == CHI_OK);
  const long first_frame = count.allocations;
  ++s->frame->surface.version;
  CHECK(render_or_describe(&exec, engine, frame, describes) == CHI_OK);
  CHECK(count.allocations == first_frame); /* a later frame of the same size allocates nothing */
  chi_occlusion_destroy(&exec, engine);
  CHECK(count.live == 0);
  for (long k = 0; k < first_frame; ++k)
  {
    chi_test_host host = { .refuse_at = k, .cancel_at = 1L << 40 };
    exec = exec_of(&host);
    const chi_status made = chi_occlusion_create(&exec, &engine);
    CHECK(made == (k == 0 ? CHI_ERROR_OUT_OF_MEMORY : CHI_OK));
    if (made == CHI_OK)
    {
      CHECK(render_or_describe(&exec, engine, frame, describes) == CHI_ERROR_OUT_OF_MEMORY);
      chi_occlusion_image image;
      chi_occlusion_get_image(engine, &image);
      CHECK(image.rgba == NULL && image.width == 0);
      CHECK(render_or_describe(&exec, engine, frame, describes) == CHI_OK); /* still usable */
      chi_occlusion_destroy(&exec, engine);
    }
    CHECK(host.live == 0);
  }
  return first_frame;
}

static void each_refused_allocation_is_reported_and_nothing_leaks(void)
{
  const size_t n[3] = { 9, 8, 7 };
  scene s;
  if (!scene_create(&s, n, WIDTH))
  {
    scene_destroy(&s);
    return;
  }
  for (int describes = 0; describes < 2; ++describes)
  {
    s.frame->volume.scalars = s.volume.extinction;
    s.frame->volume.type = CHI_F32;
    s.frame->volume.stride = sizeof(float);
    const long in_place = refuse_each(&s, describes);
    double* const wide = malloc(504 * sizeof *wide); /* to be copied */
    for (size_t i = 0; wide && i < 504; ++i)
    {
      wide[i] = (double)s.volume.extinction[i];
    }
    s.frame->volume.scalars = wide;
    s.frame->volume.type = CHI_F64;
    s.frame->volume.stride = sizeof *wide;
    const long copied = refuse_each(&s, describes);
    CHECK(in_place > 5 && copied > in_place);
    add_layers(&s, WIDTH);
    CHECK(refuse_each(&s, describes) > copied);
    remove_layers(&s);
    free(wide);
  }
  scene_destroy(&s);
}

static void cancelling_at_any_poll_is_reported_and_nothing_leaks(void)
{
  const size_t n[3] = { 9, 8, 7 };
  scene s;
  if (scene_create(&s, n, WIDTH))
  {
    chi_test_host count = { .refuse_at = -1, .cancel_at = 1L << 40 };
    chi_exec exec = exec_of(&count);
    chi_occlusion* engine = NULL;
    CHECK(chi_occlusion_create(&exec, &engine) == CHI_OK);
    CHECK(chi_occlusion_render(&exec, engine, &s.frame->frame) == CHI_OK);
    chi_occlusion_image image;
    chi_occlusion_get_image(engine, &image);
    float* const expected = malloc(WIDTH * WIDTH * 4 * sizeof *expected);
    if (expected && image.rgba)
    {
      memcpy(expected, image.rgba, WIDTH * WIDTH * 4 * sizeof *expected);
    }
    chi_occlusion_destroy(&exec, engine);
    CHECK(count.polls > 20);
    for (long k = 0; expected && k < count.polls; ++k)
    {
      chi_test_host host = { .refuse_at = -1, .cancel_at = k };
      exec = exec_of(&host);
      CHECK(chi_occlusion_create(&exec, &engine) == CHI_OK);
      CHECK(chi_occlusion_render(&exec, engine, &s.frame->frame) == CHI_ERROR_CANCELLED);
      chi_occlusion_get_image(engine, &image);
      CHECK(image.rgba == NULL);
      host.cancel_at = 1L << 40; /* the handle stays usable, and nothing half done is kept */
      CHECK(chi_occlusion_render(&exec, engine, &s.frame->frame) == CHI_OK);
      chi_occlusion_get_image(engine, &image);
      CHECK(image.rgba && memcmp(image.rgba, expected, WIDTH * WIDTH * 4 * sizeof *expected) == 0);
      chi_occlusion_destroy(&exec, engine);
      CHECK(host.live == 0);
    }
    free(expected);
  }
  scene_destroy(&s);
}

/* Every cell that a non-finite voxel touches is transparent; the others are as before. */
static void non_finite_voxels_are_transparent_and_counted(void)
{
  const size_t n[3] = { 12, 12, 12 };
  const double center[3] = { 5.5, 5.5, 5.5 }, turn[2] = { 0, 0 };
  static const float bad[3] = { NAN, INFINITY, -INFINITY };
  scene s;
  if (scene_create(&s, n, 48))
  {
    const reference_view view = reference_turned_view(center, 40, turn, 12, 48, 1);
    chi_occlusion* engine = NULL;
    CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
    for (int nearest = 0; nearest < 2; ++nearest)
    {
      for (size_t i = 0; i < 12 * 12 * 12; ++i)
      {
        /* a column of bad voxels along z at x = 6, y = 5 */
        s.volume.extinction[i] = i % 12 == 6 && i / 12 % 12 == 5 ? bad[i % 3] : 0.1f;
      }
      reference_frame_init(s.frame, &s.volume, &view, 1);
      s.frame->volume.interpolation = nearest ? CHI_NEAREST : CHI_LINEAR;
      s.frame->volume.version = (uint64_t)nearest + 1;
      CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
      chi_occlusion_stats stats;
      chi_occlusion_get_stats(engine, &stats);
      CHECK(stats.non_finite_samples == 12);
      chi_occlusion_image image;
      chi_occlusion_get_image(engine, &image);
      for (int i = 0; image.rgba && i < 48 * 48; ++i)
      {
        const double x = (i % 48 + 0.5) / 4 - 0.5, y = (i / 48 + 0.5) / 4 - 0.5;
        const double reach = nearest ? 0.5 : 1;
        const int inside = x > 0 && x < 11 && y > 0 && y < 11;
        const int hit = fabs(x - 6) < reach && fabs(y - 5) < reach;
        CHECK_NEAR((double)image.rgba[4 * i + 3], inside && !hit ? -expm1(-1.1) : 0, 1e-4);
        CHECK(isfinite(image.rgba[4 * i]) && isfinite(image.visibility[i]));
      }
    }
    chi_occlusion_destroy(NULL, engine);
  }
  scene_destroy(&s);
}

static void all_voxels_bad_is_an_empty_picture(void)
{
  const size_t n[3] = { 5, 5, 5 };
  scene s;
  chi_occlusion* engine = NULL;
  if (scene_create(&s, n, WIDTH) && chi_occlusion_create(NULL, &engine) == CHI_OK)
  {
    for (int i = 0; i < 125; ++i)
    {
      s.volume.extinction[i] = NAN;
    }
    CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
    chi_occlusion_image image;
    chi_occlusion_get_image(engine, &image);
    for (int i = 0; image.rgba && i < 4 * WIDTH * WIDTH; ++i)
    {
      CHECK(image.rgba[i] == 0);
    }
    chi_occlusion_stats stats;
    chi_occlusion_get_stats(engine, &stats);
    CHECK(stats.non_finite_samples == 125 && stats.occupied_bricks == 0);
  }
  chi_occlusion_destroy(NULL, engine);
  scene_destroy(&s);
}

/* Sizes at which loops have nothing, or one thing, to do: a picture, finite, in [0, 1]. */
static void odd_sizes_give_finite_pictures(void)
{
  static const size_t sizes[8][3] = { { 1, 1, 1 }, { 2, 1, 1 }, { 1, 2, 1 }, { 1, 1, 2 },
    { 2, 2, 2 }, { 1, 40, 3 }, { 33, 1, 9 }, { 9, 10, 1 } };
  static const int windows[4] = { 1, 2, 3, 65 };
  for (int k = 0; k < 8 * 4 * 8; ++k)
  {
    scene s;
    chi_occlusion* engine = NULL;
    if (scene_create(&s, sizes[k % 8], windows[k / 8 % 4]) &&
      chi_occlusion_create(NULL, &engine) == CHI_OK)
    {
      const int mode = k / 32;
      s.frame->volume.is_cell_data = mode & 1;
      s.frame->params.half_size = mode >> 1 & 1;
      s.frame->volume.interpolation = mode >> 2 & 1;
      CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
      chi_occlusion_image image;
      chi_occlusion_get_image(engine, &image);
      const int pixels = windows[k / 8 % 4] * windows[k / 8 % 4];
      CHECK(image.rgba != NULL);
      double alpha = 0;
      int good = image.rgba != NULL;
      for (int i = 0; image.rgba && i < 4 * pixels; ++i)
      {
        good &= image.rgba[i] >= 0 && image.rgba[i] <= 1 && image.visibility[i / 4] >= 0 &&
          image.visibility[i / 4] <= 1.0001f;
        alpha += (double)image.rgba[i];
      }
      CHECK(good);
      CHECK(s.seen >= 0 && s.seen <= 1.0001f);
      if (mode & 1) /* cells have an extent even where samples do not */
      {
        CHECK(alpha > 0 || windows[k / 8 % 4] < 4);
      }
    }
    chi_occlusion_destroy(NULL, engine);
    scene_destroy(&s);
  }
}

/* The frame is refused, and the last picture stands. */
static void check_refused(
  chi_occlusion* engine, const chi_occlusion_frame* frame, chi_status status)
{
  CHECK(chi_occlusion_render(NULL, engine, frame) == status);
  chi_occlusion_image image;
  chi_occlusion_get_image(engine, &image);
  CHECK(image.rgba != NULL && image.width == WIDTH);
}

static void bad_frames_are_refused_and_the_last_picture_stands(void)
{
  const size_t n[3] = { 4, 4, 4 };
  scene s;
  chi_occlusion* engine = NULL;
  if (scene_create(&s, n, WIDTH) && chi_occlusion_create(NULL, &engine) == CHI_OK)
  {
    reference_frame* const f = s.frame;
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_OK);
    const chi_camera camera = f->camera;
    const chi_volume_view volume = f->volume;
    const chi_transfer_view transfer = f->transfer;
    const chi_occlusion_params params = f->params;
    const chi_occlusion_frame frame = f->frame;
#define REFUSED(change)                                                                            \
  do                                                                                               \
  {                                                                                                \
    change;                                                                                        \
    check_refused(engine, &f->frame, CHI_ERROR_INVALID_ARGUMENT);                                  \
    f->camera = camera;                                                                            \
    f->volume = volume;                                                                            \
    f->transfer = transfer;                                                                        \
    f->params = params;                                                                            \
    f->frame = frame;                                                                              \
  } while (0)
    static const double bad[3] = { NAN, INFINITY, -INFINITY };
    for (int i = 0; i < 3; ++i)
    {
      for (int k = 0; k < 12; ++k)
      {
        REFUSED(f->volume.index_to_world[k] = bad[i]);
        REFUSED(f->camera.world_to_eye[k] = bad[i]);
        REFUSED(f->camera.window[k % 4] = bad[i]);
      }
      REFUSED(f->transfer.range[1] = bad[i]);
      REFUSED(f->transfer.unit_distance = bad[i]);
      REFUSED(f->params.strength = bad[i]);
      REFUSED(f->params.bias = bad[i]);
      REFUSED(f->params.sample_distance = bad[i]);
      REFUSED(f->params.cone_angle_rad = bad[i]);
    }
    for (int k = 0; k < 3; ++k) /* singular: a column, a row, all of the linear part */
    {
      REFUSED(for (int a = 0; a < 3; ++a) f->volume.index_to_world[4 * a + k] = 0);
      REFUSED(for (int a = 0; a < 3; ++a) f->volume.index_to_world[4 * k + a] = 0);
      REFUSED(for (int a = 0; a < 3; ++a) f->volume.index_to_world[4 * a] =
                f->volume.index_to_world[4 * a + 1]);
    }
    REFUSED(f->camera.window[0] = f->camera.window[1]);
    REFUSED(f->camera.width = 0);
    REFUSED(f->camera.height = -1);
    REFUSED(f->camera.near_depth = 0);
    REFUSED(f->params.method = 2);
    REFUSED(f->params.directions = 0);
    REFUSED(f->params.directions = 65);
    REFUSED(f->params.strength = 1.5);
    REFUSED(f->params.sample_distance = -1);
    REFUSED(f->params.geometry_thickness = -1);
    REFUSED(f->params.geometry_thickness = NAN);
    REFUSED(f->params.cone_angle_rad = 0);
    REFUSED(f->params.cone_angle_rad = 1.6);
    REFUSED(f->volume.scalars = NULL);
    REFUSED(f->volume.type = 11);
    REFUSED(f->volume.type = 0);
    REFUSED(f->volume.stride = 3);
    REFUSED(f->volume.dimensions[1] = 0);
    REFUSED(f->volume.interpolation = 2);
    REFUSED(f->transfer.rgb = NULL);
    REFUSED(f->transfer.opacity = NULL);
    REFUSED(f->transfer.count = 1);
    REFUSED(f->transfer.count = 65537);
    REFUSED(f->transfer.range[1] = f->transfer.range[0]);
    REFUSED(f->transfer.unit_distance = 0);
    REFUSED(f->frame.camera = NULL);
    REFUSED(f->frame.params = NULL);
    REFUSED(f->frame.transfer = NULL);
#undef REFUSED
    f->params.sample_distance = 1e-9; /* 1e10 slices */
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_ERROR_TOO_LARGE);
    f->params = params;
    f->volume.dimensions[0] = SIZE_MAX / 2;
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_ERROR_TOO_LARGE);
    CHECK(chi_occlusion_render(NULL, engine, NULL) == CHI_ERROR_INVALID_ARGUMENT);
    CHECK(chi_occlusion_render(NULL, NULL, &frame) == CHI_ERROR_INVALID_ARGUMENT);
  }
  CHECK(chi_occlusion_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  chi_occlusion_destroy(NULL, engine);
  chi_occlusion_destroy(NULL, NULL);
  scene_destroy(&s);
}

static void nothing_to_draw_is_an_empty_picture(void)
{
  const size_t n[3] = { 4, 4, 4 };
  scene s;
  chi_occlusion* engine = NULL;
  if (scene_create(&s, n, WIDTH) && chi_occlusion_create(NULL, &engine) == CHI_OK)
  {
    chi_occlusion_image image;
    chi_occlusion_get_image(engine, &image);
    CHECK(image.rgba == NULL && image.visibility == NULL && image.width == 0);
    for (int k = 0; k < 4; ++k)
    {
      s.seen = -1;
      s.frame->frame.volume = k & 1 ? &s.frame->volume : NULL;
      s.frame->frame.surface = k & 2 ? &s.frame->surface : NULL;
      memset(s.frame->opacity, 0, sizeof s.frame->opacity);
      for (int i = 0; i < WIDTH * WIDTH; ++i)
      {
        s.depth[i] = i % 2 ? NAN : -1.0f; /* no surface anywhere */
      }
      ++s.frame->transfer.version;
      ++s.frame->surface.version;
      CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
      chi_occlusion_get_image(engine, &image);
      CHECK(image.width == WIDTH && image.height == WIDTH);
      for (int i = 0; image.rgba && i < WIDTH * WIDTH; ++i)
      {
        CHECK(image.rgba[4 * i] == 0 && image.rgba[4 * i + 3] == 0 && image.visibility[i] == 1);
      }
      CHECK_NEAR((double)s.seen, 1, 1e-6);
    }
    /* A volume beside the window, or behind the eye. */
    s.frame->frame.volume = &s.frame->volume;
    s.frame->frame.surface = NULL;
    s.frame->frame.probes = NULL;
    for (int i = 0; i < REFERENCE_ENTRIES; ++i)
    {
      s.frame->opacity[i] = 0.5f;
    }
    ++s.frame->transfer.version;
    for (int k = 0; k < 2; ++k)
    {
      s.frame->camera.world_to_eye[k ? 11 : 3] += 200;
      CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
      chi_occlusion_get_image(engine, &image);
      double sum = image.rgba ? 0 : 1;
      for (int i = 0; image.rgba && i < 4 * WIDTH * WIDTH; ++i)
      {
        sum += fabs((double)image.rgba[i]);
      }
      CHECK(sum == 0);
      s.frame->camera.world_to_eye[k ? 11 : 3] -= 200;
    }
  }
  chi_occlusion_destroy(NULL, engine);
  scene_destroy(&s);
}

/* A window much larger after a small one, and the other way round: buffers grow and are kept. */
static void a_handle_draws_pictures_of_any_order_of_sizes(void)
{
  static const int sizes[6] = { 5, 130, 1, 64, 131, 7 };
  const size_t n[3] = { 9, 9, 9 };
  chi_occlusion* engine = NULL;
  CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
  for (int k = 0; engine && k < 6; ++k)
  {
    scene s;
    chi_occlusion* fresh = NULL;
    if (scene_create(&s, n, sizes[k]) && chi_occlusion_create(NULL, &fresh) == CHI_OK)
    {
      chi_occlusion_image a, b;
      s.frame->volume.version = (uint64_t)k + 10;
      s.frame->transfer.version = (uint64_t)k + 10;
      CHECK(chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
      CHECK(chi_occlusion_render(NULL, fresh, &s.frame->frame) == CHI_OK);
      chi_occlusion_get_image(engine, &a);
      chi_occlusion_get_image(fresh, &b);
      const size_t count = (size_t)(sizes[k] * sizes[k]);
      CHECK(a.rgba && b.rgba && memcmp(a.rgba, b.rgba, 4 * count * sizeof(float)) == 0);
      CHECK(a.rgba && b.rgba && memcmp(a.visibility, b.visibility, count * sizeof(float)) == 0);
    }
    chi_occlusion_destroy(NULL, fresh);
    scene_destroy(&s);
  }
  chi_occlusion_destroy(NULL, engine);
}

/* A bias that leaves the scene lets all light arrive, however far it goes. */
static void no_bias_is_too_large(void)
{
  const size_t n[3] = { 9, 9, 9 };
  static float lit[4 * WIDTH * WIDTH];
  scene s;
  for (int k = 0; k < 4 && scene_create(&s, n, WIDTH); ++k)
  {
    chi_occlusion* engine = NULL; /* with buffers of its own: those of another bias are larger */
    chi_occlusion_image image = { 0 };
    s.frame->params.bias = (const double[]){ 1e3, 1e18, 1e20, 1e308 }[k];
    CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
    CHECK(engine && chi_occlusion_render(NULL, engine, &s.frame->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    CHECK(image.rgba && (k == 0 || memcmp(lit, image.rgba, sizeof lit) == 0));
    memmove(lit, image.rgba ? image.rgba : lit, sizeof lit);
    chi_occlusion_destroy(NULL, engine);
    scene_destroy(&s);
  }
}

int main(void)
{
  each_refused_allocation_is_reported_and_nothing_leaks();
  cancelling_at_any_poll_is_reported_and_nothing_leaks();
  non_finite_voxels_are_transparent_and_counted();
  all_voxels_bad_is_an_empty_picture();
  odd_sizes_give_finite_pictures();
  bad_frames_are_refused_and_the_last_picture_stands();
  nothing_to_draw_is_an_empty_picture();
  a_handle_draws_pictures_of_any_order_of_sizes();
  no_bias_is_too_large();
  return chi_test_report();
}
