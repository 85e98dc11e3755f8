/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#define _POSIX_C_SOURCE 200809L /* setenv */

/* What must not change the occlusion engine's picture: how the same scene is put to it. */

#include "chi_test.h"
#include "occlusion_reference.h"

#include <pthread.h>
#include <stdatomic.h>

enum
{
  SIZE = 24, /* voxels along each axis */
  VOXELS = SIZE * SIZE * SIZE,
  WIDTH = 64,
  PIXELS = WIDTH * WIDTH
};

/* Two balls of small integers in 24^3, a tilted surface behind them, seen from the side. */
typedef struct scene
{
  reference_volume volume;
  reference_frame* frame;
  chi_occlusion* engine;
  float* depth;
  float* kept; /* [PIXELS][5] a picture to compare with */
} scene;

static int scene_create(scene* s, int parallel)
{
  const size_t n[3] = { SIZE, SIZE, SIZE };
  const double center[3] = { 11.5, 11.5, 11.5 }, turn[2] = { 30, 20 };
  memset(s, 0, sizeof *s);
  s->frame = malloc(sizeof *s->frame);
  s->depth = malloc(PIXELS * sizeof *s->depth);
  s->kept = malloc(5 * PIXELS * sizeof *s->kept);
  const int ok = s->frame && s->depth && s->kept && reference_volume_create(&s->volume, n) &&
    chi_occlusion_create(NULL, &s->engine) == CHI_OK;
  CHECK(ok);
  for (size_t i = 0; ok && i < VOXELS; ++i)
  {
    const double x = (double)(i % SIZE), y = (double)(i / SIZE % SIZE), z = (double)(i / 576);
    const double a = 6 - sqrt((x - 8) * (x - 8) + (y - 9) * (y - 9) + (z - 8) * (z - 8));
    const double b = 7 - sqrt((x - 15) * (x - 15) + (y - 14) * (y - 14) + (z - 16) * (z - 16));
    s->volume.extinction[i] = (float)floor(20 * fmax(0, fmin(5, fmax(a, b))));
  }
  if (ok)
  {
    const reference_view view = reference_turned_view(center, 60, turn, 40, WIDTH, parallel);
    reference_frame_init(s->frame, &s->volume, &view, 100);
    s->frame->transfer.unit_distance = 1.5;
    for (int i = 0; i < REFERENCE_ENTRIES; ++i)
    {
      s->frame->rgb[3 * i] = (float)i / (REFERENCE_ENTRIES - 1);
      s->frame->rgb[3 * i + 1] = 0.5f;
    }
    for (int i = 0; i < PIXELS; ++i)
    {
      s->depth[i] = i % WIDTH < 40 ? (float)(58 + 0.3 * (i % WIDTH)) : INFINITY;
    }
    s->frame->params.bias = -1;
    s->frame->surface = (chi_surface_view){
      .struct_size = sizeof s->frame->surface, .depth = s->depth, .version = 1
    };
    s->frame->frame.surface = &s->frame->surface;
  }
  return ok;
}

static void scene_destroy(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  reference_volume_free(&s->volume);
  free(s->frame);
  free(s->depth);
  free(s->kept);
}

/* Renders into out, [PIXELS][5]: RGBA and visibility. */
static int render(const chi_exec* exec, chi_occlusion* engine, const reference_frame* f, float* out)
{
  chi_occlusion_image image;
  const chi_status status = chi_occlusion_render(exec, engine, &f->frame);
  chi_occlusion_get_image(engine, &image);
  CHECK(status == CHI_OK && image.width == WIDTH && image.height == WIDTH);
  if (status != CHI_OK || !image.rgba || !image.visibility)
  {
    return 0;
  }
  for (int i = 0; i < PIXELS; ++i)
  {
    memcpy(out + 5 * i, image.rgba + 4 * i, 4 * sizeof *out);
    out[5 * i + 4] = image.visibility[i];
  }
  return 1;
}

/* Largest difference from the kept picture, in units of full scale; `mean` is the mean. */
static double difference(scene* s, const reference_frame* f, double* mean)
{
  float* const now = malloc(5 * PIXELS * sizeof *now);
  double worst = INFINITY;
  if (now && render(NULL, s->engine, f, now))
  {
    worst = 0;
    *mean = 0;
    for (int i = 0; i < 5 * PIXELS; ++i)
    {
      const double d = fabs((double)now[i] - (double)s->kept[i]);
      worst = fmax(worst, d);
      *mean += d / (5 * PIXELS);
    }
  }
  free(now);
  return worst;
}

