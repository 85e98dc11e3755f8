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

/* With an argument all rows are printed, and the window is as large as the argument says: that of
 * 4000^2 is a slow test of its own. */
int main(int argc, char** argv)
{
  occlusion_stress(NULL, argc > 1 ? atoi(argv[1]) : 500, check, argc > 1 ? argv[0] : NULL);
  CHECK(chi_test_checks > 200); /* the cases ran */
  return chi_test_report();
}
