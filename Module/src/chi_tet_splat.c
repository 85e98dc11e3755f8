/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tetrahedra too small for the pixels' centres to meet them, by what they cover of each pixel.
 *
 * A pixel is drawn by one rule for all: either every tetrahedron is taken where the ray of its
 * centre meets it, or, in pixels that a small one touches, every tetrahedron by its mean over the
 * pixel's area. So no pixel counts space twice, or not at all, where cells of both sizes meet. Over
 * a triangle of the fan thickness is linear in parallel projection, and a polynomial would do in
 * perspective: it is integrated over the part of the triangle within the pixel.
 *
 * Thousands of small cells may lie in a pixel, and the light that one of them takes is lost in the
 * rounding of a transmittance. They are merged, in order, until they are thick enough to count:
 * optical depths and emissions are added in double, both exact for any transfer function, in the
 * limit of thin segments.
 */
#include "chi_tet_internal.h"

#include "chi_tet_area.h"

#include <math.h>

/* Both sides of its box, pixels, of a tetrahedron that is small: it meets about one centre or none,
 * so that its own share of the picture would be right to no better than the share itself. */
#define SMALL 2.0
/* What is merged has at most this optical depth together: light is moved within it by half as much
 * of itself at most. */
#define THIN (1.0 / 64)
/* Single rays through tetrahedra that are thicker than a step are integrated by steps. */
#define STEP (1.0 / 8)
#define MOST_STEPS 1024
#define DARK 1e-4 /* light that is not followed any more */
/* Optical depths of what is covered of a pixel: where alpha would be off by 1/20 of itself, and
 * where by a quarter. */
#define KEPT 0.1
#define SOLID 0.5

/*------------------------------------------------------------------------------------------------*/
/* The entry of the table that holds a place, and how far it lies beyond the entry. */
static int32_t entry_of(const chi_segment_tables* t, double x, double* part)
{
  const int32_t last = t->count - 2;
  const int32_t i = (int32_t)x < last ? (int32_t)x : last;
  *part = x - i;
  return i;
}

static void table_at(const chi_segment_tables* t, double x, double out[4])
{
  double f;
  const int32_t i = entry_of(t, x, &f);
  for (int k = 0; k < 4; ++k)
  {
    out[k] = t->color[i][k] + f * ((double)t->color[i + 1][k] - t->color[i][k]);
  }
}

/* The integral of colour times extinction, and of extinction, over a part of an entry from its
 * start on: both are linear in it. */
static inline void integrate_part(const chi_segment_tables* t, int32_t i, double f, double out[4])
{
  const double e = t->color[i][3], rise = (double)t->color[i + 1][3] - e;
  for (int k = 0; k < 3; ++k)
  {
    const double c = t->color[i][k], d = (double)t->color[i + 1][k] - c;
    out[k] = f * (c * e + f * (0.5 * (c * rise + d * e) + f * (d * rise / 3)));
  }
  out[3] = f * (e + f * 0.5 * rise);
}

chi_status chi_tet_splat_prepare(
  const chi_exec* exec, chi_buffer* integrals, const chi_segment_tables* tables)
{
  if (!chi_buffer_reserve(exec, integrals, (size_t)tables->count, 4 * sizeof(double)))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  double(*const sum)[4] = (double(*)[4])integrals->data;
  memset(sum[0], 0, sizeof sum[0]);
  for (int32_t i = 0; i + 1 < tables->count; ++i)
  {
    double part[4];
    integrate_part(tables, i, 1, part);
    for (int k = 0; k < 4; ++k)
    {
      sum[i + 1][k] = sum[i][k] + part[k];
    }
  }
  return CHI_OK;
}

