/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Densities as colours. */

#include "chi_grid_internal.h"

#include <chiaroscuro/chi_scatterplot.h>

#include <math.h>

enum
{
  BINS_A_CHUNK = 16384
};

typedef struct display_job
{
  const chi_exec* exec;
  const double* density;
  size_t count;
  uint8_t* rgba;
  double largest;
  int is_linear;
  double decades;
} display_job;

/* The share of the scale from 0 to 1, or less than 0 where there is nothing. */
static double level_of(const display_job* job, double density)
{
  if (!(density > 0 && density <= job->largest))
  {
    return -1;
  }
  const double share = density / job->largest;
  const double level = job->is_linear ? share : 1 + log10(share) / job->decades;
  return level > 0 ? level : 0;
}

static void paint(double level, uint8_t rgba[4])
{
  static const double stops[4][3] = { { 0, 0, 0 }, { 0.9, 0.1, 0 }, { 1, 0.9, 0 }, { 1, 1, 1 } };
  static const double places[4] = { 0, 0.45, 0.85, 1 };
  int k = 0;
  while (k < 2 && level > places[k + 1])
  {
    ++k;
  }
  const double t = (level - places[k]) / (places[k + 1] - places[k]);
  for (int c = 0; c < 3; ++c)
  {
    rgba[c] =
      level < 0 ? 0 : (uint8_t)lrint(255 * (stops[k][c] + t * (stops[k + 1][c] - stops[k][c])));
  }
  rgba[3] = level < 0 ? 0 : 255;
}

static void paint_chunks(void* data, size_t begin, size_t end)
{
  const display_job* const job = (const display_job*)data;
  for (size_t c = begin; c < end && !chi_is_cancelled(job->exec); ++c)
  {
    const size_t first = c * BINS_A_CHUNK;
    const size_t last = chi_grid_chunk_end(first, BINS_A_CHUNK, job->count);
    for (size_t i = first; i < last; ++i)
    {
      paint(level_of(job, job->density[i]), job->rgba + 4 * i);
    }
  }
}

chi_status chi_scatterplot_display(const chi_exec* exec, const double* density, size_t count,
  const chi_scatterplot_display_params* given, uint8_t* rgba)
{
  chi_scatterplot_display_params params = { .struct_size = sizeof params };
  if ((given && !CHI_ADOPT(chi_scatterplot_display_params, decades, &params, given)) ||
    (count > 0 && (!density || !rgba)) || !(params.decades >= 0) || !isfinite(params.decades))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  display_job job = { .exec = exec,
    .density = density,
    .count = count,
    .rgba = rgba,
    .is_linear = params.is_linear,
    .decades = params.decades > 0 ? params.decades : 4 };
  for (size_t i = 0; i < count; ++i)
  {
    job.largest = density[i] > job.largest && isfinite(density[i]) ? density[i] : job.largest;
  }
  return chi_for(exec, chi_grid_chunks(count, BINS_A_CHUNK), paint_chunks, &job);
}
