/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The occlusion engine at the ends of what numbers can hold, as a table: how far each case is from
 * what must stay true of it, and the bound. The rows are those that test_occlusion_stress checks.
 *
 * Prints CSV (nothing is timed; the error_kind names the invariant and its bound), and the table on
 * the standard error.
 */

#include "occlusion_stress.h"

#include "chi_bench.h"

#include <string.h>

static void print_field(const char* text)
{
  for (; *text; ++text)
  {
    putchar(*text == ',' ? ';' : *text);
  }
}

static void print_row(void* user, const stress_row* row)
{
  int* const failed = (int*)user;
  const int holds = row->measured <= row->bound;
  *failed += !holds;
  fprintf(stderr, "%-52s %9.3g  %-46s %9.3g <= %-9.3g %s\n", row->name, row->parameter,
    row->invariant, row->measured, row->bound, holds ? "" : "FAILS");
  printf("occlusion_stress,");
  print_field(row->name);
  printf(",chi,%g,0,2,0,%g,bound %g: ", row->parameter, row->measured, row->bound);
  print_field(row->invariant);
  putchar('\n');
}

int main(void)
{
  chi_bench_pool two = { 2 };
  const chi_exec exec = chi_bench_exec(&two);
  int failed = 0;
  printf(CHI_BENCH_HEADER);
  occlusion_stress(&exec, 4000, print_row, &failed);
  fprintf(stderr, "%d cases fail\n", failed);
  return failed != 0;
}
