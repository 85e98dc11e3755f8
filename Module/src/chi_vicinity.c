/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * Vicinity occlusion: what surfaces within a few pixels take from a surface's light, of the details
 * that the light planes are too coarse for. Schott et al. 2013, section 3.2.5, Algorithm 5, Eqs
 * 4-6; the prose's sign of the bias. Documentation/theory/occlusion.md says how the automatic rule
 * differs.
 */

#include "chi_occlusion_internal.h"

#include <math.h>

typedef struct vicinity_job
{
  const chi_exec* exec;
  const chi_occlusion_kernels* kernels;
  chi_vicinity_row row;
  const float* receiver;
  float disc[2][2][CHI_MAX_VICINITY_SAMPLES];
  int32_t combine; /* CHI_COMBINE_... */
  float* visibility;
  size_t colors;
} vicinity_job;

static void combine_rows(void* data, size_t begin, size_t end)
{
  enum
  {
    PIECE = 256
  };
  const vicinity_job* const it = (const vicinity_job*)data;
  float left[PIECE];
  chi_vicinity_row row = it->row;
  row.left = left;
  for (size_t y = begin; y < end && !chi_is_cancelled(it->exec); ++y)
  {
    row.y = (int)y;
    row.receiver = it->receiver + y * (size_t)row.width;
    for (int x0 = 0; x0 < row.width; x0 += PIECE)
    {
      const int x1 = x0 + PIECE < row.width ? x0 + PIECE : row.width;
      it->kernels->vicinity(&row, x0, x1);
      for (int x = x0; x < x1; ++x)
      {
        const float z = row.receiver[x], near = left[x - x0];
        float* const v = it->visibility + it->colors * (y * (size_t)row.width + (size_t)x);
        for (size_t c = 0; c < it->colors && z > 0 && z < INFINITY; ++c)
        {
          v[c] = it->combine == CHI_COMBINE_MINIMUM ? fminf(v[c], near) /* Eq. 7 */
                                                    : v[c] * near;      /* Eq. 8 */
        }
      }
    }
  }
}

double chi_vicinity_radius(const chi_scene* scene, const chi_occlusion_params* params, int light)
{
  return params->vicinity_distance * tan(scene->light[light].cone);
}

int chi_vicinity_disc(const chi_scene* scene, const chi_occlusion_params* params, int light,
  double disc[CHI_MAX_VICINITY_SAMPLES][2])
{
  if (!(params->vicinity_distance > 0) || !(params->interactions & CHI_GEOMETRY_TO_GEOMETRY))
  {
    return 0;
  }
  /* The base of the cone in the virtual slice; that of a tilted light lies aside. */
  const double slope = tan(scene->light[light].cone);
  for (int k = 0; k < params->vicinity_samples; ++k)
  {
    /* Equal areas along the golden spiral (Vogel 1979) in place of a table of Poisson's */
    const double r = sqrt((k + 0.5) / params->vicinity_samples), turn = 2.39996322972865332 * k;
    disc[k][0] = r * cos(turn) + scene->light[light].slope[0] / slope;
    disc[k][1] = r * sin(turn) + scene->light[light].slope[1] / slope;
  }
  return params->vicinity_samples;
}

chi_status chi_vicinity(const chi_exec* exec, const chi_scene* scene,
  const chi_surface_view* surface, const chi_occlusion_params* params, float* visibility,
  size_t colors)
{
  vicinity_job job = { .exec = exec,
    .kernels = chi_kernels(),
    .row = { .depth = surface->depth,
      .width = scene->width,
      .height = scene->height,
      .pixels = { (float)(scene->pixels_x * scene->scale),
        (float)(scene->pixels_y * scene->scale) },
      .parallel = scene->parallel,
      .lights = scene->lights,
      .bias = params->vicinity_bias > 0 ? (float)params->vicinity_bias : 0,
      .rise = (float)CHI_VICINITY_RISE,
      .fade = (float)CHI_VICINITY_FADE,
      .inverse_distance = (float)(1 / params->vicinity_distance) },
    .receiver = surface->end ? surface->end : surface->depth,
    .combine = params->combine,
    .visibility = visibility,
    .colors = colors };
  for (int light = 0; light < scene->lights; ++light)
  {
    double disc[CHI_MAX_VICINITY_SAMPLES][2];
    const double radius = chi_vicinity_radius(scene, params, light);
    job.row.count = chi_vicinity_disc(scene, params, light, disc);
    job.row.radius[light] = (float)radius;
    job.row.curvature[light] = (float)(CHI_VICINITY_CURVATURE * radius);
    for (int k = 0; k < job.row.count; ++k)
    {
      job.disc[light][0][k] = (float)disc[k][0];
      job.disc[light][1][k] = (float)disc[k][1];
    }
    job.row.share[light] =
      job.row.count > 0 ? (float)(scene->light[light].share / job.row.count) : 0;
    job.row.disc[light][0] = job.disc[light][0];
    job.row.disc[light][1] = job.disc[light][1];
  }
  return job.row.count == 0 ? CHI_OK : chi_for(exec, (size_t)scene->height, combine_rows, &job);
}
