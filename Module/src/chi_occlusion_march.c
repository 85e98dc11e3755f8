/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/*
 * The march through the slabs.
 *
 * Light planes are too large for a core's cache, and every slab reads and writes all of them. So a
 * task takes a band of rows through a whole block of slabs. In each slab light moves by at most
 * `skew` rows; the band moves down by as much from slab to slab, and then needs, of other tasks,
 * only those that come before it: the band below in this block, and the band above in the block
 * before. Two copies of the planes are enough (theory/occlusion.md shows why no row is overwritten
 * too early).
 *
 * Tasks are handed out in the order of a diagonal sweep, by a ticket, whatever range the host's
 * parallel_for names: a task only ever waits for one that has been handed out before it, so any
 * schedule ends, a serial one included, and all give the same bits.
 */

#include "chi_occlusion_internal.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#if defined(_WIN32)
#  include <windows.h>
#  define CHI_YIELD() SwitchToThread()
#else
#  include <sched.h>
#  define CHI_YIELD() sched_yield()
#endif

enum
{
  MAX_BLOCK = 8, /* slabs a task takes at most */
  BAND = 8       /* light rows a task takes */
};

/* Picture-sized planes of floats, in this order in chi_march.planes. */
enum
{
  RED,
  GREEN,
  BLUE,
  TRANSMITTANCE,
  TABLE_POSITION,
  SUM,
  REST,
  TAU,
  ROW_VISIBILITY,
  ENTER,
  LEAVE,
  SURFACE,
  BLOCK_BEGIN,
  BLOCK_END,
  SURFACE_VISIBILITY,
  PICTURE_PLANES,
  LIGHT_TAU = 0,
  GEOMETRY,
  LIGHT_PLANES
};

/* What a cell of pixels needs in a block of slabs. */
enum
{
  CELL_EMPTY = 0,
  CELL_OCCUPIED = 1,
  CELL_CROSSES_BOX = 2,
  CELL_MIXED = 4
};

/* The shift of one slab, for all directions. */
typedef struct light_step
{
  ptrdiff_t offset[CHI_MAX_DIRECTIONS];
  float weight[CHI_MAX_DIRECTIONS][4];
} light_step;

typedef struct march
{
  const chi_exec* exec;
  const chi_scene* scene;
  const chi_occlusion_frame* frame;
  const chi_occlusion_kernels* kernels;
  chi_march* keep;
  chi_sample_frame sample;
  const chi_bricks* bricks;
  const chi_classification* classification;
  float* planes;  /* [PICTURE_PLANES][rows][stride] */
  float* scratch; /* [LIGHT_PLANES][light rows][light_stride] */
  size_t stride, rows, plane;
  /* Light: [rows][directions][light_stride], so that a row of all directions is contiguous (pages,
   * cache sets); visibility: [ring][rows][light_stride]. Origins: pixel (0, 0) within the padding. */
  size_t light_stride, light_row, light_plane, light_origin, visibility_origin;
  int64_t ring;
  int skew, block, bands;
  int64_t blocks;
  int lag; /* bands by which a block must lead the next one */
  int cells_x, cells_y, segments;
  int shift_segments;      /* segments to either side that light may come from */
  uint8_t* cells;          /* [blocks][cells_y][cells_x] */
  int64_t (*last_slab)[2]; /* [bands][segments]: of samples, of surfaces that are yet to be lit */
  uint8_t* live;           /* [blocks][bands][segments] */
  uint8_t* live_row;       /* [rows][cells_x] */
  int64_t* sampled;        /* [rows][cells_x] segment sampled last */
  uint8_t* tau_flag;       /* [light rows][segments] */
  uint8_t* tau_stale;      /* [rows] the row's thickness is that of an earlier slab */
  uint8_t* need;           /* [bands][segments] */
  float* ranges;      /* [light rows][segments][4]: blocker begin, end; receiver first, last step */
  double* reach;      /* [slabs + 1] light pixels that light can have moved */
  light_step* steps;  /* [slabs] */
  int64_t* order;     /* [tickets][2] block, band */
  atomic_uchar* done; /* [blocks][bands] */
  int fields;
  int surface_field;
  int keep_all, shaded;
  float strength;
  int64_t* probe_order; /* probes sorted by the step that serves them */
  atomic_size_t ticket;
  atomic_int cancelled;
  atomic_llong samples, skipped_samples, light_updates, skipped_light, nanoseconds[2];
  atomic_llong empty_samples;
} march;

double chi_seconds(void)
{
  struct timespec now;
  timespec_get(&now, TIME_UTC);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static float* picture(const march* m, int which, int64_t y)
{
  return m->planes + ((size_t)y * PICTURE_PLANES + (size_t)which) * m->stride;
}

static float* light_scratch(const march* m, int which, int64_t y)
{
  return m->scratch +
    ((size_t)which * (size_t)m->scene->light_height + (size_t)y) * m->light_stride;
}

static float* row_of_light(const march* m, const chi_light_field* f, int64_t side, int64_t y)
{
  return (float*)f->light[side].data + m->light_origin + (size_t)y * m->light_row;
}

static int64_t ring_slot(const march* m, int64_t slab)
{
  return slab % m->ring;
}

static float* visibility_row(const march* m, const chi_light_field* f, int64_t slab, int64_t y)
{
  return (float*)f->visibility.data + (size_t)ring_slot(m, slab) * m->light_plane +
    m->visibility_origin + (size_t)y * m->light_stride;
}

/* Flags of a row: sides 0 and 1 of the light, then the ring of visibility planes. */
static uint8_t* dirty_row(const march* m, const chi_light_field* f, int64_t which, int64_t y)
{
  return (uint8_t*)f->dirty.data +
    (size_t)(which * m->scene->light_height + y) * (size_t)m->segments;
}

/* ---- visible set ------------------------------------------------------------------------------
 */

/* Where the rays of one row of pixels enter and leave the volume's box, in slices. */
static void intersect_box(const march* m, int64_t y)
{
  const chi_scene* const s = m->scene;
  float* const enter = picture(m, ENTER, y);
  float* const leave = picture(m, LEAVE, y);
  const double first = (double)(s->volume_begin * s->group),
               last = (double)(s->volume_end * s->group);
  for (size_t x = 0; x < m->stride; ++x)
  {
    double from = first, to = last;
    for (int a = 0; a < 3; ++a)
    {
      const double across = (double)x * s->along_x[a] + (double)y * s->along_y[a];
      const double o = s->origin[a] + (s->parallel ? across : 0);
      const double d = s->axis[a] + (s->parallel ? 0 : across);
      const double p = o + d * s->start; /* index position at slice 0 */
      const double q = d * s->slice;
      if (q == 0)
      {
        to = p >= s->box_low[a] && p <= s->box_high[a] ? to : from;
        continue;
      }
      const double t0 = (s->box_low[a] - p) / q, t1 = (s->box_high[a] - p) / q;
      from = fmax(from, fmin(t0, t1));
      to = fmin(to, fmax(t0, t1));
    }
    const int hit = from < to && x < (size_t)s->width;
    enter[x] = hit ? (float)from : INFINITY;
    leave[x] = hit ? (float)to : -INFINITY;
  }
}

static void intersect_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  for (size_t y = begin; y < end && !chi_is_cancelled(m->exec); ++y)
  {
    intersect_box(m, (int64_t)y);
  }
}

