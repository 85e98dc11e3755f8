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

int chi_mask_is_valid(const chi_mask_view* view, size_t tables);

/* `reach`: bricks by which a segment may leave the brick of its sample, see chi_classify. */
chi_status chi_mask_build(const chi_exec* exec, chi_mask* mask, const chi_bricks* bricks,
  const chi_volume_view* volume, const chi_mask_view* view, int reach);
void chi_mask_free(const chi_exec* exec, chi_mask* mask);

/* Bricks of which nothing is left are not occupied. */
void chi_mask_apply(const chi_mask* mask, const chi_bricks* bricks, chi_classification* out);

/* What both engines need of it; 0 where nothing is cut. `mask` may be NULL. */
int chi_cut_prepare(chi_plan_cut* cut, const chi_scene* scene, const chi_mask* mask);

/* Whether anything is masked within, or near, [low, high] of index space; 0 without a mask. */
int chi_mask_cuts(
  const chi_mask* mask, const chi_bricks* bricks, const double low[3], const double high[3]);

#endif