static int keep(scene* s)
{
  const int ok = render(NULL, s->engine, s->frame, s->kept);
  double covered = 0, shaded = 0;
  for (int i = 0; ok && i < PIXELS; ++i)
  {
    covered += (double)s->kept[5 * i + 3] > 0.5;
    shaded += (double)s->kept[5 * i + 4] < 0.9;
  }
  CHECK(covered > 200 && shaded > 50); /* there is something to compare */
  return ok;
}

#define STORE(code, ctype)                                                                         \
  case code:                                                                                       \
  {                                                                                                \
    const ctype x = (ctype)value;                                                                  \
    memcpy(at, &x, sizeof x);                                                                      \
    break;                                                                                         \
  }
static void store(chi_type type, void* at, float value)
{
  switch (type)
  {
    STORE(CHI_F32, float)
    STORE(CHI_F64, double)
    STORE(CHI_I8, int8_t)
    STORE(CHI_U8, uint8_t)
    STORE(CHI_I16, int16_t)
    STORE(CHI_U16, uint16_t)
    STORE(CHI_I32, int32_t)
    STORE(CHI_U32, uint32_t)
    STORE(CHI_I64, int64_t)
    STORE(CHI_U64, uint64_t)
    default:
      break;
  }
}

/* Blocks of exact size: under ASan a read beyond the last sample is seen. Table positions are
 * floats, of 4096 entries: 2^-24 x 4096 of an entry. */
static void every_type_and_stride_gives_the_same_picture(void)
{
  scene s;
  if (scene_create(&s, 0) && keep(&s))
  {
    for (chi_type type = CHI_F32; type <= CHI_U64; ++type)
    {
      for (int padded = 0; padded < 2; ++padded)
      {
        const size_t size = chi_type_size(type), stride = padded ? size + 3 : size;
        char* const data = malloc((VOXELS - 1) * stride + size);
        for (size_t i = 0; data && i < VOXELS; ++i)
        {
          store(type, data + i * stride, s.volume.extinction[i]);
        }
        s.frame->volume.scalars = data;
        s.frame->volume.type = type;
        s.frame->volume.stride = stride;
        ++s.frame->volume.version;
        double mean;
        const double worst = data ? difference(&s, s.frame, &mean) : INFINITY;
        if (worst > 1e-5)
        {
          printf("type %d, stride %zu: %g\n", (int)type, stride, worst);
        }
        CHECK(worst <= 2e-4); /* between instruction paths the header states 1e-4 */
        free(data);
      }
    }
  }
  scene_destroy(&s);
}

static void types_far_from_zero_lose_nothing(void)
{
  scene s;
  if (scene_create(&s, 1) && keep(&s))
  {
    double* const data = malloc(VOXELS * sizeof *data);
    int64_t* const whole = malloc(VOXELS * sizeof *whole);
    double mean;
    for (size_t i = 0; data && whole && i < VOXELS; ++i)
    {
      data[i] = 1e9 + (double)s.volume.extinction[i];
      whole[i] = INT64_C(4000000000) + (int64_t)s.volume.extinction[i];
    }
    s.frame->volume.scalars = data;
    s.frame->volume.type = CHI_F64;
    s.frame->volume.stride = sizeof *data;
    s.frame->transfer.range[0] += 1e9;
    s.frame->transfer.range[1] += 1e9;
    CHECK(data && difference(&s, s.frame, &mean) <= 2e-4);
    s.frame->volume.scalars = whole;
    s.frame->volume.type = CHI_I64;
    s.frame->transfer.range[0] += 3e9;
    s.frame->transfer.range[1] += 3e9;
    CHECK(whole && difference(&s, s.frame, &mean) <= 2e-4);
    free(data);
    free(whole);
  }
  scene_destroy(&s);
}

/* Index order turned and mirrored, with the matrix that undoes it: the same samples in the same
 * places. Axis a of the new array runs along old axis order[a], backwards where flip has bit a. */
