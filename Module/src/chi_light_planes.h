/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_LIGHT_PLANES_H
#define CHI_LIGHT_PLANES_H

/*
 * Light planes: how a cone of light travels through the slabs of a scene, whatever the matter in
 * them. Whoever draws (the march through a volume, tetrahedra) says what optical thickness each
 * pixel's slab has, asks for the light of the slab, and reads visibility at any depth that light
 * has passed. Doc: theory/occlusion.md, Eq. 2 to 5.
 */

#include "chi_occlusion_internal.h"

/* Planes of a surface, floats a pixel. */
enum
{
  SURFACE,
  RECEIVER, /* depth from which the surface's bias counts */
  BLOCK_BEGIN,
  BLOCK_END,
  GEOMETRY_PLANES
};

/* Planes of light pixels for the slab at hand. */
enum
{
  LIGHT_TAU = 0,
  GEOMETRY,
  LIGHT_PLANES
};

/* Share of the light that may be missing where all of it is taken to be there. */
#ifndef CHI_LIGHT_LOSS
#  define CHI_LIGHT_LOSS 0x1p-20f
#endif

/* What is known of the light of CHI_SEGMENT pixels, all directions. Joined by or. */
enum
{
  TILE_BRIGHT = 1, /* 1 throughout */
  TILE_DARK = 2,   /* 0 throughout */
  TILE_MIXED = 3
};

/* The surfaces of a piece, in the order of the steps that serve them. */
typedef struct chi_light_served
{
  double plane;  /* of the next one; INFINITY: all are lit */
  int32_t last;  /* step that lights the last one, those behind the last plane included; -1: none */
  int32_t next;  /* the first one that is not lit yet */
  int32_t count; /* that some step serves: entries of its order */
} chi_light_served;

typedef struct chi_light_planes
{
  const chi_exec* exec;
  const chi_scene* scene;
  const chi_occlusion_params* params;
  const chi_occlusion_kernels* kernels;
  int skip;                    /* CHI_SKIP_... kinds that are on */
  chi_light_field (*field)[3]; /* [fields][channels] */
  int fields;
  size_t stride, rows; /* of pixels: floats from row to row; rows that fill light pixels */
  /* Light: [rows][directions][light_stride], so that a row of all directions is contiguous (pages,
   * cache sets); visibility: [ring][rows][light_stride]. Origins: pixel (0, 0) within the padding.
   */
  size_t light_stride, light_row, light_plane, light_origin, visibility_origin;
  int64_t ring;
  int segments, shift_segments; /* of a row; to either side that light may come from */
  int skew;                     /* rows that light moves by in a slab, at most */
  double* reach;                /* [slabs + 1] light pixels that light can have moved */
  ptrdiff_t* step_offset;       /* [slabs][directions] shift of one slab */
  float (*step_weight)[4];      /* [slabs][directions] */
  float* scratch;               /* [LIGHT_PLANES][light rows][light_stride] */
  float dark_below;             /* visibility of a tile that is dark in all directions */
  /* The matter of a slab and of the one before, which take turns: of the picture's pixels, along
   * the view axis. The caller's. */
  float* tau[2];     /* of even and of odd slabs */
  size_t tau_step;   /* floats from row to row */
  uint8_t* tau_flag; /* [light rows][segments] of the slab at hand: there is any */
  /* The geometry that blocks light; NULL: none. */
  float* surfaces;    /* [rows][GEOMETRY_PLANES][stride] */
  uint64_t* blocking; /* [light rows][segments][blocking_words] bits, of slab >>
                         blocking_shift, that behind the last one too: a surface may block in it */
  int blocking_words, blocking_shift;
  chi_light_served* served; /* [light rows][segments] */
  uint8_t* order;           /* [light rows][segments][CHI_SEGMENT scale^2] its surfaces' pixels */
  size_t bytes;             /* of light */
} chi_light_planes;

typedef struct light_counts
{
  int64_t updates, uniform, unreached;
} light_counts;

/* Floats from row to row, and rows, of what has a value a pixel. */
size_t chi_light_stride(const chi_scene* scene);
size_t chi_light_rows(const chi_scene* scene);

/* Where everything lies: from exec, scene, params, kernels and skip, which are set. */
void chi_light_layout(chi_light_planes* planes);
/* Memory of steps and scratch, of what is known of surfaces where there are any, and of as many
 * fields, bright throughout. */
