/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Frames of any grid, field, camera, cuts, lights and parameters, several of one handle, of which
 * each changes a part: refused where the header says so, else a picture of premultiplied colours,
 * which is that of a fresh handle on another host, cells that the grid has, and a plan whose
 * indices stay within its arrays. */

#include "fuzz_grids.h"
#include "fuzz_views.h"

#include <chiaroscuro/chi_tet.h>

enum
{
  ROUNDS = 4,
  MOST_POINTS = 1 << 16 /* of a grid that has values; those that claim more are broken */
};

typedef struct fuzz_scene
{
  chi_camera camera;
  chi_grid_view grid;
  double matrix[16], planes[4 * 4];
  chi_array_view scalars, opacity, colors;
  chi_tet_field field;
  chi_transfer_view transfer;
  chi_surface_view surface;
  chi_tet_params params;
  chi_shading_light lights[2];
  chi_shading_view shading;
  chi_tet_frame frame;
} fuzz_scene;

static size_t pixel_count(const chi_camera* c)
{
  const int small = c->width > 0 && c->height > 0 && c->width < 4096 && c->height < 4096;
  return small ? (size_t)c->width * (size_t)c->height : 0;
}

static chi_tet_params any_params(fuzz* f)
{
  static const int32_t usual[] = { CHI_PREINTEGRATION_PARTIAL, CHI_PREINTEGRATION_NONE,
    CHI_PREINTEGRATION_PARTIAL, CHI_PREINTEGRATION_AUTO }; /* full tables take long */
  chi_tet_params p;
  chi_tet_default_params(&p);
  p.struct_size = fuzz_size(f, sizeof p);
  p.order = (int32_t)fuzz_upto(f, 4);
  p.pre_integration = fuzz_once_in(f, 32) ? CHI_PREINTEGRATION_FULL : usual[fuzz_upto(f, 3)];
  p.opacity_convention = fuzz_byte(f) & 1;
  p.blend = fuzz_once_in(f, 4);
  p.skip = fuzz_byte(f) & 1 ? CHI_TET_SKIP_ALL : (int32_t)fuzz_upto(f, CHI_TET_SKIP_EVERY_KIND);
  p.automatic_unit_distance = fuzz_once_in(f, 4);
  p.reduction = fuzz_once_in(f, 4) ? (int32_t)fuzz_upto(f, 8) : 0;
  p.projection = fuzz_once_in(f, 8) ? CHI_TET_PROJECTION_PUBLISHED : CHI_TET_PROJECTION_EXACT;
  p.subpixel_splatting = fuzz_once_in(f, 4);
  p.fragment_cache_bytes = fuzz_byte(f) & 1 ? fuzz_upto(f, 65535) * fuzz_upto(f, 64) : 0;
  if (fuzz_once_in(f, 4))
  {
    p.occlusion_strength = (double)fuzz_upto(f, 4) / 4;
    p.cone_angle_degrees = (double)fuzz_upto(f, 85);
    p.occlusion_bias = (double)fuzz_upto(f, 8) / 8;
    p.direction_count = (int32_t)fuzz_upto(f, 20);
    p.occlusion_slabs = (int32_t)fuzz_upto(f, 40);
    p.full_size_light = fuzz_byte(f) & 1;
  }
  switch (fuzz_once_in(f, 32) ? 1 + fuzz_upto(f, 5) : 0) /* one thing that is wrong */
  {
    case 1:
      p.order = (int32_t)fuzz_bits(f, 4);
      break;
    case 2:
      p.pre_integration = (int32_t)fuzz_bits(f, 4);
      break;
    case 3:
      p.opacity_convention = (int32_t)fuzz_bits(f, 4);
      break;
    case 4:
      p.blend = (int32_t)fuzz_bits(f, 4);
      break;
    case 5:
      p.reduction = (int32_t)fuzz_bits(f, 4);
      break;
    case 6:
      p.skip = (int32_t)fuzz_bits(f, 4);
      break;
    default:
      break;
  }
  return p;
}

