/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#define _POSIX_C_SOURCE 200809L /* setenv */

/* Fields from derivatives under hostile hosts and callers. */

#include "derived_fields.h"

static const double straight[12] = { 0.07, 0, 0, -0.4, 0, 0.11, 0, 0.2, 0, 0, 0.05, 0.1 };

/* One grid of each kind over the same points. */
typedef struct kinds
{
  derived d;
  chi_grid_view view[4];
  double* axis[3];
  uint8_t* types;
  int64_t *ids, *offsets;
} kinds;

static kinds make_kinds(size_t nx, size_t ny, size_t nz)
{
  kinds k = { .d = make_image(nx, ny, nz, straight) };
  const size_t n[3] = { nx, ny, nz };
  sample(&k.d, waves);
  chi_grid_view* const v = k.view;
  v[CHI_GRID_IMAGE] = v[CHI_GRID_RECTILINEAR] = v[CHI_GRID_CURVILINEAR] = k.d.view;
  v[CHI_GRID_RECTILINEAR].kind = CHI_GRID_RECTILINEAR;
  v[CHI_GRID_CURVILINEAR].kind = CHI_GRID_CURVILINEAR;
  for (int a = 0; a < 3; ++a)
  {
    k.axis[a] = derived_room(n[a] * sizeof(double));
    for (size_t i = 0; i < n[a]; ++i)
    {
      k.axis[a][i] = straight[5 * a] * (double)i + straight[4 * a + 3];
    }
    v[CHI_GRID_RECTILINEAR].axes[a] =
      (chi_array_view){ k.axis[a], n[a], 1, sizeof(double), CHI_F64 };
  }
  v[CHI_GRID_CURVILINEAR].points =
    (chi_vec3_view){ k.d.x, k.d.points, 3 * sizeof(double), CHI_F64 };
  const size_t cells = (nx - 1) * (ny - 1) * (nz - 1);
  k.types = derived_room(cells);
  k.ids = derived_room(8 * cells * sizeof(int64_t));
  k.offsets = derived_room((cells + 1) * sizeof(int64_t));
  for (size_t c = 0; c <= cells; ++c)
  {
    k.offsets[c] = (int64_t)(8 * c);
    const size_t row = c / (nx - 1);
    const size_t first = c % (nx - 1) + nx * (row % (ny - 1)) + nx * ny * (row / (ny - 1));
    for (size_t i = 0; i < 8 && c < cells; ++i)
    {
      k.types[c] = 12;
      k.ids[8 * c + i] =
        (int64_t)(first + ((i + 1) >> 1 & 1) + (i >> 1 & 1) * nx + (i >> 2) * nx * ny);
    }
  }
  v[CHI_GRID_UNSTRUCTURED] = (chi_grid_view){ .struct_size = sizeof *v,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = v[CHI_GRID_CURVILINEAR].points,
    .cell_types = k.types,
    .offsets = k.offsets,
    .connectivity = k.ids,
    .cell_count = cells,
    .connectivity_count = 8 * cells };
  return k;
}

static void free_kinds(kinds* k)
{
  for (int a = 0; a < 3; ++a)
  {
    free(k->axis[a]);
  }
  free(k->types);
  free(k->ids);
  free(k->offsets);
  free_derived(&k->d);
}

