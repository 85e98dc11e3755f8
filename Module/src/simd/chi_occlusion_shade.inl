/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Gradients of the samples, and what they do to colour and opacity. Included by
 * chi_occlusion_sample.inl, after its fetch. */

/* Where a sample's cell lies, and how far its neighbours are: at the border they are the border's
 * own samples, as in a texture that is clamped to its edge. */
typedef struct cell_neighbours
{
  vi index;       /* of the cell's first sample */
  vf f[3];        /* position in the cell */
  vi before[3];   /* to the sample before the cell: <= 0 */
  vi after[3];    /* to the sample after the cell */
  vi first, last; /* masks: the cell is the first, the last, along x */
  int32_t step[3];
} cell_neighbours;

CHI_INLINE cell_neighbours find_cell(const chi_sample_frame* s, const vf p[3])
{
  cell_neighbours c;
  c.step[0] = s->step_x;
  c.step[1] = s->step_y;
  c.step[2] = s->step_z;
  c.index = vi_set(0);
  for (int a = 0; a < 3; ++a)
  {
    const vi end = vi_set(s->last_cell[a]);
    vi i = vf_int(p[a]);
    const vi beyond = i > end;
    i = (beyond & end) | (~beyond & i);
    c.f[a] = p[a] - vi_float(i);
    c.index += i * c.step[a];
    const vi lowest = i <= 0, highest = i >= end;
    c.before[a] = ~lowest & -c.step[a];
    c.after[a] = c.step[a] + (~highest & c.step[a]);
    if (a == 0)
    {
      c.first = lowest;
      c.last = highest;
    }
  }
  return c;
}

/* The scalar on a line of samples along x. */
CHI_INLINE vf fetch_line(
  const chi_sample_frame* s, const cell_neighbours* c, vi at, int fetch, vi mask)
{
  vf a, b;
  if (fetch == CHI_FETCH_F32)
  {
    a = (vf)gather_samples(s, at, fetch, mask);
    b = (vf)gather_samples(s, at + s->step_x, fetch, mask);
  }
  else
  {
    split_pair(gather_samples(s, at, fetch, mask), fetch, &a, &b);
  }
  return a + c->f[0] * (b - a);
}

/* The same, and its difference over two samples along x. */
CHI_INLINE vf fetch_line_and_slope(
  const chi_sample_frame* s, const cell_neighbours* c, vi at, int fetch, vi mask, vf* slope)
{
  vf before, a, b, after;
  if (fetch == CHI_FETCH_U8)
  {
    /* four bytes hold all four samples; in the first cell, from the second byte on */
    const vu word = (vu)gather_samples(s, at + c->before[0], fetch, mask);
    const vi all = (vi)(word << ((vu)c->first & 8));
    a = vi_float((vi)((vu)all >> 8) & 255);
    b = vi_float((vi)((vu)all >> 16) & 255);
    before = vf_select(c->first, a, vi_float(all & 255));
    after = vf_select(c->last, b, vi_float((vi)((vu)all >> 24)));
  }
  else if (fetch == CHI_FETCH_F32)
  {
    before = (vf)gather_samples(s, at + c->before[0], fetch, mask);
    a = (vf)gather_samples(s, at, fetch, mask);
    b = (vf)gather_samples(s, at + s->step_x, fetch, mask);
    after = (vf)gather_samples(s, at + c->after[0], fetch, mask);
  }
  else
  {
    vf none;
    split_pair(gather_samples(s, at + c->before[0], fetch, mask), fetch, &before, &none);
    split_pair(gather_samples(s, at, fetch, mask), fetch, &a, &b);
    split_pair(gather_samples(s, at + c->after[0], fetch, mask), fetch, &after, &none);
  }
  *slope = (b - before) + c->f[0] * ((after - a) - (b - before));
  return a + c->f[0] * (b - a);
}

/* Differences of the interpolated scalar over one sample to either side. The eight trilinear values
 * share their samples: 4 x 4 x 4 but its edges, which 12 loads bring of bytes. */
