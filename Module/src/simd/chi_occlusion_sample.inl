/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Samples of a row: fetch, classify, composite. Included by chi_occlusion_kernels.inl. */

/* Low and high half of the pair of samples that one four-byte load brings. */
CHI_INLINE void split_pair(vi word, int fetch, vf* a, vf* b)
{
  if (fetch == CHI_FETCH_U8)
  {
    *a = vi_float(word & 255);
    *b = vi_float((vi)((vu)word >> 8) & 255);
  }
  else if (fetch == CHI_FETCH_U16)
  {
    *a = vi_float(word & 65535);
    *b = vi_float((vi)((vu)word >> 16));
  }
  else
  {
    *a = vi_float((word << 16) >> 16);
    *b = vi_float(word >> 16);
  }
}

/* Four bytes that begin with a sample. At the last samples they would leave the array: there,
 * `guarded`, load earlier and shift. */
CHI_INLINE vi gather_words(
  const chi_sample_frame* s, vi index, const int fetch, const int guarded, vi mask)
{
  if (fetch == CHI_FETCH_F32)
  {
    return vi_gather(s->scalars, index, 4, mask);
  }
  const int scale = fetch == CHI_FETCH_U8 ? 1 : 2;
  const vi at = guarded ? vi_min(index, vi_set(s->last_load)) : index;
  const vi word =
    fetch == CHI_FETCH_U8 ? vi_gather(s->scalars, at, 1, mask) : vi_gather(s->scalars, at, 2, mask);
  return guarded ? (vi)((vu)word >> (vu)((index - at) * (8 * scale))) : word;
}

CHI_INLINE vi gather_samples(const chi_sample_frame* s, vi index, const int fetch, vi mask)
{
  return gather_words(s, index, fetch, 1, mask);
}

/* Scalars at the place f along x of four lines of cells. */
CHI_INLINE void fetch_lines(const chi_sample_frame* s, vi index, vf f, const int fetch,
  const int guarded, vi mask, vf line[4])
{
  for (int c = 0; c < 4; ++c)
  {
    const vi at = index + ((c & 1 ? s->step_y : 0) + (c & 2 ? s->step_z : 0));
    vf a, b;
    if (fetch == CHI_FETCH_F32)
    {
      a = (vf)gather_words(s, at, fetch, guarded, mask);
      b = (vf)gather_words(s, at + s->step_x, fetch, guarded, mask);
    }
    else
    {
      split_pair(gather_words(s, at, fetch, guarded, mask), fetch, &a, &b);
    }
    line[c] = a + f * (b - a);
  }
}

/* Trilinear (or nearest) scalar at an index position that lies inside the grid. */
CHI_INLINE vf fetch_scalar(
  const chi_sample_frame* s, const vf p[3], int fetch, int nearest, vi mask)
{
  if (nearest)
  {
    vi i[3];
    for (int a = 0; a < 3; ++a)
    {
      i[a] = vf_int(p[a] + 0.5f);
    }
    const vi index = i[0] * s->step_x + i[1] * s->step_y + i[2] * s->step_z;
    const vi word = gather_samples(s, index, fetch, mask);
    vf a, b;
    if (fetch == CHI_FETCH_F32)
    {
      return (vf)word;
    }
    split_pair(word, fetch, &a, &b);
    return a;
  }
  vi i[3];
  vf f[3];
  for (int a = 0; a < 3; ++a)
  {
    i[a] = vi_min(vf_int(p[a]), vi_set(s->last_cell[a]));
    f[a] = p[a] - vi_float(i[a]);
  }
  const vi index = i[0] * s->step_x + i[1] * s->step_y + i[2] * s->step_z;
  vf line[4];
  if (fetch != CHI_FETCH_F32 && vi_any(index > vi_set(s->last_load - s->step_y - s->step_z)))
  {
    fetch_lines(s, index, f[0], fetch, 1, mask, line);
  }
  else
  {
    fetch_lines(s, index, f[0], fetch, 0, mask, line);
  }
  const vf low = line[0] + f[1] * (line[1] - line[0]);
  const vf high = line[2] + f[1] * (line[3] - line[2]);
  return low + f[2] * (high - low);
}