static void mirrored_and_turned_matrices_equal_the_resampled_original(void)
{
  static const int order[4][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 1, 0 }, { 1, 0, 2 } };
  scene s;
  float* const data = malloc(VOXELS * sizeof *data);
  if (scene_create(&s, 0) && data && keep(&s))
  {
    for (int k = 0; k < 32; ++k)
    {
      const int* const axes = order[k >> 3];
      reference_frame* const f = s.frame;
      size_t step[3] = { 1, SIZE, SIZE * SIZE }, base = 0;
      double m[16] = { 0 };
      static const double sign[3] = { 1, 1, -1 }; /* of the original's matrix */
      for (int a = 0; a < 3; ++a)
      {
        const int old = axes[a], flip = k >> a & 1;
        m[4 * old + a] = sign[old] * (flip ? -1 : 1);
        m[4 * old + 3] = sign[old] * (flip ? SIZE - 1 : 0);
      }
      m[15] = 1;
      for (size_t i = 0; i < VOXELS; ++i)
      {
        const size_t at[3] = { i % SIZE, i / SIZE % SIZE, i / (SIZE * SIZE) };
        size_t from = base;
        for (int a = 0; a < 3; ++a)
        {
          from += step[axes[a]] * (k >> a & 1 ? SIZE - 1 - at[a] : at[a]);
        }
        data[i] = s.volume.extinction[from];
      }
      f->volume.scalars = data;
      memcpy(f->volume.index_to_world, m, sizeof m);
      ++f->volume.version;
      double mean;
      CHECK(difference(&s, f, &mean) <= 2e-4);
    }
  }
  free(data);
  scene_destroy(&s);
}

/* All lengths times a factor, and everything moved: positions are doubles, so a shift of 1e8
 * voxels leaves 1e-8 of a voxel. */
static void scale_and_place_do_not_matter(int parallel)
{
  scene s;
  if (scene_create(&s, parallel) && keep(&s))
  {
    const reference_frame original = *s.frame;
    static const double scales[4] = { 1e-6, 1e-3, 1e3, 1e6 };
    for (int k = 0; k < 6; ++k)
    {
      const double scale = k < 4 ? scales[k] : 1, far = k < 4 ? 0 : k == 4 ? 1e5 : -1e8;
      reference_frame* const f = s.frame;
      for (int i = 0; i < 12; ++i)
      {
        f->volume.index_to_world[i] = scale * original.volume.index_to_world[i];
        f->camera.world_to_eye[i] = original.camera.world_to_eye[i] * (i % 4 == 3 ? scale : 1);
      }
      for (int r = 0; r < 3; ++r)
      {
        f->volume.index_to_world[4 * r + 3] += far;
        for (int c = 0; c < 3; ++c)
        {
          f->camera.world_to_eye[4 * r + 3] -= far * original.camera.world_to_eye[4 * r + c];
        }
      }
      for (int i = 0; i < 4; ++i)
      {
        f->camera.window[i] = original.camera.window[i] * (parallel ? scale : 1);
      }
      f->camera.near_depth = original.camera.near_depth * scale;
      f->transfer.unit_distance = original.transfer.unit_distance * scale;
      for (int i = 0; i < PIXELS; ++i)
      {
        s.depth[i] = i % WIDTH < 40 ? (float)(scale * (58 + 0.3 * (i % WIDTH))) : INFINITY;
      }
      ++f->surface.version;
      ++f->transfer.version;
      double mean;
      const double worst = difference(&s, f, &mean);
      if (worst > 1e-4)
      {
        printf("scale %g, moved %g: worst %g, mean %g\n", scale, far, worst, mean);
      }
      /* A depth that rounds to the other side of a slab moves one pixel's blocker by that slab. */
      CHECK(mean <= 1e-5 && worst <= 0.02);
    }
  }
  scene_destroy(&s);
}

/* Cell data: the sample is the cell's centre and its value reaches half a cell farther, as if the
 * outermost samples stood twice, half a cell apart; here against a grid padded by one sample and a
 * surface that shows only what lies within. */
