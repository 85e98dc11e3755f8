/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TRANSFER_SHAPES_H
#define CHI_TRANSFER_SHAPES_H

/*
 * Transfer functions of two quantities, drawn by shapes: rectangles, trapezoids, Gaussians,
 * polygons and images. Source: Kniss, Kindlmann & Hansen, "Multidimensional Transfer Functions for
 * Interactive Volume Rendering", 2002. Documentation/theory/transfer.md has the formulas.
 */

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_SHAPE_RECTANGLE = 0,
  CHI_SHAPE_TRAPEZOID = 1,
  CHI_SHAPE_GAUSSIAN = 2,
  CHI_SHAPE_POLYGON = 3, /**< hard edges, even-odd; what crosses itself has holes */
  CHI_SHAPE_IMAGE = 4    /**< linear between its entries, beyond them the nearest one */
};

/** One material: a colour, and an opacity that is weighted by the place within the shape. Members
 * that its kind does not name are not read. */
typedef struct chi_transfer_shape
{
  size_t struct_size;
  int32_t kind; /**< CHI_SHAPE_... */
  int32_t reserved;
  double rgba[4];   /**< colour and largest opacity, 0 ... 1; of an image it multiplies */
  double low[2];    /**< rectangle, trapezoid, image: smallest x, y; of an image the centre of its
                         first entry */
  double high[2];   /**< largest; likewise; each larger than `low` */
  double top[2];    /**< trapezoid: smallest and largest x at high[1]; low[0], high[0] are those at
                         low[1], and either pair may be one point */
  double softness;  /**< rectangle, trapezoid: 0 ... 1, the share of the half width, from the edge
                         inwards, over which opacity rises; 1: a tent, 0: hard edges. Of a
                         trapezoid along x alone */
  double center[2]; /**< Gaussian */
  double sigma[2];  /**< Gaussian: standard deviations, > 0 */
  double correlation;    /**< Gaussian: -1 < c < 1 */
  const double* polygon; /**< [polygon_count x 2] */
  size_t polygon_count;  /**< 3 ... 65536 */
  const float* image;    /**< [image_size[1] x image_size[0] x 4], 0 ... 1; x fastest */
  size_t image_size[2];  /**< each 2 ... 65536, together up to 2^22 */
} chi_transfer_shape;

/**
 * Colour and opacity at one place: extinctions add, as of materials that are mixed, so that the
 * order of the shapes means nothing. opacity = 1 - prod (1 - a_i), colour = sum t_i c_i / sum t_i
 * with t_i = -ln(1 - min(a_i, 1 - 2^-24)); black where all are transparent.
 *
 * @param[in]  shapes  [count]
 * @param[in]  x, y    NaN: transparent
 * @param[out] rgba    0 ... 1, not premultiplied
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, unknown kind, member that is not finite or out
 * of its range
 *
 * Precision    double. Cost  O(sum of shapes and polygon points).
 */
CHI_API CHI_NODISCARD chi_status chi_transfer_shapes_map(
  const chi_transfer_shape* shapes, size_t count, double x, double y, double rgba[4]);

/**
 * The same as a table for chi_transfer_view.plane: entries are equidistant over the ranges, both
 * ends included. Rectangles, trapezoids and polygons enter each entry by their mean weight over the
 * rectangle of one step about it, taken at 8 x 8 places, so that hard edges lie where they are to a
 * sixteenth of a step; Gaussians and images by their value there.
 *
 * @param[in]  exec     host services, or NULL
 * @param[in]  shapes   [count]; none: all is transparent
 * @param[in]  size     entries along x, y: each 2 ... 65536, together up to 2^22
 * @param[in]  x_range  of the first and the last entry; likewise y_range; low < high
 * @param[out] rgba     [size[1] x size[0] x 4]
 *
 * @retval CHI_OK, CHI_ERROR_CANCELLED, CHI_ERROR_OUT_OF_MEMORY (1000 bytes an entry of a row)
 * @retval CHI_ERROR_INVALID_ARGUMENT  as of chi_transfer_shapes_map, and sizes and ranges
 *
 * Determinism  same bits for any number of threads and any parallel_for.
 */
CHI_API CHI_NODISCARD chi_status chi_transfer_shapes_table(const chi_exec* exec,
  const chi_transfer_shape* shapes, size_t count, const size_t size[2], const double x_range[2],
  const double y_range[2], float* rgba);

#ifdef __cplusplus
}
#endif
#endif
