/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous histograms of any grid, field and range: refused where the header says so, else masses
 * that add up, moments and quantiles within the values, the same on every host and after whatever
 * the handle has seen. */

#include "fuzz_grids.h"

#include <chiaroscuro/chi_histogram.h>

static chi_histogram_outputs new_outputs(fuzz* f, size_t bins)
{
  return (chi_histogram_outputs){ .struct_size = sizeof(chi_histogram_outputs),
    .centers = (double*)fuzz_new(f, bins * sizeof(double)),
    .mass = (double*)fuzz_new(f, bins * sizeof(double)),
    .density = (double*)fuzz_new(f, bins * sizeof(double)),
    .iso_area = (double*)fuzz_new(f, bins * sizeof(double)),
    .cumulative = (double*)fuzz_new(f, bins * sizeof(double)) };
}

static void check(const chi_histogram* h, const chi_histogram_params* p,
  const chi_histogram_outputs* o, const chi_histogram_result* r, size_t cells)
{
  double sum = r->mass_below + r->mass_above;
  FUZZ_CHECK(r->range[0] < r->range[1] && r->total_mass >= 0 && r->total_area >= 0);
  FUZZ_CHECK(r->dimension == 0 ||
    r->cells + r->skipped_cells + r->ghost_cells + r->blanked_cells + r->lower_dimensional_cells +
        r->unsupported_cells <=
      cells); /* those that collapse to nothing are none of these */
  for (size_t i = 0; i < p->bins; ++i)
  {
    FUZZ_CHECK(o->mass[i] >= -1e-13 * r->total_mass && o->iso_area[i] == o->iso_area[i]);
    FUZZ_CHECK(o->centers[i] >= r->range[0] && o->centers[i] <= r->range[1]);
    FUZZ_CHECK(i == 0 || o->cumulative[i] >= o->cumulative[i - 1] - 1e-13 * r->total_mass);
    sum += o->mass[i];
  }
  FUZZ_CHECK(fabs(sum - r->total_mass) <= 1e-12 * r->total_mass);
  double moment;
  FUZZ_CHECK(chi_histogram_moment(h, r->moments + 1, &moment) == CHI_ERROR_INVALID_ARGUMENT);
  FUZZ_CHECK(chi_histogram_moment(h, 1, &moment) == CHI_OK);
  if (r->total_mass > 0)
  {
    const double low = r->field_range[0], high = r->field_range[1],
                 size = fmax(fabs(low), fabs(high));
    FUZZ_CHECK(low <= high && r->mean >= low - 1e-13 * size && r->mean <= high + 1e-13 * size);
    FUZZ_CHECK(r->central_moments[2] >= 0 || !isfinite(high - low));
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  const chi_grid_view grid = fuzz_grid(f);
  const chi_exec exec = fuzz_host(f, 100000);
  const chi_grid_counts counts = fuzz_counts(&grid);
  chi_histogram* h = NULL;
  chi_status made;
  do /* a host that refuses once gives the second time */
  {
    made = chi_histogram_create(&exec, &h);
  } while (made == CHI_ERROR_OUT_OF_MEMORY);
  FUZZ_CHECK(made == CHI_OK);
  const size_t of[2] = { counts.points < 100000 ? counts.points : 0,
    counts.cells < 100000 ? counts.cells : 0 };
  const int32_t cells = fuzz_once_in(f, 4);
  const chi_array_view field =
    fuzz_array(f, of[cells], 1 + fuzz_upto(f, 1), (chi_type)(1 + fuzz_upto(f, 9)));
  const int rounds = 1 + (int)fuzz_upto(f, 2);
  const size_t kept = f->kept_count;
  for (int i = 0; i < rounds; ++i)
  {
    chi_histogram_params p = { .struct_size = fuzz_size(f, sizeof p),
      .field = &field,
      .component = (int32_t)fuzz_upto(f, 2) - 1,
      .association = fuzz_once_in(f, 64) ? (int32_t)fuzz_byte(f) : cells,
      .field_version = fuzz_byte(f) & 1,
      .bins = fuzz_once_in(f, 64) ? (size_t)fuzz_bits(f, 8) : 1 + fuzz_upto(f, 40),
      .automatic_range = fuzz_byte(f) & 1,
      .moments = fuzz_once_in(f, 4) ? (int32_t)fuzz_upto(f, 9) : 0,
      .no_skipping = (int32_t)fuzz_upto(f, 7) };
    p.range[0] = fuzz_mostly(f, fuzz_unit(f));
    p.range[1] = fuzz_mostly(f, p.range[0] + fabs(fuzz_unit(f)));
    const int is_small = p.bins <= 4096;
    if (!is_small && p.bins <= 1 << 20)
    {
      continue; /* legal, and slow */
    }
    const chi_histogram_outputs out = new_outputs(f, is_small ? p.bins : 1);
    chi_histogram_result r, plain;
    fuzz_before(f);
    chi_status status = chi_histogram_compute(&exec, h, &grid, &p, &out);
    fuzz_after(f, status);
    if (status != CHI_OK || p.struct_size != sizeof p)
    {
      double quantile;
      fuzz_before(f);
      FUZZ_CHECK(status == CHI_OK || chi_histogram_moment(h, 0, &quantile) != CHI_ERROR_EMPTY);
      fuzz_forget(f, kept);
      continue;
    }
    chi_histogram_get_result(h, &r);
    check(h, &p, &out, &r, counts.cells);
    chi_histogram* other = NULL;
    const chi_histogram_outputs again = new_outputs(f, p.bins);
    FUZZ_CHECK(chi_histogram_create(NULL, &other) == CHI_OK);
    FUZZ_CHECK(chi_histogram_compute(NULL, other, &grid, &p, &again) == CHI_OK);
    chi_histogram_get_result(other, &plain);
    FUZZ_CHECK(memcmp(out.mass, again.mass, p.bins * sizeof(double)) == 0);
    FUZZ_CHECK(memcmp(out.iso_area, again.iso_area, p.bins * sizeof(double)) == 0);
    FUZZ_CHECK(plain.total_mass == r.total_mass && plain.cells == r.cells);
    double last = -INFINITY;
    for (int k = 0; k < 3; ++k)
    {
      const double share = (double[]){ 0, 0.3, 1 }[k];
      double quantile, expected;
      fuzz_before(f);
      status = chi_histogram_quantile(&exec, h, share, &quantile);
      if (status == CHI_ERROR_EMPTY)
      {
        FUZZ_CHECK(!(r.total_mass > 0));
        break;
      }
      fuzz_after(f, status);
      FUZZ_CHECK(chi_histogram_quantile(NULL, other, share, &expected) == CHI_OK);
      if (status == CHI_OK)
      {
        FUZZ_CHECK(memcmp(&quantile, &expected, sizeof expected) == 0);
        FUZZ_CHECK(
          quantile >= last && quantile >= r.field_range[0] && quantile <= r.field_range[1]);
        last = quantile;
      }
    }
    chi_histogram_destroy(NULL, other);
    fuzz_forget(f, kept);
  }
  fuzz_before(f);
  chi_histogram_destroy(&exec, h);
  fuzz_end(f);
  return 0;
}
