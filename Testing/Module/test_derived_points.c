/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fields from derivatives on unstructured grids. */

#include "derived_fields.h"

enum
{
  TETRAHEDRA,
  HEXAHEDRA,
  TRIANGLES
};

/* A cube of side 1.2 in n^3 points, those inside moved by a share of the spacing, as cells. */
static derived make_mesh(size_t n, int cells, double jitter)
{
  const double h = 1.2 / (double)(n - 1);
  const double m[12] = { h, 0, 0, -0.3, 0, h, 0, -0.2, 0, 0, h, -0.5 };
  derived d = make_image(n, n, n, m);
  chi_grid_counts counts;
  CHECK(chi_grid_count(NULL, &d.view, &counts) == CHI_OK);
  const size_t cubes = (n - 1) * (n - 1) * (n - 1);
  const size_t size = cells == TETRAHEDRA ? 4 : 8;
  const size_t count = cells == TETRAHEDRA ? counts.tetrahedra : cubes;
  uint32_t* const vertices = derived_room(4 * counts.tetrahedra * sizeof *vertices);
  const chi_grid_tetrahedra out = { .struct_size = sizeof out, .vertices = vertices };
  CHECK(chi_grid_split(NULL, &d.view, &counts, &out) == CHI_OK);
  uint8_t* const types = d.memory[0] = derived_room(count);
  int64_t* const offsets = d.memory[1] = derived_room((count + 1) * sizeof *offsets);
  int64_t* const ids = d.memory[2] = derived_room(size * count * sizeof *ids);
  for (size_t c = 0; c < count; ++c)
  {
    const size_t first =
      c % (n - 1) + n * (c / (n - 1) % (n - 1)) + n * n * (c / (n - 1) / (n - 1));
    types[c] = cells == TETRAHEDRA ? 10 : 12;
    offsets[c] = (int64_t)(size * c);
    for (size_t k = 0; k < size; ++k)
    {
      ids[size * c + k] = cells == TETRAHEDRA
        ? (int64_t)vertices[4 * c + k]
        : (int64_t)(first + ((k + 1) >> 1 & 1) + (k >> 1 & 1) * n + (k >> 2) * n * n);
    }
  }
  offsets[count] = (int64_t)(size * count);
  free(vertices);
  uint32_t seed = 17;
  for (size_t i = 0; i < d.points; ++i)
  {
    const size_t at[3] = { i % n, i / n % n, i / (n * n) };
    for (int a = 0; a < 3; ++a)
    {
      const double move = jitter * h * (2 * chi_test_random(&seed) - 1);
      d.x[3 * i + a] += at[a] > 0 && at[a] < n - 1 ? move : 0;
    }
  }
  d.view = (chi_grid_view){ .struct_size = sizeof d.view,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { d.x, d.points, 3 * sizeof(double), CHI_F64 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = count,
    .connectivity_count = size * count };
  return d;
}

static void quadratic_fields_are_exact_on_any_mesh(void)
{
  for (int cells = TETRAHEDRA; cells <= HEXAHEDRA; ++cells)
  {
    for (int degree = 1; degree <= 2; ++degree)
    {
      derived d = make_mesh(7, cells, 0.3);
      const jet_fn f = degree == 1 ? linear : quadratic;
      sample(&d, f);
      CHECK(run_derived(&d, NULL) == CHI_OK);
      double error[ALL];
      find_errors(&d, f, NULL, error);
      for (int k = 0; k < ALL; ++k)
      {
        CHECK_NEAR(error[k], 0, 1e-10); /* eps / h^2 = 6e-15 times the condition of a fit, 1e3 */
      }
      CHECK(d.counts.linear_points == 0 && d.counts.undetermined_points == 0);
      free_derived(&d);
    }
  }
}

static int is_inside(const derived* d, size_t i)
{
  const double* const x = d->x + 3 * i;
  return x[0] > 0 && x[0] < 0.6 && x[1] > 0.1 && x[1] < 0.7 && x[2] > -0.2 && x[2] < 0.4;
}

static void errors_fall_by_the_order(void)
{
  /* slopes of the largest error between spacings of 0.06 and 0.03: gradient, then second
   * derivatives; inside where neighbours lie symmetrically, else everywhere; the next term costs up
   * to 0.4 */
  static const double expected[3][2] = { { 2, 2 }, { 2, 1 }, { 2, 1 } };
  for (int cells = TETRAHEDRA; cells <= HEXAHEDRA; ++cells)
  {
    for (int k = 0; k < 3; ++k)
    {
      double error[2][ALL];
      for (int level = 0; level < 2; ++level)
      {
        derived d = make_mesh(level ? 41 : 21, cells, k == 2 ? 0.25 : 0);
        sample(&d, waves);
        CHECK(run_derived(&d, NULL) == CHI_OK);
        find_errors(&d, waves, k == 0 ? is_inside : NULL, error[level]);
        free_derived(&d);
      }
      for (int q = 0; q < ALL; ++q)
      {
        const double slope = log2(error[0][q] / error[1][q]);
        CHECK(slope > expected[k][q > 0] - 0.4);
      }
    }
  }
}

static void spheres_have_their_curvature_on_tetrahedra(void)
{
  derived d = make_mesh(31, TETRAHEDRA, 0.2);
  sample(&d, sphere);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double error[ALL];
  find_errors(&d, sphere, NULL, error);
  /* second derivatives: first order in h = 0.04 with third derivatives of up to 1: measured 0.012
   */
  CHECK_NEAR(error[0], 0, 2e-3);
  CHECK_NEAR(error[3], 0, 0.04);
  free_derived(&d);
}

/* Points at the boundary see two layers, which are not quite flat: the second derivative across
 * is no less certain for that. */
static void bent_layers_magnify_nothing(void)
{
  derived d = make_mesh(25, HEXAHEDRA, 0);
  for (size_t i = 0; i < d.points; ++i)
  {
    double* const x = d.x + 3 * i;
    const double old = x[0];
    x[0] += 0.03 * sin(2 * x[1]);
    x[1] += 0.03 * sin(2 * x[2]);
    x[2] += 0.03 * sin(2 * old);
  }
  sample(&d, sphere);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double error[ALL];
  find_errors(&d, sphere, NULL, error);
  /* h = 0.05, third derivatives of up to 3 / r^2 = 0.9: h^2 and h times these */
  CHECK_NEAR(error[0], 0, 2e-3);
  CHECK_NEAR(error[2], 0, 0.05);
  CHECK(d.counts.linear_points == 0);
  free_derived(&d);
}

/* A plane that leans in space, as triangles: derivatives within it. */
static void a_sheet_has_the_derivatives_within_it(void)
{
  enum
  {
    N = 9
  };
  const double m[12] = { 0.1, 0.02, 0, 1, 0, 0.09, 0, 2, 0.05, -0.03, 0, 3 };
  derived d = make_image(N, N, 1, m);
  int64_t ids[6 * (N - 1) * (N - 1)], offsets[2 * (N - 1) * (N - 1) + 1];
  uint8_t types[2 * (N - 1) * (N - 1)];
  size_t count = 0;
  for (int64_t q = 0; q < (N - 1) * (N - 1); ++q)
  {
    const int64_t a = q % (N - 1) + q / (N - 1) * N;
    const int64_t two[6] = { a, a + 1, a + N + 1, a, a + N + 1, a + N };
    for (int t = 0; t < 2; ++t, ++count)
    {
      memcpy(ids + 3 * count, two + 3 * t, 3 * sizeof *ids);
      offsets[count] = (int64_t)(3 * count);
      types[count] = 5;
    }
  }
  offsets[count] = (int64_t)(3 * count);
  d.view = (chi_grid_view){ .struct_size = sizeof d.view,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { d.x, d.points, 3 * sizeof(double), CHI_F64 },
    .cell_types = types,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = count,
    .connectivity_count = 3 * count };
  sample(&d, quadratic);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  /* the projection of gradient and second derivatives onto the plane */
  const double u[3] = { 0.1, 0, 0.05 }, v[3] = { 0.02, 0.09, -0.03 };
  const double uu = u[0] * u[0] + u[2] * u[2];
  const double uv = u[0] * v[0] + u[2] * v[2];
  double e[2][3], l = 0;
  for (int a = 0; a < 3; ++a)
  {
    e[0][a] = u[a] / sqrt(uu);
    e[1][a] = v[a] - uv / uu * u[a];
    l += e[1][a] * e[1][a];
  }
  double worst = 0;
  for (size_t i = 0; i < d.points; ++i)
  {
    const jet j = quadratic(d.x + 3 * i);
    jet in = { 0 };
    for (int b = 0; b < 2; ++b)
    {
      double t[3];
      for (int a = 0; a < 3; ++a)
      {
        t[a] = e[b][a] / (b ? sqrt(l) : 1);
        in.first[b] += t[a] * j.first[a];
      }
      in.second[b] = j.second[0] * t[0] * t[0] + j.second[1] * t[1] * t[1] +
        j.second[2] * t[2] * t[2] +
        2 * (j.second[3] * t[0] * t[1] + j.second[4] * t[0] * t[2] + j.second[5] * t[1] * t[2]);
    }
    worst = fmax(worst, fabs(d.out[0][i] - hypot(in.first[0], in.first[1])));
    worst = fmax(worst, fabs(d.out[2][i] - in.second[0] - in.second[1]));
  }
  CHECK_NEAR(worst, 0, 1e-9); /* eps |f| / h^2 = 1e-12, times the condition of a fit */
  CHECK(d.counts.undetermined_points == 0 && d.counts.linear_points == 0);
  free_derived(&d);
}

static void few_neighbours_give_what_they_can_and_are_counted(void)
{
  double x[4 * 3 + 3] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 5, 5 }, values[5];
  for (int i = 0; i < 5; ++i)
  {
    values[i] = 2 * x[3 * i] - 3 * x[3 * i + 1] + 6 * x[3 * i + 2] + 1;
  }
  const int64_t ids[4] = { 0, 1, 2, 3 }, offsets[2] = { 0, 4 };
  const uint8_t type = 10;
  double out[ALL][5];
  const chi_grid_view view = { .struct_size = sizeof view,
    .kind = CHI_GRID_UNSTRUCTURED,
    .points = { x, 5, 3 * sizeof(double), CHI_F64 },
    .cell_types = &type,
    .offsets = offsets,
    .connectivity = ids,
    .cell_count = 1,
    .connectivity_count = 4 };
  const chi_array_view array = { values, 5, 1, sizeof(double), CHI_F64 };
  const chi_derived_arrays arrays = { sizeof arrays, CHI_F64, 0, out[0], out[1], out[2], out[3] };
  chi_derived_counts counts;
  CHECK(chi_derived_compute(NULL, &view, &array, NULL, &arrays, &counts) == CHI_OK);
  CHECK(counts.linear_points == 4 && counts.undetermined_points == 1);
  for (int i = 0; i < 4; ++i)
  {
    CHECK_NEAR(out[0][i], 7, 1e-13);
    CHECK(out[1][i] == 0 && out[2][i] == 0 && out[3][i] == 0);
  }
  CHECK(isnan(out[0][4]) && isnan(out[3][4]));
}

