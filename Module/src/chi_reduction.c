/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * A picture at a fraction of the resolution, and its enlargement along the edges of the surface.
 * Source: Kopf, Cohen, Lischinski & Uyttendaele, "Joint bilateral upsampling", ACM TOG 26(3), 2007,
 * Eq. 3: what is enlarged is weighted by how like the guide is, here the surface's depth.
 */

#include "chi_occlusion_describe.h"

#include <math.h>
#include <string.h>

typedef struct reduction_job
{
  const chi_exec* exec;
  const chi_occlusion_frame* frame;
  const chi_scene* scene;
  chi_reduction* out;
  int n;
  int32_t width, height, small_width, small_height;
  int
    colors; /* of the visibility, interleaved; their mean stands behind them all where they are 3 */
  float* rgba;
  float* visibility;
} reduction_job;

int chi_reduction_of(const chi_occlusion_frame* frame)
{
  const int n = frame->params->reduction;
  return n < 1 || frame->probes ? 1 : n; /* probes name pixels of the full picture */
}

/* Where the ray ends. What covers a pixel in part is left out: enlarged, it would cover them all.
 */
static float surface_depth(const chi_occlusion_frame* frame, size_t pixel)
{
  const float* const depth = frame->surface->end ? frame->surface->end : frame->surface->depth;
  const float z = depth[pixel];
  return z > 0 && z < INFINITY ? z : INFINITY;
}

/*
 * Which pixel stands for a block, from its corner a side: always the same one, and the small camera
 * looks through its middle. The nearest or the farthest would keep thin things, but roughen every
 * slope, which then darkens itself (by 7 % on a tilted plane where the two take turns).
 */
static int chosen_pixel(int n)
{
  return n / 2;
}

static size_t choose_pixel(const reduction_job* it, size_t bx, size_t by)
{
  const size_t n = (size_t)it->n, width = (size_t)it->width, height = (size_t)it->height;
  const size_t x = bx * n + (size_t)chosen_pixel(it->n), y = by * n + (size_t)chosen_pixel(it->n);
  return (y < height ? y : height - 1) * width + (x < width ? x : width - 1);
}

/* Where that pixel's middle lies, in pixels from the block's corner. */
static double middle_of(int n)
{
  return chosen_pixel(n) + 0.5;
}

static void reduce_rows(void* data, size_t begin, size_t end)
{
  const reduction_job* const it = (const reduction_job*)data;
  const chi_layers_view* const layers = it->frame->layers;
  const size_t pixels = (size_t)it->width * (size_t)it->height;
  const size_t small = (size_t)it->small_width * (size_t)it->small_height;
  for (size_t y = begin; y < end && !chi_is_cancelled(it->exec); ++y)
  {
    for (size_t x = 0; x < (size_t)it->small_width; ++x)
    {
      const size_t from = choose_pixel(it, x, y);
      const size_t to = y * (size_t)it->small_width + x;
      if (it->frame->surface)
      {
        ((float*)it->out->depth.data)[to] = surface_depth(it->frame, from);
      }
      for (size_t k = 0; layers && k < (size_t)layers->count; ++k)
      {
        ((float*)it->out->layer_depth.data)[k * small + to] = layers->depth[k * pixels + from];
        memcpy((float*)it->out->layer_rgba.data + 4 * (k * small + to),
          layers->rgba + 4 * (k * pixels + from), 4 * sizeof(float));
      }
    }
  }
}

