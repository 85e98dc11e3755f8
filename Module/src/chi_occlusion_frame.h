/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_FRAME_H
#define CHI_OCCLUSION_FRAME_H

#include <chiaroscuro/chi_occlusion.h>

/* A frame with all its structs in this version; arrays stay the caller's. */
typedef struct chi_own_frame
{
  chi_occlusion_frame frame;
  chi_camera camera;
  chi_volume_view volume;
  chi_transfer_view transfer[CHI_MAX_COMPONENTS]; /* the frame's, then those of components */
  chi_surface_view surface;
  chi_occlusion_params params;
  chi_layers_view layers;
  chi_crop_view crop;
  chi_shading_view shading;
  chi_mask_view mask;
  chi_components components;
} chi_own_frame;

/* From the structs of a caller who may have another version: what is not NULL is there, and as long
 * as it says. 0 where one of them is not to be understood. Points into itself: not to be copied. */
int chi_frame_adopt(chi_own_frame* own, const chi_occlusion_frame* given);

/* Adopts a frame, and says whether all of it is valid (chi_occlusion_check.c). */
chi_status chi_frame_check(chi_own_frame* own, const chi_occlusion_frame* given);

#endif
