/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_order_internal.h"

#include <math.h>

enum
{
  TAIL = 1 << 26 /* keys beyond the range of all but outliers, at either end */
};

typedef struct key_job
{
  const chi_tet_mesh_view* mesh;
  const chi_order_eye* eye;
  const int32_t* planes;
  double factor[4], base;
  uint32_t* keys;
} key_job;

/* Floats are ordered as their bits are, negative ones backwards; the nearest comes last. */
static uint32_t descending(double distance)
{
  const float f = (float)distance;
  uint32_t bits;
  memcpy(&bits, &f, sizeof bits);
  return ~(bits & 0x80000000u ? ~bits : bits | 0x80000000u);
}

static void measure(void* data, size_t begin, size_t end)
{
  const key_job* const it = (const key_job*)data;
  const size_t chunk = chi_order_chunk(it->mesh->count);
  const double* const m = it->eye->to_eye;
  for (size_t t = begin * chunk; t < end * chunk && t < it->mesh->count; ++t)
  {
    double x[4][3], center[3], q[3];
    chi_order_corners(it->mesh, t, x);
    for (int k = 0; k < 3; ++k)
    {
      center[k] = 0.25 * (x[0][k] + x[1][k] + x[2][k] + x[3][k]);
    }
    for (int k = 0; k < 3; ++k)
    {
      q[k] =
        m[4 * k] * center[0] + m[4 * k + 1] * center[1] + m[4 * k + 2] * center[2] + m[4 * k + 3];
    }
    it->keys[t] = descending(it->eye->parallel ? -q[2] : q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  }
}

chi_status chi_order_centroid_keys(
  const chi_exec* exec, const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys)
{
  key_job job = { .mesh = mesh, .eye = eye, .keys = keys };
  return chi_for(exec, CHI_ORDER_CHUNKS, measure, &job);
}

/* In double: integers of 31 bits times what the eye makes of them, to 2^-53; the key is cut to 32
 * bits of the range that the largest planes could give. */
static void evaluate(void* data, size_t begin, size_t end)
{
  const key_job* const it = (const key_job*)data;
  const size_t n = it->mesh->count, chunk = chi_order_chunk(n);
  const int32_t *const x = it->planes, *const y = x + n, *const z = y + n, *const w = z + n;
  const double fx = it->factor[0], fy = it->factor[1], fz = it->factor[2], fw = it->factor[3];
  const double base = it->base;
  uint32_t* const keys = it->keys;
  const size_t last = end * chunk < n ? end * chunk : n;
  for (size_t t = begin * chunk; t < last; ++t)
  {
    const double key = base + fx * x[t] + fy * y[t] + fz * z[t] + fw * w[t];
    keys[t] = (uint32_t)(int32_t)key ^ 0x80000000u;
  }
}

/* A number of 1 or more as one below 1: a 64th for every power of 2, linear between them. */
static double squeeze(double x)
{
  int power;
  const double share = frexp(x, &power);
  return power < 64 ? (power - 1 + (2 * share - 1)) / 64 : 1;
}

/* Outliers within the range of the others are keyed as they are, those beyond it in its tails. */
static void place_outliers(const chi_order_lift* lift, const key_job* job, double most)
{
  const chi_order_outlier* const outliers = (const chi_order_outlier*)lift->outliers.data;
  for (size_t i = 0; i < lift->outlier_count; ++i)
  {
    double key = 0;
    for (int k = 0; k < 4; ++k)
    {
      key += job->factor[k] * outliers[i].plane[k];
    }
    const double size = fabs(key);
    if (!(size <= most))
    {
      key = copysign(most + TAIL * (size < INFINITY ? squeeze(size / most) : 1), key);
    }
    job->keys[outliers[i].t] = (uint32_t)(int32_t)(job->base + key) ^ 0x80000000u;
  }
}

chi_status chi_order_lift_keys(const chi_exec* exec, const chi_order_lift* lift,
  const chi_tet_mesh_view* mesh, const chi_order_eye* eye, uint32_t* keys)
{
  key_job job = {
    .mesh = mesh, .eye = eye, .planes = (const int32_t*)lift->planes.data, .keys = keys
  };
  double range = 0, away[3];
  for (int k = 0; k < 3; ++k)
  {
    away[k] = eye->at[k] - (eye->parallel ? 0 : lift->center[k]);
  }
  for (int k = 0; k < 4; ++k)
  {
    const double* const f = lift->frame + 3 * k;
    job.factor[k] =
      lift->scale[k] * (k == 3 ? !eye->parallel : f[0] * away[0] + f[1] * away[1] + f[2] * away[2]);
    range += fabs(job.factor[k]);
  }
  /* all planes within +- (2^31 - 2), all keys within 2^31 - CHI_ORDER_GROUP - 2: groups need room;
   * a 32nd of the keys at either end is for outliers */
  const double most = 0x1p31 - CHI_ORDER_GROUP - 2 - (lift->outlier_count ? TAIL : 0);
  const double scale = range > 0 ? most / ((0x1p31 - 1) * range) : 0;
  for (int k = 0; k < 4; ++k)
  {
    job.factor[k] *= scale;
  }
  job.base = -0.5 * CHI_ORDER_GROUP;
  const chi_status status = chi_for(exec, CHI_ORDER_CHUNKS, evaluate, &job);
  place_outliers(lift, &job, most);
  return status == CHI_OK && lift->group_count
    ? chi_order_groups_repair(exec, lift, mesh, eye, keys)
    : status;
}
