/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Lists of nothing but tetrahedra: what their order in memory does, and does not, to a plot. */

#include "counting_host.h"
#include "scatterplot_scene.h"

#include <math.h>

static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };

static void bent(const double x[3], double value[2])
{
  value[0] = x[0] + 0.2 * x[1] * x[2];
  value[1] = x[1] * x[1] + 0.3 * x[2];
}

static double peak_of(const double* density, size_t count)
{
  double peak = 0;
  for (size_t i = 0; i < count; ++i)
  {
    peak = density[i] > peak ? density[i] : peak;
  }
  return peak;
}

enum
{
  BINS = 40
};

/* A random list, sorted and not: `change` is made to both. */
static void compare_orders(void (*change)(scene* s), int32_t weighted)
{
  scene* const s = scene_image((size_t[3]){ 18, 17, 19 }, zero, one, bent);
  chi_scatterplot_params params = scene_params(BINS, BINS, 0, 1.2, 0, 1.3);
  chi_scatterplot_result sorted, plain;
  scene_to_list(s, 9);
  if (weighted)
  {
    s->input.weight = s->input.fields[1];
    s->input.weight_association = CHI_SCATTERPLOT_POINTS;
  }
  if (change)
  {
    change(s);
  }
  double* const a = scene_plot(NULL, s, &params, &sorted);
  params.switches = CHI_SCATTERPLOT_NO_SORT;
  double* const b = scene_plot(NULL, s, &params, &plain);
  const double peak = peak_of(b, BINS * BINS);
  CHECK(sorted.is_sorted && !plain.is_sorted);
  CHECK(sorted.cells == plain.cells && sorted.skipped_cells == plain.skipped_cells);
  CHECK((sorted.skipped_cells > 0) == (change != NULL));
  CHECK_NEAR(sorted.total_mass / plain.total_mass, 1, 1e-12);
  for (size_t i = 0; i < BINS * BINS; ++i)
  {
    /* twice the bound of each, against clipping */
    CHECK_NEAR(a[i] / peak, b[i] / peak, 2e-10);
  }
  free(a);
  free(b);
  scene_free(s);
}

static void make_bad(scene* s)
{
  s->points[3 * 1000] = NAN;
  s->points[3 * 2000 + 1] = 1e101;
  s->f[3000] = INFINITY;
  s->g[100] = NAN;
}

static void the_order_of_a_list_changes_no_plot(void)
{
  compare_orders(NULL, 0);
  compare_orders(NULL, 1);
  compare_orders(make_bad, 0);
}

static void a_sorted_list_is_kept_with_its_mesh(void)
{
  scene* const s = scene_image((size_t[3]){ 18, 17, 19 }, zero, one, bent);
  const chi_scatterplot_params params = scene_params(BINS, BINS, 0, 1.2, 0, 1.3);
  static double first[BINS * BINS], other[BINS * BINS];
  counting_host host = { 0 };
  const chi_exec exec = counting_exec(&host);
  chi_scatterplot* plot = NULL;
  chi_scatterplot_result r;
  scene_to_list(s, 9);
  s->grid.version = 1;
  CHECK(chi_scatterplot_create(&exec, &plot) == CHI_OK);
  CHECK(chi_scatterplot_compute(&exec, plot, &s->input, &params, first, &r) == CHI_OK);
  const size_t before = host.allocations;
  CHECK(chi_scatterplot_compute(&exec, plot, &s->input, &params, other, &r) == CHI_OK);
  CHECK(host.allocations == before && r.is_sorted);
  CHECK(memcmp(first, other, sizeof first) == 0);
  /* weights of cells need the cells' numbers: another order, and back */
  double* const ones = (double*)malloc(s->grid.cell_count * sizeof *ones);
  for (size_t i = 0; i < s->grid.cell_count; ++i)
  {
    ones[i] = 1;
  }
  s->input.weight = (chi_array_view){ ones, s->grid.cell_count, 1, sizeof *ones, CHI_F64 };
  s->input.weight_association = CHI_SCATTERPLOT_CELLS;
  CHECK(chi_scatterplot_compute(&exec, plot, &s->input, &params, other, &r) == CHI_OK);
  const double peak = peak_of(first, BINS * BINS);
  for (size_t i = 0; i < BINS * BINS; ++i)
  {
    CHECK_NEAR(first[i] / peak, other[i] / peak, 2e-10);
  }
  s->input.weight.data = NULL;
  CHECK(chi_scatterplot_compute(&exec, plot, &s->input, &params, other, &r) == CHI_OK);
  CHECK(memcmp(first, other, sizeof first) == 0);
  chi_scatterplot_destroy(plot);
  CHECK(host.live == 0);
  free(ones);
  scene_free(s);
}

/* Stated: 16 bytes a cell and 2 a point, and what does not grow with the mesh. */
static void sorting_takes_the_memory_that_is_stated(void)
{
  size_t peak[2], cells[2], points[2];
  for (int k = 0; k < 2; ++k)
  {
    const size_t n = k ? 48 : 24;
    scene* const s = scene_image((size_t[3]){ n, n, n }, zero, one, bent);
    const chi_scatterplot_params params = scene_params(BINS, BINS, 0, 1.2, 0, 1.3);
    static double density[BINS * BINS];
    counting_host host = { 0 };
    const chi_exec exec = counting_exec(&host);
    chi_scatterplot* plot = NULL;
    chi_scatterplot_result r;
    scene_to_list(s, 9);
    CHECK(chi_scatterplot_create(&exec, &plot) == CHI_OK);
    CHECK(chi_scatterplot_compute(&exec, plot, &s->input, &params, density, &r) == CHI_OK);
    CHECK(r.is_sorted);
    chi_scatterplot_destroy(plot);
    peak[k] = host.peak;
    cells[k] = s->grid.cell_count;
    points[k] = s->grid.points.count;
    scene_free(s);
  }
  /* a tenth of a byte a cell: one piece of 2048 cells is described in less than 200 */
  const double most = 16.1 * (double)(cells[1] - cells[0]) + 2 * (double)(points[1] - points[0]);
  CHECK((double)(peak[1] - peak[0]) <= most);
}

int main(void)
{
  the_order_of_a_list_changes_no_plot();
  a_sorted_list_is_kept_with_its_mesh();
  sorting_takes_the_memory_that_is_stated();
  return chi_test_report();
}
