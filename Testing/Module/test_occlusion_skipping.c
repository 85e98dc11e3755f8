/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Skipping: each kind alone changes no pixel, spares what its counter says, and can be turned off.
 */

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  N = 56,
  WIDTH = 96,
  PIXELS = WIDTH * WIDTH,
  ENTRIES = 256
};

typedef struct scene
{
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_occlusion_params params;
  chi_occlusion_frame frame;
  float rgb[3 * ENTRIES], opacity[ENTRIES], depth[PIXELS];
  uint8_t samples[N * N * N];
  double planes[8];
} scene;

/* A ball of 255 in the middle that falls off to 0 well before the border; seen along z, the eye at
 * depth 0, the middle at depth 100. */
static scene* make_scene(int parallel)
{
  scene* const s = calloc(1, sizeof *s);
  if (!s)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, WIDTH, WIDTH, parallel ? 40 : 0.4);
  const double middle = 0.5 * (N - 1);
  for (int i = 0; i < N * N * N; ++i)
  {
    const double x = i % N - middle, y = i / N % N - middle, z = (double)(i / (N * N)) - middle;
    const double r = sqrt(x * x + y * y + z * z) + 2 * sin(0.5 * x) * sin(0.4 * y + 0.3 * z);
    s->samples[i] = (uint8_t)fmin(fmax(255 * (24 - r) / 18, 0), 255);
  }
  s->volume = cube_at(s->samples, CHI_U8, N, 100);
  s->transfer = tables(s->rgb, s->opacity, ENTRIES, 0, 255);
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = i % WIDTH < WIDTH / 2 ? (float)(98 + 0.1 * (i % WIDTH)) : INFINITY;
  }
  s->surface = surface_of(s->depth);
  chi_occlusion_default_params(&s->params);
  const double planes[8] = { 0.3, 0.1, -1, -85, 0, 1, 0, 15 }; /* z <= -85 about, y >= -15 */
  memcpy(s->planes, planes, sizeof planes);
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .volume = &s->volume,
    .transfer = &s->transfer,
    .surface = &s->surface,
    .params = &s->params,
    .clip_planes = s->planes,
    .clip_plane_count = 2 };
  return s;
}

/* The transfer functions of the benchmark: dense everywhere, a skin, and the few densest voxels. */
enum
{
  DENSE,
  SKIN,
  SPARSE,
  FUNCTIONS
};

static void set_function(scene* s, int kind)
{
  ++s->transfer.version;
  for (int i = 0; i < ENTRIES; ++i)
  {
    const double x = i / 255.0;
    const double opacity = kind == DENSE ? 0.25 * x
      : kind == SKIN                     ? 0.8 * fmax(0, 1 - fabs(x - 0.3) / 0.08)
                                         : (x > 0.9 ? 5 * (x - 0.9) : 0);
    s->opacity[i] = (float)opacity;
    s->rgb[3 * i] = (float)x;
    s->rgb[3 * i + 1] = 0.6f;
    s->rgb[3 * i + 2] = (float)(1 - x);
  }
}

