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
  uint64_t version;   /**< differs whenever the depths do */
} chi_surface_view;

#ifdef __cplusplus
}
#endif
#endif
