/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Faster frames of less quality, and the depth at which a volume becomes opaque. */

#include <chiaroscuro/chi_occlusion_plan.h>

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  N = 32,
  MAX_WIDTH = 120
};

typedef struct scene
{
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_occlusion_params params;
  chi_occlusion_frame frame;
  chi_occlusion* engine;
  float rgb[6], opacity[2], depth[MAX_WIDTH * MAX_WIDTH];
  float samples[N * N * N];
} scene;

/* A box of N - 1 voxels a side about depth 60, seen along z by a window of twice its size. */
static scene* make_scene(int parallel, int width, int height, int even)
{
  scene* const s = calloc(1, sizeof *s);
  if (!s || chi_occlusion_create(NULL, &s->engine) != CHI_OK)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, width, height, parallel ? 20 : 20.0 / 60);
  for (int i = 0; i < N * N * N; ++i)
  {
    const double x = i % N, y = i / N % N, z = (double)(i / (N * N));
    s->samples[i] = even ? 1 : (float)(0.5 + 0.5 * sin(0.3 * x) * cos(0.35 * y) * sin(0.3 * z + 1));
  }
  s->volume = cube_at(s->samples, CHI_F32, N, 60);
  const float rgb[6] = { 0.2f, 0.4f, 0.9f, 1, 0.8f, 0.3f };
  memcpy(s->rgb, rgb, sizeof rgb);
  s->opacity[1] = 0.1f;
  s->transfer = tables(s->rgb, s->opacity, 2, 0, 1);
  /* on the left a surface in front of everything, on the right one behind, tilted; between, none */
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      s->depth[y * width + x] = 3 * x < width ? 40
        : 3 * x > 2 * width                   ? (float)(78 + 0.1 * y)
                                              : INFINITY;
    }
  }
  s->surface = surface_of(s->depth);
  chi_occlusion_default_params(&s->params);
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .volume = &s->volume,
    .transfer = &s->transfer,
    .surface = &s->surface,
    .params = &s->params };
  return s;
}

static void free_scene(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  free(s);
}

/* [pixels][5]: RGBA and visibility. */
static float* render(const chi_exec* exec, scene* s)
{
  chi_occlusion_image image;
  const size_t pixels = (size_t)s->camera.width * (size_t)s->camera.height;
  CHECK(chi_occlusion_render(exec, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  float* const out = malloc(5 * pixels * sizeof *out);
  if (!out || !image.rgba || image.width != s->camera.width || image.height != s->camera.height)
  {
    CHECK(!"an image of the camera's size");
    exit(1);
  }
  for (size_t i = 0; i < pixels; ++i)
  {
    memcpy(out + 5 * i, image.rgba + 4 * i, 4 * sizeof *out);
    out[5 * i + 4] = image.visibility[i];
  }
  return out;
}

static double mean_difference(const scene* s, const float* a, const float* b)
{
  const size_t count = 5 * (size_t)s->camera.width * (size_t)s->camera.height;
  double sum = 0;
  for (size_t i = 0; i < count; ++i)
  {
    sum += fabs((double)a[i] - (double)b[i]);
  }
  return sum / (double)count;
}

static double mean_brightness(const scene* s, const float* a)
{
  const size_t pixels = (size_t)s->camera.width * (size_t)s->camera.height;
  double sum = 0;
  for (size_t i = 0; i < pixels; ++i)
  {
    const double through = s->depth[i] < INFINITY ? (1 - (double)a[5 * i + 3]) : 0;
    sum += (double)(a[5 * i] + a[5 * i + 1] + a[5 * i + 2]) / 3 + through * (double)a[5 * i + 4];
  }
  return sum / (double)pixels;
}

/* Asked: mean luminance within 2 %. */
static void a_reduced_picture_is_as_bright_and_nearly_the_same(void)
{
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, 119, 101, 0); /* no multiple of any reduction */
    float* const full = render(NULL, s);
    chi_occlusion_stats all, some;
    chi_occlusion_get_stats(s->engine, &all);
    for (int n = 2; n <= 4; ++n)
    {
      for (int coarse = 1; coarse <= 2; ++coarse)
      {
        s->params.reduction = n;
        s->params.half_size = 0;
        s->params.coarsening = coarse;
        float* const fast = render(NULL, s);
        chi_occlusion_get_stats(s->engine, &some);
        const double change = mean_brightness(s, fast) / mean_brightness(s, full) - 1;
        const double mean = mean_difference(s, fast, full);
        printf("reduction %d, coarsening %d: brightness %+.2f %%, mean difference %.2f/255\n", n,
          coarse, 100 * change, 255 * mean);
        CHECK(fabs(change) <= 0.02);
        /* the field's waves are 18 voxels long, of which a reduced pixel sees up to 1.6: linear
         * interpolation loses (pi 1.6 / 18)^2 / 2 of them, 4 %, at the edges of the box more; wider
         * slices read light up to a voxel off, 1 / 18 of a wave */
        CHECK(mean <= (coarse == 1 ? 0.015 : 0.02));
        CHECK(mean > 0);
        CHECK(some.samples * n * n * coarse < all.samples * 3 / 2);
        CHECK_NEAR(some.sample_distance, coarse * all.sample_distance, 1e-12);
        free(fast);
      }
    }
    free(full);
    free_scene(s);
  }
}

