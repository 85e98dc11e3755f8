/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fiber surfaces of any grid, any fields and any polygon: refused where the header says so, else a
 * surface that holds together, the same on every host and after whatever the handle has seen. */

#include "fuzz_grids.h"

#include <chiaroscuro/chi_fiber.h>

typedef struct arrays
{
  chi_fiber_outputs out;
  size_t points, triangles;
} arrays;

static chi_lines_view any_polygon(fuzz* f)
{
  const size_t count = fuzz_upto(f, 14), line_count = fuzz_upto(f, 3);
  double* const x = (double*)fuzz_new(f, 3 * count * sizeof *x);
  int64_t* const offsets = (int64_t*)fuzz_new(f, (line_count + 1) * sizeof *offsets);
  const int is_whole = fuzz_byte(f) & 1; /* so that values lie on it */
  for (size_t i = 0; i < 3 * count; ++i)
  {
    x[i] = fuzz_once_in(f, 64) ? fuzz_any(f) : is_whole ? round(fuzz_unit(f)) : fuzz_unit(f);
  }
  if (count > 1 && fuzz_byte(f) & 1)
  {
    memcpy(x + 3 * (count - 1), x, 3 * sizeof *x);
  }
  size_t at = 0;
  for (size_t i = 0; i <= line_count; ++i)
  {
    offsets[i] = i == line_count ? (int64_t)count : (int64_t)at;
    at += fuzz_upto(f, count - at);
  }
  offsets[0] = fuzz_once_in(f, 32) ? (int64_t)fuzz_byte(f) - 2 : offsets[0];
  return (chi_lines_view){
    .points = { x, count, 3 * sizeof *x, CHI_F64 }, .offsets = offsets, .line_count = line_count
  };
}

static arrays new_arrays(fuzz* f, const chi_fiber_sizes* s, const chi_fiber_params* p)
{
  const size_t n = s->points, m = s->triangles;
  const int finds = p->find_components || p->minimum_area > 0;
  arrays a = { .points = n, .triangles = m };
  a.out = (chi_fiber_outputs){ .struct_size = sizeof a.out,
    .points = fuzz_new(f, 3 * n * sizeof(double)),
    .point_type = CHI_F64,
    .normals = p->no_normals ? NULL : (float*)fuzz_new(f, 3 * n * sizeof(float)),
    .segment_parameter = (float*)fuzz_new(f, n * sizeof(float)),
    .offsets = (int64_t*)fuzz_new(f, (m + 1) * sizeof(int64_t)),
    .connectivity = (int64_t*)fuzz_new(f, 3 * m * sizeof(int64_t)),
    .segment_ids = (int64_t*)fuzz_new(f, m * sizeof(int64_t)),
    .cell_ids = (int64_t*)fuzz_new(f, m * sizeof(int64_t)),
    .component_ids = finds ? (int64_t*)fuzz_new(f, m * sizeof(int64_t)) : NULL };
  return a;
}

static void check_arrays(const arrays* a, const chi_fiber_sizes* s, size_t cells)
{
  for (size_t i = 0; i < a->points; ++i)
  {
    const float t = a->out.segment_parameter[i];
    FUZZ_CHECK(t >= 0 && t <= 1);
    for (size_t k = 3 * i; k < 3 * i + 3; ++k)
    {
      FUZZ_CHECK(isfinite(((const double*)a->out.points)[k]));
      FUZZ_CHECK(!a->out.normals || fabs(a->out.normals[k]) <= 1.0001);
    }
  }
  for (size_t t = 0; t < a->triangles; ++t)
  {
    const int64_t* const id = a->out.connectivity + 3 * t;
    FUZZ_CHECK(id[0] != id[1] && id[1] != id[2] && id[2] != id[0]);
    for (int k = 0; k < 3; ++k)
    {
      FUZZ_CHECK(id[k] >= 0 && (size_t)id[k] < a->points);
    }
    FUZZ_CHECK(a->out.cell_ids[t] >= 0 && (size_t)a->out.cell_ids[t] < cells);
    FUZZ_CHECK(a->out.segment_ids[t] >= 0 &&
      (size_t)a->out.segment_ids[t] < s->segments + s->empty_segments);
    FUZZ_CHECK(!a->out.component_ids || (size_t)a->out.component_ids[t] < s->components);
  }
}

