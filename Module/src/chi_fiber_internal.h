/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_FIBER_INTERNAL_H
#define CHI_FIBER_INTERNAL_H

/*
 * Fiber surfaces, in steps: the polygon as segments with their signs (chi_fiber_polygon), the index
 * of a mesh with two fields (chi_fiber_index), the pairs of a tetrahedron and a segment that may
 * meet (chi_fiber_find), each pair's part of the surface with its points by name (chi_fiber_cut),
 * points of one name made one (chi_fiber_weld), connected parts (chi_fiber_parts), and the arrays
 * (chi_fiber_write). What is enclosed: its part of the plane as triangles (chi_fiber_planar), each
 * with a tetrahedron (chi_fiber_clip), all of them (chi_fiber_enclose), the arrays
 * (chi_fiber_enclosed).
 */

#include <chiaroscuro/chi_fiber.h>

#include "chi_buffer.h"
#include "chi_grid_internal.h"
#include "math/chi_predicates.h"
#include "simd/chi_fiber_kernels.h"

#include <stdatomic.h>

enum
{
  CHI_FIBER_PAIR = 16,        /* a pair is tetrahedron * CHI_FIBER_PAIR + segment of the batch */
  CHI_FIBER_LIST_BRICK = 256, /* tetrahedra of a list that have their ranges of values together */
  CHI_FIBER_BLOCK = 8,        /* likewise cells along each axis of an image */
  CHI_FIBER_LIST_CHUNK = 32,  /* bricks that are worked on together */
  CHI_FIBER_IMAGE_CHUNK = 2,
  CHI_FIBER_SUMS = 3,       /* cells left out: bad values, bad places, hidden */
  CHI_FIBER_RUN = 256,      /* points with their ranges together */
  CHI_FIBER_CORNERS = 6,    /* most corners of a part: a quadrilateral cut off twice */
  CHI_FIBER_PARTITIONS = 64 /* of the points' names */
};

/* ---- the polygon ---- */

typedef struct chi_fiber_segment
{
  double p[2], q[2], d[2];   /* ends, q - p */
  double square, per_length; /* d . d, 1 / |d| */
  uint32_t corner[2];        /* distinct corners of the polygon */
  int64_t id;                /* of the caller's */
  uint32_t line;             /* of the caller's */
  int8_t side;               /* 1: the inside is on the left; -1 */
  int8_t tie;                /* the sign of what lies on the line */
  uint8_t is_closed;         /* of a closed line */
} chi_fiber_segment;

typedef struct chi_fiber_corner
{
  double x[2];
  int32_t starts; /* whether a segment begins here */
} chi_fiber_corner;

typedef struct chi_fiber_polygon
{
  chi_fiber_segment* segment;
  chi_fiber_corner* corner;
  size_t count, corners, empty, closed;
  chi_buffer segments, corner_buffer, given, order; /* given: the points as they came */
  size_t given_count;
} chi_fiber_polygon;

/* Into `next`, empty or not; *same: it is as `polygon` is. */
chi_status chi_fiber_polygon_read(
  const chi_exec* exec, chi_fiber_polygon* polygon, const chi_lines_view* lines);
void chi_fiber_polygon_free(const chi_exec* exec, chi_fiber_polygon* polygon);
chi_fiber_segment chi_fiber_make_segment(
  const chi_fiber_corner* corner, uint32_t from, uint32_t to);

/* (q - p) x (x - p): positive on the left of the line from p to q. The value's sign is exact. */
double chi_fiber_area_exact(const double p[2], const double q[2], const double x[2]);

static inline double chi_fiber_area(const double p[2], const double q[2], const double x[2])
{
  const double a = (q[0] - p[0]) * (x[1] - p[1]), b = (q[1] - p[1]) * (x[0] - p[0]);
  const double area = a - b;
  /* ccwerrboundA of Shewchuk 1997: (3 + 16 u) u, u = 2^-53, rounded up */
  const double bound = 0x1.8p-52 * (1 + 0x1p-40) * (fabs(a) + fabs(b));
  return fabs(area) > bound ? area : chi_fiber_area_exact(p, q, x);
}

