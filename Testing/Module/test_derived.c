/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fields from derivatives on structured grids, against fields whose derivatives are known. */

#include "derived_fields.h"

/* Lengths of 0.05 to 0.2, none of them a binary fraction. */
static const double straight[12] = { 0.07, 0, 0, -0.4, 0, 0.11, 0, 0.2, 0, 0, 0.05, 0.1 };

/* The same, turned about (1, 2, 3) by 0.7: Rodrigues' formula. */
static void turn(double m[12])
{
  const double s = sin(0.7), c = cos(0.7), l = sqrt(14);
  const double k[3] = { 1 / l, 2 / l, 3 / l };
  const double r[3][3] = { { c + k[0] * k[0] * (1 - c), k[0] * k[1] * (1 - c) - k[2] * s,
                             k[0] * k[2] * (1 - c) + k[1] * s },
    { k[1] * k[0] * (1 - c) + k[2] * s, c + k[1] * k[1] * (1 - c),
      k[1] * k[2] * (1 - c) - k[0] * s },
    { k[2] * k[0] * (1 - c) - k[1] * s, k[2] * k[1] * (1 - c) + k[0] * s,
      c + k[2] * k[2] * (1 - c) } };
  double turned[12];
  for (int x = 0; x < 3; ++x)
  {
    for (int a = 0; a < 4; ++a)
    {
      turned[4 * x + a] = r[x][0] * m[a] + r[x][1] * m[4 + a] + r[x][2] * m[8 + a];
    }
  }
  memcpy(m, turned, sizeof turned);
}

static void shear(double m[12])
{
  m[1] += 0.04; /* the second axis leans to the first, the third to both */
  m[2] -= 0.02;
  m[6] += 0.03;
}

/* Rectilinear, with the coordinates of an image's axes, unevenly. */
static void make_uneven(derived* d)
{
  d->view.kind = CHI_GRID_RECTILINEAR;
  for (int a = 0; a < 3; ++a)
  {
    const size_t n = d->view.dimensions[a];
    double* const at = d->memory[a] = derived_room(n * sizeof(double));
    for (size_t i = 0; i < n; ++i)
    {
      const double u = (double)i + 0.3 * sin(2.1 * (double)i);
      at[i] = straight[5 * a] * (a == 1 ? -u : u); /* one of them backwards */
    }
    d->view.axes[a] = (chi_array_view){ at, n, 1, sizeof(double), CHI_F64 };
  }
  for (size_t i = 0; i < d->points; ++i)
  {
    const size_t nx = d->view.dimensions[0], ny = d->view.dimensions[1];
    d->x[3 * i] = ((double*)d->memory[0])[i % nx];
    d->x[3 * i + 1] = ((double*)d->memory[1])[i / nx % ny];
    d->x[3 * i + 2] = ((double*)d->memory[2])[i / (nx * ny)];
  }
}

/* Curvilinear: the points, bent smoothly. */
static void make_bent(derived* d, double amount)
{
  d->view.kind = CHI_GRID_CURVILINEAR;
  d->view.points = (chi_vec3_view){ d->x, d->points, 3 * sizeof(double), CHI_F64 };
  for (size_t i = 0; i < d->points; ++i)
  {
    double* const x = d->x + 3 * i;
    const double old[3] = { x[0], x[1], x[2] };
    x[0] += amount * sin(1.3 * old[1] + 0.4 * old[2]);
    x[1] += amount * cos(1.1 * old[2] - 0.7 * old[0]);
    x[2] += amount * sin(0.9 * old[0] + 0.8 * old[1]);
  }
}

