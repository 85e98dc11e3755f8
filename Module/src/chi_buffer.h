/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_BUFFER_H
#define CHI_BUFFER_H

#include <chiaroscuro/chi.h>

/* Scratch that grows and is kept: per-frame calls allocate only where a scene outgrows the last. */
typedef struct chi_buffer
{
  void* data; /* at the start of a cache line: a vector of 64 bytes touches one, not two */
  size_t bytes;
  void* block; /* as allocated, up to a line more */
} chi_buffer;

/* 0 when refused; the old contents are lost when it grows. */
int chi_buffer_reserve(const chi_exec* exec, chi_buffer* buffer, size_t count, size_t size);
void chi_buffer_free(const chi_exec* exec, chi_buffer* buffer);

#endif
