/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_RINGS_H
#define CHI_TUBE_RINGS_H

#include "chi_tube_internal.h"

#include <string.h>

/* What decides over rings, for all lines. */
typedef struct chi_ring_rules
{
  const chi_exec* exec;
  const chi_lines_view* lines;
  const chi_tube_params* params;
  double turn_scale;             /* 1 / chord of the angular tolerance */
  const double* attribute_scale; /* [attribute_count] 1 / (tolerance * range); 0: constant array */
} chi_ring_rules;

/* A place on the axis that may become a ring. */
typedef struct chi_ring_candidate
{
  chi_tube_ring ring;
  double x[3], tangent[3], before[3];
  double bend[3]; /* curvature vector, of a spline */
  double axis[3]; /* the ring's centre, once a step towards it is considered */
  size_t source;
  double weight;
  int keep, clamped;
} chi_ring_candidate;

/* Lists that grow; released by chi_ring_lists_release. */
typedef struct chi_ring_lists
{
  chi_ring_candidate* candidate;
  size_t candidates, candidate_capacity;
  chi_tube_ring* ring; /* of all lines so far */
  size_t rings, ring_capacity;
} chi_ring_lists;

/* What came of one line. */
typedef struct chi_ring_choice
{
  size_t rings, clamped, dropped;
  int outside, bad_radius;
} chi_ring_choice;

/* Append the rings of one line to the lists; 0 when memory was refused. */
int chi_tube_choose_rings(const chi_ring_rules* rules, size_t line, const chi_spline_curve* curve,
  chi_ring_lists* lists, chi_ring_choice* choice);

void chi_ring_lists_release(const chi_exec* exec, chi_ring_lists* lists);

static inline double chi_tube_value(const chi_array_view* a, size_t tuple, size_t component)
{
  const char* const at = (const char*)a->data + tuple * a->stride;
  if (a->type == CHI_F32)
  {
    float x;
    memcpy(&x, at + component * sizeof x, sizeof x);
    return (double)x;
  }
  double x;
  memcpy(&x, at + component * sizeof x, sizeof x);
  return x;
}

static inline double chi_tube_radius(
  const chi_ring_rules* rules, size_t line, const chi_spline_curve* c, size_t source, double weight)
{
  const chi_tube_params* const p = rules->params;
  double radius = p->radius;
  if (p->line_radius)
  {
    radius *= chi_tube_value(p->line_radius, line, 0);
  }
  if (p->point_radius)
  {
    const size_t first = (size_t)chi_tube_point_id(rules->lines, line, c, source);
    const size_t second = (size_t)chi_tube_point_id(rules->lines, line, c, source + 1);
    const double a = chi_tube_value(p->point_radius, first, 0);
    const double b = chi_tube_value(p->point_radius, second, 0);
    radius *= a + weight * (b - a);
  }
  return radius;
}

#endif
