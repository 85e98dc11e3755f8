/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FUZZ_H
#define CHI_FUZZ_H

/*
 * What every fuzzer shares: bytes read as choices, numbers of all kinds, exact-size buffers, a host
 * that refuses, cancels and keeps account, and a check that ends the process.
 *
 * Bytes are read from the front; at the end all further choices are 0. So any bytes are a valid
 * program, and 0 is everywhere the harmless choice.
 */

#include <chiaroscuro/chi_spline.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count);

#define FUZZ_CHECK(condition)                                                                      \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      fprintf(stderr, "%s:%d: %s: %s\n", __FILE__, __LINE__, __func__, #condition);                \
      abort();                                                                                     \
    }                                                                                              \
  } while (0)

#define FUZZ_UNUSED __attribute__((unused)) static

enum
{
  FUZZ_MAX_BLOCKS = 4096
};

/* All that one input owns. */
typedef struct fuzz
{
  const uint8_t* bytes;
  size_t count;
  void* kept[256]; /* freed at the end */
  size_t kept_count;
  uint64_t versions; /* of data handed out */
  /* the host */
  long refuse_at, cancel_at, allocations, polls;
  int refused, cancelled, backwards;
  size_t live_bytes, live_count;
  struct
  {
    void* block;
    size_t bytes;
  } live[FUZZ_MAX_BLOCKS];
} fuzz;

FUZZ_UNUSED unsigned fuzz_byte(fuzz* f)
{
  if (f->count == 0)
  {
    return 0;
  }
  --f->count;
  return *f->bytes++;
}

FUZZ_UNUSED uint64_t fuzz_bits(fuzz* f, int bytes)
{
  uint64_t x = 0;
  while (bytes-- > 0)
  {
    x = x << 8 | fuzz_byte(f);
  }
  return x;
}

/* 0 ... last */
FUZZ_UNUSED size_t fuzz_upto(fuzz* f, size_t last)
{
  return (size_t)(fuzz_bits(f, last > 255 ? 2 : 1) % (last + 1));
}

/* True once in about `n` times; never where the bytes have ended. */
FUZZ_UNUSED int fuzz_once_in(fuzz* f, unsigned n)
{
  return fuzz_byte(f) % n == n - 1;
}

/* A number of unit size, on a coarse grid so that equal ones occur. */
FUZZ_UNUSED double fuzz_unit(fuzz* f)
{
  return ((double)fuzz_byte(f) - 128) / 16;
}

/* Any number: of unit size mostly, seldom far, tiny, huge, not finite, or any bits at all. */
FUZZ_UNUSED double fuzz_any(fuzz* f)
{
  const unsigned kind = fuzz_byte(f);
  const double unit = fuzz_unit(f);
  switch (kind)
  {
    case 255:
      return NAN;
    case 254:
      return unit < 0 ? -INFINITY : INFINITY;
    case 253:
      return unit * 1e300;
    case 252:
      return unit * 1e-300;
    case 251:
      return unit * 1e38;
    case 250:
      return unit * 1e-38;
    case 249:
      return unit * 4.9e-324;
    case 248:
      return unit + 1e8;
    case 247:
      return unit * 1e30;
    case 246:
      return unit * 1e-12;
    case 245:
    {
      const uint64_t bits = fuzz_bits(f, 8);
      double x;
      memcpy(&x, &bits, sizeof x);
      return x;
    }
    case 244:
      return -0.0;
    default:
      return kind < 128 ? unit : unit + (double)fuzz_byte(f) / 4096;
  }
}

/* The harmless value, or seldom any number. */
FUZZ_UNUSED double fuzz_mostly(fuzz* f, double harmless)
{
  return fuzz_once_in(f, 16) ? fuzz_any(f) : harmless;
}

/* A struct's size, seldom that of an older version, or nonsense of no more bytes. */
FUZZ_UNUSED size_t fuzz_size(fuzz* f, size_t size)
{
  return fuzz_once_in(f, 64) ? fuzz_upto(f, size) : size;
}

/* Heap of exactly this size, so that the sanitizer sees every overrun, filled with 0xa5. */
FUZZ_UNUSED void* fuzz_new(fuzz* f, size_t bytes)
{
  void* const block = malloc(bytes ? bytes : 1);
  FUZZ_CHECK(block && f->kept_count < sizeof f->kept / sizeof f->kept[0]);
  memset(block, 0xa5, bytes);
  f->kept[f->kept_count++] = block;
  return bytes ? block : (char*)block + 1;
}

