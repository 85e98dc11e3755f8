/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Colour between slices: run time against the error of the picture, by rule and by slices a voxel,
 * on ramps through a thin Gaussian peak of opacity (sigma 1/200 of the range, optical depth 3 a
 * voxel) whose colours turn 40 times over the range. Prints CSV; errors are of 255, against the
 * exact integral over the transfer function, which on a ramp is known; the parameter is slices a
 * voxel.
 */

#include "occlusion_ramp.h"

#include "chi_bench.h"

static void measure(
  chi_occlusion* engine, const ramp_scene* r, int rule, int slices, const double exact[4])
{
  double best = INFINITY, error[2];
  chi_occlusion_image image = { 0 };
  r->f->params.color_integration = rule;
  r->f->params.sample_distance = 1.0 / slices;
  for (int run = 0; run <= CHI_BENCH_RUNS; ++run)
  {
    r->f->params.bias = 1 + 1e-9 * run; /* a new frame of the same picture */
    const double t0 = chi_bench_now();
    if (chi_occlusion_render(NULL, engine, &r->f->frame) != CHI_OK)
    {
      return;
    }
    best = fmin(best, chi_bench_now() - t0);
  }
  chi_occlusion_get_image(engine, &image);
  ramp_error(image.rgba, exact, 4, error);
  static const char* const kinds[2] = { "mean_255_picture", "max_255_picture" };
  for (int k = 0; k < 2; ++k)
  {
    printf("occlusion_colour,peak-over-%d-voxels,chi-%s,%d,%d,1,%.0f,%.4f,%s\n", r->depth,
      rule == CHI_COLOR_MIDDLE ? "middle" : "pre-integrated", slices,
      RAMP_PICTURE * RAMP_PICTURE * (r->depth + 2) * slices, best, error[k], kinds[k]);
  }
  fflush(stdout);
}

int main(void)
{
  static const int depths[3] = { 16, 64, 200 };
  int failed = 0;
  printf(CHI_BENCH_HEADER);
  for (int k = 0; k < 3; ++k)
  {
    ramp_scene r;
    chi_occlusion* engine = NULL;
    if (ramp_create(&r, depths[k], 0) && chi_occlusion_create(NULL, &engine) == CHI_OK)
    {
      double exact[4];
      ramp_peak(r.f, 3, 1.0 / 200, 40);
      ramp_integrate(r.f, 0, 1.02, 1.0 / r.depth, exact);
      for (int slices = 1; slices <= 16; slices *= 2)
      {
        measure(engine, &r, CHI_COLOR_PREINTEGRATED, slices, exact);
        measure(engine, &r, CHI_COLOR_MIDDLE, slices, exact);
      }
    }
    else
    {
      failed = 1;
    }
    chi_occlusion_destroy(NULL, engine);
    ramp_free(&r);
  }
  return failed;
}
