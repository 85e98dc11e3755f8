/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_MARCH_H
#define CHI_OCCLUSION_MARCH_H

/* What the parts of the march share; chi_occlusion_march.c says how it goes. */

#include "chi_light_planes.h"

#include <stdatomic.h>

enum
{
  MAX_BLOCK = 16, /* slabs a task takes at most */
  BAND = 16       /* light rows a task takes */
};

/* Picture-sized planes of floats, in this order in chi_march.planes. */
enum
{
  RED,
  GREEN,
  BLUE,
  TRANSMITTANCE,
  TABLE_POSITION,
  SUM,
  REST,
  TAU,
  TAU_OTHER, /* slabs take turns: the one before is still needed */
  ENTER,
  LEAVE,
  VOLUME_PLANES,                    /* those of the surface lie where the picture will be */
  LAYER_SLOTS = CHI_MAX_LAYERS + 1, /* a surface's edge is one more */
  LAYER_DEPTH = 0,                  /* of chi_march.layers, a slot each: slices; INFINITY: none */
  LAYER_WEIGHT = LAYER_DEPTH + LAYER_SLOTS,            /* transmittance in front of the layer */
  LAYER_VISIBILITY = LAYER_WEIGHT + LAYER_SLOTS,       /* before strength; a channel */
  LAYER_RECEIVER = LAYER_VISIBILITY + 3 * LAYER_SLOTS, /* depth from which the edge's bias counts */
  LAYER_RED = LAYER_RECEIVER + 1,                      /* and green, blue, transmittance: */
  LAYER_PLANES = LAYER_RED + 4                         /* a row before it is sampled */
};
_Static_assert(GEOMETRY_PLANES <= 4, "the surface's planes lie in the picture's channels");

/* What a cell of pixels needs in a block of slabs. */
enum
{
  CELL_EMPTY = 0,
  CELL_OCCUPIED = 1,
  CELL_CROSSES_BOX = 2,
  CELL_MIXED = 4,
  CELL_CUT = 8 /* regions or masks cut something */
};

/* What the rays of a cell's row are up to. */
enum
{
  RAYS_SATURATED = 0,
  RAYS_LIVE = 1,
  RAYS_BEHIND_GEOMETRY = 2 /* some of them; none is live */
};

/* One frame's march: borrowed scene, buffers of chi_march, and the state that tasks share. */
typedef struct march
{
  const chi_exec* exec;
  const chi_scene* scene;
  const chi_occlusion_frame* frame;
  const chi_occlusion_kernels* kernels;
  chi_march* keep;
  chi_sample_frame sample, second;
  chi_plan_shading shade;
  const chi_bricks* bricks;
  const chi_classification* classification;
  chi_sample_frame more[CHI_MAX_COMPONENTS - 1];
  chi_component_frame component_frame;
  float* planes;    /* [rows][VOLUME_PLANES][stride] */
  float* band_rows; /* [bands][channels][stride] */
  float* seen;      /* [height][width] visibility of the picture's surfaces; see next */
  float* tint;      /* [channels][rows][stride] the same; unused with one channel */
  size_t plane;
  chi_light_planes light; /* its surfaces lie in the memory of the picture */
  int block, bands;
  int64_t blocks;
  int lag; /* bands by which a block must lead the next one */
  int cells_x, cells_y;
  uint8_t* cells;          /* [blocks][cells_y][cells_x] */
  int32_t* last_cell;      /* [cells_y][cells_x] last slab that is not empty; -1: all are */
  int64_t (*last_slab)[2]; /* [bands][segments]: of samples, of surfaces that are yet to be lit */
  int32_t* until;     /* [blocks][bands][segments] last slab in which a ray that is live may meet
                         something, as known after the block; -1: none */
  uint8_t* live_row;  /* [rows][cells_x] RAYS_... */
  int64_t* sampled;   /* [rows][cells_x] segment sampled last */
  uint8_t* tau_stale; /* [2][rows][cells_x] the cell holds the thickness of an earlier slab */
  uint8_t* need;      /* [bands][segments] */
  int64_t* order;     /* [tickets][2] block, band */
  atomic_uchar* done; /* [blocks][bands] */
  int layers;         /* slots in use: translucent ones, then the edge; 0: the next are not there */
  float* layer_planes; /* [rows][LAYER_PLANES][stride] */
  float* layer_next;   /* [rows][cells_x] depth of the nearest layer that is not blended yet */
  float* layer_steps;  /* [light rows][segments][2] first and last step that lights a layer */
  uint8_t* layer_done; /* [rows][stride] bits: slots of a pixel that are blended */
  int surface_field;
  double receiver_weight[2][2][9]; /* see chi_march_place_weights */
  int skip;                        /* CHI_SKIP_... kinds that are on */
  int shaded;
  float strength;
  atomic_size_t ticket;
  atomic_int cancelled;
  atomic_llong samples, light_updates, nanoseconds[2];
  atomic_llong skipped[CHI_SKIP_KINDS];
} march;

