/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_INTERNAL_H
#define CHI_TET_INTERNAL_H

/* The stages of the renderer of tetrahedra, in the order in which they run. Each is given what it
 * reads and keeps what it makes; chi_tet.c decides which of them have to run. */

#include "chi_buffer.h"
#include "chi_internal.h"
#include "simd/chi_tet_kernels.h"

#include <chiaroscuro/chi_tet.h>

enum
{
  CHI_TET_MAX_SIZE = 16384, /* pixels a side: tiles are numbered by bytes */
  CHI_TET_MAX_SLABS = 4096, /* of occlusion */
  CHI_TET_OCCLUSION_KEY = 6,
  CHI_TET_CHUNKS = 64 /* of the list of tetrahedra, whatever the number of threads */
};

/* Stage 1: the grid as tetrahedra. */
typedef struct chi_tet_mesh
{
  chi_grid_counts counts;
  chi_buffer vertices;    /* uint32 [tetrahedra x 4] */
  chi_buffer cells;       /* uint32 [tetrahedra]; unused where every cell is a tetrahedron */
  chi_buffer extra_cells; /* uint32 [extra points] */
  chi_buffer points;      /* double [all points x 3]; unused where the grid's own can be read */
  chi_vec3_view all_points;
  const uint32_t* cell_of; /* cells, or NULL: the identity */
  size_t point_count;      /* extra points included */
} chi_tet_mesh;

chi_status chi_tet_mesh_build(const chi_exec* exec, chi_tet_mesh* mesh, const chi_grid_view* grid);
void chi_tet_mesh_free(const chi_exec* exec, chi_tet_mesh* mesh);
/* Cells that have been split; 1 where there are none. */
size_t chi_tet_cells_of(const chi_tet_mesh* mesh);

/* Stage 2: its scalars, and which tetrahedra are to be drawn at all. */
typedef struct chi_tet_values
{
  chi_buffer scalars, opacities; /* float: of points, or of the grid's cells */
  chi_buffer colors;             /* float [x 3]: direct ones, where `direct` */
  int direct;
  int is_cell_data, separate;
  int by_plane;         /* opacities are the second quantity of a transfer function of two, */
  int by_gradient;      /* or, and separate, it is */
  chi_buffer gradients; /* float: one a tetrahedron */
  double longest_edge, widest_range; /* of a tetrahedron: units of the grid, and of the scalar */
  chi_buffer visible;                /* uint32, one bit a tetrahedron */
  float coarseness;                  /* of the tables: the largest step from entry to entry, of 1 */
  chi_buffer extinction;             /* float [entries + 1] of the table, one after the other */
  chi_buffer opaque; /* uint32: entries of the table, before each, that are not transparent */
  int64_t non_finite, transparent;
  int all_opaque;   /* `visible` holds all that is finite */
  uint64_t version; /* of `visible`: grows where it changes */
} chi_tet_values;

/* `by_plane`: of a transfer function of two quantities. */
chi_status chi_tet_values_build(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_grid_view* grid, const chi_tet_field* field, int by_plane);
/* Of these, the magnitude of the gradient, times the mean edge of a cell. */
chi_status chi_tet_gradients_build(
  const chi_exec* exec, chi_tet_values* values, const chi_tet_mesh* mesh);
/* Of these, direct colours, if the field has any. */
chi_status chi_tet_colors_build(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_grid_view* grid, const chi_tet_field* field);
/* By the tables of the transfer function; `skip_transparent` 0: all whose scalars are finite. */
chi_status chi_tet_values_choose(const chi_exec* exec, chi_tet_values* values,
  const chi_tet_mesh* mesh, const chi_segment_tables* tables, int skip_transparent);
void chi_tet_values_free(const chi_exec* exec, chi_tet_values* values);

/* Tables of a transfer function of two quantities, and what they were made from. */
typedef struct chi_tet_plane_key
{
  const void* table;
  uint64_t version;
  size_t count[2];
  double range[2], plane_range[2], unit_distance;
  int64_t convention;
} chi_tet_plane_key;

