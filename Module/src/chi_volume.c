/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_occlusion_internal.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Samples beyond a brick whose values count as its own: one slice's step of up to two voxels from a
 * point in the brick still meets only scalars within the brick's range. */
enum
{
  BRICK = 8,
  MARGIN = 2,
  SLACK = CHI_LINE - 1
};

int chi_buffer_reserve(const chi_exec* exec, chi_buffer* buffer, size_t count, size_t size)
{
  if (size != 0 && count > SIZE_MAX / size)
  {
    return 0;
  }
  const size_t bytes = count * size;
  if (bytes <= buffer->bytes)
  {
    return 1;
  }
  chi_buffer_free(exec, buffer);
  if (bytes > SIZE_MAX - SLACK)
  {
    return 0;
  }
  buffer->block = chi_alloc(exec, bytes + SLACK, 1);
  if (!buffer->block)
  {
    return 0;
  }
  buffer->data = (char*)buffer->block + (-(uintptr_t)buffer->block & SLACK);
  buffer->bytes = bytes;
  return 1;
}

void chi_buffer_free(const chi_exec* exec, chi_buffer* buffer)
{
  if (buffer->data)
  {
    chi_free(exec, buffer->block, buffer->bytes + SLACK, 1);
  }
  memset(buffer, 0, sizeof *buffer);
}

typedef struct brick_job
{
  const chi_exec* exec;
  chi_bricks* bricks;
  const chi_volume_view* volume;
  double* extremes;    /* [layers][2] */
  int64_t* non_finite; /* [layers] */
} brick_job;

static double scalar_at(const chi_volume_view* v, size_t i)
{
  return chi_number_at((const char*)v->scalars + i * v->stride, v->type);
}

/* Finite extremes and non-finite count of whole layers of samples, for the scale of the copy. */
static void layer_extremes(void* data, size_t begin, size_t end)
{
  const brick_job* const it = (const brick_job*)data;
  const size_t layer = it->volume->dimensions[0] * it->volume->dimensions[1];
  for (size_t k = begin; k < end && !chi_is_cancelled(it->exec); ++k)
  {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = k * layer; i < (k + 1) * layer; ++i)
    {
      const double x = scalar_at(it->volume, i);
      if (isfinite(x))
      {
        low = x < low ? x : low;
        high = x > high ? x : high;
      }
    }
    it->extremes[2 * k] = low;
    it->extremes[2 * k + 1] = high;
  }
}

static void copy_layers(void* data, size_t begin, size_t end)
{
  const brick_job* const it = (const brick_job*)data;
  const size_t layer = it->volume->dimensions[0] * it->volume->dimensions[1];
  float* const copy = (float*)it->bricks->copy.data;
  for (size_t k = begin; k < end && !chi_is_cancelled(it->exec); ++k)
  {
    for (size_t i = k * layer; i < (k + 1) * layer; ++i)
    {
      const double x = scalar_at(it->volume, i);
      copy[i] = isfinite(x) ? (float)((x - it->bricks->copy_offset) * it->bricks->copy_scale) : NAN;
    }
  }
}

#define CHI_ROW_RANGE(name, ctype)                                                                 \
  static int64_t name(const ctype* row, size_t low_x, size_t high_x, float range[2])               \
  {                                                                                                \
    ctype low = row[low_x], high = row[low_x];                                                     \
    for (size_t x = low_x; x <= high_x; ++x)                                                       \
    {                                                                                              \
      low = row[x] < low ? row[x] : low;                                                           \
      high = row[x] > high ? row[x] : high;                                                        \
    }                                                                                              \
    range[0] = (float)low < range[0] ? (float)low : range[0];                                      \
    range[1] = (float)high > range[1] ? (float)high : range[1];                                    \
    return 0;                                                                                      \
  }
CHI_ROW_RANGE(range_u8, uint8_t)
CHI_ROW_RANGE(range_i16, int16_t)
CHI_ROW_RANGE(range_u16, uint16_t)

static void range_f32(const float* row, size_t low_x, size_t high_x, float range[2])
{
  for (size_t x = low_x; x <= high_x; ++x)
  {
    if (isfinite(row[x]))
    {
      range[0] = row[x] < range[0] ? row[x] : range[0];
      range[1] = row[x] > range[1] ? row[x] : range[1];
    }
  }
}

static size_t clamp_low(size_t brick)
{
  return brick == 0 ? 0 : brick * BRICK - MARGIN;
}

static size_t clamp_high(size_t brick, size_t samples)
{
  const size_t high = brick * BRICK + BRICK + MARGIN;
  return high < samples ? high : samples - 1;
}

