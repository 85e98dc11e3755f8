/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Colours of segments that cross much of the transfer function. Included by
 * chi_occlusion_sample.inl. */

/* Entry of a table position, and its place within it. */
CHI_INLINE vf find_entry(const chi_sample_frame* s, vf t, int32_t at[CHI_LANES])
{
  vi entry = vf_int(t);
  entry -= (entry >= vi_set((int32_t)s->table_end)) & 1;
  vi_store(at, entry);
  return t - vi_float(entry);
}

/* Integral of extinction from scalar 0 to a table position: the fixed-point sum, and what the
 * interval adds. */
CHI_INLINE vf load_depth(const chi_sample_frame* s, vf t, vi* sum, int32_t at[CHI_LANES])
{
  const vf f = find_entry(s, t, at);
  vf parts[4];
  vf_load_entries((const float(*)[4])(const void*)s->sigma, at, parts);
  *sum = (vi)parts[0];
  return f * (parts[1] + f * parts[2]);
}

/* Difference of two such integrals. */
CHI_INLINE vf difference(const chi_sample_frame* s, vi sum1, vf rest1, vi sum0, vf rest0)
{
  return vi_float((vi)((vu)sum1 - (vu)sum0)) * s->quantum + (rest1 - rest0);
}

/* Where a segment is to be cut into parts of about equal weight: shares of its scalar interval. The
 * optical depth is known at CHI_COLOR_STEPS even steps, and taken as linear between. */
CHI_INLINE void place_cuts(
  const chi_sample_frame* s, vf near, vf change, vf tau, vf share[CHI_COLOR_PARTS + 1])
{
  const vf zero = vf_set(0.0f), one = vf_set(1.0f), end = vf_set(s->table_end);
  int32_t at[CHI_LANES];
  vi first = vi_set(0);
  vf rest0 = zero, depth[CHI_COLOR_STEPS + 1];
  for (int k = 0; k <= CHI_COLOR_STEPS; ++k)
  {
    vi sum;
    const vf t = near + change * ((float)k / CHI_COLOR_STEPS);
    const vf rest = load_depth(s, vf_min(vf_max(t, zero), end), &sum, at);
    first = k ? first : sum;
    rest0 = k ? rest0 : rest;
    depth[k] = difference(s, sum, rest, first, rest0); /* falls where the scalar falls */
  }
  const vf all = depth[CHI_COLOR_STEPS];
  const vf known =
    vf_max(tau, vf_set(CHI_COLOR_THIN)); /* below, weight and optical depth are the same */
  const vf alpha = one - vf_exp_neg(-known);
  share[0] = zero;
  share[CHI_COLOR_PARTS] = one;
  for (int j = 1; j < CHI_COLOR_PARTS; ++j)
  {
    const vf wanted = all * (vf_log(one - alpha * ((float)j / CHI_COLOR_PARTS)) / -known);
    vf sum = zero;
    for (int k = 0; k < CHI_COLOR_STEPS; ++k)
    {
      const vf here = depth[k + 1] - depth[k];
      const vi some = (here > zero) | (here < zero);
      const vf part = (wanted - depth[k]) / vf_select(some, here, one);
      /* without extinction there: the whole step, or none of it */
      const vf before = vf_select((wanted - depth[k]) * change > zero, one, zero);
      sum += vf_select(some, vf_min(vf_max(part, zero), one), before);
    }
    share[j] = sum * (1.0f / CHI_COLOR_STEPS);
  }
}

/*
 * Colours of the listed segments, which cross much of the transfer function (theory/occlusion.md,
 * Eq. 1a), into piece->rgb. Each part of a segment has its exact optical thickness and its exact
 * mean colour; within it the colour is linear in the optical thickness, at the slope between its
 * neighbours, and what is behind is attenuated by what is in front.
 */
