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
  const chi_scene* scene;
  const float* depth;
  const float* end;
  const chi_occlusion_params* params;
  double pixels[2]; /* pixels a world unit (parallel), or a unit of slope */
  double radius[2]; /* of each light's base of its cone, world units */
  double disc[2][CHI_MAX_VICINITY_SAMPLES][2];
  float* visibility;
  size_t colors;
} vicinity_job;

/* Depth of a pixel, INFINITY where there is none. */
static double depth_at(const vicinity_job* it, int64_t x, int64_t y)
{
  const chi_scene* const s = it->scene;
  if (x < 0 || y < 0 || x >= s->width || y >= s->height)
  {
    return INFINITY;
  }
  const double z = (double)it->depth[x + (int64_t)s->width * y];
  return z > 0 ? z : INFINITY;
}

/* Rise of the surface's own tangent plane a pixel: the flatter of both sides, so that the step to
 * another surface does not count. */
static double slope_at(
  const vicinity_job* it, int64_t x, int64_t y, int64_t dx, int64_t dy, double z)
{
  const double after = depth_at(it, x + dx, y + dy) - z, before = z - depth_at(it, x - dx, y - dy);
  const double slope = fabs(after) < fabs(before) ? after : before;
  return isfinite(slope) ? slope : 0;
}

/* How far a neighbour blocks, 0 to 1; `lead`: by how much it is nearer to the eye than the tangent
 * plane, which rises by `rise` on the way. */
static double blocks(const vicinity_job* it, double radius, double lead, double rise)
{
  const chi_occlusion_params* const p = it->params;
  if (p->vicinity_bias > 0)
  {
    return lead > p->vicinity_bias ? 1 : 0;
  }
  const double far = CHI_VICINITY_FADE - lead / p->vicinity_distance;
  const double share = far < 0 ? 0 : far < 1 ? far : 1;
  return lead > CHI_VICINITY_CURVATURE * radius + CHI_VICINITY_RISE * rise ? share : 0;
}

static double vicinity(const vicinity_job* it, int64_t x, int64_t y, double z)
{
  const int count = it->params->vicinity_samples, plane = !(it->params->vicinity_bias > 0);
  const double slope_x = plane ? slope_at(it, x, y, 1, 0, z) : 0;
  const double slope_y = plane ? slope_at(it, x, y, 0, 1, z) : 0;
  double all = 0;
  for (int light = 0; light < it->scene->lights; ++light)
  {
    const double radius = it->radius[light], scale = it->scene->parallel ? radius : radius / z;
    const double reach[2] = { it->pixels[0] * scale, it->pixels[1] * scale };
    double blocked = 0;
    for (int k = 0; k < count; ++k)
    {
      const double dx = floor(it->disc[light][k][0] * reach[0] + 0.5);
      const double dy = floor(it->disc[light][k][1] * reach[1] + 0.5);
      if (fabs(dx) < it->scene->width && fabs(dy) < it->scene->height)
      {
        const double expected = z + dx * slope_x + dy * slope_y;
        const double rise = fabs(dx * slope_x) + fabs(dy * slope_y);
        const double lead = expected - depth_at(it, x + (int64_t)dx, y + (int64_t)dy);
        blocked += blocks(it, radius, lead, rise);
      }
    }
    all += it->scene->light[light].share * (blocked / count);
  }
  return 1 - all;
}

static void combine_rows(void* data, size_t begin, size_t end)
{
  const vicinity_job* const it = (const vicinity_job*)data;
  const int64_t width = it->scene->width;
  for (int64_t y = (int64_t)begin; y < (int64_t)end && !chi_is_cancelled(it->exec); ++y)
  {
    for (int64_t x = 0; x < width; ++x)
    {
      const float* const receiver = it->end ? it->end : it->depth;
      const double z = (double)receiver[x + y * width];
      if (z > 0 && z < INFINITY)
      {
        float* const v = it->visibility + it->colors * (size_t)(y * width + x);
        const double near = vicinity(it, x, y, z);
        for (size_t c = 0; c < it->colors; ++c)
        {
          const double partial = (double)v[c];
          v[c] =
            (float)(it->params->combine == CHI_COMBINE_MINIMUM ? fmin(partial, near) /* Eq. 7 */
                                                               : partial * near);    /* Eq. 8 */
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
    .scene = scene,
    .depth = surface->depth,
    .end = surface->end,
    .params = params,
    .pixels = { scene->pixels_x * scene->scale, scene->pixels_y * scene->scale },
    .visibility = visibility,
    .colors = colors };
  int count = 0;
  for (int light = 0; light < scene->lights; ++light)
  {
    job.radius[light] = chi_vicinity_radius(scene, params, light);
    count = chi_vicinity_disc(scene, params, light, job.disc[light]);
  }
  return count == 0 ? CHI_OK : chi_for(exec, (size_t)scene->height, combine_rows, &job);
}