typedef struct chi_tet_plane
{
  chi_buffer entries;   /* float [rows][columns + 1][4]: colour, extinction */
  chi_buffer bound;     /* float [columns], [columns x 3]: largest opacity of each column, white */
  size_t columns, rows; /* 0: none */
  chi_tet_plane_key key;
  uint64_t version;
} chi_tet_plane;

/* `bound`: a transfer function of the first quantity alone that is opaque wherever this one is. */
chi_status chi_tet_plane_build(const chi_exec* exec, chi_tet_plane* plane,
  const chi_transfer_view* transfer, int32_t convention, chi_transfer_view* bound);
void chi_tet_plane_free(const chi_exec* exec, chi_tet_plane* plane);

/* Stage 3: points as the eye sees them. */
typedef struct chi_tet_eye
{
  chi_buffer points; /* chi_tet_point */
  chi_buffer screen; /* float [x 2] pixels; NaN in front of the near plane, and too far off */
  chi_buffer codes;  /* uint32: bit k: outside clip plane k; unused without planes */
  double planes[4 * CHI_TET_CUTS];
  double first[2], step[2];
  int any_beyond; /* a point lies in front of the near plane, or too far off */
} chi_tet_eye;

chi_status chi_tet_eye_build(const chi_exec* exec, chi_tet_eye* eye, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_frame* frame);
void chi_tet_eye_free(const chi_exec* exec, chi_tet_eye* eye);

/* Stage 4: the tetrahedra of every tile, in order. */
typedef struct chi_tet_bins
{
  chi_buffer keys;    /* uint32 [tetrahedra] */
  chi_buffer in_tile; /* uint32, one bit a tetrahedron: it is in a tile */
  chi_buffer counts;  /* uint32 [chunks][tiles] */
  chi_buffer starts;  /* size_t [tiles + 1] */
  chi_buffer list;    /* uint64: key, tetrahedron */
  chi_buffer scratch; /* first and last tile of each tetrahedron; once lists are made, of sorts */
  chi_buffer depths;  /* float [tiles] farthest surface */
  chi_buffer order;   /* uint32 [tiles] those with most to draw first */
  chi_buffer tallies; /* chi_tet_tally [tiles] */
  chi_buffer whole;   /* uint64: what chi_tet_sequence sorts, twice */
  int32_t tiles[2];
  size_t entries;
  int64_t outside, uncovered, clipped, hidden;
} chi_tet_bins;

chi_status chi_tet_bins_build(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_eye* eye, const chi_tet_frame* frame, int32_t bits);
void chi_tet_bins_free(const chi_exec* exec, chi_tet_bins* bins);

/* Stage 5: what lights make of each tetrahedron that is in a tile: factors of red, green and blue,
 * and what is added to them. */
chi_status chi_tet_shade(const chi_exec* exec, chi_buffer* shades, const chi_tet_mesh* mesh,
  const chi_tet_values* values, const chi_tet_eye* eye, const chi_tet_bins* bins,
  const chi_tet_frame* frame);

/* Stage 6: the picture. */
typedef struct chi_tet_picks
{
  double opacity;
  int64_t* cells;
  float* depths;
} chi_tet_picks;

/* Fragments kept from one frame for the next, where nothing but colours has changed. How many there
 * are has to be known before they are kept, from a frame that left none out. */
typedef struct chi_tet_cache
{
  chi_buffer starts; /* size_t [tiles + 1]: fragments of the tiles before */
  chi_buffer pixels, ends, lengths;
  int is_counted, is_full; /* `starts` are those of the frame; and the fragments */
} chi_tet_cache;

enum
{
  CHI_TET_CACHE_OFF,
  CHI_TET_CACHE_COUNT,
  CHI_TET_CACHE_WRITE,
  CHI_TET_CACHE_READ
};

typedef struct chi_tet_pass
{
  int skip_saturated;
  float* rgba;                /* [height x width x 4]; NULL with `picks` */
  const chi_tet_picks* picks; /* or NULL */
  chi_tet_cache* cache;
  int cache_use; /* CHI_TET_CACHE_... */
  /* not with `picks`: */
  int published;                /* by CHI_TET_PROJECTION_PUBLISHED */
  const double (*integrals)[4]; /* of chi_tet_splat_prepare: small ones are splatted; or NULL */
} chi_tet_pass;

