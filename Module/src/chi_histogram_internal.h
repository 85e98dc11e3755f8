/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_HISTOGRAM_INTERNAL_H
#define CHI_HISTOGRAM_INTERNAL_H

#include <chiaroscuro/chi_histogram.h>

#include "chi_buffer.h"
#include "chi_grid_internal.h"
#include "chi_scatterplot_internal.h" /* values of fields */
#include "simd/chi_histogram_kernels.h"

enum
{
  CHI_HISTOGRAM_BRICK = 8,  /* cells along each axis of a piece of a lattice */
  CHI_HISTOGRAM_RUN = 512,  /* cells of a piece of a list */
  CHI_HISTOGRAM_GROUPS = 64 /* most groups of pieces; each has bins of its own */
};

#define CHI_HISTOGRAM_LARGEST 1e100 /* of a value or a coordinate */

/* Simplices, or cells of constant value, side by side. */
typedef struct chi_histogram_block
{
  size_t count, capacity;
  double* value[4];            /* at the corners */
  double *mass, *area;         /* volume; integral of |grad f| */
  chi_buffer memory, vertices; /* vertices: room for the split of one cell */
} chi_histogram_block;

/* What is known of a piece of the mesh: enough to leave it out of a pass. */
typedef struct chi_histogram_piece
{
  double low, high; /* of the field; low > high: there is nothing */
  double mass, area, singular;
  double center, half; /* moments are of (f - center) / half */
  double moment[CHI_HISTOGRAM_MOMENTS + 1];
  uint32_t cells, simplices, skipped, ghosts, blanked, lower_dimensional, unsupported;
  int64_t bad; /* a cell that is broken, or -1 */
} chi_histogram_piece;

/* How a mesh and its field are read. */
typedef struct chi_histogram_plan
{
  chi_grid grid;
  chi_array_view field;
  int32_t component, association, moments, no_skipping;
  int dimension;    /* of the cells that count; 0: none do */
  int corners;      /* of what is deposited: 4, 3, or 1 of cells of constant value */
  int is_lattice;   /* bricks of an image or a rectilinear grid */
  size_t bricks[3]; /* along each axis */
  double cofactor[3][3], volume, cofactor_size; /* of an image's cell: the columns are normals of
                         its sides, as long as their areas, divided by cofactor_size */
  uint16_t most[256]; /* simplices of a cell by its type; 0: to be counted */
  size_t pieces;
  chi_histogram_reduction reduction; /* functions NULL: none */
} chi_histogram_plan;

struct chi_histogram
{
  chi_histogram_plan plan;
  uint64_t grid_version, field_version; /* that the pieces belong to; 0: none */
  int is_ready;                         /* there is a result, and pieces */
  chi_histogram_result result;
  chi_buffer piece_buffer, group_buffer, bin_buffer, coarse_buffer;
  int has_coarse; /* coarse_buffer has the bins of the whole range */
};

static inline chi_histogram_piece* chi_histogram_pieces(const chi_histogram* h)
{
  return (chi_histogram_piece*)h->piece_buffer.data;
}

/* A sum that keeps what additions round off (Neumaier 1974, without its branch: Knuth's TwoSum). */
typedef struct chi_sum
{
  double high, low;
} chi_sum;

static inline void chi_sum_add(chi_sum* sum, double x)
{
  const double s = sum->high + x, part = s - sum->high;
  sum->low += (sum->high - (s - part)) + (x - part);
  sum->high = s;
}

static inline double chi_sum_value(const chi_sum* sum)
{
  return sum->high + sum->low;
}

/* ---- the mesh (chi_histogram_block.c) */

/* One value of the field. */
static inline double chi_histogram_value(const chi_histogram_plan* plan, size_t tuple)
{
  return chi_scatter_value(&plan->field, plan->component, tuple);
}
/* The pieces that the mesh is read in; grid, field, component and association are set. */
void chi_histogram_make_plan(chi_histogram_plan* plan);
/* All simplices of a piece; with `piece` cells are counted and the rest of it is untouched. */
chi_status chi_histogram_fill(const chi_exec* exec, const chi_histogram_plan* plan, size_t index,
  chi_histogram_block* block, chi_histogram_piece* piece);
/* Room for `count` simplices in an empty block; 0: refused. */
int chi_histogram_reserve(const chi_exec* exec, chi_histogram_block* block, size_t count);
void chi_histogram_free_block(const chi_exec* exec, chi_histogram_block* block);

/* A piece of a lattice, in rows (chi_histogram_lattice.c); there is room. */
void chi_histogram_fill_brick(const chi_histogram_plan* plan, size_t index,
  chi_histogram_block* block, chi_histogram_piece* piece);
/* Whether an image or a rectilinear grid can be read in bricks, and what that takes. */
int chi_histogram_plan_lattice(chi_histogram_plan* plan);

/* Cells of two dimensions (chi_histogram_polygon.c). */
/* Append a cell's triangles, or with a field of cells its area; CHI_CELL_... */
int chi_histogram_add_polygon(
  const chi_histogram_plan* plan, size_t index, chi_histogram_block* block);

/* Append a simplex of two or three dimensions. */
void chi_histogram_add_triangle(
  chi_histogram_block* block, double x[3][3], const double value[3], double sign);

/* ---- passes over the mesh */

/* Every piece's range, mass and moments (chi_histogram_measure.c). */
chi_status chi_histogram_measure(const chi_exec* exec, chi_histogram* histogram);
/* Totals, mean and moments of all pieces, into the result. */
chi_status chi_histogram_add_up(chi_histogram* histogram);

/* ---- all processes together (chi_histogram_reduce.c); without others as things are */

/* The worst status, and maxima of up to three values. */
chi_status chi_histogram_agree(
  const chi_histogram_plan* plan, chi_status status, double* values, size_t count);
/* Sums, to 2^-80 of the largest. */
chi_status chi_histogram_sum(const chi_histogram_plan* plan, double* values, size_t count);

/* A window over low ... high with `bins` bins; 0 where there can be none. */
int chi_histogram_open_window(chi_histogram_window* window, double low, double high, size_t bins);
/* Masses of all slots, then areas (chi_histogram_bins.c), in histogram->bin_buffer; `skipped`
 * counts pieces by kind. */
chi_status chi_histogram_fill_window(const chi_exec* exec, chi_histogram* histogram,
  const chi_histogram_window* window, int64_t skipped[CHI_HISTOGRAM_SKIP_KINDS]);

#endif
