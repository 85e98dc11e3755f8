/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* What a frame asks for beyond what every plan describes. */

#include "chi_occlusion_frame.h"
#include "chi_occlusion_internal.h"

#include <string.h>

/* Features that the plan describes end with these members; what is appended after them must be as
 * in a default frame, or another engine would leave it out in silence. */
static int tail_differs(const void* given, const void* expected, size_t known, size_t size)
{
  return size > known &&
    memcmp((const char*)given + known, (const char*)expected + known, size - known) != 0;
}

static int is_colored(const chi_occlusion_params* p)
{
  const float red = (float)p->attenuation[0], green = (float)p->attenuation[1];
  return p->colored_attenuation && (red != green || green != (float)p->attenuation[2]);
}

static int has_edges(const chi_surface_view* s)
{
  return s && (s->end || s->edge_depth || s->edge_rgba);
}

static int is_masked(const chi_mask_view* m)
{
  return m && (m->values || m->point_flags || m->cell_flags);
}

uint64_t chi_occlusion_features(const chi_occlusion_frame* given)
{
  chi_own_frame own;
  if (!chi_frame_adopt(&own, given))
  {
    return CHI_FEATURE_OTHER;
  }
  const chi_occlusion_frame* const frame = &own.frame;
  chi_occlusion_params params;
  memset(&params, 0, sizeof params);
  chi_occlusion_default_params(&params);
  const chi_occlusion_frame no_frame = { 0 };
  const chi_volume_view no_volume = { 0 };
  const chi_transfer_view no_transfer = { 0 };
  const chi_surface_view no_surface = { 0 };
  int other = tail_differs(frame->params, &params, CHI_BEYOND(chi_occlusion_params, coarsening),
                sizeof params) ||
    tail_differs(frame, &no_frame, CHI_BEYOND(chi_occlusion_frame, components), sizeof *frame);
  if (frame->volume)
  {
    other |= tail_differs(
               frame->volume, &no_volume, CHI_BEYOND(chi_volume_view, version), sizeof no_volume) ||
      tail_differs(frame->transfer, &no_transfer, CHI_BEYOND(chi_transfer_view, table_count),
        sizeof no_transfer);
  }
  if (frame->surface)
  {
    other |= tail_differs(
      frame->surface, &no_surface, CHI_BEYOND(chi_surface_view, edge_rgba), sizeof no_surface);
  }
  return (frame->params->method == CHI_OCCLUSION_PUBLISHED ? (uint64_t)CHI_FEATURE_PUBLISHED : 0) |
    (frame->layers && frame->layers->count > 0 ? (uint64_t)CHI_FEATURE_LAYERS : 0) |
    (frame->crop && (frame->crop->regions & CHI_CROP_ALL_REGIONS) != CHI_CROP_ALL_REGIONS
        ? (uint64_t)CHI_FEATURE_CROP
        : 0) |
    (frame->volume && frame->transfer->plane ? (uint64_t)CHI_FEATURE_TRANSFER_PLANE : 0) |
    (frame->volume && is_masked(frame->mask) ? (uint64_t)CHI_FEATURE_MASK : 0) |
    (chi_reduction_of(frame) > 1 ? (uint64_t)CHI_FEATURE_REDUCTION : 0) |
    (frame->volume && frame->components ? (uint64_t)CHI_FEATURE_COMPONENTS : 0) |
    (has_edges(frame->surface) ? (uint64_t)CHI_FEATURE_EDGES : 0) |
    (frame->volume && frame->shading ? (uint64_t)CHI_FEATURE_SHADING : 0) |
    (frame->volume && frame->transfer->gradient_opacity ? (uint64_t)CHI_FEATURE_GRADIENT_OPACITY
                                                        : 0) |
    (is_colored(frame->params) ? (uint64_t)CHI_FEATURE_COLORED : 0) |
    (other ? (uint64_t)CHI_FEATURE_OTHER : 0);
}

const char* chi_occlusion_feature_name(uint64_t feature)
{
  switch (feature)
  {
    case CHI_FEATURE_PUBLISHED:
      return "the published occlusion method";
    case CHI_FEATURE_TRANSFER_PLANE:
      return "two-dimensional transfer functions";
    case CHI_FEATURE_MASK:
      return "masks, blanking and labels";
    case CHI_FEATURE_REDUCTION:
      return "pictures of fewer pixels, enlarged";
    case CHI_FEATURE_COMPONENTS:
      return "several components";
    case CHI_FEATURE_EDGES:
      return "geometry of several samples a pixel";
    case CHI_FEATURE_SHADING:
      return "shading by gradients";
    case CHI_FEATURE_GRADIENT_OPACITY:
      return "opacity by gradients";
    case CHI_FEATURE_COLORED:
      return "coloured attenuation of light";
    case CHI_FEATURE_CROP:
      return "cropping regions";
    case CHI_FEATURE_LAYERS:
      return "translucent geometry inside the volume";
    default:
      return "a setting that this engine does not know";
  }
}
