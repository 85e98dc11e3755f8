/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Continuous histograms against closed forms and against long double. */

#include "histogram_scene.h"

#define EPS 2.3e-16
/* of some thousand equal parts of 1 that are added, each rounded to half of eps of the sum so far
 */
#define PARTS 1e-13

/* Values at the points of an image of n^3 unit cubes over [0, 1]^3, or of one with a flat axis. */
typedef struct cube
{
  chi_grid_view view;
  double* values;
  size_t points;
} cube;

typedef double (*field_fn)(double x, double y, double z);

static cube make_cube(size_t nx, size_t ny, size_t nz, field_fn f)
{
  const double h[3] = { 1.0 / (double)nx, 1.0 / (double)ny, nz ? 1.0 / (double)nz : 1 };
  cube c = { .view = { .struct_size = sizeof(chi_grid_view),
               .kind = CHI_GRID_IMAGE,
               .dimensions = { nx + 1, ny + 1, nz + 1 },
               .index_to_world = { h[0], 0, 0, 0, 0, h[1], 0, 0, 0, 0, h[2], 0, 0, 0, 0, 1 } },
    .points = (nx + 1) * (ny + 1) * (nz + 1) };
  c.values = malloc(c.points * sizeof(double));
  if (!c.values)
  {
    exit(1);
  }
  for (size_t i = 0; i < c.points; ++i)
  {
    const size_t x = i % (nx + 1), y = i / (nx + 1) % (ny + 1), z = i / (nx + 1) / (ny + 1);
    c.values[i] =
      f((double)x / (double)nx, (double)y / (double)ny, nz ? (double)z / (double)nz : 0);
  }
  return c;
}

static double diagonal(double x, double y, double z)
{
  return x + y + z;
}

static double waves(double x, double y, double z)
{
  return sin(7 * x) * cos(5 * y + 1) + sin(9 * z * x) + 0.1 * x;
}

/* The distribution of the sum of three numbers of [0, 1]: an integrated quadratic box spline. */
static long double below_diagonal(long double t)
{
  static const int choose[4] = { 1, -3, 3, -1 };
  long double sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    const long double d = t > k ? t - k : 0;
    sum += choose[k] * d * d * d / 6;
  }
  return sum;
}

static void one_tetrahedron_is_a_quadratic_spline(void)
{
  static const double sets[][4] = { { 0, 1, 2, 4 }, { 4, 0, 2, 1 }, { 1, 1, 2, 3 }, { 0, 2, 2, 3 },
    { 0, 1, 3, 3 }, { 0, 0, 0, 3 }, { 3, 1, 3, 3 }, { 0, 0, 3, 3 }, { 0, 1e-9, 2e-9, 3 } };
  for (size_t k = 0; k < sizeof sets / sizeof sets[0]; ++k)
  {
    for (size_t count = 3; count <= 3000; count *= 10)
    {
      mesh* const m = new_mesh();
      add_point(m, 0, 0, 0);
      add_point(m, 1, 0, 0);
      add_point(m, 0, 1, 0);
      add_point(m, 0.25, 0.5, 2);
      add_cell(m, 10, 4, (const int64_t[4]){ 0, 1, 2, 3 });
      chi_grid_view grid = view_of(m);
      split s = split_of(m);
      const chi_array_view field = view_values(sets[k], 4);
      const chi_histogram_params params = histogram_params(&field, count, -0.5, 3.7);
      bins b;
      CHECK(make_bins(&b, NULL, NULL, &grid, &params) == CHI_OK);
      long double *const mass = calloc(2 * count, sizeof *mass), *const area = mass + count;
      reference_bins(&s, sets[k], count, -0.5, 3.7, mass, area);
      double worst = 0, worst_area = 0;
      for (size_t i = 0; i < count; ++i)
      {
        worst = fmax(worst, fabs((double)(b.mass[i] - mass[i])));
        worst_area =
          fmax(worst_area, fabs((double)(b.iso_area[i] * (4.2L / (long double)count) - area[i])));
      }
      /* values move by 2^-51 of up to twice the range: 8 eps, densities are at most 3 / 3 of the
         volume 1/3 */
      CHECK(worst < 1e-14);
      CHECK(worst_area < 1e-13);
      CHECK_NEAR((double)sum_of(&b), 1.0 / 3, 4 * EPS);
      CHECK_NEAR(b.result.total_mass, 1.0 / 3, EPS);
      free(mass);
      drop_bins(&b);
      drop_split(&s);
      drop_view(&grid);
      free(m);
    }
  }
}

