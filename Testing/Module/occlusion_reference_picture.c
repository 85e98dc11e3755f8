/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* The exact final picture, one pixel at a time. */

#include "occlusion_reference_picture.h"

#include <math.h>

enum
{
  NODES = 2 * 4 * REFERENCE_SIZE, /* places along a ray where V may be asked for, 1/2 voxel apart */
  FINE = 8                        /* steps of the sum between two of them */
};

/* A pixel's ray: index position at depth z is origin + z along. */
typedef struct ray
{
  const reference_volume* volume;
  const reference_surface* surface;
  const reference_view* view;
  const reference_rays* rays;
  const double* bias; /* of matter, of the surface */
  double origin[3], along[3], start;
  double visibility[NODES + 2]; /* NaN: not asked for yet */
} ray;

static void place(const ray* r, double depth, double at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    at[a] = r->origin[a] + depth * r->along[a];
  }
}

static double visibility_at(const ray* r, double depth, double bias)
{
  double at[3];
  place(r, depth - bias, at);
  return reference_visibility(r->volume, r->surface, r->view, r->rays, at);
}

static double visibility_of_node(ray* r, int node)
{
  if (isnan(r->visibility[node]))
  {
    r->visibility[node] = visibility_at(r, r->start + 0.5 * node, r->bias[0]);
  }
  return r->visibility[node];
}

double reference_pixel(const reference_volume* v, const reference_surface* surface,
  const reference_view* view, const reference_rays* rays, const double bias[2], const int pixel[2])
{
  const chi_camera* const c = &view->camera;
  const double u = c->window[0] + (pixel[0] + 0.5) / c->width * (c->window[1] - c->window[0]);
  const double w = c->window[2] + (pixel[1] + 0.5) / c->height * (c->window[3] - c->window[2]);
  ray r = { .volume = v, .surface = surface, .view = view, .rays = rays, .bias = bias };
  for (int a = 0; a < 3; ++a)
  {
    const double across = a == 0 ? u : a == 1 ? w : 0;
    r.origin[a] = view->eye[a] + (c->parallel ? across : 0);
    r.along[a] = (a == 2) + (c->parallel ? 0 : across);
  }
  const double first[3] = { 0, 0, 0 }, last[3] = { 0, 0, (double)v->n[2] - 1 };
  r.start = fmax(reference_depth(view, first), c->near_depth);
  const double end = reference_depth(view, last);
  const double depth = surface ? (double)surface->depth[pixel[0] + c->width * pixel[1]] : INFINITY;
  const double stop = fmin(end, depth);
  const double slant = c->parallel ? 1 : sqrt(1 + u * u + w * w);
  for (int i = 0; i < NODES + 2; ++i)
  {
    r.visibility[i] = NAN;
  }
  double clear = 1, sum = 0, from = r.start;
  for (int k = 0; from < stop && clear > 1e-6 && k < NODES * FINE; ++k)
  {
    const double to = fmin(r.start + 0.5 / FINE * (k + 1), stop), middle = 0.5 * (from + to);
    double at[3];
    place(&r, middle, at);
    const double alpha = -expm1(-reference_extinction(v, at) * (to - from) * slant);
    if (clear * alpha > 0)
    {
      const int node = k / FINE;
      const double part = 2 * (middle - r.start) - node;
      sum += clear * alpha *
        ((1 - part) * visibility_of_node(&r, node) + part * visibility_of_node(&r, node + 1));
      clear *= 1 - alpha;
    }
    from = to;
  }
  return depth < INFINITY && clear > 1e-6 ? sum + clear * visibility_at(&r, depth, bias[1]) : sum;
}