/* A piece of a row on its way through the stages below. Each stage is a loop of its own: one loop
 * for all would be a chain of some 300 cycles an iteration, longer than the processor looks ahead.
 */
enum
{
  PIECE = 128
};

typedef struct sample_piece
{
  float t[PIECE]; /* table position at the far slice; NaN: no sample */
  int32_t entry[PIECE];
  float before[PIECE];   /* with gradients: table position at the near end */
  int32_t want[PIECE];   /* with cuts: something of the segment is left */
  float back[PIECE];     /* with cuts: where its sample lies, slices from the far one, <= 0 */
  float fraction[PIECE]; /* of the segment that lies in the box, less what is cut */
  int32_t entering[PIECE];
  float depth[PIECE]; /* optical thickness along the view axis */
  int32_t color[PIECE];
  int32_t known[PIECE]; /* of several components: the near slice was sampled too */
  float change[PIECE];  /* of the table position over the segment */
  float rgb[3][PIECE];  /* colours: all of a general run, else those that are integrated */
  /* Segments whose colour is to be integrated: few, and rarely neighbours. */
  int32_t listed;
  int32_t list[PIECE + CHI_LANES];
  float tau[PIECE];    /* along the ray */
  float weight[PIECE]; /* with which the colour counts */
} sample_piece;

#include "chi_occlusion_cut.inl"

/* Samples that are left after a test that spares some. */
CHI_INLINE int count_spared(chi_sample_row* row, const int why, int before, const vi want)
{
  const int left = vi_count(want);
  row->spared[why] += before - left;
  return left;
}

/* First entry of the tables of voxels about points. Where the label has changed since the near
 * slice, what was sampled there is of another table, and the ray begins anew. */
CHI_INLINE vi choose_table(
  chi_sample_row* row, sample_piece* piece, const vf p[3], int x, int i, vi want)
{
  const chi_sample_frame* const s = row->frame;
  vi at = vi_set(0);
  const int32_t step[3] = { s->step_x, s->step_y, s->step_z };
  for (int a = 0; a < 3; ++a)
  {
    at += vf_int(p[a] + 0.5f) * step[a];
  }
  const vi first = (vi_gather(s->labels, at, 1, want) & 255) * s->table_entries;
  const vf before = vf_load(row->table_position + x), low = vi_float(first);
  const vi other = ((before < low) | (before > low + s->value_end)) & vi_set(row->restart ? 0 : -1);
  vf_store(row->table_position + x, vf_select(other, vf_set(NAN), before));
  const vi entering = row->enter ? vi_load(piece->entering + i) : vi_set(row->first ? -1 : 0);
  vi_store(piece->entering + i, entering | other);
  return first;
}

