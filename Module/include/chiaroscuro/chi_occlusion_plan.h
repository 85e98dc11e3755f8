/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_PLAN_H
#define CHI_OCCLUSION_PLAN_H

/*
 * A frame as the core's own engine carries it out, for engines on other devices: where slices and
 * slabs lie, how light moves from one to the next, what samples become in the tables, what surfaces
 * block, and which parts of the picture anything happens in. Whoever executes it slab by slab, as
 * theory/occlusion.md says, makes the picture of chi_occlusion_render but for rounding.
 */

#include "chi_occlusion.h"
#include "chi_shading.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** Bits of chi_occlusion_plan.features: what the frame asks for that not every engine can do. */
enum
{
  CHI_FEATURE_PUBLISHED = 1, /**< the published blur, one buffer for all directions */
  CHI_FEATURE_OTHER = 2,     /**< a parameter that the plan has no member for */
  CHI_FEATURE_LAYERS = 4,    /**< translucent geometry between the slices */
  CHI_FEATURE_CROP = 8,      /**< cropping regions */
  CHI_FEATURE_COLORED = 16,  /**< light that is attenuated by channel */
  CHI_FEATURE_SHADING = 32,
  CHI_FEATURE_GRADIENT_OPACITY = 64,
  CHI_FEATURE_EDGES = 128,          /**< pixels that a surface covers in part */
  CHI_FEATURE_TRANSFER_PLANE = 256, /**< colour and opacity over two quantities */
  CHI_FEATURE_MASK = 512,           /**< masks, blanking, labels */
  CHI_FEATURE_REDUCTION = 1024,     /**< a smaller picture, enlarged */
  CHI_FEATURE_COMPONENTS = 2048
};

enum
{
  CHI_PLAN_DIRECTIONS = 128,
  CHI_PLAN_VICINITY = 118,
  CHI_PLAN_GRIDS = 2
};

/** Half-open; empty where x0 >= x1 or y0 >= y1. */
typedef struct chi_rect
{
  int32_t x0, y0, x1, y1;
} chi_rect;

/** How one direction's light moves into a slab: light (q) = sum of weight[k] times light (q + x +
 * (k & 1), q + y + (k >> 1)) of the slab before; 1 from outside the light buffer. */
typedef struct chi_plan_shift
{
  int32_t x, y;
  float weight[4];
} chi_plan_shift;

/** Table of extinction, sixteen bytes an entry, so that a look-up touches one cache line. Sums are
 * fixed-point: differences are exact, however far apart. At entry i + f it is sigma + 2 f
 * half_slope, its integral from 0 is quantum sum + f (sigma + f half_slope). */
typedef struct chi_plan_entry
{
  int32_t sum;
  float sigma, half_slope, reserved;
} chi_plan_entry;

/** Table of extinction times colour: its integral from 0 to entry i + f is quantum sum + rgb f
 * (sigma + f half_slope), with chi_plan_entry's sigma. */
typedef struct chi_plan_color
{
  int32_t sum[4]; /**< of each channel; the last is 0 */
  float rgb[4];   /**< mean colour up to the next entry, weighted by extinction */
} chi_plan_color;

/** What light travels, and what blocks it. Field 0 reaches samples of the volume, surface_field
 * surfaces. */
typedef struct chi_plan_field
{
  int32_t volume, geometry;
} chi_plan_field;

/** How light of one factor of the optical thickness is attenuated. */
typedef struct chi_plan_channel
{
  float attenuation; /**< that factor */
  float mean_length; /**< mean path a unit depth, times that factor */
  float thin;        /**< thickness below which that of a light pixel is the plain mean */
  float reserved;
} chi_plan_channel;

/** One bit a cell: what lies in it stays. Cell (i, j, k) holds the index positions that are (i, j,
 * k) after adding `offset` and rounding down. */
typedef struct chi_plan_grid
{
  const uint32_t* bits; /**< cell n = i + step_y j + step_z k: bit n & 31 of word n >> 5 */
  int32_t step_y, step_z;
  int32_t last[3];
  float offset; /**< 0.5: voxels about samples; 0: cells between them */
} chi_plan_grid;

/**
 * What is left of the volume besides box and clip planes (chi_mask.h). A segment is parted where it
 * crosses planes of regions and faces of cells: of each axis and grid, the first face and the last.
 * It counts by the length of what is left, and its sample lies where its last part without a gap
 * ends, or, of nearest samples, in that part's middle. Where `ahead` before its near slice nothing
 * is left, the ray begins anew.
 */
