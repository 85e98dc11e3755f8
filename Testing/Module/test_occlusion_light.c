/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Light from aside, and from two sides, against the exact cone of straight rays and against what
 * must hold whatever the directions are. */

#include "chi_test.h"
#include "occlusion_reference.h"

#include <chiaroscuro/chi_occlusion_plan.h>

static const double angle_45 = 0.78539816339744831;
static const double radian = 0.017453292519943295;

static chi_occlusion* engine_create(void)
{
  chi_occlusion* engine = NULL;
  CHECK(chi_occlusion_create(NULL, &engine) == CHI_OK);
  return engine;
}

static void aim(double direction[3], double tilt_deg, double azimuth_deg)
{
  const double t = tilt_deg * radian, a = azimuth_deg * radian;
  direction[0] = sin(t) * cos(a);
  direction[1] = sin(t) * sin(a);
  direction[2] = cos(t);
}

/* A scene and points of its grid, every `step`-th voxel, layers from `first` on. */
typedef struct lit_scene
{
  reference_volume volume;
  reference_view view;
  reference_points points;
  double *exact, *work;
  float *a, *b;
  reference_frame* frame;
  double range;
} lit_scene;

static int scene_create(lit_scene* s, reference_kind kind)
{
  memset(s, 0, sizeof *s);
  s->range = kind == REFERENCE_HALF_PLANE ? 8 : 4.5;
  s->view = reference_parallel_view();
  const size_t most = 2048;
  s->points.position = malloc(most * 3 * sizeof(double));
  s->exact = malloc(most * sizeof(double));
  s->work = malloc(most * sizeof(double));
  s->a = malloc(most * sizeof(float));
  s->b = malloc(most * sizeof(float));
  s->frame = malloc(sizeof *s->frame);
  const int ok = s->points.position && s->exact && s->work && s->a && s->b && s->frame &&
    reference_scene(&s->volume, kind, NULL);
  CHECK(ok);
  for (int i = 0; ok && i < 128 * 128; ++i)
  {
    double at[3];
    if (kind == REFERENCE_HALF_PLANE) /* across the edge, behind the plate */
    {
      at[0] = 2 * (i % 64);
      at[1] = 64;
      at[2] = 24 + 8 * (i / 64);
    }
    else
    {
      at[0] = 14 * (i % 9) + 3;
      at[1] = 14 * (i / 9 % 9) + 3;
      at[2] = 14 * (i / 81) + 3;
    }
    if (at[2] < 128 && reference_extinction(&s->volume, at) < 0.5)
    {
      memcpy(s->points.position + 3 * s->points.count++, at, sizeof at);
    }
  }
  CHECK(s->points.count > 500 && s->points.count < most);
  return ok;
}

static void scene_free(lit_scene* s)
{
  reference_volume_free(&s->volume);
  reference_points_free(&s->points);
  free(s->exact);
  free(s->work);
  free(s->a);
  free(s->b);
  free(s->frame);
}

static void reset(lit_scene* s, double tilt_deg, double azimuth_deg)
{
  reference_frame_init(s->frame, &s->volume, &s->view, s->range);
  aim(s->frame->params.light_direction, tilt_deg, azimuth_deg);
}

static void probe(lit_scene* s, float* visibility)
{
  chi_occlusion* const engine = engine_create();
  CHECK(reference_probe(NULL, engine, s->frame, &s->view, &s->points, visibility) == CHI_OK);
  chi_occlusion_destroy(NULL, engine);
}

static double mean_difference(const float* a, const float* b, size_t count)
{
  double sum = 0;
  for (size_t i = 0; i < count; ++i)
  {
    sum += fabs((double)a[i] - (double)b[i]);
  }
  return sum / (double)count;
}

/*
 * Up to 30 degrees the limits are those asked for along the axis, 0.028 and 0.019 at full and 0.024
 * and 0.018 at half size. At 60 degrees a cone of 45 reaches to 105: a fifth of its solid angle
 * lies beyond 85 and comes in at 85 instead, which a half-plane sees with up to 0.01 in the mean
 * (the engine measured with 64 directions, 0.007 to 0.018, less its own error along the axis).
 */