chi_status chi_light_prepare(
  chi_light_planes* planes, chi_light_buffers* keep, int fields, int surfaces);
void chi_light_free(const chi_exec* exec, chi_light_buffers* keep);

/* One slab of all fields for rows of light pixels, [begin, end); need[segment]: something may still
 * receive it. Bands of rows may run side by side. */
void chi_light_band(const chi_light_planes* planes, int64_t slab, const int64_t rows[2],
  const uint8_t* need, light_counts* counts);

/* Visibility of a run of pixels between light planes at `plane`, weakened by `strength`; NULL where
 * all of it is 1. Pieces are read in whole vectors beyond x_end. */
const float* chi_light_read_row(const chi_light_planes* planes, const chi_light_field* field,
  double plane, float strength, int64_t y, int x_begin, int x_end, float* out);

/* Geometry, chi_light_block.c. Which slabs it touches: the body of a parallel loop over light rows,
 * of chi_light_planes. */
void chi_light_touch_rows(void* planes, size_t begin, size_t end);
/* Its transmittance in a slab, a segment of light pixels; 0 when nothing blocks. */
int chi_light_block(
  const chi_light_planes* planes, int64_t slab, int64_t by, int segment, float* out);
/* The next of a piece's surfaces that a step of the march serves: its pixel, and the plane that it
 * reads; 0 when there is none. Steps come in their order. */
int chi_light_serve(const chi_light_planes* planes, int64_t step, int64_t by, int segment,
  int64_t* x, int64_t* y, double* plane);
/* The step that can serve visibility at this depth: both planes about it are then complete, with a
 * row to spare on either side. */
double chi_light_receiver_plane(const chi_scene* scene, double slices);

static inline float* surface_row(const chi_light_planes* l, int which, int64_t y)
{
  return l->surfaces + ((size_t)y * GEOMETRY_PLANES + (size_t)which) * l->stride;
}

/* Optical thickness of a row in a slab; that of the slab before is there as well. */
static inline float* tau_row(const chi_light_planes* l, int64_t slab, int64_t y)
{
  return l->tau[slab & 1] + (size_t)y * l->tau_step;
}

static inline float* light_scratch(const chi_light_planes* l, int which, int64_t y)
{
  return l->scratch +
    ((size_t)which * (size_t)l->scene->light_height + (size_t)y) * l->light_stride;
}

static inline float* row_of_light(
  const chi_light_planes* l, const chi_light_field* f, int64_t side, int64_t y)
{
  return (float*)f->light[side].data + l->light_origin + (size_t)y * l->light_row;
}

static inline int64_t ring_slot(const chi_light_planes* l, int64_t slab)
{
  return (int64_t)((uint32_t)slab % (uint32_t)l->ring); /* 64 bits take twice the time */
}

static inline float* visibility_row(
  const chi_light_planes* l, const chi_light_field* f, int64_t slab, int64_t y)
{
  return (float*)f->visibility.data + (size_t)ring_slot(l, slab) * l->light_plane +
    l->visibility_origin + (size_t)y * l->light_stride;
}

/* Flags of a row: sides 0 and 1 of the light, then the ring of visibility planes. */
static inline uint8_t* tile_row(
  const chi_light_planes* l, const chi_light_field* f, int64_t which, int64_t y)
{
  return (uint8_t*)f->tiles.data +
    (size_t)(which * l->scene->light_height + y) * (size_t)l->segments;
}

/*
 * Weights of three light pixels at an offset t from the middle one, |t| <= 1/2. Full size: linear.
 * Half size: light pixels are means of 2 x 2 pixels, so that what they say of a point is the
 * parabola that has these three means (hence 1/24); what it overshoots is cut to 0 ... 1. Linear
 * weights would blur once more (mean error on the brain, 16 directions: 0.0107).
 */
static inline void chi_light_weights(int scale, double t, double weight[3])
{
  const double low = t < 0 ? -t : 0, high = t > 0 ? t : 0;
  weight[0] = scale == 1 ? low : 0.5 * t * (t - 1) - 1.0 / 24;
  weight[1] = scale == 1 ? 1 - low - high : 1 - t * t + 1.0 / 12;
  weight[2] = scale == 1 ? high : 0.5 * t * (t + 1) - 1.0 / 24;
}

static inline void chi_fill_ones(float* out, int count)
{
  for (int i = 0; i < count; ++i)
  {
    out[i] = 1;
  }
}

#endif
