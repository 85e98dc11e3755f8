/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_DESCRIBE_H
#define CHI_OCCLUSION_DESCRIBE_H

#include <chiaroscuro/chi_occlusion_plan.h>

#include "chi_occlusion_internal.h"

/* The last plan and what it points to. */
typedef struct chi_plan_keep
{
  chi_occlusion_plan plan;
  chi_plan_shading shading;
  chi_buffer shifts, rects, surface, planes, guide;
} chi_plan_keep;

/* `whole` is the frame as the caller has it, `frame` the one that is drawn: smaller where pictures
 * are reduced. */
chi_status chi_plan_fill(const chi_exec* exec, chi_plan_keep* keep, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* whole, const chi_occlusion_frame* frame);
void chi_plan_free(const chi_exec* exec, chi_plan_keep* keep);

/* How a reduced picture is enlarged; chi_reduction.c. `guide`: floats of the whole picture; NULL
 * without a surface. */
chi_status chi_reduction_describe(const chi_exec* exec, const chi_occlusion_frame* whole,
  const chi_scene* scene, float* guide, chi_occlusion_plan* plan);

#endif
