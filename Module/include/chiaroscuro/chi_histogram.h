/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_HISTOGRAM_H
#define CHI_HISTOGRAM_H

/*
 * Continuous histograms: how much of a mesh's volume has which value of a field. A field of points
 * is linear in each tetrahedron, so that the density of its values is a quadratic B-spline with the
 * four corners' values as knots; every bin is the integral of these, not a count of samples. A
 * field of cells is constant in each. Mass is volume; where there are no cells of three dimensions
 * it is area, of polygons.
 *
 * Source: Carr, Duffy & Denby, "On Histograms and Isosurface Statistics", 2006; Scheidegger,
 * Schreiner, Duffy, Carr & Silva, "Revisiting Histograms and Isosurface Statistics", 2008; Curry &
 * Schoenberg, "On Polya Frequency Functions IV: The Fundamental Spline Functions and their Limits",
 * 1966.
 */

#include "chi_grid.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** What a mesh and its field were found to hold, kept from one histogram to the next. */
typedef struct chi_histogram chi_histogram;

/** What values belong to. */
enum
{
  CHI_HISTOGRAM_POINTS = 0,
  CHI_HISTOGRAM_CELLS = 1
};

/** Bits of chi_histogram_params.no_skipping, and where chi_histogram_result.skipped counts. */
enum
{
  CHI_HISTOGRAM_SKIP_OUTSIDE = 1,   /**< pieces of the mesh that miss the range: one sum */
  CHI_HISTOGRAM_SKIP_ONE_BIN = 2,   /**< pieces within one bin, constant ones: one sum */
  CHI_HISTOGRAM_SKIP_UNCHANGED = 4, /**< ranges, masses and moments of pieces that have not changed
                                     */
  CHI_HISTOGRAM_SKIP_KINDS = 3
};

enum
{
  CHI_HISTOGRAM_MOMENTS = 8 /**< highest order */
};

/** Sums and maxima over all processes that hold a piece each; return 0, or else the call fails with
 * CHI_ERROR_CANCELLED. All processes make the same calls in the same order, failures included. */
typedef struct chi_histogram_reduction
{
  size_t struct_size;
  void* user; /**< must live until the last chi_histogram_quantile */
  int (*max_f64)(void* user, double* values, size_t count); /**< in place */
  int (*sum_i64)(void* user, int64_t* values, size_t count);
} chi_histogram_reduction;

typedef struct chi_histogram_params
{
  size_t struct_size;
  const chi_array_view* field; /**< a tuple a point or a cell */
  int32_t component;           /**< 0 ... components - 1, or -1: magnitude */
  int32_t association;         /**< CHI_HISTOGRAM_POINTS, _CELLS */
  uint64_t field_version;      /**< differs whenever a value does; 0: never the same */
  size_t bins;                 /**< 1 ... 2^20 */
  double range[2];             /**< lower end < upper end */
  int32_t automatic_range; /**< not 0: `range` is not read, all values are in. A constant c gets a
                                window of max(|c|, 1) 1e-6 around it */
  int32_t moments;         /**< highest order that is found, 2 ... 8; 0: 4 */
  int32_t no_skipping;     /**< CHI_HISTOGRAM_SKIP_... that are switched off */
  int32_t reserved;
  const chi_histogram_reduction* reduction; /**< NULL: this process has all. Else masses, ranges,
                              moments and quantiles are of the whole, counts of this piece, and a
                              piece without cells takes part */
} chi_histogram_params;

/** Caller-allocated, [bins] each; NULL members are not written. */
typedef struct chi_histogram_outputs
{
  size_t struct_size;
  double* centers;
  double* mass; /**< in each bin; its lower end belongs to it, and to the last the upper one too */
  double* density; /**< mean over the bin of the integral of dA / |grad f| over isosurfaces: mass by
                        width */
  double* iso_area;   /**< mean over the bin of the isosurfaces' area: integral of |grad f| dV by
                           width (coarea formula) */
  double* cumulative; /**< mass up to each bin's upper end, with what lies below the range */
} chi_histogram_outputs;

/** What became of the mesh. Moments are of the whole distribution, in the range or not. */
typedef struct chi_histogram_result
{
  size_t struct_size;
  double range[2];               /**< of the bins */
  double field_range[2];         /**< of the field; 1, -1 where there is no cell */
  double total_mass;             /**< of all cells that are not left out */
  double mass_below, mass_above; /**< its parts beyond the range */
  double singular_mass; /**< its part in simplices, or cells, where the field is constant; it is in
                             the bins as other mass */
  double total_area;    /**< integral of |grad f| */
  double mean;          /**< NaN where there is no mass, as the moments */
  double central_moments[CHI_HISTOGRAM_MOMENTS + 1]; /**< mean of (f - mean)^k: [0] is 1, [1] is 0,
                             [2] the variance; 0 beyond the highest that was asked for */
  int32_t moments;                                   /**< that are found */
  int32_t dimension;   /**< of the cells that count: 3, 2, or 0 where there are none */
  int32_t is_constant; /**< the range is the window about a constant */
  int32_t reserved;
  size_t cells;     /**< that count */
  size_t simplices; /**< tetrahedra or triangles that they are split into; cells, of their fields */
  size_t skipped_cells; /**< a value or a coordinate is NaN, infinite or beyond 1e100 */
  size_t ghost_cells, blanked_cells;
  size_t lower_dimensional_cells, unsupported_cells;
  size_t pieces; /**< bricks of 8^3 cells of images and rectilinear grids, else runs of 512 cells */
  int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS]; /**< [k] belongs to the flag 1 << k */
  int64_t first_bad_cell; /**< where CHI_ERROR_INVALID_ARGUMENT is due to a cell: its id; else -1 */
} chi_histogram_result;

