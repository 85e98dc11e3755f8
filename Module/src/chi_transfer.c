/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_internal.h"

#include <math.h>
#include <string.h>

/* theory/occlusion.md, Eq. 1. The clamp keeps an opaque sample finite: one unit distance leaves
 * 2^-24, the last bit of a float. */
double chi_extinction(double opacity, double unit_distance)
{
  const double clear = 1 - 0x1p-24;
  const double alpha = opacity > 0 ? (opacity < clear ? opacity : clear) : 0; /* NaN: transparent */
  return -log1p(-alpha) / unit_distance;
}

static float unit(float x)
{
  return x > 0 ? (x < 1 ? x : 1) : 0;
}

static void fill_tables(chi_classification* out, const chi_transfer_view* transfer)
{
  chi_plan_entry* const sigma = (chi_plan_entry*)out->sigma.data;
  float(*const rgba)[4] = (float(*)[4])out->rgba.data;
  uint32_t* const before = (uint32_t*)out->visible_before.data;
  const size_t n = out->entries;
  double total = 0;
  uint32_t visible = 0;
  for (size_t i = 0; i < n; ++i)
  {
    const double here = chi_extinction(transfer->opacity[i], transfer->unit_distance);
    const double next =
      i + 1 < n ? chi_extinction(transfer->opacity[i + 1], transfer->unit_distance) : here;
    sigma[i].sigma = (float)here;
    sigma[i].half_slope = (float)(0.5 * (next - here));
    sigma[i].reserved = 0;
    total += 0.5 * (here + next);
    before[i] = visible;
    visible += here > 0;
    for (int c = 0; c < 3; ++c)
    {
      rgba[i][c] = unit(transfer->rgb[3 * i + (size_t)c]);
    }
    rgba[i][3] = 1;
  }
  before[n] = visible;
  /* Sums in fixed point, so that their differences lose nothing to cancellation. */
  const double quantum = total > 0 ? total / 2147483000.0 : 1;
  double sum = 0;
  for (size_t i = 0; i < n; ++i)
  {
    sigma[i].sum = (int32_t)(sum / quantum + 0.5);
    const double here = chi_extinction(transfer->opacity[i], transfer->unit_distance);
    const double next =
      i + 1 < n ? chi_extinction(transfer->opacity[i + 1], transfer->unit_distance) : here;
    sum += 0.5 * (here + next);
  }
  out->quantum = (float)quantum;
}

/* Extinction and colour are linear from entry to entry; their product's integral is exact. */
static void fill_colors(chi_classification* out, const chi_transfer_view* transfer)
{
  chi_plan_color* const colors = (chi_plan_color*)out->colors.data;
  const chi_plan_entry* const sigma = (const chi_plan_entry*)out->sigma.data;
  const float(*const rgba)[4] = (const float(*)[4])out->rgba.data;
  const size_t n = out->entries;
  for (int c = 0; c < 4; ++c)
  {
    double sum = 0;
    for (size_t i = 0; i < n; ++i)
    {
      const double s0 = chi_extinction(transfer->opacity[i], transfer->unit_distance);
      const double s1 =
        i + 1 < n ? chi_extinction(transfer->opacity[i + 1], transfer->unit_distance) : s0;
      const double c0 = c < 3 ? (double)rgba[i][c] : 0;
      const double c1 = c < 3 && i + 1 < n ? (double)rgba[i + 1][c] : c0;
      const double part = (c0 * (2 * s0 + s1) + c1 * (s0 + 2 * s1)) / 6;
      const double all = (double)sigma[i].sigma + (double)sigma[i].half_slope;
      colors[i].sum[c] = (int32_t)(sum / (double)out->quantum + 0.5);
      colors[i].rgb[c] = all > 0 ? unit((float)(part / all)) : (float)(0.5 * (c0 + c1));
      sum += part;
    }
  }
}

/* Colour of the segment between two entries as the kernels find it, to first order in the optical
 * thickness (half as many parts), less that of its middle; the largest of the channels. */
