// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Gradients of the samples, and what they do to opacity and colour, as the core's kernels have it
// (simd/chi_occlusion_shade.inl; chi_shading.h has the formula).
#if HAS_GRADIENT
uniform vec3 toGradient[3]; // rows, from differences over two samples to eye space

#if NEAREST
// Differences over one sample to either side.
vec3 differencesAt(vec3 p)
{
  ivec3 last = textureSize(volumeTexture, 0) - 1;
  vec3 difference;
  for (int a = 0; a < 3; ++a)
  {
    ivec3 before = ivec3(p + 0.5);
    ivec3 after = before;
    before[a] = int(max(p[a] - 1.0, 0.0) + 0.5);
    after[a] = int(min(p[a] + 1.0, float(last[a])) + 0.5);
    difference[a] = scalarAt(after) - scalarAt(before);
  }
  return difference;
}
#else
// Differences of the interpolated scalar over one sample to either side; at the border, the
// border's own samples.
vec3 differencesAt(vec3 p)
{
  ivec3 last = textureSize(volumeTexture, 0) - 1;
  ivec3 i = min(ivec3(p), max(last - 1, ivec3(0)));
  ivec3 j = min(i + 1, last);
  ivec3 h = max(i - 1, ivec3(0));
  ivec3 k = min(j + 1, last);
  vec3 f = p - vec3(i);
  vec4 a = samplesAt(i.x, ivec2(i.y, j.y), ivec2(i.z, j.z));
  vec4 b = samplesAt(j.x, ivec2(i.y, j.y), ivec2(i.z, j.z));
  vec4 low = b - samplesAt(h.x, ivec2(i.y, j.y), ivec2(i.z, j.z));
  vec4 high = samplesAt(k.x, ivec2(i.y, j.y), ivec2(i.z, j.z)) - a;
  vec3 difference;
  difference.x = blend(low + f.x * (high - low), f.yz);
  vec4 value = a + f.x * (b - a); // on the four lines along x
  a = samplesAt(i.x, ivec2(h.y, k.y), ivec2(i.z, j.z));
  vec4 aside = a + f.x * (samplesAt(j.x, ivec2(h.y, k.y), ivec2(i.z, j.z)) - a);
  difference.y = blend(
    vec4(value.y - aside.x, aside.y - value.x, value.w - aside.z, aside.w - value.z), f.yz);
  a = samplesAt(i.x, ivec2(i.y, j.y), ivec2(h.z, k.z));
  aside = a + f.x * (samplesAt(j.x, ivec2(i.y, j.y), ivec2(h.z, k.z)) - a);
  difference.z = blend(
    vec4(value.z - aside.x, value.w - aside.y, aside.z - value.x, aside.w - value.y), f.yz);
  return difference;
}
#endif

// In eye space, shares of the scalar range a mean voxel; `p` lies in the grid.
vec3 gradientAt(vec3 p)
{
  vec3 difference = differencesAt(p);
  for (int a = 0; a < 3; ++a)
  {
    // beside a sample that is not finite there is no gradient
    difference[a] = abs(difference[a]) <= largest ? difference[a] : 0.0;
  }
  return vec3(
    dot(toGradient[0], difference), dot(toGradient[1], difference), dot(toGradient[2], difference));
}
#else
vec3 gradientAt(vec3 p)
{
  return vec3(0.0); // nobody asks for it
}
#endif

#if HAS_GRADIENT_OPACITY
uniform sampler2D gradientOpacityTexture;
uniform vec2 gradientScale; // of a magnitude to a place in the table; the last place

float gradientOpacity(float magnitude)
{
  float t = min(magnitude * gradientScale.x, gradientScale.y);
  int entry = min(int(t), int(gradientScale.y) - 1);
  float low = texelFetch(gradientOpacityTexture, entryPlace(entry), 0).r;
  float high = texelFetch(gradientOpacityTexture, entryPlace(entry + 1), 0).r;
  return low + (t - float(entry)) * (high - low);
}
#endif

