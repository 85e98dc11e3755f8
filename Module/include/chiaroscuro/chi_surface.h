/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SURFACE_H
#define CHI_SURFACE_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

/** What is known of opaque geometry per pixel of the camera's window (the G-buffer), borrowed. */
typedef struct chi_surface_view
{
  size_t struct_size;
  const float* depth; /**< [height x width] depth as in chi_camera, world units; +infinity, or
                         anything that is not a positive number, where there is no surface */
  uint64_t version;   /**< differs whenever anything here does */
  /** Pixels that a surface covers in part, for anti-aliased silhouettes; all NULL: none. The part
   * `edge` is blended like a translucent layer, and receives light; the ray goes on behind it, to
   * `end`. `depth` still is what blocks light. */
  const float* end;        /**< [height x width] where rays end; NULL: at `depth`. The visibility of
                              the picture is that of the surface there */
  const float* edge_depth; /**< [height x width] of the part; none where chi_layers_view has none */
  const float* edge_rgba;  /**< [height x width x 4] of the part: colour premultiplied by the share
                              of the pixel that it covers, and this share */
} chi_surface_view;

enum
{
  CHI_MAX_LAYERS = 4
};

/** Translucent geometry per pixel, layer by layer, borrowed. It neither blocks light nor ends rays:
 * each layer is blended where its depth lies in the volume, and receives light as a surface does.
 */
typedef struct chi_layers_view
{
  size_t struct_size;
  const float* depth; /**< [count x height x width] depth as in chi_surface_view, in any
                         order; no layer where it is not a positive number, infinite, or not in
                         front of the surface (of its `end`); of equal ones the first is in front */
  const float* rgba;  /**< [count x height x width x 4] colour premultiplied by alpha, and alpha 0
                         ... 1; what is not finite is no layer */
  uint64_t version;   /**< differs whenever depths or colours do */
  int32_t count;      /**< layers, 0 ... CHI_MAX_LAYERS */
  int32_t reserved;
} chi_layers_view;

#ifdef __cplusplus
}
#endif
#endif
