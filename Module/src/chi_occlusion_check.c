/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Which frames are valid. */

#include "chi_components_internal.h"
#include "chi_mask_internal.h"
#include "chi_occlusion_frame.h"
#include "chi_occlusion_internal.h"

#include <float.h>
#include <math.h>

static int all_finite(const double* x, int count)
{
  for (int i = 0; i < count; ++i)
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
  return c && c->width >= 1 && c->height >= 1 && c->width <= 32768 && c->height <= 32768 &&
    all_finite(c->world_to_eye, 16) && all_finite(c->window, 4) && c->window[0] != c->window[1] &&
    c->window[2] != c->window[3] && !isnan(c->near_depth) &&
    (c->parallel || (c->near_depth > 0 && isfinite(c->near_depth)));
}

static chi_status check_volume(const chi_volume_view* v)
{
  const size_t size = chi_type_size(v->type);
  if (!v->scalars || !size || v->stride < size || !all_finite(v->index_to_world, 16) ||
    (v->interpolation != CHI_NEAREST && v->interpolation != CHI_LINEAR))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  size_t samples = 1;
  for (int a = 0; a < 3; ++a)
  {
    if (v->dimensions[a] == 0)
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    if (v->dimensions[a] > (size_t)INT32_MAX / samples)
    {
      return CHI_ERROR_TOO_LARGE; /* the kernels address samples by 32 bits */
    }
    samples *= v->dimensions[a];
  }
  return v->stride > SIZE_MAX / samples ? CHI_ERROR_TOO_LARGE : CHI_OK;
}

int chi_transfer_is_valid(const chi_transfer_view* t)
{
  return t &&
    (t->plane ? chi_transfer_plane_is_valid(t) && t->table_count <= 1
              : t->rgb && t->opacity && t->count >= 2 && t->count <= 65536 &&
          t->table_count <= 32 * CHI_LABEL_WORDS &&
          t->count * (t->table_count ? t->table_count : 1) <= (size_t)1 << 22 &&
          chi_gradient_opacity_is_valid(t)) &&
    all_finite(t->range, 2) && t->range[0] < t->range[1] && t->unit_distance > 0 &&
    isfinite(t->unit_distance);
}

static int cone_is_valid(double angle)
{
  const double degree = 0.017453292519943295;
  return angle >= 0.999999 * degree && angle <= 85.000001 * degree;
}

static int lights_are_valid(const chi_occlusion_params* p)
{
  for (int c = 0; c < 3 && p->colored_attenuation; ++c)
  {
    if (!(p->attenuation[c] >= 0 && p->attenuation[c] <= FLT_MAX))
    {
      return 0;
    }
  }
  return cone_is_valid(p->cone_angle_rad) && all_finite(p->light_direction, 3) &&
    all_finite(p->second_light_direction, 3) && p->second_light_share >= 0 &&
    p->second_light_share <= 1 &&
    (p->second_light_cone_angle_rad == 0 || cone_is_valid(p->second_light_cone_angle_rad));
}

static int params_are_valid(const chi_occlusion_params* p)
{
  return p && (p->method == CHI_OCCLUSION_ORDINATES || p->method == CHI_OCCLUSION_PUBLISHED) &&
    p->directions >= 1 && p->directions <= CHI_MAX_DIRECTIONS && lights_are_valid(p) &&
    p->strength >= 0 && p->strength <= 1 && p->sample_distance >= 0 &&
    isfinite(p->sample_distance) && isfinite(p->bias) && p->geometry_thickness >= 0 &&
    (p->combine == CHI_COMBINE_PRODUCT || p->combine == CHI_COMBINE_MINIMUM) &&
    p->geometry_opacity >= 0 && p->geometry_opacity <= 1 && p->vicinity_samples >= 0 &&
    p->vicinity_samples <= CHI_MAX_VICINITY_SAMPLES && p->vicinity_distance >= 0 &&
    isfinite(p->vicinity_distance) && p->vicinity_bias >= 0 && isfinite(p->vicinity_bias) &&
    p->skip >= 0 && p->reduction >= 0 && p->reduction <= 4 &&
    (p->coarsening == 0 || (p->coarsening >= 1 && p->coarsening <= 64)) &&
    (p->color_integration == CHI_COLOR_PREINTEGRATED || p->color_integration == CHI_COLOR_MIDDLE);
}

static int surface_is_valid(const chi_surface_view* s)
{
  return !s || (s->depth && !s->edge_depth == !s->edge_rgba);
}

/* Shading, gradients and labels are for one component (chi_components.h). */
static int components_are_valid(const chi_occlusion_frame* frame)
{
  return !frame->volume || !frame->components ||
    (chi_components_are_valid(frame->components, frame->volume) && !frame->shading &&
      !frame->transfer->gradient_opacity && !frame->transfer->plane &&
      !(frame->mask && frame->mask->table_of_value));
}

chi_status chi_frame_check(chi_own_frame* own, const chi_occlusion_frame* given)
{
  if (!chi_frame_adopt(own, given))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const chi_occlusion_frame* const frame = &own->frame;
  if (!camera_is_valid(frame->camera) || !params_are_valid(frame->params) ||
    (frame->volume && !chi_transfer_is_valid(frame->transfer)) ||
    !surface_is_valid(frame->surface) || !chi_layers_are_valid(frame->layers) ||
    !chi_shading_is_valid(frame->shading) || frame->clip_plane_count > CHI_MAX_CLIP_PLANES ||
    (frame->clip_plane_count &&
      !(frame->clip_planes && all_finite(frame->clip_planes, 4 * (int)frame->clip_plane_count))) ||
    (frame->crop && !all_finite(frame->crop->planes[0], 24)) || !components_are_valid(frame) ||
    (frame->mask &&
      !chi_mask_is_valid(frame->mask, frame->transfer ? frame->transfer->table_count : 1)) ||
    (frame->probes && frame->probes->count &&
      !(frame->probes->position && frame->probes->visibility)))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  return frame->volume ? check_volume(frame->volume) : CHI_OK;
}
