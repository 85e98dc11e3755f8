/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Which cells of the picture meet something, block by block, and until when. */

#include "chi_mask_internal.h"
#include "chi_occlusion_march.h"

#include <math.h>

/* As fmax and fmin, NaN in b included, without a call. */
static inline double greater(double a, double b)
{
  return b > a ? b : a;
}

static inline double lesser(double a, double b)
{
  return b < a ? b : a;
}

/* Where the rays of one row of pixels enter and leave the volume's box, less what the clip planes
 * cut away, in slices. */
static void intersect_box(const march* m, int64_t y)
{
  const chi_scene* const s = m->scene;
  float* const enter = picture(m, ENTER, y);
  float* const leave = picture(m, LEAVE, y);
  const double first = (double)(s->volume_begin * s->group),
               last = (double)(s->volume_end * s->group);
  for (size_t x = 0; x < m->light.stride; ++x)
  {
    double from = first, to = last, p[3], q[3]; /* index position at slice 0, its change a slice */
    for (int a = 0; a < 3; ++a)
    {
      const double across = (double)x * s->along_x[a] + (double)y * s->along_y[a];
      const double o = s->origin[a] + (s->parallel ? across : 0);
      const double d = s->axis[a] + (s->parallel ? 0 : across);
      p[a] = o + d * s->start;
      q[a] = d * s->slice;
      if (q[a] == 0)
      {
        to = p[a] >= s->box_low[a] && p[a] <= s->box_high[a] ? to : from;
        continue;
      }
      const double t0 = (s->box_low[a] - p[a]) / q[a], t1 = (s->box_high[a] - p[a]) / q[a];
      from = greater(from, lesser(t0, t1));
      to = lesser(to, greater(t0, t1));
    }
    for (int k = 0; k < s->clips; ++k)
    {
      const double* const c = s->clip[k];
      const double value = c[0] * p[0] + c[1] * p[1] + c[2] * p[2] + c[3];
      const double change = c[0] * q[0] + c[1] * q[1] + c[2] * q[2];
      from = change > 0 ? greater(from, -value / change) : from;
      to = change < 0 ? lesser(to, -value / change) : change == 0 && value < 0 ? from : to;
    }
    const int hit = from < to && x < (size_t)s->width;
    enter[x] = hit ? (float)from : INFINITY;
    leave[x] = hit ? (float)to : -INFINITY;
  }
}

void chi_march_intersect_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  for (size_t y = begin; y < end && !chi_is_cancelled(m->exec); ++y)
  {
    intersect_box(m, (int64_t)y);
  }
}

/* Samples of a cell that the brick test spares, for the counter alone. `inside`: the cell lies in
 * the box as a whole, but for slabs behind the last one with samples. */
static int64_t count_inside(const march* m, int cx, int cy, double first, double last, int inside)
{
  const chi_scene* const s = m->scene;
  int64_t count = 0;
  if (inside)
  {
    const int width = s->width - cx * CHI_CELL_WIDTH, height = s->height - cy * CHI_CELL_HEIGHT;
    last = lesser(last, (double)(s->volume_end * s->group));
    return height <= 0
      ? 0
      : (int64_t)(last - first) * (width < CHI_CELL_WIDTH ? width : CHI_CELL_WIDTH) *
        (height < CHI_CELL_HEIGHT ? height : CHI_CELL_HEIGHT);
  }
  for (int y = cy * CHI_CELL_HEIGHT; y < (cy + 1) * CHI_CELL_HEIGHT && y < s->height; ++y)
  {
    const float* const enter = picture(m, ENTER, y);
    const float* const leave = picture(m, LEAVE, y);
    for (int x = cx * CHI_CELL_WIDTH; x < (cx + 1) * CHI_CELL_WIDTH && x < s->width; ++x)
    {
      const double from = floor(greater((double)enter[x], first));
      const double to = ceil(lesser((double)leave[x], last));
      count += to > from ? (int64_t)(to - from) : 0;
    }
  }
  return count;
}