static void any_schedule_gives_the_same_bits(void)
{
  kinds k = make_kinds(19, 70, 41);
  const chi_exec backwards = { .struct_size = sizeof backwards,
    .parallel_for = chi_test_backwards };
  double* const expected = derived_room(ALL * k.d.points * sizeof(double));
  for (int kind = 0; kind < 4; ++kind)
  {
    for (int order = 2; order <= 4; order += 2)
    {
      for (chi_type type = CHI_F32; type <= CHI_F64; ++type)
      {
        const size_t bytes = k.d.points * chi_type_size(type);
        const chi_array_view values = derived_values(&k.d);
        const chi_derived_params params = { sizeof params, order, 0 };
        chi_derived_arrays arrays = derived_arrays(&k.d);
        arrays.type = type;
        chi_derived_counts counts, again;
        CHECK(
          chi_derived_compute(NULL, &k.view[kind], &values, &params, &arrays, &counts) == CHI_OK);
        for (int q = 0; q < ALL; ++q)
        {
          memcpy((char*)expected + (size_t)q * bytes, k.d.out[q], bytes);
          memset(k.d.out[q], 255, bytes);
        }
        CHECK(chi_derived_compute(&backwards, &k.view[kind], &values, &params, &arrays, &again) ==
          CHI_OK);
        for (int q = 0; q < ALL; ++q)
        {
          CHECK(memcmp((char*)expected + (size_t)q * bytes, k.d.out[q], bytes) == 0);
        }
        CHECK(memcmp(&counts, &again, sizeof counts) == 0);
      }
    }
  }
  free(expected);
  free_kinds(&k);
}

/* Nothing is fused, and roots and quotients are rounded alike everywhere. */
static void any_instruction_set_gives_the_same_bits(void)
{
  static const char* const sets[] = { "generic", "avx2", "avx512" };
  kinds k = make_kinds(37, 9, 8);
  double* const expected = derived_room(ALL * k.d.points * sizeof(double));
  for (int kind = 0; kind < 4; ++kind)
  {
    for (chi_type type = CHI_F32; type <= CHI_F64; ++type)
    {
      float* const single = derived_room(k.d.points * sizeof(float));
      for (size_t i = 0; i < k.d.points; ++i)
      {
        single[i] = (float)k.d.values[i];
      }
      const chi_array_view values = { single, k.d.points, 1, sizeof(float), CHI_F32 };
      chi_derived_arrays arrays = derived_arrays(&k.d);
      arrays.type = type;
      const size_t bytes = k.d.points * chi_type_size(type);
      for (int s = 0; s < 3; ++s)
      {
        setenv("CHIAROSCURO_ISA", sets[s], 1);
        CHECK(
          chi_derived_compute(NULL, &k.view[kind], &values, NULL, &arrays, &k.d.counts) == CHI_OK);
        for (int q = 0; q < ALL; ++q)
        {
          char* const at = (char*)expected + (size_t)q * bytes;
          CHECK(s == 0 || memcmp(at, k.d.out[q], bytes) == 0);
          memcpy(at, k.d.out[q], bytes);
        }
      }
      free(single);
    }
  }
  unsetenv("CHIAROSCURO_ISA");
  free(expected);
  free_kinds(&k);
}

/* Each array alone is what it is among the others; the others are left alone. */
static void arrays_do_not_depend_on_each_other(void)
{
  kinds k = make_kinds(9, 8, 7);
  double* const alone = derived_room(k.d.points * sizeof(double));
  for (int kind = 0; kind < 4; ++kind)
  {
    k.d.view = k.view[kind];
    CHECK(run_derived(&k.d, NULL) == CHI_OK);
    for (int q = 0; q < ALL; ++q)
    {
      chi_derived_arrays arrays = { .struct_size = sizeof arrays, .type = CHI_F64 };
      void** const place[ALL] = { &arrays.gradient_magnitude, &arrays.second_derivative,
        &arrays.laplacian, &arrays.mean_curvature };
      *place[q] = alone;
      const chi_array_view values = derived_values(&k.d);
      CHECK(
        chi_derived_compute(NULL, &k.view[kind], &values, NULL, &arrays, &k.d.counts) == CHI_OK);
      CHECK(memcmp(alone, k.d.out[q], k.d.points * sizeof(double)) == 0);
    }
  }
  free(alone);
  free_kinds(&k);
}

