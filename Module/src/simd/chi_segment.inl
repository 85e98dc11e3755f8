/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef CHI_SEGMENT_INL
#define CHI_SEGMENT_INL

/*
 * Colour and transmittance of segments of rays along which the scalar is linear, a vector of them
 * at a time, for the kernels of engines to include. One function a method:
 *
 *   segment_none, segment_partial, segment_full(tables, x0, x1, length, out)
 *
 * x0, x1: places of the front and back scalar in the tables, within 0 ... count - 1 (clamp them);
 * length: world units, >= 0; out: premultiplied red, green, blue, and the transmittance. Equations
 * of theory/preintegration.md.
 */

#include "chi_vec.h"

#include <chiaroscuro/chi_preintegration.h>

/* The compiler must not know that the indices come from a vector: it would take them out of it one
 * by one instead of loading them, which costs a tenth of a segment. */
CHI_INLINE void segment_keep_in_memory(int32_t at[CHI_LANES])
{
  __asm__("" : "+m"(*(int32_t(*)[CHI_LANES])at));
}

/* Entries at and after x, and x's distance from the first. */
CHI_INLINE vf segment_load(const float (*table)[4], vf x, vf here[4], vf next[4])
{
  const vi i = vf_int(x);
  int32_t at[CHI_LANES];
  vi_store(at, i);
  segment_keep_in_memory(at);
  vf_load_pairs(table, at, here, next);
  return x - vi_float(i);
}

/* e^x for -1/4 <= x <= 0, by its series: 2e-6 of it. */
CHI_INLINE vf segment_exp_thin(vf x)
{
  vf p = x * (1.0f / 120) + 1.0f / 24;
  p = p * x + 1.0f / 6;
  p = p * x + 0.5f;
  p = p * x + 1.0f;
  return p * x + 1.0f;
}

/* What of the light of u in 0 ... 1 of a segment reaches its front, Eq. 4; half_rise is half of
 * what the extinction gains from front to back. */
CHI_INLINE vf segment_reach(vf front, vf half_rise, vf u)
{
  return vf_exp_neg((front + half_rise * u) * -u);
}

/* Its integral from 0 to 1 by the Gauss rule of 2 points, of 3, and of 7 as far as the light
 * reaches: the error is 4.4e-5 at most up to optical depths of 1/4, 3.5e-5 up to 3/2, and 4e-5. */
CHI_INLINE vf segment_psi_thin(vf front, vf half_rise)
{
  const float u = 0.21132487f, v = 0.78867513f;
  return (segment_exp_thin((front + half_rise * u) * -u) +
           segment_exp_thin((front + half_rise * v) * -v)) *
    0.5f;
}

CHI_INLINE vf segment_psi_medium(vf front, vf half_rise)
{
  const vf outer = segment_reach(front, half_rise, vf_set(0.11270167f)) +
    segment_reach(front, half_rise, vf_set(0.88729833f));
  return segment_reach(front, half_rise, vf_set(0.5f)) * (4.0f / 9) + outer * (5.0f / 18);
}

CHI_INLINE vf segment_psi_thick(vf front, vf half_rise)
{
  static const float node[7] = { 0.02544604f, 0.12923441f, 0.29707742f, 0.5f, 0.70292258f,
    0.87076559f, 0.97455396f };
  static const float weight[7] = { 0.06474248f, 0.13985270f, 0.19091503f, 0.20897959f, 0.19091503f,
    0.13985270f, 0.06474248f };
  const float dark = 9.5f; /* e^-9.5 is left: as much as the rule loses by a longer way */
  const vf root = vf_sqrt(vf_max(front * front + half_rise * (4 * dark), vf_set(0)));
  const vf end = vf_select(front + half_rise > dark, 2 * dark / (front + root), vf_set(1));
  vf sum = vf_set(0);
  for (int k = 0; k < 7; ++k)
  {
    sum += segment_reach(front, half_rise, end * node[k]) * weight[k];
  }
  return sum * end;
}

/* Moreland & Angel's psi, Eq. 4, of the optical depths that the extinction of the front and of the
 * back would have along the whole segment. A lane's result does not depend on its neighbours. */
CHI_INLINE vf segment_psi(vf front, vf back)
{
  const vf half_rise = (back - front) * 0.5f;
  const vf most = vf_max(front, back);
  const vi medium = most > 0.25f, thick = most > 1.5f;
  if (!vi_any(medium))
  {
    return segment_psi_thin(front, half_rise);
  }
  vf psi = vf_set(0);
  if (vi_any(~medium))
  {
    psi = segment_psi_thin(front, half_rise);
  }
  if (vi_any(medium & ~thick))
  {
    psi = vf_select(medium, segment_psi_medium(front, half_rise), psi);
  }
  if (vi_any(thick))
  {
    psi = vf_select(thick, segment_psi_thick(front, half_rise), psi);
  }
  return psi;
}