/* On which side of a segment's line values lie, after the polygon has moved by (e, e^2): the line
 * is then passed at (q - p) x (x - p) = e dy - e^2 dx from where it was, with the sign turned. */
static inline int chi_fiber_is_left(const chi_fiber_segment* s, const double x[2], double* area)
{
  *area = chi_fiber_area(s->p, s->q, x);
  return *area > 0 || (*area == 0 && s->tie > 0);
}

/* Likewise a moved corner and the line from a to b. */
static inline int chi_fiber_is_corner_left(
  const double a[2], const double b[2], const double corner[2], double* area)
{
  *area = chi_fiber_area(a, b, corner);
  const double dy = b[1] - a[1];
  return *area > 0 || (*area == 0 && (dy < 0 || (dy == 0 && b[0] - a[0] > 0)));
}

/* ---- the index ---- */

enum
{
  CHI_FIBER_LIST = 0,   /* a list of our own, from chi_grid_split */
  CHI_FIBER_DIRECT = 1, /* the caller's cells are tetrahedra */
  CHI_FIBER_KUHN = 2    /* six a cell of an image */
};

/* Why a point cannot be a corner. */
enum
{
  CHI_FIBER_BAD_VALUE = 1,
  CHI_FIBER_BAD_PLACE = 2,
  CHI_FIBER_HIDDEN = 4
};

typedef struct chi_fiber_range
{
  double low[2], high[2]; /* low > high: none */
} chi_fiber_range;

typedef struct chi_fiber_index
{
  chi_grid grid;
  int source;
  size_t points; /* with centres of cells */
  size_t centers, tetrahedra, bricks, chunks, bricks_a_chunk, runs;
  size_t blocks[3];
  double (*values)[2];        /* [points] */
  uint8_t* flags;             /* [points] CHI_FIBER_BAD_... */
  chi_fiber_range* brick;     /* [bricks] */
  chi_fiber_range* run;       /* [runs] of points */
  uint8_t* run_flags;         /* [runs] or of the points' */
  uint32_t (*vertices)[4];    /* of our own list */
  uint32_t* cells;            /* likewise */
  uint32_t* center_cells;     /* [centers] */
  double (*center_places)[3]; /* [centers] */
  size_t bad_values, bad_places, hidden, others;
  chi_fiber_range range; /* of all finite values of all points */
  chi_buffer value_buffer, flag_buffer, brick_buffer, run_buffer, list_buffer, cell_buffer,
    center_buffer, place_buffer, sum_buffer;
} chi_fiber_index;

chi_status chi_fiber_index_build(const chi_exec* exec, chi_fiber_index* index,
  const chi_grid_view* grid, const chi_fiber_params* params, int64_t* first_bad_cell);
void chi_fiber_index_free(const chi_exec* exec, chi_fiber_index* index);

extern const chi_fiber_range chi_fiber_no_range;

static inline void chi_fiber_widen(chi_fiber_range* range, const double x[2])
{
  for (int k = 0; k < 2; ++k)
  {
    range->low[k] = x[k] < range->low[k] ? x[k] : range->low[k];
    range->high[k] = x[k] > range->high[k] ? x[k] : range->high[k];
  }
}

/* While an index is built. */
typedef struct chi_fiber_index_job
{
  const chi_exec* exec;
  chi_fiber_index* index;
  const chi_fiber_params* params;
  size_t (*sums)[CHI_FIBER_SUMS]; /* [bricks] */
  int looks_at_places;
  int all_flags; /* of all points */
  atomic_int is_broken;
} chi_fiber_index_job;

/* A chi_range_fn over bricks; is_broken afterwards: the cells are not all good tetrahedra. */
void chi_fiber_read_bricks(void* data, size_t begin, size_t end);

/* The path of tetrahedron `path` of an image's cell: offsets of its corners from the first, in
 * steps along the axes. */
