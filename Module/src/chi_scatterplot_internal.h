/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SCATTERPLOT_INTERNAL_H
#define CHI_SCATTERPLOT_INTERNAL_H

#include <chiaroscuro/chi_scatterplot.h>

#include "chi_buffer.h"
#include "chi_grid_internal.h"
#include "simd/chi_scatterplot_kernels.h"

#include <math.h>
#include <stdatomic.h>

enum
{
  CHI_SCATTER_RUN = 2048,    /* cells of a list that are one piece */
  CHI_SCATTER_WORKERS = 256, /* most threads at a time; more wait */
  CHI_SCATTER_MASS_BITS = 61 /* of all mass together: sums of integers do not overflow */
};

/* What a piece of the mesh holds: read once, and enough to skip it. */
typedef struct chi_scatter_piece
{
  double low[2], high[2]; /* of the fields; low > high: there is nothing */
  double mass, size;      /* signed, and absolute */
  uint32_t cells, simplices, skipped, ghosts, blanked, lower_dimensional, unsupported;
  int32_t is_clean; /* no cell has to be looked at before it is deposited */
} chi_scatter_piece;

/* Simplices of a list, corner by corner, with the values there. Ids from the number of the grid's
 * points on are centres of cells. */
typedef struct chi_scatter_block
{
  size_t count, capacity;
  uint32_t* ids;       /* [4][capacity] */
  uint32_t* cell;      /* [capacity] each one's; those of a cell follow each other */
  double* mass;        /* [capacity + 8] NaN: left out */
  double *x, *y;       /* [4][capacity], and 8 more */
  uint32_t (*ends)[2]; /* [6 capacity] of edges, as places in the arrays of values */
  size_t centers;
  struct chi_scatter_center* center; /* [capacity] */
} chi_scatter_block;

typedef struct chi_scatter_center
{
  double point[3], value[2];
} chi_scatter_center;

/* One thread's memory. */
typedef struct chi_scatter_worker
{
  int is_busy, is_equipped;
  chi_scatter_sink sink;
  int64_t mass;                 /* within the plot, in its unit */
  int64_t out, singular, bound; /* in units of the whole; bound: of what splats are off by */
  double sink_error;            /* of a piece */
  size_t splats;
  size_t edges, one_bin, sections, missing_pieces, one_bin_pieces;
  size_t subdivided, capped, folded, more_simplices; /* of trilinear cells */
  double* tile;                                      /* zero between pieces */
  chi_scatter_brick *brick, *fine;                   /* fine: parts of cells of a brick */
  chi_scatter_edge* edge;
  chi_scatter_block block;
  uint32_t* slots; /* of a table of edges: 1 + place in `edge` */
  size_t slot_mask;
  chi_buffer bins, scratch, tile_block, brick_block, fine_block, edge_block, list_block;
  chi_buffer slot_block;
} chi_scatter_worker;

struct chi_scatterplot
{
  chi_exec exec;
  int has_exec;
  chi_buffer pieces, order, masses;
  size_t piece_count;
  uint64_t grid_version, version, order_version;
  int order_has_corners; /* chi_scatter_job.corners, not .order */
  int32_t kept_of[13];   /* what else the pieces depend on */
  chi_scatter_worker* workers[CHI_SCATTER_WORKERS];
  size_t worker_count;
};

typedef struct chi_scatter_job
{
  const chi_exec* exec;
  chi_scatterplot* keep;
  chi_scatterplot_input input;
  chi_scatterplot_params params;
  chi_scatterplot_reduction reduction;
  chi_grid grid;
  int dimension;
  int is_uniform;   /* a list of nothing but tetrahedra, one after the other, with fields of points
                       and nothing hidden */
  int is_lattice;   /* an image or rectilinear grid of three dimensions with fields of points */
  size_t bricks[3]; /* of a lattice, along each axis */
  size_t brick_phase[3]; /* cells of the whole's brick before the grid's first cell */
  size_t run_phase;
  double cell_volume; /* of an image; 0: cells differ */
  chi_scatter_piece* pieces;
  size_t piece_count;
  double* masses; /* of a list's cells in their order, as far as they are tetrahedra; or NULL */
  const uint32_t* order;        /* of a list that is sorted, or NULL */
  const uint32_t (*corners)[4]; /* likewise, of a uniform list: points of its cells */
  const chi_scatter_kernels* kernels;
  chi_scatter_plot plot;
  double total_unit; /* integers per unit of mass, of sums over all of the mesh */
  int is_signed;     /* weights are of both signs */
  size_t tile_budget;
  atomic_flag lock;
  atomic_int failed; /* a chi_status */
} chi_scatter_job;

