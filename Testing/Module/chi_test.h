/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TEST_H
#define CHI_TEST_H

/* What every core test shares: checks that count, hosts that are hostile, numbers that repeat. */

#include <chiaroscuro/chi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int chi_test_checks, chi_test_failures;

#define CHECK(condition)                                                                           \
  do                                                                                               \
  {                                                                                                \
    ++chi_test_checks;                                                                             \
    if (!(condition))                                                                              \
    {                                                                                              \
      ++chi_test_failures;                                                                         \
      fprintf(stderr, "%s:%d: %s: %s\n", __FILE__, __LINE__, __func__, #condition);                \
    }                                                                                              \
  } while (0)

#define CHECK_NEAR(actual, expected, tolerance)                                                    \
  do                                                                                               \
  {                                                                                                \
    const double chi_a = (actual), chi_e = (expected);                                             \
    ++chi_test_checks;                                                                             \
    if (!(fabs(chi_a - chi_e) <= (tolerance)))                                                     \
    {                                                                                              \
      ++chi_test_failures;                                                                         \
      fprintf(stderr, "%s:%d: %s: %s is %.9g, not %.9g +- %.3g\n", __FILE__, __LINE__, __func__,   \
        #actual, chi_a, chi_e, (double)(tolerance));                                               \
    }                                                                                              \
  } while (0)

static int chi_test_report(void)
{
  printf("%d passed, %d failed\n", chi_test_checks - chi_test_failures, chi_test_failures);
  return chi_test_failures != 0;
}

/* Last chunk first, one at a time: the least friendly schedule that the contract allows. */
__attribute__((unused)) static void chi_test_backwards(
  void* user, size_t count, chi_range_fn body, void* data)
{
  (void)user;
  while (count-- > 0)
  {
    body(data, count, count + 1);
  }
}

/* A host that refuses its `refuse_at`-th allocation (counted from 0; never if negative) and cancels
 * at its `cancel_at`-th poll; it counts what was asked and what was not given back. */
typedef struct chi_test_host
{
  long refuse_at, cancel_at, allocations, polls, live;
} chi_test_host;

__attribute__((unused)) static void* chi_test_alloc(void* user, size_t bytes, size_t alignment)
{
  chi_test_host* const host = (chi_test_host*)user;
  if (host->allocations++ == host->refuse_at)
  {
    return NULL;
  }
  ++host->live;
  const size_t a = alignment < sizeof(void*) ? sizeof(void*) : alignment;
  void* block = NULL;
  return posix_memalign(&block, a, bytes) == 0 ? block : NULL; /* exact size: ASan sees overruns */
}

__attribute__((unused)) static void chi_test_release(void* user, void* block, size_t bytes)
{
  (void)bytes;
  if (block)
  {
    --((chi_test_host*)user)->live;
  }
  free(block);
}

__attribute__((unused)) static int chi_test_is_cancelled(void* user)
{
  chi_test_host* const host = (chi_test_host*)user;
  return host->polls++ >= host->cancel_at;
}

/* The next number in [0, 1) of a generator that any language can repeat. */
__attribute__((unused)) static double chi_test_random(uint32_t* state)
{
  *state = *state * 1664525u + 1013904223u;
  return (double)*state * 0x1p-32;
}

#endif
