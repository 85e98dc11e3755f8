// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The part of a pixel's ray inside of one tetrahedron, as the core's kernels find it where they are
// most careful (simd/chi_tet_fragments.inl), and its colour. Depths are counted from the first vertex.
// Output 0 goes over what lies behind (blending ONE, ONE_MINUS_SRC_ALPHA); of maximum intensity it
// is the place of the larger scalar in the tables, and the opacity's (blending MAX).
//VTK::System::Dec
//VTK::Output::Dec
//CHI::Defines::Dec

flat in vec4 faceNormal[4];
flat in vec4 facePlace[4];
flat in vec4 faceDepth;
flat in vec4 firstPlace;
flat in float firstDepth;
flat in vec4 scalarField;
flat in vec4 opacityField;
flat in vec4 fieldRange;
flat in uvec2 cell;

uniform vec2 firstPixel;
uniform vec2 pixelStep;
uniform float nearDepth;
uniform float unit;       // world units a unit of the points
#if HAS_PLANE
uniform vec3 planePlace; // of the second quantity, likewise
#endif
uniform vec3 tablePlace;  // place of a scalar: times x, of its distance from y; at most z
#if PLANES > 0
uniform vec4 clip[PLANES]; // a x + b y + c z + d >= 0 stays
#endif
#if HAS_SURFACE
uniform sampler2D surfaceTexture; // depth, world units
#endif
#if SHADED
uniform sampler2D shadeTexture; // three texels a tetrahedron
uniform float colorLimit;
#endif

const float far = 3e38;

//CHI::Functions::Dec

// From a point to the ray at the point's depth, within the picture's plane. Pixels are counted from
// the point's own, so that nothing cancels.
vec2 awayFrom(vec4 place, float depth, vec2 pixel, vec2 ray)
{
#if PARALLEL
  return pixelStep * ((pixel - place.xy) - place.zw);
#else
  return place.z < 0.0 ? depth * ray - place.xy
                       : depth * pixelStep * ((pixel - place.xy) - place.zw);
#endif
}

// Cut the interval to one side of a plane that the ray passes with this slope, at this depth.
void cut(float slope, float depth, bool inside, inout vec2 interval)
{
  if (slope > 0.0)
  {
    interval.x = max(interval.x, depth);
  }
  else if (slope < 0.0)
  {
    interval.y = min(interval.y, depth);
  }
  else if (!inside)
  {
    interval.y = -far;
  }
}

float tableAt(float value, vec2 range, vec3 table)
{
  return clamp((clamp(value, range.x, range.y) - table.y) * table.x, 0.0, table.z);
}

// Places in the tables of both ends of the interval.
vec2 endsOf(vec4 field, vec2 range, vec3 table, vec2 interval, vec2 away, vec3 direction)
{
  float here = field.w + dot(field.xy, away);
  float slope = dot(field.xyz, direction);
  float front = here + slope * interval.x;
  float back = front + slope * (interval.y - interval.x);
  return vec2(tableAt(front, range, table), tableAt(back, range, table));
}

void main()
{
  vec2 pixel = floor(gl_FragCoord.xy);
  vec2 ray = firstPixel + pixelStep * pixel;
#if PARALLEL
  vec3 direction = vec3(0.0, 0.0, 1.0);
#else
  vec3 direction = vec3(ray, 1.0);
#endif

  vec2 interval = vec2(max(nearDepth - firstDepth, -far), far);
  for (int k = 0; k < 4; ++k)
  {
    float side = (cell.y >> uint(k) & 1u) != 0u ? 1.0 : -1.0;
    float along = dot(faceNormal[k].xyz, direction);
    float across =
      -dot(faceNormal[k].xy, awayFrom(facePlace[k], faceDepth[k], pixel, ray));
    // a ray within the plane is inside of one of the two tetrahedra at it
    bool inside = across * side < 0.0 || (across == 0.0 && side > 0.0);
    cut(along * side, across / along + faceNormal[k].w, inside, interval);
  }
  if (!(interval.x < interval.y) || interval.x == -far || interval.y == far)
  {
    discard;
  }
#if PLANES > 0
  for (int k = 0; k < PLANES; ++k)
  {
#if PARALLEL
    float slope = clip[k].z;
    float offset = clip[k].x * ray.x + clip[k].y * ray.y + clip[k].w;
#else
    float slope = dot(clip[k].xyz, direction);
    float offset = clip[k].w;
#endif
    cut(slope, -offset / slope - firstDepth, offset >= 0.0, interval);
  }
#endif
#if HAS_SURFACE
  float surface = texelFetch(surfaceTexture, ivec2(pixel), 0).r;
  interval.y = surface > 0.0 ? min(interval.y, surface / unit - firstDepth) : interval.y;
#endif
  if (!(interval.x < interval.y))
  {
    discard;
  }

  vec2 away = awayFrom(firstPlace, firstDepth, pixel, ray);
  vec2 x = endsOf(scalarField, fieldRange.xy, tablePlace, interval, away, direction);
#if HAS_PLANE
  vec2 y = endsOf(opacityField, fieldRange.zw, planePlace, interval, away, direction);
#elif SEPARATE
  vec2 y = endsOf(opacityField, fieldRange.zw, tablePlace, interval, away, direction);
#else
  vec2 y = x;
#endif
#if MAXIMUM
  gl_FragData[0] = vec4(max(x.x, x.y), max(y.x, y.y), 0.0, 0.0);
#else
  float path = (interval.y - interval.x) * unit * length(direction);
#if DIRECT
  vec3 front;
  vec3 back;
  directAt(int(cell.x), interval, away, direction, front, back);
  vec4 segment = directSegment(x, path, front, back);
#else
  vec4 segment = segmentOf(x, y, path); // premultiplied colour, transmittance
#endif
  float alpha = 1.0 - segment.a;
#if SHADED
  int first = 3 * int(cell.x);
  vec2 shade[3];
  for (int k = 0; k < 3; ++k)
  {
    shade[k] = texelFetch(shadeTexture, rowOf(first + k), 0).rg;
  }
  vec3 lit = segment.rgb * vec3(shade[0], shade[1].x) + vec3(shade[1].y, shade[2]) * alpha;
  segment.rgb = min(lit, vec3(colorLimit * alpha));
#endif
  gl_FragData[0] = vec4(segment.rgb, alpha);
#endif
}