/* Of all threads and processes. */
typedef struct chi_scatter_masses
{
  int64_t* bins;
  int64_t mass, deposited; /* within the plot: as summed, and as it went to bins */
  double total, out, singular, bound;
} chi_scatter_masses;

/* ---- all pieces together (chi_scatterplot_plan.c) */

/* Maxima over processes, the worst status among them; without others as they are. */
chi_status chi_scatter_agree(
  const chi_scatter_job* job, chi_status status, double* values, size_t count);
/* Sums over processes, in place. */
chi_status chi_scatter_add_up(const chi_scatter_job* job, int64_t* values, size_t count);
/* The highest dimension of cells, and whether all are tetrahedra one after the other. */
chi_status chi_scatter_look_at_types(chi_scatter_job* job);
void chi_scatter_plan_pieces(chi_scatter_job* job);
/* The pieces' own, where it is automatic. */
chi_status chi_scatter_choose_range(
  chi_scatter_job* job, chi_status status, chi_scatterplot_result* result);
void chi_scatter_set_plot(chi_scatter_job* job, const chi_scatterplot_result* result);
/* Integers per unit of mass: of the whole, and of bins by the pieces that touch the plot. */
chi_status chi_scatter_choose_units(chi_scatter_job* job);
/* Whether a piece's values, in units of bins, miss the plot; one on its lower or upper end does
 * not. */
int chi_scatter_misses(const chi_scatter_job* job, const chi_scatter_piece* piece, double box[4]);

/* ---- all deposits together (chi_scatterplot_result.c) */

/* Sums over threads and processes, bins in the first worker's. */
chi_status chi_scatter_sum(chi_scatter_job* job, chi_scatter_masses* masses);
void chi_scatter_write_result(const chi_scatter_job* job, const chi_scatter_masses* masses,
  double* density, chi_scatterplot_result* result);
void chi_scatter_count_pieces(const chi_scatter_job* job, chi_scatterplot_result* result);

