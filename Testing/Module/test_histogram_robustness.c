/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous histograms on hostile hosts, of nonsense, with and without what is skipped. */

#include "histogram_scene.h"

#include <stddef.h>

enum
{
  N = 26,
  POINTS = (N + 1) * (N + 1) * (N + 1),
  COUNT = 50
};

/* Constant in a corner, smooth beyond: there are pieces of every kind. */
static double* make_values(void)
{
  double* const values = malloc(POINTS * sizeof *values);
  if (!values)
  {
    exit(1);
  }
  for (int i = 0; i < POINTS; ++i)
  {
    const double x = i % (N + 1), y = i / (N + 1) % (N + 1), z = i / (N + 1) / (N + 1);
    const double r = fmax(0, sqrt(x * x + y * y + z * z) - 15);
    values[i] = 0.31 + r * r + (r > 0 ? sin(x) : 0);
  }
  return values;
}

static chi_grid_view image_view(void)
{
  return image_of(N + 1, N + 1, N + 1);
}

static int same_bins(const bins* a, const bins* b)
{
  return memcmp(a->centers, b->centers, 5 * a->count * sizeof(double)) == 0 &&
    a->result.total_mass == b->result.total_mass && a->result.mean == b->result.mean &&
    memcmp(
      a->result.central_moments, b->result.central_moments, sizeof a->result.central_moments) == 0;
}

static void any_schedule_gives_the_same_bits(void)
{
  double* const values = make_values();
  const chi_array_view field = view_values(values, POINTS);
  mesh* const m = make_mixed(6, 0.2, 4);
  chi_grid_view grids[2] = { image_view(), view_of(m) };
  const chi_exec exec = { .struct_size = sizeof exec, .parallel_for = chi_test_backwards };
  for (int g = 0; g < 2; ++g)
  {
    const chi_array_view part = view_values(values, g ? m->points : POINTS);
    chi_histogram_params params = histogram_params(g ? &part : &field, 333, 1, 200);
    for (int automatic = 0; automatic < 2; ++automatic)
    {
      bins a, b;
      params.automatic_range = automatic;
      CHECK(make_bins(&a, NULL, NULL, &grids[g], &params) == CHI_OK);
      CHECK(make_bins(&b, &exec, NULL, &grids[g], &params) == CHI_OK);
      CHECK(same_bins(&a, &b));
      drop_bins(&a);
      drop_bins(&b);
    }
  }
  drop_view(&grids[1]);
  free(m);
  free(values);
}

static void skipping_changes_nothing_and_is_counted(void)
{
  double* const values = make_values();
  const chi_array_view field = view_values(values, POINTS);
  const chi_grid_view grid = image_view();
  chi_histogram_params params = histogram_params(&field, COUNT, 0, 100);
  bins with;
  CHECK(make_bins(&with, NULL, NULL, &grid, &params) == CHI_OK);
  CHECK(with.result.skipped[0] > 0 && with.result.skipped[1] > 0);
  CHECK(with.result.pieces == 64);
  for (int k = 0; k < CHI_HISTOGRAM_SKIP_KINDS; ++k)
  {
    bins without;
    params.no_skipping = 1 << k;
    CHECK(make_bins(&without, NULL, NULL, &grid, &params) == CHI_OK);
    CHECK(without.result.skipped[k] == 0);
    for (size_t i = 0; i < COUNT; ++i)
    {
      /* a piece's parts are added in another order: 3072 of them, eps / 2 of the sum each */
      CHECK_NEAR(without.mass[i], with.mass[i], 1e-13 * with.result.total_mass);
      CHECK_NEAR(without.iso_area[i], with.iso_area[i], 1e-12 * with.result.total_area);
    }
    CHECK_NEAR(without.result.mass_above, with.result.mass_above, 1e-13 * with.result.total_mass);
    drop_bins(&without);
  }
  drop_bins(&with);
  free(values);
}

