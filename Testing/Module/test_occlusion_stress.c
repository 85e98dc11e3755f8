/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Every stress case keeps its invariant to within its stated bound. */

#include "chi_test.h"
#include "occlusion_stress.h"

static void check(void* user, const stress_row* row)
{
  CHECK(row->measured <= row->bound);
  if (user || !(row->measured <= row->bound))
  {
    printf("%-52s %8.3g  %-44s %9.3g <= %9.3g\n", row->name, row->parameter, row->invariant,
      row->measured, row->bound);
  }
}

/* A window of 4000^2 takes half a minute under the sanitizers. */
#if defined(__SANITIZE_ADDRESS__)
static const int largest = 1000;
#else
static const int largest = 4000;
#endif

/* With an argument all rows are printed, and the window is as large as the argument says. */
int main(int argc, char** argv)
{
  occlusion_stress(NULL, argc > 1 ? atoi(argv[1]) : largest, check, argc > 1 ? argv[0] : NULL);
  CHECK(chi_test_checks > 200); /* the cases ran */
  return chi_test_report();
}
