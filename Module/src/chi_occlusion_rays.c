/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays and light planes of one slab of a plan, in floats that lose nothing far from the eye. */

#include <chiaroscuro/chi_occlusion_plan.h>

#include <math.h>
#include <string.h>

void chi_occlusion_plan_slab(const chi_occlusion_plan* plan, int64_t slab, chi_plan_slab* out)
{
  memset(out, 0, sizeof *out);
  /* Counted from the middle of the samples, so that what is rounded to floats is small. */
  const chi_rect* const rect = plan->samples + slab;
  const double x = floor(0.5 * ((double)rect->x0 + rect->x1));
  const double y = floor(0.5 * ((double)rect->y0 + rect->y1));
  const double depth = plan->start + (double)slab * plan->slab;
  const double lateral = plan->parallel ? 1 : depth;
  out->pixel[0] = (float)x;
  out->pixel[1] = (float)y;
  for (int a = 0; a < 3; ++a)
  {
    const double across = x * plan->along_x[a] + y * plan->along_y[a];
    out->position[a] = (float)(plan->origin[a] + depth * plan->axis[a] + lateral * across);
    out->position_x[a] = (float)(lateral * plan->along_x[a]);
    out->position_y[a] = (float)(lateral * plan->along_y[a]);
    out->direction[a] = (float)(plan->slice * (plan->axis[a] + (plan->parallel ? 0 : across)));
    out->direction_x[a] = (float)(plan->parallel ? 0 : plan->slice * plan->along_x[a]);
    out->direction_y[a] = (float)(plan->parallel ? 0 : plan->slice * plan->along_y[a]);
  }
  /* Visibility is read at the near slice less the bias, but not from planes that are yet to come.
   */
  const double last = (double)slab - 1;
  const double first = fmin((double)slab - plan->sample_bias - 0.5, last);
  const double end = fmin(first + 1, last);
  out->is_lit = plan->strength > 0 && slab > 0 && end > -1 &&
    (plan->field[0].volume || plan->field[0].geometry);
  if (out->is_lit)
  {
    const double plane = floor(first);
    out->first_plane = (int64_t)plane;
    out->plane[0] = (float)(first - plane);
    out->plane[1] = (float)(1 / (double)plan->group);
    out->plane[2] = (float)(last - plane);
  }
}
