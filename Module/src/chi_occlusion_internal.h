/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_INTERNAL_H
#define CHI_OCCLUSION_INTERNAL_H

/*
 * The stages of a frame:
 *
 *   bricks(volume) -> classification(bricks, transfer) -> scene(camera, parameters)
 *     -> surface intervals -> visible set -> march (samples + light, slab by slab)
 *
 * "Slice": a plane of samples. "Segment": between two slices. "Slab": `group` segments, over which
 * the light takes one step; its light plane lies in its middle. Depths inside the march are in
 * slices or slabs from the first one, so that nothing depends on the scene's units.
 */

#include <chiaroscuro/chi_occlusion.h>

#include "chi_buffer.h"
#include "chi_internal.h"
#include "simd/chi_occlusion_kernels.h"

/* Stage 1: the samples as the kernels fetch them, and their ranges in bricks of 8^3 cells. */
typedef struct chi_bricks
{
  int fetch, nearest;
  const void* scalars; /* the caller's, or `copy` */
  chi_buffer copy;     /* float, where the caller's type or stride cannot be fetched directly */
  double copy_scale, copy_offset; /* copied value = (scalar - offset) * scale */
  size_t dimensions[3], count[3];
  chi_buffer
    range; /* float [count][2], margin of two samples included; low > high: nothing finite */
  int64_t non_finite;
} chi_bricks;

chi_status chi_bricks_build(
  const chi_exec* exec, chi_bricks* bricks, const chi_volume_view* volume);
void chi_bricks_free(const chi_exec* exec, chi_bricks* bricks);

/* A transfer function of two quantities; none where its counts are 0. */
typedef struct chi_transfer_plane
{
  chi_buffer sigma; /* chi_plan_entry [count y][count x], sums along x */
  chi_buffer rgba;  /* float [count y][count x][4] */
  chi_buffer bound; /* float: the largest opacity of every column, and white */
  size_t count[2];
  float quantum; /* of all rows' sums */
} chi_transfer_plane;

enum
{
  CHI_LABEL_WORDS = 8 /* of 32 bits, one a table */
};

/* The samples and cells that are masked, and what that leaves of each brick. */
typedef struct chi_mask
{
  int grids;
  chi_plan_grid grid[CHI_PLAN_GRIDS];
  chi_buffer keep[CHI_PLAN_GRIDS]; /* uint32, one bit a cell */
  chi_buffer some;                 /* uint8 a brick: something is left within a step of it */
  chi_buffer whole;                /* uint8 a brick, padded: all is left within a step of it */
  chi_buffer sums;                 /* int32, summed volume of the bricks that are not whole */
  const uint8_t* labels;           /* [samples] table of each voxel, padded; NULL: table 0 of all */
  chi_buffer label_bytes;
  chi_buffer label_sets; /* uint32 [bricks][CHI_LABEL_WORDS]: tables within a step of it */
} chi_mask;

/* Stage 2: what the transfer function makes of scalars, and which bricks it leaves visible. */
typedef struct chi_classification
{
  chi_buffer sigma;  /* chi_plan_entry [entries] */
  chi_buffer rgba;   /* float [entries][4] */
  chi_buffer colors; /* chi_plan_color [entries] */
  size_t entries;    /* of all tables */
  size_t tables, table_entries;
  float quantum, base, scale, offset; /* see chi_sample_frame */
  chi_buffer visible_before; /* uint32 [entries + 1]: entries before that are not transparent */
  chi_buffer occupied;       /* uint8 a brick, padded */
  chi_buffer sums;           /* int32 [(nx + 1)(ny + 1)(nz + 1)] summed volume of occupied */
  int64_t occupied_bricks;
  chi_transfer_plane plane;
  chi_buffer gradient_opacity; /* float, within 0 ... 1, where the transfer function has one */
  const chi_mask* mask;        /* NULL: none */
} chi_classification;

chi_status chi_classify(const chi_exec* exec, chi_classification* out, const chi_bricks* bricks,
  const chi_transfer_view* transfer, int dilate);
/* The same, of tables of one quantity or two. */
chi_status chi_classify_transfer(const chi_exec* exec, chi_classification* out,
  const chi_bricks* bricks, const chi_transfer_view* transfer, int dilate);
int chi_transfer_plane_is_valid(const chi_transfer_view* transfer);
/* What is linear in the table's opacity is not in extinction: intervals are cut into parts, along x
 * and y, and the table is `value` between its entries: 0 ... 1, what is not finite is 0. */