static void a_tilted_light_meets_the_exact_cone(lit_scene* s, reference_kind kind)
{
  const int plane = kind == REFERENCE_HALF_PLANE;
  const double limit[2] = { plane ? 0.028 : 0.019, plane ? 0.024 : 0.018 };
  for (int tilt = 0; tilt <= 60; tilt += 30)
  {
    for (int azimuth = 0; azimuth <= (tilt && plane ? 180 : 0); azimuth += 90)
    {
      const reference_rays rays = { 256, 0.5, angle_45 };
      aim(s->view.light, tilt, azimuth);
      size_t count = 0;
      const size_t all = s->points.count;
      double* const position = s->points.position;
      double keep[3 * 2048];
      memcpy(keep, position, all * 3 * sizeof(double));
      for (size_t i = 0; i < all; ++i)
      {
        const double v = reference_visibility(&s->volume, NULL, &s->view, &rays, keep + 3 * i);
        if (!plane || (v > 0.02 && v < 0.98)) /* the penumbra: elsewhere there is nothing to miss */
        {
          s->exact[count] = v;
          memcpy(position + 3 * count++, keep + 3 * i, 3 * sizeof(double));
        }
      }
      s->points.count = count;
      CHECK(count > 100);
      for (int half = 0; half < 2; ++half)
      {
        reset(s, tilt, azimuth);
        s->frame->params.half_size = half;
        probe(s, s->a);
        const reference_error e = reference_compare(s->a, s->exact, count, s->work);
        printf("%s, light %d degrees off at %d, %s: mean %.4f, bias %+.4f, %zu points\n",
          plane ? "half-plane" : "balls", tilt, azimuth, half ? "half" : "full", e.mean, e.bias,
          count);
        CHECK(e.mean > 0 && e.mean <= limit[half] + (tilt == 60 ? 0.01 : 0));
      }
      memcpy(position, keep, all * 3 * sizeof(double));
      s->points.count = all;
    }
  }
}

/* Where none, a length other than 1, or an angle beyond the limit is asked for. */
static void directions_are_taken_as_documented(lit_scene* s)
{
  const size_t bytes = s->points.count * sizeof(float);
  reset(s, 0, 0);
  memset(s->frame->params.light_direction, 0, 3 * sizeof(double));
  probe(s, s->a);
  s->frame->params.light_direction[2] = 1e-300;
  probe(s, s->b);
  CHECK(memcmp(s->a, s->b, bytes) == 0);
  reset(s, 40, 20);
  probe(s, s->a);
  for (int k = 0; k < 3; ++k)
  {
    s->frame->params.light_direction[k] *= 1024; /* exact */
  }
  probe(s, s->b);
  CHECK(memcmp(s->a, s->b, bytes) == 0);
  chi_occlusion* const engine = engine_create();
  for (int k = 0; k < 3; ++k)
  {
    const double tilt[3] = { 60, 75, 180 };
    chi_occlusion_stats stats;
    reset(s, tilt[k], 90);
    CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_OK);
    chi_occlusion_get_stats(engine, &stats);
    CHECK(stats.moved_lights == (k > 0));
    CHECK(reference_probe(NULL, engine, s->frame, &s->view, &s->points, k ? s->b : s->a) == CHI_OK);
    /* an angle through sine and cosine and back: 1e-16 of a slope, 1e-7 of floats that follow */
    CHECK(k == 0 || mean_difference(s->a, s->b, s->points.count) < 1e-6);
  }
  reset(s, 0, 0);
  s->frame->params.light_direction[1] = NAN;
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  reset(s, 0, 0);
  s->frame->params.second_light_share = 1.01;
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  reset(s, 0, 0);
  s->frame->params.second_light_cone_angle_rad = 1.5;
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  chi_occlusion_destroy(NULL, engine);
}

/* The set of directions is not its own mirror image: both are 64 directions, which miss the exact
 * cone of the balls by 0.0055 each. */