/* Values of the grid's points or cells, mostly of about the range of the transfer function. */
static chi_tet_field any_field(fuzz* f, fuzz_scene* s)
{
  chi_grid_counts counts;
  const chi_status status = chi_grid_count(NULL, &s->grid, &counts); /* one that is broken, too */
  FUZZ_CHECK(status == CHI_OK || counts.tetrahedra == 0);
  chi_tet_field field = { .struct_size = fuzz_size(f, sizeof field), .version = ++f->versions };
  field.is_cell_data = fuzz_byte(f) & 1;
  size_t count = field.is_cell_data ? counts.cells : counts.points;
  count = count < MOST_POINTS ? count : 1;
  count += fuzz_once_in(f, 64);
  const size_t components = 1 + fuzz_upto(f, 2);
  s->scalars = fuzz_array(f, count, components, (chi_type)(1 + fuzz_upto(f, 9)));
  s->opacity = fuzz_array(f, count, components, (chi_type)(1 + fuzz_upto(f, 9)));
  field.scalars = fuzz_once_in(f, 128) ? NULL : &s->scalars;
  field.opacity = fuzz_once_in(f, 4) ? &s->opacity : NULL;
  field.component = (int32_t)fuzz_upto(f, components + fuzz_once_in(f, 64)) - 1;
  field.opacity_component = (int32_t)fuzz_upto(f, components + fuzz_once_in(f, 64)) - 1;
  if (fuzz_once_in(f, 4)) /* given colours, and mostly no opacity beside them */
  {
    s->colors = fuzz_array(f, count + fuzz_once_in(f, 64), 4, (chi_type)(1 + fuzz_upto(f, 9)));
    field.colors = &s->colors;
    field.color_component = (int32_t)fuzz_upto(f, 1 + fuzz_once_in(f, 64));
    field.color_range[0] = fuzz_mostly(f, fuzz_unit(f));
    field.color_range[1] = fuzz_mostly(f, 1 + (double)fuzz_byte(f));
    field.opacity = fuzz_once_in(f, 16) ? field.opacity : NULL;
  }
  return field;
}

static chi_surface_view any_surface(fuzz* f, size_t pixels)
{
  float* const depth = (float*)fuzz_new(f, pixels * sizeof *depth);
  for (size_t i = 0; i < pixels; ++i)
  {
    depth[i] = i < 64 && fuzz_once_in(f, 16) ? (float)fuzz_any(f)
      : i % 3                                ? 12 + (float)fuzz_unit(f)
                                             : INFINITY;
  }
  return (chi_surface_view){
    .struct_size = fuzz_size(f, sizeof(chi_surface_view)), .depth = depth, .version = ++f->versions
  };
}

/* All of a scene, or what one frame changes of it. */
static void change(fuzz* f, fuzz_scene* s, int all)
{
  chi_tet_frame* const frame = &s->frame;
  if (all || fuzz_once_in(f, 4))
  {
    s->grid = fuzz_grid(f);
    s->grid.version = ++f->versions;
    s->field = any_field(f, s);
  }
  else if (fuzz_once_in(f, 4))
  {
    s->field = any_field(f, s);
  }
  if (all || fuzz_once_in(f, 3))
  {
    s->camera = fuzz_camera(f);
    s->camera.width += fuzz_once_in(f, 8) ? 100 : 0; /* several tiles */
    const size_t pixels = pixel_count(&s->camera);
    s->surface = any_surface(f, pixels);
    frame->surface = pixels && fuzz_byte(f) & 1 ? &s->surface : NULL;
  }
  if (all || fuzz_once_in(f, 3))
  {
    s->transfer = fuzz_transfer(f);
  }
  if (all || fuzz_once_in(f, 3))
  {
    s->params = any_params(f);
  }
  if (all || fuzz_once_in(f, 4))
  {
    fuzz_matrix(f, s->matrix, 0);
    frame->grid_to_world = fuzz_byte(f) & 1 ? s->matrix : NULL;
    fuzz_numbers(f, s->planes, 16, 3);
    frame->clip_plane_count = fuzz_once_in(f, 3) ? fuzz_upto(f, 4) : 0;
    frame->clip_planes = frame->clip_plane_count ? s->planes : NULL;
    if (fuzz_once_in(f, 128))
    {
      frame->clip_plane_count = CHI_TET_MAX_CLIP_PLANES + 1 + fuzz_upto(f, 255);
    }
    fuzz_shading(f, s->lights, &s->shading);
    frame->shading = fuzz_once_in(f, 3) ? &s->shading : NULL;
  }
  frame->struct_size = fuzz_size(f, sizeof *frame);
  frame->camera = fuzz_once_in(f, 128) ? NULL : &s->camera;
  frame->grid = fuzz_once_in(f, 128) ? NULL : &s->grid;
  frame->field = fuzz_once_in(f, 128) ? NULL : &s->field;
  frame->transfer = fuzz_once_in(f, 128) ? NULL : &s->transfer;
  frame->params = fuzz_once_in(f, 8) ? NULL : &s->params;
}

