/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What cropping regions leave of a segment. Included by chi_occlusion_sample.inl. */

/* A segment's line, seen by the cuts: index position far + (t - 1) step, t = 0 ... 1. */
typedef struct cut_line
{
  vf far[3], step[3];
} cut_line;

CHI_INLINE void cut_point(const cut_line* line, vf t, vf p[3])
{
  for (int a = 0; a < 3; ++a)
  {
    p[a] = line->far[a] + (t - 1.0f) * line->step[a];
  }
}

CHI_INLINE vf plane_value(const float plane[4], const vf p[3])
{
  return plane[0] * p[0] + (plane[1] * p[1] + (plane[2] * p[2] + plane[3]));
}

/* Region of a point: one count of planes a pair, base 3. */
CHI_INLINE vi cut_region(const chi_cut* cut, const vf p[3])
{
  vi region = vi_set(0);
  for (int k = 0; k < 6; ++k)
  {
    static const int32_t place[3] = { 1, 3, 9 };
    region += (plane_value(cut->plane[k], p) >= 0.0f) & place[k / 2];
  }
  return region;
}

/* Where the line crosses planes, within [low, high]; elsewhere one of these. */
CHI_INLINE int cross_regions(const chi_cut* cut, const cut_line* line, vf low, vf high, vf* t)
{
  for (int k = 0; k < 6; ++k)
  {
    const float* const n = cut->plane[k];
    const vf change = n[0] * line->step[0] + (n[1] * line->step[1] + n[2] * line->step[2]);
    /* parallel lines divide by zero: what comes out, NaN included, is clamped */
    const vf at = 1.0f - plane_value(n, line->far) / change;
    t[k] = vf_min(vf_max(at, low), high);
  }
  return 6;
}

CHI_INLINE vi is_kept(const chi_cut* cut, const vf p[3], vi mask)
{
  const vi region = cut_region(cut, p);
  return mask & (((vi)((vu)vi_set((int32_t)cut->regions) >> (vu)region) & 1) != 0);
}

enum
{
  MAX_CROSSINGS = 6
};

/* Part a segment where it crosses cuts, and add up what is left. */
CHI_INLINE void cut_segment(const chi_cut* cut, const cut_line* line, vf begin, vf start, vf end,
  vf* length, vf* stop, vi* before)
{
  vf t[MAX_CROSSINGS + 2];
  const int count = cross_regions(cut, line, begin, end, t + 1);
  for (int i = 2; i <= count; ++i) /* insertion sort, every lane its own */
  {
    for (int j = i; j > 1; --j)
    {
      const vf low = vf_min(t[j - 1], t[j]);
      t[j] = vf_max(t[j - 1], t[j]);
      t[j - 1] = low;
    }
  }
  t[0] = begin;
  t[count + 1] = end;
  for (int i = 0; i <= count; ++i)
  {
    const vi some = t[i] < t[i + 1];
    if (!vi_any(some))
    {
      continue;
    }
    vf middle[3];
    cut_point(line, 0.5f * (t[i] + t[i + 1]), middle);
    const vi kept = is_kept(cut, middle, some);
    *before |= kept & (t[i] <= begin);
    *length += vf_select(kept, vf_max(t[i + 1] - vf_max(t[i], start), vf_set(0.0f)), vf_set(0.0f));
    *stop = vf_select(kept & (t[i + 1] > start), t[i + 1], *stop);
  }
}

/*
 * Which segments are left, by how much, where their last part ends, and whether the ray comes out
 * of something that is cut. A little of the segment before is looked at as well: where a cut lies
 * on the near slice itself, rounding must not decide that the ray came from what is left.
 */
CHI_INLINE void cut_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count)
{
  const chi_cut* const cut = &row->frame->cut;
  const vf zero = vf_set(0.0f), one = vf_set(1.0f), ahead = vf_set(-1.0f / 64);
  for (int i = 0; i < count; i += CHI_LANES)
  {
    const int x = x_begin + i;
    const vf xs = vf_iota() + (float)x;
    cut_line line;
    for (int a = 0; a < 3; ++a)
    {
      line.far[a] = row->position[a] + xs * row->position_x[a];
      line.step[a] = row->direction[a] + xs * row->direction_x[a];
    }
    const vf enter = vf_load(row->enter + x), leave = vf_load(row->leave + x);
    const vf start = vf_min(vf_max(enter - row->near_slice, zero), one);
    const vf end = vf_min(vf_max(leave - row->near_slice, zero), one);
    const vi fresh = (enter >= row->near_slice) | vi_set(row->first ? -1 : 0);
    const vf begin = vf_select(fresh, start, ahead);
    const vi inside = start < end;

    vf p[3];
    cut_point(&line, begin, p);
    const vi region = cut_region(cut, p);
    cut_point(&line, end, p);
    vf length = zero, stop = end;
    vi before = vi_set(0);
    if (vi_any((region != cut_region(cut, p)) & inside))
    {
      cut_segment(cut, &line, begin, start, end, &length, &stop, &before);
    }
    else
    {
      before = is_kept(cut, p, inside); /* the whole of it or nothing */
      length = vf_select(before, end - start, zero);
    }
    const vi want = inside & (length > 0.0f);
    vi_store(piece->want + i, want);
    vf_store(piece->back + i, vf_select(want, stop - 1.0f, zero));
    vf_store(piece->fraction + i, vf_select(want, length, zero));
    vi_store(piece->entering + i, fresh | ~before);
  }
}