static void a_linear_field_on_a_cube_is_a_box_spline(void)
{
  for (size_t n = 1; n <= 17; n = 2 * n + 1)
  {
    cube c = make_cube(n, n, n, diagonal);
    const chi_array_view field = view_values(c.values, c.points);
    chi_histogram_params params = histogram_params(&field, 90, 0, 3);
    bins b;
    CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
    double worst = 0;
    for (size_t i = 0; i < 90; ++i)
    {
      const long double low = (long double)i / 30, high = (long double)(i + 1) / 30;
      const double exact = (double)(below_diagonal(high) - below_diagonal(low));
      worst = fmax(worst, fabs(b.mass[i] - exact));
      worst = fmax(worst, fabs(b.density[i] / 30 - exact));
      worst = fmax(worst, fabs(b.iso_area[i] / sqrt(3.0) / 30 - exact)); /* |grad f| = sqrt 3 */
      worst = fmax(worst, fabs(b.cumulative[i] - (double)below_diagonal(high)));
      CHECK_NEAR(b.centers[i], ((double)i + 0.5) / 30, 3 * EPS);
    }
    /* 6 n^3 parts are added, in bricks of at most 3072: they are rounded to half of eps each */
    CHECK(worst < 200 * EPS);
    CHECK_NEAR(b.result.total_area, sqrt(3.0), 400 * EPS);
    CHECK(b.result.cells == n * n * n && b.result.simplices == 6 * n * n * n);
    CHECK(b.result.dimension == 3 && b.result.singular_mass == 0);
    drop_bins(&b);
    free(c.values);
  }
}

/* The same points as other kinds of grid. */
static void every_kind_of_grid_agrees(void)
{
  enum
  {
    N = 9,
    P = N + 1,
    COUNT = 40
  };
  cube c = make_cube(N, N, N, waves);
  const chi_array_view field = view_values(c.values, c.points);
  const chi_histogram_params params = histogram_params(&field, COUNT, -1.5, 1.7);
  bins of[4];
  double axis[3][P], points[P * P * P][3];
  mesh* const m = new_mesh();
  c.view.index_to_world[0] = 0.5; /* another shape, turned: no matter, for volumes */
  c.view.index_to_world[1] = 0.25;
  for (size_t i = 0; i < c.points; ++i)
  {
    const double x[3] = { (double)(i % P), (double)(i / P % P), (double)(i / P / P) };
    for (int a = 0; a < 3; ++a)
    {
      const double* const r = c.view.index_to_world + 4 * a;
      points[i][a] = r[0] * x[0] + r[1] * x[1] + r[2] * x[2] + r[3];
    }
    add_point(m, points[i][0], points[i][1], points[i][2]);
  }
  for (size_t i = 0; i < N * N * N; ++i)
  {
    const int64_t q = (int64_t)(i % N + P * (i / N % N) + P * P * (i / N / N));
    add_cell(m, 12, 8,
      (const int64_t[8]){
        q, q + 1, q + P + 1, q + P, q + P * P, q + P * P + 1, q + P * P + P + 1, q + P * P + P });
  }
  CHECK(make_bins(&of[0], NULL, NULL, &c.view, &params) == CHI_OK);
  chi_grid_view grid = c.view;
  grid.kind = CHI_GRID_CURVILINEAR;
  grid.points = (chi_vec3_view){ points, c.points, sizeof points[0], CHI_F64 };
  CHECK(make_bins(&of[1], NULL, NULL, &grid, &params) == CHI_OK);
  chi_grid_view list = view_of(m);
  CHECK(make_bins(&of[2], NULL, NULL, &list, &params) == CHI_OK);
  /* straight, for the rectilinear one */
  c.view.index_to_world[1] = 0;
  CHECK(make_bins(&of[3], NULL, NULL, &c.view, &params) == CHI_OK);
  bins straight;
  grid = c.view;
  grid.kind = CHI_GRID_RECTILINEAR;
  for (int a = 0; a < 3; ++a)
  {
    for (int i = 0; i < P; ++i)
    {
      axis[a][i] = 5 - c.view.index_to_world[5 * a] * i; /* mirrored */
    }
    grid.axes[a] = view_values(axis[a], P);
  }
  CHECK(make_bins(&straight, NULL, NULL, &grid, &params) == CHI_OK);
  split s = split_of(m);
  long double mass[COUNT], area[COUNT];
  reference_bins(&s, c.values, COUNT, -1.5, 1.7, mass, area);
  double worst = 0, worst_area = 0, largest = 0, largest_area = 0;
  for (size_t i = 0; i < COUNT; ++i)
  {
    largest = fmax(largest, (double)mass[i]);
    largest_area = fmax(largest_area, (double)area[i] / 0.08);
    for (int k = 0; k < 3; ++k)
    {
      worst = fmax(worst, fabs(of[k].mass[i] - (double)mass[i]));
      worst_area = fmax(worst_area, fabs(of[k].iso_area[i] - (double)area[i] / 0.08));
    }
    worst = fmax(worst, fabs(straight.mass[i] - of[3].mass[i]));
    worst_area = fmax(worst_area, fabs(straight.iso_area[i] - of[3].iso_area[i]));
  }
  /* coordinates are rounded: 10 eps of a cell's size each; sums as above */
  CHECK(worst < 1e-13 * largest);
  CHECK(worst_area < 1e-13 * largest_area);
  for (int k = 0; k < 4; ++k)
  {
    drop_bins(&of[k]);
  }
  drop_bins(&straight);
  drop_view(&list);
  drop_split(&s);
  free(m);
  free(c.values);
}

