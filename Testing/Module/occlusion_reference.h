/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_REFERENCE_H
#define CHI_OCCLUSION_REFERENCE_H

/*
 * What the occlusion engine is judged by: three scenes, the points where visibility is judged, the
 * exact visibility there by straight rays, and a view of the scene for the engine. Nothing here
 * knows how the engine works.
 *
 * All lengths are voxels of a 128^3 grid; x, y, z are index coordinates, z grows away from the eye.
 * The world is index space with z negated, so that the eye looks along -z.
 */

#include <chiaroscuro/chi_occlusion.h>

enum
{
  REFERENCE_SIZE = 128,     /* voxels along each axis */
  REFERENCE_ENTRIES = 4097, /* of the transfer function */
  REFERENCE_PICTURE = 160   /* pixels along each axis of the perspective view */
};

typedef enum reference_kind
{
  REFERENCE_HALF_PLANE, /* opaque, two voxels thick; judged in its penumbra */
  REFERENCE_BALLS,      /* 60 balls; judged outside opaque ones */
  REFERENCE_RAW         /* float extinction from a file; judged where something can be seen */
} reference_kind;

/* Extinction a voxel on a grid, zero outside. */
typedef struct reference_volume
{
  float* extinction; /* [n[2]][n[1]][n[0]], owned */
  size_t n[3];
  unsigned char* occupied; /* [bricks of 8^3 cells]: any extinction there, owned */
  size_t bricks[3];
  double low[3], high[3]; /* box outside which extinction is zero */
} reference_volume;

/* An eye: parallel, one pixel a voxel; or perspective, on the grid's axis. */
typedef struct reference_view
{
  chi_camera camera;
  double eye[3];
  double light[3]; /* middle of the cone: x right, y up, z to the eye along the line of sight; all
                      0: (0, 0, 1) */
} reference_view;

/* Points in index space, x y z, and the pixel each lies in the middle of where that matters. */
typedef struct reference_points
{
  double* position; /* [count][3], owned */
  size_t count;
} reference_points;

/* The cone's rays: `step` is voxels along the ray, or, for parallel views, along the depth axis. */
typedef struct reference_rays
{
  int count;
  double step, half_angle;
} reference_rays;

/* Opaque geometry as the engine sees it: a depth a pixel of the view, blocking light from there
 * over `thickness`; or, where there is a test for it, as it is. */
typedef struct reference_surface
{
  const float* depth;
  double thickness;
  double nearest; /* smallest depth: rays end there */
  int (*contains)(const void* solid, const double at[3]);
  const void* solid;
} reference_surface;

/* 0 when memory or the file is missing. */
int reference_volume_create(reference_volume* volume, const size_t n[3]); /* extinction zero */
void reference_volume_finish(reference_volume* volume); /* after extinction has been written */
int reference_scene(reference_volume* volume, reference_kind kind, const char* raw_file);
void reference_volume_free(reference_volume* volume);

double reference_extinction(const reference_volume* volume, const double at[3]);

reference_view reference_parallel_view(void);
reference_view reference_perspective_view(double angle_deg);
/* An eye anywhere: it looks at `center` (index space) from `distance`, turned about the vertical,
 * then upwards; the window shows `size` at the centre's depth. Not for reference_visibility. */
reference_view reference_turned_view(const double center[3], double distance,
  const double turn_deg[2], double size, int32_t pixels, int32_t parallel);

double reference_depth(const reference_view* view, const double at[3]);

/* The judged points of scenes.py (parallel) or perspective.py, every `stride`-th of them. */
int reference_points_create(reference_points* points, const reference_volume* volume,
  reference_kind kind, const reference_view* view, size_t stride);
void reference_points_free(reference_points* points);

/* Mean over the cone about the ray to the eye of exp(-integral of extinction); volume or surface
 * may be NULL. `at` is where light is received. */
double reference_visibility(const reference_volume* volume, const reference_surface* surface,
  const reference_view* view, const reference_rays* rays, const double at[3]);

/* What the engine needs to draw such a scene: extinction = scalar. Pointers within; do not copy. */
typedef struct reference_frame
{
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_occlusion_params params;
  chi_occlusion_probes probes;
  chi_occlusion_frame frame;
  float rgb[3 * REFERENCE_ENTRIES], opacity[REFERENCE_ENTRIES];
} reference_frame;

/* White; visibility at bias 0; the largest extinction that counts is `range`. */
void reference_frame_init(
  reference_frame* f, const reference_volume* volume, const reference_view* view, double range);

/* Visibility at points, by the engine. */
chi_status reference_probe(const chi_exec* exec, chi_occlusion* engine, reference_frame* f,
  const reference_view* view, const reference_points* points, float* visibility);

typedef struct reference_error
{
  double mean, rms, p99, max, bias;
} reference_error;

/* Of |visibility - exact|; `work` has room for count doubles. */
reference_error reference_compare(
  const float* visibility, const double* exact, size_t count, double* work);

#endif
