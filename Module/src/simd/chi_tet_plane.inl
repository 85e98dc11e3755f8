/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Fragments under a transfer function of two quantities. */

/* Colour and extinction at a place of the table, bilinear. */
CHI_INLINE void plane_at(const chi_tet_scene* s, vf x, vf y, vf out[4])
{
  const int32_t width = (int32_t)s->tables->count + 1;
  const vi i = vf_int(x), j = vi_min(vf_int(y), vi_set(s->plane_rows - 2));
  const vf u = x - vi_float(i), v = y - vi_float(j);
  int32_t at[CHI_LANES];
  vi_store(at, i + j * width);
  segment_keep_in_memory(at);
  vf low[4], low_next[4], high[4], high_next[4];
  vf_load_pairs(s->plane, at, low, low_next);
  vf_load_pairs(s->plane + width, at, high, high_next);
  for (int c = 0; c < 4; ++c)
  {
    const vf below = low[c] + u * (low_next[c] - low[c]);
    const vf above = high[c] + u * (high_next[c] - high[c]);
    out[c] = below + v * (above - below);
  }
}

/*
 * Premultiplied colour and transmittance of a segment from (x0, y0) to (x1, y1): of full
 * pre-integration in parts along both axes at once, of which each is integrated as partially; of
 * partial one of them is all; of none the middle's values are all.
 */
CHI_INLINE void segment_plane(
  const chi_tet_scene* s, vf x0, vf x1, vf y0, vf y1, vf length, const int method, vf out[4])
{
  vf front[4], back[4];
  if (method == CHI_PREINTEGRATION_NONE)
  {
    plane_at(s, (x0 + x1) * 0.5f, (y0 + y1) * 0.5f, front);
    out[3] = vf_exp_neg(-front[3] * length);
    for (int c = 0; c < 3; ++c)
    {
      out[c] = front[c] * (1.0f - out[3]);
    }
    return;
  }
  const vf dx = x1 - x0, dy = y1 - y0;
  vf parts = vf_set(1);
  if (method == CHI_PREINTEGRATION_FULL)
  {
    const vf crossed = vf_max(vf_max(dx, -dx), vf_max(dy, -dy)) * (1.0f / CHI_TET_PLANE_STEP);
    parts = vf_min(vi_float(vf_int(crossed)) + 1.0f, vf_set(CHI_TET_PLANE_PARTS));
  }
  const vf share = 1.0f / parts;
  out[0] = out[1] = out[2] = vf_set(0);
  out[3] = vf_set(1);
  plane_at(s, x0, y0, front);
  for (int k = 0; vi_any(parts > (float)k); ++k)
  {
    const vf u = vf_min(share * (float)(k + 1), vf_set(1));
    plane_at(s, x0 + u * dx, y0 + u * dy, back);
    const vf way = vf_select(parts > (float)k, share * length, vf_set(0));
    const vf tau0 = front[3] * way, tau1 = back[3] * way;
    const vf psi = segment_psi(tau0, tau1), through = vf_exp_neg((tau0 + tau1) * -0.5f);
    for (int c = 0; c < 3; ++c)
    {
      out[c] += out[3] * (front[c] * (1.0f - psi) + back[c] * (psi - through));
    }
    out[3] *= through;
    memcpy(front, back, sizeof front);
  }
}

/* Both places at the end that has the largest scalar. */
CHI_INLINE void keep_maximum_plane(tile_state* t)
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
      p[1] = end ? f->y1[i] : f->y0[i];
    }
  }
}
