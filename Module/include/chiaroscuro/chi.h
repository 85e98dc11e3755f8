/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_CHI_H
#define CHI_CHI_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(CHI_SHARED)
#  ifdef CHI_BUILDING
#    define CHI_API __declspec(dllexport)
#  else
#    define CHI_API __declspec(dllimport)
#  endif
#elif defined(__GNUC__)
#  define CHI_API __attribute__((visibility("default")))
#else
#  define CHI_API
#endif

#if defined(__GNUC__)
#  define CHI_NODISCARD __attribute__((warn_unused_result))
#else
#  define CHI_NODISCARD
#endif

#ifdef __cplusplus
extern "C"
{
#endif

/*
 * Structs that calls read begin with struct_size: sizeof as the caller was compiled, and never more
 * than the memory that is there. Later versions of the library append members, and nothing else;
 * what a caller's struct is too short for has its default. A call is refused with
 * CHI_ERROR_INVALID_ARGUMENT where a struct is shorter than it was in the first version, or is
 * longer than the library's and anything but 0 stands in what the library does not know. Structs
 * that calls write are as long as the library's header says.
 */

/** Result of every call that can fail. Values are pinned: never renumbered, never reused. */
typedef int32_t chi_status;
enum
{
  CHI_OK = 0,
  CHI_ERROR_INVALID_ARGUMENT = 1, /**< null pointer, stride < item size, unknown type */
  CHI_ERROR_EMPTY = 2,            /**< the result is undefined for zero items */
  CHI_ERROR_OUT_OF_MEMORY = 3,
  CHI_ERROR_CANCELLED = 4, /**< is_cancelled returned non-zero; outputs unspecified */
  CHI_ERROR_TOO_LARGE = 5, /**< a count or size overflows, or exceeds the stated bound */
  CHI_ERROR_NOT_READY = 6  /**< a handle lacks the earlier call that this one builds on */
};

/** Version of the library as major * 10000 + minor * 100 + patch. */
CHI_API int32_t chi_version(void);

/** Static, never-NULL description of `status`; valid for the life of the process. */
CHI_API const char* chi_status_string(chi_status status);

typedef int32_t chi_type;
enum
{
  CHI_F32 = 1,
  CHI_F64 = 2,
  CHI_I8 = 3,
  CHI_U8 = 4,
  CHI_I16 = 5,
  CHI_U16 = 6,
  CHI_I32 = 7,
  CHI_U32 = 8,
  CHI_I64 = 9,
  CHI_U64 = 10
};

/** Bytes of one component of `type`; 0 for an unknown type. */
CHI_API size_t chi_type_size(chi_type type);

/** Borrowed, strided view of `count` 3-vectors; item i starts at (char*)data + i * stride. */
typedef struct chi_vec3_view
{
  const void* data;
  size_t count;
  size_t stride; /**< bytes between items; >= 3 * sizeof(component) */
  chi_type type; /**< component type, CHI_F32 or CHI_F64 */
} chi_vec3_view;

/** Borrowed, strided view of `count` tuples of `components` values each (an attribute array). */
typedef struct chi_array_view
{
  const void* data;
  size_t count;      /**< tuples */
  size_t components; /**< values a tuple, >= 1 */
  size_t stride;     /**< bytes between tuples; >= components * chi_type_size(type) */
  chi_type type;     /**< any chi_type */
} chi_array_view;

/**
 * Borrowed polylines: line i visits the points connectivity[offsets[i]] ... connectivity[offsets[i
 * + 1] - 1]. A NULL connectivity means the identity.
 */
typedef struct chi_lines_view
{
  chi_vec3_view points;
  const int64_t* offsets;      /**< [line_count + 1], non-decreasing, offsets[0] >= 0 */
  const int64_t* connectivity; /**< [offsets[line_count]] point ids, or NULL */
  size_t line_count;
} chi_lines_view;

typedef void (*chi_range_fn)(void* data, size_t begin, size_t end);

/** Everything a call may ask of its host. NULL, or any NULL member, selects the serial default.
 */
typedef struct chi_exec
{
  size_t struct_size; /**< sizeof(chi_exec) of the caller */
  void* user;         /**< passed back as the first argument of every hook */
  void (*parallel_for)(void* user, size_t count, chi_range_fn body, void* data);
  void* (*alloc)(void* user, size_t bytes, size_t alignment);
  void (*release)(void* user, void* block, size_t bytes);
  int (*is_cancelled)(void* user); /**< polled from any thread; once true, stays true */
  void (*progress)(void* user, double fraction); /**< called from the entry thread only */
} chi_exec;

#ifdef __cplusplus
}
#endif
#endif
