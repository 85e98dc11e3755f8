/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_internal.h"

#include <chiaroscuro/chi_transfer_shapes.h>

#include <math.h>
#include <string.h>

enum
{
  MAX_SIDE = 65536,
  MAX_ENTRIES = 1 << 22,
  PLACES = 8 /* of an entry's rectangle along each axis, where edges are hard */
};

static int in_unit(double x)
{
  return x >= 0 && x <= 1;
}

static int size_is_valid(const size_t size[2])
{
  return size[0] >= 2 && size[1] >= 2 && size[0] <= MAX_SIDE && size[1] <= MAX_SIDE &&
    size[0] * size[1] <= MAX_ENTRIES;
}

static int range_is_valid(double low, double high)
{
  return isfinite(low) && isfinite(high) && low < high && isfinite(high - low);
}

static int polygon_is_valid(const chi_transfer_shape* s)
{
  if (!s->polygon || s->polygon_count < 3 || s->polygon_count > MAX_SIDE)
  {
    return 0;
  }
  for (size_t i = 0; i < 2 * s->polygon_count; ++i)
  {
    if (!isfinite(s->polygon[i]))
    {
      return 0;
    }
  }
  return 1;
}

static int kind_is_valid(const chi_transfer_shape* s)
{
  const int high = range_is_valid(s->low[1], s->high[1]);
  switch (s->kind)
  {
    case CHI_SHAPE_RECTANGLE:
      return high && range_is_valid(s->low[0], s->high[0]) && in_unit(s->softness);
    case CHI_SHAPE_TRAPEZOID:
      return high && isfinite(s->low[0]) && isfinite(s->high[0]) && isfinite(s->top[0]) &&
        isfinite(s->top[1]) && s->low[0] <= s->high[0] && s->top[0] <= s->top[1] &&
        (s->low[0] < s->high[0] || s->top[0] < s->top[1]) && in_unit(s->softness);
    case CHI_SHAPE_GAUSSIAN:
      return isfinite(s->center[0]) && isfinite(s->center[1]) && s->sigma[0] > 0 &&
        s->sigma[1] > 0 && isfinite(s->sigma[0]) && isfinite(s->sigma[1]) &&
        fabs(s->correlation) < 1;
    case CHI_SHAPE_POLYGON:
      return polygon_is_valid(s);
    case CHI_SHAPE_IMAGE:
      return high && range_is_valid(s->low[0], s->high[0]) && s->image &&
        size_is_valid(s->image_size);
    default:
      return 0;
  }
}

/* One of ours, checked. */
static int adopt(chi_transfer_shape* own, const chi_transfer_shape* given)
{
  memset(own, 0, sizeof *own);
  int good = CHI_ADOPT(chi_transfer_shape, image_size, own, given) && kind_is_valid(own);
  for (int c = 0; c < 4; ++c)
  {
    good = good && in_unit(own->rgba[c]);
  }
  return good;
}

/* Shapes of a later version may be longer: each says how long it is, and so where the next is. */
static const chi_transfer_shape* next_of(const chi_transfer_shape* shape)
{
  return (const chi_transfer_shape*)(const void*)((const char*)shape + shape->struct_size);
}

/* Of the distance from the middle in half widths. */
static double soft(double u, double softness)
{
  const double inside = 1 - fabs(u);
  return inside < 0 ? 0 : softness > 0 && inside < softness ? inside / softness : 1;
}

static double in_rectangle(const chi_transfer_shape* s, double x, double y)
{
  const double u = (2 * x - s->low[0] - s->high[0]) / (s->high[0] - s->low[0]);
  const double v = (2 * y - s->low[1] - s->high[1]) / (s->high[1] - s->low[1]);
  return soft(u, s->softness) * soft(v, s->softness);
}

