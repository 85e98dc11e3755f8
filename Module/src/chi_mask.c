/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* What is left of a volume. */

#include "chi_mask_internal.h"

#include <math.h>
#include <string.h>

enum
{
  BRICK = 8,
  NEAR = 1,   /* cells beyond a brick in which its own samples may lie */
  STEP = 3,   /* and to which a step of up to two voxels from one of them leads */
  CHUNK = 256 /* words of bits a task fills */
};

chi_cut_share chi_crop_share(const chi_scene* s, const double corner[8][3])
{
  if (s->regions == CHI_CROP_ALL_REGIONS)
  {
    return CHI_CUT_NOTHING;
  }
  /* A hundredth of a voxel more on both sides: the kernels' positions are floats, and look a little
   * ahead of a segment. */
  const double margin = 0.01;
  int first[3] = { 0, 0, 0 }, last[3] = { 0, 0, 0 };
  for (int k = 0; k < 6; ++k)
  {
    const double* const c = s->crop[k];
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 8; ++i)
    {
      const double value = c[0] * corner[i][0] + c[1] * corner[i][1] + c[2] * corner[i][2] + c[3];
      least = fmin(least, value);
      most = fmax(most, value);
    }
    first[k / 2] += least - margin >= 0;
    last[k / 2] += most + margin >= 0;
  }
  int kept = 0, gone = 0;
  for (int z = first[2]; z <= last[2]; ++z)
  {
    for (int y = first[1]; y <= last[1]; ++y)
    {
      for (int x = first[0]; x <= last[0]; ++x)
      {
        const int stays = (int)(s->regions >> (x + 3 * y + 9 * z) & 1);
        kept |= stays;
        gone |= !stays;
      }
    }
  }
  return !gone ? CHI_CUT_NOTHING : kept ? CHI_CUT_PART : CHI_CUT_ALL;
}

int chi_mask_is_valid(const chi_mask_view* v, size_t tables)
{
  const size_t size = chi_type_size(v->type);
  for (size_t i = 0; v->table_of_value && i < v->value_count; ++i)
  {
    if (v->table_of_value[i] >= (tables ? tables : 1))
    {
      return 0;
    }
  }
  return !v->values || (size && v->stride >= size);
}

static double value_at(const chi_mask_view* v, size_t i)
{
  return chi_number_at((const char*)v->values + i * v->stride, v->type);
}

typedef struct keep_job
{
  const chi_exec* exec;
  const chi_mask_view* view;
  const chi_bricks* bricks;
  chi_mask* mask;
  uint32_t* bits;
  size_t cells[3], points[3], count;
  int values, flags; /* what decides about these cells */
  int reach;
  uint8_t* whole; /* [bricks] before they grow by reach; likewise */
  uint8_t* some;
} keep_job;

static int is_hidden(const keep_job* it, size_t n)
{
  const chi_mask_view* const v = it->view;
  if (v->cell_flags && (v->cell_flags[n] & v->cell_bits))
  {
    return 1;
  }
  if (!v->point_flags)
  {
    return 0;
  }
  const size_t at[3] = { n % it->cells[0], n / it->cells[0] % it->cells[1],
    n / (it->cells[0] * it->cells[1]) };
  for (int corner = 0; corner < 8; ++corner)
  {
    size_t point = 0;
    for (int a = 2; a >= 0; --a)
    {
      const size_t i = at[a] + (size_t)(corner >> a & 1), last = it->points[a] - 1;
      point = point * it->points[a] + (i < last ? i : last);
    }
    if (v->point_flags[point] & v->point_bits)
    {
      return 1;
    }
  }
  return 0;
}

static void fill_bits(void* data, size_t begin, size_t end)
{
  const keep_job* const it = (const keep_job*)data;
  for (size_t w = begin * CHUNK; w < end * CHUNK && 32 * w < it->count; ++w)
  {
    uint32_t word = 0;
    for (size_t n = 32 * w; n < 32 * w + 32 && n < it->count; ++n)
    {
      const int stays =
        (!it->values || value_at(it->view, n) > 0) && !(it->flags && is_hidden(it, n));
      word |= (uint32_t)stays << (n & 31);
    }
    it->bits[w] = word;
  }
}