/* Samples of a cell that the brick test spares, for the counter alone. */
static int64_t count_inside(const march* m, int cx, int cy, double first, double last)
{
  int64_t count = 0;
  for (int y = cy * CHI_CELL_HEIGHT; y < (cy + 1) * CHI_CELL_HEIGHT && y < m->scene->height; ++y)
  {
    const float* const enter = picture(m, ENTER, y);
    const float* const leave = picture(m, LEAVE, y);
    for (int x = cx * CHI_CELL_WIDTH; x < (cx + 1) * CHI_CELL_WIDTH && x < m->scene->width; ++x)
    {
      const double from = floor(fmax((double)enter[x], first));
      const double to = ceil(fmin((double)leave[x], last));
      count += to > from ? (int64_t)(to - from) : 0;
    }
  }
  return count;
}

static uint8_t classify_cell(march* m, int64_t block, int cx, int cy)
{
  const chi_scene* const s = m->scene;
  const double first = (double)(block * m->block), last = first + m->block;
  const double z[2] = { chi_scene_depth(s, first), chi_scene_depth(s, last) };
  const double x[2] = { cx * CHI_CELL_WIDTH, cx * CHI_CELL_WIDTH + CHI_CELL_WIDTH - 1 };
  const double y[2] = { cy * CHI_CELL_HEIGHT, cy * CHI_CELL_HEIGHT + CHI_CELL_HEIGHT - 1 };
  double low[3], high[3];
  int inside = first >= (double)s->volume_begin;
  for (int a = 0; a < 3; ++a)
  {
    low[a] = INFINITY;
    high[a] = -INFINITY;
    for (int corner = 0; corner < 8; ++corner)
    {
      const double depth = z[corner >> 2];
      const double across = x[corner & 1] * s->along_x[a] + y[corner >> 1 & 1] * s->along_y[a];
      const double p = s->origin[a] + depth * s->axis[a] + (s->parallel ? 1 : depth) * across;
      low[a] = fmin(low[a], p);
      high[a] = fmax(high[a], p);
    }
    if (!(high[a] >= s->box_low[a] && low[a] <= s->box_high[a]))
    {
      return CELL_EMPTY; /* outside the volume */
    }
    inside &= low[a] > s->box_low[a] + 0.01 && high[a] < s->box_high[a] - 0.01;
  }
  int64_t all;
  const int64_t occupied = chi_classification_count(m->classification, m->bricks, low, high, &all);
  const uint8_t crosses = inside ? 0 : CELL_CROSSES_BOX;
  if (m->keep_all)
  {
    return CELL_OCCUPIED | crosses;
  }
  if (occupied == 0)
  {
    const double group = (double)s->group;
    atomic_fetch_add(&m->empty_samples, count_inside(m, cx, cy, first * group, last * group));
    return CELL_EMPTY;
  }
  return (uint8_t)(CELL_OCCUPIED | crosses | (occupied < all ? CELL_MIXED : 0));
}

static void classify_blocks(void* data, size_t begin, size_t end)
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
static void band_rows(const march* m, int band, int64_t rows[2])
{
  const int64_t first = (int64_t)band * BAND - (int64_t)m->skew * (m->block - 1);
  const int64_t last = (int64_t)(band + 1) * BAND;
  rows[0] = first > 0 ? first : 0;
  rows[1] = last < m->scene->light_height ? last : m->scene->light_height;
}

/* The last slab in which a ray of this piece of a band may meet something, and the last step that
 * lights a surface in it; -1 for never. */
static void find_last_slab(const march* m, int band, int segment, int64_t last[2])
{
  const chi_scene* const s = m->scene;
  int64_t rows[2];
  band_rows(m, band, rows);
  last[0] = last[1] = -1;
  for (int64_t y = rows[0]; y < rows[1] && m->frame->surface; ++y)
  {
    const float step = m->ranges[4 * ((size_t)y * (size_t)m->segments + (size_t)segment) + 3];
    const int64_t slab = step < (float)s->slabs ? (int64_t)fmaxf(step, -1) : s->slabs;
    last[1] = slab > last[1] ? slab : last[1];
  }
  const int64_t cy0 = rows[0] * s->scale / CHI_CELL_HEIGHT;
  const int64_t cy1 = (rows[1] * s->scale - 1) / CHI_CELL_HEIGHT;
  const int64_t width = (int64_t)CHI_SEGMENT * s->scale;
  const int64_t cx0 = segment * width / CHI_CELL_WIDTH;
  int64_t cx1 = ((segment + 1) * width - 1) / CHI_CELL_WIDTH;
  cx1 = cx1 < m->cells_x ? cx1 : m->cells_x - 1;
  for (int64_t block = m->blocks - 1; block >= 0 && rows[0] < rows[1]; --block)
  {
    for (int64_t cy = cy0; cy <= cy1 && cy < m->cells_y; ++cy)
    {
      const uint8_t* const cells = m->cells + (block * m->cells_y + cy) * m->cells_x;
      for (int64_t cx = cx0; cx <= cx1; ++cx)
      {
        if (cells[cx] != CELL_EMPTY)
        {
          last[0] = (block + 1) * m->block - 1;
          last[0] = last[0] < s->slabs ? last[0] : s->slabs - 1;
          return;
        }
      }
    }
  }
}

/* ---- geometry ---------------------------------------------------------------------------------
 */

/* Step of the march that can serve visibility at this depth: both planes about it are then
 * complete, with a row to spare on either side. */
static double receiver_plane(const chi_scene* s, double slices)
{
  return slices / (double)s->group - s->bias - 0.5;
}

static void gather_ranges(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const chi_scene* const s = m->scene;
  for (size_t by = begin; by < end && !chi_is_cancelled(m->exec); ++by)
  {
    for (int segment = 0; segment < m->segments; ++segment)
    {
      float* const range = m->ranges + 4 * (by * (size_t)m->segments + (size_t)segment);
      range[0] = range[2] = INFINITY;
      range[1] = range[3] = -INFINITY;
      for (int64_t y = (int64_t)by * s->scale; y < (int64_t)(by + 1) * s->scale && y < s->height;
           ++y)
      {
        const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
        for (int64_t x = x0; x < x0 + CHI_SEGMENT * s->scale && x < s->width; ++x)
        {
          const float depth = picture(m, SURFACE, y)[x];
          if (depth < INFINITY)
          {
            const float step = (float)(floor(receiver_plane(s, (double)depth)) + 2);
            range[0] = fminf(range[0], picture(m, BLOCK_BEGIN, y)[x]);
            range[1] = fmaxf(range[1], picture(m, BLOCK_END, y)[x]);
            range[2] = fminf(range[2], step);
            range[3] = fmaxf(range[3], step);
          }
        }
      }
    }
  }
}

