// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Lists that lie in rows of a texture, and the table of colours among them.
uniform sampler2D colorTexture; // red, green, blue, extinction

ivec2 rowOf(int i)
{
  return ivec2(i & (TABLE_WIDTH - 1), i / TABLE_WIDTH);
}

// Linear from entry to entry.
vec4 entryAt(float place)
{
  int i = int(place);
  vec4 here = texelFetch(colorTexture, rowOf(i), 0);
  return here + (place - float(i)) * (texelFetch(colorTexture, rowOf(i + 1), 0) - here);
}
