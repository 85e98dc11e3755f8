/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

#include "occlusion_executor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Buffers of one frame. */
typedef struct executor
{
  const chi_occlusion_plan* plan;
  int everywhere;     /* take no notice of the plan's rectangles */
  double* pixels;     /* [height][width][EXECUTED_CHANNELS] */
  double* tau[2];     /* [light height scale][light width scale] */
  double* light[2];   /* [directions][light height][light width] */
  double* visibility; /* [ring][light height][light width] */
  int32_t tau_width;
} executor;

static chi_rect bounds(const executor* e, const chi_rect* rect, int32_t width, int32_t height)
{
  const chi_rect all = { 0, 0, width, height };
  return e->everywhere ? all : *rect;
}

static size_t light_pixels(const chi_occlusion_plan* p)
{
  return (size_t)p->light_width * (size_t)p->light_height;
}

static double* allocate(size_t count, double value)
{
  double* const block = malloc(count * sizeof *block);
  for (size_t i = 0; block && i < count; ++i)
  {
    block[i] = value;
  }
  if (!block)
  {
    exit(1);
  }
  return block;
}

static double clamp(double x, double low, double high)
{
  return fmin(fmax(x, low), high);
}

/* Place of a sample in the tables; negative: nothing visible. */
static double table_position(const chi_occlusion_plan* p, const double at[3])
{
  double f[3];
  size_t i[3];
  for (int a = 0; a < 3; ++a)
  {
    const double last = (double)p->dimensions[a] - 1, x = clamp(at[a], 0, last);
    i[a] = (size_t)fmin(floor(x), last - 1);
    f[a] = x - (double)i[a];
    if (p->use_bricks && a == 2)
    {
      const size_t edge = (size_t)p->brick_edge;
      const size_t brick[3] = { (size_t)clamp(at[0], 0, (double)p->dimensions[0] - 1) / edge,
        (size_t)clamp(at[1], 0, (double)p->dimensions[1] - 1) / edge, (size_t)x / edge };
      if (!p->occupied[brick[0] + p->bricks[0] * (brick[1] + p->bricks[1] * brick[2])])
      {
        return -1;
      }
    }
  }
  double scalar = 0;
  for (size_t corner = 0; corner < 8; ++corner)
  {
    double weight = 1;
    size_t index = 0, step = 1;
    for (int a = 0; a < 3; ++a)
    {
      const size_t up = corner >> a & 1;
      weight *= up ? f[a] : 1 - f[a];
      index += (i[a] + up) * step;
      step *= p->dimensions[a];
    }
    scalar += weight * (double)((const float*)p->scalars)[index];
  }
  const double t =
    (scalar - (double)p->table_base) * (double)p->table_scale + (double)p->table_offset;
  return clamp(t, 0, (double)p->entries - 1);
}

/* Integral of the extinction up to a place in the table, less `from` quanta. */
static double integral(const chi_occlusion_plan* p, double t, int32_t from)
{
  const size_t entry = (size_t)fmin(t, (double)p->entries - 2);
  const double f = t - (double)entry;
  const chi_plan_entry* const row = p->table + entry;
  const int32_t sum = (int32_t)((uint32_t)row->sum - (uint32_t)from);
  return (double)p->quantum * sum + f * ((double)row->sigma + f * (double)row->half_slope);
}

/* Eq. 1. */
static double mean_extinction(const chi_occlusion_plan* p, double t0, double t1)
{
  const size_t entry = (size_t)fmin(t1, (double)p->entries - 2);
  const chi_plan_entry* const row = p->table + entry;
  const double change = t0 < 0 ? 0 : t1 - t0;
  if (fabs(change) <= 1)
  {
    return fmax(
      (double)row->sigma + (2 * (t1 - (double)entry) - change) * (double)row->half_slope, 0);
  }
  return fmax((integral(p, t1, row->sum) - integral(p, t0, row->sum)) / change, 0);
}

/* Value of a light-sized plane at a pixel: Eq. 5. `rim`: in light pixels at the rim the place is
 * moved to their middle. */
static double enlarge(const chi_occlusion_plan* p, const double* plane, int x, int y, int rim)
{
  const int at[2] = { x, y }, size[2] = { p->light_width, p->light_height };
  const double* weight[2];
  for (int a = 0; a < 2; ++a)
  {
    const int middle = p->light_scale == 1 || (rim && (at[a] == 0 || at[a] == 2 * size[a] - 1));
    weight[a] = p->light_weight[middle ? 1 : at[a] & 1 ? 2 : 0];
  }
  double sum = 0;
  for (int k = 0; k < 9; ++k)
  {
    const int i = x / p->light_scale + k % 3 - 1, j = y / p->light_scale + k / 3 - 1;
    const int column = i < 0 ? 0 : i < size[0] ? i : size[0] - 1;
    const int row = j < 0 ? 0 : j < size[1] ? j : size[1] - 1;
    sum += weight[0][k % 3] * weight[1][k / 3] * plane[column + size[0] * row];
  }
  return sum;
}