static void a_mirrored_light_gives_the_mirrored_picture(lit_scene* s)
{
  reset(s, 40, 30);
  s->frame->params.directions = 64;
  s->frame->params.half_size = 0;
  probe(s, s->a);
  const size_t n = REFERENCE_SIZE;
  for (size_t row = 0; row < n * n; ++row)
  {
    float* const line = s->volume.extinction + row * n;
    for (size_t i = 0; i < n / 2; ++i)
    {
      const float x = line[i];
      line[i] = line[n - 1 - i];
      line[n - 1 - i] = x;
    }
  }
  for (int pass = 0; pass < 2; ++pass) /* the second one mirrors the points back */
  {
    for (size_t i = 0; i < s->points.count; ++i)
    {
      s->points.position[3 * i] = (double)n - 1 - s->points.position[3 * i];
    }
    if (pass == 0)
    {
      s->frame->params.light_direction[0] *= -1;
      probe(s, s->b);
    }
  }
  const double mirrored = mean_difference(s->a, s->b, s->points.count);
  s->frame->params.light_direction[0] *= -1;
  probe(s, s->b); /* the light that was not mirrored, in places that were not, of another scene */
  const double other = mean_difference(s->a, s->b, s->points.count);
  printf(
    "mirrored light in the mirrored scene: mean %.4f; light not mirrored: %.4f\n", mirrored, other);
  CHECK(mirrored <= 0.011 && other > 5 * mirrored);
  for (size_t row = 0; row < n * n; ++row)
  {
    float* const line = s->volume.extinction + row * n;
    for (size_t i = 0; i < n / 2; ++i)
    {
      const float x = line[i];
      line[i] = line[n - 1 - i];
      line[n - 1 - i] = x;
    }
  }
}

/* A sum of floats, in another order: 32 x 2^-24. At half size the cone's mean path, by which pixels
 * are taken together, is that of both lights. */
static void two_lights_are_the_weighted_mean_of_each(lit_scene* s)
{
  float* const both = malloc(s->points.count * sizeof(float));
  reset(s, 20, 200);
  s->frame->params.half_size = 0;
  aim(s->frame->params.second_light_direction, 45, 10);
  s->frame->params.second_light_cone_angle_rad = 20 * radian;
  probe(s, s->a);
  s->frame->params.second_light_share = 1;
  probe(s, s->b);
  s->frame->params.second_light_share = 0.3;
  if (both)
  {
    probe(s, both);
  }
  double differs = 0;
  for (size_t i = 0; both && i < s->points.count; ++i)
  {
    CHECK_NEAR((double)both[i], 0.7 * (double)s->a[i] + 0.3 * (double)s->b[i], 1e-5);
    differs = fmax(differs, fabs((double)s->a[i] - (double)s->b[i]));
  }
  CHECK(differs > 0.2);
  free(both);
}

static void a_second_light_without_a_share_changes_nothing(lit_scene* s)
{
  reset(s, 20, 200);
  probe(s, s->a);
  aim(s->frame->params.second_light_direction, 45, 10);
  s->frame->params.second_light_cone_angle_rad = 20 * radian;
  probe(s, s->b);
  CHECK(memcmp(s->a, s->b, s->points.count * sizeof(float)) == 0);
}

/* Both are within their own error of the exact cone: of balls 0.0185 with 16 directions, and
 * 0.0111 with 32 (measured); two sets in one place are at least as good as one. */
static void two_equal_lights_are_as_one_of_twice_the_directions(lit_scene* s)
{
  const reference_rays rays = { 256, 0.5, angle_45 };
  aim(s->view.light, 0, 0);
  for (size_t i = 0; i < s->points.count; ++i)
  {
    s->exact[i] =
      reference_visibility(&s->volume, NULL, &s->view, &rays, s->points.position + 3 * i);
  }
  double error[3];
  for (int k = 0; k < 3; ++k)
  {
    reset(s, 0, 0);
    s->frame->params.half_size = 0;
    s->frame->params.directions = k == 2 ? 32 : 16;
    s->frame->params.second_light_share = k == 1 ? 0.5 : 0;
    probe(s, k == 1 ? s->a : s->b);
    error[k] = reference_compare(k == 1 ? s->a : s->b, s->exact, s->points.count, s->work).mean;
  }
  printf("one light of 16 %.4f, two of 16 in its place %.4f, one of 32 %.4f\n", error[0], error[1],
    error[2]);
  CHECK(error[1] <= 0.75 * error[0]);
  CHECK(mean_difference(s->a, s->b, s->points.count) <= error[1] + error[2]);
}

