/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Working memory of the occlusion engine: what it asks of its host, besides input. */

#include "chi_test.h"
#include "counting_host.h"
#include "occlusion_reference.h"

/* Peak of a frame of a box of fog of 8 bits, whose depth fits into the window of pixels^2. */
static double peak_bytes(const size_t n[3], int pixels, int directions, int half, int with_surface)
{
  counting_host host = { .exec = NULL };
  const chi_exec exec = counting_exec(&host);
  const double side = (double)n[2] - 1, turn[2] = { 0, 0 };
  const double center[3] = { 0.5 * ((double)n[0] - 1), 0.5 * ((double)n[1] - 1), 0.5 * side };
  const reference_view view = reference_turned_view(center, 3 * side, turn, side, pixels, 0);
  const size_t count = (size_t)pixels * (size_t)pixels;
  reference_frame* const f = malloc(sizeof *f);
  uint8_t* const scalars = malloc(n[0] * n[1] * n[2]);
  float* const depth = malloc(count * sizeof *depth);
  chi_occlusion* engine = NULL;
  CHECK(f && scalars && depth && chi_occlusion_create(&exec, &engine) == CHI_OK);
  if (f && scalars && depth && engine)
  {
    memset(scalars, 255, n[0] * n[1] * n[2]);
    reference_frame_init(f, NULL, &view, 255);
    f->transfer.unit_distance = 4 * side;
    f->volume = (chi_volume_view){ .struct_size = sizeof f->volume,
      .scalars = scalars,
      .type = CHI_U8,
      .stride = 1,
      .dimensions = { n[0], n[1], n[2] },
      .index_to_world = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1 },
      .interpolation = CHI_LINEAR,
      .version = 1 };
    f->frame.volume = &f->volume;
    f->frame.transfer = &f->transfer;
    f->params.bias = -1;
    f->params.directions = directions;
    f->params.half_size = half;
    for (size_t i = 0; i < count; ++i)
    {
      depth[i] = (float)(3 * side);
    }
    f->surface =
      (chi_surface_view){ .struct_size = sizeof f->surface, .depth = depth, .version = 1 };
    f->frame.surface = with_surface ? &f->surface : NULL;
    CHECK(chi_occlusion_render(&exec, engine, &f->frame) == CHI_OK);
    CHECK(host.live == host.peak || host.peak > 0);
  }
  chi_occlusion_destroy(&exec, engine);
  CHECK(host.live == 0);
  free(f);
  free(scalars);
  free(depth);
  return (double)host.peak;
}

/*
 * Asked: 64 MiB + 4 bytes a pixel and direction, at 512^3 and 1024^2. Pixels and slabs are those of
 * the large case (512 sqrt 3 slabs along the diagonal), over a thin stick; what the voxels add, the
 * bricks, is linear in them.
 */
static void a_large_frame_needs_no_more_than_asked(int with_surface)
{
  static const size_t stick[3] = { 8, 8, 887 }, cubes[2][3] = { { 64, 64, 64 }, { 128, 128, 128 } };
  const int directions = 16;
  const double pixels = 1024.0 * 1024, voxels = 512.0 * 512 * 512;
  const double flat = peak_bytes(stick, 1024, directions, 1, with_surface);
  const double a_voxel =
    (peak_bytes(cubes[1], 4, directions, 1, 0) - peak_bytes(cubes[0], 4, directions, 1, 0)) /
    (128.0 * 128 * 128 - 64.0 * 64 * 64);
  const double total = flat + a_voxel * voxels, allowed = 67108864 + 4 * pixels * directions;
  printf("%s surface: %.1f bytes a pixel, %.4f a voxel: %.1f MiB of %.1f\n",
    with_surface ? "with" : "without", flat / pixels, a_voxel, total / 1048576, allowed / 1048576);
  CHECK(flat > 0 && a_voxel > 0);
  CHECK(total <= allowed);
}

/* Each direction costs its two planes of light, and no more: at half size 2 bytes a pixel. */
static void directions_cost_two_planes_each(void)
{
  static const size_t n[3] = { 32, 32, 32 };
  const double few = peak_bytes(n, 320, 8, 1, 0), many = peak_bytes(n, 320, 24, 1, 0);
  const double a_direction = (many - few) / 16 / (320.0 * 320);
  printf("%.2f bytes a pixel and direction at half size\n", a_direction);
  CHECK(a_direction >= 2 && a_direction <= 3); /* padding: a fifth of 160 light pixels a row */
}

int main(void)
{
  a_large_frame_needs_no_more_than_asked(0);
  a_large_frame_needs_no_more_than_asked(1);
  directions_cost_two_planes_each();
  return chi_test_report();
}