FUZZ_UNUSED void fuzz_forget(fuzz* f, size_t down_to)
{
  while (f->kept_count > down_to)
  {
    free(f->kept[--f->kept_count]);
  }
}

FUZZ_UNUSED void* fuzz_alloc(void* user, size_t bytes, size_t alignment)
{
  fuzz* const f = (fuzz*)user;
  FUZZ_CHECK(bytes > 0 && alignment > 0 && (alignment & (alignment - 1)) == 0);
  /* no machine is endless */
  if (f->allocations++ == f->refuse_at || bytes > (256u << 20) - f->live_bytes ||
    f->live_count == FUZZ_MAX_BLOCKS)
  {
    f->refused = 1;
    return NULL;
  }
  void* block = NULL;
  FUZZ_CHECK(posix_memalign(&block, alignment < 16 ? 16 : alignment, bytes) == 0);
  memset(block, 0xa5, bytes < 65536 ? bytes : 65536);
  f->live[f->live_count].block = block;
  f->live[f->live_count++].bytes = bytes;
  f->live_bytes += bytes;
  return block;
}

FUZZ_UNUSED void fuzz_release(void* user, void* block, size_t bytes)
{
  fuzz* const f = (fuzz*)user;
  size_t i = 0;
  while (i < f->live_count && f->live[i].block != block)
  {
    ++i;
  }
  FUZZ_CHECK(i < f->live_count && f->live[i].bytes == bytes); /* ours, and as large as asked for */
  f->live[i] = f->live[--f->live_count];
  f->live_bytes -= bytes;
  free(block);
}

FUZZ_UNUSED int fuzz_is_cancelled(void* user)
{
  fuzz* const f = (fuzz*)user;
  f->cancelled |= f->polls++ >= f->cancel_at;
  return f->cancelled;
}

FUZZ_UNUSED void fuzz_parallel_for(void* user, size_t count, chi_range_fn body, void* data)
{
  if (!((fuzz*)user)->backwards)
  {
    body(data, 0, count);
    return;
  }
  while (count-- > 0)
  {
    body(data, count, count + 1);
  }
}

/* A host: friendly mostly, else it refuses one allocation or cancels. Every one ends a call that
 * polls more than `patience` times. */
FUZZ_UNUSED chi_exec fuzz_host(fuzz* f, long patience)
{
  f->refuse_at = fuzz_once_in(f, 8) ? (long)fuzz_upto(f, 40) : -1;
  f->cancel_at = fuzz_once_in(f, 8) ? (long)fuzz_upto(f, 300) : patience;
  f->backwards = fuzz_byte(f) & 1;
  f->refused = f->cancelled = 0;
  f->allocations = f->polls = 0;
  return (chi_exec){ .struct_size = sizeof(chi_exec),
    .user = f,
    .parallel_for = fuzz_parallel_for,
    .alloc = fuzz_alloc,
    .release = fuzz_release,
    .is_cancelled = fuzz_is_cancelled };
}

/* Before a call: what the host did to it is counted from here. */
FUZZ_UNUSED void fuzz_before(fuzz* f)
{
  f->refused = f->cancelled = 0;
  f->allocations = f->polls = 0;
}

/* After it: a status from the list, and the one that the host's answers ask for. */
FUZZ_UNUSED void fuzz_after(const fuzz* f, chi_status status)
{
  FUZZ_CHECK(status >= CHI_OK && status <= CHI_ERROR_NOT_READY && status != CHI_ERROR_EMPTY);
  FUZZ_CHECK(status != CHI_ERROR_OUT_OF_MEMORY || f->refused);
  FUZZ_CHECK(status != CHI_ERROR_CANCELLED || f->cancelled);
  FUZZ_CHECK(status != CHI_OK || (!f->refused && !f->cancelled));
}

/* What an input is read through, until fuzz_end. */
FUZZ_UNUSED fuzz* fuzz_begin(const uint8_t* bytes, size_t count)
{
  fuzz* const f = (fuzz*)calloc(1, sizeof *f);
  FUZZ_CHECK(f);
  f->bytes = bytes;
  f->count = count;
  return f;
}

/* The library has given back all that it took. */
FUZZ_UNUSED void fuzz_check_all_is_back(const fuzz* f)
{
  FUZZ_CHECK(f->live_count == 0 && f->live_bytes == 0);
}

FUZZ_UNUSED void fuzz_end(fuzz* f)
{
  fuzz_check_all_is_back(f);
  fuzz_forget(f, 0);
  free(f);
}