/* An opaque plate and fog behind it, which light from 60 degrees aside leaves in full shadow where
 * it is seen past the plate: the picture changes by no more than 1/255 where that shadow's light is
 * left out, and a tenth of all light is. */
static void full_shadow_is_left_out(void)
{
  reference_volume v;
  const size_t n[3] = { 512, 80, 40 };
  const size_t pixels = n[0] * n[1];
  reference_frame* const f = malloc(sizeof *f);
  float* const all = malloc(4 * pixels * sizeof(float));
  chi_occlusion* const engine = engine_create();
  const int ok = f && all && reference_volume_create(&v, n);
  CHECK(ok);
  for (size_t i = 0; ok && i < pixels * n[2]; ++i)
  {
    const size_t x = i % n[0], z = i / pixels;
    v.extinction[i] = z < 3 ? (x >= 64 && x < 448 ? 8.0f : 0.0f) : z > 5 ? 0.02f : 0.0f;
  }
  for (int k = 0; ok && k < 4; ++k)
  {
    const int half = k / 2, skip = k & 1;
    reference_view view = reference_parallel_view();
    if (k == 0)
    {
      reference_volume_finish(&v);
    }
    view.camera.world_to_eye[3] = view.camera.world_to_eye[7] = 0;
    view.camera.window[0] = view.camera.window[2] = 0;
    view.camera.window[1] = (double)n[0];
    view.camera.window[3] = (double)n[1];
    view.camera.width = (int32_t)n[0];
    view.camera.height = (int32_t)n[1];
    reference_frame_init(f, &v, &view, 8);
    f->params.half_size = half;
    f->params.cone_angle_rad = 8 * radian;
    f->params.skip = skip ? CHI_SKIP_SATURATED_LIGHT : CHI_SKIP_NOTHING;
    aim(f->params.light_direction, 60, 0);
    chi_occlusion_image image;
    chi_occlusion_stats stats;
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    chi_occlusion_get_stats(engine, &stats);
    double most = 0, dark = 0;
    for (size_t i = 0; image.rgba && i < 4 * pixels; ++i)
    {
      most = fmax(most, fabs((double)all[i] - (double)image.rgba[i]));
      dark += i % 4 == 0 && image.rgba[i + 3] > 0.1f && image.rgba[i + 3] < 0.9f &&
        image.rgba[i] < 0.7f * image.rgba[i + 3];
      all[i] = skip ? all[i] : image.rgba[i];
    }
    const double part = (double)stats.skipped_light_updates /
      (double)(stats.skipped_light_updates + stats.light_updates);
    if (skip)
    {
      printf("full shadow, %s: %.0f %% of the light is left out, %.2g of 255 of the picture\n",
        half ? "half" : "full", 100 * part, 255 * most);
      CHECK(most <= 1.0 / 255);
      CHECK(part > 0.1 && dark > 500);
    }
    else
    {
      CHECK(stats.skipped_light_updates == 0);
    }
  }
  if (ok)
  {
    reference_volume_free(&v);
  }
  chi_occlusion_destroy(NULL, engine);
  free(all);
  free(f);
}

static void tint(lit_scene* s, double red, double green, double blue)
{
  s->frame->params.colored_attenuation = 1;
  s->frame->params.attenuation[0] = red;
  s->frame->params.attenuation[1] = green;
  s->frame->params.attenuation[2] = blue;
}