static double in_trapezoid(const chi_transfer_shape* s, double x, double y)
{
  const double t = (y - s->low[1]) / (s->high[1] - s->low[1]);
  if (!in_unit(t))
  {
    return 0;
  }
  const double left = s->low[0] + t * (s->top[0] - s->low[0]);
  const double right = s->high[0] + t * (s->top[1] - s->high[0]);
  if (!(left < right)) /* a vertex */
  {
    return x == left ? 1 : 0;
  }
  return soft((2 * x - left - right) / (right - left), s->softness);
}

static double in_gaussian(const chi_transfer_shape* s, double x, double y)
{
  const double u = (x - s->center[0]) / s->sigma[0], v = (y - s->center[1]) / s->sigma[1];
  const double c = s->correlation;
  return exp(-0.5 * (u * u - 2 * c * u * v + v * v) / (1 - c * c));
}

/* Even-odd: an edge belongs to its lower end, so that none is counted twice. */
static double in_polygon(const chi_transfer_shape* s, double x, double y)
{
  int inside = 0;
  const double* a = s->polygon + 2 * (s->polygon_count - 1);
  for (size_t i = 0; i < s->polygon_count; ++i)
  {
    const double* const b = s->polygon + 2 * i;
    if ((a[1] <= y) != (b[1] <= y))
    {
      inside ^= x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }
    a = b;
  }
  return inside;
}

static double weight_of(const chi_transfer_shape* s, double x, double y)
{
  switch (s->kind)
  {
    case CHI_SHAPE_RECTANGLE:
      return in_rectangle(s, x, y);
    case CHI_SHAPE_TRAPEZOID:
      return in_trapezoid(s, x, y);
    case CHI_SHAPE_GAUSSIAN:
      return in_gaussian(s, x, y);
    default:
      return in_polygon(s, x, y);
  }
}

static double to_unit(double x)
{
  return x > 0 ? (x < 1 ? x : 1) : 0; /* NaN: 0 */
}

/* Entry before a place along one axis, and the rest to the place. */
static size_t entry_before(const chi_transfer_shape* s, int axis, double x, double* rest)
{
  const double last = (double)(s->image_size[axis] - 1);
  const double at = to_unit((x - s->low[axis]) / (s->high[axis] - s->low[axis])) * last;
  const double i = at < last - 1 ? floor(at) : last - 1;
  *rest = at - i;
  return (size_t)i;
}

static void read_image(const chi_transfer_shape* s, double x, double y, double rgba[4])
{
  double u, v;
  const size_t i = entry_before(s, 0, x, &u), j = entry_before(s, 1, y, &v);
  const float* const at = s->image + 4 * (i + s->image_size[0] * j);
  const size_t up = 4 * s->image_size[0];
  for (size_t c = 0; c < 4; ++c)
  {
    const double below = (1 - u) * to_unit((double)at[c]) + u * to_unit((double)at[4 + c]);
    const double above =
      (1 - u) * to_unit((double)at[up + c]) + u * to_unit((double)at[up + 4 + c]);
    rgba[c] = s->rgba[c] * ((1 - v) * below + v * above);
  }
}

/* Materials that are mixed at one place. */
typedef struct mixture
{
  double clear, depth, sum[3]; /* transmittance; optical depth, and times colour */
} mixture;

static const mixture nothing = { 1, 0, { 0, 0, 0 } };

static void add(mixture* m, const double rgba[4])
{
  const double depth = -log1p(-fmin(rgba[3], 1 - 0x1p-24));
  m->clear *= 1 - rgba[3];
  m->depth += depth;
  for (int c = 0; c < 3; ++c)
  {
    m->sum[c] += depth * rgba[c];
  }
}

static void add_shape(mixture* m, const chi_transfer_shape* s, double x, double y, double weight)
{
  double rgba[4] = { s->rgba[0], s->rgba[1], s->rgba[2], s->rgba[3] * weight };
  if (s->kind == CHI_SHAPE_IMAGE)
  {
    read_image(s, x, y, rgba);
  }
  if (rgba[3] > 0)
  {
    add(m, rgba);
  }
}

static void finish(const mixture* m, double rgba[4])
{
  for (int c = 0; c < 3; ++c)
  {
    rgba[c] = m->depth > 0 ? fmin(m->sum[c] / m->depth, 1) : 0;
  }
  rgba[3] = 1 - m->clear;
}

