/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#include "chi_tet_kernels.h"

#include <math.h>

#include "chi_tet_setup.inl"

#include "chi_tet_fragments.inl"

#include "chi_segment.inl"

#include "chi_tet_ranges.inl"

/* What differs from frame to frame, so that each combination has code of its own. */
typedef struct variant
{
  int parallel, separate, cuts, picking, method, shaded, direct, lit, projected;
} variant;

enum
{
  METHOD_MAXIMUM = 16 /* beside CHI_PREINTEGRATION_... */
};

#include "chi_tet_slab.inl"

#include "chi_tet_blend.inl"

/* Rows of a box that is at most as wide as a vector, as many as fit into one: pixels from the
 * first. */
typedef struct narrow_boxes
{
  float x[CHI_LANES + 1][CHI_LANES], y[CHI_LANES + 1][CHI_LANES];
  int32_t pixel[CHI_LANES + 1][CHI_LANES];
  int32_t rows[CHI_LANES + 1];
} narrow_boxes;

static void make_narrow_boxes(narrow_boxes* boxes)
{
  for (int width = 1; width <= CHI_LANES; ++width)
  {
    boxes->rows[width] = CHI_LANES / width;
    for (int i = 0; i < CHI_LANES; ++i)
    {
      const int x = i % width, y = i / width;
      boxes->x[width][i] = (float)x;
      /* lanes beyond the last whole row belong to no row that a box has */
      boxes->y[width][i] = y < boxes->rows[width] ? (float)y : 2.0f * CHI_TET_TILE;
      boxes->pixel[width][i] = y < boxes->rows[width] ? (y << CHI_TET_TILE_SHIFT) + x : 0;
    }
  }
}

/* Where in its box a tetrahedron is being drawn. */
typedef struct cursor
{
  int32_t row;
  int32_t spans_row; /* first row of `first` and `last`; -1: none */
  int32_t first[CHI_LANES], last[CHI_LANES];
} cursor;

/* The pixels of CHI_LANES rows that the projected edges enclose. */
CHI_INLINE void find_spans(const batch* r, int lane, cursor* at)
{
  const int32_t x0 = r->x0[lane], x1 = r->x1[lane];
  if (r->state[lane] & SPREAD)
  {
    vi_store(at->first, vi_set(x0));
    vi_store(at->last, vi_set(x1));
    return;
  }
  const vf row = vf_iota() + (float)(r->y0[lane] + at->row);
  vf left = vf_set(1e9f), right = vf_set(-1e9f);
  for (int e = 0; e < 6; ++e)
  {
    const vi meets = (row >= r->edge_low[e][lane]) & (row <= r->edge_high[e][lane]);
    const vf x = row * r->edge_slope[e][lane] + r->edge_x[e][lane];
    left = vf_select(meets, vf_min(left, x), left);
    right = vf_select(meets, vf_max(right, x), right);
  }
  /* twice the margin: the slope carries that of the row */
  const vf l = vf_max(left - 4 * MARGIN, vf_set((float)x0));
  const vf h = vf_min(right + 4 * MARGIN, vf_set((float)x1));
  const vi li = vf_int(vf_min(l, vf_set(CHI_TET_TILE)));
  vi_store(at->first, li - (vi_float(li) < l));
  vi_store(at->last, vf_int(vf_max(h, vf_set(-1)) + 1.0f) - 1);
}

