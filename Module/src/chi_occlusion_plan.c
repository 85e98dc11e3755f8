/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
/* Layout, buffers and order of a frame's march. */

#include "chi_components_internal.h"
#include "chi_mask_internal.h"
#include "chi_occlusion_march.h"

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

static void plan_steps(march* m)
{
  const chi_scene* const s = m->scene;
  m->reach[0] = 0;
  for (int64_t g = 0; g < s->slabs; ++g)
  {
    double reach = 0;
    for (int k = 0; k < s->directions; ++k)
    {
      int32_t at[2];
      float* const w = m->step_weight[g * s->directions + k];
      chi_scene_step(s, g, k, at, w);
      m->step_offset[g * s->directions + k] =
        (ptrdiff_t)at[1] * (ptrdiff_t)m->light_row + (ptrdiff_t)at[0];
      /* a shift of a whole number of pixels reaches no farther than that number */
      const int32_t x = at[0] < 0 ? -at[0] : at[0] + (w[1] > 0 || w[3] > 0);
      const int32_t y = at[1] < 0 ? -at[1] : at[1] + (w[2] > 0 || w[3] > 0);
      reach = fmax(reach, x > y ? x : y);
    }
    m->reach[g] = (g ? m->reach[g - 1] : 0) + reach;
  }
  m->reach[s->slabs] = INFINITY; /* receivers behind the last plane look anywhere */
}

static size_t row_stride(const chi_scene* s)
{
  return round_up((size_t)s->width + CHI_CELL_WIDTH, 64);
}

static size_t row_count(const chi_scene* s)
{
  return round_up((size_t)s->height, (size_t)s->scale);
}

size_t chi_march_picture_floats(const chi_scene* s)
{
  return GEOMETRY_PLANES * row_count(s) * row_stride(s) + 64;
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
    m->light_bytes += count * sizeof(float);
    const chi_status status = chi_for(m->exec, count / 4096, fill_field, buffer[k]->data);
    if (status != CHI_OK)
    {
      return status;
    }
  }
  const size_t flags = (size_t)(2 + m->ring) * (size_t)m->scene->light_height * (size_t)m->segments;
  if (!chi_buffer_reserve(m->exec, &f->tiles, flags, 1))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  memset(f->tiles.data, TILE_BRIGHT, flags);
  return CHI_OK;
}

/* Which light travels: for the volume, and, where others block it, for surfaces. */
void chi_frame_fields(const chi_occlusion_frame* frame, chi_frame_light* light)
{
  const int bits = frame->params->interactions;
  const int has_volume = frame->volume != NULL, has_surface = frame->surface != NULL;
  const int to_volume[2] = { (bits & CHI_VOLUME_TO_VOLUME) && has_volume,
    (bits & CHI_GEOMETRY_TO_VOLUME) && has_surface };
  const int to_surface[2] = { (bits & CHI_VOLUME_TO_GEOMETRY) && has_volume,
    (bits & CHI_GEOMETRY_TO_GEOMETRY) && has_surface };
  memset(light, 0, sizeof *light);
  if (!(frame->params->strength > 0) && !frame->probes)
  {
    return;
  }
  light->volume[0] = to_volume[0];
  light->geometry[0] = to_volume[1];
  light->fields = to_volume[0] || to_volume[1];
  const int receives = has_surface || (chi_layers_count(frame) > 0);
  if (receives && (to_surface[0] != to_volume[0] || to_surface[1] != to_volume[1]))
  {
    light->volume[1] = to_surface[0];
    light->geometry[1] = to_surface[1];
    light->surface_field = 1;
    light->fields = to_surface[0] || to_surface[1] ? 2 : light->fields;
  }
}

static void plan_fields(march* m)
{
  chi_frame_light light;
  chi_frame_fields(m->frame, &light);
  for (int f = 0; f < 2; ++f)
  {
    for (int c = 0; c < m->scene->channels; ++c)
    {
      m->keep->field[f][c].volume = light.volume[f];
      m->keep->field[f][c].geometry = light.geometry[f];
    }
  }
  m->fields = light.fields;
  m->surface_field = light.surface_field;
}

