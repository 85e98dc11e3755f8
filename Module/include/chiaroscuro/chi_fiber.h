/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FIBER_H
#define CHI_FIBER_H

/*
 * Fiber surfaces: the points of a mesh at which two fields take the values on a polygon in the
 * plane of these fields. Within a tetrahedron both fields are linear, so a segment of the polygon
 * gives a plane, cut off where the segment ends; that is the surface, exactly. Source: Carr, Geng,
 * Tierny, Chattopadhyay & Knoll, "Fiber Surfaces: Generalizing Isosurfaces to Bivariate Data", CGF
 * 34(3), 2015; Klacansky, Tierny, Carr & Geng, "Fast and Exact Fiber Surfaces for Tetrahedral
 * Meshes", IEEE TVCG 23(7), 2017.
 */

#include "chi_grid.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** The index of a mesh with two fields, kept between calls, and the surface extracted last. */
typedef struct chi_fiber chi_fiber;

/** Bits of chi_fiber_params.no_skipping and positions in chi_fiber_sizes.skipped. */
enum
{
  CHI_FIBER_SKIP_BRICKS = 1,    /**< bricks of cells whose ranges miss every segment of a batch */
  CHI_FIBER_SKIP_RUNS = 2,      /**< runs of points that no brick needs, or on one side of all */
  CHI_FIBER_SKIP_UNCHANGED = 4, /**< index and surface of inputs that have not changed */
  CHI_FIBER_SKIP_KINDS = 3
};

typedef struct chi_fiber_params
{
  size_t struct_size;
  const chi_array_view* fields[2]; /**< a tuple a point each */
  int32_t components[2];           /**< 0 ... components - 1, or -1: magnitude */
  uint64_t fields_version;         /**< differs whenever a value does; 0: never the same */
  chi_lines_view polygon;  /**< x and y of its points are values of the first and second field. A
                              line that ends where it begins is closed */
  int32_t split_corners;   /**< non-zero: the parts of two segments share no points */
  int32_t no_normals;      /**< non-zero: none are wanted */
  int32_t find_components; /**< non-zero: find connected parts */
  int32_t no_skipping;     /**< CHI_FIBER_SKIP_... that are switched off */
  double minimum_area;     /**< connected parts of less are left out; 0: none are */
} chi_fiber_params;

typedef struct chi_fiber_sizes
{
  size_t struct_size;
  size_t points, triangles; /**< of the surface */
  size_t segments;          /**< that were extracted */
  size_t empty_segments;    /**< of no length: they keep their ids and give nothing */
  size_t components;        /**< connected parts, where they are wanted */
  size_t left_out;          /**< connected parts below the minimum area */
  size_t tetrahedra;        /**< of the mesh */
  size_t crossed;           /**< pairs of a tetrahedron and a segment with a part of the surface */
  size_t non_finite_values; /**< cells with a tetrahedron that was left out, since a value there is
                               NaN, infinite or beyond 1e100 */
  size_t non_finite_cells;  /**< likewise a coordinate */
  size_t hidden_cells;      /**< ghosts, blanked */
  size_t other_cells;       /**< without volume, or of types that are not split */
  int64_t first_bad_cell;   /**< as chi_grid_counts has it */
  double field_ranges[4];   /**< of the finite values: least, most; least, most */
  int64_t skipped[CHI_FIBER_SKIP_KINDS]; /**< [k] belongs to the flag 1 << k: bricks of all batches
                               of segments; runs; 1: the index was kept, 2: the surface too */
  uint64_t scratch_bytes;                /**< that the handle holds */
} chi_fiber_sizes;

/** Caller-allocated outputs; NULL members are not written. */
typedef struct chi_fiber_outputs
{
  size_t struct_size;
  void* points;        /**< [points x 3] of point_type */
  chi_type point_type; /**< CHI_F32 or CHI_F64 */
  int32_t reserved;
  float* normals;           /**< [points x 3] unit, away from the polygon's inside */
  float* segment_parameter; /**< [points] 0 ... 1 along the segment; at a corner that two segments
                               share 0, that of the one which begins there */
  int64_t* offsets;         /**< [triangles + 1] */
  int64_t* connectivity;    /**< [triangles x 3] counterclockwise as seen from outside */
  int64_t* segment_ids;     /**< [triangles] counted through all lines of the polygon */
  int64_t* cell_ids;        /**< [triangles] the cell of the mesh that each lies in */
  int64_t* component_ids;   /**< [triangles] 0 ..., in the order of their first triangles */
} chi_fiber_outputs;

