/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* The quadratic form of a lift: coordinates in which it is |x|^2 to begin with, and the search for
 * one that is convex across every face. */
#include "chi_tet_order_lift.h"

#include <math.h>

enum
{
  ROUNDS = 12 /* of the search */
};

void chi_lift_find_frame(void* data, size_t begin, size_t end)
{
  const lift_job* const it = (const lift_job*)data;
  const size_t chunk = chi_order_chunk(it->mesh->count);
  for (size_t c = begin; c < end; ++c)
  {
    part* const p = it->parts + c;
    for (size_t t = c * chunk; t < it->mesh->count && t < (c + 1) * chunk; ++t)
    {
      double x[4][3], sum = 0;
      chi_order_corners(it->mesh, t, x);
      for (int i = 0; i < 12; ++i)
      {
        sum += 0 * x[i / 3][i % 3];
      }
      for (int i = 0; sum == 0 && i < 4; ++i) /* one that is not finite has no say */
      {
        double e[3], q[6];
        for (int k = 0; k < 3; ++k)
        {
          p->low[k] = x[i][k] < p->low[k] ? x[i][k] : p->low[k];
          p->high[k] = x[i][k] > p->high[k] ? x[i][k] : p->high[k];
          e[k] = x[i][k] - x[0][k];
        }
        squares(e, q);
        for (int k = 0; k < 6; ++k)
        {
          p->covariance[k] += q[k];
        }
      }
    }
  }
}

/* Coordinates in which edges are as long one way as another, and |x|^2 in them. */
void chi_lift_set_frame(chi_order_lift* lift, const part* p, size_t count)
{
  /* Cholesky: covariance = l l^T, rows below the diagonal; where it vanishes, as in flat meshes,
   * any length does */
  double l[9] = { 0 }, a[9];
  const double trace = p->covariance[0] + p->covariance[1] + p->covariance[2];
  const double least = trace > 0 ? 1e-12 * trace : 1;
  for (int i = 0; i < 3; ++i)
  {
    lift->center[i] = p->low[i] <= p->high[i] ? 0.5 * p->low[i] + 0.5 * p->high[i] : 0;
    a[4 * i] = p->covariance[i];
    a[3 * i + (i + 1) % 3] = a[3 * ((i + 1) % 3) + i] = p->covariance[3 + i];
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j <= i; ++j)
    {
      double s = a[3 * i + j];
      for (int k = 0; k < j; ++k)
      {
        s -= l[3 * i + k] * l[3 * j + k];
      }
      l[3 * i + j] = i == j ? sqrt(s > least ? s : least) : s / l[4 * j];
    }
  }
  const double unit = sqrt(3.0 * (double)count);
  for (int j = 0; j < 3; ++j)
  {
    for (int i = 0; i < 3; ++i)
    {
      double s = i == j;
      for (int k = 0; k < i; ++k)
      {
        s -= l[3 * i + k] / unit * lift->frame[3 * k + j];
      }
      lift->frame[3 * i + j] = s / (l[4 * i] / unit);
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    const int m = (k + 1) % 3;
    lift->form[k] = lift->form[3 + k] = 0;
    for (int i = 0; i < 3; ++i)
    {
      lift->form[k] += l[3 * i + k] * l[3 * i + k] / (unit * unit);
      lift->form[3 + k] += 2 * l[3 * i + k] * l[3 * i + m] / (unit * unit);
    }
  }
}

/* The point of the vectors' convex hull that is nearest to the origin: as a form, the one whose
 * least product with a vector is greatest for its length. Source: Gilbert, "An Iterative Procedure
 * for Computing the Minimum of a Quadratic Form on a Convex Set", 1966. */
static double separate(const double (*vectors)[6], size_t count, double form[6])
{
  memcpy(form, vectors[0], sizeof vectors[0]);
  for (int step = 0; step < 4000; ++step)
  {
    size_t worst = 0;
    double least = INFINITY;
    for (size_t i = 0; i < count; ++i)
    {
      const double product = dot(form, vectors[i], 6);
      worst = product < least ? i : worst;
      least = product < least ? product : least;
    }
    const double square = dot(form, form, 6);
    if (square - least <= 1e-3 * square)
    {
      break;
    }
    double to[6], share;
    for (int k = 0; k < 6; ++k)
    {
      to[k] = vectors[worst][k] - form[k];
    }
    share = (square - least) / dot(to, to, 6);
    for (int k = 0; k < 6; ++k)
    {
      form[k] += (share < 1 ? share : 1) * to[k];
    }
  }
  return sqrt(dot(form, form, 6));
}

/* A form whose lift is strictly convex across all faces of the sample, then across those of all
 * that fail: vectors of failing faces are gathered until one form separates them. 0: none. */
chi_status chi_lift_search(const chi_exec* exec, lift_job* job, double form[6], int* found)
{
  static const size_t most = ROUNDS * CHI_ORDER_CHUNKS;
  chi_buffer gathered = { 0 };
  if (!chi_buffer_reserve(exec, &gathered, most, 6 * sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  double(*const vectors)[6] = (double(*)[6])gathered.data;
  size_t count = 0;
  chi_status status = CHI_OK;
  *found = 0;
  job->searches = 1;
  for (int round = 0; round < ROUNDS && status == CHI_OK; ++round)
  {
    part sum;
    job->stride = round < ROUNDS - 3 && !*found ? job->mesh->count / SAMPLE + 1 : 1;
    status = chi_lift_run(exec, job, chi_lift_judge_faces, &sum);
    if (count && sum.worst > 1e-9) /* separates by far more than the vectors' rounding */
    {
      if (*found)
      {
        break;
      }
      *found = 1;
      continue; /* and the rest of the faces? */
    }
    const size_t had = count;
    for (size_t c = 0; c < CHI_ORDER_CHUNKS; ++c)
    {
      if (job->parts[c].worst < 0.5 * fabs(sum.worst) + 1e-3)
      {
        memcpy(vectors[count++], job->parts[c].vector, sizeof vectors[0]);
      }
    }
    *found = *found && count > had;
    if (count == had || separate((const double(*)[6])vectors, count, job->lift->form) < 1e-7)
    {
      *found = 0;
      break;
    }
  }
  memcpy(form, job->lift->form, 6 * sizeof *form);
  job->stride = 1;
  job->searches = 0;
  chi_buffer_free(exec, &gathered);
  return status;
}