static chi_status reserve(march* m)
{
  const chi_exec* const exec = m->exec;
  const chi_scene* const s = m->scene;
  chi_march* const keep = m->keep;
  const size_t segments = (size_t)m->segments, bands = (size_t)m->bands;
  const size_t blocks = (size_t)m->blocks, cells = (size_t)m->cells_x,
               light_rows = (size_t)s->light_height;
  const size_t slabs = (size_t)s->slabs, directions = (size_t)s->directions;
  const size_t channels = (size_t)s->channels;
  const size_t scratch = LIGHT_PLANES * light_rows * m->light_stride;
  const size_t step_bytes = sizeof *m->step_offset + sizeof *m->step_weight;
  if (!chi_buffer_reserve(exec, &keep->planes, VOLUME_PLANES * m->plane + 64, sizeof(float)) ||
    !chi_buffer_reserve(
      exec, &keep->scratch, scratch + bands * channels * m->stride + 64, sizeof(float)) ||
    !chi_buffer_reserve(exec, &keep->cells, blocks * (size_t)m->cells_y * cells + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->last_slab, bands * segments, 2 * sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->live,
      blocks * bands * segments + light_rows * segments + bands * segments + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->live_row, 3 * m->rows * cells, 1) ||
    !chi_buffer_reserve(exec, &keep->sampled, m->rows * cells, sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->done, blocks * bands + 1, 1) ||
    !chi_buffer_reserve(exec, &keep->order, blocks * bands + 1, 2 * sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->reach, slabs + 1, sizeof(double)) ||
    !chi_buffer_reserve(exec, &keep->steps, slabs * directions + 1, step_bytes) ||
    !chi_buffer_reserve(exec, &keep->last_served, light_rows * segments, sizeof(int64_t)) ||
    !chi_buffer_reserve(exec, &keep->touched, light_rows * segments, 2 * sizeof(uint64_t)) ||
    (s->channels > 1 &&
      !chi_buffer_reserve(exec, &keep->tint, channels * m->plane + 64, sizeof(float))))
  {
    return CHI_ERROR_OUT_OF_MEMORY;
  }
  m->planes = (float*)keep->planes.data;
  m->scratch = (float*)keep->scratch.data;
  m->band_rows = m->scratch + scratch;
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
  m->step_offset = (ptrdiff_t*)keep->steps.data;
  m->step_weight = (float(*)[4])(void*)(m->step_offset + slabs * directions);
  m->last_served = (int64_t*)keep->last_served.data;
  m->touched = (uint64_t(*)[2])keep->touched.data;
  m->tint = (float*)keep->tint.data;
  memset(keep->done.data, 0, blocks * bands);
  memset(m->live_row, RAYS_LIVE, m->rows * cells);
  memset(m->tau_stale, 0, 2 * m->rows * cells);
  for (size_t i = 0; i < m->rows * cells; ++i)
  {
    m->sampled[i] = -2;
  }
  return CHI_OK;
}

static void clear_rows(void* data, size_t begin, size_t end)
{
  const march* const m = (const march*)data;
  const size_t height = (size_t)m->scene->height;
  for (size_t y = begin; y < end; ++y)
  {
    for (int c = 0; c < 3; ++c)
    {
      memset(picture(m, RED + c, (int64_t)y), 0, m->stride * sizeof(float));
    }
    memset(picture(m, TAU, (int64_t)y), 0, m->stride * sizeof(float));
    memset(picture(m, TAU_OTHER, (int64_t)y), 0, m->stride * sizeof(float));
    chi_fill_ones(picture(m, TRANSMITTANCE, (int64_t)y), (int)m->stride);
    for (int c = 0; c < m->scene->channels && m->frame->surface && y < height; ++c)
    {
      chi_fill_ones(surface_visibility(m, c, (int64_t)y), m->scene->width);
    }
  }
}

/* Length of the picture's longest ray over a unit of depth. */
static double longest_ray(const chi_scene* s)
{
  const double x = fmax(fabs(s->slope_x), fabs(s->slope_x + (s->width - 1) * s->slope_dx));
  const double y = fmax(fabs(s->slope_y), fabs(s->slope_y + (s->height - 1) * s->slope_dy));
  return sqrt(1 + x * x + y * y);
}

float chi_march_color_step(
  const chi_scene* s, const chi_classification* c, const chi_occlusion_params* params)
{
  /* several tables, or rows of one, take the middle's */
  return params->color_integration == CHI_COLOR_MIDDLE || c->tables > 1 || c->plane.count[0]
    ? INFINITY
    : chi_classification_color_step(c, s->slice * longest_ray(s));
}