static void grey_attenuation_changes_nothing(lit_scene* s)
{
  reset(s, 20, 30);
  probe(s, s->a);
  s->frame->params.attenuation[1] = 7; /* not asked for */
  probe(s, s->b);
  CHECK(memcmp(s->a, s->b, s->points.count * sizeof(float)) == 0);
  tint(s, 1, 1, 1);
  CHECK(chi_occlusion_features(&s->frame->frame) == 0);
  probe(s, s->b);
  CHECK(memcmp(s->a, s->b, s->points.count * sizeof(float)) == 0);
}

/* The same picture in one channel of three as in all three of one light; with geometry and its
 * vicinity, strength, half size. */
static void each_colour_is_the_picture_of_its_own_attenuation(lit_scene* s)
{
  const size_t pixels = (size_t)REFERENCE_SIZE * REFERENCE_SIZE;
  float* const depth = malloc(pixels * sizeof(float));
  float* const all = malloc(7 * pixels * sizeof(float));
  const double factor[3] = { 0.25, 0, 2 };
  chi_occlusion* const engine = engine_create();
  chi_occlusion_image image;
  for (int k = -1; k < 3 && depth && all; ++k)
  {
    reset(s, 30, 60);
    s->frame->params.bias = -1;
    s->frame->params.strength = 0.8;
    s->frame->params.vicinity_distance = 3;
    for (size_t i = 0; i < pixels; ++i)
    {
      depth[i] = i % 128 < 64 ? 70 + 0.2f * (float)(i / 128) : INFINITY;
    }
    s->frame->surface =
      (chi_surface_view){ .struct_size = sizeof s->frame->surface, .depth = depth, .version = 1 };
    s->frame->frame.surface = &s->frame->surface;
    const double one = k < 0 ? 0 : factor[k];
    tint(s, k < 0 ? factor[0] : one, k < 0 ? factor[1] : one, k < 0 ? factor[2] : one);
    CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    CHECK(image.rgba && (image.visibility_rgb != NULL) == (k < 0));
    if (!image.rgba || (k < 0 && !image.visibility_rgb))
    {
      break;
    }
    double different = 0;
    for (size_t i = 0; i < pixels; ++i)
    {
      if (k < 0)
      {
        memcpy(all + 7 * i, image.rgba + 4 * i, 4 * sizeof(float));
        memcpy(all + 7 * i + 4, image.visibility_rgb + 3 * i, 3 * sizeof(float));
        const float* const v = image.visibility_rgb + 3 * i;
        CHECK_NEAR((double)image.visibility[i], (double)((v[0] + v[1] + v[2]) / 3), 1e-6);
        continue;
      }
      /* the colours are looked up and multiplied in another order: 2^-24 a sample, 128 of them */
      different = fmax(
        different, fabs((double)all[7 * i + (size_t)k] - (double)image.rgba[4 * i + (size_t)k]));
      different = fmax(different, fabs((double)all[7 * i + 3] - (double)image.rgba[4 * i + 3]));
      different =
        fmax(different, fabs((double)all[7 * i + 4 + (size_t)k] - (double)image.visibility[i]));
    }
    CHECK(different <= 1e-5);
  }
  chi_occlusion_destroy(NULL, engine);
  free(depth);
  free(all);
}

/* Without geometry a channel that nothing attenuates is the unshaded ray cast; the more a channel
 * is attenuated, the darker; a factor that is not a finite one >= 0 is refused. */