static void any_mesh_agrees_with_long_double(void)
{
  mesh* const m = make_mixed(4, 0.2, 5);
  split s = split_of(m);
  const size_t extra = s.counts.extra_points;
  double* const values = malloc((m->points + extra) * sizeof *values);
  uint32_t seed = 9;
  for (size_t i = 0; i < m->points; ++i)
  {
    values[i] = 100 * chi_test_random(&seed);
  }
  for (size_t k = 0; k < extra; ++k)
  {
    const int64_t begin = m->offsets[s.extra_cells[k]], end = m->offsets[s.extra_cells[k] + 1];
    double sum = 0;
    for (int64_t i = begin; i < end; ++i)
    {
      sum += values[m->ids[i]];
    }
    values[m->points + k] = sum / (double)(end - begin);
  }
  chi_grid_view grid = view_of(m);
  const chi_array_view field = view_values(values, m->points);
  for (size_t count = 1; count < 3000; count = 3 * count + 1)
  {
    const chi_histogram_params params = histogram_params(&field, count, 20, 90);
    long double *const mass = calloc(2 * count, sizeof *mass), *const area = mass + count;
    reference_bins(&s, values, count, 20, 90, mass, area);
    bins b;
    CHECK(make_bins(&b, NULL, NULL, &grid, &params) == CHI_OK);
    double worst = 0, worst_area = 0, largest = 0, largest_area = 0;
    for (size_t i = 0; i < count; ++i)
    {
      const double wide = 70.0 / (double)count;
      largest = fmax(largest, (double)mass[i]);
      largest_area = fmax(largest_area, (double)area[i]);
      worst = fmax(worst, fabs(b.mass[i] - (double)mass[i]));
      worst_area = fmax(worst_area, fabs(b.iso_area[i] * wide - (double)area[i]));
    }
    /* the bound for bins is 1e-10 of the peak; values move by 2^-51 bins of up to 4096 */
    CHECK(worst < 1e-12 * largest);
    CHECK(worst_area < 1e-12 * largest_area);
    CHECK_NEAR(b.result.total_mass, s.counts.volume, 1e-13 * s.counts.volume);
    CHECK(b.result.simplices == s.counts.tetrahedra);
    drop_bins(&b);
    free(mass);
  }
  drop_view(&grid);
  drop_split(&s);
  free(values);
  free(m);
}