/* chi_tet_projector: a tetrahedron by the published projection. */
int chi_tet_publish(chi_tet_projector* projector, const chi_tet_scene* scene, uint32_t tetrahedron,
  const int32_t tile[2], chi_tet_sink* sink);

chi_status chi_tet_draw(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_scene* scene,
  const chi_tet_pass* pass, chi_tet_tally* tally);
/* Bytes of as many fragments; whether they can be had. */
int chi_tet_cache_reserve(const chi_exec* exec, chi_tet_cache* cache, size_t tiles, size_t limit);
void chi_tet_cache_free(const chi_exec* exec, chi_tet_cache* cache);

/* The same with occlusion, slab after slab of depths. */
typedef struct chi_tet_occlusion chi_tet_occlusion;

typedef struct chi_tet_occlusion_result
{
  chi_tet_tally tally;
  double seconds_light;
  size_t bytes;
  int32_t slabs; /* passed */
} chi_tet_occlusion_result;

int chi_tet_occlusion_is_valid(const chi_tet_params* params);
int chi_tet_is_occluded(const chi_tet_params* params);
/* What of the parameters changes the picture; zeros where it is not occluded. */
void chi_tet_occlusion_key(const chi_tet_params* params, double key[CHI_TET_OCCLUSION_KEY]);
/* `keep` is made where it is NULL. `cell`: cube root of the mesh's volume a cell, world units. */
chi_status chi_tet_occlude(const chi_exec* exec, chi_tet_occlusion** keep, chi_tet_bins* bins,
  const chi_tet_scene* scene, const chi_tet_frame* frame, double cell, float* rgba,
  chi_tet_occlusion_result* result);
void chi_tet_occlusion_destroy(const chi_exec* exec, chi_tet_occlusion* occlusion); /* NULL too */

/* Small tetrahedra by what they cover of each pixel of a tile. */
typedef struct chi_tet_splatter
{
  chi_tet_projector projector;
  const chi_tet_scene* scene;   /* set before all, */
  const double (*integrals)[4]; /* as are these, */
  chi_tet_target* target;
  int32_t tile[2];      /* and the first pixel */
  int32_t is_unsettled; /* fragments of marked pixels are on their way */
  uint8_t marked[CHI_TET_TILE_PIXELS];
  double merged[CHI_TET_TILE_PIXELS][4]; /* emission, and optical depth */
  double through[CHI_TET_TILE_PIXELS];   /* the transmittance, of which the target holds a float */
  uint64_t covered[CHI_TET_TILE_PIXELS]; /* of 8 x 8 places in a pixel those that any covers */
} chi_tet_splatter;

/* Integrals over the tables, double [count][4]. */
chi_status chi_tet_splat_prepare(
  const chi_exec* exec, chi_buffer* integrals, const chi_segment_tables* tables);
/* How many of a tile's list are small; where any is, the tile is to be drawn with the projector,
 * and then ended. */
int64_t chi_tet_splat_begin(chi_tet_splatter* splatter, const uint64_t* list, size_t count);
void chi_tet_splat_end(chi_tet_splatter* splatter);
/* A pixel's opacity after the end, of whatever size; of one that is not marked, as the target's. */
float chi_tet_splat_alpha(const chi_tet_splatter* splatter, int32_t pixel);

/* A frame of fewer pixels, and its picture brought to size. */
typedef struct chi_tet_reduction
{
  chi_camera camera;
  chi_surface_view surface;
  int32_t times;
  chi_buffer depth; /* float [height x width] of the surface */
  chi_buffer rgba;  /* float [height x width x 4] */
} chi_tet_reduction;

chi_status chi_tet_reduce(
  const chi_exec* exec, chi_tet_reduction* reduction, const chi_tet_frame* frame, int32_t times);
chi_status chi_tet_enlarge(const chi_exec* exec, const chi_tet_reduction* reduction,
  const float* from, float* to, int32_t width, int32_t height);

/* All tetrahedra that are in a tile, farthest first. */
chi_status chi_tet_sequence(const chi_exec* exec, chi_tet_bins* bins, const chi_tet_mesh* mesh,
  int32_t bits, chi_buffer* sequence, size_t* count);

#endif
