/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Small frames of any volume, surface, camera and parameters: refused where the header says so,
 * else a picture of premultiplied colours and visibilities between 0 and 1. */

#include "fuzz_occlusion_features.h"

static chi_volume_view fuzz_volume(fuzz* f)
{
  static const chi_type types[] = { CHI_U8, CHI_F32, CHI_I16, CHI_F64, CHI_I8, CHI_U16, CHI_I32,
    CHI_U32, CHI_I64, CHI_U64 };
  chi_volume_view v = { .struct_size = fuzz_size(f, sizeof v) };
  for (int k = 0; k < 3; ++k)
  {
    v.dimensions[k] = 1 + fuzz_upto(f, fuzz_once_in(f, 4) ? 1 : 12);
  }
  const size_t count = v.dimensions[0] * v.dimensions[1] * v.dimensions[2];
  v.type = types[fuzz_upto(f, 9)];
  const chi_array_view scalars = fuzz_array(f, count, 1, v.type);
  v.scalars = scalars.data;
  v.stride = scalars.stride;
  fuzz_matrix(f, v.index_to_world, 0);
  v.is_cell_data = fuzz_byte(f) & 1;
  v.interpolation = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 2) : (int32_t)(fuzz_byte(f) & 1);
  v.version = ++f->versions;
  if (fuzz_once_in(f, 64)) /* one thing that is wrong */
  {
    const size_t which = fuzz_upto(f, 3);
    v.scalars = which == 0 ? NULL : v.scalars;
    v.stride = which == 1 ? 0 : v.stride;
    v.dimensions[0] = which == 2 ? 0 : v.dimensions[0];
    v.type = which == 3 ? (chi_type)77 : v.type;
  }
  return v;
}

static chi_occlusion_params fuzz_params(fuzz* f)
{
  chi_occlusion_params p;
  chi_occlusion_default_params(&p);
  p.struct_size = fuzz_size(f, sizeof p);
  p.method = fuzz_once_in(f, 64) ? (int32_t)fuzz_bits(f, 2) : (int32_t)(fuzz_byte(f) & 1);
  p.directions =
    fuzz_once_in(f, 32) ? (int32_t)fuzz_bits(f, 2) - 9 : (int32_t)(1 + fuzz_upto(f, 63));
  p.half_size = fuzz_byte(f) & 1;
  p.interactions = (int32_t)fuzz_upto(f, 15);
  p.cone_angle_rad = fuzz_mostly(f, 0.0175 + (double)fuzz_byte(f) / 180);
  p.strength = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
  p.sample_distance = fuzz_mostly(f, (double)fuzz_byte(f) / 128);
  p.bias = fuzz_mostly(f, fuzz_unit(f));
  p.geometry_thickness = fuzz_once_in(f, 4) ? INFINITY : fuzz_mostly(f, (double)fuzz_byte(f) / 64);
  p.skip = fuzz_byte(f) & 1 ? CHI_SKIP_ALL : (int32_t)fuzz_upto(f, CHI_SKIP_EVERY_KIND);
  p.reduction = fuzz_once_in(f, 4) ? (int32_t)fuzz_upto(f, 5) : 0;
  p.coarsening = fuzz_once_in(f, 4) ? fuzz_mostly(f, 1 + (double)fuzz_byte(f) / 64) : 0;
  p.combine = (int32_t)fuzz_upto(f, fuzz_once_in(f, 64) ? 5 : 1);
  p.geometry_opacity = fuzz_mostly(f, (double)fuzz_byte(f) / 255);
  p.vicinity_samples = (int32_t)fuzz_upto(f, fuzz_once_in(f, 64) ? 200 : 40);
  p.vicinity_distance = fuzz_mostly(f, (double)fuzz_byte(f) / 64);
  p.vicinity_bias = fuzz_mostly(f, (double)fuzz_byte(f) / 256);
  fuzz_lights(f, &p);
  return p;
}