chi_status chi_transfer_shapes_map(
  const chi_transfer_shape* shapes, size_t count, double x, double y, double rgba[4])
{
  if (!rgba || (count > 0 && !shapes))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  mixture m = nothing;
  for (size_t i = 0; i < count; ++i, shapes = next_of(shapes))
  {
    chi_transfer_shape s;
    if (!adopt(&s, shapes))
    {
      return CHI_ERROR_INVALID_ARGUMENT;
    }
    if (!isnan(x) && !isnan(y))
    {
      add_shape(&m, &s, x, y, s.kind == CHI_SHAPE_IMAGE ? 1 : weight_of(&s, x, y));
    }
  }
  finish(&m, rgba);
  return CHI_OK;
}

/*------------------------------------------------------------------------------------------------*/
enum
{
  CHUNKS = 16 /* of the rows, whatever the number of threads */
};

typedef struct table_job
{
  const chi_transfer_shape* shapes;
  size_t count, size[2];
  double first[2], step[2];
  float* rgba;
  mixture* mixtures; /* [CHUNKS][size[0]] */
  double* weights;   /* likewise */
  uint8_t* toggles;  /* [CHUNKS][PLACES size[0] + 1] */
} table_job;

/* Of a polygon, at PLACES along each step of one line: an edge that crosses it turns all to its
 * right from inside to outside, or back. Adds how many of each entry's places are inside. */
static void add_line(
  const table_job* it, const chi_transfer_shape* s, double y, uint8_t* toggles, double* weights)
{
  const size_t places = PLACES * it->size[0];
  const double step = it->step[0] / PLACES;
  const double first = it->first[0] - 0.5 * it->step[0] + 0.5 * step;
  memset(toggles, 0, places + 1);
  const double* a = s->polygon + 2 * (s->polygon_count - 1);
  for (size_t i = 0; i < s->polygon_count; ++i)
  {
    const double* const b = s->polygon + 2 * i;
    if ((a[1] <= y) != (b[1] <= y))
    {
      const double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      const double at = ceil((x - first) / step);
      toggles[at > 0 ? (at < (double)places ? (size_t)at : places) : 0] ^= 1;
    }
    a = b;
  }
  uint8_t inside = 0;
  for (size_t i = 0; i < it->size[0]; ++i)
  {
    unsigned sum = 0;
    for (size_t k = PLACES * i; k < PLACES * i + PLACES; ++k)
    {
      inside ^= toggles[k];
      sum += inside;
    }
    weights[i] += sum;
  }
}

/* Whether the shape is nothing in the rectangle of one step about the place. */
static int is_beside(const chi_transfer_shape* s, double x, double y, const double step[2])
{
  const int trapezoid = s->kind == CHI_SHAPE_TRAPEZOID;
  const double left = trapezoid ? fmin(s->low[0], s->top[0]) : s->low[0];
  const double right = trapezoid ? fmax(s->high[0], s->top[1]) : s->high[0];
  return fabs(2 * x - left - right) > right - left + step[0] ||
    fabs(2 * y - s->low[1] - s->high[1]) > s->high[1] - s->low[1] + step[1];
}

static double mean_weight(const chi_transfer_shape* s, double x, double y, const double step[2])
{
  double sum = 0;
  for (int k = 0; k < PLACES * PLACES && !is_beside(s, x, y, step); ++k)
  {
    sum += weight_of(s, x + ((k % PLACES + 0.5) / PLACES - 0.5) * step[0],
      y + ((k / PLACES + 0.5) / PLACES - 0.5) * step[1]);
  }
  return sum / (PLACES * PLACES);
}