static chi_status set_sample_frame(march* m)
{
  chi_sample_frame* const f = &m->sample;
  f->saturated = m->keep->crossing      ? m->keep->crossing_transmittance
    : m->skip & CHI_SKIP_SATURATED_RAYS ? CHI_SATURATED
                                        : -1;
  if (!m->frame->volume)
  {
    return CHI_OK;
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
  f->value_end = (float)(c->table_entries - 1);
  f->table_entries = (int32_t)c->table_entries;
  f->labels = c->mask ? c->mask->labels : NULL;
  f->sigma = (const chi_plan_entry*)c->sigma.data;
  f->rgba = (const float(*)[4])c->rgba.data;
  f->colors = (const chi_plan_color*)c->colors.data;
  f->color_step = chi_march_color_step(m->scene, c, m->frame->params);
  f->quantum = c->quantum;
  f->occupied = (const uint8_t*)c->occupied.data;
  f->brick_step_y = (int32_t)b->count[0];
  f->brick_step_z = (int32_t)(b->count[0] * b->count[1]);
  f->slice = (float)m->scene->slice;
  chi_cut_prepare(&f->cut, m->scene, c->mask);
  f->tinted = m->scene->channels > 1;
  f->general |= f->tinted;
  int shaded = 0;
  if (!chi_shading_prepare(&m->shade, m->frame, b, c, &shaded))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  f->shade = shaded ? &m->shade : NULL;
  f->general = f->general || shaded;
  m->second = *f; /* the other quantity's samples lie as the volume's do */
  m->second.scalars = m->shade.plane_second;
  m->second.fetch = CHI_FETCH_F32;
  f->second = m->shade.plane_second ? &m->second : NULL;
  f->components = NULL;
  if (m->frame->components)
  {
    chi_components_prepare(m->keep->components, m->frame->components, (int)m->frame->volume->type,
      &m->component_frame.plan);
    chi_components_frame(m->keep->components, f, m->more, &m->component_frame);
    f->components = &m->component_frame;
    f->general = 1;
  }
  return CHI_OK;
}

static void plan_layout(march* m)
{
  const chi_scene* const s = m->scene;
  double columns, rows;
  widest_step(s, &columns, &rows);
  m->stride = row_stride(s);
  m->rows = row_count(s);
  m->plane = m->rows * m->stride;
  m->cells_x = (s->width - 1) / CHI_CELL_WIDTH + 1;
  m->cells_y = (int)((m->rows - 1) / CHI_CELL_HEIGHT) + 1;
  m->segments = (s->light_width - 1) / CHI_SEGMENT + 1;
  m->skew = (int)rows;
  m->shift_segments = (int)(columns / CHI_SEGMENT) + 1;
  m->block = 16 / m->skew < 1 ? 1 : 16 / m->skew < MAX_BLOCK ? 16 / m->skew : MAX_BLOCK;
  m->blocks = (s->slabs + m->block - 1) / m->block;
  while (s->slabs >> m->touched_shift > 63)
  {
    ++m->touched_shift;
  }
  m->bands = (s->light_height + m->skew * (m->block - 1) - 1) / BAND + 1;
  m->lag = (m->skew * m->block + BAND - 1) / BAND;
  /* whole cache lines before a row's first pixel: pieces begin with a line */
  const size_t pad_x = round_up((size_t)columns + 2, LINE), pad_y = (size_t)rows + 2;
  m->light_stride = round_up((size_t)s->light_width, CHI_SEGMENT) + 2 * pad_x + LINE;
  m->light_plane = ((size_t)s->light_height + 2 * pad_y) * m->light_stride;
  m->visibility_origin = pad_y * m->light_stride + pad_x;
  m->light_row = m->light_stride * (s->published ? 1 : (size_t)s->directions);
  m->light_origin = pad_y * m->light_row + pad_x;
  m->ring = chi_scene_ring(s);
}

/* Everything that a frame needs before its first task. */
chi_status chi_march_plan(march* m)
{
  plan_layout(m);
  chi_status status = reserve(m);
  if (status != CHI_OK)
  {
    return status;
  }
  plan_fields(m);
  const size_t light_floats =
    m->light_plane * (m->scene->published ? 1 : (size_t)m->scene->directions);
  for (int f = 0; f < m->fields && status == CHI_OK; ++f)
  {
    for (int c = 0; c < m->scene->channels && status == CHI_OK; ++c)
    {
      status = clear_field(m, &m->keep->field[f][c], light_floats);
    }
  }
  if (status == CHI_OK)
  {
    status = set_sample_frame(m);
  }
  if (status == CHI_OK)
  {
    plan_steps(m);
    plan_order(m);
    m->dark_below = dark_below(m->scene);
    status = chi_for(m->exec, m->rows, clear_rows, m);
  }
  return status;
}
