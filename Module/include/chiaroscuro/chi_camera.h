/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_CAMERA_H
#define CHI_CAMERA_H

#include "chi.h"

#ifdef __cplusplus
extern "C"
{
#endif

/**
 * A view of the world through a window of pixels. Pixel (0, 0) is the lower left one; its centre
 * lies at window[0] + 0.5 / width * (window[1] - window[0]), and likewise upwards. "Depth" is
 * always the distance from the eye's plane along the view axis, positive in front of the eye.
 */
typedef struct chi_camera
{
  size_t struct_size;
  double world_to_eye[16]; /**< row-major, rigid; the eye looks along -z, as in OpenGL and VTK */
  double
    window[4]; /**< left, right, bottom, top: world units (parallel), or at depth 1 (perspective);
                    need not be symmetric, so that tiles and stereo pairs fit in */
  int32_t parallel;  /**< non-zero: parallel projection */
  int32_t width;     /**< pixels, >= 1 */
  int32_t height;    /**< pixels, >= 1 */
  double near_depth; /**< nothing nearer to the eye is drawn; world units, > 0 in perspective */
} chi_camera;

#ifdef __cplusplus
}
#endif
#endif