/* Transmittance of the geometry in a slab, a segment of light pixels; 0 when nothing blocks. */
static int block_light(const march* m, int64_t slab, int64_t by, int segment, float* out)
{
  const chi_scene* const s = m->scene;
  const float* const range = m->ranges + 4 * ((size_t)by * (size_t)m->segments + (size_t)segment);
  if (!m->frame->surface || !(range[0] < (float)(slab + 1)) || !(range[1] >= (float)slab))
  {
    return 0;
  }
  const float share = 1.0f / (float)(s->scale * s->scale);
  const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
  for (int i = 0; i < CHI_SEGMENT; ++i)
  {
    out[i] = 1;
  }
  for (int64_t y = by * s->scale; y < (by + 1) * s->scale && y < s->height; ++y)
  {
    const float* const begin = picture(m, BLOCK_BEGIN, y);
    const float* const end = picture(m, BLOCK_END, y);
    for (int64_t i = 0; i < CHI_SEGMENT * s->scale && x0 + i < s->width; ++i)
    {
      const int blocked = begin[x0 + i] < (float)(slab + 1) && end[x0 + i] >= (float)slab;
      out[i / s->scale] -= blocked ? share : 0;
    }
  }
  return 1;
}

/* Mean visibility at a place of a light plane, bilinear; x and y in light pixels from a centre. */
static double plane_at(const march* m, const chi_light_field* f, int64_t slab, double x, double y)
{
  if (slab < 0)
  {
    return 1;
  }
  const chi_scene* const s = m->scene;
  x = fmin(fmax(x, 0), s->light_width - 1);
  y = fmin(fmax(y, 0), s->light_height - 1);
  const int64_t i = (int64_t)x, j = (int64_t)y;
  const int64_t i1 = i + 1 < s->light_width ? i + 1 : i, j1 = j + 1 < s->light_height ? j + 1 : j;
  const double u = x - (double)i, v = y - (double)j;
  const float* const a = visibility_row(m, f, slab, j);
  const float* const b = visibility_row(m, f, slab, j1);
  return (1 - v) * ((1 - u) * (double)a[i] + u * (double)a[i1]) +
    v * ((1 - u) * (double)b[i] + u * (double)b[i1]);
}

/* Behind the last plane: every direction at the offset that is left, in one step. */
static double beyond_last_plane(
  const march* m, const chi_light_field* f, double plane, double x, double y)
{
  const chi_scene* const s = m->scene;
  const double shift =
    chi_scene_shift(s, chi_scene_depth(s, (double)s->slabs - 0.5), chi_scene_depth(s, plane + 0.5));
  double sum = 0;
  for (int k = 0; k < s->directions; ++k)
  {
    const double px = x + (double)s->tangent[0][k] * s->pixels_x * shift;
    const double py = y + (double)s->tangent[1][k] * s->pixels_y * shift;
    if (!(px > -1 && py > -1 && px < s->light_width && py < s->light_height))
    {
      sum += 1; /* from outside the picture */
      continue;
    }
    const int64_t i = (int64_t)floor(px), j = (int64_t)floor(py);
    const double u = px - (double)i, v = py - (double)j;
    const float* const a = row_of_light(m, f, s->slabs & 1, j) + i +
      (s->published ? 0 : (ptrdiff_t)k * (ptrdiff_t)m->light_stride);
    const float* const b = a + m->light_row;
    sum += (1 - v) * ((1 - u) * (double)a[0] + u * (double)a[1]) +
      v * ((1 - u) * (double)b[0] + u * (double)b[1]);
  }
  return sum / s->directions;
}

/* Visibility between planes at `plane`, before strength. */
static double visibility_at(
  const march* m, const chi_light_field* f, double plane, double x, double y)
{
  if (!(f->volume || f->geometry) || m->scene->slabs == 0 || plane <= -1)
  {
    return 1;
  }
  if (plane > (double)(m->scene->slabs - 1))
  {
    return beyond_last_plane(m, f, plane, x, y);
  }
  const double below = floor(plane), w = plane - below;
  const int64_t i = (int64_t)below;
  const double a = plane_at(m, f, i, x, y);
  return w > 0 ? (1 - w) * a + w * plane_at(m, f, i + 1, x, y) : a;
}

static double to_light(const chi_scene* s, double pixel)
{
  return pixel / s->scale - 0.5;
}

static void light_surface(const march* m, int64_t y, int64_t x)
{
  const chi_scene* const s = m->scene;
  const double plane = receiver_plane(s, (double)picture(m, SURFACE, y)[x]);
  const double v = visibility_at(m, &m->keep->field[m->surface_field], plane,
    to_light(s, (double)x + 0.5), to_light(s, (double)y + 0.5));
  picture(m, SURFACE_VISIBILITY, y)[x] = (float)(1 - (double)m->strength * (1 - v));
}

/* Surfaces of one light row whose planes are complete in this step. */
static void light_surfaces(const march* m, int64_t step, int64_t by)
{
  const chi_scene* const s = m->scene;
  for (int segment = 0; segment < m->segments; ++segment)
  {
    const float* const range = m->ranges + 4 * ((size_t)by * (size_t)m->segments + (size_t)segment);
    if (!(range[2] <= (float)step) || !(range[3] >= (float)step))
    {
      continue;
    }
    const int64_t x0 = (int64_t)segment * CHI_SEGMENT * s->scale;
    for (int64_t y = by * s->scale; y < (by + 1) * s->scale && y < s->height; ++y)
    {
      const float* const depth = picture(m, SURFACE, y);
      for (int64_t x = x0; x < x0 + CHI_SEGMENT * s->scale && x < s->width; ++x)
      {
        if (depth[x] < INFINITY && floor(receiver_plane(s, (double)depth[x])) + 2 == (double)step)
        {
          light_surface(m, y, x);
        }
      }
    }
  }
}

/* ---- probes -----------------------------------------------------------------------------------
 */

static double probe_plane(const march* m, size_t i)
{
  const chi_scene* const s = m->scene;
  return (m->frame->probes->position[3 * i + 2] - s->start) / s->slab - s->bias - 0.5;
}

static void read_probe(const march* m, size_t i)
{
  const double* const p = m->frame->probes->position + 3 * i;
  m->frame->probes->visibility[i] = (float)visibility_at(
    m, &m->keep->field[0], probe_plane(m, i), to_light(m->scene, p[0]), to_light(m->scene, p[1]));
}

/* Probes of rows [begin, end) that this step completes. */
static void read_probes(const march* m, int64_t step, int64_t begin, int64_t end)
{
  const chi_occlusion_probes* const probes = m->frame->probes;
  for (size_t i = 0; probes && i < probes->count; ++i)
  {
    const double row = floor(probes->position[3 * i + 1] / m->scene->scale);
    const double top = (double)m->scene->light_height - 1;
    const double y = row < 0 ? 0 : row > top ? top : row;
    if (y >= (double)begin && y < (double)end && floor(probe_plane(m, i)) + 2 == (double)step)
    {
      read_probe(m, i);
    }
  }
}

/* ---- samples ----------------------------------------------------------------------------------
 */

