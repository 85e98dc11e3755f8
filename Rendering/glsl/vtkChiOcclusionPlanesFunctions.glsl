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

vec3 planesAt(ivec2 q, ivec2 last)
{
  q = clamp(q, ivec2(0), last);
  vec3 v = vec3(texelFetch(planeTexture0, q, 0).r, texelFetch(planeTexture1, q, 0).r,
    texelFetch(planeTexture2, q, 0).r);
  return mix(vec3(1.0), v, planeThere);
}

// Visibility at the three planes, before it is cut to 0 ... 1. Eq. 5.
vec3 planesHere(ivec2 pixel)
{
  ivec2 last = textureSize(planeTexture0, 0) - 1;
#if LIGHT_SCALE == 1
  return planesAt(pixel, last);
#else
  vec3 u = (pixel.x & 1) == 0 ? lightWeight[0] : lightWeight[2];
  vec3 v = (pixel.y & 1) == 0 ? lightWeight[0] : lightWeight[2];
  vec3 sum = vec3(0.0);
  for (int b = 0; b < 3; ++b)
  {
    for (int a = 0; a < 3; ++a)
    {
      sum += u[a] * v[b] * planesAt(pixel / 2 + ivec2(a - 1, b - 1), last);
    }
  }
  return sum;
#endif
}

float visibilityAt(vec3 planes, int segment)
{
  float plane = min(planeRange.x + float(segment) * planeRange.y, planeRange.z);
  // plane -1 and all before it: all light
  float low = clamp(1.0 - abs(plane), 0.0, 1.0);
  float middle = clamp(1.0 - abs(plane - 1.0), 0.0, 1.0);
  float high = clamp(1.0 - abs(plane - 2.0), 0.0, 1.0);
  float v = low * planes.x + middle * planes.y + high * planes.z;
  return clamp(1.0 - strength * (low + middle + high - v), 0.0, 1.0);
}
#endif