static void moments_are_those_of_the_distribution(void)
{
  /* of the sum of three uniform numbers about its mean 3/2: from the cumulants of uniform numbers,
     1/12, -1/120, 1/252, -1/240 */
  const double k2 = 3.0 / 12, k4 = -3.0 / 120, k6 = 3.0 / 252, k8 = -3.0 / 240;
  const double exact[9] = { 1, 0, k2, 0, k4 + 3 * k2 * k2, 0, k6 + 15 * k4 * k2 + 15 * k2 * k2 * k2,
    0, k8 + 28 * k6 * k2 + 35 * k4 * k4 + 210 * k4 * k2 * k2 + 105 * k2 * k2 * k2 * k2 };
  cube c = make_cube(12, 5, 9, diagonal);
  for (int step = 0; step < 4; ++step)
  {
    const double scale = step == 1 ? 1e-12 : step == 2 ? 1e12 : 1, offset = step == 3 ? 0x1p20 : 0;
    double* const values = malloc(c.points * sizeof *values);
    for (size_t i = 0; i < c.points; ++i)
    {
      values[i] = c.values[i] * scale + offset;
    }
    const chi_array_view field = view_values(values, c.points);
    const chi_histogram_params params = histogram_params(&field, 10, offset, offset + 3 * scale);
    chi_histogram* h = NULL;
    bins b;
    CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
    CHECK(make_bins(&b, NULL, h, &c.view, &params) == CHI_OK);
    /* values are rounded to eps of the offset */
    const double noise = offset > 0 ? 1e-9 : 2e-14;
    CHECK_NEAR(b.result.mean, offset + 1.5 * scale, EPS * (offset + 20 * scale));
    for (int k = 2; k <= 8; ++k)
    {
      const double of = pow(1.5, k);
      CHECK_NEAR(b.result.central_moments[k] / pow(scale, k), exact[k], noise * of);
    }
    /* raw ones: the third of f about 0 is mean^3 + 3 mean variance */
    double third = 0;
    CHECK(chi_histogram_moment(h, 3, &third) == CHI_OK);
    const double mean = offset + 1.5 * scale;
    const double wanted = mean * mean * mean + 3 * mean * 0.25 * scale * scale;
    CHECK_NEAR(third, wanted, 2e-14 * wanted);
    drop_bins(&b);
    chi_histogram_destroy(NULL, h);
    free(values);
  }
  free(c.values);
}