chi_status chi_reduce(
  const chi_exec* exec, chi_reduction* out, const chi_occlusion_frame* frame, int n)
{
  const chi_camera* const c = frame->camera;
  reduction_job job = { .exec = exec,
    .frame = frame,
    .out = out,
    .n = n,
    .width = c->width,
    .height = c->height,
    .small_width = (c->width - 1) / n + 1,
    .small_height = (c->height - 1) / n + 1 };
  const size_t pixels = (size_t)job.small_width * (size_t)job.small_height;
  const size_t layers = frame->layers ? (size_t)frame->layers->count : 0;
  if (!chi_buffer_reserve(exec, &out->rgba, pixels, 4 * sizeof(float)) ||
    !chi_buffer_reserve(exec, &out->visibility, 4 * pixels, sizeof(float)) ||
    (frame->surface && !chi_buffer_reserve(exec, &out->depth, pixels, sizeof(float))) ||
    (layers &&
      (!chi_buffer_reserve(exec, &out->layer_depth, layers * pixels, sizeof(float)) ||
        !chi_buffer_reserve(exec, &out->layer_rgba, layers * pixels, 4 * sizeof(float)))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  out->frame = *frame;
  out->camera = *c;
  out->camera.width = job.small_width;
  out->camera.height = job.small_height;
  const double shift = middle_of(n) - 0.5 * n; /* of the window, in pixels */
  for (int axis = 0; axis < 2; ++axis)
  {
    const double* const w = c->window + 2 * axis;
    const double pixel = (w[1] - w[0]) / (axis ? c->height : c->width);
    out->camera.window[2 * axis] = w[0] + shift * pixel;
    out->camera.window[2 * axis + 1] =
      w[0] + (shift + (double)n * (axis ? job.small_height : job.small_width)) * pixel;
  }
  out->frame.camera = &out->camera;
  if (frame->surface)
  {
    out->surface = *frame->surface;
    out->surface.depth = (const float*)out->depth.data;
    out->surface.end = out->surface.edge_depth = out->surface.edge_rgba = NULL;
    out->frame.surface = &out->surface;
  }
  if (layers)
  {
    out->layers = *frame->layers;
    out->layers.depth = (const float*)out->layer_depth.data;
    out->layers.rgba = (const float*)out->layer_rgba.data;
    out->frame.layers = &out->layers;
  }
  return frame->surface || layers ? chi_for(exec, (size_t)job.small_height, reduce_rows, &job)
                                  : CHI_OK;
}

/* The guide without surface: as far behind the last slab as that is behind the first. */
static double far_guide(const chi_scene* s)
{
  return 2.0 * (double)(s->slabs > 64 ? s->slabs : 64);
}

/* The guide: depth in slabs. */
static double guide_of(const chi_scene* s, float depth)
{
  return fmin(((double)depth - s->start) / s->slab, far_guide(s));
}

/* Weights of the four small pixels about a full one; 1 / (1 + d^2) at a distance d in depth. */
static void weigh(const reduction_job* it, size_t pixel, const size_t at[4], double weight[4])
{
  if (!it->frame->surface)
  {
    return;
  }
  const float* const small = (const float*)it->out->depth.data;
  const double here = guide_of(it->scene, surface_depth(it->frame, pixel));
  double sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    const double d = guide_of(it->scene, small[at[k]]) - here;
    weight[k] /= 1 + d * d;
    sum += weight[k];
  }
  for (int k = 0; k < 4; ++k)
  {
    weight[k] /= sum; /* the nearest of four has at least a quarter before its guide counts */
  }
}

/* Of what is not lit visibility is 1, in the neighbours as well: only surfaces count for one. */
static void enlarge_visibility(
  const reduction_job* it, size_t pixel, const size_t at[4], const double weight[4])
{
  const size_t colors = (size_t)it->colors;
  const size_t pixels = (size_t)it->width * (size_t)it->height;
  const size_t small = (size_t)it->small_width * (size_t)it->small_height;
  const float* const from = (const float*)it->out->visibility.data;
  const int lit = it->frame->surface && surface_depth(it->frame, pixel) < INFINITY;
  double sum[4] = { 0, 0, 0, 0 }, total = 0;
  for (int k = 0; k < 4 && lit; ++k)
  {
    const double w = ((const float*)it->out->depth.data)[at[k]] < INFINITY ? weight[k] : 0;
    total += w;
    for (size_t c = 0; c < colors; ++c)
    {
      sum[c] += w * (double)from[colors * at[k] + c];
    }
    sum[3] += colors > 1 ? w * (double)from[colors * small + at[k]] : 0;
  }
  for (size_t c = 0; c < colors; ++c)
  {
    it->visibility[colors * pixel + c] = total > 0 ? (float)(sum[c] / total) : 1;
  }
  if (colors > 1)
  {
    it->visibility[colors * pixels + pixel] = total > 0 ? (float)(sum[3] / total) : 1;
  }
}

static void enlarge_rows(void* data, size_t begin, size_t end)
{
  const reduction_job* const it = (const reduction_job*)data;
  const float* const rgba = (const float*)it->out->rgba.data;
  const size_t small_width = (size_t)it->small_width;
  for (size_t y = begin; y < end && !chi_is_cancelled(it->exec); ++y)
  {
    const double v = fmax(((double)y + 0.5 - middle_of(it->n)) / it->n, 0);
    const size_t j = (size_t)v, next_j = j + 1 < (size_t)it->small_height ? j + 1 : j;
    const double fv = v - (double)j;
    for (size_t x = 0; x < (size_t)it->width; ++x)
    {
      const double u = fmax(((double)x + 0.5 - middle_of(it->n)) / it->n, 0);
      const size_t i = (size_t)u, next_i = i + 1 < small_width ? i + 1 : i;
      const double fu = u - (double)i;
      const size_t pixel = y * (size_t)it->width + x;
      const size_t at[4] = { j * small_width + i, j * small_width + next_i,
        next_j * small_width + i, next_j * small_width + next_i };
      double weight[4] = { (1 - fu) * (1 - fv), fu * (1 - fv), (1 - fu) * fv, fu * fv };
      weigh(it, pixel, at, weight);
      double sum[4] = { 0, 0, 0, 0 };
      for (int k = 0; k < 4; ++k)
      {
        for (int c = 0; c < 4; ++c)
        {
          sum[c] += weight[k] * (double)rgba[4 * at[k] + (size_t)c];
        }
      }
      for (int c = 0; c < 4; ++c)
      {
        it->rgba[4 * pixel + (size_t)c] = (float)sum[c];
      }
      enlarge_visibility(it, pixel, at, weight);
    }
  }
}

chi_status chi_enlarge(const chi_exec* exec, chi_reduction* from, const chi_occlusion_frame* frame,
  const chi_scene* scene, int n, float* rgba, float* visibility)
{
  reduction_job job = { .exec = exec,
    .frame = frame,
    .scene = scene,
    .out = from,
    .n = n,
    .width = frame->camera->width,
    .height = frame->camera->height,
    .small_width = from->camera.width,
    .small_height = from->camera.height,
    .colors = scene->channels > 1 ? 3 : 1,
    .rgba = rgba,
    .visibility = visibility };
  return chi_for(exec, (size_t)job.height, enlarge_rows, &job);
}

static void write_guide(void* data, size_t begin, size_t end)
{
  const reduction_job* const it = (const reduction_job*)data;
  for (size_t i = begin * (size_t)it->width; i < end * (size_t)it->width; ++i)
  {
    const float depth = surface_depth(it->frame, i);
    it->visibility[i] = depth < INFINITY ? (float)guide_of(it->scene, depth) : INFINITY;
  }
}

chi_status chi_reduction_describe(const chi_exec* exec, const chi_occlusion_frame* frame,
  const chi_scene* scene, float* guide, chi_occlusion_plan* plan)
{
  const chi_camera* const camera = frame->camera;
  plan->reduction = chi_reduction_of(frame);
  plan->full_width = camera->width;
  plan->full_height = camera->height;
  plan->reduced_pixel = chosen_pixel(plan->reduction);
  plan->guide = guide;
  plan->guide_far = far_guide(scene);
  reduction_job job = {
    .exec = exec, .frame = frame, .scene = scene, .width = camera->width, .visibility = guide
  };
  return guide ? chi_for(exec, (size_t)camera->height, write_guide, &job) : CHI_OK;
}

void chi_reduction_free(const chi_exec* exec, chi_reduction* reduction)
{
  chi_buffer_free(exec, &reduction->depth);
  chi_buffer_free(exec, &reduction->rgba);
  chi_buffer_free(exec, &reduction->visibility);
  chi_buffer_free(exec, &reduction->layer_depth);
  chi_buffer_free(exec, &reduction->layer_rgba);
}
