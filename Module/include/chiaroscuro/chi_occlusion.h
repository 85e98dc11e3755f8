/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_H
#define CHI_OCCLUSION_H

/*
 * Combined occlusion of a volume and opaque geometry, on slices perpendicular to the view axis.
 * Source: Schott, Martin, Grosset, Smith & Hansen, "Ambient Occlusion Effects for Combined Volumes
 * and Tubular Geometry", IEEE TVCG 19(6), 2013; the blur of its occlusion buffer is replaced by
 * discrete ordinates, one buffer a direction (Documentation/theory/occlusion.md says why).
 */

#include "chi_camera.h"
#include "chi_components.h"
#include "chi_mask.h"
#include "chi_shading.h"
#include "chi_surface.h"
#include "chi_transfer.h"
#include "chi_volume.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** A renderer: what it derived from the last frames is kept, and made anew only where its source
 * changed. One handle serves one thread of calls at a time. */
typedef struct chi_occlusion chi_occlusion;

enum
{
  CHI_OCCLUSION_ORDINATES =
    0, /**< one buffer a direction, each shifted by its own constant offset */
  CHI_OCCLUSION_PUBLISHED = 1 /**< one buffer, blurred in every slice (Schott et al. 2009, 2013) */
};

/** Who darkens whom; bits of chi_occlusion_params.interactions. */
enum
{
  CHI_VOLUME_TO_VOLUME = 1,
  CHI_VOLUME_TO_GEOMETRY = 2,
  CHI_GEOMETRY_TO_VOLUME = 4,
  CHI_GEOMETRY_TO_GEOMETRY = 8,
  CHI_ALL_INTERACTIONS = 15
};

enum
{
  CHI_MAX_CLIP_PLANES = 32
};

/** How a surface's light from the planes (partial) and from its vicinity become one. */
enum
{
  CHI_COMBINE_PRODUCT = 0, /**< Schott et al. 2013, Eq. 8 */
  CHI_COMBINE_MINIMUM = 1  /**< Eq. 7 */
};

/** Work that is left out because it changes no picture by more than 1/255; bits of
 * chi_occlusion_params.skip. Bit 0 stands for every kind, those of later versions included. */
enum
{
  CHI_SKIP_NOTHING = 0,
  CHI_SKIP_ALL = 1,
  CHI_SKIP_BRICKS = 2, /**< samples in bricks that the transfer function makes transparent */
  CHI_SKIP_SATURATED_RAYS = 4,    /**< samples of rays whose transmittance is below 0.002 */
  CHI_SKIP_BEHIND_GEOMETRY = 8,   /**< samples behind the surface */
  CHI_SKIP_CLIPPED = 16,          /**< cells and slabs that the clip planes cut away as a whole */
  CHI_SKIP_FOOTPRINT = 32,        /**< cells outside the volume's footprint */
  CHI_SKIP_SATURATED_LIGHT = 64,  /**< light that is uniformly 1 or 0 over a tile */
  CHI_SKIP_UNREACHED_LIGHT = 128, /**< light that no sample and no surface receives any more */
  CHI_SKIP_UNCHANGED = 256,       /**< bricks, classification and picture of the last frame, where
                                       their sources have not changed */
  CHI_SKIP_EVERY_KIND = 510,      /**< all of this version, to take single ones away from */
  CHI_SKIP_KINDS = 16             /**< length of chi_occlusion_stats.skipped */
};

/** Colour of the segment of a ray between two slices. */
enum
{
  CHI_COLOR_PREINTEGRATED =
    0,                 /**< what the eye gets of the transfer function between both scalars */
  CHI_COLOR_MIDDLE = 1 /**< that of the middle scalar */
};