static void what_has_not_changed_is_kept(void)
{
  double* const values = make_values();
  const chi_array_view field = view_values(values, POINTS);
  chi_grid_view grid = image_view();
  chi_histogram_params params = histogram_params(&field, COUNT, 0, 100);
  chi_histogram* h = NULL;
  bins first, again;
  double before, after;
  grid.version = 1;
  params.field_version = 1;
  CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
  CHECK(make_bins(&first, NULL, h, &grid, &params) == CHI_OK && !first.result.skipped[2]);
  CHECK(chi_histogram_quantile(NULL, h, 0.3, &before) == CHI_OK);
  CHECK(make_bins(&again, NULL, h, &grid, &params) == CHI_OK && again.result.skipped[2] == 1);
  CHECK(same_bins(&first, &again));
  CHECK(chi_histogram_quantile(NULL, h, 0.3, &after) == CHI_OK && after == before);
  drop_bins(&again);
  params.bins = 7; /* the pieces do not depend on these */
  params.range[1] = 10;
  CHECK(make_bins(&again, NULL, h, &grid, &params) == CHI_OK && again.result.skipped[2] == 1);
  drop_bins(&again);
  for (int i = 0; i < POINTS; ++i)
  {
    values[i] += 1;
  }
  params.field_version = 2;
  CHECK(make_bins(&again, NULL, h, &grid, &params) == CHI_OK && again.result.skipped[2] == 0);
  CHECK_NEAR(again.result.mean, first.result.mean + 1, 1e-12 * first.result.mean);
  CHECK(chi_histogram_quantile(NULL, h, 0.3, &after) == CHI_OK);
  CHECK_NEAR(after, before + 1, 1e-12 * again.result.field_range[1]);
  drop_bins(&again);
  params.field_version = 0;
  for (int k = 0; k < 2; ++k)
  {
    CHECK(make_bins(&again, NULL, h, &grid, &params) == CHI_OK && again.result.skipped[2] == 0);
    drop_bins(&again);
  }
  drop_bins(&first);
  chi_histogram_destroy(NULL, h);
  free(values);
}

static void empty_meshes_have_no_mass(void)
{
  chi_grid_view grid = image_of(0, 4, 4);
  const chi_array_view none = view_values(NULL, 0);
  chi_histogram_params params = histogram_params(&none, 4, 0, 1);
  chi_histogram* h = NULL;
  bins b;
  double q;
  CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
  CHECK(make_bins(&b, NULL, h, &grid, &params) == CHI_OK);
  CHECK(sum_of(&b) == 0 && b.result.dimension == 0 && isnan(b.result.mean));
  CHECK(b.result.field_range[0] == 1 && b.result.field_range[1] == -1);
  CHECK(chi_histogram_quantile(NULL, h, 0.5, &q) == CHI_ERROR_EMPTY);
  CHECK(chi_histogram_moment(h, 2, &q) == CHI_OK && isnan(q));
  drop_bins(&b);
  params.automatic_range = 1;
  CHECK(make_bins(&b, NULL, h, &grid, &params) == CHI_OK);
  CHECK(b.result.range[0] == 0 && b.result.range[1] == 1);
  drop_bins(&b);
  grid = image_of(5, 1, 1); /* lines */
  const double values[5] = { 0, 1, 2, 3, 4 };
  const chi_array_view line = view_values(values, 5);
  params.field = &line;
  CHECK(make_bins(&b, NULL, h, &grid, &params) == CHI_OK);
  CHECK(b.result.lower_dimensional_cells == 4 && b.result.total_mass == 0);
  drop_bins(&b);
  chi_histogram_destroy(NULL, h);
  chi_histogram_destroy(NULL, NULL);
}

static void coordinates_that_are_no_numbers_leave_no_cell(void)
{
  for (int k = 0; k < 12; ++k)
  {
    chi_grid_view grid = image_of(4, 4, 4);
    double values[64];
    for (int i = 0; i < 64; ++i)
    {
      values[i] = i % 7;
    }
    const chi_array_view field = view_values(values, 64);
    const chi_histogram_params params = histogram_params(&field, 4, 0, 7);
    bins b;
    grid.index_to_world[k] = k % 2 ? NAN : INFINITY;
    CHECK(make_bins(&b, NULL, NULL, &grid, &params) == CHI_OK);
    /* an infinite step is at the first point 0 times infinity */
    CHECK(b.result.skipped_cells == 27 && b.result.total_mass == 0 && sum_of(&b) == 0);
    drop_bins(&b);
  }
}

