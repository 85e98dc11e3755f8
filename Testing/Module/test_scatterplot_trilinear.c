/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous scatterplots of trilinear cells that are subdivided to a tolerance. */

#include "scatterplot_scene.h"

static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };

static void xy_and_z(const double x[3], double value[2])
{
  value[0] = x[0] * x[1];
  value[1] = x[2];
}

static void x_and_yz(const double x[3], double value[2])
{
  value[0] = x[0];
  value[1] = x[1] * x[2];
}

/* Trilinear terms in every cell. */
static void bent(const double x[3], double value[2])
{
  value[0] = x[0] + 0.3 * x[1] * x[2] + 0.2 * x[0] * x[1] * x[2];
  value[1] = 0.5 * x[1] * x[1] + 0.1 * x[0] + 0.2 * x[2] + 0.4 * x[0] * x[2];
}

static void tilted(const double x[3], double value[2])
{
  value[0] = x[0] + 0.5 * x[1];
  value[1] = x[1] - 0.25 * x[2];
}

/* The image as a grid of another kind, with the same points. */
enum
{
  IMAGE,
  RECTILINEAR,
  CURVILINEAR,
  VOXELS,
  HEXAHEDRA
};

static void change_kind(scene* s, int kind)
{
  const size_t* const n = s->grid.dimensions;
  static double axes[3][64];
  s->grid.version = 0;
  if (kind == IMAGE)
  {
    return;
  }
  if (kind == RECTILINEAR)
  {
    s->grid.kind = CHI_GRID_RECTILINEAR;
    size_t step = 1;
    for (size_t a = 0; a < 3; step *= n[a++])
    {
      for (size_t i = 0; i < n[a]; ++i)
      {
        axes[a][i] = s->points[3 * i * step + a];
      }
      s->grid.axes[a] = (chi_array_view){ axes[a], n[a], 1, sizeof(double), CHI_F64 };
    }
    return;
  }
  s->grid.points =
    (chi_vec3_view){ s->points, s->input.fields[0].count, 3 * sizeof(double), CHI_F64 };
  if (kind == CURVILINEAR)
  {
    s->grid.kind = CHI_GRID_CURVILINEAR;
    return;
  }
  static const int voxel[8] = { 0, 1, 2, 3, 4, 5, 6, 7 }, around[8] = { 0, 1, 3, 2, 4, 5, 7, 6 };
  const size_t cells = (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  s->offsets = (int64_t*)malloc((cells + 1) * sizeof(int64_t));
  s->ids = (int64_t*)malloc(8 * cells * sizeof(int64_t));
  s->types = (uint8_t*)malloc(cells);
  s->offsets[0] = 0;
  for (size_t c = 0; c < cells; ++c)
  {
    const size_t at[3] = { c % (n[0] - 1), c / (n[0] - 1) % (n[1] - 1),
      c / (n[0] - 1) / (n[1] - 1) };
    for (size_t k = 0; k < 8; ++k)
    {
      const size_t b = (size_t)(kind == VOXELS ? voxel : around)[k];
      s->ids[8 * c + k] =
        (int64_t)(at[0] + (b & 1) + n[0] * (at[1] + (b >> 1 & 1) + n[1] * (at[2] + (b >> 2))));
    }
    s->types[c] = kind == VOXELS ? 11 : 12;
    s->offsets[c + 1] = (int64_t)(8 * (c + 1));
  }
  s->grid.kind = CHI_GRID_UNSTRUCTURED;
  s->grid.cell_types = s->types;
  s->grid.offsets = s->offsets;
  s->grid.connectivity = s->ids;
  s->grid.cell_count = cells;
  s->grid.connectivity_count = 8 * cells;
}

static void product_in_one_cell_is_within_the_tolerance(void)
{
  /* of x y in the unit cube less than u is u - u log u */
  static const double tolerances[] = { 0.3, 0.2, 0.05, 0.01, 1e-3, 2.5e-4 };
  static const size_t levels[] = { 0, 1, 2, 3, 4, 5 }; /* B is 1/4: (1) of the source */
  const size_t bins = 1024;
  double last = 1;
  for (int k = 0; k < 2 * 6; ++k)
  {
    scene* const s = scene_image((size_t[3]){ 1, 1, 1 }, zero, one, xy_and_z);
    change_kind(s, k % 2 ? HEXAHEDRA : IMAGE);
    chi_scatterplot_params params = scene_params(bins, 4, 0, 1, 0, 1);
    chi_scatterplot_result r;
    params.trilinear_tolerance = tolerances[k / 2];
    params.trilinear_levels = 6;
    double* const density = scene_plot(NULL, s, &params, &r);
    const size_t parts = (size_t)1 << 3 * levels[k / 2];
    CHECK(r.simplices == 6 * parts && r.capped_cells == 0 && r.subdivided_cells == (parts > 1));
    CHECK(r.edge_simplices + r.one_bin_simplices + r.section_simplices == r.simplices);
    CHECK_NEAR(scene_mass_error(density, &r, bins, 4, 1), 0, 1e-12);
    double below = 0, moved = 0;
    for (size_t i = 0; i < bins; ++i)
    {
      const double u = (double)(i + 1) / (double)bins;
      for (size_t j = 0; j < 4; ++j)
      {
        below += density[j * bins + i] / (double)(4 * bins);
      }
      moved += fabs(below - (u - u * log(u))) / (double)bins;
    }
    /* How far mass is moved on average is the integral of the difference of what lies below; the
     * sum is that but for 1e-6. */
    CHECK(moved < tolerances[k / 2]);
    if (k % 2 == 0)
    {
      CHECK(k == 0 || moved < 0.27 * last); /* a quarter a level, and what is of higher order */
      last = moved;
    }
    free(density);
    scene_free(s);
  }
}

static void map_of_a_hexahedron_gives_its_mass(void)
{
  /* z (1 + x) for z: the determinant is 1 + x. Of y z there is less than v: v - v log v. */
  const size_t bins = 16;
  double l1[3], first[2] = { 0, 0 };
  for (int k = 0; k < 3; ++k)
  {
    scene* const s = scene_image((size_t[3]){ 1, 1, 1 }, zero, one, x_and_yz);
    change_kind(s, HEXAHEDRA);
    for (int p = 0; p < 8; ++p)
    {
      s->points[3 * p + 2] *= 1 + s->points[3 * p];
    }
    chi_scatterplot_params params = scene_params(bins, bins, 0, 1, 0, 1);
    chi_scatterplot_result r;
    params.trilinear_tolerance = (double[]){ 0.2, 0.05, 0.0125 }[k];
    params.trilinear_levels = 6;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK_NEAR(r.total_mass, 1.5, 1e-14);
    CHECK_NEAR(scene_mass_error(density, &r, bins, bins, 1.5), 0, 1e-12);
    l1[k] = 0;
    first[0] = first[1] = 0;
    for (size_t i = 0; i < bins * bins; ++i)
    {
      const double u0 = (double)(i % bins) / 16, u1 = u0 + 1. / 16;
      const double v0 = (double)(i / bins) / 16, v1 = v0 + 1. / 16;
      const double below = v1 - v1 * log(v1) - (v0 > 0 ? v0 - v0 * log(v0) : 0);
      const double exact = (u1 - u0) * (1 + (u0 + u1) / 2) * below;
      l1[k] += fabs(density[i] / 256 - exact);
      first[u0 >= 0.5] += density[i] / 256;
    }
    free(density);
    scene_free(s);
  }
  /* parts are whole in halves of x, and have their exact masses: 1 + x over each half */
  CHECK_NEAR(first[0], 0.625, 1e-12);
  CHECK_NEAR(first[1], 0.875, 1e-12);
  CHECK(l1[1] < l1[0] && l1[2] < l1[0] / 14); /* second order: two levels, near to a sixteenth */
}

static void every_kind_of_grid_gives_the_same_plot(void)
{
  /* all cells at the most levels, so that all are subdivided alike */
  for (int levels = 1; levels <= 5; levels += 2)
  {
    const size_t n = levels == 5 ? 2 : 5;
    double* expected = NULL;
    for (int kind = IMAGE; kind <= HEXAHEDRA; ++kind)
    {
      scene* const s = scene_image((size_t[3]){ n, n + 1, n }, zero, one, bent);
      change_kind(s, kind);
      chi_scatterplot_params params = scene_params(30, 20, 0.2, 1.2, -0.1, 1);
      chi_scatterplot_result r;
      params.trilinear_tolerance = 1e-9;
      params.trilinear_levels = levels;
      double* const density = scene_plot(NULL, s, &params, &r);
      CHECK(r.subdivided_cells == r.capped_cells && r.subdivided_cells > 0);
      CHECK_NEAR(scene_mass_error(density, &r, 30, 20, 1), 0, 1e-12);
      double peak = 0, error = 0;
      for (int i = 0; i < 600 && expected; ++i)
      {
        peak = fmax(peak, expected[i]);
        error = fmax(error, fabs(expected[i] - density[i]));
      }
      if (expected)
      {
        CHECK_NEAR(error / peak, 0, 1e-10); /* the bound that the header states */
        free(density);
      }
      else
      {
        expected = density;
      }
      scene_free(s);
    }
    free(expected);
  }
}

static void subdivision_converges_to_finer_grids(void)
{
  /* Trilinear cells of a coarse image are those of a finer one that is sampled from them. */
  scene* const coarse = scene_image((size_t[3]){ 3, 3, 3 }, zero, one, bent);
  scene* const fine = scene_image((size_t[3]){ 48, 48, 48 }, zero, one, bent);
  for (size_t i = 0; i < 49 * 49 * 49; ++i)
  {
    const size_t at[3] = { i % 49, i / 49 % 49, i / 2401 };
    size_t c[3];
    double t[3];
    for (int a = 0; a < 3; ++a)
    {
      c[a] = at[a] / 16 < 2 ? at[a] / 16 : 2;
      t[a] = (double)(at[a] - 16 * c[a]) / 16;
    }
    fine->f[i] = fine->g[i] = 0;
    for (size_t k = 0; k < 8; ++k)
    {
      const size_t p = c[0] + (k & 1) + 4 * (c[1] + (k >> 1 & 1) + 4 * (c[2] + (k >> 2)));
      const double w =
        (k & 1 ? t[0] : 1 - t[0]) * (k & 2 ? t[1] : 1 - t[1]) * (k & 4 ? t[2] : 1 - t[2]);
      fine->f[i] += w * coarse->f[p];
      fine->g[i] += w * coarse->g[p];
    }
  }
  chi_scatterplot_params params = scene_params(32, 32, 0, 1.5, 0, 1.2);
  double* const expected = scene_plot(NULL, fine, &params, NULL);
  params.trilinear_tolerance = 1e-9;
  for (int kind = IMAGE; kind <= HEXAHEDRA; kind += HEXAHEDRA)
  {
    change_kind(coarse, kind);
    double last = 0;
    for (int levels = 1; levels <= 4; ++levels)
    {
      params.trilinear_levels = levels;
      double* const density = scene_plot(NULL, coarse, &params, NULL);
      double l1 = 0;
      for (int i = 0; i < 1024; ++i)
      {
        l1 += fabs(density[i] - expected[i]) * 1.5 * 1.2 / 1024;
      }
      /* second order; at 16 parts both are one split, but for rounding of the values */
      CHECK(levels == 1 || l1 < 0.3 * last);
      CHECK(levels < 4 || l1 < 1e-9);
      last = l1;
      free(density);
    }
  }
  free(expected);
  scene_free(coarse);
  scene_free(fine);
}

static void linear_fields_and_cells_beyond_the_plot_stay_whole(void)
{
  for (int kind = IMAGE; kind <= HEXAHEDRA; ++kind)
  {
    scene* const s = scene_image((size_t[3]){ 10, 9, 9 }, zero, one, tilted);
    change_kind(s, kind);
    chi_scatterplot_params params = scene_params(40, 40, 0, 1.5, -0.25, 1);
    chi_scatterplot_result plain, r;
    double* const expected = scene_plot(NULL, s, &params, &plain);
    params.trilinear_tolerance = 1e-6;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK(r.subdivided_cells == 0 && r.capped_cells == 0 && r.simplices == plain.simplices);
    for (int i = 0; i < 1600; ++i)
    {
      /* masses of tetrahedra are the map's up to rounding; those of lattices the same */
      CHECK_NEAR(density[i], expected[i], kind <= RECTILINEAR ? 0 : 1e-12);
    }
    free(expected);
    free(density);
    scene_free(s);
  }
  scene* const s = scene_image((size_t[3]){ 12, 12, 12 }, zero, one, bent);
  for (int kind = IMAGE; kind <= HEXAHEDRA; kind += HEXAHEDRA)
  {
    change_kind(s, kind);
    chi_scatterplot_params params = scene_params(40, 40, 0, 1.5, -0.1, 1.2);
    chi_scatterplot_result all, r;
    params.trilinear_tolerance = 1e-4;
    free(scene_plot(NULL, s, &params, &all));
    CHECK(all.subdivided_cells > 1600); /* of 1728 cells with mixed terms */
    params.range[0][0] = 0.7;
    params.range[0][1] = 0.75;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK(r.subdivided_cells > 0 && r.subdivided_cells < 600);
    CHECK_NEAR(scene_mass_error(density, &r, 40, 40, 1), 0, 1e-12);
    free(density);
  }
  scene_free(s);
}

static void jittered_hexahedra_hold_the_volume_of_their_maps(void)
{
  uint32_t seed = 5;
  scene* const s = scene_image((size_t[3]){ 6, 5, 4 }, zero, one, bent);
  change_kind(s, HEXAHEDRA);
  for (size_t i = 0; i < 3 * s->grid.points.count; ++i)
  {
    s->points[i] += 0.04 * (chi_test_random(&seed) - 0.5);
  }
  /* Gauss' rule of two points is exact for what is quadratic in each parameter */
  double volume = 0;
  for (size_t c = 0; c < s->grid.cell_count; ++c)
  {
    for (int g = 0; g < 8; ++g)
    {
      static const int bits[8] = { 0, 1, 3, 2, 4, 5, 7, 6 };
      double t[3], j[3][3] = { { 0 } };
      for (int a = 0; a < 3; ++a)
      {
        t[a] = 0.5 + (g >> a & 1 ? 0.5 : -0.5) / sqrt(3);
      }
      for (int k = 0; k < 8; ++k)
      {
        const double* const x = s->points + 3 * s->ids[8 * c + (size_t)k];
        for (int a = 0; a < 3; ++a)
        {
          double d = bits[k] >> a & 1 ? 1 : -1;
          for (int o = 0; o < 3; ++o)
          {
            d *= o == a ? 1 : bits[k] >> o & 1 ? t[o] : 1 - t[o];
          }
          for (int i = 0; i < 3; ++i)
          {
            j[a][i] += d * x[i];
          }
        }
      }
      volume += (j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
                  j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                  j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0])) /
        8;
    }
  }
  for (int k = 0; k < 4; ++k)
  {
    chi_scatterplot_params params = scene_params(50, 50, 0.1, 1.4, 0, 1.1);
    chi_scatterplot_result r;
    params.trilinear_tolerance = (double[]){ 10, 0.02, 1e-3, 1e-4 }[k];
    params.trilinear_levels = 3;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK_NEAR(r.total_mass, volume, 1e-13);
    CHECK_NEAR(scene_mass_error(density, &r, 50, 50, volume), 0, 1e-12);
    CHECK(k > 0 || r.subdivided_cells == 0);
    CHECK(r.folded_cells == 0 && (k < 3 || r.capped_cells > 0));
    free(density);
  }
  scene_free(s);
}

