// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What cropping regions and masks leave of a segment, as the core's kernels have it
// (simd/chi_occlusion_cut.inl).
#if HAS_REGIONS || GRIDS > 0
uniform float cutAhead; // slices before a segment that say whether its ray comes from what is left

#if HAS_REGIONS
uniform vec4 cropPlane[6];
uniform int regions; // that stay, a bit each

// One count of planes a pair, base 3.
int regionOf(vec3 p)
{
  vec4 at = vec4(p, 1.0);
  int region = 0;
  for (int k = 5; k >= 0; --k)
  {
    region = region * ((k & 1) == 1 ? 3 : 1) + (dot(cropPlane[k], at) >= 0.0 ? 1 : 0);
  }
  return region;
}
#endif

#if GRIDS > 0
uniform usampler2D keepTexture0; // a bit a cell, row after row of 32 bits
#if GRIDS > 1
uniform usampler2D keepTexture1;
#endif
uniform vec3 keepLast[GRIDS];    // cell
uniform int keepStep[2 * GRIDS]; // cells from row to row, and from layer to layer
uniform float keepOffset[GRIDS];

ivec3 cellOf(int grid, vec3 p)
{
  return ivec3(clamp(p + keepOffset[grid], vec3(0.0), keepLast[grid]));
}

uint wordAt(usampler2D bits, int word)
{
  int width = textureSize(bits, 0).x;
  return texelFetch(bits, ivec2(word % width, word / width), 0).r;
}

bool isCellKept(int grid, vec3 p)
{
  ivec3 cell = cellOf(grid, p);
  int n = cell.x + cell.y * keepStep[2 * grid] + cell.z * keepStep[2 * grid + 1];
#if GRIDS > 1
  uint word = grid == 0 ? wordAt(keepTexture0, n >> 5) : wordAt(keepTexture1, n >> 5);
#else
  uint word = wordAt(keepTexture0, n >> 5);
#endif
  return ((word >> uint(n & 31)) & 1u) != 0u;
}
#endif

bool isKept(vec3 p)
{
  bool kept = true;
#if HAS_REGIONS
  kept = ((regions >> regionOf(p)) & 1) != 0;
#endif
#if GRIDS > 0
  for (int k = 0; k < GRIDS; ++k)
  {
    kept = kept && isCellKept(k, p);
  }
#endif
  return kept;
}

// Whether a line between two points may cross a cut.
bool mayCross(vec3 p, vec3 q)
{
  bool differ = false;
#if HAS_REGIONS
  differ = regionOf(p) != regionOf(q);
#endif
#if GRIDS > 0
  for (int k = 0; k < GRIDS; ++k)
  {
    differ = differ || cellOf(k, p) != cellOf(k, q);
  }
#endif
  return differ;
}

const int CROSSINGS = 6 * (HAS_REGIONS + GRIDS);

// Where a segment's line crosses planes and faces of cells, anywhere on it or beyond: of every axis
// of a grid the last face, and the first, which is another one where it is longer than a cell.
// Lines along a face divide by zero, and what comes out is no place on the segment.
void findCrossings(vec3 far, vec3 step, float begin, out float t[CROSSINGS])
{
#if HAS_REGIONS
  for (int k = 0; k < 6; ++k)
  {
    t[k] = 1.0 - dot(cropPlane[k], vec4(far, 1.0)) / dot(cropPlane[k].xyz, step);
  }
#endif
#if GRIDS > 0
  for (int k = 0; k < GRIDS; ++k)
  {
    ivec3 first = cellOf(k, far + (begin - 1.0) * step);
    ivec3 last = cellOf(k, far);
    for (int a = 0; a < 3; ++a)
    {
      bool up = step[a] > 0.0;
      vec2 face = vec2(float(first[a] + (up ? 1 : 0)), float(last[a] + (up ? 0 : 1))) - keepOffset[k];
      vec2 at = 1.0 + (face - far[a]) / step[a];
      t[6 * (HAS_REGIONS + k) + 2 * a] = at.x;
      t[6 * (HAS_REGIONS + k) + 2 * a + 1] = at.y;
    }
  }
#endif
}

// Parts of a segment, 0 at its near slice, 1 at the far one.
struct Left
{
  float fraction;
  float run; // where the last part without a gap begins and ends
  float stop;
  bool before; // something is left where it was looked at first
};

// Of the segment's part from `start` to `end`, seen from `begin` on; `far` is the position at 1.
Left cutSegment(vec3 far, vec3 step, float begin, float start, float end)
{
  Left left = Left(0.0, start, end, false);
  if (!mayCross(far + (begin - 1.0) * step, far + (end - 1.0) * step))
  {
    left.before = isKept(far + (end - 1.0) * step);
    left.fraction = left.before ? max(end - start, 0.0) : 0.0;
    return left;
  }
  float t[CROSSINGS];
  findCrossings(far, step, begin, t);
  bool open = false;
  float low = begin;
  for (int part = 0; part <= CROSSINGS && low < end; ++part)
  {
    float high = end;
    for (int k = 0; k < CROSSINGS; ++k)
    {
      high = t[k] > low ? min(high, t[k]) : high;
    }
    bool kept = isKept(far + (0.5 * (low + high) - 1.0) * step);
    left.before = left.before || (kept && part == 0);
    left.fraction += kept ? max(high - max(low, start), 0.0) : 0.0;
    left.run = kept && !open ? max(low, start) : left.run;
    left.stop = kept && high > start ? high : left.stop;
    open = kept;
    low = high;
  }
  return left;
}
#endif