void chi_transfer_plane_parts(const chi_transfer_view* transfer, size_t parts[2]);
double chi_transfer_plane_value(const chi_transfer_view* transfer, double x, double y, int channel);
void chi_transfer_plane_free(const chi_exec* exec, chi_transfer_plane* plane);

/* Of an opacity over a unit distance; chi_transfer.h. */
double chi_extinction(double opacity, double unit_distance);

void chi_classification_free(const chi_exec* exec, chi_classification* classification);

/* Summed volume [(nx + 1)(ny + 1)(nz + 1)] of a flag a brick; the sum of all. */
int64_t chi_bricks_sum(const chi_bricks* bricks, const uint8_t* flags, int32_t* sums);

/* Flagged bricks, and all of them, within [low, high] of index space. */
int64_t chi_bricks_count(const chi_bricks* bricks, const int32_t* sums, const double low[3],
  const double high[3], int64_t* all);

static inline int64_t chi_classification_count(const chi_classification* c,
  const chi_bricks* bricks, const double low[3], const double high[3], int64_t* all)
{
  return chi_bricks_count(bricks, (const int32_t*)c->sums.data, low, high, all);
}

/* Table entries that a segment may cross before the colour of its middle is wrong by more than half
 * a step of 8 bits; INFINITY: any number. `length` is the longest a segment gets, world units. */
float chi_classification_color_step(const chi_classification* classification, double length);

/* A soft light: the cone about an axis, in view coordinates. */
typedef struct chi_light
{
  double axis[3];  /* unit vector to the light; (0, 0, 1): the eye's side */
  double slope[2]; /* of the axis: axis[0] / axis[2], axis[1] / axis[2] */
  double cone;     /* half angle, radians */
  double share;    /* of all light */
  int moved;       /* the axis asked for was too steep */
} chi_light;

/* Stage 3: where slices, slabs and light pixels lie. Everything that both engines must agree on. */
typedef struct chi_scene
{
  int32_t width, height, scale, light_width, light_height;
  int parallel;
  /* index position of (pixel x, pixel y, depth z): origin + z axis + (parallel ? 1 : z)(x X + y Y)
   */
  double origin[3], axis[3], along_x[3], along_y[3];
  double box_low[3], box_high[3];      /* of the volume, index units */
  double clip[CHI_MAX_CLIP_PLANES][4]; /* planes in index space, unit normals, kept where >= 0 */
  int clips;
  double crop[6][4];                           /* likewise, of the cropping regions */
  uint32_t regions;                            /* that stay */
  double slope_x, slope_dx, slope_y, slope_dy; /* of the pixel's ray: slope_x + x slope_dx */
  double pixels_x, pixels_y; /* light pixels a unit of slope (perspective) or length (parallel) */
  double start, slice, slab; /* depth of slice 0; world distance between slices, light planes */
  double voxel;              /* depth over which the index position moves by one */
  int64_t group, slabs;
  int64_t volume_begin, volume_end; /* slabs with samples */
  int64_t clipped_slabs;            /* that the clip planes spare */
  double bias;                      /* in slabs */
  double sample_bias;               /* of matter, counted from its segment's near slice */
  int lights;                       /* 1 or 2 */
  chi_light light[2];
  int directions; /* of all lights; taps of the published rule */
  /* To the light, against the pixel's own ray: light of direction m goes through (x, y) + depth
   * towards the eye x (tangent[0], tangent[1]). */
  float tangent[2][CHI_MAX_ORDINATES];
  float weight[CHI_MAX_ORDINATES]; /* of the directions in visibility; they add up to 1 */
  int weighted;                    /* they are not all equal */
  float mean_length;               /* path length a unit depth, by weight */
  /* Colours of light that are attenuated differently: 1, each red, green and blue, or in between */
  int channels, channel_of[3];
  float factor[3]; /* [channels] of the optical thickness */
  /* Light pixels by which light planes lie aside in turn, so that shifts of whole pixels are
   * blurred as others are; theory/occlusion.md, "Steps" */
  float zigzag[2][CHI_MAX_ORDINATES];
  int64_t zigzag_phase; /* slabs */
  int published;
} chi_scene;

/* Lights, directions, weights and channels of a scene; `published` is set. chi_directions.c */
void chi_scene_place_lights(chi_scene* scene, const chi_occlusion_params* params);