/* Ranges of the bricks of one row of bricks along x. */
static void brick_rows(void* data, size_t begin, size_t end)
{
  const brick_job* const it = (const brick_job*)data;
  chi_bricks* const b = it->bricks;
  const size_t nx = b->dimensions[0], ny = b->dimensions[1];
  for (size_t row = begin; row < end && !chi_is_cancelled(it->exec); ++row)
  {
    const size_t j = row % b->count[1], k = row / b->count[1];
    float(*const range)[2] = (float(*)[2])b->range.data + row * b->count[0];
    for (size_t i = 0; i < b->count[0]; ++i)
    {
      range[i][0] = INFINITY;
      range[i][1] = -INFINITY;
    }
    for (size_t z = clamp_low(k); z <= clamp_high(k, b->dimensions[2]); ++z)
    {
      for (size_t y = clamp_low(j); y <= clamp_high(j, ny); ++y)
      {
        const size_t at = nx * (y + ny * z);
        for (size_t i = 0; i < b->count[0]; ++i)
        {
          const size_t low = clamp_low(i), high = clamp_high(i, nx);
          switch (b->fetch)
          {
            case CHI_FETCH_U8:
              range_u8((const uint8_t*)b->scalars + at, low, high, range[i]);
              break;
            case CHI_FETCH_I16:
              range_i16((const int16_t*)b->scalars + at, low, high, range[i]);
              break;
            case CHI_FETCH_U16:
              range_u16((const uint16_t*)b->scalars + at, low, high, range[i]);
              break;
            default:
              range_f32((const float*)b->scalars + at, low, high, range[i]);
              break;
          }
        }
      }
    }
  }
}

static void count_non_finite(void* data, size_t begin, size_t end)
{
  const brick_job* const it = (const brick_job*)data;
  const size_t layer = it->bricks->dimensions[0] * it->bricks->dimensions[1];
  const float* const x = (const float*)it->bricks->scalars;
  for (size_t k = begin; k < end && !chi_is_cancelled(it->exec); ++k)
  {
    int64_t count = 0;
    for (size_t i = k * layer; i < (k + 1) * layer; ++i)
    {
      count += !isfinite(x[i]);
    }
    it->non_finite[k] = count;
  }
}

/* How samples of the type are fetched; -1: as floats, if they are copied first. */
static int fetch_of(const chi_volume_view* v, size_t samples)
{
  if (samples * chi_type_size(v->type) < 4)
  {
    return -1;
  }
  switch (v->type)
  {
    case CHI_U8:
      return CHI_FETCH_U8;
    case CHI_I16:
      return CHI_FETCH_I16;
    case CHI_U16:
      return CHI_FETCH_U16;
    case CHI_F32:
      return CHI_FETCH_F32;
    default:
      return -1;
  }
}

/* Components of interleaved samples, and samples at odd addresses, in their own type. */
static void pack_layers(void* data, size_t begin, size_t end)
{
  const brick_job* const it = (const brick_job*)data;
  const chi_volume_view* const v = it->volume;
  const size_t layer = v->dimensions[0] * v->dimensions[1], size = chi_type_size(v->type);
  for (size_t k = begin; k < end && !chi_is_cancelled(it->exec); ++k)
  {
    const char* from = (const char*)v->scalars + k * layer * v->stride;
    char* to = (char*)it->bricks->copy.data + k * layer * size;
    for (size_t i = 0; i < layer; ++i, from += v->stride, to += size)
    {
      switch (size)
      {
        case 1:
          *to = *from;
          break;
        case 2:
          memcpy(to, from, 2);
          break;
        default:
          memcpy(to, from, 4);
          break;
      }
    }
  }
}