static const double* plane_of(const executor* e, int field, int64_t slab)
{
  const size_t ring = (size_t)e->plan->ring;
  return e->visibility + ((size_t)field * ring + (size_t)slab % ring) * light_pixels(e->plan);
}

/* Visibility of matter in a segment of a slab. */
static double visibility_of_sample(
  const executor* e, const chi_plan_slab* rays, int64_t segment, int x, int y)
{
  const double place =
    fmin((double)rays->plane[0] + (double)segment * (double)rays->plane[1], (double)rays->plane[2]);
  double missing = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double weight = fmax(1 - fabs(place - k), 0);
    if (weight > 0 && rays->first_plane + k >= 0)
    {
      missing += weight * (1 - enlarge(e->plan, plane_of(e, 0, rays->first_plane + k), x, y, 0));
    }
  }
  return clamp(1 - e->plan->strength * missing, 0, 1);
}

/* Part of a ray, in slices from the slab's first, that the box and the clip planes leave. */
static void cut_ray(
  const chi_occlusion_plan* p, const double o[3], const double d[3], double out[2])
{
  out[0] = -1;
  out[1] = (double)p->group + 1;
  for (int a = 0; a < 3 + p->clip_count; ++a)
  {
    /* a face of the box is a plane: twice an axis */
    for (int side = 0; side < (a < 3 ? 2 : 1); ++side)
    {
      double value, change;
      if (a < 3)
      {
        value = side ? p->box_high[a] - o[a] : o[a] - p->box_low[a];
        change = side ? -d[a] : d[a];
      }
      else
      {
        const double* const c = p->clip[a - 3];
        value = c[0] * o[0] + c[1] * o[1] + c[2] * o[2] + c[3];
        change = c[0] * d[0] + c[1] * d[1] + c[2] * d[2];
      }
      if (change > 0)
      {
        out[0] = fmax(out[0], -value / change);
      }
      else if (change < 0)
      {
        out[1] = fmin(out[1], -value / change);
      }
      else if (value < 0)
      {
        out[1] = -2;
      }
    }
  }
}

static void sample_ray(executor* e, int64_t slab, const chi_plan_slab* rays, int x, int y)
{
  const chi_occlusion_plan* const p = e->plan;
  double* const pixel = e->pixels + EXECUTED_CHANNELS * (x + p->width * y);
  double o[3], d[3], part[2], square = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double u = x - (double)rays->pixel[0], v = y - (double)rays->pixel[1];
    o[a] =
      (double)rays->position[a] + u * (double)rays->position_x[a] + v * (double)rays->position_y[a];
    d[a] = (double)rays->direction[a] + u * (double)rays->direction_x[a] +
      v * (double)rays->direction_y[a];
  }
  cut_ray(p, o, d, part);
  square += pow(p->slope_x + x * p->slope_dx, 2) + pow(p->slope_y + y * p->slope_dy, 2);
  const double surface =
    p->surface ? (double)p->surface[x + p->width * y][0] - (double)(slab * p->group) : INFINITY;
  for (int64_t i = 0; i < p->group; ++i)
  {
    const double near = (double)i, stop = fmin(near + 1, part[1]), from = fmax(near, part[0]);
    if (!(from < stop))
    {
      continue;
    }
    const int entering = part[0] >= near || (slab == p->volume_begin && i == 0);
    double place[2][3];
    for (int a = 0; a < 3; ++a)
    {
      place[0][a] = o[a] + near * d[a];
      place[1][a] = o[a] + stop * d[a];
    }
    const double t0 = entering ? -1 : table_position(p, place[0]), t = table_position(p, place[1]);
    if (t < 0 || (!entering && t0 < 0))
    {
      continue;
    }
    const double depth = mean_extinction(p, t0, t) * (stop - from) * p->slice;
    e->tau[slab & 1][x + e->tau_width * y] += depth;
    const double seen = clamp(surface - near, 0, stop - from) / (stop - from);
    if (pixel[3] > p->saturated)
    {
      const double weight = pixel[3] * -expm1(-depth * seen * sqrt(square));
      const double lit = rays->is_lit ? visibility_of_sample(e, rays, i, x, y) : 1;
      const float* const rgb = p->rgba[(size_t)(t - 0.5 * (t0 < 0 ? 0 : t - t0) + 0.5)];
      for (int c = 0; c < 3; ++c)
      {
        pixel[c] += weight * lit * (double)rgb[c];
      }
      pixel[3] -= weight;
    }
  }
}

