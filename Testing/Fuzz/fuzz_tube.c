/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Tubes of any lines with any parameters: refused where the header says so, else surfaces whose
 * sizes, cells and vertices hold together. */

#include "fuzz.h"

#include <chiaroscuro/chi_tube.h>

/* Any parameters, harmless mostly; arrays of the right length mostly. */
static chi_tube_params fuzz_tube_params(fuzz* f, const chi_lines_view* lines,
  chi_array_view arrays[4], const chi_array_view** list, double* box)
{
  chi_tube_params p = { .struct_size = fuzz_size(f, sizeof p) };
  p.radius = fuzz_mostly(f, 0.125 + (double)fuzz_byte(f) / 64);
  p.sides = fuzz_once_in(f, 16) ? (int32_t)fuzz_bits(f, 2) - 4 : (int32_t)(3 + fuzz_upto(f, 9));
  p.sides = fuzz_once_in(f, 8) ? 0 : p.sides;
  p.frame = fuzz_once_in(f, 64) ? (int32_t)fuzz_byte(f) - 8 : (int32_t)fuzz_upto(f, 1);
  p.cap = fuzz_once_in(f, 64) ? (int32_t)fuzz_byte(f) - 8 : (int32_t)fuzz_upto(f, 2);
  p.cells = fuzz_once_in(f, 64) ? (int32_t)fuzz_byte(f) - 8 : (int32_t)fuzz_upto(f, 1);
  p.limit_radius = fuzz_byte(f) & 1;
  p.keep_rings = fuzz_byte(f) & 1;
  p.chord_tolerance = fuzz_mostly(f, (1 + (double)fuzz_byte(f)) / 64);
  p.angular_tolerance_rad = fuzz_mostly(f, (1 + (double)fuzz_byte(f)) / 128);
  p.attribute_tolerance = fuzz_mostly(f, (double)fuzz_byte(f) / 512);
  p.min_length = fuzz_once_in(f, 8) ? fuzz_any(f) : 0;
  if (fuzz_once_in(f, 8))
  {
    for (int k = 0; k < 6; ++k)
    {
      box[k] = fuzz_any(f);
    }
    p.clip_box = box;
  }
  const size_t points = lines->points.count;
  const chi_type type = fuzz_byte(f) & 1 ? CHI_F32 : CHI_F64;
  const size_t lack = fuzz_once_in(f, 32) ? 1 : 0;
  if (fuzz_once_in(f, 4))
  {
    arrays[0] = fuzz_array(f, points > lack ? points - lack : 0, 1, type);
    p.point_radius = &arrays[0];
  }
  if (fuzz_once_in(f, 4))
  {
    arrays[1] = fuzz_array(f, lines->line_count, 1, type);
    p.line_radius = &arrays[1];
  }
  for (size_t n = fuzz_upto(f, 2); n > 0; --n)
  {
    arrays[2 + p.attribute_count] = fuzz_array(f, points, 1 + fuzz_upto(f, 3), type);
    list[p.attribute_count] = &arrays[2 + p.attribute_count];
    ++p.attribute_count;
  }
  p.attributes = list;
  return p;
}

static void check_cells(
  const chi_tube_sizes* s, const int64_t* offsets, const int64_t* ids, int32_t cells)
{
  FUZZ_CHECK(offsets[0] == 0 && offsets[s->cells] == (int64_t)s->connectivity);
  for (size_t i = 0; i < s->cells; ++i)
  {
    FUZZ_CHECK(offsets[i + 1] - offsets[i] >= 3);
    FUZZ_CHECK(cells == CHI_TUBE_STRIPS || offsets[i + 1] - offsets[i] == 3);
  }
  for (size_t i = 0; i < s->connectivity; ++i)
  {
    FUZZ_CHECK(ids[i] >= 0 && (size_t)ids[i] < s->points);
  }
}

static void check_attribute(fuzz* f, const chi_exec* exec, const chi_tube* t,
  const chi_tube_sizes* s, const chi_lines_view* lines)
{
  const int32_t target = fuzz_byte(f) & 1;
  const size_t tuples = target == CHI_TUBE_CURVES ? s->curve_points : s->points;
  const chi_array_view in = fuzz_array(f, lines->points.count, 1, CHI_F64);
  double* const out = (double*)fuzz_new(f, tuples * sizeof *out);
  fuzz_before(f);
  chi_status status = chi_tube_attribute(exec, t, target, &in, out, sizeof *out);
  fuzz_after(f, status);
  double low = INFINITY, high = -INFINITY;
  int finite = 1;
  for (size_t i = 0; i < in.count; ++i)
  {
    const double x = fuzz_value(&in, i, 0);
    finite = finite && isfinite(x);
    low = fmin(low, x);
    high = fmax(high, x);
  }
  for (size_t i = 0; i < tuples && status == CHI_OK && finite; ++i)
  {
    FUZZ_CHECK(fuzz_is_in(out[i], low, high)); /* no overshoot */
  }
  int64_t* const ids = (int64_t*)fuzz_new(f, tuples * sizeof *ids);
  fuzz_before(f);
  status = chi_tube_nearest(exec, t, target, ids);
  fuzz_after(f, status);
  for (size_t i = 0; i < tuples && status == CHI_OK; ++i)
  {
    FUZZ_CHECK(ids[i] >= 0 && (size_t)ids[i] < lines->points.count);
  }
}