static void polynomials_up_to_the_order_are_exact_to_the_boundary(void)
{
  for (int order = 2; order <= 4; order += 2)
  {
    for (int kind = 0; kind < 4; ++kind)
    {
      double m[12];
      memcpy(m, straight, sizeof m);
      if (kind == 1)
      {
        turn(m);
      }
      if (kind == 2)
      {
        shear(m);
        turn(m);
      }
      derived d = make_image(9, 8, 11, m);
      d.params.order = order;
      if (kind == 3)
      {
        make_uneven(&d);
      }
      /* rounding: eps |f| / h^2 with |f| up to 100, h = 0.05, and weights that add up to 30 */
      const double tolerance = 2e-16 * 100 / 0.0025 * 30;
      double error[ALL];
      const jet_fn of[] = { linear, quadratic, cubic, quartic };
      for (int degree = 1; degree <= order; ++degree)
      {
        sample(&d, of[degree - 1]);
        CHECK(run_derived(&d, NULL) == CHI_OK);
        find_errors(&d, of[degree - 1], NULL, error);
        for (int k = 0; k < ALL; ++k)
        {
          /* curvature divides by the gradient, which is above 0.2 where it is looked at */
          CHECK_NEAR(error[k], 0, k == 3 ? tolerance * 5 : tolerance);
        }
        CHECK(d.counts.flat_points == 0 && d.counts.non_finite_points == 0 &&
          d.counts.undetermined_points == 0 && d.counts.points == d.points);
      }
      free_derived(&d);
    }
  }
}

/* Second derivatives along one axis are exact one degree further. */
static void laplacians_of_one_degree_more_are_exact(void)
{
  derived d = make_image(9, 8, 11, straight);
  double error[ALL];
  sample(&d, cubic);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  find_errors(&d, cubic, NULL, error);
  CHECK_NEAR(error[2], 0, 1e-9);
  CHECK(error[0] > 1e-4); /* the gradient is not */
  free_derived(&d);
}

static double order_between(const double coarse[ALL], const double fine[ALL], int k, double ratio)
{
  return log(coarse[k] / fine[k]) / log(ratio);
}

/* A cube of side 1.2 in n samples. */
static derived make_cube(size_t n, int kind)
{
  const double h = 1.2 / (double)(n - 1);
  double m[12] = { h, 0, 0, -0.3, 0, h, 0, -0.2, 0, 0, h, -0.5 };
  if (kind == 1)
  {
    turn(m);
  }
  derived d = make_image(n, n, n, m);
  if (kind == 2)
  {
    make_bent(&d, 0.1);
  }
  return d;
}

static void errors_fall_by_the_order_everywhere(void)
{
  const jet_fn of[] = { waves, sphere, cylinder };
  for (int f = 0; f < 3; ++f)
  {
    for (int kind = 0; kind < 3; ++kind)
    {
      for (int order = 2; order <= 4; order += 2)
      {
        double error[2][ALL];
        for (int level = 0; level < 2; ++level)
        {
          derived d = make_cube(level ? 41 : 21, kind);
          d.params.order = order;
          sample(&d, of[f]);
          CHECK(run_derived(&d, NULL) == CHI_OK);
          find_errors(&d, of[f], NULL, error[level]);
          CHECK(d.counts.undetermined_points == 0);
          free_derived(&d);
        }
        for (int k = 0; k < ALL; ++k)
        {
          /* the next term of the error is up to a quarter of the first at this spacing */
          CHECK(order_between(error[0], error[1], k, 2) > order - 0.45);
        }
      }
    }
  }
}

static void spheres_and_cylinders_have_their_curvatures(void)
{
  derived d = make_cube(41, 1);
  d.params.order = 4;
  const jet_fn of[] = { sphere, cylinder };
  for (int f = 0; f < 2; ++f)
  {
    sample(&d, of[f]);
    CHECK(run_derived(&d, NULL) == CHI_OK);
    double worst[ALL] = { 0 };
    for (size_t i = 0; i < d.points; ++i)
    {
      const double r = d.values[i];
      const double exact[ALL] = { 1, 0, (f ? 1 : 2) / r, (f ? 0.5 : 1) / r };
      for (int k = 0; k < ALL; ++k)
      {
        worst[k] = fmax(worst[k], fabs(d.out[k][i] - exact[k]));
      }
    }
    /* h^4 = 8e-7, derivatives of order six of up to 100, one-sided weights of 10: measured 2e-5 */
    for (int k = 0; k < ALL; ++k)
    {
      CHECK_NEAR(worst[k], 0, 2e-4);
    }
  }
  free_derived(&d);
}

static void linear_fields_are_exact_on_any_curvilinear_grid(void)
{
  derived d = make_image(7, 6, 8, straight);
  make_bent(&d, 0.02);
  uint32_t seed = 5;
  for (size_t i = 0; i < 3 * d.points; ++i)
  {
    d.x[i] += 0.01 * (2 * chi_test_random(&seed) - 1); /* not smooth at all */
  }
  sample(&d, linear);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double error[ALL];
  find_errors(&d, linear, NULL, error);
  for (int k = 0; k < ALL; ++k)
  {
    CHECK_NEAR(error[k], 0, 1e-9); /* eps / h^2 times the skewness of the cells */
  }
  free_derived(&d);
}