CHI_INLINE void fetch_differences(
  const chi_sample_frame* s, const vf p[3], int fetch, vi mask, vf difference[3])
{
  const cell_neighbours c = find_cell(s, p);
  vf value[2][2], slope[2][2]; /* [z][y] */
  for (int k = 0; k < 4; ++k)
  {
    const vi at = c.index + ((k & 1 ? c.step[1] : 0) + (k & 2 ? c.step[2] : 0));
    value[k >> 1][k & 1] = fetch_line_and_slope(s, &c, at, fetch, mask, &slope[k >> 1][k & 1]);
  }
  vf along[2], low[2], high[2];
  for (int z = 0; z < 2; ++z)
  {
    along[z] = slope[z][0] + c.f[1] * (slope[z][1] - slope[z][0]);
    const vi at = c.index + (z ? c.step[2] : 0);
    low[z] = value[z][1] - fetch_line(s, &c, at + c.before[1], fetch, mask);
    high[z] = fetch_line(s, &c, at + c.after[1], fetch, mask) - value[z][0];
  }
  difference[0] = along[0] + c.f[2] * (along[1] - along[0]);
  for (int z = 0; z < 2; ++z)
  {
    along[z] = low[z] + c.f[1] * (high[z] - low[z]);
  }
  difference[1] = along[0] + c.f[2] * (along[1] - along[0]);
  for (int y = 0; y < 2; ++y)
  {
    const vi at = c.index + (y ? c.step[1] : 0);
    low[y] = value[1][y] - fetch_line(s, &c, at + c.before[2], fetch, mask);
    high[y] = fetch_line(s, &c, at + c.after[2], fetch, mask) - value[0][y];
    along[y] = low[y] + c.f[2] * (high[y] - low[y]);
  }
  difference[2] = along[0] + c.f[1] * (along[1] - along[0]);
}

/* The same of the nearest samples. */
CHI_INLINE void fetch_nearest_differences(
  const chi_sample_frame* s, const vf p[3], int fetch, vi mask, vf difference[3])
{
  for (int a = 0; a < 3; ++a)
  {
    vf q[3] = { p[0], p[1], p[2] };
    const vf last = vf_set(s->last_index[a]);
    q[a] = vf_min(p[a] + 1.0f, last);
    const vf after = fetch_scalar(s, q, fetch, 1, mask);
    q[a] = vf_max(p[a] - 1.0f, vf_set(0.0f));
    difference[a] = after - fetch_scalar(s, q, fetch, 1, mask);
  }
}

