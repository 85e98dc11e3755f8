/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_internal.h"

#include <stdlib.h>
#include <string.h>

int32_t chi_version(void)
{
  return 100;
}

const char* chi_status_string(chi_status status)
{
  switch (status)
  {
    case CHI_OK:
      return "success";
    case CHI_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case CHI_ERROR_EMPTY:
      return "empty input";
    case CHI_ERROR_OUT_OF_MEMORY:
      return "out of memory";
    case CHI_ERROR_CANCELLED:
      return "cancelled";
    case CHI_ERROR_TOO_LARGE:
      return "too large";
    case CHI_ERROR_NOT_READY:
      return "not ready";
    default:
      return "unknown status";
  }
}

void* chi_alloc(const chi_exec* exec, size_t count, size_t size)
{
  if (count == 0 || count > SIZE_MAX / size)
  {
    return NULL;
  }
  return exec && exec->alloc ? exec->alloc(exec->user, count * size, 16) : malloc(count * size);
}

void chi_free(const chi_exec* exec, void* block, size_t count, size_t size)
{
  if (exec && exec->release)
  {
    exec->release(exec->user, block, count * size);
  }
  else
  {
    free(block);
  }
}

int chi_is_cancelled(const chi_exec* exec)
{
  return exec && exec->is_cancelled && exec->is_cancelled(exec->user);
}

chi_status chi_for(const chi_exec* exec, size_t count, chi_range_fn body, void* data)
{
  if (exec && exec->parallel_for)
  {
    exec->parallel_for(exec->user, count, body, data);
  }
  else
  {
    body(data, 0, count);
  }
  return chi_is_cancelled(exec) ? CHI_ERROR_CANCELLED : CHI_OK;
}

size_t chi_type_size(chi_type type)
{
  static const size_t size[] = { 0, 4, 8, 1, 1, 2, 2, 4, 4, 8, 8 };
  return type >= CHI_F32 && type <= CHI_U64 ? size[type] : 0;
}

int chi_adopt(void* own, size_t size, size_t least, const void* given)
{
  const unsigned char* const bytes = (const unsigned char*)given;
  size_t length;
  memcpy(&length, given, sizeof length);
  /* No version's size ends within a member, or adds so much: nobody has set it. */
  if (length < least || length % sizeof length || length > size + 4096)
  {
    return 0;
  }
  for (size_t i = size; i < length; ++i)
  {
    if (bytes[i])
    {
      return 0;
    }
  }
  memcpy(own, given, length < size ? length : size);
  memcpy(own, &size, sizeof size);
  return 1;
}

int chi_view_is_valid(const chi_vec3_view* view)
{
  return view && (view->type == CHI_F32 || view->type == CHI_F64) &&
    view->stride >= 3 * chi_type_size(view->type) && (view->data || view->count == 0);
}

int chi_array_is_valid(const chi_array_view* view)
{
  const size_t size = view ? chi_type_size(view->type) : 0;
  return size && view->components > 0 && view->components <= SIZE_MAX / size &&
    view->stride >= view->components * size && (view->data || view->count == 0);
}

int chi_lines_are_valid(const chi_lines_view* lines)
{
  if (!lines || !chi_view_is_valid(&lines->points) || (lines->line_count && !lines->offsets))
  {
    return 0;
  }
  if (lines->line_count == 0)
  {
    return 1;
  }
  if (lines->offsets[0] < 0)
  {
    return 0;
  }
  for (size_t i = 0; i < lines->line_count; ++i)
  {
    if (lines->offsets[i + 1] < lines->offsets[i])
    {
      return 0;
    }
  }
  const int64_t end = lines->offsets[lines->line_count];
  if (!lines->connectivity)
  {
    return (uint64_t)end <= lines->points.count;
  }
  for (int64_t i = lines->offsets[0]; i < end; ++i)
  {
    if (lines->connectivity[i] < 0 || (uint64_t)lines->connectivity[i] >= lines->points.count)
    {
      return 0;
    }
  }
  return 1;
}

void chi_view_get(const chi_vec3_view* view, size_t i, double x[3])
{
  const char* const item = (const char*)view->data + i * view->stride;
  if (view->type == CHI_F64)
  {
    memcpy(x, item, 3 * sizeof(double));
    return;
  }
  float single[3];
  memcpy(single, item, sizeof single);
  for (int k = 0; k < 3; ++k)
  {
    x[k] = single[k];
  }
}
