/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_TUBE_H
#define CHI_TUBE_H

#include "chi_spline.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** The plan of a sweep: rings, radii, frames' defects and sizes. Reused between calls. */
typedef struct chi_tube chi_tube;

enum
{
  CHI_TUBE_ROTATION_MINIMISING = 0,
  CHI_TUBE_FRENET = 1
};
enum
{
  CHI_TUBE_CAP_NONE = 0,
  CHI_TUBE_CAP_FLAT = 1,
  CHI_TUBE_CAP_ROUND = 2
};
enum
{
  CHI_TUBE_STRIPS = 0,
  CHI_TUBE_TRIANGLES = 1
};

typedef struct chi_tube_params
{
  size_t struct_size;
  double radius; /**< length units, > 0; times the radius array where there is one */
  const chi_array_view* point_radius; /**< NULL, or one value an input point (index: point id) */
  const chi_array_view* line_radius;  /**< NULL, or one value a line */
  int32_t sides;                      /**< >= 3; 0 = from the tolerances */
  int32_t frame;                      /**< CHI_TUBE_ROTATION_MINIMISING or _FRENET */
  int32_t cap;                        /**< CHI_TUBE_CAP_... */
  int32_t cells;                      /**< CHI_TUBE_STRIPS or _TRIANGLES */
  int32_t limit_radius; /**< non-zero: radius < 1 / curvature (Schott et al. 2013, section 4) */
  int32_t keep_rings;   /**< non-zero: a ring at every cleaned input point, no adaptivity */
  double
    chord_tolerance; /**< largest distance surface <-> ideal swept surface along, length units */
  double angular_tolerance_rad; /**< largest turn of the tangent between rings */
  double attribute_tolerance;   /**< fraction of each array's range; 0 ignores the arrays */
  const chi_array_view* const* attributes; /**< float point arrays that hold rings in place */
  size_t attribute_count;
  const double* clip_box; /**< NULL or xmin xmax ymin ymax zmin zmax: lines wholly outside (radius
                             included) are not tubed */
  double min_length;      /**< shorter lines are not tubed */
} chi_tube_params;

typedef struct chi_tube_sizes
{
  size_t struct_size;
  size_t points;       /**< output vertices */
  size_t cells;        /**< strips or triangles (caps included) */
  size_t connectivity; /**< entries of the connectivity array */
  size_t rings;
  size_t curve_points; /**< points of the fitted curves as polylines */
  size_t curves;
  size_t clamped_radii; /**< rings whose radius was limited by the curvature */
  size_t removed_rings; /**< candidate rings that every tolerance allowed to drop */
  size_t outside_lines; /**< wholly outside clip_box */
  size_t short_lines;   /**< shorter than min_length */
  uint64_t bytes;       /**< estimate of all outputs: f32 points and normals, i64 cells */
} chi_tube_sizes;

/** Caller-allocated outputs; NULL members are not written. */
typedef struct chi_tube_outputs
{
  size_t struct_size;
  void* points;        /**< [points x 3] of point_type */
  chi_type point_type; /**< CHI_F32 or CHI_F64 */
  float* normals;      /**< [points x 3] unit */
  float* tcoords;      /**< [points x 2]: see tcoord_mode */
  int32_t tcoord_mode; /**< 0 off, 1 normalised length, 2 length / tcoord_length, 3 scalar */
  double tcoord_length;
  float* parameter;      /**< [points] curve parameter u in [0, 1] */
  int64_t* line_ids;     /**< [cells] original line */
  int64_t* offsets;      /**< [cells + 1] */
  int64_t* connectivity; /**< [connectivity] */
  /* where each output point comes from, for attributes: between two input points of its line */
  double* curve_points;    /**< [curve_points x 3] port 1 */
  int64_t* curve_offsets;  /**< [curves + 1] */
  int64_t* curve_line_ids; /**< [curves] */
} chi_tube_outputs;

CHI_API CHI_NODISCARD chi_status chi_tube_create(const chi_exec* exec, chi_tube** tube);
CHI_API void chi_tube_destroy(const chi_exec* exec, chi_tube* tube);

/** Choose rings and radii; afterwards the sizes are known and nothing has been written. */
CHI_API CHI_NODISCARD chi_status chi_tube_plan(const chi_exec* exec, chi_tube* tube,
  const chi_spline* spline, const chi_lines_view* lines, const chi_tube_params* params);
CHI_API void chi_tube_get_sizes(const chi_tube* tube, chi_tube_sizes* sizes);

/** Write the surface planned last. */
CHI_API CHI_NODISCARD chi_status chi_tube_sweep(const chi_exec* exec, const chi_tube* tube,
  const chi_spline* spline, const chi_tube_outputs* outputs);

enum
{
  CHI_TUBE_SURFACE = 0,
  CHI_TUBE_CURVES = 1
};

/**
 * Carry one point array through the spline to the surface's or the curves' points. Float types:
 * monotone along the line, no overshoot; other types: from the nearest input point.
 */
CHI_API CHI_NODISCARD chi_status chi_tube_attribute(const chi_exec* exec, const chi_tube* tube,
  const chi_spline* spline, int32_t target, const chi_array_view* in, const chi_array_view* out);

/** Nearest input point id for every output point (strings and other arrays that the core cannot
 * read). */
CHI_API CHI_NODISCARD chi_status chi_tube_nearest(const chi_exec* exec, const chi_tube* tube,
  const chi_spline* spline, int32_t target, int64_t* ids);

#ifdef __cplusplus
}
#endif
#endif
