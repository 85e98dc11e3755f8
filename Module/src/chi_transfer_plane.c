/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Transfer functions of two quantities: a row of the one-dimensional tables for each step of the
 * second one. */

#include "chi_occlusion_internal.h"

#include <math.h>

enum
{
  MAX_ENTRIES = 1 << 22, /* of what is handed in */
  FINE_X = 1024,         /* entries to which small tables are refined */
  FINE_Y = 256,
  MAX_PARTS = 16
};

int chi_transfer_plane_is_valid(const chi_transfer_view* t)
{
  const size_t nx = t->plane_count[0], ny = t->plane_count[1];
  return nx >= 2 && ny >= 2 && nx <= 65536 && ny <= 65536 && nx * ny <= MAX_ENTRIES &&
    isfinite(t->plane_range[0]) && isfinite(t->plane_range[1]) &&
    t->plane_range[0] < t->plane_range[1];
}

static size_t parts_of(size_t count, size_t fine)
{
  const size_t parts = fine / (count - 1);
  return parts < 1 ? 1 : parts < MAX_PARTS ? parts : MAX_PARTS;
}

void chi_transfer_plane_parts(const chi_transfer_view* t, size_t parts[2])
{
  parts[0] = parts_of(t->plane_count[0], FINE_X);
  parts[1] = parts_of(t->plane_count[1], FINE_Y);
}

double chi_transfer_plane_value(const chi_transfer_view* t, double x, double y, int channel)
{
  const size_t nx = t->plane_count[0], ny = t->plane_count[1];
  const size_t i = (size_t)x < nx - 2 ? (size_t)x : nx - 2;
  const size_t j = (size_t)y < ny - 2 ? (size_t)y : ny - 2;
  double sum = 0;
  for (size_t k = 0; k < 4; ++k)
  {
    const double u = x - (double)i, v = y - (double)j;
    const double value =
      (double)t->plane[4 * (i + (k & 1) + nx * (j + (k >> 1))) + (size_t)channel];
    sum += (k & 1 ? u : 1 - u) * (k & 2 ? v : 1 - v) *
      (value > 0 ? (value < 1 ? value : 1) : 0); /* NaN: 0 */
  }
  return sum;
}

/* Extinctions, and the quantum in which the sums of every row fit. */
static void fill_extinctions(
  chi_transfer_plane* out, const chi_transfer_view* t, const size_t parts[2], float* opacity)
{
  chi_plan_entry* const sigma = (chi_plan_entry*)out->sigma.data;
  float(*const rgba)[4] = (float(*)[4])out->rgba.data;
  double most = 0;
  for (size_t i = 0; i < out->count[0]; ++i)
  {
    opacity[i] = 0;
  }
  for (size_t j = 0; j < out->count[1]; ++j)
  {
    double total = 0;
    for (size_t i = 0; i < out->count[0]; ++i)
    {
      const double x = (double)i / (double)parts[0], y = (double)j / (double)parts[1];
      const size_t at = i + out->count[0] * j;
      const double alpha = chi_transfer_plane_value(t, x, y, 3);
      sigma[at] =
        (chi_plan_entry){ .sigma = (float)chi_extinction(alpha, t->unit_distance), .reserved = 0 };
      total += (double)sigma[at].sigma;
      opacity[i] = (float)fmax((double)opacity[i], alpha);
      for (int c = 0; c < 3; ++c)
      {
        rgba[at][c] = (float)chi_transfer_plane_value(t, x, y, c);
      }
      rgba[at][3] = 1;
    }
    most = fmax(most, total);
  }
  out->quantum = (float)(most > 0 ? most / 2147483000.0 : 1);
}

static void fill_sums(chi_transfer_plane* out)
{
  for (size_t j = 0; j < out->count[1]; ++j)
  {
    chi_plan_entry* const row = (chi_plan_entry*)out->sigma.data + out->count[0] * j;
    double sum = 0;
    for (size_t i = 0; i < out->count[0]; ++i)
    {
      const double here = (double)row[i].sigma;
      const double next = i + 1 < out->count[0] ? (double)row[i + 1].sigma : here;
      row[i].half_slope = (float)(0.5 * (next - here));
      row[i].sum = (int32_t)(sum / (double)out->quantum + 0.5);
      sum += 0.5 * (here + next);
    }
  }
}

/* More than all, or less than nothing, would make light of nothing. */
static int copy_gradient_opacity(
  const chi_exec* exec, chi_classification* out, const chi_transfer_view* t)
{
  if (!t->gradient_opacity)
  {
    return 1;
  }
  if (!chi_buffer_reserve(exec, &out->gradient_opacity, t->gradient_count, sizeof(float)))
  {
    return 0;
  }
  float* const share = (float*)out->gradient_opacity.data;
  for (size_t i = 0; i < t->gradient_count; ++i)
  {
    const float value = t->gradient_opacity[i];
    share[i] = value > 0 ? (value < 1 ? value : 1) : 0; /* NaN: 0 */
  }
  return 1;
}

/* The bound of every column as a table of one quantity: where it is transparent, the plane is. */
chi_status chi_classify_transfer(const chi_exec* exec, chi_classification* out,
  const chi_bricks* bricks, const chi_transfer_view* transfer, int dilate)
{
  chi_transfer_plane* const plane = &out->plane;
  plane->count[0] = plane->count[1] = 0;
  if (!copy_gradient_opacity(exec, out, transfer))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  if (!transfer->plane)
  {
    return chi_classify(exec, out, bricks, transfer, dilate);
  }
  size_t parts[2];
  chi_transfer_plane_parts(transfer, parts);
  for (int a = 0; a < 2; ++a)
  {
    plane->count[a] = (transfer->plane_count[a] - 1) * parts[a] + 1;
  }
  const size_t entries = plane->count[0] * plane->count[1];
  if (!chi_buffer_reserve(exec, &plane->sigma, entries, sizeof(chi_plan_entry)) ||
    !chi_buffer_reserve(exec, &plane->rgba, entries, 4 * sizeof(float)) ||
    !chi_buffer_reserve(exec, &plane->bound, 4 * plane->count[0], sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  float* const opacity = (float*)plane->bound.data;
  float* const rgb = opacity + plane->count[0];
  fill_extinctions(plane, transfer, parts, opacity);
  fill_sums(plane);
  for (size_t i = 0; i < 3 * plane->count[0]; ++i)
  {
    rgb[i] = 1;
  }
  chi_transfer_view bound = *transfer;
  bound.rgb = rgb;
  bound.opacity = opacity;
  bound.count = plane->count[0];
  return chi_classify(exec, out, bricks, &bound, dilate);
}

void chi_transfer_plane_free(const chi_exec* exec, chi_transfer_plane* plane)
{
  chi_buffer_free(exec, &plane->sigma);
  chi_buffer_free(exec, &plane->rgba);
  chi_buffer_free(exec, &plane->bound);
}
