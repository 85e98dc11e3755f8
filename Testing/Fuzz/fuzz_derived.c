/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Derivatives of any field on any grid: refused where the header says so, else every point has its
 * values or is counted as one that has none, the same on every host. */

#include "fuzz_grids.h"

#include <chiaroscuro/chi_derived.h>

static chi_derived_arrays new_arrays(fuzz* f, size_t points, chi_type type, unsigned wanted)
{
  const size_t bytes = points * (type == CHI_F32 ? sizeof(float) : sizeof(double));
  chi_derived_arrays a = { .struct_size = sizeof a, .type = type };
  void** const all[4] = { &a.gradient_magnitude, &a.second_derivative, &a.laplacian,
    &a.mean_curvature };
  for (int k = 0; k < 4; ++k)
  {
    *all[k] = wanted >> k & 1 ? fuzz_new(f, bytes) : NULL;
  }
  return a;
}

static double value_of(const void* at, chi_type type, size_t i)
{
  return type == CHI_F32 ? (double)((const float*)at)[i] : ((const double*)at)[i];
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  const chi_grid_view grid = fuzz_grid(f);
  const chi_exec exec = fuzz_host(f, 100000);
  const chi_grid_counts counts = fuzz_counts(&grid);
  const size_t points = counts.points < 100000 ? counts.points : 0;
  const chi_array_view values =
    fuzz_array(f, points, 1 + fuzz_upto(f, 1), (chi_type)(1 + fuzz_upto(f, 9)));
  const int rounds = 1 + (int)fuzz_upto(f, 2);
  const size_t kept = f->kept_count;
  for (int i = 0; i < rounds; ++i)
  {
    const chi_derived_params p = { .struct_size = fuzz_size(f, sizeof p),
      .order = fuzz_once_in(f, 32) ? (int32_t)fuzz_byte(f) : (fuzz_byte(f) & 1 ? 4 : 2),
      .component = (int32_t)fuzz_upto(f, 2) - 1 };
    const chi_type type = fuzz_byte(f) & 1 ? CHI_F32 : CHI_F64;
    const unsigned wanted = 15 - (unsigned)fuzz_upto(f, 15);
    const chi_derived_arrays a = new_arrays(f, points, type, wanted);
    const chi_derived_arrays b = new_arrays(f, points, type, wanted);
    chi_derived_counts c, plain;
    fuzz_before(f);
    const chi_status status = chi_derived_compute(&exec, &grid, &values, &p, &a, &c);
    fuzz_after(f, status);
    if (status != CHI_OK)
    {
      fuzz_forget(f, kept);
      continue;
    }
    FUZZ_CHECK(c.points == points && c.bad_axis == -1);
    FUZZ_CHECK(chi_derived_compute(NULL, &grid, &values, &p, &b, &plain) == CHI_OK);
    FUZZ_CHECK(c.non_finite_points == plain.non_finite_points &&
      c.undetermined_points == plain.undetermined_points && c.flat_points == plain.flat_points);
    FUZZ_CHECK(c.non_finite_points + c.undetermined_points <= points && c.range[0] <= c.range[1]);
    const size_t size = type == CHI_F32 ? sizeof(float) : sizeof(double);
    const void* const ours[4] = { a.gradient_magnitude, a.second_derivative, a.laplacian,
      a.mean_curvature };
    const void* const others[4] = { b.gradient_magnitude, b.second_derivative, b.laplacian,
      b.mean_curvature };
    for (int k = 0; k < 4; ++k)
    {
      size_t missing = 0;
      FUZZ_CHECK(!ours[k] || memcmp(ours[k], others[k], points * size) == 0);
      for (size_t n = 0; n < points && ours[k]; ++n)
      {
        const double x = value_of(ours[k], type, n);
        missing += x != x;
        FUZZ_CHECK(k != 0 || !(x < 0));
      }
      FUZZ_CHECK(k != 0 || missing <= c.non_finite_points + c.undetermined_points);
    }
    fuzz_forget(f, kept);
  }
  fuzz_before(f);
  fuzz_end(f);
  return 0;
}