/* Bits of `count` <= 32 cells from n on. */
static uint32_t bits_at(const uint32_t* bits, size_t n, size_t count)
{
  const uint64_t pair = bits[n >> 5] | (uint64_t)bits[(n >> 5) + 1] << 32;
  return (uint32_t)(pair >> (n & 31)) & (uint32_t)((UINT64_C(1) << count) - 1);
}

/* Tables of voxels, a layer at a time. */
static void fill_labels(void* data, size_t begin, size_t end)
{
  const keep_job* const it = (const keep_job*)data;
  const size_t layer = it->bricks->dimensions[0] * it->bricks->dimensions[1];
  uint8_t* const labels = (uint8_t*)it->mask->label_bytes.data;
  for (size_t k = begin; k < end && !chi_is_cancelled(it->exec); ++k)
  {
    for (size_t n = k * layer; n < (k + 1) * layer; ++n)
    {
      const double value = value_at(it->view, n); /* NaN fails both */
      labels[n] = value >= 0 && value < (double)it->view->value_count
        ? it->view->table_of_value[(size_t)value]
        : 0;
    }
  }
}

/* Which tables the voxels in and around a brick use. */
static void gather_label_sets(void* data, size_t begin, size_t end)
{
  const keep_job* const it = (const keep_job*)data;
  const chi_bricks* const b = it->bricks;
  const uint8_t* const labels = (const uint8_t*)it->mask->label_bytes.data;
  for (size_t row = begin; row < end && !chi_is_cancelled(it->exec); ++row)
  {
    for (size_t i = 0; i < b->count[0]; ++i)
    {
      uint32_t* const set =
        (uint32_t*)it->mask->label_sets.data + CHI_LABEL_WORDS * (row * b->count[0] + i);
      const size_t at[3] = { i, row % b->count[1], row / b->count[1] };
      size_t low[3], high[3];
      for (int a = 0; a < 3; ++a)
      {
        const size_t first = at[a] * BRICK, last = b->dimensions[a] - 1;
        low[a] = first > STEP ? first - STEP : 0;
        high[a] = first + BRICK + STEP < last ? first + BRICK + STEP : last;
      }
      memset(set, 0, CHI_LABEL_WORDS * sizeof *set);
      for (size_t z = low[2]; z <= high[2]; ++z)
      {
        for (size_t y = low[1]; y <= high[1]; ++y)
        {
          const uint8_t* const line = labels + b->dimensions[0] * (y + b->dimensions[1] * z);
          for (size_t x = low[0]; x <= high[0]; ++x)
          {
            set[line[x] >> 5] |= UINT32_C(1) << (line[x] & 31);
          }
        }
      }
    }
  }
}

