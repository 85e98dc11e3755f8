/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_H
#define CHI_SCATTERPLOT_H

/*
 * Continuous scatterplots: how much of a mesh's volume has which pair of values of two fields
 * (Bachthaler & Weiskopf, "Continuous Scatterplots", 2008). Fields of points are linear in each
 * tetrahedron, and every bin of the plot is integrated exactly, not sampled; fields of cells are
 * constant in each. Mass is volume times weight: what the plot holds, what falls beyond it and what
 * is left out add up.
 */

#include "chi_grid.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_SCATTERPLOT_EXACT = 0,    /**< averages over bins */
  CHI_SCATTERPLOT_PUBLISHED = 1 /**< Bachthaler & Weiskopf's triangles, read at centres of bins: for
                                     comparison. Mass is not conserved, degenerate cells are lost */
};

/** What values belong to. */
enum
{
  CHI_SCATTERPLOT_POINTS = 0,
  CHI_SCATTERPLOT_CELLS = 1
};

/** Bits of chi_scatterplot_params.switches: what is not done, for comparison. */
enum
{
  CHI_SCATTERPLOT_NO_EDGES = 1,    /**< every cell by its sections: slow, for ill conditions */
  CHI_SCATTERPLOT_NO_ONE_BIN = 2,  /**< no short way for cells inside one bin */
  CHI_SCATTERPLOT_NO_SKIP = 4,     /**< no short way for parts of the mesh that miss the plot,
                                        or lie in one bin */
  CHI_SCATTERPLOT_NO_SORT = 8,     /**< lists of cells in their own order */
  CHI_SCATTERPLOT_ALWAYS_SORT = 16 /**< lists of cells in an order of space */
};

/** A mesh with two fields on it, borrowed for the call. */
typedef struct chi_scatterplot_input
{
  size_t struct_size;
  const chi_grid_view* grid;
  chi_array_view fields[2];
  int32_t components[2]; /**< 0 ... components - 1, or -1: magnitude */
  int32_t association;   /**< of both fields */
  int32_t weight_association;
  chi_array_view weight; /**< mass per volume; no data: 1. Of points: the mean of a cell's points
                              counts for all of the cell */
  int32_t weight_component;
  int32_t reserved;
  int64_t first_index[3]; /**< place of a structured grid's first point in the whole that it is a
                               piece of; bricks are fixed there */
  int64_t first_cell;     /**< the same of a list's first cell */
  uint64_t version; /**< of all values; differs whenever they do. 0: nothing is kept of them */
} chi_scatterplot_input;

/** Sums and maxima over all processes that hold a piece each; return 0, or else the call fails with
 * CHI_ERROR_CANCELLED. All processes make the same calls in the same order, failures included. */
typedef struct chi_scatterplot_reduction
{
  size_t struct_size;
  void* user;
  int (*max_f64)(void* user, double* values, size_t count); /**< in place */
  int (*sum_i64)(void* user, int64_t* values, size_t count);
} chi_scatterplot_reduction;

typedef struct chi_scatterplot_params
{
  size_t struct_size;
  size_t bins[2];          /**< 1 ... 32768 each, and 2^28 together */
  double range[2][2];      /**< of each field: lower end, upper end */
  int32_t automatic_range; /**< not 0: `range` is not read, and all values are shown. A constant c
                                gets max(|c|, 1) 1e-6 around it */
  int32_t method;          /**< CHI_SCATTERPLOT_EXACT, _PUBLISHED */
  uint32_t switches;       /**< CHI_SCATTERPLOT_NO_... */
  uint32_t reserved;
  const chi_scatterplot_reduction* reduction; /**< NULL: this process has all */
  double trilinear_tolerance; /**< of image and rectilinear cells, hexahedra and voxels with fields
                                   of points, in units of each field's range in the plot: they are
                                   subdivided until mass lies on average no further than this from
                                   where the trilinear interpolant has it. 0: all are split into
                                   tetrahedra as they are */
  int32_t trilinear_levels;   /**< most halvings of a cell's edges, 1 ... 6; 0: 4 */
  int32_t reserved2;
  double splat_size; /**< 0 ... 1: cells of lattices, and tetrahedra of lists, whose values span
                          this part of a bin or less along both fields and lie on one line between
                        bins are deposited by their mean, not exactly; 0: none */
} chi_scatterplot_params;

