// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Samples of one slab: fetch, classify, composite, as the core's kernels do it
// (simd/chi_occlusion_sample.inl). Output 0 goes under what the rays have met already (blending
// ONE_MINUS_DST_ALPHA, ONE), output 1 is the optical thickness of the slab along the view axis.
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

in vec2 texCoord;        // 0 to 1 over the target
uniform vec2 targetSize; // pixels

uniform VOLUME_SAMPLER volumeTexture;
uniform usampler3D brickTexture; // 0: transparent
uniform isampler2D sumTexture;   // integral of the extinction up to an entry, in quanta
uniform sampler2D sigmaTexture;  // extinction at an entry, half its change to the next one
uniform sampler2D colorTexture;
uniform int useBricks;
uniform vec3 tableScale; // base, scale, offset: entry = (scalar - base) scale + offset
uniform float quantum;

// Index position of a pixel at a slice, counted from this pixel and the slab's first slice.
uniform vec2 firstPixel;
uniform vec3 position;
uniform vec3 positionX; // its change a pixel
uniform vec3 positionY;
uniform vec3 direction; // its change a slice
uniform vec3 directionX;
uniform vec3 directionY;
uniform vec3 boxLow;
uniform vec3 boxHigh;
#if CLIPS > 0
uniform vec4 clip[CLIPS];
#endif
uniform vec2 raySlope;     // of pixel (0, 0)
uniform vec2 raySlopeStep; // its change a pixel
uniform float slice;       // world distance between slices
uniform int segments;
uniform int startsHere; // nothing has been sampled before the first slice
uniform float firstSlice;

#if HAS_SURFACE
uniform sampler2D surfaceTexture; // depth in slices, ...
#endif
#if HAS_LIGHT
uniform sampler2D planeTexture0; // visibility at three light planes that follow each other
uniform sampler2D planeTexture1;
uniform sampler2D planeTexture2;
uniform vec3 planeThere;    // 0: before the first plane, where all light arrives
uniform vec3 planeRange;    // plane of the first slice, counted from planeTexture0; a segment's step; most
uniform vec3 lightWeight[3]; // of light pixels -1, 0, 1 at offsets -1/4, 0, 1/4
uniform float strength;
#endif

const float largest = 3.402823e38; // infinite and NaN samples are not below it

ivec2 entryPlace(int entry)
{
  return ivec2(entry % TABLE_WIDTH, entry / TABLE_WIDTH);
}

float scalarAt(ivec3 i)
{
  return float(texelFetch(volumeTexture, i, 0).r);
}

float fetchScalar(vec3 p)
{
#if NEAREST
  return scalarAt(ivec3(p + 0.5));
#else
  ivec3 last = textureSize(volumeTexture, 0) - 1;
  ivec3 i = min(ivec3(p), max(last - 1, ivec3(0)));
  ivec3 j = min(i + 1, last);
  vec3 f = p - vec3(i);
  vec4 a = vec4(scalarAt(i), scalarAt(ivec3(i.x, j.y, i.z)), scalarAt(ivec3(i.x, i.y, j.z)),
    scalarAt(ivec3(i.x, j.yz)));
  vec4 b = vec4(scalarAt(ivec3(j.x, i.yz)), scalarAt(ivec3(j.xy, i.z)),
    scalarAt(ivec3(j.x, i.y, j.z)), scalarAt(j));
  vec4 line = a + f.x * (b - a);
  vec2 plane = line.xz + f.y * (line.yw - line.xz);
  return plane.x + f.z * (plane.y - plane.x);
#endif
}

// Place in the tables; -1: no visible sample.
float tablePosition(vec3 p)
{
  p = clamp(p, vec3(0.0), vec3(textureSize(volumeTexture, 0) - 1));
  if (useBricks != 0 && texelFetch(brickTexture, ivec3(p) / BRICK_EDGE, 0).r == 0u)
  {
    return -1.0;
  }
  float scalar = fetchScalar(p);
  if (!(abs(scalar) <= largest))
  {
    return -1.0;
  }
  return clamp((scalar - tableScale.x) * tableScale.y + tableScale.z, 0.0, float(ENTRIES - 1));
}

