/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_MASK_INTERNAL_H
#define CHI_MASK_INTERNAL_H

#include "chi_occlusion_internal.h"

typedef enum chi_cut_share
{
  CHI_CUT_NOTHING,
  CHI_CUT_PART,
  CHI_CUT_ALL
} chi_cut_share;

/* What the cropping regions take of a hexahedron in index space, or may take. */
chi_cut_share chi_crop_share(const chi_scene* scene, const double corner[8][3]);

#endif
