/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_SHADED_H
#define CHI_OCCLUSION_SHADED_H

/* One volume, its tables and lights, for the tests of what gradients do. */

#include "chi_test.h"

#include <chiaroscuro/chi_occlusion.h>

enum
{
  N = 24,       /* samples along each axis */
  PIXELS = 40,  /* of the picture, both ways */
  ENTRIES = 65, /* of every table */
  COUNT = N * N * N
};

/* A volume, a camera and all tables; pointers within, do not copy. */
typedef struct scene
{
  float scalars[COUNT];
  float rgb[3 * ENTRIES], opacity[ENTRIES], share[ENTRIES];
  double planes[6][4];
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_shading_view shading;
  chi_shading_light light[CHI_MAX_LIGHTS];
  chi_occlusion_params params;
  chi_occlusion_frame frame;
} scene;

static scene the; /* 60 kB: not on the stack */

/* White, of one extinction everywhere, strength 0; the world is index space around its centre times
 * `linear`, ten units ahead of a parallel eye. */
static inline void scene_init(const double linear[9])
{
  memset(&the, 0, sizeof the);
  for (int i = 0; i < ENTRIES; ++i)
  {
    the.rgb[3 * i] = the.rgb[3 * i + 1] = the.rgb[3 * i + 2] = 1;
    the.opacity[i] = 0.05f;
    the.share[i] = 1;
  }
  the.camera = (chi_camera){ .struct_size = sizeof the.camera,
    .world_to_eye = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 },
    .window = { -10, 10, -10, 10 },
    .parallel = 1,
    .width = PIXELS,
    .height = PIXELS,
    .near_depth = 0.01 };
  the.volume = (chi_volume_view){ .struct_size = sizeof the.volume,
    .scalars = the.scalars,
    .type = CHI_F32,
    .stride = sizeof(float),
    .dimensions = { N, N, N },
    .interpolation = CHI_LINEAR,
    .version = 1 };
  double* const m = the.volume.index_to_world;
  const double centre = 0.5 * (N - 1);
  m[15] = 1;
  for (int r = 0; r < 3; ++r)
  {
    m[4 * r + 3] = r == 2 ? -60 : 0;
    for (int c = 0; c < 3; ++c)
    {
      m[4 * r + c] = linear[3 * r + c];
      m[4 * r + 3] -= linear[3 * r + c] * centre;
    }
  }
  the.transfer = (chi_transfer_view){ .struct_size = sizeof the.transfer,
    .rgb = the.rgb,
    .opacity = the.opacity,
    .count = ENTRIES,
    .range = { -100, 100 },
    .unit_distance = 1,
    .version = 1,
    .gradient_count = ENTRIES,
    .gradient_end = 2 };
  the.shading = (chi_shading_view){
    .struct_size = sizeof the.shading, .diffuse = 1, .two_sided = 1, .lights = the.light
  };
  chi_occlusion_default_params(&the.params);
  the.params.strength = 0;
  the.frame = (chi_occlusion_frame){ .struct_size = sizeof the.frame,
    .camera = &the.camera,
    .volume = &the.volume,
    .transfer = &the.transfer,
    .params = &the.params,
    .shading = &the.shading };
}

static inline void add_light(int kind, double x, double y, double z)
{
  the.light[the.shading.light_count++] = (chi_shading_light){
    .kind = kind, .direction = { x, y, z }, .diffuse = { 1, 1, 1 }, .specular = { 1, 1, 1 }
  };
}

static inline void fill_ramp(const double g[3])
{
  for (int i = 0; i < COUNT; ++i)
  {
    the.scalars[i] =
      (float)(g[0] * (i % N - 11.5) + g[1] * (i / N % N - 11.5) + g[2] * (i / N / N - 11.5));
  }
}

/* Keep away from the border, where differences are one-sided: two samples of each face are cut. */
static inline void cut_border(void)
{
  /* planes of index space, p . x + d >= 0, go to the world with the inverse: p = q M */
  const double* const m = the.volume.index_to_world;
  double inverse[9];
  const double det = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
    m[2] * (m[4] * m[9] - m[5] * m[8]);
  for (int r = 0; r < 3; ++r)
  {
    for (int c = 0; c < 3; ++c)
    {
      const int a = (c + 1) % 3, b = (c + 2) % 3, d = (r + 1) % 3, e = (r + 2) % 3;
      inverse[3 * r + c] = (m[4 * a + d] * m[4 * b + e] - m[4 * a + e] * m[4 * b + d]) / det;
    }
  }
  for (int k = 0; k < 6; ++k)
  {
    const double sign = k & 1 ? -1 : 1;
    double* const p = the.planes[k];
    p[3] = k & 1 ? N - 3 : -2;
    for (int c = 0; c < 3; ++c)
    {
      p[c] = sign * inverse[3 * (k / 2) + c];
      p[3] -= p[c] * m[4 * c + 3];
    }
  }
  the.frame.clip_planes = the.planes[0];
  the.frame.clip_plane_count = 6;
}

static inline const float* render(const chi_exec* exec, chi_status expected)
{
  static float copy[4 * PIXELS * PIXELS];
  chi_occlusion* o = NULL;
  chi_occlusion_image image;
  CHECK(chi_occlusion_create(exec, &o) == CHI_OK);
  CHECK(chi_occlusion_render(exec, o, &the.frame) == expected);
  chi_occlusion_get_image(o, &image);
  CHECK((image.rgba != NULL) == (expected == CHI_OK));
  memset(copy, 0, sizeof copy);
  if (image.rgba)
  {
    memcpy(copy, image.rgba, sizeof copy);
  }
  chi_occlusion_destroy(exec, o);
  return copy;
}

static inline const float* centre_of(const float* rgba)
{
  return rgba + 4 * (PIXELS / 2 * PIXELS + PIXELS / 2);
}

static inline double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void normalize(double a[3])
{
  const double length = sqrt(dot(a, a));
  for (int i = 0; i < 3; ++i)
  {
    a[i] = length > 0 ? a[i] / length : 0;
  }
}

/* Solve linear^T n = g: the gradient in the world of one in index space. */
static inline void world_gradient(const double linear[9], const double g[3], double n[3])
{
  double m[3][4];
  for (int r = 0; r < 3; ++r)
  {
    for (int c = 0; c < 3; ++c)
    {
      m[r][c] = linear[3 * c + r];
    }
    m[r][3] = g[r];
  }
  for (int k = 0; k < 3; ++k)
  {
    int best = k;
    for (int r = k; r < 3; ++r)
    {
      best = fabs(m[r][k]) > fabs(m[best][k]) ? r : best;
    }
    for (int c = 0; c < 4; ++c)
    {
      const double swap = m[k][c];
      m[k][c] = m[best][c];
      m[best][c] = swap;
    }
    for (int r = 0; r < 3; ++r)
    {
      const double share = r == k ? 0 : m[r][k] / m[k][k];
      for (int c = 0; c < 4; ++c)
      {
        m[r][c] -= share * m[k][c];
      }
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    n[k] = m[k][3] / m[k][k];
  }
}

static const double identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
/* spacing 0.5 : 1 : 2 in a turned frame; the same mirrored; a shear */
static const double frames[4][9] = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 },
  { 0.4, -0.6, 0, 0.3, 0.8, 0, 0, 0, 2 }, { -0.4, -0.6, 0, -0.3, 0.8, 0, 0, 0, 2 },
  { 1, 0.4, 0, 0, 1, 0.3, 0, 0, 1 } };

#endif
