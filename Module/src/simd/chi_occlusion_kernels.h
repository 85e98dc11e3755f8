/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_KERNELS_H
#define CHI_OCCLUSION_KERNELS_H

/* The inner loops of the occlusion renderer, once per instruction set; chosen at load. */

#include <chiaroscuro/chi_occlusion_plan.h>

#include <stddef.h>
#include <stdint.h>

enum
{
  CHI_MAX_DIRECTIONS = 64, /* of a light */
  CHI_MAX_ORDINATES = 128, /* of all lights */
  CHI_CELL_WIDTH = 32,     /* pixels of the picture: granularity of empty-space tests */
  CHI_CELL_HEIGHT = 8,
  CHI_LINE = 64,   /* bytes of a cache line, of most processors: a matter of speed alone */
  CHI_SEGMENT = 32 /* light buffer pixels: granularity of light skipping; a multiple of all lanes */
};

/* Optical thickness below which a light pixel takes the plain mean of its four: the mean differs by
 * < 0.02^2 / 8 = 5e-5. */
#define CHI_THIN 0.02f

/* How samples lie in memory, for the kernels. */
enum
{
  CHI_FETCH_U8 = 0,
  CHI_FETCH_I16 = 1,
  CHI_FETCH_U16 = 2,
  CHI_FETCH_F32 = 3
};

/* How the colour of a segment is integrated; the plan hands this out to other engines. */
enum
{
  CHI_COLOR_PARTS = 4, /* of a segment, of equal weight for the eye */
  CHI_COLOR_STEPS = 8, /* by which they are found */
  CHI_COLOR_EVEN = 8   /* color_steps a segment may cross with parts that are even instead */
};
/* share of the bound that a colour must be worth to be integrated */
#define CHI_COLOR_WORTH 0.25f
/* optical thickness below which series stand for exponentials */
#define CHI_COLOR_THIN 0.05f

struct chi_sample_frame;

/* The components besides the row's own, and where their samples lie. */
typedef struct chi_component_frame
{
  chi_plan_components plan;
  const struct chi_sample_frame* more;
} chi_component_frame;

/* What all rows of a frame share when they sample. */
typedef struct chi_sample_frame
{
  const void* scalars;
  int fetch, nearest;
  int tinted;                /* non-zero: visibility differs by colour; general runs */
  int general;               /* non-zero: colours are not those of the table alone */
  int32_t step_y, step_z;    /* samples; 0 along an axis of one sample */
  int32_t step_x;            /* 1, or 0 along an axis of one sample */
  int32_t last_load;         /* largest byte offset of a four-byte load / sample size scale */
  int32_t last_cell[3];      /* dimensions - 2, at least 0 */
  float last_index[3];       /* dimensions - 1 */
  float low[3], high[3];     /* the volume's box, index units */
  float base, scale, offset; /* table position = (scalar - base) * scale + offset */
  float table_end;           /* count - 1 */
  float value_end;           /* the same of one table, where there are several */
  const uint8_t* labels;     /* [samples, padded] table of the voxel; NULL: there is one table */
  int32_t table_entries;     /* of one table */
  const chi_plan_entry* sigma;
  const float (*rgba)[4];
  const chi_plan_color* colors;
  float color_step; /* table entries a segment may cross before its middle's colour is too coarse */
  float quantum;
  const uint8_t* occupied; /* bricks of 8^3 cells, padded by four bytes */
  int32_t brick_step_y, brick_step_z;
  chi_plan_cut cut;
  float slice;                           /* world distance between slices */
  float saturated;                       /* transmittance below which a ray is done */
  const chi_plan_shading* shade;         /* NULL: no gradients are needed; else `general` is set */
  const struct chi_sample_frame* second; /* samples of shade->plane_second; NULL: the gradient */
  const chi_component_frame* components; /* NULL: one */
} chi_sample_frame;

/* Why samples inside the box were not taken. */
enum
{
  CHI_SPARED_EMPTY,
  CHI_SPARED_SATURATED,
  CHI_SPARED_HIDDEN,
  CHI_SPARED_KINDS
};