/* Visibility of a run of pixels in the middle of a segment, or NULL where all of it is 1. */
static const float* run_visibility(
  const march* m, int64_t slab, double slices, int64_t y, int x_begin, int x_end)
{
  const chi_scene* const s = m->scene;
  const chi_light_field* const f = &m->keep->field[0];
  if (!m->shaded || !(f->volume || f->geometry) || slab == 0)
  {
    return NULL;
  }
  double plane = receiver_plane(s, slices);
  plane = plane < (double)(slab - 1) ? plane : (double)(slab - 1);
  if (plane <= -1)
  {
    return NULL;
  }
  const int64_t first = (int64_t)floor(plane);
  const float w = (float)(plane - (double)first);
  int64_t rows[2] = { y, y };
  float v = 0;
  if (s->scale == 2)
  {
    rows[0] = y & 1 ? y >> 1 : (y >> 1) - 1;
    rows[1] = rows[0] + 1;
    v = y & 1 ? 0.25f : 0.75f;
    rows[0] = rows[0] > 0 ? rows[0] : 0;
    rows[1] = rows[1] < s->light_height ? rows[1] : s->light_height - 1;
  }
  const int seg0 = x_begin / s->scale / CHI_SEGMENT;
  int seg1 = (x_end - 1) / s->scale / CHI_SEGMENT + 1; /* one more: the right neighbour is read */
  seg1 = seg1 < m->segments ? seg1 : m->segments - 1;
  const float* source[4];
  float weight[4], base = 1 - m->strength;
  int dirty = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int64_t i = first + (k >> 1), row = rows[k & 1];
    weight[k] = m->strength * (k >> 1 ? w : 1 - w) * (k & 1 ? v : 1 - v);
    if (i < 0)
    {
      base += weight[k]; /* before the first plane all light arrives */
      weight[k] = 0;
    }
    const int64_t plane_read = i < 0 ? 0 : i < slab ? i : slab - 1;
    source[k] = visibility_row(m, f, plane_read, row);
    if (weight[k] > 0)
    {
      const uint8_t* const flags = dirty_row(m, f, 2 + ring_slot(m, plane_read), row);
      for (int segment = seg0 > 0 ? seg0 - 1 : 0; segment <= seg1; ++segment)
      {
        dirty |= flags[segment];
      }
    }
  }
  if (!dirty)
  {
    return NULL;
  }
  float* const out = picture(m, ROW_VISIBILITY, y);
  m->kernels->enlarge(source, weight, base, s->scale, x_begin, x_end, out);
  return out;
}

/* Common parts of a row between two slices. */
static void set_row(const march* m, chi_sample_row* row, int64_t y, int64_t segment)
{
  const chi_scene* const s = m->scene;
  const double far = s->start + (double)(segment + 1) * s->slice;
  for (int a = 0; a < 3; ++a)
  {
    const double across = (double)y * s->along_y[a];
    const double lateral = s->parallel ? 1 : far;
    row->position[a] = (float)(s->origin[a] + far * s->axis[a] + lateral * across);
    row->position_x[a] = (float)(lateral * s->along_x[a]);
    row->direction[a] = (float)(s->slice * (s->axis[a] + (s->parallel ? 0 : across)));
    row->direction_x[a] = (float)(s->parallel ? 0 : s->slice * s->along_x[a]);
  }
  const double py = s->slope_y + (double)y * s->slope_dy;
  row->length0 = (float)s->slope_x;
  row->length_x = (float)s->slope_dx;
  row->length_c = (float)(1 + py * py);
  row->near_slice = (float)segment;
  row->first = segment == s->volume_begin * s->group;
}

static void sample_row(march* m, int64_t slab, int64_t y, const uint8_t* need, chi_sample_row* row)
{
  const chi_scene* const s = m->scene;
  const int64_t block = slab / m->block;
  const uint8_t* const cells = m->cells + (block * m->cells_y + y / CHI_CELL_HEIGHT) * m->cells_x;
  const uint8_t* const live = m->live_row + y * m->cells_x;
  int64_t* const sampled = m->sampled + y * m->cells_x;
  uint8_t* const flags = m->tau_flag + y / s->scale * m->segments;
  const int width = (s->width + CHI_CELL_WIDTH - 1) / CHI_CELL_WIDTH * CHI_CELL_WIDTH;
  if (m->tau_stale[y])
  {
    memset(row->tau, 0, m->stride * sizeof(float));
    m->tau_stale[y] = 0;
  }
  for (int64_t i = 0; i < s->group; ++i)
  {
    const int64_t segment = slab * s->group + i;
    set_row(m, row, y, segment);
    for (int cx = 0; cx < m->cells_x;)
    {
      const int light = need[cx * CHI_CELL_WIDTH / s->scale / CHI_SEGMENT];
      if (cells[cx] == CELL_EMPTY || !(light || live[cx]))
      {
        if (cells[cx] != CELL_EMPTY)
        {
          row->skipped += CHI_CELL_WIDTH;
        }
        ++cx;
        continue;
      }
      /* A run of cells that are alike. */
      const int restart = sampled[cx] != segment - 1;
      int end = cx;
      while (end < m->cells_x && cells[end] == cells[cx] && live[end] == live[cx] &&
        (sampled[end] != segment - 1) == restart &&
        need[end * CHI_CELL_WIDTH / s->scale / CHI_SEGMENT] == light)
      {
        sampled[end++] = segment;
      }
      m->tau_stale[y] = 1;
      const int x0 = cx * CHI_CELL_WIDTH;
      const int x1 = end * CHI_CELL_WIDTH < width ? end * CHI_CELL_WIDTH : width;
      row->restart = restart;
      row->bricks = (cells[cx] & CELL_MIXED) != 0;
      row->enter = cells[cx] & CELL_CROSSES_BOX ? picture(m, ENTER, y) : NULL;
      row->leave = picture(m, LEAVE, y);
      row->surface = m->frame->surface ? picture(m, SURFACE, y) : NULL;
      row->saturated_too = light;
      row->visibility = live[cx] ? run_visibility(m, slab, (double)segment + 0.5, y, x0, x1) : NULL;
      row->any_tau = 0;
      m->kernels->sample(row, x0, x1);
      if (row->any_tau)
      {
        for (int k = cx; k < end; ++k)
        {
          flags[k * CHI_CELL_WIDTH / s->scale / CHI_SEGMENT] = 1;
        }
      }
      cx = end;
    }
  }
}

/* ---- light ------------------------------------------------------------------------------------
 */

static void fill_ones(float* out, int count)
{
  for (int i = 0; i < count; ++i)
  {
    out[i] = 1;
  }
}

static int source_is_dirty(
  const march* m, const chi_light_field* f, int64_t side, int64_t y, int segment)
{
  const int64_t low = y > m->skew ? y - m->skew : 0;
  const int64_t high =
    y + m->skew < m->scene->light_height ? y + m->skew : m->scene->light_height - 1;
  const int first = segment > m->shift_segments ? segment - m->shift_segments : 0;
  const int last =
    segment + m->shift_segments < m->segments ? segment + m->shift_segments : m->segments - 1;
  int dirty = 0;
  for (int64_t j = low; j <= high; ++j)
  {
    const uint8_t* const flags = dirty_row(m, f, side, j);
    for (int k = first; k <= last; ++k)
    {
      dirty |= flags[k];
    }
  }
  return dirty;
}

typedef struct light_counts
{
  int64_t updates, skipped;
} light_counts;