static void check_picture(const chi_occlusion* o, const chi_camera* c)
{
  chi_occlusion_image image;
  chi_occlusion_get_image(o, &image);
  FUZZ_CHECK(
    image.width == c->width && image.height == c->height && image.rgba && image.visibility);
  const size_t pixels = (size_t)c->width * (size_t)c->height;
  /* sums of products of numbers up to 1, in float: a few hundred roundings of 6e-8 */
  const double over = 1 + 1e-4;
  for (size_t i = 0; i < pixels; ++i)
  {
    const float* const p = image.rgba + 4 * i;
    FUZZ_CHECK(fuzz_is_in((double)p[3], 0, over));
    for (int k = 0; k < 3; ++k)
    {
      FUZZ_CHECK(fuzz_is_in((double)p[k], 0, (double)p[3] * over + 1e-6));
    }
    FUZZ_CHECK(fuzz_is_in((double)image.visibility[i], 0, over));
  }
}

/* A call on a frame that has been drawn already. */
static int succeeds_unless_stopped(const fuzz* f, chi_status status)
{
  return status == CHI_OK || (status == CHI_ERROR_OUT_OF_MEMORY && f->refused) ||
    (status == CHI_ERROR_CANCELLED && f->cancelled);
}

static int lies_within(const chi_rect* r, int32_t width, int32_t height)
{
  return r->x0 >= r->x1 || r->y0 >= r->y1 ||
    (r->x0 >= 0 && r->y0 >= 0 && r->x1 <= width && r->y1 <= height);
}

/* What can be drawn can be described, in the bounds that its reader relies on. */
static void check_plan(
  fuzz* f, chi_occlusion* o, const chi_exec* exec, const chi_occlusion_frame* frame)
{
  chi_occlusion_plan plan = { .struct_size = sizeof plan };
  fuzz_before(f);
  const chi_status status = chi_occlusion_describe(exec, o, frame, &plan);
  FUZZ_CHECK(succeeds_unless_stopped(f, status));
  if (status != CHI_OK)
  {
    return;
  }
  FUZZ_CHECK(plan.features == chi_occlusion_features(frame));
  for (int64_t g = 0; g < plan.slabs; ++g)
  {
    FUZZ_CHECK(lies_within(plan.samples + g, plan.width, plan.height));
    FUZZ_CHECK(lies_within(plan.receivers + g, plan.width, plan.height));
    FUZZ_CHECK(lies_within(plan.light + g, plan.light_width, plan.light_height));
  }
  const uint64_t gradients =
    CHI_FEATURE_SHADING | CHI_FEATURE_GRADIENT_OPACITY | CHI_FEATURE_TRANSFER_PLANE;
  const chi_plan_shading* const s = plan.shading;
  FUZZ_CHECK((s != NULL) == ((plan.features & gradients) != 0));
  FUZZ_CHECK(!s || !s->lit == !frame->shading);
  FUZZ_CHECK(!s || !s->gradient_opacity || s->gradient_end >= 1);
  if (s && s->plane_table)
  {
    FUZZ_CHECK((size_t)s->plane_row == plan.entries && s->plane_end >= 1);
    const chi_plan_entry* const last =
      s->plane_table + (size_t)s->plane_row * ((size_t)s->plane_end + 1) - 1;
    FUZZ_CHECK(last->sigma == INFINITY || (last->sigma >= 0 && last->half_slope == 0));
  }
}

