// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Colour and transmittance of a segment along which the scalar is linear, from the core's tables
// (simd/chi_segment.inl; equations of theory/preintegration.md). Places x and y are (front, back).

#if METHOD == METHOD_PARTIAL || SEPARATE
uniform sampler2D psiTexture; // PSI_SIZE^2 entries, x: the front's optical depth

// Moreland & Angel's psi, bilinear between the entries of its table.
float psiOf(vec2 tau)
{
  vec2 place = tau / (1.0 + tau) * float(PSI_SIZE - 1);
  ivec2 i = min(ivec2(place), ivec2(PSI_SIZE - 2));
  vec2 f = place - vec2(i);
  float near =
    mix(texelFetch(psiTexture, i, 0).r, texelFetch(psiTexture, i + ivec2(1, 0), 0).r, f.x);
  float next = mix(texelFetch(psiTexture, i + ivec2(0, 1), 0).r,
    texelFetch(psiTexture, i + ivec2(1, 1), 0).r, f.x);
  return mix(near, next, f.y);
}

vec4 linearSegment(vec3 front, vec3 back, vec2 extinction, float path)
{
  vec2 tau = extinction * path;
  float psi = psiOf(tau);
  float through = exp(-0.5 * (tau.x + tau.y));
  return vec4(front * (1.0 - psi) + back * (psi - through), through);
}
#endif

#if HAS_PLANE
uniform float planeStep; // entries that a part may cross
uniform int planeParts;  // at most

// From (x.x, y.x) to (x.y, y.y), in parts that are integrated partially.
vec4 segmentOf(vec2 x, vec2 y, float path)
{
  vec2 from = vec2(x.x, y.x);
  vec2 way = vec2(x.y, y.y) - from;
#if METHOD == METHOD_NONE
  vec4 middle = planeAt(from + 0.5 * way);
  float clear = exp(-middle.a * path);
  return vec4(middle.rgb * (1.0 - clear), clear);
#else
  int parts = 1;
#if METHOD == METHOD_FULL
  parts = min(int(max(abs(way.x), abs(way.y)) / planeStep) + 1, planeParts);
#endif
  vec4 sum = vec4(0.0, 0.0, 0.0, 1.0);
  vec4 front = planeAt(from);
  for (int k = 1; k <= parts; ++k)
  {
    vec4 back = planeAt(from + way * min(float(k) / float(parts), 1.0));
    vec4 part = linearSegment(front.rgb, back.rgb, vec2(front.a, back.a), path / float(parts));
    sum = vec4(sum.rgb + sum.a * part.rgb, sum.a * part.a);
    front = back;
  }
  return sum;
#endif
}

#elif SEPARATE
// Colours at x, extinctions at y.
vec4 segmentOf(vec2 x, vec2 y, float path)
{
#if METHOD == METHOD_NONE
  x = vec2(0.5 * (x.x + x.y));
  y = vec2(0.5 * (y.x + y.y));
#endif
  return linearSegment(
    entryAt(x.x).rgb, entryAt(x.y).rgb, vec2(entryAt(y.x).a, entryAt(y.y).a), path);
}

#elif METHOD == METHOD_NONE
vec4 segmentOf(vec2 x, vec2 y, float path)
{
  vec4 middle = entryAt(0.5 * (x.x + x.y));
  float through = exp(-middle.a * path);
  return vec4(middle.rgb * (1.0 - through), through);
}

#elif METHOD == METHOD_PARTIAL
vec4 segmentOf(vec2 x, vec2 y, float path)
{
  vec4 front = entryAt(x.x);
  vec4 back = entryAt(x.y);
  return linearSegment(front.rgb, back.rgb, vec2(front.a, back.a), path);
}

#elif METHOD == METHOD_FULL
uniform sampler2D depthTexture; // extinction, its integral in two parts, place in the full table
uniform sampler3D fullTexture;     // colour by front, back and optical depth

// Of the extinction of a part of an entry, from part a of it to part b.
float partOf(float here, float next, float a, float b)
{
  return (b - a) * (here + 0.5 * (a + b) * (next - here));
}

// Mean extinction between two places; places of both on the axes of the full table.
float meanExtinction(vec2 x, out vec2 axis)
{
  float low = min(x.x, x.y);
  float high = max(x.x, x.y);
  int i = int(low);
  int j = int(high);
  vec4 a = texelFetch(depthTexture, rowOf(i), 0);
  vec4 afterA = texelFetch(depthTexture, rowOf(i + 1), 0);
  vec4 b = texelFetch(depthTexture, rowOf(j), 0);
  vec4 afterB = texelFetch(depthTexture, rowOf(j + 1), 0);
  float f = low - float(i);
  float g = high - float(j);
  float sum = partOf(a.x, afterA.x, f, i < j ? 1.0 : g);
  if (i < j)
  {
    sum += (b.y - afterA.y) + (b.z - afterA.z) + partOf(b.x, afterB.x, 0.0, g);
  }
  vec2 rising = vec2(a.w + f * (afterA.w - a.w), b.w + g * (afterB.w - b.w));
  axis = x.x < x.y ? rising : rising.yx;
  return high > low ? sum / (high - low) : a.x + f * (afterA.x - a.x);
}

// Trilinear, of whole floats: the hardware's filters have weights of 8 bits.
vec3 fullAt(vec3 place)
{
  ivec3 i = min(ivec3(place), textureSize(fullTexture, 0) - 2);
  vec3 f = place - vec3(i);
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 8; ++k)
  {
    ivec3 up = ivec3(k & 1, k >> 1 & 1, k >> 2);
    vec3 w = mix(1.0 - f, f, vec3(up));
    sum += w.x * w.y * w.z * texelFetch(fullTexture, i + up, 0).rgb;
  }
  return sum;
}

vec4 segmentOf(vec2 x, vec2 y, float path)
{
  vec2 axis;
  float tau = meanExtinction(x, axis) * path;
  float through = exp(-tau);
  float depth = tau / (1.0 + tau) * float(textureSize(fullTexture, 0).z - 1);
  return vec4(fullAt(vec3(axis, depth)) * (1.0 - through), through);
}
#endif
