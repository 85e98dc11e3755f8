/* SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors */
/* SPDX-License-Identifier: BSD-3-Clause */

/* Vicinity of the surfaces of a row, a lane a pixel; chi_vicinity.c says what it is. Included by
 * chi_occlusion_kernels.inl. Depths are subtracted before anything is added: differences of floats
 * that are near each other are exact, however far away the surface is. */

/* Depth of pixels, INFINITY where there is none. */
CHI_INLINE vf depth_at(const chi_vicinity_row* r, vi x, vi y, vi mask)
{
  const vi inside = (x >= 0) & (x < r->width) & (y >= 0) & (y < r->height) & mask;
  const vf z = vf_gather(r->depth, y * r->width + x, 4, inside);
  return vf_select(inside & (z > 0.0f), z, vf_set(INFINITY));
}

/* Rise of the surface's own tangent plane a pixel: the flatter of both sides, so that the step to
 * another surface does not count. */
CHI_INLINE vf slope_at(const chi_vicinity_row* r, vi x, vi y, int dx, int dy, vf z, vi mask)
{
  const vf after = depth_at(r, x + dx, y + dy, mask) - z;
  const vf before = z - depth_at(r, x - dx, y - dy, mask);
  const vf slope = vf_select(vf_max(after, -after) < vf_max(before, -before), after, before);
  return vf_select(slope - slope == 0.0f, slope, vf_set(0.0f));
}

/* The nearest whole number; what lies beyond 2^24 is clamped. */
CHI_INLINE vf nearest_whole(vf v)
{
  v = vf_min(vf_max(v + 0.5f, vf_set(-16777216.0f)), vf_set(16777216.0f));
  const vf whole = vi_float(vf_int(v));
  return vf_select(whole > v, whole - 1.0f, whole);
}

/* What is left of the light of pixels [x, x + CHI_LANES) of the row. */
CHI_INLINE vf vicinity_of(const chi_vicinity_row* r, vf z, int x, vi mask)
{
  const vf zero = vf_set(0.0f), one = vf_set(1.0f);
  const vi px = vf_int(vf_iota()) + x, py = vi_set(r->y);
  const int plane = !(r->bias > 0);
  const vf slope_x = plane ? slope_at(r, px, py, 1, 0, z, mask) : zero;
  const vf slope_y = plane ? slope_at(r, px, py, 0, 1, z, mask) : zero;
  vf left = one;
  for (int light = 0; light < r->lights; ++light)
  {
    const float radius = r->radius[light];
    const vf scale = r->parallel ? vf_set(radius) : radius / z;
    const vf reach_x = r->pixels[0] * scale, reach_y = r->pixels[1] * scale;
    vf blocked = zero;
    for (int k = 0; k < r->count; ++k)
    {
      const vf dx = nearest_whole(r->disc[light][0][k] * reach_x);
      const vf dy = nearest_whole(r->disc[light][1][k] * reach_y);
      const vf lean_x = dx * slope_x, lean_y = dy * slope_y;
      const vf lead = z - depth_at(r, px + vf_int(dx), py + vf_int(dy), mask) + (lean_x + lean_y);
      if (!plane)
      {
        blocked += vf_select(lead > r->bias, one, zero);
        continue;
      }
      const vf rise = vf_max(lean_x, -lean_x) + vf_max(lean_y, -lean_y);
      const vf share = vf_min(vf_max(r->fade - lead * r->inverse_distance, zero), one);
      blocked += vf_select(lead > r->curvature[light] + r->rise * rise, share, zero);
    }
    left -= r->share[light] * blocked;
  }
  return left;
}

static void vicinity(const chi_vicinity_row* r, int begin, int end)
{
  for (int x = begin; x < end; x += CHI_LANES)
  {
    /* rows are not padded */
    float z[CHI_LANES], left[CHI_LANES];
    const int count = end - x < CHI_LANES ? end - x : CHI_LANES;
    for (int i = 0; i < CHI_LANES; ++i)
    {
      z[i] = i < count ? r->receiver[x + i] : INFINITY;
    }
    const vf depth = vf_load(z);
    const vi there = (depth > 0.0f) & (depth < INFINITY);
    vf_store(left, vi_any(there) ? vicinity_of(r, depth, x, there) : vf_set(1.0f));
    for (int i = 0; i < count; ++i)
    {
      r->left[x + i - begin] = left[i];
    }
  }
}