/* Thickness of a light pixel: Eq. 4. */
static double light_thickness(const executor* e, int64_t slab, int x, int y)
{
  const chi_occlusion_plan* const p = e->plan;
  const double length = (double)p->channel[0].mean_length;
  double mean = 0, most = 0, before = 0, joint = 0;
  for (int k = 0; k < p->light_scale * p->light_scale; ++k)
  {
    const int at = p->light_scale * x + k % p->light_scale +
      e->tau_width * (p->light_scale * y + k / p->light_scale);
    const double tau = e->tau[slab & 1][at], last = exp(-length * e->tau[~slab & 1][at]);
    mean += tau / (p->light_scale * p->light_scale);
    most = fmax(most, tau);
    before += last;
    joint += last * exp(-length * tau);
  }
  return p->light_scale == 1 || most <= (double)p->channel[0].thin
    ? mean
    : fmax(log(fmax(before, 4e-30) / fmax(joint, 4e-30)) / length, 0);
}

/* Share of the light that surfaces let through. */
static double geometry_through(const executor* e, int64_t slab, int x, int y)
{
  const chi_occlusion_plan* const p = e->plan;
  double blocked = 0;
  for (int k = 0; k < p->light_scale * p->light_scale; ++k)
  {
    const int i = p->light_scale * x + k % p->light_scale;
    const int j = p->light_scale * y + k / p->light_scale;
    if (i < p->width && j < p->height)
    {
      const float* const s = p->surface[i + p->width * j];
      blocked += (double)s[2] < (double)slab + 1 && (double)s[3] >= (double)slab
        ? (double)p->surface_more[i + p->width * j][0]
        : 0;
    }
  }
  return 1 - blocked / (p->light_scale * p->light_scale);
}

/* What a direction brings; 1 from outside. */
static double light_at(const executor* e, const double* from, int x, int y)
{
  const chi_occlusion_plan* const p = e->plan;
  const int inside = x >= 0 && y >= 0 && x < p->light_width && y < p->light_height;
  return inside ? from[x + p->light_width * y] : 1;
}

/* Light of direction m before a slab; all share one buffer by the published rule. */
static double* light_of(const executor* e, int64_t slab, int m)
{
  return e->light[slab & 1] + (e->plan->published ? 0 : (size_t)m * light_pixels(e->plan));
}

/* Light that direction m brings to a light pixel from the slab before. */
static double shifted_light(const executor* e, int64_t slab, int m, int x, int y)
{
  const chi_occlusion_plan* const p = e->plan;
  const chi_plan_shift* const s = p->shift + slab * p->directions + m;
  double light = 0;
  for (int k = 0; k < 4; ++k)
  {
    light += (double)s->weight[k] *
      light_at(e, light_of(e, slab, m), x + s->x + (k & 1), y + s->y + (k >> 1));
  }
  return light;
}

/* Transmittance of half a slab in a direction of this slope, through a pixel of slope px, py. */
static double half_through(double tau, double px, double py, const float slope[2])
{
  const double a = px - (double)slope[0], b = py - (double)slope[1];
  return exp(-0.5 * tau * sqrt(1 + a * a + b * b));
}

/* Eq. 3 of the one field there is, or the published rule. */
static void light_slab(executor* e, int64_t slab)
{
  const chi_occlusion_plan* const p = e->plan;
  const chi_rect r = bounds(e, p->light + slab, p->light_width, p->light_height);
  double* const seen = e->visibility + (size_t)(slab % p->ring) * light_pixels(p);
  const double half = 0.5 * (p->light_scale - 1);
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      const double tau =
        p->field[0].volume ? (double)p->channel[0].attenuation * light_thickness(e, slab, x, y) : 0;
      const double through = p->field[0].geometry ? geometry_through(e, slab, x, y) : 1;
      const double px = p->slope_x + (p->light_scale * x + half) * p->slope_dx;
      const double py = p->slope_y + (p->light_scale * y + half) * p->slope_dy;
      const int at = x + p->light_width * y;
      double sum = 0;
      for (int m = 0; m < p->directions; ++m)
      {
        const double light = shifted_light(e, slab, m, x, y);
        const double less = half_through(tau, px, py, p->published ? p->path : p->direction[m]);
        sum += (double)p->share[m] * light * less;
        if (!p->published)
        {
          light_of(e, slab + 1, m)[at] = light * less * less * through;
        }
      }
      if (p->published)
      {
        light_of(e, slab + 1, 0)[at] = sum * half_through(tau, px, py, p->path) * through;
      }
      seen[at] = sum;
    }
  }
}

