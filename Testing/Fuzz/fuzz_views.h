/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FUZZ_VIEWS_H
#define CHI_FUZZ_VIEWS_H

/* Cameras, matrices, transfer functions and lights, as any renderer is given them. */

#include "fuzz.h"

#include <chiaroscuro/chi_camera.h>
#include <chiaroscuro/chi_shading.h>
#include <chiaroscuro/chi_transfer.h>

FUZZ_UNUSED void fuzz_numbers(fuzz* f, double* out, size_t count, double usual)
{
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = fuzz_mostly(f, usual * fuzz_unit(f));
  }
}

FUZZ_UNUSED void fuzz_matrix(fuzz* f, double* m, int rigid)
{
  static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  memcpy(m, identity, sizeof identity);
  const double a = fuzz_once_in(f, 2) ? fuzz_unit(f) : 0, c = cos(a), s = sin(a);
  const size_t x = fuzz_upto(f, 2), y = (x + 1) % 3;
  m[4 * x + x] = m[4 * y + y] = c;
  m[4 * x + y] = -s;
  m[4 * y + x] = s;
  for (int k = 0; k < 3 && !rigid; ++k)
  {
    const double scale =
      fuzz_once_in(f, 3) ? fuzz_any(f) : 1; /* mirrors, slivers, nothing at all */
    for (int i = 0; i < 3; ++i)
    {
      m[4 * i + k] *= scale;
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    m[4 * k + 3] = fuzz_once_in(f, 8) ? fuzz_any(f) : fuzz_unit(f) / 2;
  }
  if (fuzz_once_in(f, 32))
  {
    m[fuzz_upto(f, 15)] = fuzz_any(f);
  }
}

FUZZ_UNUSED chi_camera fuzz_camera(fuzz* f)
{
  chi_camera c = { .struct_size = fuzz_size(f, sizeof c) };
  fuzz_matrix(f, c.world_to_eye, 1);
  c.world_to_eye[11] -= 12;
  c.parallel = fuzz_byte(f) & 1;
  const double half = c.parallel ? 8 : 0.6;
  c.window[0] = fuzz_mostly(f, -half);
  c.window[1] = fuzz_mostly(f, half);
  c.window[2] = fuzz_mostly(f, -half);
  c.window[3] = fuzz_mostly(f, half);
  c.width = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 4) : (int32_t)(1 + fuzz_upto(f, 40));
  c.height = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 4) : (int32_t)(1 + fuzz_upto(f, 40));
  c.near_depth = fuzz_mostly(f, 0.1);
  return c;
}

FUZZ_UNUSED chi_transfer_view fuzz_transfer(fuzz* f)
{
  chi_transfer_view t = { .struct_size = fuzz_size(f, sizeof t) };
  t.count = 2 + fuzz_upto(f, 12);
  float* const rgb = (float*)fuzz_new(f, 3 * t.count * sizeof *rgb);
  float* const opacity = (float*)fuzz_new(f, t.count * sizeof *opacity);
  for (size_t i = 0; i < t.count; ++i)
  {
    for (size_t k = 0; k < 3; ++k)
    {
      rgb[3 * i + k] = (float)fuzz_byte(f) / 255;
    }
    opacity[i] = fuzz_once_in(f, 64) ? (float)fuzz_any(f)
      : fuzz_byte(f) & 1             ? (float)fuzz_byte(f) / 255
                                     : 0;
  }
  t.rgb = rgb;
  t.opacity = opacity;
  t.range[0] = fuzz_mostly(f, -4);
  t.range[1] = fuzz_mostly(f, 4);
  t.unit_distance = fuzz_mostly(f, 1);
  t.version = ++f->versions;
  t.count = fuzz_once_in(f, 64) ? fuzz_upto(f, 1) : t.count;
  return t;
}

FUZZ_UNUSED void fuzz_shading(fuzz* f, chi_shading_light lights[2], chi_shading_view* out)
{
  for (int k = 0; k < 2; ++k)
  {
    chi_shading_light* const light = lights + k;
    light->kind = (int64_t)fuzz_upto(f, fuzz_once_in(f, 64) ? 9 : 2);
    fuzz_numbers(f, light->direction, 3, 1);
    fuzz_numbers(f, light->position, 3, 20);
    for (int c = 0; c < 3; ++c)
    {
      light->diffuse[c] = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
      light->specular[c] = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
      light->attenuation[c] = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
    }
    light->cone_angle_rad = fuzz_mostly(f, (double)fuzz_byte(f) / 100);
    light->exponent = fuzz_mostly(f, (double)fuzz_byte(f) / 10);
  }
  *out = (chi_shading_view){ .struct_size = fuzz_size(f, sizeof *out),
    .ambient = fuzz_mostly(f, 0.1),
    .diffuse = fuzz_mostly(f, 0.9),
    .specular = fuzz_mostly(f, 0.2),
    .specular_power = fuzz_mostly(f, 10),
    .two_sided = fuzz_byte(f) & 1,
    .lights = lights,
    .light_count = fuzz_upto(f, 2) };
}

#endif
