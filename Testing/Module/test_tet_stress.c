/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Issue 6 asks for 1e-5 of the longest edge at 99.99 % of the pixels of each hostile case, and for
 * none to be missing. With an argument: so many tetrahedra a case; prints its table.
 */
#include "chi_test.h"
#include "tet_stress.h"

static void check(void* user, const tet_stress_row* row)
{
  (void)user;
  printf("%-28s %s pixels %8lld  worst %.1e  beyond 1e-5: %.4f %%  missing %lld\n", row->name,
    row->parallel ? "parallel   " : "perspective", (long long)row->pixels, row->worst,
    100 * row->beyond, (long long)row->missing);
  CHECK(row->missing == 0);
  CHECK(row->beyond <= 1e-4);
}

int main(int argc, char** argv)
{
  CHECK(tet_stress(NULL, argc > 1 ? atoi(argv[1]) : 40, check, NULL));
  CHECK(chi_test_checks > 70); /* the cases ran */
  return chi_test_report();
}
