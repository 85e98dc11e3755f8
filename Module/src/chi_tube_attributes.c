/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Point arrays carried from the input points to the rings. */

#include "chi_tube_internal.h"

#include <string.h>

enum
{
  LINES_A_CHUNK = 8
};

typedef struct carry_job
{
  const chi_exec* exec;
  const chi_tube* tube;
  int32_t target;
  const chi_array_view* in; /* NULL: ids */
  char* out;
  size_t stride;
} carry_job;

/* Linear between two values, and not by rounding beyond them either. */
static double between(double x, double y, double w)
{
  const double low = x < y ? x : y, high = x < y ? y : x;
  const double z = (1 - w) * x + w * y;
  return w <= 0 ? x : w >= 1 ? y : z < low ? low : z > high ? high : z;
}

/* One tuple between points a and b. */
static void carry_tuple(const carry_job* job, int64_t a, int64_t b, double w, char* out)
{
  const int64_t nearest = w < 0.5 ? a : b;
  if (!job->in)
  {
    memcpy(out, &nearest, sizeof nearest);
    return;
  }
  const chi_array_view* const in = job->in;
  const char* const first = (const char*)in->data + (size_t)a * in->stride;
  const char* const second = (const char*)in->data + (size_t)b * in->stride;
  if (in->type == CHI_F32)
  {
    for (size_t c = 0; c < in->components; ++c)
    {
      float x, y;
      memcpy(&x, first + c * sizeof x, sizeof x);
      memcpy(&y, second + c * sizeof y, sizeof y);
      const float z = (float)between((double)x, (double)y, w);
      memcpy(out + c * sizeof z, &z, sizeof z);
    }
  }
  else if (in->type == CHI_F64)
  {
    for (size_t c = 0; c < in->components; ++c)
    {
      double x, y;
      memcpy(&x, first + c * sizeof x, sizeof x);
      memcpy(&y, second + c * sizeof y, sizeof y);
      const double z = between(x, y, w);
      memcpy(out + c * sizeof z, &z, sizeof z);
    }
  }
  else
  {
    memcpy(out, w < 0.5 ? first : second, in->components * chi_type_size(in->type));
  }
}

static void carry_chunk(void* data, size_t begin, size_t end)
{
  const carry_job* const job = (const carry_job*)data;
  const chi_tube* const t = job->tube;
  const size_t bytes =
    job->in ? job->in->components * chi_type_size(job->in->type) : sizeof(int64_t);
  const size_t cap_points = chi_tube_cap_points(t);
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    const size_t first = chunk * LINES_A_CHUNK, count = t->line_count;
    const size_t last = count - first < LINES_A_CHUNK ? count : first + LINES_A_CHUNK;
    for (size_t i = first; i < last && !chi_is_cancelled(job->exec); ++i)
    {
      const chi_tube_line* const line = &t->line[i];
      chi_spline_curve c;
      chi_spline_get_curve(t->spline, i, &c);
      const int surface = job->target == CHI_TUBE_SURFACE;
      const size_t rings = line->ring_count;
      const size_t own = rings && surface && c.closed ? rings - 1 : rings;
      const size_t copies = surface ? (size_t)t->sides : 1;
      char* const out =
        job->out + (surface ? line->point_start : line->curve_point_start) * job->stride;
      size_t hint = 0;
      for (size_t k = 0; k < own; ++k)
      {
        double w;
        hint = chi_tube_source(&c, t->ring[line->ring_start + k].u, hint, &w);
        char* const tuple = out + k * copies * job->stride;
        carry_tuple(job, chi_tube_point_id(t->lines, i, &c, hint),
          chi_tube_point_id(t->lines, i, &c, hint + 1), w, tuple);
        for (size_t j = 1; j < copies; ++j)
        {
          memcpy(tuple + j * job->stride, tuple, bytes);
        }
      }
      if (!surface || c.closed || own == 0)
      {
        continue;
      }
      /* caps take what their rim has */
      for (size_t j = 0; j < 2 * cap_points; ++j)
      {
        memcpy(out + (own * copies + j) * job->stride,
          out + (j < cap_points ? 0 : (own - 1) * copies) * job->stride, bytes);
      }
    }
  }
}

static chi_status carry(carry_job* job)
{
  if (!job->tube || (job->target != CHI_TUBE_SURFACE && job->target != CHI_TUBE_CURVES))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  if (!job->tube->planned)
  {
    return CHI_ERROR_NOT_READY;
  }
  const size_t chunks = (job->tube->line_count + LINES_A_CHUNK - 1) / LINES_A_CHUNK;
  return chunks ? chi_for(job->exec, chunks, carry_chunk, job) : CHI_OK;
}

chi_status chi_tube_attribute(const chi_exec* exec, const chi_tube* tube, int32_t target,
  const chi_array_view* in, void* out, size_t out_stride)
{
  if (!tube || !chi_array_is_valid(in) || !out ||
    out_stride < in->components * chi_type_size(in->type) ||
    (tube->lines && in->count < tube->lines->points.count))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  carry_job job = { exec, tube, target, in, (char*)out, out_stride };
  return carry(&job);
}

chi_status chi_tube_nearest(
  const chi_exec* exec, const chi_tube* tube, int32_t target, int64_t* ids)
{
  if (!ids)
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  carry_job job = { exec, tube, target, NULL, (char*)ids, sizeof *ids };
  return carry(&job);
}