/* A curved sheet: the Laplace-Beltrami operator and the gradient within it. */
static void a_curved_sheet_has_the_derivatives_within_it(void)
{
  enum
  {
    N = 81
  };
  const double m[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 };
  derived d = make_image(N, N, 1, m);
  d.params.order = 4;
  make_bent(&d, 0);
  for (size_t i = 0; i < d.points; ++i)
  {
    const double u = 0.5 + 1.5 * (double)(i % N) / (N - 1), v = 2.0 * (double)(i / N) / (N - 1);
    d.x[3 * i] = sin(u) * cos(v); /* a unit sphere, away from its poles */
    d.x[3 * i + 1] = sin(u) * sin(v);
    d.x[3 * i + 2] = cos(u);
    d.values[i] = cos(u); /* a spherical harmonic: its Laplacian is -2 times itself */
  }
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double worst[2] = { 0, 0 };
  for (size_t i = 0; i < d.points; ++i)
  {
    worst[0] = fmax(worst[0], fabs(d.out[0][i] - sqrt(1 - d.values[i] * d.values[i])));
    worst[1] = fmax(worst[1], fabs(d.out[2][i] + 2 * d.values[i]));
  }
  CHECK_NEAR(worst[0], 0, 1e-6); /* h = 0.02: h^4 = 1.6e-7 */
  CHECK_NEAR(worst[1], 0, 1e-5);
  CHECK(d.counts.undetermined_points == 0);
  free_derived(&d);
}

static void marschner_and_lobbs_signal_is_resolved(void)
{
  double last[ALL] = { 0 };
  for (size_t n = 41; n <= 81; n += 40)
  {
    const double h = 1.6 / (double)(n - 1);
    const double m[12] = { h, 0, 0, -0.8, 0, h, 0, -0.75, 0, 0, h, -0.7 };
    derived d = make_image(n, n, n, m);
    d.params.order = 4;
    sample(&d, marschner_lobb);
    CHECK(run_derived(&d, NULL) == CHI_OK);
    double error[ALL];
    find_errors(&d, marschner_lobb, NULL, error);
    for (int k = 0; k < 3 && n > 41; ++k)
    {
      CHECK(order_between(last, error, k, 2) > 3); /* a wave in 8 samples: short of its limit */
    }
    memcpy(last, error, sizeof last);
    free_derived(&d);
  }
}

/* Of one sample along an axis nothing changes; of two only the first derivative is known. */
static void thin_images_have_what_their_samples_say(void)
{
  static const size_t size[][3] = { { 1, 7, 8 }, { 7, 1, 8 }, { 7, 8, 1 }, { 2, 7, 8 }, { 7, 2, 8 },
    { 7, 8, 2 }, { 1, 1, 9 }, { 9, 1, 1 }, { 1, 1, 1 }, { 2, 2, 2 }, { 3, 3, 3 }, { 3, 4, 5 } };
  for (size_t s = 0; s < sizeof size / sizeof size[0]; ++s)
  {
    for (int order = 2; order <= 4; order += 2)
    {
      const size_t* const n = size[s];
      double m[12];
      memcpy(m, straight, sizeof m);
      for (int a = 0; a < 3; ++a)
      {
        m[5 * a] *= n[a] > 1; /* of no length, too */
      }
      turn(m);
      derived d = make_image(n[0], n[1], n[2], m);
      d.params.order = order;
      for (size_t i = 0; i < d.points; ++i)
      {
        const double x = straight[0] * (double)(i % n[0]);
        const double y = straight[5] * (double)(i / n[0] % n[1]);
        const double z = straight[10] * (double)(i / (n[0] * n[1]));
        d.values[i] = 3 * x - 2 * y + 5 * z + 2 * x * x + y * z;
      }
      CHECK(run_derived(&d, NULL) == CHI_OK);
      double worst = 0;
      for (size_t i = 0; i < d.points; ++i)
      {
        const double x = straight[0] * (double)(i % n[0]);
        const double y = straight[5] * (double)(i / n[0] % n[1]);
        const double z = straight[10] * (double)(i / (n[0] * n[1]));
        /* of two samples the difference, which is the derivative in their middle */
        const double fx = n[0] == 1 ? 0 : n[0] == 2 ? 3 + 2 * straight[0] : 3 + 4 * x;
        const double fy = n[1] == 1 ? 0 : z - 2, fz = n[2] == 1 ? 0 : y + 5;
        const double h[6] = { n[0] < 3 ? 0 : 4, 0, 0, 0, 0, n[1] > 1 && n[2] > 1 };
        const jet j = { 0, { fx, fy, fz }, { h[0], h[1], h[2], h[3], h[4], h[5] } };
        double exact[ALL];
        derive_exactly(&j, exact);
        for (int k = 0; k < ALL; ++k)
        {
          const double e = d.points == 1 ? fabs(d.out[k][i]) : fabs(d.out[k][i] - exact[k]);
          worst = e <= worst ? worst : e;
        }
      }
      CHECK_NEAR(worst, 0, 1e-9); /* as above */
      CHECK(d.counts.flat_points == (d.points == 1));
      free_derived(&d);
    }
  }
}

