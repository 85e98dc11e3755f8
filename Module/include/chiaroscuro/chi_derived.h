/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_DERIVED_H
#define CHI_DERIVED_H

/*
 * What a scalar field's first and second derivatives say at each point of a grid: how steep it is,
 * how that changes along the gradient, its Laplacian, and how its isosurfaces are curved. Source:
 * Kindlmann & Durkin, "Semi-Automatic Generation of Transfer Functions for Direct Volume
 * Rendering", 1998 (first and second derivative along the gradient); Kindlmann, Whitaker, Tasdizen
 * & Moller, "Curvature-Based Transfer Functions for Direct Volume Rendering", 2003.
 * Documentation/theory/derived.md has the formulas.
 */

#include "chi_grid.h"

#ifdef __cplusplus
extern "C"
{
#endif

typedef struct chi_derived_params
{
  size_t struct_size;
  int32_t order;     /**< of the differences on structured grids: 2 or 4; 0: 2 */
  int32_t component; /**< of the values: 0 ... components - 1, or -1: magnitude */
} chi_derived_params;

/** Arrays of the caller, [points] each; NULL: not wanted. */
typedef struct chi_derived_arrays
{
  size_t struct_size;
  chi_type type; /**< of all of them: CHI_F32 or CHI_F64 */
  int32_t reserved;
  void* gradient_magnitude; /**< |grad f| */
  void* second_derivative;  /**< along the gradient: n . Hess f . n with n = grad f / |grad f| */
  void* laplacian;          /**< div grad f */
  void* mean_curvature;     /**< of the isosurface: div(n) / 2; positive where it bulges towards
                                 higher values: a sphere about a minimum has 1 / radius */
} chi_derived_arrays;

typedef struct chi_derived_counts
{
  size_t struct_size;
  size_t points;            /**< of the grid */
  size_t flat_points;       /**< where |grad f| <= 1e-12 range / extent: second derivative along
                                 the gradient and curvature are 0 */
  size_t non_finite_points; /**< NaN, since a sample that they depend on is not finite or hidden */
  size_t undetermined_points; /**< NaN, since the mesh says nothing there: cells collapsed, points
                                   of no cell, coordinates that are not finite */
  size_t linear_points;       /**< of unstructured grids: with too few neighbours for all second
                                   derivatives; those that are missing count as 0 */
  double range[2];            /**< of the finite samples; 0, 0: none */
  double extent;              /**< diagonal of the bounding box */
  int32_t bad_axis;           /**< after CHI_ERROR_INVALID_ARGUMENT: the axis along which a grid
                                   stands still or turns back; else -1 */
  int32_t reserved;
} chi_derived_counts;

/**
 * Derive fields at the points of a grid.
 *
 * Images and rectilinear grids: differences of the given order along each axis, one-sided ones of
 * the same order at the boundary, mixed derivatives as products; exact for polynomials up to that
 * order (their second derivatives up to one degree more). Curvilinear grids: the same for field and
 * coordinates, and the chain rule; exact for linear fields on any grid, of the given order where
 * the mapping is smooth. An axis with fewer samples than the order needs has the order that it has
 * samples for; along an axis of one sample nothing changes, so that a sheet has the derivatives
 * within it. Unstructured grids: at each point the quadratic polynomial that goes through its value
 * and fits its neighbours' (points of the cells about it, and if these are few of the cells about
 * those) in least squares weighted by 1 / distance^2: exact for quadratic fields, first derivatives
 * of second order, second ones of first order (second where neighbours lie symmetrically).
 *
 * Hidden points (CHI_GRID_HIDDEN_POINT) count as samples that are not finite; hidden cells of
 * unstructured grids make no neighbours, those of structured grids are not looked at.
 *
 * @param[in]  exec    host services, or NULL
 * @param[in]  grid    of any kind
 * @param[in]  values  a tuple a point, any type
 * @param[in]  params  NULL: order 2, component 0
 * @param[in]  arrays  the struct is read, its arrays are written
 * @param[out] counts  after an error only points and bad_axis hold
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, order or component or type out of range, no
 * array wanted, values that are not one a point; with bad_axis an axis of zero length or parallel
 * to another, or coordinates of a rectilinear grid that do not strictly increase or decrease; cells
 * of an unstructured grid that are broken
 * @retval CHI_ERROR_OUT_OF_MEMORY  scratch was refused: 0.2 to 1 MiB for each of up to 64 pieces of
 * a structured grid, 16 bytes a point and 4 a corner of an unstructured one
 * @retval CHI_ERROR_TOO_LARGE, CHI_ERROR_CANCELLED
 *
 * Precision    float where the arrays are CHI_F32, values CHI_F32 or integers of up to 16 bits, and
 * the grid is an image or rectilinear; else double. Differences are of the samples to the one in
 * the middle, so that what is constant has derivatives of exactly 0; values and lengths are scaled
 * by powers of two, so that no range or spacing overflows. The rounding of the samples enters first
 * derivatives by about eps |f| / spacing and second ones by eps |f| / spacing^2.
 * Determinism  same bits for any number of threads, any parallel_for and any instruction set.
 * Non-finite   propagates to NaN where a stencil touches it, and is counted.
 * Cost         O(points); rows of a slab stay in cache, each sample is read twice.
 */
CHI_API CHI_NODISCARD chi_status chi_derived_compute(const chi_exec* exec,
  const chi_grid_view* grid, const chi_array_view* values, const chi_derived_params* params,
  const chi_derived_arrays* arrays, chi_derived_counts* counts);

#ifdef __cplusplus
}
#endif
#endif