static void the_edges_of_surfaces_stay_where_they_are(void)
{
  scene* const s = make_scene(1, 120, 96, 1);
  s->opacity[0] = s->opacity[1] = 0.3f;
  for (int n = 2; n <= 4; ++n)
  {
    s->params.reduction = n;
    float* const fast = render(NULL, s);
    double leak = 0, least = 1;
    for (int y = 30; y < 66; ++y)
    {
      for (int x = 33; x < 46; ++x) /* the front surface's edge, before the fog */
      {
        const double alpha = (double)fast[5 * (y * 120 + x) + 3];
        leak = 3 * x < 120 ? fmax(leak, alpha) : leak;
        least = 3 * x < 120 ? least : fmin(least, alpha);
      }
    }
    /* weights fall with the square of the distance, which is more than 30 slabs */
    CHECK(leak <= 1.0 / 255 && least >= 0.99);
    for (int i = 0; i < 120 * 96; ++i)
    {
      CHECK(s->depth[i] < INFINITY || fast[5 * i + 4] == 1);
    }
    free(fast);
  }
  free_scene(s);
}

static void one_is_none_and_any_schedule_gives_the_same_bits(void)
{
  scene* const s = make_scene(0, 77, 63, 0);
  const size_t bytes = 5 * 77 * 63 * sizeof(float);
  float* const full = render(NULL, s);
  s->params.reduction = 1;
  s->params.coarsening = 1;
  float* const one = render(NULL, s);
  CHECK(memcmp(full, one, bytes) == 0);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  s->params.reduction = 2;
  float* const serial = render(NULL, s);
  s->params.reduction = 3;
  free(render(NULL, s));
  s->params.reduction = 2;
  float* const other = render(&backwards, s);
  CHECK(memcmp(serial, other, bytes) == 0);
  free(full);
  free(one);
  free(serial);
  free(other);
  free_scene(s);
}

static void the_smallest_pictures_can_be_reduced(void)
{
  for (int n = 1; n <= 4; ++n)
  {
    for (int width = 1; width <= 5; ++width)
    {
      scene* const s = make_scene(0, width, 6 - width, 1);
      s->params.reduction = n;
      float* const picture = render(NULL, s);
      for (int i = 0; i < 5 * width * (6 - width); ++i)
      {
        CHECK(picture[i] >= 0 && picture[i] <= 1);
      }
      free(picture);
      free_scene(s);
    }
  }
}