typedef struct chi_occlusion_params
{
  size_t struct_size;
  int32_t method; /**< CHI_OCCLUSION_ORDINATES or _PUBLISHED */
  int32_t
    directions; /**< 1 ... 64, equal solid angle each; taps of the published rule; default 16 */
  int32_t half_size;    /**< non-zero: light buffers at half the picture's resolution; default 1 */
  int32_t interactions; /**< CHI_VOLUME_TO_VOLUME | ...; default all */
  double
    cone_angle_rad; /**< half angle of the cone of light, 1 ... 85 degrees; default 45 degrees */
  double strength;  /**< 0 = unshaded ray cast ... 1; default 1 */
  double sample_distance; /**< between slices along the view axis, world units; 0 = one voxel; with
                             a transfer function of two quantities at most one voxel */
  double bias;            /**< visibility is read so much nearer to the eye, world units; negative
                               (default) = 1.5 voxels for geometry and probes, and for matter
                               another half voxel, or half a slice where that is longer */
  double geometry_thickness; /**< geometry blocks the light so far behind its surface, world units;
                                  0 = one slab (default), INFINITY = Algorithm 3 of the paper */
  int32_t skip;              /**< CHI_SKIP_...; default CHI_SKIP_ALL */
  int32_t combine;           /**< CHI_COMBINE_...; default product */
  double geometry_opacity;  /**< share of the light that geometry blocks, 0 ... 1; default 1. Over a
                               finite thickness in all, over an infinite one in every slab */
  int32_t vicinity_samples; /**< of surfaces by surfaces nearby, 0 (none) ... 118; default 32. Part
                               of CHI_GEOMETRY_TO_GEOMETRY */
  int32_t reduction; /**< 2 ... 4: a picture of so many times fewer pixels a side, enlarged along
                        the edges of the surface's depth; 0, 1 = full (default). Not with probes */
  double vicinity_distance; /**< l_vicinity of Schott et al. 2013, world units: the radius is l tan
                               of the cone's angle; 0 = none (default) */
  double vicinity_bias;     /**< > 0: a neighbour blocks when nearer than the surface less so much,
                               world units, however near (the paper's rule); 0 = against the
                               surface's tangent plane, and up to l_vicinity (default) */
  /** To the light, the middle of the cone, in view coordinates: x to the right, y up, z to the eye;
   * any length, finite; all 0 = (0, 0, 1), from the eye's side (default). In perspective it turns
   * with each pixel's line of sight. More than 60 degrees off the view axis: brought to 60
   * (chi_occlusion_stats.moved_lights); from straight behind: to 60 above. What of a tilted cone is
   * more than 85 degrees off the view axis comes in at 85. */
  double light_direction[3];
  double second_light_direction[3];   /**< a further soft light, likewise */
  double second_light_cone_angle_rad; /**< its half angle, 1 ... 85 degrees; 0 = cone_angle_rad */
  double second_light_share; /**< its part in all light, 0 ... 1; 0 = none (default); with as many
                                directions again; not with the published rule, which has one light
                              */
  /** Coloured light: what passes through the volume loses exp(- factor x optical depth) in red,
   * green and blue, so that little in a channel lets that light through. Used where
   * colored_attenuation is non-zero, each finite and >= 0; else 1 (default). Costs a set of light
   * buffers for each factor that differs. Probes read the red light. */
  double attenuation[3];
  int32_t colored_attenuation;
  int32_t color_integration; /**< CHI_COLOR_...; default pre-integrated. Extinction is
                                pre-integrated with either */
  double coarsening; /**< slices so many times as far apart as sample_distance or a voxel says, 1
                        ... 64; 0 = 1 (default) */
} chi_occlusion_params;

/** Visibility at chosen points, for tests and for users who measure. */
typedef struct chi_occlusion_probes
{
  const double* position; /**< [count x 3]: x, y in pixels (centre of pixel i is i + 0.5), depth */
  float* visibility;      /**< [count] mean visibility of the cone, before strength, after bias; NaN
                               where the position is not finite */
  size_t count;
} chi_occlusion_probes;

/** One frame: all borrowed, none modified. */
typedef struct chi_occlusion_frame
{
  size_t struct_size;
  const chi_camera* camera;
  const chi_volume_view* volume;     /**< NULL: geometry alone */
  const chi_transfer_view* transfer; /**< required with a volume */
  const chi_surface_view* surface;   /**< NULL: no geometry */
  const chi_occlusion_params* params;
  const chi_occlusion_probes*
    probes; /**< NULL: none; a frame with probes is never taken as unchanged */
  /** The volume is cut: a sample stays where a x + b y + c z + d >= 0 of every plane, world
   * coordinates; what is cut away neither draws nor blocks light. */
  const double* clip_planes;     /**< [clip_plane_count x 4], not all of a, b, c zero */
  size_t clip_plane_count;       /**< 0 ... CHI_MAX_CLIP_PLANES */
  const chi_layers_view* layers; /**< NULL: no translucent geometry */
  const chi_crop_view* crop; /**< NULL: no regions are cropped; applies besides the clip planes */
  const chi_shading_view* shading;  /**< NULL: the table's colours as they are */
  const chi_mask_view* mask;        /**< NULL: nothing is masked */
  const chi_components* components; /**< NULL: one component */
} chi_occlusion_frame;

/** The last picture, owned by the handle, valid until its next call. Row 0 is the lowest. */
typedef struct chi_occlusion_image
{
  int32_t width, height;
  const float* rgba;       /**< [height x width x 4] the volume and the translucent layers:
                                premultiplied colour, alpha; in front of the surface where there is
                                one */
  const float* visibility; /**< [height x width] of the surface, planes and vicinity combined, after
                                strength: its ambient and
                                diffuse colour is to be multiplied by it; 1 where there is none */
  const float*
    visibility_rgb; /**< [height x width x 3] the same under coloured light, of which
                         visibility is the mean then; NULL where all channels are alike */
} chi_occlusion_image;

/** What the last frame cost. Times are seconds of wall clock, summed over threads where marked (t).
 */