static void quantiles_are_solved_not_read_from_bins(void)
{
  cube c = make_cube(10, 10, 10, diagonal);
  const chi_array_view field = view_values(c.values, c.points);
  const chi_histogram_params params = histogram_params(&field, 3, 0.9, 1.1); /* of no help */
  chi_histogram* h = NULL;
  bins b;
  double q = 0;
  CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
  CHECK(chi_histogram_quantile(NULL, h, 0.5, &q) == CHI_ERROR_NOT_READY);
  CHECK(make_bins(&b, NULL, h, &c.view, &params) == CHI_OK);
  for (int k = 0; k <= 40; ++k)
  {
    const double t = 3.0 * k / 40;
    CHECK(chi_histogram_quantile(NULL, h, (double)below_diagonal(t), &q) == CHI_OK);
    /* 1e-12 of the range; and the share's rounding by the slope t^2 / 2 at the ends */
    const double slope = fmin(1, 0.5 * pow(fmin(t, 3 - t), 2));
    CHECK_NEAR(q, t, 3e-12 + (slope > 0 ? 1e-14 / slope : 0));
  }
  CHECK(chi_histogram_quantile(NULL, h, 0, &q) == CHI_OK && q == 0);
  CHECK(chi_histogram_quantile(NULL, h, 1, &q) == CHI_OK && q == 3);
  CHECK(chi_histogram_quantile(NULL, h, -0.1, &q) == CHI_ERROR_INVALID_ARGUMENT);
  CHECK(chi_histogram_quantile(NULL, h, NAN, &q) == CHI_ERROR_INVALID_ARGUMENT);
  chi_histogram_destroy(NULL, h);
  drop_bins(&b);

  /* cells of constant value: the distribution jumps, at 1, 10 and 100 */
  double of_cells[1000];
  for (int i = 0; i < 1000; ++i)
  {
    of_cells[i] = i % 10 < 3 ? 1 : i % 10 < 8 ? 10 : 100;
  }
  const chi_array_view constants = view_values(of_cells, 1000);
  chi_histogram_params jumps = histogram_params(&constants, 7, 0, 1);
  jumps.association = CHI_HISTOGRAM_CELLS;
  CHECK(chi_histogram_create(NULL, &h) == CHI_OK);
  CHECK(make_bins(&b, NULL, h, &c.view, &jumps) == CHI_OK);
  static const double share[5] = { 0.29, 0.31, 0.79, 0.81, 0.999 };
  static const double value[5] = { 1, 10, 10, 100, 100 };
  for (int k = 0; k < 5; ++k)
  {
    CHECK(chi_histogram_quantile(NULL, h, share[k], &q) == CHI_OK);
    CHECK_NEAR(q, value[k], 99e-12);
  }
  CHECK_NEAR(b.mass[6], 0.3, 1e-15); /* the range's upper end belongs to the last bin */
  CHECK_NEAR(b.result.mass_above, 0.7, 1e-14);
  CHECK_NEAR(b.result.singular_mass, 1, 1e-14);
  chi_histogram_destroy(NULL, h);
  drop_bins(&b);
  free(c.values);
}

static void nothing_is_lost_at_any_scale(void)
{
  cube c = make_cube(19, 11, 21, waves);
  uint32_t seed = 3;
  double* const values = malloc(c.points * sizeof *values);
  for (int k = 0; k < 30; ++k)
  {
    const double scale = pow(10, 24 * chi_test_random(&seed) - 12);
    const double offset = k % 3 ? 0 : scale * 1e6 * chi_test_random(&seed);
    for (size_t i = 0; i < c.points; ++i)
    {
      values[i] = offset + scale * c.values[i];
    }
    const size_t count = 1 + (size_t)(pow(10, 5 * chi_test_random(&seed)));
    const double low = offset + scale * (3 * chi_test_random(&seed) - 2);
    const chi_array_view field = view_values(values, c.points);
    chi_histogram_params params =
      histogram_params(&field, count, low, low + scale * pow(10, 4 * chi_test_random(&seed) - 3));
    params.automatic_range = k % 5 == 0;
    bins b;
    CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
    CHECK_NEAR((double)(sum_of(&b) - 1), 0, 1e-13);
    CHECK_NEAR(b.result.total_mass, 1, 1e-13);
    CHECK(b.result.mass_below >= 0 && b.result.mass_above >= 0);
    CHECK(!params.automatic_range || b.result.mass_below + b.result.mass_above == 0);
    drop_bins(&b);
  }
  free(values);
  free(c.values);
}

static double constant(double x, double y, double z)
{
  (void)x, (void)y, (void)z;
  return 42;
}

static double half_constant(double x, double y, double z)
{
  (void)y, (void)z;
  return x < 0.5 ? 0 : x - 0.5; /* constant in one half of the cube */
}

