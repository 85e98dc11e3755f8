/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Tables of any transfer function: refused where the header says so, else any segment has a colour
 * that lies between those of the table, and an opacity. */

#include "fuzz.h"

#include <chiaroscuro/chi_preintegration.h>

enum
{
  SEGMENTS = 40
};

static chi_transfer_view fuzz_transfer(fuzz* f)
{
  const size_t count = fuzz_once_in(f, 16) ? fuzz_upto(f, 2) : 2 + fuzz_upto(f, 120);
  float* const rgb = (float*)fuzz_new(f, 3 * count * sizeof *rgb);
  float* const opacity = (float*)fuzz_new(f, count * sizeof *opacity);
  const int wild = fuzz_once_in(f, 16), shape = fuzz_byte(f) % 4;
  for (size_t i = 0; i < count; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      fuzz_store(
        (char*)(rgb + 3 * i + (size_t)c), CHI_F32, wild ? fuzz_any(f) : (double)fuzz_byte(f) / 255);
    }
    const double alpha = (double)fuzz_byte(f) / 255;
    fuzz_store((char*)(opacity + i), CHI_F32,
      wild           ? fuzz_any(f)
        : shape == 1 ? (alpha > 0.9) * alpha   /* mostly nothing */
        : shape == 2 ? exp(-90 * alpha)        /* over all magnitudes */
        : shape == 3 ? (i >= count / 2) * 0.25 /* a step */
                     : alpha);
  }
  chi_transfer_view t = { .struct_size = fuzz_size(f, sizeof t), .count = count };
  t.rgb = fuzz_once_in(f, 64) ? NULL : rgb;
  t.opacity = fuzz_once_in(f, 64) ? NULL : opacity;
  t.range[0] = fuzz_mostly(f, fuzz_unit(f));
  t.range[1] = t.range[0] + fuzz_mostly(f, 1 + (double)fuzz_byte(f));
  t.unit_distance = fuzz_mostly(f, (1 + (double)fuzz_byte(f)) / 64);
  t.table_count = fuzz_once_in(f, 32) ? fuzz_upto(f, 3) : 0;
  t.version = ++f->versions;
  return t;
}

static chi_preintegration_params fuzz_params(fuzz* f)
{
  chi_preintegration_params p = { .struct_size = fuzz_size(f, sizeof p) };
  p.method = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 4) : (int32_t)fuzz_upto(f, 3);
  p.opacity_convention = (int32_t)(fuzz_once_in(f, 64) ? fuzz_bits(f, 4) : fuzz_upto(f, 1));
  p.longest_segment = fuzz_once_in(f, 2) ? fuzz_mostly(f, (double)fuzz_byte(f) / 16) : 0;
  p.segment_range = fuzz_once_in(f, 2) ? fuzz_mostly(f, (double)fuzz_byte(f)) : 0;
  p.full_scalars = (int32_t)(fuzz_once_in(f, 64) ? fuzz_bits(f, 4) : 4 + fuzz_upto(f, 40));
  p.full_depths = (int32_t)(fuzz_once_in(f, 64) ? fuzz_bits(f, 4) : 4 + fuzz_upto(f, 10));
  p.direct_color = fuzz_once_in(f, 4) ? (int32_t)fuzz_bits(f, 4) : 0;
  return p;
}

static int is_valid(const chi_transfer_view* t, const chi_preintegration_params* p)
{
  if (t->struct_size % 8 || t->struct_size < offsetof(chi_transfer_view, gradient_opacity) ||
    p->struct_size % 8 || p->struct_size < offsetof(chi_preintegration_params, direct_color) ||
    !t->opacity || t->count < 2)
  {
    return 0;
  }
  const int direct =
    p->struct_size > offsetof(chi_preintegration_params, direct_color) && p->direct_color;
  if (!t->rgb && !direct)
  {
    return 0;
  }
  const size_t tables = t->struct_size >= offsetof(chi_transfer_view, table_count) + sizeof(size_t)
    ? t->table_count
    : 0;
  const double width = t->range[1] - t->range[0];
  int valid = tables <= 1 && width > 0 && width < INFINITY && t->unit_distance > 0 &&
    t->unit_distance < INFINITY && fuzz_is_in(p->method, 0, 3) &&
    fuzz_is_in(p->opacity_convention, 0, 1) && p->longest_segment >= 0 &&
    p->longest_segment < INFINITY && p->segment_range >= 0 && p->segment_range < INFINITY;
  const double scalars = p->full_scalars ? p->full_scalars : 128;
  const double depths = p->full_depths ? p->full_depths : 32;
  valid &= fuzz_is_in(scalars, 4, 512) && fuzz_is_in(depths, 4, 64) &&
    scalars * scalars * depths <= 4194304;
  for (size_t i = 0; i < t->count && valid; ++i)
  {
    const double alpha = fmin(fmax((double)t->opacity[i], 0), 1);
    const double unit = p->opacity_convention ? -log1p(-fmin(alpha, 1 - 1e-6)) : alpha;
    valid &= isfinite(t->opacity[i]) && unit / t->unit_distance <= 1e16;
    for (size_t c = 0; c < 3 && !direct; ++c)
    {
      valid &= isfinite(t->rgb[3 * i + c]);
    }
  }
  return valid;
}

