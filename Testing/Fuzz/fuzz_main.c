/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Runs a fuzzer without libFuzzer: the same inputs everywhere and each time, or those in files.
 *
 *   fuzz_<topic> [COUNT [FIRST]]     inputs FIRST ... FIRST + COUNT - 1
 *   fuzz_<topic> FILE...             each file's bytes, as libFuzzer leaves them behind
 *
 * Input i depends on i alone. What ends the process names it, so that COUNT 1 runs it again.
 */

#include "fuzz.h"

#include <signal.h>
#include <unistd.h>

enum
{
  LONGEST = 4096
};

static unsigned long running;

static void name_input(void)
{
  char text[64];
  const int length = snprintf(text, sizeof text, "input %lu\n", running);
  if (write(STDERR_FILENO, text, (size_t)length) < 0)
  {
    return;
  }
}

static void on_signal(int signal_number)
{
  name_input();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

/* The sanitizers ask for these; an abort names the input. */
const char* __asan_default_options(void);
const char* __ubsan_default_options(void);
const char* __asan_default_options(void)
{
  return "abort_on_error=1";
}
const char* __ubsan_default_options(void)
{
  return "abort_on_error=1";
}

/* SplitMix64: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
 */
static uint64_t next(uint64_t* state)
{
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static void fill(uint8_t* bytes, size_t count, uint64_t* state)
{
  for (size_t i = 0; i < count; ++i)
  {
    bytes[i] = (uint8_t)(next(state) >> 56);
  }
}

/* Input i: random bytes; every second one is a variant of the input a block of 16 begins with, with
 * bytes changed, a piece repeated elsewhere, or calm stretches of zeros. */
static size_t make_input(unsigned long i, uint8_t* bytes)
{
  uint64_t base = i & 1 ? i / 16 * 16 : i, state = 0x1234567u + i;
  size_t count = (size_t)(next(&base) % LONGEST);
  count = i % 3 ? count : count / 16;
  fill(bytes, count, &base);
  for (uint64_t changes = i & 1 ? 1 + next(&state) % 8 : 0; changes > 0 && count > 0; --changes)
  {
    const size_t at = (size_t)(next(&state) % count), from = (size_t)(next(&state) % count);
    const size_t room = count - (at > from ? at : from);
    const size_t length = 1 + (size_t)(next(&state) % (room < 64 ? room : 64));
    switch (next(&state) % 4)
    {
      case 0:
        bytes[at] = (uint8_t)next(&state);
        break;
      case 1:
        bytes[at] = (uint8_t)(bytes[at] ^ 1u << next(&state) % 8);
        break;
      case 2:
        memmove(bytes + at, bytes + from, length);
        break;
      default:
        memset(bytes + at, next(&state) & 1 ? 0 : 255, length);
        break;
    }
  }
  return count;
}

static int run(const uint8_t* bytes, size_t count)
{
  uint8_t* const exact = (uint8_t*)malloc(count ? count : 1);
  if (!exact)
  {
    return 1;
  }
  memcpy(exact, bytes, count);
  const int result = LLVMFuzzerTestOneInput(exact, count);
  free(exact);
  return result;
}

static int run_file(const char* name)
{
  static uint8_t bytes[1 << 20];
  FILE* const file = fopen(name, "rb");
  if (!file)
  {
    perror(name);
    return 1;
  }
  const size_t count = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  return run(bytes, count);
}

int main(int argc, char* argv[])
{
  signal(SIGABRT, on_signal);
  char* end = NULL;
  const unsigned long count = argc > 1 ? strtoul(argv[1], &end, 10) : 1000;
  if (end && *end)
  {
    int failed = 0;
    for (int i = 1; i < argc; ++i)
    {
      failed |= run_file(argv[i]);
    }
    return failed;
  }
  const unsigned long first = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
  static uint8_t bytes[LONGEST];
  for (running = first; running < first + count; ++running)
  {
    if (run(bytes, make_input(running, bytes)))
    {
      return 1;
    }
  }
  printf("%lu inputs\n", count);
  return 0;
}