/* Surfaces between the planes slab - 1 and slab. */
static void receive(executor* e, int64_t slab)
{
  const chi_occlusion_plan* const p = e->plan;
  const chi_rect r = bounds(e, p->receivers + slab, p->width, p->height);
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      const double at = (double)p->surface[x + p->width * y][1], above = (double)slab;
      if (at >= above - 1 && (at < above || (at == above && slab == p->slabs - 1)))
      {
        double v[2] = { 1, 1 };
        for (int k = slab == 0; k < 2; ++k)
        {
          v[k] = clamp(enlarge(p, plane_of(e, 0, slab - 1 + k), x, y, 1), 0, 1);
        }
        const double share = at - above + 1;
        e->pixels[EXECUTED_CHANNELS * (x + p->width * y) + 4] = (1 - share) * v[0] + share * v[1];
      }
    }
  }
}

/* Surfaces behind the last plane: every direction at the offset that is left. */
static void receive_beyond(executor* e)
{
  const chi_occlusion_plan* const p = e->plan;
  const chi_rect r = bounds(e, &p->beyond, p->width, p->height);
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      const size_t pixel = (size_t)(x + p->width * y);
      const double at = (double)p->surface[pixel][1];
      if (!(at > (double)(p->slabs - 1) && at < INFINITY))
      {
        continue;
      }
      double sum = 0;
      for (int m = 0; m < p->directions; ++m)
      {
        const double shift = (double)p->surface_more[pixel][1];
        const double u = (x + 0.5) / p->light_scale - 0.5 +
          (double)p->direction[m][0] * shift * p->light_pixels[0];
        const double v = (y + 0.5) / p->light_scale - 0.5 +
          (double)p->direction[m][1] * shift * p->light_pixels[1];
        const int i = (int)floor(u), j = (int)floor(v);
        const double* const from = light_of(e, p->slabs, m);
        for (int k = 0; k < 4; ++k)
        {
          const double wu = k & 1 ? u - i : 1 - (u - i), wv = k >> 1 ? v - j : 1 - (v - j);
          sum += (double)p->share[m] * wu * wv * light_at(e, from, i + (k & 1), j + (k >> 1));
        }
      }
      e->pixels[EXECUTED_CHANNELS * pixel + 4] = sum;
    }
  }
}

double* execute_plan(const chi_occlusion_plan* p, int everywhere)
{
  executor e = {
    .plan = p, .everywhere = everywhere, .tau_width = p->light_width * p->light_scale
  };
  const size_t pixels = (size_t)p->width * (size_t)p->height;
  const size_t taus = light_pixels(p) * (size_t)(p->light_scale * p->light_scale);
  e.pixels = allocate(EXECUTED_CHANNELS * pixels, 0);
  e.visibility = allocate((size_t)p->ring * light_pixels(p), 1);
  for (int k = 0; k < 2; ++k)
  {
    e.tau[k] = allocate(taus, 0);
    e.light[k] = allocate((size_t)p->directions * light_pixels(p), 1);
  }
  for (size_t i = 0; i < pixels; ++i)
  {
    e.pixels[EXECUTED_CHANNELS * i + 3] = e.pixels[EXECUTED_CHANNELS * i + 4] = 1;
  }
  for (int64_t slab = 0; slab < p->slabs; ++slab)
  {
    chi_plan_slab rays;
    chi_occlusion_plan_slab(p, slab, &rays);
    const chi_rect r = bounds(&e, p->samples + slab, p->width, p->height);
    memset(e.tau[slab & 1], 0, taus * sizeof(double));
    for (int i = 0; i < (r.x1 - r.x0) * (r.y1 - r.y0); ++i)
    {
      if (slab >= p->volume_begin && slab < p->volume_end)
      {
        sample_ray(&e, slab, &rays, r.x0 + i % (r.x1 - r.x0), r.y0 + i / (r.x1 - r.x0));
      }
    }
    light_slab(&e, slab);
    if (p->surface)
    {
      receive(&e, slab);
    }
  }
  if (p->surface)
  {
    receive_beyond(&e);
  }
  for (size_t i = 0; i < pixels; ++i)
  {
    double* const v = e.pixels + EXECUTED_CHANNELS * i + 4;
    *v = 1 - p->strength * (1 - *v);
  }
  for (int k = 0; k < 2; ++k)
  {
    free(e.tau[k]);
    free(e.light[k]);
  }
  free(e.visibility);
  return e.pixels;
}