static void a_channel_without_attenuation_has_no_occlusion(lit_scene* s)
{
  const size_t pixels = (size_t)REFERENCE_SIZE * REFERENCE_SIZE;
  float* const plain = malloc(4 * pixels * sizeof(float));
  chi_occlusion* const engine = engine_create();
  chi_occlusion_image image;
  double red = 0, blue = 0, most = 0;
  for (int shaded = 0; shaded < 2 && plain; ++shaded)
  {
    reset(s, 30, 60);
    s->frame->params.strength = shaded;
    s->frame->params.half_size = 0; /* the parabola that enlarges does not keep the order */
    tint(s, 0.5, 0, 2);
    CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    for (size_t i = 0; image.rgba && i < pixels; ++i)
    {
      if (!shaded)
      {
        memcpy(plain + 4 * i, image.rgba + 4 * i, 4 * sizeof(float));
        continue;
      }
      const float* const p = image.rgba + 4 * i;
      most = fmax(most, fabs((double)p[1] - (double)plain[4 * i + 1]));
      red += (double)plain[4 * i] - (double)p[0];
      blue += (double)plain[4 * i + 2] - (double)p[2];
      CHECK(p[0] >= p[2] - 1e-6f && p[1] >= p[0] - 1e-6f);
    }
  }
  CHECK(most <= 1e-6);
  CHECK(red > 100 && blue > 1.5 * red);
  CHECK(chi_occlusion_features(&s->frame->frame) == CHI_FEATURE_COLORED);
  reset(s, 0, 0);
  tint(s, 1, -0.1, 1);
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  tint(s, 1, NAN, 1);
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  tint(s, 1, 1, INFINITY);
  CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_ERROR_INVALID_ARGUMENT);
  chi_occlusion_destroy(NULL, engine);
  free(plain);
}

/* Visibility of attenuation a times that of one is that of a volume a times as dense. */
static void attenuation_is_a_factor_of_the_extinction(lit_scene* s)
{
  for (int half = 0; half < 2; ++half)
  {
    reset(s, 30, 60);
    s->frame->params.half_size = half;
    tint(s, 0.5, 1, 1);
    probe(s, s->a);
    reset(s, 30, 60);
    s->frame->params.half_size = half;
    s->frame->transfer.unit_distance *= 2;
    probe(s, s->b);
    /* the table's sums are rounded to 2^-31 of their whole; paths of 128 samples */
    CHECK(mean_difference(s->a, s->b, s->points.count) < 1e-5);
  }
}

/* Centre of the shadow that a small ball casts on a wall `behind` voxels behind it: a cone of 10
 * degrees about the light's axis meets it where the axis does. */
static void shadow_centre(const reference_frame* f, const chi_occlusion_image* image, double at[2])
{
  double sum = 0;
  at[0] = at[1] = 0;
  for (int i = 0; i < f->camera.width * f->camera.height; ++i)
  {
    const double dark = 1 - (double)image->visibility[i];
    sum += dark;
    at[0] += dark * (i % f->camera.width);
    at[1] += dark * (i / f->camera.width);
  }
  CHECK(sum > 10);
  at[0] /= sum;
  at[1] /= sum;
}