/* All samples of a cell's lattice, for the counter alone. */
static int64_t count_lattice(const march* m, int cx, int cy, int64_t block)
{
  const chi_scene* const s = m->scene;
  const int64_t begin = block * m->block > s->volume_begin ? block * m->block : s->volume_begin;
  const int64_t end =
    (block + 1) * m->block < s->volume_end ? (block + 1) * m->block : s->volume_end;
  const int width = s->width - cx * CHI_CELL_WIDTH, height = s->height - cy * CHI_CELL_HEIGHT;
  return end <= begin || height <= 0
    ? 0
    : (end - begin) * s->group * (width < CHI_CELL_WIDTH ? width : CHI_CELL_WIDTH) *
      (height < CHI_CELL_HEIGHT ? height : CHI_CELL_HEIGHT);
}

/* Leave out a cell that has nothing of the volume in it, or have its rays find out. */
static uint8_t spare_cell(march* m, int64_t block, int cx, int cy, int flag, int kind)
{
  if (!(m->skip & flag))
  {
    return CELL_OCCUPIED | CELL_CROSSES_BOX |
      (m->scene->regions == CHI_CROP_ALL_REGIONS && !m->classification->mask ? 0 : CELL_CUT);
  }
  atomic_fetch_add(&m->skipped[kind], count_lattice(m, cx, cy, block));
  return CELL_EMPTY;
}

static uint8_t classify_cell(march* m, int64_t block, int cx, int cy)
{
  const chi_scene* const s = m->scene;
  const double first = (double)(block * m->block), last = first + m->block;
  const double z[2] = { chi_scene_depth(s, first), chi_scene_depth(s, last) };
  const double x[2] = { cx * CHI_CELL_WIDTH, cx * CHI_CELL_WIDTH + CHI_CELL_WIDTH - 1 };
  const double y[2] = { cy * CHI_CELL_HEIGHT, cy * CHI_CELL_HEIGHT + CHI_CELL_HEIGHT - 1 };
  double low[3], high[3], p[8][3];
  int inside = first >= (double)s->volume_begin;
  for (int a = 0; a < 3; ++a)
  {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (int corner = 0; corner < 8; ++corner)
    {
      const double depth = z[corner >> 2];
      const double across = x[corner & 1] * s->along_x[a] + y[corner >> 1 & 1] * s->along_y[a];
      p[corner][a] = s->origin[a] + depth * s->axis[a] + (s->parallel ? 1 : depth) * across;
      low[a] = lesser(low[a], p[corner][a]);
      high[a] = greater(high[a], p[corner][a]);
    }
    if (!(high[a] >= s->box_low[a] && low[a] <= s->box_high[a]))
    {
      return spare_cell(m, block, cx, cy, CHI_SKIP_FOOTPRINT, SKIPPED_FOOTPRINT);
    }
    inside &= low[a] > s->box_low[a] + 0.01 && high[a] < s->box_high[a] - 0.01;
  }
  for (int k = 0; k < s->clips; ++k)
  {
    const double* const c = s->clip[k];
    double least = INFINITY, most = -INFINITY;
    for (int corner = 0; corner < 8; ++corner)
    {
      const double value = c[0] * p[corner][0] + c[1] * p[corner][1] + c[2] * p[corner][2] + c[3];
      least = lesser(least, value);
      most = greater(most, value);
    }
    if (most < 0)
    {
      return spare_cell(m, block, cx, cy, CHI_SKIP_CLIPPED, SKIPPED_CLIPPED);
    }
    inside &= least > 0.01;
  }
  const chi_cut_share share = chi_crop_share(s, (const double(*)[3])p);
  if (share == CHI_CUT_ALL)
  {
    return spare_cell(m, block, cx, cy, CHI_SKIP_CLIPPED, SKIPPED_CLIPPED);
  }
  int64_t all;
  const int64_t occupied = chi_classification_count(m->classification, m->bricks, low, high, &all);
  const int cut =
    share == CHI_CUT_PART || chi_mask_cuts(m->classification->mask, m->bricks, low, high);
  const uint8_t crosses = (uint8_t)((inside ? 0 : CELL_CROSSES_BOX) | (cut ? CELL_CUT : 0));
  if (!(m->skip & CHI_SKIP_BRICKS))
  {
    return CELL_OCCUPIED | crosses;
  }
  if (occupied == 0)
  {
    const double group = (double)s->group;
    atomic_fetch_add(
      &m->skipped[SKIPPED_BRICKS], count_inside(m, cx, cy, first * group, last * group, inside));
    return CELL_EMPTY;
  }
  return (uint8_t)(CELL_OCCUPIED | crosses | (occupied < all ? CELL_MIXED : 0));
}