/* The same from a new handle on a plain host. */
static void compare(fuzz* f, const chi_grid_view* grid, const chi_fiber_params* given,
  const arrays* a, const chi_fiber_sizes* sizes)
{
  chi_fiber_params p = *given;
  chi_fiber* fiber = NULL;
  chi_fiber_sizes plain;
  p.no_skipping ^= CHI_FIBER_SKIP_BRICKS | CHI_FIBER_SKIP_RUNS;
  FUZZ_CHECK(chi_fiber_create(NULL, &fiber) == CHI_OK);
  FUZZ_CHECK(chi_fiber_extract(NULL, fiber, grid, &p) == CHI_OK);
  chi_fiber_get_sizes(fiber, &plain);
  FUZZ_CHECK(plain.points == sizes->points && plain.triangles == sizes->triangles);
  FUZZ_CHECK(plain.crossed == sizes->crossed && plain.components == sizes->components);
  const arrays b = new_arrays(f, &plain, &p);
  FUZZ_CHECK(chi_fiber_write(NULL, fiber, &b.out) == CHI_OK);
  FUZZ_CHECK(memcmp(a->out.points, b.out.points, 3 * a->points * sizeof(double)) == 0);
  FUZZ_CHECK(
    memcmp(a->out.connectivity, b.out.connectivity, 3 * a->triangles * sizeof(int64_t)) == 0);
  FUZZ_CHECK(memcmp(a->out.cell_ids, b.out.cell_ids, a->triangles * sizeof(int64_t)) == 0);
  chi_fiber_destroy(NULL, fiber);
}

/* What the lines enclose, refused where one is open. */
static void use_enclosed(
  fuzz* f, const chi_exec* exec, chi_fiber* fiber, const chi_array_view* in, size_t cells)
{
  chi_fiber_enclosed_sizes plain;
  fuzz_before(f);
  const chi_status status = chi_fiber_enclose(exec, fiber, &plain);
  FUZZ_CHECK((plain.open_segments > 0) == (status == CHI_ERROR_INVALID_ARGUMENT));
  if (status != CHI_OK)
  {
    fuzz_after(f, plain.open_segments > 0 ? CHI_OK : status);
    return;
  }
  const size_t stride = in->components * chi_type_size(in->type);
  double* const points = (double*)fuzz_new(f, 3 * plain.points * sizeof(double));
  int64_t* const ids = (int64_t*)fuzz_new(f, 4 * plain.cells * sizeof(int64_t));
  int64_t* const from = (int64_t*)fuzz_new(f, plain.cells * sizeof(int64_t));
  const chi_fiber_enclosed_outputs out = { .struct_size = sizeof out,
    .points = points,
    .point_type = CHI_F64,
    .connectivity = ids,
    .cell_ids = from };
  FUZZ_CHECK(chi_fiber_enclosed_write(NULL, fiber, &out) == CHI_OK);
  FUZZ_CHECK(chi_fiber_enclosed_attribute(
               NULL, fiber, in, fuzz_new(f, plain.points * stride), stride) == CHI_OK);
  for (size_t i = 0; i < 3 * plain.points; ++i)
  {
    FUZZ_CHECK(isfinite(points[i]));
  }
  for (size_t i = 0; i < 4 * plain.cells; ++i)
  {
    FUZZ_CHECK(ids[i] >= 0 && (size_t)ids[i] < plain.points);
    FUZZ_CHECK(from[i / 4] >= 0 && (size_t)from[i / 4] < cells);
  }
}

