/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Frames of callers of any version. */

#include "chi_occlusion_frame.h"

#include "chi_internal.h"

/* Members after `last` were appended; they default to what `own` holds, zero unless said. */
#define ADOPT(type, last, own, pointer)                                                            \
  (!(pointer) || (CHI_ADOPT(type, last, (own), (pointer)) && ((pointer) = (own), 1)))

static int adopt_components(chi_own_frame* own)
{
  if (!own->frame.components)
  {
    return 1;
  }
  if (!ADOPT(chi_components, weight, &own->components, own->frame.components))
  {
    return 0;
  }
  chi_components* const c = &own->components;
  const int others = !c->dependent ? c->count - 1 : c->count == 2;
  int good = 1;
  for (int k = 0; k < CHI_MAX_COMPONENTS - 1 && k < others; ++k)
  {
    good &= ADOPT(chi_transfer_view, version, own->transfer + 1 + k, c->transfer[k]);
  }
  return good;
}

int chi_frame_adopt(chi_own_frame* own, const chi_occlusion_frame* given)
{
  memset(own, 0, sizeof *own);
  if (!given || !CHI_ADOPT(chi_occlusion_frame, probes, &own->frame, given))
  {
    return 0;
  }
  chi_occlusion_frame* const f = &own->frame;
  chi_occlusion_default_params(&own->params);
  return ADOPT(chi_camera, near_depth, &own->camera, f->camera) &&
    ADOPT(chi_volume_view, version, &own->volume, f->volume) &&
    ADOPT(chi_transfer_view, version, own->transfer, f->transfer) &&
    ADOPT(chi_surface_view, version, &own->surface, f->surface) &&
    ADOPT(chi_occlusion_params, skip, &own->params, f->params) &&
    ADOPT(chi_layers_view, count, &own->layers, f->layers) &&
    ADOPT(chi_crop_view, regions, &own->crop, f->crop) &&
    ADOPT(chi_shading_view, light_count, &own->shading, f->shading) &&
    ADOPT(chi_mask_view, version, &own->mask, f->mask) && adopt_components(own);
}