/* Every type, strides and components: the same numbers give the same results. */
static void every_type_gives_the_same(void)
{
  enum
  {
    N = 12
  };
  derived d = make_image(N, N, N, straight);
  for (size_t i = 0; i < d.points; ++i)
  {
    d.values[i] = (double)(i * 7919 % 97); /* which every type holds */
  }
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double* expected[ALL];
  for (int k = 0; k < ALL; ++k)
  {
    expected[k] = d.out[k];
    d.out[k] = derived_room(d.points * sizeof(double));
  }
  char* const block = derived_room(d.points * 24);
  float* const single = derived_room(ALL * d.points * sizeof(float));
  for (chi_type type = CHI_F32; type <= CHI_U64; ++type)
  {
    const size_t size = chi_type_size(type);
    for (size_t components = 1; components <= 3; components += 2)
    {
      for (size_t i = 0; i < components * d.points; ++i)
      {
        const double x = i % components == components - 1 ? d.values[i / components] : 1;
        const int64_t whole = (int64_t)x;
        const float f = (float)x;
        memcpy(block + i * size,
          type == CHI_F64     ? (const void*)&x
            : type == CHI_F32 ? &f
                              : (const void*)&whole,
          size);
      }
      const chi_array_view values = { block, d.points, components, components * size, type };
      chi_derived_params params = { sizeof params, 2, (int32_t)components - 1 };
      chi_derived_arrays arrays = derived_arrays(&d);
      CHECK(chi_derived_compute(NULL, &d.view, &values, &params, &arrays, &d.counts) == CHI_OK);
      for (int k = 0; k < ALL; ++k)
      {
        CHECK(memcmp(expected[k], d.out[k], d.points * sizeof(double)) == 0);
      }
      arrays.type = CHI_F32;
      arrays.gradient_magnitude = single;
      arrays.second_derivative = single + d.points;
      arrays.laplacian = single + 2 * d.points;
      arrays.mean_curvature = single + 3 * d.points;
      CHECK(chi_derived_compute(NULL, &d.view, &values, &params, &arrays, &d.counts) == CHI_OK);
      double worst = 0;
      for (size_t i = 0; i < d.points; ++i)
      {
        /* float: 20 roundings of terms of up to 97 * 4 / 0.05^2 each, if not less */
        const double scale = 97 * 4 / 0.0025;
        worst = fmax(worst, fabs(single[i] - expected[0][i]) / (97 / 0.05));
        worst = fmax(worst, fabs(single[d.points + i] - expected[1][i]) / scale);
        worst = fmax(worst, fabs(single[2 * d.points + i] - expected[2][i]) / scale);
      }
      CHECK_NEAR(worst, 0, 20 * 6e-8);
    }
  }
  free(block);
  free(single);
  for (int k = 0; k < ALL; ++k)
  {
    free(expected[k]);
  }
  free_derived(&d);
}