static void structs_of_older_versions_are_read_as_far_as_they_go(void)
{
  chi_grid_view grid = image_of(4, 4, 4);
  double values[64];
  for (int i = 0; i < 64; ++i)
  {
    values[i] = i % 7;
  }
  const chi_array_view field = view_values(values, 64);
  /* nothing behind it, as ASan sees */
  const size_t bytes = offsetof(chi_histogram_params, reduction);
  chi_histogram_params* const old = (chi_histogram_params*)malloc(bytes);
  const chi_histogram_params params = histogram_params(&field, 4, 0, 7);
  bins b, c;
  memcpy(old, &params, bytes);
  memcpy(old, &bytes, sizeof bytes);
  CHECK(make_bins(&b, NULL, NULL, &grid, old) == CHI_OK);
  CHECK(make_bins(&c, NULL, NULL, &grid, &params) == CHI_OK);
  CHECK(memcmp(b.mass, c.mass, 4 * sizeof(double)) == 0);
  drop_bins(&b);
  drop_bins(&c);
  free(old);
}

static void variance_of_nearly_one_value_is_not_negative(void)
{
  chi_grid_view grid = image_of(4, 4, 4);
  double cells[27];
  const chi_array_view field = view_values(cells, 27);
  chi_histogram_params params = histogram_params(&field, 4, 0, 7);
  params.association = CHI_HISTOGRAM_CELLS;
  for (int k = 0; k < 27; ++k)
  {
    /* one cell of 1e-15 of the volume is at 7 */
    static double axes[3][4] = { { 0, 1, 2, 3 }, { 0, 1, 2, 3 }, { 0, 1, 2, 2 + 1e-14 } };
    bins b;
    grid.kind = CHI_GRID_RECTILINEAR;
    for (int a = 0; a < 3; ++a)
    {
      grid.axes[a] = view_values(axes[a], 4);
    }
    for (int i = 0; i < 27; ++i)
    {
      cells[i] = i == k && k >= 18 ? 7 : 0.1 * (k % 9);
    }
    CHECK(make_bins(&b, NULL, NULL, &grid, &params) == CHI_OK);
    CHECK(b.result.central_moments[2] >= 0 && b.result.central_moments[4] >= 0);
    drop_bins(&b);
  }
}