static void what_is_out_of_range_is_refused(void)
{
  scene* const s = make_scene(0, 32, 32, 0);
  free(render(NULL, s));
  const double coarse[] = { -1, 0.5, 65, NAN, INFINITY };
  for (int i = 0; i < 5; ++i)
  {
    s->params.coarsening = coarse[i];
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  }
  s->params.coarsening = 0;
  for (int i = -1; i <= 5; i += 6)
  {
    s->params.reduction = i;
    CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_ERROR_INVALID_ARGUMENT);
  }
  s->params.reduction = 0;
  float* const depth = s->depth;
  const double alphas[] = { 0, 1, -0.5, NAN };
  for (int i = 0; i < 4; ++i)
  {
    CHECK(chi_occlusion_find_depth(NULL, s->engine, &s->frame, alphas[i], depth) ==
      CHI_ERROR_INVALID_ARGUMENT);
  }
  CHECK(
    chi_occlusion_find_depth(NULL, s->engine, &s->frame, 0.5, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_occlusion_find_depth(NULL, NULL, &s->frame, 0.5, depth) == CHI_ERROR_INVALID_ARGUMENT);
  free_scene(s);
}

/* Even fog: alpha is reached -ln(1 - alpha) / sigma along the ray from where it enters. */
static void the_depth_of_an_opacity_in_even_fog_is_exact(void)
{
  enum
  {
    WIDTH = 64
  };
  for (int parallel = 0; parallel < 2; ++parallel)
  {
    scene* const s = make_scene(parallel, WIDTH, WIDTH, 1);
    s->opacity[0] = s->opacity[1] = 0.1f;
    s->frame.surface = NULL;
    float* const picture = render(NULL, s);
    float depth[WIDTH * WIDTH];
    const double alphas[] = { 1.0 / 255, 0.3, 0.9, 0.998 };
    for (int k = 0; k < 4; ++k)
    {
      s->params.reduction = k == 1 ? 2 : 0; /* is not looked at */
      CHECK(chi_occlusion_find_depth(NULL, s->engine, &s->frame, alphas[k], depth) == CHI_OK);
      double worst = 0;
      int reached = 0;
      for (int y = 0; y < WIDTH; ++y)
      {
        for (int x = 0; x < WIDTH; ++x)
        {
          const double half = s->camera.window[1];
          const double px = half * ((2 * x + 1.0) / WIDTH - 1),
                       py = half * ((2 * y + 1.0) / WIDTH - 1);
          const double slope = parallel ? 0 : px * px + py * py;
          const double face = 60 - 0.5 * (N - 1), across = parallel ? 1 : face;
          if (fmax(fabs(px), fabs(py)) * across > 0.5 * (N - 1) - 2)
          {
            continue;
          }
          const double exact = face - log1p(-alphas[k]) / -log(1 - 0.1) / sqrt(1 + slope) * 1.0;
          const double alpha = (double)picture[5 * (y * WIDTH + x) + 3];
          const double at = (double)depth[y * WIDTH + x];
          if (fabs(alpha - alphas[k]) < 1e-3)
          {
            continue; /* at the back, where roundings decide */
          }
          CHECK((alpha > alphas[k]) == (at < INFINITY));
          if (at < INFINITY)
          {
            ++reached;
            worst = fmax(worst, fabs(at - exact));
          }
        }
      }
      printf("alpha %.3f: depth within %.1e of a voxel, %d pixels\n", alphas[k], worst, reached);
      CHECK(alphas[k] > 0.95 || reached > 500);
      /* transmittance in float, a slice at a time: 6e-8 / (1 - alpha) each, of a mean free path of
       * 10; alpha 0.9: 5e-5; depths in float: 4e-6 */
      CHECK(worst < 2e-4);
    }
    free(picture);
    free_scene(s);
  }
}

