/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_ORDER_LIFT_H
#define CHI_TET_ORDER_LIFT_H

/* What the lift and the search for its quadratic form share. */

#include "chi_tet_order_internal.h"

enum
{
  SAMPLE = 1 << 15, /* tetrahedra looked at in one round of a search */
  SIZES = 64,       /* powers of 2 that planes are counted by */
};

typedef struct part /* what a chunk finds */
{
  double low[4], high[4]; /* of planes; or of points */
  double covariance[6];
  double worst, vector[6]; /* the constraint that is least fulfilled, of length 1 */
  int64_t tied, wrong, flat, far;
  uint32_t sizes[SIZES]; /* planes from a power of 2 to the next */
} part;

typedef struct lift_job
{
  const chi_tet_mesh_view* mesh;
  const uint32_t* neighbors;
  chi_order_lift* lift;
  part* parts;
  size_t stride; /* of the sample */
  int searches;  /* for the worst constraint, in place of counting ties */
  double tie;
  double radius, cut; /* of the mesh in the lift's coordinates; planes beyond it are outliers */
  double middle[4], inverse[4]; /* plane to integers */
  uint32_t* pairs;              /* those of tied faces, from starts of chunks; NULL */
  size_t starts[CHI_ORDER_CHUNKS];
  size_t* far; /* [chunks] outliers */
} lift_job;

static inline void squares(const double y[3], double q[6])
{
  for (int k = 0; k < 3; ++k)
  {
    q[k] = y[k] * y[k];
    q[3 + k] = y[k] * y[(k + 1) % 3];
  }
}

static inline double dot(const double* a, const double* b, int n)
{
  double sum = 0;
  for (int k = 0; k < n; ++k)
  {
    sum += a[k] * b[k];
  }
  return sum;
}

/* Chunks of the mesh in parallel, and what they found together. */
chi_status chi_lift_run(const chi_exec* exec, lift_job* job, chi_range_fn body, part* sum);
/* Ties, and faces that the lift is not convex across; or, while it searches, the worst of them. */
void chi_lift_judge_faces(void* job, size_t begin, size_t end);

/* chi_tet_order_form.c */
void chi_lift_find_frame(void* job, size_t begin, size_t end);
void chi_lift_set_frame(chi_order_lift* lift, const part* p, size_t count);
/* A form whose lift is strictly convex across all faces; 0 in `found`: there is none, or it was not
 * found. */
chi_status chi_lift_search(const chi_exec* exec, lift_job* job, double form[6], int* found);

#endif