/* Mean emission and extinction of a thin segment along which the place goes from x0 to x1. */
static void mean_of_segment(const chi_tet_splatter* it, double x0, double x1, double out[4])
{
  const chi_segment_tables* const t = it->scene->tables;
  if (fabs(x1 - x0) < 1e-3) /* the square of which is left out; a difference would lose digits */
  {
    table_at(t, 0.5 * (x0 + x1), out);
    for (int k = 0; k < 3; ++k)
    {
      out[k] *= out[3];
    }
    return;
  }
  double f[2], part[2][4];
  const int32_t i = entry_of(t, x0, f), j = entry_of(t, x1, f + 1);
  integrate_part(t, i, f[0], part[0]);
  integrate_part(t, j, f[1], part[1]);
  for (int k = 0; k < 4; ++k)
  {
    out[k] = ((it->integrals[j][k] - it->integrals[i][k]) + (part[1][k] - part[0][k])) / (x1 - x0);
  }
}

/* The same where colours are not those of the extinction's place, but are linear between those of
 * both ends, as extinction is. */
static void mean_of_linear(const double color[2][4], const double extinction[2], double out[4])
{
  const double e0 = extinction[0], e1 = extinction[1];
  for (int k = 0; k < 3; ++k)
  {
    out[k] = (color[0][k] * (2 * e0 + e1) + color[1][k] * (e0 + 2 * e1)) / 6;
  }
  out[3] = 0.5 * (e0 + e1);
}

/* The place of a value in the tables. */
static double place_of(const chi_tet_scene* s, double value)
{
  const double x = (value - (double)s->base) * (double)s->scale;
  return x > 0 ? x < (double)s->end ? x : (double)s->end : 0;
}

/* Mean emission and extinction along a ray. */
static void mean_of_ray(
  const chi_tet_splatter* it, const double value[CHI_TET_QUANTITIES][2], double out[4])
{
  const chi_tet_scene* const s = it->scene;
  if (!s->separate && !s->colors)
  {
    mean_of_segment(it, place_of(s, value[0][0]), place_of(s, value[0][1]), out);
    return;
  }
  double color[2][4], extinction[2];
  for (int end = 0; end < 2; ++end)
  {
    double at[4];
    table_at(s->tables, place_of(s, value[0][end]), color[end]);
    table_at(s->tables, place_of(s, value[s->separate ? 1 : 0][end]), at);
    extinction[end] = at[3];
    for (int k = 0; k < 3 && s->colors; ++k)
    {
      color[end][k] = value[CHI_TET_COLORS + k][end];
    }
  }
  mean_of_linear((const double(*)[4])color, extinction, out);
}

/*------------------------------------------------------------------------------------------------*/
/*
 * Where no more than a share of a pixel is covered by anything, an optical depth that is spread
 * over all of it takes too much light: share (1 - e^(-tau / share)) is what rays through its area
 * lose. Where it is thin, both are alike, and optical depths are kept: the share counts as 1 up to
 * KEPT where it is covered, and as itself from SOLID on.
 */
static void gather(chi_tet_splatter* it, int32_t pixel, double share)
{
  const double tau = -log(it->through[pixel]), there = tau / share;
  if (!(there > KEPT))
  {
    return;
  }
  const double part = fmin((there - KEPT) / (SOLID - KEPT), 1);
  const double counts = 1 + (share - 1) * part;
  const double alpha = there < INFINITY ? -counts * expm1(-tau / counts) : counts;
  const double times = alpha / (1 - it->through[pixel]);
  float* const rgba = it->target->rgba + 4 * pixel;
  for (int k = 0; k < 3; ++k)
  {
    rgba[k] = (float)(rgba[k] * times);
  }
  it->through[pixel] = 1 - alpha;
  rgba[3] = (float)(1 - alpha);
}

/* What has been merged at a pixel, on to it. */
static void flush(chi_tet_splatter* it, int32_t pixel)
{
  double* const merged = it->merged[pixel];
  const double tau = merged[3];
  float* const rgba = it->target->rgba + 4 * pixel;
  if ((float)it->through[pixel] != rgba[3])
  {
    it->through[pixel] = rgba[3]; /* others have drawn there */
  }
  if (tau > 0)
  {
    const double before = it->through[pixel], share = -expm1(-tau) / tau;
    for (int k = 0; k < 3; ++k)
    {
      rgba[k] = (float)(rgba[k] + before * share * merged[k]);
    }
    it->through[pixel] = before * exp(-tau);
    rgba[3] = (float)it->through[pixel];
  }
  memset(merged, 0, sizeof it->merged[pixel]);
}

