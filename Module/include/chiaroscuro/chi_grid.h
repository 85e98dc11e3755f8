/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_GRID_H
#define CHI_GRID_H

/*
 * One view of any mesh, and its consistent split into tetrahedra. Every polygonal face is cut into
 * a fan from one of its vertices, chosen by ids alone, so that both cells at a face cut it alike;
 * the cell is the cone of its faces from its own lowest vertex ("pulling"; Dompierre, Labbe, Vallet
 * & Camarero, "How to Subdivide Pyramids, Prisms and Hexahedra into Tetrahedra", 1999).
 */

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

enum
{
  CHI_GRID_UNSTRUCTURED = 0, /**< points, cell_types, offsets, connectivity (and faces) */
  CHI_GRID_IMAGE = 1,        /**< dimensions, index_to_world */
  CHI_GRID_RECTILINEAR = 2,  /**< dimensions, axes */
  CHI_GRID_CURVILINEAR = 3   /**< dimensions, points */
};

/** Bits of chi_grid_view.cell_ghosts, those of vtkDataSetAttributes. */
enum
{
  CHI_GRID_DUPLICATE_CELL = 1,
  CHI_GRID_HIDDEN_CELL = 32
};
enum
{
  CHI_GRID_HIDDEN_POINT = 2
};

/** A mesh, borrowed. Cell types and the order of a cell's points are VTK's; point and cell ids of
 * structured grids are VTK's too (x fastest). */
typedef struct chi_grid_view
{
  size_t struct_size;
  int32_t kind; /**< CHI_GRID_... */
  int32_t reserved;
  chi_vec3_view points;      /**< of unstructured and curvilinear grids; f32 or f64 */
  size_t dimensions[3];      /**< points along x, y, z of structured grids; any 0: an empty grid */
  double index_to_world[16]; /**< image: row-major, affine */
  chi_array_view axes[3];    /**< rectilinear: dimensions[i] coordinates each, any type */
  const uint8_t* cell_types; /**< [cell_count] VTK's numbers */
  const int64_t* offsets;    /**< [cell_count + 1] */
  const int64_t* connectivity;
  size_t cell_count;         /**< unstructured only */
  size_t connectivity_count; /**< values in connectivity */
  const int64_t* faces; /**< polyhedra: per cell the number of faces, then per face the number of
                             its points and these; NULL: no polyhedra */
  const int64_t* face_offsets; /**< [cell_count] where a polyhedron's part of `faces` begins, -1 for
                                    other cells */
  size_t faces_count;          /**< values in faces */
  const uint8_t* cell_ghosts;  /**< [cells] or NULL; cells with CHI_GRID_DUPLICATE_CELL or
                                    _HIDDEN_CELL are left out */
  const uint8_t* point_ghosts; /**< [points] or NULL; cells that touch a CHI_GRID_HIDDEN_POINT are
                                    left out */
  uint64_t version;            /**< differs whenever anything here does */
} chi_grid_view;

/** What a grid holds, and what of it is left out. Every cell is split or counted once. */
typedef struct chi_grid_counts
{
  size_t struct_size;
  size_t points;        /**< of the grid */
  size_t cells;         /**< of the grid */
  size_t tetrahedra;    /**< of its split */
  size_t extra_points;  /**< centres of cells that have no fan from a vertex: ids points, points + 1
                             ... in the order of their cells */
  size_t ghost_cells;   /**< duplicates */
  size_t blanked_cells; /**< hidden, or at a hidden point */
  size_t lower_dimensional_cells; /**< vertices, lines, faces, empty cells */
  size_t unsupported_cells;       /**< cells of types that are not split */
  size_t non_finite_cells; /**< a coordinate is NaN, infinite or beyond 1e100, where volumes leave
                              the range of double */
  size_t flat_cells;       /**< tetrahedra of zero volume: kept, and drawn as nothing */
  int64_t first_bad_cell; /**< where CHI_ERROR_INVALID_ARGUMENT is due to a cell: its id; else -1 */
  int64_t first_unsupported_type; /**< VTK's number; -1: none */
  double volume;                  /**< sum of |V| of the tetrahedra */
  double bounds[6];               /**< of the cells that are split; 1, -1 thrice where none is */
  size_t folded_cells; /**< split about their centres, where that too has tetrahedra that overlap */
  size_t collapsed_tetrahedra; /**< left out, because they name a point twice */
  size_t single_cells; /**< that are one tetrahedron each; if all are, tetrahedron i is cell i */
} chi_grid_counts;

