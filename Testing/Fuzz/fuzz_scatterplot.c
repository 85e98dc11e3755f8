/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous scatterplots of any grid, fields, weights, windows and options: refused where the
 * header says so, else masses that add up, the same on every host and after whatever the handle has
 * seen. */

#include "fuzz_grids.h"

#include <chiaroscuro/chi_scatterplot.h>

static chi_scatterplot_params any_params(fuzz* f)
{
  chi_scatterplot_params p = { .struct_size = fuzz_size(f, sizeof p),
    .bins = { 1 + fuzz_upto(f, 20), 1 + fuzz_upto(f, 20) },
    .automatic_range = fuzz_byte(f) & 1,
    .method = fuzz_once_in(f, 8) ? CHI_SCATTERPLOT_PUBLISHED : CHI_SCATTERPLOT_EXACT,
    .switches = fuzz_once_in(f, 2) ? (uint32_t)fuzz_upto(f, 31) : 0,
    .trilinear_tolerance = fuzz_once_in(f, 3) ? fabs(fuzz_any(f)) / 64 : 0,
    .trilinear_levels = 1 + (int32_t)fuzz_upto(f, 2), /* 8^3 parts a cell at most */
    .splat_size = fuzz_once_in(f, 3) ? fuzz_mostly(f, (double)fuzz_byte(f) / 255) : 0 };
  for (int k = 0; k < 2; ++k)
  {
    p.range[k][0] = fuzz_mostly(f, fuzz_unit(f));
    p.range[k][1] = fuzz_mostly(f, p.range[k][0] + fabs(fuzz_unit(f)));
  }
  if (fuzz_once_in(f, 64)) /* one thing that is wrong, or too large for what the host gives */
  {
    switch (fuzz_upto(f, 3))
    {
      case 0:
        p.bins[fuzz_upto(f, 1)] = (size_t)fuzz_bits(f, 8);
        break;
      case 1:
        p.method = (int32_t)fuzz_bits(f, 4);
        break;
      case 2:
        p.switches = (uint32_t)fuzz_bits(f, 4);
        break;
      default:
        p.trilinear_levels = -(int32_t)fuzz_byte(f);
        break;
    }
  }
  return p;
}