/* Goes on with a tetrahedron until it is done, or the fragments fill their buffer: 0 then. */
CHI_INLINE int go_on(tile_state* t, int lane, cursor* at, const narrow_boxes* boxes,
  const uint8_t* marked, const variant u)
{
  const batch* const r = &t->r;
  const int32_t x0 = r->x0[lane], y0 = r->y0[lane];
  const int32_t width = r->x1[lane] - x0 + 1, height = r->y1[lane] - y0 + 1;
  const int32_t start = (y0 << CHI_TET_TILE_SHIFT) + x0;
  if (width <= CHI_LANES)
  {
    const vf x = vf_load(boxes->x[width]), y = vf_load(boxes->y[width]);
    const vi pixel = vi_load(boxes->pixel[width]) + start;
    for (; at->row < height; at->row += boxes->rows[width])
    {
      if (t->f.count > FRAGMENTS - CHI_LANES)
      {
        return 0;
      }
      const vf row = y + (float)at->row;
      evaluate(t, lane, x, row, pixel + (at->row << CHI_TET_TILE_SHIFT), row < (float)height,
        u.parallel, u.separate, u.direct, u.cuts, u.picking, u.lit, u.picking | u.shaded, marked);
    }
    return 1;
  }
  for (; at->row < height; ++at->row)
  {
    if (t->f.count > FRAGMENTS - CHI_TET_TILE)
    {
      return 0;
    }
    if (at->spans_row < 0 || at->row >= at->spans_row + CHI_LANES)
    {
      at->spans_row = at->row;
      find_spans(r, lane, at);
    }
    const int32_t first = at->first[at->row - at->spans_row];
    const int32_t last = at->last[at->row - at->spans_row];
    for (int32_t i = first; i <= last; i += CHI_LANES)
    {
      const vf x = vf_iota() + (float)(i - x0);
      const vi in_row = vf_int(vf_iota()) + i;
      const vi wanted = in_row <= last;
      /* beyond the row's end any pixel of the tile will do */
      const vi pixel = (in_row & wanted) + ((y0 + at->row) << CHI_TET_TILE_SHIFT);
      evaluate(t, lane, x, vf_set((float)at->row), pixel, wanted, u.parallel, u.separate, u.direct,
        u.cuts, u.picking, u.lit, u.picking | u.shaded, marked);
    }
  }
  return 1;
}

/* The end of a projector's pipe. */
typedef struct tile_sink
{
  chi_tet_sink sink;
  tile_state* tile;
  variant variant;
} tile_sink;

static void put(chi_tet_sink* sink, uint32_t tetrahedron, const chi_tet_fragment* from)
{
  tile_sink* const it = (tile_sink*)sink;
  fragments* const f = &it->tile->f;
  if (f->count == FRAGMENTS)
  {
    consume(it->tile, it->variant);
  }
  const size_t i = f->count++;
  f->pixel[i] = from->pixel;
  f->length[i] = from->length;
  f->x0[i] = from->value[0][0];
  f->x1[i] = from->value[0][1];
  f->y0[i] = from->value[1][0];
  f->y1[i] = from->value[1][1];
  for (int k = 0; k < 3 && it->variant.direct; ++k)
  {
    it->tile->colors[0][k][i] = from->value[CHI_TET_COLORS + k][0];
    it->tile->colors[1][k][i] = from->value[CHI_TET_COLORS + k][1];
  }
  f->id[i] = tetrahedron;
}

static void settle(chi_tet_sink* sink)
{
  tile_sink* const it = (tile_sink*)sink;
  consume(it->tile, it->variant);
}

static __attribute__((noinline)) int project(tile_state* t, uint32_t tetrahedron, const variant u)
{
  const int32_t tile[2] = { t->x, t->y };
  chi_tet_projector* const projector = t->target->projector;
  tile_sink sink = { { put, settle }, t, u };
  return projector->draw(projector, t->scene, tetrahedron, tile, &sink.sink);
}

