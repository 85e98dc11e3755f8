/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_INTERNAL_H
#define CHI_INTERNAL_H

#include <chiaroscuro/chi.h>

#include <stddef.h>
#include <string.h>

/* Scratch from the host. NULL when refused, when count is 0, or when count * size overflows. */
void* chi_alloc(const chi_exec* exec, size_t count, size_t size);
void chi_free(const chi_exec* exec, void* block, size_t count, size_t size);

/* Run body over [0, count) with the host's threads. CHI_OK or CHI_ERROR_CANCELLED. */
chi_status chi_for(const chi_exec* exec, size_t count, chi_range_fn body, void* data);
int chi_is_cancelled(const chi_exec* exec);

/*
 * A struct as one of ours, whichever version of the library its caller was compiled for: as long as
 * its struct_size says, which is its first member. `own` is ours, `size` long, and holds the
 * defaults, which stay in members that the caller does not know. 0, and nothing has been read
 * beyond it, where it is shorter than `least`, the first version's members, or says more than we
 * can know of: where bytes beyond ours are not 0.
 */
int chi_adopt(void* own, size_t size, size_t least, const void* given);
#define CHI_BEYOND(type, member) (offsetof(type, member) + sizeof(((type*)0)->member))
/* The last member that the first version had is `last`. */
#define CHI_ADOPT(type, last, own, given)                                                          \
  chi_adopt((own), sizeof(type), CHI_BEYOND(type, last), (given))

int chi_view_is_valid(const chi_vec3_view* view);
int chi_array_is_valid(const chi_array_view* view);

/* Offsets ordered, ids in range; reads all of both, so call it once an entry. */
int chi_lines_are_valid(const chi_lines_view* lines);
void chi_view_get(const chi_vec3_view* view, size_t i, double x[3]);

/* A number of any type, as a double: its sign and its integers up to 2^53 are exact. */
static inline double chi_number_at(const void* at, chi_type type)
{
#define CHI_CASE(code, ctype)                                                                      \
  case code:                                                                                       \
  {                                                                                                \
    ctype x;                                                                                       \
    memcpy(&x, at, sizeof x);                                                                      \
    return (double)x;                                                                              \
  }
  switch (type)
  {
    CHI_CASE(CHI_F32, float)
    CHI_CASE(CHI_F64, double)
    CHI_CASE(CHI_I8, int8_t)
    CHI_CASE(CHI_U8, uint8_t)
    CHI_CASE(CHI_I16, int16_t)
    CHI_CASE(CHI_U16, uint16_t)
    CHI_CASE(CHI_I32, int32_t)
    CHI_CASE(CHI_U32, uint32_t)
    CHI_CASE(CHI_I64, int64_t)
    CHI_CASE(CHI_U64, uint64_t)
    default:
      return 0;
  }
#undef CHI_CASE
}

#endif