typedef struct chi_plan_cut
{
  uint32_t regions;  /**< that stay, bit x + 3 y + 9 z; CHI_CROP_ALL_REGIONS: all */
  float plane[6][4]; /**< index units: low x, high x, low y, ... */
  int32_t grids;     /**< a point must stay in all of them */
  chi_plan_grid grid[CHI_PLAN_GRIDS];
  const uint8_t* whole; /**< [bricks]: nothing is masked within a step of the brick; null where
                           there is no grid */
  float ahead;          /**< slices */
} chi_plan_cut;

/** A light of chi_shading.h; its colours times the material's share. */
typedef struct chi_plan_light
{
  int32_t kind;       /**< CHI_LIGHT_... */
  float direction[3]; /**< of unit length */
  float position[3];
  float diffuse[3], specular[3];
  float attenuation[3];
  float cone_cosine; /**< negative: it shines everywhere */
  float exponent;
} chi_plan_light;

/**
 * What the gradient in the middle of a segment does, eye coordinates. A difference is that of the
 * interpolated scalar over one sample to either side, the border's own samples standing in for
 * those beyond it; not finite ones are 0.
 */
typedef struct chi_plan_shading
{
  float to_eye[3][4];   /**< index position to eye coordinates */
  float gradient[3][3]; /**< differences along the index axes to the gradient, shares of the
                           table's range a mean voxel */
  int32_t lit;          /**< 0: no lights, none of the members up to `light` */
  int32_t two_sided, shiny, light_count; /**< shiny 0: no light has a highlight */
  float ambient, ambient_light[3], power;
  float limit; /**< of a colour; may be infinite */
  chi_plan_light light[CHI_MAX_LIGHTS];
  /** Opacity by the gradient, NULL: 1. Table position = magnitude gradient_scale, up to
   * gradient_end, one less than its entries. Extinction is multiplied by it. */
  const float* gradient_opacity;
  float gradient_scale, gradient_end;
  /* Extinction and colour over two quantities, NULL: none. Row of the tables = ((gradient's
   * magnitude, or what plane_second says, in the segment's middle) - plane_base) plane_scale, 0 ...
   * plane_end; each row is as `table` and `rgba` of the plan, whose own are but a bound. Extinction
   * of a segment, and colour of its middle, are mixed from the two rows about the place. */
  const chi_plan_entry* plane_table; /**< [plane_end + 1][plane_row] */
  const float (*plane_rgba)[4];      /**< likewise */
  const float* plane_second;         /**< as many as the samples, in their order, of the caller:
                                        what is not finite is transparent; NULL: the gradient */
  float plane_quantum, plane_base, plane_scale, plane_end;
  int32_t plane_row; /**< as many as the plan's entries */
} chi_plan_shading;

/** A component besides the plan's own; its samples lie, and are of the type, as the plan's. */
typedef struct chi_plan_component
{
  const void* scalars;
  float base, scale, offset;   /**< place in its table = (scalar - base) scale + offset */
  float end;                   /**< last place */
  float quantum;               /**< of its table's sums */
  int32_t entries;             /**< of table and rgba, where there are any */
  const chi_plan_entry* table; /**< null: the place itself is a part of a colour */
  const float (*rgba)[4];
} chi_plan_component;

/**
 * Several components (chi_components.h); the plan's own is the first, or, of dependent ones, the
 * last. Independent: of a segment the mean extinction of each, and the colour of the middle between
 * the places at both ends; the plan's own colour as that of a single component. Dependent: colours
 * of the segment's middle. Where a component that counts is not finite there is nothing. Nearest
 * samples of all lie where the plan's own does.
 */
typedef struct chi_plan_components
{
  int32_t dependent, count;         /**< count: of `more` */
  float weight[CHI_MAX_COMPONENTS]; /**< of independent ones, the plan's own first; 0: it does not
                                       count */
  chi_plan_component more[CHI_MAX_COMPONENTS - 1];
} chi_plan_components;