static void check_tables(const chi_segment_tables* t)
{
  FUZZ_CHECK(t->method >= CHI_PREINTEGRATION_NONE && t->method <= CHI_PREINTEGRATION_FULL);
  FUZZ_CHECK((t->full != NULL) == (t->method == CHI_PREINTEGRATION_FULL));
  for (int i = 0; i <= t->count; ++i)
  {
    for (int c = 0; c < 4; ++c)
    {
      FUZZ_CHECK(
        isfinite(t->color[i][c]) && t->color[i][c] >= 0 && (c == 3 || t->color[i][c] <= 1));
      FUZZ_CHECK(isfinite(t->depth[i][c]));
    }
    FUZZ_CHECK(!t->full || i == 0 || i == t->count || t->depth[i][3] > t->depth[i - 1][3]);
  }
  const int32_t* const size = t->full_size;
  for (int i = 0; t->full && i < size[0] * size[1] * size[2]; ++i)
  {
    FUZZ_CHECK(t->full[i][0] >= 0 && t->full[i][0] <= 1 && t->full[i][1] >= 0 &&
      t->full[i][1] <= 1 && t->full[i][2] >= 0 && t->full[i][2] <= 1);
  }
}

static void check_segments(fuzz* f, const chi_segment_tables* t)
{
  float x0[SEGMENTS], x1[SEGMENTS], length[SEGMENTS], rgba[SEGMENTS][4];
  for (int i = 0; i < SEGMENTS; ++i)
  {
    fuzz_store((char*)(x0 + i), CHI_F32, fuzz_any(f) * (fuzz_byte(f) & 1 ? 16 : 1));
    fuzz_store((char*)(x1 + i), CHI_F32,
      fuzz_once_in(f, 4) ? (double)x0[i] + fuzz_unit(f) * 1e-5 : 16 * fuzz_any(f));
    fuzz_store((char*)(length + i), CHI_F32, fuzz_any(f));
  }
  const size_t count = fuzz_upto(f, SEGMENTS);
  FUZZ_CHECK(chi_segment_evaluate(t, count, x0, x1, length, rgba[0]) == CHI_OK);
  for (size_t i = 0; i < count; ++i)
  {
    FUZZ_CHECK(rgba[i][3] >= 0 && rgba[i][3] <= 1 && (length[i] > 0 || rgba[i][3] == 0));
    for (int c = 0; c < 3; ++c) /* psi's error, of one colour against the other */
    {
      FUZZ_CHECK(fuzz_is_in((double)rgba[i][c], -1e-4, (double)rgba[i][3] + 1e-4));
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  chi_exec exec = fuzz_host(f, 1000);
  chi_preintegration* p = NULL;
  chi_status status = chi_preintegration_create(&exec, &p);
  fuzz_after(f, status);
  FUZZ_CHECK((status == CHI_OK) == (p != NULL));
  uint64_t version = 0;
  for (int round = 0; p && round < 3; ++round) /* one handle, several functions */
  {
    const size_t kept = f->kept_count;
    const chi_transfer_view transfer = fuzz_transfer(f);
    const chi_preintegration_params params = fuzz_params(f);
    const int valid = is_valid(&transfer, &params);
    chi_segment_tables before, tables;
    chi_preintegration_get_tables(p, &before);
    exec = fuzz_host(f, 1000);
    status = chi_preintegration_update(&exec, p, &transfer, &params);
    fuzz_after(f, status);
    FUZZ_CHECK((status == CHI_ERROR_INVALID_ARGUMENT) == !valid);
    chi_preintegration_get_tables(p, &tables);
    if (status == CHI_OK)
    {
      FUZZ_CHECK(tables.version > version && tables.count == (int32_t)transfer.count);
      version = tables.version;
      check_tables(&tables);
      check_segments(f, &tables);
    }
    else
    {
      FUZZ_CHECK(status == CHI_ERROR_INVALID_ARGUMENT
          ? memcmp(&before, &tables, sizeof tables) == 0 /* they stand */
          : tables.count == 0 && tables.color == NULL);
    }
    fuzz_forget(f, kept);
  }
  exec = fuzz_host(f, 1000);
  chi_preintegration_destroy(&exec, p);
  fuzz_end(f);
  return 0;
}
