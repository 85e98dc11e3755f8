/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_segment.inl"
#include "chi_segment_kernels.h"

/* One vector of segments; what stands in the arrays is made safe first. */
CHI_INLINE void evaluate_vector(
  const chi_segment_tables* t, const float* x0, const float* x1, const float* length, vf out[4])
{
  const vf zero = vf_set(0), end = vf_set((float)(t->count - 1));
  const vf a = vf_min(vf_max(vf_load(x0), zero), end);
  const vf b = vf_min(vf_max(vf_load(x1), zero), end);
  const vf l = vf_max(vf_load(length), zero);
  if (t->method == CHI_PREINTEGRATION_FULL)
  {
    segment_full(t, a, b, l, out);
  }
  else if (t->method == CHI_PREINTEGRATION_PARTIAL)
  {
    segment_partial(t, a, b, l, out);
  }
  else
  {
    segment_none(t, a, b, l, out);
  }
}

static void evaluate(const chi_segment_tables* tables, size_t count, const float* x0,
  const float* x1, const float* length, float* rgba)
{
  for (size_t i = 0; i < count; i += CHI_LANES)
  {
    const size_t n = count - i < CHI_LANES ? count - i : CHI_LANES;
    float in[3][CHI_LANES] = { { 0 } }, column[4][CHI_LANES];
    memcpy(in[0], x0 + i, n * sizeof(float));
    memcpy(in[1], x1 + i, n * sizeof(float));
    memcpy(in[2], length + i, n * sizeof(float));
    vf out[4];
    evaluate_vector(tables, in[0], in[1], in[2], out);
    out[3] = 1.0f - out[3];
    for (int c = 0; c < 4; ++c)
    {
      vf_store(column[c], out[c]);
    }
    for (size_t k = 0; k < n; ++k)
    {
      for (int c = 0; c < 4; ++c)
      {
        rgba[4 * (i + k) + (size_t)c] = column[c][k];
      }
    }
  }
}
