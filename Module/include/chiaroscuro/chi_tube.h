/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_H
#define CHI_TUBE_H

#include "chi_spline.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** The plan of a sweep: which lines, where their rings lie, how large the outputs are. */
typedef struct chi_tube chi_tube;

enum
{
  CHI_TUBE_ROTATION_MINIMISING = 0,
  CHI_TUBE_FRENET = 1
};
enum
{
  CHI_TUBE_CAP_NONE = 0,
  CHI_TUBE_CAP_FLAT = 1,
  CHI_TUBE_CAP_ROUND = 2
};
enum
{
  CHI_TUBE_STRIPS = 0,
  CHI_TUBE_TRIANGLES = 1
};

typedef struct chi_tube_params
{
  size_t struct_size;
  double radius; /**< length units, > 0; times the radius arrays where there are any */
  const chi_array_view* point_radius; /**< NULL, or one factor a point (index: point id), >= 0 */
  const chi_array_view* line_radius;  /**< NULL, or one factor a line, >= 0 */
  int32_t sides;                      /**< >= 3; 0 = from chord_tolerance, 3 ... 64 */
  int32_t frame;                      /**< CHI_TUBE_ROTATION_MINIMISING or _FRENET */
  int32_t cap;                        /**< CHI_TUBE_CAP_... */
  int32_t cells;                      /**< CHI_TUBE_STRIPS or _TRIANGLES */
  int32_t limit_radius;   /**< non-zero: radius < 1 / curvature (Schott et al. 2013, section 4) */
  int32_t keep_rings;     /**< non-zero: one ring at every cleaned input point, nothing dropped */
  double chord_tolerance; /**< largest distance of the axis between rings from their chord, and of
                             the radius from linear, length units, > 0 */
  double angular_tolerance_rad; /**< largest turn of the axis between rings, > 0 */
  double
    attribute_tolerance; /**< largest error of a float array, fraction of its range; 0 ignores */
  const chi_array_view* const* attributes; /**< float point arrays that hold rings in place */
  size_t attribute_count;
  const double* clip_box; /**< NULL, or xmin xmax ymin ymax zmin zmax: lines wholly outside, radius
                               included, are not tubed */
  double min_length;      /**< lines with a shorter chord length are not tubed */
} chi_tube_params;

typedef struct chi_tube_sizes
{
  size_t struct_size;
  size_t points;       /**< output vertices */
  size_t cells;        /**< strips or triangles, caps included */
  size_t connectivity; /**< entries of the connectivity array */
  size_t rings;
  size_t curves;        /**< lines that are tubed */
  size_t curve_points;  /**< points of the curves as polylines: one a ring, one more where closed */
  size_t clamped_radii; /**< rings whose radius was limited */
  size_t removed_rings; /**< candidates that every tolerance allowed to drop */
  size_t outside_lines; /**< wholly outside clip_box */
  size_t short_lines;   /**< shorter than min_length */
  int32_t sides;
  int32_t reserved;
  uint64_t bytes; /**< of f32 points and normals, i64 connectivity, parameter and line ids */
} chi_tube_sizes;

/** Caller-allocated outputs; NULL members are not written. */
typedef struct chi_tube_outputs
{
  size_t struct_size;
  void* points;        /**< [points x 3] of point_type */
  chi_type point_type; /**< CHI_F32 or CHI_F64 */
  float* normals;      /**< [points x 3] unit, outward */
  float* tcoords; /**< [points x 2] along: (arc length of the rings, radius-free) / tcoord_length,
                       around: side / sides */
  double tcoord_length;    /**< > 0; 0: each line's own length, so that it runs from 0 to 1 */
  float* parameter;        /**< [points] curve parameter, 0 ... 1 */
  int64_t* line_ids;       /**< [cells] index of the input line */
  int64_t* offsets;        /**< [cells + 1] */
  int64_t* connectivity;   /**< [connectivity] */
  double* curve_points;    /**< [curve_points x 3] */
  int64_t* curve_offsets;  /**< [curves + 1] */
  int64_t* curve_line_ids; /**< [curves] */
} chi_tube_outputs;

/** @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null), CHI_ERROR_OUT_OF_MEMORY */
CHI_API CHI_NODISCARD chi_status chi_tube_create(const chi_exec* exec, chi_tube** tube);
/** NULL is accepted. */
CHI_API void chi_tube_destroy(const chi_exec* exec, chi_tube* tube);

/**
 * Choose lines, rings and radii; afterwards the sizes are known and nothing has been written.
 *
 * @param[in]     exec    host services, or NULL
 * @param[in,out] tube    plan; borrows `spline` and `lines`, which must stay as they are until the
 * last sweep or attribute call
 * @param[in]     spline  curves of exactly these lines (chi_spline_fit); degree 1 gives mitred
 * rings
 * @param[in]     lines   the input of that fit, for the points' ids
 * @param[in]     params  borrowed for the call
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, parameter out of range, array of the wrong
 * length, a radius that is negative or not finite
 * @retval CHI_ERROR_OUT_OF_MEMORY     scratch of about 12 bytes a ring was refused
 * @retval CHI_ERROR_TOO_LARGE         an output would overflow 64 bits
 * @retval CHI_ERROR_CANCELLED
 *
 * Precision    double; tolerances are the caller's, in length units.
 * Determinism  same bits for any number of threads and any parallel_for.
 * Cost         O(candidate rings log rings) a line.
 * Source       Schott et al. 2013, section 4.
 */
CHI_API CHI_NODISCARD chi_status chi_tube_plan(const chi_exec* exec, chi_tube* tube,
  const chi_spline* spline, const chi_lines_view* lines, const chi_tube_params* params);
CHI_API void chi_tube_get_sizes(const chi_tube* tube, chi_tube_sizes* sizes);

/**
 * Write the surface planned last: rings of `sides` vertices along rotation-minimising (or
 * consistent Frenet) frames, caps, cells.
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT, CHI_ERROR_NOT_READY (no plan), CHI_ERROR_CANCELLED
 *
 * Precision    axis and frames in double, offsets from the axis in float, sums in point_type.
 * Determinism  same bits for any schedule.
 * Source       Wang, Juettler, Zheng & Liu, "Computation of Rotation Minimizing Frames", ACM TOG
 * 27(1), 2008, section 4 (double reflection).
 */
CHI_API CHI_NODISCARD chi_status chi_tube_sweep(
  const chi_exec* exec, const chi_tube* tube, const chi_tube_outputs* outputs);

enum
{
  CHI_TUBE_SURFACE = 0, /**< one tuple an output vertex */
  CHI_TUBE_CURVES = 1   /**< one tuple a curve point */
};

/**
 * Carry a point array through the spline. Float types: linear in the curve's parameter between
 * input points, so never beyond their values; other types: from the nearest input point.
 *
 * @param[in]  in   [points of the lines' view] tuples
 * @param[out] out  [points or curve_points] tuples of the same type and components
 */
CHI_API CHI_NODISCARD chi_status chi_tube_attribute(const chi_exec* exec, const chi_tube* tube,
  int32_t target, const chi_array_view* in, void* out, size_t out_stride);

/** Nearest input point's id for every output point (strings and whatever the core cannot read). */
CHI_API CHI_NODISCARD chi_status chi_tube_nearest(
  const chi_exec* exec, const chi_tube* tube, int32_t target, int64_t* ids);

#ifdef __cplusplus
}
#endif
#endif
