// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A transfer function of two quantities: behind the table of one, a row of it for each step of the
// second quantity (classify_plane in simd/chi_occlusion_shade.inl).
#if HAS_ROWS
uniform vec3 rowScale; // base, scale, last: row = (quantity - base) scale, 0 ... last
uniform float rowQuantum;

// Integral of a row's extinction up to a table position: a sum in quanta, and what the interval
// adds; the extinction there.
float rowDepthUpTo(int first, float t, out int sum, out float extinction)
{
  int entry = min(int(t), ENTRIES - 2);
  float f = t - float(entry);
  ivec2 at = entryPlace(first + entry);
  vec2 sigma = texelFetch(sigmaTexture, at, 0).rg;
  sum = texelFetch(sumTexture, at, 0).r;
  extinction = sigma.x + 2.0 * f * sigma.y;
  return f * (sigma.x + f * sigma.y);
}

// Mean extinction of a segment on the row whose first entry this is.
float rowExtinction(int first, float near, float change)
{
  int sum0;
  int sum1;
  float extinction;
  if (abs(change) <= 1.0)
  {
    rowDepthUpTo(first, near + 0.5 * change, sum0, extinction);
    return max(extinction, 0.0);
  }
  float rest0 = rowDepthUpTo(first, near, sum0, extinction);
  float rest1 = rowDepthUpTo(first, near + change, sum1, extinction);
  return max((float(sum1 - sum0) * rowQuantum + (rest1 - rest0)) / change, 0.0);
}

// Mean extinction of a segment from table position t0 to t1 where the second quantity is y, and the
// colour of its middle; t0 < 0: not known. 0 where y is not finite.
float extinctionOfTwo(float t0, float t1, float y, out vec3 rgb)
{
  rgb = vec3(0.0);
  if (!(abs(y) <= largest))
  {
    return 0.0;
  }
  float near = t0 < 0.0 ? t1 : t0;
  float v = clamp((y - rowScale.x) * rowScale.y, 0.0, rowScale.z);
  int row = min(int(v), int(rowScale.z) - 1);
  float f = v - float(row);
  int nearest = int(near + 0.5 * (t1 - near) + 0.5);
  int first = (row + 1) * ENTRIES;
  vec3 low = texelFetch(colorTexture, entryPlace(first + nearest), 0).rgb;
  vec3 high = texelFetch(colorTexture, entryPlace(first + ENTRIES + nearest), 0).rgb;
  rgb = low + f * (high - low);
  float below = rowExtinction(first, near, t1 - near);
  return below + f * (rowExtinction(first + ENTRIES, near, t1 - near) - below);
}

#if HAS_SECOND
uniform sampler3D secondTexture; // samples of the second quantity, where the volume's are

float secondAt(ivec3 i)
{
  return texelFetch(secondTexture, i, 0).r;
}

float fetchSecond(vec3 p)
{
#if NEAREST
  return secondAt(ivec3(p + 0.5));
#else
  ivec3 last = textureSize(secondTexture, 0) - 1;
  ivec3 i = min(ivec3(p), max(last - 1, ivec3(0)));
  ivec3 j = min(i + 1, last);
  vec3 f = p - vec3(i);
  vec4 a = vec4(secondAt(i), secondAt(ivec3(i.x, j.y, i.z)), secondAt(ivec3(i.xy, j.z)),
    secondAt(ivec3(i.x, j.yz)));
  vec4 b = vec4(secondAt(ivec3(j.x, i.yz)), secondAt(ivec3(j.xy, i.z)),
    secondAt(ivec3(j.x, i.y, j.z)), secondAt(j));
  return blend(a + f.x * (b - a), f.yz);
#endif
}
#endif

// What the rows are of; `p` lies in the grid.
float secondQuantity(vec3 p, vec3 gradient)
{
#if HAS_SECOND
  return fetchSecond(p);
#else
  return length(gradient);
#endif
}
#endif