/** What became of the mesh. Masses and ranges are of all processes, counts of this one. */
typedef struct chi_scatterplot_result
{
  size_t struct_size;
  double range[2][2];       /**< of the plot */
  double total_mass;        /**< of all cells that are not left out */
  double mass_out_of_range; /**< its part beyond the plot */
  double singular_mass;     /**< its part in simplices that touch the plot and whose image has no
                                 area; deposited as others */
  int32_t dimension;        /**< of the cells that count: 3, 2, or 0 where there are none */
  int32_t constant_fields;  /**< bit i: field i is constant, and its automatic range a window */
  size_t cells;             /**< that count */
  size_t simplices;         /**< tetrahedra or triangles that they are split into */
  size_t skipped_cells;     /**< a value, a weight or a coordinate is not finite */
  size_t ghost_cells, blanked_cells;
  size_t lower_dimensional_cells, unsupported_cells;
  size_t edge_simplices, one_bin_simplices, section_simplices; /**< by the way they went */
  size_t pieces, missing_pieces, one_bin_pieces; /**< bricks of structured grids or runs of lists;
                                                      those that miss the plot or lie in one bin */
  int32_t is_sorted; /**< a list of cells was put in an order of space */
  int32_t is_kept;   /**< ranges and masses of pieces are those of the last call */
  size_t subdivided_cells; /**< trilinear ones; `simplices` counts the tetrahedra of their parts */
  size_t capped_cells;     /**< of them those that would take more than `trilinear_levels` */
  size_t splats;           /**< cells that were deposited by their mean */
  double splat_bound;      /**< the sum of what bins' masses are off by these is at most this */
  size_t folded_cells;     /**< hexahedra whose map may fold: split as without a tolerance */
} chi_scatterplot_result;

/** What is kept from one plot of a mesh to the next. */
typedef struct chi_scatterplot chi_scatterplot;

/**
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer
 * @retval CHI_ERROR_OUT_OF_MEMORY     *plot is NULL
 */
CHI_API CHI_NODISCARD chi_status chi_scatterplot_create(
  const chi_exec* exec, chi_scatterplot** plot);

/** Give back all memory, to the host that the plot was created with. NULL is accepted. */
CHI_API void chi_scatterplot_destroy(chi_scatterplot* plot);

/**
 * Mass per area of the plot.
 *
 * @param[in]  exec     host services, or NULL; scratch comes from the plot's own host
 * @param[in]  plot     one call at a time
 * @param[in]  input    grids of three dimensions are split as chi_grid_split does; where there is
 * no cell of three dimensions, polygons count by their area
 * @param[in]  params   what is plotted
 * @param[out] density  [bins[1]][bins[0]] mean mass per area of each bin, in units of the fields,
 * infinite where that is beyond double;
 * unspecified after an error. The bin's lower ends belong to it, and to the last the upper one too
 * @param[out] result   may be NULL
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, views that are invalid or not one value a point
 * or a cell, components out of range, no bins or ranges that are not lower end < upper end, finite;
 * a grid that chi_grid_count would not accept
 * @retval CHI_ERROR_OUT_OF_MEMORY, CHI_ERROR_CANCELLED
 * @retval CHI_ERROR_TOO_LARGE  more bins, points or cells than stated
 *
 * Trilinear    with a tolerance the mass of hexahedra and voxels is the volume of the trilinear map
 * (integral of its determinant, also where they need no subdivision), and of image and rectilinear
 * cells their volume, as without. A part's mass is the exact integral over it, spread evenly over
 * its six tetrahedra. Halving edges L times divides the error by 4^L; cells that miss the plot or
 * lie in one bin are not subdivided.
 * Precision    each bin to 1e-10 of the largest; total_mass = sum of the bins + mass_out_of_range
 * to 1e-12, at any scale of the fields. Values are rounded to 2^-51 of the range. Simplices whose
 * image is thin or has no area go a way that does not divide by it.
 * Determinism  same bits for any number of threads and any parallel_for on one set of instructions.
 * Pieces of a whole have the bits of the whole where they are unions of its bricks of 8^3 cells, or
 * of runs of 2048 cells of lists that are not sorted.
 * Non-finite   cells with such values are left out and counted.
 * Cost         O(simplices + bins that their edges cross). Images and rectilinear grids are
 * enumerated in bricks, never copied; lists take 8 bytes a cell, or sorted 16 and while that is done
 * 2 a point; 8 bytes a bin and thread.
 * Source       Bachthaler & Weiskopf 2008; density of a simplex: Micchelli, "A constructive approach
 * to Kergin interpolation", 1980.
 */
CHI_API CHI_NODISCARD chi_status chi_scatterplot_compute(const chi_exec* exec,
  chi_scatterplot* plot, const chi_scatterplot_input* input, const chi_scatterplot_params* params,
  double* density, chi_scatterplot_result* result);

/** How densities become colours. */
typedef struct chi_scatterplot_display_params
{
  size_t struct_size;
  int32_t is_linear; /**< 0: by the logarithm */
  int32_t reserved;
  double decades; /**< of a logarithmic scale, below the largest density; 0: 4 */
} chi_scatterplot_display_params;

/**
 * A picture of densities: black, red, yellow, white, from nothing (or `decades` below the largest)
 * to the largest. Bins that hold nothing are transparent.
 *
 * @param[in]  density  [count] as chi_scatterplot_compute wrote them
 * @param[in]  params   NULL: the defaults
 * @param[out] rgba     [count][4] not premultiplied
 *
 * @retval CHI_OK, CHI_ERROR_CANCELLED
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, decades that are negative or not finite
 *
 * Non-finite   as nothing.
 */
CHI_API CHI_NODISCARD chi_status chi_scatterplot_display(const chi_exec* exec,
  const double* density, size_t count, const chi_scatterplot_display_params* params, uint8_t* rgba);

#ifdef __cplusplus
}
#endif
#endif