/* The points of an image are those of the other kinds, up to rounding. */
static void structured_kinds_agree(void)
{
  kinds k = make_kinds(9, 8, 7);
  double* const image = derived_room(ALL * k.d.points * sizeof(double));
  for (int kind = CHI_GRID_IMAGE; kind <= CHI_GRID_CURVILINEAR; ++kind)
  {
    k.d.view = k.view[kind];
    k.d.params.order = 4;
    CHECK(run_derived(&k.d, NULL) == CHI_OK);
    double worst = 0;
    for (size_t i = 0; i < ALL * k.d.points; ++i)
    {
      const size_t at = i % k.d.points, x = at % 9, y = at / 9 % 8, z = at / 72;
      const double value = k.d.out[i / k.d.points][at];
      if (kind == CHI_GRID_IMAGE)
      {
        image[i] = value;
      }
      /* inside: unevenly spaced second derivatives take another sample, whose weight is 0 here */
      else if (x > 1 && x < 6 && y > 1 && y < 5 && z > 1 && z < 4)
      {
        worst = fmax(worst, fabs(value - image[i]));
      }
    }
    CHECK_NEAR(worst, 0, 1e-9); /* rounding: eps / h^2 */
  }
  free(image);
  free_kinds(&k);
}

static void refused_memory_is_reported_and_given_back(void)
{
  kinds k = make_kinds(9, 40, 40);
  for (int kind = 0; kind < 4; ++kind)
  {
    k.d.view = k.view[kind];
    chi_test_host host = { .refuse_at = -1, .cancel_at = 1L << 40 };
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release,
      .is_cancelled = chi_test_is_cancelled };
    CHECK(run_derived(&k.d, &exec) == CHI_OK && host.live == 0 && host.allocations > 2);
    const long allocations = host.allocations, polls = host.polls;
    for (long i = 0; i < allocations; ++i)
    {
      host = (chi_test_host){ .refuse_at = i, .cancel_at = 1L << 40 };
      CHECK(run_derived(&k.d, &exec) == CHI_ERROR_OUT_OF_MEMORY && host.live == 0);
    }
    for (long i = 0; i < polls; i += 1 + polls / 20)
    {
      host = (chi_test_host){ .refuse_at = -1, .cancel_at = i };
      CHECK(run_derived(&k.d, &exec) == CHI_ERROR_CANCELLED && host.live == 0);
    }
  }
  free_kinds(&k);
}

