/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What tetrahedra are within a slab of depths: lit fragments, and the slab as a layer. */

/* How much of their colour the light leaves of fragments i ... i + CHI_LANES - 1: linear in depth
 * on both sides of the knot, taken at the fragment's middle. */
CHI_INLINE void find_light(const tile_state* t, size_t i, float out[CHI_LANES])
{
  const chi_tet_scene* const s = t->scene;
  const fragments* const f = &t->f;
  vf light[3];
  for (int k = 0; k < 3; ++k)
  {
    float at[CHI_LANES];
    for (size_t j = 0; j < CHI_LANES; ++j)
    {
      const size_t pixel = (size_t)f->pixel[i + j];
      at[j] = t->target->light[k][(pixel >> CHI_TET_TILE_SHIFT) * t->target->light_stride +
        (pixel & (CHI_TET_TILE - 1))];
    }
    light[k] = vf_load(at);
  }
  const vf part = (vf_load(f->depth + i) - s->limits[0]) * (1.0f / (s->limits[1] - s->limits[0]));
  const vf from = vf_min(vf_max(part, vf_set(0)), vf_set(1)) - s->knot;
  const vf slope = vf_select(from < 0.0f, light[1] - light[0], light[2] - light[1]);
  vf_store(out, light[1] + from * slope);
}

/* Transmittance of 1e-30 counts as none, and is an optical thickness of 69. */
static int merge(const chi_tet_slab_row* row)
{
  int clear = 0;
  for (int x = 0; x < CHI_TET_TILE; x += CHI_LANES)
  {
    float through[CHI_LANES];
    for (int i = 0; i < CHI_LANES; ++i)
    {
      const float* const from = row->layer + 4 * (x + i);
      through[i] = x + i < row->count ? from[3] : 1.0f;
      if (x + i < row->count)
      {
        float* const to = row->rgba + 4 * (x + i);
        const float before = to[3];
        to[0] += before * from[0];
        to[1] += before * from[1];
        to[2] += before * from[2];
        to[3] = before * from[3];
        clear |= to[3] > row->opaque;
      }
    }
    const vf across = (vf_iota() + (float)x) * row->slope_x + row->slope;
    const vf length = vf_sqrt(across * across + row->square);
    const vf tau = -vf_log(vf_max(vf_load(through), vf_set(1e-30f))) / length;
    vf_store(row->tau + x, vf_max(tau, vf_set(0)));
  }
  return clear;
}
