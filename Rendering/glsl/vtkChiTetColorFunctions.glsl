// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Colours that are given, not looked up (simd/chi_tet_colors.inl): linear in a tetrahedron, or one a
// cell. They are fetched at every fragment: there are no more varyings for them.
#if DIRECT
uniform sampler2D directTexture; // of points, or of cells
#if CELL_DATA
#if HAS_CELLS
uniform usampler2D cellTexture;
#endif
#else
uniform usampler2D vertexTexture;
uniform sampler2D pointTexture;
#endif

// At both ends of the interval.
void directAt(int tetrahedron, vec2 interval, vec2 away, vec3 direction, out vec3 front, out vec3 back)
{
#if CELL_DATA
#if HAS_CELLS
  tetrahedron = int(texelFetch(cellTexture, rowOf(tetrahedron), 0).r);
#endif
  front = texelFetch(directTexture, rowOf(tetrahedron), 0).rgb;
  back = front;
#else
  uvec4 id = texelFetch(vertexTexture, rowOf(tetrahedron), 0);
  vec3 high[4];
  vec3 low[4];
  vec3 color[4];
  for (int k = 0; k < 4; ++k)
  {
    high[k] = texelFetch(pointTexture, rowOf(3 * int(id[k])), 0).xyz;
    low[k] = texelFetch(pointTexture, rowOf(3 * int(id[k]) + 1), 0).xyz;
    color[k] = texelFetch(directTexture, rowOf(int(id[k])), 0).rgb;
  }
  // not in a loop: Mesa 22 reads arrays wrongly at indices that are computed from its counter
  vec3 e1 = (high[1] - high[0]) + (low[1] - low[0]);
  vec3 e2 = (high[2] - high[0]) + (low[2] - low[0]);
  vec3 e3 = (high[3] - high[0]) + (low[3] - low[0]);
  vec3 n1 = cross(e2, e3);
  vec3 n2 = cross(e3, e1);
  vec3 n3 = cross(e1, e2);
  float determinant = dot(e1, n1);
  // of each edge's far end: what it has of the place in front, and of the way to the back
  vec3 from = vec3(away, 0.0) + direction * interval.x;
  vec3 way = direction * (interval.y - interval.x);
  vec3 share = vec3(dot(n1, from), dot(n2, from), dot(n3, from)) / determinant;
  vec3 rise = vec3(dot(n1, way), dot(n2, way), dot(n3, way)) / determinant;
  mat3 change = mat3(color[1] - color[0], color[2] - color[0], color[3] - color[0]);
  vec3 least = min(min(color[0], color[1]), min(color[2], color[3]));
  vec3 most = max(max(color[0], color[1]), max(color[2], color[3]));
  front = color[0] + change * share;
  back = clamp(front + change * rise, least, most);
  front = clamp(front, least, most);
#endif
}

// Premultiplied colour and transmittance: what is seen of the front's colour and of the back's. By
// full tables their red is the share of the back.
vec4 directSegment(vec2 x, float path, vec3 front, vec3 back)
{
#if METHOD == METHOD_FULL
  vec4 segment = segmentOf(x, x, path);
  vec2 share = vec2(max(1.0 - segment.a - segment.r, 0.0), segment.r);
  float through = segment.a;
#elif METHOD == METHOD_PARTIAL
  vec2 tau = vec2(entryAt(x.x).a, entryAt(x.y).a) * path;
  float psi = psiOf(tau);
  float through = exp(-0.5 * (tau.x + tau.y));
  vec2 share = vec2(1.0 - psi, psi - through);
#else
  float through = exp(-entryAt(0.5 * (x.x + x.y)).a * path);
  vec2 share = vec2(0.5 * (1.0 - through));
#endif
  return vec4(share.x * front + share.y * back, through);
}
#endif