static void constant_fields_are_deposited_where_they_belong(void)
{
  cube c = make_cube(4, 4, 4, constant);
  const chi_array_view field = view_values(c.values, c.points);
  chi_histogram_params params = histogram_params(&field, 5, 0, 42);
  bins b;
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  CHECK_NEAR(b.mass[4], 1, PARTS); /* the upper end */
  CHECK(b.iso_area[4] == 0 && b.result.singular_mass == b.result.total_mass);
  CHECK(b.result.mean == 42 && b.result.central_moments[2] == 0 && !b.result.is_constant);
  drop_bins(&b);
  params.range[0] = 42; /* the lower end belongs to the first */
  params.range[1] = 43;
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  CHECK_NEAR(b.mass[0], 1, PARTS);
  drop_bins(&b);
  for (int side = -1; side <= 1; side += 2)
  {
    params.range[0] = side < 0 ? 0 : nextafter(42, 50);
    params.range[1] = side < 0 ? nextafter(42, 0) : 50;
    CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
    CHECK_NEAR(side < 0 ? b.result.mass_above : b.result.mass_below, 1, PARTS);
    drop_bins(&b);
  }
  params.automatic_range = 1;
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  CHECK(b.result.is_constant);
  CHECK_NEAR(b.result.range[1] - b.result.range[0], 42e-6, 2e-14);
  CHECK_NEAR(b.mass[2], 1, PARTS);
  drop_bins(&b);
  free(c.values);

  c = make_cube(4, 4, 4, half_constant);
  const chi_array_view half = view_values(c.values, c.points);
  params = histogram_params(&half, 10, 0, 0.5);
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  CHECK_NEAR(b.result.singular_mass, 0.5, PARTS);
  CHECK_NEAR(b.mass[0], 0.55, PARTS);
  for (int i = 1; i < 10; ++i)
  {
    CHECK_NEAR(b.mass[i], 0.05, PARTS);
    CHECK_NEAR(b.iso_area[i], 1, 2 * PARTS);
  }
  drop_bins(&b);
  /* a zero at the upper end of a range is in the last bin, though all else there is above */
  params = histogram_params(&half, 10, -1, 0);
  for (int skips = 0; skips < 2; ++skips)
  {
    params.no_skipping = skips ? 0 : CHI_HISTOGRAM_SKIP_OUTSIDE | CHI_HISTOGRAM_SKIP_ONE_BIN;
    CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
    CHECK_NEAR(b.mass[9], 0.5, PARTS);
    CHECK_NEAR(b.result.mass_above, 0.5, PARTS);
    drop_bins(&b);
  }
  free(c.values);
}

static void cells_that_cannot_count_are_counted(void)
{
  enum
  {
    N = 10
  };
  cube c = make_cube(N, N, N, waves);
  uint8_t cell_ghosts[N * N * N] = { 0 }, point_ghosts[(N + 1) * (N + 1) * (N + 1)] = { 0 };
  c.values[0] = NAN;                          /* one cell */
  c.values[5 + 11 * 5 + 121 * 5] = INFINITY;  /* eight */
  c.values[5 + 11 * 5] = 1e101;               /* four */
  point_ghosts[1330] = CHI_GRID_HIDDEN_POINT; /* one */
  cell_ghosts[1] = CHI_GRID_DUPLICATE_CELL;
  cell_ghosts[2] = CHI_GRID_HIDDEN_CELL;
  c.view.cell_ghosts = cell_ghosts;
  c.view.point_ghosts = point_ghosts;
  const chi_array_view field = view_values(c.values, c.points);
  const chi_histogram_params params = histogram_params(&field, 64, -3, 3);
  bins image, list;
  CHECK(make_bins(&image, NULL, NULL, &c.view, &params) == CHI_OK);
  const chi_histogram_result* const r = &image.result;
  CHECK(r->skipped_cells == 13 && r->ghost_cells == 1 && r->blanked_cells == 2);
  CHECK(r->cells == N * N * N - 16 && r->simplices == 6 * r->cells);
  CHECK_NEAR(r->total_mass, 0.984, PARTS);
  CHECK_NEAR((double)sum_of(&image), 0.984, PARTS);
  double(*const points)[3] = malloc(c.points * sizeof *points);
  for (size_t i = 0; i < c.points; ++i)
  {
    points[i][0] = (double)(i % 11) / N;
    points[i][1] = (double)(i / 11 % 11) / N;
    points[i][2] = (double)(i / 121) / N;
  }
  chi_grid_view grid = c.view;
  grid.kind = CHI_GRID_CURVILINEAR;
  grid.points = (chi_vec3_view){ points, c.points, sizeof points[0], CHI_F64 };
  CHECK(make_bins(&list, NULL, NULL, &grid, &params) == CHI_OK);
  CHECK(list.result.skipped_cells == 13 && list.result.ghost_cells == 1 &&
    list.result.blanked_cells == 2);
  for (size_t i = 0; i < 64; ++i)
  {
    CHECK_NEAR(list.mass[i], image.mass[i], PARTS);
  }
  drop_bins(&list);
  points[3][1] = NAN;
  CHECK(make_bins(&list, NULL, NULL, &grid, &params) == CHI_OK);
  CHECK(list.result.skipped_cells == 14); /* two cells, one of them blanked already */
  drop_bins(&list);
  drop_bins(&image);
  free(points);
  free(c.values);
}

