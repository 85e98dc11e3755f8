/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_VOLUME_H
#define CHI_VOLUME_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_NEAREST = 0,
  CHI_LINEAR = 1
};

/**
 * Borrowed regular samples, x fastest. Sample (i, j, k) lies at index_to_world * (i, j, k, 1).
 * With `is_cell_data` the samples are values of cells, constant margins included: sample (i, j, k)
 * is the centre of cell (i, j, k) and the volume reaches half a sample beyond the outermost ones.
 */
typedef struct chi_volume_view
{
  size_t struct_size;
  const void* scalars;
  chi_type type;             /**< any chi_type */
  size_t stride;             /**< bytes from one sample to the next; >= chi_type_size(type) */
  size_t dimensions[3];      /**< samples along x, y, z */
  double index_to_world[16]; /**< row-major, affine; mirrors and shears are allowed */
  int32_t is_cell_data;
  int32_t interpolation; /**< CHI_NEAREST or CHI_LINEAR */
  uint64_t version;      /**< differs whenever the samples do; the caller's time stamp */
} chi_volume_view;

#ifdef __cplusplus
}
#endif
#endif