static chi_status build_labels(keep_job* job)
{
  const chi_bricks* const b = job->bricks;
  const size_t samples = b->dimensions[0] * b->dimensions[1] * b->dimensions[2];
  const size_t rows = b->count[1] * b->count[2];
  if (!chi_buffer_reserve(job->exec, &job->mask->label_bytes, samples + 4, 1) ||
    !chi_buffer_reserve(
      job->exec, &job->mask->label_sets, rows * b->count[0], CHI_LABEL_WORDS * sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset((uint8_t*)job->mask->label_bytes.data + samples, 0, 4);
  chi_status status = chi_for(job->exec, b->dimensions[2], fill_labels, job);
  if (status == CHI_OK)
  {
    status = chi_for(job->exec, rows, gather_label_sets, job);
  }
  job->mask->labels = status == CHI_OK ? (const uint8_t*)job->mask->label_bytes.data : NULL;
  return status;
}

/* What is left of the cells in and around a brick: 0 nothing, 1 something, 2 all. */
static int share_of_brick(const chi_plan_grid* grid, const size_t brick[3], size_t margin)
{
  size_t low[3], high[3];
  for (int a = 0; a < 3; ++a)
  {
    const size_t first = brick[a] * BRICK, last = (size_t)grid->last[a];
    low[a] = first > margin ? first - margin : 0;
    high[a] = first + BRICK + margin < last ? first + BRICK + margin : last;
    low[a] = low[a] < last ? low[a] : last;
  }
  const size_t count = high[0] - low[0] + 1;
  const uint32_t full = (uint32_t)((UINT64_C(1) << count) - 1);
  int some = 0, all = 1;
  for (size_t k = low[2]; k <= high[2]; ++k)
  {
    for (size_t j = low[1]; j <= high[1]; ++j)
    {
      const uint32_t row =
        bits_at(grid->bits, low[0] + (size_t)grid->step_y * j + (size_t)grid->step_z * k, count);
      some |= row != 0;
      all &= row == full;
    }
  }
  return all ? 2 : some;
}

static void look_at_bricks(void* data, size_t begin, size_t end)
{
  const keep_job* const it = (const keep_job*)data;
  const size_t* const n = it->bricks->count;
  for (size_t row = begin; row < end && !chi_is_cancelled(it->exec); ++row)
  {
    for (size_t i = 0; i < n[0]; ++i)
    {
      const size_t at[3] = { i, row % n[1], row / n[1] };
      int some = 1, whole = 1;
      for (int g = 0; g < it->mask->grids; ++g)
      {
        some &= share_of_brick(it->mask->grid + g, at, NEAR) != 0;
        whole &= some && share_of_brick(it->mask->grid + g, at, STEP) == 2;
      }
      it->some[row * n[0] + i] = (uint8_t)some;
      it->whole[row * n[0] + i] = (uint8_t)whole;
    }
  }
}

/* Steps over bricks see what lies in all of them. */
static void grow_bricks(void* data, size_t begin, size_t end)
{
  const keep_job* const it = (const keep_job*)data;
  const size_t* const n = it->bricks->count;
  const size_t reach = (size_t)it->reach;
  uint8_t* const some = (uint8_t*)it->mask->some.data;
  uint8_t* const whole = (uint8_t*)it->mask->whole.data;
  for (size_t row = begin; row < end && !chi_is_cancelled(it->exec); ++row)
  {
    for (size_t i = 0; i < n[0]; ++i)
    {
      const size_t at[3] = { i, row % n[1], row / n[1] };
      size_t low[3], high[3];
      for (int a = 0; a < 3; ++a)
      {
        low[a] = at[a] > reach ? at[a] - reach : 0;
        high[a] = at[a] + reach < n[a] ? at[a] + reach : n[a] - 1;
      }
      int any = 0, all = 1;
      for (size_t z = low[2]; z <= high[2]; ++z)
      {
        for (size_t y = low[1]; y <= high[1]; ++y)
        {
          for (size_t x = low[0]; x <= high[0]; ++x)
          {
            const size_t brick = x + n[0] * (y + n[1] * z);
            any |= it->some[brick];
            all &= it->whole[brick];
          }
        }
      }
      some[row * n[0] + i] = (uint8_t)any;
      whole[row * n[0] + i] = (uint8_t)all;
    }
  }
}

/* A grid of the samples' voxels, or of the cells between them. */
static chi_status build_grid(keep_job* job, const chi_volume_view* volume, int voxels)
{
  chi_mask* const mask = job->mask;
  chi_plan_grid* const grid = mask->grid + mask->grids;
  chi_buffer* const keep = mask->keep + mask->grids;
  job->count = 1;
  for (int a = 0; a < 3; ++a)
  {
    const size_t n = volume->dimensions[a];
    job->cells[a] = voxels ? n : n > 1 ? n - 1 : 1;
    job->points[a] = volume->is_cell_data ? n + 1 : n;
    job->count *= job->cells[a];
    grid->last[a] = (int32_t)job->cells[a] - 1;
  }
  const size_t words = job->count / 32 + 1;
  if (!chi_buffer_reserve(job->exec, keep, words + 1, sizeof(uint32_t)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  job->bits = (uint32_t*)keep->data;
  job->bits[words - 1] = job->bits[words] = 0; /* read along with the last bits */
  grid->bits = job->bits;
  grid->step_y = (int32_t)job->cells[0];
  grid->step_z = (int32_t)(job->cells[0] * job->cells[1]);
  grid->offset = voxels ? 0.5f : 0;
  ++mask->grids;
  return chi_for(job->exec, (words - 1) / CHUNK + 1, fill_bits, job);
}

chi_status chi_mask_build(const chi_exec* exec, chi_mask* mask, const chi_bricks* bricks,
  const chi_volume_view* volume, const chi_mask_view* view, int reach)
{
  mask->grids = 0;
  mask->labels = NULL;
  const int labels = view && view->values && view->table_of_value;
  const int values = view && view->values && !labels;
  const int flags =
    view && ((view->point_flags && view->point_bits) || (view->cell_flags && view->cell_bits));
  keep_job job = { .exec = exec, .view = view, .bricks = bricks, .mask = mask, .reach = reach };
  chi_status status = labels ? build_labels(&job) : CHI_OK;
  if (status != CHI_OK)
  {
    return status;
  }
  if (values || (flags && volume->is_cell_data))
  {
    job.values = values;
    job.flags = flags && volume->is_cell_data;
    status = build_grid(&job, volume, 1);
  }
  if (status == CHI_OK && flags && !volume->is_cell_data)
  {
    job.values = 0;
    job.flags = 1;
    status = build_grid(&job, volume, 0);
  }
  if (status != CHI_OK || mask->grids == 0)
  {
    mask->grids = status == CHI_OK ? mask->grids : 0;
    return status;
  }
  const size_t rows = bricks->count[1] * bricks->count[2], count = bricks->count[0] * rows;
  const size_t corners = (bricks->count[0] + 1) * (bricks->count[1] + 1) * (bricks->count[2] + 1);
  uint8_t* const raw = (uint8_t*)chi_alloc(exec, 2 * count, 1);
  if (!raw || !chi_buffer_reserve(exec, &mask->some, count, 1) ||
    !chi_buffer_reserve(exec, &mask->whole, count + 4, 1) ||
    !chi_buffer_reserve(exec, &mask->sums, corners, sizeof(int32_t)))
  {
    status = CHI_ERROR_OUT_OF_MEMORY;
  }
  if (status == CHI_OK)
  {
    job.some = raw;
    job.whole = raw + count;
    status = chi_for(exec, rows, look_at_bricks, &job);
  }
  if (status == CHI_OK)
  {
    status = chi_for(exec, rows, grow_bricks, &job);
  }
  if (status == CHI_OK)
  {
    uint8_t* const whole = (uint8_t*)mask->whole.data;
    memset(whole + count, 0, 4); /* read along with the last brick */
    for (size_t i = 0; i < count; ++i)
    {
      raw[i] = !whole[i];
    }
    chi_bricks_sum(bricks, raw, (int32_t*)mask->sums.data);
  }
  if (raw)
  {
    chi_free(exec, raw, 2 * count, 1);
  }
  mask->grids = status == CHI_OK ? mask->grids : 0;
  return status;
}

void chi_mask_free(const chi_exec* exec, chi_mask* mask)
{
  for (int k = 0; k < CHI_PLAN_GRIDS; ++k)
  {
    chi_buffer_free(exec, &mask->keep[k]);
  }
  chi_buffer_free(exec, &mask->some);
  chi_buffer_free(exec, &mask->whole);
  chi_buffer_free(exec, &mask->sums);
  chi_buffer_free(exec, &mask->label_bytes);
  chi_buffer_free(exec, &mask->label_sets);
}

void chi_mask_apply(const chi_mask* mask, const chi_bricks* bricks, chi_classification* out)
{
  if (!mask || mask->grids == 0)
  {
    return;
  }
  uint8_t* const occupied = (uint8_t*)out->occupied.data;
  const uint8_t* const some = (const uint8_t*)mask->some.data;
  for (size_t i = 0; i < bricks->count[0] * bricks->count[1] * bricks->count[2]; ++i)
  {
    occupied[i] &= some[i];
  }
  out->occupied_bricks = chi_bricks_sum(bricks, occupied, (int32_t*)out->sums.data);
}

int chi_mask_cuts(
  const chi_mask* mask, const chi_bricks* bricks, const double low[3], const double high[3])
{
  int64_t all;
  return mask && mask->grids &&
    chi_bricks_count(bricks, (const int32_t*)mask->sums.data, low, high, &all) > 0;
}

int chi_cut_prepare(chi_plan_cut* cut, const chi_scene* scene, const chi_mask* mask)
{
  memset(cut, 0, sizeof *cut);
  cut->regions = scene->regions;
  for (int k = 0; k < 24; ++k)
  {
    cut->plane[k / 4][k % 4] = (float)scene->crop[k / 4][k % 4];
  }
  cut->grids = mask ? mask->grids : 0;
  for (int k = 0; k < cut->grids; ++k)
  {
    cut->grid[k] = mask->grid[k];
  }
  cut->whole = cut->grids ? (const uint8_t*)mask->whole.data : NULL;
  cut->ahead = 1.0f / 64;
  return cut->regions != CHI_CROP_ALL_REGIONS || cut->grids > 0;
}
