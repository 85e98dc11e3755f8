/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Layout, steps and memory of light planes. */

#include "chi_light_planes.h"

#include <math.h>
#include <string.h>

enum
{
  LINE = CHI_LINE / sizeof(float)
};

static size_t round_up(size_t x, size_t to)
{
  return (x + to - 1) / to * to;
}

/* Light planes lie aside of their place by the zigzag, to this side and that in turn; which of both
 * does not depend on where the first one lies, so that cutting a volume moves none. */
static double side_of(const chi_scene* s, int64_t slab)
{
  return (s->zigzag_phase + slab) & 1 ? 1 : -1;
}

/* The shift of one direction from the light plane before this one: whole light pixels, and the
 * weights of the four taps there. */
void chi_scene_step(
  const chi_scene* s, int64_t slab, int direction, int32_t offset[2], float weight[4])
{
  const double shift = slab == 0 ? 0
                                 : chi_scene_shift(s, chi_scene_depth(s, (double)slab - 0.5),
                                     chi_scene_depth(s, (double)slab + 0.5));
  /* Farther than the picture is wide, light comes from outside: the padding is that wide. */
  const double wide = s->light_width + 1, high = s->light_height + 1;
  const double aside = side_of(s, slab) - side_of(s, slab - 1);
  const double straight_x = (double)s->tangent[0][direction] * s->pixels_x * shift;
  const double straight_y = (double)s->tangent[1][direction] * s->pixels_y * shift;
  const double dx = fmin(fmax(straight_x + aside * (double)s->zigzag[0][direction], -wide), wide);
  const double dy = fmin(fmax(straight_y + aside * (double)s->zigzag[1][direction], -high), high);
  const double i = floor(dx), j = floor(dy), u = dx - i, v = dy - j;
  offset[0] = (int32_t)i;
  offset[1] = (int32_t)j;
  weight[0] = (float)((1 - u) * (1 - v));
  weight[1] = (float)(u * (1 - v));
  weight[2] = (float)((1 - u) * v);
  weight[3] = (float)(u * v);
}

static void plan_steps(chi_light_planes* l)
{
  const chi_scene* const s = l->scene;
  l->reach[0] = 0;
  for (int64_t g = 0; g < s->slabs; ++g)
  {
    double reach = 0;
    for (int k = 0; k < s->directions; ++k)
    {
      int32_t at[2];
      float* const w = l->step_weight[g * s->directions + k];
      chi_scene_step(s, g, k, at, w);
      l->step_offset[g * s->directions + k] =
        (ptrdiff_t)at[1] * (ptrdiff_t)l->light_row + (ptrdiff_t)at[0];
      /* a shift of a whole number of pixels reaches no farther than that number */
      const int32_t x = at[0] < 0 ? -at[0] : at[0] + (w[1] > 0 || w[3] > 0);
      const int32_t y = at[1] < 0 ? -at[1] : at[1] + (w[2] > 0 || w[3] > 0);
      reach = fmax(reach, x > y ? x : y);
    }
    l->reach[g] = (g ? l->reach[g - 1] : 0) + reach;
  }
  l->reach[s->slabs] = INFINITY; /* receivers behind the last plane look anywhere */
}

size_t chi_light_stride(const chi_scene* s)
{
  return round_up((size_t)s->width + CHI_CELL_WIDTH, 64);
}

size_t chi_light_rows(const chi_scene* s)
{
  return round_up((size_t)s->height, (size_t)s->scale);
}

int64_t chi_scene_ring(const chi_scene* s)
{
  const double planes = ceil(fmax(s->bias, s->sample_bias)) + 4; /* a bias may be any number */
  return planes < (double)(s->slabs + 2) ? (int64_t)planes : s->slabs + 2;
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
  /* a mirrored window has negative pixels */
  *columns = fmin(ceil(slope_x * fabs(s->pixels_x) * shift), s->light_width + 1);
  *rows = fmax(1, fmin(ceil(slope_y * fabs(s->pixels_y) * shift), s->light_height + 1));
}

/* Mean visibility below which no direction can have 2^-10 left, a quarter of 1/255. */
static float dark_below(const chi_scene* s)
{
  float least = 1;
  for (int d = 0; d < s->directions && !s->published; ++d)
  {
    least = fminf(least, s->weight[d]);
  }
  return 0x1p-10f * least;
}

static void fill_field(void* data, size_t begin, size_t end)
{
  float* const out = (float*)data;
  for (size_t i = begin; i < end; ++i)
  {
    chi_fill_ones(out + i * 4096, 4096);
  }
}

