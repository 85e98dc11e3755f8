/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_BLOBS_H
#define CHI_OCCLUSION_BLOBS_H

/* Soft blobs with geometry in front of and behind them: the scene of the tests of cuts and masks.
 */

#include "chi_test.h"
#include "occlusion_views.h"

enum
{
  N = 40,
  WIDTH = 72,
  PIXELS = WIDTH * WIDTH,
  CUT = 16 /* a voxel to cut at */
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
  float rgb[6], opacity[2], samples[N * N * N], depth[PIXELS];
  double planes[4 * CHI_MAX_CLIP_PLANES];
} scene;

/* Soft blobs, 0 ... 1. */
static float blobs(size_t i, size_t j, size_t k)
{
  return (float)(0.5 + 0.5 * sin(0.45 * (double)i) * cos(0.4 * (double)j) * cos(0.5 * (double)k));
}

/* The volume's samples from `first` on, one unit apart, centred about depth 100; the eye looks
 * along -z. */
__attribute__((unused)) static scene* make_scene(
  int parallel, const size_t first[3], const size_t count[3])
{
  static uint64_t version = 0;
  scene* const s = calloc(1, sizeof *s);
  if (!s)
  {
    exit(1);
  }
  s->camera = eye_at_origin(parallel, WIDTH, WIDTH, parallel ? 30 : 0.3);
  for (size_t k = 0; k < count[2]; ++k)
  {
    for (size_t j = 0; j < count[1]; ++j)
    {
      for (size_t i = 0; i < count[0]; ++i)
      {
        s->samples[i + count[0] * (j + count[1] * k)] =
          blobs(i + first[0], j + first[1], k + first[2]);
      }
    }
  }
  s->volume = (chi_volume_view){ .struct_size = sizeof s->volume,
    .scalars = s->samples,
    .type = CHI_F32,
    .stride = sizeof(float),
    .dimensions = { count[0], count[1], count[2] },
    .index_to_world = { 1, 0, 0, (double)first[0] - 0.5 * (N - 1), 0, 1, 0,
      (double)first[1] - 0.5 * (N - 1), 0, 0, 1, (double)first[2] - 0.5 * (N - 1) - 100, 0, 0, 0,
      1 },
    .interpolation = CHI_LINEAR,
    .version = ++version };
  const float rgb[6] = { 0.2f, 0.4f, 0.9f, 1, 0.8f, 0.3f };
  memcpy(s->rgb, rgb, sizeof rgb);
  s->opacity[1] = 0.3f;
  s->transfer = tables(s->rgb, s->opacity, 2, 0.4, 1);
  for (int i = 0; i < PIXELS; ++i)
  {
    s->depth[i] = i % WIDTH < 20 ? 95 : 130;
  }
  s->surface = surface_of(s->depth);
  chi_occlusion_default_params(&s->params);
  s->params.sample_distance = 1;
  s->params.bias = 1.5;
  s->frame = (chi_occlusion_frame){ .struct_size = sizeof s->frame,
    .camera = &s->camera,
    .volume = &s->volume,
    .transfer = &s->transfer,
    .surface = &s->surface,
    .params = &s->params,
    .clip_planes = s->planes };
  CHECK(chi_occlusion_create(NULL, &s->engine) == CHI_OK);
  return s;
}

__attribute__((unused)) static scene* make_whole(int parallel)
{
  static const size_t first[3] = { 0, 0, 0 }, count[3] = { N, N, N };
  return make_scene(parallel, first, count);
}

static void free_scene(scene* s)
{
  chi_occlusion_destroy(NULL, s->engine);
  free(s);
}

__attribute__((unused)) static void add_plane(scene* s, double a, double b, double c, double d)
{
  const double plane[4] = { a, b, c, d };
  memcpy(s->planes + 4 * s->frame.clip_plane_count++, plane, sizeof plane);
}

static chi_occlusion_image render(scene* s)
{
  chi_occlusion_image image;
  CHECK(chi_occlusion_render(NULL, s->engine, &s->frame) == CHI_OK);
  chi_occlusion_get_image(s->engine, &image);
  CHECK(image.rgba && image.visibility);
  return image;
}

/* Regions of a scene, between index positions low and high along each axis. */
__attribute__((unused)) static void crop(
  scene* s, chi_crop_view* view, const double low[3], const double high[3], uint32_t regions)
{
  memset(view, 0, sizeof *view);
  view->struct_size = sizeof *view;
  view->regions = regions;
  const double* const m = s->volume.index_to_world;
  for (int k = 0; k < 6; ++k)
  {
    const int a = k / 2;
    view->planes[k][a] = 1;
    view->planes[k][3] = -((k & 1 ? high[a] : low[a]) * m[5 * a] + m[4 * a + 3]);
  }
  s->frame.crop = view;
}

/* Rotation of world about the centre of the blobs: no axis is parallel to a ray, or nearly. */
static void askew(double turn[9])
{
  const double cy = cos(0.5), sy = sin(0.5), cx = cos(0.4), sx = sin(0.4);
  const double r[9] = { cy, 0, sy, sx * sy, cx, -sx * cy, -cx * sy, sx, cx * cy };
  memcpy(turn, r, sizeof r);
}

__attribute__((unused)) static void look_askew(scene* s)
{
  double turn[9];
  askew(turn);
  for (int r = 0; r < 3; ++r)
  {
    for (int c = 0; c < 3; ++c)
    {
      s->camera.world_to_eye[4 * r + c] = turn[3 * r + c];
    }
    s->camera.world_to_eye[4 * r + 3] = turn[3 * r + 2] * 100 - (r == 2 ? 100 : 0);
  }
}

/* A pixel's ray p + t d, 0 <= t <= 1, in index space, through all of the blobs; its length in world
 * units is returned. */
__attribute__((unused)) static double askew_ray(const scene* s, int pixel, double p[3], double d[3])
{
  double turn[9], square = 0;
  askew(turn);
  const double* const w = s->camera.window;
  const double u = w[0] + (pixel % WIDTH + 0.5) * (w[1] - w[0]) / WIDTH;
  const double v = w[2] + (pixel / WIDTH + 0.5) * (w[3] - w[2]) / WIDTH;
  const double first = s->camera.parallel ? 1 : 0, last = s->camera.parallel ? 1 : 200;
  const double ends[2][3] = { { first * u, first * v, 0 }, { last * u, last * v, -200 } };
  for (int a = 0; a < 3; ++a) /* eye to world by the transpose, world to index */
  {
    double end[2];
    for (int e = 0; e < 2; ++e)
    {
      const double* const q = ends[e];
      end[e] = turn[a] * q[0] + turn[3 + a] * q[1] + turn[6 + a] * (q[2] + 100);
    }
    p[a] = end[0] - (s->volume.index_to_world[4 * a + 3] + (a == 2 ? 100 : 0));
    d[a] = end[1] - end[0];
    square += d[a] * d[a];
  }
  return sqrt(square);
}

#endif
