// SPDX-FileCopyrightText: Copyright (c) The Chiaroscuro Authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One quad a tetrahedron, over all pixels whose rays may meet it; which ones do is decided by the
// planes of its faces at every pixel, never by the rasteriser, so that nothing hangs on how that
// rounds the corners.
//VTK::System::Dec
//CHI::Defines::Dec

in vec2 ndCoordIn;  // corner of the quad, -1 to 1
in vec2 texCoordIn; // 0 to 1

uniform usampler2D sequenceTexture; // tetrahedra, farthest first
uniform usampler2D vertexTexture;   // four points a tetrahedron
uniform sampler2D pointTexture;     // three texels a point, see vtkChiTetTextures
#if CELL_DATA
uniform sampler2D scalarTexture;
#if SEPARATE
uniform sampler2D opacityTexture;
#endif
#if HAS_CELLS
uniform usampler2D cellTexture; // index of a tetrahedron's values
#endif
#endif
#if HAS_SECONDS
uniform sampler2D secondTexture; // what opacity is looked up at, one a tetrahedron
#endif
uniform int firstInstance;
uniform vec2 firstPixel; // centre of pixel (0, 0), at depth 1 or units of the points
uniform vec2 pixelStep;
uniform float nearDepth;
uniform vec2 pictureSize; // pixels
uniform float margin;     // of the quad, pixels

// Of a face: normal, and depth of its reference point counted from the first vertex; the reference
// point's place, see placeOf; and its depth.
flat out vec4 faceNormal[4];
flat out vec4 facePlace[4];
flat out vec4 faceDepth;
flat out vec4 firstPlace;
flat out float firstDepth;
flat out vec4 scalarField; // gradient, and value at the first vertex
flat out vec4 opacityField;
flat out vec4 fieldRange; // lowest and highest scalar, opacity
flat out uvec2 cell;      // the tetrahedron; bit k: on which side of face k it lies

//CHI::Functions::Dec

vec3 high[4];
vec3 low[4];
vec4 place[4];
vec2 value[4]; // scalar, opacity

// From corner a to corner b. The difference of the leading parts is exact where they are close, so
// that it is good to a float's rounding of itself, however far off the eye is.
vec3 way(int a, int b)
{
  return (high[b] - high[a]) + (low[b] - low[a]);
}

void readPoint(int corner, int point)
{
  vec4 first = texelFetch(pointTexture, rowOf(3 * point), 0);
  vec4 second = texelFetch(pointTexture, rowOf(3 * point + 1), 0);
  high[corner] = first.xyz;
  low[corner] = second.xyz;
  value[corner] = vec2(first.w, second.w);
  place[corner] = texelFetch(pointTexture, rowOf(3 * point + 2), 0);
}

// Pixel and part of a pixel; where there is none, since the point lies before the near plane: x, y
// of the point and negative parts.
vec4 placeOf(int corner)
{
  return place[corner].z < 0.0 ? vec4(high[corner].xy, -1.0, -1.0) : place[corner];
}

// A face by its points in the order of their ids: both tetrahedra at it compute the same bits.
void setFace(int face, ivec3 corner, uvec4 id, bool side)
{
  if (id[corner.x] > id[corner.y])
  {
    corner = corner.yxz;
    side = !side;
  }
  if (id[corner.y] > id[corner.z])
  {
    corner = corner.xzy;
    side = !side;
  }
  if (id[corner.x] > id[corner.y])
  {
    corner = corner.yxz;
    side = !side;
  }
  faceNormal[face] = vec4(cross(way(corner.x, corner.y), way(corner.x, corner.z)), way(0, corner.x).z);
  facePlace[face] = placeOf(corner.x);
  faceDepth[face] = high[corner.x].z;
  cell.y |= side ? 1u << uint(face) : 0u;
}

void extend(vec2 at, inout vec4 box)
{
  box = vec4(min(box.xy, at), max(box.zw, at));
}