/* Of all entries of a row. */
static void weigh(
  const table_job* it, const chi_transfer_shape* s, double y, uint8_t* toggles, double* weights)
{
  memset(weights, 0, it->size[0] * sizeof *weights);
  if (s->kind == CHI_SHAPE_POLYGON)
  {
    for (int k = 0; k < PLACES; ++k)
    {
      add_line(it, s, y + ((k + 0.5) / PLACES - 0.5) * it->step[1], toggles, weights);
    }
    for (size_t i = 0; i < it->size[0]; ++i)
    {
      weights[i] /= PLACES * PLACES;
    }
    return;
  }
  for (size_t i = 0; i < it->size[0]; ++i)
  {
    const double x = it->first[0] + (double)i * it->step[0];
    weights[i] = s->kind == CHI_SHAPE_GAUSSIAN ? in_gaussian(s, x, y)
      : s->kind == CHI_SHAPE_IMAGE             ? 1
                                               : mean_weight(s, x, y, it->step);
  }
}

static void fill_rows(void* data, size_t begin, size_t end)
{
  const table_job* const it = (const table_job*)data;
  const size_t width = it->size[0];
  for (size_t chunk = begin; chunk < end; ++chunk)
  {
    mixture* const mixtures = it->mixtures + chunk * width;
    double* const weights = it->weights + chunk * width;
    for (size_t j = chunk; j < it->size[1]; j += CHUNKS)
    {
      const double y = it->first[1] + (double)j * it->step[1];
      for (size_t i = 0; i < width; ++i)
      {
        mixtures[i] = nothing;
      }
      for (size_t k = 0; k < it->count; ++k)
      {
        weigh(it, it->shapes + k, y, it->toggles + chunk * (PLACES * width + 1), weights);
        for (size_t i = 0; i < width; ++i)
        {
          add_shape(
            mixtures + i, it->shapes + k, it->first[0] + (double)i * it->step[0], y, weights[i]);
        }
      }
      for (size_t i = 0; i < width; ++i)
      {
        double rgba[4];
        finish(mixtures + i, rgba);
        for (size_t c = 0; c < 4; ++c)
        {
          it->rgba[4 * (i + width * j) + c] = (float)rgba[c];
        }
      }
    }
  }
}

chi_status chi_transfer_shapes_table(const chi_exec* exec, const chi_transfer_shape* shapes,
  size_t count, const size_t size[2], const double x_range[2], const double y_range[2], float* rgba)
{
  if (!size || !x_range || !y_range || !rgba || (count > 0 && !shapes) || !size_is_valid(size) ||
    !range_is_valid(x_range[0], x_range[1]) || !range_is_valid(y_range[0], y_range[1]))
  {
    return CHI_ERROR_INVALID_ARGUMENT;
  }
  const size_t places = PLACES * size[0] + 1;
  chi_transfer_shape* const own =
    (chi_transfer_shape*)chi_alloc(exec, count + 1, sizeof(chi_transfer_shape));
  mixture* const mixtures = (mixture*)chi_alloc(exec, CHUNKS * size[0], sizeof(mixture));
  double* const weights = (double*)chi_alloc(exec, CHUNKS * size[0], sizeof(double));
  uint8_t* const toggles = (uint8_t*)chi_alloc(exec, CHUNKS * places, 1);
  chi_status status = own && mixtures && weights && toggles ? CHI_OK : CHI_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count && status == CHI_OK; ++i, shapes = next_of(shapes))
  {
    status = adopt(own + i, shapes) ? CHI_OK : CHI_ERROR_INVALID_ARGUMENT;
  }
  if (status == CHI_OK)
  {
    table_job job = { own, count, { size[0], size[1] }, { x_range[0], y_range[0] },
      { (x_range[1] - x_range[0]) / (double)(size[0] - 1),
        (y_range[1] - y_range[0]) / (double)(size[1] - 1) },
      rgba, mixtures, weights, toggles };
    status = chi_for(exec, CHUNKS, fill_rows, &job);
  }
  chi_free(exec, own, count + 1, sizeof(chi_transfer_shape));
  chi_free(exec, mixtures, CHUNKS * size[0], sizeof(mixture));
  chi_free(exec, weights, CHUNKS * size[0], sizeof(double));
  chi_free(exec, toggles, CHUNKS * places, 1);
  return status;
}