static void wrong_arguments_are_refused(void)
{
  double* const values = make_values();
  const chi_array_view field = view_values(values, POINTS), few = view_values(values, POINTS - 1);
  const chi_grid_view grid = image_view();
  const chi_histogram_params good = histogram_params(&field, COUNT, 0, 100);
  chi_histogram* h = NULL;
  CHECK(chi_histogram_create(NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
  CHECK(chi_histogram_compute(NULL, NULL, &grid, &good, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_compute(NULL, h, NULL, &good, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_compute(NULL, h, &grid, NULL, NULL) == CHI_ERROR_INVALID_ARGUMENT);
#define REFUSED(change, code)                                                                      \
  do                                                                                               \
  {                                                                                                \
    chi_histogram_params p = good;                                                                 \
    change;                                                                                        \
    CHECK(chi_histogram_compute(NULL, h, &grid, &p, NULL) == (code));                              \
  } while (0)
  REFUSED(p.field = NULL, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.field = &few, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.component = 1, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.component = -2, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.association = 2, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.association = CHI_HISTOGRAM_CELLS, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.bins = 0, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.bins = ((size_t)1 << 20) + 1, CHI_ERROR_TOO_LARGE);
  REFUSED(p.range[1] = 0, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.range[1] = -1, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.range[0] = NAN, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.range[1] = INFINITY, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.range[1] = 1e-320, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.moments = 1, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.moments = 9, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.no_skipping = 8, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED(p.struct_size = 8, CHI_ERROR_INVALID_ARGUMENT);
  REFUSED((void)p, CHI_OK);
#undef REFUSED
  const chi_histogram_outputs little = { .struct_size = sizeof little - sizeof(double*) };
  CHECK(chi_histogram_compute(NULL, h, &grid, &good, &little) == CHI_ERROR_INVALID_ARGUMENT);
  double moment;
  CHECK(chi_histogram_compute(NULL, h, &grid, &good, NULL) == CHI_OK);
  CHECK(chi_histogram_moment(h, -1, &moment) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_moment(h, 9, &moment) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_moment(h, 0, &moment) == CHI_OK && moment == 1);

  mesh* const m = make_mixed(10, 0.2, 4);
  m->ids[3000] = -1;
  size_t broken = 0;
  while (m->offsets[broken + 1] <= 3000)
  {
    ++broken;
  }
  chi_grid_view list = view_of(m);
  const chi_array_view part = view_values(values, m->points);
  chi_histogram_params p = good;
  chi_histogram_result r;
  p.field = &part;
  CHECK(chi_histogram_compute(NULL, h, &list, &p, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  chi_histogram_get_result(h, &r);
  CHECK(r.first_bad_cell == (int64_t)broken);
  CHECK(chi_histogram_moment(h, 0, &moment) == CHI_ERROR_NOT_READY);
  drop_view(&list);
  m->ids[3000] = 0;
  m->offsets[40] = 1000000;
  list = view_of(m);
  CHECK(chi_histogram_compute(NULL, h, &list, &p, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  drop_view(&list);
  free(m);
  chi_histogram_destroy(NULL, h);
  free(values);
}

static chi_status try_all(
  const chi_exec* exec, const chi_grid_view* grid, const chi_histogram_params* params)
{
  chi_histogram* h = NULL;
  double q;
  chi_status status = chi_histogram_create(exec, &h);
  status = status == CHI_OK ? chi_histogram_compute(exec, h, grid, params, NULL) : status;
  status = status == CHI_OK ? chi_histogram_quantile(exec, h, 0.7, &q) : status;
  chi_histogram_destroy(exec, h);
  return status;
}

static void every_refusal_and_every_cancellation_is_survived(void)
{
  double* const values = make_values();
  mesh* const m = make_mixed(4, 0.2, 4);
  const chi_grid_view image = image_of(10, 9, 12);
  chi_grid_view list = view_of(m);
  const chi_grid_view* const grids[2] = { &image, &list };
  const chi_array_view fields[2] = { view_values(values, 1080), view_values(values, m->points) };
  for (int g = 0; g < 2; ++g)
  {
    const chi_histogram_params params = histogram_params(&fields[g], COUNT, 0, 100);
    int finished = 0;
    for (long at = 0; at < 400 && !finished; ++at)
    {
      chi_test_host host = { .refuse_at = at, .cancel_at = -1 };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release };
      const chi_status status = try_all(&exec, grids[g], &params);
      finished = host.allocations <= at;
      CHECK(status == (finished ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY));
      CHECK(host.live == 0);
    }
    CHECK(finished);
    finished = 0;
    for (long at = 0; at < 4000 && !finished; ++at)
    {
      chi_test_host host = { .refuse_at = -1, .cancel_at = at };
      const chi_exec exec = { .struct_size = sizeof exec,
        .user = &host,
        .alloc = chi_test_alloc,
        .release = chi_test_release,
        .is_cancelled = chi_test_is_cancelled };
      const chi_status status = try_all(&exec, grids[g], &params);
      finished = host.polls <= at;
      CHECK(status == (finished ? CHI_OK : CHI_ERROR_CANCELLED));
      CHECK(host.live == 0);
    }
    CHECK(finished);
  }
  drop_view(&list);
  free(m);
  free(values);
}

int main(void)
{
  any_schedule_gives_the_same_bits();
  skipping_changes_nothing_and_is_counted();
  what_has_not_changed_is_kept();
  empty_meshes_have_no_mass();
  coordinates_that_are_no_numbers_leave_no_cell();
  structs_of_older_versions_are_read_as_far_as_they_go();
  variance_of_nearly_one_value_is_not_negative();
  wrong_arguments_are_refused();
  every_refusal_and_every_cancellation_is_survived();
  return chi_test_report();
}
