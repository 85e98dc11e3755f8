/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Samples of several components: one colour and one extinction of all. Included by
 * chi_occlusion_sample.inl, after its colours. */

/* Table position of a component's samples; NaN where they are not finite. */
CHI_INLINE vf fetch_position(
  const chi_sample_frame* s, const vf p[3], const int fetch, const int nearest, vi want)
{
  vf q[3];
  for (int a = 0; a < 3; ++a)
  {
    q[a] = vf_min(vf_max(p[a], vf_set(0.0f)), vf_set(s->last_index[a]));
  }
  const vf scalar = fetch_scalar(s, q, fetch, nearest, want);
  const vf t = (scalar - s->base) * s->scale + s->offset;
  return vf_select(
    scalar - scalar == 0.0f, vf_min(vf_max(t, vf_set(0.0f)), vf_set(s->table_end)), vf_set(NAN));
}

/* Mean extinction between two table positions, as classify_piece has it. */
CHI_INLINE vf mean_extinction(const chi_sample_frame* s, vf near, vf far)
{
  int32_t at[CHI_LANES];
  vi sum0;
  const vf rest0 = load_depth(s, near, &sum0, at);
  const vf f = find_entry(s, far, at);
  vf parts[4];
  vf_load_entries((const float(*)[4])(const void*)s->sigma, at, parts);
  const vf change = far - near;
  const vi steep = (change > 1.0f) | (change < -1.0f);
  const vf rest = f * (parts[1] + f * parts[2]);
  const vf integral = difference(s, (vi)parts[0], rest, sum0, rest0);
  const vf local = parts[1] + (2.0f * f - change) * parts[2];
  return vf_max(
    vf_select(steep, integral / vf_select(steep, change, vf_set(1.0f)), local), vf_set(0.0f));
}

/*
 * Independent components blend as vtkGPUVolumeRayCastMapper's do (VTK 9.2,
 * vtkVolumeShaderComposer.h) in the limit of short steps: with extinctions sigma_c, colours and
 * weights, extinction sum sigma_c^2 / sum w_c sigma_c, emission sum w_c sigma_c colour_c. Dependent
 * ones take colours from the components before the last. The last one, or the first of independent
 * ones, is the row's own: its extinction stands in `depth`, its colour in `rgb`.
 */
CHI_INLINE void components_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count,
  const int fetch, const int nearest)
{
  const chi_sample_frame* const s = row->frame;
  const chi_plan_components* const all = &s->components->plan;
  const vf zero = vf_set(0.0f);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    /* the row's own component was sampled at both ends, or the ray begins here */
    const vf far_own = vf_load(piece->t + i);
    const vi entering =
      row->enter || row->cut ? vi_load(piece->entering + i) : vi_set(row->first ? -1 : 0);
    vi want = (far_own == far_own) & (vi_load(piece->known + i) | entering);
    const vf own = vf_load(piece->depth + i);
    if (all->dependent)
    {
      want &= own > zero;
    }
    if (!vi_any(want))
    {
      vf_store(piece->depth + i, zero);
      continue;
    }
    const vf xs = vf_iota() + (float)x;
    vf fraction = vf_set(1.0f), end = zero; /* slices from the far one */
    if (row->cut)
    {
      fraction = vf_load(piece->fraction + i);
      end = vf_load(piece->back + i);
    }
    else if (row->enter)
    {
      fraction = vf_load(piece->fraction + i);
      end = vf_min(zero, vf_load(row->leave + x) - vf_set(row->near_slice + 1.0f));
    }
    if (nearest && !row->cut)
    {
      end -= 0.5f * fraction; /* where the row's own sample lies */
    }
    vf far[3], near[3], middle[3];
    for (int a = 0; a < 3; ++a)
    {
      const vf step = row->direction[a] + xs * row->direction_x[a];
      far[a] = row->position[a] + xs * row->position_x[a] + end * step;
      near[a] = far[a] - fraction * step;
      middle[a] = far[a] - 0.5f * fraction * step;
    }
    if (all->dependent)
    {
      /* colours of the middle, where samples that are steps lie already */
      vf value[3] = { zero, zero, zero };
      for (int c = 0; c < all->count; ++c)
      {
        const vf t =
          fetch_position(s->components->more + c, nearest ? far : middle, fetch, nearest, want);
        want &= t == t;
        value[c] = vf_select(want, t, zero);
      }
      if (all->count == 1)
      {
        int32_t at[CHI_LANES];
        vf color[4];
        vi_store(at, vf_int(value[0] + 0.5f));
        vf_load_entries(s->components->more->rgba, at, color);
        for (int c = 0; c < 3; ++c)
        {
          value[c] = color[c];
        }
      }
      for (int c = 0; c < 3; ++c)
      {
        vf_store(piece->rgb[c] + i, value[c]);
      }
      vf_store(piece->depth + i, vf_select(want, own, zero));
      continue;
    }
    const vf length = fraction * s->slice;
    vf squares = zero, weighted = zero, rgb[3] = { zero, zero, zero };
    if (all->weight[0] > 0)
    {
      squares = own * own;
      weighted = all->weight[0] * own;
      for (int c = 0; c < 3; ++c)
      {
        rgb[c] = weighted * vf_load(piece->rgb[c] + i);
      }
    }
    for (int k = 0; k < all->count; ++k)
    {
      const chi_sample_frame* const more = s->components->more + k;
      if (!(all->weight[k + 1] > 0))
      {
        continue;
      }
      vf t = fetch_position(more, far, fetch, nearest, want), t0 = t;
      if (!nearest)
      {
        t0 = fetch_position(more, near, fetch, nearest, want);
      }
      want &= (t == t) & (t0 == t0);
      t = vf_select(want, t, zero);
      t0 = vf_select(want, t0, zero);
      const vf depth = mean_extinction(more, t0, t) * length;
      const vf share = all->weight[k + 1] * depth;
      int32_t at[CHI_LANES];
      vf color[4];
      vi_store(at, vf_int(0.5f * (t0 + t) + 0.5f));
      vf_load_entries(more->rgba, at, color);
      for (int c = 0; c < 3; ++c)
      {
        rgb[c] += share * color[c];
      }
      squares += depth * depth;
      weighted += share;
    }
    const vi some = want & (squares > zero) & (weighted > zero);
    const vf depth = vf_select(some, squares / vf_select(some, weighted, vf_set(1.0f)), zero);
    vf_store(piece->depth + i, depth);
    const vf inverse = vf_select(some, 1.0f / vf_max(depth, vf_set(1e-37f)), zero);
    for (int c = 0; c < 3; ++c)
    {
      vf_store(piece->rgb[c] + i, rgb[c] * inverse);
    }
  }
}