static void use(fuzz* f, const chi_exec* exec, const chi_fiber* fiber, const chi_grid_view* grid,
  const chi_fiber_params* p, size_t cells)
{
  chi_fiber_sizes sizes;
  chi_fiber_get_sizes(fiber, &sizes);
  const arrays a = new_arrays(f, &sizes, p);
  fuzz_before(f);
  chi_status status = chi_fiber_write(exec, fiber, &a.out);
  fuzz_after(f, status);
  if (status == CHI_OK)
  {
    check_arrays(&a, &sizes, cells);
    compare(f, grid, p, &a, &sizes);
  }
  const chi_array_view* const in = p->fields[fuzz_byte(f) & 1];
  const size_t stride = in->components * chi_type_size(in->type);
  void* const carried = fuzz_new(f, sizes.points * stride);
  fuzz_before(f);
  status = chi_fiber_attribute(exec, fiber, in, carried, stride);
  fuzz_after(f, status);
  uint8_t* const mask = (uint8_t*)fuzz_new(f, cells);
  fuzz_before(f);
  status = chi_fiber_mask(exec, fiber, mask);
  fuzz_after(f, status);
  for (size_t c = 0; c < cells && status == CHI_OK; ++c)
  {
    FUZZ_CHECK(mask[c] <= 1);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  const chi_grid_view grid = fuzz_grid(f);
  const chi_exec exec = fuzz_host(f, 100000);
  chi_grid_counts counts;
  const chi_status counted = chi_grid_count(NULL, &grid, &counts);
  chi_fiber* fiber = NULL;
  chi_status made;
  do /* a host that refuses once gives the second time */
  {
    made = chi_fiber_create(&exec, &fiber);
  } while (made == CHI_ERROR_OUT_OF_MEMORY);
  FUZZ_CHECK(made == CHI_OK);
  const size_t points = counts.points < 100000 ? counts.points : 0;
  const chi_array_view fields[2] = { fuzz_array(f, points, 1 + fuzz_upto(f, 1), CHI_F64),
    fuzz_array(f, points, 1, (chi_type)(1 + fuzz_upto(f, 9))) };
  const size_t kept = f->kept_count;
  const int rounds = 1 + (int)fuzz_upto(f, 2);
  for (int i = 0; i < rounds; ++i)
  {
    const unsigned second = fuzz_byte(f) & 1;
    const chi_fiber_params p = { .struct_size = fuzz_size(f, sizeof p),
      .fields = { &fields[0], &fields[second] },
      .components = { (int32_t)fuzz_upto(f, 2) - 1, (int32_t)fuzz_upto(f, 1) - 1 },
      .fields_version = fuzz_byte(f) & 1 ? 1 + second : 0,
      .polygon = any_polygon(f),
      .split_corners = fuzz_byte(f) & 1,
      .no_normals = fuzz_byte(f) & 1,
      .find_components = fuzz_byte(f) & 1,
      .no_skipping = (int32_t)fuzz_upto(f, 7),
      .minimum_area = fuzz_once_in(f, 4) ? fuzz_any(f) : 0 };
    fuzz_before(f);
    const chi_status status = chi_fiber_extract(&exec, fiber, &grid, &p);
    fuzz_after(f, status);
    if (status == CHI_OK)
    {
      FUZZ_CHECK(counted == CHI_OK);
      use(f, &exec, fiber, &grid, &p, counts.cells);
      use_enclosed(f, &exec, fiber, p.fields[0], counts.cells);
    }
    else
    {
      chi_fiber_sizes sizes;
      chi_fiber_get_sizes(fiber, &sizes);
      FUZZ_CHECK(sizes.points == 0 && sizes.triangles == 0);
      FUZZ_CHECK(chi_fiber_mask(NULL, fiber, (uint8_t*)fuzz_new(f, 1)) == CHI_ERROR_NOT_READY);
    }
    fuzz_before(f);
  }
  chi_fiber_destroy(&exec, fiber);
  fuzz_forget(f, kept);
  fuzz_end(f);
  return 0;
}