static chi_status pack_samples(brick_job* job, size_t samples)
{
  chi_bricks* const b = job->bricks;
  if (!chi_buffer_reserve(job->exec, &b->copy, samples, chi_type_size(job->volume->type)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  b->scalars = b->copy.data;
  return chi_for(job->exec, b->dimensions[2], pack_layers, job);
}

static chi_status copy_samples(brick_job* job, size_t samples)
{
  chi_bricks* const b = job->bricks;
  const size_t layers = b->dimensions[2];
  if (!chi_buffer_reserve(job->exec, &b->copy, samples, sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  chi_status status = chi_for(job->exec, layers, layer_extremes, job);
  if (status != CHI_OK)
  {
    return status;
  }
  double low = INFINITY, high = -INFINITY;
  for (size_t k = 0; k < layers; ++k)
  {
    low = job->extremes[2 * k] < low ? job->extremes[2 * k] : low;
    high = job->extremes[2 * k + 1] > high ? job->extremes[2 * k + 1] : high;
  }
  /* Centre and scale first: 64-bit integers and doubles far from zero keep their differences. */
  b->copy_offset = low <= high ? 0.5 * low + 0.5 * high : 0;
  const double half = low <= high ? 0.5 * high - 0.5 * low : 0;
  b->copy_scale = half > 0 ? 1 / half : 1;
  b->scalars = b->copy.data;
  b->fetch = CHI_FETCH_F32;
  return chi_for(job->exec, layers, copy_layers, job);
}

chi_status chi_bricks_build(const chi_exec* exec, chi_bricks* b, const chi_volume_view* volume)
{
  size_t samples = 1, bricks = 1;
  for (int a = 0; a < 3; ++a)
  {
    b->dimensions[a] = volume->dimensions[a];
    b->count[a] = (volume->dimensions[a] - 1) / BRICK + 1;
    samples *= volume->dimensions[a]; /* the caller checked the product */
    bricks *= b->count[a];
  }
  const size_t layers = b->dimensions[2];
  double* const extremes = (double*)chi_alloc(exec, 2 * layers, sizeof(double));
  int64_t* const non_finite = (int64_t*)chi_alloc(exec, layers, sizeof(int64_t));
  brick_job job = { exec, b, volume, extremes, non_finite };
  chi_status status =
    extremes && non_finite && chi_buffer_reserve(exec, &b->range, bricks, 2 * sizeof(float))
    ? CHI_OK
    : CHI_ERROR_OUT_OF_MEMORY;
  if (status == CHI_OK)
  {
    b->copy_scale = 1;
    b->copy_offset = 0;
    b->scalars = volume->scalars;
    b->fetch = fetch_of(volume, samples);
    const size_t size = chi_type_size(volume->type);
    if (b->fetch < 0)
    {
      status = copy_samples(&job, samples);
    }
    else if (volume->stride != size || (uintptr_t)volume->scalars % size != 0)
    {
      status = pack_samples(&job, samples);
    }
  }
  b->nearest = volume->interpolation == CHI_NEAREST;
  b->non_finite = 0;
  if (status == CHI_OK)
  {
    status = chi_for(exec, b->count[1] * b->count[2], brick_rows, &job);
  }
  if (status == CHI_OK && b->fetch == CHI_FETCH_F32)
  {
    status = chi_for(exec, layers, count_non_finite, &job);
    for (size_t k = 0; k < layers && status == CHI_OK; ++k)
    {
      b->non_finite += non_finite[k];
    }
  }
  if (extremes)
  {
    chi_free(exec, extremes, 2 * layers, sizeof(double));
  }
  if (non_finite)
  {
    chi_free(exec, non_finite, layers, sizeof(int64_t));
  }
  return status;
}

int64_t chi_bricks_sum(const chi_bricks* b, const uint8_t* flags, int32_t* sums)
{
  const size_t nx = b->count[0] + 1, ny = b->count[1] + 1, nz = b->count[2] + 1;
  memset(sums, 0, nx * ny * nz * sizeof *sums);
  for (size_t k = 1; k < nz; ++k)
  {
    for (size_t j = 1; j < ny; ++j)
    {
      int32_t* const row = sums + nx * (j + ny * k);
      int32_t along = 0;
      for (size_t i = 1; i < nx; ++i)
      {
        along += *flags++ != 0;
        row[i] = along + row[i - nx] + row[i - nx * ny] - row[i - nx - nx * ny];
      }
    }
  }
  return sums[nx * ny * nz - 1];
}

int64_t chi_bricks_count(const chi_bricks* bricks, const int32_t* s, const double low[3],
  const double high[3], int64_t* all)
{
  size_t a[3], b[3];
  for (int k = 0; k < 3; ++k)
  {
    const double last = (double)(bricks->dimensions[k] - 1);
    /* A hundredth of a voxel more on both sides: the kernels' positions are floats. */
    const double l = low[k] - 0.01, h = high[k] + 0.01;
    a[k] = (size_t)(l < 0 ? 0 : l > last ? last : l) >> 3;
    b[k] = ((size_t)(h < 0 ? 0 : h > last ? last : h) >> 3) + 1;
  }
  const size_t nx = bricks->count[0] + 1, ny = bricks->count[1] + 1;
#define CHI_AT(i, j, k) ((int64_t)s[(i) + nx * ((j) + ny * (k))])
  const int64_t sum = CHI_AT(b[0], b[1], b[2]) - CHI_AT(a[0], b[1], b[2]) -
    CHI_AT(b[0], a[1], b[2]) - CHI_AT(b[0], b[1], a[2]) + CHI_AT(a[0], a[1], b[2]) +
    CHI_AT(a[0], b[1], a[2]) + CHI_AT(b[0], a[1], a[2]) - CHI_AT(a[0], a[1], a[2]);
#undef CHI_AT
  *all = (int64_t)((b[0] - a[0]) * (b[1] - a[1]) * (b[2] - a[2]));
  return sum;
}

void chi_bricks_free(const chi_exec* exec, chi_bricks* b)
{
  chi_buffer_free(exec, &b->copy);
  chi_buffer_free(exec, &b->range);
}
