/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_HANDLE_H
#define CHI_TET_HANDLE_H

/* The renderer of tetrahedra and what its stages were made from, for its own sources alone. */

#include "chi_occlusion_internal.h" /* what it knows of shading */
#include "chi_tet_internal.h"

/* What a stage was made from; it runs again only where this differs. Filled from zeros, so that
 * padding compares equal. */
typedef struct grid_key
{
  int64_t kind;
  const void* arrays[11];
  uint64_t version;
  size_t counts[10];
  double index_to_world[16];
} chi_tet_grid_key;

typedef struct field_key
{
  const void* arrays[4];
  uint64_t version;
  int64_t integers[6];
  size_t shapes[4][4];
  double color_range[2];
} chi_tet_field_key;

typedef struct choice_key
{
  uint64_t tables;
  int64_t skip;
} chi_tet_choice_key;

typedef struct view_key
{
  double world_to_eye[16], window[4], near_depth, grid_to_world[16];
  int64_t size[2], parallel, order;
  double clip_planes[4 * CHI_TET_CUTS];
  size_t clip_plane_count;
} chi_tet_view_key;

typedef struct bin_key
{
  uint64_t visible;
  const void* depth;
  uint64_t surface;
  int64_t skip, splatting;
} chi_tet_bin_key;

typedef struct draw_key
{
  uint64_t tables, plane;
  int64_t method, blend, skip, size[2], projection;
  const void* depth;
  uint64_t surface;
  chi_shading_key shading;
  double occlusion[CHI_TET_OCCLUSION_KEY];
} chi_tet_draw_key;

/* What a plan is made from. */
typedef struct described_key
{
  chi_tet_draw_key draw;
  uint64_t versions[4];
} chi_tet_described_key;

/* What fragments are made from, but for their colours. */
typedef struct cache_key
{
  uint64_t view, bins, values, surface;
  const void* depth;
  double range[2];
  size_t count;
  int64_t projection;
} chi_tet_cache_key;

struct chi_tet
{
  chi_tet_mesh mesh;
  chi_tet_values values;
  chi_tet_eye eye;
  chi_tet_bins bins;
  chi_tet_order* order;
  chi_preintegration* preintegration;
  chi_segment_tables tables;
  chi_tet_plane plane; /* beside them, which then are of its bound */
  chi_tet_reduction reduction;
  chi_tet_cache cache;
  chi_tet_cache_key cached;
  chi_tet_occlusion* occlusion; /* NULL before it is first asked for */
  double cell;                  /* cube root of the mesh's volume a cell, world units */
  chi_buffer shades;            /* float [tetrahedra][6] */
  chi_buffer image;
  int32_t width, height;
  int32_t bits; /* of the keys */
  int has_mesh, has_values, has_choice, has_view, has_bins, has_image;
  chi_tet_grid_key grid;
  chi_tet_field_key field;
  chi_tet_choice_key choice;
  chi_tet_view_key view;
  chi_tet_bin_key bin;
  chi_tet_draw_key drawn;
  chi_tet_tally tally; /* of the picture */
  /* of chi_tet_describe */
  uint64_t versions[4]; /* of the points, the sequence, the vertices, the values */
  chi_tet_described_key described;
  uint64_t frame_version;
  uint64_t sequenced;   /* version of the sequence that is made; 0: none */
  chi_buffer sequence;  /* uint32 */
  chi_buffer integrals; /* double [entries][4] of the tables, where small ones are splatted */
  size_t sequence_count;
  chi_tet_stats stats;
};

/* A frame in structs of our own, whichever version its caller was compiled for. */
typedef struct chi_tet_own_frame
{
  chi_tet_frame frame;
  chi_camera camera;
  chi_grid_view grid;
  chi_tet_field field;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_tet_params params;
  chi_shading_view shading;
} chi_tet_own_frame;

enum
{
  CHI_TET_STAGES = 4 /* split, values, view, bins */
};

/* The frame as one of ours, checked (chi_tet_check.c). The grid, the arrays and the transfer
 * function are checked in full by the stages that read them. */
chi_status chi_tet_adopt_frame(chi_tet_own_frame* own, const chi_tet_frame* given);

/* chi_tet_stages.c: */
double chi_tet_now(void);
/* Whether a stage has to run: always, where nothing may be kept. */
int chi_tet_differs(const chi_tet* tet, const chi_tet_frame* f, int has, const void* old,
  const void* key, size_t size);
/* All stages before pixels. A picture of what they were before is lost, unless the frame is
 * refused: then a stage is left to be run again, which no later picture is drawn without. */
chi_status chi_tet_prepare(const chi_exec* exec, chi_tet* tet, const chi_tet_frame* f);
/* A frame of fewer pixels in place of the one asked for, where that is asked for. */
chi_status chi_tet_reduce_frame(const chi_exec* exec, chi_tet* tet, chi_tet_own_frame* own);
/* `full`: of the picture that is handed out. */
chi_tet_draw_key chi_tet_key_of_draw(
  const chi_tet* tet, const chi_tet_frame* f, const chi_camera* full);
void chi_tet_report(chi_tet_stats* stats, const chi_tet_tally* tally);

#endif
