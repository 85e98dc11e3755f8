/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TET_H
#define CHI_TET_H

/*
 * Volume rendering of unstructured meshes by projected tetrahedra, in exact visibility order, with
 * pre-integrated segments. Sources: Shirley & Tuchman, "A Polygonal Approximation to Direct Scalar
 * Volume Rendering", 1990 (whose cases and linear thickness are replaced by the planes of each
 * tetrahedron, evaluated at every pixel); Williams 1992, Silva, Mitchell & Williams 1998 (orders);
 * Kraus, Qiao & Ebert, "Projecting Tetrahedra without Rendering Artifacts", 2004 (perspective);
 * Moreland & Angel, "A Fast High Accuracy Volume Renderer for Unstructured Data", 2004
 * (pre-integration). Documentation/theory/tet.md says where and why we deviate.
 */

#include "chi_camera.h"
#include "chi_grid.h"
#include "chi_preintegration.h"
#include "chi_shading.h"
#include "chi_surface.h"
#include "chi_tet_order.h"
#include "chi_transfer.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** A renderer: what it derived from the last frames is kept, and made anew only where its source
 * changed. One handle serves one thread of calls at a time. */
typedef struct chi_tet chi_tet;

enum
{
  CHI_TET_MAX_CLIP_PLANES = 32
};

/** What is drawn of the grid, borrowed. */
typedef struct chi_tet_field
{
  size_t struct_size;
  const chi_array_view* scalars; /**< a tuple a point of the grid, or a cell */
  int32_t is_cell_data;          /**< non-zero: constant in each cell */
  int32_t component;             /**< of scalars; -1: the magnitude of all of them */
  const chi_array_view* opacity; /**< what the opacity function is read at, likewise of points or
                                      of cells; NULL: the scalars */
  int32_t opacity_component;     /**< of opacity; -1: magnitude */
  int32_t reserved;
  uint64_t version; /**< differs whenever anything here does */
  /** Direct colours, in place of the transfer function's, whose rgb is not read then: a tuple a
   * point or a cell, as of scalars. They are linear in a tetrahedron; scalars have the opacity, the
   * gradient and the largest value, and `opacity` must be NULL. NULL: the transfer function's. */
  const chi_array_view* colors;
  int32_t color_component; /**< of colors: red; green and blue are the next two */
  int32_t reserved_colors;
  double color_range[2]; /**< values of colors that stand for 0 and 1, beyond which they are cut;
                            NaN is 0; both 0: 0 and 1 */
  /** What the second axis of chi_transfer_view.plane is read at: a tuple a point or a cell, as of
   * scalars; NULL: the magnitude of the gradient, one a tetrahedron, of values of cells 0, in units
   * of the scalar a mean cell's edge: in the grid's own coordinates times the cube root of the mean
   * volume of its cells. Not read without such a function, which has no `opacity` and no `colors`,
   * and no published projection. */
  const chi_array_view* second;
  int32_t second_component; /**< of second; -1: magnitude */
  int32_t reserved_second;
} chi_tet_field;

/** How fragments become a pixel. */
enum
{
  CHI_TET_BLEND_COMPOSITE = 0,
  CHI_TET_BLEND_MAXIMUM = 1 /**< colour and opacity of the largest scalar along the ray, exactly:
                                 scalars are linear, so it lies at an end of a segment */
};

/** Where the ends of a ray's part in a tetrahedron come from. */
enum
{
  CHI_TET_PROJECTION_EXACT = 0,    /**< the planes of its faces, at every pixel */
  CHI_TET_PROJECTION_PUBLISHED = 1 /**< to compare with, slowly: Shirley & Tuchman's triangles about
                                        the point where the tetrahedron is thickest, thickness and
                                        scalars linear on the screen between their corners, where
                                        they are exact. What the near plane, a clip plane or the
                                        surface cuts is drawn exactly, and counted; so is all
                                        where there is occlusion, without a count */
};

/** Work that is left out because it changes no picture by more than 1/255; bits of
 * chi_tet_params.skip. Bit 0 stands for every kind, those of later versions included. */
enum
{
  CHI_TET_SKIP_NOTHING = 0,
  CHI_TET_SKIP_ALL = 1,
  CHI_TET_SKIP_TRANSPARENT = 2, /**< tetrahedra whose opacity is 0 over their range of scalars */
  CHI_TET_SKIP_OUTSIDE = 4,     /**< tetrahedra outside of the window */
  CHI_TET_SKIP_CLIPPED = 8,     /**< tetrahedra beyond one of the clip planes */
  CHI_TET_SKIP_HIDDEN = 16,     /**< tetrahedra behind the surface of all pixels of their tiles */
  CHI_TET_SKIP_SATURATED = 32,  /**< tetrahedra behind a tile that lets no light through any more */
  CHI_TET_SKIP_UNCOVERED = 64,  /**< tetrahedra that cover no pixel's centre */
  CHI_TET_SKIP_UNCHANGED = 128, /**< stages whose sources have not changed */
  CHI_TET_SKIP_EVERY_KIND = 254, /**< all of this version, to take single ones away from */
  CHI_TET_SKIP_KINDS = 16        /**< length of chi_tet_stats.skipped */
};