extern const uint8_t chi_fiber_paths[6][4];

static inline void chi_fiber_cell_at(const chi_fiber_index* x, size_t cell, size_t at[3])
{
  const size_t* const n = x->grid.dimensions;
  at[0] = cell % n[0];
  at[1] = cell / n[0] % n[1];
  at[2] = cell / n[0] / n[1];
}

/* The id of the k-th point of an image's cell, its bits the steps along the axes, from its first.
 */
static inline size_t chi_fiber_step(const chi_fiber_index* x, int k)
{
  const size_t row = x->grid.dimensions[0] + 1, plane = row * (x->grid.dimensions[1] + 1);
  return (size_t)(k & 1) + (k >> 1 & 1 ? row : 0) + (k >> 2 & 1 ? plane : 0);
}

static inline size_t chi_fiber_first_point(const chi_fiber_index* x, const size_t at[3])
{
  return at[0] + (x->grid.dimensions[0] + 1) * (at[1] + (x->grid.dimensions[1] + 1) * at[2]);
}

/* The cells of an image's brick, from `low` to before `high`; its points reach up to there. */
static inline void chi_fiber_block(
  const chi_fiber_index* x, size_t brick, size_t low[3], size_t high[3])
{
  const size_t* const n = x->blocks;
  const size_t block[3] = { brick % n[0], brick / n[0] % n[1], brick / n[0] / n[1] };
  for (int a = 0; a < 3; ++a)
  {
    low[a] = block[a] * CHI_FIBER_BLOCK;
    high[a] = chi_grid_chunk_end(low[a], CHI_FIBER_BLOCK, x->grid.dimensions[a]);
  }
}

/* A tetrahedron's points; its cell. */
static inline size_t chi_fiber_fetch(const chi_fiber_index* x, uint64_t tetrahedron, uint32_t v[4])
{
  if (x->source == CHI_FIBER_LIST)
  {
    memcpy(v, x->vertices[tetrahedron], 4 * sizeof *v);
    return x->cells[tetrahedron];
  }
  if (x->source == CHI_FIBER_DIRECT)
  {
    const int64_t* const ids =
      x->grid.view.connectivity + x->grid.view.offsets[0] + 4 * tetrahedron;
    for (int k = 0; k < 4; ++k)
    {
      v[k] = (uint32_t)ids[k];
    }
    return (size_t)tetrahedron;
  }
  const size_t cell = (size_t)(tetrahedron / 6);
  size_t at[3];
  chi_fiber_cell_at(x, cell, at);
  const size_t first = chi_fiber_first_point(x, at);
  for (int k = 0; k < 4; ++k)
  {
    v[k] = (uint32_t)(first + chi_fiber_step(x, chi_fiber_paths[tetrahedron % 6][k]));
  }
  return cell;
}

static inline void chi_fiber_place(const chi_fiber_index* x, uint32_t id, double place[3])
{
  if (id < x->grid.points)
  {
    chi_grid_point(&x->grid, id, place);
  }
  else
  {
    memcpy(place, x->center_places[id - x->grid.points], 3 * sizeof *place);
  }
}

/* ---- pairs of a tetrahedron and a segment ---- */

/* What a chunk of bricks makes for a batch of segments, and where its results stand. */
typedef struct chi_fiber_job
{
  size_t batch, chunk;
  size_t first_pair, pairs;     /* of the batch */
  size_t first_part;            /* of all pairs */
  size_t first_corner, corners; /* an upper bound */
  size_t points;                /* distinct names */
  size_t own, first_own;        /* points that are first met here */
  size_t triangles, first_triangle, crossed;
} chi_fiber_job;

typedef struct chi_fiber_pairs
{
  chi_fiber_job* job; /* [jobs] batch by batch, chunk by chunk */
  size_t jobs, batches, count, corners;
  uint64_t** pair; /* [batches] tetrahedron * CHI_FIBER_PAIR + segment of the batch */
  chi_buffer job_buffer, pair_pointers, mask_buffer, active_buffer;
  chi_buffer* pair_buffer; /* [buffers] */
  size_t buffers;
  size_t skipped_bricks, skipped_runs;
} chi_fiber_pairs;