static inline float* picture(const march* m, int which, int64_t y)
{
  return m->planes + ((size_t)y * VOLUME_PLANES + (size_t)which) * m->light.stride;
}

/* Visibility of a row of pixels, one slice's: of a band, at whose row only one task is at a time.
 */
static inline float* row_visibility(const march* m, int channel, int band)
{
  return m->band_rows + (size_t)(band * m->scene->channels + channel) * m->light.stride;
}

/* Visibility of a row's surface in a channel of light: of the picture itself where there is one. */
static inline float* surface_visibility(const march* m, int channel, int64_t y)
{
  return m->scene->channels == 1
    ? m->seen + (size_t)y * (size_t)m->scene->width
    : m->tint + ((size_t)channel * m->light.rows + (size_t)y) * m->light.stride;
}

/* chi_occlusion_plan.c */
chi_status chi_march_plan(march* m);

/* chi_occlusion_visible.c; the first two are bodies of parallel loops over rows, and over blocks x
 * rows of cells */
void chi_march_intersect_rows(void* data, size_t begin, size_t end);
void chi_march_classify_blocks(void* data, size_t begin, size_t end);
void chi_march_band_rows(const march* m, int band, int64_t rows[2]);
void chi_march_last_cells(march* m);
void chi_march_last_slab(const march* m, int band, int segment, int64_t last[2]);

/* chi_occlusion_receivers.c; light_rest is the body of a parallel loop over rows */
void chi_march_place_weights(int scale, double weight[2][2][9]);
void chi_march_light_surfaces(const march* m, int64_t step, int64_t by);
void chi_march_light_rest(void* data, size_t begin, size_t end);
void chi_march_read_probes(const march* m, int64_t step, int64_t begin, int64_t end);
void chi_march_read_last_probes(const march* m);

double chi_march_visibility(const march* m, int channel, double slices, int64_t x, int64_t y);

/* chi_layers.c; the first, third and last are bodies of parallel loops over rows, light rows and
 * rows */
chi_status chi_layers_plan(march* m);
void chi_layers_light(const march* m, int64_t step, int64_t by);
void chi_layers_light_rest(void* data, size_t begin, size_t end);
int chi_layers_before(march* m, chi_sample_row* row, int64_t y, int first_cell, int end_cell);
void chi_layers_after(march* m, chi_sample_row* row, int64_t y, int first_cell, int end_cell);
void chi_layers_finish(void* data, size_t begin, size_t end);

/* chi_occlusion_samples.c */
void chi_march_sample_row(march* m, int64_t slab, int64_t y, int band, chi_sample_row* row);

/* Table entries a segment of this frame may cross before its middle's colour is too coarse. */
float chi_march_color_step(const chi_scene* scene, const chi_classification* classification,
  const chi_occlusion_params* params);

#endif
