/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_EXECUTOR_H
#define CHI_OCCLUSION_EXECUTOR_H

/*
 * A third engine, as plain as can be: it carries plans out slab by slab, in doubles, by the words
 * of chi_occlusion_plan.h and theory/occlusion.md.
 */

#include <chiaroscuro/chi_occlusion_plan.h>

enum
{
  EXECUTED_CHANNELS = 5 /* red, green, blue, transmittance, visibility of the surface */
};

/*
 * The picture [height][width][EXECUTED_CHANNELS] of a plan without features but the published
 * method: of one field and one channel of light, without vicinity, of linear floats, with the
 * colours of segments' middles. To be freed. `everywhere`: no notice is taken of the plan's
 * rectangles.
 */
double* execute_plan(const chi_occlusion_plan* plan, int everywhere);

#endif
