// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What stands in light's way through a slab, and what it brings from the slab before.
#if HAS_TAU
uniform sampler2D tauTexture;
uniform sampler2D tauBeforeTexture; // the slab before
uniform vec2 raySlope;              // of light pixel (0, 0)
uniform vec2 raySlopeStep;
uniform float attenuation; // of the optical thickness
uniform float meanLength;  // of the cone's paths, times attenuation
uniform float thin;
#endif
#if HAS_GEOMETRY
uniform sampler2D surfaceTexture;     // ..., slabs that a surface begins and ends to block
uniform sampler2D surfaceMoreTexture; // share of light that it blocks, ...
uniform float slab;
#endif

#if HAS_TAU
#if LIGHT_SCALE == 1
float lightThickness(ivec2 q)
{
  return texelFetch(tauTexture, q, 0).r;
}
#else
vec4 fourPixels(sampler2D from, ivec2 q)
{
  ivec2 p = 2 * q;
  return vec4(texelFetch(from, p, 0).r, texelFetch(from, p + ivec2(1, 0), 0).r,
    texelFetch(from, p + ivec2(0, 1), 0).r, texelFetch(from, p + ivec2(1, 1), 0).r);
}

// Thickness whose transmittance is the mean of four pixels'. Eq. 4.
float lightThickness(ivec2 q)
{
  vec4 tau = fourPixels(tauTexture, q);
  if (max(max(tau.x, tau.y), max(tau.z, tau.w)) <= thin)
  {
    return dot(tau, vec4(0.25));
  }
  vec4 before = exp(-meanLength * fourPixels(tauBeforeTexture, q));
  float joint = max(dot(exp(-meanLength * tau), before), 4e-30);
  return max((log(max(dot(before, vec4(1.0)), 4e-30)) - log(joint)) / meanLength, 0.0);
}
#endif
#endif

#if HAS_GEOMETRY
float geometryThrough(ivec2 q)
{
  ivec2 size = textureSize(surfaceTexture, 0);
  float blocked = 0.0;
  for (int j = 0; j < LIGHT_SCALE; ++j)
  {
    for (int i = 0; i < LIGHT_SCALE; ++i)
    {
      ivec2 p = LIGHT_SCALE * q + ivec2(i, j);
      if (p.x < size.x && p.y < size.y)
      {
        vec2 range = texelFetch(surfaceTexture, p, 0).ba;
        blocked += range.x < slab + 1.0 && range.y >= slab
          ? texelFetch(surfaceMoreTexture, p, 0).r : 0.0;
      }
    }
  }
  return 1.0 - blocked / float(LIGHT_SCALE * LIGHT_SCALE);
}
#endif

vec4 tap(sampler2D from, vec2 at, vec4 weight)
{
  vec2 pixel = 1.0 / vec2(textureSize(from, 0));
  vec2 low = at * pixel;
  vec2 high = (at + 1.0) * pixel;
  return weight.x * textureLod(from, low, 0.0) + weight.y * textureLod(from, vec2(high.x, low.y), 0.0) +
    weight.z * textureLod(from, vec2(low.x, high.y), 0.0) + weight.w * textureLod(from, high, 0.0);
}