static double middle_error(const chi_classification* c, size_t first, size_t cross, double length)
{
  const chi_plan_entry* const sigma = (const chi_plan_entry*)c->sigma.data;
  const chi_plan_color* const colors = (const chi_plan_color*)c->colors.data;
  const float* const at = ((const float(*)[4])c->rgba.data)[first + cross / 2];
  const size_t middle = first + cross / 2, last = first + cross;
  const double left = (double)sigma[middle].sum - (double)sigma[first].sum;
  const double right = (double)sigma[last].sum - (double)sigma[middle].sum;
  const double all = left + right;
  if (!(all > 0))
  {
    return 0;
  }
  const double tau = all * (double)c->quantum / (double)cross * length;
  /* mean place of what the eye sees, from the middle of the optical thickness: 1/2 - 1/tau +
   * 1/(e^tau
   * - 1) to 3 % */
  const double forward = tau / 12 / sqrt(1 + tau * tau / 36);
  double error = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double a = (double)colors[middle].sum[k] - (double)colors[first].sum[k];
    const double b = (double)colors[last].sum[k] - (double)colors[middle].sum[k];
    const double bend = left > 0 && right > 0 ? 2 * forward * fabs(b / right - a / left) : 0;
    error = fmax(error, fabs((a + b) / all - (double)at[k]) + bend);
  }
  /* A ray crosses the same values some 16 times at most before what is behind does not matter. */
  return error * fmin(1, 16 * tau);
}

float chi_classification_color_step(const chi_classification* c, double length)
{
  /* Windows half overlapping; of tables beyond 4096 entries, none narrower than 1/4096 of them. */
  size_t cross = 2;
  while (cross < c->entries / 4096)
  {
    cross *= 2;
  }
  float good = cross > 2 ? 0.0f : 1.0f;
  for (; cross < c->entries; cross *= 2)
  {
    for (size_t first = 0; first + cross < c->entries; first += (cross + 3) / 4)
    {
      if (middle_error(c, first, cross, length) > 1.0 / 255)
      {
        return good;
      }
    }
    good = (float)cross;
  }
  return INFINITY;
}

/* Whether any scalar of a brick's range is visible by a table. */
static int range_is_visible(const chi_classification* c, const float range[2], size_t table)
{
  const uint32_t* const before = (const uint32_t*)c->visible_before.data + table * c->table_entries;
  if (!(range[0] <= range[1]))
  {
    return 0;
  }
  const double end = (double)(c->table_entries - 1);
  double low = ((double)range[0] - c->base) * c->scale + c->offset;
  double high = ((double)range[1] - c->base) * c->scale + c->offset;
  /* A brick of exactly the scalar at which a ramp begins is transparent: a thousandth of an entry,
   * what the kernels' floats may add, counts for nothing. */
  const double tolerance = 1e-3;
  low += tolerance;
  high -= tolerance;
  const size_t first = (size_t)(low < 0 ? 0 : low > end ? end : low);
  const size_t last = (size_t)ceil(high < 0 ? 0 : high > end ? end : high);
  return last >= first ? before[last + 1] > before[first] : 0;
}

/* By any table that its voxels use. */
static int brick_is_visible(const chi_classification* c, const float range[2], size_t brick)
{
  if (!c->mask || !c->mask->labels)
  {
    return range_is_visible(c, range, 0);
  }
  const uint32_t* const set = (const uint32_t*)c->mask->label_sets.data + CHI_LABEL_WORDS * brick;
  for (size_t table = 0; table < c->tables; ++table)
  {
    if ((set[table >> 5] >> (table & 31) & 1) && range_is_visible(c, range, table))
    {
      return 1;
    }
  }
  return 0;
}

typedef struct classify_job
{
  const chi_exec* exec;
  chi_classification* out;
  const chi_bricks* bricks;
  int dilate;
} classify_job;