static double plane(double x, double y, double z)
{
  (void)z;
  return x + y;
}

static void cells_of_two_dimensions_count_by_area(void)
{
  cube c = make_cube(13, 7, 0, plane);
  const chi_array_view field = view_values(c.values, c.points);
  const chi_histogram_params params = histogram_params(&field, 40, 0, 2);
  bins b;
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  CHECK(b.result.dimension == 2 && b.result.cells == 91 && b.result.simplices == 182);
  for (int i = 0; i < 40; ++i)
  {
    const double middle = (i + 0.5) / 20, height = middle < 1 ? middle : 2 - middle;
    CHECK_NEAR(b.density[i], height, 1e-14);
    CHECK_NEAR(b.iso_area[i], height * sqrt(2.0), 2e-14); /* |grad f| = sqrt 2 */
  }
  CHECK_NEAR(b.result.central_moments[2], 1.0 / 6, 1e-15);
  drop_bins(&b);
  free(c.values);

  /* a triangle, a strip, an L of six corners, a pixel, a quadrilateral; a vertex and a line beside.
     All have their points' x as values */
  mesh* const m = new_mesh();
  static const double x[][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 2, 0 }, { 2, 1 },
    { 3, 0 }, { 3, 1 }, { 5, 0 }, { 5, 1 }, { 4, 1 }, { 4, 2 }, { 3, 2 } };
  for (size_t i = 0; i < sizeof x / sizeof x[0]; ++i)
  {
    add_point(m, x[i][0], x[i][1], 7);
  }
  add_cell(m, 5, 3, (const int64_t[3]){ 0, 1, 2 });             /* 1/2 */
  add_cell(m, 6, 4, (const int64_t[4]){ 1, 2, 4, 5 });          /* 1 */
  add_cell(m, 7, 6, (const int64_t[6]){ 6, 8, 9, 10, 11, 12 }); /* 3 */
  add_cell(m, 8, 4, (const int64_t[4]){ 4, 6, 5, 7 });          /* 1 */
  add_cell(m, 9, 4, (const int64_t[4]){ 0, 1, 2, 3 });          /* 1 */
  add_cell(m, 1, 1, (const int64_t[1]){ 0 });
  add_cell(m, 3, 2, (const int64_t[2]){ 0, 1 });
  double values[13];
  for (int i = 0; i < 13; ++i)
  {
    values[i] = x[i][0];
  }
  chi_grid_view grid = view_of(m);
  const chi_array_view across = view_values(values, 13);
  chi_histogram_params q = histogram_params(&across, 5, 0, 5);
  CHECK(make_bins(&b, NULL, NULL, &grid, &q) == CHI_OK);
  static const double area[5] = { 1.5, 1, 1, 2, 1 };
  for (int i = 0; i < 5; ++i)
  {
    CHECK_NEAR(b.mass[i], area[i], 1e-14);
    CHECK_NEAR(b.iso_area[i], area[i], 2e-14); /* |grad x| = 1 */
  }
  CHECK(b.result.cells == 5 && b.result.lower_dimensional_cells == 2);
  drop_bins(&b);
  const double of_cells[7] = { 0, 1, 2, 3, 4, 5, 6 };
  const chi_array_view constants = view_values(of_cells, 7);
  q = histogram_params(&constants, 5, -0.5, 4.5);
  q.association = CHI_HISTOGRAM_CELLS;
  CHECK(make_bins(&b, NULL, NULL, &grid, &q) == CHI_OK);
  static const double each[5] = { 0.5, 1, 3, 1, 1 };
  for (int i = 0; i < 5; ++i)
  {
    CHECK_NEAR(b.mass[i], each[i], 1e-14);
  }
  drop_bins(&b);
  drop_view(&grid);
  /* beside a tetrahedron they do not count */
  const int64_t top = add_point(m, 0, 0, 9);
  add_cell(m, 10, 4, (const int64_t[4]){ 0, 1, 2, top });
  double more[14] = { 0 };
  memcpy(more, values, sizeof values);
  grid = view_of(m);
  const chi_array_view longer = view_values(more, 14);
  q = histogram_params(&longer, 5, 0, 5);
  CHECK(make_bins(&b, NULL, NULL, &grid, &q) == CHI_OK);
  CHECK(b.result.dimension == 3 && b.result.cells == 1);
  CHECK(b.result.lower_dimensional_cells == 7);
  CHECK_NEAR(b.result.total_mass, 1.0 / 3, 1e-15);
  drop_bins(&b);
  drop_view(&grid);
  free(m);
}