typedef struct chi_tet_params
{
  size_t struct_size;
  int32_t order;                   /**< CHI_TET_ORDER_...; default AUTO */
  int32_t pre_integration;         /**< CHI_PREINTEGRATION_...; default AUTO */
  int32_t opacity_convention;      /**< CHI_OPACITY_...; default LINEAR */
  int32_t blend;                   /**< CHI_TET_BLEND_...; default composite */
  int32_t skip;                    /**< CHI_TET_SKIP_...; default all */
  int32_t automatic_unit_distance; /**< non-zero: in place of the transfer function's unit distance
                                        the cube root of the mesh's volume a cell; default 0 */
  int32_t reduction;  /**< 2 ... 8: a picture of so many times fewer pixels a side, enlarged
                           bilinearly; 0, 1: full (default). Cells are never left out */
  int32_t projection; /**< CHI_TET_PROJECTION_...; default exact. Of pictures alone: cells are
                         found, violations counted and plans made by exact ones */
  size_t fragment_cache_bytes; /**< what may be kept of fragments, 10 bytes each, so that a view
                                  that stands is drawn faster under the third and later transfer
                                    functions; scalars are rounded to 1/65535 of the range; 0: none
                                    (default) */
  /** Occlusion: how much the light that reaches matter through a cone about the direction to the
   * eye, its visibility V, darkens it: colours become 1 - strength (1 - V) times theirs, highlights
   * included. Between 0, which is off (default), and 1. Maximum intensity has none,
   * the published projection is drawn exactly. What follows
   * means what it means in chi_occlusion.h, see theory/tet_occlusion.md. */
  double occlusion_strength;
  double cone_angle_degrees; /**< half angle of the cone, 1 ... 85; 0 (default) = 45 */
  double occlusion_bias;   /**< visibility is read so much nearer to the eye than matter lies, world
                                units, and by 1.5 slabs at least; 0 (default) = twice the cube root
                                of the mesh's volume a cell */
  int32_t direction_count; /**< 1 ... 64, of equal solid angle each; 0 (default) = 16 */
  int32_t occlusion_slabs; /**< over the depths of what is drawn, 1 ... 4096; 0 (default) = 128 */
  int32_t full_size_light; /**< non-zero: a light pixel a pixel; 0 (default): one for four */
  int32_t subpixel_splatting; /**< non-zero: pixels that are touched by a tetrahedron whose box is
                                  at most two pixels wide and high have of all tetrahedra the mean
                                  over the rays of their area, not what the ray of their centre
                                  meets, so that nothing is too small to count. Thin ones are
                                  merged. Of composited pictures by the exact projection, without
                                  occlusion, under transfer functions of one quantity; others,
                                  cells that are found, counts of violations and plans are without.
                                  No fragments are kept. Default 0 */
} chi_tet_params;

/** One frame: all borrowed, none modified. */
typedef struct chi_tet_frame
{
  size_t struct_size;
  const chi_camera* camera; /**< at most 16384 pixels a side */
  const chi_grid_view* grid;
  const double* grid_to_world; /**< row-major 4 x 4, affine, any scale or mirror; NULL: identity.
                                    Lengths that opacity is taken over are those of the world */
  const chi_tet_field* field;
  const chi_transfer_view* transfer; /**< one table over the scalar, or `plane` over two quantities;
                                          y_samples is not read */
  const chi_surface_view* surface;   /**< depth alone is read; NULL: no geometry */
  const chi_tet_params* params;
  /** The mesh is cut: what is left is where a x + b y + c z + d >= 0 of every plane, world
   * coordinates. */
  const double* clip_planes; /**< [clip_plane_count x 4], not all of a, b, c zero */
  size_t clip_plane_count;   /**< 0 ... CHI_TET_MAX_CLIP_PLANES */
  /** Shading by the gradient, which is constant in a tetrahedron: lights and eye as from its centre
   * of gravity. Values of cells have no gradient. NULL: the table's colours as they are. */
  const chi_shading_view* shading;
} chi_tet_frame;

/** The last picture, owned by the handle, valid until its next call. Row 0 is the lowest. */
typedef struct chi_tet_image
{
  int32_t width, height;
  const float* rgba; /**< [height x width x 4] premultiplied colour, alpha; in front of the surface
                          where there is one */
} chi_tet_image;