FUZZ_UNUSED int fuzz_is_in(double x, double low, double high)
{
  return x >= low && x <= high;
}

/* Store x at `at` as this type; out of range is clamped, so that no conversion is undefined. */
FUZZ_UNUSED void fuzz_store(char* at, chi_type type, double x)
{
#define FUZZ_CASE(code, ctype, low, high)                                                          \
  case code:                                                                                       \
  {                                                                                                \
    const ctype y = (ctype)(x > (low) ? (x < (high) ? x : (high)) : (low));                        \
    memcpy(at, &y, sizeof y);                                                                      \
    break;                                                                                         \
  }
  switch (type)
  {
    case CHI_F32:
    {
      const float y = isfinite(x) && fabs(x) > 3.4e38 ? (x < 0 ? -3.4e38f : 3.4e38f) : (float)x;
      memcpy(at, &y, sizeof y);
      break;
    }
    case CHI_F64:
      memcpy(at, &x, sizeof x);
      break;
      FUZZ_CASE(CHI_I8, int8_t, -128, 127)
      FUZZ_CASE(CHI_U8, uint8_t, 0, 255)
      FUZZ_CASE(CHI_I16, int16_t, -32768, 32767)
      FUZZ_CASE(CHI_U16, uint16_t, 0, 65535)
      FUZZ_CASE(CHI_I32, int32_t, -2147483648.0, 2147483647.0)
      FUZZ_CASE(CHI_U32, uint32_t, 0, 4294967295.0)
      FUZZ_CASE(CHI_I64, int64_t, -9223372036854774784.0, 9223372036854774784.0)
      FUZZ_CASE(CHI_U64, uint64_t, 0, 18446744073709549568.0)
    default:
      break;
  }
#undef FUZZ_CASE
}

/* `count` tuples of any numbers, at any stride and alignment, ending with the heap block. */
FUZZ_UNUSED chi_array_view fuzz_array(fuzz* f, size_t count, size_t components, chi_type type)
{
  const size_t size = chi_type_size(type), tuple = components * size;
  const size_t stride = tuple + (fuzz_once_in(f, 4) ? fuzz_upto(f, 9) : 0);
  const size_t shift = fuzz_once_in(f, 4) ? fuzz_upto(f, 7) : 0;
  char* const data = (char*)fuzz_new(f, shift + (count ? (count - 1) * stride + tuple : 0)) + shift;
  const double magnitude = fuzz_once_in(f, 8) ? fabs(fuzz_any(f)) : 1;
  for (size_t i = 0; i < count * components; ++i)
  {
    fuzz_store(
      data + i / components * stride + i % components * size, type, magnitude * fuzz_any(f));
  }
  return (chi_array_view){ data, count, components, stride, type };
}

FUZZ_UNUSED double fuzz_value(const chi_array_view* a, size_t i, size_t component)
{
  const char* const at = (const char*)a->data + i * a->stride;
  if (a->type == CHI_F32)
  {
    float x;
    memcpy(&x, at + component * sizeof x, sizeof x);
    return (double)x;
  }
  double x;
  memcpy(&x, at + component * sizeof x, sizeof x);
  return x;
}

/* Polylines: few, short, with repeats, closed ones, and ids that many lines share. `extent`: the
 * largest finite coordinate. */