static void hidden_cells_and_points_do_not_count(void)
{
  derived d = make_mesh(7, HEXAHEDRA, 0);
  const size_t cells = d.view.cell_count;
  uint8_t* const cell_ghosts = calloc(cells, 1);
  uint8_t* const point_ghosts = calloc(d.points, 1);
  sample(&d, quadratic);
  cell_ghosts[0] = CHI_GRID_HIDDEN_CELL; /* alone has the first point */
  cell_ghosts[1] = CHI_GRID_DUPLICATE_CELL;
  d.values[0] = 1e9;
  d.view.cell_ghosts = cell_ghosts;
  CHECK(run_derived(&d, NULL) == CHI_OK);
  CHECK(d.counts.undetermined_points == 1 && isnan(d.out[0][0]));
  double error[ALL];
  d.values[0] = quadratic(d.x).value;
  d.out[0][0] = d.out[1][0] = d.out[2][0] = d.out[3][0] = 0;
  find_errors(&d, quadratic, is_inside, error);
  CHECK_NEAR(error[2], 0, 1e-6); /* the range is 1e9: eps of the units, not of the values */
  d.view.cell_ghosts = NULL;
  d.view.point_ghosts = point_ghosts;
  point_ghosts[d.points / 2] = CHI_GRID_HIDDEN_POINT;
  CHECK(run_derived(&d, NULL) == CHI_OK);
  CHECK(d.counts.non_finite_points == 27 && isnan(d.out[0][d.points / 2]));
  free(cell_ghosts);
  free(point_ghosts);
  free_derived(&d);
}