chi_status chi_scene_build(
  chi_scene* scene, const chi_occlusion_frame* frame, double surface_near, double surface_far);

/* The same for matter that is no grid of samples: so many slabs from one depth to another, light
 * read nearer to the eye by the bias, which is not negative, but by no less than 1.5 slabs. */
void chi_scene_build_slabs(chi_scene* scene, const chi_camera* camera,
  const chi_occlusion_params* params, const double depths[2], int64_t slabs);

/* One direction's shift into a slab: whole light pixels, and the weights of the taps at (0, 0), (1,
 * 0), (0, 1), (1, 1) from there. */
void chi_scene_step(
  const chi_scene* scene, int64_t slab, int direction, int32_t offset[2], float weight[4]);

/* Planes of visibility that are still read: as far back as the bias. */
int64_t chi_scene_ring(const chi_scene* scene);

/* Which light travels, and what blocks it: field 0 for the volume, field surface_field for
 * surfaces. */
typedef struct chi_frame_light
{
  int volume[2], geometry[2];
  int fields, surface_field;
} chi_frame_light;

void chi_frame_fields(const chi_occlusion_frame* frame, chi_frame_light* light);

/* Light pixels by which a unit slope shifts between the depths from < to. */
double chi_scene_shift(const chi_scene* scene, double from, double to);

static inline double chi_scene_depth(const chi_scene* scene, double slabs)
{
  return scene->start + slabs * scene->slab;
}

/* Stage 4: geometry as blocker: the slabs that a pixel's surface closes. */
chi_status chi_surface_intervals(const chi_exec* exec, const chi_scene* scene,
  const chi_surface_view* surface, double thickness, size_t stride, size_t padded,
  float* slice_depth, float* receiver, float* begin, float* end);

/* Depth in slices from which the bias counts for a surface at this depth of a pixel. */
float chi_surface_receiver(
  const chi_scene* scene, const chi_surface_view* surface, int64_t x, int64_t y, double depth);

/* Whether these layers can be drawn; none at all can. */
int chi_layers_are_valid(const chi_layers_view* layers);
/* Layers a pixel at most, with a surface's edge. */
int chi_layers_count(const chi_occlusion_frame* frame);

/* Of a pixel's slots: colour, premultiplied, and alpha before it is cut to 0 ... 1; depth in
 * slices, INFINITY where there is no layer in front of the `surface`, slices; depth from which it
 * receives light. */
const float* chi_layer_color(const chi_occlusion_frame* frame, int slot, int64_t x, int64_t y);
float chi_layer_alpha(const float rgba[4]);
float chi_layer_slices(const chi_scene* scene, const chi_occlusion_frame* frame, int slot,
  int64_t x, int64_t y, float surface);
float chi_layer_receiver(const chi_scene* scene, const chi_occlusion_frame* frame, int slot,
  int64_t x, int64_t y, float slices);

enum
{
  CHI_MAX_VICINITY_SAMPLES = 118 /* Schott et al. 2013, section 3.2.5 */
};

/* Share of the light that one slab of a surface's interval blocks. */
float chi_geometry_opacity(const chi_occlusion_params* params, float begin, float end);

/* Radius of a light's vicinity in world units, and the neighbours that are looked at, in radii;
 * returns their number, 0 where the frame has no vicinity occlusion. */
double chi_vicinity_radius(const chi_scene* scene, const chi_occlusion_params* params, int light);
int chi_vicinity_disc(const chi_scene* scene, const chi_occlusion_params* params, int light,
  double disc[CHI_MAX_VICINITY_SAMPLES][2]);

/*
 * The automatic rule: a twentieth of the radius covers what curvature and steps of depth leave of a
 * smooth surface, a fifth of the rise what is wrong with the plane of a curved surface's steep rim.
 * Blockers farther off than the virtual slice are the light planes' part; between one and two
 * slices one hands over to the other.
 */
#define CHI_VICINITY_CURVATURE 0.05
#define CHI_VICINITY_RISE 0.2
#define CHI_VICINITY_FADE 2.0

/* Rays end at alpha 0.998: what is left is half a step of 255. */
#define CHI_SATURATED 0.002f

/* Combine the visibilities of surfaces, `colors` a pixel, before strength, with what their vicinity
 * leaves. */
chi_status chi_vicinity(const chi_exec* exec, const chi_scene* scene,
  const chi_surface_view* surface, const chi_occlusion_params* params, float* visibility,
  size_t colors);