CHI_INLINE void integrate_colors(
  const chi_sample_frame* s, vf near, vf change, vf thickness, vf out[3])
{
  const vf zero = vf_set(0.0f), one = vf_set(1.0f), table_end = vf_set(s->table_end);
  vf share[CHI_COLOR_PARTS + 1], depth[CHI_COLOR_PARTS], middle[CHI_COLOR_PARTS],
    color[CHI_COLOR_PARTS][3];
  vi any[CHI_COLOR_PARTS];
  vi sum[2][4];
  vf rest[2][4], end = zero;
  for (int k = 0; k <= CHI_COLOR_PARTS; ++k)
  {
    share[k] = vf_set((float)k / CHI_COLOR_PARTS);
  }
  /* Where the middle's colour is but a few times too coarse, even parts are fine enough. */
  const vf span = vf_max(change, -change);
  if (vi_any(span > vf_set(CHI_COLOR_EVEN * s->color_step)))
  {
    place_cuts(s, near, change, thickness, share);
  }
  for (int k = 0; k <= CHI_COLOR_PARTS; ++k)
  {
    vi* const sums = sum[k & 1];
    vf* const rests = rest[k & 1];
    /* both ends lie in the table; between them rounding might step out of it */
    const vf t = vf_min(vf_max(near + change * share[k], zero), table_end);
    int32_t at[CHI_LANES];
    rests[0] = load_depth(s, t, &sums[0], at);
    vi_store(at, vi_load(at) + vi_load(at)); /* a color entry is two of the loads' sixteen bytes */
    vf parts[4], means[4];
    vf_load_entries((const float(*)[4])(const void*)s->colors, at, parts);
    vf_load_entries((const float(*)[4])(const void*)s->colors->rgb, at, means);
    for (int c = 0; c < 3; ++c)
    {
      sums[c + 1] = (vi)parts[c];
      rests[c + 1] = means[c] * rests[0];
    }
    if (k == 0)
    {
      continue;
    }
    const vi* const sums0 = sum[~k & 1];
    const vf* const rests0 = rest[~k & 1];
    const vf part = difference(s, sums[0], rests[0], sums0[0], rests0[0]);
    any[k - 1] = part * change > zero; /* up or down the table, extinction is positive */
    const vf inverse = one / vf_select(any[k - 1], part, one);
    for (int c = 0; c < 3; ++c)
    {
      const vf mean =
        inverse * difference(s, sums[c + 1], rests[c + 1], sums0[c + 1], rests0[c + 1]);
      color[k - 1][c] = vf_min(vf_max(mean, zero), one);
    }
    depth[k - 1] = vf_select(any[k - 1], part / change, zero);
    middle[k - 1] = end + 0.5f * depth[k - 1];
    end += depth[k - 1];
  }
  const vf scale = thickness / vf_max(end, vf_set(1e-30f));
  vf clear = one, total = zero, rgb[3] = { zero, zero, zero };
  for (int k = 0; k < CHI_COLOR_PARTS; ++k)
  {
    const int before = k > 0 ? k - 1 : 0, after = k + 1 < CHI_COLOR_PARTS ? k + 1 : k;
    const vf d = depth[k] * scale;
    const vf e = vf_exp_neg(-d);
    /* 1 - e^-d and d / 2 - 1 + d / (e^d - 1) lose their digits where d is small */
    const vi thin = d < CHI_COLOR_THIN;
    const vf alpha = vf_select(thin, d * (1.0f - 0.5f * d * (1.0f - 0.33333333f * d)), one - e);
    const vf bend =
      vf_select(thin, d * d * (1.0f / 12), d * e / vf_max(one - e, vf_set(0.04f)) - one + 0.5f * d);
    const vf from = vf_select(any[before], middle[before], middle[k]);
    const vf to = vf_select(any[after], middle[after], middle[k]);
    const vf slope = bend / vf_max((to - from) * scale, vf_set(1e-6f));
    const vf weight = clear * alpha;
    for (int c = 0; c < 3; ++c)
    {
      const vf first = vf_select(any[before], color[before][c], color[k][c]);
      const vf last = vf_select(any[after], color[after][c], color[k][c]);
      rgb[c] += weight * vf_min(vf_max(color[k][c] - slope * (last - first), zero), one);
    }
    total += weight;
    clear *= e;
  }
  const vf inverse = one / vf_max(total, vf_set(1e-30f));
  for (int c = 0; c < 3; ++c)
  {
    out[c] = rgb[c] * inverse;
  }
}

/* Out of line: seldom. */
static __attribute__((noinline)) void integrate_listed(
  const chi_sample_frame* s, sample_piece* piece)
{
  for (int first = 0; first < piece->listed; first += CHI_LANES)
  {
    const int count = piece->listed - first < CHI_LANES ? piece->listed - first : CHI_LANES;
    float near[CHI_LANES], change[CHI_LANES], tau[CHI_LANES];
    for (int l = 0; l < CHI_LANES; ++l)
    {
      const int i = piece->list[first + (l < count ? l : 0)];
      near[l] = piece->t[i] - piece->change[i];
      change[l] = piece->change[i];
      tau[l] = piece->tau[i];
    }
    vf out[3];
    integrate_colors(s, vf_load(near), vf_load(change), vf_load(tau), out);
    for (int c = 0; c < 3; ++c)
    {
      float colors[CHI_LANES];
      vf_store(colors, out[c]);
      for (int l = 0; l < count; ++l)
      {
        piece->rgb[c][piece->list[first + l]] = colors[l];
      }
    }
  }
}

/* Put segments on the list whose middle's colour is too coarse; the mask of these. A ray crosses
 * the same values some 16 times at most, with errors of either sign: what is worth less than a
 * quarter of the bound is left. `seen` is the weight without occlusion, so that light changes no
 * rule. */
CHI_INLINE vi list_colors(
  const chi_sample_frame* s, sample_piece* piece, int i, vf tau, vf seen, vf weight)
{
  const vf change = vf_load(piece->change + i), step = vf_set(s->color_step);
  const vf span = vf_max(change, -change);
  const vi need = (span > step) & (span * seen > step * CHI_COLOR_WORTH);
  if (vi_any(need))
  {
    int32_t mask[CHI_LANES];
    vi_store(mask, need);
    vf_store(piece->tau + i, tau);
    vf_store(piece->weight + i, weight);
    int32_t listed = piece->listed;
    for (int l = 0; l < CHI_LANES; ++l)
    {
      piece->list[listed] = i + l;
      listed -= mask[l];
    }
    piece->listed = listed;
  }
  return need;
}

/* Colours as vectors of their own, for the stages of a general run that change them. */
CHI_INLINE void color_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count)
{
  piece->listed = 0;
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const vf depth = vf_load(piece->depth + i);
    const vf slope = row->length0 + (vf_iota() + (float)(x_begin + i)) * row->length_x;
    const vf tau = depth * vf_sqrt(slope * slope + row->length_c);
    vf color[4];
    vf_load_entries(row->frame->rgba, piece->color + i, color);
    for (int c = 0; c < 3; ++c)
    {
      vf_store(piece->rgb[c] + i, color[c]);
    }
    const vf seen = vf_load(row->transmittance + x_begin + i) * tau / (1.0f + tau);
    list_colors(row->frame, piece, i, tau, seen, seen);
  }
  if (piece->listed)
  {
    integrate_listed(row->frame, piece);
  }
}