/** @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null), CHI_ERROR_OUT_OF_MEMORY */
CHI_API CHI_NODISCARD chi_status chi_fiber_create(const chi_exec* exec, chi_fiber** fiber);
/** NULL is accepted. */
CHI_API void chi_fiber_destroy(const chi_exec* exec, chi_fiber* fiber);

/**
 * Find the fiber surface of a polygon; afterwards its sizes are known and nothing has been written.
 *
 * The inside of a closed line is what it turns about (a loop is turned so that its area is not
 * negative; if it crosses itself the sign of its whole area decides), that of an open one lies on
 * its left. The surface is counterclockwise as seen from outside. Lines may cross themselves and
 * each other; parts of the surface that cross are not joined.
 *
 * A value exactly on the polygon is taken as if all of the polygon were moved by (e, e^2), e
 * infinitely small, in all cells alike: the surface of a closed line within a mesh is closed,
 * whatever the values. Points that fall together so are one point, and what of a triangle is then
 * left without area is left out.
 *
 * @param[in]     exec    host services, or NULL
 * @param[in,out] fiber   keeps an index of the mesh and its fields by grid->version and
 * params->fields_version
 * @param[in]     grid    borrowed until the last chi_fiber_write, _attribute or _mask of this
 * surface
 * @param[in]     params  read in this call; the fields' values are copied
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, a field that is not a tuple a point, component
 * out of range, a polygon that is malformed or not finite, negative or non-finite minimum_area; or
 * a broken cell: first_bad_cell of the sizes
 * @retval CHI_ERROR_OUT_OF_MEMORY     17 bytes a point for the index, 8 a point, and about 300 a
 * crossed pair; grids that are neither images, rectilinear nor tetrahedra alone 20 a tetrahedron
 * @retval CHI_ERROR_TOO_LARGE         more than 2^32 - 2 points, or corners of the surface's parts
 * @retval CHI_ERROR_CANCELLED         after this and other errors there is no surface
 *
 * Precision    positions in double; signs that decide topology are exact.
 * Determinism  same bits for any number of threads and any parallel_for.
 * Non-finite   tetrahedra with such a corner are left out, their cells counted.
 * Cost         O(points) a batch of 8 segments, bricks, and the tetrahedra of bricks that a segment
 * meets.
 * Source       Klacansky et al. 2017, section 4 (planes, cut off); Edelsbrunner & Muecke,
 * "Simulation of Simplicity", 1990, for the ties.
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_extract(const chi_exec* exec, chi_fiber* fiber,
  const chi_grid_view* grid, const chi_fiber_params* params);
CHI_API void chi_fiber_get_sizes(const chi_fiber* fiber, chi_fiber_sizes* sizes);

/**
 * Write the surface extracted last. Normals are the gradients of the segment's signed distance in
 * the tetrahedra around a point, weighted by volume: of first order in their size.
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null, unknown type, normals or components that were
 * not asked for), CHI_ERROR_NOT_READY (no surface), CHI_ERROR_CANCELLED
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_write(
  const chi_exec* exec, const chi_fiber* fiber, const chi_fiber_outputs* outputs);

/**
 * Carry a point array to the surface: float types linearly, others from the nearest point (the one
 * of most weight, of equal ones the lowest id).
 *
 * @param[in]  in   a tuple a point of the grid
 * @param[out] out  [points] tuples of the same type and components
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT, CHI_ERROR_NOT_READY, CHI_ERROR_CANCELLED
 *
 * Non-finite   propagates from the points that have weight.
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_attribute(const chi_exec* exec, const chi_fiber* fiber,
  const chi_array_view* in, void* out, size_t out_stride);

/** Nearest point's id of every point of the surface (strings and whatever the core cannot read). */
CHI_API CHI_NODISCARD chi_status chi_fiber_nearest(
  const chi_exec* exec, const chi_fiber* fiber, int64_t* ids);