static int keeps_account(const fuzz* f, const chi_camera* c, chi_status status)
{
  /* a buffer whose size overflows is refused before the host is asked; kept fragments may be
   * refused without an error */
  return status >= CHI_OK && status <= CHI_ERROR_NOT_READY && status != CHI_ERROR_EMPTY &&
    (status != CHI_ERROR_OUT_OF_MEMORY || f->refused || (double)c->width * c->height > 1e9) &&
    (status != CHI_ERROR_CANCELLED || f->cancelled);
}

static void check_picture(const fuzz_scene* s, const chi_tet_image* image)
{
  FUZZ_CHECK(image->width == s->camera.width && image->height == s->camera.height && image->rgba);
  const int unclamped = s->frame.shading && s->shading.unclamped;
  const size_t pixels = (size_t)image->width * (size_t)image->height;
  /* sums of products of numbers up to 1, in float: a few hundred roundings of 6e-8 */
  const double over = 1 + 1e-4;
  for (size_t i = 0; i < pixels; ++i)
  {
    const float* const p = image->rgba + 4 * i;
    FUZZ_CHECK(fuzz_is_in((double)p[3], 0, over));
    for (int k = 0; k < 3; ++k)
    {
      FUZZ_CHECK(
        unclamped ? !isnan(p[k]) : fuzz_is_in((double)p[k], 0, (double)p[3] * over + 1e-6));
    }
  }
}

static void check_stats(const chi_tet* tet, int reuses)
{
  chi_tet_stats t;
  chi_tet_get_stats(tet, &t);
  FUZZ_CHECK(t.reused == reuses);
  FUZZ_CHECK(t.tetrahedra == (int64_t)t.grid.tetrahedra);
  FUZZ_CHECK(t.drawn >= 0 && t.fragments >= 0 && t.delicate >= 0 && t.delicate <= t.drawn);
  FUZZ_CHECK(
    t.non_finite_cells + t.outside + t.uncovered + t.skipped[1] + t.skipped[3] + t.skipped[4] <=
    t.tetrahedra);
  FUZZ_CHECK(t.order.used >= CHI_TET_ORDER_CENTROID && t.order.used <= CHI_TET_ORDER_XMPVO);
}

static void check_plan(fuzz* f, chi_tet* tet, const chi_exec* exec, const fuzz_scene* s)
{
  chi_tet_plan p = { .struct_size = sizeof p };
  fuzz_before(f);
  const chi_status status = chi_tet_describe(exec, tet, &s->frame, &p);
  FUZZ_CHECK(keeps_account(f, &s->camera, status));
  if (status != CHI_OK)
  {
    return;
  }
  uint8_t* const seen = (uint8_t*)calloc(p.count + 1, 1);
  FUZZ_CHECK(seen && p.sequence_count <= p.count);
  for (size_t i = 0; i < p.sequence_count; ++i)
  {
    const uint32_t t = p.sequence[i];
    FUZZ_CHECK(t < p.count && !seen[t]++);
    for (int k = 0; k < 4; ++k)
    {
      FUZZ_CHECK(p.vertices[4 * t + (uint32_t)k] < p.point_count);
    }
    FUZZ_CHECK(!p.is_cell_data || (p.cells ? p.cells[t] : t) < p.value_count);
  }
  free(seen);
}

static void check_cells(fuzz* f, chi_tet* tet, const chi_exec* exec, const fuzz_scene* s)
{
  const size_t pixels = pixel_count(&s->camera), kept = f->kept_count;
  int64_t* const cells = (int64_t*)fuzz_new(f, pixels * sizeof *cells);
  float* const depths = (float*)fuzz_new(f, pixels * sizeof *depths);
  const double opacity = fuzz_mostly(f, 0.01 + (double)fuzz_byte(f) / 260);
  fuzz_before(f);
  const chi_status status = chi_tet_find_cells(exec, tet, &s->frame, opacity, cells, depths);
  FUZZ_CHECK(keeps_account(f, &s->camera, status));
  FUZZ_CHECK(status != CHI_ERROR_INVALID_ARGUMENT || !(opacity > 0 && opacity < 1));
  chi_tet_stats t;
  chi_tet_get_stats(tet, &t);
  for (size_t i = 0; i < pixels && status == CHI_OK; ++i)
  {
    FUZZ_CHECK(cells[i] >= -1 && cells[i] < (int64_t)t.grid.cells);
    FUZZ_CHECK(cells[i] >= 0 ? isfinite(depths[i]) : depths[i] == INFINITY);
  }
  fuzz_forget(f, kept);
}

