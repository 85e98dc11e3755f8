// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Samples of the volume, and their places in the tables.
uniform VOLUME_SAMPLER volumeTexture;
uniform usampler3D brickTexture; // 0: transparent
uniform int useBricks;
uniform vec3 tableScale; // base, scale, offset: entry = (scalar - base) scale + offset

const float largest = 3.402823e38; // infinite and NaN samples are not below it

float scalarAt(ivec3 i)
{
  return float(texelFetch(volumeTexture, i, 0).r);
}

// At (y, z) of (first, first), (second, first), (first, second), (second, second).
vec4 samplesAt(int x, ivec2 y, ivec2 z)
{
  return vec4(scalarAt(ivec3(x, y.x, z.x)), scalarAt(ivec3(x, y.y, z.x)),
    scalarAt(ivec3(x, y.x, z.y)), scalarAt(ivec3(x, y.y, z.y)));
}

// Bilinear, of what lies at the corners (0, 0), (1, 0), (0, 1), (1, 1).
float blend(vec4 corner, vec2 f)
{
  vec2 line = corner.xz + f.x * (corner.yw - corner.xz);
  return line.x + f.y * (line.y - line.x);
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
  vec4 a = samplesAt(i.x, ivec2(i.y, j.y), ivec2(i.z, j.z));
  vec4 b = samplesAt(j.x, ivec2(i.y, j.y), ivec2(i.z, j.z));
  return blend(a + f.x * (b - a), f.yz);
#endif
}

#if HAS_LABELS
uniform usampler3D labelTexture; // table of each voxel

// First entry of the table of the voxel about a point.
int tableAt(vec3 p)
{
  p = clamp(p, vec3(0.0), vec3(textureSize(labelTexture, 0) - 1));
  return int(texelFetch(labelTexture, ivec3(p + 0.5), 0).r) * ENTRIES;
}
#endif

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
