/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_INTERNAL_H
#define CHI_TUBE_INTERNAL_H

#include <chiaroscuro/chi_tube.h>

#include "chi_spline_internal.h"

/* One ring of the plan: where on its curve, and how wide. A polyline's corner that is too sharp to
 * mitre has two rings at one place, before and after it. A spline's rings lie a little outside of
 * its bends, so that the chords between them err to both sides. */
typedef struct chi_tube_ring
{
  double u;
  float radius;
  union
  {
    int32_t side;  /* of a polyline: 0 smooth or mitred; -1, 1: the ring before, after the corner */
    float outward; /* of a spline: distance from the curve, against its curvature */
  };
} chi_tube_ring;

/* One line of the plan. */
typedef struct chi_tube_line
{
  size_t ring_start, ring_count; /* count 0: not tubed */
  size_t point_start, cell_start, connectivity_start, curve_point_start, curve_index;
} chi_tube_line;

struct chi_tube
{
  const chi_spline* spline;
  const chi_lines_view* lines;
  chi_tube_line* line;
  chi_tube_ring* ring;
  size_t line_count, line_capacity, ring_capacity;
  int32_t sides, frame, cap, cells, keep_rings;
  int planned;
  chi_tube_sizes sizes;
};

/* Latitudes of a round cap between the rim and the pole. */
static inline size_t chi_tube_latitudes(int32_t sides)
{
  return sides / 4 > 1 ? (size_t)sides / 4 - 1 : 1;
}

/* Vertices, cells and connectivity of one cap. */
static inline size_t chi_tube_cap_points(const chi_tube* t)
{
  const size_t n = (size_t)t->sides;
  return t->cap == CHI_TUBE_CAP_FLAT ? n
    : t->cap == CHI_TUBE_CAP_ROUND   ? chi_tube_latitudes(t->sides) * n + 1
                                     : 0;
}

/* Strips or triangles of one line; chi_tube_cells.c. */
void chi_tube_write_cells(const chi_tube* tube, const chi_tube_outputs* outputs, size_t line);

/* Where a curve parameter lies among the cleaned input points: between i and i + 1, at `weight`. */
static inline size_t chi_tube_source(
  const chi_spline_curve* c, double u, size_t hint, double* weight)
{
  const double* const t = c->point_parameters;
  size_t low = 0, high = c->point_count - 1;
  if (hint < high && t[hint] <= u && u <= t[hint + 1])
  {
    low = hint;
  }
  else
  {
    while (high - low > 1)
    {
      const size_t middle = low + (high - low) / 2;
      if (t[middle] <= u)
      {
        low = middle;
      }
      else
      {
        high = middle;
      }
    }
  }
  const double width = t[low + 1] - t[low];
  const double w = width > 0 ? (u - t[low]) / width : 0;
  *weight = w < 0 ? 0 : w > 1 ? 1 : w;
  return low;
}

/* Id of a cleaned point of a line. */
static inline int64_t chi_tube_point_id(
  const chi_lines_view* lines, size_t line, const chi_spline_curve* c, size_t point)
{
  const int64_t at = lines->offsets[line] + c->point_indices[point];
  return lines->connectivity ? lines->connectivity[at] : at;
}

static inline double chi_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void chi_cross(const double a[3], const double b[3], double out[3])
{
  const double c[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0] };
  out[0] = c[0];
  out[1] = c[1];
  out[2] = c[2];
}

/* Length; v becomes a unit vector where that is not zero. */
static inline double chi_normalise(double v[3])
{
  const double length = sqrt(chi_dot(v, v));
  if (length > 0)
  {
    const double inverse = 1 / length; /* one division: this runs five times a ring */
    v[0] *= inverse;
    v[1] *= inverse;
    v[2] *= inverse;
  }
  return length;
}

/* Curvature vector of a curve with these first and second derivatives; 0 where it stands still. */
static inline void chi_tube_bend(const double first[3], const double second[3], double bend[3])
{
  const double square = chi_dot(first, first);
  const double along = square > 0 ? chi_dot(first, second) / square : 0;
  for (int a = 0; a < 3; ++a)
  {
    bend[a] = square > 0 ? (second[a] - along * first[a]) / square : 0;
  }
}

/* Centre of a ring. */
static inline void chi_tube_axis(const chi_spline_curve* c, const chi_tube_ring* ring, double x[3])
{
  double y[3][3], bend[3] = { 0, 0, 0 }, outward = 0;
  if (c->degree == 1 || ring->outward == 0)
  {
    chi_spline_evaluate(c, ring->u, 0, y);
  }
  else
  {
    chi_spline_evaluate(c, ring->u, 2, y);
    chi_tube_bend(y[1], y[2], bend);
    outward = chi_normalise(bend) > 0 ? (double)ring->outward : 0;
  }
  for (int a = 0; a < 3; ++a)
  {
    x[a] = y[0][a] - outward * bend[a];
  }
}

/* Beyond this turn (cosine of it) a corner of a polyline gets two rings instead of a mitre, which
 * would stretch by more than 1 / cos(50 degrees) = 1.56. */
#define CHI_TUBE_MITRE_COSINE (-0.17364817766693033) /* cos 100 degrees */

/* Unit tangents before and after a parameter; equal where the curve is smooth. 0 when it has none.
 */
static inline int chi_tube_tangents(
  const chi_spline_curve* c, double u, double before[3], double after[3])
{
  double x[2][3];
  chi_spline_evaluate(c, u, 1, x);
  for (int k = 0; k < 3; ++k)
  {
    before[k] = after[k] = x[1][k];
  }
  if (c->degree == 1)
  {
    const size_t span = chi_spline_span(c, u, 1);
    /* knots[span] is the parameter of coefficient span - 1 */
    if (u == c->knots[span] && (span > 1 || c->closed))
    {
      const double* const here = c->coefficients + 3 * (span - 1);
      const double* const last = span > 1 ? here - 3 : c->coefficients + 3 * (c->count - 2);
      for (int k = 0; k < 3; ++k)
      {
        before[k] = here[k] - last[k];
      }
    }
    else if (u >= 1 && c->closed)
    {
      for (int k = 0; k < 3; ++k)
      {
        after[k] = c->coefficients[3 + k] - c->coefficients[k];
      }
    }
  }
  else if (!(chi_dot(before, before) > 0))
  {
    /* A cusp: look a little aside. */
    const double aside = u < 0.5 ? u + 1e-6 : u - 1e-6;
    chi_spline_evaluate(c, aside, 1, x);
    for (int k = 0; k < 3; ++k)
    {
      before[k] = after[k] = x[1][k];
    }
  }
  return chi_normalise(before) > 0 && chi_normalise(after) > 0;
}

#endif