CHI_INLINE vf dot3(const vf a[3], const vf b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* x^power for x in 0 ... 1. */
CHI_INLINE vf power_of(vf x, float power)
{
  return vf_exp_neg(vf_log(vf_min(vf_max(x, vf_set(1e-30f)), vf_set(1.0f))) * power);
}

/* Light of a positional light at a point: its direction of travel, and what reaches it. */
CHI_INLINE vf positional_light(const chi_plan_light* l, const vf eye[3], vf travel[3])
{
  vf d2 = vf_set(0.0f);
  for (int c = 0; c < 3; ++c)
  {
    travel[c] = eye[c] - l->position[c];
    d2 += travel[c] * travel[c];
  }
  const vf distance = vf_sqrt(d2);
  const vf inverse = 1.0f / vf_max(distance, vf_set(1e-30f));
  vf cosine = vf_set(0.0f);
  for (int c = 0; c < 3; ++c)
  {
    travel[c] *= inverse;
    cosine += travel[c] * l->direction[c];
  }
  vf reaches =
    1.0f / (l->attenuation[0] + distance * (l->attenuation[1] + distance * l->attenuation[2]));
  if (l->cone_cosine >= 0.0f)
  {
    reaches =
      vf_select(cosine >= l->cone_cosine, reaches * power_of(cosine, l->exponent), vf_set(0.0f));
  }
  return reaches;
}

/* Sums of the lights' diffuse and specular parts; chi_shading.h has the formula. */
CHI_INLINE void light_sample(const chi_plan_shading* h, const vf normal[3], const vf eye[3],
  const vf view[3], vf diffuse[3], vf specular[3])
{
  const vf zero = vf_set(0.0f);
  const vf normal_view = dot3(normal, view);
  for (int k = 0; k < h->light_count; ++k)
  {
    const chi_plan_light* const l = h->light + k;
    vf reaches = vf_set(1.0f), cosine = normal_view, light_view = vf_set(1.0f);
    if (l->kind != CHI_LIGHT_EYE)
    {
      vf travel[3] = { vf_set(l->direction[0]), vf_set(l->direction[1]), vf_set(l->direction[2]) };
      if (l->kind == CHI_LIGHT_POSITIONAL)
      {
        reaches = positional_light(l, eye, travel);
      }
      cosine = dot3(normal, travel);
      light_view = dot3(travel, view);
    }
    const vf facing = h->two_sided ? vf_max(cosine, -cosine) : cosine;
    const vi lit = (facing > 0.0f) & (reaches > 0.0f); /* a NaN is not */
    /* r = 2 (n.l) n - l: one factor turned round, the other not, is not a unit vector */
    const vf factor = l->kind == CHI_LIGHT_EYE ? cosine : facing;
    const vf square = 1.0f + 4.0f * factor * (factor - cosine);
    vf mirrored = (2.0f * factor * normal_view - light_view) / vf_sqrt(vf_max(square, zero));
    if (h->two_sided && l->kind == CHI_LIGHT_POSITIONAL)
    {
      mirrored = vf_max(mirrored, -mirrored);
    }
    const vi shines = lit & (mirrored > 0.0f);
    const vf d = vf_select(lit, facing * reaches, zero);
    for (int c = 0; c < 3; ++c)
    {
      diffuse[c] += d * l->diffuse[c];
    }
    if (h->shiny && vi_any(shines))
    {
      const vf g = vf_select(shines, reaches * power_of(mirrored, h->power), zero);
      for (int c = 0; c < 3; ++c)
      {
        specular[c] += g * l->specular[c];
      }
    }
  }
}

/* Entry of a table of `last` + 1 entries, and the place between it and the next. */
CHI_INLINE vi place_in(vf t, vi last, vf* f)
{
  vi entry = vf_int(t);
  entry -= (entry >= last) & 1;
  *f = t - vi_float(entry);
  return entry;
}

/* Integral of a row's extinction up to a table position, without its fixed-point sum. */
CHI_INLINE vf load_plane(const chi_plan_shading* h, vi row, vf t, vi last, vi* sum, vf* slope)
{
  int32_t at[CHI_LANES];
  vf parts[4], f;
  vi_store(at, row + place_in(t, last, &f));
  vf_load_entries((const float(*)[4])(const void*)h->plane_table, at, parts);
  *sum = (vi)parts[0];
  *slope = parts[1] + 2.0f * f * parts[2];
  return f * (parts[1] + f * parts[2]);
}

/* Mean extinction of a segment on one row: as classify_piece has it on the only one. */
CHI_INLINE vf row_extinction(const chi_plan_shading* h, vi row, vf near, vf change, vi last)
{
  const vi steep = (change > 1.0f) | (change < -1.0f);
  vi sum0, sum1;
  vf local, none;
  load_plane(h, row, near + 0.5f * change, last, &sum0, &local);
  if (!vi_any(steep))
  {
    return local;
  }
  const vf rest0 = load_plane(h, row, near, last, &sum0, &none);
  const vf rest1 = load_plane(h, row, near + change, last, &sum1, &none);
  const vf integral = vi_float((vi)((vu)sum1 - (vu)sum0)) * h->plane_quantum + (rest1 - rest0);
  return vf_select(steep, integral / vf_select(steep, change, vf_set(1.0f)), local);
}

/* A transfer function of two quantities: extinction and colour of segments whose second quantity is
 * y in their middle. Lanes outside the mask stay in the table, whatever they hold. */
CHI_INLINE vf classify_plane(const chi_sample_frame* s, vf t, vf change, vf y, vi mask, vf rgb[3])
{
  const chi_plan_shading* const h = s->shade;
  const vf zero = vf_set(0.0f), end = vf_set(s->table_end);
  const vi last = vi_set((int32_t)s->table_end), last_row = vi_set((int32_t)h->plane_end);
  const vf far = vf_select(mask, t, zero);
  const vf step = vf_select(mask, change, zero);
  const vf near = vf_min(vf_max(far - step, zero), end);
  const vf v = vf_min(vf_max((y - h->plane_base) * h->plane_scale, zero), vf_set(h->plane_end));
  vf f;
  const vi row = place_in(v, last_row, &f) * h->plane_row;
  vf sigma[2];
  int32_t at[2][CHI_LANES];
  const vi nearest = vf_int(near + 0.5f * (far - near) + 0.5f);
  for (int k = 0; k < 2; ++k)
  {
    const vi here = row + (k ? h->plane_row : 0);
    sigma[k] = vf_max(row_extinction(h, here, near, far - near, last), zero);
    vi_store(at[k], here + nearest);
  }
  vf low[4], high[4];
  vf_load_entries(h->plane_rgba, at[0], low);
  vf_load_entries(h->plane_rgba, at[1], high);
  for (int c = 0; c < 3; ++c)
  {
    rgb[c] = low[c] + f * (high[c] - low[c]);
  }
  return sigma[0] + f * (sigma[1] - sigma[0]);
}

/*
 * Gradients in the middle of every segment that adds to the picture: its share of the opacity, or
 * what a transfer function of two quantities makes of it, and its colour under the lights,
 * visibility included.
 */
CHI_INLINE void shade_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count,
  const int fetch, const int nearest)
{
  const chi_sample_frame* const s = row->frame;
  const chi_plan_shading* const h = s->shade;
  const vf zero = vf_set(0.0f);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf depth = vf_load(piece->depth + i);
    vi want = depth > 0.0f;
    const vi seen = want & (vf_load(row->transmittance + x) > s->saturated);
    if (!h->gradient_opacity && !h->plane_table)
    {
      want = seen; /* the light needs no colours */
    }
    if (!vi_any(want))
    {
      continue;
    }
    const vf xs = vf_iota() + (float)x;
    vf back = vf_set(-0.5f);
    if (row->cut) /* nearest samples lie in the middle already */
    {
      back = vf_load(piece->back + i) - (nearest ? 0.0f : 0.5f) * vf_load(piece->fraction + i);
    }
    else if (row->enter)
    {
      const vf far = vf_set(row->near_slice + 1.0f);
      const vf stop = vf_min(far, vf_load(row->leave + x));
      back = stop - far - 0.5f * vf_load(piece->fraction + i);
    }
    vf p[3], difference[3], gradient[3], eye[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = row->position[a] + xs * row->position_x[a] +
        back * (row->direction[a] + xs * row->direction_x[a]);
    }
    for (int c = 0; c < 3; ++c)
    {
      const float* const m = h->to_eye[c];
      eye[c] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
    }
    for (int a = 0; a < 3; ++a)
    {
      p[a] = vf_min(vf_max(p[a], zero), vf_set(s->last_index[a]));
    }
    for (int a = 0; a < 3; ++a)
    {
      difference[a] = zero;
    }
    if (s->second && !h->lit)
    {
      /* nobody asks for the gradient */
    }
    else if (nearest)
    {
      fetch_nearest_differences(s, p, fetch, want, difference);
    }
    else
    {
      fetch_differences(s, p, fetch, want, difference);
    }
    for (int a = 0; a < 3; ++a)
    {
      /* beside a sample that is not finite there is no gradient */
      difference[a] = vf_select(difference[a] - difference[a] == 0.0f, difference[a], zero);
    }
    for (int c = 0; c < 3; ++c)
    {
      const float* const m = h->gradient[c];
      gradient[c] = m[0] * difference[0] + m[1] * difference[1] + m[2] * difference[2];
    }
    const vf magnitude = vf_sqrt(dot3(gradient, gradient));
    if (h->plane_table)
    {
      vf rgb[3];
      vf y = magnitude;
      if (s->second)
      {
        y = fetch_scalar(s->second, p, CHI_FETCH_F32, nearest, want);
        want &= y - y == 0.0f;
      }
      const vf t = vf_load(piece->t + i), t0 = vf_load(piece->before + i);
      const vf sigma = classify_plane(s, t, t - t0, y, want, rgb);
      const vf fraction = row->enter ? vf_load(piece->fraction + i) : vf_set(1.0f);
      vf_store(piece->depth + i, vf_select(want, sigma * (fraction * s->slice), zero));
      for (int c = 0; c < 3; ++c)
      {
        vf_store(piece->rgb[c] + i, rgb[c]);
      }
    }
    if (h->gradient_opacity)
    {
      const vf t = vf_min(vf_max(magnitude * h->gradient_scale, zero), vf_set(h->gradient_end));
      const vi last = vi_set((int32_t)h->gradient_end);
      vi entry = vf_int(t);
      entry -= (entry >= last) & 1;
      const vf low = vf_gather(h->gradient_opacity, entry, 4, want);
      const vf high = vf_gather(h->gradient_opacity, entry + 1, 4, want);
      const vf share = low + (t - vi_float(entry)) * (high - low);
      vf_store(piece->depth + i, vf_select(want, depth * share, depth));
    }
    if (h->lit)
    {
      const vf inverse =
        vf_select(magnitude > 0.0f, 1.0f / vf_max(magnitude, vf_set(1e-37f)), zero);
      const vf far = 1.0f / vf_sqrt(vf_max(dot3(eye, eye), vf_set(1e-37f)));
      vf normal[3], view[3], diffuse[3], specular[3];
      for (int c = 0; c < 3; ++c)
      {
        normal[c] = gradient[c] * inverse;
        view[c] = eye[c] * far;
        diffuse[c] = vf_set(h->ambient);
        specular[c] = zero;
      }
      light_sample(h, normal, eye, view, diffuse, specular);
      for (int c = 0; c < 3; ++c)
      {
        const float* const light = s->tinted ? row->tint[c] : row->visibility;
        const vf visibility = light ? vf_load(light + x) : vf_set(1.0f);
        const vf albedo = vf_load(piece->rgb[c] + i);
        const vf matt = visibility * (albedo * diffuse[c] + h->ambient_light[c]);
        vf_store(piece->rgb[c] + i, vf_min(matt + specular[c], vf_set(h->limit)));
      }
    }
  }
}