static void render(fuzz* f, chi_occlusion* o)
{
  const chi_camera camera = fuzz_camera(f);
  const chi_volume_view volume = fuzz_volume(f);
  chi_transfer_view transfer = fuzz_transfer(f);
  fuzz_add_tables(f, &transfer, &volume);
  const chi_occlusion_params params = fuzz_params(f);
  const int32_t w = camera.width, h = camera.height;
  const int small = w > 0 && h > 0 && w < 4096 && h < 4096;
  const size_t pixels = small ? (size_t)w * (size_t)h : 0;
  float* const depth = (float*)fuzz_new(f, pixels * sizeof *depth);
  for (size_t i = 0; i < pixels; ++i)
  {
    depth[i] = i < 64 && fuzz_once_in(f, 16) ? (float)fuzz_any(f)
      : fuzz_byte(f) & 1                     ? 12 + (float)fuzz_unit(f)
                                             : INFINITY;
  }
  const chi_surface_view surface = {
    .struct_size = sizeof surface, .depth = depth, .version = ++f->versions
  };
  float* const depth_found = (float*)fuzz_new(f, pixels * sizeof *depth_found);
  double position[3 * 8];
  float visibility[8];
  for (int i = 0; i < 24; ++i)
  {
    position[i] =
      i % 3 == 2 ? fuzz_mostly(f, 12 + fuzz_unit(f)) : fuzz_mostly(f, (double)fuzz_byte(f) / 8);
  }
  const chi_occlusion_probes probes = { position, visibility, fuzz_upto(f, 8) };
  chi_occlusion_frame frame = { .struct_size = fuzz_size(f, sizeof frame),
    .camera = &camera,
    .volume = fuzz_once_in(f, 8) ? NULL : &volume,
    .transfer = fuzz_once_in(f, 32) ? NULL : &transfer,
    .surface = small && fuzz_byte(f) & 1 ? &surface : NULL,
    .params = &params,
    .probes = fuzz_byte(f) & 1 ? &probes : NULL };
  fuzz_features features;
  fuzz_add_features(f, &features, &frame, &volume, &transfer, pixels);
  /* a frame of very many slices is honest, but ends here */
  const chi_exec exec = fuzz_host(f, 20000);
  const chi_status status = chi_occlusion_render(&exec, o, &frame);
  FUZZ_CHECK(status >= CHI_OK && status <= CHI_ERROR_NOT_READY && status != CHI_ERROR_EMPTY);
  /* a buffer whose size overflows is refused before the host is asked */
  FUZZ_CHECK(status != CHI_ERROR_OUT_OF_MEMORY || f->refused || (double)w * (double)h > 1e9);
  FUZZ_CHECK(status != CHI_ERROR_CANCELLED || f->cancelled);
  if (status == CHI_OK)
  {
    check_picture(o, &camera);
    for (size_t i = 0; i < probes.count && frame.probes; ++i)
    {
      const double* const p = position + 3 * i;
      const int finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
      FUZZ_CHECK(
        finite ? fuzz_is_in((double)visibility[i], -1e-4, 1 + 1e-4) : isnan(visibility[i]));
    }
    fuzz_before(f);
    FUZZ_CHECK(frame.probes || chi_occlusion_render(&exec, o, &frame) == CHI_OK);
    chi_occlusion_stats stats;
    chi_occlusion_get_stats(o, &stats);
    const int reuses = params.skip & (CHI_SKIP_ALL | CHI_SKIP_UNCHANGED);
    FUZZ_CHECK(frame.probes || stats.reused == (reuses != 0)); /* nothing changed */
    if (small && frame.volume)
    {
      fuzz_before(f);
      const double alpha = 0.01 + (double)fuzz_byte(f) / 260;
      const chi_status found = chi_occlusion_find_depth(&exec, o, &frame, alpha, depth_found);
      FUZZ_CHECK(succeeds_unless_stopped(f, found)); /* it has more pixels than a reduced picture */
      for (size_t i = 0; i < pixels && found == CHI_OK; ++i)
      {
        FUZZ_CHECK(depth_found[i] == INFINITY || isfinite(depth_found[i]));
      }
    }
    if (!frame.probes)
    {
      check_plan(f, o, &exec, &frame);
    }
  }
  else if (status == CHI_ERROR_OUT_OF_MEMORY || status == CHI_ERROR_CANCELLED)
  {
    chi_occlusion_image image;
    chi_occlusion_get_image(o, &image);
    FUZZ_CHECK(!image.rgba && image.width == 0);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  chi_exec exec = fuzz_host(f, 1000);
  chi_occlusion* o = NULL;
  const chi_status status = chi_occlusion_create(&exec, &o);
  FUZZ_CHECK((status == CHI_OK) == (o != NULL));
  for (int round = 0; o && round < 3; ++round) /* one handle, several frames */
  {
    const size_t kept = f->kept_count;
    render(f, o);
    fuzz_forget(f, kept);
  }
  exec = fuzz_host(f, 1000);
  chi_occlusion_destroy(&exec, o);
  fuzz_end(f);
  return 0;
}