static void sweep(fuzz* f, const chi_exec* exec, const chi_tube* t, const chi_tube_params* p,
  const chi_lines_view* lines, double extent)
{
  chi_tube_sizes s;
  chi_tube_get_sizes(t, &s);
  FUZZ_CHECK(s.curves <= lines->line_count && s.outside_lines + s.short_lines <= lines->line_count);
  if (s.points > 1000000 || s.connectivity > 4000000)
  {
    return; /* honest, but slow */
  }
  float* const normals = (float*)fuzz_new(f, 3 * s.points * sizeof(float));
  double* const points = (double*)fuzz_new(f, 3 * s.points * sizeof(double));
  int64_t* const offsets = (int64_t*)fuzz_new(f, (s.cells + 1) * sizeof(int64_t));
  int64_t* const connectivity = (int64_t*)fuzz_new(f, s.connectivity * sizeof(int64_t));
  const chi_tube_outputs out = { .struct_size = sizeof out,
    .points = points,
    .point_type = CHI_F64,
    .normals = normals,
    .tcoords = fuzz_byte(f) & 1 ? (float*)fuzz_new(f, 2 * s.points * sizeof(float)) : NULL,
    .parameter = fuzz_byte(f) & 1 ? (float*)fuzz_new(f, s.points * sizeof(float)) : NULL,
    .line_ids = fuzz_byte(f) & 1 ? (int64_t*)fuzz_new(f, s.cells * sizeof(int64_t)) : NULL,
    .offsets = offsets,
    .connectivity = connectivity,
    .curve_points =
      fuzz_byte(f) & 1 ? (double*)fuzz_new(f, 3 * s.curve_points * sizeof(double)) : NULL,
    .curve_offsets =
      fuzz_byte(f) & 1 ? (int64_t*)fuzz_new(f, (s.curves + 1) * sizeof(int64_t)) : NULL,
    .curve_line_ids = fuzz_byte(f) & 1 ? (int64_t*)fuzz_new(f, s.curves * sizeof(int64_t)) : NULL };
  fuzz_before(f);
  const chi_status status = chi_tube_sweep(exec, t, &out);
  fuzz_after(f, status);
  if (status != CHI_OK)
  {
    return;
  }
  check_cells(&s, offsets, connectivity, p->cells);
  const double radius = p->point_radius || p->line_radius ? INFINITY : p->radius;
  /* beyond, squares of coordinates or of radii leave the range of double, radii that of float */
  const int tame = extent < 1e30 && p->radius < 1e30 && radius < 1e30;
  for (size_t i = 0; i < s.points && tame; ++i)
  {
    double square = 0;
    for (size_t k = 0; k < 3; ++k)
    {
      FUZZ_CHECK(isfinite(points[3 * i + k]));
      square += (double)normals[3 * i + k] * (double)normals[3 * i + k];
    }
    FUZZ_CHECK(fuzz_is_in(square, 0.999, 1.001));
  }
  if (status == CHI_OK && s.points > 0)
  {
    check_attribute(f, exec, t, &s, lines);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  chi_spline* s = NULL;
  chi_tube* t = NULL;
  FUZZ_CHECK(chi_spline_create(NULL, &s) == CHI_OK && chi_tube_create(NULL, &t) == CHI_OK);
  for (int round = 0; round < 2; ++round)
  {
    const size_t kept = f->kept_count;
    double extent;
    const chi_lines_view lines = fuzz_lines(f, &extent);
    const chi_spline_params fit = fuzz_spline_params(f);
    if (chi_spline_fit(NULL, s, &lines, &fit) == CHI_OK)
    {
      /* the handles outlive the input: their memory is the default host's, a call's scratch ours */
      chi_array_view arrays[4];
      const chi_array_view* list[2] = { NULL, NULL };
      double box[6];
      const chi_tube_params p = fuzz_tube_params(f, &lines, arrays, list, box);
      chi_exec exec = fuzz_host(f, 100000);
      chi_tube* own = NULL;
      chi_status status = chi_tube_create(&exec, &own);
      fuzz_after(f, status);
      if (status == CHI_OK)
      {
        fuzz_before(f);
        status = chi_tube_plan(&exec, own, s, &lines, &p);
        fuzz_after(f, status);
      }
      if (status == CHI_OK)
      {
        sweep(f, &exec, own, &p, &lines, extent);
        chi_status again = chi_tube_plan(NULL, t, s, &lines, &p);
        chi_tube_sizes a, b;
        chi_tube_get_sizes(own, &a);
        chi_tube_get_sizes(t, &b);
        FUZZ_CHECK(
          again == CHI_OK && a.points == b.points && a.rings == b.rings && a.cells == b.cells);
      }
      else if (own)
      {
        const chi_tube_outputs none = { .struct_size = sizeof none };
        FUZZ_CHECK(chi_tube_sweep(&exec, own, &none) == CHI_ERROR_NOT_READY);
      }
      chi_tube_destroy(&exec, own);
      fuzz_check_all_is_back(f);
    }
    fuzz_forget(f, kept);
  }
  chi_tube_destroy(NULL, t);
  chi_spline_destroy(NULL, s);
  fuzz_end(f);
  return 0;
}