static void light_piece(march* m, chi_light_field* f, int64_t slab, int64_t y, int k, int needed,
  light_counts* counts)
{
  const chi_scene* const s = m->scene;
  const int64_t read = slab & 1, write = read ^ 1;
  const int x = k * CHI_SEGMENT;
  uint8_t* const target_dirty = dirty_row(m, f, write, y) + k;
  uint8_t* const seen_dirty = dirty_row(m, f, 2 + ring_slot(m, slab), y) + k;
  const int planes = s->published ? 1 : s->directions;
  const int64_t cost = (int64_t)s->directions * CHI_SEGMENT;
  float* const target = row_of_light(m, f, write, y) + x;
  float* const seen = visibility_row(m, f, slab, y) + x;
  float* const geometry = light_scratch(m, GEOMETRY, y) + x;
  if (!needed)
  {
    counts->skipped += cost;
    *target_dirty = *seen_dirty = 1; /* unknown, and nobody asks */
    return;
  }
  const int has_tau = f->volume && m->tau_flag[y * m->segments + k];
  const int blocked = f->geometry && block_light(m, slab, y, k, geometry);
  if (!m->keep_all && !has_tau && !blocked && !source_is_dirty(m, f, read, y, k))
  {
    counts->skipped += cost;
    for (int d = 0; d < planes && *target_dirty; ++d)
    {
      fill_ones(target + (size_t)d * m->light_stride, CHI_SEGMENT);
    }
    *target_dirty = 0;
    if (*seen_dirty)
    {
      fill_ones(seen - (k == 0), CHI_SEGMENT + (k == 0));
      *seen_dirty = 0;
    }
    return;
  }
  float length[CHI_MAX_DIRECTIONS], length_x[CHI_MAX_DIRECTIONS];
  if (has_tau)
  {
    static const float none[CHI_MAX_DIRECTIONS] = { 0 };
    const double center = (x + 0.5) * s->scale - 0.5, row = ((double)y + 0.5) * s->scale - 0.5;
    m->kernels->path_lengths(s->published ? none : s->tangent[0],
      s->published ? none : s->tangent[1], planes, (float)(s->slope_x + center * s->slope_dx),
      (float)(s->slope_y + row * s->slope_dy), (float)(s->slope_dx * s->scale), CHI_SEGMENT, length,
      length_x);
  }
  const float* const tau = s->scale == 1 ? picture(m, TAU, y) : light_scratch(m, LIGHT_TAU, y);
  const chi_light_segment segment = { .source = row_of_light(m, f, read, y) + x,
    .target = target,
    .plane = m->light_stride,
    .offset = m->steps[slab].offset,
    .weight = (const float(*)[4])m->steps[slab].weight,
    .stride = m->light_row,
    .directions = s->directions,
    .tau = has_tau ? tau + x : NULL,
    .length = length,
    .length_x = length_x,
    .geometry = blocked ? geometry : NULL,
    .visibility = seen };
  (s->published ? m->kernels->blur : m->kernels->light)(&segment);
  if (k == 0)
  {
    seen[-1] = seen[0]; /* the enlargement reads one pixel beyond the picture */
  }
  *target_dirty = *seen_dirty = 1;
  counts->updates += cost;
}

/* One slab's light for a band of rows; piece by piece, so that the rows of a piece, which share most of
 * what they read, follow each other while it is in the nearest cache. */
static void light_band(march* m, int64_t slab, const int64_t rows[2], const uint8_t* need, light_counts* counts)
{
  for (int k = 0; k < m->segments; ++k)
  {
    const int x = k * CHI_SEGMENT;
    for (int64_t y = rows[0]; y < rows[1] && m->scene->scale == 2; ++y)
    {
      if (m->tau_flag[y * m->segments + k])
      {
        m->kernels->halve(picture(m, TAU, 2 * y) + 2 * x, picture(m, TAU, 2 * y + 1) + 2 * x,
          m->scene->mean_length, light_scratch(m, LIGHT_TAU, y) + x, CHI_SEGMENT);
      }
    }
    for (int f = 0; f < m->fields; ++f)
    {
      for (int64_t y = rows[0]; y < rows[1]; ++y)
      {
        light_piece(m, &m->keep->field[f], slab, y, k, need[k], counts);
      }
    }
  }
  for (int64_t y = rows[0]; y < rows[1] && m->frame->surface; ++y)
  {
    light_surfaces(m, slab, y);
  }
  read_probes(m, slab, rows[0], rows[1]);
}

/* ---- tasks ------------------------------------------------------------------------------------
 */

/*
 * Whether light in this piece of a band can still matter: some piece, so near that light gets from
 * here to there in time, has rays that are not done and something left to meet. Of bands whose last
 * block may still be running, the state of an earlier block counts, a fixed one, so that the answer
 * does not depend on the schedule.
 */
static void find_need(march* m, int64_t block, int band, uint8_t* need)
{
  const int64_t slab = block * m->block;
  int64_t rows[2];
  band_rows(m, band, rows);
  for (int k = 0; k < m->segments; ++k)
  {
    need[k] = (uint8_t)(m->keep_all || m->frame->probes != NULL);
  }
  if (!m->fields)
  {
    memset(need, 0, (size_t)m->segments);
    return;
  }
  for (int other = 0; other < m->bands && !m->keep_all && !m->frame->probes; ++other)
  {
    const int64_t behind = other > band ? (other - band + m->lag - 1) / m->lag : 0;
    const int64_t known = block - 1 - behind;
    int64_t there[2];
    band_rows(m, other, there);
    const int64_t gap_y = there[0] >= rows[1] ? there[0] - rows[1] + 1
      : rows[0] >= there[1]                   ? rows[0] - there[1] + 1
                                              : 0;
    for (int k = 0; k < m->segments; ++k)
    {
      const int64_t* const pending = m->last_slab[(int64_t)other * m->segments + k];
      const int live = known < 0 || m->live[(known * m->bands + other) * m->segments + k];
      int64_t last = live ? pending[0] : -1;
      last = pending[1] > last ? pending[1] : last;
      if (last < slab)
      {
        continue;
      }
      /* What stands in the light planes now moves in this slab already. */
      const double reach = m->reach[last] - (slab > 0 ? m->reach[slab - 1] : 0);
      if ((double)gap_y > reach + 1)
      {
        continue;
      }
      const int spread =
        reach < CHI_SEGMENT * m->segments ? (int)(reach / CHI_SEGMENT) + 1 : m->segments;
      const int first = k > spread ? k - spread : 0;
      const int end = k + spread < m->segments ? k + spread : m->segments - 1;
      memset(need + first, 1, (size_t)(end - first + 1));
    }
  }
}

/* Which pieces still have rays to follow, after the band's last slab of a block. */
static void update_live(march* m, int64_t block, int band, int64_t slab, int64_t row0, int64_t row1)
{
  const chi_scene* const s = m->scene;
  uint8_t* const live = m->live + (block * m->bands + band) * m->segments;
  const float now = (float)((slab + 1) * s->group);
  memset(live, 0, (size_t)m->segments);
  for (int64_t y = row0 * s->scale; y < row1 * s->scale && y < s->height; ++y)
  {
    uint8_t* const row = m->live_row + y * m->cells_x;
    const float* const transmittance = picture(m, TRANSMITTANCE, y);
    const float* const surface = m->frame->surface ? picture(m, SURFACE, y) : NULL;
    for (int cx = 0; cx < m->cells_x; ++cx)
    {
      const int x0 = cx * CHI_CELL_WIDTH;
      const int x1 = x0 + CHI_CELL_WIDTH < s->width ? x0 + CHI_CELL_WIDTH : s->width;
      int any = m->keep_all;
      for (int x = x0; x < x1 && row[cx]; ++x)
      {
        any |= transmittance[x] > m->sample.saturated && (!surface || surface[x] > now);
      }
      row[cx] = (uint8_t)any;
      live[x0 / s->scale / CHI_SEGMENT] |= (uint8_t)any;
    }
  }
}