/**
 * Which cells touch the inside of the polygon's closed lines (inside of an odd number of them): 1,
 * else 0. What is left out of the surface is 0.
 *
 * @param[out] mask  [cells of the grid]
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT, CHI_ERROR_NOT_READY, CHI_ERROR_CANCELLED,
 * CHI_ERROR_OUT_OF_MEMORY (a byte a point)
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_mask(
  const chi_exec* exec, const chi_fiber* fiber, uint8_t* mask);

/** What a surface's polygon encloses. */
typedef struct chi_fiber_enclosed_sizes
{
  size_t struct_size;
  size_t points, cells;   /**< of its tetrahedra */
  size_t whole_cells;     /**< that are the mesh's own: the first ones */
  size_t pieces;          /**< triangles that the polygon's inside is cut into */
  size_t open_segments;   /**< of lines that do not end where they begin */
  double volume;          /**< of all cells */
  uint64_t scratch_bytes; /**< that the handle holds for it, beside those of the surface */
} chi_fiber_enclosed_sizes;

/** Caller-allocated outputs; NULL members are not written. */
typedef struct chi_fiber_enclosed_outputs
{
  size_t struct_size;
  void* points;        /**< [points x 3] of point_type: those of the mesh first, ascending */
  chi_type point_type; /**< CHI_F32 or CHI_F64 */
  int32_t reserved;
  int64_t* offsets;      /**< [cells + 1] */
  int64_t* connectivity; /**< [cells x 4] right-handed tetrahedra */
  int64_t* cell_ids;     /**< [cells] the cell of the mesh that each is a part of */
} chi_fiber_enclosed_outputs;

/**
 * Cut out what the closed lines of the surface extracted last enclose: the part of the mesh whose
 * values lie inside of an odd number of them (the rule of even and odd, as chi_fiber_mask), as
 * tetrahedra that share whole faces.
 *
 * The inside is divided into triangles between the polygon's corners. Tetrahedra of the mesh that
 * no side of a triangle passes are taken as they are, the others are cut along all of them: along
 * the fiber surface, exactly, at its very points, and along the fiber surfaces of the lines between
 * triangles. Lines that cross or run on one another are legal; where they cross is rounded to
 * double, and bends them by as much.
 *
 * @param[in]     exec   host services, or NULL
 * @param[in,out] fiber  with a surface; its grid is borrowed until the last call for this surface
 * @param[out]    sizes  of the result, which is kept until the surface changes
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null; or a line is open: open_segments of the sizes
 * @retval CHI_ERROR_NOT_READY         no surface
 * @retval CHI_ERROR_OUT_OF_MEMORY     14 bytes a point, a bit a tetrahedron, about 500 a pair of a
 * tetrahedron and a side that passes it
 * @retval CHI_ERROR_TOO_LARGE         2^32 points and more; or lines that cross so closely that
 * rounding never lets them end
 * @retval CHI_ERROR_CANCELLED
 *
 * Precision    as of the surface; the volume is the sum of the cells' between points in double.
 * Determinism  same bits for any number of threads and any parallel_for.
 * Non-finite   as of the surface: such tetrahedra are left out.
 * Cost         O(tetrahedra), and the pairs as in chi_fiber_extract; the polygon's triangles O(n^2)
 * at most for n corners.
 * Source       De Loera, Rambau & Santos, "Triangulations", 2010, chapter 4 (pulling); Sloan,
 * "A fast algorithm for generating constrained Delaunay triangulations", 1993.
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_enclose(
  const chi_exec* exec, chi_fiber* fiber, chi_fiber_enclosed_sizes* sizes);

/**
 * Write what chi_fiber_enclose found.
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null, unknown type), CHI_ERROR_NOT_READY (nothing has
 * been enclosed since the surface changed), CHI_ERROR_CANCELLED
 */
CHI_API CHI_NODISCARD chi_status chi_fiber_enclosed_write(
  const chi_exec* exec, const chi_fiber* fiber, const chi_fiber_enclosed_outputs* outputs);

/** As chi_fiber_attribute, to the points of what is enclosed. */
CHI_API CHI_NODISCARD chi_status chi_fiber_enclosed_attribute(const chi_exec* exec,
  const chi_fiber* fiber, const chi_array_view* in, void* out, size_t out_stride);

/** As chi_fiber_nearest, of the points of what is enclosed. */
CHI_API CHI_NODISCARD chi_status chi_fiber_enclosed_nearest(
  const chi_exec* exec, const chi_fiber* fiber, int64_t* ids);

#ifdef __cplusplus
}
#endif
#endif
