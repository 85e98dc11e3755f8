/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FUZZ_OCCLUSION_FEATURES_H
#define CHI_FUZZ_OCCLUSION_FEATURES_H

/* What a frame may have besides its volume, surface and camera; every choice 0 is "not there". */

#include "fuzz_views.h"

#include <chiaroscuro/chi_occlusion_plan.h>

typedef struct fuzz_features
{
  double clip_planes[3 * 4];
  chi_layers_view layers;
  chi_crop_view crop;
  chi_shading_light lights[2];
  chi_shading_view shading;
  chi_mask_view mask;
} fuzz_features;

static float* fuzz_shares(fuzz* f, size_t count)
{
  float* const out = (float*)fuzz_new(f, count * sizeof *out);
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = fuzz_once_in(f, 64) ? (float)fuzz_any(f) : (float)fuzz_byte(f) / 255;
  }
  return out;
}

static uint8_t* fuzz_flags(fuzz* f, size_t count, size_t most)
{
  uint8_t* const out = (uint8_t*)fuzz_new(f, count);
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = (uint8_t)fuzz_upto(f, most);
  }
  return out;
}

static void fuzz_layers(fuzz* f, fuzz_features* out, size_t pixels)
{
  const size_t count = 1 + fuzz_upto(f, CHI_MAX_LAYERS - 1);
  float* const depth = (float*)fuzz_new(f, count * pixels * sizeof *depth);
  float* const rgba = (float*)fuzz_new(f, 4 * count * pixels * sizeof *rgba);
  for (size_t i = 0; i < count * pixels; ++i)
  {
    depth[i] = fuzz_once_in(f, 64) ? (float)fuzz_any(f) : 10 + (float)fuzz_unit(f);
    rgba[4 * i + 3] = (float)fuzz_byte(f) / 255;
    for (size_t k = 0; k < 3; ++k)
    {
      rgba[4 * i + k] = fuzz_once_in(f, 128) ? NAN : rgba[4 * i + 3] * (float)fuzz_byte(f) / 255;
    }
  }
  out->layers = (chi_layers_view){ .struct_size = fuzz_size(f, sizeof out->layers),
    .depth = depth,
    .rgba = rgba,
    .version = ++f->versions,
    .count = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 1) - 9 : (int32_t)count };
  out->layers.count = out->layers.count > (int32_t)count && out->layers.count <= CHI_MAX_LAYERS
    ? (int32_t)count
    : out->layers.count;
}

static void fuzz_mask(
  fuzz* f, fuzz_features* out, const chi_volume_view* volume, const chi_transfer_view* transfer)
{
  size_t samples = 1, points = 1, cells = 1;
  for (int k = 0; k < 3; ++k)
  {
    const size_t n = volume->dimensions[k];
    samples *= n;
    points *= volume->is_cell_data ? n + 1 : n;
    cells *= volume->is_cell_data || n == 1 ? n : n - 1;
  }
  out->mask = (chi_mask_view){ .struct_size = fuzz_size(f, sizeof out->mask),
    .type = CHI_U8,
    .stride = 1,
    .point_bits = (uint8_t)fuzz_byte(f),
    .cell_bits = (uint8_t)fuzz_byte(f),
    .version = ++f->versions };
  out->mask.values = fuzz_byte(f) & 1 ? fuzz_flags(f, samples, 3) : NULL;
  out->mask.point_flags = fuzz_byte(f) & 1 ? fuzz_flags(f, points, 3) : NULL;
  out->mask.cell_flags = fuzz_byte(f) & 1 ? fuzz_flags(f, cells, 3) : NULL;
  if (out->mask.values && fuzz_byte(f) & 1)
  {
    out->mask.value_count = 1 + fuzz_upto(f, 3);
    const size_t tables = transfer->table_count > 1 ? transfer->table_count : 1;
    out->mask.table_of_value = fuzz_flags(f, out->mask.value_count, tables - 1);
  }
}

/* Hang features into a frame; `pixels` 0: the picture is too large for layers. */
static void fuzz_add_features(fuzz* f, fuzz_features* out, chi_occlusion_frame* frame,
  const chi_volume_view* volume, const chi_transfer_view* transfer, size_t pixels)
{
  memset(out, 0, sizeof *out);
  if (fuzz_once_in(f, 4))
  {
    fuzz_numbers(f, out->clip_planes, 12, 3);
    frame->clip_planes = out->clip_planes;
    frame->clip_plane_count = fuzz_upto(f, 3);
  }
  if (fuzz_once_in(f, 4))
  {
    out->crop.struct_size = fuzz_size(f, sizeof out->crop);
    for (int k = 0; k < 6; ++k)
    {
      fuzz_numbers(f, out->crop.planes[k], 4, 1);
      out->crop.planes[k][k / 2] += 1;
      out->crop.planes[k][3] += k & 1 ? -2 : 2;
    }
    out->crop.regions = (uint32_t)fuzz_bits(f, 4) & (fuzz_once_in(f, 64) ? ~0u : 0x7ffffffu);
    frame->crop = &out->crop;
  }
  if (pixels && fuzz_once_in(f, 4))
  {
    fuzz_layers(f, out, pixels);
    frame->layers = &out->layers;
  }
  if (fuzz_once_in(f, 3))
  {
    fuzz_shading(f, out->lights, &out->shading);
    frame->shading = &out->shading;
  }
  const size_t samples = volume->dimensions[0] * volume->dimensions[1] * volume->dimensions[2];
  if (samples > 0 && fuzz_once_in(f, 3))
  {
    fuzz_mask(f, out, volume, transfer);
    frame->mask = &out->mask;
  }
}

/* Further tables of a transfer view of `count` entries, and a second quantity. */
static void fuzz_add_tables(fuzz* f, chi_transfer_view* t, const chi_volume_view* volume)
{
  if (fuzz_once_in(f, 4))
  {
    t->gradient_count = 2 + fuzz_upto(f, 6);
    t->gradient_opacity = fuzz_shares(f, t->gradient_count);
    t->gradient_end = fuzz_mostly(f, 2);
  }
  if (fuzz_once_in(f, 4))
  {
    t->plane_count[0] = 2 + fuzz_upto(f, 6);
    t->plane_count[1] = 2 + fuzz_upto(f, 6);
    t->plane = fuzz_shares(f, 4 * t->plane_count[0] * t->plane_count[1]);
    t->plane_range[0] = fuzz_mostly(f, 0);
    t->plane_range[1] = fuzz_mostly(f, 2);
    t->y_samples = fuzz_byte(f) & 1
      ? fuzz_shares(f, volume->dimensions[0] * volume->dimensions[1] * volume->dimensions[2])
      : NULL;
  }
}

static void fuzz_lights(fuzz* f, chi_occlusion_params* p)
{
  if (fuzz_once_in(f, 3))
  {
    fuzz_numbers(f, p->light_direction, 3, 1);
  }
  if (fuzz_once_in(f, 3))
  {
    fuzz_numbers(f, p->second_light_direction, 3, 1);
    p->second_light_share = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
    p->second_light_cone_angle_rad = fuzz_mostly(f, (double)fuzz_byte(f) / 180);
  }
  p->colored_attenuation = fuzz_once_in(f, 4);
  for (int c = 0; c < 3; ++c)
  {
    p->attenuation[c] = fuzz_mostly(f, (double)fuzz_byte(f) / 64);
  }
}

#endif