static void nonsense_is_refused(void)
{
  kinds k = make_kinds(5, 5, 5);
  const chi_grid_view view = k.d.view;
  const chi_array_view values = derived_values(&k.d);
  const chi_derived_arrays arrays = derived_arrays(&k.d);
  const chi_derived_params params = { sizeof params, 2, 0 };
  chi_derived_counts counts;
#define REFUSED(view_, values_, params_, arrays_)                                                  \
  CHECK(chi_derived_compute(NULL, view_, values_, params_, arrays_, &counts) ==                    \
    CHI_ERROR_INVALID_ARGUMENT)
  CHECK(chi_derived_compute(NULL, &view, &values, &params, &arrays, NULL) ==
    CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(NULL, &values, &params, &arrays);
  REFUSED(&view, NULL, &params, &arrays);
  REFUSED(&view, &values, &params, NULL);
  for (int32_t order = -1; order <= 6; ++order)
  {
    const chi_derived_params p = { sizeof p, order, 0 };
    if (order != 0 && order != 2 && order != 4)
    {
      REFUSED(&view, &values, &p, &arrays);
    }
  }
  for (int32_t component = -2; component <= 1; component += 3)
  {
    const chi_derived_params p = { sizeof p, 2, component };
    REFUSED(&view, &values, &p, &arrays);
  }
  chi_derived_arrays none = { .struct_size = sizeof none, .type = CHI_F64 };
  REFUSED(&view, &values, &params, &none);
  chi_derived_arrays bytes = arrays;
  bytes.type = CHI_U8;
  REFUSED(&view, &values, &params, &bytes);
  chi_array_view few = values;
  few.count = 124;
  REFUSED(&view, &few, &params, &arrays);
  for (int a = 0; a < 3; ++a)
  {
    chi_grid_view flat = view; /* an axis of no length */
    flat.index_to_world[5 * a] = 0;
    REFUSED(&flat, &values, &params, &arrays);
    CHECK(counts.bad_axis == a && counts.points == 125);
    flat.index_to_world[5 * a] = NAN;
    REFUSED(&flat, &values, &params, &arrays);
    const double old = k.axis[a][2]; /* an axis that turns back, or stands still */
    k.axis[a][2] = k.axis[a][0];
    REFUSED(&k.view[CHI_GRID_RECTILINEAR], &values, &params, &arrays);
    CHECK(counts.bad_axis == a);
    k.axis[a][2] = NAN;
    REFUSED(&k.view[CHI_GRID_RECTILINEAR], &values, &params, &arrays);
    k.axis[a][2] = k.axis[a][1];
    REFUSED(&k.view[CHI_GRID_RECTILINEAR], &values, &params, &arrays);
    k.axis[a][2] = old;
  }
  chi_grid_view parallel = view;
  parallel.index_to_world[1] = parallel.index_to_world[0];
  parallel.index_to_world[5] = parallel.index_to_world[9] = 0;
  REFUSED(&parallel, &values, &params, &arrays);
  CHECK(counts.bad_axis == 1);
  CHECK(chi_derived_compute(NULL, &view, &values, NULL, &arrays, &counts) == CHI_OK);
  free_kinds(&k);
}

static void no_points_are_no_error(void)
{
  kinds k = make_kinds(2, 2, 2);
  chi_array_view values = derived_values(&k.d);
  values.count = 0;
  const chi_derived_arrays arrays = derived_arrays(&k.d);
  for (int kind = 0; kind < 4; ++kind)
  {
    chi_grid_view view = k.view[kind];
    view.dimensions[1] = 0;
    view.points.count = 0;
    view.cell_count = 0;
    chi_derived_counts counts;
    CHECK(chi_derived_compute(NULL, &view, &values, NULL, &arrays, &counts) == CHI_OK);
    CHECK(counts.points == 0);
  }
  free_kinds(&k);
}

/* Callers of other versions: shorter structs are refused, longer ones read as far as they are
 * known. */
static void structs_are_as_long_as_they_say(void)
{
  kinds k = make_kinds(4, 4, 4);
  const chi_array_view values = derived_values(&k.d);
  const chi_derived_arrays arrays = derived_arrays(&k.d);
  const chi_derived_params params = { sizeof params, 2, 0 };
  chi_derived_counts counts;
  for (int which = 0; which < 2; ++which)
  {
    const void* const given = which ? (const void*)&arrays : &params;
    const size_t size = which ? sizeof arrays : sizeof params;
    const size_t sizes[] = { size, size + 24, size - 8, 8, size + 24 };
    for (int i = 0; i < 5; ++i)
    {
      unsigned char* const block = calloc(1, sizes[i]); /* for the sanitizer to see */
      memcpy(block, given, sizes[i] < size ? sizes[i] : size);
      memcpy(block, &sizes[i], sizeof(size_t));
      if (i == 4)
      {
        block[sizes[i] - 1] = 1;
      }
      const chi_status status = chi_derived_compute(NULL, &k.d.view, &values,
        which ? &params : (const chi_derived_params*)(void*)block,
        which ? (const chi_derived_arrays*)(void*)block : &arrays, &counts);
      CHECK(status == (i < 2 ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT));
      free(block);
    }
  }
  free_kinds(&k);
}

int main(void)
{
  any_schedule_gives_the_same_bits();
  any_instruction_set_gives_the_same_bits();
  arrays_do_not_depend_on_each_other();
  structured_kinds_agree();
  refused_memory_is_reported_and_given_back();
  nonsense_is_refused();
  no_points_are_no_error();
  structs_are_as_long_as_they_say();
  return chi_test_report();
}