CHI_INLINE void draw_batch(tile_state* t, int n, const narrow_boxes* boxes, const variant u)
{
  batch* const r = &t->r;
  for (int o = 0; o < CHI_LANES && o < n; o += HALF_LANES)
  {
    set_up(r, o, t->scene, t->x, t->y, u.parallel, u.separate, u.direct);
  }
  t->tally->tetrahedra += n;
  for (int lane = 0; lane < n; ++lane)
  {
    const uint8_t* marked = NULL;
    if (u.projected)
    {
      const int rest = project(t, r->id[lane], u);
      marked = rest == CHI_TET_REST_UNMARKED ? t->target->projector->marked : NULL;
      if (rest == CHI_TET_REST_NONE)
      {
        continue;
      }
    }
    if (r->x1[lane] < r->x0[lane] || r->y1[lane] < r->y0[lane])
    {
      continue;
    }
    if (r->state[lane] & FLAT)
    {
      ++t->tally->flat;
      continue;
    }
    if (r->state[lane] & DELICATE_CELL)
    {
      ++t->tally->delicate;
      make_faces(t, lane);
    }
    cursor at;
    at.row = 0;
    at.spans_row = -1;
    while (!go_on(t, lane, &at, boxes, marked, u))
    {
      consume(t, u);
    }
  }
}

static int is_saturated(const float* rgba, float stop)
{
  for (size_t i = 3; i < 4 * CHI_TET_TILE_PIXELS; i += 4)
  {
    if (rgba[i] > stop)
    {
      return 0;
    }
  }
  return 1;
}

CHI_INLINE void draw_tile(const chi_tet_scene* scene, const uint64_t* list, size_t count,
  int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally, const variant u)
{
  tile_state t;
  narrow_boxes boxes;
  make_narrow_boxes(&boxes);
#if defined(CHI_VEC_AVX2)
  for (uint32_t mask = 0; mask < 256; ++mask)
  {
    int shift = 0;
    t.lanes[mask] = 0;
    for (uint64_t lane = 0; lane < 8; ++lane)
    {
      if (mask >> lane & 1)
      {
        t.lanes[mask] |= lane << shift;
        shift += 8;
      }
    }
  }
#endif
  t.scene = scene;
  t.x = tile_x;
  t.y = tile_y;
  t.left = scene->first[0] + scene->step[0] * tile_x;
  t.bottom = scene->first[1] + scene->step[1] * tile_y;
  t.f.count = 0;
  t.target = target;
  t.tally = tally;
  for (size_t k = 0; k < scene->plane_count; ++k)
  {
    const double* const p = scene->planes + 4 * k;
    t.plane[k][0] = (float)((scene->parallel ? -p[0] : p[0]) * scene->step[0]);
    t.plane[k][1] = (float)((scene->parallel ? -p[1] : p[1]) * scene->step[1]);
    t.plane[k][2] = (float)(scene->parallel ? -(p[0] * t.left + p[1] * t.bottom + p[3])
                                            : p[0] * t.left + p[1] * t.bottom + p[2]);
    t.plane[k][3] = (float)(scene->parallel ? p[2] : -p[3]);
  }
  const size_t check = 64 * CHI_LANES; /* how often to look whether all is opaque: cheap enough */
  for (size_t done = 0; done < count; done += CHI_LANES)
  {
    const size_t left = count - done;
    const int n = left < CHI_LANES ? (int)left : CHI_LANES;
    for (int i = 0; i < CHI_LANES; ++i)
    {
      t.r.id[i] = (uint32_t)list[left - 1 - (size_t)(i < n ? i : n - 1)];
    }
    for (int i = 0; i < CHI_LANES; ++i) /* the next batch's points, and the vertices of one later */
    {
      const size_t next = (size_t)(CHI_LANES + i), later = (size_t)(3 * CHI_LANES + i);
      if (next < left)
      {
        const uint32_t* const v = scene->vertices + 4 * (size_t)(uint32_t)list[left - 1 - next];
        for (int c = 0; c < 4; ++c)
        {
          __builtin_prefetch(scene->points + v[c]);
        }
      }
      if (later < left)
      {
        __builtin_prefetch(scene->vertices + 4 * (size_t)(uint32_t)list[left - 1 - later]);
      }
    }
    draw_batch(&t, n, &boxes, u);
    if (target->stop > 0 && done % check == 0 && done > 0)
    {
      consume(&t, u);
      if (is_saturated(target->rgba, target->stop))
      {
        tally->saturated += (int64_t)(left - (size_t)n);
        return;
      }
    }
  }
  consume(&t, u);
}

