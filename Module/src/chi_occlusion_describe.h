/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_OCCLUSION_DESCRIBE_H
#define CHI_OCCLUSION_DESCRIBE_H

#include <chiaroscuro/chi_occlusion_plan.h>

#include "chi_occlusion_internal.h"

/* Rectangles; x0 >= x1 or y0 >= y1: nothing. */
static inline int32_t chi_lesser(int32_t a, int32_t b)
{
  return a < b ? a : b;
}

static inline int32_t chi_greater(int32_t a, int32_t b)
{
  return a > b ? a : b;
}

static inline int chi_rect_is_empty(chi_rect r)
{
  return r.x0 >= r.x1 || r.y0 >= r.y1;
}

static inline chi_rect chi_rect_join(chi_rect a, chi_rect b)
{
  if (chi_rect_is_empty(a))
  {
    return b;
  }
  if (chi_rect_is_empty(b))
  {
    return a;
  }
  return (chi_rect){ chi_lesser(a.x0, b.x0), chi_lesser(a.y0, b.y0), chi_greater(a.x1, b.x1),
    chi_greater(a.y1, b.y1) };
}

static inline void chi_rect_add(chi_rect* rect, int32_t x, int32_t y)
{
  *rect = chi_rect_join(*rect, (chi_rect){ x, y, x + 1, y + 1 });
}

/* The last plan and what it points to. */
typedef struct chi_plan_keep
{
  chi_occlusion_plan plan;
  chi_plan_shading shading;
  chi_plan_cut cut;
  chi_plan_components components;
  const struct chi_component_set* set; /* of chi_occlusion */
  chi_buffer shifts, rects, surface, planes, guide, layers;
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

/* Translucent layers and edges, those of a pixel by depth; chi_occlusion_describe_layers.c. After
 * the surfaces. `spots` and `receivers`: rectangles [slabs], empty. */
chi_status chi_plan_layers(const chi_exec* exec, chi_plan_keep* keep, const chi_scene* scene,
  const chi_occlusion_frame* frame, chi_rect* spots, chi_rect* receivers);

/* Add a pixel that receives light at a plane to those of its slab, or to those behind all. */
void chi_plan_receive(const chi_occlusion_plan* plan, float plane, int32_t x, int32_t y,
  chi_rect* receivers, chi_rect* beyond);

/* Shift that is left behind the last slab for what lies at this light plane; 0 before that. */
float chi_plan_beyond(const chi_scene* scene, double plane);

#endif
