/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* What cropping regions and masks leave of a segment. Included by chi_occlusion_sample.inl. */

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
CHI_INLINE vi cut_region(const chi_plan_cut* cut, const vf p[3])
{
  vi region = vi_set(0);
  for (int k = 0; k < 6; ++k)
  {
    static const int32_t place[3] = { 1, 3, 9 };
    region += (plane_value(cut->plane[k], p) >= 0.0f) & place[k / 2];
  }
  return region;
}

/* Cells of a grid that points lie in; its index is returned. */
CHI_INLINE vi cut_cell(const chi_plan_grid* grid, const vf p[3], vi cell[3])
{
  for (int a = 0; a < 3; ++a)
  {
    const vf last = vf_set((float)grid->last[a]);
    cell[a] = vf_int(vf_min(vf_max(p[a] + grid->offset, vf_set(0.0f)), last));
  }
  return cell[0] + cell[1] * grid->step_y + cell[2] * grid->step_z;
}

/* Where the line crosses planes, within [low, high]; elsewhere one of these. */
CHI_INLINE int cross_regions(const chi_plan_cut* cut, const cut_line* line, vf low, vf high, vf* t)
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

/* The same of the faces between cells: of every axis the last face, and, where the line is longer
 * than a cell, the first; it crosses no others if it is no longer than two. */
CHI_INLINE int cross_cells(const chi_plan_grid* grid, const cut_line* line, vf low, vf high, vf* t)
{
  vf first[3];
  vi near[3], far[3];
  cut_point(line, low, first);
  cut_cell(grid, first, near);
  cut_cell(grid, line->far, far);
  int count = 0;
  for (int a = 0; a < 3; ++a)
  {
    const vi up = line->step[a] > 0.0f;
    const vf last_face = vi_float(far[a] + (~up & 1)) - grid->offset;
    t[count++] = vf_min(vf_max(1.0f + (last_face - line->far[a]) / line->step[a], low), high);
    const vf first_face = vi_float(near[a] + (up & 1)) - grid->offset;
    const vf at = 1.0f + (first_face - line->far[a]) / line->step[a];
    if (vi_any((at > low) & (at < t[count - 1])))
    {
      t[count] = vf_min(vf_max(at, low), high);
      ++count;
    }
  }
  return count;
}

CHI_INLINE vi is_kept(const chi_plan_cut* cut, int grids, const vf p[3], vi mask)
{
  if (cut->regions != CHI_CROP_ALL_REGIONS)
  {
    const vi region = cut_region(cut, p);
    mask &= ((vi)((vu)vi_set((int32_t)cut->regions) >> (vu)region) & 1) != 0;
  }
  for (int k = 0; k < grids; ++k)
  {
    vi cell[3];
    const vi n = cut_cell(cut->grid + k, p, cell);
    const vi word = vi_gather(cut->grid[k].bits, n >> 5, 4, mask);
    mask &= ((vi)((vu)word >> (vu)(n & 31)) & 1) != 0;
  }
  return mask;
}

/* Whether a line between two points may cross a cut. */
CHI_INLINE vi may_cross(const chi_plan_cut* cut, int grids, const vf p[3], const vf q[3])
{
  vi differ = vi_set(0);
  if (cut->regions != CHI_CROP_ALL_REGIONS)
  {
    differ |= cut_region(cut, p) != cut_region(cut, q);
  }
  for (int k = 0; k < grids; ++k)
  {
    vi cell[3];
    differ |= cut_cell(cut->grid + k, p, cell) != cut_cell(cut->grid + k, q, cell);
  }
  return differ;
}

enum
{
  MAX_CROSSINGS = 6 + 6 * CHI_PLAN_GRIDS
};

/* Part a segment where it crosses cuts, and add up what is left; its last part without a gap is run
 * ... stop. */
CHI_INLINE void cut_segment(const chi_plan_cut* cut, int grids, const cut_line* line, vf begin,
  vf start, vf end, vf* length, vf* run, vf* stop, vi* before)
{
  vf t[MAX_CROSSINGS + 2];
  int count =
    cut->regions != CHI_CROP_ALL_REGIONS ? cross_regions(cut, line, begin, end, t + 1) : 0;
  for (int k = 0; k < grids; ++k)
  {
    count += cross_cells(cut->grid + k, line, begin, end, t + 1 + count);
  }
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
  vi open = vi_set(0);
  for (int i = 0; i <= count; ++i)
  {
    const vi some = t[i] < t[i + 1];
    if (!vi_any(some))
    {
      continue;
    }
    vf middle[3];
    cut_point(line, 0.5f * (t[i] + t[i + 1]), middle);
    const vi kept = is_kept(cut, grids, middle, some);
    *before |= kept & (t[i] <= begin);
    *length += vf_select(kept, vf_max(t[i + 1] - vf_max(t[i], start), vf_set(0.0f)), vf_set(0.0f));
    *run = vf_select(kept & ~open, vf_max(t[i], start), *run);
    *stop = vf_select(kept & (t[i + 1] > start), t[i + 1], *stop);
    open = (kept & some) | (open & ~some);
  }
}

/*
 * Which segments are left, by how much, where their last part ends, and whether the ray comes out
 * of something that is cut. A little of the segment before is looked at as well: where a cut lies
 * on the near slice itself, rounding must not decide that the ray came from what is left.
 */
CHI_INLINE void cut_piece(chi_sample_row* row, sample_piece* piece, int x_begin, int count)
{
  const chi_sample_frame* const s = row->frame;
  const chi_plan_cut* const cut = &s->cut;
  const vf zero = vf_set(0.0f), one = vf_set(1.0f), ahead = vf_set(-cut->ahead);
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

    vf p[3], q[3];
    cut_point(&line, begin, p);
    cut_point(&line, end, q);
    int grids = cut->grids;
    if (grids)
    {
      vi at[3];
      for (int a = 0; a < 3; ++a)
      {
        at[a] = vf_int(vf_min(vf_max(q[a], zero), vf_set(s->last_index[a]))) >> 3;
      }
      const vi brick = at[0] + at[1] * s->brick_step_y + at[2] * s->brick_step_z;
      const vi part = (vi_gather(cut->whole, brick, 1, inside) & 255) == 0;
      grids = vi_any(part & inside) ? grids : 0;
    }
    vf length = zero, run = start, stop = end;
    vi before = vi_set(0);
    if (vi_any(may_cross(cut, grids, p, q) & inside))
    {
      cut_segment(cut, grids, &line, begin, start, end, &length, &run, &stop, &before);
    }
    else
    {
      before = is_kept(cut, grids, q, inside); /* the whole of it or nothing */
      length = vf_select(before, end - start, zero);
    }
    const vi want = inside & (length > 0.0f);
    vi_store(piece->want + i, want);
    const vf at = s->nearest ? 0.5f * (run + stop) : stop;
    vf_store(piece->back + i, vf_select(want, at - 1.0f, zero));
    vf_store(piece->fraction + i, vf_select(want, length, zero));
    vi_store(piece->entering + i, fresh | ~before);
  }
}