/* Where the samples lie, which of them anybody needs, and their places in the tables. */
CHI_INLINE void fetch_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count,
  const int fetch, const int nearest)
{
  const chi_sample_frame* const s = row->frame;
  const vf nan = vf_set(NAN);
  const vf end = vf_set(s->value_end);
  const vi last_entry = vi_set((int32_t)s->value_end);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf xs = vf_iota() + (float)x;
    vi want = vi_set(-1);
    vf p[3];
    for (int a = 0; a < 3; ++a)
    {
      p[a] = row->position[a] + xs * row->position_x[a];
    }
    if (row->cut)
    {
      want = vi_load(piece->want + i);
      const vf back = vf_load(piece->back + i);
      for (int a = 0; a < 3; ++a)
      {
        p[a] += back * (row->direction[a] + xs * row->direction_x[a]);
      }
      /* What was sampled before does not count where the ray comes out of what is cut away. */
      const vi entering = vi_load(piece->entering + i);
      vf_store(row->table_position + x, vf_select(entering, nan, vf_load(row->table_position + x)));
    }
    else if (row->enter)
    {
      /* The ray meets the box inside this segment: sample where it does, and count only the part.
       */
      const vf enter = vf_load(row->enter + x), leave = vf_load(row->leave + x);
      const vf near = vf_set(row->near_slice), far = near + 1.0f;
      want = (enter < far) & (leave > near);
      const vf stop = vf_min(far, leave), start = vf_max(near, enter);
      vf_store(piece->fraction + i, vf_max(stop - start, vf_set(0.0f)));
      vi_store(piece->entering + i, (enter >= near) | vi_set(row->first ? -1 : 0));
      const vf back = (nearest ? 0.5f * (start + stop) : stop) - far;
      for (int a = 0; a < 3; ++a)
      {
        p[a] += back * (row->direction[a] + xs * row->direction_x[a]);
      }
    }
    else if (nearest)
    {
      /* Samples that are steps count for the segment about them; at its end they might lie on a
       * face, where rounding chooses. */
      for (int a = 0; a < 3; ++a)
      {
        p[a] -= 0.5f * (row->direction[a] + xs * row->direction_x[a]);
      }
    }
    for (int a = 0; a < 3; ++a)
    {
      p[a] = vf_min(vf_max(p[a], vf_set(0.0f)), vf_set(s->last_index[a]));
    }
    int taken = row->enter || row->cut ? vi_count(want) : CHI_LANES;
    if (row->surface && !row->hidden_too)
    {
      want &= vf_load(row->surface + x) > row->near_slice;
      taken = count_spared(row, CHI_SPARED_HIDDEN, taken, want);
    }
    if (!row->saturated_too)
    {
      want &= vf_load(row->transmittance + x) > s->saturated;
      taken = count_spared(row, CHI_SPARED_SATURATED, taken, want);
    }
    if (row->bricks)
    {
      const vi brick = (vf_int(p[0]) >> 3) + (vf_int(p[1]) >> 3) * s->brick_step_y +
        (vf_int(p[2]) >> 3) * s->brick_step_z;
      want &= (vi_gather(s->occupied, brick, 1, want) & 255) != 0;
      taken = count_spared(row, CHI_SPARED_EMPTY, taken, want);
    }
    row->taken += taken;
    if (taken == 0)
    {
      vf_store(piece->t + i, nan);
      vi_store(piece->entry + i, vi_set(0));
      continue;
    }
    const vf scalar = fetch_scalar(s, p, fetch, nearest, want);
    /* x - x is 0 for every finite x: NaN and infinite samples are transparent. */
    const vi finite = fetch == CHI_FETCH_F32 ? (scalar - scalar == 0.0f) & want : want;
    vf t = (scalar - s->base) * s->scale + s->offset;
    t = vf_min(vf_max(t, vf_set(0.0f)), end);
    vi entry = vi_min(vf_int(t), last_entry - 1); /* the last entry has no interval after it */
    if (s->labels)
    {
      const vi first = choose_table(row, piece, p, x, i, want);
      entry += first;
      t += vi_float(first);
    }
    vf_store(piece->t + i, vf_select(finite, t, nan));
    vi_store(piece->entry + i, entry & finite);
  }
}