static chi_occlusion_image render(chi_occlusion* engine, const scene* s, chi_occlusion_stats* stats)
{
  chi_occlusion_image image;
  CHECK(chi_occlusion_render(NULL, engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(engine, &image);
  stats->struct_size = sizeof *stats;
  chi_occlusion_get_stats(engine, stats);
  if (!image.rgba || image.width != s->camera.width || image.height != s->camera.height)
  {
    CHECK(!"an image");
    exit(1);
  }
  return image;
}

static chi_occlusion* make_engine(void)
{
  chi_occlusion* engine = NULL;
  if (chi_occlusion_create(NULL, &engine) != CHI_OK)
  {
    exit(1);
  }
  return engine;
}

/* All kinds against all but one; also without occlusion, where no light needs the samples of rays
 * that are done. */
static void each_kind_alone_changes_no_pixel_and_counts_what_it_spares(int parallel)
{
  static const char* const names[] = { "", "bricks", "saturated rays", "behind geometry", "clipped",
    "footprint", "saturated light", "unreached light" };
  scene* const s = make_scene(parallel);
  chi_occlusion* const with = make_engine();
  chi_occlusion* const without = make_engine();
  for (int kind = 1; kind <= 7; ++kind)
  {
    int64_t spared = 0, more = 0;
    for (int k = 0; k < 2 * FUNCTIONS; ++k)
    {
      const int function = k / 2;
      s->params.strength = k % 2;
      set_function(s, function);
      chi_occlusion_stats all, less;
      s->params.skip = CHI_SKIP_EVERY_KIND;
      const chi_occlusion_image a = render(with, s, &all);
      s->params.skip = CHI_SKIP_EVERY_KIND & ~(1 << kind);
      const chi_occlusion_image b = render(without, s, &less);
      const double worst = difference(&a, &b);
      CHECK(worst <= 1.0 / 255); /* the bound */
      CHECK(less.skipped[kind] == 0);
      CHECK(less.samples >= all.samples && less.light_updates >= all.light_updates);
      spared += all.skipped[kind];
      more += less.samples - all.samples + less.light_updates - all.light_updates +
        (kind == 4 || kind == 5); /* cells outside hold no sample inside */
      printf("%-16s function %d, strength %d: spares %lld, picture differs by %.3f/255\n",
        names[kind], function, k % 2, (long long)all.skipped[kind], 255 * worst);
    }
    CHECK(spared > 0 && more > 0);
  }
  chi_occlusion_destroy(NULL, with);
  chi_occlusion_destroy(NULL, without);
  free(s);
}

/*
 * A wall in front of a picture's first piece of 32 light pixels, narrow light, something that
 * receives it behind the rest, and no matter between. What is computed from a piece with a shadow
 * is never 1 exactly, and would make the next piece so: all five of them after five slabs. The
 * shadow itself stays in the second one, next to which the third one is computed.
 */
static void light_beside_a_shadow_is_whole_where_only_a_tail_of_it_is_missing(void)
{
  scene* const s = make_scene(1);
  const int width = 5 * 32, height = 48;
  s->camera = eye_at_origin(1, width, height, 20);
  memset(s->opacity, 0, sizeof s->opacity);
  for (int i = 0; i < width * height; ++i)
  {
    s->depth[i] = i % width < 32 ? 72 : 130;
  }
  s->frame.clip_plane_count = 0;
  s->params.half_size = 0;
  s->params.cone_angle_rad = 0.05;
  chi_occlusion* const with = make_engine();
  chi_occlusion* const without = make_engine();
  chi_occlusion_stats some, none;
  s->params.skip = CHI_SKIP_SATURATED_LIGHT;
  const chi_occlusion_image a = render(with, s, &some);
  s->params.skip = CHI_SKIP_NOTHING;
  const chi_occlusion_image b = render(without, s, &none);
  const double share = (double)some.light_updates / (double)none.light_updates;
  const double worst = difference(&a, &b), dark = 1 - (double)b.visibility[32];
  printf("beside a shadow of %.2f: %.3f of the updates, visibility differs by %.2e\n", dark, share,
    worst);
  CHECK(dark > 0.1);
  CHECK(share > 0.5 && share <= 0.6);
  CHECK(worst <= 0x1p-20 * s->params.directions * (double)some.light_slices); /* a slab each */
  chi_occlusion_destroy(NULL, with);
  chi_occlusion_destroy(NULL, without);
  free(s);
}

static void one_stands_for_all_and_nothing_for_none(void)
{
  scene* const s = make_scene(1);
  set_function(s, SKIN);
  chi_occlusion* const a = make_engine();
  chi_occlusion* const b = make_engine();
  chi_occlusion_stats one, every, none;
  s->params.skip = CHI_SKIP_ALL;
  const chi_occlusion_image first = render(a, s, &one);
  s->params.skip = CHI_SKIP_EVERY_KIND;
  const chi_occlusion_image second = render(b, s, &every);
  CHECK(difference(&first, &second) == 0);
  CHECK(one.samples == every.samples && one.light_updates == every.light_updates);
  CHECK(memcmp(one.skipped, every.skipped, sizeof one.skipped) == 0);
  CHECK(one.skipped_samples == one.skipped[1] + one.skipped[2] + one.skipped[3]);
  CHECK(one.skipped_light_updates == one.skipped[6] + one.skipped[7]);
  s->params.skip = CHI_SKIP_NOTHING;
  render(a, s, &none);
  render(a, s, &none); /* not even the same frame again */
  CHECK(none.reused == 0 && none.reused_bricks == 0 && none.reused_classification == 0);
  for (int k = 0; k < CHI_SKIP_KINDS; ++k)
  {
    CHECK(none.skipped[k] == 0);
  }
  CHECK(none.samples > one.samples && none.light_updates > one.light_updates);
  chi_occlusion_destroy(NULL, a);
  chi_occlusion_destroy(NULL, b);
  free(s);
}

/* What a new frame makes anew: 1 bricks, 2 classification, 4 picture. */
static int made_anew(chi_occlusion* engine, const scene* s)
{
  chi_occlusion_stats stats;
  render(engine, s, &stats);
  CHECK(stats.skipped[8] == stats.reused_bricks + stats.reused_classification + stats.reused);
  return !stats.reused_bricks + 2 * !stats.reused_classification + 4 * !stats.reused;
}

static void a_frame_makes_anew_only_what_changed(void)
{
  scene* const s = make_scene(0);
  set_function(s, SKIN);
  chi_occlusion* const engine = make_engine();
  CHECK(made_anew(engine, s) == 7);
  CHECK(made_anew(engine, s) == 0);
  s->camera.world_to_eye[3] = 1; /* the camera */
  CHECK(made_anew(engine, s) == 4);
  set_function(s, SPARSE); /* the transfer function */
  CHECK(made_anew(engine, s) == 6);
  s->depth[3] = 90; /* the geometry */
  ++s->surface.version;
  CHECK(made_anew(engine, s) == 4);
  s->camera.height = WIDTH; /* the same value is no change */
  CHECK(made_anew(engine, s) == 0);
  s->camera.window[0] *= 1.1; /* the window */
  CHECK(made_anew(engine, s) == 4);
  ++s->samples[5]; /* the data */
  ++s->volume.version;
  CHECK(made_anew(engine, s) == 7);
  s->params.skip = CHI_SKIP_EVERY_KIND & ~CHI_SKIP_UNCHANGED;
  CHECK(made_anew(engine, s) == 7);
  CHECK(made_anew(engine, s) == 7);
  chi_occlusion_destroy(NULL, engine);
  free(s);
}

/* No light buffer, no update, and fewer allocations of memory than with it. */
static void occlusion_off_costs_nothing_over_the_plain_render(void)
{
  for (int how = 0; how < 2; ++how)
  {
    scene* const s = make_scene(1);
    set_function(s, DENSE);
    if (how)
    {
      s->params.interactions = 0;
    }
    else
    {
      s->params.strength = 0;
    }
    chi_occlusion* const off = make_engine();
    chi_occlusion_stats plain, shaded;
    const chi_occlusion_image a = render(off, s, &plain);
    CHECK(plain.light_updates == 0 && plain.skipped_light_updates == 0 && plain.light_bytes == 0);
    s->params.strength = 1;
    s->params.interactions = CHI_ALL_INTERACTIONS;
    chi_occlusion* const on = make_engine();
    const chi_occlusion_image b = render(on, s, &shaded);
    CHECK(shaded.light_updates > 0 && shaded.light_bytes > 4 * 16 * (WIDTH / 2) * (WIDTH / 2));
    CHECK(plain.samples <= shaded.samples && difference(&a, &b) > 0.1);
    chi_occlusion_destroy(NULL, off);
    chi_occlusion_destroy(NULL, on);
    free(s);
  }
}

int main(void)
{
  each_kind_alone_changes_no_pixel_and_counts_what_it_spares(0);
  each_kind_alone_changes_no_pixel_and_counts_what_it_spares(1);
  light_beside_a_shadow_is_whole_where_only_a_tail_of_it_is_missing();
  one_stands_for_all_and_nothing_for_none();
  a_frame_makes_anew_only_what_changed();
  occlusion_off_costs_nothing_over_the_plain_render();
  return chi_test_report();
}