// The pixels around what lies behind the near plane: smallest and largest.
vec4 boxOf()
{
  vec4 box = vec4(1e30, 1e30, -1e30, -1e30);
  for (int i = 0; i < 4; ++i)
  {
    bool behind = place[i].z >= 0.0;
    if (behind)
    {
      extend(place[i].xy + place[i].zw, box);
    }
    for (int j = 0; j < i; ++j)
    {
      if (behind != (place[j].z >= 0.0)) // the edge meets the near plane
      {
        vec3 along = way(i, j);
        vec2 at = high[i].xy + along.xy * ((nearDepth - high[i].z) / along.z);
        extend((at / nearDepth - firstPixel) / pixelStep, box);
      }
    }
  }
  return box;
}

vec4 fieldOf(vec4 values, vec3 n1, vec3 n2, vec3 n3, float determinant)
{
  vec3 rise = values.yzw - values.x;
  return vec4((rise.x * n1 + rise.y * n2 + rise.z * n3) / determinant, values.x);
}

vec2 rangeOf(vec4 values)
{
  return vec2(min(min(values.x, values.y), min(values.z, values.w)),
    max(max(values.x, values.y), max(values.z, values.w)));
}

void main()
{
  uint tetrahedron = texelFetch(sequenceTexture, rowOf(firstInstance + gl_InstanceID), 0).r;
  uvec4 id = texelFetch(vertexTexture, rowOf(int(tetrahedron)), 0);
  for (int i = 0; i < 4; ++i)
  {
    readPoint(i, int(id[i]));
  }
  vec3 e1 = way(0, 1);
  vec3 e2 = way(0, 2);
  vec3 e3 = way(0, 3);
  vec3 n1 = cross(e2, e3);
  vec3 n2 = cross(e3, e1);
  vec3 n3 = cross(e1, e2);
  float determinant = dot(e1, n1);
  bool mirrored = determinant < 0.0;
  cell = uvec2(tetrahedron, 0u);
  setFace(0, ivec3(1, 2, 3), id, mirrored);
  setFace(1, ivec3(0, 3, 2), id, mirrored);
  setFace(2, ivec3(0, 1, 3), id, mirrored);
  setFace(3, ivec3(0, 2, 1), id, mirrored);
  firstPlace = placeOf(0);
  firstDepth = high[0].z;

#if HAS_SECONDS
  float second = texelFetch(secondTexture, rowOf(int(tetrahedron)), 0).r;
#endif
#if CELL_DATA
#if HAS_CELLS
  int at = int(texelFetch(cellTexture, rowOf(int(tetrahedron)), 0).r);
#else
  int at = int(tetrahedron);
#endif
  scalarField = vec4(0.0, 0.0, 0.0, texelFetch(scalarTexture, rowOf(at), 0).r);
  opacityField = vec4(0.0);
#if HAS_SECONDS
  opacityField.w = second;
#elif SEPARATE
  opacityField.w = texelFetch(opacityTexture, rowOf(at), 0).r;
#endif
  fieldRange = vec4(scalarField.ww, opacityField.ww);
#else
  vec4 scalars = vec4(value[0].x, value[1].x, value[2].x, value[3].x);
#if HAS_SECONDS
  vec4 opacities = vec4(second);
#else
  vec4 opacities = vec4(value[0].y, value[1].y, value[2].y, value[3].y);
#endif
  scalarField = fieldOf(scalars, n1, n2, n3, determinant);
  opacityField = fieldOf(opacities, n1, n2, n3, determinant);
  fieldRange = vec4(rangeOf(scalars), rangeOf(opacities));
#endif

  vec4 box = boxOf();
  // beyond the picture nothing is lost, and large numbers lose nothing by it
  vec2 corner = clamp(mix(box.xy, box.zw, texCoordIn), vec2(-1.0), pictureSize) + margin * ndCoordIn;
  vec2 onPicture = (corner + 0.5) / pictureSize * 2.0 - 1.0;
  bool empty = determinant == 0.0 || box.x > box.z;
  gl_Position = vec4(empty ? vec2(-2.0) : onPicture, 0.0, 1.0);
}
