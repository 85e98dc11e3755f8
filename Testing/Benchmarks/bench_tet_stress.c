/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Tetrahedra at the ends of what numbers can hold, as a table: error of the thickness, of the
 * longest edge. The rows are those that test_tet_stress checks, of 400 tetrahedra each.
 *
 * Prints CSV (a row for the largest error, one for the share of pixels beyond 1e-5, asked to be at
 * most 1e-4; n is pixels), and the table on the standard error.
 */
#include "tet_stress.h"

#include "chi_bench.h"

enum
{
  TETRAHEDRA = 400
};

static void print_row(void* user, const tet_stress_row* row)
{
  int* const failed = (int*)user;
  const int holds = row->missing == 0 && row->beyond <= 1e-4;
  const char* const kinds[2] = { "worst thickness", "share of pixels beyond 1e-5" };
  const double errors[2] = { row->worst, row->beyond };
  *failed += !holds;
  fprintf(stderr, "%-28s %-11s %7lld pixels  worst %.1e  beyond 1e-5 %.4f %%  missing %lld %s\n",
    row->name, row->parallel ? "parallel" : "perspective", (long long)row->pixels, row->worst,
    100 * row->beyond, (long long)row->missing, holds ? "" : "FAILS");
  for (int k = 0; k < 2; ++k)
  {
    printf("tet_stress,");
    for (const char* c = row->name; *c; ++c)
    {
      putchar(*c == ',' ? ';' : *c);
    }
    printf(",chi,%s,%lld,2,%.0f,%.3g,%s\n", row->parallel ? "parallel" : "perspective",
      (long long)row->pixels, row->ns, errors[k], kinds[k]);
  }
}

int main(void)
{
  chi_bench_pool two = { 2 };
  const chi_exec exec = chi_bench_exec(&two);
  int failed = 0;
  printf(CHI_BENCH_HEADER);
  const int ran = tet_stress(&exec, TETRAHEDRA, print_row, &failed);
  fprintf(stderr, "%d cases fail\n", failed);
  return !ran || failed != 0;
}
