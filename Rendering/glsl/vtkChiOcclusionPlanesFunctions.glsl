// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Visibility that samples read from the light planes.
#if HAS_LIGHT
uniform sampler2D planeTexture0; // visibility at three light planes that follow each other
uniform sampler2D planeTexture1;
uniform sampler2D planeTexture2;
uniform vec3 planeThere;    // 0: before the first plane, where all light arrives
uniform vec3 planeRange;    // plane of the first slice, counted from planeTexture0; a segment's step; most
uniform vec3 lightWeight[3]; // of light pixels -1, 0, 1 at offsets -1/4, 0, 1/4
uniform float strength;

// Visibility at the three of them.
struct Planes
{
  LIGHT first, second, third;
};

Planes planesAt(ivec2 q, ivec2 last)
{
  q = clamp(q, ivec2(0), last);
  return Planes(mix(LIGHT(1.0), texelFetch(planeTexture0, q, 0).CHANNELS, planeThere.x),
    mix(LIGHT(1.0), texelFetch(planeTexture1, q, 0).CHANNELS, planeThere.y),
    mix(LIGHT(1.0), texelFetch(planeTexture2, q, 0).CHANNELS, planeThere.z));
}

// At a pixel, before it is cut to 0 ... 1. Eq. 5.
Planes planesHere(ivec2 pixel)
{
  ivec2 last = textureSize(planeTexture0, 0) - 1;
#if LIGHT_SCALE == 1
  return planesAt(pixel, last);
#else
  vec3 u = (pixel.x & 1) == 0 ? lightWeight[0] : lightWeight[2];
  vec3 v = (pixel.y & 1) == 0 ? lightWeight[0] : lightWeight[2];
  Planes sum = Planes(LIGHT(0.0), LIGHT(0.0), LIGHT(0.0));
  for (int b = 0; b < 3; ++b)
  {
    for (int a = 0; a < 3; ++a)
    {
      Planes at = planesAt(pixel / 2 + ivec2(a - 1, b - 1), last);
      sum.first += u[a] * v[b] * at.first;
      sum.second += u[a] * v[b] * at.second;
      sum.third += u[a] * v[b] * at.third;
    }
  }
  return sum;
#endif
}

LIGHT visibilityAt(Planes planes, int segment)
{
  float plane = min(planeRange.x + float(segment) * planeRange.y, planeRange.z);
  // plane -1 and all before it: all light
  float low = clamp(1.0 - abs(plane), 0.0, 1.0);
  float middle = clamp(1.0 - abs(plane - 1.0), 0.0, 1.0);
  float high = clamp(1.0 - abs(plane - 2.0), 0.0, 1.0);
  LIGHT v = low * planes.first + middle * planes.second + high * planes.third;
  return clamp(1.0 - strength * (low + middle + high - v), 0.0, 1.0);
}
#endif