#if IS_SHADED
uniform vec4 toEye[3]; // rows, from index to eye coordinates
uniform float ambient;
uniform vec3 ambientLight;
uniform float specularPower;
uniform float colorLimit;
#if LAMPS > 0
uniform int lampKind[LAMPS]; // 0: from the eye, 1: directional, 2: positional
uniform vec3 lampDirection[LAMPS];
uniform vec3 lampPosition[LAMPS];
uniform vec3 lampDiffuse[LAMPS];
uniform vec3 lampSpecular[LAMPS];
uniform vec3 lampAttenuation[LAMPS];
uniform vec2 lampCone[LAMPS]; // cosine, negative: everywhere; exponent

float powerOf(float x, float exponent)
{
  return pow(clamp(x, 1e-30, 1.0), exponent);
}

// What of a positional light reaches a point, and the direction in which it travels.
float reachOf(int k, vec3 eye, out vec3 travel)
{
  travel = eye - lampPosition[k];
  float far = length(travel);
  travel /= max(far, 1e-30);
  vec3 a = lampAttenuation[k];
  float reaches = 1.0 / (a.x + far * (a.y + far * a.z));
  float cosine = dot(travel, lampDirection[k]);
  if (lampCone[k].x >= 0.0)
  {
    reaches = cosine >= lampCone[k].x ? reaches * powerOf(cosine, lampCone[k].y) : 0.0;
  }
  return reaches;
}

// Adds up the lights' matt and mirrored parts.
void addLamps(vec3 normal, vec3 eye, vec3 view, inout vec3 diffuse, inout vec3 specular)
{
  float normalView = dot(normal, view);
  for (int k = 0; k < LAMPS; ++k)
  {
    float reaches = 1.0;
    float cosine = normalView;
    float lightView = 1.0;
    if (lampKind[k] != LAMP_EYE)
    {
      vec3 travel = lampDirection[k];
      if (lampKind[k] == LAMP_POSITIONAL)
      {
        reaches = reachOf(k, eye, travel);
      }
      cosine = dot(normal, travel);
      lightView = dot(travel, view);
    }
    float facing = IS_TWO_SIDED != 0 ? abs(cosine) : cosine;
    if (!(facing > 0.0 && reaches > 0.0))
    {
      continue;
    }
    diffuse += facing * reaches * lampDiffuse[k];
#if IS_SHINY
    // r = 2 (n.l) n - l: one factor turned round, the other not, is not a unit vector
    float factor = lampKind[k] == LAMP_EYE ? cosine : facing;
    float square = 1.0 + 4.0 * factor * (factor - cosine);
    float mirrored = (2.0 * factor * normalView - lightView) / sqrt(max(square, 0.0));
    if (IS_TWO_SIDED != 0 && lampKind[k] == LAMP_POSITIONAL)
    {
      mirrored = abs(mirrored);
    }
    if (mirrored > 0.0)
    {
      specular += reaches * powerOf(mirrored, specularPower) * lampSpecular[k];
    }
#endif
  }
}
#endif

// Colour of a sample under the lights; `p` in index space.
vec3 shade(vec3 albedo, vec3 gradient, vec3 p, vec3 visibility)
{
  float magnitude = length(gradient);
  vec3 normal = magnitude > 0.0 ? gradient / max(magnitude, 1e-37) : vec3(0.0);
  vec4 at = vec4(p, 1.0);
  vec3 eye = vec3(dot(toEye[0], at), dot(toEye[1], at), dot(toEye[2], at));
  vec3 diffuse = vec3(ambient);
  vec3 specular = vec3(0.0);
#if LAMPS > 0
  addLamps(normal, eye, eye / max(length(eye), 1e-18), diffuse, specular);
#endif
  return min(visibility * (albedo * diffuse + ambientLight) + specular, vec3(colorLimit));
}
#endif
