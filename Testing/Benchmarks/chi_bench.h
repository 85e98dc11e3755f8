/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_BENCH_H
#define CHI_BENCH_H

/* What every core benchmark shares: a clock and a host with threads. */

#include <chiaroscuro/chi.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum
{
  CHI_BENCH_RUNS = 5,
  CHI_BENCH_MAX_THREADS = 64
};

#define CHI_BENCH_HEADER "topic,case,method,parameter,n,threads,min_ns,error,error_kind\n"

/* Nanoseconds since a fixed moment. */
static inline double chi_bench_now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* A plain parallel_for: threads of its own a call, pieces handed out by a counter. */
typedef struct chi_bench_pool
{
  int threads;
} chi_bench_pool;

typedef struct chi_bench_job
{
  chi_range_fn body;
  void* data;
  size_t count, piece;
  atomic_size_t next;
} chi_bench_job;

static inline void* chi_bench_work(void* arg)
{
  chi_bench_job* const job = (chi_bench_job*)arg;
  for (;;)
  {
    const size_t begin = atomic_fetch_add(&job->next, job->piece);
    if (begin >= job->count)
    {
      return NULL;
    }
    const size_t end = begin + job->piece < job->count ? begin + job->piece : job->count;
    job->body(job->data, begin, end);
  }
}

static inline void chi_bench_for(void* user, size_t count, chi_range_fn body, void* data)
{
  const int threads = ((const chi_bench_pool*)user)->threads;
  chi_bench_job job = { body, data, count, count / (size_t)(16 * threads) + 1, 0 };
  pthread_t thread[CHI_BENCH_MAX_THREADS];
  int started = 0;
  while (started < threads - 1 && pthread_create(thread + started, NULL, chi_bench_work, &job) == 0)
  {
    ++started;
  }
  chi_bench_work(&job);
  for (int i = 0; i < started; ++i)
  {
    pthread_join(thread[i], NULL);
  }
}

static inline chi_exec chi_bench_exec(chi_bench_pool* p)
{
  return (chi_exec){ .struct_size = sizeof(chi_exec), .user = p, .parallel_for = chi_bench_for };
}

#endif