static void folded_hexahedra_are_split_as_without(void)
{
  scene* const s = scene_image((size_t[3]){ 1, 1, 1 }, zero, one, bent);
  change_kind(s, HEXAHEDRA);
  s->points[3 * 7] = s->points[3 * 7 + 1] = s->points[3 * 7 + 2] = -0.2; /* beyond the first */
  chi_scatterplot_params params = scene_params(20, 20, 0, 1.5, 0, 1.2);
  chi_scatterplot_result plain, r;
  double* const expected = scene_plot(NULL, s, &params, &plain);
  params.trilinear_tolerance = 1e-3;
  double* const density = scene_plot(NULL, s, &params, &r);
  CHECK(r.folded_cells == 1 && r.subdivided_cells == 0 && r.total_mass == plain.total_mass);
  CHECK(memcmp(expected, density, 400 * sizeof *density) == 0);
  free(expected);
  free(density);
  scene_free(s);
}

static void any_schedule_gives_the_same_bits(void)
{
  for (int kind = IMAGE; kind <= HEXAHEDRA; ++kind)
  {
    scene* const s = scene_image((size_t[3]){ 20, 13, 17 }, zero, one, bent);
    change_kind(s, kind);
    chi_scatterplot_params params = scene_params(60, 50, 0.1, 1.2, 0, 1.1);
    chi_scatterplot_result r, other;
    params.trilinear_tolerance = 2e-4;
    double* const density = scene_plot(NULL, s, &params, &r);
    const chi_exec exec = { .struct_size = sizeof exec, .parallel_for = chi_test_backwards };
    double* const backwards = scene_plot(&exec, s, &params, &other);
    CHECK(memcmp(density, backwards, 3000 * sizeof *density) == 0);
    CHECK(r.subdivided_cells > 0 && r.subdivided_cells == other.subdivided_cells);
    CHECK(r.simplices == other.simplices);
    free(density);
    free(backwards);
    scene_free(s);
  }
}