static void a_ball_casts_its_shadow_to_the_far_side(void)
{
  reference_volume v;
  const size_t n[3] = { 128, 128, 24 };
  float* const depth = malloc(128 * 128 * sizeof(float));
  reference_frame* const f = malloc(sizeof *f);
  const int ok = depth && f && reference_volume_create(&v, n);
  CHECK(ok);
  if (!ok)
  {
    free(depth);
    free(f);
    return;
  }
  const double middle[3] = { 100, 45, 12 };
  for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i)
  {
    const double x = (double)(i % 128) - middle[0], y = (double)(i / 128 % 128) - middle[1];
    const double z = (double)(i / (128 * 128)) - middle[2];
    v.extinction[i] = x * x + y * y + z * z < 64 ? 4 : 0;
  }
  reference_volume_finish(&v);
  const reference_view view = reference_parallel_view();
  chi_occlusion* const engine = engine_create();
  /* The wall within the volume's slabs; behind them; and so far that each direction is read in one
   * step from the last plane (the light is then the narrower, or its spread leaves the picture). */
  const double behind[3] = { 10, 60, 250 };
  const double tilt[3] = { 50, 45, 12 };
  for (int k = 0; k < 12; ++k)
  {
    const int place = k % 3, half = k / 3 % 2, published = k / 6;
    if (published && place == 2)
    {
      continue; /* the blur has no directions left that could go on straight */
    }
    for (int i = 0; i < 128 * 128; ++i)
    {
      depth[i] = (float)(10 + middle[2] + behind[place]); /* the eye is 10 before the grid */
    }
    reference_frame_init(f, &v, &view, 4);
    f->surface = (chi_surface_view){
      .struct_size = sizeof f->surface, .depth = depth, .version = (uint64_t)k + 1
    };
    f->frame.surface = &f->surface;
    f->params.half_size = half;
    f->params.method = published ? CHI_OCCLUSION_PUBLISHED : CHI_OCCLUSION_ORDINATES;
    f->params.cone_angle_rad = 4 * radian;
    f->params.vicinity_samples = 0;
    f->params.interactions = CHI_VOLUME_TO_GEOMETRY;
    aim(f->params.light_direction, tilt[place], 330);
    chi_occlusion_image image;
    CHECK(chi_occlusion_render(NULL, engine, &f->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    double at[2];
    if (image.visibility)
    {
      shadow_centre(f, &image, at);
      const double away = behind[place] * tan(tilt[place] * radian);
      /* a light plane is read half a slab off at most, and light pixels are two: 2 tan + 1 */
      const double expected[2] = { middle[0] - away * cos(330 * radian),
        middle[1] - away * sin(330 * radian) };
      printf("ball's shadow %g behind, %s, %s: %.1f %.1f, expected %.1f %.1f\n", behind[place],
        half ? "half" : "full", published ? "published" : "ordinates", at[0], at[1], expected[0],
        expected[1]);
      CHECK_NEAR(at[0], expected[0], 1.5);
      CHECK_NEAR(at[1], expected[1], 1.5);
    }
  }
  chi_occlusion_destroy(NULL, engine);
  reference_volume_free(&v);
  free(depth);
  free(f);
}

/* Leaving out work changes a picture by 1/255 at most, with light from two sides as without. */
static void skipping_changes_nothing(lit_scene* s)
{
  const size_t floats = 4 * REFERENCE_SIZE * REFERENCE_SIZE;
  float* const all = malloc(floats * sizeof(float));
  chi_occlusion* const engine = engine_create();
  double most = 0;
  for (int skip = 0; skip < 2 && all; ++skip)
  {
    chi_occlusion_image image;
    reset(s, 50, 300);
    aim(s->frame->params.second_light_direction, 60, 100);
    s->frame->params.second_light_share = 0.4;
    s->frame->params.skip = skip;
    s->frame->params.bias = -1;
    CHECK(chi_occlusion_render(NULL, engine, &s->frame->frame) == CHI_OK);
    chi_occlusion_get_image(engine, &image);
    for (size_t i = 0; image.rgba && i < floats; ++i)
    {
      all[i] = skip ? all[i] - image.rgba[i] : image.rgba[i];
      most = skip ? fmax(most, fabs((double)all[i])) : 0;
    }
  }
  CHECK(most <= 1.0 / 255);
  chi_occlusion_destroy(NULL, engine);
  free(all);
}

int main(void)
{
  lit_scene s;
  if (scene_create(&s, REFERENCE_HALF_PLANE))
  {
    a_tilted_light_meets_the_exact_cone(&s, REFERENCE_HALF_PLANE);
  }
  scene_free(&s);
  if (scene_create(&s, REFERENCE_BALLS))
  {
    a_tilted_light_meets_the_exact_cone(&s, REFERENCE_BALLS);
    directions_are_taken_as_documented(&s);
    a_mirrored_light_gives_the_mirrored_picture(&s);
    a_second_light_without_a_share_changes_nothing(&s);
    two_lights_are_the_weighted_mean_of_each(&s);
    two_equal_lights_are_as_one_of_twice_the_directions(&s);
    skipping_changes_nothing(&s);
    grey_attenuation_changes_nothing(&s);
    each_colour_is_the_picture_of_its_own_attenuation(&s);
    a_channel_without_attenuation_has_no_occlusion(&s);
    attenuation_is_a_factor_of_the_extinction(&s);
  }
  scene_free(&s);
  a_ball_casts_its_shadow_to_the_far_side();
  full_shadow_is_left_out();
  return chi_test_report();
}
