// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Lists that lie in rows of a texture, and the table of colours among them.
uniform sampler2D colorTexture; // red, green, blue, extinction

ivec2 rowOf(int i)
{
  return ivec2(i & (TABLE_WIDTH - 1), i / TABLE_WIDTH);
}

#if HAS_PLANE
uniform sampler2D planeTexture; // the same over two quantities, row after row
uniform ivec2 planeSize;        // entries of a row, rows

// Bilinear.
vec4 planeAt(vec2 place)
{
  ivec2 i = ivec2(place);
  i.y = min(i.y, planeSize.y - 2);
  vec2 f = place - vec2(i);
  int first = i.x + planeSize.x * i.y;
  vec4 low = texelFetch(planeTexture, rowOf(first), 0);
  vec4 high = texelFetch(planeTexture, rowOf(first + planeSize.x), 0);
  low += f.x * (texelFetch(planeTexture, rowOf(first + 1), 0) - low);
  high += f.x * (texelFetch(planeTexture, rowOf(first + planeSize.x + 1), 0) - high);
  return low + f.y * (high - low);
}
#endif

// Linear from entry to entry.
vec4 entryAt(float place)
{
  int i = int(place);
  vec4 here = texelFetch(colorTexture, rowOf(i), 0);
  return here + (place - float(i)) * (texelFetch(colorTexture, rowOf(i + 1), 0) - here);
}