FUZZ_UNUSED chi_lines_view fuzz_lines(fuzz* f, double* extent)
{
  const size_t points = fuzz_upto(f, 40), lines = fuzz_upto(f, 20);
  const chi_array_view xyz = fuzz_array(f, points, 3, fuzz_byte(f) & 1 ? CHI_F32 : CHI_F64);
  chi_lines_view view = { { xyz.data, points, xyz.stride, xyz.type }, NULL, NULL, lines };
  *extent = 0;
  for (size_t i = 0; i < 3 * points; ++i)
  {
    const double x = fabs(fuzz_value(&xyz, i / 3, i % 3));
    *extent = isfinite(x) ? fmax(*extent, x) : *extent;
  }
  const int identity = fuzz_once_in(f, 4);
  int64_t* const offsets = (int64_t*)fuzz_new(f, (lines + 1) * sizeof *offsets);
  size_t at = fuzz_once_in(f, 4) ? fuzz_upto(f, 3) : 0;
  for (size_t i = 0; i <= lines; ++i)
  {
    at = identity && at > points ? points : at;
    offsets[i] = (int64_t)at;
    at += fuzz_once_in(f, 8) ? fuzz_upto(f, 90) : fuzz_upto(f, 12);
  }
  view.offsets = offsets;
  if (!identity)
  {
    const size_t count = (size_t)offsets[lines];
    int64_t* const ids = (int64_t*)fuzz_new(f, count * sizeof *ids);
    const size_t step = fuzz_upto(f, 3);
    for (size_t i = 0; i < count; ++i)
    {
      ids[i] = points ? (int64_t)((step ? i * step : fuzz_upto(f, points - 1)) % points) : 0;
    }
    for (size_t i = 0; i < lines && step; ++i) /* some close */
    {
      if (offsets[i + 1] > offsets[i] && fuzz_once_in(f, 3))
      {
        ids[offsets[i + 1] - 1] = ids[offsets[i]];
      }
    }
    view.connectivity = ids;
    view.line_count = points || count == 0 ? lines : 0;
  }
  if (fuzz_once_in(f, 32)) /* one thing that is wrong */
  {
    const size_t which = fuzz_upto(f, 5), i = fuzz_upto(f, lines);
    if (which == 0)
    {
      view.points.stride = 3 * chi_type_size(view.points.type) - 1 - fuzz_upto(f, 10);
    }
    else if (which == 1)
    {
      view.points.type = (chi_type)fuzz_bits(f, 4);
      view.points.type = view.points.type == CHI_F64 ? CHI_I8 : view.points.type;
      view.points.stride = 24;
      view.points.type = view.points.type == CHI_F32 ? CHI_U8 : view.points.type;
    }
    else if (which == 2)
    {
      offsets[i] = -1 - (int64_t)fuzz_upto(f, 3);
    }
    else if (which == 3 && i > 0)
    {
      offsets[i] = offsets[i - 1] - 1;
    }
    else if (which == 4 && view.connectivity && offsets[lines] > offsets[0])
    {
      ((int64_t*)view.connectivity)[offsets[0]] = fuzz_byte(f) & 1 ? -1 : (int64_t)points;
    }
    else if (which == 5)
    {
      view.points.data = NULL;
    }
  }
  return view;
}

/* The rules of the views, once more and in other words. */
FUZZ_UNUSED int fuzz_lines_are_valid(const chi_lines_view* lines)
{
  const chi_vec3_view* const p = &lines->points;
  const size_t size = p->type == CHI_F32 ? 4 : p->type == CHI_F64 ? 8 : 0;
  if (!size || p->stride < 3 * size || (!p->data && p->count))
  {
    return 0;
  }
  if (lines->line_count == 0)
  {
    return 1;
  }
  for (size_t i = 0; i <= lines->line_count; ++i)
  {
    if (lines->offsets[i] < (i ? lines->offsets[i - 1] : 0))
    {
      return 0;
    }
  }
  for (int64_t k = lines->offsets[0]; k < lines->offsets[lines->line_count]; ++k)
  {
    const int64_t id = lines->connectivity ? lines->connectivity[k] : k;
    if (id < 0 || id >= (int64_t)p->count)
    {
      return 0;
    }
  }
  return 1;
}

/* Parameters of a fit; harmless mostly. */
FUZZ_UNUSED chi_spline_params fuzz_spline_params(fuzz* f)
{
  static const int32_t method[4] = { CHI_SPLINE_PROGRESSIVE, CHI_SPLINE_POLYLINE,
    CHI_SPLINE_INTERPOLATE, CHI_SPLINE_LEAST_SQUARES };
  chi_spline_params p = { .struct_size = fuzz_size(f, sizeof p) };
  p.tolerance = fuzz_mostly(f, (double)fuzz_byte(f) / 64);
  p.method = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 4) : method[fuzz_upto(f, 3)];
  p.max_iterations = fuzz_once_in(f, 4) ? (int32_t)fuzz_upto(f, 100) - 2 : 0;
  p.max_halvings = fuzz_once_in(f, 4) ? (int32_t)fuzz_upto(f, 40) - 2 : 0;
  p.merge_distance = fuzz_once_in(f, 4) ? fuzz_mostly(f, (double)fuzz_byte(f) / 64) : 0;
  p.coefficients = fuzz_once_in(f, 4) ? fuzz_upto(f, 60) : 0;
  return p;
}

FUZZ_UNUSED int fuzz_spline_params_are_valid(const chi_spline_params* p)
{
  return p->struct_size >= offsetof(chi_spline_params, coefficients) && p->struct_size % 8 == 0 &&
    p->tolerance >= 0 && p->tolerance < INFINITY && p->merge_distance >= 0 &&
    p->merge_distance < INFINITY && p->method >= 0 && p->method <= 3;
}

#endif