typedef struct chi_occlusion_stats
{
  size_t struct_size;
  int64_t slices;          /**< sample planes */
  int64_t light_slices;    /**< light planes, those without samples included */
  int64_t samples;         /**< volume samples fetched and classified */
  int64_t skipped_samples; /**< samples inside the volume's footprint that were not needed */
  int64_t light_updates;   /**< direction x buffer pixel updates carried out */
  int64_t skipped_light_updates;
  int64_t occupied_bricks, bricks;
  int64_t non_finite_samples; /**< NaN or infinite voxels in the input: transparent */
  int32_t reused;             /**< 1: nothing changed, the last picture stands */
  int32_t reused_bricks;      /**< 1: min-max bricks kept; likewise the next */
  int32_t reused_classification;
  int32_t reserved;
  double seconds_bricks, seconds_classification, seconds_visible_set, seconds_slices, seconds_total;
  double seconds_samples; /**< (t) share of seconds_slices */
  double seconds_light;   /**< (t) share of seconds_slices */
  int64_t moved_lights;   /**< lights whose direction was too far off the view axis */
  /** What each kind of skipping left out: [k] belongs to the flag 1 << k. Samples (of clipped and
   * of footprint those of the whole lattice, elsewhere those inside the volume's box); updates of
   * light; of unchanged the number of stages, 0 ... 3. Work that two kinds spare is counted for
   * one. */
  int64_t skipped[CHI_SKIP_KINDS];
  int64_t light_bytes;    /**< of light buffers that this frame used; 0 without occlusion */
  double sample_distance; /**< between slices, world units; 0 without any */
} chi_occlusion_stats;

/** The defaults named above. Infallible. */
CHI_API void chi_occlusion_default_params(chi_occlusion_params* params);

CHI_API CHI_NODISCARD chi_status chi_occlusion_create(
  const chi_exec* exec, chi_occlusion** occlusion);
CHI_API void chi_occlusion_destroy(const chi_exec* exec, chi_occlusion* occlusion);

/**
 * Render one frame.
 *
 * @param[in]     exec       host services, or NULL; alloc and release must be those of create
 * @param[in,out] occlusion  renderer
 * @param[in]     frame      scene, camera, parameters; borrowed for the call
 *
 * @retval CHI_OK                      picture, probes and statistics are those of this frame
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, unknown type, window or matrix that is singular
 * or not finite, parameter out of range; the last picture stands
 * @retval CHI_ERROR_OUT_OF_MEMORY     the last picture is lost, the handle stays usable
 * @retval CHI_ERROR_TOO_LARGE         more than 2^24 slices, or a size overflows; the last picture
 * stands
 * @retval CHI_ERROR_CANCELLED         the last picture is lost, the handle stays usable
 *
 * Precision    samples and light in float, positions and tables in double; see theory/occlusion.md.
 * Determinism  same bits for any number of threads and any parallel_for on one instruction set;
 *              between instruction sets pictures differ by rounding, <= 1e-4 of full scale.
 * Non-finite   NaN and infinite voxels are transparent (every cell they touch) and counted.
 * Cost         slices x pixels of the footprint x (1 sample + directions / 4 light updates at half
 * size).
 */
CHI_API CHI_NODISCARD chi_status chi_occlusion_render(
  const chi_exec* exec, chi_occlusion* occlusion, const chi_occlusion_frame* frame);

/**
 * Depth at which the volume becomes as opaque as asked, along the ray of each pixel: where one
 * points at when one points at a volume.
 *
 * @param[in]     exec       as of chi_occlusion_render
 * @param[in,out] occlusion  renderer; its last picture and statistics stand, unless the volume or
 * the transfer function have changed since
 * @param[in]     frame      scene; light, translucent layers, probes and reduction are not looked
 * at
 * @param[in]     alpha      accumulated opacity, between 0 and 1, both excluded
 * @param[out]    depth      [height x width] along the view axis, world units; INFINITY where the
 *                           volume stays more transparent, or becomes so only behind the surface
 *
 * @retval as of chi_occlusion_render; in all cases but CHI_OK the depths are undefined
 *
 * Precision    exact for an extinction that is constant from slice to slice; else within a slice.
 */
CHI_API CHI_NODISCARD chi_status chi_occlusion_find_depth(const chi_exec* exec,
  chi_occlusion* occlusion, const chi_occlusion_frame* frame, double alpha, float* depth);

/** The last picture; all zero and NULL before the first, or where the last frame lost it. */
CHI_API void chi_occlusion_get_image(const chi_occlusion* occlusion, chi_occlusion_image* image);
CHI_API void chi_occlusion_get_stats(const chi_occlusion* occlusion, chi_occlusion_stats* stats);

/** Name of the instruction set in use: "avx512", "avx2" or "generic". */
CHI_API const char* chi_occlusion_instruction_set(void);

#ifdef __cplusplus
}
#endif
#endif