static void cells_that_are_not_finite_are_left_out(void)
{
  for (int kind = IMAGE; kind <= HEXAHEDRA; ++kind)
  {
    scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
    change_kind(s, kind);
    s->f[10 * 10 * 4 + 10 * 4 + 4] = NAN;
    s->g[0] = INFINITY;
    chi_scatterplot_params params = scene_params(40, 40, 0, 1.5, -0.1, 1.2);
    chi_scatterplot_result r;
    params.trilinear_tolerance = 1e-3;
    double* const density = scene_plot(NULL, s, &params, &r);
    CHECK(r.skipped_cells == 9 && r.cells == 720);
    CHECK_NEAR(r.total_mass, 720. / 729, 1e-13);
    CHECK_NEAR(scene_mass_error(density, &r, 40, 40, 720. / 729), 0, 1e-12);
    free(density);
    scene_free(s);
  }
}

static void refused_memory_is_told(void)
{
  for (int kind = IMAGE; kind <= HEXAHEDRA; kind += HEXAHEDRA)
  {
    scene* const s = scene_image((size_t[3]){ 9, 9, 9 }, zero, one, bent);
    change_kind(s, kind);
    chi_scatterplot_params params = scene_params(20, 30, 0, 1.5, -0.1, 1.2);
    params.trilinear_tolerance = 1e-2;
    double* const density = (double*)malloc(600 * sizeof(double));
    chi_test_host host;
    const chi_exec exec = { .struct_size = sizeof exec,
      .user = &host,
      .alloc = chi_test_alloc,
      .release = chi_test_release,
      .is_cancelled = chi_test_is_cancelled };
    for (long k = -1, allocations = 0; k < allocations; ++k)
    {
      host = (chi_test_host){ .refuse_at = k, .cancel_at = 1000000 };
      chi_scatterplot* plot = NULL;
      chi_status status = chi_scatterplot_create(&exec, &plot);
      if (status == CHI_OK)
      {
        status = chi_scatterplot_compute(&exec, plot, &s->input, &params, density, NULL);
        chi_scatterplot_destroy(plot);
      }
      CHECK(status == (k < 0 ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY));
      CHECK(host.live == 0);
      allocations = k < 0 ? host.allocations : allocations;
    }
    free(density);
    scene_free(s);
  }
}