/* Mean extinction of every segment, and the optical thickness that it adds. */
CHI_INLINE void classify_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count,
  const int nearest, const int general)
{
  const chi_sample_frame* const s = row->frame;
  const vf nan = vf_set(NAN);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf t = vf_load(piece->t + i);
    const vi finite = t == t;
    const vi entry = vi_load(piece->entry + i);
    vf parts[4]; /* lanes without a sample read entry 0 */
    vf_load_entries((const float(*)[4])(const void*)s->sigma, piece->entry + i, parts);
    const vf f = t - vi_float(entry);
    const vi sum = (vi)parts[0];
    const vf sigma0 = parts[1], half_slope = parts[2];
    const vf rest = f * (sigma0 + f * half_slope);

    /* Scalar linear along the segment: integral over scalar / its change. Where that hardly
     * changes, the extinction in the middle. */
    const vf t_before = row->restart ? nan : vf_load(row->table_position + x);
    const vi known = (t_before == t_before) & finite;
    /* Samples of nearest interpolation are steps: nothing lies between two labels. */
    const vf t0 = nearest ? t : vf_select(known, t_before, t);
    const vf change = t - t0;
    if (general && s->shade)
    {
      vf_store(piece->before + i, t0);
    }
    const vi steep = ((change > 1.0f) | (change < -1.0f)) & known;
    const vf local = sigma0 + (2.0f * f - change) * half_slope;
    const vf integral = vi_float((vi)((vu)sum - (vu)vi_load(row->sum + x))) * s->quantum +
      (rest - vf_load(row->rest + x));
    vf sigma = vf_select(steep, integral / vf_select(steep, change, vf_set(1.0f)), local);
    /* A ray that begins here has no scalar before; elsewhere an unsampled neighbour was
     * transparent, and its brick's margin covers this segment. */
    const vi entering =
      row->enter || s->labels ? vi_load(piece->entering + i) : vi_set(row->first ? -1 : 0);
    const vi valid = finite & (known | entering);
    sigma = vf_select(valid, vf_max(sigma, vf_set(0.0f)), vf_set(0.0f));
    vf_store(row->table_position + x, t);
    vi_store(row->sum + x, sum);
    vf_store(row->rest + x, rest);
    const vf fraction = row->enter ? vf_load(piece->fraction + i) : vf_set(1.0f);
    vf_store(piece->depth + i, sigma * (fraction * s->slice));
    vf_store(piece->change + i, vf_select(valid, change, vf_set(0.0f)));
    if (general)
    {
      vi_store(piece->known + i, known);
    }
    vi_store(piece->color + i, vf_int(vf_select(valid, t - 0.5f * change + 0.5f, vf_set(0.0f))));
  }
}

#include "chi_occlusion_colors.inl"

#include "chi_occlusion_shade.inl"

#include "chi_occlusion_components.inl"

/* What the eye gets of it. */
CHI_INLINE void composite_piece(
  chi_sample_row* row, sample_piece* piece, int x_begin, int count, const int general)
{
  const chi_sample_frame* const s = row->frame;
  int any_tau = row->any_tau;
  piece->listed = general ? piece->listed : 0;
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    vf depth = vf_load(piece->depth + i);
    if (row->new_tau)
    {
      vf_store(row->tau + x, depth);
    }
    if (!vi_any(depth > 0.0f))
    {
      continue;
    }
    any_tau = 1;
    if (!row->new_tau)
    {
      vf_store(row->tau + x, vf_load(row->tau + x) + depth);
    }
    /* The eye sees the part in front of the surface, and nothing where it is dark already. */
    if (row->surface)
    {
      const vf fraction = row->enter ? vf_load(piece->fraction + i) : vf_set(1.0f);
      const vf free = vf_load(row->surface + x) - row->near_slice;
      depth *= vf_min(vf_max(free, vf_set(0.0f)), fraction) / vf_max(fraction, vf_set(1e-30f));
    }
    const vf transmittance = vf_load(row->transmittance + x);
    const vi seen = (transmittance > s->saturated) & (depth > 0.0f);
    if (!vi_any(seen))
    {
      continue;
    }
    const vf slope = row->length0 + (vf_iota() + (float)x) * row->length_x;
    const vf tau = depth * vf_sqrt(slope * slope + row->length_c);
    const vf alpha = vf_select(seen, 1.0f - vf_exp_neg(-tau), vf_set(0.0f));
    const vf share = transmittance * alpha;
    vf weight = share;
    vf_store(row->transmittance + x, transmittance - weight);
    const int darkened = general && s->shade && s->shade->lit; /* shading has done it */
    if (row->visibility && !darkened && !(general && s->tinted))
    {
      weight *= vf_load(row->visibility + x);
    }
    vf color[4];
    if (general)
    {
      for (int c = 0; c < 3; ++c)
      {
        color[c] = vf_load(piece->rgb[c] + i);
        if (s->tinted && row->tint[c] && !darkened)
        {
          color[c] *= vf_load(row->tint[c] + x);
        }
      }
    }
    else
    {
      vf_load_entries(s->rgba, piece->color + i, color);
      weight = vf_select(list_colors(s, piece, i, tau, share, weight), vf_set(0.0f), weight);
    }
    for (int c = 0; c < 3; ++c)
    {
      vf_store(row->color[c] + x, vf_load(row->color[c] + x) + weight * color[c]);
    }
  }
  row->any_tau = any_tau;
  if (!general && piece->listed)
  {
    integrate_listed(s, piece);
    for (int k = 0; k < piece->listed; ++k)
    {
      const int i = piece->list[k];
      for (int c = 0; c < 3; ++c)
      {
        row->color[c][x_begin + i] += piece->weight[i] * piece->rgb[c][i];
      }
    }
  }
}