static void check(const chi_scatterplot_input* in, const chi_scatterplot_params* p,
  const double* density, const chi_scatterplot_result* r, size_t cells)
{
  const size_t n = p->bins[0] * p->bins[1];
  const double width = (r->range[0][1] - r->range[0][0]) / (double)p->bins[0];
  const double height = (r->range[1][1] - r->range[1][0]) / (double)p->bins[1];
  double sum = 0, peak = 0, least = 0;
  FUZZ_CHECK(r->range[0][0] < r->range[0][1] && r->range[1][0] < r->range[1][1]);
  FUZZ_CHECK(r->dimension == 0 ||
    r->cells + r->skipped_cells + r->ghost_cells + r->blanked_cells + r->lower_dimensional_cells +
        r->unsupported_cells <=
      cells); /* those that collapse to nothing are none of these */
  FUZZ_CHECK(r->splat_bound >= 0 && (r->splats > 0 || r->splat_bound == 0));
  FUZZ_CHECK(r->capped_cells <= r->subdivided_cells && r->subdivided_cells <= r->cells);
  for (size_t i = 0; i < n; ++i)
  {
    FUZZ_CHECK(density[i] == density[i]);
    sum += density[i] * width * height;
    peak = fmax(peak, density[i]);
    least = fmin(least, density[i]);
  }
  if (in->weight.data || p->method == CHI_SCATTERPLOT_PUBLISHED)
  {
    return; /* of both signs, or not conserved */
  }
  FUZZ_CHECK(least >= -1e-10 * peak);
  FUZZ_CHECK(r->total_mass >= 0 && r->singular_mass <= r->total_mass * (1 + 1e-12));
  FUZZ_CHECK(r->splat_bound <= 2 * r->total_mass * (1 + 1e-12));
  /* areas of bins, densities and their products may leave the range of double */
  const int is_tame = width * height > 1e-200 && width * height < 1e200 && r->total_mass > 1e-80 &&
    r->total_mass < 1e80;
  FUZZ_CHECK(!is_tame || fabs(sum + r->mass_out_of_range - r->total_mass) <= 1e-12 * r->total_mass);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  const chi_grid_view grid = fuzz_grid(f);
  const chi_exec exec = fuzz_host(f, 100000);
  const chi_grid_counts counts = fuzz_counts(&grid);
  chi_scatterplot* plot = NULL;
  chi_status made;
  do /* a host that refuses once gives the second time */
  {
    made = chi_scatterplot_create(&exec, &plot);
  } while (made == CHI_ERROR_OUT_OF_MEMORY);
  FUZZ_CHECK(made == CHI_OK);
  const size_t of[2] = { counts.points < 100000 ? counts.points : 0,
    counts.cells < 100000 ? counts.cells : 0 };
  const int32_t cells = fuzz_once_in(f, 4), weight_cells = fuzz_byte(f) & 1;
  chi_scatterplot_input in = { .struct_size = fuzz_size(f, sizeof in),
    .grid = &grid,
    .fields = { fuzz_array(f, of[cells], 1 + fuzz_upto(f, 1), CHI_F64),
      fuzz_array(f, of[cells], 1, (chi_type)(1 + fuzz_upto(f, 9))) },
    .components = { (int32_t)fuzz_upto(f, 2) - 1, (int32_t)fuzz_upto(f, 1) - 1 },
    .association = cells,
    .weight_association = weight_cells };
  if (fuzz_once_in(f, 3))
  {
    in.weight = fuzz_array(f, of[weight_cells], 1, CHI_F64);
  }
  for (int a = 0; a < 3; ++a)
  {
    in.first_index[a] = (int64_t)fuzz_unit(f);
  }
  in.first_cell = fuzz_once_in(f, 8) ? (int64_t)fuzz_bits(f, 8) : (int64_t)fuzz_byte(f);
  const size_t kept = f->kept_count;
  const int rounds = 1 + (int)fuzz_upto(f, 2);
  for (int i = 0; i < rounds; ++i)
  {
    if (fuzz_once_in(f, 3)) /* one array twice */
    {
      in.fields[1] = in.fields[0];
      ++f->versions;
    }
    in.version = fuzz_byte(f) & 1 ? 1 + f->versions : 0;
    const chi_scatterplot_params p = any_params(f);
    const int is_small = p.bins[0] <= 4096 && p.bins[1] <= 4096;
    double* const density = (double*)fuzz_new(f, is_small ? p.bins[0] * p.bins[1] * 8 : 8);
    chi_scatterplot_result r;
    if (!is_small && p.bins[0] <= 32768 && p.bins[1] <= 32768)
    {
      continue; /* legal perhaps, and too much memory for this */
    }
    fuzz_before(f);
    const chi_status status = chi_scatterplot_compute(&exec, plot, &in, &p, density, &r);
    fuzz_after(f, status);
    if (status == CHI_OK && p.struct_size == sizeof p && in.struct_size == sizeof in)
    {
      check(&in, &p, density, &r, counts.cells);
      chi_scatterplot* other = NULL;
      chi_scatterplot_result plain;
      double* const again = (double*)fuzz_new(f, p.bins[0] * p.bins[1] * 8);
      FUZZ_CHECK(chi_scatterplot_create(NULL, &other) == CHI_OK);
      FUZZ_CHECK(chi_scatterplot_compute(NULL, other, &in, &p, again, &plain) == CHI_OK);
      FUZZ_CHECK(memcmp(density, again, p.bins[0] * p.bins[1] * 8) == 0);
      FUZZ_CHECK(plain.total_mass == r.total_mass && plain.splat_bound == r.splat_bound &&
        plain.simplices == r.simplices && plain.mass_out_of_range == r.mass_out_of_range);
      chi_scatterplot_destroy(other);
    }
    else if (status != CHI_OK && f->refused + f->cancelled == 0)
    {
      FUZZ_CHECK(chi_scatterplot_compute(NULL, plot, &in, &p, density, &r) == status);
    }
    fuzz_before(f);
  }
  fuzz_before(f);
  chi_scatterplot_destroy(plot);
  fuzz_forget(f, kept);
  fuzz_end(f);
  return 0;
}
