/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_COUNTING_HOST_H
#define CHI_COUNTING_HOST_H

/* A host that counts the bytes it gives out, on the threads of another one. */

#include <chiaroscuro/chi.h>

#include <stdlib.h>

typedef struct counting_host
{
  const chi_exec* exec; /* whose threads; NULL: serial */
  size_t live, peak;    /* bytes */
  size_t allocations;
} counting_host;

static inline void counting_for(void* user, size_t count, chi_range_fn body, void* data)
{
  const counting_host* const h = (const counting_host*)user;
  if (h->exec && h->exec->parallel_for)
  {
    h->exec->parallel_for(h->exec->user, count, body, data);
  }
  else if (count > 0)
  {
    body(data, 0, count);
  }
}

static inline void* counting_alloc(void* user, size_t bytes, size_t alignment)
{
  counting_host* const h = (counting_host*)user;
  void* const block = aligned_alloc(64, (bytes + 63) / 64 * 64);
  (void)alignment; /* none larger is ever asked for */
  h->live += block ? bytes : 0;
  h->peak = h->live > h->peak ? h->live : h->peak;
  ++h->allocations;
  return block;
}

static inline void counting_release(void* user, void* block, size_t bytes)
{
  ((counting_host*)user)->live -= block ? bytes : 0;
  free(block);
}

static inline chi_exec counting_exec(counting_host* host)
{
  return (chi_exec){ .struct_size = sizeof(chi_exec),
    .user = host,
    .parallel_for = counting_for,
    .alloc = counting_alloc,
    .release = counting_release };
}

#endif