/* One row of pixels over one segment between two slices. */
typedef struct chi_sample_row
{
  const chi_sample_frame* frame;
  float position[3], position_x[3]; /* index position at the far slice: position + x * position_x */
  float direction[3], direction_x[3]; /* its change a slice */
  float length0, length_x, length_c;  /* |ray| = sqrt(c + (length0 + x length_x)^2) */
  float* color[3];
  float* transmittance;
  float* table_position; /* state at the near slice; NaN: not sampled */
  int32_t* sum;
  float* rest;
  float* tau;         /* optical thickness along the view axis, for the light */
  int new_tau;        /* non-zero: tau is to be set, as what is there is old; else added to */
  int cut;            /* non-zero: regions or masks cut something here; enter is set as well */
  const float* enter; /* slice units; NULL: the whole run lies inside the box */
  const float* leave;
  const float* surface;    /* slice units; NULL: no surface in front of the far slice */
  const float* visibility; /* NULL: 1 */
  const float* tint[3];    /* where `tinted`, in its place: of red, green and blue */
  float near_slice;        /* slice coordinate of the segment's start */
  int first;               /* non-zero: nothing was sampled before by definition */
  int bricks;              /* non-zero: test bricks */
  int restart;             /* non-zero: the state at the near slice is not valid */
  int saturated_too;       /* non-zero: sample saturated rays as well, their light is needed */
  int hidden_too;          /* non-zero: sample behind the surface as well */
  /* results, accumulated */
  int64_t taken, spared[CHI_SPARED_KINDS];
  int any_tau;
} chi_sample_row;

/* One segment of CHI_SEGMENT light pixels of one row, all directions. */
typedef struct chi_light_segment
{
  const float* source;      /* direction 0, this row and column, read side */
  float* target;            /* the same, write side */
  size_t plane;             /* floats from one direction to the next, both sides */
  const ptrdiff_t* offset;  /* [directions] first tap */
  const float (*weight)[4]; /* [directions] of the taps at 0, 1, stride, stride + 1 */
  size_t stride;
  int directions;
  const float* share;    /* [directions] weights in the visibility; NULL: all equal */
  float factor;          /* of the optical thickness */
  const float* tau;      /* NULL: none */
  const float* length;   /* [directions] path length a unit depth at the segment's first pixel */
  const float* length_x; /* its change a pixel */
  const float* geometry; /* transmittance of the geometry in this slab; NULL: 1 */
  float* visibility;
  float dark_below, bright_above;
} chi_light_segment;

/* What a kernel says of a segment's visibility. */
enum
{
  CHI_LIGHT_DARK = 1,  /* all of it is below dark_below */
  CHI_LIGHT_BRIGHT = 2 /* all of it is above bright_above */
};

/* Vicinity of one row's surfaces. */
typedef struct chi_vicinity_row
{
  const float* depth; /* [height][width], of what blocks; not positive or NaN: nothing there */
  int width, height, y;
  const float* receiver; /* [width], the row's surfaces; lanes that have none give anything */
  float pixels[2];       /* pixels a world unit (parallel), or a unit of slope */
  int parallel;
  int lights, count;       /* offsets of a light */
  const float* disc[2][2]; /* [light][axis][count], in radii */
  float radius[2];         /* world units */
  float share[2];          /* of all light that one offset blocks */
  float bias;              /* world units; 0: by the tangent plane, as follows */
  float curvature[2], rise, fade, inverse_distance;
  float* left; /* out, [end - begin] */
} chi_vicinity_row;

typedef struct chi_occlusion_kernels
{
  const char* name;
  int lanes;
  void (*sample)(chi_sample_row* row, int x_begin, int x_end);
  /* CHI_LIGHT_... */
  int (*light)(const chi_light_segment* segment);
  int (*blur)(const chi_light_segment* segment);
  void (*halve)(
    const float* const tau[2], const float* const before[2], float length, float* out, int count);
  void (*path_lengths)(const float* slope_x, const float* slope_y, int directions, float px,
    float py, float px_step, int count, float* length, float* length_x);
  /* The farthest surface of the pixels whose transmittance is above a limit; INFINITY: some have
   * none, or `surface` is NULL; -INFINITY: there is no such pixel. Rows are read in whole vectors.
   */
  float (*farthest)(const float* transmittance, const float* surface, float limit, int count);
  /* Light that surfaces which block all of it let through in a slab, by the intervals of one row of
   * pixels or two; 0: all of it. */
  int (*block)(
    const float* const begin[2], const float* const end[2], int scale, float slab, float* out);
  void (*enlarge)(const float* const* rows, const float* weight, int row_count, float base,
    int scale, int begin, int end, float* out);
  void (*vicinity)(const chi_vicinity_row* row, int begin, int end);
} chi_occlusion_kernels;

extern const chi_occlusion_kernels chi_kernels_generic;
#if defined(__x86_64__) && defined(__GNUC__)
extern const chi_occlusion_kernels chi_kernels_avx2;
extern const chi_occlusion_kernels chi_kernels_avx512;
#endif

/* The widest set that this processor runs; CHIAROSCURO_ISA=generic|avx2|avx512 asks for less. */
const chi_occlusion_kernels* chi_kernels(void);

#endif