static void types_strides_and_magnitudes_agree(void)
{
  enum
  {
    N = 9,
    POINTS = (N + 1) * (N + 1) * (N + 1)
  };
  cube c = make_cube(N, N, N, waves);
  static const chi_type types[] = { CHI_F32, CHI_F64, CHI_I8, CHI_U8, CHI_I16, CHI_U16, CHI_I32,
    CHI_U32, CHI_I64, CHI_U64 };
  static char bytes[POINTS * 40];
  double whole[POINTS], vector[POINTS][3];
  for (int i = 0; i < POINTS; ++i)
  {
    whole[i] = floor(50 + 20 * c.values[i]);
    vector[i][0] = 3 * whole[i];
    vector[i][1] = -4 * whole[i];
    vector[i][2] = 0;
  }
  const chi_array_view field = view_values(whole, POINTS);
  chi_histogram_params params = histogram_params(&field, 50, 0, 127);
  bins first, b;
  CHECK(make_bins(&first, NULL, NULL, &c.view, &params) == CHI_OK);
  for (size_t k = 0; k < sizeof types / sizeof types[0]; ++k)
  {
    const size_t size = chi_type_size(types[k]);
    const chi_array_view other = { bytes, POINTS, 2, 40, types[k] };
    for (int i = 0; i < POINTS; ++i)
    {
      const double v = whole[i];
      const float f = (float)v;
      const int64_t w = (int64_t)v; /* little-endian: its low bytes are the number */
      memcpy(bytes + 40 * i + size,
        types[k] == CHI_F32     ? (const void*)&f
          : types[k] == CHI_F64 ? (const void*)&v
                                : &w,
        size);
    }
    params.field = &other;
    params.component = 1;
    CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
    CHECK(memcmp(b.mass, first.mass, 50 * sizeof(double)) == 0);
    drop_bins(&b);
  }
  const chi_array_view vectors = { vector, POINTS, 3, sizeof vector[0], CHI_F64 };
  params.field = &vectors;
  params.component = -1;
  params.range[1] = 5 * 127;
  CHECK(make_bins(&b, NULL, NULL, &c.view, &params) == CHI_OK);
  for (int i = 0; i < 50; ++i)
  {
    CHECK_NEAR(b.mass[i], first.mass[i], 1e-14);
  }
  drop_bins(&b);
  drop_bins(&first);
  free(c.values);
}

int main(void)
{
  one_tetrahedron_is_a_quadratic_spline();
  a_linear_field_on_a_cube_is_a_box_spline();
  every_kind_of_grid_agrees();
  any_mesh_agrees_with_long_double();
  moments_are_those_of_the_distribution();
  quantiles_are_solved_not_read_from_bins();
  nothing_is_lost_at_any_scale();
  constant_fields_are_deposited_where_they_belong();
  cells_that_cannot_count_are_counted();
  cells_of_two_dimensions_count_by_area();
  types_strides_and_magnitudes_agree();
  return chi_test_report();
}
