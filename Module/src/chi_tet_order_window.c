/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */
#include "chi_tet_order_internal.h"

#include <math.h>

chi_order_window chi_order_window_of(const chi_order_eye* eye)
{
  const chi_camera* const camera = eye->camera;
  chi_order_window w = { .size = { camera->width, camera->height },
    .parallel = eye->parallel,
    .near_depth = eye->parallel ? -INFINITY : camera->near_depth };
  for (int a = 0; a < 2; ++a)
  {
    w.step[a] = (camera->window[2 * a + 1] - camera->window[2 * a]) / w.size[a];
    w.first[a] = camera->window[2 * a] + chi_order_center[a] * w.step[a];
  }
  return w;
}

void chi_order_to_eye(const chi_order_eye* eye, const double x[3], double v[3])
{
  const double* const m = eye->to_eye;
  for (int r = 0; r < 3; ++r)
  {
    v[r] = m[4 * r] * x[0] + m[4 * r + 1] * x[1] + m[4 * r + 2] * x[2] + m[4 * r + 3];
  }
  v[2] = -v[2];
}

/* What of a body lies beyond the near plane is spanned by its vertices there and the points where
 * its edges pass the plane. */
chi_order_box chi_order_box_of(const chi_order_window* w, const double (*v)[3], int count)
{
  static const chi_order_box empty = { { 1, 0 }, { 1, 0 } };
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  for (int i = 0; i < count; ++i)
  {
    for (int j = i; j < count; ++j)
    {
      const double to_i = v[i][2] - w->near_depth, to_j = v[j][2] - w->near_depth;
      if (i == j ? !(to_i >= 0) : (to_i >= 0) == (to_j >= 0))
      {
        continue;
      }
      const double share = i == j ? 0 : to_i / (to_i - to_j);
      const double depth = i == j ? v[i][2] : w->near_depth;
      for (int a = 0; a < 2; ++a)
      {
        const double x = v[i][a] + share * (v[j][a] - v[i][a]);
        const double pixel = ((w->parallel ? x : x / depth) - w->first[a]) / w->step[a];
        low[a] = pixel < low[a] ? pixel : low[a];
        high[a] = pixel > high[a] ? pixel : high[a];
      }
    }
  }
  int16_t range[2][2];
  for (int a = 0; a < 2; ++a)
  {
    /* a margin for rounding, which costs a look at a pixel more at most */
    const double l = fmax(ceil(low[a] - 1e-6), 0), h = fmin(floor(high[a] + 1e-6), w->size[a] - 1);
    if (!(l <= h))
    {
      return empty;
    }
    range[a][0] = (int16_t)l;
    range[a][1] = (int16_t)h;
  }
  return (chi_order_box){ { range[0][0], range[0][1] }, { range[1][0], range[1][1] } };
}