chi_status chi_fiber_find(const chi_exec* exec, chi_fiber_pairs* pairs,
  const chi_fiber_index* index, const chi_fiber_polygon* polygon, int32_t no_skipping);
void chi_fiber_pairs_free(const chi_exec* exec, chi_fiber_pairs* pairs);

/* Whether a segment may meet a box; errs towards yes. */
int chi_fiber_meets(const chi_fiber_segment* s, const chi_fiber_range* box);
/* The bits of a segment for the points of a box, and whether they hold for all of these. */
int chi_fiber_bits_of_box(const chi_fiber_segment* s, const chi_fiber_range* box, uint64_t* bits);

/* ---- their parts of the surface ---- */

#define CHI_FIBER_NONE UINT32_MAX

/* A point's name: the mesh's points that it lies between, ascending, and what cuts there. A point
 * of the mesh has the name (a, none, none or the segment that it is kept apart for). */
typedef struct chi_fiber_name
{
  uint32_t a, b, c; /* CHI_FIBER_NONE: fewer */
  uint32_t tag;     /* a segment, or 2^31 with a corner; at a point of the mesh any segment there */
} chi_fiber_name;

#define CHI_FIBER_AT_CORNER 0x80000000u

/* A surface's parts while they are made, all by place in one row of corners. */
typedef struct chi_fiber_parts
{
  chi_fiber_name* name; /* [corners] of each job's points, from its first corner on */
  uint32_t* corner;     /* [corners] of the parts: points of the job */
  uint8_t* size;        /* [pairs] corners of each part, 0 or 3 ... 6 */
  double (*normal)[3];  /* [corners] sums of gradients, of each job's points; NULL: none */
  uint32_t* id;         /* [corners] of each job's points: that of the surface */
  uint8_t* used;        /* [corners] of each job's points: whether a triangle has it */
  uint32_t* table;      /* [2 x corners] scratch */
  chi_buffer name_buffer, corner_buffer, size_buffer, normal_buffer, id_buffer, used_buffer,
    table_buffer, order_buffer, partition_buffer;
  int split_corners;
} chi_fiber_parts;

chi_status chi_fiber_cut(const chi_exec* exec, chi_fiber_parts* parts, chi_fiber_pairs* pairs,
  const chi_fiber_index* index, const chi_fiber_polygon* polygon, int with_normals);
void chi_fiber_parts_free(const chi_exec* exec, chi_fiber_parts* parts);

/* Corners of sections, as edges between corners of a tetrahedron, by which of these are on the
 * left. Right-handed tetrahedra show them counterclockwise to who looks from the right side. */
typedef struct chi_fiber_section
{
  uint8_t count, edge[4][2];
} chi_fiber_section;
extern const chi_fiber_section chi_fiber_sections[16];

/* A job's point of this name, perhaps a new one. */
uint32_t chi_fiber_find_point(
  chi_fiber_parts* parts, chi_fiber_job* own, const chi_fiber_name* name);

/* Whether the k-th triangle of a part, a fan from its first corner, has three corners. */
static inline int chi_fiber_is_triangle(const uint32_t* corners, int k)
{
  return corners[0] != corners[k - 1] && corners[k - 1] != corners[k] && corners[k] != corners[0];
}

/* Make points of one name one; the first that is met is kept, `id` says what each became. */
chi_status chi_fiber_weld(const chi_exec* exec, chi_fiber_parts* parts, chi_fiber_pairs* pairs,
  size_t* points, size_t* triangles);

/* What a point lies between and with which weights; their number. */
int chi_fiber_locate(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name, uint32_t parents[3], double weights[3]);
/* Where on its segment it lies, 0 ... 1. */
double chi_fiber_parameter(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name);

/* What of a name's tag tells points apart. */
static inline uint32_t chi_fiber_tag(const chi_fiber_name* name)
{
  return name->b == CHI_FIBER_NONE ? 0 : name->tag;
}