static float farthest(const float* transmittance, const float* surface, float limit, int count)
{
  vf far = vf_set(-INFINITY);
  for (int x = 0; x < count; x += CHI_LANES)
  {
    const vi clear = (vf_load(transmittance + x) > limit) & (vf_iota() < (float)(count - x));
    const vf end = surface ? vf_load(surface + x) : vf_set(INFINITY);
    far = vf_max(far, vf_select(clear, end, far));
  }
  float most = far[0];
  for (int i = 1; i < CHI_LANES; ++i)
  {
    most = far[i] > most ? far[i] : most;
  }
  return most;
}

/* `general`: colours are computed, not only looked up. */
CHI_INLINE void sample_run(chi_sample_row* row, int x_begin, int x_end, const int fetch,
  const int nearest, const int general)
{
  sample_piece piece;
  for (int x = x_begin; x < x_end; x += PIECE)
  {
    const int count = x_end - x < PIECE ? x_end - x : PIECE;
    if (row->cut)
    {
      cut_piece(row, &piece, x, count);
    }
    fetch_piece(row, &piece, x, count, fetch, nearest);
    classify_piece(row, &piece, x, count, nearest, general);
    if (general)
    {
      color_piece(row, &piece, x, count);
      if (row->frame->components)
      {
        components_piece(row, &piece, x, count, fetch, nearest);
      }
      if (row->frame->shade)
      {
        shade_piece(row, &piece, x, count, fetch, nearest);
      }
    }
    composite_piece(row, &piece, x, count, general);
  }
}

/* One body an input type and interpolation. */
CHI_INLINE void sample_fetch(chi_sample_row* row, int x_begin, int x_end, const int fetch)
{
  if (row->frame->nearest)
  {
    sample_run(row, x_begin, x_end, fetch, 1, 0);
  }
  else
  {
    sample_run(row, x_begin, x_end, fetch, 0, 0);
  }
}

static void sample(chi_sample_row* row, int x_begin, int x_end)
{
  if (row->frame->general) /* slow anyhow: one body, which branches at every fetch */
  {
    sample_run(row, x_begin, x_end, row->frame->fetch, row->frame->nearest, 1);
    return;
  }
  switch (row->frame->fetch)
  {
    case CHI_FETCH_U8:
      sample_fetch(row, x_begin, x_end, CHI_FETCH_U8);
      break;
    case CHI_FETCH_I16:
      sample_fetch(row, x_begin, x_end, CHI_FETCH_I16);
      break;
    case CHI_FETCH_U16:
      sample_fetch(row, x_begin, x_end, CHI_FETCH_U16);
      break;
    default:
      sample_fetch(row, x_begin, x_end, CHI_FETCH_F32);
      break;
  }
}