typedef struct chi_occlusion_plan
{
  size_t struct_size;
  uint64_t features; /**< CHI_FEATURE_...; an engine that lacks one of them must not draw */
  uint64_t frame_version, volume_version,
    table_version; /**< differ from those of this handle's last plan where anything, the samples,
                      the tables have changed */

  /* Picture and light buffers, pixels. */
  int32_t width, height, light_scale, light_width, light_height;
  int32_t parallel;
  /** Index position of (pixel x, pixel y, depth z): origin + z axis + (parallel ? 1 : z) (x along_x
   * + y along_y) */
  double origin[3], axis[3], along_x[3], along_y[3];
  double box_low[3], box_high[3];      /**< of the volume, index units */
  double clip[CHI_MAX_CLIP_PLANES][4]; /**< index units, kept where a x + b y + c z + d >= 0 */
  int32_t clip_count;
  int32_t directions;
  double slope_x, slope_dx, slope_y, slope_dy; /**< of the pixel's ray: slope_x + x slope_dx */

  double start, slice, slab; /**< depth of slice 0; world distance of slices and of light planes */
  int64_t group, slabs;      /**< segments a slab; slabs */
  int64_t volume_begin, volume_end; /**< slabs with samples */
  double bias;                      /**< slabs */
  double sample_bias;               /**< of matter, counted from its segment's near slice; slabs */
  int64_t ring;                     /**< planes of visibility that are still read */
  double saturated; /**< transmittance below which a ray is done; 0 where nothing is skipped */
  double strength;

  /* Volume; scalars is null without one. */
  const void* scalars; /**< [z][y][x], of the caller or a copy */
  chi_type type;       /**< CHI_U8, CHI_I16, CHI_U16 or CHI_F32 */
  int32_t nearest;
  size_t dimensions[3];
  float table_base, table_scale, table_offset; /**< entry = (scalar - base) scale + offset */
  float quantum;
  size_t entries;              /**< of all tables */
  const chi_plan_entry* table; /**< [entries] */
  const float (*rgba)[4];      /**< [entries] colours at the nearest entry */
  const uint8_t* occupied;     /**< [bricks z][y][x] of brick_edge^3 cells */
  size_t bricks[3];
  int32_t brick_edge;
  int32_t use_bricks; /**< 0: sample everything */

  /* Light. */
  float direction[CHI_PLAN_DIRECTIONS][2]; /**< slopes */
  float share[CHI_PLAN_DIRECTIONS];        /**< of the visibility */
  int32_t channels;      /**< 1 ... 3 sets of light buffers, of light that is attenuated alike */
  int32_t channel_of[3]; /**< that red, green and blue see */
  chi_plan_channel channel[3]; /**< [channels] */
  double light_pixels[2];      /**< light pixels a unit of shift and slope */
  /** Of light pixels -1, 0, 1 at offsets -1/4, 0, 1/4 from the middle one */
  double light_weight[3][3];
  chi_plan_field field[2];
  int32_t fields, surface_field;
  const chi_plan_shift* shift; /**< [slabs][directions] */

  /* Surfaces, [height][width]; null without any. Infinite where there is none. */
  const float (*surface)[4]; /**< depth in slices; plane of light planes that is received; slabs
                                that it begins and ends to block */
  const float (*surface_more)[4]; /**< share of light that it blocks a slab; shift, in units of
                                     slope, from the last slab's end; depth, world units, and that
                                     of what rays end at, which differ where a pixel is covered in
                                     part */

  /* Vicinity; 0 samples: none. */
  int32_t vicinity_samples, vicinity_plane_rule, combine;
  int32_t lights;                               /**< 1 or 2 */
  float vicinity_disc[2][CHI_PLAN_VICINITY][2]; /**< of each light, in radii */
  double vicinity_radius[2], vicinity_share[2]; /**< world units; of all light */
  double vicinity_distance;                     /**< world units */
  double vicinity_bias;                         /**< world units, where not the plane rule holds */
  double vicinity_pixels[2]; /**< pixels a world unit (parallel), or a unit of slope */
  double vicinity_curvature, vicinity_rise, vicinity_fade; /**< of the plane rule */

  /* Where anything happens. */
  const chi_rect* samples;  /**< [slabs] pixels */
  const chi_rect* blockers; /**< [slabs] light pixels whose geometry blocks */
  const chi_rect* light;    /**< [slabs] light pixels to be updated; all others are 1 or not read */
  const chi_rect*
    receivers;     /**< [slabs] pixels whose surface lies between the planes g - 1 and g */
  chi_rect beyond; /**< pixels whose surface lies behind the last plane */

  /* Colour between two scalars (theory/occlusion.md, Eq. 1a). A segment that crosses more than
   * color_step entries, and that many times its weight for the eye more than color_worth
   * color_step, has its colour integrated; others have that of their middle, rgba. */
  const chi_plan_color* colors;     /**< [entries] */
  float color_step;                 /**< infinite: never */
  float color_worth;                /**< share of color_step */
  float color_thin;                 /**< optical thickness that series are for */
  int32_t color_parts, color_steps; /**< parts of a segment, and steps by which they are found */
  int32_t color_even; /**< times color_step that a segment crosses at most with even parts */

  /* Enlargement. A reduction n > 1: all of the above describes a picture of n times fewer pixels a
   * side. Full pixel (x, y) lies at (x - reduced_pixel, y - reduced_pixel) / n of it, not below 0.
   * The four small pixels about that place have the bilinear weights over 1 + d^2, and add up to 1,
   * where d is the difference of the guide at the full pixel and at the one that stands for the
   * small one: (n i + reduced_pixel, n j + reduced_pixel), within the picture. The visibility is
   * the mean of those with a surface, 1 where the full pixel or all of these have none. */
  int32_t reduction, reduced_pixel;
  int32_t full_width, full_height; /**< of the picture that is handed out, reduced or not */
  const float* guide; /**< [full_height][full_width] depth of the surface in slabs, infinite where
                         there is none; null without any surface */
  double guide_far;   /**< what infinite stands for in d */

  const chi_plan_shading* shading; /**< NULL: gradients do nothing */

  /* Translucent layers, and parts of pixels that a surface covers, which are as such. At its depth
   * f of the way through a segment's samples the transmittance T there is T q^f of the segment's
   * T q; it takes its alpha of that, and adds as much of its colour, times its light: the
   * visibility of field surface_field at its plane, and strength, as of a surface. */
  int32_t layers; /**< of a pixel at most; 0: the next are null or empty */
  /** [layers][height][width], the nearest first: depth in slices, infinite where there is none;
   * alpha; plane of light planes that is received; shift, in units of slope, from the last slab's
   * end */
  const float (*layer)[4];
  const float (*layer_rgba)[4];    /**< likewise; premultiplied */
  const chi_rect* layer_spots;     /**< [slabs] pixels with layers in it, or in front of slab 0 */
  const chi_rect* layer_receivers; /**< [slabs] pixels with layers between the planes g - 1 and g */
  chi_rect layers_beyond;          /**< pixels with layers behind the last plane */

  const chi_plan_cut* cut; /**< NULL: nothing is cut */

  /* The published rule. Where it is set, there is one light buffer for all directions, which are
   * taps of a blur: its light is the sum of shares times what the shifts bring of it, attenuated as
   * that of one direction of slope `path`. Behind the last plane taps are as directions, of the one
   * buffer. */
  int32_t published;
  float path[2];

  /* Labels. The tables lie one after the other in `table` and `rgba`; a sample takes that of the
   * voxel about it. Where it is not that of the sample before, the ray begins anew. */
  const uint8_t* labels; /**< [samples] table of each voxel; NULL: there is one table */
  size_t table_entries;  /**< of one table */
  uint64_t mask_version; /**< differs from that of this handle's last plan where cells that are
                            left, or labels, have changed */

  const chi_plan_components* components; /**< NULL: there is one */
} chi_occlusion_plan;

