/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_PREINTEGRATION_FIXTURE_H
#define CHI_PREINTEGRATION_FIXTURE_H

/* A transfer function and its tables, for the tests of pre-integration. */

#include "chi_test.h"
#include "segment_rays.h"

#include <chiaroscuro/chi_preintegration.h>

enum
{
  MOST = 65536
};

/* A transfer function, and what is made of it. */
typedef struct fixture
{
  float rgb[MOST][3], opacity[MOST];
  chi_transfer_view transfer;
  chi_preintegration_params params;
  chi_preintegration* handle;
  chi_segment_tables tables;
} fixture;

__attribute__((unused)) static fixture* make_fixture(size_t count, int method)
{
  fixture* const f = calloc(1, sizeof *f);
  if (!f || chi_preintegration_create(NULL, &f->handle) != CHI_OK)
  {
    exit(1);
  }
  chi_preintegration_default_params(&f->params);
  f->params.method = method;
  f->transfer = (chi_transfer_view){ .struct_size = sizeof f->transfer,
    .rgb = f->rgb[0],
    .opacity = f->opacity,
    .count = count,
    .range = { 0, (double)(count - 1) }, /* so that scalars are places */
    .unit_distance = 1,
    .version = 1 };
  return f;
}

__attribute__((unused)) static void free_fixture(fixture* f)
{
  chi_preintegration_destroy(NULL, f->handle);
  free(f);
}

__attribute__((unused)) static void update(fixture* f)
{
  ++f->transfer.version;
  CHECK(chi_preintegration_update(NULL, f->handle, &f->transfer, &f->params) == CHI_OK);
  chi_preintegration_get_tables(f->handle, &f->tables);
}

__attribute__((unused)) static void fill_constant(
  fixture* f, float r, float g, float b, float opacity)
{
  for (size_t i = 0; i < f->transfer.count; ++i)
  {
    f->rgb[i][0] = r;
    f->rgb[i][1] = g;
    f->rgb[i][2] = b;
    f->opacity[i] = opacity;
  }
}

/* One of segment_rays.h. */
__attribute__((unused)) static void fill_kind(fixture* f, int kind)
{
  fill_transfer(kind, f->transfer.count, f->rgb, f->opacity);
}

__attribute__((unused)) static void one(
  const fixture* f, float x0, float x1, float length, float rgba[4])
{
  CHECK(chi_segment_evaluate(&f->tables, 1, &x0, &x1, &length, rgba) == CHI_OK);
}

#endif
