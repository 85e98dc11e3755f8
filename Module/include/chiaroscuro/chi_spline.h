/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SPLINE_H
#define CHI_SPLINE_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** A set of fitted curves, one per input line, owned by the handle and reused between fits. */
typedef struct chi_spline chi_spline;

typedef struct chi_spline_params
{
  size_t struct_size;
  double tolerance; /**< largest distance of an input point to its curve, length units; >= 0 */
  int32_t method;   /**< CHI_SPLINE_... below */
  int32_t max_iterations; /**< of the coefficient update, a halving; 0 = default (64) */
  int32_t max_halvings;   /**< of the data reduction; 0 = default (16), -1 = none */
  /** Points closer than this to the one before are dropped and counted; 0 = exact repeats only. */
  double merge_distance;
  size_t coefficients; /**< CHI_SPLINE_LEAST_SQUARES of an open line: exactly so many (>= 4; at most
                          one a point); 0 = by halving while the tolerance holds */
} chi_spline_params;

enum
{
  CHI_SPLINE_PROGRESSIVE = 0, /**< Schott et al. 2013, section 4.1: the default */
  CHI_SPLINE_POLYLINE = 1,    /**< no fit: degree 1 through the input points */
  CHI_SPLINE_INTERPOLATE = 2, /**< peer for the benchmark: cubic through every point */
  CHI_SPLINE_LEAST_SQUARES =
    3 /**< peer: cubic with the same coefficients a halving level, least squares */
};

/** Why a line has no curve; CHI_SPLINE_USED otherwise. */
enum
{
  CHI_SPLINE_USED = 0,
  CHI_SPLINE_TOO_FEW_POINTS = 1, /**< fewer than two points in the input */
  CHI_SPLINE_ALL_EQUAL = 2,      /**< all (finite) points coincide */
  CHI_SPLINE_NOT_FINITE = 3      /**< fewer than two finite points are left */
};

/**
 * One curve, borrowed from the handle until the next fit or destroy. Position at u in [0, 1]:
 * sum_i N_i(u) coefficients[i], relative to `origin` (kept apart, so that lines at 1e8 lose
 * nothing). Closed curves are periodic: the first `degree` coefficients are repeated at the end, so
 * that both kinds evaluate alike.
 */
typedef struct chi_spline_curve
{
  const double* coefficients; /**< [count x 3], minus origin */
  const double* knots;        /**< [count + degree + 1], non-decreasing, chord length over length */
  size_t count;               /**< 0 where the line has no curve */
  int32_t degree;             /**< 1 or 3 */
  int32_t closed;             /**< 1: first and last input point are equal bit for bit */
  int32_t reason;             /**< CHI_SPLINE_USED ... CHI_SPLINE_NOT_FINITE */
  double origin[3];
  double length;    /**< chord length of the cleaned input line */
  double max_error; /**< >= the two-sided Hausdorff distance curve <-> cleaned polyline */
  /** Cleaned input points: parameter in [0, 1] and index within the line, both ascending. */
  const double* point_parameters; /**< [point_count] */
  const int64_t* point_indices;   /**< [point_count], index into the line's connectivity */
  size_t point_count;
} chi_spline_curve;

typedef struct chi_spline_stats
{
  size_t struct_size;
  size_t curves;            /**< lines that have a curve */
  size_t coefficients;      /**< control points of all curves, repeats of closed ones not counted */
  size_t skipped_lines;     /**< lines without a curve, all reasons */
  size_t skipped[4];        /**< by reason */
  size_t repeated_points;   /**< dropped: equal to the one before, or within merge_distance */
  size_t non_finite_points; /**< dropped: NaN or infinite */
  double max_error;         /**< the largest of the curves' */
  double max_point_error;   /**< the largest distance of an input point to its curve; <= tolerance
                               where the fit converged */
  size_t unconverged;       /**< curves whose tolerance could not be met */
} chi_spline_stats;

/**
 * A handle without curves.
 *
 * @param[in]  exec    host services, or NULL; alloc and release must serve the handle's whole life
 * @param[out] spline  the handle; NULL unless CHI_OK
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null pointer), CHI_ERROR_OUT_OF_MEMORY
 */
CHI_API CHI_NODISCARD chi_status chi_spline_create(const chi_exec* exec, chi_spline** spline);
/** NULL is accepted. */
CHI_API void chi_spline_destroy(const chi_exec* exec, chi_spline* spline);

/**
 * One curve a line, within `tolerance` of every input point and without wiggles of its own.
 *
 * @param[in]     exec    host services, or NULL
 * @param[in,out] spline  handle; its former curves are gone, whatever the result
 * @param[in]     lines   [line_count] polylines of [points.count x 3] positions, length units; f32,
 * f64
 * @param[in]     params  borrowed for the call
 *
 * @retval CHI_OK                      every line has a curve or a reason; see chi_spline_get_stats
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, invalid view, id out of range, tolerance or
 *                                     merge_distance negative or not finite, unknown method
 * @retval CHI_ERROR_OUT_OF_MEMORY     about 48 bytes a point (polyline) or 130 (fit) were refused
 * @retval CHI_ERROR_TOO_LARGE         a size overflows
 * @retval CHI_ERROR_CANCELLED         the handle holds no curves
 *
 * Precision    double, relative to each line's first point; parameters are chord length over
 * length. Determinism  same bits for any number of threads and any parallel_for. Non-finite points
 * that are NaN or infinite are dropped and counted. Cost         O(points x rounds) a level of
 * halving; CHI_SPLINE_POLYLINE copies. Source       Schott et al. 2013, section 4.1; Lin, Bao &
 * Wang, "Totally positive bases and progressive iteration approximation", Computers & Mathematics
 * with Applications 50, 2005.
 */
CHI_API CHI_NODISCARD chi_status chi_spline_fit(const chi_exec* exec, chi_spline* spline,
  const chi_lines_view* lines, const chi_spline_params* params);

/** Number of lines of the last fit; 0 before the first and after a failed one. */
CHI_API size_t chi_spline_count(const chi_spline* spline);
/** The curve of a line, borrowed; all zero (count 0) where `line` is out of range. */
CHI_API void chi_spline_get_curve(const chi_spline* spline, size_t line, chi_spline_curve* curve);
/** What the last fit did; counts are zero before the first. */
CHI_API void chi_spline_get_stats(const chi_spline* spline, chi_spline_stats* stats);

/**
 * Position and derivatives with respect to u at one parameter: out[0] position minus origin,
 * out[1] first, out[2] second, out[3] third derivative; `order` in 0 ... 3 says how many.
 * Infallible; u is clamped to [0, 1]. At a knot of a degree-1 curve the segment to the right
 * counts.
 */
CHI_API void chi_spline_evaluate(
  const chi_spline_curve* curve, double u, int32_t order, double out[][3]);

#ifdef __cplusplus
}
#endif
#endif