/** Samples of one slab: rays, and the light planes that they read. */
typedef struct chi_plan_slab
{
  float pixel[2]; /**< that the rays are counted from */
  /** Index position of pixel (x, y) of this one, s slices behind the slab's first one: position + x
   * position_x + y position_y + s (direction + x direction_x + y direction_y) */
  float position[3], position_x[3], position_y[3], direction[3], direction_x[3], direction_y[3];
  int32_t is_lit; /**< 0: visibility is 1 */
  int32_t reserved;
  int64_t first_plane; /**< light plane that the first slice reads, or the one after it; before
                          plane 0 visibility is 1 */
  float plane[3];      /**< place of the first slice between planes, from first_plane; its change a
                          slice; its most */
} chi_plan_slab;

/** Infallible; 0 <= slab < plan->slabs. */
CHI_API void chi_occlusion_plan_slab(
  const chi_occlusion_plan* plan, int64_t slab, chi_plan_slab* out);

/**
 * Describe a frame without carrying it out.
 *
 * @param[out] plan  owned by the handle but for the samples, valid until its next call
 *
 * Arguments, status and what is kept between frames are those of chi_occlusion_render; the last
 * picture stands unless memory runs out. Probes are not served.
 *
 * Cost  surfaces: 8 floats a pixel; slabs x directions; bricks and tables where they have changed.
 */
CHI_API CHI_NODISCARD chi_status chi_occlusion_describe(const chi_exec* exec,
  chi_occlusion* occlusion, const chi_occlusion_frame* frame, chi_occlusion_plan* plan);

/** The features of a frame, as its plan would have them, without making one; of any frame that
 * chi_occlusion_render takes. */
CHI_API uint64_t chi_occlusion_features(const chi_occlusion_frame* frame);

/** What a feature bit stands for, to be read by users: "the published occlusion method". Never
 * NULL. */
CHI_API const char* chi_occlusion_feature_name(uint64_t feature);

#ifdef __cplusplus
}
#endif
#endif