static inline uint32_t chi_fiber_hash(const chi_fiber_name* name)
{
  const uint64_t odd = 0x9e3779b97f4a7c15u; /* 2^64 / golden ratio (Knuth 1973, section 6.4) */
  uint64_t h = ((uint64_t)name->a << 32 | name->b) * odd;
  h ^= h >> 29;
  h = (h ^ ((uint64_t)name->c << 32 | chi_fiber_tag(name))) * odd;
  h ^= h >> 32;
  return (uint32_t)(h * odd >> 32);
}

static inline int chi_fiber_same(const chi_fiber_name* x, const chi_fiber_name* y)
{
  return x->a == y->a && x->b == y->b && x->c == y->c && chi_fiber_tag(x) == chi_fiber_tag(y);
}

/* Where it lies. */
void chi_fiber_position_of(const chi_fiber_index* index, const chi_fiber_polygon* polygon,
  int split_corners, const chi_fiber_name* name, double place[3]);
/* A tuple of a point array at a point that lies so, and the point of most weight. */
void chi_fiber_carry(const chi_fiber_index* index, const chi_array_view* in,
  const uint32_t* parents, const double* weights, int count, char* to);
uint32_t chi_fiber_nearest_of(
  const chi_fiber_index* index, const uint32_t* parents, const double* weights, int count);

/* ---- the inside ---- */

/* By points: whether a closed line's segments turn about their values, by even and odd. */
chi_status chi_fiber_find_inside(const chi_exec* exec, const chi_fiber_index* index,
  const chi_fiber_polygon* polygon, uint8_t* inside);
/* Whether a tetrahedron, given with its cell, is not left out. */
int chi_fiber_is_usable(const chi_fiber_index* index, size_t cell, const uint32_t v[4]);

/* A triangle of the inside, counterclockwise; segment k runs from corner k to the next, or back. */
typedef struct chi_fiber_triangle
{
  uint32_t corner[3], segment[3];
  uint8_t is_flipped[3];
} chi_fiber_triangle;

/* The inside as triangles that share whole sides. */
typedef struct chi_fiber_pieces
{
  chi_fiber_polygon polygon; /* of their sides; closed: those of one triangle alone */
  chi_fiber_triangle* triangle;
  int32_t (*beside)[2]; /* [segments] triangles on the left and on the right, -1: none */
  size_t triangles;
  chi_buffer triangle_buffer, beside_buffer;
} chi_fiber_pieces;

chi_status chi_fiber_pieces_make(
  const chi_exec* exec, chi_fiber_pieces* pieces, const chi_fiber_polygon* lines);
void chi_fiber_pieces_free(const chi_exec* exec, chi_fiber_pieces* pieces);

/* What a tetrahedron has in common with a triangle of the fields' plane: a convex polyhedron whose
 * corners meet three faces each, as tetrahedra. */
enum
{
  CHI_FIBER_CLIP_POINTS = 10, /* 2 (7 - 2) of seven faces */
  CHI_FIBER_CLIP_CELLS = 16   /* 30 corners of faces make 16 triangles; most of them less */
};

typedef struct chi_fiber_clipped
{
  int points, cells;
  chi_fiber_name name[CHI_FIBER_CLIP_POINTS]; /* where they lie in truth: some are one */
  uint8_t cell[CHI_FIBER_CLIP_CELLS][4];      /* handed as the tetrahedron is */
} chi_fiber_clipped;

void chi_fiber_clip(const chi_fiber_index* index, const chi_fiber_pieces* pieces,
  const uint32_t v[4], size_t triangle, chi_fiber_clipped* out);
/* Whether a segment of the pieces passes a tetrahedron. */
int chi_fiber_passes(
  const chi_fiber_index* index, const chi_fiber_segment* segment, const uint32_t v[4]);