CHI_INLINE void segment_none(const chi_segment_tables* t, vf x0, vf x1, vf length, vf out[4])
{
  vf here[4], next[4];
  const vf f = segment_load(t->color, (x0 + x1) * 0.5f, here, next);
  for (int c = 0; c < 4; ++c)
  {
    here[c] += f * (next[c] - here[c]);
  }
  out[3] = vf_exp_neg(here[3] * -length);
  for (int c = 0; c < 3; ++c)
  {
    out[c] = here[c] * (1.0f - out[3]);
  }
}

CHI_INLINE void segment_partial(const chi_segment_tables* t, vf x0, vf x1, vf length, vf out[4])
{
  vf front[4], back[4], next[4];
  const vf f = segment_load(t->color, x0, front, next);
  for (int c = 0; c < 4; ++c)
  {
    front[c] += f * (next[c] - front[c]);
  }
  const vf g = segment_load(t->color, x1, back, next);
  for (int c = 0; c < 4; ++c)
  {
    back[c] += g * (next[c] - back[c]);
  }
  const vf tau_front = front[3] * length, tau_back = back[3] * length;
  const vf psi = segment_psi(tau_front, tau_back);
  out[3] = vf_exp_neg((tau_front + tau_back) * -0.5f);
  for (int c = 0; c < 3; ++c) /* Eq. 5 */
  {
    out[c] = front[c] * (1.0f - psi) + back[c] * (psi - out[3]);
  }
}

/* Integral over an entry's part from a to b; its extinction goes from e0 to e1. */
CHI_INLINE vf segment_part(vf e0, vf e1, vf a, vf b)
{
  return (b - a) * (e0 + (a + b) * 0.5f * (e1 - e0));
}

/* Mean extinction of the segment, Eq. 2, and the places of both ends on the axes of the full table.
 * Every term is positive, so that the sum loses nothing where the ends are close. */
CHI_INLINE vf segment_mean_extinction(const chi_segment_tables* t, vf x0, vf x1, vf place[2])
{
  const vf low = vf_min(x0, x1), high = vf_max(x0, x1);
  vf a[4], a_next[4], b[4], b_next[4];
  const vf f = segment_load(t->depth, low, a, a_next);
  const vf g = segment_load(t->depth, high, b, b_next);
  const vi apart = vf_int(low) < vf_int(high);
  const vf first = segment_part(a[0], a_next[0], f, vf_select(apart, vf_set(1), g));
  const vf rest =
    (b[1] - a_next[1]) + (b[2] - a_next[2]) + segment_part(b[0], b_next[0], vf_set(0), g);
  const vf sum = first + vf_select(apart, rest, vf_set(0));
  const vf place_low = a[3] + f * (a_next[3] - a[3]), place_high = b[3] + g * (b_next[3] - b[3]);
  const vi rising = x0 < x1;
  place[0] = vf_select(rising, place_low, place_high);
  place[1] = vf_select(rising, place_high, place_low);
  const vf away = high - low;
  return vf_select(away > 0.0f, sum / away, a[0] + f * (a_next[0] - a[0]));
}

/* The cell that holds the place, which becomes that within the cell. */
CHI_INLINE vi segment_cell(vf* place, int32_t size)
{
  const vi i = vi_min(vf_int(*place), vi_set(size - 2));
  *place -= vi_float(i);
  return i;
}

CHI_INLINE void segment_full(const chi_segment_tables* t, vf x0, vf x1, vf length, vf out[4])
{
  vf p[3];
  const vf tau = segment_mean_extinction(t, x0, x1, p) * length;
  p[2] = tau / (1.0f + tau) * (float)(t->full_size[2] - 1);
  const int32_t row = t->full_size[0], slice = row * t->full_size[1];
  const vi x = segment_cell(p, row), y = segment_cell(p + 1, t->full_size[1]);
  const vi z = segment_cell(p + 2, t->full_size[2]);
  int32_t at[CHI_LANES];
  vi_store(at, x + row * y + slice * z);
  segment_keep_in_memory(at);
  vf sum[4][4], next[4];
  for (int k = 0; k < 4; ++k)
  {
    vf_load_pairs(t->full + (k & 1) * row + (k >> 1) * slice, at, sum[k], next);
    for (int c = 0; c < 3; ++c)
    {
      sum[k][c] += p[0] * (next[c] - sum[k][c]);
    }
  }
  out[3] = vf_exp_neg(-tau);
  for (int c = 0; c < 3; ++c)
  {
    const vf thin = sum[0][c] + p[1] * (sum[1][c] - sum[0][c]);
    const vf thick = sum[2][c] + p[1] * (sum[3][c] - sum[2][c]);
    out[c] = (thin + p[2] * (thick - thin)) * (1.0f - out[3]);
  }
}

#endif