// Mean extinction of a segment from table position t0 to t1; t0 < 0: not known. Eq. 1 of
// theory/occlusion.md.
float meanExtinction(float t0, float t1)
{
  int entry = min(int(t1), ENTRIES - 2);
  float f = t1 - float(entry);
  vec2 sigma = texelFetch(sigmaTexture, entryPlace(entry), 0).rg;
  float change = t0 < 0.0 ? 0.0 : t1 - t0;
  if (abs(change) <= 1.0)
  {
    return max(sigma.x + (2.0 * f - change) * sigma.y, 0.0);
  }
  int before = min(int(t0), ENTRIES - 2);
  float g = t0 - float(before);
  vec2 old = texelFetch(sigmaTexture, entryPlace(before), 0).rg;
  int sums = texelFetch(sumTexture, entryPlace(entry), 0).r -
    texelFetch(sumTexture, entryPlace(before), 0).r;
  float rest = f * (sigma.x + f * sigma.y) - g * (old.x + g * old.y);
  return max((float(sums) * quantum + rest) / change, 0.0);
}

#if HAS_LIGHT
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

void main()
{
  vec2 pixel = floor(texCoord * targetSize);
  vec2 d = pixel - firstPixel;
  vec3 p = position + d.x * positionX + d.y * positionY;
  vec3 q = direction + d.x * directionX + d.y * directionY;

  // Where the ray enters and leaves the box, less what is clipped, in slices from the first one.
  float enter = -1.0;
  float leave = float(segments) + 1.0;
  for (int a = 0; a < 3; ++a)
  {
    if (q[a] == 0.0)
    {
      leave = p[a] >= boxLow[a] && p[a] <= boxHigh[a] ? leave : -2.0;
      continue;
    }
    float t0 = (boxLow[a] - p[a]) / q[a];
    float t1 = (boxHigh[a] - p[a]) / q[a];
    enter = max(enter, min(t0, t1));
    leave = min(leave, max(t0, t1));
  }
#if CLIPS > 0
  for (int k = 0; k < CLIPS; ++k)
  {
    float value = dot(clip[k], vec4(p, 1.0));
    float change = dot(clip[k].xyz, q);
    enter = change > 0.0 ? max(enter, -value / change) : enter;
    leave = change < 0.0 ? min(leave, -value / change)
      : change == 0.0 && value < 0.0 ? -2.0 : leave;
  }
#endif

  vec4 color = vec4(0.0);
  float thickness = 0.0;
  if (enter < leave && enter < float(segments) && leave > 0.0)
  {
#if HAS_SURFACE
    float surface = texelFetch(surfaceTexture, ivec2(pixel), 0).r - firstSlice;
#endif
    vec2 slope = raySlope + pixel * raySlopeStep;
    float ray = sqrt(1.0 + dot(slope, slope));
    float through = 1.0;
    float before = -1.0;
    bool known = false; // before: the table position at the near slice
#if HAS_LIGHT
    vec3 planes = vec3(0.0);
    bool lit = false; // planes are those of this pixel
#endif
    int begin = max(int(floor(enter)), 0);
    int end = min(int(ceil(leave)), segments);
    for (int i = begin; i < end; ++i)
    {
      float near = float(i);
      float stop = min(near + 1.0, leave);
      float fraction = max(stop - max(near, enter), 0.0);
      bool entering = enter >= near || (startsHere != 0 && i == 0);
#if NEAREST
      float place = 0.5 * (max(near, enter) + stop); // the middle's label is the segment's
      float ahead = near - 0.5;
#else
      float place = stop;
      float ahead = near;
#endif
      if (!known && !entering)
      {
        before = tablePosition(p + ahead * q);
      }
      float t = tablePosition(p + place * q);
#if NEAREST
      float t0 = -1.0; // samples are steps: nothing lies between two labels
#else
      float t0 = entering ? -1.0 : before;
#endif
      bool valid = t >= 0.0 && (entering || before >= 0.0);
      before = t;
      known = true;
      if (!valid)
      {
        continue;
      }
      float depth = meanExtinction(t0, t) * (fraction * slice);
      thickness += depth;
#if HAS_SURFACE
      depth *= clamp(surface - near, 0.0, fraction) / max(fraction, 1e-30);
#endif
      if (!(depth > 0.0))
      {
        continue;
      }
      float weight = through * (1.0 - exp(-depth * ray));
      through -= weight;
#if HAS_LIGHT
      if (!lit)
      {
        planes = planesHere(ivec2(pixel));
        lit = true;
      }
      weight *= visibilityAt(planes, i);
#endif
      float middle = t0 < 0.0 ? t : 0.5 * (t + t0);
      color.rgb += weight * texelFetch(colorTexture, entryPlace(int(middle + 0.5)), 0).rgb;
    }
    color.a = 1.0 - through;
  }
  gl_FragData[0] = color;
  gl_FragData[1] = vec4(thickness);
}