/* Six times the volume of a tetrahedron, without its sign. */
static inline double chi_scatter_volume6(
  const double* p, const double* q, const double* r, const double* s)
{
  const double a[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
  const double b[3] = { r[0] - p[0], r[1] - p[1], r[2] - p[2] };
  const double c[3] = { s[0] - p[0], s[1] - p[1], s[2] - p[2] };
  return fabs(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
    a[2] * (b[0] * c[1] - b[1] * c[0]));
}

/* Of a coordinate, as chi_grid_count has it. */
#define CHI_SCATTER_LARGEST 1e100

/* ---- values (chi_scatterplot_values.c) */

/* A component, or the magnitude, of count tuples from `first` on. */
void chi_scatter_load(
  const chi_array_view* values, int32_t component, size_t first, size_t count, double* out);
/* The same of the tuples `ids`; of the first where an id is not below `limit`. */
void chi_scatter_gather(const chi_array_view* values, int32_t component, const uint32_t* ids,
  size_t limit, size_t count, double* out);
double chi_scatter_value(const chi_array_view* values, int32_t component, size_t i);
/* In place, into units of bins. */
void chi_scatter_map(const chi_scatter_plot* plot, int axis, double* values, size_t count);

/* ---- one piece: look at it, deposit it */

void chi_scatter_measure_brick(
  const chi_scatter_job* job, size_t index, chi_scatter_brick* brick, chi_scatter_piece* piece);
void chi_scatter_deposit_brick(chi_scatter_job* job, size_t index, chi_scatter_worker* worker);
/* Cells of a brick whose values, in units of bins, lie in box (x from, to, y from, to); none is
 * heavier than `most`. */
void chi_scatter_deposit_cells(chi_scatter_job* job, chi_scatter_worker* worker,
  chi_scatter_brick* brick, const double box[4], double most);
/* With `piece` look at the run and fill it in, without deposit it. */
void chi_scatter_visit_run(
  chi_scatter_job* job, size_t index, chi_scatter_worker* worker, chi_scatter_piece* piece);
/* Room for `count` simplices more; 0 where it is refused, and the job has failed. */
int chi_scatter_reserve_block(chi_scatter_job* job, chi_scatter_worker* worker, size_t count);
/* Cells of a list that are one piece. */
void chi_scatter_find_run(const chi_scatter_job* job, size_t run, size_t* first, size_t* last);
/* chi_scatter_visit_run of a list of nothing but tetrahedra. */
void chi_scatter_visit_tetrahedra(
  chi_scatter_job* job, size_t run, chi_scatter_worker* worker, chi_scatter_piece* piece);
/* Values at the corners of a block, as they are. */
void chi_scatter_gather_block(const chi_scatter_job* job, chi_scatter_block* block);
/* Leave out cells with a value or a mass that is not finite; how many, and with `piece` what the
 * others hold. */
void chi_scatter_look_through(chi_scatter_block* block, int corners, chi_scatter_piece* piece);
/* A block with its values, which become units of bins. */
void chi_scatter_deposit_block(chi_scatter_job* job, chi_scatter_worker* worker, size_t run);
/* The values of a block's corners, cells with any that is not finite left out; those are counted
 * and the others' ranges found with `piece`, else all is deposited. The block is empty then. */
void chi_scatter_finish_block(
  chi_scatter_job* job, chi_scatter_worker* worker, size_t run, chi_scatter_piece* piece);
/* Mass per volume of a cell. */
double chi_scatter_weight(
  const chi_scatter_job* job, size_t cell, const int64_t* ids, size_t count);
/* Triangles of a polygonal cell into the block; CHI_CELL_... */
int chi_scatter_add_polygon(chi_scatter_job* job, chi_scatter_worker* worker, size_t cell);
/* Area of a polygonal cell, and its weight. */
int chi_scatter_measure_polygon(
  const chi_scatter_job* job, size_t cell, double* area, double* weight);

/* ---- small cells by their means (chi_scatterplot_splat.c) */

/* Those that may are deposited, and their masses become NaN. */
void chi_scatter_splat_brick(
  chi_scatter_job* job, chi_scatter_worker* worker, chi_scatter_brick* brick);
void chi_scatter_splat_list(chi_scatter_job* job, chi_scatter_worker* worker);

static inline int chi_scatter_splats(const chi_scatter_job* job)
{
  return job->params.splat_size > 0 && job->params.method == CHI_SCATTERPLOT_EXACT;
}

/* ---- trilinear cells (chi_scatterplot_trilinear.c) */

/* Deposit a brick with the cells subdivided that have to be; 0: none has, and nothing is done. */
int chi_scatter_refine_brick(
  chi_scatter_job* job, chi_scatter_worker* worker, const chi_scatter_brick* brick);
/* The block's simplices from `first` on are those of a cell, split by `way`, with this weight. Of
 * a trilinear one they get its mass; where it is subdivided it is deposited and they are taken away
 * again, unless it is first looked at. */
void chi_scatter_refine_cell(chi_scatter_job* job, chi_scatter_worker* worker,
  const chi_grid_cell* cell, int way, size_t first, double weight, int is_first);

/* Order a list of cells in space where it pays; NULL members of the job are no error. */
chi_status chi_scatter_sort(chi_scatter_job* job);
/* The same of a uniform list: its cells' points in that order (chi_scatterplot_corners.c). */
chi_status chi_scatter_sort_corners(chi_scatter_job* job);
/* The box of all points that are finite. */
chi_status chi_scatter_find_box(const chi_scatter_job* job, double low[3], double high[3]);

/* ---- what both kinds of pieces share (chi_scatterplot_deposit.c) */

/* A free worker with its memory, or NULL: the job has failed. */
chi_scatter_worker* chi_scatter_acquire(chi_scatter_job* job);
void chi_scatter_release(chi_scatter_job* job, chi_scatter_worker* worker);
void chi_scatter_free_worker(const chi_exec* exec, chi_scatter_worker* worker);

/* All of a mass to the bin of one pair of values; 0 where that is beyond the plot. */
int chi_scatter_deposit_at(
  const chi_scatter_job* job, chi_scatter_worker* worker, double x, double y, double mass);
/* The worker's first `count` edges among the values x, y, which lie in box (x from, to, y from, to)
 * and carry `mass` together; masses of bins up to `clean` are noise. */
void chi_scatter_deposit_edges(const chi_scatter_job* job, chi_scatter_worker* worker,
  const double* x, const double* y, size_t count, double mass, const double box[4], double clean);
/* Masses of a piece that has been deposited become integers. */
void chi_scatter_settle(const chi_scatter_job* job, chi_scatter_worker* worker);
/* One tetrahedron (4 corners) or triangle (3) by its sections, or by the published method. */
void chi_scatter_deposit_simplex(const chi_scatter_job* job, chi_scatter_worker* worker,
  int corners, const double* x, const double* y, double mass);
void chi_scatter_deposit_published(const chi_scatter_job* job, chi_scatter_worker* worker,
  int corners, const double* x, const double* y, double mass);

/* Most that the published method makes of a mass, per bin. */
#define CHI_SCATTER_HIGHEST 0x1p20

/* Heavier than this, cells of a piece whose heaviest is `most` go by their edges; lighter bins than
 * chi_scatter_noise of them are rounding. */
static inline double chi_scatter_light(double most)
{
  return 1e-4 * most;
}

static inline double chi_scatter_noise(double most)
{
  return 1e-13 * most;
}

#endif