static void run_task(march* m, int64_t block, int band)
{
  const chi_scene* const s = m->scene;
  uint8_t* const need = m->need + (int64_t)band * m->segments;
  chi_sample_row row = { .frame = &m->sample };
  light_counts counts = { 0, 0 };
  double seconds[2] = { 0, 0 };
  find_need(m, block, band, need);
  int64_t slab = block * m->block, row0 = 0, row1 = 0;
  const int64_t end = slab + m->block < s->slabs ? slab + m->block : s->slabs;
  for (int64_t j = 0; slab < end; ++slab, ++j)
  {
    row0 = (int64_t)band * BAND - (int64_t)m->skew * j;
    row1 = row0 + BAND;
    row0 = row0 > 0 ? row0 : 0;
    row1 = row1 < s->light_height ? row1 : s->light_height;
    if (row0 >= row1)
    {
      continue;
    }
    const double t0 = chi_seconds();
    memset(m->tau_flag + row0 * m->segments, 0, (size_t)((row1 - row0) * m->segments));
    const int has_samples = slab >= s->volume_begin && slab < s->volume_end;
    for (int64_t y = row0 * s->scale; has_samples && y < row1 * s->scale && y < s->height; ++y)
    {
      for (int c = 0; c < 3; ++c)
      {
        row.color[c] = picture(m, RED + c, y);
      }
      row.transmittance = picture(m, TRANSMITTANCE, y);
      row.table_position = picture(m, TABLE_POSITION, y);
      row.sum = (int32_t*)(void*)picture(m, SUM, y);
      row.rest = picture(m, REST, y);
      row.tau = picture(m, TAU, y);
      sample_row(m, slab, y, need, &row);
    }
    const double t1 = chi_seconds();
    seconds[0] += t1 - t0;
    if (!m->fields)
    {
      continue;
    }
    const int64_t rows[2] = { row0, row1 };
    light_band(m, slab, rows, need, &counts);
    seconds[1] += chi_seconds() - t1;
  }
  if (row0 < row1)
  {
    update_live(m, block, band, slab - 1, row0, row1);
  }
  atomic_fetch_add(&m->samples, row.taken);
  atomic_fetch_add(&m->skipped_samples, row.skipped);
  atomic_fetch_add(&m->light_updates, counts.updates);
  atomic_fetch_add(&m->skipped_light, counts.skipped);
  atomic_fetch_add(&m->nanoseconds[0], (long long)(1e9 * seconds[0]));
  atomic_fetch_add(&m->nanoseconds[1], (long long)(1e9 * seconds[1]));
}

static void wait_for(march* m, int64_t block, int band)
{
  if (block < 0 || band < 0)
  {
    return;
  }
  band = band < m->bands ? band : m->bands - 1;
  atomic_uchar* const flag = m->done + block * m->bands + band;
  for (int spins = 0; !atomic_load_explicit(flag, memory_order_acquire); ++spins)
  {
    if (spins > 256)
    {
      CHI_YIELD();
    }
  }
}

static void run_tickets(void* data, size_t begin, size_t end)
{
  march* const m = (march*)data;
  for (size_t i = begin; i < end; ++i)
  {
    const size_t ticket = atomic_fetch_add(&m->ticket, 1);
    const int64_t block = m->order[2 * ticket];
    const int band = (int)m->order[2 * ticket + 1];
    wait_for(m, block, band - 1);
    wait_for(m, block - 1, band + m->lag);
    if (!atomic_load(&m->cancelled))
    {
      if (chi_is_cancelled(m->exec))
      {
        atomic_store(&m->cancelled, 1);
      }
      else
      {
        run_task(m, block, band);
      }
    }
    atomic_store_explicit(m->done + block * m->bands + band, 1, memory_order_release);
  }
}

/* What no step of the march could serve: surfaces and probes at the last plane and behind it. */
static void light_rest(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const chi_scene* const s = m->scene;
  for (size_t y = begin; y < end && !chi_is_cancelled(m->exec); ++y)
  {
    const float* const depth = picture(m, SURFACE, (int64_t)y);
    for (int64_t x = 0; x < s->width; ++x)
    {
      if (depth[x] < INFINITY && floor(receiver_plane(s, (double)depth[x])) + 2 >= (double)s->slabs)
      {
        light_surface(m, (int64_t)y, x);
      }
    }
  }
}

/* ---- set-up -----------------------------------------------------------------------------------
 */

static size_t round_up(size_t x, size_t to)
{
  return (x + to - 1) / to * to;
}

static void plan_steps(march* m)
{
  const chi_scene* const s = m->scene;
  m->reach[0] = 0;
  for (int64_t g = 0; g < s->slabs; ++g)
  {
    const double shift = g == 0 ? 0
                                : chi_scene_shift(s, chi_scene_depth(s, (double)g - 0.5),
                                    chi_scene_depth(s, (double)g + 0.5));
    double reach = 0;
    for (int k = 0; k < s->directions; ++k)
    {
      /* Farther than the picture is wide, light comes from outside: the padding is that wide. */
      const double wide = s->light_width + 1, high = s->light_height + 1;
      const double dx = fmin(fmax((double)s->tangent[0][k] * s->pixels_x * shift, -wide), wide);
      const double dy = fmin(fmax((double)s->tangent[1][k] * s->pixels_y * shift, -high), high);
      const double i = floor(dx), j = floor(dy), u = dx - i, v = dy - j;
      float* const w = m->steps[g].weight[k];
      m->steps[g].offset[k] = (ptrdiff_t)j * (ptrdiff_t)m->light_row + (ptrdiff_t)i;
      w[0] = (float)((1 - u) * (1 - v));
      w[1] = (float)(u * (1 - v));
      w[2] = (float)((1 - u) * v);
      w[3] = (float)(u * v);
      reach = fmax(reach, fmax(ceil(fabs(dx)), ceil(fabs(dy))));
    }
    m->reach[g] = (g ? m->reach[g - 1] : 0) + reach;
  }
  m->reach[s->slabs] = INFINITY; /* receivers behind the last plane look anywhere */
}

/* Rows and columns that light crosses in the widest step. */
static void widest_step(const chi_scene* s, double* columns, double* rows)
{
  double slope_x = 0, slope_y = 0, shift = 0;
  for (int k = 0; k < s->directions; ++k)
  {
    slope_x = fmax(slope_x, fabs((double)s->tangent[0][k]));
    slope_y = fmax(slope_y, fabs((double)s->tangent[1][k]));
  }
  if (s->slabs > 1)
  {
    shift =
      chi_scene_shift(s, chi_scene_depth(s, 0.5), chi_scene_depth(s, 1.5)); /* nearest = widest */
  }
  *columns = fmin(ceil(slope_x * s->pixels_x * shift), s->light_width + 1);
  *rows = fmax(1, fmin(ceil(slope_y * s->pixels_y * shift), s->light_height + 1));
}

static void plan_order(march* m)
{
  int64_t* next = m->order;
  const int64_t diagonals = (m->blocks - 1) * (m->lag + 1) + m->bands;
  for (int64_t d = 0; d < diagonals; ++d)
  {
    for (int64_t block = d / (m->lag + 1) < m->blocks - 1 ? d / (m->lag + 1) : m->blocks - 1;
         block >= 0; --block)
    {
      const int64_t band = d - block * (m->lag + 1);
      if (band >= m->bands)
      {
        break;
      }
      *next++ = block;
      *next++ = band;
    }
  }
}

