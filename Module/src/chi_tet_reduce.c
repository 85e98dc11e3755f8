/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_internal.h"

/* Pixel of the coarse picture to the left of, or below, pixel x of the full one, and how far x lies
 * from there to the next; centres are half a pixel inwards in both. */
static int32_t coarse_pixel(int32_t x, int32_t times, int32_t count, float* part)
{
  const float at = ((float)x + 0.5f) / (float)times - 0.5f;
  const int32_t i = at > 0 ? (int32_t)at : 0;
  const int32_t last = count - 1;
  *part = i >= last || at <= 0 ? 0 : at - (float)i;
  return i < last ? i : last;
}

chi_status chi_tet_reduce(
  const chi_exec* exec, chi_tet_reduction* r, const chi_tet_frame* frame, int32_t times)
{
  r->camera = *frame->camera;
  r->times = times;
  const int32_t full[2] = { frame->camera->width, frame->camera->height };
  int32_t* const size[2] = { &r->camera.width, &r->camera.height };
  for (int k = 0; k < 2; ++k)
  {
    *size[k] = (full[k] + times - 1) / times; /* the last pixel may reach beyond the window */
    double* const window = r->camera.window + 2 * k;
    window[1] = window[0] + (window[1] - window[0]) * *size[k] * times / full[k];
  }
  if (!frame->surface)
  {
    return CHI_OK;
  }
  const size_t width = (size_t)r->camera.width, height = (size_t)r->camera.height;
  if (!chi_buffer_reserve(exec, &r->depth, width * height, sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  float* const depth = (float*)r->depth.data;
  for (size_t y = 0; y < height; ++y)
  {
    for (size_t x = 0; x < width; ++x)
    {
      const size_t half = (size_t)times / 2;
      const size_t fx = x * (size_t)times + half, fy = y * (size_t)times + half;
      const size_t last[2] = { (size_t)full[0] - 1, (size_t)full[1] - 1 };
      depth[y * width + x] =
        frame->surface
          ->depth[(fy < last[1] ? fy : last[1]) * (size_t)full[0] + (fx < last[0] ? fx : last[0])];
    }
  }
  r->surface = *frame->surface;
  r->surface.depth = depth;
  return CHI_OK;
}

typedef struct enlarge_job
{
  const chi_tet_reduction* reduction;
  const float* from;
  float* to;
  int32_t width;
} enlarge_job;

static void enlarge_rows(void* data, size_t begin, size_t end)
{
  const enlarge_job* const it = (const enlarge_job*)data;
  const int32_t width = it->reduction->camera.width, height = it->reduction->camera.height;
  const int32_t times = it->reduction->times;
  for (size_t y = begin; y < end; ++y)
  {
    float v, u;
    const int32_t j = coarse_pixel((int32_t)y, times, height, &v);
    for (int32_t x = 0; x < it->width; ++x)
    {
      const int32_t i = coarse_pixel(x, times, width, &u);
      const float* const p = it->from + 4 * ((size_t)j * (size_t)width + (size_t)i);
      const float* const right = p + (u > 0 ? 4 : 0);
      const size_t up = v > 0 ? 4 * (size_t)width : 0;
      float* const out = it->to + 4 * (y * (size_t)it->width + (size_t)x);
      for (int k = 0; k < 4; ++k)
      {
        const float low = p[k] + u * (right[k] - p[k]);
        const float high = p[up + (size_t)k] + u * (right[up + (size_t)k] - p[up + (size_t)k]);
        out[k] = low + v * (high - low);
      }
    }
  }
}

chi_status chi_tet_enlarge(const chi_exec* exec, const chi_tet_reduction* reduction,
  const float* from, float* to, int32_t width, int32_t height)
{
  enlarge_job job = { reduction, from, to, width };
  return chi_for(exec, (size_t)height, enlarge_rows, &job);
}
