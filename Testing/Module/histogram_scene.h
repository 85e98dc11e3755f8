/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_HISTOGRAM_SCENE_H
#define CHI_HISTOGRAM_SCENE_H

/* Meshes with a field and their histograms; and the same in long double, tetrahedron by
 * tetrahedron, by differences of the closed distribution. */

#include "grid_lattice.h"

#include <chiaroscuro/chi_histogram.h>

typedef struct bins
{
  size_t count;
  double *centers, *mass, *density, *iso_area, *cumulative;
  chi_histogram_result result;
} bins;

__attribute__((unused)) static void drop_bins(bins* b)
{
  free(b->centers);
}

/* A histogram on a handle of its own, or on a given one. */
__attribute__((unused)) static chi_status make_bins(bins* b, const chi_exec* exec,
  chi_histogram* given, const chi_grid_view* grid, const chi_histogram_params* params)
{
  const size_t n = params->bins ? params->bins : 1;
  chi_histogram* h = given;
  *b = (bins){ .count = params->bins };
  b->centers = malloc(5 * n * sizeof(double));
  if (!b->centers)
  {
    exit(1);
  }
  b->mass = b->centers + n;
  b->density = b->mass + n;
  b->iso_area = b->density + n;
  b->cumulative = b->iso_area + n;
  const chi_histogram_outputs out = { .struct_size = sizeof out,
    .centers = b->centers,
    .mass = b->mass,
    .density = b->density,
    .iso_area = b->iso_area,
    .cumulative = b->cumulative };
  chi_status status = given ? CHI_OK : chi_histogram_create(exec, &h);
  if (status == CHI_OK)
  {
    status = chi_histogram_compute(exec, h, grid, params, &out);
    chi_histogram_get_result(h, &b->result);
  }
  if (!given)
  {
    chi_histogram_destroy(exec, h);
  }
  return status;
}

__attribute__((unused)) static chi_array_view view_values(const double* values, size_t count)
{
  return (chi_array_view){ values, count, 1, sizeof(double), CHI_F64 };
}

__attribute__((unused)) static chi_histogram_params histogram_params(
  const chi_array_view* field, size_t count, double low, double high)
{
  return (chi_histogram_params){ .struct_size = sizeof(chi_histogram_params),
    .field = field,
    .bins = count,
    .range = { low, high },
    .moments = CHI_HISTOGRAM_MOMENTS };
}

/* What the bins hold and what is beyond. */
__attribute__((unused)) static long double sum_of(const bins* b)
{
  long double sum = (long double)b->result.mass_below + b->result.mass_above;
  for (size_t i = 0; i < b->count; ++i)
  {
    sum += b->mass[i];
  }
  return sum;
}

__attribute__((unused)) static int compare_numbers(const void* p, const void* q)
{
  const long double x = *(const long double*)p, y = *(const long double*)q;
  return (x > y) - (x < y);
}

/* The part of a tetrahedron whose linear function's corner values are s, ascending, below t. */
__attribute__((unused)) static long double part_below(const long double s[4], long double t)
{
  const long double a = s[0], b = s[1], c = s[2], d = s[3];
  if (t >= d || t <= a)
  {
    return t >= d;
  }
  if (t <= b)
  {
    return (t - a) / (b - a) * ((t - a) / (c - a)) * ((t - a) / (d - a));
  }
  if (t >= c)
  {
    return 1 - (d - t) / (d - a) * ((d - t) / (d - b)) * ((d - t) / (d - c));
  }
  const long double ac = (t - a) / (c - a), ad = (t - a) / (d - a);
  const long double bc = (t - b) / (c - b), bd = (t - b) / (d - b);
  return ac * ad + ac * (1 - ad) * bd + (1 - ac) * bc * bd; /* three tetrahedra of the slab below */
}

/* Mass and area by bin of a split mesh; what falls beyond the range is left out. */
__attribute__((unused)) static void reference_bins(const split* s, const double* values,
  size_t count, double low, double high, long double* mass, long double* area)
{
  for (size_t i = 0; i < count; ++i)
  {
    mass[i] = area[i] = 0;
  }
  for (size_t t = 0; t < s->counts.tetrahedra; ++t)
  {
    const uint32_t* const id = s->vertices[t];
    long double e[3][3], f[3], v[4], n[3] = { 0, 0, 0 }, volume = 0;
    for (int k = 0; k < 4; ++k)
    {
      v[k] = values[id[k]];
    }
    for (int k = 0; k < 3; ++k)
    {
      f[k] = v[k + 1] - v[0];
      for (int a = 0; a < 3; ++a)
      {
        e[k][a] = (long double)s->points[id[k + 1]][a] - s->points[id[0]][a];
      }
    }
    for (int k = 0; k < 3; ++k)
    {
      for (int a = 0; a < 3; ++a)
      {
        const int p = (k + 1) % 3, q = (k + 2) % 3, b = (a + 1) % 3, c = (a + 2) % 3;
        const long double m = e[p][b] * e[q][c] - e[p][c] * e[q][b];
        n[a] += f[k] * m;
        volume += k == 0 ? e[0][a] * m / 6 : 0;
      }
    }
    const long double integral = sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 6;
    qsort(v, 4, sizeof v[0], compare_numbers);
    for (size_t i = 0; i < count; ++i)
    {
      const long double size = (long double)high - low;
      const long double begin = low + size * (long double)i / (long double)count;
      const long double end = low + size * (long double)(i + 1) / (long double)count;
      if (end <= v[0] || begin >= v[3])
      {
        continue;
      }
      const long double part = part_below(v, end) - part_below(v, begin);
      mass[i] += part * fabsl(volume);
      area[i] += part * integral;
    }
  }
}

#endif
