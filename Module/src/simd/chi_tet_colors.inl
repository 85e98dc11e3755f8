/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fragments whose colours are given at both ends, not looked up. */

/*
 * Premultiplied colour and transmittance of the fragments from i on (theory/preintegration.md, Eq.
 * 9): what is seen of the front's colour and of the back's. By full tables their red is the share
 * of the back; else both follow from psi, of the extinctions at the ends, or, of none, of the
 * middle, where the colour is too.
 */
CHI_INLINE void segment_direct(const tile_state* t, size_t i, const int method, vf out[4])
{
  const chi_segment_tables* const tables = t->scene->tables;
  vf x0 = vf_load(t->f.x0 + i), x1 = vf_load(t->f.x1 + i), front, back;
  const vf length = vf_load(t->f.length + i);
  if (method == CHI_PREINTEGRATION_FULL)
  {
    segment_full(tables, x0, x1, length, out);
    back = out[0];
    front = vf_max(1.0f - out[3] - back, vf_set(0));
  }
  else
  {
    if (method == CHI_PREINTEGRATION_NONE)
    {
      x0 = x1 = (x0 + x1) * 0.5f;
    }
    vf here[4], next[4], tau[2];
    for (int k = 0; k < 2; ++k)
    {
      const vf f = segment_load(tables->color, k ? x1 : x0, here, next);
      tau[k] = (here[3] + f * (next[3] - here[3])) * length;
    }
    const vf psi = segment_psi(tau[0], tau[1]);
    out[3] = vf_exp_neg((tau[0] + tau[1]) * -0.5f);
    front = 1.0f - psi;
    back = psi - out[3];
    if (method == CHI_PREINTEGRATION_NONE)
    {
      front = back = (1.0f - out[3]) * 0.5f;
    }
  }
  for (int c = 0; c < 3; ++c)
  {
    out[c] = vf_load(t->colors[0][c] + i) * front + vf_load(t->colors[1][c] + i) * back;
  }
}

/* The colour at the end that has the largest scalar. */
CHI_INLINE void keep_maximum_color(tile_state* t)
{
  const fragments* const f = &t->f;
  for (size_t i = 0; i < f->count; ++i)
  {
    float* const p = t->target->rgba + 4 * f->pixel[i];
    const int end = f->x1[i] > f->x0[i];
    const float x = end ? f->x1[i] : f->x0[i];
    if (x > p[0])
    {
      p[0] = x;
      for (int c = 0; c < 3; ++c)
      {
        p[1 + c] = t->colors[end][c][i];
      }
    }
  }
}

CHI_INLINE void pad_colors(tile_state* t)
{
  for (int c = 0; c < 3; ++c)
  {
    vf_store(t->colors[0][c] + t->f.count, vf_set(0));
    vf_store(t->colors[1][c] + t->f.count, vf_set(0));
  }
}
