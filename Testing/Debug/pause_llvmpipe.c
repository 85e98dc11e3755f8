/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Lets llvmpipe's threads rest where any scheduler may let them rest: with the mutex of a fence
 * held, after the last count. Shows the fault that Documentation/dev/memory.md describes; no test
 * loads it.
 *
 *   cc -O2 -fPIC -shared -o pause_llvmpipe.so Testing/Debug/pause_llvmpipe.c
 *   PYTHONMALLOC=malloc LD_PRELOAD=$PWD/pause_llvmpipe.so python3 program_that_draws.py
 */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

int pthread_cond_broadcast(pthread_cond_t* condition)
{
  static _Thread_local unsigned seed;
  static _Thread_local int paused = -1;
  int (*real)(pthread_cond_t*);
  *(void**)&real = dlvsym(RTLD_NEXT, "pthread_cond_broadcast", "GLIBC_2.3.2");
  if (paused < 0)
  {
    char name[16] = "";
    prctl(PR_GET_NAME, name);
    paused = strncmp(name, "llvmpipe-", 9) == 0;
    seed = (unsigned)getpid() + (unsigned)(size_t)&seed;
  }
  const int result = real(condition);
  if (paused && rand_r(&seed) % 10 == 0)
  {
    const struct timespec rest = { 0, 300000 };
    nanosleep(&rest, NULL);
  }
  return result;
}
