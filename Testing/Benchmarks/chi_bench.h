/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_BENCH_H
#define CHI_BENCH_H

/* What every core benchmark shares: a clock, a host with threads, what memory gives. */

#include <chiaroscuro/chi.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
  CHI_BENCH_RUNS = 5,
  CHI_BENCH_MAX_THREADS = 64,
  CHI_BENCH_TRIAD = 1 << 24, /* doubles: 400 MB in three arrays, which no cache holds */
  CHI_BENCH_TRIAD_PIECE = 1 << 14
};

#define CHI_BENCH_HEADER "topic,case,method,parameter,n,threads,min_ns,error,error_kind\n"

/* Nanoseconds since a fixed moment. */
static inline double chi_bench_now(void)
{
  struct timespec t;
  timespec_get(&t, TIME_UTC);
  return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static inline void chi_bench_must(int holds, const char* what)
{
  if (!holds)
  {
    fprintf(stderr, "%s failed\n", what);
    exit(1);
  }
}

/* count items of size bytes, not cleared. */
static inline void* chi_bench_room(size_t count, size_t size)
{
  void* const block = malloc(count * size);
  chi_bench_must(block != NULL, "malloc");
  return block;
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

typedef struct chi_bench_triad_arrays
{
  double *a, *b, *c;
} chi_bench_triad_arrays;

static inline void chi_bench_triad_pieces(void* data, size_t begin, size_t end)
{
  const chi_bench_triad_arrays* const t = (const chi_bench_triad_arrays*)data;
  for (size_t i = begin * CHI_BENCH_TRIAD_PIECE; i < end * CHI_BENCH_TRIAD_PIECE; ++i)
  {
    t->a[i] = t->b[i] + 3 * t->c[i];
  }
}

/* Prints a row with what memory gives, and returns it in GB/s; a store counts once. */
static inline double chi_bench_triad(const char* topic, int threads)
{
  chi_bench_pool pool = { threads };
  const size_t count = CHI_BENCH_TRIAD;
  chi_bench_triad_arrays t = { (double*)chi_bench_room(count, sizeof(double)),
    (double*)chi_bench_room(count, sizeof(double)),
    (double*)chi_bench_room(count, sizeof(double)) };
  memset(t.a, 0, count * sizeof(double));
  memset(t.b, 0, count * sizeof(double));
  memset(t.c, 0, count * sizeof(double));
  double best = -1;
  for (int i = 0; i < 2 * CHI_BENCH_RUNS; ++i)
  {
    const double start = chi_bench_now();
    chi_bench_for(&pool, count / CHI_BENCH_TRIAD_PIECE, chi_bench_triad_pieces, &t);
    const double took = chi_bench_now() - start;
    best = best < 0 || took < best ? took : best;
  }
  chi_bench_must(t.a[count - 1] == 0, "triad");
  const double bandwidth = 3 * sizeof(double) * (double)count / best;
  printf("%s,memory,triad,,%zu,%d,%.0f,%.3g,GB/s\n", topic, count, threads, best, bandwidth);
  free(t.a);
  free(t.b);
  free(t.c);
  return bandwidth;
}

#endif
