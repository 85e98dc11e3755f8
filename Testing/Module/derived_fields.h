/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_FIELDS_H
#define CHI_DERIVED_FIELDS_H

/* Fields whose derivatives are known, sampled on grids, and the errors of what is derived. */

#include "chi_test.h"

#include <chiaroscuro/chi_derived.h>

#define DERIVED_PI 3.14159265358979323846

/* Value, gradient and second derivatives (xx, yy, zz, xy, xz, yz) of a field at a place. */
typedef struct jet
{
  double value, first[3], second[6];
} jet;

typedef jet (*jet_fn)(const double x[3]);

/* f = a function of one linear combination: all derivatives follow from its own. */
static inline jet jet_of_wave(double value, double slope, double bend, const double k[3])
{
  return (jet){ value, { slope * k[0], slope * k[1], slope * k[2] },
    { bend * k[0] * k[0], bend * k[1] * k[1], bend * k[2] * k[2], bend * k[0] * k[1],
      bend * k[0] * k[2], bend * k[1] * k[2] } };
}

static inline jet jet_sum(jet a, jet b)
{
  a.value += b.value;
  for (int i = 0; i < 3; ++i)
  {
    a.first[i] += b.first[i];
  }
  for (int i = 0; i < 6; ++i)
  {
    a.second[i] += b.second[i];
  }
  return a;
}

/* Of full degree `n` in every direction: sum of powers of linear forms. */
__attribute__((unused)) static jet polynomial(const double x[3], int n)
{
  static const double k[4][3] = { { 1, 0.5, -0.25 }, { -0.5, 1, 0.75 }, { 0.25, -1, 1 },
    { 0.5, 0.5, 0.5 } };
  jet sum = { 0 };
  for (int i = 0; i < 4; ++i)
  {
    const double u = k[i][0] * x[0] + k[i][1] * x[1] + k[i][2] * x[2] + 0.3;
    sum =
      jet_sum(sum, jet_of_wave(pow(u, n), n * pow(u, n - 1), n * (n - 1) * pow(u, n - 2), k[i]));
  }
  return sum;
}

__attribute__((unused)) static jet linear(const double x[3])
{
  return polynomial(x, 1);
}
__attribute__((unused)) static jet quadratic(const double x[3])
{
  return polynomial(x, 2);
}
__attribute__((unused)) static jet cubic(const double x[3])
{
  return polynomial(x, 3);
}
__attribute__((unused)) static jet quartic(const double x[3])
{
  return polynomial(x, 4);
}

/* Smooth and of no symmetry. */
__attribute__((unused)) static jet waves(const double x[3])
{
  static const double k[2][3] = { { 1.1, 0.7, -0.4 }, { -0.3, 0.9, 1.3 } };
  jet sum = { 0 };
  for (int i = 0; i < 2; ++i)
  {
    const double u = k[i][0] * x[0] + k[i][1] * x[1] + k[i][2] * x[2] + 0.4 * i;
    sum = jet_sum(sum, jet_of_wave(sin(u), cos(u), -sin(u), k[i]));
  }
  return sum;
}

/* Distance from a point: |grad f| = 1, spheres of curvature 1 / r, Laplacian 2 / r. */
__attribute__((unused)) static jet sphere(const double x[3])
{
  const double p[3] = { x[0] + 1.5, x[1] + 1, x[2] + 2 };
  const double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), s = 1 / (r * r * r);
  return (jet){ r, { p[0] / r, p[1] / r, p[2] / r },
    { 1 / r - p[0] * p[0] * s, 1 / r - p[1] * p[1] * s, 1 / r - p[2] * p[2] * s, -p[0] * p[1] * s,
      -p[0] * p[2] * s, -p[1] * p[2] * s } };
}

/* Distance from the z axis through (-1.5, -1): cylinders of mean curvature 1 / (2 r). */
__attribute__((unused)) static jet cylinder(const double x[3])
{
  const double p[2] = { x[0] + 1.5, x[1] + 1 };
  const double r = sqrt(p[0] * p[0] + p[1] * p[1]), s = 1 / (r * r * r);
  return (jet){ r, { p[0] / r, p[1] / r, 0 },
    { 1 / r - p[0] * p[0] * s, 1 / r - p[1] * p[1] * s, 0, -p[0] * p[1] * s, 0, 0 } };
}

/* Marschner & Lobb 1994, equation (3), with f_M = 1 rather than 6 so that coarse grids resolve it,
 * and alpha = 0.25. */
#define ML_F 1.0
__attribute__((unused)) static jet marschner_lobb(const double x[3])
{
  const double a = 0.25, c = 2 * DERIVED_PI * ML_F, q = DERIVED_PI / 2;
  const double r2 = x[0] * x[0] + x[1] * x[1], r = sqrt(r2);
  /* rho(r) = cos(c cos(q r)) */
  const double u = c * cos(q * r), du = -c * q * sin(q * r), ddu = -c * q * q * cos(q * r);
  const double rho = cos(u), d = -sin(u) * du, dd = -cos(u) * du * du - sin(u) * ddu;
  const double scale = 1 / (2 * (1 + a));
  /* d / r has a limit of dd at the axis */
  const double over = r > 1e-6 ? d / r : dd, s = r > 1e-6 ? (dd - over) / r2 : 0;
  return (jet){ scale * (1 - sin(q * x[2]) + a * (1 + rho)),
    { scale * a * over * x[0], scale * a * over * x[1], -scale * q * cos(q * x[2]) },
    { scale * a * (over + s * x[0] * x[0]), scale * a * (over + s * x[1] * x[1]),
      scale * q * q * sin(q * x[2]), scale * a * s * x[0] * x[1], 0, 0 } };
}