/* Gradients: whether what a frame says of them is valid, whether it asks for them, and what both
 * engines need (chi_shading.c). */
int chi_shading_is_valid(const chi_shading_view* shading); /* NULL is */
int chi_gradient_opacity_is_valid(const chi_transfer_view* transfer);
int chi_shading_prepare(chi_plan_shading* out, const chi_occlusion_frame* frame,
  const chi_bricks* bricks, const chi_classification* classification,
  int* needed); /* 0: a matrix is singular */

/* What of the shading changes the picture, comparable by its bytes. */
typedef struct chi_shading_key
{
  double material[7];
  int64_t two_sided, unclamped, light_count; /* -1: none */
  chi_shading_light light[CHI_MAX_LIGHTS];
} chi_shading_key;

void chi_shading_make_key(chi_shading_key* key, const chi_shading_view* shading);

/* Light that travels for one kind of receiver. */
typedef struct chi_light_field
{
  int volume, geometry;  /* what blocks it */
  chi_buffer light[2];   /* [directions][rows][stride], padded with light from outside: 1 */
  chi_buffer visibility; /* [ring][rows][stride] */
  chi_buffer tiles;      /* uint8 [2 + ring][rows][segments]: TILE_... */
} chi_light_field;

/* Buffers of light planes, kept between frames. */
typedef struct chi_light_buffers
{
  chi_light_field field[2][3]; /* for matter, for geometry; [channels] */
  chi_buffer steps, reach, scratch, tau_flag, blocking, served, order;
} chi_light_buffers;

/* The kinds of skipping that are on, as one bit each. */
static inline int chi_skip_kinds(const chi_occlusion_params* params)
{
  return params->skip & CHI_SKIP_ALL ? CHI_SKIP_EVERY_KIND : params->skip;
}

/* Index of a kind in chi_occlusion_stats.skipped. */
enum
{
  SKIPPED_BRICKS = 1,
  SKIPPED_SATURATED_RAYS,
  SKIPPED_BEHIND_GEOMETRY,
  SKIPPED_CLIPPED,
  SKIPPED_FOOTPRINT,
  SKIPPED_SATURATED_LIGHT,
  SKIPPED_UNREACHED_LIGHT,
  SKIPPED_UNCHANGED
};

typedef struct chi_march_result
{
  int64_t samples, skipped_samples, light_updates, skipped_light_updates;
  int64_t skipped[CHI_SKIP_KINDS], light_bytes;
  double seconds_visible_set, seconds_slices, seconds_samples, seconds_light;
} chi_march_result;

/* Buffers of the march, kept between frames. */
struct chi_component_set;
typedef struct chi_march
{
  float* crossing; /* NULL, or [height][width]: depths where the transmittance gets down to ... */
  float crossing_transmittance;
  const struct chi_component_set* components; /* with frame->components */
  chi_buffer planes; /* float, picture-sized state; see chi_occlusion_march.c */
  chi_buffer cells, last_cell, last_slab, until, need, live_row, sampled, done, order, band_rows;
  chi_buffer layers, layer_flags; /* see chi_layers.c */
  chi_light_buffers light;
  chi_buffer tint; /* float; see chi_occlusion_march.h */
} chi_march;

/* A frame at a fraction of the resolution; chi_reduction.c. */
typedef struct chi_reduction
{
  chi_buffer depth, rgba, visibility, layer_depth, layer_rgba;
  chi_occlusion_frame frame;
  chi_camera camera;
  chi_surface_view surface;
  chi_layers_view layers;
} chi_reduction;

int chi_reduction_of(const chi_occlusion_frame* frame);
chi_status chi_reduce(
  const chi_exec* exec, chi_reduction* out, const chi_occlusion_frame* frame, int n);
chi_status chi_enlarge(const chi_exec* exec, chi_reduction* from, const chi_occlusion_frame* frame,
  const chi_scene* scene, int n, float* rgba, float* visibility);
void chi_reduction_free(const chi_exec* exec, chi_reduction* reduction);

/* Floats that `rgba` has room for where there is a surface, whose planes lie there meanwhile. */
size_t chi_march_picture_floats(const chi_scene* scene);
chi_status chi_march_run(const chi_exec* exec, chi_march* march, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* frame, float* rgba, float* visibility, chi_march_result* result);
void chi_march_free(const chi_exec* exec, chi_march* march);

double chi_seconds(void);

#endif
