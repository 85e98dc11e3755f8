// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What surfaces within a few pixels take from a surface's light, both combined, and how much of the
// darkening is applied (Schott et al. 2013, Algorithm 5, Eqs 4 to 8; chi_vicinity.c).
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform sampler2D visibilityTexture;
uniform float strength;
#if SAMPLES > 0
uniform sampler2D surfaceMoreTexture; // ..., depth in world units, and where rays end
uniform vec2 disc[LIGHTS * SAMPLES]; // in radii
uniform vec2 radius;                 // of each light's disc, world units
uniform vec2 share;                  // of all light
uniform vec2 pixels;                 // a world unit (parallel), or a unit of slope
uniform float virtualSlice;          // its distance, world units
uniform float bias;
uniform float curvature; // what it leaves of a smooth surface, in radii
uniform float riseShare;
uniform float fade;

const float none = 1e30;

float depthAt(ivec2 pixel)
{
  ivec2 size = textureSize(surfaceMoreTexture, 0);
  bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, size));
  return inside ? min(texelFetch(surfaceMoreTexture, pixel, 0).b, none) : none;
}

#if PLANE_RULE
float slopeAt(ivec2 pixel, ivec2 step, float z)
{
  float ahead = depthAt(pixel + step);
  float behind = depthAt(pixel - step);
  float after = ahead - z;
  float before = z - behind;
  float slope = abs(after) < abs(before) ? after : before;
  return ahead >= none && behind >= none ? 0.0 : slope;
}
#endif

float vicinity(ivec2 pixel, float z)
{
  ivec2 size = textureSize(surfaceMoreTexture, 0);
#if PLANE_RULE
  vec2 slope = vec2(slopeAt(pixel, ivec2(1, 0), z), slopeAt(pixel, ivec2(0, 1), z));
#endif
  float blocked = 0.0;
  for (int k = 0; k < LIGHTS * SAMPLES; ++k)
  {
    int light = k / SAMPLES;
#if PARALLEL
    vec2 reach = pixels * radius[light];
#else
    vec2 reach = pixels * radius[light] / z;
#endif
    vec2 d = floor(disc[k] * reach + 0.5);
    if (any(greaterThanEqual(abs(d), vec2(size))))
    {
      continue;
    }
    float other = depthAt(pixel + ivec2(d));
#if PLANE_RULE
    float lead = z - other + dot(d, slope);
    float rise = dot(abs(d), abs(slope));
    blocked += lead > curvature * radius[light] + riseShare * rise
      ? share[light] * clamp(fade - lead / virtualSlice, 0.0, 1.0) : 0.0;
#else
    blocked += z - other > bias ? share[light] : 0.0;
#endif
  }
  return 1.0 - blocked / float(SAMPLES);
}
#endif

void main()
{
  ivec2 pixel = ivec2(texCoord * targetSize);
  LIGHT v = texelFetch(visibilityTexture, pixel, 0).CHANNELS;
#if SAMPLES > 0
  float z = texelFetch(surfaceMoreTexture, pixel, 0).a;
  if (z < none)
  {
    float near = vicinity(pixel, z);
#if COMBINE_MINIMUM
    v = min(v, LIGHT(near));
#else
    v *= near;
#endif
  }
#endif
  v = 1.0 - strength * (1.0 - v);
#if COLORED
  gl_FragData[0] = vec4(v, (v.r + v.g + v.b) / 3.0);
#else
  gl_FragData[0] = vec4(v);
#endif
}
