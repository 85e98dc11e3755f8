/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TRANSFER_H
#define CHI_TRANSFER_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

/**
 * Borrowed tables of colour and opacity over the scalar, `count` equidistant entries from range[0]
 * to range[1], both included; scalars outside are clamped to the range. Opacity is that of a path
 * of `unit_distance`; extinction = -ln(1 - min(opacity, 1 - 2^-24)) / unit_distance.
 */
typedef struct chi_transfer_view
{
  size_t struct_size;
  const float* rgb;     /**< [count x 3], 0 ... 1 */
  const float* opacity; /**< [count], 0 ... 1 */
  size_t count;         /**< 2 ... 65536 */
  double range[2];      /**< scalar units; range[0] < range[1] */
  double unit_distance; /**< world units, > 0 */
  uint64_t version;     /**< differs whenever the tables do */
  /** Opacity by the gradient, or NULL: extinction is multiplied by it. Equidistant entries over the
   * gradient's magnitude from 0 to gradient_end, beyond which the last one holds. The magnitude is
   * that of the central difference, one sample to either side, in scalar units a mean voxel: times
   * the mean of the three edges of a voxel. */
  const float* gradient_opacity; /**< [gradient_count], cut to 0 ... 1; NaN: 0 */
  size_t gradient_count;         /**< 2 ... 65536 */
  double gradient_end;           /**< > 0 */
  /** Colour and opacity over two quantities, or NULL; in place of rgb, opacity and
   * gradient_opacity, which are not read then. Along x the scalar over `range`, along y the
   * gradient's magnitude as above, or what y_samples says, over plane_range, both clamped; linear
   * between entries. */
  const float* plane;     /**< [plane_count[1] x plane_count[0] x 4] red, green, blue, opacity,
                               0 ... 1; x fastest */
  size_t plane_count[2];  /**< of x and y: each 2 ... 65536, together up to 2^22 */
  double plane_range[2];  /**< y; plane_range[0] < plane_range[1] */
  const float* y_samples; /**< as many as the volume's, in their order; NULL: the gradient.
                               What is not finite makes its cells transparent */
  size_t table_count;     /**< of tables one after the other, [table_count x count], one a label of
                               chi_mask_view; 0 or 1: one; count x table_count <= 2^22 */
} chi_transfer_view;

#ifdef __cplusplus
}
#endif
#endif