/* One picture, whatever the handle has drawn before, and whoever runs it. */
static void check_fresh(const fuzz_scene* s, const chi_tet_image* image)
{
  chi_tet* fresh = NULL;
  chi_tet_image other;
  FUZZ_CHECK(chi_tet_create(NULL, &fresh) == CHI_OK);
  FUZZ_CHECK(chi_tet_render(NULL, fresh, &s->frame) == CHI_OK);
  chi_tet_get_image(fresh, &other);
  const size_t bytes = 16 * (size_t)image->width * (size_t)image->height;
  FUZZ_CHECK(other.width == image->width && other.height == image->height);
  FUZZ_CHECK(memcmp(other.rgba, image->rgba, bytes) == 0);
  chi_tet_destroy(NULL, fresh);
}

static void render(fuzz* f, chi_tet* tet, fuzz_scene* s)
{
  const chi_exec exec = fuzz_host(f, 100000);
  chi_tet_image before, image;
  chi_tet_get_image(tet, &before);
  const chi_status status = chi_tet_render(&exec, tet, &s->frame);
  FUZZ_CHECK(keeps_account(f, &s->camera, status));
  chi_tet_get_image(tet, &image);
  if (status == CHI_ERROR_INVALID_ARGUMENT) /* the last picture stands */
  {
    FUZZ_CHECK(memcmp(&before, &image, sizeof image) == 0);
    return;
  }
  if (status != CHI_OK)
  {
    FUZZ_CHECK(!image.rgba && image.width == 0);
    return;
  }
  check_picture(s, &image);
  chi_tet_stats t;
  chi_tet_get_stats(tet, &t);
  /* kept fragments are rounded, and sorts start from the last order, which overlapping cells show
   */
  const int keeps = s->frame.params && s->params.fragment_cache_bytes > 0;
  if (!keeps && t.order.used <= CHI_TET_ORDER_TANGENTIAL)
  {
    check_fresh(s, &image);
  }
  const int skip = s->frame.params ? s->params.skip : CHI_TET_SKIP_ALL;
  fuzz_before(f);
  const chi_status again = chi_tet_render(&exec, tet, &s->frame);
  FUZZ_CHECK(keeps_account(f, &s->camera, again) && again != CHI_ERROR_INVALID_ARGUMENT);
  if (again == CHI_OK)
  {
    check_stats(tet, (skip & (CHI_TET_SKIP_ALL | CHI_TET_SKIP_UNCHANGED)) != 0);
  }
  const unsigned what = fuzz_byte(f);
  if (pixel_count(&s->camera) && what & 1)
  {
    check_cells(f, tet, &exec, s);
  }
  if (what & 2)
  {
    check_plan(f, tet, &exec, s);
  }
  if (pixel_count(&s->camera) && (what & 12) == 12)
  {
    int64_t violations = -1;
    fuzz_before(f);
    const chi_status counted = chi_tet_count_violations(&exec, tet, &s->frame, &violations);
    FUZZ_CHECK(keeps_account(f, &s->camera, counted));
    FUZZ_CHECK(counted != CHI_OK || violations >= 0);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count)
{
  fuzz* const f = fuzz_begin(bytes, count);
  fuzz_scene* const s = (fuzz_scene*)calloc(1, sizeof *s);
  FUZZ_CHECK(s);
  chi_exec exec = fuzz_host(f, 1000);
  chi_tet* tet = NULL;
  const chi_status status = chi_tet_create(&exec, &tet);
  FUZZ_CHECK((status == CHI_OK) == (tet != NULL));
  for (int round = 0; tet && round < ROUNDS; ++round) /* one handle, several frames */
  {
    change(f, s, round == 0);
    render(f, tet, s);
  }
  exec = fuzz_host(f, 1000);
  chi_tet_destroy(&exec, tet);
  fuzz_end(f);
  free(s);
  return 0;
}