typedef struct chi_fiber_enclosed
{
  chi_fiber_pieces pieces;
  chi_fiber_pairs pairs, cuts; /* that may meet; jobs of what is cut, a chunk of bricks each */
  chi_fiber_parts parts;       /* points of the jobs, and their tetrahedra as corners */
  uint64_t* key;               /* [pairs] tetrahedron * segments + segment */
  uint8_t* is_cut;             /* [tetrahedra / 8] */
  uint8_t* inside;             /* [points] */
  atomic_uchar* is_used;       /* [points] */
  uint32_t* new_id;            /* [points] */
  uint64_t* from;              /* [cells that were cut] the tetrahedron */
  size_t* first_whole;         /* [blocks + 1] cells that are passed whole */
  size_t* first_used;          /* [runs + 1] points that stay */
  double* sums;                /* [blocks + jobs] volumes */
  size_t blocks, vertices, points, whole, cells;
  double volume;
  int is_ready;
  chi_buffer key_buffer, cut_buffer, inside_buffer, used_buffer, id_buffer, from_buffer,
    whole_buffer, run_buffer, sum_buffer;
} chi_fiber_enclosed;

enum
{
  CHI_FIBER_ENCLOSED_BLOCK = 8192 /* tetrahedra of the mesh that are looked at together */
};

/* Whether a tetrahedron is passed whole; then its points and its cell. */
int chi_fiber_is_whole(const chi_fiber_index* index, const chi_fiber_enclosed* enclosed,
  size_t tetrahedron, uint32_t v[4], size_t* cell);
/* Negative: it is left-handed. */
double chi_fiber_six_volumes(const chi_fiber_index* index, const uint32_t v[4]);
void chi_fiber_enclosed_free(const chi_exec* exec, chi_fiber_enclosed* enclosed);

/* ---- connected parts ---- */

typedef struct chi_fiber_components
{
  size_t count, left_out;
  uint32_t* of_point; /* [points] component of each, CHI_FIBER_NONE: left out */
  uint32_t* new_id;   /* [points] after some have been left out */
  size_t* triangles;  /* [jobs] first of each that remains */
  chi_buffer point_buffer, id_buffer, area_buffer, place_buffer, job_buffer;
} chi_fiber_components;

/* ---- the handle ---- */

struct chi_fiber
{
  chi_fiber_polygon polygon, next; /* next: to compare with */
  chi_fiber_index index;
  chi_fiber_pairs pairs;
  chi_fiber_parts parts;
  chi_fiber_components components;
  chi_fiber_enclosed enclosed;
  chi_fiber_sizes sizes;
  uint64_t grid_version, fields_version;
  int32_t component[2];
  size_t all_points, all_triangles; /* before components are left out */
  int has_index, has_surface, with_normals, with_components;
  double minimum_area;
};

/* Connected parts; those below the least area are left out of the sizes. */
chi_status chi_fiber_find_components(const chi_exec* exec, chi_fiber* fiber);
void chi_fiber_components_free(const chi_exec* exec, chi_fiber_components* components);

/* Where a point of the surface lies. */
void chi_fiber_position(const chi_fiber* fiber, const chi_fiber_name* name, double place[3]);

/* The triangles of a job, in order. */
typedef void (*chi_fiber_triangle_fn)(void* data, size_t pair, const uint32_t points[3]);
static inline void chi_fiber_visit(
  const chi_fiber* fiber, const chi_fiber_job* own, chi_fiber_triangle_fn visit, void* data)
{
  const chi_fiber_parts* const parts = &fiber->parts;
  const uint32_t* corner = parts->corner + own->first_corner;
  const uint32_t* const id = parts->id + own->first_corner;
  for (size_t p = 0; p < own->pairs; ++p)
  {
    const int size = parts->size[own->first_part + p];
    for (int k = 2; k < size; ++k)
    {
      if (chi_fiber_is_triangle(corner, k))
      {
        const uint32_t points[3] = { id[corner[0]], id[corner[k - 1]], id[corner[k]] };
        visit(data, p, points);
      }
    }
    corner += size;
  }
}

#endif