/** What the last frame cost. Times are seconds of wall clock. */
typedef struct chi_tet_stats
{
  size_t struct_size;
  chi_grid_counts grid;
  chi_tet_order_info order;
  int64_t tetrahedra;       /**< of the mesh */
  int64_t drawn;            /**< pairs of a tetrahedron and a tile of 64 x 64 pixels drawn */
  int64_t fragments;        /**< pairs of a tetrahedron and a pixel */
  int64_t delicate;         /**< of drawn: evaluated in double (theory/tet.md) */
  int64_t non_finite_cells; /**< tetrahedra left out because a scalar is NaN or infinite */
  int64_t outside;          /**< tetrahedra left out because they lie outside of the window, or have
                                 a vertex 1e18 world units or more from the eye along an axis */
  int64_t uncovered;        /**< tetrahedra left out because they cover no pixel's centre */
  int64_t skipped[CHI_TET_SKIP_KINDS]; /**< [k] belongs to the flag 1 << k: tetrahedra; of saturated
                                            ones pairs as of drawn; of unchanged stages, 0 ... 5 */
  int32_t reused;                      /**< 1: nothing changed, the last picture stands */
  int32_t pre_integration;             /**< CHI_PREINTEGRATION_... used */
  double unit_distance;                /**< used, world units */
  double seconds_split, seconds_values, seconds_order, seconds_bins, seconds_draw, seconds_total;
  size_t bytes_mesh;      /**< of the mesh and its order, kept from frame to frame */
  size_t bytes_frame;     /**< of the frame: points in the eye's space, tiles and their lists */
  size_t bytes_image;     /**< of the picture */
  size_t bytes_cache;     /**< of kept fragments */
  double seconds_light;   /**< of seconds_draw: light through the slabs; 0 without occlusion */
  size_t bytes_occlusion; /**< of light planes and the slabs' lists, kept from frame to frame */
  int64_t light_slabs;    /**< passed before all was opaque or drawn; 0 without occlusion */
  int64_t splatted;       /**< of drawn: the small ones of subpixel splatting */
  int64_t drawn_exactly;  /**< of drawn: what the published projection has left to the exact one */
} chi_tet_stats;

/** The defaults named above. Infallible. */
CHI_API void chi_tet_default_params(chi_tet_params* params);

CHI_API CHI_NODISCARD chi_status chi_tet_create(const chi_exec* exec, chi_tet** tet);
CHI_API void chi_tet_destroy(const chi_exec* exec, chi_tet* tet);

/**
 * Render one frame.
 *
 * @param[in]     exec   host services, or NULL; alloc and release must be those of create
 * @param[in,out] tet    renderer
 * @param[in]     frame  scene, camera, parameters; borrowed for the call. Arrays of the grid that
 *                       have not changed since the last frame, by its version and their addresses,
 *                       are taken to hold the same
 *
 * @retval CHI_OK                      picture and statistics are those of this frame
 * @retval CHI_ERROR_INVALID_ARGUMENT  null pointer, unknown type or kind, matrix that is singular
 * or not finite, array of the wrong length, broken grid (stats.grid.first_bad_cell); the last
 * picture stands
 * @retval CHI_ERROR_OUT_OF_MEMORY     the last picture is lost, the handle stays usable
 * @retval CHI_ERROR_TOO_LARGE         more points or tetrahedra than 32 bits count; likewise
 * @retval CHI_ERROR_CANCELLED         the last picture is lost, the handle stays usable
 *
 * Precision    planes in double, pixels in float relative to each tetrahedron, or in double where
 *              float would be off by 1e-5 of its longest edge; see theory/tet.md.
 * Determinism  same bits for any number of threads and any parallel_for on one instruction set.
 * Non-finite   cells with a coordinate, tetrahedra with a scalar that is not finite are left out
 * and counted. Cost         n log n in tetrahedra at worst, linear in fragments.
 */
CHI_API CHI_NODISCARD chi_status chi_tet_render(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame);

/** The last picture; all zero and NULL before the first, or where the last frame lost it. */
CHI_API void chi_tet_get_image(const chi_tet* tet, chi_tet_image* image);
CHI_API void chi_tet_get_stats(const chi_tet* tet, chi_tet_stats* stats);

/**
 * What one points at: the cell in which the accumulated opacity of a pixel passes `opacity`, or,
 * where it never does, the one that adds most to the pixel, if that is more than 1/255.
 *
 * @param[in]     exec     as of chi_tet_render
 * @param[in,out] tet      renderer; its last picture stands where this is its frame, else is lost
 * @param[in]     frame    scene; blended by compositing whatever its parameters say
 * @param[in]     opacity  between 0 and 1, both excluded
 * @param[out]    cells    [height x width] cells of the grid; -1: none
 * @param[out]    depths   [height x width] along the view axis, world units, where the ray enters
 *                         that cell's tetrahedron; INFINITY where there is none
 *
 * @retval as of chi_tet_render; in all cases but CHI_OK cells and depths are undefined
 */
