/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_PLAN_H
#define CHI_DERIVED_PLAN_H

#include "chi_buffer.h"
#include "chi_derived_internal.h"

enum
{
  CHI_DERIVED_FIELDS = 4 /* the scalar, and the coordinates of curvilinear grids */
};

/* How a structured grid is gone through. */
typedef struct chi_derived_plan
{
  const chi_derived_job* job;
  const chi_derived_kernels* kernels;
  chi_derived_axis axis[3];
  chi_derived_along along[2];
  void* along_weights[2];
  size_t along_bytes[2];
  chi_derived_source source[CHI_DERIVED_FIELDS];
  size_t fields, n[3], row_bytes;
  int is_second, is_curved, narrows; /* double to float at the end */
  chi_derived_form form;
  size_t block_rows, block_planes, row_blocks, blocks, pieces;
  chi_derived_counts* counts; /* [pieces] */
  chi_buffer* scratch;        /* [pieces] */
} chi_derived_plan;

/* How many rows a block's scratch has: rings, derivatives of one row, results. */
size_t chi_derived_count_rows(const chi_derived_plan* plan);
chi_status chi_derived_run(chi_derived_plan* plan);

#endif
