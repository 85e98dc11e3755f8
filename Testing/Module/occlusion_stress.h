/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_STRESS_H
#define CHI_OCCLUSION_STRESS_H

/*
 * Scenes at the ends of what numbers can hold, each with something that must stay true of it: a
 * closed form, or the picture of the same scene in friendlier numbers. test_occlusion_stress checks
 * the rows, bench_occlusion_stress prints them.
 */

#include <chiaroscuro/chi.h>

/* One case. It holds where measured <= bound; NaN does not hold. */
typedef struct stress_row
{
  const char* name;      /* what is extreme */
  double parameter;      /* how extreme */
  const char* invariant; /* what must stay true */
  double measured, bound;
} stress_row;

typedef void (*stress_report)(void* user, const stress_row* row);

/* All cases; `window` is the size of the largest picture (4000 where it is not too slow). */
void occlusion_stress(const chi_exec* exec, int window, stress_report report, void* user);

/* The cases that compare pictures; the former calls it. */
void occlusion_stress_pictures(const chi_exec* exec, int window, stress_report report, void* user);

#endif