CHI_API CHI_NODISCARD chi_status chi_tet_find_cells(const chi_exec* exec, chi_tet* tet,
  const chi_tet_frame* frame, double opacity, int64_t* cells, float* depths);

/**
 * Count the violations of the frame's visibility order: neighbouring pairs of tetrahedra on the ray
 * of a pixel whose depth intervals are disjoint by more than 1e-9 of the extent, and which are
 * drawn in the wrong order. A slow path.
 *
 * @retval as of chi_tet_render
 */
CHI_API CHI_NODISCARD chi_status chi_tet_count_violations(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame, int64_t* violations);

/** What another engine needs to draw the same frame; owned by the handle or, as the surface, by the
 * caller, valid until the next call. A fragment's colour is that of chi_segment_evaluate over the
 * part of the pixel's ray inside of the tetrahedron, with scalars clamped to the range of its
 * vertices.
 */
typedef struct chi_tet_plan
{
  size_t struct_size;
  const double* points;   /**< [point_count x 4] in the eye's space, world units: x to the right, y
                               up, depth along the view axis; two floats: the scalar, the opacity's */
  const float* scalars;   /**< [point_count], or of cells [value_count] */
  const float* opacities; /**< likewise; NULL: the scalars */
  size_t point_count, value_count;
  const uint32_t* vertices; /**< [count x 4] */
  const uint32_t* cells;    /**< [count] index into the values of cells; NULL: the identity */
  size_t count;
  const uint32_t* sequence; /**< [sequence_count] tetrahedra to draw, farthest first */
  size_t sequence_count;
  int32_t is_cell_data, blend;
  const double* planes; /**< [plane_count x 4] clip planes in the space of the points */
  size_t plane_count;
  double maximum_path; /**< maximum intensity: opacity is that of a path so long, by the convention:
                            1 - exp(-extinction x path) of images, else that product, at most 1 */
  int32_t opacity_convention;
  int32_t parallel; /**< rays along the view axis, else from the origin */
  chi_segment_tables tables;
  uint64_t points_version, scalars_version, vertices_version, sequence_version;
  const float* shades; /**< [count x 6] what lights make of each tetrahedron of the sequence:
                          factors of red, green and blue, and what is added to them; NULL: no
                          shading. A lit colour is at most color_limit, premultiplied at most that
                          times the fragment's alpha */
  double color_limit;
  int32_t width, height;           /**< pixels to draw */
  int32_t full_width, full_height; /**< pixels of the picture, to which it is enlarged, */
  int32_t reduction;               /**< bilinearly, by this; 1: not */
  int32_t reserved;
  double first[2], step[2]; /**< centre of pixel (0, 0), the lowest on the left, and from one to the
                                 next: at depth 1 in perspective, else world units */
  double near_depth;        /**< what lies nearer is not drawn */
  double point_limit;       /**< no coordinate of a point is larger */
  const float* depth;       /**< [height x width] of the surface, at which rays end where it is
                                 larger than 0; NULL: none */
  uint64_t surface_version; /**< differs whenever `depth` does */
  uint64_t frame_version;   /**< differs whenever the picture may */
  const float* colors; /**< [point_count x 3], or of cells [value_count x 3], 0 ... 1, linear in
                          each tetrahedron: direct colours, of which `tables` knows nothing
                          (chi_preintegration_params.direct_color); NULL: those of the tables */
  /** A table of two quantities, colour and extinction, [plane_rows][tables.count + 1], each row's
   * last entry twice; linear between entries: x as of `tables`, which are those of a bound, y over
   * plane_range. Then `opacities` are the second quantity. NULL: none. The method `full` cuts
   * segments into parts of plane_step entries along either axis, plane_parts of them at most, and
   * integrates each partially. */
  const float (*plane)[4];
  int32_t plane_rows, plane_parts;
  double plane_step, plane_range[2];
  uint64_t plane_version;
  const float* seconds; /**< [count] the second quantity of each tetrahedron; NULL: of points or
                             cells */
} chi_tet_plan;

/**
 * Everything of a frame but its pixels. stats.reused says that the plan is that of the last call.
 *
 * @param[in,out] plan  struct_size is that of the caller's; the rest is written, borrowed from the
 *                      handle
 *
 * @retval as of chi_tet_render
 */
CHI_API CHI_NODISCARD chi_status chi_tet_describe(
  const chi_exec* exec, chi_tet* tet, const chi_tet_frame* frame, chi_tet_plan* plan);

#ifdef __cplusplus
}
#endif
#endif
