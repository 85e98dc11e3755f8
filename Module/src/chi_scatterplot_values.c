/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Values of fields as doubles, and in units of bins. */

#include "chi_scatterplot_internal.h"

#include <math.h>

double chi_scatter_value(const chi_array_view* values, int32_t component, size_t i)
{
  const char* const at = (const char*)values->data + i * values->stride;
  const size_t size = chi_type_size(values->type);
  if (component >= 0)
  {
    return chi_number_at(at + (size_t)component * size, values->type);
  }
  double largest = 0, sum = 0; /* so that squares do not leave the range of double */
  for (size_t k = 0; k < values->components; ++k)
  {
    const double x = fabs(chi_number_at(at + k * size, values->type));
    largest = x > largest || x != x ? x : largest;
  }
  if (!(largest > 0) || largest == INFINITY)
  {
    return largest;
  }
  const double scale = ldexp(1, -ilogb(largest));
  for (size_t k = 0; k < values->components; ++k)
  {
    const double x = chi_number_at(at + k * size, values->type) * scale;
    sum += x * x;
  }
  return sqrt(sum) / scale;
}

/* The type is chosen once for all, so that the loops are tight. */
#define EACH_TYPE(LOOP)                                                                            \
  switch (values->type)                                                                            \
  {                                                                                                \
    case CHI_F32:                                                                                  \
      LOOP(float)                                                                                  \
      break;                                                                                       \
    case CHI_F64:                                                                                  \
      LOOP(double)                                                                                 \
      break;                                                                                       \
    case CHI_I8:                                                                                   \
      LOOP(int8_t)                                                                                 \
      break;                                                                                       \
    case CHI_U8:                                                                                   \
      LOOP(uint8_t)                                                                                \
      break;                                                                                       \
    case CHI_I16:                                                                                  \
      LOOP(int16_t)                                                                                \
      break;                                                                                       \
    case CHI_U16:                                                                                  \
      LOOP(uint16_t)                                                                               \
      break;                                                                                       \
    case CHI_I32:                                                                                  \
      LOOP(int32_t)                                                                                \
      break;                                                                                       \
    case CHI_U32:                                                                                  \
      LOOP(uint32_t)                                                                               \
      break;                                                                                       \
    case CHI_I64:                                                                                  \
      LOOP(int64_t)                                                                                \
      break;                                                                                       \
    default:                                                                                       \
      LOOP(uint64_t)                                                                               \
      break;                                                                                       \
  }

void chi_scatter_load(
  const chi_array_view* values, int32_t component, size_t first, size_t count, double* out)
{
  if (component < 0)
  {
    for (size_t i = 0; i < count; ++i)
    {
      out[i] = chi_scatter_value(values, component, first + i);
    }
    return;
  }
  const size_t stride = values->stride;
  const char* const at =
    (const char*)values->data + first * stride + (size_t)component * chi_type_size(values->type);
#define LOAD(type)                                                                                 \
  for (size_t i = 0; i < count; ++i)                                                               \
  {                                                                                                \
    type x;                                                                                        \
    memcpy(&x, at + i * stride, sizeof x);                                                         \
    out[i] = (double)x;                                                                            \
  }
  EACH_TYPE(LOAD)
#undef LOAD
}

void chi_scatter_gather(const chi_array_view* values, int32_t component, const uint32_t* ids,
  size_t limit, size_t count, double* out)
{
  if (component < 0)
  {
    for (size_t i = 0; i < count; ++i)
    {
      out[i] = chi_scatter_value(values, component, ids[i] < limit ? ids[i] : 0);
    }
    return;
  }
  const size_t stride = values->stride;
  const char* const at =
    (const char*)values->data + (size_t)component * chi_type_size(values->type);
#define GATHER(type)                                                                               \
  for (size_t i = 0; i < count; ++i)                                                               \
  {                                                                                                \
    type x;                                                                                        \
    const size_t id = ids[i] < limit ? ids[i] : 0;                                                 \
    memcpy(&x, at + id * stride, sizeof x);                                                        \
    out[i] = (double)x;                                                                            \
  }
  EACH_TYPE(GATHER)
#undef GATHER
}

void chi_scatter_map(const chi_scatter_plot* plot, int axis, double* values, size_t count)
{
  const double low = plot->low[axis], scale = plot->scale[axis], snap = plot->snap;
  const double far = CHI_SCATTER_FAR;
  for (size_t i = 0; i < count; ++i)
  {
    double x = (values[i] - low) * scale;
    x = x < far ? x : far;
    x = x > -far ? x : -far;
    values[i] = (x + snap) - snap;
  }
}