/* What is derived, by the definitions: magnitude, second derivative, Laplacian, curvature. */
__attribute__((unused)) static void derive_exactly(const jet* j, double out[4])
{
  const double *const g = j->first, *const h = j->second;
  const double m = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  const double n[3] = { g[0] / m, g[1] / m, g[2] / m };
  out[0] = m;
  out[1] = n[0] * (h[0] * n[0] + h[3] * n[1] + h[4] * n[2]) +
    n[1] * (h[3] * n[0] + h[1] * n[1] + h[5] * n[2]) +
    n[2] * (h[4] * n[0] + h[5] * n[1] + h[2] * n[2]);
  out[2] = h[0] + h[1] + h[2];
  out[3] = (out[2] - out[1]) / (2 * m);
}

enum
{
  ALL = 4
};

/* A grid with its coordinates, one field on it, and what the core makes of it. */
typedef struct derived
{
  chi_grid_view view;
  size_t points;
  double* x;      /* [points][3] */
  double* values; /* [points] */
  void* memory[3];
  chi_derived_params params;
  double* out[ALL];
  chi_derived_counts counts;
} derived;

static inline void* derived_room(size_t bytes)
{
  void* const block = malloc(bytes ? bytes : 1);
  if (!block)
  {
    exit(1);
  }
  return block;
}

/* An image whose index axes are the columns of m (3 x 4, row-major), as points too. */
__attribute__((unused)) static derived make_image(
  size_t nx, size_t ny, size_t nz, const double m[12])
{
  derived d = {
    .view = { .struct_size = sizeof d.view, .kind = CHI_GRID_IMAGE, .dimensions = { nx, ny, nz } },
    .points = nx * ny * nz,
    .params = { .struct_size = sizeof d.params }
  };
  memcpy(d.view.index_to_world, m, 12 * sizeof(double));
  d.view.index_to_world[15] = 1;
  d.x = derived_room(3 * d.points * sizeof(double));
  d.values = derived_room(d.points * sizeof(double));
  for (size_t i = 0; i < d.points; ++i)
  {
    const double at[3] = { (double)(i % nx), (double)(i / nx % ny), (double)(i / (nx * ny)) };
    for (int a = 0; a < 3; ++a)
    {
      d.x[3 * i + a] =
        m[4 * a] * at[0] + m[4 * a + 1] * at[1] + m[4 * a + 2] * at[2] + m[4 * a + 3];
    }
  }
  for (int k = 0; k < ALL; ++k)
  {
    d.out[k] = derived_room(d.points * sizeof(double));
  }
  return d;
}

__attribute__((unused)) static void free_derived(derived* d)
{
  free(d->x);
  free(d->values);
  for (int k = 0; k < ALL; ++k)
  {
    free(d->out[k]);
  }
  for (int k = 0; k < 3; ++k)
  {
    free(d->memory[k]);
  }
}

__attribute__((unused)) static void sample(derived* d, jet_fn f)
{
  for (size_t i = 0; i < d->points; ++i)
  {
    d->values[i] = f(d->x + 3 * i).value;
  }
}

static inline chi_array_view derived_values(const derived* d)
{
  return (chi_array_view){ d->values, d->points, 1, sizeof(double), CHI_F64 };
}

static inline chi_derived_arrays derived_arrays(const derived* d)
{
  return (chi_derived_arrays){ .struct_size = sizeof(chi_derived_arrays),
    .type = CHI_F64,
    .gradient_magnitude = d->out[0],
    .second_derivative = d->out[1],
    .laplacian = d->out[2],
    .mean_curvature = d->out[3] };
}

__attribute__((unused)) static chi_status run_derived(derived* d, const chi_exec* exec)
{
  const chi_array_view values = derived_values(d);
  const chi_derived_arrays arrays = derived_arrays(d);
  return chi_derived_compute(exec, &d->view, &values, &d->params, &arrays, &d->counts);
}

/* Largest differences to the exact ones, at all points or where `use` says; those along the
 * gradient where it is not about to vanish, since they divide by it. */
__attribute__((unused)) static void find_errors(
  const derived* d, jet_fn f, int (*use)(const derived*, size_t), double error[ALL])
{
  memset(error, 0, ALL * sizeof *error);
  for (size_t i = 0; i < d->points; ++i)
  {
    double exact[ALL];
    const jet j = f(d->x + 3 * i);
    derive_exactly(&j, exact);
    for (int k = 0; k < ALL && (!use || use(d, i)); ++k)
    {
      const double e = k % 2 && exact[0] < 0.2 ? 0 : fabs(d->out[k][i] - exact[k]);
      error[k] = e <= error[k] ? error[k] : e; /* NaN stays */
    }
  }
}

#endif