void chi_march_classify_blocks(void* data, size_t begin, size_t end)
{
  march* const m = (march*)data;
  for (size_t i = begin; i < end && !chi_is_cancelled(m->exec); ++i)
  {
    const int64_t block = (int64_t)(i / (size_t)m->cells_y);
    const int cy = (int)(i % (size_t)m->cells_y);
    const int sampled =
      (block + 1) * m->block > m->scene->volume_begin && block * m->block < m->scene->volume_end;
    for (int cx = 0; cx < m->cells_x; ++cx)
    {
      m->cells[i * (size_t)m->cells_x + (size_t)cx] =
        sampled ? classify_cell(m, block, cx, cy) : CELL_EMPTY;
    }
  }
}

/* Rows of light pixels that a band touches in any slab of a block. */
void chi_march_band_rows(const march* m, int band, int64_t rows[2])
{
  const int64_t first = (int64_t)band * BAND - (int64_t)m->light.skew * (m->block - 1);
  const int64_t last = (int64_t)(band + 1) * BAND;
  rows[0] = first > 0 ? first : 0;
  rows[1] = last < m->scene->light_height ? last : m->scene->light_height;
}

/* The last slab of every cell in which there may be something. */
void chi_march_last_cells(march* m)
{
  const int64_t count = (int64_t)m->cells_y * m->cells_x;
  for (int64_t i = 0; i < count; ++i)
  {
    int64_t block = m->blocks - 1;
    while (block >= 0 && m->cells[block * count + i] == CELL_EMPTY)
    {
      --block;
    }
    const int64_t end = (block + 1) * m->block;
    m->last_cell[i] = (int32_t)((end < m->scene->slabs ? end : m->scene->slabs) - 1);
  }
}

/* The last slab in which a ray of this piece of a band may meet something, and the last step that
 * lights a surface in it; -1 for never. */
void chi_march_last_slab(const march* m, int band, int segment, int64_t last[2])
{
  const chi_scene* const s = m->scene;
  int64_t rows[2];
  chi_march_band_rows(m, band, rows);
  last[0] = last[1] = -1;
  for (int64_t y = rows[0]; y < rows[1] && m->frame->surface; ++y)
  {
    const int64_t step = m->light.served[y * m->light.segments + segment].last;
    last[1] = step > last[1] ? step : last[1];
  }
  for (int64_t y = rows[0]; y < rows[1] && m->layers; ++y)
  {
    const float step =
      m->layer_steps[2 * ((size_t)y * (size_t)m->light.segments + (size_t)segment) + 1];
    const int64_t slab = step < (float)s->slabs ? (int64_t)fmaxf(step, -1) : s->slabs;
    last[1] = slab > last[1] ? slab : last[1];
  }
  const int64_t cy0 = rows[0] * s->scale / CHI_CELL_HEIGHT;
  const int64_t cy1 = (rows[1] * s->scale - 1) / CHI_CELL_HEIGHT;
  const int64_t width = (int64_t)CHI_SEGMENT * s->scale;
  const int64_t cx0 = segment * width / CHI_CELL_WIDTH;
  int64_t cx1 = ((segment + 1) * width - 1) / CHI_CELL_WIDTH;
  cx1 = cx1 < m->cells_x ? cx1 : m->cells_x - 1;
  for (int64_t cy = cy0; cy <= cy1 && cy < m->cells_y && rows[0] < rows[1]; ++cy)
  {
    const int32_t* const cells = m->last_cell + cy * m->cells_x;
    for (int64_t cx = cx0; cx <= cx1; ++cx)
    {
      last[0] = cells[cx] > last[0] ? cells[cx] : last[0];
    }
  }
}
