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
  chi_buffer shifts, rects, surface, planes;
} chi_plan_keep;

chi_status chi_plan_fill(const chi_exec* exec, chi_plan_keep* keep, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* frame);
void chi_plan_free(const chi_exec* exec, chi_plan_keep* keep);

#endif