static int brick_is_occupied(const classify_job* it, size_t i, size_t j, size_t k)
{
  const chi_bricks* const b = it->bricks;
  const float(*const range)[2] = (const float(*)[2])b->range.data;
  const size_t reach = (size_t)it->dilate;
  const size_t low[3] = { i > reach ? i - reach : 0, j > reach ? j - reach : 0,
    k > reach ? k - reach : 0 };
  const size_t at[3] = { i, j, k };
  size_t high[3];
  for (int a = 0; a < 3; ++a)
  {
    high[a] = at[a] + reach < b->count[a] ? at[a] + reach : b->count[a] - 1;
  }
  for (size_t z = low[2]; z <= high[2]; ++z)
  {
    for (size_t y = low[1]; y <= high[1]; ++y)
    {
      for (size_t x = low[0]; x <= high[0]; ++x)
      {
        const size_t brick = x + b->count[0] * (y + b->count[1] * z);
        if (brick_is_visible(it->out, range[brick], brick))
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

static void classify_rows(void* data, size_t begin, size_t end)
{
  const classify_job* const it = (const classify_job*)data;
  const chi_bricks* const b = it->bricks;
  uint8_t* const occupied = (uint8_t*)it->out->occupied.data;
  for (size_t row = begin; row < end && !chi_is_cancelled(it->exec); ++row)
  {
    for (size_t i = 0; i < b->count[0]; ++i)
    {
      occupied[row * b->count[0] + i] =
        (uint8_t)brick_is_occupied(it, i, row % b->count[1], row / b->count[1]);
    }
  }
}

chi_status chi_classify(const chi_exec* exec, chi_classification* out, const chi_bricks* bricks,
  const chi_transfer_view* transfer, int dilate)
{
  const size_t tables = transfer->table_count ? transfer->table_count : 1;
  const size_t n = transfer->count * tables;
  const size_t count = bricks->count[0] * bricks->count[1] * bricks->count[2];
  const size_t corners = (bricks->count[0] + 1) * (bricks->count[1] + 1) * (bricks->count[2] + 1);
  if (!chi_buffer_reserve(exec, &out->sigma, n, sizeof(chi_plan_entry)) ||
    !chi_buffer_reserve(exec, &out->rgba, n + 1, 4 * sizeof(float)) ||
    !chi_buffer_reserve(exec, &out->colors, n, sizeof(chi_plan_color)) ||
    !chi_buffer_reserve(exec, &out->visible_before, n + 1, sizeof(uint32_t)) ||
    !chi_buffer_reserve(exec, &out->occupied, count + 4, 1) ||
    !chi_buffer_reserve(exec, &out->sums, corners, sizeof(int32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  out->entries = n;
  out->tables = tables;
  out->table_entries = transfer->count;
  /* scalar -> table position, through the copy's own scale where there is a copy */
  const double entries_per_scalar =
    (double)(transfer->count - 1) / (transfer->range[1] - transfer->range[0]);
  const double scale = entries_per_scalar / bricks->copy_scale;
  const double first = (transfer->range[0] - bricks->copy_offset) * bricks->copy_scale;
  out->base = (float)first; /* subtracted before scaling: scalars far from zero lose nothing more */
  out->scale = (float)scale;
  out->offset = (float)(((double)out->base - first) * scale);
  fill_tables(out, transfer);
  fill_colors(out, transfer);
  memset((uint8_t*)out->occupied.data + count, 0, 4);
  classify_job job = { exec, out, bricks, dilate };
  const chi_status status = chi_for(exec, bricks->count[1] * bricks->count[2], classify_rows, &job);
  if (status == CHI_OK)
  {
    out->occupied_bricks =
      chi_bricks_sum(bricks, (const uint8_t*)out->occupied.data, (int32_t*)out->sums.data);
  }
  return status;
}

void chi_classification_free(const chi_exec* exec, chi_classification* c)
{
  chi_buffer_free(exec, &c->sigma);
  chi_buffer_free(exec, &c->rgba);
  chi_buffer_free(exec, &c->colors);
  chi_buffer_free(exec, &c->visible_before);
  chi_buffer_free(exec, &c->occupied);
  chi_buffer_free(exec, &c->sums);
  chi_buffer_free(exec, &c->gradient_opacity);
  chi_transfer_plane_free(exec, &c->plane);
}