static void the_magnitude_of_components_is_their_root_of_squares(void)
{
  derived d = make_image(6, 7, 5, straight);
  float* const pairs = derived_room(2 * d.points * sizeof(float));
  for (size_t i = 0; i < d.points; ++i)
  {
    const float t = (float)i;
    pairs[2 * i] = 3 * t;
    pairs[2 * i + 1] = -4 * t;
    d.values[i] = 5 * t;
  }
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double* const expected = d.out[0];
  d.out[0] = derived_room(d.points * sizeof(double));
  const chi_array_view values = { pairs, d.points, 2, 2 * sizeof(float), CHI_F32 };
  const chi_derived_params params = { sizeof params, 0, -1 };
  const chi_derived_arrays arrays = derived_arrays(&d);
  CHECK(chi_derived_compute(NULL, &d.view, &values, &params, &arrays, &d.counts) == CHI_OK);
  for (size_t i = 0; i < d.points; ++i)
  {
    CHECK_NEAR(d.out[0][i] / expected[i], 1, 1e-12); /* eps times 1000 / 1 of the differences */
  }
  free(expected);
  free(pairs);
  free_derived(&d);
}

/* Scale of values and lengths, origin far away: powers of two change nothing but themselves. */
static void scales_do_not_matter(void)
{
  derived d = make_image(10, 11, 9, straight);
  sample(&d, waves);
  CHECK(run_derived(&d, NULL) == CHI_OK);
  double* expected[ALL];
  for (int k = 0; k < ALL; ++k)
  {
    expected[k] = d.out[k];
    d.out[k] = derived_room(d.points * sizeof(double));
  }
  static const int scales[][2] = { { 300, 0 }, { -300, 0 }, { 0, 200 }, { 0, -200 }, { 40, -40 },
    { -900, -50 }, { 1000, 400 } };
  for (size_t s = 0; s < sizeof scales / sizeof scales[0]; ++s)
  {
    const double value = ldexp(1, scales[s][0]), length = ldexp(1, scales[s][1]);
    for (size_t i = 0; i < d.points; ++i)
    {
      d.values[i] = waves(d.x + 3 * i).value * value;
    }
    for (int a = 0; a < 12; ++a)
    {
      d.view.index_to_world[a] = straight[a] * (a % 4 == 3 ? 1 : length);
    }
    CHECK(run_derived(&d, NULL) == CHI_OK);
    const double unit[ALL] = { value / length, value / length / length, value / length / length,
      1 / length };
    int same = 1;
    for (int k = 0; k < ALL; ++k)
    {
      for (size_t i = 0; i < d.points; ++i)
      {
        same = same && d.out[k][i] == expected[k][i] * unit[k];
      }
    }
    CHECK(same);
  }
  for (int k = 0; k < ALL; ++k)
  {
    free(expected[k]);
  }
  free_derived(&d);
}

static void the_ends_of_floats_range_do_not_overflow(void)
{
  enum
  {
    N = 8
  };
  derived d = make_image(N, N, N, straight);
  float* const values = derived_room(d.points * sizeof(float));
  float* const out = derived_room(d.points * sizeof(float));
  static const float ends[] = { 3.4e38f, 1e-38f, 1e-42f };
  for (int e = 0; e < 3; ++e)
  {
    for (size_t i = 0; i < d.points; ++i)
    {
      values[i] = i % N % 2 ? ends[e] : -ends[e];
    }
    for (int a = 0; a < 3; ++a)
    {
      d.view.index_to_world[5 * a] = 4;
    }
    const chi_array_view view = { values, d.points, 1, sizeof(float), CHI_F32 };
    const chi_derived_arrays arrays = { sizeof arrays, CHI_F32, 0, out, NULL, NULL, NULL };
    CHECK(chi_derived_compute(NULL, &d.view, &view, NULL, &arrays, &d.counts) == CHI_OK);
    /* at the rim (-3 f0 + 4 f1 - f2) / (2 h) = 8 / 8 */
    CHECK_NEAR((double)out[0] / (double)ends[e], 1, e == 2 ? 1e-3 : 1e-6);
    CHECK(out[1] == 0 && d.counts.flat_points == d.points - 2 * N * N);
  }
  free(values);
  free(out);
  free_derived(&d);
}

