// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Components besides the volume's own: one colour and one extinction of all, as the core's kernels
// have it (simd/chi_occlusion_components.inl). A texel of the volume holds the own one first.
#if COMPONENTS > 0
uniform vec3 moreScale[COMPONENTS]; // base, scale, offset: place = (scalar - base) scale + offset
uniform float moreEnd[COMPONENTS];  // last place in the table
uniform int moreFirst[COMPONENTS];  // entry of the table, behind that of the own component
uniform float moreQuantum[COMPONENTS];
uniform float componentWeight[COMPONENTS + 1]; // of the own one first

vec3 moreAt(ivec3 i)
{
  return vec3(texelFetch(volumeTexture, i, 0).gba);
}

vec3 moreAlongX(ivec3 i, ivec3 j, float f)
{
  vec3 a = moreAt(i);
  return a + f * (moreAt(ivec3(j.x, i.yz)) - a);
}

// Places of a point in the tables of the other components; negative where one is not finite.
vec3 morePlaces(vec3 p)
{
  ivec3 last = textureSize(volumeTexture, 0) - 1;
  p = clamp(p, vec3(0.0), vec3(last));
#if NEAREST
  vec3 value = moreAt(ivec3(p + 0.5));
#else
  ivec3 i = min(ivec3(p), max(last - 1, ivec3(0)));
  ivec3 j = min(i + 1, last);
  vec3 f = p - vec3(i);
  vec3 low = moreAlongX(i, j, f.x);
  low += f.y * (moreAlongX(ivec3(i.x, j.y, i.z), j, f.x) - low);
  vec3 high = moreAlongX(ivec3(i.xy, j.z), j, f.x);
  high += f.y * (moreAlongX(ivec3(i.x, j.yz), j, f.x) - high);
  vec3 value = low + f.z * (high - low);
#endif
  vec3 place = vec3(0.0);
  for (int k = 0; k < COMPONENTS; ++k)
  {
    float t = (value[k] - moreScale[k].x) * moreScale[k].y + moreScale[k].z;
    place[k] = abs(value[k]) <= largest ? clamp(t, 0.0, moreEnd[k]) : -1.0;
  }
  return place;
}

vec3 moreColor(int k, float place)
{
  return texelFetch(colorTexture, entryPlace(moreFirst[k] + int(place + 0.5)), 0).rgb;
}

// Optical thickness of a segment, and its colour: first those of the own component, then of all.
// It lies from `near` to `far`; of samples that are steps both are the sample's place.
#if IS_DEPENDENT
float composeComponents(vec3 near, vec3 far, float own, float length, inout vec3 rgb)
{
  vec3 place = morePlaces(0.5 * (near + far));
  bool finite = true;
  for (int k = 0; k < COMPONENTS; ++k)
  {
    finite = finite && place[k] >= 0.0;
  }
#if COMPONENTS == 1
  rgb = moreColor(0, max(place.x, 0.0));
#else
  rgb = place;
#endif
  return finite ? own : 0.0;
}
#else
float composeComponents(vec3 near, vec3 far, float own, float length, inout vec3 rgb)
{
  vec3 t = morePlaces(far);
#if NEAREST
  vec3 t0 = t;
#else
  vec3 t0 = morePlaces(near);
#endif
  float squares = componentWeight[0] > 0.0 ? own * own : 0.0;
  float weighted = componentWeight[0] * own;
  rgb *= weighted;
  for (int k = 0; k < COMPONENTS; ++k)
  {
    if (!(componentWeight[k + 1] > 0.0))
    {
      continue;
    }
    if (t[k] < 0.0 || t0[k] < 0.0)
    {
      return 0.0;
    }
    float depth = length *
      meanExtinction(moreFirst[k], int(moreEnd[k]), moreQuantum[k], t0[k], t[k]);
    rgb += componentWeight[k + 1] * depth * moreColor(k, 0.5 * (t0[k] + t[k]));
    squares += depth * depth;
    weighted += componentWeight[k + 1] * depth;
  }
  if (!(squares > 0.0 && weighted > 0.0))
  {
    return 0.0;
  }
  float depth = squares / weighted;
  rgb /= max(depth, 1e-37);
  return depth;
}
#endif
#endif