/** @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null), CHI_ERROR_OUT_OF_MEMORY */
CHI_API CHI_NODISCARD chi_status chi_histogram_create(
  const chi_exec* exec, chi_histogram** histogram);
/** NULL is accepted. */
CHI_API void chi_histogram_destroy(const chi_exec* exec, chi_histogram* histogram);

/**
 * The histogram of a field on a mesh.
 *
 * @param[in]     exec       host services, or NULL; alloc and release are called from its threads
 * @param[in,out] histogram  keeps ranges, masses and moments of pieces of the mesh by grid->version
 * and params->field_version
 * @param[in]     grid       split as chi_grid_split does; where there is no cell of three
 * dimensions, polygons and structured grids of two count by their area. Its arrays and the field's
 * values are borrowed until the last chi_histogram_quantile
 * @param[in]     params     read in this call
 * @param[out]    outputs    NULL: none
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, a field that is not a tuple a point or cell,
 * component or order out of range, no bins, a range that is not lower end < upper end, finite, or
 * so small that bins by its width overflow; or a broken cell: first_bad_cell of the result
 * @retval CHI_ERROR_OUT_OF_MEMORY     180 bytes a piece, 32 a bin for 8 to 64 groups of pieces, and
 * a thread's 48 bytes a simplex of a piece
 * @retval CHI_ERROR_TOO_LARGE         more than 2^20 bins, more than 2^32 - 2 points
 * @retval CHI_ERROR_CANCELLED         after this and other errors outputs are unspecified
 *
 * Precision    values in the range are rounded to 2^-51 of the smallest power of two of bins that
 * is not below `bins`; beside this each simplex's part in each bin is right to some 1e-15 of
 * itself, however many bins it spans. The bins and the masses beyond the range add up to total_mass
 * within 1e-12 of it, at any scale of the field. Values beyond 2^200 widths of a bin are taken as
 * there.
 * Determinism  same bits for any number of threads and any parallel_for on one set of instructions.
 * Processes get the same bits; those of one process that has all differ by rounding, 1e-15.
 * Non-finite   cells with such values are left out and counted.
 * Cost         O(simplices + bins that each spans); pieces that miss the range or lie in one bin
 * are one deposit.
 * Source       Curry & Schoenberg 1966 (a simplex' density is a B-spline); coarea formula as in
 * Scheidegger et al. 2008.
 */
CHI_API CHI_NODISCARD chi_status chi_histogram_compute(const chi_exec* exec,
  chi_histogram* histogram, const chi_grid_view* grid, const chi_histogram_params* params,
  const chi_histogram_outputs* outputs);
/** Of the last chi_histogram_compute. */
CHI_API void chi_histogram_get_result(const chi_histogram* histogram, chi_histogram_result* result);

/**
 * Mean of f^order over the mesh.
 *
 * @param[in]  order   0 ... the highest that was found
 * @param[out] moment  NaN where there is no mass
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null, order), CHI_ERROR_NOT_READY (no histogram)
 *
 * Precision    3^order 1e-15 of the largest |f|^order; exact for the piecewise linear field but for
 * rounding (complete homogeneous polynomials of the corners' values; nothing comes from bins).
 */
CHI_API CHI_NODISCARD chi_status chi_histogram_moment(
  const chi_histogram* histogram, int32_t order, double* moment);

/**
 * The value below which a share of the mass lies: the least such value, where the distribution
 * jumps the place of the jump; 0 gives the least value of the field, 1 the largest. With a
 * reduction all processes call it alike.
 *
 * @param[in]  share     0 ... 1
 * @param[out] quantile  to 1e-12 of the field's range, as far as double distinguishes values there,
 * of the share to 1e-14
 *
 * @retval CHI_OK, CHI_ERROR_INVALID_ARGUMENT (null, share), CHI_ERROR_NOT_READY (no histogram),
 * CHI_ERROR_OUT_OF_MEMORY, CHI_ERROR_CANCELLED
 * @retval CHI_ERROR_EMPTY  there is no mass
 *
 * Cost         a histogram of 1024 bins over all (kept while the mesh and the field are), and seven
 * of 32 over the pieces that meet a bin of the one before.
 */
CHI_API CHI_NODISCARD chi_status chi_histogram_quantile(
  const chi_exec* exec, chi_histogram* histogram, double share, double* quantile);

#ifdef __cplusplus
}
#endif
#endif