static void cell_data_reach_half_a_sample_farther(void)
{
  enum
  {
    N = 8
  };
  reference_volume v;
  const size_t n[3] = { N, N, N };
  const double center[3] = { 3.5, 3.5, 3.5 }, turn[2] = { 0, 0 };
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* engine = NULL;
  if (f && reference_volume_create(&v, n) && chi_occlusion_create(NULL, &engine) == CHI_OK)
  {
    for (size_t i = 0; i < N * N * N; ++i)
    {
      v.extinction[i] = 0.1f * (float)(1 + i / (N * N));
    }
    reference_volume_finish(&v);
    const reference_view view = reference_turned_view(center, 40, turn, 16, WIDTH, 1);
    for (int cells = 0; cells < 2; ++cells)
    {
      reference_frame_init(f, &v, &view, 1);
      f->volume.is_cell_data = cells;
      f->params.strength = 0;
      f->params.sample_distance = 0.25;
      chi_occlusion_image image;
      CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_OK);
      chi_occlusion_get_image(engine, &image);
      /* tau along z: trapezoids between centres, and half a cell of the end values. */
      const double tau =
        0.1 * (0.5 * 1 + 2 + 3 + 4 + 5 + 6 + 7 + 0.5 * 8) + (cells ? 0.1 * 0.5 * (1 + 8) : 0);
      int covered = 0;
      for (int i = 0; image.rgba && i < PIXELS; ++i)
      {
        covered += image.rgba[4 * i + 3] > 0;
      }
      /* 4 pixels a voxel: samples span 7 voxels, cells 8 */
      CHECK(covered == (cells ? 32 * 32 : 28 * 28));
      const float* const middle = image.rgba + 4 * (WIDTH * WIDTH / 2 + WIDTH / 2);
      /* the first segment counts with its far end's value: tau + 0.1 x 0.25^2 / 2 */
      CHECK_NEAR((double)middle[3], -expm1(-tau), 0.0032 * exp(-tau));
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
}

/* Nearest: piecewise constant, steps half-way between samples. */
static void nearest_takes_the_nearest_sample(void)
{
  reference_volume v;
  const size_t n[3] = { 4, 2, 3 };
  const double center[3] = { 1.5, 0.5, 1 }, turn[2] = { 0, 0 };
  reference_frame* const f = malloc(sizeof *f);
  chi_occlusion* engine = NULL;
  if (f && reference_volume_create(&v, n) && chi_occlusion_create(NULL, &engine) == CHI_OK)
  {
    for (size_t i = 0; i < 24; ++i)
    {
      v.extinction[i] = 0.1f * (float)(1 + i % 4);
    }
    reference_volume_finish(&v);
    const reference_view view = reference_turned_view(center, 40, turn, 8, WIDTH, 1);
    reference_frame_init(f, &v, &view, 1);
    f->volume.interpolation = CHI_NEAREST;
    f->params.strength = 0;
    chi_occlusion_image image;
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    for (int i = 0; image.rgba && i < WIDTH; ++i)
    {
      const double x = (i + 0.5 - 32) / 8 + 1.5; /* 8 pixels a voxel */
      const double s = 0.1 * (1 + floor(x + 0.5));
      const double alpha = x > 0 && x < 3 ? -expm1(-2 * s) : 0;
      CHECK_NEAR((double)image.rgba[4 * (WIDTH * 32 + i) + 3], alpha, 1e-4);
    }
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(f);
}

/* Asked: no pixel by more than 1/255. */
static void skipping_changes_no_pixel(int parallel)
{
  scene s;
  if (scene_create(&s, parallel))
  {
    for (int k = 0; k < 8; ++k)
    {
      s.frame->params.half_size = k & 1;
      s.frame->params.geometry_thickness = k & 2 ? 5 : 0;
      s.frame->params.sample_distance = k & 4 ? 0.5 : 0;
      s.frame->params.skip = 0;
      chi_occlusion_stats all, some;
      keep(&s);
      chi_occlusion_get_stats(s.engine, &all);
      s.frame->params.skip = 1;
      double mean;
      CHECK(difference(&s, s.frame, &mean) <= 1.0 / 255);
      chi_occlusion_get_stats(s.engine, &some);
      CHECK(some.samples < all.samples && some.skipped_samples > all.skipped_samples);
      CHECK(some.samples + some.skipped_samples == all.samples + all.skipped_samples);
      CHECK(some.light_updates < all.light_updates);
    }
  }
  scene_destroy(&s);
}

static void only_what_changed_is_made_anew(void)
{
  scene s;
  chi_occlusion_stats stats;
  if (scene_create(&s, 0) && keep(&s))
  {
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused && !stats.reused_bricks && !stats.reused_classification);
    double mean;
    CHECK(difference(&s, s.frame, &mean) == 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(stats.reused && stats.samples == 0 && stats.light_updates == 0);
    s.frame->camera.world_to_eye[3] += 0.25; /* camera */
    CHECK(difference(&s, s.frame, &mean) > 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused && stats.reused_bricks && stats.reused_classification);
    s.frame->camera.world_to_eye[3] -= 0.25;
    s.frame->opacity[REFERENCE_ENTRIES - 1] *= 0.5f; /* transfer function */
    ++s.frame->transfer.version;
    CHECK(difference(&s, s.frame, &mean) > 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused && stats.reused_bricks && !stats.reused_classification);
    s.volume.extinction[VOXELS / 2 + SIZE / 2] = 0; /* samples */
    ++s.frame->volume.version;
    CHECK(difference(&s, s.frame, &mean) > 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused && !stats.reused_bricks && !stats.reused_classification);
    s.depth[0] = 20; /* geometry */
    ++s.frame->surface.version;
    CHECK(difference(&s, s.frame, &mean) > 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused && stats.reused_bricks && stats.reused_classification);
    s.frame->params.strength = 0.5;
    CHECK(difference(&s, s.frame, &mean) > 0);
    chi_occlusion_get_stats(s.engine, &stats);
    CHECK(!stats.reused);
  }
  scene_destroy(&s);
}

/* Strength fades linearly: half of it is the mean of none and all. */
static void strength_fades_linearly(void)
{
  scene s;
  float* const none = malloc(5 * PIXELS * sizeof *none);
  float* const half = malloc(5 * PIXELS * sizeof *half);
  if (scene_create(&s, 1) && none && half && keep(&s))
  {
    s.frame->params.strength = 0;
    int ok = render(NULL, s.engine, s.frame, none);
    s.frame->params.strength = 0.5;
    ok = ok && render(NULL, s.engine, s.frame, half);
    for (int i = 0; ok && i < 5 * PIXELS; ++i)
    {
      /* sums of some 30 floats; where rays count as saturated at 0.998, what is left of them */
      CHECK_NEAR((double)half[i], 0.5 * ((double)none[i] + (double)s.kept[i]), 1e-4);
    }
  }
  free(none);
  free(half);
  scene_destroy(&s);
}

/* Four threads that take one index at a time: whatever order the machine makes of it. */
typedef struct crowd_job
{
  chi_range_fn body;
  void* data;
  size_t count;
  atomic_size_t next;
} crowd_job;

static void* work(void* arg)
{
  crowd_job* const job = (crowd_job*)arg;
  for (size_t i = atomic_fetch_add(&job->next, 1); i < job->count;
       i = atomic_fetch_add(&job->next, 1))
  {
    job->body(job->data, i, i + 1);
  }
  return NULL;
}

static void crowd(void* user, size_t count, chi_range_fn body, void* data)
{
  (void)user;
  crowd_job job = { body, data, count, 0 };
  pthread_t thread[3];
  int started = 0;
  while (started < 3 && pthread_create(thread + started, NULL, work, &job) == 0)
  {
    ++started;
  }
  work(&job);
  while (started > 0)
  {
    pthread_join(thread[--started], NULL);
  }
}

static void any_schedule_gives_the_same_bits(void)
{
  const chi_exec schedule[2] = { { .struct_size = sizeof(chi_exec),
                                   .parallel_for = chi_test_backwards },
    { .struct_size = sizeof(chi_exec), .parallel_for = crowd } };
  float* const other = malloc(5 * PIXELS * sizeof *other);
  for (int k = 0; k < 16 && other; ++k)
  {
    scene s;
    if (scene_create(&s, k & 1))
    {
      const chi_exec* const exec = schedule + (k >> 3);
      chi_occlusion* engine = NULL;
      s.frame->params.half_size = k >> 1 & 1;
      s.frame->params.method = k >> 2 & 1;
      CHECK(chi_occlusion_create(exec, &engine) == CHI_OK);
      CHECK(keep(&s) && render(exec, engine, s.frame, other));
      CHECK(memcmp(s.kept, other, 5 * PIXELS * sizeof *other) == 0);
      chi_occlusion_destroy(exec, engine);
    }
    scene_destroy(&s);
  }
  free(other);
}

/* The header's bound; on a machine that lacks a set, the next one is compared with itself. */
static void instruction_sets_agree(void)
{
  static const char* const sets[2] = { "avx2", "generic" };
  for (int k = 0; k < 16; ++k)
  {
    scene s;
    if (scene_create(&s, k & 1))
    {
      s.frame->params.half_size = k >> 1 & 1;
      s.frame->params.method = k >> 2 & 1;
      s.frame->volume.interpolation = k >> 3 & 1;
      keep(&s);
      for (int set = 0; set < 2; ++set)
      {
        double mean;
        CHECK(setenv("CHIAROSCURO_ISA", sets[set], 1) == 0);
        ++s.frame->surface.version; /* the frame would be taken as unchanged */
        const double worst = difference(&s, s.frame, &mean);
        CHECK(worst <= 1e-4);
        unsetenv("CHIAROSCURO_ISA");
      }
    }
    scene_destroy(&s);
  }
}

int main(void)
{
  every_type_and_stride_gives_the_same_picture();
  types_far_from_zero_lose_nothing();
  mirrored_and_turned_matrices_equal_the_resampled_original();
  scale_and_place_do_not_matter(0);
  scale_and_place_do_not_matter(1);
  cell_data_reach_half_a_sample_farther();
  nearest_takes_the_nearest_sample();
  skipping_changes_no_pixel(0);
  skipping_changes_no_pixel(1);
  only_what_changed_is_made_anew();
  strength_fades_linearly();
  any_schedule_gives_the_same_bits();
  instruction_sets_agree();
  return chi_test_report();
}