static void flush_all(chi_tet_splatter* it)
{
  for (int32_t i = 0; i < CHI_TET_TILE_PIXELS; ++i)
  {
    flush(it, i);
  }
}

/* Colour that a ray brings through a tetrahedron, and the opacity, in steps of so little optical
 * depth that each is a mixture. */
static void integrate_ray(
  const chi_tet_splatter* it, const chi_tet_area_ray* ray, double tau, double out[4])
{
  const int steps = 1 + (int)fmin(tau / STEP, MOST_STEPS - 1);
  double through = 1;
  memset(out, 0, 4 * sizeof *out);
  for (int i = 0; i < steps && through > DARK; ++i)
  {
    double value[CHI_TET_QUANTITIES][2], mean[4];
    for (int q = 0; q < CHI_TET_QUANTITIES; ++q)
    {
      const double first = ray->value[q][0], rise = ray->value[q][1] - first;
      value[q][0] = first + rise * i / steps;
      value[q][1] = first + rise * (i + 1) / steps;
    }
    mean_of_ray(it, (const double(*)[2])value, mean);
    if (mean[3] > 0)
    {
      const double alpha = -expm1(-mean[3] * ray->length / steps);
      for (int k = 0; k < 3; ++k)
      {
        out[k] += through * alpha * mean[k] / mean[3];
      }
      through *= 1 - alpha;
    }
  }
  out[3] = 1 - through;
}

/* What of a tetrahedron is in a pixel: optical depths are added up, of thick rays colours are those
 * that reach the eye. */
static void deposit(chi_tet_splatter* it, uint32_t tetrahedron, int32_t pixel,
  const chi_tet_area_ray* rays, int count, chi_tet_sink* sink)
{
  const chi_tet_scene* const s = it->scene;
  double thin[4] = { 0 }, thick[4] = { 0 };
  for (int i = 0; i < count; ++i)
  {
    double mean[4];
    mean_of_ray(it, rays[i].value, mean);
    const double length = rays[i].length, tau = length * mean[3];
    for (int k = 0; k < 4; ++k)
    {
      thin[k] += rays[i].share * length * mean[k];
    }
    if (tau > STEP)
    {
      integrate_ray(it, rays + i, tau, mean);
    }
    for (int k = 0; k < 4; ++k)
    {
      thick[k] += rays[i].share * mean[k] * (tau > STEP ? 1 : length);
    }
  }
  const double tau = thin[3];
  if (!(tau > 0))
  {
    return;
  }
  double* const merged = it->merged[pixel];
  if (merged[3] + tau > THIN)
  {
    if (it->is_unsettled)
    {
      sink->settle(sink);
      it->is_unsettled = 0;
    }
    flush(it, pixel);
  }
  for (int k = 0; k < 3; ++k)
  {
    double light = thick[k] * (tau / thick[3]);
    if (s->shades)
    {
      const float* const shade = s->shades[tetrahedron];
      light =
        fmin(light * (double)shade[k] + (double)shade[3 + k] * tau, (double)s->color_limit * tau);
    }
    merged[k] += light;
  }
  merged[3] += tau;
}

/*------------------------------------------------------------------------------------------------*/
/* The pixels of the tile and the window that a box on the screen touches. 0: a point lies in front
 * of the near plane; else 1, and 2 where the box is small. */
