/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_STRESS_H
#define CHI_TET_STRESS_H

/*
 * Thickness of single tetrahedra of hostile shapes and places, 64 pixels across, against long
 * double from the coordinates as they are stored. test_tet_stress checks the rows, bench_tet_stress
 * prints them.
 */

#include <chiaroscuro/chi.h>

/* One case. Lengths are of the longest edge. */
typedef struct tet_stress_row
{
  const char* name; /* what is hostile */
  int parallel;
  int64_t pixels;  /* covered, or drawn */
  double worst;    /* error of the thickness */
  double beyond;   /* share of the pixels where that is above 1e-5 */
  int64_t missing; /* thicker than 1e-3, drawn as nothing */
  double ns;       /* all its frames */
} tet_stress_row;

typedef void (*tet_stress_report)(void* user, const tet_stress_row* row);

/* All cases, so many tetrahedra each; 400 have the 1e5 pixels a case that issue 6 asks for. Returns
 * 0 where a frame fails. */
int tet_stress(const chi_exec* exec, int tetrahedra, tet_stress_report report, void* user);

#endif