static void finding_a_depth_leaves_the_picture_and_stops_at_surfaces(void)
{
  scene* const s = make_scene(1, 60, 60, 1);
  s->opacity[0] = s->opacity[1] = 0.2f;
  float* const before = render(NULL, s);
  chi_occlusion_stats first, then;
  chi_occlusion_get_stats(s->engine, &first);
  float depth[3600];
  CHECK(chi_occlusion_find_depth(NULL, s->engine, &s->frame, 0.5, depth) == CHI_OK);
  chi_occlusion_get_stats(s->engine, &then);
  CHECK(memcmp(&first, &then, sizeof first) == 0);
  CHECK(depth[30 * 60 + 15] == INFINITY); /* behind the front surface */
  CHECK(depth[30 * 60 + 30] > 44.5 && depth[30 * 60 + 30] < 50);
  CHECK(depth[2 * 60 + 30] == INFINITY); /* beside the box */
  float* const after = render(NULL, s);
  chi_occlusion_get_stats(s->engine, &then);
  CHECK(then.reused == 1 && memcmp(before, after, 5 * 3600 * sizeof *before) == 0);
  s->frame.volume = NULL;
  CHECK(chi_occlusion_find_depth(NULL, s->engine, &s->frame, 0.5, depth) == CHI_OK);
  CHECK(depth[30 * 60 + 30] == INFINITY);
  free(before);
  free(after);
  free_scene(s);
}

static void other_engines_are_told_of_the_reduction_alone(void)
{
  scene* const s = make_scene(1, 60, 60, 1);
  CHECK(s->params.color_integration == CHI_COLOR_PREINTEGRATED);
  CHECK(chi_occlusion_features(&s->frame) == 0);
  s->params.coarsening = 2; /* a matter of where slices lie, which plans say */
  CHECK(chi_occlusion_features(&s->frame) == 0);
  for (int n = 0; n <= 4; ++n)
  {
    s->params.reduction = n;
    CHECK(chi_occlusion_features(&s->frame) == (n > 1 ? CHI_FEATURE_REDUCTION : 0));
  }
  free_scene(s);
}

static void a_plan_describes_the_small_picture_and_its_enlargement(void)
{
  scene* const s = make_scene(1, 61, 50, 1);
  chi_occlusion_plan plan = { .struct_size = sizeof plan };
  CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &plan) == CHI_OK);
  CHECK(plan.width == 61 && plan.height == 50 && plan.reduction == 1 && !plan.guide);
  CHECK(plan.full_width == 61 && plan.full_height == 50);
  for (int n = 2; n <= 4; ++n)
  {
    s->params.reduction = n;
    CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &plan) == CHI_OK);
    CHECK(plan.width == (60 / n) + 1 && plan.height == 49 / n + 1 && plan.reduction == n);
    CHECK(plan.full_width == 61 && plan.full_height == 50 && plan.reduced_pixel < n);
    CHECK(plan.features == CHI_FEATURE_REDUCTION && plan.guide != NULL);
    CHECK(plan.guide_far > (double)plan.slabs);
    for (int i = 0; i < 61 * 50 && plan.guide; ++i)
    {
      const double slabs = ((double)s->depth[i] - plan.start) / plan.slab;
      CHECK(s->depth[i] < INFINITY ? fabs((double)plan.guide[i] - slabs) < 1e-5 * plan.guide_far
                                   : plan.guide[i] == INFINITY);
    }
    for (int y = 0; y < plan.height; ++y)
    {
      for (int x = 0; x < plan.width; ++x)
      {
        /* the small picture's surfaces are those of the pixels that stand for the blocks */
        const int fx = n * x + plan.reduced_pixel, fy = n * y + plan.reduced_pixel;
        const int at = (fy < 50 ? fy : 49) * 61 + (fx < 61 ? fx : 60);
        CHECK(plan.surface_more[y * plan.width + x][2] == s->depth[at]);
      }
    }
  }
  s->frame.surface = NULL;
  CHECK(chi_occlusion_describe(NULL, s->engine, &s->frame, &plan) == CHI_OK);
  CHECK(plan.reduction == 4 && !plan.guide);
  free_scene(s);
}

int main(void)
{
  a_reduced_picture_is_as_bright_and_nearly_the_same();
  the_edges_of_surfaces_stay_where_they_are();
  one_is_none_and_any_schedule_gives_the_same_bits();
  the_smallest_pictures_can_be_reduced();
  what_is_out_of_range_is_refused();
  the_depth_of_an_opacity_in_even_fog_is_exact();
  finding_a_depth_leaves_the_picture_and_stops_at_surfaces();
  other_engines_are_told_of_the_reduction_alone();
  a_plan_describes_the_small_picture_and_its_enlargement();
  return chi_test_report();
}
