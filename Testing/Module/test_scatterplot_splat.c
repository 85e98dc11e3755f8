/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous scatterplots with small cells deposited by their mean, against exact ones. */

#include "scatterplot_scene.h"
#include "scatterplot_waves.h"

static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };

static void bent(const double x[3], double value[2])
{
  value[0] = x[0] + 0.3 * x[1] * x[2] + 0.2 * x[0] * x[1] * x[2];
  value[1] = 0.5 * x[1] * x[1] + 0.1 * x[0] + 0.2 * x[2] + 0.4 * x[0] * x[2];
}

static void along_x(const double x[3], double value[2])
{
  value[0] = x[0];
  value[1] = 0.26 + 1e-3 * x[1];
}

static void diagonal(const double x[3], double value[2])
{
  value[0] = value[1] = x[0];
}

/* Sum of differences of masses. */
static double distance(const double* a, const double* b, const chi_scatterplot_params* p)
{
  const size_t n = p->bins[0] * p->bins[1];
  const double area = (p->range[0][1] - p->range[0][0]) * (p->range[1][1] - p->range[1][0]);
  double sum = 0;
  for (size_t i = 0; i < n; ++i)
  {
    sum += fabs(a[i] - b[i]) * area / (double)n;
  }
  return sum;
}

static void the_error_is_within_its_bound(void)
{
  static const scene_field fields[] = { bent, waves_values, along_x };
  static const size_t cells[] = { 24, 30, 20 };
  for (int k = 0; k < 3 * 2 * 3; ++k)
  {
    const int list = k / 3 % 2;
    scene* const s =
      scene_image((size_t[3]){ cells[k % 3], cells[k % 3] + 1, 24 }, zero, one, fields[k % 3]);
    if (list)
    {
      scene_to_list(s, 0);
    }
    chi_scatterplot_params params = scene_params(7, 9, 0.01, 1.52, -0.02, 1.91);
    chi_scatterplot_result exact, r;
    double* const expected = scene_plot(NULL, s, &params, &exact);
    CHECK(exact.splats == 0 && exact.splat_bound == 0);
    params.splat_size = (double[]){ 0.1, 0.4, 1 }[k / 6];
    double* const density = scene_plot(NULL, s, &params, &r);
    const double error = distance(expected, density, &params);
    CHECK(r.splats > 0 || k / 6 == 0);
    CHECK(error <= r.splat_bound + 1e-10); /* with the bound of the exact ways */
    CHECK(r.splat_bound <= 2 * r.total_mass);
    CHECK_NEAR(scene_mass_error(density, &r, 7, 9, 1), 0, 1e-12);
    CHECK(r.singular_mass == exact.singular_mass && r.mass_out_of_range == exact.mass_out_of_range);
    free(expected);
    free(density);
    scene_free(s);
  }
}

static void single_tetrahedra_are_within_their_bounds(void)
{
  uint32_t seed = 17;
  size_t splats = 0;
  for (int k = 0; k < 3000; ++k)
  {
    double f[4], g[4];
    for (int c = 0; c < 4; ++c)
    {
      f[c] = 1 + 0.8 * (pow(chi_test_random(&seed), 1 + k % 4) - 0.5);
      g[c] = 0.2 + 0.6 * chi_test_random(&seed);
    }
    chi_scatterplot_params params = scene_params(2, 2, 0, 2, 0, 2);
    chi_scatterplot_result r;
    double* const expected = scene_plot_one(f, g, 1.0 / 6, &params, NULL);
    params.splat_size = 1;
    double* const density = scene_plot_one(f, g, 1.0 / 6, &params, &r);
    CHECK(distance(expected, density, &params) <= r.splat_bound + 1e-12);
    CHECK(r.splat_bound < 1.16 * r.total_mass); /* 37 / 64 twice: the theorem of Gruenbaum */
    splats += r.splats;
    free(expected);
    free(density);
  }
  CHECK(splats > 2000);
}

static void cells_without_area_stay_exact(void)
{
  scene* const s = scene_image((size_t[3]){ 20, 20, 20 }, zero, one, diagonal);
  for (int list = 0; list < 2; ++list)
  {
    chi_scatterplot_params params = scene_params(7, 5, 0, 1, 0, 1);
    chi_scatterplot_result r;
    params.splat_size = 1;
    free(scene_plot(NULL, s, &params, &r));
    CHECK(r.splats == 0 && r.splat_bound == 0);
    CHECK_NEAR(r.singular_mass, r.total_mass, 1e-12);
    if (!list)
    {
      scene_to_list(s, 0);
    }
  }
  scene_free(s);
}

static void any_schedule_gives_the_same_bits(void)
{
  scene* const s = scene_image((size_t[3]){ 20, 13, 17 }, zero, one, bent);
  for (int way = 0; way < 3; ++way)
  {
    chi_scatterplot_params params = scene_params(6, 5, 0.1, 1.2, 0, 1.1);
    chi_scatterplot_result r, other;
    params.splat_size = 0.5;
    params.trilinear_tolerance = way == 2 ? 1e-3 : 0;
    double* const density = scene_plot(NULL, s, &params, &r);
    const chi_exec exec = { .struct_size = sizeof exec, .parallel_for = chi_test_backwards };
    double* const backwards = scene_plot(&exec, s, &params, &other);
    CHECK(memcmp(density, backwards, 30 * sizeof *density) == 0);
    CHECK(r.splats > 0 && r.splats == other.splats && r.splat_bound == other.splat_bound);
    if (way == 0)
    {
      scene_to_list(s, 0);
    }
    free(density);
    free(backwards);
  }
  scene_free(s);
}

static void nonsense_is_refused(void)
{
  scene* const s = scene_image((size_t[3]){ 2, 2, 2 }, zero, one, bent);
  double density[4];
  chi_scatterplot* plot = NULL;
  CHECK(chi_scatterplot_create(NULL, &plot) == CHI_OK);
  for (int k = 0; k < 3; ++k)
  {
    chi_scatterplot_params params = scene_params(2, 2, 0, 1, 0, 1);
    params.splat_size = (double[]){ -1, NAN, 1.5 }[k];
    CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, NULL) ==
      CHI_ERROR_INVALID_ARGUMENT);
  }
  chi_scatterplot_destroy(plot);
  scene_free(s);
}

int main(void)
{
  the_error_is_within_its_bound();
  single_tetrahedra_are_within_their_bounds();
  cells_without_area_stay_exact();
  any_schedule_gives_the_same_bits();
  nonsense_is_refused();
  return chi_test_report();
}
