/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_segment.inl"
#include "chi_segment_kernels.h"

typedef void (*segment_method)(const chi_segment_tables*, vf, vf, vf, vf[4]);

/* One vector of segments; what stands in the arrays is made safe first. */
CHI_INLINE void evaluate_vector(const chi_segment_tables* t, segment_method method, const float* x0,
  const float* x1, const float* length, float (*rgba)[4])
{
  const vf zero = vf_set(0), end = vf_set((float)(t->count - 1));
  const vf a = vf_min(vf_max(vf_load(x0), zero), end);
  const vf b = vf_min(vf_max(vf_load(x1), zero), end);
  const vf l =
    vf_min(vf_max(vf_load(length), zero), vf_set(1e20f)); /* optical depths stay finite */
  vf out[4];
  method(t, a, b, l, out);
  out[3] = 1.0f - out[3];
  vf_store_entries(rgba, out);
}

CHI_INLINE void evaluate_all(const chi_segment_tables* t, segment_method method, size_t count,
  const float* x0, const float* x1, const float* length, float (*rgba)[4])
{
  size_t i = 0;
  for (; i + CHI_LANES <= count; i += CHI_LANES)
  {
    evaluate_vector(t, method, x0 + i, x1 + i, length + i, rgba + i);
  }
  if (i < count)
  {
    const size_t rest = count - i;
    float last[3][CHI_LANES] = { { 0 } }, colors[CHI_LANES][4];
    memcpy(last[0], x0 + i, rest * sizeof(float));
    memcpy(last[1], x1 + i, rest * sizeof(float));
    memcpy(last[2], length + i, rest * sizeof(float));
    evaluate_vector(t, method, last[0], last[1], last[2], colors);
    memcpy(rgba + i, colors, rest * sizeof colors[0]);
  }
}

static void evaluate(const chi_segment_tables* tables, size_t count, const float* x0,
  const float* x1, const float* length, float* rgba)
{
  if (tables->method == CHI_PREINTEGRATION_FULL)
  {
    evaluate_all(tables, segment_full, count, x0, x1, length, (float(*)[4])rgba);
  }
  else if (tables->method == CHI_PREINTEGRATION_PARTIAL)
  {
    evaluate_all(tables, segment_partial, count, x0, x1, length, (float(*)[4])rgba);
  }
  else
  {
    evaluate_all(tables, segment_none, count, x0, x1, length, (float(*)[4])rgba);
  }
}