#define CHI_DRAW(name, parallel, separate, cuts, method, lit)                                      \
  static __attribute__((noinline)) void name(const chi_tet_scene* scene, const uint64_t* list,     \
    size_t count, int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)    \
  {                                                                                                \
    draw_tile(scene, list, count, tile_x, tile_y, target, tally,                                   \
      (variant){ parallel, separate, cuts, 0, method, 0, 0, lit, 0 });                             \
  }
CHI_DRAW(draw_none, 0, 0, 0, CHI_PREINTEGRATION_NONE, 0)
CHI_DRAW(draw_partial, 0, 0, 0, CHI_PREINTEGRATION_PARTIAL, 0)
CHI_DRAW(draw_full, 0, 0, 0, CHI_PREINTEGRATION_FULL, 0)
CHI_DRAW(draw_partial_cut, 0, 0, 1, CHI_PREINTEGRATION_PARTIAL, 0)
CHI_DRAW(draw_full_cut, 0, 0, 1, CHI_PREINTEGRATION_FULL, 0)
CHI_DRAW(draw_partial_lit, 0, 0, 1, CHI_PREINTEGRATION_PARTIAL, 1)
CHI_DRAW(draw_full_lit, 0, 0, 1, CHI_PREINTEGRATION_FULL, 1)

/* Everything that is rarer, by one code. */
static __attribute__((noinline)) void draw_any(const chi_tet_scene* scene, const uint64_t* list,
  size_t count, int32_t tile_x, int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)
{
  const variant u = { scene->parallel, scene->separate,
    scene->depth || scene->plane_count || scene->limited, target->pick_alpha != NULL,
    scene->maximum ? METHOD_MAXIMUM : scene->tables->method, scene->shades != NULL,
    scene->colors != NULL, target->light[0] != NULL, target->projector != NULL };
  draw_tile(scene, list, count, tile_x, tile_y, target, tally, u);
}

static void draw(const chi_tet_scene* scene, const uint64_t* list, size_t count, int32_t tile_x,
  int32_t tile_y, chi_tet_target* target, chi_tet_tally* tally)
{
  const int cuts = scene->depth || scene->plane_count || scene->limited;
  const int lit = target->light[0] != NULL;
  const int common = !scene->parallel && !scene->separate && !target->pick_alpha &&
    !scene->maximum && !scene->shades && !scene->colors && !target->projector;
  const int plain = common && !lit;
  const int method = scene->tables->method;
  (common && lit && method == CHI_PREINTEGRATION_PARTIAL       ? draw_partial_lit
      : common && lit && method == CHI_PREINTEGRATION_FULL     ? draw_full_lit
      : plain && !cuts && method == CHI_PREINTEGRATION_PARTIAL ? draw_partial
      : plain && cuts && method == CHI_PREINTEGRATION_PARTIAL  ? draw_partial_cut
      : plain && !cuts && method == CHI_PREINTEGRATION_FULL    ? draw_full
      : plain && cuts && method == CHI_PREINTEGRATION_FULL     ? draw_full_cut
      : plain && !cuts && method == CHI_PREINTEGRATION_NONE
      ? draw_none
      : draw_any)(scene, list, count, tile_x, tile_y, target, tally);
}

static void draw_cached(const chi_tet_scene* scene, chi_tet_target* target, chi_tet_tally* tally)
{
  const variant u = { scene->parallel, 0, 0, 0, scene->tables->method, 0, 0, 0, 0 };
  if (u.method == CHI_PREINTEGRATION_PARTIAL)
  {
    draw_kept(
      scene, target, tally, (variant){ 0, 0, 0, 0, CHI_PREINTEGRATION_PARTIAL, 0, 0, 0, 0 });
  }
  else
  {
    draw_kept(scene, target, tally, u);
  }
}
