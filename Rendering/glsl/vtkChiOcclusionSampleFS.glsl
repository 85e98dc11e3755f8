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
#if COLOR_PARTS > 0
uniform isampler2D colorSumTexture; // integral of extinction times colour, in quanta
uniform sampler2D colorMeanTexture; // up to the next entry, weighted by extinction
uniform float colorStep;  // entries a segment may cross before its middle's colour is too coarse
uniform float colorWorth; // entries times weight that are worth the effort
uniform float colorEven;  // entries from which parts must be placed
uniform float colorThin;  // optical thickness below which exponentials lose their digits
#endif
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

#if COLOR_PARTS > 0
// Integral of extinction up to a table position: a sum in quanta, and what the interval adds.
float depthUpTo(float t, out int sum, out ivec2 at)
{
  int entry = min(int(t), ENTRIES - 2);
  float f = t - float(entry);
  at = entryPlace(entry);
  sum = texelFetch(sumTexture, at, 0).r;
  vec2 sigma = texelFetch(sigmaTexture, at, 0).rg;
  return f * (sigma.x + f * sigma.y);
}

// Shares of a segment's scalar interval that cut it into parts of about equal weight: place_cuts.
void placeCuts(float near, float change, float tau, out float share[COLOR_PARTS + 1])
{
  float depth[COLOR_STEPS + 1];
  int first = 0;
  float rest0 = 0.0;
  for (int k = 0; k <= COLOR_STEPS; ++k)
  {
    int sum;
    ivec2 at;
    float t = clamp(near + change * (float(k) / float(COLOR_STEPS)), 0.0, float(ENTRIES - 1));
    float rest = depthUpTo(t, sum, at);
    first = k == 0 ? sum : first;
    rest0 = k == 0 ? rest : rest0;
    depth[k] = float(sum - first) * quantum + (rest - rest0); // falls where the scalar falls
  }
  float all = depth[COLOR_STEPS];
  float known = max(tau, colorThin); // below, weight and optical depth are the same
  float alpha = 1.0 - exp(-known);
  share[0] = 0.0;
  share[COLOR_PARTS] = 1.0;
  for (int j = 1; j < COLOR_PARTS; ++j)
  {
    float wanted = all * (log(1.0 - alpha * (float(j) / float(COLOR_PARTS))) / -known);
    float sum = 0.0;
    for (int k = 0; k < COLOR_STEPS; ++k)
    {
      float here = depth[k + 1] - depth[k];
      float left = wanted - depth[k];
      // without extinction there: the whole step, or none of it
      sum += here != 0.0 ? clamp(left / here, 0.0, 1.0) : left * change > 0.0 ? 1.0 : 0.0;
    }
    share[j] = sum / float(COLOR_STEPS);
  }
}

// Colour of a segment that crosses much of the transfer function: integrate_colors, Eq. 1a.
vec3 integrateColors(float near, float change, float tau)
{
  float share[COLOR_PARTS + 1];
  for (int k = 0; k <= COLOR_PARTS; ++k)
  {
    share[k] = float(k) / float(COLOR_PARTS);
  }
  if (abs(change) > colorEven)
  {
    placeCuts(near, change, tau, share);
  }
  float depth[COLOR_PARTS];
  float middle[COLOR_PARTS];
  vec3 color[COLOR_PARTS];
  bool any[COLOR_PARTS];
  float end = 0.0;
  int sum0 = 0;
  float rest0 = 0.0;
  ivec3 sums0 = ivec3(0);
  vec3 rests0 = vec3(0.0);
  for (int k = 0; k <= COLOR_PARTS; ++k)
  {
    int sum;
    ivec2 at;
    float rest = depthUpTo(clamp(near + change * share[k], 0.0, float(ENTRIES - 1)), sum, at);
    ivec3 sums = texelFetch(colorSumTexture, at, 0).rgb;
    vec3 rests = texelFetch(colorMeanTexture, at, 0).rgb * rest;
    if (k > 0)
    {
      float part = float(sum - sum0) * quantum + (rest - rest0);
      bool some = part * change > 0.0; // up or down the table, extinction is positive
      vec3 mean = (vec3(sums - sums0) * quantum + (rests - rests0)) / (some ? part : 1.0);
      color[k - 1] = clamp(mean, 0.0, 1.0);
      any[k - 1] = some;
      depth[k - 1] = some ? part / change : 0.0;
      middle[k - 1] = end + 0.5 * depth[k - 1];
      end += depth[k - 1];
    }
    sum0 = sum;
    rest0 = rest;
    sums0 = sums;
    rests0 = rests;
  }
  float scale = tau / max(end, 1e-30);
  float clear = 1.0;
  float total = 0.0;
  vec3 rgb = vec3(0.0);
  for (int k = 0; k < COLOR_PARTS; ++k)
  {
    int before = k > 0 && any[max(k - 1, 0)] ? k - 1 : k;
    int after = k + 1 < COLOR_PARTS && any[min(k + 1, COLOR_PARTS - 1)] ? k + 1 : k;
    float d = depth[k] * scale;
    float e = exp(-d);
    bool thin = d < colorThin;
    float alpha = thin ? d * (1.0 - 0.5 * d * (1.0 - d / 3.0)) : 1.0 - e;
    float bend = thin ? d * d / 12.0 : d * e / (1.0 - e) - 1.0 + 0.5 * d;
    float slope = bend / max((middle[after] - middle[before]) * scale, 1e-6);
    float weight = clear * alpha;
    rgb += weight * clamp(color[k] - slope * (color[after] - color[before]), 0.0, 1.0);
    total += weight;
    clear *= e;
  }
  return rgb / max(total, 1e-30);
}
#endif

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
      float tau = depth * ray;
      float weight = through * (1.0 - exp(-tau));
      through -= weight;
      float change = t0 < 0.0 ? 0.0 : t - t0;
      vec3 rgb;
#if COLOR_PARTS > 0
      // The weight as if nothing lay before this slab: no less is integrated than in the core.
      if (abs(change) > colorStep && abs(change) * weight > colorWorth)
      {
        rgb = integrateColors(t0, change, tau);
      }
      else
#endif
      {
        rgb = texelFetch(colorTexture, entryPlace(int(t - 0.5 * change + 0.5)), 0).rgb;
      }
#if HAS_LIGHT
      if (!lit)
      {
        planes = planesHere(ivec2(pixel));
        lit = true;
      }
      weight *= visibilityAt(planes, i);
#endif
      color.rgb += weight * rgb;
    }
    color.a = 1.0 - through;
  }
  gl_FragData[0] = color;
  gl_FragData[1] = vec4(thickness);
}
