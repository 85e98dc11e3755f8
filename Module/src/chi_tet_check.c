/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_handle.h"

#include "chi_tet_occlusion.h"

#include <math.h>

static int all_finite(const double* x, size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    if (!isfinite(x[i]))
    {
      return 0;
    }
  }
  return 1;
}

static int camera_is_valid(const chi_camera* c)
{
  return c->width >= 1 && c->height >= 1 && c->width <= CHI_TET_MAX_SIZE &&
    c->height <= CHI_TET_MAX_SIZE && all_finite(c->world_to_eye, 16) && all_finite(c->window, 4) &&
    c->window[0] != c->window[1] && c->window[2] != c->window[3] && !isnan(c->near_depth) &&
    (c->parallel || (c->near_depth > 0 && isfinite(c->near_depth)));
}

static int field_is_valid(const chi_tet_field* f)
{
  const int one = chi_array_is_valid(f->scalars) && f->component >= -1 &&
    f->component < (int64_t)f->scalars->components;
  return one &&
    (!f->opacity ||
      (chi_array_is_valid(f->opacity) && f->opacity_component >= -1 &&
        f->opacity_component < (int64_t)f->opacity->components && !f->colors)) &&
    (!f->second ||
      (chi_array_is_valid(f->second) && f->second_component >= -1 &&
        f->second_component < (int64_t)f->second->components)) &&
    (!f->colors ||
      (chi_array_is_valid(f->colors) && f->color_component >= 0 &&
        f->color_component + (int64_t)3 <= (int64_t)f->colors->components &&
        all_finite(f->color_range, 2) &&
        (f->color_range[0] != f->color_range[1] ||
          (f->color_range[0] == 0 && f->color_range[1] == 0))));
}

static int params_are_valid(const chi_tet_params* p)
{
  return p->order >= CHI_TET_ORDER_AUTO && p->order <= CHI_TET_ORDER_XMPVO &&
    p->pre_integration >= CHI_PREINTEGRATION_AUTO &&
    p->pre_integration <= CHI_PREINTEGRATION_FULL &&
    (p->opacity_convention == CHI_OPACITY_LINEAR || p->opacity_convention == CHI_OPACITY_IMAGE) &&
    (p->blend == CHI_TET_BLEND_COMPOSITE || p->blend == CHI_TET_BLEND_MAXIMUM) && p->skip >= 0 &&
    p->reduction >= 0 && p->reduction <= 8 && p->projection >= CHI_TET_PROJECTION_EXACT &&
    p->projection <= CHI_TET_PROJECTION_PUBLISHED && chi_tet_occlusion_is_valid(p);
}

/* The frame as one of ours, checked. The grid, the arrays and the transfer function are checked in
 * full by the stages that read them. */
chi_status chi_tet_adopt_frame(chi_tet_own_frame* own, const chi_tet_frame* given)
{
  memset(own, 0, sizeof *own);
  chi_tet_default_params(&own->params);
  chi_tet_frame* const f = &own->frame;
  if (!given || !CHI_ADOPT(chi_tet_frame, clip_plane_count, f, given) || !f->camera || !f->grid ||
    !f->field || !f->transfer || !CHI_ADOPT(chi_camera, near_depth, &own->camera, f->camera) ||
    !CHI_ADOPT(chi_grid_view, version, &own->grid, f->grid) ||
    !CHI_ADOPT(chi_tet_field, version, &own->field, f->field) ||
    !CHI_ADOPT(chi_transfer_view, version, &own->transfer, f->transfer) ||
    (f->surface && !CHI_ADOPT(chi_surface_view, version, &own->surface, f->surface)) ||
    (f->shading && !CHI_ADOPT(chi_shading_view, light_count, &own->shading, f->shading)) ||
    (f->params && !CHI_ADOPT(chi_tet_params, automatic_unit_distance, &own->params, f->params)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  f->camera = &own->camera;
  f->grid = &own->grid;
  f->field = &own->field;
  f->transfer = &own->transfer;
  f->surface = f->surface ? &own->surface : NULL;
  f->params = &own->params;
  f->shading = f->shading ? &own->shading : NULL;
  chi_tet_params* const p = &own->params;
  p->subpixel_splatting = p->subpixel_splatting && p->blend == CHI_TET_BLEND_COMPOSITE &&
    p->projection == CHI_TET_PROJECTION_EXACT && !chi_tet_is_occluded(p) && !f->transfer->plane;
  if (own->params.skip & CHI_TET_SKIP_ALL)
  {
    own->params.skip |= CHI_TET_SKIP_EVERY_KIND;
  }
  const int of_two = f->transfer->plane != NULL;
  if (of_two &&
    (f->field->opacity || f->field->colors ||
      own->params.projection == CHI_TET_PROJECTION_PUBLISHED))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  return camera_is_valid(f->camera) && field_is_valid(f->field) && params_are_valid(f->params) &&
      (!f->surface || f->surface->depth) && chi_shading_is_valid(f->shading) &&
      (!f->grid_to_world || all_finite(f->grid_to_world, 16)) &&
      f->clip_plane_count <= CHI_TET_MAX_CLIP_PLANES &&
      (!f->clip_plane_count ||
        (f->clip_planes && all_finite(f->clip_planes, 4 * f->clip_plane_count)))
    ? CHI_OK
    : CHI_ERROR_INVALID_ARGUMENT;
}