static void fill_field(void* data, size_t begin, size_t end)
{
  float* const out = (float*)data;
  for (size_t i = begin; i < end; ++i)
  {
    fill_ones(out + i * 4096, 4096);
  }
}

/* Light from outside everywhere. */
static chi_status clear_field(march* m, chi_light_field* f, size_t light_floats)
{
  const size_t floats[3] = { light_floats, light_floats, (size_t)m->ring * m->light_plane };
  chi_buffer* const buffer[3] = { &f->light[0], &f->light[1], &f->visibility };
  for (int k = 0; k < 3; ++k)
  {
    /* Slack of a segment: the last row's overhang. */
    const size_t count = round_up(floats[k] + CHI_SEGMENT, 4096);
    if (!chi_buffer_reserve(m->exec, buffer[k], count, sizeof(float)))
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    const chi_status status = chi_for(m->exec, count / 4096, fill_field, buffer[k]->data);
    if (status != CHI_OK)
    {
      return status;
    }
  }
  const size_t flags = (size_t)(2 + m->ring) * (size_t)m->scene->light_height * (size_t)m->segments;
  if (!chi_buffer_reserve(m->exec, &f->dirty, flags, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(f->dirty.data, 0, flags);
  return CHI_OK;
}

static chi_status plan_fields(march* m)
{
  const int bits = m->frame->params->interactions;
  chi_light_field* const f = m->keep->field;
  const int has_volume = m->frame->volume != NULL, has_surface = m->frame->surface != NULL;
  const int to_volume[2] = { (bits & CHI_VOLUME_TO_VOLUME) && has_volume,
    (bits & CHI_GEOMETRY_TO_VOLUME) && has_surface };
  const int to_surface[2] = { (bits & CHI_VOLUME_TO_GEOMETRY) && has_volume,
    (bits & CHI_GEOMETRY_TO_GEOMETRY) && has_surface };
  m->fields = 0;
  m->surface_field = 0;
  f[0].volume = to_volume[0];
  f[0].geometry = to_volume[1];
  f[1].volume = f[1].geometry = 0;
  if (!(m->strength > 0) && !m->frame->probes)
  {
    f[0].volume = f[0].geometry = 0;
    return CHI_OK;
  }
  m->fields = f[0].volume || f[0].geometry;
  if (has_surface && (to_surface[0] != to_volume[0] || to_surface[1] != to_volume[1]))
  {
    f[1].volume = to_surface[0];
    f[1].geometry = to_surface[1];
    m->surface_field = 1;
    m->fields = f[1].volume || f[1].geometry ? 2 : m->fields;
  }
  return CHI_OK;
}

static chi_status reserve(march* m)
{
  const chi_exec* const exec = m->exec;
  const chi_scene* const s = m->scene;
  chi_march* const keep = m->keep;
  const size_t segments = (size_t)m->segments, bands = (size_t)m->bands;
  const size_t blocks = (size_t)m->blocks, cells = (size_t)m->cells_x,
               light_rows = (size_t)s->light_height;
  const size_t slabs = (size_t)s->slabs;
  if (!chi_buffer_reserve(exec, &keep->planes, PICTURE_PLANES * m->plane + 64, sizeof(float)) ||
    !chi_buffer_reserve(
      exec, &keep->scratch, LIGHT_PLANES * light_rows * m->light_stride + 64, sizeof(float)) ||
    !chi_buffer_reserve(exec, &keep->cells, blocks * (size_t)m->cells_y * cells + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->last_slab, bands * segments, 2 * sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->live,
      blocks * bands * segments + light_rows * segments + bands * segments + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->live_row, m->rows * (cells + 1), 1) ||
    !chi_buffer_reserve(exec, &keep->sampled, m->rows * cells, sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->done, blocks * bands + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->order, blocks * bands + 1, 2 * sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->reach, slabs + 1, sizeof(double)) ||
    !chi_buffer_reserve(exec, &keep->steps, slabs + 1, sizeof(light_step)) ||
    !chi_buffer_reserve(exec, &keep->ranges, light_rows * segments, 4 * sizeof(float)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  m->planes = (float*)keep->planes.data;
  m->scratch = (float*)keep->scratch.data;
  m->cells = (uint8_t*)keep->cells.data;
  m->last_slab = (int64_t(*)[2])keep->last_slab.data;
  m->live = (uint8_t*)keep->live.data;
  m->tau_flag = m->live + blocks * bands * segments;
  m->need = m->tau_flag + light_rows * segments;
  m->live_row = (uint8_t*)keep->live_row.data;
  m->tau_stale = m->live_row + m->rows * cells;
  m->sampled = (int64_t*)keep->sampled.data;
  m->done = (atomic_uchar*)keep->done.data;
  m->order = (int64_t*)keep->order.data;
  m->reach = (double*)keep->reach.data;
  m->steps = (light_step*)keep->steps.data;
  m->ranges = (float*)keep->ranges.data;
  memset(keep->done.data, 0, blocks * bands);
  memset(m->live_row, 1, m->rows * cells);
  memset(m->tau_stale, 0, m->rows);
  for (size_t i = 0; i < m->rows * cells; ++i)
  {
    m->sampled[i] = -2;
  }
  return CHI_OK;
}

static void clear_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  for (size_t y = begin; y < end; ++y)
  {
    for (int c = 0; c < 3; ++c)
    {
      memset(picture(m, RED + c, (int64_t)y), 0, m->stride * sizeof(float));
    }
    memset(picture(m, TAU, (int64_t)y), 0, m->stride * sizeof(float));
    fill_ones(picture(m, TRANSMITTANCE, (int64_t)y), (int)m->stride);
    fill_ones(picture(m, SURFACE_VISIBILITY, (int64_t)y), (int)m->stride);
  }
}

static void set_sample_frame(march* m)
{
  chi_sample_frame* const f = &m->sample;
  /* Rays end at alpha 0.998 (issue's figure: what is left is half a step of 255). */
  f->saturated = m->keep_all ? 0 : 0.002f;
  if (!m->frame->volume)
  {
    return;
  }
  const chi_bricks* const b = m->bricks;
  const chi_classification* const c = m->classification;
  const size_t* const n = b->dimensions;
  f->scalars = b->scalars;
  f->fetch = b->fetch;
  f->nearest = b->nearest;
  f->step_x = n[0] > 1;
  f->step_y = n[1] > 1 ? (int32_t)n[0] : 0;
  f->step_z = n[2] > 1 ? (int32_t)(n[0] * n[1]) : 0;
  const size_t samples = n[0] * n[1] * n[2];
  f->last_load = (int32_t)(b->fetch == CHI_FETCH_U8 ? samples - 4
      : b->fetch == CHI_FETCH_F32                   ? samples - 1
                                                    : samples - 2);
  for (int a = 0; a < 3; ++a)
  {
    f->last_cell[a] = n[a] > 1 ? (int32_t)n[a] - 2 : 0;
    f->last_index[a] = (float)(n[a] - 1);
  }
  f->base = c->base;
  f->scale = c->scale;
  f->offset = c->offset;
  f->table_end = (float)(c->entries - 1);
  f->sigma = (const chi_sigma_entry*)c->sigma.data;
  f->rgba = (const float(*)[4])c->rgba.data;
  f->quantum = c->quantum;
  f->occupied = (const uint8_t*)c->occupied.data;
  f->brick_step_y = (int32_t)b->count[0];
  f->brick_step_z = (int32_t)(b->count[0] * b->count[1]);
  f->slice = (float)m->scene->slice;
}

static void store_rows(void* data, size_t begin, size_t end)
{
  const march* const m = ((march* const*)data)[0];
  float* const rgba = ((float* const*)data)[1];
  float* const visibility = ((float* const*)data)[2];
  const size_t width = (size_t)m->scene->width;
  for (size_t y = begin; y < end; ++y)
  {
    const float* const transmittance = picture(m, TRANSMITTANCE, (int64_t)y);
    for (int c = 0; c < 3; ++c)
    {
      const float* const color = picture(m, RED + c, (int64_t)y);
      for (size_t x = 0; x < width; ++x)
      {
        rgba[4 * (y * width + x) + (size_t)c] = color[x];
      }
    }
    for (size_t x = 0; x < width; ++x)
    {
      rgba[4 * (y * width + x) + 3] = 1 - transmittance[x];
    }
    memcpy(
      visibility + y * width, picture(m, SURFACE_VISIBILITY, (int64_t)y), width * sizeof(float));
  }
}

static void plan_layout(march* m)
{
  const chi_scene* const s = m->scene;
  double columns, rows;
  widest_step(s, &columns, &rows);
  m->stride = round_up((size_t)s->width + CHI_CELL_WIDTH, 64);
  m->rows = round_up((size_t)s->height, (size_t)s->scale);
  m->plane = m->rows * m->stride;
  m->cells_x = (s->width - 1) / CHI_CELL_WIDTH + 1;
  m->cells_y = (int)((m->rows - 1) / CHI_CELL_HEIGHT) + 1;
  m->segments = (s->light_width - 1) / CHI_SEGMENT + 1;
  m->skew = (int)rows;
  m->shift_segments = (int)(columns / CHI_SEGMENT) + 1;
  m->block = 16 / m->skew < 1 ? 1 : 16 / m->skew < MAX_BLOCK ? 16 / m->skew : MAX_BLOCK;
  m->blocks = (s->slabs + m->block - 1) / m->block;
  m->bands = (s->light_height + m->skew * (m->block - 1) - 1) / BAND + 1;
  m->lag = (m->skew * m->block + BAND - 1) / BAND;
  const size_t pad_x = (size_t)columns + 2, pad_y = (size_t)rows + 2;
  m->light_stride = round_up(round_up((size_t)s->light_width, CHI_SEGMENT) + 2 * pad_x, 16) + 16;
  m->light_plane = ((size_t)s->light_height + 2 * pad_y) * m->light_stride;
  m->visibility_origin = pad_y * m->light_stride + pad_x;
  m->light_row = m->light_stride * (s->published ? 1 : (size_t)s->directions);
  m->light_origin = pad_y * m->light_row + pad_x;
  m->ring = (int64_t)ceil(s->bias) + 4;
  m->ring = m->ring < s->slabs + 2 ? m->ring : s->slabs + 2;
}

chi_status chi_march_run(const chi_exec* exec, chi_march* keep, const chi_scene* scene,
  const chi_bricks* bricks, const chi_classification* classification,
  const chi_occlusion_frame* frame, float* rgba, float* visibility, chi_march_result* result)
{
  march m = { .exec = exec,
    .scene = scene,
    .frame = frame,
    .kernels = chi_kernels(),
    .keep = keep,
    .bricks = bricks,
    .classification = classification,
    .keep_all = !frame->params->skip,
    .strength = (float)frame->params->strength };
  const double t0 = chi_seconds();
  plan_layout(&m);
  m.shaded = m.strength > 0;
  chi_status status = reserve(&m);
  if (status == CHI_OK)
  {
    status = plan_fields(&m);
  }
  const size_t light_planes = scene->published ? 1 : (size_t)scene->directions;
  for (int f = 0; f < m.fields && status == CHI_OK; ++f)
  {
    status = clear_field(&m, &keep->field[f], light_planes * m.light_plane);
  }
  if (status == CHI_OK)
  {
    set_sample_frame(&m);
    plan_steps(&m);
    status = chi_for(exec, m.rows, clear_rows, &m);
  }
  if (status == CHI_OK && frame->volume)
  {
    status = chi_for(exec, (size_t)scene->height, intersect_rows, &m);
  }
  if (status == CHI_OK && frame->surface)
  {
    status = chi_surface_intervals(exec, scene, frame->surface, frame->params->geometry_thickness,
      PICTURE_PLANES * m.stride, m.stride, picture(&m, SURFACE, 0), picture(&m, BLOCK_BEGIN, 0), picture(&m, BLOCK_END, 0));
    if (status == CHI_OK)
    {
      status = chi_for(exec, (size_t)scene->light_height, gather_ranges, &m);
    }
  }
  if (status == CHI_OK && m.blocks > 0)
  {
    status = chi_for(exec, (size_t)(m.blocks * m.cells_y), classify_blocks, &m);
  }
  const double t1 = chi_seconds();
  result->seconds_visible_set = t1 - t0;
  if (status == CHI_OK && m.blocks > 0)
  {
    for (int band = 0; band < m.bands; ++band)
    {
      for (int k = 0; k < m.segments; ++k)
      {
        find_last_slab(&m, band, k, m.last_slab[band * m.segments + k]);
      }
    }
    plan_order(&m);
    status = chi_for(exec, (size_t)(m.blocks * m.bands), run_tickets, &m);
  }
  if (status == CHI_OK && frame->surface)
  {
    status = chi_for(exec, (size_t)scene->height, light_rest, &m);
  }
  for (size_t i = 0; status == CHI_OK && frame->probes && i < frame->probes->count; ++i)
  {
    const double plane = probe_plane(&m, i);
    if (plane <= -1 || floor(plane) + 2 >= (double)scene->slabs)
    {
      read_probe(&m, i);
    }
  }
  if (status == CHI_OK)
  {
    void* outputs[3] = { &m, rgba, visibility };
    status = chi_for(exec, (size_t)scene->height, store_rows, outputs);
  }
  result->seconds_slices = chi_seconds() - t1;
  result->samples = m.samples;
  result->skipped_samples = m.skipped_samples + m.empty_samples;
  result->light_updates = m.light_updates;
  result->skipped_light_updates = m.skipped_light;
  result->seconds_samples = 1e-9 * (double)m.nanoseconds[0];
  result->seconds_light = 1e-9 * (double)m.nanoseconds[1];
  return status;
}

void chi_march_free(const chi_exec* exec, chi_march* keep)
{
  chi_buffer* const all[] = { &keep->planes, &keep->cells, &keep->last_slab, &keep->live,
    &keep->live_row, &keep->sampled, &keep->done, &keep->order, &keep->reach, &keep->steps,
    &keep->ranges, &keep->scratch };
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
  {
    chi_buffer_free(exec, all[i]);
  }
  for (int f = 0; f < 2; ++f)
  {
    chi_buffer_free(exec, &keep->field[f].light[0]);
    chi_buffer_free(exec, &keep->field[f].light[1]);
    chi_buffer_free(exec, &keep->field[f].visibility);
    chi_buffer_free(exec, &keep->field[f].dirty);
  }
}
