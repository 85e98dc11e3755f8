// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Extinction and colour of a segment.
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
uniform float quantum;

ivec2 entryPlace(int entry)
{
  return ivec2(entry % TABLE_WIDTH, entry / TABLE_WIDTH);
}

// Mean extinction of a segment from position t0 to t1, 0 ... end, of the table that begins at an
// entry, in whose quanta sums are; t0 < 0: not known. Eq. 1 of theory/occlusion.md.
float meanExtinction(int first, int end, float unit, float t0, float t1)
{
  int entry = min(int(t1), end - 1);
  float f = t1 - float(entry);
  ivec2 at = entryPlace(first + entry);
  vec2 sigma = texelFetch(sigmaTexture, at, 0).rg;
  float change = t0 < 0.0 ? 0.0 : t1 - t0;
  if (abs(change) <= 1.0)
  {
    return max(sigma.x + (2.0 * f - change) * sigma.y, 0.0);
  }
  int before = min(int(t0), end - 1);
  float g = t0 - float(before);
  ivec2 from = entryPlace(first + before);
  vec2 old = texelFetch(sigmaTexture, from, 0).rg;
  int sums = texelFetch(sumTexture, at, 0).r - texelFetch(sumTexture, from, 0).r;
  float rest = f * (sigma.x + f * sigma.y) - g * (old.x + g * old.y);
  return max((float(sums) * unit + rest) / change, 0.0);
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

// Colour of a segment between two places of the table that begins at an entry. `seen` is its weight
// as if nothing lay before this slab: no less is integrated than in the core.
vec3 colorOf(int first, float t0, float t, float tau, float seen)
{
  float change = t0 < 0.0 ? 0.0 : t - t0;
#if COLOR_PARTS > 0
  if (abs(change) > colorStep && abs(change) * seen > colorWorth)
  {
    return integrateColors(t0, change, tau);
  }
#endif
  return texelFetch(colorTexture, entryPlace(first + int(t - 0.5 * change + 0.5)), 0).rgb;
}