static void nonsense_is_refused(void)
{
  scene* const s = scene_image((size_t[3]){ 2, 2, 2 }, zero, one, bent);
  double density[4];
  chi_scatterplot* plot = NULL;
  CHECK(chi_scatterplot_create(NULL, &plot) == CHI_OK);
  for (int k = 0; k < 5; ++k)
  {
    chi_scatterplot_params params = scene_params(2, 2, 0, 1, 0, 1);
    params.trilinear_tolerance = (double[]){ -1, NAN, INFINITY, 1, 1 }[k];
    params.trilinear_levels = (int[]){ 0, 0, 0, -1, 7 }[k];
    CHECK(chi_scatterplot_compute(NULL, plot, &s->input, &params, density, NULL) ==
      CHI_ERROR_INVALID_ARGUMENT);
  }
  chi_scatterplot_destroy(plot);
  scene_free(s);
}

int main(void)
{
  product_in_one_cell_is_within_the_tolerance();
  map_of_a_hexahedron_gives_its_mass();
  every_kind_of_grid_gives_the_same_plot();
  subdivision_converges_to_finer_grids();
  linear_fields_and_cells_beyond_the_plot_stay_whole();
  jittered_hexahedra_hold_the_volume_of_their_maps();
  folded_hexahedra_are_split_as_without();
  any_schedule_gives_the_same_bits();
  cells_that_are_not_finite_are_left_out();
  refused_memory_is_told();
  nonsense_is_refused();
  return chi_test_report();
}
