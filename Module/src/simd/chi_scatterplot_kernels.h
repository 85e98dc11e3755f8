/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_KERNELS_H
#define CHI_SCATTERPLOT_KERNELS_H

/*
 * The inner loops of continuous scatterplots, once per instruction set; chosen at load. AVX2 and
 * AVX-512 fuse where the code says so; sets of instructions may differ by a rounding, threads not.
 *
 * Values are in units of bins: x along a row of the plot, y across rows, both rounded to a grid so
 * coarse that differences within the plot are exact.
 */

#include <stddef.h>
#include <stdint.h>

/* How a tetrahedron is deposited. */
enum
{
  CHI_SCATTER_NOTHING = 0,
  CHI_SCATTER_EDGES,   /* well-conditioned and inside the plot: by its six edges */
  CHI_SCATTER_ONE_BIN, /* wholly inside one bin */
  CHI_SCATTER_SECTIONS /* anything else: by its parts below lines */
};

enum
{
  CHI_SCATTER_BRICK = 8,                   /* cells along a brick's edge */
  CHI_SCATTER_ROW = CHI_SCATTER_BRICK + 2, /* doubles from one row of its points to the next */
  CHI_SCATTER_LAYER = CHI_SCATTER_ROW * (CHI_SCATTER_BRICK + 1),
  CHI_SCATTER_POINTS = CHI_SCATTER_LAYER * (CHI_SCATTER_BRICK + 1),
  CHI_SCATTER_PADDED = CHI_SCATTER_POINTS + 16, /* vectors read beyond the last point */
  CHI_SCATTER_CELLS = CHI_SCATTER_BRICK * CHI_SCATTER_BRICK * CHI_SCATTER_BRICK,
  CHI_SCATTER_CHUNK = 64 /* tetrahedra of a list that are classified at a time */
};

/* Corners of the six tetrahedra of a lattice's cell behind the first: each steps along these axes
 * in turn. */
static const unsigned char chi_scatter_steps[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
  { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
static const unsigned char chi_scatter_ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 },
  { 1, 3 }, { 2, 3 } };

/* What all deposits of a plot share. */
typedef struct chi_scatter_plot
{
  int32_t bins[2];
  double low[2], scale[2]; /* x = (value - low) scale, rounded by adding and subtracting snap */
  double snap;
  double unit;      /* integers per unit of mass */
  double condition; /* K: the product of a tetrahedron's two least areas must reach L^2 max(L, 1) /
                       K for its edges to be used */
  int32_t no_edges, no_one_bin; /* switches for tests */
} chi_scatter_plot;

/* In bins: what lies there is beyond the plot, and its ratios are finite. */
#define CHI_SCATTER_FAR 0x1p200

/* An edge that carries the second derivative of a density: `weight` times its |y_k - y_l| per unit
 * of y. */
typedef struct chi_scatter_edge
{
  uint32_t from, to; /* indices of its ends in the arrays of values */
  double weight;
} chi_scatter_edge;

/* Rows first ... first + count - 1 of second differences; column 0 of each is column `left` of the
 * plot. */
typedef struct chi_scatter_tile
{
  double* at; /* aligned to 64 bytes */
  size_t stride;
  int32_t first, count, left, width;
} chi_scatter_tile;

/* A brick of cells of a lattice, and what becomes of their tetrahedra. */
typedef struct chi_scatter_brick
{
  int32_t cells[3];
  double x[CHI_SCATTER_PADDED], y[CHI_SCATTER_PADDED];
  double mass[CHI_SCATTER_CELLS + 8]; /* of each tetrahedron of a cell; NaN: the cell is left out */
  double weight[8][CHI_SCATTER_PADDED]; /* of the edge from a point along the axes that bits name */
  uint16_t one_bin[6 * CHI_SCATTER_CELLS], sections[6 * CHI_SCATTER_CELLS]; /* 6 cell + kind */
  size_t one_bin_count, sections_count;
  size_t edge_cells;
  double edge_mass; /* of all that go by edges */
} chi_scatter_brick;

/* Where deposits go: bins in integers, so that their sums do not depend on the order; the masses of
 * one piece of the mesh beside them. */
typedef struct chi_scatter_sink
{
  int64_t* bins;
  int64_t deposited;      /* sum of what went to bins */
  double inside, outside; /* mass within the plot, and beyond */
  double singular;        /* of simplices without area that touch the plot */
  double* scratch;        /* [bins + 32] where bins is the larger number */
} chi_scatter_sink;

typedef struct chi_scatter_kernels
{
  /* Sort a brick's tetrahedra by how they are deposited, and add up the weights of edges. Those of
   * less than `light` go by sections. */
  void (*brick)(const chi_scatter_plot* plot, chi_scatter_brick* brick, double light);
  /* The same of `count` <= CHI_SCATTER_CHUNK tetrahedra whose corner c is at x[c * stride + i]. */
  void (*classify)(const chi_scatter_plot* plot, const double* x, const double* y, size_t stride,
    const double* mass, size_t count, double light, double (*weight)[CHI_SCATTER_CHUNK],
    uint8_t* kind);
  /* Second differences of edges, as far as they cross the tile's rows. */
  void (*edges)(const chi_scatter_tile* tile, const double* x, const double* y,
    const chi_scatter_edge* edges, size_t count);
  /* Sum the tile twice along its rows into integers that are added to the bins, and clear it.
   * Masses of absolute value `clean` and less are left out; the sum of the others returns. */
  int64_t (*flush)(
    const chi_scatter_plot* plot, const chi_scatter_tile* tile, double clean, int64_t* bins);
  /* Values of a field into units of bins, in place; of fewer than 8 more too. */
  void (*map)(const chi_scatter_plot* plot, int axis, double* values, size_t count);
  /* The least and the largest value; 0 where one is not finite. */
  int (*extremes)(const double* values, size_t count, double* low, double* high);
  /* Deposit a triangle (3 corners) or a tetrahedron (4) of any shape. */
  void (*sections)(const chi_scatter_plot* plot, chi_scatter_sink* sink, int corners,
    const double* x, const double* y, double mass);
  /* Cells of a brick that span `size` bins or less along both axes, and that a line between bins of
   * one axis crosses: bits of each row of cells. */
  void (*straddling)(
    const chi_scatter_plot* plot, const chi_scatter_brick* brick, double size, uint8_t* rows);
} chi_scatter_kernels;

extern const chi_scatter_kernels chi_scatter_kernels_generic;
#if defined(__x86_64__)
extern const chi_scatter_kernels chi_scatter_kernels_avx2;
extern const chi_scatter_kernels chi_scatter_kernels_avx512;
#endif

/* Those of this machine. */
const chi_scatter_kernels* chi_scatter_get_kernels(void);

#endif