static int find_box(
  const chi_tet_splatter* it, uint32_t tetrahedron, int32_t low[2], int32_t high[2])
{
  const chi_tet_scene* const s = it->scene;
  double box[2][2] = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
  for (int i = 0; i < 4; ++i)
  {
    const chi_tet_point* const p = s->points + s->vertices[4 * (size_t)tetrahedron + (size_t)i];
    if (!(p->z >= s->near_depth))
    {
      return 0;
    }
    const double w = s->parallel ? 1 : 1 / p->z;
    const double at[2] = { (p->x * w - s->first[0]) / s->step[0],
      (p->y * w - s->first[1]) / s->step[1] };
    for (int k = 0; k < 2; ++k)
    {
      box[0][k] = fmin(box[0][k], at[k]);
      box[1][k] = fmax(box[1][k], at[k]);
    }
  }
  const int32_t size[2] = { s->width, s->height };
  for (int k = 0; k < 2; ++k)
  {
    const int32_t end = size[k] - it->tile[k] < CHI_TET_TILE ? size[k] - it->tile[k] : CHI_TET_TILE;
    const double first = box[0][k] - it->tile[k] + 0.5, last = box[1][k] - it->tile[k] + 0.5;
    low[k] = first > 0 ? (int32_t)fmin(first, end) : 0;
    high[k] = last < end ? (last >= 0 ? (int32_t)last : -1) : end - 1;
  }
  return box[1][0] - box[0][0] <= SMALL && box[1][1] - box[0][1] <= SMALL ? 2 : 1;
}

static int splat(chi_tet_projector* projector, const chi_tet_scene* scene, uint32_t tetrahedron,
  const int32_t tile[2], chi_tet_sink* sink)
{
  chi_tet_splatter* const it = (chi_tet_splatter*)projector;
  int32_t low[2], high[2];
  chi_tet_area area;
  const int size = find_box(it, tetrahedron, low, high);
  if (size == 0)
  {
    /* at pixels' centres, marked or not, and behind what has been merged */
    flush_all(it);
    it->is_unsettled = 1;
    memset(it->covered, 255, sizeof it->covered);
    return CHI_TET_REST_ALL;
  }
  int any = 0;
  for (int32_t y = low[1]; y <= high[1]; ++y)
  {
    for (int32_t x = low[0]; x <= high[0]; ++x)
    {
      const int32_t pixel = y * CHI_TET_TILE + x;
      if (!it->marked[pixel])
      {
        continue;
      }
      if (!any)
      {
        chi_tet_area_begin(&area, scene, tetrahedron);
        any = 1;
      }
      chi_tet_area_ray rays[CHI_TET_AREA_RAYS];
      const int count = chi_tet_area_of_pixel(&area, tile[0] + x, tile[1] + y, rays);
      if (count)
      {
        if (~it->covered[pixel])
        {
          it->covered[pixel] |= chi_tet_area_cover(&area, tile[0] + x, tile[1] + y);
        }
        deposit(it, tetrahedron, pixel, rays, count, sink);
      }
    }
  }
  return size == 2 ? CHI_TET_REST_NONE : CHI_TET_REST_UNMARKED;
}

int64_t chi_tet_splat_begin(chi_tet_splatter* it, const uint64_t* list, size_t count)
{
  int64_t small = 0;
  memset(it->marked, 0, sizeof it->marked);
  for (size_t i = 0; i < count; ++i)
  {
    int32_t low[2], high[2];
    if (find_box(it, (uint32_t)list[i], low, high) != 2)
    {
      continue;
    }
    ++small;
    for (int32_t y = low[1]; y <= high[1]; ++y)
    {
      for (int32_t x = low[0]; x <= high[0]; ++x)
      {
        it->marked[y * CHI_TET_TILE + x] = 1;
      }
    }
  }
  if (small)
  {
    memset(it->merged, 0, sizeof it->merged);
    for (int32_t i = 0; i < CHI_TET_TILE_PIXELS; ++i)
    {
      it->through[i] = it->target->rgba[4 * i + 3];
    }
    memset(it->covered, 0, sizeof it->covered);
    it->is_unsettled = 0;
    it->projector = (chi_tet_projector){ .draw = splat, .marked = it->marked };
  }
  return small;
}

void chi_tet_splat_end(chi_tet_splatter* it)
{
  flush_all(it); /* the list is done, so that all else is in the pixels */
  for (int32_t i = 0; i < CHI_TET_TILE_PIXELS; ++i)
  {
    if (it->covered[i] && ~it->covered[i])
    {
      gather(it, i, __builtin_popcountll(it->covered[i]) / 64.0);
    }
  }
}

float chi_tet_splat_alpha(const chi_tet_splatter* it, int32_t pixel)
{
  return (float)(1 - it->through[pixel]);
}