static void what_is_constant_is_flat_and_counted(void)
{
  for (int kind = 0; kind < 3; ++kind)
  {
    derived d = make_image(9, 9, 9, straight);
    d.params.order = 4;
    if (kind == 1)
    {
      make_uneven(&d);
    }
    if (kind == 2)
    {
      make_bent(&d, 0.02);
    }
    for (size_t i = 0; i < d.points; ++i)
    {
      d.values[i] = i % 9 < 6 ? 1234.567 : 1234.567 + (double)(i % 9);
    }
    CHECK(run_derived(&d, NULL) == CHI_OK);
    CHECK(d.counts.flat_points == 4 * 81); /* beyond the reach of two samples */
    for (size_t i = 0; i < d.points; ++i)
    {
      if (i % 9 < 4)
      {
        CHECK(d.out[0][i] == 0 && d.out[1][i] == 0 && d.out[3][i] == 0);
      }
    }
    CHECK(d.counts.range[0] == 1234.567 && d.counts.range[1] == 1234.567 + 8);
    free_derived(&d);
  }
}

static void samples_that_are_not_finite_spoil_what_touches_them(void)
{
  enum
  {
    N = 15
  };
  for (int kind = 0; kind < 2; ++kind)
  {
    for (int order = 2; order <= 4; order += 2)
    {
      derived d = make_image(N, N, N, straight);
      d.params.order = order;
      uint8_t* const ghosts = derived_room(d.points);
      memset(ghosts, 0, d.points);
      sample(&d, waves);
      const size_t middle = (d.points - 1) / 2;
      const int reach = order / 2;
      if (kind == 0)
      {
        d.values[middle] = order == 2 ? INFINITY : NAN;
      }
      else
      {
        ghosts[middle] = CHI_GRID_HIDDEN_POINT;
        d.view.point_ghosts = ghosts;
      }
      CHECK(run_derived(&d, NULL) == CHI_OK);
      size_t wrong = 0, touched = 0;
      for (size_t i = 0; i < d.points; ++i)
      {
        const int at[3] = { abs((int)(i % N) - N / 2), abs((int)(i / N % N) - N / 2),
          abs((int)(i / (N * N)) - N / 2) };
        const int near = at[0] <= reach && at[1] <= reach && at[2] <= reach;
        /* mixed derivatives reach products of two axes */
        const int touches = near && (at[0] == 0) + (at[1] == 0) + (at[2] == 0) > 0;
        touched += (size_t)touches;
        wrong += touches != isnan(d.out[2][i]) && (at[0] == 0) + (at[1] == 0) + (at[2] == 0) > 1;
        wrong += !touches && (isnan(d.out[0][i]) || isnan(d.out[3][i]));
        wrong += touches && !isnan(d.out[1][i]);
      }
      CHECK(wrong == 0);
      CHECK(d.counts.non_finite_points > 0 && d.counts.non_finite_points <= touched);
      free(ghosts);
      free_derived(&d);
    }
  }
}

static void a_collapsed_cell_is_counted(void)
{
  derived d = make_image(9, 9, 9, straight);
  make_bent(&d, 0.01);
  sample(&d, waves);
  for (size_t i = 0; i < d.points; ++i)
  {
    if (i / 9 % 9 < 3) /* rows that fall onto each other */
    {
      memcpy(d.x + 3 * i, d.x + 3 * (i % 9 + i / 81 * 81), 3 * sizeof(double));
    }
  }
  CHECK(run_derived(&d, NULL) == CHI_OK);
  CHECK(d.counts.undetermined_points == 2 * 81 && d.counts.non_finite_points == 0);
  CHECK(isnan(d.out[0][0]) && isnan(d.out[3][9]) && isfinite(d.out[3][18]));
  free_derived(&d);
}

int main(void)
{
  polynomials_up_to_the_order_are_exact_to_the_boundary();
  laplacians_of_one_degree_more_are_exact();
  errors_fall_by_the_order_everywhere();
  spheres_and_cylinders_have_their_curvatures();
  linear_fields_are_exact_on_any_curvilinear_grid();
  a_curved_sheet_has_the_derivatives_within_it();
  marschner_and_lobbs_signal_is_resolved();
  thin_images_have_what_their_samples_say();
  every_type_gives_the_same();
  the_magnitude_of_components_is_their_root_of_squares();
  scales_do_not_matter();
  the_ends_of_floats_range_do_not_overflow();
  what_is_constant_is_flat_and_counted();
  samples_that_are_not_finite_spoil_what_touches_them();
  a_collapsed_cell_is_counted();
  return chi_test_report();
}