/**
 * Look through a grid: what of it can be split, and how much room that takes.
 *
 * Split are the cells 10 ... 16 (tetrahedron, voxel, hexahedron, wedge, pyramid, pentagonal and
 * hexagonal prism), 24 ... 27, 29, 31, 32, 33, 37 (quadratic ones: every node is used) and 42
 * (polyhedron), and all cells of structured grids that have three dimensions.
 *
 * @param[in]  exec    host services, or NULL
 * @param[in]  grid    borrowed for the call
 * @param[out] counts  after an error only points, cells and first_bad_cell hold
 *
 * @retval CHI_OK
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, unknown kind, arrays that are too short; or,
 * with first_bad_cell, a cell that is broken: offsets that decrease or leave the connectivity, a
 * point id out of range, the wrong number of points for its type, a polyhedron's faces malformed
 * @retval CHI_ERROR_OUT_OF_MEMORY     scratch of 0.1 bytes a cell was refused
 * @retval CHI_ERROR_TOO_LARGE         points with the extra ones, or cells, exceed 2^32 - 2
 * @retval CHI_ERROR_CANCELLED
 *
 * Precision    volumes and orientations in double, from differences of coordinates.
 * Determinism  same bits for any number of threads and any parallel_for.
 * Non-finite   the cells are left out and counted.
 * Cost         O(cells); images and rectilinear grids are enumerated, not copied.
 */
CHI_API CHI_NODISCARD chi_status chi_grid_count(
  const chi_exec* exec, const chi_grid_view* grid, chi_grid_counts* counts);

/** Arrays of the caller; NULL members are not written, `vertices` apart. */
typedef struct chi_grid_tetrahedra
{
  size_t struct_size;
  uint32_t* vertices;    /**< [tetrahedra x 4] point ids; right-handed: (b-a).((c-a)x(d-a)) >= 0, as
                              computed in double without fused operations */
  uint32_t* cells;       /**< [tetrahedra] the cell that each is part of; ascending */
  double* points;        /**< [(points + extra_points) x 3] */
  uint32_t* extra_cells; /**< [extra_points] the cell whose centre (mean of its points) each is */
} chi_grid_tetrahedra;

/**
 * Split a grid. Two cells that share a face share its triangles, whatever their types. The cells of
 * an image are split alike, into six tetrahedra about the diagonal from their first to their last
 * point (Kuhn). A cell whose fan from its lowest vertex has tetrahedra of both orientations is
 * split about the mean of its points instead. Quadratic cells are split into linear ones first; all
 * their nodes are corners.
 *
 * @param[in]  exec        host services, or NULL
 * @param[in]  grid        the one that was counted
 * @param[in]  counts      what chi_grid_count said of it
 * @param[out] tetrahedra  the struct is read, its arrays are written
 *
 * @retval CHI_OK, CHI_ERROR_OUT_OF_MEMORY (scratch of 1.1 bytes a cell), CHI_ERROR_TOO_LARGE,
 * CHI_ERROR_CANCELLED
 * @retval CHI_ERROR_INVALID_ARGUMENT  as of chi_grid_count; the counts are not this grid's
 *
 * Determinism  same bits for any number of threads and any parallel_for; tetrahedra in the order of
 * their cells.
 * Source       Dompierre, Labbe, Vallet & Camarero 1999; Kuhn, "Some combinatorial lemmas in
 * topology", 1960.
 */
CHI_API CHI_NODISCARD chi_status chi_grid_split(const chi_exec* exec, const chi_grid_view* grid,
  const chi_grid_counts* counts, const chi_grid_tetrahedra* tetrahedra);

/**
 * One scalar of every tuple of an array, and of the extra points the mean of their cells' points.
 *
 * @param[in]  grid         read where extra_count > 0 only
 * @param[in]  values       a tuple a point where extra_count > 0, else of anything
 * @param[in]  component    0 ... components - 1, or -1: magnitude
 * @param[in]  extra_cells  [extra_count] as chi_grid_split wrote them, or NULL
 * @param[out] scalars      [values.count + extra_count]
 *
 * @retval CHI_OK, CHI_ERROR_CANCELLED
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, component out of range, values that are not one
 * a point, an extra cell that the grid lacks or that is broken
 *
 * Precision    double, rounded to float at the end.
 * Non-finite   propagates.
 */
CHI_API CHI_NODISCARD chi_status chi_grid_scalars(const chi_exec* exec, const chi_grid_view* grid,
  const chi_array_view* values, int32_t component, const uint32_t* extra_cells, size_t extra_count,
  float* scalars);

#ifdef __cplusplus
}
#endif
#endif