/* The order of points and cells means nothing but rounding. */
static void numbering_does_not_matter(void)
{
  derived d = make_mesh(6, TETRAHEDRA, 0.2), e = make_mesh(6, TETRAHEDRA, 0.2);
  sample(&d, waves);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  int64_t* const ids = e.memory[2];
  for (size_t i = 0; i < e.points; ++i)
  {
    const size_t to = i * 101 % e.points; /* a prime that 216 lacks */
    memcpy(e.x + 3 * to, d.x + 3 * i, 3 * sizeof(double));
  }
  for (size_t k = 0; k < e.view.connectivity_count; ++k)
  {
    ids[k] = (int64_t)((size_t)ids[k] * 101 % e.points);
  }
  sample(&e, waves);
  CHECK(run_derived(&e, NULL) == CHI_OK);
  double worst = 0;
  for (size_t i = 0; i < e.points; ++i)
  {
    worst = fmax(worst, fabs(d.out[2][i] - e.out[2][i * 101 % e.points]));
  }
  CHECK_NEAR(worst, 0, 1e-10);
  free_derived(&d);
  free_derived(&e);
}

static void broken_cells_are_refused(void)
{
  derived d = make_mesh(3, HEXAHEDRA, 0);
  int64_t* const ids = d.memory[2];
  int64_t* const offsets = d.memory[1];
  sample(&d, linear);
  const int64_t old = ids[5];
  ids[5] = (int64_t)d.points;
  CHECK(run_derived(&d, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  ids[5] = -1;
  CHECK(run_derived(&d, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  ids[5] = old;
  offsets[1] = 20;
  CHECK(run_derived(&d, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  offsets[1] = 8;
  offsets[8] = 65;
  CHECK(run_derived(&d, NULL) == CHI_ERROR_INVALID_ARGUMENT);
  offsets[8] = 64;
  CHECK(run_derived(&d, NULL) == CHI_OK);
  free_derived(&d);
}

int main(void)
{
  quadratic_fields_are_exact_on_any_mesh();
  errors_fall_by_the_order();
  spheres_have_their_curvature_on_tetrahedra();
  bent_layers_magnify_nothing();
  a_sheet_has_the_derivatives_within_it();
  few_neighbours_give_what_they_can_and_are_counted();
  hidden_cells_and_points_do_not_count();
  numbering_does_not_matter();
  broken_cells_are_refused();
  return chi_test_report();
}