/* Light from outside everywhere. */
static chi_status clear_field(chi_light_planes* l, chi_light_field* f, size_t light_floats)
{
  const size_t floats[3] = { light_floats, light_floats, (size_t)l->ring * l->light_plane };
  chi_buffer* const buffer[3] = { &f->light[0], &f->light[1], &f->visibility };
  for (int k = 0; k < 3; ++k)
  {
    /* Slack of a segment: the last row's overhang. */
    const size_t count = round_up(floats[k] + CHI_SEGMENT, 4096);
    if (!chi_buffer_reserve(l->exec, buffer[k], count, sizeof(float)))
    {
      return CHI_ERROR_OUT_OF_MEMORY;
    }
    l->bytes += count * sizeof(float);
    const chi_status status = chi_for(l->exec, count / 4096, fill_field, buffer[k]->data);
    if (status != CHI_OK)
    {
      return status;
    }
  }
  const size_t flags = (size_t)(2 + l->ring) * (size_t)l->scene->light_height * (size_t)l->segments;
  if (!chi_buffer_reserve(l->exec, &f->tiles, flags, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(f->tiles.data, TILE_BRIGHT, flags);
  return CHI_OK;
}

void chi_light_layout(chi_light_planes* l)
{
  const chi_scene* const s = l->scene;
  double columns, rows;
  widest_step(s, &columns, &rows);
  l->stride = chi_light_stride(s);
  l->rows = chi_light_rows(s);
  l->segments = (s->light_width - 1) / CHI_SEGMENT + 1;
  l->skew = (int)rows;
  l->shift_segments = (int)(columns / CHI_SEGMENT) + 1;
  l->blocking_shift = 0;
  while (s->slabs >> l->blocking_shift >= 1024) /* no more memory than that of usual depths */
  {
    ++l->blocking_shift;
  }
  l->blocking_words = (int)(s->slabs >> l->blocking_shift >> 6) + 1;
  /* whole cache lines before a row's first pixel: pieces begin with a line */
  const size_t pad_x = round_up((size_t)columns + 2, LINE), pad_y = (size_t)rows + 2;
  l->light_stride = round_up((size_t)s->light_width, CHI_SEGMENT) + 2 * pad_x + LINE;
  l->light_plane = ((size_t)s->light_height + 2 * pad_y) * l->light_stride;
  l->visibility_origin = pad_y * l->light_stride + pad_x;
  l->light_row = l->light_stride * (s->published ? 1 : (size_t)s->directions);
  l->light_origin = pad_y * l->light_row + pad_x;
  l->ring = chi_scene_ring(s);
}

chi_status chi_light_prepare(chi_light_planes* l, chi_light_buffers* keep, int fields, int surfaces)
{
  const chi_exec* const exec = l->exec;
  const chi_scene* const s = l->scene;
  const size_t slabs = (size_t)s->slabs, directions = (size_t)s->directions;
  const size_t pieces = (size_t)s->light_height * (size_t)l->segments, scale = (size_t)s->scale;
  const size_t scratch = LIGHT_PLANES * (size_t)s->light_height * l->light_stride;
  const size_t step_bytes = sizeof *l->step_offset + sizeof *l->step_weight;
  if (!chi_buffer_reserve(exec, &keep->scratch, scratch + 64, sizeof(float)) ||
    !chi_buffer_reserve(exec, &keep->reach, slabs + 1, sizeof(double)) ||
    !chi_buffer_reserve(exec, &keep->steps, slabs * directions + 1, step_bytes) ||
    !chi_buffer_reserve(exec, &keep->tau_flag, pieces, 1) ||
    (surfaces &&
      (!chi_buffer_reserve(
         exec, &keep->blocking, pieces, (size_t)l->blocking_words * sizeof(uint64_t)) ||
        !chi_buffer_reserve(exec, &keep->served, pieces, sizeof(chi_light_served)) ||
        !chi_buffer_reserve(exec, &keep->order, pieces, CHI_SEGMENT * scale * scale))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  l->scratch = (float*)keep->scratch.data;
  l->tau_flag = (uint8_t*)keep->tau_flag.data;
  l->reach = (double*)keep->reach.data;
  l->step_offset = (ptrdiff_t*)keep->steps.data;
  l->step_weight = (float(*)[4])(void*)(l->step_offset + slabs * directions);
  l->blocking = (uint64_t*)keep->blocking.data;
  l->served = (chi_light_served*)keep->served.data;
  l->order = (uint8_t*)keep->order.data;
  l->field = keep->field;
  l->fields = fields;
  l->dark_below = dark_below(s);
  l->bytes = 0;
  plan_steps(l);
  const size_t light_floats = l->light_plane * (s->published ? 1 : directions);
  chi_status status = CHI_OK;
  for (int f = 0; f < fields && status == CHI_OK; ++f)
  {
    for (int c = 0; c < s->channels && status == CHI_OK; ++c)
    {
      status = clear_field(l, &keep->field[f][c], light_floats);
    }
  }
  return status;
}

void chi_light_free(const chi_exec* exec, chi_light_buffers* keep)
{
  chi_buffer* const all[] = { &keep->steps, &keep->reach, &keep->scratch, &keep->tau_flag,
    &keep->blocking, &keep->served, &keep->order };
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
  {
    chi_buffer_free(exec, all[i]);
  }
  for (int f = 0; f < 2; ++f)
  {
    for (int c = 0; c < 3; ++c)
    {
      chi_light_field* const field = &keep->field[f][c];
      chi_buffer_free(exec, &field->light[0]);
      chi_buffer_free(exec, &field->light[1]);
      chi_buffer_free(exec, &field->visibility);
      chi_buffer_free(exec, &field->tiles);
    }
  }
}
